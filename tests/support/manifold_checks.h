#ifndef TESTS_SUPPORT_MANIFOLD_CHECKS_H
#define TESTS_SUPPORT_MANIFOLD_CHECKS_H

// Identities of the exponential, logarithm, transport and geodesics in every symmetric space, at all distances, and of
// subdivision in it.

#include "check.h"

#include <float.h>

#include "batten/batten.h"

typedef struct manifold_case
{
    const bat_space *space;
    uint64_t seed;
    int trials;
    double reach;    ///< longest tangent vectors, within the injectivity radius
    double rounding; ///< the effect of rounded coordinates on distances, at distances up to `reach`
} manifold_case;

static inline double manifold_length(const bat_space *space, const double *p, const double *v)
{
    return sqrt(space->inner(space, p, v, v));
}

/// A tangent vector at `p` of a given length in a random direction.
static inline void manifold_tangent(const bat_space *space, bat_random *random, const double *p, double length, double *v)
{
    double q[BAT_SPACE_MAX_DIM], norm;
    do
    {
        space->random_point(space, random, q);
        norm = space->log(space, p, q, v) == BAT_OK ? manifold_length(space, p, v) : 0;
    } while (!(norm > 1e-3));
    for (size_t i = 0; i < space->tangent_dim; i++)
        v[i] *= length / norm;
}

/// Half of the lengths between 1e-12 and `reach` are uniform in the logarithm, half of them are uniform.
static inline double manifold_separation(bat_random *random, double reach)
{
    double u = bat_random_uniform(random);
    return bat_random_bits(random) & 1 ? reach * u : reach * pow(1e-12 / reach, u);
}

static inline double manifold_difference(const bat_space *space, const double *p, const double *u, const double *v,
                                         double factor)
{
    double difference[BAT_SPACE_MAX_DIM];
    for (size_t i = 0; i < space->tangent_dim; i++)
        difference[i] = u[i] - factor * v[i];
    return manifold_length(space, p, difference);
}

static inline void manifold_check_inverses(const manifold_case *c)
{
    const bat_space *space = c->space;
    bat_random random = bat_random_seed(c->seed);
    double p[BAT_SPACE_MAX_DIM], q[BAT_SPACE_MAX_DIM], r[BAT_SPACE_MAX_DIM], v[BAT_SPACE_MAX_DIM], w[BAT_SPACE_MAX_DIM];
    for (int trial = 0; trial < c->trials; trial++)
    {
        space->random_point(space, &random, p);
        double d = manifold_separation(&random, c->reach), allowance = c->rounding * (1 + d);
        manifold_tangent(space, &random, p, d, v);
        check_status(space->exp(space, p, v, q), BAT_OK);
        assert_null(space->fault(space, p));
        assert_null(space->fault(space, q));
        check_near(space->distance(space, p, q), d, allowance);
        check_near(space->distance(space, q, p), space->distance(space, p, q), allowance);
        check_status(space->log(space, p, q, w), BAT_OK);
        check_near(manifold_difference(space, p, w, v, 1), 0, allowance);
        double exact = space->distance(space, p, q);
        check_near(manifold_length(space, p, w), exact, 1e-13 * exact + 1e-300);
        check_status(space->exp(space, p, w, r), BAT_OK);
        check_near(space->distance(space, q, r), 0, allowance);
        check_near(space->distance(space, p, p), 0, 0);
        check_status(space->log(space, p, p, w), BAT_OK);
        check_near(manifold_length(space, p, w), 0, 0);
    }
}

/// In a symmetric space the pole ladder is exact (Pennec, 2018): the transport of u from p to q is minus the logarithm at q
/// of the reflection of exp_p(u) in the midpoint.
static inline void manifold_check_pole_ladder(const manifold_case *c, bat_random *random, const double *p, const double *q)
{
    const bat_space *space = c->space;
    double middle[BAT_SPACE_MAX_DIM], tip[BAT_SPACE_MAX_DIM], image[BAT_SPACE_MAX_DIM];
    double u[BAT_SPACE_MAX_DIM], moved[BAT_SPACE_MAX_DIM], w[BAT_SPACE_MAX_DIM];
    manifold_tangent(space, random, p, 0.2 * fmin(c->reach, 1), u);
    check_status(space->transport(space, p, q, u, moved), BAT_OK);
    check_status(bat_space_geodesic(space, p, q, 0.5, middle), BAT_OK);
    check_status(space->exp(space, p, u, tip), BAT_OK);
    check_status(space->log(space, middle, tip, w), BAT_OK);
    for (size_t i = 0; i < space->tangent_dim; i++)
        w[i] = -w[i];
    check_status(space->exp(space, middle, w, image), BAT_OK);
    check_status(space->log(space, q, image, w), BAT_OK);
    check_near(manifold_difference(space, q, w, moved, -1), 0, 8 * c->rounding);
}

