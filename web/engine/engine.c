#include "engine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <emscripten/emscripten.h>

/// Calls back into JavaScript. 0 stops the operation.
__attribute__((import_module("env"), import_name("engine_progress"))) extern int engine_progress(double fraction);

static bool report_progress(void *context, double fraction)
{
    (void)context;
    return engine_progress(fraction) != 0;
}

const bat_progress ENGINE_PROGRESS = {report_progress, NULL};

/// The failure of the last operation.
static bat_error failure;

/// The key of what reports have beside JSON. Texts of files are values of reports, never keys: no file can name it.
#define MARK ""

bat_status engine_fail(bat_error *error, bat_status status, const char *text, const char *name)
{
    *error = (bat_error){.status = status, .operand = BAT_NO_INDEX, .curve = BAT_NO_INDEX, .index = BAT_NO_INDEX};
    // The texts above are short; names may have any length.
    size_t used = 0;
    for (; *text != 0 && used + 1 < sizeof error->text; text++)
        if (text[0] == '%')
            for (const char *letter = name; *letter != 0 && used + 2 < sizeof error->text; letter++)
                error->text[used++] = *letter;
        else
            error->text[used++] = *text;
    error->text[used] = 0;
    return status;
}

json_t *engine_number(double value)
{
    if (isfinite(value))
        return json_real(value);
    return json_pack("{s:s}", MARK, isnan(value) ? "NaN" : value > 0 ? "Infinity" : "-Infinity");
}

json_t *engine_size(size_t value)
{
    return value == BAT_NO_INDEX ? json_null() : json_integer((json_int_t)value);
}

json_t *engine_array(const char *type, const void *data, size_t count)
{
    return data == NULL ? json_null() : json_pack("{s:[s,I,I]}", MARK, type, (json_int_t)(uintptr_t)data, (json_int_t)count);
}

json_t *engine_numbers(const double *values, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        (void)json_array_append_new(array, engine_number(values[i]));
    return array;
}

void engine_set(json_t *object, const char *name, json_t *value)
{
    (void)json_object_set_new_nocheck(object, name, value);
}

static json_t *measure_value(bat_measure_form form, const void *value)
{
    switch (form)
    {
    case BAT_MEASURE_FORM_COUNT:
        return engine_size(*(const size_t *)value);
    case BAT_MEASURE_FORM_SIGNED:
    case BAT_MEASURE_FORM_GENUS:
        return json_integer(*(const int64_t *)value);
    case BAT_MEASURE_FORM_FLAG:
        return json_boolean(*(const bool *)value);
    case BAT_MEASURE_FORM_POINT:
        return engine_numbers(value, 3);
    case BAT_MEASURE_FORM_NUMBER:
    case BAT_MEASURE_FORM_LENGTH:
        break;
    }
    return engine_number(*(const double *)value);
}

void engine_measure(json_t *object, const bat_measure *measure, const void *base)
{
    engine_set(object, measure->name, measure_value(measure->form, (const char *)base + measure->offset));
}

void *engine_own(engine_object *object, void *memory)
{
    if (object->array_count == ENGINE_ARRAYS)
        abort();
    return object->arrays[object->array_count++] = memory;
}

/// The tables of the library.
static const struct
{
    const char *name;
    const bat_family *family;
} FAMILIES[] = {
#if ENGINE_HAS_CURVES
    {"space", &bat_space_family},
    {"curve_scheme", &bat_curve_scheme_family},
    {"curve_end_rule", &bat_curve_end_rule_family},
    {"curve_simple", &bat_curve_simple_family},
    {"curve_map_topology", &bat_curve_map_topology_family},
    {"curve_map_edges", &bat_curve_map_edges_family},
    {"curve_map_join", &bat_curve_map_join_family},
    {"curve_format", &bat_curve_format_family},
    {"curve_model", &bat_curve_model_family},
    {"motion_scheme", &bat_motion_scheme_family},
    {"motion_ends", &bat_motion_ends_family},
    {"motion_shape", &bat_motion_shape_family},
#endif
    {"mesh_scheme", &bat_mesh_scheme_family},
    {"mesh_format", &bat_mesh_format_family},
    {"mesh_encoding", &bat_mesh_encoding_family},
    {"mesh_normals", &bat_mesh_normals_family},
    {"mesh_decimate_method", &bat_mesh_decimate_method_family},
    {"mesh_boundary", &bat_mesh_boundary_family},
    {"mesh_creasing", &bat_mesh_creasing_family},
    {"mesh_linear", &bat_mesh_linear_family},
#if ENGINE_HAS_SURFACES
    {"cloud_format", &bat_cloud_format_family},
    {"cloud_sides", &bat_cloud_sides_family},
    {"surface_parameters", &bat_surface_parameters_family},
    {"surface_smoothing", &bat_surface_smoothing_family},
    {"surface_format", &bat_surface_format_family},
    {"surface_unit", &bat_surface_unit_family},
#endif
};

