#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "app/verbs/case_of_fit.h"
#include "app/verbs/input_folders.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "app/verbs/set/set_cases.h"
#include "app/verbs/study/study_make.h"
#include "app/verbs/verbs.h"
#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/text/listed.h"
#include "core/model/files/statismo.h"
#include "core/placement/similarity_fit.h"
#include "core/session/case_file.h"
#include "core/structures/repair/repair.h"
#include "core/volume/formats/formats.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/readers.h"
#include "core/volume/referenced_images.h"

// The verb `repair`: what is wrong with the structures of label maps, and maps that are mended.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct MapRepairJob {
  std::vector<fs::path> maps;
  std::string set;
  fs::path image, model, out;
  std::optional<int> frame;
  GivenCommand command;
};

Json row_of_repair(const TemplateOfSet& structure, const RepairedStructure& found, const StructureSigns& signs,
                   const FittedStructure& fitted) {
  Json defects = Json::array();
  for (const Defect& defect : found.defects)
    defects.push_back({{"kind", defect_name(defect.kind)}, {"with", defect.with.empty() ? Json() : Json(defect.with)}});
  double lost = 0;
  for (const auto& [other, share] : signs.lost_to) lost = std::max(lost, share);
  return {{"name", structure.name},
          {"confidence", found.confidence},
          {"p_named", found.p_named},
          {"proposed_name", found.proposed_name},
          {"defects", std::move(defects)},
          {"changed_voxels", found.changed_voxels},
          {"signs",
           {{"islands", signs.islands},
            {"holes", signs.holes},
            {"tunnels", signs.tunnels},
            {"bars", signs.bars},
            {"bar_reach", signs.bar_reach},
            {"bridges", signs.bridges},
            {"volume", signs.volume},
            {"lacking", signs.lacking},
            {"beyond", signs.beyond},
            {"lost", lost},
            {"doubt", fitted.judgement.doubt_share},
            {"dice", fitted.fit && !fitted.judgement.rim ? Json(fitted.judgement.inside_scan.dice) : Json()},
            {"off_place", fitted.off_place}}}};
}

/// Writes a mended map as it was read: under its name, in its format, or .seg.nrrd where that format is not written.
Result<fs::path> write_mended(const MapRepairJob& job, const VolumeRead& map, const NamedMap& of,
                              const std::string& record, std::vector<std::string>& warnings) {
  std::error_code error;
  const fs::path &folder = job.out, &from = of.path;
  if (fs::equivalent(folder, from.parent_path().empty() ? fs::path(".") : from.parent_path(), error))
    return fail(folder.string(), "holds the map that is mended, which would be written over; give another folder");
  const std::string name = absolute_path(from / "x").parent_path().filename().string();
  // What stands before the name of the case stands before that of the file too.
  const std::string before = of.name.substr(0, of.name.size() - of.alone.size());
  if (fs::is_directory(from, error)) {
    const fs::path masks = folder / (before + name);
    const auto made = ResultFolder::make(masks);
    if (!made) return fail(made.error());
    if (auto written = write_single_masks(map, masks, from); !written) return fail(written.error());
    return masks;
  }
  fs::path file = folder / (before + name);
  if (!has_ending(file, label_map_endings())) {
    file = folder / (file_stem(file) + ".seg.nrrd");
    warnings.push_back(from.string() + ": its format is not written, so the mended map is " + file.string());
  }
  const std::string of_file = record_of_output(record, file.filename().string().substr(before.size()));
  if (auto written = write_segmentation(map, file, nullptr, of_file); !written) return fail(written.error());
  return file;
}

/// What a person has to look at, as a sentence.
std::string sentence_of_repaired(const RepairedStructure& found) {
  return found.defects.empty() ? "Little confidence in this structure." : sentence_of_defects(found.defects);
}

/// "vertebrae_L3: half_missing; vertebrae_L4: island, hole", as the readable report says it; "nothing".
std::string found_in_words(const TemplateSet& set, const RepairedMap& repaired) {
  std::vector<std::string> found;
  for (std::size_t k = 0; k < repaired.structures.size(); ++k) {
    std::vector<std::string> kinds;
    for (const Defect& defect : repaired.structures[k].defects) kinds.emplace_back(defect_name(defect.kind));
    if (!kinds.empty()) found.push_back(set.structures[k].name + ": " + listed(kinds, ", "));
  }
  return found.empty() ? "nothing" : listed(found, "; ");
}

/// Whether a structure was missing and is in the map that is proposed.
bool is_put_in(const RepairedMap& repaired, std::size_t k) {
  return !repaired.fitted.structures[k].fit && repaired.structures[k].changed_voxels > 0 && repaired.expected[k];
}

