// SPDX-License-Identifier: Apache-2.0
#include "baselines/lattice/fit_lattice.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "baselines/lattice/stencil.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/sample_parallel.h"
#include "space/until_late.h"
#include "trees/adaptation/fit_lengths.h"
#include "trees/adaptation/nearby_field.h"

namespace controlspace {

namespace {

// Whether check(first, end) holds for all parts of so many, which are checked on all threads. A
// trial leaves out the others where one fails, and throws GrowthStopped beyond its limit.
template <class Check>
bool all_of_parts(std::size_t count, const GrowthLimit* trial, const Check& check) {
    constexpr std::size_t grain = 256;
    std::atomic<bool> holds = true;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& part) {
                          if (trial != nullptr) {
                              if (!holds) return;
                              require_in_time(*trial);
                          }
                          if (!check(part.begin(), part.end())) holds = false;
                      });
    return holds;
}

// Beyond its faces by the rounding of places, which decides in which of two cells one is found.
Box with_margin(const Box& cell, const Box& domain) {
    constexpr double ulps = 8 * std::numeric_limits<double>::epsilon();
    const Vector margin =
        ulps * domain.low.cwiseAbs().cwiseMax(domain.high.cwiseAbs()).cwiseMax(domain.edges());
    return {cell.low - margin, cell.high + margin};
}

}  // namespace

LatticeFit::LatticeFit(const GoalField& field, const AdaptationGoal& goal, const Box& domain,
                       const GridKind& kind, int* stop)
    : field_(field), domain_(domain), kind_(kind), values_(goal.values), stop_{.stop = stop} {
    constexpr std::size_t most_suspects = 4096;
    const auto sources = goal.sources;
    const std::size_t step = sources.size() / most_suspects + 1;
    for (std::size_t i = 0; i < sources.size(); i += step) {
        suspects_.push_back(sources[i].position);
    }
    if (field.has_ranges()) return;
    std::vector<Point> x = field.probes(domain);
    for (const PointSource& source : sources) x.push_back(source.position);
    for (const Point& place : goal.places) x.push_back(nearest_in(domain, place));
    at_probes_ = sample_parallel(UntilLate(field, stop_), x);
    probes_ = std::move(x);
}

