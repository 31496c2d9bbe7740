#include "verb.h"

#include "batten/batten.h"
#include "batten/research/networks.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// The job of `batten surface`.
typedef struct surface_job
{
    verb_call call;
    bat_cloud_read_options read;
    bat_mesh_notes notes;                                 ///< of reading
    size_t corners[4];                                    ///< points of the input
    const char *parameters, *model_file, *parameter_file; ///< files; may be null
    bat_surface_reconstruct_options options;
    bat_surface_edges edges;
    bat_surface_write_options write;
    bool converts; ///< IN is a surface, which is written in another format
    bat_cloud cloud;
    bat_surface_result result;
    bat_surface_primitive shape; ///< that the points lie on
    surface_written written;
    bool spline; ///< also where the points lie on a shape
    bool shell;  ///< the surface has any shape: asked for, or found
    bat_shell_reconstruct_options shell_options;
    const char *steps; ///< the file in which a shell keeps what was found; null: none
    bat_shell made;
    bat_shell_report shell_report;
    const char *cage; ///< file; may be null
    bat_surface_view view;
    number_list bands;
} surface_job;

static const option_spec OPTIONS[] = {
    {"parameterization",
     "NAME",
     METHOD,
     COMMON,
     "{}, or a file with u v of each point of IN; default auto: what fits best by measure",
     {FIELD_NONE, 0, 0, 0, 0, &bat_surface_parameters_family}},
    {"trim", NULL, METHOD, COMMON,
     "fit over a rectangle around the points, and cut along their outline, which may be concave, and their holes",
     FLAG(surface_job, options.trim)},
    {"shell", NULL, METHOD, COMMON,
     "a surface of any shape, of patches with shared sides: closed, with holes, in pieces; default for what is closed",
     FLAG(surface_job, shell)},
    {"patches", "N", METHOD, 0, "with --shell: about this number of patches; default: as many as bring points nearer",
     WHOLE(surface_job, shell_options.faces, 6, 1000000)},
    {"spans", "N", METHOD, 0, "of a shell: spans of a patch in each direction, 2 to 16; more make fewer patches; default 2",
     WHOLE(surface_job, shell_options.spans, 2, 16)},
    {"crease-angle", "DEG", METHOD, 0, "of a shell: edges beyond this angle stay sharp; 0: none; default 40",
     DEGREES(surface_job, shell_options.crease, 0)},
    {"resume", "FILE", METHOD, 0,
     "of a shell: keep what is found in FILE, and begin with it; the file goes when the shell is made",
     TEXT(surface_job, steps)},
    {"fill-holes", "D", METHOD, 0, "with --trim or --shell: close holes of at most this diameter",
     NUMBER(surface_job, options.fill_holes)},
    {"close-gaps", "W", METHOD, 0, "with --trim: close gaps that no circle of a larger diameter fits into",
     NUMBER(surface_job, options.close_gaps)},
    {"edges", "NAME", METHOD, 0,
     "with --trim: cut along {}: as the points show, polygons of them, smooth curves; default auto",
     CHOICE(surface_job, edges, bat_surface_edges_family)},
    {"model", "FILE", METHOD, IS_READ, "learned: a network of your own, a safetensors file", TEXT(surface_job, model_file)},
    {"published", NULL, METHOD, 0, "classical neighbourhoods as published: they may fail",
     FLAG(surface_job, options.published)},
    {"slide-boundary", NULL, METHOD, 0, "no border curves: corrections move boundary parameters along their sides",
     FLAG(surface_job, options.slide_boundary)},
    {"keep-folds", NULL, METHOD, 0, "report folds of the parameters, but do not remove them",
     CLEARS(surface_job, options.repair)},
    {"corners", "A,B,C,D", METHOD, 0, "these points of IN, counted from 0, get (0,0), (1,0), (1,1), (0,1); default: found",
     NO_FIELD},
    {"sides", "NAME", METHOD, 0, "parameters along the sides: {}; default chord-length",
     CHOICE(surface_job, options.sides, bat_cloud_sides_family)},
    {"boundary", "N|FILE", INPUT, COMMON | IS_READ,
     "the first N points are the boundary loop, or FILE's are; default: found, or told in IN", NO_FIELD},
    {"strict", NULL, INPUT, 0, "refuse points that repeat another instead of leaving them out",
     FLAG(surface_job, read.strict)},
    {"class", "N,...", INPUT, 0, "of LAS: read these classes alone, as 2 for ground; default: all but 7 and 18, noise",
     TEXT(surface_job, read.classes)},
    {"max-points", "N", INPUT, 0,
     "the most points that compression and copies in IN may make; default: 2^20, and one for each byte",
     WHOLE(surface_job, read.limits.points, 1, 1e12)},
    {"from", "FORMAT", INPUT, 0,
     "the format of IN, see `batten list formats`; default: by the file's ending, failing that by its content",
     CHOICE(surface_job, read.format, bat_cloud_format_family)},
    {"force", NULL, RESULT, 0, "write also a surface that the points prove wrong", FLAG(surface_job, options.force)},
    {"keep-spline", NULL, RESULT, 0, "of STEP: a spline also where the points lie on a plane, sphere, cylinder or cone",
     FLAG(surface_job, spline)},
    {"cage", "FILE", RESULT, IS_WRITTEN, "with --shell: write the control points as a mesh of quads, .obj with creases",
     TEXT(surface_job, cage)},
    {"parameters", "FILE", RESULT, IS_WRITTEN, "write u v of each point, in the order of IN", TEXT(surface_job, parameters)},
    {"picture", "FILE", PICTURE, COMMON | IS_DRAWN,
     "draw surface and distances, of a patch also cloud and parameters (.png, .svg or .pdf)", NO_FIELD},
    {"bands", "T,...", PICTURE, 0, "colour the points of the picture by these distances and by side, as 0.1,0.2", NO_FIELD},
    {"view", "NAME", PICTURE, 0, "of the surface in the picture: {}; default shaded",
     CHOICE(surface_job, view, bat_surface_view_family)},
    END_OF_OPTIONS,
};

