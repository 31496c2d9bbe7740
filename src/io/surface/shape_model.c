#include "io/surface/step.h"
#include "linalg/vector.h"
#include "surface/trim/trimming.h"

#include <string.h>

/// @file
/// The edges of a simple shape for CAD files: trimming curves in space, which lie on the shape, become lines and circles
/// where these are no farther from them than the points are from the shape. Each shape is one of revolution around an axis
/// through its place: a point and its foot are in the same half-plane.

/// The largest angle around the axis that needs no seam, and the largest height on a sphere, in its radii.
static const double MAX_ANGLE = 0.98 * ANGLE_TURN, MAX_HEIGHT = 0.9;

static void to_frame(const shape_model *model, const double point[3], double at[3])
{
    double from[3];
    vector3_subtract(point, model->shape.place, from);
    for (int k = 0; k < 3; k++)
        at[k] = vector3_dot(from, model->axes[k]);
}

void shape_model_project(const shape_model *model, const double point[3], double foot[3])
{
    double at[3], factor = 1, sine = sin(model->shape.angle), cosine = cos(model->shape.angle);
    to_frame(model, point, at);
    double distance = hypot(at[0], at[1]), along = at[2] * cosine + distance * sine;
    if (model->shape.kind == BAT_SURFACE_PRIMITIVE_PLANE)
        at[2] = 0;
    else if (model->shape.kind == BAT_SURFACE_PRIMITIVE_CYLINDER)
        factor = model->shape.radius / distance;
    else if (model->shape.kind == BAT_SURFACE_PRIMITIVE_SPHERE)
    {
        factor = model->shape.radius / hypot(distance, at[2]);
        at[2] *= factor;
    }
    else
    {
        factor = along * sine / distance;
        at[2] = along * cosine;
    }
    for (int c = 0; c < 3; c++)
        foot[c] = model->shape.place[c] + at[2] * model->axes[2][c] +
                  factor * (at[0] * model->axes[0][c] + at[1] * model->axes[1][c]);
}

/// Whether a line between the ends is near the curve, and on the shape.
static bool is_line(const shape_model *model, const bat_spline_curve *image, double limit, double exact)
{
    size_t last = knot_vector_functions(&image->knots) - 1;
    const double *from = image->control, *to = from + 3 * last;
    double middle[3], foot[3], product[3], length = vector3_distance(from, to), largest = 0;
    for (size_t i = 1; i < last; i++)
    {
        vector3_triangle(from, to, image->control + 3 * i, product);
        largest = fmax(largest, vector3_length(product) / length);
    }
    for (int c = 0; c < 3; c++)
        middle[c] = (from[c] + to[c]) / 2;
    shape_model_project(model, middle, foot);
    return length > exact && largest <= limit && vector3_distance(foot, middle) <= exact;
}

/// Whether a closed curve is near the circle of its area around the mean of its cubics' ends. Puts its ends on it then.
static bool is_circle(bat_spline_curve *image, double limit, shape_curve *circle)
{
    size_t last = knot_vector_functions(&image->knots) - 1;
    double *end = image->control, largest = 0;
    for (size_t i = 0; i < 3 * last; i += i % 3 == 2 ? 7 : 1)
        circle->place[i % 3] += 3 * end[i] / (double)last;
    for (size_t i = 0; i < last; i += 3)
        largest = fmax(largest, fabs(vector3_distance(end + 3 * i, circle->place) - circle->radius));
    bool near = last >= 24 && largest <= limit && circle->radius > 4 * limit;
    double stretch = circle->radius / vector3_distance(end, circle->place);
    for (size_t c = 0; c < 3 && near; c++)
        end[3 * last + c] = end[c] = circle->place[c] + stretch * (end[c] - circle->place[c]);
    return near;
}

