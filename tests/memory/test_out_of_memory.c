// Memory that runs out in the middle of a verb. For every allocation of a verb, or many of them where they are too many, the
// verb runs in a process of its own in which this allocation fails. It must end with exit code 1, one line that says so, no
// output, nothing left in use and no file left open; or, where it can do without the block, with the output of an
// undisturbed run.
//
// `test_out_of_memory every [CASE [N]]` tries every allocation of all cases, which takes minutes, or of one, or one
// allocation.

#define _GNU_SOURCE // mkdtemp()

#include "arguments.h"
#include "check.h"
#include "failing_memory.h"
#include "linalg/blas.h"
#include "report.h"
#include "verb.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SLOW
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define SLOW
#endif

enum
{
    MAX_WORDS = 24,
#if defined(SLOW)
    DENSE = 8,    ///< the first allocations are all tried
    SAMPLES = 12, ///< of the others
#else
    DENSE = 16,
    SAMPLES = 24,
#endif
    SECONDS = 100, ///< for one run, under sanitizers on a busy machine
    TEXT = 4096
};

/// A verb's command line, in words. What begins with "out." is its output.
typedef struct test_case
{
    const char *name;
    const verb *what;
    const char *words;
} test_case;

static const test_case CASES[] = {
    {"curve csv", &VERB_CURVE, "curve plane.csv -o out.csv --levels 3 --quiet"},
    {"curve table", &VERB_CURVE, "curve table.csv -o out.csv --levels 1 --group track --threads 1"},
    {"curve columns", &VERB_CURVE, "curve table.csv -o out.csv --levels 1 --columns 3,2 --threads 1 --quiet"},
    {"curve two threads", &VERB_CURVE, "curve many.csv -o out.csv --levels 2 --threads 2"},
    {"curve kept simple", &VERB_CURVE, "curve strait.csv --closed --scheme six-point -o out.csv --levels 3 --threads 1"},
    {"curve geojson", &VERB_CURVE, "curve track.geojson -o out.geojson --levels 2 --threads 1"},
    {"curve obj", &VERB_CURVE, "curve path.obj -o out.obj --levels 2 --scheme four-point --snap --threads 1"},
    {"curve log-exp", &VERB_CURVE, "curve rotation.csv -o out.csv --levels 2 --scheme log-exp-4"},
    {"curve angle", &VERB_CURVE,
     "curve plane.csv -o out.csv --scheme angle-4:adaptive=1 --levels 2 --truth plane.csv --best-tension"},
    {"curve model", &VERB_CURVE,
     "curve plane.csv -o out.csv --model " WEIGHTS_FOLDER "/tension-published.safetensors --levels 2"},
    {"curve stops", &VERB_CURVE,
     "curve plane.csv -o out.csv --max-edge 0.4 --tolerance 0.01 --corner-angle 95 --threads 2 --quiet"},
    {"curve corners", &VERB_CURVE, "curve many.csv -o out.csv --levels 1 --corner-angle 60 --threads 2 --quiet"},
    {"curve json", &VERB_CURVE, "curve plane.csv --levels 2 --json --truth plane.csv"},
    {"curve picture", &VERB_CURVE, "curve plane.csv --levels 2 --picture out.svg --panel 0,1 --comb --quiet"},
    {"motion", &VERB_CURVE, "curve rotation.csv -o out.tum --space rigid --from tum --rate 7"},
    {"motion levels", &VERB_CURVE, "curve keys.csv -o out.csv --scheme hermite:order=3 --velocities --levels 2"},
    {"mesh learned", &VERB_MESH, "mesh sheet.obj -o out.obj --levels 1 --quiet"},
    {"mesh given model", &VERB_MESH,
     "mesh sheet.obj -o out.ply --levels 3 --then loop --threads 2 --model " WEIGHTS_FOLDER "/mesh.safetensors"},
    {"mesh loop", &VERB_MESH, "mesh cage.ply -o out.off --scheme loop --limit --crease-angle 30 --json"},
    {"mesh butterfly", &VERB_MESH, "mesh sheet.obj -o out.stl --scheme butterfly --levels 2"},
    {"mesh sqrt3", &VERB_MESH, "mesh cage.ply -o out.ply --scheme sqrt3 --levels 2"},
    {"mesh polygons", &VERB_MESH, "mesh tiles.obj -o out.obj --levels 1 --texture corners --creasing chaikin --threads 1"},
    {"mesh no boundary", &VERB_MESH, "mesh tiles.obj -o out.glb --levels 1 --boundary none --limit --normals --threads 1"},
    {"mesh adaptive", &VERB_MESH, "mesh sheet.obj -o out.ply --scheme loop --max-edge 0.7 --quiet"},
    {"mesh adaptive polygons", &VERB_MESH, "mesh tiles.obj -o out.off --scheme catmull-clark --tolerance 0.1 --quiet"},
    {"mesh repair", &VERB_MESH, "mesh fins.obj -o out.obj --scheme midpoint --repair"},
    {"mesh picture", &VERB_MESH, "mesh sheet.obj --scheme loop --levels 1 --beside midpoint --picture out.png --quiet"},
    {"decimate", &VERB_DECIMATE, "decimate cage.ply -o out.obj --vertices 40 --json"},
    {"decimate texture", &VERB_DECIMATE, "decimate sheet.obj -o out.obj --vertices 6 --random 4 --triangulate"},
    {"decimate repair", &VERB_DECIMATE, "decimate fins.obj -o out.off --vertices 4 --repair"},
    {"measure curve", &VERB_MEASURE, "measure plane.csv --json"},
    {"measure curves", &VERB_MEASURE, "measure many.csv many.csv --to-segments --threads 2"},
    {"measure geodesic", &VERB_MEASURE, "measure track.geojson track.geojson --geodesic --json"},
    {"measure mesh", &VERB_MEASURE, "measure sheet.obj --json"},
    {"measure meshes", &VERB_MEASURE, "measure cage.ply stone.ply --samples 500"},
    {"measure vertices", &VERB_MEASURE, "measure cage.ply stone.ply --at-vertices --json --threads 2"},
    {"measure picture", &VERB_MEASURE, "measure cage.ply cage.ply --samples 100 --picture out.png"},
    {"surface uniform", &VERB_SURFACE, "surface hull.xyz -o out.step --parameterization uniform --functions 40 --quiet"},
    {"surface learned", &VERB_SURFACE, "surface hull.xyz -o out.obj --parameterization learned --functions 30 --quiet"},
    {"surface auto", &VERB_SURFACE, "surface scan.xyz -o out.xml --functions 30 --quiet"},
    {"surface tolerance", &VERB_SURFACE,
     "surface scan.xyz -o out.json --parameterization shape-preserving --tolerance 0.1 --robust --noise 0.01 --quiet "
     "--slide-boundary"},
    {"surface stretch", &VERB_SURFACE,
     "surface hull.xyz --parameters out.uv --parameterization stretch-minimizing --functions 20 --quiet"},
    {"surface published", &VERB_SURFACE,
     "surface hull.xyz -o out.vtk --parameterization inverse-distance --published --functions 20 --force --quiet"},
    {"surface mesh", &VERB_SURFACE, "surface sheet.obj -o out.vtk --parameterization mean-value --functions 16 --quiet"},
    {"surface given", &VERB_SURFACE, "surface hull.xyz -o out.obj --parameterization hull.uv --functions 20 --quiet"},
    {"surface xml", &VERB_SURFACE, "surface fit.xml -o out.json --quiet"},
    {"surface json", &VERB_SURFACE, "surface fit.json -o out.xml --quiet"},
    {"surface trim", &VERB_SURFACE, "surface hull.xyz -o out.step --trim --functions 20 --quiet --force"},
    {"surface trimmed triangles", &VERB_SURFACE, "surface hull.xyz -o out.obj --trim --functions 16 --quiet --force"},
    {"surface trimmed iges", &VERB_SURFACE, "surface hull.xyz -o out.iges --trim --functions 16 --quiet --force"},
    {"surface trimmed json", &VERB_SURFACE, "surface trimmed.json -o out.json --quiet"},
    {"surface picture", &VERB_SURFACE,
     "surface hull.xyz --picture out.png --parameterization uniform --functions 20 --quiet"},
    {"shape", &VERB_SHAPE, "shape stone -o out.ply --vertices 200"},
    {"curve gpx", &VERB_CURVE, "curve track.gpx -o out.gpx --levels 2 --threads 1"},
    {"curve gpx geojson", &VERB_CURVE, "curve track.gpx -o out.geojson --levels 1 --threads 1"},
    {"curve csv gpx", &VERB_CURVE, "curve track.gpx -o out.csv --levels 1 --threads 1"},
    {"curve wkt table", &VERB_CURVE, "curve shapes.csv -o out.csv --levels 1 --threads 1"},
    {"curve topojson", &VERB_CURVE, "curve two.topojson -o out.topojson --levels 1 --threads 1"},
    {"curve sequence", &VERB_CURVE, "curve lines.geojsonl -o out.geojsonl --levels 2 --topology separate --threads 1"},
    {"shape map", &VERB_SHAPE, "shape map -o out.geojson --countries 12 --detail 1"},
    {"shape cloud", &VERB_SHAPE, "shape scan -o out.xyz --vertices 200"},
    {"analyze", &VERB_ANALYZE, "analyze four-point --json"},
    {"analyze sweep", &VERB_ANALYZE, "analyze four-point --sweep w=0.05:0.07 --depth 6"},
    {"list", &VERB_LIST, "list schemes --json"},
};
enum
{
    CASE_COUNT = sizeof CASES / sizeof *CASES
};

