#include "curve/map/arc_refine.h"

#include "base/error.h"
#include "base/threads.h"
#include "curve/refine.h"
#include "space/builtin.h"
#include "space/degrees.h"

bool chart_of_space(const bat_space *space, int decimals, map_chart *chart)
{
    *chart = (map_chart){.globe = space_is_sphere(space)};
    if (!chart->globe && !space_is_plane(space) && !space_is_disk(space))
        return false;
    chart->space = chart->globe ? bat_euclidean(2) : *space;
    if (chart->globe)
    {
        chart->units_per_degree = (double)degree_units_per_degree(decimals);
        chart->units_per_radian = degree_units_per_radian(decimals);
        chart->turn = 360 * chart->units_per_degree;
    }
    return true;
}

/// The longitude nearest to `near` that is the same up to whole turns.
static double nearest_longitude(const map_chart *chart, double longitude, double near)
{
    return longitude - chart->turn * rint((longitude - near) / chart->turn);
}

/// The chart of a point, near the longitude of the point before. A pole has the longitude of the point before.
static void chart_point(const map_chart *chart, const double *point, double near, double *flat)
{
    degree_units units = degrees_of_point(point, chart->units_per_radian);
    bool pole = fabs((double)units.latitude) == 90 * chart->units_per_degree;
    flat[0] = pole ? near : nearest_longitude(chart, (double)units.longitude, near);
    flat[1] = (double)units.latitude;
}

/// A longitude near which the chart of a curve begins: that of the first point off the poles.
static double first_longitude(const map_chart *chart, const bat_curve *curve)
{
    double flat[2] = {0, 0};
    for (size_t i = 0; i < curve->count; i++)
    {
        chart_point(chart, curve->points + 3 * i, 0, flat);
        if (fabs(flat[1]) < 90 * chart->units_per_degree)
            break;
    }
    return flat[0];
}

/// The chart of one curve, in room for one point more than it has.
static void chart_curve(const map_chart *chart, const bat_curve *curve, const bat_curve *coarse, const size_t *starts,
                        bat_curve *flat)
{
    size_t edges = polygon_edges(curve->count, curve->closed), next_kept = 0, kept_index = 0;
    size_t coarse_edges = coarse != NULL ? polygon_edges(coarse->count, coarse->closed) : 0;
    size_t step = coarse_edges > 0 ? edges / coarse_edges : 0;
    double near = first_longitude(chart, curve);
    for (size_t i = 0; i < curve->count; i++)
    {
        double *point = flat->points + 2 * i;
        if (coarse != NULL && i == next_kept)
        {
            memcpy(point, coarse->points + 2 * kept_index, 2 * sizeof *point);
            kept_index++;
            next_kept = kept_index < coarse->count ? (starts != NULL ? starts[kept_index] : kept_index * step) : SIZE_MAX;
        }
        else
            chart_point(chart, curve->points + 3 * i, near, point);
        near = point[0];
    }
    flat->count = curve->count;
    flat->closed = curve->closed;
    if (!curve->closed)
        return;
    double end = nearest_longitude(chart, flat->points[0], near);
    if (end == flat->points[0])
        return;
    flat->points[2 * flat->count] = end;
    flat->points[2 * flat->count + 1] = flat->points[1];
    flat->count++;
    flat->closed = false;
}

