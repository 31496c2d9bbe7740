#include "batten/curve_measure.h"
#include "geometry_helpers.h"
#include "research/train/geometry_feature.h"
#include "research/train/geometry_insert.h"
#include "research/train/geometry_loss.h"

// Derivatives against finite differences, and what invariance says of them.

enum
{
    TRUTH = 333,
};

static const geometry_stencil STENCIL = {4, 3};

/// Random numbers that functions of a polygon are weighted with.
typedef struct weights
{
    double angles[MAX_COUNT], lengths[MAX_COUNT];
    double insertion[MAX_COUNT];
    double fine[2 * MAX_COORDINATES];
    double truth[3 * TRUTH];
} weights;

static weights random_weights(geometry_surface surface, bat_random *random)
{
    weights made;
    for (size_t j = 0; j < MAX_COUNT; j++)
    {
        made.angles[j] = symmetric_uniform(random);
        made.lengths[j] = symmetric_uniform(random);
        made.insertion[j] = 0.7 * symmetric_uniform(random);
    }
    for (size_t i = 0; i < 2 * MAX_COORDINATES; i++)
        made.fine[i] = symmetric_uniform(random);
    for (size_t i = 0; i < TRUTH; i++)
        polar_point(surface, 0.5 + 0.1 * bat_random_uniform(random), 6.28 * bat_random_uniform(random),
                    made.truth + i * geometry_dim(surface));
    return made;
}

/// An open polygon's ends have no angle and its last vertex no edge; weights there must not count.
static double profile_value(const geometry_polygon *polygon, const void *context)
{
    const weights *by = context;
    double angles[MAX_COUNT], lengths[MAX_COUNT], sum = 0;
    geometry_measure(polygon, (geometry_profile){angles, lengths});
    for (size_t j = 0; j < polygon->count; j++)
        sum += by->angles[j] * angles[j] + by->lengths[j] * lengths[j];
    return sum;
}

static void profile_gradient(const geometry_polygon *polygon, const void *context, double *gradients)
{
    weights by = *(const weights *)context;
    geometry_measure_back(polygon, (geometry_profile){by.angles, by.lengths}, gradients);
}

static double insert_value(const geometry_polygon *polygon, const void *context)
{
    const weights *by = context;
    double fine[2 * MAX_COORDINATES], sum = 0;
    geometry_insert(polygon, by->insertion, fine);
    size_t rows = polygon->count + geometry_edges(polygon);
    for (size_t i = 0; i < rows * geometry_dim(polygon->surface); i++)
        sum += by->fine[i] * fine[i];
    return sum;
}

static void insert_gradient(const geometry_polygon *polygon, const void *context, double *gradients)
{
    const weights *by = context;
    geometry_insert_back(polygon, by->insertion, by->fine, gradients, NULL);
}

/// Points of a polygon, the truth, and which is nearest to which.
typedef struct matched
{
    const double *truth;
    size_t of_points[MAX_COUNT], of_truth[TRUTH];
} matched;

static double distance_between(const double *p, const double *q, size_t dim)
{
    return dim == 2 ? hypot(p[0] - q[0], p[1] - q[1]) : hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
}

/// The Chamfer distance while nearest points stay the same, as they do but for finitely many places.
static double matched_value(const geometry_polygon *polygon, const void *context)
{
    const matched *by = context;
    size_t dim = geometry_dim(polygon->surface);
    double there = 0, back = 0;
    for (size_t i = 0; i < polygon->count; i++)
        there += distance_between(polygon->points + i * dim, by->truth + by->of_points[i] * dim, dim);
    for (size_t i = 0; i < TRUTH; i++)
        back += distance_between(by->truth + i * dim, polygon->points + by->of_truth[i] * dim, dim);
    return 0.5 * (there / (double)polygon->count + back / TRUTH);
}

static void matched_gradient(const geometry_polygon *polygon, const void *context, double *gradients)
{
    matched by = *(const matched *)context;
    geometry_chamfer_back(polygon->points, polygon->count, by.truth, TRUTH, geometry_dim(polygon->surface),
                          (geometry_matches){by.of_points, by.of_truth}, 1, gradients);
}

