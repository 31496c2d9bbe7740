#include "reproduce.h"

#include "report.h"

#include "batten/research/networks.h"
#include "batten/spline.h"

#include <errno.h>
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

/// A result and what it takes.
typedef struct result
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
} result;

static const result RESULTS[] = {
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

/// Whether the arguments fit a result. False after a message, that of the first rule that is broken. In the messages, %s
/// is the name of the result, %2$s the files that it reads, and %s the most shapes that it takes.
static bool check_options(const arguments *given, const result *what)
{
    meshes use = what->meshes;
    cloud_use clouds = what->clouds;
    size_t shapes = given->positional_count - 1;
    bool data = argument_flag(given, "data"), vertices = argument_flag(given, "vertices");
    bool epochs = argument_flag(given, "epochs"), pairs = argument_flag(given, "pairs");
    bool model = argument_flag(given, "model"), uninformed = argument_flag(given, "uninformed");
    bool cases = argument_flag(given, "points") || argument_flag(given, "noise") || argument_flag(given, "degrees");
    bool reads = clouds != NO_CLOUDS || what->reads_truth || (what->may_read && !vertices && !epochs && !pairs);
    char most[24];
    (void)snprintf(most, sizeof most, "%zu", what->max_meshes);
    const usage_rule rules[] = {
        {argument_flag(given, "output") && what->drawn == NEVER, "%s has no pictures to put into a folder"},
        {model && !what->learned, "%s has no row for a model"},
        {argument_flag(given, "seed") && !what->seeded, "%s has no chance in it for a seed"},
        {argument_flag(given, "set") && !what->sets, "%s has no other curves: --set goes with tension-table1"},
        {shapes > what->max_meshes && use == NO_MESHES, "one argument too many: %s takes no shapes"},
        {shapes > what->max_meshes, "%s takes %s shapes at most"},
        {what->max_meshes == 2 && shapes == 1, "%s takes two shapes, a smooth and a sharp one, or none"},
        {!reads && use != SUBDIVIDES && (data || vertices),
         "--data and --vertices go with mesh-table2, --data with real-curves, real-meshes, motion-keyframes, "
         "surface-nefertiti and -face too"},
        {!reads && use != LEARNS && (epochs || pairs),
         "--epochs and --pairs go with mesh-ablations and mesh-style, --epochs with surface-ablation"},
        {!reads && use == SUBDIVIDES && shapes > 0 && data,
         "%s needs either shapes or --data, not both: the program comes without any"},
        {!reads && use == SUBDIVIDES && shapes == 0 && !data,
         "%s needs shapes, or a folder of them as --data: the program comes without any"},
        {what->reads_truth && (vertices || epochs || pairs), "--vertices, --pairs and --epochs do not go with %s"},
        {what->reads_truth && !data, "%s needs --data FOLDER with %s: the program comes without any"},
        {clouds != DRAWS && cases, "--points, --noise and --degrees go with surface-clouds"},
        {clouds != DRAWS && clouds != ABLATES && argument_flag(given, "clouds"),
         "--clouds goes with surface-clouds and surface-ablation"},
        {clouds != SCANS && clouds != MAKES && argument_flag(given, "corrections"),
         "--corrections goes with surface-nefertiti, -face and -shapes"},
        {clouds != ABLATES && uninformed, "--uninformed goes with surface-ablation"},
        {clouds == ABLATES && model != uninformed, "%s needs both --model and --uninformed, or trains both"},
        {clouds != NO_CLOUDS && (vertices || pairs || (clouds != ABLATES && epochs)),
         "--vertices, --pairs and --epochs do not go with %s"},
        {clouds != NO_CLOUDS && clouds != SCANS && data, "%s makes its clouds itself: there is no --data"},
        {clouds == SCANS && !data, "%s needs --data FOLDER with %s: the program comes without any scans"},
    };
    return usage_obeys(given, rules, sizeof rules / sizeof *rules, what->name,
                       shapes > what->max_meshes ? most : what->data);
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
    if (!check_options(given, &RESULTS[job->index]) ||
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
