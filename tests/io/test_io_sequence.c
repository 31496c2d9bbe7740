// Sequences of GeoJSON texts, read as a whole and part by part.

#include "test_io_helpers.h"

#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

static const bat_curve_format GEOJSON = BAT_CURVE_FORMAT_GEOJSON, LINES = BAT_CURVE_FORMAT_GEOJSON_LINES,
                              SEQUENCE = BAT_CURVE_FORMAT_GEOJSON_SEQUENCE, AUTO = BAT_CURVE_FORMAT_AUTO;

#define FEATURE(id, geometry) "{\"type\":\"Feature\",\"id\":\"" id "\",\"properties\":{\"a\":1},\"geometry\":" geometry "}"
#define LINE "{\"type\":\"LineString\",\"coordinates\":[[0,0],[1,1],[2,0]]}"
#define POINT "{\"type\":\"Point\",\"coordinates\":[3,4]}"
#define RS "\x1e"

static const char TWO[] = FEATURE("x", LINE) "\n" FEATURE("y", LINE) "\n";
static const char TWO_RECORDS[] = RS FEATURE("x", LINE) "\n" RS FEATURE("y", LINE) "\n";

static const char *path_of(const char *name)
{
    static char paths[4][80];
    static size_t next;
    char *path = paths[next++ % 4];
    (void)snprintf(path, sizeof paths[0], "test_io_sequence_%ld_%s", (long)getpid(), name);
    return path;
}

static void save(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

/// The content of a file, which is removed; null when there is none.
static char *take(const char *path)
{
    enum
    {
        ROOM = 1 << 20
    };
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return NULL;
    char *text = calloc(1, ROOM);
    assert_non_null(text);
    assert_true(fread(text, 1, ROOM - 1, file) < ROOM - 1);
    (void)fclose(file);
    (void)remove(path);
    return text;
}

static void test_lines_are_kept(void **state)
{
    (void)state;
    assert_rewritten(TWO, LINES, NULL, TWO);
    assert_rewritten(TWO_RECORDS, SEQUENCE, NULL, TWO_RECORDS);
    // Blank lines, line breaks of Windows, a byte order mark, no line break at the end.
    assert_rewritten("\xEF\xBB\xBF\n  \r\n" FEATURE("x", LINE) "\r\n\r\n \t" FEATURE("y", LINE), LINES, NULL, TWO);
    // Records may have many lines, and empty ones are skipped.
    assert_rewritten("\n" RS RS "{\"type\":\n\"LineString\",\n\"coordinates\":[[0,0],\n[1,1],[2,0]]}" RS " \n" RS POINT,
                     SEQUENCE, NULL, RS LINE "\n" RS POINT "\n");
    // Either kind is read under either name.
    assert_rewritten(TWO_RECORDS, LINES, NULL, TWO);
}

static void test_kinds_are_found_by_content(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *again;
        size_t curves;
    } cases[] = {{TWO, TWO, 2},
                 {TWO_RECORDS, TWO_RECORDS, 2},
                 {"\n" LINE " \n\n" LINE "\n", LINE "\n" LINE "\n", 2},
                 {LINE "\n", LINE "\n", 1},
                 {"{\"type\":\"FeatureCollection\",\"features\":[" FEATURE("x", LINE) ",\n" FEATURE("y", LINE) "]}",
                  "{\"type\":\"FeatureCollection\",\"features\":[\n" FEATURE("x", LINE) ",\n" FEATURE("y", LINE) "\n]}\n",
                  2}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_set set = must_read(cases[i].text, AUTO, NULL);
        assert_int_equal(set.count, cases[i].curves);
        char *text = must_write(&set, AUTO);
        assert_string_equal(text, cases[i].again);
        free(text);
        bat_curve_set_free(&set);
        // An ending that stands for GeoJSON is no obstacle.
        const char *path = path_of("kind.geojson");
        save(path, cases[i].text);
        assert_int_equal(bat_curve_read(path, NULL, &set, NULL), BAT_OK);
        assert_int_equal(set.count, cases[i].curves);
        bat_curve_set_free(&set);
        free(take(path));
    }
}

/// A geometry in place of a feature becomes one in a collection.
static void test_collections_and_sequences_convert(void **state)
{
    (void)state;
    bat_curve_set set = must_read(FEATURE("x", LINE) "\n" LINE "\n" POINT "\n", LINES, NULL);
    char *text = must_write(&set, GEOJSON);
    assert_string_equal(text, "{\"type\":\"FeatureCollection\",\"features\":[\n" FEATURE(
                                  "x", LINE) ",\n{\"type\":\"Feature\",\"properties\":null,\"geometry\":" LINE
                                             "},\n{\"type\":\"Feature\",\"properties\":null,\"geometry\":" POINT "}\n]}\n");
    bat_curve_set_free(&set);
    set = must_read(text, GEOJSON, NULL);
    free(text);
    text = must_write(&set, SEQUENCE);
    assert_string_equal(text,
                        RS FEATURE("x", LINE) "\n" RS "{\"type\":\"Feature\",\"properties\":null,\"geometry\":" LINE "}\n" RS
                                              "{\"type\":\"Feature\",\"properties\":null,\"geometry\":" POINT "}\n");
    free(text);
    bat_curve_set_free(&set);
    set = must_read("lon,lat\n0,0\n1,1\n2,0\n", BAT_CURVE_FORMAT_CSV, NULL);
    text = must_write(&set, LINES);
    assert_string_equal(text, "{\"type\":\"Feature\",\"properties\":{},\"geometry\":" LINE "}\n");
    free(text);
    bat_curve_set_free(&set);
}

