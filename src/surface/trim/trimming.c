/// @file
/// Trimmed surfaces; see trimming.h.

#include "surface/trim/trimming.h"
#include "surface/spline/tensor_surface.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Room around the points, in spacings: the curves lie up to about one spacing outside.
static const double MARGIN = 2;

void trimming_free(surface_trimming *trimming)
{
    planar_chart_free(&trimming->chart);
    outline_free(&trimming->loops);
}

bat_status trimming_make(const cloud_geometry *geometry, double fill, surface_trimming *trimming, bat_error *error)
{
    *trimming = (surface_trimming){0};
    bat_status status = planar_chart_make(geometry, MARGIN, &trimming->chart, error);
    if (status == BAT_OK)
        status =
            outline_find(geometry, &trimming->chart, ldexp(fill, geometry->frame.exponent - 1), &trimming->loops, error);
    return status;
}

void trimming_parameters(const cloud_geometry *geometry, const surface_trimming *trimming, double *parameters)
{
    for (size_t i = 0; i < geometry->order.cloud.count; i++)
        for (size_t d = 0; d < 2; d++)
            parameters[2 * (size_t)geometry->order.places[i] + d] =
                fmin(fmax(trimming->chart.places[i][d] / trimming->chart.sides[d], 0), 1);
}

bat_status trimming_curves(const cloud_geometry *geometry, const surface_trimming *trimming, const double *parameters,
                           bat_spline_trim *trim, bat_error *error)
{
    size_t count = geometry->order.cloud.count;
    double *ordered = memory_array(count, 2 * sizeof *ordered);
    *trim = (bat_spline_trim){0};
    if (ordered == NULL)
        return error_memory(error, count * 2 * sizeof *ordered);
    for (size_t i = 0; i < count; i++)
        memcpy(ordered + 2 * i, parameters + 2 * (size_t)geometry->order.places[i], 2 * sizeof *ordered);
    bat_status status =
        fair_loops_make(&trimming->loops, trimming->chart.sides, ordered, geometry->spacing, geometry->noise, trim, error);
    free(ordered);
    return status;
}

size_t trimming_drop_filled(const surface_trimming *trimming, bat_spline_trim *trim)
{
    size_t kept = 0, pieces = 0, dropped = 0, begin = 0;
    for (size_t l = 0; l < trim->loop_count; l++)
    {
        size_t end = trim->loops[l + 1];
        for (size_t i = begin; i < end; i++)
            if (trimming->loops.filled[l])
                spline_curve_free(&trim->pieces[i]);
            else
            {
                bat_spline_curve piece = trim->pieces[i];
                trim->pieces[i] = (bat_spline_curve){0};
                trim->pieces[pieces++] = piece;
            }
        begin = end;
        if (trimming->loops.filled[l])
            dropped++;
        else
            trim->loops[++kept] = pieces;
    }
    trim->loop_count = kept;
    return dropped;
}