/// Options as they are asked for by engine_signatures(); null in all other calls.
static json_t *described;

/// Append rows of options: name, type, and the name of the family of a choice.
static void describe(const engine_option *options, size_t count, const char *const *also)
{
    static const char *const TYPES[] = {"size", "int", "uint64", "number", "bool", "text", "choice"};
    for (size_t i = 0; i < count; i++)
    {
        const char *family = "";
        for (size_t k = 0; k < ENGINE_COUNT(FAMILIES); k++)
            if (FAMILIES[k].family == options[i].family)
                family = FAMILIES[k].name;
        (void)json_array_append_new(described, json_pack("[s,s,s]", options[i].name, TYPES[options[i].type], family));
    }
    for (; also != NULL && *also != NULL; also++)
        (void)json_array_append_new(described, json_pack("[s,s,s]", *also, "own", ""));
}

static bool is_listed(const char *const *names, const char *name)
{
    for (; names != NULL && *names != NULL; names++)
        if (strcmp(*names, name) == 0)
            return true;
    return false;
}

bat_status engine_choice(const bat_family *family, const char *name, void *value, bat_error *error)
{
    const bat_choice *choice;
    bat_status status = name != NULL ? bat_choice_find(family, name, &choice, error) : BAT_OK;
    if (status == BAT_OK && name != NULL)
        *(int *)value = choice->value;
    return status;
}

/// Whether a value stands for a number that is not finite.
static bool is_special(const json_t *value, double *number)
{
    const char *name = json_string_value(json_object_get(value, MARK));
    if (name == NULL)
        return false;
    *number = strcmp(name, "NaN") == 0 ? NAN : *name == '-' ? -INFINITY : INFINITY;
    return true;
}

static bat_status store(const engine_option *option, const json_t *value, void *target, bat_error *error)
{
    char *field = (char *)target + option->offset;
    double number = json_number_value(value);
    switch (option->type)
    {
    case ENGINE_BOOL:
        if (!json_is_boolean(value))
            return engine_fail(error, BAT_INVALID_ARGUMENT, "% must be true or false", option->name);
        *(bool *)field = json_is_true(value);
        return BAT_OK;
    case ENGINE_TEXT:
    case ENGINE_CHOICE:
        if (!json_is_string(value))
            return engine_fail(error, BAT_INVALID_ARGUMENT, "% must be a text", option->name);
        if (option->type == ENGINE_CHOICE)
            return engine_choice(option->family, json_string_value(value), field, error);
        *(const char **)(void *)field = json_string_value(value);
        return BAT_OK;
    case ENGINE_NUMBER:
        if (!json_is_number(value) && !is_special(value, &number))
            return engine_fail(error, BAT_INVALID_ARGUMENT, "% must be a number", option->name);
        *(double *)(void *)field = number;
        return BAT_OK;
    case ENGINE_SIZE:
    case ENGINE_INT:
    case ENGINE_UINT64:
    default:
        break;
    }
    double low = option->type == ENGINE_INT ? -0x1p31 : 0;
    double high = option->type == ENGINE_INT ? 0x1p31 - 1 : option->type == ENGINE_SIZE ? 0x1p32 - 1 : 0x1p53;
    if (!json_is_number(value) || !(number >= low && number <= high) || number != floor(number))
        return engine_fail(error, BAT_INVALID_ARGUMENT, "% must be a whole number in its range", option->name);
    if (option->type == ENGINE_INT)
        *(int *)(void *)field = (int)number;
    else if (option->type == ENGINE_SIZE)
        *(size_t *)(void *)field = (size_t)number;
    else
        *(uint64_t *)(void *)field = (uint64_t)number;
    return BAT_OK;
}

