#include "io/curve/formats.h"
#include "io/gis/gdal.h"
#include "io/gis/gis.h"

#include <errno.h>
#include <math.h>
#include <sys/stat.h>

/// @file
/// Reader of layers by GDAL. A layer becomes the text of a GeoJSON collection, which the reader of GeoJSON takes.

typedef struct layer_reader
{
    OGRLayerH layer;
    OGRFeatureDefnH fields;
    bool swaps;    ///< the two coordinates of a position
    bool measures; ///< the layer has measures (M) and no altitudes: the third number of a position is its measure
    bool ids;      ///< features have numbers of their own
    bool zeros;    ///< altitudes are 0 where there are none
    size_t undefined, straightened, recoded, points;
    text_buffer text;
    gdal_messages messages;
} layer_reader;

/// Write a number after a separator.
static void write_number(text_buffer *text, const char *separator, double value)
{
    if (isfinite(value))
        text_append_real(text, separator, value);
    else
        TEXT_APPEND(text, separator, "1e999"); // too large, as the reader of GeoJSON says
}

/// Write a string, which should be UTF-8; else it is taken as Latin-1.
static void write_string(layer_reader *reader, const char *string)
{
    size_t length = strlen(string);
    if (length == 0 || gdal.CPLIsUTF8(string, (int)length))
    {
        json_text_string(&reader->text, string, length);
        return;
    }
    char *recoded = gdal.CPLRecode(string, CPL_ENC_ISO8859_1, CPL_ENC_UTF8);
    json_text_string(&reader->text, recoded, strlen(recoded));
    gdal.VSIFree(recoded);
    reader->recoded++;
}

/// Write x and y and, where there are any, altitude and measure.
static void write_position(layer_reader *reader, OGRGeometryH geometry, int index)
{
    double x, y, z, m;
    reader->points++;
    gdal.OGR_G_GetPointZM(geometry, index, &x, &y, &z, &m);
    write_number(&reader->text, "[", x);
    write_number(&reader->text, ",", y);
    if (gdal.OGR_G_Is3D(geometry))
        write_number(&reader->text, ",", z);
    if (gdal.OGR_G_IsMeasured(geometry))
        write_number(&reader->text, ",", m);
    text_append_string(&reader->text, "]");
}

/// Write the coordinates of a geometry other than a collection. Empty parts are left out.
static void write_coordinates(layer_reader *reader, OGRGeometryH geometry)
{
    OGRwkbGeometryType type = gdal.OGR_GT_Flatten(gdal.OGR_G_GetGeometryType(geometry));
    if (type == wkbPoint && !gdal.OGR_G_IsEmpty(geometry))
    {
        write_position(reader, geometry, 0);
        return;
    }
    const char *separator = "";
    text_append_string(&reader->text, "[");
    for (int i = 0; type == wkbLineString && i < gdal.OGR_G_GetPointCount(geometry); i++, separator = ",")
    {
        text_append_string(&reader->text, separator);
        write_position(reader, geometry, i);
    }
    for (int i = 0; i < gdal.OGR_G_GetGeometryCount(geometry); i++)
    {
        OGRGeometryH part = gdal.OGR_G_GetGeometryRef(geometry, i);
        if (gdal.OGR_G_IsEmpty(part))
            continue;
        text_append_string(&reader->text, separator);
        write_coordinates(reader, part);
        separator = ",";
    }
    text_append_string(&reader->text, "]");
}

/// Write a geometry; false for a type that GeoJSON does not have.
static bool write_geometry(layer_reader *reader, OGRGeometryH geometry)
{
    OGRwkbGeometryType type = gdal.OGR_GT_Flatten(gdal.OGR_G_GetGeometryType(geometry));
    bool collection = type == wkbGeometryCollection;
    if (type == wkbUnknown || (int)type >= GEOMETRY_KINDS)
        return false;
    TEXT_APPEND(&reader->text, "{\"type\":\"", GEOMETRY_NAMES[type],
                collection ? "\",\"geometries\":[" : "\",\"coordinates\":");
    if (!collection)
        write_coordinates(reader, geometry);
    for (int i = 0; collection && i < gdal.OGR_G_GetGeometryCount(geometry); i++)
    {
        text_append_string(&reader->text, i > 0 ? "," : "");
        if (!write_geometry(reader, gdal.OGR_G_GetGeometryRef(geometry, i)))
            return false;
    }
    text_append_string(&reader->text, collection ? "]}" : "}");
    return true;
}

