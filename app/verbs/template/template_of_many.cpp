#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/describe.h"
#include "app/verbs/mending_report.h"
#include "app/verbs/read_image.h"
#include "app/verbs/template/subjects.h"
#include "app/verbs/template/template_job.h"
#include "core/groupwise/cohort_template.h"
#include "core/groupwise/suited_template.h"
#include "core/mesh/construction/mirror.h"
#include "core/template/template.h"

// Templates of several subjects: the verb `template` with --consensus and --best-of.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The subjects, with one closing radius for all of them.
struct CohortRead {
  SubjectsRead read;
  Cohort cohort;
  Json tried = Json::array();
};

/// Of label maps: the radius that those of small, median and large size need.
Result<void> choose_closing_of(const TemplateJob& options, const std::vector<fs::path>& paths, CohortRead& subjects,
                               Progress& progress) {
  std::vector<CohortMember> members;
  for (const fs::path& path : paths) {
    if (is_mesh_name(path)) continue;
    members.push_back({case_name_of(path), [&options, path](Progress& reading) -> Result<CohortMap> {
                         auto mask = read_mask(path, options.label, {options.frame, {}, options.level}, reading);
                         if (!mask) return fail(mask.error());
                         return CohortMap{std::move(mask->volume), mask->label, mask->frame};
                       }});
  }
  MaskTemplateOptions making;
  making.vertices = options.vertices;
  making.genus = genus_rule(options.genus);
  const auto choice = choose_cohort_closing(members, making, &progress);
  if (!choice) return fail(choice.error());
  subjects.cohort.closing_mm = choice->closing_mm;
  for (const auto& [subject, tried] : choice->tried)
    subjects.tried.push_back({{"subject", subject},
                              {"closing_mm", tried.closing_mm},
                              {"dice_raw", tried.dice_raw},
                              {"doubtful", tried.doubtful}});
  return {};
}

Result<CohortRead> read_cohort(const TemplateJob& options, const std::vector<fs::path>& files, Progress& progress) {
  CohortRead all;
  all.cohort.closing_mm = options.closing_mm;
  if (!options.closing_mm && !options.faced)  // a part is made with the usual radius
    if (auto chosen = choose_closing_of(options, subject_paths(files), all, progress); !chosen)
      return fail(chosen.error());
  auto read = read_subjects({.files = files,
                             .label = options.label,
                             .frame = options.frame,
                             .level = options.level,
                             .closing_mm = all.cohort.closing_mm,
                             .faced = options.faced,
                             .vertices = options.vertices,
                             .flip_mirrored = options.flip_mirrored},
                            progress);
  if (!read) return fail(read.error());
  all.read = std::move(*read);
  for (BiasSubject& subject : all.read.subjects) {
    all.cohort.names.push_back(subject.name);
    all.cohort.boundaries.push_back(std::move(subject.boundary));
  }
  return all;
}

/// The template of one subject alone, with the cohort's closing radius.
Result<MadeTemplate> template_of(const TemplateJob& options, const CohortRead& subjects, std::size_t subject,
                                 Progress& progress) {
  TemplateJob one = options;
  one.in = subjects.read.paths[subject];
  if (is_mesh_name(one.in))
    one.label.clear(), one.frame.reset(), one.level.reset(), one.closing_mm.reset(), one.faced.reset();
  else
    one.closing_mm = subjects.cohort.closing_mm;
  auto made = make_template_of_one(one, false, progress);
  if (made) made->warnings.insert(made->warnings.begin(), made->of_reading.begin(), made->of_reading.end());
  return made;
}

bool is_flipped(const CohortRead& subjects, std::size_t subject) {
  const auto& flipped = subjects.read.flipped;
  return std::find(flipped.begin(), flipped.end(), subjects.cohort.names[subject]) != flipped.end();
}

