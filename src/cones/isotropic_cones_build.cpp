// SPDX-License-Identifier: Apache-2.0
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "cones/isotropic_cones.h"
#include "controlspace/sources/cone.h"
#include "geometry/extent_of.h"
#include "geometry/hash_of_words.h"

namespace controlspace {

// Which sources cannot matter
// ---------------------------
// Let source j meet the length of source i at i's place: k = h_j + s_j |Q_i - Q_j| <= h_i. Then for
// every p, by the triangle inequality,
//     h_j + s_j |p - Q_j| <= k + s_j |p - Q_i|.
// If j is no steeper than i, s_j <= s_i, this is not above h_i + s_i |p - Q_i|. If it is, it is not
// as long as that is not above the cap, provided that k + s_j T <= cap where h_i + s_i T = cap. In
// both cases i is nowhere smaller than j where it matters, and may be left out. Where "<=" holds by
// more than some margin this goes from i to j to j's own dominator and on, lengths getting strictly
// smaller, and ends at a source that is kept: so all may be left out at once. Computed lengths
// below the cap are off by less than 32 epsilon of the cap; by a margin of more than twice that,
// leaving out does not change a bit of any answer. Of sources at one place the smallest is kept,
// without any margin, and others that are less steep.
//
// Sources on each other's cones
// -----------------------------
// The vertices of a graded mesh, read back as sources, all lie nearly on the cones of some of them.
// A bound of a node of radius r is less than its cones by up to s r, so that the search from a
// source Q visits what is within an angle of sqrt(r / R) of the way to the source whose cone it
// lies on, at the distance R: in space n^(2/3) nodes for n sources, and n^(5/3) for all, most of
// them to find that no source is dominated. Where a sample of the sources takes many visits,
// - sources are taken by their lengths, ascending, and left out where a source kept before comes
//   within rounding of theirs: those on one cone lie on that of few sources, which come first;
// - a search ends after some visits, and keeps its source. That costs room, and changes no answer.
// By a factor f in place of rounding, k <= f h_i, both conditions above give lengths of f times
// those of all sources at most: of what is left out, each is compared with what is kept alone, so
// that factors do not add up.

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t samples = 128;       // of sources
constexpr std::size_t enough_visits = 32;  // where a search of each source takes long

// Unit vector along which the items spread least. Any unit vector is right, this one is fast.
Vector normal_of(std::span<const ConeTreeItem> items, const Point& centre, double extent) {
    if (!(extent > 0)) return Vector::UnitX();
    Vector sum = Vector::Zero();
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (const ConeTreeItem& item : items) {
        const Vector v = (item.position() - centre) / extent;
        sum += v;
        moments += v * v.transpose();
    }
    moments -= sum * sum.transpose() / static_cast<double>(items.size());
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(moments);
    const Vector normal = solver.eigenvectors().col(0).normalized();
    return std::abs(normal.squaredNorm() - 1) < 4 * epsilon ? normal : Vector::UnitX();
}

double slope_of(const PointSource& source, double g) { return cone_growth(source, g) - 1; }

IsotropicCone cone_of(const PointSource& source, double g) {
    return {source.position, source.metric.xx, slope_of(source, g)};
}

// There are no two of one length at one place.
bool is_same(const IsotropicCone& a, const IsotropicCone& b) {
    return a.length == b.length && a.position == b.position;
}

// For each place the item of the smallest length there, and longer ones that are less steep, in an
// order that depends on nothing else.
void keep_smallest_at_each_place(std::vector<ConeTreeItem>& items, const SourceColumns& sources,
                                 double g) {
    const auto slope = [&](const ConeTreeItem& item) { return slope_of(sources[item.index], g); };
    tbb::parallel_sort(items.begin(), items.end(), [&](const auto& a, const auto& b) {
        // Sources are far away in memory: only of the same place are they looked at.
        if (a.coordinates != b.coordinates) return a.coordinates < b.coordinates;
        return std::tuple(slope(a), a.index) < std::tuple(slope(b), b.index);
    });
    const auto end =
        std::unique(items.begin(), items.end(), [&](const ConeTreeItem& a, const ConeTreeItem& b) {
            return a.position() == b.position() && slope(a) <= slope(b);
        });
    items.erase(end, items.end());
}

// Around the positions of items; there must be one.
struct Cylinder {
    Point centre;
    Vector normal;
    double half_thickness, radius;