bat_status chart_curves_make(const map_chart *chart, const bat_curve *curves, size_t count, const chart_curves *coarse,
                             size_t *const *starts, int threads, chart_curves *charts, bat_error *error)
{
    (void)threads; // without OpenMP
    *charts = (chart_curves){.count = count, .curves = memory_array(count, sizeof *charts->curves)};
    if (charts->curves == NULL)
        return error_memory(error, count * sizeof *charts->curves);
    size_t room = 0;
    for (size_t i = 0; i < count; i++)
    {
        charts->curves[i] = curves[i];
        room += curves[i].count + 1;
    }
    if (!chart->globe)
        return BAT_OK;
    if (array_make(&charts->points, room, 2 * sizeof *charts->points, error) != BAT_OK)
        return BAT_NO_MEMORY;
    double *at = charts->points;
    for (size_t i = 0; i < count; i++)
    {
        charts->curves[i] = (bat_curve){.space = &chart->space, .points = at};
        at += 2 * (curves[i].count + 1);
    }
    static const double WORK = 100; // arithmetic operations for a point
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads_worth(threads, count, WORK *(double)room))
    for (size_t i = 0; i < count; i++)
        chart_curve(chart, &curves[i], coarse != NULL ? &coarse->curves[i] : NULL, starts != NULL ? starts[i] : NULL,
                    &charts->curves[i]);
    return BAT_OK;
}

void chart_curves_free(chart_curves *charts)
{
    free(charts->curves);
    free(charts->points);
    *charts = (chart_curves){0};
}

void chart_to_point(const map_chart *chart, const double *flat, double *point)
{
    degrees_to_point(nearest_longitude(chart, flat[0], 0) / chart->units_per_degree, flat[1] / chart->units_per_degree,
                     point);
}

void chart_move(const map_chart *chart, const bat_curve *coarse, bat_curve *fine, bat_curve *flat, size_t edge, size_t begin,
                size_t end, draw_move move)
{
    static const double SAME_CELL = 0.01; // of a unit: hardly ever rounds to another point than the start does
    const double *p = coarse->points + 2 * edge, *q = coarse->points + 2 * (edge + 1 == coarse->count ? 0 : edge + 1);
    for (size_t i = begin + 1; i < end; i++)
    {
        double share = (double)(i - begin) / (double)(end - begin), place[2], *point = fine->points + 3 * i;
        double reach = fmax(fabs(q[0] - p[0]), fabs(q[1] - p[1]));
        if (move == DRAW_TO_START)
            share *= fmin(1, SAME_CELL / reach);
        if (move == DRAW_TO_START || (reach < 1 && move == DRAW_ON_EDGE))
        {
            // The chart is too coarse: the points differ on the sphere alone.
            size_t last = end < fine->count ? end : 0;
            if (bat_space_geodesic(fine->space, fine->points + 3 * begin, fine->points + 3 * last, share, point) == BAT_OK)
                chart_point(chart, point, flat->points[2 * begin], flat->points + 2 * i);
            continue;
        }
        double across = hypot(point[0], point[1]);
        double now[2] = {atan2(point[1], point[0]) * chart->units_per_radian,
                         atan2(point[2], across) * chart->units_per_radian};
        now[0] = nearest_longitude(chart, now[0], flat->points[2 * i]);
        for (int c = 0; c < 2; c++)
        {
            double on_edge = p[c] + share * (q[c] - p[c]);
            place[c] = move == DRAW_HALF ? on_edge + (now[c] - on_edge) / 2 : on_edge;
        }
        chart_to_point(chart, place, point);
        chart_point(chart, point, place[0], flat->points + 2 * i);
    }
}

enum
{
    NEWTON_STEPS = 20,
    /// After so many rounds with crossings the call gives up.
    ROUNDS = 60
};

/// The relative error of an area that is promised, and that at which Newton's method ends.
#define AREA_PROMISE 1e-6
#define AREA_GOAL 1e-8
/// The share of the largest relative residual at which conjugate gradients end. Newton's steps do the rest; the system is
/// singular, so that going on to the last digit would only add what rounding makes inconsistent.
#define RESIDUAL_SHARE 1e-4
/// The area of a ring over the square of its points' distances from the middle, from which on it counts.
#define NO_AREA 1e-9
/// The largest t: an edge then bulges by its own length, and Newton's method has lost its way.
#define MAX_SHARE 1.0

