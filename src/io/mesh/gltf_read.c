#include "io/mesh/gltf.h"

#include "io/mesh/builder.h"
#include "linalg/vector.h"

/// @file
/// Reader of glTF 2.0: the triangles of all meshes of a scene, in the scene's coordinates.
///
/// glTF repeats a vertex for each of its normals and texture coordinates. Within the meshes of one node, vertices at equal
/// positions become one again; texture coordinates stay at the corners.

/// The counts of what is left out or changed, for notes.
typedef struct gltf_tally
{
    size_t normals, vertices, joined, recoloured, degenerate, other_primitives, morphed, further;
} gltf_tally;

typedef struct gltf_reader
{
    gltf_document document;
    mesh_builder builder;
    const bat_mesh_read_options *options;
    size_t placed; ///< vertices of the primitives of all instances before
    char **materials;
    size_t material_count;
    size_t colours;    ///< numbers of a colour: 0, 3 or 4
    size_t colourless; ///< primitives without colours, where others have some
    gltf_tally tally;
} gltf_reader;

/// A primitive of an instance during reading.
typedef struct gltf_primitive
{
    gltf_place place;
    const gltf_instance *instance;
    gltf_values positions, texture, colours, indices; ///< null numbers: none
    uint32_t *vertices; ///< for each vertex of the primitive: that of the builder, or BAT_MESH_NONE before its first use
    uint32_t *textures;
    bool flipped; ///< the transform mirrors: corners go around the other way
    bool strip;   ///< degenerate triangles are part of strips and no fault
} gltf_primitive;

// Primitives

/// Read the accessor that a member names, if there is one.
static bat_status read_attribute(gltf_reader *reader, const json_t *object, const char *key, const gltf_wish *wish,
                                 gltf_place place, gltf_values *values, bat_error *error)
{
    size_t index = SIZE_MAX;
    bat_status status = gltf_size(object, key, place, &index, error);
    return status == BAT_OK && index != SIZE_MAX ? gltf_values_read(&reader->document, index, wish, values, error) : status;
}

/// Read the numbers of a primitive.
static bat_status read_values(gltf_reader *reader, const json_t *object, gltf_primitive *primitive, bat_error *error)
{
    static const gltf_wish point = {3, 3, false}, pair = {2, 2, false}, colour = {3, 4, false}, index = {1, 1, true};
    const json_t *attributes = json_object_get(object, "attributes");
    gltf_place place = primitive->place;
    bat_status status = read_attribute(reader, attributes, "POSITION", &point, place, &primitive->positions, error);
    if (status == BAT_OK && primitive->positions.numbers == NULL)
        status = gltf_fault(place, error, "a primitive has no 'POSITION'");
    if (status == BAT_OK)
        status = read_attribute(reader, attributes, "TEXCOORD_0", &pair, place, &primitive->texture, error);
    if (status == BAT_OK)
        status = read_attribute(reader, attributes, "COLOR_0", &colour, place, &primitive->colours, error);
    if (status == BAT_OK)
        status = read_attribute(reader, object, "indices", &index, place, &primitive->indices, error);
    size_t count = primitive->positions.count;
    if (status == BAT_OK && ((primitive->texture.numbers != NULL && primitive->texture.count != count) ||
                             (primitive->colours.numbers != NULL && primitive->colours.count != count)))
        status = gltf_fault(place, error, "the attributes of a primitive differ in their counts");
    for (size_t i = 0; i < primitive->indices.count && status == BAT_OK; i++)
        if (primitive->indices.numbers[i] >= (double)count)
            status = gltf_fault(place, error, "index %zu names vertex %.0f of %zu", i, primitive->indices.numbers[i], count);
    return status;
}

