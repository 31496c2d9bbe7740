#include "curve/curve_attributes.h"
#include "io/curve/builder.h"
#include "io/curve/formats.h"
#include "linalg/vector.h"

/// @file
/// Wavefront OBJ for curves: `v` and `l` statements.

typedef struct obj_vertex
{
    double x, y, z;
    size_t line;
} obj_vertex;

/// An `l` statement with the indices begin, …, end - 1 of obj_reader::indices.
typedef struct obj_element
{
    size_t begin, end;
    size_t line;
} obj_element;

typedef struct obj_reader
{
    obj_vertex *vertices;
    size_t vertex_count, vertex_capacity;
    size_t *indices; ///< counted from 0
    size_t index_count, index_capacity;
    obj_element *elements;
    size_t element_count, element_capacity;
    bool solid; ///< some vertex has a z other than 0
} obj_reader;

#define MAX_NUMBERS 7 ///< x y z w, or x y z and a colour

static bat_status read_vertex(obj_reader *reader, word_scan *scan, bat_error *error)
{
    double numbers[MAX_NUMBERS] = {0};
    size_t count = 0, line = scan->line;
    for (; !scan_line_done(scan); count++)
    {
        if (count == MAX_NUMBERS)
            return error_set(error, BAT_BAD_FILE, reader->vertex_count, line, "a vertex has at most 7 numbers");
        if (!scan_number(scan, &numbers[count]))
            return scan_number_fault(scan, reader->vertex_count, "a vertex needs 2 or 3 numbers", error);
    }
    if (count < 2)
        return error_set(error, BAT_BAD_FILE, reader->vertex_count, line, "a vertex needs 2 or 3 numbers");
    const obj_vertex vertex = {numbers[0], numbers[1], numbers[2], line};
    if (!ARRAY_ADD(reader->vertices, reader->vertex_capacity, reader->vertex_count, vertex))
        return error_memory(error, reader->vertex_count * sizeof *reader->vertices);
    reader->solid = reader->solid || numbers[2] != 0.0;
    return BAT_OK;
}

/// Read "i" or "i/t". The index i counts from 1 or, when negative, backwards from the last vertex.
static bool read_index(const obj_reader *reader, const char *at, const char *end, size_t *index)
{
    const char *slash = memchr(at, '/', (size_t)(end - at));
    if (slash != NULL)
        end = slash;
    bool negative = at < end && *at == '-';
    at += negative;
    if (at == end)
        return false;
    size_t value = 0;
    for (; at < end; at++)
    {
        if (*at < '0' || *at > '9' || value > (SIZE_MAX - 9) / 10)
            return false;
        value = 10 * value + (size_t)(*at - '0');
    }
    if (value == 0 || (negative && value > reader->vertex_count))
        return false;
    *index = negative ? reader->vertex_count - value : value - 1;
    return true;
}

static bat_status read_element(obj_reader *reader, word_scan *scan, bat_error *error)
{
    obj_element element = {reader->index_count, 0, scan->line};
    while (!scan_line_done(scan))
    {
        size_t index;
        const char *end = scan_word_end(scan);
        if (!read_index(reader, scan->at, end, &index))
            return scan_word_fault(scan, reader->element_count, "is not the index of a vertex", error);
        if (!ARRAY_ADD(reader->indices, reader->index_capacity, reader->index_count, index))
            return error_memory(error, reader->index_count * sizeof index);
        scan->at = end;
    }
    element.end = reader->index_count;
    if (element.end - element.begin < 2)
        return error_set(error, BAT_BAD_FILE, reader->element_count, element.line, "a line needs at least 2 vertices");
    return ARRAY_ADD(reader->elements, reader->element_capacity, reader->element_count, element)
               ? BAT_OK
               : error_memory(error, reader->element_count * sizeof element);
}

static bat_status read_statements(obj_reader *reader, const file_text *text, bat_error *error)
{
    word_scan scan = word_scan_start(text->data, text->size);
    bat_status status = BAT_OK;
    while (status == BAT_OK && scan_next_content(&scan))
    {
        if (scan_word(&scan, "v"))
            status = read_vertex(reader, &scan, error);
        else if (scan_word(&scan, "l"))
            status = read_element(reader, &scan, error);
        if (status == BAT_OK)
            (void)scan_next_line(&scan);
    }
    bool ended = text->size == 0 || text->data[text->size - 1] == '\n';
    if (status == BAT_OK && reader->element_count == 0)
        return ERROR_FILE(error, scan.line - ended, "there are no line elements");
    return status;
}

static bat_status choose_space(const obj_reader *reader, const bat_curve_read_options *options, bat_space *space,
                               bat_error *error)
{
    const char *name = options->space != NULL ? options->space : reader->solid ? "euclidean" : "plane";
    bool two = strcmp(name, "plane") == 0 || strcmp(name, "disk") == 0;
    if (two && reader->solid)
    {
        size_t i = 0;
        while (reader->vertices[i].z == 0.0)
            i++;
        return error_set(error, BAT_BAD_FILE, i, reader->vertices[i].line, "a point of the %s has no third coordinate",
                         name);
    }
    return bat_space_by_name(name, two ? 2 : 3, space, error);
}

