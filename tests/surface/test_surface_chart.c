// What our network for clouds sees and what it moves: the boundary's parameters carried on, the polynomial patch, the chart.

#include "patch_clouds.h"

#include "research/train/surface_network_tape.h"

// Helpers

/// x -> size turn x + shift
typedef struct motion
{
    double turn[3][3], shift[3], size;
} motion;

/// A rotation about an axis of no special kind (Rodrigues), then a size and a shift.
static motion motion_of(double angle, double size, double shift)
{
    const double axis[3] = {2.0 / 7, -3.0 / 7, 6.0 / 7};
    double c = cos(angle), s = sin(angle);
    motion made = {.size = size, .shift = {shift, -2 * shift, 0.5 * shift}};
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
        {
            double cross = i == j ? 0 : (j == (i + 1) % 3 ? -1 : 1) * axis[3 - i - j];
            made.turn[i][j] = (i == j ? c : 0) + (1 - c) * axis[i] * axis[j] + s * cross;
        }
    return made;
}

static void move_points(const motion *m, double *points, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        double x[3];
        memcpy(x, points + 3 * i, sizeof x);
        for (size_t a = 0; a < 3; a++)
            points[3 * i + a] = m->size * (m->turn[a][0] * x[0] + m->turn[a][1] * x[1] + m->turn[a][2] * x[2]) + m->shift[a];
    }
}

static double *numbers(size_t count)
{
    double *made = calloc(count > 0 ? count : 1, sizeof *made);
    assert_non_null(made);
    return made;
}

static double largest_difference(const double *a, const double *b, size_t count)
{
    double largest = 0;
    for (size_t i = 0; i < count; i++)
    {
        assert_true(isfinite(a[i]) && isfinite(b[i]));
        largest = fmax(largest, fabs(a[i] - b[i]));
    }
    return largest;
}

static double *extend(const bat_cloud *cloud, const double *boundary, const double *points, size_t count)
{
    biharmonic_extension extension;
    double *parameters = numbers(2 * count);
    check_status(biharmonic_extension_make(cloud, boundary, &extension, NULL), BAT_OK);
    biharmonic_extension_evaluate(&extension, points, count, parameters);
    biharmonic_extension_free(&extension);
    return parameters;
}

// The extension

/// The plane of the square within the unit box.
static void tilted_plane(double u, double v, double place[3])
{
    place[0] = 0.1 + 0.6 * u + 0.2 * v;
    place[1] = 0.7 - 0.3 * u + 0.2 * v;
    place[2] = 0.2 + 0.1 * u + 0.5 * v;
}

/// A closed line that lies in no plane.
static void bent_loop(double u, double v, double place[3])
{
    place[0] = 0.1 + 0.8 * u;
    place[1] = 0.1 + 0.7 * v;
    place[2] = 0.5 + 0.3 * u * u - 0.4 * v * v * u;
}

static void affine_maps_are_carried_on_exactly(void **state)
{
    (void)state;
    for (int bent = 0; bent < 2; bent++)
    {
        patch made = patch_scatter(bent ? bent_loop : tilted_plane, 12, 100, 0, 5);
        size_t bound = made.cloud.boundary_count, interior = made.cloud.count - bound;
        for (size_t i = 0; i < made.cloud.count; i++)
        {
            const double *x = made.cloud.points + 3 * i;
            made.parameters[2 * i] = 0.2 + 0.3 * x[0] - 0.1 * x[1] + 0.2 * x[2];
            made.parameters[2 * i + 1] = 0.3 - 0.2 * x[0] + 0.5 * x[1] + 0.1 * x[2];
        }
        double *found = extend(&made.cloud, made.parameters, made.cloud.points + 3 * bound, interior);
        assert_true(largest_difference(found, made.parameters + 2 * bound, 2 * interior) < 1e-7);
        free(found);
        patch_free(&made);
    }
}

