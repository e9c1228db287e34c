#include "app/verbs/record.h"

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <set>

#include "app/verbs/case_table.h"
#include "app/verbs/files_named.h"
#include "app/verbs/help_page.h"
#include "app/version.h"
#include "core/base/encoding/json.h"
#include "core/base/encoding/sha256.h"
#include "core/base/files/file_record.h"
#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/catalogue/catalogue.h"
#include "core/model/shapes/shape_folder.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "core/structures/built_in_set.h"
#include "core/volume/labels/label_tables.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

const std::array recorded_verbs{
    RecordedVerb{"fit",
                 {"TEMPLATE", "--mask", "--mesh", "--image", "--contours", "--placement", "--landmarks", "--model"},
                 "--output",
                 {}},
    RecordedVerb{"template", {"MASK", "--consensus", "--best-of", "--landmarks"}, "--output", {}},
    RecordedVerb{"model", {"SHAPE"}, "--output", {"--csv", "--aligned", "--optimised"}},
    RecordedVerb{"snap", {"MESH|CASE", "--image"}, "--output", {}},
    RecordedVerb{"replay", {"CASE"}, "--output", {}},
    RecordedVerb{"propagate", {"MESH", "--image"}, "--output", {}},
    RecordedVerb{"convert", {"IN", "--like"}, "OUT", {}},
    RecordedVerb{"mirror", {"TEMPLATE"}, "--output", {}},
    RecordedVerb{"label-map", {"MESH", "--like"}, "--output", {}},
    RecordedVerb{"repair-mesh", {"IN"}, "--output", {}},
    RecordedVerb{"repair", {"MAP", "--templates", "--model", "--image"}, "--output", {}},
    RecordedVerb{"set make", {"MAP", "--like"}, "--output", {}},
    RecordedVerb{"set add", {"SET", "MAP"}, "--output", {}},
    RecordedVerb{"set rename", {"SET"}, "--output", {}},
    RecordedVerb{"set share", {"SET"}, "--output", {}},
    RecordedVerb{"study make", {"CSV|MASK", "--template"}, "--output", {}},
    RecordedVerb{"score", {"NEW", "--model", "--landmarks", "--template"}, "--output", {}},
    RecordedVerb{
        "test", {"SHAPE", "--covariates", "--permutation-file", "--templates", "--without-direction"}, "--csv", {}},
    RecordedVerb{"evaluate", {"SHAPE"}, "--csv", {}},
    RecordedVerb{
        "measure", {"SHAPE", "--recipe", "--template", "--landmarks", "--image", "--model"}, "--csv", {"--profiles"}},
    RecordedVerb{"tets", {"TETS", "SHAPE", "--template"}, "--output", {}},
    RecordedVerb{"landmarks", {"SHAPE"}, "--output", {}},
    RecordedVerb{"observers", {"FIRST", "SECOND"}, "--csv", {}},
    RecordedVerb{"report", {"SHAPE", "--recipe", "--template", "--left-out"}, "--output", {}},
    RecordedVerb{"picture correspondence", {"SHAPE"}, "--output", {}},
    RecordedVerb{"picture modes", {"MODEL"}, "--output", {}},
    RecordedVerb{"picture case", {"CASE"}, "--output", {}},
    RecordedVerb{"picture window", {"CASE"}, "--output", {}},
    RecordedVerb{"picture study", {"STUDY"}, "--output", {}},
    RecordedVerb{"picture map", {"MESH", "--values"}, "--output", {}},
    RecordedVerb{"picture groups", {"SHAPE", "--covariates", "--against"}, "--output", {}},
    RecordedVerb{"picture score", {"SHAPE", "--model"}, "--output", {}},
    RecordedVerb{"picture plot", {"FILE"}, "--output", {}},
};

