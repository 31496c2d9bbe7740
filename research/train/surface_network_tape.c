#include "research/train/surface_network_tape.h"

#include "research/train/tape_graph.h"

/// Weights and biases evenly between plus and minus 1 / sqrt(inputs), gains 1, shifts 0, as PyTorch does.
static void start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t p = 0; p < parameters->count; p += 2)
    {
        const learn_parameter *weight = &parameters->list[p];
        if (weight->rank == 1)
        {
            learn_parameter_fill(parameters, p, 1);
            continue;
        }
        double bound = 1 / sqrt((double)weight->columns);
        real *values = learn_parameter_values(parameters, p);
        // The bias lies behind the weight.
        for (size_t i = 0; i < weight->rows * weight->columns + weight->rows; i++)
            values[i] = (real)(bound * (2 * bat_random_uniform(&random) - 1));
    }
}

// The network on a tape

static learn_array *rows_of(learn_tape *tape, const double *numbers, size_t rows, size_t columns)
{
    learn_array *array = learn_array_make(tape, rows, columns, false);
    for (size_t i = 0; i < learn_size(array); i++)
        array->value[i] = (real)numbers[i];
    return array;
}

/// A layer of the rows that have neighbours; 0, without the bias, where there are none.
static learn_array *layer_where_reached(learn_tape *tape, learn_array *x, learn_array *weight, learn_array *bias,
                                        const tape_graph *graph)
{
    uint32_t *reached = learn_tape_memory(tape, graph->targets, sizeof *reached);
    size_t count = 0;
    for (size_t i = 0; reached != NULL && i < graph->targets; i++)
        if (graph->degrees[i] > 0)
            reached[count++] = (uint32_t)i;
    learn_array *y = learn_linear(tape, learn_gather_rows(tape, x, reached, count), weight, bias);
    return learn_scatter_mean(tape, y, reached, graph->targets);
}

/// The mean over edges of h or g.
/// @param x          targets x 3
/// @param y          sources x 3
/// @param conditions sources x 2; null for none
static learn_array *say(learn_tape *tape, size_t first, learn_array *x, learn_array *y, learn_array *conditions,
                        const tape_graph *graph)
{
    learn_array *p[SURFACE_MESSAGE_ARRAYS];
    for (size_t i = 0; i < SURFACE_MESSAGE_ARRAYS; i++)
        p[i] = learn_parameter_array(tape, first + i);
    learn_array *of_target = learn_slice_columns(tape, p[0], 0, 3), *of_source = learn_slice_columns(tape, p[0], 3, 3);
    learn_array *at_target = learn_linear(tape, x, learn_subtract(tape, of_target, of_source), p[1]);
    learn_array *at_source = learn_linear(tape, y, of_source, NULL);
    if (conditions != NULL)
        at_source = learn_add(tape, at_source, learn_linear(tape, conditions, learn_slice_columns(tape, p[0], 6, 2), NULL));
    learn_array *said = tape_graph_messages(tape, at_target, at_source, p[2], p[3], graph);
    return layer_where_reached(tape, said, p[4], p[5], graph);
}

static learn_array *hidden_layer(learn_tape *tape, size_t first, learn_array *x, bool last, size_t *edges)
{
    tape_graph graph = tape_graph_make(tape, x, x, SURFACE_RADIUS);
    *edges = graph.edges;
    learn_array *weight = learn_parameter_array(tape, first), *bias = learn_parameter_array(tape, first + 1);
    learn_array *both[2] = {x, learn_subtract(tape, tape_graph_mean(tape, x, &graph), x)};
    learn_array *joined = learn_concatenate_columns(tape, both, 2);
    return last ? learn_linear(tape, joined, weight, bias) : learn_linear_relu(tape, joined, weight, bias);
}

static learn_array *output_network(learn_tape *tape, size_t first, learn_array *x)
{
    learn_array *p[SURFACE_OUTPUT_ARRAYS];
    for (size_t i = 0; i < SURFACE_OUTPUT_ARRAYS; i++)
        p[i] = learn_parameter_array(tape, first + i);
    x = learn_relu(tape, learn_batch_norm(tape, learn_linear(tape, x, p[0], p[1]), p[2], p[3]));
    x = learn_relu(tape, learn_batch_norm(tape, learn_linear(tape, x, p[4], p[5]), p[6], p[7]));
    return learn_sigmoid(tape, learn_linear(tape, x, p[8], p[9]));
}

static learn_array *input_layer(learn_tape *tape, const bat_cloud *cloud, const double *boundary, surface_edges *edges)
{
    bool informed = surface_network_count_is_informed(tape->parameter_count);
    size_t bound = cloud->boundary_count, begin = informed ? bound : 0;
    learn_array *x = rows_of(tape, cloud->points + 3 * begin, cloud->count - begin, 3);
    tape_graph graph = tape_graph_make(tape, x, x, SURFACE_RADIUS);
    edges->count[0] = graph.edges;
    learn_array *said =
        say(tape, surface_network_part_begin(tape->parameter_count, SURFACE_PART_INTERIOR), x, x, NULL, &graph);
    if (informed && bound > 0)
    {
        learn_array *y = rows_of(tape, cloud->points, bound, 3), *conditions = rows_of(tape, boundary, bound, 2);
        graph = tape_graph_make(tape, x, y, SURFACE_RADIUS);
        edges->count[1] = graph.edges;
        size_t first = surface_network_part_begin(tape->parameter_count, SURFACE_PART_BOUNDARY);
        said = learn_add(tape, said, say(tape, first, x, y, conditions, &graph));
    }
    return learn_relu(tape, said);
}

learn_array *surface_network_predict(learn_tape *tape, const bat_cloud *cloud, const double *boundary, surface_edges *edges)
{
    surface_edges unwanted;
    edges = edges != NULL ? edges : &unwanted;
    *edges = (surface_edges){0};
    size_t count = tape->parameter_count, hidden = surface_network_part_begin(count, SURFACE_PART_HIDDEN);
    learn_array *features[1 + SURFACE_HIDDEN] = {input_layer(tape, cloud, boundary, edges)};
    for (size_t layer = 0; layer < SURFACE_HIDDEN; layer++)
        features[layer + 1] =
            hidden_layer(tape, hidden + 2 * layer, features[layer], layer + 1 == SURFACE_HIDDEN, &edges->count[2 + layer]);
    learn_array *joined = learn_concatenate_columns(tape, features, 1 + SURFACE_HIDDEN);
    learn_array *said = output_network(tape, surface_network_part_begin(count, SURFACE_PART_OUTPUT), joined);
    size_t interior = cloud->count - cloud->boundary_count;
    return said->rows == interior ? said : learn_slice_rows(tape, said, cloud->boundary_count, interior);
}

static learn_array *predict(learn_tape *tape, const bat_cloud *cloud, const double *boundary)
{
    return surface_network_predict(tape, cloud, boundary, NULL);
}

const surface_network_training surface_training_published = {
    .kind = &surface_network_published,
    .start = start,
    .predict = predict,
};

const surface_network_training surface_training_uninformed = {
    .kind = &surface_network_uninformed,
    .start = start,
    .predict = predict,
};
