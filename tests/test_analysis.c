// What is known of the classical schemes, and invariances and brute force for all others.

#include "check.h"

#include "batten/analysis.h"

static bat_analysis analyze(bat_mask mask)
{
    bat_analysis analysis;
    bat_error error = {.text = ""};
    if (bat_mask_analyze(&mask, NULL, &analysis, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return analysis;
}

static bat_analysis analyze_to_depth(bat_mask mask, size_t depth)
{
    bat_analysis_options options = bat_analysis_defaults();
    options.depth = depth;
    bat_analysis analysis;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_OK);
    return analysis;
}

static double weight(const bat_stencil *stencil, int offset)
{
    const int k = offset - stencil->first;
    return k >= 0 && k < (int)stencil->count ? stencil->weights[k] : 0.0;
}

/// A mask of `count` random coefficients, averaged `smoothings` times, which makes its scheme converge.
static bat_mask random_mask(bat_random *random, size_t count, size_t smoothings, int first)
{
    bat_mask mask = {.count = count, .first = first};
    double sum = 0.0;
    for (size_t k = 0; k < count; ++k)
    {
        mask.coefficients[k] = bat_random_uniform(random) + 0.1;
        sum += mask.coefficients[k];
    }
    for (size_t k = 0; k < count; ++k)
        mask.coefficients[k] *= 2.0 / sum;
    for (size_t s = 0; s < smoothings; ++s)
    {
        for (size_t k = mask.count; k > 0; --k)
            mask.coefficients[k] = 0.5 * ((k < mask.count ? mask.coefficients[k] : 0.0) + mask.coefficients[k - 1]);
        mask.coefficients[0] *= 0.5;
        ++mask.count;
    }
    return mask;
}

static bat_mask reversed(const bat_mask *mask)
{
    bat_mask result = {.count = mask->count, .first = 1 - mask->first - (int)mask->count};
    for (size_t k = 0; k < mask->count; ++k)
        result.coefficients[k] = mask->coefficients[mask->count - 1 - k];
    return result;
}

// Exact facts about the classical schemes.

static void chaikin_is_the_quadratic_spline(void **state)
{
    (void)state;
    bat_analysis a = analyze(bat_mask_chaikin());
    assert_int_equal(a.multiplicity, 3);
    assert_int_equal(a.quotient.count, 1);
    check_near(a.quotient.coefficients[0], 0.25, 0.0);
    assert_int_equal(a.generation_degree, 2);
    assert_int_equal(a.reproduction_degree, 1);
    check_near(a.shift, -0.5, 0.0);
    // Alam 2025, section 3.2: matrix [3 1; 1 3] / 4, eigenvalues 1 and 1/2, eigenvectors (1, 1) and (-1, 1).
    assert_int_equal(a.matrix_first, 0);
    assert_int_equal(a.matrix_size, 2);
    const double matrix[] = {0.75, 0.25, 0.25, 0.75};
    assert_memory_equal(a.matrix, matrix, sizeof matrix);
    assert_int_equal(a.eigenvalue_count, 2);
    check_near(a.eigenvalues[1].real, 0.5, 0.0);
    const double *second = a.eigenvectors + 4 * a.eigenvalues[1].vector;
    check_near(second[0], -1.0, 1e-14);
    check_near(second[2], 1.0, 1e-14);
    check_near(weight(&a.limit, 0), 0.5, 1e-15);
    check_near(weight(&a.limit, 1), 0.5, 1e-15);
    check_near(weight(&a.tangent, 0), -1.0, 1e-14);
    check_near(weight(&a.tangent, 1), 1.0, 1e-14);
    check_near(weight(&a.vertex, -1), 1.0 / 8.0, 1e-15);
    check_near(weight(&a.vertex, 0), 6.0 / 8.0, 1e-15);
    check_near(weight(&a.vertex, 1), 1.0 / 8.0, 1e-15);
    assert_int_equal(a.converges, BAT_PROVEN);
    assert_true(a.is_stable);
    check_near(a.exponent_lower, 2.0, 0.0);
    check_near(a.exponent_upper, 2.0, 0.0);
    assert_int_equal(a.smooth_proven, 1);
    assert_int_equal(a.smooth_disproven, 2);
    assert_int_equal(a.lipschitz, BAT_PROVEN);
    bat_analysis_free(&a);
}

static void corner_cutting_has_its_limit_stencil(void **state)
{
    (void)state;
    const double cuts[][2] = {{0.3, 0.7}, {0.2, 0.6}, {0.05, 0.9}, {0.4, 0.45}};
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; ++i)
    {
        const double r = cuts[i][0], s = cuts[i][1];
        bat_analysis a = analyze(bat_mask_corner_cutting(r, s));
        assert_int_equal(a.converges, BAT_PROVEN);
        check_near(weight(&a.limit, 0), (1.0 - s) / (1.0 - s + r), 1e-14);
        check_near(weight(&a.limit, 1), r / (1.0 - s + r), 1e-14);
        check_near(a.eigenvalues[1].real, s - r, 1e-14);
        assert_int_equal(a.multiplicity, 1);
        assert_int_equal(a.smooth_proven, 0);
        assert_int_equal(a.smooth_disproven, 1);
        assert_true(a.exponent_upper < 1.0);
        bat_analysis_free(&a);
    }
}

