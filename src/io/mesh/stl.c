#include "io/common/bytes.h"
#include "io/mesh/builder.h"
#include "linalg/vector.h"

#include <strings.h>

/// @file
/// STL in text and binary form: triangles without connectivity, in single precision when binary.

enum
{
    HEADER_SIZE = 80,
    COUNT_SIZE = 4,
    NORMAL_SIZE = 12,
    TRIANGLE_SIZE = 50 ///< a normal, three vertices, two bytes of attributes
};

/// Add a corner of the current triangle. Corners with equal coordinates become one vertex.
/// @param line 0 for none
static bat_status add_corner(mesh_builder *builder, const double point[3], bool repair, size_t line, bat_error *error)
{
    bool finite = vector_is_finite(3, point);
    size_t index = builder->mesh.face_count;
    if (!finite && !repair)
        return error_remedy(error,
                            error_set(error, BAT_BAD_FILE, index, line, "a corner of triangle %zu is not finite", index),
                            "repair", "drops the triangle");
    uint32_t vertex = finite ? mesh_builder_merge(builder, point) : (uint32_t)builder->mesh.vertex_count;
    double *other = finite ? NULL : mesh_builder_vertex(builder);
    if (other != NULL)
        memcpy(other, point, 3 * sizeof *other);
    bool room = (finite || other != NULL) && vertex != BAT_MESH_NONE && mesh_builder_corner(builder, vertex, BAT_MESH_NONE);
    return room ? BAT_OK : mesh_builder_no_memory(builder, error);
}

/// Whether the size agrees with the count of a binary file. Some binary files begin with "solid" like text files.
static bool is_binary(const file_text *text)
{
    return text->size >= HEADER_SIZE + COUNT_SIZE &&
           bytes_whole(text->data + HEADER_SIZE, COUNT_SIZE, false) * TRIANGLE_SIZE == text->size - HEADER_SIZE - COUNT_SIZE;
}

/// Skip the next word of the line if it is `word`, in upper or lower case.
static bool skip_word(word_scan *scan, const char *word)
{
    scan_skip_blanks(scan);
    size_t size = (size_t)(scan_word_end(scan) - scan->at);
    if (size != strlen(word) || strncasecmp(scan->at, word, size) != 0)
        return false;
    scan->at += size;
    return true;
}

static bool begins_as_text(const file_text *text)
{
    word_scan scan = word_scan_start(text->data, text->size);
    return scan_next_content(&scan) && skip_word(&scan, "solid");
}

bool mesh_stl_resembles(const file_text *text)
{
    return is_binary(text) || begins_as_text(text);
}

static bat_status read_binary_triangle(mesh_builder *builder, const char *bytes, bool repair, bat_error *error)
{
    for (size_t c = 0; c < 3; c++)
    {
        double point[3];
        for (size_t k = 0; k < 3; k++)
            point[k] = bytes_real(bytes + NORMAL_SIZE + 4 * (3 * c + k), 4, false);
        bat_status status = add_corner(builder, point, repair, 0, error);
        if (status != BAT_OK)
            return status;
    }
    return mesh_builder_end_face(builder, 3) ? BAT_OK : mesh_builder_no_memory(builder, error);
}

static bat_status read_binary(mesh_builder *builder, const file_text *text, bool repair, bat_error *error)
{
    if (text->size < HEADER_SIZE + COUNT_SIZE)
        return ERROR_FILE(error, 0,
                          "the file neither begins with 'solid' nor holds the 84 bytes that binary STL begins with");
    size_t count = (size_t)bytes_whole(text->data + HEADER_SIZE, COUNT_SIZE, false),
           data = text->size - HEADER_SIZE - COUNT_SIZE;
    if (!is_binary(text))
        return ERROR_FILE(error, 0, "the header gives %zu triangles, but the file holds %zu bytes, enough for %zu%s", count,
                          data, data / TRIANGLE_SIZE, data % TRIANGLE_SIZE > 0 ? " and a part" : "");
    // A closed mesh has about half as many vertices as faces.
    if (!mesh_builder_reserve(builder, count / 2, count) || !point_table_reserve(&builder->points, count / 2))
        return mesh_builder_no_memory(builder, error);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        status = read_binary_triangle(builder, text->data + HEADER_SIZE + COUNT_SIZE + i * TRIANGLE_SIZE, repair, error);
    return status;
}

/// Advance to the next line with content, which must begin with these words.
static bat_status expect(word_scan *scan, size_t index, const char *first, const char *second, bat_error *error)
{
    if (!scan_next_content(scan))
        return error_set(error, BAT_BAD_FILE, index, scan->line, "the file ends where '%s' is expected", first);
    if (skip_word(scan, first) && (second == NULL || skip_word(scan, second)))
        return BAT_OK;
    char excerpt[EXCERPT_SIZE];
    scan_skip_blanks(scan);
    return error_set(error, BAT_BAD_FILE, index, scan->line, "'%s' was found where '%s%s%s' is expected",
                     text_excerpt(excerpt, scan->at, scan_word_end(scan)), first, second != NULL ? " " : "",
                     second != NULL ? second : "");
}

static bat_status read_text_vertex(mesh_builder *builder, word_scan *scan, bool repair, bat_error *error)
{
    static const char three[] = "a vertex has 3 coordinates";
    size_t index = builder->mesh.face_count;
    bat_status status = expect(scan, index, "vertex", NULL, error);
    if (status != BAT_OK)
        return status;
    double point[3];
    for (int k = 0; k < 3; k++)
        if (!scan_number(scan, &point[k]) && !scan_not_finite(scan, &point[k]))
            return scan_number_fault(scan, index, three, error);
    if (!scan_line_done(scan))
        return error_set(error, BAT_BAD_FILE, index, scan->line, "%s", three);
    return add_corner(builder, point, repair, scan->line, error);
}

