// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/fit_lengths.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

namespace controlspace::fit_lengths_test {
namespace {

// A field that is the cone of one source: h + s d, d the distance.
constexpr double h = 0.1, slope = 0.25;
constexpr double allowed = 10;
const Box domain{Point::Constant(-1), Point::Constant(1)};

GoalField cone_of(std::span<const PointSource> source) {
    return {{.sources = source, .continuous = nullptr, .ratio = 1 + slope, .target = 0.1}, domain};
}

struct FittedCell {
    Box box;
    std::array<std::uint32_t, 8> nodes;
};
FittedCell whole() { return {domain, {0, 1, 2, 3, 4, 5, 6, 7}}; }

double fit_lengths(const GoalField& field, const std::vector<FittedCell>& cells, double most,
                   std::vector<double>& lengths) {
    std::vector<std::uint32_t> numbers;
    std::vector<Box> boxes;
    std::vector<std::array<std::uint32_t, 8>> nodes;
    for (const FittedCell& cell : cells) {
        numbers.push_back(static_cast<std::uint32_t>(numbers.size()));
        boxes.push_back(cell.box);
        nodes.push_back(cell.nodes);
    }
    LengthFit fit(field);
    fit.enter(numbers, boxes);
    return fit.fit(nodes, most, lengths);
}

}  // namespace

TEST_CASE("around a source in its middle a cell takes the geometric mean of both ends") {
    const std::vector<PointSource> source{{Point::Zero(), Metric::isotropic(h)}};
    const double at_corners = h + slope * std::sqrt(3.0);
    std::vector<double> lengths(8);
    const std::vector<FittedCell> cells{whole()};
    const double factor = fit_lengths(cone_of(source), cells, allowed, lengths);
    for (const double length : lengths) {
        CHECK(length == Approx(std::sqrt(h * at_corners)).epsilon(1e-5));
    }
    CHECK(factor == Approx(std::sqrt(at_corners / h)).epsilon(1e-5));
}

TEST_CASE("a cell that no fit helps is left out") {
    const std::vector<PointSource> source{{Point::Zero(), Metric::isotropic(h)}};
    const double at_corners = h + slope * std::sqrt(3.0);
    std::vector<double> lengths(8);
    const std::vector<FittedCell> cells{whole()};
    const double needed = std::sqrt(at_corners / h);
    CHECK(fit_lengths(cone_of(source), cells, 1.1 * needed, lengths) < 1.01 * needed);
    CHECK(std::isinf(fit_lengths(cone_of(source), cells, 0.99 * needed, lengths)));
    for (const double length : lengths) CHECK(length == Approx(at_corners));
}

TEST_CASE("a field that cells can hold is left as it is") {
    // Far beyond h_max everything is constant.
    const std::vector<PointSource> source{{Point::Zero(), Metric::isotropic(10)}};
    const GoalField field({.sources = source, .continuous = nullptr, .target = 0.1, .h_max = 0.5},
                          domain);
    std::vector<double> lengths(8);
    const std::vector<FittedCell> cells{whole()};
    CHECK(fit_lengths(field, cells, allowed, lengths) == Approx(1).epsilon(1e-6));
    for (const double length : lengths) CHECK(length == Approx(0.5).epsilon(1e-6));
}

TEST_CASE("cells that share nodes are fitted together, and none is left worse than by the field") {
    const std::vector<PointSource> source{{Point(0.25, -0.25, 0.25), Metric::isotropic(h)}};
    constexpr std::uint32_t n = 4;
    std::vector<FittedCell> cells;
    std::vector<double> lengths((n + 1) * (n + 1) * (n + 1));
    const auto at = [](std::uint32_t i, std::uint32_t j, std::uint32_t k) -> Point {
        return Point(i, j, k) * (2.0 / n) - Point::Constant(1);
    };
    const auto number = [](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
        return (k * (n + 1) + j) * (n + 1) + i;
    };
    for (std::uint32_t k = 0; k <= n; ++k) {
        for (std::uint32_t j = 0; j <= n; ++j) {
            for (std::uint32_t i = 0; i <= n; ++i) {
                lengths[number(i, j, k)] = h + slope * (at(i, j, k) - source[0].position).norm();
                if (i == n || j == n || k == n) continue;
                FittedCell cell{{at(i, j, k), at(i + 1, j + 1, k + 1)}, {}};
                for (std::uint32_t c = 0; c < 8; ++c) {
                    cell.nodes[c] = number(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
                }
                cells.push_back(cell);
            }
        }
    }
    // By 9 x 9 x 9 places of each cell.
    const auto farthest = [&] {
        double most = 1;
        for (const FittedCell& cell : cells) {
            for (int p = 0; p < 729; ++p) {
                const Vector t = Vector(p % 9, p / 9 % 9, p / 81) / 8;
                double length = 0;
                for (int c = 0; c < 8; ++c) {
                    double weight = 1;
                    for (int a = 0; a < 3; ++a) weight *= (c >> a & 1) != 0 ? t[a] : 1 - t[a];
                    length += weight * lengths[cell.nodes[static_cast<std::size_t>(c)]];
                }
                const Point x = cell.box.low + t.cwiseProduct(cell.box.edges());
                const double exact = h + slope * (x - source[0].position).norm();
                most = std::max({most, length / exact, exact / length});
            }
        }
        return most;
    };
    const double before = farthest();
    const double factor = fit_lengths(cone_of(source), cells, allowed, lengths);
    const double after = farthest();
    CHECK(after < std::pow(before, 0.6));  // half of it, as a logarithm, is the least
    CHECK(factor <= after * (1 + 1e-6));
    CHECK(after <= std::pow(factor, 1.1));
}

}  // namespace controlspace::fit_lengths_test
