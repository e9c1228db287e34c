#include "core/case/case_file.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "core/base/files.h"
#include "core/base/json.h"
#include "core/base/text.h"
#include "core/case/action_json.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int format_version = 1;
constexpr const char* case_extension = ".homolog";
constexpr const char* weighed_landmarks = "weighed";  ///< "landmarks" in the header: see Document::weighs_landmarks

/// A line of the file; bytes that are no UTF-8 (a path of another encoding) become a replacement character.
std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// "built-in:kidney" and "phantom:kidney:1" name no file.
bool is_file(const std::string& source) {
  return !source.empty() && !source.starts_with("built-in:") && !source.starts_with("phantom:");
}

std::string relative_to(const fs::path& folder, const std::string& source) {
  if (!is_file(source)) return source;
  // Textual, as `resolved` is: following links here and not there would name another file.
  std::error_code error;
  const fs::path from = fs::absolute(folder.empty() ? fs::path(".") : folder, error);
  const fs::path to = fs::absolute(source, error);
  return error ? source : to.lexically_normal().lexically_proximate(from.lexically_normal()).generic_string();
}

std::string resolved(const fs::path& folder, const std::string& source) {
  return is_file(source) ? (folder / source).lexically_normal().string() : source;
}

/// Refuses with both values where the header holds `key` and what was loaded differs.
template <class Value>
Result<void> check(const Json& header, const char* key, const Value& loaded, const std::string& of) {
  if (!header.contains(key)) return {};
  Value expected{};
  try {
    expected = header.at(key).get<Value>();
  } catch (const Json::exception&) {
    return fail("", std::string("line 1: \"") + key + "\" is of the wrong kind");
  }
  if (expected == loaded) return {};
  const Json both = {expected, loaded};
  return fail("", "was made for " + of + " with " + key + " " + excerpt(both[0].dump()) + " but this one has " +
                      both[1].dump() + "; put the original back or start a new case");
}

/// "128 × 128 × 90 voxels of 1.5 × 1.5 × 3 mm"
std::string grid_in_words(const Json& voxels, const Json& spacing_mm) {
  std::string words;
  for (std::size_t axis = 0; axis < 3; ++axis)
    words += (axis > 0 ? " × " : "") + std::to_string(voxels.at(axis).get<int>());
  words += " voxels of ";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    char number[32];
    std::snprintf(number, sizeof number, "%.4g", spacing_mm.at(axis).get<double>());
    words += (axis > 0 ? " × " : "") + std::string(number);
  }
  return words + " mm";
}

/// Refuses an image on another grid than the case was made on.
Result<void> check_grid(const Json& header, const Volume& volume, const std::string& source) {
  const std::string here = geometry_hash(volume.geometry);
  try {
    if (header.value("geometry", here) == here) return {};
    const VolumeGeometry& g = volume.geometry;
    std::string made_on = "another grid", is;
    if (header.contains("voxels") && header.contains("spacing_mm")) {
      made_on = grid_in_words(header["voxels"], header["spacing_mm"]);
      is = grid_in_words(g.dims, {g.spacing_mm[0], g.spacing_mm[1], g.spacing_mm[2]});
      if (is == made_on) is = "as many, but lies elsewhere or otherwise turned";
    }
    return fail("", "was made on an image of " + made_on + " (geometry " +
                        excerpt(header["geometry"].get<std::string>()) + "), and " + source + " has " +
                        (is.empty() ? "" : is + " ") + "(geometry " + here +
                        "); open it together with its own image, or start a new case");
  } catch (const Json::exception&) {
    return fail("", "line 1: \"geometry\", \"voxels\" or \"spacing_mm\" is of the wrong kind");
  }
}

struct Lines {
  std::vector<std::string> whole;
  bool torn = false;
  std::uintmax_t whole_bytes = 0;
};

/// Splits a case file. A last line that is no JSON and lacks its line feed (or holds zero bytes) was being written when
/// the machine died.
Lines split_lines(const std::string& text) {
  Lines lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    const bool last = end + 1 >= text.size();
    const bool suspicious = last && (end == text.size() || line.find('\0') != std::string::npos);
    if (suspicious && !line.empty() && !read_json<Json>(line)) {
      lines.torn = true;
      break;
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.whole.push_back(std::move(line));
    begin = std::min(end + 1, text.size());
    lines.whole_bytes = begin;
  }
  return lines;
}

