#include "engine.h"

#include "batten/research/curve_analysis.h"

#include <stdlib.h>
#include <string.h>

/// The largest level of sampled basic limit functions.
#define MAX_BASIS_LEVEL 16

static const char *const SCHEME[] = {"scheme", NULL};
static const char *const NONE[] = {NULL};

/// Refine curves each by itself, or as a map. The options are those of both.
static bat_status refine(const engine_call *call, engine_object *result, bat_error *error, bool map)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION(bat_curve_map_refine_options, refine.levels, ENGINE_SIZE),
        ENGINE_OPTION_CHOICE(bat_curve_map_refine_options, refine.ends, &bat_curve_end_rule_family),
        ENGINE_OPTION(bat_curve_map_refine_options, refine.snap, ENGINE_BOOL),
        ENGINE_OPTION(bat_curve_map_refine_options, refine.max_points, ENGINE_SIZE),
        ENGINE_OPTION_CHOICE(bat_curve_map_refine_options, refine.simple, &bat_curve_simple_family),
        ENGINE_OPTION(bat_curve_map_refine_options, refine.corner_angle, ENGINE_NUMBER),
        ENGINE_OPTION(bat_curve_map_refine_options, refine.find_corners, ENGINE_BOOL),
        ENGINE_OPTION(bat_curve_map_refine_options, refine.max_edge, ENGINE_NUMBER),
        ENGINE_OPTION(bat_curve_map_refine_options, refine.tolerance, ENGINE_NUMBER),
        ENGINE_OPTION(bat_curve_map_refine_options, refine.max_levels, ENGINE_SIZE),
        ENGINE_OPTION(bat_curve_map_refine_options, refine.first_level, ENGINE_SIZE),
        ENGINE_OPTION(bat_curve_map_refine_options, refine.smooth, ENGINE_NUMBER),
        ENGINE_OPTION_CHOICE(bat_curve_map_refine_options, topology, &bat_curve_map_topology_family),
        ENGINE_OPTION_CHOICE(bat_curve_map_refine_options, edges, &bat_curve_map_edges_family),
        ENGINE_OPTION_CHOICE(bat_curve_map_refine_options, join, &bat_curve_map_join_family),
        ENGINE_OPTION(bat_curve_map_refine_options, simplify, ENGINE_NUMBER),
        ENGINE_OPTION(bat_curve_map_refine_options, snap_tolerance, ENGINE_NUMBER),
        ENGINE_OPTION(bat_curve_map_refine_options, keep_area, ENGINE_BOOL),
        ENGINE_OPTION(bat_curve_map_refine_options, decimals, ENGINE_INT),
    };
    // Without the prefix that tells the inner struct.
    engine_option rows[ENGINE_COUNT(OPTIONS)];
    const size_t of_maps = 7, count = ENGINE_COUNT(OPTIONS) - (map ? 0 : of_maps);
    memcpy(rows, OPTIONS, sizeof rows);
    for (size_t i = 0; i < ENGINE_COUNT(rows) - of_maps; i++)
        rows[i].name += strlen("refine.");
    bat_curve_map_refine_options options = bat_curve_map_refine_defaults();
    bat_status status = engine_options(call->options, rows, count, SCHEME, &options, error);
    const char *name = NULL;
    if (status == BAT_OK)
        status = engine_text(call->options, "scheme", &name, error);
    if (status == BAT_OK && name != NULL)
        status = bat_curve_scheme_by_name(name, &options.refine.scheme, error);
    if (status != BAT_OK)
        return status;
    options.refine.progress = ENGINE_PROGRESS;
    const bat_curve_set *set = &call->inputs[0]->set;
    bat_curve_map_refine_report report = {0};
    if (map)
    {
        options.report = &report;
        status = bat_curve_map_refine(set, &options, &result->set, error);
    }
    else
    {
        options.refine.report = &report.curves;
        bat_curve *fine = calloc(set->count, sizeof *fine);
        if (fine == NULL)
            return engine_fail(error, BAT_NO_MEMORY, "memory is used up", "");
        status = bat_curves_refine(set->curves, set->count, &options.refine, fine, error);
        if (status == BAT_OK)
            status = bat_curve_set_like(set, fine, &result->set, error);
        if (status != BAT_OK)
            free(fine);
    }
    if (status != BAT_OK)
    {
        if (error->curve < set->count && error->index != BAT_NO_INDEX && error->line == 0)
            error->line = bat_curve_set_line(set, error->curve, error->index);
        return status;
    }
    const bat_curve_refine_report *curves = &report.curves;
    json_t *json = json_object();
    engine_set(json, "checked", engine_size(curves->checked));
    engine_set(json, "given_crossing", engine_size(map ? report.given_crossing : curves->given_crossing));
    engine_set(json, "crossing", engine_size(curves->crossing));
    engine_set(json, "crossings", engine_size(map ? report.crossings : curves->crossings));
    engine_set(json, "drawn_back", engine_size(map ? report.drawn_back : curves->drawn_back));
    engine_set(json, "straight", engine_size(curves->straight));
    engine_set(json, "left_crossing", engine_size(curves->left_crossing));
    engine_set(json, "stopped", engine_size(curves->stopped));
    engine_set(json, "corners", engine_size(curves->corners));
    engine_set(json, "min_levels", engine_size(curves->min_levels));
    engine_set(json, "max_levels", engine_size(curves->max_levels));
    if (map)
    {
        engine_set(json, "map", json_boolean(report.map));
        engine_set(json, "arcs", engine_size(report.arcs));
        engine_set(json, "shared", engine_size(report.shared));
        engine_set(json, "nodes", engine_size(report.nodes));
        engine_set(json, "snapped", engine_size(report.snapped));
        engine_set(json, "spikes", engine_size(report.spikes));
        engine_set(json, "largest_snap", engine_number(report.largest_snap));
        engine_set(json, "largest_area_error", engine_number(report.largest_area_error));
    }
    engine_set(result->report, "report", json);
    return BAT_OK;
}

