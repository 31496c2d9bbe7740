#include "io/motion/pose_translation.h"

#include "space/quaternion.h"

/// @file
/// Motion capture in BVH (Biovision): a hierarchy of joints with their channels, then a row of numbers for each frame. Each
/// joint becomes a curve of poses in the frame of its parent.

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

bat_status pose_translate_bvh(pose_translation *work, bat_error *error)
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
