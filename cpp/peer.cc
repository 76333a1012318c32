// OpenVDB's own tools for offsets, as a user of OpenVDB would call them: what `exocarp compare` measures.
#include "exocarp/cpp/grid.h"
#include "exocarp/src/vdb/bridge.rs.h"

#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <limits>
#include <stdexcept>

namespace exocarp::vdb {

struct HeldPolygons {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
};

static_assert(sizeof(openvdb::Vec3s) == 3 * sizeof(float), "points cross as flat slices");
static_assert(sizeof(openvdb::Vec3I) == 3 * sizeof(std::uint32_t), "triangles cross as flat slices");
static_assert(sizeof(openvdb::Vec4I) == 4 * sizeof(std::uint32_t), "quads cross as flat slices");

std::unique_ptr<FloatGrid> mesh_band(
    double voxel,
    rust::Slice<const float> points,
    rust::Slice<const std::uint32_t> triangles,
    float exterior,
    float interior,
    std::int32_t threads)
{
    using Adapter = openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I>;
    if (points.size() % 3 != 0 || triangles.size() % 3 != 0) {
        throw std::invalid_argument("points and triangles come in threes");
    }
    for (const std::uint32_t vertex : triangles) {
        if (vertex >= points.size() / 3) throw std::invalid_argument("a triangle names no point");
    }
    initialize();
    // Flat arrays of three numbers each, as the assertions above say.
    const Adapter mesh(
        reinterpret_cast<const openvdb::Vec3s*>(points.data()),
        points.size() / 3,
        reinterpret_cast<const openvdb::Vec3I*>(triangles.data()),
        triangles.size() / 3);
    const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
    openvdb::FloatGrid::Ptr grid;
    tbb::task_arena arena(threads);
    arena.execute([&] {
        grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *transform, exterior, interior);
    });
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    return std::make_unique<FloatGrid>(std::make_shared<Held<float>>(grid));
}

void FloatGrid::filter_offset(float distance, Scheme scheme, std::int32_t threads)
{
    mHeld->forget_leaves();
    tbb::task_arena arena(threads);
    arena.execute([&] {
        openvdb::tools::LevelSetFilter<openvdb::FloatGrid> filter(*mHeld->grid);
        if (scheme == Scheme::Weno5) {
            filter.setSpatialScheme(openvdb::math::HJWENO5_BIAS);
            filter.setTemporalScheme(openvdb::math::TVD_RK3);
        } else {
            filter.setSpatialScheme(openvdb::math::FIRST_BIAS);
            filter.setTemporalScheme(openvdb::math::TVD_RK1);
        }
        filter.offset(distance);
    });
}

std::unique_ptr<Polygons> FloatGrid::contour(double iso, std::int32_t threads) const
{
    auto held = std::make_shared<HeldPolygons>();
    tbb::task_arena arena(threads);
    arena.execute([&] {
        openvdb::tools::volumeToMesh(
            *mHeld->grid, held->points, held->triangles, held->quads, iso, /*adaptivity=*/0.0);
    });
    if (held->points.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw std::length_error("more than 2^32 points");
    }
    return std::make_unique<Polygons>(std::move(held));
}

Polygons::Polygons(std::shared_ptr<HeldPolygons> held) : mHeld(std::move(held)) {}

std::size_t Polygons::point_count() const { return mHeld->points.size(); }
std::size_t Polygons::triangle_count() const { return mHeld->triangles.size(); }
std::size_t Polygons::quad_count() const { return mHeld->quads.size(); }

void Polygons::read(
    rust::Slice<float> points,
    rust::Slice<std::uint32_t> triangles,
    rust::Slice<std::uint32_t> quads) const
{
    if (points.size() != 3 * point_count() || triangles.size() != 3 * triangle_count()
        || quads.size() != 4 * quad_count()) {
        throw std::invalid_argument("the slices do not have the lengths of the polygons");
    }
    const auto copy = [](auto slice, const auto& from) {
        if (!from.empty()) std::memcpy(slice.data(), from.data(), from.size() * sizeof(from[0]));
    };
    copy(points, mHeld->points);
    copy(triangles, mHeld->triangles);
    copy(quads, mHeld->quads);
}

} // namespace exocarp::vdb