    explicit Cylinder(std::span<const ConeTreeItem> items) {
        const Box extent = extent_of(items, &ConeTreeItem::position);
        centre = extent.centre();
        normal = normal_of(items, centre, extent.edges().maxCoeff());
        double least = infinity;
        double most = -infinity;
        for (const ConeTreeItem& item : items) {
            const double along = normal.dot(item.position() - centre);
            least = std::min(least, along);
            most = std::max(most, along);
        }
        centre += 0.5 * (least + most) * normal;
        double thickness = 0;
        double squared_radius = 0;
        for (const ConeTreeItem& item : items) {
            const Vector v = item.position() - centre;
            const double along = normal.dot(v);
            thickness = std::max(thickness, std::abs(along));
            squared_radius = std::max(squared_radius, (v - along * normal).squaredNorm());
        }
        const double rounding = 64 * epsilon * extent.edges().norm();
        half_thickness = thickness + rounding;
        radius = std::sqrt(squared_radius) + rounding;
    }
};

// By length in steps of an eighth of an octave, and within one in an order as good as random: any
// first part of it is spread like the whole.
std::vector<ConeTreeItem> sorted_by_length(std::span<const ConeTreeItem> items,
                                           const SourceColumns& sources, double g) {
    constexpr int bits_below_steps = 49;
    struct Keyed {
        std::uint64_t step, number;
        ConeTreeItem item;
    };
    std::vector<Keyed> keyed(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        const double length = sources[items[i].index].metric.xx;
        keyed[i] = {std::bit_cast<std::uint64_t>(length) >> bits_below_steps,
                    hash_of_words(items[i].coordinates), items[i]};
    }
    tbb::parallel_sort(keyed.begin(), keyed.end(), [&](const Keyed& a, const Keyed& b) {
        if (a.step != b.step) return a.step < b.step;
        if (a.number != b.number) return a.number < b.number;
        const auto slope = [&](const Keyed& k) { return slope_of(sources[k.item.index], g); };
        return std::tuple(a.item.coordinates, slope(a), a.item.index) <
               std::tuple(b.item.coordinates, slope(b), b.item.index);
    });
    std::vector<ConeTreeItem> sorted(items.size());
    std::ranges::transform(keyed, sorted.begin(), &Keyed::item);
    return sorted;
}

// Leaves out those marked; whether there are any.
bool leave_out(std::vector<ConeTreeItem>& items, std::span<const std::uint8_t> marked) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (marked[i] == 0) items[kept++] = items[i];
    }
    const bool are_fewer = kept < items.size();
    items.resize(kept);
    return are_fewer;
}

}  // namespace

// Nodes that a search visits, and the most that it may.
struct IsotropicCones::Visits {
    std::size_t most = std::numeric_limits<std::size_t>::max();
    std::size_t count = 0;
};

