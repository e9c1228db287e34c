#include "app/verbs/fit/fit_sets.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "app/verbs/case_of_fit.h"
#include "app/verbs/set/set_cases.h"
#include "app/verbs/study/study_make.h"
#include "app/verbs/study/study_templates.h"
#include "core/base/files/files.h"
#include "core/base/numbers/statistics.h"
#include "core/base/text/listed.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/parts/rims.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "core/structures/fitting/fit_set.h"
#include "core/structures/maps/set_map.h"
#include "core/structures/naming/right_names.h"
#include "core/volume/labels/label_boxes.h"
#include "core/volume/labels/write_segmentation.h"

// `fit` with a template set: all structures of a scan at once.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The grid to write on: that of the map's first layer, and further where another one reaches beyond it.
VolumeGeometry grid_of_all(const VolumeRead& map) {
  VolumeGeometry grid = map.volume.geometry;
  for (const Volume& layer : map.other_layers)
    if (!same_grid(layer.geometry, map.volume.geometry)) grid = grid_over(grid, layer.geometry.bounds_mm());
  return grid;
}

Json row_of_fit(const TemplateOfSet& structure, const StructureInMap& there, const FittedStructure& one) {
  Json row{{"name", structure.name},
           {"value", there.segment.value},
           {"dice", nullptr},
           {"assd_mm", nullptr},
           {"doubt_mm", nullptr},
           {"confidence", one.confidence},
           {"p_named", one.fit ? Json(one.p_named) : Json()},
           {"doubtful", !one.fit || one.judgement.doubtful},
           {"missing", !there.is_there() && there.why_left_out.empty()}};
  if (!one.why_not.empty()) row["error"] = one.why_not;
  if (!one.fit) return row;
  if (const auto& rim = one.judgement.rim)
    row["rim_mm"] = {{"mean", rim->mean_mm}, {"p95", rim->p95_mm}};
  else
    row["dice"] = one.judgement.inside_scan.dice;
  row["assd_mm"] = one.judgement.inside_scan.assd_mm;
  const VertexScalars& doubt = one.fit->doubt_mm;
  row["doubt_mm"] = {{"mean", doubt.mean()}, {"p95", quantile(std::vector<double>(doubt.begin(), doubt.end()), 0.95)}};
  row["closing_mm"] = one.closing_mm;
  if (one.off_place >= 0) row["off_place"] = one.off_place;
  row["by_neighbours"] = one.by_neighbours;
  return row;
}

/// What a person has to know of a case, each a sentence.
std::vector<std::string> words_of(const SetOfTemplates& set, const SetInMap& subject, const FittedSet& fitted,
                                  const std::vector<Variant>& variants) {
  std::vector<std::string> words, missing, failed;
  for (std::size_t k = 0; k < fitted.structures.size(); ++k) {
    const FittedStructure& one = fitted.structures[k];
    const std::string& name = set.set.structures[k].name;
    const StructureInMap& there = subject.structures[k];
    if (!there.why_left_out.empty())
      words.push_back(name + " is left out: " + there.why_left_out);
    else if (!there.is_there() && is_absent(variants, k))
      continue;
    else if (!there.is_there())
      missing.push_back(name);
    else if (!one.why_not.empty())
      words.push_back(name + " could not be fitted: " + one.why_not);
    if (!one.fit) continue;
    if (const std::string closed = closed_flat(*one.fit->mesh.topology); !closed.empty())
      words.push_back(name + " " + closed);
    if (!one.why_whole.empty()) words.push_back(name + ": " + one.why_whole);
    if (!one.judgement.doubtful) continue;
    words.push_back(name + " is doubtful: " + reason_of_doubt(one.judgement.warnings));
  }
  for (const KeptApart& pair : fitted.apart) {
    if (!pair.too_near) continue;
    char text[160];
    std::snprintf(text, sizeof text,
                  pair.mm < 0 ? " lie up to %.1f mm within each other" : " came no farther apart than %.1f mm",
                  std::abs(pair.mm));
    words.push_back(set.set.structures[pair.a].name + " and " + set.set.structures[pair.b].name + text +
                    ", since farther apart their meshes would fold; look at both");
  }
  for (const Variant& variant : variants) words.push_back(sentence_of(variant, set));
  if (std::string found = found_by_values(set.set, subject); !found.empty()) words.push_back(std::move(found));
  if (!missing.empty())
    words.push_back("has no voxel of " + some_of(missing) + ", which the set has; they are left out");
  if (!subject.without_template.empty())
    words.push_back("has " + some_of(subject.without_template) + ", for which the set has no template; left out");
  return words;
}