static bat_status build_curve(const obj_reader *reader, const obj_element *element, int wanted_closed,
                              curve_builder *builder, bat_error *error)
{
    const size_t *indices = reader->indices;
    size_t end = element->end;
    bool returns = indices[element->begin] == indices[end - 1] && end - element->begin > 2;
    bool closed = wanted_closed < 0 ? returns : wanted_closed > 0;
    if (closed && returns)
        end--;
    for (size_t i = element->begin; i < end; i++)
    {
        size_t place = i - element->begin;
        if (indices[i] >= reader->vertex_count)
            return error_set(error, BAT_BAD_FILE, place, element->line, "there is no vertex %zu, the file has %zu",
                             indices[i] + 1, reader->vertex_count);
        const obj_vertex *vertex = &reader->vertices[indices[i]];
        double *point = builder_next(builder, 0, NULL);
        if (point == NULL || !builder_line(builder, vertex->line))
            return error_memory(error, builder->point_capacity * sizeof *point);
        const double coordinates[3] = {vertex->x, vertex->y, vertex->z};
        memcpy(point, coordinates, builder->space.point_dim * sizeof *point);
        const char *fault = builder_admit(builder);
        if (fault != NULL)
            return builder_refuse(builder, error_set(error, BAT_BAD_FILE, place, vertex->line, "the point is %s", fault),
                                  error);
        bool dropped;
        fault = builder_drop_repeat(builder, false, &dropped);
        if (fault == NULL && closed && i + 1 == end)
            fault = builder_drop_repeat(builder, true, &dropped);
        if (fault != NULL)
            return error_set(error, BAT_BAD_FILE, place, element->line, "curve %zu, point %zu: %s", builder->curve_count,
                             place, fault);
    }
    return builder_end_curve(builder, closed) ? BAT_OK : error_memory(error, (end - element->begin) * sizeof(double));
}

bat_status obj_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    obj_reader reader = {0};
    curve_builder builder = {0};
    bat_status status = read_statements(&reader, text, error);
    if (status == BAT_OK)
    {
        builder.check = true;
        builder.project = options->project;
        builder.strict = options->strict;
        status = choose_space(&reader, options, &builder.space, error);
        for (size_t i = 0; i < reader.element_count && status == BAT_OK; i++)
            status = build_curve(&reader, &reader.elements[i], options->closed, &builder, error);
    }
    free(reader.vertices);
    free(reader.indices);
    free(reader.elements);
    bat_curve_attributes *attributes = status == BAT_OK ? attributes_new(BAT_CURVE_FORMAT_OBJ) : NULL;
    if (status == BAT_OK && (attributes == NULL || !builder_note_repeats(&builder, attributes)))
        status = error_memory(error, sizeof *attributes);
    if (status == BAT_OK)
        return builder_finish(&builder, attributes, set, error);
    attributes_release(attributes);
    builder_free(&builder);
    return status;
}

static bat_status format_vertices(const void *context BAT_UNUSED, const row_span *span, text_buffer *text, bat_error *error)
{
    size_t dim = span->curve->space->point_dim;
    for (size_t i = span->begin; i < span->end; i++)
    {
        const double *point = span->curve->points + i * dim;
        if (!vector_is_finite(dim, point))
            return row_not_finite(span, i, error);
        text_append_numbers(text, "v ", (double[]){point[0], point[1], dim > 2 ? point[2] : 0}, 3);
    }
    return BAT_OK;
}

static bat_status format_elements(const void *context BAT_UNUSED, const row_span *span, text_buffer *text,
                                  bat_error *error BAT_UNUSED)
{
    if (span->begin == 0)
        text_append_string(text, "l");
    for (size_t i = span->begin; i < span->end; i++)
        text_append_fixed(text, " ", (int64_t)(span->first_row + i) + 1, 0);
    if (span->end == span->curve->count && span->curve->closed)
        text_append_fixed(text, " ", (int64_t)span->first_row + 1, 0);
    if (span->end == span->curve->count)
        text_append_string(text, "\n");
    return BAT_OK; // the sink reports a lack of memory
}

bat_status obj_write(const bat_curve_set *set, const bat_curve_write_options *options, text_sink *sink, bat_error *error)
{
    if (set->space->point_dim != 2 && set->space->point_dim != 3)
        return ERROR_UNSUPPORTED(error, 0, "OBJ cannot hold points of %zu coordinates", set->space->point_dim);
    for (size_t i = 0; i < set->count; i++)
        if (set->curves[i].count < 2)
            return error_set(error, BAT_UNSUPPORTED, i, 0, "OBJ cannot hold curve %zu, which has a single point", i);
    bat_status status = rows_write(set, sink, options->threads, format_vertices, NULL, error);
    return status == BAT_OK ? rows_write(set, sink, options->threads, format_elements, NULL, error) : status;
}
