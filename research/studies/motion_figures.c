/// @file
/// Figures 1 to 4 of Ben-Zion Vardi, Dyn and Sharon on Hermite schemes on manifolds, made anew (bat_hermite_figure_make).

#include "batten/research/motion_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/space.h"
#include "research/studies/motion_curves.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PERIOD = 6.28318530717958647693;

enum
{
    TRUTH_POINTS = 480,
    LEVELS = 5,
    AVERAGES = 24, ///< weights of figure 1: 0, 1/24, …, 1
    TENSOR_LEVELS = 6,
    TRIANGLE_LEVEL = 2, ///< figure 4 shows the rotations of level 2
    MAX_SAMPLES = 64
};

/// The scheme of a panel.
typedef enum figure_scheme
{
    OURS,
    TRANSPORT,            ///< with derivatives with respect to the index
    TRANSPORT_DIRECTIONS, ///< with unit vectors instead
    AVERAGE               ///< averages of two points for all weights
} figure_scheme;

/// The data of a panel: a smooth curve and its samples.
typedef struct figure_data
{
    const char *words;
    study_curve curve;
    double begin, end; ///< parameter range; a period for closed curves
    bool closed;
    size_t samples;
    size_t levels;
} figure_data;

// The curves

/// Figure 1: a curve between the two tensors in `data`: a geodesic or, with a radius, an arc beside it.
static bat_status tensor_form(const study_curve *curve, double t, double *point)
{
    static const double AWAY[6] = {0, 0.8, 0, 0, 0.6, 0};
    const bat_space *space = curve->space;
    double between[6], tangent[6], height = curve->radius * sin(PERIOD / 2 * t);
    bat_status status = bat_space_geodesic(space, curve->data, curve->data + space->point_dim, t, between);
    for (size_t k = 0; k < space->tangent_dim; k++)
        tangent[k] = height * AWAY[k];
    return status == BAT_OK ? space->exp(space, between, tangent, point) : status;
}

static void set_unit(double x, double y, double z, double *point)
{
    double length = sqrt(x * x + y * y + z * z);
    point[0] = x / length;
    point[1] = y / length;
    point[2] = z / length;
}

static bat_status waves_form(const study_curve *curve, double t, double *point)
{
    (void)curve;
    set_unit(cos(t), sin(t), 0.6 * cos(4 * t), point);
    return BAT_OK;
}

static bat_status spiral_form(const study_curve *curve, double t, double *point)
{
    (void)curve;
    set_unit(cos(t), sin(t), 0.4 * t, point);
    return BAT_OK;
}

static bat_status eight_form(const study_curve *curve, double t, double *point)
{
    (void)curve;
    double c = cos(t), s = sin(t);
    const double matrix[9] = {0, -s, c, s, -c * c, -s * c, c, s * c, s * s};
    return bat_rotation_from_matrix(matrix, point, NULL);
}

static double parameter_of(const figure_data *data, size_t i, size_t count)
{
    return data->begin + (data->end - data->begin) * (double)i / (double)(data->closed ? count : count - 1);
}

// The panels

/// Append a curve to a panel.
static double *add_curve(bat_hermite_panel *panel, const bat_space *space, size_t count, bool closed,
                         bat_curve_layer_role role)
{
    double *points = memory_array(count, space->point_dim * sizeof *points);
    if (points == NULL)
        return NULL;
    panel->roles[panel->curve_count] = role;
    panel->curves[panel->curve_count++] = (bat_curve){.space = space, .points = points, .count = count, .closed = closed};
    return points;
}

static bat_status add_truth(const figure_data *data, size_t count, bat_hermite_panel *panel, bat_error *error)
{
    const bat_space *space = data->curve.space;
    double *points = add_curve(panel, space, count, data->closed, BAT_CURVE_LAYER_ROLE_TRUTH);
    if (points == NULL)
        return error_memory(error, count * space->point_dim * sizeof *points);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        status = study_curve_point(&data->curve, parameter_of(data, i, count), points + i * space->point_dim);
    return status == BAT_OK ? BAT_OK : error_set(error, status, BAT_NO_INDEX, 0, "the smooth curve has no point");
}

