#include "io/mesh/builder.h"

#include "linalg/vector.h"
#include "mesh/check.h"

/// @file
/// Arrays that grow while a mesh is read, and their conversion to a checked triangle mesh.

void mesh_builder_free(mesh_builder *builder)
{
    label_table_free(&builder->labels);
    point_table_free(&builder->points);
    point_table_free(&builder->texture_table);
    free(builder->texture_keys);
    bat_mesh_free(&builder->mesh);
    *builder = (mesh_builder){0};
}

double *mesh_builder_vertex(mesh_builder *builder)
{
    size_t begin = 3 * builder->mesh.vertex_count;
    if (!ARRAY_GROW(builder->mesh.positions, builder->position_capacity, begin + 3))
        return NULL;
    builder->mesh.vertex_count++;
    return builder->mesh.positions + begin;
}

double *mesh_builder_texture(mesh_builder *builder)
{
    size_t begin = 2 * builder->mesh.texture_count;
    if (!ARRAY_GROW(builder->mesh.texture, builder->texture_capacity, begin + 2))
        return NULL;
    builder->mesh.texture_count++;
    return builder->mesh.texture + begin;
}

double *mesh_builder_channels(mesh_builder *builder)
{
    size_t end = builder->mesh.vertex_count * builder->mesh.channel_count;
    if (!ARRAY_GROW(builder->mesh.channels, builder->channel_capacity, end))
        return NULL;
    return builder->mesh.channels + end - builder->mesh.channel_count;
}

uint32_t mesh_builder_merge(mesh_builder *builder, const double position[3])
{
    builder->points.points = builder->mesh.positions;
    uint32_t found = point_table_find(&builder->points, position), added = (uint32_t)builder->mesh.vertex_count;
    if (found != BAT_MESH_NONE)
        return found;
    double *made = builder->mesh.vertex_count < BAT_MESH_NONE - 1 ? mesh_builder_vertex(builder) : NULL;
    if (made == NULL)
        return BAT_MESH_NONE;
    memcpy(made, position, 3 * sizeof *made);
    builder->points.points = builder->mesh.positions;
    return point_table_add(&builder->points, added) ? added : BAT_MESH_NONE;
}

uint32_t mesh_builder_merge_texture(mesh_builder *builder, uint32_t vertex, double u, double v)
{
    const double key[3] = {vertex, u, v};
    uint32_t found = point_table_find(&builder->texture_table, key);
    size_t count = builder->mesh.texture_count;
    if (found != BAT_MESH_NONE)
        return found;
    double *made = count < BAT_MESH_NONE - 1 ? mesh_builder_texture(builder) : NULL;
    if (made == NULL || !ARRAY_GROW(builder->texture_keys, builder->texture_key_capacity, 3 * count + 3))
        return BAT_MESH_NONE;
    memcpy(builder->texture_keys + 3 * count, key, sizeof key);
    memcpy(made, key + 1, 2 * sizeof *made);
    builder->texture_table.points = builder->texture_keys;
    return point_table_add(&builder->texture_table, (uint32_t)count) ? (uint32_t)count : BAT_MESH_NONE;
}

bool mesh_builder_reserve(mesh_builder *builder, size_t vertices, size_t triangles)
{
    size_t numbers, values, corners;
    return !size_multiply_overflows(vertices, 3, &numbers) && !size_multiply_overflows(triangles, 3, &corners) &&
           !size_multiply_overflows(vertices, builder->mesh.channel_count, &values) &&
           ARRAY_GROW(builder->mesh.positions, builder->position_capacity, numbers) &&
           ARRAY_GROW(builder->mesh.channels, builder->channel_capacity, values) &&
           ARRAY_GROW(builder->mesh.faces, builder->corner_capacity, corners) &&
           ARRAY_GROW(builder->mesh.offsets, builder->offset_capacity, triangles);
}

/// Store the texture coordinate of a corner. The first one allocates the array; earlier corners have none.
static bool add_texture_corner(mesh_builder *builder, uint32_t texture)
{
    bool first = builder->texture_corner_capacity == 0;
    if (first && texture == BAT_MESH_NONE)
        return true;
    size_t at = builder->corner_count;
    if (!ARRAY_GROW(builder->mesh.texture_faces, builder->texture_corner_capacity, at + 1))
        return false;
    if (first)
        memset(builder->mesh.texture_faces, 0xff, at * sizeof *builder->mesh.texture_faces);
    builder->mesh.texture_faces[at] = texture;
    return true;
}

bool mesh_builder_corner(mesh_builder *builder, uint32_t vertex, uint32_t texture)
{
    return add_texture_corner(builder, texture) &&
           ARRAY_ADD(builder->mesh.faces, builder->corner_capacity, builder->corner_count, vertex);
}

