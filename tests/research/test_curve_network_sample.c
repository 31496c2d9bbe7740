// The shipped rule on a tape: one step against the refinement that users get, and the loss against the library's measures
// and central differences. Built in single and double precision.

#include "learned_helpers.h"

#include "batten/curve_measure.h"
#include "research/train/curve_network_tape.h"

static const bool DOUBLE = sizeof(real) == sizeof(double);

enum
{
    TRUTH = 90
};

// A step

/// A level of bat_curve_refine() against a step on the tape.
static void check_step(learn_tape *tape, const learn_parameters *parameters, const geometry_polygon *polygon,
                       double fairness)
{
    bat_space space = space_of(polygon->surface);
    const bat_curve_angle_rule rule = learned_rule(parameters->values);
    bat_curve coarse = {
        .space = &space, .points = (double *)(uintptr_t)polygon->points, .count = polygon->count, .closed = polygon->closed};
    bat_curve_refine_options how = by_rule(&rule, fairness, 1);
    bat_curve fine = refined(&coarse, &how);
    learn_tape_begin(tape, parameters, NULL);
    tape_polygon *stepped = curve_network_step(tape, tape_polygon_given(tape, polygon), fairness);
    check_status(learn_tape_status(tape, NULL), BAT_OK);
    assert_int_equal(stepped->shape.count, fine.count);
    assert_true(stepped->shape.closed == polygon->closed);
    for (size_t i = 0; i < fine.count * space.point_dim; i++)
        check_near(stepped->shape.points[i], fine.points[i], DOUBLE ? 1e-11 : 2e-6);
    bat_curve_free(&fine);
}

static void a_step_is_a_level_of_refinement(void **state)
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
    const learn_array *said = learned_network_apply(&tape, learn_constant(&tape, 3, LEARNED_FEATURES, features));
    assert_int_equal(said->rows, 3);
    assert_int_equal(said->columns, 1);
    for (size_t r = 0; r < 3; r++)
        check_near((double)said->value[r], 0, 0);
    learn_tape_free(&tape);
    learn_parameters_free(&parameters);
}

// The loss

static const curve_loss_weights WEIGHTS = {.distance_unit = {0.5, 0.7, 0.2},
                                           .bending_unit = {10, 4, 2},
                                           .angle_unit = {0.3, 0.4, 0.6},
                                           .min_roughness = 0.1,
                                           .max_roughness = 3,
                                           .angle = 0.8};

static bat_tension_space space_number(geometry_surface surface)
{
    return surface == GEOMETRY_PLANE    ? BAT_TENSION_PLANE
           : surface == GEOMETRY_SPHERE ? BAT_TENSION_SPHERE
                                        : BAT_TENSION_DISK;
}

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
    bat_tension_space space;
    size_t steps;
    double fairness;
} fixture;

static curve_network_loss loss_of(fixture *f, real *gradient)
{
    learn_tape_begin(&f->tape, &f->parameters, gradient);
    curve_network_loss loss = curve_network_sample_loss(&f->tape, &f->sample, f->space, f->steps, f->fairness, &WEIGHTS);
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
        assert_true(length > 1e-9);
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
    f->space = space_number(surface);
    f->fairness = bat_random_uniform(random);
}

static void gradients_are_limits_of_differences(void **state)
{
    (void)state;
    if (!DOUBLE)
        skip();
    static const size_t counts[] = {4, 5, 12};
    bat_random random = bat_random_seed(5); // no polygon's difference steps across the kink of a maximum
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

/// Of the polygon that the library refines to.
static void check_terms(fixture *f)
{
    curve_network_loss loss = loss_of(f, NULL);
    bat_space space = space_of(f->sample.control.surface);
    const bat_curve_angle_rule rule = learned_rule(f->parameters.values);
    bool closed = f->sample.control.closed;
    bat_curve coarse = {.space = &space, .points = f->points, .count = f->sample.control.count, .closed = closed};
    bat_curve truth = {.space = &space, .points = f->truth, .count = TRUTH, .closed = true};
    bat_curve_refine_options how = by_rule(&rule, f->fairness, f->steps);
    bat_curve fine = refined(&coarse, &how);
    bat_curve_distance distance;
    bat_curve_fairness_values fairness;
    check_status(bat_curve_compare(&fine, &truth, NULL, &distance, NULL), BAT_OK);
    check_status(bat_curve_fairness(&fine, NULL, &fairness, NULL), BAT_OK);
    double expected_distance = closed ? distance.mean_symmetric : distance.mean_nn, tolerance = DOUBLE ? 1e-9 : 1e-3;
    check_relative((double)*loss.distance->value, expected_distance, tolerance);
    check_near((double)*loss.bending->value, log(fairness.bending / (fairness.bending + WEIGHTS.bending_unit[f->space])),
               tolerance);
    // A power mean with a large power is near the largest angle, and never above.
    double angle = (double)*loss.angle->value;
    assert_true(angle <= fairness.g1 * (1 + tolerance) && angle > 0.7 * fairness.g1);
    double unit = WEIGHTS.angle_unit[f->space] * 384 / (double)fine.count;
    double fair = 0.1 * pow(30, f->fairness), total = (double)*loss.distance->value / WEIGHTS.distance_unit[f->space] +
                                                      fair * ((double)*loss.bending->value + 0.8 * angle / unit);
    check_relative((double)*loss.total->value, total, DOUBLE ? 1e-13 : 1e-5);
    bat_curve_free(&fine);
}

static void terms_are_the_librarys_measures(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    fixture f = {.parameters = random_weights(4), .steps = 3};
    for (size_t s = 0; s < 3; s++)
        for (size_t count = 4; count < 14; count += 3)
            for (int closed = 0; closed < 2; closed++)
            {
                make_sample(&f, SURFACES[s], EVEN, count, closed == 1, &random);
                check_terms(&f);
            }
    learn_tape_free(&f.tape);
    learn_parameters_free(&f.parameters);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_is_a_level_of_refinement),
        cmocka_unit_test(training_sets_out_from_the_six_point_rule),
        cmocka_unit_test(gradients_are_limits_of_differences),
        cmocka_unit_test(terms_are_the_librarys_measures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
