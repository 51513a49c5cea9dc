// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <functional>

#include "controlspace/geometry/extent.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/study/study.h"
#include "refuse.h"
#include "study/file_endings.h"
#include "study/member_of.h"
#include "study/sources_access.h"

namespace controlspace {
namespace {

// Members on the way to those of the members of a study.
constexpr auto sources = &Study::sources;
constexpr auto field = &SourcesChoice::field;
constexpr auto curvature = &FileSources::curvature;

/// A length of which 0 means that it is not given, as does `none`, which is stored then.
template <class Place>
Access<Study> length_or_none(Place place, double none = 0) {
    Access<Study> access;
    access.set = [=](Study& s, const Values& v) {
        const double x = v.front().number();
        std::invoke(place, s) = x == 0 ? none : positive(x);
    };
    access.get = [=](const Study& s) {
        const double x = std::invoke(place, s);
        return x == none ? Values{} : Values{Value(x)};
    };
    return access;
}
/// Several numbers at once; `what` they are is said where there are others.
template <class Set, class Get>
Access<Study> numbers(std::size_t count, const char* what, const Set& set, const Get& get) {
    return {.at_most = count,
            .set =
                [=](Study& s, const Values& v) {
                    if (v.size() != count) refuse("give {}", what);
                    set(s, [&](std::size_t i) { return v[i].number(); });
                },
            .get = get};
}

Access<Study> name() {
    Access<Study> access = text<Study>(&Study::name);
    access.set = [](Study& s, const Values& v) {
        const std::string& name = v.front().text();
        const auto unfit = [](char c) { return c == '/' || (c >= 0 && c < ' ') || c == 127; };
        if (name.empty() || std::any_of(name.begin(), name.end(), unfit)) {
            refuse("'{}' cannot name a folder: leave out '/' and control characters", name);
        }
        s.name = name;
    };
    return access;
}

Access<Study> domain() {
    return numbers(
        6, "six numbers: x0 x1 y0 y1 z0 z1",
        [](Study& s, const auto& x) {
            s.domain = require_extent({{x(0), x(2), x(4)}, {x(1), x(3), x(5)}});
        },
        [](const Study& s) -> Values {
            if (!s.domain) return {};
            const Point &a = s.domain->low, &b = s.domain->high;
            return {a.x(), b.x(), a.y(), b.y(), a.z(), b.z()};
        });
}

Access<Study> field_lengths() {
    return numbers(
        2, "two numbers: across along",
        [](Study& s, const auto& x) {
            s.sources.field.lengths.across = positive(x(0));
            s.sources.field.lengths.along = positive(x(1));
        },
        [](const Study& s) -> Values {
            return {s.sources.field.lengths.across, s.sources.field.lengths.along};
        });
}

Access<Study> field_largest() {
    Access<Study> access = number<Study>(
        of(sources, field, &FieldChoice::lengths, &SurfaceLengths::largest), positive);
    access.get = [get = access.get](const Study& s) {
        return s.sources.field.lengths.largest == SurfaceLengths{}.largest ? Values{} : get(s);
    };
    return access;
}

Access<Study> density_sizes() {
    Access<Study> access;
    access.at_most = 2;
    access.set = [](Study& s, const Values& v) {
        s.sources.field.vdb.density = {positive(v.front().number()), positive(v.back().number())};
    };
    access.get = [](const Study& s) -> Values {
        const auto& sizes = s.sources.field.vdb.density;
        return sizes ? Values{sizes->finest, sizes->coarsest} : Values{};
    };
    return access;
}

std::function<bool(const Study&)> of_kind(SourcesKind kind) {
    return [=](const Study& s) { return s.sources.kind == kind; };
}
/// Whether the sources are in a file of one of the formats.
std::function<bool(const Study&)> in_file(std::vector<std::string_view> endings) {
    return [=](const Study& s) {
        return s.sources.kind == SourcesKind::file &&
               std::ranges::any_of(s.sources.files, [&](const auto& file) {
                   return has_ending(endings, lower_case_extension(file));
               });
    };
}
/// Whether some run has one of the fields.
std::function<bool(const Study&)> field_is(std::vector<std::string> kinds) {
    return [=](const Study& s) {
        return std::ranges::any_of(s.runs, [&](const Run& run) {
            const Values* fields = run.find("field");
            return fields != nullptr && std::ranges::any_of(*fields, [&](const Value& kind) {
                       return std::ranges::count(kinds, kind.text()) > 0;
                   });
        });
    };
}

constexpr double exact_integers = 9007199254740992.0;  // 2^53: whole numbers pass through doubles
constexpr Use making = Use::making, reading = Use::reading;
constexpr Topic performance = Topic::performance, fields = Topic::fields, paper = Topic::paper;
constexpr const char* length = "length";

std::vector<Parameter<Study>> table() {
    const AppliesTo<Study> always;
    const AppliesTo<Study> sphere{"the sphere", of_kind(SourcesKind::sphere)};
    const AppliesTo<Study> planes{"the planes", of_kind(SourcesKind::planes)};
    const AppliesTo<Study> sampled{"sampled surfaces",
                                   [](const Study& s) { return is_sampled(s.sources); }};
    const AppliesTo<Study> arrays{".vtu, .vtp, .vti, .vtk, .msh and .pos",
                                  in_file({".vtu", ".vtp", ".vti", ".vtk", ".msh", ".pos"})};
    const AppliesTo<Study> steps{".vtu, .vtp, .vti, .msh and .pos",
                                 in_file({".vtu", ".vtp", ".vti", ".msh", ".pos"})};
    const AppliesTo<Study> surface{"surfaces: .stl, .obj, .ply, .off, .step, .iges and .brep",
                                   in_file(part_endings())};
    const AppliesTo<Study> files{"files of sources",
                                 [](const Study& s) { return !input_files_of(s.sources).empty(); }};
    const AppliesTo<Study> vdb{"sources in a .vdb",
                               in_file({vdb_endings.begin(), vdb_endings.end()})};
    const AppliesTo<Study> field_sphere{"field = \"sphere\"", field_is({"sphere"})};
    const AppliesTo<Study> field_planes{"field = \"planes\"", field_is({"planes"})};
    const AppliesTo<Study> field_surface{"field = \"sphere\" or \"planes\"",
                                         field_is({"sphere", "planes"})};
    const AppliesTo<Study> field_file{"field = \"file\"", field_is({"file"})};
    using Sources = SourcesChoice;
    const auto angle = [](double x) { return within(0, 180)(positive(x)); };
    return {
        {"name", "", "Name of the study, and of its folder of results", name(), Use::results,
         always, Topic::output},
        {"sources", "",
         "sphere or planes (sampled); none (only a field); or files and primitives, the smallest "
         "of "
         "whose metrics counts where they overlap. Files of points with metrics: .csv (- for "
         "standard input), .mesh or .meshb with .sol or .solb, .pos, .msh, .vtu, .vtp, .vti or "
         ".vtk; or "
         "a surface: .stl, .obj, .ply, .off, .step, .iges, .brep or in a .vdb. Primitives: "
         "box:x0,x1,y0,y1,z0,z1,h=H, ball:x,y,z,r=R,h=H, cylinder:x0,y0,z0,x1,y1,z1,r=R,h=H, "
         "segment:x0,y0,z0,x1,y1,z1,h=H, surface:FILE,h=H: the length is H on them and inside, and "
         "H + (g - 1) d at the distance d, by g_r or with g=G by G",
         sources_access()},
        {"h_min", length, "Smallest length: shorter requests are raised to it",
         length_or_none(of(sources, &Sources::h_min))},
        {"h_max", length,
         "Largest length anywhere (between the nodes of K_Li and K_oLi some per cent more); left "
         "out: half of the domain's diagonal, and no length of sources is limited",
         length_or_none(of(sources, &Sources::h_max), largest_magnitude)},
        {"centre", length, "x y z: centre of the sphere",
         point<Study>(of(sources, &Sources::centre)), making, sphere, paper},
        {"radius", length, "Radius of the sphere",
         number<Study>(of(sources, &Sources::radius), positive), making, sphere, paper},
        {"slope", "", "Slope a of the second plane (u, -0.2 + a u, v)",
         number<Study>(of(sources, &Sources::slope)), making, planes, paper},
        {"h", length, "Base length of a sampled surface: the unit of rho and s_a",
         number<Study>(of(sources, &Sources::h), positive), making, sampled, paper},
        {"domain", length,
         "x0 x1 y0 y1 z0 z1; left out: where the field is defined; -1 1 along each axis for other "
         "fields and sampled surfaces; otherwise the box of the sources and a margin",
         domain()},
        {"margin", "longest extent of the sources", "Margin around sources from a file",
         number<Study>(&Study::margin, within(0, 1000))},
        {"max_memory", "GiB",
         "Maximum memory of a structure, gradation included; a grid is made coarser, a tree that "
         "exceeds it fails",
         number<Study>(&Study::max_memory_gib,
                       [](double x) { return within(0, 1 << 20)(positive(x)); }),
         making, always, performance},
        {"max_seconds", "s",
         "Time after which the making of a row's structure is stopped: trees keep the leaves made "
         "so far, a search for voxels the best grid so far, and neither is ranked. Its accuracy is "
         "measured for as long again, a second at least. Repeats that would exceed it are left "
         "out, of access times too, one sample at least; a gradation is not interrupted. 0: no "
         "limit. "
         "Left out, for an input that is no study: 60",
         number<Study>(&Study::max_seconds, at_least(0), Zero::is_none), Use::timing, always,
         performance},
        {"max_memory_ratio", "memory of the smallest row before it",
         "Memory at which a row is stopped, 4 MiB at least: trees as after max_seconds; a grid is "
         "made coarser, and not ranked; 0: no limit. Left out, for an input that is no study: 20",
         number<Study>(&Study::max_memory_ratio, at_least(0), Zero::is_none), Use::timing, always,
         performance},
        {"seed", "", "Seed of the random places, and of sources that are not regular",
         number<Study>(&Study::seed, within(0, exact_integers)), making, always, performance},
        {"threads", "",
         "Threads for creation, probes and accuracy; access is timed on one; 0: all processors",
         number<Study>(&Study::threads, within(0, 4096)), making, always, performance},
        {"access_points", "", "Number of random places at which access is timed",
         number<Study>(&Study::access_points, within(1, 1e8)), Use::timing, always, performance},
        {"access_repeats", "", "Number of samples of the access time; results contain the median",
         number<Study>(&Study::access_repeats, within(1, 1000)), Use::timing, always, performance},
        {"creation_repeats", "",
         "Number of times that each structure is made; results contain the median times",
         number<Study>(&Study::creation_repeats, within(1, 1000)), Use::timing, always,
         performance},
        {"probe_grid", "",
         "n: accuracy is sampled at the centres of an n x n x n grid, and access timed in their "
         "order",
         number<Study>(&Study::probe_grid, within(1, 300)), Use::accuracy, always, Topic::accuracy},
        {"fine_probe_grid", "", "The same for the finer probes of delta_R_fine and coarser_fine",
         number<Study>(&Study::fine_probe_grid, within(1, 300)), Use::timing, always,
         Topic::accuracy},
        {"reference_tolerance", "",
         "t of the exact reference of anisotropic sources. Order-free: log det within 3 ln(1 + t) "
         "of the best. In turn: skip those that would shorten a length by less than this fraction: "
         "faster, with an error of about delta = 2 t^2",
         number<Study>(&Study::reference_tolerance, within(0, 0.1)), making, always,
         Topic::accuracy},
        {"output", "", "New folder for the results; left out: results/NAME-DATE-TIME",
         text<Study>(&Study::output), Use::results, always, Topic::output},
        {"field_centre", length, "x y z: centre of the field sphere",
         point<Study>(of(sources, field, &FieldChoice::centre)), making, field_sphere, fields},
        {"field_radius", length, "Radius of the field sphere",
         number<Study>(of(sources, field, &FieldChoice::radius), positive), making, field_sphere,
         fields},
        {"field_slope", "", "Slope a of the second plane (u, -0.2 + a u, v) of the field planes",
         number<Study>(of(sources, field, &FieldChoice::slope)), making, field_planes, fields},
        {"field_lengths", length,
         "Lengths across and along the surface of the field sphere or planes, there",
         field_lengths(), making, field_surface, fields},
        {"field_growth", "length / length",
         "Growth of those lengths with the distance from the surface",
         number<Study>(of(sources, field, &FieldChoice::lengths, &SurfaceLengths::growth),
                       at_least(0)),
         making, field_surface, fields},
        {"field_largest", length,
         "Length up to which they grow; left out: half of the domain's diagonal", field_largest(),
         making, field_surface, fields},
        {"field_file", "", "The file of the field file: a .vdb, or the cells of a .vtu or .vti",
         text<Study>(of(sources, field, &FieldChoice::file)), making, field_file, fields},
        {"field_grid", "",
         "Its grid of lengths, or of densities; left out: metric_diag and metric_off. Of a .vtu or "
         ".vti its array of sizes or metrics; left out: the one named :metric",
         text<Study>(of(sources, field, &FieldChoice::vdb, &VdbLengths::grid)), making, field_file,
         fields},
        {"field_density_sizes", length,
         "Lengths at densities 1 and 0 of that grid; left out: the grid contains lengths",
         density_sizes(), making, field_file, fields},
        {"scale", "", "Factor for the coordinates and lengths in files of sources, and for a part",
         length_or_none(of(sources, &Sources::in_file, &FileSources::scale), 1), reading, files},
        {"unit", "",
         "Unit of the field, into which .step and .iges are converted, and a part; left out: mm. "
         "Files of other formats say none",
         word<Study>(of(sources, &Sources::in_file, &FileSources::unit)), reading},
        {"source_array", "",
         "Sources of a .vtu, .vtp, .vti, .vtk, .msh or .pos: the array or view of sizes (1 "
         "component) or "
         "Riemannian metrics (6 or 9), at points, or else of cells, for their centres; left out: "
         "the array named :metric, the only view",
         text<Study>(of(sources, &Sources::in_file, &FileSources::array)), reading, arrays},
        {"source_step", "",
         "Sources of a .vtu, .vtp, .vti, .msh or .pos: step in time, by its number in a .msh, from "
         "0 "
         "in others; left out: the last",
         number<Study>(of(sources, &Sources::in_file, &FileSources::step),
                       within(0, exact_integers)),
         reading, steps},
        {"surface_angle", "degrees",
         "Sources of a surface (.stl, .obj, .ply, .off): part of the circle of curvature that an "
         "edge spans",
         number<Study>(of(sources, &Sources::in_file, curvature, &CurvatureSizes::angle), angle),
         reading, surface, Topic::sizes},
        {"surface_crease", "degrees",
         "Sources of a surface: edges where the normal turns by more bound its smooth patches, and "
         "are not curvature",
         number<Study>(of(sources, &Sources::in_file, curvature, &CurvatureSizes::crease), angle),
         reading, surface},
        {"elements_across", "",
         "Sources of a surface: number of lengths across walls and gaps, thickness / length",
         number<Study>(of(sources, &Sources::in_file, curvature, &CurvatureSizes::elements_across),
                       positive),
         reading, surface, Topic::sizes},
        {"isotropic", "",
         "Sources of a surface: the shortest length in all directions; left out: lengths by both "
         "principal curvatures and across walls",
         flag<Study>(of(sources, &Sources::in_file, curvature, &CurvatureSizes::isotropic)),
         reading, surface},
        {"surface_h_min", length,
         "Sources of a surface: smallest length; left out: a thousandth of the diagonal of its box",
         length_or_none(of(sources, &Sources::in_file, curvature, &CurvatureSizes::h_min)), reading,
         surface, Topic::sizes},
        {"surface_h_max", length,
         "Sources of a surface: largest length; left out: a tenth of that diagonal",
         length_or_none(of(sources, &Sources::in_file, curvature, &CurvatureSizes::h_max)), reading,
         surface, Topic::sizes},
        {"vdb_size", length, "Sources of a .vdb: length at its surface",
         length_or_none(of(sources, &Sources::surface, &VdbSurface::h)), reading, vdb,
         Topic::sizes},
        {"vdb_size_per_radius", "smaller radius of curvature",
         "Sources of a .vdb: length at its surface",
         length_or_none(of(sources, &Sources::surface, &VdbSurface::per_radius)), reading, vdb,
         Topic::sizes},
        {"vdb_grid", "",
         "Sources of a .vdb: the level set or fog; left out: the only grid of the file",
         text<Study>(of(sources, &Sources::surface, &VdbSurface::grid)), reading, vdb},
        {"vdb_isovalue", "",
         "Sources of a .vdb: where its surface is; left out: at 0 of a level set, 0.5 of a fog",
         number<Study>(of(sources, &Sources::surface, &VdbSurface::isovalue)), reading, vdb},
    };
}

}  // namespace

std::span<const Parameter<Study>> study_parameters() {
    static const std::vector<Parameter<Study>> all = table();
    return all;
}

void require_applicable(const Study& study) {
    static const Study defaults;
    for (const Parameter<Study>& parameter : study_parameters()) {
        if (parameter.applies(study)) continue;
        if (parameter.access.get(study) == parameter.access.get(defaults)) continue;
        refuse("{} is for {}: leave it out", parameter.key, parameter.applies_to.what);
    }
}

}  // namespace controlspace
