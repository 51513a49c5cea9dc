// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/subdivision.h"
#include "controlspace/trees/cell_model.h"

namespace controlspace {

// A cut is the inner node of a tree: how a box is divided into parts, and which part holds a point.

/// Reference to a part of a tree: a leaf, or an inner node; 30 bits of index. The remaining bit is
/// free for the node that holds the reference.
class Ref {
public:
    static constexpr std::uint32_t leaf_bit = 1u << 31;
    static constexpr std::uint32_t spare_bit = 1u << 30;
    static constexpr std::uint32_t max_index = spare_bit - 1;

    static Ref leaf(LeafIndex i) { return Ref(i | leaf_bit); }
    static Ref inner(std::size_t i) { return Ref(static_cast<std::uint32_t>(i)); }
    Ref() : bits_(leaf_bit) {}

    static Ref from_bits(std::uint32_t bits) { return Ref(bits); }
    std::uint32_t bits() const { return bits_; }
    bool is_leaf() const { return (bits_ & leaf_bit) != 0; }
    std::uint32_t index() const { return bits_ & max_index; }
    bool spare() const { return (bits_ & spare_bit) != 0; }
    Ref with_spare(bool on) const { return Ref((bits_ & ~spare_bit) | (on ? spare_bit : 0)); }

private:
    explicit Ref(std::uint32_t bits) : bits_(bits) {}
    std::uint32_t bits_;
};

/// Inner node of a kd-tree: a plane and two children, 16 bytes. The axis sits in the spare bits of
/// the children's references.
struct KdNode {
    static constexpr int arity = 2;
    static constexpr bool is_octant = false;
    static constexpr int count() { return arity; }
    static constexpr std::size_t slot(int c) { return static_cast<std::size_t>(c); }
    double at = 0;
    std::array<Ref, 2> children;

    KdNode() = default;
    KdNode(const Subdivision& s) : KdNode(s, s.cuts[0] ? 0 : s.cuts[1] ? 1 : 2) {}
    Axis axis() const { return (children[0].spare() ? 1 : 0) + (children[1].spare() ? 2 : 0); }
    /// Where the planes stand.
    std::span<const double> planes() const { return {&at, 1}; }
    std::span<double> planes() { return {&at, 1}; }
    Axis plane_axis(std::size_t) const { return axis(); }
    void set_child(std::size_t slot, Ref ref) {
        Ref& child = children[slot];
        child = ref.with_spare(child.spare());
    }
    Subdivision subdivision(const Box& box) const { return halves(box, axis(), at); }
    static Subdivision even_subdivision(const Box&, int, const Box& box) {
        return longest_edge_halves(box);
    }
    /// The cut through the middle that serves a box where something varies by `along` the axes.
    static Subdivision subdivision_across(const Box&, int, const Box& box,
                                          const std::array<double, 3>& along) {
        return halves_across(box, along);
    }
    static bool may_cut(const Box&, int, const Subdivision&) { return true; }

    /// Slot of the child that holds `x`.
    std::size_t child_with(const Point& x) const { return x[axis()] > at ? 1 : 0; }
    /// The same, and narrows `box` to that child.
    std::size_t descend(const Point& x, Box& box) const {
        const std::size_t c = child_with(x);
        narrow(box, c);
        return c;
    }
    /// Makes the node's box that of the child in `slot`.
    void narrow(Box& box, std::size_t slot) const { (slot == 1 ? box.low : box.high)[axis()] = at; }

private:
    KdNode(const Subdivision& s, Axis axis)
        : at(s.at[axis]),
          children{Ref().with_spare((axis & 1) != 0), Ref().with_spare((axis & 2) != 0)} {}
};

/// Inner node of an octree: eight children and the planes, which go through the middle of the box;
/// one line of a cache.
///
/// Where the domain is longer along some axes, the first levels cut across these alone, until boxes
/// are near cubes; an axis without extent is never cut (a quadtree). The axes depend on the domain
/// and the level alone. The plane of an axis that is not cut is at infinity, so that no place is
/// beyond it, and the slots on its high side stay empty.
struct alignas(64) OctreeNode {
    static constexpr int arity = 8;
    static constexpr bool is_octant = true;
    std::array<Ref, 8> children;
    std::array<double, 3> at{};

