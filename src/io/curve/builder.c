#include "io/curve/builder.h"

#include "base/bisect.h"
#include "base/error.h"
#include "curve/curve_attributes.h"
#include "curve/polygon.h"
#include "linalg/vector.h"

/// @file
/// Points and channels of curves, appended one by one and checked against their space.

double *builder_next(curve_builder *builder, size_t channel_count, double **channels)
{
    size_t dim = builder->space.point_dim;
    size_t count = builder->point_count + 1;
    size_t point_values, channel_values;
    if (size_multiply_overflows(count, dim, &point_values) ||
        size_multiply_overflows(count, channel_count, &channel_values) ||
        !ARRAY_GROW(builder->points, builder->point_capacity, point_values) ||
        !ARRAY_GROW(builder->channels, builder->channel_capacity, channel_values))
        return NULL;
    builder->channel_count = channel_count;
    if (channel_count > 0)
        *channels = builder->channels + (count - 1) * channel_count;
    return builder->points + (count - 1) * dim;
}

const char *builder_admit(curve_builder *builder)
{
    size_t dim = builder->space.point_dim;
    double *point = builder->points + builder->point_count * dim;
    if (builder->check)
    {
        const char *fault = builder->space.fault(&builder->space, point);
        if (fault != NULL && builder->project)
        {
            double coordinates[BAT_SPACE_MAX_DIM];
            memcpy(coordinates, point, dim * sizeof *point);
            if (builder->space.project(&builder->space, coordinates, point) == BAT_OK)
                fault = builder->space.fault(&builder->space, point);
        }
        if (fault != NULL)
            return fault;
    }
    builder->point_count++;
    return NULL;
}

bat_status builder_refuse(const curve_builder *builder, bat_status status, bat_error *error)
{
    const bat_space *space = &builder->space;
    double point[BAT_SPACE_MAX_DIM];
    bool helps = !builder->project &&
                 space->project(space, builder->points + builder->point_count * space->point_dim, point) == BAT_OK &&
                 space->fault(space, point) == NULL;
    return helps ? error_remedy(error, status, "project", "moves points onto the space") : status;
}

bool builder_corner(curve_builder *builder, bool corner)
{
    if (!ARRAY_GROW(builder->corners, builder->corner_capacity, builder->point_count + 1))
        return false;
    builder->corners[builder->point_count] = corner;
    return true;
}

bool builder_line(curve_builder *builder, size_t line)
{
    return ARRAY_ADD(builder->lines, builder->line_capacity, builder->line_count, line);
}

void builder_continue_signs(curve_builder *builder, bool told)
{
    size_t dim = builder->space.point_dim, place = quaternion_place(&builder->space);
    bool turned = false; // the point before
    for (size_t i = 1; place != BAT_NO_INDEX && i < builder->point_count; i++)
    {
        const double *before = builder->points + (i - 1) * dim + place;
        double *quaternion = builder->points + i * dim + place, product = vector_dot(4, before, quaternion);
        bool turns = told && fabs(product) < QUATERNION_ABOUT_HALF ? turned : product < 0;
        for (size_t c = 0; c < 4 && turns; c++)
            quaternion[c] = 0 - quaternion[c]; // avoids -0
        turned = turns;
    }
}

bool builder_returns(const curve_builder *builder)
{
    if (builder->point_count < 2)
        return false;
    size_t last = builder->point_count - 1, dim = builder->space.point_dim, channels = builder->channel_count;
    size_t quaternion = quaternion_place(&builder->space);
    const double *first_point = builder->points, *last_point = builder->points + last * dim;
    bool same = true, turned = quaternion != BAT_NO_INDEX;
    for (size_t i = 0; i < dim; i++)
    {
        same = same && first_point[i] == last_point[i];
        turned = turned && first_point[i] == (i < quaternion ? last_point[i] : -last_point[i]);
    }
    for (size_t i = 0; i < channels; i++)
        if (builder->channels[i] != builder->channels[last * channels + i])
            return false;
    return same || turned;
}

void builder_drop_last(curve_builder *builder)
{
    builder->point_count--;
    if (builder->corners != NULL && builder->corners[builder->point_count] != 0)
        builder->corners[0] = 1;
    if (builder->line_count > 0)
        builder->line_count--;
}

const char *builder_drop_repeat(curve_builder *builder, bool at_end, bool *dropped)
{
    size_t dim = builder->space.point_dim, last = builder->point_count - 1, other = at_end ? 0 : last - 1;
    *dropped = builder->point_count > 1 && points_equal(builder->points + last * dim, builder->points + other * dim, dim);
    if (!*dropped)
        return NULL;
    if (builder->strict)
        return at_end ? "the last point of the closed curve repeats the first" : "the point repeats the one before it";
    if (builder->repeats++ == 0)
        builder->first_repeat = builder->line_count > 0 ? builder->lines[builder->line_count - 1] : 0;
    if (builder->corners != NULL && builder->corners[last] != 0)
        builder->corners[other] = 1;
    builder->point_count--;
    if (builder->line_count > 0)
        builder->line_count--;
    return NULL;
}

bool builder_note_repeats(const curve_builder *builder, bat_curve_attributes *attributes)
{
    return builder->repeats == 0 ||
           attributes_note(attributes, "dropped %zu repeated point%s, the first on line %zu", builder->repeats,
                           builder->repeats == 1 ? "" : "s", builder->first_repeat);
}