static void test_faults_name_line_and_feature(void **state)
{
    (void)state;
    assert_bad(FEATURE("x", LINE) "\n\n{\"type\":\"LineString\",\"coordinates\":[[0,0],[1,1", LINES, NULL, 3, "");
    assert_bad(FEATURE("x", LINE) "\n{\"type\":\"LineString\"\n" FEATURE("y", LINE), LINES, NULL, 2, "");
    assert_bad(LINE "\n" LINE "\n{\"type\":\"LineString\",\"coordinates\":[[0,0],[1,95]]}\n", LINES, NULL, 3, "feature 2");
    assert_bad(RS LINE "\n" RS "\n\n{\"type\":\"LineString\",\"coordinates\":[[0,0],[0,95]]}\n", SEQUENCE, NULL, 4,
               "feature 1");
    assert_bad("{\"type\":\"FeatureCollection\",\"features\":[]}\n", LINES, NULL, 1, "not a FeatureCollection");
    assert_bad("\n \n", LINES, NULL, 0, "there are no lines or polygons");
    assert_bad(POINT "\n", LINES, NULL, 0, "there are no lines or polygons");
}

/// A text of many records, the kth with k + 2 points; release it with free().
static char *many_records(size_t count, const char *separator)
{
    enum
    {
        ROOM = 1 << 16
    };
    char *text = malloc(ROOM);
    assert_non_null(text);
    size_t used = 0;
    for (size_t k = 0; k < count; k++)
    {
        used += (size_t)snprintf(text + used, ROOM - used,
                                 "%s{\"type\":\"Feature\",\"id\":%zu,\"properties\":null,\"geometry\":{\"type\":"
                                 "\"LineString\",\"coordinates\":[",
                                 separator, k);
        for (size_t i = 0; i < k + 2; i++)
            used += (size_t)snprintf(text + used, ROOM - used, "%s[%zu,%zu]", i == 0 ? "" : ",", i, (i * i) % 7);
        used += (size_t)snprintf(text + used, ROOM - used, "]}}\n");
        assert_true(used < ROOM - 1000);
    }
    return text;
}

typedef struct visited
{
    size_t calls, curves, stop_after;
} visited;

static bool visit(void *context, const bat_curve_set *coarse, const bat_curve_set *fine)
{
    visited *seen = context;
    seen->calls++;
    seen->curves += coarse->count;
    assert_int_equal(coarse->count, fine->count);
    return seen->calls != seen->stop_after;
}

/// Part by part gives the bytes of the whole, for any kind of input and output.
static void test_parts_equal_the_whole(void **state)
{
    (void)state;
    static const char *const inputs[] = {"in.geojsonl", "in.geojsons", "in.ndjson"};
    static const char *const outputs[] = {"out.geojsonl", "out.geojsons", "out.geojson"};
    for (size_t i = 0; i < 9; i++)
    {
        char *text = many_records(40, i / 3 == 1 ? RS : "");
        const char *in = path_of(inputs[i / 3]), *out = path_of(outputs[i % 3]);
        save(in, text);
        free(text);
        visited seen = {0, 0, 0};
        bat_curve_refine_report done;
        bat_curve_refine_file_report report;
        bat_error error;
        bat_curve_refine_file_options options = bat_curve_refine_file_defaults();
        options.refine.levels = 3;
        options.refine.report = &done;
        options.visit = visit;
        options.context = &seen;
        if (bat_curve_refine_file(in, out, &options, &report, &error) != BAT_OK)
            fail_msg("%s", error.text);
        assert_true(report.streamed);
        assert_int_equal(report.features, 40);
        assert_int_equal(report.curves, 40);
        assert_int_equal(seen.curves, 40);
        assert_int_equal(done.max_levels, 3);
        assert_int_equal(done.min_levels, 3);
        char *streamed = take(out);
        bat_curve_set coarse = {0}, fine = {0};
        assert_int_equal(bat_curve_read(in, NULL, &coarse, NULL), BAT_OK);
        bat_curve *curves = calloc(coarse.count, sizeof *curves);
        assert_non_null(curves);
        assert_int_equal(bat_curves_refine(coarse.curves, coarse.count, &options.refine, curves, NULL), BAT_OK);
        assert_int_equal(bat_curve_set_like(&coarse, curves, &fine, NULL), BAT_OK);
        assert_int_equal(bat_curve_write(out, &fine, NULL, NULL), BAT_OK);
        char *whole = take(out);
        assert_string_equal(streamed, whole);
        free(streamed);
        free(whole);
        free(take(in));
        bat_curve_set_free(&coarse);
        bat_curve_set_free(&fine);
    }
}

