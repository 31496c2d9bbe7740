#include "io/motion/pose_translation.h"

#include "linalg/vector.h"

#include <ctype.h>

/// Rows that are tried before a text without names is taken for a trajectory.
static const int PROBED_ROWS = 100;

/// Four numbers of about unit length are taken for a quaternion.
static const double UNIT_TOLERANCE = 1e-2;

const char *poses_euler_fault(const char *euler)
{
    static const char *const orders[] = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};
    static const char fault[] = "euler must be an order of x, y and z, as zyx, with ,degrees or ,radians where the names "
                                "of the columns do not tell";
    if (euler == NULL)
        return NULL;
    bool known = false;
    for (size_t i = 0; i < sizeof orders / sizeof *orders; i++)
        known = known || strncmp(euler, orders[i], 3) == 0;
    if (!known)
        return fault;
    const char *rest = euler + 3;
    return *rest == '\0' || strcmp(rest, ",degrees") == 0 || strcmp(rest, ",radians") == 0 ? NULL : fault;
}

// Rows of numbers without names

/// Whether a text has words at a place.
static bool has_words(const file_text *text, size_t at, const char *words)
{
    size_t size = strlen(words);
    return text->size >= size && at <= text->size - size && memcmp(text->data + at, words, size) == 0;
}

/// Whether the first rows all have `width` numbers, and a comment names them or two of three rows at least agree with a form
/// without names: the reader tells of the others. `*first` receives the first number.
static bool probe(const pose_translation *work, size_t width, double *first, char *separator)
{
    static const char TUM_NAMES[] = "tx ty tz qx qy qz qw";
    text_line line = text_line_start(work->source);
    size_t rows = 0, odd = 0;
    bool named = false;
    double numbers[EUROC_NUMBERS], quaternion[4], before = -INFINITY;
    while (rows < PROBED_ROWS && text_line_next(work->source, &line))
    {
        size_t end = (size_t)(line.end - work->source->data);
        if (line.begin == line.end || *line.begin == '#')
        {
            named = named || has_words(work->source, end - strlen(TUM_NAMES), TUM_NAMES);
            continue;
        }
        // Any row of a file of matrices decides.
        if (rows > 0 && width == KITTI_NUMBERS)
            return true;
        if (!pose_read_numbers(work->source, &line, width, numbers, separator) ||
            (width == KITTI_NUMBERS && pose_matrix_deviation(numbers, quaternion) > POSE_MATRIX_TOLERANCE))
            return false;
        odd += numbers[0] < before || !(fabs(sqrt(vector_square(4, numbers + 4)) - 1) <= UNIT_TOLERANCE);
        before = numbers[0];
        if (rows++ == 0)
            *first = before;
    }
    return rows > 1 && (3 * odd <= rows || named);
}

static bat_status translate_euroc_row(pose_translation *work, const text_line *line, bat_error *error)
{
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t count;
    double numbers[EUROC_SPEEDS - 1] = {0};
    bool comma = false;
    char separator = csv_find_separator(line);
    const char *fault = csv_split(work->source, line, separator, fields, &count);
    if (work->width == 0)
        work->width = count >= EUROC_SPEEDS ? EUROC_SPEEDS : TUM_NUMBERS;
    if (fault == NULL && count < work->width)
        fault = work->width == TUM_NUMBERS ? "a row of EuRoC poses has 8 numbers or more"
                                           : "the row has less than the 11 numbers of a pose with its velocity";
    if (fault == NULL)
        fault = pose_time_copy(fields[0], separator, &work->text);
    for (size_t i = 0; i + 1 < work->width && fault == NULL; i++)
        fault = csv_read_number(fields[1 + i], separator, &numbers[i], &comma);
    if (fault != NULL)
        return ERROR_FILE(error, line->number, "%s", fault);
    pose_write_tum(work, numbers, numbers + 3);
    for (size_t i = TUM_NUMBERS; i < work->width; i++)
        text_append_real(&work->text, " ", numbers[i - 1]);
    return BAT_OK;
}

/// Rows of EuRoC; `named` where the user names the format.
static bat_status pose_translate_euroc(pose_translation *work, bool named, bat_error *error)
{
    bat_status status = BAT_OK;
    text_line line = text_line_start(work->source);
    bool begun = false;
    while (status == BAT_OK && text_line_next(work->source, &line))
    {
        bool header = !begun && line.begin != line.end && *line.begin != '#' && !number_resembles(line.begin, line.end);
        if (line.begin != line.end && *line.begin != '#' && !header)
        {
            status = translate_euroc_row(work, &line, error);
            begun = true;
        }
        text_append_string(&work->text, "\n");
    }
    work->reader = work->width == EUROC_SPEEDS ? BAT_CURVE_FORMAT_EUROC : BAT_CURVE_FORMAT_TUM;
    work->format = BAT_CURVE_FORMAT_EUROC;
    pose_note(work, "EuRoC poses%s: of the body in the reference frame, quaternions w x y z%s",
              named ? "" : ", by their numbers",
              work->width == EUROC_SPEEDS ? ", with their velocities; biases are left out" : "");
    return status;
}

