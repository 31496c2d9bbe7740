#include "test_io_helpers.h"

#include "curve/curve_attributes.h"

/// @file
/// Well-known text, by itself and in tables.

static const bat_curve_format WKT = BAT_CURVE_FORMAT_WKT, TABLE = BAT_CURVE_FORMAT_WKT_CSV;

static void assert_has(const char *text, const char *words)
{
    if (strstr(text, words) == NULL)
        fail_msg("no '%s' in %s", words, text);
}

static void every_type_comes_back(void **state)
{
    (void)state;
    static const char text[] = "LINESTRING (0 0,1 1,2 1)\n"
                               "LINESTRING Z (0 0 1,1 1 2,2 1 3)\n"
                               "LINESTRING ZM (0 0 1 5,1 1 2 6)\n"
                               "MULTILINESTRING ((0 0,1 1),(3 3,4 4))\n"
                               "POLYGON ((0 0,10 0,10 10,0 10,0 0),(2 2,2 4,4 4,4 2,2 2))\n"
                               "MULTIPOLYGON (((20 0,21 0,21 1,20 0)),((30 0,31 0,31 1,30 0)))\n"
                               "POINT Z (1 2 3)\n"
                               "MULTIPOINT (1 2,3 4)\n"
                               "GEOMETRYCOLLECTION (POINT (1 2),LINESTRING (0 0,1 1.5))\n"
                               "LINESTRING EMPTY\n"
                               "GEOMETRYCOLLECTION EMPTY\n";
    assert_rewritten(text, WKT, NULL, text);
    assert_rewritten(text, WKT, "plane", text);
    assert_rewritten(
        "  linestringz(0 0 +1,\n1 1 .5e1) ;\r\nMultiPoint((1 2),(3 4))\nMULTIPOLYGON(EMPTY,((0 0,1 0,1 1,0 0)))", WKT, NULL,
        "LINESTRING Z (0 0 1,1 1 5)\nMULTIPOINT (1 2,3 4)\nMULTIPOLYGON (((0 0,1 0,1 1,0 0)))\n");
}

static void systems_and_measures_survive(void **state)
{
    (void)state;
    static const char text[] = "SRID=25833;LINESTRING M (400000 5800000 1,400001 5800001 2)\n"
                               "SRID=25833;LINESTRING (400000 5800000,400001 5800001)\n";
    assert_rewritten(text, WKT, NULL, text);
    static const char degrees[] = "SRID=4326;LINESTRING M (1 2 3,4 5 6)\n";
    assert_rewritten(degrees, WKT, NULL, degrees);
    bat_curve_set set = must_read(text, WKT, NULL);
    assert_string_equal(set.attributes->crs, "EPSG:25833");
    bat_curve_write_options options = bat_curve_write_defaults();
    bat_curve_write_report report;
    char *written;
    size_t size;
    options.format = BAT_CURVE_FORMAT_GEOJSON;
    options.report = &report;
    assert_int_equal(bat_curve_write_memory(&set, &options, &written, &size, NULL), BAT_OK);
    assert_string_equal(report.lost, "measures");
    assert_has(written, "[400000,5800000],");
    assert_has(written, "\"name\":\"urn:ogc:def:crs:EPSG::25833\"");
    free(written);
    bat_curve_set_free(&set);
    set = must_read("LINESTRING (400000 5800000,400001 5800001)", WKT, NULL);
    assert_string_equal(set.space->name, "plane");
    assert_has(bat_curve_set_note(&set, 0), "plane");
    bat_curve_set_free(&set);
}

