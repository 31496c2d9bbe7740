#include "check.h"

#include "learn/klein.h"
#include "research/learn/functions.h"
#include "research/learn/klein_layers.h"
#include "research/learn/operations.h"
#include "research/learn/parameters.h"

// Every operation's derivative against central differences, for random shapes and numbers. In single precision only the
// values are compared where there is something to compare with; the double build runs the differences.

static const bool DOUBLE = sizeof(real) == sizeof(double);

enum
{
    SEEDS = 6,
    MAX_INPUTS = 6
};

/// Sizes that are drawn at random, from LEAST to MOST.
enum
{
    M = 1000,
    N,
    K,
    LEAST = 3,
    MOST = 20
};

static const uint64_t DROPOUT_KEY = 77;

typedef struct shape
{
    size_t rows, columns;
} shape;

/// An operation on a few arrays, which are parameters so that the test can move them.
typedef struct operation_case
{
    const char *name;
    learn_array *(*apply)(learn_tape *tape, learn_array **inputs);
    shape inputs[MAX_INPUTS];
    size_t input_count;
    bool positive; ///< whether it wants numbers away from 0
} operation_case;

static learn_array *apply_linear(learn_tape *tape, learn_array **inputs)
{
    return learn_linear(tape, inputs[0], inputs[1], inputs[2]);
}

static learn_array *apply_linear_relu(learn_tape *tape, learn_array **inputs)
{
    return learn_linear_relu(tape, inputs[0], inputs[1], inputs[2]);
}

static learn_array *apply_linear_plain(learn_tape *tape, learn_array **inputs)
{
    return learn_linear(tape, inputs[0], inputs[1], NULL);
}

static learn_array *apply_layer_norm(learn_tape *tape, learn_array **inputs)
{
    return learn_layer_norm(tape, inputs[0], inputs[1], inputs[2]);
}

static learn_array *apply_layer_norm_gelu(learn_tape *tape, learn_array **inputs)
{
    return learn_layer_norm_gelu(tape, inputs[0], inputs[1], inputs[2], NULL, 0.3);
}

static learn_array *apply_layer_norm_gelu_skip(learn_tape *tape, learn_array **inputs)
{
    return learn_layer_norm_gelu(tape, inputs[0], inputs[1], inputs[2], inputs[3], 0);
}

static learn_array *apply_batch_norm(learn_tape *tape, learn_array **inputs)
{
    return learn_batch_norm(tape, inputs[0], inputs[1], inputs[2]);
}

static learn_array *apply_gelu(learn_tape *tape, learn_array **inputs)
{
    return learn_gelu(tape, inputs[0]);
}

static learn_array *apply_relu(learn_tape *tape, learn_array **inputs)
{
    return learn_relu(tape, inputs[0]);
}

static learn_array *apply_sigmoid(learn_tape *tape, learn_array **inputs)
{
    return learn_sigmoid(tape, inputs[0]);
}

static learn_array *apply_tanh(learn_tape *tape, learn_array **inputs)
{
    return learn_tanh(tape, inputs[0]);
}

static learn_array *apply_interval(learn_tape *tape, learn_array **inputs)
{
    return learn_interval(tape, inputs[0], (real)-0.7, (real)1.9);
}

static learn_array *apply_dropout(learn_tape *tape, learn_array **inputs)
{
    return learn_dropout(tape, inputs[0], 0.4);
}

static learn_array *apply_scale(learn_tape *tape, learn_array **inputs)
{
    return learn_scale(tape, inputs[0], (real)-1.7);
}

static learn_array *apply_add(learn_tape *tape, learn_array **inputs)
{
    return learn_add(tape, inputs[0], inputs[1]);
}

static learn_array *apply_subtract(learn_tape *tape, learn_array **inputs)
{
    return learn_subtract(tape, inputs[0], inputs[1]);
}

static learn_array *apply_multiply(learn_tape *tape, learn_array **inputs)
{
    return learn_multiply(tape, inputs[0], inputs[1]);
}

static learn_array *apply_square(learn_tape *tape, learn_array **inputs)
{
    return learn_multiply(tape, inputs[0], inputs[0]);
}

static learn_array *apply_sum(learn_tape *tape, learn_array **inputs)
{
    return learn_sum(tape, inputs[0]);
}