bat_status engine_options(const json_t *json, const engine_option *options, size_t count, const char *const *also,
                          void *target, bat_error *error)
{
    if (described != NULL)
    {
        describe(options, count, also);
        return BAT_CANCELLED;
    }
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)json, name, value)
    {
        if (is_listed(also, name))
            continue;
        const engine_option *option = NULL;
        for (size_t i = 0; i < count; i++)
            if (strcmp(options[i].name, name) == 0)
                option = &options[i];
        if (option == NULL)
            return engine_fail(error, BAT_INVALID_ARGUMENT, "there is no option '%'", name);
        bat_status status = store(option, value, target, error);
        if (status != BAT_OK)
            return status;
    }
    return BAT_OK;
}

bat_status engine_no_options(const json_t *json, const char *const *also, bat_error *error)
{
    return engine_options(json, NULL, 0, also, NULL, error);
}

bat_status engine_text(const json_t *json, const char *name, const char **text, bat_error *error)
{
    const json_t *value = json_object_get(json, name);
    *text = json_string_value(value);
    if (value != NULL && *text == NULL)
        return engine_fail(error, BAT_INVALID_ARGUMENT, "% must be a text", name);
    return BAT_OK;
}

// Called by JavaScript.

EMSCRIPTEN_KEEPALIVE void *engine_allocate(size_t size)
{
    return malloc(size > 0 ? size : 1);
}

EMSCRIPTEN_KEEPALIVE void engine_release(void *memory)
{
    free(memory);
}

/// Hand over what was written to standard output.
EMSCRIPTEN_KEEPALIVE void engine_flush(void)
{
    (void)fflush(stdout);
}

/// The failure of the last operation that gave no object, as JSON; release it with engine_release().
EMSCRIPTEN_KEEPALIVE char *engine_failure(void)
{
    json_t *json = json_pack("{s:i,s:s}", "status", (int)failure.status, "name", bat_status_name(failure.status));
    engine_set(json, "index", engine_size(failure.index));
    engine_set(json, "line", engine_size(failure.line));
    engine_set(json, "text", json_string(failure.text));
    engine_set(json, "option", json_string(failure.option));
    engine_set(json, "remedy", json_string(failure.remedy));
    engine_set(json, "effect", json_string(failure.remedy_effect));
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return text;
}

EMSCRIPTEN_KEEPALIVE void engine_free(engine_object *object)
{
    if (object == NULL)
        return;
    bat_curve_set_free(&object->set);
    bat_mesh_free(&object->mesh);
#if ENGINE_HAS_SURFACES
    bat_cloud_free(&object->cloud);
    bat_surface_result_free(&object->surface);
    bat_shell_free(&object->shell);
#endif
    for (size_t i = 0; i < object->array_count; i++)
        free(object->arrays[i]);
    json_decref(object->report);
    free(object->text);
    free(object);
}

static void report_curves(engine_object *object)
{
    json_t *curves = json_array();
    const bat_curve_set *set = &object->set;
    for (size_t i = 0; i < set->count; i++)
    {
        const bat_curve *curve = &set->curves[i];
        json_t *row = json_object();
        engine_set(row, "points", engine_array("f64", curve->points, curve->count * set->space->point_dim));
        engine_set(row, "closed", json_boolean(curve->closed));
        if (curve->channels != NULL)
            engine_set(row, "channels", engine_array("f64", curve->channels, curve->count * curve->channel_count));
        if (curve->corners != NULL)
            engine_set(row, "corners", engine_array("u8", curve->corners, curve->count));
        (void)json_array_append_new(curves, row);
    }
    engine_set(object->report, "curves", curves);
    engine_set(object->report, "space", json_string(set->space->name));
    engine_set(object->report, "point_dim", engine_size(set->space->point_dim));
    json_t *notes = json_array();
    const char *note;
    for (size_t i = 0; set->attributes != NULL && (note = bat_curve_set_note(set, i)) != NULL; i++)
        (void)json_array_append_new(notes, json_string(note));
    engine_set(object->report, "notes", notes);
}

static json_t *text_or_null(const char *text)
{
    return text != NULL ? json_string(text) : json_null();
}

/// The offsets of triangles. A result of an operation for polygons always has some.
static uint32_t *offsets_of_triangles(const bat_mesh *mesh)
{
    uint32_t *offsets = malloc((mesh->face_count + 1) * sizeof *offsets);
    if (offsets == NULL)
        abort();
    for (size_t f = 0; f <= mesh->face_count; f++)
        offsets[f] = (uint32_t)(3 * f);
    return offsets;
}