/// Likewise the mean distance of the polygon's points alone.
static double nearest_value(const geometry_polygon *polygon, const void *context)
{
    const matched *by = context;
    size_t dim = geometry_dim(polygon->surface);
    double sum = 0;
    for (size_t i = 0; i < polygon->count; i++)
        sum += distance_between(polygon->points + i * dim, by->truth + by->of_points[i] * dim, dim);
    return sum / (double)polygon->count;
}

static void nearest_gradient(const geometry_polygon *polygon, const void *context, double *gradients)
{
    const matched *by = context;
    geometry_mean_nearest_back(polygon->points, polygon->count, by->truth, geometry_dim(polygon->surface), by->of_points, 1,
                               gradients);
}

/// Run a check for polygons of every kind on every surface.
static void for_all(void (*check)(const geometry_polygon *polygon, const weights *by))
{
    bat_random random = bat_random_seed(11);
    for (size_t s = 0; s < 3; s++)
        for (int kind = 0; kind < KINDS; kind++)
            for (size_t count = 5; count <= MAX_COUNT; count = 2 * count + 1 + (count > 40 ? 15 : 0))
            {
                double points[MAX_COORDINATES];
                geometry_polygon polygon = make_polygon(SURFACES[s], (polygon_kind)kind, count, &random, points);
                weights by = random_weights(SURFACES[s], &random);
                check(&polygon, &by);
            }
}

static void check_measure(const geometry_polygon *polygon, const weights *by)
{
    check_polygon_gradient(polygon, profile_value, profile_gradient, by, 0, 1e-6);
}

static void check_insert(const geometry_polygon *polygon, const weights *by)
{
    check_polygon_gradient(polygon, insert_value, insert_gradient, by, 0, 1e-6);
    double gradients[MAX_COUNT] = {0};
    geometry_insert_back(polygon, by->insertion, by->fine, NULL, gradients);
    for (size_t j = 0; j < geometry_edges(polygon); j++)
    {
        weights moved = *by;
        double values[4], h = 2e-4;
        for (int k = 0; k < 4; k++)
        {
            moved.insertion[j] = by->insertion[j] + FIVE_POINT_STEPS[k] * h;
            values[k] = insert_value(polygon, &moved);
        }
        check_near(gradients[j], five_point(values, h), 1e-9 * fabs(gradients[j]) + 2e-15 * (1 + fabs(values[0])) / h);
    }
}

static void check_chamfer(const geometry_polygon *polygon, const weights *by)
{
    matched matches = {.truth = by->truth};
    double distance = geometry_chamfer(polygon->points, polygon->count, by->truth, TRUTH, geometry_dim(polygon->surface),
                                       (geometry_matches){matches.of_points, matches.of_truth});
    check_relative(distance, matched_value(polygon, &matches), 1e-14);
    check_polygon_gradient(polygon, matched_value, matched_gradient, &matches, 1e-6, 1e-6);
}

static void measure_is_differentiated(void **state)
{
    (void)state;
    for_all(check_measure);
}

static void insertion_is_differentiated(void **state)
{
    (void)state;
    for_all(check_insert);
}

static void check_mean_nearest(const geometry_polygon *polygon, const weights *by)
{
    matched matches = {.truth = by->truth};
    double distance = geometry_mean_nearest(polygon->points, polygon->count, by->truth, TRUTH,
                                            geometry_dim(polygon->surface), matches.of_points);
    check_relative(distance, nearest_value(polygon, &matches), 1e-14);
    check_polygon_gradient(polygon, nearest_value, nearest_gradient, &matches, 1e-6, 1e-6);
}

static void mean_nearest_is_differentiated(void **state)
{
    (void)state;
    for_all(check_mean_nearest);
}

static void chamfer_is_differentiated(void **state)
{
    (void)state;
    for_all(check_chamfer);
}

