#ifndef CLI_REPRODUCE_H
#define CLI_REPRODUCE_H

#include "verb.h"

#include "batten/curve_scheme.h"
#include "batten/mesh.h"
#include "batten/research/curve_data.h"
#include "batten/research/curve_study.h"

#include <jansson.h>

/// The published results that can be reproduced; `index` from 0 on. False past the last.
bool reproduce_row(size_t index, const char **name, const char **summary);

/// The job of `batten reproduce`.
typedef struct reproduce_job
{
    verb_call call;     ///< its files are the pictures
    size_t index;       ///< of the result
    const char *folder; ///< for pictures or trainings; null for none
    bool made;          ///< the folder, by this call, and no picture is in it yet
    const char *model;  ///< the file of a network; null for none
    uint64_t seed;
    bat_tension_set_kind curves; ///< set of curves for table 1
    const char *const *shapes;   ///< files of meshes, `shape_count` of them
    size_t shape_count;
    const char *data;                    ///< a folder of meshes, clouds or curves; null for none
    size_t vertices;                     ///< vertices of decimated meshes; 0 for the default, also for the next two
    size_t epochs, pairs;                ///< of trainings on meshes; `epochs` also on clouds
    const char *uninformed;              ///< file of a network without the boundary-informed layer; null for none
    size_t clouds;                       ///< number of clouds of each case; 0 for the default
    int corrections;                     ///< parameter corrections after each fit
    number_list points, noises, degrees; ///< the cases; empty for the default
} reproduce_job;

/// Prints one result, writes its pictures to the folder if it has any, and returns the exit code.
typedef int reproduce_result(const reproduce_job *job);

extern reproduce_result reproduce_curve_figures, reproduce_tension_table1, reproduce_tension_table2,
    reproduce_tension_table3, reproduce_tension_table4, reproduce_tension_iss, reproduce_tension_mechanism,
    reproduce_motion_keyframes, reproduce_real_curves, reproduce_real_meshes, reproduce_hermite_figures,
    reproduce_hermite_order, reproduce_mesh_table2, reproduce_mesh_ablations, reproduce_mesh_style,
    reproduce_surface_ablation, reproduce_surface_clouds, reproduce_surface_nefertiti, reproduce_surface_face,
    reproduce_surface_shapes, reproduce_scan_verdict;

// Common functions of the results.

enum
{
    REPRODUCE_PATH_SIZE = 4096
};

/// A picture: where it goes, and where it is written first.
typedef struct reproduce_picture
{
    char path[REPRODUCE_PATH_SIZE];
    const char *write_to;
} reproduce_picture;

/// Add a picture of that name in the job's folder. Returns the program's exit code.
int reproduce_picture_add(const reproduce_job *job, const char *name, reproduce_picture *picture);

/// Read the model that --model names, or take the published one. Returns the program's exit code.
int reproduce_model(const reproduce_job *job, bat_curve_model **model);
/// "folder/file" in a buffer. Returns the program's exit code.
int reproduce_path(const char *folder, const char *file, char path[REPRODUCE_PATH_SIZE]);

#endif
