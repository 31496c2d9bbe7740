// The ways in which the same average is computed: vector code, general code, rotations, rigid motions, products and spaces
// of a user give the same where tangents are long and angles wide; L_H of eq. (4.10); spaces and tangents that are refused.

#include "hermite_helpers.h"
#include "motion/hermite_average.h"

#include "batten/motion.h"
#include "batten/research/motion_study.h"

enum
{
    PAIRS = 10000,
    WAYS = 6
};

static const double AGREED = 1e-12;

/// A user's rotations or spheres without a geodesic(): exp(t log) is used.
static bat_space bare(const bat_space *space)
{
    bat_space own = *space;
    own.geodesic = NULL;
    return own;
}

/// Spaces in which the same pair can be written, `before` numbers after others that are 0.
typedef struct way_list
{
    bat_space spaces[WAYS];
    size_t point_before[WAYS], tangent_before[WAYS], count;
    bat_space factors[2];
    bat_product_factors alone, behind;
} way_list;

static void add_way(way_list *list, bat_space space, size_t before)
{
    list->spaces[list->count] = space;
    list->point_before[list->count] = list->tangent_before[list->count] = before;
    list->count++;
}

/// The space itself, whose refinement is vector code; under other functions; as a product of its own; behind a line.
static void make_ways(const bat_space *space, way_list *list)
{
    bat_space product;
    *list = (way_list){.factors = {bat_euclidean(1), *space}};
    list->alone = (bat_product_factors){.spaces = &list->factors[1], .count = 1};
    list->behind = (bat_product_factors){.spaces = list->factors, .count = 2};
    add_way(list, *space, 0);
    add_way(list, plain(&list->factors[1]), 0);
    check_status(bat_product(&list->alone, &product, NULL), BAT_OK);
    add_way(list, product, 0);
    check_status(bat_product(&list->behind, &product, NULL), BAT_OK);
    add_way(list, product, 1);
}

/// What a way makes of a pair: a status, and for BAT_OK a point and a direction in the numbers of the first space.
typedef struct way_result
{
    bat_status status;
    double point[DIM], direction[DIM];
} way_result;

static void write_pair(const way_list *list, size_t way, const hermite_pair *pair, double points[2 * DIM],
                       double tangents[2 * DIM])
{
    const bat_space *space = &list->spaces[way], *first = &list->spaces[0];
    size_t n = space->point_dim, k = space->tangent_dim, at = list->point_before[way], to = list->tangent_before[way];
    memset(points, 0, 2 * DIM * sizeof *points);
    memset(tangents, 0, 2 * DIM * sizeof *tangents);
    memcpy(points + at, pair->p0, first->point_dim * sizeof *points);
    memcpy(points + n + at, pair->p1, first->point_dim * sizeof *points);
    memcpy(tangents + to, pair->v0, first->tangent_dim * sizeof *tangents);
    memcpy(tangents + k + to, pair->v1, first->tangent_dim * sizeof *tangents);
}

static way_result read_result(const way_list *list, size_t way, bat_status status, const double *point,
                              const double *direction)
{
    way_result result = {.status = status};
    if (status != BAT_OK)
        return result;
    memcpy(result.point, point + list->point_before[way], list->spaces[0].point_dim * sizeof *point);
    memcpy(result.direction, direction + list->tangent_before[way], list->spaces[0].tangent_dim * sizeof *point);
    return result;
}

static way_result by_average(const way_list *list, size_t way, const hermite_pair *pair, double weight)
{
    const bat_space *space = &list->spaces[way];
    double points[2 * DIM], tangents[2 * DIM], point[DIM], direction[DIM];
    write_pair(list, way, pair, points, tangents);
    bat_status status = bat_hermite_average(space, points, tangents, points + space->point_dim,
                                            tangents + space->tangent_dim, weight, point, direction);
    return read_result(list, way, status, point, direction);
}

static way_result by_refinement(const way_list *list, size_t way, const hermite_pair *pair)
{
    const bat_space *space = &list->spaces[way];
    double points[2 * DIM], tangents[2 * DIM];
    write_pair(list, way, pair, points, tangents);
    bat_hermite_curve coarse = {.space = space, .points = points, .tangents = tangents, .count = 2}, fine = {0};
    bat_hermite_refine_options how = bat_hermite_refine_defaults();
    how.levels = 1;
    bat_status status = bat_hermite_refine(&coarse, &how, &fine, NULL);
    if (status != BAT_OK)
        return (way_result){.status = status};
    way_result result = read_result(list, way, status, fine.points + space->point_dim, fine.tangents + space->tangent_dim);
    bat_hermite_free(&fine);
    return result;
}

