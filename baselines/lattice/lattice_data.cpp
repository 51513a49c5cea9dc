// SPDX-License-Identifier: Apache-2.0
#include "baselines/lattice/lattice_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "baselines/lattice/fit_lattice.h"
#include "baselines/lattice/stencil.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "geometry/large_pages.h"
#include "refuse.h"

namespace controlspace {

LatticeData::LatticeData(const SpaceOptions& options, const GridKind& kind)
    : options_(options),
      kind_(kind),
      chooses_voxels_(options.voxel == 0),
      voxels_(voxels_of(options)) {
    if (!options.takes_later_sources) return;
    if (options.prune_delta > 0) {
        refuse("a grid that takes later sources cannot be pruned: set prune_delta 0");
    }
    if (kind.stored != nullptr) {
        refuse("a grid of floats takes no later sources: use one of doubles");
    }
}

Voxels LatticeData::voxels_of(const SpaceOptions& options) const {
    // Where it is made again, both are there for a moment.
    const double copies = options.takes_later_sources ? 2 : 1;
    return choose_voxels(options, kind_.interpolation,
                         [&](const Vector& nodes) { return copies * kind_.bytes_for(nodes); });
}

InsertionReport LatticeData::insert(std::span<const PointSource> sources) {
    return kind_.interpolation == Interpolation::nearest
               ? insert_between<Interpolation::nearest>(sources)
               : insert_between<Interpolation::trilinear>(sources);
}

template <Interpolation interpolation>
InsertionReport LatticeData::insert_between(std::span<const PointSource> sources) {
    const Stencil<interpolation> stencil(domain(), cells());
    const Lattice lattice = stencil.lattice();
    field();
    InsertionReport report;
    for (const PointSource& source : sources) {
        require_valid(source, report.sources, domain());
        ++report.sources;
        const Metric held =
            stencil.value(source.position, [&](auto i, auto j, auto k) -> const Metric& {
                return field_[lattice.index(i, j, k)];
            });
        if (!calls_for_change(source.metric, held, options_.tolerance)) continue;
        ++report.inserted;
        stencil.for_each_node(source.position, [&](auto i, auto j, auto k) {
            Metric& own = field_[lattice.index(i, j, k)];
            own = kind_.kept(intersection(own, source.metric));
        });
    }
    return report;
}

GradationReport LatticeData::grade(const NodeGradation& gradation) {
    field();
    const Lattice nodes = lattice(neighbourhood_of(gradation.options));
    const GradationReport report = gradation.field
                                       ? grade_to(*gradation.field, positions(nodes), field_)
                                       : controlspace::grade(nodes, field_, gradation.options);
    kind_.keep(field_);
    return report;
}

AdaptationReport LatticeData::adapt(const AdaptationGoal& goal) {
    // Of lengths, voxels that are joined take values within this factor of each other.
    const double joined = largest_factor_within(options_.prune_delta);
    const double allowed = largest_factor_within(goal.target);
    AdaptationGoal own = goal;
    if (joined > 1 && chooses_voxels_) {
        if (!(allowed > joined)) {
            refuse(
                "voxels that are joined within prune_delta {} cannot keep a target of {}: give a "
                "smaller prune_delta",
                options_.prune_delta, goal.target);
        }
        own.target = nonconformity_of_factor(allowed / joined);
    }
    own.values = NodeValues::field;
    const GoalField field(own, domain());
    if (goal.values == NodeValues::fitted) {
        if (kind_.interpolation == Interpolation::nearest) {
            refuse("cells of one value are set by bounds of the field: give values `field`");
        }
        if (!field.has_ranges()) {
            refuse(
                "values are fitted to lengths alone, of sources without a continuous field: give "
                "values `field`");
        }
    }
    if (joined > 1 && chooses_voxels_ && !field.has_ranges()) {
        refuse(
            "voxels are joined by what bounds nothing along each direction of a tensor: give "
            "voxels, or prune_delta 0");
    }
    const LatticeFit fit(field, goal, domain(), kind_, options_.growth.stop);
    GrowthStop stop = GrowthStop::none;
    const auto next = [&](double voxel) -> std::optional<Voxels> {
        SpaceOptions options = options_;
        options.voxel = voxel;
        Voxels voxels = voxels_of(options);
        if (!voxels.remark.empty()) stop = GrowthStop::memory;
        if (stop != GrowthStop::none) return std::nullopt;
        return voxels;
    };
    FittedLattice fitted = chooses_voxels_ ? fit.coarsest(next, options_.growth) : fit.at(voxels_);
    if (chooses_voxels_) {
        if (fitted.is_stopped) stop = GrowthStop::time;
        voxels_ = std::move(fitted.voxels);
        options_.voxel = domain().edges().cwiseQuotient(voxels_.cells).maxCoeff();
        chosen_voxel_ = options_.voxel;
    }
    field_ = std::move(fitted.nodes);

    AdaptationReport report;
    report.reached = fitted.reached;
    report.is_bound = fitted.is_bound;
    report.met = fitted.met;
    if (joined > 1) {
        const double reached =
            nonconformity_of_factor(largest_factor_within(fitted.reached) * joined);
        report.is_bound = fitted.is_bound && chooses_voxels_;
        report.met = report.met && (chooses_voxels_ || reached <= goal.target);
        report.reached = report.met ? std::min(reached, goal.target) : reached;
    }
    if (stop == GrowthStop::time || !report.met) report.stop = stop;
    if (!report.met) {
        const std::string tried = fmt::format(
            "no finer grid than this one of {:.0f} cells was tried", voxels_.cells.prod());
        report.shortfall =
            !chooses_voxels_     ? "a grid keeps the voxels that were given: make them smaller"
            : field.has_ranges() ? tried + ": raise the target, or the cap on memory"
                                 : fmt::format(
                                       "{}, of tensors and continuous fields up to {:.0f}: "
                                       "raise the target, or give voxels",
                                       tried, LatticeFit::most_cells_by_probes);
    }
    return report;
}

ControlNodes LatticeData::control_nodes(Neighbourhood neighbourhood) const {
    return {lattice(neighbourhood), field()};
}

void LatticeData::assign(std::span<const Metric> metrics) {
    require_one_each(metrics.size(), lattice().size());
    field_.assign(metrics.begin(), metrics.end());
    kind_.keep(field_);
}

std::unique_ptr<ControlSpace> LatticeData::finished(const std::shared_ptr<const LatticeData>& data,
                                                    std::optional<Precision> precision) {
    data->field();
    return data->kind_.finish(data, precision);
}

void save_lattice(const std::vector<Metric>& field, double chosen_voxel, StateWriter& state) {
    state("grid.field", field);
    if (chosen_voxel > 0) state("grid.chosen_voxel", chosen_voxel);
}

void LatticeData::load(const StateReader& state) {
    if (chooses_voxels_ && state.has("grid.chosen_voxel")) {
        state("grid.chosen_voxel", chosen_voxel_);
        state.require(is_length(chosen_voxel_), "grid.chosen_voxel", "is no length");
        options_.voxel = chosen_voxel_;
        voxels_ = voxels_of(options_);
    }
    state("grid.field", field_);
    state.require(field_.size() == lattice().size(), "grid.field",
                  "has another number of nodes than this grid");
    require_metrics(state, "grid.field", field_);
}

Lattice LatticeData::lattice(Neighbourhood neighbourhood) const {
    Lattice lattice = kind_.interpolation == Interpolation::nearest
                          ? NearestStencil(domain(), cells()).lattice()
                          : TrilinearStencil(domain(), cells()).lattice();
    lattice.neighbourhood = neighbourhood;
    return lattice;
}

const std::vector<Metric>& LatticeData::field() const {
    if (field_.empty()) {
        field_ = large_array<Metric>(lattice().size(), largest_metric(options()));
        kind_.keep(field_);
    }
    return field_;
}

}  // namespace controlspace
