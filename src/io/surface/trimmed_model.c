#include "io/surface/step.h"
#include "surface/spline/hierarchical_space.h"

#include "base/error.h"
#include "io/common/number_text.h"
#include "linalg/vector.h"

/// @file
/// One tensor-product surface and curves in space. The image of a trimming curve is a cubic Hermite spline with enough knots
/// that its distance from the surface is below the tolerance of the images.

enum
{
    MAX_FUNCTIONS = 1 << 20,
    MAX_PARTS = 64, ///< of a span of a trimming curve
    DEGREE = 3
};

/// The tolerance is this power of ten times the surface's size.
static const int smallest_digit = -7;
/// Of images, in units of the tolerance.
static const double IMAGE_TOLERANCE = 10;

double model_tolerance(const tensor_surface *patches, size_t count)
{
    double low[3], high[3], diagonal = 0;
    box_clear(3, low, high);
    for (size_t p = 0; p < count; p++)
    {
        size_t points = knot_vector_functions(&patches[p].knots[0]) * knot_vector_functions(&patches[p].knots[1]);
        for (size_t i = 0; i < points; i++)
            box_include(3, patches[p].control + 3 * i, low, high);
    }
    for (int c = 0; c < 3; c++)
        diagonal = hypot(diagonal, high[c] - low[c]);
    return pow(10, smallest_digit + (diagonal > 0 && isfinite(diagonal) ? floor(log10(diagonal)) : 0));
}

char *model_real(char *out, double value, char letter)
{
    char digits[NUMBER_TEXT_SIZE];
    const char *end = number_write(digits, value);
    bool point = false;
    for (const char *c = digits; c < end; c++)
    {
        point = point || *c == '.';
        if (*c == 'e' && !point)
            *out++ = '.';
        point = point || *c == 'e';
        *out++ = *c == 'e' ? letter : *c;
    }
    if (!point)
        *out++ = '.';
    return out;
}

static bat_status make_surface(const bat_spline_surface *surface, tensor_surface *made, bat_error *error)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(surface->space);
    size_t levels = bat_hierarchical_space_levels(surface->space);
    double functions = 1;
    for (int d = 0; d < 2; d++)
        functions *= ldexp((double)options.spans[d], (int)levels - 1) + options.degree[d];
    if (functions > MAX_FUNCTIONS)
        return ERROR_TOO_LARGE(error, "as one tensor-product surface this one has %.0f control points, more than %d",
                               functions, (int)MAX_FUNCTIONS);
    bat_hierarchical_space *fine = NULL;
    *made = (tensor_surface){.dimension = surface->dimension};
    bat_status status = hierarchical_space_copy(surface->space, &fine, error);
    for (uint32_t level = 0; level + 1 < levels && status == BAT_OK; level++)
    {
        const bat_spline_box all = {
            level, {0, 0}, {(uint32_t)(options.spans[0] << level), (uint32_t)(options.spans[1] << level)}};
        status = bat_hierarchical_space_refine(fine, &all, 1, error);
    }
    for (int d = 0; d < 2 && status == BAT_OK; d++)
        status = knot_vector_uniform(options.degree[d], options.spans[d] << (levels - 1), &made->knots[d], error);
    if (status == BAT_OK)
        status = array_make(&made->control, (size_t)functions, surface->dimension * sizeof *made->control, error);
    if (status == BAT_OK)
        status =
            hierarchical_space_prolong(surface->space, fine, surface->control, surface->dimension, made->control, error);
    bat_hierarchical_space_free(fine);
    return status;
}

