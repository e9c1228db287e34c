#include "app/editor/work/opening/recovery.h"

#include <array>
#include <chrono>
#include <ctime>
#include <fstream>
#include <string>

#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/session/journal.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

std::string date_of(const fs::path& journal) {
  std::error_code ignored;
  const auto on_system = std::chrono::file_clock::to_sys(fs::last_write_time(journal, ignored));
  const std::time_t seconds = std::chrono::system_clock::to_time_t(on_system);
  std::tm local{};
  localtime_r(&seconds, &local);
  std::array<char, 96> text{};
  std::strftime(text.data(), text.size(), "%d %B %Y, %H:%M", &local);
  return text.data();
}

/// The image that the first line names, else the template.
std::string name_in(const std::string& first_line) {
  const auto header = read_json<nlohmann::json>(first_line).value_or(nlohmann::json());
  if (!header.is_object()) return {};
  for (const char* part : {"volume", "template"}) {
    const auto found = header.find(part);
    if (found != header.end() && found->is_string() && !found->get_ref<const std::string&>().empty())
      return fs::path(found->get<std::string>()).filename().string();
  }
  return {};
}

/// Whether nobody is about to write to it: a case that was begun just now is not open yet for the blink of an eye.
bool left_alone(const fs::path& journal) {
  std::error_code error;
  const auto changed = fs::last_write_time(journal, error);
  return !error && fs::file_time_type::clock::now() - changed > std::chrono::minutes(1);
}

/// Whether all that was done is undone; a long file is not read for it.
bool is_undone(const fs::path& journal) {
  constexpr std::uintmax_t most_bytes = 1 << 16;
  std::error_code error;
  return fs::file_size(journal, error) <= most_bytes && !error && count_steps(journal) == 0;
}

}  // namespace

void Recovery::look() {
  work_.start("", [](Progress& progress) -> Result<Found> {
    std::error_code error;
    const fs::directory_iterator readable(unsaved_folder(), error);
    const bool can_be = !unsaved_folder().native().starts_with(no_home);  // else it is said where something is kept
    if (error && error != std::errc::no_such_file_or_directory && can_be)
      return fail(unsaved_folder().string(),
                  "the folder of unsaved cases cannot be read (" + error.message() + "); check its permissions");
    Found found;
    for (const UnsavedCase& one : unsaved_cases()) {
      if (progress.cancelled()) break;
      if (!one.edited) {
        if (left_alone(one.journal)) remove_without_edits(one.journal);
        continue;
      }
      if (is_undone(one.journal)) continue;
      std::string name = name_in(one.header);
      found.cases.push_back(
          {one.journal, name.empty() ? one.journal.filename().string() : std::move(name), date_of(one.journal)});
    }
    return found;
  });
}

void Recovery::count(Found found) {
  work_.start("", [found = std::move(found)](Progress& progress) mutable -> Result<Found> {
    for (RecoverDialog::Found& one : found.cases) {
      if (progress.cancelled()) break;
      const std::size_t edits = count_steps(one.journal);
      one.details = std::to_string(edits) + (edits == 1 ? " edit, " : " edits, ") + one.details;
    }
    found.counted = true;
    return std::move(found);
  });
}

bool discard_journal(const fs::path& journal) {
  if (Journal::in_use(journal)) return false;
  std::error_code ignored;
  fs::remove(journal, ignored);
  return true;
}

void remove_without_edits(const fs::path& journal) {
  if (journal.empty() || journal.parent_path() != unsaved_folder()) return;
  std::error_code ignored;
  const auto holds = unsaved_case(journal);
  if (holds && !holds->edited) fs::remove(journal, ignored);
}

}  // namespace homolog
