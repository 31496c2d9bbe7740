#include "reproduce.h"

#include "report.h"

#include "batten/research/networks.h"
#include "batten/spline.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/// When a result writes pictures.
typedef enum pictures
{
    NEVER,
    WITH_FOLDER, ///< when a folder is given
    ALWAYS,
    TRAINING ///< never, but a folder contains trainings
} pictures;

/// How a result uses given meshes.
typedef enum meshes
{
    NO_MESHES,
    SUBDIVIDES, ///< decimates and subdivides them
    LEARNS      ///< trains on them
} meshes;

/// How a result uses clouds.
typedef enum cloud_use
{
    NO_CLOUDS,
    ABLATES, ///< trains two networks, or uses given ones
    DRAWS,   ///< draws random clouds
    SCANS,   ///< reads clouds from a folder
    MAKES    ///< samples built-in shapes
} cloud_use;

enum
{
    MAX_SHAPES = MAX_POSITIONAL - 1,
    MAX_NUMBER = 1000000
};

static const struct
{
    const char *name;
    int (*run)(const reproduce_job *job);
    pictures drawn;
    bool learned; ///< accepts a network
    bool seeded;  ///< accepts a seed
    bool sets;    ///< accepts other sets of curves
    const char *summary;
    meshes meshes;
    size_t max_meshes;
    const char *folder; ///< the default one of ALWAYS and TRAINING
    cloud_use clouds;
    const char *data; ///< files required by SCANS, or of curves
    bool reads_truth; ///< reads curves or meshes from a folder
    bool may_read;    ///< reads a folder where one is given
} RESULTS[] = {
    {.name = "curve-figures",
     .run = reproduce_curve_figures,
     .drawn = ALWAYS,
     .summary = "the figures of the curve-scheme study: ten shapes at levels 0, 1, 2, 10, 20",
     .folder = "out"},
    {.name = "tension-table1",
     .run = reproduce_tension_table1,
     .drawn = WITH_FOLDER,
     .learned = true,
     .sets = true,
     .summary = "table 1 of the tension paper: 240 validation curves, or 900 test curves, all schemes, both signs"},
    {.name = "tension-table2",
     .run = reproduce_tension_table2,
     .learned = true,
     .seeded = true,
     .summary = "table 2 of the tension paper: largest angles where the control points are disturbed"},
    {.name = "tension-table3",
     .run = reproduce_tension_table3,
     .drawn = TRAINING,
     .seeded = true,
     .summary = "table 3 of the tension paper: how the network learns of the space; trains for 100 epochs three times",
     .folder = "out/tension-ablations"},
    {.name = "tension-table4",
     .run = reproduce_tension_table4,
     .drawn = TRAINING,
     .seeded = true,
     .summary = "table 4 of the tension paper: the loss without one term; trains for 100 epochs four times",
     .folder = "out/tension-ablations"},
    {.name = "tension-iss",
     .run = reproduce_tension_iss,
     .drawn = WITH_FOLDER,
     .learned = true,
     .summary = "table 5 of the tension paper: the ISS ground track"},
    {.name = "tension-mechanism",
     .run = reproduce_tension_mechanism,
     .drawn = WITH_FOLDER,
     .learned = true,
     .summary = "section 9 of the tension paper: a network's effective tension, and its Lipschitz constant (remark 4)"},
    {.name = "real-curves",
     .run = reproduce_real_curves,
     .learned = true,
     .summary =
         "curves that people have, sampled evenly, unevenly and by simplification: schemes and splines against the truth",
     .data = "FAMILY-truth.csv and FAMILY-SAMPLING.csv",
     .reads_truth = true},
    {.name = "hermite-figures",
     .run = reproduce_hermite_figures,
     .drawn = ALWAYS,
     .summary =
         "figures 1 to 4 of the Hermite paper: tensors, orders 1, 3 and 10, a spiral, rotations, beside parallel transport",
     .folder = "out"},
    {.name = "hermite-order",
     .run = reproduce_hermite_order,
     .summary =
         "the Hermite paper's claims measured in nine spaces: orders, geodesics, proximity, contraction, displacement"},
    {.name = "motion-keyframes",
     .run = reproduce_motion_keyframes,
     .summary = "motions of which every k-th pose is kept: splines in time beside scipy's; with --data a recorded one too",
     .data = "fr1-xyz.txt",
     .may_read = true},
    {.name = "mesh-table2",
     .run = reproduce_mesh_table2,
     .drawn = WITH_FOLDER,
     .learned = true,
     .summary = "table 2 of Neural Subdivision with shapes of your own: decimated, subdivided twice, measured",
     .meshes = SUBDIVIDES,
     .max_meshes = MAX_SHAPES},
    {.name = "real-meshes",
     .run = reproduce_real_meshes,
     .learned = true,
     .summary =
         "coarse meshes that other programs made of known shapes: learned, butterfly, Loop and flat against the truth",
     .data = "SHAPE.obj and coarse-by/SHAPE-VERTICES-WAY.off",
     .reads_truth = true},
    {.name = "mesh-ablations",
     .run = reproduce_mesh_ablations,
     .drawn = TRAINING,
     .seeded = true,
     .summary = "section 6, appendices G and H of Neural Subdivision: the network without its parts; trains six times, some "
                "minutes",
     .meshes = LEARNS,
     .max_meshes = MAX_SHAPES,
     .folder = "out/mesh-ablations"},
    {.name = "mesh-style",
     .run = reproduce_mesh_style,
     .drawn = TRAINING,
     .seeded = true,
     .summary = "figures 26 and 27 of Neural Subdivision: one cage, a smooth and a sharp teacher; trains twice",
     .meshes = LEARNS,
     .max_meshes = 2,
     .folder = "out/mesh-style"},
    {.name = "surface-ablation",
     .run = reproduce_surface_ablation,
     .drawn = TRAINING,
     .learned = true,
     .seeded = true,
     .summary = "section 6.1 of the BIDGCN paper: a network with and without the boundary-informed layer; trains twice, "
                "some minutes",
     .folder = "out/surface-ablation",
     .clouds = ABLATES},
    {.name = "surface-clouds",
     .run = reproduce_surface_clouds,
     .learned = true,
     .seeded = true,
     .summary = "figures 5 to 9 of the BIDGCN paper: errors, times and failures of parameterizations on random clouds",
     .clouds = DRAWS},
    {.name = "surface-nefertiti",
     .run = reproduce_surface_nefertiti,
     .drawn = WITH_FOLDER,
     .learned = true,
     .summary = "figures 12 and 14 of the BIDGCN paper: six clouds of a bust, and an adaptive fit of the largest",
     .clouds = SCANS,
     .data = "nefertiti-532.xyz, -1043, -2062, -3253, -6024 and -8818"},
    {.name = "surface-face",
     .run = reproduce_surface_face,
     .drawn = WITH_FOLDER,
     .learned = true,
     .summary = "figure 15 of the BIDGCN paper: adaptive fits of a face of bidegrees (3, 3) and (4, 4)",
     .clouds = SCANS,
     .data = "face-9283.xyz"},
    {.name = "surface-shapes",
     .run = reproduce_surface_shapes,
     .drawn = WITH_FOLDER,
     .learned = true,
     .summary = "figure 16 of the BIDGCN paper: a ship hull and a turbine blade of our own, bidegree (5, 2)",
     .clouds = MAKES},
    {.name = "scan-verdict",
     .run = reproduce_scan_verdict,
     .seeded = true,
     .summary = "surfaces of crops of meshes and of deep shapes, with noise: which are right, and which the verdict refuses",
     .data = "meshes (OBJ, OFF, PLY)",
     .reads_truth = true},
};
enum
{
    RESULT_COUNT = sizeof RESULTS / sizeof RESULTS[0]
};

