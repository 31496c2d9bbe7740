/// @file
/// Machine parts as solids bounded by planes, cylinders, cones and other smooth surfaces, with sharp edges.

#include "research/shapes/mesh_shape.h"

#include <math.h>

/// Drill a circular hole through the solid.
static void drill(mesh_primitive *primitive, const double at[3], int axis, double radius)
{
    primitive_cut(primitive, CUT_ROUND, at, axis, radius);
    solid_subtract(&primitive->shape);
}

/// Drill a blind hole from above, with a flat bottom at height `ground`.
static void sink(mesh_primitive *primitive, const double at[3], double radius, double ground)
{
    primitive_cut(primitive, CUT_ROUND, at, PRIMITIVE_Z, radius);
    primitive_cut(primitive, CUT_PLANE, (double[3]){0, 0, ground}, PRIMITIVE_Z, 0);
    solid_not(&primitive->shape);
    solid_and(&primitive->shape);
    solid_subtract(&primitive->shape);
}

void primitive_bracket(bat_random *random, mesh_primitive *primitive)
{
    double long_half = draw_between(random, 0.6, 1), wide = draw_between(random, 0.35, 0.6),
           thick = draw_between(random, 0.08, 0.13);
    double high = draw_between(random, 0.5, 0.9), wall = draw_between(random, 0.08, 0.12),
           narrow = wide * draw_between(random, 0.7, 0.95);
    double stand = -long_half + wall + draw_between(random, 0.02, 0.1);
    primitive_box(primitive, (double[3]){0, 0, 0}, long_half, wide, thick);
    primitive_box(primitive, (double[3]){stand, 0, 0.5 * high}, wall, narrow, 0.5 * high);
    solid_or(&primitive->shape);
    if (draw_coin(random))
    {
        // A rib in the corner, below an inclined plane.
        primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0.02, 0}, PRIMITIVE_Y, draw_between(random, 0.06, 0.1));
        cut *slant = primitive_cut(primitive, CUT_PLANE, (double[3]){stand, 0, 0.8 * high}, PRIMITIVE_Z, 0);
        double angle = atan2(0.8 * high, 1.4 * long_half);
        slant->axis[0] = sin(angle);
        slant->axis[2] = cos(angle);
        solid_and(&primitive->shape);
        primitive_cut(primitive, CUT_PLANE, (double[3]){stand, 0, 0}, PRIMITIVE_X, 0);
        solid_not(&primitive->shape);
        solid_and(&primitive->shape);
        primitive_cut(primitive, CUT_PLANE, (double[3]){0, 0, 0.3 * thick}, PRIMITIVE_Z, 0);
        solid_not(&primitive->shape);
        solid_and(&primitive->shape);
        solid_or(&primitive->shape);
    }
    double hole = draw_between(random, 0.08, 0.15), boss = draw_between(random, 0.18, 0.26), across = 0.5 * long_half;
    primitive_cut(primitive, CUT_ROUND, (double[3]){across, 0, 0}, PRIMITIVE_Z, boss);
    primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, thick}, PRIMITIVE_Z, draw_between(random, 0.07, 0.2));
    solid_and(&primitive->shape);
    solid_or(&primitive->shape);
    drill(primitive, (double[3]){across, 0, 0}, PRIMITIVE_Z, hole);
    if (draw_coin(random))
        drill(primitive, (double[3]){0, draw_between(random, -0.1, 0.1), 0.68 * high}, PRIMITIVE_X, 0.13 * high);
    for (int side = -1; side <= 1; side += 2)
        drill(primitive, (double[3]){-0.2 * long_half, 0.62 * wide * side, 0}, PRIMITIVE_Z, 0.16 * wide);
    if (draw_coin(random))
    {
        // Round the outer end of the plate.
        primitive_cut(primitive, CUT_ROUND, (double[3]){long_half - 1.25 * wide, 0, 0}, PRIMITIVE_Z, 1.24 * wide);
        primitive_cut(primitive, CUT_PLANE, (double[3]){long_half - 0.9 * wide, 0, 0}, PRIMITIVE_X, 0);
        solid_or(&primitive->shape);
        solid_and(&primitive->shape);
    }
    primitive_bounds(primitive, long_half + 0.02, wide + 0.02, high + 0.05);
}

