#define _GNU_SOURCE // mkdtemp()

#include "folder_helpers.h"

#include "base/atomic_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/// As the library's writers do it.
static void put_whole(const char *path, const char *text)
{
    atomic_file file;
    assert_int_equal(atomic_file_begin(path, &file, NULL), BAT_OK);
    assert_true(fputs(text, file.stream) >= 0);
    assert_int_equal(atomic_file_end(&file, BAT_OK, NULL), BAT_OK);
}

static void assert_content(const char *path, const char *expected)
{
    char text[256] = "";
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    (void)fclose(file);
    assert_string_equal(text, expected);
}

static bat_outputs *new_outputs(void)
{
    bat_outputs *outputs;
    assert_int_equal(bat_outputs_make(&outputs, NULL), BAT_OK);
    return outputs;
}

static const char *must_add(bat_outputs *outputs, const char *path)
{
    const char *write_to;
    assert_int_equal(bat_outputs_add(outputs, path, &write_to, NULL), BAT_OK);
    return write_to;
}

static mode_t rights_of(const char *path)
{
    struct stat about;
    assert_int_equal(stat(path, &about), 0);
    return about.st_mode & 0777;
}

static void files_appear_at_the_commit(void **state)
{
    (void)state;
    put("old.csv", "old");
    assert_int_equal(chmod("old.csv", 0604), 0);
    bat_outputs *outputs = new_outputs();
    const char *first = must_add(outputs, "old.csv"), *second = must_add(outputs, "new.tar.png");
    assert_string_equal(strrchr(first, '.'), ".csv");
    assert_string_equal(strrchr(second, '.'), ".png");
    put_whole(first, "one");
    put(second, "two");
    assert_content("old.csv", "old");
    assert_int_equal(access("new.tar.png", F_OK), -1);
    assert_int_equal(bat_outputs_commit(outputs, NULL), BAT_OK);
    assert_content("old.csv", "one");
    assert_content("new.tar.png", "two");
    assert_int_equal(rights_of("old.csv"), 0604);
    put("plain", "");
    assert_int_equal(rights_of("new.tar.png"), rights_of("plain"));
    bat_outputs_free(outputs);
    assert_int_equal(count_files(false), 3);
}

static void without_a_commit_nothing_changes(void **state)
{
    (void)state;
    put("old.csv", "old");
    bat_outputs *outputs = new_outputs();
    put_whole(must_add(outputs, "old.csv"), "one");
    put_whole(must_add(outputs, "new.csv"), "two");
    assert_int_equal(count_files(false), 1); // what is written has no name
    bat_outputs_remove(outputs);
    assert_int_equal(count_files(false), 1);
    bat_outputs_free(outputs);
    assert_content("old.csv", "old");
    assert_int_equal(count_files(false), 1);
}

static void a_shapefile_brings_its_companions(void **state)
{
    (void)state;
    put("a.shp", "old");
    put("a.dbf", "old");
    put("a.qix", "old");
    bat_outputs *outputs = new_outputs();
    char companion[256];
    const char *shapes = must_add(outputs, "a.shp");
    (void)snprintf(companion, sizeof companion, "%s", shapes);
    put(shapes, "new");
    for (size_t i = 0; i < 2; i++)
    {
        memcpy(companion + strlen(companion) - 4, i == 0 ? ".shx" : ".dbf", 4);
        put(companion, "new");
    }
    assert_content("a.dbf", "old");
    assert_int_equal(bat_outputs_commit(outputs, NULL), BAT_OK);
    bat_outputs_free(outputs);
    assert_content("a.shp", "new");
    assert_content("a.shx", "new");
    assert_content("a.dbf", "new");
    assert_int_equal(access("a.qix", F_OK), -1); // it described the old shapes
    assert_int_equal(count_files(false), 3);
    outputs = new_outputs();
    shapes = must_add(outputs, "a.shp");
    put(shapes, "newer");
    assert_int_equal(bat_outputs_add(outputs, "a.dbf", &shapes, NULL), BAT_INVALID_ARGUMENT);
    bat_outputs_free(outputs);
    assert_content("a.shp", "new");
    assert_int_equal(count_files(false), 3);
}