/// lambda is 1e-6 where there is no noise, times weights that say by how much the map bends.
static void clean_boundaries_keep_their_parameters(void **state)
{
    (void)state;
    patch made = patch_scatter(bent_loop, 20, 0, 0, 1);
    size_t bound = made.cloud.boundary_count;
    biharmonic_extension extension;
    check_status(biharmonic_extension_make(&made.cloud, made.parameters, &extension, NULL), BAT_OK);
    double *found = numbers(2 * bound), lambda = 1e-6 + 5 * extension.noise;
    assert_true(extension.noise < 1e-5);
    biharmonic_extension_evaluate(&extension, made.cloud.points, bound, found);
    for (size_t i = 0; i < 2 * bound; i++)
    {
        check_near(found[i], made.parameters[i], 1e-4);
        // The equation of centre i: what the map leaves is lambda times the centre's weight.
        double unclamped = made.parameters[i] - lambda * extension.weights[i];
        check_near(found[i], fmin(fmax(unclamped, 0), 1), 1e-9);
    }
    biharmonic_extension_free(&extension);
    free(found);
    patch_free(&made);
}

/// About three quarters of it: noise along the loop moves points to where others may have been.
static void noise_of_the_loop_is_measured(void **state)
{
    (void)state;
    static const double NOISES[] = {0.001, 0.003, 0.01};
    for (size_t k = 0; k < 3; k++)
    {
        double share = 0;
        for (uint64_t seed = 0; seed < 10; seed++)
        {
            patch made = patch_scatter(bent_loop, 40, 0, NOISES[k], seed);
            biharmonic_extension extension;
            check_status(biharmonic_extension_make(&made.cloud, made.parameters, &extension, NULL), BAT_OK);
            share += extension.noise / NOISES[k] / 10;
            biharmonic_extension_free(&extension);
            patch_free(&made);
        }
        check_near(share, 0.78, 0.08);
    }
}

static void turning_and_moving_change_no_extension(void **state)
{
    (void)state;
    for (uint64_t noisy = 0; noisy < 2; noisy++)
    {
        patch made = patch_scatter(bent_loop, 25, 300, 0.02 * (double)noisy, 7 + noisy);
        size_t bound = made.cloud.boundary_count, interior = made.cloud.count - bound;
        double *before = extend(&made.cloud, made.parameters, made.cloud.points + 3 * bound, interior);
        motion m = motion_of(1.1, 1, 3);
        move_points(&m, made.cloud.points, made.cloud.count);
        double *after = extend(&made.cloud, made.parameters, made.cloud.points + 3 * bound, interior);
        assert_true(largest_difference(before, after, 2 * interior) < 1e-7);
        free(before);
        free(after);
        patch_free(&made);
    }
}

/// Four points, loops in one line, and loops of more points than the system takes.
static void short_straight_and_long_loops_are_carried_on(void **state)
{
    (void)state;
    static const size_t SIDES[] = {2, 3, 129, 130, 400};
    for (size_t k = 0; k < sizeof SIDES / sizeof *SIDES; k++)
    {
        patch made = patch_scatter(tilted_plane, SIDES[k], 50, 0, k);
        size_t bound = made.cloud.boundary_count, interior = made.cloud.count - bound;
        double *found = extend(&made.cloud, made.parameters, made.cloud.points + 3 * bound, interior);
        assert_true(largest_difference(found, made.parameters + 2 * bound, 2 * interior) < 2e-2);
        free(found);
        for (size_t i = 0; i < 3 * bound; i++)
            made.cloud.points[i] = (double)(i / 3) / (double)bound;
        found = extend(&made.cloud, made.parameters, made.cloud.points + 3 * bound, interior);
        for (size_t i = 0; i < 2 * interior; i++)
            assert_true(found[i] >= 0 && found[i] <= 1);
        free(found);
        patch_free(&made);
    }
}

// The descriptor

/// Random parameters, and points of a patch of degree 6 in monomials there.
static void sample_polynomial(size_t count, uint64_t seed, double *parameters, double *points)
{
    bat_random random = bat_random_seed(seed);
    double terms[PATCH_TERMS][3];
    for (size_t k = 0; k < PATCH_TERMS; k++)
        for (size_t d = 0; d < 3; d++)
            terms[k][d] = 0.05 * bat_random_normal(&random);
    for (size_t i = 0; i < count; i++)
    {
        double u = parameters[2 * i] = bat_random_uniform(&random), v = parameters[2 * i + 1] = bat_random_uniform(&random);
        for (size_t d = 0; d < 3; d++)
        {
            double x = d == 0 ? u : d == 1 ? v : 0.3;
            for (size_t a = 0; a <= PATCH_DEGREE; a++)
                for (size_t b = 0; b <= PATCH_DEGREE; b++)
                    x += terms[a * (PATCH_DEGREE + 1) + b][d] * pow(u, (double)a) * pow(v, (double)b);
            points[3 * i + d] = x;
        }
    }
}

