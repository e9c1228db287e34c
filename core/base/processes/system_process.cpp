#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <string>

#include "core/base/processes/process.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

std::mutex& only_one_is_silent() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

void prepare_process() {
  // The descriptor that takes the place of a closed stream cannot be written to, so that printing fails as it should.
  int taken = 0;
  do taken = ::open("/dev/null", O_RDONLY);
  while (taken >= 0 && taken <= STDERR_FILENO);
  if (taken > STDERR_FILENO) ::close(taken);
  std::signal(SIGXFSZ, SIG_IGN);
}

long process_number() {
  return ::getpid();
}

fs::path program_file() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none);
}

void become_program(const fs::path& program, char** argv) {
  ::execv(program.c_str(), argv);
}

namespace {

/// Whether the program is there and ended with status 0. `prints_to`: a file descriptor; negative: nowhere.
bool ran(const std::vector<std::string>& words, int prints_to) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  if (::posix_spawn_file_actions_init(&files) != 0) return false;
  ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  if (prints_to < 0)
    ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  else
    ::posix_spawn_file_actions_adddup2(&files, prints_to, STDOUT_FILENO);
  ::posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = -1;
  const int error = ::posix_spawnp(&process, argv.front(), &files, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  if (error != 0) return false;
  int status = 0;
  while (::waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return false;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

bool run_silently(const std::vector<std::string>& words) {
  return ran(words, -1);
}

std::optional<std::string> printed_by(const std::vector<std::string>& words) {
  std::FILE* const file = std::tmpfile();
  if (file == nullptr) return std::nullopt;
  std::optional<std::string> printed;
  if (ran(words, ::fileno(file))) {
    printed.emplace();
    std::rewind(file);
    std::array<char, 4096> part{};
    std::size_t count = 0;
    do {
      count = std::fread(part.data(), 1, part.size(), file);
      printed->append(part.data(), count);
    } while (count == part.size());
  }
  std::fclose(file);
  return printed;
}

double thread_core_ms() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

bool errors_are_seen() {
  return ::isatty(STDERR_FILENO) != 0;
}

SilencedErrors::SilencedErrors() : lock_(only_one_is_silent()) {
  std::fflush(stderr);
  before_ = ::dup(STDERR_FILENO);
  if (before_ < 0) return;  // all that is printed then can be borne: nothing could bring it back
  if (const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
    ::dup2(nowhere, STDERR_FILENO);
    ::close(nowhere);
  }
}

SilencedErrors::~SilencedErrors() {
  std::fflush(stderr);
  if (before_ < 0) return;
  ::dup2(before_, STDERR_FILENO);
  ::close(before_);
}

ScratchFolder::ScratchFolder(const char* name)
    : path(fs::temp_directory_path() / (name + ("-" + std::to_string(process_number())))) {
  std::error_code ignored;  // told by what is written there
  fs::create_directories(path, ignored);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

}  // namespace homolog
