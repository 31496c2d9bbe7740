#ifndef BATTEN_RESEARCH_MESH_TRAIN_H
#define BATTEN_RESEARCH_MESH_TRAIN_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Training of learned subdivision by the recipe of Liu et al., "Neural Subdivision" (2020): their network, data and loss.

/// The levels that networks are trained for.
#define BAT_MESH_TRAIN_LEVELS 2

/// The number of bat_mesh_training_shapes().
#define BAT_MESH_TRAINING_SHAPES 30

/// How to train. Begin with bat_mesh_train_defaults(), the published recipe.
typedef struct bat_mesh_train_options
{
    uint64_t seed;         ///< of the first weights, the decimations and the order of pairs; default 1
    uint64_t epochs;       ///< at least 1; default 700
    size_t pairs;          ///< coarse meshes made of each shape, at least 1; default 200
    size_t fresh;          ///< of all pairs so many are made anew in each epoch, in turn, and never come again; default 0
    size_t batch;          ///< meshes of a step, at least 1; default 1
    size_t least_vertices; ///< of the coarse meshes: the number is drawn evenly; at least 4; default 150
    size_t most_vertices;  ///< default 300
    double least_normal, least_quality; ///< bounds of the decimation, as in bat_mesh_decimate_options; default .2
    double rate;                        ///< the learning rate of Adam; default 2e-3
    bool falling;                       ///< the rate falls to 0 along half a wave; else it is constant; default false
    bool fixed_frames; ///< half-flaps are seen through the axes of space instead of their frames (section 6); default false
    bool no_differences; ///< without differential coordinates (appendix H); default false
    bool relative;       ///< lengths by each half-flap's own, so that scale does not matter; default false: by the unit box
    bool last_level;     ///< the loss is that of the last level alone (appendix H); default false
    bool chamfer;        ///< the loss is the Chamfer distance instead of that to each vertex's own target; default false
    /// The loss counts what lies off the shape, in coarse edges, in full, and what has slipped along it a tenth (in
    /// squares), instead of mean squares; default false.
    bool surface;
    bool learn_loop; ///< the targets are Loop's refinement of the coarse meshes (appendix G); default false
    /// Where the files go, made with those that it lies in where it is not there. While training runs: the log `log.csv`,
    /// its picture `log.png`, and every five epochs and at a stop `checkpoint.safetensors`. At the end: `model.safetensors`,
    /// the best weights. Null for no files; default null.
    const char *folder;
    /// Go on from the folder's checkpoint, if there is one, to the same bytes as without the stop; default false.
    bool resume;
    int threads; ///< 0: as many as OpenMP gives; pairs are made on all, `batch` of them help with steps; the result
                 ///< does not depend on it; default 0
    bat_progress progress; ///< asked before every step; when it says stop, the checkpoint is written first
} bat_mesh_train_options;

/// The options' default values.
BAT_API bat_mesh_train_options bat_mesh_train_defaults(void);

/// The recipe of the weights that batten ships (weights/mesh.md): lengths are relative, errors are those of surfaces, the
/// rate falls, coarse meshes have 150 to 500 vertices and some are made anew in every epoch. bat_mesh_training_shapes()
/// belongs to it.
BAT_API bat_mesh_train_options bat_mesh_train_batten(void);

/// The shapes of our own making that the shipped weights are trained on, beside `bob` and `spot` by Keenan Crane, which are
/// in the public domain and have to be brought.
/// @param shapes receives BAT_MESH_TRAINING_SHAPES meshes; release each with bat_mesh_free()
/// @return BAT_OK, BAT_NO_MEMORY, BAT_CANCELLED; on failure nothing is left to release
BAT_API bat_status bat_mesh_training_shapes(bat_mesh *shapes, int threads, bat_progress progress, bat_error *error);

/// How a training went. Errors are root mean squares over the coordinates of vertices, in units of the coarse meshes'
/// longest sides, over pairs kept aside (of another loss than that of squares, the root of it).
typedef struct bat_mesh_train_report
{
    uint64_t epochs;                          ///< done, earlier runs included
    uint64_t best_epoch;                      ///< after which the weights were best, counted from 1
    double loss;                              ///< mean over the last epoch of this run; NaN when there was none
    double errors[BAT_MESH_TRAIN_LEVELS + 1]; ///< of the best weights, at each level
} bat_mesh_train_report;

/// Train the published network on shapes. Pairs are made by semi-random decimation with a map (batten/decimate.h). Five more
/// of each shape are kept aside; the best weights are those of least loss on these, which are measured every five epochs.
/// While it runs, OpenBLAS works on one thread in the whole process.
///
/// @param shapes  at least 1, each of what bat_mesh_check() and bat_mesh_connect() accept
/// @param options null for the defaults, which keep nothing but the report
/// @param report  may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT (no shapes, numbers out of range, a checkpoint of another training);
/// what
///         bat_mesh_decimate() returns; BAT_NO_CONVERGENCE with the step when a loss is not finite; BAT_BAD_FILE,
///         BAT_FILE_ACCESS or BAT_NO_MEMORY
BAT_API bat_status bat_mesh_train(const bat_mesh *shapes, size_t shape_count, const bat_mesh_train_options *options,
                                  bat_mesh_train_report *report, bat_error *error);

BAT_C_END

#endif
