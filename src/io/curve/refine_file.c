#include "base/atomic_file.h"
#include "base/option.h"
#include "base/progress.h"
#include "curve/refine.h"
#include "io/curve/formats.h"
#include "io/curve/geojson.h"
#include "io/gis/gis.h"

#include <errno.h>

/// @file
/// From a file of curves to a file of refined ones. Sequences of GeoJSON go through memory part by part.

enum
{
    FIRST_BYTES = 1 << 16, ///< of the first part
    MIN_BYTES = 1 << 14,   ///< of a part
    MAX_BYTES = 1 << 22,
    PART_POINTS = 1 << 20, ///< refined points of a part, unless it is a single feature
    READ_BYTES = 1 << 18   ///< read together
};

/// A sequence that is read part by part.
typedef struct record_stream
{
    FILE *file;
    size_t size, done;     ///< bytes of the file, 0 where unknown, and those that were read
    text_buffer text;      ///< the bytes that were read and not used, with a final zero
    size_t line;           ///< of their first byte
    bool separated;        ///< as in record_scan
    bool ended;            ///< the file has no more bytes
    size_t wanted;         ///< bytes of the next part
    feature_text *records; ///< of the current part
    size_t count, capacity;
    size_t used; ///< bytes of the current part
} record_stream;

typedef struct file_job
{
    const bat_curve_refine_file_options *options;
    bat_curve_format format; ///< of the output
    bool follows;            ///< the output has the format of the input
    text_sink sink;
    geojson_reader reader;
    record_stream stream;
    bat_curve_refine_report done;
    bat_curve_refine_file_report report;
    bat_error *error;
} file_job;

bat_curve_refine_file_options bat_curve_refine_file_defaults(void)
{
    return (bat_curve_refine_file_options){
        .read = bat_curve_read_defaults(), .refine = bat_curve_refine_defaults(), .write = bat_curve_write_defaults()};
}

static const option_field FIELDS[] = {
    OPTION_STRUCT(bat_curve_refine_file_options, read, bat_curve_read_fields),
    OPTION_STRUCT(bat_curve_refine_file_options, refine, bat_curve_refine_fields),
    OPTION_STRUCT(bat_curve_refine_file_options, write, bat_curve_write_fields),
};

const bat_options_table bat_curve_refine_file_fields = OPTIONS_TABLE(bat_curve_refine_file_options, FIELDS, NULL);

static bat_status stream_open(const char *path, record_stream *stream, bat_error *error)
{
    struct stat about;
    bool standard = strcmp(path, "-") == 0;
    *stream = (record_stream){.file = standard ? stdin : fopen(path, "rb"), .line = 1, .wanted = FIRST_BYTES};
    if (stream->file == NULL)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot open: %s", strerror(errno));
    bool regular = fstat(fileno(stream->file), &about) == 0 && S_ISREG(about.st_mode);
    stream->size = regular && about.st_size > 0 ? (size_t)about.st_size : 0;
    return BAT_OK;
}

/// Read until there are `wanted` bytes, or the file ends.
static bat_status stream_fill(record_stream *stream, size_t wanted, bat_error *error)
{
    while (!stream->ended && stream->text.size < wanted)
    {
        char *place = text_reserve(&stream->text, READ_BYTES);
        if (place == NULL)
            return error_memory(error, stream->text.size + READ_BYTES);
        size_t got = fread(place, 1, READ_BYTES, stream->file);
        stream->text.size += got;
        stream->done += got;
        stream->ended = got < READ_BYTES;
        place[got] = '\0';
    }
    if (ferror(stream->file))
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot read: %s", strerror(errno));
    return BAT_OK;
}

static void stream_drop(record_stream *stream)
{
    text_buffer *text = &stream->text;
    if (stream->used == 0)
        return;
    memmove(text->data, text->data + stream->used, text->size - stream->used + 1);
    text->size -= stream->used;
    stream->used = 0;
}