/// The structures that a person has to look at, the least sure one first, as cases of a study.
Result<std::vector<StudyCase>> write_worklist(const MapRepairJob& job, const SetOfTemplates& set, const NamedMap& of,
                                              const SubjectMap& map, const RepairedMap& repaired,
                                              const fs::path& mended, const std::string& record,
                                              std::vector<std::string>& warnings) {
  constexpr double sure = 0.8;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < repaired.structures.size(); ++k) {
    const RepairedStructure& one = repaired.structures[k];
    const bool has_fit = repaired.fitted.structures[k].fit.has_value();
    if ((has_fit && (!one.defects.empty() || one.confidence < sure)) || is_put_in(repaired, k))
      order.emplace_back(one.confidence, k);
  }
  std::ranges::sort(order);
  std::vector<StudyCase> cases;
  if (order.empty()) return cases;
  const fs::path folder = job.out / (of.name + "-cases");
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());
  for (const auto& [confidence, k] : order) {
    const FittedStructure& fit = repaired.fitted.structures[k];
    FittedCase fitted;
    const std::string structure = "-" + file_name_of_structure(set.set.structures[k].name);
    fitted.name = of.name + structure;
    fitted.image = job.image.empty() ? of.path : job.image;
    fitted.labels = mended;
    fitted.grid = grid_of(map.read.volume);
    fitted.template_of_file = set.templates[repaired.structures[k].structure];
    if (fit.fit) {
      fitted.points = fit.fit->mesh.points;
      fitted.placement = fit.fit->placement;
      fitted.doubt_mm = fit.fit->doubt_mm;
    } else {
      fitted.points = repaired.expected[k]->points;
      fitted.placement = nearest_similarity(fitted.template_of_file->points, fitted.points, {});
    }
    fitted.doubt = sentence_of_repaired(repaired.structures[k]);
    if (map.read.volume.frames > 1) fitted.frame = map.frame;
    fitted.record = record_of_output(record, of.alone + "-cases/" + of.alone + structure + case_extension);
    auto one = write_case_of_fit(fitted, folder, warnings);
    if (!one) return fail(one.error());
    cases.push_back(std::move(*one));
  }
  return cases;
}

/// Errors: none of the structures lies within the image.
Result<void> check_meeting(const MapRepairJob& job, const fs::path& path, const SetInMap& subject,
                           const Volume* image) {
  if (image == nullptr) return {};
  const Box scan = image->geometry.bounds_mm();
  Box all;
  for (const StructureInMap& one : subject.structures) {
    if (!one.is_there()) continue;
    const Box own = one.mask->geometry.bounds_mm();
    if (own.intersects(scan)) return {};
    all.extend(own);
  }
  if (all.isEmpty()) return {};
  char text[80];
  std::snprintf(text, sizeof text, "lies %.0f mm outside of ", std::sqrt(scan.squaredExteriorDistance(all)));
  return fail(path.string(), text + job.image.string() + "; give the scan that it is of");
}

