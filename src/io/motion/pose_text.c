#include "batten/motion.h"
#include "io/motion/pose_translation.h"
#include "space/quaternion.h"

#include <ctype.h>
#include <stdarg.h>

/// @file
/// Texts of poses: rows of numbers without names, KITTI's matrices, images of COLMAP, and motion capture in BVH.

/// Rows that are tried before a text without names is taken for a trajectory.
static const int PROBED_ROWS = 100;

/// Four numbers of about unit length are taken for a quaternion.
static const double UNIT_TOLERANCE = 1e-2;

void pose_note(pose_translation *work, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (work->note_count < POSE_NOTES)
        (void)vsnprintf(work->notes[work->note_count++], POSE_NOTE_SIZE, format, values);
    va_end(values);
}

bool pose_read_numbers(const file_text *source, const text_line *line, size_t count, double *numbers, char *separator)
{
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t found;
    bool comma = false;
    *separator = csv_find_separator(line);
    if (csv_split(source, line, *separator, fields, &found) != NULL)
        return false;
    while (found > count && fields[found - 1].begin == fields[found - 1].end)
        found--;
    if (found != count)
        return false;
    for (size_t i = 0; i < count; i++)
        if (csv_read_number(fields[i], *separator, &numbers[i], &comma) != NULL)
            return false;
    return !comma;
}

void pose_write_tum(pose_translation *work, const double *place, const double *quaternion)
{
    const double row[7] = {place[0], place[1], place[2], quaternion[1], quaternion[2], quaternion[3], quaternion[0]};
    for (int i = 0; i < 7; i++)
        text_append_real(&work->text, " ", row[i]);
}

void pose_write_row(pose_translation *work, double time, const double *place, const double *quaternion)
{
    text_append_real(&work->text, "", time);
    pose_write_tum(work, place, quaternion);
    text_append_string(&work->text, "\n");
}

const char *pose_time_copy(csv_field cell, char separator, text_buffer *text)
{
    iso_time iso;
    double value;
    bool comma = false;
    cell = csv_unquoted(cell);
    const char *fault = iso_time_read(cell.begin, cell.end, &iso) ? NULL : csv_read_number(cell, separator, &value, &comma);
    for (const char *at = cell.begin; at < cell.end && fault == NULL; at++)
        text_append(text, *at == ',' ? "." : at, 1);
    return fault;
}

// KITTI's rows of matrices

/// The distance that is worth a note.
static const double MATRIX_ROUNDING = 1e-6;

/// The nearest rotation of a row's 3x4 matrix, and the largest distance of an entry from it; infinite without one.
static double pose_matrix_deviation(const double *row, double *quaternion)
{
    double matrix[9], nearest[9], largest = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix[3 * i + j] = row[4 * i + j];
    if (bat_rotation_nearest(matrix, quaternion, NULL) != BAT_OK)
        return INFINITY;
    bat_rotation_to_matrix(quaternion, nearest);
    for (int i = 0; i < 9; i++)
        largest = fmax(largest, fabs(nearest[i] - matrix[i]));
    return largest;
}

/// Find the times of the rows of KITTI, where they were given.
static bat_status read_key_times(const pose_translation *work, double **times, size_t *count, bat_error *error)
{
    *times = NULL;
    *count = 0;
    if (work->options->key_times == NULL)
        return BAT_OK;
    bat_status status = bat_motion_times_read(work->options->key_times, NULL, times, count, error);
    char line[32] = "";
    if (status != BAT_OK && error != NULL && error->line > 0)
        (void)snprintf(line, sizeof line, ":%zu", error->line);
    if (status != BAT_OK && error != NULL)
        error->line = 0;
    return error_prefix(error, status, "%.80s%s: ", work->options->key_times, line);
}