bool reproduce_row(size_t index, const char **name, const char **summary)
{
    if (index >= RESULT_COUNT)
        return false;
    *name = RESULTS[index].name;
    *summary = RESULTS[index].summary;
    return true;
}

static const option_spec OPTIONS[] = {
    {"output", "FOLDER", RESULT, COMMON,
     "where pictures go; default: out for curve-figures and hermite-figures, no picture for tension-table1, -iss and "
     "-mechanism. tension-table3 and -table4: folder of the trainings, which are resumed; default out/tension-ablations. "
     "mesh-ablations, mesh-style: the same, and the picture of the latter; default out/ and their name",
     TEXT(reproduce_job, folder)},
    {"model", "FILE", METHOD, COMMON,
     "tension-table1, -table2, -iss: a learned tension, for a row \"learned-published\"; tension-mechanism: the one to look "
     "into; real-curves, mesh-table2: a learned scheme, for rows \"given\"; surface-…: a network instead of the one that "
     "comes with batten",
     TEXT(reproduce_job, model)},
    {"data", "FOLDER", INPUT, COMMON,
     "mesh-table2: all shapes of a folder but those that the networks learned from; real-curves, motion-keyframes, "
     "surface-nefertiti, -face: where the curves, motions or clouds are",
     TEXT(reproduce_job, data)},
    {"seed", "N", METHOD, COMMON,
     "tension-table2: of the noise; surface-clouds, scan-verdict: of the clouds; tension-table3, -table4, mesh-ablations, "
     "mesh-style, surface-ablation: of the trainings; default 1",
     WHOLE(reproduce_job, seed, 0, 1000000000)},
    {"uninformed", "FILE", METHOD, 0,
     "surface-ablation: a network that does not know the boundary, beside --model; else it is trained",
     TEXT(reproduce_job, uninformed)},
    {"set", "NAME", INPUT, 0, "tension-table1: published (default), resampled or unseen curves", NO_FIELD},
    {"vertices", "N", METHOD, 0, "mesh-table2: number of vertices of the decimated shapes; default 400",
     WHOLE(reproduce_job, vertices, 4, MAX_NUMBER)},
    {"epochs", "E", METHOD, 0,
     "epochs of each training; mesh-ablations, mesh-style: default 60; surface-ablation: default 10",
     WHOLE(reproduce_job, epochs, 1, MAX_NUMBER)},
    {"pairs", "N", METHOD, 0, "mesh-ablations, mesh-style: coarse meshes of each shape; default 50",
     WHOLE(reproduce_job, pairs, 1, MAX_NUMBER)},
    {"clouds", "N", METHOD, 0, "surface-clouds, surface-ablation: random clouds of each case; default 100",
     WHOLE(reproduce_job, clouds, 1, MAX_NUMBER)},
    {"corrections", "N", METHOD, 0,
     "surface-nefertiti, -face, -shapes: parameter corrections after each fit; default 1, as published",
     WHOLE(reproduce_job, corrections, 0, 100)},
    {"points", "LIST", METHOD, 0, "surface-clouds: interior points of a cloud; default 50,100,200,500,1000,2000,5000",
     NO_FIELD},
    {"noise", "LIST", METHOD, 0, "surface-clouds: standard deviations; default 0,0.005,0.01,0.05", NO_FIELD},
    {"degrees", "LIST", METHOD, 0, "surface-clouds: of surface and fit; default 2,3,4,5: a quarter of an hour in all",
     NO_FIELD},
    END_OF_OPTIONS,
};