/// Find or add the builder's vertex of a primitive's vertex.
static bat_status find_vertex(gltf_reader *reader, gltf_primitive *primitive, size_t local, uint32_t *vertex,
                              bat_error *error)
{
    mesh_builder *builder = &reader->builder;
    double image[3], colour[4] = {0};
    *vertex = primitive->vertices[local];
    if (*vertex != BAT_MESH_NONE)
        return BAT_OK;
    const double *point = primitive->positions.numbers + 3 * local, *m = primitive->instance->matrix;
    for (int i = 0; i < 3; i++)
        image[i] = m[4 * i] * point[0] + m[4 * i + 1] * point[1] + m[4 * i + 2] * point[2] + m[4 * i + 3];
    if (!isfinite(image[0]) || !isfinite(image[1]) || !isfinite(image[2]))
        return gltf_fault(primitive->place, error, "a vertex is not finite in the scene");
    const gltf_values *colours = &primitive->colours;
    for (size_t k = 0; k < reader->colours; k++) // white and opaque where the primitive has none
        colour[k] = k < colours->components ? colours->numbers[local * colours->components + k] : 1.0;
    reader->tally.vertices++;
    if (builder->mesh.vertex_count >= BAT_MESH_NONE - 1)
        return ERROR_TOO_LARGE(error, "the scene has more than %zu vertices", (size_t)BAT_MESH_NONE - 1);
    size_t before = builder->mesh.vertex_count;
    *vertex = primitive->vertices[local] = mesh_builder_merge(builder, image);
    double *channels = reader->colours > 0 && builder->mesh.vertex_count > before ? mesh_builder_channels(builder) : NULL;
    if (*vertex == BAT_MESH_NONE || (channels == NULL && reader->colours > 0 && *vertex == before))
        return mesh_builder_no_memory(&reader->builder, error);
    if (channels != NULL)
        memcpy(channels, colour, reader->colours * sizeof *channels);
    else if (reader->colours > 0)
        reader->tally.recoloured +=
            memcmp(builder->mesh.channels + *vertex * reader->colours, colour, reader->colours * sizeof *colour) != 0;
    reader->tally.joined += *vertex < before;
    return BAT_OK;
}

/// Find or add the texture coordinate of a vertex. In glTF, v counts downwards.
static bat_status find_texture(gltf_reader *reader, gltf_primitive *primitive, size_t local, uint32_t vertex,
                               uint32_t *texture, bat_error *error)
{
    *texture = primitive->texture.numbers != NULL ? primitive->textures[local] : BAT_MESH_NONE;
    if (*texture != BAT_MESH_NONE || primitive->texture.numbers == NULL)
        return BAT_OK;
    const double *given = primitive->texture.numbers + 2 * local;
    *texture = mesh_builder_merge_texture(&reader->builder, vertex, given[0], 1 - given[1]);
    if (*texture == BAT_MESH_NONE)
        return mesh_builder_no_memory(&reader->builder, error);
    primitive->textures[local] = *texture;
    return BAT_OK;
}

/// Add a triangle of three places in the primitive's indices.
static bat_status add_triangle(gltf_reader *reader, gltf_primitive *primitive, const size_t places[3], bat_error *error)
{
    uint32_t vertices[3], textures[3];
    for (int c = 0; c < 3; c++)
    {
        size_t place = places[primitive->flipped ? 2 - c : c];
        size_t local = primitive->indices.numbers != NULL ? (size_t)primitive->indices.numbers[place] : place;
        bat_status status = find_vertex(reader, primitive, local, &vertices[c], error);
        if (status == BAT_OK)
            status = find_texture(reader, primitive, local, vertices[c], &textures[c], error);
        if (status != BAT_OK)
            return status;
    }
    bool degenerate = vertices[0] == vertices[1] || vertices[1] == vertices[2] || vertices[2] == vertices[0];
    if (degenerate && (primitive->strip || !reader->options->keep_degenerate))
    {
        reader->tally.degenerate += !primitive->strip;
        return BAT_OK;
    }
    for (int c = 0; c < 3; c++)
        if (!mesh_builder_corner(&reader->builder, vertices[c], textures[c]))
            return mesh_builder_no_memory(&reader->builder, error);
    return mesh_builder_end_face(&reader->builder, 3) ? BAT_OK : mesh_builder_no_memory(&reader->builder, error);
}

