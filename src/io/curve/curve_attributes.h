#ifndef IO_CURVE_CURVE_ATTRIBUTES_H
#define IO_CURVE_CURVE_ATTRIBUTES_H

#include "batten/curve_file.h"

#include "io/curve/point_form.h"

#include <jansson.h>
#include <stdatomic.h>

/// The columns of a CSV file that had a header.
typedef struct csv_columns
{
    char **names;   ///< one block: the pointers, then the text; null without a header
    size_t *places; ///< what each column holds: coordinate `place`, or channel `place - coordinates`; null without a header
    size_t count;
    bool degrees;           ///< the coordinates are longitude and latitude
    const point_form *form; ///< how points are written, where not by their coordinates as they are
    size_t altitude;        ///< the channel that is the altitude, or BAT_NO_INDEX
} csv_columns;

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

struct bat_curve_attributes
{
    atomic_size_t owners;
    bat_curve_format format; ///< what the file was
    csv_columns csv;
    geojson_document geojson;
};

/// Attributes with one owner.
bat_curve_attributes *attributes_new(bat_curve_format format);
void attributes_share(bat_curve_attributes *attributes);
/// Give up one ownership, and free the attributes when it was the last. Null is allowed.
void attributes_release(bat_curve_attributes *attributes);

void csv_columns_free(csv_columns *columns);
void geojson_document_free(geojson_document *document);

#endif