/// Writes what was fitted: a mesh each, and a label map of all; how many voxels two meshes hold.
Result<std::size_t> write_fits(const FitJob& options, const SetOfTemplates& set, const SetInMap& subject,
                               const SubjectMap& map, const NamedMap& of, FittedSet& fitted,
                               const std::string& record) {
  const auto folder = ResultFolder::make(options.out / of.name);
  if (!folder) return fail(folder.error());
  std::vector<MeshOfSegment> meshes;
  std::vector<std::size_t> place(fitted.structures.size());  // among the meshes
  for (std::size_t k = 0; k < fitted.structures.size(); ++k) {
    const FittedStructure& one = fitted.structures[k];
    if (!one.fit) continue;
    place[k] = meshes.size();
    MeshFile file = fitted_file(*set.templates[k], *one.fit, false);
    if (map.read.volume.frames > 1) note_frame(file, map.frame);
    if (one.judgement.doubtful) file.comments.push_back(doubt_comment(reason_of_doubt(one.judgement.warnings)));
    const std::string output = "/" + file_name_of_structure(set.set.structures[k].name) + ".ply";
    file.record = record_of_output(record, of.alone + output);
    if (auto written = write_mesh_file(file, options.out / (of.name + output)); !written) return fail(written.error());
    meshes.push_back({subject.structures[k].segment, one.fit->mesh});
  }
  std::vector<MeshPair> apart;
  for (const KeptApart& pair : fitted.apart) apart.push_back({place[pair.a], place[pair.b]});
  const auto labels = map_of_meshes(meshes, grid_of_all(map.read), apart);
  const std::string output = ".seg.nrrd";
  auto written = write_segmentation(labels.map, options.out / (of.name + output), nullptr,
                                    record_of_output(record, of.alone + output));
  if (!written) return fail(written.error());
  return labels.contested_voxels;
}

/// What the cases of a run become in a study: the structure that the most of them have is that of its model.
struct CasesOfSet {
  std::vector<StudyCase> cases;
  std::vector<std::vector<std::size_t>> fitted;  ///< of each case, by the set's order
  std::vector<char> stays;                       ///< 1: the case was worked on and is as it was
};

/// Fits the set to one map, writes what came of it, and adds its case to `made`.
Result<Report> fit_subject(const FitJob& options, const SetOfTemplates& set, const NamedMap& of, CasesOfSet& made,
                           Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const fs::path& path = of.path;
  const auto map = read_subject(path, options.frame, progress);
  if (!map) return fail(map.error());
  const auto started = Clock::now();
  const SetInMap subject = find_in_map(set.set, map->read, map->frame);
  if (auto known = check_structures(subject, set.set, path); !known) return fail(known.error());
  auto fitted = fit_set(set, subject, {options.gap_mm, &progress});
  if (!fitted) return fail(path.string(), fitted.error().what);
  doubt_names(set, map->read, map->frame, subject, *fitted);
  const auto record = record_of(options.command.with("--mask", {path}), progress);
  if (!record) return fail(record.error());
  const auto contested = write_fits(options, set, subject, *map, of, *fitted, *record);
  if (!contested) return fail(contested.error());
  Report report;
  auto one = write_case_of_set(set, of, *map, subject, *fitted, options.out, *record, report.warnings);
  if (!one) return fail(one.error());
  made.cases.push_back(std::move(*one));
  made.stays.push_back(report.warnings.empty() ? 0 : 1);
  made.fitted.emplace_back();
  for (std::size_t k = 0; k < fitted->structures.size(); ++k)
    if (fitted->structures[k].fit) made.fitted.back().push_back(k);
  const auto variants = find_variants(set, subject, *fitted);
  Json rows = Json::array();
  for (std::size_t k = 0; k < fitted->structures.size(); ++k)
    rows.push_back(row_of_fit(set.set.structures[k], subject.structures[k], fitted->structures[k]));
  report.values = {{"name", of.name},
                   {"case", path.string()},
                   {"overlap_voxels", *contested},
                   {"overlap_mm", fitted->depth_mm},
                   {"seconds", std::chrono::duration<double>(Clock::now() - started).count()},
                   {"variants", json_of_variants(variants, set.set)},
                   {"structures", std::move(rows)}};
  report.warnings.insert(report.warnings.end(), map->read.warnings.begin(), map->read.warnings.end());
  for (std::string& word : words_of(set, subject, *fitted, variants))
    report.warnings.push_back(path.string() + ": " + word);
  return report;
}

