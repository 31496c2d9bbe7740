#include "engine.h"

#include <math.h>
#include <stdio.h>
#include <stdio_ext.h>
#include <stdlib.h>

// Readers and writers of this room have files alone: those of standard input and output, which JavaScript fills and takes.

static const char *const NONE[] = {NULL};
static const double DEGREES = 57.29577951308232;

static bat_status read_cloud(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION_CHOICE(bat_cloud_read_options, format, &bat_cloud_format_family),
        ENGINE_OPTION(bat_cloud_read_options, boundary, ENGINE_SIZE),
        ENGINE_OPTION(bat_cloud_read_options, strict, ENGINE_BOOL),
    };
    bat_cloud_read_options options = bat_cloud_read_defaults();
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    if (status != BAT_OK)
        return status;
    clearerr(stdin);
    __fpurge(stdin);
    return bat_cloud_read("-", &options, &result->cloud, error);
}

static bat_status cloud_noise(const engine_call *call, engine_object *result, bat_error *error)
{
    double sigma = NAN;
    bat_status status = engine_no_options(call->options, NONE, error);
    if (status == BAT_OK)
        status = bat_cloud_noise(&call->inputs[0]->cloud, &sigma, error);
    if (status == BAT_OK)
        engine_set(result->report, "noise", engine_number(sigma));
    return status;
}

static json_t *verdict_json(const bat_surface_verdict *verdict)
{
    json_t *json = json_object();
    engine_set(json, "fault", json_string(bat_choice_name(&bat_surface_fault_family, (int)verdict->fault)));
    engine_set(json, "distance_from_surface", engine_number(verdict->distance_from_surface));
    engine_set(json, "distance_from_points", engine_number(verdict->distance_from_points));
    engine_set(json, "farthest", engine_number(verdict->farthest));
    engine_set(json, "far_share", engine_number(verdict->far_share));
    engine_set(json, "cross_share", engine_number(verdict->cross_share));
    engine_set(json, "area", engine_number(verdict->area));
    engine_set(json, "cloud_area", engine_number(verdict->cloud_area));
    engine_set(json, "spacing", engine_number(verdict->spacing));
    engine_set(json, "off_planes", engine_number(verdict->off_planes));
    engine_set(json, "place", engine_numbers(verdict->place, 3));
    engine_set(json, "doubt", json_string(bat_choice_name(&bat_surface_doubt_family, (int)verdict->doubt)));
    engine_set(json, "doubt_size", engine_number(verdict->doubt_size));
    engine_set(json, "doubt_place", engine_numbers(verdict->doubt_place, 3));
    bat_error error;
    bool right = bat_surface_verdict_check(verdict, &error) == BAT_OK;
    engine_set(json, "right", json_boolean(right));
    const bool doubted = right && verdict->doubt != BAT_SURFACE_DOUBT_NONE;
    const char *doubt = doubted ? bat_choices(&bat_surface_doubt_family, verdict->doubt)->summary : "";
    engine_set(json, "text", json_string(right ? doubt : error.text));
    return json;
}

/// Holes of a trimmed surface, and gaps that it closes.
static json_t *gaps_json(const bat_surface_result *made)
{
    json_t *list = json_array();
    for (size_t k = 0; k < made->gap_count; k++)
    {
        const bat_surface_gap *gap = &made->gaps[k];
        json_t *row = json_object();
        engine_set(row, "closed", json_boolean(gap->closed));
        engine_set(row, "diameter", engine_number(gap->diameter));
        engine_set(row, "area", engine_number(gap->area));
        engine_set(row, "place", engine_numbers(gap->place, 3));
        (void)json_array_append_new(list, row);
    }
    return list;
}

