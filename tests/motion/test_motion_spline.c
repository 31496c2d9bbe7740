// Splines in time: order, continuity, end conditions, rests, limits, symmetries, and the evaluator.

#include "check.h"

#include "batten/motion_spline.h"
#include "space/builtin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MOST = 160,
    DIM = 16
};

#define TURN 6.28318530717958647693
#define TURN_4 (TURN / 4)

/// A smooth closed curve of period 2 pi.
typedef struct smooth_curve
{
    const bat_space *space;
    double centre[DIM], axes[3][DIM];
} smooth_curve;

static smooth_curve curve_in(const bat_space *space)
{
    smooth_curve curve = {.space = space};
    bat_random random = bat_random_seed(3);
    space->random_point(space, &random, curve.centre);
    for (int a = 0; a < 3; a++)
    {
        double goal[DIM], *axis = curve.axes[a];
        space->random_point(space, &random, goal);
        assert_int_equal(space->log(space, curve.centre, goal, axis), BAT_OK);
        double length = sqrt(space->inner(space, curve.centre, axis, axis));
        for (size_t c = 0; c < space->tangent_dim; c++)
            axis[c] /= length;
    }
    return curve;
}

static void curve_at(const smooth_curve *curve, double t, double *point)
{
    const bat_space *space = curve->space;
    double way[DIM] = {0};
    for (size_t c = 0; c < space->tangent_dim; c++)
        way[c] = 0.8 * (cos(t) * curve->axes[0][c] + 0.8 * sin(t) * curve->axes[1][c] +
                        0.3 * sin(2 * t + 0.4) * curve->axes[2][c]);
    assert_int_equal(space->exp(space, curve->centre, way, point), BAT_OK);
}

/// Keys with arrays of their own.
typedef struct keys
{
    double points[MOST * DIM], times[MOST];
    bat_hermite_curve curve;
} keys;

/// Samples at uneven times, which keep their pattern when their number doubles.
static void sample_curve(const smooth_curve *curve, size_t intervals, bool closed, keys *made)
{
    size_t count = closed ? intervals : intervals + 1;
    double duration = closed ? TURN : 4;
    for (size_t i = 0; i < count; i++)
    {
        double x = (double)i / (double)intervals;
        made->times[i] = duration * (x + 0.02 * sin(2 * TURN * x));
        curve_at(curve, made->times[i], made->points + i * curve->space->point_dim);
    }
    made->curve = (bat_hermite_curve){.space = curve->space, .points = made->points, .times = made->times, .count = count};
    made->curve.closed = closed;
    made->curve.closing_time = closed ? duration - made->times[count - 1] : 0;
}

static bat_motion_spline *must_make(const bat_hermite_curve *curve, const bat_motion_spline_options *options)
{
    bat_motion_spline *spline = NULL;
    bat_error error = {.text = ""};
    bat_status status = bat_motion_spline_make(curve, options, &spline, &error);
    if (status != BAT_OK)
        print_message("%s\n", error.text);
    assert_int_equal(status, BAT_OK);
    return spline;
}

static void must_give(const bat_motion_spline *spline, double time, double *point, double *velocity, double *acceleration)
{
    assert_int_equal(bat_motion_spline_at(spline, time, point, velocity, acceleration, NULL), BAT_OK);
}

static double largest_error(const smooth_curve *curve, const bat_motion_spline *spline)
{
    double begin = bat_motion_spline_keys(spline).begin, end = bat_motion_spline_keys(spline).end;
    double largest = 0, made[DIM], true_point[DIM];
    for (int i = 0; i <= 500; i++)
    {
        double t = begin + (end - begin) * i / 500;
        must_give(spline, t, made, NULL, NULL);
        curve_at(curve, t, true_point);
        largest = fmax(largest, curve->space->distance(curve->space, made, true_point));
    }
    return largest;
}

static bat_status slow_log(const bat_space *space, const double *p, const double *q, double *tangent)
{
    bat_space sphere = bat_sphere(2);
    (void)space;
    return sphere.log(&sphere, p, q, tangent);
}

static bat_status slow_turn(const bat_space *space, const double *p, const double *q, double *tangent)
{
    const bat_space rotation = bat_rotation();
    (void)space;
    return rotation.log(&rotation, p, q, tangent);
}

// A torus, cut open: the metric dx^2 + f(x)^2 dy^2. Its geodesics are integrated; no reflection at a point is an isometry.

/// The state is x, y and two tangent vectors: the geodesic's, and one that is parallel along it.
static void torus_rates(const double *state, double *rates)
{
    double f = 2 + cos(state[0]), slope = -sin(state[0]);
    memcpy(rates, state + 2, 2 * sizeof *rates);
    for (int i = 2; i < 6; i += 2)
    {
        rates[i] = f * slope * state[3] * state[i + 1];
        rates[i + 1] = -slope / f * (state[2] * state[i + 1] + state[3] * state[i]);
    }
}

/// Runge and Kutta's rule; vectors have the frame of orthonormal axes outside.
static void torus_go(const double *p, const double *tangent, const double *vector, double *state)
{
    enum
    {
        STEPS = 6
    };
    const double f = 2 + cos(p[0]), shares[] = {0, 0.5, 0.5, 1}, weights[] = {1, 2, 2, 1};
    const double begin[6] = {p[0], p[1], tangent[0], tangent[1] / f, vector[0], vector[1] / f};
    memcpy(state, begin, sizeof begin);
    for (int step = 0; step < STEPS; step++)
    {
        double rates[6] = {0}, at[6], sum[6] = {0};
        for (int k = 0; k < 4; k++)
        {
            for (int i = 0; i < 6; i++)
                at[i] = state[i] + shares[k] / STEPS * rates[i];
            torus_rates(at, rates);
            for (int i = 0; i < 6; i++)
                sum[i] += weights[k] * rates[i];
        }
        for (int i = 0; i < 6; i++)
            state[i] += sum[i] / (6.0 * STEPS);
    }
    state[3] *= 2 + cos(state[0]);
    state[5] *= 2 + cos(state[0]);
}

static bat_status torus_exp(const bat_space *space BAT_UNUSED, const double *p, const double *tangent, double *q)
{
    double state[6];
    torus_go(p, tangent, tangent, state);
    memcpy(q, state, 2 * sizeof *q);
    return BAT_OK;
}

