#include "base/atomic_file.h"
#include "io/curve/formats.h"
#include "io/gis/gdal.h"
#include "io/gis/gis.h"

/// @file
/// Writer of layers by GDAL, from the features that the writer of GeoJSON makes.

typedef struct layer_writer
{
    const bat_curve_set *set;
    const bat_curve_write_options *options;
    const geojson_document *document; ///< null for a set without features
    GDALDriverH driver;
    const char *driver_name;
    OGRGeometryH *geometries; ///< of each feature, until the feature takes it; null for none
    size_t count, capacity;
    unsigned types;      ///< the types of geometries, a bit each
    bool deep, measured; ///< some have altitudes, measures
    OGRSpatialReferenceH system;
    OGRCoordinateTransformationH to_wgs84; ///< for formats that hold WGS 84 alone; null for none
    OGRLayerH layer;
    json_t *fields; ///< the index of each field in the layer, by its name in the features
    gdal_messages messages;
} layer_writer;

static bool is_driver(const layer_writer *writer, const char *name)
{
    return strcmp(writer->driver_name, name) == 0;
}

/// Whether the format holds longitude and latitude of WGS 84 alone.
static bool is_global(const layer_writer *writer)
{
    return is_driver(writer, "KML") || is_driver(writer, "LIBKML") || is_driver(writer, "GeoJSONSeq");
}

static void add_position(OGRGeometryH geometry, const json_t *position, bool measures)
{
    double numbers[4] = {0};
    size_t count = json_array_size(position);
    for (size_t i = 0; i < count && i < 4; i++)
        numbers[i] = json_number_value(json_array_get(position, i));
    if (count > 3)
        gdal.OGR_G_AddPointZM(geometry, numbers[0], numbers[1], numbers[2], numbers[3]);
    else if (count == 3 && measures)
        gdal.OGR_G_AddPointM(geometry, numbers[0], numbers[1], numbers[2]);
    else if (count == 3)
        gdal.OGR_G_AddPoint(geometry, numbers[0], numbers[1], numbers[2]);
    else
        gdal.OGR_G_AddPoint_2D(geometry, numbers[0], numbers[1]);
}

/// Make a geometry of coordinates. `part` is the type of its parts, wkbUnknown where it has positions.
static OGRGeometryH make_geometry(OGRwkbGeometryType type, const json_t *coordinates, bool measures)
{
    OGRwkbGeometryType part = type == wkbMultiPoint        ? wkbPoint
                              : type == wkbMultiLineString ? wkbLineString
                              : type == wkbMultiPolygon    ? wkbPolygon
                              : type == wkbPolygon         ? wkbLinearRing
                                                           : wkbUnknown;
    OGRGeometryH geometry = gdal.OGR_G_CreateGeometry(type);
    if (type == wkbPoint && json_array_size(coordinates) > 0)
        add_position(geometry, coordinates, measures);
    for (size_t i = 0; type != wkbPoint && i < json_array_size(coordinates); i++)
    {
        const json_t *value = json_array_get(coordinates, i);
        if (part == wkbUnknown)
            add_position(geometry, value, measures);
        else
            (void)gdal.OGR_G_AddGeometryDirectly(geometry, make_geometry(part, value, measures));
    }
    return geometry;
}

/// Make a geometry of a geometry of GeoJSON; null for null.
static OGRGeometryH geometry_of(const json_t *tree, bool measures)
{
    geometry_kind kind = geojson_kind(tree);
    if (kind != GEOMETRY_UNKNOWN && kind != GEOMETRY_COLLECTION)
        return make_geometry((OGRwkbGeometryType)kind, json_object_get(tree, "coordinates"), measures);
    const json_t *members = json_object_get(tree, "geometries");
    OGRGeometryH collection = kind == GEOMETRY_COLLECTION ? gdal.OGR_G_CreateGeometry(wkbGeometryCollection) : NULL;
    for (size_t i = 0; i < json_array_size(members); i++)
    {
        OGRGeometryH member = geometry_of(json_array_get(members, i), measures);
        if (member != NULL)
            (void)gdal.OGR_G_AddGeometryDirectly(collection, member);
    }
    return collection;
}

