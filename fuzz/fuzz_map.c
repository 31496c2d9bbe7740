#include "byte_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// The curves of a map: borders are taken over from the curve before, so that they are shared.
static bat_curve_set take_set(byte_reader *reader, const bat_space *space)
{
    size_t count = 1 + take_below(reader, 5);
    bat_curve *curves = calloc(count, sizeof *curves);
    PROMISE(curves != NULL);
    for (size_t i = 0; i < count; i++)
    {
        curves[i] = take_curve(reader, space, 12);
        size_t shared = take_below(reader, 8);
        for (size_t k = 0; i > 0 && k < shared && k < curves[i].count && k < curves[i - 1].count; k++)
            memcpy(curves[i].points + k * space->point_dim,
                   curves[i - 1].points + (curves[i - 1].count - 1 - k) * space->point_dim,
                   space->point_dim * sizeof(double));
    }
    bat_curve_set set = {0};
    if (bat_curve_set_take(curves, count, &set, NULL) == BAT_OK)
        return set;
    for (size_t i = 0; i < count; i++)
        bat_curve_free(&curves[i]);
    free(curves);
    return set;
}

/// A refined map is in its space, and every curve of the given one is in it.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    byte_reader reader = {data, size};
    bat_space space;
    PROMISE(bat_space_by_name(take_flag(&reader) ? "sphere" : "plane", 0, &space, NULL) == BAT_OK);
    bat_curve_map_refine_report report;
    bat_curve_map_refine_options options = bat_curve_map_refine_defaults();
    options.refine = take_refine_options(&reader, NULL);
    options.report = &report;
    options.topology = BAT_CURVE_MAP_TOPOLOGY_ALWAYS;
    unsigned flags = take_byte(&reader);
    if ((flags & 1) != 0)
    {
        options.topology = (bat_curve_map_topology)take_choice(&reader, 4);
        options.edges = (bat_curve_map_edges)take_choice(&reader, 3);
        options.join = (bat_curve_map_join)take_choice(&reader, 2);
        options.decimals = (int)take_below(&reader, 14);
    }
    options.keep_area = (flags & 6) == 6;
    options.snap_tolerance = (flags & 8) != 0 ? take_option(&reader, 0, 1) : 0;
    options.simplify = (flags & 16) != 0 ? take_option(&reader, 0, 4) : 0;
    bat_curve_set coarse = take_set(&reader, &space), fine = {0};
    bat_error error = {0};
    bat_status status = coarse.count > 0 ? bat_curve_map_refine(&coarse, &options, &fine, &error) : BAT_INVALID_ARGUMENT;
    PROMISE(status != BAT_NO_MEMORY && status != BAT_CANCELLED);
    if (status == BAT_OK)
    {
        PROMISE(fine.count == coarse.count);
        for (size_t i = 0; i < fine.count; i++)
            promise_points(&space, fine.curves[i].points, fine.curves[i].count);
    }
    bat_curve_set_free(&fine);
    bat_curve_set_free(&coarse);
    return 0;
}
