/// @file
/// Schemes and splines on curves that people have: how near they come to the curve that the control points were sampled
/// from.

#include "batten/research/curve_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "base/progress.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/polygon.h"
#include "curve_akima.h"
#include "real_curves_data.h"
#include "search/nearest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    /// Points at equal steps of length that stand for a curve.
    SAMPLES = 8000,
    /// Every so many of them search the nearest of the other curve's.
    STRIDE = 4,
    SPACES = 2,
    MAX_LEVELS = 12
};

static const char POLYGON[] = "polygon", AKIMA[] = "akima", DEFAULT[] = "default", NOT_SIMPLE[] = "default, --simple never";
static const char *const METHODS[] = {POLYGON,
                                      DEFAULT,
                                      NOT_SIMPLE,
                                      "learned:fairness=0",
                                      "learned:fairness=1",
                                      "angle-4",
                                      "angle-6",
                                      "log-exp-4",
                                      "log-exp-6",
                                      "four-point",
                                      "four-point:parameters=centripetal",
                                      "four-point:parameters=chordal",
                                      "catmull-rom",
                                      AKIMA,
                                      "cubic"};
enum
{
    METHOD_COUNT = sizeof METHODS / sizeof METHODS[0]
};

bat_real_curves_options bat_real_curves_defaults(void)
{
    return (bat_real_curves_options){.levels = 5};
}

/// A true curve, sampled, with a tree of its points.
typedef struct true_curve
{
    double *points; ///< SAMPLES rows
    nearest_tree tree;
} true_curve;

/// What a curve is measured against.
typedef struct reference
{
    const true_curve *truth;
    double edge; ///< mean edge of the control polygon
    bool simple; ///< whether the control polygon is
} reference;

typedef struct figures
{
    double distance, largest, turn;
    bool crossed;
} figures;

/// One family with one sampling in one space.
typedef struct real_case
{
    const bat_space *space;
    bool sphere;
    size_t count;
    bat_curve *control, *fine; ///< `count` each
    double *points;            ///< of the control curves on the sphere
    const true_curve *truth;
    reference *references;
    figures *figures;
} real_case;

typedef struct study
{
    const bat_real_curves_options *options;
    bat_space spaces[SPACES];
    bat_real_curves_row *rows;
    size_t count;
    size_t steps, done; ///< of the progress
} study;

// Measures

/// The point that ends an edge.
static const double *edge_end(const bat_curve *curve, size_t edge)
{
    return curve->points + (edge + 1 == curve->count ? 0 : edge + 1) * curve->space->point_dim;
}

/// Points at equal steps of length; a closed curve's last step leads back to its first point.
static bat_status resample(const bat_curve *curve, double *points)
{
    const bat_space *space = curve->space;
    size_t dim = space->point_dim, edges = polygon_edges(curve->count, curve->closed);
    double total = 0, begin = 0, length = 0;
    for (size_t i = 0; i < edges; i++)
        total += space->distance(space, curve->points + i * dim, edge_end(curve, i));
    double step = total / (curve->closed ? SAMPLES : SAMPLES - 1);
    size_t edge = 0;
    for (size_t k = 0; k < SAMPLES; k++)
    {
        double at = step * (double)k;
        const double *p = curve->points + edge * dim, *q = edge_end(curve, edge);
        length = k == 0 ? space->distance(space, p, q) : length;
        while (edge + 1 < edges && at >= begin + length)
        {
            begin += length;
            edge++;
            p = q;
            q = edge_end(curve, edge);
            length = space->distance(space, p, q);
        }
        double share = length > 0 ? fmin((at - begin) / length, 1) : 0;
        bat_status status = bat_space_geodesic(space, p, q, share, points + k * dim);
        if (status != BAT_OK)
            return status;
    }
    return BAT_OK;
}

/// Geodesic distance of two points of the unit sphere from their chord.
static double arc(double chord)
{
    return 2 * asin(fmin(0.5 * chord, 1));
}

/// Mean and greatest of the distances of some of `points` to the nearest point of a tree.
static void one_sided(const real_case *a_case, const double *points, const nearest_tree *tree, double *mean,
                      double *greatest)
{
    size_t dim = a_case->space->point_dim;
    *mean = *greatest = 0;
    for (size_t k = 0; k < SAMPLES; k += STRIDE)
    {
        double distance = nearest_find(tree, points + k * dim).distance;
        distance = a_case->sphere ? arc(distance) : distance;
        *mean += distance * STRIDE / SAMPLES;
        *greatest = fmax(*greatest, distance);
    }
}