void primitive_gear(bat_random *random, mesh_primitive *primitive)
{
    int teeth = draw_whole(random, 8, 16);
    double thick = draw_between(random, 0.12, 0.3), root = draw_between(random, 0.74, 0.82),
           bore = draw_between(random, 0.12, 0.22);
    double twist = draw_coin(random) ? draw_between(random, -0.5, 0.5) : 0;
    cut *flanks = primitive_cut(primitive, CUT_TEETH, (double[3]){0, 0, 0}, PRIMITIVE_Z, root);
    flanks->count = teeth;
    flanks->slope = twist;
    flanks->teeth[0] = draw_between(random, 0.28, 0.34) * 2 * WAVE_PI / teeth;
    flanks->teeth[1] = -draw_between(random, 0.25, 0.45);
    primitive_cut(primitive, CUT_ROUND, (double[3]){0, 0, 0}, PRIMITIVE_Z, root + draw_between(random, 1.1, 1.6) / teeth);
    solid_and(&primitive->shape);
    primitive_cut(primitive, CUT_ROUND, (double[3]){0, 0, 0}, PRIMITIVE_Z, root);
    solid_or(&primitive->shape);
    primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, 0}, PRIMITIVE_Z, thick);
    solid_and(&primitive->shape);
    double hub = bore + draw_between(random, 0.08, 0.14), rim = root - draw_between(random, 0.1, 0.16);
    if (draw_coin(random))
    {
        // A recess between hub and rim.
        primitive_cut(primitive, CUT_ROUND, (double[3]){0, 0, 0}, PRIMITIVE_Z, rim);
        primitive_cut(primitive, CUT_ROUND, (double[3]){0, 0, 0}, PRIMITIVE_Z, hub);
        solid_subtract(&primitive->shape);
        primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, 0}, PRIMITIVE_Z, thick * draw_between(random, 0.35, 0.6));
        solid_subtract(&primitive->shape);
        solid_subtract(&primitive->shape);
    }
    if (draw_coin(random))
    {
        cut *holes = primitive_cut(primitive, CUT_CIRCLE, (double[3]){0, 0, 0}, PRIMITIVE_Z, 0.26 * (rim - hub));
        holes->count = draw_whole(random, 3, 6);
        holes->teeth[0] = 0.5 * (rim + hub);
        solid_subtract(&primitive->shape);
    }
    drill(primitive, (double[3]){0, 0, 0}, PRIMITIVE_Z, bore);
    primitive_bounds(primitive, 1.05, 1.05, thick + 0.02);
}

void primitive_lathe(bat_random *random, mesh_primitive *primitive)
{
    double high = draw_between(random, 0.6, 1.1), radius = draw_between(random, 0.3, 0.45);
    cut *profile =
        primitive_cut(primitive, CUT_PROFILE, (double[3]){0, 0, draw_between(random, -0.3, 0.3)}, PRIMITIVE_Z, radius);
    profile->waves = harmonics_draw(random, draw_whole(random, 1, 3), 1);
    harmonics_limit(&profile->waves, 0.45);
    profile->wave_length = high * draw_between(random, 1.8, 2.8);
    primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, 0}, PRIMITIVE_Z, high);
    solid_and(&primitive->shape);
    int flanges = draw_whole(random, 1, 3);
    for (int flange = 0; flange < flanges; flange++)
    {
        double at = high * (-0.75 + 1.5 * (flange + draw_between(random, 0.2, 0.8)) / flanges);
        primitive_cut(primitive, CUT_ROUND, (double[3]){0, 0, 0}, PRIMITIVE_Z, radius * draw_between(random, 1.3, 1.8));
        primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, at}, PRIMITIVE_Z, draw_between(random, 0.04, 0.1));
        solid_and(&primitive->shape);
        solid_or(&primitive->shape);
    }
    if (draw_coin(random))
    {
        cut *cone = primitive_cut(primitive, CUT_CONE, (double[3]){0, 0, high}, PRIMITIVE_Z, radius * 0.38);
        cone->slope = draw_between(random, 0.03, 0.1);
        primitive_cut(primitive, CUT_PLANE, (double[3]){0, 0, high * draw_between(random, -0.6, 0.4)}, PRIMITIVE_Z, 0);
        solid_not(&primitive->shape);
        solid_and(&primitive->shape);
        solid_subtract(&primitive->shape);
    }
    if (draw_coin(random))
    {
        // Flats for a spanner.
        primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, 0}, PRIMITIVE_Y, radius * draw_between(random, 0.7, 1.1));
        solid_and(&primitive->shape);
    }
    primitive_bounds(primitive, 0.85, 0.85, high + 0.02);
}