/// By shooting: the missed way, brought back as if the torus were flat there.
static bat_status torus_log(const bat_space *space, const double *p, const double *q, double *tangent)
{
    double reached[2];
    tangent[0] = q[0] - p[0];
    tangent[1] = (2 + cos((p[0] + q[0]) / 2)) * (q[1] - p[1]);
    for (int step = 0; step < 60; step++)
    {
        (void)torus_exp(space, p, tangent, reached);
        tangent[0] += q[0] - reached[0];
        tangent[1] += (2 + cos((p[0] + q[0]) / 2)) * (q[1] - reached[1]);
        if (fabs(q[0] - reached[0]) + fabs(q[1] - reached[1]) < 1e-16)
            break;
    }
    return BAT_OK;
}

static bat_status torus_transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                                  double *transported)
{
    double way[2], state[6];
    (void)torus_log(space, p, q, way);
    torus_go(p, way, tangent, state);
    memcpy(transported, state + 4, 2 * sizeof *state);
    return BAT_OK;
}

static double torus_distance(const bat_space *space, const double *p, const double *q)
{
    double way[2];
    (void)torus_log(space, p, q, way);
    return hypot(way[0], way[1]);
}

static bat_space torus(void)
{
    bat_space space = bat_euclidean(2);
    space.name = "torus";
    space.injectivity = 3;
    space.exp = torus_exp;
    space.log = torus_log;
    space.transport = torus_transport;
    space.distance = torus_distance;
    space.geodesic = NULL;
    return space;
}

/// All kinds of spaces: ours, a product of products, and a user's, with tangent vectors of as many numbers as dimensions
/// too.
typedef struct all_spaces
{
    bat_space spaces[11], factors[2], nested[2];
    bat_product_factors outer, inner;
    size_t count;
} all_spaces;

static void make_spaces(all_spaces *all)
{
    all->nested[0] = bat_sphere(2);
    all->nested[1] = bat_rotation();
    all->inner = (bat_product_factors){.spaces = all->nested, .count = 2};
    all->factors[0] = bat_euclidean(2);
    assert_int_equal(bat_product(&all->inner, &all->factors[1], NULL), BAT_OK);
    all->outer = (bat_product_factors){.spaces = all->factors, .count = 2};
    bat_space *space = all->spaces;
    *space++ = bat_euclidean(3);
    *space++ = bat_sphere(2);
    *space++ = bat_sphere(3);
    *space++ = bat_rotation();
    assert_int_equal(bat_rigid(2, space++, NULL), BAT_OK);
    *space++ = bat_disk();
    *space++ = bat_hyperbolic(3);
    *space++ = bat_positive_definite(3);
    assert_int_equal(bat_product(&all->outer, space++, NULL), BAT_OK);
    *space = bat_sphere(2);
    space->name = "user's";
    space++->log = slow_log;
    *space = bat_rotation();
    space->name = "user's turns";
    space++->log = slow_turn;
    all->count = (size_t)(space - all->spaces);
}

static void errors_fall_with_the_fourth_power(void **state)
{
    (void)state;
    all_spaces all;
    static keys made;
    make_spaces(&all);
    for (size_t s = 0; s < all.count; s++)
        for (int closed = 0; closed < 2; closed++)
        {
            smooth_curve curve = curve_in(&all.spaces[s]);
            double errors[2];
            for (int halving = 0; halving < 2; halving++)
            {
                sample_curve(&curve, (size_t)64 << halving, closed, &made);
                bat_motion_spline *spline = must_make(&made.curve, NULL);
                errors[halving] = largest_error(&curve, spline);
                bat_motion_spline_free(spline);
            }
            double order = log2(errors[0] / errors[1]);
            if (!(order > 3.85 && order < 4.6))
                print_message("%s: order %g\n", all.spaces[s].name, order);
            assert_true(order > 3.85 && order < 4.6);
            assert_true(errors[1] < 1e-6);
        }
}

/// Quotients across keys: velocity by points, acceleration by velocities, and no jump of either.
static void check_continuity(const bat_space *space, bool closed)
{
    static keys made;
    smooth_curve curve = curve_in(space);
    const double step = 1e-4, tiny = 1e-9;
    sample_curve(&curve, 14, closed, &made);
    bat_motion_spline *spline = must_make(&made.curve, NULL);
    for (size_t i = 1; i + 1 < made.curve.count; i++)
    {
        double t = made.times[i], p[3][DIM], v[3][DIM], a[3][DIM], way[2][DIM], moved[2][DIM];
        must_give(spline, t, p[1], v[1], a[1]);
        for (int side = 0; side < 3; side += 2)
        {
            must_give(spline, t + (side - 1) * step, p[side], v[side], NULL);
            assert_int_equal(space->log(space, p[1], p[side], way[side / 2]), BAT_OK);
            assert_int_equal(space->transport(space, p[side], p[1], v[side], moved[side / 2]), BAT_OK);
        }
        for (size_t c = 0; c < space->tangent_dim; c++)
        {
            assert_true(fabs((way[1][c] - way[0][c]) / (2 * step) - v[1][c]) < 1e-6);
            assert_true(fabs((moved[1][c] - moved[0][c]) / (2 * step) - a[1][c]) < 3e-3);
        }
        must_give(spline, t - tiny, p[0], v[0], a[0]);
        for (size_t c = 0; c < space->tangent_dim; c++)
        {
            assert_true(fabs(v[0][c] - v[1][c]) < 1e-6);
            assert_true(fabs(a[0][c] - a[1][c]) < 1e-6);
        }
    }
    bat_motion_spline_free(spline);
}

static void accelerations_are_continuous(void **state)
{
    (void)state;
    all_spaces all;
    bat_space cut = torus();
    make_spaces(&all);
    for (int closed = 0; closed < 2; closed++)
    {
        for (size_t s = 0; s < all.count; s++)
            check_continuity(&all.spaces[s], closed);
        check_continuity(&cut, closed);
    }
}