std::string ascii_text(const Json& json) {
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

/// Whether a folder that it is given stands for the shapes in it. Of a verb of template sets --templates is a file.
bool of_shapes(std::string_view option) {
  return option == "SHAPE" || option == "--against" || option == "--templates";
}

bool changes_no_byte(const std::string& name) {
  return name == "--json" || name == "--quiet" || name == "--jobs" || name == "--help";
}

/// SHA-256 of a file. Several records of one run name the same inputs, of which images are large: each is read once.
Result<std::string> known_sum(const fs::path& path, std::uintmax_t bytes, Progress* progress) {
  struct Sum {
    std::uintmax_t bytes;
    fs::file_time_type written;
    std::string sha256;
  };
  static std::mutex mutex;
  static std::map<std::string, Sum> sums;
  std::error_code error;
  const auto written = fs::last_write_time(path, error);
  const std::string name = absolute_path(path).string();
  if (!error) {
    const std::lock_guard lock(mutex);
    const auto known = sums.find(name);
    if (known != sums.end() && known->second.bytes == bytes && known->second.written == written)
      return known->second.sha256;
  }
  auto sum = sha256_of_file(path, progress);
  if (!sum || error) return sum;
  const std::lock_guard lock(mutex);
  sums[name] = {bytes, written, *sum};
  return sum;
}

/// What has to be known of a command to tell its inputs.
struct InputReader {
  bool shapes_alone = false;         ///< a folder stands for the shapes in it
  bool label_names = false;          ///< labels are chosen by names, which a file beside a label map may give
  bool of_table = false;             ///< a table names files of cases
  std::string row{};                 ///< the case of such a table that counts; empty: all
  std::set<std::string> of_cases{};  ///< of a folder's files those that are called as these cases; empty: all
  Progress* progress = nullptr;

  Result<Json> read(const fs::path& path, int depth = 0) const {
    std::error_code none;
    if (fs::is_directory(path, none)) return read_folder(path, depth > 0);
    const auto bytes = size_of_file(path);
    if (!bytes) return fail(bytes.error());
    auto sum = known_sum(path, *bytes, progress);
    if (!sum) return fail(sum.error());
    Json input{{"file", path.filename().string()}, {"bytes", *bytes}, {"sha256", std::move(*sum)}};
    Json names = Json::array();
    if (of_table && depth == 0 && is_case_table(path))
      if (auto read = read_table(path, names); !read) return fail(read.error());
    if (depth < deepest && !is_case_table(path))
      for (const std::string& name : files_named_in(path)) {
        const fs::path named = resolved_source(absolute_path(path).parent_path(), name);
        auto one = fs::exists(named, none) ? read(named, depth + 1) : Result<Json>(Json());
        if (!one) return one;
        names.push_back(std::move(*one));
      }
    if (label_names && looks_like_volume(path))
      if (const fs::path beside = label_names_beside(path); !beside.empty()) {
        auto one = read(beside, deepest);
        if (!one) return one;
        input["label_names"] = std::move(*one);
      }
    if (!names.empty()) input["names"] = std::move(names);
    return input;
  }

 private:
  /// A study names cases, which name images; deeper than that is a circle.
  static constexpr int deepest = 4;

  /// What a table names. Of one case: by its place among all that the table names.
  Result<void> read_table(const fs::path& path, Json& names) const {
    const auto all = files_of_table(path);
    if (!row.empty()) names = Json::object();
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!row.empty() && all[k].of_case != row) continue;
      auto one = read(resolved_source(absolute_path(path).parent_path(), all[k].file), 1);
      if (!one) return fail(one.error());
      if (row.empty())
        names.push_back(std::move(*one));
      else
        names[std::to_string(k)] = std::move(*one);
    }
    return {};
  }

  bool counts(const fs::path& path, bool of_image) const {
    if (path.filename().string().starts_with('.') || is_record_file(path)) return false;
    if (of_image && (is_case_file(path) || is_study_file(path))) return false;
    if (!of_cases.empty() && !of_cases.contains(file_stem(path))) return false;
    return !shapes_alone || keeps_numbers(path) || is_case_file(path);
  }

  /// `of_image`: a file names the folder, as a case does its DICOM series. Cases that lie beside the slices are no part
  /// of it, and no file in it is followed: a case that names its own folder would be read without end.
  Result<Json> read_folder(const fs::path& folder, bool of_image) const {
    std::vector<fs::path> entries;
    std::error_code error;
    for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
         entry.increment(error))
      if (std::error_code none; (entry->is_directory(none) && !entry->is_symlink(none)) ||  // links may go in circles
                                (entry->is_regular_file(none) && counts(entry->path(), of_image)))
        entries.push_back(entry->path());
    if (error) return fail(folder.string(), "cannot be read (" + error.message() + "); check its rights");
    std::ranges::sort(entries);
    Json files = Json::array();
    for (const fs::path& entry : entries) {
      auto one = read(entry, of_image ? deepest : 0);
      if (!one) return one;
      if (one->contains("files") && (*one)["files"].empty()) continue;
      files.push_back(std::move(*one));
    }
    return Json{{"folder", absolute_path(folder / "x").parent_path().filename().string()}, {"files", files}};
  }
};

