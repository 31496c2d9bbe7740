/// @file
/// Random Bezier surfaces and clouds sampled from them (bat_cloud_bezier).

#include "research/shapes/surface_bezier.h"

#include "base/error.h"
#include "base/option.h"
#include "research/data/wave.h"
#include "research/shapes/cloud_sampling.h"

#include <math.h>

bat_cloud_bezier_options bat_cloud_bezier_defaults(void)
{
    return (bat_cloud_bezier_options){.degree = 2, .interior = 1000, .turned = true};
}

/// Draw a rotation with a uniform axis and a uniform angle (Rodrigues' formula).
static void draw_rotation(bat_random *random, double rotation[3][3])
{
    double height = draw_between(random, -1, 1), longitude = draw_angle(random), angle = draw_angle(random);
    double across = sqrt(1 - height * height), cosine = cos(angle), sine = sin(angle);
    const double axis[3] = {across * cos(longitude), across * sin(longitude), height};
    const double cross[3][3] = {{0, -axis[2], axis[1]}, {axis[2], 0, -axis[0]}, {-axis[1], axis[0], 0}};
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            rotation[r][c] = (r == c ? cosine : 0) + sine * cross[r][c] + (1 - cosine) * axis[r] * axis[c];
}

void bezier_surface_draw(int degree, bool turned, bat_random *random, bezier_surface *surface)
{
    double half = 0.5 / degree, rotation[3][3];
    double(*point)[3] = surface->control;
    surface->degree = degree;
    for (int j = 0; j <= degree; j++)
        for (int i = 0; i <= degree; i++, point++)
        {
            (*point)[0] = (double)i / degree + draw_between(random, -half, half);
            (*point)[1] = (double)j / degree + draw_between(random, -half, half);
            (*point)[2] = draw_between(random, -1, 1);
        }
    draw_rotation(random, rotation);
    for (point = surface->control; turned && point < surface->control + (degree + 1) * (degree + 1); point++)
    {
        // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): the loop above has set all points
        const double x = (*point)[0], y = (*point)[1], z = (*point)[2];
        for (int r = 0; r < 3; r++)
            (*point)[r] = rotation[r][0] * x + rotation[r][1] * y + rotation[r][2] * z;
    }
}

void bezier_basis(int degree, double t, double *value, double *slope)
{
    value[0] = 1;
    for (int d = 1; d <= degree; d++)
    {
        if (slope != NULL && d == degree)
            for (int i = 0; i <= d; i++)
                slope[i] = d * ((i > 0 ? value[i - 1] : 0) - (i < d ? value[i] : 0));
        value[d] = t * value[d - 1];
        for (int i = d - 1; i > 0; i--)
            value[i] = t * value[i - 1] + (1 - t) * value[i];
        value[0] *= 1 - t;
    }
}

void bezier_surface_at(const bezier_surface *surface, const double parameter[2], double point[3])
{
    double of_u[BEZIER_MAX_DEGREE + 1], of_v[BEZIER_MAX_DEGREE + 1], sum[3] = {0};
    int degree = surface->degree;
    bezier_basis(degree, parameter[0], of_u, NULL);
    bezier_basis(degree, parameter[1], of_v, NULL);
    const double(*control)[3] = surface->control;
    for (int j = 0; j <= degree; j++)
        for (int i = 0; i <= degree; i++, control++)
        {
            double share = of_u[i] * of_v[j];
            for (int c = 0; c < 3; c++)
                sum[c] += share * (*control)[c];
        }
    for (int c = 0; c < 3; c++)
        point[c] = sum[c];
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_cloud_bezier_options, degree, OPTION_INT, 1, BEZIER_MAX_DEGREE),
    OPTION_FIELD(bat_cloud_bezier_options, noise, OPTION_NUMBER, 0, INFINITY),
};

static bat_status cloud_bezier_options_check(const void *opaque, bat_error *error)
{
    const bat_cloud_bezier_options *options = opaque;
    return options->side != 1 ? BAT_OK : error_option(error, "side", "is 1, but must be 0 or at least 2");
}

const bat_options_table bat_cloud_bezier_fields =
    OPTIONS_TABLE(bat_cloud_bezier_options, FIELDS, cloud_bezier_options_check);

/// Equally spaced boundary parameters, then uniformly distributed interior ones.
static void draw_parameters(sampled_cloud *sampled, size_t side, bat_random *random)
{
    double *parameter = sampled->parameters, *inside = parameter + 2 * sampled->cloud.boundary_count;
    for (int s = 0; s < 4; s++)
        for (size_t i = 0; i + 1 < side; i++, parameter += 2)
            square_side_at(s, (double)i / (double)(side - 1), parameter);
    for (const double *end = sampled->parameters + 2 * sampled->cloud.count; inside < end; inside++)
        *inside = bat_random_uniform(random);
}

bat_status bat_cloud_bezier(const bat_cloud_bezier_options *options, bat_random *random, bat_cloud *cloud,
                            double **parameters, bat_error *error)
{
    const bat_cloud_bezier_options defaults = bat_cloud_bezier_defaults();
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_cloud_bezier_fields, options, error);
    if (status != BAT_OK)
        return status;
    size_t side = options->side > 0 ? options->side : 2 + (size_t)lround(sqrt((double)options->interior));
    const size_t steps[4] = {side - 1, side - 1, side - 1, side - 1};
    sampled_cloud sampled;
    status = sampled_cloud_make(steps, options->interior, &sampled, error);
    if (status != BAT_OK)
        return status;
    bezier_surface surface;
    bezier_surface_draw(options->degree, options->turned, random, &surface);
    draw_parameters(&sampled, side, random);
    for (size_t i = 0; i < sampled.cloud.count; i++)
        bezier_surface_at(&surface, sampled.parameters + 2 * i, sampled.cloud.points + 3 * i);
    if (options->noise > 0)
        cloud_add_noise(&sampled.cloud, options->noise, random);
    sampled_cloud_move(&sampled, cloud, parameters);
    return BAT_OK;
}
