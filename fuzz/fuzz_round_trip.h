#ifndef FUZZ_ROUND_TRIP_H
#define FUZZ_ROUND_TRIP_H

#include "promise.h"

#include "batten/curve_file.h"

#include <stdlib.h>
#include <string.h>

static inline bool has_note(const bat_curve_set *set, const char *words)
{
    const char *note;
    for (size_t i = 0; (note = bat_curve_set_note(set, i)) != NULL; i++)
        if (strstr(note, words) != NULL)
            return true;
    return false;
}

/// Whether points were dropped, or curves left out. The only cell that made a column one of texts can be gone with one.
static inline bool has_dropped(const bat_curve_set *set)
{
    return has_note(set, "dropped") || has_note(set, "left out");
}

/// Whether curves have the same shape after a file. Where degrees are rounded, neighbours can become one point, so that the
/// counts may change; then only check that there are curves.
static inline void compare_counts(const bat_curve_set *before, const bat_curve_set *after, bool may_change)
{
    PROMISE(after->count > 0);
    if (may_change)
        return;
    PROMISE(after->count == before->count);
    for (size_t i = 0; i < before->count; i++)
    {
        PROMISE(after->curves[i].count == before->curves[i].count);
        PROMISE(after->curves[i].closed == before->curves[i].closed);
        // Without the row that closed the curve, a column can have running numbers.
        PROMISE(has_dropped(before) || has_note(after, "holds running numbers") ||
                after->curves[i].channel_count == before->curves[i].channel_count);
    }
}

/// Read a text in a format; what is read can be written, and what is written can be read again.
static inline void round_trip(const uint8_t *data, size_t size, bat_curve_format format, const char *space, bool project)
{
    bat_curve_read_options reading = bat_curve_read_defaults();
    reading.format = format;
    reading.space = space;
    reading.project = project;
    reading.threads = 1;
    bat_curve_set set = {0};
    bat_error error = {0};
    bat_status status = bat_curve_read_memory((const char *)data, size, &reading, &set, &error);
    PROMISE(status == error.status);
    if (status != BAT_OK)
        return;
    bat_curve_write_options writing = bat_curve_write_defaults();
    writing.threads = 1;
    char *text = NULL;
    size_t text_size = 0;
    status = bat_curve_write_memory(&set, &writing, &text, &text_size, &error);
    if (status == BAT_OK)
    {
        bat_curve_set back = {0};
        bool rounded = format != BAT_CURVE_FORMAT_OBJ && set.space->point_dim == 3;
        status = bat_curve_read_memory(text, text_size, &reading, &back, &error);
        // Curves shorter than the rounding are no lines any more.
        bool vanished = rounded && status == BAT_BAD_FILE && strstr(error.text, "no lines or polygons") != NULL;
        // Where only a dropped row had a text in it, a column is one of numbers afterwards, and its name may say times.
        bool retyped = has_dropped(&set) && status == BAT_BAD_FILE && strstr(error.text, "does not come after") != NULL;
        PROMISE(status == BAT_OK || vanished || retyped);
        if (status == BAT_OK)
            compare_counts(&set, &back, rounded);
        free(text);
        bat_curve_set_free(&back);
    }
    else
        PROMISE(status == BAT_UNSUPPORTED);
    bat_curve_set_free(&set);
}

#endif
