// SPDX-License-Identifier: Apache-2.0
#include "baselines/peers/tets/background_tets.h"

#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "cones/spatial_order.h"
#include "controlspace/input_errors.h"
#include "controlspace/metric/blend.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/riemannian.h"
#include "refuse.h"
#include "trees/topology/adjacency.h"

namespace controlspace {

namespace {

TetKernel::Point_3 to_cgal(const Point& p) { return {p.x(), p.y(), p.z()}; }

/// f of the eigenvalues.
template <class Function>
Metric mapped(const Metric& m, Function f) {
    if (is_isotropic(m)) return Metric::isotropic(f(m.xx));
    const EigenFrame frame = eigen_frame(m);
    const auto& [a, b, c] = frame.lengths;
    return metric_from_frame({f(a), f(b), f(c)}, frame.directions);
}

}  // namespace

BackgroundTets::BackgroundTets(const SpaceOptions& options, TetBlend blend)
    : options_(options), blend_(blend) {
    require_valid(options);
    if (options.takes_later_sources) {
        refuse("a background mesh cannot be extended: give all sources at once");
    }
    clear(largest_metric(options));
}

Metric BackgroundTets::encoded(const Metric& m) const {
    if (blend_ == TetBlend::metrics || is_isotropic_) return m;
    if (blend_ == TetBlend::view) return to_riemannian(m);
    return mapped(m, [](double length) { return std::log(length); });
}

Metric BackgroundTets::decoded(const Metric& value) const {
    if (blend_ == TetBlend::metrics || is_isotropic_) return value;
    if (blend_ == TetBlend::view) {
        return mapped(value, [](double inverse_square) { return 1 / std::sqrt(inverse_square); });
    }
    return mapped(value, [](double log) { return std::exp(log); });
}

void BackgroundTets::clear(const Metric& metric) {
    mesh_.clear();
    last_.forget();
    graded_ = false;
    std::vector<Point> corners(8);
    for (int i = 0; i < 8; ++i) corners[static_cast<std::size_t>(i)] = corner(domain(), i);
    add(corners, std::vector<Metric>(corners.size(), metric));
}

std::size_t BackgroundTets::add(std::span<const Point> x, std::span<const Metric> metrics) {
    using Numbered = std::pair<TetKernel::Point_3, std::size_t>;
    std::vector<Numbered> places;
    places.reserve(x.size());
    for (const Point& p : x) places.emplace_back(to_cgal(p), places.size());
    CGAL::spatial_sort(
        places.begin(), places.end(),
        CGAL::Spatial_sort_traits_adapter_3<TetKernel,
                                            CGAL::First_of_pair_property_map<Numbered>>());
    std::size_t changed = 0;
    last_.forget();
    Delaunay::Cell_handle near;
    std::vector<Delaunay::Vertex_handle> made(x.size());
    auto number = static_cast<NodeIndex>(mesh_.number_of_vertices());
    for (const auto& [place, i] : places) {
        const Delaunay::Vertex_handle vertex = mesh_.insert(place, near);
        near = vertex->cell();
        TetVertex& held = vertex->info();
        const bool is_new = held.index == TetVertex::none;
        if (is_new) {
            made[i] = vertex;
            held.index = number;
        }
        const Metric before = is_new ? metrics[i] : decoded(held.value);
        const Metric after = is_new ? before : intersection(before, metrics[i]);
        if (!is_new && after == before) continue;
        held.value = encoded(after);
        ++changed;
    }
    // Numbered as they were given, not as they were sorted.
    for (const Delaunay::Vertex_handle vertex : made) {
        if (vertex != Delaunay::Vertex_handle()) vertex->info().index = number++;
    }
    return changed;
}

InsertionReport BackgroundTets::insert(std::span<const PointSource> sources) {
    const auto refused = std::ranges::find_if_not(
        sources, [&](const PointSource& source) { return is_valid(source, domain()); });
    const auto count = static_cast<std::size_t>(refused - sources.begin());
    const double needed = bytes_with(count);
    if (needed > static_cast<double>(options_.max_bytes)) {
        throw MemoryLimitError(static_cast<std::size_t>(needed),
                               fmt::format("tetrahedra of {} sources take about {:.3g} MB: raise "
                                           "the cap on memory, or give fewer sources",
                                           count, needed / 1e6));
    }
    std::vector<Point> x;
    std::vector<Metric> metrics;
    const Metric largest = largest_metric(options_);
    for (const PointSource& source : sources.first(count)) {
        x.push_back(source.position);
        metrics.push_back(intersection(largest, source.metric));
    }
    if (graded_) {  // the graded field stays, lowered where the sources request it
        std::vector<Metric> held(count);
        sample(x, held);
        for (std::size_t i = 0; i < count; ++i) metrics[i] = intersection(held[i], metrics[i]);
    }
    const InsertionReport report{count, add(x, metrics)};
    if (refused != sources.end()) require_valid(*refused, count, domain());
    return report;
}

GradationReport BackgroundTets::grade(const NodeGradation& gradation) {
    auto [graph, metrics] = control_nodes(gradation.options.neighbourhood);
    const GradationReport report = gradation.field
                                       ? grade_to(*gradation.field, positions(graph), metrics)
                                       : controlspace::grade(graph, metrics, gradation.options);
    assign(metrics);
    return report;
}

void BackgroundTets::assign(std::span<const Metric> metrics) {
    require_one_each(metrics.size(), mesh_.number_of_vertices());
    for (const auto& vertex : mesh_.finite_vertex_handles()) {
        vertex->info().value = encoded(metrics[vertex->info().index]);
    }
    graded_ = true;
}

ControlNodes BackgroundTets::control_nodes(Neighbourhood) const {
    NodeGraph graph;
    std::vector<Metric> metrics(mesh_.number_of_vertices());
    graph.positions.resize(metrics.size());
    for (const auto& vertex : mesh_.finite_vertex_handles()) {
        graph.positions[vertex->info().index] = position(vertex);
        metrics[vertex->info().index] = metric(vertex);
    }
    link(graph, graph.size(), [&](auto&& enter) {
        for (const auto& [cell, i, j] : mesh_.finite_edges()) {
            const NodeIndex a = cell->vertex(i)->info().index, b = cell->vertex(j)->info().index;
            enter(a, b);
            enter(b, a);
        }
    });
    return {std::move(graph), std::move(metrics)};
}

// By the vertices of the smallest face that holds the place, in their order: whichever of the
// tetrahedra around it the walk ends in, the bits are the same.
BackgroundTets::Place BackgroundTets::locate(const Point& x, Delaunay::Cell_handle start) const {
    const Point p = nearest_in(domain(), x);
    Delaunay::Locate_type type;
    int i, j;
    Place place;
    place.cell = mesh_.locate(to_cgal(p), type, i, j, start);
    const auto is_in_face = [&](int k) {
        if (type == Delaunay::VERTEX) return k == i;
        if (type == Delaunay::EDGE) return k == i || k == j;
        return type != Delaunay::FACET || mesh_.dimension() < 3 || k != i;
    };
    for (int k = 0; k < corners_of_cell(); ++k) {
        const Delaunay::Vertex_handle vertex = place.cell->vertex(k);
        if (!is_in_face(k) || mesh_.is_infinite(vertex)) continue;
        place.vertices[static_cast<std::size_t>(place.count++)] = vertex;
    }
    std::sort(place.vertices.begin(), place.vertices.begin() + place.count,
              [](auto a, auto b) { return a->info().index < b->info().index; });
    const Point a = position(place.vertices[0]);
    const auto edge = [&](std::size_t k) { return Vector(position(place.vertices[k]) - a); };
    const Vector q = p - a;
    Eigen::Array4d w = Eigen::Array4d::Zero();
    if (place.count == 2) {
        w[1] = q.dot(edge(1)) / edge(1).squaredNorm();
    } else if (place.count > 2) {
        const Vector b = edge(1), c = edge(2);
        const Vector d = place.count == 4 ? edge(3) : Vector(b.cross(c));
        const Vector cd = c.cross(d);
        const double volume = b.dot(cd);
        w[1] = q.dot(cd) / volume;
        w[2] = b.dot(q.cross(d)) / volume;
        if (place.count == 4) w[3] = b.dot(c.cross(q)) / volume;
    }
    w[0] = 1 - w[1] - w[2] - w[3];
    // Rounding leaves a thin tetrahedron: answers stay between its vertices'.
    w = w.max(0);
    w /= w.sum();
    if (!w.allFinite()) w = {1, 0, 0, 0};
    place.weights = {w[0], w[1], w[2], w[3]};
    return place;
}

Metric BackgroundTets::blended(const Place& place) const {
    return decoded(blend_lengths(
        std::span(place.weights).first(static_cast<std::size_t>(place.count)),
        [&](std::size_t i) -> const Metric& { return place.vertices[i]->info().value; }));
}

void BackgroundTets::sample(std::span<const Point> x, std::span<Metric> out) const {
    Delaunay::Cell_handle cell = last_.get();
    const auto answer = [&](std::size_t i) {
        const Place place = locate(x[i], cell);
        cell = place.cell;
        out[i] = blended(place);
    };
    constexpr std::size_t batch = 32;  // from so many on, shorter walks outweigh the sorting
    if (x.size() < batch) {
        for (std::size_t i = 0; i < x.size(); ++i) answer(i);
    } else {
        for (const std::uint32_t i : spatial_order(x)) answer(i);
    }
    last_.set(cell);
}

double BackgroundTets::bytes() const {
    const Delaunay::Triangulation_data_structure& tds = mesh_.tds();
    return static_cast<double>(tds.vertices().capacity() * sizeof(Delaunay::Vertex) +
                               tds.cells().capacity() * sizeof(Delaunay::Cell));
}

double BackgroundTets::bytes_with(std::size_t vertices) const {
    // CGAL makes some 6.8 tetrahedra of each vertex.
    return bytes() + static_cast<double>(vertices) *
                         (sizeof(Delaunay::Vertex) + 6.8 * sizeof(Delaunay::Cell));
}

Footprint BackgroundTets::footprint() const {
    Footprint footprint;
    footprint.cells =
        mesh_.dimension() == 3 ? mesh_.number_of_finite_cells() : mesh_.number_of_finite_facets();
    footprint.control_nodes = mesh_.number_of_vertices();
    footprint.bytes_payload = mesh_.tds().vertices().capacity() * sizeof(Metric);
    footprint.bytes_topology = static_cast<std::size_t>(bytes()) - footprint.bytes_payload;
    return footprint;
}

void BackgroundTets::save(StateWriter& state) const {
    const ControlNodes nodes = control_nodes(Neighbourhood::faces);
    state("tets.positions", positions(nodes.graph));
    state("tets.metrics", nodes.metrics);
    state("tets.graded", graded_);
}

void BackgroundTets::load(const StateReader& state) {
    std::vector<Point> x;
    std::vector<Metric> metrics;
    state("tets.positions", x);
    state("tets.metrics", metrics);
    const auto is_inside = [&](const Point& p) { return domain().contains(p); };
    state.require(std::ranges::all_of(x, is_inside), "tets.positions", "has places outside");
    state.require(x.size() == metrics.size(), "tets.metrics", "has another length");
    require_metrics(state, "tets.metrics", metrics);
    clear(largest_metric(options_));
    add(x, metrics);
    // The corners are among them.
    state.require(mesh_.number_of_vertices() == x.size(), "tets.positions", "lacks corners");
    assign(metrics);
    state("tets.graded", graded_);
}

}  // namespace controlspace
