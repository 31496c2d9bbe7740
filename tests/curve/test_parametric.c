// The schemes with parameters of the points: nonuniform four-point, Catmull-Rom and cubic splines.

#include "refine_helpers.h"

#include "batten/curve_measure.h"

static const char *const ALL[] = {"four-point:parameters=centripetal",
                                  "four-point:parameters=chordal",
                                  "log-exp-4:parameters=chordal,base=midpoint",
                                  "catmull-rom",
                                  "catmull-rom:parameters=uniform",
                                  "catmull-rom:parameters=chordal",
                                  "cubic",
                                  "cubic:parameters=centripetal",
                                  "cubic:parameters=uniform"};
enum
{
    SCHEMES = sizeof ALL / sizeof ALL[0]
};

/// Uneven parameters 0 = t_0 < t_1 < …
static void uneven(bat_random *random, size_t count, double *t)
{
    t[0] = 0;
    for (size_t i = 1; i < count; i++)
        t[i] = t[i - 1] + 0.2 + bat_random_uniform(random);
}

static void names_choose_parameters(void **state)
{
    (void)state;
    bat_curve_scheme uniform = scheme("four-point:parameters=uniform"), today = scheme("four-point");
    assert_int_equal(uniform.kind, BAT_CURVE_SCHEME_KIND_LINEAR);
    assert_memory_equal(&uniform.mask, &today.mask, sizeof today.mask);
    assert_int_equal(scheme("log-exp-4:parameters=uniform").kind, BAT_CURVE_SCHEME_KIND_LOG_EXP);
    bat_curve_scheme four = scheme("log-exp-4:w=0.05,base=midpoint,parameters=chordal");
    assert_int_equal(four.kind, BAT_CURVE_SCHEME_KIND_FOUR_POINT);
    assert_int_equal(four.parameters, BAT_CURVE_PARAMETERS_CHORDAL);
    assert_int_equal(four.base, BAT_CURVE_BASE_MIDPOINT);
    assert_true(four.tension == 0.05);
    assert_int_equal(scheme("catmull-rom").parameters, BAT_CURVE_PARAMETERS_CENTRIPETAL);
    assert_int_equal(scheme("cubic").parameters, BAT_CURVE_PARAMETERS_CHORDAL);
    assert_int_equal(scheme("cubic:parameters=uniform").parameters, BAT_CURVE_PARAMETERS_UNIFORM);
    assert_string_equal(bat_choice_name(&bat_curve_parameters_family, BAT_CURVE_PARAMETERS_CENTRIPETAL), "centripetal");
    const bat_choice *choice;
    bat_error error;
    check_status(bat_choice_find(&bat_curve_parameters_family, "length", &choice, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "chordal"));
}

static void fields_out_of_range_are_refused(void **state)
{
    (void)state;
    bat_error error;
    const bat_curve_scheme good[] = {bat_curve_scheme_four_point(BAT_CURVE_PARAMETERS_CHORDAL, 0.05),
                                     scheme("catmull-rom:parameters=uniform"), scheme("cubic")};
    for (size_t i = 0; i < 3; i++)
    {
        bat_curve_scheme bad = good[i];
        check_status(bat_curve_scheme_check(&bad, &error), BAT_OK);
        int parameters = 3;
        memcpy(&bad.parameters, &parameters, sizeof parameters);
        check_status(bat_curve_scheme_check(&bad, &error), BAT_INVALID_ARGUMENT);
        assert_non_null(strstr(error.text, "parameters"));
    }
    bat_curve_scheme bad = good[0];
    bad.tension = NAN;
    check_status(bat_curve_scheme_check(&bad, &error), BAT_INVALID_ARGUMENT);
    bat_space plane = bat_euclidean(2);
    double points[6] = {0, 0, 1, 0, 1, 1};
    bat_curve coarse = {.space = &plane, .points = points, .count = 3};
    for (size_t s = 0; s < SCHEMES; s++)
    {
        bat_curve_refine_options how = options(ALL[s], 2);
        bat_curve fine = {0};
        how.snap = true;
        check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_UNSUPPORTED);
        how.snap = false;
        how.ends = BAT_CURVE_END_RULE_FREE;
        check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_UNSUPPORTED);
    }
}

/// The value at x of the polynomial through four numbers at t.
static double lagrange(const double *t, const double *values, double x)
{
    double sum = 0;
    for (int i = 0; i < 4; i++)
    {
        double weight = 1;
        for (int j = 0; j < 4; j++)
            weight *= j == i ? 1 : (x - t[j]) / (t[i] - t[j]);
        sum += weight * values[i];
    }
    return sum;
}

