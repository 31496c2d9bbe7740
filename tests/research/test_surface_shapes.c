// Clouds of our own making: drawn from the right distributions, sampled where they say, and of the shapes they are named
// after.
#include "check.h"

#include "batten/research/surface_shapes.h"
#include "linalg/vector.h"
#include "research/shapes/surface_bezier.h"
#include "research/shapes/surface_shape.h"

static bat_cloud make_bezier(const bat_cloud_bezier_options *options, uint64_t seed, double **parameters)
{
    bat_random random = bat_random_seed(seed);
    bat_cloud cloud;
    assert_int_equal(bat_cloud_bezier(options, &random, &cloud, parameters, NULL), BAT_OK);
    return cloud;
}

static bat_cloud make_shape(const char *name, size_t points, uint64_t seed, double **parameters)
{
    bat_cloud cloud;
    assert_int_equal(bat_cloud_shape(name, points, seed, &cloud, parameters, NULL), BAT_OK);
    return cloud;
}

static double distance_between(const double *a, const double *b)
{
    double way[3];
    vector3_subtract(a, b, way);
    return sqrt(vector3_dot(way, way));
}

/// de Casteljau's corner cutting along both parameters.
static void cut_corners(const bezier_surface *surface, const double parameter[2], double point[3])
{
    double net[16][16][3];
    int n = surface->degree;
    for (int j = 0; j <= n; j++)
        for (int i = 0; i <= n; i++)
            memcpy(net[j][i], surface->control[j * (n + 1) + i], sizeof net[j][i]);
    for (int step = n; step > 0; step--)
        for (int j = 0; j < step; j++)
            for (int i = 0; i < step; i++)
                for (int c = 0; c < 3; c++)
                {
                    double u = parameter[0], v = parameter[1];
                    net[j][i][c] = (1 - v) * ((1 - u) * net[j][i][c] + u * net[j][i + 1][c]) +
                                   v * ((1 - u) * net[j + 1][i][c] + u * net[j + 1][i + 1][c]);
                }
    memcpy(point, net[0][0], sizeof net[0][0]);
}

/// Without noise the points are those of the Bézier surface at the parameters handed back, for every degree.
static void bezier_points_lie_on_their_surface(void **state)
{
    (void)state;
    for (int degree = 1; degree <= 15; degree++)
    {
        bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
        options.degree = degree;
        options.interior = 50;
        double *parameters, point[3];
        bat_cloud cloud = make_bezier(&options, 40 + (uint64_t)degree, &parameters);
        bat_random random = bat_random_seed(40 + (uint64_t)degree);
        bezier_surface surface;
        bezier_surface_draw(degree, true, &random, &surface);
        for (size_t i = 0; i < cloud.count; i++)
        {
            cut_corners(&surface, parameters + 2 * i, point);
            check_near(distance_between(cloud.points + 3 * i, point), 0, 1e-14);
        }
        bat_cloud_free(&cloud);
        free(parameters);
    }
}

