#include "io/mesh/ply.h"

/// @file
/// Reader of PLY in text and both binary encodings. Vertex properties without another meaning become channels.

/// The destination of a vertex property.
typedef struct ply_place
{
    size_t column; ///< the column of `row`, or NO_COLUMN
    double scale;  ///< the divisor of its values
} ply_place;

#define NO_COLUMN SIZE_MAX

/// The columns of a vertex: position, texture coordinate, channels.
enum
{
    TEXTURE_COLUMN = 3,
    CHANNEL_COLUMN = 5
};

typedef struct ply_reader
{
    ply_header header;
    ply_source source;
    bool lenient; ///< numbers of vertices need not be finite
    mesh_builder builder;
    size_t vertices; ///< from the header
    ply_place *places;
    double *row;
    bool textured;     ///< vertices have texture coordinates
    size_t corners_at; ///< index of the list of corners among a face's properties
    size_t texture_at; ///< index of the list of texture coordinates, or property_count
    size_t label_at;   ///< index of the label, or property_count
    uint32_t *labels;  ///< for each label of the header: its number in the builder
    size_t label_count;
    word_scan first_face; ///< the position of the first face
    uint32_t *face;       ///< the corners of the current face
    size_t face_capacity;
} ply_reader;

static size_t line_of(const ply_reader *reader)
{
    return reader->source.encoding == PLY_TEXT ? reader->source.scan.line : 0;
}

bool mesh_ply_resembles(const file_text *text)
{
    word_scan scan = word_scan_start(text->data, text->size);
    return scan_word(&scan, "ply") && scan_line_done(&scan);
}

/// BAT_BAD_FILE for a number that cannot be read, in a row of an element.
static bat_status number_fault(ply_reader *reader, const ply_element *element, size_t row, const ply_property *property,
                               bat_error *error)
{
    char name[EXCERPT_SIZE], kind[EXCERPT_SIZE], word[EXCERPT_SIZE];
    word_scan *scan = &reader->source.scan;
    (void)text_excerpt(name, property->name.begin, property->name.begin + property->name.size);
    (void)text_excerpt(kind, element->name.begin, element->name.begin + element->name.size);
    bool text = reader->source.encoding == PLY_TEXT;
    if (text ? scan_line_done(scan) : (size_t)(scan->end - scan->at) < ply_type_size(property->type))
        return error_set(error, BAT_BAD_FILE, row, line_of(reader), "%s %zu ends before its '%s'", kind, row, name);
    if (!text)
        return error_set(error, BAT_BAD_FILE, row, 0, "'%s' of %s %zu is not finite, or longer than the file", name, kind,
                         row);
    return error_set(error, BAT_BAD_FILE, row, line_of(reader), "'%s' cannot be the '%s' of %s %zu",
                     text_excerpt(word, scan->at, scan_word_end(scan)), name, kind, row);
}

/// Advance to the line of the row, in text.
static bat_status begin_row(ply_reader *reader, const ply_element *element, size_t row, bat_error *error)
{
    char kind[EXCERPT_SIZE];
    if (reader->source.encoding != PLY_TEXT || scan_next_content(&reader->source.scan))
        return BAT_OK;
    return error_set(error, BAT_BAD_FILE, row, line_of(reader), "the file ends at %s %zu of %zu",
                     text_excerpt(kind, element->name.begin, element->name.begin + element->name.size), row, element->count);
}

static bat_status end_row(ply_reader *reader, size_t row, bat_error *error)
{
    if (reader->source.encoding != PLY_TEXT || scan_line_done(&reader->source.scan))
        return BAT_OK;
    return scan_word_fault(&reader->source.scan, row, "is superfluous on this line", error);
}

/// Read a number of a vertex, which need not be finite where that is allowed.
static bool lenient_number(ply_reader *reader, ply_type type, double *value)
{
    reader->source.lenient = reader->lenient;
    bool there = ply_number(&reader->source, type, value);
    reader->source.lenient = false;
    return there;
}

/// Read the length of a list. False when it is invalid or negative.
static bool read_length(ply_source *source, const ply_property *property, size_t *length)
{
    double value;
    if (!ply_number(source, property->count_type, &value) || value < 0)
        return false;
    *length = (size_t)value;
    return true;
}

static bat_status skip_property(ply_reader *reader, const ply_element *element, size_t row, const ply_property *property,
                                bat_error *error)
{
    size_t length = 1;
    if ((property->list && !read_length(&reader->source, property, &length)) ||
        !ply_skip(&reader->source, property->type, length))
        return number_fault(reader, element, row, property, error);
    return BAT_OK;
}