/// A whole number of 0 or more; false where the text is anything else.
static bool is_count(const char *text, const char **end, size_t *count)
{
    char *stop;
    if (*text < '0' || *text > '9')
        return false;
    unsigned long long value = strtoull(text, &stop, 10);
    *end = stop;
    *count = (size_t)value;
    return value < LONG_MAX;
}

/// What the command line says about the cloud. False after a message.
static bool read_input(surface_job *job)
{
    const arguments *given = job->call.given;
    const char *boundary = argument(given, "boundary"), *corners = argument(given, "corners");
    const char *at = corners;
    for (int k = 0; k < 4 && corners != NULL; k++, at++)
        if (!is_count(at, &at, &job->corners[k]) || *at != (k < 3 ? ',' : '\0'))
            return argument_refused(given, "corners", "four numbers of points, as in 0,33,66,99");
    job->read.corners = corners != NULL ? job->corners : NULL;
    const char *end;
    if (boundary != NULL && (!is_count(boundary, &end, &job->read.boundary) || *end != '\0'))
    {
        job->read.boundary = 0;
        job->read.boundary_path = boundary;
    }
    return boundary == NULL || job->read.boundary_path != NULL || job->read.boundary >= 4 ||
           argument_refused(given, "boundary", "a file, or a number of points from 4");
}

/// A name, or the file of given parameters, which has a dot or a slash in its name.
static bool read_parameterization(surface_job *job)
{
    const arguments *given = job->call.given;
    const char *text = argument(given, "parameterization");
    if (text == NULL)
        return true;
    bat_error error;
    const bat_choice *choice;
    if (bat_choice_find(&bat_surface_parameters_family, text, &choice, &error) == BAT_OK)
    {
        job->options.parameters = (bat_surface_parameters)choice->value;
        return true;
    }
    job->options.parameters = BAT_SURFACE_PARAMETERS_GIVEN;
    job->parameter_file = text;
    if (strpbrk(text, "./") != NULL)
        return true;
    return usage_refused(given, "%s, or a file such as ./%s", error.text, text);
}

