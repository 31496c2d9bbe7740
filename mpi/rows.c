#include "rows.h"

#include "ranks.h"

#include <errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum
{
    PART = 8 << 20 ///< bytes read at once, and the longest line
};

void *rows_exchange(const void *rows, size_t row_bytes, const size_t *counts, size_t *received)
{
    size_t ranks = (size_t)ranks_count(), out = 0, in = 0;
    int *numbers = ranks_allocate(4 * ranks, sizeof *numbers), *out_counts = numbers, *out_places = out_counts + ranks;
    int *in_counts = out_places + ranks, *in_places = in_counts + ranks;
    for (size_t rank = 0; rank < ranks; rank++)
    {
        out_counts[rank] = (int)counts[rank];
        out_places[rank] = (int)out;
        out += counts[rank];
    }
    (void)MPI_Alltoall(out_counts, 1, MPI_INT, in_counts, 1, MPI_INT, MPI_COMM_WORLD);
    for (size_t rank = 0; rank < ranks; rank++)
    {
        in_places[rank] = (int)in;
        in += (size_t)in_counts[rank];
    }
    bat_error error = {.status = BAT_TOO_LARGE, .text = "a rank has more than 2^31 points; take more ranks"};
    ranks_need(NULL, out > INT_MAX || in > INT_MAX ? BAT_TOO_LARGE : BAT_OK, &error);
    void *result = ranks_allocate(in, row_bytes);
    MPI_Datatype row;
    (void)MPI_Type_contiguous((int)row_bytes, MPI_BYTE, &row);
    (void)MPI_Type_commit(&row);
    (void)MPI_Alltoallv(rows, out_counts, out_places, row, result, in_counts, in_places, row, MPI_COMM_WORLD);
    (void)MPI_Type_free(&row);
    free(numbers);
    *received = in;
    return result;
}

/// Open a file on all ranks. False after a message.
static bool open_file(const char *path, MPI_File *file, MPI_Offset *size)
{
    bat_error error = {0};
    if (access(path, R_OK) != 0)
    {
        error = (bat_error){.status = BAT_FILE_ACCESS, .index = BAT_NO_INDEX};
        (void)snprintf(error.text, sizeof error.text, "cannot read: %s", strerror(errno));
    }
    if (!ranks_agree(path, error.status, &error))
        return false;
    if (MPI_File_open(MPI_COMM_WORLD, path, MPI_MODE_RDONLY, MPI_INFO_NULL, file) != MPI_SUCCESS ||
        MPI_File_get_size(*file, size) != MPI_SUCCESS)
    {
        error = (bat_error){.status = BAT_FILE_ACCESS, .index = BAT_NO_INDEX, .text = "cannot be read by MPI"};
        ranks_need(path, BAT_FILE_ACCESS, &error);
    }
    return true;
}

static void fail_at(bat_error *error, bat_status status, size_t line, const char *text)
{
    *error = (bat_error){.status = status, .index = BAT_NO_INDEX, .line = line};
    (void)snprintf(error->text, sizeof error->text, "%s", text);
}

static void append(rows_text *text, size_t *capacity, const double *row)
{
    if (text->count == *capacity)
    {
        *capacity = *capacity > 0 ? *capacity + *capacity / 2 : 4096;
        double *grown = ranks_grow(text->values, *capacity * text->columns, sizeof *grown);
        text->values = grown;
    }
    memcpy(text->values + text->count++ * text->columns, row, text->columns * sizeof *row);
}

/// Read a line, which ends with a null.
/// @param line counted from 1 in this rank's part
static void read_line(char *at, size_t line, rows_text *text, size_t *capacity, bat_error *error)
{
    double row[8] = {0};
    size_t count = 0;
    char *remark = strchr(at, '#'), *end;
    if (remark != NULL)
    {
        if (text->count == 0 && text->boundary == 0)
            (void)sscanf(remark, "# %zu boundary points first", &text->boundary);
        *remark = '\0';
    }
    for (; count < text->columns; count++, at = end)
    {
        row[count] = strtod(at, &end);
        if (end == at)
            break;
    }
    at += strspn(at, " \t\r");
    if (count == 0 && *at == '\0')
        return;
    if (count < text->needed)
        fail_at(error, BAT_BAD_FILE, line,
                text->needed == 5   ? "is not x y z u v; --parameterization FILE reads u v from FILE"
                : text->needed == 3 ? "is not x y z"
                                    : "is not u v");
    else
        append(text, capacity, row);
}