/// At the end of a period begins the next, twice continuously differentiable too.
static void closed_motions_are_periodic(void **state)
{
    (void)state;
    all_spaces all;
    static keys made;
    make_spaces(&all);
    for (size_t s = 0; s < all.count; s++)
    {
        const bat_space *space = &all.spaces[s];
        smooth_curve curve = curve_in(space);
        double p[2][DIM], v[2][DIM], a[2][DIM];
        sample_curve(&curve, 12, true, &made);
        bat_motion_spline *spline = must_make(&made.curve, NULL);
        must_give(spline, TURN - 1e-9, p[0], v[0], a[0]);
        must_give(spline, 0, p[1], v[1], a[1]);
        for (size_t c = 0; c < space->tangent_dim; c++)
            assert_true(fabs(v[0][c] - v[1][c]) < 1e-6 && fabs(a[0][c] - a[1][c]) < 1e-6);
        must_give(spline, 1, p[0], v[0], NULL);
        must_give(spline, 1 - 3 * TURN, p[1], v[1], NULL);
        assert_true(space->distance(space, p[0], p[1]) < 1e-13);
        bat_motion_spline_free(spline);
    }
}

static void reversed_keys_make_the_reversed_motion(void **state)
{
    (void)state;
    all_spaces all;
    static keys made, reversed;
    make_spaces(&all);
    for (size_t s = 0; s < all.count; s++)
        for (int shape = 0; shape <= BAT_MOTION_SHAPE_LIMITED; shape++)
        {
            const bat_space *space = &all.spaces[s];
            size_t dim = space->point_dim;
            smooth_curve curve = curve_in(space);
            bat_motion_spline_options options = bat_motion_spline_defaults();
            options.shape = (bat_motion_shape)shape;
            sample_curve(&curve, 9, false, &made);
            sample_curve(&curve, 9, false, &reversed);
            for (size_t i = 0; i < 10; i++)
            {
                memcpy(reversed.points + i * dim, made.points + (9 - i) * dim, dim * sizeof(double));
                reversed.times[i] = -made.times[9 - i];
            }
            bat_motion_spline *there = must_make(&made.curve, &options), *back = must_make(&reversed.curve, &options);
            for (int i = 0; i <= 50; i++)
            {
                double p[2][DIM], t = 4 * i / 50.0;
                must_give(there, t, p[0], NULL, NULL);
                must_give(back, -t, p[1], NULL, NULL);
                assert_true(space->distance(space, p[0], p[1]) < 1e-10);
            }
            bat_motion_spline_free(there);
            bat_motion_spline_free(back);
        }
}

static void not_a_knot_reproduces_cubics(void **state)
{
    (void)state;
    double times[] = {-1, 0.5, 0.75, 2, 4, 4.5}, points[6], p, v, a;
    bat_space line = bat_euclidean(1);
    for (size_t i = 0; i < 6; i++)
        points[i] = 1 + times[i] * (2 + times[i] * (3 - times[i]));
    for (size_t count = 4; count <= 6; count++)
    {
        bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = count};
        bat_motion_spline *spline = must_make(&curve, NULL);
        must_give(spline, 1.3, &p, &v, &a);
        assert_true(fabs(p - (1 + 1.3 * (2 + 1.3 * (3 - 1.3)))) < 1e-13);
        assert_true(fabs(v - (2 + 1.3 * (6 - 3.9))) < 1e-13);
        assert_true(fabs(a - (6 - 6 * 1.3)) < 1e-12);
        bat_motion_spline_free(spline);
    }
}

/// Numbers of scipy.interpolate.CubicSpline([0, 1, 2.5, 3, 5], [0, 2, -1, 0.5, 3]).
static void the_line_has_the_cubic_spline(void **state)
{
    (void)state;
    double times[] = {0, 1, 2.5, 3, 5}, points[] = {0, 2, -1, 0.5, 3}, p, v;
    double natural[] = {0.09921875000000013, -3.187946428571429}, clamped[] = {0.3235795454545456, -3.4068181818181813},
           knot[] = {-0.07656250000000031, -2.84375};
    const double *expected[] = {knot, knot, natural, clamped};
    bat_space line = bat_euclidean(1);
    bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = 5};
    for (int ends = 0; ends <= BAT_MOTION_ENDS_CLAMPED; ends++)
    {
        bat_motion_spline_options options = bat_motion_spline_defaults();
        options.ends = (bat_motion_ends)ends;
        bat_motion_spline *spline = must_make(&curve, &options);
        must_give(spline, 1.75, &p, &v, NULL);
        assert_true(fabs(p - expected[ends][0]) < 1e-13 && fabs(v - expected[ends][1]) < 1e-13);
        bat_motion_spline_free(spline);
    }
}

/// Rotations about one axis are a line of angles.
static void rotations_about_an_axis_are_a_line(void **state)
{
    (void)state;
    double times[] = {0, 1, 2.5, 3, 5}, angles[] = {0, 2, -1, 0.5, 3}, points[20];
    const double axis[] = {2.0 / 3, -1.0 / 3, 2.0 / 3};
    bat_space line = bat_euclidean(1), rotation = bat_rotation();
    for (size_t i = 0; i < 5; i++)
    {
        const double vector[] = {angles[i] * axis[0], angles[i] * axis[1], angles[i] * axis[2]};
        assert_int_equal(bat_rotation_from_vector(vector, points + 4 * i, NULL), BAT_OK);
    }
    bat_hermite_curve scalar = {.space = &line, .points = angles, .times = times, .count = 5};
    bat_hermite_curve turning = {.space = &rotation, .points = points, .times = times, .count = 5};
    for (int shape = 0; shape <= BAT_MOTION_SHAPE_LIMITED; shape++)
    {
        bat_motion_spline_options options = bat_motion_spline_defaults();
        options.shape = (bat_motion_shape)shape;
        options.ends = BAT_MOTION_ENDS_NOT_A_KNOT;
        bat_motion_spline *by_angle = must_make(&scalar, &options), *by_rotation = must_make(&turning, &options);
        for (int i = 0; i <= 40; i++)
        {
            double angle, rate, change, p[4], v[3], a[3], expected[4];
            must_give(by_angle, i / 8.0, &angle, &rate, &change);
            must_give(by_rotation, i / 8.0, p, v, a);
            const double vector[] = {angle * axis[0], angle * axis[1], angle * axis[2]};
            assert_int_equal(bat_rotation_from_vector(vector, expected, NULL), BAT_OK);
            assert_true(rotation.distance(&rotation, p, expected) < 1e-13);
            for (int c = 0; c < 3; c++)
                assert_true(fabs(v[c] - rate * axis[c]) < 1e-12 && fabs(a[c] - change * axis[c]) < 1e-11);
        }
        bat_motion_spline_free(by_angle);
        bat_motion_spline_free(by_rotation);
    }
}

