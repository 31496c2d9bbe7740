#include "number_list.h"

#include <math.h>
#include <stdlib.h>

bool argument_list(const arguments *given, const char *name, double low, double high, bool whole, number_list *list)
{
    const char *text = argument(given, name);
    if (text == NULL)
        return true;
    number_list read = {.count = 0};
    for (const char *at = text; read.count < MOST_LISTED;)
    {
        char *end;
        double value = strtod(at, &end);
        bool good = end != at && (*end == ',' || *end == '\0') && value >= low && value <= high;
        if (!good || (whole && value != floor(value)))
            break;
        read.numbers[read.count++] = value;
        if (*end == '\0')
        {
            *list = read;
            return true;
        }
        at = end + 1;
    }
    (void)usage_error(given, "--%s takes up to %d %snumbers from %g to %g like %g,%g, not '%s'", name, MOST_LISTED,
                      whole ? "whole " : "", low, high, low, high, text);
    return false;
}
