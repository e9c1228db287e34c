// A disk that fails, for LD_PRELOAD: the N-th call that changes a file below FAULT_FOLDER fails with the error FAULT_ERRNO
// (FAULT_AT=N; with FAULT_STAYS=1 also every one behind it, as on a full disk). Those calls are: open for writing, mkdir, write,
// fsync and rename. FAULT_COUNT names a file that gets their number when the program ends.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long calls;

static long number(const char* name) {
  const char* text = getenv(name);
  return text != NULL ? atol(text) : 0;
}

static int below_folder(const char* path) {
  const char* folder = getenv("FAULT_FOLDER");
  if (folder == NULL || path == NULL) return 0;
  if (path[0] == '/') return strncmp(path, folder, strlen(folder)) == 0;
  char here[4096];
  return getcwd(here, sizeof here) != NULL && strncmp(here, folder, strlen(folder)) == 0;
}

static int is_file_below_folder(int descriptor) {
  struct stat now;
  if (fstat(descriptor, &now) != 0 || !S_ISREG(now.st_mode)) return 0;
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size <= 0) return 0;
  path[size] = 0;
  return below_folder(path);
}

// Whether this call, which changes a file of the folder, is to fail; errno is set then.
static int fails(void) {
  const long at = number("FAULT_AT"), call = atomic_fetch_add(&calls, 1) + 1;
  if (at == 0 || (number("FAULT_STAYS") != 0 ? call < at : call != at)) return 0;
  errno = (int)number("FAULT_ERRNO");
  return 1;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static int opened(const char* name, int folder, const char* path, int flags, mode_t mode) {
  if ((flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0 && below_folder(path) && fails()) return -1;
  return ((int (*)(int, const char*, int, ...))dlsym(RTLD_NEXT, name))(folder, path, flags, mode);
}
#define MODE_OF(flags)                                     \
  mode_t mode = 0;                                         \
  if (((flags) & (O_CREAT | O_TMPFILE)) != 0) {            \
    va_list further;                                       \
    va_start(further, flags);                              \
    mode = va_arg(further, mode_t);                        \
    va_end(further);                                       \
  }
int open(const char* path, int flags, ...) {
  MODE_OF(flags)
  return opened("openat", AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  MODE_OF(flags)
  return opened("openat64", AT_FDCWD, path, flags, mode);
}
int openat(int folder, const char* path, int flags, ...) {
  MODE_OF(flags)
  return opened("openat", folder, path, flags, mode);
}
FILE* fopen(const char* path, const char* how) {
  if (how[0] != 'r' && below_folder(path) && fails()) return NULL;
  return REAL(fopen)(path, how);
}
FILE* fopen64(const char* path, const char* how) {
  if (how[0] != 'r' && below_folder(path) && fails()) return NULL;
  return REAL(fopen64)(path, how);
}
ssize_t write(int descriptor, const void* bytes, size_t count) {
  if (is_file_below_folder(descriptor) && fails()) return -1;
  return REAL(write)(descriptor, bytes, count);
}
ssize_t writev(int descriptor, const struct iovec* parts, int count) {
  if (is_file_below_folder(descriptor) && fails()) return -1;
  return REAL(writev)(descriptor, parts, count);
}
ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t at) {
  if (is_file_below_folder(descriptor) && fails()) return -1;
  return REAL(pwrite)(descriptor, bytes, count, at);
}
ssize_t pwrite64(int descriptor, const void* bytes, size_t count, off64_t at) {
  if (is_file_below_folder(descriptor) && fails()) return -1;
  return REAL(pwrite64)(descriptor, bytes, count, at);
}
int fsync(int descriptor) {
  if (is_file_below_folder(descriptor) && fails()) return -1;
  return REAL(fsync)(descriptor);
}
int fdatasync(int descriptor) {
  if (is_file_below_folder(descriptor) && fails()) return -1;
  return REAL(fdatasync)(descriptor);
}
int rename(const char* from, const char* to) {
  if (below_folder(to) && fails()) return -1;
  return REAL(rename)(from, to);
}
int mkdir(const char* path, mode_t mode) {
  if (below_folder(path) && fails()) return -1;
  return REAL(mkdir)(path, mode);
}

__attribute__((destructor)) static void tell(void) {
  const char* path = getenv("FAULT_COUNT");
  FILE* file = path != NULL ? REAL(fopen)(path, "w") : NULL;
  if (file == NULL) return;
  fprintf(file, "%ld\n", atomic_load(&calls));
  fclose(file);
}
