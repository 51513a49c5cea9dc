#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/detail/goal_field.h"
#include "controlspace/trees/detail/in_parallel.h"
#include "controlspace/trees/detail/leaf_judge.h"
#include "controlspace/trees/detail/sample_leaves.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

/// Finds where the metric of a leaf exceeds the cone of a single source. A cone is the smallest at
/// its source, and in a leaf at the place that is nearest to the source in the source's metric:
/// there the exact field may have a minimum that no other place of the leaf shows.
template <class Node, class Storage>
class NextToSources {
public:
    /// The sources must outlive it.
    NextToSources(const Topology<Node>& tree, const Storage& storage, const GoalField& field,
                  std::span<const PointSource> sources)
        : tree_(tree), storage_(storage), field_(field), sources_(sources) {}

    /// Of each leaf, the place where it exceeds a cone most, and an estimate of its departure from
    /// the field there; nothing if that is far below the target. Few sources are compared with all
    /// `leaves`, many with those leaves beside their own of which `is_wanted(leaf)` holds.
    template <class IsWanted>
    std::vector<Departure> worst(std::span<const LeafBox> leaves, const IsWanted& is_wanted) {
        constexpr std::size_t few = 64;
        find_inverse_squares();
        std::vector<Departure> worst(tree_.leaves());
        if (sources_.size() <= few) {
            in_parallel(leaves.size(), [&](std::size_t i) {
                for (std::size_t k = 0; k < sources_.size(); ++k) {
                    Departure departure = at_nearest_place(k, leaves[i]);
                    if constexpr (HasTrilinearLeaves<Storage>) {
                        if (!(departure.worst > field_.target())) {
                            find_exceeded(k, leaves[i], departure);
                        }
                    }
                    raise(worst[leaves[i].leaf], departure);
                }
            });
            return worst;
        }
        tbb::enumerable_thread_specific<std::vector<std::pair<LeafIndex, Departure>>> found;
        in_parallel(sources_.size(), [&](std::size_t i) {
            for_each_leaf_beside(sources_[i].position, [&](const LeafPlace& beside) {
                if (!is_wanted(beside.leaf)) return;
                const Departure departure = at_nearest_place(i, {beside.leaf, beside.box});
                if (departure.worst > 0) found.local().emplace_back(beside.leaf, departure);
            });
        });
        for (const auto& of_thread : found) {
            for (const auto& [leaf, departure] : of_thread) raise(worst[leaf], departure);
        }
        return worst;
    }

private:
    void find_inverse_squares() {
        if (!inverse_squares_.empty()) return;
        inverse_squares_.resize(sources_.size());
        in_parallel(sources_.size(), [&](std::size_t i) {
            EigenFrame frame = eigen_frame(sources_[i].metric);
            for (double& length : frame.lengths) length = 1 / (length * length);
            inverse_squares_[i] = metric_from_frame(frame.lengths, frame.directions);
        });
    }

    // Whatever the order in which they come.
    static void raise(Departure& worst, const Departure& departure) {
        const auto order = [](const Departure& d) {
            return std::tuple(d.worst, d.where.x(), d.where.y(), d.where.z());
        };
        if (order(worst) < order(departure)) worst = departure;
    }

    Departure at_nearest_place(std::size_t source, const LeafBox& of) const {
        constexpr double of_interest = 0.25;
        const Point x = nearest_place(source, of.box);
        const Metric own = value_in(tree_, field_of(storage_), of.leaf, x);
        const Metric& metric = sources_[source].metric;
        const double factor = cone_factor(sources_[source], field_.ratio(), x);
        Departure departure;
        const double most = largest_factor_within(of_interest * field_.target());
        if (!is_within(own, most, factor * metric)) {
            departure.take(directional_nonconformity(own, intersection(own, factor * metric)), x);
        }
        return departure;
    }

    // Metrics in a box, trilinear between its corners.
    struct Part {
        Box box;
        std::array<Metric, 8> at;
    };

