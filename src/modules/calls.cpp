// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "modules/load.h"
#include "modules/tables.h"

namespace controlspace {

namespace fs = std::filesystem;

std::vector<PointSource> read_vtk_sources(const fs::path& path, const ReadOptions& options) {
    return module_table<VtkModule>("vtk").read_vtk_sources(path, options);
}

AnalyticField read_vtk_field(const fs::path& path, const std::string& array) {
    return module_table<VtkModule>("vtk").read_vtk_field(path, array);
}

void write_netcdf(const fs::path& path, const ControlSpace& space, const Raster& raster,
                  const RasterProgress& progress) {
    module_table<NetcdfModule>("netcdf").write_netcdf(path, space, raster, progress);
}

SurfaceMesh read_surface_mesh(const fs::path& path) {
    return module_table<CgalModule>("cgal").read_surface_mesh(path);
}

SurfaceEdges surface_edges(const SurfaceMesh& mesh) {
    return module_table<CgalModule>("cgal").surface_edges(mesh);
}

SurfaceSources surface_sources(const SurfaceMesh& mesh, const CurvatureSizes& sizes,
                               const fs::path& file) {
    return module_table<CgalModule>("cgal").surface_sources(mesh, sizes, file);
}

std::vector<WallRequest> wall_requests(const SurfaceMesh& mesh, const CurvatureSizes& sizes,
                                       std::size_t rays, std::uint64_t seed, const fs::path& file) {
    return module_table<CgalModule>("cgal").wall_requests(mesh, sizes, rays, seed, file);
}

DistanceField surface_distance(const SurfaceMesh& mesh) {
    return module_table<CgalModule>("cgal").surface_distance(mesh);
}

SurfaceMesh read_cad_surface(const fs::path& path) {
    return module_table<GmshModule>("gmsh").read_cad_surface(path);
}

Box cad_box(const fs::path& path) { return module_table<GmshModule>("gmsh").cad_box(path); }

MeshRun mesh_with_gmsh(const Box& domain, const ControlSpace& field, const GmshOptions& options) {
    return module_table<GmshModule>("gmsh").mesh_with_gmsh(domain, field, options);
}

}  // namespace controlspace
