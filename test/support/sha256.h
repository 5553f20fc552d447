/*
 * SHA-256, for vectors that are too large to be written out.
 */
#ifndef TEST_SUPPORT_SHA256_H
#define TEST_SUPPORT_SHA256_H

#include <stddef.h>
#include <stdint.h>

/* The digest in hexadecimal digits, NUL-terminated. */
void sha256_hex(const uint8_t *bytes, size_t length, char digest[65]);

#endif
