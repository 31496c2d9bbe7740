#include "research/train/geometry_loss.h"

#include "base/lanes.h"

#include <math.h>
#include <string.h>

// Fairness

/// The first vertex with an angle.
static size_t first_corner(const geometry_polygon *polygon)
{
    return polygon->closed ? 0 : 1;
}

double geometry_smoothness(const geometry_polygon *polygon, geometry_profile profile)
{
    // The ends of an open polygon have angle 0.
    double sum = 0;
    for (size_t j = 0; j < polygon->count; j++)
        sum += profile.angles[j] * profile.angles[j];
    return sum / (double)geometry_corners(polygon);
}

void geometry_smoothness_back(const geometry_polygon *polygon, geometry_profile profile, double loss_gradient,
                              geometry_profile gradient)
{
    double factor = 2 * loss_gradient / (double)geometry_corners(polygon);
    for (size_t j = 0; j < polygon->count; j++)
        gradient.angles[j] += factor * profile.angles[j];
}

double geometry_bending(const geometry_polygon *polygon, geometry_profile profile, double offset)
{
    size_t corners = geometry_corners(polygon), first = first_corner(polygon);
    double sum = 0;
    for (size_t i = 0; i < corners; i++)
    {
        size_t j = first + i, before = j == 0 ? polygon->count - 1 : j - 1;
        double curvature = profile.angles[j] / (0.5 * (profile.lengths[before] + profile.lengths[j]) + offset);
        sum += curvature * curvature;
    }
    return sum / (double)corners;
}

void geometry_bending_back(const geometry_polygon *polygon, geometry_profile profile, double offset, double loss_gradient,
                           geometry_profile gradient)
{
    size_t corners = geometry_corners(polygon), first = first_corner(polygon);
    double factor = 2 * loss_gradient / (double)corners;
    for (size_t i = 0; i < corners; i++)
    {
        size_t j = first + i, before = j == 0 ? polygon->count - 1 : j - 1;
        double inverse = 1 / (0.5 * (profile.lengths[before] + profile.lengths[j]) + offset);
        double by_angle = factor * profile.angles[j] * inverse * inverse;
        double by_length = -0.5 * by_angle * profile.angles[j] * inverse;
        gradient.angles[j] += by_angle;
        gradient.lengths[before] += by_length;
        gradient.lengths[j] += by_length;
    }
}

/// Pairs of neighbouring vertices that both have an angle; pair i is that of vertex first_corner() + i and the next.
static size_t neighbour_pairs(const geometry_polygon *polygon)
{
    size_t corners = geometry_corners(polygon);
    return polygon->closed ? corners : corners - 1;
}

double geometry_angle_variation(const geometry_polygon *polygon, geometry_profile profile)
{
    size_t pairs = neighbour_pairs(polygon), first = first_corner(polygon);
    double sum = 0;
    for (size_t i = 0; i < pairs; i++)
    {
        size_t j = first + i, next = j + 1 == polygon->count ? 0 : j + 1;
        double difference = profile.angles[next] - profile.angles[j];
        sum += difference * difference;
    }
    return pairs > 0 ? sum / (double)pairs : 0;
}

void geometry_angle_variation_back(const geometry_polygon *polygon, geometry_profile profile, double loss_gradient,
                                   geometry_profile gradient)
{
    size_t pairs = neighbour_pairs(polygon), first = first_corner(polygon);
    double factor = 2 * loss_gradient / (double)pairs;
    for (size_t i = 0; i < pairs; i++)
    {
        size_t j = first + i, next = j + 1 == polygon->count ? 0 : j + 1;
        double difference = profile.angles[next] - profile.angles[j];
        gradient.angles[next] += factor * difference;
        gradient.angles[j] -= factor * difference;
    }
}

double geometry_angle_power_mean(const geometry_polygon *polygon, geometry_profile profile, double power)
{
    double largest = 0, sum = 0;
    for (size_t j = 0; j < polygon->count; j++)
        largest = fmax(largest, fabs(profile.angles[j]));
    if (largest == 0)
        return 0;
    // Relative to the largest, no power overflows and not all underflow.
    for (size_t j = 0; j < polygon->count; j++)
        sum += pow(fabs(profile.angles[j]) / largest, power);
    return largest * pow(sum / (double)geometry_corners(polygon), 1 / power);
}