static void two_keys_make_a_geodesic_and_three_a_parabola(void **state)
{
    (void)state;
    all_spaces all;
    static keys made;
    make_spaces(&all);
    for (size_t s = 0; s < all.count; s++)
    {
        const bat_space *space = &all.spaces[s];
        smooth_curve curve = curve_in(space);
        double p[DIM], expected[DIM], a[DIM];
        sample_curve(&curve, 1, false, &made);
        made.times[1] = 2;
        curve_at(&curve, 1, made.points + space->point_dim);
        bat_motion_spline *spline = must_make(&made.curve, NULL);
        must_give(spline, 0.5, p, NULL, a);
        bool tensors = strcmp(space->name, "spd") == 0; // whose logarithms go straight
        if (tensors)
        {
            double identity[DIM], log[2][DIM];
            positive_definite_identity(space, identity);
            for (size_t end = 0; end < 2; end++)
                assert_int_equal(space->log(space, identity, made.points + end * space->point_dim, log[end]), BAT_OK);
            for (size_t c = 0; c < space->tangent_dim; c++)
                log[0][c] += 0.25 * (log[1][c] - log[0][c]);
            assert_int_equal(space->exp(space, identity, log[0], expected), BAT_OK);
        }
        else
            assert_int_equal(bat_space_geodesic(space, made.points, made.points + space->point_dim, 0.25, expected), BAT_OK);
        assert_true(space->distance(space, p, expected) < 1e-10);
        for (size_t c = 0; c < space->tangent_dim && !tensors; c++)
            assert_true(fabs(a[c]) < 1e-8);
        bat_motion_spline_free(spline);
    }
    double times[] = {0, 1, 3}, points[] = {0, 1, 9}, p;
    bat_space line = bat_euclidean(1);
    bat_hermite_curve three = {.space = &line, .points = points, .times = times, .count = 3};
    bat_motion_spline *spline = must_make(&three, NULL);
    must_give(spline, 2.5, &p, NULL, NULL);
    assert_true(fabs(p - 6.25) < 1e-13);
    bat_motion_spline_free(spline);
}

static void what_rests_stays_at_rest(void **state)
{
    (void)state;
    double points[] = {0, 0, 0, 1, 3, 3, 2, 2}, p, v;
    bat_space line = bat_euclidean(1);
    bat_hermite_curve curve = {.space = &line, .points = points, .count = 8};
    for (int limited = 0; limited < 2; limited++)
    {
        bat_motion_spline_options options = bat_motion_spline_defaults();
        options.shape = limited ? BAT_MOTION_SHAPE_LIMITED : BAT_MOTION_SHAPE_RESTING;
        bat_motion_spline *spline = must_make(&curve, &options);
        for (int i = 0; i <= 70; i++)
        {
            double t = i / 10.0;
            must_give(spline, t, &p, &v, NULL);
            if (t <= 2)
                assert_true(p == 0 && v == 0);
            if ((t >= 4 && t <= 5) || t >= 6)
                assert_true(p == (t < 6 ? 3 : 2) && v == 0);
            assert_true(p >= 0 && p <= 3);
        }
        bat_motion_spline_free(spline);
    }
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.shape = BAT_MOTION_SHAPE_SMOOTH;
    bat_motion_spline *spline = must_make(&curve, &options);
    must_give(spline, 1.5, &p, NULL, NULL);
    assert_true(p < -0.01);
    bat_motion_spline_free(spline);
}

/// How far a motion is from a sine at most, at times from 0.5 to 9.5.
static double distance_from_sine(const bat_motion_spline *spline)
{
    double most = 0, p;
    for (int i = 0; i <= 900; i++)
    {
        double t = 0.5 + i / 100.0;
        must_give(spline, t, &p, NULL, NULL);
        most = fmax(most, fabs(p - sin(t)));
    }
    return most;
}

// Two keys that nearly agree in time, a burst of noisy ones, and a jump lead nowhere.
static void motions_do_not_leave_their_keys(void **state)
{
    (void)state;
    bat_space line = bat_euclidean(1);
    for (int what = 0; what < 3; what++)
    {
        double times[24], points[24], p;
        size_t count = 0;
        for (int i = 0; i <= 20; i++)
        {
            times[count] = i / 2.0;
            points[count++] = sin(i / 2.0) + (what == 2 && i > 10 ? 3 : 0);
            if (i == 10 && what < 2)
            {
                times[count] = 5 + 1e-5;
                points[count++] = sin(5) + (what == 0 ? 1e-3 : 0);
            }
        }
        bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = count};
        bat_motion_spline_options options = bat_motion_spline_defaults();
        bat_motion_spline *spline = must_make(&curve, &options);
        assert_int_equal(bat_motion_spline_keys(spline).held, 1);
        if (what < 2)
            assert_true(distance_from_sine(spline) < 0.005);
        for (int i = 0; i <= 100 && what == 2; i++)
        {
            must_give(spline, 4.5 + i / 100.0, &p, NULL, NULL);
            assert_true(p >= points[10] - 0.1 && p <= points[11] + 0.1);
        }
        bat_motion_spline_free(spline);
        options.shape = BAT_MOTION_SHAPE_SMOOTH;
        spline = must_make(&curve, &options);
        assert_int_equal(bat_motion_spline_keys(spline).held, 0);
        if (what < 2)
            assert_true(what == 1 || distance_from_sine(spline) > 1);
        bat_motion_spline_free(spline);
    }
}

// A jump from a rest does not tell the velocity after it: the motion goes on as if it began there.
static void jumps_tell_no_velocity(void **state)
{
    (void)state;
    double times[21], points[21], p;
    bat_space line = bat_euclidean(1);
    for (int i = 0; i <= 20; i++)
    {
        times[i] = i / 4.0;
        points[i] = i <= 10 ? 0 : 3 + sin(times[i]);
    }
    bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = 21};
    for (int shape = BAT_MOTION_SHAPE_RESTING; shape <= BAT_MOTION_SHAPE_SMOOTH; shape++)
    {
        bat_motion_spline_options options = bat_motion_spline_defaults();
        options.shape = (bat_motion_shape)shape;
        bat_motion_spline *spline = must_make(&curve, &options);
        double error = 0;
        for (int i = 0; i <= 100; i++)
        {
            must_give(spline, 2.75 + i / 100.0, &p, NULL, NULL);
            error = fmax(error, fabs(p - 3 - sin(2.75 + i / 100.0)));
        }
        assert_true(shape == BAT_MOTION_SHAPE_RESTING ? error < 2e-3 : error > 0.1);
        bat_motion_spline_free(spline);
    }
}

