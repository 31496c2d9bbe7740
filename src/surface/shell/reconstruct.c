/// @file
/// From points or a mesh to a shell; see batten/shell.h.

#include "surface/shell/work.h"

#include "base/option.h"
#include "mesh/sides.h"

#include <stdio.h>
#include <string.h>

#define MIN_POINTS 300
#define ROUNDS 8
#define UNFOLD_ROUNDS 2
#define RETRIES 3
#define MIN_FACES 40

/// Factor of the smoothing where a shell is wrong, or has more folds for each patch than allowed, and the largest distance
/// of its points in that of held-out ones, or in spacings.
static const double STIFFER = 4, MAX_FOLDED[2] = {0.001, 0.003}, FOLDED_STIFFER = 2, MAX_STIFFER = 1.2,
                    STIFFER_SPACINGS = 0.15;
/// Least share by which creases bring held-out points nearer.
static const double MIN_CREASE_GAIN = 0.01;
static const double CONNECT_SHARE = 0.3, TRIAL_SHARE = 0.4;
/// Size of the cells that connect points, in the greater of spacing and noise; the second is tried where the first fails.
static const double CELLS[2] = {1, 0.8};

bat_shell_reconstruct_options bat_shell_reconstruct_defaults(void)
{
    return (bat_shell_reconstruct_options){.spans = 2, .crease = 0.7};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_shell_reconstruct_options, tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_FIELD(bat_shell_reconstruct_options, faces, OPTION_SIZE, 0, 1000000),
    OPTION_FIELD(bat_shell_reconstruct_options, spans, OPTION_SIZE, 2, 16),
    OPTION_FIELD(bat_shell_reconstruct_options, crease, OPTION_NUMBER, 0, 3.1415926535897932),
    OPTION_FIELD(bat_shell_reconstruct_options, fill_holes, OPTION_NUMBER, 0, INFINITY),
    OPTION_THREADS(bat_shell_reconstruct_options),
};

const bat_options_table bat_shell_reconstruct_fields = OPTIONS_TABLE(bat_shell_reconstruct_options, FIELDS, NULL);

bool bat_shell_follows(const bat_surface_reconstruct_options *patch, bool outlined, const bat_error *failure,
                       bat_shell_reconstruct_options *options)
{
    options->tolerance = patch->fit.tolerance;
    options->fill_holes = patch->fill_holes;
    options->force = patch->force;
    options->threads = patch->fit.threads;
    options->progress = patch->fit.progress;
    return strcmp(failure->remedy, "shell") == 0 && !outlined && !patch->trim && !patch->published && patch->model == NULL &&
           patch->parameters == BAT_SURFACE_PARAMETERS_AUTO && patch->sides == bat_surface_reconstruct_defaults().sides &&
           patch->fit.functions == 0;
}

static bat_status make_shell(const shell_trial *trial, bat_shell *shell, bat_error *error)
{
    const shell_grid *grid = &trial->grid;
    bat_mesh *cage = &shell->cage;
    *shell =
        (bat_shell){.face_count = grid->face_count, .spans = grid->spans, .closed = grid->links.boundary_edge_count == 0};
    cage->vertex_count = grid->vertex_count;
    cage->face_count = grid->quad_count;
    cage->positions = malloc(grid->vertex_count * 3 * sizeof *cage->positions);
    cage->faces = malloc(grid->quad_count * 4 * sizeof *cage->faces);
    cage->offsets = sides_offsets(grid->quad_count, 4);
    cage->creases = malloc((4 * grid->quad_count + 1) * sizeof *cage->creases);
    shell->patches = malloc(grid->quad_count * 48 * sizeof *shell->patches);
    if (cage->positions == NULL || cage->faces == NULL || cage->offsets == NULL || cage->creases == NULL ||
        shell->patches == NULL)
        return error_memory(error, grid->quad_count * 48 * sizeof *shell->patches);
    memcpy(cage->positions, trial->fit.control, grid->vertex_count * 3 * sizeof *cage->positions);
    memcpy(cage->faces, grid->quads, grid->quad_count * 4 * sizeof *cage->faces);
    memcpy(shell->patches, trial->fit.bezier, grid->quad_count * 48 * sizeof *shell->patches);
    for (uint32_t h = 0; h < 4 * grid->quad_count; h++)
        if (grid->sharp[h] && grid->links.twin[h] > h && grid->links.twin[h] != BAT_MESH_NONE)
            cage->creases[cage->crease_count++] =
                (bat_mesh_crease){grid->quads[h], grid->quads[h % 4 == 3 ? h - 3 : h + 1], BAT_MESH_SHARP};
    return BAT_OK;
}

