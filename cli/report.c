#include "report.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Text for people

/// The bytes of the UTF-8 character at the start of a text; 0 where there is none.
static size_t character_length(const unsigned char *text)
{
    size_t length = *text < 0x80                    ? 1
                    : *text >= 0xc2 && *text < 0xe0 ? 2
                    : *text >= 0xe0 && *text < 0xf0 ? 3
                    : *text >= 0xf0 && *text < 0xf5 ? 4
                                                    : 0;
    for (size_t i = 1; i < length; i++)
        if ((text[i] & 0xc0) != 0x80)
            return 0;
    return length;
}

void report_clean(char *text)
{
    for (unsigned char *at = (unsigned char *)text; *at != '\0';)
    {
        size_t length = character_length(at);
        bool c1 = length == 2 && at[0] == 0xc2 && at[1] < 0xa0;
        bool control = length == 0 || at[0] < 0x20 || at[0] == 0x7f || c1;
        length += length == 0;
        if (control)
            memset(at, '?', length);
        at += length;
    }
}

void report_text_list(FILE *stream, const char *format, va_list list)
{
    va_list again;
    va_copy(again, list);
    char usual[1024], *text = usual;
    int length = vsnprintf(usual, sizeof usual, format, list);
    if (length >= (int)sizeof usual)
    {
        text = malloc((size_t)length + 1);
        // Without memory the beginning is shown.
        if (text != NULL)
            (void)vsnprintf(text, (size_t)length + 1, format, again);
        else
            text = usual;
    }
    va_end(again);
    size_t format_length = strlen(format);
    bool ends = format_length > 0 && format[format_length - 1] == '\n';
    if (ends && length > 0)
        text[strlen(text) - 1] = '\0';
    report_clean(text);
    (void)fprintf(stream, ends ? "%s\n" : "%s", text);
    if (text != usual)
        free(text);
}

void report_text(FILE *stream, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    report_text_list(stream, format, list);
    va_end(list);
}

const char *file_name(const char *path)
{
    const char *slash = path != NULL ? strrchr(path, '/') : NULL;
    return slash != NULL ? slash + 1 : path;
}

// Failures and progress

/// The work under way, one at a time.
static struct
{
    const char *what; ///< null when there is none
    bool drawn;       ///< standard error is a terminal
    int percent;      ///< the one drawn last; -1 for none
} work;

static int print_failure(const char *file, size_t line, const char *text)
{
    (void)fputs("batten: ", stderr);
    if (file != NULL)
        report_text(stderr, "%s:", file);
    if (line > 0)
        (void)fprintf(stderr, "%zu:", line);
    report_text(stderr, "%s%s\n", file != NULL || line > 0 ? " " : "", text);
    return EXIT_BAD_INPUT;
}

int(report_failure)(const char *file, const bat_error *error)
{
    return print_failure(file, error->line, error->text);
}

int report_bad_input(const arguments *given, const char *file, const bat_error *error)
{
    char text[WORDING_SIZE];
    argument_wording(given, error, text);
    return print_failure(file, error->line, text);
}

bat_error *report_error(void)
{
    static bat_error error;
    return &error;
}

int report_status(const arguments *given, const char *file, bat_status status)
{
    report_progress_end();
    if (status == BAT_OK)
        return EXIT_DONE;
    return given != NULL ? report_bad_input(given, file, report_error()) : report_failure(file, report_error());
}

static bool draw_progress(void *context BAT_UNUSED, double fraction)
{
    int percent = (int)(100 * fraction);
    if (work.drawn && percent != work.percent)
        (void)fprintf(stderr, "\r%s %3d %%\033[K", work.what, percent);
    work.percent = percent;
    return !interrupt_pending();
}

bat_progress report_progress(const char *what)
{
    interrupt_use(INTERRUPT_COOPERATIVE);
    work.what = what;
    work.drawn = isatty(STDERR_FILENO) != 0;
    work.percent = -1;
    return (bat_progress){draw_progress, NULL};
}

