#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/describe.h"
#include "app/verbs/mending_report.h"
#include "app/verbs/read_image.h"
#include "app/verbs/subjects.h"
#include "app/verbs/template_job.h"
#include "core/adapt/choose_closing.h"
#include "core/groupwise/suited_template.h"
#include "core/mesh/isosurface.h"
#include "core/mesh/mesh_faults.h"
#include "core/mesh/mirror.h"
#include "core/template/template.h"
#include "core/template_making/template_file.h"

// Templates of several subjects: the verb `template` with --consensus and --best-of.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The subjects, with one closing radius for all of them.
struct Cohort {
  SubjectsRead read;
  std::vector<Boundary> boundaries;  ///< of the subjects, in their order
  std::optional<double> closing_mm;  ///< absent: each label's usual one
  Json tried = Json::array();
};

/// A label map, and how much there is of its label.
struct SizedMap {
  double ml = 0;
  fs::path path;
};

/// From the smallest to the largest. Which cannot be read is left out here; reading the subjects tells.
std::vector<SizedMap> maps_by_size(const TemplateJob& options, const std::vector<fs::path>& paths, Progress& progress) {
  std::vector<SizedMap> maps;
  for (const fs::path& path : paths) {
    if (is_mesh_name(path)) continue;
    const auto mask = read_mask(path, options.labels, {options.frame, {}}, progress);
    if (!mask) continue;
    std::size_t voxels = 0;
    for (const auto& [label, count] : labels_of(mask->volume, mask->frame))
      if (label == mask->label || (mask->label == every_label && label != 0)) voxels += count;
    maps.push_back({static_cast<double>(voxels) * mask->volume.geometry.voxel_volume_mm3() / 1000, path});
  }
  std::ranges::sort(maps, {}, [](const SizedMap& one) { return std::pair(one.ml, case_name_of(one.path)); });
  return maps;
}

/// Looks at label maps of small, median and large size for the closing radius; the widest that one needs is all
/// subjects'.
Result<void> choose_closing_of(const TemplateJob& options, const std::vector<fs::path>& paths, Cohort& cohort,
                               Progress& progress) {
  const auto maps = maps_by_size(options, paths, progress);
  std::set<std::size_t> looked_at{maps.size() / 4, maps.size() / 2, 3 * maps.size() / 4};
  if (maps.empty()) looked_at.clear();
  for (const std::size_t at : looked_at) {
    const fs::path& path = maps[at].path;
    const auto mask = read_mask(path, options.labels, {options.frame, {}}, progress);
    if (!mask) return fail(mask.error());
    MaskTemplateOptions making;
    making.label = mask->label;
    making.frame = mask->frame;
    making.vertices = options.vertices;
    making.genus = genus_rule(options.genus);
    const ClosingChoice choice = choose_template_closing(mask->volume, making, &progress);
    for (const TriedClosing& one : choice.tried)
      cohort.tried.push_back({{"subject", case_name_of(path)},
                              {"closing_mm", one.closing_mm},
                              {"dice_raw", one.dice_raw},
                              {"doubtful", one.doubtful}});
    if (choice.tried.size() > 1) cohort.closing_mm = std::max(cohort.closing_mm.value_or(0), choice.closing_mm);
  }
  return {};
}

Result<Cohort> read_cohort(const TemplateJob& options, const std::vector<fs::path>& files, Progress& progress) {
  Cohort cohort;
  cohort.closing_mm = options.closing_mm;
  if (!options.closing_mm)
    if (auto chosen = choose_closing_of(options, subject_paths(files), cohort, progress); !chosen)
      return fail(chosen.error());
  auto read = read_subjects(
      {files, {}, options.labels, options.frame, cohort.closing_mm, options.vertices, options.flip_mirrored}, progress);
  if (!read) return fail(read.error());
  cohort.read = std::move(*read);
  for (BiasSubject& subject : cohort.read.subjects) cohort.boundaries.push_back(std::move(subject.boundary));
  return cohort;
}

/// The template of one subject alone, with the cohort's closing radius.
Result<MadeTemplate> template_of(const TemplateJob& options, const Cohort& cohort, std::size_t subject,
                                 Progress& progress) {
  TemplateJob one = options;
  one.in = cohort.read.paths[subject];
  if (is_mesh_name(one.in))
    one.labels.clear(), one.frame.reset(), one.closing_mm.reset();
  else
    one.closing_mm = cohort.closing_mm;
  return make_template_of_one(one, false, progress);
}

bool is_flipped(const Cohort& cohort, std::size_t subject) {
  const auto& flipped = cohort.read.flipped;
  return std::find(flipped.begin(), flipped.end(), cohort.read.subjects[subject].name) != flipped.end();
}

Json names_of(const Cohort& cohort) {
  Json names = Json::array();
  for (const BiasSubject& subject : cohort.read.subjects) names.push_back(subject.name);
  return names;
}

/// What the report says of the subjects.
void report_cohort(const TemplateJob& options, const Cohort& cohort, Json& values) {
  values["subjects"] = cohort.boundaries.size();
  values["closing_mm"] = cohort.closing_mm ? Json(*cohort.closing_mm) : Json();
  values["closing_chosen"] = !options.closing_mm.has_value();
  values["closing_tried"] = cohort.tried;
  values["flipped"] = cohort.read.flipped;
  cohort.read.report_frames(values);
}

