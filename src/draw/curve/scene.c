#include "draw/curve/scene.h"

#include "base/choice.h"
#include "base/error.h"
#include "base/option.h"

/// @file
/// Checks and measurements of a picture's panels.

#define SMALLEST_SIDE 20.0
#define LARGEST_SIDE 10000.0
/// The limits of the middle of the globe, in radians; pi/2 and rounding.
#define LARGEST_LONGITUDE 1e6
#define LARGEST_LATITUDE 1.57079632679489662
#define MAX_COLUMNS 5
/// The width that a panel needs for its details.
#define MIN_PANEL 100.0

bool scene_layer_shown(const bat_curve_picture_layer *layer, const bat_curve_picture_options *options)
{
    return layer->role != BAT_CURVE_LAYER_ROLE_CONTROL || options->control_points || options->control_polygon;
}

bool scene_is_map(const scene_panel *panel)
{
    return panel->polygons || (panel->space == VIEW_SPHERE && panel->frame.map.projection == BAT_CURVE_PROJECTION_LOCAL);
}

bool scene_points_shown(const scene_panel *panel, const bat_curve_picture_options *options)
{
    const size_t few = 400;
    return options->control_points && (panel->given_points <= few || !scene_is_map(panel));
}

int scene_colour(const bat_curve_picture_panel *panel, size_t index)
{
    int place = 1;
    for (size_t i = 0; i < index && panel->layers[index].colour == 0; i++)
        place += panel->layers[i].role == BAT_CURVE_LAYER_ROLE_CURVE ? 1 : 0;
    return panel->layers[index].colour > 0 ? panel->layers[index].colour : place;
}

size_t scene_columns(const bat_curve_picture_options *options, size_t count, double min_width)
{
    if (options->columns > 0)
        return options->columns < count ? options->columns : count;
    size_t max_columns = MAX_COLUMNS;
    if (options->width > 0.0)
        max_columns = (size_t)fmin(fmax(options->width / min_width, 1.0), MAX_COLUMNS);
    size_t rows = (count + max_columns - 1) / max_columns;
    return (count + rows - 1) / rows;
}

static const bat_choice PROJECTIONS[] = {
    CHOICE("auto", "local, map or globe, by what the curves cover", BAT_CURVE_PROJECTION_AUTO),
    CHOICE("globe", "orthographic, from far away", BAT_CURVE_PROJECTION_GLOBE),
    CHOICE("map", "the world in the Equal Earth projection", BAT_CURVE_PROJECTION_MAP),
    CHOICE("local", "azimuthal equal-area about the curves, with a scale bar", BAT_CURVE_PROJECTION_LOCAL),
    CHOICE("both", "the globe, and the map to its right", BAT_CURVE_PROJECTION_BOTH),
};
const bat_family bat_curve_projection_family = FAMILY("projection", PROJECTIONS);

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_curve_picture_options, width, OPTION_ZERO, SMALLEST_SIDE, LARGEST_SIDE),
    OPTION_FIELD(bat_curve_picture_options, height, OPTION_ZERO, SMALLEST_SIDE, LARGEST_SIDE),
    OPTION_FIELD(bat_curve_picture_options, pixels_per_point, OPTION_NUMBER, 0.1, 20),
    OPTION_FAMILY(bat_curve_picture_options, projection, bat_curve_projection_family),
    OPTION_FIELD(bat_curve_picture_options, longitude, OPTION_ANGLE, -LARGEST_LONGITUDE, LARGEST_LONGITUDE),
    OPTION_FIELD(bat_curve_picture_options, latitude, OPTION_ANGLE, -LARGEST_LATITUDE, LARGEST_LATITUDE),
    OPTION_FIELD(bat_curve_picture_options, comb_scale, OPTION_NUMBER, 0, INFINITY),
};

static bat_status curve_picture_options_check(const void *opaque, bat_error *error)
{
    const bat_curve_picture_options *options = opaque;
    const char *wrong = !text_is_valid(options->title) ? "title" : !text_is_valid(options->unit) ? "unit" : NULL;
    return wrong == NULL ? BAT_OK : error_option(error, wrong, "must be UTF-8 without control characters");
}

const bat_options_table bat_curve_picture_fields =
    OPTIONS_TABLE(bat_curve_picture_options, FIELDS, curve_picture_options_check);

