#include "io/mesh/gltf.h"

#include "io/common/base64.h"
#include "io/mesh/formats.h"

#include <math.h>

/// @file
/// The nodes of a scene and their transforms (glTF 2.0, section 3.5).

enum
{
    AXES = 3,
    MATRIX = 12, ///< numbers of an affine map: three rows of four
    GIVEN = 16   ///< numbers of a node's matrix, by columns
};

/// A node that waits for its turn.
typedef struct waiting_node
{
    size_t node;
    double matrix[MATRIX];
} waiting_node;

/// A walk along all nodes of a scene.
typedef struct scene_walk
{
    const gltf_document *document;
    unsigned char *visited;
    waiting_node *stack;
    size_t stack_count, stack_capacity;
    gltf_instance *instances;
    size_t count, capacity;
    bat_mesh_notes *notes;
} scene_walk;

static bat_status no_memory(const scene_walk *walk, bat_error *error)
{
    return error_memory(error, walk->stack_capacity * sizeof *walk->stack);
}

/// The map of a node's translation, rotation (a unit quaternion x, y, z, w) and scale.
static void compose(const double t[3], const double q[4], const double s[3], double matrix[MATRIX])
{
    double x = q[0], y = q[1], z = q[2], w = q[3];
    const double turn[AXES][AXES] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                                     {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                                     {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < AXES; i++)
    {
        for (int k = 0; k < AXES; k++)
            matrix[4 * i + k] = turn[i][k] * s[k];
        matrix[4 * i + AXES] = t[i];
    }
}

/// Read a node's own transform.
static bat_status read_transform(const json_t *node, gltf_place place, double matrix[MATRIX], bat_error *error)
{
    double given[GIVEN] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    double t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    bat_status status = gltf_numbers(node, "matrix", GIVEN, place, given, error);
    if (status == BAT_OK)
        status = gltf_numbers(node, "translation", 3, place, t, error);
    if (status == BAT_OK)
        status = gltf_numbers(node, "rotation", 4, place, q, error);
    if (status == BAT_OK)
        status = gltf_numbers(node, "scale", 3, place, s, error);
    if (status != BAT_OK)
        return status;
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(fabs(length - 1) < 0.01)) // single precision and rounded digits pass
        return gltf_fault(place, error, "its rotation has the length %g instead of 1", length);
    for (int k = 0; k < 4; k++)
        q[k] /= length;
    if (json_object_get(node, "matrix") == NULL)
    {
        compose(t, q, s, matrix);
        return BAT_OK;
    }
    if (given[3] != 0 || given[7] != 0 || given[11] != 0 || given[15] != 1)
        return gltf_fault(place, error, "the last row of its matrix is not 0, 0, 0, 1");
    for (int i = 0; i < AXES; i++)
        for (int k = 0; k < 4; k++)
            matrix[4 * i + k] = given[4 * k + i];
    return BAT_OK;
}

/// product = a b, of affine maps.
static void multiply(const double a[MATRIX], const double b[MATRIX], double product[MATRIX])
{
    for (int i = 0; i < AXES; i++)
        for (int k = 0; k < 4; k++)
        {
            product[4 * i + k] = k == AXES ? a[4 * i + AXES] : 0;
            for (int j = 0; j < AXES; j++)
                product[4 * i + k] += a[4 * i + j] * b[4 * j + k];
        }
}

/// Read the number of one of `count` nodes. False for another value.
static bool find_node(const json_t *number, size_t count, size_t *node)
{
    double value = json_number_value(number);
    bool found = json_is_number(number) && value >= 0 && value < (double)count && value == floor(value);
    *node = found ? (size_t)value : SIZE_MAX;
    return found;
}

/// Put a node on the stack. Each node has its turn once.
static bat_status push(scene_walk *walk, size_t node, const double matrix[MATRIX], bat_error *error)
{
    if (walk->visited[node])
        return gltf_fault((gltf_place){"node", node}, error, "it has two parents or is its own descendant");
    walk->visited[node] = 1;
    waiting_node next = {.node = node};
    memcpy(next.matrix, matrix, sizeof next.matrix);
    return ARRAY_ADD(walk->stack, walk->stack_capacity, walk->stack_count, next) ? BAT_OK : no_memory(walk, error);
}

/// Put all nodes of a list on the stack, the first one on top.
static bat_status push_all(scene_walk *walk, const json_t *object, const char *key, gltf_place place,
                           const double matrix[MATRIX], bat_error *error)
{
    const json_t *list;
    size_t count = json_array_size(json_object_get(walk->document->root, "nodes")), node;
    bat_status status = gltf_array(object, key, place, &list, error);
    for (size_t i = json_array_size(list); i > 0 && status == BAT_OK; i--)
        status = find_node(json_array_get(list, i - 1), count, &node)
                     ? push(walk, node, matrix, error)
                     : gltf_fault(place, error, "it names a node that is not among the %zu nodes", count);
    return status;
}

