#ifndef MPI_POINTS_H
#define MPI_POINTS_H

#include "batten/cloud_file.h"

#include <stdbool.h>
#include <stdint.h>

/// @file
/// The points of a fit, read in parts by MPI-IO and distributed along the Morton curve of their parameters.

/// The points of this rank.
typedef struct fit_input
{
    double *points;        ///< count x 3
    double *parameters;    ///< count x 2
    uint32_t *numbers;     ///< count: the place among all points, without those that repeat others
    size_t count;          ///< whole blocks, but for the last rank with points
    size_t first;          ///< points of lower ranks
    size_t total;          ///< of all ranks
    size_t boundary_count; ///< of all points: the lowest numbers
    size_t duplicates;     ///< of all points: left out
    uint64_t label;        ///< depends on all points and on nothing else
} fit_input;

void fit_input_free(fit_input *input);

/// Read points in XYZ or binary PLY with parameters: of a file of lines "u v", or in the columns after x, y and z (in PLY
/// the properties u and v).
/// @param parameters path; null for columns
/// @param boundary   number of leading points on the boundary; 0: as the file says
/// @param strict     refuse points that repeat others
/// @param relief     rank 0 gets so many points less than the others, as far as it can: it has the matrix. Not with less
/// than
///                   four ranks, where this would cost time
/// @return false after a message of rank 0
bool fit_input_read(const char *path, const char *parameters, bat_cloud_format format, size_t boundary, bool strict,
                    size_t relief, fit_input *input);

#endif
