#include "base/error.h"
#include "base/option.h"
#include "draw/common/sheet.h"
#include "draw/surface/scene.h"

#include <stdio.h>

/// @file
/// Pictures of surface fits: rows of panels with the cloud, the surface, the errors and the parameter plane.

#define MIN_WIDTH 60
#define MAX_WIDTH 4000

/// Whether the coordinates of points are finite.
static bat_status check_finite(const double *points, size_t count, const char *what, size_t row, bat_error *error)
{
    for (size_t i = 0; i < 3 * count; i++)
        if (!isfinite(points[i]))
            return error_set(error, BAT_INVALID_POINT, i / 3, 0, "row %zu: %s %zu is not finite", row, what, i / 3);
    return BAT_OK;
}

bat_surface_picture_options bat_surface_picture_defaults(void)
{
    return (bat_surface_picture_options){.width = 0};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_surface_picture_options, largest_error, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_surface_picture_options, view[0], OPTION_NUMBER, -INFINITY, INFINITY),
    OPTION_FIELD(bat_surface_picture_options, view[1], OPTION_NUMBER, -INFINITY, INFINITY),
    OPTION_FIELD(bat_surface_picture_options, view[2], OPTION_NUMBER, -INFINITY, INFINITY),
    OPTION_FIELD(bat_surface_picture_options, up[0], OPTION_NUMBER, -INFINITY, INFINITY),
    OPTION_FIELD(bat_surface_picture_options, up[1], OPTION_NUMBER, -INFINITY, INFINITY),
    OPTION_FIELD(bat_surface_picture_options, up[2], OPTION_NUMBER, -INFINITY, INFINITY),
};

static bat_status surface_picture_options_check(const void *opaque, bat_error *error)
{
    const bat_surface_picture_options *options = opaque;
    if (options->width == 0 || (options->width >= MIN_WIDTH && options->width <= MAX_WIDTH))
        return BAT_OK;
    return error_option(error, "width", "is %d, but must be 0 or from %d to %d", options->width, MIN_WIDTH, MAX_WIDTH);
}

const bat_options_table bat_surface_picture_fields =
    OPTIONS_TABLE(bat_surface_picture_options, FIELDS, surface_picture_options_check);

static bat_status check_parts(const bat_surface_picture_row *row, bool shell, size_t index, bat_error *error)
{
    const char *wrong = NULL;
    if (!text_is_valid(row->title))
        wrong = "has a title that is not UTF-8 without control characters";
    else if (row->cloud == NULL && row->surface == NULL && !shell)
        wrong = "has neither a cloud nor a surface";
    else if (row->cloud == NULL && (row->distances != NULL || row->parameters != NULL))
        wrong = "has distances or parameters but no cloud";
    else if (row->cloud != NULL && (row->cloud->count == 0 || row->cloud->boundary_count > row->cloud->count))
        wrong = "has a cloud without points, or with more on the boundary than there are";
    else if (row->surface != NULL && row->surface->dimension != 3)
        wrong = "has a surface that is not in space";
    return wrong == NULL ? BAT_OK : error_set(error, BAT_INVALID_ARGUMENT, index, 0, "row %zu %s", index, wrong);
}

static bat_status check_points(const bat_surface_picture_row *row, size_t index, bat_error *error)
{
    size_t count = row->cloud->count;
    for (size_t i = 0; row->distances != NULL && i < count; i++)
        if (!(row->distances[i] >= 0 && isfinite(row->distances[i])))
            return error_set(error, BAT_INVALID_POINT, i, 0, "row %zu: the distance of point %zu is not a finite length",
                             index, i);
    for (size_t i = 0; row->parameters != NULL && i < 2 * count; i++)
        if (!(row->parameters[i] >= 0 && row->parameters[i] <= 1))
            return error_set(error, BAT_INVALID_POINT, i / 2, 0,
                             "row %zu: the parameters of point %zu are not in the unit square", index, i / 2);
    return BAT_OK;
}

static bat_status inspection_check(const bat_surface_inspection *inspection, const bat_surface_picture_row *rows,
                                   size_t count, bat_error *error)
{
    bool good = inspection->view <= BAT_SURFACE_VIEW_CURVATURE && inspection->band_count <= BAT_SURFACE_MAX_BANDS;
    for (size_t k = 0; k < inspection->band_count && good; k++)
        good = inspection->bands[k] > (k > 0 ? inspection->bands[k - 1] : 0) && isfinite(inspection->bands[k]);
    for (size_t r = 0; r < count && inspection->band_count > 0; r++)
        good = good && (rows[r].distances == NULL || (rows[r].surface != NULL && rows[r].parameters != NULL));
    return good
               ? BAT_OK
               : error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                           "an inspection needs a view, at most %d bands above 0 that rise, and parameters to tell sides by",
                           BAT_SURFACE_MAX_BANDS);
}

