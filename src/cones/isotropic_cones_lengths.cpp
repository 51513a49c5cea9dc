// What a box needs: the cones that are the smallest in it, found once. Lengths at many places near
// to each other are those of all of these at every place.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "cones/cone_cover.h"
#include "cones/isotropic_cones.h"
#include "geometry/extent_of.h"
#include "vector_clones.h"

namespace controlspace {

namespace {

constexpr std::size_t group = 64;  // places at once
constexpr double infinity = std::numeric_limits<double>::infinity();
// Of lengths, as a fraction: a cone that is longer than another by more is not the smallest.
constexpr double beyond_rounding = 256 * std::numeric_limits<double>::epsilon();
using Numbers = std::array<double, group>;

struct Places {
    Numbers x, y, z;
};

/// For each place the two smallest lengths of the cones, up to rounding, and the number of the
/// first one. All loops are over places, so that they become vectors whatever their width.
struct Least {
    Numbers first, second, number;
};

CONTROLSPACE_VECTOR_CLONES
void find_least(const IsotropicCone* __restrict cones, std::size_t count,
                const Places& __restrict places, Least& __restrict least) {
    least.first.fill(infinity);
    least.second.fill(infinity);
    least.number.fill(0);
    for (std::size_t c = 0; c < count; ++c) {
        const double qx = cones[c].position.x();
        const double qy = cones[c].position.y();
        const double qz = cones[c].position.z();
        const double h = cones[c].length;
        const double slope = cones[c].slope;
        const auto number = static_cast<double>(c);
        for (std::size_t i = 0; i < group; ++i) {
            const double x = places.x[i] - qx;
            const double y = places.y[i] - qy;
            const double z = places.z[i] - qz;
            const double length = h + slope * std::sqrt(x * x + y * y + z * z);
            const double first = least.first[i];
            const double second = least.second[i];
            const bool is_less = length < first;
            const double above = is_less ? first : length;
            least.first[i] = is_less ? length : first;
            least.second[i] = above < second ? above : second;
            least.number[i] = is_less ? number : least.number[i];
        }
    }
}

}  // namespace

std::optional<IsotropicCone> IsotropicCones::cover_by_one(const Box& box, double tolerance,
                                                          ConeCover& cover, Hint& hint) const {
    const Point centre = box.centre();
    const double smallest = smallest_length(centre, hint);
    cover.reset(box, cap_, tolerance);
    if (!(smallest < cap_)) return std::nullopt;
    const Eigen::Index lane = lane_of(centre, smallest, hint);
    const IsotropicCone cone = tree_.leaves()[hint][lane];
    cover.choose(source_in(hint, lane), cone);
    return cone;
}

template <class Add>
bool IsotropicCones::add_uncovered(std::uint32_t number, const ConeCover& cover,
                                   const Add& add) const {
    const Leaf& leaf = tree_.leaf(number);
    const auto covered = cover.covered(leaf);
    for (Eigen::Index i = 0; i < leaf_size; ++i) {
        if (!covered[i] && !add(source_in(tree_.leaf_number(number), i), leaf[i])) return false;
    }
    return true;
}

template <class Add>
bool IsotropicCones::add_all_uncovered(const Point& centre, const ConeCover& cover,
                                       const Add& add) const {
    return tree_.search([] { return infinity; },
                        [&](const Node& node) { return node.uncovered(cover, centre); },
                        [&](std::uint32_t number) { return add_uncovered(number, cover, add); });
}

bool IsotropicCones::cover(const Box& box, double tolerance, ConeCover& cover, Hint& hint) const {
    cover_by_one(box, tolerance, cover, hint);
    return add_all_uncovered(box.centre(), cover,
                             [&](std::uint32_t source, const IsotropicCone& cone) {
                                 return cover.give(source, cone);
                             }) &&
           cover.complete();
}

// With R half the diagonal of a box, the cone that is the smallest at its centre is longer by (g-1)
// R at most at any place in it: what is above that at all places is nowhere the smallest.
bool IsotropicCones::gather(const Box& box, ConeList& nearby, Hint& hint) const {
    constexpr int most_leaves = 32;
    nearby.clear();
    const Point p = box.centre();
    const double radius = box.half_diagonal();
    ConeCover cover;
    double reach = cap_;
    if (const auto cone = cover_by_one(box, -beyond_rounding, cover, hint)) {
        nearby.add(*cone);
        reach = cone->exact_length_at(p) + cone->slope * radius;
    }
    const double beyond = std::nextafter(reach / (safely_ * safely_), infinity);
    int leaves = 0;
    return tree_.search([&] { return beyond; },
                        [&](const Node& node) { return lower_bounds(node, p, radius); },
                        [&](std::uint32_t number) {
                            const auto add = [&](std::uint32_t, const IsotropicCone& cone) {
                                nearby.add(cone);
                                return true;
                            };
                            return ++leaves <= most_leaves && add_uncovered(number, cover, add);
                        });
}

void IsotropicCones::smallest_lengths(std::span<const Point> x, std::span<double> lengths,
                                      Hint& hint) const {
    // How many places have few cones in common is learnt from those before; else one by one.
    constexpr std::size_t least = 8;
    constexpr int successes_to_grow = 4;
    std::size_t together = group;
    int successes = 0;
    for (std::size_t done = 0; done < x.size();) {
        std::size_t count = std::min(together, x.size() - done);
        if (count >= least && find_together(x.subspan(done, count), lengths.subspan(done), hint)) {
            if (++successes == successes_to_grow) {
                together = std::min(2 * together, group);
                successes = 0;
            }
        } else if (count >= 2 * least) {
            together = count / 2;
            successes = 0;
            continue;
        } else {
            count = std::min(group, x.size() - done);
            for (std::size_t i = done; i < done + count; ++i) {
                lengths[i] = smallest_length(x[i], hint);
            }
        }
        done += count;
    }
}

bool IsotropicCones::find_together(std::span<const Point> x, std::span<double> lengths,
                                   Hint& hint) const {
    constexpr std::size_t most_cones = 256;
    std::array<IsotropicCone, most_cones> cones;
    std::size_t count = 0;
    const Box box = extent_of(x);
    ConeCover cover;
    if (const auto cone = cover_by_one(box, -beyond_rounding, cover, hint)) cones[count++] = *cone;
    const auto add = [&](std::uint32_t, const IsotropicCone& cone) {
        if (count == cones.size()) return false;
        cones[count++] = cone;
        return true;
    };
    if (!add_all_uncovered(box.centre(), cover, add)) return false;

    Places places;
    for (std::size_t i = 0; i < group; ++i) {
        const Point& p = x[std::min(i, x.size() - 1)];
        places.x[i] = p.x();
        places.y[i] = p.y();
        places.z[i] = p.z();
    }
    Least least;
    find_least(cones.data(), count, places, least);
    for (std::size_t i = 0; i < x.size(); ++i) {
        double smallest = cap_;
        const double doubtful = least.first[i] / (safely_ * safely_);
        if (count > 0 && least.second[i] > doubtful) {
            smallest = std::min(
                smallest, cones[static_cast<std::size_t>(least.number[i])].exact_length_at(x[i]));
        } else {
            for (const IsotropicCone& cone : std::span(cones).first(count)) {
                if (cone.length_at(x[i]) > doubtful) continue;
                smallest = std::min(smallest, cone.exact_length_at(x[i]));
            }
        }
        lengths[i] = smallest;
    }
    return true;
}

}  // namespace controlspace
