#include "test_io_helpers.h"

#include "batten/curve_measure.h"
#include "batten/research/map_shapes.h"
#include "space/degrees.h"

#include <jansson.h>

/// The units of a degree in which the vertices are whole numbers.
static const double UNITS = 1e6;

typedef struct map_edge
{
    int64_t ends[4]; ///< longitude, latitude, longitude, latitude
    size_t curve;
} map_edge;

static bat_curve_set make_map(size_t countries, size_t detail, uint64_t seed)
{
    bat_curve_set set = {0};
    bat_error error = {0};
    const bat_shape_map_options options = {countries, detail, seed};
    if (bat_shape_map(&options, &set, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return set;
}

static int compare_edges(const void *a, const void *b)
{
    const map_edge *p = a, *q = b;
    for (int k = 0; k < 4; k++)
        if (p->ends[k] != q->ends[k])
            return p->ends[k] < q->ends[k] ? -1 : 1;
    return 0;
}

/// The edges of all rings, sorted. `count` receives their number.
static map_edge *sorted_edges(const bat_curve_set *set, size_t *count)
{
    const double units_per_radian = UNITS * 180 / 3.14159265358979323846;
    size_t total = 0;
    for (size_t i = 0; i < set->count; i++)
        total += set->curves[i].count;
    map_edge *edges = malloc(total * sizeof *edges), *edge = edges;
    assert_non_null(edges);
    for (size_t i = 0; i < set->count; i++)
        for (size_t k = 0; k < set->curves[i].count; k++, edge++)
        {
            const bat_curve *curve = &set->curves[i];
            assert_true(curve->closed);
            degree_units from = degrees_of_point(curve->points + 3 * k, units_per_radian);
            degree_units to = degrees_of_point(curve->points + 3 * ((k + 1) % curve->count), units_per_radian);
            *edge = (map_edge){{from.longitude, from.latitude, to.longitude, to.latitude}, i};
        }
    qsort(edges, total, sizeof *edges, compare_edges);
    *count = total;
    return edges;
}

static const map_edge *find_reverse(const map_edge *edges, size_t count, const map_edge *edge)
{
    const map_edge sought = {{edge->ends[2], edge->ends[3], edge->ends[0], edge->ends[1]}, 0};
    return bsearch(&sought, edges, count, sizeof *edges, compare_edges);
}

/// What borders have in common: no edge is used twice in one direction, and every vertex ends as many edges of a coast as it
/// begins. Counts the edges with a feature on both sides, and those of them along a meridian that are long.
static void check_borders(const bat_curve_set *set, size_t *shared, size_t *meridians)
{
    size_t count, coast = 0;
    map_edge *edges = sorted_edges(set, &count);
    *shared = *meridians = 0;
    for (size_t i = 0; i < count; i++)
    {
        assert_true(i == 0 || compare_edges(&edges[i - 1], &edges[i]) != 0);
        const map_edge *reverse = find_reverse(edges, count, &edges[i]);
        coast += reverse == NULL;
        if (reverse == NULL)
            continue;
        assert_int_not_equal(reverse->curve, edges[i].curve);
        (*shared)++;
        const int64_t *ends = edges[i].ends;
        *meridians += ends[0] == ends[2] && (double)llabs(ends[1] - ends[3]) > UNITS;
    }
    assert_true(coast > 0);
    free(edges);
}

static void check_simple(const bat_curve_set *set)
{
    bool *simple = calloc(set->count, sizeof *simple);
    assert_non_null(simple);
    assert_int_equal(bat_curves_are_simple(set->curves, set->count, NULL, simple, NULL), BAT_OK);
    for (size_t i = 0; i < set->count; i++)
        assert_true(simple[i]);
    free(simple);
}

/// What a written geometry reaches.
typedef struct map_reach
{
    bool east, west, pole; ///< 180 degrees, -180 degrees, the south pole
    size_t rings;
} map_reach;

static void add_reach(const json_t *coordinates, map_reach *reach)
{
    const json_t *first = json_array_get(coordinates, 0);
    if (json_is_number(first))
    {
        reach->east = reach->east || json_number_value(first) == 180;
        reach->west = reach->west || json_number_value(first) == -180;
        reach->pole = reach->pole || json_number_value(json_array_get(coordinates, 1)) == -90;
        return;
    }
    reach->rings += json_is_array(first) && json_is_number(json_array_get(first, 0));
    for (size_t i = 0; i < json_array_size(coordinates); i++)
        add_reach(json_array_get(coordinates, i), reach);
}

static void test_borders_are_shared(void **state)
{
    (void)state;
    static const size_t maps[][3] = {{200, 2, 1}, {12, 1, 2}, {40, 4, 3}, {600, 1, 4}, {60, 7, 5}};
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
    {
        size_t shared, meridians;
        bat_curve_set set = make_map(maps[i][0], maps[i][1], maps[i][2]);
        check_borders(&set, &shared, &meridians);
        assert_true(shared > 10 * maps[i][0]);
        assert_int_equal(shared % 2, 0);
        assert_true(meridians >= 2);
        check_simple(&set);
        bat_curve_set_free(&set);
    }
}

/// The numbers of features by kind, and of those over the pole and over 180 degrees, in the file.
static void test_features_are_as_promised(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 6; seed++)
    {
        bat_curve_set set = make_map(150, 1, seed);
        char *text = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
        json_t *map = json_loads(text, 0, NULL), *features = json_object_get(map, "features");
        size_t countries = 0, enclaves = 0, lakes = 0, poles = 0, across = 0, holes = 0;
        for (size_t i = 0; i < json_array_size(features); i++)
        {
            json_t *feature = json_array_get(features, i), *properties = json_object_get(feature, "properties");
            json_t *geometry = json_object_get(feature, "geometry");
            const char *kind = json_string_value(json_object_get(properties, "kind"));
            map_reach reach = {0};
            add_reach(json_object_get(geometry, "coordinates"), &reach);
            assert_true(json_string_length(json_object_get(properties, "name")) > 2);
            assert_true(json_is_integer(json_object_get(properties, "population")));
            assert_true(json_is_string(json_object_get(feature, "id")));
            countries += strcmp(kind, "country") == 0;
            enclaves += strcmp(kind, "enclave") == 0;
            lakes += strcmp(kind, "lake") == 0;
            poles += reach.pole;
            across += reach.east && reach.west && !reach.pole;
            bool single = strcmp(json_string_value(json_object_get(geometry, "type")), "Polygon") == 0;
            holes += single ? reach.rings - 1 : 0;
        }
        assert_int_equal(countries + enclaves, 150);
        assert_true(enclaves >= 3);
        assert_true(lakes >= 10);
        assert_int_equal(poles, 1);
        assert_true(across >= 3);
        assert_true(holes >= 5);
        json_decref(map);
        free(text);
        bat_curve_set_free(&set);
    }
}

static void test_same_seed_gives_same_map(void **state)
{
    (void)state;
    char *texts[3];
    static const uint64_t seeds[3] = {7, 7, 8};
    for (int i = 0; i < 3; i++)
    {
        bat_curve_set set = make_map(30, 2, seeds[i]);
        texts[i] = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
        bat_curve_set_free(&set);
    }
    assert_string_equal(texts[0], texts[1]);
    assert_string_not_equal(texts[0], texts[2]);
    for (int i = 0; i < 3; i++)
        free(texts[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_borders_are_shared),
        cmocka_unit_test(test_features_are_as_promised),
        cmocka_unit_test(test_same_seed_gives_same_map),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
