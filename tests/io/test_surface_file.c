// Spline surfaces as XML and JSON: exact round trips, and errors with their lines.

#include "surface/spline/hierarchical_space.h"
#include "surface_helpers.h"

#include <unistd.h>

static const surface_kind kinds[] = {
    {{2, 2}, {1, 1}, true, 0, 3, 6},  {{3, 1}, {5, 3}, true, 0, 1, 8},  {{2, 4}, {3, 7}, true, 2, 2, 5},
    {{3, 3}, {4, 2}, false, 0, 3, 7}, {{1, 1}, {2, 3}, false, 0, 5, 9}, {{2, 2}, {6, 6}, true, 3, 3, 12},
    {{5, 2}, {3, 3}, true, 0, 3, 0},
};
enum
{
    KINDS = sizeof kinds / sizeof *kinds
};

static void test_round_trips(void **state)
{
    (void)state;
    for (size_t k = 0; k < KINDS; k++)
        for (uint64_t seed = 0; seed < 10; seed++)
        {
            bat_spline_surface surface = random_surface(&kinds[k], seed);
            for (int format = BAT_SURFACE_FORMAT_XML; format <= BAT_SURFACE_FORMAT_JSON;
                 format += BAT_SURFACE_FORMAT_JSON - BAT_SURFACE_FORMAT_XML)
            {
                char *text = must_write(&surface, (bat_surface_format)format, NULL);
                bat_spline_surface back = must_read(text);
                assert_same_surface(&surface, &back);
                char *again = must_write(&back, (bat_surface_format)format, NULL);
                assert_string_equal(again, text);
                bat_hierarchical_options before = bat_hierarchical_space_options(surface.space);
                bat_hierarchical_options after = bat_hierarchical_space_options(back.space);
                if (format == BAT_SURFACE_FORMAT_JSON || kinds[k].refinements > 0)
                    assert_int_equal(after.truncated, before.truncated);
                assert_int_equal(after.admissible, format == BAT_SURFACE_FORMAT_JSON ? before.admissible : 0);
                free(again);
                free(text);
                bat_spline_surface_free(&back);
            }
            bat_spline_surface_free(&surface);
        }
}

static void test_files(void **state)
{
    (void)state;
    static const char *const names[] = {"surface.XML", "surface.json"};
    bat_spline_surface surface = random_surface(&kinds[0], 3), back;
    char folder[] = "/tmp/batten-surface-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    for (size_t i = 0; i < 2; i++)
    {
        (void)snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        check_status(bat_surface_write(path, &surface, NULL, NULL), BAT_OK);
        check_status(bat_surface_read(path, &back, NULL), BAT_OK);
        assert_same_surface(&surface, &back);
        bat_spline_surface_free(&back);
        assert_int_equal(unlink(path), 0);
    }
    check_status(bat_surface_read(path, &back, NULL), BAT_FILE_ACCESS);
    assert_int_equal(rmdir(folder), 0);
    bat_spline_surface_free(&surface);
}

/// The knots of a direction, shifted and scaled, with the digits of G+Smo.
static void append_knots(text_buffer *text, int degree, size_t spans, double from, double length)
{
    char number[128];
    (void)snprintf(number, sizeof number, "    <Basis type=\"BSplineBasis\" index=\"0\">\n     <KnotVector degree=\"%d\">",
                   degree);
    text_append_string(text, number);
    for (size_t i = 0; i <= spans + 2 * (size_t)degree; i++)
    {
        double place = fmin(fmax((double)i - degree, 0), (double)spans);
        (void)snprintf(number, sizeof number, "%g ", from + length * place / (double)spans);
        text_append_string(text, number);
    }
    text_append_string(text, "</KnotVector>\n    </Basis>\n");
}

/// The boxes that G+Smo writes for two regions: the first of level 1 is the left half, the second of level 2 is a part of
/// it. The rest of level 1 divides cells of level 0.
static const char leaves[] = "   <box level=\"2\">2 2 6 6 \n</box>\n   <box level=\"1\">0 0 1 6 \n</box>\n"
                             "   <box level=\"1\">3 0 4 6 \n</box>\n   <box level=\"1\">1 0 3 1 \n</box>\n"
                             "   <box level=\"1\">1 3 3 6 \n</box>\n";