/// The area that a curve adds by Green's formula: f(height, distance) times the angle around the axis. The range receives
/// the extremes of the angle from the first point of the outline, and the largest height.
static double area_of(const shape_model *model, const bat_spline_curve *image, double *angle, double range[3])
{
    static const size_t STEPS = 64; ///< of a cubic
    bool plane = model->shape.kind == BAT_SURFACE_PRIMITIVE_PLANE, cone = model->shape.kind == BAT_SURFACE_PRIMITIVE_CONE;
    size_t steps = STEPS * (knot_vector_functions(&image->knots) / 3);
    double sum = 0, place[3], at[3], next[3];
    to_frame(model, image->control, at);
    for (size_t k = 1; k <= steps; k++)
    {
        spline_curve_place(image, (double)k / (double)steps, place);
        to_frame(model, place, next);
        double cross = at[0] * next[1] - at[1] * next[0], along = at[0] * next[0] + at[1] * next[1];
        double turn = plane ? 0 : atan2(cross, along);
        sum += plane  ? cross / 2
               : cone ? -along * turn / (2 * sin(model->shape.angle))
                      : -model->shape.radius * (at[2] + next[2]) / 2 * turn;
        *angle += turn;
        range[0] = fmin(range[0], *angle);
        range[1] = fmax(range[1], *angle);
        range[2] = fmax(range[2], fabs(next[2]));
        memcpy(at, next, sizeof at);
    }
    return sum;
}

void shape_model_begin(const bat_surface_primitive *shape, const double middle[3], shape_model *model)
{
    bool sphere = shape->kind == BAT_SURFACE_PRIMITIVE_SPHERE;
    *model = (shape_model){.shape = *shape};
    memcpy(model->axes[2], shape->axis, sizeof shape->axis);
    if (sphere)
        vector3_subtract(middle, shape->place, model->axes[2]);
    vector3_complete(model->axes);
    for (int c = 0; c < 3 && sphere; c++) // its poles are as far as can be from the surface
    {
        double swap = model->axes[2][c];
        model->axes[2][c] = model->axes[0][c];
        model->axes[0][c] = -swap;
    }
}

bool shape_model_end(trimmed_model *made)
{
    static const double EXACT = 10; ///< in units of the tolerance
    shape_model *model = &made->shape;
    double exact = EXACT * made->tolerance, limit = fmax(exact, model->shape.rms);
    double ranges[2][3] = {{0}}, *range = ranges[0], angle = 0, first[3]; // of the outline, and of holes
    bool plane = model->shape.kind == BAT_SURFACE_PRIMITIVE_PLANE,
         sphere = model->shape.kind == BAT_SURFACE_PRIMITIVE_SPHERE;
    for (size_t l = 0; l < made->trim->loop_count; l++)
        for (size_t i = made->trim->loops[l]; i < made->trim->loops[l + 1]; i++)
        {
            bat_spline_curve *image = &made->images[i];
            shape_curve *curve = &made->curves[i];
            bool closed = made->trim->loops[l + 1] == made->trim->loops[l] + 1;
            size_t last = knot_vector_functions(&image->knots) - 1;
            double *end = image->control;
            if (!closed && is_line(model, image, limit, exact))
                curve->kind = SHAPE_LINE;
            for (size_t k = 3; k < 3 * last && curve->kind == SHAPE_LINE; k++)
                end[k] = end[k % 3] + floor((double)k / 3) / (double)last * (end[3 * last + k % 3] - end[k % 3]);
            double area = area_of(model, image, &angle, ranges[l > 0]);
            *curve = (shape_curve){.kind = curve->kind, .radius = sqrt(fabs(area) / ANGLE_PI)};
            if (closed && plane && is_circle(image, limit, curve))
                curve->kind = SHAPE_CIRCLE;
            for (size_t c = 0; c < 3; c++)
            {
                curve->axis[c] = copysign(1, area) * model->axes[2][c];
                curve->place[c] = curve->kind == SHAPE_LINE ? 2 * end[c] - end[3 * last + c] : curve->place[c];
            }
            model->area += area;
        }
    to_frame(model, made->images[0].control, first);
    model->height = first[2];
    double turn = atan2(first[1], first[0]) + (range[0] + range[1]) / 2 + ANGLE_PI;
    for (int c = 0; c < 3; c++)
    {
        double x = model->axes[0][c], y = model->axes[1][c];
        model->axes[0][c] = cos(turn) * x + sin(turn) * y;
        model->axes[1][c] = cos(turn) * y - sin(turn) * x;
    }
    bool high = sphere && range[2] > MAX_HEIGHT * model->shape.radius;
    return plane || (!high && range[1] - range[0] < MAX_ANGLE && fabs(angle) < 1);
}
