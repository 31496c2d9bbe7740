#ifndef MODELS_MESH_SHAPE_H
#define MODELS_MESH_SHAPE_H

#include "models/mesh_mould.h"

/// @file
/// The kinds of shapes. A drawing takes its random parameters from a stream and fills an empty mould.

typedef void mould_drawing(bat_random *random, mesh_mould *mould);

// creatures and other grown things, mesh_shape_body.c
mould_drawing mould_creature, mould_figure, mould_bust, mould_mask, mould_cactus, mould_coral, mould_pretzel, mould_stone;
// machine parts, mesh_shape_part.c
mould_drawing mould_bracket, mould_gear, mould_lathe, mould_casting, mould_gem, mould_cam, mould_groove;

/// A mesh made directly.
typedef bat_status mesh_weaving(size_t vertices, bat_random *random, bat_mesh *mesh, bat_error *error);

// grids of triangles, mesh_shape_sheet.c
mesh_weaving weave_knot, weave_relief, weave_shell;
/// The cage has its own number of vertices. mesh_shape_cage.c
mesh_weaving weave_cage;

#endif
