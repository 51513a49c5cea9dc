// SPDX-License-Identifier: Apache-2.0
#include "io/text/bisected_box.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/extent_of.h"
#include "refuse.h"

namespace controlspace {
namespace {

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    return std::uint64_t{a} << 32 | b;
}

/// The orders of the axes along which a path leads from the low corner of a cube to the high one.
constexpr std::array<std::array<int, 3>, 6> paths{
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

}  // namespace

BisectedBox::BisectedBox(const Box& box) : box_(box) {
    constexpr double most = 64;
    const Vector edges = box.edges();
    const double cube = std::max(edges.minCoeff(), edges.maxCoeff() / most);
    std::array<std::uint32_t, 3> step{1, 0, 0};  // between points, along each axis
    for (Axis a = 0; a < 3; ++a) {
        const auto i = static_cast<std::size_t>(a);
        cubes_[i] = static_cast<int>(std::max(1.0, std::round(edges[a] / cube)));
        if (i < 2) step[i + 1] = step[i] * static_cast<std::uint32_t>(cubes_[i] + 1);
    }
    const auto at = [&](Axis a, int i) {
        const int n = cubes_[static_cast<std::size_t>(a)];
        return i == n ? box.high[a] : box.low[a] + edges[a] * i / n;
    };
    for (int k = 0; k <= cubes_[2]; ++k) {
        for (int j = 0; j <= cubes_[1]; ++j) {
            for (int i = 0; i <= cubes_[0]; ++i) points_.emplace_back(at(0, i), at(1, j), at(2, k));
        }
    }
    for (int k = 0; k < cubes_[2]; ++k) {
        for (int j = 0; j < cubes_[1]; ++j) {
            for (int i = 0; i < cubes_[0]; ++i) {
                const std::array<int, 3> cell{i, j, k};
                std::uint32_t low = 0;
                for (std::size_t a = 0; a < 3; ++a)
                    low += static_cast<std::uint32_t>(cell[a]) * step[a];
                for (const auto& path : paths) {
                    Corners corners{low, 0, 0, 0};
                    for (std::size_t c = 0; c < 3; ++c) {
                        corners[c + 1] = corners[c] + step[static_cast<std::size_t>(path[c])];
                    }
                    all_.push_back({corners});
                }
            }
        }
    }
}

BisectedBox::Place BisectedBox::place_of(const Point& x) const {
    Vector inside;  // of its cube, from 0 to 1
    std::size_t cube = 0;
    for (Axis a = 2; a >= 0; --a) {
        const int n = cubes_[static_cast<std::size_t>(a)];
        const double steps = (x[a] - box_.low[a]) / box_.edges()[a] * n;
        const int i = std::clamp(static_cast<int>(steps), 0, n - 1);
        inside[a] = std::clamp(steps - i, 0.0, 1.0);
        cube = cube * static_cast<std::size_t>(n) + static_cast<std::size_t>(i);
    }
    std::size_t path = 0;
    const auto falls = [&](const std::array<int, 3>& p) {
        return inside[p[0]] >= inside[p[1]] && inside[p[1]] >= inside[p[2]];
    };
    while (!falls(paths[path])) ++path;
    const double first = inside[paths[path][0]], second = inside[paths[path][1]],
                 third = inside[paths[path][2]];
    Place place{paths.size() * cube + path, {1 - first, first - second, second - third, third}};
    descend(place);
    return place;
}

// The weights follow from each other: a x0 + b xk is (a - b) x0 + 2 b z with z between the two.
void BisectedBox::descend(Place& place) const {
    while (all_[place.tetrahedron].parts != 0) {
        const Tetrahedron& t = all_[place.tetrahedron];
        auto& w = place.weights;
        const double at_first = w[0], at_cut = w[t.cut];
        place.tetrahedron = t.parts;
        if (at_first >= at_cut) {
            w[0] = at_first - at_cut;
            w[t.cut] = 2 * at_cut;
        } else {
            ++place.tetrahedron;
            std::rotate(w.begin(), w.begin() + 1, w.begin() + t.cut + 1);
            w[t.cut - 1u] = at_cut - at_first;
            w[t.cut] = 2 * at_first;
        }
    }
}

std::uint32_t BisectedBox::middle(std::uint32_t a, std::uint32_t b) {
    const auto next = static_cast<std::uint32_t>(points_.size());
    const auto [found, is_new] = middles_.try_emplace(edge_key(a, b), next);
    if (is_new) {
        points_.push_back(0.5 * (points_[a] + points_[b]));
        new_edges_.push_back(found->first);
    }
    return found->second;
}

void BisectedBox::bisect(std::size_t tetrahedron) {
    const Tetrahedron t = all_[tetrahedron];
    const std::uint32_t z = middle(t.corners[0], t.corners[t.cut]);
    Tetrahedron low = t, high = t;
    low.cut = high.cut = static_cast<std::uint8_t>(t.cut > 1 ? t.cut - 1 : 3);
    low.corners[t.cut] = z;
    std::rotate(high.corners.begin(), high.corners.begin() + 1, high.corners.begin() + t.cut + 1);
    high.corners[t.cut] = z;
    all_[tetrahedron].parts = static_cast<std::uint32_t>(all_.size());
    all_.push_back(low);
    all_.push_back(high);
}

void BisectedBox::refine_to(const Box& cell, const Point& x) {
    constexpr double rounding = 1 + 1e-9;
    Place place = place_of(x);
    const auto is_large = [&] {
        const Box box =
            extent_of(all_[place.tetrahedron].corners, [&](std::uint32_t i) { return points_[i]; });
        return (box.edges().array() > rounding * cell.edges().array()).any();
    };
    constexpr std::size_t most_points = 20'000'000;
    while (is_large()) {
        if (points_.size() >= most_points) {
            refuse(
                "a mesh of tetrahedra as small as the cells has more than {} points: "
                "give a coarser structure, or another format",
                most_points);
        }
        bisect(place.tetrahedron);
        descend(place);
    }
}

void BisectedBox::refine(const std::vector<std::size_t>& wanted) {
    for (const std::size_t t : wanted) bisect(t);
}

void BisectedBox::close() {
    while (!new_edges_.empty()) {
        // Most tetrahedra are far from all new edges, which the ends tell sooner than the edges.
        std::vector<bool> is_end(points_.size(), false);
        for (const std::uint64_t edge : new_edges_) {
            is_end[edge >> 32] = is_end[edge & 0xffffffffu] = true;
        }
        new_edges_.clear();
        const std::size_t present = all_.size();
        for (std::size_t t = 0; t < all_.size(); ++t) {
            if (all_[t].parts != 0) continue;
            const Corners c = all_[t].corners;
            // What was bisected here may leave parts with an edge that was bisected long before.
            const auto may_be_end = [&](std::uint32_t p) { return t >= present || is_end[p]; };
            bool is_bisected = false;
            for (std::size_t i = 0; i < 4 && !is_bisected; ++i) {
                for (std::size_t j = i + 1; j < 4 && may_be_end(c[i]); ++j) {
                    is_bisected = is_bisected ||
                                  (may_be_end(c[j]) && middles_.contains(edge_key(c[i], c[j])));
                }
            }
            if (is_bisected) bisect(t);
        }
    }
}

std::vector<std::size_t> BisectedBox::leaves() const {
    std::vector<std::size_t> found;
    for (std::size_t t = 0; t < all_.size(); ++t) {
        if (all_[t].parts == 0) found.push_back(t);
    }
    return found;
}

}  // namespace controlspace