/// Skip a byte order mark, and find how records are separated. This needs a byte that is not blank.
static bat_status stream_start(record_stream *stream, bat_error *error)
{
    static const char MARK[] = "\xEF\xBB\xBF";
    bat_status status = stream_fill(stream, sizeof MARK, error);
    if (status == BAT_OK && stream->text.size >= sizeof MARK - 1 && memcmp(stream->text.data, MARK, sizeof MARK - 1) == 0)
    {
        stream->used = sizeof MARK - 1;
        stream_drop(stream);
    }
    stream->separated = stream->text.size > 0 && record_scan_start(stream->text.data, stream->text.size, 1).separated;
    return status;
}

/// Collect the complete records among the bytes that were read. False when out of memory.
static bool collect_records(record_stream *stream)
{
    record_scan scan = {stream->text.data, stream->text.data + stream->text.size, stream->line, stream->separated};
    feature_text record;
    stream->count = 0;
    while (record_scan_next(&scan, stream->ended, &record))
    {
        if (!ARRAY_ADD(stream->records, stream->capacity, stream->count, record))
            return false;
        if ((size_t)(scan.at - stream->text.data) >= stream->wanted)
            break;
    }
    stream->used = (size_t)(scan.at - stream->text.data);
    stream->line = scan.line;
    return true;
}

/// Read the next part; it has no records at the end of the file.
static bat_status stream_next(record_stream *stream, bat_error *error)
{
    bat_status status = BAT_OK;
    stream_drop(stream);
    for (size_t bytes = stream->wanted; status == BAT_OK; bytes = 2 * stream->text.size)
    {
        status = stream_fill(stream, bytes, error);
        if (status == BAT_OK && stream->text.size > 0 && !collect_records(stream))
            status = error_memory(error, stream->capacity * sizeof *stream->records);
        if (stream->text.size == 0)
            stream->count = 0;
        if (stream->count > 0 || stream->ended)
            break;
    }
    return status;
}

static size_t count_points(const bat_curve_set *set)
{
    size_t count = 0;
    for (size_t i = 0; i < set->count; i++)
        count += set->curves[i].count;
    return count;
}

/// Put the feature, with its id, before the text of an error about a curve.
static bat_status fail_in_feature(const bat_curve_set *set, size_t curve, size_t before, bat_error *error)
{
    const geojson_document *document = set->attributes->remainder.content;
    size_t i = 0;
    while (i < document->feature_count &&
           (curve < document->features[i].curve || curve >= document->features[i].curve + document->features[i].curve_count))
        i++;
    if (error == NULL || i == document->feature_count)
        return error != NULL ? error->status : BAT_INVALID_ARGUMENT;
    const geojson_feature *feature = &document->features[i];
    char name[160] = "";
    geojson_append_place(name, sizeof name, "feature", before + i);
    geojson_append_id(name, sizeof name, feature->tree);
    geojson_append_place(name, sizeof name, "curve", feature->curve_count > 1 ? curve - feature->curve : BAT_NO_INDEX);
    bat_error whole = *error;
    (void)snprintf(whole.text, sizeof whole.text, "%s: %.100s", name, error->text);
    whole.line = feature->line;
    *error = whole;
    return error->status;
}

/// Refine a set into another one, which is empty on failure.
static bat_status refine_set(file_job *job, const bat_curve_set *coarse, bat_progress progress, bat_curve_set *fine)
{
    bat_curve *curves = memory_array(coarse->count > 0 ? coarse->count : 1, sizeof *curves);
    if (curves == NULL)
        return error_memory(job->error, coarse->count * sizeof *curves);
    bat_curve_refine_report done = {0};
    bat_curve_refine_options how = job->options->refine;
    how.progress = progress;
    how.report = &done;
    bat_status status = bat_curves_refine(coarse->curves, coarse->count, &how, curves, job->error);
    if (status == BAT_OK)
    {
        status = bat_curve_set_like(coarse, curves, fine, job->error);
        for (size_t i = 0; i < coarse->count && status != BAT_OK; i++)
            bat_curve_free(&curves[i]);
    }
    if (status != BAT_OK)
    {
        free(curves);
        return status;
    }
    if (coarse->count > 0)
    {
        if (job->report.curves == 0)
            job->done.min_levels = SIZE_MAX;
        refine_report_add(&job->done, &done);
    }
    job->report.curves += coarse->count;
    job->report.coarse_points += count_points(coarse);
    job->report.fine_points += count_points(fine);
    if (job->options->visit != NULL && !job->options->visit(job->options->context, coarse, fine))
        status = error_set(job->error, BAT_CANCELLED, BAT_NO_INDEX, 0, "cancelled");
    return status;
}

