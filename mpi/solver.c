#include "solver.h"

#include "ranks.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

static const petsc_functions *loaded;

const petsc_functions *petsc_load(void)
{
    if (loaded != NULL)
        return loaded;
    // The program's RUNPATH leads to it.
    void *module = dlopen("batten-petsc.so", RTLD_NOW | RTLD_LOCAL);
    loaded = module != NULL ? dlsym(module, PETSC_TABLE_NAME) : NULL;
    bat_error error = {.status = loaded == NULL ? BAT_UNSUPPORTED : BAT_OK, .index = BAT_NO_INDEX};
    if (loaded == NULL)
        (void)snprintf(error.text, sizeof error.text, "PETSc cannot be loaded (%s); --solver cholesky needs none",
                       dlerror());
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
