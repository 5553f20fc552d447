/*
 * The IPC format of a declaration.
 *
 * What stands for other types depends on the output: a macro, a variable, or
 * their own formats.
 */
#ifndef XDRGEN_FORMAT_H
#define XDRGEN_FORMAT_H

#include "output.h"
#include "tree.h"

/* Writes what stands in a format for a type that is known by name. */
typedef void format_name_writer(struct output *output, const struct type *type);

void format_write(struct output *output, const struct declaration *declaration,
                  format_name_writer *write_name);

/* Gives each definition its expansion: its format with the formats of other types in their places.
 * Types that are defined elsewhere remain names, which IPC knows if somebody has defined a format
 * of that name.  Formats longer than LIMIT_FORMAT_TEXT, which IPC would refuse, remain NULL. */
void format_expand_all(struct tree *tree);

#endif
