// See failing_disk.h. With LD_PRELOAD the N-th call that changes a file below FAULT_FOLDER fails with the error FAULT_ERRNO
// (FAULT_AT=N; with FAULT_STAYS=1 also every one behind it, as on a full disk). FAULT_COUNT names a file that gets the number
// of those calls when the program ends.
#define _GNU_SOURCE
#include "failing_disk.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static char folder[4096];
static atomic_long calls, fail_at;
static atomic_int fail_error, fail_stays, recording;

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static struct disk_operation* record;
static size_t recorded, room;

__attribute__((constructor)) static void begin(void) {
  const char* text = getenv("FAULT_FOLDER");
  if (text != NULL) disk_watch(text);
  const char *at = getenv("FAULT_AT"), *error = getenv("FAULT_ERRNO"), *stays = getenv("FAULT_STAYS");
  if (at != NULL && error != NULL) disk_fail(atol(at), atoi(error), stays != NULL && atoi(stays) != 0);
}

void disk_watch(const char* watched) {
  snprintf(folder, sizeof folder, "%s", watched != NULL ? watched : "");
  disk_fail(0, 0, 0);
}
void disk_fail(long at, int error, int stays) {
  atomic_store(&fail_at, 0);
  atomic_store(&calls, 0);
  atomic_store(&fail_error, error);
  atomic_store(&fail_stays, stays);
  atomic_store(&fail_at, at);
}
long disk_calls(void) { return atomic_load(&calls); }

static int below_folder(const char* path) {
  if (folder[0] == 0 || path == NULL) return 0;
  if (path[0] == '/') return strncmp(path, folder, strlen(folder)) == 0;
  char here[4096];
  return getcwd(here, sizeof here) != NULL && strncmp(here, folder, strlen(folder)) == 0;
}

// The path of an open file of the folder, and its inode; 0: it is no file (folder) of it.
static int find_open(int descriptor, mode_t kind, char* path, size_t size, unsigned long* inode) {
  struct stat now;
  if (folder[0] == 0 || fstat(descriptor, &now) != 0 || (now.st_mode & S_IFMT) != kind) return 0;
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, size - 1);
  if (length <= 0) return 0;
  path[length] = 0;
  *inode = (unsigned long)now.st_ino;
  return below_folder(path);
}
static int is_file_below_folder(int descriptor) {
  char path[4096];
  unsigned long inode;
  return find_open(descriptor, S_IFREG, path, sizeof path, &inode);
}

// Whether this call, which changes a file of the folder, is to fail; errno is set then.
static int fails(void) {
  const long call = atomic_fetch_add(&calls, 1) + 1, at = atomic_load(&fail_at);
  if (at == 0 || (atomic_load(&fail_stays) != 0 ? call < at : call != at)) return 0;
  errno = atomic_load(&fail_error);
  return 1;
}

// --- The record. What is done and its line in the record are one step for other threads.

void disk_record(int on) {
  pthread_mutex_lock(&mutex);
  if (on) {
    for (size_t k = 0; k < recorded; ++k) {
      free(record[k].bytes);
      free(record[k].path);
      free(record[k].to);
    }
    recorded = 0;
  }
  atomic_store(&recording, on);
  pthread_mutex_unlock(&mutex);
}
const struct disk_operation* disk_recorded(size_t* count) {
  *count = recorded;
  return record;
}

static char* whole_path(const char* path) {
  if (path == NULL) return NULL;
  if (path[0] == '/') return strdup(path);
  char here[4096], *text = NULL;
  if (getcwd(here, sizeof here) == NULL || asprintf(&text, "%s/%s", here, path) < 0) return NULL;
  return text;
}

