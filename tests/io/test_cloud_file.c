// Clouds in files: reading, writing, and errors with their lines.
#include "batten/research/surface_shapes.h"
#include "cloud_helpers.h"

#include <unistd.h>

static char *temporary_path(const char *ending)
{
    static char path[256];
    (void)snprintf(path, sizeof path, "/tmp/batten-cloud-%ld%s", (long)getpid(), ending);
    return path;
}

/// A file with this content; its path is reused.
static char *file_of(const char *text, size_t size, const char *ending)
{
    char *path = temporary_path(ending);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    return path;
}

static bat_cloud must_read_with(const char *text, const char *ending, const bat_cloud_read_options *options)
{
    bat_cloud cloud = {0};
    bat_error error = {0};
    char *path = file_of(text, strlen(text), ending);
    if (bat_cloud_read(path, options, &cloud, &error) != BAT_OK)
        fail_msg("line %zu: %s", error.line, error.text);
    check_status(bat_cloud_check(&cloud, NULL), BAT_OK);
    (void)remove(path);
    return cloud;
}

static bat_cloud must_read(const char *text, const char *ending)
{
    return must_read_with(text, ending, NULL);
}

static void assert_refused_with(const char *text, const char *ending, const bat_cloud_read_options *options,
                                bat_status expected, size_t line, const char *words)
{
    bat_cloud cloud = {.count = 17};
    bat_error error = {0};
    char *path = file_of(text, strlen(text), ending);
    bat_status status = bat_cloud_read(path, options, &cloud, &error);
    assert_int_equal(bat_cloud_read(path, options, &cloud, NULL), status);
    (void)remove(path);
    if (status != expected || error.line != line || strstr(error.text, words) == NULL)
        fail_msg("\"%s\", line %zu, \"%s\" instead of \"%s\", line %zu, \"%s\"", bat_status_name(status), error.line,
                 error.text, bat_status_name(expected), line, words);
    assert_int_equal(cloud.count, 17);
    assert_null(cloud.points);
}

static void assert_refused(const char *text, const char *ending, bat_status expected, size_t line, const char *words)
{
    assert_refused_with(text, ending, NULL, expected, line, words);
}

static void assert_points(bat_cloud *cloud, size_t count, const double *points)
{
    assert_int_equal(cloud->count, count);
    assert_memory_equal(cloud->points, points, 3 * count * sizeof *points);
    bat_cloud_free(cloud);
}

static const double THREE[] = {0.5, -1, 2e3, 1, 2, 3, 4, 5, 6.25};

/// A scanner's place and axes, and a matrix that turns by 90 degrees about z and moves by (10, 20, 30).
#define PTX_FRAME "0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n"