    OctreeNode() = default;
    OctreeNode(const Subdivision& s) {
        for (std::size_t a = 0; a < 3; ++a)
            at[a] = s.cuts[a] ? s.at[static_cast<Axis>(a)] : nowhere;
    }
    bool cuts(std::size_t axis) const { return at[axis] != nowhere; }
    /// A bit for each axis that is cut.
    unsigned axes() const { return (cuts(0) ? 1u : 0) | (cuts(1) ? 2u : 0) | (cuts(2) ? 4u : 0); }
    int count() const { return 1 << std::popcount(axes()); }
    std::size_t slot(int c) const {
        if (count() == arity) return static_cast<std::size_t>(c);
        unsigned slot = 0;
        for (unsigned a = 0, bits = static_cast<unsigned>(c); a < 3; ++a) {
            if (!cuts(a)) continue;
            slot |= (bits & 1) << a;
            bits >>= 1;
        }
        return slot;
    }
    std::span<const double> planes() const { return at; }
    std::span<double> planes() { return at; }
    static Axis plane_axis(std::size_t plane) { return static_cast<Axis>(plane); }
    void set_child(std::size_t slot, Ref ref) { children[slot] = ref; }
    Subdivision subdivision(const Box& box) const {
        return {box, {at[0], at[1], at[2]}, {cuts(0), cuts(1), cuts(2)}};
    }
    static Subdivision even_subdivision(const Box& domain, int level, const Box& box) {
        return {box, box.centre(), long_axes(domain, level)};
    }
    static Subdivision subdivision_across(const Box& domain, int level, const Box& box,
                                          const std::array<double, 3>&) {
        return even_subdivision(domain, level, box);
    }
    static bool may_cut(const Box& domain, int level, const Subdivision& s) {
        return s.cuts == long_axes(domain, level);
    }

    std::size_t child_with(const Point& x) const {
        return (x.x() > at[0] ? 1u : 0) | (x.y() > at[1] ? 2u : 0) | (x.z() > at[2] ? 4u : 0);
    }
    std::size_t descend(const Point& x, Box& box) const {
        const std::size_t c = child_with(x);
        narrow(box, c);
        return c;
    }
    void narrow(Box& box, std::size_t slot) const {
        for (Axis a = 0; a < 3; ++a) {
            const double plane = at[static_cast<std::size_t>(a)];
            if (plane == nowhere) continue;
            ((slot >> a & 1) != 0 ? box.low : box.high)[a] = plane;
        }
    }

private:
    static constexpr double nowhere = std::numeric_limits<double>::infinity();
};

/// Compiles if `Node` is a cut, the inner node of a tree (KdNode, OctreeNode): how a box is
/// divided, into how many parts, and which of them holds a place. Otherwise says what is missing.
///
/// Children are numbered as those of the Subdivision; child c is in children[slot(c)].
template <class Node>
consteval void check_cut() {
    static_assert(
        requires {
            { Node::arity } -> std::convertible_to<int>;
        },
        "a cut needs a constant `int arity`, 2 or 8: the slots for children");
    static_assert(
        requires(const Node& node) {
            { node.count() } -> std::same_as<int>;
            { node.slot(0) } -> std::same_as<std::size_t>;
        },
        "a cut needs `int count()`, its number of children, and `std::size_t slot(int child)`");
    static_assert(
        requires {
            { Node::is_octant } -> std::convertible_to<bool>;
            Node();
        },
        "a cut needs a constant `bool is_octant` and a default constructor");
    static_assert(
        requires(const Subdivision& s) { Node(s); },
        "a cut needs a constructor from `const Subdivision&`");
    static_assert(
        requires(const Node& node, const Box& box) {
            { node.subdivision(box) } -> std::same_as<Subdivision>;
        },
        "a cut needs `Subdivision subdivision(const Box&)`, which it has made of the box");
    static_assert(
        requires(const Box& box, const std::array<double, 3>& along, const Subdivision& s) {
            { Node::even_subdivision(box, 0, box) } -> std::same_as<Subdivision>;
            { Node::subdivision_across(box, 0, box, along) } -> std::same_as<Subdivision>;
            { Node::may_cut(box, 0, s) } -> std::same_as<bool>;
        },
        "a cut needs the static `even_subdivision(domain, level, box)`, "
        "`subdivision_across(domain, level, box, along)` and `may_cut(domain, level, "
        "subdivision)`");
    static_assert(
        requires(const Node& node, const Point& x, Box& box) {
            { node.child_with(x) } -> std::same_as<std::size_t>;
            { node.descend(x, box) } -> std::same_as<std::size_t>;
            node.narrow(box, 0);
        },
        "a cut needs `std::size_t child_with(x)`, `std::size_t descend(x, box)` and `narrow(box, "
        "slot)`");
    static_assert(
        requires(Node & node) {
            node.children[0];
            node.set_child(0, node.children[0]);
            { node.planes() } -> std::convertible_to<std::span<double>>;
            { node.plane_axis(0) } -> std::same_as<Axis>;
        },
        "a cut needs `children`, `set_child(slot, ref)`, `planes()` and `plane_axis(i)`");
}

}  // namespace controlspace
