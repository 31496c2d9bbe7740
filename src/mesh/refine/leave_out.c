#include "mesh/refine/leave_out.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/// @file
/// The faces that are left, and the vertices they have.

/// Whether a crease of the mesh makes an edge sharp for ever.
static bool is_sharp(const bat_mesh *mesh, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        const bat_mesh_crease *crease = &mesh->creases[i];
        if (crease->sharpness >= BAT_MESH_SHARP &&
            ((crease->a == a && crease->b == b) || (crease->a == b && crease->b == a)))
            return true;
    }
    return false;
}

/// Mark the ends of boundary edges that no crease makes sharp.
static void mark_boundary(const mesh_level *level, const bat_mesh *mesh, bool *marked)
{
    const bat_mesh_connectivity *links = level->links;
    memset(marked, 0, links->vertex_count * sizeof *marked);
    for (uint32_t h = 0; h < sides_corners(&level->sides, links->face_count); h++)
    {
        uint32_t a = level->faces[h], b = level->faces[sides_next(&level->sides, h)];
        if (mesh_at_boundary(links, h) && !is_sharp(mesh, a, b))
            marked[a] = marked[b] = true;
    }
}

/// The coarse face that a face of a later level comes from.
static uint32_t ancestor(const mesh_level *level, uint32_t face, size_t levels, bool quads)
{
    return quads ? sides_face(&level->sides, face >> 2 * (levels - 1)) : face >> 2 * levels;
}

static bool has_marked(const mesh_level *level, uint32_t face, const bool *marked)
{
    for (uint32_t c = sides_begin(&level->sides, face); c < sides_begin(&level->sides, face + 1); c++)
        if (marked[level->faces[c]])
            return true;
    return false;
}

/// Number anew what the corners of faces name; the rows of `count` numbers that none names are dropped.
/// @param numbers workspace, one for each row; receives the new numbers, BAT_MESH_NONE for dropped rows
static size_t drop_unused(uint32_t *faces, size_t corners, size_t rows, uint32_t *numbers)
{
    memset(numbers, 0xff, rows * sizeof *numbers);
    for (size_t c = 0; c < corners; c++)
        numbers[faces[c]] = 0;
    uint32_t count = 0;
    for (size_t i = 0; i < rows; i++)
        if (numbers[i] == 0)
            numbers[i] = count++;
    for (size_t c = 0; c < corners; c++)
        faces[c] = numbers[faces[c]];
    return count;
}

static void move_rows(double *values, size_t rows, size_t dim, const uint32_t *numbers)
{
    for (size_t i = 0; values != NULL && i < rows; i++)
        if (numbers[i] != BAT_MESH_NONE)
            memmove(values + numbers[i] * dim, values + i * dim, dim * sizeof *values);
}

static void move_marks(bat_mesh *mesh, const uint32_t *numbers)
{
    size_t count = 0;
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        bat_mesh_crease crease = mesh->creases[i];
        crease.a = numbers[crease.a];
        crease.b = numbers[crease.b];
        if (crease.a != BAT_MESH_NONE && crease.b != BAT_MESH_NONE)
            mesh->creases[count++] = crease;
    }
    mesh->crease_count = count;
    count = 0;
    for (size_t i = 0; i < mesh->corner_count; i++)
    {
        bat_mesh_corner corner = mesh->corners[i];
        corner.vertex = numbers[corner.vertex];
        if (corner.vertex != BAT_MESH_NONE)
            mesh->corners[count++] = corner;
    }
    mesh->corner_count = count;
}

/// Keep some faces of a mesh and what they name.
static void keep_faces(const mesh_level *level, const bool *marked, size_t levels, uint32_t sides, bat_mesh *fine,
                       double *normals, uint32_t *numbers)
{
    size_t kept = 0;
    for (uint32_t f = 0; f < fine->face_count; f++)
    {
        if (has_marked(level, ancestor(level, f, levels, sides == 4), marked))
            continue;
        memmove(fine->faces + sides * kept, fine->faces + sides * (size_t)f, sides * sizeof *fine->faces);
        if (fine->texture_faces != NULL)
            memmove(fine->texture_faces + sides * kept, fine->texture_faces + sides * (size_t)f,
                    sides * sizeof *fine->texture_faces);
        if (fine->face_labels != NULL)
            fine->face_labels[kept] = fine->face_labels[f];
        kept++;
    }
    fine->face_count = kept;
    size_t vertices = fine->vertex_count;
    fine->vertex_count = drop_unused(fine->faces, sides * kept, vertices, numbers);
    move_rows(fine->positions, vertices, 3, numbers);
    move_rows(normals, vertices, 3, numbers);
    move_rows(fine->channels, vertices, fine->channel_count, numbers);
    move_marks(fine, numbers);
    if (fine->texture_faces == NULL)
        return;
    size_t texture = fine->texture_count;
    fine->texture_count = drop_unused(fine->texture_faces, sides * kept, texture, numbers);
    move_rows(fine->texture, texture, 2, numbers);
}

bat_status leave_out_boundary(const mesh_level *level, const bat_mesh *coarse, size_t levels, const mesh_sides *sides,
                              bat_mesh *fine, double *normals, bat_error *error)
{
    size_t rows = fine->vertex_count > fine->texture_count ? fine->vertex_count : fine->texture_count;
    bool *marked = memory_array(coarse->vertex_count, sizeof *marked);
    uint32_t *numbers = memory_array(rows, sizeof *numbers);
    bat_status status = BAT_OK;
    if (marked == NULL || numbers == NULL)
        status = error_memory(error, rows * sizeof *numbers);
    else
    {
        mark_boundary(level, coarse, marked);
        keep_faces(level, marked, levels, sides->quads ? 4 : 3, fine, normals, numbers);
        if (fine->face_count == 0)
            status = error_remedy(error,
                                  error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                                            "every face is at the boundary, and the boundary rule 'none' leaves those out"),
                                  "rules.boundary", "edges keeps them");
    }
    free(marked);
    free(numbers);
    return status;
}
