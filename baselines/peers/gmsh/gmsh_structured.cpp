#include <gmsh.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "baselines/lattice/grid_row.h"
#include "baselines/lattice/lattice_data.h"
#include "baselines/peers/gmsh/gmsh_field.h"
#include "baselines/peers/gmsh/gmsh_rows.h"
#include "controlspace/error.h"
#include "controlspace/space/detail/shared_builder.h"

namespace controlspace {

namespace {

Metric only_isotropic(const Metric& m) {
    if (is_isotropic(m)) return m;
    throw InputError(
        "Gmsh's field Structured holds one length at a place, no tensor: give isotropic sources, "
        "or leave gmsh-structured out of --structures");
}

class ScratchFile {
public:
    ScratchFile() : path_(std::filesystem::temp_directory_path() / "controlspace-XXXXXX") {
        const int file = ::mkstemp(path_.data());
        if (file < 0) throw InputError(path_ + ": cannot be made: set TMPDIR to a writable folder");
        ::close(file);
    }
    ~ScratchFile() { ::unlink(path_.c_str()); }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

/// The nodes of `uniform-trilinear` as Gmsh's field Structured, which reads a file.
class GmshStructured final : public ControlSpace, public Saved {
public:
    explicit GmshStructured(const LatticeData& data)
        : domain_(data.domain()),
          cells_(data.cells()),
          nodes_(data.lattice().size()),
          remark_(data.remark()),
          field_([&](auto& made) { make(made, data, file_->path()); }, domain_.centre()) {
        file_.reset();  // it was read when the field was asked
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        std::vector<double> sizes(x.size());
        sample_lengths(x, sizes);
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = Metric::isotropic(sizes[i]);
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        std::vector<Point> inside(x.begin(), x.end());
        for (Point& p : inside) p = p.cwiseMax(domain_.low).cwiseMin(domain_.high);
        field_.sizes(inside, out);
    }
    Box domain() const override { return domain_; }
    Footprint footprint() const override {
        Footprint footprint;
        footprint.cells = static_cast<std::size_t>(cells_.prod());
        footprint.control_nodes = nodes_;
        footprint.bytes_payload = nodes_ * sizeof(double);
        footprint.bytes_topology =
            std::max(field_.bytes(), footprint.bytes_payload) - footprint.bytes_payload;
        footprint.remark = remark_;
        return footprint;
    }
    void save(StateWriter&) const override {
        throw InputError(
            "a field of Gmsh is not saved: save uniform-trilinear, or export a .structured file");
    }

private:
    static void make(GmshField::Made& made, const LatticeData& data, const std::string& path) {
        write(data, path);
        const int field = made.field = gmsh::model::mesh::field::add("Structured");
        gmsh::model::mesh::field::setString(field, "FileName", path);
        gmsh::model::mesh::field::setNumber(field, "TextFormat", 0);
        gmsh::model::mesh::field::setNumber(field, "SetOutsideValue", 0);
    }
    /// z fastest, x slowest; in a flat domain two layers.
    static void write(const LatticeData& data, const std::string& path) {
        const Lattice lattice = data.lattice();
        std::array<int, 3> counts;
        Vector spacing = lattice.spacing;
        for (std::size_t a = 0; a < 3; ++a) {
            counts[a] = static_cast<int>(std::max(2u, lattice.nodes[a]));
            if (lattice.nodes[a] == 1) spacing[static_cast<Axis>(a)] = 1;
        }
        std::ofstream file(path, std::ios::binary);
        const auto put = [&](const auto* values, std::size_t count) {
            file.write(reinterpret_cast<const char*>(values),
                       static_cast<std::streamsize>(count * sizeof *values));
        };
        put(lattice.origin.data(), 3);
        put(spacing.data(), 3);
        put(counts.data(), 3);
        std::vector<double> column;
        const auto node = [&](int i, std::size_t axis) {
            return std::min(static_cast<std::uint32_t>(i), lattice.nodes[axis] - 1);
        };
        for (int i = 0; i < counts[0]; ++i) {
            for (int j = 0; j < counts[1]; ++j) {
                column.clear();
                for (int k = 0; k < counts[2]; ++k) {
                    const Metric& m =
                        data.field()[lattice.index(node(i, 0), node(j, 1), node(k, 2))];
                    column.push_back(only_isotropic(m).xx);
                }
                put(column.data(), column.size());
            }
        }
        file.close();
        if (!file) throw InputError(path + ": cannot be written: free space there");
    }

    Box domain_;
    Vector cells_;
    std::size_t nodes_;
    std::string remark_;
    std::optional<ScratchFile> file_{std::in_place};
    GmshField field_;
};

std::unique_ptr<ControlSpaceBuilder> make(const SpaceOptions& options,
                                          Interpolation interpolation) {
    open_gmsh();
    return std::make_unique<SharedBuilder<LatticeData>>(
        options,
        GridKind{
            .interpolation = interpolation,
            .bytes_for = [](const Vector& nodes) { return nodes.prod() * sizeof(double); },
            .finish = [](std::shared_ptr<const LatticeData> data) -> std::unique_ptr<ControlSpace> {
                return std::make_unique<GmshStructured>(*data);
            },
            .stored = only_isotropic});
}

}  // namespace

CatalogueEntry gmsh_structured_row() {
    CatalogueEntry row = grid_row<make, Interpolation::trilinear>(
        "gmsh-structured", "Gmsh's field Structured: a grid of sizes, trilinear; isotropic only");
    return row;
}

}  // namespace controlspace
