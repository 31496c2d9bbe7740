#include "base/json_scan.h"
#include "io/surface/formats.h"
#include "surface/spline/hierarchical_space.h"
#include "surface/spline/tensor_surface.h"

#include <inttypes.h>
#include <math.h>

/// @file
/// The JSON format of spline surfaces: degrees, spans, boxes of refined cells, functions and control points.

typedef struct json_file
{
    const file_text *text;
    json_t *root;
    bat_error *error;
} json_file;

/// The position before the value of a member of the file; the end of the text when it is not found.
static json_scanner before_value(const json_file *file, const char *member)
{
    json_scanner scan = {file->text->data, file->text->data + file->text->size}, key;
    (void)json_scan_take(&scan, '{');
    while (json_scan_key(&scan, &key))
    {
        json_scan_blanks(&scan);
        if (json_scan_is(&key, member))
            return scan;
        if (!json_scan_value(&scan) || !json_scan_take(&scan, ','))
            break;
    }
    scan.at = scan.end;
    return scan;
}

/// Skip an element of an array, up to the next one.
static void next_element(json_scanner *scan)
{
    if (json_scan_value(scan) && json_scan_take(scan, ','))
        json_scan_blanks(scan);
}

/// The line of a member of the file or of one of its elements; 0 when it is not found.
static size_t line_of(const json_file *file, const char *member, size_t element)
{
    json_scanner scan = before_value(file, member);
    if (element != BAT_NO_INDEX && json_scan_take(&scan, '['))
    {
        json_scan_blanks(&scan);
        for (size_t i = 0; i < element; i++)
            next_element(&scan);
    }
    return scan.at < scan.end ? 1 + json_scan_newlines(file->text->data, scan.at) : 0;
}

static bat_status bad_member(const json_file *file, const char *member, const char *what)
{
    return ERROR_FILE(file->error, line_of(file, member, BAT_NO_INDEX), "\"%s\" %s", member, what);
}

static bat_status bad_element(const json_file *file, const char *member, size_t element, const char *what)
{
    return error_set(file->error, BAT_BAD_FILE, element, line_of(file, member, element), "element %zu of \"%s\" %s", element,
                     member, what);
}

/// Read an integer from 0 to `max_value`.
static bool whole(const json_t *value, uint64_t max_value, uint64_t *number)
{
    json_int_t integer = json_integer_value(value);
    *number = (uint64_t)integer;
    return json_is_integer(value) && integer >= 0 && *number <= max_value;
}

static bool whole_row(const json_t *row, size_t count, uint64_t *numbers)
{
    bool right = json_is_array(row) && json_array_size(row) == count;
    for (size_t i = 0; i < count && right; i++)
        right = whole(json_array_get(row, i), UINT32_MAX, &numbers[i]);
    return right;
}

static bat_status check_format(const json_file *file)
{
    const char *format = json_string_value(json_object_get(file->root, "format"));
    uint64_t version;
    if (format == NULL || strcmp(format, "batten surface") != 0)
        return bad_member(file, "format", "is not \"batten surface\"");
    if (!whole(json_object_get(file->root, "version"), UINT32_MAX, &version) || version != 1)
        return ERROR_UNSUPPORTED(file->error, line_of(file, "version", BAT_NO_INDEX), "only \"version\" 1 is read");
    return BAT_OK;
}

static bat_status read_options(const json_file *file, bat_hierarchical_options *options)
{
    uint64_t degree[2], spans[2], admissible = 0;
    *options = bat_hierarchical_defaults();
    if (!whole_row(json_object_get(file->root, "degree"), 2, degree) || degree[0] < 1 || degree[1] < 1 ||
        degree[0] > BAT_SPLINE_MAX_DEGREE || degree[1] > BAT_SPLINE_MAX_DEGREE)
        return bad_member(file, "degree", "is not two whole numbers of 1 to 15");
    if (!whole_row(json_object_get(file->root, "spans"), 2, spans) || spans[0] < 1 || spans[1] < 1)
        return bad_member(file, "spans", "is not two whole numbers of at least 1");
    const json_t *truncated = json_object_get(file->root, "truncated");
    if (truncated != NULL && !json_is_boolean(truncated))
        return bad_member(file, "truncated", "is neither true nor false");
    const json_t *class = json_object_get(file->root, "admissible");
    if (class != NULL && (!whole(class, BAT_HIERARCHICAL_MAX_LEVELS, &admissible) || admissible == 1))
        return bad_member(file, "admissible", "is neither 0 nor a whole number of 2 to 20");
    for (int d = 0; d < 2; d++)
    {
        options->degree[d] = (int)degree[d];
        options->spans[d] = (size_t)spans[d];
    }
    options->truncated = truncated == NULL || json_is_true(truncated);
    options->admissible = (int)admissible;
    return BAT_OK;
}

