// SPDX-License-Identifier: Apache-2.0
#include "io/netcdf/write_netcdf.h"

#include <netcdf.h>

#include <array>
#include <string>
#include <vector>

#include "files/output_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// A file of netCDF that is being written, by its functions that return a status.
class NetcdfFile {
public:
    /// Of 64-bit offsets (CDF-2), which SciPy opens too; of 64-bit data (CDF-5) where a variable
    /// takes 4 GB or more. Neither is HDF5.
    NetcdfFile(const std::filesystem::path& written, const std::filesystem::path& target,
               std::size_t largest_variable)
        : target_(target) {
        constexpr std::size_t most = 4'000'000'000;
        const int form = largest_variable < most ? NC_64BIT_OFFSET : NC_64BIT_DATA;
        require(nc_create(written.string().c_str(), NC_CLOBBER | form, &id_));
    }
    ~NetcdfFile() {
        if (!is_closed_) nc_abort(id_);
    }
    NetcdfFile(const NetcdfFile&) = delete;
    NetcdfFile& operator=(const NetcdfFile&) = delete;

    int id() const { return id_; }
    void require(int status) const {
        if (status == NC_NOERR) return;
        refuse("cannot write {}: {}", target_.string(), nc_strerror(status));
    }
    void close() {
        is_closed_ = true;
        require(nc_close(id_));
    }

private:
    const std::filesystem::path& target_;
    int id_ = -1;
    bool is_closed_ = false;
};

std::vector<double> coordinates(const Raster& raster, std::size_t axis) {
    std::vector<double> values;
    for (std::size_t i = 0; i < (axis == 0 ? raster.columns() : raster.rows()); ++i) {
        values.push_back(raster.at(axis == 0 ? i : 0, axis == 0 ? 0 : i)[raster.axes[axis]]);
    }
    return values;
}

}  // namespace

void write_netcdf(const std::filesystem::path& path, const ControlSpace& space,
                  const Raster& raster, const RasterProgress& progress) {
    require_room(path, raster.size() * sizeof(double));
    OutputFile output(path);
    output.finish();  // the library opens it itself
    NetcdfFile file(output.written(), path, raster.size() * sizeof(double));
    const int id = file.id();
    std::array<int, 2> dimensions{};  // rows, columns
    std::array<int, 2> of_axis{};
    for (const std::size_t axis : {std::size_t{1}, std::size_t{0}}) {
        const std::string name(1, "xyz"[raster.axes[axis]]);
        int& dimension = dimensions[1 - axis];
        file.require(
            nc_def_dim(id, name.c_str(), axis == 0 ? raster.columns() : raster.rows(), &dimension));
        file.require(nc_def_var(id, name.c_str(), NC_DOUBLE, 1, &dimension, &of_axis[axis]));
    }
    int lengths = 0;
    const std::string title = "requested edge length";
    file.require(nc_def_var(id, "h", NC_DOUBLE, 2, dimensions.data(), &lengths));
    file.require(nc_put_att_text(id, lengths, "long_name", title.size(), title.data()));
    file.require(nc_set_fill(id, NC_NOFILL, nullptr));
    file.require(nc_enddef(id));
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
        file.require(nc_put_var_double(id, of_axis[axis], coordinates(raster, axis).data()));
    }
    std::size_t row = 0;
    for_each_band(space, raster, [&](std::span<const double> band) {
        const std::array<std::size_t, 2> start{row, 0};
        const std::array<std::size_t, 2> count{band.size() / raster.columns(), raster.columns()};
        file.require(nc_put_vara_double(id, lengths, start.data(), count.data(), band.data()));
        row += count[0];
        progress(row * raster.columns());
    });
    file.close();
    output.commit();
}

}  // namespace controlspace
