// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "baselines/peers/tets/background_tets.h"
#include "cones/spatial_order.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/sample_parallel.h"
#include "space/goal_field.h"

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

/// A place where a tetrahedron is compared with a goal.
struct BackgroundTets::Comparison {
    Place at;
    Point x;
    Metric wanted = {};
    double departure = 0;
};

AdaptationReport BackgroundTets::adapt(const AdaptationGoal& goal) {
    options_.h_max = std::min(options_.h_max, goal.h_max);
    const GoalField wanted(goal, domain());
    is_isotropic_ = blend_ == TetBlend::view && wanted.has_ranges();
    clear(largest_metric(options_));
    const std::vector<Point> corners = positions(control_nodes(Neighbourhood::faces).graph);
    assign(sample_parallel(wanted, corners));

    std::vector<Point> places(goal.places.begin(), goal.places.end());
    for (const PointSource& source : goal.sources) places.push_back(source.position);
    std::vector<Comparison> named;  // each is searched from the one before
    for (const std::uint32_t i : spatial_order(places)) {
        named.push_back({{}, nearest_in(domain(), places[i])});
    }
    ask(named, wanted);
    // Beside the largest errors that are found there may be somewhat larger ones, of tensors more
    // so.
    const double allowed = (wanted.has_ranges() ? 0.8 : 0.75) * goal.target;
    AdaptationReport report;
    while (refine(named, wanted, allowed, report.shortfall)) continue;
    report.reached = wanted.largest_departure(domain(), [&](auto x, auto out) { sample(x, out); });
    report.met = report.shortfall.empty() && report.reached <= goal.target;
    if (!report.met && report.shortfall.empty()) {
        report.shortfall =
            "tetrahedra follow the field at sources and where it is searched for their largest "
            "errors: elsewhere it is missed; give a smaller target";
    }
    return report;
}

void BackgroundTets::ask(std::span<Comparison> places, const ControlSpace& goal) {
    std::vector<Point> x;
    for (const Comparison& place : places) x.push_back(place.x);
    const std::vector<Metric> wanted = sample_parallel(goal, x);
    for (std::size_t i = 0; i < x.size(); ++i) places[i].wanted = wanted[i];
}

void BackgroundTets::compare(std::span<Comparison> places) const {
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
        places[i].departure = directional_nonconformity(blended(places[i].at), places[i].wanted);
    });
}

// Of each new tetrahedron the place where it misses the goal most: of its centre, places half way
// from there to its corners, and the middles of its edges, or, if these are close to the goal,
// found from the worst of them by ever smaller steps towards its corners.
std::vector<BackgroundTets::Comparison> BackgroundTets::worst_inside(const ControlSpace& goal,
                                                                     double allowed) {
    const auto corners = static_cast<std::size_t>(corners_of_cell());
    const auto at = [&](Place place, const std::array<double, 4>& weights) {
        place.weights = weights;
        Point x = Point::Zero();
        for (std::size_t i = 0; i < corners; ++i) x += weights[i] * position(place.vertices[i]);
        return Comparison{place, on_near_faces(x, domain())};
    };
    // From `from` to corner i by this share of the way.
    const auto towards = [](std::array<double, 4> from, std::size_t i, double share) {
        for (double& weight : from) weight *= 1 - share;
        from[i] += share;
        return from;
    };
    std::vector<Comparison> worst, tried;
    std::vector<std::size_t> of;  // the tetrahedra that `tried` are of
    const auto keep_worse = [&] {
        ask(tried, goal);
        compare(tried);
        for (std::size_t i = 0; i < tried.size(); ++i) {
            if (tried[i].departure > worst[of[i]].departure) worst[of[i]] = tried[i];
        }
        tried.clear();
        of.clear();
    };
    for_each_cell([&](Delaunay::Cell_handle cell) {
        if (cell->info().worst != TetState::unknown) return;
        cell->info().worst = TetState::settled;
        Place place{.cell = cell, .count = corners_of_cell(), .vertices = {}, .weights = {}};
        for (std::size_t i = 0; i < corners; ++i) {
            place.vertices[i] = cell->vertex(static_cast<int>(i));
        }
        std::array<double, 4> centre{};
        std::fill_n(centre.begin(), corners, 1 / static_cast<double>(corners));
        tried.push_back(at(place, centre));
        for (std::size_t i = 0; i < corners; ++i) {
            tried.push_back(at(place, towards(centre, i, 0.5)));
            for (std::size_t j = 0; j < i; ++j) {
                tried.push_back(at(place, towards(towards({}, i, 1), j, 0.5)));
            }
        }
        of.resize(tried.size(), worst.size());
        worst.push_back(tried.back());
    });
    keep_worse();
    for (double share = 0.4; share > 0.01; share *= 0.6) {
        for (std::size_t k = 0; k < worst.size(); ++k) {
            if (worst[k].departure > allowed || worst[k].departure < 0.2 * allowed) continue;
            for (std::size_t i = 0; i < corners; ++i) {
                tried.push_back(at(worst[k].at, towards(worst[k].at.weights, i, share)));
            }
            of.resize(tried.size(), k);
        }
        keep_worse();
    }
    return worst;
}

// Makes a vertex of the place where a tetrahedron misses the goal most, of these and what is
// named. Returns whether there was any, and room for them.
bool BackgroundTets::refine(std::vector<Comparison>& named, const ControlSpace& goal,
                            double allowed, std::string& shortfall) {
    std::vector<Comparison> places = worst_inside(goal, allowed);
    Delaunay::Cell_handle near;
    for (Comparison& place : named) {
        place.at = locate(place.x, near);
        near = place.at.cell;
    }
    compare(named);
    places.insert(places.end(), named.begin(), named.end());
    std::erase_if(places, [&](const Comparison& place) { return place.departure <= allowed; });
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        std::uint32_t& worst = places[i].at.cell->info().worst;
        if (worst >= TetState::settled || places[i].departure > places[worst].departure) worst = i;
    }
    std::vector<Point> x;
    std::vector<Metric> metrics;
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        if (places[i].at.cell->info().worst != i) continue;
        places[i].at.cell->info().worst = TetState::settled;  // numbers are those of this pass
        x.push_back(places[i].x);
        metrics.push_back(places[i].wanted);
    }
    if (bytes_with(x.size()) > static_cast<double>(options_.max_bytes)) {
        shortfall = "more tetrahedra would outgrow the cap on memory";
        return false;
    }
    return add(x, metrics) > 0;
}

}  // namespace controlspace
