# Installation of libraries and their public headers, as a package for CMake.
include(GNUInstallDirs)
set(controlspace_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/controlspace)
set(controlspace_staged_headers ${PROJECT_BINARY_DIR}/include)

# install_library(TARGET COMPONENT NAME [SHARES_STATICS] [HEADERS FILE...]): TARGET is installed as
# controlspace::NAME, which comes with the component COMPONENT of the package. HEADERS are those
# that users may include, relative to src/ (or to the project, baselines); they must be complete
# with what they include. SHARES_STATICS: its inline variables are those of a shared library that it
# includes, and must not be hidden (OpenVDB's registry of grids crashes otherwise).
function(install_library target)
    cmake_parse_arguments(ARG "SHARES_STATICS" "COMPONENT;NAME" "HEADERS" ${ARGN})
    # Static, and fit for a user's shared library, which then shows nothing of it.
    set_target_properties(${target} PROPERTIES
        EXPORT_NAME ${ARG_NAME}
        POSITION_INDEPENDENT_CODE ON)
    if(NOT ARG_SHARES_STATICS)
        set_target_properties(${target} PROPERTIES
            CXX_VISIBILITY_PRESET hidden
            VISIBILITY_INLINES_HIDDEN ON)
    endif()
    add_library(controlspace::${ARG_NAME} ALIAS ${target})
    install(TARGETS ${target} EXPORT controlspace-${ARG_COMPONENT} COMPONENT library)
    set_property(GLOBAL APPEND PROPERTY controlspace_public_headers ${ARG_HEADERS})
    get_property(components GLOBAL PROPERTY controlspace_components)
    if(NOT ARG_COMPONENT IN_LIST components)
        set_property(GLOBAL APPEND PROPERTY controlspace_components ${ARG_COMPONENT})
    endif()
endfunction()