static void add(enum disk_call call, unsigned long file, size_t at, const void* bytes, size_t size, const char* path,
                const char* to) {
  if (recorded == room) {
    room = room != 0 ? 2 * room : 256;
    record = realloc(record, room * sizeof *record);
    if (record == NULL) abort();
  }
  struct disk_operation one = {call, file, at, size, NULL, whole_path(path), whole_path(to)};
  if (bytes != NULL) {
    one.bytes = malloc(size + 1);
    if (one.bytes == NULL) abort();
    memcpy(one.bytes, bytes, size);
    one.bytes[size] = 0;
  }
  record[recorded++] = one;
}
void disk_say(const char* text) {
  if (!atomic_load(&recording)) return;
  pthread_mutex_lock(&mutex);
  add(disk_mark, 0, 0, text, strlen(text), NULL, NULL);
  pthread_mutex_unlock(&mutex);
}

static int hold(void) {
  const int kept = atomic_load(&recording);
  if (kept) pthread_mutex_lock(&mutex);
  return kept;
}
static void let_go(int kept) {
  const int error = errno;
  if (kept) pthread_mutex_unlock(&mutex);
  errno = error;
}
static void add_written(int descriptor, const void* bytes, ssize_t size, off_t at) {
  char path[4096];
  unsigned long inode;
  const int error = errno;
  if (size > 0 && find_open(descriptor, S_IFREG, path, sizeof path, &inode))
    add(disk_writes, inode, (size_t)at, bytes, (size_t)size, NULL, NULL);
  errno = error;
}
static void add_path(enum disk_call call, const char* path, const char* to) {
  struct stat now;
  const int error = errno;
  const char* final = to != NULL ? to : path;
  add(call, lstat(final, &now) == 0 ? (unsigned long)now.st_ino : 0, 0, NULL, 0, path, to);
  errno = error;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

// --- Names.

static int opened(const char* name, int at_folder, const char* path, int flags, mode_t mode) {
  const int changes = (flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0 && below_folder(path);
  if (changes && fails()) return -1;
  const int kept = changes ? hold() : 0;
  struct stat before;
  const int was_there = kept && stat(path, &before) == 0;
  const int file = ((int (*)(int, const char*, int, ...))dlsym(RTLD_NEXT, name))(at_folder, path, flags, mode);
  if (kept && file >= 0 && !was_there) add_path(disk_makes_file, path, NULL);
  if (kept && file >= 0 && was_there && (flags & O_TRUNC) != 0) add(disk_cuts, before.st_ino, 0, NULL, 0, NULL, NULL);
  let_go(kept);
  return file;
}
#define MODE_OF(flags)                          \
  mode_t mode = 0;                              \
  if (((flags) & (O_CREAT | O_TMPFILE)) != 0) { \
    va_list further;                            \
    va_start(further, flags);                   \
    mode = va_arg(further, mode_t);             \
    va_end(further);                            \
  }
int open(const char* path, int flags, ...) {
  MODE_OF(flags)
  return opened("openat", AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  MODE_OF(flags)
  return opened("openat64", AT_FDCWD, path, flags, mode);
}
int openat(int at_folder, const char* path, int flags, ...) {
  MODE_OF(flags)
  return opened("openat", at_folder, path, flags, mode);
}
FILE* fopen(const char* path, const char* how) {
  if (how[0] != 'r' && below_folder(path) && fails()) return NULL;
  return REAL(fopen)(path, how);
}
FILE* fopen64(const char* path, const char* how) {
  if (how[0] != 'r' && below_folder(path) && fails()) return NULL;
  return REAL(fopen64)(path, how);
}
int rename(const char* from, const char* to) {
  const int changes = below_folder(to);
  if (changes && fails()) return -1;
  const int kept = changes ? hold() : 0;
  const int done = REAL(rename)(from, to);
  if (kept && done == 0) add_path(disk_renames, from, to);
  let_go(kept);
  return done;
}
int mkdir(const char* path, mode_t mode) {
  const int changes = below_folder(path);
  if (changes && fails()) return -1;
  const int kept = changes ? hold() : 0;
  const int done = REAL(mkdir)(path, mode);
  if (kept && done == 0) add_path(disk_makes_folder, path, NULL);
  let_go(kept);
  return done;
}
// What is removed is recorded, but never fails: nothing depends on it.
#define REMOVING(name)                                            \
  int name(const char* path) {                                    \
    const int kept = below_folder(path) ? hold() : 0;             \
    const int done = REAL(name)(path);                            \
    if (kept && done == 0) add_path(disk_removes, path, NULL);    \
    let_go(kept);                                                 \
    return done;                                                  \
  }
REMOVING(unlink)
REMOVING(rmdir)
REMOVING(remove)

// --- Content.

ssize_t write(int descriptor, const void* bytes, size_t count) {
  const int changes = is_file_below_folder(descriptor);
  if (changes && fails()) return -1;
  const int kept = changes ? hold() : 0;
  const ssize_t written = REAL(write)(descriptor, bytes, count);
  if (kept && written > 0) add_written(descriptor, bytes, written, lseek(descriptor, 0, SEEK_CUR) - written);
  let_go(kept);
  return written;
}
ssize_t writev(int descriptor, const struct iovec* parts, int count) {
  const int changes = is_file_below_folder(descriptor);
  if (changes && fails()) return -1;
  const int kept = changes ? hold() : 0;
  const ssize_t written = REAL(writev)(descriptor, parts, count);
  off_t at = kept && written > 0 ? lseek(descriptor, 0, SEEK_CUR) - written : 0;
  ssize_t left = written;
  for (int k = 0; kept && k < count && left > 0; ++k) {
    const ssize_t part = (ssize_t)parts[k].iov_len < left ? (ssize_t)parts[k].iov_len : left;
    add_written(descriptor, parts[k].iov_base, part, at);
    at += part;
    left -= part;
  }
  let_go(kept);
  return written;
}
#define WRITING_AT(name, offset)                                                     \
  ssize_t name(int descriptor, const void* bytes, size_t count, offset at) {         \
    const int changes = is_file_below_folder(descriptor);                            \
    if (changes && fails()) return -1;                                               \
    const int kept = changes ? hold() : 0;                                           \
    const ssize_t written = REAL(name)(descriptor, bytes, count, at);                \
    if (kept && written > 0) add_written(descriptor, bytes, written, (off_t)at);     \
    let_go(kept);                                                                    \
    return written;                                                                  \
  }
WRITING_AT(pwrite, off_t)
WRITING_AT(pwrite64, off64_t)
#define CUTTING(name, offset)                                                        \
  int name(int descriptor, offset size) {                                            \
    char path[4096];                                                                 \
    unsigned long inode;                                                             \
    const int changes = find_open(descriptor, S_IFREG, path, sizeof path, &inode);   \
    if (changes && fails()) return -1;                                               \
    const int kept = changes ? hold() : 0;                                           \
    const int done = REAL(name)(descriptor, size);                                   \
    if (kept && done == 0) add(disk_cuts, inode, (size_t)size, NULL, 0, NULL, NULL); \
    let_go(kept);                                                                    \
    return done;                                                                     \
  }
CUTTING(ftruncate, off_t)
CUTTING(ftruncate64, off64_t)
#define SYNCING(name)                                                                                    \
  int name(int descriptor) {                                                                             \
    char path[4096];                                                                                     \
    unsigned long inode = 0;                                                                             \
    const int file = find_open(descriptor, S_IFREG, path, sizeof path, &inode);                          \
    const int changes = file || find_open(descriptor, S_IFDIR, path, sizeof path, &inode);               \
    if (changes && fails()) return -1;                                                                   \
    const int kept = changes ? hold() : 0;                                                               \
    const int done = REAL(name)(descriptor);                                                             \
    if (kept && done == 0)                                                                               \
      add(file ? disk_syncs_file : disk_syncs_folder, inode, 0, NULL, 0, path, NULL);                    \
    let_go(kept);                                                                                        \
    return done;                                                                                         \
  }
SYNCING(fsync)
SYNCING(fdatasync)

__attribute__((destructor)) static void tell(void) {
  const char* path = getenv("FAULT_COUNT");
  FILE* file = path != NULL ? REAL(fopen)(path, "w") : NULL;
  if (file == NULL) return;
  fprintf(file, "%ld\n", atomic_load(&calls));
  fclose(file);
}
