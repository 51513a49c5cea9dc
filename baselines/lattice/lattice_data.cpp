// SPDX-License-Identifier: Apache-2.0
#include "baselines/lattice/lattice_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "baselines/lattice/fit_lattice.h"
#include "baselines/lattice/stencil.h"
#include "controlspace/geometry/detail/large_pages.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/detail/past_gradation.h"
#include "refuse.h"

namespace controlspace {

namespace {

/// The nodes as Regradation wants them.
struct RegradedNodes {
    using Node = NodeIndex;

    Lattice lattice;
    std::span<const Metric> requested_metrics;
    std::span<Metric> metrics;

    double requested(NodeIndex node) const { return requested_metrics[node].xx; }
    double field(NodeIndex node) const { return metrics[node].xx; }
    void set(NodeIndex node, double h) { metrics[node] = Metric::isotropic(h); }
    template <class Visit>
    void for_each_link(NodeIndex node, Visit&& visit) const {
        lattice.for_each_link(node, visit);
    }
};

template <class Later, class State>
void exchange(Later& later, State& state) {
    exchange_past(later.past, state);
    state("grid.requested", later.requested);
    state("grid.lowered", later.lowered);
    state("grid.requests_isotropic", later.requests_isotropic);
}

}  // namespace

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
    return choose_voxels(options, kind_.interpolation, [&](const Vector& nodes) {
        return (options.takes_later_sources ? 2 : 1) * kind_.bytes_for(nodes);
    });
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
    std::vector<Metric>& requested = later_.requested.empty() ? field_ : later_.requested;
    const auto lower = [this](Metric& metric, const Metric& by) {
        metric = kind_.kept(intersection(metric, by));
    };
    InsertionReport report;
    for (const PointSource& source : sources) {
        require_valid(source, report.sources, domain());
        ++report.sources;
        const Metric held =
            stencil.value(source.position, [&](auto i, auto j, auto k) -> const Metric& {
                return requested[lattice.index(i, j, k)];
            });
        if (!calls_for_change(source.metric, held, options_.tolerance)) continue;
        ++report.inserted;
        stencil.for_each_node(source.position, [&](auto i, auto j, auto k) {
            const NodeIndex node = lattice.index(i, j, k);
            lower(field_[node], source.metric);
            if (later_.requested.empty()) return;
            lower(later_.requested[node], source.metric);
            later_.lowered.push_back(node);
        });
        later_.requests_isotropic = later_.requests_isotropic && is_isotropic(source.metric);
    }
    return report;
}

GradationReport LatticeData::grade(const NodeGradation& gradation) {
    const GradationOptions& options = gradation.options;
    field();
    GradationReport report;
    if (!later_.requested.empty() && may_regrade(later_.past, options) &&
        later_.requests_isotropic && !are_many(later_.lowered.size(), field_.size())) {
        report = regrade();
    } else {
        if (!later_.requested.empty()) {
            field_ = later_.requested;
        } else if (options_.takes_later_sources) {
            later_.requested = field_;
        }
        const Lattice nodes = lattice(neighbourhood_of(options));
        report = gradation.field ? grade_to(*gradation.field, positions(nodes), field_)
                                 : controlspace::grade(nodes, field_, options);
        kind_.keep(field_);
    }
    later_.lowered.clear();
    later_.past = {options, report.largest_ratio_left};
    return report;
}

GradationReport LatticeData::regrade() {
    RegradedNodes nodes{lattice(neighbourhood_of(later_.past->options)), later_.requested, field_};
    Regradation regradation(nodes, later_.past->options.ratio);
    std::sort(later_.lowered.begin(), later_.lowered.end());
    later_.lowered.erase(std::unique(later_.lowered.begin(), later_.lowered.end()),
                         later_.lowered.end());
    for (const NodeIndex node : later_.lowered) regradation.touch(node);
    return regradation.run(later_.past->largest_ratio_left);
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
    const GoalField field(own, domain());
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
    }
    field_ = std::move(fitted.nodes);
    later_ = {};
    later_.requests_isotropic = std::ranges::all_of(field_, is_isotropic);

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
    later_ = {};
    later_.requests_isotropic = std::all_of(metrics.begin(), metrics.end(), is_isotropic);
}

std::unique_ptr<ControlSpace> LatticeData::finished(const std::shared_ptr<const LatticeData>& data,
                                                    std::optional<Precision> precision) {
    data->field();
    return data->kind_.finish(data, precision);
}

void save_lattice(const std::vector<Metric>& field, const LaterSources& later, StateWriter& state) {
    state("grid.field", field);
    exchange(later, state);
}

void LatticeData::load(const StateReader& state) {
    const std::size_t nodes = lattice().size();
    state("grid.field", field_);
    exchange(later_, state);
    constexpr auto misfit = "has another number of nodes than this grid";
    state.require(field_.size() == nodes, "grid.field", misfit);
    state.require(later_.requested.empty() || later_.requested.size() == nodes, "grid.requested",
                  misfit);
    require_metrics(state, "grid.field", field_);
    require_metrics(state, "grid.requested", later_.requested);
    require_below(state, "grid.lowered", later_.lowered, nodes);
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
