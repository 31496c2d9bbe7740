#ifndef TESTS_SUPPORT_HIERARCHICAL_HELPERS_H
#define TESTS_SUPPORT_HIERARCHICAL_HELPERS_H

// Random hierarchies, and what a hierarchy is by definition: one bit for each cell of each level that says whether it is
// refined.

#include "check.h"

#include "batten/spline.h"

static inline double uniform(bat_random *random, double low, double high)
{
    return low + (high - low) * bat_random_uniform(random);
}

static inline size_t below(bat_random *random, size_t count)
{
    return (size_t)(bat_random_bits(random) % count);
}

static inline bat_hierarchical_options random_options(bat_random *random, int max_degree)
{
    bat_hierarchical_options options = bat_hierarchical_defaults();
    for (int d = 0; d < 2; d++)
    {
        options.degree[d] = 1 + (int)below(random, (size_t)max_degree);
        options.spans[d] = 1 + below(random, 6);
    }
    return options;
}

/// A box anywhere in the grid of a level, often small.
static inline bat_spline_box random_box(bat_random *random, const bat_hierarchical_options *options, uint32_t level)
{
    bat_spline_box box = {.level = level};
    for (int d = 0; d < 2; d++)
    {
        size_t spans = options->spans[d] << level, size = 1 + below(random, 1 + below(random, spans));
        box.low[d] = (uint32_t)below(random, spans - size + 1);
        box.high[d] = box.low[d] + (uint32_t)size;
    }
    return box;
}

/// Boxes of cells to refine, of levels 0 to levels - 2 in any order.
static inline size_t random_boxes(bat_random *random, const bat_hierarchical_options *options, uint32_t levels,
                                  bat_spline_box *boxes, size_t most)
{
    size_t count = 1 + below(random, most);
    for (size_t i = 0; i < count; i++)
        boxes[i] = random_box(random, options, (uint32_t)below(random, levels - 1));
    return count;
}

static inline bat_hierarchical_space *make_space(const bat_hierarchical_options *options)
{
    bat_hierarchical_space *space;
    bat_error error = {0};
    if (bat_hierarchical_space_make(options, &space, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return space;
}

static inline void refine_space(bat_hierarchical_space *space, const bat_spline_box *boxes, size_t count)
{
    bat_error error = {0};
    if (bat_hierarchical_space_refine(space, boxes, count, &error) != BAT_OK)
        fail_msg("%s", error.text);
}

/// A space with levels up to `levels`, refined in one or two steps.
static inline bat_hierarchical_space *random_space(bat_random *random, const bat_hierarchical_options *options,
                                                   uint32_t levels)
{
    bat_hierarchical_space *space = make_space(options);
    for (size_t step = 0; step < 1 + below(random, 2); step++)
    {
        bat_spline_box boxes[6];
        size_t count = random_boxes(random, options, levels, boxes, 6);
        refine_space(space, boxes, count);
    }
    return space;
}

enum
{
    MAP_LEVELS = 5
};

/// Which cells are refined, by definition.
typedef struct refined_map
{
    size_t spans[2];
    bool *refined[MAP_LEVELS]; ///< of level l: spans[0] 2^l x spans[1] 2^l, rows of columns
} refined_map;

static inline refined_map map_make(const bat_hierarchical_options *options)
{
    refined_map map = {.spans = {options->spans[0], options->spans[1]}};
    for (size_t l = 0; l < MAP_LEVELS; l++)
    {
        map.refined[l] = calloc((map.spans[0] * map.spans[1]) << (2 * l), sizeof(bool));
        assert_non_null(map.refined[l]);
    }
    return map;
}

static inline void map_free(refined_map *map)
{
    for (size_t l = 0; l < MAP_LEVELS; l++)
        free(map->refined[l]);
}

static inline bool *map_at(const refined_map *map, size_t level, size_t column, size_t row)
{
    return &map->refined[level][row * (map->spans[0] << level) + column];
}

/// Refine a box's cells and all that hold them.
static inline void map_refine(const refined_map *map, const bat_spline_box *box)
{
    for (size_t row = box->low[1]; row < box->high[1]; row++)
        for (size_t column = box->low[0]; column < box->high[0]; column++)
            for (size_t up = 0; up <= box->level; up++)
                *map_at(map, box->level - up, column >> up, row >> up) = true;
}

/// Whether a cell lies in the region of its level.
static inline bool map_in_region(const refined_map *map, size_t level, size_t column, size_t row)
{
    return level == 0 || *map_at(map, level - 1, column / 2, row / 2);
}

/// Whether a function's support lies in the region of its level, or, `next`, in that of the next level.
static inline bool map_supports(const refined_map *map, const int degree[2], bat_spline_function function, bool next)
{
    size_t p = (size_t)degree[0], q = (size_t)degree[1], width = map->spans[0] << function.level;
    size_t height = map->spans[1] << function.level;
    for (size_t row = function.j < q ? 0 : function.j - q; row <= function.j && row < height; row++)
        for (size_t column = function.i < p ? 0 : function.i - p; column <= function.i && column < width; column++)
            if (!(next ? *map_at(map, function.level, column, row) : map_in_region(map, function.level, column, row)))
                return false;
    return true;
}

#endif
