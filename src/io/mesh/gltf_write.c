#include "base/counting_sort.h"
#include "batten/mesh_transfer.h"
#include "io/common/base64.h"
#include "io/common/bytes.h"
#include "io/mesh/formats.h"
#include "io/mesh/gltf.h"
#include "linalg/vector.h"

/// @file
/// Writer of glTF 2.0: a node for each object, a primitive for each label, one buffer.
///
/// A vertex is written once for each of its texture coordinates. The primitives of a node share the vertices of the node, so
/// that groups and materials do not cut the mesh.

enum
{
    AXES = 3,
    WORD = 4, ///< bytes of an index, and of a number
    TARGET_VERTICES = 34962,
    TARGET_INDICES = 34963
};

/// The parts of the buffer, in their order.
typedef enum gltf_part
{
    PART_INDICES,
    PART_POSITIONS,
    PART_NORMALS,
    PART_TANGENTS,
    PART_TEXTURE,
    PART_COLOURS,
    PART_COUNT
} gltf_part;

typedef struct gltf_writer
{
    memory_pool pool; ///< holds the arrays
    const bat_mesh *mesh;
    const bat_mesh_write_options *options;
    size_t colour_places[MESH_COLOURS], colours;
    bool byte_colours;  ///< all colours are multiples of 1/255
    double shift[AXES]; ///< subtracted from all positions, the translation of all nodes

    size_t label_count;    ///< at least 1
    size_t node_count;     ///< at least 1
    uint32_t *node_of;     ///< for each label
    label_table objects;   ///< of the nodes; without labels, or where objects share vertices, there is one node
    bool one_node;         ///< objects share vertices: `extras` name them
    uint32_t *label_order; ///< the labels, ordered by their nodes
    uint32_t *label_place; ///< of each label in `label_order`
    size_t *label_faces;   ///< label_count + 1: where the faces of label_order[i] begin in `faces`
    uint32_t *faces;       ///< the faces, ordered by node and label

    uint32_t *corners;      ///< face_count x 3, in the order of `faces`: written vertices
    uint32_t *origins;      ///< for each written vertex: its vertex of the mesh
    uint32_t *sources;      ///< for each written vertex: a corner of the mesh
    double *tangents;       ///< of the corners; null for none
    uint32_t *textures;     ///< for each written vertex: its texture coordinate
    uint32_t *next;         ///< for each written vertex: the next one of the same vertex of the mesh, or BAT_MESH_NONE
    size_t vertex_count;    ///< of written vertices
    size_t vertex_capacity; ///< 3 x face_count at most
    size_t *node_vertices;  ///< node_count + 1: where the vertices of a node begin
    size_t begins[PART_COUNT + 1];

    json_t *root;
    text_buffer bytes;
    size_t first_view; ///< the number of the mesh's first buffer view
} gltf_writer;

static void writer_free(gltf_writer *writer)
{
    free(writer->tangents);
    memory_pool_free(&writer->pool);
    label_table_free(&writer->objects);
    json_decref(writer->root);
    text_free(&writer->bytes);
}

static bat_status no_memory(const gltf_writer *writer, bat_error *error)
{
    return error_memory(error, writer->mesh->face_count * 3 * sizeof(double));
}

static uint32_t label_of(const gltf_writer *writer, size_t face)
{
    return writer->mesh->face_labels != NULL ? writer->mesh->face_labels[face] : 0;
}

// Order

/// Whether faces of two nodes have a vertex in common.
static bool nodes_touch(const gltf_writer *writer, uint32_t *owner)
{
    const bat_mesh *mesh = writer->mesh;
    memset(owner, 0xff, mesh->vertex_count * sizeof *owner);
    for (size_t h = 0; h < 3 * mesh->face_count; h++)
    {
        uint32_t node = writer->node_of[label_of(writer, h / 3)], *known = &owner[mesh->faces[h]];
        if (*known != BAT_MESH_NONE && *known != node)
            return true;
        *known = node;
    }
    return false;
}

