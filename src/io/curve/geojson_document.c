#include "io/curve/geojson_document.h"

#include <stdlib.h>

void geojson_document_free(geojson_document *document)
{
    for (size_t i = 0; i < document->feature_count; i++)
        json_decref(document->features[i].tree);
    json_decref(document->collection);
    free(document->features);
    free(document->geometries);
    free(document->ring_counts);
    *document = (geojson_document){0};
}

static void free_content(void *content)
{
    geojson_document_free(content);
    free(content);
}

/// The line of the feature that a curve belongs to.
static size_t line_of_feature(const void *content, size_t curve)
{
    const geojson_document *document = content;
    for (size_t i = 0; i < document->feature_count; i++)
    {
        const geojson_feature *feature = &document->features[i];
        if (curve >= feature->curve && curve - feature->curve < feature->curve_count)
            return feature->line;
    }
    return 0;
}

/// The polygon and the feature of each curve, for bat_curve_set_polygon(). False when out of memory.
static bool keep_rings(const geojson_document *document, bat_curve_attributes *attributes)
{
    size_t count = 0;
    for (size_t i = 0; i < document->feature_count; i++)
        count += document->features[i].curve_count;
    curve_ring *rings = malloc((count + 1) * sizeof *rings);
    if (rings == NULL)
        return false;
    for (size_t i = 0; i < count; i++)
        rings[i] = (curve_ring){BAT_NO_INDEX, BAT_NO_INDEX};
    for (size_t i = 0; i < document->feature_count; i++)
    {
        const geojson_feature *feature = &document->features[i];
        for (size_t g = 0; g < feature->geometry_count; g++)
        {
            const geojson_geometry *geometry = &document->geometries[feature->geometry + g];
            size_t curve = feature->curve + geometry->curve;
            for (size_t p = 0; p < geometry->polygon_count; p++)
            {
                size_t polygon = feature->polygon + geometry->polygon + p;
                for (size_t r = 0; r < document->ring_counts[polygon]; r++)
                    rings[curve++] = (curve_ring){polygon, i};
            }
        }
    }
    attributes->rings = rings;
    attributes->ring_count = count;
    return true;
}

bool geojson_document_keep(geojson_document *document, bat_curve_attributes *attributes)
{
    geojson_document *kept = malloc(sizeof *kept);
    if (kept == NULL || !keep_rings(document, attributes))
    {
        free(kept);
        return false;
    }
    *kept = *document;
    *document = (geojson_document){0};
    attributes->remainder = (file_remainder){kept, free_content, line_of_feature};
    return true;
}
