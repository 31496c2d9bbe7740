#ifndef IO_CURVE_GEOJSON_DOCUMENT_H
#define IO_CURVE_GEOJSON_DOCUMENT_H

#include "curve/curve_attributes.h"

#include <jansson.h>

/// A GeoJSON geometry whose positions became curves. In the tree that stays, its "coordinates" are the geometry's index
/// among those of its feature.
typedef struct geojson_geometry
{
    size_t curve;         ///< its first curve, among those of its feature
    size_t curve_count;   ///< its lines or, for polygons, its rings
    size_t polygon;       ///< its first polygon, among those of its feature
    size_t polygon_count; ///< 0 for lines
} geojson_geometry;

/// A feature of a collection; or the whole of a file that is a single feature or geometry.
typedef struct geojson_feature
{
    json_t *tree;
    size_t line;                     ///< where it begins in the file, counted from 1; 0 when unknown
    size_t curve, curve_count;       ///< its curves in the set
    size_t geometry, geometry_count; ///< its geometries in geojson_document::geometries
    size_t polygon, polygon_count;   ///< its polygons in geojson_document::ring_counts
} geojson_feature;

/// What is left of a GeoJSON file when the lines and polygons are taken out.
typedef struct geojson_document
{
    json_t *collection; ///< the FeatureCollection, "features" being empty; null when the file is one feature or geometry
    geojson_feature *features;
    size_t feature_count, feature_capacity;
    geojson_geometry *geometries;
    size_t geometry_count, geometry_capacity;
    size_t *ring_counts; ///< of each polygon
    size_t polygon_count, polygon_capacity;
} geojson_document;

void geojson_document_free(geojson_document *document);

/// Give a document to the attributes, which free it; the document is empty then. False when out of memory.
bool geojson_document_keep(geojson_document *document, bat_curve_attributes *attributes);

#endif
