#include "io/curve/stitch.h"

#include "base/bisect.h"
#include "curve/polygon.h"
#include "io/common/number_text.h"
#include "linalg/vector.h"
#include "space/degrees.h"

static const double HALF_TURN = 180.0, TURN = 360.0, QUARTER_TURN = 90.0;

/// Degrees from the seam or a pole that count as on it: 0.1 mm on the Earth.
static const double NEAR_SEAM = 1e-9;

/// The decimals of a number in the shortest text that identifies it; 0 for a multiple of ten.
static int decimals_of(double number)
{
    char text[NUMBER_TEXT_SIZE + 1];
    *number_write(text, number) = '\0';
    const char *point = strchr(text, '.'), *exponent = strpbrk(text, "eE");
    size_t digits = point == NULL ? 0 : exponent != NULL ? (size_t)(exponent - point) - 1 : strlen(point) - 1;
    long shift = exponent != NULL ? strtol(exponent + 1, NULL, 10) : 0;
    long decimals = (long)digits - shift;
    return decimals > 0 ? (int)decimals : 0;
}

stitch_tolerance stitch_tolerance_of(const double *degrees, size_t count)
{
    int decimals = 0;
    for (size_t i = 0; i < 2 * count; i++)
    {
        int each = decimals_of(degrees[i]);
        decimals = each > decimals ? each : decimals;
    }
    // 1.5 units of the last decimal, at most 1e-7 degrees. At least 1e-9 degrees between latitudes (0.1 mm on the Earth), as
    // the two sides of a cut often differ in the last digits of a double; at least 1e-11 degrees from a great circle.
    static const double UNITS = 1.5, MOST = 1e-7, MIN_OFFSET = 1e-11;
    double rounding = UNITS * pow(10.0, -decimals);
    rounding = rounding < MOST ? rounding : MOST;
    return (stitch_tolerance){.latitude = rounding > NEAR_SEAM ? rounding : NEAR_SEAM,
                              .offset = rounding > MIN_OFFSET ? rounding : MIN_OFFSET};
}

stitch_seam stitch_seam_of(const double *degrees, size_t count)
{
    // Where longitudes exceed 180 degrees, the map is cut at 0 degrees.
    for (size_t i = 0; i < count; i++)
        if (fabs(degrees[2 * i]) > HALF_TURN + NEAR_SEAM)
            return (stitch_seam){0.0, NEAR_SEAM};
    return (stitch_seam){HALF_TURN, NEAR_SEAM};
}

bool stitch_on_seam(const stitch_seam *seam, double longitude)
{
    return fabs(remainder(longitude - seam->longitude, TURN)) <= seam->near;
}

int stitch_pole(const stitch_seam *seam, double latitude)
{
    return latitude >= QUARTER_TURN - seam->near ? 1 : latitude <= seam->near - QUARTER_TURN ? -1 : 0;
}

bool stitch_concerns(const double *degrees, size_t count)
{
    const stitch_seam seam = stitch_seam_of(degrees, count);
    for (size_t i = 0; i < count; i++)
        if (stitch_on_seam(&seam, degrees[2 * i]) || stitch_pole(&seam, degrees[2 * i + 1]) != 0)
            return true;
    return false;
}

void stitch_report_add(stitch_report *sum, const stitch_report *part)
{
    sum->joined += part->joined;
    sum->joins += part->joins;
    sum->poles += part->poles;
    sum->removed += part->removed;
    sum->unrepresented += part->unrepresented;
}

void stitch_geometry_free(stitch_geometry *geometry)
{
    curves_free(geometry->curves, geometry->count);
    free(geometry->origins);
    free(geometry->polygons);
    *geometry = (stitch_geometry){0};
}

static void point_of(const stitch_vertex *vertex, double point[3])
{
    if (vertex->share > 0)
        degrees_to_point(vertex->longitude, vertex->latitude, point);
    else
        memcpy(point, vertex->curve->points + 3 * vertex->point, 3 * sizeof *point);
}

