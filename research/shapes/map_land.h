#ifndef RESEARCH_SHAPES_MAP_LAND_H
#define RESEARCH_SHAPES_MAP_LAND_H

#include "research/shapes/map_grid.h"

/// @file
/// Land, countries and lakes of a generated map, as sets of cells.

#define MAP_SEA UINT32_MAX

/// What lies within a cell, away from its border.
typedef enum map_spot
{
    MAP_SPOT_NONE,
    MAP_SPOT_PATCH, ///< an area of `spot_owner`: an island, a lake or an enclave
    MAP_SPOT_RING   ///< the same, and within it an area of the cell's owner
} map_spot;

/// Who owns a cell.
typedef struct map_plot
{
    uint32_t owner; ///< a feature, or MAP_SEA
    map_spot spot;
    uint32_t spot_owner;
} map_plot;

typedef enum map_kind
{
    MAP_COUNTRY,
    MAP_LAKE,
    MAP_ENCLAVE ///< a country that lies within another
} map_kind;

typedef struct map_land
{
    map_plot *plots; ///< one for each cell
    map_kind *kinds; ///< of the features; feature 0 covers the south pole
    size_t feature_count, feature_capacity;
    size_t split_count; ///< countries to be made by cutting others along meridians and parallels
    bool failed;        ///< out of memory
} map_land;

enum
{
    MAP_MIN_COUNTRIES = 12,
    MAP_MAX_COUNTRIES = 5000
};

/// The frequency of the grid for a number of countries: about 20 cells for each, a third of them land.
size_t map_land_frequency(size_t countries);

/// Share the cells among `countries` countries and enclaves, and lakes. False when out of memory.
bool map_land_make(const map_grid *grid, size_t countries, bat_random *random, map_land *land);

/// The angle in degrees to turn the grid by so that about five countries lie across the antimeridian. False when out of
/// memory.
bool map_land_turn(const map_grid *grid, const map_land *land, double *turn);

void map_land_free(map_land *land);

#endif
