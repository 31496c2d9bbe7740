"""Write the C source of the module `batten._native` from the public headers.

    python native.py INCLUDE_FOLDER OUTPUT.c

Everything in the headers of `include/batten` becomes callable; a new function or option needs no line here.
"""

import re
import sys
from pathlib import Path

from cffi import FFI

# What the headers do not declare: the C library's allocator, callbacks into Python, and ragged.c.
MORE = """
void *malloc(size_t size);
void free(void *pointer);

typedef struct batten_refined
{
    bat_curve curve;
    bat_curve_refine_report report;
} batten_refined;
bat_status batten_refine(const bat_space *space, const double *points, size_t count, bool closed, const double *channels,
                         size_t channel_count, const unsigned char *corners, const bat_curve_refine_options *options,
                         batten_refined *refined, bat_error *error);
bat_status batten_pose(const bat_motion_spline *spline, double time, bool scalar_last, double *pose, bat_error *error);
bat_status batten_refine_ragged(const bat_curve *all, const int64_t *offsets, size_t count,
                                const bat_curve_refine_options *options, double **points, int64_t *fine_offsets,
                                bat_error *error);
void batten_set_eager(bool eager);
bool batten_report_seldom(void *context, double fraction);
bat_status batten_shell_evaluate(const bat_shell *shell, const int64_t *faces, const double *places, size_t count,
                                 double *points, double *normals, bat_error *error);
size_t batten_set_points(const bat_curve_set *set);
void batten_set_arrays(const bat_curve_set *set, int decimals, double *points, int64_t *offsets, bool *closed,
                       int64_t *polygon, int64_t *feature);

extern "Python"
{
    bool batten_report(void *, double);
    const char *batten_fault(const bat_space *, const double *);
    bat_status batten_project(const bat_space *, const double *, double *);
    double batten_distance(const bat_space *, const double *, const double *);
    bat_status batten_log(const bat_space *, const double *, const double *, double *);
    bat_status batten_exp(const bat_space *, const double *, const double *, double *);
    bat_status batten_transport(const bat_space *, const double *, const double *, const double *, double *);
    bat_status batten_exp_rows(const bat_space *, const double *, const double *, size_t, double *);
    bat_status batten_log_rows(const bat_space *, const double *, const double *, size_t, double *);
    bat_status batten_transport_rows(const bat_space *, const double *, const double *, const double *, size_t, double *);
    double batten_inner(const bat_space *, const double *, const double *, const double *);
}
"""


#: The headers of the research library whose functions the package has, too.
RESEARCH = ["batten/research/curve_analysis.h", "batten/research/chart_picture.h"]


def declarations(folder: Path) -> str:
    """The declarations of all headers, as the parser of cffi takes them."""
    headers = re.findall(r'#include "(batten/[a-z_]+\.h)"', (folder / "batten.h").read_text()) + RESEARCH
    ordered: list[str] = []

    def path(name: str) -> Path:
        return folder.parents[1] / "research" / "include" / name if name in RESEARCH else folder.parent / name

    def visit(name: str) -> None:
        text = path(name).read_text()
        for other in re.findall(r'#include "(batten/[a-z_]+\.h)"', text):
            visit(other)
        if name not in ordered:
            ordered.append(name)

    for name in headers:
        if name != "batten/config.h":
            visit(name)
    text = "\n".join(path(name).read_text() for name in ordered)
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)
    text = re.sub(r"^static inline [^;{]*\{.*?^\}", "", text, flags=re.S | re.M)
    numbers = re.findall(r"^#define (BAT_\w+) \(?(?:\(size_t\))?(\d+)\)?$", text, flags=re.M)
    text = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", "", text, flags=re.M)
    text = re.sub(r"\bBAT_(?:API|C_BEGIN|C_END)\b", "", text)
    for name, value in numbers:
        text = re.sub(rf"\b{name}\b", value, text)
    text += "".join(f"\n#define {name} {value}" for name, value in numbers)
    return text


def main() -> None:
    include, output = Path(sys.argv[1]), Path(sys.argv[2])
    ffi = FFI()
    ffi.cdef(declarations(include / "batten") + MORE)
    ragged = (Path(__file__).parent / "ragged.c").read_text()
    includes = "".join(f"#include <{name}>\n" for name in ["batten/batten.h", *RESEARCH, "stdlib.h"])
    ffi.set_source("batten._native", includes + ragged)
    output.parent.mkdir(parents=True, exist_ok=True)
    ffi.emit_c_code(str(output))


if __name__ == "__main__":
    main()