void engine_set_mesh(json_t *report, bat_mesh *mesh, bool polygons)
{
    if (polygons && mesh->offsets == NULL)
        mesh->offsets = offsets_of_triangles(mesh);
    const uint32_t *offsets = mesh->offsets;
    size_t corner_count = offsets != NULL ? offsets[mesh->face_count] : 3 * mesh->face_count;
    engine_set(report, "positions", engine_array("f64", mesh->positions, 3 * mesh->vertex_count));
    if (polygons)
        engine_set(report, "offsets", engine_array("u32", offsets, mesh->face_count + 1));
    engine_set(report, "faces", engine_array("u32", mesh->faces, corner_count));
    engine_set(report, "texture", engine_array("f64", mesh->texture, 2 * mesh->texture_count));
    engine_set(report, "texture_faces", engine_array("u32", mesh->texture_faces, corner_count));
    engine_set(report, "channels", engine_array("f64", mesh->channels, mesh->channel_count * mesh->vertex_count));
    json_t *names = json_array(), *creases = json_array(), *corners = json_array();
    for (size_t i = 0; i < mesh->channel_count; i++)
        (void)json_array_append_new(names, json_string(mesh->channel_names[i]));
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        const bat_mesh_crease *crease = &mesh->creases[i];
        (void)json_array_append_new(creases,
                                    json_pack("[I,I,f]", (json_int_t)crease->a, (json_int_t)crease->b, crease->sharpness));
    }
    for (size_t i = 0; i < mesh->corner_count; i++)
        (void)json_array_append_new(corners,
                                    json_pack("[I,f]", (json_int_t)mesh->corners[i].vertex, mesh->corners[i].sharpness));
    engine_set(report, "face_labels", engine_array("u32", mesh->face_labels, mesh->face_count));
    json_t *labels = json_array();
    for (size_t i = 0; i < mesh->label_count; i++)
    {
        const bat_mesh_label *label = &mesh->labels[i];
        (void)json_array_append_new(labels,
                                    json_pack("{s:s?,s:s?,s:s?,s:s?}", "object", label->object, "group", label->group,
                                              "material", label->material, "smoothing", label->smoothing));
    }
    engine_set(report, "labels", labels);
    engine_set(report, "material_files", text_or_null(mesh->material_files));
    engine_set(report, "material_json", text_or_null(mesh->material_json));
    engine_set(report, "channel_names", names);
    engine_set(report, "creases", creases);
    engine_set(report, "corners", corners);
    engine_set(report, "rules",
               json_pack("{s:s,s:s,s:s}", "boundary", bat_choice_name(&bat_mesh_boundary_family, (int)mesh->rules.boundary),
                         "creasing", bat_choice_name(&bat_mesh_creasing_family, (int)mesh->rules.creasing), "linear",
                         bat_choice_name(&bat_mesh_linear_family, (int)mesh->rules.linear)));
}

/// The report of an object as JSON; it lives as long as the object.
EMSCRIPTEN_KEEPALIVE const char *engine_report(engine_object *object)
{
    if (object->text == NULL)
    {
        if (object->kind == ENGINE_CURVES)
            report_curves(object);
        else if (object->kind == ENGINE_MESH || object->kind == ENGINE_POLYGONS)
            engine_set_mesh(object->report, &object->mesh, object->kind == ENGINE_POLYGONS);
        else if (object->kind == ENGINE_CLOUD)
            engine_set_cloud(object->report, &object->cloud);
        object->text = json_dumps(object->report, JSON_COMPACT);
    }
    return object->text;
}

static engine_object *new_object(engine_kind kind)
{
    engine_object *object = calloc(1, sizeof *object);
    if (object == NULL)
        return NULL;
    object->kind = kind;
    object->report = json_object();
    return object;
}

static const engine_row *const TABLES[] = {
#if ENGINE_HAS_CURVES
    ENGINE_CURVE_ROWS,
    ENGINE_MOTION_ROWS,
#endif
#if ENGINE_HAS_MESHES
    ENGINE_MESH_ROWS,
#endif
#if ENGINE_HAS_SURFACES
    ENGINE_SURFACE_ROWS,
#endif
};

static const engine_row *find(const char *name)
{
    for (size_t i = 0; i < ENGINE_COUNT(TABLES); i++)
        for (const engine_row *row = TABLES[i]; row->name != NULL; row++)
            if (strcmp(row->name, name) == 0)
                return row;
    return NULL;
}

