#include "hierarchical_helpers.h"

#include "surface/spline/hierarchical_space.h"

/// Areas raised in any order against an array of levels; the tree's depth stays within its bound.
static void check_tree(bat_random *random)
{
    enum
    {
        MOST = 48
    };
    uint8_t levels[MOST * MOST] = {0};
    uint64_t width = 1 + below(random, MOST), height = 1 + below(random, MOST), covered = 0;
    box_tree tree, tidy;
    assert_int_equal(box_tree_make(width, height, &tree, NULL), BAT_OK);
    for (size_t k = 0; k < 40; k++)
    {
        box_tree_area area;
        area.low[0] = below(random, (size_t)width);
        area.low[1] = below(random, (size_t)height);
        area.high[0] = area.low[0] + 1 + below(random, (size_t)(width - area.low[0]));
        area.high[1] = area.low[1] + 1 + below(random, (size_t)(height - area.low[1]));
        uint8_t level = (uint8_t)(1 + below(random, 6)), least = UINT8_MAX;
        for (uint64_t y = area.low[1]; y < area.high[1]; y++)
            for (uint64_t x = area.low[0]; x < area.high[0]; x++)
                least = levels[y * MOST + x] < least ? levels[y * MOST + x] : least;
        for (uint8_t l = 0; l < 8; l++)
            assert_int_equal(box_tree_reaches(&tree, &area, l), least >= l);
        if (k % 2 == 0)
            continue;
        assert_int_equal(box_tree_raise(&tree, &area, level, NULL), BAT_OK);
        for (uint64_t y = area.low[1]; y < area.high[1]; y++)
            for (uint64_t x = area.low[0]; x < area.high[0]; x++)
                levels[y * MOST + x] = levels[y * MOST + x] > level ? levels[y * MOST + x] : level;
    }
    assert_int_equal(box_tree_copy(&tree, &tidy, NULL), BAT_OK);
    box_tree_leaf *leaves;
    size_t count;
    assert_int_equal(box_tree_leaves(&tidy, &leaves, &count, NULL), BAT_OK);
    assert_int_equal(tidy.count, 2 * count - 1);
    for (size_t i = 0; i < count; i++)
        for (uint64_t y = leaves[i].area.low[1]; y < leaves[i].area.high[1]; y++)
            for (uint64_t x = leaves[i].area.low[0]; x < leaves[i].area.high[0]; x++, covered++)
            {
                assert_int_equal(leaves[i].level, levels[y * MOST + x]);
                assert_int_equal(box_tree_level(&tree, x, y), levels[y * MOST + x]);
                assert_int_equal(box_tree_level(&tidy, x, y), levels[y * MOST + x]);
            }
    assert_int_equal(covered, width * height);
    free(leaves);
    box_tree_free(&tree);
    box_tree_free(&tidy);
}

static void test_box_tree(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    for (int trial = 0; trial < 100; trial++)
        check_tree(&random);
}

static size_t tree_depth(const box_tree *tree, uint32_t node)
{
    const box_tree_node *here = &tree->nodes[node];
    if (here->child[0] == 0)
        return 0;
    size_t a = tree_depth(tree, here->child[0]), b = tree_depth(tree, here->child[1]);
    return 1 + (a > b ? a : b);
}

/// Every other place raised from left to right makes no list of the tree, and what is whole again is one box.
static void test_box_tree_depth(void **state)
{
    (void)state;
    box_tree tree;
    assert_int_equal(box_tree_make(1000, 3, &tree, NULL), BAT_OK);
    for (uint64_t parity = 0; parity < 2; parity++)
    {
        for (uint64_t x = parity; x < 1000; x += 2)
        {
            box_tree_area area = {{x, 0}, {x + 1, 3}};
            assert_int_equal(box_tree_raise(&tree, &area, 1, NULL), BAT_OK);
        }
        assert_true(tree_depth(&tree, 0) <= 10);
    }
    box_tree tidy;
    assert_int_equal(box_tree_copy(&tree, &tidy, NULL), BAT_OK);
    assert_int_equal(tidy.count, 1);
    box_tree_free(&tree);
    box_tree_free(&tidy);
}

/// A random hierarchy in the library's hands, and by definition.
typedef struct hierarchy
{
    bat_hierarchical_options options;
    bat_hierarchical_space *space;
    refined_map map;
} hierarchy;

