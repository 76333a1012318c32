#include "exocarp/cpp/grid.h"
#include "exocarp/src/vdb/bridge.rs.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <stdexcept>

namespace exocarp::vdb {

namespace {

constexpr std::size_t LEAF_SIZE = 512;
constexpr std::size_t MASK_WORDS = 8;

// OpenVDB's tools are quick on a narrow band, and threads are the caller's business.
constexpr bool THREADED = false;

void require(bool condition, const char* sentence)
{
    if (!condition) throw std::invalid_argument(sentence);
}

openvdb::Coord coord(rust::Slice<const std::int32_t> ijk, std::size_t n)
{
    return openvdb::Coord(ijk[3 * n], ijk[3 * n + 1], ijk[3 * n + 2]);
}

// A new grid, made by the library. `Grid::create` would compile the whole class once more, which takes the
// compiler twice as long as all else that is here.
template <class T>
std::shared_ptr<Held<T>> create(T background, const std::string& name, double voxel, rust::Str creator)
{
    using Grid = typename Held<T>::Grid;
    initialize();
    const auto grid = openvdb::gridPtrCast<Grid>(openvdb::GridBase::createGrid(Grid::gridType()));
    grid->tree().root().setBackground(background, /*updateChildNodes=*/false);
    grid->setName(name);
    grid->setCreator(std::string(creator));
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    return std::make_shared<Held<T>>(grid);
}

} // namespace

void initialize()
{
    static std::once_flag once;
    std::call_once(once, [] { openvdb::initialize(); });
}

Placement placement_of(const openvdb::GridBase& grid)
{
    const openvdb::math::Transform& t = grid.constTransform();
    Placement placement{};
    placement.linear = t.isLinear();
    const openvdb::Vec3d nodes[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int n = 0; n < 4; ++n) {
        const openvdb::Vec3d world = t.indexToWorld(nodes[n]);
        for (int axis = 0; axis < 3; ++axis) placement.frame[3 * n + axis] = world[axis];
    }
    return placement;
}

std::unique_ptr<FloatGrid> new_float_grid(double voxel, float background, rust::Str creator)
{
    auto held = create<float>(background, "surface", voxel, creator);
    held->grid->setGridClass(openvdb::GRID_LEVEL_SET);
    return std::make_unique<FloatGrid>(std::move(held));
}

std::unique_ptr<Int32Grid> new_int32_grid(double voxel, rust::Str name, rust::Str creator)
{
    return std::make_unique<Int32Grid>(create<std::int32_t>(-1, std::string(name), voxel, creator));
}

template <class T>
LeafGrid<T>::LeafGrid(std::shared_ptr<Held<T>> held) : mHeld(std::move(held))
{
}

template <class T>
void LeafGrid<T>::insert(
    rust::Slice<const std::int32_t> origins,
    rust::Slice<const T> values,
    rust::Slice<const std::uint64_t> active)
{
    using Leaf = typename Held<T>::Leaf;
    const std::size_t count = active.size() / MASK_WORDS;
    require(active.size() == MASK_WORDS * count, "the masks are not of whole leaves");
    require(origins.size() == 3 * count, "not one origin for each mask");
    require(values.size() == LEAF_SIZE * count, "not 512 values for each mask");

    mHeld->forget_leaves();
    auto accessor = mHeld->grid->getAccessor();
    for (std::size_t n = 0; n < count; ++n) {
        auto leaf = std::make_unique<Leaf>(coord(origins, n));
        std::memcpy(leaf->buffer().data(), values.data() + LEAF_SIZE * n, LEAF_SIZE * sizeof(T));
        typename Leaf::NodeMaskType mask;
        for (std::size_t w = 0; w < MASK_WORDS; ++w) {
            mask.template getWord<std::uint64_t>(openvdb::Index(w)) = active[MASK_WORDS * n + w];
        }
        leaf->setValueMask(mask);
        accessor.addLeaf(leaf.release());
    }
}

template <class T>
void LeafGrid<T>::take(const LeafGrid& other)
{
    using Leaf = typename Held<T>::Leaf;
    mHeld->forget_leaves();
    auto& tree = mHeld->grid->tree();
    const auto& from = other.mHeld->grid->constTree();
    auto tile = from.cbeginValueOff();
    tile.setMaxDepth(tile.getLeafDepth() - 1);
    for (; tile; ++tile) {
        if (*tile == from.background()) continue;
        openvdb::CoordBBox cube;
        tile.getBoundingBox(cube);
        tree.sparseFill(cube, *tile, /*active=*/false);
    }
    for (const Leaf* leaf : other.mHeld->leaves()) tree.addLeaf(new Leaf(*leaf));
}

template <class T>
std::size_t LeafGrid<T>::leaf_count() const
{
    return mHeld->leaves().size();
}

template <class T>
Counts LeafGrid<T>::counts() const
{
    const openvdb::TreeBase& tree = mHeld->grid->constBaseTree();
    Counts counts{};
    // Counted with threads of TBB's own otherwise.
    tbb::task_arena arena(1);
    arena.execute([&] {
        counts.active_voxels = tree.activeVoxelCount();
        counts.memory = tree.memUsage();
    });
    return counts;
}

template <class T>
rust::Vec<std::int32_t> LeafGrid<T>::leaf_origins() const
{
    const auto& leaves = mHeld->leaves();
    rust::Vec<std::int32_t> origins;
    origins.reserve(3 * leaves.size());
    for (const auto* leaf : leaves) {
        for (int axis = 0; axis < 3; ++axis) origins.push_back(leaf->origin()[axis]);
    }
    return origins;
}

template <class T>
void LeafGrid<T>::read(
    std::size_t first, rust::Slice<T> values, rust::Slice<std::uint64_t> active) const
{
    const auto& leaves = mHeld->leaves();
    const std::size_t count = active.size() / MASK_WORDS;
    require(active.size() == MASK_WORDS * count, "the masks are not of whole leaves");
    require(values.size() == LEAF_SIZE * count, "not 512 values for each mask");
    require(first <= leaves.size() && count <= leaves.size() - first, "there are not so many leaves");

    for (std::size_t n = 0; n < count; ++n) {
        const auto& leaf = *leaves[first + n];
        std::memcpy(values.data() + LEAF_SIZE * n, leaf.buffer().data(), LEAF_SIZE * sizeof(T));
        for (std::size_t w = 0; w < MASK_WORDS; ++w) {
            active[MASK_WORDS * n + w] =
                leaf.getValueMask().template getWord<std::uint64_t>(openvdb::Index(w));
        }
    }
}

template class LeafGrid<float>;
template class LeafGrid<std::int32_t>;

void FloatGrid::fill(
    rust::Slice<const std::int32_t> origins, rust::Slice<const std::uint32_t> sides, float value)
{
    require(origins.size() == 3 * sides.size(), "not one origin for each side");
    mHeld->forget_leaves();
    for (std::size_t n = 0; n < sides.size(); ++n) {
        const auto cube = openvdb::CoordBBox::createCube(coord(origins, n), sides[n]);
        mHeld->grid->tree().sparseFill(cube, value, /*active=*/false);
    }
}

void FloatGrid::prune()
{
    mHeld->forget_leaves();
    openvdb::tools::pruneTiles(mHeld->grid->tree(), /*tolerance=*/0.0f, THREADED);
}

void FloatGrid::inside(rust::Slice<const std::int32_t> nodes, rust::Slice<bool> inside) const
{
    require(nodes.size() == 3 * inside.size(), "not one place for each node");
    const auto accessor = mHeld->grid->getConstAccessor();
    for (std::size_t n = 0; n < inside.size(); ++n) {
        inside[n] = accessor.getValue(coord(nodes, n)) < 0.0f;
    }
}

float FloatGrid::background() const
{
    return mHeld->grid->background();
}

bool FloatGrid::is_fog() const
{
    return mHeld->grid->getGridClass() == openvdb::GRID_FOG_VOLUME;
}

Placement FloatGrid::placement() const
{
    return placement_of(*mHeld->grid);
}

} // namespace exocarp::vdb
