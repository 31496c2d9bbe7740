#include "batten/surface.h"

#include "base/choice.h"
#include "base/error.h"
#include "linalg/symmetric.h"
#include "surface/cloud/local_plane.h"

#include <string.h>

/// @file
/// Simple shapes of least squared distance, by the method of Levenberg and Marquardt (Shakarji, "Least-squares fitting
/// algorithms of the NIST algorithm testing system", 1998). All but spheres are cones, in a frame whose last axis is that of
/// the cone: a point at height z and at rho from the axis has the distance (rho - radius) cos(angle) - z sin(angle). The
/// angle of a cylinder is 0, that of a plane a right one. Coordinates are in a unit_frame.

static const bat_choice KINDS[] = {
    CHOICE("none", "no simple shape", BAT_SURFACE_PRIMITIVE_NONE),
    CHOICE("plane", "a normal and a place", BAT_SURFACE_PRIMITIVE_PLANE),
    CHOICE("sphere", "a centre and a radius", BAT_SURFACE_PRIMITIVE_SPHERE),
    CHOICE("cylinder", "an axis and a radius", BAT_SURFACE_PRIMITIVE_CYLINDER),
    CHOICE("cone", "an axis from an apex, and an angle", BAT_SURFACE_PRIMITIVE_CONE),
};
const bat_family bat_surface_primitive_kind_family = FAMILY("simple shape", KINDS);

#define PARAMETERS 7 ///< three shifts along the frame, two tilts, radius, angle

/// The parameters of each kind, and their number.
static const bool FREE[][PARAMETERS] = {[BAT_SURFACE_PRIMITIVE_PLANE] = {0, 0, 1, 1, 1},
                                        [BAT_SURFACE_PRIMITIVE_SPHERE] = {1, 1, 1, 0, 0, 1},
                                        [BAT_SURFACE_PRIMITIVE_CYLINDER] = {1, 1, 0, 1, 1, 1},
                                        [BAT_SURFACE_PRIMITIVE_CONE] = {1, 1, 0, 1, 1, 1, 1}};
static const double FREEDOM[] = {0, 3, 4, 5, 6};

/// A shape, and how well it fits some points.
typedef struct shape_fit
{
    bat_surface_primitive_kind kind;
    double place[3], axes[3][3], radius, angle;
    double squares;                                               ///< the sum of squared distances d
    double matrix[PARAMETERS * PARAMETERS], gradient[PARAMETERS]; ///< J^T J and J^T d for the Jacobian J of d
} shape_fit;

/// The signed distance of a point, and its derivatives by all parameters. Those by the shifts are the negative gradient.
static double distance_of(const shape_fit *fit, const double point[3], double row[PARAMETERS])
{
    double from[3], at[3], sine = sin(fit->angle), cosine = cos(fit->angle);
    vector3_subtract(point, fit->place, from);
    for (int k = 0; k < 3; k++)
        at[k] = vector3_dot(from, fit->axes[k]);
    bool sphere = fit->kind == BAT_SURFACE_PRIMITIVE_SPHERE;
    double across = sphere ? vector3_length(at) : hypot(at[0], at[1]), inverse = across > 0 ? 1 / across : 0;
    for (int k = 0; k < 2; k++)
    {
        row[k] = -at[k] * inverse * cosine;
        row[3 + k] = at[2] * row[k] - at[k] * sine;
    }
    row[2] = sphere ? -at[2] * inverse : sine;
    row[5] = -cosine;
    row[6] = -(across - fit->radius) * sine - at[2] * cosine;
    return (across - fit->radius) * cosine - at[2] * sine;
}

static void add_squares(const double *row, double value, double *matrix, double *gradient)
{
    for (size_t i = 0; i < PARAMETERS; i++)
        vector_add(PARAMETERS, row[i], row, matrix + PARAMETERS * i);
    vector_add(PARAMETERS, value, row, gradient);
}

/// Set the squares, the matrix and the gradient.
static void measure(const double *points, size_t count, size_t stride, shape_fit *fit)
{
    double row[PARAMETERS];
    memset(fit->matrix, 0, sizeof fit->matrix);
    memset(fit->gradient, 0, sizeof fit->gradient);
    fit->squares = 0;
    for (size_t i = 0; i < count; i += stride)
    {
        double distance = distance_of(fit, points + 3 * i, row);
        for (size_t k = 0; k < PARAMETERS; k++)
            row[k] *= FREE[fit->kind][k];
        fit->squares += distance * distance;
        add_squares(row, distance, fit->matrix, fit->gradient);
    }
}

/// Solve (matrix + damping I) x = right in the span of the matrix, which is destroyed.
static void solve(double *matrix, const double *right, double damping, double x[PARAMETERS])
{
    double vectors[PARAMETERS * PARAMETERS], largest = 0;
    symmetric_eigen(PARAMETERS, matrix, vectors, SYMMETRIC_BY_NORM);
    memset(x, 0, PARAMETERS * sizeof *x);
    for (size_t k = 0; k < PARAMETERS; k++)
        largest = fmax(largest, matrix[(PARAMETERS + 1) * k]);
    for (size_t k = 0; k < PARAMETERS; k++)
    {
        const double value = matrix[(PARAMETERS + 1) * k], *vector = vectors + PARAMETERS * k;
        double along = vector_dot(PARAMETERS, vector, right) / (value + damping * largest);
        for (size_t i = 0; i < PARAMETERS && value > 1e-14 * largest; i++)
            x[i] += vector[i] * along;
    }
}

