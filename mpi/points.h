#ifndef MPI_POINTS_H
#define MPI_POINTS_H

#include "batten/cloud_file.h"

#include <stdbool.h>
#include <stdint.h>

/// @file
/// The points of a fit, read in parts by MPI-IO and distributed along the Morton curve of their parameters.

/// A point with its parameter, as it is sent.
typedef struct point_row
{
    double at[5]; ///< x, y, z, u, v
    uint64_t number;
} point_row;

/// Points of this rank, numbered through all ranks.
typedef struct file_part
{
    point_row *rows;
    size_t count;
    size_t boundary; ///< points of the boundary of all ranks: the lowest numbers
    size_t duplicates;
    uint32_t *origins; ///< origin_count: numbers in the file, of the numbers from origin_first on
    size_t origin_first, origin_count;
} file_part;

void file_part_free(file_part *part);

/// The points of this rank.
typedef struct fit_input
{
    double *points;        ///< count x 3
    double *parameters;    ///< count x 2
    uint32_t *numbers;     ///< count: the place among all points, without those that repeat others
    size_t count;          ///< whole blocks, but for the last rank with points
    size_t first;          ///< points of lower ranks
    size_t total;          ///< of all ranks, with the samples of border curves
    size_t samples;        ///< of border curves: the largest numbers
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
///                   than four ranks, where this would cost time
/// @return false after a message of rank 0
bool fit_input_read(const char *path, const char *parameters, bat_cloud_format format, size_t boundary, bool strict,
                    size_t relief, fit_input *input);

// The same step by step, for points without parameters.

/// Read points without parameters, in the order of the file. False after a message of rank 0.
bool file_part_read(const char *path, bat_cloud_format format, size_t boundary, bool strict, file_part *part);
/// Sort the points as bat_surface_reconstruct() does, ranks after each other, and number them so. u receives the place on
/// the boundary, from 1; 0 for other points.
void file_part_sort(file_part *part);
/// Distribute points with parameters along the curve. Empties the part.
/// @param samples points of the largest numbers that are samples of border curves
void fit_input_distribute(file_part *part, size_t samples, size_t relief, fit_input *input);

/// A number that depends on a place alone; all 64 bits are random.
uint64_t place_hash(const double place[3]);

#endif
