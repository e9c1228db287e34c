#include "app/verbs/report/report_content.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "app/verbs/report/report_measurements.h"
#include "app/verbs/statistics/test_cases.h"
#include "core/base/files/file_stem.h"
#include "core/base/text/text_table.h"
#include "core/model/files/model_files.h"
#include "core/model/files/statismo.h"
#include "core/model/measures/leave_one_out.h"
#include "core/model/shapes/shape_files.h"
#include "core/model/shapes/study.h"
#include "core/statistics/covariates.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr int most_modes_by_default = 10;
constexpr double share_of_distances = 0.95;  ///< of the variance, that the modes hold in which distances are taken

/// "kidneys" of "folder/kidneys.study.json" and of "kidneys.h5.json".
std::string plain_title(const fs::path& file) {
  std::string name = file.filename().empty() ? file.parent_path().filename().string() : file.filename().string();
  for (const std::string ending : {".study.json", ".h5.json", ".h5"})
    if (name.ends_with(ending)) return name.substr(0, name.size() - ending.size());
  return file_stem(name);
}

/// The command without folders and without the page's name, so that the page is the same under each. Many shapes become
/// their number.
std::string plain_command(const ReportVerb& verb) {
  std::string command = "homolog report";
  const TrainingVerb& training = verb.training;
  if (training.files.size() > 3 || verb.without_names)
    command += " (" + std::to_string(training.files.size()) + (training.files.size() == 1 ? " file)" : " files)");
  else
    for (const fs::path& file : training.files) command += ' ' + file.filename().string();
  if (training.keep_scale) command += " --keep-scale";
  if (training.no_align) command += " --no-align";
  if (training.reading.all_frames) command += " --all-frames";
  if (training.reading.flip_mirrored) command += " --flip-mirrored";
  if (training.reading.without_doubtful) command += " --without-doubtful";
  if (!training.reading.group.empty()) command += " --group " + training.reading.group;
  if (!training.structures.empty()) command += " --structures " + listed(training.structures, ",");
  if (training.together != "common") command += " --alignment " + training.together;
  if (training.world) command += " --world";
  if (!verb.recipe.empty()) command += " --recipe " + fs::path(verb.recipe).filename().string();
  if (!verb.the_template.empty()) command += " --template " + fs::path(verb.the_template).filename().string();
  if (!verb.left_out.empty()) command += " --left-out " + verb.left_out.filename().string();
  if (verb.modes > 0) command += " --modes " + std::to_string(verb.modes);
  if (verb.without_names) command += " --without-names";
  if (verb.samples != ReportVerb().samples) command += " --samples " + std::to_string(verb.samples);
  return command;
}

/// How many modes the page has. Errors: more are asked for than there are.
Result<Eigen::Index> shown_modes(const ReportVerb& verb, const Eigen::VectorXd& variances) {
  const Eigen::Index there = (variances.array() > 0).count();
  if (verb.modes > there)
    return fail("--modes " + std::to_string(verb.modes),
                "is more than there are; the most is " + std::to_string(there));
  if (verb.modes > 0) return verb.modes;
  return std::min<Eigen::Index>(most_modes_by_default, modes_holding(variances, 0.95));
}

/// Keeps the first modes of a model, which has at least as many.
void keep_modes(ShapeModel& model, Eigen::Index count) {
  model.basis.conservativeResize(Eigen::NoChange, count);
  model.variances.conservativeResize(count);
  if (model.scores.size() > 0) model.scores.conservativeResize(count, Eigen::NoChange);
}

/// The distances of the cases, each from the model of the others.
void put_distances(PageContent& content) {
  const Eigen::VectorXd& distances = content.model.left_out_distances;
  for (PageCase& one : content.cases)
    if (one.shape >= 0 && one.shape < distances.size()) one.distance_sd = distances[one.shape];
}

/// Cases of the model, named as the model names them.
std::vector<PageCase> named_cases(const ShapeModel& model) {
  std::vector<PageCase> cases;
  for (Eigen::Index k = 0; k < model.scores.cols(); ++k) {
    PageCase one;
    const auto at = static_cast<std::size_t>(k);
    one.name = at < model.names.size() ? model.names[at] : "shape " + std::to_string(k + 1);
    one.shape = k;
    cases.push_back(std::move(one));
  }
  return cases;
}

Result<PageContent> content_of_model(const ReportVerb& verb) {
  const fs::path& file = verb.training.files.front();
  auto model = read_model(file);
  if (!model) return fail(model.error());
  if (!model->topology)
    return fail(file.string(), "is a model of points without faces, which cannot be drawn; report on its meshes");
  if (model->modes() == 0) return fail(file.string(), "has no mode to show; make the model of different shapes");
  PageContent content;
  content.from_model = true;
  content.variances = model->variances;
  content.cases = named_cases(*model);
  if (model->scores.size() > 0) content.shapes = (model->basis * model->scores).colwise() + model->mean;
  const auto modes = shown_modes(verb, model->variances);
  if (!modes) return fail(modes.error());
  if (model->left_out_distances.size() > 0) content.distance_modes = model->modes();
  keep_modes(*model, *modes);
  content.model = std::move(*model);
  put_distances(content);
  return content;
}

