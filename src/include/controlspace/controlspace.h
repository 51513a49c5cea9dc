// SPDX-License-Identifier: Apache-2.0
/* Control spaces for mesh generators in C and Fortran: a metric at every point of a box, built from
 * point sources.
 *
 * A metric is six numbers, xx yy zz xy xz yz, of the symmetric positive definite tensor M whose
 * eigenvalues are LENGTHS: the desired edge lengths along its eigenvectors, in the unit of length
 * of the domain. The isotropic metric of length h has h on the diagonal and zeros elsewhere.
 *
 * M is not the Riemannian metric of most mesh generators, whose eigenvalues are 1/h^2: that is
 * M^-2. cspace_to_riemannian() and cspace_from_riemannian() convert; all other functions take and
 * return M.
 *
 * Points are three numbers, x y z. Arrays hold one point or metric after the other, without gaps,
 * and remain the caller's.
 *
 * Functions that can fail return a cspace_status; cspace_last_error() returns the reason, in one
 * line. No exception leaves the library and nothing is printed. Several threads may read a control
 * space at the same time as long as none changes it. */
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

/* NOLINTBEGIN(readability-identifier-naming): names as C has them */

/** A control space, and the structure that it is built from. To be freed by cspace_free(). */
typedef struct cspace cspace;

/** Result of a function. */
typedef enum cspace_status {
    CSPACE_OK = 0,
    CSPACE_FAILURE = 1,  /**< the system or the library failed: out of memory */
    CSPACE_BAD_INPUT = 2 /**< an argument cannot be used */
} cspace_status;

/** The library's version, "MAJOR.MINOR.PATCH". */
CSPACE_API const char* cspace_version(void);

/** The reason why the last function on this thread that failed did so; "" if none failed. Valid
 * until the next failure on this thread. */
CSPACE_API const char* cspace_last_error(void);

/** Which of the sources, positions or metrics given that failure was about, from 0;
 * CSPACE_NO_INDEX if it was about none of them. */
CSPACE_API size_t cspace_last_error_index(void);
#define CSPACE_NO_INDEX ((size_t)-1)

/** The bytes that a structure would have taken, where it was to outgrow max_memory; otherwise 0. */
CSPACE_API size_t cspace_last_error_bytes(void);

/** Sources in arrays that need not all be there: members that are 0 are not, and later versions may
 * add some at the end. */
typedef struct cspace_sources {
    size_t struct_size;      /**< sizeof(cspace_sources), as the caller knows it */
    size_t n;                /**< number of sources */
    const double* positions; /**< n points */
    const double* metrics;   /**< n metrics M, unless there are lengths */
    const double* lengths;   /**< n lengths, of isotropic sources */
    const double* growths; /**< NULL, or n gradation ratios of the sources' own, 1 or more; 0: that
                                of the field. They need the exact field: structures that hold
                                metrics refuse them once they were adapted, or loaded, without
                                takes_later_sources. */
} cspace_sources;

/** Options of cspace_build(). Members that are 0 have their defaults; later versions may add some
 * at the end, therefore:
 *
 *     cspace_options options = {.struct_size = sizeof(cspace_options)};
 *     options.growth = 1.2; */
typedef struct cspace_options {
    size_t struct_size; /**< sizeof(cspace_options), as the caller knows it */
    double growth;      /**< gradation ratio g_r of the sources, >= 1 (default: 1.25) */
    double delta;       /**< largest non-conformity to the exact field that the structure is adapted
                             to, above 0, of tensors also of each direction alone; 0: sources are
                             inserted and graded, which is faster and less accurate */
    double max_memory;  /**< [GiB] (default: 4) */
    const char* further; /**< others, as of cspace_create(); may be NULL. Growth is g_r there, and
                            is given once */
    int* stop; /**< NULL, or a number, 0 at first: soon after another thread or a signal handler has
                    set it to 1, cspace_build() ends with CSPACE_FAILURE. With takes_later_sources=1
                    it must outlive the space, whose insertion and adaptation it ends as well */
} cspace_options;

