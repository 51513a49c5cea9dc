# The C library of netCDF, whose own module for CMake also looks for HDF5.
include(${CMAKE_CURRENT_LIST_DIR}/find_one_library.cmake)
find_one_library(NetcdfC::netcdf netcdf.h netcdf
    "install libnetcdf-dev, or configure with -DCONTROLSPACE_NETCDF=OFF")