static bat_status read_boxes(const json_file *file, surface_box **boxes, size_t *count)
{
    const json_t *rows = json_object_get(file->root, "boxes");
    if (!json_is_array(rows))
        return bad_member(file, "boxes", "is not an array");
    *count = json_array_size(rows);
    if (array_make(boxes, *count, sizeof **boxes, file->error) != BAT_OK)
        return BAT_NO_MEMORY;
    json_scanner scan = before_value(file, "boxes");
    const char *counted = file->text->data;
    size_t line = 1;
    (void)json_scan_take(&scan, '[');
    json_scan_blanks(&scan);
    for (size_t i = 0; i < *count; i++)
    {
        uint64_t numbers[5];
        line += json_scan_newlines(counted, scan.at);
        counted = scan.at;
        next_element(&scan);
        if (!whole_row(json_array_get(rows, i), 5, numbers))
            return bad_element(file, "boxes", i, "is not five whole numbers: level, low u and v, high u and v");
        (*boxes)[i] = (surface_box){numbers[0], {numbers[1], numbers[2]}, {numbers[3], numbers[4]}, line};
    }
    return BAT_OK;
}

static bat_status read_point(const json_file *file, size_t index, size_t dimension, double *point)
{
    const json_t *row = json_array_get(json_object_get(file->root, "control"), index);
    if (!json_is_array(row) || json_array_size(row) != dimension)
        return bad_element(file, "control", index, "does not have as many coordinates as \"dimension\" says");
    for (size_t c = 0; c < dimension; c++)
    {
        const json_t *number = json_array_get(row, c);
        if (!json_is_number(number))
            return bad_element(file, "control", index, "contains something that is not a number");
        point[c] = json_number_value(number);
    }
    return BAT_OK;
}

/// Find the function of each row of "control"; `places` receives their numbers.
static bat_status read_places(const json_file *file, const bat_hierarchical_space *space, size_t *places)
{
    size_t count = bat_hierarchical_space_functions(space);
    const json_t *rows = json_object_get(file->root, "functions");
    if (rows != NULL && json_array_size(rows) != count)
        return bad_member(file, "functions", "is not an array of as many functions as there are control points");
    bool *taken;
    bat_status status = array_zeros(&taken, count, sizeof *taken, file->error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        uint64_t numbers[3];
        places[i] = i;
        if (rows == NULL)
            continue;
        if (!whole_row(json_array_get(rows, i), 3, numbers))
            status = bad_element(file, "functions", i, "is not three whole numbers: level, i, j");
        else
        {
            const bat_spline_function function = {(uint32_t)numbers[0], (uint32_t)numbers[1], (uint32_t)numbers[2]};
            places[i] = hierarchical_space_find(space, function);
            if (places[i] == BAT_NO_INDEX || taken[places[i]])
                status = bad_element(file, "functions", i, "is not in the basis or occurs twice");
            else
                taken[places[i]] = true;
        }
    }
    free(taken);
    return status;
}

static bat_status read_control(const json_file *file, bat_spline_surface *surface)
{
    size_t count = bat_hierarchical_space_functions(surface->space), numbers;
    if (size_multiply_overflows(count, surface->dimension, &numbers))
        return bad_member(file, "dimension", "is too large");
    size_t *places = memory_array(count, sizeof *places);
    surface->control = memory_array(numbers, sizeof *surface->control);
    bat_status status = BAT_OK;
    if (places == NULL || surface->control == NULL)
        status = error_memory(file->error, numbers * sizeof *surface->control);
    if (status == BAT_OK)
        status = read_places(file, surface->space, places);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        status = read_point(file, i, surface->dimension, surface->control + places[i] * surface->dimension);
    free(places);
    return status;
}

static bool read_numbers(const json_t *array, size_t count, double *numbers)
{
    bool good = json_is_array(array) && json_array_size(array) == count;
    for (size_t i = 0; i < count && good; i++)
    {
        good = json_is_number(json_array_get(array, i));
        numbers[i] = good ? json_number_value(json_array_get(array, i)) : 0;
    }
    return good;
}

