/* Counts the calls of a program that change the file system and injects a fault at one of them; for LD_PRELOAD.
 *
 * FAULT_LOG   log file, one line per call: number, name, path
 * FAULT_AT    number of the call or allocation, from 1
 * FAULT_MODE  kind of fault:
 *   full       this and every later call that needs space fail: the disk is full
 *   once       only this call fails as on a full disk
 *   kill       SIGKILL instead of the call
 *   half       the first half of a write, then SIGKILL
 *   interrupt  SIGINT, then the call
 *   allocate   SIGINT at a memory allocation
 * FAULT_NO_EXCHANGE  if set, two folders cannot be swapped in one step
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static atomic_long calls, allocations;
static long at;
static enum { NOTHING, FULL, ONCE, KILL, HALF, INTERRUPT, ALLOCATE } mode;
static int log_file = -1;

__attribute__((constructor)) static void begin(void) {
    const char *names[] = {"", "full", "once", "kill", "half", "interrupt", "allocate"};
    const char *wanted = getenv("FAULT_MODE"), *number = getenv("FAULT_AT"), *path = getenv("FAULT_LOG");
    for (int i = 1; wanted && i < 7; i++)
        if (!strcmp(wanted, names[i])) mode = i;
    at = number ? atol(number) : 0;
    /* By system call, so that it is not counted. */
    if (path) log_file = syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
}

__attribute__((destructor)) static void end(void) {
    char line[64];
    int length = snprintf(line, sizeof line, "%ld allocations -\n", (long)allocations);
    if (log_file >= 0) syscall(SYS_write, log_file, line, length);
}

/* Counts a call; returns true if it must fail. Sets `halved` if half of it must be done before SIGKILL. */
static int fails(const char *name, const char *path, int needs_space, int needs_room, int *halved) {
    long number = ++calls;
    if (log_file >= 0) {
        char line[4096];
        int length = snprintf(line, sizeof line, "%ld %s %s\n", number, name, path);
        syscall(SYS_write, log_file, line, length);
    }
    if (mode == FULL && at && number >= at && needs_space) { errno = ENOSPC; return 1; }
    if (number != at) return 0;
    switch (mode) {
    case ONCE: if (needs_space || needs_room) { errno = ENOSPC; return 1; } break;
    case HALF: if (halved) { *halved = 1; break; } /* fall through */
    case KILL: raise(SIGKILL); break;
    case INTERRUPT: raise(SIGINT); break;
    default: break;
    }
    return 0;
}

/* Path of an open regular file other than the standard streams; NULL otherwise. */
static const char *path_of(int file, char *buffer, size_t size) {
    struct stat state;
    char link[64];
    if (file <= 2 || fstat(file, &state) || !(S_ISREG(state.st_mode) || S_ISDIR(state.st_mode))) return NULL;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = readlink(link, buffer, size - 1);
    buffer[length < 0 ? 0 : length] = 0;
    return buffer;
}

static int opens_for_writing(const char *path, int flags) {
    return (flags & (O_CREAT | O_TRUNC)) && strncmp(path, "/dev/", 5) && fails("create", path, 1, 0, NULL);
}

#define MODE(flags) \
    mode_t permissions = 0; \
    if ((flags) & (O_CREAT | O_TMPFILE)) { \
        va_list list; \
        va_start(list, flags); \
        permissions = va_arg(list, mode_t); \
        va_end(list); \
    }

int open(const char *path, int flags, ...) {
    MODE(flags)
    return opens_for_writing(path, flags) ? -1 : REAL(open)(path, flags, permissions);
}

int open64(const char *path, int flags, ...) {
    MODE(flags)
    return opens_for_writing(path, flags) ? -1 : REAL(open64)(path, flags, permissions);
}

int openat(int folder, const char *path, int flags, ...) {
    MODE(flags)
    return opens_for_writing(path, flags) ? -1 : REAL(openat)(folder, path, flags, permissions);
}

int openat64(int folder, const char *path, int flags, ...) {
    MODE(flags)
    return opens_for_writing(path, flags) ? -1 : REAL(openat64)(folder, path, flags, permissions);
}

ssize_t write(int file, const void *bytes, size_t count) {
    char buffer[4096];
    int halved = 0;
    const char *path = path_of(file, buffer, sizeof buffer);
    if (path && fails("write", path, 1, 0, &halved)) return -1;
    ssize_t written = REAL(write)(file, bytes, halved ? count / 2 : count);
    if (halved) raise(SIGKILL);
    return written;
}

ssize_t writev(int file, const struct iovec *parts, int count) {
    char buffer[4096];
    const char *path = path_of(file, buffer, sizeof buffer);
    return path && fails("write", path, 1, 0, NULL) ? -1 : REAL(writev)(file, parts, count);
}

ssize_t pwrite64(int file, const void *bytes, size_t count, off64_t offset) {
    char buffer[4096];
    const char *path = path_of(file, buffer, sizeof buffer);
    return path && fails("write", path, 1, 0, NULL) ? -1 : REAL(pwrite64)(file, bytes, count, offset);
}

#define ON_FILE(function, name, needs_space, parameters, arguments) \
    int function parameters { \
        char buffer[4096]; \
        const char *path = path_of(file, buffer, sizeof buffer); \
        return path && fails(name, path, needs_space, 0, NULL) ? -1 : REAL(function) arguments; \
    }
ON_FILE(fsync, "fsync", 1, (int file), (file))
ON_FILE(fdatasync, "fsync", 1, (int file), (file))
ON_FILE(ftruncate64, "truncate", 0, (int file, off64_t length), (file, length))

#define ON_PATH(function, name, needs_space, needs_room, parameters, arguments) \
    int function parameters { \
        return fails(name, path, needs_space, needs_room, NULL) ? -1 : REAL(function) arguments; \
    }
ON_PATH(mkdir, "mkdir", 1, 0, (const char *path, mode_t permissions), (path, permissions))
ON_PATH(mkdirat, "mkdir", 1, 0, (int folder, const char *path, mode_t permissions), (folder, path, permissions))
ON_PATH(rename, "rename", 0, 1, (const char *from, const char *path), (from, path))
ON_PATH(renameat, "rename", 0, 1, (int a, const char *from, int b, const char *path), (a, from, b, path))
ON_PATH(link, "link", 1, 0, (const char *from, const char *path), (from, path))
ON_PATH(linkat, "link", 1, 0, (int a, const char *from, int b, const char *path, int flags), (a, from, b, path, flags))
ON_PATH(unlink, "unlink", 0, 0, (const char *path), (path))
ON_PATH(unlinkat, "unlink", 0, 0, (int folder, const char *path, int flags), (folder, path, flags))
ON_PATH(rmdir, "rmdir", 0, 0, (const char *path), (path))

int renameat2(int a, const char *from, int b, const char *path, unsigned flags) {
    if ((flags & RENAME_EXCHANGE) && getenv("FAULT_NO_EXCHANGE")) {
        errno = EINVAL;
        return -1;
    }
    const char *name = flags & RENAME_EXCHANGE ? "exchange" : "rename";
    return fails(name, path, 0, 1, NULL) ? -1 : REAL(renameat2)(a, from, b, path, flags);
}

extern void *__libc_malloc(size_t size);

void *malloc(size_t size) {
    if (++allocations == at && mode == ALLOCATE) raise(SIGINT);
    return __libc_malloc(size);
}