/// Tell that a failure is of the output, the second file of the call.
static bat_status of_output(const file_job *job, bat_status status)
{
    return error_operand(job->error, status, 1);
}

/// Refine the records of a part and write them.
static bat_status refine_part(file_job *job, bat_progress progress)
{
    bat_curve_set coarse = {0}, fine = {0};
    record_stream *stream = &job->stream;
    size_t before = job->report.features, points = job->report.fine_points;
    bat_status status = geojson_records_read(&job->reader, stream->records, stream->count, before, &job->options->read);
    if (status == BAT_OK)
        status = geojson_records_end(
            &job->reader, job->stream.separated ? BAT_CURVE_FORMAT_GEOJSON_SEQUENCE : BAT_CURVE_FORMAT_GEOJSON_LINES,
            &coarse);
    if (status == BAT_OK)
        status = refine_set(job, &coarse, progress, &fine);
    if (status == BAT_OK)
        status = of_output(
            job, geojson_part_write(&fine, job->format, before == 0, &job->options->write, &job->sink, job->error));
    else if (job->error->curve < coarse.count)
        status = fail_in_feature(&coarse, job->error->curve, before, job->error);
    if (status == BAT_OK) // the size of the next part goes by that of this one's result
    {
        double bytes = (double)stream->used * PART_POINTS / (double)(job->report.fine_points - points + 1);
        bytes = fmin(bytes, 4.0 * (double)stream->wanted);
        stream->wanted = bytes < MIN_BYTES ? MIN_BYTES : bytes > MAX_BYTES ? MAX_BYTES : (size_t)bytes;
    }
    job->report.features += stream->count;
    bat_curve_set_free(&coarse);
    bat_curve_set_free(&fine);
    return status;
}

