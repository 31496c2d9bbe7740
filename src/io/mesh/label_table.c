#include "io/mesh/label_table.h"

#include "base/array_grow.h"
#include "base/hash.h"

#include <string.h>

/// @file
/// A hash table with linear probing; its keys are the names of labels.

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
    free(table->slots);
    *table = (label_table){0};
}

static uint64_t hash_names(const label_name names[MESH_LABEL_NAMES])
{
    uint64_t hash = HASH_BEGIN;
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
    {
        hash = hash_bytes(hash, &names[k].size, sizeof names[k].size);
        if (names[k].begin != NULL)
            hash = hash_bytes(hash, names[k].begin, names[k].size);
    }
    return hash;
}

static bool has_names(const bat_mesh_label *label, const label_name names[MESH_LABEL_NAMES])
{
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
    {
        const char *text = mesh_label_text(label, k);
        if ((text == NULL) != (names[k].begin == NULL))
            return false;
        if (text != NULL && (strlen(text) != names[k].size || memcmp(text, names[k].begin, names[k].size) != 0))
            return false;
    }
    return true;
}

/// Put a label number into its slot.
static void put(label_table *table, uint32_t number)
{
    label_name names[MESH_LABEL_NAMES] = {{0}};
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
    {
        const char *text = mesh_label_text(&table->labels[number], k);
        if (text != NULL)
            names[k] = (label_name){text, strlen(text)};
    }
    size_t slot = (size_t)hash_names(names) & (table->slot_count - 1);
    while (table->slots[slot] != BAT_MESH_NONE)
        slot = (slot + 1) & (table->slot_count - 1);
    table->slots[slot] = number;
}

/// Keep at least half of the slots empty. False when out of memory.
static bool reserve_slots(label_table *table, size_t count)
{
    enum
    {
        FIRST_SLOTS = 16
    };
    size_t wanted = table->slot_count > 0 ? table->slot_count : FIRST_SLOTS;
    while (wanted / 2 < count)
        wanted *= 2;
    if (wanted == table->slot_count)
        return true;
    uint32_t *slots = memory_array(wanted, sizeof *slots);
    if (slots == NULL)
        return false;
    memset(slots, 0xff, wanted * sizeof *slots);
    free(table->slots);
    table->slots = slots;
    table->slot_count = wanted;
    for (uint32_t i = 0; i < table->count; i++)
        put(table, i);
    return true;
}

/// The number of bytes of the UTF-8 character at `at` (RFC 3629); 0 for none.
static size_t character_size(const unsigned char *at, size_t left)
{
    size_t size = *at < 0x80 ? 1 : *at < 0xc2 ? 0 : *at < 0xe0 ? 2 : *at < 0xf0 ? 3 : *at < 0xf5 ? 4 : 0;
    if (size > left)
        return 0;
    for (size_t i = 1; i < size; i++)
        if ((at[i] & 0xc0) != 0x80)
            return 0;
    bool overlong = (*at == 0xe0 && at[1] < 0xa0) || (*at == 0xf0 && at[1] < 0x90);
    bool outside = (*at == 0xed && at[1] > 0x9f) || (*at == 0xf4 && at[1] > 0x8f);
    return overlong || outside ? 0 : size;
}

char *label_name_copy(label_name name)
{
    const unsigned char *from = (const unsigned char *)name.begin;
    size_t size = strnlen(name.begin, name.size);
    bool valid = true;
    for (size_t i = 0, step; i < size && valid; i += step)
    {
        step = character_size(from + i, size - i);
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

uint32_t label_table_add(label_table *table, const label_name names[MESH_LABEL_NAMES])
{
    bat_mesh_label label = {0};
    label_name copies[MESH_LABEL_NAMES] = {{0}};
    bool room = reserve_slots(table, table->count + 1) && ARRAY_GROW(table->labels, table->capacity, table->count + 1);
    for (int k = 0; k < MESH_LABEL_NAMES && room; k++)
    {
        if (names[k].begin == NULL)
            continue;
        char *copy = label_name_copy(names[k]);
        room = copy != NULL;
        *mesh_label_name(&label, k) = copy;
        copies[k] = (label_name){copy, room ? strlen(copy) : 0};
    }
    uint32_t found = BAT_MESH_NONE;
    for (size_t slot = room ? (size_t)hash_names(copies) & (table->slot_count - 1) : 0;
         room && found == BAT_MESH_NONE && table->slots[slot] != BAT_MESH_NONE; slot = (slot + 1) & (table->slot_count - 1))
        if (has_names(&table->labels[table->slots[slot]], copies))
            found = table->slots[slot];
    if (!room || found != BAT_MESH_NONE)
    {
        label_free(&label);
        return found;
    }
    table->labels[table->count] = label;
    put(table, (uint32_t)table->count);
    return (uint32_t)table->count++;
}