static bat_status add_triangles(gltf_reader *reader, gltf_primitive *primitive, size_t mode, bat_error *error)
{
    size_t count = primitive->indices.numbers != NULL ? primitive->indices.count : primitive->positions.count;
    if (count < 3 || (mode == GLTF_TRIANGLES && count % 3 != 0))
        return gltf_fault(primitive->place, error, "%zu indices form no triangles", count);
    bat_status status = BAT_OK;
    size_t step = mode == GLTF_TRIANGLES ? 3 : 1;
    for (size_t i = 0; i + 2 < count && status == BAT_OK; i += step)
    {
        size_t odd = mode == GLTF_STRIP ? i % 2 : 0;
        const size_t places[3] = {mode == GLTF_FAN ? 0 : i, i + 1 + odd, i + 2 - odd};
        status = add_triangle(reader, primitive, places, error);
    }
    return status;
}

/// A name of a file's object; null for an empty or missing one.
static label_name name_of(const json_t *object, const char *key)
{
    const json_t *name = json_object_get(object, key);
    return json_string_length(name) > 0 ? (label_name){json_string_value(name), json_string_length(name)} : (label_name){0};
}

/// Set the label of a primitive. `extras` of batten's own files tell what glTF has no place for.
static bat_status set_label(gltf_reader *reader, const gltf_instance *instance, const json_t *mesh, const json_t *primitive,
                            gltf_place place, bat_error *error)
{
    const json_t *extras = json_object_get(primitive, "extras");
    const json_t *node = json_array_get(json_object_get(reader->document.root, "nodes"), instance->node);
    label_name object = name_of(extras, "object"), group = name_of(extras, "group"), material = {0};
    size_t number = SIZE_MAX;
    bat_status status = gltf_size(primitive, "material", place, &number, error);
    if (status == BAT_OK && number != SIZE_MAX && number >= reader->material_count)
        status = gltf_fault(place, error, "a primitive has material %zu, but there are %zu", number, reader->material_count);
    if (status != BAT_OK)
        return status;
    if (number != SIZE_MAX)
        material = label_name_of(reader->materials[number]);
    if (object.begin == NULL)
        object = name_of(node, "name");
    if (group.begin == NULL)
        group = name_of(mesh, "name");
    if (group.begin != NULL && object.begin != NULL && strcmp(group.begin, object.begin) == 0)
        group = (label_name){0};
    const label_name names[MESH_LABEL_NAMES] = {object, group, material, name_of(extras, "smoothing")};
    bool named = false;
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
        named = named || names[k].begin != NULL;
    return (!named && !reader->builder.labelled) || mesh_builder_label(&reader->builder, names)
               ? BAT_OK
               : mesh_builder_no_memory(&reader->builder, error);
}

/// Count what a primitive has beside the first texture coordinates and colours.
static void count_others(gltf_reader *reader, const json_t *object, size_t vertices)
{
    const char *key;
    json_t *value, *attributes = json_object_get(object, "attributes");
    reader->tally.morphed += json_array_size(json_object_get(object, "targets")) > 0;
    json_object_foreach(attributes, key, value)
    {
        if (strcmp(key, "NORMAL") == 0)
            reader->tally.normals += vertices;
        else if (strcmp(key, "POSITION") != 0 && strcmp(key, "TEXCOORD_0") != 0 && strcmp(key, "COLOR_0") != 0 &&
                 strcmp(key, "TANGENT") != 0 && strncmp(key, "JOINTS_", 7) != 0 && strncmp(key, "WEIGHTS_", 8) != 0)
            reader->tally.further++;
    }
}

/// Whether the numbers of a primitive exist only in compressed form.
static bool is_compressed(const gltf_reader *reader, const json_t *object)
{
    const json_t *extension = json_object_get(json_object_get(object, "extensions"), "KHR_draco_mesh_compression");
    const json_t *position = json_object_get(json_object_get(object, "attributes"), "POSITION");
    const json_t *accessor = json_array_get(json_object_get(reader->document.root, "accessors"),
                                            json_is_integer(position) ? (size_t)json_integer_value(position) : SIZE_MAX);
    return extension != NULL && json_object_get(accessor, "bufferView") == NULL;
}

