#ifndef BATTEN_RESEARCH_MESH_STUDY_H
#define BATTEN_RESEARCH_MESH_STUDY_H

#include "batten/mesh.h"
#include "batten/mesh_refine.h"
#include "batten/research/mesh_train.h"

BAT_C_BEGIN

/// @file
/// The experiments of Liu et al., "Neural Subdivision" (2020), with any shapes: how near subdivision comes to a shape that
/// was decimated (table 2), what learning makes of its parts (section 6, appendices G and H), and style (figures 26 and 27).
/// docs/mesh-figures.md has results.

/// How to study. Begin with bat_mesh_study_defaults().
typedef struct bat_mesh_study_options
{
    size_t vertices; ///< that a shape is decimated to before it is subdivided, at least 4; default 400
    size_t levels;   ///< of subdivision; default 2
    size_t samples;  ///< on each surface, as in bat_mesh_compare_options; default BAT_MESH_SAMPLES
    uint64_t seed;   ///< of trainings; default 1
    uint64_t epochs; ///< of each training, 1 to a billion; default 60
    size_t pairs;    ///< coarse meshes of each training shape, at least 1; default 50
    /// Where trainings are kept, each in a folder of its own, as in bat_mesh_train_options. What is there already is gone on
    /// with. Default null, which studies that train refuse.
    const char *folder;
    int threads; ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_mesh_study_options;

/// The options' default values.
BAT_API bat_mesh_study_options bat_mesh_study_defaults(void);

/// Read a mesh that studies can use: polygons are cut into triangles, and what is no manifold is repaired.
///
/// @param mesh     what bat_mesh_connect() accepts; release it with bat_mesh_free()
/// @param repaired whether bat_mesh_repair() was needed; may be null
/// @param report   receives what it did, all zero where it was not needed; may be null
/// @return BAT_OK, or what bat_mesh_read(), bat_mesh_repair() and bat_mesh_connect() return; results are untouched on
/// failure
BAT_API bat_status bat_mesh_study_read(const char *path, bat_mesh *mesh, bool *repaired, bat_mesh_repair_report *report,
                                       bat_error *error);

/// A way to subdivide.
typedef struct bat_mesh_method
{
    const char *name; ///< stays the caller's
    bat_mesh_scheme scheme;
    const bat_mesh_rule *rule; ///< of BAT_MESH_SCHEME_LEARNED
} bat_mesh_method;

/// How near a method came to a shape.
typedef struct bat_mesh_score
{
    double hausdorff; ///< in the shape's units, as bat_mesh_distance has it
    double mean;      ///< the mean surface distance, both ways
    double diagonal;  ///< of the shape's bounding box
    size_t fallback;  ///< places where a learned rule fell back to a classical one
} bat_mesh_score;

/// Decimate a shape by quadric errors, subdivide what is left by each method, and measure how far that is from the shape:
/// the experiment of table 2.
///
/// @param shape   what bat_mesh_connect() accepts
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

/// Draw what bat_mesh_study_shape() made, side by side: the coarse mesh, the subdivided ones in colours that tell how far
/// each vertex is from the shape, and the shape.
///
/// @param path  .png, .svg or .pdf
/// @param title above the picture; may be null
/// @return BAT_OK or what bat_mesh_closest() and bat_mesh_picture_write() return
BAT_API bat_status bat_mesh_study_draw(const char *path, const char *title, const bat_mesh *shape, const bat_mesh *coarse,
                                       const bat_mesh_method *methods, const bat_mesh *fine, const bat_mesh_score *scores,
                                       size_t count, int threads, bat_error *error);

/// The networks of bat_mesh_ablate(), in its order.
typedef enum bat_mesh_variant
{
    BAT_MESH_FULL,           ///< the published recipe, its rate falling
    BAT_MESH_FIXED_FRAMES,   ///< "fixed-frames": the axes of space instead of half-flaps' frames (section 6, figure 21)
    BAT_MESH_NO_DIFFERENCES, ///< "no-differences": without differential coordinates (appendix H)
    BAT_MESH_LAST_LEVEL,     ///< "last-level": the loss is that of the last level alone (appendix H)
    BAT_MESH_CHAMFER,        ///< "chamfer": the Chamfer distance as loss (section 6)
    BAT_MESH_LEARN_LOOP,     ///< "learn-loop": the targets are Loop's refinement (appendix G); eight times the epochs
    BAT_MESH_VARIANT_COUNT
} bat_mesh_variant;

/// What became of one training.
typedef struct bat_mesh_ablation_row
{
    const char *variant; ///< "full", "fixed-frames", …
    bat_mesh_train_report report;
    /// The mean distance of a vertex of levels 1 and 2 from its target, as share of the diagonal of the test shape's box,
    /// over five random decimations of it. Targets are those of the map, or those of Loop's scheme for "learn-loop".
    double errors[BAT_MESH_TRAIN_LEVELS];
    bat_mesh_score straight; ///< on the test shape, as bat_mesh_study_shape() has it
    bat_mesh_score turned;   ///< the same with shape and coarse mesh turned by a radian; the diagonal is the unturned one's
} bat_mesh_ablation_row;

/// Train a network in each of the variants on the same shapes, and measure it on a shape apart.
///
/// @param shapes  to train on; null for one of our own making: a creature
/// @param count   0 where `shapes` is null
/// @param test    null for another creature
/// @param options null is refused: there must be a folder
/// @param rows    receives BAT_MESH_VARIANT_COUNT rows
/// @return BAT_OK; BAT_INVALID_ARGUMENT; what bat_mesh_train() and bat_mesh_study_shape() return
BAT_API bat_status bat_mesh_ablate(const bat_mesh *shapes, size_t count, const bat_mesh *test,
                                   const bat_mesh_study_options *options, bat_mesh_ablation_row *rows, bat_error *error);

/// What two networks of different teachers make of one cage.
typedef struct bat_mesh_style
{
    bat_mesh smooth, sharp;           ///< the shapes that were trained on
    bat_mesh cage;                    ///< the coarse mesh
    bat_mesh by_smooth;               ///< the cage subdivided by the network that learned from the smooth shape
    bat_mesh by_sharp;                ///< and by the one that learned from the sharp shape
    bat_mesh_train_report reports[2]; ///< smooth, sharp
    /// The shares of edges at which the faces of by_smooth and by_sharp meet at more than 60 degrees.
    double bent[2];
} bat_mesh_style;

/// Train one network on a smooth shape and one on a sharp shape, and subdivide the same cage with both (figures 26 and 27).
///
/// @param smooth,sharp null for shapes of our own making: a stone and a bracket
/// @param cage         null for the built-in one
/// @param options      null is refused: there must be a folder
/// @param style        release it with bat_mesh_style_free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT; what bat_mesh_train() and bat_mesh_refine() return; `style` is empty on failure
BAT_API bat_status bat_mesh_style_make(const bat_mesh *smooth, const bat_mesh *sharp, const bat_mesh *cage,
                                       const bat_mesh_study_options *options, bat_mesh_style *style, bat_error *error);

/// Draw it: the two shapes, and beneath them the cage and what became of it.
/// @return BAT_OK or what bat_mesh_picture_write() returns
BAT_API bat_status bat_mesh_style_draw(const char *path, const bat_mesh_style *style, int threads, bat_error *error);

/// Free the meshes and make them empty.
BAT_API void bat_mesh_style_free(bat_mesh_style *style);

BAT_C_END

#endif