/// Assign the labels to nodes.
static bool find_nodes(gltf_writer *writer)
{
    const bat_mesh *mesh = writer->mesh;
    writer->label_count = mesh->face_labels != NULL ? mesh->label_count : 1;
    writer->node_of = memory_pool_array(&writer->pool, writer->label_count, sizeof *writer->node_of);
    uint32_t *owner = memory_array(mesh->vertex_count, sizeof *owner);
    bool room = writer->pool.missing == 0 && owner != NULL;
    for (size_t i = 0; i < writer->label_count && room; i++)
    {
        const char *object = mesh->face_labels != NULL ? mesh->labels[i].object : NULL;
        const label_name names[MESH_LABEL_NAMES] = {label_name_of(object)};
        writer->node_of[i] = label_table_add(&writer->objects, names);
        room = writer->node_of[i] != BAT_MESH_NONE;
    }
    if (room)
    {
        writer->one_node = nodes_touch(writer, owner);
        writer->node_count = writer->one_node ? 1 : writer->objects.count;
        if (writer->one_node)
            memset(writer->node_of, 0, writer->label_count * sizeof *writer->node_of);
    }
    free(owner);
    return room;
}

static size_t node_of_label(const void *context, uint32_t label)
{
    return ((const gltf_writer *)context)->node_of[label];
}

static size_t place_of_face(const void *context, uint32_t face)
{
    const gltf_writer *writer = context;
    return writer->label_place[label_of(writer, face)];
}

/// Order the labels by node, and the faces by label.
static bool order_faces(gltf_writer *writer)
{
    size_t labels = writer->label_count, faces = writer->mesh->face_count;
    size_t *starts = memory_pool_array(&writer->pool, writer->node_count + 1, sizeof *starts);
    writer->label_order = memory_pool_array(&writer->pool, labels, sizeof *writer->label_order);
    writer->label_place = memory_pool_array(&writer->pool, labels, sizeof *writer->label_place);
    writer->label_faces = memory_pool_array(&writer->pool, labels + 1, sizeof *writer->label_faces);
    writer->faces = memory_pool_array(&writer->pool, faces, sizeof *writer->faces);
    if (writer->pool.missing > 0)
        return false;
    counting_sort(NULL, labels, node_of_label, writer, writer->node_count, starts, writer->label_order);
    for (size_t i = 0; i < labels; i++)
        writer->label_place[writer->label_order[i]] = (uint32_t)i;
    counting_sort(NULL, faces, place_of_face, writer, labels, writer->label_faces, writer->faces);
    return true;
}

/// Number the written vertices: pairs of a vertex and a texture coordinate, in the order of the faces.
static bool number_vertices(gltf_writer *writer)
{
    const bat_mesh *mesh = writer->mesh;
    size_t corners = 3 * mesh->face_count, label = 0;
    uint32_t *first = memory_array(mesh->vertex_count, sizeof *first);
    writer->corners = memory_pool_array(&writer->pool, corners, sizeof *writer->corners);
    writer->origins = memory_pool_array(&writer->pool, corners, sizeof *writer->origins);
    writer->sources = memory_pool_array(&writer->pool, corners, sizeof *writer->sources);
    writer->textures = memory_pool_array(&writer->pool, corners, sizeof *writer->textures);
    writer->next = memory_pool_array(&writer->pool, corners, sizeof *writer->next);
    writer->node_vertices = memory_pool_zeros(&writer->pool, writer->node_count + 1, sizeof *writer->node_vertices);
    bool room = first != NULL && writer->pool.missing == 0;
    if (room)
        memset(first, 0xff, mesh->vertex_count * sizeof *first);
    for (size_t i = 0; i < corners && room; i++)
    {
        size_t h = 3 * (size_t)writer->faces[i / 3] + i % 3;
        uint32_t vertex = mesh->faces[h], texture = mesh->texture_faces != NULL ? mesh->texture_faces[h] : 0,
                 found = first[vertex];
        while (found != BAT_MESH_NONE && writer->textures[found] != texture)
            found = writer->next[found];
        if (found == BAT_MESH_NONE)
        {
            found = (uint32_t)writer->vertex_count++;
            writer->origins[found] = vertex;
            writer->sources[found] = (uint32_t)h;
            writer->textures[found] = texture;
            writer->next[found] = first[vertex];
            first[vertex] = found;
        }
        writer->corners[i] = found;
        while (i / 3 >= writer->label_faces[label + 1])
            label++;
        writer->node_vertices[writer->node_of[writer->label_order[label]] + 1] = writer->vertex_count;
    }
    for (size_t n = 0; n < writer->node_count && room; n++) // a node without faces
        if (writer->node_vertices[n + 1] < writer->node_vertices[n])
            writer->node_vertices[n + 1] = writer->node_vertices[n];
    free(first);
    return room;
}

// Bytes

static const double *position_of(const gltf_writer *writer, size_t written)
{
    return writer->mesh->positions + 3 * (size_t)writer->origins[written];
}

/// The position of a written vertex in its node, in single precision.
static float coordinate(const gltf_writer *writer, size_t written, size_t axis)
{
    return (float)(position_of(writer, written)[axis] - writer->shift[axis]);
}

