#ifndef BATTEN_CURVE_SET_H
#define BATTEN_CURVE_SET_H

#include "batten/curve.h"

BAT_C_BEGIN

/// @file
/// Several curves in one space, with what a file tells beyond their points.

/// The formats of files of curves.
typedef enum bat_curve_format
{
    BAT_CURVE_FORMAT_AUTO, ///< by the file's ending; failing that by the content (reading) or by where the set came from
                           ///< (writing)
    BAT_CURVE_FORMAT_CSV,
    BAT_CURVE_FORMAT_GEOJSON,
    BAT_CURVE_FORMAT_GEOJSON_LINES,    ///< a GeoJSON feature or geometry on each line
    BAT_CURVE_FORMAT_GEOJSON_SEQUENCE, ///< the same after record separators, RFC 8142
    BAT_CURVE_FORMAT_OBJ,
    BAT_CURVE_FORMAT_TUM,   ///< poses in time, as the TUM benchmark writes them: timestamp tx ty tz qx qy qz qw; the space
                            ///< "rigid"
    BAT_CURVE_FORMAT_EUROC, ///< the same as the EuRoC data set writes them: nanoseconds, x, y, z, qw, qx, qy, qz, with names
    BAT_CURVE_FORMAT_KITTI, ///< poses as the KITTI benchmark writes them: matrices of 3 rows and 4 columns, without times
    BAT_CURVE_FORMAT_BVH,   ///< motion capture: a curve of poses for each joint; read only
    BAT_CURVE_FORMAT_GPX,
    BAT_CURVE_FORMAT_WKT,     ///< well-known text, a geometry after the other
    BAT_CURVE_FORMAT_WKT_CSV, ///< a table with a column of well-known text
    BAT_CURVE_FORMAT_TOPOJSON,
    BAT_CURVE_FORMAT_GPKG, ///< GeoPackage; this and the following need GDAL
    BAT_CURVE_FORMAT_SHP,  ///< Shapefile
    BAT_CURVE_FORMAT_KML,
    BAT_CURVE_FORMAT_FGB, ///< FlatGeobuf
    BAT_CURVE_FORMAT_DXF, ///< drawings; always in the plane
    BAT_CURVE_FORMAT_GDAL ///< whatever GDAL recognizes
} bat_curve_format;

/// What a file tells beyond its curves: GeoJSON features with their properties, CSV column names. Opaque, shared by
/// counting.
typedef struct bat_curve_attributes bat_curve_attributes;

/// Curves that belong together, such as those of one file with what else survives from it. All zero: empty.
typedef struct bat_curve_set
{
    bat_space *space;  ///< where all the curves live; owned
    bat_curve *curves; ///< `count` of them, in the order of the file; each one's `space` is the set's; owned
    size_t count;
    bat_curve_attributes *attributes; ///< what the file says beside the curves; null when there is no file; owned (shared)
    size_t *lines; ///< the line of the file that each point stands on, curve after curve; null when unknown; owned
} bat_curve_set;

/// Free what a set owns and make it empty. Does nothing to a set that is empty already.
BAT_API void bat_curve_set_free(bat_curve_set *set);

/// Move one curve that did not come from a file into a set of its own, to write it. `curve` is left empty.
/// @return BAT_OK or BAT_NO_MEMORY; on failure `curve` keeps its points
BAT_API bat_status bat_curve_set_single(bat_curve *curve, bat_curve_set *set, bat_error *error);

/// Make a set of `count` curves that did not come from a file. They must live in one kind of space, the first one's, which
/// is copied (its `parameters` are not, and must outlive the set).
///
/// @param curves an array from malloc(); the set takes it and frees it
/// @param count  at least 1
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; on failure the caller keeps the array
BAT_API bat_status bat_curve_set_take(bat_curve *curves, size_t count, bat_curve_set *set, bat_error *error);

/// Make a set of changed curves, one for each curve of `source` and in the same order, that keeps the source's attributes.
///
/// @param curves an array of source->count curves from malloc(), in the source's kind of space; the result takes it and
/// frees
///               it, and makes every curve's `space` its own copy of the source's
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; on failure the caller keeps the array
BAT_API bat_status bat_curve_set_like(const bat_curve_set *source, bat_curve *curves, bat_curve_set *result,
                                      bat_error *error);

/// Whether the file has features, as geographic files and drawings have.
BAT_API bool bat_curve_set_has_features(const bat_curve_set *set);

/// The line of the file, counted from 1, that a point was read from; for GeoJSON the line that its feature begins on. 0 when
/// it is not known.
BAT_API size_t bat_curve_set_line(const bat_curve_set *set, size_t curve, size_t point);

/// Describe the place of a curve in its file, for messages: "feature 6 (id 'ATA'), polygon 7, ring 0, near 179.99281,
/// 64.97433" for GeoJSON, else "curve 7", or nothing for a set of one curve. Indices count from 0, as in the file.
///
/// @param point its coordinates follow "near" (degrees on the sphere), since points of a file can be joined or dropped;
///              BAT_NO_INDEX for none
/// @param text  receives at most `size` bytes with a final zero; 160 suffice
BAT_API void bat_curve_set_place(const bat_curve_set *set, size_t curve, size_t point, char *text, size_t size);

/// The whole seconds since 1970 that the times of a set count from: those in its channel plus this are the times of the
/// file, with all of their digits. 0 where a double holds these: for times of less than eleven days, or of at most 15
/// digits.
BAT_API int64_t bat_curve_set_time_origin(const bat_curve_set *set);

/// What the reader guessed or changed, a short sentence each: the meaning of columns, dropped points, joined polygons.
/// @param index from 0 on
/// @return null past the last; the text lives as long as the attributes
BAT_API const char *bat_curve_set_note(const bat_curve_set *set, size_t index);

/// The polygon and the feature that a curve belongs to. The first ring of a polygon is its outer one; the rings of a polygon
/// follow each other. Where a format has no polygons, every closed curve of a file in degrees is one of its own.
/// @param polygon,feature receive indices, counted over the file
/// @return false when the curve bounds no polygon, or `curve` is out of range
BAT_API bool bat_curve_set_polygon(const bat_curve_set *set, size_t curve, size_t *polygon, size_t *feature);

BAT_C_END

#endif