/// Skip all rows of an element.
static bat_status skip_element(ply_reader *reader, const ply_element *element, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t row = 0; row < element->count && element->property_count > 0 && status == BAT_OK; row++)
    {
        status = begin_row(reader, element, row, error);
        for (size_t i = 0; i < element->property_count && status == BAT_OK; i++)
            status = skip_property(reader, element, row, &element->properties[i], error);
        if (status == BAT_OK)
            status = end_row(reader, row, error);
    }
    return status;
}

/// The divisor that maps a colour of the property's type to 0 … 1.
static double colour_scale(const ply_property *property)
{
    for (size_t i = 0; i < MESH_COLOURS; i++)
        if (label_name_is(property->name, mesh_colour_names[i]))
            return property->type == PLY_UINT8 ? UINT8_MAX : property->type == PLY_UINT16 ? UINT16_MAX : 1.0;
    return 1.0;
}

/// Assign a column to a vertex property. False when it is missing or a list.
static bool place_property(ply_reader *reader, const ply_element *vertex, const char *name, size_t column)
{
    size_t i = ply_property_find(vertex, name);
    if (i == vertex->property_count || vertex->properties[i].list)
        return false;
    reader->places[i].column = column;
    return true;
}

/// Use the first complete pair of texture coordinates.
static void place_texture(ply_reader *reader, const ply_element *vertex)
{
    for (size_t i = 0; i < PLY_TEXTURE_NAMES && !reader->textured; i++)
    {
        const char *const *names = ply_texture_names[i];
        size_t u = ply_property_find(vertex, names[0]), v = ply_property_find(vertex, names[1]);
        reader->textured = u < vertex->property_count && v < vertex->property_count && !vertex->properties[u].list &&
                           !vertex->properties[v].list;
        if (reader->textured)
        {
            (void)place_property(reader, vertex, names[0], TEXTURE_COLUMN);
            (void)place_property(reader, vertex, names[1], TEXTURE_COLUMN + 1);
        }
    }
}

/// Make channels of the remaining numbers. Normals are ignored, because they follow from the mesh; lists are skipped.
static bat_status place_channels(ply_reader *reader, const ply_element *vertex, bat_error *error)
{
    static const char *const normals[] = {"nx", "ny", "nz"};
    char **names = calloc(vertex->property_count, sizeof *names);
    bool made = names != NULL;
    size_t count = 0;
    for (size_t i = 0; i < vertex->property_count && made; i++)
    {
        const ply_property *property = &vertex->properties[i];
        bool normal = false;
        for (size_t k = 0; k < 3; k++)
            normal = normal || label_name_is(property->name, normals[k]);
        if (property->list || normal || reader->places[i].column != NO_COLUMN)
            continue;
        names[count] = strndup(property->name.begin, property->name.size);
        made = names[count] != NULL;
        reader->places[i] = (ply_place){CHANNEL_COLUMN + count, colour_scale(property)};
        count += made;
    }
    made = made && (count == 0 || channels_set_names(&reader->builder.mesh, (const char *const *)names, count));
    for (size_t i = 0; i < count; i++)
        free(names[i]);
    free(names);
    return made ? BAT_OK : mesh_builder_no_memory(&reader->builder, error);
}

static bat_status place_columns(ply_reader *reader, const ply_element *vertex, bool texture_by_corner, bat_error *error)
{
    static const char *const coordinates[] = {"x", "y", "z"};
    reader->places = memory_array(vertex->property_count, sizeof *reader->places);
    reader->row = memory_array(CHANNEL_COLUMN + vertex->property_count, sizeof *reader->row);
    if (reader->places == NULL || reader->row == NULL)
        return mesh_builder_no_memory(&reader->builder, error);
    for (size_t i = 0; i < vertex->property_count; i++)
        reader->places[i] = (ply_place){NO_COLUMN, 1.0};
    for (size_t k = 0; k < 3; k++)
        if (!place_property(reader, vertex, coordinates[k], k))
            return ERROR_FILE(error, 0, "vertices have no property '%s'", coordinates[k]);
    if (!texture_by_corner)
        place_texture(reader, vertex);
    return place_channels(reader, vertex, error);
}