// Velocities from short steps do not lead far away over a long one.
static void gaps_are_crossed_gently(void **state)
{
    (void)state;
    double times[] = {0, 0.01, 0.02, 1, 1.01, 1.02}, points[] = {0, 0.1, 0.2, 0.3, 0.2, 0.1};
    bat_space line = bat_euclidean(1);
    bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = 6};
    bat_motion_spline_options options = bat_motion_spline_defaults();
    bat_motion_spline *spline = must_make(&curve, &options);
    for (int i = 0; i <= 100; i++)
    {
        double p;
        must_give(spline, 0.02 + 0.98 * i / 100.0, &p, NULL, NULL);
        assert_true(p >= 0.2 - 1e-12 && p <= 0.3 + 1e-12);
    }
    bat_motion_spline_free(spline);
}

/// The parabola through three keys leads far away where one step is much longer than the other.
static void three_keys_do_not_overshoot(void **state)
{
    (void)state;
    double times[] = {0, 1, 60}, points[] = {0, 1, 2}, p, far = 0;
    bat_space line = bat_euclidean(1);
    bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = 3};
    for (int backwards = 0; backwards < 2; backwards++)
    {
        bat_motion_spline *spline = must_make(&curve, NULL);
        for (int i = 0; i <= 600; i++)
        {
            must_give(spline, i / 10.0, &p, NULL, NULL);
            far = fmax(far, fmax(p - 2, -p));
        }
        bat_motion_spline_free(spline);
        times[1] = 59;
    }
    assert_true(far < 0.01);
}

/// Keys on one side tell the motion in a last gap for a short time, and hardly anything of a long one.
static void last_gaps_are_nearly_straight(void **state)
{
    (void)state;
    static const double ends[] = {1.9, 3.4};
    bat_space line = bat_euclidean(1);
    for (size_t end = 0; end < 2; end++)
    {
        double times[11], points[11], p, far = 0;
        for (int i = 0; i <= 10; i++)
        {
            times[i] = i < 10 ? i / 10.0 : ends[end];
            points[i] = cos(2 * times[i]);
        }
        bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = 11};
        bat_motion_spline *spline = must_make(&curve, NULL);
        for (int i = 0; i <= 100; i++)
        {
            double share = i / 100.0;
            must_give(spline, times[9] + share * (times[10] - times[9]), &p, NULL, NULL);
            far = fmax(far, fabs(p - (1 - share) * points[9] - share * points[10]));
        }
        assert_true(end == 0 ? far > 0.2 : far < 0.1);
        bat_motion_spline_free(spline);
    }
}

/// A recording tells the motion in a hole that is no longer than itself, even where that turns back: nothing is limited.
static void holes_of_recordings_turn_back(void **state)
{
    (void)state;
    double times[101], points[101];
    int count = 0;
    bat_space line = bat_euclidean(1);
    for (int i = 0; i <= 100; i++)
    {
        if (i > 40 && i < 55)
            continue;
        times[count] = i / 10.0;
        points[count] = sin(times[count]);
        count++;
    }
    bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = (size_t)count};
    bat_motion_spline *spline = must_make(&curve, NULL);
    for (int i = 0; i <= 100; i++)
    {
        double time = 4 + 1.5 * i / 100, p;
        must_give(spline, time, &p, NULL, NULL);
        assert_true(fabs(p - sin(time)) < 0.02);
    }
    bat_motion_spline_free(spline);
}

static void limited_motions_are_monotone(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    bat_space line = bat_euclidean(1);
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.shape = BAT_MOTION_SHAPE_LIMITED;
    for (int trial = 0; trial < 50; trial++)
    {
        double times[12], points[12], before, p;
        for (int i = 0; i < 12; i++)
        {
            times[i] = i + 0.8 * bat_random_uniform(&random);
            points[i] = floor(4 * bat_random_uniform(&random)) + (i % 3 == 0 ? 0 : bat_random_uniform(&random));
        }
        bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = 12};
        bat_motion_spline *spline = must_make(&curve, &options);
        for (int i = 0; i < 11; i++)
        {
            before = points[i];
            double direction = points[i + 1] >= points[i] ? 1 : -1;
            for (int j = 1; j <= 30; j++)
            {
                must_give(spline, times[i] + (times[i + 1] - times[i]) * j / 30, &p, NULL, NULL);
                assert_true(direction * (p - before) >= -1e-12);
                before = p;
            }
        }
        bat_motion_spline_free(spline);
    }
}

/// Where nothing has to be limited, the limited motion is the smooth one.
static void limits_leave_smooth_data_alone(void **state)
{
    (void)state;
    double points[8], p[2];
    bat_space line = bat_euclidean(1);
    for (int i = 0; i < 8; i++)
        points[i] = exp(0.3 * i);
    bat_hermite_curve curve = {.space = &line, .points = points, .count = 8};
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.shape = BAT_MOTION_SHAPE_LIMITED;
    bat_motion_spline *limited = must_make(&curve, &options), *smooth = must_make(&curve, NULL);
    for (int i = 0; i <= 70; i++)
    {
        must_give(limited, i / 10.0, &p[0], NULL, NULL);
        must_give(smooth, i / 10.0, &p[1], NULL, NULL);
        assert_true(p[0] == p[1]);
    }
    bat_motion_spline_free(limited);
    bat_motion_spline_free(smooth);
}

static void given_velocities_are_kept(void **state)
{
    (void)state;
    all_spaces all;
    static keys made;
    make_spaces(&all);
    for (size_t s = 0; s < all.count; s++)
    {
        const bat_space *space = &all.spaces[s];
        smooth_curve curve = curve_in(space);
        double velocities[MOST * DIM], p[2][DIM], v[2][DIM];
        sample_curve(&curve, 10, false, &made);
        bat_motion_spline *first = must_make(&made.curve, NULL);
        memcpy(velocities, bat_motion_spline_keys(first).velocities, made.curve.count * space->tangent_dim * sizeof(double));
        made.curve.tangents = velocities;
        bat_motion_spline *second = must_make(&made.curve, NULL);
        const double *again = bat_motion_spline_keys(second).velocities;
        assert_memory_equal(velocities, again, made.curve.count * space->tangent_dim * sizeof(double));
        for (int i = 0; i <= 20; i++)
        {
            must_give(first, i / 5.0, p[0], v[0], NULL);
            must_give(second, i / 5.0, p[1], v[1], NULL);
            // In R^n the spline has degree 5 then.
            assert_true(space->distance(space, p[0], p[1]) <
                        (space_is_euclidean(space) || space_is_rigid(space) || space_is_product(space) ? 1e-2 : 1e-9));
        }
        bat_motion_spline_free(first);
        bat_motion_spline_free(second);
    }
}

