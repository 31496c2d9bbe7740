#include "base/error.h"
#include "io/common/number_text.h"
#include "io/mesh/mesh_formats.h"

/// What is written beside positions and faces.
typedef struct off_parts
{
    size_t colour_places[MESH_COLOURS];
    size_t colours;
    bool textured;
} off_parts;

static char *write_number(char *out, double number)
{
    *out++ = ' ';
    return number_write(out, number);
}

static void format_vertices(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    const off_parts *parts = context;
    for (size_t v = begin; v < end; v++)
    {
        char *out = text_reserve(text, (5 + MESH_COLOURS) * (NUMBER_TEXT_SIZE + 1));
        if (out == NULL)
            return;
        const double *position = mesh->positions + 3 * v;
        out = number_write(out, position[0]);
        out = write_number(write_number(out, position[1]), position[2]);
        for (size_t i = 0; i < parts->colours; i++)
            out = write_number(out, mesh->channels[v * mesh->channel_count + parts->colour_places[i]]);
        if (parts->textured)
            out = write_number(write_number(out, mesh->texture[2 * v]), mesh->texture[2 * v + 1]);
        *out++ = '\n';
        text_advance(text, out);
    }
}

static void format_faces(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    (void)context;
    for (size_t f = begin; f < end; f++)
    {
        char *out = text_reserve(text, 4 * NUMBER_TEXT_SIZE);
        if (out == NULL)
            return;
        *out++ = '3';
        for (size_t h = 3 * f; h < 3 * f + 3; h++)
        {
            *out++ = ' ';
            out = number_write_fixed(out, mesh->faces[h], 0);
        }
        *out++ = '\n';
        text_advance(text, out);
    }
}

/// Colours above 1 would be read as 0 to 255.
static bat_status check_colours(const bat_mesh *mesh, const off_parts *parts, bat_error *error)
{
    for (size_t v = 0; v < mesh->vertex_count; v++)
        for (size_t i = 0; i < parts->colours; i++)
        {
            double value = mesh->channels[v * mesh->channel_count + parts->colour_places[i]];
            if (value > 1.0)
                return error_set(error, BAT_UNSUPPORTED, v, 0, "OFF cannot hold the colour %g of vertex %zu, above 1", value,
                                 v);
        }
    return BAT_OK;
}

static void format_header(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    (void)begin;
    (void)end;
    const off_parts *parts = context;
    text_append_string(text, parts->textured ? "ST" : "");
    text_append_string(text, parts->colours > 0 ? "COFF\n" : "OFF\n");
    char *out = text_reserve(text, 3 * NUMBER_TEXT_SIZE);
    if (out == NULL)
        return;
    out = number_write_fixed(out, (int64_t)mesh->vertex_count, 0);
    *out++ = ' ';
    out = number_write_fixed(out, (int64_t)mesh->face_count, 0);
    *out++ = ' ';
    *out++ = '0';
    *out++ = '\n';
    text_advance(text, out);
}

bat_status mesh_off_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    off_parts parts = {.textured = mesh_texture_by_vertex(mesh)};
    parts.colours = mesh_colours(mesh, parts.colour_places);
    bat_status status = check_colours(mesh, &parts, error);
    if (status == BAT_OK)
        status = mesh_rows_write(mesh, 1, format_header, &parts, 1, sink, error);
    if (status == BAT_OK)
        status = mesh_rows_write(mesh, mesh->vertex_count, format_vertices, &parts, options->threads, sink, error);
    if (status == BAT_OK)
        status = mesh_rows_write(mesh, mesh->face_count, format_faces, NULL, options->threads, sink, error);
    return status;
}
