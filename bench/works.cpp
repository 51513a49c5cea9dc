// SPDX-License-Identifier: Apache-2.0
#include "works.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstdint>

#include "controlspace/measure/access_time.h"
#include "controlspace/measure/accuracy.h"
#include "geometry/random_fractions.h"

namespace controlspace {

namespace {

constexpr std::size_t queries = 100'000;
constexpr int grid_edge = 47;  // its cube is close to that

// Half the mean length of an element there.
double half_step(const ControlSpace& field, const Point& x) {
    return 0.5 * mean_length(sample_at(field, x));
}

std::vector<Point> walk(const ControlSpace& field) {
    RandomFractions fraction(3);
    std::vector<Point> x{Point(0.8, 0.1, 0.1)};
    while (x.size() < queries) {
        const Vector way(fraction() - 0.5, fraction() - 0.5, fraction() - 0.5);
        const Point next = x.back() + half_step(field, x.back()) * way.normalized();
        x.push_back(field.domain().contains(next) ? next : x.back());
    }
    return x;
}

// With density 1 / det M: a cell of a fine grid by its share, then a place in it.
std::vector<Point> where_elements_are(const ControlSpace& field) {
    constexpr int n = 128;
    const std::vector<Point> cells = cell_centres(field.domain(), n);
    std::vector<Metric> metrics(cells.size());
    field.sample(cells, metrics);
    std::vector<double> sums(cells.size());
    double sum = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        sums[i] = sum += 1 / metrics[i].matrix().determinant();
    }
    RandomFractions fraction(2);
    std::vector<Point> x(queries);
    for (Point& p : x) {
        const auto drawn = std::upper_bound(sums.begin(), sums.end() - 1, fraction() * sum);
        const Vector offset(fraction() - 0.5, fraction() - 0.5, fraction() - 0.5);
        p = cells[static_cast<std::size_t>(drawn - sums.begin())] +
            offset.cwiseProduct(field.domain().edges()) / n;
    }
    return x;
}

std::uint32_t morton_code(const Box& box, const Point& x) {
    std::uint32_t code = 0;
    for (Axis a = 0; a < 3; ++a) {
        const auto c =
            static_cast<std::uint32_t>(1024 * (x[a] - box.low[a]) / (box.high[a] - box.low[a]));
        for (int bit = 0; bit < 10; ++bit) code |= (c >> bit & 1u) << (3 * bit + a);
    }
    return code;
}

}  // namespace

std::span<const Work> works() {
    static const Work all[] = {{"rho:1/tau:1", 1, {}},
                               {"rho:1/tau:0.2", 0.2, {}},
                               {"rho:0.2/tau:1", 1, {.rho = 0.2}},
                               {"rho:0.2/tau:0.2", 0.2, {.rho = 0.2}},
                               {"layered/tau:1", 1, {.s_a = 4, .s_n = 0.25}}};
    return all;
}

const Box& bench_domain() {
    static const Box domain{Point::Constant(-1), Point::Constant(1)};
    return domain;
}

SpaceOptions options_of(const Work& work, std::span<const PointSource> sources) {
    return {.domain = bench_domain(), .l_min = work.tau, .finest_length = finest_length(sources)};
}

std::unique_ptr<ControlSpaceBuilder> graded(const CatalogueEntry& entry, const Work& work,
                                            SplitRule split, double voxel) {
    const std::vector<PointSource> sources = sample_sphere(work.sampling);
    SpaceOptions options = options_of(work, sources);
    options.split = split;
    options.voxel = voxel;
    auto builder = entry.make(options);
    builder->insert(sources);
    builder->grade({.ratio = options.ratio});
    return builder;
}

std::span<const NamedOrder> orders() {
    static constexpr NamedOrder all[] = {{Order::random, "random"},
                                         {Order::grid, "grid"},
                                         {Order::elements, "elements"},
                                         {Order::morton, "morton"},
                                         {Order::walk, "walk"}};
    return all;
}

std::vector<Point> places(Order order, const ControlSpace& field) {
    const Box box = field.domain();
    if (order == Order::random) return random_points(box, queries, 1);
    if (order == Order::grid) return cell_centres(box, grid_edge);
    if (order == Order::walk) return walk(field);
    std::vector<Point> x = where_elements_are(field);
    if (order == Order::morton) {
        std::sort(x.begin(), x.end(), [&](const Point& p, const Point& q) {
            return morton_code(box, p) < morton_code(box, q);
        });
    }
    return x;
}

}  // namespace controlspace
