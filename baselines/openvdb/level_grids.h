#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/level_nodes.h"
#include "baselines/openvdb/level_stack.h"
#include "baselines/openvdb/prune.h"
#include "controlspace/gradation/detail/regrade.h"
#include "controlspace/input_errors.h"
#include "controlspace/space/detail/past_gradation.h"
#include "controlspace/space/detail/shared_builder.h"

namespace controlspace {

/// The structure of make_openvdb_levels. `Values` is LevelMetrics.
template <class Values>
class LevelGrids {
    using Coord = openvdb::Coord;

public:
    explicit LevelGrids(const SpaceOptions& options)
        : options_(options), cells_(choose_levels(options)), field_(new_stack()) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const {
        sample_levels<Values>(cells_, LevelReader(field_.trees), x, out);
    }

    InsertionReport insert(std::span<const PointSource> sources) {
        InsertionReport report;
        LevelStack& requested = requested_ ? *requested_ : field_;
        LevelWriter to_requested(requested.trees);
        LevelWriter to_field(field_.trees);
        const LevelReader from_requested(requested.trees);
        for (const PointSource& source : sources) {
            require_valid(source, report.sources++, domain());
            Metric held;
            sample_levels<Values>(cells_, from_requested, {&source.position, 1}, {&held, 1});
            if (!calls_for_change(source.metric, held, options_.tolerance)) continue;
            ++report.inserted;
            past_.reset();
            lower(requested, to_requested, source);
            if (requested_) lower(field_, to_field, source);
        }
        return report;
    }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const {
        const LevelNodes nodes = numbered();
        return {nodes.graph(neighbourhood), nodes.metrics()};
    }

    void assign(std::span<const Metric> metrics) {
        set_field(metrics);
        prune({.delta = options_.prune_delta});
        requested_.reset();
        past_.reset();
    }

    GradationReport grade(const NodeGradation& gradation) {
        const GradationOptions& options = gradation.options;
        if (options_.takes_later_sources) {
            if (!gradation.field && past_ && past_->options == options) {
                return {.largest_ratio_left = past_->largest_ratio_left, .visits = 0};
            }
            if (requested_) {
                field_ = LevelStack(*requested_);
            } else {
                requested_.emplace(field_);
            }
        }
        GradationReport report;
        std::uint64_t operations = 0;
        while (true) {
            require_memory(options.neighbourhood);
            const LevelNodes nodes = numbered();
            const std::vector<Metric> before = nodes.metrics();
            std::vector<Metric> graded = before;
            report = gradation.field ? grade_to(*gradation.field, nodes.positions(), graded)
                                     : controlspace::grade(nodes.graph(neighbourhood_of(options)),
                                                           graded, options);
            operations += report.operations;
            nodes.assign(graded, field_.trees);
            const auto too_long = voxels_longer_than_wanted();
            if (too_long.empty()) break;
            nodes.assign(before, field_.trees);
            LevelWriter at(field_.trees);
            for (const auto& [level, c] : too_long) split(field_, at, level, c);
            prune({.delta = 0});
        }
        report.operations = operations;
        prune({.delta = options_.prune_delta});
        past_ = {options, report.largest_ratio_left};
        return report;
    }

    void save(StateWriter& state) const {
        save_levels(field_, cells_, field_name, state);
        state("levels.keeps_requested", requested_.has_value());
        if (requested_) save_levels(*requested_, cells_, requested_name, state);
        exchange_past(past_, state);
    }
    void load(const StateReader& state) {
        load_stack(field_, field_name, state);
        // Tiles stand where voxels are equal.
        prune({.delta = options_.prune_delta > 0 ? std::numeric_limits<double>::min() : 0});
        bool keeps_requested = false;
        state("levels.keeps_requested", keeps_requested);
        requested_.reset();
        if (keeps_requested) load_stack(requested_.emplace(new_stack()), requested_name, state);
        exchange_past(past_, state);
    }

    Box domain() const { return cells_.domain(); }
    const SpaceOptions& options() const { return options_; }

    Box cell_at(const Point& x) const {
        const Coord finest = finest_cell(x);
        const int level = LevelReader(field_.trees).level_at(finest, cells_.top());
        return cells_.box(level, finest >> static_cast<std::size_t>(level), x);
    }

    Footprint footprint() const {
        Footprint footprint;
        footprint.cells = field_.voxels;
        footprint.control_nodes = numbered().size();
        int finest = cells_.top();
        int coarsest = 0;
        for (int level = 0; level <= cells_.top(); ++level) {
            const VdbLevelTree& tree = field_.trees[static_cast<std::size_t>(level)];
            footprint.bytes_payload += tree.leafCount() * leaf_values_bytes<VdbLevelTree>;
            if (tree.activeVoxelCount() == 0) continue;
            finest = std::min(finest, level);
            coarsest = std::max(coarsest, level);
        }
        footprint.bytes_topology = field_.bytes() - footprint.bytes_payload;
        if (requested_) footprint.bytes_auxiliary = requested_->bytes();
        footprint.depth = coarsest - finest;
        footprint.remark =
            fmt::format("voxels of {:.3g} to {:.3g}", cells_.edges(finest).maxCoeff(),
                        cells_.edges(coarsest).maxCoeff());
        return footprint;
    }

private:
    static constexpr const char* field_name = "levels.field";
    static constexpr const char* requested_name = "levels.requested";

