#include "app/verbs/integrate.h"

#include <array>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "core/base/encoding/json.h"
#include "core/base/encoding/sha256.h"
#include "core/base/files/files.h"
#include "core/base/processes/process.h"

// homolog --integrate: the menu entry, the icon and the file types of a program that no package installed.

extern "C" {
extern const unsigned char homolog_desktop_desktop[], homolog_desktop_svg[], homolog_desktop_thumbnailer[],
    homolog_desktop_mime[];
extern const std::size_t homolog_desktop_desktop_size, homolog_desktop_svg_size, homolog_desktop_thumbnailer_size,
    homolog_desktop_mime_size;
}

namespace homolog {

namespace {

namespace fs = std::filesystem;

std::string desktop_asset(const unsigned char* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

/// Where the files lie, below the user's folder of data.
constexpr std::array<const char*, 4> desktop_names{"applications/homolog.desktop",
                                                   "icons/hicolor/scalable/apps/homolog.svg",
                                                   "mime/packages/homolog.xml", "thumbnailers/homolog.thumbnailer"};
/// What was written, so that it can be taken away again.
constexpr const char* desktop_record = "homolog/integrated.json";

/// $XDG_DATA_HOME; as its specification says, one that is no absolute path does not count.
fs::path desktop_home() {
  const char* set = std::getenv("XDG_DATA_HOME");
  const fs::path own = set != nullptr ? set : "";
  return own.is_absolute() ? own : home_folder() / ".local/share";
}

/// What starts this program: of the portable archive the script that finds its libraries.
fs::path program_to_start() {
  const fs::path program = program_file(), folder = program.parent_path();
  std::error_code none;
  const fs::path script = folder.parent_path() / "homolog";
  return folder.filename() == "lib" && fs::is_regular_file(script, none) ? script : program;
}

/// The menu entry of the package that this program belongs to, where the desktop looks for it; empty where it is of no
/// package.
fs::path entry_of_package() {
  const fs::path folder = program_file().parent_path();
  if (folder.parent_path().filename() != "libexec") return {};
  const fs::path share = folder.parent_path().parent_path() / "share", entry = share / desktop_names[0];
  const char* set = std::getenv("XDG_DATA_DIRS");
  const std::string searched = set != nullptr && *set != '\0' ? set : "/usr/local/share:/usr/share";
  std::error_code none;
  if (!fs::exists(entry, none)) return {};
  std::istringstream folders(searched + ":" + desktop_home().string());
  for (std::string folder_of_data; std::getline(folders, folder_of_data, ':');)
    if (fs::equivalent(folder_of_data, share, none)) return entry;
  return {};
}

/// A path as one word of a line Exec. Letters that a shell would read are escaped; each backslash is doubled once more,
/// as in every text of such a file.
std::string exec_word(const std::string& path) {
  std::string word = "\"";
  for (const char letter : path) {
    if (std::string_view("\"`$\\").find(letter) != std::string_view::npos) word += "\\\\";
    if (letter == '\\' || letter == '%') word += letter;
    word += letter;
  }
  return word + '"';
}

/// `text` with `to` in place of `from`, which it holds once.
std::string with_word(std::string text, std::string_view from, const std::string& to) {
  if (const auto at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

/// A text of an entry that is no command.
std::string entry_text(const std::string& path) {
  std::string text;
  for (const char letter : path) text += letter == '\\' ? "\\\\" : std::string(1, letter);
  return text;
}

/// The files that belong to a program, by their names.
std::map<std::string, std::string> desktop_files(const fs::path& program) {
  const std::string path = program.string(), tries = "TryExec=" + entry_text(path) + "\n";
  return {{desktop_names[0], with_word(desktop_asset(homolog_desktop_desktop, homolog_desktop_desktop_size),
                                       "Exec=homolog ", tries + "Exec=" + exec_word(path) + " ")},
          {desktop_names[1], desktop_asset(homolog_desktop_svg, homolog_desktop_svg_size)},
          {desktop_names[2], desktop_asset(homolog_desktop_mime, homolog_desktop_mime_size)},
          {desktop_names[3],
           with_word(with_word(desktop_asset(homolog_desktop_thumbnailer, homolog_desktop_thumbnailer_size),
                               "' homolog %i", "' " + exec_word(path) + " %i"),
                     "TryExec=homolog\n", tries)}};
}

/// What an earlier integration wrote.
struct IntegrationRecord {
  bool found = false;
  std::map<std::string, std::string> sums;  ///< SHA-256 of each file
  std::set<std::string> folders;            ///< that were not there before
};

IntegrationRecord read_integration(const fs::path& home) {
  IntegrationRecord record;
  const auto text = read_whole_file(home / desktop_record, 1 << 20);
  const auto json = text ? read_json<nlohmann::json>(*text) : fail(text.error());
  if (!json || !json->is_object()) return record;
  record.found = true;
  const auto texts = [](const nlohmann::json& object, const char* key, const auto& take) {
    if (const auto at = object.find(key); at != object.end())
      for (const auto& [name, value] : at->items())
        if (value.is_string()) take(name, value.template get<std::string>());
  };
  texts(*json, "files", [&](const std::string& name, const std::string& sum) { record.sums[name] = sum; });
  texts(*json, "folders", [&](const std::string&, const std::string& folder) { record.folders.insert(folder); });
  return record;
}

Result<void> write_integration(const fs::path& home, const fs::path& program, const IntegrationRecord& record) {
  const Json json{{"program", program.string()}, {"files", record.sums}, {"folders", record.folders}};
  return write_whole_file(home / desktop_record, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// The folders above a file, below `home`, the deepest first.
std::vector<std::string> folders_above(const std::string& name) {
  std::vector<std::string> folders;
  for (fs::path above = fs::path(name).parent_path(); !above.empty(); above = above.parent_path())
    folders.push_back(above.string());
  return folders;
}

/// Brings the caches of the system's tools up to date, where they are. An icon cache is only renewed: a new one would
/// hide icons that are added later.
Json update_desktop(const fs::path& home) {
  Json updated = Json::array();
  const auto update = [&](const std::vector<std::string>& words) {
    if (run_silently(words)) updated.push_back(words.front());
  };
  std::error_code none;
  if (fs::exists(home / "applications", none)) update({"update-desktop-database", (home / "applications").string()});
  if (fs::exists(home / "mime/packages", none)) update({"update-mime-database", (home / "mime").string()});
  const fs::path icons = home / "icons/hicolor";
  if (fs::exists(icons / "icon-theme.cache", none)) update({"gtk-update-icon-cache", "-f", "-t", "-q", icons.string()});
  return updated;
}

/// Refuses where a file that no integration wrote lies in the place of one.
Result<void> check_place(const fs::path& home, const std::string& name, const std::string& content,
                         const IntegrationRecord& before) {
  std::error_code none;
  const fs::path path = home / name;
  if (!fs::exists(fs::symlink_status(path, none))) return {};
  const auto now = read_whole_file(path);
  if (!now) return fail(now.error());
  if (*now == content) return {};
  const auto sum = sha256_of(*now);
  const auto known = before.sums.find(name);
  if (sum && known != before.sums.end() && known->second == *sum) return {};
  return fail(path.string(), "was not written by --integrate, or was changed since; move it away first");
}

/// Writes the files and their record. Those that were new are taken away again where a later one fails.
Result<Json> write_integration_files(const fs::path& home, const fs::path& program, IntegrationRecord record) {
  const auto files = desktop_files(program);
  Json written = Json::array();
  std::error_code none;
  for (const auto& [name, content] : files)
    if (auto free = check_place(home, name, content, record); !free) return fail(free.error());
  std::vector<ResultFolder> made;
  std::vector<fs::path> fresh;
  const auto write_all = [&]() -> Result<void> {
    for (const auto& [name, content] : files) {
      for (const std::string& folder : folders_above(name))
        if (!fs::exists(home / folder, none)) record.folders.insert(folder);
      auto folder = ResultFolder::make((home / name).parent_path());
      if (!folder) return fail(folder.error());
      made.push_back(std::move(*folder));
      const bool is_new = !fs::exists(home / name, none);
      if (auto done = write_whole_file(home / name, content); !done) return done;
      if (is_new) fresh.push_back(home / name);
      const auto sum = sha256_of(content);
      if (!sum) return fail(sum.error());
      record.sums[name] = *sum;
      written.push_back((home / name).string());
    }
    if (!fs::exists((home / desktop_record).parent_path(), none)) record.folders.insert("homolog");
    if (auto folder = make_folder((home / desktop_record).parent_path()); !folder) return folder;
    return write_integration(home, program, record);
  };
  if (auto done = write_all(); !done) {
    for (const fs::path& path : fresh) fs::remove(path, none);
    return fail(done.error());
  }
  return written;
}

}  // namespace

Result<Report> integrate_desktop() {
  Report report;
  if (const fs::path entry = entry_of_package(); !entry.empty()) {
    report.values["already"] = "a package put this Homolog into the menu (" + entry.string() + "); nothing was written";
    return report;
  }
  const fs::path home = desktop_home(), program = program_to_start();
  if (program.empty()) return fail("", "the system does not say where this program lies; start it by its full path");
  const auto written = write_integration_files(home, program, read_integration(home));
  if (!written) return fail(written.error());
  report.values["program"] = program.string();
  report.values["written"] = *written;
  report.values["updated"] = update_desktop(home);
  return report;
}

Result<Report> leave_desktop() {
  const fs::path home = desktop_home();
  const IntegrationRecord record = read_integration(home);
  Report report;
  report.values["removed"] = Json::array();
  std::error_code error;
  const auto remove = [&](const fs::path& path) -> Result<void> {
    if (fs::remove(path, error)) report.values["removed"].push_back(path.string());
    if (error)
      return fail(path.string(), "cannot be removed (" + error.message() + "); check the rights of its folder");
    return {};
  };
  for (const char* name : desktop_names) {
    const auto known = record.sums.find(name);
    const auto now = sha256_of_file(home / name);
    if (known == record.sums.end() || !now) continue;
    if (*now != known->second) {
      report.warnings.push_back((home / name).string() + ": was changed since, and stays; remove it by hand");
    } else if (auto gone = remove(home / name); !gone) {
      return fail(gone.error());
    }
  }
  if (!record.found) return report;
  report.values["updated"] = update_desktop(home);
  if (auto gone = remove(home / desktop_record); !gone) return fail(gone.error());
  std::set<std::string> possible{"homolog"};
  for (const char* name : desktop_names)
    for (const std::string& folder : folders_above(name)) possible.insert(folder);
  // Their names in reverse have the deepest first. Only empty ones go.
  for (auto folder = record.folders.rbegin(); folder != record.folders.rend(); ++folder)
    if (possible.contains(*folder)) fs::remove(home / *folder, error);
  return report;
}

}  // namespace homolog
