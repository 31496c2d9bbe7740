// A mesh of 10,000 vertices with texture coordinates and a value at each vertex becomes one of 400. The map between the
// two carries both to the coarse mesh, and to refinements of it; and it carries points there and back.
//
//     cc decimate_map.c $(pkg-config --cflags --libs batten) -lm && ./a.out

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    AROUND = 125, ///< vertices of a ring around its axis
    ACROSS = 80,  ///< vertices of its cross-section
    VERTICES = AROUND * ACROSS,
    COARSE_VERTICES = 400,
    LEVELS = 2,
};

/// A ring with bumps, 1 long.
static bat_status make_ring(bat_mesh *mesh)
{
    const double step_around = 8 * atan(1) / AROUND, step_across = 8 * atan(1) / ACROSS;
    double *positions = malloc(3 * (size_t)VERTICES * sizeof *positions);
    uint32_t *faces = malloc(6 * (size_t)VERTICES * sizeof *faces);
    *mesh = (bat_mesh){.positions = positions, .vertex_count = VERTICES, .faces = faces, .face_count = 2 * (size_t)VERTICES};
    if (positions == NULL || faces == NULL)
        return BAT_NO_MEMORY;
    for (uint32_t i = 0; i < AROUND; i++)
        for (uint32_t j = 0; j < ACROSS; j++)
        {
            double u = i * step_around, v = j * step_across;
            double thick = 0.12 + 0.015 * sin(5 * u) * cos(2 * v), radius = 0.36 + thick * cos(v);
            double *p = positions + 3 * (i * ACROSS + j);
            p[0] = radius * cos(u);
            p[1] = radius * sin(u);
            p[2] = thick * sin(v);
            uint32_t next_i = (i + 1) % AROUND, next_j = (j + 1) % ACROSS;
            uint32_t a = i * ACROSS + j, b = next_i * ACROSS + j, c = next_i * ACROSS + next_j, d = i * ACROSS + next_j;
            const uint32_t corners[] = {a, b, c, a, c, d};
            memcpy(faces + 6 * (i * ACROSS + j), corners, sizeof corners);
        }
    return BAT_OK;
}

/// Give a mesh its x and y as texture coordinates, and its height y as a value named "height".
static bat_status add_signals(bat_mesh *mesh)
{
    size_t count = mesh->vertex_count, corners = 3 * mesh->face_count;
    mesh->texture = malloc(2 * count * sizeof *mesh->texture);
    mesh->texture_faces = malloc(corners * sizeof *mesh->texture_faces);
    mesh->channels = malloc(count * sizeof *mesh->channels);
    mesh->channel_names = calloc(1, sizeof *mesh->channel_names);
    char *name = malloc(sizeof "height");
    if (mesh->texture == NULL || mesh->texture_faces == NULL || mesh->channels == NULL || mesh->channel_names == NULL ||
        name == NULL)
    {
        free(name);
        return BAT_NO_MEMORY;
    }
    mesh->channel_names[0] = memcpy(name, "height", sizeof "height");
    mesh->channel_count = 1;
    mesh->texture_count = count;
    memcpy(mesh->texture_faces, mesh->faces, corners * sizeof *mesh->faces);
    for (size_t v = 0; v < count; v++)
    {
        memcpy(mesh->texture + 2 * v, mesh->positions + 3 * v, 2 * sizeof *mesh->texture);
        mesh->channels[v] = mesh->positions[3 * v + 1];
    }
    return BAT_OK;
}

/// The root mean square of value minus height over the vertices: how far the carried value is from that of the place
/// where the vertex lies now.
static double height_error(const bat_mesh *mesh)
{
    double sum = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        double difference = mesh->channels[v] - mesh->positions[3 * v + 1];
        sum += difference * difference;
    }
    return sqrt(sum / (double)mesh->vertex_count);
}

/// Carry the middles of all coarse faces to the fine mesh and back, and return by how much the worst barycentric coordinate
/// differs afterwards; negative on failure.
static double there_and_back(const bat_mesh_map *map, size_t faces, bat_error *error)
{
    double worst = 0;
    bat_mesh_point *points = malloc(faces * sizeof *points);
    if (points == NULL)
        return -1;
    for (size_t f = 0; f < faces; f++)
        points[f] = (bat_mesh_point){.face = (uint32_t)f, .barycentric = {1.0 / 3, 1.0 / 3, 1.0 / 3}};
    if (bat_mesh_map_to_fine(map, points, faces, error) != BAT_OK ||
        bat_mesh_map_to_coarse(map, points, faces, error) != BAT_OK)
        worst = -1;
    for (size_t f = 0; f < faces && worst >= 0; f++)
        for (size_t c = 0; c < 3; c++)
            worst = points[f].face == f ? fmax(worst, fabs(points[f].barycentric[c] - 1.0 / 3)) : 1;
    free(points);
    return worst;
}

int main(void)
{
    bat_mesh fine = {0}, coarse = {0}, refined = {0};
    bat_mesh_map *map = NULL;
    bat_error error = {.text = "out of memory"};
    bat_mesh_decimate_options decimate = bat_mesh_decimate_defaults();
    decimate.vertices = COARSE_VERTICES;
    bat_mesh_refine_options refine = bat_mesh_refine_defaults();
    refine.scheme = BAT_MESH_SCHEME_BUTTERFLY;
    refine.levels = LEVELS;
    bat_status status = make_ring(&fine);
    if (status == BAT_OK)
        status = add_signals(&fine);
    if (status == BAT_OK)
        status = bat_mesh_decimate(&fine, &decimate, &coarse, &map, &error);
    if (status == BAT_OK)
        status = bat_mesh_map_transfer(map, &fine, &coarse, 0, &coarse, &error);
    if (status == BAT_OK)
        status = bat_mesh_refine(&coarse, &refine, &refined, NULL, &error);
    if (status == BAT_OK)
        status = bat_mesh_map_transfer(map, &fine, &coarse, LEVELS, &refined, &error);

    double apart = status == BAT_OK ? there_and_back(map, coarse.face_count, &error) : -1;
    bool good = apart >= 0 && apart < 1e-9;
    if (apart < 0)
        fprintf(stderr, "%s\n", error.text);
    else
    {
        double at_coarse = height_error(&coarse), at_refined = height_error(&refined);
        printf("%zu vertices become %zu, refined %zu; carried heights are off by %.5f and %.5f (the mesh is 1 long)\n",
               fine.vertex_count, coarse.vertex_count, refined.vertex_count, at_coarse, at_refined);
        printf("points there and back: %.1e\n", apart);
        good = good && coarse.texture_faces != NULL && at_coarse < 0.01 && at_refined < 0.01;
    }
    bat_mesh_map_free(map);
    bat_mesh_free(&refined);
    bat_mesh_free(&coarse);
    bat_mesh_free(&fine);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
