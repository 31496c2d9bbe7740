/// @file
/// Organic shapes as blended bodies: creatures, figures, heads, cacti, corals, pretzels, stones.

#include "research/shapes/mesh_shape.h"

#include <math.h>
#include <string.h>

static void copy(double to[3], const double *from)
{
    memcpy(to, from, 3 * sizeof *to);
}

/// Add noise of low frequency (dents), and ridged noise of higher frequency (wrinkles).
static void add_noise_layers(bat_random *random, blended_body *body, double dents, double wrinkles)
{
    body->noise = (noise_sum){.seed = bat_random_bits(random),
                              .frequency = draw_between(random, 1.5, 3),
                              .amplitude = dents * draw_between(random, 0.3, 1),
                              .gain = draw_between(random, 0.35, 0.5),
                              .octaves = draw_whole(random, 1, 3)};
    body->ridged_noise = (noise_sum){.seed = bat_random_bits(random),
                                     .frequency = draw_between(random, 3, 6),
                                     .amplitude = -wrinkles * draw_between(random, 0, 1),
                                     .gain = 0.4,
                                     .octaves = draw_whole(random, 1, 2),
                                     .ridge = draw_between(random, 0.05, 0.15)};
}

/// Add a leg of three round cones. `side` is 1 or -1.
static void add_leg(blended_body *body, const double hip[3], double length, double radius, double knee, double spread,
                    double side)
{
    double joint[3] = {hip[0] + knee * length, hip[1] + 0.5 * spread * side, hip[2] - 0.5 * length};
    double heel[3] = {hip[0], hip[1] + spread * side, hip[2] - 0.95 * length};
    double toe[3] = {heel[0] + 1.2 * radius, heel[1], heel[2]};
    blended_body_round_cone(body, hip, joint, 1.35 * radius, radius, 0.12);
    blended_body_round_cone(body, joint, heel, radius, 0.75 * radius, 0.06);
    blended_body_round_cone(body, heel, toe, 0.85 * radius, 0.7 * radius, 0.05);
}

static void add_ears(bat_random *random, blended_body *body, const double head[3], double size)
{
    double length = size * draw_between(random, 0.4, 1.6), wide = size * draw_between(random, 0.25, 0.5);
    double lean = draw_between(random, -0.5, 0.4), out = draw_between(random, 0.2, 0.9);
    for (int side = -1; side <= 1; side += 2)
    {
        double middle[3] = {head[0] - 0.35 * size, head[1] + side * (0.55 * size + 0.4 * out * length),
                            head[2] + 0.6 * size + 0.45 * length};
        blended_body_part *ear = blended_body_ellipsoid(body, middle, 0.4 * wide, wide, 0.55 * length, 0.07);
        blended_body_turn(ear, -side * out, lean, 0);
    }
}

static void add_tail(bat_random *random, blended_body *body, const double from[3], double radius)
{
    double length = draw_between(random, 0.1, 0.3), rise = draw_between(random, -1.2, 0.8),
           bend = draw_between(random, -0.6, 0.6);
    double swing = draw_between(random, -0.5, 0.5), at[3], next[3];
    copy(at, from);
    for (int segment = 0; segment < 3; segment++)
    {
        double angle = rise + bend * segment, turn = swing * segment;
        next[0] = at[0] - length * cos(angle) * cos(turn);
        next[1] = at[1] + length * cos(angle) * sin(turn);
        next[2] = at[2] + length * sin(angle);
        blended_body_round_cone(body, at, next, radius * (1 - 0.2 * segment), radius * (0.8 - 0.2 * segment), 0.05);
        copy(at, next);
    }
}

