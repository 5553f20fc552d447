/*
 * The pieces of printed values, read from a stream.
 */
#ifndef IPC_FORMAT_SCANNER_H
#define IPC_FORMAT_SCANNER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "base/buffer.h"

struct scanner {
    FILE *stream;
    int ahead[3]; /* characters looked at and not consumed, the next one first */
    int n_ahead;
};

void scanner_begin(struct scanner *scanner, FILE *stream);

/* Gives the character looked at last back to the stream. */
void scanner_end(struct scanner *scanner);

/* The next character that is not white space, without consuming it; EOF at the end. */
int scanner_peek(struct scanner *scanner);

/* Consumes the mark if it comes next, white space before it skipped. */
bool scanner_skip(struct scanner *scanner, char mark);

/*
 * Reads the word up to white space or one of , } ] > ) into the emptied buffer, with a NUL
 * behind it: 0, ERR_CONTENT if there is none or it is longer than any number
 * or name may be, or ERR_MEMORY.
 */
int scanner_word(struct scanner *scanner, struct buffer *word);

/* Reads "..." with the escapes of C, likewise. */
int scanner_text(struct scanner *scanner, struct buffer *text);

/* Reads one character: 'c' with the escapes of C, a decimal code, or itself. */
int scanner_character(struct scanner *scanner, uint8_t *character);

#endif
