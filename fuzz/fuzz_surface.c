#include "byte_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum
{
    MAX_POINTS = 48
};

/// Points near a height field, so that most clouds have a boundary; some are moved anywhere.
static bat_cloud take_cloud(byte_reader *reader)
{
    bat_cloud cloud = {.count = 1 + take_below(reader, MAX_POINTS)};
    size_t columns = 2 + take_below(reader, 6);
    cloud.points = calloc(3 * cloud.count, sizeof *cloud.points);
    PROMISE(cloud.points != NULL);
    for (size_t i = 0; i < cloud.count; i++)
    {
        double *point = cloud.points + 3 * i;
        unsigned kind = take_byte(reader);
        point[0] = (double)(i % columns) + (double)(kind & 3) / 16;
        point[1] = (double)(i / columns);
        point[2] = (double)take_byte(reader) / 64;
        for (size_t k = 0; k < 3 && kind > 246; k++)
            point[k] = take_coordinate(reader);
    }
    return cloud;
}

static bat_surface_reconstruct_options take_options(byte_reader *reader)
{
    bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
    unsigned flags = take_byte(reader);
    options.parameters = (bat_surface_parameters)take_choice(reader, BAT_SURFACE_PARAMETERS_COUNT);
    options.sides = (bat_cloud_sides)take_choice(reader, 4);
    options.published = (flags & 3) == 3;
    options.slide_boundary = (flags & 4) != 0;
    options.repair = (flags & 8) == 0;
    options.force = (flags & 16) != 0;
    options.trim = (flags & 32) != 0;
    options.fill_holes = (flags & 32) != 0 ? take_option(reader, 0, 4) : 0;
    options.fit.threads = 1;
    options.fit.functions = 4 + take_below(reader, 60);
    options.fit.iterations = (int)take_below(reader, 5);
    options.fit.robust = (flags & 64) != 0;
    if ((flags & 128) == 0)
        return options;
    options.fit.functions = take_below(reader, 40);
    options.fit.tolerance = take_option(reader, 0, 1);
    options.fit.share = take_flag(reader) ? 1 : take_option(reader, 0, 1);
    options.fit.space.degree[0] = (int)take_below(reader, 6);
    options.fit.space.degree[1] = (int)take_below(reader, 6);
    options.fit.space.spans[0] = take_below(reader, 5);
    options.fit.space.truncated = take_flag(reader);
    options.fit.space.admissible = (int)take_below(reader, 4);
    options.fit.hold_out = (int)take_below(reader, 12) - 1;
    options.fit.neighbours = (int)take_below(reader, 4);
    options.fit.smoothing = (bat_surface_smoothing)take_choice(reader, 5);
    options.fit.weight = take_option(reader, 0, 1);
    options.fit.noise = take_option(reader, 0, 1);
    options.fit.corrections = (int)take_below(reader, 3);
    options.fit.final_corrections = (int)take_below(reader, 3);
    options.fit.restarts = take_flag(reader);
    options.fit.tensor = take_flag(reader);
    return options;
}

/// A surface that is given has finite control points; all else is refused.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    byte_reader reader = {data, size};
    bat_surface_reconstruct_options options = take_options(&reader);
    bat_cloud cloud = take_cloud(&reader);
    double given[2 * MAX_POINTS];
    for (size_t i = 0; i < 2 * cloud.count && options.parameters == BAT_SURFACE_PARAMETERS_GIVEN; i++)
        given[i] = take_option(&reader, 0, 1);
    options.given = options.parameters == BAT_SURFACE_PARAMETERS_GIVEN ? given : NULL;
    bat_surface_result result = {0};
    bat_error error = {0};
    bat_status status = bat_surface_reconstruct(&cloud, &options, &result, &error);
    PROMISE(status == error.status && status != BAT_NO_MEMORY && status != BAT_CANCELLED);
    if (status == BAT_OK)
    {
        promise_finite(result.parameters, 2 * cloud.count);
        bat_surface_result_free(&result);
    }
    bat_cloud_free(&cloud);
    return 0;
}
