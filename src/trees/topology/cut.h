#pragma once

#include <array>
#include <concepts>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/subdivision.h"

namespace controlspace {

/// Compiles for what is a cut, the inner node of a tree (KdNode, OctreeNode): how a box is divided,
/// into how many parts, and which of them holds a place. Says otherwise what it lacks.
template <class Node>
consteval void check_cut() {
    static_assert(
        requires {
            { Node::arity } -> std::convertible_to<int>;
        },
        "a cut needs a constant `int arity`, 2 or 8");
    static_assert(
        requires(const Subdivision& s) { Node(s); },
        "a cut needs a constructor from `const Subdivision&`");
    static_assert(
        requires(const Node& node, const Box& box) {
            { node.subdivision(box) } -> std::same_as<Subdivision>;
        },
        "a cut needs `Subdivision subdivision(const Box&)`, which it has made of the box");
    static_assert(
        requires(const Box& box, const std::array<double, 3>& along) {
            { Node::even_subdivision(box) } -> std::same_as<Subdivision>;
            { Node::subdivision_across(box, along) } -> std::same_as<Subdivision>;
        },
        "a cut needs the static `even_subdivision(box)` and `subdivision_across(box, along)`");
    static_assert(
        requires(const Node& node, const Point& x, Box& box) {
            { node.child_with(x) } -> std::same_as<int>;
            { node.descend(x, box) } -> std::same_as<int>;
            node.narrow(box, 0);
        },
        "a cut needs `int child_with(x)`, `int descend(x, box)` and `narrow(box, child)`");
    static_assert(
        requires(Node & node) {
            node.children[0];
            node.set_child(0, node.children[0]);
            { node.planes() } -> std::convertible_to<std::span<double>>;
            { node.plane_axis(0) } -> std::same_as<Axis>;
        },
        "a cut needs `children`, `set_child(c, ref)`, `planes()` and `plane_axis(i)`");
}

}  // namespace controlspace
