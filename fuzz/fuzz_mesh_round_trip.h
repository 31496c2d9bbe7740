#ifndef FUZZ_MESH_ROUND_TRIP_H
#define FUZZ_MESH_ROUND_TRIP_H

#include "promise.h"

#include "batten/mesh.h"
#include "batten/mesh_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Whether a format rounds or renumbers: STL, glTF and 3MF.
static inline bool renumbers(bat_mesh_format format)
{
    return format >= BAT_MESH_FORMAT_STL;
}

/// Compare a mesh before and after a file.
static inline void compare_meshes(const bat_mesh *before, const bat_mesh *after, bat_mesh_format format)
{
    PROMISE(after->face_count == before->face_count);
    if (renumbers(format))
        return;
    PROMISE(after->vertex_count == before->vertex_count);
    for (size_t i = 0; i < 3 * before->vertex_count; i++)
        PROMISE(after->positions[i] == before->positions[i]);
    PROMISE(memcmp(after->faces, before->faces, before->face_count * 3 * sizeof *before->faces) == 0);
}

/// A mesh that was read can be written in any format or is refused with a reason; what is written can be read again.
static inline void write_and_read(const bat_mesh *mesh)
{
    for (int i = BAT_MESH_FORMAT_OBJ; i <= BAT_MESH_FORMAT_3MF; i++)
        for (int encoding = BAT_MESH_ENCODING_BINARY; encoding <= BAT_MESH_ENCODING_TEXT; encoding += 2)
        {
            bat_mesh_write_options writing = bat_mesh_write_defaults();
            bat_mesh_read_options reading = bat_mesh_read_defaults();
            writing.format = reading.format = (bat_mesh_format)i;
            writing.encoding = (bat_mesh_encoding)encoding;
            writing.threads = 1;
            writing.normals = encoding == BAT_MESH_ENCODING_TEXT ? BAT_MESH_NORMALS_AREA : BAT_MESH_NORMALS_NONE;
            reading.keep_degenerate = renumbers(reading.format); // vertices were equal or become equal
            reading.weld =
                renumbers(reading.format) ? reading.weld : 0; // a repair can have made triangles with own vertices
            char *bytes = NULL;
            size_t size = 0;
            bat_status status = bat_mesh_write_memory(mesh, &writing, &bytes, &size, NULL);
            PROMISE(status == BAT_OK || status == BAT_UNSUPPORTED);
            if (status != BAT_OK)
                continue;
            bat_mesh back;
            PROMISE(bat_mesh_read_memory(bytes, size, &reading, &back, NULL) == BAT_OK);
            compare_meshes(mesh, &back, reading.format);
            free(bytes);
            bat_mesh_free(&back);
        }
}

/// A repaired mesh has connectivity.
static inline void repair_and_connect(const bat_mesh *mesh)
{
    bat_mesh repaired;
    bat_mesh_connectivity connectivity;
    if (bat_mesh_repair(mesh, NULL, &repaired, NULL) != BAT_OK)
        return;
    PROMISE(bat_mesh_connect(&repaired, &connectivity, NULL) == BAT_OK);
    bat_mesh_connectivity_free(&connectivity);
    bat_mesh_free(&repaired);
}

/// Read bytes in a format with all options.
static inline void mesh_round_trip(const uint8_t *data, size_t size, bat_mesh_format format)
{
    for (int choice = 0; choice < 3; choice++)
    {
        bat_mesh_read_options reading = bat_mesh_read_defaults();
        reading.format = format;
        reading.triangulate = choice > 0;
        reading.keep_degenerate = choice > 1;
        bat_mesh mesh = {0};
        bat_error error = {0};
        bat_mesh_notes notes = {0};
        reading.notes = &notes;
        bat_status status = bat_mesh_read_memory(data, size, &reading, &mesh, &error);
        PROMISE(status == error.status);
        PROMISE(status == BAT_OK || notes.count == 0);
        bat_mesh_notes_free(&notes);
        if (status != BAT_OK)
            continue;
        bool checked = bat_mesh_check(&mesh, NULL) == BAT_OK;
        PROMISE(checked || reading.keep_degenerate);
        if (checked && choice < 2)
            write_and_read(&mesh);
        repair_and_connect(&mesh);
        bat_mesh_free(&mesh);
    }
}

#endif
