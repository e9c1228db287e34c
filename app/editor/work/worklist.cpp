#include "app/editor/work/worklist.h"

#include <algorithm>
#include <cctype>
#include <system_error>
#include <utility>

#include "app/editor/state/files/file_extensions.h"
#include "app/editor/work/fitter.h"
#include "app/editor/work/waiting_case.h"
#include "core/base/encoding/json.h"
#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/session/case_file.h"
#include "core/session/case_keeping.h"
#include "core/volume/labels/label_likeness.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A file of a folder that is a volume, without its voxels.
struct Scan {
  fs::path path;
  std::shared_ptr<const Volume> grid;
  bool is_map = false;
};

/// What may be a scan: files by their names, and folders that hold a series of slices.
std::vector<fs::path> candidates(const fs::path& folder, std::vector<std::string>& warnings) {
  std::vector<fs::path> found;
  std::size_t slices = 0;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = lower_case(entry->path().filename().string());
    std::error_code ignored;
    if (entry->is_directory(ignored)) {
      const auto series = list_series(entry->path());
      if (series && !series->empty()) found.push_back(entry->path());
      continue;
    }
    const auto& endings = volume_extensions();
    const bool is_volume =
        std::any_of(endings.begin(), endings.end(), [&](const auto& e) { return name.ends_with(e); });
    if (is_volume && !name.ends_with(".dcm"))
      found.push_back(entry->path());
    else if (name.ends_with(".dcm"))
      ++slices;
  }
  if (slices > 0)
    warnings.push_back(folder.string() + ": " + std::to_string(slices) +
                       (slices == 1 ? " DICOM file lies" : " DICOM files lie") +
                       " loose in it and were left out; put each series into a folder of its own");
  std::sort(found.begin(), found.end());
  return found;
}

Result<Scan> read_scan(const fs::path& path, Progress& progress) {
  VolumeReadOptions options;
  options.progress = &progress;
  auto read = load_volume(path.string(), options);
  if (!read) return fail(read.error());
  Scan scan{path, nullptr, holds_labels(read->volume)};
  read->volume.data = std::vector<std::uint8_t>();  // a case needs the grid alone
  scan.grid = std::make_shared<const Volume>(std::move(read->volume));
  return scan;
}

/// How many letters two names begin with in common; 0 where they part within a number: "case_1" and "case_12" are two
/// subjects.
std::size_t alike(const std::string& a, const std::string& b) {
  const auto ends = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  const auto same = static_cast<std::size_t>(ends.first - a.begin());
  const auto is_digit = [](const std::string& name, std::size_t k) {
    return k < name.size() && std::isdigit(static_cast<unsigned char>(name[k])) != 0;
  };
  const bool in_number = (is_digit(a, same) && is_digit(b, same)) ||
                         (same > 0 && is_digit(a, same - 1) && is_digit(a, same)) ||
                         (same > 0 && is_digit(b, same - 1) && is_digit(b, same));
  return in_number ? 0 : same;
}

/// The image on whose voxels a label map lies, that whose name is most like its own; null where none is like it, unless
/// there is only this image and this map.
const Scan* image_of(const Scan& map, const std::vector<Scan>& all) {
  const Scan* best = nullptr;
  std::size_t most = 0;
  for (const Scan& one : all) {
    if (one.is_map || !on_same_voxels(*map.grid, *one.grid)) continue;
    const std::size_t same = alike(file_stem(one.path), file_stem(map.path));
    if (same > most || all.size() == 2) best = &one, most = same;
  }
  return best;
}

/// An image with its label map, or one of them alone.
struct Pair {
  const Scan* image = nullptr;
  const Scan* map = nullptr;
};

std::vector<Pair> pairs_of(const std::vector<Scan>& all) {
  std::vector<Pair> pairs;
  std::vector<const Scan*> with_map;
  for (const Scan& one : all) {
    if (!one.is_map) continue;
    const Scan* image = image_of(one, all);
    with_map.push_back(image);
    pairs.push_back({image != nullptr ? image : &one, &one});
  }
  for (const Scan& one : all)
    if (!one.is_map && std::find(with_map.begin(), with_map.end(), &one) == with_map.end())
      pairs.push_back({&one, nullptr});
  return pairs;
}

/// What a case file says that it is made of.
struct CaseFile {
  fs::path image;
  std::string template_file, numbering;
  bool mirrored = false;  ///< it began with the template of the other side
};

/// Of a file that may be anything; empty where they are longer than any that begin a case.
std::pair<std::string, std::string> first_two_lines(const fs::path& path) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 20;
  const auto size = size_of_file(path);
  const auto file = LineFile::open(path);
  if (!size || !file) return {};
  const std::string text = (*file)->read(0, std::min(*size, most_bytes)).value_or("");
  const std::size_t header_end = text.find('\n');
  if (header_end == std::string::npos) return {*size < most_bytes ? text : std::string(), {}};
  const std::size_t first_end = text.find('\n', header_end + 1);
  const bool is_cut = first_end == std::string::npos && *size > most_bytes;
  return {text.substr(0, header_end), is_cut ? std::string() : text.substr(header_end + 1, first_end - header_end - 1)};
}

