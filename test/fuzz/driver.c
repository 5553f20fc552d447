/*
 * Runs a fuzz target over the files named on the command line: each as it is,
 * and every beginning of it.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { LARGEST_INPUT = 1 << 20 };

/* The target gets a block that ends with the input, so that a sanitizer sees reads beyond. */
static void run(const uint8_t *data, size_t size)
{
    uint8_t *exact = malloc(size > 0 ? size : 1);
    if (exact == NULL) {
        abort();
    }
    memcpy(exact, data, size);
    (void)LLVMFuzzerTestOneInput(exact, size);
    free(exact);
}

static int run_file(const char *path, uint8_t *data)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        (void)fprintf(stderr, "cannot open %s\n", path);
        return EXIT_FAILURE;
    }
    const size_t size = fread(data, 1, LARGEST_INPUT, file);
    (void)fclose(file);
    const size_t step = size / 500 + 1;
    for (size_t length = 0; length < size; length += step) {
        run(data, length);
    }
    run(data, size);
    return EXIT_SUCCESS;
}

int main(int n_arguments, char **arguments)
{
    int result = n_arguments > 1 ? EXIT_SUCCESS : EXIT_FAILURE;
    uint8_t *data = malloc(LARGEST_INPUT);
    if (data == NULL) {
        return EXIT_FAILURE;
    }
    for (int i = 1; i < n_arguments; i++) {
        if (run_file(arguments[i], data) != EXIT_SUCCESS) {
            result = EXIT_FAILURE;
        }
    }
    free(data);
    return result;
}
