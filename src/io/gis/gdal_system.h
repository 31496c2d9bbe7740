#ifndef IO_GIS_GDAL_SYSTEM_H
#define IO_GIS_GDAL_SYSTEM_H

#include "io/gis/gdal.h"

#include "curve/curve_attributes.h"

/// @file
/// Coordinate systems.

/// The system of a name, in the order of longitude before latitude and east before north: "EPSG:25833", a URN, or WKT. Null,
/// with a message of GDAL, for none.
OGRSpatialReferenceH system_by_name(const char *name);

/// The name of a system: its code, as in "EPSG:25833", else WKT. Null when out of memory.
char *system_name(OGRSpatialReferenceH system);

/// Whether the coordinates are longitude and latitude in degrees from Greenwich.
bool system_is_degrees(OGRSpatialReferenceH system);

/// Whether a layer stores the two coordinates in the reverse of the order above.
bool system_is_swapped(OGRSpatialReferenceH system);

#endif