/// One level straight from the definition, for closed polygons in R^n.
static void four_point_is_the_lagrange_interpolant(void **state)
{
    (void)state;
    enum
    {
        COUNT = 9
    };
    bat_random random = bat_random_seed(1);
    const double alphas[] = {0, 0.5, 1};
    for (size_t dim = 1; dim <= 5; dim++)
        for (int kind = 0; kind < 3; kind++)
            for (int tension = 0; tension < 2; tension++)
            {
                bat_space space = bat_euclidean(dim);
                double points[COUNT * 5], w = tension == 0 ? 1.0 / 16 : 0.03;
                for (size_t i = 0; i < COUNT * dim; i++)
                    points[i] = bat_random_normal(&random);
                bat_curve coarse = {.space = &space, .points = points, .count = COUNT, .closed = true};
                bat_curve_refine_options how = bat_curve_refine_defaults();
                how.scheme = bat_curve_scheme_four_point((bat_curve_parameters)kind, w);
                how.levels = 1;
                bat_curve fine = refined(&coarse, &how);
                assert_int_equal(fine.count, 2 * COUNT);
                for (size_t i = 0; i < COUNT; i++)
                {
                    const double *p[4];
                    double t[4] = {0, 0, 0, 0};
                    for (size_t k = 0; k < 4; k++)
                    {
                        p[k] = points + (i + COUNT + k - 1) % COUNT * dim;
                        t[k] = k == 0 ? 0 : t[k - 1] + pow(space.distance(&space, p[k - 1], p[k]), alphas[kind]);
                    }
                    for (size_t c = 0; c < dim; c++)
                    {
                        const double values[4] = {p[0][c], p[1][c], p[2][c], p[3][c]};
                        double middle = 0.5 * (p[1][c] + p[2][c]);
                        double displaced = lagrange(t, values, 0.5 * (t[1] + t[2])) - middle;
                        assert_true(fine.points[2 * i * dim + c] == p[1][c]);
                        check_near(fine.points[(2 * i + 1) * dim + c], middle + 16 * w * displaced,
                                   1e-12 * (1 + fabs(displaced)));
                    }
                }
                bat_curve_free(&fine);
            }
}

/// With uniform parameters the kind is the linear four-point scheme, and log-exp-4 on the sphere.
static void uniform_parameters_give_the_mask(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_euclidean(2), bat_sphere(2)};
    const char *names[] = {"four-point:w=0.05", "log-exp-4:w=0.05"};
    for (size_t k = 0; k < 2; k++)
        for (int closed = 0; closed < 2; closed++)
        {
            double points[30];
            for (size_t i = 0; i < 10; i++)
            {
                double t = 0.6 * (double)i, v[3] = {cos(t), sin(t), 0.3 * cos(2 * t)};
                check_status(spaces[k].project(&spaces[k], v, points + i * spaces[k].point_dim), BAT_OK);
            }
            bat_curve coarse = {.space = &spaces[k], .points = points, .count = 10, .closed = closed};
            bat_curve_refine_options how = options(names[k], 4);
            bat_curve a = refined(&coarse, &how);
            how.scheme = bat_curve_scheme_four_point(BAT_CURVE_PARAMETERS_UNIFORM, 0.05);
            bat_curve b = refined(&coarse, &how);
            assert_int_equal(a.count, b.count);
            for (size_t i = 0; i < a.count * spaces[k].point_dim; i++)
                check_near(a.points[i], b.points[i], 1e-13);
            bat_curve_free(&a);
            bat_curve_free(&b);
        }
}