/// The distances that bound colours of a picture.
static bool read_bands(surface_job *job)
{
    const number_list *bands = &job->bands;
    bool rises = argument_list(job->call.given, "bands", 1e-9, 1e9, false, &job->bands);
    for (size_t k = 1; k < bands->count; k++)
        rises = rises && bands->numbers[k] > bands->numbers[k - 1];
    return (rises && bands->count <= BAT_SURFACE_MAX_BANDS) ||
           (bands->count > 0 &&
            argument_refused(job->call.given, "bands", "up to %d distances that rise", BAT_SURFACE_MAX_BANDS));
}

/// The name of an option that has no part in a conversion; null when none is given.
static const char *find_fit_option(const arguments *given)
{
    static const char *const CONVERTS[] = {"output", "to", "unit", "samples", "picture", "view", "json", "quiet", NULL};
    const option_spec *option;
    for (size_t i = 0; (option = option_at(given->verb, i, NULL)) != NULL; i++)
    {
        size_t k = 0;
        while (CONVERTS[k] != NULL && strcmp(CONVERTS[k], option->name) != 0)
            k++;
        if (CONVERTS[k] == NULL && given->values[i] != NULL)
            return option->name;
    }
    return NULL;
}

static void begin(void *to)
{
    surface_job *job = to;
    job->options = bat_surface_reconstruct_defaults();
    job->shell_options = bat_shell_reconstruct_defaults();
    job->read.notes = &job->notes;
    job->written.area = NAN;
}

static bool check(void *of)
{
    surface_job *job = of;
    const arguments *given = job->call.given;
    job->options.fit.threads = job->call.threads;
    if (!read_input(job) || !surface_check_fit(given, &job->options.fit) || !read_parameterization(job) || !read_bands(job))
        return false;
    bool inspects = job->bands.count > 0 || argument(given, "view") != NULL;
    const usage_rule rules[] = {
        {job->model_file != NULL && job->options.parameters > BAT_SURFACE_PARAMETERS_LEARNED,
         "--model goes with auto and learned parameters"},
        {argument(given, "fill-holes") != NULL && !job->options.trim && !job->shell,
         "--fill-holes goes with --trim or --shell"},
        {argument(given, "close-gaps") != NULL && !job->options.trim, "--close-gaps goes with --trim"},
        {argument(given, "edges") != NULL && !job->options.trim, "--edges goes with --trim"},
        {inspects && job->call.picture == NULL, "--bands and --view go with --picture"},
        {job->shell && job->options.trim, "--trim and --shell exclude each other"},
        {argument(given, "crease-angle") != NULL && job->options.trim, "--crease-angle goes with shells, not with --trim"},
        {job->steps != NULL && job->options.trim, "--resume goes with shells, not with --trim"},
        {argument(given, "spans") != NULL && job->options.trim, "--spans goes with shells, not with --trim"},
        {job->shell && (job->parameters != NULL || job->parameter_file != NULL || argument(given, "functions") != NULL),
         "a shell has patches, not functions and parameters of one square: leave out --shell, or give --patches"},
        {job->options.trim && job->options.parameters != BAT_SURFACE_PARAMETERS_AUTO,
         "--trim and --parameterization exclude each other: a trimmed surface has a chart of its own"},
    };
    if (!usage_obeys(given, rules, sizeof rules / sizeof *rules, NULL, NULL) ||
        !argument_ending(given, &bat_surface_format_family, (int)job->write.format))
        return false;
    // A file that holds a spline surface, by its name, leaves nothing to fit.
    const bat_choice *row;
    (void)bat_choice_of_path(&bat_surface_format_family, job->call.input, true, &row, NULL);
    bat_surface_format format = row != NULL ? (bat_surface_format)row->value : BAT_SURFACE_FORMAT_AUTO;
    job->converts = format == BAT_SURFACE_FORMAT_XML || format == BAT_SURFACE_FORMAT_JSON ||
                    format == BAT_SURFACE_FORMAT_STEP || format == BAT_SURFACE_FORMAT_IGES;
    const char *option = job->converts ? find_fit_option(given) : NULL;
    return option == NULL || usage_refused(given, "IN is a spline surface already: --%s goes with points", option);
}

