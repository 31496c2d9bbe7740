#ifndef TESTS_SUPPORT_MESH_FILE_HELPERS_H
#define TESTS_SUPPORT_MESH_FILE_HELPERS_H

// Mesh files in memory: random meshes, reading, writing, comparison, refusals.

#include "check.h"
#include "error_helpers.h"

#include "batten/mesh_file.h"

/// Numbers as files have them, the smaller bytes first, on every machine.
static inline void little_endian(void *to, const float *numbers, size_t count)
{
    unsigned char *bytes = to;
    for (size_t i = 0; i < count; i++)
    {
        uint32_t bits;
        memcpy(&bits, numbers + i, sizeof bits);
        for (size_t k = 0; k < sizeof bits; k++)
            bytes[sizeof bits * i + k] = (unsigned char)(bits >> 8 * k);
    }
}

static inline double any_number(bat_random *random)
{
    return ldexp(bat_random_uniform(random) - 0.5, (int)(bat_random_bits(random) % 40) - 20);
}

/// The data of a random mesh in addition to positions and faces.
typedef struct mesh_extras
{
    size_t texture; ///< texture coordinates; SIZE_MAX: one for every vertex
    const char *const *channels;
    size_t channel_count;
    bool marks;
} mesh_extras;

static inline void add_random_channels(bat_random *random, const mesh_extras *extras, bat_mesh *mesh)
{
    mesh->channel_count = extras->channel_count;
    mesh->channel_names = malloc(extras->channel_count * sizeof *mesh->channel_names);
    mesh->channels = malloc(mesh->vertex_count * extras->channel_count * sizeof(double));
    for (size_t i = 0; i < extras->channel_count; i++)
        mesh->channel_names[i] = strdup(extras->channels[i]);
    for (size_t i = 0; i < mesh->vertex_count * extras->channel_count; i++)
        mesh->channels[i] = bat_random_uniform(random);
}

static inline void add_random_marks(bat_random *random, bat_mesh *mesh)
{
    mesh->crease_count = mesh->corner_count = 5;
    mesh->creases = malloc(mesh->crease_count * sizeof *mesh->creases);
    mesh->corners = malloc(mesh->corner_count * sizeof *mesh->corners);
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        const uint32_t *face = mesh->faces + 3 * (bat_random_bits(random) % mesh->face_count);
        mesh->creases[i] = (bat_mesh_crease){face[0], face[1], 10 * bat_random_uniform(random)};
        mesh->corners[i] = (bat_mesh_corner){face[2], 10 * bat_random_uniform(random)};
    }
}

/// Random triangles between vertices of any magnitude. Every vertex has a face.
static inline bat_mesh random_mesh(uint64_t seed, size_t vertices, size_t faces, const mesh_extras *extras)
{
    bat_random random = bat_random_seed(seed);
    bat_mesh mesh = {.positions = malloc(vertices * 3 * sizeof(double)),
                     .faces = malloc(faces * 3 * sizeof(uint32_t)),
                     .vertex_count = vertices,
                     .face_count = faces};
    for (size_t i = 0; i < 3 * vertices; i++)
        mesh.positions[i] = any_number(&random);
    for (size_t f = 0; f < faces; f++)
    {
        uint32_t a = (uint32_t)(f % vertices), step = (uint32_t)(1 + bat_random_bits(&random) % (vertices / 2 - 1));
        const uint32_t corners[3] = {a, (uint32_t)((a + step) % vertices), (uint32_t)((a + 2 * step) % vertices)};
        memcpy(mesh.faces + 3 * f, corners, sizeof corners);
    }
    if (extras == NULL)
        return mesh;
    if (extras->channel_count > 0)
        add_random_channels(&random, extras, &mesh);
    if (extras->marks)
        add_random_marks(&random, &mesh);
    if (extras->texture == 0)
        return mesh;
    bool by_vertex = extras->texture == SIZE_MAX;
    mesh.texture_count = by_vertex ? vertices : extras->texture;
    mesh.texture = malloc(mesh.texture_count * 2 * sizeof(double));
    mesh.texture_faces = malloc(faces * 3 * sizeof(uint32_t));
    for (size_t i = 0; i < 2 * mesh.texture_count; i++)
        mesh.texture[i] = any_number(&random);
    for (size_t i = 0; i < 3 * faces; i++)
        mesh.texture_faces[i] = by_vertex ? mesh.faces[i] : (uint32_t)(bat_random_bits(&random) % mesh.texture_count);
    return mesh;
}

static inline bat_mesh_read_options reading_as(bat_mesh_format format)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    options.format = format;
    options.strict = true;
    options.weld = 0;
    return options;
}

static inline bat_mesh must_read_bytes(const void *bytes, size_t size, const bat_mesh_read_options *options)
{
    bat_mesh mesh = {0};
    bat_error error = {0};
    if (bat_mesh_read_memory(bytes, size, options, &mesh, &error) != BAT_OK)
        fail_msg("line %zu: %s", error.line, error.text);
    assert_int_equal(bat_mesh_check(&mesh, &error), BAT_OK);
    return mesh;
}

static inline bat_mesh must_read(const char *text, bat_mesh_format format)
{
    bat_mesh_read_options options = reading_as(format);
    return must_read_bytes(text, strlen(text), &options);
}

/// Read with triangulation of polygons.
static inline bat_mesh must_cut(const char *text, bat_mesh_format format)
{
    bat_mesh_read_options options = reading_as(format);
    options.triangulate = true;
    return must_read_bytes(text, strlen(text), &options);
}

