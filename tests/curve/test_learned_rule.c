// The shipped rule in refinement: what it commutes with, that it keeps points and the bounds of Theorem 1 whatever its
// weights are, and where it is refused. The shipped weights are taken beside random ones, and nothing depends on how good
// they are.

#include "learned_helpers.h"

#include "batten/curve_scheme.h"
#include "learn/weights.h"

enum
{
    COUNT = 15,
    LEVELS = 5,
    WEIGHT_SETS = 4,
    /// Coordinates of what a polygon of so many vertices becomes.
    FINE_COORDINATES = 3 * (COUNT << LEVELS)
};

/// Random weights and the shipped ones.
static learn_parameters sets[WEIGHT_SETS];

static int make_sets(void **state)
{
    (void)state;
    for (size_t i = 0; i < WEIGHT_SETS; i++)
        sets[i] = random_weights(i);
    memcpy(sets[0].values, weights_learned.arrays[0].values, sets[0].total * sizeof(real));
    return 0;
}

static int free_sets(void **state)
{
    (void)state;
    for (size_t i = 0; i < WEIGHT_SETS; i++)
        learn_parameters_free(&sets[i]);
    return 0;
}

/// A polygon, and the same seen otherwise.
typedef struct pair
{
    geometry_surface surface;
    bat_space space;
    bool closed;
    double points[MAX_COORDINATES], other[MAX_COORDINATES];
    bat_curve_refine_options how;
} pair;

static bat_curve curve_of(pair *p, double *points)
{
    return (bat_curve){.space = &p->space, .points = points, .count = COUNT, .closed = p->closed};
}

/// Call `check` for all weights on closed and open polygons of all surfaces.
static void for_all_pairs(void (*check)(pair *p, bat_random *random))
{
    bat_random random = bat_random_seed(1);
    for (size_t w = 0; w < WEIGHT_SETS; w++)
        for (size_t s = 0; s < 3; s++)
            for (int closed = 0; closed < 2; closed++)
                for (int kind = EVEN; kind <= UNEVEN; kind++)
                {
                    const bat_curve_angle_rule rule = learned_rule(sets[w].values);
                    pair p = {.surface = SURFACES[s], .space = space_of(SURFACES[s]), .closed = closed == 1};
                    p.how = by_rule(&rule, bat_random_uniform(&random), LEVELS);
                    (void)make_polygon(SURFACES[s], (polygon_kind)kind, COUNT, &random, p.points);
                    check(&p, &random);
                }
}

// Symmetries

/// What the network sees is rounded to single precision: where a number is rounded otherwise, so is the new vertex.
static void check_points(const double *actual, const double *expected, size_t dim)
{
    for (size_t i = 0; i < dim; i++)
        check_near(actual[i], expected[i], 1e-5);
}

/// A random isometry, with or without a mirror image first: they move the refined curve as they move the polygon.
static void check_isometries(pair *p, bat_random *random)
{
    size_t dim = p->space.point_dim;
    for (int mirror = 0; mirror < 2; mirror++)
    {
        static double expected[FINE_COORDINATES];
        geometry_isometry isometry = geometry_isometry_random(p->surface, 0.8, random);
        memcpy(p->other, p->points, sizeof p->points);
        for (size_t j = 0; j < COUNT && mirror; j++)
            p->other[j * dim + 1] *= -1;
        geometry_isometry_apply(&isometry, p->other, COUNT, p->other);
        bat_curve coarse = curve_of(p, p->points), moved = curve_of(p, p->other);
        bat_curve fine = refined(&coarse, &p->how), fine_moved = refined(&moved, &p->how);
        memcpy(expected, fine.points, fine.count * dim * sizeof *expected);
        for (size_t j = 0; j < fine.count && mirror; j++)
            expected[j * dim + 1] *= -1;
        geometry_isometry_apply(&isometry, expected, fine.count, expected);
        for (size_t j = 0; j < fine.count; j++)
            check_points(fine_moved.points + j * dim, expected + j * dim, dim);
        bat_curve_free(&fine);
        bat_curve_free(&fine_moved);
    }
}

static void isometries_and_mirror_images_commute(void **state)
{
    (void)state;
    for_all_pairs(check_isometries);
}

