#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "controlspace/gradation/grade.h"
#include "controlspace/io/read_surface_sources.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/sources/scattered_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "study/field_choice.h"

namespace controlspace {

/// Where a study's sources come from.
enum class SourcesKind { sphere, planes, file, none };

/// What δ_R is measured against.
enum class ReferenceKind {
    /// Intersection of all sources' cones (paper §5.2) and, taken as it stands, of the field.
    exact,
    published_sphere,  ///< the analytic field behind the paper's Table 4; spheres only
};

/// What the control nodes of a graded structure hold.
enum class NodeValues {
    graded,  ///< what gradation made of them
    exact,   ///< the reference at their places: what is left is the error of interpolation alone
};

/// Whether a structure is made compact, and only read, once it is finished (ControlSpace::freeze).
enum class Frozen { no, doubles, floats };

/// What is taken out of a file of sources that holds more than one thing, or no lengths.
struct FileSources {
    std::string array = {};         ///< .vtu, .vtp, .msh, .pos; empty: the only one
    CurvatureSizes curvature = {};  ///< .stl, .obj, .ply, .off

    bool operator==(const FileSources&) const = default;
};

/// The sources of one case: a sampled surface (paper §5.1), a file, an analytic field, or such a
/// field with sources on top.
struct SourcesChoice {
    SourcesKind kind = SourcesKind::sphere;
    std::filesystem::path file;  ///< file only
    Sampling sampling = Sampling::regular;
    Point centre = Point::Zero();  ///< sphere only
    double radius = 0.8;           ///< sphere only
    double slope = 0;              ///< planes only: a of the second plane (u, -0.2 + a u, v)
    double h = 0.015;              ///< length that the sampling starts from
    double rho = 1;                ///< spacing of the samples in units of h
    double s_a = 2;                ///< tangential length in units of h
    double s_n = 1;                ///< normal length in units of the tangential one
    FieldChoice field = {};
    VdbSurface surface = {};   ///< file only, a .vdb
    FileSources in_file = {};  ///< file only, of other formats

    bool operator==(const SourcesChoice&) const = default;
};

/// One structure under one setting: what a row of a study is the result of.
struct Case {
    std::string structure = "K_L";        ///< id in the catalogue
    std::optional<SplitRule> split = {};  ///< kd-trees only
    SourcesChoice sources = {};
    double tau = 1;        ///< l_min: longest edge of a source's leaf, in the source's metric
    double epsilon = 0.2;  ///< ε_δ of insertion
    double g_r = 1.25;     ///< gradation ratio
    std::optional<int> max_depth = {};        ///< trees only
    std::optional<double> voxel = {};         ///< grids only; none: by tau and the sources
    std::optional<double> voxel_factor = {};  ///< grids in levels only
    std::optional<double> prune_delta = {};   ///< OpenVDB only; none: nothing is pruned
    /// Trees only: adapted to this δ in place of insertion and gradation; none: they are not.
    std::optional<double> target_delta = {};
    /// Grids only: δ_R, or memory [MB], that voxels are chosen for (study/equal_setting.h).
    std::optional<double> equal_delta = {};
    std::optional<double> equal_memory = {};
    NodeValues node_values = NodeValues::graded;  ///< structures that hold metrics only
    Frozen frozen = Frozen::no;                   ///< the paper's trees only
    GradationLaw law = GradationLaw::cone;
    GradationSchedule schedule = GradationSchedule::queue;
    Neighbourhood neighbourhood = Neighbourhood::faces;  ///< structures that hold metrics only
    ReferenceKind reference = ReferenceKind::exact;

    bool operator==(const Case&) const = default;
};

/// Whether the sources are sampled, so that rho, s_a and s_n mean something.
inline bool is_sampled(const SourcesChoice& s) {
    return s.kind == SourcesKind::sphere || s.kind == SourcesKind::planes;
}

/// Whether there is an analytic field: structures follow it and the sources together.
inline bool has_field(const SourcesChoice& s) { return s.field.kind != FieldKind::none; }

/// As in options and study files: "sphere", "none", "folder/file.csv".
std::string sources_name(const SourcesChoice& s);

/// The structure's id and what is its own among the settings, where that is not the default:
/// "K_oV", "K_oV, all neighbours", "openvdb-levels-nearest, c 0.5".
std::string variant_label(const Case& c);

/// The same with the split rule: "K_L s_L", "K_L s_L, all neighbours".
std::string structure_label(const Case& c);

/// What rows of one table share: "rho 1, s_a 2, s_n 1, tau 0.5, epsilon 0.2, g_r 1.25; cone law,
/// queue, exact reference", with "field ugawg-linear, " or "poisson sources, " first.
std::string setting_label(const Case& c);

/// What is asked for, however it is answered: the setting without tau, epsilon and schedule.
std::string work_label(const Case& c);

}  // namespace controlspace
