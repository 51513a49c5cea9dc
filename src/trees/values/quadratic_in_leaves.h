// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "controlspace/geometry/extent.h"
#include "controlspace/metric/blend.h"
#include "trees/topology/parts_across.h"
#include "trees/values/triquadratic.h"

namespace controlspace {

/// Metrics at places in leaves, each interpolated with those across the leaf's faces: at the
/// nearest place of the leaf; nowhere coarser than the cone of its own metric at its centre.
///
/// `values` provides
///   box(leaf)
///   parts_across(leaf, x)  PartsAcross, or the leaves there that touch x
///   metric(leaf)
///   all_isotropic()        whether all metrics are known to be
///   length(leaf)           of an isotropic metric
///   prefetch_metric(leaf)
///   slope()                of the cones: g_r - 1
///   form()                 QuadraticForm
template <class Node, class Values>
class QuadraticInLeaves {
public:
    QuadraticInLeaves(const Topology<Node>& tree, const Values& values)
        : tree_(tree), values_(values) {}

    /// As metrics; or, where all are known to be isotropic, as lengths.
    template <class Value>
    void interpolate(std::span<const LeafIndex> leaves, std::span<const Point> x,
                     std::span<Value> out) const {
        if (x.size() == 1) {
            out.front() = one<Value>(leaves.front(), x.front());
            return;
        }
        for (std::size_t first = 0; first < x.size(); first += at_a_time) {
            const std::size_t n = std::min(at_a_time, x.size() - first);
            some(leaves.subspan(first, n), x.subspan(first, n), out.subspan(first, n));
        }
    }

private:
    static constexpr std::size_t at_a_time = 16;

    template <class Value>
    Value one(LeafIndex leaf, const Point& place) const {
        const Box& box = values_.box(leaf);
        const Point x = nearest_in(box, place);
        PartsAcross across = values_.parts_across(leaf, x);
        for (std::size_t face = 0; face < 6; ++face) {
            Ref& part = across[face];
            if (part.is_leaf()) continue;
            const Point y = on_face(box, x, face);
            do part = child_with(part, y);
            while (!part.is_leaf());
        }
        return value<Value>(leaf, box, x, across);
    }

    // Descents to neighbours go side by side: while one waits for memory, others compare.
    template <class Value>
    void some(std::span<const LeafIndex> leaves, std::span<const Point> places,
              std::span<Value> out) const {
        std::array<Point, at_a_time> low, high, x;
        std::array<PartsAcross, at_a_time> across;
        std::array<std::uint8_t, 6 * at_a_time> going;
        std::size_t left = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Box& box = values_.box(leaves[i]);
            low[i] = box.low;
            high[i] = box.high;
            x[i] = nearest_in(box, places[i]);
            across[i] = values_.parts_across(leaves[i], x[i]);
            for (std::size_t face = 0; face < 6; ++face) {
                going[left] = static_cast<std::uint8_t>(8 * i + face);
                left += across[i][face].is_leaf() ? 0 : 1;
            }
        }
        std::array<Point, 8 * at_a_time> y;
        for (std::size_t k = 0; k < left; ++k) {
            const std::size_t i = going[k] / 8;
            const std::size_t face = going[k] % 8;
            __builtin_prefetch(&tree_.node(across[i][face]));
            y[going[k]] = on_face({low[i], high[i]}, x[i], face);
        }
        while (left > 0) {
            std::size_t still = 0;
            for (std::size_t k = 0; k < left; ++k) {
                Ref& part = across[going[k] / 8][going[k] % 8];
                part = child_with(part, y[going[k]]);
                going[still] = going[k];
                still += part.is_leaf() ? 0 : 1;
                __builtin_prefetch(tree_.nodes().data() + part.index());
            }
            left = still;
        }
        for (std::size_t i = 0; i < places.size(); ++i) {
            for (const Ref neighbour : across[i]) values_.prefetch_metric(neighbour.index());
        }
        for (std::size_t i = 0; i < places.size(); ++i) {
            out[i] = value<Value>(leaves[i], {low[i], high[i]}, x[i], across[i]);
        }
    }

    // All planes across a face lie beyond it, so the place on it decides on which side of each it
    // is.
    static Point on_face(const Box& box, Point x, std::size_t face) {
        const auto a = static_cast<Axis>(face / 2);
        x[a] = (face % 2 == 1 ? box.high : box.low)[a];
        return x;
    }

    Ref child_with(Ref part, const Point& y) const {
        const Node& node = tree_.node(part);
        return node.children[node.child_with(y)];
    }

    template <class Value>
    Value value(LeafIndex leaf, const Box& box, const Point& x, const PartsAcross& across) const {
        const Vector v = x - box.centre();
        const Vector t = 2 * v.cwiseQuotient(divisible_edges(box));
        if (values_.form() == QuadraticForm::published) {
            return published<Value>(leaf, t, across);
        }
        if (std::is_same_v<Value, double> || values_.all_isotropic()) {
            std::array<double, 6> lengths;
            for (std::size_t i = 0; i < 6; ++i) lengths[i] = values_.length(across[i].index());
            const double own = values_.length(leaf);
            return isotropic_value<Value>(triquadratic(own, lengths, t, v, values_.slope()));
        }
        std::array<Metric, 6> metrics;
        for (std::size_t i = 0; i < 6; ++i) metrics[i] = values_.metric(across[i].index());
        const Metric own = values_.metric(leaf);
        const Metric m = triquadratic(own, metrics, t, 1 + values_.slope() * metric_length(own, v));
        if constexpr (std::is_same_v<Value, double>) {
            return length_of(m);
        } else {
            return m;
        }
    }

    // Not inlined: the other form takes a fifth longer beside it.
    template <class Value>
    [[gnu::noinline]] Value published(LeafIndex leaf, const Vector& t,
                                      const PartsAcross& across) const {
        const auto weights = published_triquadratic_weights(t);
        return blend<Value>(
            weights.size(), [&](std::size_t i) { return weights[i]; },
            [&](std::size_t i) { return values_.metric(i < 6 ? across[i].index() : leaf); });
    }

    const Topology<Node>& tree_;
    const Values& values_;
};

}  // namespace controlspace
