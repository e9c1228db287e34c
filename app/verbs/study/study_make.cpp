#include "app/verbs/study/study_make.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "app/editor/work/worklist.h"
#include "app/verbs/case_of_fit.h"
#include "app/verbs/case_pool.h"
#include "app/verbs/case_table.h"
#include "app/verbs/describe.h"
#include "app/verbs/record.h"
#include "app/verbs/study/study_templates.h"
#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "core/model/shapes/shape_files.h"
#include "core/session/case_file.h"

// The verb `study make`: a study with scans, label maps, groups and covariates.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct MakeJob {
  std::vector<fs::path> in;
  std::string template_source;
  fs::path out;
  std::string row;  ///< of a table the case that is made alone, by its name; empty: all
  GivenCommand command;

  bool of_table() const { return in.size() == 1 && is_case_table(in.front()); }
  /// Where case files go, as in the window: NAME-cases beside the study.
  fs::path cases() const { return out.parent_path() / (file_stem(out) + "-cases"); }
};

/// What the rows of a table share.
struct RowsOfTable {
  fs::path folder;  ///< of the table
  std::shared_ptr<const Template> the_template;
  std::map<std::string, std::string> structures;  ///< of the study that is there: which one it takes of a case, by name
  ReadTogether together;                          ///< for cases that are read

  std::string structure_of(const std::string& name) const {
    const auto known = structures.find(name);
    return known == structures.end() ? std::string() : known->second;
  }
};

/// A number as one, all else as text.
Json value_of(const std::string& text) {
  const auto number = as_number<double>(text);
  return number && std::isfinite(*number) ? Json(*number) : Json(text);
}

/// What a row is about, its paths from the root.
struct RowFiles {
  fs::path file, image, labels;
};

Result<RowFiles> files_of_row(const RowOfCase& row, const fs::path& folder, const std::string& where) {
  RowFiles files;
  const std::array<fs::path*, file_columns.size()> wanted{&files.file, &files.image, &files.labels};
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const std::string cell = cell_of(row, file_columns[k]);
    if (cell.empty()) continue;
    *wanted[k] = absolute_path(folder / cell);
    std::error_code ignored;
    if (!fs::exists(*wanted[k], ignored)) return fail(wanted[k]->string(), "does not exist; correct " + where);
  }
  if (files.file.empty() && files.image.empty() && files.labels.empty())
    return fail(where, "names no file, image or label map; name one");
  return files;
}

/// The record of a row's case: of the command that makes it alone.
Result<std::string> record_of_row(const MakeJob& job, const std::string& name, Progress& progress) {
  GivenCommand alone = job.command.with("--case", {});
  alone.options.push_back({"--case", {name}});
  const auto record = record_of(alone, progress);
  return record ? record_of_made(*record, job.out, job.cases() / (name + case_extension)) : record;
}

/// A case for a mesh that was fitted elsewhere, on its scan.
Result<StudyCase> case_of_mesh(const MakeJob& job, const std::string& name, const RowFiles& files,
                               std::shared_ptr<const Volume> grid, const std::shared_ptr<const Template>& the_template,
                               std::vector<std::string>& warnings, Progress& progress) {
  const auto mesh = read_mesh_file(files.file);
  if (!mesh) return fail(mesh.error());
  const auto mirrored = mirrors_template(*mesh, files.file, *the_template);
  if (!mirrored) return fail(mirrored.error());
  FittedCase fitted{name, files.image.empty() ? files.labels : files.image, files.labels, std::move(grid),
                    the_template};
  fitted.mirrored = *mirrored;
  fitted.points = mesh->points;
  if (fitted.grid && fitted.grid->frames > 1) fitted.frame = noted_frame(*mesh);
  if (fitted.frame && *fitted.frame >= fitted.grid->frames)
    return fail(files.file.string(), "belongs to frame " + std::to_string(*fitted.frame) + ", and its scan has " +
                                         std::to_string(fitted.grid->frames) +
                                         " frames; give the scan that it was "
                                         "fitted to");
  if (mesh->doubt_mm) fitted.doubt_mm = *mesh->doubt_mm;
  if (mesh->outlier) fitted.outlier = *mesh->outlier;
  fitted.doubt = doubt_of_shape(*mesh);
  auto record = record_of_row(job, name, progress);
  if (!record) return fail(record.error());
  fitted.record = std::move(*record);
  return write_case_of_fit(fitted, job.cases(), warnings);
}

