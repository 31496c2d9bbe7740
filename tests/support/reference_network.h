#ifndef TESTS_SUPPORT_REFERENCE_NETWORK_H
#define TESTS_SUPPORT_REFERENCE_NETWORK_H

// The tension predictor of Ugail and Howard (2026), section 5.3, forward and backward, as plainly as can be and in double.

#include "check.h"
#include "learn/safetensors.h"

enum
{
    REFERENCE_ROWS = 64,
    WIDTH = 128,
    BLOCKS = 4,
    INPUTS = 14,
    HEAD = 32,
};

/// An array of weights with its gradient.
typedef struct parameter
{
    double *value, *gradient;
    size_t count;
} parameter;

static inline parameter load_parameter(const safetensors *file, const char *name, size_t count)
{
    char full[128];
    snprintf(full, sizeof full, "weight.%s", name);
    parameter loaded = {malloc(count * sizeof(double)), calloc(count, sizeof(double)), count};
    check_status(safetensors_doubles(file, full, count, loaded.value, NULL), BAT_OK);
    return loaded;
}

static inline void free_parameter(parameter *p)
{
    free(p->value);
    free(p->gradient);
}

typedef struct dense
{
    parameter weight, bias; ///< weight is outputs x inputs
    size_t inputs, outputs;
} dense;

static inline dense load_dense(const safetensors *file, const char *name, size_t inputs, size_t outputs)
{
    char weight[80], bias[80];
    snprintf(weight, sizeof weight, "%s.weight", name);
    snprintf(bias, sizeof bias, "%s.bias", name);
    return (dense){load_parameter(file, weight, inputs * outputs), load_parameter(file, bias, outputs), inputs, outputs};
}

static inline void dense_forward(const dense *layer, size_t rows, const double *x, double *y)
{
    for (size_t r = 0; r < rows; r++)
        for (size_t o = 0; o < layer->outputs; o++)
        {
            double sum = layer->bias.value[o];
            for (size_t i = 0; i < layer->inputs; i++)
                sum += layer->weight.value[o * layer->inputs + i] * x[r * layer->inputs + i];
            y[r * layer->outputs + o] = sum;
        }
}

/// Adds to the parameters' gradients; sets g_x.
static inline void dense_backward(dense *layer, size_t rows, const double *x, const double *g_y, double *g_x)
{
    memset(g_x, 0, rows * layer->inputs * sizeof(double));
    for (size_t r = 0; r < rows; r++)
        for (size_t o = 0; o < layer->outputs; o++)
        {
            double g = g_y[r * layer->outputs + o];
            layer->bias.gradient[o] += g;
            for (size_t i = 0; i < layer->inputs; i++)
            {
                layer->weight.gradient[o * layer->inputs + i] += g * x[r * layer->inputs + i];
                g_x[r * layer->inputs + i] += g * layer->weight.value[o * layer->inputs + i];
            }
        }
}

/// Linear, then LayerNorm of WIDTH numbers.
typedef struct unit
{
    dense linear;
    parameter scale, shift;
} unit;

/// What a unit keeps of a pass.
typedef struct unit_pass
{
    double input[REFERENCE_ROWS * WIDTH];
    double normal[REFERENCE_ROWS * WIDTH]; ///< mean 0, variance 1
    double inverse[REFERENCE_ROWS];        ///< 1 / standard deviation before
    double output[REFERENCE_ROWS * WIDTH];
} unit_pass;

static inline unit load_unit(const safetensors *file, const char *prefix, int linear, int norm, size_t inputs)
{
    char name[64], weight[80], bias[80];
    snprintf(name, sizeof name, "%s.%d", prefix, linear);
    snprintf(weight, sizeof weight, "%s.%d.weight", prefix, norm);
    snprintf(bias, sizeof bias, "%s.%d.bias", prefix, norm);
    return (unit){load_dense(file, name, inputs, WIDTH), load_parameter(file, weight, WIDTH),
                  load_parameter(file, bias, WIDTH)};
}

static inline void unit_forward(const unit *u, size_t rows, const double *x, unit_pass *pass)
{
    memcpy(pass->input, x, rows * u->linear.inputs * sizeof(double));
    dense_forward(&u->linear, rows, x, pass->normal);
    for (size_t r = 0; r < rows; r++)
    {
        double *row = pass->normal + r * WIDTH, mean = 0, variance = 0;
        for (int i = 0; i < WIDTH; i++)
            mean += row[i] / WIDTH;
        for (int i = 0; i < WIDTH; i++)
            variance += (row[i] - mean) * (row[i] - mean) / WIDTH;
        pass->inverse[r] = 1 / sqrt(variance + 1e-5);
        for (int i = 0; i < WIDTH; i++)
        {
            row[i] = (row[i] - mean) * pass->inverse[r];
            pass->output[r * WIDTH + (size_t)i] = row[i] * u->scale.value[i] + u->shift.value[i];
        }
    }
}

