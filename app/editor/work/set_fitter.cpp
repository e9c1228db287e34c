#include "app/editor/work/set_fitter.h"

#include <algorithm>
#include <utility>

#include "core/structures/maps/map_of_case.h"
#include "core/structures/naming/right_names.h"
#include "core/structures/variants.h"
#include "core/volume/labels/read_labels.h"

namespace homolog {

namespace {

/// Fits the set to what the map's repair proposes.
Result<SetFitted> repair_and_fit(SetFitted done, VolumeRead& read, const MapToFit& map, const FitSetOptions& options) {
  MapRepairOptions repairing;
  repairing.image = map.image.get();
  repairing.image_frame = map.image && map.image->frames > map.frame ? map.frame : 0;
  repairing.progress = options.progress;
  repairing.tell = options.tell;
  const VolumeRead as_read = read;
  auto repaired = fit_repaired(*done.set, read, std::min(map.frame, read.volume.frames - 1), repairing, options.gap_mm);
  if (!repaired) return fail(map.file.filename().string(), repaired.error().what);
  done.subject = std::move(repaired->subject);
  done.fitted = std::move(repaired->fitted);
  done.found = std::move(repaired->found);
  done.as_read = std::move(repaired->as_read);
  done.changes = voxel_changes(as_read, read);
  return done;
}

/// The same with a sentence for each structure of which the whole was taken and not a part, and for each variant of the
/// body, as a sixth lumbar level is one.
Result<SetFitted> with_remarks(Result<SetFitted> done) {
  if (!done) return done;
  for (std::size_t k = 0; k < done->fitted.structures.size(); ++k)
    if (const std::string& why = done->fitted.structures[k].why_whole; !why.empty())
      done->warnings.push_back(done->set->set.structures[k].name + ": " + why + ".");
  for (const Variant& variant : find_variants(*done->set, done->subject, done->fitted))
    done->warnings.push_back("The label map " + sentence_of(variant, *done->set) + ".");
  if (const std::string found = found_by_values(done->set->set, done->subject); !found.empty())
    done->warnings.push_back("The label map " + found + ".");
  return done;
}

}  // namespace

void SetFitRows::tell(std::size_t row, SetFitStep step) {
  if (row >= rows_.size()) return;
  const SetFitStep before = rows_[row].step;
  const bool anew = step == SetFitStep::runs && (before == SetFitStep::fitted || before == SetFitStep::failed);
  if (anew) {
    again_ = true;
    for (StructureFitShown& one : rows_) one.step = SetFitStep::waits;
  }
  rows_[row].step = step;
}

bool SetFitRows::all_done() const {
  return !rows_.empty() && std::ranges::all_of(rows_, [](const StructureFitShown& one) {
    return one.step == SetFitStep::fitted || one.step == SetFitStep::failed;
  });
}

std::string SetFitRows::pass() const {
  if (!repair_) return "Fitting the set";
  if (again_) return "Fitting to what is proposed";
  return all_done() ? "Looking for what is wrong" : "Fitting to the map as it is";
}

/// Reads the map and fits the set to it.
Result<SetFitted> SetFitter::fit(std::shared_ptr<const SetOfTemplates> set, const MapToFit& map, bool repair,
                                 Shared& shared, const std::function<void()>& wake, Progress& progress) {
  constexpr double reading_share = 0.05;
  progress.part(0, reading_share);
  VolumeReadOptions reading;
  reading.progress = &progress;
  reading.all_layers = true;
  auto read = read_labels(map.file, reading);
  if (!read) return fail(read.error());
  progress.part(reading_share, 1);
  SetFitted done;
  done.set = set;
  done.warnings = std::move(read->warnings);
  done.subject = find_in_map(set->set, *read, std::min(map.frame, read->volume.frames - 1));
  for (const StructureInMap& one : done.subject.structures)
    if (!one.why_left_out.empty()) done.warnings.push_back(one.segment.name + " is left out: " + one.why_left_out);
  {
    const std::lock_guard lock(shared.mutex);
    for (std::size_t k = 0; k < done.subject.structures.size(); ++k) {
      if (!done.subject.structures[k].is_there() || set->templates[k] == nullptr) continue;
      shared.there.push_back(k);
      shared.structures.add(set->set.structures[k].name);
    }
    if (shared.there.empty())
      return fail(map.file.filename().string(), "has no label of this set; choose another set, or rename its labels");
  }
  FitSetOptions options;
  options.gap_mm = map.gap_mm;
  options.progress = &progress;
  options.tell = [&](std::size_t structure, SetFitStep step) {
    {
      const std::lock_guard lock(shared.mutex);
      const auto at = std::ranges::find(shared.there, structure) - shared.there.begin();
      shared.structures.tell(static_cast<std::size_t>(at), step);
    }
    wake();
  };
  if (repair) return with_remarks(repair_and_fit(std::move(done), *read, map, options));
  auto fitted = fit_set(*set, done.subject, options);
  if (!fitted) return fail(map.file.filename().string(), fitted.error().what);
  done.fitted = std::move(*fitted);
  doubt_names(*set, *read, std::min(map.frame, read->volume.frames - 1), done.subject, done.fitted);
  return with_remarks(std::move(done));
}

void SetFitter::start(std::shared_ptr<const SetOfTemplates> set, MapToFit map, bool repair, std::uint64_t case_number) {
  case_number_ = case_number;
  frame_ = map.frame;
  shared_ = std::make_shared<Shared>();
  shared_->structures = SetFitRows(repair);
  work_.start(map.file.string(), [set, map, repair, shared = shared_, wake = wake_](Progress& progress) {
    return fit(set, map, repair, *shared, wake, progress);
  });
}

std::vector<StructureFitShown> SetFitter::structures() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->structures.rows();
}

std::string SetFitter::pass() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->structures.pass();
}

}  // namespace homolog
