// The triangulation of clouds that are discs: deep shapes, and what is no disc.

#include "cloud_helpers.h"

#include "surface/cloud/boundary.h"
#include "surface/cloud/spatial_order.h"

#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

/// Append a ring of points at a distance, every other one turned by half a step.
static void add_even_ring(bat_cloud *cloud, double radius, double height, double spacing, size_t number)
{
    size_t count = radius > 0 ? (size_t)ceil(2 * PI * radius / spacing) : 1;
    add_ring(cloud, radius, height, count, 0.5 * (double)(number % 2));
}

/// A plate with a finger: a cylinder with a round end. The last ring is the edge of the plate.
/// @param edge receives the number of points of the last ring
static bat_cloud make_finger(double radius, size_t *edge)
{
    bat_cloud cloud = {0};
    const double spacing = 0.06, height = 1.5;
    size_t number = 0;
    for (double angle = 0; angle < PI / 2; angle += spacing / radius)
        add_even_ring(&cloud, radius * sin(angle), height + radius * cos(angle), spacing, number++);
    for (double z = height; z > spacing; z -= spacing)
        add_even_ring(&cloud, radius, z, spacing, number++);
    for (double r = radius + spacing; r < 1; r += spacing)
        add_even_ring(&cloud, r, 0, spacing, number++);
    size_t before = cloud.count;
    add_even_ring(&cloud, 1, 0, spacing, number);
    *edge = cloud.count - before;
    return cloud;
}

static void add_noise(bat_cloud *cloud, double sigma)
{
    bat_random random = bat_random_seed(3);
    for (size_t k = 0; k < 3 * cloud->count; k++)
        cloud->points[k] += sigma * bat_random_normal(&random);
}

static double longest_side(const bat_cloud *disc)
{
    double longest = 0;
    for (size_t h = 0; h < 3 * disc->triangle_count; h++)
    {
        const double *a = disc->points + 3 * (size_t)disc->triangles[h];
        const double *b = disc->points + 3 * (size_t)disc->triangles[h / 3 * 3 + (h + 1) % 3];
        longest = fmax(longest,
                       sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2])));
    }
    return longest;
}

static void a_finger_is_a_disc(void **state)
{
    (void)state;
    const double noises[] = {0, 0.006};
    for (size_t n = 0; n < 2; n++)
    {
        size_t edge;
        bat_cloud cloud = make_finger(0.2, &edge), disc;
        add_noise(&cloud, noises[n]);
        assert_int_equal(canonical_order_apply(&cloud, NULL), BAT_OK);
        assert_int_equal(
            advancing_front_triangulate(&cloud, (advancing_front_options){.scale = 1}, (bat_progress){0}, &disc, NULL),
            BAT_OK);
        assert_int_equal(disc.count, cloud.count);
        assert_in_range(disc.boundary_count, edge - edge / 10, edge + edge / 10);
        // Euler's formula: a disc of V points, B of them on the boundary, has 2 V - B - 2 triangles.
        assert_int_equal(disc.triangle_count, 2 * disc.count - disc.boundary_count - 2);
        assert_true(longest_side(&disc) < 0.2);
        for (size_t i = 0; i < disc.boundary_count; i++)
            assert_true(hypot(disc.points[3 * i], disc.points[3 * i + 1]) > 0.88);
        bat_cloud_free(&cloud);
        bat_cloud_free(&disc);
    }
}

static void check_refused(bat_cloud *cloud)
{
    bat_cloud disc = {0};
    const double scales[] = {0.55, 0.65, 0.8, 1};
    add_noise(cloud, 0.003);
    assert_int_equal(canonical_order_apply(cloud, NULL), BAT_OK);
    for (size_t k = 0; k < sizeof scales / sizeof *scales; k++)
        assert_int_equal(advancing_front_triangulate(cloud, (advancing_front_options){.scale = scales[k]}, (bat_progress){0},
                                                     &disc, NULL),
                         BAT_NO_CONVERGENCE);
    assert_null(disc.points);
    bat_cloud_free(cloud);
}

static void what_is_no_disc_is_refused(void **state)
{
    (void)state;
    const double spacing = 0.08;
    size_t number = 0;
    bat_cloud ball = {0}, tube = {0}, band = {0};
    for (double angle = 0; angle < PI; angle += spacing)
        add_even_ring(&ball, sin(angle), cos(angle), spacing, number++);
    add_even_ring(&ball, 0, -1.001, spacing, 0);
    check_refused(&ball);
    for (double z = 0; z < 1.5; z += spacing)
        add_even_ring(&tube, 0.5, z, spacing, number++);
    check_refused(&tube);
    // A Moebius band.
    for (double angle = 0; angle < 2 * PI - 0.01; angle += 2 * PI / 80)
        for (double w = -0.36; w < 0.37; w += spacing)
        {
            double radius = 1 + w * cos(angle / 2);
            add_point(&band, radius * cos(angle), radius * sin(angle), w * sin(angle / 2));
        }
    check_refused(&band);
}

/// A leg that is flat at the ankle: the triangles across are smaller than those that continue it.
static void an_ankle_stays_open(void **state)
{
    (void)state;
    for (int spares = 0; spares < 2; spares++)
    {
        size_t edge;
        bat_cloud leg = make_finger(0.15, &edge), disc = {0};
        for (size_t i = 0; i < leg.count; i++)
            leg.points[3 * i] *= 1 - 0.85 * exp(-40 * (leg.points[3 * i + 2] - 0.9) * (leg.points[3 * i + 2] - 0.9));
        add_noise(&leg, 0.001);
        assert_int_equal(canonical_order_apply(&leg, NULL), BAT_OK);
        const advancing_front_options options = {.scale = 0.65, .spares_thin = spares == 1};
        assert_int_equal(advancing_front_triangulate(&leg, options, (bat_progress){0}, &disc, NULL),
                         spares == 1 ? BAT_OK : BAT_NO_CONVERGENCE);
        if (spares == 1)
            assert_int_equal(disc.triangle_count, 2 * disc.count - disc.boundary_count - 2);
        bat_cloud_free(&disc);
        bat_cloud_free(&leg);
    }
}

static void points_of_a_plane_have_no_tetrahedra(void **state)
{
    (void)state;
    bat_cloud plate = {0}, disc = {0};
    bat_error error = {0};
    for (size_t i = 0; i < 100; i++)
        add_point(&plate, (double)(i % 10), (double)(i / 10), 0);
    assert_int_equal(
        advancing_front_triangulate(&plate, (advancing_front_options){.scale = 1}, (bat_progress){0}, &disc, &error),
        BAT_NO_CONVERGENCE);
    assert_true(error.text[0] != '\0');
    bat_cloud_free(&plate);
}

static bool stop_at_once(void *context, double fraction)
{
    (void)context;
    (void)fraction;
    return false;
}

static void it_can_be_stopped(void **state)
{
    (void)state;
    size_t edge;
    bat_cloud cloud = make_finger(0.2, &edge), disc = {0};
    const bat_progress progress = {.report = stop_at_once};
    assert_int_equal(advancing_front_triangulate(&cloud, (advancing_front_options){.scale = 1}, progress, &disc, NULL),
                     BAT_CANCELLED);
    bat_cloud_free(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_finger_is_a_disc),  cmocka_unit_test(what_is_no_disc_is_refused),
        cmocka_unit_test(an_ankle_stays_open), cmocka_unit_test(points_of_a_plane_have_no_tetrahedra),
        cmocka_unit_test(it_can_be_stopped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
