#include "batten/research/mesh_shapes.h"
#include "batten/research/mesh_train.h"

#include "base/shared_work.h"
#include "base/threads.h"

enum
{
    VERTICES = 8000
};

/// More of what is grown and folded than of what is machined: it is what decimated meshes mostly come from.
static const struct
{
    const char *name;
    uint64_t seed;
} SHAPES[BAT_MESH_TRAINING_SHAPES] = {
    {"creature", 1}, {"creature", 2}, {"creature", 3}, {"creature", 4}, {"creature", 5}, {"figure", 1},
    {"figure", 2},   {"bust", 1},     {"bust", 2},     {"bust", 3},     {"mask", 1},     {"mask", 2},
    {"cactus", 1},   {"cactus", 2},   {"coral", 1},    {"pretzel", 1},  {"stone", 1},    {"stone", 2},
    {"bracket", 1},  {"bracket", 2},  {"gear", 1},     {"lathe", 1},    {"casting", 1},  {"gem", 1},
    {"cam", 1},      {"block", 1},    {"knot", 1},     {"relief", 1},   {"shell", 1},    {"casting", 2},
};

bat_status bat_mesh_training_shapes(bat_mesh *shapes, int threads, bat_progress progress, bat_error *error)
{
    enum
    {
        COUNT = BAT_MESH_TRAINING_SHAPES
    };
    shared_work work = shared_work_make(COUNT, progress);
    for (size_t i = 0; i < COUNT; i++)
        shapes[i] = (bat_mesh){0};
#pragma omp parallel for schedule(dynamic) num_threads(threads_for(threads, COUNT))
    for (size_t i = 0; i < COUNT; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error own;
        bat_status status = bat_mesh_shape(SHAPES[i].name, VERTICES, SHAPES[i].seed, &shapes[i], &own);
        shared_work_finish(&work, i, status, &own);
    }
    bat_status status = shared_work_end(&work, error);
    for (size_t i = 0; i < COUNT && status != BAT_OK; i++)
        bat_mesh_free(&shapes[i]);
    return status;
}