/// The state of an arc.
typedef struct area_arc
{
    double *weights; ///< of each refined point: how far it moves for t = 1; 0 for given points
    double *given;   ///< the refined points before they are moved
    bool *crossing;  ///< of each refined edge: whether it crosses another before they are moved
    double gain;     ///< the area to the left of the arc that is lost for t = 1
    double share;    ///< t of this step
} area_arc;

typedef struct area_job
{
    const arc_graph *graph;
    const bat_curve *curves;
    size_t count, dim;
    bool sphere, keeps_points;
    refined_arcs *fine;
    area_arc *arcs;
    double *targets; ///< of each curve its area; NaN for open curves, and rings without an area but rounding
    double *areas;
    double *vectors;     ///< five of `count` numbers, for conjugate gradients
    size_t frozen;       ///< points that stay
    size_t straightened; ///< edges that became straight
    bool moved;          ///< whether the arcs are no longer as given
    const map_chart *chart;
    memory_pool pool; ///< of all arrays
} area_job;

/// The signed area of the triangle between a fixed point and an edge; on the sphere by Eriksson's formula.
static double triangle(const area_job *job, const double *fixed, const double *p, const double *q)
{
    if (!job->sphere)
        return ((p[0] - fixed[0]) * (q[1] - fixed[1]) - (p[1] - fixed[1]) * (q[0] - fixed[0])) / 2;
    // The determinant of the differences is that of the vectors, and accurate for small triangles.
    double to_p[3], to_q[3];
    for (int c = 0; c < 3; c++)
    {
        to_p[c] = p[c] - fixed[c];
        to_q[c] = q[c] - fixed[c];
    }
    return 2 * atan2(vector3_determinant(fixed, to_p, to_q),
                     1 + vector3_dot(fixed, p) + vector3_dot(p, q) + vector3_dot(q, fixed));
}

/// A point in the middle of a ring.
static void middle_of(const area_job *job, const bat_curve *curve, double *middle)
{
    for (size_t c = 0; c < job->dim; c++)
        middle[c] = 0;
    for (size_t i = 0; i < curve->count; i++)
        for (size_t c = 0; c < job->dim; c++)
            middle[c] += curve->points[i * job->dim + c] / (double)curve->count;
    double length = job->sphere ? sqrt(vector3_dot(middle, middle)) : 1;
    for (size_t c = 0; c < job->dim; c++)
        middle[c] /= length > 0 ? length : 1;
}

/// The signed area under a polyline, as triangles with a fixed point.
static double area_under(const area_job *job, const double *fixed, const bat_curve *line)
{
    double sum = 0;
    size_t edges = polygon_edges(line->count, line->closed);
    for (size_t i = 0; i < edges; i++)
        sum +=
            triangle(job, fixed, line->points + i * job->dim, line->points + (i + 1 == line->count ? 0 : i + 1) * job->dim);
    return sum;
}

static double side_of(const arc_use *use)
{
    return use->reversed ? -1 : 1;
}

/// The area of a refined ring.
static double refined_area(const area_job *job, size_t curve)
{
    double middle[3] = {0}, sum = 0;
    middle_of(job, &job->curves[curve], middle);
    for (size_t u = job->graph->first_use[curve]; u < job->graph->first_use[curve + 1]; u++)
    {
        const arc_use *use = &job->graph->uses[u];
        sum += side_of(use) * area_under(job, middle, &job->fine->arcs[use->arc]);
    }
    return sum;
}

/// The unit vector to the left of an arc at point i, and the distance of its neighbours.
static double left_of(const area_job *job, const bat_curve *line, size_t i, double *left)
{
    size_t dim = job->dim;
    const double *p = line->points + i * dim, *before = line->points + (i > 0 ? i - 1 : line->count - 1) * dim,
                 *after = line->points + (i + 1 < line->count ? i + 1 : 0) * dim;
    double along[3] = {0}, square = 0, across = 0;
    for (size_t c = 0; c < dim; c++)
    {
        along[c] = after[c] - before[c];
        square += along[c] * along[c];
    }
    left[0] = job->sphere ? p[1] * along[2] - p[2] * along[1] : -along[1];
    left[1] = job->sphere ? p[2] * along[0] - p[0] * along[2] : along[0];
    left[2] = job->sphere ? p[0] * along[1] - p[1] * along[0] : 0;
    across = sqrt(vector3_dot(left, left));
    for (int c = 0; c < 3; c++)
        left[c] = across > 0 ? left[c] / across : 0;
    return sqrt(square);
}