static bat_status add_copy(const bat_hermite_curve *curve, bat_curve_layer_role role, bat_hermite_panel *panel,
                           bat_error *error)
{
    size_t size = curve->count * curve->space->point_dim * sizeof(double);
    double *points = add_curve(panel, curve->space, curve->count, curve->closed, role);
    if (points == NULL)
        return error_memory(error, size);
    memcpy(points, curve->points, size);
    return BAT_OK;
}

/// The samples with the tangents for a scheme.
static bat_status sample(const figure_data *data, figure_scheme scheme, bat_hermite_curve *samples, bat_error *error)
{
    double parameters[MAX_SAMPLES];
    for (size_t i = 0; i < data->samples; i++)
        parameters[i] = parameter_of(data, i, data->samples);
    bat_status status = study_curve_sample(&data->curve, parameters, data->samples, data->closed, samples, error);
    if (status != BAT_OK || scheme != TRANSPORT)
        return status == BAT_OK ? bat_hermite_normalize(samples, error) : status;
    double spacing = parameters[1] - parameters[0];
    for (size_t i = 0; i < data->samples * data->curve.space->tangent_dim; i++)
        samples->tangents[i] *= spacing;
    return BAT_OK;
}

/// The averages of a pair for weights 0 … 1.
static bat_status average_all(const bat_hermite_curve *pair, bat_hermite_curve *fine, bat_error *error)
{
    const bat_space *space = pair->space;
    size_t n = space->point_dim, k = space->tangent_dim, count = AVERAGES + 1;
    bat_hermite_curve made = {.space = space, .count = count};
    made.points = memory_array(count, n * sizeof(double));
    made.tangents = memory_array(count, k * sizeof(double));
    made.times = memory_array(count, sizeof(double));
    bool has_memory = made.points != NULL && made.tangents != NULL && made.times != NULL;
    bat_status status = has_memory ? BAT_OK : error_memory(error, count * n * sizeof(double));
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        double weight = (double)i / AVERAGES;
        made.times[i] = pair->times[0] + weight * (pair->times[1] - pair->times[0]);
        status = bat_hermite_average(space, pair->points, pair->tangents, pair->points + n, pair->tangents + k, weight,
                                     made.points + i * n, made.tangents + i * k);
        if (status != BAT_OK)
            (void)error_set(error, status, i, 0, "the pair has no average of weight %g", weight);
    }
    if (status == BAT_OK)
        *fine = made;
    else
        bat_hermite_free(&made);
    return status;
}

static bat_status refine(const bat_hermite_curve *samples, figure_scheme scheme, size_t order, size_t levels,
                         bat_hermite_curve *fine, bat_error *error)
{
    if (scheme == AVERAGE)
        return average_all(samples, fine, error);
    bat_hermite_refine_options how = bat_hermite_refine_defaults();
    const bat_hermite_linear linear = {bat_hermite_mask_merrien(-0.125, -0.5), BAT_CURVE_BASE_VERTEX};
    how.order = scheme == OURS ? order : 1;
    how.levels = levels;
    return bat_hermite_transport_refine(samples, scheme == OURS ? NULL : &linear, &how, fine, error);
}

/// Add the smooth curve, the samples and the refined curve.
static bat_status draw_curves(const figure_data *data, const bat_hermite_curve *samples, const bat_hermite_curve *fine,
                              bat_hermite_panel *panel, bat_error *error)
{
    bool tensors = strcmp(data->curve.space->name, "spd") == 0;
    bat_status status = add_copy(samples, BAT_CURVE_LAYER_ROLE_CONTROL, panel, error);
    if (status == BAT_OK)
        status = add_truth(data, tensors ? AVERAGES + 1 : TRUTH_POINTS, panel, error);
    return status == BAT_OK ? add_copy(fine, BAT_CURVE_LAYER_ROLE_CURVE, panel, error) : status;
}

