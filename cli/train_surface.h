#ifndef CLI_TRAIN_SURFACE_H
#define CLI_TRAIN_SURFACE_H

/// "batten train surface", with the command line of the verb "train".
int train_surface(int argc, char **argv);

#endif