/// Where the sides over an edge of the disk would not meet, the limit holds: the derivative by the angle is 0, those by the
/// ends are not.
static void limited_insertion_is_differentiated(void **state)
{
    (void)state;
    const double points[] = {-0.8, 0.1, 0.75, 0.2, 0.1, 0.85};
    geometry_polygon polygon = {points, 3, GEOMETRY_DISK, true};
    bat_random random = bat_random_seed(3);
    weights by = random_weights(GEOMETRY_DISK, &random);
    by.insertion[0] = 0.7;
    by.insertion[1] = -0.7;
    by.insertion[2] = 0.02;
    check_polygon_gradient(&polygon, insert_value, insert_gradient, &by, 1e-4, 1e-9);
    double gradients[3] = {0};
    geometry_insert_back(&polygon, by.insertion, by.fine, NULL, gradients);
    assert_true(gradients[0] == 0 && gradients[1] == 0 && gradients[2] != 0);
}

/// Functions of a profile, weighted, by number.
typedef enum profile_function
{
    MEAN_LENGTH,
    PUBLISHED_FEATURES,
    STENCIL_FEATURES,
    TENSION_OUTWARD,
    TENSION_PRINTED,
    SMOOTHNESS,
    BENDING,
    VARIATION,
    POWER_MEAN,
    PROFILE_FUNCTIONS
} profile_function;

static double weighted_rows(const double *rows, size_t count, size_t width, size_t stride, const double *by)
{
    double sum = 0;
    for (size_t j = 0; j < count; j++)
        for (size_t i = 0; i < width; i++)
            sum += by[j * stride + i] * rows[j * stride + i];
    return sum;
}

enum
{
    STRIDE = 16,
    ROWS = 12,
};

static double value_of(profile_function function, const geometry_polygon *polygon, geometry_profile profile,
                       const double *by)
{
    double rows[ROWS * STRIDE];
    size_t edges = geometry_edges(polygon);
    switch (function)
    {
    case MEAN_LENGTH:
        return geometry_mean_length(polygon, profile);
    case PUBLISHED_FEATURES:
        geometry_published_features(polygon, profile, rows, STRIDE);
        return weighted_rows(rows, edges, GEOMETRY_PUBLISHED_FEATURES, STRIDE, by);
    case STENCIL_FEATURES:
        geometry_stencil_features(polygon, profile, STENCIL, rows, STRIDE);
        return weighted_rows(rows, edges, geometry_stencil_size(STENCIL), STRIDE, by);
    case TENSION_OUTWARD:
    case TENSION_PRINTED:
        geometry_tension_angles(polygon, profile, -0.25,
                                function == TENSION_OUTWARD ? BAT_CURVE_ANGLE_SIGN_OUTWARD : BAT_CURVE_ANGLE_SIGN_PRINTED,
                                rows);
        return weighted_rows(rows, edges, 1, 1, by);
    case SMOOTHNESS:
        return geometry_smoothness(polygon, profile);
    case BENDING:
        return geometry_bending(polygon, profile, 1e-3);
    case VARIATION:
        return geometry_angle_variation(polygon, profile);
    default:
        return geometry_angle_power_mean(polygon, profile, 7);
    }
}

static void gradient_of(profile_function function, const geometry_polygon *polygon, geometry_profile profile,
                        const double *by, geometry_profile gradient)
{
    switch (function)
    {
    case MEAN_LENGTH:
        geometry_mean_length_back(polygon, 1, gradient);
        return;
    case PUBLISHED_FEATURES:
        geometry_published_features_back(polygon, profile, by, STRIDE, gradient);
        return;
    case STENCIL_FEATURES:
        geometry_stencil_features_back(polygon, profile, STENCIL, by, STRIDE, gradient);
        return;
    case TENSION_OUTWARD:
    case TENSION_PRINTED:
        geometry_tension_angles_back(
            polygon, profile, -0.25,
            function == TENSION_OUTWARD ? BAT_CURVE_ANGLE_SIGN_OUTWARD : BAT_CURVE_ANGLE_SIGN_PRINTED, by, gradient);
        return;
    case SMOOTHNESS:
        geometry_smoothness_back(polygon, profile, 1, gradient);
        return;
    case BENDING:
        geometry_bending_back(polygon, profile, 1e-3, 1, gradient);
        return;
    case VARIATION:
        geometry_angle_variation_back(polygon, profile, 1, gradient);
        return;
    default:
        geometry_angle_power_mean_back(polygon, profile, 7, 1, gradient);
    }
}