static bat_status take_geometry(void *context, size_t index, const json_t *feature, bat_error *error)
{
    layer_writer *writer = context;
    if (!ARRAY_GROW(writer->geometries, writer->capacity, index + 1))
        return error_memory(error, index * sizeof(OGRGeometryH));
    bool bare = !geojson_has_type(feature, "Feature");
    bool measures = writer->document != NULL && writer->document->measures;
    OGRGeometryH geometry = geometry_of(bare ? feature : json_object_get(feature, "geometry"), measures);
    writer->geometries[writer->count++] = geometry;
    if (geometry == NULL)
        return BAT_OK;
    if (writer->to_wgs84 != NULL && gdal.OGR_G_Transform(geometry, writer->to_wgs84) != OGRERR_NONE)
        return error_set(error, BAT_INVALID_POINT, BAT_NO_INDEX, 0, "feature %zu has no place on the globe", index);
    writer->types |= 1U << gdal.OGR_GT_Flatten(gdal.OGR_G_GetGeometryType(geometry));
    writer->deep = writer->deep || gdal.OGR_G_Is3D(geometry);
    writer->measured = writer->measured || gdal.OGR_G_IsMeasured(geometry);
    return BAT_OK;
}

static const unsigned LINES = 1U << wkbLineString | 1U << wkbMultiLineString,
                      POLYGONS = 1U << wkbPolygon | 1U << wkbMultiPolygon;

/// The type of the layer. Where there are single and multiple lines, or polygons, all become multiple.
static OGRwkbGeometryType choose_type(layer_writer *writer)
{
    bool lines = (writer->types & ~LINES) == 0, polygons = (writer->types & ~POLYGONS) == 0;
    // KML and GeoJSON have no types of layers.
    bool any = is_global(writer) ||
               (writer->document != NULL && writer->document->layer != NULL && writer->document->layer->any_geometry);
    OGRwkbGeometryType type = wkbUnknown;
    if (!any && lines)
        type = writer->types == 1U << wkbLineString ? wkbLineString : wkbMultiLineString;
    else if (!any && polygons)
        type = writer->types == 1U << wkbPolygon ? wkbPolygon : wkbMultiPolygon;
    for (size_t i = 0; i < writer->count; i++)
    {
        OGRGeometryH *geometry = &writer->geometries[i];
        if (*geometry != NULL && type == wkbMultiLineString)
            *geometry = gdal.OGR_G_ForceToMultiLineString(*geometry);
        else if (*geometry != NULL && type == wkbMultiPolygon)
            *geometry = gdal.OGR_G_ForceToMultiPolygon(*geometry);
    }
    return gdal.OGR_GT_SetModifier(type, writer->deep, writer->measured);
}

static const char ID[] = "id";

static OGRFieldDefnH define_field(const char *name, json_int_t kinds)
{
    bool number = (kinds & ~(json_int_t)(VALUE_INTEGER | VALUE_LONG | VALUE_REAL)) == 0 && kinds != 0;
    OGRFieldType type = OFTString;
    if (kinds == VALUE_BOOLEAN || kinds == VALUE_INTEGER)
        type = OFTInteger;
    else if (number)
        type = (kinds & VALUE_REAL) != 0 ? OFTReal : OFTInteger64;
    OGRFieldDefnH field = gdal.OGR_Fld_Create(name, type);
    if (kinds == VALUE_BOOLEAN)
        gdal.OGR_Fld_SetSubType(field, OFSTBoolean);
    else if (kinds == VALUE_TREE)
        gdal.OGR_Fld_SetSubType(field, OFSTJSON);
    return field;
}

