#include "base/error.h"
#include "base/memory.h"
#include "io/surface/surface_formats.h"
#include "io/surface/surface_xml_parse.h"

#include <math.h>
#include <stdlib.h>

/// How far a knot may be from its place, as a share of the domain: G+Smo writes knots with six digits.
static const double knot_digits = 1e-6;
/// The same as a share of a span.
static const double span_share = 0.01;

/// Whether a range of knots has one value.
static bool all_equal(const double *knots, size_t count)
{
    for (size_t i = 1; i < count; i++)
        if (knots[i] != knots[0])
            return false;
    return true;
}

/// The number of spans of a clamped uniform knot vector; 0 where it is none.
static size_t uniform_spans(const xml_numbers *knots, size_t degree)
{
    size_t clamped = degree + 1;
    if (knots->count < 2 * clamped || !all_equal(knots->values, clamped) ||
        !all_equal(knots->values + knots->count - clamped, clamped))
        return 0;
    const double *breaks = knots->values + degree;
    size_t spans = knots->count - 2 * clamped + 1;
    double length = breaks[spans] - breaks[0], step = length / (double)spans;
    double tolerance = fmin(knot_digits * length, span_share * step);
    if (!(length > 0) || !isfinite(length))
        return 0;
    for (size_t i = 1; i < spans; i++)
        if (!(fabs(breaks[i] - (breaks[0] + (double)i * step)) <= tolerance))
            return 0;
    return spans;
}

static bat_status read_options(const xml_surface *from, bat_hierarchical_options *options, bat_error *error)
{
    *options = bat_hierarchical_defaults();
    options->truncated = from->truncated;
    for (int d = 0; d < 2; d++)
    {
        const xml_numbers *knots = &from->knots[d];
        if (from->degree[d] < 1)
            return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, knots->line, "splines of degree 0 are not read");
        options->degree[d] = from->degree[d];
        options->spans[d] = uniform_spans(knots, (size_t)from->degree[d]);
        if (options->spans[d] == 0 || options->spans[d] > UINT32_MAX)
            return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, knots->line,
                             "only uniform knots are read, with %d equal ones at either end", from->degree[d] + 1);
    }
    return BAT_OK;
}

bat_status surface_xml_read(const file_text *text, bat_spline_surface *surface, bat_error *error)
{
    xml_surface from;
    bat_hierarchical_options options;
    bat_hierarchical_space *space = NULL;
    bat_status status = xml_surface_parse(text, &from, error);
    if (status == BAT_OK)
        status = read_options(&from, &options, error);
    if (status == BAT_OK && (from.dimension == 0 || from.control.count % from.dimension != 0))
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, from.control.line,
                           "%zu numbers are not points of %zu coordinates", from.control.count, from.dimension);
    if (status == BAT_OK)
        status = surface_space_make(&options, from.boxes, from.box_count, from.control.line,
                                    from.control.count / from.dimension, &space, error);
    if (status == BAT_OK)
    {
        *surface = (bat_spline_surface){.space = space, .control = from.control.values, .dimension = from.dimension};
        from.control.values = NULL;
    }
    xml_surface_free(&from);
    return status;
}