/// Figure 4: a corner of a triangle about (0, 1, 0).
static void corner_of(size_t corner, double *direction)
{
    double angle = PERIOD * ((double)corner / 3 + 0.25);
    set_unit(0.25 * cos(angle), 1, 0.25 * sin(angle), direction);
}

static void act(const double *quaternion, const double *direction, double *turned)
{
    double matrix[9];
    bat_rotation_to_matrix(quaternion, matrix);
    for (size_t row = 0; row < 3; row++)
        turned[row] =
            matrix[3 * row] * direction[0] + matrix[3 * row + 1] * direction[1] + matrix[3 * row + 2] * direction[2];
}

/// Add the paths of the triangle's corners on the sphere.
static bat_status add_corner_paths(const figure_data *data, const bat_space *sphere, bat_hermite_panel *panel,
                                   bat_error *error)
{
    for (size_t corner = 0; corner < 3; corner++)
    {
        double direction[3], quaternion[4];
        double *points = add_curve(panel, sphere, TRUTH_POINTS, data->closed, BAT_CURVE_LAYER_ROLE_TRUTH);
        if (points == NULL)
            return error_memory(error, TRUTH_POINTS * 3 * sizeof *points);
        corner_of(corner, direction);
        for (size_t i = 0; i < TRUTH_POINTS; i++)
        {
            bat_status status = study_curve_point(&data->curve, parameter_of(data, i, TRUTH_POINTS), quaternion);
            if (status != BAT_OK)
                return error_set(error, status, i, 0, "the smooth curve has no point");
            act(quaternion, direction, points + 3 * i);
        }
    }
    return BAT_OK;
}

/// Add a triangle for every rotation whose index is a multiple of `stride`.
static bat_status add_triangles(const bat_hermite_curve *rotations, size_t stride, const bat_space *sphere,
                                bat_curve_layer_role role, bat_hermite_panel *panel, bat_error *error)
{
    for (size_t i = 0; i < rotations->count; i += stride)
    {
        double *points = add_curve(panel, sphere, 3, true, role);
        if (points == NULL)
            return error_memory(error, 9 * sizeof *points);
        for (size_t corner = 0; corner < 3; corner++)
        {
            double direction[3];
            corner_of(corner, direction);
            act(rotations->points + 4 * i, direction, points + 3 * corner);
        }
    }
    return BAT_OK;
}

static bat_status draw_triangles(const figure_data *data, const bat_space *sphere, const bat_hermite_curve *samples,
                                 const bat_hermite_curve *fine, bat_hermite_panel *panel, bat_error *error)
{
    bat_status status = add_corner_paths(data, sphere, panel, error);
    if (status == BAT_OK)
        status =
            add_triangles(fine, (size_t)1 << (LEVELS - TRIANGLE_LEVEL), sphere, BAT_CURVE_LAYER_ROLE_CURVE, panel, error);
    return status == BAT_OK ? add_triangles(samples, 1, sphere, BAT_CURVE_LAYER_ROLE_CONTROL, panel, error) : status;
}

/// Add a panel: sample, refine, measure, and store the curves to draw.
static bat_status add_panel(bat_hermite_figure *figure, const figure_data *data, figure_scheme scheme, size_t order,
                            bat_error *error)
{
    static const char *const NAMES[] = {"hermite", "transport", "transport of directions", "hermite"};
    bat_hermite_panel *panel = &figure->panels[figure->panel_count++];
    *panel = (bat_hermite_panel){.data = data->words, .scheme = NAMES[scheme], .order = order, .samples = data->samples};
    bat_hermite_curve samples = {0}, fine = {0};
    bat_status status = sample(data, scheme, &samples, error);
    if (status == BAT_OK)
        status = refine(&samples, scheme, order, data->levels, &fine, error);
    if (status == BAT_OK && study_curve_error(&data->curve, &fine, &panel->error) != BAT_OK)
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the refined curve is too far from the smooth one");
    if (status == BAT_OK)
        status = strcmp(data->curve.space->name, "rotation") == 0
                     ? draw_triangles(data, &figure->spaces[1], &samples, &fine, panel, error)
                     : draw_curves(data, &samples, &fine, panel, error);
    bat_hermite_free(&samples);
    bat_hermite_free(&fine);
    return status;
}

