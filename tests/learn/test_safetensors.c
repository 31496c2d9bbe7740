#include "check.h"

#include "learn/safetensors.h"

#include <unistd.h>

/// A file with this header and this much data: bytes 1, 2, 3, …
static bat_status parse_size(const char *header, size_t data_size, safetensors *content, bat_error *error)
{
    size_t length = strlen(header);
    unsigned char *bytes = malloc(8 + length + data_size);
    for (size_t i = 0; i < 8; i++)
        bytes[i] = (unsigned char)(length >> (8 * i));
    memcpy(bytes + 8, header, length);
    for (size_t i = 0; i < data_size; i++)
        bytes[8 + length + i] = (unsigned char)(i + 1);
    bat_status status = safetensors_parse(bytes, 8 + length + data_size, content, error);
    free(bytes);
    return status;
}

static void reads_arrays_in_the_order_of_their_data(void **state)
{
    (void)state;
    safetensors content;
    check_status(parse_size("{\"b\":{\"dtype\":\"U8\",\"shape\":[2,1],\"data_offsets\":[4,6]},"
                            "\"__metadata__\":{\"who\":\"us\"},"
                            "\"a\":{\"dtype\":\"I16\",\"shape\":[2],\"data_offsets\":[0,4]},"
                            "\"none\":{\"shape\":[3,0],\"dtype\":\"F64\",\"data_offsets\":[6,6]},"
                            "\"one\":{\"dtype\":\"I8\",\"shape\":[],\"data_offsets\":[6,7]}}   ",
                            7, &content, NULL),
                 BAT_OK);
    assert_int_equal(content.array_count, 4);
    assert_string_equal(content.arrays[0].name, "a");
    assert_string_equal(content.arrays[1].name, "b");
    assert_string_equal(safetensors_find_note(&content, "who"), "us");
    assert_null(safetensors_find_note(&content, "what"));
    assert_null(safetensors_find(&content, "__metadata__"));
    const safetensors_array *b = safetensors_find(&content, "b");
    assert_int_equal(b->rank, 2);
    assert_int_equal(b->shape[0], 2);
    assert_int_equal(b->shape[1], 1);
    int64_t whole[2];
    check_status(safetensors_integers(&content, "a", 2, whole, NULL), BAT_OK);
    assert_int_equal(whole[0], 0x0201);
    assert_int_equal(whole[1], 0x0403);
    double numbers[2];
    check_status(safetensors_doubles(&content, "b", 2, numbers, NULL), BAT_OK);
    check_near(numbers[1], 6, 0);
    check_status(safetensors_integers(&content, "one", 1, whole, NULL), BAT_OK);
    assert_int_equal(whole[0], 7);
    check_status(safetensors_doubles(&content, "none", 0, NULL, NULL), BAT_OK);

    bat_error error;
    check_status(safetensors_doubles(&content, "c", 2, numbers, &error), BAT_BAD_FILE);
    assert_string_equal(error.text, "there is no array 'c'");
    check_status(safetensors_doubles(&content, "b", 3, numbers, &error), BAT_BAD_FILE);
    assert_string_equal(error.text, "array 'b' has 2 elements, not 3");
    check_status(safetensors_integers(&content, "none", 0, whole, &error), BAT_BAD_FILE);
    assert_string_equal(error.text, "array 'none' is of the wrong type F64");
    safetensors_free(&content);
}

static void refuses_what_does_not_fit(void **state)
{
    (void)state;
    const struct
    {
        const char *header;
        size_t data_size;
        bat_status status;
    } cases[] = {
        {"", 0, BAT_BAD_FILE},
        {"[]", 0, BAT_BAD_FILE},
        {" {}", 0, BAT_BAD_FILE},
        {"{", 0, BAT_BAD_FILE},
        {"{} x", 0, BAT_BAD_FILE},
        {"{}", 1, BAT_BAD_FILE},
        {"{\"a\":1}", 0, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[1]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[1],\"data_offsets\":[0,1],\"more\":1}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U9\",\"shape\":[1],\"data_offsets\":[0,1]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":8,\"shape\":[1],\"data_offsets\":[0,1]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":1,\"data_offsets\":[0,1]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[-1],\"data_offsets\":[0,1]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[1.0],\"data_offsets\":[0,1]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[1],\"data_offsets\":[0]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[1],\"data_offsets\":[0,2]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[1],\"data_offsets\":[1,0]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[2],\"data_offsets\":[0,1]}}", 1, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"F64\",\"shape\":[2305843009213693952],\"data_offsets\":[0,0]}}", 0, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[4294967296,4294967296],\"data_offsets\":[0,0]}}", 0, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[99999999999999999999],\"data_offsets\":[0,0]}}", 0, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[1],\"data_offsets\":[1,2]}}", 2, BAT_BAD_FILE}, // a gap
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[2],\"data_offsets\":[0,2]},"
         "\"b\":{\"dtype\":\"U8\",\"shape\":[2],\"data_offsets\":[1,3]}}",
         3, BAT_BAD_FILE}, // an overlap
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[1],\"data_offsets\":[0,1]},"
         "\"a\":{\"dtype\":\"U8\",\"shape\":[1],\"data_offsets\":[1,2]}}",
         2, BAT_BAD_FILE}, // a name twice
        {"{\"__metadata__\":1}", 0, BAT_BAD_FILE},
        {"{\"__metadata__\":{\"a\":1}}", 0, BAT_BAD_FILE},
        {"{\"a\":{\"dtype\":\"U8\",\"shape\":[1,1,1,1,1,1,1,1,1],\"data_offsets\":[0,1]}}", 1, BAT_UNSUPPORTED},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        safetensors content = {.array_count = 77};
        bat_error error = {0};
        bat_status status = parse_size(cases[i].header, cases[i].data_size, &content, &error);
        if (status != cases[i].status)
            print_error("%s gives %s\n", cases[i].header, bat_status_name(status));
        check_status(status, cases[i].status);
        assert_true(error.text[0] != '\0');
        assert_int_equal(content.array_count, 77);
    }
}

