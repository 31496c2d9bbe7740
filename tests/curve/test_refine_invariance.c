// What makes no difference to refinement: vector code or a space's own functions, isometries, the direction of travel, the
// dimension around a great circle.

#include "refine_helpers.h"

/// A space with the same functions under other addresses takes the general code instead of the vector code.
static bat_status own_apex(const bat_space *space, const double *p, const double *q, double angle, double *point)
{
    const bat_space *real = space->parameters;
    return real->apex(real, p, q, angle, point);
}

static void vector_code_agrees_with_the_spaces(void **state)
{
    (void)state;
    bat_space known[3] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    const char *names[] = {"angle-4",   "angle-6:sign=printed",   "angle-4:adaptive=1", "angle-6:turns=1",
                           "log-exp-4", "log-exp-6:base=midpoint"};
    bat_random random = bat_random_seed(7);
    for (int k = 0; k < 3; k++)
        for (size_t s = 0; s < 5; s++)
        {
            bat_space own = known[k];
            own.apex = own_apex;
            own.parameters = &known[k];
            double points[3 * 40], v[3];
            own.random_point(&own, &random, points);
            for (size_t i = 1, d = own.point_dim; i < 40; i++)
            {
                do
                    own.random_point(&own, &random, points + i * d);
                while (own.log(&own, points + (i - 1) * d, points + i * d, v) != BAT_OK);
                for (size_t c = 0; c < d; c++)
                    v[c] *= k == 2 ? 0.1 : 0.4; // in the disk, short of the angle of parallelism
                check_status(own.exp(&own, points + (i - 1) * d, v, points + i * d), BAT_OK);
            }
            bat_curve a = {.space = &known[k], .points = points, .count = 40}, b = a;
            b.space = &own;
            bat_curve_refine_options how = options(names[s], 2);
            bat_curve fine_a = {0}, fine_b = {0};
            check_status(bat_curve_refine(&b, &how, &fine_b, NULL), BAT_OK);
            check_status(bat_curve_refine(&a, &how, &fine_a, NULL), BAT_OK);
            for (size_t i = 0; i < fine_a.count * own.point_dim; i++)
                check_near(fine_a.points[i], fine_b.points[i], 1e-12);
            bat_curve_free(&fine_a);
            bat_curve_free(&fine_b);
        }
}

/// Rotating the sphere, turning and scaling the plane, translating the disk: before or after makes no difference.
static void isometries_commute_with_refinement(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2), plane = bat_euclidean(2), disk = bat_disk();
    const char *names[] = {"angle-4", "angle-6", "angle-6:adaptive=1", "angle-6:turns=1", "log-exp-4", "log-exp-6"};
    for (size_t s = 0; s < 5; s++)
    {
        double round[30], turned[30], flat[20], moved[20], bent[20], shifted[20];
        double c = cos(0.7), n = sin(0.7), step[2] = {0.4, -0.3};
        for (int i = 0; i < 10; i++)
        {
            double t = 2 * PI * i / 10, v[3] = {cos(t), sin(t), 0.5 * sin(2 * t)}, *p = round + 3 * i;
            check_status(sphere.project(&sphere, v, p), BAT_OK);
            double r[3] = {c * p[0] - n * p[2], p[1], n * p[0] + c * p[2]};
            memcpy(turned + 3 * i, r, sizeof r);
            double *f = flat + 2 * i, *b = bent + 2 * i;
            f[0] = (1 + 0.3 * cos(3 * t)) * cos(t);
            f[1] = (1 + 0.3 * cos(3 * t)) * sin(t);
            moved[2 * i] = 5 * (c * f[0] - n * f[1]) + 1;
            moved[2 * i + 1] = 5 * (n * f[0] + c * f[1]) - 2;
            b[0] = 0.5 * f[0];
            b[1] = 0.5 * f[1];
            double origin[2] = {0, 0}, tangent[2];
            check_status(disk.log(&disk, origin, b, tangent), BAT_OK);
            check_status(disk.exp(&disk, step, tangent, shifted + 2 * i), BAT_OK);
        }
        bat_curve_refine_options how = options(names[s], 4);
        bat_curve a = {.space = &sphere, .points = round, .count = 10, .closed = true}, b = a;
        b.points = turned;
        bat_curve fine_a = refined(&a, &how), fine_b = refined(&b, &how);
        for (size_t i = 0; i < fine_a.count; i++)
        {
            const double *p = fine_a.points + 3 * i, *q = fine_b.points + 3 * i;
            check_near(q[0], c * p[0] - n * p[2], 1e-13);
            check_near(q[1], p[1], 1e-13);
            check_near(q[2], n * p[0] + c * p[2], 1e-13);
        }
        bat_curve_free(&fine_a);
        bat_curve_free(&fine_b);
        a = (bat_curve){.space = &plane, .points = flat, .count = 10, .closed = true};
        b = a;
        b.points = moved;
        fine_a = refined(&a, &how);
        fine_b = refined(&b, &how);
        for (size_t i = 0; i < fine_a.count; i++)
        {
            const double *p = fine_a.points + 2 * i, *q = fine_b.points + 2 * i;
            check_near(q[0], 5 * (c * p[0] - n * p[1]) + 1, 1e-12);
            check_near(q[1], 5 * (n * p[0] + c * p[1]) - 2, 1e-12);
        }
        bat_curve_free(&fine_a);
        bat_curve_free(&fine_b);
        a = (bat_curve){.space = &disk, .points = bent, .count = 10, .closed = true};
        b = a;
        b.points = shifted;
        fine_a = refined(&a, &how);
        fine_b = refined(&b, &how);
        for (size_t i = 0; i < fine_a.count; i++)
        {
            double origin[2] = {0, 0}, tangent[2], expected[2];
            check_status(disk.log(&disk, origin, fine_a.points + 2 * i, tangent), BAT_OK);
            check_status(disk.exp(&disk, step, tangent, expected), BAT_OK);
            check_near(disk.distance(&disk, expected, fine_b.points + 2 * i), 0, 1e-12);
        }
        bat_curve_free(&fine_a);
        bat_curve_free(&fine_b);
    }
}