/// A file in the form of G+Smo for the identity of the square: coefficients are Greville points.
static char *gismo_file(const bat_spline_surface *surface, const char *boxes)
{
    text_buffer text = {0};
    bat_hierarchical_options options = bat_hierarchical_space_options(surface->space);
    text_append_string(&text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<xml>\n <!-- a comment -->\n"
                              " <MultiPatch parDim=\"2\"><patches type=\"id_range\">0 0</patches></MultiPatch>\n"
                              " <Geometry type=\"THBSpline2\" id=\"0\">\n"
                              "  <Basis type=\"THBSplineBasis2\" manualLevels=\"false\">\n"
                              "   <Basis type=\"TensorBSplineBasis2\">\n");
    append_knots(&text, options.degree[0], options.spans[0], 0, 1);
    append_knots(&text, options.degree[1], options.spans[1], -2, 30);
    text_append_string(&text, "   </Basis>\n");
    text_append_string(&text, boxes);
    text_append_string(&text, "  </Basis>\n  <coefs geoDim=\"3\">");
    for (size_t i = 0; i < 3 * bat_hierarchical_space_functions(surface->space); i++)
    {
        char number[128];
        (void)snprintf(number, sizeof number, "%.17g%s", surface->control[i], i % 3 == 2 ? " \n" : " ");
        text_append_string(&text, number);
    }
    text_append_string(&text, "</coefs>\n </Geometry>\n</xml>\n");
    text_append(&text, "", 1);
    return text.data;
}

static void test_gismo(void **state)
{
    (void)state;
    const surface_kind kind = {{2, 3}, {3, 3}, true, 0, 3, 0};
    bat_spline_surface surface = {.dimension = 3};
    bat_hierarchical_options options = bat_hierarchical_defaults();
    memcpy(options.degree, kind.degree, sizeof options.degree);
    memcpy(options.spans, kind.spans, sizeof options.spans);
    check_status(bat_hierarchical_space_make(&options, &surface.space, NULL), BAT_OK);
    const bat_spline_box boxes[] = {{0, {0, 0}, {2, 3}}, {1, {1, 1}, {3, 3}}};
    check_status(bat_hierarchical_space_refine(surface.space, boxes, 2, NULL), BAT_OK);
    size_t count = bat_hierarchical_space_functions(surface.space);
    surface.control = malloc(3 * count * sizeof *surface.control);
    for (size_t f = 0; f < count; f++)
    {
        bat_spline_function function = hierarchical_space_function(surface.space, f);
        const uint32_t index[2] = {function.i, function.j};
        for (int d = 0; d < 2; d++)
        {
            double spans = ldexp(3, (int)function.level), sum = 0;
            for (int k = 1; k <= kind.degree[d]; k++)
                sum += fmin(fmax((double)index[d] + k - kind.degree[d], 0), spans);
            surface.control[3 * f + (size_t)d] = sum / (spans * kind.degree[d]);
        }
        surface.control[3 * f + 2] = 7;
    }
    char *text = gismo_file(&surface, leaves);
    bat_spline_surface back = must_read(text);
    assert_same_surface(&surface, &back);
    for (int i = 0; i <= 20; i++)
        for (int j = 0; j <= 20; j++)
        {
            double position[3];
            evaluate_at(&back, i / 20., j / 20., position);
            check_near(position[0], i / 20., 1e-14);
            check_near(position[1], j / 20., 1e-14);
            check_near(position[2], 7, 1e-14);
        }
    free(text);
    bat_spline_surface_free(&back);
    bat_spline_surface_free(&surface);
}

/// A cell of level 0 that boxes of level 1 fill only partly.
static void test_gismo_unfilled(void **state)
{
    (void)state;
    bat_spline_surface surface = random_sheet(&(surface_kind){{2, 2}, {3, 3}, true, 0, 3, 0}, 1), back = {0};
    char *text = gismo_file(&surface, "   <box level=\"1\">0 0 3 4 \n</box>\n");
    bat_error error = {0};
    check_status(read_string(text, &back, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "level 1 do not fill"));
    assert_int_equal(error.line, 15);
    assert_null(back.space);
    free(text);
    bat_spline_surface_free(&surface);
}