static bat_status check_layer(const bat_curve_picture_layer *layer, size_t panel, size_t index, bat_error *error)
{
    bat_status status = view_check(layer->curve, error);
    if (status != BAT_OK && error != NULL && error->index == BAT_NO_INDEX)
        error->index = index;
    if (status != BAT_OK)
        return error_prefix(error, status, "panel %zu, layer %zu: ", panel, index);
    if (layer->role < BAT_CURVE_LAYER_ROLE_CURVE || layer->role > BAT_CURVE_LAYER_ROLE_TRUTH || layer->colour < 0)
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "panel %zu, layer %zu: no such role or colour", panel,
                         index);
    if (!text_is_valid(layer->label))
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "panel %zu, layer %zu: the label is not plain UTF-8 text",
                         panel, index);
    return BAT_OK;
}

static bat_status check_panel(const bat_curve_picture_panel *panel, size_t index, bat_error *error)
{
    if (panel->layers == NULL || panel->layer_count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "panel %zu has no layers", index);
    if (!text_is_valid(panel->title))
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "the title of panel %zu is not plain UTF-8 text", index);
    for (size_t i = 0; i < panel->layer_count; i++)
    {
        bat_status status = check_layer(&panel->layers[i], index, i, error);
        if (status != BAT_OK)
            return status;
        const bat_space *first = panel->layers[0].curve->space;
        const bat_space *space = panel->layers[i].curve->space;
        if (view_space_of(space) != view_space_of(first) || space->point_dim != first->point_dim)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0,
                             "panel %zu, layer %zu: its space differs from that of layer 0", index, i);
    }
    return BAT_OK;
}

static bat_status make_combs(scene_panel *panel, bat_error *error)
{
    const bat_curve_picture_panel *source = panel->drawn;
    if (array_zeros(&panel->combs, source->layer_count, sizeof *panel->combs, error) != BAT_OK)
        return BAT_NO_MEMORY;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < source->layer_count && status == BAT_OK; i++)
    {
        bool itself = source == panel->source && panel->space != VIEW_TENSOR;
        if (itself && source->layers[i].role == BAT_CURVE_LAYER_ROLE_CURVE)
            status = comb_make(source->layers[i].curve, &panel->combs[i], error);
    }
    return status;
}

static void include_point(scene_frame *frame, const draw_view *view, const double *point)
{
    double place[2];
    view_project(view, point, &place[0], &place[1]);
    box_include(2, place, frame->low, frame->high);
    if (view->space == VIEW_SOLID)
        box_include(3, point, frame->box_low, frame->box_high);
}

static bool same_space(const scene_panel *a, const scene_panel *b)
{
    return a->space == b->space && a->point_dim == b->point_dim;
}

static void include_curves(scene_frame *frame, const scene *made, const scene_panel *panel)
{
    draw_view view = {.kind = VIEW_FLAT, .space = panel->space, .point_dim = panel->point_dim};
    view_set_solid(&view);
    for (size_t i = 0; i < panel->drawn->layer_count; i++)
    {
        const bat_curve_picture_layer *layer = &panel->drawn->layers[i];
        for (size_t k = 0; k < layer->curve->count && scene_layer_shown(layer, made->options); k++)
            include_point(frame, &view, layer->curve->points + k * panel->point_dim);
    }
    for (unsigned corner = 0; corner < 8 && panel->space == VIEW_SOLID && made->options->axes; corner++)
    {
        double point[3];
        scene_corner(frame, corner, point);
        include_point(frame, &view, point);
    }
}

static bat_status scale_combs(scene_frame *frame, const scene_panel *panel, bat_error *error)
{
    double extent = hypot(frame->high[0] - frame->low[0], frame->high[1] - frame->low[1]);
    bool flat = panel->space == VIEW_PLANE || panel->space == VIEW_SOLID;
    double usual = flat ? 0.1 * extent : panel->space == VIEW_SPHERE ? 0.3 : 0.5; // in the unit of the space
    bat_status status = BAT_OK;
    for (size_t i = 0; i < panel->drawn->layer_count && status == BAT_OK; i++)
    {
        double scale = INFINITY;
        if (panel->combs != NULL && panel->combs[i].count > 0)
            status = comb_natural_scale(&panel->combs[i], usual, 2.5 * usual, &scale, error);
        frame->comb_scale = fmin(frame->comb_scale, scale);
    }
    return status;
}

