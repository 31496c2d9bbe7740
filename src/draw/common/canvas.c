#include "draw/common/sheet.h"

#include "base/atomic_file.h"
#include "base/error.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <strings.h>

// Pixel images aligned with the pixels of the page.

pixel_box pixel_box_align(cairo_t *cairo, double per_point, const double box[4])
{
    double x = box[0], y = box[1];
    cairo_user_to_device(cairo, &x, &y);
    x = ceil(x);
    y = ceil(y);
    cairo_device_to_user(cairo, &x, &y);
    return (pixel_box){.x = x,
                       .y = y,
                       .per_point = per_point,
                       .columns = (size_t)fmax(floor((box[0] + box[2] - x) * per_point), 1),
                       .rows = (size_t)fmax(floor((box[1] + box[3] - y) * per_point), 1)};
}

bat_status pixel_image_draw(cairo_t *cairo, const pixel_box *place, pixel_painter *paint, const void *context,
                            bat_error *error)
{
    cairo_surface_t *image = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, (int)place->columns, (int)place->rows);
    if (cairo_surface_status(image) != CAIRO_STATUS_SUCCESS)
    {
        cairo_surface_destroy(image);
        return error_memory(error, 4 * place->columns * place->rows);
    }
    cairo_surface_flush(image);
    bat_status status =
        paint(context, cairo_image_surface_get_data(image), (size_t)cairo_image_surface_get_stride(image), error);
    cairo_surface_mark_dirty(image);
    if (status == BAT_OK)
    {
        cairo_save(cairo);
        cairo_translate(cairo, place->x, place->y);
        cairo_scale(cairo, 1 / place->per_point, 1 / place->per_point);
        cairo_set_source_surface(cairo, image, 0, 0);
        cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_NEAREST);
        cairo_paint(cairo);
        cairo_restore(cairo);
    }
    cairo_surface_destroy(image);
    return status;
}

// Files of pictures by cairo. SVG surfaces are renumbered, so that equal drawings give equal files.

#define NUMBER_SIZE 24

/// The text before the numbers of surfaces in cairo's versions; a quotation mark ends them. Images do not contain it.
static const char *const MARKS[] = {"<g id=\"surface", "\"image", "\"#image", "\"source-", "\"#source-"};

typedef struct numbered_name
{
    size_t digits, end; ///< its first digit, and the end of its digits
} numbered_name;

/// The surface name at a position. False when there is none.
static bool name_at(const char *data, size_t size, size_t place, numbered_name *name)
{
    if (data[place] != '"' && data[place] != '<')
        return false;
    for (size_t m = 0; m < sizeof MARKS / sizeof MARKS[0]; m++)
    {
        size_t length = strlen(MARKS[m]), end = place + length;
        if (size - place <= length || memcmp(data + place, MARKS[m], length) != 0)
            continue;
        while (end < size && data[end] >= '0' && data[end] <= '9')
            end++;
        *name = (numbered_name){place + length, end};
        return end > name->digits && end < size && data[end] == '"' && end - name->digits < NUMBER_SIZE;
    }
    return false;
}

/// The place of a name among `count` others; `count` for a new one.
static size_t place_of(const char *data, numbered_name name, const numbered_name *seen, size_t count)
{
    size_t length = name.end - name.digits, i = 0;
    while (i < count &&
           (seen[i].end - seen[i].digits != length || memcmp(data + seen[i].digits, data + name.digits, length) != 0))
        i++;
    return i;
}

/// Renumber the surfaces in an SVG file from 1 in their order: cairo writes numbers that count all of a process.
/// @return false when out of memory; the file is unchanged then
static bool svg_renumber(text_buffer *file)
{
    text_buffer copy = {0};
    numbered_name name, *seen = NULL;
    size_t count = 0, capacity = 0, copied = 0;
    bool done = true;
    for (size_t i = 0; i < file->size && done; i++)
    {
        char number[NUMBER_SIZE];
        if (!name_at(file->data, file->size, i, &name))
            continue;
        size_t place = place_of(file->data, name, seen, count);
        (void)snprintf(number, sizeof number, "%zu", place + 1);
        text_append(&copy, file->data + copied, name.digits - copied);
        text_append_string(&copy, number);
        copied = name.end;
        i = name.end - 1;
        done = place < count || ARRAY_ADD(seen, capacity, count, name);
    }
    text_append(&copy, file->data + copied, file->size - copied);
    free(seen);
    done = done && !copy.failed;
    text_free(done ? file : &copy);
    if (done)
        *file = copy;
    return done;
}

