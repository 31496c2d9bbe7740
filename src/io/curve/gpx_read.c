#include "io/curve/gpx.h"

#include "io/common/xml_parse.h"

/// @file
/// Reader of GPX.

/// What an element is.
typedef enum gpx_role
{
    ROLE_OUTSIDE,
    ROLE_ROOT,
    ROLE_TRACK,
    ROLE_SEGMENT,
    ROLE_ROUTE,
    ROLE_WAYPOINT,
    ROLE_POINT, ///< of a segment or route
    ROLE_VALUE, ///< an element in a point
    ROLE_OTHER
} gpx_role;

#define MAX_DEPTH 64

typedef struct open_element
{
    gpx_role role;
    text_range tag; ///< its start tag, in the text that it went to
    bool parent;    ///< it contains elements
} open_element;

typedef struct gpx_reader
{
    xml_parse xml;
    const bat_curve_read_options *options;
    gpx_source *source;
    curve_builder builder; ///< each point has its altitude and its place as channels
    geojson_document document;
    size_t prefix; ///< of the names of GPX, with its colon, as a length
    char root[EXCERPT_SIZE];
    open_element open[MAX_DEPTH + 1];
    size_t depth;
    text_buffer *sink;             ///< what receives the text of the file
    text_buffer gap;               ///< after a point, before the next one
    text_buffer late;              ///< of the gaps, what is no blanks
    text_buffer first_tag;         ///< the start tag of the curve's first point, without its end
    text_buffer text;              ///< of the innermost element
    gpx_curve curve;               ///< the current one
    bool timed;                    ///< one of its points has a time
    bool flat;                     ///< a feature has no altitudes
    json_t *properties, *geometry; ///< of the current feature
    double waypoint[3];
    size_t waypoint_numbers;
    size_t points, dropped, first_dropped; ///< in the file; lines of one point, and the line of the first
    bool crowded;                          ///< there are more values than columns
} gpx_reader;

/// Fail at the parser's line.
#define FAIL(reader, status, ...) XML_FAIL(&(reader)->xml, status, __VA_ARGS__)

static bool fail_memory(gpx_reader *reader)
{
    return xml_stop(&reader->xml, error_memory(reader->xml.error, reader->source->contents.capacity));
}

/// The name of an element of GPX without its prefix; an empty text for another namespace.
static const char *plain_name(const gpx_reader *reader, const char *name)
{
    if (strncmp(name, reader->root, reader->prefix) != 0)
        return "";
    name += reader->prefix;
    return strchr(name, ':') == NULL ? name : "";
}

/// The name without any prefix.
static const char *local_name(const char *name)
{
    const char *colon = strrchr(name, ':');
    return colon != NULL ? colon + 1 : name;
}

static csv_field trimmed(const char *begin, const char *end)
{
    while (begin < end && strchr(" \t\r\n", *begin) != NULL)
        begin++;
    while (end > begin && strchr(" \t\r\n", end[-1]) != NULL)
        end--;
    return (csv_field){begin, end};
}

static csv_field trimmed_text(const text_buffer *text)
{
    return text->size > 0 ? trimmed(text->data, text->data + text->size) : (csv_field){"", ""};
}

/// Read longitude and latitude. False after a failure.
static bool read_position(gpx_reader *reader, const XML_Char **attributes, double position[2])
{
    static const char *const names[] = {"lon", "lat"};
    for (size_t i = 0; i < 2; i++)
    {
        const char *text = xml_attribute(attributes, names[i]);
        csv_field field = trimmed(text != NULL ? text : "", text != NULL ? text + strlen(text) : "");
        char excerpt[EXCERPT_SIZE];
        if (field.begin == field.end)
            return FAIL(reader, BAT_BAD_FILE, "a point has no attribute %s", names[i]);
        const char *fault = number_read(field.begin, field.end, &position[i]);
        if (fault != NULL)
            return FAIL(reader, BAT_BAD_FILE, "the attribute %s '%s' %s", names[i],
                        text_excerpt(excerpt, field.begin, field.end), fault);
    }
    const char *fault = degrees_fault(position[0], position[1]);
    return fault == NULL || FAIL(reader, BAT_BAD_FILE, "%s", fault);
}

