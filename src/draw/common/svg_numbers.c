#include "draw/common/svg_numbers.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    NUMBER_SIZE = 24
};

/// What stands before the numbers of surfaces in versions of cairo; a quotation mark follows them. Coded images hold none.
static const char *const MARKS[] = {"<g id=\"surface", "\"image", "\"#image", "\"source-", "\"#source-"};

/// A number in the file.
typedef struct numbered_name
{
    size_t digits, end; ///< its first digit, and behind its last
} numbered_name;

/// The name that begins at a place. False for none.
static bool name_at(const unsigned char *data, size_t size, size_t place, numbered_name *name)
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

/// The place in the list of names of one with the same digits as `name`, which is added if it is new.
static size_t number_of(const unsigned char *data, numbered_name name, numbered_name *seen, size_t *count)
{
    size_t length = name.end - name.digits;
    for (size_t i = 0; i < *count; i++)
        if (seen[i].end - seen[i].digits == length && memcmp(data + seen[i].digits, data + name.digits, length) == 0)
            return i;
    seen[*count] = name;
    return (*count)++;
}

static size_t copy_renumbered(const unsigned char *data, size_t size, numbered_name *seen, unsigned char *copy)
{
    size_t written = 0, count = 0;
    for (size_t i = 0; i < size;)
    {
        numbered_name name;
        if (!name_at(data, size, i, &name))
        {
            copy[written++] = data[i++];
            continue;
        }
        memcpy(copy + written, data + i, name.digits - i);
        written += name.digits - i;
        written += (size_t)snprintf((char *)copy + written, NUMBER_SIZE, "%zu", number_of(data, name, seen, &count) + 1);
        i = name.end;
    }
    return written;
}

bool svg_renumber(unsigned char **data, size_t *size)
{
    size_t names = 0;
    numbered_name name;
    for (size_t i = 0; i < *size; i++)
        names += name_at(*data, *size, i, &name);
    if (names == 0)
        return true;
    numbered_name *seen = memory_array(names, sizeof *seen);
    unsigned char *copy = malloc(*size + names * NUMBER_SIZE);
    if (seen != NULL && copy != NULL)
    {
        *size = copy_renumbered(*data, *size, seen, copy);
        free(*data);
        *data = copy;
        copy = NULL;
    }
    bool done = seen != NULL && copy == NULL;
    free(copy);
    free(seen);
    return done;
}