static bat_status add_instance(scene_walk *walk, size_t node, size_t mesh, const double matrix[MATRIX], bat_error *error)
{
    gltf_instance made = {.node = node, .mesh = mesh};
    memcpy(made.matrix, matrix, sizeof made.matrix);
    return ARRAY_ADD(walk->instances, walk->capacity, walk->count, made) ? BAT_OK : no_memory(walk, error);
}

/// Visit the node on top of the stack.
static bat_status visit(scene_walk *walk, bat_error *error)
{
    static const double identity[MATRIX] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    waiting_node now = walk->stack[--walk->stack_count];
    gltf_place place = {"node", now.node};
    json_t *node;
    double own[MATRIX] = {0}, matrix[MATRIX];
    size_t mesh = SIZE_MAX;
    bat_status status = gltf_element(walk->document, "nodes", "node", now.node, &node, error);
    if (status == BAT_OK)
        status = read_transform(node, place, own, error);
    if (status == BAT_OK)
        status = gltf_size(node, "mesh", place, &mesh, error);
    if (status != BAT_OK)
        return status;
    multiply(now.matrix, own, matrix);
    for (int i = 0; i < MATRIX; i++)
        if (!isfinite(matrix[i]))
            return gltf_fault(place, error, "its transform is not finite");
    bool skinned = mesh != SIZE_MAX && json_object_get(node, "skin") != NULL;
    if (skinned)
        status = mesh_note(walk->notes, error, "skins are left out: skinned meshes are as they were bound");
    if (status == BAT_OK && json_object_get(json_object_get(node, "extensions"), "EXT_mesh_gpu_instancing") != NULL)
        status = mesh_note(walk->notes, error, "instances of EXT_mesh_gpu_instancing are left out");
    if (status == BAT_OK && (json_object_get(node, "camera") != NULL ||
                             json_object_get(json_object_get(node, "extensions"), "KHR_lights_punctual") != NULL))
        status = mesh_note(walk->notes, error, "cameras and lights are left out");
    if (status == BAT_OK && mesh != SIZE_MAX)
        status = add_instance(walk, now.node, mesh, skinned ? identity : matrix, error);
    return status == BAT_OK ? push_all(walk, node, "children", place, matrix, error) : status;
}

/// Put the roots of the scene on the stack. Without a scene they are the nodes that no other node names.
static bat_status push_roots(scene_walk *walk, const double identity[MATRIX], bat_error *error)
{
    const json_t *root = walk->document->root, *scenes, *nodes, *children;
    gltf_place file = {"the file", SIZE_MAX};
    size_t number = 0;
    json_t *scene;
    bat_status status = gltf_array(root, "scenes", file, &scenes, error);
    if (status == BAT_OK)
        status = gltf_array(root, "nodes", file, &nodes, error);
    if (status == BAT_OK)
        status = gltf_size(root, "scene", file, &number, error);
    if (status != BAT_OK)
        return status;
    if (json_array_size(scenes) > 0)
    {
        status = gltf_element(walk->document, "scenes", "scene", number, &scene, error);
        if (status == BAT_OK && json_array_size(scenes) > 1)
            status = mesh_note(walk->notes, error, "of %zu scenes the one with number %zu is read", json_array_size(scenes),
                               number);
        return status == BAT_OK ? push_all(walk, scene, "nodes", (gltf_place){"scene", number}, identity, error) : status;
    }
    size_t count = json_array_size(nodes);
    unsigned char *child = calloc(count + 1, 1);
    if (child == NULL)
        return error_memory(error, count + 1);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        status = gltf_array(json_array_get(nodes, i), "children", (gltf_place){"node", i}, &children, error);
        size_t node;
        for (size_t k = 0; k < json_array_size(children) && status == BAT_OK; k++)
            if (find_node(json_array_get(children, k), count, &node))
                child[node] = 1;
    }
    for (size_t i = count; i > 0 && status == BAT_OK; i--)
        if (!child[i - 1])
            status = push(walk, i - 1, identity, error);
    free(child);
    return status;
}

bat_status gltf_instances_find(const gltf_document *document, gltf_instance **instances, size_t *count,
                               bat_mesh_notes *notes, bat_error *error)
{
    static const double identity[MATRIX] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    size_t nodes = json_array_size(json_object_get(document->root, "nodes"));
    scene_walk walk = {.document = document, .visited = calloc(nodes + 1, 1), .notes = notes};
    bat_status status = walk.visited != NULL ? BAT_OK : error_memory(error, nodes);
    const json_t *meshes = NULL; // each once, for a file without nodes
    if (status == BAT_OK && nodes == 0)
        status = gltf_array(document->root, "meshes", (gltf_place){"the file", SIZE_MAX}, &meshes, error);
    for (size_t i = 0; i < json_array_size(meshes) && status == BAT_OK; i++)
        status = add_instance(&walk, SIZE_MAX, i, identity, error);
    if (status == BAT_OK && nodes > 0)
        status = push_roots(&walk, identity, error);
    while (status == BAT_OK && walk.stack_count > 0)
        status = visit(&walk, error);
    free(walk.visited);
    free(walk.stack);
    if (status != BAT_OK)
    {
        free(walk.instances);
        return status;
    }
    *instances = walk.instances;
    *count = walk.count;
    return BAT_OK;
}