static void add_head(bat_random *random, blended_body *body, const double neck[3], double size)
{
    double head[3] = {neck[0] + 0.3 * size, neck[1], neck[2] + 0.2 * size};
    double wide = size * draw_between(random, 0.75, 1), deep = size * draw_between(random, 0.9, 1.3);
    blended_body_part *skull = blended_body_ellipsoid(body, head, deep, wide, 0.85 * size, 0.1);
    blended_body_turn(skull, 0, draw_between(random, 0, 0.5), 0);
    double snout = size * draw_between(random, 0.6, 1.7), drop = draw_between(random, 0.1, 0.7);
    double nose[3] = {head[0] + snout, head[1], head[2] - drop * size};
    blended_body_round_cone(body, head, nose, 0.65 * size, size * draw_between(random, 0.25, 0.5), 0.1);
    add_ears(random, body, head, size);
    for (int side = -1; side <= 1; side += 2)
    {
        double eye[3] = {head[0] + 0.75 * size, head[1] + 0.52 * size * side, head[2] + 0.3 * size};
        blended_body_ellipsoid(body, eye, 0.22 * size, 0.2 * size, 0.2 * size, 0.03);
    }
    if (draw_whole(random, 0, 2) > 0)
        return;
    double length = size * draw_between(random, 0.6, 1.5), curl = draw_between(random, -0.5, 0.8);
    for (int side = -1; side <= 1; side += 2)
    {
        double root[3] = {head[0] + 0.1 * size, head[1] + 0.3 * size * side, head[2] + 0.6 * size};
        double bow[3] = {root[0] + 0.2 * length, root[1] + 0.3 * length * side, root[2] + 0.6 * length};
        double tip[3] = {bow[0] + curl * length, bow[1], bow[2] + 0.5 * length};
        blended_body_round_cone(body, root, bow, 0.3 * size, 0.2 * size, 0.05);
        blended_body_round_cone(body, bow, tip, 0.2 * size, 0.11 * size, 0.03);
    }
}

void primitive_creature(bat_random *random, mesh_primitive *primitive)
{
    blended_body *body = &primitive->body;
    blended_body_begin(body);
    double chest = draw_between(random, 0.19, 0.3), hips = chest * draw_between(random, 0.7, 1.1);
    double slope = draw_between(random, -0.15, 0.1), sag = draw_between(random, -0.12, 0.08);
    double front[3] = {0.42, 0, 0}, middle[3] = {0, 0, sag}, back[3] = {-0.42, 0, slope};
    blended_body_round_cone(body, back, middle, hips, (chest + hips) * draw_between(random, 0.4, 0.55), 0.15);
    blended_body_round_cone(body, middle, front, (chest + hips) * 0.48, chest, 0.15);
    double leg = draw_between(random, 0.35, 0.85), radius = draw_between(random, 0.065, 0.12);
    double knee = draw_between(random, 0.03, 0.16), spread = draw_between(random, 0, 0.06);
    for (int side = -1; side <= 1; side += 2)
    {
        double stride = draw_between(random, -0.12, 0.12), shoulder[3] = {0.4 + stride, 0.62 * chest * side, -0.3 * chest};
        double hip[3] = {-0.42 - stride, 0.62 * hips * side, slope - 0.3 * hips};
        add_leg(body, shoulder, leg, radius, -0.4 * knee, spread, side);
        add_leg(body, hip, leg + slope, 1.1 * radius, knee, spread, side);
    }
    double reach = draw_between(random, 0.2, 0.6), rise = draw_between(random, 0.2, 1.25),
           swing = draw_between(random, -0.15, 0.15);
    double neck[3] = {0.5 + reach * cos(rise), swing, 0.08 + reach * sin(rise)}, size = draw_between(random, 0.13, 0.22);
    blended_body_round_cone(body, front, neck, 0.75 * chest, 0.75 * size, 0.15);
    add_head(random, body, neck, size);
    double rump[3] = {-0.42 - 0.75 * hips, 0, slope + 0.2 * hips};
    add_tail(random, body, rump, draw_between(random, 0.05, 0.08));
    add_noise_layers(random, body, 0.03, 0.022);
    primitive_body(primitive);
}

static void add_arm(bat_random *random, blended_body *body, const double shoulder[3], double length, double radius,
                    double side)
{
    double lift = draw_between(random, -1.3, 0.9), bend = draw_between(random, -0.3, 1.2),
           ahead = draw_between(random, -0.2, 0.7);
    double elbow[3] = {shoulder[0] + ahead * 0.4 * length, shoulder[1] + side * 0.5 * length * cos(lift),
                       shoulder[2] + 0.5 * length * sin(lift)};
    double wrist[3] = {elbow[0] + ahead * 0.5 * length, elbow[1] + side * 0.5 * length * cos(lift + bend),
                       elbow[2] + 0.5 * length * sin(lift + bend)};
    blended_body_round_cone(body, shoulder, elbow, 1.2 * radius, radius, 0.1);
    blended_body_round_cone(body, elbow, wrist, radius, 0.7 * radius, 0.05);
    blended_body_part *hand = blended_body_ellipsoid(body, wrist, 1.0 * radius, 0.75 * radius, 1.2 * radius, 0.06);
    blended_body_turn(hand, lift * side, 0, 0);
}

