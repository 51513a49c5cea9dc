# The C library of netCDF: the target NetcdfC::netcdf. Its own module for CMake also looks for HDF5.
find_path(NETCDFC_INCLUDE_DIR netcdf.h)
find_library(NETCDFC_LIBRARY netcdf)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(NetcdfC
    REQUIRED_VARS NETCDFC_LIBRARY NETCDFC_INCLUDE_DIR
    REASON_FAILURE_MESSAGE "install libnetcdf-dev, or configure with -DCONTROLSPACE_NETCDF=OFF")
mark_as_advanced(NETCDFC_INCLUDE_DIR NETCDFC_LIBRARY)
if(NetcdfC_FOUND AND NOT TARGET NetcdfC::netcdf)
    add_library(NetcdfC::netcdf UNKNOWN IMPORTED)
    set_target_properties(NetcdfC::netcdf PROPERTIES
        IMPORTED_LOCATION ${NETCDFC_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${NETCDFC_INCLUDE_DIR})
endif()
