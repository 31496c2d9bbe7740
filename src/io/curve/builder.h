#ifndef IO_CURVE_BUILDER_H
#define IO_CURVE_BUILDER_H

#include "batten/curve_file.h"

/// Collects the points of curves, one after the other, while a file is read.
typedef struct curve_builder
{
    bat_space space;
    bool project; ///< move points onto the space instead of refusing them
    bool check;   ///< whether points are checked at all; false where they are in the space by construction

    bat_curve *curves; ///< those that are complete
    size_t curve_count, curve_capacity;

    double *points; ///< of the curve that is being read
    size_t point_count, point_capacity;
    double *channels;
    size_t channel_count, channel_capacity; ///< per point; in doubles

    size_t *lines; ///< of all points of all curves; null when never given
    size_t line_count, line_capacity;
} curve_builder;

/// Room for one more point of the current curve with `channel_count` channels, which is the same for all points of a curve;
/// null when out of memory. The caller fills `point`, `*channels` and then calls builder_admit().
double *builder_next(curve_builder *builder, size_t channel_count, double **channels);

/// Check or project the point that builder_next() gave room for and count it. Null when it is good, else why not.
const char *builder_admit(curve_builder *builder);

/// Remember the line of the last point. False when out of memory.
bool builder_line(curve_builder *builder, size_t line);

/// Give the quaternions of the current curve, where its points have any, the signs that are nearest to the ones before: q
/// and -q are the same rotation.
void builder_continue_signs(curve_builder *builder);

/// Whether the last point of the current curve repeats the first, channels included, but not the sign of a quaternion.
bool builder_returns(const curve_builder *builder);
/// Take the last point back.
void builder_drop_last(curve_builder *builder);

/// Complete the current curve, if it has points. False when out of memory.
bool builder_end_curve(curve_builder *builder, bool closed);

/// Move the curves of `other` behind those of `builder`. False when out of memory.
bool builder_append(curve_builder *builder, curve_builder *other);

/// Make a set of what was collected; it takes one ownership of the attributes, also on failure. The builder is empty then.
bat_status builder_finish(curve_builder *builder, bat_curve_attributes *attributes, bat_curve_set *set, bat_error *error);

void builder_free(curve_builder *builder);

#endif
