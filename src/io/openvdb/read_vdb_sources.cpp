// SPDX-License-Identifier: Apache-2.0
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "controlspace/io/read_vdb.h"
#include "io/openvdb/vdb_file.h"

namespace controlspace {
namespace {

using Sampler =
    openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>;

double sample(const Sampler& grid, const Point& x) { return grid.wsSample({x.x(), x.y(), x.z()}); }

Vector gradient_at(const Sampler& grid, const Point& x, double step) {
    Vector gradient;
    for (Axis a = 0; a < 3; ++a) {
        const Vector d = step * Vector::Unit(a);
        gradient[a] = (sample(grid, x + d) - sample(grid, x - d)) / (2 * step);
    }
    return gradient;
}

/// The larger of the two principal curvatures of the grid's isosurface at `x`, without sign.
double largest_curvature(const Sampler& grid, const Point& x, double step) {
    const Vector gradient = gradient_at(grid, x, step);
    const double slope = gradient.norm();
    if (!(slope > 0)) return 0;
    Eigen::Matrix3d second;
    const double centre = sample(grid, x);
    for (Axis a = 0; a < 3; ++a) {
        const Vector da = step * Vector::Unit(a);
        second(a, a) = sample(grid, x + da) - 2 * centre + sample(grid, x - da);
        for (Axis b = 0; b < a; ++b) {
            const Vector db = step * Vector::Unit(b);
            second(a, b) = second(b, a) =
                0.25 * (sample(grid, x + da + db) - sample(grid, x + da - db) -
                        sample(grid, x - da + db) + sample(grid, x - da - db));
        }
    }
    const Vector n = gradient / slope;
    const Eigen::Matrix3d tangential = Eigen::Matrix3d::Identity() - n * n.transpose();
    // Its eigenvalues are the principal curvatures, and 0 along the normal.
    const Eigen::Matrix3d shape = tangential * second * tangential / (slope * step * step);
    const auto curvatures = eigen_frame(Metric::from_matrix(shape)).lengths;
    return std::max(std::abs(curvatures[0]), std::abs(curvatures[2]));
}

std::string grid_of(const VdbFile& file, const VdbSurface& surface) {
    if (!surface.grid.empty()) return surface.grid;
    if (file.grids().size() > 1) file.fail("name one of its grids: it holds {}", file.listing());
    return file.grids().front();
}

double isovalue_of(const VdbFile& file, const openvdb::FloatGrid& grid, const VdbSurface& surface) {
    if (surface.isovalue) return *surface.isovalue;
    switch (grid.getGridClass()) {
        case openvdb::GRID_LEVEL_SET:
            return 0;
        case openvdb::GRID_FOG_VOLUME:
            return 0.5;
        default:
            file.fail("grid '{}' is neither level set nor fog: give the isovalue", grid.getName());
    }
}

void require_finite(const VdbFile& file, const openvdb::FloatGrid& grid) {
    for (auto value = grid.cbeginValueOn(); value; ++value) {
        if (std::isfinite(*value)) continue;
        const openvdb::Coord voxel = value.getCoord();
        file.fail("grid '{}' holds {} at voxel ({}, {}, {}): give finite numbers", grid.getName(),
                  *value, voxel.x(), voxel.y(), voxel.z());
    }
}

/// Voxels that the surface crosses at the borders of tiles, each a cube of many voxels of one value
/// that takes a few bytes of the file: by the values in the middle of what is beside their faces.
double voxels_at_tiles(const openvdb::FloatGrid& grid, double isovalue) {
    const auto values = grid.getConstAccessor();
    double count = 0;
    auto tile = grid.cbeginValueOn();
    tile.setMaxDepth(openvdb::FloatGrid::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        const openvdb::CoordBBox box = tile.getBoundingBox();
        const openvdb::Coord middle = box.min() + (box.dim() >> 1);
        for (std::size_t a = 0; a < 3; ++a) {
            const double face = double(box.dim()[(a + 1) % 3]) * double(box.dim()[(a + 2) % 3]);
            for (const int beside : {box.min()[a] - 1, box.max()[a] + 1}) {
                openvdb::Coord voxel = middle;
                voxel[a] = beside;
                if ((values.getValue(voxel) < isovalue) != (*tile < isovalue)) count += face;
            }
        }
    }
    return count;
}

}  // namespace

std::vector<PointSource> read_vdb_sources(const std::filesystem::path& path,
                                          const VdbSurface& surface) {
    const VdbFile file(path);
    const bool by_curvature = surface.per_radius != 0;
    if (by_curvature == (surface.h != 0) ||
        !is_length(by_curvature ? surface.per_radius : surface.h)) {
        file.fail(
            "a surface has no lengths of its own: give a positive length (--vdb-size), or one in "
            "units of the radius of curvature (--vdb-size-per-radius); a field, as `export` writes "
            "it, is read by --field file --field-file");
    }
    const auto grid = file.read_as<openvdb::FloatGrid>(grid_of(file, surface));
    require_finite(file, *grid);
    const double isovalue = isovalue_of(file, *grid, surface);
    constexpr double most =
        2e6;  // a few seconds, and less than the memory of a small file's reader
    if (const double count = voxels_at_tiles(*grid, isovalue); count > most) {
        file.fail(
            "grid '{}' has a surface of some {:.0f} million voxels at the borders of tiles, {:.0f} "
            "can be read: resample it to larger voxels",
            grid->getName(), count / 1e6, most / 1e6);
    }

    std::vector<openvdb::Vec3s> vertices;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*grid, vertices, quads, isovalue);
    if (vertices.empty()) {
        file.fail("grid '{}' has no surface at {}: give another isovalue", grid->getName(),
                  isovalue);
    }
    const openvdb::Vec3d edges = grid->voxelSize();
    const double voxel = std::min({edges.x(), edges.y(), edges.z()});
    const double coarsest = active_box(*grid).half_diagonal();

    std::vector<PointSource> sources(vertices.size());
    constexpr std::size_t points_per_task = 1024;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices.size(), points_per_task),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          const auto nodes = grid->getConstAccessor();
                          const Sampler sampler(nodes, grid->transform());
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                              Point x(vertices[i].x(), vertices[i].y(), vertices[i].z());
                              // The mesh's vertices lie near the surface: one step of Newton's,
                              // within the voxel.
                              const Vector gradient = gradient_at(sampler, x, voxel);
                              const double slope = gradient.norm();
                              if (slope > 0) {
                                  const double way = (isovalue - sample(sampler, x)) / slope;
                                  x += std::clamp(way, -voxel, voxel) / slope * gradient;
                              }
                              double h = surface.h;
                              if (by_curvature) {
                                  h = surface.per_radius / largest_curvature(sampler, x, voxel);
                                  h = std::clamp(h, voxel, coarsest);
                              }
                              sources[i] = {x, Metric::isotropic(h)};
                          }
                      });
    const double scale = scale_of(*grid);
    for (PointSource& source : sources) {
        if (scale == 1) break;
        source.position /= scale;
        if (by_curvature) source.metric = (1 / scale) * source.metric;
    }
    return sources;
}

}  // namespace controlspace
