// A coarse mesh that somebody modelled becomes a smooth one, by Loop's scheme and by the butterfly, which goes through the
// points that were given.
//
//     cc refine_mesh.c $(pkg-config --cflags --libs batten) -lm && ./a.out [IN.obj [OUT.obj [PICTURE.png]]]

#include "batten/research/research.h"
#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    LEVELS = 3,
};

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
    bat_error error;
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.levels = LEVELS;
    options.scheme = BAT_MESH_SCHEME_LOOP;
    bat_status status =
        argc > 1 ? bat_mesh_read(argv[1], NULL, &coarse, &error) : bat_mesh_shape("cage", 200, 1, &coarse, &error);
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
