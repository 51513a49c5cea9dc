// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "editable_space.h"

namespace controlspace {

/// Of the whole catalogue, what passes the filter. Kd-trees cut in the middle here (s_L): the other
/// rules move cuts and nothing else, and random scenes draw them (scenes/scenes_test.cpp).
template <class Filter>
std::vector<CatalogueEntry> structures_that(const Filter& filter) {
    std::vector<CatalogueEntry> found;
    for (const CatalogueEntry& entry : structures()) {
        if (filter(entry)) found.push_back(entry);
    }
    return found;
}

// Filters of structures.
inline bool every_structure(const CatalogueEntry&) { return true; }
/// Those that round promise less.
inline bool does_not_round(const CatalogueEntry& structure) { return !is_rounding(structure); }
/// Structures that hold metrics, and those whose every answer is the exact field anyway.
inline bool keeps_node_values(const CatalogueEntry& structure) {
    return does_not_round(structure) && keeps_values(structure);
}
/// Not the exact field itself.
inline bool stores_a_field(const CatalogueEntry& structure) {
    return does_not_round(structure) && !is_direct(structure);
}
inline bool stores_node_values(const CatalogueEntry& structure) {
    return keeps_node_values(structure) && !is_direct(structure);
}
inline bool keeps_sources_in_leaves(const CatalogueEntry& structure) {
    return !keeps_values(structure);
}
inline bool has_compact_form(const CatalogueEntry& structure) {
    return structure.has<CompactForm>();
}

/// Sources few enough to test many structures on them.
struct Work {
    std::string name;
    std::vector<PointSource> sources;
    Box domain{Point(-1, -1, -1), Point(1, 1, 1)};

    bool isotropic() const {
        return std::all_of(sources.begin(), sources.end(),
                           [](const PointSource& s) { return is_isotropic(s.metric); });
    }
    SpaceOptions options() const {
        // Deep enough that no tree is stopped by the depth.
        return {.domain = domain, .kd_depth = 200, .finest_length = finest_length(sources)};
    }
    std::unique_ptr<EditableSpace> inserted(const CatalogueEntry& structure) const {
        auto space = editable(structure.make(options()));
        space->insert(sources);
        return space;
    }
    std::unique_ptr<EditableSpace> graded(const CatalogueEntry& structure,
                                          const GradationOptions& gradation = {}) const {
        auto space = inserted(structure);
        space->grade(gradation);
        return space;
    }
};

/// The cones of all isotropic sources, with g_r = 1.25, one by one.
inline double exact_length(const Work& work, const Point& x) {
    double h = work.domain.half_diagonal();
    for (const PointSource& s : work.sources) {
        h = std::min(h, s.metric.xx + 0.25 * (x - s.position).norm());
    }
    return h;
}

inline Work isotropic_sphere() {
    return {"isotropic", sample_sphere({.h = 0.05, .s_a = 2, .s_n = 1, .rho = 2})};
}
inline Work anisotropic_sphere() {
    return {"anisotropic", sample_sphere({.h = 0.1, .s_a = 4, .s_n = 0.25, .rho = 2})};
}
/// An oblong box far from the origin, none of its edges a multiple of another: sources without any
/// symmetry on a tilted patch of a paraboloid near one end, and a few that are coarser at the
/// other.
inline Work oblong_box() {
    Work work{"oblong", {}, {Point(1000, -300, 57), Point(1003.7, -298.9, 57.83)}};
    const auto place = [&](double x, double y, double z) {
        return Point(work.domain.low + Vector(x, y, z));
    };
    for (int i = 0; i < 24; ++i) {
        for (int j = 0; j < 18; ++j) {
            const double u = 0.041 * i, v = 0.053 * j;
            const double h = 0.06 + 0.03 * u + 0.02 * v * v;
            work.sources.push_back(
                {place(0.31 + u, 0.07 + v, 0.2 + 0.3 * u + 0.2 * v * v), Metric::isotropic(h)});
        }
    }
    work.sources.push_back({place(3.1, 0.2, 0.7), Metric::isotropic(0.11)});
    work.sources.push_back({place(3.6, 1.05, 0.03), Metric::isotropic(0.23)});
    return work;
}
/// A plane across the y axis, with sources along a curve in it and a few coarser ones.
inline Work flat_box() {
    Work work{"flat", {}, {Point(-1, 0.3, 2), Point(1.5, 0.3, 3.7)}};
    for (int i = 0; i < 120; ++i) {
        const double t = i / 120.0;
        work.sources.push_back({Point(-0.8 + 2 * t, 0.3, 2.7 + 0.6 * std::sin(5 * t)),
                                Metric::isotropic(0.04 + 0.05 * t)});
    }
    work.sources.push_back({Point(1.3, 0.3, 2.1), Metric::isotropic(0.17)});
    return work;
}
/// The same with tensors, turned and 1:4 thin.
inline Work anisotropic_flat_box() {
    Work work = flat_box();
    work.name = "anisotropic flat";
    for (std::size_t i = 0; i < work.sources.size(); ++i) {
        const double h = work.sources[i].metric.xx;
        const Eigen::Matrix3d frame =
            Eigen::AngleAxisd(0.01 * static_cast<double>(i), Vector::UnitY()).toRotationMatrix();
        work.sources[i].metric = metric_from_frame({h, 2 * h, 4 * h}, frame);
    }
    return work;
}
/// Sources along a line through a box with these edges, away from the origin.
inline Work thin_box(const Vector& edges) {
    Work work{"thin", {}, {Point(3, -1, 0.5), Point(3, -1, 0.5) + edges}};
    const double longest = edges.maxCoeff();
    for (int i = 0; i < 40; ++i) {
        const double t = (i + 0.5) / 40;
        work.sources.push_back(
            {work.domain.low + Vector(t, 0.2 + 0.5 * t * t, 0.4).cwiseProduct(edges),
             Metric::isotropic(longest * (0.01 + 0.02 * t))});
    }
    return work;
}
/// The same with tensors, turned and up to 1:4 thin.
inline Work anisotropic_oblong_box() {
    Work work = oblong_box();
    work.name = "anisotropic oblong";
    for (std::size_t i = 0; i < work.sources.size(); ++i) {
        const double h = work.sources[i].metric.xx, angle = 0.05 * static_cast<double>(i % 7);
        const Eigen::Matrix3d frame = (Eigen::AngleAxisd(0.4 + angle, Vector::UnitX()) *
                                       Eigen::AngleAxisd(0.7 - angle, Vector::UnitZ()))
                                          .toRotationMatrix();
        work.sources[i].metric = metric_from_frame({h, 2 * h, 4 * h}, frame);
    }
    return work;
}
/// The same work, two of three sources with gradation ratios of their own.
inline Work with_own_growths(Work work) {
    work.name += ", ratios of their own";
    for (std::size_t i = 0; i < work.sources.size(); ++i) {
        constexpr std::array growths{0.0, 1.05, 1.8};
        work.sources[i].growth = growths[i % 3];
    }
    return work;
}

}  // namespace controlspace