/// Check the arguments about meshes against a result; EXIT_DONE if they are valid.
static int check_meshes(const arguments *given, size_t index)
{
    static const char *const FOR_SUBDIVISION[] = {"data", "vertices", NULL}, *const FOR_LEARNING[] = {"epochs", "pairs",
                                                                                                      NULL};
    const char *name = RESULTS[index].name;
    meshes use = RESULTS[index].meshes;
    size_t count = given->positional_count - 1;
    if (count > RESULTS[index].max_meshes)
        return use == NO_MESHES ? usage_error(given, "one argument too many: %s takes no shapes", name)
                                : usage_error(given, "%s takes %zu shapes at most", name, RESULTS[index].max_meshes);
    if (RESULTS[index].max_meshes == 2 && count == 1)
        return usage_error(given, "%s takes two shapes, a smooth and a sharp one, or none", name);
    if (RESULTS[index].clouds != NO_CLOUDS || RESULTS[index].reads_truth)
        return EXIT_DONE;
    if (RESULTS[index].may_read && argument(given, "vertices") == NULL && argument_first(given, FOR_LEARNING) == NULL)
        return EXIT_DONE;
    if (use != SUBDIVIDES && argument_first(given, FOR_SUBDIVISION) != NULL)
        return usage_error(given, "--data and --vertices go with mesh-table2, --data with real-curves, real-meshes, "
                                  "motion-keyframes, surface-nefertiti and -face too");
    if (use != LEARNS && argument_first(given, FOR_LEARNING) != NULL)
        return usage_error(given,
                           "--epochs and --pairs go with mesh-ablations and mesh-style, --epochs with surface-ablation");
    if (use == SUBDIVIDES && (count > 0) == (argument(given, "data") != NULL))
        return usage_error(given, "%s needs %s: the program comes without any", name,
                           count > 0 ? "either shapes or --data, not both" : "shapes, or a folder of them as --data");
    return EXIT_DONE;
}

