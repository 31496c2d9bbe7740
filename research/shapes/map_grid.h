#ifndef RESEARCH_SHAPES_MAP_GRID_H
#define RESEARCH_SHAPES_MAP_GRID_H

#include "batten/base.h"

/// @file
/// Cells on the sphere: the vertices of a geodesic triangulation, each moved a little at random. The cells are the faces of
/// its dual, whose corners are the centroids of the triangles.

enum
{
    MAP_MAX_DEGREE = 6
};

/// A cell with its neighbours and corners, counter-clockwise from outside.
typedef struct map_cell
{
    double point[3];            ///< its site, a unit vector
    double longitude, latitude; ///< of its site, in degrees
    size_t degree;              ///< 5 or 6
    uint32_t neighbours[MAP_MAX_DEGREE];
    uint32_t triangles[MAP_MAX_DEGREE]; ///< triangle k lies between neighbours k and k + 1
} map_cell;

typedef struct map_grid
{
    map_cell *cells;
    size_t cell_count;
    uint32_t (*triangles)[3]; ///< cells, counter-clockwise
    size_t triangle_count;
} map_grid;

/// Make a grid of 10 frequency^2 + 2 cells; `frequency` is 1 to 4000. False when out of memory.
bool map_grid_make(size_t frequency, bat_random *random, map_grid *grid);

/// Turn a grid about the axis of the Earth.
void map_grid_turn(map_grid *grid, double degrees);

void map_grid_free(map_grid *grid);

/// The difference of longitudes in degrees that is nearest to 0.
double map_longitude_step(double degrees);

#endif
