// Refinement of Hermite data: what is kept, what makes no difference, what is reproduced, and what is refused.

#include "hermite_helpers.h"
#include "motion/hermite_average.h"

#include "base/memory.h"

/// A scheme of averages, or a linear one of derivatives.
typedef struct hermite_scheme
{
    bat_hermite_refine_options refine;
    bool is_linear;
    bat_hermite_linear linear;
} hermite_scheme;

static hermite_scheme transport(bat_hermite_mask mask, size_t levels)
{
    hermite_scheme how = {bat_hermite_refine_defaults(), true, {mask, BAT_CURVE_BASE_VERTEX}};
    how.refine.levels = levels;
    return how;
}

static hermite_scheme lane_riesenfeld(size_t order, size_t levels)
{
    hermite_scheme how = transport(bat_hermite_mask_merrien(-0.125, -0.5), levels);
    how.is_linear = false;
    how.refine.order = order;
    return how;
}

static bat_status refine(const bat_hermite_curve *coarse, const hermite_scheme *how, bat_hermite_curve *fine,
                         bat_error *error)
{
    return bat_hermite_transport_refine(coarse, how->is_linear ? &how->linear : NULL, &how->refine, fine, error);
}

static bat_hermite_curve refined(const bat_hermite_curve *coarse, const hermite_scheme *how)
{
    bat_hermite_curve fine;
    bat_error error = {.text = ""};
    if (refine(coarse, how, &fine, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return fine;
}

static void check_same(const bat_hermite_curve *a, const bat_hermite_curve *b)
{
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->points, b->points, a->count * a->space->point_dim * sizeof(double));
    assert_memory_equal(a->tangents, b->tangents, a->count * a->space->tangent_dim * sizeof(double));
    if (a->times != NULL)
        assert_memory_equal(a->times, b->times, a->count * sizeof(double));
}

static void check_near_curves(const bat_hermite_curve *a, const bat_hermite_curve *b, double points, double tangents)
{
    const bat_space *space = a->space;
    assert_int_equal(a->count, b->count);
    for (size_t i = 0; i < a->count; i++)
    {
        const double *p = a->points + i * space->point_dim;
        check_near(space->distance(space, p, b->points + i * space->point_dim), 0, points);
        check_near(gap(space, p, a->tangents + i * space->tangent_dim, b->tangents + i * space->tangent_dim), 0, tangents);
    }
}

static void order_one_and_merrien_keep_the_given(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t s = 0; s < 2 * SPACES; s++)
    {
        const bat_space *space = &spaces[s / 2];
        study_curve curve = smooth_curve(space, s);
        bat_hermite_curve coarse = even_directions(&curve, 9, s % 2 == 0);
        hermite_scheme how[2] = {lane_riesenfeld(1, 3), transport(bat_hermite_mask_merrien(-0.125, -0.5), 3)};
        for (int k = 0; k < 2; k++)
        {
            bat_hermite_curve fine = refined(&coarse, &how[k]);
            assert_int_equal(fine.count, coarse.closed ? 72 : 65);
            for (size_t i = 0; i < coarse.count; i++)
            {
                assert_memory_equal(fine.points + 8 * i * space->point_dim, coarse.points + i * space->point_dim,
                                    space->point_dim * sizeof(double));
                check_near(fine.times[8 * i], coarse.times[i], 0);
                for (size_t c = 0; c < space->tangent_dim; c++)
                    check_near(fine.tangents[8 * i * space->tangent_dim + c],
                               coarse.tangents[i * space->tangent_dim + c] * (k == 1 ? 0.125 : 1), 0);
            }
            bat_hermite_free(&fine);
        }
        bat_hermite_free(&coarse);
        study_curve_free(&curve);
    }
}

