#include "base/bisect.h"
#include "io/common/json.h"
#include "io/common/xml_parse.h"
#include "io/common/zip.h"
#include "io/mesh/builder.h"
#include "linalg/vector.h"

/// @file
/// Reader of 3MF: 3MF Consortium, "3D Manufacturing Format: Core Specification" 1.3. The meshes of the objects that the
/// build places become one mesh, in millimetres.

#define CORE "http://schemas.microsoft.com/3dmanufacturing/core/2015/02|"
#define RELATION "http://schemas.openxmlformats.org/package/2006/relationships|Relationship"
#define MODEL_TYPE "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"

enum
{
    MAX_DEPTH = 64, ///< of components in components
    MAX_RESOURCES = 1 << 16,
    MAX_MATERIALS = 1 << 10, ///< names are compared in pairs
    MAX_COPIES = 1000,       ///< vertices of the result for each one of the file …
    ALWAYS = 1 << 20         ///< … but as many are no danger
};

/// An affine map: the image of (x, y, z) is (x, y, z, 1) times these 4 rows of 3.
typedef struct affine
{
    double m[4][3];
} affine;

/// An object that another one or the build places.
typedef struct placed
{
    size_t object;
    affine to;
} placed;

/// An object: a mesh, or components.
typedef struct object_3mf
{
    char *name;
    double *positions; ///< vertex_count x 3
    size_t vertex_count, position_capacity;
    uint32_t *faces;     ///< face_count x 3
    uint32_t *materials; ///< of each face; BAT_MESH_NONE for none
    size_t face_count, face_capacity, material_capacity;
    placed *components;
    size_t component_count, component_capacity;
    size_t group, property; ///< of faces without their own; SIZE_MAX for none
    size_t total_vertices;  ///< with those of its components
    size_t depth;           ///< of components in components
    bool placed;            ///< by the build or by another object
} object_3mf;

/// What has a number.
typedef struct resource
{
    size_t id;
    enum
    {
        OBJECT,
        MATERIALS,
        OTHER_RESOURCE ///< of an extension
    } kind;
    size_t index, count; ///< the object; or the first material of the group, and how many it has
} resource;

typedef struct material_3mf
{
    char *name;
    double colour[4]; ///< linear
} material_3mf;

/// The elements that are read.
typedef enum element
{
    OUTSIDE,
    MODEL,
    RESOURCES,
    GROUP,
    BASE,
    OBJECT_ELEMENT,
    MESH,
    VERTICES,
    VERTEX,
    TRIANGLES,
    TRIANGLE,
    COMPONENTS,
    COMPONENT,
    BUILD,
    ITEM,
    OTHER ///< skipped with its content
} element;

typedef struct reader_3mf
{
    xml_parse xml;
    const bat_mesh_read_options *options;
    element open[16];
    size_t depth, skipped; ///< open elements; those of them within an OTHER one
    double unit;           ///< in millimetres
    char unit_name[16];
    resource *resources;                              ///< by their ids
    size_t resource_count, resource_capacity, latest; ///< the id of the latest
    object_3mf *objects;
    size_t object_count, object_capacity;
    material_3mf *materials;
    size_t material_count, material_capacity;
    placed *items;
    size_t item_count, item_capacity;
    size_t vertices; ///< of all objects
    size_t unread;   ///< properties of faces that are no base materials
    char *target;    ///< the model's part, of the package's relationships
    mesh_builder builder;
    uint32_t material; ///< of the builder's label
} reader_3mf;

static void reader_free(reader_3mf *reader)
{
    for (size_t i = 0; i < reader->object_count; i++)
    {
        free(reader->objects[i].name);
        free(reader->objects[i].positions);
        free(reader->objects[i].faces);
        free(reader->objects[i].materials);
        free(reader->objects[i].components);
    }
    for (size_t i = 0; i < reader->material_count; i++)
        free(reader->materials[i].name);
    free(reader->objects);
    free(reader->materials);
    free(reader->resources);
    free(reader->items);
    free(reader->target);
    mesh_builder_free(&reader->builder);
}

// XML

