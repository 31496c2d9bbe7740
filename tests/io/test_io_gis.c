#define _GNU_SOURCE // mkdtemp()

#include "folder_helpers.h"
#include "test_io_helpers.h"

#include "batten/curve_file.h"
#include "curve/curve_attributes.h"
#include "io/gis/gis.h"

#if BATTEN_HAS_GDAL
#include "io/gis/gdal.h"
#endif

#include <jansson.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

/// @file
/// Formats of GDAL. Every test has a folder of its own, which is the current one meanwhile.

/// Reading fails with this status and a text that contains these words.
static void refuse(const char *path, const bat_curve_read_options *options, bat_status status, const char *words)
{
    bat_curve_set set = {0};
    bat_error error = {0};
    assert_int_equal(bat_curve_read(path, options, &set, &error), status);
    if (strstr(error_words(&error), words) == NULL)
        fail_msg("message '%s' instead of one with '%s'", error_words(&error), words);
    assert_null(set.curves);
    assert_int_equal(bat_curve_read(path, options, &set, NULL), status);
}

static const char LINES[] =
    "{\"type\":\"FeatureCollection\",\"name\":\"ways\",\"features\":[\n"
    "{\"type\":\"Feature\",\"properties\":{\"name\":\"Stra\\u00dfe\",\"lanes\":2,\"length\":1234.5678},\"geometry\":"
    "{\"type\":\"LineString\",\"coordinates\":[[13.1234567891,52.5,30.5],[13.25,52.625,31],[13.5,52.5,33.25]]}},\n"
    "{\"type\":\"Feature\",\"properties\":{\"name\":\"B\",\"lanes\":null,\"length\":-0.5},\"geometry\":"
    "{\"type\":\"LineString\",\"coordinates\":[[-70,-33.25,1],[-70.5,-33.5,2]]}}\n]}\n";

#if BATTEN_HAS_GDAL

static const char POLYGONS[] =
    "{\"type\":\"FeatureCollection\",\"features\":[\n"
    "{\"type\":\"Feature\",\"properties\":{\"name\":\"outer\",\"big\":12345678901,\"flag\":true},\"geometry\":"
    "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[10,0],[10,10],[0,10],[0,0]],[[2,2],[2,4],[4,4],[4,2],[2,2]]]}},\n"
    "{\"type\":\"Feature\",\"properties\":{\"name\":\"empty\",\"big\":1,\"flag\":false},\"geometry\":null},\n"
    "{\"type\":\"Feature\",\"properties\":{\"name\":\"two\",\"big\":2,\"flag\":false},\"geometry\":"
    "{\"type\":\"MultiPolygon\",\"coordinates\":[[[[20,0],[21,0],[21,1],[20,0]]],[[[30,0],[31,0],[31,1],[30,0]]]]}}\n]}\n";

static void must_write_file(const char *path, const bat_curve_set *set)
{
    bat_error error = {0};
    if (bat_curve_write(path, set, NULL, &error) != BAT_OK)
        fail_msg("%s: %s", path, error.text);
}

static bat_curve_set must_read_file(const char *path, const bat_curve_read_options *options)
{
    bat_curve_set set = {0};
    bat_error error = {0};
    if (bat_curve_read(path, options, &set, &error) != BAT_OK)
        fail_msg("%s: %s", path, error.text);
    return set;
}

static void put_geojson(const char *path, const char *text)
{
    bat_curve_set set = must_read(text, BAT_CURVE_FORMAT_GEOJSON, NULL);
    must_write_file(path, &set);
    bat_curve_set_free(&set);
}

/// The file as GeoJSON.
static char *as_geojson(const char *path, const char *layer)
{
    bat_curve_read_options options = bat_curve_read_defaults();
    options.layer = layer;
    bat_curve_set set = must_read_file(path, &options);
    char *text = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
    bat_curve_set_free(&set);
    return text;
}

