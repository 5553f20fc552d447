/*
 * The rules that the grammar cannot express: names, dimensions, sizes of arrays.
 */
#ifndef XDRGEN_CHECK_H
#define XDRGEN_CHECK_H

#include "diagnostics.h"
#include "language.h"
#include "tree.h"

/* Resolves the names of types in a tree and collects what is wrong for an output language.  After
 * syntax errors (which the diagnostics already count) it does not complain of missing names. */
void check_tree(struct tree *tree, enum language language, struct diagnostics *diagnostics);

#endif
