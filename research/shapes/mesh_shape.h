#ifndef RESEARCH_SHAPES_MESH_SHAPE_H
#define RESEARCH_SHAPES_MESH_SHAPE_H

#include "research/shapes/mesh_primitive.h"

/// @file
/// The kinds of shapes. A drawing takes its random parameters from a stream and fills an empty mould.

typedef void primitive_drawing(bat_random *random, mesh_primitive *mould);

// creatures and other grown things, mesh_shape_body.c
primitive_drawing primitive_creature, primitive_figure, primitive_bust, primitive_mask, primitive_cactus, primitive_coral,
    primitive_pretzel, primitive_stone;
// machine parts, mesh_shape_part.c
primitive_drawing primitive_bracket, primitive_gear, primitive_lathe, primitive_casting, primitive_gem, primitive_cam,
    primitive_groove;

/// A mesh made directly.
typedef bat_status mesh_weaving(size_t vertices, bat_random *random, bat_mesh *mesh, bat_error *error);

// grids of triangles, mesh_shape_sheet.c
mesh_weaving weave_knot, weave_relief, weave_shell;
/// The cage has its own number of vertices. mesh_shape_cage.c
mesh_weaving weave_cage;

#endif