static bat_status translate_matrix(pose_translation *work, const text_line *line, const double *times, size_t time_count,
                                   size_t row, double *worst, size_t *worst_line, bat_error *error)
{
    double numbers[KITTI_NUMBERS + 4], quaternion[4];
    const double *last = numbers + KITTI_NUMBERS;
    char separator;
    bool whole = pose_read_numbers(work->source, line, KITTI_NUMBERS + 4, numbers, &separator) && last[0] == 0 &&
                 last[1] == 0 && last[2] == 0 && last[3] == 1;
    if (!whole && !pose_read_numbers(work->source, line, KITTI_NUMBERS, numbers, &separator))
        return ERROR_FILE(
            error, line->number,
            "a row of KITTI poses has 12 numbers, a matrix of 3 rows and 4 columns, or 16 that end in 0 0 0 1");
    double deviation = pose_matrix_deviation(numbers, quaternion);
    if (!(deviation <= POSE_MATRIX_TOLERANCE) && !(work->options->project && deviation < INFINITY))
    {
        (void)ERROR_FILE(error, line->number,
                         deviation < INFINITY ? "the matrix is no rotation: an entry is off by %.3g"
                                              : "the matrix is no rotation",
                         deviation);
        return deviation < INFINITY ? error_remedy(error, BAT_BAD_FILE, "project", "takes the nearest rotation")
                                    : BAT_BAD_FILE;
    }
    if (deviation > *worst)
    {
        *worst = deviation;
        *worst_line = line->number;
    }
    if (times != NULL && row >= time_count)
        return ERROR_FILE(error, line->number, "there are more poses than times, which are %zu", time_count);
    pose_write_row(work, times != NULL ? times[row] : (double)row, (double[3]){numbers[3], numbers[7], numbers[11]},
                   quaternion);
    return BAT_OK;
}

static bat_status pose_translate_kitti(pose_translation *work, bat_error *error)
{
    double *times, worst = 0;
    size_t time_count, rows = 0, worst_line = 0;
    bat_status status = read_key_times(work, &times, &time_count, error);
    text_line line = text_line_start(work->source);
    while (status == BAT_OK && text_line_next(work->source, &line))
    {
        if (line.begin != line.end && *line.begin != '#')
            status = translate_matrix(work, &line, times, time_count, rows++, &worst, &worst_line, error);
        else
            text_append_string(&work->text, "\n");
    }
    if (status == BAT_OK && times != NULL && rows != time_count)
        status = ERROR_FILE(error, line.number, "there are %zu poses, but %zu times", rows, time_count);
    work->reader = BAT_CURVE_FORMAT_TUM;
    work->format = times != NULL ? BAT_CURVE_FORMAT_TUM : BAT_CURVE_FORMAT_KITTI;
    pose_note(work, "KITTI poses: matrices from the camera's frame (x right, y down, z forward) to that of the first pose");
    if (times == NULL)
        pose_note(work, "no times: pose i is at time i, the number of its frame; a file of times gives others");
    if (worst > MATRIX_ROUNDING)
        pose_note(work, "matrices are up to %.2g from rotations, most on line %zu; they became the nearest ones", worst,
                  worst_line);
    free(times);
    return status;
}

// The images of a reconstruction by COLMAP, images.txt: two lines for each, of which the first has the rotation and the
// translation from the world to the camera, and the name of the image.

typedef struct colmap_image
{
    csv_field name;
    size_t line;
    double pose[7]; ///< quaternion and translation
} colmap_image;

static int by_name(const void *a, const void *b)
{
    const csv_field p = ((const colmap_image *)a)->name, q = ((const colmap_image *)b)->name;
    size_t m = (size_t)(p.end - p.begin), n = (size_t)(q.end - q.begin);
    int order = memcmp(p.begin, q.begin, m < n ? m : n);
    return order != 0 ? order : ORDER_OF(m, n);
}

/// The last number in a name, as that of a frame; -1 without one.
static double number_in(csv_field name)
{
    const char *end = name.end;
    while (end > name.begin && !(end[-1] >= '0' && end[-1] <= '9'))
        end--;
    const char *begin = end;
    while (begin > name.begin && begin[-1] >= '0' && begin[-1] <= '9')
        begin--;
    double value = -1;
    return begin < end && number_read(begin, end, &value) == NULL ? value : -1;
}

static bat_status read_image(const pose_translation *work, const text_line *line, colmap_image *image, bat_error *error)
{
    csv_field fields[BAT_SPACE_MAX_DIM];
    size_t count;
    bool comma = false;
    const char *fault = csv_split(work->source, line, ' ', fields, &count);
    if (fault == NULL && count < 10)
        fault = "a line of an image has a number, a quaternion, a translation, a camera and a name";
    for (size_t i = 0; i < 7 && fault == NULL; i++)
        fault = csv_read_number(fields[1 + i], ' ', &image->pose[i], &comma);
    if (fault == NULL && !isnormal(quaternion_dot(image->pose, image->pose)))
        fault = "the quaternion is 0 or too large";
    if (fault != NULL)
        return ERROR_FILE(error, line->number, "%s", fault);
    image->name = (csv_field){fields[9].begin, line->end};
    image->line = line->number;
    return BAT_OK;
}