Result<Document> read_header(const Json& header, const fs::path& folder, const ReplayOptions& replay,
                             std::vector<std::string>& warnings) {
  if (!header.is_object() || !header.contains("homolog")) {
    return fail("", "is not a Homolog case: its first line is no header");
  }
  if (header["homolog"] != format_version) {
    return fail("", "is of case format " + excerpt(header["homolog"].dump()) + "; this Homolog reads format 1");
  }
  std::shared_ptr<const Volume> volume;
  std::string volume_source, template_source;
  VolumeReadOptions options;
  options.progress = replay.progress;
  try {
    volume_source = replay.volume_source.empty() ? resolved(folder, header.value("volume", "")) : replay.volume_source;
    template_source = resolved(folder, header.value("template", ""));
    options.series_uid = header.value("series", "");
    if (const auto spacing = header.find("spacing_mm"); spacing != header.end() && spacing->size() == 3) {
      options.stack_spacing_mm =
          Vec3((*spacing)[0].get<double>(), (*spacing)[1].get<double>(), (*spacing)[2].get<double>());
    }
  } catch (const Json::exception&) {
    return fail("", "line 1: a value is of the wrong kind");
  }
  if (!volume_source.empty()) {
    std::error_code ignored;
    if (!volume_source.starts_with("phantom:") && !fs::exists(volume_source, ignored))
      return fail("", "its image " + excerpt(volume_source) +
                          " does not exist; put it back, or open the case together with the image where it is now");
    auto read = load_volume(volume_source, options);
    if (!read) return fail(read.error());
    warnings.insert(warnings.end(), read->warnings.begin(), read->warnings.end());
    volume = std::make_shared<const Volume>(std::move(read->volume));
    if (auto same = check_grid(header, *volume, volume_source); !same) return fail(same.error());
    if (auto same = check(header, "series", volume->series_uid, "a volume"); !same) return fail(same.error());
  }
  std::shared_ptr<const Template> reference;
  if (!template_source.empty()) {
    auto loaded = load_template(template_source);
    if (!loaded) return fail(loaded.error());
    reference = *loaded;
    const auto vertices = static_cast<std::int64_t>(reference->topology->vertices());
    if (auto same = check(header, "vertices", vertices, "a template"); !same) return fail(same.error());
    if (auto same = check(header, "connectivity", reference->topology->hash(), "a template"); !same) {
      return fail(same.error());
    }
  }
  Document document = new_document(volume_source, std::move(volume), std::move(reference));
  // Homolog always wrote "connectivity"; without it the header was written by a person, and nothing is to be kept to.
  const auto landmarks = header.find("landmarks");
  document.weighs_landmarks =
      landmarks != header.end() ? *landmarks == weighed_landmarks : !header.contains("connectivity");
  return document;
}

/// What the options force, whatever the file says.
void override_settings(const ReplayOptions& options, Document& document) {
  if (options.scheme) document.scheme = *options.scheme;
  if (options.paper_events) document.paper_events = *options.paper_events;
  if (options.spacing) document.spacing = *options.spacing;
}

void override_settings(const ReplayOptions& options, Action& action) {
  if (auto* scheme = std::get_if<SetScheme>(&action)) {
    scheme->scheme = options.scheme.value_or(scheme->scheme);
    scheme->paper_events = options.paper_events.value_or(scheme->paper_events);
  }
  if (auto* spacing = std::get_if<SetSpacing>(&action)) spacing->strength = options.spacing.value_or(spacing->strength);
}

Error in_line(const fs::path& path, std::size_t number, const Error& error) {
  return {path.string(), "line " + std::to_string(number) + ": " + error.sentence()};
}

}  // namespace

std::string case_header(const Document& document, const fs::path& folder) {
  Json header{{"homolog", format_version}};
  if (!document.volume_source.empty()) header["volume"] = relative_to(folder, document.volume_source);
  if (document.reference) header["template"] = relative_to(folder, document.reference->source);
  if (document.has_shape()) header["placement"] = to_json(document.shape().placement);
  if (document.weighs_landmarks) header["landmarks"] = weighed_landmarks;
  if (document.reference) {
    header["vertices"] = document.reference->topology->vertices();
    header["connectivity"] = document.reference->topology->hash();
  }
  if (document.volume) {
    const Volume& volume = *document.volume;
    header["geometry"] = geometry_hash(volume.geometry);
    header["voxels"] = volume.geometry.dims;
    if (!volume.series_uid.empty()) header["series"] = volume.series_uid;
    const Vec3& spacing = volume.geometry.spacing_mm;
    header["spacing_mm"] = Json::array({spacing[0], spacing[1], spacing[2]});
  }
  return dumped(header);
}

std::string action_line(const Action& action, bool joined) {
  Json json = to_json(action);
  if (joined) json["joined"] = true;
  return dumped(json);
}

Result<EditStep> parse_action(const std::string& line) {
  const auto json = read_json<Json>(line);
  if (!json) return fail(json.error());
  auto action = action_from_json(*json);
  if (!action) return fail(action.error());
  const auto joined = json->find("joined");
  return EditStep{std::move(*action), joined != json->end() && *joined == true};
}