/// Run an operation.
/// @param options a JSON object; null for none
/// @return the result, for engine_free(); null on failure, which engine_failure() tells
EMSCRIPTEN_KEEPALIVE engine_object *engine_run(const char *name, const char *options, engine_object *first,
                                               engine_object *second, const void *bytes, size_t size)
{
    failure = (bat_error){.status = BAT_OK, .index = BAT_NO_INDEX};
    engine_call call = {.inputs = {first, second}, .bytes = bytes, .size = size};
    const engine_row *row = find(name);
    if (row == NULL)
    {
        (void)engine_fail(&failure, BAT_INVALID_ARGUMENT, "there is no operation '%'", name);
        return NULL;
    }
    for (size_t i = 0; i < ENGINE_INPUTS; i++)
        if (row->inputs[i] != ENGINE_VALUES && (call.inputs[i] == NULL || call.inputs[i]->kind != row->inputs[i]))
        {
            bool cut = row->inputs[i] == ENGINE_MESH && call.inputs[i] != NULL && call.inputs[i]->kind == ENGINE_POLYGONS;
            const char *text =
                cut ? "% takes triangles; bat_polygon_mesh_triangulate() cuts polygons into them" : "% needs another input";
            (void)engine_fail(&failure, BAT_INVALID_ARGUMENT, text, name);
            return NULL;
        }
    json_t *json = options != NULL ? json_loads(options, JSON_REJECT_DUPLICATES, NULL) : json_object();
    engine_object *result = new_object(row->result);
    bat_status status = BAT_OK;
    if (result == NULL)
        status = engine_fail(&failure, BAT_NO_MEMORY, "memory is used up", "");
    else if (!json_is_object(json))
        status = engine_fail(&failure, BAT_INVALID_ARGUMENT, "the options of % are no JSON object", name);
    else
    {
        call.options = json;
        status = row->run(&call, result, &failure);
    }
    json_decref(json);
    if (status == BAT_OK)
        return result;
    engine_free(result);
    return NULL;
}

/// Make curves of arrays. The arrays are copied.
/// @param layout JSON: the name of the space, its `point_dim`, `channel_count`, and lists `counts` and `closed`
EMSCRIPTEN_KEEPALIVE engine_object *engine_curves(const char *layout, const double *points, const double *channels,
                                                  const unsigned char *corners)
{
    failure = (bat_error){.status = BAT_OK, .index = BAT_NO_INDEX};
    json_t *json = json_loads(layout, 0, NULL);
    const char *name = json_string_value(json_object_get(json, "space"));
    bat_space space;
    bat_status status = bat_space_by_name(name != NULL ? name : "plane",
                                          (size_t)json_integer_value(json_object_get(json, "point_dim")), &space, &failure);
    const json_t *counts = json_object_get(json, "counts"), *closed = json_object_get(json, "closed");
    size_t count = json_array_size(counts),
           channel_count = (size_t)json_integer_value(json_object_get(json, "channel_count"));
    if (status == BAT_OK && count == 0)
        status = engine_fail(&failure, BAT_INVALID_ARGUMENT, "there is no curve", "");
    engine_object *object = status == BAT_OK ? new_object(ENGINE_CURVES) : NULL;
    bat_curve *curves = object != NULL ? calloc(count, sizeof *curves) : NULL;
    bool complete = curves != NULL;
    for (size_t i = 0; i < count && complete; i++)
    {
        size_t rows = (size_t)json_integer_value(json_array_get(counts, i)), numbers = rows * space.point_dim;
        curves[i] = (bat_curve){.space = &space,
                                .points = malloc((numbers + 1) * sizeof(double)),
                                .count = rows,
                                .closed = json_is_true(json_array_get(closed, i)),
                                .channels = channels != NULL ? malloc((rows * channel_count + 1) * sizeof(double)) : NULL,
                                .channel_count = channels != NULL ? channel_count : 0,
                                .corners = corners != NULL ? malloc(rows + 1) : NULL};
        complete = curves[i].points != NULL && (channels == NULL || curves[i].channels != NULL) &&
                   (corners == NULL || curves[i].corners != NULL);
        if (!complete)
            break;
        memcpy(curves[i].points, points, numbers * sizeof *points);
        points += numbers;
        if (channels != NULL)
        {
            memcpy(curves[i].channels, channels, rows * channel_count * sizeof *channels);
            channels += rows * channel_count;
        }
        if (corners != NULL)
        {
            memcpy(curves[i].corners, corners, rows);
            corners += rows;
        }
    }
    json_decref(json);
    if (complete)
    {
        status = bat_curve_set_take(curves, count, &object->set, &failure);
        if (status == BAT_OK)
            return object;
    }
    else if (status == BAT_OK)
        (void)engine_fail(&failure, BAT_NO_MEMORY, "memory is used up", "");
    for (size_t i = 0; curves != NULL && i < count; i++)
        bat_curve_free(&curves[i]);
    free(curves);
    engine_free(object);
    return NULL;
}