static hierarchy random_hierarchy(bat_random *random)
{
    hierarchy made = {.options = random_options(random, 5)};
    made.options.truncated = below(random, 4) > 0;
    made.space = make_space(&made.options);
    made.map = map_make(&made.options);
    for (size_t step = 0; step < 1 + below(random, 3); step++)
    {
        bat_spline_box boxes[5];
        size_t count = random_boxes(random, &made.options, MAP_LEVELS, boxes, 5);
        refine_space(made.space, boxes, count);
        for (size_t i = 0; i < count; i++)
            map_refine(&made.map, &boxes[i]);
    }
    return made;
}

static void hierarchy_free(hierarchy *made)
{
    bat_hierarchical_space_free(made->space);
    map_free(&made->map);
}

/// The active cells are those of the definition, in order.
static void check_cells(const hierarchy *h)
{
    size_t index = 0;
    for (uint32_t level = 0; level < MAP_LEVELS; level++)
        for (uint32_t row = 0; row < h->options.spans[1] << level; row++)
            for (uint32_t column = 0; column < h->options.spans[0] << level; column++)
            {
                if (!map_in_region(&h->map, level, column, row) || *map_at(&h->map, level, column, row))
                    continue;
                bat_spline_box cell = bat_hierarchical_space_cell(h->space, index++);
                assert_int_equal(cell.level, level);
                assert_int_equal(cell.low[0], column);
                assert_int_equal(cell.low[1], row);
                assert_int_equal(cell.high[0], column + 1);
                assert_int_equal(cell.high[1], row + 1);
                assert_true(bat_hierarchical_space_levels(h->space) > level);
            }
    assert_int_equal(bat_hierarchical_space_cells(h->space), index);
}

/// The functions are Kraft's selection, in order, and found by their indices.
static void check_functions(const hierarchy *h)
{
    size_t index = 0;
    for (uint32_t level = 0; level < MAP_LEVELS; level++)
        for (uint32_t j = 0; j < (h->options.spans[1] << level) + (size_t)h->options.degree[1]; j++)
            for (uint32_t i = 0; i < (h->options.spans[0] << level) + (size_t)h->options.degree[0]; i++)
            {
                bat_spline_function function = {level, i, j};
                bool selected = map_supports(&h->map, h->options.degree, function, false) &&
                                !map_supports(&h->map, h->options.degree, function, true);
                assert_true(hierarchical_space_find(h->space, function) == (selected ? index : BAT_NO_INDEX));
                if (!selected)
                    continue;
                bat_spline_function found = hierarchical_space_function(h->space, index++);
                assert_memory_equal(&found, &function, sizeof found);
            }
    assert_int_equal(bat_hierarchical_space_functions(h->space), index);
    assert_true(hierarchical_space_find(h->space, (bat_spline_function){MAP_LEVELS, 0, 0}) == BAT_NO_INDEX);
    assert_true(hierarchical_space_find(h->space, (bat_spline_function){0, UINT32_MAX, 0}) == BAT_NO_INDEX);
}

/// The regions' boxes are disjoint and cover the regions; refining by them makes the same space.
static void check_regions(const hierarchy *h)
{
    bat_spline_box *boxes;
    size_t count, cells[MAP_LEVELS] = {0}, expected[MAP_LEVELS] = {0};
    assert_int_equal(hierarchical_space_regions(h->space, &boxes, &count, NULL), BAT_OK);
    for (size_t b = 0; b < count; b++)
    {
        assert_true(boxes[b].level >= 1 && (b == 0 || boxes[b].level >= boxes[b - 1].level));
        for (uint32_t row = boxes[b].low[1]; row < boxes[b].high[1]; row++)
            for (uint32_t column = boxes[b].low[0]; column < boxes[b].high[0]; column++, cells[boxes[b].level]++)
                assert_true(map_in_region(&h->map, boxes[b].level, column, row));
        for (size_t c = 0; c < b; c++)
            assert_true(boxes[b].level != boxes[c].level || boxes[b].high[0] <= boxes[c].low[0] ||
                        boxes[c].high[0] <= boxes[b].low[0] || boxes[b].high[1] <= boxes[c].low[1] ||
                        boxes[c].high[1] <= boxes[b].low[1]);
    }
    for (size_t level = 1; level < MAP_LEVELS; level++)
    {
        for (size_t i = 0; i < (h->map.spans[0] * h->map.spans[1]) << (2 * (level - 1)); i++)
            expected[level] += h->map.refined[level - 1][i] ? 4 : 0;
        assert_int_equal(cells[level], expected[level]);
    }
    bat_hierarchical_space *again = make_space(&h->options);
    for (size_t b = 0; b < count; b++)
    {
        boxes[b].level--;
        for (int d = 0; d < 2; d++)
        {
            boxes[b].low[d] /= 2;
            boxes[b].high[d] /= 2;
        }
    }
    refine_space(again, boxes, count);
    assert_int_equal(bat_hierarchical_space_functions(again), bat_hierarchical_space_functions(h->space));
    assert_int_equal(bat_hierarchical_space_cells(again), bat_hierarchical_space_cells(h->space));
    bat_hierarchical_space_free(again);
    free(boxes);
}

