#include "batten/picture.h"
#include "draw/canvas.h"
#include "draw/comb.h"
#include "draw/ink.h"
#include "draw/simplify.h"
#include "draw/text.h"
#include "draw/ticks.h"
#include "draw/view.h"

#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/// Read by LeakSanitizer: fontconfig keeps its configuration and a few patterns until the program ends.
const char *__lsan_default_suppressions(void); // NOLINT(bugprone-reserved-identifier)
const char *__lsan_default_suppressions(void)  // NOLINT(bugprone-reserved-identifier)
{
    return "leak:libfontconfig";
}

static const double PI = 3.14159265358979323846;

static bat_space plane;
static bat_space solid;
static bat_space five;
static bat_space sphere;
static bat_space disk;
static char folder[] = "/tmp/batten-picture-XXXXXX";

static int set_up(void **state)
{
    (void)state;
    plane = bat_euclidean(2);
    solid = bat_euclidean(3);
    five = bat_euclidean(5);
    sphere = bat_sphere(2);
    disk = bat_disk();
    return mkdtemp(folder) == NULL ? -1 : 0;
}

static int tear_down(void **state)
{
    (void)state;
    return rmdir(folder);
}

static bat_curve make_curve(const bat_space *space, size_t count, bool closed)
{
    bat_curve curve = {.space = space, .count = count, .closed = closed};
    curve.points = calloc(count * space->point_dim, sizeof(double));
    assert_non_null(curve.points);
    return curve;
}

static void set_direction(double *point, double longitude, double latitude)
{
    point[0] = cos(latitude) * cos(longitude);
    point[1] = cos(latitude) * sin(longitude);
    point[2] = sin(latitude);
}

/// A wavy closed curve with `count` points in any of the spaces.
static bat_curve make_sample(const bat_space *space, size_t count)
{
    bat_curve curve = make_curve(space, count, true);
    for (size_t i = 0; i < count; i++)
    {
        double angle = 2.0 * PI * (double)i / (double)count;
        double radius = 0.6 + 0.2 * cos(3.0 * angle);
        double *point = curve.points + i * space->point_dim;
        if (space == &sphere)
        {
            set_direction(point, angle, radius * sin(2.0 * angle));
            continue;
        }
        point[0] = radius * cos(angle);
        point[1] = radius * sin(angle);
        for (size_t k = 2; k < space->point_dim; k++)
        {
            point[k] = 0.1 * sin((double)k * angle);
        }
    }
    return curve;
}

static void path_of(char *path, const char *name)
{
    (void)snprintf(path, 128, "%s/%s", folder, name);
}

/// The bytes of a file, with a zero behind them; released with free().
static char *slurp(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    bytes[*size] = '\0';
    (void)fclose(file);
    return bytes;
}

static size_t folder_entries(void)
{
    size_t count = 0;
    DIR *open_folder = opendir(folder);
    assert_non_null(open_folder);
    for (struct dirent *entry = readdir(open_folder); entry != NULL; entry = readdir(open_folder))
    {
        count += entry->d_name[0] != '.' || strlen(entry->d_name) > 2 ? 1 : 0;
    }
    (void)closedir(open_folder);
    return count;
}

/// Whether a text is somewhere in bytes that may contain zeros.
static bool contains(const char *bytes, size_t size, const char *text)
{
    size_t length = strlen(text);
    for (size_t i = 0; i + length <= size; i++)
    {
        if (memcmp(bytes + i, text, length) == 0)
        {
            return true;
        }
    }
    return false;
}

/// Every tag that opens closes in order, and there is one root.
static void check_nesting(const char *text)
{
    int depth = 0;
    for (const char *tag = strchr(text, '<'); tag != NULL; tag = strchr(tag + 1, '<'))
    {
        const char *end = strchr(tag, '>');
        assert_non_null(end);
        bool opens = tag[1] != '/' && tag[1] != '?' && end[-1] != '/';
        depth += opens ? 1 : tag[1] == '/' ? -1 : 0;
        assert_true(depth >= 0);
    }
    assert_int_equal(depth, 0);
}

static unsigned big_endian(const char *bytes)
{
    const unsigned char *b = (const unsigned char *)bytes;
    return (unsigned)b[0] << 24 | (unsigned)b[1] << 16 | (unsigned)b[2] << 8 | (unsigned)b[3];
}

/// The file at `path` is a picture of that size, in points, of the format its ending says.
static void check_picture(const char *path, unsigned width, unsigned height)
{
    size_t size;
    char *bytes = slurp(path, &size);
    char dimensions[80];
    if (strstr(path, ".svg") != NULL)
    {
        assert_non_null(strstr(bytes, "</svg>"));
        (void)snprintf(dimensions, sizeof dimensions, "width=\"%upt\" height=\"%upt\"", width, height);
        assert_non_null(strstr(bytes, dimensions));
        check_nesting(bytes);
    }
    else if (strstr(path, ".pdf") != NULL)
    {
        assert_memory_equal(bytes, "%PDF-", 5);
        assert_memory_equal(bytes + size - 6, "%%EOF\n", 6);
        (void)snprintf(dimensions, sizeof dimensions, "%u %u ]", width, height);
        assert_true(contains(bytes, size, dimensions));
    }
    else
    {
        assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n", 8);
        assert_int_equal(big_endian(bytes + 16), 2 * width);
        assert_int_equal(big_endian(bytes + 20), 2 * height);
        assert_memory_equal(bytes + size - 8, "IEND", 4);
    }
    free(bytes);
}

static const char *const endings[] = {"svg", "png", "pdf"};

