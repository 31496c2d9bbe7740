#include "io/curve/geojson.h"

#include "base/bisect.h"

#include <limits.h>
#include <strings.h>

bool geojson_document_reserve(geojson_document *document, size_t polygons, size_t curves)
{
    return ARRAY_GROW(document->polygons, document->polygon_capacity, polygons) &&
           ARRAY_GROW(document->origins, document->curve_capacity, curves);
}

const char *const GEOMETRY_NAMES[GEOMETRY_KINDS] = {[GEOMETRY_POINT] = "Point",
                                                    [GEOMETRY_LINE] = "LineString",
                                                    [GEOMETRY_POLYGON] = "Polygon",
                                                    [GEOMETRY_POINTS] = "MultiPoint",
                                                    [GEOMETRY_LINES] = "MultiLineString",
                                                    [GEOMETRY_POLYGONS] = "MultiPolygon",
                                                    [GEOMETRY_COLLECTION] = "GeometryCollection"};

geometry_kind geojson_kind(const json_t *geometry)
{
    const char *type = json_string_value(json_object_get(geometry, "type"));
    int kind = GEOMETRY_POINT;
    while (type != NULL && kind < GEOMETRY_KINDS && strcmp(type, GEOMETRY_NAMES[kind]) != 0)
        kind++;
    return type != NULL && kind < GEOMETRY_KINDS ? (geometry_kind)kind : GEOMETRY_UNKNOWN;
}

void geojson_document_free(geojson_document *document)
{
    for (size_t i = 0; i < document->feature_count; i++)
        json_decref(document->features[i].tree);
    json_decref(document->collection);
    free(document->features);
    free(document->geometries);
    free(document->polygons);
    free(document->origins);
    if (document->layer != NULL)
        document->layer_free(document->layer);
    free(document->column);
    if (document->gpx != NULL)
        document->gpx_free(document->gpx);
    *document = (geojson_document){0};
}

static void free_content(void *content)
{
    geojson_document_free(content);
    free(content);
}

void geojson_append_place(char *text, size_t size, const char *what, size_t index)
{
    size_t used = strlen(text);
    if (index != BAT_NO_INDEX)
        (void)snprintf(text + used, size - used, "%s%s %zu", used > 0 ? ", " : "", what, index);
}

void geojson_append_id(char *text, size_t size, const json_t *feature)
{
    const json_t *id = json_object_get(feature, "id");
    size_t used = strlen(text);
    if (json_is_string(id))
        (void)snprintf(text + used, size - used, " (id '%.60s')", json_string_value(id));
    else if (json_is_integer(id))
        (void)snprintf(text + used, size - used, " (id %lld)", (long long)json_integer_value(id));
    else if (json_is_real(id))
        (void)snprintf(text + used, size - used, " (id %.15g)", json_real_value(id));
}

/// The feature that a curve belongs to. Features are in the order of their curves.
static const geojson_feature *feature_of(const geojson_document *document, size_t curve)
{
    size_t end = 1, high = document->feature_count;
    BISECT(end, high, middle, document->features[middle].curve <= curve)
    // Of features with the same first curve, all but the last have no curves.
    return end <= document->feature_count ? &document->features[end - 1] : NULL;
}

static size_t line_of_feature(const void *content, size_t curve)
{
    const geojson_feature *feature = feature_of(content, curve);
    return feature != NULL ? feature->line : 0;
}

/// Write "feature 6 (id 'ATA'), polygon 7, ring 0".
static void place_of_curve(const void *content, size_t curve, char *text, size_t size)
{
    const geojson_document *document = content;
    const geojson_feature *feature = feature_of(document, curve);
    text[0] = '\0';
    if (feature == NULL || feature->geometry_count == 0 || curve >= document->curve_count)
        return;
    size_t index = 0;
    while (index + 1 < feature->geometry_count &&
           document->geometries[feature->geometry + index + 1].curve <= curve - feature->curve)
        index++;
    const geojson_geometry *geometry = &document->geometries[feature->geometry + index];
    const stitch_origin *origin = &document->origins[curve];
    if (document->collection != NULL)
    {
        geojson_append_place(text, size, "feature", (size_t)(feature - document->features));
        geojson_append_id(text, size, feature->tree);
    }
    bool polygons = geometry->polygon_count > 0;
    geojson_append_place(text, size, "geometry", feature->geometry_count > 1 ? index : BAT_NO_INDEX);
    geojson_append_place(text, size, polygons ? "polygon" : "line", origin->part);
    geojson_append_place(text, size, "ring", polygons ? origin->ring : BAT_NO_INDEX);
}

bool geojson_document_keep(geojson_document *document, bat_curve_attributes *attributes)
{
    size_t count = 0;
    for (size_t i = 0; i < document->feature_count; i++)
        count += document->features[i].curve_count;
    curve_ring *rings = malloc((count + 1) * sizeof *rings);
    geojson_document *kept = malloc(sizeof *kept);
    if (rings == NULL || kept == NULL)
    {
        free(rings);
        free(kept);
        return false;
    }
    // The polygon and the feature of each curve, for bat_curve_set_polygon().
    for (size_t i = 0; i < count; i++)
        rings[i] = (curve_ring){BAT_NO_INDEX, BAT_NO_INDEX};
    for (size_t i = 0; i < document->feature_count; i++)
    {
        const geojson_feature *feature = &document->features[i];
        for (size_t g = 0; g < feature->geometry_count; g++)
        {
            const geojson_geometry *geometry = &document->geometries[feature->geometry + g];
            size_t curve = feature->curve + geometry->curve;
            for (size_t p = 0; p < geometry->polygon_count; p++)
            {
                size_t polygon = feature->polygon + geometry->polygon + p;
                for (size_t r = 0; r < document->polygons[polygon].rings; r++)
                    rings[curve++] = (curve_ring){polygon, i};
            }
        }
    }
    attributes->rings = rings;
    attributes->ring_count = count;
    *kept = *document;
    *document = (geojson_document){0};
    attributes->remainder = (file_remainder){kept, free_content, line_of_feature, place_of_curve};
    return true;
}