static bat_status surface_picture_check(const bat_surface_picture_row *rows, size_t count, bool shell,
                                        const bat_surface_picture_options *options, bat_error *error)
{
    bat_status status = bat_options_check(&bat_surface_picture_fields, options, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        status = check_parts(&rows[i], shell, i, error);
        if (status == BAT_OK && rows[i].cloud != NULL)
            status = check_finite(rows[i].cloud->points, rows[i].cloud->count, "point", i, error);
        if (status == BAT_OK && rows[i].cloud != NULL)
            status = check_points(&rows[i], i, error);
        if (status == BAT_OK && rows[i].surface != NULL)
            status = check_finite(rows[i].surface->control, bat_hierarchical_space_functions(rows[i].surface->space),
                                  "control point", i, error);
    }
    return status;
}

#define USUAL_WIDTH 420
#define SHELL_WIDTH 640
/// Pixels in a point of the page; images in SVG and PDF have more.
#define PIXELS_PER_POINT 2.0
#define FINE_PIXELS_PER_POINT 4.0
/// The largest and smallest aspect ratio of a panel, height over width.
#define TALLEST 1.35
#define FLATTEST 0.45
#define TITLE_ROOM 20.0
/// The surface is drawn within the points' bounding box, enlarged by this fraction of its longest side.
#define BEYOND_SHARE 0.06
/// The fraction of distances within the colour scale.
#define SCALED_SHARE 0.99

typedef struct surface_scene
{
    surface_row *rows;
    size_t count;
    surface_panel_kind kinds[SURFACE_PANEL_KINDS]; ///< the panels that some row has
    size_t columns;
    surface_colours colours;
    double per_point;
    double title_room;
    bool has_errors;
    char labels[2 * BAT_SURFACE_MAX_BANDS + 1][64]; ///< of bands
    legend_item items[2 * BAT_SURFACE_MAX_BANDS + 2];
    size_t item_count;
} surface_scene;

static bool row_has(const surface_row *row, surface_panel_kind kind)
{
    const bat_surface_picture_row *panel = row->panel;
    if (kind == SURFACE_PANEL_ERRORS)
        return row->distances != NULL;
    if (row->shell != NULL)
        return kind == SURFACE_PANEL_PATCH;
    if (kind == SURFACE_PANEL_CLOUD)
        return panel->cloud != NULL;
    return panel->surface != NULL || (kind != SURFACE_PANEL_PATCH && panel->parameters != NULL);
}

static void describe_row(surface_row *row)
{
    const bat_surface_picture_row *panel = row->panel;
    if (panel->cloud != NULL)
    {
        char *caption = row->captions[SURFACE_PANEL_CLOUD];
        if (panel->cloud->boundary_count > 0)
            (void)snprintf(caption, SURFACE_CAPTION_SIZE, "%zu points, %zu on the boundary", panel->cloud->count,
                           panel->cloud->boundary_count);
        else
            (void)snprintf(caption, SURFACE_CAPTION_SIZE, "%zu points", panel->cloud->count);
    }
    if (panel->cloud != NULL && row->distances != NULL)
    {
        double squares = 0, largest = 0;
        for (size_t i = 0; i < panel->cloud->count; i++)
        {
            squares += row->distances[i] * row->distances[i];
            largest = fmax(largest, row->distances[i]);
        }
        (void)snprintf(row->captions[SURFACE_PANEL_ERRORS], SURFACE_CAPTION_SIZE, "mean squared error %.3g, largest %.3g",
                       squares / (double)panel->cloud->count, largest);
    }
    if (panel->surface != NULL)
    {
        bat_hierarchical_options options = bat_hierarchical_space_options(panel->surface->space);
        size_t levels = bat_hierarchical_space_levels(panel->surface->space);
        (void)snprintf(row->captions[SURFACE_PANEL_PATCH], SURFACE_CAPTION_SIZE, "bidegree (%d, %d), %zu degrees of freedom",
                       options.degree[0], options.degree[1], bat_hierarchical_space_functions(panel->surface->space));
        (void)snprintf(row->captions[SURFACE_PANEL_PLANE], SURFACE_CAPTION_SIZE,
                       levels == 1 ? "%zu cells of %zu level" : "%zu cells of %zu levels",
                       bat_hierarchical_space_cells(panel->surface->space), levels);
    }
    else if (row->shell != NULL)
        (void)snprintf(row->captions[SURFACE_PANEL_PATCH], SURFACE_CAPTION_SIZE, "%zu patches", row->shell->face_count);
    else if (panel->parameters != NULL)
        (void)snprintf(row->captions[SURFACE_PANEL_PLANE], SURFACE_CAPTION_SIZE, "parameters");
}

