# For packages without a module of CMake: `target` is the library with its header; without them find_package fails
# with `advice`.
include(FindPackageHandleStandardArgs)
macro(find_one_library target header library advice)
    find_path(${CMAKE_FIND_PACKAGE_NAME}_INCLUDE_DIR ${header})
    find_library(${CMAKE_FIND_PACKAGE_NAME}_LIBRARY ${library})
    find_package_handle_standard_args(${CMAKE_FIND_PACKAGE_NAME}
        REQUIRED_VARS ${CMAKE_FIND_PACKAGE_NAME}_LIBRARY ${CMAKE_FIND_PACKAGE_NAME}_INCLUDE_DIR
        REASON_FAILURE_MESSAGE ${advice})
    mark_as_advanced(${CMAKE_FIND_PACKAGE_NAME}_INCLUDE_DIR ${CMAKE_FIND_PACKAGE_NAME}_LIBRARY)
    if(${CMAKE_FIND_PACKAGE_NAME}_FOUND AND NOT TARGET ${target})
        add_library(${target} UNKNOWN IMPORTED)
        set_target_properties(${target} PROPERTIES
            IMPORTED_LOCATION ${${CMAKE_FIND_PACKAGE_NAME}_LIBRARY}
            INTERFACE_INCLUDE_DIRECTORIES ${${CMAKE_FIND_PACKAGE_NAME}_INCLUDE_DIR})
    endif()
endmacro()