static void include_combs(scene_frame *frame, const scene_panel *panel, double *tip)
{
    if (panel->combs == NULL)
        return;
    draw_view view = {.kind = VIEW_FLAT, .space = panel->space, .point_dim = panel->point_dim};
    view_set_solid(&view);
    for (size_t i = 0; i < panel->drawn->layer_count; i++)
        for (size_t k = 0; k < panel->combs[i].count; k++)
        {
            double place[2];
            comb_tip(&panel->combs[i], k, frame->comb_scale, tip);
            view_project(&view, tip, &place[0], &place[1]);
            box_include(2, place, frame->low, frame->high);
        }
}

/// Choose a common comb scale for the panels first, …, end - 1 like `panel`, and extend the frame by the segments.
static bat_status frame_combs(scene_frame *frame, const scene *made, const scene_panel *panel, size_t first, size_t end,
                              bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = first; i < end && status == BAT_OK; i++)
        status = same_space(panel, &made->panels[i]) ? scale_combs(frame, &made->panels[i], error) : BAT_OK;
    frame->comb_scale = isfinite(frame->comb_scale) ? frame->comb_scale : 0.0;
    frame->comb_scale = made->options->comb_scale > 0.0 ? made->options->comb_scale : frame->comb_scale;
    double *tip = memory_array(panel->point_dim, sizeof(double));
    if (tip == NULL)
        return error_memory(error, panel->point_dim * sizeof(double));
    for (size_t i = first; i < end && (panel->space == VIEW_PLANE || panel->space == VIEW_SOLID); i++)
        if (same_space(panel, &made->panels[i]))
            include_combs(frame, &made->panels[i], tip);
    free(tip);
    return status;
}

/// Choose what the panels first, …, end - 1 show of the sphere.
static bat_status frame_sphere(scene_frame *frame, const scene *made, size_t first, size_t end, bat_error *error)
{
    size_t count = 0;
    for (size_t i = first; i < end; i++)
        count += made->panels[i].drawn->layer_count;
    const bat_curve **curves = memory_array(count, sizeof *curves);
    if (curves == NULL)
        return error_memory(error, count * sizeof *curves);
    count = 0;
    bool polygons = false;
    for (size_t i = first; i < end; i++)
    {
        const bat_curve_picture_panel *source = made->panels[i].drawn;
        polygons = polygons || (made->panels[i].space == VIEW_SPHERE && made->panels[i].polygons);
        for (size_t k = 0; k < source->layer_count && made->panels[i].space == VIEW_SPHERE; k++)
            curves[count++] = source->layers[k].curve;
    }
    frame->map = map_choose(curves, count, polygons, made->options);
    free(curves);
    return BAT_OK;
}

/// Enlarge an empty or one-dimensional range.
static void widen(scene_frame *frame)
{
    double extent = fmax(frame->high[0] - frame->low[0], frame->high[1] - frame->low[1]);
    double min_width = extent > 0.0 ? 0.1 * extent : fmax(1e-3 * fmax(fabs(frame->low[0]), fabs(frame->low[1])), 1e-12);
    for (int k = 0; k < 2; k++)
    {
        double lack = fmax(0.0, min_width - (frame->high[k] - frame->low[k]));
        frame->low[k] -= 0.5 * lack;
        frame->high[k] += 0.5 * lack;
    }
}

static bat_status set_frame(scene *made, size_t index, bat_error *error)
{
    scene_panel *panel = &made->panels[index];
    scene_frame frame = {.comb_scale = INFINITY};
    box_clear(3, frame.box_low, frame.box_high);
    box_clear(2, frame.low, frame.high);
    // The panels that share the frame, all in the same space.
    size_t columns = made->options->own_frames ? 1 : made->columns, first = index - index % columns;
    size_t end = first + columns < made->count ? first + columns : made->count;
    for (size_t i = first; i < index; i++)
        if (same_space(panel, &made->panels[i]))
        {
            panel->frame = made->panels[i].frame;
            return BAT_OK;
        }
    bool flat = panel->space == VIEW_PLANE || panel->space == VIEW_SOLID;
    for (size_t i = first; i < end && flat; i++)
        if (same_space(panel, &made->panels[i]))
            include_curves(&frame, made, &made->panels[i]);
    if (flat && !(frame.low[0] <= frame.high[0]))
        box_include(2, (const double[]){0.0, 0.0}, frame.low, frame.high);
    bat_status status = panel->space == VIEW_SPHERE ? frame_sphere(&frame, made, first, end, error) : BAT_OK;
    for (size_t i = first; i < end && panel->space == VIEW_TENSOR && status == BAT_OK; i++)
        status = same_space(panel, &made->panels[i]) ? tensor_row_include(&frame, made->panels[i].drawn, error) : BAT_OK;
    if (status == BAT_OK && made->options->comb)
        status = frame_combs(&frame, made, panel, first, end, error);
    widen(&frame);
    panel->frame = frame;
    return status;
}

