#include "linalg/vector3.h"
#include "research/shapes/mesh_shape.h"

#include <math.h>
#include <string.h>

void primitive_body(mesh_primitive *mould)
{
    solid_push(&mould->shape, blended_body_value, &mould->body);
    double margin = noise_sum_reach(&mould->body.skin) + noise_sum_reach(&mould->body.folds);
    for (int c = 0; c < 3; c++)
    {
        mould->shape.low[c] = mould->body.low[c] - margin;
        mould->shape.high[c] = mould->body.high[c] + margin;
    }
}

cut *primitive_cut(mesh_primitive *mould, cut_kind kind, const double at[3], int axis, double size)
{
    cut *made = &mould->cuts[mould->cut_count++];
    *made = (cut){.kind = kind, .size = size, .wave_length = 1};
    memcpy(made->at, at, sizeof made->at);
    made->axis[axis] = 1;
    made->side[(axis + 1) % 3] = 1;
    solid_push(&mould->shape, cut_value, made);
    return made;
}

void primitive_box(mesh_primitive *mould, const double middle[3], double x, double y, double z)
{
    primitive_cut(mould, CUT_SLAB, middle, PRIMITIVE_X, x);
    primitive_cut(mould, CUT_SLAB, middle, PRIMITIVE_Y, y);
    solid_and(&mould->shape);
    primitive_cut(mould, CUT_SLAB, middle, PRIMITIVE_Z, z);
    solid_and(&mould->shape);
}

void primitive_bounds(mesh_primitive *mould, double x, double y, double z)
{
    double half[3] = {x, y, z};
    for (int c = 0; c < 3; c++)
    {
        mould->shape.low[c] = -half[c];
        mould->shape.high[c] = half[c];
    }
}

/// A point seen from the axis.
typedef struct around_axis
{
    double height, radius, across, up; ///< across and up: towards the side and at right angles to it
} around_axis;

static around_axis see(const cut *c, const double *point)
{
    double away[3] = {point[0] - c->at[0], point[1] - c->at[1], point[2] - c->at[2]};
    double up[3] = {c->axis[1] * c->side[2] - c->axis[2] * c->side[1], c->axis[2] * c->side[0] - c->axis[0] * c->side[2],
                    c->axis[0] * c->side[1] - c->axis[1] * c->side[0]};
    around_axis seen = {
        .height = vector3_dot(away, c->axis), .across = vector3_dot(away, c->side), .up = vector3_dot(away, up)};
    seen.radius = sqrt(seen.across * seen.across + seen.up * seen.up);
    return seen;
}

/// The angle to the nearest of `count` evenly spaced directions.
static double fold_angle(const cut *c, const around_axis *seen)
{
    double angle = atan2(seen->up, seen->across) - c->slope * seen->height;
    double step = 2 * WAVE_PI / c->count;
    return angle - step * round(angle / step);
}

double cut_value(const void *context, const double point[3])
{
    const cut *c = context;
    around_axis seen = see(c, point);
    switch (c->kind)
    {
    case CUT_PLANE:
        return seen.height - c->size;
    case CUT_SLAB:
        return fabs(seen.height) - c->size;
    case CUT_ROUND:
        return seen.radius - c->size;
    case CUT_CONE:
        return (seen.radius - c->size - c->slope * seen.height) / sqrt(1 + c->slope * c->slope);
    case CUT_BALL:
        return sqrt(seen.radius * seen.radius + seen.height * seen.height) - c->size;
    case CUT_PROFILE:
    {
        double turn = 2 * WAVE_PI * seen.height / c->wave_length;
        return 0.7 * (seen.radius - c->size * (1 + harmonics_at(&c->waves, cos(turn), sin(turn))));
    }
    case CUT_POLAR:
    {
        double turn = atan2(seen.up, seen.across) - c->slope * seen.height;
        return 0.7 * (seen.radius - c->size * (1 + harmonics_at(&c->waves, cos(turn), sin(turn))));
    }
    case CUT_TEETH:
    {
        double angle = fold_angle(c, &seen);
        return fabs(seen.radius * sin(angle)) - c->size * c->teeth[0] - c->teeth[1] * (seen.radius * cos(angle) - c->size);
    }
    case CUT_CIRCLE:
    {
        double angle = fold_angle(c, &seen);
        return hypot(seen.radius * cos(angle) - c->teeth[0], seen.radius * sin(angle)) - c->size;
    }
    }
    return 0;
}