/// A folder of shapes of one structure stands for its shapes.
GivenCommand with_shapes_opened(const GivenCommand& command) {
  const auto given = [&](std::string_view name) {
    return std::ranges::find(command.options, name, &GivenOption::name) != command.options.end();
  };
  if (command.verb != "model" || given("--structures")) return command;
  std::vector<fs::path> shapes;
  for (const GivenOption& option : command.options) {
    if (option.name != "SHAPE") continue;
    for (const fs::path path : option.values) {
      std::error_code none;
      auto within = fs::is_directory(path, none) ? shapes_in_folder(path) : Result<std::vector<fs::path>>({path});
      if (within) shapes.insert(shapes.end(), within->begin(), within->end());
    }
  }
  return command.with("SHAPE", shapes);
}

/// The cases of a fit, by whose names landmarks are found in a folder. Empty: a folder of cases is given.
std::set<std::string> cases_of_fit(const GivenCommand& command) {
  std::set<std::string> names;
  if (command.verb != "fit") return names;
  for (const GivenOption& option : command.options) {
    if (option.name != "--mask" && option.name != "--mesh") continue;
    for (const fs::path path : option.values) {
      std::error_code none;
      if (fs::is_directory(path, none)) return {};
      names.insert(file_stem(path));
    }
  }
  return names;
}

/// Whether labels are meant by their names: by --label or --labels, by those of a template set, or to be those of one.
bool asks_for_names(const GivenCommand& command) {
  return std::ranges::any_of(command.options, [](const GivenOption& option) {
    if (option.name == "TEMPLATE" || option.name == "--templates") return names_set(option.values.front());
    if (option.name == "SET" || option.name == "--all") return true;
    return (option.name == "--label" || option.name == "--labels") &&
           option.values.front().find_first_not_of("0123456789,") != std::string::npos;
  });
}

}  // namespace

bool RecordedVerb::reads(std::string_view option) const {
  return std::ranges::find(inputs, option) != inputs.end();
}

bool RecordedVerb::writes(std::string_view option) const {
  return option == output || std::ranges::find(beside, option) != beside.end();
}

const RecordedVerb* recorded_verb(std::string_view name) {
  const auto found = std::ranges::find(recorded_verbs, name, &RecordedVerb::name);
  return found != recorded_verbs.end() ? &*found : nullptr;
}

GivenCommand GivenCommand::with(std::string_view option, const std::vector<fs::path>& values) const {
  GivenCommand other = *this;
  for (GivenOption& one : other.options) {
    if (one.name != option) continue;
    one.values.clear();
    for (const fs::path& value : values) one.values.push_back(value.string());
  }
  if (values.empty()) std::erase_if(other.options, [&](const GivenOption& one) { return one.name == option; });
  return other;
}