static void messages_are_one_line(void **state)
{
    (void)state;
    const char *headers[] = {"{\"a\\nb\":1}", "{\"a\\u0007\":{\"dtype\":\"U8\",\"shape\":1,\"data_offsets\":[0,1]}}",
                             "{\"__metadata__\":{\"a\\r\\n\":1}}", "{\"a\":\n\n\x01}"};
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
    {
        safetensors content;
        bat_error error;
        check_status(parse_size(headers[i], 0, &content, &error), BAT_BAD_FILE);
        for (const char *c = error.text; *c != '\0'; c++)
            assert_in_range(*c, ' ', '~');
    }
}

static void refuses_headers_that_run_past_the_end(void **state)
{
    (void)state;
    const unsigned char long_header[] = {3, 0, 0, 0, 0, 0, 0, 0, '{', '}'};
    const unsigned char huge_header[] = {2, 0, 0, 0, 0, 0, 0, 0x80, '{', '}'};
    safetensors content;
    check_status(safetensors_parse(long_header, sizeof long_header, &content, NULL), BAT_BAD_FILE);
    check_status(safetensors_parse(huge_header, sizeof huge_header, &content, NULL), BAT_BAD_FILE);
    for (size_t size = 0; size < 8; size++)
        check_status(safetensors_parse(long_header, size, &content, NULL), BAT_BAD_FILE);
}

static void comes_back_as_it_was_written(void **state)
{
    (void)state;
    const double reals[] = {1.5, -0.0, INFINITY, 1e-320, 5, 6};
    const float floats[] = {0.1f, 3};
    const int64_t whole[] = {INT64_MIN, INT64_MAX};
    const uint8_t flags[] = {1, 0, 1};
    safetensors_array arrays[] = {
        {.name = "flags", .type = SAFETENSORS_BOOL, .rank = 1, .shape = {3}, .count = 3, .values = flags},
        {.name = "r\"é\n", .type = SAFETENSORS_F64, .rank = 2, .shape = {2, 3}, .count = 6, .values = reals},
        {.name = "f", .type = SAFETENSORS_F32, .rank = 1, .shape = {2}, .count = 2, .values = floats},
        {.name = "i", .type = SAFETENSORS_I64, .rank = 1, .shape = {2}, .count = 2, .values = whole},
        {.name = "empty", .type = SAFETENSORS_F16, .rank = 1, .shape = {0}, .count = 0, .values = NULL},
    };
    safetensors_note notes[] = {{"seed", "42"}, {"by", "a test"}};
    safetensors written = {.arrays = arrays, .array_count = 5, .notes = notes, .note_count = 2}, content;
    char path[] = "/tmp/batten-safetensors-XXXXXX";
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    (void)close(descriptor);
    check_status(safetensors_write(path, &written, NULL), BAT_OK);
    check_status(safetensors_read(path, &content, NULL), BAT_OK);
    assert_int_equal(content.array_count, 5);
    for (size_t i = 0; i < 5; i++)
    {
        const safetensors_array *array = &content.arrays[i];
        assert_string_equal(array->name, arrays[i].name);
        assert_int_equal(array->type, arrays[i].type);
        assert_int_equal(array->rank, arrays[i].rank);
        assert_memory_equal(array->shape, arrays[i].shape, array->rank * sizeof *array->shape);
        if (array->count > 0)
            assert_memory_equal(array->values, arrays[i].values, array->count * safetensors_element_size(array->type));
        assert_int_equal((uintptr_t)array->values % 64, 0);
    }
    assert_string_equal(safetensors_find_note(&content, "seed"), "42");
    assert_string_equal(safetensors_find_note(&content, "by"), "a test");
    safetensors_free(&content);
    (void)unlink(path);
    bat_error error;
    check_status(safetensors_read(path, &content, &error), BAT_FILE_ACCESS);
}

static void refuses_to_write_what_cannot_be_read(void **state)
{
    (void)state;
    const uint8_t bytes[4] = {0};
    safetensors_array arrays[2] = {
        {.name = "a", .type = SAFETENSORS_U8, .rank = 1, .shape = {4}, .count = 4, .values = bytes},
        {.name = "a", .type = SAFETENSORS_U8, .rank = 1, .shape = {4}, .count = 4, .values = bytes},
    };
    safetensors content = {.arrays = arrays, .array_count = 2};
    text_buffer out = {0};
    bat_error error;
    check_status(safetensors_encode(&content, &out, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 1);
    arrays[1].name = "\xff";
    check_status(safetensors_encode(&content, &out, &error), BAT_INVALID_ARGUMENT);
    arrays[1].name = "b";
    arrays[1].count = 3;
    check_status(safetensors_encode(&content, &out, &error), BAT_INVALID_ARGUMENT);
    arrays[1].name = "__metadata__";
    arrays[1].count = 4;
    check_status(safetensors_encode(&content, &out, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(out.size, 0);
    text_free(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_arrays_in_the_order_of_their_data),
        cmocka_unit_test(refuses_what_does_not_fit),
        cmocka_unit_test(refuses_headers_that_run_past_the_end),
        cmocka_unit_test(messages_are_one_line),
        cmocka_unit_test(comes_back_as_it_was_written),
        cmocka_unit_test(refuses_to_write_what_cannot_be_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
