#ifndef BATTEN_RESEARCH_MESH_STUDY_H
#define BATTEN_RESEARCH_MESH_STUDY_H

#include "batten/mesh.h"
#include "batten/mesh_refine.h"
#include "batten/research/mesh_train.h"

BAT_C_BEGIN

/// @file
/// The experiments of Liu et al., "Neural Subdivision" (2020), with any shapes: distance of subdivided surfaces from a
/// decimated shape (table 2), ablation of learning (section 6, appendices G and H), and style (figures 26 and 27).
/// docs/results/meshes.md has results.

/// Options of the studies. Begin with bat_mesh_study_defaults().
typedef struct bat_mesh_study_options
{
    size_t vertices; ///< number of vertices of the decimated shape, at least 4; default 400
    size_t levels;   ///< levels of subdivision; default 2
    size_t samples;  ///< samples on each surface, as in bat_mesh_compare_options; default BAT_MESH_SAMPLES
    uint64_t seed;   ///< of trainings; default 1
    uint64_t epochs; ///< of each training, 1 to a billion; default 60
    size_t pairs;    ///< coarse meshes of each training shape, at least 1; default 50
    /// Folder of the trainings, each in a subfolder, as in bat_mesh_train_options. Trainings found there are resumed.
    /// Default null, which studies with training refuse.
    const char *folder;
    int threads; ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_mesh_study_options;

/// The options' default values.
BAT_API bat_mesh_study_options bat_mesh_study_defaults(void);

/// Read a mesh for a study. Polygons are triangulated, and meshes that are not manifold are repaired.
///
/// @param mesh     receives a mesh that bat_mesh_connect() accepts; release it with bat_mesh_free()
/// @param repaired whether bat_mesh_repair() was needed; may be null
/// @param report   receives the report of the repair, all zero if it was not needed; may be null
/// @return BAT_OK, or the status of bat_mesh_read(), bat_mesh_repair() and bat_mesh_connect(); results are untouched on
///        failure
BAT_API bat_status bat_mesh_study_read(const char *path, bat_mesh *mesh, bool *repaired, bat_mesh_repair_report *report,
                                       bat_error *error);

/// The meshes of a folder on which a subdivision can be tested, sorted by name: all but the training shapes of the networks
/// that come with the library and names that begin with "coarse-".
///
/// @param paths receives `count` paths, at least one; release each, and the array, with free()
/// @return BAT_OK, BAT_FILE_ACCESS, BAT_INVALID_ARGUMENT (too long a name) or BAT_NO_MEMORY
BAT_API bat_status bat_mesh_study_list(const char *folder, char ***paths, size_t *count, bat_error *error);

/// A subdivision method.
typedef struct bat_mesh_method
{
    const char *name; ///< not copied
    bat_mesh_scheme scheme;
    const bat_mesh_rule *rule; ///< of BAT_MESH_SCHEME_LEARNED
} bat_mesh_method;

/// The distances between a subdivided surface and the shape.
typedef struct bat_mesh_score
{
    double hausdorff; ///< in the shape's units, as bat_mesh_distance has it
    double mean;      ///< the mean surface distance, both ways
    double diagonal;  ///< of the shape's bounding box
    size_t fallback;  ///< number of insertions for which a learned rule used its classical fallback
} bat_mesh_score;

/// Decimate a shape by quadric errors, subdivide the coarse mesh by each method, and measure the distances from the shape:
/// the experiment of table 2.
///
/// @param shape   a mesh that bat_mesh_connect() accepts
/// @param methods `count` of them, at least 1
/// @param options null for the defaults
/// @param coarse  receives the decimated shape; release it with bat_mesh_free()
/// @param fine    receives `count` subdivided meshes; release each with bat_mesh_free(). May be null
/// @param scores  receives `count` scores
/// @return BAT_OK; BAT_INVALID_ARGUMENT; what bat_mesh_decimate(), bat_mesh_refine() and bat_mesh_compare() return; meshes
/// are
///         empty on failure
BAT_API bat_status bat_mesh_study_shape(const bat_mesh *shape, const bat_mesh_method *methods, size_t count,
                                        const bat_mesh_study_options *options, bat_mesh *coarse, bat_mesh *fine,
                                        bat_mesh_score *scores, bat_error *error);

/// Draw the results of bat_mesh_study_shape() side by side: the coarse mesh, the subdivided meshes with colours for the
/// distance of each vertex from the shape, and the shape.
///
/// @param path  .png, .svg or .pdf
/// @param title title of the picture; may be null
/// @return BAT_OK or the status of bat_mesh_closest() and bat_mesh_picture_write()
BAT_API bat_status bat_mesh_study_draw(const char *path, const char *title, const bat_mesh *shape, const bat_mesh *coarse,
                                       const bat_mesh_method *methods, const bat_mesh *fine, const bat_mesh_score *scores,
                                       size_t count, int threads, bat_error *error);

/// The networks of bat_mesh_ablate(), in its order.
typedef enum bat_mesh_variant
{
    BAT_MESH_VARIANT_FULL,           ///< the published recipe, with cosine decay of the learning rate
    BAT_MESH_VARIANT_FIXED_FRAMES,   ///< "fixed-frames": coordinate axes instead of half-flap frames (section 6, figure 21)
    BAT_MESH_VARIANT_NO_DIFFERENCES, ///< "no-differences": without differential coordinates (appendix H)
    BAT_MESH_VARIANT_LAST_LEVEL,     ///< "last-level": loss of the last level only (appendix H)
    BAT_MESH_VARIANT_CHAMFER,        ///< "chamfer": the Chamfer distance as loss (section 6)
    BAT_MESH_VARIANT_LEARN_LOOP, ///< "learn-loop": the targets are Loop's refinement (appendix G); eight times the epochs
    BAT_MESH_VARIANT_COUNT
} bat_mesh_variant;

/// The results of one training.
typedef struct bat_mesh_ablation_row
{
    const char *variant; ///< "full", "fixed-frames", …
    bat_mesh_train_report report;
    /// The mean distance of the vertices of levels 1 and 2 from their targets, relative to the diagonal of the test shape's
    /// bounding box, over five random decimations. Targets are those of the map, or of Loop's scheme for "learn-loop".
    double errors[BAT_MESH_TRAIN_LEVELS];
    bat_mesh_score straight; ///< scores of bat_mesh_study_shape() on the test shape
    bat_mesh_score
        turned; ///< the same with shape and coarse mesh rotated by one radian; relative to the diagonal before the rotation
} bat_mesh_ablation_row;

/// Train a network in each variant on the same shapes, and evaluate it on another shape.
///
/// @param shapes  training shapes; null for a built-in creature
/// @param count   0 where `shapes` is null
/// @param test    test shape; null for another built-in creature
/// @param options null is refused: there must be a folder
/// @param rows    receives BAT_MESH_VARIANT_COUNT rows
/// @return BAT_OK; BAT_INVALID_ARGUMENT; what bat_mesh_train() and bat_mesh_study_shape() return
BAT_API bat_status bat_mesh_ablate(const bat_mesh *shapes, size_t count, const bat_mesh *test,
                                   const bat_mesh_study_options *options, bat_mesh_ablation_row *rows, bat_error *error);

/// The results of two networks, trained on different shapes, for one cage.
typedef struct bat_mesh_style
{
    bat_mesh smooth, sharp;           ///< the training shapes
    bat_mesh cage;                    ///< the coarse mesh
    bat_mesh by_smooth;               ///< the cage subdivided by the network trained on the smooth shape
    bat_mesh by_sharp;                ///< the cage subdivided by the network trained on the sharp shape
    bat_mesh_train_report reports[2]; ///< smooth, sharp
    /// The fractions of edges of by_smooth and by_sharp at which the face normals differ by more than 60 degrees.
    double sharp_edges[2];
} bat_mesh_style;

/// Train one network on a smooth shape and one on a sharp shape, and subdivide the same cage with both (figures 26 and 27).
///
/// @param smooth,sharp training shapes; null for a built-in stone and bracket
/// @param cage         null for the built-in one
/// @param options      null is refused: there must be a folder
/// @param style        release it with bat_mesh_style_free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT; what bat_mesh_train() and bat_mesh_refine() return; `style` is empty on failure
BAT_API bat_status bat_mesh_style_make(const bat_mesh *smooth, const bat_mesh *sharp, const bat_mesh *cage,
                                       const bat_mesh_study_options *options, bat_mesh_style *style, bat_error *error);

/// Draw the two shapes, and below them the cage and both results.
/// @return BAT_OK or what bat_mesh_picture_write() returns
BAT_API bat_status bat_mesh_style_draw(const char *path, const bat_mesh_style *style, int threads, bat_error *error);

/// Release the meshes and make them empty.
BAT_API void bat_mesh_style_free(bat_mesh_style *style);

/// Options of bat_real_meshes(). Begin with bat_real_meshes_defaults().
typedef struct bat_real_meshes_options
{
    size_t levels;               ///< levels of subdivision, 1 to 6; default 2
    size_t samples;              ///< samples on each surface, as in bat_mesh_compare_options; default 100000
    const bat_mesh_model *model; ///< a further model, with rows "given"; null for none; default null
    int threads;                 ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_real_meshes_options;

/// The options' default values.
BAT_API bat_real_meshes_options bat_real_meshes_defaults(void);

enum
{
    BAT_REAL_MESHES_NAME = 64 ///< the size of names
};

/// A coarse mesh refined by one method, against the shape that it was made from.
typedef struct bat_real_meshes_row
{
    char shape[BAT_REAL_MESHES_NAME], way[BAT_REAL_MESHES_NAME]; ///< "bunny", "cgal"
    size_t vertices;                                             ///< of the coarse mesh
    const char *method;                                          ///< "flat", "butterfly", "loop", "learned", …
    double mean;                                                 ///< mean distance, both ways, over the diagonal
    double hausdorff;                                            ///< over the diagonal
    double relative;   ///< mean distance over the least of flat, butterfly and loop
    double angle;      ///< 95 % quantile of the angles between neighbouring faces, radians
    double true_angle; ///< the same with all vertices moved to the closest points of the shape
    double volume;     ///< error relative to the shape's volume, signed; NaN for an open mesh
} bat_real_meshes_row;

/// Refine coarse meshes made by other programs, and measure their distances from the shapes.
///
/// @param folder has the shapes as SHAPE.obj, SHAPE.ply or SHAPE.off, and the coarse meshes as
///               coarse-by/SHAPE-VERTICES-WAY.off
/// @param rows   receives the rows, mesh by mesh in the order of their files' names; release it with free()
/// @return BAT_OK; BAT_FILE_ACCESS (a folder that cannot be read, without coarse meshes, or without a shape);
///         BAT_INVALID_ARGUMENT; what reading, bat_mesh_refine() and bat_mesh_compare() return; BAT_CANCELLED; results are
///         untouched on failure
BAT_API bat_status bat_real_meshes(const char *folder, const bat_real_meshes_options *options, bat_real_meshes_row **rows,
                                   size_t *count, bat_error *error);

BAT_C_END

#endif
