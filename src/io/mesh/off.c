#include "io/mesh/builder.h"
#include "mesh/sides.h"

/// @file
/// The Object File Format of Geomview in text form, [ST][C][N]OFF: texture coordinates, colours and normals at vertices.

enum
{
    COORDINATES = 3,
    MAX_NUMBERS = 3 + 3 + 4 + 2 ///< position, normal, colour, texture
};

typedef struct off_reader
{
    mesh_builder builder;
    word_scan scan;
    bool lenient;                          ///< numbers of vertices need not be finite
    bool textured, coloured, with_normals; ///< the data of each vertex, from the header word
    size_t colours;                        ///< numbers of a colour, 3 or 4; 0 before the first vertex
    size_t vertices, faces;                ///< from the header
} off_reader;

static bool skip_letters(word_scan *scan, const char *letters)
{
    size_t size = strlen(letters);
    bool there = (size_t)(scan->end - scan->at) >= size && memcmp(scan->at, letters, size) == 0;
    scan->at += there ? size : 0;
    return there;
}

/// Read the header word [ST][C][N]OFF.
static bool read_header_word(off_reader *reader)
{
    word_scan *scan = &reader->scan;
    if (!scan_next_content(scan))
        return false;
    reader->textured = skip_letters(scan, "ST");
    reader->coloured = skip_letters(scan, "C");
    reader->with_normals = skip_letters(scan, "N");
    return skip_letters(scan, "OFF") && scan_word_ends(scan, scan->at);
}

bool mesh_off_resembles(const file_text *text)
{
    off_reader reader = {.scan = word_scan_start(text->data, text->size)};
    return read_header_word(&reader);
}

/// Read a number of vertices or faces. Each of them takes a line, so large numbers in short files are errors.
static bat_status read_count(off_reader *reader, const char *what, size_t *count, bat_error *error)
{
    word_scan *scan = &reader->scan;
    uint64_t value;
    if (!scan_count(scan, BAT_MESH_NONE, &value))
        return scan_word_fault(scan, BAT_NO_INDEX, what, error);
    *count = (size_t)value;
    return BAT_OK;
}

static bat_status read_header(off_reader *reader, bat_error *error)
{
    static const size_t SHORTEST_LINE = 6; ///< of a vertex or a face, with its line break
    word_scan *scan = &reader->scan;
    if (!read_header_word(reader))
        return ERROR_FILE(error, scan->line, "the file does not begin with OFF, COFF, NOFF, CNOFF, STOFF or a similar word");
    if (scan_word(scan, "BINARY"))
        return ERROR_UNSUPPORTED(error, scan->line, "binary OFF is not read");
    if (!scan_next_content(scan))
        return ERROR_FILE(error, scan->line, "the counts of vertices and faces are missing");
    bat_status status = read_count(reader, "is not the number of vertices", &reader->vertices, error);
    if (status == BAT_OK)
        status = read_count(reader, "is not the number of faces", &reader->faces, error);
    size_t edges;
    if (status == BAT_OK && !scan_line_done(scan))
        status = read_count(reader, "is not the number of edges", &edges, error);
    if (status == BAT_OK && !scan_line_done(scan))
        status = scan_word_fault(scan, BAT_NO_INDEX, "follows the counts of vertices, faces and edges", error);
    size_t max_count = (size_t)(scan->end - scan->at) / SHORTEST_LINE + 1;
    if (status == BAT_OK && (reader->vertices > max_count || reader->faces > max_count - reader->vertices + 1))
        return ERROR_FILE(error, scan->line, "the file is too short for %zu vertices and %zu faces", reader->vertices,
                          reader->faces);
    if (status == BAT_OK && !mesh_builder_reserve(&reader->builder, reader->vertices, reader->faces))
        status = mesh_builder_no_memory(&reader->builder, error);
    return status;
}