bool mesh_builder_label(mesh_builder *builder, const label_name names[MESH_LABEL_NAMES])
{
    static const label_name none[MESH_LABEL_NAMES] = {{0}};
    size_t faces = builder->mesh.face_count;
    if (!builder->labelled && faces > 0)
    {
        uint32_t nameless = label_table_add(&builder->labels, none);
        if (nameless == BAT_MESH_NONE || !ARRAY_GROW(builder->mesh.face_labels, builder->face_label_capacity, faces))
            return false;
        memset(builder->mesh.face_labels, 0,
               faces * sizeof *builder->mesh.face_labels); // the first label is that without names
    }
    builder->labelled = true;
    builder->label = label_table_add(&builder->labels, names);
    return builder->label != BAT_MESH_NONE;
}

bool mesh_builder_end_face(mesh_builder *builder, uint32_t size)
{
    size_t face = builder->mesh.face_count;
    if (!ARRAY_GROW(builder->mesh.offsets, builder->offset_capacity, face + 2) ||
        (builder->labelled && !ARRAY_GROW(builder->mesh.face_labels, builder->face_label_capacity, face + 1)))
        return false;
    if (builder->labelled)
        builder->mesh.face_labels[face] = builder->label;
    builder->mesh.offsets[0] = 0;
    builder->mesh.offsets[face + 1] = builder->mesh.offsets[face] + size;
    builder->mesh.face_count++;
    return true;
}

bool mesh_builder_crease(mesh_builder *builder, bat_mesh_crease crease)
{
    return ARRAY_ADD(builder->mesh.creases, builder->crease_capacity, builder->mesh.crease_count, crease);
}

bool mesh_builder_mark(mesh_builder *builder, bat_mesh_corner mark)
{
    return ARRAY_ADD(builder->mesh.corners, builder->mark_capacity, builder->mesh.corner_count, mark);
}

bat_status mesh_builder_no_memory(const mesh_builder *builder, bat_error *error)
{
    return error_memory(error, builder->position_capacity * sizeof(double));
}

/// Check that every face has three corners or may have more, and that its indices are valid.
static bat_status check_faces(const bat_mesh *mesh, bool polygons, bat_error *error)
{
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        uint32_t begin = mesh->offsets[f], end = mesh->offsets[f + 1], size = end - begin;
        if (size < 3)
            return error_set(error, BAT_BAD_FILE, f, 0, "face %zu has %u corners, fewer than 3", f, size);
        if (size > 3 && !polygons)
            return error_remedy(error, error_set(error, BAT_BAD_FILE, f, 0, "face %zu has %u corners", f, size),
                                "triangulate", "cuts it into triangles");
        for (uint32_t i = begin; i < end; i++)
        {
            if (mesh->faces[i] >= mesh->vertex_count)
                return error_set(error, BAT_BAD_FILE, f, 0, "face %zu names vertex %u, counted from 0, but there are %zu", f,
                                 mesh->faces[i], mesh->vertex_count);
            if (mesh->texture_faces != NULL && mesh->texture_faces[i] >= mesh->texture_count &&
                mesh->texture_faces[i] != BAT_MESH_NONE)
                return error_set(error, BAT_BAD_FILE, f, 0,
                                 "face %zu names texture coordinate %u, counted from 0, but there are %zu", f,
                                 mesh->texture_faces[i], mesh->texture_count);
        }
    }
    return BAT_OK;
}

/// Assign the texture coordinate (0, 0) to corners without one, if other corners have one.
static bool complete_texture(mesh_builder *builder)
{
    bat_mesh *mesh = &builder->mesh;
    uint32_t origin = BAT_MESH_NONE;
    for (size_t i = 0; mesh->texture_faces != NULL && i < builder->corner_count; i++)
    {
        if (mesh->texture_faces[i] != BAT_MESH_NONE)
            continue;
        if (origin == BAT_MESH_NONE)
        {
            origin = (uint32_t)mesh->texture_count;
            double *zero = mesh_builder_texture(builder);
            if (zero == NULL)
                return false;
            zero[0] = zero[1] = 0.0;
        }
        mesh->texture_faces[i] = origin;
    }
    return true;
}

/// Check that no triangle has a vertex twice. The error names the polygon in the file.
/// @param offsets of the polygons that were cut
static bat_status check_triangles(const bat_mesh *mesh, const uint32_t *offsets, bat_error *error)
{
    size_t made = 0;
    for (size_t f = 0; mesh->faces != NULL && made < mesh->face_count; f++)
        for (uint32_t i = offsets[f] + 2; i < offsets[f + 1]; i++, made++)
        {
            const uint32_t *corner = mesh->faces + 3 * made;
            if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
                return error_remedy(error,
                                    error_set(error, BAT_BAD_FILE, f, 0, "face %zu has vertex %u, counted from 0, twice", f,
                                              corner[0] == corner[1] ? corner[0] : corner[2]),
                                    "repair", "drops the face");
        }
    return BAT_OK;
}

