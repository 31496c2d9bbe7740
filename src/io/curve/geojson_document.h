#ifndef IO_CURVE_GEOJSON_DOCUMENT_H
#define IO_CURVE_GEOJSON_DOCUMENT_H

#include "curve/curve_attributes.h"
#include "io/curve/stitch.h"

#include <jansson.h>

/// A GeoJSON geometry that became curves. In the stored tree its "coordinates" are its index among the geometries of its
/// feature.
typedef struct geojson_geometry
{
    size_t curve;         ///< its first curve, within the feature
    size_t curve_count;   ///< the number of its lines or rings
    size_t polygon;       ///< its first polygon, within the feature
    size_t polygon_count; ///< 0 for lines
} geojson_geometry;

/// A feature of a collection, or the single feature or geometry of a file.
typedef struct geojson_feature
{
    json_t *tree;
    size_t line;                     ///< the line where it begins, counted from 1; 0 when unknown
    size_t curve, curve_count;       ///< its curves in the set
    size_t geometry, geometry_count; ///< its geometries in geojson_document::geometries
    size_t polygon, polygon_count;   ///< its polygons in geojson_document::ring_counts
} geojson_feature;

/// A GeoJSON file without the coordinates of lines and polygons.
typedef struct geojson_document
{
    json_t *collection; ///< the FeatureCollection with an empty "features"; null when the file is one feature or geometry
    geojson_feature *features;
    size_t feature_count, feature_capacity;
    geojson_geometry *geometries;
    size_t geometry_count, geometry_capacity;
    size_t *ring_counts; ///< for each polygon
    signed char *poles;  ///< for each polygon, as in stitch_geometry
    size_t polygon_count, polygon_capacity, pole_capacity;
    stitch_origin *origins; ///< for each curve
    size_t curve_count, curve_capacity;
    bool measures; ///< the third number of a position is a measure and no altitude; of a layer without altitudes
    struct geojson_layer *layer; ///< what the room gis keeps of the layer that the features are from; null for none
    void (*layer_free)(struct geojson_layer *layer);
} geojson_document;

/// Make room for the polygons and the curves of a document. False when out of memory.
bool geojson_document_reserve(geojson_document *document, size_t polygons, size_t curves);

/// Write " (id 'ATA')" or " (id 17)" for a feature with an id, else nothing. Returns `text`.
const char *geojson_feature_id(const json_t *tree, char *text, size_t size);

void geojson_document_free(geojson_document *document);

/// Give a document to the attributes, which free it; the document is empty then. False when out of memory.
bool geojson_document_keep(geojson_document *document, bat_curve_attributes *attributes);

#endif