static bat_status compare(const real_case *a_case, const bat_curve *curve, const reference *to, double *points,
                          figures *result, bat_error *error)
{
    nearest_tree tree;
    if (resample(curve, points) != BAT_OK)
        return error_set(error, BAT_CUT_LOCUS, BAT_NO_INDEX, 0, "the curve has antipodal neighbours");
    bat_status status = nearest_build(NEAREST_POINTS, points, NULL, SAMPLES, curve->space->point_dim, &tree, error);
    if (status != BAT_OK)
        return status;
    double there, back, max_from_first, max_from_second;
    one_sided(a_case, points, &to->truth->tree, &there, &max_from_first);
    one_sided(a_case, to->truth->points, &tree, &back, &max_from_second);
    nearest_free(&tree);
    result->distance = 0.5 * (there + back) / to->edge;
    result->largest = fmax(max_from_first, max_from_second) / to->edge;
    return BAT_OK;
}

static bat_status measure(const real_case *a_case, const bat_curve *curve, const reference *to, figures *result,
                          bat_error *error)
{
    bat_curve_fairness_values fairness = {0, 0, 0};
    bool simple = true;
    double *points = memory_array(SAMPLES * curve->space->point_dim, sizeof *points);
    if (points == NULL)
        return error_memory(error, SAMPLES * curve->space->point_dim * sizeof *points);
    bat_status status = compare(a_case, curve, to, points, result, error);
    free(points);
    if (status == BAT_OK)
        status = bat_curve_fairness(curve, NULL, &fairness, error);
    if (status == BAT_OK && to->simple)
        status = bat_curve_is_simple(curve, &simple, error);
    result->turn = fairness.g1;
    result->crossed = !simple;
    return status;
}

/// Measure curves, which the threads share.
static bat_status measure_all(const real_case *a_case, const bat_curve *curves, int wanted, bat_error *error)
{
    shared_work work = shared_work_make(a_case->count, (bat_progress){0});
    int threads = threads_for(wanted, a_case->count);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < work.total; i++)
        if (shared_work_wants(&work, i))
        {
            bat_error own;
            bat_status status = measure(a_case, &curves[i], &a_case->references[i], &a_case->figures[i], &own);
            shared_work_finish(&work, i, status, &own);
        }
    return shared_work_end(&work, error);
}

// Methods

static bat_status akima_all(const real_case *a_case, size_t levels, bat_error *error)
{
    bat_status status = BAT_OK;
    size_t made = 0;
    for (; made < a_case->count && status == BAT_OK; made++)
        status = curve_akima(&a_case->control[made], levels, &a_case->fine[made], error);
    for (size_t i = 0; i + 1 < made && status != BAT_OK; i++)
        bat_curve_free(&a_case->fine[i]);
    return status;
}

/// The refined curves of a method, which the caller frees; those of the polygon are the control curves themselves.
/// @return BAT_UNSUPPORTED where the method does not exist in the space
static bat_status refine_all(const study *s, const real_case *a_case, size_t method, bat_error *error)
{
    const bat_tension_method *further = method < METHOD_COUNT ? NULL : &s->options->methods[method - METHOD_COUNT];
    const char *name = further == NULL ? METHODS[method] : further->name;
    if (name == AKIMA)
        return a_case->sphere ? BAT_UNSUPPORTED : akima_all(a_case, s->options->levels, error);
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.levels = s->options->levels;
    how.threads = s->options->threads;
    bat_status status = BAT_OK;
    if (further != NULL)
        how.scheme = further->scheme;
    else if (name == NOT_SIMPLE)
        how.simple = BAT_CURVE_SIMPLE_NEVER;
    else if (name != DEFAULT)
        status = bat_curve_scheme_by_name(name, &how.scheme, error);
    bat_error own;
    if (status != BAT_OK)
        return status;
    status = bat_curves_refine(a_case->control, a_case->count, &how, a_case->fine, &own);
    return status == BAT_OK ? BAT_OK
                            : error_set(error, status, own.index, 0, "curve %zu by %s: %.160s", own.curve, name, own.text);
}