static void corner_cutting_is_smooth_where_edges_halve(void **state)
{
    (void)state;
    // 1 + z divides the difference mask [r, s - r, 1 - s] exactly when s - r = 1/2; then the second differences are refined by
    // [r, 1 - s], so that the exponent is -log2 max(r, 1 - s). Of these, only Chaikin's ratios are symmetric.
    for (int i = 1; i < 10; ++i)
    {
        const double r = 0.05 * i;
        bat_analysis a = analyze(bat_mask_corner_cutting(r, r + 0.5));
        assert_int_equal(a.smooth_proven, 1);
        assert_int_equal(a.smooth_disproven, 2);
        check_near(a.exponent_lower, -log2(fmax(r, 0.5 - r)), 1e-12);
        check_near(a.exponent_upper, -log2(fmax(r, 0.5 - r)), 1e-12);
        assert_int_equal(a.is_symmetric, i == 5);
        bat_analysis_free(&a);
    }
}

static void four_point_is_just_not_twice_differentiable(void **state)
{
    (void)state;
    bat_analysis a = analyze(bat_mask_four_point(1.0 / 16.0));
    assert_int_equal(a.generation_degree, 3);
    assert_int_equal(a.reproduction_degree, 3);
    // Alam 2025, section 5.2: eigenvalues 1, 1/2, 1/4, 1/4, 1/8. There is no second eigenvector for 1/4, against the paper's zero.
    assert_int_equal(a.matrix_size, 5);
    assert_int_equal(a.matrix_first, -2);
    const double values[] = {1.0, 0.5, 0.25, 0.125};
    const size_t multiplicities[] = {1, 1, 2, 1};
    assert_int_equal(a.eigenvalue_count, 4);
    for (size_t e = 0; e < 4; ++e)
    {
        check_near(a.eigenvalues[e].real, values[e], 1e-15);
        check_near(a.eigenvalues[e].imaginary, 0.0, 0.0);
        assert_int_equal(a.eigenvalues[e].multiplicity, multiplicities[e]);
        assert_int_equal(a.eigenvalues[e].vector_count, 1);
    }
    for (int i = 0; i < 5; ++i)
        check_near(a.eigenvectors[10 * a.eigenvalues[3].vector + 2 * (size_t)i], pow((i - 2) / 2.0, 3), 1e-13);
    assert_int_equal(a.limit.count, 1);
    check_near(a.limit.weights[0], 1.0, 0.0);
    const double tangent[] = {1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0};
    for (int i = 0; i < 5; ++i)
        check_near(weight(&a.tangent, i - 2), tangent[i], 1e-13);
    // The exponent of the derivative is 1 as a supremum only.
    assert_true(a.exponent_lower < 2.0);
    check_near(a.exponent_lower, 2.0, 1e-9);
    check_near(a.exponent_upper, 2.0, 1e-12);
    assert_int_equal(a.smooth_proven, 1);
    assert_int_equal(a.smooth_disproven, 2);
    assert_int_equal(a.lipschitz, BAT_DISPROVEN);
    bat_analysis_free(&a);
}

static void four_point_loses_its_tangent_at_a_cubic_root(void **state)
{
    (void)state;
    // Hechler, Mößner and Reif 2009: C^1 for 0 < w < w*, the real root of 32 w^3 + 4 w - 1 = 0.
    double low = 0.1, high = 0.3;
    for (int i = 0; i < 60; ++i)
    {
        const double middle = 0.5 * (low + high);
        if (32.0 * middle * middle * middle + 4.0 * middle < 1.0)
            low = middle;
        else
            high = middle;
    }
    check_near(low, 0.19273, 1e-5);
    bat_analysis below = analyze(bat_mask_four_point(low - 1e-5));
    assert_int_equal(below.smooth_proven, 1);
    bat_analysis above = analyze(bat_mask_four_point(low + 1e-5));
    assert_int_equal(above.smooth_proven, 0);
    assert_int_equal(above.smooth_disproven, 1);
    bat_analysis_free(&below);
    bat_analysis_free(&above);
}

static void known_exponents_are_found(void **state)
{
    (void)state;
    // Six-point: 2.830 (Deslauriers and Dubuc 1989), which is -log2(9/64).
    bat_analysis six = analyze(bat_mask_six_point(BAT_SIX_POINT_WEIGHT));
    assert_int_equal(six.generation_degree, 5);
    assert_int_equal(six.reproduction_degree, 5);
    assert_int_equal(six.smooth_proven, 2);
    assert_int_equal(six.smooth_disproven, 3);
    check_near(six.exponent_lower, -log2(9.0 / 64.0), 1e-9);
    check_near(six.exponent_upper, -log2(9.0 / 64.0), 1e-9);
    bat_analysis_free(&six);
    // Daubechies' scaling function with two vanishing moments: 2 - log2(1 + sqrt 3) (Daubechies and Lagarias 1992).
    const double q = sqrt(3.0);
    const bat_mask d4 = {.coefficients = {(1 + q) / 4, (3 + q) / 4, (3 - q) / 4, (1 - q) / 4}, .count = 4};
    bat_analysis daubechies = analyze(d4);
    assert_int_equal(daubechies.multiplicity, 2);
    assert_int_equal(daubechies.smooth_proven, 0);
    check_near(daubechies.exponent_lower, 2.0 - log2(1.0 + q), 1e-9);
    check_near(daubechies.exponent_upper, 2.0 - log2(1.0 + q), 1e-9);
    bat_analysis_free(&daubechies);
}

