// Decimation of real meshes to as few vertices as the training uses, with the default bounds.

#include "decimate_helpers.h"

#include "batten/mesh_file.h"
#include "mesh/decimate/map.h"

static const char *const NAMES[] = {"bunny.obj",   "bob.obj",        "spot.obj",       "horse.obj",
                                    "cactus.obj",  "elephant.obj",   "nefertiti.obj",  "camelhead.off",
                                    "fandisk.off", "crane_hook.obj", "fat_dragon.obj", "face.obj"};

enum
{
    NAME_COUNT = sizeof NAMES / sizeof NAMES[0],
    POINTS = 2000
};

/// Points of the coarse mesh return unchanged from the fine mesh.
static void check_round_trip(const bat_mesh *coarse, const bat_mesh_map *map, double size)
{
    static bat_mesh_point points[POINTS], carried[POINTS];
    bat_random random = bat_random_seed(1);
    for (size_t i = 0; i < POINTS; i++)
    {
        double u = sqrt(bat_random_uniform(&random)), v = bat_random_uniform(&random);
        points[i] = (bat_mesh_point){(uint32_t)(bat_random_bits(&random) % coarse->face_count), {1 - u, u * (1 - v), u * v}};
        carried[i] = points[i];
    }
    assert_int_equal(bat_mesh_map_to_fine(map, carried, POINTS, NULL), BAT_OK);
    assert_int_equal(bat_mesh_map_to_coarse(map, carried, POINTS, NULL), BAT_OK);
    for (size_t i = 0; i < POINTS; i++)
    {
        double there[3], back[3];
        shape_point(coarse, &points[i], there);
        shape_point(coarse, &carried[i], back);
        check_near(shape_distance(there, back), 0, 1e-9 * size);
    }
}

static void check_decimation(const bat_mesh *fine, size_t vertices, size_t candidates, uint64_t seed)
{
    bat_mesh coarse;
    bat_mesh_map *map;
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.vertices = vertices;
    options.candidates = candidates;
    options.seed = seed;
    assert_int_equal(bat_mesh_decimate(fine, &options, &coarse, &map, NULL), BAT_OK);
    assert_int_equal(coarse.vertex_count, vertices);
    shape_topology before = shape_topology_of(fine), after = shape_topology_of(&coarse);
    assert_int_equal(after.euler, before.euler);
    assert_int_equal(after.loops, before.loops);
    assert_int_equal(map_inspect(map, NULL), BAT_OK);
    check_round_trip(&coarse, map, sqrt(shape_area(fine)));
    bat_mesh_free(&coarse);
    bat_mesh_map_free(map);
}

static void test_meshes(void **state)
{
    (void)state;
    for (size_t i = 0; i < NAME_COUNT; i++)
    {
        char path[1024];
        bat_mesh fine;
        (void)snprintf(path, sizeof path, "%s/data/meshes/%s", SHARED_DATA, NAMES[i]);
        if (bat_mesh_read(path, NULL, &fine, NULL) != BAT_OK)
        {
            print_message("%s is not there\n", path);
            continue;
        }
        check_decimation(&fine, 150, 0, 1);
        check_decimation(&fine, 150, 100, 1);
        check_decimation(&fine, 450, 100, 2);
        bat_mesh_free(&fine);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