/// Begin a feature with these properties and no geometry. Null after a failure.
static bool begin_feature(gpx_reader *reader)
{
    geojson_document *document = &reader->document;
    json_t *properties = json_object();
    json_t *tree = json_pack("{s:s, s:n, s:O?}", "type", "Feature", "geometry", "properties", properties);
    reader->properties = properties;
    json_decref(properties);
    const geojson_feature feature = {.tree = tree,
                                     .line = xml_line(&reader->xml),
                                     .curve = reader->builder.curve_count,
                                     .geometry = document->geometry_count};
    if (tree != NULL && ARRAY_ADD(document->features, document->feature_capacity, document->feature_count, feature))
        return true;
    json_decref(tree);
    reader->properties = NULL;
    return fail_memory(reader);
}

/// Take the altitudes out of the channels of a feature's curves where a point has none. Returns whether it did.
static bool drop_altitudes(bat_curve *curves, size_t count)
{
    bool flat = false;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < curves[i].count; k++)
            flat = flat || !isfinite(curves[i].channels[k * curves[i].channel_count]);
    for (size_t i = 0; i < count && flat; i++)
    {
        double *channels = curves[i].channels;
        for (size_t k = 0; k < curves[i].count; k++)
            memmove(channels + k * CSV_PLACE_CHANNELS, channels + k * (1 + CSV_PLACE_CHANNELS) + 1,
                    CSV_PLACE_CHANNELS * sizeof *channels);
        curves[i].channel_count = CSV_PLACE_CHANNELS;
    }
    return flat;
}

/// Give the current feature its curves as a geometry.
static void end_lines(gpx_reader *reader)
{
    geojson_document *document = &reader->document;
    geojson_feature *feature = &document->features[document->feature_count - 1];
    feature->curve_count = reader->builder.curve_count - feature->curve;
    reader->properties = NULL;
    if (feature->curve_count == 0)
        return;
    bool flat = drop_altitudes(reader->builder.curves + feature->curve, feature->curve_count);
    reader->flat = reader->flat || flat;
    const geojson_geometry lines = {.curve_count = feature->curve_count};
    json_t *geometry = json_pack(
        "{s:s, s:i}", "type", GEOMETRY_NAMES[feature->curve_count > 1 ? GEOMETRY_LINES : GEOMETRY_LINE], "coordinates", 0);
    feature->geometry_count = 1;
    if (json_object_set_new(feature->tree, "geometry", geometry) != 0 ||
        !ARRAY_ADD(document->geometries, document->geometry_capacity, document->geometry_count, lines) ||
        !geojson_document_reserve(document, 0, reader->builder.curve_count))
    {
        fail_memory(reader);
        return;
    }
    for (size_t i = 0; i < feature->curve_count; i++)
        document->origins[document->curve_count++] = (stitch_origin){i, 0};
}

/// Keep where the bounds of the file stand, which grow with the curves. They stand before all points.
static void take_bounds(gpx_reader *reader, text_range tag, const XML_Char **attributes)
{
    static const char *const names[] = {"minlon", "minlat", "maxlon", "maxlat"};
    gpx_source *source = reader->source;
    bool known = source->bounds.end == 0 && source->curve_count == 0 && reader->sink == &source->frame;
    for (size_t i = 0; i < sizeof names / sizeof *names && known; i++)
    {
        const char *text = xml_attribute(attributes, names[i]);
        known = text != NULL && number_read(text, text + strlen(text), &source->box[i]) == NULL;
    }
    if (known)
        source->bounds = tag;
}

/// Take the blanks at the end of the frame, before the first point of a curve.
static void take_indent(gpx_reader *reader)
{
    text_buffer *frame = &reader->source->frame, *tags = &reader->source->tags;
    csv_field inner = trimmed_text(frame);
    size_t size = (size_t)(inner.end - frame->data);
    reader->curve.indent = (text_range){tags->size, tags->size + frame->size - size};
    text_append(tags, inner.end, frame->size - size);
    frame->size = size;
}

static void begin_point(gpx_reader *reader, const char *name, const XML_Char **attributes)
{
    gpx_source *source = reader->source;
    double position[2], *channels;
    if (!read_position(reader, attributes, position))
        return;
    if (reader->curve.row_count++ == 0)
    {
        take_indent(reader);
        reader->curve.tag = (text_range){source->tags.size, source->tags.size + strlen(name)};
        text_append_string(&source->tags, name);
        reader->first_tag.size = 0;
        reader->sink = &reader->first_tag;
        XML_DefaultCurrent(reader->xml.parser);
    }
    else if (trimmed_text(&reader->gap).begin != trimmed_text(&reader->gap).end)
        text_append(&reader->late, reader->gap.data, reader->gap.size);
    reader->gap.size = 0;
    reader->points++;
    const gpx_row row = {source->contents.size, source->value_count};
    double *point = builder_next(&reader->builder, 1 + CSV_PLACE_CHANNELS, &channels);
    if (point == NULL || !builder_line(&reader->builder, xml_line(&reader->xml)) ||
        !ARRAY_ADD(source->rows, source->row_capacity, source->row_count, row) || source->tags.failed)
    {
        fail_memory(reader);
        return;
    }
    if (reader->builder.space.point_dim == 3)
        degrees_to_point(position[0], position[1], point);
    else
        memcpy(point, position, sizeof position);
    channels[0] = NAN;
    reader->sink = &source->contents;
}

