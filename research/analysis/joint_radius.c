#include "research/analysis/joint_radius.h"

#include "base/error.h"
#include "linalg/blas.h"
#include "research/analysis/eigen.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Growth rates that agree to this share count as ties.
#define TIE 1e-7
/// A growth rate must exceed the best one by this share before its eigenvalues are bounded with care.
#define RECORD 1e-13
/// A better lower bound restarts the polytope only when it is better by this share.
#define RESTART 1e-10
/// Floating-point operations that one search for long products may take; longer ones are left out.
#define WORD_WORK 1e9
/// Operations that one polytope may take, roughly; it bounds the number of vertices.
#define POLYTOPE_WORK 1e9
/// Rounds of growth for every unit of depth.
#define ROUNDS_PER_DEPTH 2
/// The excess of the first polytope at a larger rate, and of each next one relative to the one before.
#define FIRST_EXCESS 0.1
#define EXCESS_RATIO 0.25

bat_status matrix_set_make(size_t dimension, size_t count, matrix_set *set, bat_error *error)
{
    const size_t numbers = dimension * dimension * count;
    *set = (matrix_set){.dimension = dimension, .count = count};
    const bat_status status = blas_load(error);
    if (status != BAT_OK)
        return status;
    set->entries = memory_array(numbers, sizeof *set->entries);
    return set->entries != NULL ? BAT_OK : error_memory(error, numbers * sizeof *set->entries);
}

void matrix_set_free(matrix_set *set)
{
    free(set->entries);
    *set = (matrix_set){0};
}

/// Sums of moduli over row i and column i, off the diagonal, of all matrices together.
static void off_diagonal_sums(const matrix_set *set, size_t i, double *row, double *column)
{
    const size_t n = set->dimension;
    *row = *column = 0.0;
    for (size_t m = 0; m < set->count; m++)
    {
        const double *a = matrix_set_at(set, m);
        for (size_t j = 0; j < n; j++)
        {
            if (j == i)
                continue;
            *row += fabs(a[i * n + j]);
            *column += fabs(a[j * n + i]);
        }
    }
}

void matrix_set_balance(matrix_set *set)
{
    static const int SWEEPS = 10;
    const size_t n = set->dimension;
    for (size_t sweep = 0; sweep < SWEEPS; sweep++)
    {
        for (size_t i = 0; i < n; i++)
        {
            double row, column;
            off_diagonal_sums(set, i, &row, &column);
            if (row == 0.0 || column == 0.0)
                continue;
            const double factor = exp2(round(0.5 * log2(row / column)));
            if (factor == 1.0 || !isfinite(factor))
                continue;
            for (size_t m = 0; m < set->count; m++)
            {
                double *a = matrix_set_at(set, m);
                for (size_t j = 0; j < n; j++)
                {
                    a[j * n + i] *= factor;
                    a[i * n + j] /= factor;
                }
            }
        }
    }
}

/// Divide all matrices by a power of two that brings the largest norm near 1, so that long products keep in range.
/// @return the power; 1 when all matrices vanish
static double scale_to_unit(matrix_set *set)
{
    const size_t n = set->dimension;
    double largest = 0.0;
    for (size_t m = 0; m < set->count; m++)
        largest = fmax(largest, dense_norm(n, matrix_set_at(set, m)));
    if (largest == 0.0)
        return 1.0;
    const double scale = exp2(round(log2(largest)));
    for (size_t i = 0; i < set->count * n * n; i++)
        set->entries[i] /= scale;
    return scale;
}

/// The state of a search for the products that grow most.
typedef struct word_search
{
    const matrix_set *set; ///< balanced and scaled
    joint_radius *result;  ///< in units of the scale
    size_t length;         ///< of the words under way
    matrix_word word;
    double *products; ///< product of the first t letters at t n n; the empty one is not used
    double *distance; ///< rounding error of each product, Frobenius norm
    double *scratch;  ///< for dense_spectral_radius()
    bat_error *error;
} word_search;

static void extend_product(word_search *search, size_t position)
{
    const size_t n = search->set->dimension;
    const double *factor = matrix_set_at(search->set, search->word.letters[position]);
    double *product = search->products + position * n * n;
    if (position == 0)
    {
        memcpy(product, factor, n * n * sizeof *product);
        search->distance[0] = 0.0;
        return;
    }
    const double *before = product - n * n;
    const double norm = dense_norm(n, factor);
    dense_multiply(n, before, factor, product);
    search->distance[position] = norm * (search->distance[position - 1] + (double)n * DBL_EPSILON * dense_norm(n, before));
}