/** Builds the field of sources in one step: creates a control space, and inserts and grades the
 * sources, or adapts it to them. It is only read from then on, which takes less time and, where
 * all is isotropic, less memory: further sources, gradation and adaptation are refused, unless
 * options->further has takes_later_sources=1.
 *
 *     cspace_sources sources = {.struct_size = sizeof(cspace_sources)};
 *     sources.n = n, sources.positions = positions, sources.lengths = lengths;
 *
 * @param structure, domain  as of cspace_create()
 * @param sources  inside the domain, with lengths or metrics, not both
 * @param options  may be NULL
 * @param reached  unless NULL receives what cspace_adapt() says; NaN where nothing was adapted
 * @param space    receives the control space; NULL after a failure */
CSPACE_API cspace_status cspace_build(const char* structure, const double* domain,
                                      const cspace_sources* sources, const cspace_options* options,
                                      double* reached, cspace** space);

/** Creates a control space. Before the first source, its metric is isotropic everywhere; the length
 * is half of the domain's diagonal, or h_max if that is less.
 *
 * @param structure  id of the data structure, "K_oV"; cspace_structure() lists them
 * @param domain     the box: x0 y0 z0 x1 y1 z1; a plane where low and high are equal along one axis
 * @param options    "" or NULL for the defaults, or some of these, as in "tau=0.5 split=s_G":
 *                   split (split rule of kd-trees: s_L, s_G, s_Gx, s_M), tau (maximum leaf edge:
 *                   longest edge of a source's leaf, in the source's metric), epsilon (insertion
 *                   tolerance), kd_depth, octree_depth (maximum depth; the root has depth 0),
 *                   finest_length (smallest length of the sources [length]: grids choose their
 *                   voxels by it), voxel (longest edge of a grid's voxels [length]), h_max (largest
 *                   length anywhere), g_r (gradation ratio), takes_later_sources (1: sources may
 *                   be inserted after gradation or adaptation, which cspace_grade() repeats with
 *                   all sources), max_memory [GiB]
 * @param space      receives the control space; NULL after a failure */
CSPACE_API cspace_status cspace_create(const char* structure, const double* domain,
                                       const char* options, cspace** space);

/** Id of data structure number `i`, from 0; NULL beyond the last. */
CSPACE_API const char* cspace_structure(size_t i);

/** Frees a control space; NULL is allowed. */
CSPACE_API void cspace_free(cspace* space);

/** Inserts `n` sources: metrics M requested at points of the domain. If a source is refused, those
 * before it are inserted. */
CSPACE_API cspace_status cspace_insert(cspace* space, size_t n, const double* positions,
                                       const double* metrics);

/** The same for isotropic sources: one length each. */
CSPACE_API cspace_status cspace_insert_lengths(cspace* space, size_t n, const double* positions,
                                               const double* lengths);

/** Inserts sources, as cspace_insert() does. */
CSPACE_API cspace_status cspace_insert_sources(cspace* space, const cspace_sources* sources);

/** Limits the growth of lengths from point to point to the gradation ratio `ratio` (g_r >= 1; 0:
 * the g_r that it was created with): the control nodes get the exact field of the sources inserted.
 * To be called after all sources are inserted, unless the control space takes later sources: then
 * it gives the field of all sources at once, and adapts again what was adapted, with this ratio. */
CSPACE_API cspace_status cspace_grade(cspace* space, double ratio);

/** Replaces the whole content, instead of insertion and gradation, by the graded field of `n`
 * sources with metrics M, whose lengths grow with the distance by `ratio` (as of cspace_grade()); a
 * tree is refined until its non-conformity (delta) to that field is at most `target` (above 0, for
 * example 0.1). `reached`, unless NULL, receives the largest delta found, above `target` if that
 * was missed; infinity where a tree could not show that it was met. */