/// The greatest error of the spline through keys of a curve in the plane with its velocities, away from the ends.
static double error_with_velocities(size_t count)
{
    const bat_space space = bat_euclidean(2);
    double times[64], points[128], velocities[128], point[2], worst = 0;
    for (size_t i = 0; i < count; i++)
    {
        double t = times[i] = 8.0 * (double)i / (double)(count - 1);
        memcpy(points + 2 * i, (const double[]){sin(t), cos(1.3 * t)}, 2 * sizeof(double));
        memcpy(velocities + 2 * i, (const double[]){cos(t), -1.3 * sin(1.3 * t)}, 2 * sizeof(double));
    }
    const bat_hermite_curve curve = {
        .space = &space, .points = points, .tangents = velocities, .times = times, .count = count};
    bat_motion_spline *spline = must_make(&curve, NULL);
    for (int i = 200; i <= 600; i++)
    {
        double t = i / 100.0;
        must_give(spline, t, point, NULL, NULL);
        worst = fmax(worst, hypot(point[0] - sin(t), point[1] - cos(1.3 * t)));
    }
    bat_motion_spline_free(spline);
    return worst;
}

// The interpolant of degree 5 through three keys with velocities has errors of order 6 where their bends agree, at least 5
// else.
static void velocities_raise_the_order(void **state)
{
    (void)state;
    double coarse = error_with_velocities(17), fine = error_with_velocities(33);
    print_message("errors with velocities %.2g, %.2g\n", coarse, fine);
    assert_true(coarse < 1e-4 && coarse > 20 * fine);
}

// Intervals without a way and without velocities rest, whatever moves beside them.
static void given_rests_are_kept(void **state)
{
    (void)state;
    const bat_space space = bat_euclidean(2);
    double times[] = {0, 1, 2, 3, 4, 5}, points[] = {0, 0, 1, 1, 2, 0, 2, 0, 3, 1, 5, 0}, point[2];
    double velocities[] = {1, 1, 1, 0, 0, 0, 0, 0, 1, 0, 1, -1};
    const bat_hermite_curve curve = {.space = &space, .points = points, .tangents = velocities, .times = times, .count = 6};
    bat_motion_spline *spline = must_make(&curve, NULL);
    for (int i = 0; i <= 10; i++)
    {
        must_give(spline, 2 + i / 10.0, point, NULL, NULL);
        assert_true(point[0] == 2 && point[1] == 0);
    }
    bat_motion_spline_free(spline);
}

static void batches_agree_with_single_calls(void **state)
{
    (void)state;
    enum
    {
        COUNT = 10000
    };
    all_spaces all;
    static keys made;
    make_spaces(&all);
    double *times = malloc(COUNT * sizeof *times);
    double *made_points[2], *velocities[2], *accelerations[2];
    for (int i = 0; i < 2; i++)
    {
        made_points[i] = malloc((size_t)COUNT * DIM * sizeof(double));
        velocities[i] = malloc((size_t)COUNT * DIM * sizeof(double));
        accelerations[i] = malloc((size_t)COUNT * DIM * sizeof(double));
    }
    for (size_t s = 0; s < all.count; s++)
        for (int sorted = 0; sorted < 2; sorted++)
        {
            const bat_space *space = &all.spaces[s];
            smooth_curve curve = curve_in(space);
            bat_random random = bat_random_seed(9);
            sample_curve(&curve, 40, false, &made);
            for (size_t i = 0; i < COUNT; i++)
                times[i] = sorted ? 4.0 * (double)i / (COUNT - 1) : 4 * bat_random_uniform(&random);
            size_t count = s == 7 || s == 9 ? 300 : COUNT; // differences are slow
            size_t points_size = count * space->point_dim * sizeof(double);
            for (int threads = 1; threads <= 3; threads += 2)
            {
                bat_motion_spline_options options = bat_motion_spline_defaults();
                options.threads = threads;
                bat_motion_spline *spline = must_make(&made.curve, &options);
                assert_int_equal(bat_motion_spline_sample(spline, times, count, made_points[threads > 1], NULL, NULL, NULL),
                                 BAT_OK);
                for (size_t i = 0; i < count; i += 37)
                {
                    double p[DIM];
                    must_give(spline, times[i], p, NULL, NULL);
                    assert_true(space->distance(space, p, made_points[0] + i * space->point_dim) < 1e-13);
                }
                assert_int_equal(bat_motion_spline_sample(spline, times, count, made_points[threads > 1],
                                                          velocities[threads > 1], accelerations[threads > 1], NULL),
                                 BAT_OK);
                bat_motion_spline_free(spline);
            }
            assert_memory_equal(made_points[0], made_points[1], points_size);
            assert_memory_equal(velocities[0], velocities[1], count * space->tangent_dim * sizeof(double));
            assert_memory_equal(accelerations[0], accelerations[1], count * space->tangent_dim * sizeof(double));
        }
    for (int i = 0; i < 2; i++)
    {
        free(made_points[i]);
        free(velocities[i]);
        free(accelerations[i]);
    }
    free(times);
}

static void keys_come_back_bit_for_bit(void **state)
{
    (void)state;
    all_spaces all;
    static keys made;
    make_spaces(&all);
    for (size_t s = 0; s < all.count; s++)
    {
        const bat_space *space = &all.spaces[s];
        smooth_curve curve = curve_in(space);
        double p[DIM], all_points[MOST * DIM];
        sample_curve(&curve, 20, false, &made);
        bat_motion_spline *spline = must_make(&made.curve, NULL);
        assert_int_equal(bat_motion_spline_sample(spline, made.times, 21, all_points, NULL, NULL, NULL), BAT_OK);
        for (size_t i = 0; i < 21; i++)
        {
            must_give(spline, made.times[i], p, NULL, NULL);
            assert_memory_equal(p, all_points + i * space->point_dim, space->point_dim * sizeof(double));
            assert_true(space->distance(space, p, made.points + i * space->point_dim) < 1e-15);
        }
        bat_motion_spline_free(spline);
    }
}

