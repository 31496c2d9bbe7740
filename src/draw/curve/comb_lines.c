#include "draw/curve/comb_lines.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Between the feet of two teeth, or where the feet crowd between the tips.
#define FOOT_SPACING 2.2
#define TIP_SPACING 6.6

/// The teeth from vertex `first` to before `end`, with the tips of all vertices.
typedef struct tooth_row
{
    const comb *teeth;
    const double *tips;
    size_t first, end;
} tooth_row;

/// A tooth on paper.
typedef struct paper_tooth
{
    double foot_x, foot_y;
    double tip_x, tip_y;
} paper_tooth;

static paper_tooth place_tooth(const draw_view *view, const tooth_row *row, size_t index)
{
    size_t n = row->teeth->point_dim;
    paper_tooth placed;
    view_place(view, row->teeth->points + index * n, &placed.foot_x, &placed.foot_y);
    view_place(view, row->tips + index * n, &placed.tip_x, &placed.tip_y);
    return placed;
}

/// Whether there is too little room for tooth `a` beside tooth `b`.
static bool crowded(const paper_tooth *a, const paper_tooth *b)
{
    return hypot(a->foot_x - b->foot_x, a->foot_y - b->foot_y) < FOOT_SPACING &&
           hypot(a->tip_x - b->tip_x, a->tip_y - b->tip_y) < TIP_SPACING;
}

/// Draw as many teeth as have room, the first always.
static bat_status draw_teeth(cairo_t *cairo, const draw_view *view, const tooth_row *row, line_style line, bat_error *error)
{
    size_t n = row->teeth->point_dim;
    double *tooth = memory_array(2 * n, sizeof(double));
    if (tooth == NULL)
    {
        return error_memory(error, 2 * n * sizeof(double));
    }
    bat_status status = BAT_OK;
    paper_tooth last = {0};
    for (size_t i = row->first; i < row->end && status == BAT_OK; i++)
    {
        paper_tooth placed = place_tooth(view, row, i);
        if (i == row->first || !crowded(&placed, &last))
        {
            memcpy(tooth, row->teeth->points + i * n, n * sizeof(double));
            memcpy(tooth + n, row->tips + i * n, n * sizeof(double));
            drawn_line drawn = {view, tooth, 2, false, VIEW_FRONT};
            status = stroke_line(cairo, &drawn, line, error);
            last = placed;
        }
    }
    free(tooth);
    return status;
}

bat_status comb_lines_draw(cairo_t *cairo, const draw_view *view, const comb *teeth, double scale, draw_colour colour,
                           bat_error *error)
{
    size_t n = teeth->point_dim;
    size_t margin = teeth->closed ? 0 : 1;
    if (teeth->count < 3)
    {
        return BAT_OK;
    }
    double *tips = memory_array(teeth->count * n, sizeof(double));
    if (tips == NULL)
    {
        return error_memory(error, teeth->count * n * sizeof(double));
    }
    for (size_t i = 0; i < teeth->count; i++)
    {
        comb_tip(teeth, i, scale, tips + i * n);
    }
    tooth_row row = {teeth, tips, margin, teeth->count - margin};
    line_style thin = {style_mix(colour, COLOUR_PAPER, 0.4), LINE_COMB, 0.0, 0.0};
    line_style envelope = {style_mix(colour, COLOUR_PAPER, 0.6), LINE_ENVELOPE, 0.0, 0.0};
    bat_status status = draw_teeth(cairo, view, &row, thin, error);
    if (status == BAT_OK)
    {
        drawn_line drawn = {view, tips + row.first * n, row.end - row.first, teeth->closed, VIEW_FRONT};
        status = stroke_line(cairo, &drawn, envelope, error);
    }
    free(tips);
    return status;
}
