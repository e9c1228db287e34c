#include <memory>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/set_cases.h"
#include "app/verbs/verbs.h"
#include "core/structures/repair.h"
#include "core/volume/write_segmentation.h"

// The verb `repair`: what is wrong with the structures of label maps, and maps that are mended.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct MapRepairJob {
  std::vector<fs::path> maps;
  std::string set;
  fs::path out;
  std::optional<int> frame;
};

Json row_of_repair(const TemplateOfSet& structure, const RepairedStructure& found, const StructureSigns& signs) {
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
            {"bridges", signs.bridges},
            {"volume", signs.volume},
            {"lacking", signs.lacking},
            {"beyond", signs.beyond},
            {"lost", lost}}}};
}

/// The file that a repaired map goes into: the same name and format, or .seg.nrrd where nothing else can be written.
fs::path mended_file(const fs::path& map, const fs::path& folder) {
  return folder / map.filename();
}

Result<Report> repair_one(const MapRepairJob& job, const SetOfTemplates& set, const fs::path& path,
                          Progress& progress) {
  auto map = read_subject(path, job.frame, progress);
  if (!map) return fail(map.error());
  const auto repaired = repair_map(set, map->read, map->frame, &progress);
  if (!repaired) return fail(path.string(), repaired.error().what);
  const fs::path file = mended_file(path, job.out);
  if (auto written = write_segmentation(map->read, file); !written) return fail(written.error());
  Report report;
  Json rows = Json::array();
  for (std::size_t k = 0; k < repaired->structures.size(); ++k)
    rows.push_back(row_of_repair(set.set.structures[k], repaired->structures[k], repaired->signs[k]));
  report.values = {
      {"name", case_name_of(path)}, {"case", path.string()}, {"file", file.string()}, {"structures", std::move(rows)}};
  report.warnings = map->read.warnings;
  return report;
}

Result<Report> repair_maps(const MapRepairJob& job, Progress& progress) {
  const auto set = load_set_of_templates(job.set);
  if (!set) return fail(set.error());
  return run_set_cases(
      *set, maps_of(job.maps, set->set), job.out, "repaired",
      [&](const fs::path& path, Progress& own) { return repair_one(job, *set, path, own); }, progress);
}

}  // namespace

void add_repair(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<MapRepairJob>();
  CLI::App* verb = add_verb(app, "repair", "Finds what is wrong with the structures of label maps, and mends it");
  verb->add_option("MAP", job->maps, "Label maps of several structures, or folders of them")->required();
  verb->add_option("--templates", job->set, "The template set, NAME.set.json")->required();
  verb->add_option("--frame", job->frame, "Which frame of a label map with several")->check(CLI::Range(0, 100000));
  verb->add_option("-o,--output", job->out, "The folder for the mended maps, each under its own name")->required();
  verb->callback([job, &asked] { asked.run = [job](Progress& progress) { return repair_maps(*job, progress); }; });
}

}  // namespace homolog
