// A coarse mesh that somebody modelled becomes a smooth one, by Loop's scheme and by the butterfly, which goes through the
// points that were given.
//
//     cc refine_mesh.c $(pkg-config --cflags --libs batten) -lm && ./a.out [IN.obj [OUT.obj [PICTURE.png]]]

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    LEVELS = 3,
    AROUND = 6, ///< vertices of a ring of our own making, around its axis, where no file is given
    ACROSS = 4, ///< vertices of its cross-section
};

/// A ring of quadrilaterals, each split into two triangles.
static bat_status make_ring(bat_mesh *mesh)
{
    const double step_around = 8 * atan(1) / AROUND, step_across = 8 * atan(1) / ACROSS;
    double *positions = malloc(3 * AROUND * ACROSS * sizeof *positions);
    uint32_t *faces = malloc(6 * AROUND * ACROSS * sizeof *faces);
    *mesh = (bat_mesh){
        .positions = positions, .vertex_count = AROUND * ACROSS, .faces = faces, .face_count = 2 * AROUND * ACROSS};
    if (positions == NULL || faces == NULL)
        return BAT_NO_MEMORY;
    for (uint32_t i = 0; i < AROUND; i++)
        for (uint32_t j = 0; j < ACROSS; j++)
        {
            double radius = 2 + 0.8 * cos(j * step_across);
            double *p = positions + 3 * (i * ACROSS + j);
            p[0] = radius * cos(i * step_around);
            p[1] = radius * sin(i * step_around);
            p[2] = 0.8 * sin(j * step_across);
            uint32_t next_i = (i + 1) % AROUND, next_j = (j + 1) % ACROSS;
            uint32_t a = i * ACROSS + j, b = next_i * ACROSS + j, c = next_i * ACROSS + next_j, d = i * ACROSS + next_j;
            const uint32_t corners[] = {a, b, c, a, c, d};
            for (size_t k = 0; k < 6; k++)
                faces[6 * (i * ACROSS + j) + k] = corners[k];
        }
    return BAT_OK;
}

/// The farthest that one of the first vertices of the fine mesh is from where it was in the coarse one.
static double farthest_move(const bat_mesh *coarse, const bat_mesh *fine)
{
    double farthest = 0;
    for (size_t v = 0; v < coarse->vertex_count; v++)
    {
        const double *before = coarse->positions + 3 * v, *after = fine->positions + 3 * v;
        farthest = fmax(farthest, hypot(hypot(after[0] - before[0], after[1] - before[1]), after[2] - before[2]));
    }
    return farthest;
}

static bat_status draw(const char *path, const bat_mesh *coarse, const bat_mesh *loop, const bat_mesh *butterfly,
                       bat_error *error)
{
    const bat_mesh_picture_panel panels[] = {
        {.mesh = coarse, .title = "given", .wires = true, .flat = true},
        {.mesh = loop, .title = "Loop"},
        {.mesh = butterfly, .title = "butterfly"},
    };
    return bat_mesh_picture_write(path, panels, 3, NULL, error);
}

int main(int argc, char **argv)
{
    bat_mesh coarse = {0}, loop = {0}, butterfly = {0};
    bat_error error = {.text = "out of memory"};
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.levels = LEVELS;
    options.scheme = BAT_MESH_SCHEME_LOOP;
    bat_status status = argc > 1 ? bat_mesh_read(argv[1], NULL, &coarse, &error) : make_ring(&coarse);
    if (status == BAT_OK)
        status = bat_mesh_refine(&coarse, &options, &loop, NULL, &error);
    options.scheme = BAT_MESH_SCHEME_BUTTERFLY;
    if (status == BAT_OK)
        status = bat_mesh_refine(&coarse, &options, &butterfly, NULL, &error);
    if (status == BAT_OK && argc > 2)
        status = bat_mesh_write(argv[2], &loop, NULL, &error);
    if (status == BAT_OK && argc > 3)
        status = draw(argv[3], &coarse, &loop, &butterfly, &error);
    if (status != BAT_OK)
        fprintf(stderr, "%s\n", error.text);

    double by_loop = 0, by_butterfly = 0;
    if (status == BAT_OK)
    {
        by_loop = farthest_move(&coarse, &loop);
        by_butterfly = farthest_move(&coarse, &butterfly);
        printf("%zu faces become %zu; given vertices move by at most %.4f with Loop's scheme, by %.4f with the butterfly\n",
               coarse.face_count, loop.face_count, by_loop, by_butterfly);
    }
    bool good = status == BAT_OK && loop.face_count == coarse.face_count << 2 * LEVELS && by_loop > 0 && by_butterfly == 0;
    bat_mesh_free(&butterfly);
    bat_mesh_free(&loop);
    bat_mesh_free(&coarse);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
