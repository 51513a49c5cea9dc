// Lengths at many places near to each other: their cones are found once, and every one of them is
// evaluated at every place.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "cones/cone_cover.h"
#include "cones/isotropic_cones.h"
#include "controlspace/metric/metric.h"
#include "vector_clones.h"

namespace controlspace {

namespace {

constexpr std::size_t group = 64;  // places at once
constexpr double infinity = std::numeric_limits<double>::infinity();
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

double exact_length(const IsotropicCone& cone, const Point& p) {
    const Metric m = Metric::isotropic(cone.length);
    return (1 + cone.slope * metric_length(m, p - cone.position)) * cone.length;
}

}  // namespace

// All but those that the cone which is the smallest at the centre covers, beyond rounding.
template <class Add>
bool IsotropicCones::visit_uncovered(const Box& box, Hint& hint, const Add& add) const {
    constexpr double never = std::numeric_limits<double>::infinity();
    constexpr double rounding = 256 * std::numeric_limits<double>::epsilon();
    const Point centre = box.centre();
    const double smallest = smallest_length(centre, hint);
    ConeCover cover;
    cover.reset(box, cap_, -rounding);
    if (smallest < cap_) {
        const Leaf& leaf = tree_.leaves()[hint];
        const IsotropicCone cone = leaf[lane_of(centre, smallest, hint)];
        cover.choose(0, cone);
        add(cone);
    }
    const auto bounds = [&](const Node& node) { return node.uncovered(cover, centre); };
    return tree_.search([] { return never; }, bounds,
                        [&](std::uint32_t number) {
                            const Leaf& leaf = tree_.leaf(number);
                            const auto covered = cover.covered(leaf);
                            for (Eigen::Index i = 0; i < leaf_size; ++i) {
                                if (!covered[i] && !add(leaf[i])) return false;
                            }
                            return true;
                        });
}

void IsotropicCones::smallest_lengths(std::span<const Point> x, std::span<double> lengths,
                                      Hint& hint) const {
    // Fewer places are searched for one by one; so are those among too many cones.
    constexpr std::size_t few = 4;
    constexpr std::size_t most_cones = 256;
    if (x.size() > group) {
        for (std::size_t begin = 0; begin < x.size(); begin += group) {
            const std::size_t count = std::min(group, x.size() - begin);
            smallest_lengths(x.subspan(begin, count), lengths.subspan(begin, count), hint);
        }
        return;
    }
    const auto one_by_one = [&] {
        for (std::size_t i = 0; i < x.size(); ++i) lengths[i] = smallest_length(x[i], hint);
    };
    if (x.size() <= few) return one_by_one();

    Point low = x.front();
    Point high = low;
    for (const Point& p : x) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    std::array<IsotropicCone, most_cones> cones;
    std::size_t count = 0;
    const auto add = [&](const IsotropicCone& cone) {
        if (count == cones.size()) return false;
        cones[count++] = cone;
        return true;
    };
    if (!visit_uncovered({low, high}, hint, add)) {
        const std::size_t half = x.size() / 2;
        smallest_lengths(x.first(half), lengths.first(half), hint);
        return smallest_lengths(x.subspan(half), lengths.subspan(half), hint);
    }

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
                smallest, exact_length(cones[static_cast<std::size_t>(least.number[i])], x[i]));
        } else {
            for (const IsotropicCone& cone : std::span(cones).first(count)) {
                if (cone.length_at(x[i]) > doubtful) continue;
                smallest = std::min(smallest, exact_length(cone, x[i]));
            }
        }
        lengths[i] = smallest;
    }
}

}  // namespace controlspace
