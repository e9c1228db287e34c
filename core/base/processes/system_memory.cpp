#include "core/base/processes/memory.h"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>

namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();

/// The number that a file holds; nothing where it is absent or says "max".
std::optional<double> number_in(const fs::path& file) {
  std::ifstream in(file);
  double number = 0;
  if (in >> number) return number;
  return {};
}

/// The number behind a key in a file of lines "key number"; 0 without it.
double number_of(const fs::path& file, const std::string& wanted) {
  std::ifstream in(file);
  std::string key;
  for (double number = 0; in >> key >> number;)
    if (key == wanted) return number;
  return 0;
}

/// The files of one version of control groups.
struct GroupFiles {
  const char *limit, *usage, *reclaimable;
};
constexpr GroupFiles version_1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr GroupFiles version_2{"memory.max", "memory.current", "inactive_file"};

/// The room that one group's limit leaves. Cached files count as its usage, but give way.
double room_in(const fs::path& group, const GroupFiles& files) {
  const auto limit = number_in(group / files.limit), usage = number_in(group / files.usage);
  if (!limit || !usage) return no_limit;
  return std::max(0.0, *limit - *usage + number_of(group / "memory.stat", files.reclaimable));
}

/// The group at `path` below `root` and all around it. In a container the path may be that outside of it; then only
/// some of its folders are there, which is no fault.
double room_along(const fs::path& root, const fs::path& path, const GroupFiles& files) {
  fs::path group = root;
  double room = room_in(group, files);
  for (const fs::path& name : path.relative_path()) {
    if (name == "..") break;
    group /= name;
    room = std::min(room, room_in(group, files));
  }
  return room;
}

/// The number that a file of the system gives by "KEY: N kB", in bytes; nothing where it does not.
std::optional<double> kilobytes_of(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    double kilobytes = 0;
    if (line.starts_with(key + ":") && std::sscanf(line.c_str() + key.size() + 1, "%lf kB", &kilobytes) == 1)
      return kilobytes * 1024;
  }
  return {};
}

/// The room that one limit of this process leaves of what it has; `key` names that in /proc/self/status.
template <class Resource>
double room_under(Resource resource, const std::string& key) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return no_limit;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - kilobytes_of("/proc/self/status", key).value_or(0));
}

}  // namespace

double control_group_room_bytes(const std::string& membership, const fs::path& root) {
  double room = no_limit;
  std::istringstream lines(membership);
  for (std::string line; std::getline(lines, line);) {  // "4:memory:/path", or "0::/path" in version 2
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const fs::path path = line.substr(second + 1);
    if (controllers == ",,") room = std::min(room, room_along(root, path, version_2));
    if (controllers.find(",memory,") != std::string::npos)
      room = std::min(room, room_along(root / "memory", path, version_1));
  }
  return room;
}

double process_room_bytes() {
  return std::min(room_under(RLIMIT_AS, "VmSize"), room_under(RLIMIT_DATA, "VmData"));
}

double available_memory_bytes() {
  std::ifstream in("/proc/self/cgroup");
  const std::string membership(std::istreambuf_iterator<char>(in), {});
  return std::min({kilobytes_of("/proc/meminfo", "MemAvailable").value_or(no_limit),
                   control_group_room_bytes(membership, "/sys/fs/cgroup"), process_room_bytes()});
}

double resident_memory_mb() {
  return kilobytes_of("/proc/self/status", "VmRSS").value_or(0) / 1e6;
}

double peak_memory_mb() {
  return kilobytes_of("/proc/self/status", "VmHWM").value_or(0) / 1e6;
}

void forget_peak_memory() {
  std::ofstream("/proc/self/clear_refs") << 5;
}

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int largest_kept_block = 64 << 20, most_kept = 512 << 20;  // bytes
  ::mallopt(M_MMAP_THRESHOLD, largest_kept_block);
  ::mallopt(M_TRIM_THRESHOLD, most_kept);
#endif
}

void give_back_freed_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

Result<void> check_memory(const fs::path& file, double needed_bytes) {
  const double available = available_memory_bytes();
  if (needed_bytes <= available) return {};
  char text[200];
  std::snprintf(text, sizeof text,
                "needs %.1f GB of memory and %.1f GB are free; close other programs, or crop or resample the volume",
                needed_bytes / 1e9, available / 1e9);
  return fail(file.string(), text);
}

}  // namespace homolog
