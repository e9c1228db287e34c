#pragma once

#include <doctest/doctest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/base/files/files.h"
#include "tests/skip.h"
#include "tests/small_files.h"
#include "tests/temporary_folder.h"

namespace homolog {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Ran {
  int status = -1;
  std::string out, errors;
  Json json() const { return Json::parse(out, nullptr, false); }
};

/// Runs a command as a shell would, without a display. `before`: what the shell runs it by ("timeout 20 ").
inline Ran run_command(const TemporaryFolder& folder, const std::string& command_line, const std::string& before = "") {
  const fs::path errors = folder.path / "stderr";
  const std::string command = "cd '" + folder.path.string() + "' && " + before + "env -u DISPLAY -u WAYLAND_DISPLAY " +
                              command_line + " 2>'" + errors.string() + "' </dev/null";
  FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  Ran ran;
  std::array<char, 4096> buffer{};
  for (std::size_t got = 0; (got = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    ran.out.append(buffer.data(), got);
  const int status = ::pclose(pipe);
  ran.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  ran.errors = read_whole_file(errors).value_or("");
  return ran;
}

/// Runs the program.
inline Ran run(const TemporaryFolder& folder, const std::string& arguments, const std::string& before = "") {
  return run_command(folder, "'" HOMOLOG_PROGRAM "' " + arguments, before);
}

/// Runs the laboratory.
inline Ran run_lab(const TemporaryFolder& folder, const std::string& arguments) {
  return run_command(folder, "'" HOMOLOG_PROGRAM "-lab' " + arguments);
}

/// Runs the program on a disk where no file grows beyond `most_bytes`.
inline Ran run_on_full_disk(const TemporaryFolder& folder, const std::string& arguments, rlim_t most_bytes) {
  const SmallFilesOnly full(most_bytes);
  return run(folder, arguments);
}

/// The bytes of a PLY without the record of how it was made: two commands may make the same mesh.
inline std::string without_record(std::string bytes) {
  const std::string key = "comment homolog.record ";
  for (std::size_t at = bytes.find(key); at != std::string::npos; at = bytes.find(key, at))
    bytes.erase(at, bytes.find('\n', at) + 1 - at);
  return bytes;
}

inline std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// A refusal: status 1, nothing on stdout, one line on stderr that starts as the contract says and names `subject`.
inline void check_refused(const Ran& ran, const std::string& subject) {
  INFO(ran.errors);
  CHECK(ran.status == 1);
  CHECK(ran.out.empty());
  CHECK(lines(ran.errors) == 1);
  CHECK(ran.errors.rfind("homolog: ", 0) == 0);
  CHECK(ran.errors.find(subject) != std::string::npos);
}

/// Whether the program refused because the machine cannot draw; the test is skipped then.
inline bool cannot_draw(const Ran& ran) {
  if (ran.status != 1 || ran.errors.find("OpenGL") == std::string::npos) return false;
  test::skip(ran.errors);
  return true;
}

}  // namespace homolog
