#include "check.h"

#include "batten/research/curve_study.h"
#include "research/learn/parameters.h"
#include "research/networks/tension_network.h"
#include "research/studies/spectral_norm.h"
#include "research/train/tension_sample.h"

#include <unistd.h>

// Effective tensions, gradients by features, spectral norms.

static void spectral_norms_are_largest_singular_values(void **state)
{
    (void)state;
    double norm;
    const double diagonal[] = {3, 0, 0, 0, -7, 0};
    check_status(spectral_norm(2, 3, diagonal, &norm, NULL), BAT_OK);
    check_relative(norm, 7.0, 1e-12);
    // The golden ratio.
    const double shear[] = {1, 1, 0, 1};
    check_status(spectral_norm(2, 2, shear, &norm, NULL), BAT_OK);
    check_relative(norm, 0.5 * (1 + sqrt(5)), 1e-12);
    // Of rank one: |u| |v|. All singular values alike: a rotation.
    const double outer[] = {2, 4, 4, 3, 6, 6};
    check_status(spectral_norm(2, 3, outer, &norm, NULL), BAT_OK);
    check_relative(norm, 3 * sqrt(13), 1e-12);
    const double turn[] = {0.6, -0.8, 0.8, 0.6};
    check_status(spectral_norm(2, 2, turn, &norm, NULL), BAT_OK);
    check_relative(norm, 1.0, 1e-12);
    const double zero[] = {0, 0, 0};
    check_status(spectral_norm(1, 3, zero, &norm, NULL), BAT_OK);
    check_near(norm, 0, 0);
}

/// A network with a file.
typedef struct fixture
{
    learn_parameters parameters;
    char path[40];
} fixture;

static fixture fixture_make(bat_tension_embedding embedding)
{
    fixture f = {.path = "/tmp/batten-mechanism-XXXXXX"};
    int file = mkstemp(f.path);
    assert_true(file >= 0);
    (void)close(file);
    check_status(tension_predictor_make(embedding, &f.parameters, NULL), BAT_OK);
    return f;
}

static void fixture_free(fixture *f)
{
    learn_parameters_free(&f->parameters);
    (void)unlink(f->path);
}

static bat_tension_mechanism_report report_of(const fixture *f, const bat_tension_mechanism_options *options)
{
    bat_tension_mechanism_report report;
    check_status(learn_parameters_write(&f->parameters, f->path, NULL, 0, NULL), BAT_OK);
    check_status(bat_tension_mechanism(f->path, options, &report, NULL), BAT_OK);
    return report;
}

static double cut_off(double tension)
{
    return fmin(fmax(tension, BAT_TENSION_EFFECTIVE_MIN), BAT_TENSION_EFFECTIVE_MAX);
}

/// The mean for angles of 0 on the control polygons, by the library's own angles.
static double mean_of_midpoints(const bat_tension_set *set, const bat_space *space, size_t curves, size_t *undefined)
{
    double angles[BAT_TENSION_CONTROL_POINTS], sum = 0, count = 0;
    const size_t n = BAT_TENSION_CONTROL_POINTS;
    for (size_t i = 0; i < curves; i++)
    {
        bat_curve control = bat_tension_control(set, i, space);
        check_status(bat_curve_exterior_angles(&control, angles, NULL), BAT_OK);
        for (size_t j = 0; j < n; j++)
        {
            double outer = angles[(j + n - 1) % n] + angles[(j + 2) % n], inner = angles[j] + angles[(j + 1) % n];
            if (fabs(outer - inner) < 8e-6)
            {
                ++*undefined;
                continue;
            }
            sum += cut_off(-inner / (outer - inner));
            count++;
        }
    }
    return sum / count;
}

/// Weights of zero insert midpoints: no gradient, no norms, and both signs alike.
static void midpoints_have_the_tension_that_makes_angles_zero(void **state)
{
    (void)state;
    fixture f = fixture_make(BAT_TENSION_EMBEDDING_LEARNED);
    bat_tension_mechanism_options options = bat_tension_mechanism_defaults();
    options.levels = 1;
    bat_tension_mechanism_report report = report_of(&f, &options);
    bat_tension_data data;
    check_status(bat_tension_data_make(&data, NULL), BAT_OK);
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    check_near(report.product, 0, 0);
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        const bat_tension_mechanism_space *space = &report.spaces[s];
        size_t undefined = 0;
        double mean = mean_of_midpoints(&data.validation[s], &spaces[s], options.curves, &undefined);
        check_near(space->printed.summary.mean, mean, 1e-9);
        check_near(space->outward.summary.mean, space->printed.summary.mean, 1e-15);
        assert_int_equal(space->printed.insertions, 60 * BAT_TENSION_CONTROL_POINTS);
        assert_int_equal(space->printed.undefined, undefined);
        check_near(space->largest_gradient, 0, 0);
        check_near(space->centre, 0, 0);
    }
    bat_tension_data_free(&data);
    fixture_free(&f);
}

