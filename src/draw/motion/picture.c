#include "base/error.h"
#include "base/number_digits.h"
#include "base/option.h"
#include "draw/common/sheet.h"
#include "draw/curve/plot.h"
#include "draw/curve/scene.h"
#include "draw/motion/film.h"

#include <inttypes.h>

/// @file
/// Pages of motions: the motions themselves above charts of their speeds.

enum
{
    /// Coordinates that are drawn over time.
    MAX_COORDINATES = 7,
    MAX_CHARTS = BAT_MOTION_PICTURE_MOTIONS + 2,
    MAX_SERIES = MAX_COORDINATES * BAT_MOTION_PICTURE_MOTIONS + 4 * BAT_MOTION_PICTURE_MOTIONS,
    MAX_ITEMS = MAX_SERIES + 8,
    LABEL_SIZE = 160,
    /// Keyframes that are marked in a chart.
    MARKED_KEYS = 100,
    /// Ellipses of a tensor's motion.
    TENSORS = 25
};

#define WIDTH 520.0
#define CHART_ASPECT 0.27
#define SHAPE_TALLEST 0.9

/// Lines over time, or the dots of keyframes.
typedef struct time_series
{
    plot_series drawn;
    bool dots;
    const char *label;
} time_series;

typedef struct time_chart
{
    plot_axes axes;
    double low, high; ///< the ends of the y axis; NaN: from the numbers
    const time_series *series;
    size_t series_count;
} time_chart;

typedef struct film_page
{
    film film;
    path_view view;
    scene scene; ///< of FILM_SHAPE
    bat_curve curves[BAT_MOTION_PICTURE_MOTIONS];
    double *shapes[BAT_MOTION_PICTURE_MOTIONS]; ///< points of tensors at equal times
    bat_curve_picture_layer layers[2 * BAT_MOTION_PICTURE_MOTIONS];
    bat_curve_picture_panel panel;
    bool has_scene;
    size_t first_chart; ///< the number of boxes above the charts: 0 or 1
    time_chart charts[MAX_CHARTS];
    size_t chart_count;
    time_series series[MAX_SERIES];
    size_t series_count;
    double *columns[MAX_COORDINATES * BAT_MOTION_PICTURE_MOTIONS];
    char labels[MAX_SERIES][LABEL_SIZE];
    char time_label[LABEL_SIZE], speed_label[LABEL_SIZE], turn_label[LABEL_SIZE];
    legend_item items[MAX_ITEMS];
    size_t item_count;
    bat_curve_picture_options page, shape; ///< options of the page and of FILM_SHAPE
} film_page;

bat_motion_picture_options bat_motion_picture_defaults(void)
{
    return (bat_motion_picture_options){.pixels_per_point = 2, .legend = true};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_motion_picture_options, width, OPTION_ZERO, 100, 10000),
    OPTION_FIELD(bat_motion_picture_options, height, OPTION_ZERO, 100, 10000),
    OPTION_FIELD(bat_motion_picture_options, pixels_per_point, OPTION_NUMBER, 0.1, 20),
    OPTION_FIELD(bat_motion_picture_options, poses, OPTION_SIZE, 0, 1000),
};

static bat_status motion_picture_options_check(const void *opaque, bat_error *error)
{
    const bat_motion_picture_options *options = opaque;
    if (text_is_valid(options->title) && text_is_valid(options->length_unit) && text_is_valid(options->time_unit))
        return BAT_OK;
    return error_option(error, "title", "and units must be UTF-8 without control characters");
}

const bat_options_table bat_motion_picture_fields =
    OPTIONS_TABLE(bat_motion_picture_options, FIELDS, motion_picture_options_check);

// Charts

static time_chart *add_chart(film_page *page, const char *label)
{
    time_chart *chart = &page->charts[page->chart_count++];
    *chart = (time_chart){.axes = {.y = {.low = INFINITY, .high = -INFINITY, .label = label}},
                          .low = NAN,
                          .high = NAN,
                          .series = page->series + page->series_count};
    return chart;
}

static void add_series(film_page *page, time_chart *chart, time_series series)
{
    page->series[page->series_count++] = series;
    chart->series_count++;
}

static int colour_of(const film_page *page, size_t track)
{
    return page->film.count == 1 ? BAT_CURVE_PICTURE_COLOURS : (int)track + 1;
}

/// A chart of speeds, or of angular speeds, from 0 on.
static void add_speeds(film_page *page, bool turns, const char *label)
{
    time_chart *chart = add_chart(page, label);
    double highest = 0;
    for (size_t k = 0; k < page->film.count; k++)
    {
        const film_track *track = &page->film.tracks[k];
        const double *values = turns ? track->turns : track->speeds, *at_keys = turns ? track->key_turns : track->key_speeds;
        for (size_t i = 0; i < track->count; i++)
            highest = fmax(highest, values[i]);
        add_series(page, chart, (time_series){{track->times, values, track->count, colour_of(page, k)}, false, NULL});
        if (track->key_count <= MARKED_KEYS)
            add_series(page, chart,
                       (time_series){{track->key_times, at_keys, track->key_count, colour_of(page, k)}, true, NULL});
    }
    chart->low = 0;
    chart->high = highest > 0 ? 1.06 * highest : 1;
}

