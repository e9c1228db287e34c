#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace homolog {

/// To be called first in a program. A file that is opened does not get the number of a standard stream that is closed:
/// what is printed would be written into it. A file that may not grow (`ulimit -f`) is an error of writing, not the
/// program's end.
void prepare_process();

/// The number by which the system knows this process.
long process_number();

/// The file of the program that runs; empty where the system does not say.
std::filesystem::path program_file();

/// Goes on as another program, with this command line. Returns only where that is not possible.
void become_program(const std::filesystem::path& program, char** argv);

/// Runs a program of the system to its end, found as a shell finds it: `words` are its name and its arguments. It reads
/// and prints nothing. Whether it is there and ended with status 0.
bool run_silently(const std::vector<std::string>& words);
/// The same, with what it prints; nothing where it is not there or ended otherwise.
std::optional<std::string> printed_by(const std::vector<std::string>& words);

/// How long the calling thread has had a core, in ms. Other programs that take turns do not count.
double thread_core_ms();

/// Whether a person sees what is written to the standard error.
bool errors_are_seen();

/// While it lives, nothing is written to the standard error, by whatever library. One thread at a time: others wait.
class SilencedErrors {
 public:
  SilencedErrors();
  ~SilencedErrors();
  SilencedErrors(const SilencedErrors&) = delete;
  SilencedErrors& operator=(const SilencedErrors&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  int before_ = -1;
};

/// A folder of this process alone for what is needed for a while; removed at the end with all that is in it.
struct ScratchFolder {
  /// Its name begins with `name`.
  explicit ScratchFolder(const char* name);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path path;
};

}  // namespace homolog
