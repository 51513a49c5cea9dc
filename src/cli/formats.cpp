#include "cli/formats.h"

#include "cli/child_reading.h"
#include "cli/modules/module.h"
#include "controlspace/io/read_sources.h"
#include "io/text/pos.h"
#include "io/text/write_sources.h"

namespace controlspace {
namespace {

using Sources = std::vector<PointSource>;

/// A format of files of sources.
struct SourceFormat {
    const char* ending;
    /// The module that reads it, in a process of its own first, as libraries may crash on damaged
    /// files; null for our own formats.
    const char* module;
    Sources (*read)(const SourcesChoice& choice);
    void (*write)(const std::filesystem::path& file,
                  std::span<const PointSource> sources) = nullptr;
    /// The part of `read` that may crash, if the rest starts threads, which a forked process must
    /// not.
    void (*try_read)(const SourcesChoice& choice) = nullptr;
};

Sources read_pos(const SourcesChoice& choice) {
    return read_pos_sources(choice.file, choice.in_file.array);
}
Sources read_vdb(const SourcesChoice& choice) {
    return read_vdb_sources(choice.file, choice.surface);
}
Sources read_vtk(const SourcesChoice& choice) {
    return read_vtk_sources(choice.file, choice.in_file.array);
}
Sources read_msh(const SourcesChoice& choice) {
    return read_msh_sources(choice.file, choice.in_file.array);
}
Sources read_surface(const SourcesChoice& choice) {
    return read_surface_sources(choice.file, choice.in_file.curvature);
}
void try_surface(const SourcesChoice& choice) { read_surface_mesh(choice.file); }

constexpr SourceFormat formats[] = {
    {".pos", nullptr, read_pos},
    {".vdb", "openvdb", read_vdb},
    {".vtu", "vtk", read_vtk, write_vtk_sources},
    {".vtp", "vtk", read_vtk, write_vtk_sources},
    {".msh", "gmsh", read_msh},
    {".stl", "cgal", read_surface, nullptr, try_surface},
    {".obj", "cgal", read_surface, nullptr, try_surface},
    {".ply", "cgal", read_surface, nullptr, try_surface},
    {".off", "cgal", read_surface, nullptr, try_surface},
};

Sources read_by(const SourceFormat& format, const SourcesChoice& choice) {
    if (format.module != nullptr) {
        load_module(format.module);  // here, as the child's time and memory are limited
        require_readable(choice.file, [&] {
            format.try_read ? format.try_read(choice) : static_cast<void>(format.read(choice));
        });
    }
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

void write_source_file(const std::filesystem::path& file, std::span<const PointSource> sources) {
    const std::string ending = lower_case_extension(file);
    for (const SourceFormat& format : formats) {
        if (ending == format.ending && format.write) return format.write(file, sources);
    }
    write_sources(file, sources);
}

std::string source_formats_help() {
    return "Sources: .csv; .mesh, .sol, .meshb or .solb, the other beside it; .pos; .msh; .vtu, "
           ".vtp; or a surface: .stl, .obj, .ply, .off, or in a .vdb";
}

}  // namespace controlspace