static void lane_riesenfeld_is_a_spline(void **state)
{
    (void)state;
    const size_t orders[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 33, 80};
    for (size_t i = 0; i < sizeof orders / sizeof *orders; ++i)
    {
        const size_t order = orders[i];
        bat_analysis a = analyze(bat_mask_lane_riesenfeld(order));
        assert_int_equal(a.multiplicity, order + 1);
        assert_int_equal(a.generation_degree, order);
        assert_int_equal(a.reproduction_degree, 1);
        assert_int_equal(a.smooth_proven, order - 1);
        assert_int_equal(a.smooth_disproven, order);
        check_near(a.exponent_lower, (double)order, 1e-12);
        check_near(a.exponent_upper, (double)order, 1e-12);
        assert_int_equal(a.lipschitz, BAT_PROVEN);
        for (size_t e = 0; e < a.eigenvalue_count; ++e)
            check_near(a.eigenvalues[e].real, ldexp(1.0, -(int)e), 0.0);
        bat_analysis_free(&a);
    }
}

static void derivative_exponents_follow(void **state)
{
    (void)state;
    bat_analysis a = analyze(bat_mask_six_point(BAT_SIX_POINT_WEIGHT));
    double lower, upper;
    assert_true(bat_analysis_derivative_exponent(&a, 0, &lower, &upper));
    check_near(lower, 1.0, 0.0);
    assert_true(bat_analysis_derivative_exponent(&a, 2, &lower, &upper));
    check_near(lower, 0.830074998, 1e-8);
    check_near(upper, 0.830074998, 1e-8);
    assert_false(bat_analysis_derivative_exponent(&a, 3, &lower, &upper));
    bat_analysis_free(&a);
}

// Refinement as such, and what follows from it.

/// A row of points with indices first … first + count - 1.
typedef struct row
{
    double values[4096];
    int first;
    int count;
} row;

/// The points of the next level that the row determines.
static row refine(const bat_mask *mask, const row *coarse)
{
    // Index i needs the points from (i - last of the mask) / 2, rounded up, to (i - first of the mask) / 2, rounded down.
    row fine = {.first = 2 * coarse->first + mask->first + (int)mask->count - 2};
    const int last = 2 * (coarse->first + coarse->count - 1) + mask->first + 1;
    for (int i = fine.first; i <= last; ++i)
    {
        double sum = 0.0;
        for (int k = 0; k < (int)mask->count; ++k)
        {
            const int doubled = i - mask->first - k;
            if (doubled % 2 != 0)
                continue;
            const int j = doubled / 2 - coarse->first;
            assert_in_range(j, 0, coarse->count - 1);
            sum += mask->coefficients[k] * coarse->values[j];
        }
        fine.values[fine.count++] = sum;
    }
    return fine;
}

/// Keep the points from first to last.
static void crop(row *r, int first, int last)
{
    const int cut = first > r->first ? first - r->first : 0;
    memmove(r->values, r->values + cut, (size_t)(r->count - cut) * sizeof *r->values);
    r->first += cut;
    r->count -= cut;
    if (r->first + r->count - 1 > last)
        r->count = last - r->first + 1;
}

/// The limit at a parameter of the index parametrization, by 28 levels of refinement of the few points that matter.
static double brute_limit(const bat_mask *mask, const row *points, double parameter)
{
    const int reach = 2 * (int)mask->count;
    row now = *points;
    int centre = 0;
    for (int level = 1; level <= 28; ++level)
    {
        now = refine(mask, &now);
        centre = (int)floor(ldexp(parameter, level));
        crop(&now, centre - reach, centre + reach);
    }
    return now.values[centre - now.first];
}

static row random_points(bat_random *random, int half)
{
    row points = {.first = -half, .count = 2 * half + 1};
    for (int i = 0; i < points.count; ++i)
        points.values[i] = bat_random_normal(random);
    return points;
}

static double apply(const bat_stencil *stencil, const row *points, int at)
{
    double sum = 0.0;
    for (size_t k = 0; k < stencil->count; ++k)
        sum += stencil->weights[k] * points->values[at + stencil->first + (int)k - points->first];
    return sum;
}

static void limit_stencils_agree_with_refinement(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(7);
    for (int trial = 0; trial < 20; ++trial)
    {
        const bat_mask mask = trial == 0   ? bat_mask_four_point(1.0 / 16.0)
                              : trial == 1 ? bat_mask_six_point(0.02)
                              : trial == 2
                                  ? bat_mask_chaikin()
                                  : random_mask(&random, 1 + (size_t)trial % 5, 2 + (size_t)trial % 3, trial % 7 - 5);
        bat_analysis a = analyze(mask);
        assert_int_equal(a.converges, BAT_PROVEN);
        const row points = random_points(&random, 40);
        check_near(apply(&a.limit, &points, 0), brute_limit(&mask, &points, 0.0), 1e-7);
        for (int at = -2; at <= 2; ++at)
            check_near(apply(&a.vertex, &points, at), brute_limit(&mask, &points, at + a.shift), 1e-6);
        bat_analysis_free(&a);
    }
}

