// Preloaded into the tool, lets one call fail, or ends the process there. Counts all of them, so that the call can be chosen.
//
//     CHAOS_FOLDER   calls on files below it count, and on no others
//     CHAOS_STRIKE   "CALL N VALUE": the Nth CALL, from 1, fails with errno VALUE; below 0, the process gets the signal -VALUE
//     CHAOS_COUNTS   a file that is given how many calls of each kind there were, "struck 1" where one failed, and the most
//                    memory that there was, in kB of addresses
//
// CALL: open, write, sync, rename, close, mkdir; "ours", an allocation that skinslide's libraries ask for, or those that they
// compute with; "any", an allocation of anybody once skinslide has computed.
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <new>
#include <sys/stat.h>
#include <unistd.h>

extern "C" {
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *memory);
}

namespace {

enum Call { Open, Write, Sync, Rename, Close, Mkdir, Ours, Any, Calls };
const char *const names[Calls] = {"open", "write", "sync", "rename", "close", "mkdir", "ours", "any"};

std::atomic<long> counts[Calls];
std::atomic<bool> struck;
int wanted = Calls, value;
long at;
char folder[4096], countsFile[4096];

void copy(char (&to)[4096], const char *name) {
    const char *text = getenv(name);
    snprintf(to, sizeof to, "%s", text ? text : "");
}

__attribute__((constructor)) void begin() {
    char call[16] = "", strike[4096];
    copy(folder, "CHAOS_FOLDER"), copy(countsFile, "CHAOS_COUNTS"), copy(strike, "CHAOS_STRIKE");
    if (sscanf(strike, "%15s %ld %d", call, &at, &value) == 3)
        for (int each = 0; each < Calls; each++)
            if (!strcmp(call, names[each]))
                wanted = each;
}

long mostMemory() {
    char line[256];
    long found = 0;
    FILE *status = fopen("/proc/self/status", "r");
    while (status && fgets(line, sizeof line, status) && sscanf(line, "VmPeak: %ld", &found) != 1) {
    }
    if (status)
        fclose(status);
    return found;
}

void tell() {
    char text[512];
    int length = 0;
    for (int call = 0; call < Calls; call++)
        length += snprintf(text + length, sizeof text - length, "%s %ld\n", names[call], counts[call].load());
    length += snprintf(text + length, sizeof text - length, "struck %d\nmemory %ld\n", struck.load(), mostMemory());
    int file = open(countsFile, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file >= 0 && write(file, text, length) == length)
        close(file);
}

__attribute__((destructor)) void end() {
    if (countsFile[0])
        tell();
}

// Counts a call; whether it is to fail.
bool strikes(Call call) {
    if (++counts[call] != at || call != wanted)
        return false;
    struck = true;
    if (value < 0) {
        end();
        kill(getpid(), -value);
        return false;
    }
    errno = value;
    return true;
}

bool isBelow(const char *path) {
    char whole[4096];
    if (!folder[0] || !path)
        return false;
    if (path[0] != '/') {
        if (!getcwd(whole, sizeof whole))
            return false;
        path = whole; // none of ours climbs out of the folder
    }
    return !strncmp(path, folder, strlen(folder));
}

bool isBelow(int descriptor) {
    char link[64], path[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    ssize_t length = folder[0] ? readlink(link, path, sizeof path - 1) : -1;
    if (length < 0)
        return false;
    path[length] = 0;
    return path[0] == '/' && isBelow(path);
}

template <class T> T real(const char *name) {
    return reinterpret_cast<T>(dlsym(RTLD_NEXT, name));
}

bool opensToWrite(int flags) {
    return (flags & O_ACCMODE) != O_RDONLY;
}

// ---- Allocations ----

const char *const ourLibraries[] = {"/libskinslide",         "/skinslideFileFormat", "/_core.",    "/libcamd",
                                    "/libsuitesparseconfig", "/libosdCPU",           "/libOpenEXR"};

bool lookUpWhetherOurs(const void *caller) {
    Dl_info info;
    if (!dladdr(caller, &info) || !info.dli_fname)
        return false;
    for (const char *library : ourLibraries)
        if (strstr(info.dli_fname, library))
            return true;
    return false;
}

// Of a caller, remembered: a word of an address and of what was found.
bool isOurs(const void *caller) {
    enum { Size = 1 << 14 };
    static std::atomic<uintptr_t> known[Size];
    uintptr_t key = reinterpret_cast<uintptr_t>(caller) << 1;
    std::atomic<uintptr_t> &slot = known[(key >> 3) % Size];
    if ((slot | 1) != (key | 1))
        slot = key | lookUpWhetherOurs(caller);
    return slot & 1;
}

bool refused(const void *caller) {
    if (wanted != Ours && wanted != Any && !countsFile[0])
        return false;
    if (isOurs(caller) && strikes(Ours))
        return true;
    return counts[Ours] && strikes(Any);
}

void *orThrow(void *memory) {
    if (!memory)
        throw std::bad_alloc();
    return memory;
}

} // namespace

#define CALLER __builtin_return_address(0)

extern "C" void *malloc(size_t size) {
    return refused(CALLER) ? nullptr : __libc_malloc(size);
}
extern "C" void *calloc(size_t count, size_t size) {
    return refused(CALLER) ? nullptr : __libc_calloc(count, size);
}
extern "C" void *realloc(void *memory, size_t size) {
    return refused(CALLER) ? nullptr : __libc_realloc(memory, size);
}
extern "C" int posix_memalign(void **memory, size_t alignment, size_t size) {
    void *made = refused(CALLER) ? nullptr : __libc_memalign(alignment, size);
    if (made)
        *memory = made;
    return made ? 0 : ENOMEM;
}
void *operator new(size_t size) {
    return orThrow(refused(CALLER) ? nullptr : __libc_malloc(size));
}
void *operator new[](size_t size) {
    return orThrow(refused(CALLER) ? nullptr : __libc_malloc(size));
}
void *operator new(size_t size, const std::nothrow_t &) noexcept {
    return refused(CALLER) ? nullptr : __libc_malloc(size);
}
void operator delete(void *memory) noexcept {
    __libc_free(memory);
}
void operator delete[](void *memory) noexcept {
    __libc_free(memory);
}
void operator delete(void *memory, size_t) noexcept {
    __libc_free(memory);
}
void operator delete[](void *memory, size_t) noexcept {
    __libc_free(memory);
}

// A process that ends at once runs no destructors.
extern "C" [[noreturn]] void _exit(int code) {
    static auto next = real<void (*)(int)>("_exit");
    end();
    next(code);
    abort();
}

// ---- Files ----

#define OPEN(name)                                                                                                             \
    extern "C" int name(const char *path, int flags, ...) {                                                                    \
        va_list more;                                                                                                          \
        va_start(more, flags);                                                                                                 \
        mode_t mode = flags & O_CREAT ? va_arg(more, mode_t) : 0;                                                              \
        va_end(more);                                                                                                          \
        static auto next = real<int (*)(const char *, int, ...)>(#name);                                                       \
        return opensToWrite(flags) && isBelow(path) && strikes(Open) ? -1 : next(path, flags, mode);                           \
    }
OPEN(open)
OPEN(open64)

#define FOPEN(name)                                                                                                            \
    extern "C" FILE *name(const char *path, const char *mode) {                                                                \
        static auto next = real<FILE *(*)(const char *, const char *)>(#name);                                                 \
        return mode[0] != 'r' && isBelow(path) && strikes(Open) ? nullptr : next(path, mode);                                  \
    }
FOPEN(fopen)
FOPEN(fopen64)

extern "C" ssize_t write(int file, const void *data, size_t size) {
    static auto next = real<ssize_t (*)(int, const void *, size_t)>("write");
    return isBelow(file) && strikes(Write) ? -1 : next(file, data, size);
}

#define PWRITE(name)                                                                                                           \
    extern "C" ssize_t name(int file, const void *data, size_t size, off_t offset) {                                           \
        static auto next = real<ssize_t (*)(int, const void *, size_t, off_t)>(#name);                                         \
        return isBelow(file) && strikes(Write) ? -1 : next(file, data, size, offset);                                          \
    }
PWRITE(pwrite)
PWRITE(pwrite64)

extern "C" size_t fwrite(const void *data, size_t size, size_t count, FILE *file) {
    static auto next = real<size_t (*)(const void *, size_t, size_t, FILE *)>("fwrite");
    if (!isBelow(fileno(file)) || !strikes(Write))
        return next(data, size, count, file);
    file->_flags |= 0x20; // what ferror() looks for
    return 0;
}

extern "C" int fsync(int file) {
    static auto next = real<int (*)(int)>("fsync");
    return isBelow(file) && strikes(Sync) ? -1 : next(file);
}

extern "C" int rename(const char *from, const char *to) {
    static auto next = real<int (*)(const char *, const char *)>("rename");
    return isBelow(to) && strikes(Rename) ? -1 : next(from, to);
}

extern "C" int mkdir(const char *path, mode_t mode) {
    static auto next = real<int (*)(const char *, mode_t)>("mkdir");
    return isBelow(path) && strikes(Mkdir) ? -1 : next(path, mode);
}

// Closes all the same, as Linux does where it fails.
extern "C" int fclose(FILE *file) {
    static auto next = real<int (*)(FILE *)>("fclose");
    int flags = fcntl(fileno(file), F_GETFL);
    bool fails = flags >= 0 && opensToWrite(flags) && isBelow(fileno(file)) && strikes(Close);
    int status = next(file);
    return fails ? (errno = value, EOF) : status;
}

extern "C" int close(int file) {
    static auto next = real<int (*)(int)>("close");
    int flags = fcntl(file, F_GETFL);
    bool fails = flags >= 0 && opensToWrite(flags) && isBelow(file) && strikes(Close);
    int status = next(file);
    return fails ? (errno = value, -1) : status;
}
