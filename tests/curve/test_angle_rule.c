// Rules of a user's own: what they see, what the kernel makes of their angles, and how they may be run.

#include "geometry_helpers.h"
#include "refine_helpers.h"

#include "batten/curve_measure.h"

enum
{
    COUNT = 40,
    LEVELS = 3
};

/// Eq. (9) as a rule: the four-point scheme, outward.
static void four_point_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *angles,
                              void *scratch)
{
    (void)rule;
    (void)scratch;
    for (size_t j = 0; j < view->count; j++)
        angles[j] = -0.125 * (view->angles[j] + view->angles[j + 1]);
}

static const bat_curve_angle_rule FOUR_POINT = {.name = "four-point", .reach = 1, .angles = four_point_angles};

/// A rule that looks at all it may, and in its scratch memory, too.
static void wide_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *angles,
                        void *scratch)
{
    double *sums = scratch;
    ptrdiff_t reach = (ptrdiff_t)rule->reach, count = (ptrdiff_t)view->count;
    assert_true(view->count <= BAT_CURVE_ANGLE_RULE_EDGES);
    for (ptrdiff_t j = 0; j < count; j++)
    {
        sums[j] = 0;
        for (ptrdiff_t i = 1 - reach; i <= reach; i++)
            sums[j] += view->angles[j + i] * (double)(i * i + 1);
        for (ptrdiff_t i = -reach; i <= reach; i++)
            sums[j] += 0.3 * sin((double)i) * view->lengths[j + i] / view->lengths[j];
    }
    for (ptrdiff_t j = 0; j < count; j++)
        angles[j] = -0.02 * tanh(sums[j]) * (rule->wants_mean_length ? view->lengths[j] / view->mean_length : 1);
}

static bat_curve_angle_rule wide_rule(size_t reach, bool wants_mean_length)
{
    return (bat_curve_angle_rule){.name = "wide",
                                  .reach = reach,
                                  .wants_mean_length = wants_mean_length,
                                  .scratch_size = BAT_CURVE_ANGLE_RULE_EDGES * sizeof(double),
                                  .angles = wide_angles};
}

static bat_curve_refine_options with_rule(const bat_curve_angle_rule *rule, size_t levels)
{
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = bat_curve_scheme_angle_rule(rule);
    how.levels = levels;
    return how;
}

static void check_same(const bat_curve *a, const bat_curve *b, double tolerance)
{
    assert_int_equal(a->count, b->count);
    for (size_t i = 0; i < a->count * a->space->point_dim; i++)
        check_near(a->points[i], b->points[i], tolerance);
}

/// Equation (9) gives the same by its own code and as a rule: closed and open, by both end rules, run by run.
static void the_four_point_scheme_can_be_a_rule(void **state)
{
    (void)state;
    double points[MAX_COORDINATES];
    bat_random random = bat_random_seed(1);
    for (int s = 0; s < 3; s++)
        for (int way = 0; way < 3; way++)
        {
            bat_space space = space_of(SURFACES[s]);
            (void)make_polygon(SURFACES[s], UNEVEN, COUNT, &random, points);
            bat_curve coarse = {.space = &space, .points = points, .count = COUNT, .closed = way == 0};
            bat_curve_refine_options rule = with_rule(&FOUR_POINT, 7), built_in = options("angle-4", 7);
            rule.ends = built_in.ends = way == 2 ? BAT_CURVE_END_RULE_EXTRAPOLATE : BAT_CURVE_END_RULE_REFLECT;
            bat_curve a = refined(&coarse, &rule), b = refined(&coarse, &built_in);
            check_same(&a, &b, 1e-12);
            bat_curve_free(&a);
            bat_curve_free(&b);
        }
}

