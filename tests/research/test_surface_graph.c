// Radius graphs against all pairs, points on the rim among them, and sums over neighbours against loops.

#include "check.h"

#include "batten/base.h"
#include "research/networks/radius_graph.h"

static void *test_memory(size_t count, size_t size)
{
    void *memory = aligned_alloc(64, (count * size + 64) / 64 * 64);
    assert_non_null(memory);
    memset(memory, 0, (count * size + 64) / 64 * 64);
    return memory;
}

static bool has(const uint64_t *bits, size_t words, size_t target, size_t source)
{
    return (bits[target * words + source / SURFACE_WORD] >> (source % SURFACE_WORD) & 1) != 0;
}

static double squared_distance(const real *x, const real *y, size_t width)
{
    double square = 0;
    for (size_t c = 0; c < width; c++)
        square += ((double)x[c] - (double)y[c]) * ((double)x[c] - (double)y[c]);
    return square;
}

/// Returns how many edges there are.
static size_t check_graph(const real *targets, size_t target_count, const real *points, size_t count, size_t width,
                          double radius)
{
    size_t words = surface_words(count), edges = 0;
    real *memory = test_memory(surface_sources_size(count, width), sizeof *memory);
    uint64_t *bits = test_memory(target_count * words, sizeof *bits);
    uint32_t *degrees = test_memory(target_count, sizeof *degrees);
    memset(bits, 0xff, target_count * words * sizeof *bits);
    surface_sources sources = surface_sources_make(points, count, width, memory);
    surface_neighbours(&sources, targets, target_count, radius, bits, degrees);
    for (size_t i = 0; i < target_count; i++)
    {
        size_t degree = 0;
        for (size_t j = 0; j < words * SURFACE_WORD; j++)
        {
            bool near = j < count && squared_distance(targets + i * width, points + j * width, width) <= radius * radius;
            assert_int_equal(has(bits, words, i, j), near);
            degree += near;
        }
        assert_int_equal(degrees[i], degree);
        edges += degree;
    }
    free(memory);
    free(bits);
    free(degrees);
    return edges;
}

static real *random_rows(size_t count, size_t width, double middle, double spread, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    real *rows = test_memory(count * width, sizeof *rows);
    for (size_t i = 0; i < count * width; i++)
        rows[i] = (real)(middle + spread * bat_random_normal(&random));
    return rows;
}

static void graphs_are_those_of_all_pairs(void **state)
{
    (void)state;
    static const size_t widths[] = {1, 2, 3, 64}, counts[] = {1, 5, 31, 64, 65, 200, 1100};
    for (size_t w = 0; w < 4; w++)
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
        {
            // Far from the origin most pairs are too near the radius for the product to tell.
            for (int far = 0; far < 3; far++)
            {
                double spread = 0.08 / sqrt((double)widths[w]);
                real *x = random_rows(counts[c], widths[w], far, spread, c);
                real *y = random_rows(77, widths[w], far, spread, 100 + c);
                assert_true(check_graph(x, counts[c], x, counts[c], widths[w], 0.1) >= counts[c]);
                (void)check_graph(y, 77, x, counts[c], widths[w], 0.1);
                free(x);
                free(y);
            }
        }
}

/// On a lattice whose steps a float holds exactly, the radius is met exactly: 5^2 = 3^2 + 4^2.
static void the_rim_belongs_to_the_neighbourhood(void **state)
{
    (void)state;
    enum
    {
        SIDE = 21
    };
    real *x = test_memory(SIDE * SIDE * 3, sizeof *x);
    for (size_t i = 0; i < SIDE; i++)
        for (size_t j = 0; j < SIDE; j++)
        {
            x[3 * (i * SIDE + j)] = (real)i / 64;
            x[3 * (i * SIDE + j) + 1] = (real)j / 64;
            x[3 * (i * SIDE + j) + 2] = 1;
        }
    size_t with = check_graph(x, SIDE * SIDE, x, SIDE * SIDE, 3, 5.0 / 64);
    size_t without = check_graph(x, SIDE * SIDE, x, SIDE * SIDE, 3, 4.999 / 64);
    // Steps (5, 0) and (0, 5) both ways, and (3, 4) and (4, 3) with all signs.
    assert_int_equal(with - without, 2 * 2 * SIDE * (SIDE - 5) + 2 * 4 * (SIDE - 3) * (SIDE - 4));
    free(x);
}

static void sums_are_those_of_loops(void **state)
{
    (void)state;
    static const size_t counts[] = {1, 64, 100, 400};
    bat_random random = bat_random_seed(5);
    for (size_t c = 0; c < 4; c++)
        for (int share = 0; share <= 10; share++)
        {
            size_t count = counts[c], words = surface_words(count);
            real *features = random_rows(count, SURFACE_WIDTH, 0, 1, c),
                 *word_sums = test_memory(words * SURFACE_WIDTH, sizeof(real));
            uint64_t *bits = test_memory(words, sizeof *bits);
            double expected[SURFACE_WIDTH] = {0};
            real sum[SURFACE_WIDTH];
            for (size_t j = 0; j < count; j++)
                if (10 * bat_random_uniform(&random) < share)
                {
                    bits[j / SURFACE_WORD] |= UINT64_C(1) << (j % SURFACE_WORD);
                    for (size_t f = 0; f < SURFACE_WIDTH; f++)
                        expected[f] += (double)features[j * SURFACE_WIDTH + f];
                }
            surface_word_sums(features, count, word_sums);
            surface_sum(bits, features, count, word_sums, sum);
            for (size_t f = 0; f < SURFACE_WIDTH; f++)
                check_near((double)sum[f], expected[f], 1e-6 * (double)count);
            free(features);
            free(word_sums);
            free(bits);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(graphs_are_those_of_all_pairs),
        cmocka_unit_test(the_rim_belongs_to_the_neighbourhood),
        cmocka_unit_test(sums_are_those_of_loops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