/// Keep the word if it ties with the best growth or beats it.
static void remember_leader(joint_radius *result, const matrix_word *word)
{
    const double best = result->leader_count > 0 ? result->leaders[0].growth : 0.0;
    if (word->growth <= best * (1.0 - TIE))
        return;
    if (word->growth > best * (1.0 + TIE))
        result->leader_count = 0;
    if (result->leader_count < JOINT_RADIUS_LEADERS)
        result->leaders[result->leader_count++] = *word;
}

static bat_status visit_word(word_search *search)
{
    const size_t n = search->set->dimension;
    const double *product = search->products + (search->length - 1) * n * n;
    const double root = 1.0 / (double)search->length;
    double radius;
    bat_status status = dense_spectral_radius(n, product, search->scratch, &radius, search->error);
    if (status != BAT_OK)
        return status;
    search->word.length = search->length;
    search->word.growth = pow(radius, root);
    remember_leader(search->result, &search->word);
    if (search->word.growth <= search->result->lower * (1.0 + RECORD))
        return BAT_OK;
    double bound;
    status = dense_spectral_radius_below(n, product, search->distance[search->length - 1], &bound, search->error);
    if (status == BAT_OK)
        search->result->lower = fmax(search->result->lower, pow(bound, root) * (1.0 - 2.0 * DBL_EPSILON));
    return status;
}

/// All Lyndon words of the search's length over the set's indices, by the algorithm of Fredricksen, Kessler and Maiorana:
/// letters before `position` stand, and repeat with `period`.
static bat_status visit_lyndon_words(word_search *search, size_t position, size_t period)
{
    if (position == search->length)
        return period == search->length ? visit_word(search) : BAT_OK;
    const unsigned char first = position == 0 ? 0 : search->word.letters[position - period];
    bat_status status = BAT_OK;
    for (size_t letter = first; letter < search->set->count && status == BAT_OK; letter++)
    {
        search->word.letters[position] = (unsigned char)letter;
        extend_product(search, position);
        status = visit_lyndon_words(search, position + 1, letter == first && position > 0 ? period : position + 1);
    }
    return status;
}

/// Whether trying every word of this length stays within WORD_WORK; the eigenvalues cost about 25 n^3.
static bool length_is_affordable(const matrix_set *set, size_t length)
{
    const double n = (double)set->dimension;
    const double words = pow((double)set->count, (double)length);
    return words * (2.0 * n * n * n + 500.0) + words / (double)length * (25.0 * n * n * n + 10000.0) <= WORD_WORK;
}

double matrix_word_product(const matrix_set *set, const matrix_word *word, double distance, double *product, double *other)
{
    const size_t n = set->dimension;
    double error_norm = distance;
    memcpy(product, matrix_set_at(set, word->letters[0]), n * n * sizeof *product);
    for (size_t t = 1; t < word->length; t++)
    {
        const double *factor = matrix_set_at(set, word->letters[t]);
        const double size = dense_norm(n, product);
        dense_multiply(n, product, factor, other);
        memcpy(product, other, n * n * sizeof *product);
        error_norm = (error_norm + (double)n * DBL_EPSILON * size) * (dense_norm(n, factor) + distance) + size * distance;
    }
    return error_norm;
}

/// The rows that follow `vector` when the factors of the word but the first are applied to it, the last factor first.
static void follow(const matrix_set *set, const matrix_word *word, double rate, double *vector)
{
    const size_t n = set->dimension;
    for (size_t step = 1; step < word->length; step++)
    {
        double *image = vector + step * n;
        dense_apply(n, matrix_set_at(set, word->letters[word->length - step]), image - n, image);
        for (size_t i = 0; i < n; i++)
            image[i] /= rate;
    }
}

/// The orbits of one word.
/// @param memory room for two matrices and two vectors
/// @param rows room for phases times the word's length rows
/// @param count receives how many there are
static bat_status word_orbits(const matrix_set *set, const matrix_word *word, double rate, size_t phases, double *memory,
                              double *rows, size_t *count, bat_error *error)
{
    const double pi = 3.14159265358979323846;
    const size_t n = set->dimension;
    double *product = memory;
    double *real = memory + 2 * n * n;
    double *imaginary = real + n;
    (void)matrix_word_product(set, word, 0.0, product, product + n * n);
    const bat_status status = dense_leading_vector(n, product, real, imaginary, error);
    if (status != BAT_OK)
        return status;
    bool is_complex = false;
    for (size_t i = 0; i < n; i++)
        is_complex = is_complex || imaginary[i] != 0.0;
    *count = 0;
    for (size_t phase = 0; phase < (is_complex ? phases : 1); phase++)
    {
        const double angle = pi * (double)phase / (double)phases;
        double *row = rows + *count * n;
        for (size_t i = 0; i < n; i++)
            row[i] = cos(angle) * real[i] + sin(angle) * imaginary[i];
        follow(set, word, rate, row);
        *count += word->length;
    }
    return BAT_OK;
}

