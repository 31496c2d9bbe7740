#pragma once

#include <stdio.h>
#include <stdlib.h>

/// Room for the text of number_digits().
#define NUMBER_DIGITS_SIZE 32

/// A number for messages, with the fewest of 15, 16 or 17 significant digits that identify the double. Returns `text`.
static inline const char *number_digits(double value, char text[NUMBER_DIGITS_SIZE])
{
    for (int digits = 15; digits <= 17; digits++)
    {
        (void)snprintf(text, NUMBER_DIGITS_SIZE, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    return text;
}
