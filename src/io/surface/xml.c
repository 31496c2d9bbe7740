/// @file
/// G+Smo's XML format, for B-spline, HB-spline and THB-spline surfaces.

#include "io/common/xml_parse.h"
#include "io/surface/formats.h"
#include "surface/spline/hierarchical_space.h"
#include "surface/spline/tensor_surface.h"

#include <inttypes.h>
#include <math.h>

typedef struct xml_numbers
{
    double *values;
    size_t count;
    size_t line; ///< the line of the first; 0 when the element is missing
} xml_numbers;

/// The content of a geometry with two parameters.
typedef struct xml_surface
{
    bool hierarchical, truncated;
    size_t line; ///< the line where it begins
    int degree[2];
    xml_numbers knots[2];
    size_t directions; ///< the number of knot vectors read
    surface_box *boxes;
    size_t box_count, box_capacity;
    size_t dimension;
    xml_numbers control;
} xml_surface;

/// Elements of a surface. Other elements are skipped with their content.
typedef enum xml_element
{
    XML_OUTSIDE,
    XML_ROOT,       ///< <xml>
    XML_OTHER,      ///< any other element
    XML_GEOMETRY,   ///< <Geometry>
    XML_HIERARCHY,  ///< <Basis> of a hierarchical basis
    XML_TENSOR,     ///< <Basis> of a tensor-product basis
    XML_UNIVARIATE, ///< <Basis> of one direction
    XML_KNOTS,      ///< <KnotVector>
    XML_BOX,        ///< <box>
    XML_CONTROL     ///< <coefs>
} xml_element;

#define MAX_DEPTH 64

typedef struct xml_state
{
    xml_parse xml;
    xml_surface *surface;
    xml_element open[MAX_DEPTH + 1];
    size_t depth;
    text_buffer content; ///< the text of the open element, if it holds numbers
    size_t content_line;
    size_t other_line; ///< the line of a geometry of an unsupported type
    char other_type[EXCERPT_SIZE];
} xml_state;

/// Fail at the parser's line.
#define FAIL(state, status, ...) XML_FAIL(&(state)->xml, status, __VA_ARGS__)

/// Read an attribute as an integer, at most `max_value`.
static bool whole_attribute(xml_state *state, const XML_Char **attributes, const char *name, size_t max_value, size_t *value)
{
    const char *text = xml_attribute(attributes, name);
    uint64_t number = 0;
    size_t digits = 0;
    for (; text != NULL && text[digits] >= '0' && text[digits] <= '9' && number <= max_value; digits++)
        number = 10 * number + (uint64_t)(text[digits] - '0');
    if (digits == 0 || text[digits] != '\0' || number > max_value)
        return FAIL(state, BAT_BAD_FILE, "the attribute '%s' is missing or not a whole number up to %zu", name, max_value);
    *value = (size_t)number;
    return true;
}

static bool type_is(const XML_Char **attributes, const char *type)
{
    const char *value = xml_attribute(attributes, "type");
    return value != NULL && strcmp(value, type) == 0;
}

/// Skip a geometry of an unsupported type and remember the first one.
static xml_element pass_over(xml_state *state, const XML_Char **attributes)
{
    if (state->other_line == 0)
    {
        const char *type = xml_attribute(attributes, "type");
        type = type != NULL ? type : "";
        (void)text_excerpt(state->other_type, type, type + strlen(type));
        state->other_line = xml_line(&state->xml);
    }
    return XML_OTHER;
}

static xml_element begin_geometry(xml_state *state, const XML_Char **attributes)
{
    xml_surface *surface = state->surface;
    bool truncated = type_is(attributes, "THBSpline2"), plain = type_is(attributes, "HBSpline2");
    if (!truncated && !plain && !type_is(attributes, "TensorBSpline2"))
        return pass_over(state, attributes);
    if (surface->line > 0)
        FAIL(state, BAT_UNSUPPORTED, "the file has a second surface; only one is supported");
    surface->hierarchical = truncated || plain;
    surface->truncated = !plain;
    surface->line = xml_line(&state->xml);
    return XML_GEOMETRY;
}

static xml_element begin_box(xml_state *state, const XML_Char **attributes)
{
    xml_surface *surface = state->surface;
    size_t level;
    if (!whole_attribute(state, attributes, "level", UINT32_MAX, &level))
        return XML_OTHER;
    if (!ARRAY_GROW(surface->boxes, surface->box_capacity, surface->box_count + 1))
    {
        xml_stop(&state->xml, error_memory(state->xml.error, surface->box_count * sizeof *surface->boxes));
        return XML_OTHER;
    }
    surface->boxes[surface->box_count] = (surface_box){.level = level, .line = xml_line(&state->xml)};
    return XML_BOX;
}