/// What the command line asks for: a case, and one of its allocations; null and 0 for all.
static const char *wanted;
static size_t wanted_number;

/// Where everything happens: the first holds the input, in the second the verbs write.
static char folder[64];

static void write_file(const char *name, const char *text)
{
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static char *read_file(const char *name, size_t *size)
{
    FILE *file = fopen(name, "rb");
    *size = 0;
    if (file == NULL)
        return NULL;
    struct stat about;
    assert_int_equal(fstat(fileno(file), &about), 0);
    char *bytes = calloc((size_t)about.st_size + 1, 1);
    assert_non_null(bytes);
    *size = fread(bytes, 1, (size_t)about.st_size, file);
    (void)fclose(file);
    return bytes;
}

/// What a run of a verb left.
typedef struct outcome
{
    int code;         ///< the program's exit code; -1 when it did not end by itself
    int status;       ///< of the process, as waitpid() gives it
    int open_files;   ///< more than before
    int blas_threads; ///< more than before
    failing_result memory;
} outcome;

static int count_open_files(void)
{
    DIR *list = opendir("/proc/self/fd");
    int count = 0;
    while (list != NULL && readdir(list) != NULL)
        count++;
    if (list != NULL)
        (void)closedir(list);
    return count;
}

static void redirect(const char *name, int to)
{
    int file = open(name, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || dup2(file, to) < 0)
        abort();
    (void)close(file);
}

// Where AddressSanitizer is on, it looks for blocks that other libraries lost.
// NOLINTNEXTLINE(bugprone-reserved-identifier): its name
__attribute__((weak)) int __lsan_do_recoverable_leak_check(void);

/// Run the verb in this process, which ends by it.
static void run_here(const test_case *which, size_t n, failing_mode mode, int report_to)
{
    char text[TEXT], *words[MAX_WORDS], *rest = NULL;
    int count = 0;
    (void)snprintf(text, sizeof text, "%s", which->words);
    for (char *word = strtok_r(text, " ", &rest); word != NULL && count < MAX_WORDS - 1; word = strtok_r(NULL, " ", &rest))
        words[count++] = word;
    words[count] = NULL;
    // cmocka's own handlers would go on with the test here.
    static const int signals[] = {SIGSEGV, SIGFPE, SIGILL, SIGBUS, SIGABRT};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        (void)signal(signals[i], SIG_DFL);
    redirect("stdout", STDOUT_FILENO);
    redirect("stderr", STDERR_FILENO);
    (void)alarm(SECONDS);
    outcome came = {.open_files = -count_open_files(), .blas_threads = -openblas_get_num_threads()};
    failing_memory_begin(n, mode);
    came.code = report_end(verb_run(which->what, count, words));
    came.memory = failing_memory_end();
    (void)fflush(stdout);
    came.open_files += count_open_files();
    came.blas_threads += openblas_get_num_threads();
    if (__lsan_do_recoverable_leak_check != NULL && __lsan_do_recoverable_leak_check() != 0)
        came.memory.left++;
    (void)!write(report_to, &came, sizeof came);
    _exit(0);
}

/// Run the verb in a process of its own. This one makes no threads, so that its children may.
static outcome run(const test_case *which, size_t n, failing_mode mode)
{
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    (void)fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
    {
        (void)close(ends[0]);
        run_here(which, n, mode, ends[1]);
    }
    (void)close(ends[1]);
    outcome came = {.code = -1};
    if (read(ends[0], &came, sizeof came) != sizeof came)
        came = (outcome){.code = -1};
    (void)close(ends[0]);
    assert_int_equal(waitpid(child, &came.status, 0), child);
    return came;
}

/// The files that a run has written, all bytes of theirs, and those that it printed. Removes them.
typedef struct output
{
    char *file, *printed, *told;
    size_t file_size, printed_size, told_size, files;
} output;

static output take_output(void)
{
    output made = {0};
    made.printed = read_file("stdout", &made.printed_size);
    made.told = read_file("stderr", &made.told_size);
    DIR *list = opendir(".");
    assert_non_null(list);
    for (const struct dirent *entry = readdir(list); entry != NULL; entry = readdir(list))
    {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        if (strncmp(entry->d_name, "out.", 4) == 0)
        {
            free(made.file);
            made.file = read_file(entry->d_name, &made.file_size);
        }
        struct stat about;
        if (lstat(entry->d_name, &about) != 0 || S_ISLNK(about.st_mode))
            continue;
        made.files += strncmp(entry->d_name, "std", 3) != 0;
        assert_int_equal(unlink(entry->d_name), 0);
    }
    (void)closedir(list);
    return made;
}

static void free_output(output *made)
{
    free(made->file);
    free(made->printed);
    free(made->told);
}

static bool same(const output *a, const output *b)
{
    return a->files == b->files && a->file_size == b->file_size && a->printed_size == b->printed_size &&
           (a->file_size == 0 || memcmp(a->file, b->file, a->file_size) == 0) &&
           (a->printed_size == 0 || memcmp(a->printed, b->printed, a->printed_size) == 0);
}

/// Whether one line says that memory ran out, in our words or in the system's.
static bool tells_of_memory(const output *made)
{
    const char *end = made->told != NULL ? strchr(made->told, '\n') : NULL;
    return end != NULL && end[1] == '\0' && strncmp(made->told, "batten: ", 8) == 0 &&
           (strstr(made->told, "out of memory") != NULL || strstr(made->told, strerror(ENOMEM)) != NULL);
}

/// What is wrong with a run; null for nothing.
static const char *fault_of(const outcome *came, const output *made, const output *expected)
{
    if (came->code < 0)
        return WIFSIGNALED(came->status) ? "it was ended by a signal" : "it ended the process";
    if (came->memory.left > 0)
        return "blocks are left in use";
    if (came->open_files != 0)
        return "files are left open";
    if (came->blas_threads != 0)
        return "OpenBLAS has another number of threads";
    if (came->code == EXIT_DONE)
        return same(made, expected) ? NULL : "it did not notice";
    if (came->code != EXIT_BAD_INPUT)
        return "another exit code than 1";
    if (!tells_of_memory(made))
        return "no line that says so";
    // What was whole before the memory ran out, for a report perhaps, may stay.
    bool whole = made->files == 1 && made->file_size > 0 && made->file_size == expected->file_size &&
                 memcmp(made->file, expected->file, made->file_size) == 0;
    return made->files == 0 || whole ? NULL : "files are left";
}

/// Let the n-th allocation fail. Returns whether all was well.
static bool check_failure(const test_case *which, size_t n, failing_mode mode, const output *expected)
{
    outcome came = run(which, n, mode);
    output made = take_output();
    const char *fault = fault_of(&came, &made, expected);
    if (fault != NULL)
        print_error("%s: allocation %zu fails%s: %s (exit code %d, signal %d, %zu left, the first of %zu bytes from "
                    "allocation %zu)\n%s\n",
                    which->name, n, mode == FAIL_ALL ? " and all after it" : "", fault, came.code,
                    WIFSIGNALED(came.status) ? WTERMSIG(came.status) : 0, came.memory.left, came.memory.size,
                    came.memory.left > 0 ? came.memory.first : 0, made.told != NULL ? made.told : "");
    free_output(&made);
    return fault == NULL;
}

/// The allocation to fail after the n-th, of `count`: every one at first, then ever fewer.
static size_t next_of(size_t n, size_t count, bool every)
{
    size_t step = every || n < DENSE || count <= DENSE + SAMPLES ? 1 : (count - DENSE) / SAMPLES;
    return n + step;
}

static size_t check_case(const test_case *which, bool every)
{
    outcome came = run(which, 0, FAIL_ONE);
    output expected = take_output();
    if (came.code != EXIT_DONE || came.memory.left > 0)
        fail_msg("%s: the undisturbed run ends with %d, signal %d, %zu blocks in use, the first from allocation %zu: %s",
                 which->name, came.code, WIFSIGNALED(came.status) ? WTERMSIG(came.status) : 0, came.memory.left,
                 came.memory.first, expected.told);
    assert_true(came.memory.count > 0);
    assert_true(expected.files <= 1 && expected.files + expected.printed_size > 0);
    size_t failures = 0, tried = 0, first = wanted_number > 0 ? wanted_number : 1;
    size_t last = wanted_number > 0 ? first : came.memory.count;
    for (size_t n = first; n <= last; n = next_of(n, came.memory.count, every))
    {
        bool third = ++tried % 3 == 0;
        if (every || !third)
            failures += !check_failure(which, n, FAIL_ONE, &expected);
        if (every || third)
            failures += !check_failure(which, n, FAIL_ALL, &expected);
    }
    free_output(&expected);
    if (every)
        print_message("%s: %zu allocations, %zu failures\n", which->name, came.memory.count, failures);
    return failures;
}

static void verbs_end_cleanly(void **state)
{
    (void)state;
    size_t failures = 0;
    for (size_t i = 0; i < CASE_COUNT; i++)
        failures += check_case(&CASES[i], false);
    assert_int_equal(failures, 0);
}

/// Input that verbs make.
static void make(const verb *what, const char *words)
{
    test_case made = {"input", what, words};
    outcome came = run(&made, 0, FAIL_ONE);
    if (came.code != EXIT_DONE)
        fail_msg("%s: exit code %d", words, came.code);
}

static int make_input(void **state)
{
    (void)state;
    (void)strcpy(folder, "/tmp/batten-test-XXXXXX");
    if (mkdtemp(folder) == NULL || chdir(folder) != 0 || blas_load(NULL) != BAT_OK)
        return -1;
    write_file("plane.csv", "x,y\n0,0\n3,1\n4,4\n1,5\n0,3\n");
    char many[TEXT] = "x,y,height\n";
    for (size_t i = 0; i < 40; i++)
        (void)snprintf(many + strlen(many), sizeof many - strlen(many), "%zu,0,1\n2,%zu,2\n5,5,3\n\n", i, i + 1);
    write_file("many.csv", many);
    write_file("table.csv", "track,lon,lat,name,time,v\nb,1,2,p,2024-05-01T12:00:00Z,\na,3,2,q,2024-05-01T12:00:01Z,4\n"
                            "b,3,4,r,2024-05-01T12:00:02Z,x\na,5,3,s,2024-05-01T12:00:03Z,6\n");
    write_file("strait.csv", "0,0\n8,0\n8,6\n5,6\n5,1\n4.5,1\n4.5,6\n0,6\n");
    write_file("track.geojson",
               "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{\"name\":\"a\"},"
               "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[170,10],[179,20],[-172,15],[-160,30]]}},"
               "{\"type\":\"Feature\",\"properties\":null,\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
               "[[[0,0],[20,0],[20,20],[0,20],[0,0]]]}}]}");
    write_file("lines.geojsonl", "{\"type\":\"LineString\",\"coordinates\":[[0,0],[1,1],[2,0]]}\n"
                                 "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1,1],[2,0],[0,0]]]}\n");
    write_file(
        "track.gpx",
        "<gpx><metadata><bounds minlat=\"0\" minlon=\"0\" maxlat=\"1\" maxlon=\"1\"/></metadata><wpt lat=\"1\" lon=\"2\">"
        "<name>w</name></wpt><trk><name>t</name><trkseg><trkpt lat=\"0\" lon=\"0\"><ele>1</ele><time>2024-05-01T12:00:00Z"
        "</time></trkpt><trkpt lat=\"0\" lon=\"1\"><ele>2</ele><time>2024-05-01T12:00:01Z</time><extensions><hr>9</hr>"
        "</extensions></trkpt><trkpt lat=\"1\" lon=\"1\"><ele>3</ele></trkpt></trkseg></trk></gpx>");
    write_file("shapes.csv",
               "id,g,n\n1,\"LINESTRING Z (0 0 1, 1 1 2, 2 0 3)\",a\n2,\"POLYGON ((0 0, 1 0, 1 1, 0 0))\",\"b,\"\n");
    write_file(
        "two.topojson",
        "{\"type\":\"Topology\",\"objects\":{\"a\":{\"type\":\"GeometryCollection\",\"geometries\":[{\"type\":\"Polygon\","
        "\"arcs\":[[0,1]]},{\"type\":\"Polygon\",\"arcs\":[[2,-1]]}]}},\"arcs\":[[[5,0],[6,5],[5,9]],[[5,9],[0,9],[0,0],"
        "[5,0]],[[5,0],[11,1],[11,9],[5,9]]]}");
    write_file("path.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 1 1\nl 1 2 3 4\n");
    write_file("rotation.csv", "0 0 0 0 0 0 0 1\n1 1 0 0 0.28 0 0 0.96\n2.5 1 1 0 0.6 0 0 0.8\n4 1 1 1 0.48 0.36 0 0.8\n");
    write_file("keys.csv", "time,qw,qx,qy,qz\n0,1,0,0,0\n1,0.96,0.28,0,0\n2,0.8,0.6,0,0\n3,0.8,0.48,0.36,0\n");
    write_file("sheet.obj",
               "v 0 0 0\nv 1 0 0\nv 2 0 1\nv 0 1 0\nv 1 1 1\nv 2 1 0\nv 0 2 0\nv 1 2 0\nv 2 2 1\nvt 0 0\nvt 1 0\nvt 1 1\n"
               "f 1/1 2/2 5/3\nf 1/1 5/3 4/2\nf 2/1 3/2 6/3\nf 2 6 5\nf 4 5 8\nf 4 8 7\nf 5 6 9\nf 5 9 8\n");
    write_file("tiles.obj",
               "v 0 0 0\nv 1 0 0\nv 2 0 1\nv 3 0 0\nv 0 1 0\nv 1 1 1\nv 2 1 0\nv 3 1 0\nv 0 2 0\nv 1 2 0\nv 2 2 1\nv 3 2 0\n"
               "v 0 3 0\nv 1 3 0\nv 2 3 0\nv 3 3 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\ng a\nusemtl b\nf 1/1 2/2 6/3 5/4\n"
               "f 2/2 3/1 7/4 6/3\nf 3 4 8 7\ng c\nf 5 6 10 9\nf 6/3 7/4 11/1 10/2\nf 7 8 12 11\nf 9 10 14 13\nf 10 11 15\n"
               "f 10 15 14\nf 11 12 16 15\nt crease 2/1/0 5 6 2.5\nt corner 1/1/0 10 1.5\n");
    write_file("fins.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
    make(&VERB_SHAPE, "shape cage -o cage.ply --quiet");
    make(&VERB_SHAPE, "shape stone -o stone.ply --vertices 200 --quiet");
    make(&VERB_SHAPE, "shape hull -o hull.xyz --vertices 200 --quiet");
    make(&VERB_SHAPE, "shape scan -o scan.xyz --vertices 250 --quiet");
    make(&VERB_SURFACE,
         "surface hull.xyz -o fit.xml --parameters hull.uv --parameterization uniform --functions 40 --quiet");
    make(&VERB_SURFACE, "surface fit.xml -o fit.json --quiet");
    make(&VERB_SURFACE, "surface hull.xyz -o trimmed.json --trim --functions 20 --force --quiet");
    if (mkdir("runs", 0700) != 0 || chdir("runs") != 0)
        return -1;
    static const char *const inputs[] = {
        "plane.csv", "many.csv", "table.csv",  "track.geojson", "path.obj",  "lines.geojsonl", "rotation.csv", "keys.csv",
        "sheet.obj", "fins.obj", "cage.ply",   "stone.ply",     "hull.xyz",  "scan.xyz",       "fit.xml",      "tiles.obj",
        "fit.json",  "hull.uv",  "strait.csv", "trimmed.json",  "track.gpx", "shapes.csv",     "two.topojson"};
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++)
    {
        char target[64];
        (void)snprintf(target, sizeof target, "../%s", inputs[i]);
        if (symlink(target, inputs[i]) != 0)
            return -1;
    }
    return 0;
}

static void remove_all(const char *name)
{
    DIR *list = opendir(name);
    for (const struct dirent *entry = list != NULL ? readdir(list) : NULL; entry != NULL; entry = readdir(list))
    {
        char path[512];
        if (entry->d_name[0] == '.')
            continue;
        (void)snprintf(path, sizeof path, "%s/%s", name, entry->d_name);
        if (unlink(path) != 0)
            remove_all(path);
    }
    if (list != NULL)
        (void)closedir(list);
    (void)rmdir(name);
}

static int remove_input(void **state)
{
    (void)state;
    assert_int_equal(chdir("/"), 0);
    remove_all(folder);
    return 0;
}

static void every_allocation_is_tried(void **state)
{
    (void)state;
    size_t failures = 0;
    for (size_t i = 0; i < CASE_COUNT; i++)
    {
        if (wanted != NULL && strcmp(wanted, CASES[i].name) != 0)
            continue;
        failures += check_case(&CASES[i], true);
    }
    assert_int_equal(failures, 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(verbs_end_cleanly)},
                            all[] = {cmocka_unit_test(every_allocation_is_tried)};
    wanted = argc > 2 ? argv[2] : NULL;
    wanted_number = argc > 3 ? strtoul(argv[3], NULL, 10) : 0;
    return argc > 1 ? cmocka_run_group_tests(all, make_input, remove_input)
                    : cmocka_run_group_tests(tests, make_input, remove_input);
}