Result<MadeTemplate> consensus_of(const TemplateJob& options, Progress& progress) {
  progress.part(0, 0.05);
  auto cohort = read_cohort(options, options.consensus, progress);
  if (!cohort) return fail(cohort.error());
  const auto& subjects = cohort->read.subjects;
  const auto by_size = subjects_by_size(cohort->boundaries);
  const std::size_t first = by_size[by_size.size() / 2];
  auto start = template_of(options, *cohort, first, progress);
  if (!start) return fail(start.error());
  if (is_flipped(*cohort, first)) start->file = mirrored(start->file);
  const auto topology = Topology::make(start->file.points.rows(), start->file.triangles);
  if (!topology) return fail(subjects[first].name, topology.error().what);
  progress.part(0.05, 1);
  const auto made = consensus_template(cohort->boundaries, {.vertices = options.vertices,
                                                            .start = first,
                                                            .first = Mesh{*topology, start->file.points},
                                                            .progress = &progress});
  if (!made) return fail(made.error());
  if (const MeshFaults faults = mesh_faults(made->mesh); faults.any()) {
    const std::string remedy = made->doubtful.empty() ? "give a --closing-mm, --genus 0 or more vertices"
                                                      : "leave out " + subjects[made->doubtful.front()].name +
                                                            ", which looks like another organ than most others";
    return fail(options.out.string(),
                "would be a template with " + faults.words() + ", so it was not written; " + remedy);
  }
  MadeTemplate consensus;
  consensus.warnings = std::move(cohort->read.warnings);
  for (const std::string& warning : start->warnings)
    consensus.warnings.push_back(warning + " (the consensus starts with it)");
  for (const std::size_t k : made->left_out)
    consensus.warnings.push_back(subjects[k].name + ": could not be fitted, so the template is made without it");
  for (const std::size_t k : made->doubtful) consensus.warnings.push_back(other_organ_warning(subjects[k].name));
  if (!made->rests)
    consensus.warnings.emplace_back(
        "the mean still moved in the last round; use more vertices, and look at subjects that differ much from "
        "others");
  consensus.file = template_file(made->mesh, {{"consensus", names_of(*cohort)}, {"vertices", options.vertices}});
  if (cohort->closing_mm) consensus.file.comments.push_back(closing_comment(*cohort->closing_mm));
  consensus.values = {{"rounds", made->rounds}, {"moved_mm", made->moved_mm}, {"rests", made->rests}};
  report_cohort(options, *cohort, consensus.values);
  return consensus;
}

/// A subject's template, and how well it suits the others.
struct Candidate {
  std::size_t subject;
  MadeTemplate made;
  Suitability suits;
};

Result<MadeTemplate> best_of(const TemplateJob& options, Progress& progress) {
  constexpr std::size_t most_candidates = 5, most_others = 12;
  progress.part(0, 0.05);
  auto cohort = read_cohort(options, options.best_of, progress);
  if (!cohort) return fail(cohort.error());
  const auto& subjects = cohort->read.subjects;
  if (subjects.size() < 3)
    return fail(options.best_of.front().string(), "is one of " + std::to_string(subjects.size()) +
                                                      " subjects; name three or more, or make a template of one");
  progress.part(0.05, 0.2);
  auto nearest = nearest_to_mean(cohort->boundaries, subjects.size(), options.vertices, &progress);
  if (!nearest) return fail(nearest.error());
  std::erase_if(*nearest, [&](std::size_t k) { return is_flipped(*cohort, k); });
  nearest->resize(std::min(nearest->size(), most_candidates));
  std::vector<std::string> warnings = std::move(cohort->read.warnings);
  std::optional<Candidate> best;
  Json tried = Json::array();
  for (std::size_t n = 0; n < nearest->size(); ++n) {
    const auto share = [&](std::size_t k) {
      return 0.2 + 0.8 * static_cast<double>(k) / static_cast<double>(nearest->size());
    };
    progress.part(share(n), share(n + 1));
    const std::size_t k = (*nearest)[n];
    std::optional<Progress> making(std::in_place, progress, 0);
    auto made = template_of(options, *cohort, k, *making);
    const auto the_template = made ? make_template(made->file, subjects[k].name) : tl::make_unexpected(made.error());
    if (!the_template) {
      warnings.push_back(the_template.error().sentence());
      continue;
    }
    const auto suits = suitability(**the_template, k, cohort->boundaries, most_others, &progress);
    if (!suits) return fail(suits.error());
    tried.push_back({{"subject", subjects[k].name},
                     {"fits", suits->fits},
                     {"doubtful", suits->doubtful},
                     {"assd_mm", suits->assd_mm},
                     {"doubt_share", suits->doubt_share}});
    if (!best || suits->better_than(best->suits)) best = Candidate{k, std::move(*made), *suits};
  }
  if (!best)
    return fail(options.best_of.front().string(),
                "gave no template of any of its subjects; the last: " +
                    (warnings.empty() ? std::string("all are flipped") : warnings.back()));
  warnings.insert(warnings.end(), best->made.warnings.begin(), best->made.warnings.end());
  best->made.warnings = std::move(warnings);
  Json& values = best->made.values;
  report_cohort(options, *cohort, values);
  values.erase("closing_why");
  values["subject"] = subjects[best->subject].name;
  values["candidates"] = tried;
  return std::move(best->made);
}

}  // namespace

Result<MadeTemplate> make_template_of_many(const TemplateJob& options, Progress& progress) {
  return options.consensus.empty() ? best_of(options, progress) : consensus_of(options, progress);
}

}  // namespace homolog