void primitive_figure(bat_random *random, mesh_primitive *primitive)
{
    blended_body *body = &primitive->body;
    blended_body_begin(body);
    double wide = draw_between(random, 0.15, 0.26), belly = draw_between(random, 0.14, 0.27);
    double pelvis[3] = {0, 0, 0}, waist[3] = {draw_between(random, -0.04, 0.05), 0, 0.22};
    double breast[3] = {draw_between(random, -0.05, 0.06), draw_between(random, -0.05, 0.05), 0.48};
    blended_body_ellipsoid(body, pelvis, 0.8 * belly, belly, 0.2, 0.1);
    blended_body_ellipsoid(body, waist, belly * 0.85, belly * 0.9, 0.2, 0.15);
    blended_body_ellipsoid(body, breast, 0.75 * wide, 1.15 * wide, 0.23, 0.15);
    double radius = draw_between(random, 0.06, 0.1), leg = draw_between(random, 0.6, 0.95);
    double size = draw_between(random, 0.13, 0.21), neck[3] = {breast[0] + 0.03, breast[1], 0.72};
    blended_body_round_cone(body, breast, neck, 0.5 * wide, 0.5 * size, 0.12);
    double head[3] = {neck[0] + 0.02, neck[1], neck[2] + size};
    add_head(random, body, head, size);
    for (int side = -1; side <= 1; side += 2)
    {
        double shoulder[3] = {breast[0], breast[1] + 1.05 * wide * side, 0.6}, hip[3] = {0, 0.6 * belly * side, -0.08};
        add_arm(random, body, shoulder, draw_between(random, 0.5, 0.75), 0.85 * radius, side);
        double spread = draw_between(random, 0.03, 0.12), knee = draw_between(random, 0, 0.2);
        add_leg(body, hip, leg, 1.1 * radius, knee, spread, side);
    }
    add_noise_layers(random, body, 0.025, 0.018);
    primitive_body(primitive);
}

static void add_face(bat_random *random, blended_body *body)
{
    double long_nose = draw_between(random, 0.04, 0.13), brow = draw_between(random, 0.04, 0.08),
           jaw = draw_between(random, 0.2, 0.32);
    blended_body_round_cone(body, (double[3]){0.42, 0, 0.12}, (double[3]){0.48 + long_nose, 0, -0.06}, 0.045,
                            draw_between(random, 0.045, 0.065), 0.08);
    blended_body_ellipsoid(body, (double[3]){0.3, 0, -0.34}, 0.17, jaw, 0.13, 0.14);
    blended_body_ellipsoid(body, (double[3]){0.41, 0, -0.2}, 0.09, 0.13, 0.045, 0.045);
    blended_body_ellipsoid(body, (double[3]){0.39, 0, -0.275}, 0.09, 0.12, 0.05, 0.045);
    for (int side = -1; side <= 1; side += 2)
    {
        blended_body_part *socket = blended_body_ellipsoid(body, (double[3]){0.52, 0.17 * side, 0.1}, 0.1, 0.1, 0.07, 0.07);
        socket->subtracted = true;
        blended_body_ellipsoid(body, (double[3]){0.39, 0.17 * side, 0.1}, 0.07, 0.075, 0.065, 0.02);
        blended_body_round_cone(body, (double[3]){0.46, 0.06 * side, 0.19}, (double[3]){0.36, 0.3 * side, 0.19}, brow,
                                0.8 * brow, 0.06);
        blended_body_part *cheek = blended_body_ellipsoid(body, (double[3]){0.36, 0.22 * side, -0.08}, 0.1, 0.1, 0.09, 0.12);
        blended_body_turn(cheek, 0, 0, 0.3 * side);
        blended_body_part *ear = blended_body_ellipsoid(body, (double[3]){-0.02, 0.45 * side, 0.02}, 0.1, 0.045, 0.15, 0.05);
        blended_body_turn(ear, 0.2 * side, 0.2, -0.4 * side);
    }
}

