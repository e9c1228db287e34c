#include "core/session/case_file.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "core/base/encoding/json.h"
#include "core/case/action_json.h"
#include "core/case/action_line.h"
#include "core/session/case_header.h"
#include "core/session/case_keeping.h"
#include "core/session/checkpoint.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The fault of a line, and a remedy where the error names none.
Error in_line(const fs::path& path, std::size_t number, const Error& error) {
  const std::string sentence = error.sentence();
  const bool has_remedy = sentence.find("; ") != std::string::npos || sentence.ends_with('.');
  const char* remedy = has_remedy ? "" : "; correct that line or take it out";
  return {path.string(), "line " + std::to_string(number) + ": " + sentence + remedy};
}

/// A case file, looked through once.
struct FileLines {
  struct Line {
    LinePlace place;
    LineKind kind;
    std::uint32_t check = 0;  ///< the checksum of the lines before it
  };
  std::string header;
  std::vector<Line> lines;  ///< behind the header
  std::uint64_t begin = 0;  ///< the begin of the first of them, in the file
  std::uint64_t whole_bytes = 0;
  std::uint32_t check = 0;  ///< the checksum of all lines
  bool torn = false;
  bool of_frames = false;  ///< a line may speak of a frame
};

/// Leaves the first lines alone, as if the file ended there.
void keep_lines(FileLines& whole, std::size_t count) {
  if (count >= whole.lines.size()) return;
  whole.whole_bytes = whole.begin + whole.lines[count].place.at;
  whole.check = whole.lines[count].check;
  whole.lines.resize(count);
}

/// A line that cannot be played.
struct BadLine {
  std::size_t at = 0;  ///< behind the header
  Error error;
};

/// Whether a last line was being written when the machine died: it is no JSON and lacks its line feed, or holds zero
/// bytes.
bool is_torn(std::string_view line, bool ended) {
  const bool suspicious = !ended || line.find('\0') != std::string_view::npos;
  return suspicious && !line.empty() && !read_json<Json>(line);
}

/// Errors: an empty file, one whose first line is torn.
Result<FileLines> looked_through(const LineFile& file, Progress* progress) {
  FileLines whole;
  std::uint64_t last = 0;
  bool last_ended = true;
  const auto visit = [&](std::string_view line, std::uint64_t at, bool ended) -> Result<void> {
    if (progress != nullptr && progress->cancelled()) return fail(file.path().string(), "was not opened: cancelled");
    last = at;
    last_ended = ended;
    whole.whole_bytes = at + line.size() + (ended ? 1 : 0);
    if (whole.begin == 0) {
      whole.header = line;
      whole.begin = whole.whole_bytes;
      return {};
    }
    whole.of_frames = whole.of_frames || line.find("frame") != std::string_view::npos;
    whole.lines.push_back({{at - whole.begin, line.size()}, kind_of(line), whole.check});
    whole.check = CaseLines::checked(CaseLines::checked(whole.check, line), ended ? "\n" : "");
    return {};
  };
  if (auto read = file.for_each_line(visit); !read) return fail(read.error());
  const auto line = file.read(last, whole.whole_bytes - last - (last_ended && whole.whole_bytes > 0 ? 1 : 0));
  if (!line) return fail(line.error());
  whole.torn = is_torn(*line, last_ended);
  if (whole.begin == 0 || (whole.torn && whole.lines.empty()))
    return fail(file.path().string(),
                "is not a Homolog case: it is empty or its first line is torn; take a copy of it from before");
  if (whole.torn) {
    whole.whole_bytes = last;
    whole.check = whole.lines.back().check;
    whole.lines.pop_back();
  }
  return whole;
}

/// Sets what the options force, whatever the file says.
void override_settings(const ReplayOptions& options, Document& document) {
  if (options.scheme) document.scheme = *options.scheme;
  if (options.paper_events) document.paper_events = *options.paper_events;
  if (options.even_spacing) document.even_spacing = *options.even_spacing;
}

void override_settings(const ReplayOptions& options, Action& action) {
  if (auto* scheme = std::get_if<SetScheme>(&action)) {
    scheme->scheme = options.scheme.value_or(scheme->scheme);
    scheme->paper_events = options.paper_events.value_or(scheme->paper_events);
  }
  if (auto* spacing = std::get_if<SetEvenSpacing>(&action))
    spacing->strength = options.even_spacing.value_or(spacing->strength);
}

bool overrides(const ReplayOptions& options) {
  return options.scheme || options.paper_events || options.even_spacing;
}

bool needs_image(const FileLines& whole) {
  const Json header = read_json<Json>(whole.header).value_or(Json());
  return whole.of_frames || !header.contains("placement") || header.value("homolog", Json()) != 1;
}