void geometry_angle_power_mean_back(const geometry_polygon *polygon, geometry_profile profile, double power,
                                    double loss_gradient, geometry_profile gradient)
{
    double mean = geometry_angle_power_mean(polygon, profile, power);
    if (mean == 0)
        return;
    double factor = loss_gradient / (double)geometry_corners(polygon);
    for (size_t j = 0; j < polygon->count; j++)
        gradient.angles[j] += copysign(factor * pow(fabs(profile.angles[j]) / mean, power - 1), profile.angles[j]);
}

// Distances

enum
{
    /// Queries that are processed together.
    QUERIES = 128,
};

/// Queries by axis, with the squared distances and numbers of the nearest items so far.
typedef struct nearest_block
{
    double x[QUERIES], y[QUERIES], z[QUERIES];
    double distance[QUERIES];
    size_t nearest[QUERIES];
} nearest_block;

/// Replace the nearest so far by an item that is nearer.
static inline void take_nearer(double distance, size_t item, double *min, size_t *nearest)
{
    bool nearer = distance < *min;
    *min = nearer ? distance : *min;
    *nearest = nearer ? item : *nearest;
}

static inline double square_2(double x, double y, const double *item)
{
    double dx = x - item[0], dy = y - item[1];
    return dx * dx + dy * dy;
}

static inline double square_3(double x, double y, double z, const double *item)
{
    double dx = x - item[0], dy = y - item[1], dz = z - item[2];
    return dx * dx + dy * dy + dz * dz;
}

/// Four items at a time, so that the state of the queries is loaded and stored a quarter as often.
LANES_CLONES
static void search_2(nearest_block *restrict block, size_t queries, const double *restrict items, size_t item_count)
{
    size_t item = 0;
    for (; item + 4 <= item_count; item += 4)
    {
        const double *row = items + 2 * item;
        for (size_t i = 0; i < queries; i++)
        {
            double x = block->x[i], y = block->y[i], min = block->distance[i];
            size_t nearest = block->nearest[i];
            take_nearer(square_2(x, y, row), item, &min, &nearest);
            take_nearer(square_2(x, y, row + 2), item + 1, &min, &nearest);
            take_nearer(square_2(x, y, row + 4), item + 2, &min, &nearest);
            take_nearer(square_2(x, y, row + 6), item + 3, &min, &nearest);
            block->distance[i] = min;
            block->nearest[i] = nearest;
        }
    }
    for (; item < item_count; item++)
        for (size_t i = 0; i < queries; i++)
            take_nearer(square_2(block->x[i], block->y[i], items + 2 * item), item, &block->distance[i], &block->nearest[i]);
}

LANES_CLONES
static void search_3(nearest_block *restrict block, size_t queries, const double *restrict items, size_t item_count)
{
    size_t item = 0;
    for (; item + 4 <= item_count; item += 4)
    {
        const double *row = items + 3 * item;
        for (size_t i = 0; i < queries; i++)
        {
            double x = block->x[i], y = block->y[i], z = block->z[i], min = block->distance[i];
            size_t nearest = block->nearest[i];
            take_nearer(square_3(x, y, z, row), item, &min, &nearest);
            take_nearer(square_3(x, y, z, row + 3), item + 1, &min, &nearest);
            take_nearer(square_3(x, y, z, row + 6), item + 2, &min, &nearest);
            take_nearer(square_3(x, y, z, row + 9), item + 3, &min, &nearest);
            block->distance[i] = min;
            block->nearest[i] = nearest;
        }
    }
    for (; item < item_count; item++)
        for (size_t i = 0; i < queries; i++)
            take_nearer(square_3(block->x[i], block->y[i], block->z[i], items + 3 * item), item, &block->distance[i],
                        &block->nearest[i]);
}

void geometry_nearest(const double *queries, size_t query_count, const double *items, size_t item_count, size_t dim,
                      size_t *nearest)
{
    nearest_block block;
    for (size_t done = 0; done < query_count; done += QUERIES)
    {
        size_t count = query_count - done < QUERIES ? query_count - done : QUERIES;
        for (size_t i = 0; i < count; i++)
        {
            const double *query = queries + (done + i) * dim;
            block.x[i] = query[0];
            block.y[i] = query[1];
            block.z[i] = dim == 3 ? query[2] : 0;
            block.distance[i] = INFINITY;
            block.nearest[i] = 0;
        }
        if (dim == 2)
            search_2(&block, count, items, item_count);
        else
            search_3(&block, count, items, item_count);
        memcpy(nearest + done, block.nearest, count * sizeof *nearest);
    }
}

