#include "io/surface/formats.h"
#include "io/surface/step.h"

/// @file
/// A spline surface as IGES 5.3 (ANSI US PRO/IPO-100, 1996): rational B-spline surface (entity 128); of a trimmed surface
/// also rational B-spline curves (126), composite curves (102), curves on a surface (142) and the trimmed surface (144).
/// A file consists of records of 80 columns, of which the last eight hold the section's letter and the record's number.

enum
{
    PARAMETER_COLUMNS = 64,
    COLUMNS = 72,
    NUMBER_SIZE = NUMBER_TEXT_SIZE + 4
};

/// Use flags of directory entries: status numbers.
static const char INDEPENDENT[] = "00000000", DEPENDENT[] = "00010000", PARAMETRIC[] = "00010500";

typedef struct iges_file
{
    text_buffer directory, parameters;
    char line[COLUMNS + 1]; ///< of parameters, not yet complete
    size_t used;
    unsigned entries, records; ///< records of the two sections
    unsigned entity;           ///< the directory record of the entity
    unsigned first;            ///< its first parameter record
} iges_file;

static void append_record(text_buffer *text, const char *content, char section, unsigned number)
{
    char record[96];
    (void)snprintf(record, sizeof record, "%-72.72s%c%7u\n", content, section, number);
    text_append_string(text, record);
}

static void end_line(iges_file *file)
{
    char content[96];
    (void)snprintf(content, sizeof content, "%-64.64s%8u", file->line, file->entity);
    append_record(&file->parameters, content, 'P', ++file->records);
    file->used = 0;
    file->line[0] = '\0';
}

/// Append a value and its delimiter. Values are not divided between records.
static void add_text(iges_file *file, const char *text, char delimiter)
{
    size_t length = strlen(text) + 1;
    if (file->used + length > PARAMETER_COLUMNS)
        end_line(file);
    (void)snprintf(file->line + file->used, sizeof file->line - file->used, "%s%c", text, delimiter);
    file->used += length;
}

static void add_whole(iges_file *file, size_t value, char delimiter)
{
    char text[32];
    (void)snprintf(text, sizeof text, "%zu", value);
    add_text(file, text, delimiter);
}

static void add_wholes(iges_file *file, const size_t *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        add_whole(file, values[i], ',');
}

/// Real numbers need a decimal point, those of double precision the letter D.
static void add_real(iges_file *file, double value, char delimiter)
{
    char text[NUMBER_SIZE];
    *model_real(text, value, 'D') = '\0';
    add_text(file, text, delimiter);
}

/// Begin an entity. Returns the number of its directory record, by which others refer to it.
static unsigned begin_entity(iges_file *file, int type)
{
    file->entity = file->entries + 1;
    file->first = file->records + 1;
    add_whole(file, (size_t)type, ',');
    return file->entity;
}

static void end_entity(iges_file *file, int type, const char *status)
{
    char content[96];
    end_line(file);
    (void)snprintf(content, sizeof content, "%8d%8u%8d%8d%8d%8d%8d%8d%8s", type, file->first, 0, 0, 0, 0, 0, 0, status);
    append_record(&file->directory, content, 'D', ++file->entries);
    (void)snprintf(content, sizeof content, "%8d%8d%8d%8u%8d%8s%8s%8s%8d", type, 0, 0, file->records - file->first + 1, 0,
                   "", "", "", 0);
    append_record(&file->directory, content, 'D', ++file->entries);
}

static void add_reals(iges_file *file, const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        add_real(file, values[i], ',');
}

/// Append the first and the last parameter.
static void add_domain(iges_file *file, const bat_knot_vector *knots, char delimiter)
{
    add_real(file, knots->knots[knots->degree], ',');
    add_real(file, knots->knots[knot_vector_functions(knots)], delimiter);
}

static unsigned write_surface(iges_file *file, const tensor_surface *surface, bool trimmed)
{
    static const int SURFACE = 128;
    const bat_knot_vector *u = &surface->knots[0], *v = &surface->knots[1];
    size_t columns = knot_vector_functions(u), rows = knot_vector_functions(v);
    unsigned number = begin_entity(file, SURFACE);
    add_wholes(file, (const size_t[]){columns - 1, rows - 1, (size_t)u->degree, (size_t)v->degree}, 4);
    // Open in both directions, polynomial, not periodic.
    add_wholes(file, (const size_t[]){0, 0, 1, 0, 0}, 5);
    add_reals(file, u->knots, u->count);
    add_reals(file, v->knots, v->count);
    for (size_t i = 0; i < columns * rows; i++)
        add_real(file, 1, ',');
    add_reals(file, surface->control, 3 * columns * rows);
    add_domain(file, u, ',');
    add_domain(file, v, ';');
    end_entity(file, SURFACE, trimmed ? DEPENDENT : INDEPENDENT);
    return number;
}

static unsigned write_curve(iges_file *file, const bat_spline_curve *curve)
{
    static const int CURVE = 126;
    size_t functions = knot_vector_functions(&curve->knots), dimension = curve->dimension;
    const double *last = curve->control + dimension * (functions - 1);
    bool closed = memcmp(last, curve->control, dimension * sizeof *last) == 0, planar = dimension == 2;
    unsigned number = begin_entity(file, CURVE);
    add_wholes(file, (const size_t[]){functions - 1, (size_t)curve->knots.degree, planar, closed, 1, 0}, 6);
    add_reals(file, curve->knots.knots, curve->knots.count);
    for (size_t i = 0; i < functions; i++)
        add_real(file, 1, ',');
    for (size_t i = 0; i < functions; i++)
        for (size_t c = 0; c < 3; c++)
            add_real(file, c < dimension ? curve->control[dimension * i + c] : 0, ',');
    add_domain(file, &curve->knots, ',');
    for (int c = 0; c < 3; c++)
        add_real(file, c == 2 && planar, c < 2 ? ',' : ';');
    end_entity(file, CURVE, planar ? PARAMETRIC : DEPENDENT);
    return number;
}

