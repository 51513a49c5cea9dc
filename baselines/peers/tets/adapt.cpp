#include <tbb/parallel_for.h>

#include <algorithm>

#include "baselines/peers/tets/background_tets.h"
#include "cones/spatial_order.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/detail/goal_field.h"
#include "controlspace/space/sample_parallel.h"

namespace controlspace {

namespace {

/// A place that rounding has moved off a face of the domain is put back on it. Beside the face it
/// would leave a tetrahedron without height there, in which the same place is missed again.
Point on_near_faces(Point x, const Box& domain) {
    for (Axis a = 0; a < 3; ++a) {
        const double close = 1e-9 * (domain.high[a] - domain.low[a]);
        if (x[a] < domain.low[a] + close) x[a] = domain.low[a];
        if (x[a] > domain.high[a] - close) x[a] = domain.high[a];
    }
    return x;
}

}  // namespace

/// Places where tetrahedra are compared with a goal.
struct BackgroundTets::Comparison {
    std::vector<Point> x;
    std::vector<Metric> wanted;

    void ask(const ControlSpace& goal) {
        wanted.resize(x.size());
        sample_parallel(goal, x, wanted);
    }
};

AdaptationReport BackgroundTets::adapt(const AdaptationGoal& goal) {
    options_.h_max = std::min(options_.h_max, goal.h_max);
    const GoalField wanted(goal, domain());
    clear(largest_metric(options_));
    Comparison corners{positions(control_nodes(Neighbourhood::faces).graph), {}};
    corners.ask(wanted);
    assign(corners.wanted);

    Comparison named;
    for (const PointSource& source : goal.sources) named.x.push_back(source.position);
    for (const Point& place : goal.places) named.x.push_back(clamped(place));
    // Each is searched from the one before.
    std::vector<Point> near_the_last;
    for (const std::uint32_t i : spatial_order(named.x)) near_the_last.push_back(named.x[i]);
    named.x = std::move(near_the_last);
    named.ask(wanted);
    // Between the places that are compared it may miss the goal by somewhat more.
    const double allowed = 0.75 * goal.target;
    bool has_room = true;
    while (has_room && refine(named, wanted, allowed)) {
        has_room = bytes() <= static_cast<double>(options_.max_bytes);
    }
    AdaptationReport report;
    report.reached = wanted.largest_departure(domain(), [&](auto x, auto out) { sample(x, out); });
    report.met = has_room && report.reached <= goal.target;
    if (!has_room) {
        report.shortfall = "more tetrahedra would outgrow the cap on memory";
    } else if (!report.met) {
        report.shortfall =
            "tetrahedra follow the field at sources, edges and five places inside: between "
            "these it is missed; give a smaller target";
    }
    return report;
}

// Makes a vertex of the place where a tetrahedron misses the goal most: of its centre, places half
// way from there to its corners, the middles of its edges, and what is named. Returns whether there
// was any.
bool BackgroundTets::refine(Comparison& named, const ControlSpace& goal, double allowed) {
    Comparison places = named;
    std::vector<Delaunay::Cell_handle> cells(named.x.size());
    std::vector<Metric> own(named.x.size());
    Delaunay::Cell_handle near;
    for (std::size_t i = 0; i < named.x.size(); ++i) {
        const Place place = locate(named.x[i], near);
        near = cells[i] = place.cell;
        own[i] = blended(place);
    }
    const auto corners = static_cast<std::size_t>(corners_of_cell());
    Comparison inside;
    for_each_cell([&](Delaunay::Cell_handle cell) {
        if (cell->info().worst != TetState::unknown) return;
        cell->info().worst = TetState::settled;
        std::array<Delaunay::Vertex_handle, 4> vertices;
        for (std::size_t i = 0; i < corners; ++i) vertices[i] = cell->vertex(static_cast<int>(i));
        const auto compare = [&](const std::array<double, 4>& weights) {
            Point x = Point::Zero();
            for (std::size_t i = 0; i < corners; ++i) {
                x += weights[i] * position(vertices[i]);
            }
            inside.x.push_back(on_near_faces(x, domain()));
            own.push_back(blended({cell, corners_of_cell(), vertices, weights}));
            cells.push_back(cell);
        };
        std::array<double, 4> centre{};
        std::fill_n(centre.begin(), corners, 1 / static_cast<double>(corners));
        compare(centre);
        for (std::size_t i = 0; i < corners; ++i) {
            std::array<double, 4> weights = centre;
            for (double& weight : weights) weight /= 2;
            weights[i] += 0.5;
            compare(weights);
            for (std::size_t j = 0; j < i; ++j) {
                weights = {};
                weights[i] = weights[j] = 0.5;
                compare(weights);
            }
        }
    });
    inside.ask(goal);
    places.x.insert(places.x.end(), inside.x.begin(), inside.x.end());
    places.wanted.insert(places.wanted.end(), inside.wanted.begin(), inside.wanted.end());

    std::vector<double> departures(places.x.size());
    tbb::parallel_for(std::size_t{0}, departures.size(), [&](std::size_t i) {
        departures[i] = directional_nonconformity(own[i], places.wanted[i]);
    });
    for (std::uint32_t i = 0; i < departures.size(); ++i) {
        if (departures[i] <= allowed) continue;
        std::uint32_t& worst = cells[i]->info().worst;
        if (worst >= TetState::settled || departures[i] > departures[worst]) worst = i;
    }
    Comparison chosen;
    for (std::uint32_t i = 0; i < departures.size(); ++i) {
        if (cells[i]->info().worst != i) continue;
        chosen.x.push_back(places.x[i]);
        chosen.wanted.push_back(places.wanted[i]);
        cells[i]->info().worst = TetState::settled;  // numbers are those of this pass
    }
    return add(chosen.x, chosen.wanted) > 0;
}

}  // namespace controlspace
