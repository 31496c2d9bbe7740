#ifndef CLI_NUMBER_LIST_H
#define CLI_NUMBER_LIST_H

#include "arguments.h"

enum
{
    MOST_LISTED = 16
};

/// Numbers that an option lists, as in "50,100,200".
typedef struct number_list
{
    double numbers[MOST_LISTED];
    size_t count;
} number_list;

/// Numbers from `low` to `high`; `list` is as it was where the option was not given. False after a message.
bool argument_list(const arguments *given, const char *name, double low, double high, bool whole, number_list *list);

#endif