/// Assign the numbers of a vertex: position, normal (ignored), colour, texture coordinate.
static bat_status take_vertex(off_reader *reader, const double *numbers, size_t count, bat_error *error)
{
    mesh_builder *builder = &reader->builder;
    size_t index = builder->mesh.vertex_count, before_colour = reader->with_normals ? 2 * COORDINATES : COORDINATES;
    size_t texture = reader->textured ? 2 : 0;
    if (reader->coloured && index == 0)
    {
        reader->colours = count == before_colour + texture + 3 ? 3 : 4;
        if (!channels_set_names(&builder->mesh, mesh_colour_names, reader->colours))
            return mesh_builder_no_memory(&reader->builder, error);
    }
    size_t expected = before_colour + reader->colours + texture;
    if (count != expected)
        return error_set(error, BAT_BAD_FILE, index, reader->scan.line, "vertex %zu has %zu numbers instead of %zu", index,
                         count, expected);
    double *position = mesh_builder_vertex(builder);
    double *colour = reader->coloured ? mesh_builder_channels(builder) : NULL;
    double *place = reader->textured ? mesh_builder_texture(builder) : NULL;
    if (position == NULL || (reader->coloured && colour == NULL) || (reader->textured && place == NULL))
        return mesh_builder_no_memory(&reader->builder, error);
    memcpy(position, numbers, COORDINATES * sizeof *numbers);
    if (reader->coloured)
        memcpy(colour, numbers + before_colour, reader->colours * sizeof *numbers);
    if (reader->textured)
        memcpy(place, numbers + before_colour + reader->colours, 2 * sizeof *numbers);
    return BAT_OK;
}

static bat_status read_vertex(off_reader *reader, bat_error *error)
{
    word_scan *scan = &reader->scan;
    size_t count = 0, index = reader->builder.mesh.vertex_count;
    double numbers[MAX_NUMBERS];
    if (!scan_next_content(scan))
        return error_set(error, BAT_BAD_FILE, index, scan->line, "the file ends at vertex %zu of %zu", index,
                         reader->vertices);
    for (; !scan_line_done(scan); count++)
    {
        if (count == MAX_NUMBERS)
            return error_set(error, BAT_BAD_FILE, index, scan->line, "vertex %zu has more than %d numbers", index,
                             MAX_NUMBERS);
        if (!scan_number(scan, &numbers[count]) && !(reader->lenient && scan_not_finite(scan, &numbers[count])))
            return scan_number_fault(scan, index, "a number is missing", error);
    }
    return take_vertex(reader, numbers, count, error);
}

/// Skip the colour of a face, 0 to 4 numbers.
static bat_status skip_colour(off_reader *reader, bat_error *error)
{
    static const int MAX_COLOURS = 4;
    word_scan *scan = &reader->scan;
    size_t index = reader->builder.mesh.face_count;
    double colour;
    for (int count = 0; !scan_line_done(scan); count++)
    {
        if (count == MAX_COLOURS)
            return scan_word_fault(scan, index, "follows the face's corners and colour", error);
        if (!scan_number(scan, &colour))
            return scan_number_fault(scan, index, "a number is missing", error);
    }
    return BAT_OK;
}

static bat_status read_face(off_reader *reader, bat_error *error)
{
    word_scan *scan = &reader->scan;
    mesh_builder *builder = &reader->builder;
    size_t index = builder->mesh.face_count;
    uint64_t size, vertex;
    if (!scan_next_content(scan))
        return error_set(error, BAT_BAD_FILE, index, scan->line, "the file ends at face %zu of %zu", index, reader->faces);
    if (!scan_count(scan, BAT_MESH_NONE, &size))
        return scan_word_fault(scan, index, "is not the number of a face's corners", error);
    size_t line = scan->line;
    for (uint64_t i = 0; i < size; i++)
    {
        if (!scan_next_content(scan)) // a face may take several lines
            return error_set(error, BAT_BAD_FILE, index, line, "face %zu has %zu of its %zu corners", index, (size_t)i,
                             (size_t)size);
        if (!scan_count(scan, reader->vertices, &vertex))
            return scan_word_fault(scan, index, "is not the number, from 0, of a vertex", error);
        if (!mesh_builder_corner(builder, (uint32_t)vertex, reader->textured ? (uint32_t)vertex : BAT_MESH_NONE))
            return mesh_builder_no_memory(&reader->builder, error);
    }
    bat_status status = skip_colour(reader, error);
    if (status != BAT_OK)
        return status;
    return mesh_builder_end_face(builder, (uint32_t)size) ? BAT_OK : mesh_builder_no_memory(&reader->builder, error);
}

