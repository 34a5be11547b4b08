/* Structs that may grow. A caller's begins with the size that it had in the version that the caller was compiled with: a member
 * that it lacks has its default, and one that we lack must be 0.
 *
 * Sizes tell versions apart if what a version adds to a struct begins where the struct ended, padding included, and leaves no
 * padding of its own. tests/install/test_abi.py watches over that. */
#include "base.h"

#include <string.h>

enum { LARGEST = 4096 }; /* no struct is larger: such a size was never set */

static size_t size_of(const void *given) {
    size_t size;
    memcpy(&size, given, sizeof size);
    return size;
}

skinslide_status ss_check_size(const void *given, const char *name, skinslide_error *error) {
    size_t size = size_of(given);
    if (size > sizeof size && size <= LARGEST)
        return SKINSLIDE_OK;
    return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "%s: its size is %zu; start from its default", name, size);
}

skinslide_status ss_take(const void *given, const char *name, void *own, size_t own_size, skinslide_error *error) {
    skinslide_status status = given ? ss_check_size(given, name, error) : SKINSLIDE_OK;
    if (status || !given)
        return status;
    size_t size = size_of(given);
    for (size_t i = own_size; i < size; i++)
        if (((const unsigned char *)given)[i] != 0)
            return ss_fail(error, SKINSLIDE_UNSUPPORTED, "%s: it has something that version %s does not know", name,
                           SKINSLIDE_VERSION_TEXT);
    memcpy(own, given, size < own_size ? size : own_size);
    memcpy(own, &own_size, sizeof own_size);
    return SKINSLIDE_OK;
}

skinslide_status ss_take_all(const void *given, int64_t count, const char *name, void *own, size_t own_size,
                             const void *standard, skinslide_error *error) {
    skinslide_status status = SKINSLIDE_OK;
    for (int64_t i = 0; i < count && !status; i++) {
        const void *element = (const char *)given + (size_t)i * size_of(given);
        void *taken = (char *)own + (size_t)i * own_size;
        if (size_of(element) != size_of(given))
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "%s: number %lld has size %zu, the first has %zu", name, (long long)i,
                           size_of(element), size_of(given));
        memcpy(taken, standard, own_size);
        status = ss_take(element, name, taken, own_size, error);
    }
    return status;
}

void ss_give(const void *own, size_t own_size, void *given) {
    size_t size = size_of(given), known = size < own_size ? size : own_size;
    memcpy((char *)given + sizeof size, (const char *)own + sizeof size, known - sizeof size);
    memset((char *)given + known, 0, size - known);
}

void ss_give_all(const void *own, int64_t count, size_t own_size, void *given) {
    for (int64_t i = 0; i < count; i++) {
        size_t size = size_of(given);
        void *element = (char *)given + (size_t)i * size;
        memcpy(element, &size, sizeof size);
        ss_give((const char *)own + (size_t)i * own_size, own_size, element);
    }
}
