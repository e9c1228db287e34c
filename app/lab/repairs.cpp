#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "app/lab/experiment.h"
#include "app/lab/tables.h"
#include "app/verbs/case_landmarks.h"
#include "app/verbs/set/set_cases.h"
#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/base/numbers/statistics.h"
#include "core/structures/repair/repair.h"
#include "core/volume/labels/read_labels.h"

// The verb `repairs` of the laboratory: how much of what `corrupt` planted `repair` finds and mends.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct RepairsJob {
  fs::path list, out;
  std::string set;
};

/// Which structure of a set each voxel of a map is, by its place in the set and 1; 0: none. Maps have one layer here.
struct NamedVoxels {
  VolumeGeometry grid;
  std::vector<int> at;
};

NamedVoxels named_voxels(const TemplateSet& set, const VolumeRead& map) {
  NamedVoxels named{map.volume.geometry, std::vector<int>(map.volume.geometry.voxels())};
  std::map<int, int> numbers;
  const SetInMap known = find_in_map(set, map);
  for (std::size_t k = 0; k < known.structures.size(); ++k)
    if (known.structures[k].is_there()) numbers[known.structures[k].segment.value] = static_cast<int>(k) + 1;
  std::visit(
      [&](const auto& voxels) {
        for (std::size_t v = 0; v < named.at.size(); ++v) {
          const auto number = numbers.find(rounded_label(voxels[v]));
          if (number != numbers.end()) named.at[v] = number->second;
        }
      },
      map.volume.data);
  return named;
}

/// The same on the grid of another map of the subject, of which it may be a part.
NamedVoxels on_grid(const NamedVoxels& from, const VolumeGeometry& grid) {
  NamedVoxels to{grid, std::vector<int>(grid.voxels())};
  std::size_t v = 0;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i, ++v) {
        const Vec3 there = from.grid.to_voxel(grid.to_mm(Vec3(i, j, k)));
        const std::array<long, 3> at{std::lround(there[0]), std::lround(there[1]), std::lround(there[2])};
        bool within = true;
        for (std::size_t a = 0; a < 3; ++a) within = within && at[a] >= 0 && at[a] < from.grid.dims[a];
        if (within) to.at[v] = from.at[from.grid.index(at[0], at[1], at[2])];
      }
  return to;
}

/// What a name has in two maps of one grid.
struct Shared {
  std::size_t first = 0, second = 0, both = 0, changed = 0;
  double dice() const {
    return first + second > 0 ? 2.0 * static_cast<double>(both) / static_cast<double>(first + second) : 0;
  }
};

Shared shared(const NamedVoxels& first, const NamedVoxels& second, int name) {
  Shared found;
  for (std::size_t v = 0; v < first.at.size(); ++v) {
    const bool a = first.at[v] == name, b = second.at[v] == name;
    found.first += a ? 1 : 0;
    found.second += b ? 1 : 0;
    found.both += a && b ? 1 : 0;
    found.changed += a != b ? 1 : 0;
  }
  return found;
}

/// Whether the grid ends within a structure: sound as it is, it is cut off there.
bool is_cut(const NamedVoxels& map, int name) {
  std::size_t v = 0;
  for (int k = 0; k < map.grid.dims[2]; ++k)
    for (int j = 0; j < map.grid.dims[1]; ++j)
      for (int i = 0; i < map.grid.dims[0]; ++i, ++v) {
        if (map.at[v] != name) continue;
        const std::array<int, 3> at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a)
          if (at[a] == 0 || at[a] == map.grid.dims[a] - 1) return true;
      }
  return false;
}

/// Which structure has, by its name, most of what another one truly is; 0: none.
int name_given_to(const NamedVoxels& truth, const NamedVoxels& given, int name) {
  std::map<int, std::size_t> counts;
  for (std::size_t v = 0; v < truth.at.size(); ++v)
    if (truth.at[v] == name && given.at[v] != 0) ++counts[given.at[v]];
  const auto most = std::ranges::max_element(counts, {}, [](const auto& one) { return one.second; });
  return most == counts.end() ? 0 : most->first;
}

bool has_kind(const std::vector<Defect>& defects, const std::string& kind) {
  return std::ranges::any_of(defects, [&](const Defect& one) { return defect_name(one.kind) == kind; });
}

std::string kinds_of(const std::vector<Defect>& defects) {
  std::set<std::string> kinds;
  for (const Defect& one : defects) kinds.insert(defect_name(one.kind));
  std::string text;
  for (const std::string& kind : kinds) text += (text.empty() ? "" : " ") + kind;
  return text;
}

