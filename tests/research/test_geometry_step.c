#include "geometry_helpers.h"
#include "reference_network.h"
#include "research/train/geometry_feature.h"
#include "research/train/geometry_insert.h"
#include "research/train/geometry_loss.h"

#include <jansson.h>

// One training step of the tension paper, composed of the differentiable geometry and a reference network, against values of
// the published program's formulas in double.

#define ORACLE SHARED_DATA "/oracle/tension/"

enum
{
    CONTROL = 12,
    LEVELS = 4,
    FINEST = CONTROL << 3,
    SHARED_TRUTH = 1000,
};

/// A measure with its derivative.
typedef struct measure
{
    void (*forward)(const geometry_polygon *polygon, geometry_profile profile);
    void (*backward)(const geometry_polygon *polygon, geometry_profile gradient, double *point_gradients);
} measure;

static const measure SHIPPED = {geometry_measure, geometry_measure_back};

static double dot(const double *u, const double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/// The part of v orthogonal to p if p has unit length.
static void orthogonal_part(const double *p, const double *v, double *part)
{
    double along = dot(p, v);
    for (int i = 0; i < 3; i++)
        part[i] = v[i] - along * p[i];
}

/// The published program's angle and length on the sphere. The stored points were rounded to single precision, so that
/// formulas which agree for unit vectors differ in the seventh digit.
static void published_vertex(const double *before, const double *p, const double *after, double *angle, double *length)
{
    double back[3], out[3];
    orthogonal_part(p, before, back);
    orthogonal_part(p, after, out);
    normalize(back);
    normalize(out);
    double sine = p[0] * (out[1] * back[2] - out[2] * back[1]) + p[1] * (out[2] * back[0] - out[0] * back[2]) +
                  p[2] * (out[0] * back[1] - out[1] * back[0]);
    *angle = atan2(sine, -dot(back, out));
    *length = acos(dot(p, after));
}

static void published_measure(const geometry_polygon *polygon, geometry_profile profile)
{
    size_t count = polygon->count;
    for (size_t j = 0; j < count; j++)
        published_vertex(polygon->points + 3 * ((j + count - 1) % count), polygon->points + 3 * j,
                         polygon->points + 3 * ((j + 1) % count), &profile.angles[j], &profile.lengths[j]);
}

/// By finite differences.
static void published_measure_back(const geometry_polygon *polygon, geometry_profile gradient, double *point_gradients)
{
    size_t count = polygon->count;
    const double h = 5e-6;
    for (size_t j = 0; j < count; j++)
        for (size_t i = 0; i < 9; i++)
        {
            size_t moved = (j + count - 1 + i / 3) % count;
            double points[9], angles[4], lengths[4];
            for (size_t k = 0; k < 3; k++)
                memcpy(points + 3 * k, polygon->points + 3 * ((j + count - 1 + k) % count), 3 * sizeof(double));
            double kept = points[i];
            for (int k = 0; k < 4; k++)
            {
                points[i] = kept + FIVE_POINT_STEPS[k] * h;
                published_vertex(points, points + 3, points + 6, &angles[k], &lengths[k]);
            }
            point_gradients[3 * moved + i % 3] +=
                gradient.angles[j] * five_point(angles, h) + gradient.lengths[j] * five_point(lengths, h);
        }
}

static const measure PUBLISHED = {published_measure, published_measure_back};

/// A level of the refined polygon with everything that belongs to it.
typedef struct level
{
    geometry_polygon polygon;
    double points[3 * FINEST], point_gradients[3 * FINEST];
    double angles[FINEST], lengths[FINEST], angle_gradients[FINEST], length_gradients[FINEST];
    double features[FINEST * GEOMETRY_PUBLISHED_FEATURES];
    double insertion[FINEST], insertion_gradients[FINEST];
    network_pass pass;
} level;

static geometry_profile profile_of(level *l)
{
    return (geometry_profile){l->angles, l->lengths};
}

static geometry_profile gradient_of(level *l)
{
    return (geometry_profile){l->angle_gradients, l->length_gradients};
}

typedef struct losses
{
    double chamfer, smoothness, bending, total;
} losses;

static level *make_levels(geometry_surface surface, const double *control)
{
    level *levels = calloc(LEVELS, sizeof *levels);
    assert_non_null(levels);
    for (size_t k = 0; k < LEVELS; k++)
        levels[k].polygon = (geometry_polygon){levels[k].points, (size_t)CONTROL << k, surface, true};
    memcpy(levels[0].points, control, CONTROL * geometry_dim(surface) * sizeof(double));
    return levels;
}

/// Warm up with tension -0.15 and the sign as printed, then two learned steps (Algorithm 1).
static void forward(level *levels, const network *net, const measure *by)
{
    by->forward(&levels[0].polygon, profile_of(&levels[0]));
    geometry_tension_angles(&levels[0].polygon, profile_of(&levels[0]), -0.15, BAT_CURVE_ANGLE_SIGN_PRINTED,
                            levels[0].insertion);
    geometry_insert(&levels[0].polygon, levels[0].insertion, levels[1].points);
    for (size_t k = 1; k < LEVELS - 1; k++)
    {
        level *l = &levels[k];
        by->forward(&l->polygon, profile_of(l));
        geometry_published_features(&l->polygon, profile_of(l), l->features, GEOMETRY_PUBLISHED_FEATURES);
        network_forward(net, l->polygon.count, l->features, &l->pass, l->insertion);
        geometry_insert(&l->polygon, l->insertion, levels[k + 1].points);
    }
    by->forward(&levels[LEVELS - 1].polygon, profile_of(&levels[LEVELS - 1]));
}

/// Eq. (18) without its last term, with the gradients at the finest level.
static losses loss(level *finest, const double *truth, const measure *by)
{
    const geometry_polygon *polygon = &finest->polygon;
    geometry_profile profile = profile_of(finest), gradient = gradient_of(finest);
    size_t dim = geometry_dim(polygon->surface), of_points[FINEST], of_truth[SHARED_TRUTH];
    geometry_matches matches = {of_points, of_truth};
    double smoothness_weight = polygon->surface == GEOMETRY_SPHERE ? 0.15 : 0.05, bending_weight = 1e-4;
    losses made = {.chamfer = geometry_chamfer(polygon->points, polygon->count, truth, SHARED_TRUTH, dim, matches),
                   .smoothness = geometry_smoothness(polygon, profile),
                   .bending = geometry_bending(polygon, profile, 1e-7)};
    made.total = made.chamfer + smoothness_weight * made.smoothness + bending_weight * made.bending;
    geometry_smoothness_back(polygon, profile, smoothness_weight, gradient);
    geometry_bending_back(polygon, profile, 1e-7, bending_weight, gradient);
    by->backward(polygon, gradient, finest->point_gradients);
    geometry_chamfer_back(polygon->points, polygon->count, truth, SHARED_TRUTH, dim, matches, 1, finest->point_gradients);
    return made;
}

static void backward(level *levels, network *net, const measure *by)
{
    for (size_t k = LEVELS - 2; k >= 1; k--)
    {
        level *l = &levels[k];
        double g_features[FINEST * GEOMETRY_PUBLISHED_FEATURES] = {0};
        geometry_insert_back(&l->polygon, l->insertion, levels[k + 1].point_gradients, k > 1 ? l->point_gradients : NULL,
                             l->insertion_gradients);
        network_backward(net, &l->pass, l->insertion_gradients, g_features);
        if (k == 1)
            return;
        geometry_published_features_back(&l->polygon, profile_of(l), g_features, GEOMETRY_PUBLISHED_FEATURES,
                                         gradient_of(l));
        by->backward(&l->polygon, gradient_of(l), l->point_gradients);
    }
}

/// Compare with an array of the file, relative to its largest entry.
static void check_array(const safetensors *file, const char *space, const char *name, const double *actual, size_t count,
                        double tolerance)
{
    char full[128];
    double *expected = malloc(count * sizeof *expected), largest = 0;
    snprintf(full, sizeof full, "%s%s", space, name);
    check_status(safetensors_doubles(file, full, count, expected, NULL), BAT_OK);
    for (size_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(expected[i]));
    for (size_t i = 0; i < count; i++)
        check_near(actual[i], expected[i], tolerance * largest);
    free(expected);
}

static void zero_gradient(parameter *p, const char *name, void *context)
{
    (void)name;
    (void)context;
    memset(p->gradient, 0, p->count * sizeof(double));
}

typedef struct tolerances
{
    double points, values, gradients;
} tolerances;

static void check_step(const safetensors *file, json_t *expected, network *net, geometry_surface surface, const measure *by,
                       tolerances to)
{
    const char *space = json_string_value(json_object_get(expected, "geometry"));
    double control[3 * CONTROL], truth[3 * SHARED_TRUTH];
    char name[64];
    size_t dim = geometry_dim(surface);
    snprintf(name, sizeof name, "%s.control", space);
    check_status(safetensors_doubles(file, name, CONTROL * dim, control, NULL), BAT_OK);
    snprintf(name, sizeof name, "%s.truth", space);
    check_status(safetensors_doubles(file, name, SHARED_TRUTH * dim, truth, NULL), BAT_OK);
    level *levels = make_levels(surface, control);
    for_parameters(net, zero_gradient, NULL);
    forward(levels, net, by);
    losses made = loss(&levels[LEVELS - 1], truth, by);
    backward(levels, net, by);
    check_array(file, space, ".level1", levels[1].points, 2 * CONTROL * dim, to.points);
    check_array(file, space, ".features.level1", levels[1].features, 2 * CONTROL * GEOMETRY_PUBLISHED_FEATURES, to.values);
    check_array(file, space, ".level3", levels[3].points, FINEST * dim, to.points);
    check_relative(made.chamfer, json_real_value(json_object_get(expected, "chamfer")), to.values);
    check_relative(made.smoothness, json_real_value(json_object_get(expected, "smoothness")), to.values);
    check_relative(made.bending, json_real_value(json_object_get(expected, "bending")), to.values);
    check_relative(made.total, json_real_value(json_object_get(expected, "loss")), to.values);
    check_array(file, space, ".grad.input_proj.0.weight", net->project.linear.weight.gradient, WIDTH * INPUTS, to.gradients);
    check_array(file, space, ".grad.geom_embed.weight", net->embedding.gradient, 24, to.gradients);
    check_array(file, space, ".grad.head.2.weight", net->last.weight.gradient, HEAD, to.gradients);
    free(levels);
}

/// The files of a test, or null where they are absent.
typedef struct oracle
{
    safetensors weights, step;
    json_t *values;
    network net;
} oracle;

static oracle *load_oracle(void)
{
    oracle *o = calloc(1, sizeof *o);
    assert_non_null(o);
    o->values = json_load_file(ORACLE "training-step.json", 0, NULL);
    if (o->values == NULL)
    {
        print_message("no %s: skipped\n", ORACLE "training-step.json");
        free(o);
        return NULL;
    }
    check_status(safetensors_read(ORACLE "network.safetensors", &o->weights, NULL), BAT_OK);
    check_status(safetensors_read(ORACLE "training-step.safetensors", &o->step, NULL), BAT_OK);
    o->net = load_network(&o->weights);
    return o;
}

static void free_oracle(oracle *o)
{
    free_network(&o->net);
    safetensors_free(&o->weights);
    safetensors_free(&o->step);
    json_decref(o->values);
    free(o);
}

static void check_gradient(parameter *p, const char *name, void *context)
{
    check_array(context, "grad.", name, p->gradient, p->count, 1e-12);
}

/// The reference network itself, for the loss that is the sum of the squared angles.
static void reference_network_is_the_published_one(void **state)
{
    (void)state;
    oracle *o = load_oracle();
    if (o == NULL)
        skip();
    double features[REFERENCE_ROWS * 7], angles[REFERENCE_ROWS], gradients[REFERENCE_ROWS * 7];
    network_pass *pass = malloc(sizeof *pass);
    check_status(safetensors_doubles(&o->weights, "features", REFERENCE_ROWS * 7, features, NULL), BAT_OK);
    network_forward(&o->net, REFERENCE_ROWS, features, pass, angles);
    check_array(&o->weights, "", "angles", angles, REFERENCE_ROWS, 1e-13);
    for (size_t i = 0; i < REFERENCE_ROWS; i++)
        angles[i] *= 2;
    network_backward(&o->net, pass, angles, gradients);
    for_parameters(&o->net, check_gradient, &o->weights);
    free(pass);
    free_oracle(o);
}

static void step_of(size_t index, geometry_surface surface, const measure *by, tolerances to)
{
    oracle *o = load_oracle();
    if (o == NULL)
        skip();
    check_step(&o->step, json_array_get(o->values, index), &o->net, surface, by, to);
    free_oracle(o);
}

static void step_in_the_plane(void **state)
{
    (void)state;
    step_of(0, GEOMETRY_PLANE, &SHIPPED, (tolerances){1e-14, 1e-13, 1e-11});
}

static void step_on_the_sphere(void **state)
{
    (void)state;
    step_of(1, GEOMETRY_SPHERE, &PUBLISHED, (tolerances){1e-14, 1e-11, 1e-9});
}

/// By formulas that are right for unit vectors only to the rounding of the stored points to single precision.
static void step_on_the_sphere_by_accurate_formulas(void **state)
{
    (void)state;
    step_of(1, GEOMETRY_SPHERE, &SHIPPED, (tolerances){1e-8, 2e-6, 1e-5});
}

static void step_in_the_disk(void **state)
{
    (void)state;
    step_of(2, GEOMETRY_DISK, &SHIPPED, (tolerances){1e-14, 1e-13, 1e-11});
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reference_network_is_the_published_one),
        cmocka_unit_test(step_in_the_plane),
        cmocka_unit_test(step_on_the_sphere),
        cmocka_unit_test(step_on_the_sphere_by_accurate_formulas),
        cmocka_unit_test(step_in_the_disk),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
