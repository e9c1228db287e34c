#include <algorithm>
#include <filesystem>
#include <memory>

#include "app/lab/experiment.h"
#include "app/verbs/case_landmarks.h"
#include "core/base/files/files.h"
#include "core/base/numbers/random.h"
#include "core/base/text/listed.h"
#include "core/experiment/corrupt_labels.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/labels/write_segmentation.h"

// The verb `corrupt` of the laboratory: label maps with one thing wrong each, and a list of what it is.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct CorruptJob {
  std::vector<fs::path> maps;
  fs::path out;
  std::vector<std::string> kinds;
  int count = 20;
  std::uint64_t seed = 1;
};

Json row_of_corrupted(const std::string& file, const fs::path& truth, const std::vector<PlantedDefect>& planted) {
  Json defects = Json::array();
  for (const PlantedDefect& one : planted)
    defects.push_back({{"structure", one.structure},
                       {"kind", defect_name(one.defect.kind)},
                       {"with", one.defect.with.empty() ? Json() : Json(one.defect.with)}});
  return {{"file", file}, {"truth", fs::absolute(truth).string()}, {"defects", std::move(defects)}};
}

Result<Report> corrupt(const CorruptJob& job, Progress& progress) {
  const auto folder = ResultFolder::make(job.out);
  if (!folder) return fail(folder.error());
  std::vector<DefectKind> kinds;
  for (const std::string& name : job.kinds) kinds.push_back(*defect_of_name(name));
  if (kinds.empty())
    for (int k = 0; k < static_cast<int>(DefectKind::other); ++k) kinds.push_back(static_cast<DefectKind>(k));
  Json files = Json::array();
  Random random(job.seed);
  for (const fs::path& path : job.maps) {
    const auto read = read_labels(path);
    if (!read) return fail(read.error());
    std::vector<int> values;
    for (const auto& [value, voxels] : labels_of(read->volume)) values.push_back(value);
    if (values.empty()) return fail(path.string(), "holds no label; give a label map");
    int made = 0;
    for (int tries = 0; made < job.count && tries < 20 * job.count; ++tries) {
      if (progress.cancelled()) return fail("", "was stopped");
      const int value = values[static_cast<std::size_t>(random.uniform() * static_cast<double>(values.size()))];
      const auto seed = static_cast<std::uint64_t>(random.uniform() * 1e15);
      // The kinds in turn, so that there is the same number of each.
      const auto one = corrupt_labels(*read, value, kinds[static_cast<std::size_t>(tries) % kinds.size()], seed);
      if (!one) continue;
      char number[16];
      std::snprintf(number, sizeof number, "-%03d", made++);
      const std::string name = case_name_of(path) + number + ".seg.nrrd";
      if (auto written = write_segmentation(one->map, job.out / name); !written) return fail(written.error());
      files.push_back(row_of_corrupted(name, path, one->planted));
    }
  }
  if (auto written = write_whole_file(job.out / "planted.json", files.dump(1) + '\n'); !written)
    return fail(written.error());
  Report report;
  report.values = {{"files", files.size()}, {"list", (job.out / "planted.json").string()}};
  return report;
}

}  // namespace

void add_lab_corrupt(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<CorruptJob>();
  CLI::App* verb = add_verb(app, "corrupt", "Label maps with one thing wrong each, and a list of what it is");
  verb->add_option("MAP", job->maps, "Label maps of several structures that are right")->required();
  // Those that can be made: "other" is what repair says of the rest.
  const std::vector<std::string> known(defect_names.begin(), defect_names.end() - 1);
  verb->add_option("--kinds", job->kinds, "Which defects, by name: " + listed(known, ", ") + "; without it all")
      ->delimiter(',')
      ->check([known](const std::string& name) {
        return std::ranges::find(known, name) != known.end()
                   ? std::string()
                   : name + " is no kind of defect; use " + listed(known, ", ");
      });
  verb->add_option("--count", job->count, "How many of each map")->check(CLI::Range(1, 10000))->capture_default_str();
  verb->add_option("--seed", job->seed, "Of the choices")->capture_default_str();
  verb->add_option("-o,--output", job->out, "The folder to write into; planted.json lists the defects")->required();
  verb->callback([job, &asked] { asked.run = [job](Progress& progress) { return corrupt(*job, progress); }; });
}

}  // namespace homolog
