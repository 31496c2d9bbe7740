/// @file
/// Trimming curves and their polygons, and what a trimmed surface has of its own; see trimming.h.

#include "surface/spline/tensor_surface.h"
#include "surface/trim/trimming.h"

#include "base/bisect.h"
#include "base/error.h"
#include "linalg/vector.h"

#include <string.h>

static const size_t SPAN_POINTS = 8; ///< corners of the polygon for each span of a curve

static const double CLOSED = 1e-9;

void spline_curve_free(bat_spline_curve *curve)
{
    knot_vector_free(&curve->knots);
    free(curve->control);
    *curve = (bat_spline_curve){0};
}

void spline_trim_free(bat_spline_trim *trim)
{
    for (size_t i = 0; trim->loop_count > 0 && i < trim->loops[trim->loop_count]; i++)
        spline_curve_free(&trim->pieces[i]);
    free(trim->pieces);
    free(trim->loops);
    *trim = (bat_spline_trim){0};
}

void spline_curve_place(const bat_spline_curve *curve, double t, double *place)
{
    double basis[BAT_SPLINE_MAX_DEGREE + 1];
    size_t span = knot_vector_span(&curve->knots, t), degree = (size_t)curve->knots.degree;
    knot_vector_basis(&curve->knots, span, t, 0, basis);
    memset(place, 0, curve->dimension * sizeof *place);
    for (size_t k = 0; k <= degree; k++)
        for (size_t c = 0; c < curve->dimension; c++)
            place[c] += basis[k] * curve->control[(span - degree + k) * curve->dimension + c];
}

static bat_status check_piece(const bat_spline_curve *piece, size_t index, bat_error *error)
{
    bat_status status = knot_vector_check(&piece->knots, error);
    if (status != BAT_OK)
        return status;
    const bat_knot_vector *knots = &piece->knots;
    const double domain[2] = {knots->knots[knots->degree], knots->knots[knot_vector_functions(knots)]};
    bool good = piece->dimension == 2 && piece->control != NULL && knots->degree > 0 && knots->knots[0] == domain[0] &&
                knots->knots[knots->count - 1] == domain[1];
    for (size_t k = 0; good && k < 2 * knot_vector_functions(knots); k++)
        good = piece->control[k] >= 0 && piece->control[k] <= 1;
    return good ? BAT_OK
                : error_set(error, BAT_INVALID_ARGUMENT, index, 0,
                            "trimming curve %zu is not a clamped planar spline in the unit square", index);
}

/// Whether all control points of curves lie on one line, so that their loop has no area.
static bool lie_on_line(const bat_spline_curve *pieces, size_t count)
{
    const double *first = pieces[0].control, *far = first;
    double length = 0, height = 0;
    for (size_t i = 0; i < count; i++) // the farthest
        for (size_t k = 0; k < knot_vector_functions(&pieces[i].knots); k++)
        {
            const double *p = pieces[i].control + 2 * k;
            double apart = hypot(p[0] - first[0], p[1] - first[1]);
            far = apart > length ? p : far;
            length = fmax(length, apart);
        }
    for (size_t i = 0; i < count; i++) // heights over the line to it, times its length
        for (size_t k = 0; k < knot_vector_functions(&pieces[i].knots); k++)
            height = fmax(height, fabs(vector2_turn(first, far, pieces[i].control + 2 * k)));
    return height <= CLOSED * length * length;
}

bat_status spline_trim_check(const bat_spline_trim *trim, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t l = 0; l < trim->loop_count; l++)
    {
        size_t begin = trim->loops[l], end = trim->loops[l + 1];
        if (end <= begin)
            return error_set(error, BAT_INVALID_ARGUMENT, l, 0, "trimming loop %zu is empty", l);
        for (size_t i = begin; i < end && status == BAT_OK; i++)
            status = check_piece(&trim->pieces[i], i, error);
        for (size_t i = begin; i < end && status == BAT_OK; i++)
        {
            const bat_spline_curve *piece = &trim->pieces[i], *next = &trim->pieces[i + 1 < end ? i + 1 : begin];
            const double *last = piece->control + 2 * (knot_vector_functions(&piece->knots) - 1);
            if (!(hypot(last[0] - next->control[0], last[1] - next->control[1]) <= CLOSED))
                status =
                    error_set(error, BAT_INVALID_ARGUMENT, i, 0, "trimming loop %zu is not closed after curve %zu", l, i);
        }
        if (status != BAT_OK)
            return status;
        if (lie_on_line(trim->pieces + begin, end - begin))
            return error_set(error, BAT_INVALID_ARGUMENT, l, 0, "trimming loop %zu has no area", l);
    }
    return BAT_OK;
}