/// The weights of an arc of a scheme that keeps the given points.
static void weigh_edges(const area_job *job, size_t a, double *weights)
{
    const bat_curve *coarse = &job->graph->arcs[a];
    size_t edges = polygon_edges(coarse->count, coarse->closed), rows = job->fine->arcs[a].count;
    for (size_t e = 0; e < edges; e++)
    {
        const double *p = coarse->points + e * job->dim,
                     *q = coarse->points + (e + 1 == coarse->count ? 0 : e + 1) * job->dim;
        double length = coarse->space->distance(coarse->space, p, q);
        size_t begin = refined_arcs_row(job->fine, job->graph, a, e),
               end = e + 1 == edges && coarse->closed ? rows : refined_arcs_row(job->fine, job->graph, a, e + 1);
        for (size_t i = begin; i < end; i++)
        {
            double s = (double)(i - begin) / (double)(end - begin);
            weights[i] = 16 * s * s * (1 - s) * (1 - s) * length;
        }
    }
    if (!coarse->closed)
        weights[rows - 1] = 0;
}

/// The weights of an arc of a scheme that moves the given points: even, and 0 at the ends.
static void weigh_arc(const area_job *job, size_t a, double *weights)
{
    const bat_curve *coarse = &job->graph->arcs[a];
    size_t edges = polygon_edges(coarse->count, coarse->closed), rows = job->fine->arcs[a].count;
    double length = 0;
    for (size_t e = 0; e < edges; e++)
        length += coarse->space->distance(coarse->space, coarse->points + e * job->dim,
                                          coarse->points + (e + 1) % coarse->count * job->dim) /
                  (double)edges;
    for (size_t i = 0; i < rows; i++)
    {
        double u = coarse->closed ? 0 : 2 * (double)i / (double)(rows - 1) - 1;
        weights[i] = length * (1 - u * u) * (1 - u * u);
    }
}

/// Set up the arcs and the areas to keep.
static bat_status prepare(area_job *job, bat_error *error)
{
    size_t arcs = job->graph->arc_count;
    job->arcs = memory_pool_zeros(&job->pool, arcs, sizeof *job->arcs);
    job->targets = memory_pool_array(&job->pool, job->count, sizeof(double));
    job->areas = memory_pool_array(&job->pool, job->count, sizeof(double));
    job->vectors = memory_pool_array(&job->pool, 5 * job->count, sizeof(double));
    bat_status status = memory_pool_check(&job->pool, error);
    for (size_t a = 0; a < arcs && status == BAT_OK; a++)
    {
        size_t rows = job->fine->arcs[a].count, values = rows * job->dim;
        job->arcs[a].weights = memory_pool_array(&job->pool, rows, sizeof(double));
        job->arcs[a].given = memory_pool_array(&job->pool, values, sizeof(double));
        job->arcs[a].crossing = memory_pool_zeros(&job->pool, rows, sizeof(bool));
        status = memory_pool_check(&job->pool, error);
        if (status != BAT_OK)
            return status;
        memcpy(job->arcs[a].given, job->fine->arcs[a].points, values * sizeof(double));
        (job->keeps_points ? weigh_edges : weigh_arc)(job, a, job->arcs[a].weights);
    }
    for (size_t c = 0; c < job->count && status == BAT_OK; c++)
    {
        double middle[3] = {0}, length = 0;
        middle_of(job, &job->curves[c], middle);
        for (size_t i = 0; i < job->curves[c].count; i++)
            length += job->curves[c].space->distance(job->curves[c].space, middle, job->curves[c].points + i * job->dim);
        job->targets[c] = job->curves[c].closed ? area_under(job, middle, &job->curves[c]) : NAN;
        if (fabs(job->targets[c]) < NO_AREA * length * length)
            job->targets[c] = NAN;
    }
    return status;
}