static bat_status refine_curves(const engine_call *call, engine_object *result, bat_error *error)
{
    return refine(call, result, error, false);
}

static bat_status refine_map(const engine_call *call, engine_object *result, bat_error *error)
{
    return refine(call, result, error, true);
}

static bat_status read_curves(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION_CHOICE(bat_curve_read_options, format, &bat_curve_format_family),
        ENGINE_OPTION(bat_curve_read_options, space, ENGINE_TEXT),
        ENGINE_OPTION(bat_curve_read_options, closed, ENGINE_INT),
        ENGINE_OPTION(bat_curve_read_options, strict, ENGINE_BOOL),
        ENGINE_OPTION(bat_curve_read_options, project, ENGINE_BOOL),
        ENGINE_OPTION(bat_curve_read_options, columns, ENGINE_TEXT),
        ENGINE_OPTION(bat_curve_read_options, group, ENGINE_TEXT),
        ENGINE_OPTION(bat_curve_read_options, euler, ENGINE_TEXT),
        ENGINE_OPTION(bat_curve_read_options, translation_weight, ENGINE_NUMBER),
    };
    bat_curve_read_options options = bat_curve_read_defaults();
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    if (status == BAT_OK)
        status = bat_curve_read_memory(call->bytes, call->size, &options, &result->set, error);
    if (status != BAT_OK)
        return status;
    engine_set(result->report, "has_times", json_boolean(bat_motion_has_times(&result->set)));
    json_t *rings = json_array();
    for (size_t i = 0; i < result->set.count; i++)
    {
        size_t polygon, feature;
        if (bat_curve_set_polygon(&result->set, i, &polygon, &feature))
            (void)json_array_append_new(rings, json_pack("[I,I]", (json_int_t)polygon, (json_int_t)feature));
        else
            (void)json_array_append_new(rings, json_null());
    }
    engine_set(result->report, "polygons", rings);
    return BAT_OK;
}

