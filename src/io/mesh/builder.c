#include "io/mesh/builder.h"

#include "base/error.h"
#include "mesh/polygon/polygon.h"
#include "mesh/triangulate.h"

#include <string.h>

/// @file
/// Arrays that grow while a mesh is read, and their conversion to a checked triangle mesh.

void mesh_builder_free(mesh_builder *builder)
{
    free(builder->positions);
    free(builder->texture);
    free(builder->channels);
    for (size_t i = 0; i < builder->channel_count && builder->channel_names != NULL; i++)
        free(builder->channel_names[i]);
    free(builder->channel_names);
    free(builder->corners);
    free(builder->texture_corners);
    free(builder->sizes);
    free(builder->creases);
    free(builder->marks);
    label_table_free(&builder->labels);
    free(builder->face_labels);
    free(builder->material_files);
    free(builder->material_json);
    *builder = (mesh_builder){0};
}

/// Call array_grow() for a pointer of any type.
static bool grow(void *place, size_t *capacity, size_t needed, size_t size)
{
    if (needed <= *capacity)
        return true;
    void *array;
    memcpy(&array, place, sizeof array);
    bool grown = array_grow(&array, capacity, needed, size);
    memcpy(place, &array, sizeof array);
    return grown;
}

#define GROW(array, capacity, needed) grow((void *)&(array), &(capacity), (needed), sizeof *(array))

double *mesh_builder_vertex(mesh_builder *builder)
{
    size_t begin = 3 * builder->vertex_count;
    if (!GROW(builder->positions, builder->position_capacity, begin + 3))
        return NULL;
    builder->vertex_count++;
    return builder->positions + begin;
}

double *mesh_builder_texture(mesh_builder *builder)
{
    size_t begin = 2 * builder->texture_count;
    if (!GROW(builder->texture, builder->texture_capacity, begin + 2))
        return NULL;
    builder->texture_count++;
    return builder->texture + begin;
}

double *mesh_builder_channels(mesh_builder *builder)
{
    size_t end = builder->vertex_count * builder->channel_count;
    if (!GROW(builder->channels, builder->channel_capacity, end))
        return NULL;
    return builder->channels + end - builder->channel_count;
}

bool mesh_builder_name_channels(mesh_builder *builder, const char *const *names, size_t count)
{
    builder->channel_names = calloc(count + 1, sizeof *builder->channel_names);
    if (builder->channel_names == NULL)
        return false;
    builder->channel_count = count;
    for (size_t i = 0; i < count; i++)
    {
        builder->channel_names[i] = strdup(names[i]);
        if (builder->channel_names[i] == NULL)
            return false;
    }
    return true;
}

bool mesh_builder_reserve(mesh_builder *builder, size_t vertices, size_t triangles)
{
    size_t numbers, values, corners;
    return !size_multiply_overflows(vertices, 3, &numbers) && !size_multiply_overflows(triangles, 3, &corners) &&
           !size_multiply_overflows(vertices, builder->channel_count, &values) &&
           GROW(builder->positions, builder->position_capacity, numbers) &&
           GROW(builder->channels, builder->channel_capacity, values) &&
           GROW(builder->corners, builder->corner_capacity, corners) &&
           GROW(builder->sizes, builder->size_capacity, triangles);
}

/// Store the texture coordinate of a corner. The first one allocates the array; earlier corners have none.
static bool add_texture_corner(mesh_builder *builder, uint32_t texture)
{
    bool first = builder->texture_corner_capacity == 0;
    if (first && texture == BAT_MESH_NONE)
        return true;
    size_t at = builder->corner_count;
    if (!GROW(builder->texture_corners, builder->texture_corner_capacity, at + 1))
        return false;
    if (first)
        memset(builder->texture_corners, 0xff, at * sizeof *builder->texture_corners);
    builder->texture_corners[at] = texture;
    return true;
}

bool mesh_builder_corner(mesh_builder *builder, uint32_t vertex, uint32_t texture)
{
    if (!GROW(builder->corners, builder->corner_capacity, builder->corner_count + 1) ||
        !add_texture_corner(builder, texture))
        return false;
    builder->corners[builder->corner_count++] = vertex;
    return true;
}

