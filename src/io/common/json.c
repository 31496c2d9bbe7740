#include "io/common/json.h"

#include "io/common/number_text.h"

/// @file
/// Writing of JSON values as text.

void json_text_string(text_buffer *text, const char *string, size_t length)
{
    static const size_t LONGEST_ESCAPE = 6;
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

void json_text(text_buffer *text, const json_t *value)
{
    json_type type = json_typeof(value);
    if (type == JSON_OBJECT)
        append_object(text, value);
    else if (type == JSON_ARRAY)
    {
        size_t count = json_array_size(value);
        text_append(text, "[", 1);
        for (size_t i = 0; i < count; i++)
        {
            if (i > 0)
                text_append(text, ",", 1);
            json_text(text, json_array_get(value, i));
        }
        text_append(text, "]", 1);
    }
    else if (type == JSON_STRING)
        json_text_string(text, json_string_value(value), json_string_length(value));
    else if (type == JSON_INTEGER)
        text_append_format(text, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    else if (type == JSON_REAL)
        append_real(text, json_real_value(value));
    else
        text_append_string(text, type == JSON_TRUE ? "true" : type == JSON_FALSE ? "false" : "null");
}

char *json_text_make(const json_t *value)
{
    text_buffer text = {0};
    json_text(&text, value);
    text_append(&text, "", 1);
    if (text.failed)
        text_free(&text);
    return text.data;
}
