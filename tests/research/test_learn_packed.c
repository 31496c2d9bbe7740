#include "check.h"

#include "research/learn/operations.h"
// The source itself, to call the product of each register width and not just the widest that this machine has.
#include "learn/packed.c"
#include "research/learn/packed_norm.h"

// Packed layers against the same layers on a tape, which are tested by themselves.

static const double TOLERANCE = sizeof(real) == sizeof(double) ? 1e-12 : 1e-5;

enum
{
    MAX_ROWS = 5 * LEARN_TILE,
    MAX_COLUMNS = 3 * LEARN_PANEL,
    MAX_INPUTS = 45
};

static void fill(real *values, size_t count, bat_random *random)
{
    for (size_t i = 0; i < count; i++)
        values[i] = (real)bat_random_normal(random);
}

/// A layer of random weights, as a tape has it and packed.
typedef struct layer
{
    learn_parameters parameters;
    learn_packed packed;
    _Alignas(64) real memory[(MAX_INPUTS + 1) * MAX_COLUMNS];
} layer;

static layer *make_layer(size_t inputs, size_t outputs, bat_random *random)
{
    layer *l = aligned_alloc(64, (sizeof *l + 63) / 64 * 64);
    assert_non_null(l);
    l->parameters = (learn_parameters){0};
    (void)learn_parameters_add(&l->parameters, outputs, inputs, "weight");
    (void)learn_parameters_add(&l->parameters, 0, outputs, "bias");
    check_status(learn_parameters_allocate(&l->parameters, NULL), BAT_OK);
    fill(l->parameters.values, l->parameters.total, random);
    assert_true(learn_packed_size(inputs, outputs) <= sizeof l->memory / sizeof(real));
    l->packed = learn_pack(inputs, outputs, learn_parameter_values(&l->parameters, 0), inputs,
                           learn_parameter_values(&l->parameters, 1), l->memory);
    return l;
}

static void free_layer(layer *l)
{
    learn_parameters_free(&l->parameters);
    free(l);
}

static void linear_layers_are_those_of_a_tape(void **state)
{
    (void)state;
    static const size_t sizes[][2] = {{1, 1}, {6, 7}, {14, 32}, {32, 33}, {45, 96}, {44, 64}};
    static real x[MAX_ROWS * MAX_INPUTS], y[MAX_ROWS * MAX_COLUMNS];
    bat_random random = bat_random_seed(3);
    learn_tape tape = learn_tape_make();
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
    {
        size_t inputs = sizes[s][0], outputs = sizes[s][1];
        layer *l = make_layer(inputs, outputs, &random);
        for (size_t rows = LEARN_TILE; rows <= MAX_ROWS; rows += LEARN_TILE)
        {
            fill(x, rows * inputs, &random);
            learn_packed_linear(&l->packed, rows, x, inputs, y);
            learn_tape_begin(&tape, &l->parameters, NULL);
            const learn_array *expected = learn_linear(&tape, learn_constant(&tape, rows, inputs, x),
                                                       learn_parameter_array(&tape, 0), learn_parameter_array(&tape, 1));
            for (size_t r = 0; r < rows; r++)
                for (size_t c = 0; c < l->packed.columns; c++)
                    check_near((double)y[r * l->packed.columns + c],
                               c < outputs ? (double)expected->value[r * outputs + c] : 0, 10 * TOLERANCE);
        }
        free_layer(l);
    }
    learn_tape_free(&tape);
}

static void products_of_all_widths_agree(void **state)
{
    (void)state;
    enum
    {
        INPUTS = 37,
        OUTPUTS = 90
    };
    static real x[MAX_ROWS * INPUTS], narrow[MAX_ROWS * MAX_COLUMNS], wide[MAX_ROWS * MAX_COLUMNS];
    bat_random random = bat_random_seed(6);
    layer *l = make_layer(INPUTS, OUTPUTS, &random);
    size_t count = MAX_ROWS * l->packed.columns;
    fill(x, MAX_ROWS * INPUTS, &random);
    product_128(&l->packed, MAX_ROWS, x, INPUTS, narrow);
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    {
        product_256(&l->packed, MAX_ROWS, x, INPUTS, wide);
        for (size_t i = 0; i < count; i++)
            check_near((double)wide[i], (double)narrow[i], 10 * TOLERANCE);
    }
    if (__builtin_cpu_supports("avx512f"))
    {
        product_512(&l->packed, MAX_ROWS, x, INPUTS, wide);
        for (size_t i = 0; i < count; i++)
            check_near((double)wide[i], (double)narrow[i], 10 * TOLERANCE);
    }
#endif
    learn_packed_linear(&l->packed, MAX_ROWS, x, INPUTS, wide);
    for (size_t i = 0; i < count; i++)
        check_near((double)wide[i], (double)narrow[i], 10 * TOLERANCE);
    free_layer(l);
}