/// Fail at the parser's line.
#define FAIL(reader, status, ...) XML_FAIL(&(reader)->xml, status, __VA_ARGS__)

static bool fail_memory(reader_3mf *reader, size_t size)
{
    return xml_stop(&reader->xml, error_memory(reader->xml.error, size));
}

/// Append to an array. False when out of memory, which is then the failure.
#define ADD(reader, array, capacity, count, ...)                                                                            \
    (ARRAY_ADD(array, capacity, count, __VA_ARGS__) || fail_memory(reader, (count) * sizeof *(array)))

/// Read a whole number below `limit`; without the attribute `*value` stays, unless it is `needed`.
static bool read_whole(reader_3mf *reader, const XML_Char **attributes, const char *name, size_t limit, bool needed,
                       size_t *value)
{
    const char *text = xml_attribute(attributes, name);
    size_t number = 0, digits = 0;
    if (text == NULL && !needed)
        return true;
    for (; text != NULL && text[digits] >= '0' && text[digits] <= '9' && number < limit; digits++)
        number = 10 * number + (size_t)(text[digits] - '0');
    if (digits > 0 && text[digits] == '\0' && number < limit)
    {
        *value = number;
        return true;
    }
    char excerpt[EXCERPT_SIZE];
    if (text == NULL)
        return FAIL(reader, BAT_BAD_FILE, "the attribute '%s' is missing", name);
    return FAIL(reader, BAT_BAD_FILE, "the attribute '%s' is '%s', but must be a whole number below %zu", name,
                text_excerpt(excerpt, text, text + strlen(text)), limit);
}

/// Read `count` finite numbers between blanks.
static bool read_numbers(reader_3mf *reader, const char *name, const char *text, size_t count, double *values)
{
    static const char BLANKS[] = " \t\n\r";
    char excerpt[EXCERPT_SIZE];
    const char *at = text != NULL ? text : "";
    for (size_t i = 0; i < count; i++)
    {
        at += strspn(at, BLANKS);
        size_t size = strcspn(at, BLANKS);
        const char *wrong = size > 0 ? number_read(at, at + size, &values[i]) : "missing";
        if (wrong != NULL || !isfinite(values[i]))
            return FAIL(reader, BAT_BAD_FILE, "the attribute '%s' has number %zu of %zu '%s': %s", name, i + 1, count,
                        text_excerpt(excerpt, at, at + size), wrong != NULL ? wrong : "not finite");
        at += size;
    }
    return at[strspn(at, BLANKS)] == '\0' ||
           FAIL(reader, BAT_BAD_FILE, "the attribute '%s' has more than %zu numbers", name, count);
}

/// A copy of a name; null for an empty or missing one, and when out of memory, which is then the failure.
static char *copy_name(reader_3mf *reader, const char *name)
{
    if (name == NULL || *name == '\0')
        return NULL;
    char *copy = label_name_copy(label_name_of(name));
    if (copy == NULL)
        fail_memory(reader, strlen(name));
    return copy;
}

// Resources

/// The place of an id among the resources: that of the resource, or where it would stand.
static size_t place_of(const reader_3mf *reader, size_t id)
{
    size_t low = 0, high = reader->resource_count;
    BISECT(low, high, middle, reader->resources[middle].id < id)
    return low;
}

static resource *find_resource(const reader_3mf *reader, size_t id)
{
    size_t place = place_of(reader, id);
    return place < reader->resource_count && reader->resources[place].id == id ? &reader->resources[place] : NULL;
}

/// Add a resource whose id is an attribute.
static void add_resource(reader_3mf *reader, const XML_Char **attributes, resource made)
{
    if (!read_whole(reader, attributes, "id", 1UL << 31, true, &made.id))
        return;
    size_t place = place_of(reader, made.id);
    if (find_resource(reader, made.id) != NULL)
        FAIL(reader, BAT_BAD_FILE, "the resource %zu is there twice", made.id);
    else if (reader->resource_count == MAX_RESOURCES)
        FAIL(reader, BAT_TOO_LARGE, "there are more than %d resources", MAX_RESOURCES);
    else if (ADD(reader, reader->resources, reader->resource_capacity, reader->resource_count, made))
    {
        memmove(&reader->resources[place + 1], &reader->resources[place],
                (reader->resource_count - 1 - place) * sizeof made);
        reader->resources[place] = made;
        reader->latest = made.id;
    }
}