/// A rule sees the numbers that bat_curve_exterior_angles() and bat_curve_edge_lengths() give.
static void inspect(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *angles, void *scratch)
{
    (void)scratch;
    const bat_curve *curve = rule->parameters;
    double expected[COUNT], lengths[COUNT], mean = 0;
    ptrdiff_t reach = (ptrdiff_t)rule->reach;
    check_status(bat_curve_exterior_angles(curve, expected, NULL), BAT_OK);
    bat_curve_edge_lengths(curve, lengths);
    for (size_t j = 0; j < COUNT; j++)
        mean += lengths[j] / COUNT;
    assert_int_equal(view->count, COUNT);
    check_near(view->mean_length, mean, 1e-13 * mean);
    for (ptrdiff_t v = 1 - reach; v < COUNT + reach; v++)
        check_near(view->angles[v], expected[(v + 2 * COUNT) % COUNT], 1e-13);
    for (ptrdiff_t e = -reach; e < COUNT + reach; e++)
        check_relative(view->lengths[e], lengths[(e + 2 * COUNT) % COUNT], 1e-13);
    for (size_t j = 0; j < view->count; j++)
        angles[j] = 0;
}

static void a_rule_sees_angles_and_lengths(void **state)
{
    (void)state;
    double points[MAX_COORDINATES];
    bat_random random = bat_random_seed(2);
    for (int s = 0; s < 3; s++)
        for (int kind = 0; kind < 3; kind++)
        {
            bat_space space = space_of(SURFACES[s]);
            (void)make_polygon(SURFACES[s], kind == 0 ? EVEN : kind == 1 ? UNEVEN : WIDE, COUNT, &random, points);
            bat_curve coarse = {.space = &space, .points = points, .count = COUNT, .closed = true};
            bat_curve_angle_rule rule = {
                .name = "inspector", .wants_mean_length = true, .parameters = &coarse, .angles = inspect};
            for (rule.reach = 1; rule.reach <= BAT_CURVE_ANGLE_RULE_REACH; rule.reach *= 4)
            {
                bat_curve_refine_options how = with_rule(&rule, 1);
                how.threads = 1;
                bat_curve fine = refined(&coarse, &how);
                for (size_t j = 0; j < COUNT; j++) // angle 0: the midpoint
                {
                    double middle[3];
                    const double *p = points + j * space.point_dim, *q = points + (j + 1) % COUNT * space.point_dim;
                    check_status(bat_space_geodesic(&space, p, q, 0.5, middle), BAT_OK);
                    for (size_t c = 0; c < space.point_dim; c++)
                        check_near(fine.points[(2 * j + 1) * space.point_dim + c], middle[c],
                                   SURFACES[s] == GEOMETRY_PLANE ? 1e-12 : 1e-14);
                }
                bat_curve_free(&fine);
            }
        }
}

/// The same functions under another address: no vector code.
static bat_status own_apex(const bat_space *space, const double *p, const double *q, double angle, double *point)
{
    const bat_space *real = space->parameters;
    return real->apex(real, p, q, angle, point);
}

static void threads_and_a_users_space_make_no_difference(void **state)
{
    (void)state;
    double points[MAX_COORDINATES];
    bat_random random = bat_random_seed(3);
    for (int s = 0; s < 3; s++)
        for (int mean = 0; mean < 2; mean++)
            for (int closed = 0; closed < 2; closed++)
            {
                bat_space space = space_of(SURFACES[s]), own = space;
                own.apex = own_apex;
                own.parameters = &space;
                (void)make_polygon(SURFACES[s], EVEN, COUNT, &random, points);
                bat_curve coarse = {.space = &space, .points = points, .count = COUNT, .closed = closed == 1};
                bat_curve_angle_rule rule = wide_rule(5, mean == 1);
                bat_curve_refine_options how = with_rule(&rule, 8); // several chunks
                how.threads = 1;
                bat_curve one = refined(&coarse, &how);
                how.threads = 3;
                bat_curve three = refined(&coarse, &how);
                assert_memory_equal(one.points, three.points, one.count * space.point_dim * sizeof(double));
                how.levels = LEVELS;
                bat_curve known = refined(&coarse, &how);
                coarse.space = &own;
                bat_curve any = refined(&coarse, &how);
                check_same(&known, &any, 1e-11);
                bat_curve_free(&one);
                bat_curve_free(&three);
                bat_curve_free(&known);
                bat_curve_free(&any);
            }
}

