#include "base/error.h"
#include "draw/curve/scene.h"

#include <string.h>

/// @file
/// The curvature vector at p, with unit tangents a and b towards its neighbours and edges of lengths l_a and l_b, is 2
/// angle(-a, b) / (l_a + l_b) in the direction of a + b.

/// The Möbius translation (z + w) / (1 + conj(w) z) of the disk, which maps 0 to w.
static void translate(const double *w, const double *z, double *result)
{
    double real = 1.0 + w[0] * z[0] + w[1] * z[1], imaginary = w[0] * z[1] - w[1] * z[0];
    double x = z[0] + w[0], y = z[1] + w[1];
    double square = real * real + imaginary * imaginary;
    double result_x = (x * real + y * imaginary) / square;
    result[1] = (y * real - x * imaginary) / square;
    result[0] = result_x;
}

/// The unit tangent vector at p towards q.
/// @return the distance from p to q; 0 with a zero vector when they coincide
static double direction_to(const comb *segments, const double *p, const double *q, double *direction)
{
    size_t n = segments->point_dim;
    if (segments->space == VIEW_DISK)
    {
        double back[2] = {-p[0], -p[1]};
        translate(back, q, direction);
    }
    else
    {
        double square = segments->space == VIEW_SPHERE ? vector_dot(n, p, p) : 1.0;
        vector_subtract(n, q, p, direction);
        double radial = segments->space == VIEW_SPHERE ? vector_dot(n, direction, p) / square : 0.0;
        for (size_t k = 0; k < n && radial != 0.0; k++)
            direction[k] -= radial * p[k];
    }
    double length = sqrt(vector_dot(n, direction, direction));
    for (size_t k = 0; k < n; k++)
        direction[k] = length > 0.0 ? direction[k] / length : 0.0;
    if (segments->space == VIEW_SPHERE)
        return atan2(length, vector_dot(n, p, q));
    return segments->space == VIEW_DISK ? 2.0 * atanh(fmin(length, 1.0 - 1e-16)) : length;
}

/// Set the negative curvature vector at p. With unit tangents a towards `before` and b towards `after`, the exterior angle
/// is the angle between -a and b, and the direction is that of a + b.
static void set_vector(const comb *segments, const double *before, const double *p, const double *after, double *scratch,
                       double *vector)
{
    size_t n = segments->point_dim;
    double *a = scratch, *b = scratch + n;
    double mean = 0.5 * (direction_to(segments, p, before, a) + direction_to(segments, p, after, b));
    double sum = 0.0, difference = 0.0;
    for (size_t k = 0; k < n; k++)
    {
        sum += (a[k] + b[k]) * (a[k] + b[k]);
        difference += (b[k] - a[k]) * (b[k] - a[k]);
    }
    double angle = 2.0 * atan2(sqrt(sum), sqrt(difference));
    double factor = sum > 0.0 && mean > 0.0 ? -angle / (mean * sqrt(sum)) : 0.0;
    for (size_t k = 0; k < n; k++)
        vector[k] = factor * (a[k] + b[k]);
}

bat_status comb_make(const bat_curve *curve, comb *segments, bat_error *error)
{
    size_t n = curve->space->point_dim;
    size_t stride = (curve->count + COMB_MAX_POINTS - 1) / COMB_MAX_POINTS;
    size_t count = (curve->count + stride - 1) / stride;
    *segments = (comb){.space = view_space_of(curve->space), .point_dim = n, .count = count, .closed = curve->closed};
    segments->points = memory_pool_array(&segments->pool, count * n, sizeof(double));
    segments->vectors = memory_pool_zeros(&segments->pool, count * n, sizeof(double));
    double *scratch = memory_pool_array(&segments->pool, 2 * n, sizeof(double));
    if (segments->pool.missing > 0)
        return memory_pool_check(&segments->pool, error);
    for (size_t i = 0; i < count; i++)
        memcpy(segments->points + i * n, curve->points + i * stride * n, n * sizeof(double));
    for (size_t i = segments->closed ? 0 : 1; i + (segments->closed ? 0 : 1) < segments->count && segments->count >= 3; i++)
    {
        size_t before = i > 0 ? i - 1 : segments->count - 1;
        size_t after = i + 1 < segments->count ? i + 1 : 0;
        set_vector(segments, segments->points + before * n, segments->points + i * n, segments->points + after * n, scratch,
                   segments->vectors + i * n);
    }
    return BAT_OK;
}

