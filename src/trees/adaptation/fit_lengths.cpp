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
double fit_lengths(const GoalField& field, std::span<const FittedCell> cells,
                   std::span<double> lengths) {
    constexpr int sweeps = 12;
    constexpr double share = 0.8;  // of the way to the middle

    // Inverse lengths of the field, in units of a length in the cell: domains may be tiny.
    std::vector<std::array<float, places>> exact(cells.size());
    std::vector<double> units(cells.size());
    in_parallel(cells.size(), [&, nearby = NearbyField(field)](std::size_t i) mutable {
        std::array<Point, places> x;
        std::array<Metric, places> m;
        const Box& box = cells[i].box;
        for (std::size_t p = 0; p < places; ++p) {
            x[p] = box.low + weights().at[p].cwiseProduct(box.edges());
        }
        nearby.enter(box, true);
        nearby.evaluate(x, m);
        units[i] = lengths[cells[i].nodes[0]];
        for (std::size_t p = 0; p < places; ++p)
            exact[i][p] = static_cast<float>(units[i] / m[p].xx);
    });

    std::vector<Range> of_cells(cells.size()), of_nodes(lengths.size());
    std::vector<double> best(lengths.begin(), lengths.end());
    double best_farthest = std::numeric_limits<double>::infinity();
    for (int sweep = 0;; ++sweep) {
        in_parallel(cells.size(), [&](std::size_t i) {
            std::array<float, 8> corners;
            for (std::size_t c = 0; c < 8; ++c) {
                corners[c] = static_cast<float>(lengths[cells[i].nodes[c]] / units[i]);
            }
            float least = std::numeric_limits<float>::infinity(), most = 0;
            for (std::size_t p = 0; p < places; ++p) {
                float length = 0;
                for (std::size_t c = 0; c < 8; ++c) length += weights().of[p][c] * corners[c];
                const float factor = length * exact[i][p];
                least = std::min(least, factor);
                most = std::max(most, factor);
            }
            of_cells[i] = {std::log(static_cast<double>(least)),
                           std::log(static_cast<double>(most))};
        });
        Range all;
        for (const Range& range : of_cells) all.take(range);
        if (all.farthest() < best_farthest) {
            best_farthest = all.farthest();
            std::ranges::copy(lengths, best.begin());
        }
        if (sweep == sweeps) break;
        std::ranges::fill(of_nodes, Range());
        for (std::size_t i = 0; i < cells.size(); ++i) {
            for (const std::uint32_t node : cells[i].nodes) of_nodes[node].take(of_cells[i]);
        }
        for (std::size_t n = 0; n < lengths.size(); ++n) {
            lengths[n] *= std::exp(-0.5 * share * (of_nodes[n].least + of_nodes[n].most));
        }
    }
    std::ranges::copy(best, lengths.begin());
    return std::exp(best_farthest);
}

}  // namespace controlspace
