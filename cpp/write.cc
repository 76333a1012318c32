#include "exocarp/cpp/grid.h"
#include "exocarp/src/vdb/bridge.rs.h"

#include <openvdb/io/Archive.h>
#include <tbb/task_arena.h>

#include <cerrno>
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

// The archive takes zip off the compression of every grid that says it is a level set or a fog volume, though
// readers take each grid's compression from the file. It asks the grid itself, and then writes the metadata
// of a copy: so only the copy says what this is.
class Zipped : public openvdb::FloatGrid {
public:
    explicit Zipped(const openvdb::FloatGrid& grid)
        : openvdb::FloatGrid(openvdb::ConstPtrCast<TreeType>(grid.constTreePtr()))
    {
        insertMeta(grid);
        setTransform(grid.constTransform().copy());
        mClass = getGridClass();
        clearGridClass();
    }

    openvdb::GridBase::ConstPtr copyGrid() const override
    {
        const auto copy = openvdb::ConstPtrCast<GridBase>(openvdb::FloatGrid::copyGrid());
        copy->setGridClass(mClass);
        return copy;
    }

private:
    openvdb::GridClass mClass;
};

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

void write_file(
    rust::Slice<const std::uint8_t> path,
    const FloatGrid& surface,
    const std::unique_ptr<Int32Grid>& closest,
    Codec codec,
    const rust::Vec<MetaItem>& metadata)
{
    initialize();
    openvdb::GridCPtrVec grids{surface.held().grid};
    if (codec == Codec::Zip) grids[0] = std::make_shared<Zipped>(*surface.held().grid);
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
