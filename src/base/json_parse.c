#include "base/json_parse.h"

#include "base/error.h"

#include <ctype.h>
#include <locale.h>
#include <string.h>

void json_printable(char *text)
{
    for (char *c = text; *c != '\0'; c++)
        *c = *c >= ' ' && *c <= '~' ? *c : '?';
}

/// A text between two places, for a check of its grammar (RFC 8259).
typedef struct json_text_part
{
    const char *at, *end;
} json_text_part;

/// Pass a byte after blanks, if it is next.
static bool pass_byte(json_text_part *text, char byte)
{
    while (text->at < text->end && memchr(" \t\r\n", *text->at, 4) != NULL)
        text->at++;
    if (text->at == text->end || *text->at != byte)
        return false;
    text->at++;
    return true;
}

/// Pass the four hexadecimal digits of an escape; the result is -1 where there are none.
static long pass_hexadecimal(json_text_part *text)
{
    long value = 0;
    for (int i = 0; i < 4; i++, text->at++)
    {
        static const char DIGITS[] = "0123456789abcdef";
        const char *digit = text->at < text->end ? memchr(DIGITS, tolower((unsigned char)*text->at), 16) : NULL;
        if (digit == NULL)
            return -1;
        value = 16 * value + (digit - DIGITS);
    }
    return value;
}

/// Pass an escape after its backslash. The halves of a surrogate pair come together.
static bool pass_escape(json_text_part *text)
{
    enum
    {
        HIGH = 0xD800,
        LOW = 0xDC00,
        AFTER = 0xE000
    };
    if (text->at == text->end || memchr("\"\\/bfnrtu", *text->at, 9) == NULL)
        return false;
    if (*text->at++ != 'u')
        return true;
    long first = pass_hexadecimal(text);
    if (first < HIGH || first >= AFTER)
        return first >= 0;
    if (first >= LOW || text->end - text->at < 2 || memcmp(text->at, "\\u", 2) != 0)
        return false;
    text->at += 2;
    long second = pass_hexadecimal(text);
    return second >= LOW && second < AFTER;
}

static bool pass_string(json_text_part *text)
{
    if (!pass_byte(text, '"'))
        return false;
    while (text->at < text->end && *text->at != '"')
    {
        unsigned char c = (unsigned char)*text->at++;
        if (c < ' ' || (c == '\\' && !pass_escape(text)))
            return false;
    }
    return text->at < text->end && *text->at++ == '"';
}

static bool pass_digits(json_text_part *text)
{
    const char *begin = text->at;
    while (text->at < text->end && isdigit((unsigned char)*text->at))
        text->at++;
    return text->at > begin;
}

static bool pass_one_of(json_text_part *text, char a, char b)
{
    bool there = text->at < text->end && (*text->at == a || *text->at == b);
    text->at += there;
    return there;
}

static bool pass_number(json_text_part *text)
{
    (void)pass_one_of(text, '-', '-');
    if (!pass_one_of(text, '0', '0') && !pass_digits(text))
        return false;
    if (pass_one_of(text, '.', '.') && !pass_digits(text))
        return false;
    if (!pass_one_of(text, 'e', 'E'))
        return true;
    (void)pass_one_of(text, '+', '-');
    return pass_digits(text);
}

/// Pass a value that is neither an array nor an object; blanks before it have been passed.
static bool pass_scalar(json_text_part *text)
{
    static const char *const WORDS[] = {"true", "false", "null"};
    if (text->at < text->end && *text->at == '"')
        return pass_string(text);
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++)
    {
        size_t size = strlen(WORDS[i]);
        if ((size_t)(text->end - text->at) >= size && memcmp(text->at, WORDS[i], size) == 0)
        {
            text->at += size;
            return true;
        }
    }
    return pass_number(text);
}

static bool pass_name(json_text_part *text)
{
    return pass_string(text) && pass_byte(text, ':');
}

/// Pass what follows a value: closing brackets, then a comma with the next name. False where something else follows.
/// @param open the `depth` brackets that are open
static bool pass_ends(json_text_part *text, const char *open, size_t *depth)
{
    while (*depth > 0 && pass_byte(text, open[*depth - 1] == '[' ? ']' : '}'))
        --*depth;
    return *depth == 0 || (pass_byte(text, ',') && (open[*depth - 1] == '[' || pass_name(text)));
}

/// Whether a text is an array or an object by the grammar of JSON. Encoding, repeated names and the size of numbers are not
/// checked.
static bool is_valid(const char *bytes, size_t size)
{
    enum
    {
        MAX_DEPTH = 2048 ///< Jansson's limit
    };
    json_text_part text = {bytes, bytes + size};
    char open[MAX_DEPTH];
    size_t depth = 0;
    do
    {
        bool array = pass_byte(&text, '['), object = !array && pass_byte(&text, '{');
        if ((array || object) && depth == MAX_DEPTH)
            return false;
        if (array || object)
        {
            open[depth++] = array ? '[' : '{';
            if (pass_byte(&text, array ? ']' : '}'))
                depth--;
            else if (array || pass_name(&text))
                continue;
            else
                return false;
        }
        else if (depth == 0 || !pass_scalar(&text))
            return false;
        if (!pass_ends(&text, open, &depth))
            return false;
    } while (depth > 0);
    (void)pass_byte(&text, '\0');
    return text.at == text.end;
}

/// Whether a failure is one of memory. Jansson leaves no message for most failed allocations. Where its scanner lacks memory
/// it reports a wrong string.
static bool is_of_memory(const json_error_t *fault, const char *text, size_t size)
{
    enum json_error_code code = json_error_code(fault);
    return fault->text[0] == '\0' || code == json_error_out_of_memory ||
           (code == json_error_invalid_syntax && is_valid(text, size));
}

bat_status json_parse(const char *text, size_t size, size_t flags, size_t first_line, json_t **value, bat_error *error)
{
    // Jansson reads numbers with strtod(), in the locale of the thread if it has one of its own.
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (plain == (locale_t)0)
        return error_memory(error, size);
    locale_t before = uselocale(plain);
    json_error_t fault;
    *value = json_loadb(text, size, JSON_REJECT_DUPLICATES | flags, &fault);
    (void)uselocale(before);
    freelocale(plain);
    if (*value != NULL)
        return BAT_OK;
    if (is_of_memory(&fault, text, size))
        return error_memory(error, size);
    json_printable(fault.text);
    size_t line = fault.line > 0 ? first_line + (size_t)fault.line - 1 : first_line;
    return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line, "%s", fault.text);
}
