#include "io/mesh/gltf.h"

#include "base/file_bytes.h"
#include "io/common/base64.h"
#include "io/common/bytes.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/// @file
/// The JSON of a glTF file, and its buffers: the binary chunk, data URIs, or files beside it.

bool mesh_glb_resembles(const file_text *text)
{
    return text->size >= 4 && bytes_u32(text->data) == GLB_MAGIC;
}

/// An object whose member "asset" tells glTF from GeoJSON.
bool mesh_gltf_resembles(const file_text *text)
{
    json_scanner scan = {text->data, text->data + text->size}, key;
    if (!json_scan_take(&scan, '{'))
        return false;
    while (json_scan_key(&scan, &key))
        if (json_scan_is(&key, "asset"))
            return true;
        else if (!json_scan_value(&scan) || !json_scan_take(&scan, ','))
            return false;
    return false;
}

bat_status gltf_fault(gltf_place place, bat_error *error, const char *format, ...)
{
    char fault[BAT_ERROR_TEXT_SIZE / 2];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(fault, sizeof fault, format, arguments);
    va_end(arguments);
    if (place.index == SIZE_MAX)
        return ERROR_FILE(error, 0, "%s: %s", place.what, fault);
    return ERROR_FILE(error, 0, "%s %zu: %s", place.what, place.index, fault);
}

bat_status gltf_size(const json_t *object, const char *key, gltf_place place, size_t *value, bat_error *error)
{
    const json_t *member = json_object_get(object, key);
    if (member == NULL)
        return BAT_OK;
    double number = json_number_value(member);
    if (!json_is_number(member) || !(number >= 0 && number <= 0x1p53) || number != floor(number))
        return gltf_fault(place, error, "'%s' is no whole number of 0 or more", key);
    *value = size_clipped((uint64_t)number);
    return BAT_OK;
}

bat_status gltf_numbers(const json_t *object, const char *key, size_t count, gltf_place place, double *values,
                        bat_error *error)
{
    const json_t *member = json_object_get(object, key);
    if (member == NULL)
        return BAT_OK;
    bool good = json_array_size(member) == count;
    for (size_t i = 0; i < count && good; i++)
    {
        const json_t *number = json_array_get(member, i);
        good = json_is_number(number) && isfinite(json_number_value(number));
        if (good)
            values[i] = json_number_value(number);
    }
    return good ? BAT_OK : gltf_fault(place, error, "'%s' is no list of %zu numbers", key, count);
}

bat_status gltf_array(const json_t *object, const char *key, gltf_place place, const json_t **array, bat_error *error)
{
    *array = json_object_get(object, key);
    return *array == NULL || json_is_array(*array) ? BAT_OK : gltf_fault(place, error, "'%s' is no list", key);
}

bat_status gltf_element(const gltf_document *document, const char *array, const char *what, size_t index, json_t **element,
                        bat_error *error)
{
    const json_t *list = json_object_get(document->root, array);
    *element = json_array_get(list, index);
    if (*element == NULL)
        return ERROR_FILE(error, 0, "there is no %s %zu: the file has %zu %s", what, index, json_array_size(list), array);
    return json_is_object(*element) ? BAT_OK : gltf_fault((gltf_place){what, index}, error, "it is no object");
}

// The file

/// Find the chunks of a GLB file.
static bat_status read_chunks(const file_text *text, gltf_document *document, const char **json, size_t *json_size,
                              bat_error *error)
{
    const char *bytes = text->data;
    if (text->size < GLB_HEADER + GLB_CHUNK_HEADER)
        return ERROR_FILE(error, 0, "the file ends in the header of GLB");
    if (bytes_u32(bytes + 4) != GLB_VERSION)
        return ERROR_UNSUPPORTED(error, 0, "GLB of version %u is not read, only version 2", bytes_u32(bytes + 4));
    if (bytes_u32(bytes + 8) != text->size)
        return ERROR_FILE(error, 0, "the file has %zu bytes, but its header tells %u", text->size, bytes_u32(bytes + 8));
    size_t at = GLB_HEADER;
    for (size_t number = 0; text->size - at >= GLB_CHUNK_HEADER; number++)
    {
        size_t size = bytes_u32(bytes + at);
        uint32_t kind = bytes_u32(bytes + at + 4);
        at += GLB_CHUNK_HEADER;
        if (size > text->size - at)
            return ERROR_FILE(error, 0, "chunk %zu of GLB is longer than the file", number);
        if (number == 0 && kind != GLB_JSON)
            break;
        if (number == 0)
        {
            *json = bytes + at;
            *json_size = size;
        }
        else if (kind == GLB_BIN && document->chunk == NULL)
        {
            document->chunk = (const unsigned char *)bytes + at;
            document->chunk_size = size;
        }
        at += size;
    }
    return *json != NULL ? BAT_OK : ERROR_FILE(error, 0, "the first chunk of GLB is not JSON");
}

