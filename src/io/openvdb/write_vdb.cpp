// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/write_vdb.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/openvdb.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

#include "controlspace/input_errors.h"
#include "io/openvdb/vdb_builder.h"
#include "io/openvdb/vdb_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

using Builders = std::vector<std::unique_ptr<VdbBuilder>>;
constexpr std::int32_t side = SampledBlock::side;

std::vector<MetricGrid> chosen_grids(const std::vector<std::string>& names) {
    const auto known = metric_grids();
    if (names.empty()) return {known.begin(), known.end()};
    std::vector<MetricGrid> chosen;
    for (const std::string& name : names) {
        const auto named = [&](const MetricGrid& grid) { return grid.name == name; };
        const auto grid = std::find_if(known.begin(), known.end(), named);
        if (grid == known.end()) {
            std::vector<std::string_view> all;
            for (const MetricGrid& g : known) all.push_back(g.name);
            refuse("unknown grid '{}': give {}", name, fmt::join(all, ", "));
        }
        if (std::none_of(chosen.begin(), chosen.end(), named)) chosen.push_back(*grid);
    }
    return chosen;
}

struct Extremes {
    double finest = std::numeric_limits<double>::infinity();  ///< of the smallest lengths
    double coarsest = 0;                                      ///< of the smallest lengths
    double longest = 0;                                       ///< of all lengths
    bool isotropic = true;

    void add(const Extremes& other) {
        finest = std::min(finest, other.finest);
        coarsest = std::max(coarsest, other.coarsest);
        longest = std::max(longest, other.longest);
        isotropic &= other.isotropic;
    }
};

/// Samples all blocks. Returns the bytes of the grids, and what the lengths are.
std::pair<std::size_t, Extremes> fill(const Builders& builders, const ControlSpace& field,
                                      const VoxelLattice& lattice, const VdbOptions& options) {
    const auto blocks = [&](std::size_t axis) -> std::int64_t {
        return (lattice.counts[axis] + side - 1) / side;
    };
    const std::int64_t in_layer = blocks(1) * blocks(2), count = blocks(0) * in_layer;
    struct Scratch {
        SampledBlock block;
        std::array<EigenFrame, SampledBlock::size> frames;
        Extremes extremes;
    };
    tbb::combinable<std::unique_ptr<Scratch>> scratches([] { return std::make_unique<Scratch>(); });
    std::atomic<std::size_t> bytes = 0;
    std::mutex mutex;  // of the progress
    std::int64_t done = 0;
    tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t b) {
        Scratch& s = *scratches.local();
        const std::array<std::int64_t, 3> place{b / in_layer, b / blocks(2) % blocks(1),
                                                b % blocks(2)};
        std::array<std::int32_t, 3> first, inside;
        for (std::size_t a = 0; a < 3; ++a) {
            first[a] = static_cast<std::int32_t>(place[a]) * side;
            inside[a] = std::min(side, lattice.counts[a] - first[a]);
        }
        // A thread that waits for its part of the field must not take up another block, whose
        // scratch would be the same.
        tbb::this_task_arena::isolate(
            [&] { sample_block(field, lattice, first, options.tolerance, s.block); });
        for (std::size_t v = 0; v < SampledBlock::size; ++v) {
            if (s.block.same_as[v] != v) continue;
            s.frames[v] = eigen_frame(s.block.metrics[v]);
            const auto& lengths = s.frames[v].lengths;
            s.extremes.add({lengths[0], lengths[0], lengths[2], is_isotropic(s.block.metrics[v])});
        }
        for (const auto& builder : builders)
            bytes += builder->add(first, inside, s.block, s.frames);
        if (bytes > options.max_bytes) {
            throw MemoryLimitError(
                bytes,
                fmt::format(
                    "grids of {} x {} x {} voxels take more memory than {} bytes: raise the voxel "
                    "(--voxel), the tolerance, or the cap (--max-memory), or write fewer grids",
                    lattice.counts[0], lattice.counts[1], lattice.counts[2], options.max_bytes));
        }
        const std::lock_guard lock(mutex);
        if (++done % in_layer != 0 || !options.progress) return;
        const auto all = static_cast<std::size_t>(lattice.size());
        options.progress(
            all * static_cast<std::size_t>(done / in_layer) / static_cast<std::size_t>(blocks(0)),
            all);
    });
    Extremes extremes;
    scratches.combine_each([&](const std::unique_ptr<Scratch>& s) { extremes.add(s->extremes); });
    return {bytes, extremes};
}

void require_numbers_hold(const Extremes& lengths, bool half) {
    const double most = half ? 65504 : static_cast<double>(std::numeric_limits<float>::max());
    const double least = half ? 6.2e-5 : static_cast<double>(std::numeric_limits<float>::min());
    if (lengths.finest < least || lengths.longest > most) {
        refuse(
            "lengths from {:.3g} to {:.3g} do not fit the file's numbers, from {:.3g} "
            "to {:.3g}: {}",
            lengths.finest, lengths.longest, least, most,
            half ? "leave out --half" : "use another unit of length");
    }
}

/// Smallest lengths, in place, to what the fog is.
void make_density(openvdb::FloatGrid& grid, const Extremes& lengths) {
    const auto density = [&](float h) {
        return static_cast<float>(
            density_of(static_cast<double>(h), lengths.finest, lengths.coarsest));
    };
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(grid.tree());
    leaves.foreach ([&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) {
        for (auto value = leaf.beginValueOn(); value; ++value) value.setValue(density(*value));
    });
    auto tile = grid.tree().beginValueOn();
    tile.setMaxDepth(openvdb::FloatTree::ValueOnIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) tile.setValue(density(*tile));
    grid.insertMeta("h_at_1", openvdb::DoubleMetadata(lengths.finest));
    grid.insertMeta("h_at_0", openvdb::DoubleMetadata(lengths.coarsest));
}

