/*
 * The output languages and the words that they reserve.
 *
 * Python's words are of no concern here: its emitter writes other names instead.
 */
#include "language.h"

#include <string.h>

/* C89 without the words of XDR, which cannot be names; true and false are macros of the header. */
static const char *const words_c[] = {
    "auto",   "break",  "case",   "const", "continue", "default",  "do",     "else",  "extern",
    "false",  "for",    "goto",   "if",    "long",     "register", "return", "short", "signed",
    "sizeof", "static", "switch", "true",  "union",    "volatile", "while",  NULL};

static const char *const words_c_later[] = {
    "_Alignas", "_Alignof",      "_Atomic",      "_Bool",          "_Complex",
    "_Generic", "_Imaginary",    "_Noreturn",    "_Static_assert", "_Thread_local",
    "alignas",  "alignof",       "constexpr",    "inline",         "nullptr",
    "restrict", "static_assert", "thread_local", "typeof",         "typeof_unqual",
    NULL};

static const char *const words_cxx[] = {
    "and",        "and_eq",   "asm",       "auto",   "bitand",   "bitor",
    "break",      "case",     "catch",     "class",  "compl",    "const",
    "const_cast", "continue", "default",   "delete", "do",       "dynamic_cast",
    "else",       "explicit", "export",    "extern", "false",    "for",
    "friend",     "goto",     "if",        "inline", "long",     "mutable",
    "namespace",  "new",      "not",       "not_eq", "operator", "or",
    "or_eq",      "private",  "protected", "public", "register", "reinterpret_cast",
    "return",     "short",    "signed",    "sizeof", "static",   "static_cast",
    "switch",     "template", "this",      "throw",  "true",     "try",
    "typeid",     "typename", "union",     "using",  "virtual",  "volatile",
    "wchar_t",    "while",    "xor",       "xor_eq", NULL};

static const char *const words_cxx_later[] = {
    "alignas",  "alignof",  "char16_t",      "char32_t",     "char8_t",   "co_await", "co_return",
    "co_yield", "concept",  "consteval",     "constexpr",    "constinit", "decltype", "noexcept",
    "nullptr",  "requires", "static_assert", "thread_local", NULL};

static bool is_among(const char *const *words, struct text word)
{
    for (; *words != NULL; words++) {
        if (text_equal(word, text_of(*words))) {
            return true;
        }
    }
    return false;
}

enum reservation language_reserves(enum language language, struct text word)
{
    if (language != LANGUAGE_C && language != LANGUAGE_CXX) {
        return RESERVED_NOT;
    }
    const bool cxx = language == LANGUAGE_CXX;
    if (is_among(cxx ? words_cxx : words_c, word)) {
        return RESERVED_ALWAYS;
    }
    return is_among(cxx ? words_cxx_later : words_c_later, word) ? RESERVED_LATER : RESERVED_NOT;
}
