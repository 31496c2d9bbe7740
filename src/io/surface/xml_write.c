#include "io/common/number_text.h"
#include "io/surface/formats.h"
#include "surface/spline/hierarchical_space.h"
#include "surface/spline/knot_vector.h"

#include "base/error.h"

#include <inttypes.h>
#include <stdio.h>

/// @file
/// Writer of G+Smo's XML format. Clamped uniform knots and boxes describe the space.

static void append_number(text_buffer *text, double value, char after)
{
    char *out = text_reserve(text, NUMBER_TEXT_SIZE + 1);
    if (out == NULL)
        return;
    out = number_write(out, value);
    *out++ = after;
    text_advance(text, out);
}

static void append_direction(text_buffer *text, const bat_hierarchical_options *options, int direction)
{
    char line[128];
    int degree = options->degree[direction];
    size_t spans = options->spans[direction];
    (void)snprintf(line, sizeof line, "<Basis type=\"BSplineBasis\" index=\"%d\">\n<KnotVector degree=\"%d\">", direction,
                   degree);
    text_append_string(text, line);
    for (int i = 0; i < degree; i++)
        text_append_string(text, "0 ");
    for (size_t i = 0; i <= spans; i++)
        append_number(text, (double)i / (double)spans, ' ');
    for (int i = 0; i < degree; i++)
        text_append_string(text, "1 ");
    text_append_string(text, "</KnotVector>\n</Basis>\n");
}

static bat_status append_boxes(text_buffer *text, const bat_hierarchical_space *space, bat_error *error)
{
    bat_spline_box *boxes = NULL;
    size_t count = 0;
    bat_status status = hierarchical_space_regions(space, &boxes, &count, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        char line[128];
        (void)snprintf(line, sizeof line,
                       "<box level=\"%" PRIu32 "\">%" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32 "</box>\n", boxes[i].level,
                       boxes[i].low[0], boxes[i].low[1], boxes[i].high[0], boxes[i].high[1]);
        text_append_string(text, line);
    }
    free(boxes);
    return status;
}

static bat_status append_basis(text_buffer *text, const bat_spline_surface *surface, bat_error *error)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(surface->space);
    bool hierarchical = bat_hierarchical_space_levels(surface->space) > 1;
    const char *name = !hierarchical ? "TensorBSpline" : options.truncated ? "THBSpline" : "HBSpline";
    char line[160];
    (void)snprintf(line, sizeof line, "<Geometry type=\"%s2\" id=\"0\">\n<Basis type=\"%sBasis2\">\n", name, name);
    text_append_string(text, line);
    if (hierarchical)
        text_append_string(text, "<Basis type=\"TensorBSplineBasis2\">\n");
    append_direction(text, &options, 0);
    append_direction(text, &options, 1);
    text_append_string(text, "</Basis>\n");
    if (!hierarchical)
        return BAT_OK;
    bat_status status = append_boxes(text, surface->space, error);
    text_append_string(text, "</Basis>\n");
    return status;
}

static void append_control(text_buffer *text, const bat_spline_surface *surface)
{
    char line[64];
    (void)snprintf(line, sizeof line, "<coefs geoDim=\"%zu\">", surface->dimension);
    text_append_string(text, line);
    size_t functions = bat_hierarchical_space_functions(surface->space);
    const double *number = surface->control;
    for (size_t i = 0; i < functions; i++)
        for (size_t c = 0; c < surface->dimension; c++)
            append_number(text, *number++, c + 1 < surface->dimension ? ' ' : '\n');
    text_append_string(text, "</coefs>\n</Geometry>\n");
}

/// Trimming curves are further geometries, planar B-splines in the parameters of the surface.
static void append_trim(text_buffer *text, const bat_spline_trim *trim)
{
    for (size_t l = 0; l < trim->loop_count; l++)
        for (size_t i = trim->loops[l]; i < trim->loops[l + 1]; i++)
        {
            const bat_spline_curve *piece = &trim->pieces[i];
            char line[160];
            (void)snprintf(line, sizeof line,
                           "<Geometry type=\"BSpline\" id=\"%zu\" label=\"loop %zu\">\n<Basis type=\"BSplineBasis\">\n"
                           "<KnotVector degree=\"%d\">",
                           i + 1, l, piece->knots.degree);
            text_append_string(text, line);
            for (size_t k = 0; k < piece->knots.count; k++)
                append_number(text, piece->knots.knots[k], ' ');
            text_append_string(text, "</KnotVector>\n</Basis>\n<coefs geoDim=\"2\">");
            for (size_t k = 0; k < 2 * knot_vector_functions(&piece->knots); k++)
                append_number(text, piece->control[k], k % 2 == 0 ? ' ' : '\n');
            text_append_string(text, "</coefs>\n</Geometry>\n");
        }
}

bat_status surface_xml_write(const bat_spline_surface *surface, const bat_surface_write_options *options, text_sink *sink,
                             bat_error *error)
{
    (void)options;
    text_buffer text = {0};
    text_append_string(&text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<xml>\n");
    bat_status status = append_basis(&text, surface, error);
    append_control(&text, surface);
    append_trim(&text, &surface->trim);
    text_append_string(&text, "</xml>\n");
    if (status == BAT_OK)
        status = sink_write(sink, &text, error);
    text_free(&text);
    return status;
}