/// Reference values: CubicSpline of scipy 1.10, not-a-knot, periodic, and natural through three points, at a quarter and at
/// three quarters of each edge.
static void cubic_agrees_with_reference(void **state)
{
    (void)state;
    static const double POINTS[6][2] = {{0, 0}, {3, 1}, {4, 5}, {4.5, 5.25}, {9, 2}, {10, -3}};
    static const double OPEN[][2] = {{1.3183917204167621, -0.23211046320788736}, {2.7242621405269136, 0.34428688608689645},
                                     {3.1345926082880728, 2.0583187566331675},   {3.4259516818577445, 4.2276556829462129},
                                     {4.1160743063995957, 5.0750904870074862},   {4.368722048328685, 5.2003399318198271},
                                     {5.787030872499157, 5.2882441026194238},    {8.088378281207266, 3.4725395741963307},
                                     {9.637871690505234, 0.53510483481979998},   {10.177672155722622, -2.1127142887010875}};
    static const double CLOSED[][2] = {
        {0.63533353254170566, 0.16531021853231978}, {2.3373799234766306, 0.56947551122174223},
        {3.3735175638436941, 1.9189495491525477},   {3.5200273768276915, 4.1722050236107648},
        {4.1136367863772652, 5.076667656096908},    {4.3672804574775279, 5.2014130736109925},
        {5.7729044218017878, 5.2826598399055777},   {8.0272589771230063, 3.4720939857614992},
        {9.7727075505555092, 0.53005020556437443},  {10.426724873400641, -2.1239764544142896},
        {7.2817224277448878, -3.4027591612800974},  {0.41390783459717095, -1.0910059277099173}};
    static const double NATURAL[][2] = {{0.86358589820908915, 0.14481592127734561},
                                        {2.4090202574927249, 0.60274228978828381},
                                        {3.520334437737632, 1.7496618926400826},
                                        {3.9430960269554514, 3.821187066171488}};
    const struct
    {
        size_t count, edges;
        bool closed;
        const double (*values)[2];
    } cases[] = {{6, 5, false, OPEN}, {6, 6, true, CLOSED}, {3, 2, false, NATURAL}};
    bat_space plane = bat_euclidean(2);
    for (size_t k = 0; k < 3; k++)
    {
        double points[12];
        memcpy(points, POINTS, sizeof points);
        bat_curve coarse = {.space = &plane, .points = points, .count = cases[k].count, .closed = cases[k].closed};
        bat_curve_refine_options how = options("cubic", 2);
        bat_curve fine = refined(&coarse, &how);
        for (size_t i = 0; i < 2 * cases[k].edges; i++)
            for (size_t c = 0; c < 2; c++)
                check_near(fine.points[2 * (2 * i + 1) + c], cases[k].values[i][c], 2e-14);
        bat_curve_free(&fine);
    }
}

/// The pyramid of Barry and Goldman (1988) at x, between t[1] and t[2].
static double pyramid(const double *t, const double *values, double x)
{
    double level[4];
    memcpy(level, values, sizeof level);
    for (int k = 0; k < 3; k++)
        level[k] = ((t[k + 1] - x) * level[k] + (x - t[k]) * level[k + 1]) / (t[k + 1] - t[k]);
    for (int k = 0; k < 2; k++)
        level[k] = ((t[k + 2] - x) * level[k] + (x - t[k]) * level[k + 1]) / (t[k + 2] - t[k]);
    return ((t[2] - x) * level[0] + (x - t[1]) * level[1]) / (t[2] - t[1]);
}

static void catmull_rom_is_the_pyramid(void **state)
{
    (void)state;
    enum
    {
        COUNT = 8
    };
    bat_random random = bat_random_seed(3);
    bat_space space = bat_euclidean(3);
    const char *names[] = {"catmull-rom:parameters=uniform", "catmull-rom", "catmull-rom:parameters=chordal"};
    for (int kind = 0; kind < 3; kind++)
        for (int closed = 0; closed < 2; closed++)
        {
            double rows[(COUNT + 3) * 3], *points = rows + 3;
            for (size_t i = 0; i < COUNT * 3; i++)
                points[i] = bat_random_normal(&random);
            bat_curve coarse = {.space = &space, .points = points, .count = COUNT, .closed = closed};
            bat_curve_refine_options how = options(names[kind], 3);
            bat_curve fine = refined(&coarse, &how);
            for (size_t c = 0; c < 3; c++)
            {
                rows[c] = closed ? points[(COUNT - 1) * 3 + c] : 2 * points[c] - points[3 + c];
                points[COUNT * 3 + c] = closed ? points[c] : 2 * points[(COUNT - 1) * 3 + c] - points[(COUNT - 2) * 3 + c];
                points[(COUNT + 1) * 3 + c] = points[3 + c];
            }
            for (size_t i = 0; i < (closed ? COUNT : COUNT - 1); i++)
            {
                double t[4] = {0, 0, 0, 0};
                for (size_t k = 1; k < 4; k++)
                    t[k] = t[k - 1] + pow(space.distance(&space, rows + (i + k - 1) * 3, rows + (i + k) * 3), 0.5 * kind);
                for (size_t k = 0; k < 8; k++)
                    for (size_t c = 0; c < 3; c++)
                    {
                        const double *p = rows + i * 3 + c, values[4] = {p[0], p[3], p[6], p[9]};
                        check_near(fine.points[(8 * i + k) * 3 + c],
                                   pyramid(t, values, t[1] + (t[2] - t[1]) * (double)k / 8), 1e-12);
                    }
            }
            bat_curve_free(&fine);
        }
}