static inline void unit_backward(unit *u, size_t rows, const unit_pass *pass, const double *g_y, double *g_x)
{
    static double g[REFERENCE_ROWS * WIDTH];
    for (size_t r = 0; r < rows; r++)
    {
        const double *normal = pass->normal + r * WIDTH, *above = g_y + r * WIDTH;
        double mean = 0, along = 0;
        for (int i = 0; i < WIDTH; i++)
        {
            u->scale.gradient[i] += above[i] * normal[i];
            u->shift.gradient[i] += above[i];
            mean += above[i] * u->scale.value[i] / WIDTH;
            along += above[i] * u->scale.value[i] * normal[i] / WIDTH;
        }
        for (int i = 0; i < WIDTH; i++)
            g[r * WIDTH + (size_t)i] = (above[i] * u->scale.value[i] - mean - along * normal[i]) * pass->inverse[r];
    }
    dense_backward(&u->linear, rows, pass->input, g, g_x);
}

static inline void gelu_forward(size_t count, const double *x, double *y)
{
    for (size_t i = 0; i < count; i++)
        y[i] = 0.5 * x[i] * (1 + erf(x[i] * 0.70710678118654752440));
}

/// Multiply g by the derivative at x.
static inline void gelu_backward(size_t count, const double *x, double *g)
{
    for (size_t i = 0; i < count; i++)
        g[i] *= 0.5 * (1 + erf(x[i] * 0.70710678118654752440)) + x[i] * 0.39894228040143267794 * exp(-0.5 * x[i] * x[i]);
}

typedef struct network
{
    parameter embedding; ///< 3 x 8
    unit project, first[BLOCKS], second[BLOCKS];
    dense head, last;
} network;

/// Everything kept of a pass over some rows.
typedef struct network_pass
{
    size_t rows;
    size_t place[REFERENCE_ROWS]; ///< rows of the embedding
    unit_pass project, first[BLOCKS], second[BLOCKS];
    double trunk[BLOCKS + 1][REFERENCE_ROWS * WIDTH];
    double sum[BLOCKS][REFERENCE_ROWS * WIDTH];
    double head[REFERENCE_ROWS * HEAD], head_gelu[REFERENCE_ROWS * HEAD];
    double share[REFERENCE_ROWS]; ///< the sigmoid
} network_pass;

static const double REFERENCE_LIMIT = 0.76539816339744830962; // pi / 4 - 0.02

static inline network load_network(const safetensors *file)
{
    network loaded = {.embedding = load_parameter(file, "geom_embed.weight", 24),
                      .project = load_unit(file, "input_proj", 0, 1, INPUTS),
                      .head = load_dense(file, "head.0", WIDTH, HEAD),
                      .last = load_dense(file, "head.2", HEAD, 1)};
    for (int b = 0; b < BLOCKS; b++)
    {
        char prefix[32];
        snprintf(prefix, sizeof prefix, "trunk.%d.net", b);
        loaded.first[b] = load_unit(file, prefix, 0, 1, WIDTH);
        loaded.second[b] = load_unit(file, prefix, 4, 5, WIDTH);
    }
    return loaded;
}

/// Call a function for every parameter, with its name in the file.
static inline void for_parameters(network *net, void (*visit)(parameter *p, const char *name, void *context), void *context)
{
    struct
    {
        parameter *p;
        char name[64];
    } all[7 + 8 * BLOCKS + 2] = {{&net->embedding, "geom_embed.weight"},
                                 {&net->project.linear.weight, "input_proj.0.weight"},
                                 {&net->project.linear.bias, "input_proj.0.bias"},
                                 {&net->project.scale, "input_proj.1.weight"},
                                 {&net->project.shift, "input_proj.1.bias"},
                                 {&net->head.weight, "head.0.weight"},
                                 {&net->head.bias, "head.0.bias"},
                                 {&net->last.weight, "head.2.weight"},
                                 {&net->last.bias, "head.2.bias"}};
    size_t count = 9;
    for (int b = 0; b < BLOCKS; b++)
        for (int half = 0; half < 2; half++)
        {
            unit *u = half == 0 ? &net->first[b] : &net->second[b];
            parameter *ps[] = {&u->linear.weight, &u->linear.bias, &u->scale, &u->shift};
            for (int i = 0; i < 4; i++, count++)
            {
                all[count].p = ps[i];
                snprintf(all[count].name, sizeof all[count].name, "trunk.%d.net.%d.%s", b, 4 * half + i / 2,
                         i % 2 ? "bias" : "weight");
            }
        }
    for (size_t i = 0; i < count; i++)
        visit(all[i].p, all[i].name, context);
}

