// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>

#include "modules/load.h"
#include "modules/tables.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

const OpenvdbModule& openvdb() { return module_table<OpenvdbModule>("openvdb"); }

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_openvdb_grid(const SpaceOptions& options,
                                                       Interpolation interpolation) {
    return openvdb().make_openvdb_grid(options, interpolation);
}

std::unique_ptr<ControlSpaceBuilder> make_openvdb_bricks(const SpaceOptions& options) {
    return openvdb().make_openvdb_bricks(options);
}
std::unique_ptr<ControlSpaceBuilder> make_openvdb_tiles(const SpaceOptions& options) {
    return openvdb().make_openvdb_tiles(options);
}
std::unique_ptr<ControlSpaceBuilder> make_openvdb_vec3s(const SpaceOptions& options) {
    return openvdb().make_openvdb_vec3s(options);
}

std::string state_in_octree_file(const std::string& bytes, const std::string& file) {
    return openvdb().state_in_octree_file(bytes, file);
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

}  // namespace controlspace
