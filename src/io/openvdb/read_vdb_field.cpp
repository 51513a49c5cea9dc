// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "controlspace/io/metric_grids.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/metric/blend.h"
#include "controlspace/sources/point_source.h"
#include "io/openvdb/vdb_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

using openvdb::Coord;

/// The voxels around a point, in index space.
class Corners {
public:
    Corners(const openvdb::math::Transform& transform, const openvdb::CoordBBox& voxels,
            const Point& x) {
        Vector fractions;
        const openvdb::Vec3d at = transform.worldToIndex({x.x(), x.y(), x.z()});
        for (int a = 0; a < 3; ++a) {
            const auto i = static_cast<std::size_t>(a);
            // Comparisons that send not-a-number to the low side.
            const double above = at[a] > voxels.min()[i] ? at[a] : voxels.min()[i];
            const double t = above < voxels.max()[i] ? above : voxels.max()[i];
            low_[i] = static_cast<openvdb::Int32>(std::floor(t));
            fractions[a] = t - low_[i];
        }
        weights_ = corner_weights(fractions);
    }
    Coord voxel(int corner) const {
        return low_.offsetBy(corner & 1, corner >> 1 & 1, corner >> 2);
    }
    double weight(int corner) const { return weights_[static_cast<std::size_t>(corner)]; }

private:
    Coord low_;
    std::array<double, 8> weights_;
};

Metric metric_from(const openvdb::Vec3s& diagonal, const openvdb::Vec3s& off_diagonal) {
    return {diagonal[0],     diagonal[1],     diagonal[2],
            off_diagonal[0], off_diagonal[1], off_diagonal[2]};
}

/// Either lengths, or both parts of tensors.
struct Grids {
    openvdb::FloatGrid::ConstPtr lengths;
    openvdb::Vec3SGrid::ConstPtr diagonal;
    openvdb::Vec3SGrid::ConstPtr off_diagonal;

    /// The grid that says which voxels are active.
    const openvdb::GridBase& base() const {
        if (lengths) return *lengths;
        return *diagonal;
    }
};

class VoxelField final : public ControlSpace {
public:
    VoxelField(Grids grids, double elsewhere)
        : grids_(std::move(grids)),
          domain_(active_box(grids_.base())),
          voxels_(grids_.base().evalActiveVoxelBoundingBox()),
          elsewhere_(Metric::isotropic(elsewhere)) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        if (grids_.lengths) {
            const auto nodes = grids_.lengths->getConstUnsafeAccessor();
            interpolate(x, out, [&](const Coord& voxel, Metric& metric) {
                float h = 0;
                if (!nodes.probeValue(voxel, h)) return false;
                metric = Metric::isotropic(h);
                return true;
            });
        } else {
            const auto a = grids_.diagonal->getConstUnsafeAccessor();
            const auto b = grids_.off_diagonal->getConstUnsafeAccessor();
            interpolate(x, out, [&](const Coord& voxel, Metric& metric) {
                openvdb::Vec3s d;
                if (!a.probeValue(voxel, d)) return false;
                metric = metric_from(d, b.getValue(voxel));
                return true;
            });
        }
    }
    Box domain() const override { return domain_; }

private:
    /// `read`(voxel, metric) answers whether the voxel is active, and its metric.
    template <class Read>
    void interpolate(std::span<const Point> x, std::span<Metric> out, const Read& read) const {
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = at(x[i], read);
    }

    template <class Read>
    Metric at(const Point& x, const Read& read) const {
        const Corners corners(grids_.base().transform(), voxels_, x);
        std::array<double, 8> weights;
        std::array<Metric, 8> metrics;
        std::size_t found = 0;
        double sum = 0;
        for (int c = 0; c < 8; ++c) {
            const double w = corners.weight(c);
            if (!(w > 0) || !read(corners.voxel(c), metrics[found])) continue;
            weights[found++] = w;
            sum += w;
        }
        if (found == 0) return elsewhere_;
        if (found == 1) return metrics[0];
        for (std::size_t i = 0; i < found; ++i) weights[i] /= sum;
        return blend_lengths(std::span(weights).first(found),
                             [&](std::size_t i) -> const Metric& { return metrics[i]; });
    }

    Grids grids_;
    Box domain_;
    openvdb::CoordBBox voxels_;
    Metric elsewhere_;
};

std::string name_of(const Coord& voxel) {
    return fmt::format("({}, {}, {})", voxel.x(), voxel.y(), voxel.z());
}

/// As the grids are, or in the unit from which they were scaled.
AnalyticField field_of(Grids grids, double elsewhere, double finest) {
    const double scale = scale_of(grids.base());
    auto field = std::make_shared<VoxelField>(std::move(grids), elsewhere);
    if (scale == 1) return {std::move(field), finest};
    const std::shared_ptr<const ControlSpace> in_unit = scaled(*field, 1 / scale);
    return {{in_unit.get(), [field, in_unit](const ControlSpace*) {}}, finest / scale};
}

