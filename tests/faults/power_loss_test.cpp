#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "core/session/unsaved_cases.h"
#include "tests/faults/disk.h"

// A session of the window whose writes, syncs and renamings are recorded; then the power fails behind each of them.
// What was not synced may be lost: whole, in part, or so that zeros are in its place; names may be older than contents,
// or newer. Whatever is left, cases and studies open, and what the window had shown as done is in them.

namespace homolog {

namespace {

/// A file or a folder of the disk: what is on it for certain, and what it was asked for since.
struct Node {
  bool is_folder = false;
  std::string synced, now;
  std::vector<std::pair<std::size_t, std::string>> writes;  ///< since then; of a cut the new size, and nothing
};
using Names = std::map<fs::path, std::shared_ptr<Node>>;

enum class Loss {
  nothing,          ///< the program alone was stopped
  all,              ///< what was not synced: names too
  contents,         ///< names are on the disk before what they stand for
  half,             ///< of what was written
  zeros,            ///< in place of what was written
  all_but_removals  ///< what was removed is gone at once
};
constexpr std::array losses{Loss::nothing, Loss::all, Loss::contents, Loss::half, Loss::zeros, Loss::all_but_removals};

class Disk {
 public:
  /// As the folder is now.
  explicit Disk(const std::vector<fs::path>& folders) {
    for (const fs::path& folder : folders)
      for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        auto node = std::make_shared<Node>();
        node->is_folder = entry.is_directory();
        if (!node->is_folder) node->synced = node->now = test::must(read_whole_file(entry.path()));
        struct stat now {};
        REQUIRE(::stat(entry.path().c_str(), &now) == 0);
        nodes_[now.st_ino] = synced_names_[entry.path()] = names_[entry.path()] = node;
      }
  }

  void take(const disk_operation& done) {
    switch (done.call) {
      case disk_makes_file:
      case disk_makes_folder:
        removed_.erase(done.path);
        nodes_[done.file] = names_[done.path] = std::make_shared<Node>();
        names_[done.path]->is_folder = done.call == disk_makes_folder;
        break;
      case disk_writes: {
        Node& node = *nodes_.at(done.file);
        node.writes.emplace_back(done.at, std::string(done.bytes, done.size));
        write(node.now, node.writes.back());
        break;
      }
      case disk_cuts:
        nodes_.at(done.file)->writes.emplace_back(done.at, "");
        nodes_.at(done.file)->now.resize(done.at);
        break;
      case disk_syncs_file:
        nodes_.at(done.file)->synced = nodes_.at(done.file)->now;
        nodes_.at(done.file)->writes.clear();
        break;
      case disk_syncs_folder:
        sync_names(done.path);
        break;
      case disk_renames:
        names_[done.to] = names_.at(done.path);
        names_.erase(done.path);
        removed_.erase(done.to);
        break;
      case disk_removes:
        names_.erase(done.path);
        removed_.insert(done.path);
        break;
      case disk_mark:
        break;
    }
  }

  /// What a person finds afterwards.
  std::map<fs::path, std::string> files(Loss loss) const {
    std::map<fs::path, std::string> left;
    const bool old_names = loss == Loss::all || loss == Loss::all_but_removals;
    const Names& names = old_names ? synced_names_ : names_;
    for (const auto& [path, node] : names) {
      if (node->is_folder || (loss == Loss::all_but_removals && removed_.contains(path))) continue;
      bool reached = true;
      for (fs::path above = path.parent_path(); above != above.parent_path(); above = above.parent_path())
        reached = reached && (names.contains(above) || !names_.contains(above));
      if (reached) left[path] = content(*node, loss);
    }
    return left;
  }

 private:
  static void write(std::string& into, const std::pair<std::size_t, std::string>& bytes) {
    if (bytes.second.empty()) return into.resize(bytes.first);
    into.resize(std::max(into.size(), bytes.first + bytes.second.size()));
    into.replace(bytes.first, bytes.second.size(), bytes.second);
  }
  static std::string content(const Node& node, Loss loss) {
    if (loss == Loss::nothing) return node.now;
    std::string left = node.synced;
    if (loss == Loss::zeros && node.now.size() > left.size()) left.resize(node.now.size(), '\0');
    if (loss != Loss::half || node.writes.empty()) return left;
    const std::size_t half = node.writes.size() / 2;
    for (std::size_t k = 0; k < half; ++k) write(left, node.writes[k]);
    auto torn = node.writes[half];
    if (torn.second.empty()) return left;
    torn.second.resize((torn.second.size() + 1) / 2);
    write(left, torn);
    return left;
  }
  void sync_names(const fs::path& folder) {
    std::erase_if(synced_names_,
                  [&](const auto& one) { return one.first.parent_path() == folder && !names_.contains(one.first); });
    for (const auto& [path, node] : names_)
      if (path.parent_path() == folder) synced_names_[path] = node;
  }

  std::map<unsigned long, std::shared_ptr<Node>> nodes_;
  Names names_, synced_names_;
  std::set<fs::path> removed_;
};

/// What the window had shown as done.
struct Shown {
  fs::path case_file;
  std::string state;
  fs::path study_file;
  int note = 0;  ///< the number in the study's notes
};

/// What a file holds, read from the disk once for each content that it has.
class Contents {
 public:
  /// Of a case the states that it may have been in.
  const std::vector<std::string>& states(const fs::path& path, const std::string& bytes) {
    auto& known = states_[{path, bytes}];
    if (known.empty()) {
      put(path, bytes);
      known = states_of_file(path);
    }
    return known;
  }
  /// The number in a study's notes.
  int note(const fs::path& path, const std::string& bytes) {
    const auto [known, is_new] = notes_.try_emplace({path, bytes}, 0);
    if (!is_new) return known->second;
    put(path, bytes);
    const auto read = read_study(path);
    REQUIRE_MESSAGE(read, (read ? std::string() : read.error().sentence()));
    if (!read->study.cases.empty() && !read->study.cases.front().notes.empty())
      known->second = std::stoi(read->study.cases.front().notes);
    return known->second;
  }
  std::size_t count() const { return states_.size() + notes_.size(); }

