#pragma once

#include "batten/mesh_file.h"
#include "io/common/block_writer.h"
#include "io/common/file_text.h"
#include "mesh/hash_table.h"
#include "mesh/labels.h"

/// @file
/// Readers and writers of mesh formats, one file for each. Readers leave `mesh` untouched on failure. Writers of formats
/// that hold triangles alone get no polygons.

typedef bat_status mesh_reader(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh,
                               bat_error *error);
typedef bat_status mesh_writer(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink,
                               bat_error *error);
/// Whether a text begins as a format does.
typedef bool mesh_recognizer(const file_text *text);

mesh_reader mesh_obj_read, mesh_ply_read, mesh_off_read, mesh_stl_read, mesh_gltf_read, mesh_3mf_read;
/// Read a file that may have only vertices; the mesh then has no faces.
mesh_reader mesh_obj_read_points, mesh_ply_read_points;
mesh_writer mesh_obj_write, mesh_ply_write, mesh_off_write, mesh_stl_write, mesh_gltf_write, mesh_glb_write, mesh_3mf_write;
mesh_recognizer mesh_ply_resembles, mesh_off_resembles, mesh_stl_resembles, mesh_gltf_resembles, mesh_glb_resembles;

/// Whether every vertex has exactly one texture coordinate, with the vertex's index.
bool mesh_texture_by_vertex(const bat_mesh *mesh);

/// Append a note, unless the same one is there. Null `notes` take none.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_note(bat_mesh_notes *notes, bat_error *error, const char *format, ...) __attribute__((format(printf, 3, 4)));

/// The note of a reader.
#define MESH_NORMALS_LEFT_OUT "%zu normals are left out: they follow from the mesh, and writers can make new ones"

/// Move all notes to the end of `to`, which may be null. `from` is empty afterwards, also on failure.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_notes_move(bat_mesh_notes *from, bat_mesh_notes *to, bat_error *error);

// Different labels, numbered in the order of their first use.

/// A name in the text of a file; `begin` is null for none.
typedef struct label_name
{
    const char *begin;
    size_t size;
} label_name;

/// A string, or null, as a name.
static inline label_name label_name_of(const char *text)
{
    return (label_name){text, text != NULL ? strlen(text) : 0};
}

static inline bool label_name_is(label_name name, const char *word)
{
    return name.begin != NULL && name.size == strlen(word) && memcmp(name.begin, word, name.size) == 0;
}

static inline bool label_names_equal(label_name a, label_name b)
{
    return a.size == b.size && memcmp(a.begin, b.begin, a.size) == 0;
}

/// Labels without repetition. All zero: empty.
typedef struct label_table
{
    bat_mesh_label *labels;
    size_t count, capacity;
    key_map numbers; ///< by hashes of labels
} label_table;

/// A copy of a name in UTF-8 (other bytes: Latin-1; control characters: '_'), up to a zero byte. Null: out of memory.
char *label_name_copy(label_name name);

/// Whether one of `count` rows of `size` bytes begins with a name.
bool label_name_taken(const char *name, const void *rows, size_t size, size_t count);

/// A name for a new row beside `count` rows of `size` bytes, which begin with their names: a copy of the one given or,
/// `numbered` or where another row has it, that with a number. Null: out of memory.
char *label_name_unique(const char *given, bool numbered, const void *rows, size_t size, size_t count);

/// The number of the label with these names, copied by label_name_copy(); a new one is added. BAT_MESH_NONE: out of memory.
uint32_t label_table_add(label_table *table, const label_name names[MESH_LABEL_NAMES]);
void label_table_free(label_table *table);
