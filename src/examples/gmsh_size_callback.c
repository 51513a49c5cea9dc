// SPDX-License-Identifier: Apache-2.0
/* A control space as the size callback of Gmsh, from C: Gmsh calls the library itself. */
#include <controlspace/controlspace.h>
#include <gmshc.h>
#include <stdio.h>

#if GMSH_API_VERSION_MAJOR > 4 || (GMSH_API_VERSION_MAJOR == 4 && GMSH_API_VERSION_MINOR >= 9)
#define SIZE_CALLBACK cspace_gmsh_size
#define INITIALIZE(error) gmshInitialize(0, NULL, 0, 0, error)
#else
#define SIZE_CALLBACK cspace_gmsh_size_4_8
#define INITIALIZE(error) gmshInitialize(0, NULL, 0, error)
#endif

int main(void) {
    const double domain[6] = {-1, -1, -1, 1, 1, 1};
    const double positions[6] = {0.3, 0.2, 0, -1, -1, -1};
    const double lengths[2] = {0.02, 0.05};
    cspace* space = NULL;
    int error = 0;

    if (cspace_create("K_oV", domain, NULL, &space) != CSPACE_OK ||
        cspace_insert_lengths(space, 2, positions, lengths) != CSPACE_OK ||
        cspace_grade(space, 1.25) != CSPACE_OK) {
        fprintf(stderr, "%s\n", cspace_last_error());
        return 1;
    }
    INITIALIZE(&error);
    gmshModelOccAddBox(-1, -1, -1, 2, 2, 2, -1, &error);
    gmshModelOccSynchronize(&error);
    gmshOptionSetNumber("Mesh.MeshSizeFromPoints", 0, &error);
    gmshOptionSetNumber("Mesh.MeshSizeExtendFromBoundary", 0, &error);
    gmshOptionSetNumber("Mesh.MeshSizeFactor", 0.77, &error);
    gmshModelMeshSetSizeCallback(SIZE_CALLBACK, space, &error);
    gmshModelMeshGenerate(3, &error);
    gmshWrite("mesh.msh", &error);
    gmshFinalize(&error);
    cspace_free(space);
    return error;
}
