#include "research/data/arc_samples.h"

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