/// Check the arguments about clouds against a result; EXIT_DONE if they are valid.
static int check_clouds(const arguments *given, size_t index)
{
    static const char *const FOR_CASES[] = {"points", "noise", "degrees", NULL}, *const FOR_MESHES[] = {"vertices", "pairs",
                                                                                                        NULL};
    const char *name = RESULTS[index].name;
    cloud_use use = RESULTS[index].clouds;
    bool informed = argument(given, "model") != NULL, uninformed = argument(given, "uninformed") != NULL;
    if (use != DRAWS && argument_first(given, FOR_CASES) != NULL)
        return usage_error(given, "--points, --noise and --degrees go with surface-clouds");
    if (use != DRAWS && use != ABLATES && argument(given, "clouds") != NULL)
        return usage_error(given, "--clouds goes with surface-clouds and surface-ablation");
    if (use != SCANS && use != MAKES && argument(given, "corrections") != NULL)
        return usage_error(given, "--corrections goes with surface-nefertiti, -face and -shapes");
    if (use != ABLATES && uninformed)
        return usage_error(given, "--uninformed goes with surface-ablation");
    if (use == ABLATES && informed != uninformed)
        return usage_error(given, "%s needs both --model and --uninformed, or trains both", name);
    if (use == NO_CLOUDS)
        return EXIT_DONE;
    if (argument_first(given, FOR_MESHES) != NULL || (use != ABLATES && argument(given, "epochs") != NULL))
        return usage_error(given, "--vertices, --pairs and --epochs do not go with %s", name);
    if (use != SCANS && argument(given, "data") != NULL)
        return usage_error(given, "%s makes its clouds itself: there is no --data", name);
    if (use == SCANS && argument(given, "data") == NULL)
        return usage_error(given, "%s needs --data FOLDER with %s: the program comes without any scans", name,
                           RESULTS[index].data);
    return EXIT_DONE;
}

/// Check the arguments about curves of a folder against a result; EXIT_DONE if they are valid.
static int check_curves(const arguments *given, size_t index)
{
    static const char *const FOR_MESHES[] = {"vertices", "epochs", "pairs", NULL};
    const char *name = RESULTS[index].name;
    if (!RESULTS[index].reads_truth)
        return EXIT_DONE;
    if (argument_first(given, FOR_MESHES) != NULL)
        return usage_error(given, "--vertices, --pairs and --epochs do not go with %s", name);
    if (argument(given, "data") == NULL)
        return usage_error(given, "%s needs --data FOLDER with %s: the program comes without any", name,
                           RESULTS[index].data);
    return EXIT_DONE;
}

/// Check all arguments against a result; EXIT_DONE if they are valid.
static int check_options(const arguments *given, size_t index)
{
    const char *name = RESULTS[index].name;
    if (argument(given, "output") != NULL && RESULTS[index].drawn == NEVER)
        return usage_error(given, "%s has no pictures to put into a folder", name);
    if (argument(given, "model") != NULL && !RESULTS[index].learned)
        return usage_error(given, "%s has no row for a model", name);
    if (argument(given, "seed") != NULL && !RESULTS[index].seeded)
        return usage_error(given, "%s has no chance in it for a seed", name);
    if (argument(given, "set") != NULL && !RESULTS[index].sets)
        return usage_error(given, "%s has no other curves: --set goes with tension-table1", name);
    int code = check_meshes(given, index);
    if (code == EXIT_DONE)
        code = check_curves(given, index);
    return code == EXIT_DONE ? check_clouds(given, index) : code;
}

static void begin(void *to)
{
    reproduce_job *job = to;
    job->seed = 1;
    job->corrections = 1;
}