static void threads_and_levels_make_no_difference(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_sphere(2), bat_rotation(), bat_sphere(3)};
    for (size_t s = 0; s < 3; s++)
        for (size_t order = 1; order <= 4; order++)
        {
            study_curve curve = smooth_curve(&spaces[s], order);
            bat_hermite_curve coarse = even_directions(&curve, 301, true);
            hermite_scheme how = lane_riesenfeld(order, 6);
            how.refine.threads = 1;
            bat_hermite_curve one = refined(&coarse, &how);
            how.refine.threads = 3;
            bat_hermite_curve three = refined(&coarse, &how);
            check_same(&one, &three);
            how.refine.levels = 3;
            bat_hermite_curve half = refined(&coarse, &how), whole = refined(&half, &how);
            check_near_curves(&one, &whole, 0, 0);
            bat_hermite_free(&one);
            bat_hermite_free(&three);
            bat_hermite_free(&half);
            bat_hermite_free(&whole);
            bat_hermite_free(&coarse);
            study_curve_free(&curve);
        }
}

/// Times are the spline of the given ones, and the period stays.
static void times_go_along(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2), line = bat_euclidean(1);
    study_curve curve = smooth_curve(&sphere, 8);
    for (size_t order = 1; order <= 5; order++)
    {
        bat_hermite_curve coarse = even_directions(&curve, 12, order % 2 == 0);
        for (size_t i = 1; i < coarse.count; i += 2)
            coarse.times[i] += 0.1;
        coarse.closing_time = coarse.closed ? 2 * PI + 0.3 - coarse.times[11] : 0;
        hermite_scheme how = lane_riesenfeld(order, 3);
        bat_hermite_curve fine = refined(&coarse, &how);
        check_status(bat_hermite_check(&fine, NULL), BAT_OK);
        if (coarse.closed)
            check_near(fine.times[fine.count - 1] - fine.times[0] + fine.closing_time, 2 * PI, 1e-14);
        bat_curve values = {.space = &line, .points = coarse.times, .count = coarse.count}, spline = {0};
        bat_curve_refine_options linear = bat_curve_refine_defaults();
        linear.scheme = bat_curve_scheme_linear(bat_mask_lane_riesenfeld(order));
        linear.levels = 3;
        check_status(bat_curve_refine(&values, &linear, &spline, NULL), BAT_OK);
        for (size_t i = 0; i < spline.count && !coarse.closed; i++)
            check_near(fine.times[i], spline.points[i], 1e-14);
        bat_curve_free(&spline);
        bat_hermite_free(&fine);
        bat_hermite_free(&coarse);
    }
    study_curve_free(&curve);
}

static void vector_code_agrees_with_the_spaces(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_sphere(2), bat_rotation()};
    bat_random random = bat_random_seed(3);
    for (size_t trial = 0; trial < 60; trial++)
    {
        const bat_space *known = &spaces[trial % 2];
        bat_space own = plain(known);
        // from nearly coinciding points to nearly antipodal ones, with directions that turn back
        double distance = trial < 20 ? pow(10, -(double)trial / 3) : 0.1 * (double)(trial % 31),
               amount = 0.1 * (double)(trial % 7);
        hermite_pair pair = random_pair(known, &random, distance + 1e-7, amount * amount * amount * amount);
        double points[2 * DIM], tangents[2 * DIM];
        memcpy(points, pair.p0, known->point_dim * sizeof *points);
        memcpy(points + known->point_dim, pair.p1, known->point_dim * sizeof *points);
        memcpy(tangents, pair.v0, known->tangent_dim * sizeof *points);
        memcpy(tangents + known->tangent_dim, pair.v1, known->tangent_dim * sizeof *points);
        bat_hermite_curve a = {.space = known, .points = points, .tangents = tangents, .count = 2}, b = a;
        b.space = &own;
        hermite_scheme how = lane_riesenfeld(1, 1);
        bat_hermite_curve fine_a = refined(&a, &how), fine_b = refined(&b, &how);
        check_near_curves(&fine_a, &fine_b, 1e-14, 4e-15 + 2e-15 / distance);
        bat_hermite_free(&fine_a);
        bat_hermite_free(&fine_b);
    }
}

