// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "baselines/peers/tets/delaunay.h"
#include "controlspace/error.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/space_options.h"
#include "space/given_sources.h"
#include "space/state.h"

namespace controlspace {

/// What is linear within a tetrahedron. `view`: what is in Gmsh's views, for adaptation: lengths
/// where all sources are isotropic, otherwise M^-2.
enum class TetBlend { metrics, logarithms, view };

/// A background mesh, as meshers and error estimators use it: CGAL's Delaunay tetrahedra of the
/// sources and the box's corners, a metric at each vertex; in a flat domain triangles.
///
/// Every source is a vertex, without regard to the insertion tolerance. Graded from node to node,
/// metrics grow along the edges of the tetrahedra alone, paths through which are longer than
/// straight lines; by the sources, vertices take the exact field. Neither bounds what is between
/// vertices far apart: adaptation to a goal chooses vertices anew, from the corners, where the
/// linear field misses it most. The data of a SharedBuilder.
class BackgroundTets {
public:
    BackgroundTets(const SpaceOptions& options, TetBlend blend);

    InsertionReport insert(std::span<const PointSource> sources);
    GradationReport grade(const NodeGradation& gradation);
    /// adapt.cpp
    AdaptationReport adapt(const AdaptationGoal& goal);
    static constexpr int order() { return 1; }  // of interpolation
    void assign(std::span<const Metric> metrics);
    ControlNodes control_nodes(Neighbourhood) const;

    /// Walks from where the search before it ended. Thread-safe.
    void sample(std::span<const Point> x, std::span<Metric> out) const;

    Footprint footprint() const;
    std::optional<Box> cell_at(const Point&) const { return std::nullopt; }
    const SpaceOptions& options() const { return options_; }
    const Box& domain() const { return options_.domain; }
    const Delaunay& mesh() const { return mesh_; }
    static Point position(Delaunay::Vertex_handle vertex) {
        return {vertex->point().x(), vertex->point().y(), vertex->point().z()};
    }
    /// The metric of a vertex.
    Metric metric(Delaunay::Vertex_handle vertex) const { return decoded(vertex->info().value); }
    /// 4, or 3 in a flat domain.
    int corners_of_cell() const { return mesh_.dimension() + 1; }
    /// visit(cell) for all tetrahedra, or triangles.
    template <class Visit>
    void for_each_cell(Visit&& visit) const {
        if (mesh_.dimension() == 3) {
            for (const auto& cell : mesh_.finite_cell_handles()) visit(cell);
        } else {
            for (const auto& [cell, _] : mesh_.finite_facets()) visit(cell);
        }
    }

    void save(StateWriter& state) const;
    void load(const StateReader& state);

private:
    /// A place in a tetrahedron, or in its face, edge or vertex.
    struct Place {
        Delaunay::Cell_handle cell;
        int count = 0;
        std::array<Delaunay::Vertex_handle, 4> vertices;
        std::array<double, 4> weights;  ///< >= 0, their sum 1
    };
    Place locate(const Point& x, Delaunay::Cell_handle start) const;
    Metric blended(const Place& place) const;
    Metric encoded(const Metric& m) const;
    Metric decoded(const Metric& value) const;
    /// Vertices at `x` with the metrics; where there is one already, the intersection. Returns how
    /// many were made or made smaller.
    std::size_t add(std::span<const Point> x, std::span<const Metric> metrics);
    /// The corners alone, with the metric.
    void clear(const Metric& metric);
    double bytes() const;
    /// With so many vertices more.
    double bytes_with(std::size_t vertices) const;
    struct Comparison;
    static void ask(std::span<Comparison> places, const ControlSpace& goal);
    void compare(std::span<Comparison> places) const;
    std::vector<Comparison> worst_inside(const ControlSpace& goal, double allowed);
    bool refine(std::vector<Comparison>& named, const ControlSpace& goal, double allowed,
                std::string& shortfall);

    SpaceOptions options_;
    TetBlend blend_;
    bool is_isotropic_ = false;  // as adaptation to isotropic sources alone leaves it
    Delaunay mesh_;
    bool graded_ = false;
    mutable LastCell last_;
};

}  // namespace controlspace
