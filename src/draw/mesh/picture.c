#include "base/choice.h"
#include "base/error.h"
#include "base/option.h"
#include "draw/common/sheet.h"
#include "draw/mesh/shade.h"

#include <float.h>

/// @file
/// Pictures of meshes: a page of shaded panels with a colour scale.

#define USUAL_COLUMNS ((size_t)4)
/// The largest and smallest aspect ratio of a panel, height over width.
#define TALLEST 1.25
#define FLATTEST 0.45
/// The width of wires in points.
#define WIRE_WIDTH 0.42
#define MAX_SAMPLES ((double)(1 << 28))
#define LARGEST_SIDE 10000.0
/// Of the viewer, in radians; pi/2 and rounding.
#define LARGEST_LONGITUDE 1e6
#define LARGEST_LATITUDE 1.5707963267948968

bat_mesh_picture_options bat_mesh_picture_defaults(void)
{
    return (bat_mesh_picture_options){.pixels_per_point = 2.0,
                                      .longitude = NAN,
                                      .latitude = NAN,
                                      .ambient_occlusion = true,
                                      .boundaries = true,
                                      .value_low = NAN,
                                      .value_high = NAN};
}

/// A picture to be drawn.
typedef struct mesh_scene
{
    memory_pool pool; ///< of all arrays
    const bat_mesh_picture_panel *panels;
    size_t count, columns;
    const bat_mesh_picture_options *options;
    mesh_view *views;   ///< for each panel
    mesh_frame *frames; ///< for each panel
    bat_mesh *cut;      ///< for each panel: its polygons as triangles; empty where it has triangles
    bool has_values;
    double value_low, value_high;
} mesh_scene;

/// The mesh of a panel, as triangles.
static const bat_mesh *triangles_of(const mesh_scene *made, size_t index)
{
    return made->cut[index].face_count > 0 ? &made->cut[index] : made->panels[index].mesh;
}

static const bat_choice UP_AXES[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "the second axis", BAT_MESH_UP_AUTO),
    CHOICE("y", "the second axis", BAT_MESH_UP_Y),
    CHOICE("z", "the third axis", BAT_MESH_UP_Z),
    CHOICE("x", "the first axis", BAT_MESH_UP_X),
};
const bat_family bat_mesh_up_family = FAMILY("axis", UP_AXES);

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_mesh_picture_options, width, OPTION_NUMBER, 0, LARGEST_SIDE),
    OPTION_FIELD(bat_mesh_picture_options, height, OPTION_NUMBER, 0, LARGEST_SIDE),
    OPTION_FIELD(bat_mesh_picture_options, pixels_per_point, OPTION_NUMBER, 0.1, 20),
    OPTION_FAMILY(bat_mesh_picture_options, up, bat_mesh_up_family),
    OPTION_FIELD(bat_mesh_picture_options, longitude, OPTION_ANGLE, -LARGEST_LONGITUDE, LARGEST_LONGITUDE),
    OPTION_FIELD(bat_mesh_picture_options, latitude, OPTION_ANGLE, -LARGEST_LATITUDE, LARGEST_LATITUDE),
    OPTION_FIELD(bat_mesh_picture_options, value_low, OPTION_ANGLE, -DBL_MAX, DBL_MAX),
    OPTION_FIELD(bat_mesh_picture_options, value_high, OPTION_ANGLE, -DBL_MAX, DBL_MAX),
    OPTION_THREADS(bat_mesh_picture_options),
};

static bat_status mesh_picture_options_check(const void *opaque, bat_error *error)
{
    const bat_mesh_picture_options *options = opaque;
    if (options->value_low >= options->value_high)
        return error_option(error, "value_low", "is %.10g, but must be below value_high", options->value_low);
    const char *wrong = !text_is_valid(options->title)         ? "title"
                        : !text_is_valid(options->value_label) ? "value_label"
                                                               : NULL;
    return wrong == NULL ? BAT_OK : error_option(error, wrong, "must be UTF-8 without control characters");
}