/// q and -q are the same rotation, in whatever order keyframes come with one or the other.
static void signs_of_quaternions_make_no_difference(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    study_curve curve = smooth_curve(&rotation, 12);
    for (size_t order = 1; order <= 5; order++)
    {
        bat_hermite_curve data = even_directions(&curve, 10, order % 2 == 0);
        hermite_scheme how = order == 5 ? transport(bat_hermite_mask_de_rham(), 3) : lane_riesenfeld(order, 3);
        bat_hermite_curve plus = refined(&data, &how);
        for (size_t i = 0; i < 4 * data.count; i++)
            data.points[i] *= i / 4 % 3 == 0 ? -1 : 1;
        bat_hermite_curve minus = refined(&data, &how);
        check_near_curves(&plus, &minus, 1e-13, 1e-11);
        bat_hermite_free(&plus);
        bat_hermite_free(&minus);
        bat_hermite_free(&data);
    }
    study_curve_free(&curve);
}

static void reversal_reverses(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t trial = 0; trial < 2 * SPACES * 4; trial++)
    {
        const bat_space *space = &spaces[trial % SPACES];
        bool closed = trial / SPACES % 2 == 0;
        size_t order = 1 + trial / (2 * SPACES), count = 9;
        study_curve curve = smooth_curve(space, trial);
        bat_hermite_curve coarse = even_directions(&curve, count, closed), back = even_directions(&curve, count, closed);
        for (size_t i = 0; i < count; i++)
        {
            size_t j = count - 1 - i;
            memcpy(back.points + j * space->point_dim, coarse.points + i * space->point_dim,
                   space->point_dim * sizeof(double));
            negate(space, coarse.tangents + i * space->tangent_dim, back.tangents + j * space->tangent_dim);
        }
        hermite_scheme how = lane_riesenfeld(order, 3);
        bat_hermite_curve fine = refined(&coarse, &how), other = refined(&back, &how);
        // Parameter t becomes count - 1 - t; new point i is at i / 8, for even orders at (i + 7 / 2) / 8.
        size_t total = fine.count, shift = closed ? (order % 2 == 1 ? 7 : 14) : 0;
        for (size_t i = 0; i < total; i++)
        {
            size_t j = (2 * total - 1 - i - shift) % total;
            double turned[DIM];
            const double *p = fine.points + i * space->point_dim;
            negate(space, other.tangents + j * space->tangent_dim, turned);
            check_near(space->distance(space, p, other.points + j * space->point_dim), 0, 1e-13);
            check_near(gap(space, p, fine.tangents + i * space->tangent_dim, turned), 0, 1e-11);
        }
        bat_hermite_free(&fine);
        bat_hermite_free(&other);
        bat_hermite_free(&coarse);
        bat_hermite_free(&back);
        study_curve_free(&curve);
    }
}

/// Samples of a geodesic, evenly spaced.
static bat_hermite_curve geodesic_samples(const bat_space *space, uint64_t seed, double step, size_t count)
{
    bat_hermite_curve samples = {.space = space, .count = count};
    samples.points = memory_array(count, space->point_dim * sizeof(double));
    samples.tangents = memory_array(count, space->tangent_dim * sizeof(double));
    assert_true(samples.points != NULL && samples.tangents != NULL);
    double p[DIM], v[DIM], way[DIM];
    bat_random random = bat_random_seed(seed);
    space->random_point(space, &random, p);
    random_direction(space, &random, p, v);
    for (size_t i = 0; i < count; i++)
    {
        double *point = samples.points + i * space->point_dim;
        for (size_t c = 0; c < space->tangent_dim; c++)
            way[c] = step * (double)i * v[c];
        check_status(space->exp(space, p, way, point), BAT_OK);
        check_status(space->transport(space, p, point, v, samples.tangents + i * space->tangent_dim), BAT_OK);
    }
    return samples;
}