 private:
  static void put(const fs::path& path, const std::string& bytes) {
    fs::create_directories(path.parent_path());
    fs::remove(path);
    write_bytes(path, bytes);
  }
  std::map<std::pair<fs::path, std::string>, std::vector<std::string>> states_;
  std::map<std::pair<fs::path, std::string>, int> notes_;
};

/// Says in the record what is shown now.
void mark(Driver& driver, int note) {
  driver.settle();
  std::ostringstream text;
  text << driver.case_file().string() << '\n'
       << state_of(driver.document()) << '\n'
       << driver.state().models.kept.file.string() << '\n'
       << note;
  disk_say(text.str().c_str());
}

Shown shown_in(const char* text) {
  std::istringstream lines(text);
  Shown shown;
  std::string line;
  std::getline(lines, line);
  shown.case_file = line;
  std::getline(lines, shown.state);
  std::getline(lines, line);
  shown.study_file = line;
  lines >> shown.note;
  return shown;
}

/// What a person does: every kind of writing that belongs to work.
void work(Driver& driver, const BallDesk& desk) {
  int note = 0;
  const auto write_note = [&] {
    const std::string name = driver.state().models.study.cases.front().name;
    driver.app().send(SetCaseText{name, "notes", std::to_string(++note)});
  };
  mark(driver, note);
  for (int k = 1; k < 4; ++k) {
    apply(driver, BallDesk::pull(k));
    mark(driver, note);
  }
  apply(driver, BallDesk::relax(1));
  for (int k = 2; k < 6; ++k) apply(driver, BallDesk::relax(k), true);
  rest(driver);
  mark(driver, note);
  driver.app().send(GoInHistory{-1});
  mark(driver, note);
  driver.app().send(SaveCaseAs{{desk.out / "saved.homolog"}});
  mark(driver, note);
  apply(driver, BallDesk::pull(7));
  mark(driver, note);
  driver.app().send(OpenStudy{{desk.study}});
  mark(driver, note);
  for (int k = 0; k < 3; ++k) {
    write_note();
    mark(driver, note);
  }
  driver.app().send(AddScans{{desk.scan}});
  mark(driver, note);
  driver.app().send(SaveStudyAs{{desk.out / "other.study.json"}});
  mark(driver, note);
  write_note();
  mark(driver, note);
  driver.app().send(OpenFiles{{desk.scan}});  // an unsaved case, in a folder that is made for it
  mark(driver, note);
  apply(driver, BallDesk::pull(8));
  mark(driver, note);
  driver.app().send(SaveCaseAs{{desk.out / "second.homolog"}});
  mark(driver, note);
  apply(driver, BallDesk::pull(9));
  mark(driver, note);
}

void check_what_is_left(const std::map<fs::path, std::string>& files, const std::optional<Shown>& shown,
                        const std::optional<Shown>& next, Contents& contents) {
  for (const auto& [path, bytes] : files) {
    INFO(path.string());
    if (path.extension() == ".homolog") contents.states(path, bytes);
    if (path.native().ends_with(".study.json")) contents.note(path, bytes);
  }
  if (!shown) return;
  // While it goes on under another name, both hold it, and then the new one.
  const fs::path file = files.contains(shown->case_file) || !next ? shown->case_file : next->case_file;
  INFO(file.string());
  REQUIRE(files.contains(file));
  const auto& states = contents.states(file, files.at(file));
  CHECK_MESSAGE(std::find(states.begin(), states.end(), shown->state) != states.end(), "what was shown is lost");
  if (shown->study_file.empty()) return;
  REQUIRE(files.contains(shown->study_file));
  CHECK(contents.note(shown->study_file, files.at(shown->study_file)) >= shown->note);
}

}  // namespace

TEST_CASE("where the power fails at any moment of a session cases and studies open with what was shown as done") {
  const WatchedDisk watched;
  const BallDesk desk;
  Driver driver(desk.document());
  rest(driver);
  const std::vector<fs::path> folders{desk.folder.path, driver.folder()};
  Disk disk(folders);
  disk_record(1);
  work(driver, desk);
  disk_record(0);
  driver.app().start_session(EditSession(new_document({}, nullptr, nullptr)));  // lets go of the files
  std::size_t count = 0;
  const disk_operation* done = disk_recorded(&count);
  REQUIRE(count > 60);
  std::optional<Shown> shown;
  Contents contents;
  int cuts = 0;
  for (std::size_t k = 0; k < count; ++k) {
    disk.take(done[k]);
    if (done[k].call == disk_mark) shown = shown_in(done[k].bytes);
    std::optional<Shown> next;
    for (std::size_t later = k + 1; later < count && !next; ++later)
      if (done[later].call == disk_mark) next = shown_in(done[later].bytes);
    for (std::size_t which = 0; which < losses.size(); ++which) {
      INFO("behind operation ", k, " of ", count, ", loss ", which);
      const auto files = disk.files(losses[which]);
      check_what_is_left(files, shown, next, contents);
      ++cuts;
    }
  }
  MESSAGE(cuts, " cuts of ", count, " operations; ", contents.count(), " different files were read");
}

}  // namespace homolog