static void report_fit(engine_object *result, size_t points)
{
    const bat_surface_result *made = &result->surface;
    const bat_surface_fit_report *fit = &made->report;
    const bat_surface_fit_round *last = &fit->rounds[fit->count - 1];
    json_t *report = result->report;
    engine_set(report, "chosen", json_string(bat_choice_name(&bat_surface_parameters_family, (int)made->chosen)));
    engine_set(report, "functions", engine_size(last->functions));
    engine_set(report, "levels", engine_size(last->levels));
    engine_set(report, "rms", engine_number(last->rms));
    engine_set(report, "mean_squared", engine_number(last->mean_squared));
    engine_set(report, "largest", engine_number(last->largest));
    engine_set(report, "within", engine_number(last->within));
    engine_set(report, "held_out_rms", engine_number(fit->held_out_rms));
    engine_set(report, "expected_rms", engine_number(fit->expected_rms));
    engine_set(report, "reached", json_boolean(fit->reached));
    engine_set(report, "outliers", engine_size(fit->outliers));
    engine_set(report, "noise", engine_number(made->noise));
    engine_set(report, "below_noise", json_boolean(made->below_noise));
    engine_set(report, "boundary_found", json_boolean(made->boundary_found));
    engine_set(report, "corners_found", json_boolean(made->corners_found));
    engine_set(report, "is_plane", json_boolean(made->is_plane));
    engine_set(report, "verdict", verdict_json(&made->verdict));
    engine_set(report, "gaps", gaps_json(made));
    engine_set(report, "distances", engine_array("f64", fit->distances, points));
    engine_set(report, "parameters", engine_array("f64", made->parameters, 2 * points));
    engine_set(report, "dimension", engine_size(made->surface.dimension));
    engine_set(report, "control",
               engine_array("f64", made->surface.control,
                            bat_hierarchical_space_functions(made->surface.space) * made->surface.dimension));
    // The order of the cloud has changed: its boundary comes first.
    engine_set(report, "points", engine_array("f64", result->cloud.points, 3 * result->cloud.count));
}

static bat_status reconstruct(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION_CHOICE(bat_surface_reconstruct_options, parameters, &bat_surface_parameters_family),
        ENGINE_OPTION_CHOICE(bat_surface_reconstruct_options, sides, &bat_cloud_sides_family),
        ENGINE_OPTION(bat_surface_reconstruct_options, published, ENGINE_BOOL),
        ENGINE_OPTION(bat_surface_reconstruct_options, slide_boundary, ENGINE_BOOL),
        ENGINE_OPTION(bat_surface_reconstruct_options, repair, ENGINE_BOOL),
        ENGINE_OPTION(bat_surface_reconstruct_options, force, ENGINE_BOOL),
        ENGINE_OPTION(bat_surface_reconstruct_options, trim, ENGINE_BOOL),
        ENGINE_OPTION(bat_surface_reconstruct_options, fill_holes, ENGINE_NUMBER),
#define FIT(field, kind) {#field, offsetof(bat_surface_reconstruct_options, fit.field), kind, NULL}
        FIT(tolerance, ENGINE_NUMBER),
        FIT(share, ENGINE_NUMBER),
        FIT(functions, ENGINE_SIZE),
        FIT(hold_out, ENGINE_INT),
        FIT(iterations, ENGINE_INT),
        FIT(neighbours, ENGINE_INT),
        {"smoothing", offsetof(bat_surface_reconstruct_options, fit.smoothing), ENGINE_CHOICE,
         &bat_surface_smoothing_family},
        FIT(weight, ENGINE_NUMBER),
        FIT(noise, ENGINE_NUMBER),
        FIT(corrections, ENGINE_INT),
        FIT(final_corrections, ENGINE_INT),
        FIT(restarts, ENGINE_BOOL),
        FIT(tensor, ENGINE_BOOL),
        FIT(robust, ENGINE_BOOL),
#undef FIT
    };
    bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
    options.fit.progress = ENGINE_PROGRESS;
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    if (status == BAT_OK)
        status = bat_cloud_copy(&call->inputs[0]->cloud, &result->cloud, error);
    if (status == BAT_OK)
        status = bat_surface_reconstruct(&result->cloud, &options, &result->surface, error);
    if (status == BAT_OK)
        report_fit(result, result->cloud.count);
    return status;
}