/// Compare derivatives by every angle and length with finite differences.
static void check_profile_function(profile_function function, const geometry_polygon *polygon, geometry_profile profile,
                                   const double *by)
{
    double angles[MAX_COUNT] = {0}, lengths[MAX_COUNT] = {0};
    gradient_of(function, polygon, profile, by, (geometry_profile){angles, lengths});
    for (size_t j = 0; j < 2 * polygon->count; j++)
    {
        size_t index = j / 2;
        bool is_angle = j % 2 == 0;
        bool is_end = !polygon->closed && (index == 0 || index + 1 == polygon->count);
        if (is_angle ? is_end : !polygon->closed && index + 1 == polygon->count)
            continue;
        double *entry = is_angle ? &profile.angles[index] : &profile.lengths[index], kept = *entry, values[4],
               h = 1e-3 * fabs(kept);
        for (int k = 0; k < 4; k++)
        {
            *entry = kept + FIVE_POINT_STEPS[k] * h;
            values[k] = value_of(function, polygon, profile, by);
        }
        *entry = kept;
        double analytic = is_angle ? angles[index] : lengths[index];
        check_near(analytic, five_point(values, h), 1e-9 * fabs(analytic) + 1e-14 * (1 + fabs(values[0])) / h);
    }
}

/// With some angles so large that the insertion angle reaches its limit, and fewer vertices than the stencil sees.
static void profile_functions_are_differentiated(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    for (int open = 0; open < 2; open++)
        for (size_t count = 4; count <= ROWS; count++)
        {
            double angles[MAX_COUNT] = {0}, lengths[MAX_COUNT] = {0}, by[ROWS * STRIDE];
            geometry_polygon polygon = {NULL, count, GEOMETRY_SPHERE, !open};
            for (size_t j = 0; j < count; j++)
            {
                bool is_end = open && (j == 0 || j + 1 == count);
                angles[j] =
                    is_end ? 0 : (j % 2 ? 3 : 0.3) * (0.5 + 0.5 * bat_random_uniform(&random)) * (j % 3 == 0 ? -1 : 1);
                lengths[j] = open && j + 1 == count ? 0 : exp(2 * symmetric_uniform(&random));
            }
            for (size_t i = 0; i < ROWS * STRIDE; i++)
                by[i] = symmetric_uniform(&random);
            for (int function = 0; function < PROFILE_FUNCTIONS; function++)
                check_profile_function((profile_function)function, &polygon, (geometry_profile){angles, lengths}, by);
        }
}

static void tension_angles_are_limited(void **state)
{
    (void)state;
    double angles[] = {3, 3, 3, -3, -3, -3}, lengths[6], insertion[6], gradients[6] = {0};
    const double ones[] = {1, 1, 1, 1, 1, 1};
    geometry_polygon polygon = {NULL, 6, GEOMETRY_PLANE, true};
    geometry_profile profile = {angles, lengths};
    geometry_tension_angles(&polygon, profile, -2, BAT_CURVE_ANGLE_SIGN_OUTWARD, insertion);
    assert_true(insertion[0] == -BAT_CURVE_ANGLE_LIMIT && insertion[3] == BAT_CURVE_ANGLE_LIMIT);
    geometry_tension_angles_back(&polygon, profile, -2, BAT_CURVE_ANGLE_SIGN_OUTWARD, ones,
                                 (geometry_profile){gradients, lengths});
    // Only edges 2 and 5, whose angles cancel, are not limited; vertex 1 is an outer one of both.
    check_near(gradients[2], -0.375, 1e-15);
    check_near(gradients[1], 0.5, 1e-15);
}

