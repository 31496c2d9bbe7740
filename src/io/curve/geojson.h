#pragma once

#include "curve/curve_attributes.h"
#include "io/common/json.h"
#include "io/curve/builder.h"
#include "io/curve/stitch.h"

/// @file
/// Parts of the GeoJSON reader: positions for messages, coordinates cut out of the text, features, geometries.

/// The types of geometries, with the codes of "Simple feature access" (OGC 06-103r4), which GDAL has, too.
typedef enum geometry_kind
{
    GEOMETRY_UNKNOWN,
    GEOMETRY_POINT,
    GEOMETRY_LINE,
    GEOMETRY_POLYGON,
    GEOMETRY_POINTS,
    GEOMETRY_LINES,
    GEOMETRY_POLYGONS,
    GEOMETRY_COLLECTION,
    GEOMETRY_KINDS
} geometry_kind;

/// Their names in GeoJSON; null for GEOMETRY_UNKNOWN.
extern const char *const GEOMETRY_NAMES[GEOMETRY_KINDS];
geometry_kind geojson_kind(const json_t *geometry);

/// A geometry that became curves. In the tree its "coordinates" are its index among the feature's geometries.
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
    size_t polygon, polygon_count;   ///< its polygons in geojson_document::polygons
} geojson_feature;

/// A GeoJSON file without the coordinates of lines and polygons.
typedef struct geojson_document
{
    json_t *collection; ///< the FeatureCollection with an empty "features"; null when the file is one feature or geometry
    geojson_feature *features;
    size_t feature_count, feature_capacity;
    geojson_geometry *geometries;
    size_t geometry_count, geometry_capacity;
    stitch_polygon *polygons;
    size_t polygon_count, polygon_capacity;
    stitch_origin *origins; ///< for each curve
    size_t curve_count, curve_capacity;
    bool measures; ///< the third number of a position is a measure and no altitude; of a layer without altitudes
    struct geojson_layer *layer; ///< what the room gis keeps of the layer that the features are from; null for none
    void (*layer_free)(struct geojson_layer *layer);
    char *column;        ///< the name of the column of geometries in a table; null for none, and for a table without names
    size_t column_place; ///< among the columns
    bool binary;         ///< the table has well-known binary
    struct gpx_source *gpx; ///< the text of a GPX file; null for none
    void (*gpx_free)(struct gpx_source *source);
} geojson_document;

/// Make room for the polygons and the curves of a document. False when out of memory.
bool geojson_document_reserve(geojson_document *document, size_t polygons, size_t curves);

/// Append "WHAT INDEX", after a comma where there is a text; nothing for BAT_NO_INDEX.
void geojson_append_place(char *text, size_t size, const char *what, size_t index);
/// Append " (id 'ATA')" or " (id 17)" for a feature with an id, else nothing.
void geojson_append_id(char *text, size_t size, const json_t *feature);

void geojson_document_free(geojson_document *document);

/// The kinds of values of a property, a bit each.
enum
{
    VALUE_BOOLEAN = 1,
    VALUE_INTEGER = 2,
    VALUE_LONG = 4,
    VALUE_REAL = 8,
    VALUE_STRING = 16,
    VALUE_TREE = 32
};

/// The names of the properties of all features, each with the kinds of its values. A feature's id is one too, unless there
/// is one of that name. Null when out of memory; a null document has none.
json_t *geojson_property_kinds(const geojson_document *document);

/// Give a document to the attributes, which free it; the document is empty then. False when out of memory.
bool geojson_document_keep(geojson_document *document, bat_curve_attributes *attributes);

/// The position of a reader in the file, for messages; BAT_NO_INDEX where it does not apply.
typedef struct geojson_place
{
    size_t feature, geometry, polygon, part, position;
    size_t line; ///< the line where the feature begins; 0 when unknown
} geojson_place;

/// The text of a feature or geometry without the coordinates of its lines and polygons. Each array of coordinates is
/// replaced by its index, [0], [1], …, and its line breaks. All zero: empty. It can be reused for the next text.
typedef struct geojson_extraction
{
    text_buffer text;
    const char **arrays; ///< the start of each array in the original text; the arrays are valid JSON and hold only numbers
    size_t count, capacity;
} geojson_extraction;

/// What a reader changed, for notes: counts, and the place of the first.
typedef struct geojson_findings
{
    size_t repeats;    ///< repeated positions that were dropped
    size_t degenerate; ///< lines and rings with too few different points that were dropped
    size_t unchanged;  ///< geometries that were not converted
    size_t wide;       ///< edges of more than 180 degrees of longitude
    stitch_report lines, polygons;
    char first_repeat[120], first_degenerate[120], first_unchanged[120], first_join[120], first_pole[120], first_wide[120];
} geojson_findings;

/// The state of a reader that converts features to curves. Each thread has its own.
typedef struct geojson_reader
{
    int closed;                               ///< as in bat_curve_read_options
    bool strict;                              ///< as in bat_curve_read_options
    bool degrees;                             ///< positions are longitudes and latitudes, else plain coordinates
    double *positions;                        ///< of the current geometry with degrees: longitude and latitude of each point
    size_t position_count, position_capacity; ///< the capacity in doubles
    bool aliases; ///< neighbouring positions of the current geometry with different numbers are one point
    geojson_findings findings;
    char *crs;        ///< the short name of the coordinate reference system; null when the file names none
    bool plane_crs;   ///< the space is the plane because of that system
    bool unnamed_crs; ///< there is a member "crs" without a name
    curve_builder builder;
    geojson_document document;
    geojson_place place;
    bool rings;          ///< the parts of the current geometry are rings
    bool multiple;       ///< the current geometry is a MultiLineString or MultiPolygon
    size_t number_count; ///< numbers in each position of the current geometry; 0 before the first
    bool extracted;      ///< coordinates were extracted from the last parsed text
    geojson_extraction extraction;
    const char *text_end; ///< the end of that text
    bat_error *error;     ///< receives the failure; may be null
} geojson_reader;

