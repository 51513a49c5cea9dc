#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/sources/point_source.h"
#include "controlspace/space/insertion.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// Finds sources ahead of their turn that will change nothing when it comes: on all of TBB's
/// threads, where inserting is a matter of one after the other.
///
/// While isotropic sources are inserted, what is asked for at a place never gets larger. So one
/// that is met now, with room for rounding, is met later too, and insertion may leave it out
/// without any difference to the field. Sources are looked at in parts, since those that follow
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

    /// Looks for them in `part`. Nothing is said of those from the first anisotropic one on.
    template <class Node, class Storage>
    void look(const Topology<Node>& tree, const Storage& storage, double tolerance,
              std::span<const PointSource> part) {
        const auto end = std::find_if_not(part.begin(), part.end(), [](const PointSource& source) {
            return is_isotropic(source.metric);
        });
        const double let_pass = length_let_pass(tolerance);
        constexpr std::size_t at_a_time = Topology<Node>::most_found;
        const auto look_at = [&](std::size_t first, std::size_t last) {
            std::array<Point, at_a_time> x;
            std::array<LeafIndex, at_a_time> leaves;
            const std::size_t n = last - first;
            for (std::size_t i = 0; i < n; ++i) x[i] = part[first + i].position;
            tree.find({x.data(), n}, leaves);
            if constexpr (requires { storage.prefetch(leaves[0]); }) {
                for (std::size_t i = 0; i < n; ++i) storage.prefetch(leaves[i]);
            }
            for (std::size_t i = 0; i < n; ++i) {
                const double asked = let_pass * part[first + i].metric.xx;
                const bool met = storage.ceiling(leaves[i], x[i]) <= asked &&
                                 std::isfinite(asked) && tree.domain().contains(x[i]);
                met_[first + i] = met ? 1 : 0;
            }
        };
        constexpr std::size_t sources_per_task = 256;
        const auto count = static_cast<std::size_t>(end - part.begin());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, sources_per_task),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i < range.end(); i += at_a_time) {
                                  look_at(i, std::min(i + at_a_time, range.end()));
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