/// Create a field, unless the format has given the layer one of that name.
static bool add_field(layer_writer *writer, const char *name, OGRFieldDefnH field)
{
    int index = gdal.OGR_L_FindFieldIndex(writer->layer, name, 1);
    if (index < 0 && gdal.OGR_L_CreateField(writer->layer, field, 1) == OGRERR_NONE)
        index = gdal.OGR_FD_GetFieldCount(gdal.OGR_L_GetLayerDefn(writer->layer)) - 1;
    return index >= 0 && json_object_set_new(writer->fields, name, json_integer(index)) == 0;
}

/// Create the fields of the layer that was read, or those that the properties of the features make.
static bat_status create_fields(layer_writer *writer, bat_error *error)
{
    const geojson_layer *layer = writer->document != NULL ? writer->document->layer : NULL;
    bool added = true;
    for (int i = 0; layer != NULL && added && i < gdal.OGR_FD_GetFieldCount(layer->fields); i++)
    {
        OGRFieldDefnH field = gdal.OGR_FD_GetFieldDefn(layer->fields, i);
        added = add_field(writer, gdal.OGR_Fld_GetNameRef(field), field);
    }
    json_t *kinds = layer == NULL ? geojson_property_kinds(writer->document) : NULL, *value;
    const char *name;
    if (layer == NULL && kinds == NULL)
        return error_memory(error, sizeof *kinds);
    json_object_foreach(kinds, name, value)
    {
        OGRFieldDefnH field = define_field(name, json_integer_value(value));
        added = added && add_field(writer, name, field);
        gdal.OGR_Fld_Destroy(field);
    }
    json_decref(kinds);
    return added ? BAT_OK : gdal_fault(&writer->messages, BAT_UNSUPPORTED, error, "GDAL cannot make a field");
}

static bool set_list(OGRFeatureH feature, int index, OGRFieldType type, const json_t *list)
{
    size_t count = json_array_size(list);
    memory_pool pool = {0};
    double *reals = memory_pool_array(&pool, count, sizeof *reals);
    GIntBig *longs = memory_pool_array(&pool, count, sizeof *longs);
    const char **strings = memory_pool_zeros(&pool, count + 1, sizeof *strings); // with the end of the list
    bool enough = pool.missing == 0;
    for (size_t i = 0; enough && i < count; i++)
    {
        const json_t *value = json_array_get(list, i);
        reals[i] = json_is_string(value) ? NAN : json_number_value(value);
        longs[i] = json_integer_value(value);
        strings[i] = json_is_string(value) ? json_string_value(value) : "";
    }
    if (enough && type == OFTRealList)
        gdal.OGR_F_SetFieldDoubleList(feature, index, (int)count, reals);
    else if (enough && type == OFTStringList)
        gdal.OGR_F_SetFieldStringList(feature, index, (CSLConstList)strings);
    else if (enough)
        gdal.OGR_F_SetFieldInteger64List(feature, index, (int)count, longs);
    memory_pool_free(&pool);
    return enough;
}

static bool set_field(OGRFeatureH feature, int index, OGRFieldType type, const json_t *value)
{
    bool number = type == OFTInteger || type == OFTInteger64 || type == OFTReal;
    bool list = type == OFTIntegerList || type == OFTInteger64List || type == OFTRealList || type == OFTStringList;
    if (json_is_null(value))
        gdal.OGR_F_SetFieldNull(feature, index);
    else if (json_is_string(value) && type == OFTBinary)
    {
        int size = 0;
        GByte *bytes = gdal.CPLHexToBinary(json_string_value(value), &size);
        gdal.OGR_F_SetFieldBinary(feature, index, size, bytes);
        gdal.VSIFree(bytes);
    }
    else if (json_is_string(value))
        gdal.OGR_F_SetFieldString(feature, index, json_string_value(value));
    else if (json_is_real(value) && number)
        gdal.OGR_F_SetFieldDouble(feature, index, json_real_value(value));
    else if (number && (json_is_integer(value) || json_is_boolean(value)))
        gdal.OGR_F_SetFieldInteger64(feature, index, json_is_true(value) ? 1 : json_integer_value(value));
    else if (json_is_array(value) && list)
        return set_list(feature, index, type, value);
    else
    {
        char *text = json_text_make(value);
        if (text == NULL)
            return false;
        gdal.OGR_F_SetFieldString(feature, index, text);
        free(text);
    }
    return true;
}