static void legendre_polynomials_are_orthogonal(void **state)
{
    (void)state;
    double products[PATCH_DEGREE + 1][PATCH_DEGREE + 1] = {{0}}, values[PATCH_DEGREE + 1];
    const size_t steps = 2000; // of the midpoint rule
    for (size_t i = 0; i < steps; i++)
    {
        legendre_polynomials(((double)i + 0.5) / (double)steps, PATCH_DEGREE, values);
        for (size_t a = 0; a <= PATCH_DEGREE; a++)
            for (size_t b = 0; b <= PATCH_DEGREE; b++)
                products[a][b] += values[a] * values[b] / (double)steps;
    }
    for (size_t a = 0; a <= PATCH_DEGREE; a++)
        for (size_t b = 0; b <= PATCH_DEGREE; b++)
            check_near(products[a][b], a == b ? 1 / (double)(2 * a + 1) : 0, 1e-4);
    legendre_polynomials(1, PATCH_DEGREE, values);
    for (size_t a = 0; a <= PATCH_DEGREE; a++)
        check_near(values[a], 1, 1e-14);
}

/// Costs of 1e-7 times the square of at most 72 are all that keeps the patch from being met.
static void patches_of_the_degree_are_met(void **state)
{
    (void)state;
    const size_t count = 700;
    double *parameters = numbers(2 * count), *points = numbers(3 * count);
    sample_polynomial(count, 3, parameters, points);
    polynomial_patch descriptor;
    check_status(polynomial_patch_fit(points, parameters, count, 0, &descriptor, NULL), BAT_OK);
    assert_true(descriptor.residual < 1e-4);
    for (size_t i = 0; i < count; i++)
    {
        double u[PATCH_DEGREE + 1], v[PATCH_DEGREE + 1];
        legendre_polynomials(parameters[2 * i], PATCH_DEGREE, u);
        legendre_polynomials(parameters[2 * i + 1], PATCH_DEGREE, v);
        for (size_t d = 0; d < 3; d++)
        {
            double x = 0;
            for (size_t k = 0; k < PATCH_TERMS; k++)
                x += descriptor.terms[k][d] * u[k / (PATCH_DEGREE + 1)] * v[k % (PATCH_DEGREE + 1)];
            check_near(x, points[3 * i + d], 1e-3);
        }
    }
    free(parameters);
    free(points);
}

static void see(const double *points, const double *parameters, size_t count, double noise, double *features)
{
    polynomial_patch descriptor;
    check_status(polynomial_patch_fit(points, parameters, count, noise, &descriptor, NULL), BAT_OK);
    assert_true(polynomial_patch_features(&descriptor, features));
}

/// The cost of noise is in the cloud's units, which a turn does not change but a size does.
static void place_turn_and_size_are_not_seen(void **state)
{
    (void)state;
    static const size_t COUNTS[] = {7, 60, 700};
    for (size_t k = 0; k < 6; k++)
    {
        size_t count = COUNTS[k / 2];
        double noise = k % 2 == 0 ? 0 : 0.02, before[PATCH_FEATURES], after[PATCH_FEATURES];
        double *parameters = numbers(2 * count), *points = numbers(3 * count);
        sample_polynomial(count, 10 + k, parameters, points);
        see(points, parameters, count, noise, before);
        motion m = motion_of(2.2, k % 2 == 0 ? 0.4 : 1, 0.3);
        move_points(&m, points, count);
        see(points, parameters, count, noise, after);
        assert_true(largest_difference(before, after, PATCH_FEATURES) < 1e-8);
        for (size_t i = 0; i < count; i++)
            points[3 * i + 1] *= -1;
        see(points, parameters, count, noise, after);
        for (size_t i = 0; i < PATCH_FEATURES; i++)
            check_near(after[i], i % 3 == 2 ? -before[i] : before[i], 1e-8);
        free(parameters);
        free(points);
    }
}

