#include "io/curve/csv.h"

#include <string.h>
#include <strings.h>

/// @file
/// Tables of spellings.

/// Spellings, null-terminated; as name_parts::base has them.
typedef const char *const *spellings;

#define SPELLINGS(...) ((const char *const[]){__VA_ARGS__, NULL})

static bool is_spelled(const char *base, spellings known)
{
    for (; *known != NULL; known++)
        if (strcmp(base, *known) == 0)
            return true;
    return false;
}

/// Copy letters, digits and bytes beyond ASCII in lower case; false for a result that is too long.
static bool simplify(const char *begin, const char *end, char base[NAME_BASE_SIZE])
{
    size_t size = 0;
    for (; begin < end; begin++)
    {
        unsigned char c = (unsigned char)*begin;
        bool upper = c >= 'A' && c <= 'Z';
        if (!upper && !(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9') && c < 0x80)
            continue;
        if (size == NAME_BASE_SIZE - 1)
            return false;
        base[size++] = (char)(upper ? c - 'A' + 'a' : c);
    }
    base[size] = '\0';
    return true;
}

/// The unit of a text; NAME_UNIT_NONE when it is not known as one.
static name_unit unit_of(const char *begin, const char *end)
{
    char text[NAME_BASE_SIZE];
    if (!simplify(begin, end, text))
        return NAME_UNIT_NONE;
    if (is_spelled(text, SPELLINGS("deg", "degs", "degree", "degrees", "dd", "decdeg", "decimaldegree", "decimaldegrees",
                                   "degreeseast", "degreesnorth", "degeast", "degnorth", "dege", "degn", "wgs84", "epsg4326",
                                   "\u00B0", "\u00B0e", "\u00B0n")))
        return NAME_UNIT_DEGREES;
    if (is_spelled(text, SPELLINGS("rad", "rads", "radian", "radians")))
        return NAME_UNIT_RADIANS;
    if (is_spelled(text, SPELLINGS("m", "mm", "cm", "km", "ft", "feet", "foot", "meter", "meters", "metre", "metres", "yd",
                                   "mi", "px", "utm", "usft")))
        return NAME_UNIT_LENGTH;
    return NAME_UNIT_NONE;
}

/// The last bracket, which closes at the end, or null.
static const char *bracket_before(const char *begin, const char *end)
{
    static const char pairs[] = "()[]{}";
    const char *pair = end > begin && end[-1] != '\0' ? strchr(pairs, end[-1]) : NULL;
    if (pair == NULL || (pair - pairs) % 2 == 0)
        return NULL;
    for (const char *at = end - 1; at > begin; at--)
        if (at[-1] == pair[-1])
            return at - 1;
    return NULL;
}

name_parts name_parse(const char *name)
{
    name_parts parts = {.unit = NAME_UNIT_NONE};
    const char *begin = name, *end = name + strlen(name);
    if (end - begin >= 2 && *begin == '"' && end[-1] == '"')
    {
        begin++;
        end--;
    }
    while (end > begin && (end[-1] == ' ' || end[-1] == '\t'))
        end--;
    const char *bracket = bracket_before(begin, end);
    if (bracket != NULL)
    {
        parts.unit = unit_of(bracket + 1, end - 1);
        if (parts.unit == NAME_UNIT_NONE)
            parts.unit = NAME_UNIT_OTHER;
        end = bracket;
    }
    else
    {
        const char *at = end;
        while (at > begin && at[-1] != '_' && at[-1] != ' ' && at[-1] != '.')
            at--;
        parts.unit = at > begin + 1 ? unit_of(at, end) : NAME_UNIT_NONE;
        if (parts.unit != NAME_UNIT_NONE)
            end = at - 1;
    }
    if (!simplify(begin, end, parts.base))
        parts.base[0] = '\0';
    return parts;
}

bool name_is_index(const char *name)
{
    name_parts parts = name_parse(name);
    const char *inner = name + (*name == '"');
    return *inner == '\0' || strcmp(inner, "\"") == 0 || strcmp(inner, "#") == 0 || strcmp(inner, "#\"") == 0 ||
           is_spelled(parts.base,
                      SPELLINGS("id", "index", "idx", "fid", "ogcfid", "gid", "oid", "objectid", "no", "nr", "num", "number",
                                "row", "rowid", "rownum", "rownumber", "pointid", "pointno", "pointnr", "point", "pt",
                                "ptid", "seq", "sequence", "vertex", "vertexid", "vertexindex"));
}

static bool ends_with(const char *text, const char *tail)
{
    size_t length = strlen(text), tail_length = strlen(tail);
    return length >= tail_length && strcmp(text + length - tail_length, tail) == 0;
}

bool name_is_code(const char *name)
{
    name_parts parts = name_parse(name);
    return ends_with(parts.base, "id") || name_is_index(name);
}

bool name_is_group(const char *name)
{
    static const char *const words[] = {"track",   "trip",  "segment", "seg",    "line",   "route",
                                        "path",    "trace", "curve",   "group",  "part",   "ring",
                                        "polygon", "shape", "feature", "stroke", "contour"};
    name_parts parts = name_parse(name);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strncmp(parts.base, words[i], strlen(words[i])) == 0)
            return true;
    return ends_with(parts.base, "id");
}

/// The first column with one of the spellings; BAT_NO_INDEX for none.
static size_t find_spelled(const column_names *names, spellings known, name_parts *parts)
{
    for (; *known != NULL; known++)
        for (size_t i = 0; i < names->count; i++)
        {
            *parts = name_parse(names->names[i]);
            if (strcmp(parts->base, *known) == 0)
                return i;
        }
    return BAT_NO_INDEX;
}

static spellings const LONGITUDES =
    SPELLINGS("lon", "lng", "long", "longitude", "decimallongitude", "gpslon", "gpslng", "gpslong", "gpslongitude",
              "locationlong", "locationlongitude", "positionlong", "longitud", "l\xC3\xA4ngengrad", "laengengrad");
static spellings const LATITUDES = SPELLINGS("lat", "latitude", "decimallatitude", "gpslat", "gpslatitude", "locationlat",
                                             "locationlatitude", "positionlat", "latitud", "breitengrad");
static spellings const ALTITUDES = SPELLINGS("alt", "altitude", "ele", "elev", "elevation", "height", "z", "h",
                                             "gpsaltitude", "enhancedaltitude", "h\xC3\xB6he", "hoehe");

/// The spellings of one kind of plane coordinates.
static const struct plane_names
{
    spellings first, second;
} PLANES[] = {
    {SPELLINGS("x", "xcoord", "xcoordinate", "coordx", "pointx", "posx", "positionx", "utmx"),
     SPELLINGS("y", "ycoord", "ycoordinate", "coordy", "pointy", "posy", "positiony", "utmy")},
    {SPELLINGS("easting", "eastings", "east", "e", "utme", "utmeasting", "rechtswert", "ostwert", "rw"),
     SPELLINGS("northing", "northings", "north", "n", "utmn", "utmnorthing", "hochwert", "nordwert", "hw")},
};
static spellings const THIRDS = SPELLINGS("z", "zcoord", "zcoordinate", "coordz", "pointz", "posz", "positionz", "alt",
                                          "altitude", "ele", "elev", "elevation", "height", "h", "h\xC3\xB6he", "hoehe");
static spellings const FOURTHS = SPELLINGS("w");

static bool is_angle(name_unit unit)
{
    return unit == NAME_UNIT_DEGREES || unit == NAME_UNIT_RADIANS;
}

/// Whether two columns exist with units of one kind.
static bool find_pair(const column_names *names, spellings first, spellings second, named_coordinates *found,
                      name_unit *unit)
{
    name_parts a = {0}, b = {0};
    found->columns[0] = find_spelled(names, first, &a);
    found->columns[1] = find_spelled(names, second, &b);
    *unit = a.unit;
    return found->columns[0] != BAT_NO_INDEX && found->columns[1] != BAT_NO_INDEX &&
           (a.unit == NAME_UNIT_RADIANS) == (b.unit == NAME_UNIT_RADIANS) &&
           (a.unit == NAME_UNIT_LENGTH) == (b.unit == NAME_UNIT_LENGTH);
}

/// Whether a column is called by one of the short names.
static bool is_canonical(const char *name)
{
    bool quoted = *name == '"';
    for (spellings at = SPELLINGS("lon", "lng", "long", "longitude", "lat", "latitude", "x", "y", "z", "w"); *at != NULL;
         at++)
    {
        size_t length = strlen(*at);
        if (strncasecmp(name + quoted, *at, length) == 0 && strcmp(name + quoted + length, quoted ? "\"" : "") == 0)
            return true;
    }
    return false;
}

static void note_spelling(const column_names *names, named_coordinates *found)
{
    for (size_t i = 0; i < found->count; i++)
        found->spelled = found->spelled || !is_canonical(names->names[found->columns[i]]);
}

static named_coordinates as_geographic(const column_names *names, named_coordinates found, name_unit unit)
{
    name_parts parts;
    found.count = 2;
    found.geographic = true;
    found.radians = unit == NAME_UNIT_RADIANS;
    found.altitude = find_spelled(names, ALTITUDES, &parts);
    note_spelling(names, &found);
    return found;
}

named_coordinates names_find_coordinates(const column_names *names)
{
    named_coordinates found = {.altitude = BAT_NO_INDEX};
    name_unit unit;
    name_parts parts;
    if (names->names == NULL)
        return found;
    if (find_pair(names, LONGITUDES, LATITUDES, &found, &unit) && unit != NAME_UNIT_LENGTH)
        return as_geographic(names, found, unit);
    for (size_t i = 0; i < sizeof PLANES / sizeof *PLANES; i++)
    {
        if (!find_pair(names, PLANES[i].first, PLANES[i].second, &found, &unit))
            continue;
        if (is_angle(unit))
            return as_geographic(names, found, unit);
        size_t third = find_spelled(names, THIRDS, &parts), fourth = find_spelled(names, FOURTHS, &parts);
        found.count = 2;
        if (third != BAT_NO_INDEX)
            found.columns[found.count++] = third;
        if (third != BAT_NO_INDEX && fourth != BAT_NO_INDEX)
            found.columns[found.count++] = fourth;
        note_spelling(names, &found);
        return found;
    }
    return found;
}