static void end_point(gpx_reader *reader)
{
    gpx_source *source = reader->source;
    curve_builder *builder = &reader->builder;
    size_t row = source->row_count - 1, index = builder->point_count;
    builder->channels[index * builder->channel_count] = gpx_altitude(source, row);
    reader->sink = &reader->gap;
    bool dropped = false;
    (void)builder_admit(builder);
    const char *fault = builder_drop_repeat(builder, false, &dropped);
    if (fault != NULL)
        FAIL(reader, BAT_BAD_FILE, "%s", fault);
    else if (!dropped && !ARRAY_ADD(source->point_rows, source->point_capacity, source->point_count, row))
        fail_memory(reader);
}

/// Put the rows of the current curve into the frame. They all have the position of its first point.
static void leave_rows(gpx_reader *reader)
{
    gpx_source *source = reader->source;
    text_buffer *frame = &source->frame, *tag = &reader->first_tag;
    const gpx_curve *curve = &reader->curve;
    tag->size -= tag->size > 1 && tag->data[tag->size - 2] == '/' ? 2 : tag->size > 0;
    for (size_t row = curve->row; row < source->row_count; row++)
    {
        size_t begin = source->rows[row].content;
        size_t end = row + 1 < source->row_count ? source->rows[row + 1].content : source->contents.size;
        text_append(frame, source->tags.data + curve->indent.begin, curve->indent.end - curve->indent.begin);
        text_append(frame, tag->data, tag->size);
        text_append_string(frame, ">");
        if (end > begin)
            text_append(frame, source->contents.data + begin, end - begin);
        text_append_string(frame, "</");
        text_append(frame, source->tags.data + curve->tag.begin, curve->tag.end - curve->tag.begin);
        text_append_string(frame, ">");
    }
}

/// Take a curve of too few points out of those to refine.
static void drop_curve(gpx_reader *reader)
{
    gpx_source *source = reader->source;
    if (reader->options->strict)
        FAIL(reader, BAT_BAD_FILE, "a line needs at least 2 different points");
    if (reader->dropped++ == 0)
        reader->first_dropped = xml_line(&reader->xml);
    const gpx_row row = source->rows[reader->curve.row];
    source->contents.size = row.content;
    source->value_count = row.value;
    source->row_count = reader->curve.row;
    source->point_count = reader->curve.point;
    reader->builder.line_count -= reader->builder.point_count;
    reader->builder.point_count = 0;
}

/// Whether the curve is closed. A last point that repeats the first is taken off.
static bool close_curve(gpx_reader *reader)
{
    static const int RING_POINTS = 4;
    curve_builder *builder = &reader->builder;
    size_t dim = builder->space.point_dim, last = builder->point_count - 1;
    int wanted = reader->options->closed;
    bool returns = last > 0 && points_equal(builder->points, builder->points + last * dim, dim);
    bool closed = wanted < 0 ? returns && !reader->timed && builder->point_count >= RING_POINTS : wanted > 0;
    reader->curve.returning = closed && returns;
    if (!reader->curve.returning)
        return closed;
    builder->point_count--;
    builder->line_count--;
    reader->source->point_count--;
    return true;
}

static void end_curve(gpx_reader *reader)
{
    gpx_source *source = reader->source;
    curve_builder *builder = &reader->builder;
    reader->sink = &source->frame;
    reader->curve.frame = source->frame.size;
    bool closed = reader->curve.row_count > 0 && close_curve(reader);
    size_t count = builder->point_count;
    bool few = count < (closed ? 3 : 2);
    if (few && count == 1)
        leave_rows(reader);
    text_append(&source->frame, reader->late.data, reader->late.size);
    text_append(&source->frame, reader->gap.data, reader->gap.size);
    reader->gap.size = 0;
    if (few && reader->curve.row_count > 0)
        drop_curve(reader);
    if (few)
        return;
    for (size_t i = 0; i < count; i++)
    {
        double *channels = builder->channels + i * builder->channel_count;
        cells_place(i, count, closed, channels + 1);
    }
    if (!builder_end_curve(builder, closed) ||
        !ARRAY_ADD(source->curves, source->curve_capacity, source->curve_count, reader->curve))
        fail_memory(reader);
}

