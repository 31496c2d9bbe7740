#ifndef RESEARCH_SHAPES_MESH_SHAPE_H
#define RESEARCH_SHAPES_MESH_SHAPE_H

#include "research/data/wave.h"
#include "research/shapes/blended_body.h"
#include "research/shapes/solid.h"

/// @file
/// Signed-distance primitives of the random mesh shapes, and the generators of all shapes.

typedef enum cut_kind
{
    CUT_PLANE, ///< the half-space below a plane
    CUT_SLAB,  ///< the space between two planes
    CUT_ROUND, ///< a circular cylinder
    CUT_CONE,  ///< a circular cone
    CUT_BALL,
    CUT_PROFILE, ///< a surface of revolution: the radius is a trigonometric sum of the height
    CUT_POLAR,   ///< a twisted cylinder whose radius is a trigonometric sum of the angle
    CUT_TEETH,   ///< the flanks of teeth around an axis
    CUT_CIRCLE   ///< parallel circular cylinders on a circle around an axis
} cut_kind;

/// A smooth surface of a solid.
typedef struct cut
{
    cut_kind kind;
    double at[3];    ///< a point on the plane or axis
    double axis[3];  ///< unit normal of a plane, or unit vector of an axis
    double side[3];  ///< unit vector perpendicular to the axis; the zero of angles
    double size;     ///< half the width of a slab, or a radius
    double slope;    ///< slope of a cone's radius, or twist per length
    double teeth[3]; ///< teeth: half the angle of a tooth at the radius `size`, and the change of its half width per radius;
                     ///< circles: the radius of the circle, the change of its half width per radius; of circles: the radius
                     ///< of the circle
    int count;       ///< number of teeth or cylinders
    harmonics waves; ///< relative deviation of the radius from `size`
    double wave_length; ///< period of a profile along the axis
} cut;

/// A solid with the data of its surfaces. It must not be copied or moved, because the solid points into it.
typedef struct mesh_primitive
{
    solid shape;
    blended_body body;
    cut cuts[SOLID_MAX_SURFACES];
    size_t cut_count;
    size_t blended; ///< number of leading cuts that form one surface with edges of varying sharpness
} mesh_primitive;

/// The coordinate axes.
enum
{
    PRIMITIVE_X,
    PRIMITIVE_Y,
    PRIMITIVE_Z
};

/// Push the blended body.
void primitive_body(mesh_primitive *primitive);
/// Push a surface along a coordinate axis. Returns it for changes before the next push.
cut *primitive_cut(mesh_primitive *primitive, cut_kind kind, const double at[3], int axis, double size);
/// Push a box, the intersection of three slabs.
void primitive_box(mesh_primitive *primitive, const double middle[3], double x, double y, double z);
/// Set the bounding box of the solid.
void primitive_bounds(mesh_primitive *primitive, double x, double y, double z);

/// The function of a cut, as a solid_function.
double cut_value(const void *context, const double point[3]);

/// Draws random parameters and fills an empty primitive.
typedef void primitive_generator(bat_random *random, mesh_primitive *primitive);

// Organic shapes, mesh_organic.c
primitive_generator primitive_creature, primitive_figure, primitive_bust, primitive_mask, primitive_cactus, primitive_coral,
    primitive_pretzel, primitive_stone;
// Machine parts, mesh_parts.c
primitive_generator primitive_bracket, primitive_gear, primitive_lathe, primitive_casting, primitive_gem, primitive_cam,
    primitive_groove;

/// Generates a mesh directly, without a solid.
typedef bat_status mesh_generator(size_t vertices, bat_random *random, bat_mesh *mesh, bat_error *error);

// Triangulated grids, mesh_grids.c
mesh_generator generate_knot, generate_relief, generate_shell;
/// A coarse control mesh; ignores `vertices`. mesh_cage.c
mesh_generator generate_cage;

#endif