/// Doubts of the cases' vertices, by the names of the set.
Result<void> put_doubts(const ReportVerb& verb, const Training& training, PageContent& content, Progress& progress) {
  if (!training.parts.empty()) return {};
  const auto sources = shape_sources(verb.training.files, verb.training.reading.group);
  if (!sources) return fail(sources.error());
  std::map<std::string, PageCase*> of_name;
  for (PageCase& one : content.cases)
    if (one.shape >= 0) of_name[training.names[one.shape]] = &one;
  VertexScalars squares = VertexScalars::Zero(training.components.vertices());
  const auto take = [&](const ReadShape& shape) {
    const auto& doubt = shape.mesh->doubt_mm;
    const auto found = of_name.find(shape.name);
    if (found == of_name.end() || !doubt || doubt->size() != squares.size()) return Result<void>();
    found->second->doubt_mm = std::sqrt(doubt->cwiseAbs2().mean());
    squares += doubt->cwiseAbs2();
    ++content.doubt_cases;
    return Result<void>();
  };
  if (auto read = read_shapes(*sources, {verb.training.reading.all_frames}, take, &progress); !read)
    return fail(read.error());
  if (content.doubt_cases > 0) content.doubt_mm = (squares / static_cast<double>(content.doubt_cases)).cwiseSqrt();
  return {};
}

/// Why a study's case is not in the model.
std::string why_excluded(const StudyCase& one, const std::string& key, const ReportVerb& verb,
                         const std::map<std::string, std::string>& left_out) {
  if (const auto reason = left_out.find(key); reason != left_out.end()) return reason->second;
  const std::string& group = verb.training.reading.group;
  if (!group.empty() && one.group != group) return "is not of the group " + group;
  return one.waits() ? "has no shape yet" : "its file could not be read";
}

/// The cases of the set with what studies know of them, then those that were left out.
Result<std::vector<PageCase>> cases_of_set(const ReportVerb& verb, const Training& training) {
  std::vector<fs::path> studies;
  for (const fs::path& file : verb.training.files)
    if (is_study_file(file)) studies.push_back(file);
  const auto known = cases_of_studies(studies);
  if (!known) return fail(known.error());
  std::map<std::string, std::string> doubtful;
  std::map<std::string, std::string> left_out;  // by the study's case, or the name where it is of none
  for (const DoubtfulShape& one : training.doubtful) doubtful.emplace(one.name, one.reason);
  for (const DoubtfulShape& one : training.left_out) {
    const bool of_study = std::ranges::any_of(one.study_keys, [&](const auto& key) { return known->contains(key); });
    if (!of_study) left_out.emplace(one.name, one.reason);
    for (const std::string& key : one.study_keys) left_out.emplace(key, one.reason);
  }
  const auto names = training.parts.empty() ? names_with_folders(training.names) : training.names;
  std::vector<PageCase> cases;
  std::set<std::string> in_model;
  for (std::size_t k = 0; k < names.size(); ++k) {
    PageCase one;
    const std::string& file = training.names[k];
    const auto& keys = training.study_keys[k];
    const auto of_study = keys.empty() ? known->end() : known->find(keys.front());
    const bool is_one_case = of_study != known->end() && training.parts.empty() && !verb.training.reading.all_frames;
    one.name = is_one_case ? of_study->second.name : names[k];
    one.flipped = of_study != known->end() && of_study->second.flipped;
    if (!training.groups.empty()) one.group = training.groups[k];
    if (const auto reason = doubtful.find(file); reason != doubtful.end()) one.doubt = reason->second;
    one.size_mm = training.sizes_mm[k];
    one.shape = static_cast<Eigen::Index>(k);
    in_model.insert(keys.begin(), keys.end());
    cases.push_back(std::move(one));
  }
  for (const auto& [key, of_study] : *known) {
    if (in_model.contains(key)) continue;
    PageCase one;
    one.name = of_study.name;
    one.group = of_study.group;
    one.doubt = of_study.doubt;
    one.excluded = why_excluded(of_study, key, verb, left_out);
    left_out.erase(key);
    cases.push_back(std::move(one));
  }
  for (const auto& [file, reason] : left_out) {
    PageCase one;
    one.name = training.parts.empty() ? file_stem(file) : file;
    one.excluded = reason;
    cases.push_back(std::move(one));
  }
  return cases;
}

/// The name of the template of the first study, without its folder.
std::string template_name_of(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    if (!is_study_file(file)) continue;
    const auto read = read_study(file);
    if (read && !read->study.template_file.empty()) return read->study.template_file.filename().string();
  }
  return {};
}