/// One map: a row for each structure of the set that the truth or the map has.
Result<std::vector<Json>> judge_one(const SetOfTemplates& set, const Json& entry, const fs::path& folder,
                                    Progress& progress) {
  const fs::path file = folder / entry["file"].get<std::string>(), of_truth = entry["truth"].get<std::string>();
  const auto right = read_subject(of_truth, {}, progress);
  if (!right) return fail(right.error());
  auto map = read_subject(file, {}, progress);
  if (!map) return fail(map.error());
  const NamedVoxels given = named_voxels(set.set, map->read);
  const NamedVoxels truth = on_grid(named_voxels(set.set, right->read), given.grid);
  MapRepairOptions options;
  options.progress = &progress;
  const auto repaired = repair_map(set, map->read, map->frame, options);
  if (!repaired) return fail(file.string(), repaired.error().what);
  const NamedVoxels after = named_voxels(set.set, map->read);
  std::map<std::string, std::set<std::string>> planted;
  for (const Json& one : entry["defects"])
    planted[one["structure"].get<std::string>()].insert(one["kind"].get<std::string>());
  std::vector<Json> rows;
  for (std::size_t k = 0; k < set.set.structures.size(); ++k) {
    const std::string& name = set.set.structures[k].name;
    const int number = static_cast<int>(k) + 1;
    const Shared before = shared(truth, given, number), mended = shared(truth, after, number);
    if (before.first + before.second == 0 && mended.second == 0) continue;
    // What is planted is told of a structure by its right name; the map may call it otherwise.
    const int called = name_given_to(truth, given, number);
    const std::size_t asked = called > 0 ? static_cast<std::size_t>(called) - 1 : k;
    const RepairedStructure& found = repaired->structures[k];
    std::string kinds, hits;
    for (const std::string& kind : planted[name]) {
      kinds += (kinds.empty() ? "" : " ") + kind;
      const bool hit = has_kind(repaired->structures[kind == "level_shifted" ? asked : k].defects, kind);
      if (hit) hits += (hits.empty() ? "" : " ") + kind;
    }
    const StructureSigns& signs = repaired->signs[k];
    const FittedStructure& fitted = repaired->fitted.structures[k];
    double lost = 0;
    for (const auto& [other, share] : signs.lost_to) lost = std::max(lost, share);
    const bool is_sound = planted[name].empty() && before.changed == 0;
    rows.push_back({{"map", entry["file"]},
                    {"subject", of_truth.filename().string()},
                    {"structure", name},
                    {"planted", kinds},
                    {"found", hits},
                    {"said", kinds_of(found.defects)},
                    {"sound", is_sound ? 1 : 0},
                    {"cut", is_cut(truth, number) ? 1 : 0},
                    {"there", before.second > 0 ? 1 : 0},
                    {"confidence", found.confidence},
                    {"p_named", found.p_named},
                    {"dice_before", before.dice()},
                    {"dice_after", mended.dice()},
                    {"changed_voxels", is_sound ? shared(given, after, number).changed : 0},
                    {"doubt", fitted.judgement.doubt_share},
                    {"off_place", fitted.off_place},
                    {"lost", lost},
                    {"holes", signs.holes},
                    {"bridges", signs.bridges},
                    {"islands", signs.islands},
                    {"tunnels", signs.tunnels},
                    {"bars", signs.bars},
                    {"volume", signs.volume},
                    {"lacking", signs.lacking},
                    {"gap", signs.gap},
                    {"beyond", signs.beyond},
                    {"at_border", signs.at_border},
                    {"has_fit", fitted.fit ? 1 : 0}});
  }
  return rows;
}

bool holds_word(const Json& row, const char* column, const std::string& word) {
  return (" " + row[column].get<std::string>() + " ").find(" " + word + " ") != std::string::npos;
}

