#include "linalg/leading_orbit.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// product = letters[0] letters[1] …; `other` is room for a matrix.
static void multiply_word(const matrix_set *set, const matrix_word *word, double *product, double *other)
{
    const size_t n = set->dimension;
    memcpy(product, matrix_set_at(set, word->letters[0]), n * n * sizeof *product);
    for (size_t t = 1; t < word->length; t++)
    {
        dense_multiply(n, product, matrix_set_at(set, word->letters[t]), other);
        memcpy(product, other, n * n * sizeof *product);
    }
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
    multiply_word(set, word, product, product + n * n);
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

bat_status leading_orbits(const matrix_set *set, const joint_radius *radius, double rate, size_t phases, double **vectors,
                          size_t *count, bat_error *error)
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
