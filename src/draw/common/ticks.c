#include "draw/common/ticks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/// @file
/// Choice of round steps and of the shortest labels that distinguish all ticks.

double ticks_step(double step)
{
    double power = pow(10.0, floor(log10(step)));
    double share = step / power;
    return power * (share < sqrt(2.0) ? 1.0 : share < sqrt(10.0) ? 2.0 : share < sqrt(50.0) ? 5.0 : 10.0);
}

void ticks_add(tick_list *ticks, double value, bool labelled)
{
    if (ticks->count < TICKS_MAX)
    {
        ticks->values[ticks->count] = value;
        ticks->labelled[ticks->count] = labelled;
        ticks->count++;
    }
}

/// The decimals that distinguish multiples of a step.
static int decimals_of(double step)
{
    return (int)fmin(fmax(-floor(log10(step) + 1e-9), 0.0), 12.0);
}

tick_list ticks_linear(double low, double high, double wanted)
{
    double step = ticks_step((high - low) / fmax(wanted, 1.0));
    double slack = 1e-9 * (high - low);
    tick_list ticks = {.step = step, .decimals = decimals_of(step)};
    for (double i = ceil((low - slack) / step); i * step <= high + slack && ticks.count < TICKS_MAX; i += 1.0)
        ticks_add(&ticks, i * step, true);
    return ticks;
}

/// Whether numbers of this size are short without an exponent.
static bool plain(double size)
{
    return size < 1e5 && size >= 1e-2;
}

tick_scale ticks_scale(double low, double high)
{
    tick_scale scale = {0};
    double range = high - low;
    double largest = fmax(fabs(low), fabs(high));
    double agreement = plain(largest) ? 1e5 : 1e2;
    if (largest > agreement * range)
    {
        double unit = pow(10.0, ceil(log10(range) - 1e-9));
        scale.offset = unit * round((low + 0.5 * range) / unit);
        largest = fmax(fabs(low - scale.offset), fabs(high - scale.offset));
    }
    scale.exponent = plain(largest) ? 0 : 3 * (int)floor(log10(largest) / 3.0);
    return scale;
}

void ticks_use_scale(tick_list *ticks, tick_scale scale)
{
    ticks->scale = scale;
    ticks->decimals = decimals_of(ticks->step * pow(10.0, -scale.exponent));
}

/// "×10⁻⁶"
static void power_text(int exponent, char *text, size_t size)
{
    static const char *const digits[] = {"\xe2\x81\xb0", "\xc2\xb9",     "\xc2\xb2",     "\xc2\xb3",     "\xe2\x81\xb4",
                                         "\xe2\x81\xb5", "\xe2\x81\xb6", "\xe2\x81\xb7", "\xe2\x81\xb8", "\xe2\x81\xb9"};
    int magnitude = abs(exponent); // at most 324
    (void)snprintf(text, size,
                   "\xc3\x97"
                   "10%s%s%s%s",
                   exponent < 0 ? "\xe2\x81\xbb" : "", magnitude >= 100 ? digits[magnitude / 100 % 10] : "",
                   magnitude >= 10 ? digits[magnitude / 10 % 10] : "", digits[magnitude % 10]);
}

void tick_scale_text(tick_scale scale, char *text)
{
    char power[24] = "";
    char offset[32] = "";
    if (scale.exponent != 0)
        power_text(scale.exponent, power, sizeof power);
    if (scale.offset != 0.0)
        (void)snprintf(offset, sizeof offset, "%.15g", fabs(scale.offset));
    const char *gap = *power != '\0' && *offset != '\0' ? " " : "";
    const char *sign = scale.offset < 0.0 ? "\xe2\x80\x93" : scale.offset > 0.0 ? "+" : "";
    (void)snprintf(text, TICK_SCALE_SIZE, "%s%s%s%s%s", power, gap, sign, gap, offset);
}

void tick_label(const tick_list *ticks, size_t index, char *label)
{
    double value = (ticks->values[index] - ticks->scale.offset) * pow(10.0, -ticks->scale.exponent);
    double size = fabs(value);
    bool zero = size < 0.5 * pow(10.0, -ticks->decimals);
    const char *sign = value < 0.0 && !zero ? "\xe2\x80\x93" : "";
    (void)snprintf(label, TICK_LABEL_SIZE, "%s%.*f", sign, ticks->decimals, size);
}

double tick_width(cairo_t *cairo, const tick_list *ticks, size_t index)
{
    char label[TICK_LABEL_SIZE];
    if (ticks->label != NULL)
        return ticks->label(cairo, ticks->values[index], NULL);
    tick_label(ticks, index, label);
    return text_width(cairo, label);
}

void tick_draw(cairo_t *cairo, const tick_list *ticks, size_t index, double x, double y, double align)
{
    char label[TICK_LABEL_SIZE];
    double left = x - align * tick_width(cairo, ticks, index);
    if (ticks->label != NULL)
    {
        (void)ticks->label(cairo, ticks->values[index], (double[]){left, y});
        return;
    }
    tick_label(ticks, index, label);
    text_draw_middle(cairo, label, left, y, 0.0);
}
