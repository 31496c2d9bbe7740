#include "check.h"

#include "learn/klein.h"
#include "learn/packed.h"
#include "research/learn/klein_layers.h"
#include "research/learn/operations.h"

// What the two reflections do to a layer's input they do to its output; and the layer without a tape.

static const bool DOUBLE = sizeof(real) == sizeof(double);

enum
{
    ROWS = 13,
    WIDTH = 37, ///< no whole number of vectors
    TOTAL = KLEIN_COUNT * WIDTH,
    GROUP = 4 ///< elements: the identity, the two reflections, and both together
};

/// The sign that a reflection, or both together, gives to the numbers of a character.
static real sign_of(int element, size_t character)
{
    bool first = (element & 1) != 0 && (character == KLEIN_FIRST || character == KLEIN_BOTH);
    bool second = (element & 2) != 0 && (character == KLEIN_SECOND || character == KLEIN_BOTH);
    return first != second ? -1 : 1;
}

/// Let an element of the group act on rows of blocks.
static void act(int element, klein_widths widths, size_t rows, const real *x, real *moved)
{
    for (size_t r = 0; r < rows; r++)
        for (size_t k = 0; k < KLEIN_COUNT; k++)
            for (size_t c = 0; c < widths.of[k]; c++)
                *moved++ = sign_of(element, k) * *x++;
}

static void fill(real *numbers, size_t count, double size, bat_random *random)
{
    for (size_t i = 0; i < count; i++)
        numbers[i] = (real)(size * bat_random_normal(random));
}

/// A layer, by its input on a tape.
typedef learn_array *layer(learn_tape *tape, learn_array *x, const learn_parameters *parameters);

static const klein_widths IN = {{5, 9, 2, 7}}, OUT = {{8, 1, 6, 11}};

static learn_array *linear(learn_tape *tape, learn_array *x, const learn_parameters *parameters)
{
    (void)parameters;
    learn_array *weights[KLEIN_COUNT];
    for (size_t k = 0; k < KLEIN_COUNT; k++)
        weights[k] = learn_parameter_array(tape, k);
    return learn_klein_linear(tape, x, IN, OUT, weights, learn_parameter_array(tape, KLEIN_COUNT));
}

static learn_array *gelu(learn_tape *tape, learn_array *x, const learn_parameters *parameters)
{
    (void)parameters;
    return learn_klein_gelu(tape, x);
}

/// @param size      of the numbers that go in
/// @param tolerance of those that come out
static void check_commutes(layer *apply, klein_widths in, klein_widths out, double size, double tolerance,
                           const learn_parameters *parameters)
{
    bat_random random = bat_random_seed(7);
    static real x[ROWS * TOTAL], moved[ROWS * TOTAL], expected[ROWS * TOTAL];
    assert_true(klein_total(in) <= TOTAL && klein_total(out) <= TOTAL);
    fill(x, ROWS * klein_total(in), size, &random);
    for (int element = 0; element < GROUP; element++)
    {
        learn_tape tape = learn_tape_make();
        learn_tape_begin(&tape, parameters, NULL);
        act(element, in, ROWS, x, moved);
        learn_array *y = apply(&tape, learn_constant(&tape, ROWS, klein_total(in), x), parameters);
        learn_array *other = apply(&tape, learn_constant(&tape, ROWS, klein_total(in), moved), parameters);
        check_status(learn_tape_status(&tape, NULL), BAT_OK);
        assert_int_equal(y->columns, klein_total(out));
        act(element, out, ROWS, y->value, expected);
        for (size_t i = 0; i < learn_size(other); i++)
            check_near((double)other->value[i], (double)expected[i], tolerance);
        learn_tape_free(&tape);
    }
}