/// The paper's numbers: 1,000 points inside, 34 on each side, equally spaced, counter-clockwise from (0, 0).
static void bezier_boundary_is_in_order(void **state)
{
    (void)state;
    bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
    double *parameters;
    bat_cloud cloud = make_bezier(&options, 1, &parameters);
    assert_int_equal(cloud.count, 1132);
    assert_int_equal(cloud.boundary_count, 132);
    assert_true(cloud.has_corners);
    assert_null(cloud.order);
    assert_null(cloud.triangles);
    static const double CORNERS[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (size_t s = 0; s < 4; s++)
    {
        assert_int_equal(cloud.corners[s], 33 * s);
        for (size_t i = 0; i < 33; i++)
            for (size_t c = 0; c < 2; c++)
            {
                double from = CORNERS[s][c], to = CORNERS[(s + 1) % 4][c];
                check_near(parameters[2 * (33 * s + i) + c], from + (to - from) * (double)i / 33, 1e-15);
            }
    }
    for (size_t i = 2 * 132; i < 2 * 1132; i++)
        assert_true(parameters[i] >= 0 && parameters[i] < 1);
    bat_cloud_free(&cloud);
    free(parameters);
    options.side = 2;
    options.interior = 0;
    cloud = make_bezier(&options, 1, NULL);
    assert_int_equal(cloud.count, 4);
    assert_int_equal(cloud.boundary_count, 4);
    bat_cloud_free(&cloud);
}

/// Control points fill the boxes of section 4.2: of a uniform distribution over [a, b], the mean is (a + b) / 2, the
/// variance (b - a)^2 / 12, and nothing lies outside.
static void control_points_fill_their_boxes(void **state)
{
    (void)state;
    enum
    {
        DRAWS = 4000
    };
    bat_random random = bat_random_seed(3);
    double sums[9][3] = {{0}}, squares[9][3] = {{0}};
    for (int draw = 0; draw < DRAWS; draw++)
    {
        bezier_surface surface;
        bezier_surface_draw(2, false, &random, &surface);
        for (int k = 0; k < 9; k++)
        {
            const double middle[3] = {k % 3 / 2.0, k / 3 / 2.0, 0}, half[3] = {0.25, 0.25, 1};
            for (int c = 0; c < 3; c++)
            {
                double away = (surface.control[k][c] - middle[c]) / half[c];
                assert_true(fabs(away) <= 1);
                sums[k][c] += away / DRAWS;
                squares[k][c] += away * away / DRAWS;
            }
        }
    }
    for (int k = 0; k < 27; k++)
    {
        // Five standard deviations of the mean, sqrt(1/3 / n), and of the mean square, sqrt(4/45 / n).
        check_near(sums[k / 3][k % 3], 0, 5 * sqrt(1.0 / 3 / DRAWS));
        check_near(squares[k / 3][k % 3], 1.0 / 3, 5 * sqrt(4.0 / 45 / DRAWS));
    }
}

/// A turned surface is the same one in another position, not mirrored; axes point everywhere alike and angles are uniform,
/// so that the mean rotation is the mean of axis axis^T, a third of the identity.
static void surfaces_are_turned_evenly(void **state)
{
    (void)state;
    enum
    {
        DRAWS = 4000
    };
    double mean[3][3] = {{0}};
    for (uint64_t seed = 0; seed < DRAWS; seed++)
    {
        bat_random one = bat_random_seed(seed), other = bat_random_seed(seed);
        bezier_surface still, turned;
        bezier_surface_draw(2, false, &one, &still);
        bezier_surface_draw(2, true, &other, &turned);
        assert_memory_equal(&one, &other, sizeof one);
        double before[3][3], after[3][3], first, second;
        for (int k = 0; k < 2; k++)
        {
            vector3_subtract(still.control[k == 0 ? 2 : 6], still.control[0], before[k]);
            vector3_subtract(turned.control[k == 0 ? 2 : 6], turned.control[0], after[k]);
        }
        vector3_cross(before[0], before[1], before[2]);
        vector3_cross(after[0], after[1], after[2]);
        for (int k = 0; k < 9; k++)
        {
            first = vector3_dot(before[k / 3], before[k % 3]);
            second = vector3_dot(after[k / 3], after[k % 3]);
            check_near(first, second, 1e-12);
        }
        double along = sqrt(vector3_dot(before[2], before[2]));
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                mean[r][c] += after[2][r] * before[2][c] / (along * along) / DRAWS;
    }
    // E[R n n^T] = E[n n^T] / 3, of trace 1/3; each entry is a mean of numbers within [-1, 1].
    check_near(mean[0][0] + mean[1][1] + mean[2][2], 1.0 / 3, 5 / sqrt(DRAWS));
    check_near(mean[0][1] - mean[1][0], 0, 5 / sqrt(DRAWS));
    check_near(mean[0][2] - mean[2][0], 0, 5 / sqrt(DRAWS));
    check_near(mean[1][2] - mean[2][1], 0, 5 / sqrt(DRAWS));
}

/// Noise of the deviation asked for is added to all points, those of the boundary too; surface and parameters stay.
static void noise_is_on_all_points(void **state)
{
    (void)state;
    bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
    options.interior = 4000;
    options.side = 1001;
    double *clean_parameters, *noisy_parameters;
    bat_cloud clean = make_bezier(&options, 9, &clean_parameters);
    options.noise = 0.05;
    bat_cloud noisy = make_bezier(&options, 9, &noisy_parameters);
    assert_int_equal(clean.count, 8000);
    assert_memory_equal(clean_parameters, noisy_parameters, 2 * clean.count * sizeof(double));
    for (int part = 0; part < 2; part++)
    {
        double sum = 0, squares = 0, n = 3 * 4000;
        for (size_t i = 0; i < 3 * 4000; i++)
        {
            double off = noisy.points[3 * 4000 * (size_t)part + i] - clean.points[3 * 4000 * (size_t)part + i];
            sum += off;
            squares += off * off;
        }
        check_near(sum / n, 0, 5 * 0.05 / sqrt(n));
        check_near(squares / n, 0.0025, 5 * 0.0025 * sqrt(2 / n));
    }
    bat_cloud_free(&clean);
    bat_cloud_free(&noisy);
    free(clean_parameters);
    free(noisy_parameters);
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    bat_cloud_bezier_options wrong[6];
    for (int i = 0; i < 6; i++)
        wrong[i] = bat_cloud_bezier_defaults();
    wrong[0].degree = 0;
    wrong[1].degree = 16;
    wrong[2].side = 1;
    wrong[3].noise = -1;
    wrong[4].noise = NAN;
    wrong[5].interior = SIZE_MAX;
    for (int i = 0; i < 6; i++)
    {
        bat_cloud cloud;
        bat_error error;
        bat_status expected = i == 5 ? BAT_TOO_LARGE : BAT_INVALID_ARGUMENT;
        assert_int_equal(bat_cloud_bezier(&wrong[i], &random, &cloud, NULL, &error), expected);
        assert_true(strlen(error.text) > 0);
    }
    bat_cloud cloud;
    assert_int_equal(bat_cloud_shape("boat", 9600, 1, &cloud, NULL, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_cloud_shape(NULL, 9600, 1, &cloud, NULL, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_cloud_shape("hull", 199, 1, &cloud, NULL, NULL), BAT_INVALID_ARGUMENT);
}

/// Every shape passes the checks of clouds, repeats itself for the same seed and differs for another.
static void shapes_are_clouds(void **state)
{
    (void)state;
    for (const char *const *name = bat_cloud_shape_names(); *name != NULL; name++)
        for (size_t points = 200; points <= 20000; points *= 10)
        {
            double *first_parameters, *again_parameters;
            bat_cloud first = make_shape(*name, points, 1, &first_parameters);
            bat_cloud again = make_shape(*name, points, 1, &again_parameters), other = make_shape(*name, points, 2, NULL);
            assert_int_equal(bat_cloud_check(&first, NULL), BAT_OK);
            assert_true(fabs((double)first.count - (double)points) < 0.15 * (double)points);
            assert_int_equal(first.count, again.count);
            assert_memory_equal(first.points, again.points, 3 * first.count * sizeof(double));
            assert_memory_equal(first_parameters, again_parameters, 2 * first.count * sizeof(double));
            assert_memory_not_equal(first.points, other.points, 3 * 150 * sizeof(double));
            for (size_t i = 0; i < 2 * first.count; i++)
                assert_true(first_parameters[i] >= 0 && first_parameters[i] <= 1);
            bat_cloud_free(&first);
            bat_cloud_free(&again);
            bat_cloud_free(&other);
            free(first_parameters);
            free(again_parameters);
        }
}

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/// Distances to the nearest other point, rising. Release them with free().
static double *nearest_distances(const bat_cloud *cloud)
{
    double *nearest = malloc(cloud->count * sizeof *nearest);
    assert_non_null(nearest);
    for (size_t i = 0; i < cloud->count; i++)
    {
        nearest[i] = HUGE_VAL;
        for (size_t k = 0; k < cloud->count; k++)
            if (k != i)
                nearest[i] = fmin(nearest[i], distance_between(cloud->points + 3 * i, cloud->points + 3 * k));
    }
    qsort(nearest, cloud->count, sizeof *nearest, compare_numbers);
    return nearest;
}

/// Hull and blade: points are exactly at their parameters, the boundary goes round the square in order, and points lie
/// evenly.
static void sampled_shapes_are_even(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"hull", "blade"};
    for (int n = 0; n < 2; n++)
    {
        double *parameters, point[3];
        bat_cloud cloud = make_shape(NAMES[n], 3000, 5, &parameters);
        surface_shape shape;
        bat_random random;
        assert_int_equal(cloud.count, 3000);
        assert_true(surface_shape_make(NAMES[n], 5, &shape, &random));
        for (size_t i = 0; i < cloud.count; i++)
        {
            const double *q = parameters + 2 * i;
            shape.at(&shape, q, point);
            assert_memory_equal(point, cloud.points + 3 * i, sizeof point);
            if (i >= cloud.boundary_count)
            {
                assert_true(q[0] > 0 && q[0] < 1 && q[1] > 0 && q[1] < 1);
                continue;
            }
            size_t side = i >= cloud.corners[3] ? 3 : i >= cloud.corners[2] ? 2 : i >= cloud.corners[1];
            assert_true(q[side % 2 == 0] == (side == 1 || side == 2));
            const double *next = parameters + 2 * ((i + 1) % cloud.boundary_count);
            assert_true((next[side % 2] - q[side % 2]) * (side < 2 ? 1 : -1) > 0);
        }
        double *nearest = nearest_distances(&cloud), median = nearest[cloud.count / 2];
        assert_true(nearest[0] > 0.1 * median);
        assert_true(nearest[cloud.count / 20] > 0.5 * median);
        assert_true(nearest[cloud.count - 1] < 2.5 * median);
        free(nearest);
        bat_cloud_free(&cloud);
        free(parameters);
    }
}

/// S_u x S_v by central differences.
static void normal_at(const surface_shape *shape, double u, double v, double normal[3])
{
    const double step = 1e-5;
    double ahead[3], back[3], along[2][3];
    for (int c = 0; c < 2; c++)
    {
        double before[2] = {u, v}, after[2] = {u, v};
        before[c] -= step;
        after[c] += step;
        shape->at(shape, after, ahead);
        shape->at(shape, before, back);
        vector3_subtract(ahead, back, along[c]);
        for (int k = 0; k < 3; k++)
            along[c][k] /= 2 * step;
    }
    vector3_cross(along[0], along[1], normal);
}

/// A ship's side: on the middle plane along stem and keel, outside of it elsewhere, with a flat of side midships, a bulb
/// that reaches forward of the stem above it and a deck that hangs over, for every seed.
static void hulls_are_ships(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++)
    {
        surface_shape shape;
        bat_random random;
        double point[3], normal[3], low = HUGE_VAL, high = -HUGE_VAL;
        assert_true(surface_shape_make("hull", seed, &shape, &random));
        for (int i = 0; i <= 100; i++)
            for (int j = 0; j <= 100; j++)
            {
                double q[2] = {i / 100.0, j / 100.0};
                shape.at(&shape, q, point);
                if (i == 0)
                    check_near(point[1], 0, 1e-15);
                if (j == 0)
                    check_near(point[1], 0, 1e-15);
                assert_true(point[1] >= -1e-15);
                low = fmin(low, point[0]);
                high = fmax(high, point[0]);
                normal_at(&shape, q[0], q[1], normal);
                assert_true(vector3_dot(normal, normal) > 1e-6);
                if (i > 0 && j > 0)
                    assert_true(normal[1] > -1e-3 * sqrt(vector3_dot(normal, normal)) || normal[2] < 0);
            }
        check_near(high - low, 1.06, 0.05);
        normal_at(&shape, 0.5, 0.8, normal);
        check_near(normal[1] / sqrt(vector3_dot(normal, normal)), 1, 0.01);
        normal_at(&shape, 0.5, 0.1, normal);
        check_near(normal[2] / sqrt(vector3_dot(normal, normal)), -1, 0.02);
        double bulb[3], neck[3], deck[3];
        shape.at(&shape, (double[]){0, shape.form.hull.bulb_height}, bulb);
        shape.at(&shape, (double[]){0, 0.55}, neck);
        shape.at(&shape, (double[]){0, 1}, deck);
        assert_true(bulb[0] > neck[0] + 0.02 && deck[0] > neck[0] + 0.02);
    }
}

/// The curvature of a plane curve through three points.
static double curvature_of(const double a[3], const double b[3], const double c[3])
{
    double first[3], second[3], product[3];
    vector3_subtract(b, a, first);
    vector3_subtract(c, a, second);
    vector3_cross(first, second, product);
    return 2 * sqrt(vector3_dot(product, product)) /
           (distance_between(a, b) * distance_between(b, c) * distance_between(a, c));
}

/// A section's nose is that of the parabola y = k sqrt(x), whose radius is k^2 / 2; the gap at the trailing edge is as wide
/// as the form says; normals point outwards.
static void blades_are_round_in_front(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++)
    {
        surface_shape shape;
        bat_random random;
        assert_true(surface_shape_make("blade", seed, &shape, &random));
        const blade_form *form = &shape.form.blade;
        for (int end = 0; end < 2; end++)
        {
            double around[3][3], rims[2][3], chord = end == 0 ? form->root_chord : form->tip_chord;
            double thickness = end == 0 ? form->root_thickness : form->tip_thickness;
            for (int k = 0; k < 3; k++)
                shape.at(&shape, (double[]){0.5 + 1e-3 * (k - 1), end}, around[k]);
            // The greatest of sqrt(x) (1 - x) is 2 / sqrt(27).
            double k = 0.5 * thickness * sqrt(27) / 2;
            check_relative(1 / curvature_of(around[0], around[1], around[2]), 0.5 * k * k * chord, 1e-3);
            shape.at(&shape, (double[]){0, end}, rims[0]);
            shape.at(&shape, (double[]){1, end}, rims[1]);
            check_relative(distance_between(rims[0], rims[1]), 2 * form->opening * chord, 1e-12);
        }
        for (double v = 0.05; v < 1; v += 0.1)
        {
            double suction[3], pressure[3], across[3], normal[3];
            shape.at(&shape, (double[]){0.2, v}, suction);
            shape.at(&shape, (double[]){0.8, v}, pressure);
            vector3_subtract(suction, pressure, across);
            normal_at(&shape, 0.2, v, normal);
            assert_true(vector3_dot(across, normal) > 0);
            normal_at(&shape, 0.8, v, normal);
            assert_true(vector3_dot(across, normal) < 0);
        }
    }
}

