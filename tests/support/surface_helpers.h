#ifndef TESTS_SUPPORT_SURFACE_HELPERS_H
#define TESTS_SUPPORT_SURFACE_HELPERS_H

// Spline surfaces in memory as files: made at random, written, read, compared.

#include "check.h"

#include "io/surface/formats.h"
#include "surface/spline/hierarchical_space.h"

/// What a random surface is made of.
typedef struct surface_kind
{
    int degree[2];
    size_t spans[2];
    bool truncated;
    int admissible;
    size_t dimension;
    int refinements;
} surface_kind;

static inline uint32_t random_below(bat_random *random, uint32_t limit)
{
    return (uint32_t)(bat_random_bits(random) % limit);
}

/// Refine a few random boxes of random levels.
static inline bat_hierarchical_space *random_space(const surface_kind *kind, bat_random *random)
{
    bat_hierarchical_options options = bat_hierarchical_defaults();
    memcpy(options.degree, kind->degree, sizeof options.degree);
    memcpy(options.spans, kind->spans, sizeof options.spans);
    options.truncated = kind->truncated;
    options.admissible = kind->admissible;
    bat_hierarchical_space *space = NULL;
    check_status(bat_hierarchical_space_make(&options, &space, NULL), BAT_OK);
    for (int i = 0; i < kind->refinements; i++)
    {
        bat_spline_box box = {.level = random_below(random, 3)};
        for (int d = 0; d < 2; d++)
        {
            uint32_t cells = (uint32_t)kind->spans[d] << box.level;
            box.low[d] = random_below(random, cells);
            box.high[d] = box.low[d] + 1 + random_below(random, cells - box.low[d] < 3 ? cells - box.low[d] : 3);
        }
        check_status(bat_hierarchical_space_refine(space, &box, 1, NULL), BAT_OK);
    }
    return space;
}

/// Control points of any magnitude, negative zero among them.
static inline bat_spline_surface random_surface(const surface_kind *kind, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    bat_spline_surface surface = {.space = random_space(kind, &random), .dimension = kind->dimension};
    size_t count = bat_hierarchical_space_functions(surface.space) * kind->dimension;
    surface.control = malloc(count * sizeof *surface.control);
    for (size_t i = 0; i < count; i++)
        surface.control[i] = ldexp(bat_random_uniform(&random) - 0.5, (int)random_below(&random, 60) - 30);
    surface.control[0] = -0.0;
    surface.control[count - 1] = 1e17;
    return surface;
}

/// A sheet over the square of the truncated basis: (u, v, height), with random heights.
static inline bat_spline_surface random_sheet(const surface_kind *kind, uint64_t seed)
{
    bat_spline_surface surface = random_surface(kind, seed);
    bat_random random = bat_random_seed(seed + 1);
    bat_hierarchical_options options = bat_hierarchical_space_options(surface.space);
    size_t count = bat_hierarchical_space_functions(surface.space);
    for (size_t f = 0; f < count; f++)
    {
        // The truncated basis keeps coefficients: those of u and v are the Greville abscissae of each function's level.
        bat_spline_function function = hierarchical_space_function(surface.space, f);
        const uint32_t index[2] = {function.i, function.j};
        for (int d = 0; d < 2; d++)
        {
            double spans = ldexp((double)options.spans[d], (int)function.level), sum = 0;
            for (int k = 1; k <= options.degree[d]; k++)
                sum += fmin(fmax((double)index[d] + k - options.degree[d], 0), spans);
            surface.control[3 * f + (size_t)d] = sum / (spans * options.degree[d]);
        }
        surface.control[3 * f + 2] = 0.2 * bat_random_uniform(&random);
    }
    return surface;
}

/// The text of a surface in a format; ends with a zero.
static inline char *must_write(const bat_spline_surface *surface, bat_surface_format format,
                               const bat_surface_write_options *options)
{
    const bat_surface_write_options defaults = {0};
    text_buffer buffer = {0};
    text_sink sink = {.buffer = &buffer};
    bat_error error = {0};
    if (surface_check(surface, format, options != NULL ? options : &defaults, &error) != BAT_OK ||
        surface_write_text(surface, format, options != NULL ? options : &defaults, &sink, &error) != BAT_OK)
        fail_msg("%s", error.text);
    text_append(&buffer, "", 1);
    return buffer.data;
}

static inline bat_status read_string(const char *string, bat_spline_surface *surface, bat_error *error)
{
    file_text text;
    check_status(file_text_copy(string, strlen(string), NULL, &text, NULL), BAT_OK);
    bat_status status = surface_read_text(&text, surface, error);
    file_text_free(&text);
    return status;
}

static inline bat_spline_surface must_read(const char *string)
{
    bat_spline_surface surface = {0};
    bat_error error = {0};
    if (read_string(string, &surface, &error) != BAT_OK)
        fail_msg("line %zu: %s", error.line, error.text);
    return surface;
}

/// The same functions with the same coefficients, bit by bit.
static inline void assert_same_surface(const bat_spline_surface *a, const bat_spline_surface *b)
{
    bat_hierarchical_options x = bat_hierarchical_space_options(a->space), y = bat_hierarchical_space_options(b->space);
    assert_memory_equal(x.degree, y.degree, sizeof x.degree);
    assert_memory_equal(x.spans, y.spans, sizeof x.spans);
    size_t functions = bat_hierarchical_space_functions(a->space), cells = bat_hierarchical_space_cells(a->space);
    assert_int_equal(bat_hierarchical_space_functions(b->space), functions);
    assert_int_equal(bat_hierarchical_space_cells(b->space), cells);
    for (size_t i = 0; i < functions; i++)
    {
        bat_spline_function f = hierarchical_space_function(a->space, i);
        assert_int_equal(hierarchical_space_find(b->space, f), i);
    }
    for (size_t i = 0; i < cells; i++)
    {
        bat_spline_box p = bat_hierarchical_space_cell(a->space, i), q = bat_hierarchical_space_cell(b->space, i);
        assert_memory_equal(&p, &q, sizeof p);
    }
    assert_int_equal(a->dimension, b->dimension);
    assert_memory_equal(a->control, b->control, functions * a->dimension * sizeof *a->control);
}

/// Position of the surface.
static inline void evaluate_at(const bat_spline_surface *surface, double u, double v, double *position)
{
    const double parameter[2] = {u, v};
    check_status(bat_spline_surface_evaluate(surface, parameter, 1, 0, position, NULL), BAT_OK);
}

#endif
