#include "app/editor/work/models/study_folder.h"

#include <string>
#include <system_error>
#include <vector>

#include "app/editor/state/models/models_state.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/mesh_io.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

namespace fs = std::filesystem;

fs::path studies_folder() {
  return unsaved_folder() / "studies";
}

int phantom_shapes(Organ organ) {
  switch (organ) {
    case Organ::vertebra:
      return 10;
    case Organ::kidney:
      return 16;
    case Organ::ventricle:
      return 20;
  }
  return 0;
}

Result<fs::path> make_phantom_study(Organ organ, const fs::path& folder, Progress& progress) {
  const fs::path path = folder / ("phantom-" + std::string(organ_name(organ)) + ".study.json");
  if (auto made = make_folder(folder, Readers::user_alone); !made) return fail(made.error());
  const bool cine = organ == Organ::ventricle;
  const std::vector<MeshFile> phases = cine ? phantom_truth(organ, 1) : std::vector<MeshFile>();
  std::error_code error;
  ModelsState made;
  std::vector<fs::path> files;
  const int count = phantom_shapes(organ);
  for (int k = 0; k < count; ++k) {
    progress.report(static_cast<double>(k) / count);
    if (progress.cancelled()) return fail("", "was stopped");
    const std::string number = std::to_string(100 + k + (cine ? 0 : 1)).substr(1);
    files.push_back(folder / (std::string(organ_name(organ)) + (cine ? "-phase-" : "-") + number + ".ply"));
    if (fs::exists(files.back(), error)) continue;
    const MeshFile shape = cine ? phases[k] : phantom_truth(organ, k + 1).front();
    if (auto written = write_mesh_file(shape, files.back()); !written) return fail(written.error());
  }
  if (fs::exists(path, error)) return path;
  add_cases(made, files);
  made.study.template_file = built_in_source(organ);
  for (std::size_t k = 0; k < made.study.cases.size(); ++k) {
    made.study.cases[k].state = CaseState::done;
    if (cine) made.study.cases[k].group = 2 * k < made.study.cases.size() ? "first half" : "second half";
  }
  if (auto written = write_study(made.study, path); !written) return fail(written.error());
  return path;
}

}  // namespace homolog
