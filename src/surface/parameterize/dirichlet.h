#ifndef SURFACE_PARAMETERIZE_DIRICHLET_H
#define SURFACE_PARAMETERIZE_DIRICHLET_H

#include "base/memory_pool.h"
#include "linalg/multifrontal.h"

/// @file
/// The symmetric Dirichlet energy of a map from triangles in space to the unit square, and its minimization.
///     E = sum over triangles of area (s_1^2 + s_2^2 + s_1^-2 + s_2^-2).
/// s_1 and s_2 are the singular values of the map on a triangle. Triangles are scaled so that their total area is that of
/// the square. The energy is infinite where a triangle degenerates, so that no triangle turns over. Points of the
/// boundary slide along their side of the square; those at its corners stay.

enum
{
    DIRICHLET_UNKNOWNS = 6, ///< of a triangle
    DIRICHLET_ENTRIES = DIRICHLET_UNKNOWNS * (DIRICHLET_UNKNOWNS + 1) / 2
};

/// A triangle: gradients of the hat functions of its corners in its plane, and its area. The sum over corners of
/// parameter_k gradient_k^T is the derivative of the map to the parameters.
typedef struct dirichlet_triangle
{
    uint32_t corners[3];
    double gradient[3][2];
    double area;
    int entries[DIRICHLET_ENTRIES]; ///< of its unknowns' pairs (a, b), b <= a, in the matrix; negative for none
} dirichlet_triangle;

/// A map, its matrix and its solver. All zero: empty. Release it with dirichlet_free().
typedef struct dirichlet_map
{
    memory_pool pool; ///< all arrays
    dirichlet_triangle *triangles;
    size_t triangle_count;
    size_t point_count, boundary_count; ///< points of the boundary come first
    double *parameters, *next;          ///< point_count x 2
    int *unknown;                       ///< point_count x 2: unknowns of the coordinates, negative for coordinates that stay
    size_t unknowns;
    int *first; ///< unknowns + 1, of the pattern
    int *row;
    multifrontal *solver; ///< null: nothing moves
    double *values;       ///< of the matrix
    double *direction;    ///< unknowns
} dirichlet_map;

void dirichlet_free(dirichlet_map *map);

/// Measure triangles in space, scaled to the total area 1.
/// @param points    point_count x 3
/// @param triangles triangle_count x 3
/// @return BAT_OK or BAT_NO_MEMORY
bat_status dirichlet_measure(const double *points, const uint32_t *triangles, size_t triangle_count, dirichlet_map *map,
                             bat_error *error);

/// The energy of parameters; infinite where a triangle is degenerate or turned over.
double dirichlet_energy(const dirichlet_map *map, const double *parameters);

/// Number the unknowns, make the matrix and its solver. The map has triangles and parameters.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status dirichlet_prepare(dirichlet_map *map, bat_error *error);

/// Minimize the energy from parameters whose energy is finite.
/// @return BAT_OK, BAT_NO_MEMORY, BAT_CANCELLED
bat_status dirichlet_minimize(dirichlet_map *map, bat_progress progress, bat_error *error);

#endif
