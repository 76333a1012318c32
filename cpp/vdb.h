// The functions behind src/vdb/bridge.rs. Light: no header of OpenVDB is included here.
#pragma once

#include "rust/cxx.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace exocarp::vdb {

// Shared with Rust; defined by the generated header.
enum class Codec : std::uint8_t;
enum class Depth : std::uint8_t;
enum class Scheme : std::uint8_t;
struct Contents;
struct Counts;
struct MetaItem;
struct Placement;

// OpenVDB's grid; defined in grid.h.
template <class T>
struct Held;

// The polygons of a contoured grid; defined in peer.cc.
struct HeldPolygons;
class Polygons {
public:
    explicit Polygons(std::shared_ptr<HeldPolygons> held);

    std::size_t point_count() const;
    std::size_t triangle_count() const;
    std::size_t quad_count() const;
    void read(
        rust::Slice<float> points,
        rust::Slice<std::uint32_t> triangles,
        rust::Slice<std::uint32_t> quads) const;

private:
    std::shared_ptr<HeldPolygons> mHeld;
};

// What grids of all value types can do.
template <class T>
class LeafGrid {
public:
    explicit LeafGrid(std::shared_ptr<Held<T>> held);

    void insert(
        rust::Slice<const std::int32_t> origins,
        rust::Slice<const T> values,
        rust::Slice<const std::uint64_t> active);
    std::size_t leaf_count() const;
    Counts counts() const;
    rust::Vec<std::int32_t> leaf_origins() const;
    void read(std::size_t first, rust::Slice<T> values, rust::Slice<std::uint64_t> active) const;

    const Held<T>& held() const { return *mHeld; }

protected:
    void take(const LeafGrid& other);

    std::shared_ptr<Held<T>> mHeld;
};

class FloatGrid : public LeafGrid<float> {
public:
    using LeafGrid::LeafGrid;

    void append(const FloatGrid& other) { take(other); }
    void fill(
        rust::Slice<const std::int32_t> origins,
        rust::Slice<const std::uint32_t> sides,
        float value);
    void prune();
    void inside(rust::Slice<const std::int32_t> nodes, rust::Slice<bool> inside) const;
    float background() const;
    bool is_fog() const;
    Placement placement() const;
    rust::String check(std::uint8_t test, std::int32_t threads) const;
    std::unique_ptr<FloatGrid> half_copy(float background) const;
    void filter_offset(float distance, Scheme scheme, std::int32_t threads);
    std::unique_ptr<Polygons> contour(double iso, std::int32_t threads) const;
};

class Int32Grid : public LeafGrid<std::int32_t> {
public:
    using LeafGrid::LeafGrid;

    void append(const Int32Grid& other) { take(other); }
};

std::unique_ptr<FloatGrid> new_float_grid(double voxel, float background, rust::Str creator);
std::unique_ptr<Int32Grid> new_int32_grid(double voxel, rust::Str name, rust::Str creator);

std::unique_ptr<FloatGrid> mesh_band(
    double voxel,
    rust::Slice<const float> points,
    rust::Slice<const std::uint32_t> triangles,
    float exterior,
    float interior,
    std::int32_t threads);

void write_file(
    rust::Slice<const std::uint8_t> path,
    const FloatGrid& surface,
    const std::unique_ptr<Int32Grid>& closest,
    Codec codec,
    const rust::Vec<MetaItem>& metadata);

Contents read_contents(rust::Slice<const std::uint8_t> path, Depth depth);
std::unique_ptr<FloatGrid> read_float_grid(rust::Slice<const std::uint8_t> path, std::size_t number);
std::unique_ptr<Int32Grid> read_int32_grid(rust::Slice<const std::uint8_t> path, std::size_t number);

} // namespace exocarp::vdb