/// One angle everywhere, that of `parameters`.
static void constant_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *angles,
                            void *scratch)
{
    (void)scratch;
    for (size_t j = 0; j < view->count; j++)
        angles[j] = *(const double *)rule->parameters;
}

static void angles_are_clipped_and_must_be_numbers(void **state)
{
    (void)state;
    double points[MAX_COORDINATES], angle = 10, most = BAT_CURVE_ANGLE_LIMIT;
    bat_random random = bat_random_seed(4);
    for (int s = 0; s < 3; s++)
    {
        bat_space space = space_of(SURFACES[s]), own = space;
        own.apex = own_apex;
        own.parameters = &space;
        (void)make_polygon(SURFACES[s], EVEN, 12, &random, points);
        bat_curve coarse = {.space = &space, .points = points, .count = 12, .closed = true};
        bat_curve_angle_rule rule = {.name = "constant", .reach = 1, .parameters = &angle, .angles = constant_angles},
                             limit = rule;
        limit.parameters = &most;
        bat_curve_refine_options how = with_rule(&rule, 2), at_most = with_rule(&limit, 2);
        angle = 10;
        bat_curve a = refined(&coarse, &how), b = refined(&coarse, &at_most);
        check_same(&a, &b, 0);
        bat_curve_free(&a);
        bat_curve_free(&b);
        angle = NAN;
        how.levels = 1;
        for (int k = 0; k < 2; k++, coarse.space = &own)
        {
            bat_error error;
            check_status(bat_curve_refine(&coarse, &how, &a, &error), BAT_INVALID_POINT);
            assert_int_equal(error.index, 0);
        }
    }
}

static const char *only_spheres(const bat_curve_angle_rule *rule, const bat_space *space)
{
    (void)rule;
    return strcmp(space->name, "sphere") == 0 ? NULL : "it is not round";
}

static void wrong_rules_are_refused(void **state)
{
    (void)state;
    double points[6] = {0, 0, 1, 0, 0, 1};
    bat_space plane = bat_euclidean(2);
    bat_curve coarse = {.space = &plane, .points = points, .count = 3, .closed = true}, fine;
    bat_error error;
    bat_curve_angle_rule rule = FOUR_POINT;
    bat_curve_refine_options how = with_rule(&rule, 1);
    rule.reach = 0;
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    rule.reach = BAT_CURVE_ANGLE_RULE_REACH + 1;
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    rule = FOUR_POINT;
    rule.angles = NULL;
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    rule = FOUR_POINT;
    rule.scratch_size = SIZE_MAX;
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    rule = FOUR_POINT;
    rule.fault = only_spheres;
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "it is not round"));
    rule = FOUR_POINT;
    bat_space line = bat_euclidean(3);
    coarse = (bat_curve){.space = &line, .points = points, .count = 2};
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_UNSUPPORTED);
}

/// Two points, or three, and a stencil that reaches many times around.
static void short_polygons_have_wide_stencils(void **state)
{
    (void)state;
    double points[MAX_COORDINATES];
    bat_random random = bat_random_seed(5);
    bat_curve_angle_rule rule = wide_rule(7, false);
    for (int s = 0; s < 3; s++)
        for (size_t count = 2; count < 5; count++)
            for (int closed = 0; closed < 2; closed++)
            {
                bat_space space = space_of(SURFACES[s]);
                (void)make_polygon(SURFACES[s], EVEN, count, &random, points);
                bat_curve coarse = {.space = &space, .points = points, .count = count, .closed = closed == 1};
                if (closed == 1 && count == 2)
                    continue;
                bat_curve_refine_options how = with_rule(&rule, 3);
                bat_curve fine = refined(&coarse, &how);
                check_status(bat_space_check(&space, fine.points, fine.count, NULL), BAT_OK);
                bat_curve_free(&fine);
            }
}

// The first levels alone

