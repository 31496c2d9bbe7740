#include "io/curve/geojson_lift.h"

#include "io/common/json_scan.h"
#include "io/common/number_text.h"

enum
{
    DEEPEST_ARRAY = 4,   ///< of a MultiPolygon: polygons, rings, positions, numbers
    DEEPEST_GEOMETRY = 8 ///< collections in collections beyond it are for the parser
};

typedef struct lifting
{
    json_scanner scan;
    const char *copied; ///< the text before it is in lift->text
    geojson_lift *lift;
} lifting;

/// The type of the object that begins here, with its quotes; empty when there is none.
static json_scanner find_type(json_scanner scan)
{
    json_scanner key, type = {scan.at, scan.at};
    (void)json_scan_take(&scan, '{');
    do
    {
        if (!json_scan_key(&scan, &key))
            break;
        if (!json_scan_is(&key, "type") || !json_scan_at(&scan, '"'))
            continue;
        type.at = scan.at;
        type.end = json_scan_string(&scan) ? scan.at : type.at;
        break;
    } while (json_scan_value(&scan) && json_scan_take(&scan, ','));
    return type;
}

static bool is_curves(const json_scanner *type)
{
    return json_scan_is(type, "\"LineString\"") || json_scan_is(type, "\"MultiLineString\"") ||
           json_scan_is(type, "\"Polygon\"") || json_scan_is(type, "\"MultiPolygon\"");
}

static bool has_escape(const json_scanner *string)
{
    return memchr(string->at, '\\', (size_t)(string->end - string->at)) != NULL;
}

/// Put the next number in the place of an array, and go on behind it. One without numbers or with anything else stays.
static bool lift_array(lifting *job)
{
    geojson_lift *lift = job->lift;
    void *arrays = lift->arrays;
    const char *begin = job->scan.at;
    json_scanner ahead = {begin + 1, job->scan.end};
    if (json_scan_at(&ahead, ']'))
        return json_scan_value(&job->scan);
    ahead.at = begin;
    if (!json_scan_numbers(&ahead, DEEPEST_ARRAY))
        return json_scan_value(&job->scan);
    bool grown = array_grow(&arrays, &lift->capacity, lift->count + 1, sizeof *lift->arrays);
    lift->arrays = arrays;
    if (!grown)
        return false;
    text_append(&lift->text, job->copied, (size_t)(begin - job->copied));
    size_t newlines = json_scan_newlines(begin, ahead.at);
    char *out = text_reserve(&lift->text, NUMBER_TEXT_SIZE + newlines);
    if (out == NULL)
        return false;
    *out++ = '[';
    out = number_write_fixed(out, (int64_t)lift->count, 0);
    memset(out, '\n', newlines);
    out[newlines] = ']';
    text_advance(&lift->text, out + newlines + 1);
    lift->arrays[lift->count++] = begin;
    job->copied = job->scan.at = ahead.at;
    return true;
}

static bool lift_object(lifting *job, size_t depth);

static bool lift_objects(lifting *job, size_t depth)
{
    (void)json_scan_take(&job->scan, '[');
    for (size_t i = 0; json_scan_element(&job->scan, i); i++)
        if (!(json_scan_at(&job->scan, '{') ? lift_object(job, depth) : json_scan_value(&job->scan)))
            return false;
    return true;
}

/// Lift what the members of an object of this type hold. False where only the parser can tell what is what.
static bool lift_object(lifting *job, size_t depth)
{
    json_scanner *scan = &job->scan, key;
    const json_scanner type = find_type(*scan);
    if (depth > DEEPEST_GEOMETRY || has_escape(&type))
        return false;
    (void)json_scan_take(scan, '{');
    do
    {
        if (!json_scan_key(scan, &key) || has_escape(&key))
            return false;
        bool lifted;
        if (json_scan_is(&key, "geometry") && json_scan_is(&type, "\"Feature\"") && json_scan_at(scan, '{'))
            lifted = lift_object(job, depth + 1);
        else if (json_scan_is(&key, "geometries") && json_scan_is(&type, "\"GeometryCollection\"") &&
                 json_scan_at(scan, '['))
            lifted = lift_objects(job, depth + 1);
        else if (json_scan_is(&key, "coordinates") && is_curves(&type) && json_scan_at(scan, '['))
            lifted = lift_array(job);
        else
            lifted = json_scan_value(scan);
        if (!lifted)
            return false;
    } while (json_scan_take(scan, ','));
    return json_scan_take(scan, '}');
}

bool geojson_lift_text(geojson_lift *lift, const char *begin, const char *end)
{
    lifting job = {{begin, end}, begin, lift};
    lift->text.size = 0;
    lift->count = 0;
    if (!json_scan_at(&job.scan, '{') || !lift_object(&job, 0) || lift->count == 0)
        return false;
    text_append(&lift->text, job.copied, (size_t)(end - job.copied));
    return !lift->text.failed;
}

void geojson_lift_free(geojson_lift *lift)
{
    text_free(&lift->text);
    free(lift->arrays);
    *lift = (geojson_lift){0};
}