/// Whether two results are the same to AGREED; unit quaternions up to their sign.
static bool agree(const bat_space *space, const way_result *a, const way_result *b)
{
    if (a->status != BAT_OK || b->status != BAT_OK)
        return a->status == b->status;
    double away[2] = {0}, turned = 0;
    for (size_t i = 0; i < space->point_dim; i++)
    {
        away[0] = fmax(away[0], fabs(a->point[i] - b->point[i]));
        away[1] = fmax(away[1], fabs(a->point[i] + b->point[i]));
    }
    for (size_t i = 0; i < space->tangent_dim; i++)
        turned = fmax(turned, fabs(a->direction[i] - b->direction[i]));
    return (away[0] <= AGREED || (strcmp(space->name, "rotation") == 0 && away[1] <= AGREED)) && turned <= AGREED;
}

static size_t disagreeing_pairs(const bat_space *space, const way_result *results, size_t count)
{
    size_t pairs = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++)
            pairs += !agree(space, &results[i], &results[j]);
    return pairs;
}

/// Two points 0.1 to pi - 1e-9 apart, half of them near that, with directions or tangents of any angle to the edge.
static hermite_pair wide_pair(const bat_space *space, bat_random *random, double tangent_length)
{
    hermite_pair pair;
    double way[DIM], uniform = bat_random_uniform(random);
    double angle = bat_random_uniform(random) < 0.5 ? 0.1 + (PI - 0.1 - 1e-9) * uniform : PI - pow(10, -9 * uniform);
    space->random_point(space, random, pair.p0);
    random_direction(space, random, pair.p0, way);
    for (size_t i = 0; i < space->tangent_dim; i++)
        way[i] *= angle;
    check_status(space->exp(space, pair.p0, way, pair.p1), BAT_OK);
    random_direction(space, random, pair.p0, pair.v0);
    random_direction(space, random, pair.p1, pair.v1);
    for (size_t i = 0; i < space->tangent_dim; i++)
    {
        pair.v0[i] *= tangent_length;
        pair.v1[i] *= tangent_length;
    }
    return pair;
}

/// How far the averages of a pair lie along the tangents: the reach of eq. (3.6).
static double reach_of(const bat_space *space, const hermite_pair *pair)
{
    double way[2][DIM], length = space->distance(space, pair->p0, pair->p1);
    if (space->log(space, pair->p0, pair->p1, way[0]) != BAT_OK || space->log(space, pair->p1, pair->p0, way[1]) != BAT_OK)
        return 0;
    double turn = acos(fmax(-1, fmin(1, space->inner(space, pair->p0, pair->v0, way[0]) / length))) +
                  acos(fmax(-1, fmin(1, -space->inner(space, pair->p1, pair->v1, way[1]) / length)));
    return length / (3 * pow(cos(turn / 4), 2));
}

static void check_ways(const way_list *list, uint64_t seed)
{
    const bat_space *space = &list->spaces[0];
    bat_random random = bat_random_seed(seed);
    size_t apart = 0, long_legs = 0, done = 0;
    for (size_t trial = 0; trial < PAIRS; trial++)
    {
        way_result results[2 * WAYS] = {0};
        hermite_pair pair = wide_pair(space, &random, 1);
        double weight = bat_random_uniform(&random);
        size_t count = 0;
        for (size_t way = 0; way < list->count; way++)
        {
            results[count++] = by_average(list, way, &pair, 0.5);
            results[count++] = by_refinement(list, way, &pair);
        }
        apart += disagreeing_pairs(space, results, count) > 0;
        done += results[0].status == BAT_OK;
        long_legs += results[0].status == BAT_OK && reach_of(space, &pair) > PI;
        count = 0;
        for (size_t way = 0; way < list->count; way++)
            results[count++] = by_average(list, way, &pair, weight);
        apart += disagreeing_pairs(space, results, count) > 0;
    }
    if (apart > 0)
        fail_msg("%s: the averages of %zu pairs depend on the code", space->name, apart);
    // The data are those that the test is about.
    assert_true(done > PAIRS * 9 / 10 && long_legs > PAIRS / 10);
}

static void rotations_average_the_same_in_all_code(void **state)
{
    (void)state;
    way_list list;
    bat_space rotation = bat_rotation(), rigid;
    make_ways(&rotation, &list);
    check_status(bat_rigid(0.7, &rigid, NULL), BAT_OK);
    add_way(&list, rigid, 3);
    add_way(&list, bare(&rotation), 0);
    check_ways(&list, 1);
}

static void spheres_average_the_same_in_all_code(void **state)
{
    (void)state;
    way_list list;
    bat_space sphere = bat_sphere(2);
    make_ways(&sphere, &list);
    check_ways(&list, 3);
}