/// Refuse numbers in other encodings or orders.
static bool is_plain(xml_state *state, const XML_Char **attributes)
{
    const char *format = xml_attribute(attributes, "format"), *order = xml_attribute(attributes, "order");
    if ((format == NULL || strcmp(format, "ASCII") == 0 || strcmp(format, "ascii") == 0) && order == NULL)
        return true;
    return FAIL(state, BAT_UNSUPPORTED, "only numbers in ASCII, one point after the other, are supported");
}

static xml_element begin_knots(xml_state *state, const XML_Char **attributes)
{
    xml_surface *surface = state->surface;
    size_t degree;
    if (surface->directions == 2)
        FAIL(state, BAT_BAD_FILE, "the surface has a third knot vector; two are expected");
    else if (whole_attribute(state, attributes, "degree", BAT_SPLINE_MAX_DEGREE, &degree) && is_plain(state, attributes))
    {
        surface->degree[surface->directions] = (int)degree;
        return XML_KNOTS;
    }
    return XML_OTHER;
}

/// Classify an element by its name, its type and its parent.
static xml_element begin_element(xml_state *state, const char *name, const XML_Char **attributes)
{
    const xml_surface *surface = state->surface;
    bool basis = strcmp(name, "Basis") == 0;
    switch (state->open[state->depth])
    {
    case XML_OUTSIDE:
        if (strcmp(name, "xml") == 0)
            return XML_ROOT;
        break;
    case XML_ROOT:
        return strcmp(name, "Geometry") == 0 ? begin_geometry(state, attributes) : XML_OTHER;
    case XML_GEOMETRY:
        if (strcmp(name, "coefs") == 0)
        {
            if (surface->control.line > 0)
                FAIL(state, BAT_BAD_FILE, "the surface has coefficients already");
            else if (whole_attribute(state, attributes, "geoDim", UINT32_MAX, &state->surface->dimension) &&
                     is_plain(state, attributes))
                return XML_CONTROL;
            return XML_OTHER;
        }
        if (basis && surface->hierarchical && type_is(attributes, surface->truncated ? "THBSplineBasis2" : "HBSplineBasis2"))
        {
            const char *manual = xml_attribute(attributes, "manualLevels");
            if (manual == NULL || strcmp(manual, "true") != 0)
                return XML_HIERARCHY;
            FAIL(state, BAT_UNSUPPORTED, "levels with their own knots are not supported, only levels with halved spans");
            return XML_OTHER;
        }
        if (basis && !surface->hierarchical && type_is(attributes, "TensorBSplineBasis2"))
            return XML_TENSOR;
        break;
    case XML_HIERARCHY:
        if (basis && type_is(attributes, "TensorBSplineBasis2"))
            return XML_TENSOR;
        if (strcmp(name, "box") == 0)
            return begin_box(state, attributes);
        break;
    case XML_TENSOR:
        if (basis && type_is(attributes, "BSplineBasis"))
            return XML_UNIVARIATE;
        break;
    case XML_UNIVARIATE:
        if (strcmp(name, "KnotVector") == 0)
            return begin_knots(state, attributes);
        break;
    case XML_OTHER:
        return XML_OTHER;
    case XML_KNOTS:
    case XML_BOX:
    case XML_CONTROL:
        break;
    }
    char excerpt[EXCERPT_SIZE];
    FAIL(state, BAT_UNSUPPORTED, "an element <%s> of this type is unknown here",
         text_excerpt(excerpt, name, name + strlen(name)));
    return XML_OTHER;
}

static void XMLCALL on_begin(void *context, const XML_Char *name, const XML_Char **attributes)
{
    xml_state *state = context;
    if (state->xml.status != BAT_OK)
        return;
    if (state->depth == MAX_DEPTH)
    {
        FAIL(state, BAT_BAD_FILE, "elements are nested more than %d deep", MAX_DEPTH);
        return;
    }
    xml_element element = begin_element(state, name, attributes);
    state->open[++state->depth] = element;
    state->content.size = 0;
    state->content_line = xml_line(&state->xml);
    if (state->xml.status == BAT_OK && text_reserve(&state->content, 0) == NULL)
        xml_stop(&state->xml, error_memory(state->xml.error, state->content.size));
}

static void XMLCALL on_text(void *context, const XML_Char *text, int size)
{
    xml_state *state = context;
    xml_element element = state->open[state->depth];
    if (state->xml.status != BAT_OK || (element != XML_KNOTS && element != XML_BOX && element != XML_CONTROL))
        return;
    if (state->content.size == 0)
        state->content_line = xml_line(&state->xml);
    text_append(&state->content, text, (size_t)size);
    if (state->content.failed)
        xml_stop(&state->xml, error_memory(state->xml.error, state->content.size));
}