/// Place and derivative in space of a trimming curve.
static bat_status lift(const trimmed_model *model, const bat_spline_curve *piece, double t, double place[3], double slope[3],
                       bat_error *error)
{
    static const double STEP = 1e-4; ///< of central differences of a shape's feet, in slopes
    double basis[2 * (BAT_SPLINE_MAX_DEGREE + 1)], planar[2][2] = {{0}}, values[9];
    size_t span = knot_vector_span(&piece->knots, t), degree = (size_t)piece->knots.degree;
    knot_vector_basis(&piece->knots, span, t, 1, basis);
    for (size_t k = 0; k < 2 * (degree + 1); k++)
        for (size_t d = 0; d < 2; d++)
            planar[k / (degree + 1)][d] += basis[k] * piece->control[2 * (span - degree + k % (degree + 1)) + d];
    for (int d = 0; d < 2; d++)
        planar[0][d] = fmin(fmax(planar[0][d], 0), 1);
    bat_status status = bat_spline_surface_evaluate(model->source, planar[0], 1, 1, values, error);
    bool shaped = model->shape.shape.kind != BAT_SURFACE_PRIMITIVE_NONE && status == BAT_OK;
    double sides[2][3];
    for (size_t c = 0; c < 3 && status == BAT_OK; c++)
    {
        place[c] = values[c];
        slope[c] = planar[1][0] * values[3 + c] + planar[1][1] * values[6 + c];
        sides[0][c] = place[c] - STEP * slope[c];
        sides[1][c] = place[c] + STEP * slope[c];
    }
    if (shaped)
        shape_model_project(&model->shape, values, place);
    for (int k = 0; k < 2 && shaped; k++)
        shape_model_project(&model->shape, sides[k], sides[k]);
    for (int c = 0; c < 3 && shaped; c++)
        slope[c] = (sides[1][c] - sides[0][c]) / (2 * STEP);
    return status;
}

/// Whether the cubic of an interval stays near the surface.
static bool is_near(const double from[6], const double to[6], double width, const double middle[3], double tolerance)
{
    double apart = 0;
    for (int c = 0; c < 3; c++)
        apart = hypot(apart, (from[c] + to[c]) / 2 + width * (from[3 + c] - to[3 + c]) / 8 - middle[c]);
    return apart <= tolerance;
}

/// Places and derivatives at the ends of a part of a span. Derivatives at a knot belong to the span after it; those at the
/// end of the span are taken just before it.
static bat_status lift_ends(const trimmed_model *model, const bat_spline_curve *piece, size_t span, double part, double step,
                            double from[6], double to[6], bat_error *error)
{
    double begin = piece->knots.knots[span], last = begin + (piece->knots.knots[span + 1] - begin) * (1 - 0x1p-40);
    bat_status status = lift(model, piece, begin + part * step, from, from + 3, error);
    return status != BAT_OK ? status : lift(model, piece, fmin(begin + (part + 1) * step, last), to, to + 3, error);
}

/// The number of parts of a span, a power of two.
static bat_status count_parts(const trimmed_model *model, const bat_spline_curve *piece, size_t span, double tolerance,
                              size_t *parts, bat_error *error)
{
    double begin = piece->knots.knots[span], width = piece->knots.knots[span + 1] - begin;
    bat_status status = BAT_OK;
    bool near = false;
    for (*parts = 1; *parts < MAX_PARTS && status == BAT_OK; *parts *= 2)
    {
        near = true;
        for (size_t k = 0; k < *parts && near && status == BAT_OK; k++)
        {
            double from[6], to[6], middle[3], slope[3], step = width / (double)*parts;
            status = lift_ends(model, piece, span, (double)k, step, from, to, error);
            if (status == BAT_OK)
                status = lift(model, piece, begin + ((double)k + 0.5) * step, middle, slope, error);
            near = status == BAT_OK && is_near(from, to, step, middle, tolerance);
        }
        if (near)
            break;
    }
    return status;
}

/// Append the control points of a span, without the first one of the curve. At its end, the knot is triple.
static bat_status append_span(const trimmed_model *model, const bat_spline_curve *piece, size_t span, size_t parts,
                              bat_spline_curve *image, size_t *points, bat_error *error)
{
    double begin = piece->knots.knots[span], step = (piece->knots.knots[span + 1] - begin) / (double)parts;
    bat_status status = BAT_OK;
    for (size_t k = 0; k < parts && status == BAT_OK; k++)
    {
        double from[6], to[6];
        status = lift_ends(model, piece, span, (double)k, step, from, to, error);
        double *control = image->control + 3 * *points;
        for (size_t c = 0; c < 3 && status == BAT_OK; c++)
        {
            control[c] = from[c] + step / 3 * from[3 + c];
            control[3 + c] = to[c] - step / 3 * to[3 + c];
            control[6 + c] = to[c];
        }
        *points += 3;
        double knot = k + 1 == parts ? piece->knots.knots[span + 1] : begin + (double)(k + 1) * step;
        for (int m = 0; m < DEGREE; m++)
            image->knots.knots[image->knots.count++] = knot;
    }
    return status;
}

