/// @file
/// Measured orders of convergence and constants of Hermite schemes on manifolds (bat_hermite_measure_orders): errors e(h) on
/// smooth curves, orders log2(e(2 h) / e(h)), proximity to Bezier averages, contraction and displacement.

#include "batten/research/motion_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/space.h"
#include "research/studies/motion_curves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PERIOD = 6.28318530717958647693;

enum
{
    SPACES = 9,
    COARSEST = 16, ///< number of samples of the coarsest data
    HALVINGS = 4,  ///< number of spacings, each half the one before
    LEVELS = 3,
    ORDERS = 5, ///< orders whose contraction and displacement are measured
    TRIALS = 20,
    THIRDS = 5, ///< elements to which the triangle inequality of a pair is applied
    DIM = 8,    ///< maximum dimension of points and tangents
    MIN_CAPACITY = 256
};

/// The spaces of the study, with the spaces that they refer to.
typedef struct study_spaces
{
    bat_space spaces[SPACES];
    bat_space factors[2];
    bat_product_factors product;
} study_spaces;

static const char *const SPACE_NAMES[SPACES] = {"R^3",       "sphere",    "disk",           "rotation",     "rigid",
                                                "spd 2 x 2", "spd 3 x 3", "hyperbolic H^3", "sphere x disk"};

static bat_status make_spaces(study_spaces *made, bat_error *error)
{
    *made = (study_spaces){.spaces = {bat_euclidean(3),
                                      bat_sphere(2),
                                      bat_disk(),
                                      bat_rotation(),
                                      {0},
                                      bat_positive_definite(2),
                                      bat_positive_definite(3),
                                      bat_hyperbolic(3)},
                           .factors = {bat_sphere(2), bat_disk()}};
    made->product = (bat_product_factors){.spaces = made->factors, .count = 2};
    bat_status status = bat_rigid(0.5, &made->spaces[4], error);
    return status == BAT_OK ? bat_product(&made->product, &made->spaces[SPACES - 1], error) : status;
}

/// A scheme of the table.
typedef struct study_scheme
{
    const char *name;
    bool points_alone; ///< `name` is one for bat_curve_scheme_by_name()
    bool estimated;
    bool linear;
    size_t order;
    bool smooth; ///< use the C2 mask
    bat_curve_base base;
} study_scheme;

static const study_scheme SCHEMES[] = {
    {.name = "hermite:order=1", .order = 1},
    {.name = "hermite:order=2", .order = 2},
    {.name = "hermite:order=3", .order = 3},
    {.name = "transport:mask=merrien", .linear = true, .order = 1},
    {.name = "transport:mask=merrien,base=midpoint", .linear = true, .order = 1, .base = BAT_CURVE_BASE_MIDPOINT},
    {.name = "transport:mask=de-rham", .linear = true, .order = 1, .smooth = true},
    {.name = "hermite:order=1,tangents=estimated", .estimated = true, .order = 1},
    {.name = "log-exp-4", .points_alone = true},
    {.name = "log-exp-lane-riesenfeld:order=3", .points_alone = true},
    {.name = "geodesic:order=3", .points_alone = true},
};
enum
{
    SCHEME_COUNT = sizeof SCHEMES / sizeof SCHEMES[0]
};

const char *bat_hermite_quantity_name(bat_hermite_quantity quantity)
{
    static const char *const NAMES[] = {"error",           "geodesic error", "point proximity",
                                        "angle proximity", "contraction",    "displacement",
                                        "halving",         "half share",     "triangle"};
    return quantity >= BAT_HERMITE_QUANTITY_ERROR && quantity <= BAT_HERMITE_QUANTITY_TRIANGLE ? NAMES[quantity] : "unknown";
}

/// A table that grows.
typedef struct study_table
{
    bat_hermite_table made;
    size_t capacity;
} study_table;

