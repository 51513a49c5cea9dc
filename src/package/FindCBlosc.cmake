# Blosc (version 1), whose package has no module for CMake: the target CBlosc::blosc. Not by the
# name of the module that comes with OpenVDB.
find_path(CBLOSC_INCLUDE_DIR blosc.h)
find_library(CBLOSC_LIBRARY blosc)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CBlosc
    REQUIRED_VARS CBLOSC_LIBRARY CBLOSC_INCLUDE_DIR
    REASON_FAILURE_MESSAGE "install libblosc-dev")
mark_as_advanced(CBLOSC_INCLUDE_DIR CBLOSC_LIBRARY)
if(CBlosc_FOUND AND NOT TARGET CBlosc::blosc)
    add_library(CBlosc::blosc UNKNOWN IMPORTED)
    set_target_properties(CBlosc::blosc PROPERTIES
        IMPORTED_LOCATION ${CBLOSC_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${CBLOSC_INCLUDE_DIR})
endif()
