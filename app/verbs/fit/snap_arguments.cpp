#include "app/verbs/fit/snap_arguments.h"

#include "app/verbs/read_image.h"
#include "core/deform/fold_guard.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

void add_snap_arguments(CLI::App& verb, SnapArguments& arguments) {
  verb.add_option("--frame", arguments.frame, "Which frame of a cine, from 0")->check(CLI::NonNegativeNumber);
  verb.add_option("--reach-mm", arguments.reach_mm, "How far (mm) to look for the boundary, to both sides of the mesh")
      ->check(CLI::Range(0.5, 100.0))
      ->capture_default_str();
  verb.add_option("--strength", arguments.strength, "0: nothing moves; 1: the image decides wherever it shows an edge")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb.add_option("--polarity", arguments.polarity, "On which side of its boundary the organ is brighter")
      ->check(CLI::IsMember({"automatic", "bright-inside", "dark-inside", "either"}))
      ->capture_default_str();
  verb.add_option("--done", arguments.done,
                  "MESH IMAGE of a finished case: learn how the boundary looks there; may be given several times");
}

Result<SnapOptions> snap_options(const SnapArguments& arguments, Eigen::Index vertices, Progress& progress) {
  SnapOptions options;
  options.strength = arguments.strength;
  options.edges.reach_mm = arguments.reach_mm;
  options.edges.polarity = arguments.polarity == "bright-inside" ? Polarity::bright_inside
                           : arguments.polarity == "dark-inside" ? Polarity::dark_inside
                           : arguments.polarity == "either"      ? Polarity::either
                                                                 : Polarity::automatic;
  if (arguments.done.empty()) return options;
  auto appearance = std::make_shared<Appearance>();
  for (const auto& [mesh_path, image_path] : arguments.done) {
    const auto mesh = read_mesh(mesh_path);
    if (!mesh) return fail(mesh.error());
    const auto file = read_mesh_file(mesh_path);
    if (!file) return fail(file.error());
    const int frame = noted_frame(*file).value_or(0);
    if (mesh->points.rows() != vertices)
      return fail(mesh_path, "has " + std::to_string(mesh->points.rows()) + " vertices where the template has " +
                                 std::to_string(vertices) + "; learn from meshes of the same template");
    const auto image = read_image(image_path, frame, progress);
    if (!image) return fail(image.error());
    if (auto learned = appearance->learn(image->volume, frame, *mesh); !learned)
      return fail(mesh_path, learned.error().what);
  }
  options.edges.appearance = std::move(appearance);
  return options;
}

Report snap_report(const SnapResult& result, const Mesh& mesh, const Points& placed,
                   const std::filesystem::path& path) {
  Report report;
  report.values = {{"confidence", result.mean_confidence},
                   {"moved_mm", result.moved_mm},
                   {"doubtful", result.doubtful},
                   {"unseen_vertices", result.unseen.size()},
                   {"turned_triangles", turned_triangles(*mesh.topology, placed, mesh.points).size()},
                   {"self_intersections", self_intersections(mesh).size()}};
  for (const std::string& warning : result.warnings) report.warnings.push_back(path.string() + ": " + warning);
  return report;
}

}  // namespace homolog