/// Take `count` values out of the builder's array: a copy of a small one, or a large one itself. Null when out of memory.
static double *take_doubles(double **values, size_t *capacity, size_t count)
{
    static const int MANY = 1 << 16;
    double *taken;
    if (count < MANY)
    {
        taken = memory_array(count, sizeof *taken);
        return taken != NULL ? memcpy(taken, *values, count * sizeof *taken) : NULL;
    }
    taken = realloc(*values, count * sizeof *taken);
    if (taken == NULL)
        taken = *values;
    *values = NULL;
    *capacity = 0;
    return taken;
}

bool builder_end_curve(curve_builder *builder, bool closed)
{
    if (builder->point_count == 0)
        return true;
    bat_curve curve = {.count = builder->point_count, .closed = closed, .channel_count = builder->channel_count};
    if (!ARRAY_GROW(builder->curves, builder->curve_capacity, builder->curve_count + 1))
        return false;
    curve.points = take_doubles(&builder->points, &builder->point_capacity, curve.count * builder->space.point_dim);
    if (curve.points != NULL && curve.channel_count > 0)
        curve.channels = take_doubles(&builder->channels, &builder->channel_capacity, curve.count * curve.channel_count);
    if (curve.points != NULL && builder->corners != NULL)
    {
        curve.corners = memory_array(curve.count, 1);
        if (curve.corners != NULL)
            memcpy(curve.corners, builder->corners, curve.count);
    }
    if (curve.points == NULL || (curve.channel_count > 0 && curve.channels == NULL) ||
        (builder->corners != NULL && curve.corners == NULL))
    {
        bat_curve_free(&curve);
        return false;
    }
    builder->curves[builder->curve_count++] = curve;
    builder->point_count = 0;
    return true;
}

bool builder_append(curve_builder *builder, curve_builder *other)
{
    if (!ARRAY_GROW(builder->curves, builder->curve_capacity, builder->curve_count + other->curve_count))
        return false;
    if (other->curve_count > 0)
        memcpy(builder->curves + builder->curve_count, other->curves, other->curve_count * sizeof *other->curves);
    builder->curve_count += other->curve_count;
    other->curve_count = 0;
    return true;
}

bat_status builder_finish(curve_builder *builder, bat_curve_attributes *attributes, bat_curve_set *set, bat_error *error)
{
    bat_space *space = malloc(sizeof *space);
    if (space == NULL)
    {
        attributes_release(attributes);
        builder_free(builder);
        return error_memory(error, sizeof *space);
    }
    *space = builder->space;
    for (size_t i = 0; i < builder->curve_count; i++)
        builder->curves[i].space = space;
    *set = (bat_curve_set){.space = space,
                           .curves = builder->curves,
                           .count = builder->curve_count,
                           .attributes = attributes,
                           .lines = builder->lines};
    builder->curves = NULL;
    builder->curve_count = 0;
    builder->lines = NULL;
    builder_free(builder);
    return BAT_OK;
}

void builder_free(curve_builder *builder)
{
    curves_free(builder->curves, builder->curve_count);
    free(builder->points);
    free(builder->channels);
    free(builder->corners);
    free(builder->lines);
    *builder = (curve_builder){0};
}

// Rows of all curves of a set, formatted in blocks.

static const size_t ROWS_PER_BLOCK = 1 << 15;

/// The points of all curves of a set, partitioned into blocks of equal size.
typedef struct row_job
{
    const bat_curve_set *set;
    size_t *first_rows; ///< for each curve, then the number of all rows
    row_format *format;
    const void *context;
} row_job;

static bat_status format_block(const void *context, size_t block, text_buffer *text, bat_error *error)
{
    const row_job *job = context;
    const size_t *first_rows = job->first_rows;
    size_t row = block * ROWS_PER_BLOCK, last = first_rows[job->set->count];
    if (last - row > ROWS_PER_BLOCK)
        last = row + ROWS_PER_BLOCK;
    bat_status status = BAT_OK;
    for (size_t i = bisect_sizes(first_rows, 0, job->set->count, row); row < last && status == BAT_OK; i++)
    {
        size_t end = first_rows[i + 1] < last ? first_rows[i + 1] : last;
        row_span span = {&job->set->curves[i], i, first_rows[i], row - first_rows[i], end - first_rows[i]};
        status = job->format(job->context, &span, text, error);
        row = end;
    }
    return status;
}

bat_status rows_write(const bat_curve_set *set, text_sink *sink, int threads, row_format *format, const void *context,
                      bat_error *error)
{
    size_t *rows = memory_array(set->count + 1, sizeof *rows);
    if (rows == NULL)
        return error_memory(error, set->count * sizeof *rows);
    rows[0] = 0;
    for (size_t i = 0; i < set->count; i++)
        rows[i + 1] = rows[i] + set->curves[i].count;
    const row_job job = {set, rows, format, context};
    size_t blocks = (rows[set->count] + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK;
    bat_status status = blocks_write(sink, blocks, threads, format_block, &job, error);
    free(rows);
    return status;
}

bat_status row_not_finite(const row_span *span, size_t point, bat_error *error)
{
    return error_set(error, BAT_INVALID_POINT, point, 0, "point %zu of curve %zu is not finite", point, span->curve_index);
}