static bat_status bad_number(const xml_state *state, const char *begin, const char *at, const char *end)
{
    size_t line = state->content_line;
    for (const char *c = begin; c < at; c++)
        line += *c == '\n';
    const char *word_end = at;
    while (word_end < end && !text_is_blank(*word_end))
        word_end++;
    char excerpt[EXCERPT_SIZE];
    return ERROR_FILE(state->xml.error, line, "'%s' is not a number", text_excerpt(excerpt, at, word_end));
}

static bat_status read_numbers(const xml_state *state, xml_numbers *numbers)
{
    const char *at = state->content.data, *begin = at, *end = at + state->content.size;
    void *values = NULL;
    size_t count = 0, capacity = 0;
    bat_status status = BAT_OK;
    while (status == BAT_OK)
    {
        while (at < end && text_is_blank(*at))
            at++;
        if (at == end)
            break;
        double value;
        const char *after = number_scan(at, end, &value);
        if (after == NULL || (after < end && !text_is_blank(*after)))
            status = bad_number(state, begin, at, end);
        else if (!array_grow(&values, &capacity, count + 1, sizeof value))
            status = error_memory(state->xml.error, (count + 1) * sizeof value);
        else
        {
            ((double *)values)[count++] = value;
            at = after;
        }
    }
    *numbers = (xml_numbers){values, count, state->content_line};
    return status;
}

static bat_status read_box(const xml_state *state, surface_box *box)
{
    xml_numbers numbers;
    bat_status status = read_numbers(state, &numbers);
    bool whole = numbers.count == 4;
    for (size_t i = 0; i < 4 && whole; i++)
        whole = numbers.values[i] >= 0 && numbers.values[i] <= UINT32_MAX &&
                numbers.values[i] == (double)(uint32_t)numbers.values[i];
    if (status == BAT_OK && !whole)
        status =
            ERROR_FILE(state->xml.error, box->line, "a box has four whole numbers: its start and its end in each direction");
    for (size_t d = 0; d < 2 && status == BAT_OK; d++)
    {
        box->low[d] = (uint64_t)numbers.values[d];
        box->high[d] = (uint64_t)numbers.values[2 + d];
    }
    free(numbers.values);
    return status;
}

static void XMLCALL on_end(void *context, const XML_Char *name)
{
    (void)name; // the parser checks that it matches
    xml_state *state = context;
    if (state->xml.status != BAT_OK)
        return;
    xml_surface *surface = state->surface;
    bat_status status = BAT_OK;
    switch (state->open[state->depth])
    {
    case XML_KNOTS:
        status = read_numbers(state, &surface->knots[surface->directions++]);
        break;
    case XML_BOX:
        status = read_box(state, &surface->boxes[surface->box_count++]);
        break;
    case XML_CONTROL:
        status = read_numbers(state, &surface->control);
        break;
    default:
        break;
    }
    state->depth--;
    if (status != BAT_OK)
        xml_stop(&state->xml, status);
}

static bat_status check_whole(const xml_state *state)
{
    const xml_surface *surface = state->surface;
    if (surface->line == 0 && state->other_line > 0)
        return ERROR_UNSUPPORTED(state->xml.error, state->other_line,
                                 "a geometry of type '%s' is not supported; THBSpline2, HBSpline2 and TensorBSpline2 are",
                                 state->other_type);
    if (surface->line == 0)
        return ERROR_FILE(state->xml.error, 0, "there is no element <Geometry>");
    if (surface->directions < 2)
        return ERROR_FILE(state->xml.error, surface->line, "the surface lacks a <KnotVector>");
    if (surface->control.line == 0)
        return ERROR_FILE(state->xml.error, surface->line, "the surface lacks <coefs>");
    return BAT_OK;
}

/// Read a surface. Release `surface` also on failure.
/// @return BAT_OK with all elements; BAT_BAD_FILE or BAT_UNSUPPORTED with the line; BAT_NO_MEMORY
static bat_status xml_surface_parse(const file_text *text, xml_surface *surface, bat_error *error)
{
    *surface = (xml_surface){0};
    xml_state state = {.xml = {.prefix = "",
                               .doctype = "document types are not supported",
                               .doctype_fault = BAT_UNSUPPORTED,
                               .error = error},
                       .surface = surface};
    bat_status status = xml_begin(&state.xml, NULL, on_begin, on_end);
    if (status != BAT_OK)
        return status;
    XML_SetCharacterDataHandler(state.xml.parser, on_text);
    status = xml_text(&state.xml, text);
    if (status == BAT_OK)
        status = check_whole(&state);
    text_free(&state.content);
    return status;
}

/// Tolerance of knots, relative to the domain: G+Smo writes six digits.
static const double knot_digits = 1e-6;
/// Tolerance of knots, relative to a span.
static const double span_share = 0.01;