/// Append a measurement. Its order is computed from the row before, if that has the same names and quantity and twice the
/// spacing.
static bat_status add_row(study_table *table, bat_hermite_measure row, bat_error *error)
{
    bat_hermite_table *made = &table->made;
    if (made->count == table->capacity)
    {
        size_t capacity = table->capacity > 0 ? 2 * table->capacity : MIN_CAPACITY;
        bat_hermite_measure *rows = realloc(made->rows, capacity * sizeof *rows);
        if (rows == NULL)
            return error_memory(error, capacity * sizeof *rows);
        made->rows = rows;
        table->capacity = capacity;
    }
    const bat_hermite_measure *before = made->count > 0 ? &made->rows[made->count - 1] : NULL;
    bool halved = before != NULL && before->space == row.space && before->scheme == row.scheme &&
                  before->quantity == row.quantity && fabs(before->h - 2 * row.h) < 1e-9;
    row.order = halved ? log2(before->value / row.value) : NAN;
    made->rows[made->count++] = row;
    return BAT_OK;
}

// Errors and orders

/// The distance of a curve refined from points alone. Point i 2^LEVELS is close to sample i.
static bat_status points_alone_error(const study_curve *curve, const char *name, size_t count, double *largest,
                                     bat_error *error)
{
    bat_curve_refine_options how = bat_curve_refine_defaults();
    double parameters[COARSEST << (HALVINGS - 1)], times[COARSEST << (HALVINGS - 1 + LEVELS)];
    bat_hermite_curve samples = {0};
    bat_curve fine = {0};
    for (size_t i = 0; i < count; i++)
        parameters[i] = PERIOD * (double)i / (double)count;
    how.levels = LEVELS;
    how.simple = BAT_CURVE_SIMPLE_NEVER;
    bat_status status = bat_curve_scheme_by_name(name, &how.scheme, error);
    if (status == BAT_OK)
        status = study_curve_sample(curve, parameters, count, true, &samples, error);
    bat_curve coarse = {.space = curve->space, .points = samples.points, .count = count, .closed = true};
    if (status == BAT_OK)
        status = bat_curve_refine(&coarse, &how, &fine, error);
    for (size_t i = 0; i < fine.count; i++)
        times[i] = PERIOD * (double)i / (double)fine.count;
    bat_hermite_curve timed = {.space = curve->space, .points = fine.points, .times = times, .count = fine.count};
    if (status == BAT_OK && study_curve_error(curve, &timed, largest) != BAT_OK)
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the refined curve is too far from the smooth one");
    bat_hermite_free(&samples);
    bat_curve_free(&fine);
    return status;
}

static bat_status scheme_error(const study_curve *curve, const study_scheme *scheme, size_t count, double *largest,
                               bat_error *error)
{
    if (scheme->points_alone)
        return points_alone_error(curve, scheme->name, count, largest, error);
    bat_hermite_refine_options how = bat_hermite_refine_defaults();
    how.levels = LEVELS;
    how.order = scheme->order;
    bat_hermite_linear linear = {bat_hermite_mask_merrien(-0.125, -0.5), scheme->base};
    if (scheme->smooth)
        linear.mask = bat_hermite_mask_de_rham();
    study_setup setup = {.count = count, .closed = true, .estimated = scheme->estimated, .options = &how};
    setup.linear = scheme->linear ? &linear : NULL;
    return study_refinement_error(curve, &setup, largest, error);
}

static bat_status add_errors(study_table *table, const study_curve *curve, const char *space, const study_scheme *scheme,
                             bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t halving = 0; halving < HALVINGS && status == BAT_OK; halving++)
    {
        size_t count = (size_t)COARSEST << halving;
        bat_hermite_measure row = {
            .space = space, .scheme = scheme->name, .quantity = BAT_HERMITE_QUANTITY_ERROR, .h = PERIOD / (double)count};
        status = scheme_error(curve, scheme, count, &row.value, error);
        if (status == BAT_OK)
            status = add_row(table, row, error);
    }
    return status;
}

