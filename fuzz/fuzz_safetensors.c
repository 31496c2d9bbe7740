#include "learn/safetensors.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/// Read every array as numbers, of any type.
static void convert_all(const safetensors *content)
{
    for (size_t i = 0; i < content->array_count; i++)
    {
        const safetensors_array *array = &content->arrays[i];
        void *values = malloc(array->count * sizeof(double) + 1);
        if (values == NULL)
            continue;
        (void)safetensors_doubles(content, array->name, array->count, values, NULL);
        (void)safetensors_integers(content, array->name, array->count, values, NULL);
        free(values);
    }
}

/// What was read can be written and is preserved.
static void write_and_read(const safetensors *content)
{
    text_buffer bytes = {0};
    safetensors again;
    if (safetensors_encode(content, &bytes, NULL) != BAT_OK ||
        safetensors_parse(bytes.data, bytes.size, &again, NULL) != BAT_OK || again.array_count != content->array_count)
        abort();
    for (size_t i = 0; i < again.array_count; i++)
    {
        const safetensors_array *a = &content->arrays[i], *b = &again.arrays[i];
        size_t size = a->count * safetensors_element_size(a->type);
        if (strcmp(a->name, b->name) != 0 || a->count != b->count || (size > 0 && memcmp(a->values, b->values, size) != 0))
            abort();
    }
    safetensors_free(&again);
    text_free(&bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    safetensors content;
    if (safetensors_parse(bytes, size, &content, NULL) == BAT_OK)
    {
        convert_all(&content);
        write_and_read(&content);
        safetensors_free(&content);
    }
    return 0;
}