/// Leading eigenvectors of the leaders of a joint radius, and the vectors they pass through while their product is applied,
/// each step divided by `rate`: vertices that an extremal polytope must have.
///
/// A complex eigenvector stands for an ellipse, on which the product turns vectors; it gives `phases` points of half of it.
/// @param set the matrices that the leaders' letters count
/// @param vectors receives rows of dimension numbers; release it with free()
/// @return BAT_OK, BAT_NO_MEMORY or BAT_NO_CONVERGENCE
static bat_status leading_orbits(const matrix_set *set, const joint_radius *radius, double rate, size_t phases,
                                 double **vectors, size_t *count, bat_error *error)
{
    const size_t n = set->dimension;
    size_t rows = 0;
    for (size_t l = 0; l < radius->leader_count; l++)
        rows += phases * radius->leaders[l].length;
    *count = 0;
    *vectors = memory_array(rows * n, sizeof **vectors);
    double *memory = memory_array(2 * n * (n + 1), sizeof *memory);
    bat_status status = *vectors != NULL && memory != NULL ? BAT_OK : error_memory(error, rows * n * sizeof **vectors);
    for (size_t l = 0; l < radius->leader_count && status == BAT_OK; l++)
    {
        size_t more;
        status = word_orbits(set, &radius->leaders[l], rate, phases, memory, *vectors + *count * n, &more, error);
        *count += status == BAT_OK ? more : 0;
    }
    free(memory);
    if (status != BAT_OK)
    {
        free(*vectors);
        *vectors = NULL;
    }
    return status;
}

/// How many vertices V stay within POLYTOPE_WORK: about count V norms, each n steps of n (3 n + V) operations.
static size_t affordable_vertices(const matrix_set *set, size_t wanted)
{
    const double n = (double)set->dimension;
    const double norms = POLYTOPE_WORK / (n * n * (double)set->count);
    const double affordable = 0.5 * (sqrt(9.0 * n * n + 4.0 * norms) - 3.0 * n);
    return (double)wanted < affordable ? wanted : (size_t)affordable;
}

bat_status joint_radius_growth(const matrix_set *set, const matrix_set *seed_set, const joint_radius *radius, double rate,
                               size_t phases, size_t vertices, polytope_growth *growth, bat_error *error)
{
    double *seeds;
    size_t seed_count;
    bat_status status = leading_orbits(seed_set, radius, rate, phases, &seeds, &seed_count, error);
    if (status != BAT_OK)
        return status;
    status = polytope_growth_make(set, rate, seeds, seed_count, affordable_vertices(set, vertices), growth, error);
    free(seeds);
    return status;
}

/// Lower and upper bound in turn, deeper and deeper, in units of the scale.
typedef struct bound_search
{
    word_search words;
    polytope_growth growth; ///< at the rate of the lower bound: closes when that is the joint spectral radius, or never
    bool growing;           ///< `growth` is there
    bool closed;
    double excess; ///< share by which the next polytope at a larger rate exceeds the lower bound; 0 for no more
} bound_search;

static bool is_enough(const joint_radius *result, const joint_radius_limits *limits)
{
    return result->upper <= (1.0 + limits->tolerance) * result->lower || result->upper < limits->stop_below ||
           result->lower >= limits->stop_from;
}

/// Let the polytope at the rate of the lower bound grow a little, from new seeds if that bound is new.
static bat_status grow_at_lower_bound(bound_search *search, bool is_new, size_t vertices, bat_error *error)
{
    joint_radius *result = search->words.result;
    const matrix_set *set = search->words.set;
    bat_status status = BAT_OK;
    if (!search->growing || is_new)
    {
        if (search->growing)
            polytope_growth_free(&search->growth);
        search->growing = search->closed = false;
        status = joint_radius_growth(set, set, result, result->lower, 2, vertices, &search->growth, error);
        search->growing = status == BAT_OK;
    }
    for (size_t round = 0; round < ROUNDS_PER_DEPTH && status == BAT_OK && !search->closed && !search->growth.full; round++)
    {
        double bound;
        status = polytope_growth_round(&search->growth, &bound, &search->closed, error);
        if (status == BAT_OK)
            result->upper = fmin(result->upper, bound);
        result->vertices = search->growth.hull.count;
    }
    return status;
}

