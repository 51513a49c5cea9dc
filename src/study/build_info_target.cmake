# Writes at every build which commit is built. Sets CONTROLSPACE_BUILD_INFO to the source.
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
get_target_property(build_flags controlspace_flags INTERFACE_COMPILE_OPTIONS)
list(FILTER build_flags EXCLUDE REGEX "^-W|^\\$")
list(TRANSFORM build_flags REPLACE ">$" "")  # where a generator expression ends
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
        -P ${CMAKE_CURRENT_SOURCE_DIR}/build_info.cmake
    VERBATIM COMMENT "")
set(CONTROLSPACE_BUILD_INFO ${CMAKE_CURRENT_BINARY_DIR}/build_info.cpp)
