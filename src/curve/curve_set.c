#include "base/error.h"
#include "curve/curve_attributes.h"
#include "curve/polygon.h"
#include "space/degrees.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bat_curve_attributes *attributes_new(bat_curve_format format)
{
    bat_curve_attributes *attributes = calloc(1, sizeof *attributes);
    if (attributes != NULL)
    {
        atomic_init(&attributes->owners, 1);
        attributes->format = format;
        attributes->channels.time = BAT_NO_INDEX;
    }
    return attributes;
}

void attributes_share(bat_curve_attributes *attributes)
{
    if (attributes != NULL)
        (void)atomic_fetch_add(&attributes->owners, 1);
}

void attributes_release(bat_curve_attributes *attributes)
{
    if (attributes == NULL || atomic_fetch_sub(&attributes->owners, 1) != 1)
        return;
    for (size_t i = 0; i < attributes->note_count; i++)
        free(attributes->notes[i]);
    free(attributes->notes);
    free(attributes->crs);
    if (attributes->csv != NULL)
        attributes->free_csv(attributes->csv);
    free(attributes->rings);
    if (attributes->remainder.content != NULL)
        attributes->remainder.free(attributes->remainder.content);
    free(attributes);
}

#define LONGEST 240 ///< characters of a note

bool attributes_note(bat_curve_attributes *attributes, const char *format, ...)
{
    char text[LONGEST];
    va_list values;
    va_start(values, format);
    (void)vsnprintf(text, sizeof text, format, values);
    va_end(values);
    char **notes = realloc(attributes->notes, (attributes->note_count + 1) * sizeof *notes);
    if (notes == NULL)
        return false;
    attributes->notes = notes;
    notes[attributes->note_count] = strdup(text);
    return notes[attributes->note_count] != NULL && ++attributes->note_count > 0;
}

int64_t bat_curve_set_time_origin(const bat_curve_set *set)
{
    return set->attributes != NULL ? set->attributes->time_origin : 0;
}

const char *bat_curve_set_note(const bat_curve_set *set, size_t index)
{
    const bat_curve_attributes *attributes = set->attributes;
    return attributes != NULL && index < attributes->note_count ? attributes->notes[index] : NULL;
}

void bat_curve_set_free(bat_curve_set *set)
{
    curves_free(set->curves, set->count);
    free(set->space);
    free(set->lines);
    attributes_release(set->attributes);
    *set = (bat_curve_set){0};
}

static bat_status set_assemble(const bat_space *space, bat_curve *curves, size_t count, bat_curve_attributes *attributes,
                               bat_curve_set *set, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
        if (curves[i].space->point_dim != space->point_dim || strcmp(curves[i].space->name, space->name) != 0)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "curve %zu is in the space %s and not in %s", i,
                             curves[i].space->name, space->name);
    bat_space *copy = malloc(sizeof *copy);
    if (copy == NULL)
        return error_memory(error, sizeof *copy);
    *copy = *space;
    for (size_t i = 0; i < count; i++)
        curves[i].space = copy;
    attributes_share(attributes);
    *set = (bat_curve_set){.space = copy, .curves = curves, .count = count, .attributes = attributes};
    return BAT_OK;
}

bat_status bat_curve_set_take(bat_curve *curves, size_t count, bat_curve_set *set, bat_error *error)
{
    if (count == 0)
        return ERROR_ARGUMENT(error, "a set needs at least one curve");
    return set_assemble(curves[0].space, curves, count, NULL, set, error);
}

bat_status bat_curve_set_single(bat_curve *curve, bat_curve_set *set, bat_error *error)
{
    bat_curve *curves = malloc(sizeof *curves);
    if (curves == NULL)
        return error_memory(error, sizeof *curves);
    *curves = *curve;
    bat_status status = bat_curve_set_take(curves, 1, set, error);
    if (status == BAT_OK)
        *curve = (bat_curve){.space = curve->space};
    else
        free(curves);
    return status;
}

bat_status bat_curve_set_like(const bat_curve_set *source, bat_curve *curves, bat_curve_set *result, bat_error *error)
{
    return set_assemble(source->space, curves, source->count, source->attributes, result, error);
}

bool bat_curve_set_has_features(const bat_curve_set *set)
{
    return set->attributes != NULL && set->attributes->remainder.content != NULL;
}

size_t bat_curve_set_line(const bat_curve_set *set, size_t curve, size_t point)
{
    if (curve >= set->count || point >= set->curves[curve].count)
        return 0;
    if (set->lines == NULL && !bat_curve_set_has_features(set))
        return 0;
    if (set->lines == NULL)
        return set->attributes->remainder.line(set->attributes->remainder.content, curve);
    size_t before = 0;
    for (size_t i = 0; i < curve; i++)
        before += set->curves[i].count;
    return set->lines[before + point];
}

bool bat_curve_set_polygon(const bat_curve_set *set, size_t curve, size_t *polygon, size_t *feature)
{
    const bat_curve_attributes *attributes = set->attributes;
    if (attributes == NULL || curve >= set->count)
        return false;
    curve_ring ring = {.polygon = BAT_NO_INDEX};
    if (attributes->rings != NULL && curve < attributes->ring_count)
        ring = attributes->rings[curve];
    else if (attributes->rings == NULL && attributes->degrees)
        ring = (curve_ring){curve, curve};
    if (ring.polygon == BAT_NO_INDEX || !set->curves[curve].closed)
        return false;
    *polygon = ring.polygon;
    *feature = ring.feature;
    return true;
}

void bat_curve_set_place(const bat_curve_set *set, size_t curve, size_t point, char *text, size_t size)
{
    static const int DECIMALS = 6;
    if (size == 0)
        return;
    text[0] = '\0';
    const file_remainder *remainder = set->attributes != NULL ? &set->attributes->remainder : NULL;
    if (curve >= set->count || remainder == NULL || remainder->content == NULL)
    {
        if (set->count > 1 && curve < set->count)
            (void)snprintf(text, size, "curve %zu", curve);
        return;
    }
    remainder->place(remainder->content, curve, text, size);
    size_t used = strlen(text);
    if (point >= set->curves[curve].count || set->space->point_dim < 2)
        return;
    const double *at = set->curves[curve].points + point * set->space->point_dim;
    if (strcmp(set->space->name, "sphere") == 0 && set->space->point_dim == 3)
    {
        const degree_units shown = degrees_of_point(at, degree_units_per_radian(DECIMALS));
        double unit = (double)degree_units_per_degree(DECIMALS);
        (void)snprintf(text + used, size - used, "%s%.9g, %.8g", used > 0 ? ", near " : "near ",
                       (double)shown.longitude / unit, (double)shown.latitude / unit);
    }
    else
        (void)snprintf(text + used, size - used, "%s%.10g, %.10g", used > 0 ? ", near " : "near ", at[0], at[1]);
}