/// The bytes of the call are parameters.
static bat_status evaluate(const engine_call *call, engine_object *result, bat_error *error)
{
    struct
    {
        int derivatives;
    } options = {0};
    static const engine_option OPTIONS[] = {{"derivatives", 0, ENGINE_INT, NULL}};
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    if (status == BAT_OK && (options.derivatives < 0 || options.derivatives > 2 || call->size % (2 * sizeof(double)) != 0))
        status = engine_fail(error, BAT_INVALID_ARGUMENT, "derivatives are 0, 1 or 2, and parameters come in pairs", "");
    if (status != BAT_OK)
        return status;
    static const size_t ROWS[] = {1, 3, 6};
    const bat_spline_surface *surface = &call->inputs[0]->surface.surface;
    size_t count = call->size / (2 * sizeof(double)), numbers = count * ROWS[options.derivatives] * surface->dimension;
    double *values = engine_own(result, malloc((numbers + 1) * sizeof *values));
    if (values == NULL)
        return engine_fail(error, BAT_NO_MEMORY, "memory is used up", "");
    status = bat_spline_surface_evaluate(surface, call->bytes, count, options.derivatives, values, error);
    if (status == BAT_OK)
        engine_set(result->report, "values", engine_array("f64", values, numbers));
    return status;
}

static bat_status write_options(const engine_call *call, bat_surface_write_options *options, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION_CHOICE(bat_surface_write_options, format, &bat_surface_format_family),
        ENGINE_OPTION_CHOICE(bat_surface_write_options, unit, &bat_surface_unit_family),
        ENGINE_OPTION(bat_surface_write_options, samples, ENGINE_SIZE),
    };
    *options = bat_surface_write_defaults();
    return engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, options, error);
}

static bat_status write_surface(const engine_call *call, engine_object *result, bat_error *error)
{
    (void)result;
    bat_surface_write_options options;
    bat_status status = write_options(call, &options, error);
    if (status == BAT_OK)
        status = bat_surface_write("-", &call->inputs[0]->surface.surface, &options, error);
    return status;
}

static bat_status make_shell(const engine_call *call, engine_object *result, bat_error *error, const bat_cloud *cloud,
                             const bat_mesh *mesh)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION(bat_shell_reconstruct_options, tolerance, ENGINE_NUMBER),
        ENGINE_OPTION(bat_shell_reconstruct_options, faces, ENGINE_SIZE),
        ENGINE_OPTION(bat_shell_reconstruct_options, spans, ENGINE_SIZE),
        ENGINE_OPTION(bat_shell_reconstruct_options, crease, ENGINE_NUMBER),
        ENGINE_OPTION(bat_shell_reconstruct_options, fill_holes, ENGINE_NUMBER),
        ENGINE_OPTION(bat_shell_reconstruct_options, force, ENGINE_BOOL),
    };
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    bat_shell_report made;
    options.progress = ENGINE_PROGRESS;
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    if (status == BAT_OK)
        status = bat_shell_reconstruct(cloud != NULL ? cloud->points : NULL, cloud != NULL ? cloud->count : 0, mesh,
                                       &options, &result->shell, &made, error);
    if (status != BAT_OK)
        return status;
    json_t *report = result->report;
    engine_set(report, "face_count", engine_size(result->shell.face_count));
    engine_set(report, "spans", engine_size(result->shell.spans));
    engine_set(report, "closed", json_boolean(result->shell.closed));
    engine_set(report, "control_points", engine_size(result->shell.cage.vertex_count));
    engine_set(report, "fitted", engine_size(made.points));
    engine_set(report, "spacing", engine_number(made.spacing));
    engine_set(report, "noise", engine_number(made.noise));
    engine_set(report, "rms", engine_number(made.rms));
    engine_set(report, "largest", engine_number(made.largest));
    engine_set(report, "held_out", engine_number(made.held_out));
    engine_set(report, "reach", engine_number(made.reach));
    engine_set(report, "volume", engine_number(made.volume));
    engine_set(report, "normal_jump", engine_number(made.normal_jump[1] * DEGREES));
    engine_set(report, "pieces", engine_size(made.pieces));
    engine_set(report, "holes", engine_size(made.holes));
    engine_set(report, "filled", engine_size(made.filled));
    engine_set(report, "dropped_pieces", engine_size(made.dropped_pieces));
    size_t patches = result->shell.face_count * result->shell.spans * result->shell.spans;
    engine_set(report, "patches", engine_array("f64", result->shell.patches, patches * 16 * 3));
    return BAT_OK;
}