/// Read a trimming curve. `good` is false for anything that is no curve.
static bat_status read_curve(const json_file *file, const json_t *object, bat_spline_curve *piece, bool *good)
{
    uint64_t degree;
    const json_t *knots = json_object_get(object, "knots"), *control = json_object_get(object, "control");
    size_t count = json_array_size(knots), functions = json_array_size(control);
    *good = whole(json_object_get(object, "degree"), BAT_SPLINE_MAX_DEGREE, &degree) && degree > 0 && functions > degree &&
            count == functions + (size_t)degree + 1;
    if (!*good)
        return BAT_OK;
    *piece = (bat_spline_curve){.dimension = 2,
                                .control = memory_array(functions, 2 * sizeof(double)),
                                .knots = {memory_array(count, sizeof(double)), count, (int)degree}};
    if (piece->control == NULL || piece->knots.knots == NULL)
        return error_memory(file->error, count * sizeof(double));
    *good = read_numbers(knots, count, piece->knots.knots);
    for (size_t i = 0; i < functions && *good; i++)
        *good = read_numbers(json_array_get(control, i), 2, piece->control + 2 * i);
    return BAT_OK;
}

static bat_status read_trim(const json_file *file, bat_spline_trim *trim)
{
    const json_t *loops = json_object_get(file->root, "trim");
    size_t count = json_array_size(loops), pieces = 0;
    if (loops == NULL)
        return BAT_OK;
    for (size_t l = 0; l < count; l++)
        pieces += json_array_size(json_array_get(loops, l));
    if (count == 0 || pieces == 0)
        return bad_member(file, "trim", "is not an array of loops, which are arrays of curves");
    trim->pieces = calloc(pieces, sizeof *trim->pieces);
    trim->loops = calloc(count + 1, sizeof *trim->loops);
    if (trim->pieces == NULL || trim->loops == NULL)
        return error_memory(file->error, pieces * sizeof *trim->pieces);
    bool good = true;
    bat_status status = BAT_OK;
    for (size_t l = 0, made = 0; l < count && good && status == BAT_OK; l++)
    {
        const json_t *loop = json_array_get(loops, l);
        trim->loop_count = l + 1;
        trim->loops[l + 1] = made;
        for (size_t i = 0; i < json_array_size(loop) && good && status == BAT_OK; i++)
        {
            trim->loops[l + 1] = made + 1;
            status = read_curve(file, json_array_get(loop, i), &trim->pieces[made++], &good);
        }
        good = good && json_array_size(loop) > 0;
        if (status == BAT_OK && !good)
            status =
                bad_element(file, "trim", l, "holds something that is not a curve with degree, knots and control points");
    }
    bat_error failure;
    if (status == BAT_OK && spline_trim_check(trim, &failure) != BAT_OK)
        status = bad_member(file, "trim", failure.text);
    return status;
}

static bat_status read_surface(const json_file *file, bat_spline_surface *surface)
{
    bat_hierarchical_options options;
    surface_box *boxes = NULL;
    size_t box_count = 0;
    uint64_t dimension;
    bat_status status = check_format(file);
    if (status == BAT_OK)
        status = read_options(file, &options);
    if (status == BAT_OK && (!whole(json_object_get(file->root, "dimension"), UINT32_MAX, &dimension) || dimension == 0))
        status = bad_member(file, "dimension", "is not a whole number of at least 1");
    const json_t *control = json_object_get(file->root, "control");
    if (status == BAT_OK && !json_is_array(control))
        status = bad_member(file, "control", "is not an array");
    if (status == BAT_OK)
        status = read_boxes(file, &boxes, &box_count);
    if (status == BAT_OK)
        status = surface_space_make(&options, boxes, box_count, line_of(file, "control", BAT_NO_INDEX),
                                    json_array_size(control), &surface->space, file->error);
    free(boxes);
    if (status != BAT_OK)
        return status;
    surface->dimension = (size_t)dimension;
    // Check the dimension before memory for all points is allocated.
    if (json_array_size(json_array_get(control, 0)) != surface->dimension)
        return bad_element(file, "control", 0, "does not have as many coordinates as \"dimension\" says");
    status = read_control(file, surface);
    return status == BAT_OK ? read_trim(file, &surface->trim) : status;
}

bat_status surface_json_read(const file_text *text, bat_spline_surface *surface, bat_error *error)
{
    json_file file = {.text = text, .error = error};
    bat_spline_surface made = {0};
    bat_status status = json_parse(text->data, text->size, 0, 1, &file.root, error);
    if (status != BAT_OK)
        return status;
    status = json_is_object(file.root) ? read_surface(&file, &made) : ERROR_FILE(error, 1, "this is not a JSON object");
    json_decref(file.root);
    if (status == BAT_OK)
        *surface = made;
    else
        bat_spline_surface_free(&made);
    return status;
}