/// Second derivatives of the cubic spline are continuous: three numbers on either side of a joint agree with one parabola
/// but for the jump of the third derivative, so the jump of second differences falls by 8 where steps halve.
static void cubic_is_c2(void **state)
{
    (void)state;
    bat_space line = bat_euclidean(1);
    bat_random random = bat_random_seed(4);
    double points[12];
    for (size_t i = 0; i < 12; i++)
        points[i] = bat_random_normal(&random);
    const struct
    {
        const char *name;
        double least, most;
    } cases[] = {{"cubic:parameters=uniform", 7, 9}, {"catmull-rom:parameters=uniform", 3, 5}};
    for (size_t k = 0; k < 2; k++)
    {
        double jumps[2] = {0, 0};
        for (size_t level = 0; level < 2; level++)
        {
            bat_curve coarse = {.space = &line, .points = points, .count = 12, .closed = true};
            bat_curve_refine_options how = options(cases[k].name, 8 + level);
            bat_curve fine = refined(&coarse, &how);
            const double *p = fine.points + (fine.count / 12) * 5;
            jumps[level] = fabs((p[0] - 2 * p[1] + p[2]) - (p[0] - 2 * p[-1] + p[-2]));
            bat_curve_free(&fine);
        }
        assert_in_range((unsigned)(10 * jumps[0] / jumps[1]), (unsigned)(10 * cases[k].least),
                        (unsigned)(10 * cases[k].most));
    }
}

/// Points of a line, unevenly spaced, with powers of the arc length as channels: chordal four-point and cubic reproduce
/// cubics, Catmull-Rom parabolas, and every scheme stays on the line.
static void polynomials_of_the_parameter_are_reproduced(void **state)
{
    (void)state;
    enum
    {
        COUNT = 7
    };
    const struct
    {
        const char *name;
        size_t degree;
    } cases[] = {{"four-point:parameters=chordal", 3},
                 {"log-exp-4:parameters=chordal,base=midpoint", 3},
                 {"cubic", 3},
                 {"catmull-rom:parameters=chordal", 2},
                 {"catmull-rom", 0},
                 {"cubic:parameters=centripetal", 0},
                 {"four-point:parameters=centripetal", 0}};
    bat_random random = bat_random_seed(5);
    bat_space space = bat_euclidean(3);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
    {
        double t[COUNT], points[3 * COUNT], channels[3 * COUNT];
        uneven(&random, COUNT, t);
        for (size_t i = 0; i < COUNT; i++)
        {
            const double p[3] = {1 + 2 * t[i] / 3, 2 - t[i] / 3, 2 * t[i] / 3},
                         c[3] = {t[i], t[i] * t[i], t[i] * t[i] * t[i]};
            memcpy(points + 3 * i, p, sizeof p);
            memcpy(channels + 3 * i, c, sizeof c);
        }
        bat_curve coarse = {.space = &space, .points = points, .count = COUNT, .channels = channels, .channel_count = 3};
        bat_curve_refine_options how = options(cases[k].name, 4);
        how.ends = BAT_CURVE_END_RULE_EXTRAPOLATE;
        bat_curve fine = refined(&coarse, &how);
        assert_int_equal(fine.count, 16 * (COUNT - 1) + 1);
        for (size_t i = 0; i < fine.count; i++)
        {
            const double *p = fine.points + 3 * i;
            double x = 1.5 * (p[0] - 1), power = 1;
            check_near(p[1], 2 - x / 3, 1e-12);
            check_near(p[2], 2 * x / 3, 1e-12);
            if (cases[k].degree > 0)
                check_near(x, t[i / 16] + (i % 16 == 0 ? 0 : (t[i / 16 + 1] - t[i / 16]) * (double)(i % 16) / 16), 1e-12);
            for (size_t c = 0; c < cases[k].degree; c++)
            {
                power *= x;
                check_near(fine.channels[3 * i + c], power, 1e-10);
            }
        }
        bat_curve_free(&fine);
    }
}

/// The ellipse x^2 / 4 + y^2 = 1 at steps of 1, 2, 1 and 3 in turn.
static bat_curve ellipse(const bat_space *plane, size_t count, double *points)
{
    static const double STEPS[] = {1, 2, 1, 3};
    double t = 0.3;
    for (size_t i = 0; i < count; i++)
    {
        points[2 * i] = 2 * cos(t);
        points[2 * i + 1] = sin(t);
        t += 2 * PI * STEPS[i % 4] / 7 * 4 / (double)count;
    }
    return (bat_curve){.space = plane, .points = points, .count = count, .closed = true};
}

