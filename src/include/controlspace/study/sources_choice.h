// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "controlspace/fields/analytic_field.h"
#include "controlspace/fields/primitives.h"
#include "controlspace/fields/surface_fields.h"
#include "controlspace/io/read_surface_sources.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/sources/scattered_surfaces.h"
#include "controlspace/words.h"

namespace controlspace {

/// Where the sources of a study come from.
enum class SourcesKind { sphere, planes, file, none };

/// The analytic field of a case, beside its point sources.
enum class FieldKind { none, sphere, planes, ugawg_linear, ugawg_polar_1, ugawg_polar_2, file };

/// An analytic field and its parameters (see fields/), or a .vdb file.
struct FieldChoice {
    FieldKind kind = FieldKind::none;
    Point centre = Point::Zero();  ///< sphere only
    double radius = 0.8;           ///< sphere only
    double slope = 0;              ///< planes only
    SurfaceLengths lengths = {};   ///< sphere and planes only
    std::filesystem::path file;    ///< file only, a .vdb
    VdbLengths vdb;                ///< file only

    bool operator==(const FieldChoice&) const = default;
};

enum class LengthUnit { um, mm, cm, m, km, in, ft };

/// How many millimetres it has.
double millimetres(LengthUnit unit);

/// The part of a file of sources to be read, or lengths for a file without any.
struct FileSources {
    double scale = 1;                     ///< of coordinates and lengths in files of all formats
    std::optional<LengthUnit> unit = {};  ///< that CAD files are converted into; none: millimetres
    std::string array = {};               ///< .vtu, .vtp, .vti, .msh, .pos; empty: the only one
    std::optional<std::uint64_t> step = {};  ///< in time, of the same but .vtk; none: the last
    CurvatureSizes curvature = {};           ///< .stl, .obj, .ply, .off

    bool operator==(const FileSources&) const = default;
};

/// The sources of one case: a sampled surface (paper §5.1), a file, an analytic field, or such a
/// field with sources on top.
struct SourcesChoice {
    SourcesKind kind = SourcesKind::sphere;
    std::vector<std::filesystem::path> files = {};  ///< file only, the sources of all together
    Sampling sampling = Sampling::regular;
    Point centre = Point::Zero();  ///< sphere only
    double radius = 0.8;           ///< sphere only
    double slope = 0;              ///< planes only: a of the second plane (u, -0.2 + a u, v)
    double h = 0.015;              ///< length that the sampling starts from
    double rho = 1;                ///< spacing of the samples in units of h
    double s_a = 2;                ///< tangential length in units of h
    double s_n = 1;                ///< normal length in units of the tangential one
    FieldChoice field = {};
    std::vector<Primitive> primitives = {};  ///< beside these sources
    double primitives_ratio = 1.25;    ///< of those without a growth of their own: g_r of the case
    double h_min = 0;                  ///< shorter requested lengths are this long
    double h_max = largest_magnitude;  ///< no length of a structure is longer
    VdbSurface surface = {};           ///< file only, a .vdb
    FileSources in_file = {};          ///< file only, of other formats

    bool operator==(const SourcesChoice&) const = default;
};

/// Whether the sources are sampled, so that h, rho, s_a and s_n apply.
inline bool is_sampled(const SourcesChoice& s) {
    return s.kind == SourcesKind::sphere || s.kind == SourcesKind::planes;
}

/// Whether there is a continuous field, analytic or of primitives: structures follow it and the
/// sources together.
inline bool has_field(const SourcesChoice& s) {
    return s.field.kind != FieldKind::none || !s.primitives.empty();
}

/// The files of sources, and those of primitives and of a field.
std::vector<std::filesystem::path> input_files_of(const SourcesChoice& s);

/// As in options and study files: "sphere", "none", or "folder/a.csv", "ball:0,0,0,r=1,h=0.1".
std::vector<std::string> source_names(const SourcesChoice& s);
/// The same between commas.
std::string sources_name(const SourcesChoice& s);

/// The field of a formula. Throws InputError for parameters out of range. Precondition:
/// `choice.kind` is neither `none` nor `file`.
AnalyticField make_field(const FieldChoice& choice);

/// Of `--sources`, beside names of files and primitives.
template <>
struct Words<SourcesKind> {
    static constexpr Word<SourcesKind> table[] = {{SourcesKind::sphere, "sphere", "sampled"},
                                                  {SourcesKind::planes, "planes", "sampled"},
                                                  {SourcesKind::none, "none", "only a field"}};
};
template <>
struct Words<LengthUnit> {
    static constexpr Word<LengthUnit> table[] = {
        {LengthUnit::um, "um", "micrometres"}, {LengthUnit::mm, "mm", "millimetres"},
        {LengthUnit::cm, "cm", "centimetres"}, {LengthUnit::m, "m", "metres"},
        {LengthUnit::km, "km", "kilometres"},  {LengthUnit::in, "in", "inches"},
        {LengthUnit::ft, "ft", "feet"}};
};
template <>
struct Words<Sampling> {
    static constexpr Word<Sampling> table[] = {
        {Sampling::regular, "regular", "in rows, as in the paper"},
        {Sampling::random, "random", "each anywhere on the surface"},
        {Sampling::clustered, "clustered", "around a few places on the surface, nearly normal"},
        {Sampling::poisson, "poisson", "anywhere, but no two nearer than h rho"}};
};
template <>
struct Words<FieldKind> {
    static constexpr Word<FieldKind> table[] = {
        {FieldKind::none, "none", "sources alone"},
        {FieldKind::sphere, "sphere", "lengths across and along a sphere, growing with distance"},
        {FieldKind::planes, "planes", "the same for two planes that cross"},
        {FieldKind::ugawg_linear, "ugawg-linear", "UGAWG's benchmark: a layer at z = 0.5, 100:1"},
        {FieldKind::ugawg_polar_1, "ugawg-polar-1", "a layer at r = 0.5 around the z axis, 100:1"},
        {FieldKind::ugawg_polar_2, "ugawg-polar-2", "the same, shorter along the arc too"},
        {FieldKind::file, "file", "the grids of the .vdb field_file"}};
};

}  // namespace controlspace