/// Lengths and volumes in the unit of the input.
static bat_shell_report restore_report(double unit, const bat_shell_report *report)
{
    bat_shell_report restored = *report;
    double *lengths[] = {&restored.spacing, &restored.noise, &restored.rms, &restored.largest, &restored.held_out};
    for (size_t k = 0; k < sizeof lengths / sizeof *lengths; k++)
        *lengths[k] *= unit;
    restored.volume *= unit * unit * unit;
    restored.mesh_volume *= unit * unit * unit;
    return restored;
}

/// Anchor the patches that fold, and those around, as long as folds get fewer: places of their points begin anew, and points
/// of the mesh, whose places stay, are fitted, too.
/// @param folds receives how many are left
static bat_status unfold(const shell_work *work, shell_trial *trial, size_t *folds, bat_error *error)
{
    shell_fit *fit = &trial->fit, open = *fit;
    const uint32_t *quads = trial->grid.quads;
    size_t all = work->count + SHELL_ANCHORS * work->mesh.face_count, before = SIZE_MAX;
    bool *marks = memory_pool_zeros(&trial->pool, trial->grid.vertex_count, sizeof *marks),
         *held = memory_pool_array(&trial->pool, all, sizeof *held);
    bat_status status = memory_pool_check(&trial->pool, error);
    if (status == BAT_OK)
        status = shell_find_folds(fit, &work->mesh, marks, folds, error);
    fit->held = held;
    fit->count = all;
    while (status == BAT_OK && *folds > 0 && *folds < before)
    {
        for (size_t i = 0; i < all; i++)
        {
            bool near = false;
            for (size_t c = 0; c < 4; c++)
                near = near || marks[quads[4 * (size_t)fit->places[i].face + c]] ||
                       marks[quads[4 * (size_t)trial->first[i].face + c]];
            held[i] = i >= work->count && !near;
            fit->places[i] = near ? trial->first[i] : fit->places[i];
        }
        before = *folds;
        status = shell_fit_run(fit, UNFOLD_ROUNDS, error);
        if (status == BAT_OK)
            status = shell_find_folds(fit, &work->mesh, marks, folds, error);
    }
    *fit = open;
    return status;
}

/// Refuse a shell that its points contradict at some place.
static bat_status check_places(shell_work *work, const shell_fit *fit, bat_error *error)
{
    static const char *const TEXTS[] = {
        [SHELL_SHEETS] = "the points lie on two sheets near %.4g %.4g %.4g, nearer to each other than their points; more "
                         "points would tell them apart",
        [SHELL_MISSED] = "the shell misses a part of the points near %.4g %.4g %.4g; more points would tell its shape"};
    size_t worst = SIZE_MAX;
    shell_fault fault = SHELL_RIGHT;
    bat_status status = shell_find_fault(fit, &work->report, &fault, &worst, error);
    if (status != BAT_OK || fault == SHELL_RIGHT)
        return status;
    double place[3];
    memcpy(place, fit->points + 3 * worst, sizeof place);
    shell_restore(&work->frame, place, 1);
    work->split = fault == SHELL_SHEETS;
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, TEXTS[fault], place[0], place[1], place[2]);
}