static learn_array *apply_sum_of_squares(learn_tape *tape, learn_array **inputs)
{
    return learn_sum_of_squares(tape, inputs[0]);
}

static learn_array *apply_mean_of_squares(learn_tape *tape, learn_array **inputs)
{
    return learn_mean_of_squares(tape, inputs[0]);
}

static learn_array *apply_mean_squared_error(learn_tape *tape, learn_array **inputs)
{
    return learn_mean_squared_error(tape, inputs[0], inputs[1]);
}

static learn_array *apply_row_norms(learn_tape *tape, learn_array **inputs)
{
    return learn_row_norms(tape, inputs[0]);
}

static learn_array *apply_gather_rows(learn_tape *tape, learn_array **inputs)
{
    static const uint32_t indices[] = {2, 0, 2, 2, 1};
    return learn_gather_rows(tape, inputs[0], indices, 5);
}

static learn_array *apply_segment_mean(learn_tape *tape, learn_array **inputs)
{
    static const uint32_t offsets[] = {0, 1, 1, 4};
    return learn_segment_mean(tape, inputs[0], offsets, NULL, 3);
}

static learn_array *apply_neighbour_mean(learn_tape *tape, learn_array **inputs)
{
    static const uint32_t offsets[] = {0, 3, 5, 5, 6}, indices[] = {0, 1, 3, 3, 3, 2};
    return learn_segment_mean(tape, inputs[0], offsets, indices, 4);
}

static learn_array *apply_scatter_mean(learn_tape *tape, learn_array **inputs)
{
    static const uint32_t targets[] = {4, 0, 4, 1, 4};
    return learn_scatter_mean(tape, inputs[0], targets, 6);
}

static learn_array *apply_slice_rows(learn_tape *tape, learn_array **inputs)
{
    return learn_slice_rows(tape, inputs[0], 1, 2);
}

static learn_array *apply_slice_columns(learn_tape *tape, learn_array **inputs)
{
    return learn_slice_columns(tape, inputs[0], 2, 3);
}

static learn_array *apply_concatenate_rows(learn_tape *tape, learn_array **inputs)
{
    return learn_concatenate_rows(tape, inputs, 3);
}

static learn_array *apply_concatenate_columns(learn_tape *tape, learn_array **inputs)
{
    return learn_concatenate_columns(tape, inputs, 3);
}

static learn_array *apply_log(learn_tape *tape, learn_array **inputs)
{
    return learn_log(tape, learn_add_number(tape, learn_interval(tape, inputs[0], (real)-0.8, (real)2), 1));
}

static learn_array *apply_klein_linear(learn_tape *tape, learn_array **inputs)
{
    const klein_widths in = {{3, 1, 2, 4}}, out = {{2, 5, 1, 3}};
    return learn_klein_linear(tape, inputs[0], in, out, inputs + 1, inputs[5]);
}

static learn_array *apply_klein_linear_plain(learn_tape *tape, learn_array **inputs)
{
    return learn_klein_linear(tape, inputs[0], klein_equal(2), klein_equal(3), inputs + 1, NULL);
}

static learn_array *apply_klein_gelu(learn_tape *tape, learn_array **inputs)
{
    return learn_klein_gelu(tape, inputs[0]);
}

