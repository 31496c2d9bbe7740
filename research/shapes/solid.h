#ifndef RESEARCH_SHAPES_SOLID_H
#define RESEARCH_SHAPES_SOLID_H

#include "batten/mesh.h"

/// @file
/// Solids bounded by smooth surfaces that meet in sharp edges, and triangle meshes of their boundaries.
///
/// Every surface is the zero set of a function, negative inside. A solid joins their insides by and, or and not, written in
/// postfix order: solid_surface_add() pushes an inside, the operations work on what was pushed last. As long as no surface
/// is used twice, the boundary is a manifold.

enum
{
    SOLID_MAX_SURFACES = 40,
    SOLID_MAX_STEPS = 3 * SOLID_MAX_SURFACES,
    SOLID_MAX_MEETING = 3 ///< surfaces at one point
};

/// A function of space, much like a distance near its zeros: its gradient there is about 1, and seldom longer than 2.
typedef double solid_function(const void *context, const double point[3]);

typedef struct solid_surface
{
    solid_function *value;
    const void *context;
    bool open; ///< this part of the boundary is left out of the mesh, which ends there
} solid_surface;

typedef enum solid_operation
{
    SOLID_SURFACE,
    SOLID_AND,
    SOLID_OR,
    SOLID_NOT
} solid_operation;

typedef struct solid_step
{
    solid_operation operation;
    size_t surface; ///< of SOLID_SURFACE
} solid_step;

/// All zero with a box: nothing. The functions that build it assert that there is room.
typedef struct solid
{
    solid_surface surfaces[SOLID_MAX_SURFACES];
    size_t surface_count;
    solid_step steps[SOLID_MAX_STEPS];
    size_t step_count;
    double low[3], high[3]; ///< a box around it
} solid;

void solid_push(solid *s, solid_function *value, const void *context);
/// Push a surface where the mesh ends.
void solid_push_open(solid *s, solid_function *value, const void *context);
void solid_and(solid *s);
void solid_or(solid *s);
void solid_not(solid *s);
/// Take away from what was pushed before last what was pushed last.
void solid_subtract(solid *s);

/// The function of the whole, from the greater of two values (and), the lesser (or) and the opposite (not).
double solid_value(const solid *s, const double point[3]);
/// Whether a point is inside of the whole that is inside of the surfaces whose bits are set.
bool solid_is_inside(const solid *s, uint64_t surfaces);

/// A step from a point towards where up to SOLID_MAX_MEETING surfaces are all zero: Newton's, the shortest one.
/// @param surfaces    indices of the surfaces
/// @param longest     no longer step is made
/// @param difference  the spacing of finite differences
void solid_step_towards(const solid *s, const size_t *surfaces, size_t count, double longest, double difference,
                        double point[3]);

/// A closed mesh of the boundary from a lattice of tetrahedra, with triangles of any shape: the largest piece. Every face
/// has the surface that it belongs to.
///
/// The lattice is body-centred cubic; its tetrahedra are cut along every surface, which is taken as linear in each. The
/// boundary is what lies between tetrahedra inside and outside.
///
/// @param cell     the lattice's spacing
/// @param steepest how fast values change at most: a ball of radius r around a point of value above steepest r holds no
/// boundary
/// @param surfaces receives the surface of every face; release it with free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT where the lattice meets no boundary; BAT_TOO_LARGE; BAT_NO_MEMORY. A mesh with a
/// boundary
///         is a sign of values that change faster
bat_status solid_cut(const solid *s, double cell, double steepest, bat_mesh *mesh, uint16_t **surfaces, bat_error *error);

/// A mesh of the boundary of about so many vertices, its triangles of even size and good shape, its edges along the edges of
/// the solid.
bat_status solid_mesh(const solid *s, size_t vertices, bat_mesh *mesh, bat_error *error);

#endif