/// Gradients of what isometries leave alone are orthogonal to the fields that generate isometries.
static void check_killing(const geometry_polygon *polygon, const weights *by)
{
    double g[MAX_COORDINATES] = {0}, along[3] = {0}, size = 0;
    size_t dim = geometry_dim(polygon->surface);
    profile_gradient(polygon, by, g);
    for (size_t j = 0; j < polygon->count; j++)
    {
        const double *p = polygon->points + j * dim, *h = g + j * dim;
        if (polygon->surface == GEOMETRY_SPHERE)
        {
            for (int i = 0; i < 3; i++)
                along[i] += p[(i + 1) % 3] * h[(i + 2) % 3] - p[(i + 2) % 3] * h[(i + 1) % 3];
            double length = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
            check_near(p[0] * h[0] + p[1] * h[1] + p[2] * h[2], 0, 1e-14 * length);
            size += length;
            continue;
        }
        // The fields i z, and 1 - c z^2, i (1 + c z^2) with c = 1 in the disk and 0 in the plane.
        double c = polygon->surface == GEOMETRY_DISK ? 1 : 0, re = p[0] * p[0] - p[1] * p[1], im = 2 * p[0] * p[1];
        along[0] += p[0] * h[1] - p[1] * h[0];
        along[1] += (1 - c * re) * h[0] - c * im * h[1];
        along[2] += -c * im * h[0] + (1 + c * re) * h[1];
        size += (1 + hypot(p[0], p[1])) * hypot(h[0], h[1]);
    }
    for (int i = 0; i < 3; i++)
        check_near(along[i], 0, 1e-13 * size);
}

static void gradients_are_orthogonal_to_isometries(void **state)
{
    (void)state;
    for_all(check_killing);
}

static void check_moved(const geometry_polygon *polygon, const weights *by)
{
    (void)by;
    bat_random random = bat_random_seed(17);
    double moved[MAX_COORDINATES], angles[2][MAX_COUNT], lengths[2][MAX_COUNT];
    geometry_isometry isometry = geometry_isometry_random(polygon->surface, 1.5, &random);
    geometry_isometry_apply(&isometry, polygon->points, polygon->count, moved);
    geometry_polygon other = *polygon;
    other.points = moved;
    geometry_measure(polygon, (geometry_profile){angles[0], lengths[0]});
    geometry_measure(&other, (geometry_profile){angles[1], lengths[1]});
    for (size_t j = 0; j < polygon->count; j++)
    {
        check_near(lengths[1][j], lengths[0][j], 1e-13 * (1 + 100 * lengths[0][j]));
        check_near(angles[1][j], angles[0][j], 1e-13 + 1e-14 / (0.01 * safe_step(polygon, j)));
    }
}

static void isometries_keep_profiles(void **state)
{
    (void)state;
    for_all(check_moved);
}

/// Scaling in the plane changes no feature, so its gradients are orthogonal to the field z.
static void features_ignore_scale(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(23);
    for (int function = PUBLISHED_FEATURES; function <= STENCIL_FEATURES; function++)
    {
        double points[MAX_COORDINATES], angles[ROWS], lengths[ROWS], by[ROWS * STRIDE];
        double angle_gradients[ROWS] = {0}, length_gradients[ROWS] = {0}, g[2 * ROWS] = {0}, along = 0, size = 0;
        geometry_polygon polygon = make_polygon(GEOMETRY_PLANE, UNEVEN, ROWS, &random, points);
        geometry_profile profile = {angles, lengths}, gradient = {angle_gradients, length_gradients};
        for (size_t i = 0; i < ROWS * STRIDE; i++)
            by[i] = symmetric_uniform(&random);
        geometry_measure(&polygon, profile);
        gradient_of((profile_function)function, &polygon, profile, by, gradient);
        geometry_measure_back(&polygon, gradient, g);
        for (size_t i = 0; i < 2 * ROWS; i++)
        {
            along += points[i] * g[i];
            size += fabs(points[i] * g[i]);
        }
        check_near(along, 0, 1e-14 * size);
    }
}