/// Minimize the squares over every `stride`-th point.
static void refine(const double *points, size_t count, size_t stride, int rounds, shape_fit *fit)
{
    double damping = 1e-4, step[PARAMETERS];
    bool goes_on = true;
    measure(points, count, stride, fit);
    for (int round = 0; round < rounds && goes_on && damping < 1e3; round++)
    {
        shape_fit next = *fit;
        solve(next.matrix, next.gradient, damping, step);
        for (int c = 0; c < 3; c++)
        {
            next.place[c] -= step[0] * fit->axes[0][c] + step[1] * fit->axes[1][c] + step[2] * fit->axes[2][c];
            next.axes[2][c] -= step[3] * fit->axes[0][c] + step[4] * fit->axes[1][c];
        }
        vector3_complete(next.axes);
        next.radius -= step[5];
        next.angle -= step[6];
        measure(points, count, stride, &next);
        bool better = next.squares < fit->squares;
        goes_on = !better || next.squares < (1 - 1e-12) * fit->squares;
        damping *= better ? 0.1 : 10;
        *fit = better ? next : *fit;
    }
}

/// The shape with given axes that solves linear equations: x^2 + y^2 + z^2 = 2 (c, d, e) (x, y, z) + f for a sphere, x^2 +
/// y^2 = 2 (c, d) (x, y) + f + g z + h z^2 for a cone.
static void begin(const double *points, size_t count, size_t stride, shape_fit *fit)
{
    double matrix[PARAMETERS * PARAMETERS] = {0}, right[PARAMETERS] = {0}, x[PARAMETERS];
    fit->angle = acos(0);
    if (fit->kind == BAT_SURFACE_PRIMITIVE_PLANE)
        return;
    bool sphere = fit->kind == BAT_SURFACE_PRIMITIVE_SPHERE, cone = fit->kind == BAT_SURFACE_PRIMITIVE_CONE;
    for (size_t i = 0; i < count; i += stride)
    {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = vector3_dot(points + 3 * i, fit->axes[k]);
        double square = at[2] * at[2];
        const double row[PARAMETERS] = {at[0], at[1], sphere ? at[2] : 0, 1, cone ? at[2] : 0, cone ? square : 0};
        add_squares(row, at[0] * at[0] + at[1] * at[1] + (sphere ? square : 0), matrix, right);
    }
    solve(matrix, right, 0, x);
    for (int c = 0; c < 3; c++)
        fit->place[c] = (x[0] * fit->axes[0][c] + x[1] * fit->axes[1][c] + x[2] * fit->axes[2][c]) / 2;
    fit->radius = sqrt(fmax(x[3] + vector3_dot(fit->place, fit->place), 0));
    fit->angle = atan(copysign(sqrt(fmax(x[5], 0)), x[4]));
}

/// Fit a shape, from directions on half of a sphere, evenly along a spiral.
static void fit_shape(const double *points, size_t count, shape_fit *fit)
{
    const double golden = 2.39996322972865332;
    const size_t starts = 60, few = count / 200 + 1;
    fit->squares = INFINITY;
    for (size_t k = 0; k < starts; k++)
    {
        double z = ((double)k + 0.5) / (double)starts, r = sqrt(1 - z * z), turn = golden * (double)k;
        shape_fit start = {.kind = fit->kind, .axes[2] = {r * cos(turn), r * sin(turn), z}};
        vector3_complete(start.axes);
        begin(points, count, few, &start);
        refine(points, count, few, 20, &start);
        *fit = start.squares < fit->squares ? start : *fit;
    }
    refine(points, count, 1, 80, fit);
}

/// How alike the distances of neighbours are: squared sums of runs of neighbouring feet, against those of independent
/// distances, in standard deviations (Wilson and Hilferty, 1931). The largest of two lengths of runs.
/// @param feet receives count x 3
static bat_status find_pattern(const double *points, size_t count, const shape_fit *fit, double *feet, double *pattern,
                               bat_error *error)
{
    double row[PARAMETERS], variance = fit->squares / ((double)count - FREEDOM[fit->kind]);
    nearest_tree tree = {0};
    for (size_t i = 0; i < 3 * count; i++)
    {
        double distance = distance_of(fit, points + i - i % 3, row), slope = 0;
        for (size_t k = 0; k < 3; k++)
            slope += row[k] * fit->axes[k][i % 3];
        feet[i] = points[i] + distance * slope;
    }
    bat_status status = nearest_build(NEAREST_POINTS, feet, NULL, count, 3, &tree, error);
    for (size_t runs = 24; 3 * runs <= count && runs <= 96 && variance > 0 && status == BAT_OK; runs *= 4)
    {
        double squares = 0, sum = 0, ninth = 2 / (9 * (double)runs);
        for (size_t i = 0; i < count; i++)
        {
            sum += distance_of(fit, points + 3 * tree.items[i], row);
            if ((i + 1) * runs / count == i * runs / count)
                continue;
            squares += sum * sum / ((double)count * variance);
            sum = 0;
        }
        *pattern = fmax(*pattern, (cbrt(squares) - (1 - ninth)) / sqrt(ninth));
    }
    nearest_free(&tree);
    return status;
}