static void limit_stencil_is_the_same_at_every_level(void **state)
{
    (void)state;
    // Points of level 1 moved to the limit are limits of the points of level 0 at (i + shift) / 2.
    bat_random random = bat_random_seed(11);
    for (int trial = 0; trial < 10; ++trial)
    {
        const bat_mask mask = random_mask(&random, 3, 3, -3 + trial % 3);
        bat_stencil stencil;
        check_status(bat_mask_limit_stencil(&mask, &stencil, NULL), BAT_OK);
        double shift = 0.0;
        for (size_t k = 0; k < mask.count; ++k)
            shift += 0.5 * (mask.first + (int)k) * mask.coefficients[k];
        const row points = random_points(&random, 40);
        const row fine = refine(&mask, &points);
        for (int i = -2; i <= 2; ++i)
            check_near(apply(&stencil, &fine, i), brute_limit(&mask, &points, 0.5 * (i + shift)), 1e-6);
    }
}

static void limit_stencils_reproduce_straight_lines(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    row line = {.first = -40, .count = 81};
    for (int i = 0; i < line.count; ++i)
        line.values[i] = 2.0 + 3.0 * (line.first + i);
    for (int trial = 0; trial < 10; ++trial)
    {
        const bat_mask mask = random_mask(&random, 4, 2, -4);
        bat_analysis a = analyze(mask);
        check_near(apply(&a.vertex, &line, 5), 17.0, 1e-11); // the shift is taken to 40 binary digits
        check_near(apply(&a.limit, &line, 0), 2.0 - 3.0 * a.shift, 1e-12);
        if (a.tangent.count > 0)
            check_near(apply(&a.tangent, &line, 0), 3.0, 1e-11);
        bat_analysis_free(&a);
    }
}

static void tangents_agree_with_difference_quotients(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(23);
    for (int trial = 0; trial < 10; ++trial)
    {
        const bat_mask mask = random_mask(&random, 3, 4, -4);
        bat_analysis a = analyze(mask);
        assert_true(a.smooth_proven >= 2);
        assert_true(a.tangent.count > 0);
        const row points = random_points(&random, 40);
        const double step = 0x1p-8;
        const double slope = (brute_limit(&mask, &points, step) - brute_limit(&mask, &points, -step)) / (2.0 * step);
        check_near(apply(&a.tangent, &points, 0), slope, 0.05);
        bat_analysis_free(&a);
    }
}

static void basis_is_a_partition_of_one(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    for (int trial = 0; trial < 8; ++trial)
    {
        const bat_mask mask = trial == 0 ? bat_mask_six_point(BAT_SIX_POINT_WEIGHT) : random_mask(&random, 4, 2, -trial);
        bat_basis basis;
        check_status(bat_mask_basis(&mask, 5, &basis, NULL), BAT_OK);
        assert_int_equal(basis.count, (size_t)(basis.last - basis.first) * 32 + 1);
        check_near(basis.values[0], 0.0, 0.0);
        check_near(basis.values[basis.count - 1], 0.0, 1e-14);
        for (size_t offset = 0; offset < 32; ++offset)
        {
            double sum = 0.0;
            for (size_t i = offset; i < basis.count; i += 32)
                sum += basis.values[i];
            check_near(sum, 1.0, 1e-13);
        }
        bat_basis_free(&basis);
        bat_basis_free(&basis);
    }
}

static void basis_of_chaikin_is_the_quadratic_spline(void **state)
{
    (void)state;
    bat_basis basis;
    const bat_mask mask = bat_mask_chaikin();
    check_status(bat_mask_basis(&mask, 6, &basis, NULL), BAT_OK);
    assert_int_equal(basis.first, -2);
    assert_int_equal(basis.last, 1);
    for (size_t i = 0; i < basis.count; ++i)
    {
        const double x = (double)i / 64.0;
        const double expected = x < 1.0 ? 0.5 * x * x : x < 2.0 ? 0.75 - (x - 1.5) * (x - 1.5) : 0.5 * (3.0 - x) * (3.0 - x);
        check_near(basis.values[i], expected, 1e-14);
    }
    bat_basis_free(&basis);
}

static void reproduction_agrees_with_refinement(void **state)
{
    (void)state;
    // The degrees of polynomials that one step takes from the parameters i + shift to (i + shift) / 2.
    bat_random random = bat_random_seed(31);
    for (int trial = 0; trial < 12; ++trial)
    {
        const bat_mask mask = trial == 0   ? bat_mask_four_point(1.0 / 16.0)
                              : trial == 1 ? bat_mask_six_point(BAT_SIX_POINT_WEIGHT)
                              : trial == 2 ? bat_mask_lane_riesenfeld(6)
                              : trial == 3 ? bat_mask_six_point(0.01)
                                           : random_mask(&random, 3, 1 + (size_t)trial % 3, -3);
        bat_analysis a = analyze(mask);
        size_t degree = 0;
        for (bool holds = true; holds && degree <= a.generation_degree;)
        {
            row points = {.first = -20, .count = 41};
            for (int i = 0; i < points.count; ++i)
                points.values[i] = pow(points.first + i + a.shift, (double)degree);
            const row fine = refine(&mask, &points);
            for (int i = -3; i <= 3; ++i)
                holds = holds && fabs(fine.values[i - fine.first] - pow(0.5 * (i + a.shift), (double)degree)) < 1e-9;
            degree += holds ? 1 : 0;
        }
        assert_int_equal(a.reproduction_degree, degree - 1);
        bat_analysis_free(&a);
    }
}

