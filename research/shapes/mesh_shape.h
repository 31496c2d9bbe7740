#ifndef RESEARCH_SHAPES_MESH_SHAPE_H
#define RESEARCH_SHAPES_MESH_SHAPE_H

#include "research/data/wave.h"
#include "research/shapes/blended_body.h"
#include "research/shapes/solid.h"

/// @file
/// What shapes are described by before they become meshes.

typedef enum cut_kind
{
    CUT_PLANE, ///< the half-space below a plane
    CUT_SLAB,  ///< between two planes
    CUT_ROUND, ///< a round bar
    CUT_CONE,  ///< a round bar whose radius grows along it
    CUT_BALL,
    CUT_PROFILE, ///< turned: the radius is a sum of waves of the height
    CUT_POLAR,   ///< a bar whose radius is a sum of waves of the angle, turning along it
    CUT_TEETH,   ///< the flanks of teeth around an axis
    CUT_CIRCLE   ///< round bars on a circle around an axis
} cut_kind;

/// One smooth surface of a machine part.
typedef struct cut
{
    cut_kind kind;
    double at[3];       ///< a point on the plane or axis
    double axis[3];     ///< the unit normal of a plane, the unit vector along a bar
    double side[3];     ///< a unit vector across the axis, from which angles count
    double size;        ///< half a slab's width, a radius
    double slope;       ///< of a cone's radius; a polar bar's turn per length
    double teeth[3];    ///< of teeth: half the angle a tooth takes at the radius `size`, the change of its half width per
                        ///< radius; of circles: the radius of the circle
    int count;          ///< of teeth, of bars
    harmonics waves;    ///< the radius is size (1 + waves)
    double wave_length; ///< along the axis, of a profile
} cut;

/// A solid with what its surfaces read. It must stay where it is.
typedef struct mesh_primitive
{
    solid shape;
    blended_body body;
    cut cuts[SOLID_MAX_SURFACES];
    size_t cut_count;
    size_t blended; ///< the first so many cuts are one surface with fading edges
} mesh_primitive;

/// The axes of space.
enum
{
    PRIMITIVE_X,
    PRIMITIVE_Y,
    PRIMITIVE_Z
};

/// Push the body.
void primitive_body(mesh_primitive *primitive);
/// Push a surface with an axis of space; returns it, to be changed further before the next is pushed.
cut *primitive_cut(mesh_primitive *primitive, cut_kind kind, const double at[3], int axis, double size);
/// Push the box of three slabs.
void primitive_box(mesh_primitive *primitive, const double middle[3], double x, double y, double z);
/// Set the solid's box.
void primitive_bounds(mesh_primitive *primitive, double x, double y, double z);

double cut_value(const void *context, const double point[3]);

/// @file
/// The kinds of shapes. A drawing takes its random parameters from a stream and fills an empty mould.

typedef void primitive_generator(bat_random *random, mesh_primitive *primitive);

// creatures and other grown things, mesh_shape_body.c
primitive_generator primitive_creature, primitive_figure, primitive_bust, primitive_mask, primitive_cactus, primitive_coral,
    primitive_pretzel, primitive_stone;
// machine parts, mesh_shape_part.c
primitive_generator primitive_bracket, primitive_gear, primitive_lathe, primitive_casting, primitive_gem, primitive_cam,
    primitive_groove;

/// A mesh made directly.
typedef bat_status mesh_generator(size_t vertices, bat_random *random, bat_mesh *mesh, bat_error *error);

// grids of triangles, mesh_shape_sheet.c
mesh_generator generate_knot, generate_relief, generate_shell;
/// The cage has its own number of vertices. mesh_shape_cage.c
mesh_generator generate_cage;

#endif