static size_t polygon_points(const bat_spline_curve *piece)
{
    size_t spans = knot_vector_functions(&piece->knots) - (size_t)piece->knots.degree;
    return spans * (piece->knots.degree == 1 ? 1 : SPAN_POINTS);
}

/// Append the corners of a piece without its end.
static void sample_piece(const bat_spline_curve *piece, trim_region *region)
{
    size_t degree = (size_t)piece->knots.degree, functions = knot_vector_functions(&piece->knots);
    size_t steps = degree == 1 ? 1 : SPAN_POINTS;
    for (size_t span = degree; span < functions; span++)
    {
        double from = piece->knots.knots[span], to = piece->knots.knots[span + 1];
        for (size_t k = 0; k < steps && to > from; k++)
            spline_curve_place(piece, from + (to - from) * (double)k / (double)steps, region->points[region->count++]);
    }
}

size_t trim_region_next(const trim_region *region, size_t corner)
{
    size_t loop = bisect_sizes(region->loops, 0, region->loop_count, corner);
    return corner + 1 < region->loops[loop + 1] ? corner + 1 : region->loops[loop];
}

static size_t row_of(double v)
{
    double row = floor(v * TRIM_ROWS);
    return row < 0 ? 0 : row > TRIM_ROWS - 1 ? TRIM_ROWS - 1 : (size_t)row;
}

static bat_status make_rows(trim_region *region, bat_error *error)
{
    size_t *fill = region->row_edges = memory_pool_zeros(&region->pool, TRIM_ROWS + 2, sizeof *fill);
    if (fill == NULL)
        return memory_pool_check(&region->pool, error);
    for (int pass = 0; pass < 2; pass++)
    {
        for (size_t e = 0; e < region->count; e++)
        {
            size_t a = row_of(region->points[e][1]), b = row_of(region->points[trim_region_next(region, e)][1]);
            for (size_t row = a < b ? a : b; row <= (a < b ? b : a); row++)
                if (pass == 0)
                    fill[row + 2]++;
                else
                    region->edges[fill[row + 1]++] = (uint32_t)e;
        }
        if (pass == 1)
            break;
        for (size_t row = 1; row < TRIM_ROWS + 2; row++)
            fill[row] += fill[row - 1];
        region->edges = memory_pool_array(&region->pool, fill[TRIM_ROWS + 1], sizeof *region->edges);
        if (region->edges == NULL)
            return memory_pool_check(&region->pool, error);
    }
    return BAT_OK;
}

bat_status trim_region_make(const bat_spline_trim *trim, trim_region *region, bat_error *error)
{
    *region = (trim_region){0};
    if (trim->loop_count == 0)
        return BAT_OK;
    size_t total = 0;
    for (size_t i = 0; i < trim->loops[trim->loop_count]; i++)
        total += polygon_points(&trim->pieces[i]);
    region->points = memory_pool_array(&region->pool, total, sizeof *region->points);
    region->loops = memory_pool_array(&region->pool, trim->loop_count + 1, sizeof *region->loops);
    bat_status status = memory_pool_check(&region->pool, error);
    region->loop_count = trim->loop_count;
    for (size_t l = 0; l < trim->loop_count && status == BAT_OK; l++)
    {
        region->loops[l] = region->count;
        for (size_t i = trim->loops[l]; i < trim->loops[l + 1]; i++)
            sample_piece(&trim->pieces[i], region);
    }
    if (status == BAT_OK)
    {
        region->loops[trim->loop_count] = region->count;
        status = make_rows(region, error);
    }
    if (status != BAT_OK)
        trim_region_free(region);
    return status;
}