// Invariances.

static void difference_masks_refine_differences(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(13);
    const bat_mask mask = bat_mask_six_point(BAT_SIX_POINT_WEIGHT);
    row points = random_points(&random, 30);
    row fine = refine(&mask, &points);
    for (size_t order = 1; order <= 6; ++order)
    {
        bat_mask difference;
        check_status(bat_mask_difference(&mask, order, &difference, NULL), BAT_OK);
        for (row *r = &points;; r = &fine)
        {
            for (int i = 0; i + 1 < r->count; ++i)
                r->values[i] = r->values[i + 1] - r->values[i];
            r->first += 1;
            r->count -= 1;
            if (r == &fine)
                break;
        }
        const row refined = refine(&difference, &points);
        for (int i = -4; i <= 4; ++i)
            check_near(refined.values[i - refined.first], fine.values[i - fine.first], 1e-12);
    }
    bat_mask difference;
    check_status(bat_mask_difference(&mask, 7, &difference, NULL), BAT_INVALID_ARGUMENT);
}

static void shifts_and_zeros_change_nothing_else(void **state)
{
    (void)state;
    const bat_mask mask = bat_mask_corner_cutting(0.2, 0.55);
    bat_mask moved = {.count = mask.count + 5, .first = mask.first + 17 - 2};
    for (size_t k = 0; k < mask.count; ++k)
        moved.coefficients[k + 2] = mask.coefficients[k];
    bat_analysis a = analyze(mask);
    bat_analysis b = analyze(moved);
    assert_int_equal(b.mask.count, a.mask.count);
    assert_int_equal(b.mask.first, a.mask.first + 17);
    check_near(b.shift, a.shift + 17.0, 1e-13);
    assert_int_equal(b.matrix_first, a.matrix_first - 17);
    check_near(b.exponent_lower, a.exponent_lower, 1e-12);
    check_near(b.exponent_upper, a.exponent_upper, 1e-12);
    assert_int_equal(b.vertex.count, a.vertex.count);
    assert_int_equal(b.vertex.first, a.vertex.first);
    for (size_t k = 0; k < a.vertex.count; ++k)
        check_near(b.vertex.weights[k], a.vertex.weights[k], 1e-10);
    bat_analysis_free(&a);
    bat_analysis_free(&b);
}

static void reversal_reverses(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(17);
    for (int trial = 0; trial < 10; ++trial)
    {
        const bat_mask mask = random_mask(&random, 4, 1 + (size_t)trial % 3, -3);
        const bat_mask mirror = reversed(&mask);
        bat_analysis a = analyze(mask);
        bat_analysis b = analyze(mirror);
        check_near(b.shift, -a.shift, 1e-14);
        assert_int_equal(b.multiplicity, a.multiplicity);
        assert_int_equal(b.reproduction_degree, a.reproduction_degree);
        // Both pairs of bounds hold the same number.
        assert_true(a.exponent_lower <= b.exponent_upper && b.exponent_lower <= a.exponent_upper);
        for (int k = -6; k <= 6; ++k)
        {
            check_near(weight(&b.limit, k), weight(&a.limit, -k), 1e-13);
            check_near(weight(&b.vertex, k), weight(&a.vertex, -k), 1e-9);
            check_near(weight(&b.tangent, k), -weight(&a.tangent, -k), 1e-11);
        }
        bat_analysis_free(&a);
        bat_analysis_free(&b);
    }
}

static void smoothing_adds_one_derivative(void **state)
{
    (void)state;
    // Convolution with the unit box integrates: one more factor (1 + z) / 2 adds 1 to the exponent.
    bat_mask mask = bat_mask_corner_cutting(0.15, 0.6);
    bat_analysis before = analyze(mask);
    for (size_t k = mask.count; k > 0; --k)
        mask.coefficients[k] = 0.5 * ((k < mask.count ? mask.coefficients[k] : 0.0) + mask.coefficients[k - 1]);
    mask.coefficients[0] *= 0.5;
    ++mask.count;
    bat_analysis after = analyze(mask);
    assert_int_equal(after.multiplicity, before.multiplicity + 1);
    check_near(after.exponent_lower, before.exponent_lower + 1.0, 1e-9);
    check_near(after.exponent_upper, before.exponent_upper + 1.0, 1e-9);
    assert_int_equal(after.smooth_proven, before.smooth_proven + 1);
    bat_analysis_free(&before);
    bat_analysis_free(&after);
}

static void bounds_tighten_with_depth(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(41);
    for (int trial = 0; trial < 5; ++trial)
    {
        const bat_mask mask = trial == 0 ? bat_mask_six_point(0.02) : random_mask(&random, 5, 1, -3);
        double lower = -INFINITY;
        double upper = INFINITY;
        for (size_t depth = 1; depth <= 9; ++depth)
        {
            bat_analysis a = analyze_to_depth(mask, depth);
            assert_true(a.exponent_lower >= lower);
            assert_true(a.exponent_upper <= upper);
            assert_true(a.exponent_lower <= a.exponent_upper);
            lower = a.exponent_lower;
            upper = a.exponent_upper;
            bat_analysis_free(&a);
        }
        assert_true(upper - lower < 0.02);
    }
}