static double colour(const gltf_writer *writer, size_t written, size_t k)
{
    const bat_mesh *mesh = writer->mesh;
    return mesh->channels[(size_t)writer->origins[written] * mesh->channel_count + writer->colour_places[k]];
}

/// Choose the translation: the middle of meshes far from the origin, whose digits single precision would lose.
static void choose_shift(gltf_writer *writer)
{
    static const double far = 4;
    double low[AXES], high[AXES];
    box_clear(AXES, low, high);
    for (size_t i = 0; i < writer->vertex_count; i++)
        box_include(AXES, position_of(writer, i), low, high);
    for (size_t k = 0; k < AXES; k++)
    {
        double middle = low[k] / 2 + high[k] / 2;
        writer->shift[k] = fabs(middle) > far * (high[k] - low[k]) ? middle : 0;
    }
}

static bool has_byte_colours(const gltf_writer *writer)
{
    for (size_t i = 0; i < writer->vertex_count; i++)
        for (size_t k = 0; k < writer->colours; k++)
        {
            double value = colour(writer, i, k);
            if (!(value >= 0 && value <= 1) || round(value * UINT8_MAX) / UINT8_MAX != value)
                return false;
        }
    return true;
}

/// The bytes of a written vertex in a part.
static size_t width_of(const gltf_writer *writer, gltf_part part)
{
    const size_t widths[PART_COUNT] = {
        [PART_POSITIONS] = AXES * WORD,
        [PART_NORMALS] = writer->options->vertex_normals != NULL ? AXES * WORD : 0,
        [PART_TANGENTS] = writer->tangents != NULL ? 4 * WORD : 0,
        [PART_TEXTURE] = writer->mesh->texture_faces != NULL ? 2 * WORD : 0,
        [PART_COLOURS] = writer->byte_colours ? WORD : writer->colours * WORD,
    };
    return widths[part];
}

static char *put_vertex(const gltf_writer *writer, gltf_part part, size_t i, char *out)
{
    const bat_mesh *mesh = writer->mesh;
    const double *normal = part == PART_NORMALS ? writer->options->vertex_normals + 3 * (size_t)writer->origins[i] : NULL;
    bool undefined = normal != NULL && normal[0] == 0 && normal[1] == 0 && normal[2] == 0;
    uint32_t bytes = 0;
    for (size_t k = 0; k < AXES && part == PART_POSITIONS; k++)
        out = bytes_put_float(out, (double)coordinate(writer, i, k));
    for (size_t k = 0; k < AXES && part == PART_NORMALS; k++)
        out = bytes_put_float(out, undefined ? k == 2 : normal[k]);
    for (size_t k = 0; k < 4 && part == PART_TANGENTS; k++)
        out = bytes_put_float(out, writer->tangents[4 * (size_t)writer->sources[i] + k]);
    for (size_t k = 0; k < 2 && part == PART_TEXTURE; k++)
    {
        double texture = mesh->texture[2 * (size_t)writer->textures[i] + k];
        out = bytes_put_float(out, k == 0 ? texture : 1 - texture);
    }
    for (size_t k = 0; k < writer->colours && part == PART_COLOURS; k++)
        if (writer->byte_colours)
            bytes |= (uint32_t)round(colour(writer, i, k) * UINT8_MAX) << 8 * k;
        else
            out = bytes_put_float(out, colour(writer, i, k));
    if (part == PART_COLOURS && writer->byte_colours)
        out = bytes_put(out, bytes, WORD, false);
    return out;
}

/// Write the indices, counted within each node, and the vertices.
static bat_status fill_bytes(gltf_writer *writer, bat_error *error)
{
    const bat_mesh *mesh = writer->mesh;
    size_t corners = 3 * mesh->face_count, label = 0, size = writer->bytes.size;
    for (gltf_part part = PART_INDICES; part < PART_COUNT; part++)
    {
        writer->begins[part] = size;
        size += part == PART_INDICES ? corners * WORD : writer->vertex_count * width_of(writer, part);
    }
    writer->begins[PART_COUNT] = size;
    char *out = size < UINT32_MAX ? text_reserve(&writer->bytes, size - writer->begins[0]) : NULL;
    if (out == NULL)
        return size < UINT32_MAX ? no_memory(writer, error)
                                 : ERROR_TOO_LARGE(error, "the mesh takes %zu bytes in glTF, more than GLB holds", size);
    for (size_t i = 0; i < corners; i++)
    {
        while (i / 3 >= writer->label_faces[label + 1])
            label++;
        size_t first = writer->node_vertices[writer->node_of[writer->label_order[label]]];
        out = bytes_put(out, writer->corners[i] - (uint32_t)first, WORD, false);
    }
    for (gltf_part part = PART_POSITIONS; part < PART_COUNT; part++)
        for (size_t i = 0; i < writer->vertex_count && width_of(writer, part) > 0; i++)
            out = put_vertex(writer, part, i, out);
    text_advance(&writer->bytes, out);
    return BAT_OK;
}

