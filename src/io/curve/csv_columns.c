#include "io/curve/csv.h"

#include "io/common/time_text.h"

#include <strings.h>

/// @file
/// The meaning of CSV columns: coordinates, times, velocities and other channels.

bool csv_columns_name(csv_columns *columns, const csv_field *fields, size_t count)
{
    size_t size = count * sizeof(char *);
    for (size_t i = 0; i < count; i++)
        size += (size_t)(fields[i].end - fields[i].begin) + 1;
    char **names = malloc(size);
    if (names == NULL)
        return false;
    char *text = (char *)(names + count);
    for (size_t i = 0; i < count; i++)
    {
        size_t length = (size_t)(fields[i].end - fields[i].begin);
        names[i] = memcpy(text, fields[i].begin, length);
        text[length] = '\0';
        text += length + 1;
    }
    free(columns->names);
    columns->names = names;
    columns->count = count;
    columns->time = column_find_time(&(column_names){names, count}, NULL);
    return true;
}

static column_names names_of(const csv_columns *columns)
{
    return (column_names){columns->names, columns->count};
}

static csv_kind kind_of(const csv_columns *columns, size_t column)
{
    return columns->kinds != NULL ? (csv_kind)columns->kinds[column] : CSV_NUMBER;
}

/// Choose columns of numbers by their places, up to `most`. A column of times is none where `fewest` others are left.
static void choose_places(const csv_columns *columns, size_t most, size_t fewest, csv_choice *choice)
{
    size_t numbers = 0, time = columns->time;
    for (size_t i = 0; i < columns->count; i++)
        numbers += kind_of(columns, i) == CSV_NUMBER ? 1 : 0;
    bool timed = time != BAT_NO_INDEX && kind_of(columns, time) == CSV_NUMBER && numbers > fewest;
    choice->times = timed ? time : BAT_NO_INDEX;
    choice->count = 0;
    choice->by_place = true;
    for (size_t i = 0; i < columns->count && choice->count < most; i++)
        if (kind_of(columns, i) == CSV_NUMBER && !(timed && i == time))
            choice->columns[choice->count++] = i;
}

void csv_columns_choose(const csv_columns *columns, const char *space, bool motion, csv_choice *choice)
{
    column_names names = names_of(columns);
    named_coordinates named = names_find_coordinates(&names, false);
    bool two = space != NULL && (strcmp(space, "plane") == 0 || strcmp(space, "disk") == 0);
    bool sphere = space != NULL && strcmp(space, "sphere") == 0;
    bool flat = space != NULL && strcmp(space, "euclidean") == 0;
    *choice = (csv_choice){.space = space, .altitude = BAT_NO_INDEX, .times = BAT_NO_INDEX, .spelled = named.spelled};
    memcpy(choice->columns, named.columns, sizeof named.columns);
    choice->count = named.count;
    if (named.geographic && (space == NULL || sphere))
    {
        choice->space = "sphere";
        choice->altitude = named.altitude;
        choice->degrees = true;
        choice->radians = named.radians;
    }
    else if (two && named.count >= 2)
        choice->count = 2;
    else if (motion && named.count == 0 && (space == NULL || flat) && column_find(&names, "vx") != BAT_NO_INDEX &&
             column_find(&names, "x") != BAT_NO_INDEX)
        choice->columns[choice->count++] = column_find(&names, "x"); // a number and its velocity
    else if (named.geographic || named.count == 0 || (sphere && named.count < 3) || !(space == NULL || sphere || flat))
        choose_places(columns, two ? 2 : SIZE_MAX, motion ? 1 : 2, choice);
    if (choice->space == NULL)
        choice->space = choice->count == 2 ? "plane" : "euclidean";
}

bool csv_columns_place(csv_columns *columns, const size_t *chosen, size_t count)
{
    size_t *places = memory_array(columns->count, sizeof *places);
    if (places == NULL)
        return false;
    for (size_t i = 0; i < columns->count; i++)
        places[i] = BAT_NO_INDEX;
    for (size_t i = 0; i < count; i++)
        places[chosen[i]] = i;
    for (size_t i = 0, next = count; i < columns->count; i++)
        if (places[i] == BAT_NO_INDEX && (kind_of(columns, i) == CSV_NUMBER || kind_of(columns, i) == CSV_CLOCK))
            places[i] = next++;
    free(columns->places);
    columns->places = places;
    return true;
}

