// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/sources/point_source.h"
#include "controlspace/space/insertion.h"
#include "controlspace/trees/leaf_model.h"
#include "trees/insertion/source_search.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// Finds sources ahead of their turn that will change nothing when it comes: on all of TBB's
/// threads, where inserting is a matter of one after the other.
///
/// While isotropic sources are inserted, what is requested at a place never gets larger. So one
/// that is met now, with room for rounding, is met later too, and insertion may leave it out
/// without any difference to the field. Sources are searched in parts, since those that follow
/// each other often lie close together, and are not met before the first of them is inserted.
class MetSources {
public:
    /// The next part of what is left: longer where sources tend to be met.
    std::span<const PointSource> next_part(std::span<const PointSource> left) {
        const auto found = static_cast<std::size_t>(std::count(met_.begin(), met_.end(), 1));
        if (20 * found >= 19 * met_.size()) {
            length_ = std::min(2 * length_, longest);
        } else if (4 * found < 3 * met_.size()) {
            length_ = std::max(length_ / 2, shortest);
        }
        const auto part = left.first(std::min(length_, left.size()));
        met_.assign(part.size(), 0);
        return part;
    }

    /// Finds them in `part`, among those before the first anisotropic one.
    template <class Node>
    void find(const Topology<Node>& tree, const LeafModel<Node>& model, double tolerance,
              std::span<const PointSource> part) {
        const auto end = std::find_if_not(part.begin(), part.end(), [](const PointSource& source) {
            return is_isotropic(source.metric);
        });
        const double let_pass = length_let_pass(tolerance);
        find_leaves(
            tree, part.first(static_cast<std::size_t>(end - part.begin())),
            [&](std::size_t first, std::span<const Point> x, std::span<const LeafIndex> leaves) {
                std::array<double, Topology<Node>::most_found> most;
                const std::span<double> ceilings = std::span(most).first(x.size());
                model.ceilings(tree, leaves, x, ceilings);
                for (std::size_t k = 0; k < x.size(); ++k) {
                    const PointSource& source = part[first + k];
                    const double enough = let_pass * source.metric.xx;
                    const bool met = ceilings[k] <= enough && std::isfinite(enough) &&
                                     tree.domain().contains(x[k]) &&
                                     is_source_growth(source.growth);
                    met_[first + k] = met ? 1 : 0;
                }
            });
    }

    /// Whether source `k` of the part is known to be met.
    bool is_met(std::size_t k) const { return met_[k] != 0; }

private:
    static constexpr std::size_t shortest = 256;
    static constexpr std::size_t longest = 65536;

    std::size_t length_ = 1024;
    std::vector<std::uint8_t> met_;
};

}  // namespace controlspace