static void test_selection(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2);
    for (int trial = 0; trial < 60; trial++)
    {
        hierarchy h = random_hierarchy(&random);
        check_cells(&h);
        check_functions(&h);
        check_regions(&h);
        hierarchy_free(&h);
    }
}

/// Every parameter lies in its cell, borders being the doubles nearest to whole numbers over the count of cells.
static void check_located(const bat_hierarchical_space *space, double u, double v)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(space);
    bat_spline_box cell = bat_hierarchical_space_cell(space, bat_hierarchical_space_locate(space, u, v));
    double parameter[2] = {u, v};
    for (int d = 0; d < 2; d++)
    {
        double spans = (double)(options.spans[d] << cell.level);
        assert_true(cell.low[d] / spans <= parameter[d]);
        assert_true(parameter[d] < cell.high[d] / spans || (parameter[d] == 1 && cell.high[d] / spans == 1));
    }
}

static void test_locate(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    for (int trial = 0; trial < 30; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 3);
        options.spans[0] = (size_t[]){1, 3, 7, 49, 161, 107}[trial % 6];
        bat_hierarchical_space *space = random_space(&random, &options, 4);
        for (int k = 0; k < 300; k++)
            check_located(space, bat_random_uniform(&random), bat_random_uniform(&random));
        size_t spans = options.spans[0] * 16;
        for (size_t c = 0; c <= spans; c++)
        {
            double u = (double)c / (double)spans, v = (double)below(&random, 9) / 8;
            check_located(space, u, v);
            check_located(space, nextafter(u, 0), v);
            check_located(space, fmin(nextafter(u, 2), 1), 1);
        }
        bat_hierarchical_space_free(space);
    }
}

static void check_equal_spaces(const bat_hierarchical_space *a, const bat_hierarchical_space *b)
{
    assert_int_equal(bat_hierarchical_space_functions(a), bat_hierarchical_space_functions(b));
    assert_int_equal(bat_hierarchical_space_cells(a), bat_hierarchical_space_cells(b));
    assert_int_equal(bat_hierarchical_space_levels(a), bat_hierarchical_space_levels(b));
    assert_int_equal(hierarchical_space_max_active(a), hierarchical_space_max_active(b));
    for (size_t f = 0; f < bat_hierarchical_space_functions(a); f++)
        assert_true(hierarchical_space_find(b, hierarchical_space_function(a, f)) == f);
    for (size_t c = 0; c < bat_hierarchical_space_cells(a); c++)
    {
        bat_spline_box here = bat_hierarchical_space_cell(a, c), there = bat_hierarchical_space_cell(b, c);
        const uint32_t *actives[2];
        size_t count = bat_hierarchical_space_active(a, c, &actives[0]);
        assert_memory_equal(&here, &there, sizeof here);
        assert_int_equal(bat_hierarchical_space_active(b, c, &actives[1]), count);
        assert_memory_equal(actives[0], actives[1], count * sizeof *actives[0]);
    }
}

