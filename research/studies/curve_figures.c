/// @file
/// Figures of Alam (2025) made anew with our own polygons: curves at five levels, and their distances (bat_curve_figure).

#include "batten/research/curve_shapes.h"
#include "batten/research/curve_study.h"

#include "batten/curve_picture.h"
#include "batten/research/curve_analysis.h"
#include "batten/space.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum
{
    PANELS = BAT_CURVE_FIGURE_PANELS,
    MIDDLE = 3, ///< the panels of level 10 …
    LAST = 4,   ///< … and of level 20
    MAX_OUTLINES = BAT_SHAPE_MAX_OUTLINES,
    NAME_SIZE = 64
};

/// The levels that the study shows.
static const size_t LEVELS[PANELS] = {0, 1, 2, 10, 20};

static double now(void)
{
    struct timespec time;
    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static bat_status refine_outlines(bat_curve_figure *f, const bat_space *plane, size_t panel, const bat_curve_scheme *scheme,
                                  bat_error *error)
{
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = *scheme;
    how.levels = LEVELS[panel];
    how.simple = BAT_CURVE_SIMPLE_NEVER;
    how.progress = f->progress;
    bat_status status = BAT_OK;
    for (size_t o = 0; o < f->shape->outline_count && status == BAT_OK; o++)
    {
        bat_curve coarse;
        status = bat_curve_shape_curve(f->shape, o, plane, &coarse, error);
        if (status != BAT_OK)
            break;
        status = bat_curve_refine(&coarse, &how, &f->curves[panel][o], error);
        bat_curve_free(&coarse);
    }
    return status;
}

/// Update the largest distances of the figure by those of outline `o`.
static bat_status measure_outline(bat_curve_figure *f, size_t o, const bat_mask_stencil *stencil, bat_error *error)
{
    const bat_curve *middle = &f->curves[MIDDLE][o], *last = &f->curves[LAST][o];
    bat_curve_measure_options how = bat_curve_measure_defaults();
    how.progress = f->progress;
    double chord, middle_off_limit, last_off_limit;
    bat_status status = bat_curve_chord_distance(middle, last, &how, &chord, error);
    if (status == BAT_OK)
        status = bat_curve_limit_distance(middle, stencil, &how, &middle_off_limit, error);
    if (status == BAT_OK)
        status = bat_curve_limit_distance(last, stencil, &how, &last_off_limit, error);
    if (status != BAT_OK)
        return status;
    f->chord = fmax(f->chord, chord);
    f->middle_off_limit = fmax(f->middle_off_limit, middle_off_limit);
    f->last_off_limit = fmax(f->last_off_limit, last_off_limit);
    return BAT_OK;
}

static bat_status figure_measure(bat_curve_figure *f, const bat_mask_stencil *stencil, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t o = 0; o < f->shape->outline_count && status == BAT_OK; o++)
    {
        f->vertices += f->curves[0][o].count;
        f->points += f->curves[LAST][o].count;
        status = measure_outline(f, o, stencil, error);
    }
    return status;
}

bat_status bat_curve_figure_make(const bat_curve_shape *shape, const bat_shape_figure *study, const bat_space *plane,
                                 bat_progress progress, bat_curve_figure *f, bat_error *error)
{
    *f = (bat_curve_figure){.shape = shape, .study = study, .progress = progress};
    (void)snprintf(f->name, sizeof f->name, "curve-figures-%.*s-%s", (int)strcspn(study->scheme, ":"), study->scheme,
                   shape->name);
    bat_curve_scheme scheme;
    bat_mask_stencil stencil;
    bat_status status = bat_curve_scheme_by_name(study->scheme, &scheme, error);
    if (status == BAT_OK)
        status = bat_mask_limit_stencil(&scheme.mask, &stencil, error);
    for (size_t panel = 0; panel < PANELS && status == BAT_OK; panel++)
    {
        double begin = now();
        status = refine_outlines(f, plane, panel, &scheme, error);
        f->seconds = now() - begin;
    }
    if (status == BAT_OK)
        status = figure_measure(f, &stencil, error);
    if (status != BAT_OK)
        bat_curve_figure_free(f);
    return status;
}

void bat_curve_figure_free(bat_curve_figure *f)
{
    for (size_t panel = 0; panel < PANELS; panel++)
        for (size_t o = 0; o < MAX_OUTLINES; o++)
            bat_curve_free(&f->curves[panel][o]);
}

bat_status bat_curve_figure_draw(const char *path, const bat_curve_figure *f, bat_error *error)
{
    bat_curve_picture_layer layers[PANELS][MAX_OUTLINES];
    bat_curve_picture_panel panels[PANELS];
    char titles[PANELS][NAME_SIZE], heading[2 * NAME_SIZE];
    for (size_t panel = 0; panel < PANELS; panel++)
    {
        for (size_t o = 0; o < f->shape->outline_count; o++)
            layers[panel][o] = (bat_curve_picture_layer){.curve = &f->curves[panel][o], .colour = 1};
        (void)snprintf(titles[panel], sizeof titles[panel], "level %zu", LEVELS[panel]);
        panels[panel] = (bat_curve_picture_panel){layers[panel], f->shape->outline_count, titles[panel]};
    }
    (void)snprintf(heading, sizeof heading, "%s, %s", f->shape->name, f->study->scheme);
    bat_curve_picture_options how = bat_curve_picture_defaults();
    how.title = heading;
    return bat_curve_picture_write(path, panels, PANELS, &how, error);
}