Result<PageContent> content_of_set(const ReportVerb& verb, Progress& progress) {
  progress.part(0, 0.4);
  auto training = train(verb.training, progress);
  if (!training) return fail(training.error());
  if (!training->topology)
    return fail(verb.training.files.front().string(),
                "has points without faces, which cannot be drawn; give one mesh of the same numbering with them");
  PageContent content;
  content.template_name = template_name_of(verb.training.files);
  auto cases = cases_of_set(verb, *training);
  if (!cases) return fail(cases.error());
  content.cases = std::move(*cases);
  progress.part(0.4, 0.7);
  if (auto put = put_doubts(verb, *training, content, progress); !put) return fail(put.error());
  progress.part(0.7, 0.9);
  const PrincipalComponents& components = training->components;
  content.variances = components.variances();
  const auto modes = shown_modes(verb, content.variances);
  if (!modes) return fail(modes.error());
  std::vector<std::string> names;
  for (const PageCase& one : content.cases)
    if (one.shape >= 0) names.push_back(one.name);
  content.model = model_of_modes(components, *modes, training->topology, names);
  content.distance_modes = modes_holding(components.variances(), share_of_distances);
  content.model.left_out_distances = left_out_distances(components, content.distance_modes);
  put_distances(content);
  content.flipped =
      static_cast<Eigen::Index>(training->flipped) + std::ranges::count(content.cases, true, &PageCase::flipped);
  content.model.parts = training->parts;
  content.model.alignment = verb.training.alignment();
  content.shapes = components.centred.colwise() + components.mean;
  if (components.shapes() > 2) {
    content.samples = verb.samples;
    content.generalisation_rms = generalisation_rms(components);
    content.specificity_rms = specificity_rms(components, verb.samples, 1);
  }
  if (progress.cancelled()) return fail("", "cancelled");
  content.warnings = std::move(training->warnings);
  return content;
}

/// "is empty" of "homolog: masks/k1.nii.gz: is empty": a page needs no path, which may name a patient.
std::string reason_alone(std::string reason, const std::string& name) {
  const std::string program = "homolog: ";
  if (reason.starts_with(program)) reason.erase(0, program.size());
  const std::size_t end = reason.find(": ");
  if (end != std::string::npos && reason.substr(0, end).find(name) != std::string::npos) reason.erase(0, end + 2);
  return reason;
}

/// Puts the cases of a table behind the others. Errors: read_covariates', no column of reasons.
Result<void> put_left_out(const ReportVerb& verb, PageContent& content) {
  const auto table = read_covariates(verb.left_out);
  if (!table) return fail(table.error());
  const auto failed = table->column("failed"), reasons = failed ? failed : table->column("reason");
  if (!reasons)
    return fail(table->source, "has no column failed or reason; give one that says why each case is left out");
  std::set<std::string> known;
  for (const PageCase& one : content.cases) known.insert(one.name);
  for (std::size_t k = 0; k < table->cases.size(); ++k) {
    const std::string& name = table->cases[k];
    if (is_missing(table->cells[k][*reasons])) continue;
    if (known.contains(name)) {
      content.warnings.push_back(table->source + ": names " + name + ", which is among the shapes");
      continue;
    }
    PageCase one;
    one.name = name;
    one.excluded = reason_alone(table->cells[k][*reasons], name);
    const bool may_name = one.excluded.find(name) != std::string::npos ||
                          one.excluded.find_first_of("/\\") != std::string::npos;  // a path may name a patient
    if (verb.without_names && may_name) one.excluded = "could not be taken";
    content.cases.push_back(std::move(one));
  }
  return {};
}

}  // namespace

Eigen::Index PageContent::cases_in_model() const {
  return std::count_if(cases.begin(), cases.end(), [](const PageCase& one) { return one.shape >= 0; });
}

std::vector<std::string> PageContent::groups() const {
  std::vector<std::string> names;
  for (const PageCase& one : cases)
    if (one.shape >= 0 && !one.group.empty() && std::find(names.begin(), names.end(), one.group) == names.end())
      names.push_back(one.group);
  return names;
}

Result<PageContent> page_content(const ReportVerb& verb, Progress& progress) {
  const std::vector<fs::path>& files = verb.training.files;
  auto content =
      files.size() == 1 && is_model_name(files.front()) ? content_of_model(verb) : content_of_set(verb, progress);
  if (!content) return content;
  if (!verb.recipe.empty() || !verb.the_template.empty())
    if (auto measured = measure_page(verb, *content, progress); !measured) return fail(measured.error());
  if (!verb.left_out.empty())
    if (auto put = put_left_out(verb, *content); !put) return fail(put.error());
  const bool names_cases = files.size() > 1 || !(is_study_file(files.front()) || is_model_name(files.front()));
  content->title = !verb.title.empty()                 ? verb.title
                   : verb.without_names && names_cases ? "Shapes"
                                                       : plain_title(files.front());
  content->command = plain_command(verb);
  if (verb.without_names)
    for (std::size_t k = 0; k < content->cases.size(); ++k) content->cases[k].name = "case " + std::to_string(k + 1);
  return content;
}

}  // namespace homolog
