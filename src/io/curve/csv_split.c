#include "io/curve/csv.h"

#include <string.h>
#include <strings.h>

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

csv_field csv_trimmed(const char *begin, const char *end)
{
    while (begin < end && (is_blank(*begin) || *begin == '\r'))
        begin++;
    while (end > begin && (is_blank(end[-1]) || end[-1] == '\r'))
        end--;
    return (csv_field){begin, end};
}

/// Whether a separator is there outside quotes, and the fields that it makes have at most one comma each.
static bool separates(const text_line *line, char separator, bool *few_commas)
{
    bool quoted = false, found = false;
    size_t commas = 0;
    *few_commas = true;
    for (const char *at = line->begin; at < line->end; at++)
    {
        quoted = quoted != (*at == '"');
        if (quoted)
            continue;
        commas += *at == ',' ? 1 : 0;
        if (*at == separator)
        {
            found = true;
            commas = 0;
        }
        *few_commas = *few_commas && commas <= 1;
    }
    return found;
}

char csv_find_separator(const text_line *line)
{
    bool few, unused, comma = separates(line, ',', &unused);
    for (const char *candidate = ";\t"; *candidate != '\0'; candidate++)
        if (separates(line, *candidate, &few) && (!comma || few))
            return *candidate;
    return comma ? ',' : ' ';
}

/// The end of the field that begins at `at`; null for a quote that does not end.
static const char *field_end(const char *at, const char *end, char separator)
{
    const char *inner = at;
    while (inner < end && is_blank(*inner) && *inner != separator)
        inner++;
    if (inner < end && *inner == '"')
    {
        // A quote within quotes is doubled.
        do
        {
            inner = memchr(inner + 1, '"', (size_t)(end - inner - 1));
            if (inner == NULL)
                return NULL;
            inner++;
        } while (inner < end && *inner == '"');
        at = inner;
    }
    if (separator != ' ')
    {
        const char *found = memchr(at, separator, (size_t)(end - at));
        return found != NULL ? found : end;
    }
    while (at < end && !is_blank(*at))
        at++;
    return at;
}

const char *csv_split(const file_text *text, const text_line *line, char separator, csv_field *fields, size_t *count)
{
    const char *at = line->begin, *end = line->end;
    if (separator == '\t')
    {
        while (at > text->data && is_blank(at[-1]))
            at--;
        while (is_blank(*end)) // the text ends with a zero
            end++;
    }
    for (*count = 0;;)
    {
        const char *stop = field_end(at, end, separator);
        if (stop == NULL)
            return "a quote does not end on its line";
        if (*count == BAT_SPACE_MAX_DIM)
            return "more than 1024 columns";
        fields[(*count)++] = csv_trimmed(at, stop);
        if (stop == end)
            return NULL;
        at = stop + 1;
        while (separator == ' ' && is_blank(*at))
            at++;
    }
}

csv_field csv_unquoted(csv_field field)
{
    if (field.end - field.begin >= 2 && *field.begin == '"' && field.end[-1] == '"')
        return csv_trimmed(field.begin + 1, field.end - 1);
    return field;
}

csv_field csv_text(const char *text)
{
    return csv_unquoted((csv_field){text, text + strlen(text)});
}

const char *csv_field_fault(csv_field field)
{
    static const char mark[] = "\xEF\xBB\xBF";
    size_t size = (size_t)(field.end - field.begin);
    if (size > 0 && memchr(field.begin, '\0', size) != NULL)
        return "has a zero byte";
    bool marked = size >= sizeof mark - 1 && memcmp(field.begin, mark, sizeof mark - 1) == 0;
    return marked ? "has a byte order mark" : NULL;
}

const char *csv_read_number(csv_field field, char separator, double *value, bool *comma)
{
    enum
    {
        LONGEST = 64
    };
    field = csv_unquoted(field);
    if (field.begin == field.end)
        return "is empty";
    const char *fault = number_read(field.begin, field.end, value);
    size_t size = (size_t)(field.end - field.begin);
    if (fault == NULL || separator == ',' || size > LONGEST)
        return fault;
    char text[LONGEST];
    memcpy(text, field.begin, size);
    char *point = memchr(text, ',', size);
    if (point == NULL || memchr(text, '.', size) != NULL)
        return fault;
    *point = '.';
    if (number_read(text, text + size, value) != NULL)
        return fault;
    *comma = true;
    return NULL;
}

bool csv_is_missing(csv_field field)
{
    static const char *const words[] = {"na", "n/a", "nan", "null", "none"};
    field = csv_unquoted(field);
    size_t size = (size_t)(field.end - field.begin);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strlen(words[i]) == size && strncasecmp(field.begin, words[i], size) == 0)
            return true;
    return size == 0;
}

bool csv_read_whole(csv_field field, int64_t *value)
{
    enum
    {
        MAX_DIGITS = 15
    };
    field = csv_unquoted(field);
    bool negative = field.begin < field.end && *field.begin == '-';
    field.begin += negative;
    *value = 0;
    if (field.begin == field.end || field.end - field.begin > MAX_DIGITS)
        return false;
    for (const char *at = field.begin; at < field.end; at++)
    {
        if (*at < '0' || *at > '9')
            return false;
        *value = 10 * *value + (*at - '0');
    }
    *value = negative ? -*value : *value;
    return true;
}
