#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "cones/isotropic_cones.h"

namespace controlspace {

// Which sources cannot matter
// ---------------------------
// Let source j meet the length of source i at i's place: h_j + (g-1) |Q_i - Q_j| <= h_i. Then for
// every p, by the triangle inequality,
//     h_j + (g-1) |p - Q_j| <= h_j + (g-1) |Q_i - Q_j| + (g-1) |p - Q_i| <= h_i + (g-1) |p - Q_i|:
// i is nowhere smaller than j, and may be left out. Where "<=" holds by more than some margin this
// goes from i to j to j's own dominator and on, lengths getting strictly smaller, and ends at a
// source that is kept: so all may be left out at once. Computed lengths below the cap are off by
// less than 32 epsilon of the cap; by a margin of more than twice that, leaving out does not change
// a bit of any answer. Of sources at one place the smallest is kept, without any margin.

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();

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

// One item for each place, of the smallest length there, in an order that depends on nothing else.
void keep_smallest_at_each_place(std::vector<ConeTreeItem>& items) {
    const auto key = [](const ConeTreeItem& i) {
        const auto& c = i.coordinates;
        return std::tie(c[0], c[1], c[2], c[3], i.index);
    };
    tbb::parallel_sort(
        items.begin(), items.end(),
        [&](const ConeTreeItem& a, const ConeTreeItem& b) { return key(a) < key(b); });
    const auto end = std::unique(
        items.begin(), items.end(),
        [](const ConeTreeItem& a, const ConeTreeItem& b) { return position(a) == position(b); });
    items.erase(end, items.end());
}

}  // namespace

struct IsotropicCones::Cylinder {
    Point centre;
    Vector normal;
    double half_thickness, radius;

    explicit Cylinder(std::span<const ConeTreeItem> items) {
        Point low = position(items.front());
        Point high = low;
        for (const ConeTreeItem& item : items) {
            low = low.cwiseMin(position(item));
            high = high.cwiseMax(position(item));
        }
        centre = 0.5 * (low + high);
        normal = normal_of(items, centre, (high - low).maxCoeff());
        double least = infinity;
        double most = -infinity;
        for (const ConeTreeItem& item : items) {
            const double along = normal.dot(position(item) - centre);
            least = std::min(least, along);
            most = std::max(most, along);
        }
        centre += 0.5 * (least + most) * normal;
        double thickness = 0;
        double squared_radius = 0;
        for (const ConeTreeItem& item : items) {
            const Vector v = position(item) - centre;
            const double along = normal.dot(v);
            thickness = std::max(thickness, std::abs(along));
            squared_radius = std::max(squared_radius, (v - along * normal).squaredNorm());
        }
        const double rounding = 64 * epsilon * (high - low).norm();
        half_thickness = thickness + rounding;
        radius = std::sqrt(squared_radius) + rounding;
    }
};

IsotropicCones::IsotropicCones(std::span<const PointSource> sources, double g, double cap)
    : g_(g),
      slope_(g - 1),
      cap_(cap),
      // A cone's length is computed as h (1 + (g-1) |v / h|), its bounds as h + (g-1) |v|; the two
      // differ by a few roundings, and the bounds give way by more. Without growth, by none.
      safely_(g > 1 ? 1 - 64 * epsilon : 1) {
    // Without growth only the lengths tell cones apart.
    const double weight = slope_ > 0 ? 1 / slope_ : 1;
    std::vector<ConeTreeItem> items(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const Point& q = sources[i].position;
        items[i] = {{q.x(), q.y(), q.z(), weight * sources[i].metric.xx},
                    static_cast<std::uint32_t>(i)};
    }
    keep_smallest_at_each_place(items);
    build(items, sources);

    std::vector<std::uint8_t> dominated(items.size());
    tbb::parallel_for(std::size_t{0}, items.size(), [&](std::size_t i) {
        dominated[i] = is_dominated(sources[items[i].index]) ? 1 : 0;
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (dominated[i] == 0) items[kept++] = items[i];
    }
    dropped_ = sources.size() - kept;
    if (kept == items.size()) return;
    items.resize(kept);
    build(items, sources);
}

void IsotropicCones::build(std::span<ConeTreeItem> items, std::span<const PointSource> sources) {
    shape_ = ConeTreeShape::with_leaves_of(items.size(), leaf_size);
    const auto items_of = [&](std::uint32_t node) {
        return items.subspan(shape_.begin(node), shape_.end(node) - shape_.begin(node));
    };
    sort_for_tree(shape_, items);
    indices_ = std::vector<std::uint32_t>(items.size());
    std::transform(items.begin(), items.end(), indices_.begin(),
                   [](const ConeTreeItem& item) { return item.index; });

    leaves_ = std::vector<Leaf>(shape_.leaves);
    tbb::parallel_for(std::size_t{0}, leaves_.size(), [&](std::size_t l) {
        Leaf& leaf = leaves_[l];
        leaf.x.setZero();
        leaf.y.setZero();
        leaf.z.setZero();
        leaf.length.setConstant(infinity);
        Eigen::Index lane = 0;
        const std::size_t begin = l * leaf_size;
        const std::size_t end = std::min<std::size_t>(begin + leaf_size, items.size());
        for (const ConeTreeItem& item : items.subspan(begin, end - begin)) {
            leaf.x[lane] = item.coordinates[0];
            leaf.y[lane] = item.coordinates[1];
            leaf.z[lane] = item.coordinates[2];
            leaf.length[lane++] = sources[item.index].metric.xx;
        }
    });

    const std::vector<int> levels = levels_of_eight_children(shape_.depth);
    first_of_level_.assign(1, 0);
    for (const int level : levels) {
        first_of_level_.push_back(first_of_level_.back() + (std::size_t{1} << level));
    }
    first_of_level_.shrink_to_fit();
    nodes_ = std::vector<Node>(first_of_level_.back());
    for (std::size_t l = levels.size(); l-- > 0;) {
        const int below = l + 1 < levels.size() ? levels[l + 1] : shape_.depth;
        const std::uint32_t children = std::uint32_t{1} << (below - levels[l]);
        const std::uint32_t nodes = std::uint32_t{1} << levels[l];
        tbb::parallel_for(std::uint32_t{0}, nodes, [&](std::uint32_t n) {
            Node& node = nodes_[first_of_level_[l] + n];
            for (std::uint32_t c = 0; c < static_cast<std::uint32_t>(arity); ++c) {
                const std::uint32_t child = n * children + c;
                const auto items_of_child =
                    items_of((std::uint32_t{1} << below) + (c < children ? child : 0));
                const bool exists = c < children && !items_of_child.empty();
                const Cylinder cylinder(exists ? items_of_child : items.first(1));
                node.x[c] = cylinder.centre.x();
                node.y[c] = cylinder.centre.y();
                node.z[c] = cylinder.centre.z();
                node.normal_x[c] = cylinder.normal.x();
                node.normal_y[c] = cylinder.normal.y();
                node.normal_z[c] = cylinder.normal.z();
                node.half_thickness[c] = cylinder.half_thickness;
                node.radius[c] = cylinder.radius;
                node.length[c] = !exists ? infinity
                                 : l + 1 < levels.size()
                                     ? nodes_[first_of_level_[l + 1] + child].length.minCoeff()
                                     : leaves_[shape_.leaf_in(child)].length.minCoeff();
            }
        });
    }
}

bool IsotropicCones::is_dominated(const PointSource& source) const {
    const double margin = 128 * epsilon * cap_;
    const double length = source.metric.xx - margin;
    Hint hint = 0;
    return search(source.position, length, 0, hint) < length;
}

}  // namespace controlspace