/// Find the properties of faces.
static bat_status plan_faces(ply_reader *reader, const ply_element *face, bat_error *error)
{
    size_t count = face->property_count;
    reader->corners_at = ply_property_find(face, "vertex_indices");
    if (reader->corners_at == count)
        reader->corners_at = ply_property_find(face, "vertex_index");
    if (reader->corners_at == count || !face->properties[reader->corners_at].list)
        return ERROR_FILE(error, 0, "faces have no list 'vertex_indices' or 'vertex_index'");
    if (face->properties[reader->corners_at].type >= PLY_FLOAT32)
        return ERROR_FILE(error, 0, "the indices of vertices must be whole numbers");
    reader->texture_at = ply_property_find(face, "texcoord");
    if (reader->texture_at < count && !face->properties[reader->texture_at].list)
        reader->texture_at = count;
    reader->label_at = reader->label_count > 0 ? ply_property_find(face, PLY_LABEL) : count;
    if (reader->label_at < count && face->properties[reader->label_at].list)
        reader->label_at = count;
    return BAT_OK;
}

/// Check the header and decide what to read.
static bat_status plan(ply_reader *reader, bat_error *error)
{
    const ply_element *vertex = ply_header_find(&reader->header, "vertex");
    const ply_element *face = ply_header_find(&reader->header, "face");
    bool bare = reader->builder.faceless && (face == NULL || face->count == 0);
    if (vertex == NULL || (face == NULL && !bare))
        return ERROR_FILE(error, 0, "the header has no element '%s'", vertex == NULL ? "vertex" : "face");
    bat_status status = bare ? BAT_OK : plan_faces(reader, face, error);
    if (status != BAT_OK)
        return status;
    if (vertex->count >= BAT_MESH_NONE)
        return ERROR_TOO_LARGE(error, "the file has more than %zu vertices", (size_t)BAT_MESH_NONE);
    reader->vertices = vertex->count;
    return place_columns(reader, vertex, !bare && reader->texture_at < face->property_count, error);
}

static bat_status store_vertex(ply_reader *reader, bat_error *error)
{
    mesh_builder *builder = &reader->builder;
    double *position = mesh_builder_vertex(builder);
    double *texture = reader->textured ? mesh_builder_texture(builder) : NULL;
    double *channels = builder->mesh.channel_count > 0 ? mesh_builder_channels(builder) : NULL;
    if (position == NULL || (reader->textured && texture == NULL) || (builder->mesh.channel_count > 0 && channels == NULL))
        return mesh_builder_no_memory(&reader->builder, error);
    memcpy(position, reader->row, 3 * sizeof *position);
    if (texture != NULL)
        memcpy(texture, reader->row + TEXTURE_COLUMN, 2 * sizeof *texture);
    if (channels != NULL)
        memcpy(channels, reader->row + CHANNEL_COLUMN, builder->mesh.channel_count * sizeof *channels);
    return BAT_OK;
}

static bat_status read_vertices(ply_reader *reader, const ply_element *element, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t row = 0; row < element->count && status == BAT_OK; row++)
    {
        status = begin_row(reader, element, row, error);
        for (size_t i = 0; i < element->property_count && status == BAT_OK; i++)
        {
            const ply_property *property = &element->properties[i];
            const ply_place *place = &reader->places[i];
            double value;
            if (place->column == NO_COLUMN)
                status = skip_property(reader, element, row, property, error);
            else if (lenient_number(reader, property->type, &value))
                reader->row[place->column] = value / place->scale;
            else
                status = number_fault(reader, element, row, property, error);
        }
        if (status == BAT_OK)
            status = end_row(reader, row, error);
        if (status == BAT_OK)
            status = store_vertex(reader, error);
    }
    return status;
}

/// Read the corners of a face into reader->face.
static bat_status read_corners(ply_reader *reader, const ply_element *element, size_t row, size_t *size, bat_error *error)
{
    const ply_property *property = &element->properties[reader->corners_at];
    if (!read_length(&reader->source, property, size))
        return number_fault(reader, element, row, property, error);
    for (size_t i = 0; i < *size; i++)
    {
        double vertex;
        if (!ply_number(&reader->source, property->type, &vertex))
            return number_fault(reader, element, row, property, error);
        if (!(vertex >= 0 && vertex < (double)reader->vertices))
            return error_set(error, BAT_BAD_FILE, row, line_of(reader), "face %zu names vertex %.0f, but there are %zu", row,
                             vertex, reader->vertices);
        if (!ARRAY_GROW(reader->face, reader->face_capacity, i + 1))
            return mesh_builder_no_memory(&reader->builder, error);
        reader->face[i] = (uint32_t)vertex;
    }
    return BAT_OK;
}

