// What a map costs: shared borders and no crossings, as a share of refining every curve by itself, files included, in one
// run.

#include "timing.h"

#include "batten/batten.h"
#include "batten/research/map_shapes.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum
{
    ROUNDS = 3,
    COUNTRIES = 250,
    DETAIL = 7,
    LEVELS = 3
};

static const char GIVEN[] = "bench_map_given.geojson", REFINED[] = "bench_map_refined.geojson";

static int failed(const bat_error *error)
{
    (void)fprintf(stderr, "bench_map: %s\n", error->text);
    return 1;
}

/// Read, refine and write the map.
static bat_status run(const bat_curve_map_refine_options *options, double *seconds, size_t *points, bat_error *error)
{
    bat_curve_set given, fine;
    double begin = seconds_now();
    bat_status status = bat_curve_read(GIVEN, NULL, &given, error);
    if (status != BAT_OK)
        return status;
    status = bat_curve_map_refine(&given, options, &fine, error);
    if (status == BAT_OK)
    {
        status = bat_curve_write(REFINED, &fine, NULL, error);
        *seconds = seconds_now() - begin;
        *points = 0;
        for (size_t i = 0; i < fine.count; i++)
            *points += fine.curves[i].count;
        bat_curve_set_free(&fine);
    }
    bat_curve_set_free(&given);
    return status;
}

static int compare(const char *name, const char *scheme, bool mends)
{
    bat_error error;
    bat_curve_map_refine_report report = {0};
    bat_curve_map_refine_options together = bat_curve_map_refine_defaults();
    double spent[2][ROUNDS];
    size_t points;
    together.refine.levels = LEVELS;
    together.report = &report;
    if (!mends)
        together.refine.simple = BAT_CURVE_SIMPLE_NEVER;
    if (bat_curve_scheme_by_name(scheme, &together.refine.scheme, &error) != BAT_OK)
        return failed(&error);
    bat_curve_map_refine_options separate = together;
    separate.topology = BAT_CURVE_MAP_TOPOLOGY_SEPARATE;
    separate.report = NULL;
    for (size_t i = 0; i < ROUNDS; i++)
        if (run(&separate, &spent[0][i], &points, &error) != BAT_OK ||
            run(&together, &spent[1][i], &points, &error) != BAT_OK)
            return failed(&error);
    double alone = median_of(spent[0], ROUNDS), map = median_of(spent[1], ROUNDS);
    (void)printf("%-28s %9zu points: %.2f s, %.2f times as long as separate; %zu arcs, %zu edges drawn back\n", name, points,
                 map, map / alone, report.arcs, report.drawn_back);
    return 0;
}

int main(void)
{
    bat_error error;
    bat_curve_set map;
    bat_shape_map_options how = bat_shape_map_defaults();
    how.countries = COUNTRIES;
    how.detail = DETAIL;
    if (bat_shape_map(&how, &map, &error) != BAT_OK || bat_curve_write(GIVEN, &map, NULL, &error) != BAT_OK)
        return failed(&error);
    bat_curve_set_free(&map);
    int code = compare("learned", "learned", true);
    if (code == 0)
        code = compare("angle-4", "angle-4", true);
    if (code == 0)
        code = compare("angle-4, crossings allowed", "angle-4", false);
    (void)unlink(GIVEN);
    (void)unlink(REFINED);
    return code;
}
