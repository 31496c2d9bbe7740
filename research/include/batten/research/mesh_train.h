#ifndef BATTEN_RESEARCH_MESH_TRAIN_H
#define BATTEN_RESEARCH_MESH_TRAIN_H

#include "batten/mesh.h"
#include "batten/research/train.h"

BAT_C_BEGIN

/// @file
/// Training of learned subdivision of meshes: network, data and loss of Liu et al., "Neural Subdivision" (2020), and
/// batten's own (docs/algorithms/mesh-network.md, weights/mesh.md).

/// The levels that networks are trained for.
#define BAT_MESH_TRAIN_LEVELS 2

/// The number of bat_mesh_training_shapes().
#define BAT_MESH_TRAINING_SHAPES 44

/// The most pairs, the most meshes of a step, and the most vertices of a coarse mesh.
#define BAT_MESH_TRAIN_MAX_PAIRS 10000000
#define BAT_MESH_TRAIN_MAX_BATCH 10000000
#define BAT_MESH_TRAIN_MAX_VERTICES 1000000000

/// How to train. Begin with bat_mesh_train_defaults().
typedef struct bat_mesh_train_options
{
    bat_train_options run; ///< default 700 epochs; batten 200
    bat_recipe recipe;     ///< with BAT_RECIPE_BATTEN the bat_mesh_training_shapes() follow the given shapes
    size_t pairs;          ///< coarse meshes per shape; 1 to BAT_MESH_TRAIN_MAX_PAIRS for all shapes; default 200; batten 16
    size_t resampled;      ///< pairs that each epoch replaces by new ones, in turn; default 0; batten 64
    size_t batch;          ///< meshes per step, 1 to the number of pairs; default 1; batten 4
    /// Vertices of a coarse mesh, drawn uniformly, or by batten's recipe logarithmically; 4 (batten: 20) to
    /// BAT_MESH_TRAIN_MAX_VERTICES; default 150 to 300; batten 100 to 500.
    size_t min_vertices, max_vertices;
    double min_normal;  ///< bound of the decimation, -1 to 1 (bat_mesh_decimate_options); default 0.2
    double min_quality; ///< bound of the decimation, 0 to 1; default 0.2
    double rate;        ///< the learning rate of Adam, batten AdamW, above 0; default 2e-3
    bool cosine_decay;  ///< the learning rate decays to 0 along a cosine, else it is constant; default false; batten true
    /// Weights that batten's recipe begins with, a file; the loss then counts the worst meshes and the largest distances
    /// more. Null: random weights; default null.
    const char *begin;
    // The following are of the published network alone; batten's recipe refuses them.
    bool fixed_frames;   ///< half-flaps use the axes of space instead of their own frames (section 6); default false
    bool no_differences; ///< without differential coordinates (appendix H); default false
    bool relative;       ///< lengths are relative to each half-flap's own, else to the unit box; default false
    bool last_level;     ///< the loss is that of the last level alone (appendix H); default false
    bool chamfer;        ///< the loss is the Chamfer distance, not the distance to each vertex's own target; default false
    /// The loss counts distances from the shape, in coarse edges, in full and distances along it by a tenth (in squares),
    /// instead of mean squares; default false.
    bool surface;
    bool learn_loop; ///< the targets are Loop's refinement of the coarse meshes (appendix G); default false
} bat_mesh_train_options;

/// The default options of a recipe.
BAT_API bat_mesh_train_options bat_mesh_train_defaults(bat_recipe recipe);

/// The generated shapes of batten's recipe. The shipped weights were trained on them alone.
/// @param shapes receives BAT_MESH_TRAINING_SHAPES meshes; release each with bat_mesh_free()
/// @return BAT_OK, BAT_NO_MEMORY, BAT_CANCELLED; on failure nothing is left to release
BAT_API bat_status bat_mesh_training_shapes(bat_mesh *shapes, int threads, bat_progress progress, bat_error *error);

/// The outcome of a training.
typedef struct bat_mesh_train_report
{
    /// `best` is the mean validation loss; by batten's recipe the geometric mean, over validation meshes, of the mean
    /// distance over the least of the classical schemes
    bat_train_report run;
    /// Of the best weights, at each level: root mean squares over the coordinates of vertices of validation pairs, in units
    /// of the coarse mesh's longest side. With another loss than that of squares, the root of it. NaN by batten's recipe.
    double errors[BAT_MESH_TRAIN_LEVELS + 1];
} bat_mesh_train_report;

/// Train on shapes. Pairs of a coarse mesh and a shape are made by semi-random decimation with a map
/// (batten/mesh_decimate.h). Five more of each shape are for validation; the best weights are those of the lowest loss on
/// these, every five epochs. Batten's recipe makes coarse meshes in five ways, validates on shapes of its own, and takes the
/// last weights. While it runs, OpenBLAS works on one thread in the whole process.
///
/// @param shapes      each valid for bat_mesh_check() and bat_mesh_connect()
/// @param shape_count at least 1; batten's recipe needs none
/// @param options     null for the defaults of BAT_RECIPE_PUBLISHED
/// @param report      may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT (no shapes, an option out of range, a checkpoint of another
/// training);
///         what bat_mesh_decimate() returns; BAT_NO_CONVERGENCE with the step when a loss is not finite; BAT_BAD_FILE,
///         BAT_FILE_ACCESS or BAT_NO_MEMORY
BAT_API bat_status bat_mesh_train(const bat_mesh *shapes, size_t shape_count, const bat_mesh_train_options *options,
                                  bat_mesh_train_report *report, bat_error *error);

BAT_C_END

#endif
