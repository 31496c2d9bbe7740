#include "io/curve/stitch_seam.h"

#include "base/array_grow.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Lines that were cut at the antimeridian, joined again.

/// The lines of a geometry during joining.
typedef struct line_job
{
    const stitch_geometry *geometry;
    const double *degrees;
    const stitch_tolerance *tolerance;
    stitch_seam seam;
    size_t *begins; ///< the index of each line's first point; one more for the end
    size_t *next;   ///< the line that continues each one; itself for a line that closes; BAT_NO_INDEX
    bool *follows;  ///< whether a line continues another one
} line_job;

/// Whether two positions are one point of the seam, on different sides of the map.
static bool meets(const line_job *job, size_t end, size_t begin)
{
    static const double TURN = 360.0;
    const double *a = job->degrees + 2 * end, *b = job->degrees + 2 * begin;
    return stitch_on_seam(&job->seam, a[0]) && fabs(fabs(a[0] - b[0]) - TURN) <= 2 * job->seam.near &&
           fabs(a[1] - b[1]) <= job->tolerance->latitude;
}

static bool line_meets(const line_job *job, size_t line, size_t other)
{
    return meets(job, job->begins[line + 1] - 1, job->begins[other]);
}

typedef struct line_end
{
    double latitude;
    size_t line;
} line_end;

static int compare_ends(const void *a, const void *b)
{
    const line_end *p = a, *q = b;
    if (p->latitude != q->latitude)
        return p->latitude < q->latitude ? -1 : 1;
    return (p->line > q->line) - (p->line < q->line);
}

/// Join a line to the next one of the file where they meet, else to the first line that it meets.
static bool find_joins(line_job *job)
{
    size_t count = job->geometry->count, begin_count = 0;
    for (size_t i = 0; i + 1 < count; i++)
        if (line_meets(job, i, i + 1))
        {
            job->next[i] = i + 1;
            job->follows[i + 1] = true;
        }
    line_end *starts = memory_array(count, sizeof *starts);
    if (starts == NULL)
        return false;
    for (size_t i = 0; i < count; i++)
        if (!job->follows[i] && stitch_on_seam(&job->seam, job->degrees[2 * job->begins[i]]))
            starts[begin_count++] = (line_end){job->degrees[2 * job->begins[i] + 1], i};
    qsort(starts, begin_count, sizeof *starts, compare_ends);
    for (size_t i = 0; i < count; i++)
    {
        if (job->next[i] != BAT_NO_INDEX)
            continue;
        const double *end = job->degrees + 2 * (job->begins[i + 1] - 1);
        size_t low = 0, high = begin_count;
        while (low < high)
        {
            size_t middle = low + (high - low) / 2;
            if (starts[middle].latitude < end[1] - job->tolerance->latitude)
                low = middle + 1;
            else
                high = middle;
        }
        for (; low < begin_count && starts[low].latitude <= end[1] + job->tolerance->latitude; low++)
        {
            size_t other = starts[low].line;
            if (job->follows[other] || other == i || !line_meets(job, i, other))
                continue;
            job->next[i] = other;
            job->follows[other] = true;
            break;
        }
    }
    free(starts);
    return true;
}

static bool add_line(const line_job *job, size_t line, bool continues, stitch_path *path)
{
    const bat_curve *curve = &job->geometry->curves[line];
    for (size_t i = 0; i < curve->count; i++)
    {
        const double *degrees = job->degrees + 2 * (job->begins[line] + i);
        const stitch_vertex vertex = {
            .curve = curve, .point = i, .longitude = degrees[0], .latitude = degrees[1], .junction = continues && i == 0};
        // The end of the line before is the same point, up to the last digits.
        if (vertex.junction)
            path->count--;
        if (!ARRAY_ADD(path->vertices, path->capacity, path->count, vertex))
            return false;
    }
    return true;
}

/// Follow the joins from a line. Sets whether they lead back to it, and the number of lines.
static bool trace_line(const line_job *job, size_t first, bool *used, bool *returns, size_t *lines, stitch_path *path)
{
    path->count = 0;
    *lines = 0;
    *returns = false;
    for (size_t line = first;; line = job->next[line])
    {
        used[line] = true;
        if (!add_line(job, line, ++*lines > 1, path))
            return false;
        if (job->next[line] == BAT_NO_INDEX)
            return true;
        *returns = job->next[line] == first;
        if (*returns)
            return true;
    }
}