/// The terms of P_1(u) and P_1(v) span a parallelogram of area 1 in the plane of the first two axes, that of u along the
/// first.
static void the_frame_is_that_of_the_first_terms(void **state)
{
    (void)state;
    const size_t count = 200;
    double *parameters = numbers(2 * count), *points = numbers(3 * count), features[PATCH_FEATURES];
    sample_polynomial(count, 4, parameters, points);
    see(points, parameters, count, 0, features);
    const double *u = features + 3 * (size_t)PATCH_DEGREE, *v = features;
    assert_true(u[0] > 0 && v[1] > 0);
    check_near(u[1], 0, 1e-14);
    check_near(u[2], 0, 1e-14);
    check_near(v[2], 0, 1e-14);
    check_near(u[0] * v[1], 1, 1e-13);
    free(parameters);
    free(points);
}

static void patches_without_a_plane_are_not_seen(void **state)
{
    (void)state;
    const size_t count = 50;
    double *parameters = numbers(2 * count), *points = numbers(3 * count), features[PATCH_FEATURES];
    polynomial_patch descriptor;
    bat_random random = bat_random_seed(1);
    // All in one line of space.
    for (size_t i = 0; i < count; i++)
    {
        parameters[2 * i] = bat_random_uniform(&random);
        parameters[2 * i + 1] = bat_random_uniform(&random);
        for (size_t d = 0; d < 3; d++)
            points[3 * i + d] = 0.5 * (parameters[2 * i] + parameters[2 * i + 1]);
    }
    check_status(polynomial_patch_fit(points, parameters, count, 0, &descriptor, NULL), BAT_OK);
    assert_false(polynomial_patch_features(&descriptor, features));
    parameters[17] = NAN;
    check_status(polynomial_patch_fit(points, parameters, count, 0, &descriptor, NULL), BAT_NO_CONVERGENCE);
    free(parameters);
    free(points);
}

/// A patch of known shape: (u, v, height) with a hill.
static void hill(double u, double v, double place[3])
{
    place[0] = u;
    place[1] = v;
    place[2] = 0.8 * u * (1 - u) * v * (1 - v) + 0.1 * u * u * u;
}

/// The unit normal of the hill.
static void normal_of_hill(double u, double v, double normal[3])
{
    double x = 0.8 * (1 - 2 * u) * v * (1 - v) + 0.3 * u * u, y = 0.8 * u * (1 - u) * (1 - 2 * v);
    double length = sqrt(x * x + y * y + 1);
    normal[0] = -x / length;
    normal[1] = -y / length;
    normal[2] = 1 / length;
}

static void steps_lead_to_the_foot(void **state)
{
    (void)state;
    patch made = patch_scatter(hill, 20, 400, 0, 2);
    polynomial_patch descriptor;
    check_status(polynomial_patch_fit(made.cloud.points, made.parameters, made.cloud.count, 0, &descriptor, NULL), BAT_OK);
    bat_random random = bat_random_seed(6);
    for (int k = 0; k < 100; k++)
    {
        double foot[2] = {0.1 + 0.8 * bat_random_uniform(&random), 0.1 + 0.8 * bat_random_uniform(&random)};
        double place[3], normal[3], height = 0.1 * (bat_random_uniform(&random) - 0.5), step[2];
        double at[2] = {foot[0] + 0.06 * (bat_random_uniform(&random) - 0.5),
                        foot[1] + 0.06 * (bat_random_uniform(&random) - 0.5)};
        hill(foot[0], foot[1], place);
        normal_of_hill(foot[0], foot[1], normal);
        for (size_t d = 0; d < 3; d++)
            place[d] += height * normal[d];
        double far = hypot(at[0] - foot[0], at[1] - foot[1]);
        for (int round = 0; round < 12; round++)
        {
            polynomial_patch_step(&descriptor, place, at, step);
            at[0] += step[0];
            at[1] += step[1];
            // The point's height times the curvature is what Gauss and Newton leave out.
            if (round == 0)
                assert_true(hypot(at[0] - foot[0], at[1] - foot[1]) < 0.15 * far);
        }
        check_near(at[0], foot[0], 1e-5);
        check_near(at[1], foot[1], 1e-5);
    }
    const double nowhere[3] = {100, -100, 0}, middle[2] = {0.5, 0.5};
    double step[2];
    polynomial_patch_step(&descriptor, nowhere, middle, step);
    assert_true(step[0] == 0.2 && step[1] == -0.2);
    patch_free(&made);
}