static void begin_model(reader_3mf *reader, const XML_Char **attributes)
{
    static const struct
    {
        const char *name;
        double millimetres;
    } UNITS[] = {{"micron", 1e-3}, {"millimeter", 1}, {"centimeter", 10}, {"inch", 25.4}, {"foot", 304.8}, {"meter", 1e3}};
    const char *unit = xml_attribute(attributes, "unit"), *required = xml_attribute(attributes, "requiredextensions");
    char excerpt[EXCERPT_SIZE];
    for (size_t i = 0; unit != NULL && i < sizeof UNITS / sizeof *UNITS; i++)
        if (strcmp(unit, UNITS[i].name) == 0)
        {
            reader->unit = UNITS[i].millimetres;
            (void)snprintf(reader->unit_name, sizeof reader->unit_name, "%s", unit);
        }
    if (unit != NULL && reader->unit_name[0] == '\0')
        FAIL(reader, BAT_BAD_FILE, "there is no unit '%s'", text_excerpt(excerpt, unit, unit + strlen(unit)));
    else if (required != NULL && required[strspn(required, " \t\n\r")] != '\0')
        FAIL(reader, BAT_UNSUPPORTED, "the model requires extensions, which are not read: '%s'",
             text_excerpt(excerpt, required, required + strlen(required)));
}

static void begin_group(reader_3mf *reader, const XML_Char **attributes)
{
    add_resource(reader, attributes, (resource){.kind = MATERIALS, .index = reader->material_count});
}

/// Read "#RRGGBB" or "#RRGGBBAA".
static bool read_colour(const char *text, double colour[4])
{
    size_t size = text != NULL && text[0] == '#' ? strspn(text + 1, "0123456789abcdefABCDEF") : 0;
    if ((size != 6 && size != 8) || text[1 + size] != '\0')
        return false;
    unsigned long value = strtoul(text + 1, NULL, 16);
    if (size == 6)
        value = value << 8 | 0xff;
    for (int k = 0; k < 3; k++) // from sRGB to the linear scale of glTF
    {
        double c = (double)(value >> (24 - 8 * k) & 0xff) / 255;
        colour[k] = c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
    }
    colour[3] = (double)(value & 0xff) / 255;
    return true;
}

static void begin_base(reader_3mf *reader, const XML_Char **attributes)
{
    const char *text = xml_attribute(attributes, "displaycolor");
    char excerpt[EXCERPT_SIZE];
    double colour[4];
    if (!read_colour(text, colour))
    {
        text = text != NULL ? text : "";
        FAIL(reader, BAT_BAD_FILE, "the display colour '%s' of a material is not #RRGGBB or #RRGGBBAA",
             text_excerpt(excerpt, text, text + strlen(text)));
        return;
    }
    if (reader->material_count == MAX_MATERIALS)
    {
        FAIL(reader, BAT_TOO_LARGE, "there are more than %d materials", MAX_MATERIALS);
        return;
    }
    const char *name = xml_attribute(attributes, "name");
    name = name != NULL && *name != '\0' ? name : "material";
    material_3mf made = {
        .name = label_name_unique(name, false, reader->materials, sizeof *reader->materials, reader->material_count)};
    memcpy(made.colour, colour, sizeof colour);
    if (made.name == NULL)
        fail_memory(reader, strlen(name));
    if (made.name == NULL || !ADD(reader, reader->materials, reader->material_capacity, reader->material_count, made))
    {
        free(made.name);
        return;
    }
    find_resource(reader, reader->latest)->count++;
}

