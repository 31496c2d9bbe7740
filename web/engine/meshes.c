#include "engine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const NONE[] = {NULL};

/// Report notes and free them.
static void report_notes(engine_object *result, bat_mesh_notes *notes)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < notes->count; i++)
        (void)json_array_append_new(rows, json_string(notes->texts[i]));
    engine_set(result->report, "notes", rows);
    bat_mesh_notes_free(notes);
}

static bat_status refine_mesh(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION_CHOICE(bat_mesh_refine_options, scheme, &bat_mesh_scheme_family),
        ENGINE_OPTION_CHOICE(bat_mesh_refine_options, then, &bat_mesh_scheme_family),
        ENGINE_OPTION(bat_mesh_refine_options, fairness, ENGINE_NUMBER),
        ENGINE_OPTION(bat_mesh_refine_options, levels, ENGINE_SIZE),
        ENGINE_OPTION(bat_mesh_refine_options, limit, ENGINE_BOOL),
        ENGINE_OPTION(bat_mesh_refine_options, crease_angle, ENGINE_NUMBER),
        ENGINE_OPTION(bat_mesh_refine_options, tolerance, ENGINE_NUMBER),
        ENGINE_OPTION(bat_mesh_refine_options, max_edge, ENGINE_NUMBER),
        {"boundary", offsetof(bat_mesh_refine_options, rules.boundary), ENGINE_CHOICE, &bat_mesh_boundary_family},
        {"creasing", offsetof(bat_mesh_refine_options, rules.creasing), ENGINE_CHOICE, &bat_mesh_creasing_family},
        {"linear", offsetof(bat_mesh_refine_options, rules.linear), ENGINE_CHOICE, &bat_mesh_linear_family},
    };
    static const char *const ALSO[] = {"limit_normals", NULL};
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.progress = ENGINE_PROGRESS;
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), ALSO, &options, error);
    double *normals = NULL;
    if (json_is_true(json_object_get(call->options, "limit_normals")))
        options.limit_normals = &normals;
    size_t fallback = 0;
    if (status == BAT_OK)
        status = bat_mesh_refine(&call->inputs[0]->mesh, &options, &result->mesh, &fallback, error);
    if (status != BAT_OK)
        return status;
    size_t vertex_count = result->mesh.vertex_count;
    engine_set(result->report, "fallback", engine_size(fallback));
    if (normals != NULL)
        engine_set(result->report, "limit_normals", engine_array("f64", engine_own(result, normals), 3 * vertex_count));
    return BAT_OK;
}

/// The scheme that "auto" stands for.
static bat_status scheme_for(const engine_call *call, engine_object *result, bat_error *error)
{
    bat_status status = engine_no_options(call->options, NONE, error);
    bat_mesh_scheme scheme = bat_mesh_scheme_for(&call->inputs[0]->mesh);
    if (status == BAT_OK)
        engine_set(result->report, "scheme", json_string(bat_choice_name(&bat_mesh_scheme_family, (int)scheme)));
    return status;
}

static bat_status limit_normals(const engine_call *call, engine_object *result, bat_error *error)
{
    bat_status status = engine_no_options(call->options, NONE, error);
    const bat_mesh *given = &call->inputs[0]->mesh;
    size_t vertex_count = given->vertex_count;
    double *normals = engine_own(result, malloc((3 * vertex_count + 1) * sizeof *normals));
    if (normals == NULL)
        return engine_fail(error, BAT_NO_MEMORY, "memory is used up", "");
    if (status == BAT_OK)
        status = bat_mesh_limit_normals(given, 1, normals, error);
    if (status == BAT_OK)
        engine_set(result->report, "values", engine_array("f64", normals, 3 * vertex_count));
    return status;
}

static bat_status triangulate(const engine_call *call, engine_object *result, bat_error *error)
{
    bat_status status = engine_no_options(call->options, NONE, error);
    if (status == BAT_OK)
        status = bat_mesh_triangulate(&call->inputs[0]->mesh, &result->mesh, error);
    return status;
}