/// Whether batten reads files that require an extension. Extensions of materials are kept as they are.
static bool is_known_extension(const char *name)
{
    static const char *const known[] = {"KHR_mesh_quantization", "KHR_texture_",       "KHR_materials_", "KHR_lights_",
                                        "EXT_texture_",          "EXT_lights_",        "KHR_xmp_",       "KHR_xmp",
                                        "MSFT_texture_",         "KHR_node_visibility"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strncmp(name, known[i], strlen(known[i])) == 0)
            return true;
    return false;
}

static bat_status check_extensions(const json_t *root, bat_error *error)
{
    const json_t *required;
    bat_status status = gltf_array(root, "extensionsRequired", (gltf_place){"the file", SIZE_MAX}, &required, error);
    for (size_t i = 0; i < json_array_size(required) && status == BAT_OK; i++)
    {
        const char *name = json_string_value(json_array_get(required, i));
        char excerpt[EXCERPT_SIZE];
        if (name == NULL)
            return ERROR_FILE(error, 0, "'extensionsRequired' holds other values than texts");
        if (!is_known_extension(name))
            status = ERROR_UNSUPPORTED(
                error, 0, "the file requires the extension '%s'%s", text_excerpt(excerpt, name, name + strlen(name)),
                strstr(name, "draco") != NULL || strstr(name, "meshopt") != NULL ? ": compressed meshes are not read"
                                                                                 : ", which is not read");
    }
    return status;
}

static bat_status check_version(const json_t *root, bat_error *error)
{
    const json_t *asset = json_object_get(root, "asset");
    const char *minimum = json_string_value(json_object_get(asset, "minVersion"));
    const char *version = json_string_value(json_object_get(asset, "version"));
    char excerpt[EXCERPT_SIZE];
    if (version == NULL)
        return ERROR_FILE(error, 0, "there is no 'asset' with a 'version': the JSON is no glTF");
    if (minimum != NULL)
        version = minimum;
    if (strncmp(version, "2.", 2) != 0 || (minimum != NULL && strcmp(minimum, "2.0") != 0))
        return ERROR_UNSUPPORTED(error, 0, "glTF of version '%s' is not read, only version 2.0",
                                 text_excerpt(excerpt, version, version + strlen(version)));
    return BAT_OK;
}

bat_status gltf_open(const file_text *text, gltf_document *document, bat_error *error)
{
    *document = (gltf_document){.text = text, .total_size = text->size};
    bool binary = mesh_glb_resembles(text);
    const char *json = binary ? NULL : text->data;
    size_t size = text->size;
    json_scanner begin = {text->data, text->data + text->size};
    if (!binary && !json_scan_at(&begin, '{'))
        return ERROR_FILE(error, 0, "the file begins neither as GLB, with 'glTF', nor as JSON");
    bat_status status = binary ? read_chunks(text, document, &json, &size, error) : BAT_OK;
    if (status == BAT_OK)
        status = json_parse(json, size, 0, 1, &document->root, error);
    if (status != BAT_OK)
    {
        document->root = NULL;
        return status;
    }
    if (!json_is_object(document->root))
        return ERROR_FILE(error, 0, "the JSON is no object");
    status = check_version(document->root, error);
    if (status == BAT_OK)
        status = check_extensions(document->root, error);
    if (status != BAT_OK)
        return status;
    document->buffer_count = json_array_size(json_object_get(document->root, "buffers"));
    return array_zeros(&document->buffers, document->buffer_count, sizeof *document->buffers, error);
}