/// Scale colours from 0 … 255 to 0 … 1 if any value is greater than 1.
static void scale_colours(mesh_builder *builder)
{
    static const double whole = 255.0;
    size_t count = builder->mesh.vertex_count * builder->mesh.channel_count;
    bool bytes = false;
    for (size_t i = 0; i < count; i++)
        bytes = bytes || builder->mesh.channels[i] > 1.0;
    for (size_t i = 0; bytes && i < count; i++)
        builder->mesh.channels[i] /= whole;
}

/// Read the header, the vertices and the first `faces` faces, or all.
static bat_status read_elements(off_reader *reader, size_t faces, bat_error *error)
{
    bat_status status = read_header(reader, error);
    for (size_t i = 0; i < reader->vertices && status == BAT_OK; i++)
        status = read_vertex(reader, error);
    for (size_t i = 0; i < reader->faces && i < faces && status == BAT_OK; i++)
        status = read_face(reader, error);
    return status;
}

/// The line of a face, by reading up to it; needed only for errors.
static size_t line_of_face(off_reader *reader, const file_text *text, size_t face)
{
    bat_error ignored;
    reader->scan = word_scan_start(text->data, text->size);
    mesh_builder_free(&reader->builder);
    bat_status status = read_elements(reader, face, &ignored);
    (void)scan_next_content(&reader->scan);
    mesh_builder_free(&reader->builder);
    return status == BAT_OK ? reader->scan.line : 0;
}

bat_status mesh_off_read(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    off_reader reader = {.scan = word_scan_start(text->data, text->size), .lenient = options->repair || !options->strict};
    bat_status status = read_elements(&reader, SIZE_MAX, error);
    if (status == BAT_OK && scan_next_content(&reader.scan))
        status = scan_word_fault(&reader.scan, BAT_NO_INDEX, "follows the last face", error);
    if (status != BAT_OK)
    {
        mesh_builder_free(&reader.builder);
        return status;
    }
    scale_colours(&reader.builder);
    if (reader.with_normals)
        status = mesh_note(options->notes, error, MESH_NORMALS_LEFT_OUT, reader.vertices);
    if (status == BAT_OK)
        status = mesh_builder_finish(&reader.builder, options, mesh, error);
    if (status != BAT_OK && error != NULL && error->index != BAT_NO_INDEX)
        error->line = line_of_face(&reader, text, error->index);
    mesh_builder_free(&reader.builder);
    return status;
}

/// What is written, with optional data.
typedef struct off_parts
{
    const bat_mesh *mesh;
    size_t colour_places[MESH_COLOURS];
    size_t colours;
    bool textured;
} off_parts;

static void format_vertex(const void *context, size_t v, text_buffer *text)
{
    const off_parts *parts = context;
    const bat_mesh *mesh = parts->mesh;
    double numbers[5 + MESH_COLOURS];
    size_t count = 3;
    memcpy(numbers, mesh->positions + 3 * v, 3 * sizeof *numbers);
    for (size_t i = 0; i < parts->colours; i++)
        numbers[count++] = mesh->channels[v * mesh->channel_count + parts->colour_places[i]];
    for (size_t k = 0; k < 2 && parts->textured; k++)
        numbers[count++] = mesh->texture[2 * v + k];
    text_append_numbers(text, "", numbers, count);
}

static void format_face(const void *context, size_t f, text_buffer *text)
{
    const bat_mesh *mesh = ((const off_parts *)context)->mesh;
    size_t first = mesh_corners_until(mesh, f), last = mesh_corners_until(mesh, f + 1);
    text_append_count(text, last - first, " ");
    for (size_t h = first; h < last; h++)
        text_append_count(text, mesh->faces[h], h + 1 < last ? " " : "\n");
}

/// Check that colours are at most 1; greater ones would be read as 0 … 255.
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

bat_status mesh_off_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    off_parts parts = {.mesh = mesh, .textured = mesh_texture_by_vertex(mesh)};
    parts.colours = mesh_colours(mesh, parts.colour_places);
    bat_status status = check_colours(mesh, &parts, error);
    if (status == BAT_OK)
        status = sink_format(sink, error, "%s%s\n%zu %zu 0\n", parts.textured ? "ST" : "",
                             parts.colours > 0 ? "COFF" : "OFF", mesh->vertex_count, mesh->face_count);
    if (status == BAT_OK)
        status = text_lines_write(sink, mesh->vertex_count, options->threads, format_vertex, &parts, error);
    return status == BAT_OK ? text_lines_write(sink, mesh->face_count, options->threads, format_face, &parts, error)
                            : status;
}