/// A session at the start of a case, with nothing done yet.
Result<EditSession> session_at_start(const LineFile& file, const FileLines& whole, const ReplayOptions& options,
                                     std::vector<std::string>& warnings) {
  const Json header = read_json<Json>(whole.header).value_or(Json());
  const ImageOfHeader image{options.volume_source, !options.shapes_alone || needs_image(whole), !options.shapes_alone};
  auto document = read_header(header, file.path().parent_path(), image, options.progress, warnings);
  if (!document) {
    Error error = document.error();
    if (error.subject.empty()) error.subject = file.path().string();
    return fail(std::move(error));
  }
  override_settings(options, *document);
  auto labels = labels_in_header(header, file.path().parent_path());
  if (!labels) return fail(in_line(file.path(), 1, labels.error()));
  auto templates = templates_in_header(header, file.path().parent_path());
  if (!templates) return fail(in_line(file.path(), 1, templates.error()));
  EditSession session(std::move(*document), options.limits);
  session.set_labels(std::move(*labels));
  session.set_templates(std::move(*templates));
  if (header.contains("placement") && session.document().view()) {
    const auto placement = similarity_from_json(header["placement"]);
    if (!placement) return fail(in_line(file.path(), 1, placement.error()));
    if (auto placed = session.start_at(*placement); !placed) return fail(in_line(file.path(), 1, placed.error()));
  }
  return session;
}

/// Brings a session to the last checkpoint that holds; gives how many lines need not be played then.
std::size_t go_to_checkpoint(EditSession& session, const FileLines& whole, const LineFile& file) {
  std::optional<Document> found;
  std::size_t k = whole.lines.size();
  while (k > 0 && !found) {
    const FileLines::Line& line = whole.lines[--k];
    if (line.kind.kind != LineKind::checkpoint) continue;
    const auto text = file.read(whole.begin + line.place.at, line.place.bytes);
    if (text) found = read_checkpoint(*text, session.initial_document(), line.check, session.templates());
  }
  if (!found) return 0;
  const auto end = whole.lines.begin() + static_cast<std::ptrdiff_t>(k) + 1;
  const auto is_unknown = [](const FileLines::Line& line) { return line.kind.kind == LineKind::unknown; };
  if (std::any_of(whole.lines.begin(), end, is_unknown)) return 0;
  for (auto line = whole.lines.begin(); line != end; ++line)
    if (!session.count(line->kind, line->place, line->check)) return 0;
  session.go_on_from(std::make_shared<const Document>(std::move(*found)));
  return k + 1;
}

/// `bad` says which line cannot be played, where that is why it fails.
Result<void> play(EditSession& session, const FileLines& whole, std::size_t from, const LineFile& file,
                  Progress* progress, std::optional<BadLine>& bad) {
  const auto stop_at = [&](std::size_t k, const Error& error) {
    bad = BadLine{k, in_line(file.path(), k + 2, error)};
    return fail(bad->error);
  };
  for (std::size_t k = from; k < whole.lines.size(); ++k) {
    if (progress != nullptr) {
      progress->report(static_cast<double>(k - from) / static_cast<double>(whole.lines.size() - from));
      if (progress->cancelled()) return fail(file.path().string(), "was not opened: cancelled");
    }
    const FileLines::Line& line = whole.lines[k];
    if (line.kind.kind == LineKind::empty || line.kind.kind == LineKind::checkpoint) continue;
    const auto text = file.read(whole.begin + line.place.at, line.place.bytes);
    if (!text) return fail(text.error());
    auto step = parse_action(*text);
    if (!step) return stop_at(k, step.error());
    if (auto done = session.replay(std::move(*step), line.place); !done) return stop_at(k, done.error());
  }
  return {};
}

/// Finds, before the image is read, which may take long, the first of the lines that certainly cannot be played: those
/// of no known kind, and short ones behind the last checkpoint whose values are wrong.
Result<std::optional<BadLine>> check_lines(const LineFile& file, const FileLines& whole) {
  constexpr std::size_t short_bytes = 1024;
  bool checkpoint_behind = false;
  std::optional<BadLine> first;
  for (std::size_t k = whole.lines.size(); k-- > 0;) {
    const FileLines::Line& line = whole.lines[k];
    checkpoint_behind = checkpoint_behind || line.kind.kind == LineKind::checkpoint;
    const bool is_played = !checkpoint_behind && line.kind.kind != LineKind::empty;
    if (line.kind.kind != LineKind::unknown && !(is_played && line.place.bytes <= short_bytes)) continue;
    const auto text = file.read(whole.begin + line.place.at, line.place.bytes);
    if (!text) return fail(text.error());
    if (auto step = parse_action(*text); !step) first = BadLine{k, in_line(file.path(), k + 2, step.error())};
  }
  return first;
}