/// Read the lines that begin at bytes `begin` to `end` - 1.
/// @return their number
static size_t read_lines(MPI_File file, MPI_Offset size, MPI_Offset begin, MPI_Offset end, rows_text *text, bat_error *error)
{
    char *buffer = ranks_allocate(PART + 1, 1);
    size_t held = 0, lines = 0, capacity = 0;
    // The byte before tells whether a line begins at `begin`.
    MPI_Offset next = begin > 0 ? begin - 1 : 0, start = next;
    bool skips = begin > 0;
    while (error->status == BAT_OK && start < end && (next < size || held > 0))
    {
        MPI_Status status;
        int wanted = (int)(size - next < (MPI_Offset)(PART - held) ? size - next : (MPI_Offset)(PART - held)), got = 0;
        if (wanted > 0 && (MPI_File_read_at(file, next, buffer + held, wanted, MPI_BYTE, &status) != MPI_SUCCESS ||
                           MPI_Get_count(&status, MPI_BYTE, &got) != MPI_SUCCESS || got != wanted))
            fail_at(error, BAT_FILE_ACCESS, 0, "cannot be read");
        next += wanted;
        held += (size_t)wanted;
        size_t at = 0;
        while (error->status == BAT_OK && at < held && start < end)
        {
            char *stop = memchr(buffer + at, '\n', held - at);
            if (stop == NULL && next < size)
                break;
            size_t length = stop != NULL ? (size_t)(stop - buffer) - at : held - at, whole = length + (stop != NULL);
            buffer[at + length] = '\0';
            if (!skips)
            {
                lines++;
                if (strlen(buffer + at) != length)
                    fail_at(error, BAT_BAD_FILE, lines, "has a null byte");
                else
                    read_line(buffer + at, lines, text, &capacity, error);
            }
            skips = false;
            at += whole;
            start += (MPI_Offset)whole;
        }
        if (at == 0 && held == PART)
            fail_at(error, BAT_BAD_FILE, lines + 1, "the line is too long");
        memmove(buffer, buffer + at, held - at);
        held -= at;
        if (next == size && held == 0)
            break;
    }
    free(buffer);
    return lines;
}

