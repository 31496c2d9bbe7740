// The learned rule on a tape: its steps against refinement by the library, and the loss against central differences. Built
// in single and double precision.

#include "learned_helpers.h"

#include "batten/curve_measure.h"
#include "research/train/curve_network_tape.h"

static const bool DOUBLE = sizeof(real) == sizeof(double);

enum
{
    TRUTH = 90
};

// A step

/// Levels of bat_curve_refine() against steps on the tape: those of the network, and one after them.
static void check_step(learn_tape *tape, const learn_parameters *parameters, const geometry_polygon *polygon,
                       double fairness)
{
    bat_space space = space_of(polygon->surface);
    const bat_curve_angle_rule rule = learned_rule(parameters->values);
    bat_curve coarse = {
        .space = &space, .points = (double *)(uintptr_t)polygon->points, .count = polygon->count, .closed = polygon->closed};
    bat_curve_refine_options how = by_rule(&rule, fairness, LEARNED_LEVELS + 1);
    bat_curve fine = refined(&coarse, &how);
    learn_tape_begin(tape, parameters, NULL);
    tape_polygon *stepped = tape_polygon_given(tape, polygon);
    for (size_t level = 0; level < how.levels; level++)
        stepped = curve_network_step(tape, stepped, level, fairness);
    check_status(learn_tape_status(tape, NULL), BAT_OK);
    assert_int_equal(stepped->shape.count, fine.count);
    assert_true(stepped->shape.closed == polygon->closed);
    for (size_t i = 0; i < fine.count * space.point_dim; i++)
        check_near(stepped->shape.points[i], fine.points[i], DOUBLE ? 1e-10 : 1e-5);
    bat_curve_free(&fine);
}

static void steps_are_levels_of_refinement(void **state)
{
    (void)state;
    learn_parameters parameters = random_weights(1);
    learn_tape tape = learn_tape_make();
    bat_random random = bat_random_seed(1);
    double points[MAX_COORDINATES];
    for (size_t s = 0; s < 3; s++)
        for (size_t count = 4; count < 40; count += count < 12 ? 1 : 13)
            for (int closed = 0; closed < 2; closed++)
                for (int kind = EVEN; kind <= UNEVEN; kind++)
                {
                    geometry_polygon polygon = make_polygon(SURFACES[s], (polygon_kind)kind, count, &random, points);
                    polygon.closed = closed == 1;
                    check_step(&tape, &parameters, &polygon, bat_random_uniform(&random));
                }
    learn_tape_free(&tape);
    learn_parameters_free(&parameters);
}

/// Networks begin as the six-point rule: with weights drawn for training the last layer is zero.
static void training_sets_out_from_the_six_point_rule(void **state)
{
    (void)state;
    learn_parameters parameters = {0};
    learn_tape tape = learn_tape_make();
    bat_random random = bat_random_seed(2);
    check_status(learned_network_make(&parameters, NULL), BAT_OK);
    learned_network_start(&parameters, 2);
    real features[3 * LEARNED_FEATURES];
    for (size_t i = 0; i < 3 * LEARNED_FEATURES; i++)
        features[i] = (real)bat_random_normal(&random);
    learn_tape_begin(&tape, &parameters, NULL);
    const learn_array *output = learned_network_apply(&tape, learn_constant(&tape, 3, LEARNED_FEATURES, features));
    assert_int_equal(output->rows, 3);
    assert_int_equal(output->columns, LEARNED_OUTPUTS);
    for (size_t r = 0; r < 3 * LEARNED_OUTPUTS; r++)
        check_near((double)output->value[r], 0, 0);
    learn_tape_free(&tape);
    learn_parameters_free(&parameters);
}

// The loss

static const curve_loss_weights WEIGHTS = {.min_roughness = 0.1, .max_roughness = 3, .angle = 0.8, .hinge = 0.7};

/// A curve to be near to: a circle that is no refined polygon's.
static void make_truth(geometry_surface surface, double *truth)
{
    for (size_t i = 0; i < TRUTH; i++)
        polar_point(surface, 0.5, 0.01 + 6.28318530717958647693 * (double)i / TRUTH, truth + i * geometry_dim(surface));
}

/// A sample with a tape and weights to differentiate by.
typedef struct fixture
{
    learn_parameters parameters;
    learn_tape tape;
    double points[MAX_COORDINATES], truth[3 * TRUTH];
    tension_sample sample;
    size_t steps;
    double fairness;
} fixture;

static curve_network_loss loss_of(fixture *f, real *gradient)
{
    learn_tape_begin(&f->tape, &f->parameters, gradient);
    curve_network_loss loss = curve_network_sample_loss(&f->tape, &f->sample, f->steps, f->fairness, &WEIGHTS);
    if (gradient != NULL)
        learn_tape_backward(&f->tape, loss.total, 1);
    check_status(learn_tape_status(&f->tape, NULL), BAT_OK);
    return loss;
}