/// Every space, every format, every option that draws something.
static void writes_all_spaces_in_all_formats(void **state)
{
    (void)state;
    const bat_space *spaces[] = {&plane, &solid, &five, &sphere, &disk};
    for (size_t s = 0; s < 5; s++)
    {
        bat_curve curve = make_sample(spaces[s], 64);
        bat_curve coarse = make_sample(spaces[s], 8);
        bat_picture_layer layers[] = {{&coarse, BAT_LAYER_CONTROL, "control polygon", 0},
                                      {&curve, BAT_LAYER_TRUTH, "truth", 0},
                                      {&curve, BAT_LAYER_CURVE, "curve", 0}};
        bat_picture_panel panels[] = {{layers, 3, "left <&>"}, {layers, 3, NULL}};
        bat_picture_options options = bat_picture_defaults();
        options.width = 320;
        options.height = 240;
        options.title = "Title \xc3\xa9";
        options.comb = options.axes = true;
        for (int variant = 0; variant < 9; variant++)
        {
            char name[32];
            char path[128];
            options.projection = (bat_projection)(variant / 3);
            (void)snprintf(name, sizeof name, "picture.%s", endings[variant % 3]);
            path_of(path, name);
            assert_int_equal(bat_picture_write(path, panels, 2, &options, NULL), BAT_OK);
            check_picture(path, 320, 240);
            assert_int_equal(unlink(path), 0);
        }
        free(curve.points);
        free(coarse.points);
    }
}

static void endings_ignore_case(void **state)
{
    (void)state;
    canvas_format format;
    assert_int_equal(canvas_format_of("a/b.SVG", &format, NULL), BAT_OK);
    assert_int_equal(format, CANVAS_SVG);
    assert_int_equal(canvas_format_of("b.x.pNg", &format, NULL), BAT_OK);
    assert_int_equal(format, CANVAS_PNG);
    assert_int_equal(canvas_format_of("B.PDF", &format, NULL), BAT_OK);
    assert_int_equal(format, CANVAS_PDF);
    const char *wrong[] = {"", "svg", ".svg", "a.svg/b", "a.jpeg", "a.", "a/.png", "a.svg "};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
    {
        assert_int_equal(canvas_format_of(wrong[i], &format, NULL), BAT_INVALID_ARGUMENT);
    }
}

static void same_input_gives_same_bytes(void **state)
{
    (void)state;
    bat_curve curve = make_sample(&sphere, 50);
    bat_picture_layer layer = {&curve, BAT_LAYER_CURVE, "curve", 0};
    bat_picture_panel panel = {&layer, 1, "panel"};
    for (int i = 0; i < 3; i++)
    {
        char first[128];
        char second[128];
        char name[16];
        (void)snprintf(name, sizeof name, "a.%s", endings[i]);
        path_of(first, name);
        name[0] = 'b';
        path_of(second, name);
        assert_int_equal(bat_picture_write(first, &panel, 1, NULL, NULL), BAT_OK);
        assert_int_equal(bat_picture_write(second, &panel, 1, NULL, NULL), BAT_OK);
        size_t sizes[2];
        char *bytes[2] = {slurp(first, &sizes[0]), slurp(second, &sizes[1])};
        assert_int_equal(sizes[0], sizes[1]);
        assert_memory_equal(bytes[0], bytes[1], sizes[0]);
        free(bytes[0]);
        free(bytes[1]);
        assert_int_equal(unlink(first), 0);
        assert_int_equal(unlink(second), 0);
    }
    free(curve.points);
}

/// Write a picture of one curve that must fail, and look at the error.
static void check_refused(const bat_curve *curve, bat_status status, size_t index)
{
    char path[128];
    path_of(path, "refused.svg");
    bat_error error = {0};
    bat_picture_layer layer = {curve, BAT_LAYER_CURVE, NULL, 0};
    bat_picture_panel panel = {&layer, 1, NULL};
    assert_int_equal(bat_picture_write(path, &panel, 1, NULL, &error), status);
    assert_int_equal(error.status, status);
    assert_int_equal(error.index, index);
    assert_true(strlen(error.text) > 0);
    assert_int_equal(access(path, F_OK), -1);
}

static void bad_points_are_named(void **state)
{
    (void)state;
    const bat_space *spaces[] = {&plane, &solid, &five, &sphere, &disk};
    double bad[] = {NAN, INFINITY, -INFINITY, 1e200};
    for (size_t s = 0; s < 5; s++)
    {
        for (size_t b = 0; b < 4; b++)
        {
            bat_curve curve = make_sample(spaces[s], 9);
            curve.points[7 * spaces[s]->point_dim + 1] = bad[b];
            check_refused(&curve, BAT_INVALID_POINT, 7);
            free(curve.points);
        }
    }
    bat_curve long_one = make_sample(&sphere, 9);
    long_one.points[3 * 4] *= 1.001;
    long_one.points[3 * 4 + 1] *= 1.001;
    long_one.points[3 * 4 + 2] *= 1.001;
    check_refused(&long_one, BAT_INVALID_POINT, 4);
    free(long_one.points);
    bat_curve outside = make_sample(&disk, 9);
    outside.points[2 * 3] = 0.6;
    outside.points[2 * 3 + 1] = 0.8;
    check_refused(&outside, BAT_INVALID_POINT, 3);
    free(outside.points);
    bat_curve opposite = make_sample(&sphere, 9);
    for (int k = 0; k < 3; k++)
    {
        opposite.points[k] = -opposite.points[3 * 8 + k];
    }
    check_refused(&opposite, BAT_CUT_LOCUS, 8);
    opposite.closed = false;
    char path[128];
    path_of(path, "fine.svg");
    bat_picture_layer layer = {&opposite, BAT_LAYER_CURVE, NULL, 0};
    assert_int_equal(bat_picture_write(path, &(bat_picture_panel){&layer, 1, NULL}, 1, NULL, NULL), BAT_OK);
    assert_int_equal(unlink(path), 0);
    free(opposite.points);
}