/// The pose of the camera in the world, of a unit quaternion: x = R c + t becomes c = R^T (x - t).
static void write_image(pose_translation *work, double time, const double *pose)
{
    const double turned[] = {pose[0], -pose[1], -pose[2], -pose[3]};
    double matrix[9], place[3];
    bat_rotation_to_matrix(turned, matrix);
    for (size_t i = 0; i < 3; i++)
        place[i] = -(matrix[3 * i] * pose[4] + matrix[3 * i + 1] * pose[5] + matrix[3 * i + 2] * pose[6]);
    pose_write_row(work, time, place, turned);
}

static bat_status pose_translate_colmap(pose_translation *work, bat_error *error)
{
    colmap_image *images = NULL;
    size_t count = 0, capacity = 0;
    bat_status status = BAT_OK;
    bool points = false, numbered = true; // the second line of an image, which may be empty
    text_line line = text_line_start(work->source);
    while (status == BAT_OK && text_line_next(work->source, &line))
    {
        colmap_image image;
        if ((line.begin != line.end && *line.begin == '#') || (!points && line.begin == line.end))
            continue;
        points = !points;
        if (!points)
            continue;
        status = read_image(work, &line, &image, error);
        if (status == BAT_OK && !ARRAY_ADD(images, capacity, count, image))
            status = error_memory(error, count * sizeof image);
    }
    if (status == BAT_OK && count > 0)
        qsort(images, count, sizeof *images, by_name);
    for (size_t i = 0; i < count; i++)
        numbered = numbered && number_in(images[i].name) > (i > 0 ? number_in(images[i - 1].name) : -1);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        write_image(work, numbered ? number_in(images[i].name) : (double)i, images[i].pose);
    free(images);
    work->reader = work->format = BAT_CURVE_FORMAT_TUM;
    pose_note(work,
              "images of COLMAP in the order of their names: poses of the camera in the world (x right, y down, z forward)");
    pose_note(work, numbered ? "no times: a pose is at the number in its image's name"
                             : "no times: pose i is at time i, since names have no increasing numbers");
    return status;
}

// Motion capture in BVH (Biovision): a hierarchy of joints with their channels, then a row of numbers for each frame. Each
// joint becomes a curve of poses in the frame of its parent.

typedef struct bvh_joint
{
    double offset[3];
    char channels[6]; ///< X, Y, Z: positions in place of the offset; x, y, z: rotations about the moving axes
    size_t count;
} bvh_joint;

typedef struct bvh_file
{
    const char *at, *end;
    size_t line;
    bvh_joint *joints;
    size_t count, capacity, width; ///< joints, and numbers of a frame
} bvh_file;

/// The next word; empty at the end.
static csv_field next_word(bvh_file *file)
{
    for (; file->at < file->end && (unsigned char)*file->at <= ' '; file->at++)
        file->line += *file->at == '\n';
    csv_field word = {file->at, file->at};
    while (file->at < file->end && (unsigned char)*file->at > ' ')
        word.end = ++file->at;
    return word;
}

static bool is_word(csv_field word, const char *text)
{
    return (size_t)(word.end - word.begin) == strlen(text) && memcmp(word.begin, text, strlen(text)) == 0;
}

/// A number, or NaN.
static double next_number(bvh_file *file)
{
    double value;
    csv_field word = next_word(file);
    return word.begin < word.end && number_read(word.begin, word.end, &value) == NULL ? value : NAN;
}