static bat_status summarize(const real_case *a_case, bat_real_curves_row *row, bat_error *error)
{
    double *turns = memory_array(a_case->count, sizeof *turns);
    if (turns == NULL)
        return error_memory(error, a_case->count * sizeof *turns);
    for (size_t i = 0; i < a_case->count; i++)
    {
        const figures *f = &a_case->figures[i];
        row->distance += f->distance / (double)a_case->count;
        row->largest += f->largest / (double)a_case->count;
        row->crossed += f->crossed ? 1 : 0;
        turns[i] = f->turn;
    }
    bat_curve_summary summary = {.count = 0};
    bat_status status = bat_curve_summarize(turns, a_case->count, &summary, error);
    row->turn = summary.median;
    free(turns);
    return status;
}

static bat_status run_method(study *s, const real_case *a_case, size_t method, bat_real_curves_row *row, bat_error *error)
{
    bool polygon = method < METHOD_COUNT && METHODS[method] == POLYGON;
    bat_status status = polygon ? BAT_OK : refine_all(s, a_case, method, error);
    if (status != BAT_OK)
        return status;
    status = measure_all(a_case, polygon ? a_case->control : a_case->fine, s->options->threads, error);
    for (size_t i = 0; i < a_case->count && !polygon; i++)
        bat_curve_free(&a_case->fine[i]);
    return status == BAT_OK ? summarize(a_case, row, error) : status;
}

static bat_status report_step(study *s, bat_error *error)
{
    const bat_progress *progress = &s->options->progress;
    s->done++;
    if (progress->report == NULL || progress->report(progress->context, (double)s->done / (double)s->steps))
        return BAT_OK;
    return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
}

static size_t methods_of(const study *s)
{
    return METHOD_COUNT + s->options->method_count;
}

/// All methods on one case; the first is the polygon, which the others are compared with.
static bat_status run_methods(study *s, const real_case *a_case, const char *family, const char *sampling, bat_error *error)
{
    size_t polygon = s->count;
    bat_status status = BAT_OK;
    for (size_t m = 0; m < methods_of(s) && status == BAT_OK; m++)
    {
        bat_real_curves_row row = {.space = a_case->sphere ? "sphere" : "plane", .curves = a_case->count};
        memcpy(row.family, family, strlen(family) + 1);
        memcpy(row.sampling, sampling, strlen(sampling) + 1);
        row.method = m < METHOD_COUNT ? METHODS[m] : s->options->methods[m - METHOD_COUNT].name;
        bat_error own;
        status = run_method(s, a_case, m, &row, &own);
        if (status != BAT_OK && status != BAT_UNSUPPORTED)
            return error_set(error, status, own.index, 0, "%s-%s on the %s: %.180s", family, sampling, row.space, own.text);
        if (status == BAT_OK)
        {
            s->rows[s->count++] = row;
            s->rows[s->count - 1].relative = row.distance / s->rows[polygon].distance;
        }
        status = report_step(s, error);
    }
    return status;
}

// Cases

static double mean_edge(const bat_curve *curve)
{
    size_t dim = curve->space->point_dim, edges = polygon_edges(curve->count, curve->closed);
    double sum = 0;
    for (size_t i = 0; i < edges; i++)
        sum += curve->space->distance(curve->space, curve->points + i * dim, edge_end(curve, i));
    return sum / (double)edges;
}

static void case_free(real_case *a_case)
{
    free(a_case->control);
    free(a_case->fine);
    free(a_case->points);
    free(a_case->references);
    free(a_case->figures);
}

static bat_status case_fill(const real_family *family, const bat_curve_set *control, real_case *a_case, bat_error *error)
{
    double *points = a_case->points;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < a_case->count && status == BAT_OK; i++)
    {
        bat_curve *curve = &a_case->control[i];
        *curve = control->curves[i];
        curve->space = a_case->space;
        curve->channels = NULL;
        curve->channel_count = 0;
        if (a_case->sphere)
        {
            real_curve_on_sphere(&control->curves[i], &family->truth.curves[i], points);
            curve->points = points;
            points += 3 * curve->count;
        }
        a_case->references[i] = (reference){.truth = &a_case->truth[i], .edge = mean_edge(curve)};
        status = bat_curve_is_simple(curve, &a_case->references[i].simple, error);
    }
    return status;
}

