#include "batten/mesh_picture.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/memory.h"
#include "draw/common/sheet.h"
#include "io/common/base64.h"
#include "io/common/json.h"

#include <cairo.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Images that were baked as PNG files, and as the textures of a glTF material.

static cairo_status_t append(void *to, const unsigned char *bytes, unsigned size)
{
    text_append(to, (const char *)bytes, size);
    return ((text_buffer *)to)->failed ? CAIRO_STATUS_NO_MEMORY : CAIRO_STATUS_SUCCESS;
}

/// Append an image as PNG.
static bat_status append_png(const bat_mesh_image *image, text_buffer *bytes, bat_error *error)
{
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)image->width, (int)image->height);
    unsigned char *rows = cairo_image_surface_get_data(surface);
    size_t stride = (size_t)cairo_image_surface_get_stride(surface);
    for (size_t i = 0; i < image->width * image->height && rows != NULL; i++)
    {
        const unsigned char *pixel = image->pixels + 3 * i;
        uint32_t packed = (uint32_t)pixel[0] << 16 | (uint32_t)pixel[1] << 8 | pixel[2];
        memcpy(rows + i / image->width * stride + i % image->width * sizeof packed, &packed, sizeof packed);
    }
    cairo_surface_mark_dirty(surface);
    cairo_status_t status = cairo_surface_write_to_png_stream(surface, append, bytes);
    cairo_surface_destroy(surface);
    return status == CAIRO_STATUS_SUCCESS ? BAT_OK : error_memory(error, 4 * image->width * image->height);
}

bat_status bat_mesh_image_write(const char *path, const bat_mesh_image *image, bat_error *error)
{
    text_buffer bytes = {0};
    if (image->pixels == NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the image has no pixels");
    bat_status status = append_png(image, &bytes, error);
    if (status == BAT_OK)
        status = atomic_file_write(path, bytes.data, bytes.size, error);
    text_free(&bytes);
    return status;
}

/// Add an image to the arrays of a glTF file. Returns a texture reference, null when out of memory.
static json_t *add_texture(json_t *root, const bat_mesh_image *image)
{
    text_buffer bytes = {0}, uri = {0};
    json_t *images = json_object_get(root, "images"), *textures = json_object_get(root, "textures");
    size_t index = json_array_size(textures);
    bool made = append_png(image, &bytes, NULL) == BAT_OK;
    text_append_string(&uri, "data:image/png;base64,");
    if (made)
        base64_append(&uri, bytes.data, bytes.size);
    made = made && !uri.failed &&
           json_array_append_new(images, json_pack("{s:o}", "uri", json_stringn(uri.data, uri.size))) == 0 &&
           json_array_append_new(
               textures, json_pack("{s:I, s:i}", "source", (json_int_t)json_array_size(images) - 1, "sampler", 0)) == 0;
    text_free(&bytes);
    text_free(&uri);
    return made ? json_pack("{s:I}", "index", (json_int_t)index) : NULL;
}

/// Give all faces the material of this name, in place of theirs.
static bool name_material(bat_mesh *mesh, const char *name)
{
    if (mesh->face_labels == NULL)
    {
        mesh->labels = calloc(1, sizeof *mesh->labels);
        mesh->face_labels = calloc(mesh->face_count, sizeof *mesh->face_labels);
        mesh->label_count = mesh->labels != NULL;
        if (mesh->labels == NULL || mesh->face_labels == NULL)
            return false;
    }
    for (size_t i = 0; i < mesh->label_count; i++)
    {
        char *copy = strdup(name);
        if (copy == NULL)
            return false;
        free(mesh->labels[i].material);
        mesh->labels[i].material = copy;
    }
    return true;
}

bat_status bat_mesh_baked_attach(const bat_mesh_baked *baked, bat_mesh *mesh, bat_error *error)
{
    const struct
    {
        const bat_mesh_image *image;
        const char *key;
    } parts[] = {{&baked->normal, "normalTexture"}, {&baked->occlusion, "occlusionTexture"}};
    json_t *shading = json_pack("{s:i, s:i}", "metallicFactor", 0, "roughnessFactor", 1);
    json_t *material = json_pack("{s:s, s:O}", "name", "baked", "pbrMetallicRoughness", shading);
    json_t *root = json_pack("{s:[O], s:[], s:[], s:[{s:i, s:i}]}", "materials", material, "textures", "images", "samplers",
                             "magFilter", 9729, "minFilter", 9987);
    bool made = root != NULL;
    if (made && baked->colour.pixels != NULL)
        made = json_object_set_new(shading, "baseColorTexture", add_texture(root, &baked->colour)) == 0;
    for (size_t i = 0; i < sizeof parts / sizeof *parts && made; i++)
        if (parts[i].image->pixels != NULL)
            made = json_object_set_new(material, parts[i].key, add_texture(root, parts[i].image)) == 0;
    char *text = made ? json_text_make(root) : NULL;
    json_decref(shading);
    json_decref(material);
    json_decref(root);
    if (text == NULL || !name_material(mesh, "baked"))
    {
        free(text);
        return error_memory(error, mesh->face_count);
    }
    free(mesh->material_json);
    mesh->material_json = text;
    return BAT_OK;
}