template <Interpolation interpolation>
FittedLattice LatticeFit::fitted(const Voxels& voxels, NodeValues values,
                                 const GrowthLimit* trial) const {
    const Stencil<interpolation> stencil(domain_, voxels.cells);
    const Lattice lattice = stencil.lattice();
    FittedLattice fit{.voxels = voxels, .nodes = {}};
    const auto at_nodes = [&](auto i, auto j, auto k) -> const Metric& {
        return fit.nodes[lattice.index(i, j, k)];
    };
    const auto set_to_field = [&] {
        const UntilLate field(field_, trial != nullptr ? *trial : stop_);
        fit.nodes = sample_parallel(field, positions(lattice));
        kind_.keep(fit.nodes);
    };
    const double target = field_.target();

    if (!field_.has_ranges()) {
        if (trial != nullptr && !may_keep_probes(stencil, *trial)) return fit;
        set_to_field();
        std::vector<double> worst(probes_.size());
        fit.met = all_of_parts(worst.size(), trial, [&](std::size_t first, std::size_t end) {
            for (std::size_t i = first; i < end; ++i) {
                worst[i] =
                    directional_nonconformity(stencil.value(probes_[i], at_nodes), at_probes_[i]);
            }
            return std::ranges::all_of(std::span(worst).subspan(first, end - first),
                                       [&](double delta) { return delta <= target; });
        });
        fit.reached = *std::ranges::max_element(worst);
        return fit;
    }

    // The value of a constant cell, and how far it departs at most.
    const auto constant_in = [&](const Box& cell, NearbyField& nearby) {
        nearby.enter(with_margin(cell, domain_), false);
        const auto [least, most] = nearby.range();
        const Metric middle = kind_.kept(Metric::isotropic(std::sqrt(least * most)));
        return std::pair(middle, std::max(nonconformity(middle, Metric::isotropic(most)),
                                          nonconformity(middle, Metric::isotropic(least))));
    };
    const auto is_kept_between = [&](const Box& cell, const std::array<double, 8>& corners,
                                     NearbyField& nearby) {
        nearby.enter(cell, true);
        return !nearby.doubt_of(corners);
    };
    // Cells of sources first: those are what most lattices fail by, and few.
    const auto may_be_met = [&](std::size_t first, std::size_t end) {
        NearbyField nearby(field_);
        for (std::size_t i = first; i < end; ++i) {
            const Box cell = stencil.cell_at(suspects_[i]);
            if constexpr (interpolation == Interpolation::nearest) {
                if (constant_in(cell, nearby).second > target) return false;
            } else {
                std::array<Point, 8> x;
                std::array<Metric, 8> m;
                std::array<double, 8> corners;
                for (int c = 0; c < 8; ++c) x[static_cast<std::size_t>(c)] = corner(cell, c);
                field_.sample(x, m);
                std::ranges::transform(m, corners.begin(),
                                       [&](const Metric& f) { return kind_.kept(f).xx; });
                if (!is_kept_between(cell, corners, nearby)) return false;
            }
        }
        return true;
    };
    if (trial != nullptr && values == NodeValues::field &&
        !all_of_parts(suspects_.size(), trial, may_be_met)) {
        return fit;
    }

    const auto nx = static_cast<std::size_t>(voxels.cells.x()),
               ny = static_cast<std::size_t>(voxels.cells.y());
    const auto count = static_cast<std::size_t>(voxels.cells.prod());
    const auto cell_number = [&](std::size_t n) {
        return Cell{static_cast<std::int32_t>(n % nx), static_cast<std::int32_t>(n / nx % ny),
                    static_cast<std::int32_t>(n / nx / ny)};
    };
    if constexpr (interpolation == Interpolation::nearest) {
        fit.nodes.resize(count);
    } else {
        if (trial != nullptr && values == NodeValues::fitted && count > LengthFit::most_cells) {
            return fit;
        }
        if (values == NodeValues::field || count > LengthFit::most_cells) {
            set_to_field();
        } else {
            std::vector<std::uint32_t> numbers(count);
            std::vector<Box> boxes(count);
            std::vector<std::array<std::uint32_t, 8>> nodes(count);
            for (std::size_t n = 0; n < count; ++n) {
                const Cell cell = cell_number(n);
                numbers[n] = static_cast<std::uint32_t>(n);
                boxes[n] = stencil.box_of(cell);
                for (std::size_t c = 0; c < 8; ++c) {
                    nodes[n][c] = static_cast<std::uint32_t>(stencil.at_corner(
                        cell, c, [&](auto i, auto j, auto k) { return lattice.index(i, j, k); }));
                }
            }
            LengthFit length_fit(field_);
            length_fit.enter(numbers, boxes);
            std::vector<double> lengths(lattice.size());
            const double factor = length_fit.fit(nodes, largest_factor_within(target), lengths);
            // What is missed at its samples needs no proof.
            if (trial != nullptr && factor > largest_factor_within(target)) return fit;
            fit.nodes.resize(lengths.size());
            std::ranges::transform(lengths, fit.nodes.begin(), [&](double length) {
                return kind_.kept(Metric::isotropic(length));
            });
        }
    }
    std::vector<double> of_cell(interpolation == Interpolation::nearest ? count : 0);
    fit.met = all_of_parts(count, trial, [&](std::size_t first, std::size_t end) {
        NearbyField nearby(field_);
        bool holds = true;
        for (std::size_t n = first; n < end && (holds || trial == nullptr); ++n) {
            const Cell cell = cell_number(n);
            const Box box = stencil.box_of(cell);
            if constexpr (interpolation == Interpolation::nearest) {
                std::tie(fit.nodes[n], of_cell[n]) = constant_in(box, nearby);
                holds = holds && of_cell[n] <= target;
            } else {
                std::array<double, 8> corners;
                for (std::size_t c = 0; c < 8; ++c) {
                    corners[c] = stencil.at_corner(cell, c, at_nodes).xx;
                }
                holds = holds && is_kept_between(box, corners, nearby);
            }
        }
        return holds;
    });
    fit.is_bound = fit.met;
    fit.reached = interpolation == Interpolation::nearest && !of_cell.empty()
                      ? *std::ranges::max_element(of_cell)
                      : target;
    if (!fit.met && trial == nullptr && interpolation == Interpolation::trilinear) {
        fit.reached = field_.largest_departure(domain_, [&](auto x, auto metrics) {
            for (std::size_t i = 0; i < x.size(); ++i) metrics[i] = stencil.value(x[i], at_nodes);
        });
        fit.met = fit.reached <= target;
    }
    return fit;
}