const bat_options_table bat_mesh_picture_fields =
    OPTIONS_TABLE(bat_mesh_picture_options, FIELDS, mesh_picture_options_check);

static bat_status check_panel(const bat_mesh_picture_panel *panel, size_t index, bat_error *error)
{
    if (panel->mesh == NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "panel %zu has no mesh", index);
    if (!text_is_valid(panel->title))
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0,
                         "the title of panel %zu is not UTF-8 without control characters", index);
    bat_status status = bat_mesh_check(panel->mesh, error);
    if (status != BAT_OK)
        return error_prefix(error, status, "panel %zu: ", index);
    for (size_t v = 0; panel->values != NULL && v < panel->mesh->vertex_count; v++)
        if (isinf(panel->values[v]))
            return error_set(error, BAT_INVALID_POINT, v, 0, "panel %zu: the value at vertex %zu is infinite", index, v);
    return BAT_OK;
}

/// Find the range of the colour scale.
static void find_values(mesh_scene *made)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t i = 0; i < made->count; i++)
    {
        const bat_mesh_picture_panel *panel = &made->panels[i];
        made->has_values = made->has_values || panel->values != NULL;
        for (size_t v = 0; panel->values != NULL && v < panel->mesh->vertex_count; v++)
            box_include(1, &panel->values[v], &low, &high);
    }
    const bat_mesh_picture_options *options = made->options;
    made->value_high = !isnan(options->value_high) ? options->value_high : low <= high ? high : 1;
    made->value_low = !isnan(options->value_low) ? options->value_low : fmin(fmin(low, 0), made->value_high);
    if (!(made->value_low < made->value_high))
        made->value_high = made->value_low + fmax(fabs(made->value_low), 1) * 1e-3;
}

/// Choose the view and the frame of every panel; the panels of a row share them unless each has its own.
static void find_frames(mesh_scene *made)
{
    for (size_t i = 0; i < made->count; i++)
    {
        size_t first = made->options->own_frames ? i : i - i % made->columns;
        const bat_mesh *triangles = triangles_of(made, i);
        made->views[i] = first == i ? mesh_view_of(triangles, made->options) : made->views[first];
        made->frames[i] = mesh_frame_of(triangles->positions, triangles->faces, 3 * triangles->face_count, &made->views[i]);
        if (first != i)
            made->frames[first] = mesh_frame_join(&made->frames[first], &made->frames[i]);
    }
    for (size_t i = 0; i < made->count && !made->options->own_frames; i++)
        made->frames[i] = made->frames[i - i % made->columns];
}

static void scene_free(mesh_scene *made)
{
    for (size_t i = 0; made->cut != NULL && i < made->count; i++)
        bat_mesh_free(&made->cut[i]);
    memory_pool_free(&made->pool);
}

