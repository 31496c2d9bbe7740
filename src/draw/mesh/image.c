#include "batten/mesh_picture.h"

#include "base/atomic_file.h"
#include "draw/common/sheet.h"
#include "io/common/base64.h"
#include "io/gis/gis.h"
#include "io/mesh/gltf.h"
#include "mesh/labels.h"

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

static cairo_status_t take(void *from, unsigned char *bytes, unsigned size)
{
    gltf_buffer *left = from;
    if (left->size < size)
        return CAIRO_STATUS_READ_ERROR;
    memcpy(bytes, left->bytes, size);
    left->bytes += size;
    left->size -= size;
    return CAIRO_STATUS_SUCCESS;
}

/// Whether the header of PNG names more pixels than are read.
static bool is_too_large(gltf_buffer png)
{
    double sides[2] = {0};
    for (size_t i = 0; i < 8 && png.size >= 24; i++)
        sides[i / 4] = 256 * sides[i / 4] + png.bytes[16 + i];
    return png.size >= 24 && memcmp(png.bytes + 1, "PNG", 3) == 0 && sides[0] * sides[1] > IMAGE_MAX_PIXELS;
}

/// Decode PNG. Returns whether nothing is lost, as colours of transparent pixels are. No pixels: it cannot be decoded.
static bool decode_png(gltf_buffer bytes, bat_mesh_image *image)
{
    cairo_surface_t *surface = cairo_image_surface_create_from_png_stream(take, &bytes);
    cairo_format_t format = cairo_image_surface_get_format(surface);
    bool opaque = format == CAIRO_FORMAT_RGB24, good = opaque || format == CAIRO_FORMAT_ARGB32;
    const unsigned char *rows = good ? cairo_image_surface_get_data(surface) : NULL; // without padding
    size_t width = (size_t)cairo_image_surface_get_width(surface), height = (size_t)cairo_image_surface_get_height(surface);
    *image = (bat_mesh_image){rows != NULL ? memory_array(width * height, 3) : NULL, width, height};
    for (size_t i = 0; i < width * height && image->pixels != NULL; i++)
    {
        uint32_t packed;
        memcpy(&packed, rows + 4 * i, sizeof packed);
        uint32_t alpha = opaque ? UINT8_MAX : packed >> 24, divisor = alpha > 0 ? alpha : 1;
        for (uint32_t k = 0; k < 3; k++)
            image->pixels[3 * i + k] =
                (unsigned char)(((packed >> (16 - 8 * k) & UINT8_MAX) * UINT8_MAX + alpha / 2) / divisor);
    }
    cairo_surface_destroy(surface);
    return opaque && image->pixels != NULL;
}

bat_status bat_mesh_image_read(const char *uri, const char *mesh, bat_mesh_image *image, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    gltf_buffer bytes = {0};
    bat_error own = {0};
    bat_mesh_image made;
    bat_status status = gltf_bytes_read(mesh, uri, (gltf_place){"an image", SIZE_MAX}, &bytes, error);
    if (status != BAT_OK)
        return status;
    if (is_too_large(bytes))
        status = ERROR_TOO_LARGE(&own, "its pixels are more than %d", IMAGE_MAX_PIXELS);
    else if (!decode_png(bytes, &made) && gis_image_read(bytes.bytes, bytes.size, &made, &own) != BAT_OK &&
             made.pixels == NULL)
        status = own.status;
    free(bytes.owned);
    if (status != BAT_OK)
        return error_set(error, status, BAT_NO_INDEX, 0, "the image '%s' is not read: %.160s; save it as PNG",
                         text_excerpt(excerpt, uri, uri + strlen(uri)), own.text);
    *image = made;
    return BAT_OK;
}

bat_status bat_mesh_image_write(const char *path, const bat_mesh_image *image, bat_error *error)
{
    text_buffer bytes = {0};
    if (image->pixels == NULL)
        return ERROR_ARGUMENT(error, "the image has no pixels");
    bat_status status = append_png(image, &bytes, error);
    if (status == BAT_OK)
        status = atomic_file_write(path, bytes.data, bytes.size, error);
    text_free(&bytes);
    return status;
}

/// A member of an object, which is made where it is missing or of another type. Null when out of memory.
static json_t *member_of(json_t *object, const char *key, json_type type)
{
    json_t *member = json_object_get(object, key);
    if (member != NULL && json_typeof(member) == type)
        return member;
    member = type == JSON_ARRAY ? json_array() : json_object();
    return json_object_set_new(object, key, member) == 0 ? member : NULL;
}

/// Add an image to the arrays of a glTF file. Returns a texture reference, null when out of memory.
static json_t *add_texture(json_t *root, const bat_mesh_image *image)
{
    text_buffer bytes = {0}, uri = {0};
    json_t *images = member_of(root, "images", JSON_ARRAY), *textures = member_of(root, "textures", JSON_ARRAY),
           *samplers = member_of(root, "samplers", JSON_ARRAY);
    bool made = append_png(image, &bytes, NULL) == BAT_OK;
    text_append_string(&uri, "data:image/png;base64,");
    if (made)
        base64_append(&uri, bytes.data, bytes.size);
    made = made && !uri.failed &&
           json_array_append_new(images, json_pack("{s:o}", "uri", json_stringn(uri.data, uri.size))) == 0 &&
           json_array_append_new(samplers, json_pack("{s:i, s:i}", "magFilter", 9729, "minFilter", 9987)) == 0 &&
           json_array_append_new(textures, json_pack("{s:I, s:I}", "source", (json_int_t)json_array_size(images) - 1,
                                                     "sampler", (json_int_t)json_array_size(samplers) - 1)) == 0;
    text_free(&bytes);
    text_free(&uri);
    return made ? json_pack("{s:I}", "index", (json_int_t)json_array_size(textures) - 1) : NULL;
}

