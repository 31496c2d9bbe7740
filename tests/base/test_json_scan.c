#include "check.h"

#include "base/json_scan.h"

#include <jansson.h>
#include <string.h>

/// Against Jansson, the parser that the library uses.
static void arrays_of_numbers_agree_with_jansson(void **state)
{
    (void)state;
    static const char *const texts[] = {"[0]",
                                        " [ 1 , 2 ] ",
                                        "[[1,-2.5e+3],[0.5]]",
                                        "[0,-0,10,1E5]",
                                        "[[[0e-0]],[[12.50]]]",
                                        "[[],[1]]",
                                        "",
                                        "1",
                                        "[",
                                        "]",
                                        "[}",
                                        "[1,]",
                                        "[,1]",
                                        "[1 2]",
                                        "[01]",
                                        "[1.]",
                                        "[.5]",
                                        "[-]",
                                        "[1e]",
                                        "[+1]",
                                        "[[1]",
                                        "[tru]"};
    size_t valid = 0;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        json_scanner scan = {texts[i], texts[i] + strlen(texts[i])};
        json_t *tree = json_loads(texts[i], 0, NULL);
        bool taken = json_scan_numbers(&scan, 3);
        json_scan_blanks(&scan);
        if ((taken && scan.at == scan.end) != (tree != NULL))
            fail_msg("%s: Jansson disagrees", texts[i]);
        valid += tree != NULL;
        json_decref(tree);
    }
    assert_int_equal(valid, 6);
}

static void other_arrays_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {"[true]", "[null]", "[\"a\"]", "[{}]", "[1,{\"a\":1}]", "[[[[1]]]]"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        json_scanner scan = {texts[i], texts[i] + strlen(texts[i])};
        assert_false(json_scan_numbers(&scan, 3));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(arrays_of_numbers_agree_with_jansson),
                                       cmocka_unit_test(other_arrays_are_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
