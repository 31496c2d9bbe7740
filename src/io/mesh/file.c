#include "batten/mesh_file.h"

#include "base/atomic_file.h"
#include "base/choice.h"
#include "base/error.h"
#include "base/option.h"
#include "io/mesh/formats.h"

#include <string.h>

/// @file
/// Reading and writing of meshes in any format, from files and from memory.

const char *const mesh_colour_names[MESH_COLOURS] = {"red", "green", "blue", "alpha"};

/// A format: its reader, its writer, and whether a text begins as it does. OBJ has no mark at its begin: whatever has no
/// other's is taken for it.
typedef struct mesh_format
{
    bat_choice choice;
    bat_status (*read)(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error);
    bat_status (*write)(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error);
    bool (*resembles)(const file_text *text);
} mesh_format;

static const mesh_format FORMATS[] = {
    {.choice = {.name = "auto", .summary = "by the file's ending", .value = BAT_MESH_FORMAT_AUTO}},
    {{.name = "obj",
      .summary = "meshes: with texture coordinates, creases and corners",
      .endings = ".obj",
      .reads = true,
      .writes = true,
      .value = BAT_MESH_FORMAT_OBJ},
     mesh_obj_read,
     mesh_obj_write,
     NULL},
    {{.name = "ply",
      .summary = "meshes: binary or text, with values at the vertices",
      .endings = ".ply",
      .reads = true,
      .writes = true,
      .value = BAT_MESH_FORMAT_PLY},
     mesh_ply_read,
     mesh_ply_write,
     mesh_ply_resembles},
    {{.name = "off",
      .summary = "meshes: text, with colours",
      .endings = ".off",
      .reads = true,
      .writes = true,
      .value = BAT_MESH_FORMAT_OFF},
     mesh_off_read,
     mesh_off_write,
     mesh_off_resembles},
    {{.name = "stl",
      .summary = "meshes: separate triangles in single precision",
      .endings = ".stl",
      .reads = true,
      .writes = true,
      .value = BAT_MESH_FORMAT_STL},
     mesh_stl_read,
     mesh_stl_write,
     mesh_stl_resembles},
};
static const choice_table TABLE = CHOICE_TABLE("mesh format", FORMATS);

CHOICE_FUNCTIONS(bat_mesh_format, TABLE, 1)

/// The row of a format other than BAT_MESH_FORMAT_AUTO.
static const mesh_format *row_of(bat_mesh_format format)
{
    return (const mesh_format *)(const void *)choice_of_value(&TABLE, (int)format);
}

bat_mesh_format bat_mesh_format_of_path(const char *path)
{
    const bat_choice *row = choice_of_path(&TABLE, path);
    return row != NULL ? (bat_mesh_format)row->value : BAT_MESH_FORMAT_AUTO;
}

/// The format of the options, else of a file's ending; BAT_MESH_FORMAT_AUTO for a name without one.
static bat_status format_for_path(const char *path, bool writes, bat_mesh_format wanted, bat_mesh_format *format,
                                  bat_error *error)
{
    const bat_choice *row = NULL;
    bat_status status = BAT_OK;
    if (wanted == BAT_MESH_FORMAT_AUTO)
        status = choice_for_path(&TABLE, path, writes, writes ? "to" : "from", &row, error);
    *format = row != NULL ? (bat_mesh_format)row->value : wanted;
    return status;
}

size_t mesh_colours(const bat_mesh *mesh, size_t places[MESH_COLOURS])
{
    size_t count = 0;
    for (; count < MESH_COLOURS; count++)
    {
        size_t i = 0;
        while (i < mesh->channel_count && strcmp(mesh->channel_names[i], mesh_colour_names[count]) != 0)
            i++;
        if (i == mesh->channel_count)
            break;
        places[count] = i;
    }
    return count >= MESH_COLOURS - 1 ? count : 0;
}

bool mesh_texture_by_vertex(const bat_mesh *mesh)
{
    return mesh->texture_faces != NULL && mesh->texture_count == mesh->vertex_count &&
           memcmp(mesh->texture_faces, mesh->faces, 3 * mesh->face_count * sizeof *mesh->faces) == 0;
}

enum
{
    ROWS_PER_BLOCK = 1 << 14
};

typedef struct row_job
{
    const bat_mesh *mesh;
    size_t count;
    mesh_row_format *format;
    const void *context;
} row_job;

static bat_status format_block(const void *context, size_t block, text_buffer *text, bat_error *error)
{
    (void)error; // the sink reports a lack of memory
    const row_job *job = context;
    size_t begin = block * ROWS_PER_BLOCK, left = job->count - begin;
    job->format(job->mesh, job->context, begin, begin + (left < ROWS_PER_BLOCK ? left : ROWS_PER_BLOCK), text);
    return BAT_OK;
}

bat_status mesh_rows_write(const bat_mesh *mesh, size_t count, mesh_row_format *format, const void *context, int threads,
                           text_sink *sink, bat_error *error)
{
    row_job job = {mesh, count, format, context};
    return blocks_write(sink, count / ROWS_PER_BLOCK + (count % ROWS_PER_BLOCK > 0), threads, format_block, &job, error);
}

bat_mesh_read_options bat_mesh_read_defaults(void)
{
    return (bat_mesh_read_options){.format = BAT_MESH_FORMAT_AUTO};
}

bat_mesh_write_options bat_mesh_write_defaults(void)
{
    return (bat_mesh_write_options){.format = BAT_MESH_FORMAT_AUTO, .encoding = BAT_MESH_ENCODING_BINARY};
}

bat_status bat_mesh_read_options_check(const bat_mesh_read_options *options, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_mesh_read_options, format, OPTION_CHOICE, 0, BAT_MESH_FORMAT_STL),
    };
    return options == NULL ? BAT_OK : OPTIONS_CHECK(options, FIELDS, error);
}

