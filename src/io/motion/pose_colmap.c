#include "io/motion/pose_translation.h"

#include "space/quaternion.h"

/// @file
/// The images of a reconstruction by COLMAP, images.txt: two lines for each, of which the first has the rotation and the
/// translation from the world to the camera, and the name of the image.

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

bat_status pose_translate_colmap(pose_translation *work, bat_error *error)
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