bool rows_read_text(const char *path, rows_text *text)
{
    MPI_File file;
    MPI_Offset size, rank = ranks_rank(), ranks = ranks_count();
    bat_error error = {0};
    if (!open_file(path, &file, &size))
        return false;
    MPI_Offset begin = size / ranks * rank + size % ranks * rank / ranks;
    MPI_Offset end = size / ranks * (rank + 1) + size % ranks * (rank + 1) / ranks;
    unsigned long long lines = read_lines(file, size, begin, end, text, &error), before = 0;
    (void)MPI_Exscan(&lines, &before, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
    // Only the first lines tell the boundary.
    unsigned long long boundary = text->boundary;
    (void)MPI_Bcast(&boundary, 1, MPI_UNSIGNED_LONG_LONG, 0, MPI_COMM_WORLD);
    text->boundary = (size_t)boundary;
    (void)MPI_File_close(&file);
    if (error.line > 0)
        error.line += rank > 0 ? (size_t)before : 0;
    if (ranks_agree(path, error.status, &error))
        return true;
    free(text->values);
    text->values = NULL;
    return false;
}

// Binary PLY

enum
{
    HEADER = 1 << 16, ///< bytes that hold the header
    FIELDS = 5
};

/// Where the numbers of a vertex are.
typedef struct ply_layout
{
    uint64_t data, rows;
    uint32_t row_bytes;
    uint32_t place[FIELDS];
    uint32_t bytes[FIELDS]; ///< 4, 8, or 0 for a property that is not there
} ply_layout;

/// Bytes of a type of PLY; 0 for none.
static uint32_t bytes_of_type(const char *name, bool *real)
{
    static const struct
    {
        const char *name;
        uint32_t bytes;
        bool real;
    } TYPES[] = {{"char", 1, false},  {"uchar", 1, false},  {"int8", 1, false},  {"uint8", 1, false},
                 {"short", 2, false}, {"ushort", 2, false}, {"int16", 2, false}, {"uint16", 2, false},
                 {"int", 4, false},   {"uint", 4, false},   {"int32", 4, false}, {"uint32", 4, false},
                 {"float", 4, true},  {"float32", 4, true}, {"double", 8, true}, {"float64", 8, true}};
    for (size_t k = 0; k < sizeof TYPES / sizeof *TYPES; k++)
        if (strcmp(name, TYPES[k].name) == 0)
        {
            *real = TYPES[k].real;
            return TYPES[k].bytes;
        }
    return 0;
}

/// One property of a vertex. False for one that cannot be read.
static bool add_property(const char *line, ply_layout *layout)
{
    static const char *const NAMES[2][FIELDS] = {{"x", "y", "z", "u", "v"}, {"x", "y", "z", "s", "t"}};
    char type[32], name[64];
    bool real = false;
    if (sscanf(line, "property %31s %63s", type, name) != 2)
        return false;
    uint32_t bytes = bytes_of_type(type, &real);
    for (size_t k = 0; k < FIELDS; k++)
        if (strcmp(name, NAMES[0][k]) == 0 || strcmp(name, NAMES[1][k]) == 0)
        {
            if (!real)
                return false;
            layout->place[k] = layout->row_bytes;
            layout->bytes[k] = bytes;
        }
    layout->row_bytes += bytes;
    return bytes > 0;
}

/// Read a header. Null, or what is wrong.
static const char *read_header(char *header, size_t needed, ply_layout *layout)
{
    char *end = strstr(header, "end_header\n"), *rest = NULL;
    bool vertices = false;
    size_t elements = 0;
    if (strncmp(header, "ply\n", 4) != 0 || end == NULL)
        return "is not a PLY file with lines that end with LF";
    if (strstr(header, "\nformat binary_little_endian 1.0\n") == NULL)
        return "is not a binary little-endian PLY file; XYZ holds text";
    layout->data = (uint64_t)(end - header) + strlen("end_header\n");
    *end = '\0';
    for (char *line = strtok_r(header, "\n", &rest); line != NULL; line = strtok_r(NULL, "\n", &rest))
    {
        unsigned long long rows;
        char name[64];
        if (sscanf(line, "element %63s %llu", name, &rows) == 2)
        {
            vertices = strcmp(name, "vertex") == 0;
            if (elements++ == 0 && !vertices)
                return "does not begin with the vertices";
            if (vertices)
                layout->rows = rows;
            else if (rows > 0)
                return "has other elements than vertices; a mesh is for `batten surface`";
        }
        else if (vertices && strncmp(line, "property", 8) == 0 && !add_property(line, layout))
            return "has a property of vertices that cannot be read";
    }
    for (size_t k = 0; k < needed; k++)
        if (layout->bytes[k] == 0)
            return k < 3 ? "has no x, y and z that are float or double"
                         : "has no properties u and v; --parameterization FILE reads them from FILE";
    return NULL;
}

static double number_of(const char *row, const ply_layout *layout, size_t field)
{
    float single;
    double number = 0;
    if (layout->bytes[field] == sizeof single)
    {
        memcpy(&single, row + layout->place[field], sizeof single);
        return single;
    }
    if (layout->bytes[field] == sizeof number)
        memcpy(&number, row + layout->place[field], sizeof number);
    return number;
}

/// Read this rank's rows.
static void read_rows(MPI_File file, const ply_layout *layout, rows_text *text, bat_error *error)
{
    uint64_t rank = (uint64_t)ranks_rank(), ranks = (uint64_t)ranks_count();
    uint64_t first = layout->rows / ranks * rank + (rank < layout->rows % ranks ? rank : layout->rows % ranks);
    text->count = layout->rows / ranks + (rank < layout->rows % ranks);
    text->values = ranks_allocate(text->count * text->columns, sizeof(double));
    size_t at_once = PART / layout->row_bytes;
    char *buffer = ranks_allocate(PART, 1);
    for (size_t begin = 0; begin < text->count && error->status == BAT_OK; begin += at_once)
    {
        size_t rows = text->count - begin < at_once ? text->count - begin : at_once;
        MPI_Status status;
        int wanted = (int)(rows * layout->row_bytes), got = 0;
        MPI_Offset place = (MPI_Offset)(layout->data + (first + begin) * layout->row_bytes);
        if (MPI_File_read_at(file, place, buffer, wanted, MPI_BYTE, &status) != MPI_SUCCESS ||
            MPI_Get_count(&status, MPI_BYTE, &got) != MPI_SUCCESS || got != wanted)
            fail_at(error, BAT_FILE_ACCESS, 0, "cannot be read");
        for (size_t i = 0; i < rows && error->status == BAT_OK; i++)
            for (size_t k = 0; k < text->columns; k++)
                text->values[(begin + i) * text->columns + k] = number_of(buffer + i * layout->row_bytes, layout, k);
    }
    free(buffer);
}

bool rows_read_ply(const char *path, rows_text *text)
{
    MPI_File file;
    MPI_Offset size;
    bat_error error = {0};
    ply_layout layout = {0};
    if (!open_file(path, &file, &size))
        return false;
    char *header = ranks_allocate(HEADER + 1, 1);
    (void)MPI_File_read_at_all(file, 0, header, (int)(size < HEADER ? size : HEADER), MPI_BYTE, MPI_STATUS_IGNORE);
    const char *wrong = read_header(header, text->needed, &layout);
    free(header);
    if (wrong == NULL && (layout.row_bytes > PART || layout.rows > (uint64_t)size ||
                          layout.data + layout.rows * layout.row_bytes > (uint64_t)size))
        wrong = "ends before the last vertex";
    if (wrong != NULL)
        fail_at(&error, BAT_BAD_FILE, 0, wrong);
    else
        read_rows(file, &layout, text, &error);
    (void)MPI_File_close(&file);
    if (ranks_agree(path, error.status, &error))
        return true;
    free(text->values);
    text->values = NULL;
    return false;
}

// Parameters

/// The numbers of the first line that has some.
static size_t count_numbers(char *text)
{
    char *rest = NULL;
    for (char *line = strtok_r(text, "\n", &rest); line != NULL; line = strtok_r(NULL, "\n", &rest))
    {
        size_t count = 0;
        char *remark = strchr(line, '#'), *end;
        if (remark != NULL)
            *remark = '\0';
        for (;; count++, line = end)
        {
            (void)strtod(line, &end);
            if (end == line)
                break;
        }
        if (count > 0)
            return count;
    }
    return 0;
}

bool rows_have_parameters(const char *path, bat_cloud_format format)
{
    int found = 0;
    if (ranks_rank() == 0)
    {
        FILE *file = fopen(path, "rb");
        char *text = ranks_allocate(HEADER + 1, 1);
        size_t size = file != NULL ? fread(text, 1, HEADER, file) : 0;
        text[size] = '\0';
        if (file != NULL)
            (void)fclose(file);
        ply_layout layout = {0};
        const bat_choice *row = NULL;
        if (format == BAT_CLOUD_FORMAT_AUTO)
            (void)bat_choice_of_path(&bat_cloud_format_family, path, false, &row, NULL);
        if (row != NULL)
            format = (bat_cloud_format)row->value;
        found = format == BAT_CLOUD_FORMAT_PLY ? read_header(text, FIELDS, &layout) == NULL : count_numbers(text) == FIELDS;
        free(text);
    }
    (void)MPI_Bcast(&found, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return found != 0;
}
