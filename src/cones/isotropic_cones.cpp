#include "cones/isotropic_cones.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>

#include "cones/cone.h"

namespace controlspace {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

// From p to the cylinders, and so to all sources in them.
IsotropicCones::Children IsotropicCones::distances(const Node& node, const Point& p) const {
    const Children x = p.x() - node.x;
    const Children y = p.y() - node.y;
    const Children z = p.z() - node.z;
    const Children along = x * node.normal_x + y * node.normal_y + z * node.normal_z;
    const Children across =
        ((x - along * node.normal_x).square() + (y - along * node.normal_y).square() +
         (z - along * node.normal_z).square())
            .sqrt();
    const Children above = (along.abs() - node.half_thickness).max(0);
    const Children beside = (across - node.radius).max(0);
    return (above.square() + beside.square()).sqrt();
}

IsotropicCones::Children IsotropicCones::lower_bounds(const Node& node, const Point& p) const {
    return safely_ * (node.length + slope_ * distances(node, p));
}

double IsotropicCones::length_at(const Leaf& leaf, Eigen::Index lane, const Point& p) const {
    const double h = leaf.length[lane];
    const PointSource source{{leaf.x[lane], leaf.y[lane], leaf.z[lane]}, Metric::isotropic(h)};
    return cone_factor(source, g_, p) * h;
}

void IsotropicCones::visit_leaf(std::uint32_t index, const Point& p, double& smallest,
                                Hint& hint) const {
    // First as bounds have them, all lanes: only those near to the least may have the smallest.
    const Leaf& leaf = leaves_[index];
    const Lanes lengths = leaf.length + slope_ * leaf.distances(p);
    const double least = lengths.minCoeff();
    if (!(safely_ * least < smallest)) return;
    const double doubtful = least / (safely_ * safely_);
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(leaf_size); ++i) {
        if (!(lengths[i] <= doubtful)) continue;
        const double length = length_at(leaf, i, p);
        if (length < smallest) {
            smallest = length;
            hint = index;
        }
    }
}

double IsotropicCones::smallest_length(const Point& p, Hint& hint) const {
    return search(p, cap_, 0, hint);
}

double IsotropicCones::smallest_length(const Point& p, double tolerance, Hint& hint) const {
    return search(p, cap_, tolerance, hint);
}

std::optional<std::uint32_t> IsotropicCones::source_below(const Point& p, double length,
                                                          Hint& hint) const {
    const double smallest = search(p, length, 0, hint);
    if (!(smallest < length)) return std::nullopt;
    return source_of(p, smallest, hint);
}

std::uint32_t IsotropicCones::source_of(const Point& p, double smallest, Hint hint) const {
    return indices_[hint * leaf_size + static_cast<std::size_t>(lane_of(p, smallest, hint))];
}

Eigen::Index IsotropicCones::lane_of(const Point& p, double smallest, Hint leaf) const {
    Eigen::Index lane = 0;
    while (length_at(leaves_[leaf], lane, p) != smallest) ++lane;
    return lane;
}

// Calls visit_leaf(leaf) for all leaves but those below children that `passed_over(node)` tells to
// pass over, until one call returns false; returns whether none did.
template <class PassedOver, class VisitLeaf>
bool IsotropicCones::visit(const PassedOver& passed_over, const VisitLeaf& visit_leaf) const {
    struct Part {
        std::uint32_t level;
        std::uint32_t node;  ///< within its level
    };
    // Seven siblings wait at each of at most eleven levels.
    std::array<Part, 96> stack;
    std::size_t height = 0;
    stack[height++] = {0, 0};
    const std::size_t levels = first_of_level_.size() - 1;
    while (height > 0) {
        const Part next = stack[--height];
        if (next.level == levels) {
            if (!visit_leaf(shape_.leaf_in(next.node))) return false;
            continue;
        }
        const auto passed = passed_over(nodes_[first_of_level_[next.level] + next.node]);
        for (std::uint32_t c = 0; c < static_cast<std::uint32_t>(arity); ++c) {
            if (!passed[c]) stack[height++] = {next.level + 1, arity * next.node + c};
        }
    }
    return true;
}