/// Recall, false alarms and what mending is worth, of each kind.
Json by_kind(const std::vector<Json>& rows) {
  Json kinds = Json::array();
  const std::string cut = defect_name(DefectKind::cut_by_scan);
  for (const char* const kind : defect_names) {
    std::size_t planted = 0, found = 0, sound = 0, alarms = 0, worse = 0;
    std::vector<double> before, after;
    for (const Json& row : rows) {
      const bool is_sound = row["sound"] == 1 && !(row["cut"] == 1 && kind == cut);
      sound += is_sound ? 1 : 0;
      alarms += is_sound && holds_word(row, "said", kind) ? 1 : 0;
      if (!holds_word(row, "planted", kind)) continue;
      ++planted;
      found += holds_word(row, "found", kind) ? 1 : 0;
      before.push_back(row["dice_before"]);
      after.push_back(row["dice_after"]);
      worse += after.back() < before.back() - 1e-9 ? 1 : 0;
    }
    if (planted == 0 && alarms == 0) continue;
    Json one{{"kind", kind}, {"planted", planted}, {"found", found}, {"sound", sound}, {"false_alarms", alarms}};
    if (planted > 0) {
      one["dice_before"] = median_of(before);
      one["dice_after"] = median_of(after);
      one["worse"] = worse;
    }
    kinds.push_back(std::move(one));
  }
  return kinds;
}

/// How far the confidence is from the share of structures that are right, in ten bins of equal count.
Json calibration(const std::vector<Json>& rows) {
  std::vector<std::pair<double, bool>> all;
  for (const Json& row : rows)
    if (row["there"] == 1) all.emplace_back(row["confidence"], row["dice_before"] >= 0.9);
  std::ranges::sort(all);
  constexpr std::size_t bins = 10;
  Json curve = Json::array();
  double error = 0;
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t first = b * all.size() / bins, last = (b + 1) * all.size() / bins;
    if (first == last) continue;
    double said = 0, right = 0;
    for (std::size_t k = first; k < last; ++k) {
      said += all[k].first;
      right += all[k].second ? 1 : 0;
    }
    const auto count = static_cast<double>(last - first);
    // The interval of Wilson, of 95 %.
    constexpr double z = 1.96;
    const double share = right / count, scale = 1 + z * z / count, middle = (share + z * z / (2 * count)) / scale;
    const double half = z * std::sqrt(share * (1 - share) / count + z * z / (4 * count * count)) / scale;
    curve.push_back({{"confidence", said / count}, {"right", share}, {"low", middle - half}, {"high", middle + half}});
    error += std::abs(said - right) / static_cast<double>(all.size());
  }
  return {{"structures", all.size()}, {"error", error}, {"bins", std::move(curve)}};
}

Result<Report> repairs(const RepairsJob& job, Progress& progress) {
  const auto set = load_set_of_templates(job.set);
  if (!set) return fail(set.error());
  const auto text = read_whole_file(job.list);
  if (!text) return fail(text.error());
  const auto list = read_json<Json>(*text);
  if (!list || !list->is_array() || list->empty())
    return fail(job.list.string(), "lists no label maps; give planted.json as corrupt writes it");
  const auto folder = ResultFolder::make(job.out);
  if (!folder) return fail(folder.error());
  Report report;
  std::vector<Json> rows;
  for (const Json& entry : *list) {
    Progress own(progress, 1 / static_cast<double>(list->size()));
    auto of_map = judge_one(*set, entry, job.list.parent_path(), own);
    if (progress.cancelled()) return fail("", "was stopped");
    if (!of_map)
      report.warnings.push_back(of_map.error().sentence());
    else
      rows.insert(rows.end(), of_map->begin(), of_map->end());
  }
  if (rows.empty()) return fail(job.list.string(), "lists no map that can be judged");
  if (auto written = write_csv(rows, job.out / "structures.csv"); !written) return fail(written.error());
  std::size_t changed = 0, sound = 0;
  for (const Json& row : rows) {
    sound += row["sound"] == 1 ? 1 : 0;
    changed += row["changed_voxels"].get<std::size_t>();
  }
  report.values = {{"maps", list->size()},
                   {"structures", rows.size()},
                   {"sound", sound},
                   {"sound_voxels_changed", changed},
                   {"kinds", by_kind(rows)},
                   {"calibration", calibration(rows)},
                   {"table", (job.out / "structures.csv").string()}};
  return report;
}

}  // namespace

void add_lab_repairs(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<RepairsJob>();
  CLI::App* verb = add_verb(app, "repairs", "How much of what corrupt planted repair finds and mends");
  verb->add_option("LIST", job->list, "planted.json, as corrupt writes it beside its maps")->required();
  verb->add_option("--templates", job->set, "The template set, NAME.set.json")->required();
  verb->add_option("-o,--output", job->out, "The folder for structures.csv: a row for each structure")->required();
  verb->callback([job, &asked] { asked.run = [job](Progress& progress) { return repairs(*job, progress); }; });
}

}  // namespace homolog
