#include "io/common/json.h"

#include "io/common/number_text.h"

#include <string.h>

/// @file
/// JSON text: a scanner that skips values without a parse tree, and a writer.

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

void json_text_string(text_buffer *text, const char *string, size_t length)
{
    enum
    {
        LONGEST_ESCAPE = 6
    };
    static const char digits[] = "0123456789abcdef";
    if (length > SIZE_MAX / LONGEST_ESCAPE - 1)
    {
        text->failed = true;
        return;
    }
    char *out = text_reserve(text, LONGEST_ESCAPE * length + 2);
    if (out == NULL)
        return;
    *out++ = '"';
    for (size_t i = 0; i < length; i++)
    {
        unsigned char c = (unsigned char)string[i];
        if (c == '"' || c == '\\')
            *out++ = '\\';
        if (c >= ' ')
        {
            *out++ = (char)c;
            continue;
        }
        memcpy(out, "\\u00", 4);
        out[4] = digits[c >> 4];
        out[5] = digits[c & 15];
        out += LONGEST_ESCAPE;
    }
    *out++ = '"';
    text_advance(text, out);
}

static void append_object(text_buffer *text, const json_t *object)
{
    const char *separator = "{";
    // The iterator does not change the object, but its parameter is not const.
    json_t *members = (json_t *)(uintptr_t)object;
    for (void *member = json_object_iter(members); member != NULL; member = json_object_iter_next(members, member))
    {
        const char *key = json_object_iter_key(member);
        text_append_string(text, separator);
        json_text_string(text, key, strlen(key));
        text_append(text, ":", 1);
        json_text(text, json_object_iter_value(member));
        separator = ",";
    }
    text_append_string(text, *separator == '{' ? "{}" : "}");
}

static void append_array(text_buffer *text, const json_t *array)
{
    size_t count = json_array_size(array);
    text_append(text, "[", 1);
    for (size_t i = 0; i < count; i++)
    {
        if (i > 0)
            text_append(text, ",", 1);
        json_text(text, json_array_get(array, i));
    }
    text_append(text, "]", 1);
}

/// Append a real number with a point or an exponent, so that it is read back as a real number.
static void append_real(text_buffer *text, double value)
{
    char *begin = text_reserve(text, NUMBER_TEXT_SIZE + 2);
    if (begin == NULL)
        return;
    char *end = number_write(begin, value);
    size_t length = (size_t)(end - begin);
    if (memchr(begin, '.', length) == NULL && memchr(begin, 'e', length) == NULL)
    {
        *end++ = '.';
        *end++ = '0';
    }
    text_advance(text, end);
}

static void append_integer(text_buffer *text, json_int_t value)
{
    char digits[NUMBER_TEXT_SIZE];
    int length = snprintf(digits, sizeof digits, "%" JSON_INTEGER_FORMAT, value);
    text_append(text, digits, (size_t)length);
}

void json_text(text_buffer *text, const json_t *value)
{
    switch (json_typeof(value))
    {
    case JSON_OBJECT:
        append_object(text, value);
        break;
    case JSON_ARRAY:
        append_array(text, value);
        break;
    case JSON_STRING:
        json_text_string(text, json_string_value(value), json_string_length(value));
        break;
    case JSON_INTEGER:
        append_integer(text, json_integer_value(value));
        break;
    case JSON_REAL:
        append_real(text, json_real_value(value));
        break;
    case JSON_TRUE:
        text_append_string(text, "true");
        break;
    case JSON_FALSE:
        text_append_string(text, "false");
        break;
    case JSON_NULL:
        text_append_string(text, "null");
        break;
    }
}