// The chart

/// @param memory receives what the chart keeps
static surface_chart chart_of(const patch *made, double **memory)
{
    surface_chart chart;
    *memory = numbers(4 * made->cloud.count);
    check_status(surface_chart_make(&made->cloud, made->parameters, *memory, &chart, NULL), BAT_OK);
    assert_int_equal(chart.count, made->cloud.count - made->cloud.boundary_count);
    return chart;
}

static void draw_moves(double size, uint64_t seed, double moves[CHART_MOVES])
{
    bat_random random = bat_random_seed(seed);
    for (size_t k = 0; k < CHART_MOVES; k++)
        moves[k] = size * bat_random_normal(&random);
}

static void derivatives_of_moves_are_those_of_differences(void **state)
{
    (void)state;
    patch made = patch_scatter(hill, 20, 150, 0.003, 3);
    double *memory, moves[CHART_MOVES], by_moves[CHART_MOVES] = {0};
    surface_chart chart = chart_of(&made, &memory);
    double *by = numbers(2 * chart.count), *sides[2] = {numbers(2 * chart.count), numbers(2 * chart.count)};
    draw_moves(0.003, 1, moves);
    surface_chart_move(&chart, moves, sides[0]);
    bat_random random = bat_random_seed(8);
    // Those that are held at the rim have no derivative, and are left out here.
    for (size_t i = 0; i < 2 * chart.count; i++)
        by[i] = sides[0][i] > 1e-3 && sides[0][i] < 1 - 1e-3 ? bat_random_normal(&random) : 0;
    surface_chart_move_back(&chart, moves, by, by_moves);
    surface_chart_move_back(&chart, moves, by, by_moves); // it adds
    const double step = 1e-5;
    for (size_t k = 0; k < CHART_MOVES; k++)
    {
        double kept = moves[k], difference = 0;
        for (int side = 0; side < 2; side++)
        {
            moves[k] = kept + (side == 0 ? -step : step);
            surface_chart_move(&chart, moves, sides[side]);
        }
        moves[k] = kept;
        for (size_t i = 0; i < 2 * chart.count; i++)
            difference += by[i] * (sides[1][i] - sides[0][i]) / (2 * step);
        check_near(0.5 * by_moves[k], difference, 1e-8);
    }
    for (int side = 0; side < 2; side++)
        free(sides[side]);
    free(by);
    free(memory);
    patch_free(&made);
}

/// Points on the rim that have no step stay, whatever the field; none leaves the square.
static void the_field_leaves_the_rim_where_it_is(void **state)
{
    (void)state;
    patch made = patch_allocate(9, 0);
    size_t count = made.cloud.boundary_count;
    surface_chart chart = {.count = count, .parameters = made.parameters, .steps = numbers(2 * count)};
    double moves[CHART_MOVES], *moved = numbers(2 * count);
    draw_moves(1, 2, moves);
    surface_chart_move(&chart, moves, moved);
    assert_memory_equal(moved, made.parameters, 2 * count * sizeof *moved);
    free(chart.steps);
    free(moved);
    patch_free(&made);
}

static void parameters_stay_in_the_square(void **state)
{
    (void)state;
    patch made = patch_scatter(hill, 12, 300, 0.05, 4);
    double *memory, moves[CHART_MOVES];
    surface_chart chart = chart_of(&made, &memory);
    double *moved = numbers(2 * chart.count);
    static const double SIZES[] = {0, 0.1, 10, 1e300};
    for (size_t k = 0; k < 4; k++)
    {
        draw_moves(SIZES[k], k, moves);
        surface_chart_move(&chart, moves, moved);
        for (size_t i = 0; i < 2 * chart.count; i++)
            assert_true(moved[i] >= 0 && moved[i] <= 1);
    }
    free(moved);
    free(memory);
    patch_free(&made);
}

