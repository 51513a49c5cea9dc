#include "cli/readers.h"

#include "cli/first_in_child.h"
#include "io/text/pos.h"

#ifdef CONTROLSPACE_OPENVDB
#include "controlspace/io/read_vdb_field.h"
#include "controlspace/io/read_vdb_sources.h"
#endif

#ifdef CONTROLSPACE_CGAL
#include "controlspace/io/read_surface_sources.h"
#include "io/surface/surface_mesh.h"
#endif
#ifdef CONTROLSPACE_GMSH
#include "gmsh/read_msh_sources.h"
#endif
#ifdef CONTROLSPACE_VTK
#include "controlspace/io/read_vtk_sources.h"
#endif

namespace controlspace {
namespace {

/// What `read` makes of `file`, for libraries that may crash on it.
template <class Read>
auto read_twice(const std::filesystem::path& file, const Read& read) {
    require_readable(file, read);
    return read();
}

}  // namespace

FileReaders file_readers() {
    FileReaders readers;
    readers.sources[".pos"] = [](const SourcesChoice& choice) {
        return read_pos_sources(choice.file, choice.in_file.array);
    };
#ifdef CONTROLSPACE_OPENVDB
    readers.sources[".vdb"] = [](const SourcesChoice& choice) {
        return read_twice(choice.file,
                          [&] { return read_vdb_sources(choice.file, choice.surface); });
    };
    readers.vdb_field = [](const FieldChoice& choice) {
        return read_twice(choice.file, [&] { return read_vdb_field(choice.file, choice.vdb); });
    };
#endif
#ifdef CONTROLSPACE_CGAL
    for (const char* ending : {".stl", ".obj", ".ply", ".off"}) {
        readers.sources[ending] = [](const SourcesChoice& choice) {
            require_readable(choice.file, [&] { read_surface_mesh(choice.file); });
            return read_surface_sources(choice.file, choice.in_file.curvature);
        };
    }
#endif
#ifdef CONTROLSPACE_GMSH
    readers.sources[".msh"] = [](const SourcesChoice& choice) {
        return read_twice(choice.file,
                          [&] { return read_msh_sources(choice.file, choice.in_file.array); });
    };
#endif
#ifdef CONTROLSPACE_VTK
    for (const char* ending : {".vtu", ".vtp"}) {
        readers.sources[ending] = [](const SourcesChoice& choice) {
            return read_twice(choice.file,
                              [&] { return read_vtk_sources(choice.file, choice.in_file.array); });
        };
    }
#endif
    return readers;
}

}  // namespace controlspace