static bat_status case_make(const real_family *family, const bat_curve_set *control, real_case *a_case, bat_error *error)
{
    size_t count = control->count, rows = 0;
    for (size_t i = 0; i < count; i++)
        rows += control->curves[i].count;
    a_case->count = count;
    a_case->control = memory_array(count, sizeof *a_case->control);
    a_case->fine = memory_array(count, sizeof *a_case->fine);
    a_case->points = memory_array(3 * rows, sizeof *a_case->points);
    a_case->references = memory_array(count, sizeof *a_case->references);
    a_case->figures = memory_array(count, sizeof *a_case->figures);
    if (a_case->control == NULL || a_case->fine == NULL || a_case->points == NULL || a_case->references == NULL ||
        a_case->figures == NULL)
        return error_memory(error, 3 * rows * sizeof *a_case->points);
    return case_fill(family, control, a_case, error);
}

static void truths_free(true_curve *truths, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        nearest_free(&truths[i].tree);
        free(truths[i].points);
    }
    free(truths);
}

static bat_status truth_make(const bat_curve *curve, const bat_space *space, true_curve *truth, bat_error *error)
{
    bool sphere = space->point_dim == 3;
    bat_curve placed = *curve;
    placed.space = space;
    truth->points = memory_array(SAMPLES * space->point_dim, sizeof *truth->points);
    placed.points = sphere ? memory_array(3 * curve->count, sizeof *placed.points) : curve->points;
    bat_status status = BAT_OK;
    if (truth->points == NULL || placed.points == NULL)
        status = error_memory(error, (SAMPLES + curve->count) * space->point_dim * sizeof *truth->points);
    if (status == BAT_OK && sphere)
        real_curve_on_sphere(curve, curve, placed.points);
    if (status == BAT_OK && resample(&placed, truth->points) != BAT_OK)
        status = error_set(error, BAT_CUT_LOCUS, BAT_NO_INDEX, 0, "a true curve has antipodal neighbours");
    if (status == BAT_OK)
        status = nearest_build(NEAREST_POINTS, truth->points, NULL, SAMPLES, space->point_dim, &truth->tree, error);
    if (sphere)
        free(placed.points);
    return status;
}

static bat_status run_family(study *s, const bat_space *space, const real_family *family, bat_error *error)
{
    size_t count = family->truth.count;
    true_curve *truths = calloc(count, sizeof *truths);
    bat_status status = truths != NULL ? BAT_OK : error_memory(error, count * sizeof *truths);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        status = truth_make(&family->truth.curves[i], space, &truths[i], error);
    for (size_t k = 0; k < family->count && status == BAT_OK; k++)
    {
        real_case a_case = {.space = space, .sphere = space->point_dim == 3, .truth = truths};
        status = case_make(family, &family->samplings[k].control, &a_case, error);
        if (status == BAT_OK)
            status = run_methods(s, &a_case, family->name, family->samplings[k].name, error);
        case_free(&a_case);
    }
    if (truths != NULL)
        truths_free(truths, count);
    return status;
}

static bat_status run(study *s, const real_folder *folder, bat_error *error)
{
    size_t samplings = 0;
    for (size_t i = 0; i < folder->count; i++)
        samplings += folder->families[i].count;
    s->steps = SPACES * samplings * methods_of(s);
    s->rows = memory_array(s->steps, sizeof *s->rows);
    if (s->rows == NULL)
        return error_memory(error, s->steps * sizeof *s->rows);
    bat_status status = BAT_OK;
    for (size_t k = 0; k < SPACES; k++)
        for (size_t i = 0; i < folder->count && status == BAT_OK; i++)
            status = run_family(s, &s->spaces[k], &folder->families[i], error);
    return status;
}

bat_status bat_real_curves(const char *folder, const bat_real_curves_options *options, bat_real_curves_row **rows,
                           size_t *count, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_real_curves_options, levels, OPTION_SIZE, 0, MAX_LEVELS),
        OPTION_THREADS(bat_real_curves_options),
    };
    const bat_real_curves_options defaults = bat_real_curves_defaults();
    study s = {.options = options != NULL ? options : &defaults, .spaces = {bat_euclidean(2), bat_sphere(2)}};
    real_folder data;
    bat_status status = OPTIONS_CHECK(s.options, FIELDS, error);
    if (status == BAT_OK)
        status = real_folder_read(folder, &data, error);
    if (status != BAT_OK)
        return status;
    status = run(&s, &data, error);
    real_folder_free(&data);
    if (status != BAT_OK)
    {
        free(s.rows);
        return status;
    }
    *rows = s.rows;
    *count = s.count;
    return BAT_OK;
}