CaseFile read_case_file(const fs::path& file) {
  const auto [header, first] = first_two_lines(file);
  const auto json = read_json<nlohmann::json>(header);
  if (!json || !json->is_object()) return {};
  const auto text = [&](const char* key) {
    const auto found = json->find(key);
    return found != json->end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  const auto placed = [&](const std::string& path) { return (file.parent_path() / path).lexically_normal(); };
  const std::string of = text("template");
  const auto first_step = read_json<nlohmann::json>(first).value_or(nlohmann::json());
  return {placed(text("volume")), is_built_in(of) ? of : placed(of).string(), text("connectivity"),
          first_step.contains(action_kind(MirrorTemplate{}).key)};
}

/// Whether a case file is one that would be made now.
bool starts_alike(const CaseFile& file, const CaseStart& start) {
  const Template& wanted = *start.the_template;
  const std::string source =
      is_built_in(wanted.source) ? wanted.source : absolute_path(wanted.source).lexically_normal().string();
  return file.template_file == source && file.mirrored == start.mirrored &&
         (file.numbering.empty() || file.numbering == wanted.topology->hash());
}

/// What became of the scans so far.
struct Made {
  std::vector<fs::path> files;  ///< case files, of which each is of one scan alone
  std::size_t of_others = 0;    ///< files of the same image that were left, since they are of another template
};

Result<StudyCase> make_case(const Pair& pair, bool named_by_map, const CaseStart& start, Made& made_so_far) {
  StudyCase one;
  const fs::path image = absolute_path(pair.image->path);
  const std::string stem = file_stem(named_by_map ? pair.map->path : pair.image->path);
  // Scans of other folders may be called the same.
  std::error_code ignored;
  for (int number = 1;; ++number) {
    one.name = number == 1 ? stem : stem + "-" + std::to_string(number);
    one.file = absolute_path(start.cases / (one.name + case_extension));
    if (!fs::exists(one.file, ignored)) break;
    if (std::find(made_so_far.files.begin(), made_so_far.files.end(), one.file) != made_so_far.files.end()) continue;
    const CaseFile there = read_case_file(one.file);
    if (there.image != image.lexically_normal()) continue;
    const bool known = std::find(start.known.begin(), start.known.end(), one.file) != start.known.end();
    if (known || starts_alike(there, start)) break;
    ++made_so_far.of_others;
  }
  made_so_far.files.push_back(one.file);
  one.from_scan = true;
  if (pair.map != nullptr) one.labels = absolute_path(pair.map->path);
  if (fs::exists(one.file, ignored)) return one;
  Document document = new_document(image.string(), pair.image->grid, start.the_template);
  document.hold_landmarks();
  std::vector<fs::path> scan{image};
  if (pair.map != nullptr && pair.map != pair.image) scan.push_back(one.labels);
  auto record = start.record ? start.record(one.file, scan) : Result<std::string>(std::string());
  if (!record) return fail(record.error());
  auto made = create_case(std::move(document), one.file, {}, std::move(*record));
  if (!made) return fail(made.error());
  if (!start.mirrored) return one;
  // A case's first line names the template's file, so the other side is its first step.
  if (auto mirrored = made->apply(MirrorTemplate{}); !mirrored) return fail(one.name, mirrored.error().what);
  return one;
}

/// `asked`: one folder, or files.
Result<WorklistDone> cases_of(const std::vector<fs::path>& asked, CaseStart start, Progress& progress) {
  WorklistDone done;
  std::vector<Scan> scans;
  std::error_code ignored;
  const bool is_folder = asked.size() == 1 && fs::is_directory(asked.front(), ignored);
  const auto paths = is_folder ? candidates(asked.front(), done.warnings) : asked;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    progress.report(static_cast<double>(k) / static_cast<double>(paths.size()));
    Progress reading(progress, 0);
    auto scan = read_scan(paths[k], reading);
    if (progress.cancelled()) return fail("", "No scan was added: cancelled.");
    if (scan)
      scans.push_back(std::move(*scan));
    else
      done.warnings.push_back(scan.error().sentence());
  }
  if (scans.empty())
    return fail(asked.front().string(),
                is_folder ? "holds no scan and no label map; choose a folder of images, one file for each"
                          : "is no scan and no label map, and neither are the others; choose images");
  if (auto made = make_folder(start.cases); !made) return fail(made.error());
  if (!start.the_template) {
    auto loaded = load_template(start.template_source);
    if (!loaded) return fail(loaded.error());
    start.the_template = std::move(*loaded);
  }
  const auto pairs = pairs_of(scans);
  Made made_so_far;
  for (const Pair& pair : pairs) {
    const auto shared = std::count_if(pairs.begin(), pairs.end(), [&](const Pair& p) { return p.image == pair.image; });
    auto one = make_case(pair, shared > 1 && pair.map != nullptr, start, made_so_far);
    if (one)
      done.added.push_back(std::move(*one));
    else
      done.warnings.push_back(one.error().sentence());
  }
  const std::size_t of_others = made_so_far.of_others;
  if (of_others > 0)
    done.warnings.push_back(start.cases.filename().string() + " holds " +
                            (of_others == 1 ? "a case file" : std::to_string(of_others) + " case files") +
                            " of these scans with another template. " +
                            (of_others == 1 ? "It stays as it is, and a new one was made."
                                            : "They stay as they are, and new ones were made."));
  return done;
}

