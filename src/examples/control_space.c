// SPDX-License-Identifier: Apache-2.0
/* A control space from C: sources request edge lengths at some points, and the control space gives
 * them at every point, before and after it is saved. */
#include <controlspace/controlspace.h>
#include <stdio.h>

static int fail(cspace* space) {
    fprintf(stderr, "controlspace %s: %s\n", cspace_version(), cspace_last_error());
    cspace_free(space);
    return 1;
}

int main(void) {
    const double domain[6] = {-1, -1, -1, 1, 1, 1};
    const double positions[6] = {0.3, 0.2, 0, -1, -1, -1};
    const double lengths[2] = {0.02, 0.05};
    const double places[6] = {0.3, 0.2, 0, 0.9, 0.9, 0.9};
    const cspace_sources sources = {
        .struct_size = sizeof(cspace_sources), .n = 2, .positions = positions, .lengths = lengths};
    /* Lengths within 2.5 %: delta = sqrt(3) (k + 1/k - 2) for a factor k of two lengths. */
    const cspace_options options = {
        .struct_size = sizeof(cspace_options), .growth = 1.25, .delta = 0.001};
    double metrics[12];
    double again[12];
    cspace* space = NULL;
    int i;

    if (cspace_build("K_oV", domain, &sources, &options, NULL, &space) != CSPACE_OK) {
        return fail(space);
    }
    if (cspace_sample(space, 2, places, metrics) != CSPACE_OK) return fail(space);
    printf("length at the source: %.3f, requested: %.3f, far from it: %.3f\n", metrics[0],
           lengths[0], metrics[6]);

    if (cspace_save(space, "field.ctrl") != CSPACE_OK) return fail(space);
    cspace_free(space);
    if (cspace_load("field.ctrl", &space) != CSPACE_OK) return fail(space);
    if (cspace_sample(space, 2, places, again) != CSPACE_OK) return fail(space);
    for (i = 0; i < 12; ++i) {
        if (again[i] != metrics[i]) return 1;
    }
    printf("the same after loading\n");
    cspace_free(space);
    return 0;
}