static bat_status read_primitive(gltf_reader *reader, const gltf_instance *instance, const json_t *mesh,
                                 const json_t *object, bat_error *error)
{
    const double *m = instance->matrix;
    gltf_primitive primitive = {
        .place = {"mesh", instance->mesh}, .instance = instance, .flipped = vector3_determinant(m, m + 4, m + 8) < 0};
    size_t mode = GLTF_TRIANGLES;
    if (!json_is_object(object))
        return gltf_fault(primitive.place, error, "a primitive is no object");
    bat_status status = gltf_size(object, "mode", primitive.place, &mode, error);
    if (status == BAT_OK && mode > GLTF_FAN)
        status = gltf_fault(primitive.place, error, "a primitive has the mode %zu", mode);
    if (status == BAT_OK && mode < GLTF_TRIANGLES)
    {
        reader->tally.other_primitives++;
        return BAT_OK;
    }
    if (status == BAT_OK && is_compressed(reader, object))
        status = ERROR_UNSUPPORTED(
            error, 0, "mesh %zu is compressed by Draco (KHR_draco_mesh_compression), which is not read", instance->mesh);
    if (status == BAT_OK)
        status = set_label(reader, instance, mesh, object, primitive.place, error);
    if (status == BAT_OK)
        status = read_values(reader, object, &primitive, error);
    if (status == BAT_OK)
    {
        reader->placed += primitive.positions.count;
        status = file_text_points(reader->document.text, reader->document.total_size, reader->placed, error);
    }
    if (status == BAT_OK)
    {
        size_t count = primitive.positions.count;
        primitive.strip = mode == GLTF_STRIP;
        primitive.vertices = memory_array(count, sizeof *primitive.vertices);
        primitive.textures = memory_array(count, sizeof *primitive.textures);
        if (primitive.vertices == NULL || primitive.textures == NULL)
            status = mesh_builder_no_memory(&reader->builder, error);
        else
        {
            memset(primitive.vertices, 0xff, count * sizeof *primitive.vertices);
            memset(primitive.textures, 0xff, count * sizeof *primitive.textures);
            count_others(reader, object, count);
            reader->colourless += reader->colours > 0 && primitive.colours.numbers == NULL;
            status = add_triangles(reader, &primitive, mode, error);
        }
    }
    gltf_values_free(&primitive.positions);
    gltf_values_free(&primitive.texture);
    gltf_values_free(&primitive.colours);
    gltf_values_free(&primitive.indices);
    free(primitive.vertices);
    free(primitive.textures);
    return status;
}

// The scene

static bat_status primitives_of(const gltf_reader *reader, size_t index, json_t **mesh, const json_t **primitives,
                                bat_error *error)
{
    bat_status status = gltf_element(&reader->document, "meshes", "mesh", index, mesh, error);
    return status == BAT_OK ? gltf_array(*mesh, "primitives", (gltf_place){"mesh", index}, primitives, error) : status;
}

/// Decide whether vertices have colours, and of how many numbers.
static bat_status plan_colours(gltf_reader *reader, const gltf_instance *instances, size_t count, bat_error *error)
{
    const json_t *accessors = json_object_get(reader->document.root, "accessors"), *primitives;
    json_t *mesh;
    for (size_t i = 0; i < count; i++)
    {
        bat_status status = primitives_of(reader, instances[i].mesh, &mesh, &primitives, error);
        if (status != BAT_OK)
            return status;
        for (size_t k = 0; k < json_array_size(primitives) && reader->colours < MESH_COLOURS; k++)
        {
            const json_t *attributes = json_object_get(json_array_get(primitives, k), "attributes");
            const json_t *number = json_object_get(attributes, "COLOR_0");
            double index = json_is_number(number) ? json_number_value(number) : -1;
            if (!(index >= 0 && index < (double)json_array_size(accessors)))
                continue;
            const char *type = json_string_value(json_object_get(json_array_get(accessors, (size_t)index), "type"));
            reader->colours = type != NULL && strcmp(type, "VEC4") == 0 ? MESH_COLOURS : MESH_COLOURS - 1;
        }
    }
    return reader->colours == 0 || channels_set_names(&reader->builder.mesh, mesh_colour_names, reader->colours)
               ? BAT_OK
               : mesh_builder_no_memory(&reader->builder, error);
}

