// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "cones/isotropic_cones.h"

// A function that is trilinear in a box has its extrema at corners, and a convex one is nowhere in
// it larger than the trilinear function with its values at the corners (Jensen). Cones are convex:
// - lengths are nowhere longer than a multiple of a cone if they are not longer, at the corners,
//   than that multiple of one of the cone's tangents;
// - lengths are nowhere shorter than a fraction of the smallest cone if they are not shorter, at
//   the corners, than that fraction of one cone, or of a mean of two.
// Where that does not show it, the box is halved.

namespace controlspace {

std::optional<Doubt> IsotropicCones::doubt_of(const TrilinearLengths& lengths, double factor,
                                              Hint& hint) const {
    constexpr int most_parts = 4096;
    struct Part {
        TrilinearLengths lengths;
        bool may_be_long, may_be_short;
    };
    // Rounding: of what is allowed, and of places, by which cones and lengths vary.
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const Box& box = lengths.box;
    const double reach = std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()) +
                         box.half_diagonal();
    const double steepest = std::max(steepest_, lengths.slope());
    const double rounding =
        64 * epsilon * (1 + steepest * reach / *std::ranges::min_element(lengths.at));
    const double shown = 1 + (1 - 1e-9) * (factor - 1) - rounding;
    if (!(shown > 1)) return Doubt{box.centre(), false};
    std::vector<Part> parts{{lengths, true, true}};
    for (int looked_at = 1; !parts.empty(); ++looked_at) {
        Part part = parts.back();
        parts.pop_back();
        std::optional<Doubt> doubt;
        const auto check = [&](bool& may_be, const std::optional<Doubt>& found) {
            may_be = found.has_value();
            if (found && !(doubt && doubt->is_certain)) doubt = found;
        };
        if (part.may_be_long) check(part.may_be_long, doubt_of_long(part.lengths, shown));
        if (part.may_be_short) check(part.may_be_short, doubt_of_short(part.lengths, shown, hint));
        if (!doubt) continue;
        if (doubt->is_certain || looked_at >= most_parts) return doubt;
        const auto [low, high] = part.lengths.halves();
        parts.push_back({high, part.may_be_long, part.may_be_short});
        parts.push_back({low, part.may_be_long, part.may_be_short});
    }
    return std::nullopt;
}

std::optional<Doubt> IsotropicCones::doubt_of_long(const TrilinearLengths& lengths,
                                                   double factor) const {
    using Numbers = LanesOf<leaf_size>;
    const Box& box = lengths.box;
    const Point centre = box.centre();
    const double radius = box.half_diagonal();
    const auto at_longest = std::ranges::max_element(lengths.at);
    const double longest = *at_longest;
    if (longest > factor * cap_) {
        return Doubt{corner(box, static_cast<int>(at_longest - lengths.at.begin())), true};
    }
    const double slope = lengths.slope();
    std::optional<Doubt> doubt;
    tree_.search(
        [&] { return longest / factor; },
        [&](const Node& node) { return lower_bounds(node, centre, radius); },
        [&](std::uint32_t number) {
            const Leaf& leaf = tree_.leaf(number);
            // Tangents at the centre.
            const Numbers distances = leaf.distances(centre);
            const Numbers steepness = leaf.slope / distances.max(1e-150 * std::max(1.0, steepest_));
            const Numbers x = steepness * (centre.x() - leaf.position.x);
            const Numbers y = steepness * (centre.y() - leaf.position.y);
            const Numbers z = steepness * (centre.z() - leaf.position.z);
            const Numbers at_centre = leaf.length + leaf.slope * distances;
            Numbers least = Numbers::Constant(std::numeric_limits<double>::infinity());
            for (int c = 0; c < 8; ++c) {
                const Vector v = corner(box, c) - centre;
                const Numbers tangent = at_centre + x * v.x() + y * v.y() + z * v.z();
                least = least.min(factor * tangent - lengths.at[static_cast<std::size_t>(c)]);
            }
            for (Eigen::Index i = 0; i < leaf_size; ++i) {
                if (least[i] >= 0) continue;
                // The place of the box next to the source.
                const Point q = leaf.position[i];
                const Point nearest = nearest_in(box, q);
                const double own = lengths.at_place(nearest);
                if (own > factor * leaf[i].length_at(nearest)) {
                    doubt = {nearest, true};
                    return false;
                }
                // From there, lengths grow no faster than the multiple of the cone does.
                const bool is_flat = slope <= factor * leaf.slope[i];
                if (is_flat && own <= factor * leaf.length[i]) continue;
                doubt = {nearest, false};
            }
            return true;
        });
    return doubt;
}

std::optional<Doubt> IsotropicCones::doubt_of_short(const TrilinearLengths& lengths, double factor,
                                                    Hint& hint) const {
    std::array<double, 8> most;
    std::ranges::transform(lengths.at, most.begin(), [&](double t) { return factor * t; });
    if (*std::ranges::min_element(most) >= cap_) return std::nullopt;

    const Box& box = lengths.box;
    using Values = std::array<double, 8>;
    // At the corners, that of the cone which is the smallest at x.
    const auto smallest_cone = [&](const Point& x, Values& at_corners) {
        const double smallest = smallest_length(x, hint);
        at_corners.fill(cap_);
        if (!(smallest < cap_)) return;
        const IsotropicCone cone = tree_.leaves()[hint][lane_of(x, smallest, hint)];
        for (int c = 0; c < 8; ++c) {
            at_corners[static_cast<std::size_t>(c)] = cone.length_at(corner(box, c));
        }
    };
    Values first;
    smallest_cone(box.centre(), first);
    std::size_t worst = 0;
    for (std::size_t c = 1; c < 8; ++c) {
        if (first[c] - most[c] > first[worst] - most[worst]) worst = c;
    }
    if (first[worst] <= most[worst]) return std::nullopt;

    const Point where = corner(box, static_cast<int>(worst));
    Values second;
    smallest_cone(where, second);
    if (second[worst] > most[worst]) return Doubt{where, true};
    // Some share s of the second and 1 - s of the first.
    double least_share = 0, most_share = 1;
    for (std::size_t c = 0; c < 8; ++c) {
        const double gap = most[c] - first[c];
        const double rise = second[c] - first[c];
        if (rise < 0) {
            least_share = std::max(least_share, gap / rise);
        } else if (rise > 0) {
            most_share = std::min(most_share, gap / rise);
        } else if (gap < 0) {
            return Doubt{where, false};
        }
    }
    if (least_share <= most_share) return std::nullopt;
    return Doubt{where, false};
}

}  // namespace controlspace