AnalyticField tensor_field(const VdbFile& file) {
    for (const std::string_view name : {diagonal_grid, off_diagonal_grid}) {
        if (file.has(name)) continue;
        file.fail("has no grid '{}'; it holds {}: name a grid of lengths or densities", name,
                  file.listing());
    }
    const auto diagonal = file.read_as<openvdb::Vec3SGrid>(diagonal_grid);
    const auto off_diagonal = file.read_as<openvdb::Vec3SGrid>(off_diagonal_grid);
    if (diagonal->transform() != off_diagonal->transform()) {
        file.fail("grids '{}' and '{}' have different transforms: write both alike", diagonal_grid,
                  off_diagonal_grid);
    }
    double finest = largest_magnitude;
    double coarsest = 0;
    std::uint64_t bad = 0;
    std::uint64_t all = 0;
    Coord first_bad;
    const auto check = [&](const openvdb::Vec3s& d, const openvdb::Vec3s& o, const Coord& voxel) {
        const Metric m = metric_from(d, o);
        ++all;
        if (!is_source_metric(m)) {
            if (bad++ == 0) first_bad = voxel;
            return;
        }
        const auto lengths = eigen_frame(m).lengths;
        finest = std::min(finest, lengths[0]);
        coarsest = std::max(coarsest, lengths[2]);
    };
    // Both grids, as a tile of one may lie over voxels of the other.
    const auto other = off_diagonal->getConstAccessor();
    for (auto value = diagonal->cbeginValueOn(); value; ++value) {
        check(*value, other.getValue(value.getCoord()), value.getCoord());
    }
    const auto base = diagonal->getConstAccessor();
    for (auto value = off_diagonal->cbeginValueOn(); value; ++value) {
        openvdb::Vec3s d;
        if (base.probeValue(value.getCoord(), d)) check(d, *value, value.getCoord());
    }
    if (bad > 0) {
        file.fail(
            "{} of {} tensors are not positive definite, first at voxel {}: are "
            "they of lengths, xx yy zz and xy xz yz?",
            bad, all, name_of(first_bad));
    }
    return field_of({nullptr, diagonal, off_diagonal}, coarsest, finest);
}

AnalyticField length_field(const VdbFile& file, const openvdb::FloatGrid::Ptr& grid,
                           const VdbLengths& what) {
    // Lengths of densities are in the unit of the field, the others in that of the grid.
    const double scale = scale_of(*grid);
    double finest = largest_magnitude;
    double coarsest = 0;
    for (auto value = grid->beginValueOn(); value; ++value) {
        const double given = *value;
        if (!std::isfinite(given)) {
            file.fail("grid '{}' holds {} at voxel {}: give finite numbers", what.grid, given,
                      name_of(value.getCoord()));
        }
        const double h = what.density ? scale * length_of_density(given, what.density->finest,
                                                                  what.density->coarsest)
                                      : given;
        if (!is_length(h)) {
            file.fail("grid '{}' holds {} at voxel {}: lengths must be positive", what.grid, given,
                      name_of(value.getCoord()));
        }
        if (what.density) value.setValue(static_cast<float>(h));
        finest = std::min(finest, h);
        coarsest = std::max(coarsest, h);
    }
    return field_of({grid, nullptr, nullptr},
                    what.density ? scale * what.density->coarsest : coarsest, finest);
}

/// The lengths, where write_vdb wrote isotropic metrics and no tensors; or null.
openvdb::FloatGrid::Ptr lengths_alone(const VdbFile& file) {
    if (file.has(diagonal_grid) || file.has(off_diagonal_grid) || !file.has(lengths_grid)) {
        return nullptr;
    }
    auto grid = file.read_as<openvdb::FloatGrid>(lengths_grid);
    const auto note = grid->getMetadata<openvdb::BoolMetadata>(isotropic_note);
    return note && note->value() ? grid : nullptr;
}

}  // namespace

AnalyticField read_vdb_field(const std::filesystem::path& path, const VdbLengths& what) {
    if (what.density && !(is_length(what.density->finest) && is_length(what.density->coarsest))) {
        refuse("lengths {} and {} for densities 1 and 0: give positive ones", what.density->finest,
               what.density->coarsest);
    }
    const VdbFile file(path);
    if (!what.grid.empty()) {
        return length_field(file, file.read_as<openvdb::FloatGrid>(what.grid), what);
    }
    if (what.density) file.fail("name the grid of densities: it holds {}", file.listing());
    if (const auto grid = lengths_alone(file)) {
        return length_field(file, grid, {.grid = std::string(lengths_grid)});
    }
    return tensor_field(file);
}

}  // namespace controlspace