/// The role of an element, by its name and its parent.
static gpx_role role_of(const gpx_reader *reader, const char *name)
{
    static const struct
    {
        gpx_role parent;
        const char *name;
        gpx_role role;
    } roles[] = {{ROLE_ROOT, "trk", ROLE_TRACK},      {ROLE_ROOT, "rte", ROLE_ROUTE},
                 {ROLE_ROOT, "wpt", ROLE_WAYPOINT},   {ROLE_TRACK, "trkseg", ROLE_SEGMENT},
                 {ROLE_SEGMENT, "trkpt", ROLE_POINT}, {ROLE_ROUTE, "rtept", ROLE_POINT}};
    gpx_role parent = reader->open[reader->depth].role;
    const char *plain = plain_name(reader, name);
    for (size_t i = 0; i < sizeof roles / sizeof *roles; i++)
        if (roles[i].parent == parent && strcmp(plain, roles[i].name) == 0)
            return roles[i].role;
    return parent == ROLE_POINT || parent == ROLE_VALUE ? ROLE_VALUE : ROLE_OTHER;
}

static void XMLCALL on_begin(void *context, const XML_Char *name, const XML_Char **attributes)
{
    gpx_reader *reader = context;
    if (reader->xml.status != BAT_OK)
        return;
    if (reader->depth == MAX_DEPTH)
    {
        FAIL(reader, BAT_BAD_FILE, "elements are nested more than %d deep", MAX_DEPTH);
        return;
    }
    if (reader->depth == 0)
    {
        const char *local = local_name(name);
        reader->prefix = (size_t)(local - name);
        if (strcmp(local, "gpx") != 0 || reader->prefix >= sizeof reader->root)
            FAIL(reader, BAT_BAD_FILE, "the file is no GPX: its outer element is not <gpx>");
        else
            memcpy(reader->root, name, reader->prefix);
    }
    gpx_role role = reader->depth == 0 ? ROLE_ROOT : role_of(reader, name);
    const char *link =
        role == ROLE_OTHER && strcmp(local_name(name), "link") == 0 ? xml_attribute(attributes, "href") : NULL;
    if (role == ROLE_POINT)
        begin_point(reader, name, attributes);
    else if (role == ROLE_TRACK || role == ROLE_ROUTE)
        (void)begin_feature(reader);
    else if (role == ROLE_WAYPOINT)
    {
        reader->waypoint_numbers = 2;
        reader->source->waypoints++;
        if (read_position(reader, attributes, reader->waypoint))
            (void)begin_feature(reader);
    }
    if (reader->xml.status != BAT_OK)
        return;
    size_t begin = reader->sink->size;
    if (role != ROLE_POINT)
        XML_DefaultCurrent(reader->xml.parser);
    if (role == ROLE_SEGMENT || role == ROLE_ROUTE)
    {
        reader->curve = (gpx_curve){.row = reader->source->row_count, .point = reader->source->point_count};
        reader->timed = false;
        reader->late.size = 0;
    }
    if (role == ROLE_OTHER && reader->depth <= 2 && strcmp(plain_name(reader, name), "bounds") == 0)
        take_bounds(reader, (text_range){begin, reader->sink->size}, attributes);
    if (link != NULL && reader->properties != NULL)
        (void)json_object_set_new(reader->properties, "link", json_string(link));
    reader->open[reader->depth].parent = true;
    reader->open[++reader->depth] = (open_element){role, {begin, reader->sink->size}, false};
    reader->text.size = 0;
}

/// The column of the innermost element; BAT_NO_INDEX where there are too many.
static size_t find_column(gpx_reader *reader, const char *name)
{
    gpx_source *source = reader->source;
    const char *contents = source->contents.data;
    char key[1024];
    size_t size = 0, own = 0;
    for (size_t i = 1; i <= reader->depth; i++)
    {
        const open_element *element = &reader->open[i];
        if (element->role != ROLE_VALUE)
            continue;
        size_t length = element->tag.end - element->tag.begin;
        if (length > sizeof key - size)
            return BAT_NO_INDEX;
        own = size;
        memcpy(key + size, contents + element->tag.begin, length);
        size += length;
    }
    size_t column = gpx_column_find(source, key, size, own, local_name(name));
    if (column == BAT_NO_INDEX && source->tags.failed)
        fail_memory(reader);
    return column;
}