static double distance_between(const double *p, const double *q, size_t dim)
{
    return sqrt(dim == 2 ? square_2(p[0], p[1], q) : square_3(p[0], p[1], p[2], q));
}

/// Mean distance of the points to their matches.
static double mean_distance(const double *points, size_t count, const double *others, size_t dim, const size_t *matches)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += distance_between(points + i * dim, others + matches[i] * dim, dim);
    return sum / (double)count;
}

double geometry_chamfer(const double *points, size_t count, const double *truth, size_t truth_count, size_t dim,
                        geometry_matches matches)
{
    geometry_nearest(points, count, truth, truth_count, dim, matches.of_points);
    geometry_nearest(truth, truth_count, points, count, dim, matches.of_truth);
    return 0.5 * (mean_distance(points, count, truth, dim, matches.of_points) +
                  mean_distance(truth, truth_count, points, dim, matches.of_truth));
}

/// Add `factor` times the derivative of |p - q| with respect to p.
static void add_distance_gradient(const double *p, const double *q, size_t dim, double factor, double *gradient)
{
    double distance = distance_between(p, q, dim), scale = distance > 0 ? factor / distance : 0;
    for (size_t i = 0; i < dim; i++)
        gradient[i] += scale * (p[i] - q[i]);
}

void geometry_chamfer_back(const double *points, size_t count, const double *truth, size_t truth_count, size_t dim,
                           geometry_matches matches, double loss_gradient, double *point_gradients)
{
    double factor = 0.5 * loss_gradient / (double)count, truth_factor = 0.5 * loss_gradient / (double)truth_count;
    for (size_t i = 0; i < count; i++)
        add_distance_gradient(points + i * dim, truth + matches.of_points[i] * dim, dim, factor, point_gradients + i * dim);
    for (size_t i = 0; i < truth_count; i++)
    {
        size_t point = matches.of_truth[i];
        add_distance_gradient(points + point * dim, truth + i * dim, dim, truth_factor, point_gradients + point * dim);
    }
}

double geometry_mean_nearest(const double *points, size_t count, const double *truth, size_t truth_count, size_t dim,
                             size_t *of_points)
{
    geometry_nearest(points, count, truth, truth_count, dim, of_points);
    return mean_distance(points, count, truth, dim, of_points);
}

void geometry_mean_nearest_back(const double *points, size_t count, const double *truth, size_t dim, const size_t *of_points,
                                double loss_gradient, double *point_gradients)
{
    double factor = loss_gradient / (double)count;
    for (size_t i = 0; i < count; i++)
        add_distance_gradient(points + i * dim, truth + of_points[i] * dim, dim, factor, point_gradients + i * dim);
}

// Polylines

/// Points of 2 or 3 coordinates, joined in order.
typedef struct polyline
{
    const double *points;
    size_t count, dim;
    bool closed;
} polyline;

static const double *row_of(const polyline *line, size_t i)
{
    return line->points + i % line->count * line->dim;
}

/// Half the lengths of the edges at each point, divided by the length of the polyline.
static void weigh_points(const polyline *line, double *weights)
{
    size_t edges = line->closed ? line->count : line->count - 1;
    double total = 0;
    for (size_t i = 0; i < line->count; i++)
        weights[i] = 0;
    for (size_t i = 0; i < edges; i++)
    {
        double length = distance_between(row_of(line, i), row_of(line, i + 1), line->dim);
        weights[i] += length;
        weights[(i + 1) % line->count] += length;
        total += 2 * length;
    }
    for (size_t i = 0; i < line->count; i++)
        weights[i] /= total;
}

/// The nearest point of an edge.
static geometry_foot foot_on(const polyline *line, size_t edge, const double *query)
{
    const double *p = row_of(line, edge), *q = row_of(line, edge + 1);
    double along = 0, squared = 0;
    for (size_t i = 0; i < line->dim; i++)
    {
        along += (query[i] - p[i]) * (q[i] - p[i]);
        squared += (q[i] - p[i]) * (q[i] - p[i]);
    }
    double share = squared > 0 ? along / squared : 0;
    return (geometry_foot){edge, share < 0 ? 0 : share > 1 ? 1 : share};
}

