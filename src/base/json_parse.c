#include "base/json_parse.h"

#include "base/error.h"

#include <locale.h>

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
    return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line, "%s", fault.text);
}
