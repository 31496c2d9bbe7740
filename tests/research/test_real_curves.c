// The study of curves that people have, on a small folder of files that this test writes.

#include "check.h"

#include "batten/curve.h"
#include "batten/research/curve_study.h"
#include "research/studies/curve_akima.h"

#include <unistd.h>

static const double PI = 3.14159265358979323846;

enum
{
    /// Points of a true curve, and edges of the regular polygon.
    DENSE = 4000,
    CORNERS = 12
};

static char root[] = "/tmp/batten-real-curves-XXXXXX";

static int make_root(void **state)
{
    (void)state;
    return mkdtemp(root) == NULL ? -1 : 0;
}

static FILE *open_file(const char *name)
{
    char path[256];
    (void)snprintf(path, sizeof path, "%s/%s", root, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    return file;
}

static void remove_file(const char *name)
{
    char path[256];
    (void)snprintf(path, sizeof path, "%s/%s", root, name);
    assert_int_equal(remove(path), 0);
}

/// A circle, and an open wave.
static void write_curves(const char *name, size_t circle, size_t wave)
{
    FILE *file = open_file(name);
    (void)fprintf(file, "# space: plane\n# closed\n");
    for (size_t i = 0; i < circle; i++)
        (void)fprintf(file, "%.17g,%.17g\n", cos(2 * PI * (double)i / (double)circle),
                      sin(2 * PI * (double)i / (double)circle));
    if (wave > 0)
        (void)fprintf(file, "\n# open\n");
    for (size_t i = 0; i < wave; i++)
    {
        double t = 7 * (double)i / (double)(wave - 1);
        (void)fprintf(file, "%.17g,%.17g\n", 3 + t, sin(t));
    }
    assert_int_equal(fclose(file), 0);
}

static const bat_real_curves_row *find(const bat_real_curves_row *rows, size_t count, const char *space, const char *family,
                                       const char *sampling, const char *method)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(rows[i].space, space) == 0 && strcmp(rows[i].family, family) == 0 &&
            strcmp(rows[i].sampling, sampling) == 0 && strcmp(rows[i].method, method) == 0)
            return &rows[i];
    return NULL;
}

/// A regular polygon in a circle: on the mean, a chord is cos(a) from a point of the arc over it, which is sin(a) / a high,
/// and a circle 1 minus the mean distance of the chord's points from the centre.
static void circles_have_known_distances(void **state)
{
    (void)state;
    write_curves("ring-truth.csv", DENSE, 0);
    write_curves("ring-even.csv", CORNERS, 0);
    bat_real_curves_row *rows;
    size_t count;
    check_status(bat_real_curves(root, NULL, &rows, &count, NULL), BAT_OK);
    double a = PI / CORNERS, edge = 2 * sin(a), height = cos(a), inward = 0;
    for (int k = 0; k < 10000; k++)
        inward += (1 - hypot(height, sin(a) * (2 * k + 1 - 10000) / 10000)) / 10000;
    double mean = 0.5 * (sin(a) / a - height + inward) / edge, largest = (1 - height) / edge;
    const bat_real_curves_row *polygon = find(rows, count, "plane", "ring", "even", "polygon");
    assert_non_null(polygon);
    assert_int_equal(polygon->curves, 1);
    check_relative(polygon->distance, mean, 2e-3);
    check_relative(polygon->largest, largest, 2e-3);
    check_near(polygon->turn, 2 * a, 1e-12);
    assert_true(polygon->relative == 1);
    // Angle-based schemes reproduce the circle; only the steps of the samples remain.
    const bat_real_curves_row *angle = find(rows, count, "plane", "ring", "even", "angle-4");
    assert_true(angle->distance < PI / 8000 / edge);
    check_near(angle->turn, 2 * a / 32, 1e-9);
    assert_int_equal(angle->crossed, 0);
    // On a cap of 20 degrees, lengths differ by some per cent.
    const bat_real_curves_row *cap = find(rows, count, "sphere", "ring", "even", "polygon");
    check_relative(cap->distance, mean, 0.05);
    // Not all methods exist on the sphere.
    assert_null(find(rows, count, "sphere", "ring", "even", "akima"));
    assert_null(find(rows, count, "sphere", "ring", "even", "four-point"));
    const char *const both[] = {"default",
                                "learned:fairness=0",
                                "learned:fairness=1",
                                "angle-6",
                                "log-exp-4",
                                "log-exp-6",
                                "four-point:parameters=chordal",
                                "catmull-rom",
                                "cubic",
                                "angle-4",
                                "catmull-rom",
                                "four-point:parameters=centripetal"};
    for (size_t i = 0; i < sizeof both / sizeof *both; i++)
        assert_non_null(find(rows, count, "sphere", "ring", "even", both[i]));
    free(rows);
    remove_file("ring-even.csv");
    remove_file("ring-truth.csv");
}

static bool stop(void *context, double share)
{
    (void)context;
    return share < 0.3;
}

