/// @file
/// Signed-distance primitives in cylindrical coordinates about their axes; see mesh_shape.h.

#include "linalg/vector.h"
#include "research/shapes/mesh_shape.h"

#include <math.h>
#include <string.h>

void primitive_body(mesh_primitive *primitive)
{
    solid_push(&primitive->shape, blended_body_value, &primitive->body);
    double margin = noise_sum_reach(&primitive->body.noise) + noise_sum_reach(&primitive->body.ridged_noise);
    for (int c = 0; c < 3; c++)
    {
        primitive->shape.low[c] = primitive->body.low[c] - margin;
        primitive->shape.high[c] = primitive->body.high[c] + margin;
    }
}

cut *primitive_cut(mesh_primitive *primitive, cut_kind kind, const double at[3], int axis, double size)
{
    cut *made = &primitive->cuts[primitive->cut_count++];
    *made = (cut){.kind = kind, .size = size, .wave_length = 1};
    memcpy(made->at, at, sizeof made->at);
    made->axis[axis] = 1;
    made->side[(axis + 1) % 3] = 1;
    solid_push(&primitive->shape, cut_value, made);
    return made;
}

void primitive_box(mesh_primitive *primitive, const double middle[3], double x, double y, double z)
{
    primitive_cut(primitive, CUT_SLAB, middle, PRIMITIVE_X, x);
    primitive_cut(primitive, CUT_SLAB, middle, PRIMITIVE_Y, y);
    solid_and(&primitive->shape);
    primitive_cut(primitive, CUT_SLAB, middle, PRIMITIVE_Z, z);
    solid_and(&primitive->shape);
}

void primitive_bounds(mesh_primitive *primitive, double x, double y, double z)
{
    double half[3] = {x, y, z};
    for (int c = 0; c < 3; c++)
    {
        primitive->shape.low[c] = -half[c];
        primitive->shape.high[c] = half[c];
    }
}

/// A point in coordinates relative to an axis.
typedef struct around_axis
{
    double height, radius, across, up; ///< components along `side`, and perpendicular to it
} around_axis;

static around_axis axis_coordinates(const cut *c, const double *point)
{
    double away[3] = {point[0] - c->at[0], point[1] - c->at[1], point[2] - c->at[2]};
    double up[3] = {c->axis[1] * c->side[2] - c->axis[2] * c->side[1], c->axis[2] * c->side[0] - c->axis[0] * c->side[2],
                    c->axis[0] * c->side[1] - c->axis[1] * c->side[0]};
    around_axis local = {
        .height = vector3_dot(away, c->axis), .across = vector3_dot(away, c->side), .up = vector3_dot(away, up)};
    local.radius = sqrt(local.across * local.across + local.up * local.up);
    return local;
}

/// The angle to the nearest of `count` equally spaced directions.
static double sector_angle(const cut *c, const around_axis *local)
{
    double angle = atan2(local->up, local->across) - c->slope * local->height;
    double step = 2 * WAVE_PI / c->count;
    return angle - step * round(angle / step);
}

double cut_value(const void *context, const double point[3])
{
    const cut *c = context;
    around_axis local = axis_coordinates(c, point);
    switch (c->kind)
    {
    case CUT_PLANE:
        return local.height - c->size;
    case CUT_SLAB:
        return fabs(local.height) - c->size;
    case CUT_ROUND:
        return local.radius - c->size;
    case CUT_CONE:
        return (local.radius - c->size - c->slope * local.height) / sqrt(1 + c->slope * c->slope);
    case CUT_BALL:
        return sqrt(local.radius * local.radius + local.height * local.height) - c->size;
    case CUT_PROFILE:
    {
        double turn = 2 * WAVE_PI * local.height / c->wave_length;
        return 0.7 * (local.radius - c->size * (1 + harmonics_at(&c->waves, cos(turn), sin(turn))));
    }
    case CUT_POLAR:
    {
        double turn = atan2(local.up, local.across) - c->slope * local.height;
        return 0.7 * (local.radius - c->size * (1 + harmonics_at(&c->waves, cos(turn), sin(turn))));
    }
    case CUT_TEETH:
    {
        double angle = sector_angle(c, &local);
        return fabs(local.radius * sin(angle)) - c->size * c->teeth[0] - c->teeth[1] * (local.radius * cos(angle) - c->size);
    }
    case CUT_CIRCLE:
    {
        double angle = sector_angle(c, &local);
        return hypot(local.radius * cos(angle) - c->teeth[0], local.radius * sin(angle)) - c->size;
    }
    }
    return 0;
}
