#include "reproduce.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/// What a result does and takes, or-ed together.
enum
{
    WITH_FOLDER = 1,   ///< writes pictures where a folder is given
    ALWAYS = 2,        ///< writes pictures
    TRAINING = 4,      ///< the folder contains trainings
    MODEL = 8,         ///< accepts a network
    SEED = 16,         ///< accepts a seed
    OTHER_SETS = 32,   ///< accepts other sets of curves
    SUBDIVIDES = 64,   ///< decimates and subdivides given meshes
    LEARNS = 128,      ///< trains on given meshes
    PAIR = 256,        ///< takes two meshes or none
    ABLATES = 512,     ///< trains two networks on clouds, or uses given ones
    DRAWS = 1024,      ///< draws random clouds
    SCANS = 2048,      ///< reads clouds from a folder
    MAKES = 4096,      ///< samples built-in shapes
    TRUTH = 8192,      ///< reads curves or meshes from a folder
    MAY_READ = 16384,  ///< reads a folder where one is given
    WHOLE_SET = 32768, ///< makes all results
    COUNTS = 65536,    ///< takes a number of random inputs
    CLOUDS = ABLATES | DRAWS | SCANS | MAKES,
    MAX_SHAPES = MAX_POSITIONAL - 1,
    MAX_NUMBER = 1000000,
    DEFAULT_BUDGET = 1800
};

typedef struct result
{
    const char *name;
    reproduce_result *run;
    unsigned marks;
    const char *folder; ///< the default one of ALWAYS and TRAINING
    const char *data;   ///< files that it reads from a folder
    const char *summary;
    const char *kind, *quick; ///< as in a reproduce_part
} result;

static const result RESULTS[] = {
    {"curve-figures", reproduce_curve_figures, ALWAYS, "out", NULL,
     "the figures of the curve-scheme study: ten shapes at levels 0, 1, 2, 10, 20", NULL, "-"},
    {"tension-table1", reproduce_tension_table1, WITH_FOLDER | MODEL | OTHER_SETS, NULL, NULL,
     "table 1 of the tension paper: 240 validation curves, or 900 test curves, all schemes, both signs", NULL, NULL},
    {"tension-table2", reproduce_tension_table2, MODEL | SEED, NULL, NULL,
     "table 2 of the tension paper: largest angles where the control points are disturbed", NULL, NULL},
    {"tension-table3", reproduce_tension_table3, TRAINING | SEED, "out/tension-ablations", NULL,
     "table 3 of the tension paper: how the network learns of the space; trains for 100 epochs three times", NULL, "-"},
    {"tension-table4", reproduce_tension_table4, TRAINING | SEED, "out/tension-ablations", NULL,
     "table 4 of the tension paper: the loss without one term; trains for 100 epochs four times", NULL, "-"},
    {"tension-iss", reproduce_tension_iss, WITH_FOLDER | MODEL, NULL, NULL,
     "table 5 of the tension paper: the ISS ground track", NULL, NULL},
    {"tension-mechanism", reproduce_tension_mechanism, WITH_FOLDER | MODEL, NULL, NULL,
     "section 9 of the tension paper: a network's effective tension, and its Lipschitz constant (remark 4)", NULL, NULL},
    {"real-curves", reproduce_real_curves, MODEL | TRUTH, NULL, "FAMILY-truth.csv and FAMILY-SAMPLING.csv",
     "curves that people have, sampled evenly, unevenly and by simplification: schemes and splines against the truth",
     "curves", "-"},
    {"hermite-figures", reproduce_hermite_figures, ALWAYS, "out", NULL,
     "figures 1 to 4 of the Hermite paper: tensors, orders 1, 3 and 10, a spiral, rotations, beside parallel transport",
     NULL, NULL},
    {"hermite-order", reproduce_hermite_order, 0, NULL, NULL,
     "the Hermite paper's claims measured in nine spaces: orders, geodesics, proximity, contraction, displacement", NULL,
     NULL},
    {"motion-keyframes", reproduce_motion_keyframes, MAY_READ, NULL, "fr1-xyz.txt",
     "motions of which every k-th pose is kept: splines in time beside scipy's; with --data a recorded one too", "motion",
     NULL},
    {"mesh-table2", reproduce_mesh_table2, WITH_FOLDER | MODEL | SUBDIVIDES, NULL, NULL,
     "table 2 of Neural Subdivision with shapes of your own: decimated, subdivided twice, measured", "meshes", NULL},
    {"real-meshes", reproduce_real_meshes, MODEL | TRUTH, NULL, "SHAPE.obj and coarse-by/SHAPE-VERTICES-WAY.off",
     "coarse meshes that other programs made of known shapes: learned, butterfly, Loop and flat against the truth", "meshes",
     NULL},
    {"mesh-ablations", reproduce_mesh_ablations, TRAINING | SEED | LEARNS, "out/mesh-ablations", NULL,
     "section 6, appendices G and H of Neural Subdivision: the network without its parts; trains six times, some minutes",
     NULL, "--epochs 1 --pairs 2"},
    {"mesh-style", reproduce_mesh_style, TRAINING | SEED | LEARNS | PAIR, "out/mesh-style", NULL,
     "figures 26 and 27 of Neural Subdivision: one cage, a smooth and a sharp teacher; trains twice", NULL,
     "--epochs 1 --pairs 2"},
    {"surface-ablation", reproduce_surface_ablation, TRAINING | MODEL | SEED | ABLATES, "out/surface-ablation", NULL,
     "section 6.1 of the BIDGCN paper: a network with and without the boundary-informed layer; trains twice, some minutes",
     NULL, "--epochs 1 --clouds 4"},
    {"surface-clouds", reproduce_surface_clouds, MODEL | SEED | DRAWS, NULL, NULL,
     "figures 5 to 9 of the BIDGCN paper: errors, times and failures of parameterizations on random clouds", NULL,
     "--clouds 4 --degrees 2 --points 200,1000 --noise 0,0.01"},
    {"surface-nefertiti", reproduce_surface_nefertiti, WITH_FOLDER | MODEL | SCANS, NULL,
     "nefertiti-532.xyz, -1043, -2062, -3253, -6024 and -8818",
     "figures 12 and 14 of the BIDGCN paper: six clouds of a bust, and an adaptive fit of the largest", "clouds", "-"},
    {"surface-face", reproduce_surface_face, WITH_FOLDER | MODEL | SCANS, NULL, "face-9283.xyz",
     "figure 15 of the BIDGCN paper: adaptive fits of a face of bidegrees (3, 3) and (4, 4)", "clouds", "-"},
    {"surface-shapes", reproduce_surface_shapes, WITH_FOLDER | MODEL | MAKES, NULL, NULL,
     "figure 16 of the BIDGCN paper: a ship hull and a turbine blade of our own, bidegree (5, 2)", NULL, NULL},
    {"scan-verdict", reproduce_scan_verdict, SEED | TRUTH, NULL, "meshes (OBJ, OFF, PLY)",
     "surfaces of crops of meshes and of deep shapes, with noise: which are right, and which the verdict refuses", "meshes",
     "-"},
    {"scan-verdict-scanner", reproduce_scan_verdict_scanner, SEED | TRUTH, NULL, "meshes (OBJ, OFF, PLY)",
     "the same of points as a scanner sees them: density by the cosine of the view, noise along it", "meshes", "-"},
    {"scan-solids", reproduce_scan_solids, SEED | TRUTH, NULL, "meshes (OBJ, OFF, PLY)",
     "shells of clouds that are sampled from meshes, with noise and as by a scanner: which are right, and their errors",
     "meshes", "-"},
    {"scan-rims", reproduce_scan_solids, SEED, NULL, NULL,
     "the same of open bodies with smooth rims, with few and with many points", NULL, "-"},
    {"harm", reproduce_harm, SEED | COUNTS, NULL, NULL,
     "random inputs of many kinds with a known truth: how often a default loses to the simplest rival", NULL, "--clouds 1"},
    {"all", reproduce_all, ALWAYS | MAY_READ | WHOLE_SET, NULL, "curves, meshes, clouds and motion",
     "every other result, each to a file in a folder; what is there already is kept", NULL, NULL},
};
bool reproduce_row(size_t index, const char **name, const char **summary)
{
    if (index >= sizeof RESULTS / sizeof *RESULTS)
        return false;
    *name = RESULTS[index].name;
    *summary = RESULTS[index].summary;
    return true;
}