/// Fit a number of faces to all points, and judge the shell.
/// @param strict whether it is wrong where folds stay
static bat_status fit_faces(shell_work *work, size_t faces, bool strict, bat_progress progress, bat_shell *shell,
                            bat_error *error)
{
    shell_trial trial = {0};
    bat_shell made = {0};
    size_t folds = 0;
    bat_status status = shell_trial_make(work, faces, &trial, error);
    trial.fit.progress = progress;
    work->report.turned = 0;
    if (status == BAT_OK)
        status = shell_trial_fit(&trial, ROUNDS, error);
    if (status == BAT_OK)
        status = unfold(work, &trial, &folds, error);
    work->folded = strict && (double)folds > MAX_FOLDED[work->sharp] * (double)trial.grid.quad_count;
    if (status == BAT_OK && work->folded)
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the shell folds at %zu places", folds);
    if (status == BAT_OK)
        status = shell_agree(&trial.grid, trial.fit.bezier, error);
    if (status == BAT_OK)
    {
        shell_fit_correct(&trial.fit);
        status = make_shell(&trial, &made, error);
    }
    if (status == BAT_OK)
        status = shell_measure(&made, &trial.fit, &work->mesh, &work->report, error);
    const bat_shell_report report = restore_report(work->unit, &work->report);
    if (status == BAT_OK && !work->options->force)
        status = shell_judge(&made, &report, work->unit * work->noise, error);
    if (status == BAT_OK && !work->options->force)
        status = check_places(work, &trial.fit, error);
    shell_trial_free(&trial);
    if (status == BAT_OK)
        *shell = made;
    else
        bat_shell_free(&made);
    return status;
}

/// Take the mesh with creases, or give it back.
static void swap_creases(shell_work *work)
{
    SWAP(work->mesh, work->creased);
    SWAP(work->points, work->creased_points);
    SWAP(work->closest, work->creased_closest);
    work->sharp = !work->sharp;
}

/// Fit the mesh with creases, where held-out points are nearer with it, by the layout of the nearer ones first.
/// @param fitted receives whether one is right; else `work` is as before
static bat_status fit_creases(shell_work *work, size_t faces, bool strict, bat_progress progress, bat_shell *shell,
                              bool *fitted, bat_error *error)
{
    double held[2] = {INFINITY, INFINITY}, smooth = work->report.held_out, normals = work->normals, largest;
    work->creased_points = work->points;
    swap_creases(work);
    bat_status status = shell_place_on_mesh(work, error);
    for (int k = 0; k < 2 && status == BAT_OK; k++)
    {
        work->normals = k * SHELL_NORMALS;
        status = shell_try_layout(work, faces, &held[k], &largest, error);
    }
    for (int k = 0; k < 2 && status == BAT_OK && !*fitted; k++)
    {
        int nearer = (held[1] < held[0]) != k;
        if (!(held[nearer] < (1 - MIN_CREASE_GAIN) * smooth))
            break;
        work->normals = nearer * SHELL_NORMALS;
        work->report.held_out = held[nearer];
        status = fit_faces(work, faces, strict, progress, shell, error);
        *fitted = status == BAT_OK;
        status = status == BAT_NO_CONVERGENCE ? BAT_OK : status;
    }
    if (!*fitted)
    {
        swap_creases(work);
        work->normals = normals;
        work->report.held_out = smooth;
    }
    return status == BAT_NO_CONVERGENCE ? BAT_OK : status;
}

/// Find the number of faces and fit. A shell that is wrong has too many faces for its points at some place: half as many
/// are tried then, with more smoothing (first as many, where it folds or its layout follows distances), and the first
/// failure is told where that fails too.
static bat_status fit_and_judge(shell_work *work, bat_shell *shell, bat_error *error)
{
    progress_part trials = {work->options->progress, CONNECT_SHARE, TRIAL_SHARE},
                  last = {work->options->progress, CONNECT_SHARE + TRIAL_SHARE, 1 - CONNECT_SHARE - TRIAL_SHARE};
    bat_status status = shell_place_on_mesh(work, error);
    if (status == BAT_OK && work->faces == 0)
        status = shell_find_layout(work, progress_of_part(&trials), error);
    size_t faces = work->faces;
    const bool strict = work->options->faces == 0 && faces > MIN_FACES;
    bool fitted = false;
    if (status == BAT_OK && work->creased.face_count > 0)
        status = fit_creases(work, faces, strict, progress_of_part(&last), shell, &fitted, error);
    if (status == BAT_OK && !fitted)
        status = fit_faces(work, faces, strict, progress_of_part(&last), shell, error);
    for (int k = 0; k < RETRIES && status == BAT_NO_CONVERGENCE && !work->split && (strict || work->normals > SHELL_NORMALS);
         k++)
    {
        bat_error failure;
        bool weighed = work->normals > SHELL_NORMALS, again = k == 0 && (work->folded || work->stiffness > 1 || weighed);
        work->normals = weighed ? 0 : work->normals;
        faces = again ? faces : faces / 2;
        work->stiffness = !again ? STIFFER * work->stiffness : work->folded ? FOLDED_STIFFER * work->stiffness : 1;
        status = fit_faces(work, faces, false, progress_of_part(&last), shell, &failure);
        if (status == BAT_OK && !work->options->force &&
            work->report.rms > fmax(MAX_STIFFER * work->report.held_out, STIFFER_SPACINGS * work->report.spacing))
        {
            bat_shell_free(shell);
            status = BAT_NO_CONVERGENCE;
        }
        if (status != BAT_OK && status != BAT_NO_CONVERGENCE)
            return error_copy(error, &failure);
    }
    if (status == BAT_OK)
    {
        shell_restore(&work->frame, shell->patches, shell->cage.face_count * 16);
        shell_restore(&work->frame, shell->cage.positions, shell->cage.vertex_count);
        work->report = restore_report(work->unit, &work->report);
    }
    return status;
}

