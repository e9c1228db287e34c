#include "core/base/processes/confined.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

namespace homolog {

namespace {

std::string program_for_children = "/proc/self/exe";

tl::unexpected<Error> cannot_start(int error) {
  return fail("", std::string("cannot be read, because no process for it can be started (") + std::strerror(error) +
                      "); close other programs and try again");
}

/// The program with `arguments`, writing into `output`; everything else that is open here is closed there.
int spawn(const std::vector<std::string>& arguments, int output, pid_t& process) {
  std::vector<char*> argv{const_cast<char*>("homolog")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  if (const int error = ::posix_spawn_file_actions_init(&files); error != 0) return error;
  ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  ::posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  const int error = ::posix_spawn(&process, program_for_children.c_str(), &files, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  return error;
}

[[maybe_unused]] std::uintmax_t address_space_bytes() {  // not under sanitizers, which take all addresses
  unsigned long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "re"); file != nullptr) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return std::uintmax_t{pages} * static_cast<std::uintmax_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

void use_program_for_children(const std::filesystem::path& program) {
  program_for_children = program.string();
}

Result<ConfinedChild> ConfinedChild::start(const std::vector<std::string>& arguments) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return cannot_start(errno);
  pid_t process = -1;
  const int error = spawn(arguments, ends[1], process);
  ::close(ends[1]);
  std::FILE* output = error == 0 ? ::fdopen(ends[0], "r") : nullptr;
  if (output == nullptr) ::close(ends[0]);
  if (error != 0) return cannot_start(error);
  ConfinedChild child(process, output);
  if (output == nullptr) return cannot_start(ENOMEM);
  return child;
}

ConfinedChild::ConfinedChild(ConfinedChild&& other) noexcept
    : process_(std::exchange(other.process_, -1)), output_(std::exchange(other.output_, nullptr)) {}

ConfinedChild::~ConfinedChild() {
  if (output_ != nullptr) std::fclose(output_);
  while (process_ > 0 && ::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void confine_this_process(std::uintmax_t memory_bytes, unsigned seconds) {
  const auto limit = [](auto resource, std::uintmax_t most) {
    rlimit now{};
    ::getrlimit(resource, &now);  // RLIM_INFINITY is the largest number
    now.rlim_cur = now.rlim_max = std::min(static_cast<rlim_t>(most), now.rlim_max);
    ::setrlimit(resource, &now);
  };
  limit(RLIMIT_CORE, 0);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static_cast<void>(memory_bytes);  // the sanitizers' own memory is terabytes of addresses
  limit(RLIMIT_CPU, 20 * seconds);  // and they are slow
#else
  limit(RLIMIT_AS, address_space_bytes() + memory_bytes);
  limit(RLIMIT_CPU, seconds);
#endif
  std::signal(SIGINT, SIG_IGN);
}

}  // namespace homolog
