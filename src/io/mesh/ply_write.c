#include "io/common/bytes.h"
#include "io/mesh/ply.h"
#include "mesh/sides.h"

#include <math.h>

/// @file
/// Writer of PLY in text and both binary encodings. Numbers are doubles; colours that bytes represent exactly are bytes.

/// The data to write, and the encoding.
typedef struct ply_plan
{
    const bat_mesh *mesh;
    bool *bytes; ///< for each channel: whether it is a colour and all values are multiples of 1/255
    bool texture_by_vertex, texture_by_corner;
    bool text, big_endian;
    const double *normals; ///< null: none
    bool long_lists;       ///< the lengths of lists need four bytes
} ply_plan;

/// Whether bytes represent a channel exactly, as a colour.
static bool is_byte_colour(const bat_mesh *mesh, size_t channel)
{
    bool colour = false;
    for (size_t i = 0; i < MESH_COLOURS; i++)
        colour = colour || strcmp(mesh->channel_names[channel], mesh_colour_names[i]) == 0;
    for (size_t v = 0; v < mesh->vertex_count && colour; v++)
    {
        double value = mesh->channels[v * mesh->channel_count + channel];
        colour = value >= 0 && value <= 1 && !signbit(value) && round(value * UINT8_MAX) / UINT8_MAX == value;
    }
    return colour;
}

/// Whether a property of this name is read back as a channel.
static bool is_channel_name(const char *name)
{
    static const char *const taken[] = {"x", "y", "z", "nx", "ny", "nz"};
    for (const char *at = name; *at != '\0'; at++)
        if (*at <= ' ' || *at == '#' || *at > '~')
            return false;
    return *name != '\0' && !label_name_taken(name, taken, sizeof *taken, sizeof taken / sizeof *taken);
}

/// Whether one of the first channels has a name.
static bool has_channel(const bat_mesh *mesh, const char *name, size_t before)
{
    return label_name_taken(name, mesh->channel_names, sizeof *mesh->channel_names, before);
}

static bat_status check_names(const bat_mesh *mesh, const ply_plan *plan, bat_error *error)
{
    size_t count = mesh->channel_count;
    for (size_t i = 0; i < count; i++)
    {
        const char *name = mesh->channel_names[i];
        char excerpt[EXCERPT_SIZE];
        bool texture = plan->texture_by_vertex &&
                       (strcmp(name, ply_texture_names[0][0]) == 0 || strcmp(name, ply_texture_names[0][1]) == 0);
        if (!is_channel_name(name) || texture || has_channel(mesh, name, i))
            return ERROR_UNSUPPORTED(error, 0, "PLY cannot hold a channel named '%s' beside the others",
                                     text_excerpt(excerpt, name, name + strlen(name)));
    }
    for (size_t i = 0; i < PLY_TEXTURE_NAMES && !plan->texture_by_vertex && !plan->texture_by_corner; i++)
        if (has_channel(mesh, ply_texture_names[i][0], count) && has_channel(mesh, ply_texture_names[i][1], count))
            return ERROR_UNSUPPORTED(error, 0, "PLY would make a texture coordinate of the channels '%s' and '%s'",
                                     ply_texture_names[i][0], ply_texture_names[i][1]);
    return BAT_OK;
}

static bat_status write_header(const bat_mesh *mesh, const ply_plan *plan, text_sink *sink, bat_error *error)
{
    text_buffer text = {0};
    const char *encoding = plan->text ? "ascii" : plan->big_endian ? "binary_big_endian" : "binary_little_endian";
    TEXT_APPEND(&text, "ply\nformat ", encoding, " 1.0\n");
    ply_labels_write(mesh, &text);
    text_append_string(&text, "element vertex ");
    text_append_count(&text, mesh->vertex_count, "\nproperty double x\nproperty double y\nproperty double z\n");
    if (plan->normals != NULL)
        text_append_string(&text, "property double nx\nproperty double ny\nproperty double nz\n");
    if (plan->texture_by_vertex)
        text_append_string(&text, "property double s\nproperty double t\n");
    for (size_t i = 0; i < mesh->channel_count; i++)
        TEXT_APPEND(&text, plan->bytes[i] ? "property uchar " : "property double ", mesh->channel_names[i], "\n");
    text_append_string(&text, "element face ");
    text_append_count(&text, mesh->face_count, plan->long_lists ? "\nproperty list uint " : "\nproperty list uchar ");
    TEXT_APPEND(&text, mesh->vertex_count > INT32_MAX ? "uint" : "int", " vertex_indices\n");
    if (plan->texture_by_corner)
        text_append_string(&text, plan->long_lists ? "property list uint double texcoord\n"
                                                   : "property list uchar double texcoord\n");
    if (mesh->face_labels != NULL)
        text_append_string(&text, "property uint " PLY_LABEL "\n");
    text_append_string(&text, "end_header\n");
    return sink_take(sink, &text, BAT_OK, error);
}