static bat_status scene_begin(const bat_mesh_picture_panel *panels, size_t count, const bat_mesh_picture_options *options,
                              mesh_scene *made, bat_error *error)
{
    bat_status status = bat_options_check(&bat_mesh_picture_fields, options, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        status = check_panel(&panels[i], i, error);
    if (status != BAT_OK)
        return status;
    size_t rows = (count + USUAL_COLUMNS - 1) / USUAL_COLUMNS;
    *made = (mesh_scene){.panels = panels,
                         .count = count,
                         .columns = options->columns > 0 ? options->columns : (count + rows - 1) / rows,
                         .options = options};
    made->views = memory_pool_array(&made->pool, count, sizeof *made->views);
    made->frames = memory_pool_array(&made->pool, count, sizeof *made->frames);
    made->cut = memory_pool_zeros(&made->pool, count, sizeof *made->cut);
    made->columns = made->columns > count ? count : made->columns;
    status = memory_pool_check(&made->pool, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        if (panels[i].mesh->offsets != NULL)
            status = error_prefix(error, bat_mesh_triangulate(panels[i].mesh, &made->cut[i], error), "panel %zu: ", i);
    if (status != BAT_OK)
    {
        scene_free(made);
        return status;
    }
    find_values(made);
    find_frames(made);
    return BAT_OK;
}

static double panel_height(const void *context, size_t index, double width)
{
    const mesh_scene *made = context;
    const mesh_frame *frame = &made->frames[index];
    double aspect = (frame->high[1] - frame->low[1]) / fmax(frame->high[0] - frame->low[0], 1e-300);
    return width * fmin(fmax(aspect + 2 * FRAME_PADDING, FLATTEST), TALLEST);
}

static const char *panel_caption(const void *context, size_t index)
{
    const mesh_scene *made = context;
    return made->panels[index].title;
}

static shade_task panel_task(const mesh_scene *made, size_t index, const pixel_box *place)
{
    const bat_mesh_picture_panel *panel = &made->panels[index];
    const bat_mesh_picture_options *options = made->options;
    mesh_placing placing = mesh_frame_place(&made->frames[index], &made->views[index], place->columns, place->rows);
    return (shade_task){.mesh = triangles_of(made, index),
                        .polygons = panel->mesh->offsets != NULL ? panel->mesh : NULL,
                        .values = panel->values,
                        .value_low = made->value_low,
                        .value_high = made->value_high,
                        .wires = panel->wires,
                        .flat = panel->flat,
                        .occlusion = options->ambient_occlusion,
                        .boundaries = options->boundaries,
                        .placing = placing,
                        .line = WIRE_WIDTH * place->per_point,
                        .columns = place->columns,
                        .rows = place->rows,
                        .threads = options->threads};
}

static bat_status shade_image(const void *task, unsigned char *pixels, size_t stride, bat_error *error)
{
    return mesh_shade(task, pixels, stride, error);
}

static bat_status panel_draw_mesh(const void *context, cairo_t *cairo, size_t index, const double box[4], bat_error *error)
{
    const mesh_scene *made = context;
    pixel_box place = pixel_box_align(cairo, made->options->pixels_per_point, box);
    if ((double)place.columns * (double)place.rows * SHADE_SAMPLES * SHADE_SAMPLES > MAX_SAMPLES)
        return error_set(error, BAT_TOO_LARGE, index, 0,
                         "panel %zu would have %zu by %zu pixels; reduce the pixels for each point", index, place.columns,
                         place.rows);
    shade_task task = panel_task(made, index, &place);
    return pixel_image_draw(cairo, &place, shade_image, &task, error);
}

static void draw_scale(const void *context, cairo_t *cairo, const double box[4])
{
    const mesh_scene *made = context;
    colour_bar_draw(cairo, colour_scale_at, made->value_low, made->value_high, made->options->value_label, box);
}

bat_status bat_mesh_picture_write(const char *path, const bat_mesh_picture_panel *panels, size_t count,
                                  const bat_mesh_picture_options *options, bat_error *error)
{
    bat_mesh_picture_options defaults = bat_mesh_picture_defaults();
    canvas_format format;
    if (path == NULL || panels == NULL || count == 0)
        return ERROR_ARGUMENT(error, "a picture needs a file name and at least one mesh");
    bat_status status = canvas_format_of(path, &format, error);
    mesh_scene made;
    if (status == BAT_OK)
        status = scene_begin(panels, count, options != NULL ? options : &defaults, &made, error);
    if (status != BAT_OK)
        return status;
    bat_curve_picture_options page = bat_curve_picture_defaults();
    page.width = made.options->width;
    page.height = made.options->height;
    page.pixels_per_point = made.options->pixels_per_point;
    page.title = made.options->title;
    sheet_content content = {.count = count,
                             .columns = made.columns,
                             .options = &page,
                             .natural_width = fmin(80.0 + 240.0 * (double)made.columns, 4000.0),
                             .context = &made,
                             .height = panel_height,
                             .caption = panel_caption,
                             .draw = panel_draw_mesh,
                             .footer_height = made.has_values ? colour_bar_height() : 0,
                             .draw_footer = draw_scale};
    status = sheet_write(path, &content, error);
    scene_free(&made);
    return status;
}