bool mesh_builder_label(mesh_builder *builder, const label_name names[MESH_LABEL_NAMES])
{
    static const label_name none[MESH_LABEL_NAMES] = {{0}};
    size_t faces = builder->face_count;
    if (!builder->labelled && faces > 0)
    {
        uint32_t nameless = label_table_add(&builder->labels, none);
        if (nameless == BAT_MESH_NONE || !GROW(builder->face_labels, builder->face_label_capacity, faces))
            return false;
        memset(builder->face_labels, 0, faces * sizeof *builder->face_labels); // the first label is that without names
    }
    builder->labelled = true;
    builder->label = label_table_add(&builder->labels, names);
    return builder->label != BAT_MESH_NONE;
}

/// Store the label of the current face.
static bool add_face_label(mesh_builder *builder)
{
    if (!builder->labelled)
        return true;
    if (!GROW(builder->face_labels, builder->face_label_capacity, builder->face_count + 1))
        return false;
    builder->face_labels[builder->face_count] = builder->label;
    return true;
}

bool mesh_builder_end_face(mesh_builder *builder, uint32_t size)
{
    if (!GROW(builder->sizes, builder->size_capacity, builder->face_count + 1) || !add_face_label(builder))
        return false;
    builder->sizes[builder->face_count++] = size;
    return true;
}

bool mesh_builder_crease(mesh_builder *builder, bat_mesh_crease crease)
{
    if (!GROW(builder->creases, builder->crease_capacity, builder->crease_count + 1))
        return false;
    builder->creases[builder->crease_count++] = crease;
    return true;
}

bool mesh_builder_mark(mesh_builder *builder, bat_mesh_corner mark)
{
    if (!GROW(builder->marks, builder->mark_capacity, builder->mark_count + 1))
        return false;
    builder->marks[builder->mark_count++] = mark;
    return true;
}

/// Check that every face has three corners or may be triangulated, and that its indices are valid.
static bat_status check_faces(const mesh_builder *builder, bool triangulate, bat_error *error)
{
    size_t begin = 0;
    for (size_t f = 0; f < builder->face_count; f++)
    {
        size_t size = builder->sizes[f];
        if (size < 3)
            return error_set(error, BAT_BAD_FILE, f, 0, "face %zu has %zu corners, fewer than 3", f, size);
        if (size > 3 && !triangulate)
            return error_remedy(error, error_set(error, BAT_BAD_FILE, f, 0, "face %zu has %zu corners", f, size),
                                "triangulate", "cuts it into triangles");
        for (size_t i = begin; i < begin + size; i++)
        {
            if (builder->corners[i] >= builder->vertex_count)
                return error_set(error, BAT_BAD_FILE, f, 0, "face %zu names vertex %u, counted from 0, but there are %zu", f,
                                 builder->corners[i], builder->vertex_count);
            if (builder->texture_corners != NULL && builder->texture_corners[i] >= builder->texture_count &&
                builder->texture_corners[i] != BAT_MESH_NONE)
                return error_set(error, BAT_BAD_FILE, f, 0,
                                 "face %zu names texture coordinate %u, counted from 0, but there are %zu", f,
                                 builder->texture_corners[i], builder->texture_count);
        }
        begin += size;
    }
    return BAT_OK;
}

/// Assign the texture coordinate (0, 0) to corners without one, if other corners have one.
static bool complete_texture(mesh_builder *builder)
{
    if (builder->texture_corners == NULL)
        return true;
    uint32_t origin = BAT_MESH_NONE;
    for (size_t i = 0; i < builder->corner_count; i++)
    {
        if (builder->texture_corners[i] != BAT_MESH_NONE)
            continue;
        if (origin == BAT_MESH_NONE)
        {
            origin = (uint32_t)builder->texture_count;
            double *zero = mesh_builder_texture(builder);
            if (zero == NULL)
                return false;
            zero[0] = zero[1] = 0.0;
        }
        builder->texture_corners[i] = origin;
    }
    return true;
}

/// The triangles of the polygons: their corners and texture corners.
typedef struct triangle_cutter
{
    const mesh_builder *builder;
    uint32_t *faces, *texture_faces;
    uint32_t *places; ///< the corner numbers of one polygon's triangles
    polygon_workspace room;
} triangle_cutter;