/// The growth of a mask's subdivision operator by |S^k|^(1/k) in the maximum norm, which is never below the true one.
static double measured_growth(const bat_mask *mask, int steps)
{
    static double values[1 << 16];
    static double next[1 << 16];
    size_t count = 1;
    values[0] = 1.0;
    for (int s = 0; s < steps; ++s)
    {
        const size_t arity = (size_t)1 << s;
        const size_t longer = count + (mask->count - 1) * arity;
        assert_true(longer <= sizeof next / sizeof *next);
        memset(next, 0, sizeof next);
        for (size_t k = 0; k < mask->count; ++k)
            for (size_t i = 0; i < count; ++i)
                next[i + k * arity] += mask->coefficients[k] * values[i];
        memcpy(values, next, sizeof values);
        count = longer;
    }
    double norm = 0.0;
    const size_t arity = (size_t)1 << steps;
    for (size_t residue = 0; residue < arity; ++residue)
    {
        double sum = 0.0;
        for (size_t i = residue; i < count; i += arity)
            sum += fabs(values[i]);
        norm = fmax(norm, sum);
    }
    return pow(norm, 1.0 / steps);
}

static void bounds_hold_measured_growth(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(43);
    for (int trial = 0; trial < 12; ++trial)
    {
        const bat_mask mask = trial == 0   ? bat_mask_four_point(1.0 / 16.0)
                              : trial == 1 ? bat_mask_four_point(0.19)
                                           : random_mask(&random, 3 + (size_t)trial % 4, (size_t)trial % 3 + 1, 0);
        bat_analysis a = analyze(mask);
        assert_true(a.radius_lower <= a.radius_upper);
        assert_true(a.radius_lower <= measured_growth(&a.quotient, 12) * (1.0 + 1e-12));
        // |S^12| is at most a moderate constant times radius^12.
        assert_true(a.radius_upper >= measured_growth(&a.quotient, 12) * pow(0.02, 1.0 / 12.0));
        bat_analysis_free(&a);
    }
}

// Schemes without limits, limits without proofs, and masks that are none.

static void divergent_schemes_are_told(void **state)
{
    (void)state;
    const bat_mask masks[] = {
        {.coefficients = {1.0, 1.0}, .count = 2, .first = 0},           // piecewise constant
        {.coefficients = {1.0, 0.0, 0.0, 1.0}, .count = 4, .first = 0}, // a comb
        bat_mask_four_point(0.5),
        bat_mask_four_point(-0.7),
        {.coefficients = {-1.0, 3.0, 2.0, -2.0}, .count = 4, .first = -2},
    };
    for (size_t m = 0; m < sizeof masks / sizeof *masks; ++m)
    {
        bat_analysis a = analyze(masks[m]);
        assert_int_equal(a.converges, BAT_DISPROVEN);
        assert_int_equal(a.smooth_proven, -1);
        assert_int_equal(a.smooth_disproven, 0);
        assert_int_equal(a.limit.count, 0);
        assert_int_equal(a.vertex.count, 0);
        double lower, upper;
        assert_false(bat_analysis_derivative_exponent(&a, 0, &lower, &upper));
        bat_analysis_free(&a);
        bat_stencil stencil;
        bat_basis basis;
        bat_error error;
        check_status(bat_mask_limit_stencil(&masks[m], &stencil, &error), BAT_NO_CONVERGENCE);
        check_status(error.status, BAT_NO_CONVERGENCE);
        check_status(bat_mask_basis(&masks[m], 3, &basis, &error), BAT_NO_CONVERGENCE);
    }
}

static void unstable_masks_get_no_upper_bound(void **state)
{
    (void)state;
    // (1 + z) (1 + z^2) (1 + z + z^2) / 6 has the zeros i and -i; its limit function is the sum of two shifts of the one of
    // (1 + z)^2 (1 + z + z^2) / 6, and as smooth as that, although its own differences tell less.
    const bat_mask unstable = {.coefficients = {1.0 / 6, 2.0 / 6, 3.0 / 6, 3.0 / 6, 2.0 / 6, 1.0 / 6}, .count = 6};
    const bat_mask stable = {.coefficients = {1.0 / 6, 3.0 / 6, 4.0 / 6, 3.0 / 6, 1.0 / 6}, .count = 5};
    bat_analysis a = analyze(unstable);
    bat_analysis b = analyze(stable);
    assert_int_equal(a.converges, BAT_PROVEN);
    assert_false(a.is_stable);
    assert_true(isinf(a.exponent_upper));
    assert_int_equal(a.smooth_disproven, -1);
    assert_true(b.is_stable);
    assert_true(a.exponent_lower < b.exponent_lower - 0.5);
    assert_int_equal(b.smooth_proven, 1);
    bat_analysis_free(&a);
    bat_analysis_free(&b);
    // 1 - z + z^2 vanishes at the negatives of the cube roots of unity, a cycle under squaring.
    bat_mask cycle = {.coefficients = {1.0, -1.0, 1.0}, .count = 3};
    for (size_t s = 0; s < 4; ++s)
    {
        for (size_t k = cycle.count; k > 0; --k)
            cycle.coefficients[k] = (k < cycle.count ? cycle.coefficients[k] : 0.0) + cycle.coefficients[k - 1];
        ++cycle.count;
    }
    for (size_t k = 0; k < cycle.count; ++k)
        cycle.coefficients[k] /= 8.0;
    bat_analysis c = analyze(cycle);
    assert_int_equal(c.converges, BAT_PROVEN);
    assert_int_equal(c.multiplicity, 4);
    assert_false(c.is_stable);
    bat_analysis_free(&c);
}