static double distance_from_ellipse(const bat_curve *curve)
{
    double largest = 0;
    for (size_t i = 0; i < curve->count; i++)
    {
        double x = curve->points[2 * i], y = curve->points[2 * i + 1];
        largest = fmax(largest, fabs(x * x / 4 + y * y - 1) / hypot(x / 2, 2 * y));
    }
    return largest;
}

/// Orders of convergence where the points are unevenly spaced: four for chordal parameters (three for Catmull-Rom, whose
/// velocities are those of parabolas), two for uniform ones.
static void distances_fall_by_the_order(void **state)
{
    (void)state;
    const struct
    {
        const char *name;
        double least, most;
    } cases[] = {{"four-point:parameters=chordal", 3.7, 4.3},
                 {"cubic", 3.7, 4.3},
                 {"catmull-rom:parameters=chordal", 2.7, 3.3},
                 {"four-point:parameters=centripetal", 1.7, 3.3},
                 {"catmull-rom", 1.7, 3.3},
                 {"four-point", 1.7, 2.3},
                 {"catmull-rom:parameters=uniform", 1.7, 2.3}};
    bat_space plane = bat_euclidean(2);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
    {
        double points[2 * 256], errors[2];
        for (size_t half = 0; half < 2; half++)
        {
            bat_curve coarse = ellipse(&plane, half == 0 ? 128 : 256, points);
            bat_curve_refine_options how = options(cases[k].name, 4);
            bat_curve fine = refined(&coarse, &how);
            errors[half] = distance_from_ellipse(&fine);
            bat_curve_free(&fine);
        }
        double order = log2(errors[0] / errors[1]);
        if (!(cases[k].least < order && order < cases[k].most))
            fail_msg("%s: order %g", cases[k].name, order);
    }
}

/// A closed curve of the plane, the sphere or the disk with edges whose lengths differ by more than 10.
static void uneven_points(const bat_space *space, size_t count, double *points)
{
    double t = 0;
    for (size_t i = 0; i < count; i++)
    {
        double v[3] = {0.6 * cos(t), 0.5 * sin(t), 0.5 + 0.1 * cos(3 * t)};
        check_status(space->project(space, v, points + i * space->point_dim), BAT_OK);
        t += 2 * PI / (double)count * (i % 3 == 0 ? 0.15 : i % 3 == 1 ? 0.95 : 1.9);
    }
}

/// The largest turning angle halves, nearly, from level to level: limits are C1, in every space.
static void largest_turns_halve(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    for (size_t k = 0; k < 3; k++)
        for (size_t s = 0; s < SCHEMES; s++)
        {
            double points[36], turns[2];
            uneven_points(&spaces[k], 12, points);
            bat_curve coarse = {.space = &spaces[k], .points = points, .count = 12, .closed = true};
            for (size_t later = 0; later < 2; later++)
            {
                bat_curve_refine_options how = options(ALL[s], 8 + 4 * later);
                how.simple = BAT_CURVE_SIMPLE_NEVER; // uniform parameters make loops here
                bat_curve fine = refined(&coarse, &how);
                bat_curve_fairness_values values;
                check_status(bat_curve_fairness(&fine, NULL, &values, NULL), BAT_OK);
                turns[later] = values.g1;
                bat_curve_free(&fine);
            }
            if (!(turns[1] < turns[0] / 8))
                fail_msg("%s, %s: largest turn %g at level 8, %g at level 12", spaces[k].name, ALL[s], turns[0], turns[1]);
        }
}

/// Reversed and mirrored points give reversed and mirrored curves; in the plane, local schemes to the bit.
static void reversal_and_mirror(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    for (size_t k = 0; k < 3; k++)
        for (size_t s = 0; s < SCHEMES; s++)
            for (int open = 0; open < 2; open++)
            {
                size_t dim = spaces[k].point_dim;
                double points[36], reversed[36], mirrored[36];
                uneven_points(&spaces[k], 12, points);
                for (size_t i = 0; i < 12; i++)
                    for (size_t c = 0; c < dim; c++)
                    {
                        reversed[(11 - i) * dim + c] = points[i * dim + c];
                        mirrored[i * dim + c] = c == 0 ? -points[i * dim] : points[i * dim + c];
                    }
                bat_curve a = {.space = &spaces[k], .points = points, .count = 12, .closed = !open}, b = a, m = a;
                b.points = reversed;
                m.points = mirrored;
                bat_curve_refine_options how = options(ALL[s], 3);
                bat_curve fine = refined(&a, &how), back = refined(&b, &how), other = refined(&m, &how);
                bool vertex_base = strncmp(ALL[s], "four-point", 10) == 0 && k > 0;
                bool exact = k == 0 && strncmp(ALL[s], "cubic", 5) != 0;
                size_t n = fine.count, sum = open ? n - 1 : 11 * 8 + n;
                for (size_t i = 0; i < n; i++)
                    for (size_t c = 0; c < dim; c++)
                    {
                        double value = fine.points[i * dim + c];
                        if (!vertex_base)
                            check_near(back.points[(sum - i) % n * dim + c], value, exact ? 0 : 1e-13);
                        check_near(other.points[i * dim + c], c == 0 ? -value : value, k == 0 ? 0 : 1e-13);
                    }
                bat_curve_free(&fine);
                bat_curve_free(&back);
                bat_curve_free(&other);
            }
}

