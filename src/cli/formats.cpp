#include "cli/formats.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "cli/child_reading.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/io/read_surface_sources.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/io/read_vtk_sources.h"
#include "io/surface/surface_mesh.h"
#include "modules/load.h"

namespace controlspace {
namespace {

using Sources = std::vector<PointSource>;

/// A format of files of sources that an external library reads. These libraries trust the contents
/// of a file, and may crash or exhaust the memory if it is damaged; therefore it is first read in a
/// child process. Our own readers (read_sources) check files.
struct SourceFormat {
    const char* ending;
    const char* module;  ///< that reads it
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
Sources read_surface(const SourcesChoice& choice) {
    SurfaceSources read = read_surface_sources(choice.file, choice.in_file.curvature);
    if (read.skipped > 0) {
        spdlog::warn("{}: {} vertices are skipped: no triangle there has an area",
                     choice.file.string(), read.skipped);
    }
    return std::move(read.sources);
}
void try_surface(const SourcesChoice& choice) { read_surface_mesh(choice.file); }

constexpr SourceFormat formats[] = {
    {".vdb", "openvdb", read_vdb},
    {".vtu", "vtk", read_vtk},
    {".vtp", "vtk", read_vtk},
    {".stl", "cgal", read_surface, try_surface},
    {".obj", "cgal", read_surface, try_surface},
    {".ply", "cgal", read_surface, try_surface},
    {".off", "cgal", read_surface, try_surface},
};

Sources read_by(const SourceFormat& format, const SourcesChoice& choice) {
    load_module(format.module);  // here, as the child's time and memory are limited
    require_readable(choice.file, [&] {
        format.try_read ? format.try_read(choice) : static_cast<void>(format.read(choice));
    });
    return format.read(choice);
}

}  // namespace

FileReaders file_readers() {
    FileReaders readers;
    for (const SourceFormat& format : formats) {
        readers.sources[format.ending] = [&format](const SourcesChoice& choice) {
            return read_by(format, choice);
        };
    }
    readers.vdb_field = [](const FieldChoice& choice) {
        const auto read = [&] { return read_vdb_field(choice.file, choice.vdb); };
        load_module("openvdb");
        require_readable(choice.file, read);
        return read();
    };
    return readers;
}

std::string source_formats_help() {
    return "Sources: .csv; .mesh, .sol, .meshb or .solb, the other beside it; .pos; .msh; .vtu, "
           ".vtp; or a surface: .stl, .obj, .ply, .off, or in a .vdb";
}

}  // namespace controlspace