static bool same_point(const stitch_vertex *a, const stitch_vertex *b)
{
    double p[3], q[3];
    point_of(a, p);
    point_of(b, q);
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/// Make one vertex of neighbours at the same point. It is a junction only if both are.
static void merge_repeated(stitch_path *path, bool closed)
{
    size_t count = 0;
    for (size_t i = 0; i < path->count; i++)
    {
        stitch_vertex *last = count > 0 ? &path->vertices[count - 1] : NULL;
        if (last != NULL && same_point(last, &path->vertices[i]))
            last->junction = last->junction && path->vertices[i].junction;
        else
            path->vertices[count++] = path->vertices[i];
    }
    for (; closed && count > 1 && same_point(&path->vertices[0], &path->vertices[count - 1]); count--)
        path->vertices[0].junction = path->vertices[0].junction && path->vertices[count - 1].junction;
    path->count = count;
}

/// Whether a junction lies on the great circle or parallel between its neighbours, which are on different sides of the seam.
/// The writer never cuts an edge of almost 180 degrees, whose great circle rounding decides.
static bool is_between(const stitch_vertex *before, const stitch_vertex *vertex, const stitch_vertex *after,
                       const stitch_tolerance *tolerance)
{
    static const double RADIAN = 57.295779513082320876798154814105, COSINE_OF_179_DEGREES = -0.99984769515639124;
    double p[3], c[3], q[3];
    point_of(before, p);
    point_of(vertex, c);
    point_of(after, q);
    if (!(p[1] * q[1] < 0) || vector3_dot(p, q) < COSINE_OF_179_DEGREES || vector3_dot(p, c) + vector3_dot(c, q) < 0)
        return false;
    double highest = fmax(fmax(before->latitude, vertex->latitude), after->latitude);
    double lowest = fmin(fmin(before->latitude, vertex->latitude), after->latitude);
    if (highest - lowest <= tolerance->latitude && 360 - fabs(before->longitude - after->longitude) > 1)
        return true;
    const double normal[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    const double from_p[3] = {c[0] - p[0], c[1] - p[1], c[2] - p[2]};
    return fabs(vector3_dot(normal, from_p)) <= tolerance->offset / RADIAN * sqrt(vector3_dot(normal, normal));
}

static size_t remove_junctions(stitch_path *path, bool closed, const stitch_tolerance *tolerance)
{
    size_t given = path->count, count = 0, least = closed ? 3 : 2;
    stitch_vertex *vertices = path->vertices;
    for (size_t i = 0; i < given; i++)
    {
        bool inner = closed || (i > 0 && i + 1 < given);
        if (vertices[i].junction && inner && count + given - i > least)
        {
            // Vertex 0 has not moved yet, or is the next one of the last.
            const stitch_vertex *before = count > 0 ? &vertices[count - 1] : &vertices[given - 1];
            const stitch_vertex *after = &vertices[i + 1 < given ? i + 1 : 0];
            if (is_between(before, &vertices[i], after, tolerance))
                continue;
        }
        vertices[count++] = vertices[i];
    }
    path->count = count;
    return given - count;
}

static void channels_of(const stitch_vertex *vertex, double *channels)
{
    const bat_curve *curve = vertex->curve;
    size_t next = vertex->point + 1 < curve->count ? vertex->point + 1 : 0;
    const double *here = curve->channels + vertex->point * curve->channel_count;
    const double *there = curve->channels + next * curve->channel_count;
    for (size_t k = 0; k < curve->channel_count; k++)
        channels[k] = vertex->share > 0 ? here[k] + vertex->share * (there[k] - here[k]) : here[k];
}

bool stitch_make_curve(stitch_path *path, bool closed, const stitch_tolerance *tolerance, size_t *removed, bat_curve *curve)
{
    merge_repeated(path, closed);
    *removed += remove_junctions(path, closed, tolerance);
    const bat_curve *first = path->vertices[0].curve;
    size_t channels = first->channel_count;
    bat_curve made;
    if (curve_room(first, path->count, false, &made, NULL) != BAT_OK)
    {
        bat_curve_free(&made);
        return false;
    }
    made.closed = closed;
    for (size_t i = 0; i < path->count; i++)
    {
        point_of(&path->vertices[i], made.points + 3 * i);
        if (channels > 0)
            channels_of(&path->vertices[i], made.channels + i * channels);
    }
    *curve = made;
    return true;
}

// Lines that were cut at the antimeridian, joined again.

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

DEFINE_ORDER(compare_ends, line_end, latitude, line)

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
        BISECT(low, high, middle, starts[middle].latitude < end[1] - job->tolerance->latitude)
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
    static const int RING_POSITIONS = 4;
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

DEFINE_ORDER(compare_origins, stitch_origin, part, ring)

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
    curves_free(geometry->curves, geometry->count);
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
