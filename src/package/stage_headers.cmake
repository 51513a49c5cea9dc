# cmake -DSOURCE_DIR= -DOUTPUT= -DHEADERS= -P stage_headers.cmake: lays out public headers as they
# are installed, under OUTPUT/controlspace. There they include each other by names that begin with
# controlspace/, so that no folder of a user's own can come in between.
file(REMOVE_RECURSE ${OUTPUT}/controlspace)
foreach(header IN LISTS HEADERS)
    if(header MATCHES "^baselines/")
        set(path ${SOURCE_DIR}/${header})
    else()
        set(path ${SOURCE_DIR}/src/${header})
    endif()
    file(READ ${path} text)
    string(REGEX REPLACE "(#include \")([a-z_/]+\\.h\")" "\\1controlspace/\\2" text "${text}")
    string(REGEX REPLACE "^c/" "" header ${header})  # the C header's name is short
    file(WRITE ${OUTPUT}/controlspace/${header} "${text}")
endforeach()
