// SPDX-License-Identifier: Apache-2.0
// Sources that are as bad as they may be: what every structure of the catalogue still promises.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "contract/structure_case.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "editable_space.h"
#include "metric/draw.h"

namespace controlspace::extreme_sources_test {
namespace {

constexpr double g = 1.25;

/// Lengths from 1e-12 to 1 in a domain of length 2, in an order without any.
Work twelve_orders() {
    Work work{"twelve orders", {}};
    Draw draw(1);
    for (int i = 0; i <= 24; ++i) {
        const Point p(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        work.sources.push_back({p, Metric::isotropic(std::pow(10, -0.5 * ((i * 7) % 25)))});
    }
    return work;
}

/// Thin along three directions at one place, and, turned, at another.
Work crossing() {
    Work work{"crossing", {}};
    Draw draw(2);
    for (const Point& p : {Point(0.3, -0.2, 0.1), Point(-0.5, 0.5, -0.5)}) {
        const Eigen::Matrix3d frame =
            p.x() > 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : draw.rotation();
        for (const std::array<double, 3>& lengths :
             {std::array{0.1, 0.8, 0.8}, {0.8, 0.1, 0.8}, {0.8, 0.8, 0.1}}) {
            work.sources.push_back({p, metric_from_frame(lengths, frame)});
        }
    }
    return work;
}

Work single() { return {"single", {{Point(0.3, -0.7, 0.123), Metric::isotropic(0.05)}}}; }
Work single_thin() {
    return {"single, thin", {{Point(0.3, -0.7, 0.123), {0.1, 0.4, 0.3, 0.05, 0.02, -0.03}}}};
}

/// In the plane z = 0.25, where octrees cut, and on a line along its diagonal.
Work in_plane() {
    Work work{"plane", {}};
    for (int i = -4; i <= 4; ++i) {
        for (int j = -4; j <= 4; ++j) {
            work.sources.push_back({Point(0.2 * i, 0.2 * j, 0.25), Metric::isotropic(0.1)});
        }
    }
    return work;
}
Work on_line() {
    Work work{"line", {}};
    for (int i = -10; i <= 10; ++i) {
        work.sources.push_back({Point(0.09 * i, 0.09 * i, 0.25), {0.1, 0.2, 0.4, 0, 0, 0}});
    }
    return work;
}
/// In corners, on edges and on faces of the domain.
Work on_border() {
    Work work{"border", {}};
    for (const Point& p : {Point(-1, -1, -1), Point(1, 1, 1), Point(1, -1, 0.3), Point(-1, 0, 0)}) {
        work.sources.push_back({p, Metric::isotropic(0.1)});
    }
    return work;
}

Work any_work() {
    return GENERATE(twelve_orders(), crossing(), single(), single_thin(), in_plane(), on_line(),
                    on_border());
}

/// No intersection is smaller. In inverse squares, that of k tensors is at most their sum.
double least_length(const Work& work) {
    const double k = work.isotropic() ? 1 : static_cast<double>(work.sources.size());
    return finest_length(work.sources) / std::sqrt(k);
}

/// Deep enough for lengths of 1e-12 (2^42 of them in the domain), and grids of 17^3 cells.
std::unique_ptr<EditableSpace> inserted(const Work& work, const CatalogueEntry& structure) {
    SpaceOptions options = work.options();
    options.octree_depth = 44;
    if (structure.has<VoxelSize>()) options.voxel = 0.12;
    auto space = editable(structure.make(options));
    space->insert(work.sources);
    return space;
}

/// Anywhere, at the sources and around them, at the corners of the domain.
std::vector<Point> places(const Work& work) {
    std::vector<Point> x = random_points(work.domain, 500, 3);
    Draw draw(4);
    for (const PointSource& s : work.sources) {
        x.push_back(s.position);
        for (int i = 0; i < 4; ++i) {
            const double distance = mean_length(s.metric) * draw.uniform(0, 3);
            x.push_back(s.position + distance * draw.vector());
        }
    }
    for (int corner = 0; corner < 8; ++corner) {
        x.emplace_back(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    }
    return x;
}

/// Number of answers that are no metric; or lie outside what any source and the domain allow, which
/// quadratic functions may.
std::size_t bad_answers(const ControlSpace& space, const std::vector<Point>& x, double smallest,
                        double largest, int order) {
    std::vector<Metric> m(x.size());
    space.sample(x, m);
    return static_cast<std::size_t>(std::count_if(m.begin(), m.end(), [&](const Metric& answer) {
        if (!is_positive_definite(answer)) return true;
        const EigenFrame frame = eigen_frame(answer);
        const double low = order == 2 ? 0.49 * smallest : smallest * (1 - 1e-6);
        const double high = order == 2 ? 1.2 * largest : largest * (1 + 1e-9);
        return frame.lengths[0] < low || frame.lengths[2] > high;
    }));
}

/// Largest δ over the sources between what is held there and what it should at most be. K_Li holds
/// at its leaf's centre what is requested, and grows from there as the gradation allows.
/// Nodes that take the exact field are longer by up to the growth on the way to them, or twice.
constexpr bool by_exact_nodes = true;
double worst_at_sources(const ControlSpace& space, const std::vector<PointSource>& sources,
                        int order, bool has_exact_nodes = false) {
    double worst = 0;
    for (const PointSource& s : sources) {
        const Metric held = sample_at(space, s.position);
        const Box cell = space.cell_at(s.position).value();
        const Vector to_centre = s.position - cell.centre();
        double growth = order == 2 ? 1 + (g - 1) * metric_length(s.metric, to_centre) : 1;
        if (has_exact_nodes) {
            double across = 0;
            for (Axis a = 0; a < 3; ++a) {
                across += metric_length(s.metric, cell.edges()[a] * Vector::Unit(a));
            }
            growth *= std::min(2.0, 1 + (g - 1) * across);
        }
        worst = std::max(worst, nonconformity(held, intersection(held, growth * s.metric)));
    }
    return worst;
}

}  // namespace

STRUCTURE_CASE(does_not_round,
               "bad sources: answers stay metrics, sources are met, gradation holds") {
    const Work work = any_work();
    const std::vector<Point> x = places(work);
    const double smallest = least_length(work);
    const double largest = work.domain.half_diagonal();
    CAPTURE(work.name);
    const int order = structure.order;
    const auto space = inserted(work, structure);
    CHECK(bad_answers(*space, x, smallest, largest, order) == 0);
    CHECK(worst_at_sources(*space, work.sources, order) < 0.2);

    const GradationReport report = space->grade({.schedule = GradationSchedule::queue, .ratio = g});
    CHECK(bad_answers(*space, x, smallest, largest, order) == 0);
    CHECK(worst_at_sources(*space, work.sources, order) < 0.2);
    // Three sources cannot stand for all tensors that cut a leaf.
    if (keeps_values(structure) || work.isotropic()) {
        CHECK(report.largest_ratio_left <= g * (1 + 1e-4));
    }

    const auto exact = inserted(work, structure);
    exact->grade({.ratio = g});
    CHECK(bad_answers(*exact, x, smallest, largest, order) == 0);
    CHECK(worst_at_sources(*exact, work.sources, order, by_exact_nodes) < 0.2);
}

STRUCTURE_CASE(does_not_round,
               "bad sources: the order in which they come does not decide what is met") {
    Work work = GENERATE(twelve_orders(), crossing());
    std::shuffle(work.sources.begin(), work.sources.end(), std::mt19937(5));
    CAPTURE(work.name);
    const auto space = inserted(work, structure);
    space->grade({.ratio = g});
    CHECK(worst_at_sources(*space, work.sources, structure.order, by_exact_nodes) < 0.2);
}

}  // namespace controlspace::extreme_sources_test