/// Begin a body with a head that faces along x.
static void shape_head(bat_random *random, blended_body *body)
{
    blended_body_begin(body);
    double high = draw_between(random, 0.5, 0.6), wide = draw_between(random, 0.4, 0.47),
           deep = draw_between(random, 0.48, 0.56);
    blended_body_part *skull = blended_body_ellipsoid(body, (double[3]){-0.02, 0, 0.12}, deep, wide, high, 0.1);
    blended_body_turn(skull, 0, draw_between(random, -0.1, 0.3), 0);
    add_face(random, body);
}

static void add_hair(bat_random *random, blended_body *body)
{
    int style = draw_whole(random, 0, 2);
    if (style == 1)
        blended_body_ellipsoid(body, (double[3]){-0.12, 0, 0.28}, 0.54, 0.5, 0.5, 0.03);
    if (style == 2)
        blended_body_ellipsoid(body, (double[3]){-0.5, 0, 0.5}, 0.2, 0.22, 0.2, 0.06);
}

void primitive_bust(bat_random *random, mesh_primitive *primitive)
{
    blended_body *body = &primitive->body;
    shape_head(random, body);
    add_hair(random, body);
    double lean = draw_between(random, -0.1, 0.1);
    blended_body_round_cone(body, (double[3]){-0.08, 0, -0.1}, (double[3]){-0.15, lean, -0.8}, 0.24, 0.28, 0.15);
    blended_body_part *chest = blended_body_ellipsoid(body, (double[3]){-0.15, lean, -0.95}, 0.36, 0.72, 0.32, 0.2);
    blended_body_turn(chest, draw_between(random, -0.15, 0.15), 0, 0);
    add_noise_layers(random, body, 0.02, 0.025);
    primitive_body(primitive);
    if (draw_coin(random))
        return;
    primitive_cut(primitive, CUT_PLANE, (double[3]){0, 0, -0.98}, PRIMITIVE_Z, 0);
    solid_subtract(&primitive->shape);
}

void primitive_mask(bat_random *random, mesh_primitive *primitive)
{
    blended_body *body = &primitive->body;
    shape_head(random, body);
    add_noise_layers(random, body, 0.03, 0.03);
    primitive_body(primitive);
    cut *back = primitive_cut(primitive, CUT_PLANE, (double[3]){draw_between(random, -0.05, 0.12), 0, 0}, PRIMITIVE_X, 0);
    double tilt = draw_between(random, -0.2, 0.2);
    back->axis[0] = cos(tilt);
    back->axis[2] = sin(tilt);
    primitive->shape.surfaces[primitive->shape.surface_count - 1].open = true;
    solid_subtract(&primitive->shape);
}

void primitive_cactus(bat_random *random, mesh_primitive *primitive)
{
    blended_body *body = &primitive->body;
    blended_body_begin(body);
    double height = draw_between(random, 1, 1.7), radius = draw_between(random, 0.17, 0.26);
    double bend = draw_between(random, -0.12, 0.12);
    blended_body_round_cone(body, (double[3]){0, 0, 0}, (double[3]){bend, 0, 0.5 * height}, 0.9 * radius, radius, 0.1);
    blended_body_round_cone(body, (double[3]){bend, 0, 0.5 * height}, (double[3]){bend, 0.1, height}, radius, 0.75 * radius,
                            0.1);
    int arms = draw_whole(random, 1, 4);
    for (int arm = 0; arm < arms; arm++)
    {
        double angle = 2 * WAVE_PI * arm / arms + draw_between(random, -0.4, 0.4),
               from = height * draw_between(random, 0.25, 0.65);
        double out = radius + draw_between(random, 0.2, 0.35), up = draw_between(random, 0.25, 0.6), thick = radius * 0.6;
        double root[3] = {bend, 0, from}, elbow[3] = {bend + out * cos(angle), out * sin(angle), from + 0.08};
        double tip[3] = {elbow[0], elbow[1], elbow[2] + up};
        blended_body_round_cone(body, root, elbow, thick, thick, 0.06);
        blended_body_round_cone(body, elbow, tip, thick, 0.8 * thick, 0.04);
    }
    if (draw_coin(random))
        blended_body_round_cone(body, (double[3]){0, 0, -0.3}, (double[3]){0, 0, -0.02}, 0.3, 0.38, 0.03);
    body->ridge_count = draw_whole(random, 6, 10);
    body->ridges = draw_between(random, 0.08, 0.24);
    add_noise_layers(random, body, 0.02, 0);
    primitive_body(primitive);
}