static bat_status decimate(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION(bat_mesh_decimate_options, vertices, ENGINE_SIZE),
        ENGINE_OPTION(bat_mesh_decimate_options, faces, ENGINE_SIZE),
        ENGINE_OPTION(bat_mesh_decimate_options, ratio, ENGINE_NUMBER),
        ENGINE_OPTION(bat_mesh_decimate_options, tolerance, ENGINE_NUMBER),
        ENGINE_OPTION(bat_mesh_decimate_options, relative_tolerance, ENGINE_BOOL),
        ENGINE_OPTION_CHOICE(bat_mesh_decimate_options, method, &bat_mesh_decimate_method_family),
        ENGINE_OPTION(bat_mesh_decimate_options, candidates, ENGINE_SIZE),
        ENGINE_OPTION(bat_mesh_decimate_options, seed, ENGINE_UINT64),
        ENGINE_OPTION(bat_mesh_decimate_options, min_normal, ENGINE_NUMBER),
        ENGINE_OPTION(bat_mesh_decimate_options, min_quality, ENGINE_NUMBER),
        ENGINE_OPTION(bat_mesh_decimate_options, boundary_weight, ENGINE_NUMBER),
        ENGINE_OPTION(bat_mesh_decimate_options, attributes, ENGINE_NUMBER),
    };
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    double distance = NAN;
    options.progress = ENGINE_PROGRESS;
    options.distance = &distance;
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    if (status == BAT_OK)
        status = bat_mesh_decimate(&call->inputs[0]->mesh, &options, &result->mesh, NULL, error);
    if (status == BAT_OK && options.tolerance > 0)
        engine_set(result->report, "distance", engine_number(distance));
    return status;
}

static void report_repairs(engine_object *result, const bat_mesh_repair_report *report)
{
    json_t *json = json_object();
    engine_set(json, "degenerate_faces", engine_size(report->degenerate_faces));
    engine_set(json, "duplicate_faces", engine_size(report->duplicate_faces));
    engine_set(json, "flipped_faces", engine_size(report->flipped_faces));
    engine_set(json, "nonmanifold_edges", engine_size(report->nonmanifold_edges));
    engine_set(json, "unorientable_edges", engine_size(report->unorientable_edges));
    engine_set(json, "split_vertices", engine_size(report->split_vertices));
    engine_set(json, "added_vertices", engine_size(report->added_vertices));
    engine_set(json, "filled_holes", engine_size(report->filled_holes));
    engine_set(json, "unused_vertices", engine_size(report->unused_vertices));
    engine_set(result->report, "repairs", json);
}

static bat_status repair(const engine_call *call, engine_object *result, bat_error *error)
{
    bat_mesh_repair_report report = {0};
    bat_status status = engine_no_options(call->options, NONE, error);
    if (status == BAT_OK)
        status = bat_mesh_repair(&call->inputs[0]->mesh, &report, &result->mesh, error);
    if (status == BAT_OK)
        report_repairs(result, &report);
    return status;
}

static bat_status weld(const engine_call *call, engine_object *result, bat_error *error)
{
    struct
    {
        double distance;
    } options = {0};
    static const engine_option OPTIONS[] = {{"distance", 0, ENGINE_NUMBER, NULL}};
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    size_t merged = 0;
    if (status == BAT_OK)
        status = bat_mesh_weld(&call->inputs[0]->mesh, options.distance, &merged, &result->mesh, error);
    if (status == BAT_OK)
        engine_set(result->report, "merged", engine_size(merged));
    return status;
}

static bat_status read_mesh(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION_CHOICE(bat_mesh_read_options, format, &bat_mesh_format_family),
        ENGINE_OPTION(bat_mesh_read_options, strict, ENGINE_BOOL),
        ENGINE_OPTION(bat_mesh_read_options, triangulate, ENGINE_BOOL),
        ENGINE_OPTION(bat_mesh_read_options, keep_degenerate, ENGINE_BOOL),
        ENGINE_OPTION(bat_mesh_read_options, repair, ENGINE_BOOL),
        ENGINE_OPTION(bat_mesh_read_options, fill_holes, ENGINE_SIZE),
    };
    bat_mesh_read_options options = bat_mesh_read_defaults();
    bat_mesh_repair_report report = {0};
    bat_mesh_notes notes = {0};
    options.repairs = &report;
    options.notes = &notes;
    options.polygons = result->kind == ENGINE_POLYGONS;
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    if (status == BAT_OK)
        status = bat_mesh_read_memory(call->bytes, call->size, &options, &result->mesh, error);
    if (status == BAT_OK)
        report_repairs(result, &report);
    report_notes(result, &notes);
    return status;
}

static bat_status write_mesh(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION_CHOICE(bat_mesh_write_options, format, &bat_mesh_format_family),
        ENGINE_OPTION_CHOICE(bat_mesh_write_options, encoding, &bat_mesh_encoding_family),
        ENGINE_OPTION_CHOICE(bat_mesh_write_options, normals, &bat_mesh_normals_family),
        ENGINE_OPTION(bat_mesh_write_options, tangents, ENGINE_BOOL),
    };
    bat_mesh_write_options options = bat_mesh_write_defaults();
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    bat_mesh_notes notes = {0};
    char *bytes = NULL;
    size_t size = 0;
    options.notes = &notes;
    if (status == BAT_OK)
        status = bat_mesh_write_memory(&call->inputs[0]->mesh, &options, &bytes, &size, error);
    if (status == BAT_OK)
        engine_set(result->report, "bytes", engine_array("u8", engine_own(result, bytes), size));
    report_notes(result, &notes);
    return status;
}

