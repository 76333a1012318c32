#include "exocarp/cpp/grid.h"
#include "exocarp/src/vdb/bridge.rs.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>

#include <fstream>
#include <stdexcept>

namespace exocarp::vdb {

namespace {

using openvdb::GridBase;
using openvdb::io::GridDescriptor;

[[noreturn]] void truncated()
{
    throw std::runtime_error("the file ends too early");
}

// io::File does not look at the stream's state and takes whatever is in memory for what a truncated
// file lacks. This reads the same on a stream that throws, and never with delayed loading.
class Reader : public openvdb::io::Archive {
public:
    explicit Reader(const std::string& path) : mStream(path, std::ios::in | std::ios::binary)
    {
        if (!mStream) throw std::runtime_error("it cannot be opened");
        mStream.exceptions(std::ios::badbit | std::ios::failbit);
        mStream.seekg(0, std::ios::end);
        mSize = mStream.tellg();
        mStream.seekg(0);

        readHeader(mStream);
        mMetadata.reset(new openvdb::io::StreamMetadata);
        mMetadata->setSeekable(true);
        openvdb::io::setStreamMetadataPtr(mStream, mMetadata, /*transfer=*/false);
        setFormatVersion(mStream);
        setLibraryVersion(mStream);
        setDataCompression(mStream);
        meta.readMeta(mStream);
        read_descriptors();
    }

    std::size_t size() const { return mEntries.size(); }
    const GridDescriptor& descriptor(std::size_t n) const { return mEntries.at(n).descriptor; }

    GridBase::Ptr load(std::size_t n)
    {
        const Entry& entry = mEntries.at(n);
        GridBase::Ptr grid = entry.grid;
        if (!grid) {
            entry.descriptor.seekToGrid(mStream);
            grid = create(entry.descriptor);
            readGrid(grid, entry.descriptor, mStream);
        }
        if (entry.descriptor.isInstance()) grid->setTree(load(parent(n))->baseTreePtr());
        return grid;
    }

    // All but the leaves' values.
    GridBase::Ptr load_topology(std::size_t n)
    {
        const Entry& entry = mEntries.at(n);
        if (entry.grid || entry.descriptor.isInstance()) return load(n);
        entry.descriptor.seekToGrid(mStream);
        GridBase::Ptr grid = create(entry.descriptor);
        readGridCompression(mStream);
        grid->readMeta(mStream);
        grid->readTransform(mStream);
        grid->readTopology(mStream);
        return grid;
    }

    openvdb::MetaMap meta;

private:
    struct Entry {
        GridDescriptor descriptor;
        // Only of a file without offsets, which must be read from end to end.
        GridBase::Ptr grid;
    };

    static GridBase::Ptr create(const GridDescriptor& descriptor)
    {
        GridBase::Ptr grid = GridBase::createGrid(descriptor.gridType());
        grid->setSaveFloatAsHalf(descriptor.saveFloatAsHalf());
        return grid;
    }

    void read_descriptors()
    {
        const std::int32_t count = readGridCount(mStream);
        for (std::int32_t n = 0; n < count; ++n) {
            Entry entry;
            GridBase::Ptr grid = entry.descriptor.read(mStream);
            if (!inputHasGridOffsets()) {
                readGrid(grid, entry.descriptor, mStream);
                entry.grid = grid;
            } else {
                const std::int64_t end = entry.descriptor.getEndPos();
                if (end > mSize || end <= mStream.tellg()) truncated();
                entry.descriptor.seekToEnd(mStream);
            }
            mEntries.push_back(entry);
        }
    }

    // The grid whose tree an instance shares. It comes first and is no instance itself.
    std::size_t parent(std::size_t n) const
    {
        for (std::size_t p = 0; p < mEntries.size(); ++p) {
            const GridDescriptor& d = mEntries[p].descriptor;
            if (d.uniqueName() == mEntries[n].descriptor.instanceParentName() && !d.isInstance()) return p;
        }
        throw std::runtime_error("a grid shares the tree of one that is missing");
    }