static void geodesics_are_reproduced(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t trial = 0; trial < 7 * SPACES; trial++)
    {
        const bat_space *space = &spaces[trial % SPACES];
        const size_t levels = 2, count = 6;
        size_t which = trial / SPACES;
        const double step = 0.2;
        hermite_scheme how = lane_riesenfeld(which + 1, levels);
        if (which >= 5)
            how = transport(which == 5 ? bat_hermite_mask_merrien(-0.125, -0.5) : bat_hermite_mask_de_rham(), levels);
        bool primal = which < 5 ? which % 2 == 0 : which == 5;
        bat_hermite_curve coarse = geodesic_samples(space, trial, step, count);
        if (which >= 5)
            for (size_t i = 0; i < count * space->tangent_dim; i++)
                coarse.tangents[i] *= step;
        bat_hermite_curve fine = refined(&coarse, &how);
        assert_int_equal(fine.count, primal ? 21 : 22);
        for (size_t i = 0; i < fine.count; i++)
        {
            // With two new points an edge the ends are the given ones, and the others half a step from the quarters.
            double place = primal ? 0.25 * (double)i : 0.25 * ((double)i - 0.5);
            place = primal ? place : fmin(fmax(place, 0), (double)count - 1);
            double expected[DIM], along[DIM], way[DIM];
            const double *p = fine.points + i * space->point_dim, *v = fine.tangents + i * space->tangent_dim;
            double length = which < 5 ? 1 : 0.25 * step;
            for (size_t c = 0; c < space->tangent_dim; c++)
                way[c] = place * step * coarse.tangents[c] / (which < 5 ? 1 : step);
            check_status(space->exp(space, coarse.points, way, expected), BAT_OK);
            check_near(space->distance(space, p, expected), 0, 1e-13);
            check_status(space->transport(space, coarse.points, p, coarse.tangents, along), BAT_OK);
            for (size_t c = 0; c < space->tangent_dim; c++)
                along[c] *= which < 5 ? 1 : 0.25;
            check_near(gap(space, p, v, along), 0, 2e-12 * length);
        }
        bat_hermite_free(&fine);
        bat_hermite_free(&coarse);
    }
}

/// a + b t + c t^2 + d t^3 and its derivative.
static void cubic(double t, double *value, double *slope)
{
    *value = 1 + t * (0.5 + t * (-0.3 + t * 0.1));
    *slope = 0.5 + t * (-0.6 + t * 0.3);
}

static void linear_schemes_reproduce_cubics(void **state)
{
    (void)state;
    bat_space line = bat_euclidean(1);
    const bat_hermite_mask masks[2] = {bat_hermite_mask_merrien(-0.125, -0.5), bat_hermite_mask_de_rham()};
    for (int k = 0; k < 4; k++)
    {
        double points[6], slopes[6];
        for (int i = 0; i < 6; i++)
            cubic(i, &points[i], &slopes[i]);
        bat_hermite_curve coarse = {.space = &line, .points = points, .tangents = slopes, .count = 6};
        hermite_scheme how = transport(masks[k % 2], 2);
        how.linear.base = k < 2 ? BAT_CURVE_BASE_VERTEX : BAT_CURVE_BASE_MIDPOINT;
        bat_hermite_curve fine = refined(&coarse, &how);
        for (size_t i = k % 2 == 0 ? 0 : 4; i < (k % 2 == 0 ? 21 : 18); i++)
        {
            double value, slope, t = k % 2 == 0 ? 0.25 * (double)i : 0.25 * ((double)i - 1) + 0.125;
            cubic(t, &value, &slope);
            check_near(fine.points[i], value, 1e-14);
            check_near(fine.tangents[i], 0.25 * slope, 1e-14);
        }
        bat_hermite_free(&fine);
    }
}

