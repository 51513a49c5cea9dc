// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <openvdb/Grid.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/io/write_vdb.h"
#include "controlspace/space/control_space.h"
#include "refuse.h"

namespace controlspace {

/// Writes `grids` whole or not at all; returns the file's bytes. Throws InputError, the disk being
/// full among the reasons.
std::uintmax_t write_vdb_file(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
                              VdbCompression compression);

/// `text` without control characters, which names of grids and messages of libraries may contain.
std::string one_line(std::string text);

/// A .vdb file of any program. All errors are InputError and name the file.
class VdbFile {
public:
    /// Throws for what cannot be read as .vdb, or holds no grid.
    explicit VdbFile(const std::filesystem::path& path);

    bool has(std::string_view grid) const;
    /// The grid of that name. Throws, listing what is there, if there is none; for a grid of a type
    /// that OpenVDB does not know; and as `require_usable` does.
    openvdb::GridBase::Ptr read(std::string_view grid) const;
    /// The same as a grid of a type; throws for another one.
    template <class Grid>
    typename Grid::Ptr read_as(std::string_view name) const {
        auto grid = openvdb::gridPtrCast<Grid>(read(name));
        if (!grid) {
            fail("grid '{}' is not of type {}: it holds {}", name,
                 openvdb::typeNameAsString<typename Grid::ValueType>(), listing());
        }
        return grid;
    }
    /// "density (float), sizes (vec3s)".
    std::string listing() const;
    const std::vector<std::string>& grids() const { return names_; }

    template <class... Args>
    [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
        refuse_at(path_, "{}", one_line(fmt::format(text, std::forward<Args>(args)...)));
    }

private:
    /// A grid must have active voxels, and a transform that is linear.
    void require_usable(const openvdb::GridBase& grid) const;

    std::filesystem::path path_;
    std::vector<std::string> names_;
    std::vector<std::string> types_;  ///< of values; "unknown type" where OpenVDB knows none
};

/// Metadatum of a grid whose places and lengths are multiplied by that number.
inline constexpr const char* scale_note = "scale";
/// Metadatum of a grid: whether all metrics of its field are isotropic.
inline constexpr const char* isotropic_note = "isotropic";

/// That number; 1 where there is none.
double scale_of(const openvdb::GridBase& grid);

/// The field with places and lengths multiplied by `scale`; refers to `field`.
std::unique_ptr<ControlSpace> scaled(const ControlSpace& field, double scale);

/// Box of the active voxels, with their extent, in the world.
Box active_box(const openvdb::GridBase& grid);

}  // namespace controlspace