/// Choose the view and the frame of a row: from the cloud if its boundary is known, else from the surface.
static void choose_view(surface_row *row, size_t loop_count, const bat_surface_picture_options *options)
{
    const bat_cloud *cloud = row->panel->cloud;
    patch_points surface = {row->patch.positions, row->patch.vertex_count, loop_count};
    patch_points points = {0};
    if (cloud != NULL)
        points = (patch_points){cloud->points, cloud->count, cloud->boundary_count};
    bool by_cloud = cloud != NULL && (points.loop_count > 0 || surface.count == 0);
    row->view = surface_view_of(by_cloud ? &points : &surface, options->view, options->up);
    if (cloud != NULL && row->shell == NULL)
    {
        double low[3], high[3], extent = 0;
        box_of_points(3, cloud->points, cloud->count, low, high);
        for (int c = 0; c < 3; c++)
            extent = fmax(extent, high[c] - low[c]);
        for (int c = 0; c < 3; c++)
        {
            low[c] -= BEYOND_SHARE * extent;
            high[c] += BEYOND_SHARE * extent;
        }
        surface_patch_cut(&row->patch, low, high);
    }
    row->turned = surface_patch_turn(&row->patch, row->view.rotation[2]);
    mesh_frame of_surface = mesh_frame_of(row->patch.positions, row->patch.faces, 3 * row->patch.face_count, &row->view);
    mesh_frame of_cloud = mesh_frame_of(points.points, NULL, points.count, &row->view);
    row->frame = mesh_frame_join(&of_cloud, &of_surface);
}

static bat_status make_row(const bat_surface_picture_options *options, surface_colours *colours, surface_row *row,
                           bat_error *error)
{
    const bat_surface_inspection *inspection = &colours->inspection;
    const bat_surface_picture_row *panel = row->panel;
    size_t loop_count = 0;
    double *parameters = NULL;
    bat_status status = BAT_OK;
    if (panel->surface != NULL)
        status = surface_patch_make(panel->surface, &row->patch, &parameters, &loop_count, error);
    if (status != BAT_OK)
        return status;
    choose_view(row, loop_count, options);
    describe_row(row);
    if (row->patch.face_count > 0 && inspection->view != BAT_SURFACE_VIEW_SHADED)
        status =
            surface_row_inspect(row, inspection->view == BAT_SURFACE_VIEW_ZEBRA, parameters, &colours->most_curved, error);
    if (status == BAT_OK && row->distances != NULL && inspection->band_count > 0)
        status = surface_row_sign(row, error);
    free(parameters);
    return status;
}

/// Add the bands to the legend, with the share of the points of all rows.
static void add_bands(surface_scene *scene)
{
    const bat_surface_inspection *inspection = &scene->colours.inspection;
    size_t points = 0, bands = 2 * inspection->band_count + 1, counts[2 * BAT_SURFACE_MAX_BANDS + 1] = {0};
    for (size_t r = 0; r < scene->count; r++)
        for (size_t i = 0; scene->rows[r].signed_distances != NULL && i < scene->rows[r].panel->cloud->count; i++, points++)
            counts[surface_band_of(inspection, scene->rows[r].signed_distances[i])]++;
    for (size_t k = 0; k < bands && points > 0; k++)
    {
        surface_band_label(inspection, k, (double)counts[k] / (double)points, scene->labels[k], sizeof scene->labels[k]);
        legend_add(scene->items, &scene->item_count,
                   (legend_item){.label = scene->labels[k],
                                 .mark = LEGEND_DOT,
                                 .line = {.colour = surface_band_colour(inspection, k)}});
    }
}

/// The quantile of the distances of all points.
static bat_status find_highest(const surface_row *rows, size_t count, double *highest, bat_error *error)
{
    size_t total = 0, copied = 0;
    for (size_t r = 0; r < count; r++)
        total += rows[r].distances != NULL ? rows[r].panel->cloud->count : 0;
    double *all = memory_array(total, sizeof *all);
    if (all == NULL)
        return error_memory(error, total * sizeof *all);
    for (size_t r = 0; r < count; r++)
        for (size_t i = 0; rows[r].distances != NULL && i < rows[r].panel->cloud->count; i++)
            all[copied++] = rows[r].distances[i];
    qsort(all, total, sizeof *all, ascending);
    double found = total > 0 ? all[(size_t)(SCALED_SHARE * (double)(total - 1))] : 0;
    if (total > 0 && !(found > 0))
        found = all[total - 1];
    *highest = found > 0 ? found : 1;
    free(all);
    return BAT_OK;
}