/// Limits of the de Rham transform are C2: second differences over h^2 settle, with differences that fall like h^0.8 or
/// faster. Those of Merrien's scheme do not: its limits are cubics joined at the points.
static void de_rham_limits_are_c2(void **state)
{
    (void)state;
    bat_space line = bat_euclidean(1);
    bat_random random = bat_random_seed(9);
    double points[8], slopes[8], jumps[2][2];
    for (int i = 0; i < 8; i++)
    {
        points[i] = bat_random_normal(&random);
        slopes[i] = bat_random_normal(&random);
    }
    bat_hermite_curve coarse = {.space = &line, .points = points, .tangents = slopes, .count = 8, .closed = true};
    for (int k = 0; k < 2; k++)
        for (int deep = 0; deep < 2; deep++)
        {
            size_t levels = deep == 0 ? 4 : 8;
            hermite_scheme how =
                transport(k == 0 ? bat_hermite_mask_merrien(-0.125, -0.5) : bat_hermite_mask_de_rham(), levels);
            bat_hermite_curve fine = refined(&coarse, &how);
            double scale = ldexp(1, 2 * (int)levels), *p = fine.points;
            jumps[k][deep] = 0;
            for (size_t i = 0; i + 3 < fine.count; i++)
                jumps[k][deep] = fmax(jumps[k][deep], scale * fabs(p[i + 3] - 3 * p[i + 2] + 3 * p[i + 1] - p[i]));
            bat_hermite_free(&fine);
        }
    assert_true(jumps[0][1] > 0.5 * jumps[0][0]);
    assert_true(jumps[1][1] < pow(2, -4 * 0.8) * jumps[1][0]);
}

/// Lane-Riesenfeld of points alone, by geodesics and by log-exp: in R^n the linear scheme; nowhere do points leave a
/// geodesic.
static void geodesic_averages_of_points(void **state)
{
    (void)state;
    bat_space solid = bat_euclidean(3);
    bat_random random = bat_random_seed(4);
    double points[3 * 7];
    for (int i = 0; i < 21; i++)
        points[i] = bat_random_normal(&random);
    for (size_t order = 1; order <= 12; order++)
        for (int closed = 0; closed < 2; closed++)
        {
            bat_curve coarse = {.space = &solid, .points = points, .count = 7, .closed = closed == 1}, a = {0}, b = {0},
                      c = {0};
            bat_curve_refine_options how = bat_curve_refine_defaults();
            how.levels = 3;
            how.scheme = bat_curve_scheme_geodesic(order);
            check_status(bat_curve_refine(&coarse, &how, &a, NULL), BAT_OK);
            how.scheme = bat_curve_scheme_linear(bat_mask_lane_riesenfeld(order));
            check_status(bat_curve_refine(&coarse, &how, &b, NULL), BAT_OK);
            how.scheme = bat_curve_scheme_log_exp(bat_mask_lane_riesenfeld(order));
            how.scheme.base = order % 3 == 0 ? BAT_CURVE_BASE_MIDPOINT : BAT_CURVE_BASE_VERTEX;
            how.ends = BAT_CURVE_END_RULE_REFLECT;
            check_status(bat_curve_refine(&coarse, &how, &c, NULL), BAT_OK);
            assert_int_equal(a.count, b.count);
            assert_int_equal(a.count, c.count);
            for (size_t i = 0; i < 3 * a.count; i++)
            {
                check_near(a.points[i], b.points[i], 2e-14);
                check_near(a.points[i], c.points[i], 2e-14);
            }
            bat_curve_free(&c);
            bat_curve_free(&a);
            bat_curve_free(&b);
        }
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t s = 0; s < SPACES; s++)
    {
        bat_hermite_curve straight = geodesic_samples(&spaces[s], s, 0.2, 6);
        bat_curve coarse = {.space = &spaces[s], .points = straight.points, .count = 6}, fine = {0};
        bat_curve_refine_options how = bat_curve_refine_defaults();
        how.levels = 2;
        for (int kind = 0; kind < 2; kind++)
        {
            how.scheme = kind == 0 ? bat_curve_scheme_geodesic(3) : bat_curve_scheme_log_exp(bat_mask_lane_riesenfeld(3));
            check_status(bat_curve_refine(&coarse, &how, &fine, NULL), BAT_OK);
            assert_int_equal(fine.count, 21);
            for (size_t i = 0; i < fine.count; i++)
                check_near(spaces[s].distance(&spaces[s], fine.points, fine.points + i * spaces[s].point_dim),
                           0.05 * (double)i, 1e-13);
            bat_curve_free(&fine);
        }
        bat_hermite_free(&straight);
    }
    bat_curve coarse = {.space = &solid, .points = points, .count = 7}, fine;
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = bat_curve_scheme_geodesic(3);
    how.scheme.mask.coefficients[0] += 0.1;
    check_status(bat_curve_refine(&coarse, &how, &fine, NULL), BAT_UNSUPPORTED);
}

