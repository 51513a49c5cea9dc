// SPDX-License-Identifier: Apache-2.0
#include "cli/formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "controlspace/io/read_sources.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/io/read_vtk_sources.h"
#include "controlspace/io/require_readable.h"
#include "geometry/extent_of.h"
#include "gmsh/cad_surface.h"
#include "io/surface/surface_distance.h"
#include "io/surface/surface_mesh.h"
#include "io/surface/surface_sources.h"
#include "io/text/cad_unit.h"
#include "modules/load.h"
#include "refuse.h"
#include "study/file_endings.h"

namespace controlspace {
namespace {

using Sources = std::vector<PointSource>;

/// Formats of files of sources that an external library reads. These libraries trust the contents
/// of a file, and may crash or exhaust the memory if it is damaged; therefore it is first read in a
/// child process. Our own readers (read_sources) check files.
struct SourceFormat {
    std::span<const std::string_view> endings;
    const char* module;  ///< that reads them
    Sources (*read)(const std::filesystem::path& file, const SourcesChoice& choice);
    /// The part of `read` that may crash, if the rest starts threads, which a forked process must
    /// not: of surfaces.
    SurfaceMesh (*read_mesh)(const std::filesystem::path& file) = nullptr;
};

void warn(const std::string& remark) { spdlog::warn("{}", remark); }

Sources read_vdb(const std::filesystem::path& file, const SourcesChoice& choice) {
    VdbSurface surface = choice.surface;
    surface.h /= choice.in_file.scale;  // what is read is scaled
    return read_vdb_sources(file, surface);
}
Sources read_vtk(const std::filesystem::path& file, const SourcesChoice& choice) {
    return read_vtk_sources(
        file, {.array = choice.in_file.array, .step = choice.in_file.step, .remark = warn});
}

/// From the numbers of a part as they are read, for which CAD files are in millimetres, to those of
/// the field.
double factor_of(const std::filesystem::path& file, const FileSources& choice) {
    const bool has_unit = has_ending(cad_endings, lower_case_extension(file)) &&
                          lower_case_extension(file) != ".brep";
    return choice.scale / (has_unit ? millimetres(choice.unit.value_or(LengthUnit::mm)) : 1);
}

/// Once for each file, whether it is read for sources, as a part or both.
void report_other_unit(const std::filesystem::path& file, const FileSources& choice) {
    static std::set<std::filesystem::path> reported;
    const std::string unit = cad_unit(file);
    if (choice.unit || unit.empty() || unit == name_of(LengthUnit::mm)) return;
    if (!reported.insert(file).second) return;
    spdlog::warn("{} has the unit {}, and is converted into mm: give that of the field{}",
                 file.string(), unit,
                 from_name<LengthUnit>(unit) ? fmt::format(" (--unit {})", unit) : " (--unit)");
}

template <SurfaceMesh (*read_mesh)(const std::filesystem::path&)>
Sources read_surface(const std::filesystem::path& file, const SourcesChoice& choice) {
    report_other_unit(file, choice.in_file);
    const SurfaceMesh surface = scaled(read_mesh(file), factor_of(file, choice.in_file));
    load_module("cgal");
    SurfaceSources found = surface_sources(surface, choice.in_file.curvature, file);
    if (found.skipped > 0) {
        spdlog::warn("{}: {} vertices are skipped: no triangle there has an area", file.string(),
                     found.skipped);
    }
    if (found.raised > 0) {
        spdlog::warn(
            "{}: at {} of {} places curvature or walls ask for less than {:.4g}{}, to which "
            "lengths "
            "are raised (--surface-h-min)",
            file.string(), found.raised, found.sources.size(), found.h_min,
            choice.in_file.curvature.h_min == 0 ? ", a thousandth of its diagonal" : "");
    }
    const SurfaceEdges edges = surface_edges(surface);
    if (edges.open.size() > 2 * surface.triangles.size()) {
        spdlog::warn(
            "{}: {} of {} edges are open: corners of its triangles differ by more than round-off, "
            "and curvature is not seen across edges; join its vertices",
            file.string(), edges.open.size(), edges.count);
    }
    if (found.fitted > 0 && !surface.curvatures.empty()) {
        spdlog::warn(
            "{}: at {} of {} vertices the CAD file gives no curvature: "
            "it is fitted to triangles",
            file.string(), found.fitted, surface.vertices.size());
    }
    return std::move(found.sources);
}

constexpr SourceFormat formats[] = {
    {vdb_endings, "openvdb", read_vdb},
    {vtk_endings, "vtk", read_vtk},
    {triangle_endings, "cgal", read_surface<read_surface_mesh>, read_surface_mesh},
    {cad_endings, "gmsh", read_surface<read_cad_surface>, read_cad_surface},
};

/// A Medit mesh, with a solution beside it or alone.
Sources read_mesh(const std::filesystem::path& file, const SourcesChoice&) {
    Sources sources = read_sources(file);
    std::filesystem::path solution = file;
    std::error_code none;
    if (!std::filesystem::exists(solution.replace_extension(".sol"), none) &&
        !std::filesystem::exists(solution.replace_extension(".solb"), none)) {
        spdlog::warn(
            "{} has no solution beside it: lengths of its required edges are taken, at {} vertices",
            file.string(), sources.size());
    }
    return sources;
}

Sources read_by(const SourceFormat& format, const std::filesystem::path& file,
                const SourcesChoice& choice) {
    load_module(format.module);  // here, as the child's time and memory are limited
    require_readable(file, [&] {
        format.read_mesh ? static_cast<void>(format.read_mesh(file))
                         : static_cast<void>(format.read(file, choice));
    });
    return format.read(file, choice);
}

const SourceFormat* format_of(const std::filesystem::path& file) {
    const auto* format = std::ranges::find_if(formats, [&](const SourceFormat& known) {
        return has_ending(known.endings, lower_case_extension(file));
    });
    return format == std::end(formats) ? nullptr : format;
}

/// The format of a part, which can be read.
const SourceFormat& checked_part(const std::filesystem::path& file) {
    if (!is_part(file)) {
        refuse("{} is no part: name a {}", file.string(), fmt::join(part_endings(), ", "));
    }
    const SourceFormat& format = *format_of(file);
    load_module(format.module);
    require_readable(file, [&] { format.read_mesh(file); });
    return format;
}

void require_closed(const SurfaceMesh& surface, const std::filesystem::path& file) {
    const SurfaceEdges edges = surface_edges(surface);
    if (edges.open.empty()) return;
    constexpr std::size_t shown = 3;
    std::vector<std::string> ends;
    for (const auto& [a, b] : std::span(edges.open).first(std::min(shown, edges.open.size()))) {
        const Point &p = surface.vertices[a], &q = surface.vertices[b];
        ends.push_back(fmt::format("({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})", p.x(),
                                   p.y(), p.z(), q.x(), q.y(), q.z()));
    }
    refuse_at(
        file,
        "{} of {} edges are open, with one triangle or an odd number of them: {}{}; close the "
        "surface",
        edges.open.size(), edges.count, fmt::join(ends, "; "),
        edges.open.size() > shown ? "; ..." : "");
}

}  // namespace

bool is_part(const std::filesystem::path& file) {
    const SourceFormat* format = format_of(file);
    return format != nullptr && format->read_mesh != nullptr;
}

PartFacts facts_of_part(const std::filesystem::path& file, const FileSources& choice,
                        std::size_t rays) {
    constexpr std::uint64_t seed = 1;
    const SurfaceMesh surface = scaled(checked_part(file).read_mesh(file), factor_of(file, choice));
    load_module("cgal");
    return {surface.triangles.size(), surface_edges(surface), cad_unit(file),
            wall_requests(surface, choice.curvature, rays, seed, file)};
}

Part read_part(const std::filesystem::path& file, double crease, const FileSources& choice) {
    const SourceFormat& format = checked_part(file);
    const double factor = factor_of(file, choice);
    if (has_ending(cad_endings, lower_case_extension(file))) {
        report_other_unit(file, choice);
        const Box box = cad_box(file);
        return {.cad = file, .box = {factor * box.low, factor * box.high}, .scale = factor};
    }
    SurfaceMesh surface = scaled(format.read_mesh(file), factor);
    require_closed(surface, file);
    const Box box = extent_of(surface.vertices);
    return {.vertices = std::move(surface.vertices),
            .triangles = std::move(surface.triangles),
            .crease = crease,
            .box = box};
}

FileReaders file_readers() {
    FileReaders readers;
    readers.remark = warn;
    readers.sources = {{".mesh", read_mesh}, {".meshb", read_mesh}};
    for (const SourceFormat& format : formats) {
        for (const std::string_view ending : format.endings) {
            readers.sources[std::string(ending)] = [&format](const auto& file, const auto& choice) {
                return read_by(format, file, choice);
            };
        }
    }
    readers.vdb_field = [](const FieldChoice& choice) {
        const std::string ending = lower_case_extension(choice.file);
        const bool is_vtk = ending == ".vtu" || ending == ".vti";
        if (!is_vtk && ending != ".vdb") {
            refuse_at(choice.file, "name a .vdb, .vtu or .vti as the field");
        }
        if (is_vtk && choice.vdb.density) refuse("field_density_sizes is for a .vdb: leave it out");
        const auto read = [&] {
            return is_vtk ? read_vtk_field(choice.file, choice.vdb.grid)
                          : read_vdb_field(choice.file, choice.vdb);
        };
        load_module(is_vtk ? "vtk" : "openvdb");
        require_readable(choice.file, read);
        return read();
    };
    readers.surface_distance = [](const std::filesystem::path& file, const FileSources& choice) {
        report_other_unit(file, choice);
        const SurfaceMesh mesh =
            scaled(checked_part(file).read_mesh(file), factor_of(file, choice));
        load_module("cgal");
        return surface_distance(mesh);
    };
    return readers;
}

std::string source_formats_help() {
    return "Sources: .csv; .npy; .mesh, .sol, .meshb or .solb, the other beside it; .pos; .msh; "
           ".vtu, "
           ".vtp, .vti, .vtk; or a surface: .stl, .obj, .ply, .off, or in a .vdb; or CAD: .step, "
           ".iges, "
           ".brep; several with commas; or another value of --sources (sphere, planes)";
}

}  // namespace controlspace