// The figures

/// Two tensors with the directions of their geodesic, and with those of an arc beside it.
static bat_status make_tensors(bat_hermite_figure *figure, bat_error *error)
{
    static const double ENDS[12] = {1.6, 0, 0, 0.5, 0, 0.5, 0.5, -0.1, 0, 0.6, 0.3, 1.7};
    static const double HEIGHTS[2] = {0, 0.8};
    static const figure_scheme SCHEMES[2] = {AVERAGE, TRANSPORT};
    bat_status status = BAT_OK;
    figure->spaces[0] = bat_positive_definite(3);
    for (size_t i = 0; i < 4 && status == BAT_OK; i++)
    {
        bool arc = i / 2 == 1;
        figure_data data = {
            .words = arc ? "arc" : "geodesic",
            .curve = {.space = &figure->spaces[0], .form = tensor_form, .data = ENDS, .radius = HEIGHTS[i / 2]},
            .end = 1,
            .samples = 2,
            .levels = TENSOR_LEVELS};
        status = add_panel(figure, &data, SCHEMES[i % 2], SCHEMES[i % 2] == AVERAGE, error);
    }
    return status;
}

static bat_status make_orders(bat_hermite_figure *figure, bat_error *error)
{
    static const size_t ORDERS[3] = {1, 3, 10};
    figure_data waves = {.words = "waves",
                         .curve = {.space = &figure->spaces[0], .form = waves_form},
                         .begin = 0.2,
                         .end = 0.2 + PERIOD,
                         .closed = true,
                         .samples = 16,
                         .levels = LEVELS};
    figure->spaces[0] = bat_sphere(2);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < 3 && status == BAT_OK; i++)
        status = add_panel(figure, &waves, OURS, ORDERS[i], error);
    if (status == BAT_OK)
        status = add_panel(figure, &waves, TRANSPORT, 0, error);
    return status == BAT_OK ? add_panel(figure, &waves, TRANSPORT_DIRECTIONS, 0, error) : status;
}

static bat_status make_spiral(bat_hermite_figure *figure, bat_error *error)
{
    static const size_t COUNTS[3] = {11, 21, 41};
    static const char *const WORDS[3] = {"spiral, spacing 2", "spiral, spacing 1", "spiral, spacing 1/2"};
    bat_status status = BAT_OK;
    figure->spaces[0] = bat_sphere(2);
    for (size_t i = 0; i < 9 && status == BAT_OK; i++)
    {
        figure_data spiral = {.words = WORDS[i / 3],
                              .curve = {.space = &figure->spaces[0], .form = spiral_form},
                              .begin = -10,
                              .end = 10,
                              .samples = COUNTS[i / 3],
                              .levels = LEVELS};
        figure_scheme scheme = (figure_scheme)(i % 3);
        status = add_panel(figure, &spiral, scheme, scheme == OURS, error);
    }
    return status;
}

static bat_status make_rotations(bat_hermite_figure *figure, bat_error *error)
{
    figure_data eight = {.words = "figure of eight",
                         .curve = {.space = &figure->spaces[0], .form = eight_form},
                         .end = PERIOD,
                         .closed = true,
                         .samples = 5,
                         .levels = LEVELS};
    figure->spaces[0] = bat_rotation();
    figure->spaces[1] = bat_sphere(2);
    bat_status status = BAT_OK;
    for (figure_scheme scheme = OURS; scheme <= TRANSPORT_DIRECTIONS && status == BAT_OK; scheme++)
        status = add_panel(figure, &eight, scheme, scheme == OURS, error);
    return status;
}

