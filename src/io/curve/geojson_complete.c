#include "io/curve/geojson.h"

#include <stdlib.h>
#include <string.h>

/// @file
/// Completion of GeoJSON geometries whose coordinates have been read: parts that the file cuts at the antimeridian are
/// joined, lines are closed, lines and rings with too few different points are dropped.

/// Make a line closed when its ends are equal; `closed` as in bat_curve_read_options.
static void close_line(bat_curve *curve, int closed)
{
    enum
    {
        RING_POSITIONS = 4
    };
    size_t dim = curve->space->point_dim, last = curve->count - 1, channels = curve->channel_count;
    bool returns = last > 0 && points_equal(curve->points, curve->points + last * dim, dim);
    for (size_t k = 0; k < channels && returns; k++)
        returns = curve->channels[k] == curve->channels[last * channels + k];
    curve->closed = closed < 0 ? returns && curve->count >= RING_POSITIONS : closed > 0;
    if (curve->closed && returns)
        curve->count--;
}

/// Make one point of neighbours that are the same point of the sphere.
static void merge_aliases(bat_curve *curve)
{
    size_t count = 1, channels = curve->channel_count;
    double *points = curve->points;
    for (size_t i = 1; i < curve->count; i++)
    {
        if (points_equal(points + 3 * i, points + 3 * (count - 1), 3))
            continue;
        memmove(points + 3 * count, points + 3 * i, 3 * sizeof *points);
        if (channels > 0)
            memmove(curve->channels + count * channels, curve->channels + i * channels, channels * sizeof *points);
        count++;
    }
    while (curve->closed && count > 1 && points_equal(points, points + 3 * (count - 1), 3))
        count--;
    curve->count = count;
}

/// Move the last curves of the builder, and the polygons, into a geometry. Null arrays when out of memory.
static bool take_geometry(geojson_reader *reader, size_t first_curve, size_t first_polygon, stitch_geometry *geometry)
{
    curve_builder *builder = &reader->builder;
    geojson_document *document = &reader->document;
    size_t curves = builder->curve_count - first_curve, polygons = document->polygon_count - first_polygon;
    *geometry = (stitch_geometry){.curves = memory_array(curves, sizeof *geometry->curves),
                                  .origins = memory_array(curves, sizeof *geometry->origins),
                                  .polygons = memory_array(polygons, sizeof *geometry->polygons)};
    if (geometry->curves == NULL || geometry->origins == NULL || geometry->polygons == NULL)
    {
        stitch_geometry_free(geometry);
        return false;
    }
    memcpy(geometry->curves, builder->curves + first_curve, curves * sizeof *geometry->curves);
    memcpy(geometry->origins, document->origins + first_curve, curves * sizeof *geometry->origins);
    if (polygons > 0)
        memcpy(geometry->polygons, document->polygons + first_polygon, polygons * sizeof *geometry->polygons);
    geometry->count = curves;
    geometry->polygon_count = polygons;
    builder->curve_count = first_curve;
    document->curve_count = first_curve;
    document->polygon_count = first_polygon;
    return true;
}

/// Move the curves of a geometry to the builder, and its polygons to the document.
static bool give_geometry(geojson_reader *reader, stitch_geometry *geometry)
{
    geojson_document *document = &reader->document;
    size_t curves = document->curve_count, polygons = document->polygon_count;
    curve_builder part = {.curves = geometry->curves, .curve_count = geometry->count};
    if (!geojson_document_reserve(document, polygons + geometry->polygon_count, curves + geometry->count) ||
        !builder_append(&reader->builder, &part))
        return false;
    memcpy(document->origins + curves, geometry->origins, geometry->count * sizeof *geometry->origins);
    if (geometry->polygon_count > 0)
        memcpy(document->polygons + polygons, geometry->polygons, geometry->polygon_count * sizeof *geometry->polygons);
    document->curve_count += geometry->count;
    document->polygon_count += geometry->polygon_count;
    geometry->count = 0;
    return true;
}

/// Join what is cut at the antimeridian. The geometry is the curves from `first_curve` on.
static bat_status join_parts(geojson_reader *reader, size_t first_curve, size_t first_polygon, bool *represented)
{
    stitch_geometry geometry;
    stitch_report report = {0};
    geojson_findings *findings = &reader->findings;
    const stitch_tolerance tolerance = stitch_tolerance_of(reader->positions, reader->position_count);
    if (!take_geometry(reader, first_curve, first_polygon, &geometry))
        return geojson_no_memory(reader);
    bool done = reader->rings ? stitch_polygons(&geometry, reader->positions, &tolerance, &report)
                              : stitch_lines(&geometry, reader->positions, &tolerance, reader->closed != 0, &report);
    done = done && give_geometry(reader, &geometry);
    stitch_geometry_free(&geometry);
    if (!done)
        return geojson_no_memory(reader);
    stitch_report *sum = reader->rings ? &findings->polygons : &findings->lines;
    if (report.joins > 0 && findings->lines.joins + findings->polygons.joins == 0)
        geojson_describe_place(reader, findings->first_join, sizeof findings->first_join);
    if (report.poles > 0 && findings->polygons.poles == 0)
        geojson_describe_place(reader, findings->first_pole, sizeof findings->first_pole);
    stitch_report_add(sum, &report);
    *represented = report.unrepresented == 0;
    return BAT_OK;
}

