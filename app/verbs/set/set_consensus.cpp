#include <algorithm>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/case_pool.h"
#include "app/verbs/set/set_cases.h"
#include "app/verbs/set/set_making.h"
#include "app/verbs/template/template_job.h"
#include "core/base/text/text.h"
#include "core/groupwise/cohort_template.h"
#include "core/structures/fitting/fit_set.h"
#include "core/structures/fitting/neighbours_say.h"
#include "core/structures/naming/level_names.h"

// `set make --consensus`: templates that no subject decides, each where it lies on average.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The structures of all maps: the first of a name, and a segment without name by its value.
struct StructuresOfAll {
  std::vector<Segment> segments;
  TemplateSet set;                             ///< their names and values, to find them in a map
  std::vector<std::vector<std::size_t>> maps;  ///< that have each
};

/// A vertebra whose names differ goes by its level.
NameLikeness likeness_of(const std::string& a, const std::string& b) {
  const NameLikeness of_names = name_likeness(a, b);
  return of_names == NameLikeness::none && is_same_vertebra(a, b) ? NameLikeness::words : of_names;
}

StructuresOfAll united(const std::vector<std::vector<Segment>>& asked) {
  StructuresOfAll all;
  for (std::size_t m = 0; m < asked.size(); ++m)
    for (const Segment& segment : asked[m]) {
      const auto likeness = [&](const TemplateOfSet& one) {
        if (segment.name.empty()) return one.value == segment.value ? NameLikeness::words : NameLikeness::none;
        return likeness_of(one.name, segment.name);
      };
      const auto found = std::ranges::max_element(all.set.structures, {}, likeness);
      if (found != all.set.structures.end() && likeness(*found) != NameLikeness::none) {
        // Of two labels of one map that are called alike, the first counts.
        auto& maps = all.maps[found - all.set.structures.begin()];
        if (maps.back() != m) maps.push_back(m);
        continue;
      }
      all.segments.push_back(segment);
      TemplateOfSet one;
      one.name = name_in_set(segment);
      one.value = segment.value;
      all.set.structures.push_back(std::move(one));
      all.maps.push_back({m});
    }
  return all;
}

/// A template with its middle at 0, and the middles of its labels, of each map.
struct MeanStructure {
  MadeStructure made;
  std::vector<std::optional<Vec3>> middles;
};

/// One structure's labels in those maps that have voxels of it.
struct LabelsOfOne {
  Cohort cohort;
  std::vector<std::size_t> maps;
  std::vector<std::string> warnings;  ///< which maps could not be used, and why
};

/// A structure's part of a map: a bit a voxel, so that those of all maps lie in memory at once. A soft mask as it is.
struct PackedLabel {
  Volume around;  ///< without its voxels
  std::vector<bool> held;
  std::optional<Volume> soft;

  CohortMap map() const {
    if (soft) return {*soft, 1, 0};
    CohortMap map{around, 1, 0};
    map.volume.data = std::vector<std::uint8_t>(held.begin(), held.end());
    map.volume.range_max = 1;
    return map;
  }
};

PackedLabel packed(Volume mask, int value) {
  PackedLabel label;
  std::visit(
      [&](const auto& voxels) {
        for (const auto voxel : voxels) label.held.push_back(rounded_label(voxel) == value);
      },
      mask.data);
  mask.data = std::vector<std::uint8_t>();
  label.around = std::move(mask);
  return label;
}

/// What one map has of all structures, in their order.
struct LabelsOfMap {
  std::vector<std::optional<PackedLabel>> labels;  ///< none: it shows nothing of the structure
  std::vector<std::string> why_left_out;           ///< empty: it is not
};

Result<LabelsOfMap> read_labels_in(const fs::path& map, const TemplateSet& set, Progress& progress) {
  const auto read = read_subject(map, std::nullopt, progress, false);
  if (!read) return fail(read.error());
  LabelsOfMap all;
  for (StructureInMap& one : find_in_map(set, read->read).structures) {
    all.why_left_out.push_back(std::move(one.why_left_out));
    all.labels.emplace_back();
    if (one.soft)
      all.labels.back() = PackedLabel{.soft = std::move(one.soft)};
    else if (one.is_there())
      all.labels.back() = packed(std::move(*one.mask), one.segment.value);
  }
  return all;
}

using ReadMaps = std::vector<Result<LabelsOfMap>>;

