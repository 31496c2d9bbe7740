#include "reproduce.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Curves, meshes and scans that people have, against the truth.

static const double DEGREES = 57.295779513082320877;

enum
{
    /// Rows of a given model.
    MAX_METHODS = 3,
    MAX_WAYS = 32
};

// Curves

/// The rows of a given model: three where it has a fairness, else one.
static size_t model_methods(const bat_curve_model *model, bat_tension_method methods[MAX_METHODS])
{
    static const char *const NAMES[MAX_METHODS] = {"given:fairness=0", "given:fairness=0.5", "given:fairness=1"};
    bat_curve_scheme scheme = bat_curve_scheme_of_model(model);
    if (!bat_curve_model_has_fairness(model))
    {
        methods[0] = (bat_tension_method){.name = "given", .scheme = scheme};
        return 1;
    }
    for (size_t i = 0; i < MAX_METHODS; i++)
    {
        scheme.fairness = 0.5 * (double)i;
        methods[i] = (bat_tension_method){.name = NAMES[i], .fairness = scheme.fairness, .scheme = scheme};
    }
    return MAX_METHODS;
}

int reproduce_real_curves(const reproduce_job *job)
{
    bat_tension_method methods[MAX_METHODS];
    bat_curve_model *model = NULL;
    bat_real_curves_row *rows;
    size_t count;
    if (job->model != NULL && bat_curve_model_read_published(job->model, &model, report_error()) != BAT_OK)
        return report_failure(job->model, report_error());
    bat_real_curves_options options = bat_real_curves_defaults();
    options.methods = methods;
    options.method_count = model != NULL ? model_methods(model, methods) : 0;
    options.progress = report_progress("measuring curves");
    int code = report_status(NULL, NULL, bat_real_curves(job->data, &options, &rows, &count, report_error()));
    bat_curve_model_free(model);
    if (code != EXIT_DONE)
        return code;
    report_table table = report_begin(job->call.json);
    report_head(&table,
                "Curves refined by %zu levels against the curves that their points were sampled from.\n"
                "relative: mean distance over that of the control polygon; distance and largest distance in control edges;\n"
                "turn: median of the largest turning angles, degrees; crossed: curves that cross themselves though their\n"
                "polygon does not.\n",
                options.levels);
    for (size_t i = 0; i < count; i++)
    {
        const bat_real_curves_row *row = &rows[i];
        if (strcmp(row->method, "polygon") == 0)
            report_head(&table,
                        "\n%s, %s, %s: %zu curves\nscheme                               relative  distance   largest    "
                        "turn  crossed\n",
                        row->space, row->family, row->sampling, row->curves);
        report_row(&table, "{scheme:-35} {relative:9.3f} {distance:9.5f} {largest:9.4f} {turn:7.2f} {crossed:8}\n",
                   "space:s family:s sampling:s scheme:s distance:n relative:n largest:n turn:n crossed:z curves:z",
                   row->space, row->family, row->sampling, row->method, row->distance, row->relative, row->largest,
                   row->turn * DEGREES, row->crossed, row->curves);
    }
    free(rows);
    return report_print(job->call.json, "", "levels:z rows:o", options.levels, table.rows);
}

// Meshes

/// Means over the meshes that were made in one way, refined by one method.
typedef struct summary
{
    const char *way, *method;
    size_t count, closed;
    double relative, worst; ///< sum of logarithms; the greatest
    const char *worst_shape;
    double rough, volume; ///< sums: of logarithms of the angle over the true one; of absolute errors
} summary;

static void add_row(summary *s, const bat_real_meshes_row *row)
{
    s->count++;
    s->relative += log(row->relative);
    s->rough += log(row->angle / row->true_angle);
    if (row->relative > s->worst)
    {
        s->worst = row->relative;
        s->worst_shape = row->shape;
    }
    if (isfinite(row->volume))
    {
        s->closed++;
        s->volume += fabs(row->volume);
    }
}

static void print_summary(const bat_real_meshes_row *rows, size_t count)
{
    summary all[MAX_WAYS * 8] = {0};
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
    {
        size_t at = 0;
        while (at < used && (strcmp(all[at].way, rows[i].way) != 0 || strcmp(all[at].method, rows[i].method) != 0))
            at++;
        if (at == sizeof all / sizeof *all)
            continue;
        if (at == used)
            all[used++] = (summary){.way = rows[i].way, .method = rows[i].method};
        add_row(&all[at], &rows[i]);
    }
    report_table table = report_begin(false);
    report_head(&table, "\nway        scheme               meshes relative    worst of           angle/true volume %%\n");
    for (size_t i = 0; i < used; i++)
    {
        const summary *s = &all[i];
        double share = 1 / (double)s->count;
        report_row(&table,
                   "{way:-10} {method:-20} {count:6} {relative:8.3f} {worst:8.3f} {shape:-12} {rough:10.3f} "
                   "[closed?{100 volume:8.2f}][!closed?       -]\n",
                   "way:s method:s count:z closed:z relative:n worst:n shape:s rough:n volume:n", s->way, s->method,
                   s->count, s->closed, exp(share * s->relative), s->worst, s->worst_shape, exp(share * s->rough),
                   s->volume / (double)s->closed);
    }
}

