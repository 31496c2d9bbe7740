#ifndef CLI_VERBS_H
#define CLI_VERBS_H

/// Every verb takes its own command line, argv[0] being its name, and returns the program's exit code.
int verb_analyze(int argc, char **argv);
int verb_curve(int argc, char **argv);
int verb_decimate(int argc, char **argv);
int verb_list(int argc, char **argv);
int verb_measure(int argc, char **argv);
int verb_mesh(int argc, char **argv);
int verb_motion(int argc, char **argv);
int verb_reproduce(int argc, char **argv);
int verb_shape(int argc, char **argv);
int verb_surface(int argc, char **argv);
int verb_train(int argc, char **argv);

#endif
