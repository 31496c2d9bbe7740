#include "io/mesh/gltf.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// The numbers of accessors (glTF 2.0, section 3.6).

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

static size_t size_of_type(size_t type)
{
    switch (type)
    {
    case GLTF_INT8:
    case GLTF_UINT8:
        return 1;
    case GLTF_INT16:
    case GLTF_UINT16:
        return 2;
    case GLTF_UINT32:
    case GLTF_FLOAT:
        return 4;
    default:
        return 0;
    }
}

/// The number at some bytes, which are little-endian.
static double number_at(const unsigned char *bytes, number_form form)
{
    uint32_t bits = 0;
    float real;
    for (size_t i = 0; i < form.size; i++)
        bits |= (uint32_t)bytes[i] << 8 * i;
    switch (form.type)
    {
    case GLTF_INT8:
        return form.normalized ? fmax((int8_t)bits / (double)INT8_MAX, -1) : (int8_t)bits;
    case GLTF_INT16:
        return form.normalized ? fmax((int16_t)bits / (double)INT16_MAX, -1) : (int16_t)bits;
    case GLTF_UINT8:
        return form.normalized ? bits / (double)UINT8_MAX : bits;
    case GLTF_UINT16:
        return form.normalized ? bits / (double)UINT16_MAX : bits;
    case GLTF_FLOAT:
        memcpy(&real, &bits, sizeof real);
        return real;
    case GLTF_UINT32:
        break;
    }
    return bits;
}

static bat_status read_form(const json_t *object, gltf_place place, number_form *form, bat_error *error)
{
    size_t type = 0;
    bat_status status = gltf_size(object, "componentType", place, &type, error);
    form->type = (gltf_type)type;
    form->size = size_of_type(type);
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
    enum
    {
        MAX_STRIDE = 252
    };
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
        if (status == BAT_OK)
            status = find_elements(&view, offset, found->count, found->components * form->size, found->place, &found->bytes,
                                   &found->stride, error);
        return status;
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

/// Insert the values of a sparse accessor.
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