/// A case whose template lies somewhere in its scan; one that is there already stays.
Result<StudyCase> case_of_scan(const MakeJob& job, const std::string& name, const RowFiles& files,
                               std::shared_ptr<const Volume> grid, RowsOfTable& rows, Progress& progress) {
  StudyCase one;
  one.name = name;
  one.file = absolute_path(job.cases() / (name + case_extension));
  one.from_scan = true;
  one.labels = files.labels;
  std::error_code ignored;
  if (fs::exists(one.file, ignored)) {
    auto same = check_template_of_case(one.file, rows.structure_of(name), *rows.the_template, rows.together);
    return same ? Result<StudyCase>(std::move(one)) : fail(same.error());
  }
  const fs::path& image = files.image.empty() ? files.labels : files.image;
  Document document = new_document(image.string(), std::move(grid), rows.the_template);
  document.hold_landmarks();
  auto record = record_of_row(job, name, progress);
  if (!record) return fail(record.error());
  auto made = create_case(std::move(document), one.file, {}, std::move(*record));
  if (!made) return fail(made.error());
  return one;
}

/// A case of a row whose shape is there already.
Result<StudyCase> case_of_shape(const std::string& name, const RowFiles& files, RowsOfTable& rows) {
  if (is_mesh_name(files.file)) {
    const auto mesh = read_mesh_file(files.file);
    if (!mesh) return fail(mesh.error());
    if (auto ours = mirrors_template(*mesh, files.file, *rows.the_template); !ours) return fail(ours.error());
  } else if (is_case_file(files.file)) {
    auto same = check_template_of_case(files.file, rows.structure_of(name), *rows.the_template, rows.together);
    if (!same) return fail(same.error());
  }
  StudyCase one;
  one.name = name;
  one.file = files.file;
  one.labels = files.labels;
  one.state = CaseState::in_work;
  return one;
}

Result<StudyCase> case_of_row(const MakeJob& job, const RowOfCase& row, RowsOfTable& rows, const std::string& where,
                              std::vector<std::string>& warnings, Progress& progress) {
  const auto files = files_of_row(row, rows.folder, where);
  if (!files) return fail(files.error());
  const fs::path& scan = files->image.empty() ? files->labels : files->image;
  const std::string name = name_of_row(row);
  std::shared_ptr<const Volume> grid;
  if (!scan.empty() && !is_case_file(files->file)) {
    VolumeReadOptions reading;
    reading.progress = &progress;
    const auto read = read_volume(scan, reading);
    if (!read) return fail(read.error());
    grid = grid_of(read->volume);
  }
  Result<StudyCase> one = StudyCase{};
  if (!files->file.empty() && (is_case_file(files->file) || scan.empty()))
    one = case_of_shape(name, *files, rows);
  else if (!files->file.empty())
    one = case_of_mesh(job, name, *files, std::move(grid), rows.the_template, warnings, progress);
  else
    one = case_of_scan(job, name, *files, std::move(grid), rows, progress);
  if (!one) return one;
  for (const auto& [column, text] : row) {
    if (column == "group")
      one->group = text;
    else if (column == "notes")
      one->notes = text;
    else if (column == "label" && !text.empty())
      one->label = value_of(text);
    else if (!is_own_column(column) && !text.empty())
      one->covariates[column] = value_of(text);
  }
  return one;
}

/// What a row is called in messages.
std::string words_of_row(const MakeJob& job, std::size_t k) {
  return job.row.empty() ? "row " + std::to_string(k + 1) : "the row of " + job.row;
}

/// What can be told of the rows before a case is made of any, so that a table that is wrong leaves none behind.
Result<void> check_rows(const MakeJob& job, const std::vector<RowOfCase>& rows, const fs::path& folder) {
  const std::string table = job.in.front().string();
  std::set<std::string> names;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::string where = words_of_row(job, k) + " of " + table, name = name_of_row(rows[k]);
    if (const auto files = files_of_row(rows[k], folder, where); !files) return fail(files.error());
    if (!is_file_name(name))
      return fail(where, "has the name \"" + name + "\", which cannot be a file's; choose another");
    if (!names.insert(name).second) return fail(table, "has two cases named \"" + name + "\"; rename one of them");
  }
  return {};
}