/// Writes the study of a folder of fits. Warns of cases that lack the structure that the others are taken for.
Result<void> write_study_of(const fs::path& file, const SetOfTemplates& set, CasesOfSet made, const std::string& record,
                            std::vector<std::string>& warnings) {
  std::vector<std::size_t> counts(set.templates.size(), 0);
  for (const auto& fitted : made.fitted)
    for (const std::size_t k : fitted) ++counts[k];
  const auto most = static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin());
  std::error_code ignored;
  const bool is_there = fs::exists(file, ignored);  // a study in which a case may have another structure
  for (std::size_t c = 0; c < made.cases.size(); ++c) {
    const auto& fitted = made.fitted[c];
    const auto at = std::ranges::find(fitted, most) - fitted.begin();
    // A case's structures are numbered as they were fitted.
    if (at < std::ssize(fitted) && (is_there ? made.stays[c] == 0 : at > 0))
      made.cases[c].structure = "s" + std::to_string(at + 1);
    if (at == std::ssize(fitted) && !fitted.empty())
      warnings.push_back(file.string() + ": " + made.cases[c].name + " has no " + set.set.structures[most].name +
                         ", the structure that models take of the others, so they take its " +
                         set.set.structures[fitted.front()].name + "; take it off the study, or use --structures");
  }
  const auto written = write_cases_into(file, set.templates[most]->source, std::move(made.cases), record);
  return written ? Result<void>() : fail(written.error());
}

}  // namespace

Result<Report> fit_sets(const FitJob& options, Progress& progress) {
  const auto set = load_set_of_templates(options.template_source);
  if (!set) return fail(set.error());
  CasesOfSet made;
  const auto paths = maps_of(options.masks, set->set);
  const auto maps = named_maps(paths);
  if (!maps) return fail(maps.error());
  std::vector<fs::path> to_write;
  for (const NamedMap& map : *maps) to_write.push_back(options.out / (map.name + ".seg.nrrd"));
  if (auto safe = check_not_read(to_write, paths); !safe) return fail(safe.error());
  const fs::path study = study_in(options.out);
  const auto suits = check_template_of_study(study, set->templates, "the templates of " + options.template_source,
                                             "give the set that it was made with, or another folder");
  if (!suits) return fail(suits.error());
  auto report = run_set_cases(
      *set, *maps, options.out, "fitted",
      [&](const NamedMap& map, Progress& own) { return fit_subject(options, *set, map, made, own); }, progress);
  if (!report) return report;
  const auto record = record_of(options.command, progress);
  if (!record) return fail(record.error());
  // Done again elsewhere, the command would name the cases otherwise.
  const std::string of_study = are_named_by_files(*maps) ? record_of_made(*record, options.out, study) : std::string();
  const auto written = write_study_of(study, *set, std::move(made), of_study, report->warnings);
  if (!written) return fail(written.error());
  report->values["study"] = study.string();
  return report;
}

}  // namespace homolog