static bat_status shell_of_cloud(const engine_call *call, engine_object *result, bat_error *error)
{
    const bat_cloud *cloud = &call->inputs[0]->cloud;
    const bat_mesh mesh = {.positions = cloud->points,
                           .faces = cloud->triangles,
                           .vertex_count = cloud->count,
                           .face_count = cloud->triangle_count};
    return make_shell(call, result, error, cloud->triangle_count > 0 ? NULL : cloud,
                      cloud->triangle_count > 0 ? &mesh : NULL);
}

static bat_status shell_of_mesh(const engine_call *call, engine_object *result, bat_error *error)
{
    return make_shell(call, result, error, NULL, &call->inputs[0]->mesh);
}

static bat_status tessellate(const engine_call *call, engine_object *result, bat_error *error)
{
    struct
    {
        size_t samples;
    } options = {.samples = 4};
    static const engine_option OPTIONS[] = {{"samples", 0, ENGINE_SIZE, NULL}};
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    if (status == BAT_OK)
        status = bat_shell_tessellate(&call->inputs[0]->shell, options.samples, &result->mesh, error);
    return status;
}

static bat_status write_shell(const engine_call *call, engine_object *result, bat_error *error)
{
    (void)result;
    bat_surface_write_options options;
    bat_status status = write_options(call, &options, error);
    if (status != BAT_OK || options.format == BAT_SURFACE_FORMAT_STEP)
        return status == BAT_OK ? bat_shell_write("-", &call->inputs[0]->shell, &options, error) : status;
    if (options.format != BAT_SURFACE_FORMAT_OBJ)
        return engine_fail(error, BAT_UNSUPPORTED, "a shell is written as step or obj", "");
    bat_mesh mesh;
    bat_mesh_write_options write = bat_mesh_write_defaults();
    char *bytes = NULL;
    size_t size = 0;
    write.format = BAT_MESH_FORMAT_OBJ;
    status = bat_shell_tessellate(&call->inputs[0]->shell, options.samples > 0 ? options.samples : 4, &mesh, error);
    if (status != BAT_OK)
        return status;
    status = bat_mesh_write_memory(&mesh, &write, &bytes, &size, error);
    if (status == BAT_OK)
        (void)fwrite(bytes, 1, size, stdout);
    free(bytes);
    bat_mesh_free(&mesh);
    return status;
}

const engine_row ENGINE_SURFACE_ROWS[] = {
    {"bat_cloud_read", read_cloud, {ENGINE_VALUES}, ENGINE_CLOUD},
    {"bat_cloud_noise", cloud_noise, {ENGINE_CLOUD}, ENGINE_VALUES},
    {"bat_surface_reconstruct", reconstruct, {ENGINE_CLOUD}, ENGINE_SURFACE},
    {"bat_spline_surface_evaluate", evaluate, {ENGINE_SURFACE}, ENGINE_VALUES},
    {"bat_surface_write", write_surface, {ENGINE_SURFACE}, ENGINE_VALUES},
    {"bat_shell_reconstruct", shell_of_cloud, {ENGINE_CLOUD}, ENGINE_SHELL},
    {"bat_shell_reconstruct_mesh", shell_of_mesh, {ENGINE_MESH}, ENGINE_SHELL},
    {"bat_shell_tessellate", tessellate, {ENGINE_SHELL}, ENGINE_POLYGONS},
    {"bat_shell_write", write_shell, {ENGINE_SHELL}, ENGINE_VALUES},
    {NULL, NULL, {ENGINE_VALUES}, ENGINE_VALUES},
};