static bat_status add_coordinates(film_page *page, size_t index, bat_error *error)
{
    const film_track *track = &page->film.tracks[index];
    size_t dim = page->film.space->point_dim, shown = dim < MAX_COORDINATES ? dim : MAX_COORDINATES;
    time_chart *chart = add_chart(page, "coordinates");
    for (size_t c = 0; c < shown; c++)
    {
        double *column = memory_array(track->count, sizeof *column);
        char *label = page->labels[page->series_count];
        if (column == NULL)
            return error_memory(error, track->count * sizeof *column);
        page->columns[index * MAX_COORDINATES + c] = column;
        for (size_t i = 0; i < track->count; i++)
        {
            column[i] = track->points[i * dim + c];
            plot_include(&chart->axes.y, column[i]);
        }
        (void)snprintf(label, LABEL_SIZE, c + 1 == shown && shown < dim ? "coordinate %zu (of %zu)" : "coordinate %zu",
                       c + 1, dim);
        add_series(page, chart, (time_series){{track->times, column, track->count, (int)c + 1}, false, label});
    }
    return BAT_OK;
}

/// "speed (m/s)", "speed (m per time)", "speed (1/s)" or "speed".
static void write_label(const char *name, const char *length, const char *time, char *label)
{
    bool timed = time[0] != '\0', measured = length[0] != '\0';
    (void)snprintf(label, LABEL_SIZE, measured || timed ? "%s (%.40s%s%.40s)" : "%s", name, measured ? length : "1",
                   timed ? "/" : " per time", time);
}

static void write_labels(film_page *page)
{
    const film *shown = &page->film;
    char digits[NUMBER_DIGITS_SIZE];
    bool timed = shown->time_unit[0] != '\0', angular = shown->kind == FILM_STRIP;
    int length = snprintf(page->time_label, LABEL_SIZE, timed ? "time (%.40s)" : "time", shown->time_unit);
    double whole = floor(shown->origin);
    if (shown->date != NULL)
        (void)snprintf(page->time_label + length, LABEL_SIZE - (size_t)length, " since %s", shown->date);
    else if (shown->since != 0)
        (void)snprintf(page->time_label + length, LABEL_SIZE - (size_t)length, " since %" PRId64 ".%06.0f",
                       shown->since + (int64_t)whole, floor((shown->origin - whole) * 1e6));
    else if (shown->origin != 0)
        (void)snprintf(page->time_label + length, LABEL_SIZE - (size_t)length, " since %s",
                       number_digits(shown->origin, digits));
    write_label("speed", shown->length_unit, shown->time_unit, page->speed_label);
    write_label("angular speed", "°", shown->time_unit, page->turn_label);
    if (angular)
        page->speed_label[0] = '\0';
}

static bat_status add_charts(film_page *page, bat_error *error)
{
    const film *shown = &page->film;
    bat_status status = BAT_OK;
    write_labels(page);
    for (size_t k = 0; k < shown->count && shown->kind == FILM_COORDINATES && status == BAT_OK; k++)
        status = add_coordinates(page, k, error);
    if (status != BAT_OK)
        return status;
    if (shown->tracks[0].speeds != NULL)
        add_speeds(page, false, page->speed_label);
    if (shown->tracks[0].turns != NULL)
        add_speeds(page, true, page->turn_label);
    page->charts[page->chart_count - 1].axes.x.label = page->time_label;
    for (size_t i = 0; i < page->chart_count; i++)
    {
        time_chart *chart = &page->charts[i];
        if (!plot_set_range(&chart->axes.x, shown->begin, shown->end) ||
            !plot_set_range(&chart->axes.y, chart->low, chart->high))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "chart %zu: the range of an axis is empty", i);
    }
    return BAT_OK;
}

// Curves and tensors

/// Points at equal times.
static bat_status sample_tensors(film_page *page, size_t index, bat_error *error)
{
    const film_track *track = &page->film.tracks[index];
    size_t dim = page->film.space->point_dim;
    double *points = page->shapes[index] = memory_array(TENSORS, dim * sizeof *points);
    if (points == NULL)
        return error_memory(error, TENSORS * dim * sizeof *points);
    double begin = track->times[0], end = track->times[track->count - 1];
    bat_status status = BAT_OK;
    for (size_t i = 0; i < TENSORS && status == BAT_OK; i++)
        status = film_at(&page->film, track, begin + (end - begin) * ((double)i / (TENSORS - 1)), points + i * dim, error);
    page->curves[index].points = points;
    page->curves[index].count = TENSORS;
    return status;
}

