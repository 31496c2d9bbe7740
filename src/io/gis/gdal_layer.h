#ifndef IO_GIS_GDAL_LAYER_H
#define IO_GIS_GDAL_LAYER_H

#include "io/gis/gdal.h"

#include "io/curve/geojson.h"

/// @file
/// What a GeoJSON document keeps of the layer it was read from, so that it can be written again.
typedef struct geojson_layer
{
    char *name;             ///< null for none
    char *ids;              ///< the column of the features' numbers; "" for none
    OGRFeatureDefnH fields; ///< shared with GDAL
    bool any_geometry;      ///< the layer takes geometries of all types
} geojson_layer;

#endif
