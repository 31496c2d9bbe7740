#include "research/train/surface_sample.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/research/surface_shapes.h"
#include "mesh/measure/unit_box.h"
#include "research/train/bezier_fit.h"
#include "search/nearest.h"

#include <assert.h>
#include <stdlib.h>

// Drawing

/// A whole number from `min` to `max`, with probability proportional to 1 / n.
static size_t draw_count(size_t min, size_t max, bat_random *random)
{
    double low = log((double)min), high = log((double)max + 1);
    size_t count = (size_t)exp(low + (high - low) * bat_random_uniform(random));
    return count < min ? min : count > max ? max : count;
}

/// Rows in the order of `places`.
static bool reorder(double *rows, size_t columns, const size_t *places, size_t count)
{
    double *copy = memory_array(count, columns * sizeof *copy);
    if (copy == NULL)
        return false;
    memcpy(copy, rows, count * columns * sizeof *copy);
    for (size_t i = 0; i < count; i++)
        memcpy(rows + i * columns, copy + places[i] * columns, columns * sizeof *copy);
    free(copy);
    return true;
}

/// Order the interior points so that near ones follow each other, which makes the search for graphs faster.
static bat_status put_in_order(surface_sample *sample, bat_error *error)
{
    size_t bound = sample->cloud.boundary_count, interior = sample->cloud.count - bound;
    nearest_tree tree;
    bat_status status = neighbours_build(sample->cloud.points + 3 * bound, interior, &tree, error);
    if (status != BAT_OK)
        return status;
    if (!reorder(sample->cloud.points + 3 * bound, 3, tree.items, interior) ||
        !reorder(sample->parameters + 2 * bound, 2, tree.items, interior))
        status = error_memory(error, interior * 3 * sizeof(double));
    nearest_free(&tree);
    return status;
}

bat_status surface_sample_draw(const surface_sample_range *range, bat_random *random, surface_sample *sample,
                               bat_error *error)
{
    bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
    options.interior = draw_count(range->min_points, range->max_points, random);
    options.degree =
        range->min_degree + (int)(bat_random_uniform(random) * (double)(range->max_degree - range->min_degree + 1));
    double share = (bat_random_uniform(random) - range->clean) / (1 - range->clean);
    options.noise = share > 0 ? range->noise * share : 0;
    surface_sample drawn = {.degree = options.degree};
    bat_status status = bat_cloud_bezier(&options, random, &drawn.cloud, &drawn.parameters, error);
    if (status != BAT_OK)
        return status;
    unit_box box = unit_box_of(drawn.cloud.points, drawn.cloud.count);
    for (size_t i = 0; i < 3 * drawn.cloud.count; i++)
        drawn.cloud.points[i] = unit_box_in(&box, i, drawn.cloud.points[i]);
    status = put_in_order(&drawn, error);
    if (status == BAT_OK)
        *sample = drawn;
    else
        surface_sample_free(&drawn);
    return status;
}

void surface_sample_free(surface_sample *sample)
{
    bat_cloud_free(&sample->cloud);
    free(sample->parameters);
    *sample = (surface_sample){0};
}

// The loss

typedef struct residual
{
    const surface_sample *sample;
    learn_array *interior, *loss;
    double *parameters, *gradient; ///< count x 2
    bezier_fit fit;
} residual;

static void residual_backward(void *context)
{
    const residual *r = context;
    const bat_cloud *cloud = &r->sample->cloud;
    real *dinterior = learn_gradient(r->interior);
    double slope = (double)*r->loss->gradient;
    bezier_fit_gradient(&r->fit, r->parameters, cloud->count, r->gradient);
    for (size_t i = 0; i < learn_size(r->interior); i++)
        dinterior[i] += (real)(slope * r->gradient[2 * cloud->boundary_count + i]);
}

learn_array *surface_sample_residual(learn_tape *tape, const surface_sample *sample, learn_array *interior)
{
    const bat_cloud *cloud = &sample->cloud;
    learn_array *loss = learn_array_make(tape, 1, 1, learn_wants(interior));
    residual *r = learn_tape_memory(tape, 1, sizeof *r);
    double *left = learn_tape_memory(tape, cloud->count, 3 * sizeof *left);
    double *parameters = learn_tape_memory(tape, cloud->count, 2 * sizeof *parameters);
    double *gradient = learn_tape_memory(tape, cloud->count, 2 * sizeof *gradient);
    if (tape->status != BAT_OK)
        return &tape->nothing;
    assert(interior->rows == cloud->count - cloud->boundary_count && interior->columns == 2);
    memcpy(parameters, sample->parameters, 2 * cloud->boundary_count * sizeof *parameters);
    for (size_t i = 0; i < learn_size(interior); i++)
        parameters[2 * cloud->boundary_count + i] = (double)interior->value[i];
    *r = (residual){.sample = sample, .interior = interior, .loss = loss, .parameters = parameters, .gradient = gradient};
    r->fit.patch.degree = sample->degree;
    r->fit.residual = left;
    bat_status status = bezier_fit_make(cloud->points, parameters, cloud->count, &r->fit, NULL);
    if (status == BAT_NO_MEMORY || status == BAT_TOO_LARGE)
    {
        tape->status = status;
        return &tape->nothing;
    }
    // Parameters that are not finite give a loss of NaN, which ends the training with an error.
    *loss->value = status == BAT_OK ? (real)r->fit.error : (real)NAN;
    if (learn_wants(loss) && status == BAT_OK)
        learn_tape_record(tape, loss, residual_backward, r);
    return loss;
}

bat_status surface_sample_floor(const surface_sample *sample, double *error_left, bat_error *error)
{
    bezier_fit fit = {.patch.degree = sample->degree};
    fit.residual = memory_array(sample->cloud.count, 3 * sizeof *fit.residual);
    if (fit.residual == NULL)
        return error_memory(error, sample->cloud.count * 3 * sizeof *fit.residual);
    bat_status status = bezier_fit_make(sample->cloud.points, sample->parameters, sample->cloud.count, &fit, error);
    *error_left = fit.error;
    free(fit.residual);
    return status;
}