/// Take the text of an element of a point.
static void take_value(gpx_reader *reader, const char *name)
{
    gpx_source *source = reader->source;
    csv_field field = trimmed_text(&reader->text);
    if (field.begin == field.end)
        return;
    size_t column = find_column(reader, name);
    reader->crowded = reader->crowded || column == BAT_NO_INDEX;
    if (column == BAT_NO_INDEX)
        return;
    const gpx_value value = {column, {source->texts.size, source->texts.size + (size_t)(field.end - field.begin)}};
    text_append(&source->texts, field.begin, (size_t)(field.end - field.begin));
    if (source->texts.failed || !ARRAY_ADD(source->values, source->value_capacity, source->value_count, value))
        fail_memory(reader);
    reader->timed = reader->timed || (source->columns[column].direct && strcmp(plain_name(reader, name), "time") == 0);
}

/// Take the text of an element of a track, route or waypoint as a property.
static void take_property(gpx_reader *reader, const char *name)
{
    csv_field field = trimmed_text(&reader->text);
    const char *local = local_name(name);
    size_t size = (size_t)(field.end - field.begin);
    double value;
    bool direct = reader->open[reader->depth - 1].role == ROLE_WAYPOINT;
    if (direct && strcmp(plain_name(reader, name), "ele") == 0 && number_read(field.begin, field.end, &value) == NULL)
    {
        reader->waypoint[2] = value;
        reader->waypoint_numbers = 3;
    }
    else if (size > 0 && json_object_get(reader->properties, local) == NULL &&
             json_object_set_new(reader->properties, local, json_stringn(field.begin, size)) != 0)
        fail_memory(reader);
}

static void XMLCALL on_end(void *context, const XML_Char *name)
{
    gpx_reader *reader = context;
    if (reader->xml.status != BAT_OK)
        return;
    const open_element *element = &reader->open[reader->depth];
    if (element->role == ROLE_SEGMENT || element->role == ROLE_ROUTE)
        end_curve(reader);
    if (element->role == ROLE_POINT)
        end_point(reader);
    else
        XML_DefaultCurrent(reader->xml.parser);
    if (element->role == ROLE_VALUE && !element->parent)
        take_value(reader, name);
    else if (element->role == ROLE_OTHER && !element->parent && reader->properties != NULL)
        take_property(reader, name);
    else if (element->role == ROLE_WAYPOINT)
    {
        geojson_feature *feature = &reader->document.features[reader->document.feature_count - 1];
        json_t *position = json_array();
        bool made = position != NULL;
        for (size_t i = 0; i < reader->waypoint_numbers && made; i++)
            made = json_array_append_new(position, json_real(reader->waypoint[i])) == 0;
        json_t *geometry = json_pack("{s:s, s:o}", "type", GEOMETRY_NAMES[GEOMETRY_POINT], "coordinates", position);
        if (!made || json_object_set_new(feature->tree, "geometry", geometry) != 0)
            fail_memory(reader);
        reader->properties = NULL;
    }
    else if (element->role == ROLE_TRACK || element->role == ROLE_ROUTE)
        end_lines(reader);
    reader->depth--;
    reader->text.size = 0;
}

static void XMLCALL on_text(void *context, const XML_Char *text, int size)
{
    gpx_reader *reader = context;
    if (reader->xml.status != BAT_OK)
        return;
    text_append(&reader->text, text, (size_t)size);
    XML_DefaultCurrent(reader->xml.parser);
}

static void XMLCALL on_raw(void *context, const XML_Char *text, int size)
{
    gpx_reader *reader = context;
    text_append(reader->sink, text, (size_t)size);
    if (reader->sink->failed || reader->text.failed)
        fail_memory(reader);
}