/// Choose the panel itself or its proxy.
static bat_status choose_drawn(scene_panel *panel, const bat_curve_picture_options *options, bat_error *error)
{
    const bat_space *space = panel->source->layers[0].curve->space;
    panel->drawn = panel->source;
    if (view_space_of(space) > VIEW_TENSOR)
    {
        bat_status status = proxy_make(panel->source, options, &panel->proxied, error);
        if (status != BAT_OK)
            return status;
        panel->drawn = &panel->proxied.panel;
        space = &panel->proxied.space;
    }
    panel->space = view_space_of(space);
    panel->point_dim = space->point_dim;
    return BAT_OK;
}

/// What the layers of a panel are, taken together.
static void summarize(scene_panel *panel)
{
    bool holds = panel->space == VIEW_SPHERE || panel->space == VIEW_PLANE;
    panel->given_only = true;
    for (size_t k = 0; k < panel->drawn->layer_count; k++)
    {
        const bat_curve_picture_layer *layer = &panel->drawn->layers[k];
        panel->polygons = panel->polygons || (holds && layer->polygon > 0);
        panel->given_only = panel->given_only && layer->role != BAT_CURVE_LAYER_ROLE_CURVE;
        panel->given_points += layer->role == BAT_CURVE_LAYER_ROLE_CONTROL ? layer->curve->count : 0;
    }
}

bat_status scene_measure(const bat_curve_picture_panel *panels, size_t count, const bat_curve_picture_options *options,
                         scene *made, bat_error *error)
{
    bat_status status = bat_options_check(&bat_curve_picture_fields, options, error);
    if (status != BAT_OK)
        return status;
    *made = (scene){.options = options, .count = count, .columns = scene_columns(options, count, MIN_PANEL)};
    made->rows = (count + made->columns - 1) / made->columns;
    if (array_zeros(&made->panels, count, sizeof *made->panels, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t i = 0; i < made->count && status == BAT_OK; i++)
    {
        scene_panel *panel = &made->panels[i];
        status = check_panel(&panels[i], i, error);
        if (status == BAT_OK)
        {
            panel->source = &panels[i];
            status = choose_drawn(panel, made->options, error);
        }
        if (status == BAT_OK && made->options->comb)
            status = make_combs(panel, error);
        if (status == BAT_OK)
            summarize(panel);
    }
    for (size_t i = 0; i < made->count && status == BAT_OK; i++)
        status = set_frame(made, i, error);
    if (status != BAT_OK)
        scene_free(made);
    return status;
}

bat_status scene_make(const bat_curve_picture_panel *panels, size_t count, const bat_curve_picture_options *options,
                      scene *made, bat_error *error)
{
    bat_status status = scene_measure(panels, count, options, made, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        scene_panel *panel = &made->panels[i];
        status = panel->polygons ? map_network_make(panel->drawn, &panel->network, error) : BAT_OK;
    }
    if (status != BAT_OK)
        scene_free(made);
    return status;
}

void scene_free(scene *made)
{
    for (size_t i = 0; i < made->count && made->panels != NULL; i++)
    {
        for (size_t k = 0; made->panels[i].combs != NULL && k < made->panels[i].drawn->layer_count; k++)
            memory_pool_free(&made->panels[i].combs[k].pool);
        free(made->panels[i].combs);
        memory_pool_free(&made->panels[i].network.pool);
        proxy_free(&made->panels[i].proxied);
    }
    free(made->panels);
    *made = (scene){0};
}
