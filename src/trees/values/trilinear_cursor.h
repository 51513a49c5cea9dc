// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "controlspace/space/control_space.h"
#include "trees/values/trilinear_in_leaves.h"

namespace controlspace {

/// Lengths that are trilinear in leaves, for one caller: remembers the leaves that were entered
/// last, with the lengths at their corners, which is all that a place in one of them needs.
/// `Values` as of trilinear_in_leaves, to be copied, or a reference to them.
///
/// On walks in steps of half an element, one leaf would hold 50 to 70 % of the next places, four
/// hold 70 to 90 %, sixteen 75 to 95 %. Where they hold less than two of three, entering leaves
/// takes longer than it saves: then it works without for a while.
template <class Node, class Values>
class TrilinearCursor final : public Cursor {
public:
    TrilinearCursor(const Topology<Node>& tree, Values values) : tree_(tree), values_(values) {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        above_[0] += infinity;  // nothing is in the leaves yet
        for (std::size_t a = 0; a < 3; ++a) {
            below_[a] = std::nextafter(tree.domain().low[static_cast<Axis>(a)], -infinity);
        }
    }

    Metric metric_at(const Point& x) override { return Metric::isotropic(length_at(x)); }
    double length_at(const Point& x) override {
        if (without_ > 0) {
            --without_;
            return trilinear_in_leaf<double>(values_, tree_.find(x), x);
        }
        ++asked_;
        // One comparison with all: which of them holds the place cannot be predicted. A bit for
        // each, since a leaf is there twice where places beyond the domain come to it.
        const Whole held = (x.x() > above_[0]) & (x.x() <= up_to_[0]) & (x.y() > above_[1]) &
                           (x.y() <= up_to_[1]) & (x.z() > above_[2]) & (x.z() <= up_to_[2]) &
                           Whole{1, 2, 4, 8};
        const auto bits = static_cast<std::uint64_t>((held[0] | held[1]) | (held[2] | held[3]));
        if (bits == 0) return enter(x);
        return leaves_[static_cast<std::size_t>(std::countr_zero(bits))].length_at(x);
    }

private:
    // In vectors, which are written as a whole: reading them waits where a part has been written.
    static constexpr std::size_t most = 4;
    using Numbers [[gnu::vector_size(32)]] = double;
    using Whole [[gnu::vector_size(32)]] = std::int64_t;

    struct Leaf {
        Numbers low{}, edges{1, 1, 1, 1};
        std::array<Numbers, 2> lengths{};

        // As trilinear_in_leaf, to the bit.
        double length_at(const Point& x) const {
            const Numbers high = (Numbers{x.x(), x.y(), x.z(), 0} - low) / edges;
            const Numbers rest = 1 - high;
            const Numbers across = Numbers{rest[0], high[0], rest[0], high[0]} *
                                   Numbers{rest[1], rest[1], high[1], high[1]};
            const Numbers below = across * rest[2] * lengths[0];
            const Numbers above = across * high[2] * lengths[1];
            return below[0] + below[1] + below[2] + below[3] + above[0] + above[1] + above[2] +
                   above[3];
        }
    };

    // Not inlined: otherwise what it needs is also done for places in leaves that are remembered.
    [[gnu::noinline]] double enter(const Point& x) {
        if (++entered_ == most_entered) {
            if (asked_ < few_asked) without_ = long_without;
            asked_ = entered_ = 0;
        }
        const LeafIndex found = tree_.find(x);
        const Box box = values_.box(found);
        const Box& domain = tree_.domain();
        const std::size_t next = std::exchange(next_, (next_ + 1) % most);
        const Whole is_next = Whole{0, 1, 2, 3} == static_cast<std::int64_t>(next);
        const auto edge = [&](Axis a) { return divisible_edge(box.low[a], box.high[a]); };
        for (std::size_t a = 0; a < 3; ++a) {
            const auto axis = static_cast<Axis>(a);
            const Numbers low = Numbers{} + box.low[axis], high = Numbers{} + box.high[axis];
            // The domain's low face belongs to its leaves.
            const Numbers above = low > domain.low[axis] ? low : Numbers{} + below_[a];
            above_[a] = is_next ? above : above_[a];
            up_to_[a] = is_next ? high : up_to_[a];
        }
        const auto at_corners = values_.at_corners(found);
        const auto length = [&](std::size_t c) { return length_of(at_corners(c)); };
        Leaf& leaf = leaves_[next];
        leaf.low = Numbers{box.low.x(), box.low.y(), box.low.z(), 0};
        leaf.edges = Numbers{edge(0), edge(1), edge(2), 1};
        leaf.lengths = {Numbers{length(0), length(1), length(2), length(3)},
                        Numbers{length(4), length(5), length(6), length(7)}};
        return leaf.length_at(nearest_in(domain, x));
    }

    const Topology<Node>& tree_;
    Values values_;
    std::array<double, 3> below_;               // the domain
    std::array<Numbers, 3> above_{}, up_to_{};  // faces of the leaves
    std::array<Leaf, most> leaves_;
    std::size_t next_ = 0;  // to be replaced
    // Where less than two of three places are in them, none are remembered for a while.
    static constexpr std::uint32_t most_entered = 32, few_asked = 96, long_without = 1024;
    std::uint32_t asked_ = 0, entered_ = 0, without_ = 0;
};

}  // namespace controlspace