static void check_reversal(pair *p, bat_random *random)
{
    (void)random;
    size_t dim = p->space.point_dim;
    for (size_t j = 0; j < COUNT; j++)
        memcpy(p->other + j * dim, p->points + (COUNT - 1 - j) * dim, dim * sizeof *p->points);
    bat_curve coarse = curve_of(p, p->points), reversed = curve_of(p, p->other);
    bat_curve fine = refined(&coarse, &p->how), fine_reversed = refined(&reversed, &p->how);
    // The refined curve begins where the polygon does, at vertex COUNT - 1 of the other.
    size_t last = (COUNT - 1) << LEVELS;
    for (size_t k = 0; k < fine.count; k++)
        check_points(fine_reversed.points + k * dim, fine.points + (last + fine.count - k) % fine.count * dim, dim);
    bat_curve_free(&fine);
    bat_curve_free(&fine_reversed);
}

static void reversal_commutes(void **state)
{
    (void)state;
    for_all_pairs(check_reversal);
}

static void check_shift(pair *p, bat_random *random)
{
    if (!p->closed)
        return;
    size_t dim = p->space.point_dim, shift = 1 + bat_random_bits(random) % (COUNT - 1);
    for (size_t j = 0; j < COUNT; j++)
        memcpy(p->other + j * dim, p->points + (j + shift) % COUNT * dim, dim * sizeof *p->points);
    bat_curve coarse = curve_of(p, p->points), shifted = curve_of(p, p->other);
    bat_curve fine = refined(&coarse, &p->how), fine_shifted = refined(&shifted, &p->how);
    for (size_t k = 0; k < fine.count; k++)
        check_points(fine_shifted.points + k * dim, fine.points + (k + (shift << LEVELS)) % fine.count * dim, dim);
    bat_curve_free(&fine);
    bat_curve_free(&fine_shifted);
}

static void closed_curves_begin_anywhere(void **state)
{
    (void)state;
    for_all_pairs(check_shift);
}

static void check_scaling(pair *p, bat_random *random)
{
    (void)random;
    static const double scales[] = {1e-290, 3e-9, 7, 1e160, 1e290};
    if (p->surface != GEOMETRY_PLANE)
        return;
    for (size_t s = 0; s < sizeof scales / sizeof *scales; s++)
    {
        for (size_t i = 0; i < 2 * COUNT; i++)
            p->other[i] = scales[s] * p->points[i];
        bat_curve coarse = curve_of(p, p->points), scaled = curve_of(p, p->other);
        bat_curve fine = refined(&coarse, &p->how), fine_scaled = refined(&scaled, &p->how);
        for (size_t i = 0; i < 2 * fine.count; i++)
            fine_scaled.points[i] /= scales[s];
        for (size_t k = 0; k < fine.count; k++)
            check_points(fine_scaled.points + 2 * k, fine.points + 2 * k, 2);
        bat_curve_free(&fine);
        bat_curve_free(&fine_scaled);
    }
}

static void scaling_the_plane_commutes(void **state)
{
    (void)state;
    for_all_pairs(check_scaling);
}

/// Fairness and weights change the curve: what commutes is no curve that the network has no part in.
static void the_network_has_its_part(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2);
    pair p = {.surface = GEOMETRY_PLANE, .space = bat_euclidean(2), .closed = true};
    (void)make_polygon(GEOMETRY_PLANE, UNEVEN, COUNT, &random, p.points);
    bat_curve coarse = curve_of(&p, p.points);
    const bat_curve_angle_rule rule = learned_rule(sets[1].values), other = learned_rule(sets[2].values);
    const bat_curve_refine_options hows[] = {by_rule(&rule, 0, 1), by_rule(&rule, 1, 1), by_rule(&other, 0, 1)};
    bat_curve fine = refined(&coarse, &hows[0]);
    for (int k = 1; k < 3; k++)
    {
        bat_curve changed = refined(&coarse, &hows[k]);
        double most = 0;
        for (size_t i = 0; i < 2 * fine.count; i++)
            most = fmax(most, fabs(fine.points[i] - changed.points[i]));
        assert_true(most > 1e-4);
        bat_curve_free(&changed);
    }
    bat_curve_free(&fine);
}

static void check_given_points(pair *p, bat_random *random)
{
    (void)random;
    size_t dim = p->space.point_dim;
    bat_curve coarse = curve_of(p, p->points), fine = refined(&coarse, &p->how);
    assert_int_equal(fine.count, p->closed ? COUNT << LEVELS : ((COUNT - 1) << LEVELS) + 1);
    check_status(bat_space_check(&p->space, fine.points, fine.count, NULL), BAT_OK);
    for (size_t j = 0; j < COUNT; j++)
        assert_memory_equal(fine.points + (j << LEVELS) * dim, p->points + j * dim, dim * sizeof(double));
    bat_curve_free(&fine);
}