static void find_panels(surface_scene *scene)
{
    const surface_row *rows = scene->rows;
    bool has_boundary = false;
    for (surface_panel_kind kind = SURFACE_PANEL_CLOUD; kind < SURFACE_PANEL_KINDS; kind++)
    {
        bool any = false;
        for (size_t r = 0; r < scene->count; r++)
            any = any || row_has(&rows[r], kind);
        if (any)
            scene->kinds[scene->columns++] = kind;
    }
    for (size_t r = 0; r < scene->count; r++)
    {
        has_boundary = has_boundary || (rows[r].panel->cloud != NULL && rows[r].panel->cloud->boundary_count > 0);
        scene->has_errors = scene->has_errors || (rows[r].distances != NULL && scene->colours.inspection.band_count == 0);
        scene->title_room = text_given(rows[r].panel->title) ? TITLE_ROOM : scene->title_room;
    }
    if (has_boundary)
        legend_add(scene->items, &scene->item_count,
                   (legend_item){.label = "boundary points", .mark = LEGEND_DOT, .line = {.colour = COLOUR_BOUNDARY_POINT}});
}

static bat_status scene_begin(const bat_surface_picture_row *rows, size_t count, const bat_shell *shell,
                              const bat_surface_inspection *inspection, const bat_surface_picture_options *options,
                              surface_scene *scene, bat_error *error)
{
    *scene = (surface_scene){.rows = calloc(count, sizeof *scene->rows),
                             .count = count,
                             .colours = {.inspection = *inspection, .highest = options->largest_error}};
    if (scene->rows == NULL)
        return error_memory(error, count * sizeof *scene->rows);
    bat_status status = BAT_OK;
    for (size_t r = 0; r < count && status == BAT_OK; r++)
    {
        scene->rows[r] = (surface_row){.panel = &rows[r], .shell = shell, .distances = rows[r].distances};
        status = shell != NULL ? surface_shell_make(&scene->rows[r], error) : BAT_OK;
    }
    if (status == BAT_OK)
        find_panels(scene);
    if (status == BAT_OK && scene->colours.highest == 0)
        status = find_highest(scene->rows, count, &scene->colours.highest, error);
    for (size_t r = 0; r < count && status == BAT_OK; r++)
        status = make_row(options, &scene->colours, &scene->rows[r], error);
    if (status == BAT_OK && inspection->band_count > 0)
        add_bands(scene);
    return status;
}

static surface_panel_kind kind_at(const surface_scene *scene, size_t index)
{
    return scene->kinds[index % scene->columns];
}

static const surface_row *row_at(const surface_scene *scene, size_t index)
{
    return &scene->rows[index / scene->columns];
}

static double panel_height(const void *context, size_t index, double width)
{
    const surface_scene *scene = context;
    const mesh_frame *frame = &row_at(scene, index)->frame;
    if (kind_at(scene, index) == SURFACE_PANEL_PLANE)
        return scene->title_room + width;
    double aspect = (frame->high[1] - frame->low[1]) / fmax(frame->high[0] - frame->low[0], 1e-300);
    return scene->title_room + width * fmin(fmax(aspect + 2 * FRAME_PADDING, FLATTEST), TALLEST);
}

static const char *panel_caption(const void *context, size_t index)
{
    const surface_scene *scene = context;
    return row_at(scene, index)->captions[kind_at(scene, index)];
}

static bat_status draw_panel(const void *context, cairo_t *cairo, size_t index, const double box[4], bat_error *error)
{
    const surface_scene *scene = context;
    const surface_row *row = row_at(scene, index);
    const double below[4] = {box[0], box[1] + scene->title_room, box[2], box[3] - scene->title_room};
    if (index % scene->columns == 0 && text_given(row->panel->title))
    {
        char cut[256];
        text_use(cairo, TEXT_TITLE, true);
        style_use_colour(cairo, COLOUR_FOREGROUND);
        text_cut(cairo, row->panel->title, box[2] * (double)scene->columns, cut, sizeof cut);
        text_draw(cairo, cut, box[0], box[1] + 0.5 * TITLE_ROOM, 0);
    }
    if (!row_has(row, kind_at(scene, index)))
        return BAT_OK;
    if (kind_at(scene, index) == SURFACE_PANEL_PLANE)
        return surface_plane_draw(row, cairo, below, scene->per_point, error);
    return surface_view_draw(row, kind_at(scene, index), &scene->colours, cairo, below, scene->per_point, error);
}

