#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cones/cone_tree.h"
#include "metric/metric.h"
#include "sources/point_source.h"

namespace controlspace {

/// Intersection of the cones of any sources at a place (paper §5.2), in the canonical order: by the
/// smallest length of the cone there, ascending, and by index where equal. Best-first search in a
/// bounding-volume hierarchy; only cones that provably leave the result as it is are left out.
class AnisotropicCones {
public:
    /// g >= 1. Lengths of `cap` or more do not matter.
    AnisotropicCones(std::span<const PointSource> sources, double g, double cap);

    /// A cone or a node of the hierarchy that waits for its turn.
    struct Waiting {
        double length;        ///< smallest length of the cone; below that of all cones of the node
        std::uint32_t rank;   ///< 1 + index of the source; 0 for a node
        std::uint32_t place;  ///< of the source in tree order, or the node's number
    };
    /// Memory of `intersect`, to be kept from one call to the next.
    using Queue = std::vector<Waiting>;

    /// `largest`, no longer than the cap, intersected with the cones at `p`, one after the other.
    /// Cones that would shorten no length by more than the fraction `tolerance` are passed over.
    /// Appends the indices of the sources that shortened one to `governing`, if there is such.
    Metric intersect(const Point& p, const Metric& largest, double tolerance, Queue& queue,
                     std::vector<std::uint32_t>* governing) const;

    /// Sources that change the result nowhere, and were left out.
    std::size_t dropped() const { return dropped_; }

    /// Bytes allocated: of the metrics, and of what finds them.
    std::size_t bytes_payload() const { return cones_.capacity() * sizeof(Metric); }
    std::size_t bytes_topology() const {
        return cones_.capacity() * (sizeof(Cone) - sizeof(Metric)) +
               nodes_.capacity() * sizeof(Node);
    }

private:
    struct Cone {
        PointSource source;
        Metric square;  ///< of the metric
        double length;  ///< the metric's smallest
        std::uint32_t index;
    };
    /// Bounds of all sources below it (see the .cpp for what follows from them).
    struct Node {
        Point centre;
        double radius;   ///< largest |inverse (Q_i - centre)|
        Metric inverse;  ///< no displacement v is shorter in M_i than |inverse v|
        Metric square;   ///< L^2, where L is within all M_i
        double length;   ///< smallest of all M_i
    };

    void build(std::vector<Cone> cones);
    bool is_dominated(const Cone& cone) const;
    void make_leaf(std::uint32_t node);
    void merge(std::uint32_t node);
    void enclose(std::uint32_t node);
    double least_factor(const Node& node, const Point& p) const;

    double g_;
    double cap_;
    std::size_t dropped_ = 0;
    double uncertainty_ = 0;  ///< relative, of lengths computed from the metrics given
    ConeTreeShape shape_;
    std::vector<Cone> cones_;  ///< in tree order
    std::vector<Node> nodes_;
};

}  // namespace controlspace
