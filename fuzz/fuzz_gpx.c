#include "fuzz_round_trip.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// What is read can be written in other formats, too.
static void write_others(const uint8_t *data, size_t size)
{
    static const bat_curve_format formats[] = {BAT_CURVE_FORMAT_GEOJSON, BAT_CURVE_FORMAT_CSV};
    bat_curve_read_options reading = bat_curve_read_defaults();
    reading.format = BAT_CURVE_FORMAT_GPX;
    bat_curve_set set = {0};
    if (bat_curve_read_memory((const char *)data, size, &reading, &set, NULL) != BAT_OK)
        return;
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
    {
        bat_curve_write_options writing = bat_curve_write_defaults();
        writing.threads = 1;
        writing.format = formats[i];
        char *text = NULL;
        size_t text_size = 0;
        bat_status status = bat_curve_write_memory(&set, &writing, &text, &text_size, NULL);
        PROMISE(status == BAT_OK || status == BAT_UNSUPPORTED);
        free(status == BAT_OK ? text : NULL);
    }
    bat_curve_set_free(&set);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    round_trip(data, size, BAT_CURVE_FORMAT_GPX, NULL, false);
    round_trip(data, size, BAT_CURVE_FORMAT_GPX, "plane", false);
    write_others(data, size);
    return 0;
}