    // A place where trilinear metrics exceed a cone by more than the target allows in all
    // directions at once. They do so nowhere in a box if they do not at its corners, when the
    // cone's factor, which is convex, is replaced by a tangent: |T(x) M^-1| is a convex function of
    // T, and T a mean of the corners'.
    void find_exceeded(std::size_t source, const LeafBox& of, Departure& departure) const {
        constexpr std::size_t most_parts = 256;
        const auto& [q, metric, growth] = sources_[source];
        const Eigen::Matrix3d inverse_square = inverse_squares_[source].matrix();
        const double slope = cone_growth(sources_[source], field_.ratio()) - 1;
        const double most = largest_factor_within(field_.target());
        const auto metrics = storage_.metrics().field();
        Part leaf{of.box, {}};
        std::ranges::transform(storage_.nodes_of(of.leaf), leaf.at.begin(),
                               [&](const auto node) { return metrics[node]; });
        std::vector<Part> parts{leaf};
        for (std::size_t k = 0; !parts.empty() && k < most_parts; ++k) {
            const Part part = parts.back();
            parts.pop_back();
            const Point centre = part.box.centre();
            const double distance = std::max(metric_length(metric, centre - q), 1e-150);
            const Vector steepness = slope / distance * (inverse_square * (centre - q));
            bool is_doubtful = false;
            for (int c = 0; c < 8; ++c) {
                const Point x = corner(part.box, c);
                const Metric& own = part.at[static_cast<std::size_t>(c)];
                const double tangent = 1 + slope * distance + steepness.dot(x - centre);
                if (tangent > 0 && is_within(own, most * tangent, metric)) continue;
                is_doubtful = true;
                const double factor = 1 + slope * metric_length(metric, x - q);
                if (is_within(own, most * factor, metric)) continue;
                const Metric within = intersection(own, factor * metric);
                departure.take(directional_nonconformity(own, within), x);
                if (departure.worst > field_.target()) return;
            }
            if (is_doubtful) halve(part, metric, parts);
        }
    }

    // Across the edge that is the longest in this metric.
    static void halve(const Part& part, const Metric& metric, std::vector<Part>& parts) {
        const auto lengths = metric_edge_lengths(metric, part.box.edges());
        const auto longest = static_cast<Axis>(std::ranges::max_element(lengths) - lengths.begin());
        Part low = part;
        Part high = part;
        low.box.high[longest] = high.box.low[longest] = part.box.centre()[longest];
        const std::size_t bit = std::size_t{1} << longest;
        for (std::size_t c = 0; c < 8; ++c) {
            if ((c & bit) != 0) continue;
            low.at[c | bit] = high.at[c] =
                Metric::from_matrix(0.5 * (part.at[c].matrix() + part.at[c | bit].matrix()));
        }
        parts.push_back(low);
        parts.push_back(high);
    }

    // A quadratic function has its minimum in a box inside of it, in a face, an edge or a corner.
    Point nearest_place(std::size_t source, const Box& box) const {
        const Point& q = sources_[source].position;
        Point nearest = nearest_in(box, q);
        if (is_isotropic(sources_[source].metric) || nearest == q) return nearest;
        // Mostly it is where the nearest place of a plane between the source and the box is.
        const Eigen::Matrix3d squared = square(sources_[source].metric).matrix();
        for (Axis i = 0; i < 3; ++i) {
            if (nearest[i] == q[i]) continue;
            Point x = q + (nearest[i] - q[i]) / squared(i, i) * squared.col(i);
            x[i] = nearest[i];
            if (box.contains(x)) return x;
        }
        const Eigen::Matrix3d a = inverse_squares_[source].matrix();
        double least = (nearest - q).dot(a * (nearest - q));
        for (int sides = 0; sides < 27; ++sides) {
            // Coordinates on a side are given, at the others the slope is zero.
            Eigen::Matrix3d equations = a;
            Vector right = a * q;
            for (Axis i = 0, rest = sides; i < 3; ++i, rest /= 3) {
                if (rest % 3 == 2) continue;
                equations.row(i).setZero();
                equations(i, i) = 1;
                right[i] = rest % 3 == 0 ? box.low[i] : box.high[i];
            }
            const Vector at = equations.inverse() * right;
            const Point x = nearest_in(box, at);
            const double distance = (x - q).dot(a * (x - q));
            if (!(distance < least)) continue;
            least = distance;
            nearest = x;
        }
        return nearest;
    }

    // Across the nearest faces, edges and corner of the leaf that holds x.
    template <class Visit>
    void for_each_leaf_beside(const Point& x, const Visit& visit) const {
        const Box box = tree_.locate(x).box;
        const Point centre = box.centre();
        constexpr double infinity = std::numeric_limits<double>::infinity();
        for (int sides = 1; sides < 8; ++sides) {
            Point p = x;
            for (Axis a = 0; a < 3; ++a) {
                if ((sides >> a & 1) == 0) continue;
                p[a] = x[a] < centre[a] ? std::nextafter(box.low[a], -infinity)
                                        : std::nextafter(box.high[a], infinity);
            }
            if (tree_.domain().contains(p)) visit(tree_.locate(p));
        }
    }

    const Topology<Node>& tree_;
    const Storage& storage_;
    const GoalField& field_;
    std::span<const PointSource> sources_;
    std::vector<Metric> inverse_squares_;  // of the sources, once they are needed
};

}  // namespace controlspace
