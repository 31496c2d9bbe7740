// Parameters of least distortion where others crowd: a long finger of a plate.

#include "cloud_helpers.h"

#include "batten/cloud_parameterize.h"
#include "surface/cloud/boundary.h"
#include "surface/cloud/spatial_order.h"
#include "surface/parameterize/weights.h"

static const double PI = 3.14159265358979323846;

/// A plate of 12 rings with a finger of a height, closed by a point, triangulated.
static bat_cloud make_finger(double height)
{
    enum
    {
        AROUND = 14
    };
    bat_cloud cloud = {0}, disc = {0};
    const double radius = 0.2, spacing = 2 * PI * radius / AROUND;
    size_t number = 0;
    add_point(&cloud, 0, 0, height + 0.5 * radius);
    add_ring(&cloud, radius / 2, height + 0.4 * radius, AROUND / 2, 0);
    for (double z = height; z > spacing / 2; z -= spacing)
        add_ring(&cloud, radius, z, AROUND, 0.5 * (double)(number++ % 2));
    for (double r = radius + spacing; r < 1.2; r += spacing)
        add_ring(&cloud, r, 0, (size_t)(2 * PI * r / spacing), 0.3 * (double)(number++ % 3));
    assert_int_equal(canonical_order_apply(&cloud, NULL), BAT_OK);
    assert_int_equal(
        advancing_front_triangulate(&cloud, (advancing_front_options){.scale = 1}, (bat_progress){0}, &disc, NULL), BAT_OK);
    bat_cloud_free(&cloud);
    assert_int_equal(bat_cloud_find_corners(&disc, NULL), BAT_OK);
    return disc;
}

/// The energy of parameters by a method; infinite where a triangle is turned over.
static double energy_by(const bat_cloud *disc, bat_cloud_parameterization method)
{
    double *boundary = malloc(2 * disc->boundary_count * sizeof *boundary);
    double *parameters = malloc(2 * disc->count * sizeof *parameters);
    uint32_t *triangles = malloc(3 * disc->triangle_count * sizeof *triangles);
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.method = method;
    assert_int_equal(bat_cloud_boundary_parameters(disc, BAT_CLOUD_SIDES_CHORD_LENGTH, boundary, NULL), BAT_OK);
    assert_int_equal(bat_cloud_parameterize(disc, boundary, &options, parameters, NULL), BAT_OK);
    double least = INFINITY;
    // Either orientation of the square is right.
    for (size_t turned = 0; turned < 2; turned++)
    {
        dirichlet_map map = {.point_count = disc->count, .boundary_count = disc->boundary_count};
        for (size_t h = 0; h < 3 * disc->triangle_count; h++)
            triangles[h] = disc->triangles[turned == 0 ? h : h / 3 * 3 + 2 - h % 3];
        assert_int_equal(dirichlet_measure(disc->points, triangles, disc->triangle_count, &map, NULL), BAT_OK);
        least = fmin(least, dirichlet_energy(&map, parameters));
        dirichlet_free(&map);
    }
    free(boundary);
    free(parameters);
    free(triangles);
    return least;
}

static void a_crowded_finger_spreads(void **state)
{
    (void)state;
    const double heights[] = {1, 2.5, 4};
    double crowded = 0;
    for (size_t k = 0; k < sizeof heights / sizeof *heights; k++)
    {
        bat_cloud disc = make_finger(heights[k]);
        double before = energy_by(&disc, BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE);
        double after = energy_by(&disc, BAT_CLOUD_PARAMETERIZATION_ISOMETRIC);
        // An isometric map has 4. That of a finger cannot be, but no part of it crowds.
        assert_true(after < 30);
        crowded = fmax(crowded, before);
        bat_cloud_free(&disc);
    }
    assert_true(crowded > 1e12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_crowded_finger_spreads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