// Shells

/// Whether another surface is to follow the failure of a patch.
static bool leads_on(surface_job *job, const bat_error *failure)
{
    bool outlined = job->read.boundary > 0 || job->read.boundary_path != NULL || job->read.corners != NULL;
    return bat_shell_follows(&job->options, outlined || job->model_file != NULL || job->parameters != NULL, failure,
                             &job->shell_options);
}

/// Whether a shell is to follow the failure of a patch, and can be written.
static bool leads_to_shell(surface_job *job)
{
    const bat_choice *row = NULL;
    if (job->call.output != NULL && job->write.format == BAT_SURFACE_FORMAT_AUTO)
        (void)bat_choice_of_path(&bat_surface_format_family, job->call.output, true, &row, NULL);
    int format = row != NULL ? row->value : (int)job->write.format;
    return leads_on(job, report_error()) &&
           (format == BAT_SURFACE_FORMAT_AUTO || format == BAT_SURFACE_FORMAT_STEP || format == BAT_SURFACE_FORMAT_OBJ);
}

/// Draw the shell, and the points that it was fitted to.
static bat_status draw_shell(const surface_job *job, const double *points, size_t count)
{
    const bat_surface_inspection inspection = {job->view, job->bands.numbers, job->bands.count};
    const bat_shell_report *report = &job->shell_report;
    char title[240];
    (void)snprintf(title, sizeof title, "%s shell of %zu patches: root mean square distance of the points %.3g",
                   job->made.closed ? "closed" : "open", job->made.face_count, report->rms);
    return bat_shell_picture_write(output_path(&job->call.files, "picture"), title, &job->made, points, count, &inspection,
                                   NULL, report_error());
}

static int make_shell(surface_job *job)
{
    bat_shell_reconstruct_options *options = &job->shell_options;
    bat_mesh read = {0};
    const bat_mesh patch = {.positions = job->cloud.points,
                            .faces = job->cloud.triangles,
                            .vertex_count = job->cloud.count,
                            .face_count = job->cloud.triangle_count};
    const bat_mesh *mesh = patch.face_count > 0 ? &patch : NULL;
    bat_status status = BAT_OK;
    job->shell = true;
    if (job->cloud.count == 0)
    {
        status = bat_mesh_read(job->call.input, NULL, &read, report_error());
        mesh = &read;
    }
    (void)bat_shell_follows(&job->options, false, report_error(), options);
    options->progress = report_progress("fitting");
    if (status == BAT_OK)
        status = bat_shell_reconstruct_in_steps(job->cloud.points, job->cloud.count, mesh, options, job->steps, &job->made,
                                                &job->shell_report, report_error());
    int code = report_status(job->call.given, job->call.input, status);
    if (code == EXIT_DONE && job->cage != NULL)
        code = report_status(NULL, job->cage,
                             bat_mesh_write(output_path(&job->call.files, "cage"), &job->made.cage, NULL, report_error()));
    if (code == EXIT_DONE && job->call.picture != NULL)
        code = report_status(NULL, job->call.picture,
                             read.vertex_count > 0 ? draw_shell(job, read.positions, read.vertex_count)
                                                   : draw_shell(job, job->cloud.points, job->cloud.count));
    bat_mesh_free(&read);
    return code;
}

static const double DEGREES = 57.29577951308232;