static bool is_degenerate(const bat_curve *curve)
{
    enum
    {
        LINE_POINTS = 2,
        RING_POINTS = 3
    };
    return curve->count < (curve->closed ? (size_t)RING_POINTS : (size_t)LINE_POINTS);
}

/// Remove rings and lines with too few points, and polygons whose outer ring has too few.
static bat_status drop_degenerate(geojson_reader *reader, size_t first_curve, size_t first_polygon)
{
    curve_builder *builder = &reader->builder;
    geojson_document *document = &reader->document;
    geojson_findings *findings = &reader->findings;
    size_t ring = first_curve, kept = first_curve, kept_polygons = first_polygon, end = builder->curve_count;
    size_t polygon = first_polygon;
    while (ring < end)
    {
        size_t rings = reader->rings ? document->polygons[polygon].rings : 1, before = kept;
        bool dropped = is_degenerate(&builder->curves[ring]);
        for (size_t i = 0; i < rings; i++, ring++)
        {
            bat_curve *curve = &builder->curves[ring];
            stitch_origin origin = document->origins[ring];
            bool degenerate = is_degenerate(curve);
            if (degenerate)
            {
                geojson_place *place = &reader->place;
                const geojson_place outer = *place;
                if (reader->multiple && reader->rings)
                    place->polygon = origin.part;
                if (reader->multiple || reader->rings)
                    place->part = reader->rings ? origin.ring : origin.part;
                if (reader->strict)
                    return geojson_fault(reader, "the %s has too few different positions", reader->rings ? "ring" : "line");
                if (findings->degenerate++ == 0)
                    geojson_describe_place(reader, findings->first_degenerate, sizeof findings->first_degenerate);
                *place = outer;
            }
            if (degenerate || dropped)
            {
                bat_curve_free(curve);
                continue;
            }
            bat_curve moved = *curve;
            *curve = (bat_curve){0};
            builder->curves[kept] = moved;
            document->origins[kept++] = origin;
        }
        if (!reader->rings)
            continue;
        if (kept > before)
            document->polygons[kept_polygons++] = (stitch_polygon){kept - before, document->polygons[polygon].pole};
        polygon++;
    }
    builder->curve_count = document->curve_count = kept;
    document->polygon_count = kept_polygons;
    return BAT_OK;
}

/// Forget the curves of a geometry, which passes unchanged.
static void forget(geojson_reader *reader, size_t first_curve, size_t first_polygon)
{
    curve_builder *builder = &reader->builder;
    for (size_t i = first_curve; i < builder->curve_count; i++)
        bat_curve_free(&builder->curves[i]);
    builder->curve_count = reader->document.curve_count = first_curve;
    reader->document.polygon_count = first_polygon;
    geojson_findings *findings = &reader->findings;
    if (findings->unchanged++ == 0)
        geojson_describe_place(reader, findings->first_unchanged, sizeof findings->first_unchanged);
}

/// Join, close and clean the curves of a geometry that has been read.
bat_status geojson_complete_geometry(geojson_reader *reader, size_t first_curve, size_t first_polygon)
{
    curve_builder *builder = &reader->builder;
    bool represented = true, degenerate = false;
    // Curves get the space of the set at the end; until then that of the builder.
    for (size_t i = first_curve; i < builder->curve_count; i++)
        builder->curves[i].space = &builder->space;
    if (reader->degrees && stitch_concerns(reader->positions, reader->position_count))
    {
        bat_status status = join_parts(reader, first_curve, first_polygon, &represented);
        if (status != BAT_OK)
            return status;
    }
    for (size_t i = first_curve; i < builder->curve_count; i++)
    {
        if (!reader->rings && !builder->curves[i].closed)
            close_line(&builder->curves[i], reader->closed);
        if (reader->aliases)
            merge_aliases(&builder->curves[i]);
        degenerate = degenerate || is_degenerate(&builder->curves[i]);
    }
    bat_status status = degenerate && represented ? drop_degenerate(reader, first_curve, first_polygon) : BAT_OK;
    if (status == BAT_OK && (!represented || builder->curve_count == first_curve))
        forget(reader, first_curve, first_polygon);
    return status;
}