static bat_status write_curves(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION_CHOICE(bat_curve_write_options, format, &bat_curve_format_family),
        ENGINE_OPTION(bat_curve_write_options, precision, ENGINE_INT),
        ENGINE_OPTION(bat_curve_write_options, crs, ENGINE_TEXT),
    };
    bat_curve_write_options options = bat_curve_write_defaults();
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    char *text = NULL;
    size_t size = 0;
    if (status == BAT_OK)
        status = bat_curve_write_memory(&call->inputs[0]->set, &options, &text, &size, error);
    if (status == BAT_OK)
        engine_set(result->report, "bytes", engine_array("u8", engine_own(result, text), size));
    return status;
}

/// Fairness, angles, lengths and simplicity of each curve.
static bat_status measure_curves(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {ENGINE_OPTION(bat_curve_measure_options, bending_offset, ENGINE_NUMBER)};
    bat_curve_measure_options options = bat_curve_measure_defaults();
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    const bat_curve_set *set = &call->inputs[0]->set;
    json_t *rows = json_array();
    for (size_t i = 0; i < set->count && status == BAT_OK; i++)
    {
        bat_curve_fairness_values values;
        status = bat_curve_fairness(&set->curves[i], &options, &values, error);
        json_t *row = json_object();
        bat_measure measure;
        for (size_t k = 0; status == BAT_OK && bat_curve_measures(1, k, &measure); k++)
            engine_measure(row, &measure, &values);
        (void)json_array_append_new(rows, row);
    }
    engine_set(result->report, "fairness", rows);
    return status;
}

static bat_status are_simple(const engine_call *call, engine_object *result, bat_error *error)
{
    bat_status status = engine_no_options(call->options, NONE, error);
    const bat_curve_set *set = &call->inputs[0]->set;
    json_t *rows = json_array();
    for (size_t i = 0; i < set->count && status == BAT_OK; i++)
    {
        bool simple = false;
        status = bat_curve_is_simple(&set->curves[i], &simple, error);
        (void)json_array_append_new(rows, json_boolean(simple));
    }
    engine_set(result->report, "simple", rows);
    return status;
}

/// The exterior angles of the first curve.
static bat_status exterior_angles(const engine_call *call, engine_object *result, bat_error *error)
{
    bat_status status = engine_no_options(call->options, NONE, error);
    const bat_curve *curve = &call->inputs[0]->set.curves[0];
    double *angles = engine_own(result, malloc((curve->count + 1) * sizeof *angles));
    if (angles == NULL)
        return engine_fail(error, BAT_NO_MEMORY, "memory is used up", "");
    if (status == BAT_OK)
        status = bat_curve_exterior_angles(curve, angles, error);
    if (status == BAT_OK)
        engine_set(result->report, "values", engine_array("f64", angles, curve->count));
    return status;
}

static bat_status edge_lengths(const engine_call *call, engine_object *result, bat_error *error)
{
    bat_status status = engine_no_options(call->options, NONE, error);
    const bat_curve *curve = &call->inputs[0]->set.curves[0];
    double *lengths = engine_own(result, malloc((curve->count + 1) * sizeof *lengths));
    if (lengths == NULL)
        return engine_fail(error, BAT_NO_MEMORY, "memory is used up", "");
    bat_curve_edge_lengths(curve, lengths);
    engine_set(result->report, "values",
               engine_array("f64", lengths, curve->count > 0 && !curve->closed ? curve->count - 1 : curve->count));
    return status;
}

