#include "exocarp/cpp/grid.h"
#include "exocarp/src/vdb/bridge.rs.h"

#include <openvdb/io/Archive.h>
#include <openvdb/tools/ChangeBackground.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace exocarp::vdb {

namespace {

// io::File::write does not look at the stream's state, so that a full disk would go unnoticed. This
// is the same (a seekable archive with grid offsets) on a stream that throws.
class Writer : public openvdb::io::Archive {
public:
    void write_to(const std::string& path, const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& meta)
    {
        errno = 0;
        std::ofstream out(path, std::ios::out | std::ios::binary | std::ios::trunc);
        if (!out) fail();
        out.exceptions(std::ios::badbit | std::ios::failbit);
        try {
            Archive::write(static_cast<std::ostream&>(out), grids, /*seekable=*/true, meta);
            out.close();
        } catch (const std::ios_base::failure&) {
            fail();
        }
    }

private:
    // The library hides what the system said; errno of the failed call is still there.
    [[noreturn]] static void fail()
    {
        const int code = errno != 0 ? errno : EIO;
        throw std::runtime_error(std::generic_category().message(code));
    }
};

std::uint32_t flags(Codec codec)
{
    using namespace openvdb::io;
    switch (codec) {
    case Codec::Blosc:
        if (!Archive::hasBloscCompression()) {
            throw std::runtime_error("this OpenVDB was built without Blosc, use zip or none");
        }
        return COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK;
    case Codec::Zip:
        if (!Archive::hasZLibCompression()) {
            throw std::runtime_error("this OpenVDB was built without zlib, use blosc or none");
        }
        return COMPRESS_ZIP | COMPRESS_ACTIVE_MASK;
    default: return COMPRESS_ACTIVE_MASK;
    }
}

// The class of a grid: unknown, until the grid is copied.
//
// The archive takes zip off the compression of every grid that says it is a level set or a fog volume, though
// readers take each grid's compression from the file. It asks the grid itself, and then writes the metadata
// of a copy: so only the copy says what this is. (A class derived from FloatGrid could do that as well, but it
// takes four times as long to compile.)
class ClassOfCopies : public openvdb::StringMetadata {
public:
    // The first `copies` generations of copies are still unknown.
    ClassOfCopies(std::string name, int copies)
        : openvdb::StringMetadata(openvdb::GridBase::gridClassToString(openvdb::GRID_UNKNOWN))
        , mName(std::move(name))
        , mCopies(copies)
    {
    }

    openvdb::Metadata::Ptr copy() const override
    {
        if (mCopies > 0) return std::make_shared<ClassOfCopies>(mName, mCopies - 1);
        return std::make_shared<openvdb::StringMetadata>(mName);
    }

private:
    std::string mName;
    int mCopies;
};

// The same grid, which the archive compresses with zip.
openvdb::GridBase::ConstPtr zipped(const openvdb::GridBase& grid)
{
    const auto copy = openvdb::ConstPtrCast<openvdb::GridBase>(grid.copyGrid());
    const std::string name = openvdb::GridBase::gridClassToString(grid.getGridClass());
    // What a grid is given it copies once.
    copy->insertMeta(openvdb::GridBase::META_GRID_CLASS, ClassOfCopies(name, 1));
    return copy;
}

openvdb::MetaMap meta_map(const rust::Vec<MetaItem>& items)
{
    openvdb::MetaMap map;
    for (const MetaItem& item : items) {
        const std::string name(item.name);
        switch (item.kind) {
        case MetaKind::Real: map.insertMeta(name, openvdb::DoubleMetadata(item.real)); break;
        case MetaKind::Integer: map.insertMeta(name, openvdb::Int64Metadata(item.integer)); break;
        default: map.insertMeta(name, openvdb::StringMetadata(std::string(item.text)));
        }
    }
    return map;
}

} // namespace

std::unique_ptr<FloatGrid> FloatGrid::half_copy(float background) const
{
    // The smallest half float; anything smaller would become 0 and lose its sign.
    constexpr float SMALLEST = 5.9604645e-8f;
    const auto copy = openvdb::gridPtrCast<openvdb::FloatGrid>(mHeld->grid->deepCopyGrid());
    openvdb::tools::changeLevelSetBackground(copy->tree(), background, THREADED);
    std::vector<Held<float>::Leaf*> leaves;
    copy->tree().getNodes(leaves);
    for (auto* leaf : leaves) {
        for (auto value = leaf->beginValueOn(); value; ++value) {
            value.setValue(std::copysign(std::max(std::abs(*value), SMALLEST), *value));
        }
    }
    copy->setSaveFloatAsHalf(true);
    return std::make_unique<FloatGrid>(std::make_shared<Held<float>>(copy));
}

void write_file(
    rust::Slice<const std::uint8_t> path,
    const FloatGrid& surface,
    const std::unique_ptr<Int32Grid>& closest,
    Codec codec,
    const rust::Vec<MetaItem>& metadata)
{
    initialize();
    openvdb::GridCPtrVec grids{surface.held().grid};
    if (codec == Codec::Zip) grids[0] = zipped(*surface.held().grid);
    if (closest) grids.push_back(closest->held().grid);
    const openvdb::MetaMap map = meta_map(metadata);
    Writer writer;
    writer.setCompression(flags(codec));
    writer.setGridStatsMetadataEnabled(true);
    // The statistics are counted with threads of TBB's own otherwise.
    tbb::task_arena arena(1);
    arena.execute([&] { writer.write_to(path_string(path), grids, map); });
}

} // namespace exocarp::vdb
