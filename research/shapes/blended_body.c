/// @file
/// Gradient noise and blends of signed distances; see blended_body.h.

#include "research/shapes/blended_body.h"

#include "linalg/vector.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static uint64_t mix(uint64_t z)
{
    // finalizer of splitmix64 (Steele, Lea and Flood, 2014)
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// The inner product of an offset with the gradient at an integer point.
static double gradient_product(uint64_t seed, int64_t i, int64_t j, int64_t k, double x, double y, double z)
{
    static const double GRADIENTS[16][3] = {{1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
                                            {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1},
                                            {1, 1, 0},  {-1, 1, 0},  {0, -1, 1}, {0, -1, -1}};
    uint64_t place =
        (uint64_t)i * 0x9e3779b97f4a7c15u + (uint64_t)j * 0xc2b2ae3d27d4eb4fu + (uint64_t)k * 0x165667b19e3779f9u;
    const double *g = GRADIENTS[mix(seed + place) >> 60];
    return g[0] * x + g[1] * y + g[2] * z;
}

static double smoother_step(double t)
{
    return t * t * t * (t * (6 * t - 15) + 10);
}

static double blend(double a, double b, double share)
{
    return a + share * (b - a);
}

double noise_at(uint64_t seed, double x, double y, double z)
{
    double fx = floor(x), fy = floor(y), fz = floor(z);
    int64_t i = (int64_t)fx, j = (int64_t)fy, k = (int64_t)fz;
    x -= fx;
    y -= fy;
    z -= fz;
    double u = smoother_step(x), v = smoother_step(y), w = smoother_step(z), levels[2];
    for (int up = 0; up < 2; up++)
    {
        double low = blend(gradient_product(seed, i, j, k + up, x, y, z - up),
                           gradient_product(seed, i + 1, j, k + up, x - 1, y, z - up), u);
        double high = blend(gradient_product(seed, i, j + 1, k + up, x, y - 1, z - up),
                            gradient_product(seed, i + 1, j + 1, k + up, x - 1, y - 1, z - up), u);
        levels[up] = blend(low, high, v);
    }
    return blend(levels[0], levels[1], w);
}

double noise_sum_at(const noise_sum *noise, const double point[3])
{
    double sum = 0, amplitude = noise->amplitude, frequency = noise->frequency;
    for (int octave = 0; octave < noise->octaves; octave++)
    {
        double value =
            noise_at(noise->seed + (uint64_t)octave, frequency * point[0], frequency * point[1], frequency * point[2]);
        if (noise->ridge > 0)
            value = 1 - 2 * sqrt(value * value + noise->ridge * noise->ridge);
        sum += amplitude * value;
        amplitude *= noise->gain;
        frequency *= 2;
    }
    return sum;
}

double noise_sum_reach(const noise_sum *noise)
{
    double sum = 0, amplitude = fabs(noise->amplitude);
    for (int octave = 0; octave < noise->octaves; octave++)
    {
        // Gradient noise is bounded by 1.04; ridged noise is between -1.2 and 1.
        sum += 1.2 * amplitude;
        amplitude *= noise->gain;
    }
    return sum;
}

static double clamp(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

void blended_body_begin(blended_body *body)
{
    *body = (blended_body){.count = 0};
    for (int c = 0; c < 3; c++)
    {
        body->low[c] = HUGE_VAL;
        body->high[c] = -HUGE_VAL;
    }
}

static blended_body_part *add_part(blended_body *body, blended_body_part part)
{
    assert(body->count < BLENDED_BODY_MAX_PARTS);
    static const double AXES[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    memcpy(part.axes, AXES, sizeof AXES);
    body->parts[body->count] = part;
    return &body->parts[body->count++];
}

static void widen(blended_body *body, const double *middle, double radius)
{
    for (int c = 0; c < 3; c++)
    {
        body->low[c] = fmin(body->low[c], middle[c] - radius);
        body->high[c] = fmax(body->high[c], middle[c] + radius);
    }
}

blended_body_part *blended_body_round_cone(blended_body *body, const double a[3], const double b[3], double radius_a,
                                           double radius_b, double blend)
{
    blended_body_part part = {.kind = BLENDED_BODY_ROUND_CONE, .radius = {radius_a, radius_b, 0}, .blend = blend};
    memcpy(part.a, a, sizeof part.a);
    memcpy(part.b, b, sizeof part.b);
    widen(body, a, 1.3 * radius_a);
    widen(body, b, 1.3 * radius_b);
    return add_part(body, part);
}

blended_body_part *blended_body_ellipsoid(blended_body *body, const double middle[3], double x, double y, double z,
                                          double blend)
{
    blended_body_part part = {.kind = BLENDED_BODY_ELLIPSOID, .radius = {x, y, z}, .blend = blend};
    memcpy(part.a, middle, sizeof part.a);
    widen(body, middle, 1.2 * fmax(fmax(x, y), z));
    return add_part(body, part);
}

blended_body_part *blended_body_ring(blended_body *body, const double middle[3], const double across[3], double radius,
                                     double tube, double blend)
{
    blended_body_part part = {.kind = BLENDED_BODY_TORUS, .radius = {radius, tube, 0}, .blend = blend};
    memcpy(part.a, middle, sizeof part.a);
    widen(body, middle, radius + 1.3 * tube);
    blended_body_part *added = add_part(body, part);
    memcpy(added->axes[2], across, sizeof added->axes[2]);
    return added;
}

blended_body_part *blended_body_box(blended_body *body, const double middle[3], double x, double y, double z,
                                    double rounding, double blend)
{
    blended_body_part part = {.kind = BLENDED_BODY_BOX, .radius = {x, y, z}, .b = {rounding, 0, 0}, .blend = blend};
    memcpy(part.a, middle, sizeof part.a);
    widen(body, middle, sqrt(x * x + y * y + z * z));
    return add_part(body, part);
}

static void turn_about(double axes[3][3], int u, int v, double angle)
{
    double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++)
    {
        double along = axes[i][u], across = axes[i][v];
        axes[i][u] = c * along - s * across;
        axes[i][v] = s * along + c * across;
    }
}

void blended_body_turn(blended_body_part *part, double x, double y, double z)
{
    turn_about(part->axes, 1, 2, x);
    turn_about(part->axes, 2, 0, y);
    turn_about(part->axes, 0, 1, z);
}

/// The signed distance of a round cone, measured across its axis: exact for equal radii.
static double round_cone_distance(const blended_body *body, const blended_body_part *part, const double *point)
{
    double along[3], away[3];
    for (int c = 0; c < 3; c++)
    {
        along[c] = part->b[c] - part->a[c];
        away[c] = point[c] - part->a[c];
    }
    double share = clamp(vector3_dot(away, along) / fmax(vector3_dot(along, along), 1e-12), 0, 1);
    for (int c = 0; c < 3; c++)
        away[c] -= share * along[c];
    double radius = part->radius[0] + share * (part->radius[1] - part->radius[0]);
    double distance = sqrt(vector3_dot(away, away));
    if (body->ridges == 0 || distance > 3 * radius)
        return distance - radius;
    // The angle around the axis, from a common reference direction.
    double length = sqrt(vector3_dot(along, along)) + 1e-12;
    double reference[3] = {0.31, 0.17, 0.02}, side[3];
    double slant = vector3_dot(reference, along) / (length * length);
    for (int c = 0; c < 3; c++)
        reference[c] -= slant * along[c];
    side[0] = (along[1] * reference[2] - along[2] * reference[1]) / length;
    side[1] = (along[2] * reference[0] - along[0] * reference[2]) / length;
    side[2] = (along[0] * reference[1] - along[1] * reference[0]) / length;
    double angle = atan2(vector3_dot(away, side), vector3_dot(away, reference));
    double depth = body->ridges * radius * fmin(1, distance / (0.5 * radius));
    return distance - radius + depth * (1 - sqrt(pow(cos(0.5 * body->ridge_count * angle), 2) + 0.04));
}

/// The estimate of Quilez for ellipsoids: |p/r| (|p/r| - 1) / |p/r^2|.
static double ellipsoid_distance(const blended_body_part *part, const double *point)
{
    double away[3], once = 0, twice = 0;
    for (int c = 0; c < 3; c++)
        away[c] = point[c] - part->a[c];
    for (int c = 0; c < 3; c++)
    {
        double scaled = vector3_dot(away, part->axes[c]) / part->radius[c];
        once += scaled * scaled;
        twice += scaled * scaled / (part->radius[c] * part->radius[c]);
    }
    double minimum = fmin(fmin(part->radius[0], part->radius[1]), part->radius[2]);
    once = sqrt(once);
    // Near the centre the estimate is too steep.
    return once < 1e-3 ? -minimum : fmax(once * (once - 1) / sqrt(twice), -minimum);
}

static double ring_distance(const blended_body_part *part, const double *point)
{
    double away[3];
    for (int c = 0; c < 3; c++)
        away[c] = point[c] - part->a[c];
    double height = vector3_dot(away, part->axes[2]);
    double across = sqrt(fmax(vector3_dot(away, away) - height * height, 0)) - part->radius[0];
    return sqrt(across * across + height * height) - part->radius[1];
}

/// The signed distance of a box with rounded edges.
static double box_distance(const blended_body_part *part, const double *point)
{
    double away[3], out[3], rounding = part->b[0], maximum = -HUGE_VAL;
    for (int c = 0; c < 3; c++)
        away[c] = point[c] - part->a[c];
    for (int c = 0; c < 3; c++)
    {
        double beyond = fabs(vector3_dot(away, part->axes[c])) - part->radius[c] + rounding;
        maximum = fmax(maximum, beyond);
        out[c] = fmax(beyond, 0);
    }
    return sqrt(vector3_dot(out, out)) + fmin(maximum, 0) - rounding;
}

static double part_distance(const blended_body *body, const blended_body_part *part, const double *point)
{
    switch (part->kind)
    {
    case BLENDED_BODY_ROUND_CONE:
        return round_cone_distance(body, part, point);
    case BLENDED_BODY_ELLIPSOID:
        return ellipsoid_distance(part, point);
    case BLENDED_BODY_TORUS:
        return ring_distance(part, point);
    case BLENDED_BODY_BOX:
        return box_distance(part, point);
    }
    return 0;
}

/// The cubic smooth minimum: min(a, b) - h^3 width / 6, h = max(width - |a - b|, 0) / width. It is twice continuously
/// differentiable.
static double smooth_min(double a, double b, double width)
{
    double overlap = fmax(width - fabs(a - b), 0) / width;
    return fmin(a, b) - overlap * overlap * overlap * width / 6;
}

double blended_body_value(const void *context, const double point[3])
{
    const blended_body *body = context;
    double value = HUGE_VAL;
    for (size_t i = 0; i < body->count; i++)
    {
        const blended_body_part *part = &body->parts[i];
        double distance = part_distance(body, part, point);
        if (i == 0)
            value = distance;
        else if (part->subtracted)
            value = -smooth_min(-value, distance, part->blend);
        else
            value = smooth_min(value, distance, part->blend);
    }
    if (body->noise.amplitude != 0 && fabs(value) < 4 * fabs(body->noise.amplitude) + 0.2)
        value += noise_sum_at(&body->noise, point);
    if (body->ridged_noise.amplitude != 0 && fabs(value) < 4 * fabs(body->ridged_noise.amplitude) + 0.2)
        value += noise_sum_at(&body->ridged_noise, point);
    return value;
}
