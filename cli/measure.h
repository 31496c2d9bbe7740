#ifndef CLI_MEASURE_H
#define CLI_MEASURE_H

#include "verb.h"

#include "batten/batten.h"

/// The job of `batten measure`.
typedef struct measure_job
{
    verb_call call;
    const char *paths[2]; ///< the second null when there is only A
    bool of_meshes;
    bat_error failure; ///< of telling meshes from curves; its status is BAT_OK where there was none
    bat_curve_read_options read;
    bat_curve_measure_options measure;
    bat_curve_set sets[2];
    bat_mesh_read_options read_mesh;
    bat_mesh_compare_options compare;
    bat_mesh meshes[2];
    bat_mesh_summary summary;   ///< of one mesh
    bat_mesh_distance distance; ///< of two
} measure_job;

/// The file at fault in a comparison: the first one where the text of the error names it alone, else the second.
const char *measure_file_at_fault(const char *const paths[2], const bat_error *error);

/// Whether the files of `batten measure` are meshes: by --mesh or --from, else by the first file whose ending or content is
/// clear. An OBJ file is a mesh when its first element is a face. Pipes are not read.
/// @param failure untouched unless a file cannot be recognized for want of memory
bool measure_means_meshes(const arguments *given, bat_error *failure);

/// Check the options for meshes. False after a message.
bool measure_check_meshes(measure_job *job);
/// Read and measure one mesh or two, and draw them. Returns the program's exit code, as the following does.
int measure_meshes(measure_job *job);
int measure_report_meshes(const measure_job *job);

#endif