static void a_table_keeps_its_columns(void **state)
{
    (void)state;
    static const char table[] = "id,name,the_geom,len\n"
                                "1,\"a, \"\"b\"\"\",\"LINESTRING (0 0,1 1,2 1)\",1.10\n"
                                "2,\"two\nlines\",\"POLYGON ((0 0,10 0,10 10,0 10,0 0))\",2.5\n"
                                "3,007,,\n";
    assert_rewritten(table, TABLE, NULL, table);
    bat_curve_set set = must_read(table, BAT_CURVE_FORMAT_CSV, NULL); // by its content
    assert_int_equal(set.attributes->format, TABLE);
    assert_int_equal(bat_curve_set_line(&set, 1, 0), 3);
    char *text = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
    assert_has(text, "\"properties\":{\"id\":1,\"name\":\"a, \\\"b\\\"\",\"len\":\"1.10\"}");
    free(text);
    text = must_write(&set, WKT);
    assert_has(text, "\nGEOMETRYCOLLECTION EMPTY\n");
    free(text);
    bat_curve_set_free(&set);
}

static void other_tables_are_known(void **state)
{
    (void)state;
    assert_rewritten("a;g\n1;LINESTRING (0 0, 1 1)\n", TABLE, NULL, "a,g\n1,\"LINESTRING (0 0,1 1)\"\n");
    assert_rewritten("\"LINESTRING (0 0, 1 1)\",7\n\"LINESTRING (0 0, 2 1)\",8\n", TABLE, NULL,
                     "\"LINESTRING (0 0,1 1)\",7\n\"LINESTRING (0 0,2 1)\",8\n");
    assert_rewritten("WKT\n\"SRID=25833;LINESTRING Z (0 0 1,1 1 2)\"\n", TABLE, NULL,
                     "WKT\n\"SRID=25833;LINESTRING Z (0 0 1,1 1 2)\"\n");
    // A name that begins like a geometry is none.
    bat_curve_set names = must_read("x,y,name\n0,0,Point Z\n1,1,Point Mugu\n", BAT_CURVE_FORMAT_CSV, NULL);
    assert_int_equal(names.attributes->format, BAT_CURVE_FORMAT_CSV);
    bat_curve_set_free(&names);
    bat_curve_set set =
        must_read("{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"id\":\"x\",\"properties\":"
                  "{\"a\":[1,2],\"b\":true},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[0,0],[1,1]]}}]}",
                  BAT_CURVE_FORMAT_GEOJSON, NULL);
    char *text = must_write(&set, TABLE);
    assert_string_equal(text, "WKT,a,b,id\n\"LINESTRING (0 0,1 1)\",\"[1,2]\",true,x\n");
    free(text);
    bat_curve_set_free(&set);
}

/// Well-known binary, as PostGIS and GEOS print it, comes back as PostGIS prints it.
static void binary_geometries_come_back(void **state)
{
    (void)state;
#define BINARY_LINE "01020000000200000000000000000000000000000000000000000000000000F03F000000000000F03F"
    static const char z_bit[] =
        "g,a\n01020000A0E96400000200000000000000000000000000000000000000000000000000F03F000000000000F03F000000000000F03F"
        "0000000000000040,1\n";
    static const char plain[] =
        "a,g\n1," BINARY_LINE "\n2,0106000000010000000103000000010000000400000000000000000000000000000000000000000000000000"
        "F03F0000000000000000000000000000F03F000000000000F03F00000000000000000000000000000000\n"
        "3,0101000000000000000000F87F000000000000F87F\n"
        "4,0107000000020000000101000000000000000000F03F00000000000000400102000000020000000000000000003E400000000000003E40"
        "0000000000003F400000000000003F40\n";
    assert_rewritten(z_bit, TABLE, NULL, z_bit);
    assert_rewritten(plain, TABLE, NULL, plain);
    // Big-endian, with a Z by the standard's thousand.
    assert_rewritten("g\n00000003EA00000002000000000000000000000000000000003FF00000000000003FF00000000000003FF0000000000000"
                     "4000000000000000\n",
                     TABLE, NULL,
                     "g\n01020000800200000000000000000000000000000000000000000000000000F03F000000000000F03F000000000000F03F"
                     "0000000000000040\n");
    bat_curve_set set = must_read(z_bit, BAT_CURVE_FORMAT_CSV, NULL);
    assert_string_equal(set.attributes->crs, "EPSG:25833");
    char *text = must_write(&set, WKT);
    assert_string_equal(text, "SRID=25833;LINESTRING Z (0 0 1,1 1 2)\n");
    free(text);
    bat_curve_set_free(&set);
    assert_bad("g\n" BINARY_LINE "\n01020000000200000000000000000000000000000000000000000000000000F03F\n", TABLE, NULL, 3,
               "column 1: the binary geometry ends too early");
    assert_bad("g\n" BINARY_LINE "00\n", TABLE, NULL, 2, "goes on behind its end");
    assert_bad("g\n0102000000020000000000000000000000000000000000000000000000000000000000000000000000F07F\n" BINARY_LINE
               "\n",
               TABLE, NULL, 2, "goes on behind");
    assert_bad("g\n010200000001000000000000000000F07F0000000000000000\n", TABLE, NULL, 2, "not finite");
    assert_bad("g\n0105000000010000000101000000000000000000F03F0000000000000040\n", TABLE, NULL, 2, "of another type");
}

