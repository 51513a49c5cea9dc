// SPDX-License-Identifier: Apache-2.0
#include "io/openvdb/vdb_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include "controlspace/error.h"
#include "files/output_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

// openvdb::io::File writes to a stream of its own and does not check for errors such as a full
// disk.
class CheckedArchive : public openvdb::io::Archive {
public:
    explicit CheckedArchive(VdbCompression compression) {
        namespace io = openvdb::io;
        const bool is_blosc = compression == VdbCompression::blosc;
        setCompression(compression == VdbCompression::none
                           ? io::COMPRESS_NONE
                           : io::COMPRESS_ACTIVE_MASK |
                                 (is_blosc ? io::COMPRESS_BLOSC : io::COMPRESS_ZIP));
    }
    void write_to(std::ostream& stream, const openvdb::GridCPtrVec& grids) const {
        write(stream, grids, /*seekable=*/true);
    }
};

std::string value_type(openvdb::io::File& file, const std::string& grid) {
    try {
        return file.readGridMetadata(grid)->valueType();
    } catch (const openvdb::Exception&) {
        return "unknown type";
    }
}

}  // namespace

std::string one_line(std::string text) {
    std::ranges::replace_if(
        text, [](char c) { return c >= '\0' && c < ' '; }, ' ');
    return text;
}

std::uintmax_t write_vdb_file(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
                              VdbCompression compression) {
    OutputFile file(path);
    std::uintmax_t bytes = 0;
    errno = 0;
    try {
        std::ofstream stream;
        stream.exceptions(std::ios::failbit | std::ios::badbit);
        stream.open(file.written(), std::ios::binary | std::ios::trunc);
        CheckedArchive(compression).write_to(stream, grids);
        stream.seekp(0, std::ios::end);
        bytes = static_cast<std::uintmax_t>(stream.tellp());
        stream.close();
    } catch (const std::ios::failure&) {
        refuse("cannot write {}: {}", path.string(),
               errno != 0 ? std::strerror(errno) : "name a file on a disk");
    }
    file.commit();
    return bytes;
}

VdbFile::VdbFile(const std::filesystem::path& path) : path_(path) {
    openvdb::initialize();
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) fail("is a directory: name a file");
    if (!std::ifstream(path)) fail("cannot be read: {}", std::strerror(errno));
    try {
        openvdb::io::File file(path.string());
        file.open(/*delayLoad=*/false);
        for (auto name = file.beginName(); name != file.endName(); ++name) {
            names_.push_back(*name);
            types_.push_back(value_type(file, *name));
        }
    } catch (const std::exception& error) {
        fail("is no .vdb file that can be read ({})", error.what());
    }
    if (names_.empty()) fail("holds no grid: name another file");
}

bool VdbFile::has(std::string_view grid) const {
    return std::find(names_.begin(), names_.end(), grid) != names_.end();
}

std::string VdbFile::listing() const {
    std::vector<std::string> all;
    for (std::size_t i = 0; i < names_.size(); ++i) {
        all.push_back(fmt::format("{} ({})", names_[i], types_[i]));
    }
    return fmt::format("{}", fmt::join(all, ", "));
}

openvdb::GridBase::Ptr VdbFile::read(std::string_view grid) const {
    if (!has(grid)) fail("has no grid '{}': it holds {}", grid, listing());
    openvdb::GridBase::Ptr read;
    try {
        openvdb::io::File file(path_.string());
        file.open(/*delayLoad=*/false);
        read = file.readGrid(std::string(grid));
    } catch (const std::exception& error) {
        fail("grid '{}' cannot be read ({})", grid, error.what());
    }
    require_usable(*read);
    return read;
}

void VdbFile::require_usable(const openvdb::GridBase& grid) const {
    if (!grid.transform().isLinear()) {
        fail("grid '{}' has a transform that is not linear ({}): resample it", grid.getName(),
             grid.transform().mapType());
    }
    const double volume = std::abs(grid.transform().voxelVolume());
    if (!(volume > 0 && std::isfinite(volume))) {
        fail("grid '{}' has a transform whose voxels have the volume {}: resample it",
             grid.getName(), volume);
    }
    if (grid.activeVoxelCount() == 0) {
        fail("grid '{}' is empty: it has no active voxel", grid.getName());
    }
    try {
        require_volume(active_box(grid));
    } catch (const InputError& error) {
        fail("grid '{}' lies where nothing can be computed ({}): resample it", grid.getName(),
             error.what());
    }
}

double scale_of(const openvdb::GridBase& grid) {
    const auto note = grid.getMetadata<openvdb::DoubleMetadata>(scale_note);
    const double scale = note ? note->value() : 1;
    return scale > 0 && std::isfinite(scale) ? scale : 1;
}

std::unique_ptr<ControlSpace> scaled(const ControlSpace& field, double scale) {
    class Scaled final : public ControlSpace {
    public:
        Scaled(const ControlSpace& field, double scale) : field_(field), scale_(scale) {}

        void sample(std::span<const Point> x, std::span<Metric> out) const override {
            std::vector<Point> places(x.begin(), x.end());
            for (Point& p : places) p /= scale_;
            field_.sample(places, out);
            for (Metric& m : out) m = scale_ * m;
        }
        Box domain() const override {
            const Box box = field_.domain();
            return {scale_ * box.low, scale_ * box.high};
        }

    private:
        const ControlSpace& field_;
        const double scale_;
    };
    return std::make_unique<Scaled>(field, scale);
}

Box active_box(const openvdb::GridBase& grid) {
    const openvdb::CoordBBox voxels = grid.evalActiveVoxelBoundingBox();
    const Box index{{voxels.min().x() - 0.5, voxels.min().y() - 0.5, voxels.min().z() - 0.5},
                    {voxels.max().x() + 0.5, voxels.max().y() + 0.5, voxels.max().z() + 0.5}};
    std::vector<Point> corners;
    for (int i = 0; i < 8; ++i) {
        const Point p = corner(index, i);
        const openvdb::Vec3d world =
            grid.transform().indexToWorld(openvdb::Vec3d(p.x(), p.y(), p.z()));
        corners.emplace_back(world.x(), world.y(), world.z());
    }
    return bounding_box(corners, 0);
}

}  // namespace controlspace