static void a_failed_rename_takes_the_others_back(void **state)
{
    (void)state;
    put("old.csv", "old");
    bat_error error;
    bat_outputs *outputs = new_outputs();
    put_whole(must_add(outputs, "old.csv"), "one");
    put_whole(must_add(outputs, "new.csv"), "two");
    put_whole(must_add(outputs, "blocked.csv"), "three");
    // A folder cannot be replaced by a file.
    assert_int_equal(mkdir("blocked.csv", 0777), 0);
    assert_int_equal(bat_outputs_commit(outputs, &error), BAT_FILE_ACCESS);
    assert_int_equal(error.index, 2);
    bat_outputs_free(outputs);
    assert_content("old.csv", "old");
    assert_int_equal(count_files(false), 2);
}

static void a_file_that_was_not_written_is_a_failure(void **state)
{
    (void)state;
    bat_error error;
    bat_outputs *outputs = new_outputs();
    put_whole(must_add(outputs, "one.csv"), "one");
    (void)must_add(outputs, "two.csv");
    assert_int_equal(bat_outputs_commit(outputs, &error), BAT_FILE_ACCESS);
    assert_int_equal(error.index, 1);
    assert_non_null(strstr(error.text, "nothing was written"));
    bat_outputs_free(outputs);
    assert_int_equal(count_files(false), 0);
}

static void refuse(bat_outputs *outputs, const char *path, bat_status status)
{
    const char *write_to;
    bat_error error;
    assert_int_equal(bat_outputs_add(outputs, path, &write_to, &error), status);
    assert_int_equal(error.status, status);
}

static void one_file_is_taken_once(void **state)
{
    (void)state;
    put("old.csv", "old");
    assert_int_equal(link("old.csv", "twin.csv"), 0);
    assert_int_equal(symlink("old.csv", "link.csv"), 0);
    assert_int_equal(symlink("nowhere", "dangling.csv"), 0);
    assert_int_equal(mkdir("inner", 0777), 0);
    bat_outputs *outputs = new_outputs();
    (void)must_add(outputs, "old.csv");
    (void)must_add(outputs, "new.csv");
    refuse(outputs, "old.csv", BAT_INVALID_ARGUMENT);
    refuse(outputs, "./old.csv", BAT_INVALID_ARGUMENT);
    refuse(outputs, "twin.csv", BAT_INVALID_ARGUMENT);
    refuse(outputs, "link.csv", BAT_INVALID_ARGUMENT);
    refuse(outputs, "inner/../new.csv", BAT_INVALID_ARGUMENT);
    refuse(outputs, "-", BAT_INVALID_ARGUMENT);
    refuse(outputs, "dangling.csv", BAT_FILE_ACCESS);
    refuse(outputs, "inner", BAT_FILE_ACCESS);
    refuse(outputs, "no/such.csv", BAT_FILE_ACCESS);
    (void)must_add(outputs, "inner/new.csv");
    bat_outputs_free(outputs);
    bat_outputs_free(NULL);
}

static void what_is_no_file_is_written_directly(void **state)
{
    (void)state;
    bat_outputs *outputs = new_outputs();
    assert_string_equal(must_add(outputs, "/dev/null"), "/dev/null");
    assert_string_equal(must_add(outputs, "/dev/null"), "/dev/null");
    put_whole("/dev/null", "one");
    put_whole(must_add(outputs, "two.csv"), "two");
    assert_int_equal(bat_outputs_commit(outputs, NULL), BAT_OK);
    bat_outputs_free(outputs);
    struct stat about;
    assert_int_equal(stat("/dev/null", &about), 0);
    assert_true(S_ISCHR(about.st_mode));
    assert_content("two.csv", "two");
}

static void links_are_followed(void **state)
{
    (void)state;
    put("old.csv", "old");
    assert_int_equal(symlink("old.csv", "link.csv"), 0);
    bat_outputs *outputs = new_outputs();
    put_whole(must_add(outputs, "link.csv"), "one");
    assert_int_equal(bat_outputs_commit(outputs, NULL), BAT_OK);
    bat_outputs_free(outputs);
    struct stat about;
    assert_int_equal(lstat("link.csv", &about), 0);
    assert_true(S_ISLNK(about.st_mode));
    assert_content("old.csv", "one");
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, enter_folder, leave_folder)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(files_appear_at_the_commit),
        IN_FOLDER(without_a_commit_nothing_changes),
        IN_FOLDER(a_shapefile_brings_its_companions),
        IN_FOLDER(a_failed_rename_takes_the_others_back),
        IN_FOLDER(a_file_that_was_not_written_is_a_failure),
        IN_FOLDER(one_file_is_taken_once),
        IN_FOLDER(what_is_no_file_is_written_directly),
        IN_FOLDER(links_are_followed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
