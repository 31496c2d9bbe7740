#include "io/common/number_text.h"
#include "io/mesh/mesh_formats.h"

#include <math.h>

/// Blanks and numbers.
static char *write_numbers(char *out, const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        *out++ = ' ';
        out = number_write(out, numbers[i]);
    }
    return out;
}

/// A sharpness that a file can hold.
static double finite_sharpness(double sharpness)
{
    return isfinite(sharpness) ? sharpness : BAT_MESH_SHARP;
}

/// The colours' places among the channels.
typedef struct obj_colours
{
    size_t places[MESH_COLOURS];
    size_t count;
} obj_colours;

static void format_vertices(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    const obj_colours *colours = context;
    for (size_t v = begin; v < end; v++)
    {
        char *out = text_reserve(text, (3 + MESH_COLOURS) * (NUMBER_TEXT_SIZE + 1) + 2);
        if (out == NULL)
            return;
        *out++ = 'v';
        out = write_numbers(out, mesh->positions + 3 * v, 3);
        for (size_t i = 0; i < colours->count; i++)
            out = write_numbers(out, mesh->channels + v * mesh->channel_count + colours->places[i], 1);
        *out++ = '\n';
        text_advance(text, out);
    }
}

static void format_texture(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    (void)context;
    for (size_t i = begin; i < end; i++)
    {
        char *out = text_reserve(text, 2 * (NUMBER_TEXT_SIZE + 1) + 3);
        if (out == NULL)
            return;
        *out++ = 'v';
        *out++ = 't';
        out = write_numbers(out, mesh->texture + 2 * i, 2);
        *out++ = '\n';
        text_advance(text, out);
    }
}

static void format_faces(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    (void)context;
    for (size_t f = begin; f < end; f++)
    {
        char *out = text_reserve(text, 6 * NUMBER_TEXT_SIZE);
        if (out == NULL)
            return;
        *out++ = 'f';
        for (size_t h = 3 * f; h < 3 * f + 3; h++)
        {
            *out++ = ' ';
            out = number_write_fixed(out, (int64_t)mesh->faces[h] + 1, 0);
            if (mesh->texture_faces == NULL)
                continue;
            *out++ = '/';
            out = number_write_fixed(out, (int64_t)mesh->texture_faces[h] + 1, 0);
        }
        *out++ = '\n';
        text_advance(text, out);
    }
}

static void format_creases(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    (void)context;
    for (size_t i = begin; i < end; i++)
    {
        text_append_string(text, "t crease 2/1/0");
        char *out = text_reserve(text, 3 * (NUMBER_TEXT_SIZE + 1) + 1);
        if (out == NULL)
            return;
        const double numbers[] = {mesh->creases[i].a, mesh->creases[i].b, finite_sharpness(mesh->creases[i].sharpness)};
        out = write_numbers(out, numbers, 3);
        *out++ = '\n';
        text_advance(text, out);
    }
}

static void format_corners(const bat_mesh *mesh, const void *context, size_t begin, size_t end, text_buffer *text)
{
    (void)context;
    for (size_t i = begin; i < end; i++)
    {
        text_append_string(text, "t corner 1/1/0");
        char *out = text_reserve(text, 2 * (NUMBER_TEXT_SIZE + 1) + 1);
        if (out == NULL)
            return;
        const double numbers[] = {mesh->corners[i].vertex, finite_sharpness(mesh->corners[i].sharpness)};
        out = write_numbers(out, numbers, 2);
        *out++ = '\n';
        text_advance(text, out);
    }
}

bat_status mesh_obj_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    obj_colours colours;
    colours.count = mesh_colours(mesh, colours.places);
    const struct
    {
        size_t count;
        mesh_row_format *format;
    } parts[] = {{mesh->vertex_count, format_vertices},
                 {mesh->texture_faces != NULL ? mesh->texture_count : 0, format_texture},
                 {mesh->face_count, format_faces},
                 {mesh->crease_count, format_creases},
                 {mesh->corner_count, format_corners}};
    bat_status status = BAT_OK;
    for (size_t i = 0; i < sizeof parts / sizeof *parts && status == BAT_OK; i++)
        status = mesh_rows_write(mesh, parts[i].count, parts[i].format, &colours, options->threads, sink, error);
    return status;
}
