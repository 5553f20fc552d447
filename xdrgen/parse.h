/*
 * From an input in memory to a tree.
 */
#ifndef XDRGEN_PARSE_H
#define XDRGEN_PARSE_H

#include "diagnostics.h"
#include "scan.h"
#include "source.h"
#include "tree.h"

/* What the grammar's actions work on. */
struct parse {
    struct scan scan;
    struct tree *tree;
    struct diagnostics *diagnostics;
};

/* Fills an empty tree, whose names are pieces of the source.  Errors are only collected. */
void parse_source(struct source *source, struct tree *tree, struct diagnostics *diagnostics);

/* For the grammar: says which tokens were expected in place of the one at hand, which are given by
 * the grammar's names; none if there were too many. */
void parse_report_unexpected(struct parse *parse, const struct place *place, const char *found,
                             const char *const *expected, int n_expected);

/* For the grammar: the structures are nested too deeply for the parser. */
void parse_report_depth(struct parse *parse, const struct place *place);

/* For the grammar: a structure is complete. */
struct type parse_record(struct parse *parse, struct record *record, const struct place *place);

#endif
