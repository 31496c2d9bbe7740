// The quintic spline: what it reproduces, its order and smoothness, its invariances, and that it serves every space.

#include "check.h"
#include "refine_helpers.h"

#include "batten/batten.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_POINTS = 64
};

static bat_curve refine(const bat_space *space, double *points, size_t count, bool closed, const char *name, size_t levels)
{
    const bat_curve coarse = {.space = space, .points = points, .count = count, .closed = closed};
    bat_curve_refine_options how = bat_curve_refine_defaults();
    bat_curve fine = {0};
    bat_error error;
    how.scheme = scheme(name);
    how.levels = levels;
    how.simple = BAT_CURVE_SIMPLE_NEVER;
    if (bat_curve_refine(&coarse, &how, &fine, &error) != BAT_OK)
        fail_msg("%s in the %s: %s", name, space->name, error.text);
    return fine;
}

/// A polynomial of degree 4 at uniform parameters comes back, up to the ends.
static void quartics_are_reproduced(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * 9];
    for (size_t i = 0; i < 9; i++)
    {
        double x = (double)i - 4;
        points[2 * i] = x;
        points[2 * i + 1] = 0.02 * x * x * x * x - 0.1 * x * x * x + 0.3 * x * x - x + 2;
    }
    for (size_t count = 5; count <= 9; count++)
    {
        bat_curve fine = refine(&plane, points, count, false, "quintic:parameters=uniform", 4);
        assert_int_equal(fine.count, 16 * (count - 1) + 1);
        for (size_t i = 0; i < fine.count; i++)
        {
            double x = (double)i / 16 - 4;
            check_near(fine.points[2 * i], x, 1e-13);
            check_near(fine.points[2 * i + 1], 0.02 * x * x * x * x - 0.1 * x * x * x + 0.3 * x * x - x + 2, 1e-12);
        }
        bat_curve_free(&fine);
    }
}

/// The point at parameter t of a closed curve: an ellipse, or a wavy circle on the sphere.
static void point_of(const bat_space *space, double t, double *point)
{
    if (space->point_dim == 2)
    {
        point[0] = 2 * cos(t);
        point[1] = sin(t);
        return;
    }
    double z = 0.3 + 0.2 * sin(2 * t), r = sqrt(1 - z * z);
    point[0] = r * cos(t);
    point[1] = r * sin(t);
    point[2] = z;
}

static double largest_error(const bat_space *space, size_t count)
{
    double points[3 * MAX_POINTS], truth[3], largest = 0, turn = 2 * acos(-1);
    for (size_t i = 0; i < count; i++)
        point_of(space, turn * (double)i / (double)count, points + i * space->point_dim);
    bat_curve fine = refine(space, points, count, true, "quintic:parameters=uniform", 3);
    for (size_t i = 0; i < fine.count; i++)
    {
        point_of(space, turn * (double)i / (double)fine.count, truth);
        largest = fmax(largest, space->distance(space, truth, fine.points + i * space->point_dim));
    }
    bat_curve_free(&fine);
    return largest;
}

/// Errors at uniform parameters fall by the fifth power of the spacing in the plane, and by the fourth on the sphere, where
/// a Bezier curve of geodesics has another acceleration than its control points tell.
static void errors_fall_by_the_order(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2);
    double flat = log2(largest_error(&plane, 32) / largest_error(&plane, 64));
    double round = log2(largest_error(&sphere, 32) / largest_error(&sphere, 64));
    if (flat < 4.8 || round < 3.8)
        fail_msg("orders %g in the plane, %g on the sphere", flat, round);
}

/// Second differences from both sides of a given point agree as the spacing falls, at any parameters.
static void curves_of_the_plane_are_c2(void **state)
{
    (void)state;
    static const char *const names[] = {"quintic:parameters=uniform", "quintic:parameters=centripetal", "quintic"};
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 1, 0.2, 1.5, 1.4, 3, 1.1, 3.2, 2.5, 1, 3, -0.4, 1.6};
    for (size_t k = 0; k < 3; k++)
    {
        double alpha = 0.5 * (double)k, jump[2];
        for (size_t finer = 0; finer < 2; finer++)
        {
            size_t levels = 7 + finer, step = (size_t)1 << levels;
            bat_curve fine = refine(&plane, points, 7, true, names[k], levels);
            jump[finer] = 0;
            for (size_t i = 1; i < 6; i++)
                for (size_t c = 0; c < 2; c++)
                {
                    const double *at = fine.points + 2 * i * step + c;
                    double before = pow(plane.distance(&plane, points + 2 * i - 2, points + 2 * i), alpha) / (double)step;
                    double after = pow(plane.distance(&plane, points + 2 * i, points + 2 * i + 2), alpha) / (double)step;
                    double left = (at[0] - 2 * at[-2] + at[-4]) / (before * before);
                    double right = (at[0] - 2 * at[2] + at[4]) / (after * after);
                    jump[finer] = fmax(jump[finer], fabs(right - left));
                }
            bat_curve_free(&fine);
        }
        assert_true(jump[1] < 0.55 * jump[0]);
    }
}

