#include "check.h"

#include "research/networks/tension_network.h"

#include <unistd.h>

// The tension network against PyTorch's forward and backward pass in double precision.

static const bool DOUBLE = sizeof(real) == sizeof(double);
static const char *const ORACLE = SHARED_DATA "/oracle/tension/network.safetensors";

enum
{
    ROWS = 64,
    COLUMNS = TENSION_FEATURES + 1
};

/// A forward and backward pass on a batch of feature rows with the curvature in the last column; the loss is the sum of
/// squares.
static learn_array *run(learn_tape *tape, const learn_parameters *parameters, const double *features, size_t rows,
                        uint32_t *spaces, real *gradient)
{
    learn_tape_begin(tape, parameters, gradient);
    learn_array *x = learn_array_make(tape, rows, TENSION_FEATURES, false);
    for (size_t r = 0; r < rows; r++)
    {
        for (size_t c = 0; c < TENSION_FEATURES; c++)
            x->value[r * TENSION_FEATURES + c] = (real)features[r * COLUMNS + c];
        spaces[r] = (uint32_t)(features[r * COLUMNS + TENSION_FEATURES] + 1);
    }
    learn_array *angles = tension_network_angles(tape, x, spaces);
    learn_tape_backward(tape, learn_sum_of_squares(tape, angles), 1);
    check_status(learn_tape_status(tape, NULL), BAT_OK);
    return angles;
}

static void check_gradients(const learn_parameters *parameters, const real *gradient, const safetensors *content)
{
    real *expected = calloc(parameters->total, sizeof *expected);
    check_status(learn_parameters_extract(parameters, content, "grad.", expected, NULL), BAT_OK);
    for (size_t i = 0; i < parameters->count; i++)
    {
        const learn_parameter *p = &parameters->list[i];
        double largest = 0, off = 0;
        for (size_t k = p->offset; k < p->offset + p->rows * p->columns; k++)
        {
            largest = fmax(largest, fabs((double)expected[k]));
            off = fmax(off, fabs((double)gradient[k] - (double)expected[k]));
        }
        if (off > (DOUBLE ? 1e-10 : 1e-5 * largest))
            print_error("%s: off by %g of %g\n", p->name, off, largest);
        assert_true(off <= (DOUBLE ? 1e-10 : 1e-5 * largest));
    }
    free(expected);
}

static void angles_and_gradients_are_those_of_pytorch(void **state)
{
    (void)state;
    if (access(ORACLE, R_OK) != 0)
    {
        print_message("skipped: %s is not there\n", ORACLE);
        skip();
    }
    safetensors content;
    bat_error error;
    check_status(safetensors_read(ORACLE, &content, &error), BAT_OK);
    learn_parameters parameters = {0};
    check_status(tension_network_make(&parameters, &error), BAT_OK);
    check_status(learn_parameters_extract(&parameters, &content, "weight.", parameters.values, &error), BAT_OK);
    double features[ROWS * COLUMNS], angles[ROWS];
    check_status(safetensors_doubles(&content, "features", ROWS * COLUMNS, features, &error), BAT_OK);
    check_status(safetensors_doubles(&content, "angles", ROWS, angles, &error), BAT_OK);
    real *gradient = calloc(parameters.total, sizeof *gradient);
    uint32_t spaces[ROWS];
    learn_tape tape = learn_tape_make();
    const learn_array *result = run(&tape, &parameters, features, ROWS, spaces, gradient);
    for (size_t r = 0; r < ROWS; r++)
        check_near((double)result->value[r], angles[r], DOUBLE ? 1e-10 : 1e-5 * TENSION_ANGLE_LIMIT);
    check_gradients(&parameters, gradient, &content);
    learn_tape_free(&tape);
    free(gradient);
    learn_parameters_free(&parameters);
    safetensors_free(&content);
}

static void fresh_weights_are_as_drawn(void **state)
{
    (void)state;
    learn_parameters a = {0}, b = {0};
    check_status(tension_network_make(&a, NULL), BAT_OK);
    check_status(tension_network_make(&b, NULL), BAT_OK);
    assert_int_equal(a.total, 140505);
    tension_network_start(&a, 1);
    tension_network_start(&b, 1);
    assert_memory_equal(a.values, b.values, a.total * sizeof *a.values);
    tension_network_start(&b, 2);
    assert_memory_not_equal(a.values, b.values, a.total * sizeof *a.values);
    for (size_t i = 1; i < a.count; i++)
    {
        const learn_parameter *p = &a.list[i];
        const real *values = learn_parameter_values(&a, i);
        size_t count = p->rows * p->columns;
        double squares = 0;
        for (size_t k = 0; k < count; k++)
            squares += (double)values[k] * (double)values[k];
        if (p->rank == 2) // variance 2 / inputs, within five deviations of the estimate
            check_near(squares / (double)count * (double)p->columns / 2, 1, 5 * sqrt(2.0 / (double)count));
        else
            check_near(squares, strstr(p->name, ".weight") != NULL ? (double)count : 0, 0);
    }
    learn_parameters_free(&a);
    learn_parameters_free(&b);
}

/// The safety of theorem 1: no weights, however wild, give an angle of pi/4 or more.
static void no_weights_leave_the_safe_interval(void **state)
{
    (void)state;
    learn_parameters parameters = {0};
    check_status(tension_network_make(&parameters, NULL), BAT_OK);
    learn_tape tape = learn_tape_make();
    bat_random random = bat_random_seed(11);
    uint32_t spaces[ROWS];
    double features[ROWS * COLUMNS];
    for (double size = 1e-2; size < 1e7; size *= 100)
    {
        for (size_t k = 0; k < parameters.total; k++)
            parameters.values[k] = (real)(size * bat_random_normal(&random));
        for (size_t k = 0; k < ROWS * COLUMNS; k++)
            features[k] = k % COLUMNS == TENSION_FEATURES ? (double)(k % 3) - 1 : bat_random_normal(&random);
        const learn_array *angles = run(&tape, &parameters, features, ROWS, spaces, NULL);
        for (size_t r = 0; r < ROWS; r++)
            assert_true(fabs((double)angles->value[r]) <= TENSION_ANGLE_LIMIT * (1 + 1e-6));
    }
    learn_tape_free(&tape);
    learn_parameters_free(&parameters);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_and_gradients_are_those_of_pytorch),
        cmocka_unit_test(fresh_weights_are_as_drawn),
        cmocka_unit_test(no_weights_leave_the_safe_interval),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