// Pairs

/// Two points with directions.
typedef struct study_pair
{
    double points[2 * DIM], directions[2 * DIM];
} study_pair;

static void random_direction(const bat_space *space, bat_random *random, const double *p, double *direction)
{
    double goal[DIM], square = 0;
    do
    {
        space->random_point(space, random, goal);
        square = space->log(space, p, goal, direction) == BAT_OK ? space->inner(space, p, direction, direction) : 0;
    } while (square < 1e-6);
    for (size_t k = 0; k < space->tangent_dim; k++)
        direction[k] /= sqrt(square);
}

/// Rotate a direction by up to asin(amount).
static void bend(const bat_space *space, bat_random *random, const double *p, double amount, double *direction)
{
    double other[DIM];
    random_direction(space, random, p, other);
    for (size_t k = 0; k < space->tangent_dim; k++)
        direction[k] += amount * other[k];
    double length = sqrt(space->inner(space, p, direction, direction));
    for (size_t k = 0; k < space->tangent_dim; k++)
        direction[k] /= length;
}

/// A random geodesic of a given length, with its directions rotated by up to asin(amount).
static bat_status random_pair(const bat_space *space, bat_random *random, double length, double amount, study_pair *pair)
{
    double way[DIM], *p = pair->points, *q = p + space->point_dim;
    double *v = pair->directions, *w = v + space->tangent_dim;
    space->random_point(space, random, p);
    random_direction(space, random, p, v);
    for (size_t k = 0; k < space->tangent_dim; k++)
        way[k] = length * v[k];
    bat_status status = space->exp(space, p, way, q);
    if (status == BAT_OK)
        status = space->transport(space, p, q, v, w);
    if (status == BAT_OK && amount > 0)
    {
        bend(space, random, p, amount, v);
        bend(space, random, q, amount, w);
    }
    return status;
}

/// The largest distance of the points of a refined pair from the geodesic at their parameters.
static bat_status geodesic_error(const bat_space *space, study_pair *pair, double *largest, bat_error *error)
{
    bat_hermite_curve coarse = {.space = space, .points = pair->points, .tangents = pair->directions, .count = 2}, fine;
    bat_status status = bat_hermite_refine(&coarse, NULL, &fine, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < fine.count && status == BAT_OK; i++)
    {
        double there[DIM], share = (double)i / (double)(fine.count - 1);
        status = bat_space_geodesic(space, pair->points, pair->points + space->point_dim, share, there);
        if (status == BAT_OK)
            *largest = fmax(*largest, space->distance(space, there, fine.points + i * space->point_dim));
    }
    bat_hermite_free(&fine);
    return status == BAT_OK ? BAT_OK : error_set(error, status, BAT_NO_INDEX, 0, "the pair has no geodesic");
}

static bat_status add_geodesics(study_table *table, const bat_space *space, const char *name, bat_error *error)
{
    bat_random random = bat_random_seed(1);
    bat_hermite_measure row = {
        .space = name, .scheme = SCHEMES[0].name, .quantity = BAT_HERMITE_QUANTITY_GEODESIC_ERROR, .h = NAN};
    bat_status status = BAT_OK;
    for (int trial = 0; trial < TRIALS && status == BAT_OK; trial++)
    {
        study_pair pair;
        status = random_pair(space, &random, 1, 0, &pair);
        status = status == BAT_OK ? geodesic_error(space, &pair, &row.value, error)
                                  : error_set(error, status, BAT_NO_INDEX, 0, "there is no random geodesic in %s", name);
    }
    return status == BAT_OK ? add_row(table, row, error) : status;
}