int reproduce_real_meshes(const reproduce_job *job)
{
    bat_real_meshes_options options = bat_real_meshes_defaults();
    bat_mesh_model *model = NULL;
    bat_real_meshes_row *rows;
    size_t count;
    if (job->model != NULL && bat_mesh_model_read_published(job->model, &model, report_error()) != BAT_OK)
        return report_failure(job->model, report_error());
    options.model = model;
    options.progress = report_progress("measuring meshes");
    int code = report_status(NULL, NULL, bat_real_meshes(job->data, &options, &rows, &count, report_error()));
    bat_mesh_model_free(model);
    if (code != EXIT_DONE)
        return code;
    report_table table = report_begin(job->call.json);
    report_head(
        &table,
        "Coarse meshes refined by %zu levels against the shapes that they were made from.\nrelative: mean distance over the "
        "least of flat, butterfly and Loop; mean and largest distance over the\ndiagonal; angle: 95 %% quantile between "
        "neighbouring faces, degrees; true: the same with all vertices\nmoved to the shape; volume: error.\n\nshape        "
        "vertices way        scheme               relative    mean %%  largest %%  angle   true volume %%\n",
        options.levels);
    for (size_t i = 0; i < count; i++)
    {
        const bat_real_meshes_row *row = &rows[i];
        report_row(&table,
                   "{shape:-12} {vertices:8} {way:-10} {scheme:-20} {relative:8.3f} {100 mean:9.4f} {100 hausdorff:10.3f} "
                   "{angle:6.1f} {true_angle:6.1f} [volume?{100 volume:8.2f}][!volume?       -]\n",
                   "shape:s way:s vertices:z scheme:s mean:n hausdorff:n relative:n angle:n true_angle:n volume:n",
                   row->shape, row->way, row->vertices, row->method, row->mean, row->hausdorff, row->relative,
                   row->angle * DEGREES, row->true_angle * DEGREES, row->volume);
    }
    if (!job->call.json)
        print_summary(rows, count);
    free(rows);
    return report_print(job->call.json, "", "levels:z rows:o", options.levels, table.rows);
}

// Scans

static int study_verdict(const reproduce_job *job, bool scanner)
{
    // By whether they are right, then by whether they are accepted, without a doubt or with one.
    static const char *const OUTCOMES[2][3] = {{"wrong, refused", "wrong, accepted", "wrong, doubted"},
                                               {"right, refused", "right", "right, doubted"}};
    bat_scan_verdict_options options = bat_scan_verdict_defaults();
    bat_scan_verdict_row *rows;
    size_t count, failed = 0, sums[2][3] = {{0}};
    options.seed = job->seed;
    options.scanner = scanner;
    options.progress = report_progress("fitting");
    int code = report_status(NULL, NULL, bat_scan_verdict(job->data, &options, &rows, &count, report_error()));
    if (code != EXIT_DONE)
        return code;
    report_table table = report_begin(job->call.json);
    report_head(&table, "shape                 points   noise outcome            missed   strays   area\n");
    for (size_t i = 0; i < count; i++)
    {
        const bat_scan_verdict_row *row = &rows[i];
        bool made = row->failure[0] == '\0';
        int taken = row->is_accepted + (row->doubt != BAT_SURFACE_DOUBT_NONE);
        sums[row->is_right][taken] += made;
        failed += !made;
        report_row(&table,
                   "{shape:-20} {points:7} {noise:7g} {outcome:-16} [failure?{failure}][!failure?"
                   "{distance_from_surface:8.4f} {distance_from_points:8.4f} {area:6.3f}]\n",
                   "shape:s points:z noise:n outcome:s failure:s fault:i distance_from_surface:n distance_from_points:n "
                   "area:n",
                   row->shape, row->points, row->noise, made ? OUTCOMES[row->is_right][taken] : "none", row->failure,
                   (int)row->fault, row->distance_from_surface, row->distance_from_points, row->area);
    }
    free(rows);
    return report_print(job->call.json,
                        "\nright and accepted {right_accepted}, with a doubt {right_doubted}, right but refused "
                        "{right_refused}, wrong but accepted {wrong_accepted}, with a doubt {wrong_doubted}, wrong and "
                        "refused {wrong_refused}, none {failed}\n",
                        "right_accepted:z right_doubted:z right_refused:z wrong_accepted:z wrong_doubted:z wrong_refused:z "
                        "failed:z rows:o",
                        sums[1][1], sums[1][2], sums[1][0], sums[0][1], sums[0][2], sums[0][0], failed, table.rows);
}