static bat_hermite_curve good_data(study_curve *curve)
{
    static bat_space sphere;
    sphere = bat_sphere(2);
    *curve = smooth_curve(&sphere, 1);
    return even_directions(curve, 3000, false);
}

typedef struct bad_case
{
    const char *words; ///< that the message must contain
    bat_status status;
    size_t index;
    double *at, value; ///< what is spoilt
} bad_case;

static void faults_are_named(void **state)
{
    (void)state;
    study_curve curve;
    bat_hermite_curve data = good_data(&curve);
    double copied[3];
    memcpy(copied, data.points + 3 * 2000, sizeof copied);
    const bad_case cases[] = {
        {"not finite", BAT_INVALID_POINT, 1500, data.points + 3 * 1500 + 1, NAN},
        {"not of unit length", BAT_INVALID_POINT, 7, data.points + 3 * 7, 2},
        {"tangent of point 2222 is not finite", BAT_INVALID_POINT, 2222, data.tangents + 3 * 2222, INFINITY},
        {"tangent of point 41 is not tangent", BAT_INVALID_POINT, 41, data.tangents + 3 * 41, 0.77},
        {"not later", BAT_INVALID_POINT, 90, data.times + 90, -10},
        {"time of point 2999 is not finite", BAT_INVALID_POINT, 2999, data.times + 2999, NAN},
    };
    hermite_scheme how = lane_riesenfeld(1, 2);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
    {
        bat_hermite_curve fine = {0};
        bat_error error;
        double kept = *cases[k].at;
        *cases[k].at = cases[k].value;
        for (int threads = 1; threads <= 3; threads += 2)
        {
            how.refine.threads = threads;
            check_status(refine(&data, &how, &fine, &error), cases[k].status);
            assert_int_equal(error.index, cases[k].index);
            if (strstr(error.text, cases[k].words) == NULL)
                fail_msg("'%s' does not say '%s'", error.text, cases[k].words);
            assert_null(fine.points);
        }
        *cases[k].at = kept;
    }
    bat_hermite_free(&data);
    study_curve_free(&curve);
}

static void refused(const bat_hermite_curve *data, const hermite_scheme *how, bat_status status, size_t index,
                    const char *words)
{
    bat_hermite_curve fine = {0};
    bat_error error;
    check_status(refine(data, how, &fine, &error), status);
    assert_true(error.index == index);
    if (strstr(error.text, words) == NULL)
        fail_msg("'%s' does not say '%s'", error.text, words);
    assert_null(fine.points);
}