/// Rotating the sphere, reversing a curve and scaling the plane commute with refinement.
static void isometries_reversal_and_scale(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2), plane = bat_euclidean(2);
    double points[3 * 12], turned[3 * 12], reversed[3 * 12], small[2 * 12];
    for (size_t i = 0; i < 12; i++)
    {
        double *p = points + 3 * i;
        point_of(&sphere, 0.5 * (double)i, p);
        turned[3 * i] = p[1];
        turned[3 * i + 1] = p[2];
        turned[3 * i + 2] = p[0];
        memcpy(reversed + 3 * (11 - i), p, 3 * sizeof *p);
        small[2 * i] = 0x1p-40 * p[0];
        small[2 * i + 1] = 0x1p-40 * p[1];
    }
    bat_curve fine = refine(&sphere, points, 12, false, "quintic", 3);
    bat_curve other = refine(&sphere, turned, 12, false, "quintic", 3);
    bat_curve back = refine(&sphere, reversed, 12, false, "quintic", 3);
    for (size_t i = 0; i < fine.count; i++)
        for (size_t c = 0; c < 3; c++)
        {
            check_near(other.points[3 * i + c], fine.points[3 * i + (c + 1) % 3], 1e-13);
            check_near(back.points[3 * (fine.count - 1 - i) + c], fine.points[3 * i + c], 1e-13);
        }
    bat_curve_free(&fine);
    bat_curve_free(&other);
    bat_curve_free(&back);
    double large[2 * 12];
    for (size_t i = 0; i < 24; i++)
        large[i] = 0x1p40 * small[i];
    fine = refine(&plane, large, 12, true, "quintic", 3);
    other = refine(&plane, small, 12, true, "quintic", 3);
    for (size_t i = 0; i < 2 * fine.count; i++)
        check_near(0x1p40 * other.points[i], fine.points[i], 1e-13);
    bat_curve_free(&fine);
    bat_curve_free(&other);
}

/// In every space given points stay, and all new ones are points of the space.
static void every_space_is_served(void **state)
{
    (void)state;
    const bat_choice *row;
    for (size_t k = 0; (row = bat_choices(&bat_space_family, k)) != NULL; k++)
    {
        bat_space space;
        bat_error error;
        check_status(bat_space_by_name(row->name, 0, &space, &error), BAT_OK);
        double points[MAX_POINTS * BAT_SPACE_MAX_DIM], origin[BAT_SPACE_MAX_DIM] = {0};
        size_t dim = space.point_dim;
        bool matrix = strcmp(row->name, "spd") == 0, pose = strcmp(row->name, "rigid") == 0;
        origin[0] = strcmp(row->name, "disk") == 0 ? 0.1 : 1;
        if (matrix)
            origin[3] = origin[5] = 1;
        if (pose)
            origin[3] = 1;
        for (size_t count = 2; count <= 7; count++)
            for (int closed = 0; closed <= (count > 2); closed++)
            {
                for (size_t i = 0; i < count; i++)
                {
                    double tangent[BAT_SPACE_MAX_DIM] = {0}, base[BAT_SPACE_MAX_DIM], moved[BAT_SPACE_MAX_DIM];
                    check_status(space.project(&space, origin, base), BAT_OK);
                    for (size_t c = 0; c < dim; c++)
                        moved[c] = base[c] + 0.1 * cos((double)(3 * i + 5 * c)) + 0.02 * (double)i;
                    check_status(space.project(&space, moved, moved), BAT_OK);
                    check_status(space.log(&space, base, moved, tangent), BAT_OK);
                    check_status(space.exp(&space, base, tangent, points + i * dim), BAT_OK);
                }
                bat_curve fine = refine(&space, points, count, closed != 0, "quintic", 2);
                check_status(bat_space_check(&space, fine.points, fine.count, &error), BAT_OK);
                for (size_t i = 0; i < count; i++)
                    assert_memory_equal(fine.points + 4 * i * dim, points + i * dim, dim * sizeof *points);
                bat_curve_free(&fine);
            }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quartics_are_reproduced),    cmocka_unit_test(errors_fall_by_the_order),
        cmocka_unit_test(curves_of_the_plane_are_c2), cmocka_unit_test(isometries_reversal_and_scale),
        cmocka_unit_test(every_space_is_served),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
