#include "cones/isotropic_cones.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "cones/cone.h"

namespace controlspace {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

Point position(const ConeTreeItem& item) {
    return {item.coordinates[0], item.coordinates[1], item.coordinates[2]};
}

// Unit vector along which the items spread least. Any unit vector is right, this one is fast.
Vector normal_of(std::span<const ConeTreeItem> items, const Point& centre, double extent) {
    if (!(extent > 0)) return Vector::UnitX();
    Vector sum = Vector::Zero();
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (const ConeTreeItem& item : items) {
        const Vector v = (position(item) - centre) / extent;
        sum += v;
        moments += v * v.transpose();
    }
    moments -= sum * sum.transpose() / static_cast<double>(items.size());
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(moments);
    const Vector normal = solver.eigenvectors().col(0).normalized();
    return std::abs(normal.squaredNorm() - 1) < 4 * epsilon ? normal : Vector::UnitX();
}

}  // namespace

IsotropicCones::IsotropicCones(std::span<const PointSource> sources, double g)
    : g_(g),
      slope_(g - 1),
      // A cone's length is computed as h (1 + (g-1) |v / h|), its bounds as h + (g-1) |v|; the two
      // differ by a few roundings, and the bounds give way by more. Without growth, by none.
      safely_(g > 1 ? 1 - 64 * epsilon : 1),
      shape_(ConeTreeShape::with_leaves_of(sources.size(), leaf_size)),
      nodes_(shape_.nodes()),
      leaves_(shape_.first_leaf()) {
    if (sources.empty()) return;
    // Without growth only the lengths tell cones apart.
    const double weight = slope_ > 0 ? 1 / slope_ : 1;
    std::vector<ConeTreeItem> items(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const Point& q = sources[i].position;
        items[i] = {{q.x(), q.y(), q.z(), weight * sources[i].metric.xx},
                    static_cast<std::uint32_t>(i)};
    }
    sort_for_tree(shape_, items);
    for (std::uint32_t first = shape_.first_leaf(); first > 0; first /= 2) {
        tbb::parallel_for(first, 2 * first, [&](std::uint32_t node) {
            if (shape_.is_leaf(node)) {
                make_leaf(node, sources, items);
            } else {
                nodes_[node].length =
                    std::min(nodes_[2 * node].length, nodes_[2 * node + 1].length);
            }
            enclose(node, items);
        });
    }
}

void IsotropicCones::make_leaf(std::uint32_t node, std::span<const PointSource> sources,
                               std::span<const ConeTreeItem> items) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Leaf& leaf = leaves_[node - shape_.first_leaf()];
    leaf.length.fill(infinity);
    const std::size_t begin = shape_.begin(node);
    for (std::size_t i = begin; i < shape_.end(node); ++i) {
        const PointSource& source = sources[items[i].index];
        const std::size_t lane = i - begin;
        leaf.x[lane] = source.position.x();
        leaf.y[lane] = source.position.y();
        leaf.z[lane] = source.position.z();
        leaf.length[lane] = source.metric.xx;
    }
    nodes_[node].length = *std::min_element(leaf.length.begin(), leaf.length.end());
}

void IsotropicCones::enclose(std::uint32_t n, std::span<const ConeTreeItem> items) {
    const auto of_node = items.subspan(shape_.begin(n), shape_.end(n) - shape_.begin(n));
    Point low = position(of_node.front());
    Point high = low;
    for (const ConeTreeItem& item : of_node) {
        low = low.cwiseMin(position(item));
        high = high.cwiseMax(position(item));
    }
    Node& node = nodes_[n];
    node.centre = 0.5 * (low + high);
    node.normal = normal_of(of_node, node.centre, (high - low).maxCoeff());
    double thickness = 0;
    double squared_radius = 0;
    for (const ConeTreeItem& item : of_node) {
        const Vector v = position(item) - node.centre;
        const double along = node.normal.dot(v);
        thickness = std::max(thickness, std::abs(along));
        squared_radius = std::max(squared_radius, v.squaredNorm() - along * along);
    }
    const double rounding = 64 * epsilon * (high - low).norm();
    node.half_thickness = thickness + rounding;
    node.radius = std::sqrt(squared_radius) + rounding;
}

double IsotropicCones::lower_bound(const Node& node, const Point& p) const {
    // Every source of the node has h_i >= length and |p - Q_i| >= distance to the cylinder.
    const Vector v = p - node.centre;
    const double along = node.normal.dot(v);
    const double across = std::sqrt(std::max(0.0, v.squaredNorm() - along * along));
    const double above = std::max(0.0, std::abs(along) - node.half_thickness);
    const double beside = std::max(0.0, across - node.radius);
    return safely_ * (node.length + slope_ * std::sqrt(above * above + beside * beside));
}

void IsotropicCones::visit_leaf(const Leaf& leaf, const Point& p, double& smallest) const {
    // Negative where h_i + (g-1) |p - Q_i| may be below `smallest`: compared as squares, all lanes.
    Lanes excess;
    for (std::size_t i = 0; i < leaf_size; ++i) {
        const double reach = smallest / safely_ - leaf.length[i];
        const double x = leaf.x[i] - p.x();
        const double y = leaf.y[i] - p.y();
        const double z = leaf.z[i] - p.z();
        excess[i] = reach > 0 ? slope_ * slope_ * (x * x + y * y + z * z) - reach * reach : 0;
    }
    for (std::size_t i = 0; i < leaf_size; ++i) {
        if (excess[i] >= 0) continue;
        const double h = leaf.length[i];
        const PointSource source{{leaf.x[i], leaf.y[i], leaf.z[i]}, Metric::isotropic(h)};
        smallest = std::min(smallest, cone_factor(source, g_, p) * h);
    }
}

double IsotropicCones::smallest_length(const Point& p, double cap) const {
    struct Postponed {
        double bound;
        std::uint32_t node;
    };
    std::array<Postponed, 64> stack;  // at most one a level
    std::size_t height = 0;
    double smallest = cap;
    if (shape_.size > 0) stack[height++] = {0, 1};
    while (height > 0) {
        auto [bound, node] = stack[--height];
        while (bound < smallest && !shape_.is_leaf(node)) {
            const double low = lower_bound(nodes_[2 * node], p);
            const double high = lower_bound(nodes_[2 * node + 1], p);
            const std::uint32_t nearer = low <= high ? 0 : 1;
            stack[height++] = {std::max(low, high), 2 * node + (1 - nearer)};
            bound = std::min(low, high);
            node = 2 * node + nearer;
        }
        if (bound < smallest) visit_leaf(leaves_[node - shape_.first_leaf()], p, smallest);
    }
    return smallest;
}

}  // namespace controlspace