/// Reversed, edge j is edge n - 2 - j (cyclically): its angles in reverse order with other signs, its lengths in reverse
/// order.
static void stencils_are_symmetric(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(29);
    for (size_t s = 0; s < 3; s++)
        for (int open = 0; open < 2; open++)
        {
            double points[MAX_COORDINATES], reversed[MAX_COORDINATES], angles[ROWS], lengths[ROWS];
            double forth[ROWS * STRIDE], back[ROWS * STRIDE];
            geometry_polygon polygon = make_polygon(SURFACES[s], UNEVEN, ROWS, &random, points), other = polygon;
            size_t dim = geometry_dim(SURFACES[s]), angle_count = 2 * STENCIL.angle_reach,
                   length_count = 2 * STENCIL.length_reach + 1;
            for (size_t j = 0; j < ROWS; j++)
                memcpy(reversed + j * dim, points + (ROWS - 1 - j) * dim, dim * sizeof(double));
            polygon.closed = other.closed = !open;
            other.points = reversed;
            geometry_measure(&polygon, (geometry_profile){angles, lengths});
            geometry_stencil_features(&polygon, (geometry_profile){angles, lengths}, STENCIL, forth, STRIDE);
            geometry_measure(&other, (geometry_profile){angles, lengths});
            geometry_stencil_features(&other, (geometry_profile){angles, lengths}, STENCIL, back, STRIDE);
            for (size_t j = 0; j < geometry_edges(&polygon); j++)
            {
                const double *f = forth + j * STRIDE, *b = back + (2 * ROWS - 2 - j) % ROWS * STRIDE;
                for (size_t i = 0; i < angle_count; i++)
                    check_near(f[i], -b[angle_count - 1 - i], 1e-13);
                for (size_t i = 0; i < length_count; i++)
                    check_near(f[angle_count + i], b[angle_count + length_count - 1 - i], 1e-13);
            }
        }
}

/// What is differentiated is what the library's spaces compute.
static void check_spaces(const geometry_polygon *polygon, const weights *by)
{
    bat_space space = space_of(polygon->surface);
    size_t dim = space.point_dim, count = polygon->count, edges = geometry_edges(polygon);
    double angles[MAX_COUNT], lengths[MAX_COUNT], fine[2 * MAX_COORDINATES], apex[3];
    geometry_measure(polygon, (geometry_profile){angles, lengths});
    geometry_insert(polygon, by->insertion, fine);
    for (size_t j = 0; j < count; j++)
    {
        const double *before = polygon->points + (j + count - 1) % count * dim, *p = polygon->points + j * dim;
        const double *after = polygon->points + (j + 1) % count * dim;
        bool is_end = !polygon->closed && (j == 0 || j + 1 == count);
        check_near(angles[j], is_end ? 0 : space.exterior_angle(&space, before, p, after), 1e-15);
        check_relative(lengths[j], j < edges ? space.distance(&space, p, after) : 0, 1e-15);
        assert_memory_equal(fine + 2 * j * dim, p, dim * sizeof(double));
        if (j < edges && space.apex(&space, p, after, by->insertion[j], apex) == BAT_OK)
        {
            // Beyond 0.9 of the slope where sides are parallel ours is limited, which other tests are about.
            double slope = fabs(tan(by->insertion[j])) * sinh(0.5 * lengths[j]);
            for (size_t i = 0; i < dim && (polygon->surface != GEOMETRY_DISK || slope < 0.9); i++)
                check_near(fine[(2 * j + 1) * dim + i], apex[i], 1e-15 * (1 + fabs(apex[i])));
        }
    }
}

static void values_are_those_of_the_spaces(void **state)
{
    (void)state;
    for_all(check_spaces);
}