/// Make a reader for a file that is not a collection.
geojson_reader geojson_reader_start(const bat_space *space, const bat_curve_read_options *options, bat_error *error);

/// Parse JSON from line `first_line` on, which must remain until its coordinates are read. Null on failure.
json_t *geojson_parse(geojson_reader *reader, const char *begin, const char *end, size_t first_line);

/// Read a feature, or a bare geometry, from the last tree of geojson_parse(), which the document takes, also on failure.
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status geojson_read_feature(geojson_reader *reader, json_t *tree, bool bare_geometry);

/// Whether a text begins with an object whose "type" is `type`.
bool geojson_text_has_type(const char *begin, const char *end, const char *type);

/// Whether the "type" of an object is `type`.
bool geojson_has_type(const json_t *object, const char *type);

void geojson_reader_free(geojson_reader *reader);

typedef struct feature_text
{
    const char *begin, *end;
    size_t line; ///< the line of its first byte, counted from 1
} feature_text;

/// Make a reader for the records of a sequence, in the space that the options choose.
/// @return BAT_OK, or as bat_space_by_name(), or BAT_UNSUPPORTED
bat_status geojson_records_begin(const bat_curve_read_options *options, geojson_reader *reader, bat_error *error);

/// Read records, each a feature or a geometry, on several threads. `first` is the number of records before these.
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status geojson_records_read(geojson_reader *reader, const feature_text *records, size_t count, size_t first,
                                const bat_curve_read_options *options);

/// Move what was read into a set, which may have no curves. The reader can read further records.
bat_status geojson_records_end(geojson_reader *reader, bat_curve_format format, bat_curve_set *set);

void geojson_extraction_free(geojson_extraction *extraction);

/// Read coordinates at the scanner's position, which are valid JSON, into curves, and join what the file cuts at the
/// antimeridian. A geometry without a line or ring of enough different points, or one that is not an outline on the sphere,
/// gives no curves.
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status geojson_read_coordinates(geojson_reader *reader, geometry_kind kind, json_scanner *scan);

/// BAT_BAD_FILE, with a message that begins with the reader's position.
bat_status geojson_fault(geojson_reader *reader, const char *format, ...) __attribute__((format(printf, 2, 3)));

bat_status geojson_no_memory(geojson_reader *reader);

// Sequences of GeoJSON texts: RFC 8142, where a record separator begins each record, and a record a line.

/// The record separator of RFC 8142.
#define RECORD_SEPARATOR '\x1e'

/// A position in a sequence. Blank lines and empty records are skipped.
typedef struct record_scan
{
    const char *at, *end; ///< the byte at `end` is readable
    size_t line;          ///< the line of `at`, counted from 1
    bool separated;       ///< by record separators, else by line breaks
} record_scan;

/// The start of a sequence, or of its next part: `separated` where the first byte that is not blank is a separator.
record_scan record_scan_start(const char *text, size_t size, size_t line);

/// Advance behind the next record. `whole`: the text does not go on after its end, where the last record needs no line break
/// or separator. False, without moving, when there is no complete record.
bool record_scan_next(record_scan *scan, bool whole, feature_text *record);

/// Write the features of a set as a part of a collection or of a sequence. In a collection a comma stands before each
/// feature but the first one of the part with `first`.
bat_status geojson_part_write(const bat_curve_set *set, bat_curve_format format, bool first,
                              const bat_curve_write_options *options, text_sink *sink, bat_error *error);

/// What stands before and after the features of a collection.
extern const char GEOJSON_COLLECTION_BEGIN[], GEOJSON_COLLECTION_END[];

/// Whether a text that begins with a separator or a brace is a sequence of several records.
bool geojson_is_sequence(const char *text, size_t size);

// Names of coordinate reference systems, as GeoJSON files of 2008 and programs spell them.

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

/// Names that are shown are shorter; a system without a name has longer text.
#define CRS_NAME_SIZE 128

/// Append the member "crs" with the URN of a short name, "urn:ogc:def:crs:EPSG::25833"; other names as they are.
void crs_append(const char *short_name, text_buffer *text);

// Collections of GeoJSON that the readers of other formats make, so that the reader of GeoJSON does the rest.

/// What is known of the positions of a collection.
typedef struct geojson_made
{
    double low[2], high[2]; ///< of x and y
    int srid;               ///< the EPSG code of their system; 0 for none
    bool degrees;           ///< without a system they are longitude and latitude, if they can be
    bool measures;          ///< as in geojson_document
    bool lines;             ///< features begin on the lines of the file
} geojson_made;

geojson_made geojson_made_start(void);

/// Take x or y of a position into account.
static inline void geojson_made_take(geojson_made *made, size_t axis, double value)
{
    made->low[axis] = value < made->low[axis] ? value : made->low[axis];
    made->high[axis] = value > made->high[axis] ? value : made->high[axis];
}

/// The begin of a collection, up to its first feature.
extern const char GEOJSON_MADE_BEGIN[];

/// Append line breaks up to the line of a position, so that features begin on the lines of the file.
/// @param counted where the last call ended
void geojson_made_pad(const char *at, const char **counted, text_buffer *geojson);

/// End a collection and read it as a set of a format.
bat_status geojson_made_read(const geojson_made *made, text_buffer *geojson, bat_curve_format format,
                             const bat_curve_read_options *options, bat_curve_set *set, bat_error *error);