static void begin_object(reader_3mf *reader, const XML_Char **attributes)
{
    object_3mf made = {.group = SIZE_MAX, .property = 0};
    if (!read_whole(reader, attributes, "pid", 1UL << 31, false, &made.group) ||
        !read_whole(reader, attributes, "pindex", 1UL << 31, false, &made.property))
        return;
    add_resource(reader, attributes, (resource){.kind = OBJECT, .index = reader->object_count});
    if (reader->xml.status == BAT_OK && ADD(reader, reader->objects, reader->object_capacity, reader->object_count, made))
        reader->objects[reader->object_count - 1].name = copy_name(reader, xml_attribute(attributes, "name"));
}

static object_3mf *open_object(const reader_3mf *reader)
{
    return &reader->objects[reader->object_count - 1];
}

static void begin_vertex(reader_3mf *reader, const XML_Char **attributes)
{
    static const char *const NAMES[] = {"x", "y", "z"};
    object_3mf *object = open_object(reader);
    double point[3];
    for (int k = 0; k < 3; k++)
        if (!read_numbers(reader, NAMES[k], xml_attribute(attributes, NAMES[k]), 1, &point[k]))
            return;
    if (!ARRAY_GROW(object->positions, object->position_capacity, 3 * object->vertex_count + 3))
    {
        fail_memory(reader, 3 * object->vertex_count * sizeof *point);
        return;
    }
    memcpy(object->positions + 3 * object->vertex_count++, point, sizeof point);
    reader->vertices++;
}

/// Find the material of a face: number `property` of the group `group`.
static bool find_material(reader_3mf *reader, size_t group, size_t property, uint32_t *material)
{
    const resource *found = group != SIZE_MAX ? find_resource(reader, group) : NULL;
    *material = BAT_MESH_NONE;
    if (group != SIZE_MAX && (found == NULL || found->kind == OBJECT))
        FAIL(reader, BAT_BAD_FILE, "a face has properties of the resource %zu, which is not defined before it", group);
    else if (found != NULL && found->kind == MATERIALS && property >= found->count)
        FAIL(reader, BAT_BAD_FILE, "a face has the material %zu of the %zu of resource %zu", property, found->count, group);
    else if (found != NULL && found->kind == MATERIALS)
        *material = (uint32_t)(found->index + property);
    else
        reader->unread += found != NULL;
    return reader->xml.status == BAT_OK;
}

static void begin_triangle(reader_3mf *reader, const XML_Char **attributes)
{
    static const char *const NAMES[] = {"v1", "v2", "v3"};
    object_3mf *object = open_object(reader);
    size_t corners[3], group = object->group, property = object->property;
    for (int k = 0; k < 3; k++)
        if (!read_whole(reader, attributes, NAMES[k], object->vertex_count, true, &corners[k]))
            return;
    uint32_t material;
    if (!read_whole(reader, attributes, "pid", 1UL << 31, false, &group) ||
        !read_whole(reader, attributes, "p1", 1UL << 31, false, &property) ||
        !find_material(reader, group, property, &material))
        return;
    if (!ARRAY_GROW(object->faces, object->face_capacity, 3 * object->face_count + 3))
    {
        fail_memory(reader, 3 * object->face_count * sizeof *object->faces);
        return;
    }
    for (size_t k = 0; k < 3; k++)
        object->faces[3 * object->face_count + k] = (uint32_t)corners[k];
    (void)ADD(reader, object->materials, object->material_capacity, object->face_count, material);
}

/// Read what is placed where. An object must stand before those that place it, so that none can contain itself.
static bool read_placed(reader_3mf *reader, const XML_Char **attributes, size_t limit, placed *made)
{
    size_t id;
    if (!read_whole(reader, attributes, "objectid", 1UL << 31, true, &id))
        return false;
    const resource *found = find_resource(reader, id);
    if (found == NULL || found->kind != OBJECT || found->index >= limit)
        return FAIL(reader, BAT_BAD_FILE, "the object %zu is placed, but is not defined before", id);
    made->object = found->index;
    reader->objects[found->index].placed = true;
    const char *text = xml_attribute(attributes, "transform");
    made->to = (affine){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};
    return text == NULL || read_numbers(reader, "transform", text, 12, made->to.m[0]);
}