IsotropicCones::IsotropicCones(const SourceColumns& sources, double g, double cap, double longer)
    : steepest_(largest_growth(sources, g) - 1),
      cap_(cap),
      // A cone's length is computed as h (1 + (g-1) |v / h|), its bounds as h + (g-1) |v|; the two
      // differ by a few roundings, and the bounds give way by more. Without growth, by none.
      safely_(steepest_ > 0 ? 1 - 64 * epsilon : 1) {
    // Without growth cones differ in their lengths only.
    const double weight = g > 1 ? 1 / (g - 1) : 1;
    std::vector<ConeTreeItem> items(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const PointSource& source = sources[i];
        const Point& q = source.position;
        items[i] = {{q.x(), q.y(), q.z(), weight * source.metric.xx},
                    static_cast<std::uint32_t>(i)};
    }
    keep_smallest_at_each_place(items, sources, g);
    build(items, sources, g);

    std::size_t most_visits = Visits().most;
    if (takes_long(items, sources, g)) {
        most_visits = enough_visits;
        if (!leave_out_covered(items, sources, g, 1 + 16 * epsilon) && longer > 1 &&
            leave_out_covered(items, sources, g, longer)) {
            longer_ = longer;
        }
    }
    const double margin = 128 * epsilon * cap_;
    const std::vector<std::uint8_t> dominated =
        found_in(items, most_visits, [&](const ConeTreeItem& item, Visits& visits) {
            const IsotropicCone cone = cone_of(sources[item.index], g);
            return is_dominated(cone, cone.length - margin, visits);
        });
    if (leave_out(items, dominated)) build(items, sources, g);
    dropped_ = sources.size() - items.size();
}

// Whether another source's cone is below this length at the source, and nowhere above that of the
// source by more than the same factor, as far as so many visits show.
bool IsotropicCones::is_dominated(const IsotropicCone& cone, double below, Visits& visits) const {
    const double margin = 128 * epsilon * cap_;
    const auto is_below = [&](double at_cone, double slope) {
        if (!(at_cone < below)) return false;
        if (slope <= cone.slope) return true;
        return at_cone + slope * (cap_ - cone.length) / cone.slope <= cap_ - margin;
    };
    // Steeper sources that all rise above the cap, or too near to it, are passed over together.
    const double reach = (cap_ - cone.length) / cone.slope;
    const auto bounds = [&](const Node& node) -> Lanes {
        if (visits.count == visits.most) return Lanes::Constant(infinity);
        ++visits.count;
        const Lanes least = lower_bounds(node, cone.position);
        const auto rise_above =
            node.slope > cone.slope && least + node.slope * reach > cap_ - margin;
        return rise_above.select(Lanes::Constant(infinity), least);
    };
    return !tree_.search([&] { return below; }, bounds,
                         [&](std::uint32_t number) {
                             const Leaf& leaf = tree_.leaf(number);
                             const LanesOf<leaf_size> roughly = leaf.lengths_at(cone.position);
                             for (Eigen::Index i = 0; i < leaf_size; ++i) {
                                 if (!(safely_ * roughly[i] < below)) continue;
                                 const IsotropicCone other = leaf[i];
                                 const double length = other.exact_length_at(cone.position);
                                 if (!is_below(length, other.slope)) continue;
                                 if (!is_same(other, cone)) return false;
                             }
                             return true;
                         });
}

// For each of `items` whether is_found(item, visits) holds, which makes `most` visits at most.
template <class IsFound>
std::vector<std::uint8_t> IsotropicCones::found_in(std::span<const ConeTreeItem> items,
                                                   std::size_t most, const IsFound& is_found) {
    std::vector<std::uint8_t> found(items.size());
    std::atomic<std::size_t> visited = 0;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, items.size()), [&](const auto& range) {
        std::size_t of_range = 0;
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            Visits visits{most};
            found[i] = is_found(items[i], visits) ? 1 : 0;
            of_range += visits.count;
        }
        visited += of_range;
    });
    visits_ += visited;
    return found;
}

// The share of the sources, of some, that are within a factor of others' cones; adds the visits.
double IsotropicCones::share_covered(std::span<const ConeTreeItem> items,
                                     const SourceColumns& sources, double g, double factor,
                                     std::size_t& visits) const {
    constexpr std::size_t most_visits = 256;
    std::size_t covered = 0;
    for (std::size_t k = 0; k < samples; ++k) {
        const IsotropicCone cone = cone_of(sources[items[k * items.size() / samples].index], g);
        Visits of_one{most_visits};
        if (is_dominated(cone, factor * cone.length, of_one)) ++covered;
        visits += of_one.count;
    }
    return static_cast<double>(covered) / samples;
}