static void check_refused(bat_mask mask, bat_status expected, const char *part)
{
    bat_analysis analysis;
    memset(&analysis, 0x5a, sizeof analysis);
    const bat_analysis before = analysis;
    bat_error error;
    check_status(bat_mask_analyze(&mask, NULL, &analysis, &error), expected);
    check_status(error.status, expected);
    assert_non_null(strstr(error.text, part));
    assert_memory_equal(&analysis, &before, sizeof analysis);
    check_status(bat_mask_analyze(&mask, NULL, &analysis, NULL), expected);
    bat_stencil stencil;
    check_status(bat_mask_limit_stencil(&mask, &stencil, NULL), expected);
}

static void malformed_masks_are_refused(void **state)
{
    (void)state;
    check_refused((bat_mask){.count = 0}, BAT_INVALID_ARGUMENT, "coefficients");
    check_refused((bat_mask){.count = BAT_MASK_MAX + 1}, BAT_INVALID_ARGUMENT, "coefficients");
    check_refused((bat_mask){.coefficients = {1.0, NAN}, .count = 2}, BAT_INVALID_ARGUMENT, "coefficient 1");
    check_refused((bat_mask){.coefficients = {INFINITY, 1.0}, .count = 2}, BAT_INVALID_ARGUMENT, "coefficient 0");
    check_refused((bat_mask){.coefficients = {0.5, 0.5}, .count = 2}, BAT_INVALID_ARGUMENT, "even index sum to 0.5");
    check_refused((bat_mask){.coefficients = {0.5, 0.4, 0.5, 0.5}, .count = 4}, BAT_INVALID_ARGUMENT,
                  "odd index sum to 0.9");
    check_refused((bat_mask){.coefficients = {1.0}, .count = 1}, BAT_INVALID_ARGUMENT, "odd");
    check_refused((bat_mask){.coefficients = {0.5, 1.0, 0.5}, .count = 3, .first = 2000000000}, BAT_INVALID_ARGUMENT,
                  "first");
    check_refused((bat_mask){.coefficients = {1e308, 1e308, 1e308, 1e308}, .count = 4}, BAT_INVALID_ARGUMENT, "beyond");
}

static void options_are_checked(void **state)
{
    (void)state;
    const bat_mask mask = bat_mask_chaikin();
    bat_analysis analysis;
    bat_analysis_options options = bat_analysis_defaults();
    options.depth = 0;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_INVALID_ARGUMENT);
    options.depth = BAT_ANALYSIS_MAX_DEPTH + 1;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_INVALID_ARGUMENT);
    options = bat_analysis_defaults();
    options.tolerance = NAN;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_INVALID_ARGUMENT);
    options = bat_analysis_defaults();
    options.vertices = 0;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_INVALID_ARGUMENT);
    bat_basis basis;
    check_status(bat_mask_basis(&mask, 60, &basis, NULL), BAT_TOO_LARGE);
    assert_string_equal(bat_verdict_name(BAT_PROVEN), "proven");
}

static void long_masks_are_taken(void **state)
{
    (void)state;
    bat_mask mask = {.count = BAT_MASK_MAX, .first = -64};
    for (size_t k = 0; k < mask.count; ++k)
        mask.coefficients[k] = 2.0 / BAT_MASK_MAX;
    bat_analysis a = analyze_to_depth(mask, 2);
    // The symbol is (1 + z) (1 + z^2) … (1 + z^64) / 64, so it has the zeros i and -i.
    assert_int_equal(a.converges, BAT_PROVEN);
    assert_int_equal(a.multiplicity, 1);
    assert_false(a.is_stable);
    bat_analysis_free(&a);
}

// Sweeps.

static bat_mask four_point_family(void *context, double w)
{
    (void)context;
    return bat_mask_four_point(w);
}

static bat_mask cutting_family(void *context, double r)
{
    return bat_mask_corner_cutting(r, *(const double *)context);
}

static bat_mask bent_family(void *context, double x)
{
    (void)context;
    return bat_mask_four_point(x * x);
}

static bool stop_at_half(void *context, double fraction)
{
    *(double *)context = fraction;
    return fraction < 0.5;
}

static void sweep_finds_the_sharp_interval(void **state)
{
    (void)state;
    bat_sweep_options options = bat_sweep_defaults();
    options.end = 0.25;
    options.tolerance = 2e-4;
    bat_interval *intervals;
    size_t count;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_OK);
    // 0 alone, undecided, proven, undecided, disproven.
    assert_int_equal(count, 5);
    assert_int_equal(intervals[0].verdict, BAT_DISPROVEN);
    check_near(intervals[0].end, 0.0, 0.0);
    assert_int_equal(intervals[2].verdict, BAT_PROVEN);
    assert_true(intervals[2].begin < 3e-4);
    const double end = intervals[2].end;
    assert_true(32.0 * end * end * end + 4.0 * end < 1.0);
    const double begin = intervals[4].begin;
    assert_int_equal(intervals[4].verdict, BAT_DISPROVEN);
    assert_true(32.0 * begin * begin * begin + 4.0 * begin > 1.0);
    check_near(end, 0.19273, 3e-4);
    check_near(begin, 0.19273, 3e-4);
    check_near(intervals[4].end, 0.25, 0.0);
    for (size_t i = 1; i < count; ++i)
        check_near(intervals[i].begin, intervals[i - 1].end, 0.0);
    free(intervals);
}

