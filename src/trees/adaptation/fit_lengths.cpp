// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/fit_lengths.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trees/adaptation/nearby_field.h"
#include "trees/in_parallel.h"

namespace controlspace {

// Weights of the corners at each place. Places are on the faces too: between places in the interior
// alone a field that has a crease on a face is missed by twice the target.
struct LengthFit::Weights {
    std::array<std::array<float, padded>, 8> of_corner{};
    std::array<Vector, places> at;
    std::array<std::size_t, 8> place_of_corner{};

    Weights() {
        for (std::size_t i = 0; i < padded; ++i) {
            // What pads repeats the last place.
            const std::size_t p = std::min(i, places - 1);
            const std::array numbers{p % along, p / along % along, p / (along * along)};
            Vector t;
            for (std::size_t a = 0; a < 3; ++a) {
                t[static_cast<Axis>(a)] = static_cast<double>(numbers[a]) / (along - 1);
            }
            at[p] = t;
            for (std::size_t corner = 0; corner < 8; ++corner) {
                double weight = 1;
                for (Axis a = 0; a < 3; ++a) {
                    weight *= (corner >> a & 1) != 0 ? t[a] : 1 - t[a];
                }
                of_corner[corner][i] = static_cast<float>(weight);
                if (weight == 1) place_of_corner[corner] = p;
            }
        }
    }
};

const LengthFit::Weights& LengthFit::weights() {
    static const Weights w;
    return w;
}

// Logarithms of the smallest and the largest factor of some lengths by the field's.
struct LengthFit::Range {
    double least = std::numeric_limits<double>::infinity();
    double most = -std::numeric_limits<double>::infinity();