CSPACE_API cspace_status cspace_adapt(cspace* space, size_t n, const double* positions,
                                      const double* metrics, double ratio, double target,
                                      double* reached);

/** The same for sources with ratios of their own. */
CSPACE_API cspace_status cspace_adapt_sources(cspace* space, const cspace_sources* sources,
                                              double ratio, double target, double* reached);

/** Metrics M at `n` points; a point outside the domain gets the metric of the nearest point of the
 * domain. A coordinate that is NaN is refused, and nothing is written. Many points in one call are
 * far faster than one by one; from 100000 on all cores are used, here and in the functions below.
 */
CSPACE_API cspace_status cspace_sample(const cspace* space, size_t n, const double* positions,
                                       double* metrics);

/** The smallest length that the metric requests in any direction, at each of `n` points; otherwise
 * as cspace_sample(). */
CSPACE_API cspace_status cspace_sample_lengths(const cspace* space, size_t n,
                                               const double* positions, double* lengths);

/** The same at one point; NaN if a coordinate is NaN, and after a failure. */
CSPACE_API double cspace_size(const cspace* space, double x, double y, double z);

/** Metric lengths of `n` straight edges: the integral of |M^-1 dx| along each by Simpson's rule,
 * from the metrics at both ends and in the middle. An edge as long as requested has length 1. */
CSPACE_API cspace_status cspace_edge_lengths(const cspace* space, size_t n, const double* from,
                                             const double* to, double* lengths);

/** The size callback of Gmsh 4.9 and later; `data` is the control space, which must outlive it:
 *
 *     gmshModelMeshSetSizeCallback(cspace_gmsh_size, space, &error);
 *     gmshOptionSetNumber("Mesh.MeshSizeExtendFromBoundary", 0, &error);
 *
 * It returns cspace_size(), or `lc`, the size that Gmsh has from elsewhere, where that is smaller
 * and where there is none. Gmsh makes edges longer than its size field: a Mesh.MeshSizeFactor of
 * 0.77, or 0.70 with HXT, compensates. Several threads may call it. */
CSPACE_API double cspace_gmsh_size(int dim, int tag, double x, double y, double z, double lc,
                                   void* data);

/** The same for Gmsh 4.8, which passes no `lc`. */
CSPACE_API double cspace_gmsh_size_4_8(int dim, int tag, double x, double y, double z, void* data);

/** Converts `n` metrics M to Riemannian metrics M^-2, and back; six numbers each, in the same
 * order, xx yy zz xy xz yz. Both arrays may be the same. A tensor that is not positive definite is
 * refused with its index; those before it are converted. */
CSPACE_API cspace_status cspace_to_riemannian(size_t n, const double* metrics, double* riemannian);
CSPACE_API cspace_status cspace_from_riemannian(size_t n, const double* riemannian,
                                                double* metrics);

/** The domain: x0 y0 z0 x1 y1 z1. */
CSPACE_API cspace_status cspace_domain(const cspace* space, double* domain);

/** Saves a control space to a .ctrl file, or one of openvdb-tiles or openvdb-bricks, whose lengths
 * are then floats, to a .vdb. If that fails, no part of a file is left. */
CSPACE_API cspace_status cspace_save(const cspace* space, const char* file);

/** Loads a saved control space, to be freed by cspace_free(); NULL after a failure. One that was
 * only read is only read again. */
CSPACE_API cspace_status cspace_load(const char* file, cspace** space);

/** Loads an octree that ranks of MPI wrote in pieces, from its index (.pctrl), to be read. Of a
 * region, x0 y0 z0 x1 y1 z1, only the pieces that answer in it are loaded, and it is the domain:
 * for a process that meshes a part. NULL: all of them. */
CSPACE_API cspace_status cspace_load_pieces(const char* index, const double* region,
                                            cspace** space);

/* NOLINTEND(readability-identifier-naming) */

#ifdef __cplusplus
}
#endif

#endif