static void begin_component(reader_3mf *reader, const XML_Char **attributes)
{
    placed made;
    if (!read_placed(reader, attributes, reader->object_count - 1, &made))
        return;
    object_3mf *object = open_object(reader);
    const object_3mf *part = &reader->objects[made.object];
    if (!ADD(reader, object->components, object->component_capacity, object->component_count, made))
        return;
    object->depth = part->depth + 1 > object->depth ? part->depth + 1 : object->depth;
    if (object->depth > MAX_DEPTH)
        FAIL(reader, BAT_TOO_LARGE, "components are nested deeper than %d", MAX_DEPTH);
}

static void begin_item(reader_3mf *reader, const XML_Char **attributes)
{
    placed made;
    if (read_placed(reader, attributes, SIZE_MAX, &made))
        (void)ADD(reader, reader->items, reader->item_capacity, reader->item_count, made);
}

/// The elements, each below its parent.
static const struct
{
    const char *name;
    element is, parent;
    void (*begin)(reader_3mf *reader, const XML_Char **attributes);
} ELEMENTS[] = {
    {"vertex", VERTEX, VERTICES, begin_vertex},
    {"triangle", TRIANGLE, TRIANGLES, begin_triangle},
    {"model", MODEL, OUTSIDE, begin_model},
    {"resources", RESOURCES, MODEL, NULL},
    {"basematerials", GROUP, RESOURCES, begin_group},
    {"base", BASE, GROUP, begin_base},
    {"object", OBJECT_ELEMENT, RESOURCES, begin_object},
    {"mesh", MESH, OBJECT_ELEMENT, NULL},
    {"vertices", VERTICES, MESH, NULL},
    {"triangles", TRIANGLES, MESH, NULL},
    {"components", COMPONENTS, OBJECT_ELEMENT, NULL},
    {"component", COMPONENT, COMPONENTS, begin_component},
    {"build", BUILD, MODEL, NULL},
    {"item", ITEM, BUILD, begin_item},
};

static void on_begin(void *context, const XML_Char *name, const XML_Char **attributes)
{
    reader_3mf *reader = context;
    element parent = reader->depth > 0 ? reader->open[reader->depth - 1] : OUTSIDE;
    bool core = strncmp(name, CORE, strlen(CORE)) == 0;
    if (reader->skipped > 0)
    {
        reader->skipped++;
        return;
    }
    for (size_t i = 0; core && i < sizeof ELEMENTS / sizeof *ELEMENTS; i++)
        if (ELEMENTS[i].parent == parent && strcmp(name + strlen(CORE), ELEMENTS[i].name) == 0)
        {
            reader->open[reader->depth++] = ELEMENTS[i].is;
            if (ELEMENTS[i].begin != NULL)
                ELEMENTS[i].begin(reader, attributes);
            return;
        }
    if (parent == OUTSIDE)
        FAIL(reader, BAT_BAD_FILE, "the root element is no 'model' of 3MF");
    else if (parent == RESOURCES)
        add_resource(reader, attributes, (resource){.kind = OTHER_RESOURCE});
    reader->skipped = 1;
}

static void on_end(void *context, const XML_Char *name BAT_UNUSED)
{
    reader_3mf *reader = context;
    if (reader->skipped > 0)
    {
        reader->skipped--;
        return;
    }
    if (reader->open[--reader->depth] != OBJECT_ELEMENT || reader->xml.status != BAT_OK)
        return;
    object_3mf *object = open_object(reader);
    object->total_vertices = object->vertex_count;
    for (size_t i = 0; i < object->component_count; i++)
    {
        size_t more = reader->objects[object->components[i].object].total_vertices + 1,
               total = object->total_vertices + more;
        object->total_vertices = total >= more ? total : SIZE_MAX / 2;
    }
}

static void on_relation(void *context, const XML_Char *name, const XML_Char **attributes)
{
    reader_3mf *reader = context;
    const char *type = xml_attribute(attributes, "Type"), *target = xml_attribute(attributes, "Target");
    if (strcmp(name, RELATION) != 0 || type == NULL || target == NULL || strcmp(type, MODEL_TYPE) != 0)
        return;
    if (reader->target != NULL)
        FAIL(reader, BAT_BAD_FILE, "the package has two 3D models");
    else if ((reader->target = strdup(target + (*target == '/'))) == NULL)
        fail_memory(reader, strlen(target));
}

