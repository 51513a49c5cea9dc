#include "controlspace/io/write_vdb.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/openvdb.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "controlspace/error.h"
#include "controlspace/space/space_field.h"
#include "io/openvdb/vdb_builder.h"
#include "io/openvdb/vdb_file.h"
#include "io/openvdb/vdb_points.h"

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
            throw InputError(fmt::format("unknown grid '{}': give {}", name, fmt::join(all, ", ")));
        }
        if (std::none_of(chosen.begin(), chosen.end(), named)) chosen.push_back(*grid);
    }
    return chosen;
}

/// Lengths from `finest` to `coarsest`, of a field.
struct Range {
    double finest = std::numeric_limits<double>::infinity();
    double coarsest = 0;

    void add(const Range& other) {
        finest = std::min(finest, other.finest);
        coarsest = std::max(coarsest, other.coarsest);
    }
};

struct Extremes {
    Range smallest;  ///< of the smallest lengths
    Range all;
    bool isotropic = true;

    void add(const Metric& m, const EigenFrame& frame) {
        const double h = frame.lengths[0];
        smallest.add({h, h});
        all.add({h, frame.lengths[2]});
        isotropic &= is_isotropic(m);
    }
    void add(const Extremes& other) {
        smallest.add(other.smallest);
        all.add(other.all);
        isotropic &= other.isotropic;
    }
};

/// Samples the blocks layer by layer of x, so that no more than a layer is held beside the grids.
Extremes fill(const Builders& builders, const MetricField& field, const VoxelLattice& lattice,
              const VdbOptions& options) {
    const auto blocks = [&](std::size_t axis) { return (lattice.counts[axis] + side - 1) / side; };
    const std::int32_t rows = blocks(1);
    const std::int32_t columns = blocks(2);
    struct Scratch {
        SampledBlock block;
        std::array<EigenFrame, SampledBlock::size> frames;
        Extremes extremes;
    };
    tbb::combinable<std::unique_ptr<Scratch>> scratches([] { return std::make_unique<Scratch>(); });
    for (std::int32_t layer = 0; layer < blocks(0); ++layer) {
        const std::int32_t in_layer = rows * columns;
        for (const auto& builder : builders) {
            builder->start_layer(static_cast<std::size_t>(in_layer));
        }
        tbb::parallel_for(std::int32_t{0}, in_layer, [&](std::int32_t b) {
            Scratch& s = *scratches.local();
            const std::array first{layer * side, b / columns * side, b % columns * side};
            std::array<std::int32_t, 3> inside;
            for (std::size_t a = 0; a < 3; ++a) {
                inside[a] = std::min(side, lattice.counts[a] - first[a]);
            }
            // A thread that waits for its part of the field must not take up another block, whose
            // scratch would be the same.
            tbb::this_task_arena::isolate(
                [&] { sample_block(field, lattice, first, options.tolerance, s.block); });
            for (std::size_t v = 0; v < SampledBlock::size; ++v) {
                if (s.block.same_as[v] != v) continue;
                s.frames[v] = eigen_frame(s.block.metrics[v]);
                s.extremes.add(s.block.metrics[v], s.frames[v]);
            }
            for (const auto& builder : builders) {
                builder->fill(static_cast<std::size_t>(b), first, inside, s.block, s.frames);
            }
        });
        std::size_t bytes = 0;
        for (const auto& builder : builders) {
            builder->finish_layer();
            bytes += builder->bytes();
        }
        if (bytes > options.max_bytes) {
            throw InputError(fmt::format(
                "grids of {} x {} x {} voxels take more memory than {} bytes: raise the voxel "
                "(--voxel), the tolerance, or the cap (--max-memory), or write fewer grids",
                lattice.counts[0], lattice.counts[1], lattice.counts[2], options.max_bytes));
        }
        if (options.progress) {
            const auto all = static_cast<std::size_t>(lattice.size());
            const auto layers = static_cast<std::size_t>(blocks(0));
            options.progress(all * static_cast<std::size_t>(layer + 1) / layers, all);
        }
    }
    Extremes extremes;
    scratches.combine_each([&](const std::unique_ptr<Scratch>& s) { extremes.add(s->extremes); });
    return extremes;
}

void require_numbers_hold(const Range& lengths, bool half) {
    const double most = half ? 65504 : static_cast<double>(std::numeric_limits<float>::max());
    const double least = half ? 6.2e-5 : static_cast<double>(std::numeric_limits<float>::min());
    if (lengths.finest < least || lengths.coarsest > most) {
        throw InputError(
            fmt::format("lengths from {:.3g} to {:.3g} do not fit the file's numbers, from {:.3g} "
                        "to {:.3g}: {}",
                        lengths.finest, lengths.coarsest, least, most,
                        half ? "leave out --half" : "use another unit of length"));
    }
}

/// Smallest lengths, in place, to what the fog is.
void make_density(openvdb::FloatGrid& grid, const Range& lengths) {
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
    const auto transform = openvdb::math::Transform::createLinearTransform(lattice.voxel);
    // Whole indices are the centres of voxels.
    const Point first = lattice.domain.low.array() + 0.5 * lattice.voxel;
    transform->postTranslate({first.x(), first.y(), first.z()});
    return transform;
}

void annotate(openvdb::GridBase& grid, const Box& domain, const VdbOptions& options) {
    const auto corner_of = [](const Point& x) {
        return openvdb::Vec3DMetadata({x.x(), x.y(), x.z()});
    };
    grid.setCreator("controlspace");
    grid.insertMeta("domain_low", corner_of(domain.low));
    grid.insertMeta("domain_high", corner_of(domain.high));
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

}  // namespace

VdbReport write_vdb(const std::filesystem::path& path, const MetricField& field, const Box& domain,
                    const VdbOptions& options) {
    if (!std::isfinite(options.tolerance) || options.tolerance < 0) {
        throw InputError(
            fmt::format("a tolerance of {}: give a finite one, 0 or more", options.tolerance));
    }
    const std::vector<MetricGrid> kinds = chosen_grids(options.grids);
    const VoxelLattice lattice = voxel_lattice(domain, options.voxel);
    openvdb::initialize();

    Builders builders;
    for (const MetricGrid& kind : kinds) builders.push_back(make_vdb_builder(kind));
    const Extremes extremes = fill(builders, field, lattice, options);
    require_numbers_hold(extremes.all, options.half);

    VdbReport report{lattice.voxel, lattice.counts, extremes.smallest.finest,
                     extremes.smallest.coarsest};
    const auto transform = transform_of(lattice);
    openvdb::GridPtrVec grids;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        const double kept = static_cast<double>(builders[i]->voxels());
        report.kept = std::max(report.kept, kept / lattice.size());
        report.memory += builders[i]->bytes();
        grids.push_back(builders[i]->finish());
        if (kinds[i].kind == GridKind::fog) {
            make_density(*openvdb::gridPtrCast<openvdb::FloatGrid>(grids[i]), extremes.smallest);
        }
    }
    if (extremes.isotropic) share_trees(kinds, grids);
    if (!options.sources.empty()) {
        grids.push_back(make_points_grid(options.sources, *transform));
    }
    for (const openvdb::GridBase::Ptr& grid : grids) {
        grid->setTransform(transform->copy());
        annotate(*grid, domain, options);
    }
    report.file = write_vdb_file(path, {grids.begin(), grids.end()}, options.compression);
    return report;
}

VdbReport write_vdb(const std::filesystem::path& path, const ControlSpace& space,
                    const VdbOptions& options) {
    return write_vdb(path, SpaceAsField(space), space.domain(), options);
}

}  // namespace controlspace