    void take(const Range& other) {
        least = std::min(least, other.least);
        most = std::max(most, other.most);
    }
    double farthest() const { return std::max(most, -least); }
};

void LengthFit::enter(std::span<const std::uint32_t> numbers, std::span<const Box> boxes) {
    const auto last = std::ranges::max_element(numbers);
    if (last == numbers.end()) return;
    samples_.resize(std::max<std::size_t>(samples_.size(), *last + 1));
    in_parallel(numbers.size(), [&, nearby = NearbyField(field_)](std::size_t i) mutable {
        std::array<Point, places> x;
        std::array<Metric, places> m;
        const Box& box = boxes[i];
        for (std::size_t p = 0; p < places; ++p) {
            x[p] = box.low + weights().at[p].cwiseProduct(box.edges());
        }
        nearby.enter(box, true);
        nearby.evaluate(x, m);
        Samples& own = samples_[numbers[i]];
        for (std::size_t c = 0; c < 8; ++c) {
            own.at_corners[c] = m[weights().place_of_corner[c]].xx;
        }
        for (std::size_t p = 0; p < padded; ++p) {
            own.inverse[p] = static_cast<float>(own.at_corners[0] / m[std::min(p, places - 1)].xx);
        }
    });
}

LengthFit::Range LengthFit::range_of(const Samples& cell, const std::array<std::uint32_t, 8>& nodes,
                                     std::span<const double> lengths) const {
    const auto& of_corner = weights().of_corner;
    std::array<float, 8> corners;
    for (std::size_t c = 0; c < 8; ++c) {
        corners[c] = static_cast<float>(lengths[nodes[c]] / cell.at_corners[0]);
    }
    std::array<float, lanes> least, most;
    least.fill(std::numeric_limits<float>::infinity());
    most.fill(0);
    for (std::size_t first = 0; first < padded; first += lanes) {
        std::array<float, lanes> factor{};
        for (std::size_t c = 0; c < 8; ++c) {
            for (std::size_t l = 0; l < lanes; ++l) {
                factor[l] += of_corner[c][first + l] * corners[c];
            }
        }
        for (std::size_t l = 0; l < lanes; ++l) {
            factor[l] *= cell.inverse[first + l];
            least[l] = factor[l] < least[l] ? factor[l] : least[l];
            most[l] = factor[l] > most[l] ? factor[l] : most[l];
        }
    }
    return {std::log(static_cast<double>(*std::ranges::min_element(least))),
            std::log(static_cast<double>(*std::ranges::max_element(most)))};
}

// Sweeps over all nodes at once. A node is divided by the middle of the range of factors in the
// cells around it, or by most of it: neighbours move too, and together they would overshoot. A
// sweep may make things worse in a cell that several nodes correct; the best one counts, so that
// the number of sweeps decides about time alone.
//
// Cells where the field's own values are off by more than twice what is allowed, as a logarithm,
// are left out: no fit helps them. Others may turn out to be as hopeless, or spoil cells that need
// no fit. These are left out in the next round, which begins anew. In the last round all are that
// need a fit, so that no cell is made worse than allowed that was not. Cells that a tree cuts are
// thus cells that it cuts with the field's own values too.
double LengthFit::fit(std::span<const std::array<std::uint32_t, 8>> nodes, double allowed,
                      std::span<double> lengths) const {
    // Chosen.
    constexpr int sweeps = 8;
    constexpr double share = 0.8;  // of the way to the middle
    constexpr int most_rounds = 6;
    constexpr double share_aimed_at = 0.97;  // of the logarithm: what is closer is hard to prove

    const std::size_t cells = nodes.size();
    const double most = std::log(allowed), aim = share_aimed_at * most;
    const auto set_to_field = [&] {
        for (std::size_t i = 0; i < cells; ++i) {
            for (std::size_t c = 0; c < 8; ++c) lengths[nodes[i][c]] = samples_[i].at_corners[c];
        }
    };
    std::vector<Range> of_cells(cells), of_nodes(lengths.size());
    std::vector<double> by_field(cells);
    std::vector<std::uint32_t> fitted;
    set_to_field();
    in_parallel(cells, [&](std::size_t i) {
        of_cells[i] = range_of(samples_[i], nodes[i], lengths);
        by_field[i] = of_cells[i].farthest();
    });
    for (std::uint32_t i = 0; i < cells; ++i) {
        if (by_field[i] <= 2 * most) fitted.push_back(i);
    }
    const std::vector<Range> at_first = of_cells;

    // Returns the logarithm of the largest factor that is left.
    std::vector<double> best;
    std::vector<Range> best_ranges;
    const auto sweep_over_fitted = [&] {
        double best_farthest = std::numeric_limits<double>::infinity();
        for (int sweep = 0;; ++sweep) {
            Range all;
            for (const std::uint32_t i : fitted) all.take(of_cells[i]);
            if (all.farthest() < best_farthest) {
                best_farthest = all.farthest();
                best.assign(lengths.begin(), lengths.end());
                best_ranges = of_cells;
            }
            if (sweep == sweeps) break;
            std::ranges::fill(of_nodes, Range());
            for (const std::uint32_t i : fitted) {
                for (const std::uint32_t node : nodes[i]) of_nodes[node].take(of_cells[i]);
            }
            for (std::size_t n = 0; n < lengths.size(); ++n) {
                if (of_nodes[n].most < of_nodes[n].least) continue;
                lengths[n] *= std::exp(-0.5 * share * (of_nodes[n].least + of_nodes[n].most));
            }
            in_parallel(fitted.size(), [&](std::size_t k) {
                const std::uint32_t i = fitted[k];
                of_cells[i] = range_of(samples_[i], nodes[i], lengths);
            });
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
        left = sweep_over_fitted();
        std::ranges::fill(is_spoiled, std::uint8_t{0});
        for (const std::uint32_t i : fitted) {
            if (needs_fit(i) || !is_off(i)) continue;
            for (const std::uint32_t node : nodes[i]) is_spoiled[node] = 1;
        }
        const auto spoils = [&](std::uint32_t i) {
            return std::ranges::any_of(nodes[i],
                                       [&](std::uint32_t node) { return is_spoiled[node] != 0; });
        };
        const std::size_t before = fitted.size();
        std::erase_if(fitted, [&](std::uint32_t i) {
            return needs_fit(i) && (round == most_rounds || is_off(i) || spoils(i));
        });
        if (fitted.size() == before) break;
        set_to_field();
        of_cells = at_first;
    }
    return fitted.size() < cells ? std::numeric_limits<double>::infinity() : std::exp(left);
}

}  // namespace controlspace