void primitive_casting(bat_random *random, mesh_primitive *primitive)
{
    blended_body *body = &primitive->body;
    blended_body_begin(body);
    double blend = draw_between(random, 0.08, 0.2), rise = draw_between(random, -0.1, 0.25),
           turn = draw_between(random, -0.6, 0.6);
    double left[3] = {-0.6, 0, 0}, right[3] = {0.6 * cos(turn), 0.6 * sin(turn), rise}, middle[3] = {0, 0, 0};
    double big = draw_between(random, 0.22, 0.32), small = draw_between(random, 0.15, 0.24);
    blended_body_round_cone(body, left, middle, draw_between(random, 0.14, 0.2), 0.18, blend);
    blended_body_round_cone(body, middle, right, 0.18, draw_between(random, 0.1, 0.16), blend);
    blended_body_round_cone(body, (double[3]){left[0], 0, -0.25}, (double[3]){left[0], 0, 0.25}, big, big, blend);
    blended_body_round_cone(body, (double[3]){right[0], right[1], rise - 0.16}, (double[3]){right[0], right[1], rise + 0.16},
                            small, small, blend);
    double high = draw_between(random, 0.12, 0.25), wide = draw_between(random, 0.22, 0.4),
           deep = draw_between(random, 0.15, 0.25);
    blended_body_part *block = blended_body_box(body, middle, deep, wide, high, 0.06, blend);
    double third = draw_between(random, -0.5, 0.5), second = draw_between(random, -0.3, 0.3),
           first = draw_between(random, -0.3, 0.3);
    blended_body_turn(block, first, second, third);
    primitive_body(primitive);
    primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, 0.02}, PRIMITIVE_Z, draw_between(random, 0.26, 0.36));
    solid_and(&primitive->shape);
    drill(primitive, left, PRIMITIVE_Z, big * draw_between(random, 0.5, 0.68));
    if (draw_coin(random))
        drill(primitive, right, PRIMITIVE_Z, small * draw_between(random, 0.45, 0.6));
    else
        sink(primitive, right, small * 0.55, rise);
    if (draw_coin(random))
    {
        primitive_cut(primitive, CUT_PLANE, (double[3]){0, draw_between(random, 0.2, 0.3), 0}, PRIMITIVE_Y, 0);
        solid_and(&primitive->shape);
    }
}

void primitive_gem(bat_random *random, mesh_primitive *primitive)
{
    int planes = draw_whole(random, 6, 16);
    primitive_cut(primitive, CUT_BALL, (double[3]){0, 0, 0}, PRIMITIVE_Z, 1);
    double turn = draw_angle(random);
    for (int i = 0; i < planes; i++)
    {
        // Directions along a spiral from pole to pole, with random displacements.
        double height = fmin(fmax(1 - (2 * i + 1.0) / planes + draw_between(random, -0.1, 0.1), -1), 1);
        double across = sqrt(1 - height * height), angle = turn + 2.39996 * i + draw_between(random, -0.25, 0.25);
        cut *plane = primitive_cut(primitive, CUT_PLANE, (double[3]){0, 0, 0}, PRIMITIVE_Z, draw_between(random, 0.6, 0.85));
        plane->axis[0] = across * cos(angle);
        plane->axis[1] = across * sin(angle);
        plane->axis[2] = height;
        plane->side[0] = -sin(angle);
        plane->side[1] = cos(angle);
        solid_and(&primitive->shape);
    }
    primitive_bounds(primitive, 1, 1, 1);
}