static const operation_case cases[] = {
    {"linear", apply_linear, {{M, N}, {K, N}, {1, K}}, 3, false},
    {"linear relu", apply_linear_relu, {{M, N}, {K, N}, {1, K}}, 3, false},
    {"linear to one column", apply_linear, {{M, N}, {1, N}, {1, 1}}, 3, false},
    {"linear without bias", apply_linear_plain, {{M, N}, {K, N}}, 2, false},
    {"layer norm", apply_layer_norm, {{M, N}, {1, N}, {1, N}}, 3, false},
    {"layer norm, wide", apply_layer_norm, {{M, 67}, {1, 67}, {1, 67}}, 3, false},
    {"layer norm gelu", apply_layer_norm_gelu, {{M, N}, {1, N}, {1, N}}, 3, false},
    {"layer norm gelu skip", apply_layer_norm_gelu_skip, {{M, N}, {1, N}, {1, N}, {M, N}}, 4, false},
    {"batch norm", apply_batch_norm, {{M, N}, {1, N}, {1, N}}, 3, false},
    {"gelu", apply_gelu, {{M, N}}, 1, false},
    {"relu", apply_relu, {{M, N}}, 1, true},
    {"sigmoid", apply_sigmoid, {{M, N}}, 1, false},
    {"tanh", apply_tanh, {{M, N}}, 1, false},
    {"interval", apply_interval, {{M, N}}, 1, false},
    {"dropout", apply_dropout, {{M, N}}, 1, false},
    {"scale", apply_scale, {{M, N}}, 1, false},
    {"add", apply_add, {{M, N}, {M, N}}, 2, false},
    {"subtract", apply_subtract, {{M, N}, {M, N}}, 2, false},
    {"multiply", apply_multiply, {{M, N}, {M, N}}, 2, false},
    {"multiply by itself", apply_square, {{M, N}}, 1, false},
    {"sum", apply_sum, {{M, N}}, 1, false},
    {"sum of squares", apply_sum_of_squares, {{M, N}}, 1, false},
    {"mean of squares", apply_mean_of_squares, {{M, N}}, 1, false},
    {"mean squared error", apply_mean_squared_error, {{M, N}, {M, N}}, 2, false},
    {"row norms", apply_row_norms, {{M, N}}, 1, true},
    {"gather rows", apply_gather_rows, {{3, N}}, 1, false},
    {"segment mean", apply_segment_mean, {{4, N}}, 1, false},
    {"neighbour mean", apply_neighbour_mean, {{4, N}}, 1, false},
    {"scatter mean", apply_scatter_mean, {{5, N}}, 1, false},
    {"slice rows", apply_slice_rows, {{M, N}}, 1, false},
    {"slice columns", apply_slice_columns, {{M, 6}}, 1, false},
    {"concatenate rows", apply_concatenate_rows, {{M, N}, {1, N}, {K, N}}, 3, false},
    {"concatenate columns", apply_concatenate_columns, {{M, N}, {M, 1}, {M, K}}, 3, false},
    {"log", apply_log, {{M, N}}, 1, false},
    {"klein linear", apply_klein_linear, {{M, 10}, {3, 2}, {1, 5}, {2, 1}, {4, 3}, {1, 2}}, 6, false},
    {"klein linear without bias", apply_klein_linear_plain, {{M, 8}, {2, 3}, {2, 3}, {2, 3}, {2, 3}}, 5, false},
    {"klein gelu", apply_klein_gelu, {{M, 4 * 7}}, 1, false},
};

/// Parameters of the shapes with random numbers.
static learn_parameters make_inputs(const operation_case *operation, uint64_t seed)
{
    learn_parameters inputs = {0};
    bat_random random = bat_random_seed(seed);
    static const char *const names[MAX_INPUTS] = {"a", "b", "c", "d", "e", "f"};
    size_t drawn[3];
    for (size_t i = 0; i < 3; i++)
        drawn[i] = LEAST + bat_random_bits(&random) % (MOST - LEAST + 1);
    for (size_t i = 0; i < operation->input_count; i++)
    {
        shape s = operation->inputs[i];
        (void)learn_parameters_add(&inputs, s.rows >= M ? drawn[s.rows - M] : s.rows,
                                   s.columns >= M ? drawn[s.columns - M] : s.columns, names[i]);
    }
    check_status(learn_parameters_allocate(&inputs, NULL), BAT_OK);
    for (size_t k = 0; k < inputs.total; k++)
    {
        double x = bat_random_normal(&random);
        inputs.values[k] = (real)(operation->positive && fabs(x) < 0.01 ? 0.5 : x);
    }
    return inputs;
}

/// The squared distance of the output from a random target, so that every element has its own slope. The first input is used
/// once more beside the operation, so that gradients must add up.
static learn_array *loss_of(learn_tape *tape, const operation_case *operation, const learn_parameters *inputs,
                            real *gradient)
{
    learn_tape_begin(tape, inputs, gradient);
    learn_tape_drop(tape, DROPOUT_KEY);
    learn_array *arrays[MAX_INPUTS];
    for (size_t i = 0; i < operation->input_count; i++)
        arrays[i] = learn_scale(tape, learn_parameter_array(tape, i), 1);
    learn_array *output = operation->apply(tape, arrays);
    bat_random random = bat_random_seed(5);
    learn_array *target = learn_array_make(tape, output->rows, output->columns, false);
    for (size_t k = 0; k < learn_size(target); k++)
        target->value[k] = (real)bat_random_normal(&random);
    learn_array *loss = learn_sum_of_squares(tape, learn_subtract(tape, output, target));
    return learn_add(tape, loss, learn_scale(tape, learn_sum_of_squares(tape, arrays[0]), (real)0.3));
}

