# Writes OUTPUT from build_info.cpp.in; run at every build, and touches OUTPUT only where it changes.
set(COMMIT "unknown")
set(DIRTY "false")
find_package(Git QUIET)
if(GIT_FOUND)
    execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse HEAD
        WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE
        RESULT_VARIABLE failed ERROR_QUIET)
    if(NOT failed)
        set(COMMIT ${commit})
        execute_process(COMMAND ${GIT_EXECUTABLE} status --porcelain --untracked-files=no -- . :!bench/results
            WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE changes ERROR_QUIET)
        if(changes)
            set(DIRTY "true")
        endif()
    endif()
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/build_info.cpp.in ${OUTPUT} @ONLY)
