#include "promise.h"

#include "batten/curve_file.h"

#include <stdint.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// Motions of every format. What is read can be written as TUM and as CSV, or is refused with a status.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const bat_curve_format formats[] = {BAT_CURVE_FORMAT_AUTO,  BAT_CURVE_FORMAT_CSV,   BAT_CURVE_FORMAT_TUM,
                                               BAT_CURVE_FORMAT_EUROC, BAT_CURVE_FORMAT_KITTI, BAT_CURVE_FORMAT_BVH};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
    {
        bat_curve_read_options reading = bat_curve_read_defaults();
        reading.format = formats[i];
        reading.motion = true;
        reading.threads = 1;
        bat_curve_set set = {0};
        bat_error error = {0};
        bat_status status = bat_curve_read_memory((const char *)data, size, &reading, &set, &error);
        PROMISE(status == error.status && (status == BAT_OK) == (set.count > 0));
        for (int csv = 0; csv < 2 && status == BAT_OK; csv++)
        {
            bat_curve_write_options writing = bat_curve_write_defaults();
            writing.threads = 1;
            writing.format = csv ? BAT_CURVE_FORMAT_CSV : BAT_CURVE_FORMAT_TUM;
            char *text = NULL;
            size_t length;
            bat_status written = bat_curve_write_memory(&set, &writing, &text, &length, &error);
            PROMISE(written == BAT_OK || (written == error.status && error.text[0] != '\0'));
            free(text);
        }
        bat_curve_set_free(&set);
    }
    return 0;
}