/// The loss with one of the inputs' numbers moved.
static double value_at(learn_tape *tape, const operation_case *operation, learn_parameters *inputs, size_t number, double by)
{
    real kept = inputs->values[number];
    inputs->values[number] = (real)((double)kept + by);
    double value = (double)*loss_of(tape, operation, inputs, NULL)->value;
    inputs->values[number] = kept;
    return value;
}

/// The derivative by one of them, by central differences of fourth order.
static double slope_of(learn_tape *tape, const operation_case *operation, learn_parameters *inputs, size_t number)
{
    const double h = 5e-4;
    double near = value_at(tape, operation, inputs, number, h) - value_at(tape, operation, inputs, number, -h);
    double far = value_at(tape, operation, inputs, number, 2 * h) - value_at(tape, operation, inputs, number, -2 * h);
    return (8 * near - far) / (12 * h);
}

static void check_case(const operation_case *operation, uint64_t seed)
{
    learn_parameters inputs = make_inputs(operation, seed);
    real *gradient = calloc(inputs.total, sizeof *gradient);
    learn_tape tape = learn_tape_make();
    learn_array *loss = loss_of(&tape, operation, &inputs, gradient);
    learn_tape_backward(&tape, loss, 1);
    check_status(learn_tape_status(&tape, NULL), BAT_OK);
    assert_true(isfinite(*loss->value));
    // What the last digits of the loss become when differences are divided by the step.
    double rounding = 2e-12 * (double)*loss->value;
    for (size_t k = 0; k < inputs.total; k++)
    {
        assert_true(isfinite(gradient[k]));
        if (!DOUBLE)
            continue;
        double slope = slope_of(&tape, operation, &inputs, k);
        double tolerance = 2e-8 * (1 + fabs(slope)) + rounding;
        if (fabs(slope - (double)gradient[k]) > tolerance)
            print_error("%s, seed %d, number %zu\n", operation->name, (int)seed, k);
        check_near((double)gradient[k], slope, tolerance);
    }
    learn_tape_free(&tape);
    free(gradient);
    learn_parameters_free(&inputs);
}

static void derivatives_are_those_of_central_differences(void **state)
{
    (void)state;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
        for (uint64_t seed = 0; seed < SEEDS; seed++)
            check_case(&cases[c], seed);
}

/// In single precision the values and gradients of the vectorised functions against the C library's.
static void functions_agree_with_the_c_library(void **state)
{
    (void)state;
    double tolerance = DOUBLE ? 1e-14 : 4e-7;
    for (double x = -12; x <= 12; x += 0.00371)
    {
        real t = (real)x;
        double y = (double)t, below = 0.5 * erfc(-y / sqrt(2)), density = exp(-0.5 * y * y) / sqrt(6.283185307179586);
        check_near((double)real_gelu(t), y * below, tolerance * (1 + fabs(y)));
        check_near((double)real_gelu_slope(t), below + y * density, 2 * tolerance);
        check_near((double)real_tanh(t), tanh(y), tolerance * fabs(tanh(y)));
        check_relative((double)real_exp(t), exp(y), tolerance);
        check_relative((double)real_sigmoid(t), 1 / (1 + exp(-y)), 2 * tolerance);
    }
    assert_true(real_tanh(0) == 0);
    assert_true(real_gelu(0) == 0);
    assert_true(real_exp(0) == 1);
    assert_true(isfinite(real_gelu((real)-1e30)) && isfinite(real_exp((real)80)));
}

/// GELU at points whose values are known: x P(X < x).
static void gelu_is_the_exact_one(void **state)
{
    (void)state;
    double tolerance = DOUBLE ? 1e-15 : 3e-7;
    check_near((double)real_gelu(1), 0.84134474606854294859, tolerance);
    check_near((double)real_gelu(-1), -0.15865525393145705141, tolerance);
    check_near((double)real_gelu(2), 1.9544997361036415856, 2 * tolerance);
}