// No cone's length differs by more than (g-1) R between the centre of a box and a place in it, R
// half its diagonal: what is 2 (g-1) R above the smallest at the centre is nowhere the smallest.
bool IsotropicCones::gather(const Box& box, NearbyCones& nearby, Hint& hint) const {
    nearby.reset(slope_, cap_);
    if (leaves_.empty()) return true;
    const Point p = box.centre();
    const double reach =
        (smallest_length(p, hint) + 2 * slope_ * box.half_diagonal()) / (safely_ * safely_);
    std::array<std::size_t, most_leaves_gathered> leaves;
    std::size_t leaves_found = 0;
    const bool are_few =
        visit([&](const Node& node) { return (lower_bounds(node, p) > reach).eval(); },
              [&](std::size_t leaf) {
                  if (leaves_found == leaves.size()) return false;
                  leaves[leaves_found++] = leaf;
                  return true;
              });
    if (!are_few) return false;
    for (const std::size_t number : std::span(leaves).first(leaves_found)) {
        const Leaf& leaf = leaves_[number];
        const Lanes lengths = leaf.length + slope_ * leaf.distances(p);
        for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(leaf_size); ++i) {
            if (!(lengths[i] <= reach) || leaf.length[i] == infinity) continue;
            nearby.add({leaf.x[i], leaf.y[i], leaf.z[i]}, leaf.length[i]);
        }
    }
    return true;
}

bool IsotropicCones::give_uncovered(std::size_t number, const Point& centre,
                                    ConeCover& cover) const {
    const Leaf& leaf = leaves_[number];
    const auto covered = cover.covered(leaf.distances(centre), leaf.length,
                                       [&](const Point& q) { return leaf.distances(q); });
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(leaf_size); ++i) {
        const std::size_t item = number * leaf_size + static_cast<std::size_t>(i);
        const Point position(leaf.x[i], leaf.y[i], leaf.z[i]);
        if (!covered[i] && !cover.give(indices_[item], position, leaf.length[i])) return false;
    }
    return true;
}

// Those are given that the source which is the smallest at the centre does not cover.
bool IsotropicCones::cover(const Box& box, double tolerance, ConeCover& cover, Hint& hint) const {
    cover.reset(box, slope_, cap_, tolerance);
    if (leaves_.empty()) return true;
    const Point centre = box.centre();
    const double smallest = smallest_length(centre, hint);
    if (smallest < cap_) {
        const Leaf& leaf = leaves_[hint];
        const Eigen::Index lane = lane_of(centre, smallest, hint);
        cover.choose(indices_[hint * leaf_size + static_cast<std::size_t>(lane)],
                     {leaf.x[lane], leaf.y[lane], leaf.z[lane]}, leaf.length[lane]);
    }
    const bool all_given = visit(
        [&](const Node& node) {
            const Children reach = (node.half_thickness.square() + node.radius.square()).sqrt();
            return cover.covered(distances(node, centre), node.length,
                                 [&](const Point& q) -> Children {
                                     return ((node.x - q.x()).square() + (node.y - q.y()).square() +
                                             (node.z - q.z()).square())
                                                .sqrt() +
                                            reach;
                                 });
        },
        [&](std::size_t leaf) { return give_uncovered(leaf, centre, cover); });
    return all_given && cover.complete();
}

double IsotropicCones::search(const Point& p, double cap, double tolerance, Hint& hint) const {
    return search(
        cap, tolerance, hint, [&](const Node& node) { return lower_bounds(node, p); },
        [&](Hint leaf, double& smallest) { visit_leaf(leaf, p, smallest, hint); });
}