/// Make the faces triangles.
static bat_status cut_faces(bat_mesh *mesh, bool degenerate, bat_error *error)
{
    uint32_t *offsets = mesh->offsets;
    if (offsets == NULL)
        return BAT_OK;
    bat_status status = BAT_OK;
    if (offsets[mesh->face_count] == 3 * mesh->face_count)
        mesh->offsets = NULL;
    else
        status = mesh_cut_polygons(mesh, &offsets, error);
    if (status != BAT_OK)
        return status;
    if (!degenerate)
        status = check_triangles(mesh, offsets, error);
    free(offsets);
    return status;
}

/// Check polygons. Where all are triangles, offsets go.
static bat_status keep_polygons(bat_mesh *mesh, bat_error *error)
{
    bat_status status = mesh->face_count > 0 ? bat_mesh_check(mesh, error) : BAT_OK;
    if (status == BAT_OK && mesh->face_count > 0 && mesh->offsets[mesh->face_count] == 3 * mesh->face_count)
    {
        free(mesh->offsets);
        mesh->offsets = NULL;
    }
    if (error != NULL && status == BAT_INVALID_POINT)
        error->status = BAT_BAD_FILE;
    return status == BAT_INVALID_POINT ? BAT_BAD_FILE : status;
}

static bat_status check_all(mesh_builder *builder, bool polygons, bat_error *error)
{
    const bat_mesh *mesh = &builder->mesh;
    if (mesh->face_count == 0 && !builder->faceless)
        return ERROR_FILE(error, 0, "there are no faces");
    bat_status status = check_faces(mesh, polygons, error);
    size_t triangle_count = builder->corner_count - 2 * mesh->face_count;
    if (status == BAT_OK && (triangle_count > BAT_MESH_MAX_FACES || mesh->vertex_count >= BAT_MESH_NONE))
        return ERROR_TOO_LARGE(error, "the mesh has more than %zu faces or %zu vertices", BAT_MESH_MAX_FACES,
                               (size_t)BAT_MESH_NONE);
    if (status == BAT_OK && !complete_texture(builder))
        status = error_memory(error, builder->texture_capacity * sizeof(double));
    return status;
}

/// Release unused memory of an array.
static void *trim(void *array, size_t count, size_t size)
{
    void *trimmed = count > 0 ? realloc(array, count * size) : NULL;
    if (count == 0)
        free(array);
    return trimmed != NULL || count == 0 ? trimmed : array;
}

/// The mesh of a builder, which is empty afterwards.
static bat_mesh take_mesh(mesh_builder *builder)
{
    bat_mesh mesh = builder->mesh;
    if (mesh.texture_faces == NULL)
        mesh.texture_count = 0;
    mesh.positions = trim(mesh.positions, 3 * mesh.vertex_count, sizeof *mesh.positions);
    mesh.texture = trim(mesh.texture, 2 * mesh.texture_count, sizeof *mesh.texture);
    mesh.channels = trim(mesh.channels, mesh.vertex_count * mesh.channel_count, sizeof *mesh.channels);
    mesh.creases = trim(mesh.creases, mesh.crease_count, sizeof *mesh.creases);
    mesh.corners = trim(mesh.corners, mesh.corner_count, sizeof *mesh.corners);
    size_t corners = builder->corner_count, labels = builder->labelled ? mesh.face_count : 0;
    mesh.faces = trim(mesh.faces, corners, sizeof *mesh.faces);
    mesh.texture_faces = trim(mesh.texture_faces, mesh.texture_faces != NULL ? corners : 0, sizeof *mesh.texture_faces);
    mesh.offsets = trim(mesh.offsets, mesh.face_count > 0 ? mesh.face_count + 1 : 0, sizeof *mesh.offsets);
    mesh.face_labels = trim(mesh.face_labels, labels, sizeof *mesh.face_labels);
    mesh.labels = builder->labels.labels;
    mesh.label_count = builder->labels.count;
    key_map_free(&builder->labels.numbers);
    point_table_free(&builder->points);
    point_table_free(&builder->texture_table);
    free(builder->texture_keys);
    if (mesh.channel_count == 0)
    {
        free(mesh.channel_names);
        mesh.channel_names = NULL;
    }
    *builder = (mesh_builder){0};
    return mesh;
}

// Numbers that are not finite.