static void normalized_rows_have_mean_0_and_variance_1(void **state)
{
    (void)state;
    operation_case norms[] = {{"layer", apply_layer_norm, {{5, 40}, {1, 40}, {1, 40}}, 3, false},
                              {"batch", apply_batch_norm, {{40, 5}, {1, 5}, {1, 5}}, 3, false}};
    for (size_t n = 0; n < 2; n++)
    {
        learn_parameters inputs = make_inputs(&norms[n], 3);
        learn_parameter_fill(&inputs, 1, 1);
        learn_parameter_fill(&inputs, 2, 0);
        learn_tape tape = learn_tape_make();
        learn_tape_begin(&tape, &inputs, NULL);
        learn_array *arrays[3];
        for (size_t i = 0; i < 3; i++)
            arrays[i] = learn_parameter_array(&tape, i);
        learn_array *y = norms[n].apply(&tape, arrays);
        size_t groups = n == 0 ? y->rows : y->columns;
        for (size_t g = 0; g < groups; g++)
        {
            double sum = 0, squares = 0;
            for (size_t k = 0; k < 40; k++)
            {
                double v = (double)y->value[n == 0 ? g * 40 + k : k * 5 + g];
                sum += v;
                squares += v * v;
            }
            check_near(sum, 0, DOUBLE ? 1e-12 : 1e-4);
            check_near(squares / 40, 1, 1e-4);
        }
        learn_tape_free(&tape);
        learn_parameters_free(&inputs);
    }
}

static void the_fused_layer_is_its_parts(void **state)
{
    (void)state;
    operation_case parts = {"", apply_layer_norm, {{19, 33}, {1, 33}, {1, 33}, {19, 33}}, 4, false};
    learn_parameters inputs = make_inputs(&parts, 8);
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, &inputs, NULL);
    learn_array *a[4];
    for (size_t i = 0; i < 4; i++)
        a[i] = learn_parameter_array(&tape, i);
    learn_tape_drop(&tape, 9);
    learn_array *fused = learn_layer_norm_gelu(&tape, a[0], a[1], a[2], a[3], 0.25);
    learn_tape_drop(&tape, 9);
    tape.dropout_uses = 0;
    learn_array *normal = learn_add(&tape, learn_layer_norm(&tape, a[0], a[1], a[2]), a[3]);
    learn_array *separate = learn_dropout(&tape, learn_gelu(&tape, normal), 0.25);
    for (size_t k = 0; k < learn_size(fused); k++)
        check_near((double)fused->value[k], (double)separate->value[k], DOUBLE ? 1e-14 : 1e-5);
    learn_tape_free(&tape);
    learn_parameters_free(&inputs);
}

static void dropout_drops_its_share_and_keeps_the_mean(void **state)
{
    (void)state;
    enum
    {
        ROWS = 500,
        COLUMNS = 400
    };
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, NULL, NULL);
    learn_array *x = learn_array_make(&tape, ROWS, COLUMNS, false);
    for (size_t k = 0; k < learn_size(x); k++)
        x->value[k] = 1;
    assert_ptr_equal(learn_dropout(&tape, x, 0.05), x);
    learn_tape_drop(&tape, 1);
    learn_array *first = learn_dropout(&tape, x, 0.05), *second = learn_dropout(&tape, x, 0.05);
    size_t dropped = 0, both = 0, neighbours = 0;
    for (size_t k = 0; k < learn_size(x); k++)
    {
        assert_true(first->value[k] == 0 || first->value[k] == (real)(1 / (1 - 0.05)));
        dropped += first->value[k] == 0;
        both += first->value[k] == 0 && second->value[k] == 0;
        neighbours += k > 0 && first->value[k] == 0 && first->value[k - 1] == 0;
    }
    // Binomial counts of 200,000 trials, within five deviations.
    check_near((double)dropped, 10000, 490);
    check_near((double)both, 500, 112);
    check_near((double)neighbours, 500, 112);
    learn_tape_free(&tape);
}

// An operation of one's own: z = x1 / x2 for two 1 x 1 arrays, and as a second output their product.

typedef struct quotient
{
    learn_array *x, *y, *ratio, *product;
} quotient;