bat_status bat_mesh_write_options_check(const bat_mesh_write_options *options, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_mesh_write_options, format, OPTION_CHOICE, 0, BAT_MESH_FORMAT_STL),
        OPTION_FIELD(bat_mesh_write_options, encoding, OPTION_CHOICE, 0, BAT_MESH_ENCODING_TEXT),
        OPTION_THREADS(bat_mesh_write_options),
    };
    return options == NULL ? BAT_OK : OPTIONS_CHECK(options, FIELDS, error);
}

/// The format of a text. OBJ has no signature; texts without another format's signature are OBJ.
static bat_mesh_format format_of_text(const file_text *text)
{
    for (size_t i = 0; i < sizeof FORMATS / sizeof *FORMATS; i++)
        if (FORMATS[i].resembles != NULL && FORMATS[i].resembles(text))
            return (bat_mesh_format)FORMATS[i].choice.value;
    return BAT_MESH_FORMAT_OBJ;
}

static bat_status read_format(const file_text *text, bat_mesh_format format, const bat_mesh_read_options *options,
                              bat_mesh *mesh, bat_error *error)
{
    if (format == BAT_MESH_FORMAT_AUTO)
        format = format_of_text(text);
    return row_of(format)->read(text, options, mesh, error);
}

/// Read a mesh, and repair it where that is asked for.
static bat_status read_text(const file_text *text, bat_mesh_format format, const bat_mesh_read_options *options,
                            bat_mesh *mesh, bat_error *error)
{
    bat_mesh_read_options lenient = *options;
    bat_mesh_repair_report report = {0};
    bat_mesh broken;
    lenient.keep_degenerate = options->keep_degenerate || options->repair;
    bat_status status = read_format(text, format, &lenient, options->repair ? &broken : mesh, error);
    if (status == BAT_OK && options->repair)
    {
        status = bat_mesh_repair(&broken, &report, mesh, error);
        bat_mesh_free(&broken);
    }
    if (status == BAT_OK && options->repairs != NULL)
        *options->repairs = report;
    return status;
}

bat_status bat_mesh_read(const char *path, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    bat_mesh_read_options defaults = bat_mesh_read_defaults();
    if (options == NULL)
        options = &defaults;
    file_text text;
    bat_mesh_format format;
    bat_status status = bat_mesh_read_options_check(options, error);
    if (status == BAT_OK)
        status = format_for_path(path, false, options->format, &format, error);
    if (status == BAT_OK)
        status = file_text_read(path, &text, error);
    if (status != BAT_OK)
        return status;
    status = read_text(&text, format, options, mesh, error);
    file_text_free(&text);
    return status;
}

bat_status bat_mesh_read_memory(const void *bytes, size_t size, const bat_mesh_read_options *options, bat_mesh *mesh,
                                bat_error *error)
{
    bat_mesh_read_options defaults = bat_mesh_read_defaults();
    if (options == NULL)
        options = &defaults;
    file_text text;
    bat_status status = bat_mesh_read_options_check(options, error);
    if (status == BAT_OK)
        status = file_text_copy(bytes, size, &text, error);
    if (status != BAT_OK)
        return status;
    status = read_text(&text, options->format, options, mesh, error);
    file_text_free(&text);
    return status;
}

static bat_status check_write(const bat_mesh *mesh, bat_mesh_format format, const bat_mesh_write_options *options,
                              bat_error *error)
{
    bat_status status = bat_mesh_write_options_check(options, error);
    if (status != BAT_OK)
        return status;
    char known[2 * BAT_ERROR_TEXT_SIZE / 3];
    if (format == BAT_MESH_FORMAT_AUTO)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "cannot tell what format to write; the endings are %s",
                         choice_endings(&TABLE, true, known, sizeof known));
    if (options->encoding == BAT_MESH_ENCODING_BIG_ENDIAN && format != BAT_MESH_FORMAT_PLY)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "only PLY supports the big-endian encoding");
    return bat_mesh_check(mesh, error);
}

bat_status bat_mesh_write(const char *path, const bat_mesh *mesh, const bat_mesh_write_options *options, bat_error *error)
{
    bat_mesh_write_options defaults = bat_mesh_write_defaults();
    if (options == NULL)
        options = &defaults;
    bat_mesh_format format;
    atomic_file file;
    bat_status status = format_for_path(path, true, options->format, &format, error);
    if (status == BAT_OK)
        status = check_write(mesh, format, options, error);
    if (status == BAT_OK)
        status = atomic_file_begin(path, &file, error);
    if (status != BAT_OK)
        return status;
    text_sink sink = {.stream = file.stream};
    status = row_of(format)->write(mesh, options, &sink, error);
    return atomic_file_end(&file, status, error);
}

bat_status bat_mesh_write_memory(const bat_mesh *mesh, const bat_mesh_write_options *options, char **bytes, size_t *size,
                                 bat_error *error)
{
    bat_mesh_write_options defaults = bat_mesh_write_defaults();
    if (options == NULL)
        options = &defaults;
    bat_status status = check_write(mesh, options->format, options, error);
    if (status != BAT_OK)
        return status;
    text_buffer buffer = {0};
    text_sink sink = {.buffer = &buffer};
    status = row_of(options->format)->write(mesh, options, &sink, error);
    text_append(&buffer, "", 1);
    if (status == BAT_OK && buffer.failed)
        status = error_memory(error, buffer.size);
    if (status != BAT_OK)
    {
        text_free(&buffer);
        return status;
    }
    *bytes = buffer.data;
    *size = buffer.size - 1;
    return BAT_OK;
}