/// Each map is read once.
ReadMaps read_maps(const SetJob& job, const TemplateSet& set, Progress& progress) {
  ReadMaps maps(job.maps.size(), LabelsOfMap{});
  const auto work = [&](std::size_t m, Progress& part) -> Result<Report> {
    maps[m] = read_labels_in(job.maps[m], set, part);
    return Report{};
  };
  run_cases(maps.size(), work, progress);
  return maps;
}

Result<CohortMap> label_in(const Result<LabelsOfMap>& map, const fs::path& file, const TemplateSet& set,
                           std::size_t structure) {
  if (!map) return fail(map.error());
  const std::string& name = set.structures[structure].name;
  if (!map->why_left_out[structure].empty()) return fail(file.string(), name + ": " + map->why_left_out[structure]);
  if (!map->labels[structure]) return fail(file.string(), "has no voxel of " + name);
  return map->labels[structure]->map();
}

/// Whether a map shows nothing of a structure, which is no fault.
bool lacks_voxels(const Result<LabelsOfMap>& map, std::size_t structure) {
  return map && map->why_left_out[structure].empty() && !map->labels[structure];
}

Result<LabelsOfOne> labels_of_one(const SetJob& job, const StructuresOfAll& all, const ReadMaps& read,
                                  std::size_t structure, Progress& progress) {
  std::vector<std::size_t> maps = all.maps[structure];
  std::erase_if(maps, [&](std::size_t m) { return lacks_voxels(read[m], structure); });
  std::vector<CohortMember> members;
  for (const std::size_t m : maps)
    members.push_back(
        {case_name_of(job.maps[m]), [&, m](Progress&) { return label_in(read[m], job.maps[m], all.set, structure); }});
  MaskTemplateOptions making;
  making.vertices = job.vertices;
  const auto closing = choose_cohort_closing(members, making, &progress);
  if (!closing) return fail(closing.error());
  LabelsOfOne labels;
  labels.cohort.closing_mm = closing->closing_mm;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto label = members[k].read(progress);
    if (!label) {
      labels.warnings.push_back(label.error().sentence() + "; it is not in the mean");
      continue;
    }
    auto boundary = label_boundary(label->volume, label->label, 0, closing->closing_mm, job.vertices);
    if (!boundary) {
      labels.warnings.push_back(Error{members[k].name, boundary.error().what}.sentence() + "; it is not in the mean");
      continue;
    }
    labels.cohort.names.push_back(members[k].name);
    labels.cohort.boundaries.push_back(std::move(*boundary));
    labels.maps.push_back(maps[k]);
  }
  return labels;
}

/// A subject's own template, with the closing radius of all.
Result<MadeTemplate> own_template_of(const SetJob& job, const std::vector<std::vector<Segment>>& asked,
                                     const std::string& name, int value, std::size_t map,
                                     const std::optional<double>& closing_mm, Progress& progress) {
  const auto likeness = [&](const Segment& segment) { return likeness_of(name, segment.name); };
  const auto best = std::ranges::max_element(asked[map], {}, likeness);
  const bool by_name = best != asked[map].end() && likeness(*best) != NameLikeness::none;
  TemplateJob making;
  making.in = job.maps[map];
  making.label = by_name ? best->name : std::to_string(value);
  making.vertices = job.vertices;
  making.closing_mm = closing_mm;
  return make_template_of_one(making, !closing_mm, progress);
}

MeanStructure mean_structure(const SetJob& job, const std::vector<std::vector<Segment>>& asked,
                             const StructuresOfAll& all, const ReadMaps& read, std::size_t k, Progress& progress) {
  MeanStructure mean{without_template(all.segments[k]), {}};
  mean.middles.resize(job.maps.size());
  MadeStructure& made = mean.made;
  const auto give_up = [&](const Error& why) {
    take_template(fail(why), job, made);
    return mean;
  };
  const auto labels = labels_of_one(job, all, read, k, progress);
  if (!labels) return give_up(labels.error());
  made.warnings.insert(made.warnings.end(), labels->warnings.begin(), labels->warnings.end());
  if (labels->maps.empty()) return give_up({"", "no map has a voxel of it"});
  for (std::size_t s = 0; s < labels->maps.size(); ++s)
    mean.middles[labels->maps[s]] = labels->cohort.boundaries[s].surface.points.colwise().mean().transpose();
  const std::size_t start = consensus_start(labels->cohort);
  auto own = own_template_of(job, asked, made.structure.name, made.structure.value, labels->maps[start],
                             labels->cohort.closing_mm, progress);
  if (!own) return give_up(own.error());
  for (const std::string& warning : own->warnings) made.warnings.push_back(warning);
  made.row["subjects"] = labels->maps.size();
  if (labels->maps.size() == 1) {
    own->file.points.rowwise() -= own->file.points.colwise().mean();
    own->file.landmarks.clear();
    made.row["warning"] = "is in " + labels->cohort.names.front() + " alone, so that its template is that subject's";
    made.warnings.push_back(made.structure.name + ": " + made.row["warning"].get<std::string>());
    take_template(std::move(own->file), job, made);
    return mean;
  }
  const auto topology = Topology::make(own->file.points.rows(), own->file.triangles);
  if (!topology) return give_up(topology.error());
  auto consensus = cohort_consensus(labels->cohort, {*topology, own->file.points}, job.vertices, &progress);
  if (!consensus) return give_up(consensus.error());
  for (const std::string& warning : consensus->warnings) {
    made.warnings.push_back(made.structure.name + ": " + warning);
    made.row["warning"] = warning;
  }
  take_template(std::move(consensus->file), job, made);
  return mean;
}