/// Multiplied by a power of two, however large, the curve changes no digit; by any motion and scaling, none but the last.
static void scale_and_motion(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    for (size_t s = 0; s < SCHEMES; s++)
        for (int closed = 0; closed < 2; closed++)
        {
            double points[24], scaled[24], moved[24];
            uneven_points(&plane, 12, points);
            bat_curve a = {.space = &plane, .points = points, .count = 12, .closed = closed}, b = a, m = a;
            b.points = scaled;
            m.points = moved;
            for (size_t i = 0; i < 12; i++)
            {
                double x = points[2 * i], y = points[2 * i + 1];
                moved[2 * i] = 3.7 * (0.8 * x - 0.6 * y) + 1;
                moved[2 * i + 1] = 3.7 * (0.6 * x + 0.8 * y) - 2;
            }
            bat_curve_refine_options how = options(ALL[s], 4);
            bat_curve fine = refined(&a, &how), away = refined(&m, &how);
            for (int exponent = -900; exponent <= 900; exponent += 450)
            {
                for (size_t i = 0; i < 24; i++)
                    scaled[i] = ldexp(points[i], exponent);
                bat_curve large = refined(&b, &how);
                for (size_t i = 0; i < 2 * fine.count; i++)
                    assert_true(large.points[i] == ldexp(fine.points[i], exponent));
                bat_curve_free(&large);
            }
            for (size_t i = 0; i < fine.count; i++)
            {
                double x = fine.points[2 * i], y = fine.points[2 * i + 1];
                check_near(away.points[2 * i], 3.7 * (0.8 * x - 0.6 * y) + 1, 1e-12);
                check_near(away.points[2 * i + 1], 3.7 * (0.6 * x + 0.8 * y) - 2, 1e-12);
            }
            bat_curve_free(&fine);
            bat_curve_free(&away);
        }
}

/// A great circle of the sphere and a diameter of the disk are isometric to a line: the curve is that of the line.
static void geodesics_are_lines(void **state)
{
    (void)state;
    enum
    {
        COUNT = 7
    };
    bat_random random = bat_random_seed(6);
    bat_space line = bat_euclidean(1), sphere = bat_sphere(2), disk = bat_disk();
    for (size_t s = 0; s < SCHEMES; s++)
        for (int ends = BAT_CURVE_END_RULE_REFLECT; ends <= BAT_CURVE_END_RULE_EXTRAPOLATE; ends++)
        {
            double t[COUNT], round[3 * COUNT], flat[2 * COUNT], channels[COUNT];
            uneven(&random, COUNT, t);
            for (size_t i = 0; i < COUNT; i++)
            {
                t[i] *= 0.3;
                channels[i] = sin(3 * t[i]);
                const double p[3] = {0.6 * cos(t[i]), sin(t[i]), 0.8 * cos(t[i])}, q[2] = {0, tanh(t[i] / 2 - 0.3)};
                memcpy(round + 3 * i, p, sizeof p);
                memcpy(flat + 2 * i, q, sizeof q);
            }
            bat_curve a = {.space = &line, .points = t, .count = COUNT, .channels = channels, .channel_count = 1}, b = a,
                      d = a;
            b.space = &sphere;
            b.points = round;
            d.space = &disk;
            d.points = flat;
            bat_curve_refine_options how = options(ALL[s], 4);
            how.ends = (bat_curve_end_rule)ends;
            bat_curve fine = refined(&a, &how), on_sphere = refined(&b, &how), in_disk = refined(&d, &how);
            for (size_t i = 0; i < fine.count; i++)
            {
                const double *p = on_sphere.points + 3 * i, *q = in_disk.points + 2 * i;
                check_near(0.8 * p[0] - 0.6 * p[2], 0, 1e-13);
                check_near(p[0] * p[0] + p[1] * p[1] + p[2] * p[2], 1, 1e-15);
                check_near(atan2(p[1], p[0] / 0.6), fine.points[i], 1e-12);
                check_near(q[0], 0, 1e-13);
                check_near(2 * atanh(q[1]) + 0.6, fine.points[i], 1e-12);
                check_near(on_sphere.channels[i], fine.channels[i], 1e-12);
                check_near(in_disk.channels[i], fine.channels[i], 1e-12);
            }
            bat_curve_free(&fine);
            bat_curve_free(&on_sphere);
            bat_curve_free(&in_disk);
        }
}