/// Check that single precision represents all numbers, and note what it rounds away.
static bat_status check_range(const gltf_writer *writer, bat_error *error)
{
    const bat_mesh *mesh = writer->mesh;
    size_t merged = 0;
    for (size_t i = 0; i < writer->vertex_count; i++)
    {
        bool good = true;
        for (size_t k = 0; k < AXES; k++)
            good = good && isfinite(coordinate(writer, i, k));
        for (size_t k = 0; k < 2 && mesh->texture_faces != NULL; k++)
            good = good && isfinite((float)mesh->texture[2 * (size_t)writer->textures[i] + k]);
        for (size_t k = 0; k < writer->colours; k++)
            good = good && isfinite((float)colour(writer, i, k));
        if (!good)
            return error_set(error, BAT_UNSUPPORTED, writer->origins[i], 0,
                             "glTF holds numbers in single precision, and one of vertex %u is too large",
                             writer->origins[i]);
    }
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
    {
        uint32_t a = writer->corners[i], b = writer->corners[i % 3 == 2 ? i - 2 : i + 1];
        merged += writer->origins[a] != writer->origins[b] && coordinate(writer, a, 0) == coordinate(writer, b, 0) &&
                  coordinate(writer, a, 1) == coordinate(writer, b, 1) &&
                  coordinate(writer, a, 2) == coordinate(writer, b, 2);
    }
    bat_status status = BAT_OK;
    if (merged > 0)
        status = mesh_note(writer->options->notes, error,
                           "glTF holds single precision, in which the ends of %zu edges of faces coincide", merged);
    size_t used = 0;
    for (size_t i = 0; i < writer->vertex_count; i++)
        used += writer->next[i] == BAT_MESH_NONE;
    if (status == BAT_OK && used < mesh->vertex_count)
        status = mesh_note(writer->options->notes, error, "the output lacks %zu vertices without a face: glTF has none",
                           mesh->vertex_count - used);
    return status;
}

// JSON

// Members and elements that are null are refused by jansson, so that each call passes on that memory lacked.

/// An object whose members were all set; else it is released, and null comes back.
static json_t *complete(json_t *object, bool set)
{
    if (set)
        return object;
    json_decref(object);
    return NULL;
}

/// Append an object to an array of the root. Returns its index, SIZE_MAX when out of memory.
static size_t add_to(const gltf_writer *writer, const char *array, json_t *object)
{
    json_t *list = json_object_get(writer->root, array);
    if (list == NULL)
    {
        list = json_array();
        if (json_object_set_new(writer->root, array, list) != 0)
        {
            json_decref(object);
            return SIZE_MAX;
        }
    }
    return json_array_append_new(list, object) == 0 ? json_array_size(list) - 1 : SIZE_MAX;
}

/// What add_to() returned as a number.
static json_t *index_json(size_t index)
{
    return index != SIZE_MAX ? json_integer((json_int_t)index) : NULL;
}

static json_t *text_json(const char *text)
{
    char *copy = label_name_copy(label_name_of(text));
    json_t *made = copy != NULL ? json_string(copy) : NULL;
    free(copy);
    return made;
}

static json_t *point_json(const double point[AXES])
{
    return json_pack("[f, f, f]", point[0], point[1], point[2]);
}

