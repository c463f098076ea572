/* Preloaded into a process: counts the calls that change files below a folder, and at one of them the process is killed,
   or the call fails as on a full disk. Build: cc -shared -fPIC -o io_faults.so io_faults.c -ldl */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

static char folder[PATH_MAX];
static long at, seen;
static int deadly;

/* From now on: strike at the n-th call (never for 0); kill, or fail. */
void io_faults(const char *below, long n, int kill_it) {
  snprintf(folder, sizeof folder, "%s", below);
  at = n, seen = 0, deadly = kill_it;
}

long io_calls(void) { return seen; }

static int struck(int concerned) {
  if (!concerned || ++seen != at) return 0;
  if (deadly) kill(getpid(), SIGKILL);
  errno = ENOSPC;
  return 1;
}

static int below(const char *path) {
  char whole[PATH_MAX];
  if (!folder[0] || !path) return 0;
  if (path[0] != '/' && getcwd(whole, sizeof whole / 2)) {
    strncat(whole, "/", 2);
    strncat(whole, path, sizeof whole / 2 - 2);
    path = whole;
  }
  return !strncmp(path, folder, strlen(folder));
}

static int of(int file) {
  char link[64], path[PATH_MAX];
  ssize_t size;
  if (!folder[0]) return 0;
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  size = readlink(link, path, sizeof path - 1);
  if (size < 0) return 0;
  path[size] = 0;
  return below(path);
}

#define REAL(type, name, ...) ((type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, #name))
#define WRAP(type, name, concerned, declared, given, ...)                                                             \
  type name declared {                                                                                                \
    static type (*real)(__VA_ARGS__);                                                                                 \
    if (!real) real = REAL(type, name, __VA_ARGS__);                                                                  \
    return struck(concerned) ? (type)-1 : real given;                                                                 \
  }

WRAP(ssize_t, write, of(f), (int f, const void *b, size_t n), (f, b, n), int, const void *, size_t)
WRAP(ssize_t, pwrite, of(f), (int f, const void *b, size_t n, off_t o), (f, b, n, o), int, const void *, size_t, off_t)
WRAP(ssize_t, pwrite64, of(f), (int f, const void *b, size_t n, off64_t o), (f, b, n, o), int, const void *, size_t,
     off64_t)
WRAP(ssize_t, writev, of(f), (int f, const struct iovec *v, int n), (f, v, n), int, const struct iovec *, int)
WRAP(int, fsync, of(f), (int f), (f), int)
WRAP(int, fdatasync, of(f), (int f), (f), int)
WRAP(int, ftruncate, of(f), (int f, off_t n), (f, n), int, off_t)
WRAP(int, ftruncate64, of(f), (int f, off64_t n), (f, n), int, off64_t)
WRAP(int, rename, below(a) || below(b), (const char *a, const char *b), (a, b), const char *, const char *)
WRAP(int, unlink, below(a), (const char *a), (a), const char *)

#define WRAP_OPEN(name)                                                                                               \
  int name(const char *path, int flags, ...) {                                                                        \
    static int (*real)(const char *, int, ...);                                                                       \
    mode_t mode = 0;                                                                                                  \
    if (!real) real = (int (*)(const char *, int, ...))dlsym(RTLD_NEXT, #name);                                       \
    if (flags & O_CREAT) {                                                                                            \
      va_list more;                                                                                                   \
      va_start(more, flags);                                                                                          \
      mode = va_arg(more, mode_t);                                                                                    \
      va_end(more);                                                                                                   \
    }                                                                                                                 \
    return struck((flags & O_CREAT) && below(path)) ? -1 : real(path, flags, mode);                                   \
  }

WRAP_OPEN(open)
WRAP_OPEN(open64)