static void linear_layers_commute_with_the_reflections(void **state)
{
    (void)state;
    static const char *const names[] = {"kept", "second", "first", "both"};
    learn_parameters parameters = {0};
    bat_random random = bat_random_seed(1);
    for (size_t k = 0; k < KLEIN_COUNT; k++)
        (void)learn_parameters_add(&parameters, IN.of[k], OUT.of[k], names[k]);
    (void)learn_parameters_add(&parameters, 0, OUT.of[KLEIN_KEPT], "bias");
    check_status(learn_parameters_allocate(&parameters, NULL), BAT_OK);
    fill(parameters.values, parameters.total, 1, &random);
    // To the last bit.
    check_commutes(linear, IN, OUT, 1, 0, &parameters);
    learn_parameters_free(&parameters);
}

static void gelu_commutes_with_the_reflections(void **state)
{
    (void)state;
    // A product and a sum that become one instruction are rounded differently in the one order and in the other.
    for (double size = 1e-3; size < 1e4; size *= 10)
        check_commutes(gelu, klein_equal(WIDTH), klein_equal(WIDTH), size, size * (DOUBLE ? 2e-15 : 1e-6), NULL);
}

/// A character's numbers are +-1 on the four elements and multiply as they do, and no two characters are alike.
static void signs_are_characters_of_the_group(void **state)
{
    (void)state;
    for (size_t k = 0; k < KLEIN_COUNT; k++)
        for (int a = 0; a < GROUP; a++)
            for (int b = 0; b < GROUP; b++)
                check_near((double)(sign_of(a, k) * sign_of(b, k)), (double)sign_of(a ^ b, k), 0);
    for (size_t k = 0; k < KLEIN_COUNT; k++)
        for (size_t l = 0; l < KLEIN_COUNT; l++)
        {
            double sum = 0;
            for (int a = 0; a < GROUP; a++)
                sum += (double)(sign_of(a, k) * sign_of(a, l));
            check_near(sum, k == l ? GROUP : 0, 0);
        }
}

/// Where the blocks that change signs are 0, the function is GELU itself, at half the number, twice over.
static void gelu_of_what_all_keep_is_gelu(void **state)
{
    (void)state;
    for (double v = -8; v < 8; v += 0.37)
    {
        real x[KLEIN_COUNT] = {(real)v}, y[KLEIN_COUNT];
        klein_gelu_forward(1, x, y);
        double half = 0.5 * (double)x[0], expected = 2 * half * 0.5 * erfc(-half / sqrt(2));
        check_near((double)y[0], expected, (DOUBLE ? 1e-14 : 1e-6) * (1 + fabs(v)));
        for (size_t k = 1; k < KLEIN_COUNT; k++)
            check_near((double)y[k], 0, 0);
    }
}

/// Blocks one behind the other instead of side by side.
static void the_layer_without_a_tape_is_the_same(void **state)
{
    (void)state;
    static real x[ROWS * TOTAL], blocks[ROWS * TOTAL], y[ROWS * TOTAL];
    bat_random random = bat_random_seed(3);
    fill(x, ROWS * TOTAL, 2, &random);
    for (size_t r = 0; r < ROWS; r++)
        for (size_t k = 0; k < KLEIN_COUNT; k++)
            memcpy(blocks + (k * ROWS + r) * WIDTH, x + r * TOTAL + k * WIDTH, WIDTH * sizeof *x);
    learn_packed_klein_gelu(ROWS * WIDTH, blocks, y);
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, NULL, NULL);
    const learn_array *expected = learn_klein_gelu(&tape, learn_constant(&tape, ROWS, TOTAL, x));
    for (size_t r = 0; r < ROWS; r++)
        for (size_t k = 0; k < KLEIN_COUNT; k++)
            for (size_t c = 0; c < WIDTH; c++)
                check_near((double)y[(k * ROWS + r) * WIDTH + c], (double)expected->value[r * TOTAL + k * WIDTH + c],
                           DOUBLE ? 1e-14 : 1e-6);
    learn_tape_free(&tape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signs_are_characters_of_the_group),    cmocka_unit_test(linear_layers_commute_with_the_reflections),
        cmocka_unit_test(gelu_commutes_with_the_reflections),   cmocka_unit_test(gelu_of_what_all_keep_is_gelu),
        cmocka_unit_test(the_layer_without_a_tape_is_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