int reproduce_scan_verdict(const reproduce_job *job)
{
    return study_verdict(job, false);
}

int reproduce_scan_verdict_scanner(const reproduce_job *job)
{
    return study_verdict(job, true);
}

// Random inputs

int reproduce_harm(const reproduce_job *job)
{
    bat_harm_study_options options = bat_harm_study_defaults();
    bat_harm_row *rows;
    size_t count, sums[3] = {0};
    options.seed = job->seed;
    options.count = job->clouds > 0 ? job->clouds : options.count;
    options.progress = report_progress("searching");
    if (bat_harm_study(&options, &rows, &count, report_error()) != BAT_OK)
        return report_failure(NULL, report_error());
    report_progress_end();
    report_table table = report_begin(job->call.json);
    report_head(
        &table,
        "Random inputs with a known truth: the error of the default over that of the simplest rival. Harmed: by more\n"
        "than a tenth.\n\n%-14s %-42s %6s %7s %7s %7s %7s\n",
        "", "", "tried", "harmed", "refused", "median", "worst");
    for (size_t i = 0; i < count; i++)
    {
        const bat_harm_row *row = &rows[i];
        report_row(&table,
                   "{system:-14} {kind:-42} {tried:6} {harmed:7} {refused:7} {median:7.2f} {worst:7.2f} (case {case})\n",
                   "system:s kind:s rival:s tried:z harmed:z refused:z median:n worst:n case:z", row->system, row->kind,
                   row->rival, row->tried, row->harmed, row->refused, row->median, row->worst, row->worst_case);
        sums[0] += row->tried;
        sums[1] += row->harmed;
        sums[2] += row->refused;
    }
    free(rows);
    return report_print(job->call.json, "\n{tried} tried, {harmed} harmed, {refused} refused\n",
                        "tried:z harmed:z refused:z rows:o", sums[0], sums[1], sums[2], table.rows);
}

int reproduce_scan_solids(const reproduce_job *job)
{
    bat_scan_solids_options options = bat_scan_solids_defaults();
    bat_scan_solids_row *rows;
    size_t count, sums[3] = {0};
    options.seed = job->seed;
    options.progress = report_progress("fitting");
    int code = report_status(NULL, NULL, bat_scan_solids(job->data, &options, &rows, &count, report_error()));
    if (code != EXIT_DONE)
        return code;
    report_table table = report_begin(job->call.json);
    report_head(&table,
                "Shells of %zu points against the mesh. rms: in standard deviations of the noise, else in %% of the "
                "diagonal;\nlargest: %% of the diagonal; jumps of normals: degrees; volume, of open meshes area: %%; "
                "euler: -2 for each handle too many.\n\nshape              noise scanner  result       rms largest   jumps: "
                "median    "
                "99 %%  largest  volume euler faces cut\n",
                options.points);
    for (size_t i = 0; i < count; i++)
    {
        const bat_scan_solids_row *row = &rows[i];
        bool made = row->failure[0] == '\0';
        const double *jump = row->report.normal_jump;
        sums[!made ? 1 : row->is_right ? 0 : 2]++;
        report_row(
            &table,
            "{shape:-16} {100 noise:5.2g} % [scanner?scanner][!scanner?       ]  {result:-8} [failure?{failure}]"
            "[!failure?{error:8.3g} {100 largest:7.3f} {jump_median:16.2f} {jump_99:7.2f} {jump_largest:8.1f} [volume?"
            "{100 volume:7.3f}][!volume?      -] {euler:5} {faces:5} {cut_handles:3}]\n",
            "shape:s noise:n scanner:b result:s failure:s -error:n rms:n largest:n jump_median:n jump_99:n jump_largest:n "
            "volume:n euler:i faces:z cut_handles:z crossings:z missed:z",
            row->shape, row->noise, (int)row->scanner,
            !made           ? "refused"
            : row->is_right ? "right"
                            : "wrong",
            row->failure, row->noise > 0 ? row->rms / row->noise : 100 * row->rms, row->rms, row->largest, jump[0] * DEGREES,
            jump[1] * DEGREES, jump[2] * DEGREES, row->volume, (int)row->euler, row->faces, row->report.cut_handles,
            row->report.crossings, row->report.missed);
    }
    free(rows);
    return report_print(job->call.json, "\nright {right}, refused {refused}, wrong {wrong}\n",
                        "right:z refused:z wrong:z rows:o", sums[0], sums[1], sums[2], table.rows);
}
