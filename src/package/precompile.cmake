# Precompiled headers: what most files include, parsed once for all targets with the same flags.
# Every file still includes what it uses: with a compiler cache, which handles them badly, they are off.
if(CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
endif()

set(precompiled_common
    <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory> <optional> <span> <string> <variant>
    <vector> <Eigen/Core> <fmt/format.h> <tbb/parallel_for.h>)
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/empty.cpp CONTENT "")  # as it was where CMake runs again

# add_precompiled(NAME HEADERS HEADER... LIBRARIES TARGET... PROPERTIES ...): HEADERS and the common ones, for
# precompile(NAME ...).
function(add_precompiled name)
    cmake_parse_arguments(ARG "" "" "HEADERS;LIBRARIES;PROPERTIES" ${ARGN})
    add_library(precompiled_${name} OBJECT EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/empty.cpp)
    target_link_libraries(precompiled_${name} PRIVATE
        controlspace_flags Eigen3::Eigen fmt::fmt TBB::tbb ${ARG_LIBRARIES})
    if(ARG_PROPERTIES)
        set_target_properties(precompiled_${name} PROPERTIES ${ARG_PROPERTIES})
    endif()
    target_precompile_headers(precompiled_${name} PRIVATE ${precompiled_common} ${ARG_HEADERS})
endfunction()

# precompile(NAME TARGET...): the targets are compiled with add_precompiled(NAME ...), which must agree with them
# on position independence and visibility.
function(precompile name)
    foreach(target IN LISTS ARGN)
        target_precompile_headers(${target} REUSE_FROM precompiled_${name})
        if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
            target_include_directories(${target} SYSTEM PRIVATE
                $<TARGET_PROPERTY:precompiled_${name},INCLUDE_DIRECTORIES>)
            target_compile_definitions(${target} PRIVATE
                $<TARGET_PROPERTY:precompiled_${name},COMPILE_DEFINITIONS>)
        endif()
    endforeach()
endfunction()
