#include "fuzz_round_trip.h"

#include <stdint.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// The same JSON with the name "type" spelled so that the reader extracts no coordinates before it parses.
static char *spell_types(const uint8_t *data, size_t size, size_t *spelled_size)
{
    static const char name[] = "\"type\"", spelled[] = "\"typ\\u0065\"";
    const size_t name_size = sizeof name - 1, step = sizeof spelled - 1;
    char *text = malloc(2 * size + 1), *out = text;
    for (size_t i = 0; text != NULL && i < size;)
    {
        bool found = size - i >= name_size && memcmp(data + i, name, name_size) == 0;
        memcpy(out, found ? (const void *)spelled : data + i, found ? step : 1);
        out += found ? step : 1;
        i += found ? name_size : 1;
    }
    *spelled_size = text != NULL ? (size_t)(out - text) : 0;
    return text;
}

static void compare_values(const double *a, const double *b, size_t count)
{
    for (size_t i = 0; i < count; i++)
        PROMISE(a[i] == b[i]);
}

/// Reading with and without extracted coordinates gives the same curves.
static void compare_spellings(const uint8_t *data, size_t size, const char *space)
{
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = BAT_CURVE_FORMAT_GEOJSON;
    options.space = space;
    options.threads = 1;
    bat_curve_set parsed = {0}, lifted = {0};
    size_t spelled_size;
    char *spelled = spell_types(data, size, &spelled_size);
    if (spelled != NULL && bat_curve_read_memory(spelled, spelled_size, &options, &parsed, NULL) == BAT_OK)
    {
        PROMISE(bat_curve_read_memory((const char *)data, size, &options, &lifted, NULL) == BAT_OK);
        compare_counts(&parsed, &lifted, false);
        for (size_t i = 0; i < parsed.count; i++)
        {
            const bat_curve *a = &parsed.curves[i], *b = &lifted.curves[i];
            compare_values(a->points, b->points, a->count * parsed.space->point_dim);
            compare_values(a->channels, b->channels, a->count * a->channel_count);
        }
    }
    free(spelled);
    bat_curve_set_free(&parsed);
    bat_curve_set_free(&lifted);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    round_trip(data, size, BAT_CURVE_FORMAT_GEOJSON, NULL, false);
    round_trip(data, size, BAT_CURVE_FORMAT_GEOJSON_LINES, NULL, false);
    round_trip(data, size, BAT_CURVE_FORMAT_GEOJSON, "plane", false);
    round_trip(data, size, BAT_CURVE_FORMAT_GEOJSON, "sphere", true);
    round_trip(data, size, BAT_CURVE_FORMAT_GEOJSON, "disk", true);
    compare_spellings(data, size, NULL);
    compare_spellings(data, size, "plane");
    return 0;
}