/// Reading these bytes fails with this status, and no memory leaks.
static inline void assert_refused(const void *bytes, size_t size, const bat_mesh_read_options *options, bat_status expected,
                                  size_t line, const char *words)
{
    bat_mesh mesh = {.vertex_count = 17};
    bat_error error = {0};
    // A copy of exact size, so that the sanitizer detects reads beyond its end.
    void *copy = malloc(size + (size == 0));
    memcpy(copy, bytes, size);
    bat_status status = bat_mesh_read_memory(copy, size, options, &mesh, &error);
    assert_int_equal(bat_mesh_read_memory(copy, size, options, &mesh, NULL), status);
    free(copy);
    if (status != expected || strstr(error_words(&error), words) == NULL || error.line != line)
        fail_msg("status \"%s\", line %zu, \"%s\" instead of \"%s\", line %zu, \"%s\"", bat_status_name(status), error.line,
                 error.text, bat_status_name(expected), line, words);
    assert_null(strchr(error.text, '\n'));
    assert_int_equal(error.status, expected);
    assert_int_equal(mesh.vertex_count, 17);
    assert_null(mesh.positions);
}

static inline void assert_bad(const char *text, bat_mesh_format format, size_t line, const char *words)
{
    bat_mesh_read_options options = reading_as(format);
    assert_refused(text, strlen(text), &options, BAT_BAD_FILE, line, words);
}

static inline bat_mesh_write_options writing_as(bat_mesh_format format, bat_mesh_encoding encoding)
{
    bat_mesh_write_options options = bat_mesh_write_defaults();
    options.format = format;
    options.encoding = encoding;
    return options;
}

/// The bytes of a mesh as a file; they do not depend on the number of threads.
static inline char *must_write(const bat_mesh *mesh, bat_mesh_format format, bat_mesh_encoding encoding, size_t *size)
{
    bat_mesh_write_options options = writing_as(format, encoding);
    char *bytes[2] = {NULL, NULL};
    size_t sizes[2];
    bat_error error = {0};
    for (int i = 0; i < 2; i++)
    {
        options.threads = i + 1;
        if (bat_mesh_write_memory(mesh, &options, &bytes[i], &sizes[i], &error) != BAT_OK)
            fail_msg("%s", error.text);
    }
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0] + 1);
    free(bytes[1]);
    *size = sizes[0];
    return bytes[0];
}

static inline bat_mesh through_file(const bat_mesh *mesh, bat_mesh_format format, bat_mesh_encoding encoding)
{
    size_t size;
    char *bytes = must_write(mesh, format, encoding, &size);
    bat_mesh_read_options options = reading_as(BAT_MESH_FORMAT_AUTO);
    bat_mesh back = must_read_bytes(bytes, size, &options);
    free(bytes);
    return back;
}

static inline void assert_text(const bat_mesh *mesh, bat_mesh_format format, const char *expected)
{
    size_t size;
    char *text = must_write(mesh, format, BAT_MESH_ENCODING_TEXT, &size);
    assert_string_equal(text, expected);
    free(text);
}

static inline void assert_unwritable(const bat_mesh *mesh, bat_mesh_format format, bat_mesh_encoding encoding,
                                     bat_status expected, const char *words)
{
    bat_mesh_write_options options = writing_as(format, encoding);
    char *bytes = NULL;
    size_t size;
    bat_error error = {0};
    assert_int_equal(bat_mesh_write_memory(mesh, &options, &bytes, &size, &error), expected);
    assert_int_equal(bat_mesh_write_memory(mesh, &options, &bytes, &size, NULL), expected);
    if (strstr(error.text, words) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
    assert_null(bytes);
}

static inline void assert_same_shape(const bat_mesh *a, const bat_mesh *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->face_count, b->face_count);
    assert_memory_equal(a->positions, b->positions, a->vertex_count * 3 * sizeof(double));
    assert_memory_equal(a->faces, b->faces, a->face_count * 3 * sizeof(uint32_t));
}

/// The same texture coordinates at the same corners, in any numbering.
static inline void assert_same_texture(const bat_mesh *a, const bat_mesh *b)
{
    assert_int_equal(a->texture_faces == NULL, b->texture_faces == NULL);
    for (size_t i = 0; i < 3 * a->face_count && a->texture_faces != NULL; i++)
        assert_memory_equal(a->texture + 2 * (size_t)a->texture_faces[i], b->texture + 2 * (size_t)b->texture_faces[i],
                            2 * sizeof(double));
}

static inline void assert_same_channels(const bat_mesh *a, const bat_mesh *b)
{
    assert_int_equal(a->channel_count, b->channel_count);
    for (size_t i = 0; i < a->channel_count; i++)
        assert_string_equal(a->channel_names[i], b->channel_names[i]);
    if (a->channel_count > 0)
        assert_memory_equal(a->channels, b->channels, a->vertex_count * a->channel_count * sizeof(double));
}

/// Every proper prefix of a file is refused without a leak, except for the given number of last bytes.
static inline void assert_truncations_fail(const char *bytes, size_t size, size_t spare, bat_mesh_format format)
{
    bat_mesh_read_options options = reading_as(format);
    for (size_t cut = 0; cut + spare < size; cut++)
    {
        bat_mesh mesh = {0};
        bat_error error = {0};
        char *copy = malloc(cut + 1);
        memcpy(copy, bytes, cut);
        bat_status status = bat_mesh_read_memory(copy, cut, &options, &mesh, &error);
        free(copy);
        if (status != BAT_BAD_FILE)
            fail_msg("%zu of %zu bytes: %s", cut, size, bat_status_name(status));
        assert_int_not_equal(error.text[0], '\0');
    }
}

#endif