static void quotient_backward(void *context)
{
    quotient *q = context;
    real x = *q->x->value, y = *q->y->value;
    real dratio = q->ratio->begun ? *q->ratio->gradient : 0, dproduct = q->product->begun ? *q->product->gradient : 0;
    *learn_gradient(q->x) += dratio / y + dproduct * y;
    *learn_gradient(q->y) += -dratio * x / (y * y) + dproduct * x;
}

static void operations_of_ones_own_take_part(void **state)
{
    (void)state;
    learn_parameters inputs = {0};
    (void)learn_parameters_add(&inputs, 0, 1, "x");
    (void)learn_parameters_add(&inputs, 0, 1, "y");
    check_status(learn_parameters_allocate(&inputs, NULL), BAT_OK);
    learn_parameter_fill(&inputs, 0, 3);
    learn_parameter_fill(&inputs, 1, 4);
    real gradient[2] = {0, 0};
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, &inputs, gradient);
    quotient *q = learn_tape_memory(&tape, 1, sizeof *q);
    *q = (quotient){learn_parameter_array(&tape, 0), learn_parameter_array(&tape, 1), learn_array_make(&tape, 1, 1, true),
                    learn_array_make(&tape, 1, 1, true)};
    *q->ratio->value = *q->x->value / *q->y->value;
    *q->product->value = *q->x->value * *q->y->value;
    learn_tape_record(&tape, NULL, quotient_backward, q);
    // loss = 2 (x / y), then gradient 2 / y and -2 x / y^2; the product is not used.
    learn_tape_backward(&tape, learn_scale(&tape, q->ratio, 2), 1);
    check_near((double)gradient[0], 0.5, 1e-7);
    check_near((double)gradient[1], -0.375, 1e-7);
    learn_tape_free(&tape);
    learn_parameters_free(&inputs);
}

static void a_step_repeated_takes_no_more_memory(void **state)
{
    (void)state;
    learn_parameters inputs = make_inputs(&cases[0], 1);
    learn_tape tape = learn_tape_make();
    const struct tape_block *block = NULL;
    size_t used = 0;
    for (int step = 0; step < 5; step++)
    {
        learn_tape_begin(&tape, &inputs, NULL);
        learn_array *x = learn_parameter_array(&tape, 0);
        for (int layer = 0; layer < 2000; layer++)
            x = learn_scale(&tape, x, (real)0.99);
        if (step > 1)
        {
            assert_ptr_equal(tape.block, block);
            assert_int_equal(tape.used, used);
        }
        block = tape.block;
        used = tape.used;
    }
    learn_tape_free(&tape);
    learn_parameters_free(&inputs);
}

static void a_failure_is_kept_and_harmless(void **state)
{
    (void)state;
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, NULL, NULL);
    const real one = 1;
    learn_array *x = learn_constant(&tape, 1, 1, &one);
    learn_array *huge = learn_array_make(&tape, (size_t)1 << 40, 1, true);
    learn_array *after = learn_gelu(&tape, learn_add(&tape, huge, huge));
    after = learn_layer_norm(&tape, after, x, x);
    after = learn_linear(&tape, after, x, x);
    learn_array *both[2] = {after, huge};
    after = learn_row_norms(&tape, learn_concatenate_columns(&tape, both, 2));
    learn_tape_backward(&tape, learn_mean_of_squares(&tape, after), 1);
    bat_error error;
    check_status(learn_tape_status(&tape, &error), BAT_TOO_LARGE);
    learn_tape_begin(&tape, NULL, NULL);
    check_status(learn_tape_status(&tape, &error), BAT_OK);
    learn_tape_free(&tape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_are_those_of_central_differences),
        cmocka_unit_test(functions_agree_with_the_c_library),
        cmocka_unit_test(gelu_is_the_exact_one),
        cmocka_unit_test(normalized_rows_have_mean_0_and_variance_1),
        cmocka_unit_test(the_fused_layer_is_its_parts),
        cmocka_unit_test(dropout_drops_its_share_and_keeps_the_mean),
        cmocka_unit_test(operations_of_ones_own_take_part),
        cmocka_unit_test(a_step_repeated_takes_no_more_memory),
        cmocka_unit_test(a_failure_is_kept_and_harmless),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