/// A regular polygon around the pole keeps its symmetry, so that all new points at the same place of their edges have one
/// height; small curves of the sphere are those of the plane.
static void circles_of_the_sphere(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2), plane = bat_euclidean(2);
    for (size_t s = 0; s < SCHEMES; s++)
    {
        double points[30], flat[24], small[36];
        for (size_t i = 0; i < 10; i++)
        {
            double t = 2 * PI * (double)i / 10;
            const double p[3] = {0.8 * cos(t), 0.8 * sin(t), 0.6};
            memcpy(points + 3 * i, p, sizeof p);
        }
        bat_curve coarse = {.space = &sphere, .points = points, .count = 10, .closed = true};
        bat_curve_refine_options how = options(ALL[s], 3);
        bat_curve fine = refined(&coarse, &how);
        for (size_t i = 0; i < fine.count; i++)
        {
            check_near(fine.points[3 * i + 2], fine.points[3 * (i % 8) + 2], 1e-14);
            check_near(fine.points[3 * i + 2], 0.6, 4e-3);
        }
        bat_curve_free(&fine);
        uneven_points(&plane, 12, flat);
        for (size_t i = 0; i < 12; i++)
        {
            const double p[3] = {1e-4 * flat[2 * i], 1e-4 * flat[2 * i + 1],
                                 sqrt(1 - 1e-8 * (flat[2 * i] * flat[2 * i] + flat[2 * i + 1] * flat[2 * i + 1]))};
            memcpy(small + 3 * i, p, sizeof p);
        }
        bat_curve a = {.space = &plane, .points = flat, .count = 12, .closed = true}, b = a;
        b.space = &sphere;
        b.points = small;
        bat_curve fine_a = refined(&a, &how), fine_b = refined(&b, &how);
        for (size_t i = 0; i < fine_a.count; i++)
            for (size_t c = 0; c < 2; c++)
                check_near(1e4 * fine_b.points[3 * i + c], fine_a.points[2 * i + c], 1e-7);
        bat_curve_free(&fine_a);
        bat_curve_free(&fine_b);
    }
}

/// Every space of the library has these schemes; given points stay to the bit, and channels do not change the points.
static void given_points_stay_and_channels_do_not_count(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_euclidean(1), bat_euclidean(2),         bat_sphere(2),    bat_sphere(3), bat_disk(),
                          bat_rotation(),   bat_positive_definite(3), bat_hyperbolic(3)};
    for (size_t k = 0; k < sizeof spaces / sizeof spaces[0]; k++)
        for (size_t s = 0; s < SCHEMES; s++)
            for (int closed = 0; closed < 2; closed++)
            {
                enum
                {
                    COUNT = 6
                };
                size_t dim = spaces[k].point_dim, tangent_dim = spaces[k].tangent_dim;
                double points[COUNT * 6], channels[COUNT * 2], tangent[6], base[6];
                bat_random random = bat_random_seed(k + 1);
                spaces[k].random_point(&spaces[k], &random, base);
                for (size_t i = 0; i < COUNT; i++)
                {
                    do
                        spaces[k].random_point(&spaces[k], &random, points + i * dim);
                    while (spaces[k].log(&spaces[k], base, points + i * dim, tangent) != BAT_OK);
                    for (size_t c = 0; c < tangent_dim; c++)
                        tangent[c] *= 0.3;
                    check_status(spaces[k].exp(&spaces[k], base, tangent, points + i * dim), BAT_OK);
                    channels[2 * i] = points[i * dim];
                    channels[2 * i + 1] = bat_random_normal(&random);
                }
                bat_curve plain = {.space = &spaces[k], .points = points, .count = COUNT, .closed = closed}, rich = plain;
                rich.channels = channels;
                rich.channel_count = 2;
                bat_curve_refine_options how = options(ALL[s], 3);
                bat_curve a = refined(&plain, &how), b = refined(&rich, &how);
                assert_int_equal(a.count, closed ? 8 * COUNT : 8 * (COUNT - 1) + 1);
                assert_int_equal(a.count, b.count);
                assert_memory_equal(a.points, b.points, a.count * dim * sizeof(double));
                for (size_t i = 0; i < COUNT; i++)
                {
                    assert_memory_equal(a.points + 8 * i * dim, points + i * dim, dim * sizeof(double));
                    assert_memory_equal(b.channels + 16 * i, channels + 2 * i, 2 * sizeof(double));
                }
                if (k <= 1) // a channel with the values of a coordinate is that coordinate
                    for (size_t i = 0; i < a.count; i++)
                        assert_true(b.channels[2 * i] == b.points[i * dim]);
                double *into = malloc(a.count * dim * sizeof *into);
                check_status(bat_curve_refine_into(&rich, &how, into, NULL, a.count, NULL), BAT_OK);
                assert_memory_equal(into, a.points, a.count * dim * sizeof(double));
                free(into);
                bat_curve_free(&a);
                bat_curve_free(&b);
            }
}

