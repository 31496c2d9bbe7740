#ifndef RESEARCH_SHAPES_SOLID_H
#define RESEARCH_SHAPES_SOLID_H

#include "batten/mesh.h"

/// @file
/// Solids bounded by implicit surfaces that meet in sharp edges, and triangle meshes of their boundaries.
///
/// Every surface is the zero set of a function, negative inside. A solid is a Boolean expression of their insides in postfix
/// notation: solid_push() pushes an inside, the operations combine the last operands. If every surface occurs once, the
/// boundary is a manifold.

enum
{
    SOLID_MAX_SURFACES = 40,
    SOLID_MAX_STEPS = 3 * SOLID_MAX_SURFACES,
    SOLID_MAX_MEETING = 3 ///< maximum number of surfaces at a point
};

/// A function of space that approximates a distance near its zeros: its gradient has a length of about 1, seldom above 2.
typedef double solid_function(const void *context, const double point[3]);

/// A surface.
typedef struct solid_surface
{
    solid_function *value;
    const void *context;
    bool open; ///< this surface is omitted, so that the mesh has a boundary there
} solid_surface;

typedef enum solid_operation
{
    SOLID_SURFACE,
    SOLID_AND,
    SOLID_OR,
    SOLID_NOT
} solid_operation;

/// A step of the postfix expression.
typedef struct solid_step
{
    solid_operation operation;
    size_t surface; ///< operand of SOLID_SURFACE
} solid_step;

/// A solid. All zero with a bounding box: empty. The functions below assert that the capacity suffices.
typedef struct solid
{
    solid_surface surfaces[SOLID_MAX_SURFACES];
    size_t surface_count;
    solid_step steps[SOLID_MAX_STEPS];
    size_t step_count;
    double low[3], high[3]; ///< bounding box
} solid;

/// Push the inside of a surface.
void solid_push(solid *s, solid_function *value, const void *context);
/// Push a surface that is omitted from the mesh.
void solid_push_open(solid *s, solid_function *value, const void *context);
/// Replace the last two operands by their intersection.
void solid_and(solid *s);
/// Replace the last two operands by their union.
void solid_or(solid *s);
/// Replace the last operand by its complement.
void solid_not(solid *s);
/// Replace the last two operands a, b by a minus b.
void solid_subtract(solid *s);

/// The value of the solid: maximum for and, minimum for or, negation for not.
double solid_value(const solid *s, const double point[3]);
/// Whether a point is inside the solid, if it is inside exactly the surfaces whose bits are set.
bool solid_is_inside(const solid *s, uint64_t surfaces);

/// One Newton step of minimal length towards the intersection of up to SOLID_MAX_MEETING surfaces.
/// @param surfaces   indices of the surfaces
/// @param longest    maximum length of the step
/// @param difference spacing of finite differences
void solid_step_towards(const solid *s, const size_t *surfaces, size_t count, double longest, double difference,
                        double point[3]);

/// A closed mesh of the boundary from a body-centred cubic lattice of tetrahedra. The result is the largest component, with
/// triangles of any shape, and with the surface of every face.
///
/// Tetrahedra are cut along every surface, which is linearized in each of them. The boundary separates tetrahedra inside and
/// outside.
///
/// @param cell     spacing of the lattice
/// @param steepest Lipschitz constant of the values: a ball of radius r around a point with a value above steepest r
///        contains no boundary
/// @param surfaces receives the surface of every face; release it with free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT if the lattice does not meet the boundary; BAT_TOO_LARGE; BAT_NO_MEMORY. A mesh with
///        a
///         boundary indicates that `steepest` is too small
bat_status solid_cut(const solid *s, double cell, double steepest, bat_mesh *mesh, uint16_t **surfaces, bat_error *error);

/// A mesh of the boundary with about `vertices` vertices, well-shaped triangles of uniform size, and mesh edges along the
/// sharp edges of the solid.
bat_status solid_mesh(const solid *s, size_t vertices, bat_mesh *mesh, bat_error *error);

#endif
