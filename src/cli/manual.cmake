# Man pages, made from what the program says with --help: controlspace(1), and one of each command.
find_program(HELP2MAN help2man)
if(NOT HELP2MAN)
    return()
endif()
set(commands compare info convert build query export mesh list)

set(script ${CMAKE_CURRENT_SOURCE_DIR}/manual_page.sh)
function(add_man_page page)
    add_custom_command(OUTPUT ${page}
        COMMAND sh ${script} ${HELP2MAN} $<TARGET_FILE:controlspace_app> ${PROJECT_VERSION}
                ${page} ${ARGN}
        DEPENDS controlspace_app ${script}
        VERBATIM)
    set(pages ${pages} ${CMAKE_CURRENT_BINARY_DIR}/${page} PARENT_SCOPE)
endfunction()
add_man_page(controlspace.1)
foreach(command IN LISTS commands)
    add_man_page(controlspace-${command}.1 ${command})
endforeach()

# The same of the pages made from results, whose programs are named so only once they are installed.
function(add_pages_man name says)
    set(page controlspace-${name}.1)
    set(program ${CMAKE_CURRENT_BINARY_DIR}/controlspace-${name})
    file(CREATE_LINK ${PROJECT_SOURCE_DIR}/bench/${name} ${program} SYMBOLIC)
    add_custom_command(OUTPUT ${page}
        COMMAND ${HELP2MAN} --no-info --version-string=${PROJECT_VERSION} --name=${says}
                --output=${page} ${program}
        DEPENDS ${PROJECT_SOURCE_DIR}/bench/pages/${name}_command.py
        VERBATIM)
    set(pages ${pages} ${CMAKE_CURRENT_BINARY_DIR}/${page} PARENT_SCOPE)
endfunction()
add_pages_man(paper "set results beside the paper's tables, cell by cell")
add_pages_man(report "write a page with figures and tables of results")
add_custom_target(man ALL DEPENDS ${pages})
add_dependencies(controlspace_installed man)
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