static void reversal_reverses(void **state)
{
    (void)state;
    const char *names[] = {"chaikin",
                           "four-point",
                           "lane-riesenfeld:order=4",
                           "angle-4",
                           "angle-6:adaptive=1",
                           "angle-6:turns=1",
                           "log-exp-4:base=midpoint"};
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2);
    for (size_t s = 0; s < 6; s++)
        for (int open = 0; open < 2; open++)
        {
            bool curved = s >= 3;
            double forward[36], backward[36];
            const bat_space *space = curved ? &sphere : &plane;
            size_t dim = space->point_dim;
            for (size_t i = 0; i < 12; i++)
            {
                double t = 0.5 * (double)i, v[3] = {cos(t), sin(t) + 0.1 * t, 0.4 * sin(2 * t)};
                check_status(space->project(space, v, forward + i * dim), BAT_OK);
                memcpy(backward + (11 - i) * dim, forward + i * dim, dim * sizeof(double));
            }
            bat_curve a = {.space = space, .points = forward, .count = 12, .closed = !open}, b = a;
            b.points = backward;
            bat_curve_refine_options how = options(names[s], 3);
            bat_curve fine_a = refined(&a, &how), fine_b = refined(&b, &how);
            // Old point j becomes point 11 - j; a closed curve's new points follow, counted from the mask's centre.
            ptrdiff_t n = (ptrdiff_t)fine_a.count;
            bool dual = how.scheme.kind == BAT_CURVE_SCHEME_KIND_LINEAR && how.scheme.mask.count % 2 == 0;
            ptrdiff_t sum = open ? n - 1 : 11 * 8 - (dual ? 7 : 0);
            for (ptrdiff_t i = 0; i < n; i++)
            {
                ptrdiff_t j = ((sum - i) % n + n) % n;
                for (size_t c = 0; c < dim; c++)
                    check_near(fine_a.points[(size_t)i * dim + c], fine_b.points[(size_t)j * dim + c], 1e-13);
            }
            bat_curve_free(&fine_a);
            bat_curve_free(&fine_b);
        }
}

static void great_circles_stay_great_circles(void **state)
{
    (void)state;
    bat_space sphere3 = bat_sphere(3), sphere = bat_sphere(2);
    const char *names[] = {"log-exp-4", "log-exp-6:base=midpoint", "angle-4", "angle-6"};
    for (size_t s = 0; s < 4; s++)
    {
        const bat_space *space = s < 2 ? &sphere3 : &sphere;
        double points[4 * 5];
        for (size_t i = 0; i < 5; i++)
        {
            double t = 0.9 * (double)i, v[4] = {0.6 * cos(t), sin(t), 0.8 * cos(t), 0};
            memcpy(points + i * space->point_dim, v, space->point_dim * sizeof(double));
        }
        bat_curve coarse = {.space = space, .points = points, .count = 5};
        bat_curve_refine_options how = options(names[s], 5);
        bat_curve fine = refined(&coarse, &how);
        for (size_t i = 0; i < fine.count; i++)
        {
            const double *p = fine.points + i * space->point_dim;
            check_near(0.8 * p[0] - 0.6 * p[2], 0, 1e-14);
            check_near(atan2(p[1], p[0] / 0.6), remainder(0.9 * (double)i / 32, 2 * PI), 1e-13);
        }
        bat_curve_free(&fine);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vector_code_agrees_with_the_spaces),
        cmocka_unit_test(isometries_commute_with_refinement),
        cmocka_unit_test(reversal_reverses),
        cmocka_unit_test(great_circles_stay_great_circles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
