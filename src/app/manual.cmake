# Man pages, made from what the program says with --help: controlspace(1), and one of each command.
find_program(HELP2MAN help2man)
if(NOT HELP2MAN)
    return()
endif()
set(commands compare paper report info convert build query export list)
if(CONTROLSPACE_GMSH)
    list(APPEND commands mesh)
endif()

set(program $<TARGET_FILE:controlspace_app>)
function(add_man_page page title)
    add_custom_command(OUTPUT ${page}
        COMMAND ${HELP2MAN} --no-info --version-string=${PROJECT_VERSION} --name=${title}
                --output=${page} "${program} ${ARGN}"
        DEPENDS controlspace_app
        VERBATIM)
    set(pages ${pages} ${CMAKE_CURRENT_BINARY_DIR}/${page} PARENT_SCOPE)
endfunction()
add_man_page(controlspace.1 "compare control spaces for mesh generation")
foreach(command IN LISTS commands)
    add_man_page(controlspace-${command}.1 "${command}, of controlspace" ${command})
endforeach()
add_custom_target(man ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
