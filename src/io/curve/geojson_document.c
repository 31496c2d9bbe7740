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

bool geojson_document_keep(geojson_document *document, bat_curve_attributes *attributes)
{
    geojson_document *kept = malloc(sizeof *kept);
    if (kept == NULL)
        return false;
    *kept = *document;
    *document = (geojson_document){0};
    attributes->remainder = (file_remainder){kept, free_content, line_of_feature};
    return true;
}