openvdb::math::Transform::Ptr transform_of(const VoxelLattice& lattice) {
    auto transform = openvdb::math::Transform::createLinearTransform(lattice.voxel);
    // Whole indices are the centres of voxels.
    const Point first = lattice.domain.low.array() + 0.5 * lattice.voxel;
    transform->postTranslate({first.x(), first.y(), first.z()});
    return transform;
}

void annotate(openvdb::GridBase& grid, const Box& domain, bool isotropic,
              const VdbOptions& options) {
    const auto corner_of = [](const Point& x) {
        return openvdb::Vec3DMetadata({x.x(), x.y(), x.z()});
    };
    grid.setCreator("controlspace");
    grid.insertMeta("domain_low", corner_of(domain.low));
    grid.insertMeta("domain_high", corner_of(domain.high));
    grid.insertMeta(isotropic_note, openvdb::BoolMetadata(isotropic));
    grid.insertMeta("tolerance", openvdb::DoubleMetadata(options.tolerance));
    for (const auto& [name, value] : options.notes) {
        if (const double* number = std::get_if<double>(&value)) {
            grid.insertMeta(name, openvdb::DoubleMetadata(*number));
        } else {
            grid.insertMeta(name, openvdb::StringMetadata(std::get<std::string>(value)));
        }
    }
    grid.setSaveFloatAsHalf(options.half);
}

/// Lets grids that hold the same have one tree, which the file then keeps once.
void share_trees(const std::vector<MetricGrid>& kinds, const openvdb::GridPtrVec& grids) {
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        for (std::size_t j = 0; j < kinds.size(); ++j) {
            if (kinds[j].name == kinds[i].isotropic_twin)
                grids[i]->setTree(grids[j]->baseTreePtr());
        }
    }
}

/// Of isotropic metrics all other grids would hold the same again, or nothing.
void leave_lengths(std::vector<MetricGrid>& kinds, Builders& builders) {
    for (std::size_t i = kinds.size(); i-- > 0;) {
        if (kinds[i].kind == GridKind::fog || kinds[i].name == lengths_grid) continue;
        kinds.erase(kinds.begin() + static_cast<std::ptrdiff_t>(i));
        builders.erase(builders.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

/// The power of ten by which a voxel is multiplied: 1 where OpenVDB can have it as it is, whose
/// transforms have a volume of more than 3e-15.
double scale_of(double voxel) {
    constexpr double smallest = 2e-5;
    return voxel < smallest ? std::pow(10, std::ceil(-std::log10(voxel))) : 1;
}

VdbReport write_scaled(const std::filesystem::path& path, const ControlSpace& field,
                       const Box& domain, VdbOptions options, double scale) {
    const auto larger = scaled(field, scale);
    for (PointSource& s : options.sources) {
        s = {scale * s.position, scale * s.metric, s.growth};
    }
    options.voxel *= scale;
    options.notes.emplace_back(scale_note, scale);
    VdbReport report = write_vdb(path, *larger, {scale * domain.low, scale * domain.high}, options);
    report.scale = scale;
    for (double* length : {&report.voxel, &report.finest, &report.coarsest}) *length /= scale;
    return report;
}

}  // namespace

VdbReport write_vdb(const std::filesystem::path& path, const ControlSpace& field, const Box& domain,
                    const VdbOptions& options) {
    const double voxel = voxel_lattice(domain, options.voxel).voxel;
    const double scale = scale_of(voxel);
    if (scale != 1) return write_scaled(path, field, domain, options, scale);
    if (!std::isfinite(options.tolerance) || options.tolerance < 0) {
        refuse("a tolerance of {}: give a finite one, 0 or more", options.tolerance);
    }
    std::vector<MetricGrid> kinds = chosen_grids(options.grids);
    const VoxelLattice lattice = voxel_lattice(domain, options.voxel);
    openvdb::initialize();

    Builders builders;
    for (const MetricGrid& kind : kinds) builders.push_back(make_vdb_builder(kind));
    const auto [bytes, extremes] = fill(builders, field, lattice, options);
    require_numbers_hold(extremes, options.half);
    if (options.grids.empty() && extremes.isotropic) leave_lengths(kinds, builders);

    VdbReport report{.voxel = lattice.voxel,
                     .counts = lattice.counts,
                     .finest = extremes.finest,
                     .coarsest = extremes.coarsest,
                     .memory = bytes};
    const auto transform = transform_of(lattice);
    openvdb::GridPtrVec grids;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        const double kept = static_cast<double>(builders[i]->voxels());
        report.kept = std::max(report.kept, kept / lattice.size());
        grids.push_back(builders[i]->finish());
        if (kinds[i].kind == GridKind::fog) {
            make_density(*openvdb::gridPtrCast<openvdb::FloatGrid>(grids[i]), extremes);
        }
    }
    if (extremes.isotropic) share_trees(kinds, grids);
    if (!options.sources.empty()) {
        grids.push_back(make_points_grid(options.sources, *transform));
    }
    for (const openvdb::GridBase::Ptr& grid : grids) {
        grid->setTransform(transform->copy());
        annotate(*grid, domain, extremes.isotropic, options);
    }
    report.file = write_vdb_file(path, {grids.begin(), grids.end()}, options.compression);
    return report;
}

VdbReport write_vdb(const std::filesystem::path& path, const ControlSpace& space,
                    const VdbOptions& options) {
    return write_vdb(path, space, space.domain(), options);
}

}  // namespace controlspace