typedef struct bad_text
{
    const char *text;
    bat_status status;
    size_t line;
    const char *words;
} bad_text;

static void assert_refused(const bad_text *bad)
{
    bat_spline_surface surface = {0};
    bat_error error = {0};
    bat_status status = read_string(bad->text, &surface, &error);
    if (status != bad->status || error.line != bad->line || strstr(error.text, bad->words) == NULL)
        fail_msg("status %s, line %zu, '%s' instead of line %zu, '%s' for: %s", bat_status_name(status), error.line,
                 error.text, bad->line, bad->words, bad->text);
    assert_null(strchr(error.text, '\n'));
    assert_int_equal(error.status, status);
    assert_null(surface.space);
    assert_null(surface.control);
    check_status(read_string(bad->text, &surface, NULL), bad->status);
}

#define XML_DIRECTION(knots) "<Basis type=\"BSplineBasis\"><KnotVector degree=\"1\">" knots "</KnotVector></Basis>\n"
#define XML_TENSOR(coefs)                                                                                                   \
    "<xml>\n<Geometry type=\"TensorBSpline2\">\n<Basis type=\"TensorBSplineBasis2\">\n" XML_DIRECTION("0 0 1 1")            \
        XML_DIRECTION("0 0 1 1") "</Basis>\n" coefs "</Geometry>\n</xml>\n"
#define XML_HIERARCHY(basis, boxes, coefs)                                                                                  \
    "<xml>\n<Geometry type=\"THBSpline2\">\n<Basis " basis                                                                  \
    ">\n<Basis type=\"TensorBSplineBasis2\">\n" XML_DIRECTION("0 0 1 1")                                                    \
        XML_DIRECTION("0 0 1 1") "</Basis>\n" boxes "</Basis>\n" coefs "</Geometry>\n</xml>\n"
#define XML_KNOTS(knots)                                                                                                    \
    "<xml>\n<Geometry type=\"TensorBSpline2\">\n<Basis type=\"TensorBSplineBasis2\">\n" XML_DIRECTION("0 0 1 1")            \
        XML_DIRECTION(knots) "</Basis>\n<coefs geoDim=\"1\">1 2 3 4 5 6</coefs></Geometry>\n</xml>\n"
#define XML_THB "type=\"THBSplineBasis2\""
#define XML_FOUR "<coefs geoDim=\"1\">1 2 3 4</coefs>"