// Nodes around some hundreds of probes show most lattices that are too coarse.
template <class Stencil>
bool LatticeFit::may_keep_probes(const Stencil& stencil, const GrowthLimit& limit) const {
    constexpr std::size_t few = 512;
    const Lattice lattice = stencil.lattice();
    const std::size_t step = probes_.size() / few + 1;
    return all_of_parts(probes_.size() / step, &limit, [&](std::size_t first, std::size_t end) {
        for (std::size_t n = first; n < end; ++n) {
            const std::size_t i = n * step;
            const Metric own = stencil.value(probes_[i], [&](auto... ijk) {
                Metric m;
                const Point x = lattice.position(lattice.index(ijk...));
                field_.sample({&x, 1}, {&m, 1});
                return kind_.kept(m);
            });
            if (directional_nonconformity(own, at_probes_[i]) > field_.target()) return false;
        }
        return true;
    });
}

FittedLattice LatticeFit::fitted(const Voxels& voxels, NodeValues values,
                                 const GrowthLimit* trial) const {
    return kind_.interpolation == Interpolation::nearest
               ? fitted<Interpolation::nearest>(voxels, values, trial)
               : fitted<Interpolation::trilinear>(voxels, values, trial);
}

FittedLattice LatticeFit::at(const Voxels& voxels) const {
    FittedLattice fit = fitted(voxels, values_, nullptr);
    if (fit.met || values_ == NodeValues::field) return fit;
    FittedLattice of_field = fitted(voxels, NodeValues::field, nullptr);
    return of_field.reached < fit.reached ? of_field : fit;
}

FittedLattice LatticeFit::coarsest(
    const std::function<std::optional<Voxels>(double edge)>& voxels_of,
    const GrowthLimit& limit) const {
    const double longest = domain_.edges().maxCoeff();
    const auto with = [&](std::int64_t n) -> std::optional<Voxels> {
        auto voxels = voxels_of(longest / static_cast<double>(n));
        if (voxels && !field_.has_ranges() && voxels->cells.prod() > most_cells_by_probes) {
            voxels.reset();
        }
        return voxels;
    };
    std::optional<FittedLattice> best;
    bool is_stopped = false;
    Voxels finest = *with(1);
    std::int64_t most_tried = std::numeric_limits<std::int64_t>::max();
    const auto is_enough = [&](std::int64_t n, NodeValues values) {
        if (n >= most_tried) return true;
        auto voxels = with(n);
        if (!voxels) return true;
        FittedLattice fit = fitted(*voxels, values, &limit);
        if (!fit.met) {
            if (!best) finest = std::move(*voxels);
            return false;
        }
        best = std::move(fit);
        return true;
    };
    // The fewest cells along the longest edge that will do or outgrow a limit: in steps that double
    // from a guess, then by bisection, to about a hundredth; larger voxels that are no multiple may
    // do by chance.
    const auto fewest = [&](NodeValues values, std::int64_t guess) {
        std::int64_t refused = 0, enough = guess;
        for (std::int64_t step = 1; !is_enough(enough, values); step *= 2) {
            refused = enough;
            enough += step;
        }
        for (std::int64_t step = 1; refused == 0 && enough > 1; step *= 2) {
            const std::int64_t fewer = std::max(enough - step, std::int64_t{1});
            (is_enough(fewer, values) ? enough : refused) = fewer;
        }
        while (enough - refused > 1 + refused / 100) {
            const std::int64_t middle = refused + (enough - refused) / 2;
            (is_enough(middle, values) ? enough : refused) = middle;
        }
        return enough;
    };
    try {
        const std::int64_t enough = fewest(NodeValues::field, 1);
        // Of most works fitted values take a little more than half as many; none that takes more
        // than the field's own is looked for.
        if (values_ == NodeValues::fitted && best) {
            most_tried = enough;
            fewest(NodeValues::fitted, std::max(enough * 11 / 20, std::int64_t{1}));
        }
    } catch (const GrowthStopped&) {
        require_in_time(stop_);
        is_stopped = true;
    }
    if (!best) best = fitted(finest, NodeValues::field, nullptr);
    best->is_stopped = is_stopped;
    return std::move(*best);
}

}  // namespace controlspace