/// To the last bit: so what is computed does not depend on how a curve is cut into runs.
static void a_row_depends_on_nothing_but_itself(void **state)
{
    (void)state;
    enum
    {
        INPUTS = 45,
        OUTPUTS = 70
    };
    static real x[MAX_ROWS * INPUTS], y[MAX_ROWS * MAX_COLUMNS], alone[LEARN_TILE * INPUTS],
        result[LEARN_TILE * MAX_COLUMNS], norm[2 * MAX_COLUMNS];
    bat_random random = bat_random_seed(4);
    layer *l = make_layer(INPUTS, OUTPUTS, &random);
    size_t columns = l->packed.columns;
    fill(norm, 2 * columns, &random);
    fill(x, MAX_ROWS * INPUTS, &random);
    learn_packed_linear(&l->packed, MAX_ROWS, x, INPUTS, y);
    learn_packed_norm_gelu(MAX_ROWS, columns, norm, norm + columns, NULL, y);
    for (size_t r = 0; r < MAX_ROWS; r++)
    {
        size_t place = (r * 5 + 1) % LEARN_TILE;
        fill(alone, LEARN_TILE * INPUTS, &random);
        memcpy(alone + place * INPUTS, x + r * INPUTS, INPUTS * sizeof *x);
        learn_packed_linear(&l->packed, LEARN_TILE, alone, INPUTS, result);
        learn_packed_norm_gelu(LEARN_TILE, columns, norm, norm + columns, NULL, result);
        assert_memory_equal(result + place * columns, y + r * columns, columns * sizeof *y);
    }
    free_layer(l);
}

static void norm_and_gelu_are_those_of_a_tape(void **state)
{
    (void)state;
    static real y[MAX_ROWS * MAX_COLUMNS], skip[MAX_ROWS * MAX_COLUMNS];
    bat_random random = bat_random_seed(5);
    learn_tape tape = learn_tape_make();
    for (size_t columns = 3; columns <= MAX_COLUMNS; columns += 31)
        for (int with_skip = 0; with_skip < 2; with_skip++)
        {
            learn_parameters norm = {0};
            (void)learn_parameters_add(&norm, 0, columns, "gain");
            (void)learn_parameters_add(&norm, 0, columns, "shift");
            check_status(learn_parameters_allocate(&norm, NULL), BAT_OK);
            fill(norm.values, norm.total, &random);
            fill(y, MAX_ROWS * columns, &random);
            fill(skip, MAX_ROWS * columns, &random);
            learn_tape_begin(&tape, &norm, NULL);
            learn_array *from = learn_constant(&tape, MAX_ROWS, columns, skip);
            const learn_array *expected =
                learn_layer_norm_gelu(&tape, learn_constant(&tape, MAX_ROWS, columns, y), learn_parameter_array(&tape, 0),
                                      learn_parameter_array(&tape, 1), with_skip ? from : NULL, 0);
            const learn_array *twice = learn_gelu(&tape, learn_constant(&tape, MAX_ROWS, columns, expected->value));
            learn_packed_norm_gelu(MAX_ROWS, columns, norm.values, norm.values + columns, with_skip ? skip : NULL, y);
            for (size_t i = 0; i < MAX_ROWS * columns; i++)
                check_near((double)y[i], (double)expected->value[i], TOLERANCE);
            learn_packed_gelu(MAX_ROWS * columns, y);
            for (size_t i = 0; i < MAX_ROWS * columns; i++)
                check_near((double)y[i], (double)twice->value[i], TOLERANCE);
            learn_parameters_free(&norm);
        }
    learn_tape_free(&tape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_layers_are_those_of_a_tape),
        cmocka_unit_test(products_of_all_widths_agree),
        cmocka_unit_test(a_row_depends_on_nothing_but_itself),
        cmocka_unit_test(norm_and_gelu_are_those_of_a_tape),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