/// Plays the lines. `bad` says which one cannot be played, where that is why it fails.
Result<EditSession> played(const std::shared_ptr<const LineFile>& file, const FileLines& whole,
                           const ReplayOptions& options, std::vector<std::string>& warnings,
                           std::optional<BadLine>& bad) {
  auto session = session_at_start(*file, whole, options, warnings);
  if (!session) return session;
  std::size_t known = 0;
  if (options.from_checkpoint && !overrides(options)) {
    known = go_to_checkpoint(*session, whole, *file);
    if (known == 0) {
      EditSession again(session->initial_document(), options.limits);
      again.set_labels(session->kept().labels);
      again.set_templates(session->templates());
      *session = std::move(again);
    }
  }
  std::function<void(Action&)> adjust;
  if (overrides(options)) adjust = [options](Action& action) { override_settings(options, action); };
  session->read_from(CaseLines(file, whole.begin, whole.whole_bytes, whole.check), std::move(adjust));
  if (auto done = play(*session, whole, known, *file, options.progress, bad); !done) return fail(done.error());
  return session;
}

Result<CaseRead> read_lines(const std::shared_ptr<const LineFile>& file, const ReplayOptions& options) {
  auto whole = looked_through(*file, options.progress);
  if (!whole) return fail(whole.error());
  std::vector<std::string> torn, warnings;
  if (whole->torn) {
    torn.push_back(
        file->path().string() +
        ": the last line was torn when the machine stopped; it is dropped and everything before it restored");
  }
  auto checked = check_lines(*file, *whole);
  if (!checked) return fail(checked.error());
  std::optional<BadLine> bad = std::move(*checked);
  std::string fault;
  for (;;) {
    if (bad) {
      if (!options.up_to_bad_line) return fail(std::move(bad->error));
      fault = bad->error.sentence();
      keep_lines(*whole, bad->at);
    }
    bad.reset();
    warnings = torn;
    auto session = played(file, *whole, options, warnings, bad);
    if (!session && !bad) return fail(session.error());
    if (!session) continue;
    std::ranges::move(session->templates().take_warnings(), std::back_inserter(warnings));
    return CaseRead{std::move(*session), std::move(warnings), whole->whole_bytes, std::move(fault)};
  }
}

}  // namespace

bool is_case_file(const std::filesystem::path& file) {
  return file.extension() == case_extension;
}

bool shapes_need_image(const fs::path& path) {
  const auto file = LineFile::open(path);
  const auto whole = file ? looked_through(**file, nullptr) : fail(file.error());
  return !whole || needs_image(*whole);
}

Result<CaseRead> read_case(const fs::path& path, const ReplayOptions& options) {
  const auto file = LineFile::open(path);
  return file ? read_lines(*file, options) : fail(file.error());
}

Result<CaseRead> open_case(const fs::path& path, Progress* progress, const std::string& volume_source,
                           const HistoryLimits& limits, bool up_to_bad_line) {
  // Locked before it is read: what another program writes until then is read, and nobody writes afterwards.
  auto journal = Journal::open(path);
  if (!journal) return fail(journal.error());
  ReplayOptions options;
  options.progress = progress;
  options.volume_source = volume_source;
  options.limits = limits;
  options.up_to_bad_line = up_to_bad_line;
  auto read = read_lines((*journal)->file(), options);
  if (!read || !read->fault.empty()) return read;
  if (auto cut = (*journal)->keep_first(read->whole_bytes); !cut) return fail(cut.error());
  auto first_line = read->session.lines().first_line();
  if (!first_line) return fail(first_line.error());
  if (auto goes_on = read->session.write_to(std::move(*journal), std::move(*first_line)); !goes_on)
    return fail(goes_on.error());
  if (volume_source.empty()) return read;
  if (auto moved = go_on_in(read->session, path); !moved) return fail(moved.error());
  return read;
}

Result<EditSession> create_case(Document initial, const fs::path& path, const HistoryLimits& limits,
                                std::string record) {
  for (const auto& structure : initial.structures) {
    if (!structure || !structure->the_template)
      return fail(path.string(), "would be a case of a structure without a template; load one first");
    if (auto sound = check_template(*structure->the_template); !sound) return fail(path.string(), sound.error().what);
  }
  EditSession session(std::move(initial), limits);
  session.set_record(std::move(record));
  if (auto begun = go_on_in(session, path); !begun) return fail(begun.error());
  return session;
}

Result<void> save_case_as(EditSession& session, const fs::path& path) {
  Journal* journal = session.journal();
  const fs::path old = journal != nullptr ? journal->path() : fs::path();
  if (journal != nullptr && journal->is_at(path) && journal->fate() == Journal::Fate::as_left) return journal->sync();
  if (auto moved = go_on_in(session, path); !moved) return moved;
  std::error_code error;
  if (!old.empty() && old != path && old.parent_path() == unsaved_folder()) fs::remove(old, error);
  return {};
}

}  // namespace homolog