// On the average, sources on surfaces take 1 to 12 visits, at random places 6, vertices of graded
// meshes 7 to 70; few sources take little time in any case.
bool IsotropicCones::takes_long(std::span<const ConeTreeItem> items, const SourceColumns& sources,
                                double g) const {
    constexpr std::size_t few_sources = 4096;
    constexpr std::size_t few_visits = 16;
    if (items.size() < few_sources) return false;
    std::size_t visits = 0;
    share_covered(items, sources, g, 1, visits);
    return visits > few_visits * samples;
}

// Leaves out the sources that those kept before them cover, within a factor; returns false, without
// effect, where these are fewer than half. Each part is as large as all before it, so that the
// trees, together, take twice the time of the last one at most.
bool IsotropicCones::leave_out_covered(std::vector<ConeTreeItem>& items,
                                       const SourceColumns& sources, double g, double factor) {
    constexpr double share_worth_it = 0.5;
    std::size_t visits_of_some = 0;
    if (share_covered(items, sources, g, factor, visits_of_some) < share_worth_it) return false;
    const std::vector<ConeTreeItem> sorted = sorted_by_length(items, sources, g);
    Tree of_all = std::move(tree_);
    std::vector<ConeTreeItem> kept;
    for (std::size_t done = 0; done < sorted.size();) {
        constexpr std::size_t first_part = 64;
        const auto part = std::span(sorted).subspan(
            done, std::min(std::max(done, first_part), sorted.size() - done));
        done += part.size();
        build(kept, sources, g);
        const std::vector<std::uint8_t> covered =
            found_in(part, enough_visits, [&](const ConeTreeItem& item, Visits& visits) {
                const IsotropicCone cone = cone_of(sources[item.index], g);
                return is_dominated(cone, factor * cone.length, visits);
            });
        for (std::size_t i = 0; i < part.size(); ++i) {
            if (covered[i] == 0) kept.push_back(part[i]);
        }
    }
    if (static_cast<double>(kept.size()) > share_worth_it * static_cast<double>(items.size())) {
        tree_ = std::move(of_all);
        return false;
    }
    items = std::move(kept);
    build(items, sources, g);
    return true;
}

void IsotropicCones::build(std::span<ConeTreeItem> items, const SourceColumns& sources, double g) {
    const auto make_leaf = [&](std::span<const ConeTreeItem> of_leaf, Leaf& leaf) {
        Eigen::Index lane = 0;
        for (const ConeTreeItem& item : of_leaf) leaf.set(lane++, cone_of(sources[item.index], g));
    };
    // Lanes without a source or a child have infinite lengths.
    const auto least_slope = [&](std::uint32_t number) -> double {
        const auto least = [](const auto& of) {
            return (of.length < infinity).select(of.slope, infinity).minCoeff();
        };
        return tree_.is_leaf(number) ? least(tree_.leaf(number)) : least(tree_.node(number));
    };
    const auto make_node = [&](std::span<const Tree::Child> children, Node& node, std::uint32_t) {
        for (std::size_t i = 0; i < children.size(); ++i) {
            const auto& [number, of_child] = children[i];
            if (of_child.empty()) continue;
            const auto lane = static_cast<Eigen::Index>(i);
            const Cylinder cylinder(of_child);
            node.centre.set(lane, cylinder.centre);
            node.normal.set(lane, cylinder.normal);
            node.half_thickness[lane] = cylinder.half_thickness;
            node.radius[lane] = cylinder.radius;
            node.length[lane] = tree_.is_leaf(number) ? tree_.leaf(number).length.minCoeff()
                                                      : tree_.node(number).length.minCoeff();
            node.slope[lane] = least_slope(number);
        }
    };
    tree_.build(items, leaf_size, make_leaf, make_node);
}

}  // namespace controlspace