/// Scans of several blocks, points that are missing, and what notes tell.
static void test_scans_of_the_trade(void **state)
{
    (void)state;
    static const double turned[] = {8, 21, 33, 5, 24, 36, 1, 2, 3};
    bat_cloud cloud =
        must_read("2\n1\n" PTX_FRAME "1 2 3 0.5\n4 5 6 0.5 255 0 0\n2\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 "
                  "0 0\n0 0 1 0\n0 0 0 1\n0 0 0 0.5\n1 2 3 0.5\n",
                  ".ptx");
    assert_points(&cloud, 3, turned);
    static const struct
    {
        const char *ending, *text, *note;
    } files[] = {
        {".asc", "//X Y Z Nx Ny Nz\n3\n.5 -1 2e3 0 0 1\n1 2 3 0 0 1\n4 5 6.25 0 0 1\n", "\"X Y Z Nx Ny Nz\""},
        {".pts", "1\n.5 -1 2e3 -7 1 2 3\n2\n1 2 3 -7 1 2 3\n4 5 6.25 -7 1 2 3\n", "4 others"},
        {".txt", "Z X Y\n2e3 .5 -1\nnan nan nan\n3 1 2\n6.25 4 5\n", "1 rows without"},
        {".xyz", "0,5;-1;2000\n1;2;3\n4;5;6,25\n", "decimal commas"},
        {".xyz", "east north up\n.5 -1 2e3\n1 2 3\n4 5 6.25\n", "columns 1, 2 and 3"},
        {".csv", "Nr;Hochwert;Rechtswert;H\u00F6he\n7;-1;.5;2e3\n8;2;1;3\n9;5;4;6.25\n", "columns 3, 2 and 4"},
        {".csv", "Point,Northing (ft),Easting (ft),Elev,Code\n1,-1,.5,2e3,a\n2,2,1,3,b\n3,5,4,6.25,\n",
         "columns 3, 2 and 4"},
        {".csv", "time,h,N,E\n.1,2e3,-1,.5\n.2,3,2,1\n.3,6.25,5,4\n", "columns 4, 3 and 2"},
        {".csv", "lat,lon,x_m,y_m,z\n7,7,.5,-1,2e3\n7,7,1,2,3\n7,7,4,5,6.25\n", "columns 3, 4 and 5"},
        {".txt", "# a scan\n# t x y z\n7 .5 -1 2e3\n7 1 2 3\n7 4 5 6.25\n", "columns 2, 3 and 4"},
        {".xyz", "# scans of one day\n.5 -1 2e3 1\n1 2 3 1\n4 5 6.25 1\n", "1 others"},
        {".csv", "0,.5,-1,2e3\n1,1,2,3\n2,4,5,6.25\n", "counts the points"},
        {".xyz", "3\n1.000 .5 -1 2e3 255\n2.000 1 2 3 255\n3.000 4 5 6.25 255\n", "counts the points"},
        {".csv", "x;y;z\n0,5;-1;2000\n1;2;3\n4;5;6,25\n", "decimal commas"},
        {".xyz", "X,Y,Z,I\n.5,-1,2e3,7\n1,2,3,7\n4,5,6.25,7\n", "\"X,Y,Z,I\""},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    {
        bat_mesh_notes notes = {0};
        const bat_cloud_read_options options = {.notes = &notes};
        cloud = must_read_with(files[i].text, files[i].ending, &options);
        assert_points(&cloud, 3, THREE);
        assert_int_equal(notes.count, 1);
        if (strstr(notes.texts[0], files[i].note) == NULL)
            fail_msg("\"%s\" instead of \"%s\"", notes.texts[0], files[i].note);
        bat_mesh_notes_free(&notes);
    }
    const bat_cloud_read_options strict = {.strict = true};
    assert_refused_with("X Y Z\n3\n1 2 3\nnan nan nan\n1 2 3\n", ".xyz", &strict, BAT_INVALID_POINT, 5, "that of line 3");
}

/// Two triangles in the formats of meshes.
static void test_meshes_of_all_formats(void **state)
{
    (void)state;
    static const char *const files[][2] = {
        {".off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"},
        {".stl",
         "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\nfacet "
         "normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n"},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        for (int by_content = 0; by_content < 2; by_content++)
        {
            bat_cloud cloud = must_read(files[i][1], by_content ? "." : files[i][0]);
            assert_int_equal(cloud.count, 4);
            assert_int_equal(cloud.boundary_count, 4);
            assert_int_equal(cloud.triangle_count, 2);
            bat_cloud_free(&cloud);
        }
}

static void test_every_format_gives_the_points(void **state)
{
    (void)state;
    static const struct
    {
        const char *ending, *text;
    } files[] = {
        {".xyz", ".5 -1 2e3\n1 2 3\n4 5 6.25\n"},
        {".xyz", "\xEF\xBB\xBF# a remark\r\n\r\n\t.5\t-1 2e3 # another\r\n  1 2 3 0.1 0.2 0.3 red\r\n4 5 6.25"},
        {".TXT", "0.5 -1 2000 255 0 0\n1 2 3\n4 5 6.25\n"},
        {".csv", "x,y,z\n.5,-1,2e3\n1,2,3\n4,5,6.25\n"},
        {".csv", "# remark\n\n.5 , -1,2e3\n1,2,3\n\n4,5,6.25"},
        {".csv", "id;Z;\"X\";y;name\r\n1;2e3;.5;-1;a\r\n2;3;1;2;b\r\n3;6.25;4;5;\r\n"},
        {".csv", "east\tnorth\tup\n.5\t-1\t2e3\n1\t2\t3\n4\t5\t6.25\n"},
        {".csv", "x y z\n.5   -1 2e3\n1 2 3\n4 5 6.25\n"},
        {".ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float nx\nproperty double x\nproperty double y\nproperty "
         "double z\nend_header\n0 .5 -1 2e3\n0 1 2 3\n0 4 5 6.25\n"},
        {".ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nelement "
                 "face 0\nproperty list uchar int vertex_indices\nend_header\n.5 -1 2e3\n1 2 3\n4 5 6.25\n"},
        {".obj", "# remark\no cloud\nv .5 -1 2e3\nvn 0 0 1\nv 1 2 3\nv 4 5 6.25 1\np 1 2 3\n"},
        // Without a known ending, the content determines the format.
        {".", ".5 -1 2e3\n1 2 3\n4 5 6.25\n"},
        {".", ".5,-1,2e3\n1,2,3\n4,5,6.25\n"},
        {".", "v .5 -1 2e3\nv 1 2 3\nv 4 5 6.25\n"},
        {".", "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double "
              "z\nend_header\n.5 -1 2e3\n1 2 3\n4 5 6.25\n"},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    {
        bat_cloud cloud = must_read(files[i].text, files[i].ending);
        assert_int_equal(cloud.boundary_count, 0);
        assert_null(cloud.order);
        assert_points(&cloud, 3, THREE);
    }
}

static void test_binary_ply(void **state)
{
    (void)state;
    char bytes[512];
    int head = snprintf(bytes, sizeof bytes,
                        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty "
                        "double y\nproperty double z\nend_header\n");
    memcpy(bytes + head, THREE, sizeof THREE);
    size_t size = (size_t)head + sizeof THREE;
    bat_cloud cloud = {0};
    check_status(bat_cloud_read(file_of(bytes, size, ".ply"), NULL, &cloud, NULL), BAT_OK);
    assert_points(&cloud, 3, THREE);
    for (size_t cut = 0; cut < size; cut++)
        check_status(bat_cloud_read(file_of(bytes, cut, ".ply"), NULL, &cloud, NULL), BAT_BAD_FILE);
    (void)remove(temporary_path(".ply"));
}

static void test_bad_files_are_refused_at_their_line(void **state)
{
    (void)state;
    assert_refused("", ".xyz", BAT_BAD_FILE, 0, "no points");
    assert_refused("# nothing\n\n", ".csv", BAT_BAD_FILE, 0, "no points");
    assert_refused("x,y,z\n", ".csv", BAT_BAD_FILE, 0, "no points");
    assert_refused("# no faces, no vertices\n", ".obj", BAT_BAD_FILE, 0, "no points");
    assert_refused("1 2 3\n\n4 5\n", ".xyz", BAT_BAD_FILE, 3, "point 1 has no z");
    assert_refused("1 2 3\n4 # 5 6\n", ".xyz", BAT_BAD_FILE, 2, "point 1 has no y");
    assert_refused("1 2 3\n4 5 6x\n", ".xyz", BAT_BAD_FILE, 2, "'6x' is not a number");
    assert_refused("1,5 2 3\n", ".xyz", BAT_BAD_FILE, 1, "2 columns");
    assert_refused("a b c\n1 2 3\n", ".xyz", BAT_BAD_FILE, 1, "\"a b c\" do not name x, y and z: rename");
    assert_refused("My scan\n1 2 3\n", ".xyz", BAT_BAD_FILE, 1, "\"My scan\"");
    assert_refused("1\nid,x,y,time\n1,2,3,4\n", ".csv", BAT_BAD_FILE, 2, "\"id,x,y,time\"");
    assert_refused("lat,lon,alt\n1,2,3\n", ".csv", BAT_BAD_FILE, 1, "project longitude and latitude");
    assert_refused("X Y Z\nX Y Z\n1 2 3\n", ".xyz", BAT_BAD_FILE, 2, "'X' is not a number");
    assert_refused("# r\n3\n1 2 3\n4 5 6\n", ".pts", BAT_BAD_FILE, 2, "3 points are announced, but 2 follow");
    assert_refused("1\n1 2 3\n4 5 6\n", ".pts", BAT_BAD_FILE, 1, "1 points are announced, but 2 follow");
    assert_refused("1\n1 2 3\n2\n4 5 6\n", ".pts", BAT_BAD_FILE, 3, "2 points are announced, but 1 follow");
    assert_refused("1 2 3\n2\n4 5 6\n", ".xyz", BAT_BAD_FILE, 2, "point 1 has no y");
    assert_refused("1,5;2;3\n1,5,2;2;3\n", ".xyz", BAT_BAD_FILE, 2, "'1,5,2' is not a number");
    assert_refused("1\t2\t3\n1\t\t2\t3\n", ".xyz", BAT_BAD_FILE, 2, "column 2 is empty");
    assert_refused("//X Y Z\n1 2\n", ".asc", BAT_BAD_FILE, 2, "point 0 has no z");
    assert_refused("2\n", ".ptx", BAT_BAD_FILE, 2, "columns and rows");
    assert_refused("2\n1\n" PTX_FRAME "1 2 3\n", ".ptx", BAT_BAD_FILE, 12, "ends within");
    assert_refused("2\n1\n" PTX_FRAME "1 2 3\n1 2 x\n", ".ptx", BAT_BAD_FILE, 12, "'x' is not a number");
    assert_refused("2\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 a\n", ".ptx", BAT_BAD_FILE, 6, "'a' is not a number");
    const bat_cloud_read_options ground = {.classes = "2"}, wrong = {.classes = "2,"}, large = {.classes = "256"};
    assert_refused_with("1 2 3\n", ".xyz", &ground, BAT_INVALID_ARGUMENT, 0, "LAS");
    assert_refused_with("1 2 3\n", ".xyz", &wrong, BAT_INVALID_ARGUMENT, 0, "classes");
    assert_refused_with("1 2 3\n", ".xyz", &large, BAT_INVALID_ARGUMENT, 0, "classes");
    assert_refused("ASTM-E57 and bytes", ".xyz", BAT_UNSUPPORTED, 0, "E57");
    assert_refused("1 2 1e400\n", ".xyz", BAT_BAD_FILE, 1, "'1e400' is too large");
    assert_refused("1 2 3\n4 nan 6\n", ".xyz", BAT_INVALID_POINT, 2, "point 1 is not finite: 'nan'");
    assert_refused("1 2 -Infinity\n", ".xyz", BAT_INVALID_POINT, 1, "point 0 is not finite");
    assert_refused("0x10 2 3\n", ".xyz", BAT_BAD_FILE, 1, "not a number");
    assert_refused("x,y,z\n1,2,3\n1,2\n", ".csv", BAT_BAD_FILE, 3, "2 columns where the first row has 3");
    assert_refused("1,2,3\n1,2,3,4\n", ".csv", BAT_BAD_FILE, 2, "4 columns where the first row has 3");
    assert_refused("x,y\n1,2\n", ".csv", BAT_BAD_FILE, 1, "a point has 3 coordinates");
    assert_refused("a,x,y,z\n1,2,,4\n", ".csv", BAT_BAD_FILE, 2, "column 3 is empty");
    assert_refused("1,2,3\n4,inf,6\n", ".csv", BAT_INVALID_POINT, 2, "not finite");
    assert_refused("1,2,3\n4,5 6,7\n", ".csv", BAT_BAD_FILE, 2, "'5 6' is not a number");
    assert_refused("v 1 2\n", ".obj", BAT_BAD_FILE, 1, "3 coordinates");
    assert_refused("v 1 2 3\nv 1 nan 3\n", ".obj", BAT_BAD_FILE, 2, "not a number");
    assert_refused("ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\nproperty float "
                   "z\nend_header\n1 2 3\n",
                   ".ply", BAT_TOO_LARGE, 0, "vertices");
    assert_refused("ply\nformat ascii 1.0\nelement vertex 999999999\nproperty float x\nproperty float y\nproperty float "
                   "z\nend_header\n1 2 3\n",
                   ".ply", BAT_BAD_FILE, 0, "too short");
    assert_refused("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nend_header\n1 2\n3 4\n",
                   ".ply", BAT_BAD_FILE, 0, "no property 'z'");
    bat_cloud cloud;
    check_status(bat_cloud_read("/nowhere/at/all.xyz", NULL, &cloud, NULL), BAT_FILE_ACCESS);
    const bat_cloud_read_options unknown = {.format = (bat_cloud_format)11};
    check_status(bat_cloud_read("any.xyz", &unknown, &cloud, NULL), BAT_INVALID_ARGUMENT);
}

static void test_repeated_points_are_counted_or_refused(void **state)
{
    (void)state;
    const bat_cloud_read_options strict = {.strict = true};
    static const struct
    {
        const char *ending, *text;
        size_t line;
        const char *words;
    } files[] = {
        {".xyz", "# r\n1 2 3\n4 5 6\n\n# r\n1.0 2 3\n0 0 0\n-0 0 0\n", 6, "the point repeats that of line 2"},
        {".csv", "x,y,z\n1,2,3\n4,5,6\n\n1,2,3\n0,0,0\n0,0,0\n", 5, "the point repeats that of line 2"},
        {".csv", "1,2,3\n4,5,6\n\n1,2,3\n0,0,0\n0,0,0\n", 4, "the point repeats that of line 1"},
        {".obj", "v 1 2 3\nvn 0 0 1\nv 4 5 6\nv 1 2 3\nv 0 0 0\nv 0 0 0\n", 4, "the point repeats that of line 1"},
        {".ply",
         "ply\nformat ascii 1.0\nelement vertex 5\nproperty int x\nproperty int y\nproperty int z\nend_header\n1 2 3\n4 "
         "5 6\n1 2 3\n0 0 0\n0 0 0\n",
         0, "point 2 repeats point 0"},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    {
        static const double expected[] = {1, 2, 3, 4, 5, 6, 0, 0, 0};
        static const size_t order[] = {0, 1, 3};
        assert_refused_with(files[i].text, files[i].ending, &strict, BAT_INVALID_POINT, files[i].line, files[i].words);
        bat_cloud cloud = must_read(files[i].text, files[i].ending);
        assert_int_equal(cloud.duplicates, 2);
        assert_memory_equal(cloud.order, order, sizeof order);
        assert_points(&cloud, 3, expected);
    }
}

#define SIX "0 0 0\n1 0 0\n1 1 0\n0 1 0\n.5 .25 0\n.75 .5 0\n"

static void test_the_boundary_is_said_in_a_remark(void **state)
{
    (void)state;
    static const struct
    {
        const char *ending, *text;
        size_t boundary;
        bool corners;
    } files[] = {
        {".xyz", "# 5 boundary points first\n" SIX, 5, false},
        {".xyz", "#5 boundary points first, in order around the loop, then 1 interior points\n" SIX, 5, false},
        {".xyz", "# a scan\n\n# 4 boundary points first: whatever\n#corners 0 1 2 3\n" SIX, 4, true},
        {".xyz", "# 4 boundary points first\n# corners 0 1 2 4\n" SIX, 4, false},
        {".xyz", "# 4 boundary points first\n# corners 0 2 1 3\n" SIX, 4, false},
        {".xyz", "# 4 boundary points first\n# corners 0 1 2\n" SIX, 4, false},
        {".xyz", "# 4 boundary points last\n" SIX, 0, false},
        {".xyz", "0 0 7\n# 4 boundary points first\n" SIX, 0, false},
        {".csv", "# 4 boundary points first\nx,y,z\n0,0,0\n1,0,0\n1,1,0\n0,1,0\n.5,.5,0\n", 4, false},
        {".obj", "# 4 boundary points first\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 0\n", 4, false},
        {".ply",
         "ply\nformat ascii 1.0\ncomment 4 boundary points first\ncomment corners 0 1 2 3\nelement vertex 5\nproperty "
         "int x\nproperty int y\nproperty int z\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 2 0\n",
         4, true},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    {
        bat_cloud cloud = must_read(files[i].text, files[i].ending);
        assert_int_equal(cloud.boundary_count, files[i].boundary);
        assert_int_equal(cloud.has_corners, files[i].corners);
        bat_cloud_free(&cloud);
    }
    assert_refused("\n# 7 boundary points first\n" SIX, ".xyz", BAT_BAD_FILE, 2, "only 6");
    assert_refused("# 3 boundary points first\n" SIX, ".xyz", BAT_BAD_FILE, 1, "four corners");
    const bat_cloud_read_options five = {.boundary = 5}, seven = {.boundary = 7}, two = {.boundary = 2};
    bat_cloud cloud = must_read_with("# 4 boundary points first\n# corners 0 1 2 3\n" SIX, ".xyz", &five);
    assert_int_equal(cloud.boundary_count, 5);
    assert_false(cloud.has_corners);
    bat_cloud_free(&cloud);
    assert_refused_with(SIX, ".xyz", &seven, BAT_INVALID_ARGUMENT, 0, "only 6");
    assert_refused_with(SIX, ".xyz", &two, BAT_INVALID_ARGUMENT, 0, "four corners");
    // Points that are dropped from the boundary shorten it.
    cloud = must_read("# 6 boundary points first\n# corners 0 1 2 4\n0 0 0\n1 0 0\n1 0 0\n1 1 0\n0 1 0\n0 .5 0\n.5 .5 0\n",
                      ".xyz");
    assert_int_equal(cloud.boundary_count, 5);
    assert_false(cloud.has_corners);
    bat_cloud_free(&cloud);
}

static void assert_with_boundary(const char *boundary, const char *text, bat_status expected, const char *words,
                                 bat_cloud *cloud)
{
    bat_error error = {0};
    char boundary_path[256];
    (void)snprintf(boundary_path, sizeof boundary_path, "%s", file_of(boundary, strlen(boundary), ".csv"));
    const bat_cloud_read_options options = {.boundary_path = boundary_path, .strict = true};
    bat_status status = bat_cloud_read(file_of(text, strlen(text), ".xyz"), &options, cloud, &error);
    (void)remove(boundary_path);
    (void)remove(temporary_path(".xyz"));
    if (status != expected || (words != NULL && strstr(error.text, words) == NULL))
        fail_msg("\"%s\", \"%s\" instead of \"%s\"", bat_status_name(status), error.text, words);
}

static void test_the_boundary_in_a_file_of_its_own(void **state)
{
    (void)state;
    static const double expected[] = {0, 1, 0, 1, 1, 0, 1, 0, 0, 0, 0, 0, .5, .25, 0, .75, .5, 0};
    static const size_t order[] = {0, 1, 2, 3, 8, 9};
    bat_cloud cloud = {0}, unused = {0};
    assert_with_boundary("0,1,0\n1,1,0\n1,0,0\n0,0,0\n", "# 5 boundary points first\n" SIX, BAT_OK, NULL, &cloud);
    assert_int_equal(cloud.boundary_count, 4);
    assert_memory_equal(cloud.order, order, sizeof order);
    assert_points(&cloud, 6, expected);
    // The main file may contain only other points.
    assert_with_boundary("0,1,0\n1,1,0\n1,0,0\n0,0,0\n", ".5 .25 0\n.75 .5 0\n", BAT_OK, NULL, &cloud);
    assert_null(cloud.order);
    assert_points(&cloud, 6, expected);
    assert_with_boundary("0,1,0\n1,1,0\n", SIX, BAT_BAD_FILE, "the boundary's file: 2 points", &unused);
    assert_with_boundary("0,1,0\n1,1,0\n1,0,0\n0,0,0\n1,1,0\n", SIX, BAT_INVALID_POINT,
                         "line 5 of the boundary's file: the point", &unused);
    assert_with_boundary("0,1,0\n1,a,0\n1,0,0\n0,0,0\n1,1,0\n", SIX, BAT_BAD_FILE, "line 2 of the boundary's file: 'a'",
                         &unused);
    assert_with_boundary("0,1,0\n1,1,0\n1,0,0\n0,0,0\n", "5 5 5\n5 5 5\n", BAT_INVALID_POINT, "that of line 1", &unused);
    const bat_cloud_read_options both = {.boundary = 4, .boundary_path = "b.xyz"};
    check_status(bat_cloud_read("a.xyz", &both, &unused, NULL), BAT_INVALID_ARGUMENT);
    const bat_cloud_read_options missing = {.boundary_path = "/nowhere/b.xyz"};
    assert_refused_with(SIX, ".xyz", &missing, BAT_FILE_ACCESS, 0, "the boundary's file: cannot open");
}

#define SQUARE "v .5 .5 .25\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static void test_files_with_faces_are_meshes(void **state)
{
    (void)state;
    bat_cloud cloud = must_read(SQUARE "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 2\n", ".obj");
    static const uint32_t triangles[] = {4, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0};
    assert_int_equal(cloud.boundary_count, 4);
    assert_int_equal(cloud.order[0], 1);
    assert_memory_equal(cloud.triangles, triangles, sizeof triangles);
    bat_cloud_free(&cloud);
    cloud =
        must_read("ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty int y\nproperty int z\nelement face "
                  "1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
                  ".ply");
    assert_int_equal(cloud.triangle_count, 2);
    assert_int_equal(cloud.boundary_count, 4);
    bat_cloud_free(&cloud);
    assert_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", ".obj", BAT_UNSUPPORTED, 0,
                   "closed");
    assert_refused(SQUARE "f 1 2 9\n", ".obj", BAT_BAD_FILE, 6, "names vertex 8");
    const bat_cloud_read_options five = {.boundary = 4}, strict = {.strict = true};
    assert_refused_with(SQUARE "f 1 2 3\n", ".obj", &five, BAT_INVALID_ARGUMENT, 0, "its own boundary");
    // A mesh with unshared vertices is welded.
    static const char soup[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\n";
    assert_refused_with(soup, ".obj", &strict, BAT_UNSUPPORTED, 0, "several");
    cloud = must_read(soup, ".obj");
    assert_int_equal(cloud.duplicates, 2);
    assert_int_equal(cloud.count, 4);
    assert_int_equal(cloud.boundary_count, 4);
    bat_cloud_free(&cloud);
}

/// A cloud with numbers of any magnitude, a boundary and corners.
static bat_cloud any_cloud(size_t count, size_t boundary)
{
    bat_random random = bat_random_seed(count);
    bat_cloud cloud = {.points = malloc((count + 1) * 3 * sizeof *cloud.points), .count = count};
    assert_non_null(cloud.points);
    for (size_t i = 0; i < count; i++)
    {
        double *point = cloud.points + 3 * i;
        point[0] = bat_random_normal(&random);
        point[1] = ldexp(bat_random_normal(&random), (int)(i % 90) - 45);
        point[2] = (double)i;
    }
    cloud.boundary_count = boundary;
    cloud.has_corners = boundary > 0;
    for (size_t k = 0; k < 4 && boundary > 0; k++)
        cloud.corners[k] = k * (boundary / 4) + (k == 3);
    return cloud;
}

static void assert_same_cloud(const bat_cloud *a, const bat_cloud *b)
{
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->boundary_count, b->boundary_count);
    assert_int_equal(a->has_corners, b->has_corners);
    assert_memory_equal(a->points, b->points, 3 * a->count * sizeof *a->points);
    if (a->has_corners)
        assert_memory_equal(a->corners, b->corners, sizeof a->corners);
}

static void test_what_is_written_is_read(void **state)
{
    (void)state;
    static const char *const endings[] = {".xyz", ".csv", ".ply", ".obj"};
    for (size_t i = 0; i < 4; i++)
        for (size_t boundary = 0; boundary <= 40; boundary += 20)
        {
            bat_cloud cloud = any_cloud(boundary == 40 ? 40000 : 100, boundary), back = {0};
            char *path = temporary_path(endings[i]);
            check_status(bat_cloud_write(path, &cloud, NULL), BAT_OK);
            check_status(bat_cloud_read(path, NULL, &back, NULL), BAT_OK);
            (void)remove(path);
            assert_same_cloud(&cloud, &back);
            bat_cloud_free(&back);
            bat_cloud_free(&cloud);
        }
}

static void test_triangles_go_through_files_that_have_them(void **state)
{
    (void)state;
    bat_cloud cloud = must_read(SQUARE "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 2\n", ".obj");
    cloud.has_corners = true;
    for (size_t k = 0; k < 4; k++)
        cloud.corners[k] = k;
    static const char *const endings[] = {".ply", ".obj"};
    for (size_t i = 0; i < 2; i++)
    {
        bat_cloud back = {0};
        char *path = temporary_path(endings[i]);
        check_status(bat_cloud_write(path, &cloud, NULL), BAT_OK);
        check_status(bat_cloud_read(path, NULL, &back, NULL), BAT_OK);
        (void)remove(path);
        assert_same_cloud(&cloud, &back);
        assert_int_equal(back.triangle_count, cloud.triangle_count);
        assert_memory_equal(back.triangles, cloud.triangles, 3 * cloud.triangle_count * sizeof *cloud.triangles);
        bat_cloud_free(&back);
    }
    bat_cloud_free(&cloud);
}

static void test_texts_that_are_written(void **state)
{
    (void)state;
    bat_cloud cloud = must_read("# 4 boundary points first\n# corners 0 1 2 3\n" SIX, ".xyz");
    static const char *const texts[][2] = {
        {".xyz",
         "# 4 boundary points first, in order around the loop, then 2 interior points\n# corners 0 1 2 3\n0 0 0\n1 0 0\n1 1 "
         "0\n0 1 0\n0.5 0.25 0\n0.75 0.5 0\n"},
        {".csv", "# 4 boundary points first, in order around the loop, then 2 interior points\n# corners 0 1 2 "
                 "3\nx,y,z\n0,0,0\n1,0,0\n1,1,0\n0,1,0\n0.5,0.25,0\n0.75,0.5,0\n"}};
    for (size_t i = 0; i < 2; i++)
    {
        char text[512] = {0};
        char *path = temporary_path(texts[i][0]);
        check_status(bat_cloud_write(path, &cloud, NULL), BAT_OK);
        FILE *file = fopen(path, "rb");
        assert_non_null(file);
        assert_true(fread(text, 1, sizeof text - 1, file) > 0);
        (void)fclose(file);
        (void)remove(path);
        assert_string_equal(text, texts[i][1]);
    }
    bat_error error;
    check_status(bat_cloud_write("/tmp/batten-cloud.step", &cloud, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_cloud_write("/nowhere/at/all.xyz", &cloud, &error), BAT_FILE_ACCESS);
    cloud.points[0] = NAN;
    check_status(bat_cloud_write(temporary_path(".xyz"), &cloud, &error), BAT_INVALID_POINT);
    assert_null(fopen(temporary_path(".xyz"), "rb"));
    bat_cloud_free(&cloud);
}

static void test_scans(void **state)
{
    (void)state;
    static const struct
    {
        const char *name;
        size_t boundary, interior;
    } scans[] = {{"face-9283", 90, 9193},       {"nefertiti-532", 92, 440},    {"nefertiti-1043", 127, 916},
                 {"nefertiti-2062", 167, 1895}, {"nefertiti-3253", 181, 3072}, {"nefertiti-6024", 181, 5843},
                 {"nefertiti-8818", 181, 8637}};
    for (size_t i = 0; i < sizeof scans / sizeof *scans; i++)
    {
        char path[1024];
        bat_cloud cloud = {0};
        bat_error error = {0};
        (void)snprintf(path, sizeof path, SHARED_DATA "/data/clouds/%s.xyz", scans[i].name);
        bat_status status = bat_cloud_read(path, NULL, &cloud, &error);
        if (status == BAT_FILE_ACCESS)
        {
            print_message("%s is not here: skipped\n", path);
            skip();
        }
        check_status(status, BAT_OK);
        assert_int_equal(cloud.boundary_count, scans[i].boundary);
        assert_int_equal(cloud.count, scans[i].boundary + scans[i].interior);
        check_status(bat_cloud_check(&cloud, NULL), BAT_OK);
        bat_cloud_free(&cloud);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_format_gives_the_points),
        cmocka_unit_test(test_binary_ply),
        cmocka_unit_test(test_bad_files_are_refused_at_their_line),
        cmocka_unit_test(test_repeated_points_are_counted_or_refused),
        cmocka_unit_test(test_the_boundary_is_said_in_a_remark),
        cmocka_unit_test(test_the_boundary_in_a_file_of_its_own),
        cmocka_unit_test(test_files_with_faces_are_meshes),
        cmocka_unit_test(test_what_is_written_is_read),
        cmocka_unit_test(test_triangles_go_through_files_that_have_them),
        cmocka_unit_test(test_texts_that_are_written),
        cmocka_unit_test(test_scans),
        cmocka_unit_test(test_scans_of_the_trade),
        cmocka_unit_test(test_meshes_of_all_formats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
