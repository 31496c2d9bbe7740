#include "batten/motion.h"
#include "io/motion/pose_translation.h"

#include <math.h>

/// @file
/// KITTI's rows of matrices.

/// The distance that is worth a note.
static const double MATRIX_ROUNDING = 1e-6;

double pose_matrix_deviation(const double *row, double *quaternion)
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

bat_status pose_translate_kitti(pose_translation *work, bat_error *error)
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