static json_t *features_of(const char *text)
{
    json_t *tree = json_loads(text, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(tree);
    json_t *features = json_incref(json_object_get(tree, "features"));
    json_decref(tree);
    return features;
}

/// Single lines and polygons are equal to those in a collection of one.
static json_t *parts_of(json_t *geometry)
{
    json_t *coordinates = json_object_get(geometry, "coordinates");
    const char *type = json_string_value(json_object_get(geometry, "type"));
    return type == NULL                     ? json_null()
           : strncmp(type, "Multi", 5) == 0 ? json_incref(coordinates)
                                            : json_pack("[O]", coordinates);
}

/// Both hold the same features: geometries are equal, and so are the properties of the expected ones. Formats may add
/// others, and may leave out what is null.
static void assert_same_features(const char *expected_text, const char *text, const char *path)
{
    json_t *expected = features_of(expected_text), *found = features_of(text);
    assert_int_equal(json_array_size(found), json_array_size(expected));
    for (size_t i = 0; i < json_array_size(expected); i++)
    {
        json_t *a = json_array_get(expected, i), *b = json_array_get(found, i), *value;
        json_t *parts_a = parts_of(json_object_get(a, "geometry")), *parts_b = parts_of(json_object_get(b, "geometry"));
        if (!json_equal(parts_a, parts_b))
            fail_msg("%s: feature %zu has another geometry in %s", path, i, text);
        const char *name;
        json_object_foreach(json_object_get(a, "properties"), name, value)
        {
            json_t *properties = json_object_get(b, "properties"), *other = json_object_get(properties, name);
            if (strstr(path, ".kml") != NULL && other == NULL)
                other = json_object_get(properties, "Name"); // of KML itself
            if (strstr(path, ".kml") != NULL && !json_equal(value, other))
                continue; // KML has no large integers and no booleans
            if (!json_equal(value, other) && !(json_is_null(value) && other == NULL))
                fail_msg("%s: feature %zu has another '%s' in %s", path, i, name, text);
        }
        json_decref(parts_a);
        json_decref(parts_b);
    }
    json_decref(expected);
    json_decref(found);
}

/// Write features in a format, read them, write them again, and read them again.
static void round_trip(const char *text, const char *ending)
{
    char first[32], second[32];
    (void)snprintf(first, sizeof first, "first%s", ending);
    (void)snprintf(second, sizeof second, "second%s", ending);
    put_geojson(first, text);
    char *once = as_geojson(first, NULL);
    assert_same_features(text, once, first);
    bat_curve_set set = must_read_file(first, NULL);
    must_write_file(second, &set);
    bat_curve_set_free(&set);
    char *twice = as_geojson(second, NULL);
    assert_same_features(once, twice, second);
    assert_same_features(text, twice, second);
    free(once);
    free(twice);
}

static void every_format_keeps_lines_and_their_values(void **state)
{
    (void)state;
    static const char *const endings[] = {".gpkg", ".shp", ".kml", ".fgb", ".geojsonl", ".shp.zip", ".geojson.gz"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        round_trip(LINES, endings[i]);
}

static void every_format_keeps_polygons_and_empty_features(void **state)
{
    (void)state;
    static const char *const endings[] = {".gpkg", ".kml", ".geojsonl", ".GeoJSON.GZ"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        round_trip(POLYGONS, endings[i]);
}

static void a_layer_keeps_its_name_and_its_numbers(void **state)
{
    (void)state;
    put_geojson("a.gpkg", LINES);
    char *text = as_geojson("a.gpkg", "ways");
    assert_non_null(strstr(text, "\"name\":\"ways\""));
    assert_non_null(strstr(text, "\"id\":2"));
    free(text);
    put_geojson("b.gpkg", POLYGONS); // the layer of a file without a name has that of the file
    free(as_geojson("b.gpkg", "b"));
}

/// Make a file with layers by GDAL itself. Each gets one line with altitudes and measures, or without.
typedef struct made_layer
{
    const char *name, *system;
    OGRwkbGeometryType type;
} made_layer;

static void make_layers(const char *path, const char *driver, const made_layer *layers, size_t count)
{
    gdal_messages messages;
    assert_int_equal(gdal_begin(&messages, NULL), BAT_OK);
    GDALDatasetH dataset = gdal.GDALCreate(gdal.GDALGetDriverByName(driver), path, 0, 0, 0, GDT_Unknown, NULL);
    assert_non_null(dataset);
    for (size_t i = 0; i < count; i++)
    {
        OGRSpatialReferenceH system = layers[i].system != NULL ? system_by_name(layers[i].system) : NULL;
        OGRLayerH layer = gdal.GDALDatasetCreateLayer(dataset, layers[i].name, system, layers[i].type, NULL);
        static const struct
        {
            const char *name;
            OGRFieldType type;
            OGRFieldSubType subtype;
            const char *value;
        } fields[] = {
            {"day", OFTDate, OFSTNone, "2024/02/29"}, {"moment", OFTDateTime, OFSTNone, "2024/02/29 12:34:56.789+00"},
            {"small", OFTInteger, OFSTInt16, "-12"},  {"large", OFTInteger64, OFSTNone, "9007199254740993"},
            {"number", OFTReal, OFSTNone, "0.1"},     {"nothing", OFTReal, OFSTNone, NULL},
            {"yes", OFTInteger, OFSTBoolean, "1"}};
        enum
        {
            FIELDS = sizeof fields / sizeof *fields
        };
        for (size_t k = 0; k < FIELDS; k++)
        {
            OGRFieldDefnH field = gdal.OGR_Fld_Create(fields[k].name, fields[k].type);
            gdal.OGR_Fld_SetSubType(field, fields[k].subtype);
            assert_int_equal(gdal.OGR_L_CreateField(layer, field, 1), OGRERR_NONE);
            gdal.OGR_Fld_Destroy(field);
        }
        OGRFeatureH feature = gdal.OGR_F_Create(gdal.OGR_L_GetLayerDefn(layer));
        for (int k = 0; k < FIELDS; k++)
            if (fields[k].value != NULL)
                gdal.OGR_F_SetFieldString(feature, k, fields[k].value);
            else
                gdal.OGR_F_SetFieldNull(feature, k);
        OGRGeometryH line = gdal.OGR_G_CreateGeometry(layers[i].type);
        bool deep = gdal.OGR_GT_HasZ(layers[i].type) != 0, measured = gdal.OGR_GT_HasM(layers[i].type) != 0;
        for (int k = 0; k < 3; k++)
        {
            double x = layers[i].system != NULL && strcmp(layers[i].system, "EPSG:25833") == 0 ? 4e5 : 10;
            double y = x > 100 ? 5.8e6 : 50;
            if (deep && measured)
                gdal.OGR_G_AddPointZM(line, x + k, y + 0.1 * k * k, 100 + k, 1000 + 10 * k);
            else if (measured)
                gdal.OGR_G_AddPointM(line, x + k, y + 0.1 * k * k, 1000 + 10 * k);
            else if (deep)
                gdal.OGR_G_AddPoint(line, x + k, y + 0.1 * k * k, 100 + k);
            else
                gdal.OGR_G_AddPoint_2D(line, x + k, y + 0.1 * k * k);
        }
        assert_int_equal(gdal.OGR_F_SetGeometryDirectly(feature, line), OGRERR_NONE);
        assert_int_equal(gdal.OGR_L_CreateFeature(layer, feature), OGRERR_NONE);
        gdal.OGR_F_Destroy(feature);
        if (system != NULL)
            gdal.OSRDestroySpatialReference(system);
    }
    gdal.GDALClose(dataset);
    assert_int_equal(messages.failures, 0);
    gdal_end();
}

/// Whether two files have layers of one name, geometry type, system and fields.
static void assert_same_layers(const char *path_a, const char *path_b)
{
    gdal_messages messages;
    assert_int_equal(gdal_begin(&messages, NULL), BAT_OK);
    GDALDatasetH a = gdal.GDALOpenEx(path_a, GDAL_OF_VECTOR, NULL, NULL, NULL);
    GDALDatasetH b = gdal.GDALOpenEx(path_b, GDAL_OF_VECTOR, NULL, NULL, NULL);
    OGRLayerH layer_a = gdal.GDALDatasetGetLayer(a, 0), layer_b = gdal.GDALDatasetGetLayer(b, 0);
    assert_string_equal(gdal.OGR_L_GetName(layer_a), gdal.OGR_L_GetName(layer_b));
    assert_int_equal(gdal.OGR_L_GetGeomType(layer_a), gdal.OGR_L_GetGeomType(layer_b));
    assert_true(gdal.OSRIsSame(gdal.OGR_L_GetSpatialRef(layer_a), gdal.OGR_L_GetSpatialRef(layer_b)));
    OGRFeatureDefnH fields_a = gdal.OGR_L_GetLayerDefn(layer_a), fields_b = gdal.OGR_L_GetLayerDefn(layer_b);
    assert_int_equal(gdal.OGR_FD_GetFieldCount(fields_a), gdal.OGR_FD_GetFieldCount(fields_b));
    for (int i = 0; i < gdal.OGR_FD_GetFieldCount(fields_a); i++)
    {
        OGRFieldDefnH field_a = gdal.OGR_FD_GetFieldDefn(fields_a, i), field_b = gdal.OGR_FD_GetFieldDefn(fields_b, i);
        assert_string_equal(gdal.OGR_Fld_GetNameRef(field_a), gdal.OGR_Fld_GetNameRef(field_b));
        assert_int_equal(gdal.OGR_Fld_GetType(field_a), gdal.OGR_Fld_GetType(field_b));
        assert_int_equal(gdal.OGR_Fld_GetSubType(field_a), gdal.OGR_Fld_GetSubType(field_b));
    }
    gdal.GDALClose(a);
    gdal.GDALClose(b);
    gdal_end();
}

static void types_of_fields_and_of_geometries_survive(void **state)
{
    (void)state;
    static const OGRwkbGeometryType types[] = {wkbLineString, wkbLineString25D, wkbLineStringM, wkbLineStringZM};
    static const char *const numbers[] = {"[11,50.1]", "[11,50.1,101]", "[11,50.1]", "[11,50.1,101,1010]"};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
    {
        (void)count_files(true);
        make_layers("a.gpkg", "GPKG", &(made_layer){"roads", "EPSG:4326", types[i]}, 1);
        bat_curve_set set = must_read_file("a.gpkg", NULL);
        assert_int_equal(set.count, 1);
        size_t channels = i == 3 ? 2 : i == 0 ? 0 : 1;
        assert_int_equal(set.curves[0].channel_count, channels);
        if (i >= 2)
            assert_true(set.curves[0].channels[2 * channels - 1] == 1010);
        must_write_file("b.gpkg", &set);
        bat_curve_set_free(&set);
        assert_same_layers("a.gpkg", "b.gpkg");
        char *first = as_geojson("a.gpkg", NULL), *second = as_geojson("b.gpkg", NULL);
        assert_string_equal(first, second);
        assert_non_null(strstr(first, numbers[i]));
        assert_non_null(strstr(first,
                               "\"id\":1,\"properties\":{\"day\":\"2024-02-29\",\"moment\":\"2024-02-29T12:34:56.789Z\","
                               "\"small\":-12,\"large\":9007199254740993,\"number\":0.1,\"nothing\":null,"
                               "\"yes\":true}"));
        free(first);
        free(second);
        set = must_read_file("b.gpkg", NULL);
        if (i >= 2)
            assert_true(set.curves[0].channels[3 * channels - 1] == 1020);
        bat_curve_set_free(&set);
    }
}

static void a_file_with_several_layers_needs_a_choice(void **state)
{
    (void)state;
    const made_layer layers[] = {
        {"roads", "EPSG:4326", wkbLineString}, {"stops", "EPSG:4326", wkbPoint}, {"rails", "EPSG:4326", wkbLineString}};
    bat_curve_read_options options = bat_curve_read_defaults();
    make_layers("a.gpkg", "GPKG", layers, 3);
    refuse("a.gpkg", NULL, BAT_INVALID_ARGUMENT, "there are 2 layers: roads, rails; layer chooses one");
    options.layer = "trams";
    refuse("a.gpkg", &options, BAT_INVALID_ARGUMENT, "there is no layer 'trams'; there are roads, stops, rails");
    options.layer = "stops";
    refuse("a.gpkg", &options, BAT_BAD_FILE, "there are no lines or polygons");
    options.layer = "rails";
    bat_curve_set set = must_read_file("a.gpkg", &options);
    bat_curve_set_free(&set);
    (void)count_files(true);
    make_layers("a.gpkg", "GPKG", layers, 2);
    set = must_read_file("a.gpkg", NULL);
    assert_non_null(strstr(bat_curve_set_note(&set, 0), "'roads', the only one of 2"));
    bat_curve_set_free(&set);
}

static void projected_data_stay_in_their_plane(void **state)
{
    (void)state;
    make_layers("a.gpkg", "GPKG", &(made_layer){"roads", "EPSG:25833", wkbLineString25D}, 1);
    bat_curve_set set = must_read_file("a.gpkg", NULL);
    assert_string_equal(set.space->name, "plane");
    assert_string_equal(set.attributes->crs, "EPSG:25833");
    assert_true(set.curves[0].points[2] == 400001);
    must_write_file("b.gpkg", &set);
    must_write_file("b.shp", &set);
    must_write_file("b.fgb", &set);
    must_write_file("b.kml", &set);
    assert_same_layers("a.gpkg", "b.gpkg");
    bat_curve_set_free(&set);
    static const char *const others[] = {"b.shp", "b.fgb"};
    for (size_t i = 0; i < 2; i++)
    {
        set = must_read_file(others[i], NULL);
        assert_string_equal(set.attributes->crs, "EPSG:25833");
        assert_true(set.curves[0].points[2] == 400001);
        bat_curve_set_free(&set);
    }
    set = must_read_file("b.kml", NULL); // longitude and latitude alone
    assert_string_equal(set.space->name, "sphere");
    assert_true(fabs(set.curves[0].points[2] - sin(52.34 * 0.017453292519943295)) < 1e-4);
    bat_curve_set_free(&set);
    bat_curve_read_options options = bat_curve_read_defaults();
    options.space = "sphere";
    refuse("a.gpkg", &options, BAT_UNSUPPORTED, "; on_sphere transforms them");
}

static void projected_data_go_to_the_sphere_and_back(void **state)
{
    (void)state;
    make_layers("a.gpkg", "GPKG", &(made_layer){"roads", "EPSG:25833", wkbLineString25D}, 1);
    bat_curve_read_options options = bat_curve_read_defaults();
    options.on_sphere = true;
    bat_curve_set set = must_read_file("a.gpkg", &options), back;
    assert_string_equal(set.space->name, "sphere");
    // One metre between the points, on an Earth of 6371 km; the scale of the projection there is 0.9997.
    const double *p = set.curves[0].points;
    double step = sqrt((p[3] - p[0]) * (p[3] - p[0]) + (p[4] - p[1]) * (p[4] - p[1]) + (p[5] - p[2]) * (p[5] - p[2]));
    assert_true(fabs(step * 6371e3 - 1.005) < 5e-3);
    must_write_file("b.gpkg", &set);
    bat_curve_set_free(&set);
    assert_same_layers("a.gpkg", "b.gpkg");
    set = must_read_file("a.gpkg", NULL);
    back = must_read_file("b.gpkg", NULL);
    for (size_t i = 0; i < 6; i++)
        assert_true(fabs(set.curves[0].points[i] - back.curves[0].points[i]) < 1e-6);
    bat_curve_set_free(&set);
    bat_curve_set_free(&back);
    put("c.csv", "x,y\n0,0\n1,1\n");
    refuse("c.csv", &options, BAT_INVALID_ARGUMENT, "no coordinate system");
}

static void files_without_a_system_are_guessed(void **state)
{
    (void)state;
    make_layers("a.shp", "ESRI Shapefile", &(made_layer){"a", NULL, wkbLineString}, 1);
    bat_curve_set set = must_read_file("a.shp", NULL);
    assert_string_equal(set.space->name, "sphere");
    assert_non_null(strstr(bat_curve_set_note(&set, 0), "taken as degrees"));
    bat_curve_set_free(&set);
    make_layers("b.shp", "ESRI Shapefile", &(made_layer){"b", "EPSG:25833", wkbLineString}, 1);
    assert_int_equal(unlink("b.prj"), 0);
    set = must_read_file("b.shp", NULL);
    assert_string_equal(set.space->name, "plane");
    assert_null(set.attributes->crs);
    assert_non_null(strstr(bat_curve_set_note(&set, 0), "those of a plane"));
    bat_curve_set_free(&set);
    bat_curve_read_options options = bat_curve_read_defaults();
    options.space = "plane";
    set = must_read_file("a.shp", &options);
    assert_string_equal(set.space->name, "plane");
    assert_null(bat_curve_set_note(&set, 0));
    bat_curve_set_free(&set);
}

/// The coordinates of a drawing are lengths, even where they could be degrees.
static void drawings_are_in_the_plane(void **state)
{
    (void)state;
    put("a.csv", "x,y\n0,0\n10,5\n20,-5\n");
    bat_curve_set set = must_read_file("a.csv", NULL);
    must_write_file("a.dxf", &set);
    bat_curve_set back = must_read_file("a.dxf", NULL);
    assert_string_equal(back.space->name, "plane");
    assert_non_null(strstr(bat_curve_set_note(&back, 0), "those of a plane"));
    assert_int_equal(back.count, 1);
    assert_int_equal(back.curves[0].count, 3);
    assert_memory_equal(back.curves[0].points, set.curves[0].points, 6 * sizeof(double));
    bat_curve_set_free(&back);
    bat_curve_set_free(&set);
}

static void points_of_the_globe_have_the_written_decimals(void **state)
{
    (void)state;
    bat_curve_set set = must_read("{\"type\":\"LineString\",\"coordinates\":[[0.1,0.2],[12.34567890123,-45.6]]}",
                                  BAT_CURVE_FORMAT_GEOJSON, NULL);
    bat_curve_write_options options = bat_curve_write_defaults();
    options.precision = 4;
    assert_int_equal(bat_curve_write("a.gpkg", &set, &options, NULL), BAT_OK);
    bat_curve_set_free(&set);
    bat_curve_read_options plane = bat_curve_read_defaults();
    plane.space = "plane";
    set = must_read_file("a.gpkg", &plane);
    static const double expected[] = {0.1, 0.2, 12.3457, -45.6};
    for (size_t i = 0; i < 4; i++)
        assert_true(set.curves[0].points[i] == expected[i]);
    bat_curve_set_free(&set);
}

static void points_pass_through(void **state)
{
    (void)state;
    round_trip("{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{\"n\":1},\"geometry\":"
               "{\"type\":\"Point\",\"coordinates\":[1.123456789012345,2]}},{\"type\":\"Feature\",\"properties\":{\"n\":2},"
               "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[0,1],[2,3]]}}]}",
               ".gpkg");
}

static void a_shapefile_is_replaced_as_a_whole(void **state)
{
    (void)state;
    put_geojson("a.shp", LINES);
    assert_int_equal(count_files(false), 5); // .shp .shx .dbf .prj .cpg
    put("a.qix", "an index of the old file");
    bat_curve_set mixed =
        must_read("{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{},"
                  "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[0,1],[2,3]]}},{\"type\":\"Feature\""
                  ",\"properties\":{},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
                  "[[[0,0],[1,0],[1,1],[0,0]]]}}]}",
                  BAT_CURVE_FORMAT_GEOJSON, NULL);
    bat_error error;
    assert_int_equal(bat_curve_write("a.shp", &mixed, NULL, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "lines or polygons"));
    bat_curve_set_free(&mixed);
    assert_int_equal(count_files(false), 6);
    char *text = as_geojson("a.shp", NULL);
    assert_same_features(LINES, text, "a.shp");
    free(text);
    put_geojson("a.shp", POLYGONS);
    assert_int_equal(count_files(false), 5);
    assert_int_equal(access("a.qix", F_OK), -1);
    text = as_geojson("a.shp", NULL);
    assert_non_null(strstr(text, "\"two\""));
    free(text);
}

static void bad_files_are_refused(void **state)
{
    (void)state;
    static const char *const endings[] = {"a.gpkg", "a.shp", "a.kml", "a.fgb", "a.geojson.gz"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
    {
        refuse(endings[i], NULL, BAT_FILE_ACCESS, i < 4 ? "No such file" : "cannot read");
        put_geojson(endings[i], LINES);
        struct stat about;
        assert_int_equal(stat(endings[i], &about), 0);
        assert_int_equal(truncate(endings[i], about.st_size / 2), 0);
        refuse(endings[i], NULL, BAT_BAD_FILE, "");
    }
    assert_int_equal(mkdir("b.gpkg", 0777), 0);
    refuse("b.gpkg", NULL, BAT_FILE_ACCESS, "Is a directory");
    put("c.gpkg", "");
    refuse("c.gpkg", NULL, BAT_BAD_FILE, "GDAL cannot open the file");
    put("d.kml", "<kml><Placemark><Point><coordinates>1,2</coordinates></Point></Placemark></kml>");
    refuse("d.kml", NULL, BAT_BAD_FILE, "");
    bat_curve_set set = must_read(LINES, BAT_CURVE_FORMAT_GEOJSON, NULL);
    bat_error error;
    assert_int_equal(bat_curve_write("/vsimem/a.gpkg", &set, NULL, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "/vsi"));
    bat_curve_write_options options = bat_curve_write_defaults();
    options.format = BAT_CURVE_FORMAT_GPKG;
    assert_int_equal(bat_curve_write("-", &set, &options, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "standard output"));
    assert_int_equal(bat_curve_write("no/such/folder.gpkg", &set, NULL, &error), BAT_FILE_ACCESS);
    assert_int_equal(rmdir("b.gpkg"), 0);
    bat_curve_set_free(&set);
}

static void packed_text_is_read_by_its_own_reader(void **state)
{
    (void)state;
    bat_curve_set set = must_read("x,y,speed\n0,0,1\n1,0.5,2\n", BAT_CURVE_FORMAT_CSV, NULL);
    must_write_file("a.csv.gz", &set);
    bat_curve_set_free(&set);
    set = must_read_file("a.csv.gz", NULL);
    char *text = must_write(&set, BAT_CURVE_FORMAT_CSV);
    assert_non_null(strstr(text, "x,y,speed\n0,0,1\n1,0.5,2\n"));
    free(text);
    bat_curve_set_free(&set);
    set = must_read_file("/vsigzip/a.csv.gz", NULL);
    assert_int_equal(set.curves[0].count, 2);
    bat_curve_set_free(&set);
}

static void sequences_behind_gz_are_refined_whole(void **state)
{
    (void)state;
    bat_curve_set set = must_read(LINES, BAT_CURVE_FORMAT_GEOJSON, NULL);
    must_write_file("a.geojsonl", &set);
    must_write_file("a.geojsonl.gz", &set);
    bat_curve_set_free(&set);
    static const char *const inputs[] = {"a.geojsonl", "a.geojsonl.gz"};
    static const char *const outputs[] = {"b.geojsonl", "b.geojsonl.gz"};
    char *first = NULL;
    for (size_t i = 0; i < 4; i++)
    {
        bat_curve_refine_file_report report;
        assert_int_equal(bat_curve_refine_file(inputs[i / 2], outputs[i % 2], NULL, &report, NULL), BAT_OK);
        assert_int_equal(report.streamed, i == 0);
        char *text = as_geojson(outputs[i % 2], NULL);
        if (first == NULL)
            first = strdup(text);
        assert_string_equal(text, first);
        free(text);
    }
    free(first);
}

static void a_layer_without_altitudes_has_no_measures_in_geojson(void **state)
{
    (void)state;
    make_layers("a.gpkg", "GPKG", &(made_layer){"roads", "EPSG:25833", wkbLineStringM}, 1);
    bat_curve_set set = must_read_file("a.gpkg", NULL);
    bat_curve_write_options options = bat_curve_write_defaults();
    bat_error error;
    char *text = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
    assert_non_null(strstr(text, "[400000,5800000],[400001,"));
    assert_non_null(strstr(text, "urn:ogc:def:crs:EPSG::25833"));
    free(text);
    assert_int_equal(bat_curve_write("b.geojsonl", &set, NULL, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "cannot name the system"));
    options.crs = "EPSG:32633";
    assert_int_equal(bat_curve_write("b.gpkg", &set, &options, NULL), BAT_OK);
    bat_curve_set_free(&set);
    set = must_read_file("b.gpkg", NULL);
    assert_string_equal(set.attributes->crs, "EPSG:32633");
    bat_curve_set_free(&set);
    set = must_read(LINES, BAT_CURVE_FORMAT_GEOJSON, NULL);
    assert_int_equal(bat_curve_write("c.gpkg", &set, &options, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "no coordinates in EPSG:32633"));
    bat_curve_set_free(&set);
}

static void limits_bound_what_is_read(void **state)
{
    (void)state;
    bat_curve_read_options few = bat_curve_read_defaults(), shorter = bat_curve_read_defaults();
    few.limits.points = 4;
    shorter.limits.bytes = sizeof LINES - 2;
    put_geojson("a.gpkg", LINES);
    put_geojson("a.geojson.gz", LINES);
    refuse("a.gpkg", &few, BAT_TOO_LARGE, "more than 4 points");
    few.limits.points = 5;
    bat_curve_set set = must_read_file("a.gpkg", &few);
    bat_curve_set_free(&set);
    refuse("a.gpkg", &shorter, BAT_TOO_LARGE, "bytes");
    struct stat packed;
    assert_int_equal(stat("a.geojson.gz", &packed), 0);
    shorter.limits.bytes = (size_t)packed.st_size;
    refuse("a.geojson.gz", &shorter, BAT_TOO_LARGE, "bytes");
}

/// GDAL would write a schema beside the file, and beside one of the type aaa-suite even where it is told not to.
static void reading_writes_nothing(void **state)
{
    (void)state;
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = BAT_CURVE_FORMAT_GDAL;
    put("a.gml",
        "<f:c xmlns:f=\"http://f\" xmlns:gml=\"http://www.opengis.net/gml\"><gml:featureMember><f:way fid=\"w\"><f:place>"
        "<gml:LineString srsName=\"EPSG:4326\"><gml:coordinates>8,47 8.5,47.2</gml:coordinates></gml:LineString>"
        "</f:place></f:way></gml:featureMember></f:c>");
    bat_curve_set set = must_read_file("a.gml", &options);
    assert_int_equal(set.curves[0].count, 2);
    bat_curve_set_free(&set);
    put("b.gml", "<n xmlns:f=\"f\" x=\"opengis.net/gml\"><Member><f:name></f:name>aaa-suite");
    bat_error error = {0};
    assert_int_equal(bat_curve_read("b.gml", &options, &set, &error), BAT_BAD_FILE);
    assert_int_equal(count_files(false), 2);
}

/// Drivers that make a folder for another ending, in place of the file or beside it, leave nothing behind.
static void folders_are_refused(void **state)
{
    (void)state;
    bat_curve_write_options options = bat_curve_write_defaults();
    bat_curve_set set = must_read(LINES, BAT_CURVE_FORMAT_GEOJSON, NULL);
    static const char *const PATHS[] = {"a.xml", "a.other"};
    for (size_t i = 0; i < 2; i++)
    {
        bat_error error = {0};
        options.format = BAT_CURVE_FORMAT_KML;
        assert_int_equal(bat_curve_write(PATHS[i], &set, &options, &error), BAT_UNSUPPORTED);
        assert_non_null(strstr(error.text, "makes a folder here"));
        options.format = BAT_CURVE_FORMAT_GDAL;
        assert_int_equal(bat_curve_write(PATHS[i], &set, &options, &error), BAT_UNSUPPORTED);
        assert_int_equal(count_files(true), 0);
    }
    bat_curve_set_free(&set);
}

/// GDAL would look for the end of the second line for ever.
static void a_drawing_that_is_not_text_is_refused(void **state)
{
    (void)state;
    static const char DRAWING[] = {'\n', ')', '\r', '\0'};
    FILE *file = fopen("a.dxf", "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(DRAWING, 1, sizeof DRAWING, file), sizeof DRAWING);
    assert_int_equal(fclose(file), 0);
    bat_curve_read_options any = bat_curve_read_defaults();
    any.format = BAT_CURVE_FORMAT_GDAL;
    refuse("a.dxf", NULL, BAT_BAD_FILE, "save it again as DXF in ASCII");
    refuse("a.dxf", &any, BAT_BAD_FILE, "save it again as DXF in ASCII");
}

static void options_of_other_formats_are_refused(void **state)
{
    (void)state;
    bat_curve_read_options layer = bat_curve_read_defaults(), columns = bat_curve_read_defaults();
    layer.layer = "roads";
    columns.columns = "1,2";
    put_geojson("a.gpkg", LINES);
    put_geojson("a.geojson", LINES);
    refuse("a.geojson", &layer, BAT_INVALID_ARGUMENT, "formats of GDAL have layers");
    refuse("a.gpkg", &columns, BAT_INVALID_ARGUMENT, "only CSV has columns, not the format gpkg");
}

#else

static void a_build_without_gdal_says_what_to_install(void **state)
{
    (void)state;
    static const char *const paths[] = {"a.gpkg", "a.shp", "a.kml", "a.fgb", "a.zip", "a.geojson.gz", "/vsimem/a"};
    bat_curve_set set = must_read(LINES, BAT_CURVE_FORMAT_GEOJSON, NULL);
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
    {
        bat_error error;
        put("a.gpkg", "");
        refuse(paths[i], NULL, BAT_UNSUPPORTED, "scripts/install-deps");
        assert_int_equal(bat_curve_write(paths[i], &set, NULL, &error), BAT_UNSUPPORTED);
        assert_non_null(strstr(error.text, "libgdal-dev"));
    }
    assert_int_equal(count_files(false), 1);
    bat_curve_set_free(&set);
}

#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
#define GIS_TEST(test) cmocka_unit_test_setup_teardown(test, enter_folder, leave_folder)
#if BATTEN_HAS_GDAL
        GIS_TEST(every_format_keeps_lines_and_their_values),
        GIS_TEST(every_format_keeps_polygons_and_empty_features),
        GIS_TEST(a_layer_keeps_its_name_and_its_numbers),
        GIS_TEST(types_of_fields_and_of_geometries_survive),
        GIS_TEST(a_file_with_several_layers_needs_a_choice),
        GIS_TEST(projected_data_stay_in_their_plane),
        GIS_TEST(projected_data_go_to_the_sphere_and_back),
        GIS_TEST(files_without_a_system_are_guessed),
        GIS_TEST(drawings_are_in_the_plane),
        GIS_TEST(points_of_the_globe_have_the_written_decimals),
        GIS_TEST(points_pass_through),
        GIS_TEST(a_shapefile_is_replaced_as_a_whole),
        GIS_TEST(bad_files_are_refused),
        GIS_TEST(packed_text_is_read_by_its_own_reader),
        GIS_TEST(sequences_behind_gz_are_refined_whole),
        GIS_TEST(a_layer_without_altitudes_has_no_measures_in_geojson),
        GIS_TEST(limits_bound_what_is_read),
        GIS_TEST(reading_writes_nothing),
        GIS_TEST(folders_are_refused),
        GIS_TEST(a_drawing_that_is_not_text_is_refused),
        GIS_TEST(options_of_other_formats_are_refused),
#else
        GIS_TEST(a_build_without_gdal_says_what_to_install),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