Result<CaseRead> read_case(const fs::path& path, const ReplayOptions& options) {
  const auto text = read_whole_file(path, std::uintmax_t{1} << 30);
  if (!text) return fail(text.error());
  const Lines lines = split_lines(*text);
  if (lines.whole.empty()) return fail(path.string(), "is not a Homolog case: it is empty or its first line is torn");
  std::vector<std::string> warnings;
  if (lines.torn) {
    warnings.push_back(
        path.string() +
        ": the last line was torn when the machine stopped; it is dropped and everything before it restored");
  }
  const Json header = read_json<Json>(lines.whole.front()).value_or(Json());
  auto document = read_header(header, path.parent_path(), options, warnings);
  if (!document) {
    Error error = document.error();
    if (error.subject.empty()) error.subject = path.string();
    return fail(std::move(error));
  }
  override_settings(options, *document);
  EditSession session(std::move(*document));
  if (header.contains("placement") && session.document().has_shape()) {
    const auto placement = similarity_from_json(header["placement"]);
    if (!placement) return fail(in_line(path, 1, placement.error()));
    if (auto placed = session.start_at(*placement); !placed) return fail(in_line(path, 1, placed.error()));
  }
  for (std::size_t k = 1; k < lines.whole.size(); ++k) {
    if (options.progress != nullptr) {
      options.progress->report(static_cast<double>(k) / static_cast<double>(lines.whole.size()));
      if (options.progress->cancelled()) return fail(path.string(), "was not opened: cancelled");
    }
    if (lines.whole[k].empty()) continue;
    auto step = parse_action(lines.whole[k]);
    if (!step) return fail(in_line(path, k + 1, step.error()));
    override_settings(options, step->action);
    if (auto done = session.apply(std::move(step->action), step->joined); !done)
      return fail(in_line(path, k + 1, done.error()));
  }
  return CaseRead{std::move(session), std::move(warnings), lines.whole_bytes};
}

Result<CaseRead> open_case(const fs::path& path, Progress* progress, const std::string& volume_source) {
  // Locked before it is read: what another program writes until then is read, and nobody writes afterwards.
  auto journal = Journal::open(path);
  if (!journal) return fail(journal.error());
  ReplayOptions options;
  options.progress = progress;
  options.volume_source = volume_source;
  auto read = read_case(path, options);
  if (!read) return read;
  if (auto cut = (*journal)->keep_first(read->whole_bytes); !cut) return fail(cut.error());
  if (!volume_source.empty()) {
    const auto text = read_whole_file(path, std::uintmax_t{1} << 30);
    if (!text) return fail(text.error());
    const std::size_t end = std::min(text->find('\n'), text->size());
    Json header = read_json<Json>(text->substr(0, end)).value_or(Json());
    header["volume"] = relative_to(path.parent_path(), volume_source);
    journal->reset();  // its lock goes with the old file
    journal = Journal::create(path, dumped(header) + text->substr(end));
    if (!journal) return fail(journal.error());
  }
  read->session.write_to(std::move(*journal));
  return read;
}

Result<EditSession> create_case(Document initial, const fs::path& path) {
  auto journal = Journal::create(path, case_header(initial, path.parent_path()) + '\n');
  if (!journal) return fail(journal.error());
  EditSession session(std::move(initial));
  session.write_to(std::move(*journal));
  return session;
}

Result<fs::path> new_unsaved_path() {
  const fs::path folder = unsaved_folder();
  if (auto made = make_private_folder(folder); !made)
    return fail(folder.string(), made.error().what + ", for instance by XDG_STATE_HOME");
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto stamp = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  return folder / ("unsaved-" + std::to_string(stamp) + "-" + std::to_string(::getpid()) + case_extension);
}

Result<EditSession> create_unsaved_case(Document initial) {
  const auto path = new_unsaved_path();
  if (!path) return fail(path.error());
  return create_case(std::move(initial), *path);
}

std::vector<fs::path> unsaved_cases() {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(unsaved_folder(), error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() != case_extension || Journal::in_use(entry->path())) continue;
    const auto text = read_whole_file(entry->path(), std::uintmax_t{1} << 30);
    if (text && std::count(text->begin(), text->end(), '\n') >= 2) found.push_back(entry->path());
  }
  std::sort(found.rbegin(), found.rend());
  return found;
}

Result<void> save_case_as(EditSession& session, const fs::path& path) {
  if (session.journal() == nullptr) {
    // Nothing could be journalled so far: the file begins with the case as it was opened.
    std::string lines = case_header(session.initial_document(), path.parent_path()) + '\n';
    for (const EditStep& step : session.steps_done()) lines += action_line(step.action, step.joined) + '\n';
    auto journal = Journal::create(path, lines);
    if (!journal) return fail(journal.error());
    session.write_to(std::move(*journal));
    return {};
  }
  const fs::path old = session.journal()->path();
  std::error_code error;
  if (fs::equivalent(old, path, error)) return {};
  auto text = read_whole_file(old, std::uintmax_t{1} << 30);
  if (!text) return fail(text.error());
  const std::size_t end = text->find('\n');
  Json header = read_json<Json>(text->substr(0, end)).value_or(Json());
  if (!header.is_object()) return fail(old.string(), "has lost its first line; export the mesh instead");
  for (const char* key : {"volume", "template"}) {
    if (!header.contains(key)) continue;
    const std::string source = resolved(old.parent_path(), header[key].get<std::string>());
    header[key] = relative_to(path.parent_path(), source);
  }
  auto journal = Journal::create(path, dumped(header) + text->substr(end));
  if (!journal) return fail(journal.error());
  session.write_to(std::move(*journal));
  if (old.parent_path() == unsaved_folder()) fs::remove(old, error);
  return {};
}

}  // namespace homolog
