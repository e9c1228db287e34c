#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// Starts the program again as a child process, for work that may fail badly: a library that reads an unknown file may
/// crash, run for ever or take all memory. The child is a new start of the program and not a fork, because a process
/// with threads must not fork and continue (a lock that another thread holds stays locked for ever in the child). No
/// other program has to be found: /proc/self/exe is this one, even if it was moved or rebuilt meanwhile.
class ConfinedChild {
 public:
  /// `arguments` follow the program's name; something in it must know them (see hdf5_reader.cpp). Errors: no process
  /// can be made.
  static Result<ConfinedChild> start(const std::vector<std::string>& arguments);
  ConfinedChild(ConfinedChild&& other) noexcept;
  ConfinedChild& operator=(ConfinedChild&&) = delete;
  /// Closes the child's output, which ends it where it still writes, and waits for its end.
  ~ConfinedChild();

  /// The child's standard output. Not to be trusted.
  std::FILE* output() { return output_; }

 private:
  ConfinedChild(int process, std::FILE* output) : process_(process), output_(output) {}
  int process_;  ///< the system's number
  std::FILE* output_;
};

/// The program that is started as a child, where this one is not one that knows the arguments: Python, which has core
/// as a module. Before the first child.
void use_program_for_children(const std::filesystem::path& program);

/// Called by the child before its work: from now on it may take `memory_bytes` more than it has and `seconds` of the
/// processor's time; beyond that, memory is refused and the process is killed. It leaves no core file and ignores
/// Ctrl-C, which its parent answers.
void confine_this_process(std::uintmax_t memory_bytes, unsigned seconds);

}  // namespace homolog