/// Read the texture coordinates of a face's corners, or an empty list, and add the corners.
static bat_status read_texture(ply_reader *reader, const ply_element *element, size_t row, word_scan place, size_t size,
                               bat_error *error)
{
    const ply_property *property = &element->properties[reader->texture_at];
    word_scan after = reader->source.scan;
    size_t length;
    reader->source.scan = place;
    if (!read_length(&reader->source, property, &length))
        return number_fault(reader, element, row, property, error);
    if (length != 0 && length != 2 * size)
        return error_set(error, BAT_BAD_FILE, row, line_of(reader), "face %zu has %zu corners, but %zu texture numbers", row,
                         size, length);
    for (size_t i = 0; i < size; i++)
    {
        double texture[2];
        uint32_t number = BAT_MESH_NONE;
        for (int k = 0; k < 2 && length > 0; k++)
            if (!ply_number(&reader->source, property->type, &texture[k]))
                return number_fault(reader, element, row, property, error);
        if (length > 0)
            number = mesh_builder_merge_texture(&reader->builder, reader->face[i], texture[0], texture[1]);
        if ((length > 0 && number == BAT_MESH_NONE) || !mesh_builder_corner(&reader->builder, reader->face[i], number))
            return mesh_builder_no_memory(&reader->builder, error);
    }
    reader->source.scan = after;
    return BAT_OK;
}

/// Read the label of a face.
static bat_status read_label(ply_reader *reader, const ply_element *element, size_t row, bat_error *error)
{
    const ply_property *property = &element->properties[reader->label_at];
    double value;
    if (!ply_number(&reader->source, property->type, &value))
        return number_fault(reader, element, row, property, error);
    if (!(value >= 0 && value < (double)reader->label_count))
        return error_set(error, BAT_BAD_FILE, row, line_of(reader), "face %zu has label %g, but there are %zu", row, value,
                         reader->label_count);
    reader->builder.label = reader->labels[(size_t)value];
    reader->builder.labelled = true;
    return BAT_OK;
}

static bat_status read_face(ply_reader *reader, const ply_element *element, size_t row, bat_error *error)
{
    size_t size = 0;
    word_scan texture_place = {0};
    bat_status status = begin_row(reader, element, row, error);
    for (size_t i = 0; i < element->property_count && status == BAT_OK; i++)
    {
        if (i == reader->texture_at)
            texture_place = reader->source.scan;
        if (i == reader->corners_at)
            status = read_corners(reader, element, row, &size, error);
        else if (i == reader->label_at)
            status = read_label(reader, element, row, error);
        else
            status = skip_property(reader, element, row, &element->properties[i], error);
    }
    if (status == BAT_OK)
        status = end_row(reader, row, error);
    if (status != BAT_OK)
        return status;
    if (reader->texture_at < element->property_count)
        status = read_texture(reader, element, row, texture_place, size, error);
    else
        for (size_t i = 0; i < size && status == BAT_OK; i++)
            if (!mesh_builder_corner(&reader->builder, reader->face[i], reader->textured ? reader->face[i] : BAT_MESH_NONE))
                status = mesh_builder_no_memory(&reader->builder, error);
    if (status == BAT_OK && !mesh_builder_end_face(&reader->builder, (uint32_t)size))
        status = mesh_builder_no_memory(&reader->builder, error);
    return status;
}

static bat_status read_faces(ply_reader *reader, const ply_element *element, bat_error *error)
{
    reader->first_face = reader->source.scan;
    bat_status status = BAT_OK;
    for (size_t row = 0; row < element->count && status == BAT_OK; row++)
        status = read_face(reader, element, row, error);
    return status;
}

/// The minimal number of bytes in a row of an element.
static size_t min_size(const ply_element *element, ply_encoding encoding)
{
    size_t size = 0;
    for (size_t i = 0; i < element->property_count; i++)
    {
        const ply_property *property = &element->properties[i];
        size += encoding == PLY_TEXT ? 2 : ply_type_size(property->list ? property->count_type : property->type);
    }
    return size;
}