/// Whether a third or fourth number is defined. Shapefiles write one below -1e38 for none.
static bool is_defined(double number)
{
    static const double NONE = -1e38;
    return isfinite(number) && number > NONE;
}

/// What the altitudes and measures of a geometry are.
typedef struct number_survey
{
    bool altitudes, measures; ///< all are defined
    bool flat;                ///< all altitudes are 0
} number_survey;

static void survey(OGRGeometryH geometry, number_survey *found)
{
    OGRwkbGeometryType type = gdal.OGR_GT_Flatten(gdal.OGR_G_GetGeometryType(geometry));
    bool leaf = type == wkbPoint || type == wkbLineString;
    for (int i = 0; leaf && i < gdal.OGR_G_GetPointCount(geometry); i++)
    {
        double x, y, z, m;
        gdal.OGR_G_GetPointZM(geometry, i, &x, &y, &z, &m);
        found->altitudes = found->altitudes && is_defined(z);
        found->measures = found->measures && is_defined(m);
        found->flat = found->flat && z == 0;
    }
    for (int i = 0; i < gdal.OGR_G_GetGeometryCount(geometry); i++)
        survey(gdal.OGR_G_GetGeometryRef(geometry, i), found);
}

/// Remove altitudes and measures that are not defined, and those of KML that are all 0, which may mean none.
static void remove_undefined(layer_reader *reader, OGRGeometryH geometry)
{
    number_survey found = {.altitudes = true, .measures = true, .flat = true};
    survey(geometry, &found);
    bool deep = gdal.OGR_G_Is3D(geometry) != 0, measured = gdal.OGR_G_IsMeasured(geometry) != 0;
    reader->undefined += (deep && !found.altitudes) || (measured && !found.measures);
    if (deep && (!found.altitudes || (reader->zeros && found.flat)))
        gdal.OGR_G_Set3D(geometry, 0);
    if (measured && !found.measures)
        gdal.OGR_G_SetMeasured(geometry, 0);
}

/// Write the geometry of a feature, of which this takes the ownership.
static bool write_feature_geometry(layer_reader *reader, OGRGeometryH geometry)
{
    if (geometry == NULL)
    {
        text_append_string(&reader->text, "null");
        return true;
    }
    if (gdal.OGR_G_HasCurveGeometry(geometry, 0))
    {
        OGRGeometryH straight = gdal.OGR_G_GetLinearGeometry(geometry, 0, NULL);
        gdal.OGR_G_DestroyGeometry(geometry);
        geometry = straight;
        reader->straightened++;
    }
    OGRwkbGeometryType type = gdal.OGR_GT_Flatten(gdal.OGR_G_GetGeometryType(geometry));
    if (type == wkbPolyhedralSurface || type == wkbTIN || type == wkbTriangle)
        geometry = gdal.OGR_G_ForceToMultiPolygon(geometry);
    gdal.OGR_G_CloseRings(geometry);
    if (reader->swaps)
        gdal.OGR_G_SwapXY(geometry);
    remove_undefined(reader, geometry);
    if (reader->measures)
        gdal.OGR_G_Set3D(geometry, 0);
    else if (gdal.OGR_G_IsMeasured(geometry))
        gdal.OGR_G_Set3D(geometry, 1);
    bool written = write_geometry(reader, geometry);
    gdal.OGR_G_DestroyGeometry(geometry);
    return written;
}

