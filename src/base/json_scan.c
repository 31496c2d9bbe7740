#include "base/json_scan.h"

#include <ctype.h>
#include <string.h>

/// @file
/// A scanner of JSON text that skips values without a parse tree.

void json_scan_blanks(json_scanner *scan)
{
    while (scan->at < scan->end && (*scan->at == ' ' || *scan->at == '\n' || *scan->at == '\r' || *scan->at == '\t'))
        scan->at++;
}

bool json_scan_at(json_scanner *scan, char byte)
{
    json_scan_blanks(scan);
    return scan->at < scan->end && *scan->at == byte;
}

bool json_scan_take(json_scanner *scan, char byte)
{
    bool there = json_scan_at(scan, byte);
    scan->at += there;
    return there;
}

bool json_scan_string(json_scanner *scan)
{
    if (!json_scan_take(scan, '"'))
        return false;
    while (scan->at < scan->end && *scan->at != '"')
        scan->at += *scan->at == '\\' ? 2 : 1;
    if (scan->at >= scan->end)
        return false;
    scan->at++;
    return true;
}

bool json_scan_key(json_scanner *scan, json_scanner *key)
{
    json_scan_blanks(scan);
    key->at = scan->at + 1;
    if (!json_scan_string(scan))
        return false;
    key->end = scan->at - 1;
    return json_scan_take(scan, ':');
}

bool json_scan_is(const json_scanner *scan, const char *text)
{
    size_t size = strlen(text);
    return (size_t)(scan->end - scan->at) == size && memcmp(scan->at, text, size) == 0;
}

bool json_scan_value(json_scanner *scan)
{
    size_t depth = 0;
    json_scan_blanks(scan);
    while (scan->at < scan->end)
    {
        char c = *scan->at;
        if (c == '"')
        {
            if (!json_scan_string(scan))
                return false;
            continue;
        }
        if (depth == 0 && (c == ',' || c == '}' || c == ']'))
            return true;
        scan->at++;
        if (c == '{' || c == '[')
            depth++;
        else if (c == '}' || c == ']')
        {
            if (--depth == 0)
                return true;
        }
    }
    return false;
}

bool json_scan_element(json_scanner *scan, size_t index)
{
    if (json_scan_take(scan, ']'))
        return false;
    return index == 0 || json_scan_take(scan, ',');
}

static bool skip_digits(json_scanner *scan)
{
    const char *first = scan->at;
    while (scan->at < scan->end && *scan->at >= '0' && *scan->at <= '9')
        scan->at++;
    return scan->at > first;
}

/// Skip one of the bytes `a` and `b`, without blanks before it.
static bool skip_either(json_scanner *scan, char a, char b)
{
    bool there = scan->at < scan->end && (*scan->at == a || *scan->at == b);
    scan->at += there;
    return there;
}

/// Skip a JSON number.
static bool skip_number(json_scanner *scan)
{
    (void)skip_either(scan, '-', '-');
    if (!skip_either(scan, '0', '0') && !skip_digits(scan))
        return false;
    if (skip_either(scan, '.', '.') && !skip_digits(scan))
        return false;
    if (!skip_either(scan, 'e', 'E'))
        return true;
    (void)skip_either(scan, '+', '-');
    return skip_digits(scan);
}

bool json_scan_numbers(json_scanner *scan, size_t depth)
{
    size_t open = 0;
    for (;;)
    {
        if (json_scan_take(scan, '['))
        {
            if (++open > depth)
                return false;
            if (!json_scan_at(scan, ']'))
                continue;
        }
        else if (open == 0 || !skip_number(scan))
            return false;
        while (json_scan_take(scan, ']'))
            if (--open == 0)
                return true;
        if (!json_scan_take(scan, ','))
            return false;
    }
}

size_t json_scan_newlines(const char *begin, const char *end)
{
    size_t count = 0;
    while (begin < end && (begin = memchr(begin, '\n', (size_t)(end - begin))) != NULL)
    {
        count++;
        begin++;
    }
    return count;
}