/// The gains of the arcs where they are now.
static void measure_gains(area_job *job)
{
    for (size_t a = 0; a < job->graph->arc_count; a++)
    {
        const bat_curve *line = &job->fine->arcs[a];
        double left[3], gain = 0;
        for (size_t i = 0; i < line->count; i++)
            if (job->arcs[a].weights[i] > 0)
                gain += left_of(job, line, i, left) * job->arcs[a].weights[i] / 2;
        job->arcs[a].gain = gain;
    }
}

static bool is_ring(const area_job *job, size_t curve)
{
    return !isnan(job->targets[curve]);
}

/// The shares of the arcs for multipliers of the rings.
static void spread(area_job *job, const double *multipliers)
{
    for (size_t a = 0; a < job->graph->arc_count; a++)
        job->arcs[a].share = 0;
    for (size_t c = 0; c < job->count; c++)
        for (size_t u = job->graph->first_use[c]; u < job->graph->first_use[c + 1] && is_ring(job, c); u++)
            job->arcs[job->graph->uses[u].arc].share += side_of(&job->graph->uses[u]) * multipliers[c];
}

/// The area that each ring loses with the shares of the arcs.
static void collect(const area_job *job, double *losses)
{
    for (size_t c = 0; c < job->count; c++)
    {
        losses[c] = 0;
        for (size_t u = job->graph->first_use[c]; u < job->graph->first_use[c + 1] && is_ring(job, c); u++)
        {
            const arc_use *use = &job->graph->uses[u];
            losses[c] += side_of(use) * job->arcs[use->arc].gain * job->arcs[use->arc].share;
        }
    }
}

/// Solve for the shares with which the rings lose `losses`, by conjugate gradients in the multipliers. The system is
/// positive semidefinite and consistent: rings that bound the same faces from both sides repeat each other.
static void solve_shares(area_job *job, const double *losses)
{
    size_t n = job->count;
    double *x = job->vectors, *r = x + n, *z = r + n, *p = z + n, *q = p + n, scale = 0, product = 0;
    const size_t limit = 10 * n + 100;
    for (size_t c = 0; c < n; c++)
    {
        x[c] = 0;
        r[c] = is_ring(job, c) ? losses[c] : 0;
        scale = fmax(scale, is_ring(job, c) ? fabs(r[c] / job->targets[c]) : 0);
    }
    double *inverse = job->areas; // of the diagonal
    for (size_t c = 0; c < n; c++)
    {
        double diagonal = 0;
        for (size_t u = job->graph->first_use[c]; u < job->graph->first_use[c + 1] && is_ring(job, c); u++)
            diagonal += job->arcs[job->graph->uses[u].arc].gain;
        inverse[c] = diagonal > 0 ? 1 / diagonal : 0;
        z[c] = inverse[c] * r[c];
        p[c] = z[c];
        product += r[c] * z[c];
    }
    for (size_t step = 0; step < limit && product > 0; step++)
    {
        double energy = 0, next = 0, worst = 0;
        spread(job, p);
        collect(job, q);
        for (size_t c = 0; c < n; c++)
            energy += p[c] * q[c];
        if (!(energy > 0))
            break;
        for (size_t c = 0; c < n; c++)
        {
            x[c] += product / energy * p[c];
            r[c] -= product / energy * q[c];
            z[c] = inverse[c] * r[c];
            next += r[c] * z[c];
            if (is_ring(job, c))
                worst = fmax(worst, fabs(r[c] / job->targets[c]));
        }
        if (worst <= RESIDUAL_SHARE * scale)
            break;
        for (size_t c = 0; c < n; c++)
            p[c] = z[c] + next / product * p[c];
        product = next;
    }
    spread(job, x);
}

