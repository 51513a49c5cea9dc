# The find module for OpenVDB comes with OpenVDB's package; the folder's name holds the
# architecture.
file(GLOB openvdb_modules LIST_DIRECTORIES true
     /usr/lib/*/cmake/OpenVDB /usr/local/lib/cmake/OpenVDB /usr/lib64/cmake/OpenVDB)
list(APPEND CMAKE_MODULE_PATH ${openvdb_modules})