/// Add the accessor of `count` elements from element `first` on of a part. Returns its number, null when out of memory.
static json_t *add_accessor(const gltf_writer *writer, gltf_part part, size_t first, size_t count)
{
    static const char *const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const size_t components[PART_COUNT] = {1, 3, 3, 4, 2, writer->colours};
    int type = part == PART_INDICES ? GLTF_UINT32 : part == PART_COLOURS && writer->byte_colours ? GLTF_UINT8 : GLTF_FLOAT;
    size_t width = part == PART_INDICES ? WORD : width_of(writer, part), view = writer->first_view;
    for (gltf_part before = PART_INDICES; before < part; before++)
        view += writer->begins[before + 1] > writer->begins[before];
    json_t *accessor = json_pack("{s:I, s:I, s:i, s:I, s:s}", "bufferView", (json_int_t)view, "byteOffset",
                                 (json_int_t)first * (json_int_t)width, "componentType", type, "count", (json_int_t)count,
                                 "type", types[components[part] - 1]);
    bool set = type != GLTF_UINT8 || json_object_set_new(accessor, "normalized", json_true()) == 0;
    if (part == PART_POSITIONS)
    {
        double low[AXES], high[AXES], place[AXES];
        box_clear(AXES, low, high);
        for (size_t i = first; i < first + count; i++)
        {
            for (size_t k = 0; k < AXES; k++)
                place[k] = (double)coordinate(writer, i, k);
            box_include(AXES, place, low, high);
        }
        set = set && json_object_set_new(accessor, "min", point_json(low)) == 0 &&
              json_object_set_new(accessor, "max", point_json(high)) == 0;
    }
    return index_json(add_to(writer, "accessors", complete(accessor, set)));
}

static bool add_views(const gltf_writer *writer)
{
    for (gltf_part part = PART_INDICES; part < PART_COUNT; part++)
    {
        size_t size = writer->begins[part + 1] - writer->begins[part];
        if (size == 0)
            continue;
        json_t *view =
            json_pack("{s:i, s:I, s:I, s:i}", "buffer", 0, "byteOffset", (json_int_t)writer->begins[part], "byteLength",
                      (json_int_t)size, "target", part == PART_INDICES ? (int)TARGET_INDICES : (int)TARGET_VERTICES);
        bool set = part == PART_INDICES ||
                   json_object_set_new(view, "byteStride", json_integer((json_int_t)width_of(writer, part))) == 0;
        if (add_to(writer, "bufferViews", complete(view, set)) == SIZE_MAX)
            return false;
    }
    return true;
}

static bool collect_extensions(const json_t *value, json_t *used)
{
    const char *key;
    json_t *member;
    size_t index;
    bool room = true;
    json_t *object = (json_t *)(uintptr_t)value; // the iterators do not change it, but their parameters are not const
    json_object_foreach(object, key, member)
    {
        const char *name;
        json_t *extension;
        if (strcmp(key, "extensions") == 0)
            json_object_foreach(member, name, extension) room = room && json_object_set_new(used, name, json_null()) == 0;
        room = room && collect_extensions(member, used);
    }
    json_array_foreach(value, index, member) room = room && collect_extensions(member, used);
    return room;
}

/// Put the definitions of materials into the root.
static bat_status add_definitions(const gltf_writer *writer, bat_error *error)
{
    const char *text = writer->mesh->material_json, *key;
    json_t *definitions, *member, *used = json_object();
    if (text == NULL || used == NULL)
    {
        json_decref(used);
        return text == NULL ? BAT_OK : no_memory(writer, error);
    }
    bat_status status = json_parse(text, strlen(text), 0, 1, &definitions, error);
    if (status != BAT_OK)
    {
        json_decref(used);
        return status == BAT_NO_MEMORY ? status : error_option(error, "material_json", "is no JSON");
    }
    bool room = json_is_object(definitions) && collect_extensions(definitions, used);
    json_object_foreach(definitions, key, member)
    {
        if (json_array_size(member) > 0)
            room = room && json_object_set(writer->root, key, member) == 0;
    }
    json_object_foreach(used, key, member)
    {
        room = room && add_to(writer, "extensionsUsed", json_string(key)) != SIZE_MAX;
    }
    json_decref(definitions);
    json_decref(used);
    return room ? BAT_OK : no_memory(writer, error);
}

/// The number of the material of a name, which is added where there is none. Null when out of memory.
static json_t *find_material(const gltf_writer *writer, const char *name)
{
    json_t *materials = json_object_get(writer->root, "materials"), *material, *made = text_json(name);
    size_t index, found = SIZE_MAX;
    json_array_foreach(materials, index, material)
    {
        if (found == SIZE_MAX && json_equal(json_object_get(material, "name"), made))
            found = index;
    }
    if (found == SIZE_MAX)
        found = add_to(writer, "materials", json_pack("{s:O}", "name", made));
    json_decref(made);
    return index_json(found);
}

static bool set_text(json_t *object, const char *key, const char *text)
{
    return text == NULL || json_object_set_new(object, key, text_json(text)) == 0;
}