static int report_shell(const surface_job *job)
{
    const bat_shell *shell = &job->made;
    const bat_shell_report *report = &job->shell_report;
    double tolerance = job->shell_options.tolerance;
    char fact[64];
    if (job->call.quiet)
        return EXIT_DONE;
    if (shell->closed)
        (void)snprintf(fact, sizeof fact, "volume %.6g", report->volume);
    else
        (void)snprintf(fact, sizeof fact, "%zu boundary loops", report->holes);
    const bat_surface_result known = {.noise = report->noise};
    json_t *object = report_part(
        job->call.json,
        "{input}: {points} points, noise about {noise:.3g}\n"
        "{kind} shell of {faces} patches, {control} control points; {fact}\n"
        "distance of the points: root mean square {rms:.4g}, largest {largest:.4g}; held out {held_out:.4g}; {missed} "
        "missed\n"
        "[!reached?the tolerance is not reached\n]"
        "normals across patches: 99 % below {jump_99:.2g}, largest {jump_largest:.2g} degrees apart\n"
        "pieces {pieces}, left out {dropped_pieces}; holes closed {filled}; false handles cut {cut_handles}; patches that "
        "cross others {crossings}\n",
        "-input:s points:z noise:n -kind:s faces:z control:z -fact:s rms:n largest:n held_out:n jump_99:n jump_largest:n "
        "volume:n "
        "mesh_volume:n pieces:z holes:z filled:z dropped_pieces:z closed:b spacing:n missed:z cut_handles:z crossings:z "
        "reached:b",
        job->call.input, report->points, report->noise, shell->closed ? "closed" : "open", shell->face_count,
        shell->cage.vertex_count, fact, report->rms, report->largest, report->held_out, report->normal_jump[1] * DEGREES,
        report->normal_jump[2] * DEGREES, report->volume, report->mesh_volume, report->pieces, report->holes, report->filled,
        report->dropped_pieces, (int)shell->closed, report->spacing, report->missed, report->cut_handles, report->crossings,
        (int)(!(tolerance > 0) || report->largest <= tolerance));
    bat_surface_primitive found = {.kind = BAT_SURFACE_PRIMITIVE_NONE};
    if (job->cloud.points != NULL)
        (void)bat_surface_find_primitive(&job->cloud, &known, &found, report_error());
    json_t *shape = surface_shape(&found, NULL, job->call.json);
    return report_whole(job->call.json, job->call.json ? report_add(object, "shape", shape) : NULL);
}

// A fit

/// Try a trimmed surface where a patch is refused, or closes a gap. Take it if it is right, and instead of a right patch if
/// it closes none, or a smaller one.
/// @param patch the status of the patch
static bat_status try_trimmed(surface_job *job, bat_surface_reconstruct_options options, bat_status patch)
{
    bat_surface_doubt doubt = job->result.verdict.doubt;
    bool closes = patch == BAT_OK && (doubt == BAT_SURFACE_DOUBT_GAP || doubt == BAT_SURFACE_DOUBT_AREA);
    if (!(closes || (patch != BAT_OK && strcmp(report_error()->remedy, "trim") == 0)) ||
        !leads_on(job, &(bat_error){.remedy = "shell"}))
        return patch;
    bat_cloud cloud;
    bat_surface_result trimmed = {0};
    options.trim = true;
    bat_status status = bat_cloud_copy(&job->cloud, &cloud, report_error());
    if (status != BAT_OK)
        return status;
    cloud.boundary_count = 0;
    cloud.has_corners = false;
    status = bat_surface_reconstruct_edges(&cloud, &options, job->edges, &trimmed, report_error());
    const bat_surface_verdict *verdict = &trimmed.verdict;
    bool is_better = verdict->fault == BAT_SURFACE_FAULT_NONE &&
                     (verdict->doubt != BAT_SURFACE_DOUBT_GAP || verdict->doubt_size < job->result.verdict.doubt_size);
    if (status == BAT_OK && (patch != BAT_OK || is_better))
    {
        const bat_surface_result result = job->result;
        const bat_cloud points = job->cloud;
        job->result = trimmed;
        job->cloud = cloud;
        trimmed = result;
        cloud = points;
    }
    bat_surface_result_free(&trimmed);
    bat_cloud_free(&cloud);
    return patch == BAT_OK && status != BAT_CANCELLED && status != BAT_NO_MEMORY ? BAT_OK : status;
}