/// Proximity of lemma 3.7 and theorem 4.3 in isometrically embedded spaces; in R^3 it is 0.
static bat_status add_proximity(study_table *table, const bat_space *space, const char *name, bool angles, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t halving = 0; halving < HALVINGS && status == BAT_OK; halving++)
    {
        bat_random random = bat_random_seed(1);
        bat_hermite_measure row = {.space = name,
                                   .scheme = SCHEMES[0].name,
                                   .quantity =
                                       angles ? BAT_HERMITE_QUANTITY_ANGLE_PROXIMITY : BAT_HERMITE_QUANTITY_POINT_PROXIMITY,
                                   .h = ldexp(0.01, -(int)halving)};
        for (int trial = 0; trial < TRIALS && status == BAT_OK; trial++)
        {
            study_pair pair;
            study_proximity near = {0};
            status = random_pair(space, &random, row.h, 0.2, &pair);
            if (status == BAT_OK)
                status = study_proximity_of(space, pair.points, pair.directions, pair.points + space->point_dim,
                                            pair.directions + space->tangent_dim, &near);
            row.value = fmax(row.value, angles ? near.angle : near.point);
        }
        status = status == BAT_OK ? add_row(table, row, error)
                                  : error_set(error, status, BAT_NO_INDEX, 0, "a pair in %s has no average", name);
    }
    return status;
}

// Contraction and displacement

/// The largest ratios over LEVELS levels, from COARSEST samples.
static bat_status level_ratios(const study_curve *curve, size_t order, double *contraction, double *displacement,
                               bat_error *error)
{
    bat_hermite_refine_options how = bat_hermite_refine_defaults();
    bat_hermite_curve coarse = {0};
    double parameters[COARSEST];
    for (size_t i = 0; i < COARSEST; i++)
        parameters[i] = PERIOD * (double)i / COARSEST;
    bat_status status = study_curve_sample(curve, parameters, COARSEST, true, &coarse, error);
    if (status == BAT_OK)
        status = bat_hermite_normalize(&coarse, error);
    how.levels = 1;
    how.order = order;
    for (int level = 0; level < LEVELS && status == BAT_OK; level++)
    {
        bat_hermite_curve fine;
        status = bat_hermite_refine(&coarse, &how, &fine, error);
        if (status != BAT_OK)
            break;
        double longest = study_longest_edge(&coarse);
        *contraction = fmax(*contraction, study_longest_edge(&fine) / longest);
        *displacement = fmax(*displacement, study_displacement(&coarse, &fine) / longest);
        bat_hermite_free(&coarse);
        coarse = fine;
    }
    bat_hermite_free(&coarse);
    return status;
}

static bat_status add_ratios(study_table *table, const study_curve *curve, const char *space, bat_error *error)
{
    static const char *const NAMES[ORDERS] = {"hermite:order=1", "hermite:order=2", "hermite:order=3", "hermite:order=4",
                                              "hermite:order=5"};
    bat_status status = BAT_OK;
    for (size_t order = 1; order <= ORDERS && status == BAT_OK; order++)
    {
        bat_hermite_measure row = {.space = space, .scheme = NAMES[order - 1], .h = NAN};
        double contraction = 0, displacement = 0;
        status = level_ratios(curve, order, &contraction, &displacement, error);
        row.quantity = BAT_HERMITE_QUANTITY_CONTRACTION;
        row.value = contraction;
        if (status == BAT_OK)
            status = add_row(table, row, error);
        row.quantity = BAT_HERMITE_QUANTITY_DISPLACEMENT;
        row.value = displacement;
        if (status == BAT_OK)
            status = add_row(table, row, error);
    }
    return status;
}

// The length L_H of section 4.4

/// L_H of eq. (4.10).
static bat_status length_of(const bat_space *space, const double *p, const double *v, const double *q, const double *w,
                            double *length, bat_error *error)
{
    bat_hermite_length parts = {0};
    bat_status status = bat_hermite_length_of(space, p, v, q, w, &parts, error);
    *length = parts.path + parts.turn;
    return status;
}

