#include "check.h"

#include "base/json_scan.h"

#include <jansson.h>
#include <string.h>

/// Against Jansson, the parser that the library uses.
static void grammar_agrees_with_jansson(void **state)
{
    (void)state;
    static const char *const texts[] = {"[]",
                                        "{}",
                                        " [ ] ",
                                        "{\"a\":1}",
                                        "{\"a\":[1,-2.5e+3,0.5,{\"b\":null}],\"c\":true,\"d\":\"\\u00e9\\n\\\"x\"}",
                                        "[\"\\ud83d\\ude00\"]",
                                        "[[[[]],[]],{}]",
                                        "[0,-0,10,1E5]",
                                        "",
                                        "1",
                                        "\"a\"",
                                        "[",
                                        "]",
                                        "[}",
                                        "{]",
                                        "[1,]",
                                        "[,1]",
                                        "[1 2]",
                                        "[01]",
                                        "[1.]",
                                        "[.5]",
                                        "[-]",
                                        "[1e]",
                                        "[+1]",
                                        "[tru]",
                                        "[nulls]",
                                        "{\"a\"}",
                                        "{\"a\":}",
                                        "{\"a\":1,}",
                                        "{a:1}",
                                        "{1:1}",
                                        "{\"a\":1 \"b\":2}",
                                        "[\"a]",
                                        "[\"\\x\"]",
                                        "[\"\\u12g4\"]",
                                        "[\"\\u12\"]",
                                        "[\"\\ud83d\"]",
                                        "[\"\\ude00\"]",
                                        "[\"\\ud83d\\u0041\"]",
                                        "[\"a\nb\"]",
                                        "[\"a\tb\"]",
                                        "[] []",
                                        "[]]",
                                        "{}x"};
    size_t valid = 0;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        json_t *tree = json_loads(texts[i], 0, NULL);
        if (json_scan_valid(texts[i], strlen(texts[i])) != (tree != NULL))
            fail_msg("%s: Jansson disagrees", texts[i]);
        valid += tree != NULL;
        json_decref(tree);
    }
    assert_int_equal(valid, 8);
    static const char deep[] = "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[";
    char deeper[4200] = "";
    for (size_t i = 0; i < 40; i++)
        (void)strcat(deeper, deep);
    assert_false(json_scan_valid(deeper, strlen(deeper)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(grammar_agrees_with_jansson)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