static int reconstruct(surface_job *job)
{
    bat_surface_model *model = NULL;
    double *given = NULL;
    int code = EXIT_DONE;
    if (job->model_file != NULL)
        code =
            report_status(NULL, job->model_file, bat_surface_model_read_published(job->model_file, &model, report_error()));
    if (code == EXIT_DONE && job->parameter_file != NULL)
        code = report_status(NULL, job->parameter_file,
                             bat_cloud_parameters_read(job->parameter_file, &job->cloud, &given, report_error()));
    if (code == EXIT_DONE)
    {
        bat_surface_reconstruct_options options = job->options;
        options.model = model;
        options.given = given;
        options.fit.progress = report_progress("fitting");
        bat_status status = bat_surface_reconstruct_edges(&job->cloud, &options, job->edges, &job->result, report_error());
        status = try_trimmed(job, options, status);
        code = status != BAT_OK && leads_to_shell(job) ? make_shell(job)
                                                       : report_status(job->call.given, job->call.input, status);
    }
    bat_surface_model_free(model);
    free(given);
    return code;
}

/// Draw a row: of a fit, or of a surface that is converted.
static int draw_row(const surface_job *job, const bat_surface_picture_row *row)
{
    const bat_surface_inspection inspection = {job->view, job->bands.numbers, job->bands.count};
    return report_status(
        job->call.given, job->call.picture,
        bat_surface_picture_inspect(output_path(&job->call.files, "picture"), row, 1, &inspection, NULL, report_error()));
}

static int draw(const surface_job *job)
{
    const bat_surface_result *result = &job->result;
    char title[240], verdict[SURFACE_VERDICT_SIZE];
    const bat_surface_fit_round *last = &result->report.rounds[result->report.count - 1];
    (void)snprintf(title, sizeof title, "%s parameters, %zu functions: mean squared distance %.3g; verdict: %s",
                   bat_choice_name(&bat_surface_parameters_family, (int)result->chosen), last->functions, last->mean_squared,
                   surface_verdict(&result->verdict, verdict));
    return draw_row(job, &(bat_surface_picture_row){.title = title,
                                                    .cloud = &job->cloud,
                                                    .surface = &result->surface,
                                                    .distances = result->report.distances,
                                                    .parameters = result->parameters});
}

/// Whether the spline meets a tolerance that the shape does not.
static bool misses_tolerance(const surface_job *job)
{
    double tolerance = job->options.fit.tolerance;
    return tolerance > 0 && job->result.report.reached && job->shape.largest > tolerance;
}

/// Write the surface; the distances of a cloud go along where the format holds them.
static int write_surface(void *of, const char *path)
{
    surface_job *job = of;
    bat_surface_write_options write = job->write;
    if (job->shell)
        return report_status(job->call.given, job->call.output, bat_shell_write(path, &job->made, &write, report_error()));
    if (!job->converts)
    {
        write.points = job->cloud.points;
        write.errors = job->result.report.distances;
        write.point_count = job->cloud.count;
    }
    bat_surface_primitive shape = job->shape;
    if (job->spline || misses_tolerance(job))
        shape.kind = BAT_SURFACE_PRIMITIVE_NONE;
    return report_status(job->call.given, job->call.output,
                         bat_surface_write_shape(path, &job->result.surface, &shape, &write, job->written.edges,
                                                 &job->written.area, report_error()));
}

// A conversion

