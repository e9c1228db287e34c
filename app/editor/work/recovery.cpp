#include "app/editor/work/recovery.h"

#include <array>
#include <chrono>
#include <ctime>
#include <fstream>
#include <string>

#include "core/base/json.h"
#include "core/case/case_file.h"

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

}  // namespace

std::vector<RecoverDialog::Found> cases_to_recover() {
  std::vector<RecoverDialog::Found> found;
  for (const fs::path& journal : unsaved_cases()) {
    std::ifstream file(journal);
    std::string line;
    std::getline(file, line);
    std::string name = name_in(line);
    int edits = 0;
    while (std::getline(file, line)) ++edits;
    found.push_back({journal, name.empty() ? journal.filename().string() : std::move(name),
                     std::to_string(edits) + (edits == 1 ? " edit, " : " edits, ") + date_of(journal)});
  }
  return found;
}

void remove_without_edits(const fs::path& journal) {
  std::error_code ignored;
  if (journal.parent_path() != unsaved_folder() || !fs::is_regular_file(journal, ignored)) return;
  std::ifstream file(journal);
  std::string line;
  const bool edited = std::getline(file, line) && std::getline(file, line);
  if (file.is_open() && !edited) fs::remove(journal, ignored);
}

void remove_all_without_edits() {
  std::error_code error;
  std::vector<fs::path> journals;
  for (fs::directory_iterator entry(unsaved_folder(), error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".homolog" && !Journal::in_use(entry->path())) journals.push_back(entry->path());
  for (const fs::path& journal : journals) remove_without_edits(journal);
}

}  // namespace homolog