static void empty_and_mixed_panels_are_refused(void **state)
{
    (void)state;
    char path[128];
    path_of(path, "refused.png");
    bat_curve flat = make_sample(&plane, 5);
    bat_curve round = make_sample(&sphere, 5);
    bat_curve none = {.space = &plane};
    bat_space line = bat_euclidean(1);
    bat_curve thin = make_curve(&line, 3, false);
    check_refused(&none, BAT_INVALID_ARGUMENT, 0);
    check_refused(NULL, BAT_INVALID_ARGUMENT, 0);
    check_refused(&thin, BAT_UNSUPPORTED, 0);
    bat_picture_layer layers[] = {{&flat, BAT_LAYER_CURVE, NULL, 0}, {&round, BAT_LAYER_CURVE, NULL, 0}};
    bat_picture_panel mixed[] = {{layers, 1, NULL}, {layers, 2, NULL}};
    bat_error error;
    assert_int_equal(bat_picture_write(path, mixed, 2, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 1);
    bat_picture_panel empty[] = {{layers, 1, NULL}, {layers, 1, NULL}, {layers, 0, NULL}};
    assert_int_equal(bat_picture_write(path, empty, 3, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 2);
    empty[2] = (bat_picture_panel){NULL, 1, NULL};
    assert_int_equal(bat_picture_write(path, empty, 3, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_picture_write(path, NULL, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_picture_write(path, mixed, 0, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_picture_write(NULL, mixed, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    free(flat.points);
    free(round.points);
    free(thin.points);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    char path[128];
    path_of(path, "refused.png");
    bat_curve flat = make_sample(&plane, 5);
    bat_picture_layer layer = {&flat, BAT_LAYER_CURVE, NULL, 0};
    bat_picture_panel panel = {&layer, 1, NULL};
    bat_picture_options bad[14];
    for (int i = 0; i < 14; i++)
    {
        bad[i] = bat_picture_defaults();
    }
    bad[0].width = -1.0;
    bad[1].width = NAN;
    bad[2].height = 1e5;
    bad[3].height = INFINITY;
    bad[4].pixels_per_point = 0.0;
    bad[5].pixels_per_point = 1e3;
    bad[6].projection = (bat_projection)7;
    bad[7].latitude = 2.0;
    bad[8].longitude = INFINITY;
    bad[9].comb_scale = -1.0;
    bad[10].comb_scale = NAN;
    bad[11].title = "\xff";
    bad[12].height = 30.0;
    bad[13].width = 30.0;
    for (int i = 0; i < 14; i++)
    {
        assert_int_equal(bat_picture_write(path, &panel, 1, &bad[i], NULL), BAT_INVALID_ARGUMENT);
    }
    layer.label = "\xc0\xaf";
    assert_int_equal(bat_picture_write(path, &panel, 1, NULL, NULL), BAT_INVALID_ARGUMENT);
    layer.label = NULL;
    panel.title = "two\nlines";
    assert_int_equal(bat_picture_write(path, &panel, 1, NULL, NULL), BAT_INVALID_ARGUMENT);
    panel.title = NULL;
    layer.role = (bat_layer_role)9;
    assert_int_equal(bat_picture_write(path, &panel, 1, NULL, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(folder_entries(), 0);
    free(flat.points);
}

static void failure_leaves_files_alone(void **state)
{
    (void)state;
    char path[128];
    char missing[160];
    path_of(path, "kept.png");
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    (void)fputs("precious", file);
    (void)fclose(file);
    bat_curve curve = make_sample(&plane, 5);
    curve.points[4] = NAN;
    bat_picture_layer layer = {&curve, BAT_LAYER_CURVE, NULL, 0};
    bat_picture_panel panel = {&layer, 1, NULL};
    assert_int_equal(bat_picture_write(path, &panel, 1, NULL, NULL), BAT_INVALID_POINT);
    size_t size;
    char *bytes = slurp(path, &size);
    assert_string_equal(bytes, "precious");
    free(bytes);
    curve.points[4] = 0.0;
    bat_error error;
    (void)snprintf(missing, sizeof missing, "%s/none/a.png", folder);
    assert_int_equal(bat_picture_write(missing, &panel, 1, NULL, &error), BAT_FILE_ACCESS);
    assert_int_equal(bat_picture_write(path, &panel, 1, NULL, NULL), BAT_OK);
    assert_int_equal(folder_entries(), 1);
    bytes = slurp(path, &size);
    assert_memory_equal(bytes, "\x89PNG", 4);
    free(bytes);
    free(curve.points);
    assert_int_equal(unlink(path), 0);
}

/// What a path became.
typedef struct recording
{
    double (*points)[2];
    bool *moves;
    size_t count;
    size_t capacity;
} recording;

static void record(void *context, double x, double y, bool move)
{
    recording *log = context;
    if (log->count == log->capacity)
    {
        log->capacity = 2 * log->capacity + 64;
        log->points = realloc(log->points, log->capacity * sizeof *log->points);
        log->moves = realloc(log->moves, log->capacity * sizeof *log->moves);
        assert_true(log->points != NULL && log->moves != NULL);
    }
    log->points[log->count][0] = x;
    log->points[log->count][1] = y;
    log->moves[log->count++] = move;
}

static void record_move(void *context, double x, double y)
{
    record(context, x, y, true);
}

static void record_line(void *context, double x, double y)
{
    record(context, x, y, false);
}

static void forget(recording *log)
{
    free(log->points);
    free(log->moves);
    *log = (recording){0};
}

static path_simplifier recorder(recording *log, double tolerance)
{
    return simplifier_begin((path_sink){record_move, record_line, log}, tolerance);
}

static double distance_to_segment(const double *p, const double *a, const double *b)
{
    double dx = b[0] - a[0];
    double dy = b[1] - a[1];
    double square = dx * dx + dy * dy;
    double share = square > 0.0 ? ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square : 0.0;
    share = fmin(fmax(share, 0.0), 1.0);
    return hypot(p[0] - a[0] - share * dx, p[1] - a[1] - share * dy);
}

/// Simplify a path of `count` points and check it against each point's own piece of the result.
/// @return the number of points kept
static size_t check_simplified(double (*path)[2], size_t count, double tolerance)
{
    recording log = {0};
    path_simplifier simplifier = recorder(&log, tolerance);
    simplifier_move(&simplifier, path[0][0], path[0][1]);
    for (size_t i = 1; i < count; i++)
    {
        simplifier_line(&simplifier, path[i][0], path[i][1]);
    }
    simplifier_flush(&simplifier);
    assert_true(log.moves[0]);
    assert_memory_equal(log.points[0], path[0], sizeof path[0]);
    assert_memory_equal(log.points[log.count - 1], path[count - 1], sizeof path[0]);
    size_t piece = 0; // points before path[i] were drawn by pieces up to this one
    for (size_t i = 0; i < count; i++)
    {
        while (piece + 2 < log.count && memcmp(log.points[piece + 1], path[i], sizeof path[i]) == 0)
        {
            piece++;
        }
        double here = distance_to_segment(path[i], log.points[piece], log.points[piece + 1]);
        assert_true(here <= tolerance);
    }
    size_t kept = log.count;
    forget(&log);
    return kept;
}

/// Smooth, rough, straight, turning back: no dropped point is farther from its piece than the tolerance.
static void simplifier_keeps_its_bound(void **state)
{
    (void)state;
    enum
    {
        COUNT = 20000
    };
    static double path[COUNT][2];
    bat_random random = bat_random_seed(5);
    for (int kind = 0; kind < 6; kind++)
    {
        double x = 0.0;
        double y = 0.0;
        double heading = 0.0;
        for (int i = 0; i < COUNT; i++)
        {
            double t = (double)i / COUNT;
            heading += kind == 1 ? 0.05 * bat_random_normal(&random) : 0.0;
            double step = kind == 3 ? 0.02 * bat_random_normal(&random) : 0.01;
            x = kind == 0 ? 200.0 * cos(2.0 * PI * t) : kind == 4 ? 40.0 * sin(30.0 * t) : x + step * cos(heading);
            y = kind == 0 ? 200.0 * sin(2.0 * PI * t) : kind == 4 ? 40.0 * sin(30.0 * t) : y + step * sin(heading);
            x += kind == 2 ? 0.3 * bat_random_normal(&random) : 0.0;
            y += kind == 5 ? 0.02 * bat_random_normal(&random) : 0.0;
            path[i][0] = x;
            path[i][1] = y;
        }
        const double tolerances[] = {0.02, 0.1, 1.0};
        for (int k = 0; k < 3; k++)
        {
            check_simplified(path, COUNT, tolerances[k]);
        }
    }
}

/// A chord of sagitta s on a circle of radius r spans sqrt(8 s / r), so a circle needs about 2 pi sqrt(r / (8 s)) chords.
static void simplifier_thins_circles(void **state)
{
    (void)state;
    enum
    {
        COUNT = 200000
    };
    static double path[COUNT][2];
    const double radius = 300.0;
    const double tolerance = 0.1;
    for (int i = 0; i < COUNT; i++)
    {
        path[i][0] = radius * cos(2.0 * PI * i / COUNT);
        path[i][1] = radius * sin(2.0 * PI * i / COUNT);
    }
    size_t kept = check_simplified(path, COUNT, tolerance);
    double least = 2.0 * PI * sqrt(radius / (8.0 * tolerance));
    assert_true((double)kept < 2.0 * least + 2.0);
}

static draw_view unit_view(view_kind kind, const bat_space *space)
{
    return (draw_view){
        .kind = kind, .space = view_space_of(space), .point_dim = space->point_dim, .scale = 1.0, .tolerance = 1e-4};
}

/// The coordinates (u, v) of a unit view from those on paper.
static void unpaper(recording *log)
{
    for (size_t i = 0; i < log->count; i++)
    {
        log->points[i][1] = -log->points[i][1];
    }
}

/// A triangle whose edges cross the limb: what is drawn on each side begins and ends on the limb and lies on the edges' great
/// circles.
static void globe_is_cut_at_the_limb(void **state)
{
    (void)state;
    const double corners[] = {1.0, 0.0, 0.0, -0.6, 0.8, 0.0, -0.48, -0.36, 0.8};
    draw_view view = unit_view(VIEW_GLOBE, &sphere);
    view_face(&view, 0.3, 0.2);
    for (int side = VIEW_FRONT; side <= VIEW_BACK; side++)
    {
        recording log = {0};
        path_simplifier path = recorder(&log, 0.0);
        view_trace(&view, corners, 3, true, (view_side)side, &path);
        unpaper(&log);
        size_t cuts = 0;
        for (size_t i = 0; i < log.count; i++)
        {
            double u = log.points[i][0];
            double v = log.points[i][1];
            double rest = 1.0 - u * u - v * v;
            assert_true(rest > -1e-9);
            bool first = log.moves[i] && i > 0;
            bool last = i + 1 == log.count || log.moves[i + 1];
            bool corner = side == VIEW_FRONT && (i == 0 || i + 1 == log.count);
            if ((first || last || log.moves[i]) && !corner)
            {
                assert_true(fabs(hypot(u, v) - 1.0) < 1e-9);
                cuts++;
            }
            double depth = (side == VIEW_FRONT ? 1.0 : -1.0) * sqrt(fmax(rest, 0.0));
            double least = INFINITY;
            for (int k = 0; k < 3; k++)
            {
                double p[3];
                double q[3];
                view_rotate(&view, corners + (size_t)(3 * k), p);
                view_rotate(&view, corners + (size_t)(3 * ((k + 1) % 3)), q);
                double normal[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
                least = fmin(least, fabs(normal[0] * u + normal[1] * v + normal[2] * depth));
            }
            assert_true(least < (fabs(rest) < 1e-9 ? 1e-9 : 1e-7));
        }
        assert_int_equal(cuts, 2);
        forget(&log);
    }
}

/// The halves of a great circle seen at an angle are two half ellipses from limb to limb.
static void globe_halves_a_great_circle(void **state)
{
    (void)state;
    bat_curve circle = make_curve(&sphere, 360, true);
    for (size_t i = 0; i < circle.count; i++)
    {
        set_direction(circle.points + 3 * i, 2.0 * PI * ((double)i + 0.37) / 360.0, 0.0);
    }
    draw_view view = unit_view(VIEW_GLOBE, &sphere);
    view_face(&view, 1.0, 0.5);
    for (int side = VIEW_FRONT; side <= VIEW_BACK; side++)
    {
        recording log = {0};
        path_simplifier path = recorder(&log, 0.0);
        view_trace(&view, circle.points, circle.count, true, (view_side)side, &path);
        unpaper(&log);
        double limit = 0.0;
        for (size_t i = 0; i < log.count; i++)
        {
            double u = log.points[i][0];
            double v = log.points[i][1];
            assert_true(side == VIEW_FRONT ? v < 1e-9 : v > -1e-9);
            assert_true(fabs(u * u + pow(v / sin(0.5), 2.0) - 1.0) < 1e-9);
            limit = fmax(limit, fabs(u));
        }
        assert_true(limit > 1.0 - 1e-9);
        forget(&log);
    }
    free(circle.points);
}

/// An arc over the antimeridian is cut there, at the latitude where the great circle crosses it.
static void map_is_cut_at_the_antimeridian(void **state)
{
    (void)state;
    double arc[6];
    set_direction(arc, 170.0 * PI / 180.0, 0.2);
    set_direction(arc + 3, -150.0 * PI / 180.0, 0.9);
    double normal[3] = {arc[1] * arc[5] - arc[2] * arc[4], arc[2] * arc[3] - arc[0] * arc[5],
                        arc[0] * arc[4] - arc[1] * arc[3]};
    double crossing = atan(normal[0] / normal[2]); // n . (-cos b, 0, sin b) = 0
    draw_view view = unit_view(VIEW_MAP, &sphere);
    recording log = {0};
    path_simplifier path = recorder(&log, 0.0);
    view_trace(&view, arc, 2, false, VIEW_FRONT, &path);
    unpaper(&log);
    size_t cuts = 0;
    for (size_t i = 1; i < log.count; i++)
    {
        if (log.moves[i])
        {
            cuts++;
            assert_true(log.points[i - 1][0] == PI && log.points[i][0] == -PI);
            assert_true(fabs(log.points[i - 1][1] - crossing) < 1e-12);
            assert_true(log.points[i][1] == log.points[i - 1][1]);
        }
        else
        {
            assert_true(fabs(log.points[i][0] - log.points[i - 1][0]) < 0.2);
        }
        double point[3];
        set_direction(point, log.points[i][0], log.points[i][1]);
        assert_true(fabs(normal[0] * point[0] + normal[1] * point[1] + normal[2] * point[2]) < 1e-12);
    }
    assert_int_equal(cuts, 1);
    forget(&log);
}

/// Whatever the curve, no line of a map runs across it; points on the antimeridian itself do no harm.
static void map_has_no_streaks(void **state)
{
    (void)state;
    draw_view view = unit_view(VIEW_MAP, &sphere);
    bat_random random = bat_random_seed(9);
    for (int trial = 0; trial < 200; trial++)
    {
        double points[15];
        for (int i = 0; i < 5; i++)
        {
            double longitude = i == 2 ? PI : PI * (2.0 * bat_random_uniform(&random) - 1.0);
            set_direction(points + (size_t)(3 * i), longitude, 1.4 * (2.0 * bat_random_uniform(&random) - 1.0));
        }
        points[7] = trial % 2 == 0 ? 0.0 : -0.0;
        recording log = {0};
        path_simplifier path = recorder(&log, 0.0);
        view_trace(&view, points, 5, true, VIEW_FRONT, &path);
        for (size_t i = 1; i < log.count; i++)
        {
            assert_true(fabs(log.points[i][0]) <= PI);
            assert_true(log.moves[i] || fabs(log.points[i][0] - log.points[i - 1][0]) < 0.5 * PI);
            assert_true(!log.moves[i] || fabs(fabs(log.points[i][0]) - PI) < 1e-15);
        }
        forget(&log);
    }
}

/// Poincaré's distance.
static double disk_distance(const double *p, const double *q)
{
    double square = pow(p[0] - q[0], 2.0) + pow(p[1] - q[1], 2.0);
    double room = (1.0 - p[0] * p[0] - p[1] * p[1]) * (1.0 - q[0] * q[0] - q[1] * q[1]);
    return 2.0 * asinh(sqrt(square / room));
}

/// Points of a geodesic add their distances up to the whole.
static void disk_edges_are_geodesics(void **state)
{
    (void)state;
    draw_view view = unit_view(VIEW_POINCARE, &disk);
    bat_random random = bat_random_seed(3);
    for (int trial = 0; trial < 300; trial++)
    {
        double ends[4];
        for (int i = 0; i < 2; i++)
        {
            double radius = tanh(2.0 * bat_random_uniform(&random));
            double angle = trial % 10 == 0 ? 0.7 + PI * i : 2.0 * PI * bat_random_uniform(&random);
            ends[2 * i] = radius * cos(angle);
            ends[2 * i + 1] = radius * sin(angle);
        }
        recording log = {0};
        path_simplifier path = recorder(&log, 0.0);
        view_trace(&view, ends, 2, false, VIEW_FRONT, &path);
        unpaper(&log);
        double whole = disk_distance(ends, ends + 2);
        for (size_t i = 0; i < log.count; i++)
        {
            double detour = disk_distance(ends, log.points[i]) + disk_distance(log.points[i], ends + 2) - whole;
            assert_true(detour < 1e-9 * (1.0 + whole));
        }
        for (size_t i = 1; i + 1 < log.count; i++)
        {
            double middle[2] = {0.5 * (log.points[i][0] + log.points[i - 1][0]),
                                0.5 * (log.points[i][1] + log.points[i - 1][1])};
            double radius = hypot(middle[0], middle[1]);
            assert_true(radius < 1.0);
        }
        forget(&log);
    }
}

static void automatic_view_finds_the_middle(void **state)
{
    (void)state;
    const double longitudes[] = {0.0, 2.0, -3.0};
    const double latitudes[] = {0.0, 0.9, -1.2};
    for (int i = 0; i < 3; i++)
    {
        bat_curve circle = make_curve(&sphere, 500, true);
        draw_view view = unit_view(VIEW_GLOBE, &sphere);
        view_face(&view, longitudes[i], latitudes[i]);
        for (size_t k = 0; k < circle.count; k++)
        {
            double angle = 2.0 * PI * (double)k / (double)circle.count;
            double local[3] = {sin(0.7) * cos(angle), sin(0.7) * sin(angle), cos(0.7)};
            for (int c = 0; c < 3; c++)
            {
                circle.points[3 * k + (size_t)c] =
                    view.rotation[0][c] * local[0] + view.rotation[1][c] * local[1] + view.rotation[2][c] * local[2];
            }
        }
        const bat_curve *curves[] = {&circle};
        double longitude;
        double latitude;
        assert_int_equal(bat_picture_view(curves, 1, &longitude, &latitude, NULL), BAT_OK);
        assert_true(fabs(remainder(longitude - longitudes[i], 2.0 * PI)) < 1e-9);
        assert_true(fabs(latitude - latitudes[i]) < 1e-9);
        free(circle.points);
    }
    bat_curve flat = make_sample(&plane, 5);
    const bat_curve *curves[] = {&flat};
    double angle;
    assert_int_equal(bat_picture_view(curves, 1, &angle, &angle, NULL), BAT_UNSUPPORTED);
    free(flat.points);
}

/// A great circle has no mean. It is seen from 25 degrees above its plane, from the north.
static void automatic_view_of_a_great_circle_is_oblique(void **state)
{
    (void)state;
    const double inclination = 0.9;
    bat_curve circle = make_curve(&sphere, 400, true);
    for (size_t i = 0; i < circle.count; i++)
    {
        double t = 2.0 * PI * (double)i / (double)circle.count;
        double *p = circle.points + 3 * i;
        p[0] = cos(t);
        p[1] = sin(t) * cos(inclination);
        p[2] = sin(t) * sin(inclination);
    }
    const bat_curve *curves[] = {&circle};
    double longitude;
    double latitude;
    assert_int_equal(bat_picture_view(curves, 1, &longitude, &latitude, NULL), BAT_OK);
    double eye[3];
    set_direction(eye, longitude, latitude);
    double height = -sin(inclination) * eye[1] + cos(inclination) * eye[2];
    assert_true(fabs(height - sin(25.0 * PI / 180.0)) < 1e-6);
    free(circle.points);
}

/// The regular n-gon of radius r has curvature (2 pi / n) / edge. Its limit is 1/r in the plane, cot r on the sphere and
/// coth r in the hyperbolic plane; teeth point away from the middle.
static void comb_measures_circles(void **state)
{
    (void)state;
    const bat_space *spaces[] = {&plane, &solid, &sphere, &disk};
    const double radius = 0.8;
    const double expected[] = {1.0 / radius, 1.0 / radius, 1.0 / tan(radius), 1.0 / tanh(radius)};
    for (size_t s = 0; s < 4; s++)
    {
        bat_curve circle = make_curve(spaces[s], 2000, true);
        for (size_t i = 0; i < circle.count; i++)
        {
            double angle = 2.0 * PI * (double)i / (double)circle.count;
            double *p = circle.points + i * spaces[s]->point_dim;
            double reach = s < 2 ? radius : s == 2 ? sin(radius) : tanh(0.5 * radius);
            p[0] = reach * cos(angle);
            p[1] = reach * sin(angle);
            if (s == 2)
            {
                p[2] = cos(radius);
            }
        }
        comb teeth;
        assert_int_equal(comb_make(&circle, &teeth, NULL), BAT_OK);
        assert_int_equal(teeth.count, circle.count);
        for (size_t i = 0; i < teeth.count; i++)
        {
            size_t n = teeth.point_dim;
            double size = 0.0;
            for (size_t k = 0; k < n; k++)
            {
                size += teeth.vectors[i * n + k] * teeth.vectors[i * n + k];
            }
            assert_true(fabs(sqrt(size) - expected[s]) < 1e-5);
            double tip[3];
            comb_tip(&teeth, i, 0.1, tip);
            double reach = radius + 0.1 * expected[s];
            double paper = s < 2 ? reach : s == 2 ? sin(reach) : tanh(0.5 * reach);
            assert_true(fabs(hypot(tip[0], tip[1]) - paper) < 1e-6);
        }
        double scale;
        assert_int_equal(comb_natural_scale(&teeth, 0.5, 1.0, &scale, NULL), BAT_OK);
        assert_true(fabs(scale - 0.5 / expected[s]) < 1e-5);
        comb_free(&teeth);
        free(circle.points);
    }
}

static void comb_of_a_line_is_flat(void **state)
{
    (void)state;
    bat_curve line = make_curve(&plane, 20000, false);
    for (size_t i = 0; i < line.count; i++)
    {
        line.points[2 * i] = (double)i;
    }
    comb teeth;
    assert_int_equal(comb_make(&line, &teeth, NULL), BAT_OK);
    assert_true(teeth.count <= COMB_MOST && teeth.count > COMB_MOST / 2);
    double scale;
    assert_int_equal(comb_natural_scale(&teeth, 1.0, 2.0, &scale, NULL), BAT_OK);
    assert_true(isinf(scale));
    comb_free(&teeth);
    free(line.points);
}

/// Degenerate curves are drawn too: one point, coincident points, a vertical line, far from the origin.
static void degenerate_curves_are_drawn(void **state)
{
    (void)state;
    char path[128];
    path_of(path, "degenerate.svg");
    const bat_space *spaces[] = {&plane, &solid, &sphere, &disk};
    bat_picture_options options = bat_picture_defaults();
    options.comb = options.axes = true;
    for (size_t s = 0; s < 4; s++)
    {
        for (size_t count = 1; count <= 4; count++)
        {
            bat_curve curve = make_curve(spaces[s], count, count != 2);
            for (size_t i = 0; i < count; i++)
            {
                curve.points[i * spaces[s]->point_dim + (s == 2 ? 2 : 1)] = s == 0   ? 1e9 + (double)(i / 3)
                                                                            : s == 2 ? 1.0
                                                                                     : 0.5;
            }
            bat_picture_layer layers[] = {{&curve, BAT_LAYER_CURVE, NULL, 0}, {&curve, BAT_LAYER_CONTROL, NULL, 0}};
            for (int projection = 0; projection < 3; projection++)
            {
                options.projection = (bat_projection)projection;
                assert_int_equal(bat_picture_write(path, &(bat_picture_panel){layers, 2, NULL}, 1, &options, NULL), BAT_OK);
                size_t size;
                char *bytes = slurp(path, &size);
                assert_null(strstr(bytes, "nan"));
                assert_null(strstr(bytes, "inf"));
                check_nesting(bytes);
                free(bytes);
            }
            free(curve.points);
        }
    }
    assert_int_equal(unlink(path), 0);
}

static void large_curves_become_small_files(void **state)
{
    (void)state;
    const bat_space *spaces[] = {&plane, &sphere, &disk};
    for (size_t s = 0; s < 3; s++)
    {
        bat_curve curve = make_sample(spaces[s], 400000);
        bat_picture_layer layer = {&curve, BAT_LAYER_CURVE, NULL, 0};
        for (int i = 0; i < 3; i++)
        {
            char name[16];
            char path[128];
            (void)snprintf(name, sizeof name, "large.%s", endings[i]);
            path_of(path, name);
            assert_int_equal(bat_picture_write(path, &(bat_picture_panel){&layer, 1, NULL}, 1, NULL, NULL), BAT_OK);
            size_t size;
            free(slurp(path, &size));
            assert_true(size < 200000);
            assert_int_equal(unlink(path), 0);
        }
        free(curve.points);
    }
}

/// Noise leaves the ink of its band, whatever the number of points; every point of the line lies on ink.
static void rough_curves_become_ink(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(7);
    bat_curve noise = make_curve(&plane, 300000, true);
    for (size_t i = 0; i < noise.count; i++)
    {
        double angle = 2.0 * PI * (double)i / (double)noise.count;
        double radius = 1.0 + 0.05 * bat_random_uniform(&random);
        noise.points[2 * i] = radius * cos(angle);
        noise.points[2 * i + 1] = radius * sin(angle);
    }
    char path[128];
    path_of(path, "rough.svg");
    bat_picture_layer layer = {&noise, BAT_LAYER_CURVE, NULL, 0};
    assert_int_equal(bat_picture_write(path, &(bat_picture_panel){&layer, 1, NULL}, 1, NULL, NULL), BAT_OK);
    size_t size;
    free(slurp(path, &size));
    assert_true(size < 2000000);
    assert_int_equal(unlink(path), 0);
    free(noise.points);

    ink_map map;
    assert_int_equal(ink_begin(-3.0, -2.0, 3.0, 2.0, &map, NULL), BAT_OK);
    path_sink sink = ink_sink(&map);
    const double ends[4] = {-3.0, 2.0, 2.9, -1.7};
    sink.move(sink.context, ends[0], ends[1]);
    sink.line(sink.context, ends[2], ends[3]);
    size_t marks = 0;
    for (size_t row = 0; row < map.rows; row++)
    {
        for (size_t column = 0; column < map.columns; column++)
        {
            double middle[2] = {-3.0 + ((double)column + 0.5) * INK_CELL, -2.0 + ((double)row + 0.5) * INK_CELL};
            double away = distance_to_segment(middle, ends, ends + 2);
            bool marked = (map.words[row * map.stride + column / 64] >> column % 64 & 1u) != 0;
            assert_true(marked ? away <= 0.2 : away >= 0.25 * INK_CELL);
            marks += marked ? 1 : 0;
        }
    }
    assert_true((double)marks > hypot(5.9, 3.7) / INK_CELL / sqrt(2.0));
    ink_free(&map);
}

static void texts_must_be_utf8(void **state)
{
    (void)state;
    const char *good[] = {NULL, "", "plain", "\xc2\xb0", "\xe2\x88\x92", "\xf0\x9f\x99\x82", "\xed\x9f\xbf"};
    const char *bad[] = {"\x80", "\xc1\x81", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                         "\xc2", "\xe2\x88", "a\tb",         "\x7f"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
    {
        assert_true(text_is_valid(good[i]));
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    {
        assert_false(text_is_valid(bad[i]));
    }
}

static void long_texts_are_cut_between_characters(void **state)
{
    (void)state;
    draw_canvas canvas;
    assert_int_equal(canvas_open(&canvas, CANVAS_PNG, 10.0, 10.0, 1.0, NULL), BAT_OK);
    text_use(canvas.cairo, 10.0, false);
    char text[2048] = "";
    for (int i = 0; i < 600; i++)
    {
        (void)strcat(text, "\xc3\xa9");
    }
    for (size_t capacity = 5; capacity < 1300; capacity += 97)
    {
        char cut[2048];
        text_cut(canvas.cairo, text, 1e9, cut, capacity);
        assert_true(strlen(cut) < capacity);
        assert_true(text_is_valid(cut));
        text_cut(canvas.cairo, text, 60.0, cut, sizeof cut);
        assert_true(text_is_valid(cut));
        assert_true(text_width(canvas.cairo, cut) <= 60.0);
    }
    canvas_close(&canvas);
}

static size_t labelled(tick_list ticks)
{
    size_t count = 0;
    for (size_t i = 0; i < ticks.count; i++)
    {
        count += ticks.labelled[i] ? 1 : 0;
    }
    return count;
}

static void ticks_are_round(void **state)
{
    (void)state;
    tick_list ticks = ticks_linear(-0.11, 0.52, 6.0);
    char label[TICK_LABEL_SIZE];
    assert_int_equal(ticks.count, 7);
    tick_label(&ticks, 0, label);
    assert_string_equal(label, "\xe2\x88\x92"
                               "0.1");
    tick_label(&ticks, 1, label);
    assert_string_equal(label, "0.0");
    tick_label(&ticks, 6, label);
    assert_string_equal(label, "0.5");
    ticks = ticks_logarithmic(0.5, 300.0, 6.0);
    for (size_t i = 0; i < ticks.count; i++)
    {
        assert_true(ticks.values[i] >= 0.5 * (1.0 - 1e-9) && ticks.values[i] <= 300.0);
        assert_true(i == 0 || ticks.values[i] > ticks.values[i - 1]);
    }
    for (int i = 0; i < 200; i++) // never too many, never none, whatever the range
    {
        double low = 1.1 * pow(10.0, -150.0 + i);
        double high = low * (1.5 + i);
        assert_true(ticks_linear(low, high, 8.0).count >= 2);
        assert_true(ticks_linear(-high, low, 8.0).count <= TICKS_MAX);
        assert_true(labelled(ticks_logarithmic(low, high, 8.0)) >= 1);
        assert_true(labelled(ticks_logarithmic(low, low * pow(10.0, 0.7 * i + 0.4), 8.0)) >= 1);
    }
    assert_int_equal(ticks_exponent(0.0, 99999.0), 0);
    assert_int_equal(ticks_exponent(-2e6, 1.0), 6);
    assert_int_equal(ticks_exponent(0.0, 4e-5), -6);
}

static void writes_charts(void **state)
{
    (void)state;
    const double x[] = {0.1, 1.0, 10.0, 100.0};
    const double y[] = {3.0, 1e-9, 5e6, 2.0};
    const char *names[] = {"a", NULL, "a rather long name", ""};
    for (int mark = 0; mark <= BAT_SERIES_BARS; mark++)
    {
        for (int axes = 0; axes < 4; axes++)
        {
            bat_chart_series series = {x, y, 4, (bat_series_mark)mark, "series", names, 0};
            bat_chart chart = bat_chart_defaults();
            chart.series = &series;
            chart.series_count = 1;
            chart.x_label = chart.y_label = chart.title = "text";
            chart.log_x = axes % 2 == 1;
            chart.log_y = axes >= 2 && mark != BAT_SERIES_BARS;
            bat_picture_options options = bat_picture_defaults();
            options.width = 300;
            options.height = 200;
            for (int i = 0; i < 3; i++)
            {
                char name[16];
                char path[128];
                (void)snprintf(name, sizeof name, "chart.%s", endings[i]);
                path_of(path, name);
                assert_int_equal(bat_chart_write(path, &chart, 1, &options, NULL), BAT_OK);
                check_picture(path, 300, 200);
                assert_int_equal(unlink(path), 0);
            }
        }
    }
}

static void bad_charts_are_refused(void **state)
{
    (void)state;
    char path[128];
    path_of(path, "chart.svg");
    double x[] = {1.0, 2.0, 3.0};
    double y[] = {1.0, 0.0, 3.0};
    bat_chart_series series = {x, y, 3, BAT_SERIES_LINE, NULL, NULL, 0};
    bat_chart chart = bat_chart_defaults();
    bat_error error;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    chart.series = &series;
    chart.series_count = 1;
    chart.log_y = true;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    chart.log_y = false;
    chart.x_low = chart.x_high = 2.0;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    chart.x_low = chart.x_high = NAN;
    y[2] = NAN;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 2);
    y[2] = 1.0;
    x[1] = 0.5;
    series.mark = BAT_SERIES_BARS;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    series.count = 0;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_chart_write(path, NULL, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(folder_entries(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_all_spaces_in_all_formats),
        cmocka_unit_test(endings_ignore_case),
        cmocka_unit_test(same_input_gives_same_bytes),
        cmocka_unit_test(bad_points_are_named),
        cmocka_unit_test(empty_and_mixed_panels_are_refused),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(failure_leaves_files_alone),
        cmocka_unit_test(simplifier_keeps_its_bound),
        cmocka_unit_test(simplifier_thins_circles),
        cmocka_unit_test(globe_is_cut_at_the_limb),
        cmocka_unit_test(globe_halves_a_great_circle),
        cmocka_unit_test(map_is_cut_at_the_antimeridian),
        cmocka_unit_test(map_has_no_streaks),
        cmocka_unit_test(disk_edges_are_geodesics),
        cmocka_unit_test(automatic_view_finds_the_middle),
        cmocka_unit_test(automatic_view_of_a_great_circle_is_oblique),
        cmocka_unit_test(comb_measures_circles),
        cmocka_unit_test(comb_of_a_line_is_flat),
        cmocka_unit_test(degenerate_curves_are_drawn),
        cmocka_unit_test(large_curves_become_small_files),
        cmocka_unit_test(rough_curves_become_ink),
        cmocka_unit_test(texts_must_be_utf8),
        cmocka_unit_test(long_texts_are_cut_between_characters),
        cmocka_unit_test(ticks_are_round),
        cmocka_unit_test(writes_charts),
        cmocka_unit_test(bad_charts_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