void primitive_cam(bat_random *random, mesh_primitive *primitive)
{
    double high = draw_between(random, 0.15, 0.5), radius = 0.6;
    cut *bar = primitive_cut(primitive, CUT_POLAR, (double[3]){0, 0, 0}, PRIMITIVE_Z, radius);
    bar->waves = harmonics_draw(random, draw_whole(random, 2, 6), 1);
    harmonics_limit(&bar->waves, 0.4);
    bar->slope = draw_coin(random) ? draw_between(random, -1.2, 1.2) : 0;
    if (draw_coin(random))
        primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, 0}, PRIMITIVE_Z, high);
    else
    {
        primitive_cut(primitive, CUT_BALL, (double[3]){0, 0, -0.9}, PRIMITIVE_Z, 0.9 + high);
        primitive_cut(primitive, CUT_PLANE, (double[3]){0, 0, -high}, PRIMITIVE_Z, 0);
        solid_not(&primitive->shape);
        solid_and(&primitive->shape);
    }
    solid_and(&primitive->shape);
    double step = draw_between(random, 0.15, 0.28);
    primitive_cut(primitive, CUT_ROUND, (double[3]){0.08, 0, 0}, PRIMITIVE_Z, step);
    primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, 0}, PRIMITIVE_Z, high + draw_between(random, 0.1, 0.4));
    solid_and(&primitive->shape);
    solid_or(&primitive->shape);
    if (draw_coin(random))
        drill(primitive, (double[3]){0.08, 0, 0}, PRIMITIVE_Z, step * draw_between(random, 0.4, 0.7));
    if (draw_coin(random))
    {
        primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0, high}, PRIMITIVE_Z, 0.06);
        primitive_cut(primitive, CUT_SLAB, (double[3]){0, 0.02, 0}, PRIMITIVE_Y, draw_between(random, 0.06, 0.1));
        solid_and(&primitive->shape);
        solid_subtract(&primitive->shape);
    }
    primitive_bounds(primitive, 0.9, 0.9, high + 0.42);
}

/// The smooth maximum of the blended cuts, whose width varies along x; see primitive_groove().
static double groove_value(const void *context, const double point[3])
{
    const mesh_primitive *primitive = context;
    const cut *cuts = primitive->cuts;
    double share = 0.5 + 0.5 * tanh((point[0] - cuts[0].teeth[0]) * cuts[0].teeth[1]);
    double width = cuts[0].slope + (cuts[0].wave_length - cuts[0].slope) * share, value = -HUGE_VAL;
    for (size_t i = 0; i < primitive->blended; i++)
    {
        double next = cut_value(&cuts[i], point);
        double overlap = i == 0 ? 0 : fmax(width - fabs(value - next), 0) / width;
        value = fmax(value, next) + overlap * overlap * width / 4;
    }
    return value;
}

/// A block with edges that are nearly sharp at one end and round at the other.
void primitive_groove(bat_random *random, mesh_primitive *primitive)
{
    static const double MIDDLE[3] = {0, 0, 0};
    double half[3] = {1, draw_between(random, 0.5, 0.8), draw_between(random, 0.4, 0.7)};
    for (int axis = 0; axis < 3; axis++)
        primitive_cut(primitive, CUT_SLAB, MIDDLE, axis, half[axis]);
    int corners = draw_whole(random, 1, 3);
    for (int i = 0; i < corners; i++)
    {
        double angle = draw_angle(random), rise = draw_between(random, -0.6, 0.6);
        cut *plane = primitive_cut(primitive, CUT_PLANE, MIDDLE, PRIMITIVE_Z, draw_between(random, 0.55, 0.75));
        plane->axis[0] = cos(angle) * cos(rise);
        plane->axis[1] = sin(angle) * cos(rise);
        plane->axis[2] = sin(rise);
    }
    primitive->cuts[0].slope = draw_between(random, 0.05, 0.1);
    primitive->cuts[0].wave_length = draw_between(random, 0.4, 0.7);
    primitive->cuts[0].teeth[0] = draw_between(random, -0.3, 0.3);
    primitive->cuts[0].teeth[1] = draw_between(random, 1.5, 4) * (draw_coin(random) ? 1 : -1);
    primitive->blended = primitive->cut_count;
    primitive->shape.surface_count = primitive->shape.step_count = 0;
    solid_push(&primitive->shape, groove_value, primitive);
    if (draw_coin(random))
    {
        double radius = draw_between(random, 0.12, 0.25), x = draw_between(random, -0.4, 0.4);
        drill(primitive, (double[3]){x, 0, 0}, PRIMITIVE_Z, radius);
    }
    primitive_bounds(primitive, 1, half[1], half[2]);
}