/// Note what was left out or changed.
static bat_status note_all(const gltf_reader *reader, bat_error *error)
{
    const gltf_tally *tally = &reader->tally;
    const struct
    {
        size_t count;
        const char *text;
    } counted[] = {
        {tally->joined, "%zu vertices that differ from another one only in normal, texture or colour are joined to it"},
        {tally->recoloured, "%zu joined vertices had another colour, which is left out"},
        {tally->degenerate, "%zu triangles whose corners coincide are left out"},
        {tally->other_primitives, "%zu primitives of points or lines are left out"},
        {tally->morphed, "the morph targets of %zu primitives are left out"},
        {tally->further, "%zu attributes are left out: only the first texture coordinates and colours are read"},
        {reader->colourless, "%zu primitives without colours are white"},
        {tally->normals, MESH_NORMALS_LEFT_OUT},
        {json_array_size(json_object_get(reader->document.root, "animations")), "%zu animations are left out"},
    };
    bat_status status = BAT_OK;
    for (size_t i = 0; i < sizeof counted / sizeof *counted && status == BAT_OK; i++)
    {
        char text[BAT_ERROR_TEXT_SIZE];
        const char *rest = strstr(counted[i].text, "%zu") + strlen("%zu");
        (void)snprintf(text, sizeof text, "%.*s%zu%s", (int)(rest - counted[i].text - 3), counted[i].text, counted[i].count,
                       rest);
        if (counted[i].count > 0)
            status = mesh_note(reader->options->notes, error, "%s", text);
    }
    return status;
}

static bat_status read_scene(gltf_reader *reader, bat_error *error)
{
    gltf_instance *instances = NULL;
    size_t count = 0;
    bat_mesh_notes *notes = reader->options->notes;
    label_name files = name_of(json_object_get(reader->document.root, "extras"), "material_files");
    bat_status status = gltf_instances_find(&reader->document, &instances, &count, notes, error);
    if (status == BAT_OK)
        status = gltf_materials_read(&reader->document, &reader->materials, &reader->material_count,
                                     &reader->builder.mesh.material_json, notes, error);
    if (status == BAT_OK && files.begin != NULL && (reader->builder.mesh.material_files = label_name_copy(files)) == NULL)
        status = mesh_builder_no_memory(&reader->builder, error);
    if (status == BAT_OK)
        status = plan_colours(reader, instances, count, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        json_t *mesh = NULL;
        const json_t *primitives = NULL;
        status = primitives_of(reader, instances[i].mesh, &mesh, &primitives, error);
        point_table_free(&reader->builder.points);
        for (size_t k = 0; k < json_array_size(primitives) && status == BAT_OK; k++)
            status = read_primitive(reader, &instances[i], mesh, json_array_get(primitives, k), error);
    }
    free(instances);
    if (status == BAT_OK && reader->builder.mesh.face_count == 0 && count == 0)
        status = ERROR_FILE(error, 0, "the scene has no meshes");
    if (status == BAT_OK && reader->builder.mesh.face_count == 0 && reader->tally.other_primitives > 0)
        status = ERROR_UNSUPPORTED(error, 0, "the meshes have points or lines, but no triangles");
    return status == BAT_OK ? note_all(reader, error) : status;
}

bat_status mesh_gltf_read(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    gltf_reader reader = {.options = options};
    bat_status status = gltf_open(text, &reader.document, error);
    if (status == BAT_OK)
        status = read_scene(&reader, error);
    if (status == BAT_OK)
        status = mesh_builder_finish(&reader.builder, options, mesh, error);
    for (size_t i = 0; i < reader.material_count; i++)
        free(reader.materials[i]);
    free(reader.materials);
    mesh_builder_free(&reader.builder);
    gltf_close(&reader.document);
    return status;
}