bool reproduce_part_at(size_t index, reproduce_part *part)
{
    if (index >= sizeof RESULTS / sizeof *RESULTS || RESULTS[index].marks & WHOLE_SET)
        return false;
    const result *row = &RESULTS[index];
    *part = (reproduce_part){
        .name = row->name,
        .summary = row->summary,
        .kind = row->kind,
        .quick = row->quick,
        .needs_data = row->marks & (TRUTH | SCANS | SUBDIVIDES),
        .has_folder = row->marks & (WITH_FOLDER | ALWAYS | TRAINING),
        .trains = row->marks & TRAINING,
    };
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
     "surface-nefertiti, -face: where the curves, motions or clouds are; all: where their folders are",
     TEXT(reproduce_job, data)},
    {"seed", "N", METHOD, COMMON,
     "tension-table2: of the noise; surface-clouds, scan-verdict, -solids, harm: of the inputs; tension-table3, -table4, "
     "mesh-ablations, "
     "mesh-style, surface-ablation: of the trainings; default 1",
     WHOLE(reproduce_job, seed, 0, 1000000000)},
    {"quick", NULL, METHOD, 0, "all: smaller trainings and fewer cases; leaves out what takes minutes all the same",
     FLAG(reproduce_job, quick)},
    {"budget", "S", METHOD, 0,
     "all: seconds for each result, which is left out when they are over; the next call goes on with a training; default "
     "1800",
     POSITIVE(reproduce_job, budget)},
    {"without-trainings", NULL, METHOD, 0, "all: leaves out what trains networks", FLAG(reproduce_job, without_trainings)},
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
    {"clouds", "N", METHOD, 0,
     "surface-clouds, surface-ablation: random clouds of each case; default 100; harm: inputs of each kind; default 20",
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
    unsigned marks = what->marks;
    size_t shapes = given->positional_count - 1, max = marks & PAIR ? 2 : marks & (SUBDIVIDES | LEARNS) ? MAX_SHAPES : 0;
    bool data = argument(given, "data") != NULL, vertices = argument(given, "vertices") != NULL;
    bool epochs = argument(given, "epochs") != NULL, pairs = argument(given, "pairs") != NULL;
    bool model = argument(given, "model") != NULL, uninformed = argument(given, "uninformed") != NULL;
    bool cases = argument(given, "points") != NULL || argument(given, "noise") != NULL || argument(given, "degrees") != NULL;
    bool reads = marks & (CLOUDS | TRUTH) || (marks & MAY_READ && !vertices && !epochs && !pairs);
    bool has_folder = marks & (WITH_FOLDER | ALWAYS | TRAINING), subdivides = !reads && marks & SUBDIVIDES;
    char most[24];
    (void)snprintf(most, sizeof most, "%zu", max);
    const usage_rule rules[] = {
        {argument(given, "output") != NULL && !has_folder, "%s has no pictures to put into a folder"},
        {marks & WHOLE_SET && argument(given, "output") == NULL, "%s needs -o FOLDER for its files"},
        {argument(given, "quick") != NULL && !(marks & WHOLE_SET), "%s is not shortened: --quick goes with all"},
        {(argument(given, "budget") != NULL || argument(given, "without-trainings") != NULL) && !(marks & WHOLE_SET),
         "--budget and --without-trainings go with all"},
        {model && !(marks & MODEL), "%s has no row for a model"},
        {argument(given, "seed") != NULL && !(marks & SEED), "%s has no chance in it for a seed"},
        {argument(given, "set") != NULL && !(marks & OTHER_SETS), "%s has no other curves: --set goes with tension-table1"},
        {shapes > max && max == 0, "one argument too many: %s takes no shapes"},
        {shapes > max, "%s takes %s shapes at most"},
        {max == 2 && shapes == 1, "%s takes two shapes, a smooth and a sharp one, or none"},
        {!reads && !subdivides && (data || vertices),
         "--data and --vertices go with mesh-table2, --data with real-curves, real-meshes, motion-keyframes, "
         "surface-nefertiti and -face too"},
        {!reads && !(marks & LEARNS) && (epochs || pairs),
         "--epochs and --pairs go with mesh-ablations and mesh-style, --epochs with surface-ablation"},
        {subdivides && shapes > 0 && data, "%s needs either shapes or --data, not both: the program comes without any"},
        {subdivides && shapes == 0 && !data,
         "%s needs shapes, or a folder of them as --data: the program comes without any"},
        {marks & TRUTH && (vertices || epochs || pairs), "--vertices, --pairs and --epochs do not go with %s"},
        {marks & TRUTH && !data, "%s needs --data FOLDER with %s: the program comes without any"},
        {!(marks & DRAWS) && cases, "--points, --noise and --degrees go with surface-clouds"},
        {!(marks & (DRAWS | ABLATES | COUNTS)) && argument(given, "clouds") != NULL,
         "--clouds goes with surface-clouds, surface-ablation and harm"},
        {!(marks & (SCANS | MAKES)) && argument(given, "corrections") != NULL,
         "--corrections goes with surface-nefertiti, -face and -shapes"},
        {!(marks & ABLATES) && uninformed, "--uninformed goes with surface-ablation"},
        {marks & ABLATES && model != uninformed, "%s needs both --model and --uninformed, or trains both"},
        {marks & CLOUDS && (vertices || pairs || (!(marks & ABLATES) && epochs)),
         "--vertices, --pairs and --epochs do not go with %s"},
        {marks & CLOUDS && !(marks & SCANS) && data, "%s makes its clouds itself: there is no --data"},
        {marks & SCANS && !data, "%s needs --data FOLDER with %s: the program comes without any scans"},
    };
    return usage_obeys(given, rules, sizeof rules / sizeof *rules, what->name, shapes > max ? most : what->data);
}

static void begin(void *to)
{
    reproduce_job *job = to;
    job->seed = 1;
    job->corrections = 1;
    job->budget = DEFAULT_BUDGET;
}

static bool check(void *of)
{
    // In the order of bat_tension_set_kind.
    static const char *const SETS[] = {"published", "resampled", "unseen", NULL};
    reproduce_job *job = of;
    const arguments *given = job->call.given;
    int set;
    while (job->index < sizeof RESULTS / sizeof *RESULTS && strcmp(job->call.input, RESULTS[job->index].name) != 0)
        job->index++;
    if (job->index == sizeof RESULTS / sizeof *RESULTS)
        return usage_refused(given, "there is no result '%s'; `batten list results` names them", job->call.input);
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
    bool makes_folder = folder != NULL && !(RESULTS[job->index].marks & TRAINING);
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
    .options = {{OPTIONS, 0}, {JSON_OPTION, 0}},
    .positional = {1, MAX_POSITIONAL},
    .list = "results",
    .job_size = sizeof(reproduce_job),
    .calls = {begin, check, make, NULL, report, end},
};