void trim_region_free(trim_region *region)
{
    memory_pool_free(&region->pool);
    *region = (trim_region){0};
}

bool trim_region_contains(const trim_region *region, double u, double v)
{
    if (region->loop_count == 0)
        return true;
    bool inside = false;
    size_t row = row_of(v);
    for (size_t k = region->row_edges[row]; k < region->row_edges[row + 1]; k++)
    {
        const double *a = region->points[region->edges[k]], *b = region->points[trim_region_next(region, region->edges[k])];
        if ((a[1] > v) != (b[1] > v) && u < a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            inside = !inside;
    }
    return inside;
}

// Trimmed surfaces; see trimming.h.

/// Room around the points, in spacings: the curves lie up to about one spacing outside, their control points farther.
static const double MARGIN = 4;

void trimming_free(surface_trimming *trimming)
{
    planar_chart_free(&trimming->chart);
    outline_free(&trimming->loops);
}

bat_status trimming_make(const cloud_geometry *geometry, double fill, double close, surface_trimming *trimming,
                         bat_error *error)
{
    int exponent = geometry->frame.exponent - 1;
    *trimming = (surface_trimming){0};
    bat_status status = planar_chart_make(geometry, MARGIN, &trimming->chart, error);
    if (status == BAT_OK)
        status =
            outline_find(geometry, &trimming->chart, ldexp(fill, exponent), ldexp(close, exponent), &trimming->loops, error);
    return status;
}

void trimming_parameters(const cloud_geometry *geometry, const surface_trimming *trimming, double *parameters)
{
    for (size_t i = 0; i < geometry->order.cloud.count; i++)
        for (size_t d = 0; d < 2; d++)
            parameters[2 * (size_t)geometry->order.places[i] + d] =
                fmin(fmax(trimming->chart.places[i][d] / trimming->chart.sides[d], 0), 1);
}

bat_status trimming_curves(const cloud_geometry *geometry, const surface_trimming *trimming, const double *parameters,
                           double rms, bat_spline_trim *trim, bat_error *error)
{
    size_t count = geometry->order.cloud.count;
    double *ordered = memory_array(count, 2 * sizeof *ordered);
    *trim = (bat_spline_trim){0};
    if (ordered == NULL)
        return error_memory(error, count * 2 * sizeof *ordered);
    for (size_t i = 0; i < count; i++)
        memcpy(ordered + 2 * i, parameters + 2 * (size_t)geometry->order.places[i], 2 * sizeof *ordered);
    bat_status status = fair_loops_make(&trimming->loops, trimming->chart.sides, ordered, count, geometry->spacing,
                                        fmin(geometry->noise, rms), trim, error);
    free(ordered);
    return status;
}

size_t trimming_drop_filled(const surface_trimming *trimming, bat_spline_trim *trim)
{
    size_t count = trim->loop_count, kept = 0, pieces = 0, begin = 0;
    for (size_t l = 0; l < count; l++)
    {
        size_t end = trim->loops[l + 1];
        for (size_t i = begin; i < end; i++)
            if (trimming->loops.filled[l])
                spline_curve_free(&trim->pieces[i]);
            else
            {
                SWAP(trim->pieces[pieces], trim->pieces[i]); // with itself, or with one that is released
                pieces++;
            }
        begin = end;
        if (!trimming->loops.filled[l])
            trim->loops[++kept] = pieces;
    }
    trim->loop_count = kept;
    return count - kept;
}

void trimming_take_gaps(const cloud_geometry *geometry, surface_trimming *trimming, bat_surface_gap **gaps, size_t *count)
{
    int exponent = 1 - geometry->frame.exponent;
    *gaps = trimming->loops.gaps;
    *count = trimming->loops.gap_count;
    trimming->loops.gaps = NULL;
    trimming->loops.gap_count = 0;
    for (size_t k = 0; k < *count; k++)
    {
        bat_surface_gap *gap = &(*gaps)[k];
        for (int d = 0; d < 3; d++)
            gap->place[d] = geometry->frame.middle[d] + ldexp(gap->place[d], exponent);
        gap->diameter = ldexp(gap->diameter, exponent);
        gap->area = ldexp(gap->area, 2 * exponent);
    }
}