static const char *row_end(size_t row, size_t rows)
{
    return row + 1 < rows ? "],\n" : "]\n";
}

static bat_status append_boxes(text_buffer *text, const bat_hierarchical_space *space, bat_error *error)
{
    bat_spline_box *boxes = NULL;
    size_t count = 0;
    bat_status status = hierarchical_space_regions(space, &boxes, &count, error);
    if (status != BAT_OK)
        return status;
    text_append_string(text, "\"boxes\": [\n");
    for (size_t i = 0; i < count; i++)
        text_append_format(text, "[%" PRIu32 ", %" PRIu32 ", %" PRIu32 ", %" PRIu32 ", %" PRIu32 "%s", boxes[i].level,
                           boxes[i].low[0], boxes[i].low[1], boxes[i].high[0], boxes[i].high[1], row_end(i, count));
    text_append_string(text, "],\n");
    free(boxes);
    return BAT_OK;
}

static void append_functions(text_buffer *text, const bat_hierarchical_space *space)
{
    size_t count = bat_hierarchical_space_functions(space);
    text_append_string(text, "\"functions\": [\n");
    for (size_t i = 0; i < count; i++)
    {
        bat_spline_function function = hierarchical_space_function(space, i);
        text_append_format(text, "[%" PRIu32 ", %" PRIu32 ", %" PRIu32 "%s", function.level, function.i, function.j,
                           row_end(i, count));
    }
    text_append_string(text, "],\n");
}

/// Append an array of numbers, with what ends it.
static void append_numbers(text_buffer *text, const double *numbers, size_t count, const char *end)
{
    for (size_t i = 0; i < count; i++)
    {
        text_append_real(text, i > 0 ? ", " : "[", numbers[i]);
        if (numbers[i] == 0 && signbit(numbers[i])) // JSON readers take "-0" for an integer, which loses the sign
            text_append_string(text, ".0");
    }
    text_append_string(text, end);
}

static void append_trim(text_buffer *text, const bat_spline_trim *trim)
{
    if (trim->loop_count == 0)
        return;
    text_append_string(text, "\"trim\": [\n");
    for (size_t l = 0; l < trim->loop_count; l++)
    {
        text_append_string(text, "[");
        for (size_t i = trim->loops[l]; i < trim->loops[l + 1]; i++)
        {
            const bat_spline_curve *piece = &trim->pieces[i];
            size_t functions = knot_vector_functions(&piece->knots);
            text_append_format(text, "{\"degree\": %d, \"knots\": ", piece->knots.degree);
            append_numbers(text, piece->knots.knots, piece->knots.count, "], \"control\": [");
            for (size_t k = 0; k < functions; k++)
                append_numbers(text, piece->control + 2 * k, 2, k + 1 < functions ? "], " : "]");
            text_append_string(text, i + 1 < trim->loops[l + 1] ? "]},\n" : "]}");
        }
        text_append_string(text, row_end(l, trim->loop_count));
    }
    text_append_string(text, "],\n");
}

static void append_control(text_buffer *text, const bat_spline_surface *surface)
{
    size_t count = bat_hierarchical_space_functions(surface->space);
    text_append_string(text, "\"control\": [\n");
    for (size_t i = 0; i < count; i++)
        append_numbers(text, surface->control + i * surface->dimension, surface->dimension, row_end(i, count));
    text_append_string(text, "]\n}\n");
}

bat_status surface_json_write(const bat_spline_surface *surface, const bat_surface_write_options *options BAT_UNUSED,
                              text_sink *sink, bat_error *error)
{
    text_buffer text = {0};
    bat_hierarchical_options grid = bat_hierarchical_space_options(surface->space);
    text_append_format(&text,
                       "{\n\"format\": \"batten surface\",\n\"version\": 1,\n\"degree\": [%d, %d],\n\"spans\": [%zu, %zu],\n"
                       "\"truncated\": %s,\n\"admissible\": %d,\n\"dimension\": %zu,\n",
                       grid.degree[0], grid.degree[1], grid.spans[0], grid.spans[1], grid.truncated ? "true" : "false",
                       grid.admissible, surface->dimension);
    bat_status status = append_boxes(&text, surface->space, error);
    append_functions(&text, surface->space);
    append_trim(&text, &surface->trim);
    append_control(&text, surface);
    return sink_take(sink, &text, status, error);
}