/// The shares of L_H that a pair's halves have: from the first element to the average of both, and from there to the second.
static bat_status half_shares(const bat_space *space, const double *p, const double *v, const double *q, const double *w,
                              double shares[2], bat_error *error)
{
    double middle[DIM], direction[DIM], whole = 0;
    bat_status status = bat_hermite_average(space, p, v, q, w, 0.5, middle, direction);
    if (status != BAT_OK)
        return error_set(error, status, BAT_NO_INDEX, 0, "a pair has no average");
    status = length_of(space, p, v, q, w, &whole, error);
    if (status == BAT_OK)
        status = length_of(space, p, v, middle, direction, &shares[0], error);
    if (status == BAT_OK)
        status = length_of(space, middle, direction, q, w, &shares[1], error);
    shares[0] /= whole;
    shares[1] /= whole;
    return status;
}

/// Eq. (4.14) on neighbours of a smooth curve.
static bat_status curve_halving(const study_curve *curve, size_t count, double *largest, bat_error *error)
{
    const bat_space *space = curve->space;
    double parameters[COARSEST << (HALVINGS - 1)];
    bat_hermite_curve samples = {0};
    for (size_t i = 0; i < count; i++)
        parameters[i] = PERIOD * (double)i / (double)count;
    bat_status status = study_curve_sample(curve, parameters, count, true, &samples, error);
    if (status == BAT_OK)
        status = bat_hermite_normalize(&samples, error);
    for (size_t i = 0; i + 1 < count && status == BAT_OK; i++)
    {
        const double *p = samples.points + i * space->point_dim, *v = samples.tangents + i * space->tangent_dim;
        double shares[2] = {0};
        status = half_shares(space, p, v, p + space->point_dim, v + space->tangent_dim, shares, error);
        *largest = fmax(*largest, fmax(fabs(shares[0] - 0.5), fabs(shares[1] - 0.5)));
    }
    bat_hermite_free(&samples);
    return status;
}

static bat_status add_halving(study_table *table, const study_curve *curve, const char *name, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t halving = 0; halving < HALVINGS && status == BAT_OK; halving++)
    {
        size_t count = (size_t)COARSEST << halving;
        bat_hermite_measure row = {
            .space = name, .scheme = SCHEMES[0].name, .quantity = BAT_HERMITE_QUANTITY_HALVING, .h = PERIOD / (double)count};
        status = curve_halving(curve, count, &row.value, error);
        if (status == BAT_OK)
            status = add_row(table, row, error);
    }
    return status;
}

/// L_H(Q0, Q1) / (L_H(Q0, Q) + L_H(Q, Q1)) for an element Q near the average of the pair: 0.1 from its point, its direction
/// rotated by up to asin(0.2).
static bat_status triangle_quotient(const bat_space *space, bat_random *random, const study_pair *pair, double *quotient,
                                    bat_error *error)
{
    const double *p = pair->points, *q = p + space->point_dim, *v = pair->directions, *w = v + space->tangent_dim;
    double whole = 0, first = 0, second = 0, middle[DIM], direction[DIM], way[DIM], third[DIM], along[DIM];
    bat_status status = bat_hermite_average(space, p, v, q, w, 0.5, middle, direction);
    if (status == BAT_OK)
    {
        random_direction(space, random, middle, way);
        for (size_t k = 0; k < space->tangent_dim; k++)
            way[k] *= 0.1;
        status = space->exp(space, middle, way, third);
    }
    if (status == BAT_OK)
        status = space->transport(space, middle, third, direction, along);
    if (status != BAT_OK)
        return error_set(error, status, BAT_NO_INDEX, 0, "a pair has no average");
    bend(space, random, third, 0.2, along);
    status = length_of(space, p, v, q, w, &whole, error);
    if (status == BAT_OK)
        status = length_of(space, p, v, third, along, &first, error);
    if (status == BAT_OK)
        status = length_of(space, third, along, q, w, &second, error);
    *quotient = whole / (first + second);
    return status;
}