static inline void free_one(parameter *p, const char *name, void *context)
{
    (void)name;
    (void)context;
    free_parameter(p);
}

static inline void free_network(network *net)
{
    for_parameters(net, free_one, NULL);
}

/// @param features rows x 7, eq. (17)
static inline void network_forward(const network *net, size_t rows, const double *features, network_pass *pass,
                                   double *angles)
{
    static double input[REFERENCE_ROWS * INPUTS], z[REFERENCE_ROWS * WIDTH];
    pass->rows = rows;
    for (size_t r = 0; r < rows; r++)
    {
        pass->place[r] = (size_t)lround(features[r * 7 + 6] + 1);
        for (size_t i = 0; i < INPUTS; i++)
            input[r * INPUTS + i] = i < 6 ? features[r * 7 + i] : net->embedding.value[pass->place[r] * 8 + i - 6];
    }
    unit_forward(&net->project, rows, input, &pass->project);
    gelu_forward(rows * WIDTH, pass->project.output, pass->trunk[0]);
    for (int b = 0; b < BLOCKS; b++)
    {
        unit_forward(&net->first[b], rows, pass->trunk[b], &pass->first[b]);
        gelu_forward(rows * WIDTH, pass->first[b].output, z);
        unit_forward(&net->second[b], rows, z, &pass->second[b]);
        for (size_t i = 0; i < rows * WIDTH; i++)
            pass->sum[b][i] = pass->trunk[b][i] + pass->second[b].output[i];
        gelu_forward(rows * WIDTH, pass->sum[b], pass->trunk[b + 1]);
    }
    dense_forward(&net->head, rows, pass->trunk[BLOCKS], pass->head);
    gelu_forward(rows * HEAD, pass->head, pass->head_gelu);
    dense_forward(&net->last, rows, pass->head_gelu, pass->share);
    for (size_t r = 0; r < rows; r++)
    {
        pass->share[r] = 1 / (1 + exp(-pass->share[r]));
        angles[r] = REFERENCE_LIMIT * (2 * pass->share[r] - 1);
    }
}

/// Adds to the parameters' gradients.
/// @param g_features receives rows x 7
static inline void network_backward(network *net, const network_pass *pass, const double *g_angles, double *g_features)
{
    static double g[REFERENCE_ROWS * WIDTH], inner[REFERENCE_ROWS * WIDTH], skip[REFERENCE_ROWS * WIDTH];
    size_t rows = pass->rows;
    for (size_t r = 0; r < rows; r++)
        g[r] = g_angles[r] * 2 * REFERENCE_LIMIT * pass->share[r] * (1 - pass->share[r]);
    dense_backward(&net->last, rows, pass->head_gelu, g, inner);
    gelu_backward(rows * HEAD, pass->head, inner);
    dense_backward(&net->head, rows, pass->trunk[BLOCKS], inner, g);
    for (int b = BLOCKS - 1; b >= 0; b--)
    {
        gelu_backward(rows * WIDTH, pass->sum[b], g);
        memcpy(skip, g, sizeof g);
        unit_backward(&net->second[b], rows, &pass->second[b], g, inner);
        gelu_backward(rows * WIDTH, pass->first[b].output, inner);
        unit_backward(&net->first[b], rows, &pass->first[b], inner, g);
        for (size_t i = 0; i < rows * WIDTH; i++)
            g[i] += skip[i];
    }
    gelu_backward(rows * WIDTH, pass->project.output, g);
    unit_backward(&net->project, rows, &pass->project, g, inner);
    for (size_t r = 0; r < rows; r++)
        for (size_t i = 0; i < INPUTS; i++)
        {
            double above = inner[r * INPUTS + i];
            if (i < 6)
                g_features[r * 7 + i] = above;
            else
                net->embedding.gradient[pass->place[r] * 8 + i - 6] += above;
        }
}

#endif