static inline void manifold_check_transport(const manifold_case *c)
{
    const bat_space *space = c->space;
    bat_random random = bat_random_seed(c->seed + 1);
    double p[BAT_SPACE_MAX_DIM], q[BAT_SPACE_MAX_DIM], u[BAT_SPACE_MAX_DIM], v[BAT_SPACE_MAX_DIM], w[BAT_SPACE_MAX_DIM];
    double at_q[BAT_SPACE_MAX_DIM], other[BAT_SPACE_MAX_DIM];
    for (int trial = 0; trial < c->trials; trial++)
    {
        space->random_point(space, &random, p);
        double d = manifold_separation(&random, 0.95 * c->reach);
        manifold_tangent(space, &random, p, d, v);
        check_status(space->exp(space, p, v, q), BAT_OK);
        check_status(space->log(space, p, q, v), BAT_OK);
        // the velocity of the geodesic
        check_status(space->transport(space, p, q, v, at_q), BAT_OK);
        check_status(space->log(space, q, p, w), BAT_OK);
        check_near(manifold_difference(space, q, at_q, w, -1), 0, c->rounding * (1 + d));
        // inner products
        manifold_tangent(space, &random, p, 1, u);
        manifold_tangent(space, &random, p, 1, w);
        check_status(space->transport(space, p, q, u, at_q), BAT_OK);
        check_status(space->transport(space, p, q, w, other), BAT_OK);
        check_near(space->inner(space, q, at_q, other), space->inner(space, p, u, w), 1e-13);
        check_near(manifold_length(space, q, at_q), 1, 1e-13);
        // and back
        check_status(space->transport(space, q, p, at_q, other), BAT_OK);
        check_near(manifold_difference(space, p, other, u, 1), 0, c->rounding * (1 + d));
        if (d < 0.4 * c->reach)
            manifold_check_pole_ladder(c, &random, p, q);
    }
}

static inline void manifold_check_geodesics(const manifold_case *c)
{
    const bat_space *space = c->space;
    bat_random random = bat_random_seed(c->seed + 2);
    double p[BAT_SPACE_MAX_DIM], q[BAT_SPACE_MAX_DIM], r[BAT_SPACE_MAX_DIM], s[BAT_SPACE_MAX_DIM], v[BAT_SPACE_MAX_DIM];
    for (int trial = 0; trial < c->trials; trial++)
    {
        space->random_point(space, &random, p);
        double d = manifold_separation(&random, c->reach), allowance = 2 * c->rounding * (1 + d);
        manifold_tangent(space, &random, p, d, v);
        check_status(space->exp(space, p, v, q), BAT_OK);
        double t = trial % 4 == 0 ? 0.5 : bat_random_uniform(&random);
        check_status(bat_space_geodesic(space, p, q, t, r), BAT_OK);
        assert_null(space->fault(space, r));
        check_near(space->distance(space, p, r), t * d, allowance);
        check_near(space->distance(space, r, q), (1 - t) * d, allowance);
        check_status(bat_space_geodesic(space, q, p, 1 - t, s), BAT_OK);
        check_near(space->distance(space, r, s), 0, allowance);
        check_status(bat_space_geodesic(space, p, q, 0, s), BAT_OK);
        check_near(space->distance(space, p, s), 0, allowance);
        check_status(bat_space_geodesic(space, p, q, 1, s), BAT_OK);
        check_near(space->distance(space, q, s), 0, allowance);
        // beyond the ends, the exponential of the longer tangent
        t = 1 + 0.5 * bat_random_uniform(&random);
        t = bat_random_bits(&random) & 1 ? t : 1 - t;
        check_status(bat_space_geodesic(space, p, q, t, r), BAT_OK);
        for (size_t i = 0; i < space->tangent_dim; i++)
            v[i] *= t;
        check_status(space->exp(space, p, v, s), BAT_OK);
        check_near(space->distance(space, r, s), 0, 4 * allowance);
    }
}

/// A log-exp scheme keeps equidistant points of a geodesic on it, also at the ends of open curves.
static inline void manifold_check_refinement(const manifold_case *c)
{
    enum
    {
        COUNT = 6,
        LEVELS = 3
    };
    const bat_space *space = c->space;
    size_t dim = space->point_dim;
    double *points = malloc(COUNT * dim * sizeof *points), q[BAT_SPACE_MAX_DIM], v[BAT_SPACE_MAX_DIM];
    assert_non_null(points);
    bat_random random = bat_random_seed(c->seed + 3);
    space->random_point(space, &random, points);
    manifold_tangent(space, &random, points, 0.2 * fmin(c->reach, 3), v);
    check_status(space->exp(space, points, v, q), BAT_OK);
    for (size_t i = 1; i < COUNT; i++)
        check_status(bat_space_geodesic(space, points, q, (double)i, points + i * dim), BAT_OK);
    bat_curve coarse = {.space = space, .points = points, .count = COUNT}, fine = {0};
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = LEVELS;
    bat_error error;
    check_status(bat_curve_scheme_by_name("log-exp-4", &options.scheme, &error), BAT_OK);
    check_status(bat_curve_refine(&coarse, &options, &fine, &error), BAT_OK);
    assert_int_equal(fine.count, ((COUNT - 1) << LEVELS) + 1);
    for (size_t i = 0; i < fine.count; i++)
    {
        double at[BAT_SPACE_MAX_DIM];
        check_status(bat_space_geodesic(space, points, q, (double)i / (1 << LEVELS), at), BAT_OK);
        check_near(space->distance(space, at, fine.points + i * dim), 0, 40 * c->rounding);
    }
    bat_curve_free(&fine);
    free(points);
}

static inline void manifold_check(const manifold_case *c)
{
    manifold_check_inverses(c);
    manifold_check_transport(c);
    manifold_check_geodesics(c);
    manifold_check_refinement(c);
}

#endif
