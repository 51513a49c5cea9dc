// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/single_cones.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/riemannian.h"
#include "metric/tensor_lanes.h"
#include "trees/adaptation/parameters.h"
#include "trees/in_parallel.h"

namespace controlspace {

// A cone M (1 + (g-1) |x - Q|) that a cell exceeds is exceeded most near its tip, which may lie
// outside of the cell: at the place of the box that is nearest to the source in its metric the cone
// is smallest. A metric that varies in the cell may exceed it elsewhere. Where it is trilinear, it
// is nowhere longer than k times the cone if it is not at the corners (doubtful_corners), so parts
// of the cell are ruled out, or halved, until a corner of a part exceeds it, or none is left. Where
// several cones are touched, their intersection may be shorter than each: such places are reported
// as contacts, and compared with the field itself.

/// Metrics of a box, trilinear between its corners.
struct SingleCones::Part {
    Box box;
    TensorLanes at;
    unsigned known = 0;  // corners that have been compared with the cone

    // Across an axis.
    std::pair<Part, Part> halves(Axis axis) const {
        std::pair<Part, Part> parts{*this, *this};
        auto& [low, high] = parts;
        low.box.high[axis] = high.box.low[axis] = box.centre()[axis];
        const int bit = 1 << axis;
        for (int c = 0; c < 8; ++c) {
            if ((c & bit) != 0) continue;
            const Metric middle =
                Metric::from_matrix(0.5 * (at[c].matrix() + at[c | bit].matrix()));
            low.at.set(c | bit, middle);
            high.at.set(c, middle);
            low.known &= ~(1U << (c | bit));
            high.known &= ~(1U << c);
        }
        return parts;
    }
};

namespace {

// Of the box: three at its corners, two on its edges.
std::ptrdiff_t faces_at(const Box& box, const Point& x) {
    return ((x.array() == box.low.array()) || (x.array() == box.high.array())).count();
}

// Bit c: corner c has the higher coordinate along the axis.
Lanes side_of_corners(Axis axis) {
    Lanes side;
    for (int c = 0; c < 8; ++c) side[c] = (c >> axis & 1) != 0 ? 1 : -1;
    return side;
}

}  // namespace

SingleCones::SingleCones(std::span<const PointSource> sources, double ratio, double target)
    : sources_(sources),
      ratio_(ratio),
      target_(target),
      of_interest_(largest_factor_within(single_cones::share_of_interest * target)),
      most_(largest_factor_within(target)),
      most_along_(largest_factor_along(target)),
      inverse_squares_(sources.size()) {
    in_parallel(sources_.size(),
                [&](std::size_t i) { inverse_squares_[i] = to_riemannian(sources_[i].metric); });
}

Departure SingleCones::at_nearest_place(std::size_t source, const Box& box,
                                        const MetricAt& metric_at,
                                        std::vector<Point>* contacts) const {
    const Point x = nearest_place(source, box);
    const Metric own = metric_at(x);
    if (contacts != nullptr &&
        !is_within(own, 1, cone_factor(sources_[source], ratio_, x) * sources_[source].metric)) {
        contacts->push_back(x);
    }
    return beyond(source, own, of_interest_, x);
}

// Of a metric at x that is longer than the cone by more than this factor.
Departure SingleCones::beyond(std::size_t source, const Metric& own, double most,
                              const Point& x) const {
    const Metric& metric = sources_[source].metric;
    const double factor = cone_factor(sources_[source], ratio_, x);
    Departure departure;
    if (!is_within(own, most, factor * metric)) {
        departure.take(directional_nonconformity(own, intersection(own, factor * metric)), x);
    }
    return departure;
}

SingleCones::Part SingleCones::whole(const Box& box, const std::array<Metric, 8>& at_corners) {
    Part part{box, {}};
    for (int c = 0; c < 8; ++c) part.at.set(c, at_corners[static_cast<std::size_t>(c)]);
    return part;
}

bool SingleCones::may_be_exceeded(std::size_t source, const Box& box,
                                  const std::array<Metric, 8>& at_corners) const {
    return doubtful_corners(source, whole(box, at_corners), of_interest_) != 0;
}

Departure SingleCones::worst_in(const Box& box, const std::array<Metric, 8>& at_corners,
                                const MetricAt& metric_at, std::vector<Point>* contacts) const {
    const Part leaf = whole(box, at_corners);
    Departure worst;
    for (std::size_t k = 0; k < size(); ++k) {
        const double least = contacts != nullptr ? 1 : of_interest_;
        if (doubtful_corners(k, leaf, least) == 0) continue;
        Departure departure = at_nearest_place(k, box, metric_at, contacts);
        for (const double most : {most_along_, most_}) {
            if (!(departure.worst > target_)) find_exceeded(k, leaf, most, departure);
        }
        worst.take(departure);
    }
    return worst;
}

void SingleCones::append_around_tips(const Box& box, std::ptrdiff_t most_faces,
                                     std::vector<Point>& places) const {
    constexpr double near = single_cones::near_tip;
    for (std::size_t k = 0; k < size(); ++k) {
        const Metric& metric = sources_[k].metric;
        const double reach = near * std::ranges::max(metric_edge_lengths(metric, box.edges()));
        const double gap = (nearest_in(box, position(k)) - position(k)).squaredNorm();
        const double longest = metric.xx + metric.yy + metric.zz;
        if (gap > reach * reach * longest * longest) continue;
        const Point nearest = nearest_place(k, box);
        const double distance = metric_length(metric, nearest - position(k));
        if (distance > reach) continue;
        const EigenFrame frame = eigen_frame(metric);
        const std::ptrdiff_t first = std::ssize(places);
        for (const double share : {0.5, 1.5, 4.0}) {
            const double size = share * std::max(distance, 0.5);
            if (size > 2 * reach / near) break;
            // Along the axes of the metric, and between them.
            for (int way = 0; way < 27; ++way) {
                const Eigen::Vector3i signs(way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1);
                const Vector along = signs.cast<double>();
                const double steps = along.cwiseAbs().sum();
                if (steps != 1 && steps != 3) continue;
                Vector step = Vector::Zero();
                for (int a = 0; a < 3; ++a) {
                    step += along[a] * frame.lengths[static_cast<std::size_t>(a)] *
                            frame.directions.col(a);
                }
                const Point x = nearest_in(box, nearest + size / std::sqrt(steps) * step);
                const bool is_known =
                    x == nearest || faces_at(box, x) > most_faces ||
                    std::find(places.begin() + first, places.end(), x) != places.end();
                if (!is_known) places.push_back(x);
            }
        }
    }
}

// Bits of corners; if none, trilinear metrics are nowhere in the box longer than the cone by more
// than a factor. They are not if they are not at the corners, when the cone's own factor, which is
// convex, is replaced by a tangent at the centre: |T(x) M^-1| is a convex function of T, and T a
// mean of the corners'. At a corner, T is within k M where k² M² - T² is positive definite.
unsigned SingleCones::doubtful_corners(std::size_t source, const Part& part, double most) const {
    constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
    const Metric& metric = sources_[source].metric;
    const double slope = cone_growth(sources_[source], ratio_) - 1;
    const Vector from_source = part.box.centre() - position(source);
    const double distance = std::max(metric_length(metric, from_source), 1e-150);
    const Vector rise = (slope / distance * (inverse_squares_[source].matrix() * from_source))
                            .cwiseProduct(0.5 * part.box.edges());
    static const std::array sides{side_of_corners(0), side_of_corners(1), side_of_corners(2)};
    const Lanes tangent =
        1 + slope * distance + rise.x() * sides[0] + rise.y() * sides[1] + rise.z() * sides[2];
    const Lanes k2 = (most * tangent.max(0)).square();
    const TensorLanes own = square(part.at);
    const Metric of_source = square(metric);
    const Lanes doubt = rounding * k2 * (of_source.xx + of_source.yy + of_source.zz);
    const TensorLanes room{k2 * of_source.xx - own.xx - doubt, k2 * of_source.yy - own.yy - doubt,
                           k2 * of_source.zz - own.zz - doubt, k2 * of_source.xy - own.xy,
                           k2 * of_source.xz - own.xz,         k2 * of_source.yz - own.yz};
    const Lanes least = least_minor(room);
    unsigned corners = 0;
    for (int c = 0; c < 8; ++c) corners |= static_cast<unsigned>(!(least[c] > 0)) << c;
    return corners;
}

// In halves of the leaf, halves of these and so on, across edges that are the longest in the
// source's metric, as long as the cone may be exceeded by the factor in them.
void SingleCones::find_exceeded(std::size_t source, const Part& leaf, double most,
                                Departure& departure) const {
    std::vector<Part> parts{leaf};
    for (std::size_t k = 0; !parts.empty() && k < single_cones::parts_of_cell; ++k) {
        Part part = parts.back();
        parts.pop_back();
        const unsigned doubtful = doubtful_corners(source, part, most);
        if (doubtful == 0) continue;
        for (int c = 0; c < 8; ++c) {
            if (((doubtful & ~part.known) >> c & 1) == 0) continue;
            departure.take(beyond(source, part.at[c], most_, corner(part.box, c)));
            if (departure.worst > target_) return;
        }
        part.known |= doubtful;
        const auto lengths = metric_edge_lengths(sources_[source].metric, part.box.edges());
        const auto [low, high] =
            part.halves(static_cast<Axis>(std::ranges::max_element(lengths) - lengths.begin()));
        parts.push_back(low);
        parts.push_back(high);
    }
}

// Outside of the box a quadratic distance has its minimum in one of the faces that are seen from
// the source, or in an edge.
Point SingleCones::nearest_place(std::size_t source, const Box& box) const {
    const Point& q = position(source);
    Point nearest = nearest_in(box, q);
    if (is_isotropic(sources_[source].metric) || nearest == q) return nearest;
    // Mostly it is where the nearest place of a face's plane is.
    const Eigen::Matrix3d squared = square(sources_[source].metric).matrix();
    for (Axis i = 0; i < 3; ++i) {
        if (nearest[i] == q[i]) continue;
        Point x = q + (nearest[i] - q[i]) / squared(i, i) * squared.col(i);
        x[i] = nearest[i];
        if (box.contains(x)) return x;
    }
    const Eigen::Matrix3d a = inverse_squares_[source].matrix();
    double least = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 8; ++c) {
        for (Axis along = 0; along < 3; ++along) {
            if ((c >> along & 1) != 0) continue;
            Point x = corner(box, c);
            const double at = x[along] - a.col(along).dot(x - q) / a(along, along);
            x[along] = std::clamp(at, box.low[along], box.high[along]);
            const double distance = (x - q).dot(a * (x - q));
            if (!(distance < least)) continue;
            least = distance;
            nearest = x;
        }
    }
    return nearest;
}

}  // namespace controlspace
