#ifndef TESTS_SUPPORT_HERMITE_HELPERS_H
#define TESTS_SUPPORT_HERMITE_HELPERS_H

// Spaces, Hermite data in them, isometries, and refinement that must succeed.

#include "batten/motion_hermite.h"
#include "batten/space.h"
#include "check.h"
#include "research/studies/motion_curves.h"

enum
{
    SPACES = 11,
    DIM = 8 ///< room for a point or tangent of any of the spaces
};

static const double PI = 3.14159265358979323846;

/// Of each kind one or two. Keeps what they refer to.
static inline void all_spaces(bat_space spaces[SPACES])
{
    static const double weights[2] = {1, 2};
    static bat_space factors[2];
    static bat_product_factors product;
    const bat_space made[SPACES - 2] = {
        bat_euclidean(2),         bat_euclidean(3),         bat_sphere(2),    bat_sphere(3), bat_disk(), bat_rotation(),
        bat_positive_definite(2), bat_positive_definite(3), bat_hyperbolic(3)};
    memcpy(spaces, made, sizeof made);
    factors[0] = bat_sphere(2);
    factors[1] = bat_disk();
    product = (bat_product_factors){factors, weights, 2};
    check_status(bat_product(&product, &spaces[SPACES - 2], NULL), BAT_OK);
    check_status(bat_rigid(0.5, &spaces[SPACES - 1], NULL), BAT_OK);
}

/// A space's function under another address: then no vector code is used for it.
static inline bat_status plain_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    const bat_space *real = space->parameters;
    return bat_space_geodesic(real, p, q, t, point);
}

static inline bat_space plain(const bat_space *space)
{
    bat_space own = *space;
    own.geodesic = plain_geodesic;
    own.parameters = space;
    return own;
}

static inline double length_of(const bat_space *space, const double *p, const double *v)
{
    return sqrt(space->inner(space, p, v, v));
}

/// |u - v|
static inline double gap(const bat_space *space, const double *p, const double *u, const double *v)
{
    double difference[DIM];
    for (size_t i = 0; i < space->tangent_dim; i++)
        difference[i] = u[i] - v[i];
    return length_of(space, p, difference);
}

static inline void negate(const bat_space *space, const double *v, double *negative)
{
    for (size_t i = 0; i < space->tangent_dim; i++)
        negative[i] = -v[i];
}

/// The unit vector at p towards a random point.
static inline void random_direction(const bat_space *space, bat_random *random, const double *p, double *v)
{
    double goal[DIM];
    do
        space->random_point(space, random, goal);
    while (space->log(space, p, goal, v) != BAT_OK || length_of(space, p, v) < 1e-3);
    double length = length_of(space, p, v);
    for (size_t i = 0; i < space->tangent_dim; i++)
        v[i] /= length;
}

/// v + amount times a random direction, of unit length.
static inline void bend(const bat_space *space, bat_random *random, const double *p, double amount, double *v)
{
    double other[DIM];
    random_direction(space, random, p, other);
    for (size_t i = 0; i < space->tangent_dim; i++)
        other[i] = v[i] + amount * other[i];
    double length = length_of(space, p, other);
    for (size_t i = 0; i < space->tangent_dim; i++)
        v[i] = other[i] / length;
}

/// Two points `distance` apart with directions that are off the geodesic by up to `amount` (tangent of the angle).
typedef struct hermite_pair
{
    double p0[DIM], v0[DIM], p1[DIM], v1[DIM];
} hermite_pair;

static inline hermite_pair random_pair(const bat_space *space, bat_random *random, double distance, double amount)
{
    hermite_pair pair;
    double way[DIM];
    space->random_point(space, random, pair.p0);
    random_direction(space, random, pair.p0, pair.v0);
    for (size_t i = 0; i < space->tangent_dim; i++)
        way[i] = distance * pair.v0[i];
    check_status(space->exp(space, pair.p0, way, pair.p1), BAT_OK);
    check_status(space->transport(space, pair.p0, pair.p1, pair.v0, pair.v1), BAT_OK);
    bend(space, random, pair.p0, amount, pair.v0);
    bend(space, random, pair.p1, amount, pair.v1);
    return pair;
}

/// The geodesic symmetry in a centre, an isometry of every space here. Its derivative is minus the transport through the
/// centre.
static inline void reflect(const bat_space *space, const double *centre, const double *p, const double *v, double *image,
                           double *moved)
{
    double way[DIM], there[DIM];
    check_status(space->log(space, centre, p, way), BAT_OK);
    negate(space, way, way);
    check_status(space->exp(space, centre, way, image), BAT_OK);
    check_status(space->transport(space, p, centre, v, there), BAT_OK);
    check_status(space->transport(space, centre, image, there, moved), BAT_OK);
    negate(space, moved, moved);
}

static inline bat_hermite_curve hermite_refined(const bat_hermite_curve *coarse, const bat_hermite_refine_options *how)
{
    bat_hermite_curve fine = {0};
    bat_error error;
    if (bat_hermite_refine(coarse, how, &fine, &error) != BAT_OK)
        fail_msg("%s: %s", coarse->space->name, error.text);
    return fine;
}

/// Samples of a smooth closed curve, evenly spaced in its parameter; all around, or about half of it for an open curve.
static inline bat_hermite_curve even_samples(const study_curve *curve, size_t count, bool closed)
{
    double parameters[4096];
    assert_true(count <= 4096);
    for (size_t i = 0; i < count; i++)
        parameters[i] = 0.3 + (closed ? 2 * PI * (double)i / (double)count : PI * (double)i / (double)(count - 1));
    bat_hermite_curve samples;
    check_status(study_curve_sample(curve, parameters, count, closed, &samples, NULL), BAT_OK);
    return samples;
}

/// The same with directions instead of velocities.
static inline bat_hermite_curve even_directions(const study_curve *curve, size_t count, bool closed)
{
    bat_hermite_curve samples = even_samples(curve, count, closed);
    check_status(bat_hermite_normalize(&samples, NULL), BAT_OK);
    return samples;
}

static inline study_curve smooth_curve(const bat_space *space, uint64_t seed)
{
    study_curve curve;
    check_status(study_curve_make(space, 0.5, seed, &curve, NULL), BAT_OK);
    return curve;
}

#endif
