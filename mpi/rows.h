#ifndef MPI_ROWS_H
#define MPI_ROWS_H

#include "batten/cloud_file.h"

#include <stddef.h>

#include <stdbool.h>

/// @file
/// Rows of numbers, read in parts by MPI-IO and exchanged between ranks.

/// Rows of a file that this rank reads: those that begin in its part of the bytes.
typedef struct rows_text
{
    size_t columns;  ///< numbers kept of each row; missing ones are 0
    size_t needed;   ///< numbers that each row must have
    double *values;  ///< count x columns, from malloc()
    size_t count;    ///< of this rank
    size_t boundary; ///< "# N boundary points first" before the first row; 0 for none
} rows_text;

/// Read lines of numbers with blanks between them; '#' begins a remark.
/// @return false after a message of rank 0
bool rows_read_text(const char *path, rows_text *text);
/// Read the vertices of a PLY file, binary and little-endian: x, y, z, and the properties u and v (or s and t).
bool rows_read_ply(const char *path, rows_text *text);

/// Whether a file has parameters after x, y and z: five numbers in its first row, or properties u and v. False for a file
/// that cannot be read. All ranks receive the answer of rank 0.
bool rows_have_parameters(const char *path, bat_cloud_format format);

/// Send rows to the ranks; `counts` of them to each, those of rank 0 first.
/// @param received receives the number of rows that came, those of rank 0 first
/// @return these rows, from malloc()
void *rows_exchange(const void *rows, size_t row_bytes, const size_t *counts, size_t *received);

#endif