/// Skip the four hexadecimal digits of an escape; the result is -1 where there are none.
static long skip_hexadecimal(json_scanner *scan)
{
    long value = 0;
    for (int i = 0; i < 4; i++, scan->at++)
    {
        static const char DIGITS[] = "0123456789abcdef";
        const char *digit = scan->at < scan->end ? memchr(DIGITS, tolower((unsigned char)*scan->at), 16) : NULL;
        if (digit == NULL)
            return -1;
        value = 16 * value + (digit - DIGITS);
    }
    return value;
}

/// Skip an escape after its backslash. The halves of a surrogate pair come together.
static bool skip_escape(json_scanner *scan)
{
    enum
    {
        HIGH = 0xD800,
        LOW = 0xDC00,
        AFTER = 0xE000
    };
    if (scan->at >= scan->end || memchr("\"\\/bfnrtu", *scan->at, 9) == NULL)
        return false;
    if (*scan->at++ != 'u')
        return true;
    long first = skip_hexadecimal(scan);
    if (first < HIGH || first >= AFTER)
        return first >= 0;
    if (first >= LOW || scan->end - scan->at < 2 || memcmp(scan->at, "\\u", 2) != 0)
        return false;
    scan->at += 2;
    long second = skip_hexadecimal(scan);
    return second >= LOW && second < AFTER;
}

/// Skip a string, and check its characters and escapes.
static bool skip_valid_string(json_scanner *scan)
{
    if (!json_scan_take(scan, '"'))
        return false;
    while (scan->at < scan->end && *scan->at != '"')
    {
        unsigned char c = (unsigned char)*scan->at++;
        if (c < ' ' || (c == '\\' && !skip_escape(scan)))
            return false;
    }
    return skip_either(scan, '"', '"');
}

/// Skip a value that is neither an array nor an object.
static bool skip_scalar(json_scanner *scan)
{
    static const char *const WORDS[] = {"true", "false", "null"};
    if (json_scan_at(scan, '"'))
        return skip_valid_string(scan);
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++)
    {
        size_t size = strlen(WORDS[i]);
        if ((size_t)(scan->end - scan->at) >= size && memcmp(scan->at, WORDS[i], size) == 0)
        {
            scan->at += size;
            return true;
        }
    }
    return skip_number(scan);
}

static bool skip_name(json_scanner *scan)
{
    return skip_valid_string(scan) && json_scan_take(scan, ':');
}

/// Skip what follows a value: closing brackets, then a comma with the next name. False where something else follows.
/// @param open the `depth` brackets that are open
static bool skip_ends(json_scanner *scan, const char *open, size_t *depth)
{
    while (*depth > 0 && json_scan_take(scan, open[*depth - 1] == '[' ? ']' : '}'))
        --*depth;
    return *depth == 0 || (json_scan_take(scan, ',') && (open[*depth - 1] == '[' || skip_name(scan)));
}

bool json_scan_valid(const char *text, size_t size)
{
    enum
    {
        MAX_DEPTH = 2048 ///< Jansson's limit
    };
    json_scanner scan = {text, text + size};
    char open[MAX_DEPTH];
    size_t depth = 0;
    do
    {
        bool array = json_scan_take(&scan, '['), object = !array && json_scan_take(&scan, '{');
        if ((array || object) && depth == MAX_DEPTH)
            return false;
        if (array || object)
        {
            open[depth++] = array ? '[' : '{';
            if (json_scan_take(&scan, array ? ']' : '}'))
                depth--;
            else if (array || skip_name(&scan))
                continue;
            else
                return false;
        }
        else if (depth == 0 || !skip_scalar(&scan))
            return false;
        if (!skip_ends(&scan, open, &depth))
            return false;
    } while (depth > 0);
    json_scan_blanks(&scan);
    return scan.at == scan.end;
}