/// A scan: no boundary, no order, noise about the surface, a gap, and twice as many points where it went over twice.
static void scans_are_scans(void **state)
{
    (void)state;
    double *parameters, point[3], squares = 0, moments[3] = {0};
    bat_cloud cloud = make_shape("scan", 9600, 4, &parameters);
    surface_shape shape;
    bat_random random;
    assert_true(surface_shape_make("scan", 4, &shape, &random));
    assert_int_equal(cloud.boundary_count, 0);
    assert_false(cloud.has_corners);
    size_t twice = 0, once = 0;
    for (size_t i = 0; i < cloud.count; i++)
    {
        const double *q = parameters + 2 * i;
        shape.at(&shape, q, point);
        double off = distance_between(point, cloud.points + 3 * i);
        squares += off * off / (3 * (double)cloud.count);
        assert_true(hypot(q[0] - 0.615, q[1] - 0.405) > 0.02);
        twice += q[0] > 0.7 && q[0] < 0.85 && q[1] > 0.4 && q[1] < 0.7;
        once += q[0] > 0.15 && q[0] < 0.3 && q[1] > 0.4 && q[1] < 0.7;
        double place = (double)i / (double)cloud.count - 0.5;
        moments[0] += place * (q[1] - 0.5);
        moments[1] += place * place;
        moments[2] += (q[1] - 0.5) * (q[1] - 0.5);
    }
    check_relative(sqrt(squares), 0.0012, 0.03);
    assert_true(twice > 3 * once / 2);
    check_near(moments[0] / sqrt(moments[1] * moments[2]), 0, 0.05);
    bat_cloud_free(&cloud);
    free(parameters);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bezier_points_lie_on_their_surface),
        cmocka_unit_test(bezier_boundary_is_in_order),
        cmocka_unit_test(control_points_fill_their_boxes),
        cmocka_unit_test(surfaces_are_turned_evenly),
        cmocka_unit_test(noise_is_on_all_points),
        cmocka_unit_test(wrong_options_are_refused),
        cmocka_unit_test(shapes_are_clouds),
        cmocka_unit_test(sampled_shapes_are_even),
        cmocka_unit_test(hulls_are_ships),
        cmocka_unit_test(blades_are_round_in_front),
        cmocka_unit_test(scans_are_scans),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