static bool set_fields(layer_writer *writer, OGRFeatureH feature, json_t *tree)
{
    OGRFeatureDefnH definition = gdal.OGR_L_GetLayerDefn(writer->layer);
    const json_t *id = json_object_get(tree, ID), *id_field = json_object_get(writer->fields, ID);
    json_t *value;
    const char *name;
    bool set = true;
    if (writer->document->layer != NULL && json_is_integer(id))
        set = gdal.OGR_F_SetFID(feature, json_integer_value(id)) == OGRERR_NONE;
    else if (id != NULL && id_field != NULL)
    {
        int index = (int)json_integer_value(id_field);
        set = set_field(feature, index, gdal.OGR_Fld_GetType(gdal.OGR_FD_GetFieldDefn(definition, index)), id);
    }
    json_object_foreach(json_object_get(tree, "properties"), name, value)
    {
        int index = (int)json_integer_value(json_object_get(writer->fields, name));
        OGRFieldType type = gdal.OGR_Fld_GetType(gdal.OGR_FD_GetFieldDefn(definition, index));
        set = set && set_field(feature, index, type, value);
    }
    return set;
}

static bat_status create_features(layer_writer *writer, bat_error *error)
{
    bat_status status = BAT_OK;
    bool transaction = gdal.OGR_L_StartTransaction(writer->layer) == OGRERR_NONE;
    for (size_t i = 0; i < writer->count && status == BAT_OK; i++)
    {
        OGRFeatureH feature = gdal.OGR_F_Create(gdal.OGR_L_GetLayerDefn(writer->layer));
        bool set = writer->document == NULL || set_fields(writer, feature, writer->document->features[i].tree);
        if (writer->geometries[i] != NULL)
            (void)gdal.OGR_F_SetGeometryDirectly(feature, writer->geometries[i]);
        writer->geometries[i] = NULL;
        char what[64];
        (void)snprintf(what, sizeof what, "GDAL cannot write feature %zu", i);
        if (!set)
            status = error_memory(error, sizeof(json_t));
        else if (gdal.OGR_L_CreateFeature(writer->layer, feature) != OGRERR_NONE || writer->messages.failures > 0)
            status = gdal_fault(&writer->messages, BAT_UNSUPPORTED, error, what);
        gdal.OGR_F_Destroy(feature);
    }
    if (transaction && gdal.OGR_L_CommitTransaction(writer->layer) != OGRERR_NONE && status == BAT_OK)
        status = gdal_fault(&writer->messages, BAT_FILE_ACCESS, error, "GDAL cannot write the features");
    return status;
}

/// Whether features have a field of this name, in either case.
static bool has_field(const layer_writer *writer, const char *name)
{
    const geojson_layer *layer = writer->document != NULL ? writer->document->layer : NULL;
    for (int i = 0; layer != NULL && i < gdal.OGR_FD_GetFieldCount(layer->fields); i++)
        if (strcasecmp(gdal.OGR_Fld_GetNameRef(gdal.OGR_FD_GetFieldDefn(layer->fields, i)), name) == 0)
            return true;
    for (size_t i = 0; layer == NULL && writer->document != NULL && i < writer->document->feature_count; i++)
    {
        json_t *value;
        const char *key;
        json_object_foreach(json_object_get(writer->document->features[i].tree, "properties"), key,
                            value) if (strcasecmp(key, name) == 0) return true;
    }
    return false;
}