// With c the centre of the box and R half its diagonal, a source Q is no nearer to any place in it
// than |c - Q| - R, and its farthest place is the corner opposite, at sqrt(|c - Q|^2 + R^2) at
// least: with the half edges e, the sum of (|c - Q|_a + e_a)^2.
IsotropicCones::Range IsotropicCones::range_in(const Box& box, Hint& hint) const {
    const Point centre = box.centre();
    const Vector half = 0.5 * box.edges();
    const double radius = half.norm();
    // Of one leaf's sources, the smallest length at the distances that `of` makes of those from the
    // centre along the axes.
    const auto visit = [&](Hint index, double& smallest, const auto& of) {
        const Leaf& leaf = leaves_[index];
        const Lanes x = of((leaf.x - centre.x()).abs(), half.x());
        const Lanes y = of((leaf.y - centre.y()).abs(), half.y());
        const Lanes z = of((leaf.z - centre.z()).abs(), half.z());
        const double least =
            (leaf.length + slope_ * (x.square() + y.square() + z.square()).sqrt()).minCoeff();
        if (!(least < smallest)) return;
        smallest = least;
        hint = index;
    };
    const double most = search(
        cap_, 0, hint,
        [&](const Node& node) -> Children {
            const Children farthest = (distances(node, centre).square() + radius * radius).sqrt();
            return safely_ * (node.length + slope_ * farthest);
        },
        [&](Hint leaf, double& smallest) {
            visit(leaf, smallest,
                  [](const Lanes& away, double edge) -> Lanes { return away + edge; });
        });
    const double least = search(
        most, 0, hint,
        [&](const Node& node) -> Children {
            const Children nearest = (distances(node, centre) - radius).max(0);
            return safely_ * (node.length + slope_ * nearest);
        },
        [&](Hint leaf, double& smallest) {
            visit(leaf, smallest,
                  [](const Lanes& away, double edge) -> Lanes { return (away - edge).max(0); });
        });
    return {least, most};
}

// The smallest of what `visit_leaf` lowers the length to, below `cap`, or up to the fraction
// `tolerance` more.
template <class LowerBounds, class VisitLeaf>
double IsotropicCones::search(double cap, double tolerance, Hint& hint,
                              const LowerBounds& lower_bounds, const VisitLeaf& visit_leaf) const {
    if (leaves_.empty()) return cap;
    const double enough = 1 / (1 + tolerance);
    double smallest = cap;
    visit_leaf(std::min(hint, static_cast<Hint>(leaves_.size() - 1)), smallest);
    struct Postponed {
        double bound;
        std::uint32_t level;
        std::uint32_t node;  ///< within its level
    };
    // Seven siblings wait at each of at most eleven levels.
    std::array<Postponed, 96> stack;
    std::size_t height = 0;
    stack[height++] = {-infinity, 0, 0};
    const std::size_t levels = first_of_level_.size() - 1;
    while (height > 0) {
        const Postponed next = stack[--height];
        if (next.bound >= enough * smallest) continue;
        if (next.level == levels) {
            visit_leaf(static_cast<Hint>(shape_.leaf_in(next.node)), smallest);
            continue;
        }
        const Node& node = nodes_[first_of_level_[next.level] + next.node];
        const Children bounds = lower_bounds(node);
        const std::size_t floor = height;
        const double limit = enough * smallest;
        unsigned children = 0;
        for (int c = 0; c < arity; ++c) children |= (bounds[c] < limit ? 1u : 0u) << c;
        for (; children != 0; children &= children - 1) {
            const auto c = static_cast<std::uint32_t>(std::countr_zero(children));
            // The nearest on top.
            std::size_t place = height++;
            for (; place > floor && stack[place - 1].bound < bounds[c]; --place) {
                stack[place] = stack[place - 1];
            }
            stack[place] = {bounds[c], next.level + 1, arity * next.node + c};
        }
    }
    return smallest;
}

}  // namespace controlspace
