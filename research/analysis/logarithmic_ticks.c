#include "research/analysis/chart.h"

#include <stdio.h>

/// @file
/// Ticks of logarithmic axes.

/// The size of exponents, relative to that of the label.
#define EXPONENT_SHARE 0.72

/// The exponent of the leading digit of a positive number.
static double exponent_of(double value)
{
    return floor(log10(value) + 1e-9);
}

void power_label(double value, char label[TICK_LABEL_SIZE])
{
    double leading = value / pow(10.0, exponent_of(value));
    (void)snprintf(label, TICK_LABEL_SIZE,
                   leading > 1.0 + 1e-9 ? "%.6g\xc3\x97"
                                          "10"
                                        : "10",
                   leading);
}

/// A multiple of a power of ten, with its exponent.
static double draw_power(cairo_t *cairo, double value, const double place[2])
{
    char label[TICK_LABEL_SIZE], raised[TICK_LABEL_SIZE];
    double exponent = exponent_of(value);
    power_label(value, label);
    (void)snprintf(raised, TICK_LABEL_SIZE, "%s%.0f", exponent < 0.0 ? "\xe2\x80\x93" : "", fabs(exponent));
    double width = text_width(cairo, label);
    if (place == NULL)
        return width + EXPONENT_SHARE * text_width(cairo, raised);
    text_draw_middle(cairo, label, place[0], place[1], 0.0);
    cairo_matrix_t font;
    cairo_get_font_matrix(cairo, &font);
    cairo_set_font_size(cairo, EXPONENT_SHARE * font.yy);
    text_draw_middle(cairo, raised, place[0] + width, place[1] - 0.38 * font.yy, 0.0);
    cairo_set_font_size(cairo, font.yy);
    return width;
}

static double draw_number(cairo_t *cairo, double value, const double place[2])
{
    char label[TICK_LABEL_SIZE];
    (void)snprintf(label, TICK_LABEL_SIZE, "%.6g", value);
    if (place != NULL)
        text_draw_middle(cairo, label, place[0], place[1], 0.0);
    return text_width(cairo, label);
}

/// The multiples of powers of ten that have ticks on an axis over `decades` powers.
static size_t multiples(double decades, const double **shares)
{
    static const double few[] = {1.0, 2.0, 5.0};
    static const double many[] = {1.0, 2.0, 3.0, 4.0, 6.0, 8.0};
    *shares = decades < 1.2 ? many : few;
    return decades < 1.2 ? 6 : decades < 3.0 ? 3 : 1;
}

tick_list ticks_logarithmic(double low, double high, double wanted)
{
    double decades = log10(high / low);
    if (decades < 0.4)
    {
        tick_list linear = ticks_linear(low, high, wanted);
        linear.label = low < 1e-4 || high > 1e5 ? draw_power : draw_number;
        return linear;
    }
    tick_list ticks = {0};
    const double *shares;
    size_t share_count = multiples(decades, &shares);
    double first = floor(log10(low) + 1e-9);
    double every = fmax(1.0, ticks_step(decades / fmax(wanted, 1.0)));
    bool powers = share_count == 1 || first < -4.0 || log10(high) > 5.0;
    ticks.label = powers ? draw_power : draw_number;
    double stride = decades > TICKS_MAX - 2 ? every : 1.0;
    for (double i = stride * floor(first / stride); i <= log10(high) + 1e-9; i += stride)
    {
        for (size_t k = 0; k < share_count; k++)
        {
            // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): shares has share_count numbers
            double value = shares[k] * pow(10.0, i);
            bool whole = k == 0 && fmod(fabs(i), every) == 0.0;
            if (value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9))
                ticks_add(&ticks, value, whole || !powers || decades < 1.2);
        }
    }
    return ticks;
}