GivenCommand given_command(const CLI::App& verb) {
  GivenCommand command{full_name(verb), {}};
  const RecordedVerb* known = recorded_verb(command.verb);
  for (const CLI::Option* option : verb.get_options()) {
    const std::string name = option->get_name();
    if (name == "--recipe" && option->count() == 0 && verb.count("--template") > 0)
      if (std::string beside = recipe_of_template(verb.get_option("--template")->as<std::string>()); !beside.empty())
        command.options.push_back({name, {std::move(beside)}});
    if (option->count() == 0 || changes_no_byte(name) || (known != nullptr && known->writes(name))) continue;
    GivenOption given{name, {}};
    if (option->get_items_expected_max() > 0) given.values = option->results();
    if (const char delimiter = option->get_delimiter(); delimiter != '\0' && given.values.size() > 1) {
      std::string joined;
      for (const std::string& value : given.values) joined += (joined.empty() ? "" : std::string(1, delimiter)) + value;
      given.values = {joined};
    }
    command.options.push_back(std::move(given));
  }
  return command;
}

Result<std::string> record_of(const GivenCommand& given, Progress& progress) {
  const RecordedVerb* known = recorded_verb(given.verb);
  if (known == nullptr)
    return fail(given.verb,
                "has no row in recorded_verbs of app/verbs/record.cpp, so no record can be made; add its row");
  const GivenCommand command = with_shapes_opened(given);
  const bool of_names = asks_for_names(command);
  const auto one_row = std::ranges::find(command.options, std::string_view("--case"), &GivenOption::name);
  const std::string row = one_row != command.options.end() ? one_row->values.front() : std::string();
  Json options = Json::object();
  for (const GivenOption& option : command.options) {
    InputReader reader{of_shapes(option.name), of_names, option.name == "CSV|MASK", row};
    reader.progress = &progress;
    if (option.name == "--landmarks") reader.of_cases = cases_of_fit(command);
    Json values = option.values.empty() ? Json(true) : Json::array();
    for (const std::string& value : option.values) {
      std::error_code none;
      if (!known->reads(option.name) || !names_file(value) || !fs::exists(value, none)) {
        values.push_back(value);
        continue;
      }
      auto input = reader.read(value);
      if (!input) return fail(input.error());
      values.push_back(std::move(*input));
    }
    options[option.name] = std::move(values);
  }
  const Json record{{"version", version}, {"command", command.verb}, {"options", std::move(options)}};
  return ascii_text(record);
}

std::string record_of_output(const std::string& record, const std::string& output) {
  return record.substr(0, record.size() - 1) + ",\"output\":" + ascii_text(output) + "}";
}

std::string record_of_made(const std::string& record, const fs::path& output, const fs::path& file) {
  if (file == output) return record;
  const fs::path whole = absolute_path(output / "x").parent_path(), made = absolute_path(file);
  const std::string within = made.lexically_relative(whole).generic_string();
  const std::string named = whole.filename().string();
  const bool is_called_after = is_study_file(file) && file_stem(file) == named;
  if (!within.starts_with("..") && !is_called_after) return record_of_output(record, within);
  // A star stands for what somebody called the output, so that files are the same under every name.
  const std::string from_folder = made.lexically_relative(whole.parent_path()).generic_string();
  const auto common = std::ranges::mismatch(named, from_folder);
  const std::string ending(common.in1, named.end());
  const std::string rest = is_called_after ? "/*" + made.filename().string().substr(named.size())
                                           : std::string(common.in2, from_folder.end());
  const std::string starred = record_of_output(record, "*" + rest);
  return starred.substr(0, starred.size() - 1) + ",\"beside\":" + ascii_text(ending) + "}";
}

Result<std::string> record_of_case(const fs::path& case_file, const std::string& structure, Progress& progress) {
  GivenCommand replay{"replay", {{"CASE", {case_file.string()}}}};
  if (!structure.empty()) replay.options.push_back({"--structure", {structure}});
  return record_of(replay, progress);
}

Result<Report> run_recorded(const VerbRun& run, const CLI::App& verb, Progress& progress) {
  auto report = run(progress);
  const RecordedVerb* known = report && !report->made.empty() ? recorded_verb(full_name(verb)) : nullptr;
  if (known == nullptr) return report;
  const fs::path output = verb.get_option(std::string(known->output))->results().front();
  const auto record = record_of(given_command(verb), progress);
  if (!record) return fail(record.error());
  for (const fs::path& file : report->made)
    if (auto added = add_record(file, record_of_made(*record, output, file)); !added) return fail(added.error());
  return report;
}

}  // namespace homolog