Result<std::vector<StudyCase>> cases_of_table(const MakeJob& job, const std::shared_ptr<const Template>& the_template,
                                              Report& report, Progress& progress) {
  const fs::path& table = job.in.front();
  auto rows = read_case_table(table);
  if (!rows) return fail(rows.error());
  if (!job.row.empty()) std::erase_if(*rows, [&](const RowOfCase& row) { return name_of_row(row) != job.row; });
  if (rows->empty()) return fail(table.string(), "has no case \"" + job.row + "\"; name one that it has with --case");
  RowsOfTable shared{absolute_path(table).parent_path(), the_template, {}, {}};
  if (auto checked = check_rows(job, *rows, shared.folder); !checked) return fail(checked.error());
  std::error_code ignored;
  if (fs::exists(job.out, ignored)) {
    const auto known = read_study(job.out);
    if (!known) return fail(known.error());
    for (const StudyCase& one : known->study.cases) shared.structures[one.name] = one.structure;
  }
  std::vector<StudyCase> cases(rows->size());
  std::vector<std::vector<std::string>> warnings(rows->size());
  const auto results = run_cases(
      rows->size(),
      [&](std::size_t k, Progress& own) -> Result<Report> {
        const std::string row = words_of_row(job, k);
        set_case_in_work(row);
        const std::string where = row + " of " + table.string();
        auto one = case_of_row(job, (*rows)[k], shared, where, warnings[k], own);
        if (!one) return fail(one.error());
        cases[k] = std::move(*one);
        return Report{};
      },
      progress);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (!results[k]) return fail(results[k].error());
    report.warnings.insert(report.warnings.end(), warnings[k].begin(), warnings[k].end());
  }
  return cases;
}

/// The record of a scan's case: of the command that makes it alone, of its image and its label map.
Result<std::string> record_of_scan(const MakeJob& job, const fs::path& file, const std::vector<fs::path>& scan,
                                   Progress& progress) {
  std::error_code ignored;
  // A scan of slices is a folder, which stands for the scans in it where it is given.
  const bool alone = std::ranges::none_of(scan, [&](const fs::path& one) { return fs::is_directory(one, ignored); });
  const auto record = record_of(alone ? job.command.with("CSV|MASK", scan) : job.command, progress);
  if (!record) return record;
  return record_of_made(*record, job.out, alone ? job.cases() / (file_stem(scan.front()) + case_extension) : file);
}

Result<std::vector<StudyCase>> cases_of_maps(const MakeJob& job, const std::shared_ptr<const Template>& the_template,
                                             Report& report, Progress& progress) {
  std::vector<std::vector<fs::path>> parts(1);  // loose files, then folder by folder
  std::error_code ignored;
  for (const fs::path& path : job.in)
    if (fs::is_directory(path, ignored))
      parts.push_back({path});
    else
      parts.front().push_back(path);
  CaseStart start{job.cases(), the_template, false, {}};
  start.record = [&](const fs::path& file, const std::vector<fs::path>& scan) {
    return record_of_scan(job, file, scan, progress);
  };
  std::vector<StudyCase> cases;
  for (const auto& part : parts) {
    if (part.empty()) continue;
    auto done = cases_of_scans(part, start, progress);
    if (!done) return fail(done.error());
    for (StudyCase& one : done->added) cases.push_back(std::move(one));
    report.warnings.insert(report.warnings.end(), done->warnings.begin(), done->warnings.end());
  }
  if (cases.empty())
    return fail(job.in.front().string(),
                "gave no case" + (report.warnings.empty() ? std::string() : ": " + report.warnings.front()));
  return cases;
}