void gltf_close(gltf_document *document)
{
    for (size_t i = 0; i < document->buffer_count && document->buffers != NULL; i++)
        free(document->buffers[i].owned);
    free(document->buffers);
    json_decref(document->root);
    *document = (gltf_document){0};
}

// Buffers

/// Decode a data URI after "data:".
static bat_status decode_data(const char *uri, gltf_place place, gltf_buffer *buffer, bat_error *error)
{
    const char *comma = strchr(uri, ',');
    static const char encoding[] = ";base64";
    size_t size = sizeof encoding - 1;
    if (comma == NULL || (size_t)(comma - uri) < size || memcmp(comma - size, encoding, size) != 0)
        return gltf_fault(place, error, "its data URI is not in base64");
    text_buffer bytes = {0};
    bool decoded = base64_decode(&bytes, comma + 1, strlen(comma + 1));
    if (!decoded || bytes.failed)
    {
        text_free(&bytes);
        return decoded ? error_memory(error, strlen(uri)) : gltf_fault(place, error, "its data URI is invalid base64");
    }
    *buffer = (gltf_buffer){(const unsigned char *)bytes.data, bytes.size, bytes.data};
    return BAT_OK;
}

static int hex_value(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/// Append a URI with its percent escapes replaced (RFC 3986, section 2.1). False for an escaped zero byte.
static bool append_unescaped(text_buffer *path, const char *uri)
{
    for (const char *at = uri; *at != '\0'; at++)
    {
        char c = *at;
        int high = c == '%' ? hex_value(at[1]) : -1, low = high >= 0 ? hex_value(at[2]) : -1;
        if (low >= 0)
        {
            c = (char)(16 * high + low);
            at += 2;
        }
        if (c == '\0')
            return false;
        text_append(path, &c, 1);
    }
    return true;
}

/// Whether a path stays in its folder and the folders below.
static bool stays_below(const char *path)
{
    if (*path == '/' || *path == '\0' || strchr(path, ':') != NULL || strchr(path, '\\') != NULL)
        return false;
    for (const char *part = path; part != NULL; part = strchr(part, '/'))
    {
        part += *part == '/';
        if (strncmp(part, "..", 2) == 0 && (part[2] == '/' || part[2] == '\0'))
            return false;
    }
    return true;
}

bat_status gltf_bytes_read(const char *own, const char *uri, gltf_place place, gltf_buffer *buffer, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    if (strncmp(uri, "data:", 5) == 0)
        return decode_data(uri + 5, place, buffer, error);
    (void)text_excerpt(excerpt, uri, uri + strlen(uri));
    if (own == NULL || strcmp(own, "-") == 0)
        return gltf_fault(place, error, "its file '%s' cannot be found from bytes without a folder", excerpt);
    text_buffer path = {0}, bytes = {0};
    const char *slash = strrchr(own, '/');
    size_t folder = slash != NULL ? (size_t)(slash + 1 - own) : 0;
    text_append(&path, own, folder);
    bool plain = append_unescaped(&path, uri);
    text_append(&path, "", 1);
    bat_status status = BAT_OK;
    if (path.failed)
        status = error_memory(error, path.size);
    else if (!plain || !stays_below(path.data + folder))
        status = gltf_fault(place, error, "'%s' is no file in the folder of the mesh or below", excerpt);
    else
    {
        status = file_bytes_read(path.data, FILE_MAX_BYTES, &bytes, error);
        if (status != BAT_OK && status != BAT_NO_MEMORY)
        {
            char reason[BAT_ERROR_TEXT_SIZE / 2];
            (void)snprintf(reason, sizeof reason, "%.*s", (int)sizeof reason - 1, error != NULL ? error->text : "");
            (void)gltf_fault(place, error, "its file '%s': %s", excerpt, reason);
            if (error != NULL)
                error->status = status;
        }
    }
    text_free(&path);
    if (status == BAT_OK)
        *buffer = (gltf_buffer){(const unsigned char *)bytes.data, bytes.size, bytes.data};
    return status;
}

/// Load a buffer on its first use.
static bat_status load_buffer(gltf_document *document, size_t index, gltf_buffer **loaded, bat_error *error)
{
    gltf_place place = {"buffer", index};
    json_t *object;
    size_t size = SIZE_MAX;
    bat_status status = gltf_element(document, "buffers", "buffer", index, &object, error);
    if (status != BAT_OK)
        return status;
    *loaded = &document->buffers[index];
    if ((*loaded)->bytes != NULL)
        return BAT_OK;
    status = gltf_size(object, "byteLength", place, &size, error);
    if (status == BAT_OK && size == SIZE_MAX)
        status = gltf_fault(place, error, "'byteLength' is missing");
    if (status != BAT_OK)
        return status;
    const json_t *uri = json_object_get(object, "uri");
    gltf_buffer buffer = {0};
    if (uri == NULL && (json_object_get(json_object_get(object, "extensions"), "EXT_meshopt_compression") != NULL ||
                        json_object_get(json_object_get(object, "extensions"), "KHR_meshopt_compression") != NULL))
        return ERROR_UNSUPPORTED(error, 0, "buffer %zu exists only in the form of meshopt compression, which is not read",
                                 index);
    if (uri == NULL && index == 0 && document->chunk != NULL)
        buffer = (gltf_buffer){document->chunk, document->chunk_size, NULL};
    else if (!json_is_string(uri))
        status = gltf_fault(place, error, "it has neither 'uri' nor a binary chunk");
    else
        status = gltf_bytes_read(document->text->path, json_string_value(uri), place, &buffer, error);
    if (status == BAT_OK && buffer.size < size)
        status = gltf_fault(place, error, "it has %zu bytes instead of %zu", buffer.size, size);
    if (status != BAT_OK)
    {
        free(buffer.owned);
        return status;
    }
    static const unsigned char nothing[1] = {0};
    document->total_size += buffer.owned != NULL ? buffer.size : 0;
    buffer.size = size;
    if (buffer.bytes == NULL)
        buffer.bytes = nothing;
    **loaded = buffer;
    return BAT_OK;
}

bat_status gltf_view_find(gltf_document *document, size_t index, gltf_view *view, bat_error *error)
{
    gltf_place place = {"buffer view", index};
    json_t *object;
    gltf_buffer *buffer;
    size_t number = SIZE_MAX, offset = 0, size = SIZE_MAX, stride = 0;
    bat_status status = gltf_element(document, "bufferViews", "buffer view", index, &object, error);
    if (status == BAT_OK)
        status = gltf_size(object, "buffer", place, &number, error);
    if (status == BAT_OK)
        status = gltf_size(object, "byteOffset", place, &offset, error);
    if (status == BAT_OK)
        status = gltf_size(object, "byteLength", place, &size, error);
    if (status == BAT_OK)
        status = gltf_size(object, "byteStride", place, &stride, error);
    if (status == BAT_OK && (number == SIZE_MAX || size == SIZE_MAX))
        status = gltf_fault(place, error, "'%s' is missing", number == SIZE_MAX ? "buffer" : "byteLength");
    if (status == BAT_OK)
        status = load_buffer(document, number, &buffer, error);
    if (status == BAT_OK && (offset > buffer->size || size > buffer->size - offset))
        status = gltf_fault(place, error, "%zu bytes from byte %zu on are not within buffer %zu of %zu bytes", size, offset,
                            number, buffer->size);
    if (status == BAT_OK)
        *view = (gltf_view){buffer->bytes + offset, size, stride};
    return status;
}

// The numbers of accessors (glTF 2.0, section 3.6).

/// How numbers are stored.
typedef struct number_form
{
    gltf_type type;
    size_t size;
    bool normalized;
} number_form;

/// An accessor, checked against its buffer.
typedef struct accessor
{
    gltf_place place;
    const json_t *object;
    size_t count, components;
    number_form form;
    const unsigned char *bytes; ///< null: zeros
    size_t stride;
} accessor;

/// The number at some bytes, which are little-endian.
static double number_at(const unsigned char *bytes, number_form form)
{
    const uint32_t bits = (uint32_t)bytes_whole(bytes, form.size, false);
    if (form.type == GLTF_FLOAT)
        return bytes_real(bytes, sizeof(float), false);
    bool has_sign = form.type == GLTF_INT8 || form.type == GLTF_INT16;
    double value = !has_sign ? (double)bits : form.size == 1 ? (int8_t)bits : (int16_t)bits;
    double greatest = ldexp(1, (int)(8 * form.size) - has_sign) - 1;
    return form.normalized ? fmax(value / greatest, -1) : value;
}

static bat_status read_form(const json_t *object, gltf_place place, number_form *form, bat_error *error)
{
    static const size_t SIZES[] = {1, 1, 2, 2, 0, 4, 4}; // from GLTF_INT8 on; there is no type 5124
    size_t type = 0;
    bat_status status = gltf_size(object, "componentType", place, &type, error);
    form->type = (gltf_type)type;
    form->size = type >= GLTF_INT8 && type <= GLTF_FLOAT ? SIZES[type - GLTF_INT8] : 0;
    form->normalized = json_is_true(json_object_get(object, "normalized"));
    if (status == BAT_OK && form->size == 0)
        status = gltf_fault(place, error, "%zu is no 'componentType'", type);
    if (status == BAT_OK && form->normalized && form->size == 4)
        status = gltf_fault(place, error, "its numbers cannot be normalized");
    return status;
}

static size_t components_of(const json_t *object)
{
    static const char *const names[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const char *type = json_string_value(json_object_get(object, "type"));
    for (size_t i = 0; i < sizeof names / sizeof *names && type != NULL; i++)
        if (strcmp(type, names[i]) == 0)
            return i + 1;
    return 0;
}

/// Find `count` elements of `size` bytes in a view from byte `offset` on.
static bat_status find_elements(const gltf_view *view, size_t offset, size_t count, size_t size, gltf_place place,
                                const unsigned char **bytes, size_t *stride, bat_error *error)
{
    static const int MAX_STRIDE = 252;
    *stride = view->stride > 0 ? view->stride : size;
    if (*stride == 0 || *stride < size || *stride > MAX_STRIDE)
        return gltf_fault(place, error, "a 'byteStride' of %zu for elements of %zu bytes", *stride, size);
    if (offset > view->size || size > view->size - offset || (count - 1) > (view->size - offset - size) / *stride)
        return gltf_fault(place, error, "its %zu elements are not within the %zu bytes of their buffer view", count,
                          view->size);
    *bytes = view->bytes + offset;
    return BAT_OK;
}

static bat_status accessor_find(gltf_document *document, size_t index, const gltf_wish *wish, accessor *found,
                                bat_error *error)
{
    json_t *object;
    size_t view_index = SIZE_MAX, offset = 0;
    *found = (accessor){.place = {"accessor", index}};
    bat_status status = gltf_element(document, "accessors", "accessor", index, &object, error);
    if (status != BAT_OK)
        return status;
    found->object = object;
    found->components = components_of(object);
    status = read_form(object, found->place, &found->form, error);
    if (status == BAT_OK)
        status = gltf_size(object, "count", found->place, &found->count, error);
    if (status == BAT_OK)
        status = gltf_size(object, "bufferView", found->place, &view_index, error);
    if (status == BAT_OK)
        status = gltf_size(object, "byteOffset", found->place, &offset, error);
    if (status != BAT_OK)
        return status;
    const number_form *form = &found->form;
    if (found->components < wish->min_components || found->components > wish->max_components)
        return gltf_fault(found->place, error, "its 'type' does not suit its use");
    if (wish->whole && (form->normalized || form->type == GLTF_FLOAT || form->type == GLTF_INT8 || form->type == GLTF_INT16))
        return gltf_fault(found->place, error, "indices must be unsigned whole numbers");
    if (found->count == 0)
        return gltf_fault(found->place, error, "'count' is missing or 0");
    if (view_index != SIZE_MAX)
    {
        gltf_view view;
        status = gltf_view_find(document, view_index, &view, error);
        return status == BAT_OK ? find_elements(&view, offset, found->count, found->components * form->size, found->place,
                                                &found->bytes, &found->stride, error)
                                : status;
    }
    if (json_object_get(object, "sparse") == NULL)
        return gltf_fault(found->place, error, "it has no 'bufferView'");
    return found->count <= document->total_size
               ? BAT_OK
               : gltf_fault(found->place, error, "%zu elements are too many for the file", found->count);
}

/// Find one of the two lists of a sparse accessor.
static bat_status sparse_find(gltf_document *document, const json_t *list, const accessor *owner, size_t count, size_t size,
                              const unsigned char **bytes, size_t *stride, bat_error *error)
{
    size_t index = SIZE_MAX, offset = 0;
    gltf_view view;
    bat_status status = gltf_size(list, "bufferView", owner->place, &index, error);
    if (status == BAT_OK)
        status = gltf_size(list, "byteOffset", owner->place, &offset, error);
    if (status == BAT_OK && index == SIZE_MAX)
        status = gltf_fault(owner->place, error, "'sparse' lacks a 'bufferView'");
    if (status == BAT_OK)
        status = gltf_view_find(document, index, &view, error);
    return status == BAT_OK ? find_elements(&view, offset, count, size, owner->place, bytes, stride, error) : status;
}

static bat_status insert_sparse(gltf_document *document, const accessor *owner, double *numbers, bat_error *error)
{
    const json_t *sparse = json_object_get(owner->object, "sparse");
    const json_t *indices = json_object_get(sparse, "indices");
    const unsigned char *index_bytes = NULL, *value_bytes = NULL;
    size_t count = 0, index_stride = 0, value_stride = 0, before = 0;
    number_form index_form = {0};
    if (sparse == NULL)
        return BAT_OK;
    bat_status status = gltf_size(sparse, "count", owner->place, &count, error);
    if (status == BAT_OK && (count == 0 || count > owner->count))
        status = gltf_fault(owner->place, error, "'sparse' has a 'count' of %zu for %zu elements", count, owner->count);
    if (status == BAT_OK)
        status = read_form(indices, owner->place, &index_form, error);
    if (status == BAT_OK && (index_form.type == GLTF_FLOAT || index_form.type == GLTF_INT8 || index_form.type == GLTF_INT16))
        status = gltf_fault(owner->place, error, "indices must be unsigned whole numbers");
    if (status == BAT_OK)
        status = sparse_find(document, indices, owner, count, index_form.size, &index_bytes, &index_stride, error);
    size_t size = owner->form.size;
    if (status == BAT_OK)
        status = sparse_find(document, json_object_get(sparse, "values"), owner, count, owner->components * size,
                             &value_bytes, &value_stride, error);
    index_form.normalized = false;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        size_t row = (size_t)number_at(index_bytes + i * index_stride, index_form);
        if (row >= owner->count || (i > 0 && row <= before))
            return gltf_fault(owner->place, error, "index %zu of 'sparse' is out of range or out of order", row);
        for (size_t k = 0; k < owner->components; k++)
            numbers[row * owner->components + k] = number_at(value_bytes + i * value_stride + k * size, owner->form);
        before = row;
    }
    return status;
}

bat_status gltf_values_read(gltf_document *document, size_t index, const gltf_wish *wish, gltf_values *values,
                            bat_error *error)
{
    accessor found;
    bat_status status = accessor_find(document, index, wish, &found, error);
    if (status != BAT_OK)
        return status;
    size_t width = found.components, size = found.form.size;
    double *numbers = memory_array(found.count, width * sizeof *numbers);
    if (numbers == NULL)
        return error_memory(error, found.count * width * sizeof *numbers);
    for (size_t i = 0; i < found.count; i++)
        for (size_t k = 0; k < width; k++)
            numbers[i * width + k] =
                found.bytes != NULL ? number_at(found.bytes + i * found.stride + k * size, found.form) : 0.0;
    status = insert_sparse(document, &found, numbers, error);
    for (size_t i = 0; i < found.count * width && status == BAT_OK; i++)
        if (!isfinite(numbers[i]))
            status = gltf_fault(found.place, error, "number %zu of element %zu is not finite", i % width, i / width);
    if (status == BAT_OK)
        *values = (gltf_values){numbers, found.count, width};
    else
        free(numbers);
    return status;
}

void gltf_values_free(gltf_values *values)
{
    free(values->numbers);
    *values = (gltf_values){0};
}
