#include "byte_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// Whether all values are finite.
static bool all_finite(const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

/// A refined curve is in its space and has as many points as announced; a failure is one of those of the documentation.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    byte_reader reader = {data, size};
    bat_space space = take_space(&reader);
    bat_curve_refine_report report;
    bat_curve_refine_options options = take_refine_options(&reader, &report);
    bat_curve coarse = take_curve(&reader, &space, 24), fine = {0};
    bat_error error = {0};
    bat_status status = bat_curve_refine(&coarse, &options, &fine, &error);
    PROMISE(status == error.status);
    PROMISE(status != BAT_NO_MEMORY && status != BAT_CANCELLED && status != BAT_BAD_FILE && status != BAT_FILE_ACCESS);
    PROMISE(status == BAT_OK || fine.points == NULL);
    size_t count;
    if (status == BAT_OK)
    {
        promise_points(&space, fine.points, fine.count);
        PROMISE(fine.closed == coarse.closed && fine.channel_count == coarse.channel_count);
        if (fine.channels != NULL && all_finite(coarse.channels, coarse.count * coarse.channel_count))
            PROMISE(fine.channels != NULL);
        PROMISE(fine.count <= options.max_points);
        // A smoothed curve may need other levels.
        if (options.smooth == 0)
            PROMISE(bat_curve_refined_count(&coarse, &options, &count, NULL) == BAT_OK && count == fine.count);
    }
    bat_curve_free(&fine);
    bat_curve_free(&coarse);
    return 0;
}
