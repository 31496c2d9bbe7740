#include "batten/research/map_shapes.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/option.h"
#include "base/text_buffer.h"
#include "batten/curve_file.h"
#include "io/common/number_text.h"
#include "research/shapes/map_rings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/// @file
/// Generated maps: from the cells over the rings to GeoJSON text, which is read as any other.

enum
{
    NAME_SIZE = 32,
    MAX_DETAIL = 10
};

/// A name and its number of inhabitants.
typedef struct map_title
{
    char name[NAME_SIZE];
    int64_t population;
} map_title;

bat_shape_map_options bat_shape_map_defaults(void)
{
    return (bat_shape_map_options){.countries = 200, .detail = 2, .seed = 1};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_shape_map_options, countries, OPTION_SIZE, MAP_MIN_COUNTRIES, MAP_MAX_COUNTRIES),
    OPTION_FIELD(bat_shape_map_options, detail, OPTION_SIZE, 1, MAX_DETAIL),
};

const bat_options_table bat_shape_map_fields = OPTIONS_TABLE(bat_shape_map_options, FIELDS, NULL);

static const char *pick(bat_random *random, const char *const *words, size_t count)
{
    return words[(size_t)(bat_random_uniform(random) * (double)count)];
}

/// An invented name: two or three syllables, and the ending of a country.
static void invent_name(bat_random *random, map_kind kind, char name[NAME_SIZE])
{
    static const char *const STARTS[] = {"b", "br", "c", "d", "f", "g",  "h", "k", "l", "m", "n",
                                         "p", "r",  "s", "t", "v", "st", "t", "z", "w", "tr"};
    static const char *const VOWELS[] = {"a", "e", "i", "o", "u", "a", "o", "ei", "au", "ia"};
    static const char *const ENDS[] = {"", "", "", "n", "r", "l", "s"};
    static const char *const ENDINGS[] = {"ia", "a", "land", "or", "", "ey", "mark", "ana"};
    size_t used = 0, syllables = bat_random_uniform(random) < 0.7 ? 2 : 3;
    if (kind == MAP_LAKE)
        used = (size_t)snprintf(name, NAME_SIZE, "Lake ");
    size_t first = used;
    for (size_t i = 0; i < syllables; i++)
    {
        const char *start = pick(random, STARTS, sizeof STARTS / sizeof *STARTS);
        const char *vowel = pick(random, VOWELS, sizeof VOWELS / sizeof *VOWELS);
        const char *end = i + 1 < syllables ? "" : pick(random, ENDS, sizeof ENDS / sizeof *ENDS);
        used += (size_t)snprintf(name + used, NAME_SIZE - used, "%s%s%s", start, vowel, end);
    }
    if (kind != MAP_LAKE)
    {
        const char *ending = pick(random, ENDINGS, sizeof ENDINGS / sizeof *ENDINGS);
        bool vowel = strchr("aeiou", name[used - 1]) != NULL;
        // Two vowels do not follow each other.
        bool clashes = vowel && ending[0] != '\0' && strchr("aeio", ending[0]) != NULL;
        (void)snprintf(name + used, NAME_SIZE - used, "%s%s", clashes ? "n" : "", ending);
    }
    name[first] = (char)(name[first] - 'a' + 'A');
}

/// The area of a polygon in square degrees at the equator, roughly.
static double area_of(const map_rings *map, const map_ring *ring)
{
    double area = 0, x = 0;
    for (size_t i = 0; i < ring->count; i++)
    {
        map_vertex a = map->vertices[ring->vertices[i]], b = map->vertices[ring->vertices[(i + 1) % ring->count]];
        double step = (double)map_step(b.longitude - a.longitude) / MAP_UNITS;
        double low = (double)a.latitude / MAP_UNITS, high = (double)b.latitude / MAP_UNITS;
        area += (x * high - (x + step) * low) * cos((low + high) * (3.14159265358979323846 / 360));
        x += step;
    }
    return fabs(area) / 2;
}

/// Inhabitants, with three digits that are not 0.
static int64_t invent_population(const map_rings *map, const map_area *area, bat_random *random)
{
    static const double DENSITY = 2e5, SPREAD = 1.2; // for a square degree
    double size = 0;
    for (size_t i = 0; i < area->count; i++)
        size += area->polygons[i].pole ? 0 : area_of(map, &area->polygons[i].rings[0]);
    double people = size * DENSITY * exp(SPREAD * bat_random_normal(random));
    double unit = people > 1000 ? pow(10, floor(log10(people)) - 2) : 1;
    int64_t population = (int64_t)(floor(people / unit) * unit);
    return area->kind == MAP_LAKE ? 0 : population;
}

/// Names that are all different, and populations.
static void invent_titles(const map_rings *map, bat_random *random, map_title *titles)
{
    for (size_t i = 0; i < map->area_count; i++)
    {
        bool taken = true;
        while (taken)
        {
            invent_name(random, map->areas[i].kind, titles[i].name);
            taken = false;
            for (size_t k = 0; k < i && !taken; k++)
                taken = strcmp(titles[k].name, titles[i].name) == 0;
        }
        titles[i].population = invent_population(map, &map->areas[i], random);
    }
}

