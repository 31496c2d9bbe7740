#ifndef IO_MESH_LABEL_TABLE_H
#define IO_MESH_LABEL_TABLE_H

#include "mesh/key_map.h"
#include "mesh/labels.h"

/// @file
/// Different labels, numbered in the order of their first use.

/// A name in the text of a file; `begin` is null for none.
typedef struct label_name
{
    const char *begin;
    size_t size;
} label_name;

/// Labels without repetition. All zero: empty.
typedef struct label_table
{
    bat_mesh_label *labels;
    size_t count, capacity;
    key_map numbers; ///< by hashes of labels
} label_table;

/// A copy of a name in UTF-8, up to its first zero byte. Other bytes are taken for Latin-1, and control characters become
/// '_'. Null when out of memory.
char *label_name_copy(label_name name);

/// The number of the label with these names, in the form of label_name_copy(). It is added if it is new. BAT_MESH_NONE when
/// out of memory.
uint32_t label_table_add(label_table *table, const label_name names[MESH_LABEL_NAMES]);
void label_table_free(label_table *table);

#endif
