#ifndef CLI_TRAIN_MESH_H
#define CLI_TRAIN_MESH_H

/// "batten train mesh", with the command line of the verb "train".
int train_mesh(int argc, char **argv);

#endif