/// What follows `prefix` in either case; null when the text begins differently.
static const char *after(const char *text, const char *prefix)
{
    size_t length = strlen(prefix);
    return strncasecmp(text, prefix, length) == 0 ? text + length : NULL;
}

/// What follows the last separator of a name after a prefix: the code, after a version.
static const char *code_of(const char *name)
{
    static const struct
    {
        const char *prefix;
        char separator;
    } forms[] = {{"urn:ogc:def:crs:EPSG:", ':'},
                 {"urn:x-ogc:def:crs:EPSG:", ':'},
                 {"EPSG:", ':'},
                 {"http://www.opengis.net/def/crs/EPSG/", '/'},
                 {"https://www.opengis.net/def/crs/EPSG/", '/'},
                 {"http://www.opengis.net/gml/srs/epsg.xml#", '#'}};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
    {
        if (after(name, forms[i].prefix) == NULL)
            continue;
        const char *code = strrchr(name, forms[i].separator) + 1;
        size_t digits = strspn(code, "0123456789");
        return digits > 0 && code[digits] == '\0' ? code : NULL;
    }
    return NULL;
}

char *crs_short_name(const char *name)
{
    static const char *const global[] = {"urn:ogc:def:crs:OGC:1.3:CRS84",
                                         "urn:ogc:def:crs:OGC::CRS84",
                                         "urn:ogc:def:crs:OGC:2:84",
                                         "http://www.opengis.net/def/crs/OGC/1.3/CRS84",
                                         "https://www.opengis.net/def/crs/OGC/1.3/CRS84",
                                         "OGC:CRS84",
                                         "CRS:84",
                                         "CRS84"};
    for (size_t i = 0; i < sizeof global / sizeof *global; i++)
        if (strcasecmp(name, global[i]) == 0)
            return strdup("OGC:CRS84");
    const char *code = code_of(name);
    if (code == NULL)
        return strdup(name);
    size_t size = strlen(code) + sizeof "EPSG:";
    char *text = malloc(size);
    if (text != NULL)
        (void)snprintf(text, size, "EPSG:%s", code);
    return text;
}

bool crs_is_default(const char *short_name)
{
    return strcmp(short_name, "OGC:CRS84") == 0 || strcmp(short_name, "EPSG:4326") == 0 ||
           strcmp(short_name, "EPSG:4979") == 0;
}

bool crs_is_geographic(const char *short_name)
{
    static const char *const others[] = {"EPSG:4258", "EPSG:4269", "EPSG:4283", "EPSG:7844",
                                         "EPSG:6668", "EPSG:4490", "EPSG:4167"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(short_name, others[i]) == 0)
            return true;
    return crs_is_default(short_name);
}

void crs_append(const char *short_name, text_buffer *text)
{
    char urn[CRS_NAME_SIZE + 32];
    const char *code = after(short_name, "EPSG:");
    (void)snprintf(urn, sizeof urn, "%s%s", code != NULL ? "urn:ogc:def:crs:EPSG::" : "", code != NULL ? code : short_name);
    text_append_string(text, "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":");
    json_text_string(text, urn, strlen(urn));
    text_append_string(text, "}}");
}

// Properties

static json_int_t kind_of_value(const json_t *value)
{
    if (json_is_integer(value))
        return json_integer_value(value) >= INT_MIN && json_integer_value(value) <= INT_MAX ? VALUE_INTEGER : VALUE_LONG;
    if (json_is_null(value))
        return 0;
    return json_is_boolean(value)  ? VALUE_BOOLEAN
           : json_is_real(value)   ? VALUE_REAL
           : json_is_string(value) ? VALUE_STRING
                                   : VALUE_TREE;
}

static bool add_kind(json_t *kinds, const char *name, const json_t *value)
{
    json_int_t known = json_integer_value(json_object_get(kinds, name));
    return json_object_set_new(kinds, name, json_integer(known | kind_of_value(value))) == 0;
}

static const char ID[] = "id";

json_t *geojson_property_kinds(const geojson_document *document)
{
    json_t *kinds = json_object(), *ids = json_object();
    bool kept = kinds != NULL && ids != NULL;
    for (size_t i = 0; document != NULL && kept && i < document->feature_count; i++)
    {
        json_t *tree = document->features[i].tree, *value;
        const char *name;
        json_object_foreach(json_object_get(tree, "properties"), name, value) kept = kept && add_kind(kinds, name, value);
        if (json_object_get(tree, ID) != NULL)
            kept = kept && add_kind(ids, ID, json_object_get(tree, ID));
    }
    kept = kept && json_object_update_missing(kinds, ids) == 0;
    json_decref(ids);
    if (kept)
        return kinds;
    json_decref(kinds);
    return NULL;
}
