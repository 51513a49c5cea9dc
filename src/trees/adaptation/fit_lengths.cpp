// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/fit_lengths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "trees/adaptation/nearby_field.h"
#include "trees/in_parallel.h"

namespace controlspace {

namespace {

// Along each axis; at the ends too: between places in the interior alone a field that has a crease
// on a face is missed by twice the target.
constexpr std::size_t along = 5;
constexpr std::size_t places = along * along * along;

// Weights of the corners at each place.
struct Weights {
    std::array<std::array<float, 8>, places> of{};
    std::array<Vector, places> at;
    std::array<std::size_t, 8> of_corner{};  // numbers of places

    Weights() {
        for (std::size_t i = 0; i < places; ++i) {
            const Vector t =
                Vector(static_cast<double>(i % along), static_cast<double>(i / along % along),
                       static_cast<double>(i / along / along)) /
                (along - 1);
            at[i] = t;
            for (std::size_t corner = 0; corner < 8; ++corner) {
                double weight = 1;
                for (Axis a = 0; a < 3; ++a) {
                    weight *= (corner >> a & 1) != 0 ? t[a] : 1 - t[a];
                }
                of[i][corner] = static_cast<float>(weight);
                if (weight == 1) of_corner[corner] = i;
            }
        }
    }
};

const Weights& weights() {
    static const Weights w;
    return w;
}

// Logarithms of the smallest and the largest factor of some lengths by the field's.
struct Range {
    double least = std::numeric_limits<double>::infinity();
    double most = -std::numeric_limits<double>::infinity();

    void take(const Range& other) {
        least = std::min(least, other.least);
        most = std::max(most, other.most);
    }
    double farthest() const { return std::max(most, -least); }
};

}  // namespace

// Sweeps over all nodes at once. A node is divided by the middle of the range of factors in the
// cells around it, or by most of it: neighbours move too, and together they would overshoot. A
// sweep may make things worse in a cell that several nodes correct; the best one counts, so that
// the number of sweeps, which is chosen, decides about time alone.
double fit_lengths(const GoalField& field, std::span<const FittedCell> cells, double allowed,
                   std::span<double> lengths) {
    constexpr int sweeps = 12;
    constexpr double share = 0.8;  // of the way to the middle
    constexpr int most_rounds = 12;
    constexpr double share_aimed_at = 0.97;  // of the logarithm: what is closer is hard to prove

    // Inverse lengths of the field, in units of a length in the cell: domains may be tiny.
    std::vector<std::array<float, places>> exact(cells.size());
    std::vector<std::array<double, 8>> at_corners(cells.size());
    in_parallel(cells.size(), [&, nearby = NearbyField(field)](std::size_t i) mutable {
        std::array<Point, places> x;
        std::array<Metric, places> m;
        const Box& box = cells[i].box;
        for (std::size_t p = 0; p < places; ++p) {
            x[p] = box.low + weights().at[p].cwiseProduct(box.edges());
        }
        nearby.enter(box, true);
        nearby.evaluate(x, m);
        for (std::size_t c = 0; c < 8; ++c) at_corners[i][c] = m[weights().of_corner[c]].xx;
        for (std::size_t p = 0; p < places; ++p) {
            exact[i][p] = static_cast<float>(at_corners[i][0] / m[p].xx);
        }
    });
    const auto set_to_field = [&] {
        for (std::size_t i = 0; i < cells.size(); ++i) {
            for (std::size_t c = 0; c < 8; ++c) lengths[cells[i].nodes[c]] = at_corners[i][c];
        }
    };
    set_to_field();

    const auto range_of = [&](std::size_t i) {
        std::array<float, 8> corners;
        for (std::size_t c = 0; c < 8; ++c) {
            corners[c] = static_cast<float>(lengths[cells[i].nodes[c]] / at_corners[i][0]);
        }
        float least = std::numeric_limits<float>::infinity(), most = 0;
        for (std::size_t p = 0; p < places; ++p) {
            float length = 0;
            for (std::size_t c = 0; c < 8; ++c) length += weights().of[p][c] * corners[c];
            const float factor = length * exact[i][p];
            least = std::min(least, factor);
            most = std::max(most, factor);
        }
        return Range{std::log(static_cast<double>(least)), std::log(static_cast<double>(most))};
    };
    std::vector<Range> of_cells(cells.size()), of_nodes(lengths.size());
    std::vector<double> by_field(cells.size());
    std::vector<std::uint32_t> fitted;
    const double most = std::log(allowed), aim = share_aimed_at * most;
    in_parallel(cells.size(), [&](std::size_t i) {
        of_cells[i] = range_of(i);
        by_field[i] = of_cells[i].farthest();
    });
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (by_field[i] <= 2 * most) fitted.push_back(static_cast<std::uint32_t>(i));
    }

    // Sweeps, the best of which counts. Returns the logarithm of the largest factor that is left.
    std::vector<double> best;
    std::vector<Range> best_ranges;
    const auto sweep_over = [&](std::span<const std::uint32_t> some) {
        double best_farthest = std::numeric_limits<double>::infinity();
        for (int sweep = 0;; ++sweep) {
            Range all;
            for (const std::uint32_t i : some) all.take(of_cells[i]);
            if (all.farthest() < best_farthest) {
                best_farthest = all.farthest();
                best.assign(lengths.begin(), lengths.end());
                best_ranges = of_cells;
            }
            if (sweep == sweeps) break;
            std::ranges::fill(of_nodes, Range());
            for (const std::uint32_t i : some) {
                for (const std::uint32_t node : cells[i].nodes) of_nodes[node].take(of_cells[i]);
            }
            for (std::size_t n = 0; n < lengths.size(); ++n) {
                if (of_nodes[n].most < of_nodes[n].least) continue;
                lengths[n] *= std::exp(-0.5 * share * (of_nodes[n].least + of_nodes[n].most));
            }
            in_parallel(some.size(), [&](std::size_t i) { of_cells[some[i]] = range_of(some[i]); });
        }
        std::ranges::copy(best, lengths.begin());
        std::swap(of_cells, best_ranges);
        return best_farthest;
    };
    const auto needs_fit = [&](std::uint32_t i) { return by_field[i] > most; };
    const auto is_off = [&](std::uint32_t i) {
        return of_cells[i].farthest() > (needs_fit(i) ? aim : std::max(aim, by_field[i]));
    };
    std::vector<std::uint8_t> is_spoiled(lengths.size());
    double left = 0;
    for (int round = 1; !fitted.empty(); ++round) {
        left = sweep_over(fitted);
        std::ranges::fill(is_spoiled, std::uint8_t{0});
        for (const std::uint32_t i : fitted) {
            if (needs_fit(i) || !is_off(i)) continue;
            for (const std::uint32_t node : cells[i].nodes) is_spoiled[node] = 1;
        }
        const auto spoils = [&](std::uint32_t i) {
            return std::ranges::any_of(cells[i].nodes,
                                       [&](std::uint32_t node) { return is_spoiled[node] != 0; });
        };
        const std::size_t before = fitted.size();
        std::erase_if(fitted, [&](std::uint32_t i) {
            return needs_fit(i) && (round == most_rounds || is_off(i) || spoils(i));
        });
        if (fitted.size() == before) break;
        set_to_field();
        in_parallel(fitted.size(),
                    [&](std::size_t i) { of_cells[fitted[i]] = range_of(fitted[i]); });
    }
    return fitted.size() < cells.size() ? std::numeric_limits<double>::infinity() : std::exp(left);
}

}  // namespace controlspace