    std::ifstream mStream;
    std::int64_t mSize = 0;
    openvdb::io::StreamMetadata::Ptr mMetadata;
    std::vector<Entry> mEntries;
};

// Runs `read` on the file, with sentences for what a damaged file makes the library throw.
template <class Read>
auto with_file(rust::Slice<const std::uint8_t> path, Read read)
{
    initialize();
    try {
        Reader reader(path_string(path));
        return read(reader);
    } catch (const std::ios_base::failure&) {
        truncated();
    } catch (const std::bad_alloc&) {
        throw std::runtime_error("the file is damaged or does not fit into memory");
    } catch (const std::length_error&) {
        throw std::runtime_error("the file is damaged");
    }
}

rust::Vec<MetaItem> items(const openvdb::MetaMap& map)
{
    rust::Vec<MetaItem> list;
    for (auto it = map.beginMeta(); it != map.endMeta(); ++it) {
        MetaItem item{};
        item.name = text(it->first);
        item.kind = MetaKind::Text;
        item.text = text(it->second->str());
        // Text has six digits only.
        if (const auto* real = dynamic_cast<const openvdb::DoubleMetadata*>(it->second.get())) {
            item.kind = MetaKind::Real;
            item.real = real->value();
        } else if (const auto* integer = dynamic_cast<const openvdb::Int64Metadata*>(it->second.get())) {
            item.kind = MetaKind::Integer;
            item.integer = integer->value();
        }
        list.push_back(std::move(item));
    }
    return list;
}

void describe(GridEntry& entry, const GridBase& grid)
{
    entry.grid_class = text(GridBase::gridClassToString(grid.getGridClass()));
    if (const auto background = grid.constBaseTree().getBackgroundValue()) {
        entry.background = text(background->str());
    }
    entry.placement = placement_of(grid);
    entry.active_voxels = grid.activeVoxelCount();
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    for (int axis = 0; axis < 3; ++axis) {
        entry.bbox[axis] = box.min()[axis];
        entry.bbox[3 + axis] = box.max()[axis];
    }
    entry.metadata = items(grid);
}

template <class T>
std::shared_ptr<Held<T>> load_typed(rust::Slice<const std::uint8_t> path, std::size_t number)
{
    using Grid = typename Held<T>::Grid;
    const GridBase::Ptr grid = with_file(path, [&](Reader& reader) { return reader.load(number); });
    const auto typed = openvdb::gridPtrCast<Grid>(grid);
    if (!typed) throw std::runtime_error("a grid is not of the type that the file names");
    return std::make_shared<Held<T>>(typed);
}

} // namespace

Contents read_contents(rust::Slice<const std::uint8_t> path, Depth depth)
{
    return with_file(path, [&](Reader& reader) {
        Contents contents{};
        contents.format = reader.fileVersion();
        contents.library = text(reader.version());
        contents.metadata = items(reader.meta);
        for (std::size_t n = 0; n < reader.size(); ++n) {
            GridEntry entry{};
            entry.name = text(GridDescriptor::nameAsString(reader.descriptor(n).uniqueName()));
            entry.value_type = text(GridBase::createGrid(reader.descriptor(n).gridType())->valueType());
            if (depth == Depth::Topology) describe(entry, *reader.load_topology(n));
            contents.grids.push_back(std::move(entry));
        }
        return contents;
    });
}

std::unique_ptr<FloatGrid> read_float_grid(rust::Slice<const std::uint8_t> path, std::size_t number)
{
    return std::make_unique<FloatGrid>(load_typed<float>(path, number));
}

std::unique_ptr<Int32Grid> read_int32_grid(rust::Slice<const std::uint8_t> path, std::size_t number)
{
    return std::make_unique<Int32Grid>(load_typed<std::int32_t>(path, number));
}

} // namespace exocarp::vdb