static bat_status make_shape(film_page *page, bat_error *error)
{
    const film *shown = &page->film;
    bat_status status = BAT_OK;
    bool tensors = view_space_of(shown->space) == VIEW_TENSOR;
    for (size_t k = 0; k < shown->count && status == BAT_OK; k++)
    {
        const film_track *track = &shown->tracks[k];
        page->curves[k] = (bat_curve){.space = shown->space, .points = track->points, .count = track->count};
        page->layers[2 * k] = (bat_curve_picture_layer){
            .curve = &shown->keyframes->curves[k], .role = BAT_CURVE_LAYER_ROLE_CONTROL, .label = "keyframes"};
        page->layers[2 * k + 1] = (bat_curve_picture_layer){.curve = &page->curves[k],
                                                            .label = tensors ? "motion at equal times" : "motion",
                                                            .colour = tensors ? (int)k + 1 : colour_of(page, k)};
        if (tensors)
            status = sample_tensors(page, k, error);
    }
    page->panel = (bat_curve_picture_panel){.layers = page->layers, .layer_count = 2 * shown->count};
    if (status == BAT_OK)
        status = scene_make(&page->panel, 1, &page->shape, &page->scene, error);
    page->has_scene = status == BAT_OK;
    return status;
}

// The legend

static void add_item(film_page *page, const char *label, line_style line, legend_mark mark)
{
    if (page->item_count < MAX_ITEMS)
        legend_add(page->items, &page->item_count, (legend_item){label, line, mark});
}

static void add_path_items(film_page *page)
{
    static const char *const axes[] = {"body x", "body y", "body z"};
    const film *shown = &page->film;
    for (size_t k = 0; k < shown->count; k++)
    {
        char *label = page->labels[k];
        (void)snprintf(label, LABEL_SIZE, shown->count > 1 ? "motion %zu" : "motion", k + 1);
        if (shown->kind != FILM_STRIP || shown->count > 1)
            add_item(page, label, (line_style){shown->tracks[k].colour, LINE_CURVE, 0, 0}, LEGEND_NO_MARK);
    }
    bool few = false;
    for (size_t k = 0; k < shown->count; k++)
        few = few || shown->tracks[k].key_count <= MARKED_KEYS;
    if (shown->kind == FILM_PATH)
        add_item(page, "keyframe", (line_style){COLOUR_CONTROL, 0, 0, 0}, LEGEND_RING);
    else if (few)
        add_item(page, "keyframe", (line_style){shown->tracks[0].colour, 0, 0, 0}, LEGEND_DOT);
    if (shown->kind == FILM_PATH && shown->any_outlier)
        add_item(page, "outlier", (line_style){style_palette(4), 0, 0, 0}, LEGEND_DOT);
    if (shown->kind == FILM_PATH && shown->space->point_dim > 2)
        add_item(page, "on the floor", (line_style){COLOUR_TRUTH, LINE_CONTROL, 0, 0}, LEGEND_NO_MARK);
    for (size_t a = 0; a < 3 && (shown->body || shown->kind == FILM_STRIP); a++)
        add_item(page, axes[a], (line_style){film_axis_colour(a), 1.6, 0, 0}, LEGEND_NO_MARK);
}

// The page

static double content_height(const void *context, size_t index, double width)
{
    const film_page *page = context;
    if (index >= page->first_chart)
        return CHART_ASPECT * width;
    if (page->film.kind == FILM_PATH)
        return path_aspect(&page->view) * width;
    if (page->film.kind == FILM_STRIP)
        return strip_height(&page->film, width);
    return fmin(panel_height(&page->scene.panels[0], &page->shape, SHAPE_TALLEST, width), SHAPE_TALLEST * width);
}

/// Draw a chart, whose y axis is in line with those of the others.
static void draw_chart(cairo_t *cairo, const film_page *page, const time_chart *chart, const double box[4])
{
    plot_axes axes = chart->axes;
    double widest = 0, own = plot_margin(cairo, axes, box);
    for (size_t i = 0; i < page->chart_count; i++)
        widest = fmax(widest, plot_margin(cairo, page->charts[i].axes, box));
    const double inner[4] = {box[0] + (widest - own), box[1], box[2] - (widest - own), box[3]};
    plot_begin(cairo, &axes, inner, page->page.grid);
    for (int dots = 0; dots < 2; dots++)
        for (size_t i = 0; i < chart->series_count; i++)
            if (chart->series[i].dots == (dots > 0))
                (dots > 0 ? plot_dots : plot_line)(cairo, &axes, &chart->series[i].drawn);
    plot_end(cairo, &axes, inner);
}