/// Write curves that follow each other. Returns the number of the whole; 0 when out of memory.
static unsigned write_composite(iges_file *file, const bat_spline_curve *curves, size_t count)
{
    static const int COMPOSITE = 102;
    if (count == 1)
        return write_curve(file, curves);
    unsigned *numbers = calloc(count, sizeof *numbers);
    if (numbers == NULL)
        return 0;
    for (size_t i = 0; i < count; i++)
        numbers[i] = write_curve(file, &curves[i]);
    unsigned whole = begin_entity(file, COMPOSITE);
    add_whole(file, count, ',');
    for (size_t i = 0; i < count; i++)
        add_whole(file, numbers[i], i + 1 < count ? ',' : ';');
    end_entity(file, COMPOSITE, curves->dimension == 2 ? PARAMETRIC : DEPENDENT);
    free(numbers);
    return whole;
}

/// Write a loop as a curve on a surface. Returns its number; 0 when out of memory.
static unsigned write_loop(iges_file *file, const trimmed_model *model, size_t loop, unsigned surface)
{
    enum
    {
        CURVE_ON_SURFACE = 142,
        PROJECTION = 1, ///< way of creation
        EQUAL = 3       ///< neither of the two representations is preferred
    };
    size_t begin = model->trim->loops[loop], count = model->trim->loops[loop + 1] - begin;
    unsigned flat = write_composite(file, model->trim->pieces + begin, count);
    unsigned space = write_composite(file, model->images + begin, count);
    if (flat == 0 || space == 0)
        return 0;
    unsigned number = begin_entity(file, CURVE_ON_SURFACE);
    add_wholes(file, (const size_t[]){PROJECTION, surface, flat, space}, 4);
    add_whole(file, EQUAL, ';');
    end_entity(file, CURVE_ON_SURFACE, DEPENDENT);
    return number;
}

static bat_status write_trimmed(iges_file *file, const trimmed_model *model, unsigned surface, bat_error *error)
{
    static const int TRIMMED = 144;
    size_t count = model->trim->loop_count;
    unsigned *loops = calloc(count, sizeof *loops);
    if (loops == NULL)
        return error_memory(error, count * sizeof *loops);
    bool complete = true;
    for (size_t l = 0; l < count && complete; l++)
    {
        loops[l] = write_loop(file, model, l, surface);
        complete = loops[l] > 0;
    }
    if (complete)
    {
        (void)begin_entity(file, TRIMMED);
        add_wholes(file, (const size_t[]){surface, 1, count - 1}, 3);
        for (size_t l = 0; l < count; l++)
            add_whole(file, loops[l], l + 1 < count ? ',' : ';');
        end_entity(file, TRIMMED, INDEPENDENT);
    }
    free(loops);
    return complete ? BAT_OK : error_memory(error, model->piece_count * sizeof *loops);
}

/// Write the global section. Returns the number of its records.
static unsigned append_global(text_buffer *text, bat_surface_unit unit, const trimmed_model *model)
{
    static const char *const UNITS[] = {"2,2HMM", "2,2HMM", "6,1HM", "1,4HINCH"}; // by bat_surface_unit
    char tolerance[NUMBER_SIZE], name[32], global[400];
    *model_real(tolerance, model->tolerance, 'D') = '\0';
    (void)snprintf(name, sizeof name, "batten %d.%d.%d", BAT_VERSION_MAJOR, BAT_VERSION_MINOR, BAT_VERSION_PATCH);
    (void)snprintf(
        global, sizeof global,
        "1H,,1H;,7Hsurface,12Hsurface.iges,%zuH%s,%zuH%s,32,38,6,308,15,7Hsurface,1.,%s,1,0.,15H19700101.000000,%s,"
        "0.,6Hbatten,6Hbatten,11,0,15H19700101.000000;",
        strlen(name), name, strlen(name), name, UNITS[unit], tolerance);
    unsigned records = 0;
    for (size_t at = 0; at < strlen(global); at += COLUMNS)
        append_record(text, global + at, 'G', ++records);
    return records;
}

bat_status surface_iges_write(const bat_spline_surface *surface, const bat_surface_write_options *options, text_sink *sink,
                              bat_error *error)
{
    trimmed_model model;
    iges_file file = {0};
    text_buffer head = {0};
    char content[96];
    bat_status status = trimmed_model_make(surface, NULL, &model, error);
    if (status != BAT_OK)
        return status;
    append_record(&head, "B-spline surface", 'S', 1);
    unsigned global = append_global(&head, options->unit, &model);
    unsigned number = write_surface(&file, &model.surface, model.piece_count > 0);
    if (model.piece_count > 0)
        status = write_trimmed(&file, &model, number, error);
    (void)snprintf(content, sizeof content, "S%7uG%7uD%7uP%7u", 1, global, file.entries, file.records);
    append_record(&file.parameters, content, 'T', 1);
    status = sink_take(sink, &head, status, error);
    status = sink_take(sink, &file.directory, status, error);
    status = sink_take(sink, &file.parameters, status, error);
    trimmed_model_free(&model);
    return status;
}