/// Leave out the textures of a material, also within its extensions.
static void drop_textures(json_t *value)
{
    static const char ending[] = "exture";
    const char *key;
    json_t *member;
    void *next;
    json_object_foreach_safe(value, next, key, member)
    {
        size_t size = strlen(key), tail = sizeof ending - 1;
        drop_textures(member);
        if (size >= tail && strcmp(key + size - tail, ending) == 0)
            (void)json_object_del(value, key);
    }
}

/// Give faces without a material the one called "baked", and define those that have only a name.
static bool define_materials(json_t *materials, bat_mesh *mesh)
{
    if (mesh->face_labels == NULL)
    {
        mesh->labels = calloc(1, sizeof *mesh->labels);
        mesh->face_labels = calloc(mesh->face_count, sizeof *mesh->face_labels);
        mesh->label_count = mesh->labels != NULL;
        if (mesh->labels == NULL || mesh->face_labels == NULL)
            return false;
    }
    bool room = true;
    for (size_t i = 0; i < mesh->label_count && room; i++)
    {
        char **name = &mesh->labels[i].material;
        bool defined = false;
        *name = *name != NULL ? *name : strdup("baked");
        for (size_t k = 0; k < json_array_size(materials) && *name != NULL && !defined; k++)
        {
            const char *other = json_string_value(json_object_get(json_array_get(materials, k), "name"));
            defined = other != NULL && strcmp(other, *name) == 0;
        }
        room = *name != NULL &&
               (defined ||
                json_array_append_new(materials, json_pack("{s:s, s:{s:i, s:i}}", "name", *name, "pbrMetallicRoughness",
                                                           "metallicFactor", 0, "roughnessFactor", 1)) == 0);
    }
    return room;
}

/// Leave out the colours of vertices.
static void drop_colours(bat_mesh *mesh)
{
    size_t places[MESH_COLOURS], count = mesh->channel_count, colours = mesh_colours(mesh, places), kept = 0;
    for (size_t i = 0; i < (mesh->vertex_count + 1) * count; i++)
    {
        bool names = i >= mesh->vertex_count * count, colour = false;
        kept = i == mesh->vertex_count * count ? 0 : kept;
        for (size_t k = 0; k < colours; k++)
            colour = colour || places[k] == i % count;
        if (names && colour)
            free(mesh->channel_names[i % count]);
        else if (names)
            mesh->channel_names[kept++] = mesh->channel_names[i % count];
        else if (!colour)
            mesh->channels[kept++] = mesh->channels[i];
    }
    mesh->channel_count = kept;
}

bat_status bat_mesh_baked_attach(const bat_mesh_baked *baked, bat_mesh *mesh, bat_error *error)
{
    static const char *const keys[] = {"baseColorTexture", "normalTexture", "occlusionTexture"};
    const bat_mesh_image *const images[] = {&baked->colour, &baked->normal, &baked->occlusion};
    json_t *own = NULL;
    if (mesh->material_json != NULL)
        (void)json_parse(mesh->material_json, strlen(mesh->material_json), 0, 1, &own, NULL);
    json_t *root = json_is_object(own) ? json_incref(own) : json_object();
    json_decref(own);
    json_t *materials = member_of(root, "materials", JSON_ARRAY);
    if (baked->charts > 0) // the texture coordinates of the materials' own images are gone
    {
        static const char *const gone[] = {"textures", "images", "samplers"};
        for (size_t k = 0; k < sizeof gone / sizeof *gone; k++)
            (void)json_object_del(root, gone[k]);
        for (size_t i = 0; i < json_array_size(materials); i++)
            drop_textures(json_array_get(materials, i));
    }
    bool made = materials != NULL && define_materials(materials, mesh);
    for (size_t k = 0; k < sizeof keys / sizeof *keys && made; k++)
    {
        json_t *texture = images[k]->pixels != NULL ? add_texture(root, images[k]) : NULL;
        made = texture != NULL || images[k]->pixels == NULL;
        for (size_t i = 0; i < json_array_size(materials) && texture != NULL && made; i++)
        {
            json_t *material = json_array_get(materials, i);
            made = json_object_set(k == 0 ? member_of(material, "pbrMetallicRoughness", JSON_OBJECT) : material, keys[k],
                                   texture) == 0;
        }
        json_decref(texture);
    }
    char *text = made ? json_text_make(root) : NULL;
    json_decref(root);
    if (text == NULL)
        return error_memory(error, mesh->face_count);
    if (baked->colour.pixels != NULL) // glTF multiplies both
        drop_colours(mesh);
    free(mesh->material_json);
    mesh->material_json = text;
    return BAT_OK;
}