/// The vector from a foot to a query.
static double foot_vector(const polyline *line, geometry_foot foot, const double *query, double vector[3])
{
    const double *p = row_of(line, foot.edge), *q = row_of(line, foot.edge + 1);
    double squared = 0;
    for (size_t i = 0; i < line->dim; i++)
    {
        vector[i] = query[i] - (p[i] + foot.share * (q[i] - p[i]));
        squared += vector[i] * vector[i];
    }
    return sqrt(squared);
}

/// The weighted mean distance of points to a polyline.
static double mean_foot_distance(const double *queries, const double *weights, size_t count, const polyline *line,
                                 size_t *nearest, geometry_foot *feet)
{
    double sum = 0;
    geometry_nearest(queries, count, line->points, line->count, line->dim, nearest);
    for (size_t i = 0; i < count; i++)
    {
        const double *query = queries + i * line->dim;
        size_t at = nearest[i], before = at == 0 ? line->count - 1 : at - 1;
        bool has_before = line->closed || at > 0, has_after = line->closed || at + 1 < line->count;
        geometry_foot one = foot_on(line, has_before ? before : at, query),
                      other = foot_on(line, has_after ? at : before, query);
        double vector[3], first = foot_vector(line, one, query, vector), second = foot_vector(line, other, query, vector);
        feet[i] = first < second ? one : other;
        sum += weights[i] * fmin(first, second);
    }
    return sum;
}

double geometry_curve_distance(const geometry_polygon *polygon, const double *truth, size_t truth_count, geometry_feet feet)
{
    size_t dim = geometry_dim(polygon->surface);
    const polyline line = {polygon->points, polygon->count, dim, polygon->closed};
    const polyline true_line = {truth, truth_count, dim, polygon->closed};
    weigh_points(&line, feet.point_weights);
    weigh_points(&true_line, feet.truth_weights);
    return 0.5 * (mean_foot_distance(line.points, feet.point_weights, line.count, &true_line, feet.nearest, feet.of_points) +
                  mean_foot_distance(truth, feet.truth_weights, truth_count, &line, feet.nearest, feet.of_truth));
}

void geometry_curve_distance_back(const geometry_polygon *polygon, const double *truth, size_t truth_count,
                                  geometry_feet feet, double loss_gradient, double *point_gradients)
{
    size_t dim = geometry_dim(polygon->surface);
    const polyline line = {polygon->points, polygon->count, dim, polygon->closed};
    const polyline true_line = {truth, truth_count, dim, polygon->closed};
    double vector[3], next[3], mean = 0, total = 0;
    for (size_t i = 0; i < line.count; i++)
    {
        double distance = foot_vector(&true_line, feet.of_points[i], row_of(&line, i), vector);
        double factor = distance > 0 ? 0.5 * loss_gradient * feet.point_weights[i] / distance : 0;
        mean += feet.point_weights[i] * distance;
        for (size_t k = 0; k < dim; k++)
            point_gradients[i * dim + k] += factor * vector[k];
    }
    // The weights depend on the lengths.
    size_t edges = line.closed ? line.count : line.count - 1;
    for (size_t i = 0; i < edges; i++)
        total += distance_between(row_of(&line, i), row_of(&line, i + 1), dim);
    for (size_t i = 0; i < edges; i++)
    {
        const double *p = row_of(&line, i), *q = row_of(&line, i + 1);
        double here = foot_vector(&true_line, feet.of_points[i], p, vector);
        double there = foot_vector(&true_line, feet.of_points[(i + 1) % line.count], q, next);
        double by_length = 0.5 * loss_gradient * (0.5 * (here + there) - mean) / total;
        add_distance_gradient(p, q, dim, by_length, point_gradients + i * dim);
        add_distance_gradient(q, p, dim, by_length, point_gradients + (i + 1) % line.count * dim);
    }
    for (size_t i = 0; i < truth_count; i++)
    {
        geometry_foot foot = feet.of_truth[i];
        double distance = foot_vector(&line, foot, truth + i * dim, vector);
        double factor = distance > 0 ? -0.5 * loss_gradient * feet.truth_weights[i] / distance : 0;
        double *begin = point_gradients + foot.edge * dim, *end = point_gradients + (foot.edge + 1) % line.count * dim;
        for (size_t k = 0; k < dim; k++)
        {
            begin[k] += factor * (1 - foot.share) * vector[k];
            end[k] += factor * foot.share * vector[k];
        }
    }
}