bat_status canvas_format_of(const char *path, canvas_format *format, bat_error *error)
{
    static const char *const endings[] = {[CANVAS_SVG] = ".svg", [CANVAS_PNG] = ".png", [CANVAS_PDF] = ".pdf"};
    const char *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path;
    const char *ending = strrchr(name, '.');
    for (int i = CANVAS_SVG; ending != NULL && ending != name && i <= CANVAS_PDF; i++)
    {
        if (strcasecmp(ending, endings[i]) == 0)
        {
            *format = (canvas_format)i;
            return BAT_OK;
        }
    }
    return ERROR_ARGUMENT(error, "a picture's name must end in .svg, .png or .pdf");
}

bat_status bat_picture_check(const char *path, bat_error *error)
{
    canvas_format format;
    return canvas_format_of(path, &format, error);
}

static cairo_status_t append_bytes(void *context, const unsigned char *data, unsigned int length)
{
    text_buffer *bytes = context;
    text_append(bytes, (const char *)data, length);
    return bytes->failed ? CAIRO_STATUS_NO_MEMORY : CAIRO_STATUS_SUCCESS;
}

/// The status for a failure of cairo, which writes to memory only.
static bat_status drawing_failed(cairo_status_t status, bat_error *error)
{
    bat_status mine = status == CAIRO_STATUS_INVALID_SIZE ? BAT_TOO_LARGE : BAT_NO_MEMORY;
    return error_set(error, mine, BAT_NO_INDEX, 0, "the picture cannot be drawn: %s", cairo_status_to_string(status));
}

static void use_exact_text(cairo_t *cairo)
{
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_set_font_options(cairo, options);
    cairo_font_options_destroy(options);
}

bat_status canvas_open(draw_canvas *canvas, canvas_format format, double width, double height, double pixels_per_point,
                       bat_error *error)
{
    *canvas = (draw_canvas){.format = format, .pixels_per_point = format == CANVAS_PNG ? pixels_per_point : 1.0};
    double scale = canvas->pixels_per_point;
    if (format == CANVAS_PNG)
        canvas->surface =
            cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)lround(width * scale), (int)lround(height * scale));
    else if (format == CANVAS_SVG)
        canvas->surface = cairo_svg_surface_create_for_stream(append_bytes, &canvas->bytes, width, height);
    else
    {
        canvas->surface = cairo_pdf_surface_create_for_stream(append_bytes, &canvas->bytes, width, height);
        cairo_pdf_surface_set_metadata(canvas->surface, CAIRO_PDF_METADATA_CREATE_DATE, "");
    }
    canvas->cairo = cairo_create(canvas->surface);
    cairo_status_t status = cairo_status(canvas->cairo);
    if (status != CAIRO_STATUS_SUCCESS)
    {
        canvas_close(canvas);
        return drawing_failed(status, error);
    }
    cairo_scale(canvas->cairo, scale, scale);
    use_exact_text(canvas->cairo);
    style_use_colour(canvas->cairo, COLOUR_BACKGROUND);
    cairo_paint(canvas->cairo);
    return BAT_OK;
}

bat_status canvas_save(draw_canvas *canvas, const char *path, bat_error *error)
{
    cairo_status_t status = cairo_status(canvas->cairo);
    if (status == CAIRO_STATUS_SUCCESS && canvas->format == CANVAS_PNG)
        status = cairo_surface_write_to_png_stream(canvas->surface, append_bytes, &canvas->bytes);
    cairo_surface_finish(canvas->surface);
    if (status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_status(canvas->surface);
    if (status != CAIRO_STATUS_SUCCESS)
        return drawing_failed(status, error);
    if (canvas->format == CANVAS_SVG && !svg_renumber(&canvas->bytes))
        return error_memory(error, canvas->bytes.size);
    return atomic_file_write(path, canvas->bytes.data, canvas->bytes.size, error);
}

void canvas_close(draw_canvas *canvas)
{
    cairo_destroy(canvas->cairo);
    cairo_surface_destroy(canvas->surface);
    text_free(&canvas->bytes);
    *canvas = (draw_canvas){0};
}

static void append(void *context, double x, double y, bool begins)
{
    (begins ? cairo_move_to : cairo_line_to)(context, x, y);
}

path_sink canvas_sink(cairo_t *cairo)
{
    return (path_sink){append, cairo};
}
