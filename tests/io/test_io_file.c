#define _GNU_SOURCE // mkdtemp(), O_TMPFILE

#include "choice_helpers.h"
#include "test_io_helpers.h"

#include "base/atomic_file.h"
#include "base/file_bytes.h"
#include "io/common/file_text.h"

#include "batten/mesh_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/// A new folder for each test, with memory for a path inside.
typedef struct folder
{
    char name[64];
    char path[128];
} folder;

static int make_folder(void **state)
{
    folder *made = calloc(1, sizeof *made);
    (void)strcpy(made->name, "/tmp/batten-test-XXXXXX");
    *state = made;
    return mkdtemp(made->name) != NULL ? 0 : -1;
}

static const char *path_in(folder *in, const char *name)
{
    (void)snprintf(in->path, sizeof in->path, "%s/%s", in->name, name);
    return in->path;
}

/// The number of files in a folder, which are removed if asked for.
static size_t count_files(folder *in, bool and_remove)
{
    size_t count = 0;
    DIR *directory = opendir(in->name);
    for (struct dirent *entry = readdir(directory); entry != NULL; entry = readdir(directory))
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
        {
            char path[512];
            (void)snprintf(path, sizeof path, "%s/%s", in->name, entry->d_name);
            if (and_remove)
                (void)remove(path);
            count++;
        }
    (void)closedir(directory);
    return count;
}

static int remove_folder(void **state)
{
    (void)count_files(*state, true);
    (void)rmdir(((folder *)*state)->name);
    free(*state);
    return 0;
}

static void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
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

static const char ROWS[] = "1,2\n3,4\n";

static bat_status write_rows(const char *path, bat_error *error)
{
    bat_curve_set set = must_read(ROWS, BAT_CURVE_FORMAT_CSV, NULL);
    bat_status status = bat_curve_write(path, &set, NULL, error);
    bat_curve_set_free(&set);
    return status;
}

static void a_file_is_written_and_replaced(void **state)
{
    const char *path = path_in(*state, "curves.csv");
    assert_int_equal(write_rows(path, NULL), BAT_OK);
    assert_content(path, ROWS);
    put(path, "old and longer than what replaces it");
    assert_int_equal(chmod(path, 0640), 0);
    assert_int_equal(write_rows(path, NULL), BAT_OK);
    assert_content(path, ROWS);
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0640);
    assert_int_equal(count_files(*state, false), 1);
}

static void a_new_file_has_the_usual_rights(void **state)
{
    const char *path = path_in(*state, "curves.csv");
    mode_t mask = umask(027);
    assert_int_equal(write_rows(path, NULL), BAT_OK);
    (void)umask(mask);
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0640);
}

