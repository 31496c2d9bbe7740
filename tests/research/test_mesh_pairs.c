// Training pairs: what they hold, and that chance alone decides it.

#include "mesh_flap_helpers.h"

#include "research/train/mesh_pairs.h"
#include "research/train/mesh_targets.h"

static const mesh_pair_plan PLAN = {
    .levels = 2, .min_vertices = 20, .max_vertices = 40, .min_normal = 0.2, .min_quality = 0.2};

static size_t vertices_at(const mesh_levels *levels, size_t level)
{
    return level < levels->count ? levels->level[level].vertex_count : levels->vertex_count;
}

static void check_same_pair(const mesh_pair *a, const mesh_pair *b)
{
    assert_int_equal(a->coarse.vertex_count, b->coarse.vertex_count);
    assert_int_equal(a->coarse.face_count, b->coarse.face_count);
    assert_memory_equal(a->coarse.positions, b->coarse.positions, 3 * a->coarse.vertex_count * sizeof(double));
    assert_memory_equal(a->coarse.faces, b->coarse.faces, 3 * a->coarse.face_count * sizeof(uint32_t));
    for (size_t level = 0; level <= a->levels.count; level++)
        assert_memory_equal(a->target[level], b->target[level], 3 * vertices_at(&a->levels, level) * sizeof(double));
}

/// On a sphere, all targets and normals are near to the sphere's.
static void targets_lie_on_the_shape(void **state)
{
    (void)state;
    bat_mesh shape = ball(4);
    for (uint64_t seed = 1; seed < 4; seed++)
    {
        mesh_pair pair;
        check_status(mesh_pair_make(&shape, &PLAN, seed, &pair, NULL), BAT_OK);
        assert_in_range(pair.coarse.vertex_count, 20, 40);
        assert_int_equal(pair.levels.level[0].vertex_count, pair.coarse.vertex_count);
        assert_non_null(pair.normals);
        for (size_t v = 0; v < pair.levels.vertex_count; v++)
        {
            const double *p = pair.target[2] + 3 * v, *n = pair.normals + 3 * v;
            double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
            check_near(length, 1, 0.01);
            check_near((p[0] * n[0] + p[1] * n[1] + p[2] * n[2]) / length, 1, 0.01);
            check_near(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-14);
        }
        mesh_pair_free(&pair);
    }
    bat_mesh_free(&shape);
}

/// A map has no targets for other meshes.
static void targets_are_of_the_map_s_meshes(void **state)
{
    (void)state;
    bat_mesh shape = ball(4), coarse;
    bat_mesh_map *map = NULL;
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.vertices = 40;
    double positions[3] = {0};
    check_status(bat_mesh_decimate(&shape, &options, &coarse, &map, NULL), BAT_OK);
    check_status(mesh_map_targets(map, &coarse, &coarse, 1, positions, NULL, NULL), BAT_INVALID_ARGUMENT);
    check_status(mesh_map_targets(map, &shape, &shape, 1, positions, NULL, NULL), BAT_INVALID_ARGUMENT);
    assert_true(positions[0] == 0);
    bat_mesh_map_free(map);
    bat_mesh_free(&coarse);
    bat_mesh_free(&shape);
}

static void targets_of_loop_are_its_levels(void **state)
{
    (void)state;
    bat_mesh shape = ball(3);
    mesh_pair_plan plan = PLAN;
    mesh_pair pair;
    plan.loop = true;
    check_status(mesh_pair_make(&shape, &plan, 1, &pair, NULL), BAT_OK);
    assert_null(pair.normals);
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LOOP;
    for (size_t level = 0; level <= plan.levels; level++)
    {
        bat_mesh fine;
        options.levels = level;
        check_status(bat_mesh_refine(&pair.coarse, &options, &fine, NULL, NULL), BAT_OK);
        assert_int_equal(fine.vertex_count, vertices_at(&pair.levels, level));
        assert_memory_equal(fine.positions, pair.target[level], 3 * fine.vertex_count * sizeof(double));
        bat_mesh_free(&fine);
    }
    mesh_pair_free(&pair);
    bat_mesh_free(&shape);
}

/// In each epoch as many pairs change as are wanted, all in turn; which, does not depend on the way there nor on threads.
static void fresh_pairs_come_in_turn(void **state)
{
    (void)state;
    enum
    {
        COUNT = 5,
        FRESH = 2,
        EPOCHS = 7
    };
    bat_mesh shapes[2] = {ball(2), ball(3)};
    mesh_pair_plan plan = PLAN;
    plan.min_vertices = 10;
    plan.max_vertices = 14;
    mesh_pairs walked, jumped;
    check_status(mesh_pairs_begin(shapes, 2, COUNT, &plan, 7, FRESH, &walked, NULL), BAT_OK);
    uint64_t before[COUNT] = {0};
    for (uint64_t epoch = 0; epoch < EPOCHS; epoch++)
    {
        size_t changed = 0;
        check_status(mesh_pairs_renew(&walked, epoch, NULL, 1, (bat_progress){0}, NULL), BAT_OK);
        for (size_t p = 0; p < COUNT; p++)
        {
            changed += walked.made_for[p] != before[p];
            before[p] = walked.made_for[p];
            assert_true(epoch + 1 - walked.made_for[p] <= COUNT / FRESH || walked.made_for[p] == 1);
        }
        assert_int_equal(changed, epoch == 0 ? COUNT : FRESH);
        check_status(mesh_pairs_begin(shapes, 2, COUNT, &plan, 7, FRESH, &jumped, NULL), BAT_OK);
        check_status(mesh_pairs_renew(&jumped, epoch, NULL, 3, (bat_progress){0}, NULL), BAT_OK);
        for (size_t p = 0; p < COUNT; p++)
            check_same_pair(&walked.pair[p], &jumped.pair[p]);
        mesh_pairs_free(&jumped);
    }
    mesh_pairs_free(&walked);
    bat_mesh_free(&shapes[0]);
    bat_mesh_free(&shapes[1]);
}

static bool refuse(void *context, double fraction)
{
    (void)context;
    (void)fraction;
    return false;
}

static void making_pairs_can_be_stopped(void **state)
{
    (void)state;
    bat_mesh shape = ball(3);
    mesh_pairs pairs;
    check_status(mesh_pairs_begin(&shape, 1, 20, &PLAN, 1, 0, &pairs, NULL), BAT_OK);
    check_status(mesh_pairs_renew(&pairs, 0, NULL, 1, (bat_progress){.report = refuse}, NULL), BAT_CANCELLED);
    assert_int_equal(pairs.made_for[19], 0);
    mesh_pairs_free(&pairs);
    bat_mesh_free(&shape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(targets_lie_on_the_shape),       cmocka_unit_test(targets_are_of_the_map_s_meshes),
        cmocka_unit_test(targets_of_loop_are_its_levels), cmocka_unit_test(fresh_pairs_come_in_turn),
        cmocka_unit_test(making_pairs_can_be_stopped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