/// Move the points of all arcs by their shares.
static bat_status move_arcs(area_job *job, bat_error *error)
{
    size_t longest = 0;
    for (size_t a = 0; a < job->graph->arc_count; a++)
        longest = job->fine->arcs[a].count > longest ? job->fine->arcs[a].count : longest;
    double *moved = memory_array(longest, 3 * sizeof(double));
    if (moved == NULL)
        return error_memory(error, longest * 3 * sizeof(double));
    for (size_t a = 0; a < job->graph->arc_count; a++)
    {
        bat_curve *line = &job->fine->arcs[a];
        const area_arc *arc = &job->arcs[a];
        memcpy(moved, line->points, line->count * job->dim * sizeof(double));
        for (size_t i = 0; i < line->count; i++)
        {
            double left[3], *point = moved + i * job->dim;
            double way = arc->share * arc->weights[i];
            if (way == 0)
                continue;
            (void)left_of(job, line, i, left);
            vector_add(job->dim, way, left, point);
            double length = job->sphere ? sqrt(vector3_dot(point, point)) : 1;
            for (size_t c = 0; c < job->dim; c++)
                point[c] /= length;
        }
        memcpy(line->points, moved, line->count * job->dim * sizeof(double));
    }
    free(moved);
    return BAT_OK;
}

/// The largest relative error of a ring's area, and the ring.
static double measure_areas(area_job *job, double *losses, size_t *ring)
{
    double largest = 0;
    *ring = BAT_NO_INDEX;
    for (size_t c = 0; c < job->count; c++)
    {
        losses[c] = 0;
        if (!is_ring(job, c))
            continue;
        losses[c] = refined_area(job, c) - job->targets[c];
        double relative = fabs(losses[c] / job->targets[c]);
        if (relative > largest)
        {
            largest = relative;
            *ring = c;
        }
    }
    return largest;
}

/// Newton's method from where the points are.
static bat_status run_newton(area_job *job, double *losses, double *largest, size_t *ring, bat_error *error)
{
    *largest = measure_areas(job, losses, ring);
    for (size_t step = 0; step<NEWTON_STEPS && * largest> AREA_GOAL; step++)
    {
        measure_gains(job);
        solve_shares(job, losses);
        for (size_t a = 0; a < job->graph->arc_count; a++)
            if (!(fabs(job->arcs[a].share) <= MAX_SHARE))
                return BAT_OK;
        bat_status status = move_arcs(job, error);
        if (status != BAT_OK)
            return status;
        double before = *largest;
        *largest = measure_areas(job, losses, ring);
        if (*largest<AREA_PROMISE && * largest> before / 2)
            break;
    }
    return BAT_OK;
}

// Crossings

/// The points of the given edge over which a refined edge lies are moved no further. Where the given points stay, the edge
/// becomes straight: then it crosses no other such edge, and a ring of such edges has its area.
static void freeze(area_job *job, edge_place place)
{
    area_arc *arc = &job->arcs[place.curve];
    const bat_curve *line = &job->fine->arcs[place.curve];
    size_t rows = line->count, begin = place.edge, end = (place.edge + 1) % rows, before = job->frozen;
    for (; arc->weights[begin] > 0; begin = begin > 0 ? begin - 1 : rows - 1, job->frozen++)
        arc->weights[begin] = 0;
    for (; arc->weights[end] > 0; end = end + 1 < rows ? end + 1 : 0, job->frozen++)
        arc->weights[end] = 0;
    size_t last = end > begin ? end : end + rows;
    if (!job->keeps_points || job->frozen == before)
        return;
    job->straightened++;
    for (size_t i = begin + 1; i < last; i++)
        (void)bat_space_geodesic(line->space, arc->given + begin * job->dim, arc->given + end * job->dim,
                                 (double)(i - begin) / (double)(last - begin), arc->given + (i % rows) * job->dim);
}