/// The rule FOUR_POINT, which checks the numbers that it is given. Vertex 0 is the only one where the polygon turns right.
static void numbered_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *angles,
                            void *scratch)
{
    assert_true(view->level < rule->levels);
    ptrdiff_t count = (ptrdiff_t)COUNT << view->level;
    for (ptrdiff_t j = 0; j < (ptrdiff_t)view->count && view->level == 0; j++)
        assert_true((view->angles[j] < 0) == ((view->first + j) % count == 0));
    four_point_angles(rule, view, angles, scratch);
}

/// A polygon around the origin with one vertex drawn inwards.
static void make_dented(double *points)
{
    for (size_t j = 0; j < COUNT; j++)
        polar_point(GEOMETRY_PLANE, j == 0 ? 0.9 : 1, 2 * PI * (double)j / COUNT + 0.02 * sin(5.0 * (double)j),
                    points + 2 * j);
}

static void a_rule_may_decide_the_first_levels(void **state)
{
    (void)state;
    double points[2 * COUNT];
    make_dented(points);
    bat_space plane = bat_euclidean(2);
    bat_curve coarse = {.space = &plane, .points = points, .count = COUNT, .closed = true};
    bat_curve_angle_rule rule = FOUR_POINT;
    rule.levels = 2;
    rule.angles = numbered_angles;
    for (int closed = 0; closed < 2; closed++)
    {
        coarse.closed = closed == 1;
        rule.angles = closed ? numbered_angles : four_point_angles;
        bat_curve_refine_options first = options("angle-4", 2), last = options("angle-6:turns=1", 2),
                                 all = with_rule(&rule, 4);
        bat_curve half = refined(&coarse, &first), expected = refined(&half, &last), fine = refined(&coarse, &all);
        check_same(&fine, &expected, 1e-12);
        bat_curve_free(&half);
        bat_curve_free(&expected);
        bat_curve_free(&fine);
        all.levels = 1;
        first.levels = 1;
        expected = refined(&coarse, &first);
        fine = refined(&coarse, &all);
        check_same(&fine, &expected, 1e-12);
        bat_curve_free(&expected);
        bat_curve_free(&fine);
    }
}

static double largest_turn(const bat_curve *curve)
{
    bat_curve_fairness_values fairness;
    check_status(bat_curve_fairness(curve, NULL, &fairness, NULL), BAT_OK);
    return fairness.g1;
}

/// The largest exterior angle halves with every level, between edges of any lengths; more slowly where a short edge bounds
/// the turn of a long one.
static void turns_halve_on_uneven_polygons(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    double points[3 * COUNT], angles[COUNT];
    for (int s = 0; s < 3; s++)
    {
        bat_space space = space_of(SURFACES[s]);
        double sum = 0;
        for (size_t j = 0; j < COUNT; j++)
            angles[j] = sum += exp(1.5 * (2 * bat_random_uniform(&random) - 1));
        for (size_t j = 0; j < COUNT; j++)
            polar_point(SURFACES[s], 0.3 + 0.1 * bat_random_uniform(&random), 2 * PI * angles[j] / sum,
                        points + j * space.point_dim);
        bat_curve coarse = {.space = &space, .points = points, .count = COUNT, .closed = true};
        bat_curve_refine_options five = options("angle-6:turns=1", 5), nine = options("angle-6:turns=1", 9);
        bat_curve before = refined(&coarse, &five), after = refined(&coarse, &nine);
        assert_true(largest_turn(&after) < 0.2 * largest_turn(&before));
        assert_true(largest_turn(&after) > 0.05 * largest_turn(&before));
        bat_curve_free(&before);
        bat_curve_free(&after);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rule_may_decide_the_first_levels),
        cmocka_unit_test(turns_halve_on_uneven_polygons),
        cmocka_unit_test(the_four_point_scheme_can_be_a_rule),
        cmocka_unit_test(a_rule_sees_angles_and_lengths),
        cmocka_unit_test(threads_and_a_users_space_make_no_difference),
        cmocka_unit_test(angles_are_clipped_and_must_be_numbers),
        cmocka_unit_test(wrong_rules_are_refused),
        cmocka_unit_test(short_polygons_have_wide_stencils),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