/// Whether a text begins as BVH does. A table can have a column of the first name.
static bool resembles_bvh(const file_text *text)
{
    static const char FIRST[] = "HIERARCHY";
    size_t end = sizeof FIRST - 1, at = end;
    if (!has_words(text, 0, FIRST))
        return false;
    while (at < text->size && isspace((unsigned char)text->data[at]))
        at++;
    return at > end && has_words(text, at, "ROOT");
}

static bat_status guess(pose_translation *work, bool names_alone, bat_error *error)
{
    text_line head;
    pose_header names;
    csv_field time;
    double first = 0;
    char separator = ' ';
    if (has_words(work->source, 0, "# Image list with two lines of data per image"))
        return pose_translate_colmap(work, error);
    if (resembles_bvh(work->source))
        return pose_translate_bvh(work, error);
    if (pose_find_header(work, &head, &names, &time) && pose_wants_table(work, &names, time))
        return pose_translate_table(work, &head, &names, error);
    const char *space = work->options->space;
    if (names_alone || (space != NULL && strcmp(space, "rigid") != 0))
        return BAT_OK;
    if (probe(work, KITTI_NUMBERS, &first, &separator))
        return pose_translate_kitti(work, error);
    if (probe(work, EUROC_NUMBERS, &first, &separator) && first >= 1e17)
        return pose_translate_euroc(work, false, error);
    if (!probe(work, TUM_NUMBERS, &first, &separator))
        return BAT_OK;
    if (separator != ' ' && separator != '\t' && first >= 1e17)
        return pose_translate_euroc(work, false, error);
    if (separator != ' ' && separator != '\t')
        return space != NULL ? BAT_OK
                             : error_remedy(error,
                                            ERROR_FILE(error, 0,
                                                       "the rows look like times, positions and quaternions, but nothing "
                                                       "names their order, or the space euclidean for plain numbers"),
                                            "read.format", "tum takes quaternions as x y z w");
    work->reader = work->format = BAT_CURVE_FORMAT_TUM;
    work->as_it_is = true;
    pose_note(work, "a TUM trajectory, by its content: times, positions, quaternions x y z w from the body's frame "
                    "to the fixed one");
    return BAT_OK;
}

static bat_status read_translated(pose_translation *work, bat_curve_set *set, bat_error *error)
{
    file_text made = {.data = work->text.data, .size = work->text.size};
    bat_curve_read_options options = *work->options;
    options.format = work->reader;
    options.motion = true;
    options.euler = work->order[0] != '\0' ? work->order : NULL;
    if (work->format == BAT_CURVE_FORMAT_EUROC && options.time_unit == BAT_TIME_UNIT_AUTO)
        options.time_unit = BAT_TIME_UNIT_NANOSECONDS;
    bat_status status = csv_read(work->as_it_is ? work->source : &made, &options, set, error);
    if (status != BAT_OK)
        return status;
    set->attributes->format = work->format;
    for (size_t i = 0; i < work->note_count; i++)
        if (!attributes_note(set->attributes, "%s", work->notes[i]))
        {
            bat_curve_set_free(set);
            return error_memory(error, POSE_NOTE_SIZE);
        }
    return BAT_OK;
}

bat_status poses_read(const file_text *text, bat_curve_format format, const bat_curve_read_options *options,
                      bat_curve_set *set, bool *taken, bat_error *error)
{
    *taken = true;
    pose_translation *work = calloc(1, sizeof *work);
    if (work == NULL)
        return error_memory(error, sizeof *work);
    work->source = text;
    work->options = options;
    bool forced = format == BAT_CURVE_FORMAT_EUROC || format == BAT_CURVE_FORMAT_KITTI || format == BAT_CURVE_FORMAT_BVH;
    bat_status status = BAT_OK;
    if (forced && options->space != NULL && strcmp(options->space, "rigid") != 0)
        status = ERROR_ARGUMENT(error, "%s poses are in the space rigid, not %.60s",
                                bat_choice_name(&bat_curve_format_family, (int)format), options->space);
    else if (format == BAT_CURVE_FORMAT_KITTI)
        status = pose_translate_kitti(work, error);
    else if (format == BAT_CURVE_FORMAT_EUROC)
        status = pose_translate_euroc(work, true, error);
    else if (format == BAT_CURVE_FORMAT_BVH)
        status = pose_translate_bvh(work, error);
    else if (options->columns == NULL && options->group == NULL)
        status = guess(work, format == BAT_CURVE_FORMAT_CSV, error);
    text_append(&work->text, "", 1);
    if (status == BAT_OK && work->text.failed)
        status = error_memory(error, text->size);
    else if (!work->text.failed)
        work->text.size--;
    *taken = status != BAT_OK || work->reader != BAT_CURVE_FORMAT_AUTO;
    if (status == BAT_OK && *taken)
        status = read_translated(work, set, error);
    text_free(&work->text);
    free(work);
    return status;
}

bat_status trajectory_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set,
                           bat_error *error)
{
    bool taken;
    return poses_read(text, options->format, options, set, &taken, error);
}