/// Fit a kind of shape to a part of the points in a frame, and measure it at all points.
static bat_status try_kind(const bat_cloud *cloud, const unit_frame *frame, double *places, size_t count,
                           bat_surface_primitive *shape, bat_error *error)
{
    shape_fit fit = {.kind = shape->kind};
    double unit = ldexp(1, 1 - frame->exponent), squares = 0, deviations[PARAMETERS], row[PARAMETERS];
    fit_shape(places, count, &fit);
    for (size_t k = 0; k < PARAMETERS; k++)
    {
        shape_fit copy = fit;
        const double one[PARAMETERS] = {k == 0, k == 1, k == 2, k == 3, k == 4, k == 5, k == 6};
        solve(copy.matrix, one, 0, row);
        deviations[k] = sqrt(row[k] * fit.squares / ((double)count - FREEDOM[fit.kind]));
    }
    for (size_t i = 0; i < cloud->count; i++)
    {
        double place[3];
        unit_frame_place(frame, cloud->points + 3 * i, place);
        double distance = unit * fabs(distance_of(&fit, place, row));
        shape->largest = fmax(shape->largest, distance);
        squares += distance * distance;
    }
    shape->rms = sqrt(squares / ((double)cloud->count - FREEDOM[fit.kind]));
    bool cone = fit.kind == BAT_SURFACE_PRIMITIVE_CONE;
    double apex = cone ? fit.radius / tan(fit.angle) : 0, way = cone ? copysign(1, fit.angle) : 1;
    for (int c = 0; c < 3; c++)
    {
        shape->place[c] = unit * (fit.place[c] - apex * fit.axes[2][c]) + frame->middle[c];
        shape->axis[c] = way * fit.axes[2][c];
    }
    shape->radius = FREE[fit.kind][5] && !cone ? unit * fit.radius : NAN;
    shape->angle = cone ? way * fit.angle : NAN;
    shape->place_deviation = cone ? NAN : unit * vector3_length(deviations);
    shape->axis_deviation = fit.kind == BAT_SURFACE_PRIMITIVE_SPHERE ? NAN : hypot(deviations[3], deviations[4]);
    shape->radius_deviation = isnan(shape->radius) ? NAN : unit * deviations[5];
    shape->angle_deviation = cone ? deviations[6] : NAN;
    return find_pattern(places, count, &fit, places + 3 * count, &shape->pattern, error);
}

bat_status bat_surface_find_primitive(const bat_cloud *cloud, const bat_surface_result *result, bat_surface_primitive *shape,
                                      bat_error *error)
{
    // Of the size, below which coordinates are rounded; what a noise may exceed its estimate by; and in standard deviations.
    static const double ROUNDED = 1e-6, NOISE = 1.1, PATTERN = 3, TAIL = 7;
    const bat_surface_fit_report *fit = &result->report;
    double limit = fit->held_out_count > 0 ? fit->expected_rms * (1 + 1 / sqrt(2 * (double)fit->held_out_count))
                                           : NOISE * result->noise;
    size_t each = cloud->count / 20000 + 1, count = (cloud->count + each - 1) / each;
    *shape = (bat_surface_primitive){.kind = BAT_SURFACE_PRIMITIVE_NONE};
    if (cloud->count <= 2 * PARAMETERS)
        return BAT_OK;
    double *places = memory_array(count, 6 * sizeof *places); // and feet
    if (places == NULL)
        return error_memory(error, count * 6 * sizeof *places);
    unit_frame frame = unit_frame_of(cloud->points, cloud->count);
    for (size_t i = 0; i < count; i++)
        unit_frame_place(&frame, cloud->points + 3 * each * i, places + 3 * i);
    bat_status status = BAT_OK;
    for (int kind = BAT_SURFACE_PRIMITIVE_PLANE;
         kind <= BAT_SURFACE_PRIMITIVE_CONE && shape->kind == BAT_SURFACE_PRIMITIVE_NONE && status == BAT_OK; kind++)
    {
        bat_surface_primitive tried = {.kind = (bat_surface_primitive_kind)kind};
        status = try_kind(cloud, &frame, places, count, &tried, error);
        bool even = tried.rms <= limit && tried.pattern <= PATTERN && tried.largest <= TAIL * tried.rms;
        if (status == BAT_OK && (even || tried.largest <= ROUNDED * ldexp(1, 1 - frame.exponent)))
            *shape = tried;
    }
    free(places);
    return status;
}