/// Set the material of a primitive, and as extras the names that glTF has no place for.
static bool set_names(const gltf_writer *writer, const bat_mesh_label *label, json_t *primitive)
{
    json_t *extras = json_object();
    bool room = extras != NULL && set_text(extras, "group", label->group) &&
                set_text(extras, "smoothing", label->smoothing) &&
                (!writer->one_node || set_text(extras, "object", label->object));
    if (room && label->material != NULL)
        room = json_object_set_new(primitive, "material", find_material(writer, label->material)) == 0;
    if (room && json_object_size(extras) > 0)
        room = json_object_set(primitive, "extras", extras) == 0;
    json_decref(extras);
    return room;
}

/// The attributes that the primitives of a node share.
static json_t *attributes_of(const gltf_writer *writer, size_t node)
{
    static const char *const names[PART_COUNT] = {NULL, "POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "COLOR_0"};
    size_t first = writer->node_vertices[node], count = writer->node_vertices[node + 1] - first;
    json_t *attributes = json_object();
    bool set = true;
    for (gltf_part part = PART_POSITIONS; part < PART_COUNT; part++)
        if (width_of(writer, part) > 0)
            set = set && json_object_set_new(attributes, names[part], add_accessor(writer, part, first, count)) == 0;
    return complete(attributes, set);
}

/// The primitives of a node: its labels that have faces. `*at` is the node's first place in label_order, then its end.
static json_t *primitives_of(const gltf_writer *writer, size_t node, size_t *at)
{
    json_t *attributes = attributes_of(writer, node), *list = json_array();
    bool room = attributes != NULL && list != NULL;
    for (; *at < writer->label_count && writer->node_of[writer->label_order[*at]] == node; ++*at)
    {
        size_t begin = writer->label_faces[*at], end = writer->label_faces[*at + 1];
        if (begin == end || !room)
            continue;
        json_t *primitive =
            json_pack("{s:O, s:o, s:i}", "attributes", attributes, "indices",
                      add_accessor(writer, PART_INDICES, 3 * begin, 3 * (end - begin)), "mode", GLTF_TRIANGLES);
        bool set = primitive != NULL && (writer->mesh->face_labels == NULL ||
                                         set_names(writer, &writer->mesh->labels[writer->label_order[*at]], primitive));
        room = json_array_append_new(list, complete(primitive, set)) == 0;
    }
    json_decref(attributes);
    return complete(list, room);
}

/// Add a node with its mesh to the scene.
static bool add_node(const gltf_writer *writer, size_t number, size_t *at, json_t *scene)
{
    size_t first = *at;
    if (writer->node_vertices[number] == writer->node_vertices[number + 1]) // no faces
    {
        while (*at < writer->label_count && writer->node_of[writer->label_order[*at]] == number)
            ++*at;
        return true;
    }
    json_t *primitives = primitives_of(writer, number, at);
    const char *name = writer->mesh->face_labels != NULL && !writer->one_node
                           ? writer->mesh->labels[writer->label_order[first]].object
                           : NULL;
    json_t *mesh = json_pack("{s:o}", "primitives", primitives);
    size_t index = add_to(writer, "meshes", complete(mesh, set_text(mesh, "name", name)));
    json_t *node = json_pack("{s:o}", "mesh", index_json(index));
    bool set = set_text(node, "name", name);
    if (writer->shift[0] != 0 || writer->shift[1] != 0 || writer->shift[2] != 0)
        set = set && json_object_set_new(node, "translation", point_json(writer->shift)) == 0;
    index = add_to(writer, "nodes", complete(node, set));
    return json_array_append_new(scene, index_json(index)) == 0;
}

/// Begin the JSON of the file.
static bat_status begin_json(gltf_writer *writer, bat_error *error)
{
    const char *files = writer->mesh->material_files;
    char generator[32];
    (void)snprintf(generator, sizeof generator, "batten %s", bat_version());
    writer->root = json_pack("{s:{s:s, s:s}, s:i}", "asset", "version", "2.0", "generator", generator, "scene", 0);
    bat_status status = writer->root != NULL ? add_definitions(writer, error) : no_memory(writer, error);
    if (status != BAT_OK || files == NULL)
        return status;
    json_t *extras = json_object();
    bool set = set_text(extras, "material_files", files);
    return json_object_set_new(writer->root, "extras", complete(extras, set)) == 0 ? BAT_OK : no_memory(writer, error);
}

/// Append the mesh to the bytes and the JSON; `nodes` receives the numbers of its nodes.
static bat_status append_mesh(gltf_writer *writer, json_t *nodes, bat_error *error)
{
    size_t at = 0;
    writer->colours = mesh_colours(writer->mesh, writer->colour_places);
    if (!find_nodes(writer) || !order_faces(writer) || !number_vertices(writer))
        return no_memory(writer, error);
    choose_shift(writer);
    writer->byte_colours = writer->colours > 0 && has_byte_colours(writer);
    bat_status status = check_range(writer, error);
    if (status == BAT_OK && writer->options->tangents && writer->options->vertex_normals != NULL &&
        writer->mesh->texture_faces != NULL)
        status = bat_mesh_tangents(writer->mesh, writer->options->vertex_normals, &writer->tangents, error);
    if (status == BAT_OK)
        status = fill_bytes(writer, error);
    if (status == BAT_OK && writer->root == NULL)
        status = begin_json(writer, error);
    writer->first_view = json_array_size(json_object_get(writer->root, "bufferViews"));
    bool room = status == BAT_OK;
    for (size_t n = 0; n < writer->node_count && room; n++)
        room = add_node(writer, n, &at, nodes);
    room = room && add_views(writer);
    return status == BAT_OK && !room ? no_memory(writer, error) : status;
}

/// One node for all nodes of a mesh. SIZE_MAX when out of memory.
static size_t join_nodes(const gltf_writer *writer, json_t *nodes)
{
    if (json_array_size(nodes) == 1)
        return (size_t)json_integer_value(json_array_get(nodes, 0));
    return add_to(writer, "nodes", json_pack("{s:o}", "children", json_copy(nodes)));
}

/// Append a level of detail to the bytes and the JSON of the mesh; `number` receives its node.
static bat_status append_level(gltf_writer *writer, size_t index, size_t *number, bat_error *error)
{
    const bat_mesh_write_options *given = writer->options;
    bat_mesh_write_options options = *given;
    gltf_writer level = {.mesh = &given->lods[index], .options = &options, .root = writer->root, .bytes = writer->bytes};
    double *normals = NULL;
    json_t *nodes = json_array();
    bat_status status = nodes != NULL ? BAT_OK : no_memory(writer, error);
    if (status == BAT_OK && given->vertex_normals != NULL)
    {
        normals = memory_array(level.mesh->vertex_count, 3 * sizeof *normals);
        status = normals != NULL ? bat_mesh_vertex_normals(level.mesh, BAT_MESH_NORMALS_ANGLE, normals, error)
                                 : no_memory(&level, error);
        options.vertex_normals = normals;
    }
    if (status == BAT_OK)
        status = append_mesh(&level, nodes, error);
    writer->bytes = level.bytes;
    level.root = NULL;
    level.bytes = (text_buffer){0};
    *number = status == BAT_OK ? join_nodes(writer, nodes) : SIZE_MAX;
    if (*number != SIZE_MAX && given->lod_distances != NULL)
        (void)json_object_set_new(
            json_array_get(json_object_get(writer->root, "nodes"), *number), "extras",
            json_pack("{s:f, s:I}", "distance", given->lod_distances[index], "faces", (json_int_t)level.mesh->face_count));
    json_decref(nodes);
    free(normals);
    writer_free(&level);
    return status == BAT_OK && *number == SIZE_MAX ? no_memory(writer, error) : status;
}

/// Append all levels of detail of the node that `nodes` then holds alone.
static bat_status append_levels(gltf_writer *writer, json_t *nodes, bat_error *error)
{
    json_t *numbers = json_array();
    size_t first = join_nodes(writer, nodes), number;
    bat_status status = numbers != NULL && first != SIZE_MAX ? BAT_OK : no_memory(writer, error);
    for (size_t i = 0; i < writer->options->lod_count && status == BAT_OK; i++)
    {
        status = append_level(writer, i, &number, error);
        if (status == BAT_OK && json_array_append_new(numbers, json_integer((json_int_t)number)) != 0)
            status = no_memory(writer, error);
    }
    json_t *node = json_array_get(json_object_get(writer->root, "nodes"), first);
    if (status == BAT_OK &&
        (json_object_set_new(node, "extensions", json_pack("{s:{s:O}}", "MSFT_lod", "ids", numbers)) != 0 ||
         add_to(writer, "extensionsUsed", json_string("MSFT_lod")) == SIZE_MAX || json_array_clear(nodes) != 0 ||
         json_array_append_new(nodes, json_integer((json_int_t)first)) != 0))
        status = no_memory(writer, error);
    json_decref(numbers);
    return status;
}

/// Make the JSON and the bytes, but for the buffer's own entry.
static bat_status writer_fill(gltf_writer *writer, bat_error *error)
{
    json_t *nodes = json_array();
    bat_status status = nodes != NULL ? append_mesh(writer, nodes, error) : no_memory(writer, error);
    if (status == BAT_OK && writer->options->lod_count > 0)
        status = append_levels(writer, nodes, error);
    if (status == BAT_OK && add_to(writer, "scenes", json_pack("{s:O}", "nodes", nodes)) == SIZE_MAX)
        status = no_memory(writer, error);
    json_decref(nodes);
    return status;
}

/// Add the buffer's entry and write the JSON as text.
static bat_status finish_json(const gltf_writer *writer, bool embedded, text_buffer *text, bat_error *error)
{
    json_t *buffer = json_pack("{s:I}", "byteLength", (json_int_t)writer->bytes.size);
    bool set = true;
    if (embedded)
    {
        text_buffer uri = {0};
        text_append_string(&uri, "data:application/octet-stream;base64,");
        base64_append(&uri, writer->bytes.data, writer->bytes.size);
        set = !uri.failed && json_object_set_new(buffer, "uri", json_stringn(uri.data, uri.size)) == 0;
        text_free(&uri);
    }
    if (add_to(writer, "buffers", complete(buffer, set)) == SIZE_MAX)
        return no_memory(writer, error);
    json_text(text, writer->root);
    return text->failed ? no_memory(writer, error) : BAT_OK;
}

bat_status mesh_gltf_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    gltf_writer writer = {.mesh = mesh, .options = options};
    text_buffer text = {0};
    bat_status status = writer_fill(&writer, error);
    if (status == BAT_OK)
        status = finish_json(&writer, true, &text, error);
    text_append(&text, "\n", 1);
    status = sink_take(sink, &text, status, error);
    writer_free(&writer);
    return status;
}