Result<Report> make_study(const MakeJob& job, Progress& progress) {
  auto the_template = load_template(job.template_source);
  if (!the_template) return fail(the_template.error());
  const std::string remedy = "give that template, or another name of the study";
  if (auto same = check_template_of_study(job.out, {*the_template}, (*the_template)->source, remedy); !same)
    return fail(same.error());
  const auto folder = ResultFolder::make(job.cases());
  if (!folder) return fail(folder.error());
  const bool is_table = job.of_table();
  Report report;
  auto cases = is_table ? cases_of_table(job, *the_template, report, progress)
                        : cases_of_maps(job, *the_template, report, progress);
  if (progress.cancelled()) return fail("", "the study was cancelled");
  if (!cases) return fail(cases.error());
  std::size_t waiting = 0, without_labels = 0;
  for (const StudyCase& one : *cases) {
    waiting += one.waits() ? 1 : 0;
    without_labels += one.waits() && one.labels.empty() ? 1 : 0;
  }
  const std::size_t count = cases->size();
  const auto record = record_of(job.command, progress);
  if (!record) return fail(record.error());
  const auto added = write_cases_into(job.out, job.template_source, std::move(*cases), *record);
  if (!added) return fail(added.error());
  const auto written = read_study(job.out);
  if (!written) return fail(written.error());
  report.values = {{"study", job.out.string()},
                   {"cases", count},
                   {"added", *added},
                   {"waiting", waiting},
                   {"groups", written->study.groups()}};
  constexpr std::size_t enough = 5;  // subjects, from which on their consensus is the better template
  const auto mesh =
      is_built_in(job.template_source) ? Result<MeshFile>(MeshFile{}) : read_mesh_file(job.template_source);
  const bool of_all = mesh && std::any_of(mesh->comments.begin(), mesh->comments.end(), [](const std::string& comment) {
                        return comment.find("\"consensus\"") != std::string::npos;
                      });
  if (count - without_labels >= enough && !of_all)
    report.warnings.push_back(job.template_source +
                              ": is no consensus of these subjects, whose template would depend on no single one; make "
                              "it with template --consensus");
  if (without_labels > 0)
    report.warnings.push_back(std::to_string(without_labels) +
                              " cases have no label map, so they can be fitted in the window only");
  return report;
}

}  // namespace

Result<std::size_t> write_cases_into(const fs::path& study_file, const fs::path& the_template,
                                     std::vector<StudyCase> cases, const std::string& record) {
  Study study, alone;
  std::error_code ignored;
  if (fs::exists(study_file, ignored)) {
    auto read = read_study(study_file);
    if (!read) return fail(read.error());
    study = std::move(read->study);
  }
  study.template_file = is_built_in(the_template.string()) ? the_template : absolute_path(the_template);
  alone.template_file = study.template_file;
  alone.cases = cases;
  std::size_t added = 0;
  for (StudyCase& one : cases) {
    const auto known = std::find_if(study.cases.begin(), study.cases.end(),
                                    [&](const StudyCase& other) { return other.name == one.name; });
    if (known == study.cases.end()) {
      study.cases.push_back(std::move(one));
      ++added;
      continue;
    }
    known->file = one.file;
    known->labels = one.labels;
    known->from_scan = one.from_scan;
    if (one.frame) known->frame = one.frame;  // none of a case that stayed as it is
    if (!one.structure.empty()) known->structure = one.structure;
    if (known->state != CaseState::done) known->doubt = one.doubt;
    if (known->state == CaseState::to_do) known->state = one.state;
    if (!one.group.empty()) known->group = one.group;
    if (!one.notes.empty()) known->notes = one.notes;
    if (!one.label.is_null()) known->label = one.label;
    if (!one.covariates.empty()) known->covariates = one.covariates;
  }
  const std::string of_alone = study == alone ? record : std::string();
  if (auto written = write_study(study, study_file, of_alone); !written) return fail(written.error());
  return added;
}

void add_study_make(CLI::App& study, CommandLine& asked) {
  auto options = std::make_shared<MakeJob>();
  CLI::App* verb = add_verb(study, "make", "A study of scans and label maps, to fit and repair them in the window");
  verb->add_option("CSV|MASK", options->in,
                   "A table (.csv) with the columns name, image, labels, label, group, file (what is known of a case) "
                   "and any others, which are kept as covariates; or label maps, or a folder of them with their images")
      ->required();
  verb->add_option("--template", options->template_source, template_sources())->required();
  verb->add_option("-o,--output", options->out,
                   "The study to write (NAME.study.json); cases go into NAME-cases beside it")
      ->required()
      ->check([](const std::string& text) {
        return text.empty() || text.ends_with(".study.json") ? std::string()
                                                             : text + " is no name of a study; use NAME.study.json";
      });
  verb->add_option("--case", options->row, "Of a table this case alone, by its name");
  verb->callback([options, verb, &asked] {
    if (!options->of_table()) refuse_without_effect(*verb, "--case", "a table");
    options->command = given_command(*verb);
    asked.run = [options](Progress& progress) { return make_study(*options, progress); };
  });
}

}  // namespace homolog