/// Add a branch with `further` generations of side branches.
static void branch(bat_random *random, blended_body *body, const double from[3], const double heading[3], double length,
                   double radius, int further)
{
    double to[3];
    for (int c = 0; c < 3; c++)
        to[c] = from[c] + length * heading[c];
    blended_body_round_cone(body, from, to, radius, 0.75 * radius, 0.08);
    if (further == 0)
        return;
    int children = draw_whole(random, 2, 3);
    double turn = draw_angle(random);
    for (int child = 0; child < children; child++)
    {
        double angle = turn + 2 * WAVE_PI * child / children, tilt = draw_between(random, 0.5, 0.95), next[3], size = 0;
        double lean[3] = {cos(angle), sin(angle), draw_between(random, -0.2, 0.3)};
        for (int c = 0; c < 3; c++)
        {
            next[c] = cos(tilt) * heading[c] + sin(tilt) * lean[c];
            size += next[c] * next[c];
        }
        for (int c = 0; c < 3; c++)
            next[c] /= sqrt(size);
        double thick = radius * draw_between(random, 0.65, 0.8), reach = length * draw_between(random, 0.65, 0.9);
        branch(random, body, to, next, reach, thick, further - 1);
    }
}

void primitive_coral(bat_random *random, mesh_primitive *primitive)
{
    blended_body *body = &primitive->body;
    blended_body_begin(body);
    branch(random, body, (double[3]){0, 0, 0}, (double[3]){0, 0, 1}, 0.5, draw_between(random, 0.14, 0.2), 2);
    blended_body_ellipsoid(body, (double[3]){0, 0, -0.08}, 0.4, 0.35, 0.14, 0.1);
    add_noise_layers(random, body, 0.03, 0.02);
    primitive_body(primitive);
}

void primitive_pretzel(bat_random *random, mesh_primitive *primitive)
{
    blended_body *body = &primitive->body;
    blended_body_begin(body);
    int rings = draw_whole(random, 1, 4);
    double tube = draw_between(random, 0.1, 0.16);
    for (int ring = 0; ring < rings; ring++)
    {
        double radius = draw_between(random, 0.3, 0.42), tilt = draw_between(random, -0.6, 0.6),
               turn = draw_between(random, -0.4, 0.4);
        double across[3] = {sin(tilt), cos(tilt) * sin(turn), cos(tilt) * cos(turn)};
        double middle[3] = {0.62 * ring, 0.25 * (ring % 2), 0};
        blended_body_ring(body, middle, across, radius, tube * draw_between(random, 0.85, 1.2), 0.12);
    }
    add_noise_layers(random, body, 0.03, 0.02);
    primitive_body(primitive);
}

void primitive_stone(bat_random *random, mesh_primitive *primitive)
{
    blended_body *body = &primitive->body;
    blended_body_begin(body);
    double tall = draw_between(random, 0.4, 0.7), wide = draw_between(random, 0.45, 0.7),
           deep = draw_between(random, 0.5, 0.8);
    blended_body_ellipsoid(body, (double[3]){0, 0, 0}, deep, wide, tall, 0.1);
    int lumps = draw_whole(random, 0, 4);
    for (int lump = 0; lump < lumps; lump++)
    {
        double angle = draw_angle(random), high = draw_between(random, -0.7, 0.7), size = draw_between(random, 0.15, 0.3);
        double middle[3] = {0.55 * cos(angle) * cos(high), 0.55 * sin(angle) * cos(high), 0.45 * sin(high)};
        blended_body_ellipsoid(body, middle, size, size * draw_between(random, 0.8, 1.2), size, 0.15);
    }
    add_noise_layers(random, body, 0.1, 0.09);
    body->ridged_noise.frequency *= 0.6;
    primitive_body(primitive);
}