/// One call or many, in any order, with or without a class of admissibility: the same space.
static void test_order_of_refinement(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    for (int trial = 0; trial < 40; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 4);
        options.admissible = (int[]){0, 2, 3, 4}[trial % 4];
        bat_hierarchical_space *at_once = make_space(&options), *one_by_one = make_space(&options), *copy;
        bat_spline_box boxes[6];
        size_t count = random_boxes(&random, &options, 4, boxes, 6);
        refine_space(at_once, boxes, count);
        for (size_t i = count; i-- > 0;)
            refine_space(one_by_one, &boxes[i], 1);
        refine_space(one_by_one, boxes, count);
        check_equal_spaces(at_once, one_by_one);
        assert_int_equal(hierarchical_space_copy(at_once, &copy, NULL), BAT_OK);
        check_equal_spaces(at_once, copy);
        bat_hierarchical_space_free(at_once);
        bat_hierarchical_space_free(one_by_one);
        bat_hierarchical_space_free(copy);
    }
}

/// A refined space that would have too many functions is only counted.
static void test_counted(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    for (int trial = 0; trial < 20; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 4);
        bat_hierarchical_space *space = make_space(&options), *refined = make_space(&options), *made;
        bat_spline_box boxes[6];
        size_t count = random_boxes(&random, &options, 4, boxes, 6), functions, counted;
        refine_space(refined, boxes, count);
        functions = bat_hierarchical_space_functions(refined);
        assert_int_equal(hierarchical_space_refined(space, boxes, count, functions - 1, &counted, &made, NULL), BAT_OK);
        assert_null(made);
        assert_int_equal(counted, functions);
        assert_int_equal(hierarchical_space_refined(space, boxes, count, functions, &counted, &made, NULL), BAT_OK);
        assert_int_equal(counted, functions);
        check_equal_spaces(made, refined);
        bat_hierarchical_space_free(space);
        bat_hierarchical_space_free(refined);
        bat_hierarchical_space_free(made);
    }
}

/// The most successive levels that a cell sees.
static uint32_t seen_levels(const bat_hierarchical_space *space)
{
    uint32_t most = 0;
    for (size_t c = 0; c < bat_hierarchical_space_cells(space); c++)
    {
        const uint32_t *active;
        size_t count = bat_hierarchical_space_active(space, c, &active);
        uint32_t coarsest = hierarchical_space_function(space, active[0]).level;
        uint32_t finest = hierarchical_space_function(space, active[count - 1]).level;
        assert_true(finest <= bat_hierarchical_space_cell(space, c).level);
        uint32_t seen = bat_hierarchical_space_cell(space, c).level - coarsest + 1;
        most = seen > most ? seen : most;
    }
    return most;
}

/// No cell sees functions of more than m levels; what was asked for is refined; without a class there are such cells.
static void test_admissible(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    uint32_t worst[2][5] = {{0}};
    for (int trial = 0; trial < 120; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 3);
        options.admissible = (int[]){0, 2, 3, 4}[trial % 4];
        options.truncated = trial % 3 != 0;
        bat_hierarchical_space *space = make_space(&options);
        for (uint32_t level = 0; level < 4; level++)
        {
            // Small boxes deep down see the most levels.
            bat_spline_box box = {.level = level};
            for (int d = 0; d < 2; d++)
            {
                box.low[d] = (uint32_t)below(&random, options.spans[d] << level);
                box.high[d] = box.low[d] + 1;
            }
            refine_space(space, &box, 1);
            double u = (box.low[0] + 0.5) / (double)(options.spans[0] << level);
            double v = (box.low[1] + 0.5) / (double)(options.spans[1] << level);
            size_t cell = bat_hierarchical_space_locate(space, u, v);
            assert_true(bat_hierarchical_space_cell(space, cell).level > level);
        }
        uint32_t seen = seen_levels(space), *kept = &worst[options.truncated][options.admissible];
        *kept = seen > *kept ? seen : *kept;
        bat_hierarchical_space_free(space);
    }
    for (size_t truncated = 0; truncated < 2; truncated++)
    {
        assert_true(worst[truncated][0] > 4);
        for (uint32_t m = 2; m <= 4; m++)
            assert_int_equal(worst[truncated][m], m);
    }
}

static void check_refused(bat_hierarchical_space *space, bat_spline_box box, bat_status expected)
{
    bat_hierarchical_space *before;
    bat_error error;
    const bat_spline_box boxes[] = {{0, {0, 0}, {1, 1}}, box};
    assert_int_equal(hierarchical_space_copy(space, &before, NULL), BAT_OK);
    assert_int_equal(bat_hierarchical_space_refine(space, boxes, 2, &error), expected);
    assert_int_equal(error.index, 1);
    check_equal_spaces(space, before);
    bat_hierarchical_space_free(before);
}

