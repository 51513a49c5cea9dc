# Gmsh's library.
include(${CMAKE_CURRENT_LIST_DIR}/find_one_library.cmake)
find_one_library(Gmsh::Gmsh gmsh.h gmsh
    "install libgmsh-dev, or configure with -DCONTROLSPACE_GMSH=OFF")