/// The joints, up to the word MOTION. Returns an error text, or null.
static const char *read_joints(bvh_file *file)
{
    bvh_joint site = {.count = 0}, *joint = &site; // where offsets and channels go
    for (csv_field word = next_word(file); !is_word(word, "MOTION"); word = next_word(file))
    {
        if (word.begin == word.end)
            return "the file ends before the word MOTION";
        bool begins = is_word(word, "ROOT") || is_word(word, "JOINT");
        if (begins && !ARRAY_ADD(file->joints, file->capacity, file->count, (bvh_joint){.count = 0}))
            return "out of memory";
        joint = begins ? &file->joints[file->count - 1] : is_word(word, "Site") ? &site : joint;
        for (size_t i = 0; i < 3 && is_word(word, "OFFSET"); i++)
            joint->offset[i] = next_number(file);
        double wanted = is_word(word, "CHANNELS") ? next_number(file) : 0;
        if (!(wanted >= 0 && wanted <= 6 && isfinite(joint->offset[0] + joint->offset[1] + joint->offset[2])) ||
            (wanted > 0 && joint->count > 0))
            return "a joint has three numbers of its offset and up to 6 channels";
        for (; joint->count < (size_t)wanted; file->width++)
        {
            csv_field name = next_word(file);
            bool good = name.end - name.begin == 9 && *name.begin >= 'X' && *name.begin <= 'Z';
            if (!good || (name.begin[1] != 'p' && name.begin[1] != 'r'))
                return "a channel is a position or a rotation, as Xposition or Zrotation";
            joint->channels[joint->count++] = (char)(*name.begin + (name.begin[1] == 'r' ? 'x' - 'X' : 0));
        }
    }
    return site.count > 0 ? "an end site has no channels" : NULL;
}

static void write_pose(pose_translation *work, double time, const bvh_joint *joint, const double *numbers)
{
    double place[3], q[4] = {1, 0, 0, 0}, before[4], turn[3] = {0};
    memcpy(place, joint->offset, sizeof place);
    for (size_t i = 0; i < joint->count; i++)
    {
        bool turns = joint->channels[i] >= 'x';
        size_t axis = (size_t)(joint->channels[i] - (turns ? 'x' : 'X'));
        (turns ? turn : place)[axis] = numbers[i] * (turns ? ANGLE_DEGREE : 1);
        memcpy(before, q, sizeof q);
        quaternion_turn(before, turn[0], turn[1], turn[2], q);
        turn[axis] = 0;
    }
    pose_write_row(work, time, place, q);
}

static bat_status pose_translate_bvh(pose_translation *work, bat_error *error)
{
    bvh_file file = {.at = work->source->data, .end = work->source->data + work->source->size, .line = 1};
    const char *fault = read_joints(&file);
    double frames = 0, step = 0, *numbers = NULL;
    if (fault == NULL && !(is_word(next_word(&file), "Frames:") && (frames = next_number(&file)) >= 1 && frames < 1e9))
        fault = "after MOTION comes 'Frames:' with their number";
    if (fault == NULL &&
        !(is_word(next_word(&file), "Frame") && is_word(next_word(&file), "Time:") && (step = next_number(&file)) > 0))
        fault = "after the number of frames comes 'Frame Time:' with a number above 0";
    // A number takes two bytes at least.
    size_t wanted = fault == NULL ? (size_t)frames * file.width : 0;
    if (fault == NULL && (file.width == 0 || wanted > (size_t)(file.end - file.at)))
        fault = "there are fewer numbers than the joints have in all frames";
    if (fault == NULL && (numbers = memory_array(wanted, sizeof *numbers)) == NULL)
        fault = "out of memory";
    for (size_t i = 0; i < wanted && fault == NULL; i++)
        if (!isfinite(numbers[i] = next_number(&file)))
            fault = "a frame has a number for each channel";
    csv_field rest = fault == NULL ? next_word(&file) : (csv_field){file.end, file.end};
    if (rest.begin < rest.end)
        fault = "the frames go on after the number of them that 'Frames:' gives";
    text_append_string(&work->text, "# space: rigid\ntime tx ty tz qx qy qz qw\n");
    for (size_t j = 0, at = 0; j < file.count && fault == NULL; at += file.joints[j++].count)
    {
        text_append_string(&work->text, j > 0 ? "\n" : "");
        for (size_t i = 0; i < (size_t)frames; i++)
            write_pose(work, (double)i * step, &file.joints[j], numbers + i * file.width + at);
    }
    pose_note(work, "BVH: %zu joints, each a curve of poses in its parent's frame, in the file's order", file.count);
    work->reader = work->format = BAT_CURVE_FORMAT_CSV;
    free(file.joints);
    free(numbers);
    return fault == NULL ? BAT_OK : ERROR_FILE(error, file.line, "%s", fault);
}

// Any text

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