/// The derivative of the loss along a direction of some weights.
static double slope_along(fixture *f, size_t first, size_t count, const double *direction)
{
    const double h = 3e-6; // small, as neighbours in the distances change
    double values[4];
    real *kept = malloc(count * sizeof *kept), *weights = f->parameters.values + first;
    assert_non_null(kept);
    memcpy(kept, weights, count * sizeof *kept);
    for (int k = 0; k < 4; k++)
    {
        for (size_t i = 0; i < count; i++)
            weights[i] = (real)((double)kept[i] + FIVE_POINT_STEPS[k] * h * direction[i]);
        values[k] = (double)*loss_of(f, NULL).total->value;
    }
    memcpy(weights, kept, count * sizeof *kept);
    free(kept);
    return five_point(values, h);
}

/// All the gradient, array by array: along the gradient itself, which misses no part of it, and along a random direction.
static void check_gradient(fixture *f, bat_random *random)
{
    real *gradient = calloc(f->parameters.total, sizeof *gradient);
    double *direction = malloc(f->parameters.total * sizeof *direction);
    assert_non_null(gradient);
    assert_non_null(direction);
    (void)loss_of(f, gradient);
    for (size_t p = 0; p < f->parameters.count; p++)
    {
        size_t first = f->parameters.list[p].offset, count = f->parameters.list[p].rows * f->parameters.list[p].columns;
        double length = 0;
        for (size_t i = 0; i < count; i++)
            length += (double)(gradient[first + i] * gradient[first + i]);
        length = sqrt(length);
        if (!(length > 1e-9))
            fail_msg("%s has no gradient: %g", f->parameters.list[p].name, length);
        for (int drawn = 0; drawn < 2; drawn++)
        {
            double along = 0;
            for (size_t i = 0; i < count; i++)
            {
                direction[i] =
                    drawn ? bat_random_normal(random) / sqrt((double)count) : (double)gradient[first + i] / length;
                along += direction[i] * (double)gradient[first + i];
            }
            check_near(along, slope_along(f, first, count, direction), 1e-6 * length + 1e-9);
        }
    }
    free(direction);
    free(gradient);
}

static void make_sample(fixture *f, geometry_surface surface, polygon_kind kind, size_t count, bool closed,
                        bat_random *random)
{
    make_truth(surface, f->truth);
    f->sample = (tension_sample){
        .control = make_polygon(surface, kind, count, random, f->points), .truth = f->truth, .truth_count = TRUTH};
    f->sample.control.closed = closed;
    f->fairness = bat_random_uniform(random);
}

static void gradients_are_limits_of_differences(void **state)
{
    (void)state;
    if (!DOUBLE)
        skip();
    static const size_t counts[] = {4, 5, 12};
    bat_random random = bat_random_seed(7); // no polygon's difference steps across the kink of a maximum
    fixture f = {.parameters = random_weights(3)};
    for (size_t s = 0; s < 3; s++)
        for (size_t c = 0; c < 3; c++)
            for (int closed = 0; closed < 2; closed++)
            {
                make_sample(&f, SURFACES[s], c == 1 ? EVEN : UNEVEN, counts[c], closed == 1, &random);
                f.steps = counts[c] < 12 ? 3 : 2;
                check_gradient(&f, &random);
            }
    learn_tape_free(&f.tape);
    learn_parameters_free(&f.parameters);
}

/// The total is the weighted sum, with the hinge where the distance exceeds the classical one.
static void check_total(fixture *f)
{
    curve_network_loss loss = loss_of(f, NULL);
    double distance = (double)*loss.distance->value;
    double fair = 0.1 * pow(30, pow(f->fairness, 1.25)),
           roughness = (double)*loss.bending->value + 0.8 * (double)*loss.angle->value;
    double total = distance * (distance > 1 ? 1.7 : 1) + fair * roughness;
    check_relative((double)*loss.total->value, total, DOUBLE ? 1e-13 : 1e-5);
}

static void the_total_is_the_weighted_sum(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    fixture f = {.parameters = random_weights(4), .steps = 3};
    for (size_t s = 0; s < 3; s++)
        for (size_t count = 4; count < 14; count += 3)
            for (int closed = 0; closed < 2; closed++)
            {
                make_sample(&f, SURFACES[s], EVEN, count, closed == 1, &random);
                check_total(&f);
            }
    learn_tape_free(&f.tape);
    learn_parameters_free(&f.parameters);
}

/// A network that begins its training is the six-point rule, to which the terms are relative, up to its bounds at corners.
static void the_six_point_rule_has_terms_near_one(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(6);
    fixture f = {.steps = 4};
    check_status(learned_network_make(&f.parameters, NULL), BAT_OK);
    learned_network_start(&f.parameters, 3);
    make_sample(&f, GEOMETRY_PLANE, EVEN, 12, true, &random);
    curve_network_loss loss = loss_of(&f, NULL);
    check_near((double)*loss.bending->value, log(0.5), 0.2);
    assert_true((double)*loss.angle->value < 1 && (double)*loss.angle->value > 0.5);
    assert_true((double)*loss.distance->value > 0.9);
    learn_tape_free(&f.tape);
    learn_parameters_free(&f.parameters);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_are_levels_of_refinement),        cmocka_unit_test(training_sets_out_from_the_six_point_rule),
        cmocka_unit_test(gradients_are_limits_of_differences),   cmocka_unit_test(the_total_is_the_weighted_sum),
        cmocka_unit_test(the_six_point_rule_has_terms_near_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