Result<Report> repair_one(const MapRepairJob& job, const SetOfTemplates& set, const SetModel* model, const NamedMap& of,
                          std::vector<StudyCase>& worklist, Progress& progress) {
  const fs::path& path = of.path;
  auto map = read_subject(path, job.frame, progress);
  if (!map) return fail(map.error());
  MapRepairOptions options;
  options.progress = &progress;
  options.model = model;
  std::optional<VolumeRead> image;
  if (!job.image.empty()) {
    auto read = read_image(job.image, map->frame, progress);
    if (!read) return fail(read.error());
    image = std::move(*read);
    options.image = &image->volume;
    options.image_frame = map->frame;
  }
  const SetInMap subject = find_in_map(set.set, map->read, map->frame);
  if (auto known = check_structures(subject, set.set, path); !known) return fail(known.error());
  if (auto met = check_meeting(job, path, subject, options.image); !met) return fail(met.error());
  std::optional<std::string> made_on_others;
  if (image) {
    auto other = check_scan(path, map->read.volume.frame_of_reference, map->read.referenced, job.image, image->volume);
    if (!other) return fail(other.error());
    made_on_others = std::move(*other);
  }
  const auto repaired = repair_map(set, map->read, map->frame, options);
  if (!repaired) return fail(path.string(), repaired.error().what);
  Report report;
  report.warnings = map->read.warnings;
  if (made_on_others) report.warnings.push_back(std::move(*made_on_others));
  for (const StructureInMap& one : subject.structures)
    if (!one.why_left_out.empty())
      report.warnings.push_back(path.string() + ": " + one.segment.name + " is left as it is: " + one.why_left_out);
  for (const Variant& variant : repaired->variants)
    report.warnings.push_back(path.string() + ": " + sentence_of(variant, set));
  if (const std::string found = found_by_values(set.set, subject); !found.empty())
    report.warnings.push_back(path.string() + ": " + found);
  std::vector<std::string> absent;
  for (std::size_t k = 0; k < set.set.structures.size(); ++k)
    if (!subject.structures[k].is_there() && subject.structures[k].why_left_out.empty() &&
        repaired->structures[k].defects.empty() && !is_absent(repaired->variants, k))
      absent.push_back(set.set.structures[k].name);
  if (!absent.empty())
    report.warnings.push_back(path.string() + ": has no voxel of " + some_of(absent) +
                              ", and nothing tells that it should; they are not filled in");
  std::vector<std::string> without = subject.without_template;
  for (const auto& [name, now] : repaired->renamed_without) {
    report.warnings.push_back(path.string() + ": " + name + ", for which the set has no template, is called " + now +
                              " with the levels beside it");
    std::erase(without, name);
  }
  if (!without.empty())
    report.warnings.push_back(path.string() + ": has " + some_of(without) +
                              ", for which the set has no template; left as they are");
  const auto record = record_of(job.command.with("MAP", {path}), progress);
  if (!record) return fail(record.error());
  const auto file = write_mended(job, map->read, of, *record, report.warnings);
  if (!file) return fail(file.error());
  auto cases = write_worklist(job, set, of, *map, *repaired, *file, *record, report.warnings);
  if (!cases) return fail(cases.error());
  worklist.insert(worklist.end(), cases->begin(), cases->end());
  Json rows = Json::array();
  for (std::size_t k = 0; k < repaired->structures.size(); ++k)
    rows.push_back(row_of_repair(set.set.structures[k], repaired->structures[k], repaired->signs[k],
                                 repaired->fitted.structures[k]));
  report.values = {{"name", of.name},
                   {"case", path.string()},
                   {"file", file->string()},
                   {"found", found_in_words(set.set, *repaired)},
                   {"variants", json_of_variants(repaired->variants, set.set)},
                   {"structures", std::move(rows)}};
  return report;
}

/// The joint model that was given, if any.
Result<std::optional<SetModel>> model_of(const MapRepairJob& job, const SetOfTemplates& set) {
  if (job.model.empty()) return std::optional<SetModel>();
  const auto model = read_model(job.model);
  if (!model) return fail(model.error());
  auto of_set = set_model(*model, set);
  if (!of_set) return fail(job.model.string(), of_set.error().what);
  return std::optional<SetModel>(std::move(*of_set));
}

Result<Report> repair_maps(const MapRepairJob& job, Progress& progress) {
  if (auto there = check_there({job.image}); !there) return fail(there.error());
  const auto set = load_set_of_templates(job.set);
  if (!set) return fail(set.error());
  const auto model = model_of(job, *set);
  if (!model) return fail(model.error());
  const auto maps = named_maps(maps_of(job.maps, set->set));
  if (!maps) return fail(maps.error());
  std::vector<StudyCase> worklist;
  auto report = run_set_cases(
      *set, *maps, job.out, "repaired",
      [&](const NamedMap& map, Progress& own) {
        return repair_one(job, *set, *model ? &**model : nullptr, map, worklist, own);
      },
      progress);
  if (!report || worklist.empty()) return report;
  const fs::path study = job.out / "worklist.study.json";
  const auto record = record_of(job.command, progress);
  if (!record) return fail(record.error());
  // Done again elsewhere, the command would name the cases otherwise.
  const std::string of_study =
      are_named_by_files(*maps) ? record_of_output(*record, study.filename().string()) : std::string();
  const auto written = write_cases_into(study, {}, std::move(worklist), of_study);
  if (!written) return fail(written.error());
  report->values["study"] = study.string();
  return report;
}

}  // namespace

void add_repair(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<MapRepairJob>();
  CLI::App* verb = add_verb(app, "repair", "Finds what is wrong with the structures of label maps, and mends it");
  verb->add_option("MAP", job->maps, "Label maps of several structures, or folders of them")->required();
  verb->add_option("--templates", job->set, "The template set, NAME.set.json")->required();
  verb->add_option("--model", job->model,
                   "A joint model (.h5, .h5.json) of the set's structures: says how what is missing lies and looks");
  verb->add_option("--image", job->image, "The scan: what is filled in goes to the boundary that it shows");
  verb->add_option("--frame", job->frame, "Which frame of a label map with several")->check(CLI::Range(0, 100000));
  verb->add_option("-o,--output", job->out, "The folder for the mended maps, each under its own name")->required();
  verb->callback([job, verb, &asked] {
    if (!job->image.empty() && job->maps.size() > 1) throw CLI::ValidationError("--image", "is for one map only");
    job->command = given_command(*verb);
    asked.run = [job](Progress& progress) { return repair_maps(*job, progress); };
  });
}

}  // namespace homolog