/// Triangulate the polygon whose corners begin at `begin`, into the triangles from `triangle` on.
static bat_status cut_polygon(triangle_cutter *cutter, size_t face, size_t begin, size_t triangle, bat_error *error)
{
    const mesh_builder *builder = cutter->builder;
    size_t size = builder->sizes[face];
    bat_status status =
        polygon_triangulate(builder->positions, builder->corners + begin, size, cutter->places, &cutter->room);
    if (status == BAT_TOO_LARGE)
        return error_set(error, status, face, 0, "face %zu is not convex and has %zu corners, more than %d", face, size,
                         POLYGON_MAX_EARS);
    if (status != BAT_OK)
        return error_memory(error, 3 * size * sizeof(uint32_t));
    for (size_t i = 0; i < 3 * (size - 2); i++)
    {
        size_t corner = begin + cutter->places[i];
        cutter->faces[3 * triangle + i] = builder->corners[corner];
        if (cutter->texture_faces != NULL)
            cutter->texture_faces[3 * triangle + i] = builder->texture_corners[corner];
    }
    return BAT_OK;
}

static bat_status cut_all(triangle_cutter *cutter, bat_error *error)
{
    bat_status status = BAT_OK;
    size_t begin = 0, triangle = 0;
    for (size_t f = 0; f < cutter->builder->face_count && status == BAT_OK; f++)
    {
        size_t size = cutter->builder->sizes[f];
        status = cut_polygon(cutter, f, begin, triangle, error);
        begin += size;
        triangle += size - 2;
    }
    return status;
}

/// Give every triangle the label of its polygon.
static bat_status cut_labels(mesh_builder *builder, size_t triangle_count, bat_error *error)
{
    if (!builder->labelled)
        return BAT_OK;
    uint32_t *labels = memory_array(triangle_count, sizeof *labels);
    if (labels == NULL)
        return error_memory(error, triangle_count * sizeof *labels);
    size_t triangle = 0;
    for (size_t f = 0; f < builder->face_count; f++)
        for (size_t i = 2; i < builder->sizes[f]; i++)
            labels[triangle++] = builder->face_labels[f];
    free(builder->face_labels);
    builder->face_labels = labels;
    return BAT_OK;
}

/// Replace the polygons by `triangle_count` triangles. `sizes` still holds the sizes of the polygons.
static bat_status cut_polygons(mesh_builder *builder, size_t triangle_count, bat_error *error)
{
    uint32_t largest = 0;
    for (size_t f = 0; f < builder->face_count; f++)
        largest = builder->sizes[f] > largest ? builder->sizes[f] : largest;
    size_t corners = 3 * triangle_count;
    bool textured = builder->texture_corners != NULL;
    triangle_cutter cutter = {.builder = builder,
                              .faces = memory_array(corners, sizeof *cutter.faces),
                              .texture_faces = textured ? memory_array(corners, sizeof *cutter.texture_faces) : NULL,
                              .places = memory_array(3 * (size_t)largest, sizeof *cutter.places)};
    bat_status status = BAT_OK;
    if (cutter.faces == NULL || cutter.places == NULL || (textured && cutter.texture_faces == NULL))
        status = error_memory(error, corners * sizeof *cutter.faces);
    if (status == BAT_OK)
        status = cut_all(&cutter, error);
    free(cutter.places);
    polygon_workspace_free(&cutter.room);
    if (status != BAT_OK)
    {
        free(cutter.faces);
        free(cutter.texture_faces);
        return status;
    }
    free(builder->corners);
    free(builder->texture_corners);
    builder->corners = cutter.faces;
    builder->texture_corners = cutter.texture_faces;
    builder->corner_count = corners;
    return BAT_OK;
}

/// Check that no triangle has a vertex twice. The error names the polygon in the file.
static bat_status check_triangles(const mesh_builder *builder, bat_error *error)
{
    const uint32_t *corner = builder->corners;
    for (size_t f = 0; f < builder->face_count; f++)
        for (size_t i = 2; i < builder->sizes[f]; i++, corner += 3)
            if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
                return error_remedy(error,
                                    error_set(error, BAT_BAD_FILE, f, 0, "face %zu has vertex %u, counted from 0, twice", f,
                                              corner[0] == corner[1] ? corner[0] : corner[2]),
                                    "repair", "drops the face");
    return BAT_OK;
}