bat_status comb_natural_scale(const comb *segments, double usual, double longest, double *scale, bat_error *error)
{
    size_t n = segments->point_dim;
    double *sizes = memory_array(segments->count, sizeof(double));
    if (sizes == NULL)
        return error_memory(error, segments->count * sizeof(double));
    for (size_t i = 0; i < segments->count; i++)
        sizes[i] = sqrt(vector_dot(n, segments->vectors + i * n, segments->vectors + i * n));
    qsort(sizes, segments->count, sizeof(double), ascending);
    double large = sizes[(size_t)(0.95 * (double)(segments->count - 1))];
    double largest = sizes[segments->count - 1];
    free(sizes);
    *scale = largest > 0.0 ? fmin(usual / large, longest / largest) : INFINITY;
    return BAT_OK;
}

void comb_tip(const comb *segments, size_t index, double scale, double *tip)
{
    size_t n = segments->point_dim;
    const double *p = segments->points + index * n;
    const double *vector = segments->vectors + index * n;
    double length = sqrt(vector_dot(n, vector, vector));
    double reach = scale * length;
    double along = length > 0.0 ? scale : 0.0, stay = 1.0;
    if (segments->space == VIEW_SPHERE && length > 0.0)
    {
        stay = cos(reach);
        along = sin(reach) / length;
    }
    if (segments->space == VIEW_DISK && length > 0.0)
    {
        stay = 0.0;
        along = tanh(0.5 * reach) / length;
    }
    for (size_t k = 0; k < n; k++)
        tip[k] = stay * p[k] + along * vector[k];
    if (segments->space == VIEW_DISK && length > 0.0)
        translate(p, tip, tip);
}

/// The smallest distance between the starts of two drawn segments or, where these are closer, between their ends.
#define FOOT_SPACING 2.2
#define TIP_SPACING 6.6

typedef struct comb_segment
{
    double foot_x, foot_y;
    double tip_x, tip_y;
} comb_segment;

bat_status comb_lines_draw(cairo_t *cairo, const draw_view *view, const comb *segments, double scale, draw_colour colour,
                           bat_error *error)
{
    size_t n = segments->point_dim, margin = segments->closed ? 0 : 1, end = segments->count - margin;
    if (segments->count < 3)
        return BAT_OK;
    memory_pool pool = {0};
    double *tips = memory_pool_array(&pool, segments->count * n, sizeof *tips);
    double *segment = memory_pool_array(&pool, 2 * n, sizeof *segment);
    bat_status status = memory_pool_check(&pool, error);
    for (size_t i = 0; i < segments->count && status == BAT_OK; i++)
        comb_tip(segments, i, scale, tips + i * n);
    line_style thin = {style_mix(colour, COLOUR_BACKGROUND, 0.4), LINE_COMB, 0.0, 0.0};
    line_style envelope = {style_mix(colour, COLOUR_BACKGROUND, 0.6), LINE_ENVELOPE, 0.0, 0.0};
    comb_segment last = {0};
    for (size_t i = margin; i < end && status == BAT_OK; i++)
    {
        const double *foot = segments->points + i * n, *tip = tips + i * n;
        comb_segment placed;
        view_place(view, foot, &placed.foot_x, &placed.foot_y);
        view_place(view, tip, &placed.tip_x, &placed.tip_y);
        bool crowded = hypot(placed.foot_x - last.foot_x, placed.foot_y - last.foot_y) < FOOT_SPACING &&
                       hypot(placed.tip_x - last.tip_x, placed.tip_y - last.tip_y) < TIP_SPACING;
        if (i == margin || !crowded)
        {
            memcpy(segment, foot, n * sizeof(double));
            memcpy(segment + n, tip, n * sizeof(double));
            drawn_line drawn = {view, segment, 2, false, VIEW_FRONT};
            status = stroke_line(cairo, &drawn, thin, error);
            last = placed;
        }
    }
    if (status == BAT_OK)
    {
        drawn_line drawn = {view, tips + margin * n, end - margin, segments->closed, VIEW_FRONT};
        status = stroke_line(cairo, &drawn, envelope, error);
    }
    memory_pool_free(&pool);
    return status;
}