static void edges_at_fault_are_named(void **state)
{
    (void)state;
    study_curve curve;
    bat_hermite_curve data = good_data(&curve);
    hermite_scheme how = lane_riesenfeld(1, 2);
    double kept[3], turned[3];
    memcpy(kept, data.points + 3 * 2001, sizeof kept);
    memcpy(data.points + 3 * 2001, data.points + 3 * 2000, sizeof kept);
    memcpy(data.tangents + 3 * 2001, data.tangents + 3 * 2000, sizeof kept);
    refused(&data, &how, BAT_INVALID_POINT, 2001, "point 2001 repeats point 2000");
    check_status(bat_hermite_check(&data, NULL), BAT_OK);
    bat_hermite_free(&data);
    study_curve_free(&curve);

    data = good_data(&curve);
    for (size_t i = 1000; i < 1002; i++)
        for (int c = 0; c < 3; c++)
            data.tangents[3 * i + (size_t)c] *= -1;
    refused(&data, &how, BAT_INVALID_POINT, 1001, "directions of points 1000 and 1001 turn too much");
    check_status(hermite_check(&data, (hermite_check_parts){.unit = true, .edges = true, .admissible = true}, 1, NULL),
                 BAT_INVALID_POINT);
    for (int c = 0; c < 3; c++)
        turned[c] = data.tangents[30 + c] *= 0.5;
    refused(&data, &how, BAT_INVALID_POINT, 10, "has length 0.5, not 1");
    check_status(bat_hermite_normalize(&data, NULL), BAT_OK);
    check_near(data.tangents[30], 2 * turned[0], 1e-15);
    memset(data.tangents + 60, 0, 3 * sizeof *data.tangents);
    bat_error error;
    check_status(bat_hermite_normalize(&data, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 20);
    bat_hermite_free(&data);
    study_curve_free(&curve);

    bat_space sphere = bat_sphere(2);
    double points[9] = {1, 0, 0, 0, 1, 0, 0, -1, 0}, tangents[9] = {0, 1, 0, 0, 0, 1, 0, 0, 1};
    data = (bat_hermite_curve){.space = &sphere, .points = points, .tangents = tangents, .count = 3};
    refused(&data, &how, BAT_CUT_LOCUS, 2, "points 1 and 2 have no unique shortest geodesic");
    how.is_linear = true;
    refused(&data, &how, BAT_CUT_LOCUS, 2, "points 1 and 2 have no unique shortest geodesic");
}

static void options_are_checked(void **state)
{
    (void)state;
    study_curve curve;
    bat_hermite_curve data = good_data(&curve);
    hermite_scheme how = lane_riesenfeld(0, 2);
    refused(&data, &how, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, "must be from 1 to 10");
    how = lane_riesenfeld(BAT_HERMITE_MAX_ORDER + 1, 2);
    refused(&data, &how, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, "must be from 1 to 10");
    how = lane_riesenfeld(1, 60);
    refused(&data, &how, BAT_TOO_LARGE, BAT_NO_INDEX, "too many points");
    how = lane_riesenfeld(1, 2);
    how.refine.max_points = 3000 * 4 - 4;
    refused(&data, &how, BAT_TOO_LARGE, BAT_NO_INDEX, "");
    how = transport(bat_hermite_mask_merrien(-0.125, -0.5), 1);
    how.linear.mask.coefficients[1][0][0] = 0.9;
    refused(&data, &how, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, "sum to 1");
    how.linear.mask.count = 0;
    refused(&data, &how, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, "1 to 16 matrices");
    data.count = 1;
    refused(&data, &how, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, "1 to 16 matrices");
    how = lane_riesenfeld(1, 2);
    refused(&data, &how, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, "at least 2 points");
    data.count = 3000;
    bat_hermite_free(&data);
    study_curve_free(&curve);
}

static bool stop_at_half(void *context, double fraction)
{
    *(double *)context = fraction;
    return fraction < 0.5;
}

static void progress_can_stop(void **state)
{
    (void)state;
    study_curve curve;
    bat_hermite_curve data = good_data(&curve), fine = {0};
    hermite_scheme how = lane_riesenfeld(1, 8);
    double fraction = 0;
    how.refine.progress = (bat_progress){stop_at_half, &fraction};
    how.refine.threads = 1;
    check_status(refine(&data, &how, &fine, NULL), BAT_CANCELLED);
    assert_true(fraction >= 0.5 && fraction < 1);
    assert_null(fine.points);
    bat_hermite_free(&data);
    study_curve_free(&curve);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(order_one_and_merrien_keep_the_given),
        cmocka_unit_test(threads_and_levels_make_no_difference),
        cmocka_unit_test(times_go_along),
        cmocka_unit_test(signs_of_quaternions_make_no_difference),
        cmocka_unit_test(vector_code_agrees_with_the_spaces),
        cmocka_unit_test(reversal_reverses),
        cmocka_unit_test(geodesics_are_reproduced),
        cmocka_unit_test(linear_schemes_reproduce_cubics),
        cmocka_unit_test(de_rham_limits_are_c2),
        cmocka_unit_test(geodesic_averages_of_points),
        cmocka_unit_test(faults_are_named),
        cmocka_unit_test(edges_at_fault_are_named),
        cmocka_unit_test(options_are_checked),
        cmocka_unit_test(progress_can_stop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