/// Take an array of a layout, which is [address, count of numbers]; null where the layout has none.
static void *take(const json_t *layout, const char *name, size_t *count)
{
    const json_t *array = json_object_get(layout, name);
    *count = (size_t)json_integer_value(json_array_get(array, 1));
    return (void *)(uintptr_t)json_integer_value(json_array_get(array, 0));
}

/// A copy of a text; null for none. False without memory.
static bool copy_text(const json_t *text, char **copy)
{
    *copy = json_is_string(text) ? strdup(json_string_value(text)) : NULL;
    return *copy != NULL || !json_is_string(text);
}

static bool take_texts(const json_t *layout, bat_mesh *mesh)
{
    const json_t *names = json_object_get(layout, "channel_names"), *labels = json_object_get(layout, "labels");
    bool complete = copy_text(json_object_get(layout, "material_files"), &mesh->material_files) &&
                    copy_text(json_object_get(layout, "material_json"), &mesh->material_json);
    mesh->channel_names = mesh->channel_count > 0 ? calloc(mesh->channel_count, sizeof *mesh->channel_names) : NULL;
    for (size_t i = 0; i < mesh->channel_count && mesh->channel_names != NULL && complete; i++)
        complete = copy_text(json_array_get(names, i), &mesh->channel_names[i]);
    mesh->label_count = json_array_size(labels);
    mesh->labels = mesh->label_count > 0 ? calloc(mesh->label_count, sizeof *mesh->labels) : NULL;
    for (size_t i = 0; i < mesh->label_count && mesh->labels != NULL && complete; i++)
    {
        const json_t *row = json_array_get(labels, i);
        bat_mesh_label *label = &mesh->labels[i];
        complete = copy_text(json_object_get(row, "object"), &label->object) &&
                   copy_text(json_object_get(row, "group"), &label->group) &&
                   copy_text(json_object_get(row, "material"), &label->material) &&
                   copy_text(json_object_get(row, "smoothing"), &label->smoothing);
    }
    return complete && (mesh->channel_names != NULL || mesh->channel_count == 0) &&
           (mesh->labels != NULL || mesh->label_count == 0);
}

static bool take_sharpness(const json_t *layout, bat_mesh *mesh)
{
    const json_t *creases = json_object_get(layout, "creases"), *corners = json_object_get(layout, "corners");
    mesh->crease_count = json_array_size(creases);
    mesh->corner_count = json_array_size(corners);
    mesh->creases = malloc((mesh->crease_count + 1) * sizeof *mesh->creases);
    mesh->corners = malloc((mesh->corner_count + 1) * sizeof *mesh->corners);
    if (mesh->creases == NULL || mesh->corners == NULL)
        return false;
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        const json_t *row = json_array_get(creases, i);
        mesh->creases[i] = (bat_mesh_crease){(uint32_t)json_integer_value(json_array_get(row, 0)),
                                             (uint32_t)json_integer_value(json_array_get(row, 1)),
                                             json_number_value(json_array_get(row, 2))};
    }
    for (size_t i = 0; i < mesh->corner_count; i++)
    {
        const json_t *row = json_array_get(corners, i);
        mesh->corners[i] = (bat_mesh_corner){(uint32_t)json_integer_value(json_array_get(row, 0)),
                                             json_number_value(json_array_get(row, 1))};
    }
    return true;
}

/// The rules of a layout: names; "auto" for those that it has not.
static bat_status take_rules(const json_t *layout, bat_mesh_rules *rules)
{
    const json_t *given = json_object_get(layout, "rules");
    const char *boundary = json_string_value(json_object_get(given, "boundary"));
    const char *creasing = json_string_value(json_object_get(given, "creasing"));
    const char *linear = json_string_value(json_object_get(given, "linear"));
    bat_status status = engine_choice(&bat_mesh_boundary_family, boundary, &rules->boundary, &failure);
    if (status == BAT_OK)
        status = engine_choice(&bat_mesh_creasing_family, creasing, &rules->creasing, &failure);
    if (status == BAT_OK)
        status = engine_choice(&bat_mesh_linear_family, linear, &rules->linear, &failure);
    return status;
}