static void sweep_finds_single_parameters(void **state)
{
    (void)state;
    bat_sweep_options options = bat_sweep_defaults();
    options.begin = 0.05;
    options.end = 0.6;
    double s = 0.75;
    bat_interval *intervals;
    size_t count;
    check_status(bat_mask_sweep(cutting_family, &s, &options, &intervals, &count, NULL), BAT_OK);
    assert_int_equal(count, 3);
    assert_int_equal(intervals[0].verdict, BAT_DISPROVEN);
    assert_int_equal(intervals[1].verdict, BAT_PROVEN);
    assert_int_equal(intervals[2].verdict, BAT_DISPROVEN);
    check_near(intervals[1].begin, 0.25, 1e-15);
    check_near(intervals[1].end, intervals[1].begin, 0.0);
    free(intervals);
    options.smoothness = 0;
    check_status(bat_mask_sweep(cutting_family, &s, &options, &intervals, &count, NULL), BAT_OK);
    assert_int_equal(count, 1);
    assert_int_equal(intervals[0].verdict, BAT_PROVEN);
    free(intervals);
}

static void sweep_agrees_with_single_analyses(void **state)
{
    (void)state;
    bat_sweep_options options = bat_sweep_defaults();
    options.begin = -0.3;
    options.end = 0.3;
    options.tolerance = 0.01;
    bat_interval *intervals;
    size_t count;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_OK);
    for (size_t i = 0; i < count; ++i)
    {
        if (intervals[i].verdict == BAT_UNDECIDED)
            continue;
        for (int share = 1; share <= 7; share += 2)
        {
            const double w = intervals[i].begin + 0.125 * share * (intervals[i].end - intervals[i].begin);
            bat_analysis a = analyze(bat_mask_four_point(w));
            assert_int_equal(a.smooth_proven >= 1, intervals[i].verdict == BAT_PROVEN);
            bat_analysis_free(&a);
        }
    }
    free(intervals);
}

static void sweeps_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    bat_sweep_options options = bat_sweep_defaults();
    bat_interval *intervals = NULL;
    size_t count;
    options.end = options.begin;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_INVALID_ARGUMENT);
    options.end = NAN;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_INVALID_ARGUMENT);
    options = bat_sweep_defaults();
    check_status(bat_mask_sweep(bent_family, NULL, &options, &intervals, &count, NULL), BAT_UNSUPPORTED);
    options.smoothness = 1000;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_INVALID_ARGUMENT);
    options = bat_sweep_defaults();
    options.end = 0.2;
    double fraction = 0.0;
    options.progress = (bat_progress){.report = stop_at_half, .context = &fraction};
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_CANCELLED);
    assert_true(fraction >= 0.5);
    assert_null(intervals);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chaikin_is_the_quadratic_spline),
        cmocka_unit_test(corner_cutting_has_its_limit_stencil),
        cmocka_unit_test(corner_cutting_is_smooth_where_edges_halve),
        cmocka_unit_test(four_point_is_just_not_twice_differentiable),
        cmocka_unit_test(four_point_loses_its_tangent_at_a_cubic_root),
        cmocka_unit_test(known_exponents_are_found),
        cmocka_unit_test(lane_riesenfeld_is_a_spline),
        cmocka_unit_test(derivative_exponents_follow),
        cmocka_unit_test(limit_stencils_agree_with_refinement),
        cmocka_unit_test(limit_stencil_is_the_same_at_every_level),
        cmocka_unit_test(limit_stencils_reproduce_straight_lines),
        cmocka_unit_test(tangents_agree_with_difference_quotients),
        cmocka_unit_test(basis_is_a_partition_of_one),
        cmocka_unit_test(basis_of_chaikin_is_the_quadratic_spline),
        cmocka_unit_test(reproduction_agrees_with_refinement),
        cmocka_unit_test(difference_masks_refine_differences),
        cmocka_unit_test(shifts_and_zeros_change_nothing_else),
        cmocka_unit_test(reversal_reverses),
        cmocka_unit_test(smoothing_adds_one_derivative),
        cmocka_unit_test(bounds_tighten_with_depth),
        cmocka_unit_test(bounds_hold_measured_growth),
        cmocka_unit_test(divergent_schemes_are_told),
        cmocka_unit_test(unstable_masks_get_no_upper_bound),
        cmocka_unit_test(malformed_masks_are_refused),
        cmocka_unit_test(options_are_checked),
        cmocka_unit_test(long_masks_are_taken),
        cmocka_unit_test(sweep_finds_the_sharp_interval),
        cmocka_unit_test(sweep_finds_single_parameters),
        cmocka_unit_test(sweep_agrees_with_single_analyses),
        cmocka_unit_test(sweeps_that_make_no_sense_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