static void test_bad_input(void **state)
{
    (void)state;
    bat_hierarchical_space *space;
    bat_hierarchical_options options = bat_hierarchical_defaults(), bad = options;
    bad.degree[1] = 0;
    assert_int_equal(bat_hierarchical_space_make(&bad, &space, NULL), BAT_INVALID_ARGUMENT);
    bad.degree[1] = BAT_SPLINE_MAX_DEGREE + 1;
    assert_int_equal(bat_hierarchical_space_make(&bad, &space, NULL), BAT_INVALID_ARGUMENT);
    bad = options;
    bad.spans[0] = 0;
    assert_int_equal(bat_hierarchical_space_make(&bad, &space, NULL), BAT_INVALID_ARGUMENT);
    bad.spans[0] = SIZE_MAX;
    assert_int_equal(bat_hierarchical_space_make(&bad, &space, NULL), BAT_TOO_LARGE);
    bad.spans[0] = bad.spans[1] = 1 << 20;
    assert_int_equal(bat_hierarchical_space_make(&bad, &space, NULL), BAT_TOO_LARGE);
    bad = options;
    bad.admissible = 1;
    assert_int_equal(bat_hierarchical_space_make(&bad, &space, NULL), BAT_INVALID_ARGUMENT);
    options.spans[0] = 3;
    options.spans[1] = 2;
    space = make_space(&options);
    check_refused(space, (bat_spline_box){0, {0, 0}, {4, 1}}, BAT_INVALID_ARGUMENT);
    check_refused(space, (bat_spline_box){1, {0, 0}, {1, 5}}, BAT_INVALID_ARGUMENT);
    check_refused(space, (bat_spline_box){0, {1, 1}, {1, 2}}, BAT_INVALID_ARGUMENT);
    check_refused(space, (bat_spline_box){0, {2, 1}, {1, 2}}, BAT_INVALID_ARGUMENT);
    check_refused(space, (bat_spline_box){BAT_HIERARCHICAL_MAX_LEVELS - 1, {0, 0}, {1, 1}}, BAT_TOO_LARGE);
    check_refused(space, (bat_spline_box){UINT32_MAX, {0, 0}, {1, 1}}, BAT_TOO_LARGE);
    assert_int_equal(bat_hierarchical_space_refine(space, NULL, 0, NULL), BAT_OK);
    assert_int_equal(bat_hierarchical_space_functions(space), 20);
    bat_hierarchical_space_free(space);
    bat_hierarchical_space_free(NULL);
}

/// A corner refined to the last level.
static void test_most_levels(void **state)
{
    (void)state;
    bat_hierarchical_options options = bat_hierarchical_defaults();
    options.spans[0] = options.spans[1] = 8;
    options.admissible = 2;
    bat_hierarchical_space *space = make_space(&options);
    bat_spline_box corner = {.level = BAT_HIERARCHICAL_MAX_LEVELS - 2};
    for (int d = 0; d < 2; d++)
        corner.low[d] = (corner.high[d] = 8U << corner.level) - 1;
    refine_space(space, &corner, 1);
    assert_int_equal(bat_hierarchical_space_levels(space), BAT_HIERARCHICAL_MAX_LEVELS);
    size_t last = bat_hierarchical_space_locate(space, 1, 1);
    assert_true(last + 1 == bat_hierarchical_space_cells(space));
    assert_int_equal(bat_hierarchical_space_cell(space, last).high[0], 8 << (BAT_HIERARCHICAL_MAX_LEVELS - 1));
    assert_int_equal(bat_hierarchical_space_cell(space, bat_hierarchical_space_locate(space, 0, 0)).level, 0);
    assert_true(seen_levels(space) == 2);
    bat_hierarchical_space_free(space);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_tree),  cmocka_unit_test(test_box_tree_depth),      cmocka_unit_test(test_selection),
        cmocka_unit_test(test_locate),    cmocka_unit_test(test_order_of_refinement), cmocka_unit_test(test_admissible),
        cmocka_unit_test(test_bad_input), cmocka_unit_test(test_most_levels),         cmocka_unit_test(test_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
