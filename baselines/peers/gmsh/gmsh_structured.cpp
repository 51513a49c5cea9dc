// SPDX-License-Identifier: Apache-2.0
#include <gmsh.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "baselines/lattice/grid_row.h"
#include "baselines/lattice/lattice_data.h"
#include "baselines/peers/gmsh/gmsh_space.h"
#include "files/output_file.h"
#include "refuse.h"
#include "space/shared_builder.h"

namespace controlspace {

namespace {

Metric only_isotropic(const Metric& m) {
    if (is_isotropic(m)) return m;
    refuse(
        "Gmsh's field Structured holds one length at a place, no tensor: give isotropic sources, "
        "or leave gmsh-structured out of --structures");
}

class ScratchFile {
public:
    ScratchFile() : path_(std::filesystem::temp_directory_path() / "controlspace-XXXXXX") {
        const int file = ::mkstemp(path_.data());
        if (file < 0) refuse_at(path_, "cannot be made: set TMPDIR to a writable folder");
        ::close(file);
    }
    ~ScratchFile() { ::unlink(path_.c_str()); }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

/// z fastest, x slowest; in a flat domain two layers.
void write(const LatticeData& data, const std::string& path) {
    const Lattice lattice = data.lattice();
    std::array<int, 3> counts;
    Vector spacing = lattice.spacing;
    for (std::size_t a = 0; a < 3; ++a) {
        counts[a] = static_cast<int>(std::max(2u, lattice.nodes[a]));
        if (lattice.nodes[a] == 1) spacing[static_cast<Axis>(a)] = 1;
    }
    OutputFile file(path);
    file.write_raw(lattice.origin.data(), 3);
    file.write_raw(spacing.data(), 3);
    file.write_raw(counts.data(), 3);
    const auto node = [&](int i, std::size_t axis) {
        return std::min(static_cast<std::uint32_t>(i), lattice.nodes[axis] - 1);
    };
    for (int i = 0; i < counts[0]; ++i) {
        for (int j = 0; j < counts[1]; ++j) {
            for (int k = 0; k < counts[2]; ++k) {
                const Metric& m = data.field()[lattice.index(node(i, 0), node(j, 1), node(k, 2))];
                file.write_raw(only_isotropic(m).xx);
            }
        }
    }
    file.commit();
}

/// The nodes of `uniform-trilinear` as Gmsh's field Structured, which reads a file.
std::unique_ptr<ControlSpace> finished(const std::shared_ptr<const LatticeData>& data,
                                       std::optional<Precision> precision) {
    if (precision) refuse_precision();
    const ScratchFile file;  // it is read before the constructor ends
    write(*data, file.path());
    Footprint counts;
    counts.cells = static_cast<std::size_t>(data->cells().prod());
    counts.control_nodes = data->lattice().size();
    counts.bytes_payload = counts.control_nodes * sizeof(double);
    counts.remark = data->remark();
    return std::make_unique<GmshSpace>(data->domain(), counts, [&] {
        const int field = gmsh::model::mesh::field::add("Structured");
        gmsh::model::mesh::field::setString(field, "FileName", file.path());
        gmsh::model::mesh::field::setNumber(field, "TextFormat", 0);
        gmsh::model::mesh::field::setNumber(field, "SetOutsideValue", 0);
        return GmshSpace::Made{.field = field};
    });
}

std::unique_ptr<ControlSpaceBuilder> make(const SpaceOptions& options,
                                          Interpolation interpolation) {
    open_gmsh();
    return std::make_unique<SharedBuilder<LatticeData>>(
        options,
        GridKind{.interpolation = interpolation,
                 .bytes_for = [](const Vector& nodes) { return nodes.prod() * sizeof(double); },
                 .finish = finished,
                 .stored = only_isotropic});
}

}  // namespace

CatalogueEntry gmsh_structured_row() {
    CatalogueEntry row = grid_row<make, Interpolation::trilinear>(
        "gmsh-structured", "Gmsh's field Structured: a grid of sizes, trilinear; isotropic only");
    row.capabilities = {MetricNodes(), VoxelSize(), FittedValues()};
    return row;
}

}  // namespace controlspace