bool csv_columns_fit(const csv_columns *columns, size_t coordinates, size_t channels)
{
    size_t hidden = columns->has_places ? CSV_PLACE_CHANNELS : 0;
    return coordinates + channels == columns->count - columns->other_count + hidden;
}

void csv_columns_free(csv_columns *columns)
{
    free(columns->names);
    free(columns->places);
    free(columns->kinds);
    free(columns->chosen);
    free(columns->cells.first_rows);
    free(columns->cells.closed);
    free(columns->cells.offsets);
    free(columns->cells.text);
    *columns = (csv_columns){.time = BAT_NO_INDEX, .altitude = BAT_NO_INDEX, .corner = BAT_NO_INDEX};
}

bool csv_columns_use_form(csv_columns *columns, const point_form *form)
{
    columns->form = form;
    if (columns->names == NULL)
        return true;
    free(columns->places);
    columns->places = memory_array(columns->count, sizeof *columns->places);
    if (columns->places == NULL)
        return false;
    size_t next = 0;
    for (size_t i = 0; i < columns->count; i++)
        columns->places[i] = BAT_NO_INDEX;
    for (const char *const *name = form->names; *name != NULL; name++)
    {
        column_names names = names_of(columns);
        size_t column = column_find(&names, *name);
        if (column != BAT_NO_INDEX && columns->places[column] == BAT_NO_INDEX)
            columns->places[column] = next++;
    }
    if (next < form->count) // no name is in the header: the columns are in the form's order
        next = 0;
    for (size_t i = 0; i < columns->count; i++)
        if (columns->places[i] == BAT_NO_INDEX && kind_of(columns, i) == CSV_NUMBER)
            columns->places[i] = next++;
    return true;
}

/// The channel of a column, or BAT_NO_INDEX.
static size_t channel_of(const csv_columns *columns, size_t coordinates, size_t column)
{
    if (column == BAT_NO_INDEX)
        return BAT_NO_INDEX;
    size_t place = columns->places != NULL ? columns->places[column] : column;
    return place < coordinates || place == BAT_NO_INDEX ? BAT_NO_INDEX : place - coordinates;
}

void csv_columns_channels(const csv_columns *columns, size_t coordinates, const point_form *form, motion_channels *channels)
{
    column_names names = names_of(columns);
    *channels = (motion_channels){.time = channel_of(columns, coordinates, columns->time)};
    size_t found[MAX_VELOCITIES];
    if (form == NULL || point_form_find_velocities(form, &names, found) == 0)
        return;
    channels->velocity_count = form->velocity_count;
    for (size_t i = 0; i < form->velocity_count; i++)
        channels->velocity[i] = channel_of(columns, coordinates, found[i]);
}

static void free_columns(csv_columns *columns)
{
    csv_columns_free(columns);
    free(columns);
}

bat_curve_attributes *csv_attributes_new(bat_curve_format format)
{
    bat_curve_attributes *attributes = attributes_new(format);
    csv_columns *columns = malloc(sizeof *columns);
    if (attributes == NULL || columns == NULL)
    {
        attributes_release(attributes);
        free(columns);
        return NULL;
    }
    *columns = (csv_columns){.time = BAT_NO_INDEX, .altitude = BAT_NO_INDEX, .corner = BAT_NO_INDEX};
    attributes->csv = columns;
    attributes->free_csv = free_columns;
    return attributes;
}

void csv_attributes_describe(bat_curve_attributes *attributes, const bat_space *space)
{
    const csv_columns *columns = attributes->csv;
    const point_form *form = columns->form != NULL ? columns->form : point_form_first(space->name, space->point_dim);
    size_t coordinates = columns->degrees ? 2 : columns->form != NULL ? columns->form->count : space->point_dim;
    size_t numbers = columns->count - columns->other_count + (columns->has_places ? CSV_PLACE_CHANNELS : 0);
    attributes->degrees = columns->degrees;
    attributes->form = columns->form;
    if (columns->names == NULL || numbers < coordinates)
        return;
    attributes->channel_count = numbers - coordinates;
    csv_columns_channels(columns, coordinates, columns->degrees ? NULL : form, &attributes->channels);
}

#define MADE_NAME_SIZE 16