static char **layer_options(const layer_writer *writer)
{
    char **options = NULL, decimals[16];
    const geojson_layer *layer = writer->document != NULL ? writer->document->layer : NULL;
    (void)snprintf(decimals, sizeof decimals, "%d", writer->options->precision);
    if (is_driver(writer, "GPKG"))
    {
        const char *ids = layer != NULL && layer->ids[0] != '\0' ? layer->ids : "fid";
        options = gdal.CSLSetNameValue(options, "FID", has_field(writer, ids) ? "batten_fid" : ids);
        options = gdal.CSLSetNameValue(options, "GEOMETRY_NAME", has_field(writer, "geom") ? "batten_geom" : "geom");
    }
    else if (is_driver(writer, "ESRI Shapefile"))
        options = gdal.CSLSetNameValue(options, "ENCODING", "UTF-8");
    else if (is_driver(writer, "GeoJSONSeq"))
        options = gdal.CSLSetNameValue(options, "COORDINATE_PRECISION", decimals);
    return options;
}

/// The name of the layer: that of the input, else of the file.
static void choose_name(const layer_writer *writer, const char *path, char *name, size_t size)
{
    const geojson_document *document = writer->document;
    const char *given = document != NULL ? json_string_value(json_object_get(document->collection, "name")) : NULL;
    const char *base = atomic_name_shown(path), *ending = strrchr(base, '.');
    if (document != NULL && document->layer != NULL)
        given = document->layer->name;
    if (given != NULL)
        (void)snprintf(name, size, "%s", given);
    else
        (void)snprintf(name, size, "%.*s", (int)(ending != NULL ? ending - base : (ptrdiff_t)strlen(base)), base);
    char *inner = ending != NULL && strcasecmp(ending, ".zip") == 0 ? strrchr(name, '.') : NULL;
    if (inner != NULL)
        *inner = '\0';
}

/// Remove a folder that a driver made in place of the file with a hidden name, or beside it, and refuse that.
static bat_status refuse_folder(const char *path, bat_status status, bat_error *error)
{
    char *name = strdup(path);
    if (name == NULL)
        return status == BAT_OK ? error_memory(error, strlen(path)) : status;
    bool found = false;
    for (int pass = 0; pass < 2 && !found; pass++)
    {
        struct stat about;
        char *dot = strrchr(name, '.');
        if (pass == 1 && dot != NULL)
            *dot = '\0';
        found = atomic_is_hidden(name) && stat(name, &about) == 0 && S_ISDIR(about.st_mode);
    }
    if (found)
        (void)gdal.VSIRmdirRecursive(name);
    free(name);
    if (found && status == BAT_OK)
        return ERROR_UNSUPPORTED(error, 0, "GDAL makes a folder here, not a file: take the format's own ending");
    return status;
}

static bat_status create_layer(void *context, const char *path, bat_error *error)
{
    layer_writer *writer = context;
    char name[256];
    choose_name(writer, path, name, sizeof name);
    // A Shapefile would otherwise turn polygons into lines.
    bool lines = (writer->types & ~LINES) == 0, polygons = (writer->types & ~POLYGONS) == 0;
    if (is_driver(writer, "ESRI Shapefile") && !lines && !polygons)
        return ERROR_UNSUPPORTED(error, 0, "a Shapefile holds lines or polygons, not both");
    bat_status status = BAT_OK;
    OGRwkbGeometryType type = choose_type(writer);
    // Polygons that are not valid are written like others.
    gdal.CPLSetThreadLocalConfigOption("LIBKML_STRICT_COMPLIANCE", "NO");
    GDALDatasetH dataset = gdal.GDALCreate(writer->driver, path, 0, 0, 0, GDT_Unknown, NULL);
    if (dataset == NULL)
        return gdal_fault(&writer->messages, BAT_FILE_ACCESS, error, "GDAL cannot make the file");
    char **options = layer_options(writer);
    OGRSpatialReferenceH system = is_global(writer) ? system_by_name("OGC:CRS84") : writer->system;
    writer->layer = gdal.GDALDatasetCreateLayer(dataset, name, system, type, options);
    if (writer->layer == NULL)
        status = gdal_fault(&writer->messages, BAT_UNSUPPORTED, error, "GDAL cannot make the layer");
    if (status == BAT_OK)
        status = create_fields(writer, error);
    if (status == BAT_OK)
        status = create_features(writer, error);
    gdal.CSLDestroy(options);
    gdal.GDALClose(dataset);
    gdal.CPLSetThreadLocalConfigOption("LIBKML_STRICT_COMPLIANCE", NULL);
    if (is_global(writer) && system != NULL)
        gdal.OSRDestroySpatialReference(system);
    if (status == BAT_OK && writer->messages.failures > 0)
        status = gdal_fault(&writer->messages, BAT_FILE_ACCESS, error, "GDAL cannot write the file");
    return refuse_folder(path, status, error);
}

