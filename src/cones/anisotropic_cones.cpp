#include "cones/anisotropic_cones.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

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
// Which sources cannot matter
// ---------------------------
// Source i may be left out if a source j has C_j < C_i wherever C_i is shorter than the cap in any
// direction: there the smallest length of C_j is less, so C_j comes first, and by 1. C_i changes
// nothing any more; elsewhere it changes nothing by 2. Lengths get strictly smaller from i to j to
// j's own dominator and on, so all such sources may be left out at once.
// Let v = p - Q_i, t = (g-1) |M_i^-1 v|, k = f_j(Q_i), and r = max |M_j^-1 u| / |M_i^-1 u| over all
// u, the growth from M_j to M_i. Then
//     C_i = (1 + t) M_i,    C_j <= (k + (g-1) |M_j^-1 v|) M_j <= (k + r t) M_j,
// by the triangle inequality. C_i matters for t < T = cap / (smallest length of M_i) - 1 only, and
// (k + r t) / (1 + t) is monotonous in t, so it is at most s = max(k, (k + r T) / (1 + T)):
//     s M_j < M_i    is enough.
// Of equal sources at one place all but the first change nothing, and are left out too.
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
    double longest;  // or more: it only gets shorter, and is brought up to date now and then

    explicit Accumulated(const Metric& m)
        : metric(m), squared(square(m)), longest(eigen_frame(m).lengths[2]) {}

    // Whether `m` is another.
    bool shorten_to(const Metric& m) {
        if (m == metric) return false;
        metric = m;
        squared = square(m);
        constexpr unsigned now_and_then = 8;
        if (++changes % now_and_then == 0) longest = eigen_frame(m).lengths[2];
        return true;
    }

private:
    unsigned changes = 0;
};

struct Later {
    bool operator()(const AnisotropicCones::Waiting& a, const AnisotropicCones::Waiting& b) const {
        // Nodes, of rank 0, go before cones of the same length: they may hold one of lower rank.
        return a.length != b.length ? a.length > b.length : a.rank > b.rank;
    }
};

}  // namespace

AnisotropicCones::AnisotropicCones(std::span<const PointSource> sources, double g, double cap)
    : g_(g), cap_(cap) {
    std::vector<Cone> cones(sources.size());
    std::vector<double> anisotropies(sources.size());
    tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t i) {
        const auto lengths = eigen_frame(sources[i].metric).lengths;
        cones[i] = {sources[i], square(sources[i].metric), lengths[0],
                    static_cast<std::uint32_t>(i)};
        anisotropies[i] = lengths[2] / lengths[0];
    });
    for (const double a : anisotropies) uncertainty_ = std::max(uncertainty_, 4096 * epsilon * a);
    uncertainty_ = std::min(uncertainty_, 1.0);

    const auto key = [](const Cone& c) {
        const auto& [q, m] = c.source;
        return std::tie(q.x(), q.y(), q.z(), m.xx, m.yy, m.zz, m.xy, m.xz, m.yz, c.index);
    };
    tbb::parallel_sort(cones.begin(), cones.end(),
                       [&](const Cone& a, const Cone& b) { return key(a) < key(b); });
    cones.erase(std::unique(cones.begin(), cones.end(),
                            [](const Cone& a, const Cone& b) { return a.source == b.source; }),
                cones.end());
    build(std::move(cones));

    std::vector<std::uint8_t> dominated(cones_.size());
    tbb::parallel_for(std::size_t{0}, cones_.size(),
                      [&](std::size_t i) { dominated[i] = is_dominated(cones_[i]) ? 1 : 0; });
    std::vector<Cone> kept;
    for (std::size_t i = 0; i < cones_.size(); ++i) {
        if (dominated[i] == 0) kept.push_back(cones_[i]);
    }
    dropped_ = sources.size() - kept.size();
    if (kept.size() < cones_.size()) build(std::move(kept));
}

void AnisotropicCones::build(std::vector<Cone> cones) {
    shape_ = ConeTreeShape::with_leaves_of(cones.size(), leaf_size);
    const double weight = g_ > 1 ? 1 / (g_ - 1) : 1;
    std::vector<ConeTreeItem> items(cones.size());
    for (std::size_t i = 0; i < cones.size(); ++i) {
        const Point& q = cones[i].source.position;
        items[i] = {{q.x(), q.y(), q.z(), weight * cones[i].length}, static_cast<std::uint32_t>(i)};
    }
    sort_for_tree(shape_, items);
    cones_ = std::vector<Cone>(cones.size());
    for (std::size_t i = 0; i < items.size(); ++i) cones_[i] = cones[items[i].index];
    nodes_ = std::vector<Node>(shape_.nodes());
    if (cones_.empty()) return;
    for (std::uint32_t first = shape_.first_leaf(); first > 0; first /= 2) {
        tbb::parallel_for(first, 2 * first, [this](std::uint32_t node) {
            shape_.is_leaf(node) ? make_leaf(node) : merge(node);
            enclose(node);
        });
    }
    for (Node& node : nodes_) node.square = square(node.square);
}

bool AnisotropicCones::is_dominated(const Cone& cone) const {
    const double certain = 1 - uncertainty_;
    const double reach = std::max(0.0, cap_ / cone.length - 1);
    const Point& q = cone.source.position;
    const auto by = [&](const Cone& other) {
        const double k = cone_factor(other.source, g_, q);
        const auto is_below = [&](double factor) {
            const double safe = factor / certain;
            return certainly_below(safe * safe * other.square, 1, cone.square);
        };
        if (!(k * other.length < certain * cone.length) || !is_below(k)) return false;
        const double r = growth(cone.source.metric, other.source.metric);
        return is_below(std::max(k, (k + r * reach) / (1 + reach)));
    };
    std::vector<std::uint32_t> stack{1};
    while (!stack.empty()) {
        const std::uint32_t n = stack.back();
        stack.pop_back();
        if (!(least_factor(nodes_[n], q) * nodes_[n].length < certain * cone.length)) continue;
        if (!shape_.is_leaf(n)) {
            stack.insert(stack.end(), {2 * n, 2 * n + 1});
        } else if (std::any_of(cones_.data() + shape_.begin(n), cones_.data() + shape_.end(n),
                               by)) {
            return true;
        }
    }
    return false;
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

Metric AnisotropicCones::intersect(const Point& p, const Metric& largest, double tolerance,
                                   Queue& queue, std::vector<std::uint32_t>* governing) const {
    const double certain = 1 - uncertainty_;
    const double enough = certain * (1 + tolerance);
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
        if (!within(shortest, factor, cone.square)) {
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
            const Cone& cone = cones_[next.place];
            if (within(next.length, next.length / cone.length, cone.square)) continue;
            const double factor = cone_factor(cone.source, g_, p);
            const Metric shortened = intersection(found.metric, factor * cone.source.metric);
            if (found.shorten_to(shortened) && governing != nullptr) {
                governing->push_back(cone.index);
            }
        }
    }
    return found.metric;
}

}  // namespace controlspace