static void threads_and_sets_change_no_byte(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    double points[36];
    uneven_points(&sphere, 12, points);
    for (size_t s = 0; s < SCHEMES; s++)
    {
        bat_curve coarse[9];
        for (size_t i = 0; i < 9; i++)
            coarse[i] = (bat_curve){.space = &sphere, .points = points, .count = 4 + i, .closed = i % 2 == 0};
        bat_curve_refine_options how = options(ALL[s], 9);
        how.threads = 3;
        bat_curve fine[9];
        check_status(bat_curves_refine(coarse, 9, &how, fine, NULL), BAT_OK);
        for (size_t i = 0; i < 9; i++)
        {
            how.threads = i < 8 ? 1 : 3;
            bat_curve one = refined(&coarse[i], &how);
            assert_int_equal(one.count, fine[i].count);
            assert_memory_equal(one.points, fine[i].points, one.count * 3 * sizeof(double));
            bat_curve_free(&one);
            bat_curve_free(&fine[i]);
        }
    }
}

/// Edges of any ratio of lengths, points that meet at a fold, two points: finite results inside of a small box.
static void extreme_edges(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double ratios[] = {0, 0, 1, 0, 1, 1e-150, 1 + 1e-15, 1, 0, 1}, fold[] = {0, 0, 1, 0, 0, 0, 1, 0}, two[] = {0, 0, 1, 1};
    const bat_curve curves[] = {{.space = &plane, .points = ratios, .count = 5, .closed = true},
                                {.space = &plane, .points = fold, .count = 4},
                                {.space = &plane, .points = two, .count = 2}};
    const char *names[] = {"four-point:parameters=centripetal", "four-point:parameters=chordal", "catmull-rom", "cubic"};
    for (size_t s = 0; s < 4; s++)
        for (size_t k = 0; k < 3; k++)
            for (size_t levels = 0; levels <= 12; levels += 4)
            {
                bat_curve_refine_options how = options(names[s], levels);
                bat_curve fine = refined(&curves[k], &how);
                for (size_t i = 0; i < 2 * fine.count; i++)
                    assert_true(fabs(fine.points[i]) < 5);
                bat_curve_free(&fine);
            }
    // Where nothing finite can come out, the call fails.
    double huge[] = {-1.5e308, 0, 1.5e308, 1e308, 1e308, -1e308, 0, 1.7e308};
    bat_curve coarse = {.space = &plane, .points = huge, .count = 4, .closed = true};
    for (size_t s = 0; s < 4; s++)
    {
        bat_curve_refine_options how = options(names[s], 3);
        bat_curve fine = {0};
        check_status(bat_curve_refine(&coarse, &how, &fine, NULL), BAT_INVALID_POINT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_choose_parameters),
        cmocka_unit_test(fields_out_of_range_are_refused),
        cmocka_unit_test(four_point_is_the_lagrange_interpolant),
        cmocka_unit_test(uniform_parameters_give_the_mask),
        cmocka_unit_test(cubic_agrees_with_reference),
        cmocka_unit_test(catmull_rom_is_the_pyramid),
        cmocka_unit_test(cubic_is_c2),
        cmocka_unit_test(polynomials_of_the_parameter_are_reproduced),
        cmocka_unit_test(distances_fall_by_the_order),
        cmocka_unit_test(largest_turns_halve),
        cmocka_unit_test(reversal_and_mirror),
        cmocka_unit_test(scale_and_motion),
        cmocka_unit_test(geodesics_are_lines),
        cmocka_unit_test(circles_of_the_sphere),
        cmocka_unit_test(given_points_stay_and_channels_do_not_count),
        cmocka_unit_test(threads_and_sets_change_no_byte),
        cmocka_unit_test(extreme_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
