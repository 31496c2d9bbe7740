#ifndef FUZZ_SURFACE_ROUND_TRIP_H
#define FUZZ_SURFACE_ROUND_TRIP_H

#include "promise.h"

#include "io/surface/formats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The same functions and the same coefficients.
static inline void compare_surfaces(const bat_spline_surface *before, const bat_spline_surface *after)
{
    size_t functions = bat_hierarchical_space_functions(before->space);
    PROMISE(bat_hierarchical_space_functions(after->space) == functions);
    PROMISE(bat_hierarchical_space_cells(after->space) == bat_hierarchical_space_cells(before->space));
    PROMISE(after->dimension == before->dimension);
    PROMISE(memcmp(after->control, before->control, functions * before->dimension * sizeof *before->control) == 0);
}

static inline bat_status write_format(const bat_spline_surface *surface, bat_surface_format format, text_buffer *text)
{
    const bat_surface_write_options options = {.samples = 1};
    text_sink sink = {.buffer = text};
    bat_status status = surface_check(surface, format, &options, NULL);
    return status == BAT_OK ? surface_write_text(surface, format, &options, &sink, NULL) : status;
}

/// A surface is preserved by both exact formats and can be written in the others.
static inline void write_and_read(const bat_spline_surface *surface)
{
    enum
    {
        MAX_CELLS = 2000 // limits the time of an input
    };
    bool small = bat_hierarchical_space_cells(surface->space) <= MAX_CELLS;
    for (int i = BAT_SURFACE_FORMAT_XML; i <= BAT_SURFACE_FORMAT_IGES; i++)
    {
        text_buffer text = {0};
        bool exact = i == BAT_SURFACE_FORMAT_XML || i == BAT_SURFACE_FORMAT_JSON;
        if (!exact && !small)
            continue;
        bat_status status = write_format(surface, (bat_surface_format)i, &text);
        PROMISE(status == BAT_OK || (!exact && (status == BAT_UNSUPPORTED || status == BAT_TOO_LARGE)));
        if (exact)
        {
            file_text file;
            bat_spline_surface back;
            PROMISE(file_text_copy(text.data, text.size, NULL, &file, NULL) == BAT_OK);
            PROMISE(surface_read_text(&file, &back, NULL) == BAT_OK);
            compare_surfaces(surface, &back);
            bat_spline_surface_free(&back);
            file_text_free(&file);
        }
        text_free(&text);
    }
}

typedef bat_status surface_reader(const file_text *text, bat_spline_surface *surface, bat_error *error);

static inline void surface_round_trip(const uint8_t *data, size_t size, surface_reader *read)
{
    file_text text;
    bat_spline_surface surface = {0};
    bat_error error = {0};
    if (file_text_copy((const char *)data, size, NULL, &text, NULL) != BAT_OK)
        return;
    bat_status status = read(&text, &surface, &error);
    PROMISE(status == error.status);
    PROMISE(status == BAT_OK || (surface.space == NULL && surface.control == NULL && error.text[0] != '\0'));
    if (status == BAT_OK)
    {
        write_and_read(&surface);
        bat_spline_surface_free(&surface);
    }
    file_text_free(&text);
}

#endif