static void given_points_are_kept(void **state)
{
    (void)state;
    for_all_pairs(check_given_points);
}

/// Thousands of vertices, so that there are several chunks of edges, and several curves at once.
static void threads_make_no_difference(void **state)
{
    (void)state;
    static const int threads[] = {2, 5};
    bat_random random = bat_random_seed(5);
    bat_space sphere = bat_sphere(2);
    double points[MAX_COORDINATES];
    (void)make_polygon(GEOMETRY_SPHERE, EVEN, 101, &random, points);
    bat_curve coarse = {.space = &sphere, .points = points, .count = 101, .closed = true};
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = bat_curve_scheme_learned(0.3);
    how.levels = 6;
    how.threads = 1;
    bat_curve one = refined(&coarse, &how), many[8], several[8];
    for (size_t i = 0; i < 8; i++)
        many[i] = coarse;
    for (size_t t = 0; t < 2; t++)
    {
        how.threads = threads[t];
        bat_curve fine = refined(&coarse, &how);
        assert_memory_equal(one.points, fine.points, 3 * one.count * sizeof(double));
        bat_curve_free(&fine);
        check_status(bat_curves_refine(many, 8, &how, several, NULL), BAT_OK);
        for (size_t i = 0; i < 8; i++)
        {
            assert_memory_equal(one.points, several[i].points, 3 * one.count * sizeof(double));
            bat_curve_free(&several[i]);
        }
    }
    bat_curve_free(&one);
}

// Theorem 1

/// Weights that want harm.
typedef enum harm
{
    TINY,
    LARGE,
    HUGE_SIGNS, ///< +-1e30, which overflow on the way
    GREATEST,   ///< the largest numbers there are
    ALL_ALIKE,
    RANDOM_SIZES,
    HARMS
} harm;

static void fill_weights(learn_parameters *parameters, harm kind, bat_random *random)
{
    for (size_t i = 0; i < parameters->total; i++)
    {
        double x = symmetric_uniform(random), sign = x < 0 ? -1 : 1;
        const double values[HARMS] = {
            [TINY] = 1e-30 * x,       [LARGE] = 100 * x,  [HUGE_SIGNS] = 1e30 * sign,
            [GREATEST] = 3e38 * sign, [ALL_ALIKE] = 1e30, [RANDOM_SIZES] = sign * pow(10, 30 * symmetric_uniform(random))};
        parameters->values[i] = (real)values[kind];
    }
}

/// What makes polygons harder than polygon_kind does.
enum
{
    SPIKES = KINDS, ///< the polygon runs back on itself, but for 1e-3
    RIM,            ///< disk: to 1e-6 from the rim
    ALL_KINDS
};

static geometry_polygon make_hard(geometry_surface surface, int kind, size_t count, bat_random *random, double *points)
{
    if (kind < KINDS)
        return make_polygon(surface, (polygon_kind)kind, count, random, points);
    for (size_t j = 0; j < count; j++)
    {
        double at = 6.283 * (double)j / (double)count;
        if (kind == RIM && surface == GEOMETRY_DISK)
            polar_point(surface, 1 - pow(10, -6 * bat_random_uniform(random)), at, points + 2 * j);
        else
            polar_point(surface, j % 2 ? 0.7 : 0.1, 1e-3 * bat_random_uniform(random), points + j * geometry_dim(surface));
    }
    return (geometry_polygon){points, count, surface, true};
}

/// The angle at p from the edge to q to that to the new vertex: p's exterior angle when one comes from q's reflection.
static double insertion_angle(const bat_space *space, const double *p, const double *apex, const double *q)
{
    double tangent[3], before[3];
    check_status(space->log(space, p, q, tangent), BAT_OK);
    for (size_t i = 0; i < space->tangent_dim; i++)
        tangent[i] *= -0.5;
    check_status(space->exp(space, p, tangent, before), BAT_OK);
    return space->exterior_angle(space, before, p, apex);
}