void report_progress_end(void)
{
    if (work.what == NULL)
        return;
    work.what = NULL;
    if (work.drawn && work.percent >= 0)
        (void)fputs("\r\033[K", stderr);
    interrupt_use(INTERRUPT_AT_ONCE);
}

json_t *report_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *report_numbers(const double *values, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        if (json_array_append_new(array, report_number(values[i])) != 0)
        {
            json_decref(array);
            return NULL;
        }
    return array;
}

/// Print JSON with the control characters beyond those of ASCII escaped as well.
static void print_json(const char *text)
{
    for (const unsigned char *at = (const unsigned char *)text; *at != '\0'; at++)
        if (*at == 0x7f)
            (void)printf("\\u007f");
        else if (at[0] == 0xc2 && at[1] < 0xa0)
            (void)printf("\\u%04x", *++at);
        else
            (void)putchar(*at);
    (void)printf("\n");
}

int report_json(json_t *object)
{
    char *text = object != NULL ? json_dumps(object, JSON_INDENT(1) | JSON_REAL_PRECISION(17)) : NULL;
    json_decref(object);
    if (text == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    print_json(text);
    free(text);
    return EXIT_DONE;
}

// Reports

enum
{
    MAX_VALUES = 40
};

/// One value of a report.
typedef struct report_value
{
    const char *key; ///< with `length` bytes
    size_t length;
    char kind;
    bool optional;
    const char *text;
    long long whole;
    double number;
    json_t *json;
} report_value;

/// Read the values of keys; returns how many there are.
static size_t read_values(const char *keys, va_list list, report_value values[MAX_VALUES])
{
    size_t count = 0;
    while (*keys != '\0' && count < MAX_VALUES)
    {
        report_value *value = &values[count++];
        size_t length = strcspn(keys, ":"), whole = strcspn(keys, " ");
        *value = (report_value){
            .key = keys, .length = length, .kind = keys[length + 1], .optional = keys[length + 2] == '?', .number = NAN};
        keys += whole + (keys[whole] == ' ');
        switch (value->kind)
        {
        case 's':
            value->text = va_arg(list, const char *);
            break;
        case 'z':
            value->whole = (long long)va_arg(list, size_t);
            break;
        case 'n':
            value->number = va_arg(list, double);
            break;
        case 'o':
            value->json = va_arg(list, json_t *);
            break;
        default:
            value->whole = va_arg(list, int);
        }
    }
    return count;
}

static bool is_set(const report_value *value)
{
    return (value->text != NULL && *value->text != '\0') || value->whole != 0 || isfinite(value->number) ||
           value->json != NULL;
}

/// The value as JSON; null where memory ran out.
static json_t *value_json(const report_value *value)
{
    switch (value->kind)
    {
    case 's':
        return value->text != NULL ? json_string(value->text) : json_null();
    case 'b':
        return json_boolean(value->whole != 0);
    case 'n':
        return report_number(value->number);
    case 'o':
        return value->json;
    default:
        return json_integer(value->whole);
    }
}

/// Put a value into an object, or into the object in it that the key names first. False where memory ran out.
static bool put_value(json_t *object, const report_value *value)
{
    char name[64];
    const char *dot = memchr(value->key, '.', value->length), *last = dot != NULL ? dot + 1 : value->key;
    if (dot != NULL)
    {
        (void)snprintf(name, sizeof name, "%.*s", (int)(dot - value->key), value->key);
        if (json_object_get(object, name) == NULL)
            (void)json_object_set_new(object, name, json_object());
        object = json_object_get(object, name);
    }
    (void)snprintf(name, sizeof name, "%.*s", (int)(value->key + value->length - last), last);
    return json_object_set_new(object, name, value_json(value)) == 0;
}

static json_t *make_object(const report_value *values, size_t count)
{
    json_t *object = json_object();
    bool failed = object == NULL;
    for (size_t i = 0; i < count; i++)
    {
        const report_value *value = &values[i];
        bool set = value->kind == 'o' ? !json_is_null(value->json) : is_set(value);
        if (value->key[0] != '-' && (set || !value->optional))
            failed = !put_value(object, value) || failed;
    }
    if (!failed)
        return object;
    json_decref(object);
    return NULL;
}

/// The value of a key, which may have a - in front.
static const report_value *find_value(const report_value *values, size_t count, const char *key, size_t length)
{
    for (size_t i = 0; i < count; i++)
    {
        size_t hidden = values[i].key[0] == '-';
        if (values[i].length == length + hidden && strncmp(values[i].key + hidden, key, length) == 0)
            return &values[i];
    }
    static const report_value none = {.key = "", .kind = 's', .text = "", .number = NAN};
    return &none;
}

/// Print what stands between the braces of a field.
static void print_field(const char *field, const report_value *values, size_t count)
{
    char *key = (char *)field, format[16];
    double factor = isdigit((unsigned char)*field) ? strtod(field, &key) : 1;
    key += *key == ' ';
    size_t length = strcspn(key, ":/}"), second = key[length] == '/' ? strcspn(key + length, ":}") : 0;
    const char *how = key + length + second;
    const report_value *value = find_value(values, count, key, length);
    how += *how == ':';
    (void)snprintf(format, sizeof format, "%%%.*s", (int)strcspn(how, "}"), how);
    if (value->kind == 'n')
        (void)printf(format, factor * value->number);
    else if (value->kind == 's')
        report_text(stdout, "%*s", (int)strtol(how, NULL, 10), value->text);
    else
        (void)printf("%*lld", (int)strtol(how, NULL, 10), value->whole);
    if (second == 0)
        return;
    double other = find_value(values, count, key + length + 1, second - 1)->number;
    if (isfinite(other))
        (void)printf(" (%5.3f)", value->number / other);
    else
        (void)printf("        ");
}

static void print_values(const char *text, const report_value *values, size_t count)
{
    size_t hidden = 0; // brackets that are open and not printed
    while (*text != '\0')
    {
        size_t length = strcspn(text, "[]{");
        if (hidden == 0)
            (void)printf("%.*s", (int)length, text);
        text += length;
        if (*text == '[')
        {
            bool negated = text[1] == '!';
            const char *key = text + 1 + negated;
            length = strcspn(key, "?");
            hidden += hidden > 0 || is_set(find_value(values, count, key, length)) == negated;
            text = key + length + 1;
        }
        else if (*text == ']')
        {
            hidden -= hidden > 0;
            text++;
        }
        else if (*text == '{')
        {
            if (hidden == 0)
                print_field(text + 1, values, count);
            text += strcspn(text, "}") + 1;
        }
    }
}

json_t *report_part(bool as_json, const char *text, const char *keys, ...)
{
    report_value values[MAX_VALUES];
    va_list list;
    va_start(list, keys);
    size_t count = read_values(keys, list, values);
    va_end(list);
    if (as_json)
        return make_object(values, count);
    print_values(text, values, count);
    for (size_t i = 0; i < count; i++)
        json_decref(values[i].json);
    return NULL;
}

int report_whole(bool as_json, json_t *object)
{
    return as_json ? report_json(object) : EXIT_DONE;
}

json_t *report_add(json_t *object, const char *key, json_t *member)
{
    if (json_object_set_new(object, key, member) == 0)
        return object;
    json_decref(object);
    return NULL;
}

report_table report_begin(bool as_json)
{
    return (report_table){as_json, as_json ? json_array() : NULL};
}

void report_head(const report_table *table, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    if (!table->as_json)
        (void)vprintf(format, list);
    va_end(list);
}

void report_gather(report_table *table, json_t *row)
{
    if (!table->as_json)
        (void)fflush(stdout);
    else if (json_array_append_new(table->rows, row) != 0)
        (void)report_drop(table, EXIT_BAD_INPUT);
}

int report_drop(report_table *table, int code)
{
    json_decref(table->rows);
    table->rows = NULL;
    return code;
}

int report_end(int code)
{
    if (code != EXIT_DONE || (fflush(stdout) == 0 && !ferror(stdout)))
        return code;
    return report_failure(NULL, &(bat_error){.text = "standard output cannot be written"});
}