static void check_distribution(const bat_tension_effective *e, size_t insertions)
{
    size_t sum = 0;
    for (size_t i = 0; i < BAT_TENSION_EFFECTIVE_BINS; i++)
        sum += e->histogram[i];
    assert_int_equal(e->insertions, insertions);
    assert_int_equal(sum, insertions - e->undefined);
    assert_int_equal(e->summary.count, sum);
    assert_true(e->histogram[0] >= e->below && e->histogram[BAT_TENSION_EFFECTIVE_BINS - 1] >= e->above);
    check_near(cut_off(e->quantiles[2]), e->summary.median, 1e-12);
    for (size_t q = 1; q < 5; q++)
        assert_true(e->quantiles[q - 1] <= e->quantiles[q]);
    assert_true((double)e->below <= 0.25 * (double)sum || e->quantiles[1] < BAT_TENSION_EFFECTIVE_MIN);
}

/// Every kind of network, at the weights that training begins with.
static void distributions_hold_together(void **state)
{
    (void)state;
    bat_tension_mechanism_options options = {.curves = 5, .levels = 3};
    for (int kind = 0; kind < 3; kind++)
    {
        fixture f = fixture_make((bat_tension_embedding)kind);
        tension_network_start(&f.parameters, 3);
        bat_tension_mechanism_report report = report_of(&f, &options);
        double product = 1;
        for (size_t i = 0; i < BAT_TENSION_LAYERS; i++)
        {
            assert_true(report.layers[i] > 0.1 && report.layers[i] < 10);
            product *= report.layers[i];
        }
        check_relative(report.product, product, 1e-12);
        for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        {
            check_distribution(&report.spaces[s].printed, 5 * BAT_TENSION_CONTROL_POINTS * 7);
            check_distribution(&report.spaces[s].outward, 5 * BAT_TENSION_CONTROL_POINTS * 7);
        }
        fixture_free(&f);
    }
}

/// On the flat part of the sigmoid the gradient goes with the last layer's weights.
static void gradients_go_with_the_last_layer(void **state)
{
    (void)state;
    fixture f = fixture_make(BAT_TENSION_EMBEDDING_ONE_HOT);
    tension_network_start(&f.parameters, 4);
    const learn_parameter *last = &f.parameters.list[f.parameters.count - 2];
    assert_int_equal(last->columns, TENSION_HEAD);
    bat_tension_mechanism_options options = {.curves = 3, .levels = 1};
    double gradients[2];
    for (int i = 0; i < 2; i++)
    {
        double factor = i == 0 ? 1e-4 : 0.5;
        for (size_t k = 0; k < TENSION_HEAD; k++)
            f.parameters.values[last->offset + k] = (real)(factor * (double)f.parameters.values[last->offset + k]);
        bat_tension_mechanism_report report = report_of(&f, &options);
        gradients[i] = report.spaces[BAT_TENSION_SPACE_SPHERE].largest_gradient;
    }
    assert_true(gradients[0] > 0);
    check_relative(gradients[1], 0.5 * gradients[0], 1e-4);
    fixture_free(&f);
}

static bool stop(void *context, double fraction)
{
    (void)context;
    (void)fraction;
    return false;
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    fixture f = fixture_make(BAT_TENSION_EMBEDDING_LEARNED);
    bat_tension_mechanism_options options = bat_tension_mechanism_defaults();
    bat_tension_mechanism_report report;
    bat_error error;
    check_status(bat_tension_mechanism(f.path, &options, &report, &error), BAT_BAD_FILE);
    check_status(bat_tension_mechanism("/tmp/no/such/file", &options, &report, &error), BAT_FILE_ACCESS);
    check_status(learn_parameters_write(&f.parameters, f.path, NULL, 0, NULL), BAT_OK);
    options.progress = (bat_progress){stop, NULL};
    check_status(bat_tension_mechanism(f.path, &options, &report, &error), BAT_CANCELLED);
    options.levels = 0;
    check_status(bat_tension_mechanism(f.path, &options, &report, &error), BAT_INVALID_ARGUMENT);
    options = bat_tension_mechanism_defaults();
    options.curves = 0;
    check_status(bat_tension_mechanism(f.path, &options, &report, &error), BAT_INVALID_ARGUMENT);
    fixture_free(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spectral_norms_are_largest_singular_values),
        cmocka_unit_test(midpoints_have_the_tension_that_makes_angles_zero),
        cmocka_unit_test(distributions_hold_together),
        cmocka_unit_test(gradients_go_with_the_last_layer),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