/// What the report says of the subjects.
void report_cohort(const TemplateJob& options, const CohortRead& subjects, Json& values) {
  const auto& closing_mm = subjects.cohort.closing_mm;
  values["subjects"] = subjects.cohort.boundaries.size();
  values["closing_mm"] = closing_mm ? Json(*closing_mm) : Json();
  values["closing_chosen"] = !options.closing_mm.has_value();
  values["closing_tried"] = subjects.tried;
  values["flipped"] = subjects.read.flipped;
  subjects.read.report_frames(values);
}

Result<MadeTemplate> consensus_of(const TemplateJob& options, Progress& progress) {
  progress.part(0, 0.05);
  auto subjects = read_cohort(options, options.consensus, progress);
  if (!subjects) return fail(subjects.error());
  const std::size_t first = consensus_start(subjects->cohort);
  auto start = template_of(options, *subjects, first, progress);
  if (!start) return fail(start.error());
  if (is_flipped(*subjects, first)) start->file = mirrored(start->file);
  const auto topology = Topology::make(start->file.points.rows(), start->file.triangles);
  if (!topology) return fail(subjects->cohort.names[first], topology.error().what);
  progress.part(0.05, 1);
  auto made = cohort_consensus(subjects->cohort, {*topology, start->file.points}, options.vertices, &progress);
  if (!made) return fail(made.error().subject.empty() ? options.out.string() : made.error().subject, made.error().what);
  MadeTemplate consensus;
  consensus.warnings = std::move(subjects->read.warnings);
  for (const std::string& warning : start->warnings)
    consensus.warnings.push_back(warning + " (the consensus starts with it)");
  consensus.warnings.insert(consensus.warnings.end(), made->warnings.begin(), made->warnings.end());
  consensus.file = std::move(made->file);
  if (options.faced) consensus.file.comments.push_back(faced_comment(*options.faced));
  consensus.values = {{"rounds", made->made.rounds}, {"moved_mm", made->made.moved_mm}, {"rests", made->made.rests}};
  report_cohort(options, *subjects, consensus.values);
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
  auto subjects = read_cohort(options, options.best_of, progress);
  if (!subjects) return fail(subjects.error());
  const auto& [names, boundaries, closing_mm] = subjects->cohort;
  if (names.size() < 3)
    return fail(options.best_of.front().string(), "is one of " + std::to_string(names.size()) +
                                                      " subjects; name three or more, or make a template of one");
  progress.part(0.05, 0.2);
  auto nearest = nearest_to_mean(boundaries, names.size(), options.vertices, &progress);
  if (!nearest) return fail(nearest.error());
  std::erase_if(*nearest, [&](std::size_t k) { return is_flipped(*subjects, k); });
  nearest->resize(std::min(nearest->size(), most_candidates));
  std::vector<std::string> warnings = std::move(subjects->read.warnings);
  std::optional<Candidate> best;
  Json tried = Json::array();
  for (std::size_t n = 0; n < nearest->size(); ++n) {
    const auto share = [&](std::size_t k) {
      return 0.2 + 0.8 * static_cast<double>(k) / static_cast<double>(nearest->size());
    };
    progress.part(share(n), share(n + 1));
    const std::size_t k = (*nearest)[n];
    std::optional<Progress> making(std::in_place, progress, 0);
    auto made = template_of(options, *subjects, k, *making);
    const auto the_template = made ? make_template(made->file, names[k]) : tl::make_unexpected(made.error());
    if (!the_template) {
      warnings.push_back(the_template.error().sentence());
      continue;
    }
    const auto suits = suitability(**the_template, k, boundaries, most_others, &progress);
    if (!suits) return fail(suits.error());
    tried.push_back({{"subject", names[k]},
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
  report_cohort(options, *subjects, values);
  values.erase("closing_why");
  values["subject"] = names[best->subject];
  values["candidates"] = tried;
  return std::move(best->made);
}

}  // namespace

Result<MadeTemplate> make_template_of_many(const TemplateJob& options, Progress& progress) {
  return options.consensus.empty() ? best_of(options, progress) : consensus_of(options, progress);
}

}  // namespace homolog
