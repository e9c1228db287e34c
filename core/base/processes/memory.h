#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.h"

namespace homolog {

/// Bytes of memory that this process can still get: what the machine has free, or what the limits of its control groups
/// (containers, batch systems) or its own (`ulimit -v`, `ulimit -d`) leave where that is less. Infinite where the
/// system says none of these.
double available_memory_bytes();

/// Bytes that the limits of this process leave on its addresses and its data [setrlimit(2), RLIMIT_AS and RLIMIT_DATA];
/// infinite without such limits.
double process_room_bytes();

/// Bytes that the limits of a process's control groups leave, those of the groups around them included; infinite where
/// there is no limit. `membership` is the text of /proc/self/cgroup and `root` the folder of the groups,
/// /sys/fs/cgroup; versions 1 and 2 [Linux, Documentation/admin-guide/cgroup-v1/memory.rst and cgroup-v2.rst].
double control_group_room_bytes(const std::string& membership, const std::filesystem::path& root);

/// Memory of this process, in MB (a million bytes): what it has now, and the most since it began or since
/// forget_peak_memory(); 0 where the system does not say.
double resident_memory_mb();
double peak_memory_mb();
void forget_peak_memory();

/// Lets this process keep memory that it freed, up to some hundred MB, and use it again. To give it back and to get it
/// anew costs a fit as much time as to compute. To be called before there are other threads.
void keep_freed_memory();
/// Gives all of it back, after work that needed much once.
void give_back_freed_memory();

/// Fails where `needed_bytes` exceed the memory that is available; the sentence names `file` and both sizes.
Result<void> check_memory(const std::filesystem::path& file, double needed_bytes);

}  // namespace homolog
