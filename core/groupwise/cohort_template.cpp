#include "core/groupwise/cohort_template.h"

#include <algorithm>
#include <cstdio>
#include <set>
#include <utility>

#include "core/base/numbers/statistics.h"
#include "core/groupwise/other_organs.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_faults.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/template_file.h"

namespace homolog {

namespace {

/// How much there is of the label, mm³.
double labelled_mm3(const CohortMap& map) {
  std::size_t voxels = 0;
  for (const auto& [label, count] : labels_of(map.volume, map.frame))
    if (label == map.label || (map.label == every_label && label != 0)) voxels += count;
  return static_cast<double>(voxels) * map.volume.geometry.voxel_volume_mm3();
}

/// Indices of those that can be read, from the smallest to the largest.
std::vector<std::size_t> members_by_size(const std::vector<CohortMember>& members, Progress& progress) {
  std::vector<std::pair<double, std::size_t>> sized;
  for (std::size_t k = 0; k < members.size(); ++k)
    if (const auto map = members[k].read(progress)) sized.emplace_back(labelled_mm3(*map), k);
  std::ranges::sort(sized, {}, [&](const auto& one) { return std::pair(one.first, members[one.second].name); });
  std::vector<std::size_t> order;
  order.reserve(sized.size());
  for (const auto& [mm3, k] : sized) order.push_back(k);
  return order;
}

std::string ml_text(double ml) {
  char text[32];
  std::snprintf(text, sizeof text, ml < 10 ? "%.1f ml" : "%.0f ml", ml);
  return text;
}

}  // namespace

Result<CohortClosing> choose_cohort_closing(const std::vector<CohortMember>& members, const MaskTemplateOptions& making,
                                            Progress* progress) {
  Progress none;
  Progress& reading = progress != nullptr ? *progress : none;
  const auto order = members_by_size(members, reading);
  CohortClosing choice;
  if (order.empty()) return choice;
  for (const std::size_t at : std::set{order.size() / 4, order.size() / 2, 3 * order.size() / 4}) {
    const CohortMember& member = members[order[at]];
    const auto map = member.read(reading);
    if (!map) return fail(map.error());
    MaskTemplateOptions own = making;
    own.label = map->label;
    own.frame = map->frame;
    const ClosingChoice one = choose_template_closing(map->volume, own, progress);
    for (const TriedClosing& tried : one.tried) choice.tried.push_back({member.name, tried});
    if (one.tried.size() > 1) choice.closing_mm = std::max(choice.closing_mm.value_or(0), one.closing_mm);
  }
  return choice;
}

std::size_t consensus_start(const Cohort& cohort) {
  const auto order = subjects_by_size(cohort.boundaries);
  return order[order.size() / 2];
}

Result<CohortConsensus> cohort_consensus(const Cohort& cohort, const Mesh& start, int vertices, Progress* progress) {
  const auto& names = cohort.names;
  auto made = consensus_template(
      cohort.boundaries,
      {.vertices = vertices, .start = consensus_start(cohort), .first = start, .progress = progress});
  if (!made) return fail(made.error());
  if (const MeshFaults faults = mesh_faults(made->mesh); faults.any()) {
    const std::string remedy = made->doubtful.empty() ? "give a --closing-mm, --genus 0 or more vertices"
                                                      : "leave out " + names[made->doubtful.front()] +
                                                            ", which looks like another organ than most others";
    return fail("", "would be a template with " + faults.words() + ", so it was not written; " + remedy);
  }
  CohortConsensus consensus;
  for (const std::size_t k : made->left_out)
    consensus.warnings.push_back(names[k] + ": could not be fitted, so the template is made without it");
  for (const std::size_t k : made->doubtful) consensus.warnings.push_back(other_organ_warning(names[k]));
  if (!made->rests)
    consensus.warnings.emplace_back(
        "the mean still moved in the last round; use more vertices, and look at subjects that differ much from "
        "others");
  consensus.file = template_file(made->mesh, {{"consensus", names}, {"vertices", vertices}});
  if (cohort.closing_mm) consensus.file.comments.push_back(closing_comment(*cohort.closing_mm));
  consensus.made = std::move(*made);
  return consensus;
}

std::string other_organ_warning(const std::string& name) {
  return name +
         ": looks like another organ than most others, by the doubt and the shape of its fits; look at it, or leave it "
         "out";
}

std::vector<std::string> volume_warnings(const std::vector<std::string>& names,
                                         const std::vector<const Boundary*>& subjects) {
  std::vector<double> volumes_ml;
  for (const Boundary* one : subjects)
    volumes_ml.push_back(one->surface.topology->closed() ? enclosed_volume_ml(one->surface) : 0);
  std::vector<double> closed_ml = volumes_ml;
  std::erase(closed_ml, 0);
  std::vector<std::string> sentences;
  for (const std::size_t k : unlike_in_volume(volumes_ml))
    sentences.push_back(names[k] + ": has a volume of " + ml_text(volumes_ml[k]) + ", and most others about " +
                        ml_text(quantile(closed_ml, 0.5)) +
                        "; check that it is the same organ, whole, and the right label, or leave it out");
  return sentences;
}

}  // namespace homolog