/// The text that is kept is UTF-8, whatever the file is.
static void XMLCALL on_declaration(void *context, const XML_Char *version, const XML_Char *encoding, int standalone)
{
    (void)version, (void)encoding, (void)standalone;
    text_append_string(&((gpx_reader *)context)->source->frame, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
}

/// Choose the space: longitudes and latitudes on the sphere, or as numbers of the plane.
static bat_status choose_space(const bat_curve_read_options *options, bat_space *space, bat_error *error)
{
    const char *name = options->space != NULL ? options->space : "sphere";
    if (strcmp(name, "euclidean") == 0)
        name = "plane";
    if (strcmp(name, "sphere") != 0 && strcmp(name, "plane") != 0)
        return ERROR_UNSUPPORTED(error, 0, "GPX cannot hold points of the space %.60s", name);
    return bat_space_by_name(name, 0, space, error);
}

static bool add_notes(const gpx_reader *reader, bat_curve_attributes *attributes)
{
    const gpx_source *source = reader->source;
    bool done = true;
    if (source->repeats > 0)
        done = attributes_note(attributes, "%zu point%s the one before %s, the first on line %zu; GPX alone keeps them",
                               source->repeats, source->repeats == 1 ? " repeats" : "s repeat",
                               source->repeats == 1 ? "it" : "them", reader->builder.first_repeat);
    if (done && reader->dropped > 0)
        done = attributes_note(
            attributes,
            "left out %zu line%s with too few different points, the first ends on line %zu; GPX keeps single points",
            reader->dropped, reader->dropped == 1 ? "" : "s", reader->first_dropped);
    if (done && reader->crowded)
        done = attributes_note(attributes, "only %d kinds of values have ones between, others stay at the given points",
                               GPX_MAX_COLUMNS);
    return done;
}

static void free_source(struct gpx_source *source)
{
    gpx_source_free(source);
    free(source);
}

static bat_status finish(gpx_reader *reader, bat_curve_set *set)
{
    gpx_source *source = reader->source;
    curve_builder *builder = &reader->builder;
    bool altitude = !reader->flat, globe = builder->space.point_dim == 3;
    const gpx_row end = {source->contents.size, source->value_count};
    source->repeats = builder->repeats;
    if (!ARRAY_GROW(source->rows, source->row_capacity, source->row_count + 1))
        return error_memory(reader->xml.error, sizeof end);
    source->rows[source->row_count] = end;
    gpx_columns_sort(source);
    bat_curve_attributes *attributes = gpx_attributes_make(source, builder, altitude, globe);
    reader->document.collection = json_pack("{s:s, s:[]}", "type", "FeatureCollection", "features");
    if (attributes == NULL || reader->document.collection == NULL || !add_notes(reader, attributes))
    {
        attributes_release(attributes);
        return error_memory(reader->xml.error, source->contents.size);
    }
    reader->document.gpx = source;
    reader->document.gpx_free = free_source;
    reader->source = NULL;
    if (!geojson_document_keep(&reader->document, attributes))
    {
        attributes_release(attributes);
        return error_memory(reader->xml.error, sizeof *attributes);
    }
    return builder_finish(builder, attributes, set, reader->xml.error);
}

bat_status gpx_read(const file_text *text, const bat_curve_read_options *options, bat_curve_set *set, bat_error *error)
{
    bat_error unread;
    gpx_reader *reader = calloc(1, sizeof *reader);
    gpx_source *source = calloc(1, sizeof *source);
    error = error != NULL ? error : &unread;
    bat_status status = reader != NULL && source != NULL ? BAT_OK : error_memory(error, sizeof *reader);
    if (status == BAT_OK)
    {
        *reader = (gpx_reader){.options = options, .source = source, .sink = &source->frame};
        reader->xml = (xml_parse){.prefix = "XML: ",
                                  .doctype = "a document type is not allowed in GPX",
                                  .doctype_fault = BAT_BAD_FILE,
                                  .error = error};
        reader->builder.strict = options->strict;
        status = choose_space(options, &reader->builder.space, error);
    }
    if (status == BAT_OK)
        status = xml_begin(&reader->xml, NULL, on_begin, on_end);
    if (status == BAT_OK)
    {
        XML_SetCharacterDataHandler(reader->xml.parser, on_text);
        XML_SetDefaultHandler(reader->xml.parser, on_raw);
        XML_SetXmlDeclHandler(reader->xml.parser, on_declaration);
        status = xml_text(&reader->xml, text);
    }
    if (status == BAT_OK && reader->builder.curve_count == 0)
        status = ERROR_FILE(error, 0, "there are no lines or polygons%s",
                            source->waypoints > 0 ? ", only waypoints" : ": no track or route has two points");
    if (status == BAT_OK)
        status = finish(reader, set);
    if (reader != NULL)
    {
        source = reader->source;
        builder_free(&reader->builder);
        geojson_document_free(&reader->document);
        text_free(&reader->gap);
        text_free(&reader->late);
        text_free(&reader->first_tag);
        text_free(&reader->text);
    }
    if (source != NULL)
        free_source(source);
    free(reader);
    return status;
}
