#include "base/counting_sort.h"
#include "base/json_scan.h"
#include "io/common/zip.h"
#include "io/mesh/formats.h"

#include <math.h>

/// @file
/// Writer of 3MF: an object for each name of an object where these share no vertices, else one object. Base materials have
/// the colours of the mesh's materials.

static const char CONTENT_TYPES[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
    "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n"
    "</Types>\n";
static const char RELATIONS[] = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                                "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
                                "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
                                "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n"
                                "</Relationships>\n";

enum
{
    MATERIALS_ID = 1,
    FIRST_OBJECT_ID = 2
};

/// The plan of a file.
typedef struct writer_3mf
{
    memory_pool pool; ///< holds the arrays
    const bat_mesh *mesh;
    label_table objects, materials;       ///< by their names alone
    uint32_t *object_of, *material_of;    ///< of each label that faces have
    uint32_t *vertex_object;              ///< the object of each vertex
    uint32_t *vertices, *faces;           ///< their numbers, those of one object after those of another
    size_t *vertices_until, *faces_until; ///< object_count + 1
    size_t object_count;
    text_buffer model;
} writer_3mf;

static bat_status no_memory(const writer_3mf *writer, bat_error *error)
{
    return error_memory(error, writer->mesh->vertex_count * sizeof *writer->vertices);
}

static size_t object_of_face(const void *context, uint32_t face)
{
    const writer_3mf *writer = context;
    return writer->object_count > 1 ? writer->object_of[writer->mesh->face_labels[face]] : 0;
}

static size_t object_of_vertex(const void *context, uint32_t vertex)
{
    const writer_3mf *writer = context;
    return writer->object_count > 1 ? writer->vertex_object[vertex] : 0;
}

// Text

/// Append an attribute with a text in the form of label_name_copy().
static void put_text(text_buffer *out, const char *name, const char *text)
{
    static const struct
    {
        const char *characters, *text;
    } REPLACED[] = {{"&", "&amp;"}, {"<", "&lt;"}, {"\"", "&quot;"}, {"\xef\xbf\xbe", "_"}, {"\xef\xbf\xbf", "_"}};
    text_append_string(out, name);
    while (*text != '\0')
    {
        size_t size = 1;
        const char *shown = text;
        for (size_t i = 0; i < sizeof REPLACED / sizeof *REPLACED && shown == text; i++)
            if (strncmp(text, REPLACED[i].characters, strlen(REPLACED[i].characters)) == 0)
            {
                size = strlen(REPLACED[i].characters);
                shown = REPLACED[i].text;
            }
        text_append(out, shown, shown == text ? 1 : strlen(shown));
        text += size;
    }
    text_append_string(out, "\"");
}

static void put_whole(text_buffer *out, const char *name, size_t value)
{
    text_append_fixed(out, name, (int64_t)value, 0);
    text_append_string(out, "\"");
}

// Materials

/// The byte of sRGB of a linear component, or of an opacity as it is.
static unsigned byte_of(double value, bool linear)
{
    value = value > 0 ? fmin(value, 1) : 0;
    if (linear)
        value = value <= 0.0031308 ? 12.92 * value : 1.055 * pow(value, 1 / 2.4) - 0.055;
    return (unsigned)lround(value * 255);
}

/// Append a base material; it is opaque white where `definition` gives no colour.
static void put_material(writer_3mf *writer, const char *name, const json_t *definition)
{
    static const char DIGITS[] = "0123456789ABCDEF";
    const json_t *factor = json_object_get(json_object_get(definition, "pbrMetallicRoughness"), "baseColorFactor");
    char colour[] = " displaycolor=\"#FFFFFFFF\"/>\n", *digit = strchr(colour, '#') + 1;
    for (size_t k = 0; k < 4 && json_array_size(factor) == 4; k++)
    {
        unsigned byte = byte_of(json_number_value(json_array_get(factor, k)), k < 3);
        *digit++ = DIGITS[byte / 16];
        *digit++ = DIGITS[byte % 16];
    }
    put_text(&writer->model, "<base name=\"", name);
    text_append_string(&writer->model, colour);
}

/// The definition of a material among those of glTF; null for none.
static const json_t *definition_of(const json_t *definitions, const char *name)
{
    size_t index;
    json_t *material;
    json_array_foreach(json_object_get(definitions, "materials"), index, material)
    {
        const char *its = json_string_value(json_object_get(material, "name"));
        if (its != NULL && strcmp(its, name) == 0)
            return material;
    }
    return NULL;
}

static bat_status put_materials(writer_3mf *writer, bat_error *error)
{
    const char *text = writer->mesh->material_json;
    json_t *definitions = NULL;
    if (writer->materials.count == 0)
        return BAT_OK;
    bat_status status = text != NULL ? json_parse(text, strlen(text), 0, 1, &definitions, error) : BAT_OK;
    text_append_string(&writer->model, "<basematerials id=\"1\">\n");
    for (size_t i = 0; i < writer->materials.count && status == BAT_OK; i++)
    {
        const char *name = writer->materials.labels[i].material;
        put_material(writer, name, definition_of(definitions, name));
    }
    text_append_string(&writer->model, "</basematerials>\n");
    json_decref(definitions);
    return status;
}

// Objects

/// Number the objects and the materials of the labels that faces have.
static bool number_names(writer_3mf *writer)
{
    const bat_mesh *mesh = writer->mesh;
    bool room = true;
    memset(writer->object_of, 0xff, mesh->label_count * sizeof *writer->object_of);
    memset(writer->material_of, 0xff, mesh->label_count * sizeof *writer->material_of);
    for (size_t f = 0; f < mesh->face_count && mesh->face_labels != NULL && room; f++)
    {
        uint32_t label = mesh->face_labels[f];
        const label_name object[MESH_LABEL_NAMES] = {label_name_of(mesh->labels[label].object)};
        const label_name material[MESH_LABEL_NAMES] = {{0}, {0}, label_name_of(mesh->labels[label].material)};
        if (writer->object_of[label] != BAT_MESH_NONE)
            continue;
        writer->object_of[label] = label_table_add(&writer->objects, object);
        if (material[2].begin != NULL)
            writer->material_of[label] = label_table_add(&writer->materials, material);
        room = writer->object_of[label] != BAT_MESH_NONE &&
               (material[2].begin == NULL || writer->material_of[label] != BAT_MESH_NONE);
    }
    writer->object_count = writer->objects.count > 0 ? writer->objects.count : 1;
    return room;
}

/// Find the object of each vertex: all are one object where two share a vertex, and lone vertices are of the first.
static bat_status part_vertices(writer_3mf *writer, const bat_mesh_write_options *options, bat_error *error)
{
    const bat_mesh *mesh = writer->mesh;
    memset(writer->vertex_object, 0xff, mesh->vertex_count * sizeof *writer->vertex_object);
    for (size_t h = 0; h < 3 * mesh->face_count && writer->object_count > 1; h++)
    {
        uint32_t *at = &writer->vertex_object[mesh->faces[h]], here = (uint32_t)object_of_face(writer, (uint32_t)(h / 3));
        if (*at != BAT_MESH_NONE && *at != here)
        {
            writer->object_count = 1;
            return mesh_note(options->notes, error, "the output has one object, because the %zu objects share vertices",
                             writer->objects.count);
        }
        *at = here;
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (writer->vertex_object[v] == BAT_MESH_NONE)
            writer->vertex_object[v] = 0;
    return BAT_OK;
}

static bat_status plan(writer_3mf *writer, const bat_mesh_write_options *options, bat_error *error)
{
    const bat_mesh *mesh = writer->mesh;
    writer->object_of = memory_pool_array(&writer->pool, mesh->label_count, sizeof *writer->object_of);
    writer->material_of = memory_pool_array(&writer->pool, mesh->label_count, sizeof *writer->material_of);
    writer->vertex_object = memory_pool_array(&writer->pool, mesh->vertex_count, sizeof *writer->vertex_object);
    writer->vertices = memory_pool_array(&writer->pool, mesh->vertex_count, sizeof *writer->vertices);
    writer->faces = memory_pool_array(&writer->pool, mesh->face_count, sizeof *writer->faces);
    if (writer->pool.missing > 0 || !number_names(writer))
        return no_memory(writer, error);
    bat_status status = part_vertices(writer, options, error);
    writer->vertices_until = memory_pool_array(&writer->pool, writer->object_count + 1, sizeof *writer->vertices_until);
    writer->faces_until = memory_pool_array(&writer->pool, writer->object_count + 1, sizeof *writer->faces_until);
    if (writer->pool.missing > 0)
        return no_memory(writer, error);
    counting_sort(NULL, mesh->vertex_count, object_of_vertex, writer, writer->object_count, writer->vertices_until,
                  writer->vertices);
    counting_sort(NULL, mesh->face_count, object_of_face, writer, writer->object_count, writer->faces_until, writer->faces);
    return status;
}

/// Append the vertices of an object, and keep the number of each in it in place of its object's.
static void put_vertices(writer_3mf *writer, size_t object)
{
    static const char *const NAMES[] = {"<vertex x=\"", "\" y=\"", "\" z=\""};
    size_t first = writer->vertices_until[object];
    for (size_t i = first; i < writer->vertices_until[object + 1]; i++)
    {
        for (size_t k = 0; k < 3; k++)
            text_append_real(&writer->model, NAMES[k], writer->mesh->positions[3 * writer->vertices[i] + k]);
        text_append_string(&writer->model, "\"/>\n");
        writer->vertex_object[writer->vertices[i]] = (uint32_t)(i - first);
    }
}

static void put_triangles(writer_3mf *writer, size_t object)
{
    static const char *const NAMES[] = {"<triangle v1=\"", " v2=\"", " v3=\""};
    const bat_mesh *mesh = writer->mesh;
    for (size_t i = writer->faces_until[object]; i < writer->faces_until[object + 1]; i++)
    {
        size_t face = writer->faces[i];
        uint32_t material = mesh->face_labels != NULL ? writer->material_of[mesh->face_labels[face]] : BAT_MESH_NONE;
        for (size_t c = 0; c < 3; c++)
            put_whole(&writer->model, NAMES[c], writer->vertex_object[mesh->faces[3 * face + c]]);
        if (material != BAT_MESH_NONE)
        {
            put_whole(&writer->model, " pid=\"", MATERIALS_ID);
            put_whole(&writer->model, " p1=\"", material);
        }
        text_append_string(&writer->model, "/>\n");
    }
}

static bat_status put_model(writer_3mf *writer, bat_error *error)
{
    text_buffer *model = &writer->model;
    text_append_string(model, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
                              "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>\n");
    bat_status status = put_materials(writer, error);
    for (size_t i = 0; i < writer->object_count && status == BAT_OK; i++)
    {
        bool own = writer->object_count == writer->objects.count && writer->objects.labels[i].object != NULL;
        put_whole(model, "<object type=\"model\" id=\"", FIRST_OBJECT_ID + i);
        if (own)
            put_text(model, " name=\"", writer->objects.labels[i].object);
        text_append_string(model, ">\n<mesh>\n<vertices>\n");
        put_vertices(writer, i);
        text_append_string(model, "</vertices>\n<triangles>\n");
        put_triangles(writer, i);
        text_append_string(model, "</triangles>\n</mesh>\n</object>\n");
    }
    text_append_string(model, "</resources>\n<build>\n");
    for (size_t i = 0; i < writer->object_count; i++)
    {
        put_whole(model, "<item objectid=\"", FIRST_OBJECT_ID + i);
        text_append_string(model, "/>\n");
    }
    text_append_string(model, "</build>\n</model>\n");
    return status;
}

/// Note names that have no place.
static bat_status note_groups(const bat_mesh *mesh, bat_mesh_notes *notes, bat_error *error)
{
    for (size_t i = 0; i < mesh->label_count && mesh->face_labels != NULL; i++)
        if (mesh->labels[i].group != NULL)
            return mesh_note(notes, error, "the output lacks names of groups: 3mf does not hold them");
    return BAT_OK;
}

bat_status mesh_3mf_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    writer_3mf writer = {.mesh = mesh};
    text_buffer types = {0}, relations = {0};
    bat_status status = plan(&writer, options, error);
    if (status == BAT_OK)
        status = note_groups(mesh, options->notes, error);
    if (status == BAT_OK)
        status = put_model(&writer, error);
    if (status == BAT_OK)
    {
        zip_writer archive = {.sink = sink};
        text_append_string(&types, CONTENT_TYPES);
        text_append_string(&relations, RELATIONS);
        status = zip_add(&archive, "[Content_Types].xml", &types, error);
        if (status == BAT_OK)
            status = zip_add(&archive, "_rels/.rels", &relations, error);
        if (status == BAT_OK)
            status = zip_add(&archive, "3D/3dmodel.model", &writer.model, error);
        status = zip_end(&archive, status, error);
    }
    text_free(&types);
    text_free(&relations);
    label_table_free(&writer.objects);
    label_table_free(&writer.materials);
    memory_pool_free(&writer.pool);
    text_free(&writer.model);
    return status;
}