/// As bat_shell_reconstruct_in_steps().
/// @param share of the spacing or the noise in a cell that connects points
/// @param again receives whether smaller cells may help
static bat_status reconstruct(const double *points, size_t count, const bat_mesh *mesh,
                              const bat_shell_reconstruct_options *options, const char *steps, double share, bool *again,
                              bat_shell *shell, bat_shell_report *report, bat_error *error)
{
    shell_work work = {.options = options, .steps = steps, .share = share, .stiffness = 1, .report = {.held_out = NAN}};
    progress_part first = {options->progress, 0, CONNECT_SHARE};
    bat_status status = mesh != NULL ? shell_take_mesh(&work, mesh, error) : shell_take_points(&work, points, count, error);
    if (status == BAT_OK && share == CELLS[0])
        status = shell_steps_load(&work, error);
    if (status == BAT_OK && work.mesh.channels == NULL)
        status = shell_make_meshes(&work, progress_of_part(&first), error);
    if (status == BAT_OK)
        status = fit_and_judge(&work, shell, error);
    *again = status == BAT_NO_CONVERGENCE && work.has_share && work.share == CELLS[0];
    bat_mesh_free(&work.mesh);
    bat_mesh_free(&work.creased);
    memory_pool_free(&work.pool);
    if (status == BAT_OK)
        *report = work.report;
    return status;
}

bat_status bat_shell_reconstruct_in_steps(const double *points, size_t count, const bat_mesh *mesh,
                                          const bat_shell_reconstruct_options *options, const char *steps, bat_shell *shell,
                                          bat_shell_report *report, bat_error *error)
{
    bat_shell_reconstruct_options wanted = options != NULL ? *options : bat_shell_reconstruct_defaults();
    bat_shell made = {0};
    bat_shell_report measured;
    bat_error failure;
    bool again;
    bat_status status = bat_options_check(&bat_shell_reconstruct_fields, &wanted, error);
    if (status != BAT_OK)
        return status;
    if (mesh != NULL && wanted.fill_holes > 0)
        return error_option(error, "fill_holes", "closes holes of points; close those of a mesh first, as batten mesh does");
    if (mesh == NULL && count < MIN_POINTS)
        return ERROR_ARGUMENT(error, "%zu points are too few: a shell needs %d", count, MIN_POINTS);
    status = reconstruct(points, count, mesh, &wanted, steps, CELLS[0], &again, &made, &measured, error);
    if (again)
    {
        progress_part done = {wanted.progress, 1, 0};
        wanted.progress = progress_of_part(&done);
        bat_status second = reconstruct(points, count, mesh, &wanted, steps, CELLS[1], &again, &made, &measured, &failure);
        // The first failure is told, but for one of the second's that has nothing to do with the points.
        status = second == BAT_OK || second == BAT_NO_CONVERGENCE ? second : error_copy(error, &failure);
    }
    if (status == BAT_OK && steps != NULL)
        (void)remove(steps);
    if (status == BAT_OK)
        *shell = made;
    if (status == BAT_OK && report != NULL)
        *report = measured;
    return status;
}

bat_status bat_shell_reconstruct(const double *points, size_t count, const bat_mesh *mesh,
                                 const bat_shell_reconstruct_options *options, bat_shell *shell, bat_shell_report *report,
                                 bat_error *error)
{
    return bat_shell_reconstruct_in_steps(points, count, mesh, options, NULL, shell, report, error);
}