static bool check(void *of)
{
    // In the order of bat_tension_set_kind.
    static const char *const SETS[] = {"published", "resampled", "unseen", NULL};
    reproduce_job *job = of;
    const arguments *given = job->call.given;
    int set;
    while (job->index < RESULT_COUNT && strcmp(job->call.input, RESULTS[job->index].name) != 0)
        job->index++;
    if (job->index == RESULT_COUNT)
    {
        (void)usage_error(given, "there is no result '%s'; `batten list results` names them", job->call.input);
        return false;
    }
    if (check_options(given, job->index) != EXIT_DONE ||
        !argument_word(given, "set", SETS, BAT_TENSION_SET_KIND_PUBLISHED, &set) ||
        !argument_list(given, "points", 1, 100000, true, &job->points) ||
        !argument_list(given, "noise", 0, 10, false, &job->noises) ||
        !argument_list(given, "degrees", 1, BAT_SPLINE_MAX_DEGREE, true, &job->degrees))
        return false;
    job->curves = (bat_tension_set_kind)set;
    job->shapes = given->positional + 1;
    job->shape_count = given->positional_count - 1;
    if (job->folder == NULL)
        job->folder = RESULTS[job->index].folder;
    return true;
}

static int make(void *of)
{
    reproduce_job *job = of;
    const char *folder = job->folder;
    bat_error error = {0};
    // Trainings make their folders themselves.
    bool makes_folder = folder != NULL && RESULTS[job->index].drawn != TRAINING;
    job->made = makes_folder && mkdir(folder, 0777) == 0;
    if (makes_folder && !job->made && errno != EEXIST)
    {
        (void)snprintf(error.text, sizeof error.text, "the folder cannot be made: %s", strerror(errno));
        return report_failure(folder, &error);
    }
    job->call.files.folder = folder;
    return RESULTS[job->index].run(job);
}

/// The pictures are in their places.
static int report(void *of)
{
    reproduce_job *job = of;
    job->made = false;
    return EXIT_DONE;
}

static void end(void *of)
{
    const reproduce_job *job = of;
    if (job->made)
        (void)rmdir(job->folder);
}

const verb VERB_REPRODUCE = {
    .name = "reproduce",
    .arguments = "NAME [SHAPE...] [-o FOLDER] [--model FILE] [--seed N] [options]",
    .summary = "compute published tables and figures, beside the published ones",
    .about =
        "A published table or figure, computed anew and shown beside the published figures; `batten list results` names "
        "them. mesh-table2 needs SHAPEs (see `batten list formats`) or --data. mesh-ablations learns from all SHAPEs but "
        "the last, which it tests on; mesh-style from a smooth and a sharp one; without any, both make their own.",
    .example = "batten reproduce tension-iss -o out",
    .options = (const option_table[]){{OPTIONS, 0}, {JSON_OPTION, 0}, {NULL, 0}},
    .min_positional = 1,
    .max_positional = MAX_POSITIONAL,
    .list = "results",
    .job_size = sizeof(reproduce_job),
    .begin = begin,
    .check = check,
    .make = make,
    .report = report,
    .end = end,
};

// What the results share.

int reproduce_model(const reproduce_job *job, bat_curve_model **model)
{
    bat_error error;
    bat_status status = bat_curve_model_read_published(job->model, model, &error);
    return status == BAT_OK ? EXIT_DONE : report_failure(job->model, &error);
}

void reproduce_print_figure(double ours, double published, int width)
{
    (void)printf(" %*.5g", width, ours);
    if (isfinite(published))
        (void)printf(" (%5.3f)", ours / published);
    else
        (void)printf(" %7s", "");
}

void reproduce_set_number(json_t *object, const char *key, double value)
{
    if (isfinite(value))
        (void)json_object_set_new(object, key, report_number(value));
}

int reproduce_path(const char *folder, const char *file, char path[REPRODUCE_PATH_SIZE])
{
    int length = snprintf(path, REPRODUCE_PATH_SIZE, "%s/%s", folder, file);
    if (length < 0 || length >= REPRODUCE_PATH_SIZE)
        return report_failure(NULL, &(bat_error){.text = "the folder's name is too long"});
    return EXIT_DONE;
}

int reproduce_picture_add(const reproduce_job *job, const char *name, reproduce_picture *picture)
{
    bat_error error;
    int code = reproduce_path(job->folder, name, picture->path);
    if (code == EXIT_DONE && bat_outputs_add(job->call.files.files, picture->path, &picture->write_to, &error) != BAT_OK)
        code = report_failure(picture->path, &error);
    return code;
}