static void bad_files_are_refused(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *words;
        size_t line;
    } cases[] = {
        {"", "no lines", 0},
        {"POINT (1 2)", "no lines", 0},
        {"POINT (1 2)\nLINESTRING (0 0, 1)", "column 18: a position needs 2 to 4 numbers", 2},
        {"LINESTRING (0 0, 1 1", "column 21: ',' or ')' is expected", 1},
        {"LINESTRING 0 0, 1 1", "'(' is expected", 1},
        {"CIRCULARSTRING (0 0, 1 1, 2 0)", "'CIRCULARSTRING' is no type", 1},
        {"\n(0 0)", "column 1: a geometry is expected", 2},
        {"LINESTRING (0 0 1, 1 1)", "2 numbers where 3", 1},
        {"LINESTRING Z (0 0, 1 1)", "2 numbers where 3", 1},
        {"LINESTRING (0 0 1 2 3, 1 1)", "at most 4", 1},
        {"LINESTRING (0 0, nan 1)", "column 18: a number", 1},
        {"LINESTRING (0 0, 1e999 1)", "a number", 1},
        {"SRID=x;LINESTRING (0 0, 1 1)", "an SRID is", 1},
        {"SRID=1;LINESTRING (0 0, 1 1)\nLINESTRING (0 0, 1 1)", "has the SRID 0", 2},
        {"LINESTRING M (0 0 1,1 1 1)\nLINESTRING Z (0 0 1,1 1 1)", "M alone", 2},
        {"LINESTRING (0 0,1 1)\nPOLYGON ((0 0,1 0,1 1))", "must repeat the first", 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_bad(cases[i].text, WKT, NULL, cases[i].line, cases[i].words);
    assert_bad("a,g\n1,\"LINESTRING (0 0,1 1)\"\n2,\"LINESTRING (0 0,x 1)\"", BAT_CURVE_FORMAT_CSV, NULL, 3,
               "column 20: a number");
    assert_bad("a,g\n1,\"LINESTRING (0 0,1 1)\"\n2", TABLE, NULL, 3, "1 columns where the first row has 2");
    assert_bad("a,a,g\n1,2,\"LINESTRING (0 0,1 1)\"", TABLE, NULL, 1, "two columns have the name 'a'");
    assert_bad("a,g\n1,\"LINESTRING (0 0,1 1) 2\"", TABLE, NULL, 2, "has ended here");
    assert_bad("a,b\n1,2\n", TABLE, NULL, 0, "no column");
    char deep[4096] = "";
    for (size_t i = 0; i < 100; i++)
        memcpy(deep + 20 * i, "GEOMETRYCOLLECTION (", sizeof "GEOMETRYCOLLECTION (");
    assert_bad(deep, WKT, NULL, 1, "nested");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type_comes_back),       cmocka_unit_test(systems_and_measures_survive),
        cmocka_unit_test(a_table_keeps_its_columns),   cmocka_unit_test(other_tables_are_known),
        cmocka_unit_test(binary_geometries_come_back), cmocka_unit_test(bad_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