static void write_ring(const map_rings *map, const map_ring *ring, text_buffer *text)
{
    for (size_t i = 0; i <= ring->count; i++)
    {
        map_vertex vertex = map->vertices[ring->vertices[i % ring->count]];
        char *out = text_reserve(text, 2 * NUMBER_TEXT_SIZE + 5);
        if (out == NULL)
            return;
        *out++ = i == 0 ? '[' : ',';
        *out++ = '[';
        out = number_write_fixed(out, vertex.longitude, MAP_DECIMALS);
        *out++ = ',';
        out = number_write_fixed(out, vertex.latitude, MAP_DECIMALS);
        *out++ = ']';
        if (i == ring->count)
            *out++ = ']';
        text_advance(text, out);
    }
}

static void write_polygon(const map_rings *map, const map_polygon *polygon, text_buffer *text)
{
    for (size_t i = 0; i < polygon->count; i++)
    {
        text_append_string(text, i == 0 ? "[" : ",");
        write_ring(map, &polygon->rings[i], text);
    }
    text_append_string(text, "]");
}

static void write_area(const map_rings *map, const map_area *area, const char *id, const map_title *title, text_buffer *text)
{
    static const char *const KINDS[] = {"country", "lake", "enclave"};
    enum
    {
        HEAD_SIZE = 200
    };
    char head[HEAD_SIZE];
    bool one = area->count == 1;
    (void)snprintf(
        head, sizeof head,
        "{\"type\":\"Feature\",\"id\":\"%s\",\"properties\":{\"name\":\"%s\",\"kind\":\"%s\",\"population\":%lld},"
        "\"geometry\":{\"type\":\"%s\",\"coordinates\":",
        id, title->name, KINDS[area->kind], (long long)title->population, one ? "Polygon" : "MultiPolygon");
    text_append_string(text, head);
    for (size_t i = 0; i < area->count; i++)
    {
        if (!one)
            text_append_string(text, i == 0 ? "[" : ",");
        write_polygon(map, &area->polygons[i], text);
    }
    text_append_string(text, one ? "}}" : "]}}");
}

static void write_map(const map_rings *map, const map_title *titles, text_buffer *text)
{
    size_t countries = 0, lakes = 0;
    text_append_string(text, "{\"type\":\"FeatureCollection\",\"features\":[\n");
    for (size_t i = 0; i < map->area_count; i++)
    {
        char id[16];
        bool lake = map->areas[i].kind == MAP_LAKE;
        (void)snprintf(id, sizeof id, "%c%03zu", lake ? 'L' : 'C', lake ? ++lakes : ++countries);
        text_append_string(text, i == 0 ? "" : ",\n");
        write_area(map, &map->areas[i], id, &titles[i], text);
    }
    text_append_string(text, "\n]}\n");
}

/// Make the rings of a map. False when out of memory.
static bool make_rings(const bat_shape_map_options *options, bat_random *random, map_rings *map)
{
    map_grid grid;
    map_land land;
    double turn;
    if (!map_grid_make(map_land_frequency(options->countries), random, &grid))
        return false;
    bool made = map_land_make(&grid, options->countries, random, &land);
    if (made)
    {
        made = map_land_turn(&grid, &land, &turn);
        map_grid_turn(&grid, turn);
        made = made && map_rings_make(&grid, &land, options->detail, bat_random_bits(random), map);
        if (made && !map_rings_split(map, land.split_count, random))
        {
            map_rings_free(map);
            made = false;
        }
        map_land_free(&land);
    }
    map_grid_free(&grid);
    return made;
}

bat_status bat_shape_map(const bat_shape_map_options *options, bat_curve_set *set, bat_error *error)
{
    const bat_shape_map_options defaults = bat_shape_map_defaults();
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_shape_map_fields, options, error);
    if (status != BAT_OK)
        return status;
    bat_random random = bat_random_seed(hash_bytes(HASH_BEGIN, "map", 3) + options->seed * UINT64_C(0x9e3779b97f4a7c15));
    map_rings map;
    if (!make_rings(options, &random, &map))
        return error_memory(error, options->countries * sizeof(map_area));
    text_buffer text = {0};
    map_title *titles = memory_array(map.area_count, sizeof *titles);
    if (titles != NULL)
    {
        invent_titles(&map, &random, titles);
        write_map(&map, titles, &text);
    }
    bool written = titles != NULL && !text.failed;
    free(titles);
    map_rings_free(&map);
    bat_curve_read_options how = bat_curve_read_defaults();
    how.format = BAT_CURVE_FORMAT_GEOJSON;
    status = written ? bat_curve_read_memory(text.data, text.size, &how, set, error) : error_memory(error, text.size);
    text_free(&text);
    return status;
}