/// One level after the other, looking at all new vertices.
static void check_levels(const bat_curve_angle_rule *rule, const geometry_polygon *polygon, double fairness)
{
    enum
    {
        DEPTH = 6
    };
    bat_space space = space_of(polygon->surface);
    size_t dim = space.point_dim;
    const bat_curve_refine_options how = by_rule(rule, fairness, 1);
    bat_curve curve = {
        .space = &space, .points = (double *)(uintptr_t)polygon->points, .count = polygon->count, .closed = polygon->closed};
    for (int level = 0; level < DEPTH; level++)
    {
        bat_curve fine = refined(&curve, &how);
        check_status(bat_space_check(&space, fine.points, fine.count, NULL), BAT_OK);
        for (size_t j = 1; j < fine.count; j += 2)
        {
            const double *p = fine.points + (j - 1) * dim, *q = fine.points + (j + 1) % fine.count * dim;
            // Differences of coordinates of 1 have only so many digits.
            double tolerance = 1e-14 / space.distance(&space, p, q) + 1e-9;
            assert_true(fabs(insertion_angle(&space, p, fine.points + j * dim, q)) <= BAT_CURVE_ANGLE_LIMIT + tolerance);
        }
        if (level > 0)
            bat_curve_free(&curve);
        curve = fine;
    }
    bat_curve_free(&curve);
}

static void no_weights_make_an_invalid_vertex(void **state)
{
    (void)state;
    static const double fairnesses[] = {0, 1, 0.25, 0.75};
    bat_random random = bat_random_seed(4);
    double points[MAX_COORDINATES];
    learn_parameters parameters = {0};
    check_status(learned_network_make(&parameters, NULL), BAT_OK);
    const bat_curve_angle_rule rule = learned_rule(parameters.values);
    for (int kind = 0; kind < HARMS; kind++)
        for (int s = 0; s < 3; s++)
            for (int shape = 0; shape < ALL_KINDS; shape++)
            {
                fill_weights(&parameters, (harm)kind, &random);
                geometry_polygon polygon = make_hard(SURFACES[s], shape, 8, &random, points);
                if (shape % 2)
                    polygon.closed = false;
                check_levels(&rule, &polygon, fairnesses[(kind + s + shape) % 4]);
            }
    learn_parameters_free(&parameters);
}

/// Where nothing can be had from the network, there remains the six-point rule, which on a circle's even points is exact.
static void overflowing_weights_leave_the_six_point_rule(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(6);
    bat_space plane = bat_euclidean(2);
    double points[2 * COUNT];
    learn_parameters parameters = {0};
    check_status(learned_network_make(&parameters, NULL), BAT_OK);
    fill_weights(&parameters, GREATEST, &random);
    const bat_curve_angle_rule rule = learned_rule(parameters.values);
    for (size_t j = 0; j < COUNT; j++)
        polar_point(GEOMETRY_PLANE, 2, 2 * PI * (double)j / COUNT, points + 2 * j);
    bat_curve coarse = {.space = &plane, .points = points, .count = COUNT, .closed = true};
    const bat_curve_refine_options how = by_rule(&rule, 0.5, LEVELS);
    bat_curve fine = refined(&coarse, &how);
    for (size_t j = 0; j < fine.count; j++)
        check_near(hypot(fine.points[2 * j], fine.points[2 * j + 1]), 2, 1e-13);
    bat_curve_free(&fine);
    learn_parameters_free(&parameters);
}

// Arguments

static void fairness_is_kept(void **state)
{
    (void)state;
    const double cases[] = {0, 0.25, 1};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_scheme learned = bat_curve_scheme_learned(cases[i]);
        assert_true(learned.fairness == cases[i]);
        assert_int_equal(learned.kind, BAT_CURVE_SCHEME_KIND_ANGLE);
        assert_string_equal(learned.rule->name, "learned");
        check_status(bat_curve_scheme_check(&learned, NULL), BAT_OK);
    }
}

/// The same text for the struct and for the name.
static void fairness_out_of_range_is_refused(void **state)
{
    (void)state;
    double points[] = {0, 0, 1, 0, 1, 1};
    bat_space plane = bat_euclidean(2);
    bat_curve coarse = {.space = &plane, .points = points, .count = 3, .closed = true}, fine;
    bat_curve_refine_options how = bat_curve_refine_defaults();
    const double cases[] = {7, -0.1, NAN, INFINITY};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_error error;
        how.scheme = bat_curve_scheme_learned(cases[i]);
        check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_INVALID_ARGUMENT);
        assert_non_null(strstr(error.text, "fairness is"));
    }
    bat_error error;
    check_status(bat_curve_scheme_by_name("learned:fairness=7", &how.scheme, &error), BAT_INVALID_ARGUMENT);
    assert_string_equal(error.text, "fairness is 7, but must be from 0 to 1");
}

