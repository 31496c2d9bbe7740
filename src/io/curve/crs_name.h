#ifndef IO_CURVE_CRS_NAME_H
#define IO_CURVE_CRS_NAME_H

#include <stdbool.h>

/// @file
/// Names of coordinate reference systems, as GeoJSON files of 2008 and programs spell them.

/// The short form of a name: "EPSG:25833" for "urn:ogc:def:crs:EPSG::25833", "EPSG:25833",
/// "http://www.opengis.net/def/crs/EPSG/0/25833" and "http://www.opengis.net/gml/srs/epsg.xml#25833", "OGC:CRS84" for the
/// spellings of CRS84; else a copy. Release it with free(); null when out of memory.
char *crs_short_name(const char *name);

/// Whether a short name is of longitude and latitude in degrees: CRS84, WGS 84 (EPSG:4326 and 4979), and the geographic
/// systems ETRS89, NAD83, GDA94, GDA2020, JGD2011, CGCS2000 and NZGD2000, which differ from it by metres. GeoJSON has the
/// longitude first in all of them.
bool crs_is_geographic(const char *short_name);

/// Whether a short name is of WGS 84, the system of RFC 7946, which needs no member "crs".
bool crs_is_default(const char *short_name);

/// The URN of a short name, "urn:ogc:def:crs:EPSG::25833"; other names as they are. Writes at most `size` bytes.
void crs_urn(const char *short_name, char *text, unsigned long size);

#endif
