// SPDX-License-Identifier: Apache-2.0
#include "io/surface/smooth_patches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace controlspace {
namespace {

// Corner k of triangle t has the number 3 t + k, and so has the side from there to the next corner.
using Corner = std::uint32_t;
constexpr Corner none = ~Corner{};

constexpr Corner next(Corner c) { return c % 3 == 2 ? c - 2 : c + 1; }

/// The sides of triangles, and those that two share. A side's partner is the other triangle's.
class Sides {
public:
    Sides(const SurfaceMesh& mesh, const std::vector<Vector>& normals)
        : mesh_(mesh), normals_(normals), partner_(3 * mesh.triangles.size(), none) {
        std::vector<std::array<std::uint32_t, 3>> all;
        for (Corner c = 0; c < partner_.size(); ++c) {
            all.push_back(
                {std::min(vertex(c), vertex(next(c))), std::max(vertex(c), vertex(next(c))), c});
        }
        std::sort(all.begin(), all.end());
        const auto same = [](const auto& a, const auto& b) { return a[0] == b[0] && a[1] == b[1]; };
        for (auto side = all.begin(); side != all.end();) {
            const auto end =
                std::find_if(side, all.end(), [&](const auto& s) { return !same(s, *side); });
            if (end - side == 2) {
                partner_[side[0][2]] = side[1][2];
                partner_[side[1][2]] = side[0][2];
            }
            side = end;
        }
    }

    std::size_t size() const { return partner_.size(); }
    Corner partner(Corner side) const { return partner_[side]; }
    std::uint32_t vertex(Corner c) const { return mesh_.triangles[c / 3][c % 3]; }
    const Point& point(Corner c) const { return mesh_.vertices[vertex(c)]; }
    const SurfaceMesh& mesh() const { return mesh_; }
    double length(Corner side) const { return (point(next(side)) - point(side)).norm(); }

    /// Whether the triangles on both sides turn the same way.
    bool agree(Corner side) const { return vertex(side) != vertex(partner_[side]); }

    /// Angle between the normals on both sides, whatever their orientation.
    double turn(Corner side) const {
        const Vector& a = normals_[side / 3];
        const Vector b = (agree(side) ? 1 : -1) * normals_[partner_[side] / 3];
        return std::atan2(a.cross(b).norm(), a.dot(b));
    }

