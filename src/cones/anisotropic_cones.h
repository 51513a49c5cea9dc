// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cones/tensor_tree.h"
#include "cones/undominated.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Intersection of the cones of any sources at a place (paper §5.2), in the canonical order: by the
/// smallest length of the cone there, ascending, and by index where equal. Best-first search in a
/// bounding-volume hierarchy; only cones that provably leave the result as it is are left out.
class AnisotropicCones {
public:
    /// g >= 1, the ratio of sources that have none. Lengths of `cap` or more do not matter.
    AnisotropicCones(std::span<const PointSource> sources, double g, double cap);

    /// A cone, with its smallest length, or a node, with a length below that of all its cones.
    struct Waiting {
        double length;
        std::uint32_t rank;   ///< of a node 0, of a cone 1 + the index of its source
        std::uint32_t place;  ///< number of the node; of the cone among the cones met

        bool comes_after(const Waiting& other) const {
            return length != other.length ? length > other.length : rank > other.rank;
        }
    };
    /// Memory of `intersect`, to be kept from one call to the next.
    struct Search {
        std::vector<Waiting> queue;  ///< a heap, whose first comes before all others
        std::vector<Metric> cones;   ///< met so far
    };

    /// `largest`, no longer than the cap, intersected with the cones at `p`, one after the other.
    /// Cones that would shorten no length by more than the fraction `tolerance` are passed over.
    /// Appends the indices of the sources that shortened one to `governing`, if there is such.
    Metric intersect(const Point& p, const Metric& largest, double tolerance, Search& search,
                     std::vector<std::uint32_t>* governing) const;

    /// Sources that change the result nowhere, and were left out.
    std::size_t dropped() const { return dropped_; }

    /// Bytes allocated: of the metrics, and of what finds them.
    std::size_t bytes_payload() const { return tree_.leaves().size() * sizeof(TensorLanes); }
    std::size_t bytes_topology() const { return tree_.bytes() - bytes_payload(); }

private:
    explicit AnisotropicCones(UndominatedSources sources);

    std::size_t dropped_;
    double uncertainty_;  ///< relative, of lengths computed from the metrics given
    TensorTree tree_;
};

}  // namespace controlspace