/// The distances of the first curves of two sets.
static bat_status compare_curves(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION(bat_curve_measure_options, geodesic, ENGINE_BOOL),
        ENGINE_OPTION(bat_curve_measure_options, to_segments, ENGINE_BOOL),
    };
    bat_curve_measure_options options = bat_curve_measure_defaults();
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), NONE, &options, error);
    options.progress = ENGINE_PROGRESS;
    bat_curve_distance distance;
    if (status == BAT_OK)
        status =
            bat_curve_compare(&call->inputs[0]->set.curves[0], &call->inputs[1]->set.curves[0], &options, &distance, error);
    if (status != BAT_OK)
        return status;
    bat_measure measure;
    for (size_t i = 0; bat_curve_measures(2, i, &measure); i++)
        engine_measure(result->report, &measure, &distance);
    return BAT_OK;
}

/// The mask of the linear scheme that the option "scheme" names.
static bat_status mask_of(const engine_call *call, bat_mask *mask, bat_error *error)
{
    const char *name = NULL;
    bat_curve_scheme scheme = {.kind = BAT_CURVE_SCHEME_KIND_AUTO};
    bat_status status = engine_text(call->options, "scheme", &name, error);
    if (status == BAT_OK && name == NULL)
        return engine_fail(error, BAT_INVALID_ARGUMENT, "the option 'scheme' is missing", "");
    if (status == BAT_OK)
        status = bat_curve_scheme_by_name(name, &scheme, error);
    if (status == BAT_OK && scheme.kind != BAT_CURVE_SCHEME_KIND_LINEAR)
        return engine_fail(error, BAT_UNSUPPORTED, "'%' is not linear: it has no mask", name);
    *mask = scheme.mask;
    return status;
}

static json_t *weights(const double *values, size_t count, int first)
{
    return json_pack("{s:o,s:i}", "weights", engine_numbers(values, count), "first", first);
}

static bat_status analyze(const engine_call *call, engine_object *result, bat_error *error)
{
    static const engine_option OPTIONS[] = {
        ENGINE_OPTION(bat_mask_analyze_options, depth, ENGINE_SIZE),
        ENGINE_OPTION(bat_mask_analyze_options, tolerance, ENGINE_NUMBER),
        ENGINE_OPTION(bat_mask_analyze_options, vertices, ENGINE_SIZE),
    };
    bat_mask_analyze_options options = bat_mask_analyze_defaults();
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), SCHEME, &options, error);
    bat_mask mask;
    bat_analysis analysis;
    if (status == BAT_OK)
        status = mask_of(call, &mask, error);
    if (status == BAT_OK)
        status = bat_mask_analyze(&mask, &options, &analysis, error);
    if (status != BAT_OK)
        return status;
    json_t *report = result->report;
    engine_set(report, "mask", weights(analysis.mask.coefficients, analysis.mask.count, analysis.mask.first));
    engine_set(report, "quotient",
               weights(analysis.quotient.coefficients, analysis.quotient.count, analysis.quotient.first));
    engine_set(report, "multiplicity", engine_size(analysis.multiplicity));
    engine_set(report, "remainder", engine_number(analysis.remainder));
    engine_set(report, "is_interpolatory", json_boolean(analysis.is_interpolatory));
    engine_set(report, "is_symmetric", json_boolean(analysis.is_symmetric));
    engine_set(report, "shift", engine_number(analysis.shift));
    engine_set(report, "generation_degree", engine_size(analysis.generation_degree));
    engine_set(report, "reproduction_degree", engine_size(analysis.reproduction_degree));
    engine_set(report, "matrix_first", json_integer(analysis.matrix_first));
    engine_set(report, "matrix_size", engine_size(analysis.matrix_size));
    engine_set(report, "matrix", engine_numbers(analysis.matrix, analysis.matrix_size * analysis.matrix_size));
    json_t *values = json_array();
    for (size_t i = 0; i < analysis.eigenvalue_count; i++)
    {
        const bat_analysis_eigenvalue *value = &analysis.eigenvalues[i];
        (void)json_array_append_new(values, json_pack("{s:o,s:o,s:o,s:o}", "real", engine_number(value->real), "imaginary",
                                                      engine_number(value->imaginary), "multiplicity",
                                                      engine_size(value->multiplicity), "vector_count",
                                                      engine_size(value->vector_count)));
    }
    engine_set(report, "eigenvalues", values);
    engine_set(report, "converges", json_string(bat_choice_name(&bat_analysis_verdict_family, (int)analysis.converges)));
    engine_set(report, "limit", weights(analysis.limit.weights, analysis.limit.count, analysis.limit.first));
    engine_set(report, "tangent", weights(analysis.tangent.weights, analysis.tangent.count, analysis.tangent.first));
    engine_set(report, "vertex", weights(analysis.vertex.weights, analysis.vertex.count, analysis.vertex.first));
    engine_set(report, "radius_lower", engine_number(analysis.radius_lower));
    engine_set(report, "radius_upper", engine_number(analysis.radius_upper));
    engine_set(report, "product", json_string(analysis.product));
    engine_set(report, "depth", engine_size(analysis.depth));
    engine_set(report, "is_stable", json_boolean(analysis.is_stable));
    engine_set(report, "exponent_lower", engine_number(analysis.exponent_lower));
    engine_set(report, "exponent_upper", engine_number(analysis.exponent_upper));
    engine_set(report, "smooth_proven", json_integer(analysis.smooth_proven));
    engine_set(report, "smooth_disproven", json_integer(analysis.smooth_disproven));
    engine_set(report, "lipschitz", json_string(bat_choice_name(&bat_analysis_verdict_family, (int)analysis.lipschitz)));
    bat_analysis_free(&analysis);
    return BAT_OK;
}

