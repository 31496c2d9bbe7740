#pragma once

#include "verb.h"

#include "batten/batten.h"
#include "batten/research/research.h"

/// What `batten reproduce all` knows of a result.
typedef struct reproduce_part
{
    const char *name, *summary;
    const char *kind;  ///< "meshes": what it reads from a folder, and the name of that folder in one for all; null for none
    const char *quick; ///< further words of a quick run; "-" where there is none; null where all runs are quick
    bool needs_data, has_folder, trains;
} reproduce_part;

/// As reproduce_row().
bool reproduce_part_at(size_t index, reproduce_part *part);

/// The job of `batten reproduce`.
typedef struct reproduce_job
{
    verb_call call;         ///< its files are the pictures
    size_t index;           ///< of the result
    const char *folder;     ///< for pictures or trainings; null for none
    bool quick;             ///< of all results
    bool without_trainings; ///< of all results
    double budget;          ///< seconds for each of all results
    bool made;              ///< the folder, by this call, and no picture is in it yet
    const char *model;      ///< the file of a network; null for none
    uint64_t seed;
    bat_tension_set_kind curves; ///< set of curves for table 1
    const char *const *shapes;   ///< files of meshes, `shape_count` of them
    size_t shape_count;
    const char *data;                    ///< a folder of meshes, clouds or curves; null for none
    size_t vertices;                     ///< vertices of decimated meshes; 0 for the default, also for the next two
    size_t epochs, pairs;                ///< of trainings on meshes; `epochs` also on clouds
    const char *uninformed;              ///< file of a network without the boundary-informed layer; null for none
    size_t clouds;                       ///< number of clouds or inputs of each case; 0 for the default
    int corrections;                     ///< parameter corrections after each fit
    number_list points, noises, degrees; ///< the cases; empty for the default
} reproduce_job;

/// Prints one result, writes its pictures to the folder if it has any, and returns the exit code.
typedef int reproduce_result(const reproduce_job *job);

extern reproduce_result reproduce_all, reproduce_curve_figures, reproduce_tension_table1, reproduce_tension_table2,
    reproduce_tension_table3, reproduce_tension_table4, reproduce_tension_iss, reproduce_tension_mechanism,
    reproduce_motion_keyframes, reproduce_real_curves, reproduce_real_meshes, reproduce_hermite_figures,
    reproduce_hermite_order, reproduce_mesh_table2, reproduce_mesh_ablations, reproduce_mesh_style,
    reproduce_surface_ablation, reproduce_surface_clouds, reproduce_surface_nefertiti, reproduce_surface_face,
    reproduce_surface_shapes, reproduce_scan_verdict, reproduce_scan_verdict_scanner, reproduce_scan_solids, reproduce_harm;