static bat_status summarize(const engine_call *call, engine_object *result, bat_error *error)
{
    bat_mesh_summary summary;
    bat_status status = engine_no_options(call->options, NONE, error);
    if (status == BAT_OK)
        status = bat_mesh_summarize(&call->inputs[0]->mesh, &summary, error);
    if (status != BAT_OK)
        return status;
    bat_measure measure;
    for (size_t i = 0; bat_mesh_measures(1, i, &measure); i++)
        engine_measure(result->report, &measure, &summary);
    return BAT_OK;
}

static bat_status compare(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION(bat_mesh_compare_options, vertices, ENGINE_BOOL),
        ENGINE_OPTION(bat_mesh_compare_options, samples, ENGINE_SIZE),
        ENGINE_OPTION(bat_mesh_compare_options, tolerance, ENGINE_NUMBER),
    };
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    options.progress = ENGINE_PROGRESS;
    bat_mesh_distance distance;
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    if (status == BAT_OK)
        status = bat_mesh_compare(&call->inputs[0]->mesh, &call->inputs[1]->mesh, &options, &distance, error);
    if (status != BAT_OK)
        return status;
    bat_measure measure;
    for (size_t i = 0; bat_mesh_measures(2, i, &measure); i++)
        engine_measure(result->report, &measure, &distance);
    return BAT_OK;
}

static bat_status vertex_distances(const engine_call *call, engine_object *result, bat_error *error)
{
    bat_status status = engine_no_options(call->options, NONE, error);
    const bat_mesh *from = &call->inputs[0]->mesh;
    double *distances = engine_own(result, malloc((from->vertex_count + 1) * sizeof *distances));
    if (distances == NULL)
        return engine_fail(error, BAT_NO_MEMORY, "memory is used up", "");
    if (status == BAT_OK)
        status = bat_mesh_vertex_distances(from, &call->inputs[1]->mesh, 1, distances, error);
    if (status == BAT_OK)
        engine_set(result->report, "values", engine_array("f64", distances, from->vertex_count));
    return status;
}

const engine_row ENGINE_MESH_ROWS[] = {
    {"bat_mesh_refine", refine_mesh, {ENGINE_MESH}, ENGINE_MESH},
    {"bat_mesh_scheme_for", scheme_for, {ENGINE_MESH}, ENGINE_VALUES},
    {"bat_mesh_limit_normals", limit_normals, {ENGINE_MESH}, ENGINE_VALUES},
    {"bat_mesh_decimate", decimate, {ENGINE_MESH}, ENGINE_MESH},
    {"bat_mesh_repair", repair, {ENGINE_MESH}, ENGINE_MESH},
    {"bat_mesh_weld", weld, {ENGINE_MESH}, ENGINE_MESH},
    {"bat_mesh_read_memory", read_mesh, {ENGINE_VALUES}, ENGINE_MESH},
    {"bat_mesh_write_memory", write_mesh, {ENGINE_MESH}, ENGINE_VALUES},
    {"bat_mesh_summarize", summarize, {ENGINE_MESH}, ENGINE_VALUES},
    {"bat_mesh_compare", compare, {ENGINE_MESH, ENGINE_MESH}, ENGINE_VALUES},
    {"bat_mesh_vertex_distances", vertex_distances, {ENGINE_MESH, ENGINE_MESH}, ENGINE_VALUES},
    {"bat_polygon_mesh_refine", refine_mesh, {ENGINE_POLYGONS}, ENGINE_POLYGONS},
    {"bat_polygon_mesh_scheme_for", scheme_for, {ENGINE_POLYGONS}, ENGINE_VALUES},
    {"bat_polygon_mesh_limit_normals", limit_normals, {ENGINE_POLYGONS}, ENGINE_VALUES},
    {"bat_polygon_mesh_triangulate", triangulate, {ENGINE_POLYGONS}, ENGINE_MESH},
    {"bat_polygon_mesh_of_triangles", triangulate, {ENGINE_MESH}, ENGINE_POLYGONS},
    {"bat_polygon_mesh_read_memory", read_mesh, {ENGINE_VALUES}, ENGINE_POLYGONS},
    {"bat_polygon_mesh_write_memory", write_mesh, {ENGINE_POLYGONS}, ENGINE_VALUES},
    {NULL, NULL, {ENGINE_VALUES}, ENGINE_VALUES},
};