static void draw_scales(const void *context, cairo_t *cairo, const double box[4])
{
    const surface_scene *scene = context;
    const surface_colours *colours = &scene->colours;
    const double below[4] = {box[0], box[1] + (scene->has_errors ? colour_bar_height() : 0), box[2], box[3]};
    if (scene->has_errors)
        colour_bar_draw(cairo, colour_scale_at, 0, colours->highest, "distance of points from the surface", box);
    if (colours->most_curved > 0)
        colour_bar_draw(cairo, colour_scale_diverging, -colours->most_curved, colours->most_curved,
                        "mean curvature, + bulges towards the viewer", below);
}

static bat_status write_scene(const char *path, const surface_scene *scene, int width, bat_error *error)
{
    bat_curve_picture_options page = bat_curve_picture_defaults();
    page.pixels_per_point = PIXELS_PER_POINT;
    double usual = scene->rows->shell != NULL ? SHELL_WIDTH : USUAL_WIDTH,
           panel = (width > 0 ? width : usual) / PIXELS_PER_POINT;
    sheet_content content = {.count = scene->count * scene->columns,
                             .columns = scene->columns,
                             .options = &page,
                             .items = scene->items,
                             .item_count = scene->item_count,
                             .natural_width = sheet_width(panel, scene->columns),
                             .context = scene,
                             .height = panel_height,
                             .caption = panel_caption,
                             .draw = draw_panel,
                             .footer_height = colour_bar_height() * (scene->has_errors + (scene->colours.most_curved > 0)),
                             .draw_footer = draw_scales};
    return sheet_write(path, &content, error);
}

static bat_status write_rows(const char *path, const bat_surface_picture_row *rows, size_t count, const bat_shell *shell,
                             const bat_surface_inspection *inspection, const bat_surface_picture_options *options,
                             bat_error *error)
{
    static const bat_surface_inspection NONE;
    const bat_surface_picture_options defaults = bat_surface_picture_defaults();
    canvas_format format;
    if (path == NULL || rows == NULL || count == 0)
        return ERROR_ARGUMENT(error, "a picture needs a file name and at least one row");
    options = options != NULL ? options : &defaults;
    inspection = inspection != NULL ? inspection : &NONE;
    bat_status status = canvas_format_of(path, &format, error);
    if (status == BAT_OK)
        status = surface_picture_check(rows, count, shell != NULL, options, error);
    if (status == BAT_OK)
        status = inspection_check(inspection, rows, count, error);
    if (status != BAT_OK)
        return status;
    surface_scene scene;
    status = scene_begin(rows, count, shell, inspection, options, &scene, error);
    scene.per_point = format == CANVAS_PNG ? PIXELS_PER_POINT : FINE_PIXELS_PER_POINT;
    if (status == BAT_OK)
        status = write_scene(path, &scene, options->width, error);
    for (size_t r = 0; scene.rows != NULL && r < scene.count; r++)
    {
        memory_pool_free(&scene.rows[r].pool);
        bat_mesh_free(&scene.rows[r].patch);
        free(scene.rows[r].values);
        free(scene.rows[r].signed_distances);
    }
    free(scene.rows);
    return status;
}

bat_status bat_surface_picture_write(const char *path, const bat_surface_picture_row *rows, size_t count,
                                     const bat_surface_picture_options *options, bat_error *error)
{
    return write_rows(path, rows, count, NULL, NULL, options, error);
}

bat_status bat_surface_picture_inspect(const char *path, const bat_surface_picture_row *rows, size_t count,
                                       const bat_surface_inspection *inspection, const bat_surface_picture_options *options,
                                       bat_error *error)
{
    return write_rows(path, rows, count, NULL, inspection, options, error);
}

bat_status bat_shell_picture_write(const char *path, const char *title, const bat_shell *shell, const double *points,
                                   size_t count, const bat_surface_inspection *inspection,
                                   const bat_surface_picture_options *options, bat_error *error)
{
    const bat_cloud cloud = {.points = (double *)points, .count = count};
    if (shell == NULL || shell->face_count == 0 || (points == NULL && count > 0))
        return ERROR_ARGUMENT(error, "a picture needs a shell with patches, and the points that are counted");
    const bat_surface_picture_row row = {.title = title, .cloud = count > 0 ? &cloud : NULL};
    bat_status status = check_finite(shell->patches, 16 * shell->cage.face_count, "B\xc3\xa9zier point", 0, error);
    return status != BAT_OK ? status : write_rows(path, &row, 1, shell, inspection, options, error);
}
