#include "cones/anisotropic_cones.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "cones/cone.h"
#include "metric/intersection.h"

namespace controlspace {

// What makes leaving out safe
// ---------------------------
// Write A <= B for "the tensor of lengths A is within B": |A u| <= |B u| for all u, that is,
// B^2 - A^2 is positive semidefinite; then |A^-1 v| >= |B^-1 v| for all v. Let X be what has been
// accumulated, C_i = M_i f_i the cone of source i at p, f_i = 1 + (g-1) |M_i^-1 (p - Q_i)|.
//
// 1. Intersecting X with C_i leaves X as it is if X <= C_i. X only ever gets smaller, so a cone
//    that X is within once may be dropped at once, whatever its place in the order.
// 2. Where no length of X exceeds the smallest length of C_i, X <= C_i. Cones come by their
//    smallest length, so the first such one ends the search.
// 3. A node keeps L with L <= M_i for all its sources, and V, such that |V v| <= |M_i^-1 v|. Both
//    are intersections: of the M_i, and of their inverses. With c the node's centre and
//    R = max |V (Q_i - c)|, the triangle inequality gives
//        |M_i^-1 (p - Q_i)| >= |V (p - c)| - |V (Q_i - c)| >= |V (p - c)| - R,
//    hence f_i >= f = 1 + (g-1) max(0, |V (p - c)| - R). No cone of the node is shorter than
//    f min_i (smallest length of M_i), and L f <= C_i for all i: if X <= L f, drop the node.
//
// Rounding: a length computed from a tensor of anisotropy k is uncertain by some k epsilon, more so
// where thirty tensors have been intersected on the way to the root; bounds give way by that much
// (`uncertainty_`), so that in doubt a cone is intersected.

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr int leaf_size = 16;

Metric square(const Metric& m) {
    return {m.xx * m.xx + m.xy * m.xy + m.xz * m.xz, m.xy * m.xy + m.yy * m.yy + m.yz * m.yz,
            m.xz * m.xz + m.yz * m.yz + m.zz * m.zz, m.xy * (m.xx + m.yy) + m.xz * m.yz,
            m.xz * (m.xx + m.zz) + m.xy * m.yz,      m.yz * (m.yy + m.zz) + m.xy * m.xz};
}

Metric inverse(const Metric& m) {
    EigenFrame frame = eigen_frame(m);
    for (double& length : frame.lengths) length = 1 / length;
    return metric_from_frame(frame.lengths, frame.directions);
}

double length_in(const Metric& inverse, const Vector& v) {
    return Vector(inverse.xx * v.x() + inverse.xy * v.y() + inverse.xz * v.z(),
                  inverse.xy * v.x() + inverse.yy * v.y() + inverse.yz * v.z(),
                  inverse.xz * v.x() + inverse.yz * v.y() + inverse.zz * v.z())
        .norm();
}

// Whether `b_factor` * b2 - a2 is positive definite beyond doubt. The factorisation's backward
// error is a few epsilon of the largest entry, which the diagonal gives up in advance.
bool certainly_below(const Metric& a2, double b_factor, const Metric& b2) {
    const double doubt = 64 * epsilon * b_factor * (b2.xx + b2.yy + b2.zz);
    const double xx = b_factor * b2.xx - a2.xx - doubt;
    const double yy = b_factor * b2.yy - a2.yy - doubt;
    const double zz = b_factor * b2.zz - a2.zz - doubt;
    if (!(xx > 0 && yy > 0 && zz > 0)) return false;
    const double xy = b_factor * b2.xy - a2.xy;
    const double xz = b_factor * b2.xz - a2.xz;
    const double yz = b_factor * b2.yz - a2.yz;
    const double yx = xy / xx;
    const double zx = xz / xx;
    const double pivot_y = yy - yx * xy;
    if (!(pivot_y > 0)) return false;
    const double left_yz = yz - zx * xy;
    return zz - zx * xz - left_yz * left_yz / pivot_y > 0;
}

// The metric accumulated so far, with what the tests against it need.
struct Accumulated {
    Metric metric;
    Metric squared;
    double longest;

    explicit Accumulated(const Metric& m)
        : metric(m), squared(square(m)), longest(eigen_frame(m).lengths[2]) {}
};

struct Later {
    bool operator()(const AnisotropicCones::Waiting& a, const AnisotropicCones::Waiting& b) const {
        // Nodes, of rank 0, go before cones of the same length: they may hold one of lower rank.
        return a.length != b.length ? a.length > b.length : a.rank > b.rank;
    }
};

}  // namespace

