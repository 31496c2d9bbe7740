#include "io/mesh/formats.h"

#include "base/hash.h"
#include "base/utf8.h"

/// @file
/// Labels by the hashes of their names.

static void label_free(bat_mesh_label *label)
{
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
        free(*mesh_label_name(label, k));
}

void label_table_free(label_table *table)
{
    for (size_t i = 0; i < table->count; i++)
        label_free(&table->labels[i]);
    free(table->labels);
    key_map_free(&table->numbers);
    *table = (label_table){0};
}

static uint64_t hash_label(const bat_mesh_label *label)
{
    uint64_t hash = HASH_BEGIN;
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
    {
        const char *text = mesh_label_text(label, k);
        size_t size = text != NULL ? strlen(text) : SIZE_MAX;
        hash = hash_bytes(hash, &size, sizeof size);
        if (text != NULL)
            hash = hash_bytes(hash, text, size);
    }
    return hash;
}

static bool same_label(const bat_mesh_label *a, const bat_mesh_label *b)
{
    bool same = true;
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
        same = same && mesh_text_equals(mesh_label_text(a, k), mesh_label_text(b, k));
    return same;
}

/// The place of a label's number in the map, UINT32_MAX for a new one. Equal hashes follow each other. Null: no memory.
static uint32_t *place_of(label_table *table, const bat_mesh_label *label)
{
    for (uint64_t key = hash_label(label);; key++)
    {
        uint32_t *place = key_map_at(&table->numbers, key != KEY_MAP_NO_KEY ? key : 0);
        if (place == NULL || *place == UINT32_MAX || same_label(&table->labels[*place], label))
            return place;
    }
}

char *label_name_copy(label_name name)
{
    const unsigned char *from = (const unsigned char *)name.begin;
    size_t size = strnlen(name.begin, name.size);
    bool valid = true;
    for (size_t i = 0, step; i < size && valid; i += step)
    {
        step = utf8_size(from + i, size - i);
        valid = step > 0;
    }
    char *copy = malloc(2 * size + 1), *out = copy;
    for (size_t i = 0; i < size && copy != NULL; i++)
    {
        unsigned char c = from[i] < ' ' || from[i] == 0x7f ? '_' : from[i];
        if (!valid && c >= 0x80)
        {
            *out++ = (char)(0xc0 | c >> 6);
            c = 0x80 | (c & 0x3f);
        }
        *out++ = (char)c;
    }
    if (copy != NULL)
        *out = '\0';
    return copy;
}

bool label_name_taken(const char *name, const void *rows, size_t size, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(*(char *const *)(const void *)((const char *)rows + i * size), name) == 0)
            return true;
    return false;
}

char *label_name_unique(const char *given, bool numbered, const void *rows, size_t size, size_t count)
{
    char *name = label_name_copy(label_name_of(given));
    if (name == NULL || (!numbered && !label_name_taken(name, rows, size, count)))
        return name;
    size_t room = strlen(name) + 24;
    char *longer = malloc(room);
    for (size_t number = count; longer != NULL; number++)
    {
        (void)snprintf(longer, room, "%s_%zu", name, number);
        if (!label_name_taken(longer, rows, size, count))
            break;
    }
    free(name);
    return longer;
}

uint32_t label_table_add(label_table *table, const label_name names[MESH_LABEL_NAMES])
{
    bat_mesh_label label = {0};
    bool room = ARRAY_GROW(table->labels, table->capacity, table->count + 1);
    for (int k = 0; k < MESH_LABEL_NAMES && room; k++)
        if (names[k].begin != NULL)
        {
            *mesh_label_name(&label, k) = label_name_copy(names[k]);
            room = mesh_label_text(&label, k) != NULL;
        }
    uint32_t *place = room ? place_of(table, &label) : NULL;
    if (place == NULL || *place != UINT32_MAX)
    {
        label_free(&label);
        return place != NULL ? *place : BAT_MESH_NONE;
    }
    *place = (uint32_t)table->count;
    table->labels[table->count++] = label;
    return *place;
}
