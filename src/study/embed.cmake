# Sources that are written by the build: data files as text, and which commit is built.
# Sets CONTROLSPACE_EMBEDDED to their names.
set(embedded_data ${PROJECT_SOURCE_DIR}/data/studies/paper-sphere-quick.toml)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${embedded_data})
file(READ ${PROJECT_SOURCE_DIR}/data/studies/paper-sphere-quick.toml QUICK_STUDY)
configure_file(study/embedded.cpp.in ${CMAKE_CURRENT_BINARY_DIR}/embedded.cpp @ONLY)

string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
get_target_property(build_flags controlspace_flags INTERFACE_COMPILE_OPTIONS)
list(FILTER build_flags EXCLUDE REGEX "^-W|^\\$")
list(JOIN build_flags " " build_flags)
string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}} ${build_flags}" build_flags)
add_custom_target(controlspace_build_info
    BYPRODUCTS ${CMAKE_CURRENT_BINARY_DIR}/build_info.cpp
    COMMAND ${CMAKE_COMMAND}
        -DSOURCE_DIR=${PROJECT_SOURCE_DIR}
        -DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/build_info.cpp
        -DVERSION=${PROJECT_VERSION}
        "-DCOMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
        "-DFLAGS=${build_flags}"
        -P ${CMAKE_CURRENT_SOURCE_DIR}/study/build_info.cmake
    VERBATIM COMMENT "")
set(CONTROLSPACE_EMBEDDED
    ${CMAKE_CURRENT_BINARY_DIR}/build_info.cpp
    ${CMAKE_CURRENT_BINARY_DIR}/embedded.cpp)