AnisotropicCones::AnisotropicCones(std::span<const PointSource> sources, double g, double tolerance)
    : g_(g),
      tolerance_(tolerance),
      shape_(ConeTreeShape::with_leaves_of(sources.size(), leaf_size)),
      cones_(sources.size()),
      nodes_(shape_.nodes()) {
    std::vector<Cone> given(sources.size());
    std::vector<double> anisotropies(sources.size());
    std::vector<ConeTreeItem> items(sources.size());
    const double weight = g > 1 ? 1 / (g - 1) : 1;
    tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t i) {
        const auto index = static_cast<std::uint32_t>(i);
        const auto lengths = eigen_frame(sources[i].metric).lengths;
        given[i] = {sources[i], lengths[0], index};
        anisotropies[i] = lengths[2] / lengths[0];
        const Point& q = sources[i].position;
        items[i] = {{q.x(), q.y(), q.z(), weight * lengths[0]}, index};
    });
    for (const double a : anisotropies) uncertainty_ = std::max(uncertainty_, 4096 * epsilon * a);
    uncertainty_ = std::min(uncertainty_, 1.0);

    sort_for_tree(shape_, items);
    for (std::size_t i = 0; i < items.size(); ++i) cones_[i] = given[items[i].index];
    if (cones_.empty()) return;
    for (std::uint32_t first = shape_.first_leaf(); first > 0; first /= 2) {
        tbb::parallel_for(first, 2 * first, [this](std::uint32_t node) {
            shape_.is_leaf(node) ? make_leaf(node) : merge(node);
            enclose(node);
        });
    }
    for (Node& node : nodes_) node.square = square(node.square);
}

void AnisotropicCones::make_leaf(std::uint32_t n) {
    Node& node = nodes_[n];
    const std::size_t begin = shape_.begin(n);
    node.square = cones_[begin].source.metric;
    node.inverse = inverse(node.square);
    node.length = cones_[begin].length;
    for (std::size_t i = begin + 1; i < shape_.end(n); ++i) {
        const Metric& m = cones_[i].source.metric;
        node.square = intersection(node.square, m);
        node.inverse = intersection(node.inverse, inverse(m));
        node.length = std::min(node.length, cones_[i].length);
    }
}

void AnisotropicCones::merge(std::uint32_t n) {
    const Node& low = nodes_[2 * n];
    const Node& high = nodes_[2 * n + 1];
    nodes_[n].square = intersection(low.square, high.square);
    nodes_[n].inverse = intersection(low.inverse, high.inverse);
    nodes_[n].length = std::min(low.length, high.length);
}

void AnisotropicCones::enclose(std::uint32_t n) {
    Node& node = nodes_[n];
    Point low = cones_[shape_.begin(n)].source.position;
    Point high = low;
    for (std::size_t i = shape_.begin(n); i < shape_.end(n); ++i) {
        low = low.cwiseMin(cones_[i].source.position);
        high = high.cwiseMax(cones_[i].source.position);
    }
    node.centre = 0.5 * (low + high);
    node.radius = 0;
    for (std::size_t i = shape_.begin(n); i < shape_.end(n); ++i) {
        node.radius =
            std::max(node.radius, length_in(node.inverse, cones_[i].source.position - node.centre));
    }
}

double AnisotropicCones::least_factor(const Node& node, const Point& p) const {
    const double away = (1 - uncertainty_) * length_in(node.inverse, p - node.centre);
    return 1 + (g_ - 1) * std::max(0.0, away - (1 + uncertainty_) * node.radius);
}

Metric AnisotropicCones::intersect(const Point& p, const Metric& largest, Queue& queue) const {
    const double certain = 1 - uncertainty_;
    const double enough = certain * (1 + tolerance_);
    Accumulated found(largest);
    const auto within = [&](double shortest, double factor, const Metric& squared) {
        return enough * shortest >= found.longest ||
               certainly_below(found.squared, enough * enough * factor * factor, squared);
    };
    const auto wait = [&](const Waiting& w) {
        queue.push_back(w);
        std::push_heap(queue.begin(), queue.end(), Later{});
    };
    const auto consider_node = [&](std::uint32_t n) {
        const Node& node = nodes_[n];
        const double factor = least_factor(node, p);
        const double shortest = certain * factor * node.length;
        if (!within(shortest, factor, node.square)) wait({shortest, 0, n});
    };
    const auto consider_cone = [&](std::uint32_t place) {
        const Cone& cone = cones_[place];
        const double factor = cone_factor(cone.source, g_, p);
        const double shortest = factor * cone.length;
        if (!within(shortest, factor, square(cone.source.metric))) {
            wait({shortest, cone.index + 1, place});
        }
    };

    queue.clear();
    if (!cones_.empty()) consider_node(1);
    while (!queue.empty()) {
        std::pop_heap(queue.begin(), queue.end(), Later{});
        const Waiting next = queue.back();
        queue.pop_back();
        if (enough * next.length >= found.longest) break;
        if (next.rank == 0) {
            const Node& node = nodes_[next.place];
            if (within(next.length, least_factor(node, p), node.square)) continue;
            if (!shape_.is_leaf(next.place)) {
                consider_node(2 * next.place);
                consider_node(2 * next.place + 1);
            } else {
                for (std::size_t i = shape_.begin(next.place); i < shape_.end(next.place); ++i) {
                    consider_cone(static_cast<std::uint32_t>(i));
                }
            }
        } else {
            const PointSource& source = cones_[next.place].source;
            const double factor = cone_factor(source, g_, p);
            if (within(next.length, factor, square(source.metric))) continue;
            const Metric smaller = intersection(found.metric, factor * source.metric);
            if (smaller != found.metric) found = Accumulated(smaller);
        }
    }
    return found.metric;
}

}  // namespace controlspace
