#pragma once

#include "batten/curve_file.h"
#include "curve/map/arc_refine.h"
#include "io/common/block_writer.h"

/// @file
/// Construction of curves from the points of a file.

/// The curves of a file during reading.
typedef struct curve_builder
{
    bat_space space;
    bool project; ///< project points onto the space instead of refusing them
    bool check;   ///< whether to check points; false for points that are valid by construction

    bat_curve *curves; ///< the complete curves
    size_t curve_count, curve_capacity;

    double *points; ///< the current curve
    size_t point_count, point_capacity;
    double *channels;
    size_t channel_count, channel_capacity; ///< per point; the capacity in doubles

    unsigned char *corners; ///< flags of the current curve; null without them
    size_t corner_capacity;

    bool strict;         ///< repeated points are errors
    size_t repeats;      ///< repeated points that builder_drop_repeat() dropped
    size_t first_repeat; ///< the line of the first, or 0

    size_t *lines; ///< for all points of all curves; null when no lines are given
    size_t line_count, line_capacity;
} curve_builder;

/// Add a point with `channel_count` channels to the current curve; all points of a curve have the same number. The caller
/// sets the point and `*channels` and then calls builder_admit(). Null when out of memory.
double *builder_next(curve_builder *builder, size_t channel_count, double **channels);

/// Check or project the point of builder_next() and count it. Returns null, or an error text.
const char *builder_admit(curve_builder *builder);
/// Name the option that leads out of an error about a point that builder_admit() has not taken. Returns the status.
bat_status builder_refuse(const curve_builder *builder, bat_status status, bat_error *error);

/// Store whether the last point of builder_next() is a corner; for all points of a file or none. False: out of memory.
bool builder_corner(curve_builder *builder, bool corner);

/// Store the line of the last point. False when out of memory.
bool builder_line(curve_builder *builder, size_t line);

/// Choose the signs of the current curve's quaternions, so that each is nearest to its predecessor; but where `told`,
/// rotations about half a turn apart keep their signs to each other, which tell the way.
void builder_continue_signs(curve_builder *builder, bool told);

/// Whether the last point of the current curve equals the first, with its channels, but up to the sign of a quaternion.
bool builder_returns(const curve_builder *builder);
/// Remove the last point. If it was a corner, so is the first, which it repeats.
void builder_drop_last(curve_builder *builder);

/// Drop the last point if it equals the one before it, or, with `at_end`, the first one of a closed curve; channels do not
/// count. A dropped corner makes the other point one. Null when nothing is wrong, also after dropping; an error text when
/// `strict`. Sets whether the point was dropped.
const char *builder_drop_repeat(curve_builder *builder, bool at_end, bool *dropped);
/// Tell how many points were dropped. False when out of memory.
bool builder_note_repeats(const curve_builder *builder, bat_curve_attributes *attributes);

/// Complete the current curve, if it has points. False when out of memory.
bool builder_end_curve(curve_builder *builder, bool closed);

bool builder_append(curve_builder *builder, curve_builder *other);

/// Make a curve set. It takes one ownership of the attributes, also on failure. The builder is empty afterwards.
bat_status builder_finish(curve_builder *builder, bat_curve_attributes *attributes, bat_curve_set *set, bat_error *error);

void builder_free(curve_builder *builder);

// Output of curve sets as rows of text.

/// A part of a curve: its points begin, …, end - 1.
typedef struct row_span
{
    const bat_curve *curve;
    size_t curve_index;
    size_t first_row; ///< of the curve, counted over the set
    size_t begin, end;
} row_span;

/// Append the text of a span.
typedef bat_status row_format(const void *context, const row_span *span, text_buffer *text, bat_error *error);

/// Write all points of a set, in blocks of equal size that several threads format.
bat_status rows_write(const bat_curve_set *set, text_sink *sink, int threads, row_format *format, const void *context,
                      bat_error *error);

/// BAT_INVALID_POINT for the point `point` of a span, which is not finite.
bat_status row_not_finite(const row_span *span, size_t point, bat_error *error);