/// Find the system of the set and, where the format needs it, the transformation to WGS 84.
static bat_status choose_system(layer_writer *writer, bat_error *error)
{
    bool sphere = writer->set->space->point_dim == 3;
    const char *name = writer->set->attributes != NULL ? writer->set->attributes->crs : NULL;
    if (writer->options->crs != NULL)
        name = writer->options->crs;
    if (is_global(writer) && !sphere && name == NULL)
        return ERROR_ARGUMENT(error,
                              "%s holds longitude and latitude, but the curves lie in a plane without a coordinate system",
                              writer->driver_name);
    writer->system = name != NULL ? system_by_name(name) : sphere ? system_by_name("EPSG:4326") : NULL;
    if (writer->system == NULL && (name != NULL || sphere))
        return gdal_fault(&writer->messages, BAT_UNSUPPORTED, error, "there is no such coordinate system");
    if (writer->options->crs != NULL && sphere && !system_is_degrees(writer->system))
        return ERROR_ARGUMENT(error, "the curves have longitudes and latitudes, which are no coordinates in %.80s", name);
    if (!is_global(writer) || name == NULL)
        return BAT_OK;
    OGRSpatialReferenceH wgs84 = system_by_name("OGC:CRS84");
    writer->to_wgs84 = gdal.OCTNewCoordinateTransformation(writer->system, wgs84);
    gdal.OSRDestroySpatialReference(wgs84);
    return writer->to_wgs84 != NULL
               ? BAT_OK
               : gdal_fault(&writer->messages, BAT_UNSUPPORTED, error, "the coordinate system cannot be transformed");
}

/// Whether one of a driver's endings is that of a path.
static bool has_ending(GDALDriverH driver, const char *path)
{
    const char *endings = gdal.GDALGetMetadataItem(driver, GDAL_DMD_EXTENSIONS, NULL);
    char **list = endings != NULL ? gdal.CSLTokenizeString2(endings, " ", 0) : NULL;
    bool found = false;
    for (char **ending = list; ending != NULL && *ending != NULL; ending++)
    {
        size_t length = strlen(path), size = strlen(*ending);
        found = found || (length > size && path[length - size - 1] == '.' && strcasecmp(path + length - size, *ending) == 0);
    }
    gdal.CSLDestroy(list);
    return found;
}

static bool can_create(GDALDriverH driver)
{
    return driver != NULL && gdal.GDALGetMetadataItem(driver, GDAL_DCAP_VECTOR, NULL) != NULL &&
           gdal.GDALGetMetadataItem(driver, GDAL_DCAP_CREATE, NULL) != NULL;
}

static bat_status choose_driver(layer_writer *writer, const char *drivers, const char *path, bat_error *error)
{
    char **names = drivers != NULL ? gdal.CSLTokenizeString2(drivers, ",", 0) : NULL;
    for (char **name = names; name != NULL && *name != NULL; name++)
    {
        GDALDriverH driver = gdal.GDALGetDriverByName(*name);
        if (can_create(driver) && (writer->driver == NULL || has_ending(driver, path)))
            writer->driver = driver;
    }
    gdal.CSLDestroy(names);
    for (int i = 0; drivers == NULL && writer->driver == NULL && i < gdal.GDALGetDriverCount(); i++)
    {
        GDALDriverH driver = gdal.GDALGetDriver(i);
        if (can_create(driver) && has_ending(driver, path))
            writer->driver = driver;
    }
    if (!can_create(writer->driver))
        return ERROR_UNSUPPORTED(error, 0, "GDAL has no driver here that writes %s",
                                 drivers != NULL ? drivers : "files of this ending");
    writer->driver_name = gdal.GDALGetDriverShortName(writer->driver);
    return BAT_OK;
}