static void write_time(layer_reader *reader, OGRFeatureH feature, int field, OGRFieldType type)
{
    enum
    {
        LOCAL = 1, ///< zones in quarters of an hour from Greenwich, as GDAL counts them
        GREENWICH = 100,
        QUARTER = 15,
        HOUR = 60
    };
    int year, month, day, hour, minute, zone;
    float second;
    char text[128];
    size_t used = 0;
    (void)gdal.OGR_F_GetFieldAsDateTimeEx(feature, field, &year, &month, &day, &hour, &minute, &second, &zone);
    if (type != OFTTime)
        used += (size_t)snprintf(text, sizeof text, "%04d-%02d-%02d", year, month, day);
    if (type != OFTDate)
    {
        int milliseconds = (int)lrint((double)second * 1000);
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%02d:%02d:%02d", used > 0 ? "T" : "", hour, minute,
                                 milliseconds / 1000);
        if (milliseconds % 1000 != 0)
            used += (size_t)snprintf(text + used, sizeof text - used, ".%03d", milliseconds % 1000);
        int offset = (zone - GREENWICH) * QUARTER;
        if (zone == GREENWICH)
            (void)snprintf(text + used, sizeof text - used, "Z");
        else if (zone > LOCAL)
            (void)snprintf(text + used, sizeof text - used, "%c%02d:%02d", offset < 0 ? '-' : '+', abs(offset) / HOUR,
                           abs(offset) % HOUR);
    }
    write_string(reader, text);
}