static void test_bad_xml(void **state)
{
    (void)state;
    static const bad_text bad[] = {
        {"<xml>\n<Geometry/>\n</xml>\n", BAT_UNSUPPORTED, 2, "geometry of type ''"},
        {"<xml>\n<Geometry type=\"TensorBSpline2\">\n</xml>\n", BAT_BAD_FILE, 3, "mismatched tag"},
        {"<xml>\n<Geometry type=\"TensorNurbs2\"/>\n</xml>\n", BAT_UNSUPPORTED, 2, "'TensorNurbs2' is not supported"},
        {"<xml></xml>", BAT_BAD_FILE, 0, "no element <Geometry>"},
        {"<svg></svg>", BAT_UNSUPPORTED, 1, "<svg>"},
        {"<xml><Geometry type=\"THBSpline2\"></Geometry></xml>", BAT_BAD_FILE, 1, "lacks a <KnotVector>"},
        {"<!DOCTYPE xml [<!ENTITY a \"b\">]><xml>&a;</xml>", BAT_UNSUPPORTED, 1, "document types"},
        {XML_TENSOR(""), BAT_BAD_FILE, 2, "lacks <coefs>"},
        {XML_TENSOR("<coefs>1 2 3 4</coefs>\n"), BAT_BAD_FILE, 7, "'geoDim'"},
        {XML_TENSOR("<coefs geoDim=\"0\">1 2 3 4</coefs>\n"), BAT_BAD_FILE, 7, "of 0 coordinates"},
        {XML_TENSOR("<coefs geoDim=\"3\">1 2 3 4</coefs>\n"), BAT_BAD_FILE, 7, "4 numbers are not points of 3"},
        {XML_TENSOR("<coefs geoDim=\"1\">1 2 3</coefs>\n"), BAT_BAD_FILE, 7, "3 control points, fewer than the 4"},
        {XML_TENSOR("<coefs geoDim=\"1\">1 2 3 4 5</coefs>\n"), BAT_BAD_FILE, 7, "5 control points, but 4 functions"},
        {XML_TENSOR("<coefs geoDim=\"1\">1\n2\n x3 4</coefs>\n"), BAT_BAD_FILE, 9, "'x3' is not a number"},
        {XML_TENSOR("<coefs geoDim=\"1\">1 2 3 nan</coefs>\n"), BAT_BAD_FILE, 7, "'nan' is not a number"},
        {XML_TENSOR("<coefs geoDim=\"1\">1 2 3 1e999</coefs>\n"), BAT_BAD_FILE, 7, "'1e999' is not a number"},
        {XML_TENSOR("<coefs geoDim=\"1\" format=\"Base64\">abc</coefs>\n"), BAT_UNSUPPORTED, 7, "ASCII"},
        {XML_TENSOR(XML_FOUR XML_FOUR), BAT_BAD_FILE, 7, "has coefficients already"},
        {XML_TENSOR(XML_FOUR "\n<transform/>\n"), BAT_UNSUPPORTED, 8, "<transform>"},
        {XML_TENSOR(XML_FOUR "</Geometry>\n<Geometry type=\"THBSpline2\">"), BAT_UNSUPPORTED, 8, "second surface"},
        {XML_TENSOR(XML_DIRECTION("0 0 1 1")), BAT_UNSUPPORTED, 7, "<Basis>"},
        {XML_KNOTS("0 0 0.4 1 1"), BAT_UNSUPPORTED, 5, "uniform"},
        {XML_KNOTS("0 0 0.5 0.5 1 1"), BAT_UNSUPPORTED, 5, "uniform"},
        {XML_KNOTS("0 0.5 1 1"), BAT_UNSUPPORTED, 5, "uniform"},
        {XML_KNOTS("0 0 0 0"), BAT_UNSUPPORTED, 5, "uniform"},
        {XML_KNOTS("0 1"), BAT_UNSUPPORTED, 5, "2 equal knots"},
        {XML_KNOTS(""), BAT_UNSUPPORTED, 5, "uniform"},
        {XML_KNOTS("1 1 0 0"), BAT_UNSUPPORTED, 5, "uniform"},
        {XML_HIERARCHY(XML_THB, "<box>0 0 2 2</box>\n", XML_FOUR), BAT_BAD_FILE, 8, "'level'"},
        {XML_HIERARCHY(XML_THB, "<box level=\"1\">0 0 2</box>\n", XML_FOUR), BAT_BAD_FILE, 8, "four whole"},
        {XML_HIERARCHY(XML_THB, "<box level=\"1\">0 0 2 1.5</box>\n", XML_FOUR), BAT_BAD_FILE, 8, "four whole"},
        {XML_HIERARCHY(XML_THB, "<box level=\"1\">0 0 2 -1</box>\n", XML_FOUR), BAT_BAD_FILE, 8, "four whole"},
        {XML_HIERARCHY(XML_THB, "<box level=\"1\">0 0 2 3</box>\n", XML_FOUR), BAT_BAD_FILE, 8, "exceeds the 2 cells"},
        {XML_HIERARCHY(XML_THB, "\n<box level=\"1\">0 2 2 2</box>\n", XML_FOUR), BAT_BAD_FILE, 9, "is empty"},
        {XML_HIERARCHY(XML_THB, "<box level=\"20\">0 0 2 2</box>\n", XML_FOUR), BAT_BAD_FILE, 8, "level 20, above 19"},
        {XML_HIERARCHY(XML_THB, "<box level=\"99999999999\">0 0 2 2</box>\n", XML_FOUR), BAT_BAD_FILE, 8, "'level'"},
        {XML_HIERARCHY(XML_THB, "<box level=\"19\">0 0 524288 524288</box>\n", XML_FOUR), BAT_TOO_LARGE, 8, "cells"},
        {XML_HIERARCHY(XML_THB, "<box level=\"1\">0 0 2 2</box>\n", XML_FOUR), BAT_BAD_FILE, 10, "but 9 functions"},
        {XML_HIERARCHY(XML_THB " manualLevels=\"true\"", "", XML_FOUR), BAT_UNSUPPORTED, 3, "halved spans"},
        {XML_HIERARCHY("type=\"HBSplineBasis2\"", "", XML_FOUR), BAT_UNSUPPORTED, 3, "<Basis>"},
        {"", BAT_BAD_FILE, 1, "neither"},
        {"v 0 0 0\n", BAT_BAD_FILE, 1, "neither"},
        {"ISO-10303-21;\n", BAT_UNSUPPORTED, 0, "STEP"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(&bad[i]);
    bat_spline_surface good = must_read(XML_TENSOR("<coefs geoDim=\"1\">1 2\n3\t4</coefs>\n"));
    assert_int_equal(good.control[3], 4);
    bat_spline_surface_free(&good);
}

#define JSON_HEAD                                                                                                           \
    "{\"format\": \"batten surface\", \"version\": 1,\n\"degree\": [1, 1],\n\"spans\": [1, 1],\n\"dimension\": 1,\n"
#define JSON_FOUR "\"control\": [[1],\n[2],\n[3],\n[4]]}\n"
#define JSON_HIERARCHY(boxes, rest) JSON_HEAD "\"boxes\": [" boxes "],\n" rest

static void test_bad_json(void **state)
{
    (void)state;
    static const bad_text bad[] = {
        {"{\n", BAT_BAD_FILE, 2, "expected"},
        {"{\"format\": 1}", BAT_BAD_FILE, 1, "\"format\""},
        {"{\"format\": \"batten surface\",\n\"version\": 2}", BAT_UNSUPPORTED, 2, "\"version\" 1"},
        {"{\"format\": \"batten surface\", \"version\": 1}", BAT_BAD_FILE, 0, "\"degree\""},
        {"{\"format\": \"batten surface\", \"version\": 1,\n\"degree\": [0, 1]}", BAT_BAD_FILE, 2, "\"degree\""},
        {"{\"format\": \"batten surface\", \"version\": 1,\n\"degree\": [1, 16]}", BAT_BAD_FILE, 2, "\"degree\""},
        {"{\"format\": \"batten surface\", \"version\": 1, \"degree\": [1, 2],\n\"spans\": [0, 3]}", BAT_BAD_FILE, 2,
         "\"spans\""},
        {JSON_HIERARCHY("", ""), BAT_BAD_FILE, 6, "string or '}' expected"},
        {JSON_HIERARCHY("", "\"control\": 3}"), BAT_BAD_FILE, 6, "\"control\" is not an array"},
        {JSON_HIERARCHY("", "\"control\": []}"), BAT_BAD_FILE, 6, "fewer than the 4"},
        {JSON_HIERARCHY("", "\"truncated\": 1,\n" JSON_FOUR), BAT_BAD_FILE, 6, "\"truncated\""},
        {JSON_HIERARCHY("", "\"admissible\": 1,\n" JSON_FOUR), BAT_BAD_FILE, 6, "\"admissible\""},
        {JSON_HIERARCHY("[1, 0, 0, 2]", JSON_FOUR), BAT_BAD_FILE, 5, "element 0 of \"boxes\""},
        {JSON_HIERARCHY("\n[1, 0, 0, 2, 2],\n[2, 0, 0, 2, 5]", JSON_FOUR), BAT_BAD_FILE, 7, "exceeds the 4 cells"},
        {JSON_HIERARCHY("\n[1, 0, 0, 2, 2]", JSON_FOUR), BAT_BAD_FILE, 7, "4 control points, but 9 functions"},
        {JSON_HIERARCHY("", "\"control\": [[1],\n[2],\n[3, 4],\n[4]]}"), BAT_BAD_FILE, 8, "element 2 of \"control\""},
        {JSON_HIERARCHY("", "\"control\": [[1, 2],\n[2],\n[3],\n[4]]}"), BAT_BAD_FILE, 6, "element 0 of \"control\""},
        {JSON_HIERARCHY("", "\"control\": [[1],\n[2],\n[3],\n[\"a\"]]}"), BAT_BAD_FILE, 9, "not a number"},
        {JSON_HIERARCHY("", "\"functions\": [[0, 0, 0]],\n" JSON_FOUR), BAT_BAD_FILE, 6, "\"functions\""},
        {JSON_HIERARCHY("", "\"functions\": [[0, 0, 0],\n[0, 0, 1],\n[0, 0, 1],\n[0, 1, 1]],\n" JSON_FOUR), BAT_BAD_FILE, 8,
         "occurs twice"},
        {JSON_HIERARCHY("", "\"functions\": [[0, 0, 0],\n[0, 0, 1],\n[0, 2, 1],\n[0, 1, 1]],\n" JSON_FOUR), BAT_BAD_FILE, 8,
         "not in the basis"},
        {JSON_HIERARCHY("", "\"functions\": [[0, 0, 0],\n[0, 0],\n[0, 2, 1],\n[0, 1, 1]],\n" JSON_FOUR), BAT_BAD_FILE, 7,
         "three whole numbers"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(&bad[i]);
}

/// Functions may come in any order.
static void test_json_order(void **state)
{
    (void)state;
    bat_spline_surface surface =
        must_read(JSON_HIERARCHY("", "\"functions\": [[0,1,1],[0,0,1],[0,0,0],[0,1,0]],\n" JSON_FOUR));
    static const double expected[4] = {3, 4, 2, 1};
    assert_memory_equal(surface.control, expected, sizeof expected);
    bat_spline_surface_free(&surface);
}

/// A file of a few bytes may specify any number of spans.
static void test_sizes(void **state)
{
    (void)state;
    static const bad_text bad[] = {
        {"{\"format\": \"batten surface\", \"version\": 1, \"degree\": [1, 1], \"spans\": [4294967295, 4294967295],\n"
         "\"dimension\": 1, \"boxes\": [],\n" JSON_FOUR,
         BAT_BAD_FILE, 3, "fewer than"},
        {"{\"format\": \"batten surface\", \"version\": 1, \"degree\": [1, 1], \"spans\": [1, 1],\n"
         "\"dimension\": 4294967295, \"boxes\": [],\n" JSON_FOUR,
         BAT_BAD_FILE, 3, "element 0"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(&bad[i]);
}

static void test_write_refuses(void **state)
{
    (void)state;
    bat_spline_surface surface = random_surface(&kinds[1], 1);
    bat_error error;
    const bat_surface_write_options many = {.samples = 5000}, points = {.point_count = 3}, unknown = {.format = 17};
    check_status(bat_surface_write("/nowhere/a.step", &surface, NULL, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "dimension 1"));
    check_status(bat_surface_write("/nowhere/a.brep", &surface, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, ".step"));
    check_status(bat_surface_write("-", &surface, NULL, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_surface_write("/nowhere/a.xml", &surface, &unknown, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_surface_write("/nowhere/a.xml", &surface, &many, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_surface_write("/nowhere/a.xml", &surface, &points, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_surface_write("/nowhere/a.xml", &surface, NULL, NULL), BAT_FILE_ACCESS);
    surface.control[4] = NAN;
    check_status(bat_surface_write("/nowhere/a.xml", &surface, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 4);
    bat_spline_surface_free(&surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trips),    cmocka_unit_test(test_files),   cmocka_unit_test(test_gismo),
        cmocka_unit_test(test_gismo_unfilled), cmocka_unit_test(test_bad_xml), cmocka_unit_test(test_bad_json),
        cmocka_unit_test(test_json_order),     cmocka_unit_test(test_sizes),   cmocka_unit_test(test_write_refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