/// Set numbers that are not finite to 0. Returns how many there were.
static size_t clear_numbers(double *numbers, size_t count)
{
    size_t cleared = 0;
    for (size_t i = 0; numbers != NULL && i < count; i++)
        if (!isfinite(numbers[i]))
        {
            numbers[i] = 0;
            cleared++;
        }
    return cleared;
}

static bool is_finite_at(const bat_mesh *mesh, size_t vertex)
{
    return vector_is_finite(3, mesh->positions + 3 * vertex);
}

/// Drop the faces with a vertex that is not finite.
static void drop_faces(bat_mesh *mesh)
{
    size_t faces = 0;
    uint32_t corners = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        uint32_t begin = mesh->offsets[f], end = mesh->offsets[f + 1];
        bool whole = true;
        for (uint32_t i = begin; i < end; i++)
            whole = whole && is_finite_at(mesh, mesh->faces[i]);
        for (uint32_t i = begin; i < end && whole; i++, corners++)
        {
            mesh->faces[corners] = mesh->faces[i];
            if (mesh->texture_faces != NULL)
                mesh->texture_faces[corners] = mesh->texture_faces[i];
        }
        if (!whole)
            continue;
        if (mesh->face_labels != NULL)
            mesh->face_labels[faces] = mesh->face_labels[f];
        mesh->offsets[++faces] = corners;
    }
    mesh->face_count = faces;
}

/// Drop the vertices that are not finite. No face has one.
/// @param number workspace: vertex_count
static void drop_vertices(bat_mesh *mesh, uint32_t *number)
{
    uint32_t kept = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        number[v] = is_finite_at(mesh, v) ? kept++ : BAT_MESH_NONE;
    for (size_t i = 0; mesh->face_count > 0 && i < mesh->offsets[mesh->face_count]; i++)
        mesh->faces[i] = number[mesh->faces[i]];
    mesh_renumber(mesh, kept, number);
}

/// Set values and texture coordinates that are not finite to 0, and drop such vertices. Vertices of faces are dropped by a
/// repair alone, with their faces.
static bat_status clean_numbers(bat_mesh *mesh, const bat_mesh_read_options *options, bat_error *error)
{
    size_t cleared = clear_numbers(mesh->channels, mesh->vertex_count * mesh->channel_count) +
                     clear_numbers(mesh->texture, 2 * mesh->texture_count),
           vertices = mesh->positions != NULL ? mesh->vertex_count : 0, faces = mesh->face_count,
           corners = mesh->offsets != NULL ? mesh->offsets[faces] : 0;
    bat_status status = BAT_OK;
    if (cleared > 0)
        status = mesh_note(options->notes, error, "%zu values that are not finite were set to 0", cleared);
    size_t bad = 0;
    for (size_t v = 0; v < vertices; v++)
        bad += !is_finite_at(mesh, v);
    if (bad == 0 || status != BAT_OK)
        return status;
    for (size_t i = 0; i < corners && !options->repair; i++)
        if (!is_finite_at(mesh, mesh->faces[i]))
            return error_remedy(error, ERROR_FILE(error, 0, "vertex %u, counted from 0, is not finite", mesh->faces[i]),
                                "repair", "drops it and its faces");
    uint32_t *number = memory_array(vertices, sizeof *number);
    if (number == NULL)
        return error_memory(error, vertices * sizeof *number);
    drop_faces(mesh);
    drop_vertices(mesh, number);
    free(number);
    if (faces > 0 && mesh->face_count == 0)
        return ERROR_FILE(error, 0, "every face has a vertex that is not finite");
    return mesh_note(options->notes, error, "%zu vertices that are not finite were dropped, with %zu faces", bad,
                     faces - mesh->face_count);
}

bat_status mesh_builder_finish(mesh_builder *builder, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    bool all_triangles = builder->corner_count == 3 * builder->mesh.face_count;
    bool keep =
        options->polygons && !options->triangulate && !options->repair && !(all_triangles && options->keep_degenerate);
    size_t given = builder->mesh.face_count;
    bat_status status = check_all(builder, options->triangulate || keep || !options->strict, error);
    if (status != BAT_OK)
    {
        mesh_builder_free(builder);
        return status;
    }
    bat_mesh made = take_mesh(builder);
    status = clean_numbers(&made, options, error);
    if (status == BAT_OK)
        status = keep ? keep_polygons(&made, error) : cut_faces(&made, options->keep_degenerate, error);
    if (status == BAT_OK && !keep && !options->triangulate && made.face_count > given)
        status = mesh_note(options->notes, error, "polygons were cut into %zu triangles", made.face_count);
    if (status == BAT_OK)
        *mesh = made;
    else
        bat_mesh_free(&made);
    return status;
}