/// Carries each template of the set to its mean place.
void carry(const std::vector<Similarity>& places, SetInMaking& making) {
  for (std::size_t k = 0; k < places.size(); ++k) {
    making.files[k].points = places[k].apply(making.files[k].points);
    const std::string source = making.made.set.structures[k].file.string();
    making.made.templates[k] = make_template(making.files[k], source).value();  // its topology is as it was
  }
}

std::vector<Points> template_points_of(const SetInMaking& making) {
  std::vector<Points> points;
  for (const MeshFile& file : making.files) points.push_back(file.points);
  return points;
}

/// Fits the set to all maps and brings its structures to their mean places there.
Result<void> bring_to_mean_places(const SetJob& job, SetInMaking& making, Progress& progress) {
  std::vector<FittedSet> fitted;
  std::vector<std::vector<std::optional<Similarity>>> placed;
  for (const fs::path& map : job.maps) {
    Progress part(progress, 1 / static_cast<double>(job.maps.size()));
    const auto subject = read_subject(map, std::nullopt, part, false);
    if (!subject) return fail(subject.error());
    auto one = fit_set(making.made, find_in_map(making.made.set, subject->read), {.gap_mm = 0, .progress = &part});
    if (!one) return fail(map.string(), one.error().what);
    placed.emplace_back();
    for (const FittedStructure& structure : one->structures)
      placed.back().push_back(structure.fit && !structure.judgement.doubtful ? std::optional(structure.fit->placement)
                                                                             : std::nullopt);
    fitted.push_back(std::move(*one));
  }
  const std::vector<Similarity> places = mean_places(template_points_of(making), placed);
  carry(places, making);
  for (std::size_t s = 0; s < fitted.size(); ++s)
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!placed[s][k]) continue;
      if (const auto said = said_by_neighbours(making.made, fitted[s].structures, k))
        making.relative[k].push_back(said->inverse().after(*placed[s][k]).after(places[k].inverse()));
    }
  return {};
}

}  // namespace

Result<void> add_consensus(const SetJob& job, const std::vector<std::vector<Segment>>& asked, SetInMaking& making,
                           Progress& progress) {
  const StructuresOfAll all = united(asked);
  std::optional<Progress> part(std::in_place, progress, 0.1);
  const ReadMaps read = read_maps(job, all.set, *part);
  std::vector<MeanStructure> means(all.segments.size());
  const auto work = [&](std::size_t k, Progress& own) -> Result<Report> {
    means[k] = mean_structure(job, asked, all, read, k, own);
    return Report{};
  };
  part.emplace(progress, 0.6);
  const auto done = run_cases(means.size(), work, *part);
  if (progress.cancelled()) return fail("", "was stopped; no set is written");
  for (const auto& one : done)
    if (!one) return fail(one.error());
  std::vector<std::vector<std::optional<Similarity>>> roughly(job.maps.size());
  for (MeanStructure& mean : means) {
    const bool there = mean.made.is_there();
    append(std::move(mean.made), making);
    for (std::size_t m = 0; there && m < job.maps.size(); ++m) {
      roughly[m].emplace_back();
      if (mean.middles[m]) roughly[m].back() = Similarity{.translation = *mean.middles[m]};
    }
  }
  if (making.files.empty()) return {};  // said where the set is written
  for (auto& relative : making.relative) relative.clear();
  carry(mean_places(template_points_of(making), roughly), making);
  part.emplace(progress, 0.3);
  return bring_to_mean_places(job, making, *part);
}

}  // namespace homolog
