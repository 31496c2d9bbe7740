/// @file
/// Choice of control points by chord length; see control_polygon.h.

#include "research/data/control_polygon.h"

#include "research/data/tension_set.h"

#include <math.h>

static double chord(const double *p, const double *q, size_t dim)
{
    double sum = 0;
    for (size_t i = 0; i < dim; i++)
    {
        double difference = q[i] - p[i];
        sum += difference * difference;
    }
    return sqrt(sum);
}

void arc_samples(const double *points, size_t count, size_t dim, bool closed, double *lengths, size_t sample_count,
                 size_t *samples)
{
    lengths[0] = 0;
    for (size_t i = 0; i < count; i++)
        lengths[i + 1] = lengths[i] + chord(points + i * dim, points + (i + 1) % count * dim, dim);
    double total = lengths[closed ? count : count - 1];
    size_t vertex = 0;
    for (size_t k = 0; k < sample_count; k++)
    {
        double reached = total * ((double)k / (double)sample_count - ARC_SAMPLES_TOLERANCE);
        while (vertex + 1 < count && lengths[vertex] < reached)
            vertex++;
        samples[k] = vertex;
    }
}

/// Minimum distance of neighbours, as a fraction of the even spacing.
static const double MIN_EDGE = 1e-6;
/// Minimum inner product of neighbours on the sphere: an angle of 171 degrees.
static const double MIN_COSINE = -0.988;

static bool edge_is_fit(bat_tension_space space, const double *p, const double *q, double minimum)
{
    size_t dim = tension_dim(space);
    double squared = 0, inner = 0;
    for (size_t i = 0; i < dim; i++)
    {
        squared += (q[i] - p[i]) * (q[i] - p[i]);
        inner += p[i] * q[i];
    }
    return squared > minimum * minimum && (space != BAT_TENSION_SPACE_SPHERE || inner > MIN_COSINE);
}

/// Binary search for the first point with at least the length `reached`; `count` if there is none.
static size_t vertex_at(const double *lengths, size_t count, double reached)
{
    size_t low = 0, high = count;
    while (low < high)
    {
        size_t middle = low + (high - low) / 2;
        if (lengths[middle] < reached)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

bool tension_control_sample(bat_tension_space space, const double *points, size_t count, const tension_control_plan *plan,
                            bat_random *random, double *lengths, size_t *samples)
{
    size_t dim = tension_dim(space), first;
    arc_samples(points, count, dim, true, lengths, 1, &first);
    double total = lengths[count], spacing = 1 / (double)plan->count;
    for (size_t k = 0; k < plan->count; k++)
    {
        double moved = plan->jitter > 0 ? plan->jitter * (bat_random_uniform(random) - 0.5) : 0;
        double share = plan->start + ((double)k + moved) * spacing;
        share -= floor(share);
        samples[k] = vertex_at(lengths, count, total * (share - ARC_SAMPLES_TOLERANCE)) % count;
    }
    for (size_t k = 0; k < plan->count; k++)
        if (!edge_is_fit(space, points + samples[k] * dim, points + samples[(k + 1) % plan->count] * dim,
                         MIN_EDGE * total * spacing))
            return false;
    return true;
}