static void check_measures(const geometry_polygon *polygon, const weights *by)
{
    bat_space space = space_of(polygon->surface);
    double angles[MAX_COUNT], lengths[MAX_COUNT], g1 = 0;
    geometry_profile profile = {angles, lengths};
    geometry_measure(polygon, profile);
    bat_curve curve = {
        .space = &space, .points = (double *)(uintptr_t)polygon->points, .count = polygon->count, .closed = polygon->closed};
    bat_curve truth = {.space = &space, .points = (double *)(uintptr_t)by->truth, .count = TRUTH, .closed = true};
    bat_curve_fairness_values fairness;
    bat_curve_distance distance;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, NULL), BAT_OK);
    check_status(bat_curve_compare(&curve, &truth, NULL, &distance, NULL), BAT_OK);
    check_relative(geometry_bending(polygon, profile, BAT_CURVE_BENDING_OFFSET), fairness.bending, 1e-13);
    size_t of_points[MAX_COUNT], of_truth[TRUTH];
    check_relative(geometry_chamfer(polygon->points, polygon->count, by->truth, TRUTH, space.point_dim,
                                    (geometry_matches){of_points, of_truth}),
                   distance.mean_symmetric, 1e-13);
    check_relative(geometry_mean_nearest(polygon->points, polygon->count, by->truth, TRUTH, space.point_dim, of_points),
                   distance.mean_nn, 1e-13);
    for (size_t j = 0; j < polygon->count; j++)
        g1 = fmax(g1, fabs(angles[j]));
    double mean = geometry_angle_power_mean(polygon, profile, 200);
    assert_true(mean <= g1 && mean >= g1 * pow((double)geometry_corners(polygon), -1.0 / 200) * (1 - 1e-13));
    check_relative(geometry_smoothness(polygon, profile), pow(geometry_angle_power_mean(polygon, profile, 2), 2), 1e-13);
}

static void losses_are_the_librarys_measures(void **state)
{
    (void)state;
    for_all(check_measures);
}

static void first_of_equally_near_items_is_taken(void **state)
{
    (void)state;
    // Squares of these coordinates are exact, so that ties are.
    for (size_t dim = 2; dim <= 3; dim++)
    {
        double items[21] = {0};
        const double places[7] = {3, 1, -1, 1, -1, 1, 3};
        for (size_t i = 0; i < 7; i++)
            items[i * dim] = places[i];
        const double queries[] = {0, 0, 0, 0, 0, 0};
        size_t nearest[2];
        geometry_nearest(queries, 2, items, 7, dim, nearest);
        assert_int_equal(nearest[0], 1);
        assert_int_equal(nearest[1], 1);
        geometry_nearest(queries, 1, items + 2 * dim, 4, dim, nearest);
        assert_int_equal(nearest[0], 0);
    }
}

static void random_rotations_are_rotations(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(31);
    double mean[9] = {0};
    for (int trial = 0; trial < 4000; trial++)
    {
        geometry_isometry isometry = geometry_isometry_random(GEOMETRY_SPHERE, 0, &random);
        const double *r = isometry.rotation;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                check_near(r[3 * i] * r[3 * k] + r[3 * i + 1] * r[3 * k + 1] + r[3 * i + 2] * r[3 * k + 2], i == k, 1e-14);
        check_near(r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                       r[2] * (r[3] * r[7] - r[4] * r[6]),
                   1, 1e-14);
        for (int i = 0; i < 9; i++)
            mean[i] += r[i] / 4000;
    }
    // Entries of a uniform rotation have mean 0 and variance 1/3: five deviations.
    for (int i = 0; i < 9; i++)
        check_near(mean[i], 0, 5 / sqrt(3 * 4000.0));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(measure_is_differentiated),
        cmocka_unit_test(insertion_is_differentiated),
        cmocka_unit_test(limited_insertion_is_differentiated),
        cmocka_unit_test(chamfer_is_differentiated),
        cmocka_unit_test(mean_nearest_is_differentiated),
        cmocka_unit_test(profile_functions_are_differentiated),
        cmocka_unit_test(tension_angles_are_limited),
        cmocka_unit_test(gradients_are_orthogonal_to_isometries),
        cmocka_unit_test(isometries_keep_profiles),
        cmocka_unit_test(features_ignore_scale),
        cmocka_unit_test(stencils_are_symmetric),
        cmocka_unit_test(values_are_those_of_the_spaces),
        cmocka_unit_test(losses_are_the_librarys_measures),
        cmocka_unit_test(first_of_equally_near_items_is_taken),
        cmocka_unit_test(random_rotations_are_rotations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