bool csv_columns_of_motion(const bat_curve_attributes *attributes, csv_columns *columns)
{
    static const char *const degrees[] = {"lon", "lat", NULL};
    const point_form *form = attributes->form;
    const motion_channels *channels = &attributes->channels;
    const char *names[1 + MAX_FORM_COLUMNS + 2 * MAX_VELOCITIES];
    char deviations[MAX_VELOCITIES][MADE_NAME_SIZE];
    csv_field fields[1 + MAX_FORM_COLUMNS + 2 * MAX_VELOCITIES];
    size_t count = 0, first = channels->time != BAT_NO_INDEX;
    *columns = (csv_columns){.time = BAT_NO_INDEX, .altitude = BAT_NO_INDEX, .corner = BAT_NO_INDEX};
    char time[MADE_NAME_SIZE];
    (void)snprintf(time, sizeof time, "time%s", exact_time_suffix(attributes->time_decimals));
    if (first > 0)
        names[count++] = time;
    for (const char *const *point = attributes->degrees ? degrees : form->names; *point != NULL; point++)
        names[count++] = *point;
    for (size_t i = 0; i < channels->velocity_count; i++)
        names[count++] = form->velocities[i];
    for (size_t i = 0; i < channels->velocity_count && channels->deviation > 0; i++)
    {
        (void)snprintf(deviations[i], MADE_NAME_SIZE, "sd_%s", form->velocities[i] + (form->velocities[i][0] == 'v'));
        names[count++] = deviations[i];
    }
    for (size_t i = 0; i < count; i++)
        fields[i] = (csv_field){names[i], names[i] + strlen(names[i])};
    if (!csv_columns_name(columns, fields, count))
        return false;
    columns->time = first > 0 ? 0 : BAT_NO_INDEX;
    columns->degrees = attributes->degrees;
    return columns->degrees ? csv_columns_place(columns, (const size_t[]){first, first + 1}, 2)
                            : csv_columns_use_form(columns, form);
}

// Tables of spellings.

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

bool name_is_angle(const char *name)
{
    return is_spelled(name_parse(name).base,
                      SPELLINGS("heading", "course", "bearing", "azimuth", "yaw", "cog", "magvar", "direction"));
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

static spellings const ALTITUDES = SPELLINGS("alt", "altitude", "ele", "elev", "elevation", "height", "z", "h",
                                             "gpsaltitude", "enhancedaltitude", "h\xC3\xB6he", "hoehe");

/// The spellings of pairs of coordinates: longitude and latitude first, then those of the plane.
static const struct plane_names
{
    spellings first, second;
} PAIRS[] = {
    {SPELLINGS("lon", "lng", "long", "longitude", "decimallongitude", "gpslon", "gpslng", "gpslong", "gpslongitude",
               "locationlong", "locationlongitude", "positionlong", "longitud", "l\xC3\xA4ngengrad", "laengengrad"),
     SPELLINGS("lat", "latitude", "decimallatitude", "gpslat", "gpslatitude", "locationlat", "locationlatitude",
               "positionlat", "latitud", "breitengrad")},
    {SPELLINGS("x", "xcoord", "xcoordinate", "coordx", "pointx", "posx", "positionx", "utmx", "points0"),
     SPELLINGS("y", "ycoord", "ycoordinate", "coordy", "pointy", "posy", "positiony", "utmy", "points1")},
    {SPELLINGS("easting", "eastings", "east", "e", "utme", "utmeasting", "rechtswert", "ostwert", "rw"),
     SPELLINGS("northing", "northings", "north", "n", "utmn", "utmnorthing", "hochwert", "nordwert", "hw")},
};
static spellings const THIRDS =
    SPELLINGS("z", "zcoord", "zcoordinate", "coordz", "pointz", "posz", "positionz", "alt", "altitude", "ele", "elev",
              "elevation", "height", "h", "h\xC3\xB6he", "hoehe", "up", "points2");
static spellings const FOURTHS = SPELLINGS("w");

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

named_coordinates names_find_coordinates(const column_names *names, bool planar)
{
    named_coordinates found = {.altitude = BAT_NO_INDEX};
    name_unit unit;
    name_parts parts;
    for (size_t i = planar ? 1 : 0; i < sizeof PAIRS / sizeof *PAIRS && names->names != NULL; i++)
    {
        if (!find_pair(names, PAIRS[i].first, PAIRS[i].second, &found, &unit) || (i == 0 && unit == NAME_UNIT_LENGTH))
            continue;
        if (i == 0 || unit == NAME_UNIT_DEGREES || unit == NAME_UNIT_RADIANS)
        {
            found.count = 2;
            found.geographic = true;
            found.radians = unit == NAME_UNIT_RADIANS;
            found.altitude = find_spelled(names, ALTITUDES, &parts);
            note_spelling(names, &found);
            return found;
        }
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