/// Write a layer or a compressed text into a file.
typedef bat_status file_writer(void *context, const char *path, bat_error *error);

/// Write a file under a hidden name, and put it and its companions into their places.
static bat_status write_whole(file_writer *write, void *context, const char *path, bat_error *error)
{
    if (strcmp(path, "-") == 0 || strncmp(path, "/dev/", 5) == 0)
        return ERROR_UNSUPPORTED(error, 0, "formats of GDAL go to files, not to %s",
                                 path[0] == '-' ? "standard output" : "devices");
    if (strncmp(path, "/vsi", 4) == 0)
        return ERROR_UNSUPPORTED(error, 0, "paths that begin with /vsi are read, not written");
    if (atomic_is_hidden(path))
        return write(context, path, error);
    bat_outputs *outputs;
    const char *hidden;
    bat_status status = bat_outputs_make(&outputs, error);
    if (status != BAT_OK)
        return status;
    status = bat_outputs_add(outputs, path, &hidden, error);
    if (status == BAT_OK)
        status = write(context, hidden, error);
    if (status == BAT_OK)
        status = bat_outputs_commit(outputs, error);
    bat_outputs_free(outputs);
    if (status != BAT_OK && error != NULL)
        error->index = BAT_NO_INDEX; // of the outputs
    return status;
}

bat_status gis_write(const char *path, const char *drivers, const bat_curve_set *set, const bat_curve_write_options *options,
                     bat_error *error)
{
    const bat_curve_attributes *attributes = set->attributes;
    bool features = attributes_are_geojson(attributes);
    layer_writer writer = {.set = set, .options = options, .document = features ? attributes->remainder.content : NULL};
    bat_status status = gdal_begin(&writer.messages, error);
    if (status != BAT_OK)
        return status;
    writer.fields = json_object();
    if (writer.fields == NULL)
        status = error_memory(error, sizeof *writer.fields);
    if (status == BAT_OK)
        status = choose_driver(&writer, drivers, path, error);
    if (status == BAT_OK)
        status = choose_system(&writer, error);
    if (status == BAT_OK)
        status = geojson_each(set, options->given, options->precision, take_geometry, &writer, error);
    if (status == BAT_OK)
        status = write_whole(create_layer, &writer, path, error);
    for (size_t i = 0; i < writer.count; i++)
        gdal.OGR_G_DestroyGeometry(writer.geometries[i]);
    free(writer.geometries);
    if (writer.to_wgs84 != NULL)
        gdal.OCTDestroyCoordinateTransformation(writer.to_wgs84);
    if (writer.system != NULL)
        gdal.OSRDestroySpatialReference(writer.system);
    json_decref(writer.fields);
    gdal_end();
    return status;
}

static bat_status write_compressed(void *context, const char *path, bat_error *error)
{
    const text_buffer *text = context;
    gdal_messages messages;
    bat_status status = gdal_begin(&messages, error);
    if (status != BAT_OK)
        return status;
    char *spelled = gdal_path(path);
    VSILFILE *file = spelled != NULL ? gdal.VSIFOpenL(spelled, "wb") : NULL;
    if (spelled == NULL)
        status = error_memory(error, strlen(path));
    else if (file == NULL)
        status = gdal_fault(&messages, BAT_FILE_ACCESS, error, "cannot write");
    bool written = file != NULL && gdal.VSIFWriteL(text->data, 1, text->size, file) == text->size;
    bool closed = file != NULL && gdal.VSIFCloseL(file) == 0;
    if (status == BAT_OK && (!written || !closed || messages.failures > 0))
        status = gdal_fault(&messages, BAT_FILE_ACCESS, error, "cannot write");
    free(spelled);
    gdal_end();
    return status;
}

bat_status gis_text_write(const char *path, const text_buffer *text, bat_error *error)
{
    text_buffer bytes = *text;
    return write_whole(write_compressed, &bytes, path, error);
}