static bat_status basis(const engine_call *call, engine_object *result, bat_error *error)
{
    struct
    {
        size_t level;
    } options = {7};
    static const engine_option OPTIONS[] = {{"level", 0, ENGINE_SIZE, NULL}};
    bat_status status = engine_options(call->options, OPTIONS, ENGINE_COUNT(OPTIONS), SCHEME, &options, error);
    bat_mask mask;
    bat_basis samples;
    if (status == BAT_OK && options.level > MAX_BASIS_LEVEL)
        return engine_fail(error, BAT_TOO_LARGE, "level must be at most 16", "");
    if (status == BAT_OK)
        status = mask_of(call, &mask, error);
    if (status == BAT_OK)
        status = bat_mask_basis(&mask, options.level, &samples, error);
    if (status != BAT_OK)
        return status;
    engine_set(result->report, "values", engine_array("f64", engine_own(result, samples.values), samples.count));
    engine_set(result->report, "level", engine_size(samples.level));
    engine_set(result->report, "first", json_integer(samples.first));
    engine_set(result->report, "last", json_integer(samples.last));
    return BAT_OK;
}

const engine_row ENGINE_CURVE_ROWS[] = {
    {"bat_curve_refine", refine_curves, {ENGINE_CURVES}, ENGINE_CURVES},
    {"bat_curve_map_refine", refine_map, {ENGINE_CURVES}, ENGINE_CURVES},
    {"bat_curve_read_memory", read_curves, {ENGINE_VALUES}, ENGINE_CURVES},
    {"bat_curve_write_memory", write_curves, {ENGINE_CURVES}, ENGINE_VALUES},
    {"bat_curve_fairness", measure_curves, {ENGINE_CURVES}, ENGINE_VALUES},
    {"bat_curve_is_simple", are_simple, {ENGINE_CURVES}, ENGINE_VALUES},
    {"bat_curve_exterior_angles", exterior_angles, {ENGINE_CURVES}, ENGINE_VALUES},
    {"bat_curve_edge_lengths", edge_lengths, {ENGINE_CURVES}, ENGINE_VALUES},
    {"bat_curve_compare", compare_curves, {ENGINE_CURVES, ENGINE_CURVES}, ENGINE_VALUES},
    {"bat_mask_analyze", analyze, {ENGINE_VALUES}, ENGINE_VALUES},
    {"bat_mask_basis", basis, {ENGINE_VALUES}, ENGINE_VALUES},
    {NULL, NULL, {ENGINE_VALUES}, ENGINE_VALUES},
};