static void a_link_is_followed(void **state)
{
    char real[128];
    (void)snprintf(real, sizeof real, "%s", path_in(*state, "real.csv"));
    put(real, "old");
    const char *link = path_in(*state, "link.csv");
    assert_int_equal(symlink("real.csv", link), 0);
    assert_int_equal(write_rows(link, NULL), BAT_OK);
    assert_content(real, ROWS);
    struct stat status;
    assert_int_equal(lstat(link, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
}

static void a_link_that_leads_nowhere_is_refused(void **state)
{
    const char *link = path_in(*state, "link.csv");
    bat_error error = {0};
    assert_int_equal(symlink("missing.csv", link), 0);
    assert_int_equal(write_rows(link, &error), BAT_FILE_ACCESS);
    assert_non_null(strstr(error.text, "leads nowhere"));
    assert_int_equal(unlink(link), 0);
    assert_int_equal(symlink("link.csv", link), 0);
    assert_int_equal(write_rows(link, &error), BAT_FILE_ACCESS);
    assert_int_equal(count_files(*state, false), 1);
}

static void the_owner_is_kept(void **state)
{
    enum
    {
        SOMEBODY = 65534
    };
    const char *path = path_in(*state, "curves.csv");
    put(path, "old");
    if (chown(path, SOMEBODY, SOMEBODY) != 0)
        skip();
    assert_int_equal(chmod(path, 0604), 0);
    assert_int_equal(write_rows(path, NULL), BAT_OK);
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_uid, SOMEBODY);
    assert_int_equal(status.st_gid, SOMEBODY);
    assert_int_equal(status.st_mode & 0777, 0604);
}

static void what_cannot_be_opened_is_told(void **state)
{
    bat_error error = {0};
    assert_int_equal(write_rows(path_in(*state, "missing/curves.csv"), &error), BAT_FILE_ACCESS);
    assert_non_null(strstr(error.text, "No such file"));
    (void)snprintf(((folder *)*state)->path, sizeof((folder *)*state)->path, "%s", ((folder *)*state)->name);
    bat_curve_set set = must_read(ROWS, BAT_CURVE_FORMAT_CSV, NULL);
    assert_int_equal(bat_curve_write(((folder *)*state)->name, &set, NULL, &error), BAT_FILE_ACCESS);
    bat_curve_set_free(&set);
    assert_int_equal(bat_curve_read(path_in(*state, "missing.csv"), NULL, &set, &error), BAT_FILE_ACCESS);
    assert_int_equal(bat_curve_read(((folder *)*state)->name, NULL, &set, &error), BAT_FILE_ACCESS);
    assert_int_equal(count_files(*state, false), 0);
}

/// Write as an unprivileged user in a separate process; its exit status is the bat_status.
static int write_as_nobody(const char *path)
{
    enum
    {
        NOBODY = 65534
    };
    pid_t child = fork();
    if (child == 0)
    {
        if (geteuid() == 0 && setuid(NOBODY) != 0)
            _exit(-1);
        _exit((int)write_rows(path, NULL));
    }
    int outcome = -1;
    (void)waitpid(child, &outcome, 0);
    return WIFEXITED(outcome) ? WEXITSTATUS(outcome) : -1;
}

static void what_is_read_only_is_kept(void **state)
{
    folder *in = *state;
    const char *path = path_in(in, "curves.csv");
    put(path, "old");
    assert_int_equal(chmod(in->name, 0777), 0);
    assert_int_equal(chmod(path, 0444), 0);
    assert_int_equal(write_as_nobody(path), BAT_FILE_ACCESS);
    assert_int_equal(chmod(path, 0666), 0);
    assert_int_equal(chmod(in->name, 0555), 0);
    assert_int_equal(write_as_nobody(path), BAT_FILE_ACCESS);
    assert_int_equal(chmod(in->name, 0777), 0);
    assert_content(path, "old");
    assert_int_equal(count_files(in, false), 1);
    assert_int_equal(write_as_nobody(path), BAT_OK);
    assert_content(path, ROWS);
}

static void a_failure_in_the_middle_keeps_the_old_file(void **state)
{
    const char *path = path_in(*state, "curves.geojson");
    put(path, "old");
    bat_curve_set set = must_read("lon,lat\n1,2\n3,4\n\n5,6\n7,8\n", BAT_CURVE_FORMAT_CSV, NULL);
    bat_error error = {0};
    set.curves[1].count = 1; // no line
    assert_int_equal(bat_curve_write(path, &set, NULL, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "curve 1"));
    bat_curve_set_free(&set);
    assert_content(path, "old");
    assert_int_equal(count_files(*state, false), 1);
}

/// Write more than the limit of file sizes in a separate process; its exit status is the bat_status.
static int write_beyond_limit(const char *path)
{
    pid_t child = fork();
    if (child == 0)
    {
        (void)signal(SIGXFSZ, SIG_IGN);
        const struct rlimit limit = {1 << 16, 1 << 16};
        (void)setrlimit(RLIMIT_FSIZE, &limit);
        atomic_file file;
        bat_status status = atomic_file_begin(path, &file, NULL);
        if (status == BAT_OK)
        {
            for (int i = 0; i < 1 << 15; i++)
                (void)fputs("123456789\n", file.stream);
            status = atomic_file_end(&file, BAT_OK, NULL);
        }
        _exit((int)status);
    }
    int outcome = -1;
    (void)waitpid(child, &outcome, 0);
    return WIFEXITED(outcome) ? WEXITSTATUS(outcome) : -1;
}

static void a_full_disk_keeps_the_old_file(void **state)
{
    const char *path = path_in(*state, "curves.csv");
    put(path, "old");
    assert_int_equal(write_beyond_limit(path), BAT_FILE_ACCESS);
    assert_content(path, "old");
    assert_int_equal(count_files(*state, false), 1);
    assert_int_equal(write_rows("/dev/full", NULL), BAT_FILE_ACCESS);
}

/// Whether the folder's file system supports unnamed files.
static bool has_nameless_files(const folder *in)
{
#ifdef O_TMPFILE
    int descriptor = open(in->name, O_WRONLY | O_TMPFILE, 0600);
    if (descriptor >= 0)
        (void)close(descriptor);
    return descriptor >= 0;
#else
    (void)in;
    return false;
#endif
}

static void a_killed_process_leaves_nothing(void **state)
{
    const char *path = path_in(*state, "curves.csv");
    if (!has_nameless_files(*state))
        skip();
    put(path, "old");
    pid_t child = fork();
    if (child == 0)
    {
        atomic_file file;
        if (atomic_file_begin(path, &file, NULL) == BAT_OK && fputs(ROWS, file.stream) >= 0 && fflush(file.stream) == 0)
            (void)raise(SIGKILL);
        _exit(0);
    }
    int outcome = 0;
    (void)waitpid(child, &outcome, 0);
    assert_true(WIFSIGNALED(outcome));
    assert_content(path, "old");
    assert_int_equal(count_files(*state, false), 1);
}

static void what_is_no_file_is_written_in_place(void **state)
{
    const char *path = path_in(*state, "pipe.csv");
    assert_int_equal(mkfifo(path, 0600), 0);
    int reader = open(path, O_RDONLY | O_NONBLOCK);
    assert_int_equal(write_rows(path, NULL), BAT_OK);
    char text[64] = "";
    assert_int_equal(read(reader, text, sizeof text - 1), (ssize_t)strlen(ROWS));
    assert_string_equal(text, ROWS);
    (void)close(reader);
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    assert_true(S_ISFIFO(status.st_mode));
}

static void a_pipe_can_be_read(void **state)
{
    enum
    {
        COUNT = 100000
    };
    char path[128];
    (void)snprintf(path, sizeof path, "%s", path_in(*state, "pipe"));
    assert_int_equal(mkfifo(path, 0600), 0);
    pid_t child = fork();
    if (child == 0)
    {
        FILE *file = fopen(path, "wb");
        for (int i = 0; i < COUNT; i++)
            (void)fprintf(file, "%d,0.5\n", i);
        (void)fclose(file);
        _exit(0);
    }
    bat_curve_set set = {0};
    bat_status status = bat_curve_read(path, NULL, &set, NULL);
    (void)waitpid(child, NULL, 0);
    assert_int_equal(status, BAT_OK);
    assert_int_equal(set.curves[0].count, COUNT);
    assert_true(set.curves[0].points[2 * (COUNT - 1)] == COUNT - 1);
    bat_curve_set_free(&set);
}

/// A pipe may go on forever, and a device does; a regular file ends.
static void input_without_end_is_refused(void **state)
{
    char path[128], text[4096];
    struct stat about;
    (void)snprintf(path, sizeof path, "%s", path_in(*state, "pipe"));
    assert_int_equal(mkfifo(path, 0600), 0);
    pid_t child = fork();
    if (child == 0)
    {
        (void)signal(SIGPIPE, SIG_DFL);
        int file = open(path, O_WRONLY);
        memset(text, '1', sizeof text);
        while (write(file, text, sizeof text) > 0)
            continue;
        _exit(0);
    }
    text_buffer bytes = {0};
    bat_error error;
    assert_int_equal(file_bytes_read(path, 1000000, &bytes, &error), BAT_FILE_ACCESS);
    assert_non_null(strstr(error.text, "does not end after 1000000 bytes"));
    assert_null(bytes.data);
    (void)waitpid(child, NULL, 0);

    (void)snprintf(path, sizeof path, "%s", path_in(*state, "file"));
    put(path, "0123456789");
    assert_int_equal(file_bytes_read(path, 5, &bytes, &error), BAT_OK);
    assert_int_equal(bytes.size, 10);
    text_free(&bytes);

    static const char *const devices[] = {"/dev/zero", "/dev/full", "/dev/null"};
    for (size_t i = 0; i < sizeof devices / sizeof *devices; i++)
    {
        if (stat(devices[i], &about) != 0 || !S_ISCHR(about.st_mode))
            continue;
        assert_int_equal(file_bytes_read(devices[i], 5, &bytes, &error), BAT_FILE_ACCESS);
        assert_non_null(strstr(error.text, "device"));
    }
}

static void the_ending_tells_the_format(void **state)
{
    (void)state;
    const struct
    {
        const char *path;
        bat_curve_format format;
    } cases[] = {{"a.csv", BAT_CURVE_FORMAT_CSV},
                 {"a.b/c.TXT", BAT_CURVE_FORMAT_CSV},
                 {"a.GeoJSON", BAT_CURVE_FORMAT_GEOJSON},
                 {"x.json", BAT_CURVE_FORMAT_GEOJSON},
                 {"/m/n.Obj", BAT_CURVE_FORMAT_OBJ},
                 {"-", BAT_CURVE_FORMAT_AUTO},
                 {"a.csv/b", BAT_CURVE_FORMAT_AUTO},
                 {"a.csv.GZ", BAT_CURVE_FORMAT_CSV},
                 {"", BAT_CURVE_FORMAT_AUTO},
                 {"a.gpkg", BAT_CURVE_FORMAT_GPKG},
                 {"a.gz", BAT_CURVE_FORMAT_GDAL},
                 {"/vsizip/a", BAT_CURVE_FORMAT_GDAL},
                 {"a.shp.zip", BAT_CURVE_FORMAT_GDAL},
                 {"/vsizip/a.zip/b.shp", BAT_CURVE_FORMAT_SHP}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(choice_value_of_path(&bat_curve_format_family, cases[i].path), cases[i].format);
    const bat_choice *format;
    bat_error error;
    assert_int_equal(bat_choice_find(&bat_curve_format_family, "obj", &format, &error), BAT_OK);
    assert_int_equal(format->value, BAT_CURVE_FORMAT_OBJ);
    assert_int_equal(bat_choice_find(&bat_curve_format_family, "dwg", &format, &error), BAT_INVALID_ARGUMENT);
}

static void a_format_that_nothing_tells_is_asked_for(void **state)
{
    const char *path = path_in(*state, "curves");
    assert_int_equal(write_rows(path, NULL), BAT_OK); // the format of the input
    double *points = calloc(2, sizeof *points);
    bat_space plane = bat_euclidean(2);
    bat_curve curve = {.space = &plane, .points = points, .count = 1};
    bat_curve_set set;
    bat_error error;
    assert_int_equal(bat_curve_set_single(&curve, &set, &error), BAT_OK);
    assert_int_equal(bat_curve_write(path, &set, NULL, &error), BAT_INVALID_ARGUMENT);
    bat_curve_write_options options = bat_curve_write_defaults();
    options.format = BAT_CURVE_FORMAT_CSV;
    assert_int_equal(bat_curve_write(path, &set, &options, &error), BAT_OK);
    assert_content(path, "0,0\n");
    bat_curve_set_free(&set);
    bat_curve_set_free(&set);
}

/// Reading and writing of an ending that no format has fails with a text that lists the known ones.
static void unknown_endings_are_refused(void **state)
{
    const struct
    {
        const char *name, *words;
    } cases[] = {{"a.doc", "'.doc'; there are .csv, "}, {"b.CSV.bz2", "'.bz2', of compressed files"}, {".c.x1", "'.x1'"}};
    bat_curve_set set = {0};
    bat_error error;
    bat_curve_read_options reading = bat_curve_read_defaults();
    bat_curve_write_options writing = bat_curve_write_defaults();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        const char *path = path_in(*state, cases[i].name);
        const bat_choice *format;
        assert_int_equal(bat_choice_of_path(&bat_curve_format_family, path, true, &format, &error), BAT_INVALID_ARGUMENT);
        assert_null(format);
        assert_int_equal(write_rows(path, &error), BAT_INVALID_ARGUMENT);
        assert_non_null(strstr(error.text, cases[i].words));
        assert_non_null(strstr(error_words(&error), ".zip; write.format names one"));
        assert_int_equal(access(path, F_OK), -1);
        assert_int_equal(bat_curve_read(path, NULL, &set, &error), BAT_INVALID_ARGUMENT);
        assert_non_null(strstr(error.text, cases[i].words));
        assert_string_equal(error.remedy, "read.format");

        bat_curve_set rows = {0};
        assert_int_equal(bat_curve_read_memory(ROWS, strlen(ROWS), NULL, &rows, NULL), BAT_OK);
        writing.format = reading.format = BAT_CURVE_FORMAT_CSV;
        assert_int_equal(bat_curve_write(path, &rows, &writing, NULL), BAT_OK);
        assert_int_equal(bat_curve_read(path, &reading, &set, NULL), BAT_OK);
        bat_curve_set_free(&rows);
        bat_curve_set_free(&set);
        assert_int_equal(unlink(path), 0);
    }
    const char *const plain[] = {"noending", "v1.2", "dir.d/name", ".hidden", "name.", "-", "/dev/stdin"};
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
    {
        const bat_choice *format;
        assert_int_equal(bat_choice_of_path(&bat_curve_format_family, plain[i], true, &format, &error), BAT_OK);
        assert_null(format);
    }
}

static void options_out_of_range_are_refused(void **state)
{
    (void)state;
    bat_curve_set set = {0};
    bat_curve_read_options options = bat_curve_read_defaults();
    options.closed = 2;
    assert_int_equal(bat_curve_read_memory(ROWS, strlen(ROWS), &options, &set, NULL), BAT_INVALID_ARGUMENT);
    options = bat_curve_read_defaults();
    options.threads = -1;
    assert_int_equal(bat_curve_read_memory(ROWS, strlen(ROWS), &options, &set, NULL), BAT_INVALID_ARGUMENT);
    options = bat_curve_read_defaults();
    options.format = (bat_curve_format)77;
    assert_int_equal(bat_curve_read_memory(ROWS, strlen(ROWS), &options, &set, NULL), BAT_INVALID_ARGUMENT);
}

static void utf16_is_refused(void **state)
{
    static const char LITTLE[] = "\xFF\xFEx\0,\0y\0\n\0001\0", BIG[] = "\xFE\xFF\0x\0,\0y\0\n\0001";
    (void)state;
    bat_curve_set set = {0};
    bat_mesh mesh = {0};
    bat_error error;
    assert_int_equal(bat_curve_read_memory(LITTLE, sizeof LITTLE - 1, NULL, &set, &error), BAT_BAD_FILE);
    assert_int_equal(error.line, 1);
    assert_non_null(strstr(error.text, "UTF-16"));
    assert_int_equal(bat_curve_read_memory(BIG, sizeof BIG - 1, NULL, &set, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "UTF-16"));
    assert_int_equal(bat_mesh_read_memory(BIG, sizeof BIG - 1, NULL, &mesh, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "UTF-16"));
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, make_folder, remove_folder)

int main(void)
{
    const struct CMUnitTest tests[] = {IN_FOLDER(a_file_is_written_and_replaced),
                                       IN_FOLDER(a_new_file_has_the_usual_rights),
                                       IN_FOLDER(a_link_is_followed),
                                       IN_FOLDER(a_link_that_leads_nowhere_is_refused),
                                       IN_FOLDER(the_owner_is_kept),
                                       IN_FOLDER(what_cannot_be_opened_is_told),
                                       IN_FOLDER(what_is_read_only_is_kept),
                                       IN_FOLDER(a_failure_in_the_middle_keeps_the_old_file),
                                       IN_FOLDER(a_full_disk_keeps_the_old_file),
                                       IN_FOLDER(a_killed_process_leaves_nothing),
                                       IN_FOLDER(what_is_no_file_is_written_in_place),
                                       IN_FOLDER(a_pipe_can_be_read),
                                       IN_FOLDER(input_without_end_is_refused),
                                       IN_FOLDER(a_format_that_nothing_tells_is_asked_for),
                                       IN_FOLDER(unknown_endings_are_refused),
                                       cmocka_unit_test(the_ending_tells_the_format),
                                       cmocka_unit_test(options_out_of_range_are_refused),
                                       cmocka_unit_test(utf16_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
