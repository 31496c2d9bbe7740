#include "verb.h"

#include "report.h"

#include <stdlib.h>

const option_spec JSON_OPTION[] = {
    {"json", NULL, RESULT, COMMON, "print one JSON object", FLAG(verb_call, json)},
    END_OF_OPTIONS,
};
const option_spec OUTPUT_OPTION[] = {
    {"output", "OUT", RESULT, COMMON | IS_WRITTEN, "write the result to OUT (- for standard output)", NO_FIELD},
    END_OF_OPTIONS,
};
const option_spec REPORT_OPTIONS[] = {
    {"json", NULL, RESULT, COMMON, "print the report as one JSON object", FLAG(verb_call, json)},
    {"quiet", NULL, RESULT, COMMON, "print no report", FLAG(verb_call, silent)},
    END_OF_OPTIONS,
};
const option_spec THREADS_OPTION[] = {
    {"threads", "N", CALL, 0, "default: all; the result does not depend on it", WHOLE(verb_call, threads, 1, MAX_THREADS)},
    END_OF_OPTIONS,
};
const option_spec MANY_OPTIONS[] = {
    {"jobs", "N", CALL, 0, "of several IN: so many at a time, which share the threads; default 1", NO_FIELD},
    {"in-place", NULL, CALL, 0, "of several IN: outputs may replace inputs", NO_FIELD},
    END_OF_OPTIONS,
};

/// Find the outputs. False after a message.
static bool choose_outputs(const verb *what, verb_call *call)
{
    size_t given = 0, known = 0;
    const option_spec *option;
    for (size_t i = 0; (option = option_at(what, i, NULL)) != NULL; i++)
        if ((option->marks & (IS_WRITTEN | IS_DRAWN)) != 0)
        {
            known++;
            given += argument(call->given, option->name) != NULL;
        }
    call->output = argument(call->given, "output");
    call->picture = argument(call->given, "picture");
    if (what->prints_result && given == 0 && !call->json)
        call->output = "-";
    bool piped = is_standard_output(call->output);
    call->quiet = call->silent || piped;
    if (call->json && call->silent)
        (void)usage_error(call->given, "--json and --quiet exclude each other");
    else if (call->json && piped)
        (void)usage_error(call->given, "--json and -o - both need standard output");
    else if (known > 0 && given == 0 && call->silent && !what->prints_result)
        (void)usage_error(call->given, "there is no output: give -o OUT, or do without --quiet");
    else
        return true;
    return false;
}

/// Make and write the result, and report.
static int carry_out(const verb *what, verb_call *call)
{
    int code = what->make(call);
    if (code == EXIT_DONE && what->write != NULL && output_path(&call->files, "output") != NULL)
        code = what->write(call, output_path(&call->files, "output"));
    code = outputs_close(&call->files, code);
    if (code == EXIT_DONE && what->write != NULL && is_standard_output(call->output))
        code = what->write(call, "-");
    return code == EXIT_DONE && what->report != NULL ? what->report(call) : code;
}

/// Run a verb for one input.
static int run(const arguments *given)
{
    const verb *what = given->verb;
    verb_call *call = calloc(1, what->job_size);
    if (call == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    call->given = given;
    call->input = given->positional_count > 0 ? given->positional[0] : NULL;
    if (what->begin != NULL)
        what->begin(call);
    int code = EXIT_BAD_USAGE;
    if (arguments_store(given, call) && choose_outputs(what, call) && (what->check == NULL || what->check(call)))
        code = outputs_open(given, &call->files);
    if (code == EXIT_DONE)
        code = carry_out(what, call);
    if (what->end != NULL)
        what->end(call);
    free(call);
    return code;
}

int verb_run(const verb *what, int argc, char **argv)
{
    arguments given;
    int code;
    if (!arguments_read(what, argc, argv, &given, &code))
        return code;
    return what->formats != NULL && many_wanted(&given) ? many_run(&given, run) : run(&given);
}