/// Without a word of the network: the true parameters, but for what coefficients cost where points are fewer than these.
static void planes_need_no_network(void **state)
{
    (void)state;
    static const size_t SIDES[] = {2, 5, 30}, INTERIORS[] = {0, 1, 500};
    for (size_t k = 0; k < 9; k++)
    {
        patch made = patch_scatter(tilted_plane, SIDES[k / 3], INTERIORS[k % 3], 0, k);
        double *memory, moves[CHART_MOVES] = {0};
        surface_chart chart = chart_of(&made, &memory);
        double *moved = numbers(2 * chart.count);
        surface_chart_move(&chart, moves, moved);
        assert_true(chart.has_features);
        assert_false(chart.folded);
        assert_true(largest_difference(moved, made.parameters + 2 * made.cloud.boundary_count, 2 * chart.count) < 5e-4);
        free(moved);
        free(memory);
        patch_free(&made);
    }
}

/// What is left of a sphere without a cap of half a radian around its lowest point, evenly filled by the square.
static void deep_sphere(double u, double v, double place[3])
{
    double x = 2 * u - 1, y = 2 * v - 1, reach = fmax(fabs(x), fabs(y)), turn = atan2(y, x);
    double height = 1 - reach * reach * (1 + cos(0.5)), from_axis = sqrt(1 - height * height);
    place[0] = 0.5 + 0.5 * from_axis * cos(turn);
    place[1] = 0.5 + 0.5 * from_axis * sin(turn);
    place[2] = 0.5 + 0.5 * height;
}

static void deep_shapes_are_known(void **state)
{
    (void)state;
    patch_surface *const surfaces[] = {hill, patch_waves, deep_sphere};
    for (size_t k = 0; k < 3; k++)
        for (size_t noisy = 0; noisy < 2; noisy++)
        {
            patch made = patch_scatter(surfaces[k], k == 2 ? 8 : 20, 1000, noisy == 1 ? 0.02 : 0, k);
            double *memory;
            surface_chart chart = chart_of(&made, &memory);
            assert_int_equal(chart.folded, k == 2);
            free(memory);
            patch_free(&made);
        }
}

/// All interior points next to each other.
static void crowded_points_are_no_different(void **state)
{
    (void)state;
    patch made = patch_scatter(tilted_plane, 6, 40, 0, 9);
    size_t bound = made.cloud.boundary_count;
    double middle[3];
    tilted_plane(0.3, 0.6, middle);
    for (size_t i = 3 * bound; i < 3 * made.cloud.count; i++)
        made.cloud.points[i] = middle[i % 3] + 1e-12 * (double)i;
    double *memory;
    surface_chart chart = chart_of(&made, &memory);
    for (size_t i = 0; i < 2 * chart.count; i++)
        check_near(chart.parameters[i], i % 2 == 0 ? 0.3 : 0.6, 1e-4);
    assert_false(chart.folded);
    free(memory);
    patch_free(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(affine_maps_are_carried_on_exactly),
        cmocka_unit_test(clean_boundaries_keep_their_parameters),
        cmocka_unit_test(noise_of_the_loop_is_measured),
        cmocka_unit_test(turning_and_moving_change_no_extension),
        cmocka_unit_test(short_straight_and_long_loops_are_carried_on),
        cmocka_unit_test(legendre_polynomials_are_orthogonal),
        cmocka_unit_test(patches_of_the_degree_are_met),
        cmocka_unit_test(place_turn_and_size_are_not_seen),
        cmocka_unit_test(the_frame_is_that_of_the_first_terms),
        cmocka_unit_test(patches_without_a_plane_are_not_seen),
        cmocka_unit_test(steps_lead_to_the_foot),
        cmocka_unit_test(derivatives_of_moves_are_those_of_differences),
        cmocka_unit_test(the_field_leaves_the_rim_where_it_is),
        cmocka_unit_test(parameters_stay_in_the_square),
        cmocka_unit_test(planes_need_no_network),
        cmocka_unit_test(deep_shapes_are_known),
        cmocka_unit_test(crowded_points_are_no_different),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
