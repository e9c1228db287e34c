#include "app/lab/bench_study.h"

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/lab/study_frames.h"
#include "app/verbs/case_of_fit.h"
#include "core/base/encoding/json.h"
#include "core/base/processes/parallel.h"
#include "core/base/processes/process.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// One study twice: of meshes, and of the cases of the same shapes.
struct MadeStudies {
  fs::path of_meshes, of_cases;
};

/// What every case is made for.
struct CommonParts {
  fs::path image;
  std::shared_ptr<const Volume> grid;
  std::shared_ptr<const Template> the_template;
};

/// One image for all cases, a scan of 256×256×128 voxels.
Result<CommonParts> common_parts(const fs::path& folder) {
  CommonParts parts;
  auto image = std::make_shared<Volume>();
  image->geometry.dims = {256, 256, 128};
  image->geometry.spacing_mm = Vec3::Constant(1);
  image->geometry.origin_mm = Vec3(-128, -128, -64);
  image->data = std::vector<std::int16_t>(image->geometry.voxels(), 40);
  image->range_min = image->range_max = 40;
  parts.image = folder / "scan.nii.gz";
  if (auto written = write_volume(*image, parts.image); !written) return fail(written.error());
  parts.grid = grid_of(*image);
  auto the_template = load_template(built_in_source(Organ::kidney));
  if (!the_template) return fail(the_template.error());
  parts.the_template = *the_template;
  return parts;
}

struct MadeCase {
  StudyCase as_mesh, as_case;
};

Result<MadeCase> made_case(int number, const CommonParts& parts, const fs::path& folder) {
  MadeCase made;
  const MeshFile shape = phantom_truth(Organ::kidney, number).front();
  made.as_mesh.name = "kidney-" + std::to_string(1000000 + number).substr(1);  // at most 100,000, each its own
  made.as_mesh.file = folder / (made.as_mesh.name + ".ply");
  if (auto written = write_mesh_file(shape, made.as_mesh.file); !written) return fail(written.error());
  FittedCase fitted;
  fitted.name = made.as_mesh.name;
  fitted.image = parts.image;
  fitted.grid = parts.grid;
  fitted.template_of_file = parts.the_template;
  fitted.points = shape.points;
  std::vector<std::string> warnings;
  auto written = write_case_of_fit(fitted, folder, warnings);
  if (!written) return fail(written.error());
  made.as_case = std::move(*written);
  return made;
}

Result<MadeStudies> make_studies(int shapes, const fs::path& folder, Progress& progress) {
  const auto parts = common_parts(folder);
  if (!parts) return fail(parts.error());
  std::vector<std::optional<Result<MadeCase>>> made(static_cast<std::size_t>(shapes));
  std::atomic<int> done = 0;
  for_each_in_parallel(made.size(), [&](std::size_t k) {
    if (progress.cancelled()) return;
    made[k] = made_case(static_cast<int>(k) + 1, *parts, folder);
    progress.report(0.8 * ++done / shapes);
  });
  if (progress.cancelled()) return fail("bench", "was stopped");
  Study of_meshes, of_cases;
  for (auto& one : made) {
    if (!*one) return fail(one->error());
    of_meshes.cases.push_back(std::move((*one)->as_mesh));
    of_cases.cases.push_back(std::move((*one)->as_case));
  }
  const MadeStudies studies{folder / "meshes.study.json", folder / "cases.study.json"};
  if (auto written = write_study(of_meshes, studies.of_meshes); !written) return fail(written.error());
  if (auto written = write_study(of_cases, studies.of_cases); !written) return fail(written.error());
  return studies;
}

Json figures_of(const StudyCost& cost) {
  return {{"open_ms", cost.open_ms},
          {"at_rest_ms", cost.at_rest_ms},
          {"slowest_frame_ms", cost.slowest_frame_ms},
          {"turned_frame_ms", cost.turned_frame_ms},
          {"next_page_frame_ms", cost.next_page_frame_ms},
          {"peak_mb", cost.peak_mb}};
}

}  // namespace

Result<Json> figures_of_study(const fs::path& study) {
  const auto cost = study_cost(study);
  if (!cost) return fail(cost.error());
  return figures_of(*cost);
}

Result<Json> study_figures(int shapes, Progress& progress) {
  const ScratchFolder folder("homolog-bench-study");
  const auto studies = make_studies(shapes, folder.path, progress);
  if (!studies) return fail(studies.error());
  Json figures{{"shapes", shapes}};
  for (const auto& [from, file] : {std::pair("from_meshes", studies->of_meshes), {"from_cases", studies->of_cases}}) {
    // Each in a process of its own, as a person opens one: what OpenGL keeps of the other does not count.
    const auto printed = printed_by({program_file().string(), "bench", "--opened", file.string(), "--json"});
    if (progress.cancelled()) return fail("bench", "was stopped");
    auto cost = read_json<Json>(printed.value_or(""));
    if (!cost || !cost->is_object() || !cost->contains("study"))
      return fail("bench", "the window could not open the study; it needs OpenGL 3.3, of a display or by software");
    figures[from] = std::move((*cost)["study"]);
  }
  return figures;
}

}  // namespace homolog
