#include "base/json_scan.h"

#include "base/error.h"

#include <locale.h>
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
    return !json_scan_take(scan, ']') && (index == 0 || json_scan_take(scan, ','));
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

void json_printable(char *text)
{
    for (char *c = text; *c != '\0'; c++)
        *c = *c >= ' ' && *c <= '~' ? *c : '?';
}

bat_status json_parse(const char *text, size_t size, size_t flags, size_t first_line, json_t **value, bat_error *error)
{
    // Jansson reads numbers with strtod(), in the locale of the thread if it has one of its own.
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (plain == (locale_t)0)
        return error_memory(error, size);
    locale_t before = uselocale(plain);
    json_error_t fault;
    // Where Jansson's scanner lacks memory it reports a wrong string: a text with a fault has it the second time, too.
    *value = NULL;
    for (int i = 0; i < 2 && *value == NULL; i++)
        *value = json_loadb(text, size, JSON_REJECT_DUPLICATES | flags, &fault);
    (void)uselocale(before);
    freelocale(plain);
    if (*value != NULL)
        return BAT_OK;
    // Jansson leaves no message for most failed allocations.
    if (fault.text[0] == '\0' || json_error_code(&fault) == json_error_out_of_memory)
        return error_memory(error, size);
    json_printable(fault.text);
    size_t line = fault.line > 0 ? first_line + (size_t)fault.line - 1 : first_line;
    return ERROR_FILE(error, line, "%s", fault.text);
}
