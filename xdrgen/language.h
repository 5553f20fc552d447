/*
 * The output languages and the words that they reserve.
 */
#ifndef XDRGEN_LANGUAGE_H
#define XDRGEN_LANGUAGE_H

#include "text.h"

enum language { LANGUAGE_C, LANGUAGE_CXX, LANGUAGE_PYTHON, LANGUAGE_JSON };

/* Whether a word may be a name: not if every version of the language reserves it. */
enum reservation { RESERVED_NOT, RESERVED_LATER, RESERVED_ALWAYS };
enum reservation language_reserves(enum language language, struct text word);

#endif
