/* Runs a fuzzer's target on files, where there is no fuzzer: what it once found stays found. */
#include "stream.h"

#include <stdio.h>

static int replay(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END)) {
        fprintf(stderr, "%s cannot be read\n", path);
        return 1;
    }
    long size = ftell(file);
    uint8_t *data = malloc(size > 0 ? (size_t)size : 1);
    rewind(file);
    size_t read = data ? fread(data, 1, (size_t)size, file) : 0;
    fclose(file);
    LLVMFuzzerTestOneInput(data, read);
    free(data);
    return read == (size_t)size ? 0 : 1;
}

int main(int count, char **arguments) {
    int failed = count < 2;
    for (int i = 1; i < count; i++)
        failed |= replay(arguments[i]);
    printf("%d files\n", count - 1);
    return failed;
}