bat_status bat_hermite_figure_make(size_t index, bat_hermite_figure *figure, bat_error *error)
{
    static const struct
    {
        const char *name, *title;
        bat_status (*make)(bat_hermite_figure *figure, bat_error *error);
        size_t columns;
    } FIGURES[BAT_HERMITE_FIGURE_COUNT] = {
        {"tensors", "Figure 1: averages of two 3 x 3 tensors, along a geodesic and off it", make_tensors, 2},
        {"orders", "Figure 2: Hermite Lane-Riesenfeld of orders 1, 3 and 10 on the sphere", make_orders, 5},
        {"spiral", "Figure 3: a spherical spiral at three sampling rates", make_spiral, 3},
        {"rotations", "Figure 4: rotations acting on a triangle", make_rotations, 3},
    };
    if (index >= BAT_HERMITE_FIGURE_COUNT)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there is no figure %zu", index);
    bat_hermite_figure made = {
        .name = FIGURES[index].name, .title = FIGURES[index].title, .columns = FIGURES[index].columns};
    made.spaces = memory_array(2, sizeof *made.spaces);
    if (made.spaces == NULL)
        return error_memory(error, 2 * sizeof *made.spaces);
    bat_status status = FIGURES[index].make(&made, error);
    if (status == BAT_OK)
        *figure = made;
    else
        bat_hermite_figure_free(&made);
    return status;
}

void bat_hermite_figure_free(bat_hermite_figure *figure)
{
    for (size_t i = 0; i < figure->panel_count; i++)
        for (size_t k = 0; k < figure->panels[i].curve_count; k++)
            bat_curve_free(&figure->panels[i].curves[k]);
    free(figure->spaces);
    *figure = (bat_hermite_figure){0};
}

// The picture

enum
{
    TITLE_SIZE = 128
};

static bat_curve_picture_layer layer_of(const bat_hermite_panel *panel, size_t index)
{
    static const char *const LABELS[] = {"refined", "given", "smooth curve"};
    bat_curve_layer_role role = panel->roles[index];
    size_t first = 0;
    while (panel->roles[first] != role)
        first++;
    return (bat_curve_picture_layer){
        .curve = &panel->curves[index], .role = role, .label = index == first ? LABELS[role] : NULL, .colour = 1};
}

static void scheme_words(const bat_hermite_panel *panel, char *text, size_t size)
{
    if (panel->order > 0)
        (void)snprintf(text, size, "%s, order %zu", panel->scheme, panel->order);
    else
        (void)snprintf(text, size, "%s", panel->scheme);
}

bat_status bat_hermite_figure_draw(const char *path, const bat_hermite_figure *figure, bat_error *error)
{
    bat_curve_picture_layer layers[BAT_HERMITE_FIGURE_PANELS][BAT_HERMITE_FIGURE_CURVES];
    bat_curve_picture_panel panels[BAT_HERMITE_FIGURE_PANELS];
    char titles[BAT_HERMITE_FIGURE_PANELS][TITLE_SIZE];
    for (size_t p = 0; p < figure->panel_count; p++)
    {
        const bat_hermite_panel *panel = &figure->panels[p];
        char words[TITLE_SIZE / 2];
        for (size_t i = 0; i < panel->curve_count; i++)
            layers[p][i] = layer_of(panel, i);
        scheme_words(panel, words, sizeof words);
        (void)snprintf(titles[p], sizeof titles[p], "%s, %zu points: error %.2g", words, panel->samples, panel->error);
        panels[p] = (bat_curve_picture_panel){layers[p], panel->curve_count, titles[p]};
    }
    bat_curve_picture_options how = bat_curve_picture_defaults();
    how.title = figure->title;
    how.columns = figure->columns;
    how.control_polygon = false;
    return bat_curve_picture_write(path, panels, figure->panel_count, &how, error);
}