/// Read a facet after its first word. Its normal follows from its corners and is skipped.
static bat_status read_text_facet(mesh_builder *builder, word_scan *scan, bool repair, bat_error *error)
{
    size_t index = builder->mesh.face_count;
    (void)scan_next_line(scan);
    bat_status status = expect(scan, index, "outer", "loop", error);
    for (int c = 0; c < 3 && status == BAT_OK; c++)
        status = read_text_vertex(builder, scan, repair, error);
    if (status == BAT_OK)
        status = expect(scan, index, "endloop", NULL, error);
    if (status == BAT_OK)
        status = expect(scan, index, "endfacet", NULL, error);
    return status == BAT_OK && !mesh_builder_end_face(builder, 3) ? mesh_builder_no_memory(builder, error) : status;
}

/// Read one or more solids. Their names are skipped.
static bat_status read_text(mesh_builder *builder, const file_text *text, bool repair, bat_error *error)
{
    word_scan scan = word_scan_start(text->data, text->size);
    bat_status status = BAT_OK;
    while (status == BAT_OK && scan_next_content(&scan))
    {
        status = expect(&scan, BAT_NO_INDEX, "solid", NULL, error);
        (void)scan_next_line(&scan);
        while (status == BAT_OK && scan_next_content(&scan) && skip_word(&scan, "facet"))
            status = read_text_facet(builder, &scan, repair, error);
        if (status == BAT_OK)
            status = expect(&scan, BAT_NO_INDEX, "endsolid", NULL, error);
        (void)scan_next_line(&scan);
    }
    return status;
}

bat_status mesh_stl_read(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    mesh_builder builder = {0};
    bool binary = is_binary(text) || !begins_as_text(text);
    bat_status status = (binary ? read_binary : read_text)(&builder, text, options->repair, error);
    if (status != BAT_OK)
    {
        mesh_builder_free(&builder);
        return status;
    }
    status = mesh_builder_finish(&builder, options, mesh, error);
    if (status != BAT_OK && !binary && error != NULL && error->index != BAT_NO_INDEX)
        error->line = scan_line_of(text, skip_word, "facet", error->index);
    return status;
}

/// The unit normal of a face, or zero. Edges are scaled first to avoid overflow.
static void face_normal(const bat_mesh *mesh, size_t face, double normal[3])
{
    const uint32_t *corner = mesh->faces + 3 * face;
    const double *p = mesh->positions + 3 * (size_t)corner[0];
    double edges[6], largest = 0.0;
    for (size_t i = 0; i < 6; i++)
    {
        edges[i] = mesh->positions[3 * (size_t)corner[1 + i / 3] + i % 3] / 2 - p[i % 3] / 2;
        largest = fmax(largest, fabs(edges[i]));
    }
    for (size_t i = 0; i < 6 && largest > 0; i++)
        edges[i] /= largest;
    vector3_cross(edges, edges + 3, normal);
    bool flat = !vector3_normalize(normal);
    for (int k = 0; k < 3; k++)
        normal[k] = flat ? 0.0 : normal[k] + 0.0; // no negative zeros
}

static char *put_floats(char *out, const double values[3])
{
    for (int k = 0; k < 3; k++)
        out = bytes_put_float(out, values[k]);
    return out;
}

static void format_binary(const void *context, size_t f, text_buffer *text)
{
    const bat_mesh *mesh = context;
    char *out = text_reserve(text, TRIANGLE_SIZE);
    double normal[3];
    if (out == NULL)
        return;
    face_normal(mesh, f, normal);
    out = put_floats(out, normal);
    for (size_t h = 3 * f; h < 3 * f + 3; h++)
        out = put_floats(out, mesh->positions + 3 * (size_t)mesh->faces[h]);
    *out++ = 0;
    *out++ = 0;
    text_advance(text, out);
}

static void format_text(const void *context, size_t f, text_buffer *text)
{
    const bat_mesh *mesh = context;
    double normal[3];
    face_normal(mesh, f, normal);
    text_append_numbers(text, "facet normal ", normal, 3);
    text_append_string(text, "outer loop\n");
    for (size_t h = 3 * f; h < 3 * f + 3; h++)
        text_append_numbers(text, "vertex ", mesh->positions + 3 * (size_t)mesh->faces[h], 3);
    text_append_string(text, "endloop\nendfacet\n");
}

/// Check that single precision can represent every coordinate.
static bat_status check_range(const bat_mesh *mesh, bat_error *error)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        if (!isfinite((float)mesh->positions[i]))
            return error_set(error, BAT_UNSUPPORTED, i / 3, 0, "binary STL cannot hold the coordinate %g of vertex %zu",
                             mesh->positions[i], i / 3);
    return BAT_OK;
}

static bat_status write_binary(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink,
                               bat_error *error)
{
    char header[HEADER_SIZE + 4] = "binary STL";
    (void)bytes_put(header + HEADER_SIZE, mesh->face_count, COUNT_SIZE, false);
    text_buffer text = {0};
    text_append(&text, header, sizeof header);
    bat_status status = sink_take(sink, &text, check_range(mesh, error), error);
    return status == BAT_OK ? text_lines_write(sink, mesh->face_count, options->threads, format_binary, mesh, error)
                            : status;
}

bat_status mesh_stl_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    if (options->encoding != BAT_MESH_ENCODING_TEXT)
        return write_binary(mesh, options, sink, error);
    bat_status status = sink_format(sink, error, "solid mesh\n");
    if (status == BAT_OK)
        status = text_lines_write(sink, mesh->face_count, options->threads, format_text, mesh, error);
    return status == BAT_OK ? sink_format(sink, error, "endsolid mesh\n") : status;
}
