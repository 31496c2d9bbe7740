#include "test_io_helpers.h"

#include "learn/safetensors.h"

#include <locale.h>
#include <stdio.h>

/// Locales with another decimal separator: a comma or, in the last one, a character of two bytes.
static const char *const LOCALES[] = {"de_DE.UTF-8", "de_DE.utf8",  "fr_FR.UTF-8", "fr_FR.utf8", "nl_NL.UTF-8",
                                      "pt_BR.UTF-8", "ru_RU.UTF-8", "sv_SE.UTF-8", "ps_AF.UTF-8"};

/// Run a check in every listed locale that the system has.
static void in_locales(void (*check)(void))
{
    size_t found = 0;
    for (size_t i = 0; i < sizeof LOCALES / sizeof *LOCALES; i++)
        if (setlocale(LC_ALL, LOCALES[i]) != NULL)
        {
            found++;
            check();
        }
    (void)setlocale(LC_ALL, "C");
    if (found == 0)
    {
        print_message("skipped: the system has no locale with a decimal comma\n");
        skip();
    }
}

static void check_csv(void)
{
    assert_rewritten("x,y\n0.12345678901234566,1.5\n2.5e-7,1e300\n", BAT_CURVE_FORMAT_CSV, NULL,
                     "x,y\n0.12345678901234566,1.5\n2.5e-07,1e+300\n");
    assert_bad("1,5e\n", BAT_CURVE_FORMAT_CSV, NULL, 1, "is not a number");
}

static void check_geojson(void)
{
    assert_rewritten(
        "{\"type\":\"LineString\",\"coordinates\":[[0.12345678901234566,1.5],[2.5e-7,1e300]],\"a\":[1.5,2.5e-7]}",
        BAT_CURVE_FORMAT_GEOJSON, "plane",
        "{\"type\":\"LineString\",\"coordinates\":[[0.12345678901234566,1.5],[2.5e-07,1e+300]],"
        "\"a\":[1.5,2.5e-07]}\n");
    assert_rewritten("{\"type\":\"LineString\",\"coordinates\":[[0.5,1.5],[2.25,3]]}", BAT_CURVE_FORMAT_GEOJSON, NULL,
                     "{\"type\":\"LineString\",\"coordinates\":[[0.5,1.5],[2.25,3]]}\n");
}

static void check_obj(void)
{
    assert_rewritten("v 0.12345678901234566 2.5e-7 1.5\nv 0 0 0\nl 1 2\n", BAT_CURVE_FORMAT_OBJ, NULL,
                     "v 0.12345678901234566 2.5e-07 1.5\nv 0 0 0\nl 1 2\n");
}

static void check_safetensors(void)
{
    static const char header[] = "{\"a\":{\"dtype\":\"U8\",\"shape\":[1.5],\"data_offsets\":[0,0]}}";
    char bytes[8 + sizeof header] = {(char)(sizeof header - 1)};
    (void)strcpy(bytes + 8, header);
    safetensors content;
    bat_error error;
    assert_int_equal(safetensors_parse(bytes, 8 + sizeof header - 1, &content, &error), BAT_BAD_FILE);
    assert_string_equal(error.text, "array 'a' of the header has an impossible shape");
}

static void csv_has_points_in_every_locale(void **state)
{
    (void)state;
    in_locales(check_csv);
}

static void geojson_has_points_in_every_locale(void **state)
{
    (void)state;
    in_locales(check_geojson);
}

static void obj_has_points_in_every_locale(void **state)
{
    (void)state;
    in_locales(check_obj);
}

static void safetensors_are_read_in_every_locale(void **state)
{
    (void)state;
    in_locales(check_safetensors);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(csv_has_points_in_every_locale), cmocka_unit_test(geojson_has_points_in_every_locale),
        cmocka_unit_test(obj_has_points_in_every_locale), cmocka_unit_test(safetensors_are_read_in_every_locale)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
