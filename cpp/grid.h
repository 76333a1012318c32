// What the .cc files share. Heavy: includes OpenVDB.
#pragma once

#include "exocarp/cpp/vdb.h"

#include <openvdb/Grid.h>
#include <openvdb/tree/Tree.h>

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace exocarp::vdb {

template <class T>
using Tree = typename openvdb::tree::Tree4<T, 5, 4, 3>::Type;

template <class T>
struct Held {
    using Grid = openvdb::Grid<Tree<T>>;
    using Leaf = typename Grid::TreeType::LeafNodeType;

    explicit Held(typename Grid::Ptr g) : grid(std::move(g)) {}

    // The leaves in the order of the tree, listed on first use after a change.
    const std::vector<const Leaf*>& leaves() const
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!listed) {
            list.clear();
            grid->constTree().getNodes(list);
            listed = true;
        }
        return list;
    }

    // To be called before the tree changes, which needs the only reference to the grid.
    void forget_leaves() { listed = false; }

    typename Grid::Ptr grid;

private:
    mutable std::mutex mutex;
    mutable bool listed = false;
    mutable std::vector<const Leaf*> list;
};

// Registers OpenVDB's types, once.
void initialize();

Placement placement_of(const openvdb::GridBase& grid);

inline std::string path_string(rust::Slice<const std::uint8_t> path)
{
    return std::string(path.begin(), path.end());
}

// rust::String demands UTF-8, which names in a file need not be.
inline rust::String text(const std::string& s)
{
    return rust::String::lossy(s);
}

} // namespace exocarp::vdb
