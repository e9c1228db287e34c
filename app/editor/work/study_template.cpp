#include "app/editor/work/study_template.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "app/editor/work/waiting_case.h"
#include "core/catalogue/catalogue.h"
#include "core/groupwise/cohort_template.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/mesh_io.h"
#include "core/session/case_file.h"
#include "core/session/case_keeping.h"
#include "core/template_making/mask_template.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

Result<CohortMap> read_member(const StudyCase& one, const FitSettings& settings, Progress& progress) {
  auto labels = read_case_labels(one, settings, progress);
  if (!labels) return fail(labels.error());
  return CohortMap{*labels->map.volume, labels->label, 0};
}

void say_what_is_odd(const Cohort& cohort, std::vector<std::string>& warnings, Progress& progress) {
  std::vector<const Boundary*> subjects;
  for (const Boundary& one : cohort.boundaries) subjects.push_back(&one);
  for (std::string& sentence : volume_warnings(cohort.names, subjects)) warnings.push_back(std::move(sentence));
  for (const std::size_t k : mirrored_subjects(subjects, &progress))
    warnings.push_back(
        cohort.names[k] +
        ": looks like a mirror image of most others; check its side, and take it off the study where it is");
}

/// A waiting case with another template, on the side of its label map; false where somebody worked on it.
Result<bool> begin_anew(const StudyCase& one, const std::shared_ptr<const Template>& the_template, Progress& progress) {
  std::optional<Document> fresh;
  KeptWithCase kept;
  {
    auto read = open_case(one.file, &progress);
    if (!read) return fail(read.error());
    EditSession& session = read->session;
    if (was_worked_on(session) || session.can_redo()) return false;
    kept = session.kept();
    const Document& before = session.document();
    fresh = new_document(before.scan.source, before.scan.image, the_template);
    fresh->hold_landmarks();
  }
  auto made = create_case(std::move(*fresh), one.file);
  if (!made) return fail(made.error());
  // The consensus is of the side that counts.
  if (one.flipped)
    if (auto mirrored = made->apply(MirrorTemplate{}); !mirrored) return fail(one.name, mirrored.error().what);
  if (kept.window)
    if (auto shown = made->apply(Note{"window", kept.window, {}}, true); !shown) return fail(shown.error());
  if (!kept.labels.empty())
    if (auto named = name_labels(*made, kept.labels); !named) return fail(named.error());
  return true;
}

/// The template of one subject from which the consensus starts, of the side that counts.
Result<MaskTemplate> start_of(const StudyCase& one, const FitSettings& settings, MaskTemplateOptions making,
                              Progress& progress) {
  const auto map = read_member(one, settings, progress);
  if (!map) return fail(map.error());
  making.label = map->label;
  auto start = make_mask_template(map->volume, making, &progress);
  if (!start) return fail(one.name, start.error().what);
  for (std::string& warning : start->warnings) warning += " (the consensus starts with it)";
  if (!one.flipped) return start;
  const MeshFile other = mirrored(MeshFile{start->mesh.points, start->mesh.topology->triangles()});
  auto topology = Topology::make(other.points.rows(), other.triangles);
  if (!topology) return fail(one.name, topology.error().what);
  start->mesh = {*topology, other.points};
  return start;
}

}  // namespace

Result<StudyTemplate> make_study_template(const std::vector<StudyCase>& cases, const FitSettings& settings,
                                          const fs::path& file, Progress& progress) {
  const auto cancelled = [] { return fail("", "No template was made: cancelled."); };
  // A template that is replaced would be another than cases began with, and they could not be opened.
  std::error_code ignored;
  if (fs::exists(file, ignored))
    return fail(file.string(), "exists already, and cases may have begun with it; choose another name");
  StudyTemplate result;
  std::vector<CohortMember> members;
  std::vector<const StudyCase*> subjects;
  MaskTemplateOptions making;
  progress.part(0, 0.1);
  Progress reading(progress, 0);
  for (const StudyCase& one : cases) {
    if (one.labels.empty()) continue;
    // Whatever is to be asked is asked before anything takes time.
    auto labels = read_case_labels(one, settings, reading);
    if (progress.cancelled()) return cancelled();
    if (!labels) return fail(labels.error());
    if (labels->label == 0) {
      result.map = labels->map.name;
      result.labels = std::move(labels->segments);
      return result;
    }
    std::ranges::move(labels->warnings, std::back_inserter(result.warnings));
    members.push_back({one.name, [&one, &settings](Progress& own) { return read_member(one, settings, own); }});
    subjects.push_back(&one);
  }
  if (members.size() < 2)
    return fail("This study", "has fewer than two cases with label maps; add scans with their label maps first");
  const auto closing = choose_cohort_closing(members, making, &reading);
  if (progress.cancelled()) return cancelled();
  if (!closing) return fail(closing.error());
  Cohort cohort;
  cohort.closing_mm = making.closing_mm = closing->closing_mm;
  for (std::size_t k = 0; k < members.size(); ++k) {
    progress.report(static_cast<double>(k) / static_cast<double>(members.size()));
    const auto map = members[k].read(reading);
    if (progress.cancelled()) return cancelled();
    if (!map) return fail(map.error());
    auto boundary = label_boundary(map->volume, map->label, map->frame, cohort.closing_mm, making.vertices);
    if (!boundary) return fail(members[k].name, boundary.error().what);
    for (const std::string& warning : boundary->warnings) result.warnings.push_back(members[k].name + ": " + warning);
    cohort.names.push_back(members[k].name);
    cohort.boundaries.push_back(subjects[k]->flipped ? mirrored_boundary(*boundary) : std::move(*boundary));
  }
  say_what_is_odd(cohort, result.warnings, reading);
  auto start = start_of(*subjects[consensus_start(cohort)], settings, making, reading);
  if (progress.cancelled()) return cancelled();
  if (!start) return fail(start.error());
  std::ranges::move(start->warnings, std::back_inserter(result.warnings));
  progress.part(0.1, 0.95);
  auto made = cohort_consensus(cohort, start->mesh, making.vertices, &progress);
  if (progress.cancelled()) return cancelled();
  if (!made) return fail(made.error().subject.empty() ? file.string() : made.error().subject, made.error().what);
  result.warnings.insert(result.warnings.end(), made->warnings.begin(), made->warnings.end());
  if (auto written = write_mesh_file(made->file, file); !written) return fail(written.error());
  const auto the_template = load_template(file.string());
  if (!the_template) return fail(the_template.error());
  result.file = file;
  result.subjects = members.size();
  for (const StudyCase& one : cases) {
    if (!one.waits()) continue;
    const auto begun = begin_anew(one, *the_template, reading);
    if (!begun)
      result.warnings.push_back(begun.error().sentence());
    else if (*begun)
      ++result.begun;
    else
      result.stays.push_back(one.name);
  }
  return result;
}

}  // namespace homolog
