#ifndef MPI_VERBS_H
#define MPI_VERBS_H

/// Every verb takes its own command line, argv[0] being its name, and returns the program's exit code. All ranks call it
/// with the same words.
int verb_surface(int argc, char **argv);
int verb_train_together(int argc, char **argv);

#endif
