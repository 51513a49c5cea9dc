// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cones/quadric_tree.h"
#include "controlspace/metric/metric.h"
#include "controlspace/metric/order_free_intersection.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Order-free intersection of the cones of any sources at a place: the largest metric within all of
/// them, and within a largest metric.
///
/// Few cones determine it. A core set of them is intersected; a bounding-volume hierarchy finds
/// cones that the answer exceeds; the worst join the core set, until no cone is exceeded by more
/// than the tolerance. The core set starts from that of the centre of a cell of a fixed grid which
/// contains the place, so that the answer depends neither on earlier places nor on threads.
class OrderFreeCones {
public:
    /// In multipliers, in place of the index of a source: the largest metric, and a further one.
    static constexpr std::uint32_t index_of_largest = 0xffffffff;
    static constexpr std::uint32_t index_of_further = 0xfffffffe;
    static constexpr std::size_t most_members = OrderFreeIntersection::most_multipliers - 2;

    /// g >= 1, the ratio of sources that have none. With a `tolerance` t, log det M is within 3
    /// ln(1 + t) of the best. Throws InputError for metrics that `order_free_intersection` does not
    /// accept.
    OrderFreeCones(std::span<const PointSource> sources, double g, const Metric& largest,
                   double tolerance);

    /// The duality gap that a tolerance allows.
    static double gap_of(double tolerance);

    /// Where the search for an answer begins: the core set of another place, and its factor.
    struct Start {
        Eigen::Matrix3d factor = Eigen::Matrix3d::Identity();
        std::array<std::uint32_t, most_members> members{};
        std::uint32_t count = 0;
    };
    struct Search;

    /// The intersection at `p`, within `further` too, if there is such. Multipliers have the
    /// indices of sources. Begins at `near`, if given, which should be that of a place near to `p`:
    /// the answer depends on it, as far as the tolerance allows. `found` becomes that of `p`.
    /// Throws InputError for a `further` metric that `order_free_intersection` does not accept.
    /// With a `tolerance`, in place of the field's own.
    OrderFreeIntersection intersect(const Point& p, const Metric* further, Search& search,
                                    const Start* near = nullptr, Start* found = nullptr,
                                    std::optional<double> tolerance = {}) const;
    /// The same of sources close to those of `near` in the hierarchy alone: log det M is no less,
    /// to the tolerance. A fraction of the time.
    OrderFreeIntersection intersect_close(const Point& p, const Metric* further, const Start& near,
                                          Start& found) const;

    /// Indices of the members of a core set.
    void append_sources(const Start& start, std::vector<std::uint32_t>& sources) const;

    /// What finds the sources; it has those that may change the result.
    const QuadricTree& tree() const { return tree_; }
    /// Sources that change the result nowhere, and were left out.
    std::size_t dropped() const { return dropped_; }

    /// Bytes allocated: of the metrics, and of what finds them.
    std::size_t bytes_payload() const { return tree_.shapes().size() * sizeof(TensorLanes); }
    std::size_t bytes_topology() const { return tree_.bytes() - bytes_payload(); }

private:
    struct Cell {
        static constexpr std::int64_t none = -1;
        std::array<std::int64_t, 4> key{none, 0, 0, 0};  ///< level, and place in the grid
        Start start;
        bool is_small = false;  ///< good for all places in it
    };
    class Core;

    double growth(const Point& p, const Eigen::Matrix3d& h, const PointSource& source) const;
    /// Searches the sources below the nodes so many `levels` above the members of the core set;
    /// without a number, all.
    OrderFreeIntersection answer(const Point& p, const Metric* further, const Start& start,
                                 double tolerance, Start* found,
                                 std::optional<int> levels = {}) const;
    const Start& start_near(const Point& p, Search& search) const;
    std::array<std::int64_t, 4> cell_at(const Point& p, int level) const;
    Cell made_cell(const std::array<std::int64_t, 4>& key, const Start& from) const;

    double steepest_;  ///< the largest slope g - 1 of the cones
    Metric largest_;
    double tolerance_;
    double rounding_ = 0;  ///< of squared lengths, relative
    std::size_t dropped_ = 0;
    QuadricTree tree_;
    Point origin_ = Point::Zero();  ///< of the cells of level 0
    double edge_ = 0;               ///< of the cells of level 0
    Start start_;

public:
    /// Memory of `intersect`, to be kept from one call to the next, for one field only. Has no
    /// effect on answers.
    struct Search {
        std::vector<Cell> cells;  ///< by a hash of their keys
        std::size_t filled = 0;
        Cell last;
    };
};

}  // namespace controlspace
