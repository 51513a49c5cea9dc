// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

using NodeIndex = std::uint32_t;

/// Which control nodes gradation compares with which.
///
/// | neighbourhood     | one node a leaf                       | a node a vertex           |
/// |-------------------|---------------------------------------|---------------------------|
/// | faces             | all leaves across the six faces       | vertices joined by an     |
/// |                   |                                       | edge of a leaf            |
/// | nearest_per_face  | across each face the one leaf nearest | the same                  |
/// |                   | to the leaf's centre; not always      |                           |
/// |                   | mutual (the paper's tables)           |                           |
/// | all               | all leaves that touch, at edges and   | all vertices of a leaf    |
/// |                   | corners too                           |                           |
///
/// A node of a grid has six neighbours, or 26 with `all`. Paths across the faces of a grid are up
/// to √3 times as long as the straight line, those through all neighbours up to 1.13 times.
enum class Neighbourhood { faces, nearest_per_face, all };

/// Control nodes and their neighbours as flat arrays: node i has the neighbours
/// `neighbours[first[i]] .. neighbours[first[i + 1] - 1]`.
struct NodeGraph {
    std::vector<Point> positions;
    std::vector<std::size_t> first;  ///< positions.size() + 1 entries
    std::vector<NodeIndex> neighbours;

    std::size_t size() const { return positions.size(); }
    const Point& position(NodeIndex i) const { return positions[i]; }
    /// visit(j) for the neighbours j of node i.
    template <class Visit>
    void for_each_neighbour(NodeIndex i, Visit&& visit) const {
        for (std::size_t k = first[i]; k < first[i + 1]; ++k) visit(neighbours[k]);
    }
    /// visit(j, v) for the same; v is the displacement from i to j.
    template <class Visit>
    void for_each_link(NodeIndex i, Visit&& visit) const {
        const Point p = positions[i];
        for_each_neighbour(i, [&](NodeIndex j) { visit(j, Vector(positions[j] - p)); });
    }
};

/// Control nodes on a regular lattice, x fastest; nothing is stored per node.
struct Lattice {
    Point origin;  ///< position of node 0
    Vector spacing;
    std::array<std::uint32_t, 3> nodes;  ///< number of nodes along x, y and z
    Neighbourhood neighbourhood = Neighbourhood::faces;

    std::size_t size() const { return std::size_t{nodes[0]} * nodes[1] * nodes[2]; }
    NodeIndex index(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
        return (k * nodes[1] + j) * nodes[0] + i;
    }
    std::array<std::uint32_t, 3> coordinates(NodeIndex n) const {
        return {n % nodes[0], n / nodes[0] % nodes[1], n / nodes[0] / nodes[1]};
    }
    Point position(NodeIndex n) const {
        const auto [i, j, k] = coordinates(n);
        return origin + spacing.cwiseProduct(Vector(i, j, k));
    }
    template <class Visit>
    void for_each_neighbour(NodeIndex n, Visit&& visit) const {
        for_each_link(n, [&](NodeIndex j, const Vector&) { visit(j); });
    }
    template <class Visit>
    void for_each_link(NodeIndex n, Visit&& visit) const {
        if (neighbourhood == Neighbourhood::all) {
            for_each_link_around(n, visit);
        } else {
            for_each_link_across_faces(n, visit);
        }
    }

private:
    template <class Visit>
    void for_each_link_across_faces(NodeIndex n, Visit& visit) const {
        const auto c = coordinates(n);
        NodeIndex stride = 1;
        for (Axis a = 0; a < 3; ++a) {
            const auto axis = static_cast<std::size_t>(a);
            const Vector step = spacing[a] * Vector::Unit(a);
            if (c[axis] > 0) visit(n - stride, -step);
            if (c[axis] + 1 < nodes[axis]) visit(n + stride, step);
            stride *= nodes[axis];
        }
    }
    template <class Visit>
    void for_each_link_around(NodeIndex n, Visit& visit) const {
        const auto c = coordinates(n);
        const auto low = [&](std::size_t a) { return c[a] - (c[a] > 0 ? 1 : 0); };
        const auto high = [&](std::size_t a) { return c[a] + (c[a] + 1 < nodes[a] ? 1 : 0); };
        const auto steps = [](std::uint32_t to, std::uint32_t from) {
            return static_cast<double>(to) - static_cast<double>(from);
        };
        for (std::uint32_t k = low(2); k <= high(2); ++k) {
            for (std::uint32_t j = low(1); j <= high(1); ++j) {
                for (std::uint32_t i = low(0); i <= high(0); ++i) {
                    const NodeIndex other = index(i, j, k);
                    if (other == n) continue;
                    const Vector way(steps(i, c[0]), steps(j, c[1]), steps(k, c[2]));
                    visit(other, Vector(spacing.cwiseProduct(way)));
                }
            }
        }
    }
};

using ControlGraph = std::variant<NodeGraph, Lattice>;

/// The positions of the nodes, in their order.
inline std::vector<Point> positions(const ControlGraph& graph) {
    return std::visit(
        [](const auto& nodes) {
            std::vector<Point> x(nodes.size());
            for (NodeIndex i = 0; i < x.size(); ++i) x[i] = nodes.position(i);
            return x;
        },
        graph);
}

}  // namespace controlspace
