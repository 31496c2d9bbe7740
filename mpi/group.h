#ifndef MPI_GROUP_H
#define MPI_GROUP_H

#include "batten/base.h"
#include "batten/research/distributed.h"

/// All ranks as a group of the library. A wait for others leaves the processor to them after some time.
const bat_group *ranks_group(void);

#endif
