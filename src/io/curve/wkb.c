#include "io/curve/wkt.h"

#include <math.h>

/// @file
/// Well-known binary (ISO 19125-1) in hexadecimal digits, as databases print it. It is read as the well-known text of the
/// same geometry. The standard tells dimensions by thousands of the type, PostGIS by bits; these are written.

enum
{
    TYPE_BYTES = 4,
    REAL_BYTES = 8,
    MIN_DIGITS = 2 * (1 + TYPE_BYTES + TYPE_BYTES), ///< of an empty line
    MAX_DEPTH = 33,                                 ///< of geometries in others
    MAX_NUMBERS = 4,                                ///< of a position
    THOUSAND = 1000,
    PARTS = GEOMETRY_POINTS - GEOMETRY_POINT ///< from the type of a part to that of several
};

static const uint32_t Z_BIT = 1U << 31, M_BIT = 1U << 30, SRID_BIT = 1U << 29;
static const char ENDS_EARLY[] = "ends too early", NOT_FINITE[] = "has a coordinate that is not finite";

/// Digits that are left.
typedef struct wkb_digits
{
    const char *at, *end;
    bool big_endian;
} wkb_digits;

/// The type of a geometry.
typedef struct wkb_type
{
    geometry_kind kind;
    bool z, m, srid;
} wkb_type;

static int digit_value(char digit)
{
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    const char *found = digit != '\0' ? strchr(digits, digit) : NULL;
    return found != NULL ? (int)(found - digits) % 16 : -1;
}

/// Take a whole number of `bytes` bytes.
static bool take_bits(wkb_digits *digits, size_t bytes, uint64_t *bits)
{
    *bits = 0;
    if ((size_t)(digits->end - digits->at) < 2 * bytes)
        return false;
    for (size_t i = 0; i < bytes; i++, digits->at += 2)
    {
        int high = digit_value(digits->at[0]), low = digit_value(digits->at[1]);
        if (high < 0 || low < 0)
            return false;
        *bits |= (uint64_t)(16 * high + low) << 8 * (digits->big_endian ? bytes - 1 - i : i);
    }
    return true;
}

/// Take the byte order and the type. Null, or what is wrong.
static const char *take_type(wkb_digits *digits, wkb_type *type)
{
    uint64_t order, bits;
    if (!take_bits(digits, 1, &order))
        return ENDS_EARLY;
    digits->big_endian = order == 0;
    if (order > 1)
        return "has an unknown byte order";
    if (!take_bits(digits, TYPE_BYTES, &bits))
        return ENDS_EARLY;
    uint64_t number = bits & (SRID_BIT - 1), kind = number % THOUSAND, form = number / THOUSAND;
    *type = (wkb_type){.kind = (geometry_kind)kind,
                       .z = (bits & Z_BIT) != 0 || (form & 1) != 0,
                       .m = (bits & M_BIT) != 0 || (form & 2) != 0,
                       .srid = (bits & SRID_BIT) != 0};
    return kind >= GEOMETRY_POINT && kind <= GEOMETRY_COLLECTION && form <= 3 ? NULL : "has a type that is not known here";
}

bool wkb_begins(const char *begin, const char *end)
{
    wkb_type type;
    wkb_digits digits = {.at = begin, .end = end};
    const char *at = begin;
    while (at < end && digit_value(*at) >= 0)
        at++;
    return at == end && end - begin >= MIN_DIGITS && (end - begin) % 2 == 0 && take_type(&digits, &type) == NULL;
}

/// Take a position, which is empty where all of its numbers are no numbers.
static const char *take_position(wkb_digits *digits, size_t numbers, bool *empty, text_buffer *text)
{
    double values[MAX_NUMBERS];
    bool finite = true;
    *empty = true;
    for (size_t i = 0; i < numbers; i++)
    {
        uint64_t bits;
        if (!take_bits(digits, REAL_BYTES, &bits))
            return ENDS_EARLY;
        memcpy(&values[i], &bits, sizeof bits);
        finite = finite && isfinite(values[i]);
        *empty = *empty && isnan(values[i]);
    }
    for (size_t i = 0; i < numbers && finite; i++)
        text_append_real(text, i > 0 ? " " : "", values[i]);
    return finite || *empty ? NULL : NOT_FINITE;
}

static const char *take_geometry(wkb_digits *digits, geometry_kind whole, size_t depth, text_buffer *text);

/// Take what follows the type, as text in brackets.
static const char *take_content(wkb_digits *digits, geometry_kind kind, size_t numbers, size_t depth, text_buffer *text)
{
    uint64_t count = 1;
    const char *fault = NULL;
    bool empty = false;
    if (kind != GEOMETRY_POINT && !take_bits(digits, TYPE_BYTES, &count))
        return ENDS_EARLY;
    text_append_string(text, "(");
    for (uint64_t i = 0; i < count && fault == NULL; i++)
    {
        text_append_string(text, i > 0 ? "," : "");
        if (kind == GEOMETRY_POLYGON)
            fault = take_content(digits, GEOMETRY_LINE, numbers, depth, text);
        else if (kind == GEOMETRY_POINT || kind == GEOMETRY_LINE)
            fault = take_position(digits, numbers, &empty, text);
        else
            fault = take_geometry(digits, kind, depth + 1, text);
        if (empty && kind == GEOMETRY_LINE)
            fault = NOT_FINITE;
    }
    text->size -= (count == 0 || empty) && text->size > 0 ? 1 : 0;
    text_append_string(text, count == 0 || empty ? " EMPTY" : ")");
    return fault;
}