static bat_status make_image(const trimmed_model *model, const bat_spline_curve *piece, double tolerance,
                             bat_spline_curve *image, bat_error *error)
{
    size_t degree = (size_t)piece->knots.degree, functions = knot_vector_functions(&piece->knots), total = 0, points = 1;
    size_t *parts = calloc(functions, sizeof *parts);
    bat_status status = parts == NULL ? error_memory(error, functions * sizeof *parts) : BAT_OK;
    for (size_t span = degree; span < functions && status == BAT_OK; span++)
        if (piece->knots.knots[span + 1] > piece->knots.knots[span])
        {
            status = count_parts(model, piece, span, tolerance, &parts[span], error);
            total += parts[span];
        }
    *image = (bat_spline_curve){.dimension = 3};
    image->control = memory_array(3 * total + 1, 3 * sizeof *image->control);
    image->knots = (bat_knot_vector){.degree = DEGREE, .knots = memory_array(3 * total + 5, sizeof(double))};
    if (status == BAT_OK && (image->control == NULL || image->knots.knots == NULL))
        status = error_memory(error, 9 * total * sizeof(double));
    if (status == BAT_OK)
    {
        double slope[3];
        for (int m = 0; m <= DEGREE; m++)
            image->knots.knots[image->knots.count++] = piece->knots.knots[degree];
        status = lift(model, piece, piece->knots.knots[degree], image->control, slope, error);
    }
    for (size_t span = degree; span < functions && status == BAT_OK; span++)
        if (parts[span] > 0)
            status = append_span(model, piece, span, parts[span], image, &points, error);
    if (status == BAT_OK)
    {
        image->knots.knots[image->knots.count] = image->knots.knots[image->knots.count - 1];
        image->knots.count++;
    }
    free(parts);
    return status;
}

/// Let the images of a loop end where the next ones begin.
static void join_images(const trimmed_model *model)
{
    const bat_spline_trim *trim = model->trim;
    for (size_t l = 0; l < trim->loop_count; l++)
        for (size_t i = trim->loops[l]; i < trim->loops[l + 1]; i++)
        {
            const bat_spline_curve *next = &model->images[i + 1 < trim->loops[l + 1] ? i + 1 : trim->loops[l]];
            bat_spline_curve *image = &model->images[i];
            size_t last = knot_vector_functions(&image->knots) - 1;
            for (size_t c = 0; c < 3 && image->control != NULL && next->control != NULL; c++)
                image->control[3 * last + c] = next->control[c];
        }
}

bat_status trimmed_model_make(const bat_spline_surface *surface, const bat_surface_primitive *shape, trimmed_model *model,
                              bat_error *error)
{
    static const double MIDDLE[] = {0.5, 0.5};
    double middle[3];
    *model = (trimmed_model){.source = surface, .trim = &surface->trim};
    bat_status status = make_surface(surface, &model->surface, error);
    if (status == BAT_OK && shape != NULL)
        status = bat_spline_surface_evaluate(surface, MIDDLE, 1, 0, middle, error);
    if (status == BAT_OK && shape != NULL)
        shape_model_begin(shape, middle, &model->shape);
    if (status == BAT_OK)
    {
        model->tolerance = model_tolerance(&model->surface, 1);
        model->piece_count = surface->trim.loop_count > 0 ? surface->trim.loops[surface->trim.loop_count] : 0;
        model->images = calloc(model->piece_count + 1, sizeof *model->images);
        model->curves = calloc(model->piece_count + 1, sizeof *model->curves);
        if (model->images == NULL || model->curves == NULL)
            status = error_memory(error, model->piece_count * sizeof *model->images);
    }
    for (size_t i = 0; i < model->piece_count && status == BAT_OK; i++)
        status = make_image(model, &surface->trim.pieces[i], IMAGE_TOLERANCE * model->tolerance, &model->images[i], error);
    if (status == BAT_OK)
        join_images(model);
    else
        trimmed_model_free(model);
    return status;
}

void trimmed_model_free(trimmed_model *model)
{
    for (size_t i = 0; i < model->piece_count && model->images != NULL; i++)
        spline_curve_free(&model->images[i]);
    free(model->images);
    free(model->curves);
    tensor_surface_free(&model->surface);
    *model = (trimmed_model){0};
}