static bat_status prepare(mesh_builder *builder, const bat_mesh_read_options *options, bat_error *error)
{
    if (builder->face_count == 0 && !builder->faceless)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "there are no faces");
    bat_status status = check_faces(builder, options->triangulate || options->polygons != NULL, error);
    size_t triangle_count = builder->corner_count - 2 * builder->face_count;
    if (status == BAT_OK && (triangle_count > BAT_MESH_MAX_FACES || builder->vertex_count >= BAT_MESH_NONE))
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the mesh has more than %zu faces or %zu vertices",
                         BAT_MESH_MAX_FACES, (size_t)BAT_MESH_NONE);
    if (status == BAT_OK && !complete_texture(builder))
        status = error_memory(error, builder->texture_capacity * sizeof(double));
    if (options->polygons != NULL)
        return status;
    if (status == BAT_OK && triangle_count > builder->face_count)
    {
        status = cut_polygons(builder, triangle_count, error);
        if (status == BAT_OK)
            status = cut_labels(builder, triangle_count, error);
    }
    if (status == BAT_OK && !options->keep_degenerate)
        status = check_triangles(builder, error);
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

/// The mesh of a builder's arrays, with all corners in its lists of faces. The builder is empty afterwards.
static bat_mesh take_arrays(mesh_builder *builder, size_t face_count)
{
    bool textured = builder->texture_corners != NULL;
    size_t corners = builder->corner_count, vertices = builder->vertex_count;
    size_t texture_count = textured ? builder->texture_count : 0;
    bat_mesh mesh = {
        .positions = trim(builder->positions, 3 * vertices, sizeof(double)),
        .faces = trim(builder->corners, corners, sizeof(uint32_t)),
        .vertex_count = vertices,
        .face_count = face_count,
        .texture = trim(builder->texture, 2 * texture_count, sizeof(double)),
        .texture_faces = trim(builder->texture_corners, textured ? corners : 0, sizeof(uint32_t)),
        .texture_count = texture_count,
        .channels = trim(builder->channels, vertices * builder->channel_count, sizeof(double)),
        .channel_names = builder->channel_count > 0 ? builder->channel_names : NULL,
        .channel_count = builder->channel_count,
        .creases = trim(builder->creases, builder->crease_count, sizeof *builder->creases),
        .crease_count = builder->crease_count,
        .corners = trim(builder->marks, builder->mark_count, sizeof *builder->marks),
        .corner_count = builder->mark_count,
        .face_labels = trim(builder->face_labels, builder->labelled ? face_count : 0, sizeof *builder->face_labels),
        .labels = builder->labels.labels,
        .label_count = builder->labels.count,
        .material_files = builder->material_files,
        .material_json = builder->material_json,
        .rules = builder->rules,
    };
    free(builder->labels.slots);
    free(builder->sizes);
    if (builder->channel_count == 0)
        free(builder->channel_names);
    *builder = (mesh_builder){0};
    return mesh;
}

/// Give a builder's polygons to a mesh of polygons and check it.
static bat_status finish_polygons(mesh_builder *builder, bat_polygon_mesh *polygons, bat_error *error)
{
    size_t count = builder->face_count;
    uint32_t *offsets = memory_array(count + 1, sizeof *offsets);
    if (offsets == NULL)
    {
        mesh_builder_free(builder);
        return error_memory(error, (count + 1) * sizeof *offsets);
    }
    offsets[0] = 0;
    for (size_t f = 0; f < count; f++)
        offsets[f + 1] = offsets[f] + builder->sizes[f];
    bat_mesh view = take_arrays(builder, count);
    bat_polygon_mesh made = polygon_mesh_from_view(&view, offsets);
    bat_status status = count > 0 ? bat_polygon_mesh_check(&made, error) : BAT_OK;
    if (status == BAT_OK)
    {
        *polygons = made;
        return BAT_OK;
    }
    bat_polygon_mesh_free(&made);
    if (error != NULL && status == BAT_INVALID_POINT)
        error->status = BAT_BAD_FILE;
    return status == BAT_INVALID_POINT ? BAT_BAD_FILE : status;
}

bat_status mesh_builder_finish(mesh_builder *builder, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    bat_status status = prepare(builder, options, error);
    if (status != BAT_OK)
    {
        mesh_builder_free(builder);
        return status;
    }
    if (options->polygons != NULL)
        return finish_polygons(builder, options->polygons, error);
    *mesh = take_arrays(builder, builder->corner_count / 3);
    return BAT_OK;
}