    LevelStack new_stack() const { return {cells_, largest_metric(options_), Values()}; }
    void load_stack(LevelStack& stack, const char* name, const StateReader& state) {
        load_levels(stack, cells_, name, state, [&](LevelWriter& at, int level, const Coord& c) {
            split(stack, at, level, c);
        });
    }

    LevelNodes numbered() const { return {cells_, field_.trees, Values::interpolation}; }

    Coord finest_cell(const Point& x) const {
        CellBatch batch;
        cells_.locate({&x, 1}, batch);
        const auto [i, j, k] = batch[0];
        return {i, j, k};
    }

    bool is_longer(int level, const Metric& metric, double length) const {
        const auto lengths = metric_edge_lengths(metric, cells_.edges(level));
        return std::max({lengths[0], lengths[1], lengths[2]}) > length;
    }

    // Refines the voxel at a source and lowers what is left of it there.
    void lower(LevelStack& stack, LevelWriter& at, const PointSource& source) {
        const Coord finest = finest_cell(source.position);
        int level = at.level_at(finest, cells_.top());
        for (; level > 0 && is_longer(level, source.metric, options_.l_min); --level) {
            split(stack, at, level, finest >> static_cast<std::size_t>(level));
        }
        Values::lower(at, cells_, level, finest >> static_cast<std::size_t>(level), source.metric);
    }

    void split(LevelStack& stack, LevelWriter& at, int level, const Coord& c) {
        if (stack.voxels >= next_look_) require_memory();
        Values::split(at, cells_, level, c);
        stack.voxels += static_cast<std::size_t>(cells_.places(2).asVec3i().product()) - 1;
    }

    // Stops a structure that outgrows the cap, long before the system stops the program.
    void require_memory(Neighbourhood neighbourhood = Neighbourhood::faces) {
        const std::size_t bytes = field_.bytes() + (requested_ ? requested_->bytes() : 0) +
                                  field_.voxels * gradation_bytes_per_voxel(neighbourhood);
        if (bytes > options_.max_bytes) {
            throw MemoryLimitError(
                bytes,
                fmt::format("a grid in levels would take more than {:.3g} GiB, gradation included: "
                            "raise voxel, "
                            "voxel_factor or max_memory",
                            static_cast<double>(options_.max_bytes) / (1 << 30)));
        }
        next_look_ = field_.voxels + field_.voxels / 16;
    }

    std::vector<std::pair<int, Coord>> voxels_longer_than_wanted() const {
        std::vector<std::pair<int, Coord>> found;
        const LevelReader at(field_.trees);
        for (int level = 1; level <= cells_.top(); ++level) {
            const VdbLevelTree& tree = field_.trees[static_cast<std::size_t>(level)];
            for (auto voxel = tree.cbeginValueOn(); voxel; ++voxel) {
                bool longer = false;
                Values::for_each_metric(
                    at, cells_, level, voxel.getCoord(), [&](const Metric& metric) {
                        longer = longer || is_longer(level, metric, options_.voxel_factor);
                    });
                if (longer) found.emplace_back(level, voxel.getCoord());
            }
        }
        return found;
    }

    void set_field(std::span<const Metric> metrics) { numbered().assign(metrics, field_.trees); }

    // Takes away leaves that hold nothing any more, too.
    void prune(const PruneRule& rule) {
        for (VdbLevelTree& tree : field_.trees) prune_metrics(tree, rule);
    }

    // Numbers, graph and copies of metrics, as counted on spheres: 180 bytes for a voxel, 320 with
    // all neighbours; for its vertices 330 and 700, and half as much again where few are shared.
    static constexpr std::size_t gradation_bytes_per_voxel(Neighbourhood neighbourhood) {
        const bool all = neighbourhood == Neighbourhood::all;
        if (Values::interpolation == Interpolation::nearest) return all ? 450 : 250;
        return all ? 1100 : 600;
    }

    SpaceOptions options_;
    LevelCells cells_;
    LevelStack field_;
    std::size_t next_look_ = 1 << 12;  // number of voxels at which memory is looked at again

    // Where sources may come after gradation: what they request, on voxels that sources alone have
    // refined; and the gradation that still holds.
    std::optional<LevelStack> requested_;
    std::optional<PastGradation> past_;
};

/// The trilinear one, compiled apart: each takes many seconds.
std::unique_ptr<ControlSpaceBuilder> make_trilinear_levels(const SpaceOptions& options);

}  // namespace controlspace