/// The point at 1/2 is that of De Casteljau's algorithm with shortest geodesics only, written out.
static void legs_are_shortest_geodesics(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    bat_random random = bat_random_seed(5);
    for (size_t trial = 0; trial < 1000; trial++)
    {
        hermite_pair pair = wide_pair(&rotation, &random, 1);
        double rows[4][DIM], u[DIM], point[DIM], direction[DIM], alpha = reach_of(&rotation, &pair);
        if (bat_hermite_average(&rotation, pair.p0, pair.v0, pair.p1, pair.v1, 0.5, point, direction) != BAT_OK ||
            alpha > 20)
            continue;
        memcpy(rows[0], pair.p0, sizeof rows[0]);
        memcpy(rows[3], pair.p1, sizeof rows[3]);
        for (size_t c = 0; c < 3; c++)
            u[c] = alpha * pair.v0[c];
        check_status(rotation.exp(&rotation, pair.p0, u, rows[1]), BAT_OK);
        for (size_t c = 0; c < 3; c++)
            u[c] = -alpha * pair.v1[c];
        check_status(rotation.exp(&rotation, pair.p1, u, rows[2]), BAT_OK);
        for (size_t round = 0; round < 3; round++)
            for (size_t j = 0; j + round < 3; j++)
            {
                double middle[DIM];
                check_status(bat_space_geodesic(&rotation, rows[j], rows[j + 1], 0.5, middle), BAT_OK);
                memcpy(rows[j], middle, sizeof middle);
            }
        check_near(rotation.distance(&rotation, rows[0], point), 0, 1e-6);
    }
}

/// Straight lines have their length and no turn; a reversed pair has another length: L_H is not symmetric.
static void lengths_of_pairs(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    bat_random random = bat_random_seed(6);
    bat_hermite_length length, back;
    for (size_t s = 0; s < SPACES; s++)
    {
        const bat_space *space = &spaces[s];
        hermite_pair pair = random_pair(space, &random, 0.8, 0);
        check_status(bat_hermite_length_of(space, pair.p0, pair.v0, pair.p1, pair.v1, &length, NULL), BAT_OK);
        check_near(length.path, 0.8, 1e-9);
        check_near(length.turn, 0, 1e-9);
        check_status(bat_hermite_length_of(space, pair.p0, pair.v0, pair.p0, pair.v0, &length, NULL), BAT_OK);
        assert_true(length.path == 0 && length.turn == 0);
        // Reversed directions and order give the same curve the other way.
        pair = random_pair(space, &random, 0.8, 1);
        double v0[DIM], v1[DIM];
        negate(space, pair.v0, v0);
        negate(space, pair.v1, v1);
        check_status(bat_hermite_length_of(space, pair.p0, pair.v0, pair.p1, pair.v1, &length, NULL), BAT_OK);
        check_status(bat_hermite_length_of(space, pair.p1, v1, pair.p0, v0, &back, NULL), BAT_OK);
        check_near(back.path, length.path, 1e-8 * length.path);
        check_near(back.turn, length.turn, 1e-8 * length.path);
    }
    // A quarter of a circle about, in the plane: the directions turn by half a turn in one order, the other way in the
    // other.
    bat_space plane = bat_euclidean(2);
    const double p[2] = {0, 0}, q[2] = {1, 0}, up[2] = {0, 1}, down[2] = {0, -1}, slant[2] = {0.6, 0.8};
    check_status(bat_hermite_length_of(&plane, p, up, q, down, &length, NULL), BAT_OK);
    check_near(length.turn, PI, 1e-7);
    check_near(length.path, 1.57, 0.03);
    check_status(bat_hermite_length_of(&plane, p, slant, q, down, &length, NULL), BAT_OK);
    check_status(bat_hermite_length_of(&plane, q, down, p, slant, &back, NULL), BAT_OK);
    assert_true(fabs(length.path + length.turn - back.path - back.turn) > 0.1);
    check_status(bat_hermite_length_of(&plane, p, up, p, down, &length, NULL), BAT_INVALID_POINT);
}