static int report_converted(const surface_job *job)
{
    const bat_spline_surface *surface = &job->result.surface;
    const bat_hierarchical_options space = bat_hierarchical_space_options(surface->space);
    const int *degree = space.degree;
    if (job->call.quiet)
        return EXIT_DONE;
    return report_print(job->call.json, "{input}: bidegree ({p}, {q}), {functions} functions on {levels} levels\n",
                        "-input:s -p:i -q:i degree:o functions:z levels:z dimension:z", job->call.input, degree[0],
                        degree[1], json_pack("[i, i]", degree[0], degree[1]),
                        (size_t)bat_hierarchical_space_functions(surface->space),
                        (size_t)bat_hierarchical_space_levels(surface->space), (size_t)surface->dimension);
}

static int make(void *of)
{
    surface_job *job = of;
    const char *in = job->call.input, *parameters = output_path(&job->call.files, "parameters");
    if (job->converts)
    {
        if (bat_surface_read(in, &job->result.surface, report_error()) != BAT_OK)
            return report_bad_input(job->call.given, in, report_error());
        return job->call.picture == NULL
                   ? EXIT_DONE
                   : draw_row(job, &(bat_surface_picture_row){.title = in, .surface = &job->result.surface});
    }
    bat_status status = bat_cloud_read(in, &job->read, &job->cloud, report_error());
    print_file_notes(&job->call, &job->notes);
    if ((status == BAT_OK && job->shell) || (status != BAT_OK && leads_to_shell(job)))
        return make_shell(job);
    int code = report_status(job->call.given, in, status);
    if (code == EXIT_DONE)
        code = reconstruct(job);
    if (job->shell)
        return code;
    if (code == EXIT_DONE)
        code = report_status(job->call.given, in,
                             bat_surface_find_primitive(&job->cloud, &job->result, &job->shape, report_error()));
    if (code == EXIT_DONE && job->call.picture != NULL)
        code = draw(job);
    if (code == EXIT_DONE && job->parameters != NULL)
        code = report_status(NULL, job->parameters,
                             bat_cloud_parameters_write(parameters, &job->cloud, job->result.parameters, report_error()));
    return code;
}

static int report(void *of)
{
    const surface_job *job = of;
    if (job->converts)
        return report_converted(job);
    if (job->shell)
        return report_shell(job);
    surface_findings findings = {job->call.input, &job->cloud, &job->options, &job->result,
                                 &job->notes,     &job->shape, &job->written};
    int code = EXIT_DONE;
    if (job->call.json)
        code = report_json(surface_report(&findings, true));
    else if (!job->call.quiet)
        (void)surface_report(&findings, false);
    if (!job->result.below_noise)
        return code;
    report_text(stderr, "batten: %s: the tolerance is below the noise (about %.3g); the best surface so far is written\n",
                job->call.input, job->result.noise);
    return EXIT_BAD_INPUT;
}

static void end(void *of)
{
    surface_job *job = of;
    bat_surface_result_free(&job->result);
    bat_shell_free(&job->made);
    bat_cloud_free(&job->cloud);
    bat_mesh_notes_free(&job->notes);
}

const verb VERB_SURFACE = {
    .name = "surface",
    .arguments = "IN... [-o OUT] [--tolerance T|--functions N] [--picture FILE] [options]",
    .summary = "fit a spline surface to scattered points, to CAD files and a picture",
    .about = "Fit an adaptive spline surface to the points of a file (see `batten list formats`; - for standard input): a "
             "patch with one boundary, or a mesh of one. A spline surface (.xml, .json) as IN is written in another format.",
    .example = "batten surface scan.ply --tolerance 0.05 -o scan.step --picture scan.png",
    .options = {{SURFACE_FIT_OPTIONS, offsetof(surface_job, options.fit)},
                {OPTIONS, 0},
                {SURFACE_WRITE_OPTIONS, offsetof(surface_job, write)}},
    .formats = &bat_surface_format_family,
    .job_size = sizeof(surface_job),
    .calls = {begin, check, make, write_surface, report, end},
};
