#include "solver.h"

#include "ranks.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const petsc_functions *loaded;

/// Load the module by its absolute path: from the program's folder in a build, from that of libraries where it is installed.
static void *load_module(void)
{
    static const char *const folders[] = {".", BATTEN_MODULE_FOLDER};
    char program[PATH_MAX], path[PATH_MAX + sizeof BATTEN_MODULE_FOLDER + 32];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length <= 0)
        return NULL;
    program[length] = '\0';
    *strrchr(program, '/') = '\0';
    void *module = NULL;
    for (size_t k = 0; k < sizeof folders / sizeof *folders && module == NULL; k++)
    {
        (void)snprintf(path, sizeof path, "%s/%s/batten-petsc.so", program, folders[k]);
        module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    }
    return module;
}

const petsc_functions *petsc_load(void)
{
    if (loaded != NULL)
        return loaded;
    void *module = load_module();
    const char *cause = module == NULL ? dlerror() : NULL;
    loaded = module != NULL ? dlsym(module, PETSC_TABLE_NAME) : NULL;
    bat_error error = {.status = loaded == NULL ? BAT_UNSUPPORTED : BAT_OK, .index = BAT_NO_INDEX};
    if (loaded == NULL)
        (void)snprintf(error.text, sizeof error.text, "PETSc cannot be loaded (%s); --solver cholesky needs none",
                       cause != NULL ? cause : "no module for this program");
    if (ranks_agree(NULL, error.status, &error))
        return loaded;
    if (ranks_rank() == 0)
        (void)MPI_Abort(MPI_COMM_WORLD, EXIT_BAD_INPUT);
    // The others wait for their end.
    (void)MPI_Barrier(MPI_COMM_WORLD);
    exit(EXIT_BAD_INPUT);
}

void petsc_end(void)
{
    if (loaded != NULL)
        loaded->end();
}
