#ifndef IO_MESH_NOTES_H
#define IO_MESH_NOTES_H

#include "batten/mesh_file.h"

/// @file
/// Notes of readers and writers.

/// Append a note, unless the same one is there. Null `notes` take none.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_note(bat_mesh_notes *notes, bat_error *error, const char *format, ...) __attribute__((format(printf, 3, 4)));

/// Move all notes to the end of `to`, which may be null. `from` is empty afterwards, also on failure.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_notes_move(bat_mesh_notes *from, bat_mesh_notes *to, bat_error *error);

#endif
