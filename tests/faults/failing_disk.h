// A disk that fails and that keeps a record of what it is asked: tests link the library, programs get it by LD_PRELOAD
// (failing_disk.c says how it is told what to do then). Only calls that change files below one folder count.
#ifndef HOMOLOG_FAILING_DISK_H
#define HOMOLOG_FAILING_DISK_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

// Requests of a program to the disk: open for writing and mkdir (which make a name), write, ftruncate, fsync, rename,
// unlink and rmdir.
enum disk_call {
  disk_makes_file,
  disk_makes_folder,
  disk_writes,
  disk_cuts,
  disk_syncs_file,
  disk_syncs_folder,
  disk_renames,
  disk_removes,
  disk_mark  // nothing was asked: the test says something
};

struct disk_operation {
  enum disk_call call;
  unsigned long file;  // its inode; inodes are given again when a file is made
  size_t at;           // the place of what is written; the new size of what is cut
  size_t size;
  char* bytes;  // written; of a mark its text
  char* path;   // the path of what has one
  char* to;     // the new name of a renaming
};

// From now on calls below the folder count; null: none do. Nothing fails.
void disk_watch(const char* folder);
// The `at`-th call from now on fails with `error`, and where it stays so all later ones; 0: none does.
void disk_fail(long at, int error, int stays);
// How many calls that can fail there were since disk_watch() or disk_fail().
long disk_calls(void);
// Keeps a record from now on, or stops keeping it. The record is the library's, and gone with the next call.
void disk_record(int on);
const struct disk_operation* disk_recorded(size_t* count);
// Puts a text between the operations.
void disk_say(const char* text);

#ifdef __cplusplus
}
#endif

#endif