static bat_status content_draw(const void *context, cairo_t *cairo, size_t index, const double box[4], bat_error *error)
{
    const film_page *page = context;
    if (index >= page->first_chart)
    {
        draw_chart(cairo, page, &page->charts[index - page->first_chart], box);
        return BAT_OK;
    }
    if (page->film.kind == FILM_PATH)
        return path_draw(&page->film, &page->view, cairo, box, error);
    if (page->film.kind == FILM_STRIP)
        return strip_draw(&page->film, cairo, box, error);
    return panel_draw(cairo, &page->scene.panels[0], &page->shape, box, error);
}

static bat_status write_page(const char *path, film_page *page, const bat_motion_picture_options *options, bat_error *error)
{
    page->page = page->shape = bat_curve_picture_defaults();
    page->page.width = options->width;
    page->page.height = options->height;
    page->page.pixels_per_point = page->shape.pixels_per_point = options->pixels_per_point;
    page->page.title = options->title;
    page->shape.control_polygon = false;
    page->first_chart = page->film.kind != FILM_COORDINATES;
    bat_status status = add_charts(page, error);
    if (status == BAT_OK && page->film.kind == FILM_SHAPE)
        status = make_shape(page, error);
    if (status != BAT_OK)
        return status;
    if (page->film.kind == FILM_PATH)
        path_view_make(&page->film, &page->view);
    if (options->legend)
    {
        for (size_t i = 0; i < page->series_count && page->film.kind == FILM_COORDINATES; i++)
            if (page->series[i].label != NULL)
                add_item(page, page->series[i].label, style_curve(page->series[i].drawn.colour), LEGEND_NO_MARK);
        for (size_t i = 0; i < page->panel.layer_count && page->has_scene; i++)
            if (page->item_count < MAX_ITEMS)
                legend_add(page->items, &page->item_count, panel_legend_item(&page->scene.panels[0], i, &page->shape));
        if (page->film.kind == FILM_PATH || page->film.kind == FILM_STRIP)
            add_path_items(page);
    }
    sheet_content content = {.count = page->first_chart + page->chart_count,
                             .columns = 1,
                             .options = &page->page,
                             .items = page->items,
                             .item_count = page->item_count,
                             .natural_width = WIDTH,
                             .context = page,
                             .height = content_height,
                             .draw = content_draw};
    return sheet_write(path, &content, error);
}

/// Draw the splines of keyframes; null: make them.
static bat_status write_motions(const char *path, const bat_curve_set *keyframes, bat_motion_spline *const *splines,
                                const bat_motion_curves_options *motion, const bat_motion_picture_options *options,
                                bat_error *error)
{
    bat_motion_picture_options defaults = bat_motion_picture_defaults();
    canvas_format format;
    if (path == NULL || keyframes == NULL)
        return ERROR_ARGUMENT(error, "a picture needs a file name and keyframes");
    options = options != NULL ? options : &defaults;
    bat_status status = canvas_format_of(path, &format, error);
    if (status == BAT_OK)
        status = bat_options_check(&bat_motion_picture_fields, options, error);
    if (status != BAT_OK)
        return status;
    film_page *page = calloc(1, sizeof *page);
    if (page == NULL)
        return error_memory(error, sizeof *page);
    status = film_make(keyframes, splines, motion, options, &page->film, error);
    if (status == BAT_OK)
        status = write_page(path, page, options, error);
    if (page->has_scene)
        scene_free(&page->scene);
    for (size_t k = 0; k < BAT_MOTION_PICTURE_MOTIONS; k++)
        free(page->shapes[k]);
    for (size_t i = 0; i < sizeof page->columns / sizeof *page->columns; i++)
        free(page->columns[i]);
    film_free(&page->film);
    free(page);
    return status;
}

bat_status bat_motion_picture_write(const char *path, const bat_curve_set *keyframes,
                                    const bat_motion_curves_options *motion, const bat_motion_picture_options *options,
                                    bat_error *error)
{
    bat_motion_curves_options how = bat_motion_curves_defaults();
    return write_motions(path, keyframes, NULL, motion != NULL ? motion : &how, options, error);
}

bat_status bat_motion_splines_picture_write(const char *path, const bat_curve_set *keyframes,
                                            bat_motion_spline *const *splines, bat_motion_outliers outliers,
                                            const bat_motion_picture_options *options, bat_error *error)
{
    bat_motion_curves_options how = bat_motion_curves_defaults();
    how.spline.outliers = outliers;
    how.spline.sigma = 1; // rules are refused without
    if (splines == NULL)
        return ERROR_ARGUMENT(error, "a picture of splines needs splines");
    bat_status status = bat_options_check(&bat_motion_spline_fields, &how.spline, error);
    return status == BAT_OK ? write_motions(path, keyframes, splines, &how, options, error) : status;
}
