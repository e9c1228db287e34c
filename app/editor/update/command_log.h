#pragma once

#include <deque>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "app/editor/update/commands.h"

namespace homolog {

/// A command as a line of JSON, `{"do":"choose tool","tool":"slide"}`. Two commands are the same where their lines are.
std::string log_line(const Command& command);
/// The command of a line. Errors: no JSON, no known command, a member that is missing or of the wrong kind.
Result<Command> command_of_line(const std::string& line);

/// The commands of a log's file. Errors: no file, or a line that is no command, by its number.
Result<std::vector<Command>> read_log(const std::filesystem::path& path);

/// The commands of a session, in the order in which they took effect. Done again, each when the one before it is done,
/// they lead to the same case: so a fit, which is given up where the case changes meanwhile, is logged when it is
/// done, and one that was given up is not logged at all. Previews are not.
class CommandLog {
 public:
  /// From now on every line is also written to a file, at once, in place of an older log. Errors: it cannot be made, or
  /// holds something else.
  Result<void> write_to(const std::filesystem::path& path);
  /// A command that was given, and done unless its work goes on.
  void was_given(const Command& command);
  /// One that is logged when it is done, and is done now.
  void is_done(const Command& command) { add(log_line(command)); }

  /// The latest; of a long session no more than 10,000.
  const std::deque<std::string>& lines() const { return lines_; }
  /// Why the file does not get the lines any more, once; empty while it does.
  std::string take_fault() { return std::exchange(fault_, {}); }

 private:
  void add(std::string line);
  void write(const std::string& line);

  std::deque<std::string> lines_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::string fault_;
};

}  // namespace homolog