static void times_outside_are_refused_or_extrapolated(void **state)
{
    (void)state;
    double points[] = {0, 1, 4, 9, 16}, times[] = {1, 2, 3, 4, 5}, p, v, a, many[3] = {2, 1, 5.5}, made[3];
    bat_space line = bat_euclidean(1);
    bat_hermite_curve curve = {.space = &line, .points = points, .times = times, .count = 5};
    bat_motion_spline *spline = must_make(&curve, NULL);
    bat_error error;
    assert_int_equal(bat_motion_spline_at(spline, 5.5, &p, NULL, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "time 5.5 is not within"));
    assert_int_equal(bat_motion_spline_at(spline, NAN, &p, NULL, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_motion_spline_sample(spline, many, 3, made, NULL, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 2);
    bat_motion_spline_free(spline);
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.extrapolate = true;
    spline = must_make(&curve, &options);
    must_give(spline, 5.5, &p, &v, &a);
    assert_true(fabs(p - 20) < 1e-12 && fabs(v - 8) < 1e-12 && a == 0);
    must_give(spline, 0, &p, &v, &a);
    assert_true(fabs(p) < 1e-12 && fabs(v) < 1e-12);
    bat_motion_spline_free(spline);
}

static void clamped_ends_take_velocities(void **state)
{
    (void)state;
    all_spaces all;
    static keys made;
    make_spaces(&all);
    for (size_t s = 0; s < all.count; s++)
    {
        const bat_space *space = &all.spaces[s];
        smooth_curve curve = curve_in(space);
        bat_motion_spline_options options = bat_motion_spline_defaults();
        double p[2][DIM], v[DIM];
        sample_curve(&curve, 8, false, &made);
        bat_motion_spline *spline = must_make(&made.curve, NULL);
        const double *velocities = bat_motion_spline_keys(spline).velocities;
        options.begin_velocity = velocities;
        options.end_velocity = velocities + 8 * space->tangent_dim;
        assert_int_equal(bat_options_check(&bat_motion_spline_fields, &options, NULL), BAT_INVALID_ARGUMENT);
        options.ends = BAT_MOTION_ENDS_CLAMPED;
        bat_motion_spline *clamped = must_make(&made.curve, &options);
        must_give(clamped, 4, p[0], v, NULL);
        assert_memory_equal(v, options.end_velocity, space->tangent_dim * sizeof *v);
        must_give(clamped, 0.1, p[0], NULL, NULL);
        must_give(spline, 0.1, p[1], NULL, NULL);
        assert_true(space->distance(space, p[0], p[1]) < 1e-8);
        bat_motion_spline_free(spline);
        bat_motion_spline_free(clamped);
    }
}

/// Turns about an axis that are longer than half of one: by velocities, in rotations and in poses, and by rotation vectors.
static void long_turns_go_as_told(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation(), rigid;
    check_status(bat_rigid(1, &rigid, NULL), BAT_OK);
    static const double RATES[] = {TURN_4 * 2, TURN_4 * 3, TURN_4 * 4, TURN_4 * 7, TURN_4 * 8, TURN_4 * 12 + 0.1};
    for (size_t r = 0; r < 2 * (sizeof RATES / sizeof *RATES); r++)
    {
        bool moves = r % 2 == 1;
        double rate = RATES[r / 2], points[4 * 7], velocities[4 * 6], turns[4 * 3], point[7], v[6], a[6];
        size_t at = moves ? 3 : 0, dim = moves ? 7 : 4, n = moves ? 6 : 3;
        for (size_t i = 0; i < 4; i++)
        {
            const double pose[] = {(double)i,
                                   0,
                                   0,
                                   cos(rate * (double)i / 2),
                                   0.6 * sin(rate * (double)i / 2),
                                   0,
                                   0.8 * sin(rate * (double)i / 2)};
            const double motion[] = {1, 0, 0, 0.6 * rate, 0, 0.8 * rate};
            memcpy(points + i * dim, pose + 3 - at, dim * sizeof *points);
            memcpy(velocities + i * n, motion + 3 - at, n * sizeof *velocities);
            memcpy(turns + 3 * i, motion + 3, 3 * sizeof *turns);
        }
        bat_hermite_curve given = {.space = moves ? &rigid : &rotation, .points = points, .count = 4};
        for (int how = 0; how < 2; how++)
        {
            bat_motion_spline_options options = bat_motion_spline_defaults();
            given.tangents = how == 0 ? velocities : NULL;
            options.turns = how == 0 ? NULL : turns;
            bat_motion_spline *spline = must_make(&given, &options);
            assert_int_equal(bat_motion_spline_keys(spline).turned, 3);
            for (int step = 0; step < 34; step++)
            {
                double time = 0.09 * step, apart[] = {time, fmod(time + 1.3, 3)}, both[2 * 7]; // in two intervals
                check_status(bat_motion_spline_at(spline, time, point, v, a, NULL), BAT_OK);
                check_status(bat_motion_spline_sample(spline, apart, 2, both, NULL, NULL, NULL), BAT_OK);
                check_near(given.space->distance(given.space, point, both), 0, 1e-13);
                check_near(fabs(point[at]), fabs(cos(rate * time / 2)), 1e-11);
                check_near(v[at], 0.6 * rate, 1e-9);
                check_near(v[at + 2], 0.8 * rate, 1e-9);
                check_near(a[at + 1], 0, 1e-8);
            }
            bat_motion_spline_free(spline);
        }
        // Velocities in degrees agree with no turn, and half a turn stays unknown.
        bat_motion_spline *spline = NULL;
        for (size_t i = 0; i < 4 * n; i++)
            velocities[i] *= 60;
        given.tangents = velocities;
        if (r < 2)
            check_status(bat_motion_spline_make(&given, NULL, &spline, NULL), BAT_CUT_LOCUS);
    }
}

/// Continuous accelerations through half turns and longer ones whose axes change, and the same keys.
static void told_turns_are_smooth(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    bat_random random = bat_random_seed(5);
    enum
    {
        TURNS = 9
    };
    double points[4 * TURNS], turns[3 * TURNS], point[4], sides[2][2][3];
    rotation.random_point(&rotation, &random, points);
    for (size_t i = 0; i < TURNS; i++)
    {
        double axis[] = {0.3 * bat_random_normal(&random), 0.3 * bat_random_normal(&random), 1}, turned[4],
               *turn = turns + 3 * i;
        double angle = i == 3 ? TURN_4 * 2 : TURN_4 * (1.5 + bat_random_uniform(&random));
        double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + 1);
        for (int c = 0; c < 3; c++)
            turn[c] = axis[c] * angle / length;
        check_status(rotation.exp(&rotation, points + 4 * i, turn, turned), BAT_OK);
        if (i + 1 < TURNS)
            memcpy(points + 4 * (i + 1), turned, sizeof turned);
    }
    bat_hermite_curve given = {.space = &rotation, .points = points, .count = TURNS};
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.turns = turns;
    bat_motion_spline *spline = must_make(&given, &options);
    assert_true(bat_motion_spline_keys(spline).turned >= 3);
    for (size_t i = 1; i + 1 < TURNS; i++)
    {
        for (int side = 0; side < 2; side++)
            check_status(bat_motion_spline_at(spline, (double)i + (side == 0 ? -1e-9 : 1e-9), point, sides[side][0],
                                              sides[side][1], NULL),
                         BAT_OK);
        check_near(rotation.distance(&rotation, point, points + 4 * i), 0, 1e-7);
        for (int c = 0; c < 3; c++)
        {
            check_near(sides[0][0][c], sides[1][0][c], 1e-6);
            check_near(sides[0][1][c], sides[1][1][c], 1e-5);
        }
    }
    bat_motion_spline_free(spline);
}

static void bad_keys_are_refused(void **state)
{
    (void)state;
    double points[] = {1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, times[] = {0, 2, 1};
    bat_space rotation = bat_rotation(), hollow = rotation;
    bat_motion_spline *spline;
    bat_error error;
    bat_hermite_curve curve = {.space = &rotation, .points = points, .count = 3};
    assert_int_equal(bat_motion_spline_make(&curve, NULL, &spline, &error), BAT_CUT_LOCUS);
    assert_int_equal(error.index, 1);
    points[4] = 1;
    points[5] = 0;
    curve.times = times;
    assert_int_equal(bat_motion_spline_make(&curve, NULL, &spline, &error), BAT_INVALID_POINT);
    curve.count = 1;
    assert_int_equal(bat_motion_spline_make(&curve, NULL, &spline, &error), BAT_INVALID_ARGUMENT);
    curve.count = 2;
    hollow.transport = NULL;
    curve.space = &hollow;
    assert_int_equal(bat_motion_spline_make(&curve, NULL, &spline, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "transport"));
}

/// Tensors far apart have a motion, whose velocities are those of its points, and which turns and grows with them.
static void tensors_far_apart_have_a_motion(void **state)
{
    (void)state;
    static const double points[] = {1.297674778,   -0.1155161591, -0.9098235203,  0.01248490101, 0.08390370844,
                                    0.6465138501,  0.09615691862, -0.01166950419, -0.074949576,  0.00681325047,
                                    0.04312848201, 0.277038058,   0.7884578339,   0.2565051589,  0.07220820535,
                                    0.09098037634, 0.01266295753, 0.02757847408};
    bat_space space = bat_positive_definite(3);
    double grown[18], p[6], q[6], near[2][6], v[6], rate[6];
    bat_hermite_curve curve = {.space = &space, .points = (double *)points, .count = 3}, more = curve;
    for (size_t i = 0; i < 18; i++)
        grown[i] = 1000 * points[i];
    more.points = grown;
    bat_motion_spline *spline = must_make(&curve, NULL), *larger = must_make(&more, NULL);
    for (size_t i = 0; i <= 40; i++)
    {
        double t = fmin(fmax((double)i / 20, 1e-4), 2 - 1e-4);
        must_give(spline, t, p, v, NULL);
        must_give(larger, t, q, NULL, NULL);
        for (size_t c = 0; c < 6; c++)
            assert_true(fabs(q[c] / 1000 - p[c]) < 1e-9);
        must_give(spline, t - 1e-4, near[0], NULL, NULL);
        must_give(spline, t + 1e-4, near[1], NULL, NULL);
        assert_int_equal(bat_positive_definite_velocity(&space, p, v, rate), BAT_OK);
        for (size_t c = 0; c < 6; c++)
            assert_true(fabs((near[1][c] - near[0][c]) / 2e-4 - rate[c]) < 1e-5 * (1 + fabs(rate[c])));
    }
    bat_motion_spline_free(spline);
    bat_motion_spline_free(larger);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tensors_far_apart_have_a_motion),
        cmocka_unit_test(errors_fall_with_the_fourth_power),
        cmocka_unit_test(accelerations_are_continuous),
        cmocka_unit_test(closed_motions_are_periodic),
        cmocka_unit_test(reversed_keys_make_the_reversed_motion),
        cmocka_unit_test(not_a_knot_reproduces_cubics),
        cmocka_unit_test(the_line_has_the_cubic_spline),
        cmocka_unit_test(rotations_about_an_axis_are_a_line),
        cmocka_unit_test(two_keys_make_a_geodesic_and_three_a_parabola),
        cmocka_unit_test(what_rests_stays_at_rest),
        cmocka_unit_test(motions_do_not_leave_their_keys),
        cmocka_unit_test(gaps_are_crossed_gently),
        cmocka_unit_test(last_gaps_are_nearly_straight),
        cmocka_unit_test(three_keys_do_not_overshoot),
        cmocka_unit_test(holes_of_recordings_turn_back),
        cmocka_unit_test(jumps_tell_no_velocity),
        cmocka_unit_test(limited_motions_are_monotone),
        cmocka_unit_test(limits_leave_smooth_data_alone),
        cmocka_unit_test(given_velocities_are_kept),
        cmocka_unit_test(velocities_raise_the_order),
        cmocka_unit_test(given_rests_are_kept),
        cmocka_unit_test(batches_agree_with_single_calls),
        cmocka_unit_test(keys_come_back_bit_for_bit),
        cmocka_unit_test(times_outside_are_refused_or_extrapolated),
        cmocka_unit_test(clamped_ends_take_velocities),
        cmocka_unit_test(long_turns_go_as_told),
        cmocka_unit_test(told_turns_are_smooth),
        cmocka_unit_test(bad_keys_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