static char *put_double(char *out, double value, const ply_plan *plan)
{
    uint64_t bits;
    if (plan->text)
    {
        out = number_write(out, value);
        *out++ = ' ';
        return out;
    }
    memcpy(&bits, &value, sizeof bits);
    return bytes_put(out, bits, sizeof bits, plan->big_endian);
}

static char *put_integer(char *out, uint32_t value, size_t size, const ply_plan *plan)
{
    if (!plan->text)
        return bytes_put(out, value, size, plan->big_endian);
    out = number_write_fixed(out, value, 0);
    *out++ = ' ';
    return out;
}

/// In text, replace the last blank by a line break.
static char *end_row(char *out, const ply_plan *plan)
{
    if (plan->text)
        out[-1] = '\n';
    return out;
}

static void format_vertex(const void *context, size_t v, text_buffer *text)
{
    static const size_t MAX_NUMBERS = 8;
    const ply_plan *plan = context;
    const bat_mesh *mesh = plan->mesh;
    char *out = text_reserve(text, (MAX_NUMBERS + mesh->channel_count) * (NUMBER_TEXT_SIZE + 1));
    if (out == NULL)
        return;
    for (size_t k = 0; k < 3; k++)
        out = put_double(out, mesh->positions[3 * v + k], plan);
    for (size_t k = 0; k < 3 && plan->normals != NULL; k++)
        out = put_double(out, plan->normals[3 * v + k], plan);
    for (size_t k = 0; k < 2 && plan->texture_by_vertex; k++)
        out = put_double(out, mesh->texture[2 * v + k], plan);
    for (size_t i = 0; i < mesh->channel_count; i++)
    {
        double value = mesh->channels[v * mesh->channel_count + i];
        out = plan->bytes[i] ? put_integer(out, (uint32_t)round(value * UINT8_MAX), 1, plan) : put_double(out, value, plan);
    }
    text_advance(text, end_row(out, plan));
}

static void format_face(const void *context, size_t f, text_buffer *text)
{
    static const size_t INDEX_SIZE = 4;
    const ply_plan *plan = context;
    const bat_mesh *mesh = plan->mesh;
    size_t length_size = plan->long_lists ? 4 : 1;
    size_t first = mesh_corners_until(mesh, f), last = mesh_corners_until(mesh, f + 1);
    uint32_t corners = (uint32_t)(last - first);
    char *out = text_reserve(text, (3 * (size_t)corners + 3) * (NUMBER_TEXT_SIZE + 1));
    if (out == NULL)
        return;
    out = put_integer(out, corners, length_size, plan);
    for (size_t h = first; h < last; h++)
        out = put_integer(out, mesh->faces[h], INDEX_SIZE, plan);
    if (plan->texture_by_corner)
        out = put_integer(out, 2 * corners, length_size, plan);
    for (size_t h = first; h < last && plan->texture_by_corner; h++)
        for (size_t k = 0; k < 2; k++)
            out = put_double(out, mesh->texture[2 * (size_t)mesh->texture_faces[h] + k], plan);
    if (mesh->face_labels != NULL)
        out = put_integer(out, mesh->face_labels[f], INDEX_SIZE, plan);
    text_advance(text, end_row(out, plan));
}

bat_status mesh_ply_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    ply_plan plan = {.mesh = mesh,
                     .texture_by_vertex = mesh_texture_by_vertex(mesh),
                     .text = options->encoding == BAT_MESH_ENCODING_TEXT,
                     .big_endian = options->encoding == BAT_MESH_ENCODING_BIG_ENDIAN,
                     .normals = options->vertex_normals};
    plan.texture_by_corner = mesh->texture_faces != NULL && !plan.texture_by_vertex;
    for (size_t f = 0; mesh->offsets != NULL && f < mesh->face_count; f++)
        plan.long_lists = plan.long_lists || mesh->offsets[f + 1] - mesh->offsets[f] > UINT8_MAX / 2;
    bat_status status = check_names(mesh, &plan, error);
    if (status != BAT_OK)
        return status;
    plan.bytes = memory_array(mesh->channel_count, sizeof *plan.bytes);
    if (plan.bytes == NULL)
        return error_memory(error, mesh->channel_count);
    for (size_t i = 0; i < mesh->channel_count; i++)
        plan.bytes[i] = is_byte_colour(mesh, i);
    status = write_header(mesh, &plan, sink, error);
    if (status == BAT_OK)
        status = text_lines_write(sink, mesh->vertex_count, options->threads, format_vertex, &plan, error);
    if (status == BAT_OK)
        status = text_lines_write(sink, mesh->face_count, options->threads, format_face, &plan, error);
    free(plan.bytes);
    return status;
}
