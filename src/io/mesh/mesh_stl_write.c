#include "base/error.h"
#include "io/common/number_text.h"
#include "io/mesh/mesh_formats.h"

#include <float.h>
#include <math.h>

enum
{
    HEADER_SIZE = 80,
    TRIANGLE_SIZE = 50
};

/// The unit normal of a face, all zero where it has none. Edges are scaled first, so that their products stay in range.
static void face_normal(const bat_mesh *mesh, size_t face, double normal[3])
{
    const double *p[3];
    double edges[2][3], largest = 0.0;
    for (int c = 0; c < 3; c++)
        p[c] = mesh->positions + 3 * (size_t)mesh->faces[3 * face + (size_t)c];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
        {
            edges[i][k] = p[i + 1][k] / 2 - p[0][k] / 2;
            largest = fmax(largest, fabs(edges[i][k]));
        }
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            edges[i][k] = largest > 0 ? edges[i][k] / largest : 0.0;
    const double *a = edges[0], *b = edges[1];
    normal[0] = a[1] * b[2] - a[2] * b[1];
    normal[1] = a[2] * b[0] - a[0] * b[2];
    normal[2] = a[0] * b[1] - a[1] * b[0];
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int k = 0; k < 3; k++)
        normal[k] = length > 0 ? normal[k] / length + 0.0 : 0.0;
}

static char *put_bytes(char *out, uint32_t bits)
{
    for (int i = 0; i < 4; i++)
        *out++ = (char)(bits >> 8 * i & 0xff);
    return out;
}

static char *put_floats(char *out, const double values[3])
{
    for (int k = 0; k < 3; k++)
    {
        float value = (float)values[k];
        uint32_t bits;
        memcpy(&bits, &value, sizeof bits);
        out = put_bytes(out, bits);
    }
    return out;
}

static void format_binary(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    (void)context;
    for (size_t f = begin; f < end; f++)
    {
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
}

static void append_numbers(text_buffer *text, const char *words, const double numbers[3])
{
    text_append_string(text, words);
    char *out = text_reserve(text, 3 * (NUMBER_TEXT_SIZE + 1) + 1);
    if (out == NULL)
        return;
    for (int k = 0; k < 3; k++)
    {
        *out++ = ' ';
        out = number_write(out, numbers[k]);
    }
    *out++ = '\n';
    text_advance(text, out);
}

static void format_text(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    (void)context;
    for (size_t f = begin; f < end; f++)
    {
        double normal[3];
        face_normal(mesh, f, normal);
        append_numbers(text, "facet normal", normal);
        text_append_string(text, "outer loop\n");
        for (size_t h = 3 * f; h < 3 * f + 3; h++)
            append_numbers(text, "vertex", mesh->positions + 3 * (size_t)mesh->faces[h]);
        text_append_string(text, "endloop\nendfacet\n");
    }
}

/// Single precision must hold every coordinate.
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
    (void)put_bytes(header + HEADER_SIZE, (uint32_t)mesh->face_count);
    text_buffer text = {0};
    bat_status status = check_range(mesh, error);
    if (status == BAT_OK)
    {
        text_append(&text, header, sizeof header);
        status = sink_write(sink, &text, error);
    }
    text_free(&text);
    if (status == BAT_OK)
        status = mesh_rows_write(mesh, mesh->face_count, format_binary, NULL, options->threads, sink, error);
    return status;
}

static bat_status write_line(text_sink *sink, const char *line, bat_error *error)
{
    text_buffer text = {0};
    text_append_string(&text, line);
    bat_status status = sink_write(sink, &text, error);
    text_free(&text);
    return status;
}

bat_status mesh_stl_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    if (options->encoding != BAT_MESH_ENCODING_TEXT)
        return write_binary(mesh, options, sink, error);
    bat_status status = write_line(sink, "solid mesh\n", error);
    if (status == BAT_OK)
        status = mesh_rows_write(mesh, mesh->face_count, format_text, NULL, options->threads, sink, error);
    return status == BAT_OK ? write_line(sink, "endsolid mesh\n", error) : status;
}