static void test_other_formats_are_refined_whole(void **state)
{
    (void)state;
    const char *in = path_of("in.csv"), *out = path_of("out.csv");
    bat_curve_refine_file_report report;
    save(in, "x,y\n0,0\n1,1\n2,0\n");
    bat_curve_refine_file_options options = bat_curve_refine_file_defaults();
    options.refine.levels = 1;
    assert_int_equal(bat_curve_refine_file(in, out, &options, &report, NULL), BAT_OK);
    assert_false(report.streamed);
    assert_int_equal(report.curves, 1);
    assert_int_equal(report.fine_points, 5);
    free(take(in));
    free(take(out));
}

/// A failure names the feature and leaves the output as it was; so does the caller's wish to stop.
static void test_all_or_nothing(void **state)
{
    (void)state;
    const char *in = path_of("bad.geojsonl"), *out = path_of("bad-out.geojsonl");
    bat_error error;
    save(out, "before");
    save(in, FEATURE("x", LINE) "\n\n" FEATURE("far", "{\"type\":\"LineString\",\"coordinates\":[[0,0],[180,0]]}") "\n");
    assert_int_equal(bat_curve_refine_file(in, out, NULL, NULL, &error), BAT_CUT_LOCUS);
    assert_int_equal(error.line, 3);
    assert_non_null(strstr(error.text, "feature 1 (id 'far')"));
    save(in, FEATURE("x", LINE) "\n" FEATURE("y", LINE) "\n{\"type\":\"Feature\"");
    assert_int_equal(bat_curve_refine_file(in, out, NULL, NULL, &error), BAT_BAD_FILE);
    assert_int_equal(error.line, 3);
    save(in, TWO);
    visited seen = {0, 0, 1};
    bat_curve_refine_file_options options = bat_curve_refine_file_defaults();
    options.visit = visit;
    options.context = &seen;
    assert_int_equal(bat_curve_refine_file(in, out, &options, NULL, &error), BAT_CANCELLED);
    save(in, POINT "\n");
    assert_int_equal(bat_curve_refine_file(in, out, NULL, NULL, &error), BAT_BAD_FILE);
    assert_int_equal(bat_curve_refine_file(path_of("none.geojsonl"), out, NULL, NULL, &error), BAT_FILE_ACCESS);
    char *text = take(out);
    assert_string_equal(text, "before");
    free(text);
    // The result may replace the input.
    save(in, TWO);
    assert_int_equal(bat_curve_refine_file(in, in, NULL, NULL, &error), BAT_OK);
    text = take(in);
    assert_int_equal(strncmp(text, TWO, 40), 0);
    assert_true(strlen(text) > strlen(TWO));
    free(text);
}

/// The memory does not grow with the file: half its size is never needed.
static void test_memory_is_bounded(void **state)
{
    (void)state;
    enum
    {
        FEATURES = 6000,
        POINTS = 600
    };
    if (getenv("BATTEN_SANITIZED") != NULL)
        skip();
    const char *in = path_of("long.geojsonl"), *out = path_of("long-out.geojsonl");
    FILE *file = fopen(in, "wb");
    assert_non_null(file);
    for (int k = 0; k < FEATURES; k++)
    {
        (void)fprintf(file, "{\"type\":\"LineString\",\"coordinates\":[[0,0]");
        for (int i = 1; i < POINTS; i++)
            (void)fprintf(file, ",[%.6f,%.6f]", i * 0.01, (double)((i * (k + 3)) % 97) / 97);
        (void)fprintf(file, "]}\n");
    }
    long bytes = ftell(file);
    assert_int_equal(fclose(file), 0);
    struct rusage before, after;
    assert_int_equal(getrusage(RUSAGE_SELF, &before), 0);
    bat_curve_refine_file_options options = bat_curve_refine_file_defaults();
    options.refine.levels = 0;
    options.read.threads = options.refine.threads = options.write.threads = 2;
    bat_curve_refine_file_report report;
    assert_int_equal(bat_curve_refine_file(in, out, &options, &report, NULL), BAT_OK);
    assert_int_equal(getrusage(RUSAGE_SELF, &after), 0);
    assert_int_equal(report.fine_points, (size_t)FEATURES * POINTS);
    (void)remove(in);
    (void)remove(out);
    assert_true((after.ru_maxrss - before.ru_maxrss) * 1024L < bytes / 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lines_are_kept),
        cmocka_unit_test(test_kinds_are_found_by_content),
        cmocka_unit_test(test_collections_and_sequences_convert),
        cmocka_unit_test(test_faults_name_line_and_feature),
        cmocka_unit_test(test_parts_equal_the_whole),
        cmocka_unit_test(test_other_formats_are_refined_whole),
        cmocka_unit_test(test_all_or_nothing),
        cmocka_unit_test(test_memory_is_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