/// Fits one case and writes it down there; what it says where that fails. Where one of the map's labels has to be
/// chosen first, it says that in `done` and leaves the case.
Result<std::string> fit_case(const StudyCase& one, FitSettings settings, Progress& progress, WorklistDone& done) {
  auto read = open_case(one.file, &progress);
  if (!read) return fail(read.error());
  EditSession& session = read->session;
  if (was_worked_on(session)) return std::string();
  const auto view = session.document().view(one.structure);
  if (!view) return fail(one.name, "has no template; take it off the study and add it again");
  auto labels = read_case_labels(one, settings, progress);
  if (!labels) return fail(labels.error());
  if (labels->label == 0) {
    done.map = labels->map.name;
    done.labels = std::move(labels->segments);
    return std::string();
  }
  settings.all_labels = labels->label == every_label;
  settings.label = settings.all_labels ? labels->held.front() : labels->label;
  settings.as_placed = false;
  FitOptions fit;
  fit.progress = &progress;
  auto fitted = fit_to_labels(*view, labels->map, settings, {}, fit);
  if (!fitted) return fail(fitted.error());
  // What is wrong with the fit is said last.
  const std::string reason =
      fitted->figures.warnings.empty() ? "The fit is doubtful." : fitted->figures.warnings.back();
  const Note figures{"fit", {}, {}, fitted->figures};
  if (auto applied = session.apply(std::move(fitted->edit), false, one.structure); !applied)
    return fail(applied.error());
  if (auto noted = session.apply(figures, false, one.structure); !noted) return fail(noted.error());
  if (auto named = name_labels(session, one.labels); !named) return fail(named.error());
  if (!fitted->doubtful) return labels->warnings.empty() ? std::string() : labels->warnings.front();
  return reason;
}

}  // namespace

Result<WorklistDone> cases_of_scans(const std::vector<fs::path>& paths, const CaseStart& start, Progress& progress) {
  return cases_of(paths, start, progress);
}

void Worklist::add(const std::vector<fs::path>& paths, CaseStart start) {
  if (paths.empty()) return;
  if (!busy()) asked_ = done_ = 0;
  ++asked_;
  worker_.queue((paths.size() == 1 ? paths.front() : paths.front().parent_path()).string(),
                [paths, start = std::move(start)](Progress& progress) { return cases_of(paths, start, progress); },
                "Reading");
}

void Worklist::make_template(const std::vector<StudyCase>& cases, const FitSettings& settings, const fs::path& file,
                             const fs::path& study) {
  if (!busy()) asked_ = done_ = 0;
  ++asked_;
  worker_.queue(
      "template",
      [cases, settings, file, study](Progress& progress) -> Result<WorklistDone> {
        auto made = make_study_template(cases, settings, file, progress);
        if (!made) return fail(made.error());
        WorklistDone done;
        done.made = std::move(*made);
        done.file = file;
        done.study = study;
        return done;
      },
      "Making");
}

void Worklist::fit(const std::vector<StudyCase>& cases, const FitSettings& settings) {
  if (!busy()) asked_ = done_ = 0;
  for (const StudyCase& one : cases) {
    ++asked_;
    worker_.queue(
        one.name,
        [one, settings](Progress& progress) -> Result<WorklistDone> {
          WorklistDone done;
          done.fitted = one.name;
          done.file = one.file;
          const auto doubt = fit_case(one, settings, progress, done);
          if (progress.cancelled()) return fail("", "The fits were cancelled.");
          if (doubt)
            done.doubt = *doubt;
          else
            done.fault = doubt.error().sentence();
          return done;
        },
        "Fitting");
  }
}

void Worklist::cancel() {
  worker_.cancel();
  asked_ = done_ = 0;
}

std::string Worklist::what() const {
  const auto job = worker_.running();
  if (!job) return {};
  const std::string subject = fs::path(job->subject).filename().string();
  return std::string(job->verb) + " " + (subject.empty() ? job->subject : subject);
}

double Worklist::fraction() const {
  // What was done before these were asked for may be taken after.
  return asked_ == 0 ? 0
                     : std::min(1.0, (static_cast<double>(done_) + worker_.fraction()) / static_cast<double>(asked_));
}

std::optional<Result<WorklistDone>> Worklist::take() {
  auto done = worker_.take();
  if (done) ++done_;
  return done;
}

}  // namespace homolog