/// Make the curve that begins with a line. An unchanged line is taken as it is, and the given one left empty.
static bool make_line(const line_job *job, size_t first, bool close, bool *used, stitch_path *path, stitch_report *report,
                      bat_curve *made)
{
    enum
    {
        RING_POSITIONS = 4
    };
    bool returns;
    size_t lines;
    if (!trace_line(job, first, used, &returns, &lines, path))
        return false;
    bool meets_itself =
        lines == 1 && path->count >= RING_POSITIONS && meets(job, job->begins[first + 1] - 1, job->begins[first]);
    bool closed = close && path->count >= RING_POSITIONS && (returns || meets_itself);
    if (lines == 1 && !closed)
    {
        *made = (bat_curve){0};
        return true;
    }
    if (closed)
    {
        path->count--;
        path->vertices[0].junction = true;
    }
    report->joined += lines - 1;
    report->joins += lines > 1;
    return stitch_make_curve(path, closed, job->tolerance, &report->removed, made);
}

/// Make all curves into `made`; those that stay are empty there.
static bool make_lines(const line_job *job, bool close, stitch_geometry *made, stitch_report *report)
{
    size_t count = job->geometry->count;
    bool *used = calloc(count, sizeof *used);
    stitch_path path = {0};
    bool done = used != NULL;
    // Lines that continue none come first: what is left then are cycles.
    for (int cycles = 0; cycles < 2 && done; cycles++)
        for (size_t i = 0; i < count && done; i++)
        {
            if (used[i] || (job->follows[i] && cycles == 0))
                continue;
            done = make_line(job, i, close, used, &path, report, &made->curves[made->count]);
            made->origins[made->count] = (stitch_origin){.part = i};
            made->count += done;
        }
    free(path.vertices);
    free(used);
    return done;
}

static int compare_origins(const void *a, const void *b)
{
    const stitch_origin *p = a, *q = b;
    return (p->part > q->part) - (p->part < q->part);
}

/// Order the curves by their first lines, and take over the lines that did not change.
static bool replace(stitch_geometry *geometry, stitch_geometry *made)
{
    bat_curve *curves = calloc(geometry->count, sizeof *curves);
    bat_curve *by_line = curves;
    if (curves == NULL)
        return false;
    for (size_t i = 0; i < made->count; i++)
    {
        bat_curve *curve = &made->curves[i], *given = &geometry->curves[made->origins[i].part];
        by_line[made->origins[i].part] = curve->points != NULL ? *curve : *given;
        if (curve->points == NULL)
            *given = (bat_curve){0};
    }
    qsort(made->origins, made->count, sizeof *made->origins, compare_origins);
    for (size_t i = 0; i < made->count; i++)
    {
        size_t line = made->origins[i].part;
        curves[i] = curves[line];
        made->origins[i] = geometry->origins[line];
    }
    for (size_t i = 0; i < geometry->count; i++)
        bat_curve_free(&geometry->curves[i]);
    free(geometry->curves);
    free(geometry->origins);
    free(made->curves);
    geometry->curves = curves;
    geometry->origins = made->origins;
    geometry->count = made->count;
    return true;
}

bool stitch_lines(stitch_geometry *geometry, const double *degrees, const stitch_tolerance *tolerance, bool close,
                  stitch_report *report)
{
    size_t count = geometry->count;
    line_job job = {geometry,
                    degrees,
                    tolerance,
                    .begins = memory_array(count + 1, sizeof *job.begins),
                    .next = memory_array(count, sizeof *job.next),
                    .follows = calloc(count + 1, sizeof *job.follows)};
    stitch_geometry made = {.curves = calloc(count + 1, sizeof *made.curves),
                            .origins = memory_array(count, sizeof *made.origins)};
    bool done = job.begins != NULL && job.next != NULL && job.follows != NULL && made.curves != NULL && made.origins != NULL;
    stitch_report found = {0};
    if (done)
    {
        job.begins[0] = 0;
        for (size_t i = 0; i < count; i++)
        {
            job.begins[i + 1] = job.begins[i] + geometry->curves[i].count;
            job.next[i] = BAT_NO_INDEX;
        }
        job.seam = stitch_seam_of(degrees, job.begins[count]);
        done = find_joins(&job) && make_lines(&job, close, &made, &found) && replace(geometry, &made);
    }
    if (done)
        *report = found;
    else
        stitch_geometry_free(&made);
    free(job.begins);
    free(job.next);
    free(job.follows);
    return done;
}
