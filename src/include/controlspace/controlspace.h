/* Control spaces for meshers in C and Fortran: a metric at every point of a box, learnt from point
 * sources.
 *
 * A metric is six numbers, xx yy zz xy xz yz, of the symmetric tensor M whose eigenvalues are the
 * desired edge lengths along its eigenvectors, in the unit of length of the domain: h on the
 * diagonal for the same length h in every direction. (The tensor of Riemannian meshers is M^-2:
 * cspace_to_riemannian(), cspace_from_riemannian().) Positions are three numbers, x y z, none of
 * them NaN. Arrays hold one after the other, without gaps, and stay the caller's.
 *
 * Functions that can fail return a cspace_status, and cspace_last_error() says what went wrong, in
 * one line. No exception leaves them, nothing is printed. A control space may be read by several
 * threads at a time as long as none writes to it. */
#ifndef CONTROLSPACE_CONTROLSPACE_H
#define CONTROLSPACE_CONTROLSPACE_H

#include <stddef.h>

#if defined(__GNUC__)
#define CSPACE_API __attribute__((visibility("default")))
#else
#define CSPACE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** A control space; to be freed by cspace_free(). */
typedef struct cspace cspace;

/** What a function returns. */
typedef enum cspace_status {
    CSPACE_OK = 0,
    CSPACE_FAILURE = 1,  /**< of the system or of the library: out of memory */
    CSPACE_BAD_INPUT = 2 /**< something that was given cannot be used */
} cspace_status;

/** The library's version, "MAJOR.MINOR.PATCH". */
CSPACE_API const char* cspace_version(void);

/** What the last function that failed on this thread had to say; "" if none did. Valid until the
 * next one fails on this thread. */
CSPACE_API const char* cspace_last_error(void);

/** Makes a control space, which holds half of its domain's diagonal as the length everywhere.
 *
 * @param structure  its name in the catalogue, "K_oV"; cspace_structure() lists them
 * @param domain     its box: x0 y0 z0 x1 y1 z1
 * @param options    "" or NULL for the defaults, or some of these, as in "tau=0.5 split=s_G":
 *                   split (of kd-trees: s_L, s_G, s_Gx, s_M), tau (longest edge of a source's
 *                   leaf, in the source's metric), epsilon (tolerance of insertion), kd_depth,
 *                   octree_depth, finest_length (smallest length that sources ask for: grids size
 *                   their voxels by it), voxel (their longest edge), g_r (gradation ratio, for
 *                   structures that keep sources), takes_later_sources (1: sources may come after
 *                   gradation), max_memory (GiB)
 * @param space      where to put it; NULL after a failure */
CSPACE_API cspace_status cspace_create(const char* structure, const double* domain,
                                       const char* options, cspace** space);

/** Name of the structure number `i`, from 0 on; NULL beyond the last. */
CSPACE_API const char* cspace_structure(size_t i);

/** Frees a control space; NULL is allowed. */
CSPACE_API void cspace_free(cspace* space);

/** Inserts `n` sources: metrics that are asked for at places in the domain. A source that is
 * refused leaves those before it. */
CSPACE_API cspace_status cspace_insert(cspace* space, size_t n, const double* positions,
                                       const double* metrics);

/** The same for lengths that are alike in every direction, one for each source. */
CSPACE_API cspace_status cspace_insert_lengths(cspace* space, size_t n, const double* positions,
                                               const double* lengths);

/** Makes the field grow smoothly, by a ratio of neighbours of at most `ratio` (g_r >= 1). To be
 * called once all sources are inserted, unless the space takes later ones. */
CSPACE_API cspace_status cspace_grade(cspace* space, double ratio);

/** In place of insertion and gradation: replaces all that the space holds by the field of `n`
 * sources, whose lengths grow by `ratio` (g_r >= 1) with the distance, and cuts a tree until it
 * keeps within a non-conformity (delta) of `target` to it (above 0; 0.1 say). `reached`, unless
 * NULL, gets the largest delta that was found. */
CSPACE_API cspace_status cspace_adapt(cspace* space, size_t n, const double* positions,
                                      const double* metrics, double ratio, double target,
                                      double* reached);

/** Metrics at `n` places; outside the domain, that of its nearest place. Many places in one call
 * are far faster than one by one. */
CSPACE_API cspace_status cspace_sample(const cspace* space, size_t n, const double* positions,
                                       double* metrics);

/** The Riemannian metrics M^-2 of `n` metrics M, and the way back; numbers in the same order, xx yy
 * zz xy xz yz. Both arrays may be the same. Refused, by its index, is what is not positive
 * definite; those before it are converted. */
CSPACE_API cspace_status cspace_to_riemannian(size_t n, const double* metrics, double* riemannian);
CSPACE_API cspace_status cspace_from_riemannian(size_t n, const double* riemannian,
                                                double* metrics);

/** The domain: x0 y0 z0 x1 y1 z1. */
CSPACE_API cspace_status cspace_domain(const cspace* space, double* domain);

/** Saves a control space to a .ctrl file, whole or not at all. */
CSPACE_API cspace_status cspace_save(const cspace* space, const char* file);

/** Loads a control space that was saved, to be freed as one that was made; NULL after a failure. */
CSPACE_API cspace_status cspace_load(const char* file, cspace** space);

#ifdef __cplusplus
}
#endif

#endif