/// Every function that motions call is asked for by name.
static void missing_functions_are_named(void **state)
{
    (void)state;
    double points[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, tangents[12] = {0, 1, 0, 0, 0, 1, 1, 0, 0}, out[12];
    bat_space sphere = bat_sphere(2), lacking[7];
    const char *const names[7] = {"fault", "project", "distance", "log", "exp", "transport", "inner"};
    for (size_t i = 0; i < 7; i++)
        lacking[i] = sphere;
    lacking[0].fault = NULL;
    lacking[1].project = NULL;
    lacking[2].distance = NULL;
    lacking[3].log = NULL;
    lacking[4].exp = NULL;
    lacking[5].transport = NULL;
    lacking[6].inner = NULL;
    check_status(bat_space_check(&sphere, NULL, 0, NULL), BAT_OK);
    for (size_t i = 0; i < 7; i++)
    {
        bat_hermite_curve keys = {.space = &lacking[i], .points = points, .tangents = tangents, .count = 3}, fine;
        bat_motion_spline *spline;
        bat_hermite_length length;
        bat_error errors[9];
        size_t count = 0;
        check_status(bat_space_check(&lacking[i], NULL, 0, &errors[count++]), BAT_INVALID_ARGUMENT);
        check_status(bat_hermite_check(&keys, &errors[count++]), BAT_INVALID_ARGUMENT);
        check_status(hermite_check(&keys, (hermite_check_parts){.unit = true, .edges = true, .admissible = true}, 1,
                                   &errors[count++]),
                     BAT_INVALID_ARGUMENT);
        check_status(bat_hermite_normalize(&keys, &errors[count++]), BAT_INVALID_ARGUMENT);
        check_status(bat_hermite_refine(&keys, NULL, &fine, &errors[count++]), BAT_INVALID_ARGUMENT);
        check_status(bat_hermite_estimate_tangents(&keys, 2, &errors[count++]), BAT_INVALID_ARGUMENT);
        check_status(bat_motion_spline_make(&keys, NULL, &spline, &errors[count++]), BAT_INVALID_ARGUMENT);
        check_status(
            bat_hermite_length_of(&lacking[i], points, tangents, points + 3, tangents + 3, &length, &errors[count++]),
            BAT_INVALID_ARGUMENT);
        check_status(bat_hermite_average(&lacking[i], points, tangents, points + 3, tangents + 3, 0.5, out, out + 6),
                     BAT_INVALID_ARGUMENT);
        for (size_t k = 0; k < count; k++)
            assert_non_null(strstr(errors[k].text, names[i]));
    }
    bat_space wide = sphere, endless = sphere;
    bat_error error;
    wide.point_dim = BAT_SPACE_MAX_DIM + 1;
    endless.injectivity = NAN;
    check_status(bat_space_check(&wide, NULL, 0, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_space_check(&endless, NULL, 0, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "injectivity"));
    check_status(bat_space_check(NULL, NULL, 0, &error), BAT_INVALID_ARGUMENT);
}

/// Directions are never sampled as velocities.
static void directions_are_not_velocities(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[6] = {0, 0, 2, 0, 3, 5}, tangents[6], times[3] = {0, 1, 3}, point[2];
    bat_hermite_curve keys = {.space = &plane, .points = points, .tangents = tangents, .count = 3}, fine;
    bat_motion_spline *spline;
    bat_error error;
    check_status(bat_hermite_estimate_tangents(&keys, 2, &error), BAT_OK);
    assert_int_equal(keys.kind, BAT_HERMITE_TANGENTS_DIRECTIONS);
    check_status(bat_hermite_refine(&keys, NULL, &fine, &error), BAT_OK);
    assert_int_equal(fine.kind, BAT_HERMITE_TANGENTS_DIRECTIONS);
    check_status(bat_motion_spline_make(&fine, NULL, &spline, &error), BAT_INVALID_ARGUMENT);
    bat_hermite_free(&fine);
    keys.times = times;
    check_status(bat_motion_spline_make(&keys, NULL, &spline, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "not velocities"));
    check_status(bat_hermite_estimate_tangents(&keys, 2, &error), BAT_OK);
    assert_int_equal(keys.kind, BAT_HERMITE_TANGENTS_VELOCITIES);
    check_status(bat_motion_spline_make(&keys, NULL, &spline, &error), BAT_OK);
    bat_motion_spline_free(spline);
    const bat_hermite_linear linear = {bat_hermite_mask_merrien(-0.125, -0.5), BAT_CURVE_BASE_VERTEX};
    check_status(bat_hermite_transport_refine(&keys, &linear, NULL, &fine, &error), BAT_OK);
    assert_int_equal(fine.kind, BAT_HERMITE_TANGENTS_INDEX_DERIVATIVES);
    check_status(bat_motion_spline_make(&fine, NULL, &spline, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "by the index"));
    bat_hermite_free(&fine);
    double half[2] = {0.5, 0}, unit[2] = {1, 0}, out[2];
    check_status(bat_hermite_average(&plane, points, half, points + 2, unit, 0.5, point, out), BAT_INVALID_POINT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rotations_average_the_same_in_all_code),
        cmocka_unit_test(spheres_average_the_same_in_all_code),
        cmocka_unit_test(legs_are_shortest_geodesics),
        cmocka_unit_test(lengths_of_pairs),
        cmocka_unit_test(missing_functions_are_named),
        cmocka_unit_test(directions_are_not_velocities),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