    void separate(Corner side) { partner_[std::exchange(partner_[side], none)] = none; }

private:
    const SurfaceMesh& mesh_;
    const std::vector<Vector>& normals_;
    std::vector<Corner> partner_;
};

/// Twice the area of a triangle.
double doubled_area(const Sides& sides, Corner c) {
    const Point& a = sides.point(c);
    return (sides.point(next(c)) - a).cross(sides.point(next(next(c))) - a).norm();
}

/// By how much round-off of the vertices may tilt a triangle.
double tilt_by_rounding(const Sides& sides, std::uint32_t t) {
    const Corner c = 3 * t;
    const double longest = std::max({sides.length(c), sides.length(c + 1), sides.length(c + 2)});
    return rounding(sides.mesh()) * longest / doubled_area(sides, c);
}

/// Whether a triangle has an angle of more than 150 degrees.
bool is_cap(const Sides& sides, std::uint32_t t) {
    static const double widest = -std::cos(std::numbers::pi / 6);
    for (Corner c = 3 * t; c < 3 * t + 3; ++c) {
        const Vector a = sides.point(next(c)) - sides.point(c);
        const Vector b = sides.point(next(next(c))) - sides.point(c);
        if (a.dot(b) < widest * a.norm() * b.norm()) return true;
    }
    return false;
}

/// Normals, of which those of caps are a neighbour's: three vertices nearly on a line hardly say
/// how the surface is tilted, and would make creases of smooth edges. Of the neighbours the one
/// that turns least is taken: the longest side is often an edge of the part. Caps in the plane of
/// other caps keep their own, and so do those that turn away from neighbours that are apart, too.
std::vector<Vector> without_caps(const Sides& sides, const std::vector<Vector>& normals,
                                 double crease) {
    constexpr double least = 1e-3;
    std::vector<char> caps(normals.size());
    for (std::uint32_t t = 0; t < caps.size(); ++t) caps[t] = is_cap(sides, t);
    std::vector<Vector> result = normals;
    for (std::uint32_t t = 0; t < normals.size(); ++t) {
        if (!caps[t]) continue;
        bool is_plane = false;
        std::vector<std::pair<double, Vector>> around;  // turns and normals of neighbours
        for (Corner side = 3 * t; side < 3 * t + 3; ++side) {
            if (sides.partner(side) == none) continue;
            const std::uint32_t other = sides.partner(side) / 3;
            const double turn = sides.turn(side);
            if (caps[other]) {
                is_plane |= turn < least + 4 * (tilt_by_rounding(sides, t) +
                                                tilt_by_rounding(sides, other));
            } else {
                around.emplace_back(turn, (sides.agree(side) ? 1 : -1) * normals[other]);
            }
        }
        if (around.empty() || is_plane) continue;
        const auto& [turn, nearest] = *std::ranges::min_element(
            around, {}, [](const auto& neighbour) { return neighbour.first; });
        const auto goes_on = std::ranges::count_if(around, [&](const auto& neighbour) {
            return neighbour.second.dot(nearest) >= std::cos(crease);
        });
        if (turn <= crease || around.size() == 1 || goes_on > 1) result[t] = nearest;
    }
    return result;
}

/// Separates triangles at creases, whose triangles are added to `creases`; what the others say of
/// their triangles.
std::vector<double> separate_at_creases(Sides& sides, double crease,
                                        std::vector<std::array<std::uint32_t, 2>>& creases) {
    constexpr double rounding = 1e-6;
    std::vector<double> bends(sides.size() / 3, 0.0);
    for (Corner side = 0; side < sides.size(); ++side) {
        if (sides.partner(side) == none) continue;
        const double turn = sides.turn(side);
        if (turn > crease + rounding) {
            creases.push_back({side / 3, sides.partner(side) / 3});
            sides.separate(side);
        } else {
            double& bend = bends[side / 3];
            bend = std::max(bend, turn * sides.length(side) / doubled_area(sides, side));
        }
    }
    return bends;
}

/// Turns normals so that those on both sides of a smooth edge are on the same side of the surface;
/// the patch of each triangle, by its first one.
std::vector<std::uint32_t> orient(const Sides& sides, std::vector<Vector>& normals) {
    std::vector<double> sign(normals.size(), 0);
    std::vector<std::uint32_t> patch_of(normals.size());
    std::vector<std::uint32_t> reached;
    for (std::uint32_t seed = 0; seed < normals.size(); ++seed) {
        if (sign[seed] != 0) continue;
        sign[seed] = 1;
        reached.assign(1, seed);
        while (!reached.empty()) {
            const std::uint32_t t = reached.back();
            reached.pop_back();
            patch_of[t] = seed;
            for (Corner side = 3 * t; side < 3 * t + 3; ++side) {
                if (sides.partner(side) == none) continue;
                const std::uint32_t other = sides.partner(side) / 3;
                if (sign[other] != 0) continue;
                sign[other] = sides.agree(side) ? sign[t] : -sign[t];
                reached.push_back(other);
            }
        }
    }
    for (std::size_t t = 0; t < normals.size(); ++t) normals[t] *= sign[t];
    return patch_of;
}

std::array<std::uint32_t, 2> in_order(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

/// For each corner the first of its fan.
std::vector<Corner> first_corners(const Sides& sides) {
    std::vector<Corner> first(sides.size());
    std::iota(first.begin(), first.end(), 0);
    const auto root = [&](Corner c) {
        while (first[c] != c) c = first[c] = first[first[c]];
        return c;
    };
    const auto unite = [&](Corner a, Corner b) {
        a = root(a);
        b = root(b);
        first[std::max(a, b)] = std::min(a, b);
    };
    for (Corner side = 0; side < sides.size(); ++side) {
        const Corner partner = sides.partner(side);
        if (partner == none || partner < side) continue;
        unite(side, sides.agree(side) ? next(partner) : partner);
        unite(next(side), sides.agree(side) ? partner : next(partner));
    }
    for (Corner c = 0; c < first.size(); ++c) first[c] = root(c);
    return first;
}

void add_fans(const Sides& sides, double crease, SmoothPatches& patches) {
    const std::vector<Corner> first = first_corners(sides);
    std::vector<std::uint32_t> fan_of(sides.size());
    std::vector<double> weights;
    for (Corner c = 0; c < sides.size(); ++c) {
        if (first[c] == c) {
            fan_of[c] = static_cast<std::uint32_t>(patches.fans.size());
            patches.fans.push_back({.vertex = sides.vertex(c), .triangles = {}});
            weights.push_back(0);
        }
        const std::uint32_t i = fan_of[c] = fan_of[first[c]], t = c / 3;
        const Corner previous = next(next(c));
        const double lengths = sides.length(c) * sides.length(previous);
        const double weight = doubled_area(sides, c) / (lengths * lengths);
        Fan& fan = patches.fans[i];
        fan.triangles.push_back(t);
        fan.normal += weight * patches.normals[t];
        weights[i] += weight;
        patches.fan_of[t][c % 3] = i;
        if (sides.partner(c) == none || sides.partner(previous) == none) fan.closed = false;
    }
    const double least = std::max(std::cos(crease), 0.1);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        Vector& normal = patches.fans[i].normal;
        patches.fans[i].apex = !(normal.stableNorm() >= least * weights[i]);
        normal.stableNormalize();
    }
}

}  // namespace

std::vector<Vector> triangle_normals(const SurfaceMesh& mesh) {
    std::vector<Vector> normals;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Point& p = mesh.vertices[a];
        normals.push_back((mesh.vertices[b] - p).cross(mesh.vertices[c] - p).stableNormalized());
    }
    return normals;
}

bool SmoothPatches::meet(std::size_t t, std::size_t other) const {
    return std::ranges::binary_search(meeting, in_order(patch_of[t], patch_of[other]));
}

SmoothPatches smooth_patches(const SurfaceMesh& mesh, double crease) {
    SmoothPatches patches;
    patches.normals = triangle_normals(mesh);
    patches.fan_of.resize(mesh.triangles.size());
    Sides sides(mesh, patches.normals);
    patches.normals = without_caps(sides, patches.normals, crease);
    patches.bends = separate_at_creases(sides, crease, patches.meeting);
    patches.patch_of = orient(sides, patches.normals);
    for (auto& crease_of : patches.meeting) {
        const auto& [t, other] = crease_of;
        crease_of = in_order(patches.patch_of[t], patches.patch_of[other]);
    }
    std::erase_if(patches.meeting, [](const auto& pair) { return pair[0] == pair[1]; });
    std::ranges::sort(patches.meeting);
    add_fans(sides, crease, patches);
    return patches;
}

}  // namespace controlspace