/// Move images from data URIs to the bytes. Images in files, and what is no base64, stay as they are.
static bool store_images(gltf_writer *writer)
{
    json_t *image;
    size_t index;
    bool room = true;
    json_array_foreach(json_object_get(writer->root, "images"), index, image)
    {
        const char *uri = json_string_value(json_object_get(image, "uri"));
        const char *data = uri != NULL && strncmp(uri, "data:", 5) == 0 ? strstr(uri, ";base64,") : NULL;
        size_t begin = writer->bytes.size;
        if (data == NULL || !base64_decode(&writer->bytes, data + 8, strlen(data + 8)) || writer->bytes.size == begin)
            continue;
        size_t size = writer->bytes.size - begin;
        while (writer->bytes.size % WORD != 0 && !writer->bytes.failed)
            text_append(&writer->bytes, "", 1);
        json_t *view =
            json_pack("{s:i, s:I, s:I}", "buffer", 0, "byteOffset", (json_int_t)begin, "byteLength", (json_int_t)size);
        room = room && json_object_set_new(image, "mimeType", json_stringn(uri + 5, strcspn(uri + 5, ";"))) == 0 &&
               json_object_set_new(image, "bufferView", index_json(add_to(writer, "bufferViews", view))) == 0 &&
               json_object_del(image, "uri") == 0;
    }
    return room && !writer->bytes.failed;
}