/// Write a real number; what is no number becomes a string, as JSON has none for it.
static void write_real(layer_reader *reader, double value)
{
    if (isfinite(value))
        write_number(&reader->text, "", value);
    else
        write_string(reader, isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
}

static void write_integer(layer_reader *reader, long long value)
{
    text_append_format(&reader->text, "%lld", value);
}

static void write_list(layer_reader *reader, OGRFeatureH feature, int field, OGRFieldType type)
{
    int count = 0;
    const int *integers = type == OFTIntegerList ? gdal.OGR_F_GetFieldAsIntegerList(feature, field, &count) : NULL;
    const GIntBig *longs = type == OFTInteger64List ? gdal.OGR_F_GetFieldAsInteger64List(feature, field, &count) : NULL;
    const double *reals = type == OFTRealList ? gdal.OGR_F_GetFieldAsDoubleList(feature, field, &count) : NULL;
    char **strings = type == OFTStringList ? gdal.OGR_F_GetFieldAsStringList(feature, field) : NULL;
    while (strings != NULL && strings[count] != NULL)
        count++;
    text_append_string(&reader->text, "[");
    for (int i = 0; i < count; i++)
    {
        text_append_string(&reader->text, i > 0 ? "," : "");
        if (integers != NULL)
            write_integer(reader, integers[i]);
        else if (longs != NULL)
            write_integer(reader, longs[i]);
        else if (reals != NULL)
            write_real(reader, reals[i]);
        else if (strings != NULL)
            write_string(reader, strings[i]);
    }
    text_append_string(&reader->text, "]");
}

static void write_binary(layer_reader *reader, OGRFeatureH feature, int field)
{
    int size = 0;
    const GByte *bytes = gdal.OGR_F_GetFieldAsBinary(feature, field, &size);
    char *text = gdal.CPLBinaryToHex(size, bytes);
    write_string(reader, text);
    gdal.VSIFree(text);
}

/// Write a string, or where the field holds JSON and it is valid, its value.
static void write_text(layer_reader *reader, OGRFeatureH feature, int field, OGRFieldSubType subtype)
{
    const char *string = gdal.OGR_F_GetFieldAsString(feature, field);
    json_t *value = subtype == OFSTJSON ? json_loads(string, JSON_REJECT_DUPLICATES | JSON_ALLOW_NUL, NULL) : NULL;
    if (value != NULL)
        json_text(&reader->text, value);
    else
        write_string(reader, string);
    json_decref(value);
}

static void write_value(layer_reader *reader, OGRFeatureH feature, int field)
{
    OGRFieldDefnH definition = gdal.OGR_FD_GetFieldDefn(reader->fields, field);
    OGRFieldType type = gdal.OGR_Fld_GetType(definition);
    OGRFieldSubType subtype = gdal.OGR_Fld_GetSubType(definition);
    if (gdal.OGR_F_IsFieldNull(feature, field))
        text_append_string(&reader->text, "null");
    else if (type == OFTInteger && subtype == OFSTBoolean)
        text_append_string(&reader->text, gdal.OGR_F_GetFieldAsInteger64(feature, field) != 0 ? "true" : "false");
    else if (type == OFTInteger || type == OFTInteger64)
        write_integer(reader, gdal.OGR_F_GetFieldAsInteger64(feature, field));
    else if (type == OFTReal)
        write_real(reader, gdal.OGR_F_GetFieldAsDouble(feature, field));
    else if (type == OFTDate || type == OFTTime || type == OFTDateTime)
        write_time(reader, feature, field, type);
    else if (type == OFTIntegerList || type == OFTInteger64List || type == OFTRealList || type == OFTStringList)
        write_list(reader, feature, field, type);
    else if (type == OFTBinary)
        write_binary(reader, feature, field);
    else
        write_text(reader, feature, field, subtype);
}

/// Write a feature; false when its geometry has no form in GeoJSON.
static bool write_feature(layer_reader *reader, OGRFeatureH feature)
{
    const char *separator = "";
    text_append_string(&reader->text, "{\"type\":\"Feature\"");
    if (reader->ids)
    {
        text_append_string(&reader->text, ",\"id\":");
        write_integer(reader, gdal.OGR_F_GetFID(feature));
    }
    text_append_string(&reader->text, ",\"properties\":{");
    for (int i = 0; i < gdal.OGR_FD_GetFieldCount(reader->fields); i++)
    {
        if (!gdal.OGR_F_IsFieldSet(feature, i))
            continue;
        text_append_string(&reader->text, separator);
        write_string(reader, gdal.OGR_Fld_GetNameRef(gdal.OGR_FD_GetFieldDefn(reader->fields, i)));
        text_append_string(&reader->text, ":");
        write_value(reader, feature, i);
        separator = ",";
    }
    text_append_string(&reader->text, "},\"geometry\":");
    bool written = write_feature_geometry(reader, gdal.OGR_F_StealGeometry(feature));
    text_append_string(&reader->text, "}");
    return written;
}

static bat_status write_features(layer_reader *reader, const bat_limits *limits, size_t file_size, bat_error *error)
{
    const file_text limited = {.points = limits->points};
    size_t count = 0;
    bat_status status = BAT_OK;
    text_append_string(&reader->text, "{\"type\":\"FeatureCollection\",\"name\":");
    write_string(reader, gdal.OGR_L_GetName(reader->layer));
    text_append_string(&reader->text, ",\"features\":[");
    gdal.OGR_L_ResetReading(reader->layer);
    for (OGRFeatureH feature; status == BAT_OK && (feature = gdal.OGR_L_GetNextFeature(reader->layer)) != NULL; count++)
    {
        text_append_string(&reader->text, count > 0 ? ",\n" : "\n");
        if (!write_feature(reader, feature))
            status = error_set(error, BAT_UNSUPPORTED, count, 0, "feature %zu has a geometry of an unknown type", count);
        else
            status = file_text_points(&limited, file_size, reader->points, error);
        gdal.OGR_F_Destroy(feature);
        if (status == BAT_OK && reader->messages.failures > 0)
            break;
    }
    text_append_string(&reader->text, "\n]}");
    if (status == BAT_OK && reader->messages.failures > 0)
        status = gdal_fault(&reader->messages, BAT_BAD_FILE, error, "GDAL cannot read all features");
    return status == BAT_OK && reader->text.failed ? error_memory(error, reader->text.size) : status;
}

static bool is_of_curves(OGRLayerH layer)
{
    OGRwkbGeometryType type = gdal.OGR_GT_Flatten(gdal.OGR_L_GetGeomType(layer));
    return type != wkbNone && type != wkbPoint && type != wkbMultiPoint;
}

/// The names of the layers of lines and polygons, or of all layers, for messages.
static const char *layer_names(GDALDatasetH dataset, bool all, char *names, size_t size)
{
    names[0] = '\0';
    for (int i = 0; i < gdal.GDALDatasetGetLayerCount(dataset); i++)
    {
        OGRLayerH layer = gdal.GDALDatasetGetLayer(dataset, i);
        size_t used = strlen(names);
        if (all || is_of_curves(layer))
            (void)snprintf(names + used, size - used, "%s%s", used > 0 ? ", " : "", gdal.OGR_L_GetName(layer));
    }
    return names;
}

/// Choose the layer of the options, or the only one of lines and polygons.
static bat_status choose_layer(GDALDatasetH dataset, const bat_curve_read_options *options, OGRLayerH *chosen,
                               bat_error *error)
{
    char names[BAT_ERROR_TEXT_SIZE / 2];
    *chosen = NULL;
    if (options->layer != NULL)
    {
        *chosen = gdal.GDALDatasetGetLayerByName(dataset, options->layer);
        return *chosen != NULL ? BAT_OK
                               : ERROR_ARGUMENT(error, "there is no layer '%.40s'; there are %s", options->layer,
                                                layer_names(dataset, true, names, sizeof names));
    }
    size_t count = 0;
    for (int i = 0; i < gdal.GDALDatasetGetLayerCount(dataset); i++)
    {
        OGRLayerH layer = gdal.GDALDatasetGetLayer(dataset, i);
        if (is_of_curves(layer) && count++ == 0)
            *chosen = layer;
    }
    if (count == 0)
        return ERROR_FILE(error, 0, "there are no lines or polygons");
    if (count > 1)
    {
        (void)ERROR_ARGUMENT(error, "there are %zu layers: %s", count, layer_names(dataset, false, names, sizeof names));
        return error_remedy(error, BAT_INVALID_ARGUMENT, "layer", "chooses one");
    }
    return BAT_OK;
}

/// The system of the layer as the name that attributes keep, and the space that follows from it.
typedef struct layer_system
{
    char *name; ///< null: none, or WGS 84 on the sphere
    const char *space;
    bool guessed, missing;
} layer_system;

static bool fits_degrees(OGRLayerH layer)
{
    OGREnvelope box;
    return gdal.OGR_L_GetExtent(layer, &box, 1) == OGRERR_NONE && box.MinX >= -180 && box.MaxX <= 180 && box.MinY >= -90 &&
           box.MaxY <= 90;
}

/// @param drawing whether coordinates without a system are those of a drawing, never degrees
static bat_status find_system(layer_reader *reader, bool drawing, const char *space, layer_system *found, bat_error *error)
{
    OGRSpatialReferenceH system = gdal.OGR_L_GetSpatialRef(reader->layer);
    *found = (layer_system){.space = space, .missing = system == NULL};
    if (system == NULL)
    {
        found->guessed = space == NULL;
        if (space == NULL)
            found->space = !drawing && fits_degrees(reader->layer) ? "sphere" : "plane";
        return BAT_OK;
    }
    reader->swaps = system_is_swapped(system);
    bool degrees = system_is_degrees(system);
    if (space == NULL)
        found->space = degrees ? "sphere" : "plane";
    bool sphere = strcmp(found->space, "sphere") == 0;
    found->name = system_name(system);
    if (found->name == NULL)
        return error_memory(error, 1);
    if (sphere && !degrees)
    {
        (void)ERROR_UNSUPPORTED(error, 0, "the coordinates are not degrees but of the system %.60s", found->name);
        return error_remedy(error, BAT_UNSUPPORTED, "on_sphere", "transforms them");
    }
    OGRSpatialReferenceH wgs84 = sphere ? system_by_name("OGC:CRS84") : NULL;
    if (wgs84 != NULL && (strcmp(found->name, "EPSG:4326") == 0 || gdal.OSRIsSame(system, wgs84)))
    {
        free(found->name);
        found->name = NULL;
    }
    if (wgs84 != NULL)
        gdal.OSRDestroySpatialReference(wgs84);
    return BAT_OK;
}

static void layer_free(geojson_layer *layer)
{
    gdal.OGR_FD_Release(layer->fields);
    free(layer->name);
    free(layer->ids);
    free(layer);
}

/// Give the document of a set what it needs to be written as a layer again.
static bool keep_layer(const layer_reader *reader, geojson_document *document)
{
    geojson_layer *kept = calloc(1, sizeof *kept);
    if (kept == NULL)
        return false;
    kept->fields = reader->fields;
    (void)gdal.OGR_FD_Reference(kept->fields);
    kept->name = strdup(gdal.OGR_L_GetName(reader->layer));
    kept->ids = strdup(gdal.OGR_L_GetFIDColumn(reader->layer));
    kept->any_geometry = gdal.OGR_GT_Flatten(gdal.OGR_L_GetGeomType(reader->layer)) == wkbUnknown;
    document->layer = kept;
    document->layer_free = layer_free;
    document->measures = reader->measures;
    return kept->name != NULL && kept->ids != NULL;
}

static bool note_all(const layer_reader *reader, GDALDatasetH dataset, const bat_curve_read_options *options,
                     const layer_system *system, bat_curve_attributes *attributes)
{
    bool noted = true, sphere = strcmp(system->space, "sphere") == 0;
    int layers = gdal.GDALDatasetGetLayerCount(dataset);
    if (layers > 1 && options->layer == NULL)
        noted = attributes_note(attributes, "read the layer '%s', the only one of %d with lines or polygons",
                                gdal.OGR_L_GetName(reader->layer), layers);
    if (noted && system->guessed)
        noted = sphere ? attributes_note(attributes, "the file names no coordinate system; its coordinates are taken as "
                                                     "degrees, because they could be (the plane takes them as they are)")
                       : attributes_note(attributes, "the file names no coordinate system; its coordinates are those of a "
                                                     "plane");
    if (noted && reader->straightened > 0)
        noted = attributes_note(attributes, "arcs of %zu features became polygons or lines", reader->straightened);
    if (noted && reader->undefined > 0)
        noted = attributes_note(attributes, "dropped altitudes or measures of %zu features, of which some are no numbers",
                                reader->undefined);
    if (noted && reader->recoded > 0)
        noted = attributes_note(attributes, "took %zu texts that are not UTF-8 as Latin-1", reader->recoded);
    return noted;
}

static bat_status read_layer(layer_reader *reader, GDALDatasetH dataset, size_t bytes, const bat_curve_read_options *options,
                             bat_curve_set *set, bat_error *error)
{
    OGRwkbGeometryType type = gdal.OGR_L_GetGeomType(reader->layer);
    reader->fields = gdal.OGR_L_GetLayerDefn(reader->layer);
    const char *driver = gdal.GDALGetDriverShortName(gdal.GDALGetDatasetDriver(dataset));
    reader->zeros = strstr(driver, "KML") != NULL;
    reader->ids = gdal.OGR_L_GetFIDColumn(reader->layer)[0] != '\0';
    reader->measures = gdal.OGR_GT_HasM(type) && !gdal.OGR_GT_HasZ(type);
    layer_system system;
    bat_curve_set made = {0};
    bat_status status = find_system(reader, strcmp(driver, "DXF") == 0, options->space, &system, error);
    if (status == BAT_OK)
        status = write_features(reader, &options->limits, bytes, error);
    if (status == BAT_OK)
    {
        bat_curve_read_options rest = *options;
        rest.space = system.space;
        file_text text = {.data = reader->text.data, .size = reader->text.size};
        status = geojson_read(&text, &rest, &made, error);
        if (status != BAT_OK && error != NULL)
            error->line = 0; // of a text that nobody sees
    }
    text_free(&reader->text);
    if (status == BAT_OK)
    {
        geojson_document *document = made.attributes->remainder.content;
        for (size_t i = 0; i < document->feature_count; i++)
            document->features[i].line = 0;
        free(made.attributes->crs);
        made.attributes->crs = system.name;
        system.name = NULL;
        if (!keep_layer(reader, document) || !note_all(reader, dataset, options, &system, made.attributes))
            status = error_memory(error, sizeof *document);
    }
    free(system.name);
    if (status == BAT_OK)
        *set = made;
    else
        bat_curve_set_free(&made);
    return status;
}

/// Whether a path of the file system can be read, for a message in the usual words. `bytes` becomes its length if it has
/// one.
static bat_status check_path(const char *path, bool folders, const bat_limits *limits, size_t *bytes, bat_error *error)
{
    struct stat about;
    if (strncmp(path, "/vsi", 4) == 0)
        return BAT_OK;
    if (strcmp(path, "-") == 0)
        return ERROR_UNSUPPORTED(error, 0, "formats of GDAL cannot be read from standard input");
    int reason = stat(path, &about) != 0 ? errno : S_ISDIR(about.st_mode) && !folders ? EISDIR : 0;
    if (reason != 0)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot read: %s", strerror(reason));
    *bytes = (size_t)about.st_size;
    return file_text_bytes(limits, *bytes, error);
}

/// GDAL looks for ever for the end of a line of a drawing that has a zero byte. Other files are not looked at.
static bat_status check_drawing(const char *spelled, bat_error *error)
{
    static const char *const DRAWINGS[] = {"DXF", NULL};
    if (gdal.GDALIdentifyDriverEx(spelled, GDAL_OF_VECTOR, DRAWINGS, NULL) == NULL)
        return BAT_OK;
    char piece[1 << 12];
    size_t got = 0;
    bool zeros = false;
    VSILFILE *file = gdal.VSIFOpenL(spelled, "rb");
    while (file != NULL && !zeros && (got = gdal.VSIFReadL(piece, 1, sizeof piece, file)) > 0)
        zeros = memchr(piece, '\0', got) != NULL;
    if (file != NULL)
        (void)gdal.VSIFCloseL(file);
    return zeros ? ERROR_FILE(error, 0, "the drawing is not text: save it again as DXF in ASCII") : BAT_OK;
}

bat_status gis_read(const char *path, const char *drivers, const bat_curve_read_options *options, bat_curve_set *set,
                    bat_error *error)
{
    // GML: nothing is written beside the file, not even tried, and nothing fetched that it names.
    static const char *const OPENING[] = {"WRITE_GFS=NO", "DOWNLOAD_SCHEMA=NO", NULL};
    layer_reader reader = {.fields = NULL};
    size_t bytes = SIZE_MAX / 2; // unknown, as is that of many files
    bat_status status = check_path(path, drivers == NULL, &options->limits, &bytes, error);
    if (status == BAT_OK)
        status = gdal_begin(&reader.messages, error);
    if (status != BAT_OK)
        return status;
    char *spelled = gdal_path(path);
    if (drivers == NULL && spelled != NULL && strcmp(spelled, path) == 0)
        bytes = SIZE_MAX / 2;
    if (spelled == NULL)
        status = error_memory(error, strlen(path));
    else if (drivers == NULL || strcmp(drivers, "DXF") == 0)
        status = check_drawing(spelled, error);
    char **allowed = drivers != NULL ? gdal.CSLTokenizeString2(drivers, ",", 0) : NULL;
    GDALDatasetH dataset = NULL;
    if (status == BAT_OK)
        dataset =
            gdal.GDALOpenEx(spelled, GDAL_OF_VECTOR | GDAL_OF_VERBOSE_ERROR, (const char *const *)allowed, OPENING, NULL);
    if (status == BAT_OK && dataset == NULL)
        status = gdal_fault(&reader.messages, BAT_BAD_FILE, error, "GDAL cannot open the file");
    if (status == BAT_OK)
        status = choose_layer(dataset, options, &reader.layer, error);
    if (status == BAT_OK)
        status = read_layer(&reader, dataset, bytes, options, set, error);
    if (dataset != NULL)
        gdal.GDALClose(dataset);
    gdal.CSLDestroy(allowed);
    free(spelled);
    gdal_end();
    return status;
}
