#include "app/editor/update/command_log.h"

#include <cerrno>
#include <cstring>
#include <sstream>
#include <utility>

#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/case/action_json.h"
#include "core/case/actions/fields.h"

namespace homolog {

namespace {

using Json = Fields::Json;

template <class One>
void read_where_it_is(const Json& line, const std::string& key, std::optional<Command>& read) {
  if (read || key != One::key) return;
  One command;
  Fields members = Fields::reader(line);
  if constexpr (requires { command.spell(members); }) command.spell(members);
  read = std::move(command);
}

template <class... Listed>
Command read_command(const Json& line, TypeList<Listed...>) {
  const auto key = line.at("do").get<std::string>();
  std::optional<Command> read;
  (read_where_it_is<Listed>(line, key, read), ...);
  if (!read) throw Unreadable{"\"" + excerpt(key) + "\" is no command"};
  return std::move(*read);
}

}  // namespace

std::string log_line(const Command& command) {
  Json line = Json::object();
  line["do"] = command.key();
  Fields members = Fields::writer(line);
  command.write(members);
  return dumped(line);
}

Result<Command> command_of_line(const std::string& line) {
  const auto json = read_json<Json>(line);
  if (!json) return fail(json.error());
  return caught([&] { return read_command(*json, AllCommands()); });
}

Result<std::vector<Command>> read_log(const std::filesystem::path& path) {
  auto content = read_whole_file(path, std::uintmax_t{1} << 25);
  if (!content) return fail(content.error());
  std::vector<Command> commands;
  std::istringstream lines(std::move(*content));
  for (std::string line; std::getline(lines, line);) {
    auto command = command_of_line(line);
    if (!command)
      return fail(path.string(), "line " + std::to_string(commands.size() + 1) +
                                     " is not a command: " + command.error().what + "; give a file that --log wrote");
    commands.push_back(std::move(*command));
  }
  return commands;
}

Result<void> CommandLog::write_to(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !read_log(path))
    return fail(path.string(), "exists already and is not a log of commands; give another name");
  path_ = path;
  file_.open(path, std::ios::trunc);
  if (!file_) return fail(path.string(), std::string("cannot be written: ") + std::strerror(errno));
  for (const std::string& line : lines_) write(line);
  return {};
}

void CommandLog::was_given(const Command& command) {
  if (command.logged() == Logged::at_once) add(log_line(command));
}

void CommandLog::add(std::string line) {
  if (file_.is_open()) write(line);
  constexpr std::size_t most_lines = 10000;
  lines_.push_back(std::move(line));
  if (lines_.size() > most_lines) lines_.pop_front();
}

void CommandLog::write(const std::string& line) {
  if ((file_ << line << '\n').flush()) return;
  fault_ = path_.string() + ": the log ends here, because no more could be written (" + std::strerror(errno) +
           "); free some space and start again with --log.";
  file_.close();
}

}  // namespace homolog