/// Append the header of a chunk.
static void append_chunk(text_buffer *text, size_t size, uint32_t kind)
{
    char header[GLB_CHUNK_HEADER];
    (void)bytes_put(bytes_put(header, size, WORD, false), kind, WORD, false);
    text_append(text, header, sizeof header);
}

bat_status mesh_glb_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    gltf_writer writer = {.mesh = mesh, .options = options};
    text_buffer json = {0}, head = {0}, middle = {0};
    bat_status status = writer_fill(&writer, error);
    if (status == BAT_OK)
        status = store_images(&writer) ? finish_json(&writer, false, &json, error) : no_memory(&writer, error);
    while (status == BAT_OK && json.size % WORD != 0)
        text_append(&json, " ", 1);
    size_t total = GLB_HEADER + 2 * (size_t)GLB_CHUNK_HEADER + json.size + writer.bytes.size;
    if (status == BAT_OK && total > UINT32_MAX)
        status = ERROR_TOO_LARGE(error, "the mesh takes %zu bytes in glTF, more than GLB holds", total);
    char header[GLB_HEADER];
    const uint64_t words[] = {GLB_MAGIC, GLB_VERSION, total};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        (void)bytes_put(header + WORD * i, words[i], WORD, false);
    text_append(&head, header, sizeof header);
    append_chunk(&head, json.size, GLB_JSON);
    append_chunk(&middle, writer.bytes.size, GLB_BIN);
    text_buffer *const parts[] = {&head, &json, &middle, &writer.bytes};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        status = sink_take(sink, parts[i], status, error);
    writer_free(&writer);
    return status;
}
