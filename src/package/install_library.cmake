# Installation of libraries and their public headers, as a package for CMake.
include(GNUInstallDirs)
set(controlspace_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/controlspace)
# Shared libraries that are loaded when they are needed (src/modules): the same place relative to the program
# where it is installed and in the build folder.
file(RELATIVE_PATH controlspace_modules_from_program
    ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/controlspace)
set(controlspace_modules_folder ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${controlspace_modules_from_program})
# The public headers, which include nothing but each other.
set(controlspace_headers ${PROJECT_SOURCE_DIR}/src/include)

# `cmake --install` builds what is missing: bench/run, for one, builds nothing but the program.
add_custom_target(controlspace_installed)
foreach(component IN ITEMS Unspecified program library)
    install(CODE "execute_process(
        COMMAND \"${CMAKE_COMMAND}\" --build \"${CMAKE_BINARY_DIR}\" --target controlspace_installed
        COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
endforeach()

# install_library(TARGET COMPONENT NAME [SHARES_STATICS]): TARGET is installed as
# controlspace::NAME, which comes with the component COMPONENT of the package. SHARES_STATICS: its
# inline variables are those of a shared library that it
# includes, and must not be hidden (OpenVDB's registry of grids crashes otherwise).
function(install_library target)
    cmake_parse_arguments(ARG "SHARES_STATICS" "COMPONENT;NAME" "" ${ARGN})
    # Static, and fit for a user's shared library, which then shows nothing of it.
    set_target_properties(${target} PROPERTIES
        EXPORT_NAME ${ARG_NAME}
        POSITION_INDEPENDENT_CODE ON)
    set(group library)
    if(ARG_SHARES_STATICS)
        set(group openvdb)
    else()
        set_target_properties(${target} PROPERTIES
            CXX_VISIBILITY_PRESET hidden
            VISIBILITY_INLINES_HIDDEN ON)
    endif()
    precompile(${group} ${target})
    add_library(controlspace::${ARG_NAME} ALIAS ${target})
    add_dependencies(controlspace_installed ${target})
    install(TARGETS ${target} EXPORT controlspace-${ARG_COMPONENT} COMPONENT library)
    get_property(components GLOBAL PROPERTY controlspace_components)
    if(NOT ARG_COMPONENT IN_LIST components)
        set_property(GLOBAL APPEND PROPERTY controlspace_components ${ARG_COMPONENT})
    endif()
endfunction()