/// Grow one polytope at a slightly larger rate, which must close if only there is room. Less excess each time it does.
static bat_status grow_at_larger_rate(bound_search *search, size_t vertices, bat_error *error)
{
    joint_radius *result = search->words.result;
    const matrix_set *set = search->words.set;
    const double rate = result->lower * (1.0 + search->excess);
    // So many points of half an ellipse that their hull contains it when shrunk by 1 + excess / 2.
    const double phases = ceil(1.6 / sqrt(search->excess)) + 1.0;
    if (rate >= result->upper)
    {
        search->excess *= EXCESS_RATIO;
        return BAT_OK;
    }
    if (phases > (double)vertices)
    {
        search->excess = 0.0;
        return BAT_OK;
    }
    polytope_growth growth;
    bat_status status = joint_radius_growth(set, set, result, rate, (size_t)phases, vertices, &growth, error);
    if (status != BAT_OK)
        return status;
    bool closed = false;
    while (status == BAT_OK && !closed && !growth.full)
    {
        double bound;
        status = polytope_growth_round(&growth, &bound, &closed, error);
        if (status == BAT_OK)
            result->upper = fmin(result->upper, bound);
    }
    search->excess = closed ? search->excess * EXCESS_RATIO : 0.0;
    polytope_growth_free(&growth);
    return status;
}

static bat_status deepen(bound_search *search, size_t depth, const joint_radius_limits *limits, bat_error *error)
{
    const matrix_set *set = search->words.set;
    joint_radius *result = search->words.result;
    const double before = result->lower;
    bat_status status = BAT_OK;
    if (length_is_affordable(set, depth))
    {
        search->words.length = depth;
        status = visit_lyndon_words(&search->words, 0, 1);
        result->length = depth;
    }
    if (status != BAT_OK || result->lower == 0.0 || is_enough(result, limits))
        return status;
    const bool is_new = result->lower > before * (1.0 + RESTART);
    const size_t vertices = affordable_vertices(set, limits->vertices);
    if (vertices < 2 * set->dimension)
        return BAT_OK;
    status = grow_at_lower_bound(search, is_new, vertices, error);
    if (is_new && search->excess == 0.0)
        search->excess = FIRST_EXCESS;
    if (status == BAT_OK && !search->closed && search->excess > 0.0 && !is_enough(result, limits))
        status = grow_at_larger_rate(search, vertices, error);
    return status;
}

static bat_status search_memory(bound_search *search, size_t depth, bat_error *error)
{
    const size_t n = search->words.set->dimension;
    word_search *words = &search->words;
    words->products = memory_array(depth * n * n, sizeof *words->products);
    words->distance = memory_array(depth, sizeof *words->distance);
    words->scratch = memory_array(n * (n + 2), sizeof *words->scratch);
    if (words->products == NULL || words->distance == NULL || words->scratch == NULL)
        return error_memory(error, depth * n * n * sizeof *words->products);
    return BAT_OK;
}

static bat_status bound_scaled(const matrix_set *set, const joint_radius_limits *limits, double scale, joint_radius *result,
                               bat_error *error)
{
    joint_radius_limits scaled = *limits;
    scaled.stop_below = limits->stop_below / scale;
    scaled.stop_from = limits->stop_from / scale;
    *result = (joint_radius){.upper = limits->known_upper / scale};

    bound_search search = {.words = {.set = set, .result = result, .error = error}, .excess = FIRST_EXCESS};
    bat_status status = search_memory(&search, limits->depth, error);
    for (size_t depth = 1; depth <= limits->depth && status == BAT_OK && !is_enough(result, &scaled); depth++)
        status = deepen(&search, depth, &scaled, error);
    if (search.growing)
        polytope_growth_free(&search.growth);
    free(search.words.products);
    free(search.words.distance);
    free(search.words.scratch);
    return status;
}

/// The joint spectral radius of numbers is the largest modulus.
static void bound_numbers(const matrix_set *set, joint_radius *result)
{
    *result = (joint_radius){.length = 1, .leader_count = 1, .leaders = {{.length = 1}}};
    for (size_t m = 0; m < set->count; m++)
    {
        if (fabs(set->entries[m]) <= result->upper)
            continue;
        result->lower = result->upper = fabs(set->entries[m]);
        result->leaders[0].letters[0] = (unsigned char)m;
        result->leaders[0].growth = result->upper;
    }
}

bat_status joint_radius_bound(const matrix_set *set, const joint_radius_limits *limits, joint_radius *result,
                              bat_error *error)
{
    if (set->dimension == 1)
    {
        bound_numbers(set, result);
        return BAT_OK;
    }
    matrix_set copy;
    bat_status status = matrix_set_make(set->dimension, set->count, &copy, error);
    if (status != BAT_OK)
        return status;
    memcpy(copy.entries, set->entries, set->count * set->dimension * set->dimension * sizeof *copy.entries);
    matrix_set_balance(&copy);
    const double scale = scale_to_unit(&copy);
    status = bound_scaled(&copy, limits, scale, result, error);
    matrix_set_free(&copy);
    result->lower *= scale;
    result->upper *= scale;
    for (size_t l = 0; l < result->leader_count; l++)
        result->leaders[l].growth *= scale;
    return status;
}