/// Eqs. (4.11) and (4.12) on a pair.
static bat_status pair_lengths(const bat_space *space, bat_random *random, const study_pair *pair, double *share,
                               double *triangle, bat_error *error)
{
    const double *p = pair->points, *q = p + space->point_dim, *v = pair->directions, *w = v + space->tangent_dim;
    double shares[2] = {0}, quotient = 0;
    bat_status status = half_shares(space, p, v, q, w, shares, error);
    *share = fmax(*share, fmax(shares[0], shares[1]));
    for (int k = 0; k < THIRDS && status == BAT_OK; k++)
    {
        status = triangle_quotient(space, random, pair, &quotient, error);
        *triangle = fmax(*triangle, quotient);
    }
    return status;
}

static bat_status add_lengths(study_table *table, const bat_space *space, const char *name, bat_error *error)
{
    bat_random random = bat_random_seed(1);
    double share = 0, triangle = 0;
    bat_status status = BAT_OK;
    for (int trial = 0; trial < TRIALS && status == BAT_OK; trial++)
    {
        study_pair pair;
        status = random_pair(space, &random, 1, 0.7, &pair);
        status = status == BAT_OK ? pair_lengths(space, &random, &pair, &share, &triangle, error)
                                  : error_set(error, status, BAT_NO_INDEX, 0, "there is no random pair in %s", name);
    }
    bat_hermite_measure row = {.space = name, .scheme = SCHEMES[0].name, .h = NAN};
    row.quantity = BAT_HERMITE_QUANTITY_HALF_SHARE;
    row.value = share;
    if (status == BAT_OK)
        status = add_row(table, row, error);
    row.quantity = BAT_HERMITE_QUANTITY_TRIANGLE;
    row.value = triangle;
    return status == BAT_OK ? add_row(table, row, error) : status;
}

static bat_status check_progress(bat_progress progress, size_t done, size_t all, bat_error *error)
{
    if (progress.report == NULL || progress.report(progress.context, (double)done / (double)all))
        return BAT_OK;
    return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "measuring was cancelled");
}

/// All rows of space `s`.
static bat_status add_space(study_table *table, const study_spaces *made, size_t s, bat_progress progress, bat_error *error)
{
    const bat_space *space = &made->spaces[s];
    study_curve curve;
    bat_status status = study_curve_make(space, 0.5, s, &curve, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < SCHEME_COUNT && status == BAT_OK; i++)
    {
        status = check_progress(progress, s * SCHEME_COUNT + i, SPACES * (size_t)SCHEME_COUNT, error);
        if (status == BAT_OK)
            status = add_errors(table, &curve, SPACE_NAMES[s], &SCHEMES[i], error);
    }
    if (status == BAT_OK)
        status = add_geodesics(table, space, SPACE_NAMES[s], error);
    for (int angles = 0; angles < 2 && status == BAT_OK && strcmp(space->name, "sphere") == 0; angles++)
        status = add_proximity(table, space, SPACE_NAMES[s], angles == 1, error);
    if (status == BAT_OK)
        status = add_ratios(table, &curve, SPACE_NAMES[s], error);
    if (status == BAT_OK)
        status = add_halving(table, &curve, SPACE_NAMES[s], error);
    if (status == BAT_OK)
        status = add_lengths(table, space, SPACE_NAMES[s], error);
    study_curve_free(&curve);
    return status;
}

bat_status bat_hermite_measure_orders(bat_progress progress, bat_hermite_table *table, bat_error *error)
{
    study_spaces made;
    study_table grown = {0};
    bat_status status = make_spaces(&made, error);
    for (size_t s = 0; s < SPACES && status == BAT_OK; s++)
        status = add_space(&grown, &made, s, progress, error);
    if (status == BAT_OK)
        *table = grown.made;
    else
        bat_hermite_table_free(&grown.made);
    return status;
}

void bat_hermite_table_free(bat_hermite_table *table)
{
    free(table->rows);
    *table = (bat_hermite_table){0};
}