/// Families and samplings by name, also where one family's name begins another's; threads change no byte.
static void folders_of_several_families(void **state)
{
    (void)state;
    write_curves("line-truth.csv", DENSE, DENSE);
    write_curves("line-even.csv", 20, 15);
    write_curves("line-few.csv", 7, 6);
    write_curves("line-2-truth.csv", DENSE, 0);
    write_curves("line-2-even.csv", 15, 0);
    bat_real_curves_options options = bat_real_curves_defaults();
    bat_tension_method further = {.name = "mine", .scheme = bat_curve_scheme_angle(0)};
    options.methods = &further;
    options.method_count = 1;
    options.threads = 1;
    bat_real_curves_row *rows, *again;
    size_t count, again_count;
    check_status(bat_real_curves(root, &options, &rows, &count, NULL), BAT_OK);
    options.threads = 3;
    check_status(bat_real_curves(root, &options, &again, &again_count, NULL), BAT_OK);
    assert_int_equal(count, again_count);
    assert_int_equal(count, 3 * (16 + 14));
    for (size_t i = 0; i < count; i++)
    {
        assert_string_equal(rows[i].family, again[i].family);
        assert_string_equal(rows[i].sampling, again[i].sampling);
        assert_true(rows[i].method == again[i].method && rows[i].crossed == again[i].crossed);
        assert_true(rows[i].distance == again[i].distance && rows[i].largest == again[i].largest);
        assert_true(rows[i].turn == again[i].turn && rows[i].relative == again[i].relative);
        assert_int_equal(rows[i].curves, strcmp(rows[i].family, "line") == 0 ? 2 : 1);
        assert_int_equal(rows[i].crossed, 0);
    }
    // Smooth curves with even samples: splines are far nearer than the polygon, in both spaces alike.
    const char *const splines[] = {"cubic", "catmull-rom", "four-point:parameters=chordal"};
    for (size_t i = 0; i < 3; i++)
    {
        const bat_real_curves_row *plane = find(rows, count, "plane", "line", "even", splines[i]);
        const bat_real_curves_row *sphere = find(rows, count, "sphere", "line", "even", splines[i]);
        assert_true(plane->relative < 0.2);
        assert_true(sphere->relative < 0.2);
        assert_true(plane->relative < find(rows, count, "plane", "line", "few", splines[i])->relative);
    }
    const bat_real_curves_row *mine = find(rows, count, "plane", "line-2", "even", "mine");
    assert_true(mine->distance == find(rows, count, "plane", "line-2", "even", "angle-4")->distance);
    free(rows);
    free(again);
    options.progress.report = stop;
    check_status(bat_real_curves(root, &options, &rows, &count, NULL), BAT_CANCELLED);
    const char *const files[] = {"line-truth.csv", "line-even.csv", "line-few.csv", "line-2-truth.csv", "line-2-even.csv"};
    for (size_t i = 0; i < 5; i++)
        remove_file(files[i]);
}

static void bad_folders_are_refused(void **state)
{
    (void)state;
    bat_real_curves_row *rows = NULL;
    size_t count = 17;
    bat_error error;
    check_status(bat_real_curves("/no/such/folder", NULL, &rows, &count, &error), BAT_FILE_ACCESS);
    check_status(bat_real_curves(root, NULL, &rows, &count, &error), BAT_BAD_FILE);
    write_curves("ring-truth.csv", DENSE, 0);
    check_status(bat_real_curves(root, NULL, &rows, &count, &error), BAT_BAD_FILE);
    write_curves("ring-even.csv", CORNERS, 5);
    check_status(bat_real_curves(root, NULL, &rows, &count, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "2 curves, but 1 true"));
    FILE *file = open_file("ring-even.csv");
    (void)fprintf(file, "# open\n0,0\n1,0\n1,1\n");
    assert_int_equal(fclose(file), 0);
    check_status(bat_real_curves(root, NULL, &rows, &count, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "open"));
    bat_real_curves_options options = bat_real_curves_defaults();
    options.levels = 13;
    check_status(bat_real_curves(root, &options, &rows, &count, &error), BAT_INVALID_ARGUMENT);
    assert_null(rows);
    assert_int_equal(count, 17);
    remove_file("ring-even.csv");
    remove_file("ring-truth.csv");
}

/// Reference values: Akima1DInterpolator of scipy 1.10, at a quarter of each edge; the closed curve repeated.
static void akima_agrees_with_reference(void **state)
{
    (void)state;
    static const double OPEN[][2] = {{0.96143797979342049, 0.05074379362278339},
                                     {3.333904236127943, 1.8707106846477632},
                                     {4.1206962570618311, 5.103084977033828},
                                     {5.6759009085295027, 4.8587888180076453},
                                     {9.7112680875249318, 0.87560929007714272}};
    static const double CLOSED[][2] = {
        {0.50614516590674141, 0.24055715437832487}, {3.2416918762227556, 1.6798802550249343},
        {4.1206962570618302, 5.103084977033828},    {5.6675433613298312, 4.8305791625926462},
        {9.728088931096627, 0.62371992942306675},   {8.2023698266613909, -2.3861279055836131}};
    double points[12] = {0, 0, 3, 1, 4, 5, 4.5, 5.25, 9, 2, 10, -3};
    bat_space plane = bat_euclidean(2);
    for (int closed = 0; closed < 2; closed++)
    {
        bat_curve coarse = {.space = &plane, .points = points, .count = 6, .closed = closed}, fine;
        check_status(curve_akima(&coarse, 2, &fine, NULL), BAT_OK);
        assert_int_equal(fine.count, closed ? 24 : 21);
        for (size_t i = 0; i < (closed ? 6 : 5); i++)
            for (size_t c = 0; c < 2; c++)
                check_near(fine.points[2 * (4 * i + 1) + c], closed ? CLOSED[i][c] : OPEN[i][c], 2e-14);
        bat_curve_free(&fine);
    }
}

static int remove_root(void **state)
{
    (void)state;
    return rmdir(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circles_have_known_distances),
        cmocka_unit_test(folders_of_several_families),
        cmocka_unit_test(bad_folders_are_refused),
        cmocka_unit_test(akima_agrees_with_reference),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}