/// Make a mesh: of polygons where there are `offsets`, else of triangles.
/// @param layout JSON with the fields of bat_mesh: texts, names of `rules`, rows of `creases`, `corners` and
///               `labels`, and arrays as [address, count of numbers] of engine_allocate(), which the mesh takes, also on
///               failure
EMSCRIPTEN_KEEPALIVE engine_object *engine_mesh(const char *layout)
{
    failure = (bat_error){.status = BAT_OK, .index = BAT_NO_INDEX};
    json_t *json = json_loads(layout, 0, NULL);
    engine_object *object = new_object(ENGINE_MESH);
    if (object == NULL)
        abort(); // nothing owns the arrays
    bat_mesh *mesh = &object->mesh;
    size_t positions, corners, offset_count, texture, texture_corners, channels, labels;
    *mesh = (bat_mesh){.positions = take(json, "positions", &positions),
                       .faces = take(json, "faces", &corners),
                       .offsets = take(json, "offsets", &offset_count),
                       .texture = take(json, "texture", &texture),
                       .texture_faces = take(json, "texture_faces", &texture_corners),
                       .channels = take(json, "channels", &channels),
                       .face_labels = take(json, "face_labels", &labels)};
    const uint32_t *offsets = mesh->offsets;
    mesh->vertex_count = positions / 3;
    mesh->face_count = offsets != NULL ? offset_count - 1 : corners / 3;
    mesh->texture_count = texture / 2;
    mesh->channel_count = json_array_size(json_object_get(json, "channel_names"));
    const char *fault = NULL;
    if (positions % 3 != 0 || (offsets == NULL && corners % 3 != 0) || texture % 2 != 0)
        fault = "positions and faces come in threes, texture in pairs";
    else if (offsets != NULL && offsets[mesh->face_count] != corners)
        fault = "the last number of offsets must be that of all corners";
    else if (mesh->texture_faces != NULL && texture_corners != corners)
        fault = "texture_faces must have as many numbers as faces";
    else if (channels != mesh->channel_count * mesh->vertex_count)
        fault = "channels need a number for each name at each vertex";
    else if (mesh->face_labels != NULL && labels != mesh->face_count)
        fault = "face_labels need a number for each face";
    bat_status status =
        fault != NULL ? engine_fail(&failure, BAT_INVALID_ARGUMENT, fault, "") : take_rules(json, &mesh->rules);
    if (!take_texts(json, mesh) || !take_sharpness(json, mesh))
        status = engine_fail(&failure, BAT_NO_MEMORY, "memory is used up", "");
    json_decref(json);
    if (offsets != NULL)
        object->kind = ENGINE_POLYGONS;
    if (status == BAT_OK)
        return object;
    engine_free(object);
    return NULL;
}

void engine_set_cloud(json_t *report, const bat_cloud *cloud)
{
    engine_set(report, "points", engine_array("f64", cloud->points, 3 * cloud->count));
    engine_set(report, "boundary_count", engine_size(cloud->boundary_count));
    json_t *corners = json_null();
    if (cloud->has_corners)
        corners = json_pack("[I,I,I,I]", (json_int_t)cloud->corners[0], (json_int_t)cloud->corners[1],
                            (json_int_t)cloud->corners[2], (json_int_t)cloud->corners[3]);
    engine_set(report, "corners", corners);
    engine_set(report, "triangles", engine_array("u32", cloud->triangles, 3 * cloud->triangle_count));
    engine_set(report, "duplicates", engine_size(cloud->duplicates));
}