static bat_status write_text(file_job *job, const char *text)
{
    if (job->format != BAT_CURVE_FORMAT_GEOJSON || fputs(text, job->sink.stream) >= 0)
        return BAT_OK;
    return of_output(job, error_set(job->error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot write: %s", strerror(errno)));
}

static bat_status refine_parts(file_job *job)
{
    double done = 0;
    bat_status status = stream_start(&job->stream, job->error);
    if (job->follows)
        job->format = job->stream.separated ? BAT_CURVE_FORMAT_GEOJSON_SEQUENCE : BAT_CURVE_FORMAT_GEOJSON_LINES;
    if (status == BAT_OK)
        status = write_text(job, GEOJSON_COLLECTION_BEGIN);
    while (status == BAT_OK)
    {
        status = stream_next(&job->stream, job->error);
        if (status != BAT_OK || job->stream.count == 0)
            break;
        // All zero where the size is unknown.
        double length = job->stream.size > 0 ? (double)job->stream.used / (double)job->stream.size : 0;
        progress_part part = {job->options->refine.progress, done < 1 - length ? done : 1 - length, length};
        status = refine_part(job, progress_of_part(&part));
        done = part.begin + part.length;
        bat_progress progress = job->options->refine.progress;
        if (status == BAT_OK && progress.report != NULL && !progress.report(progress.context, done))
            status = error_set(job->error, BAT_CANCELLED, BAT_NO_INDEX, 0, "cancelled");
    }
    if (status == BAT_OK && job->report.curves == 0)
        status = ERROR_FILE(job->error, 0, "there are no lines or polygons");
    return status == BAT_OK ? write_text(job, GEOJSON_COLLECTION_END) : status;
}

static bat_status refine_streamed(file_job *job, const char *input, const char *output)
{
    atomic_file file;
    bat_status status = geojson_records_begin(&job->options->read, &job->reader, job->error);
    if (status != BAT_OK)
        return status;
    status = stream_open(input, &job->stream, job->error);
    if (status == BAT_OK)
        status = of_output(job, atomic_file_begin(output, &file, job->error));
    if (status == BAT_OK)
    {
        job->sink = (text_sink){.stream = file.stream};
        job->report.streamed = true;
        bat_status refined = refine_parts(job);
        status = atomic_file_end(&file, refined, job->error);
        status = refined == BAT_OK ? of_output(job, status) : status;
    }
    if (job->stream.file != NULL && job->stream.file != stdin)
        (void)fclose(job->stream.file);
    text_free(&job->stream.text);
    free(job->stream.records);
    job->stream = (record_stream){0};
    geojson_reader_free(&job->reader);
    return status;
}

/// Whether a file can go through memory part by part. Sets the format of the output.
static bool can_stream(const char *input, const char *output, const bat_curve_refine_file_options *options,
                       bat_curve_format *format)
{
    const bat_choice *row = NULL;
    bat_curve_format from = options->read.format;
    if (from == BAT_CURVE_FORMAT_AUTO && bat_choice_of_path(&bat_curve_format_family, input, false, &row, NULL) == BAT_OK)
        from = row != NULL ? (bat_curve_format)row->value : from;
    bool sequence = from == BAT_CURVE_FORMAT_GEOJSON_LINES || from == BAT_CURVE_FORMAT_GEOJSON_SEQUENCE;
    const bat_curve_attributes attributes = {.format = from};
    bool plain = !gis_is_virtual(input) && !gis_is_virtual(output) && options->read.layer == NULL &&
                 !options->read.on_sphere && options->write.crs == NULL;
    return sequence && plain && curve_format_choose(output, &attributes, &options->write, format, NULL) == BAT_OK &&
           attributes_are_geojson(&(bat_curve_attributes){.format = *format});
}

static bat_status refine_whole(file_job *job, const char *input, const char *output)
{
    bat_curve_set coarse = {0}, fine = {0};
    bat_status status = bat_curve_read(input, &job->options->read, &coarse, job->error);
    if (status != BAT_OK)
        return status;
    status = refine_set(job, &coarse, job->options->refine.progress, &fine);
    if (status == BAT_OK)
        status = of_output(job, bat_curve_write(output, &fine, &job->options->write, job->error));
    else if (job->error->curve < coarse.count && attributes_are_geojson(coarse.attributes))
        status = fail_in_feature(&coarse, job->error->curve, 0, job->error);
    bat_curve_set_free(&coarse);
    bat_curve_set_free(&fine);
    return status;
}

bat_status bat_curve_refine_file(const char *input, const char *output, const bat_curve_refine_file_options *options,
                                 bat_curve_refine_file_report *report, bat_error *error)
{
    const bat_curve_refine_file_options defaults = bat_curve_refine_file_defaults();
    bat_error unread;
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_curve_refine_file_fields, options, error);
    if (status != BAT_OK)
        return status;
    if (options->write.report != NULL)
        *options->write.report = (bat_curve_write_report){.first_left_out = BAT_NO_INDEX};
    file_job job = {.options = options, .error = error != NULL ? error : &unread};
    const bat_choice *row;
    (void)bat_choice_of_path(&bat_curve_format_family, output, true, &row, NULL);
    job.follows = options->write.format == BAT_CURVE_FORMAT_AUTO && row == NULL;
    status = can_stream(input, output, options, &job.format) ? refine_streamed(&job, input, output)
                                                             : refine_whole(&job, input, output);
    if (status != BAT_OK)
        return status;
    if (options->refine.report != NULL)
        *options->refine.report = job.done;
    if (report != NULL)
        *report = job.report;
    return BAT_OK;
}