static bool all_equal(const double *knots, size_t count)
{
    for (size_t i = 1; i < count; i++)
        if (knots[i] != knots[0])
            return false;
    return true;
}

/// The number of spans of a clamped uniform knot vector; 0 for any other knot vector.
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
            return ERROR_UNSUPPORTED(error, knots->line, "splines of degree 0 are not supported");
        options->degree[d] = from->degree[d];
        options->spans[d] = uniform_spans(knots, (size_t)from->degree[d]);
        if (options->spans[d] == 0 || options->spans[d] > UINT32_MAX)
            return ERROR_UNSUPPORTED(error, knots->line, "only uniform knots with %d equal knots at both ends are supported",
                                     from->degree[d] + 1);
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
        status = ERROR_FILE(error, from.control.line, "%zu numbers are not points of %zu coordinates", from.control.count,
                            from.dimension);
    if (status == BAT_OK)
        status = surface_space_make(&options, from.boxes, from.box_count, from.control.line,
                                    from.control.count / from.dimension, &space, error);
    if (status == BAT_OK)
    {
        *surface = (bat_spline_surface){.space = space, .control = from.control.values, .dimension = from.dimension};
        from.control.values = NULL;
    }
    free(from.knots[0].values);
    free(from.knots[1].values);
    free(from.boxes);
    free(from.control.values);
    return status;
}

// The writer: clamped uniform knots and boxes describe the space.

static void append_direction(text_buffer *text, const bat_hierarchical_options *options, int direction)
{
    int degree = options->degree[direction];
    size_t spans = options->spans[direction];
    text_append_format(text, "<Basis type=\"BSplineBasis\" index=\"%d\">\n<KnotVector degree=\"%d\">", direction, degree);
    for (int i = 0; i < degree; i++)
        text_append_string(text, "0 ");
    for (size_t i = 0; i <= spans; i++)
        text_append_number(text, (double)i / (double)spans, ' ');
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
        text_append_format(text, "<box level=\"%" PRIu32 "\">%" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32 "</box>\n",
                           boxes[i].level, boxes[i].low[0], boxes[i].low[1], boxes[i].high[0], boxes[i].high[1]);
    free(boxes);
    return status;
}

static bat_status append_basis(text_buffer *text, const bat_spline_surface *surface, bat_error *error)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(surface->space);
    bool hierarchical = bat_hierarchical_space_levels(surface->space) > 1;
    const char *name = !hierarchical ? "TensorBSpline" : options.truncated ? "THBSpline" : "HBSpline";
    text_append_format(text, "<Geometry type=\"%s2\" id=\"0\">\n<Basis type=\"%sBasis2\">\n", name, name);
    text_append_string(text, hierarchical ? "<Basis type=\"TensorBSplineBasis2\">\n" : "");
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
    text_append_format(text, "<coefs geoDim=\"%zu\">", surface->dimension);
    size_t functions = bat_hierarchical_space_functions(surface->space);
    const double *number = surface->control;
    for (size_t i = 0; i < functions; i++)
        for (size_t c = 0; c < surface->dimension; c++)
            text_append_number(text, *number++, c + 1 < surface->dimension ? ' ' : '\n');
    text_append_string(text, "</coefs>\n</Geometry>\n");
}

/// Trimming curves are further geometries, planar B-splines in the parameters of the surface.
static void append_trim(text_buffer *text, const bat_spline_trim *trim)
{
    for (size_t l = 0; l < trim->loop_count; l++)
        for (size_t i = trim->loops[l]; i < trim->loops[l + 1]; i++)
        {
            const bat_spline_curve *piece = &trim->pieces[i];
            text_append_format(text,
                               "<Geometry type=\"BSpline\" id=\"%zu\" label=\"loop %zu\">\n<Basis type=\"BSplineBasis\">\n"
                               "<KnotVector degree=\"%d\">",
                               i + 1, l, piece->knots.degree);
            for (size_t k = 0; k < piece->knots.count; k++)
                text_append_number(text, piece->knots.knots[k], ' ');
            text_append_string(text, "</KnotVector>\n</Basis>\n<coefs geoDim=\"2\">");
            for (size_t k = 0; k < 2 * knot_vector_functions(&piece->knots); k++)
                text_append_number(text, piece->control[k], k % 2 == 0 ? ' ' : '\n');
            text_append_string(text, "</coefs>\n</Geometry>\n");
        }
}

bat_status surface_xml_write(const bat_spline_surface *surface, const bat_surface_write_options *options BAT_UNUSED,
                             text_sink *sink, bat_error *error)
{
    text_buffer text = {0};
    text_append_string(&text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<xml>\n");
    bat_status status = append_basis(&text, surface, error);
    append_control(&text, surface);
    append_trim(&text, &surface->trim);
    text_append_string(&text, "</xml>\n");
    return sink_take(sink, &text, status, error);
}