static bool note_crossing(void *context, edge_place first, edge_place second)
{
    area_job *job = context;
    bool *crossing[2] = {&job->arcs[first.curve].crossing[first.edge], &job->arcs[second.curve].crossing[second.edge]};
    if (!job->moved)
        *crossing[0] = *crossing[1] = true;
    else if (!*crossing[0] || !*crossing[1])
    {
        freeze(job, first);
        freeze(job, second);
    }
    return true;
}

/// Freeze edges whose refined points cross others. Those that cross before they are moved may go on.
static bat_status freeze_crossings(area_job *job, bat_error *error)
{
    chart_curves charts;
    bat_status status = chart_curves_make(job->chart, job->fine->arcs, job->fine->count, NULL, NULL, 1, &charts, error);
    if (status == BAT_OK)
        status =
            edge_pairs_find(charts.curves, charts.count, job->chart->turn, EDGE_PAIRS_ARCS, 0, note_crossing, job, error);
    chart_curves_free(&charts);
    return status;
}

static void restore(area_job *job)
{
    for (size_t a = 0; a < job->graph->arc_count; a++)
        memcpy(job->fine->arcs[a].points, job->arcs[a].given, job->fine->arcs[a].count * job->dim * sizeof(double));
}

static bat_status run(area_job *job, bool tested, double *largest, bat_error *error)
{
    double *losses;
    bat_status status = array_make(&losses, job->count, sizeof *losses, error);
    bool apart = false;
    size_t ring = BAT_NO_INDEX;
    if (status == BAT_OK && tested)
        status = freeze_crossings(job, error);
    job->moved = true;
    for (size_t round = 0; round < ROUNDS && status == BAT_OK && !apart; round++)
    {
        restore(job);
        status = run_newton(job, losses, largest, &ring, error);
        size_t before = job->frozen;
        if (status == BAT_OK && tested)
            status = freeze_crossings(job, error);
        if (*largest > AREA_PROMISE && job->keeps_points)
            for (size_t u = job->graph->first_use[ring]; u < job->graph->first_use[ring + 1]; u++)
                for (size_t i = 0, arc = job->graph->uses[u].arc; i < job->fine->arcs[arc].count; i++)
                    freeze(job, (edge_place){arc, i});
        apart = job->frozen == before;
    }
    free(losses);
    if (status != BAT_OK)
        return status;
    if (!apart || *largest > AREA_PROMISE)
    {
        restore(job);
        status =
            ERROR_UNSUPPORTED(error, 0, "the area of the ring cannot be kept to %g of it without crossings", AREA_PROMISE);
        return error_operand(error, error_curve(error, status, ring), 0);
    }
    return BAT_OK;
}

bat_status arcs_keep_area(const arc_graph *graph, const bat_curve *curves, size_t count,
                          const bat_curve_refine_options *options, const map_chart *chart, bool tested, refined_arcs *fine,
                          bat_curve_map_refine_report *report, bat_error *error)
{
    area_job job = {.graph = graph, .curves = curves, .count = count, .fine = fine, .chart = chart};
    job.dim = curves[0].space->point_dim;
    job.sphere = space_is_sphere(curves[0].space);
    job.keeps_points = scheme_keeps_points(&options->scheme) && !options->snap;
    if (!job.sphere && !space_is_plane(curves[0].space))
        return ERROR_UNSUPPORTED(error, 0, "areas can be kept in the plane and on the sphere only");
    bat_status status = prepare(&job, error);
    if (status == BAT_OK)
        status = run(&job, tested, &report->largest_area_error, error);
    report->drawn_back += status == BAT_OK ? job.straightened : 0;
    memory_pool_free(&job.pool);
    return status;
}