static bat_status parse_piece(void *context, const char *bytes, size_t size, bool last, bat_error *error BAT_UNUSED)
{
    return xml_piece(context, bytes, size, last);
}

/// Parse a part of the package.
static bat_status parse_part(reader_3mf *reader, const file_text *text, const char *name, XML_StartElementHandler begin,
                             XML_EndElementHandler end, bat_error *error)
{
    zip_part part;
    bat_status status = zip_find(text, name, &part, error);
    if (status == BAT_OK && part.name == NULL)
        status = ERROR_FILE(error, 0, "the package lacks the part '%.60s'", name);
    if (status != BAT_OK)
        return status;
    reader->xml.prefix = "XML: ";
    reader->xml.doctype = "a document type is not allowed in 3MF";
    reader->xml.doctype_fault = BAT_BAD_FILE;
    reader->xml.error = error;
    status = xml_begin(&reader->xml, "|", begin, end);
    if (status != BAT_OK)
        return status;
    status = zip_inflate(&part, parse_piece, &reader->xml, error);
    XML_ParserFree(reader->xml.parser);
    return status;
}

// The scene

/// The map that applies `first`, then `then`.
static affine compose(const affine *first, const affine *then)
{
    affine both;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            both.m[i][k] = first->m[i][0] * then->m[0][k] + first->m[i][1] * then->m[1][k] + first->m[i][2] * then->m[2][k] +
                           (i == 3 ? then->m[3][k] : 0);
    return both;
}

static bat_status no_memory(const reader_3mf *reader, bat_error *error)
{
    return error_memory(error, reader->vertices * 3 * sizeof(double));
}

static bat_status add_vertices(reader_3mf *reader, const object_3mf *object, const affine *to, bat_error *error)
{
    for (size_t v = 0; v < object->vertex_count; v++)
    {
        const double *p = object->positions + 3 * v;
        double *image = mesh_builder_vertex(&reader->builder);
        if (image == NULL)
            return no_memory(reader, error);
        for (int k = 0; k < 3; k++)
            image[k] = (p[0] * to->m[0][k] + p[1] * to->m[1][k] + p[2] * to->m[2][k] + to->m[3][k]) * reader->unit;
        if (!isfinite(image[0]) || !isfinite(image[1]) || !isfinite(image[2]))
            return error_set(error, BAT_BAD_FILE, v, 0, "vertex %zu of the object '%s' is not finite where it is placed", v,
                             object->name != NULL ? object->name : "");
    }
    return BAT_OK;
}

static bool set_label(reader_3mf *reader, const char *name, uint32_t material)
{
    const char *own = material != BAT_MESH_NONE ? reader->materials[material].name : NULL;
    const label_name names[MESH_LABEL_NAMES] = {label_name_of(name), {0}, label_name_of(own)};
    bool named = name != NULL || own != NULL;
    return (!named && !reader->builder.labelled) || mesh_builder_label(&reader->builder, names);
}

static bat_status add_faces(reader_3mf *reader, const object_3mf *object, const char *name, uint32_t first, bool flipped,
                            bat_error *error)
{
    for (size_t f = 0; f < object->face_count; f++)
    {
        const uint32_t *face = object->faces + 3 * f;
        bool room =
            (f > 0 && object->materials[f] == object->materials[f - 1]) || set_label(reader, name, object->materials[f]);
        for (int c = 0; c < 3; c++)
            room = room && mesh_builder_corner(&reader->builder, first + face[flipped ? 2 - c : c], BAT_MESH_NONE);
        if (!room || !mesh_builder_end_face(&reader->builder, 3))
            return no_memory(reader, error);
    }
    return BAT_OK;
}

