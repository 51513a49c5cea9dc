# Blosc (version 1). Not by the name of the module that comes with OpenVDB.
include(${CMAKE_CURRENT_LIST_DIR}/find_one_library.cmake)
find_one_library(CBlosc::blosc blosc.h blosc "install libblosc-dev")
