// The outputs of the published program.

#include "hermite_helpers.h"

#include "base/memory.h"
#include "learn/safetensors.h"

static const char *const ORACLE = SHARED_DATA "/oracle/hermite/reference.safetensors";

/// One array of the file, in its own memory.
static double *array_of(const safetensors *content, const char *run, const char *part, size_t *rows)
{
    char name[128];
    (void)snprintf(name, sizeof name, "%s.%s", run, part);
    const safetensors_array *array = safetensors_find(content, name);
    assert_non_null(array);
    *rows = array->shape[0];
    double *values = malloc(array->count * sizeof *values);
    assert_non_null(values);
    check_status(safetensors_doubles(content, name, array->count, values, NULL), BAT_OK);
    return values;
}

/// A run on the sphere. The program counts its points of order m from (m - 1) / 2 steps of each level later than we do.
static void check_sphere(const safetensors *content, const char *run, bat_hermite_refine_options options,
                         const bat_hermite_linear *linear, bool closed)
{
    size_t count, fine_count, shift = ((options.order - 1) / 2) * (((size_t)1 << options.levels) - 1);
    bat_space sphere = bat_sphere(2);
    bat_hermite_curve coarse = {.space = &sphere, .closed = closed};
    coarse.points = array_of(content, run, "in.point", &coarse.count);
    coarse.tangents = array_of(content, run, "in.tangent", &count);
    double *points = array_of(content, run, "out.point", &fine_count);
    double *tangents = array_of(content, run, "out.tangent", &count);
    bat_hermite_curve fine;
    check_status(bat_hermite_transport_refine(&coarse, linear, &options, &fine, NULL), BAT_OK);
    assert_int_equal(fine.count, fine_count);
    for (size_t i = 0; i < fine.count; i++)
        for (size_t c = 0; c < 3; c++)
        {
            size_t ours = (i + shift) % fine.count;
            check_near(fine.points[3 * ours + c], points[3 * i + c], 1e-9);
            check_near(fine.tangents[3 * ours + c], tangents[3 * i + c], 1e-6);
        }
    bat_hermite_free(&fine);
    bat_hermite_free(&coarse);
    free(points);
    free(tangents);
}

/// The program's rotations are matrices R; its tangents are R^T dR, skew, of Frobenius norm 1: the rotation vector of length
/// 1 over sqrt 2. Their place in the matrix is that of the cross product.
static void check_rotation(const safetensors *content, const char *run, bat_hermite_refine_options options, bool closed)
{
    size_t count, fine_count;
    bat_space rotation = bat_rotation();
    double *matrices = array_of(content, run, "in.point", &count), *skew = array_of(content, run, "in.tangent", &count);
    double *points = array_of(content, run, "out.point", &fine_count),
           *tangents = array_of(content, run, "out.tangent", &fine_count);
    bat_hermite_curve coarse = {.space = &rotation, .count = count, .closed = closed};
    coarse.points = memory_array(count, 4 * sizeof(double));
    coarse.tangents = memory_array(count, 3 * sizeof(double));
    for (size_t i = 0; i < count; i++)
    {
        const double *m = skew + 9 * i;
        const double vector[3] = {m[7], m[2], m[3]};
        check_status(bat_rotation_nearest(matrices + 9 * i, coarse.points + 4 * i, NULL), BAT_OK);
        for (int c = 0; c < 3; c++)
            coarse.tangents[3 * i + (size_t)c] = sqrt(2) * vector[c];
    }
    bat_hermite_curve fine = hermite_refined(&coarse, &options);
    assert_int_equal(fine.count, fine_count);
    for (size_t i = 0; i < fine_count; i++)
    {
        double matrix[9];
        const double *m = tangents + 9 * i, *v = fine.tangents + 3 * i;
        bat_rotation_to_matrix(fine.points + 4 * i, matrix);
        for (int k = 0; k < 9; k++)
            check_near(matrix[k], points[9 * i + (size_t)k], 1e-9);
        check_near(v[0], sqrt(2) * m[7], 1e-6);
        check_near(v[1], sqrt(2) * m[2], 1e-6);
        check_near(v[2], sqrt(2) * m[3], 1e-6);
    }
    bat_hermite_free(&fine);
    bat_hermite_free(&coarse);
    free(matrices);
    free(skew);
    free(points);
    free(tangents);
}

static void oracle_is_met(void **state)
{
    (void)state;
    safetensors content;
    if (safetensors_read(ORACLE, &content, NULL) != BAT_OK)
    {
        print_message("skipped: %s is not there\n", ORACLE);
        skip();
    }
    bat_hermite_refine_options options = bat_hermite_refine_defaults();
    options.levels = 4;
    check_sphere(&content, "sphere-spiral-lr1-levels4", options, NULL, false);
    options.levels = 3;
    check_sphere(&content, "sphere-geodesic-lr1-levels3", options, NULL, false);
    check_sphere(&content, "sphere-sinusoid-closed-lr1-levels3", options, NULL, true);
    check_rotation(&content, "rotation-curve-closed-lr1-levels3", options, true);
    options.order = 3;
    check_sphere(&content, "sphere-sinusoid-closed-lr3-levels3", options, NULL, true);
    options.order = 1;
    const bat_hermite_linear linear = {bat_hermite_mask_merrien(-0.125, -0.5), BAT_CURVE_BASE_VERTEX};
    check_sphere(&content, "sphere-sinusoid-closed-parallel-transport-levels3", options, &linear, true);
    safetensors_free(&content);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(oracle_is_met)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