/// Make a cloud.
/// @param layout JSON with `points` and `triangles` as engine_mesh() takes them, `boundary_count`, and `corners`, a list of
///               four indices
EMSCRIPTEN_KEEPALIVE engine_object *engine_cloud(const char *layout)
{
    failure = (bat_error){.status = BAT_OK, .index = BAT_NO_INDEX};
    json_t *json = json_loads(layout, 0, NULL);
    engine_object *object = new_object(ENGINE_CLOUD);
    if (object == NULL)
        abort(); // nothing owns the arrays
    bat_cloud *cloud = &object->cloud;
    size_t numbers, indices;
    cloud->points = take(json, "points", &numbers);
    cloud->triangles = take(json, "triangles", &indices);
    cloud->count = numbers / 3;
    cloud->triangle_count = indices / 3;
    cloud->boundary_count = (size_t)json_integer_value(json_object_get(json, "boundary_count"));
    const json_t *corners = json_object_get(json, "corners");
    cloud->has_corners = json_array_size(corners) == 4;
    for (size_t k = 0; k < 4 && cloud->has_corners; k++)
        cloud->corners[k] = (size_t)json_integer_value(json_array_get(corners, k));
    bat_status status = BAT_OK;
    if (numbers % 3 != 0 || indices % 3 != 0 || (json_array_size(corners) != 0 && !cloud->has_corners))
        status = engine_fail(&failure, BAT_INVALID_ARGUMENT, "points and triangles come in threes, corners are four", "");
    json_decref(json);
    if (status == BAT_OK)
        return object;
    engine_free(object);
    return NULL;
}

static json_t *family_rows(const bat_family *family)
{
    json_t *rows = json_array();
    const bat_choice *choice;
    for (size_t i = 0; (choice = bat_choices(family, i)) != NULL; i++)
        (void)json_array_append_new(rows,
                                    json_pack("{s:s,s:s,s:s,s:s,s:b,s:b}", "name", choice->name, "settings",
                                              choice->settings != NULL ? choice->settings : "", "summary", choice->summary,
                                              "endings", choice->endings != NULL ? choice->endings : "", "reads",
                                              choice->reads, "writes", choice->writes));
    return rows;
}

/// The tables of the library as a JSON object, by the names of their families: "curve_scheme" for bat_curve_scheme_family.
/// Release it with engine_release().
EMSCRIPTEN_KEEPALIVE char *engine_families(void)
{
    json_t *all = json_object();
    for (size_t i = 0; i < ENGINE_COUNT(FAMILIES); i++)
        engine_set(all, FAMILIES[i].name, family_rows(FAMILIES[i].family));
    char *text = json_dumps(all, JSON_COMPACT);
    json_decref(all);
    return text;
}

static json_t *measure_rows(bool (*walk)(size_t operands, size_t index, bat_measure *measure), size_t operands)
{
    static const char *const FORMS[] = {"number", "number", "point", "count", "number", "number", "flag"};
    json_t *rows = json_array();
    bat_measure measure;
    for (size_t i = 0; walk(operands, i, &measure); i++)
        (void)json_array_append_new(rows, json_pack("[s,s,s]", measure.name, FORMS[measure.form], measure.title));
    return rows;
}

/// The options of each operation and the names of all measures, as JSON, for the declarations of types. Release it with
/// engine_release().
EMSCRIPTEN_KEEPALIVE char *engine_signatures(void)
{
    bat_space plane = bat_euclidean(2);
    bat_curve curve = {.space = &plane};
    engine_object input = {.set = {.space = &plane, .curves = &curve}};
    const engine_call call = {.inputs = {&input, &input}};
    json_t *operations = json_object();
    for (size_t i = 0; i < ENGINE_COUNT(TABLES); i++)
        for (const engine_row *row = TABLES[i]; row->name != NULL; row++)
        {
            described = json_array();
            engine_object *result = new_object(row->result);
            (void)row->run(&call, result, &failure);
            engine_free(result);
            engine_set(operations, row->name, described);
        }
    described = NULL;
    // Families that take "auto", which some lists leave out.
    json_t *automatic = json_array();
    const bat_choice *choice;
    for (size_t i = 0; i < ENGINE_COUNT(FAMILIES); i++)
        if (bat_choice_find(FAMILIES[i].family, "auto", &choice, NULL) == BAT_OK)
            (void)json_array_append_new(automatic, json_string(FAMILIES[i].name));
    json_t *all =
        json_pack("{s:o,s:o,s:o,s:o,s:o,s:o}", "operations", operations, "automatic", automatic, "fairness",
                  measure_rows(bat_curve_measures, 1), "curve_distance", measure_rows(bat_curve_measures, 2), "mesh_summary",
                  measure_rows(bat_mesh_measures, 1), "mesh_distance", measure_rows(bat_mesh_measures, 2));
    char *text = json_dumps(all, JSON_COMPACT);
    json_decref(all);
    return text;
}

EMSCRIPTEN_KEEPALIVE const char *engine_version(void)
{
    return bat_version();
}