/// Add an object and its components, at most MAX_DEPTH deep.
static bat_status add_object(reader_3mf *reader, const placed *at, const char *name, bat_error *error)
{
    const object_3mf *object = &reader->objects[at->object];
    uint32_t first = (uint32_t)reader->builder.mesh.vertex_count;
    name = object->name != NULL ? object->name : name;
    bat_status status = add_vertices(reader, object, &at->to, error);
    if (status == BAT_OK)
        status =
            add_faces(reader, object, name, first, vector3_determinant(at->to.m[0], at->to.m[1], at->to.m[2]) < 0, error);
    for (size_t i = 0; i < object->component_count && status == BAT_OK; i++)
    {
        placed part = object->components[i];
        part.to = compose(&part.to, &at->to);
        status = add_object(reader, &part, name, error);
    }
    return status;
}

/// The materials in the form of glTF.
static bat_status describe_materials(reader_3mf *reader, bat_error *error)
{
    json_t *root = json_object(), *list = json_array();
    bool room = json_object_set_new(root, "materials", list) == 0;
    for (size_t i = 0; i < reader->material_count && room; i++)
    {
        const material_3mf *at = &reader->materials[i];
        json_t *made = json_pack("{s:s, s:{s:[f,f,f,f]}}", "name", at->name, "pbrMetallicRoughness", "baseColorFactor",
                                 at->colour[0], at->colour[1], at->colour[2], at->colour[3]);
        room = json_array_append_new(list, made) == 0;
    }
    char *text = room ? json_text_make(root) : NULL;
    json_decref(root);
    reader->builder.mesh.material_json = text;
    return text != NULL ? BAT_OK : no_memory(reader, error);
}

/// Check that the build places something, and not a huge mesh made of few numbers.
static bat_status check_size(const reader_3mf *reader, bat_error *error)
{
    size_t total = 0, limit = reader->vertices > ALWAYS / MAX_COPIES ? reader->vertices * MAX_COPIES : ALWAYS;
    if (reader->item_count == 0)
        return ERROR_FILE(error, 0, "the build places no object");
    for (size_t i = 0; i < reader->item_count && total <= limit; i++)
        total += reader->objects[reader->items[i].object].total_vertices + 1;
    if (total > limit || total >= BAT_MESH_NONE)
        return ERROR_TOO_LARGE(error, "the components place more than %d copies of the model's %zu vertices", MAX_COPIES,
                               reader->vertices);
    return BAT_OK;
}

static bat_status note_all(const reader_3mf *reader, bat_error *error)
{
    bat_mesh_notes *notes = reader->options->notes;
    bat_status status = BAT_OK;
    size_t unplaced = 0;
    for (size_t i = 0; i < reader->object_count; i++)
        unplaced += !reader->objects[i].placed;
    if (reader->unit != 1)
        status = mesh_note(notes, error, "the unit of the file is the %s; coordinates are converted to millimetres",
                           reader->unit_name);
    if (status == BAT_OK && unplaced > 0)
        status = mesh_note(notes, error, "%zu objects that the build does not place are left out", unplaced);
    if (status == BAT_OK && reader->unread > 0)
        status = mesh_note(notes, error, "the properties of %zu faces are left out: only base materials are read",
                           reader->unread);
    return status;
}

bat_status mesh_3mf_read(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    reader_3mf reader = {.options = options, .unit = 1};
    bat_status status = zip_resembles(text) ? BAT_OK : ERROR_FILE(error, 0, "the file is no ZIP archive, as 3MF files are");
    if (status == BAT_OK)
        status = parse_part(&reader, text, "_rels/.rels", on_relation, NULL, error);
    if (status == BAT_OK && reader.target == NULL)
        status = ERROR_FILE(error, 0, "the package has no 3D model");
    if (status == BAT_OK)
        status = parse_part(&reader, text, reader.target, on_begin, on_end, error);
    if (status == BAT_OK)
        status = check_size(&reader, error);
    for (size_t i = 0; i < reader.item_count && status == BAT_OK; i++)
        status = add_object(&reader, &reader.items[i], NULL, error);
    if (status == BAT_OK && reader.material_count > 0)
        status = describe_materials(&reader, error);
    if (status == BAT_OK)
        status = note_all(&reader, error);
    if (status == BAT_OK)
        status = mesh_builder_finish(&reader.builder, options, mesh, error);
    reader_free(&reader);
    return status;
}