// Materials of glTF as a JSON text that needs no buffers.

/// The arrays that materials consist of.
static const char *const ARRAYS[] = {"materials", "textures", "samplers", "images"};

static void free_names(char **names, size_t count)
{
    for (size_t i = 0; i < count && names != NULL; i++)
        free(names[i]);
    free(names);
}

/// Replace the buffer view of an image by a data URI.
static bat_status embed_image(gltf_document *document, json_t *image, size_t index, bat_error *error)
{
    gltf_place place = {"image", index};
    size_t number = SIZE_MAX;
    gltf_view view;
    const char *type = json_string_value(json_object_get(image, "mimeType"));
    text_buffer text = {0};
    bat_status status = gltf_size(image, "bufferView", place, &number, error);
    if (status != BAT_OK || number == SIZE_MAX)
        return status;
    status = gltf_view_find(document, number, &view, error);
    if (status != BAT_OK)
        return status;
    TEXT_APPEND(&text, "data:", type != NULL ? type : "image/png", ";base64,");
    base64_append(&text, view.bytes, view.size);
    json_t *uri = text.failed ? NULL : json_stringn(text.data, text.size);
    if (uri == NULL || json_object_set_new(image, "uri", uri) != 0)
        status = error_memory(error, view.size);
    text_free(&text);
    (void)json_object_del(image, "bufferView");
    return status;
}

static bat_status embed_images(gltf_document *document, json_t *images, bat_mesh_notes *notes, bat_error *error)
{
    bat_status status = BAT_OK;
    size_t files = 0;
    for (size_t i = 0; i < json_array_size(images) && status == BAT_OK; i++)
    {
        json_t *image = json_array_get(images, i);
        const char *uri = json_string_value(json_object_get(image, "uri"));
        if (!json_is_object(image))
            return gltf_fault((gltf_place){"image", i}, error, "it is no object");
        if (uri == NULL)
            status = embed_image(document, image, i, error);
        else
            files += strncmp(uri, "data:", 5) != 0;
    }
    if (status == BAT_OK && files > 0)
        status =
            mesh_note(notes, error, "%zu images of materials stay in their files, with names relative to the input", files);
    return status;
}

/// Name all materials of `made`.
static bat_status name_materials(json_t *materials, char ***names, bat_error *error)
{
    static const int MAX_MATERIALS = 1 << 14; ///< names are compared in pairs
    size_t count = json_array_size(materials);
    if (count > MAX_MATERIALS)
        return ERROR_TOO_LARGE(error, "there are %zu materials, more than %d", count, MAX_MATERIALS);
    char **made = calloc(count + 1, sizeof *made);
    bat_status status = made != NULL ? BAT_OK : error_memory(error, count * sizeof *made);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        json_t *material = json_array_get(materials, i);
        if (!json_is_object(material))
        {
            status = gltf_fault((gltf_place){"material", i}, error, "it is no object");
            break;
        }
        const char *own = json_string_value(json_object_get(material, "name"));
        bool nameless = own == NULL || *own == '\0';
        made[i] = label_name_unique(nameless ? "material" : own, nameless, made, sizeof *made, i);
        if (made[i] == NULL || json_object_set_new(material, "name", json_string(made[i])) != 0)
            status = error_memory(error, count * sizeof *made);
    }
    if (status == BAT_OK)
        *names = made;
    else
        free_names(made, count);
    return status;
}

bat_status gltf_materials_read(gltf_document *document, char ***names, size_t *count, char **json, bat_mesh_notes *notes,
                               bat_error *error)
{
    json_t *made = json_object();
    bat_status status = made != NULL ? BAT_OK : error_memory(error, sizeof *made);
    for (size_t i = 0; i < sizeof ARRAYS / sizeof *ARRAYS && status == BAT_OK; i++)
    {
        json_t *array = json_object_get(document->root, ARRAYS[i]);
        if (array != NULL && !json_is_array(array))
            status = gltf_fault((gltf_place){"the file", SIZE_MAX}, error, "'%s' is no list", ARRAYS[i]);
        else if (array != NULL && json_object_set_new(made, ARRAYS[i], json_deep_copy(array)) != 0)
            status = error_memory(error, document->total_size);
    }
    json_t *materials = json_object_get(made, "materials");
    size_t found = json_array_size(materials);
    char **made_names = NULL, *text = NULL;
    if (status == BAT_OK && found > 0)
        status = name_materials(materials, &made_names, error);
    if (status == BAT_OK && found > 0)
        status = embed_images(document, json_object_get(made, "images"), notes, error);
    if (status == BAT_OK && found > 0)
    {
        text = json_text_make(made);
        status = text != NULL ? BAT_OK : error_memory(error, document->total_size);
    }
    json_decref(made);
    if (status != BAT_OK)
    {
        free_names(made_names, found);
        return status;
    }
    *names = made_names;
    *count = found;
    *json = text;
    return BAT_OK;
}
