#include "cli/formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "cli/child_reading.h"
#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/io/read_vtk_sources.h"
#include "gmsh/cad_surface.h"
#include "io/surface/surface_distance.h"
#include "io/surface/surface_mesh.h"
#include "io/surface/surface_sources.h"
#include "modules/load.h"
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
    Sources (*read)(const SourcesChoice& choice);
    /// The part of `read` that may crash, if the rest starts threads, which a forked process must
    /// not.
    void (*try_read)(const SourcesChoice& choice) = nullptr;
};

Sources read_vdb(const SourcesChoice& choice) {
    return read_vdb_sources(choice.file, choice.surface);
}
Sources read_vtk(const SourcesChoice& choice) {
    return read_vtk_sources(choice.file, choice.in_file.array);
}
Sources sources_on(const SurfaceMesh& surface, const SourcesChoice& choice) {
    load_module("cgal");
    SurfaceSources found = surface_sources(surface, choice.in_file.curvature, choice.file);
    if (found.skipped > 0) {
        spdlog::warn("{}: {} vertices are skipped: no triangle there has an area",
                     choice.file.string(), found.skipped);
    }
    if (found.fitted > 0 && !surface.curvatures.empty()) {
        spdlog::warn(
            "{}: at {} of {} vertices the CAD file gives no curvature: "
            "it is fitted to triangles",
            choice.file.string(), found.fitted, surface.vertices.size());
    }
    return std::move(found.sources);
}
Sources read_surface(const SourcesChoice& choice) {
    return sources_on(read_surface_mesh(choice.file), choice);
}
void try_surface(const SourcesChoice& choice) { read_surface_mesh(choice.file); }
Sources read_cad(const SourcesChoice& choice) {
    return sources_on(read_cad_surface(choice.file), choice);
}
void try_cad(const SourcesChoice& choice) { read_cad_surface(choice.file); }

constexpr SourceFormat formats[] = {
    {vdb_endings, "openvdb", read_vdb},
    {vtk_endings, "vtk", read_vtk},
    {triangle_endings, "cgal", read_surface, try_surface},
    {cad_endings, "gmsh", read_cad, try_cad},
};

// Whether this is a Medit mesh without a solution beside it.
bool is_mesh_alone(std::filesystem::path file) {
    const std::string ending = lower_case_extension(file);
    if (ending != ".mesh" && ending != ".meshb") return false;
    std::error_code none;
    return std::ranges::none_of(std::array{".sol", ".solb"}, [&](const char* solution) {
        return std::filesystem::exists(file.replace_extension(solution), none);
    });
}

Sources read_by(const SourceFormat& format, const SourcesChoice& choice) {
    load_module(format.module);  // here, as the child's time and memory are limited
    require_readable(choice.file, [&] {
        format.try_read ? format.try_read(choice) : static_cast<void>(format.read(choice));
    });
    Sources sources = format.read(choice);
    if (is_mesh_alone(choice.file)) {
        spdlog::warn(
            "{} has no solution beside it: lengths of its required edges are taken, at {} "
            "vertices",
            choice.file.string(), sources.size());
    }
    return sources;
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
        throw InputError(fmt::format("{} is no part: name a {}", file.string(),
                                     fmt::join(part_endings(), ", ")));
    }
    const SourceFormat& format = *format_of(file);
    load_module(format.module);
    require_readable(file, [&] { format.try_read({.file = file}); });
    return format;
}

}  // namespace

bool is_part(const std::filesystem::path& file) {
    const SourceFormat* format = format_of(file);
    return format != nullptr && format->try_read != nullptr;
}

Part read_part(const std::filesystem::path& file, double crease) {
    if (checked_part(file).read == read_cad) return {.cad = file};
    SurfaceMesh surface = read_surface_mesh(file);
    return {std::move(surface.vertices), std::move(surface.triangles), crease};
}

FileReaders file_readers() {
    FileReaders readers;
    for (const SourceFormat& format : formats) {
        for (const std::string_view ending : format.endings) {
            readers.sources[std::string(ending)] = [&format](const SourcesChoice& choice) {
                return read_by(format, choice);
            };
        }
    }
    readers.vdb_field = [](const FieldChoice& choice) {
        const std::string ending = lower_case_extension(choice.file);
        const bool is_vtk = ending == ".vtu" || ending == ".vti";
        if (!is_vtk && ending != ".vdb") {
            throw InputError(
                fmt::format("{}: name a .vdb, .vtu or .vti as the field", choice.file.string()));
        }
        if (is_vtk && choice.vdb.density) {
            throw InputError("field_density_sizes is for a .vdb: leave it out");
        }
        const auto read = [&] {
            return is_vtk ? read_vtk_field(choice.file, choice.vdb.grid)
                          : read_vdb_field(choice.file, choice.vdb);
        };
        load_module(is_vtk ? "vtk" : "openvdb");
        require_readable(choice.file, read);
        return read();
    };
    readers.surface_distance = [](const std::filesystem::path& file) {
        const bool is_cad = checked_part(file).read == read_cad;
        const SurfaceMesh mesh = is_cad ? read_cad_surface(file) : read_surface_mesh(file);
        load_module("cgal");
        return surface_distance(mesh);
    };
    return readers;
}

std::string source_formats_help() {
    return "Sources: .csv; .mesh, .sol, .meshb or .solb, the other beside it; .pos; .msh; .vtu, "
           ".vtp, .vti; or a surface: .stl, .obj, .ply, .off, or in a .vdb; or CAD: .step, .iges, "
           ".brep; several with commas; or another value of --sources (sphere, planes)";
}

}  // namespace controlspace