/// Take a geometry as text: a part of `whole`, which is GEOMETRY_UNKNOWN for none.
static const char *take_geometry(wkb_digits *digits, geometry_kind whole, size_t depth, text_buffer *text)
{
    wkb_type type;
    uint64_t srid;
    const char *fault = depth < MAX_DEPTH ? take_type(digits, &type) : "has too many geometries in others";
    if (fault != NULL)
        return fault;
    if (type.srid && !take_bits(digits, TYPE_BYTES, &srid))
        return ENDS_EARLY;
    if (type.srid && whole == GEOMETRY_UNKNOWN)
        text_append_format(text, "SRID=%llu;", (unsigned long long)srid);
    bool several = whole >= GEOMETRY_POINTS && whole <= GEOMETRY_POLYGONS;
    if (several && (int)type.kind + PARTS != (int)whole)
        return "has a part of another type";
    if (!several)
        TEXT_APPEND(text, WKT_NAMES[type.kind], type.z && type.m ? " ZM" : type.z ? " Z" : type.m ? " M" : "");
    return take_content(digits, type.kind, 2 + (size_t)type.z + (size_t)type.m, depth, text);
}

bat_status wkb_scan_geometry(wkt_scanner *scan, text_buffer *geojson)
{
    text_buffer text = {0};
    wkb_digits digits = {.at = scan->at, .end = scan->end};
    const char *fault = take_geometry(&digits, GEOMETRY_UNKNOWN, 0, &text);
    if (fault == NULL && digits.at < digits.end)
        fault = "goes on behind its end";
    bat_status status = text.failed     ? error_memory(scan->error, text.size)
                        : fault != NULL ? wkt_fault(scan, "the binary geometry %s", fault)
                                        : BAT_OK;
    if (status == BAT_OK)
    {
        wkt_scanner inner = *scan;
        inner.place = scan->at;
        inner.at = text.data;
        inner.end = text.data + text.size;
        status = wkt_scan_geometry(&inner, geojson);
        inner.at = inner.end = scan->end;
        inner.place = NULL;
        inner.binary = true;
        *scan = inner;
    }
    text_free(&text);
    return status;
}

// Writing.

static void append_bits(text_buffer *text, uint64_t bits, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++, bits >>= 8)
        text_append_format(text, "%02X", (unsigned)(bits & UINT8_MAX));
}

static void append_position(const json_t *position, text_buffer *text)
{
    size_t count = json_array_size(position);
    for (size_t i = 0; i < (count > 0 ? count : 2); i++)
    {
        double value = i < count ? json_number_value(json_array_get(position, i)) : NAN;
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        append_bits(text, bits, REAL_BYTES);
    }
}

/// Append what follows the type.
static void append_content(geometry_kind kind, const json_t *coordinates, uint32_t dimensions, text_buffer *text)
{
    size_t count = json_array_size(coordinates);
    if (kind == GEOMETRY_POINT)
    {
        append_position(coordinates, text);
        return;
    }
    append_bits(text, count, TYPE_BYTES);
    for (size_t i = 0; i < count; i++)
    {
        const json_t *part = json_array_get(coordinates, i);
        geometry_kind inner = (geometry_kind)((int)kind - PARTS);
        if (kind == GEOMETRY_LINE || kind == GEOMETRY_POLYGON)
            append_content((geometry_kind)((int)kind - 1), part, dimensions, text);
        else
        {
            append_bits(text, 1, 1);
            append_bits(text, dimensions | (uint32_t)inner, TYPE_BYTES);
            append_content(inner, part, dimensions, text);
        }
    }
}

void wkb_append_geometry(const json_t *geometry, bool measures, const char *srid, text_buffer *text)
{
    geometry_kind kind = geojson_kind(geometry);
    const json_t *coordinates = json_object_get(geometry, "coordinates"), *members = json_object_get(geometry, "geometries");
    size_t numbers = wkt_count_numbers(coordinates);
    uint32_t dimensions =
        (numbers > 3 || (numbers == 3 && !measures) ? Z_BIT : 0) | (numbers > 3 || (numbers == 3 && measures) ? M_BIT : 0);
    if (kind == GEOMETRY_UNKNOWN)
        kind = GEOMETRY_COLLECTION; // for null
    append_bits(text, 1, 1);
    append_bits(text, dimensions | (srid != NULL ? SRID_BIT : 0) | (uint32_t)kind, TYPE_BYTES);
    if (srid != NULL)
        append_bits(text, strtoul(srid, NULL, 10), TYPE_BYTES);
    if (kind != GEOMETRY_COLLECTION)
    {
        append_content(kind, coordinates, dimensions, text);
        return;
    }
    append_bits(text, json_array_size(members), TYPE_BYTES);
    for (size_t i = 0; i < json_array_size(members); i++)
        wkb_append_geometry(json_array_get(members, i), measures, NULL, text);
}
