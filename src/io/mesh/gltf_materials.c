#include "io/mesh/gltf.h"

#include "base/error.h"
#include "io/common/base64.h"
#include "io/mesh/formats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Materials of glTF as a JSON text that needs no buffers.

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
    text_append_string(&text, "data:");
    text_append_string(&text, type != NULL ? type : "image/png");
    text_append_string(&text, ";base64,");
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

/// Whether one of the first names is the same.
static bool is_taken(char *const *names, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return false;
}

/// A name for material `index` that no earlier one has: its own, or with a number. Null when out of memory.
static char *unique_name(char *const *names, size_t index, const json_t *material)
{
    const json_t *given = json_object_get(material, "name");
    const char *own = json_is_string(given) && json_string_length(given) > 0 ? json_string_value(given) : "material";
    char *name = label_name_copy((label_name){own, strlen(own)});
    bool numbered = own != json_string_value(given);
    if (name == NULL || (!numbered && !is_taken(names, index, name)))
        return name;
    size_t size = strlen(name) + 24;
    char *longer = malloc(size);
    for (size_t number = index; longer != NULL; number++)
    {
        (void)snprintf(longer, size, "%s_%zu", name, number);
        if (!is_taken(names, index, longer))
            break;
    }
    free(name);
    return longer;
}

/// Name all materials of `made`.
static bat_status name_materials(json_t *materials, char ***names, bat_error *error)
{
    static const int MAX_MATERIALS = 1 << 14; ///< names are compared in pairs
    size_t count = json_array_size(materials);
    if (count > MAX_MATERIALS)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "there are %zu materials, more than %d", count,
                         MAX_MATERIALS);
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
        made[i] = unique_name(made, i, material);
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
        text_buffer buffer = {0};
        json_text(&buffer, made);
        text_append(&buffer, "", 1);
        if (buffer.failed)
        {
            status = error_memory(error, buffer.size);
            text_free(&buffer);
        }
        text = buffer.data;
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
