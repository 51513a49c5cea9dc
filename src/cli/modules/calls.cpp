// The functions of the modules, as the program is linked with them: each loads its module.
#include <dlfcn.h>
#include <fmt/format.h>

#include "cli/modules/module.h"
#include "controlspace/error.h"
#include "controlspace/version.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

/// The folder of the modules lies in the same place relative to the program, in the build folder
/// and where it is installed.
fs::path module_file(const std::string& name) {
    return (fs::read_symlink("/proc/self/exe").parent_path() / CONTROLSPACE_MODULES /
            (name + ".so"))
        .lexically_normal();
}

void* open_module(const std::string& name) {
    const fs::path file = module_file(name);
    if (!fs::exists(file)) {
        throw InputError(fmt::format(
            "{}: no such file: the program is built or installed without {}", file.string(), name));
    }
    void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) throw InputError(fmt::format("cannot be loaded: {}", ::dlerror()));
    return module;
}

template <class Table>
const Table& load(const std::string& name) {
    void* function = ::dlsym(open_module(name), "controlspace_module");
    const auto* table = function ? reinterpret_cast<const Table* (*)()>(function)() : nullptr;
    if (table == nullptr || table->version != version()) {
        throw InputError(fmt::format("{}: not of this program's version, {}",
                                     module_file(name).string(), version()));
    }
    return *table;
}

const OpenvdbModule& openvdb() {
    static const auto& module = load<OpenvdbModule>("openvdb");
    return module;
}

const VtkModule& vtk() {
    static const auto& module = load<VtkModule>("vtk");
    return module;
}

const CgalModule& cgal() {
    static const auto& module = load<CgalModule>("cgal");
    return module;
}

const GmshModule& gmsh() {
    static const auto& module = load<GmshModule>("gmsh");
    return module;
}

}  // namespace

void load_module(const std::string& name) { open_module(name); }

void load_module_of(std::string_view structure) {
    if (structure.starts_with("openvdb")) load_module("openvdb");
}

std::unique_ptr<ControlSpaceBuilder> make_openvdb_grid(const SpaceOptions& options,
                                                       Interpolation interpolation) {
    return openvdb().make_openvdb_grid(options, interpolation);
}

std::unique_ptr<ControlSpaceBuilder> make_openvdb_levels(const SpaceOptions& options,
                                                         Interpolation interpolation) {
    return openvdb().make_openvdb_levels(options, interpolation);
}

std::unique_ptr<ControlSpaceBuilder> make_openvdb_vec3s(const SpaceOptions& options) {
    return openvdb().make_openvdb_vec3s(options);
}

std::vector<PointSource> read_vdb_sources(const fs::path& path, const VdbSurface& surface) {
    return openvdb().read_vdb_sources(path, surface);
}

AnalyticField read_vdb_field(const fs::path& path, const VdbLengths& what) {
    return openvdb().read_vdb_field(path, what);
}

VdbReport write_vdb(const fs::path& path, const ControlSpace& space, const VdbOptions& options) {
    return openvdb().write_vdb(path, space, options);
}

std::vector<PointSource> read_vtk_sources(const fs::path& path, const std::string& array) {
    return vtk().read_vtk_sources(path, array);
}

SurfaceMesh read_surface_mesh(const fs::path& path) { return cgal().read_surface_mesh(path); }

std::vector<PointSource> read_surface_sources(const fs::path& path, const CurvatureSizes& sizes) {
    return cgal().read_surface_sources(path, sizes);
}

GmshRun mesh_with_gmsh(const Box& domain, const ControlSpace& field, const GmshOptions& options) {
    return gmsh().mesh_with_gmsh(domain, field, options);
}

}  // namespace controlspace