static void check_unsupported(const bat_space *space)
{
    const double coordinates[] = {1, 0, 0, 0, 0.6, 0.8, 0, 0, 0, 0.6, 0.8, 0, 0, 0, 0.6, 0.8};
    double points[16];
    memcpy(points, coordinates, sizeof points);
    bat_curve coarse = {.space = space, .points = points, .count = 4}, fine;
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = bat_curve_scheme_learned(0);
    bat_error error = {0};
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_UNSUPPORTED);
    assert_true(strlen(error.text) > 0 && strchr(error.text, '\n') == NULL);
}

static void other_spaces_are_refused(void **state)
{
    (void)state;
    bat_space space = bat_sphere(3), solid = bat_euclidean(3), own = bat_euclidean(2);
    check_unsupported(&space);
    check_unsupported(&solid);
    own.distance = solid.distance == own.distance ? bat_disk().distance : solid.distance; // no longer the library's plane
    check_unsupported(&own);
}

/// As few vertices as can be refined at all, fewer than the rule sees.
static void short_curves_are_refined(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(7);
    double points[MAX_COORDINATES];
    for (int s = 0; s < 3; s++)
        for (size_t count = 2; count < 6; count++)
            for (int closed = 0; closed < (count > 2 ? 2 : 1); closed++)
            {
                bat_space space = space_of(SURFACES[s]);
                (void)make_polygon(SURFACES[s], EVEN, count, &random, points);
                bat_curve coarse = {.space = &space, .points = points, .count = count, .closed = closed == 1};
                bat_curve_refine_options how = bat_curve_refine_defaults();
                how.scheme = bat_curve_scheme_learned(0.5);
                bat_curve fine = refined(&coarse, &how);
                check_status(bat_space_check(&space, fine.points, fine.count, NULL), BAT_OK);
                // Two points are a straight line.
                double middle = count > 2 ? 0 : space.distance(&space, points, fine.points + 16 * space.point_dim);
                if (count == 2)
                    check_relative(2 * middle, space.distance(&space, points, points + space.point_dim), 1e-9);
                bat_curve_free(&fine);
            }
}

/// The brake of rough lines: 12 vertices of a ring tell nothing, 24 do.
static void small_rings_have_no_brake(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(11);
    const bat_curve_angle_rule network = learned_rule(weights_learned.arrays[0].values);
    bat_space plane = bat_euclidean(2);
    for (size_t count = 12; count <= 24; count += 12)
    {
        double points[2 * 24];
        for (size_t i = 0; i < count; i++)
        {
            double angle = 6.283185307179586 * ((double)i + 0.3 * bat_random_uniform(&random)) / (double)count;
            double radius = (i % 2 == 0 ? 1 : 0.8) + 0.1 * bat_random_uniform(&random);
            points[2 * i] = radius * cos(angle);
            points[2 * i + 1] = radius * sin(angle);
        }
        bat_curve ring = {.space = &plane, .points = points, .count = count, .closed = true};
        bat_curve_refine_options how = bat_curve_refine_defaults();
        how.scheme = bat_curve_scheme_learned(0);
        bat_curve braked = refined(&ring, &how);
        how.scheme = bat_curve_scheme_angle_rule(&network);
        how.scheme.fairness = 0;
        bat_curve free_of_brakes = refined(&ring, &how);
        bool same = memcmp(braked.points, free_of_brakes.points, 2 * braked.count * sizeof(double)) == 0;
        assert_int_equal(same, count == 12);
        bat_curve_free(&braked);
        bat_curve_free(&free_of_brakes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(isometries_and_mirror_images_commute),
        cmocka_unit_test(reversal_commutes),
        cmocka_unit_test(closed_curves_begin_anywhere),
        cmocka_unit_test(scaling_the_plane_commutes),
        cmocka_unit_test(the_network_has_its_part),
        cmocka_unit_test(given_points_are_kept),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(no_weights_make_an_invalid_vertex),
        cmocka_unit_test(overflowing_weights_leave_the_six_point_rule),
        cmocka_unit_test(fairness_is_kept),
        cmocka_unit_test(fairness_out_of_range_is_refused),
        cmocka_unit_test(other_spaces_are_refused),
        cmocka_unit_test(short_curves_are_refined),
        cmocka_unit_test(small_rings_have_no_brake),
    };
    return cmocka_run_group_tests(tests, make_sets, free_sets);
}