static bat_status read_element(ply_reader *reader, const ply_element *element, bat_error *error)
{
    char kind[EXCERPT_SIZE];
    size_t left = (size_t)(reader->source.scan.end - reader->source.scan.at) + 1,
           row = min_size(element, reader->source.encoding);
    if (row > 0 && element->count > left / row)
        return ERROR_FILE(error, 0, "the file is too short for its %zu elements '%s'", element->count,
                          text_excerpt(kind, element->name.begin, element->name.begin + element->name.size));
    bool vertex = label_name_is(element->name, "vertex"), face = label_name_is(element->name, "face");
    if ((vertex && !mesh_builder_reserve(&reader->builder, element->count, 0)) ||
        (face && !mesh_builder_reserve(&reader->builder, 0, element->count)))
        return mesh_builder_no_memory(&reader->builder, error);
    if (vertex)
        return read_vertices(reader, element, error);
    return face ? read_faces(reader, element, error) : skip_element(reader, element, error);
}

static bat_status read_all(ply_reader *reader, bat_error *error)
{
    const char *begin = reader->source.scan.at;
    bat_status status = ply_header_read(&reader->source.scan, &reader->header, error);
    reader->source.encoding = reader->header.encoding;
    if (status == BAT_OK)
        status = ply_labels_read(begin, (size_t)(reader->source.scan.at - begin), &reader->builder, &reader->labels,
                                 &reader->label_count, error);
    if (status == BAT_OK)
        status = plan(reader, error);
    for (size_t i = 0; i < reader->header.element_count && status == BAT_OK; i++)
        status = read_element(reader, &reader->header.elements[i], error);
    if (status != BAT_OK)
        return status;
    if (reader->source.encoding == PLY_TEXT ? scan_next_content(&reader->source.scan)
                                            : reader->source.scan.at < reader->source.scan.end)
        return ERROR_FILE(error, line_of(reader), "there is data after the last element");
    return BAT_OK;
}

/// The line of a face in a text file, by counting lines with content.
static size_t line_of_face(const ply_reader *reader, size_t face)
{
    word_scan scan = reader->first_face;
    while (scan_next_content(&scan) && face-- > 0)
        (void)scan_next_line(&scan);
    return scan.line;
}

/// Note what is in the file but not in the mesh.
static bat_status note_losses(const ply_reader *reader, bat_mesh_notes *notes, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < reader->header.element_count && status == BAT_OK; i++)
    {
        const ply_element *element = &reader->header.elements[i];
        char name[EXCERPT_SIZE];
        (void)text_excerpt(name, element->name.begin, element->name.begin + element->name.size);
        if (label_name_is(element->name, "vertex"))
            status = ply_property_find(element, "nx") < element->property_count
                         ? mesh_note(notes, error, MESH_NORMALS_LEFT_OUT, element->count)
                         : BAT_OK;
        else if (!label_name_is(element->name, "face") && element->count > 0)
            status =
                mesh_note(notes, error, "%zu elements '%s' are left out: a mesh does not hold them", element->count, name);
        for (size_t k = 0; k < element->property_count && status == BAT_OK && label_name_is(element->name, "face"); k++)
        {
            const ply_property *property = &element->properties[k];
            (void)text_excerpt(name, property->name.begin, property->name.begin + property->name.size);
            if (k != reader->corners_at && k != reader->texture_at && k != reader->label_at)
                status = mesh_note(notes, error, "the property '%s' of faces is left out: a mesh does not hold it", name);
        }
    }
    return status;
}

static bat_status read_ply(const file_text *text, const bat_mesh_read_options *options, bool faceless, bat_mesh *mesh,
                           bat_error *error)
{
    ply_reader reader = {.builder.faceless = faceless,
                         .source.scan = word_scan_start(text->data, text->size),
                         .lenient = options->repair || !options->strict};
    bat_status status = read_all(&reader, error);
    if (status == BAT_OK)
        status = note_losses(&reader, options->notes, error);
    if (status == BAT_OK)
    {
        status = mesh_builder_finish(&reader.builder, options, mesh, error);
        if (status != BAT_OK && reader.source.encoding == PLY_TEXT && error != NULL && error->index != BAT_NO_INDEX)
            error->line = line_of_face(&reader, error->index);
    }
    ply_header_free(&reader.header);
    mesh_builder_free(&reader.builder);
    free(reader.places);
    free(reader.row);
    free(reader.labels);
    free(reader.face);
    return status;
}

bat_status mesh_ply_read(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    return read_ply(text, options, false, mesh, error);
}

bat_status mesh_ply_read_points(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh,
                                bat_error *error)
{
    return read_ply(text, options, true, mesh, error);
}
