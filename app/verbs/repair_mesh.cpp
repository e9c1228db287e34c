#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>

#include "app/verbs/describe.h"
#include "app/verbs/mended.h"
#include "core/mesh/mesh_faults.h"
#include "core/mesh/mesh_io.h"

// The verb `repair-mesh`: a manifold mesh from whatever faces a file holds.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct RepairJob {
  fs::path in, out;
  std::string genus = "keep", holes = "small";
  int vertices = 0;
};

constexpr int fewest_vertices = 100, most_vertices = 20000;  ///< of a surface that is rebuilt, where nobody says

double longest_rim_share(const std::string& holes) {
  if (holes == "keep") return -1;
  return holes == "small" ? small_rim_share : std::numeric_limits<double>::infinity();
}

/// Whether the surface has more tunnels than the rule leaves.
bool needs_rebuilding(const Mesh& mesh, const GenusRule& rule) {
  MeshFaults faults;
  faults.tunnels = mesh.topology->genus();
  if (rule.kind == GenusRule::Kind::number) return faults.tunnels != rule.genus;
  return rule.kind == GenusRule::Kind::automatic && faults.riddled();
}

MeshFile file_of(const Mesh& mesh, const MeshFile& before, std::vector<std::string>& warnings) {
  MeshFile file;
  file.points = mesh.points;
  file.triangles = mesh.topology->triangles();
  file.landmarks = before.landmarks;
  file.comments = before.comments;
  if (before.stiffness || !before.regions.list.empty())
    warnings.emplace_back("its vertices are others now, so stiffness and regions were left out; paint them again");
  return file;
}

Result<Report> repair(const RepairJob& job, Progress& progress) {
  const auto before = read_mesh_to_mend(job.in);
  if (!before) return fail(before.error());
  const auto repair = repaired(*before, {longest_rim_share(job.holes)});
  if (!repair) return fail(job.in.string(), repair.error().what);
  const GenusRule rule = genus_rule(job.genus);
  std::vector<std::string> warnings = before->warnings;
  Json further{{"mended", json_of(repair->mended)}};
  MeshFile file;
  if (needs_rebuilding(repair->mesh, rule)) {
    MeshTemplateOptions making;
    making.genus = rule;
    making.vertices = job.vertices > 0
                          ? job.vertices
                          : std::clamp(static_cast<int>(repair->mesh.points.rows()), fewest_vertices, most_vertices);
    const auto made = make_mesh_template(*before, making, &progress);
    if (!made) return fail(job.in.string(), made.error().what);
    warnings = made->warnings;
    file = file_of(made->mesh, *before, warnings);
    further["mended"] = json_of(made->mended);
    if (made->rebuilt) further["rebuilt"] = json_of(*made->rebuilt);
    further["distance_to_mesh_mm"] = json_of(made->to_mesh);
    further["distance_from_mesh_mm"] = json_of(made->from_mesh);
  } else if (repair->mended.any()) {
    warnings.push_back("was mended: " + repair->mended.words());
    file = file_of(repair->mesh, *before, warnings);
  } else {
    file = *before;
  }
  auto report = describe(file, job.out);
  if (!report) return report;
  report->values.update(further);
  report->warnings = about(job.in, std::move(warnings));
  for (std::string& fault : faults_of(file, job.out)) report->warnings.push_back(std::move(fault));
  if (auto written = write_mesh_file(file, job.out); !written) return fail(written.error());
  return report;
}

}  // namespace

void add_repair_mesh(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<RepairJob>();
  CLI::App* verb = add_verb(app, "repair-mesh", "A manifold mesh from a broken one, with a report of what was mended");
  verb->add_option("IN", job->in, "A surface (STL, PLY, …)")->required();
  verb->add_option("-o,--output", job->out, "The mesh to write")->required();
  verb->add_option("--holes", job->holes,
                   "small: holes with a rim of up to half the surface's diagonal are closed; all; keep: none is")
      ->check(CLI::IsMember({"small", "all", "keep"}))
      ->capture_default_str();
  add_genus_option(*verb, job->genus,
                   "Tunnels. keep: all stay; a number: the narrowest are cut until so many are left; auto: narrow ones "
                   "are cut where there are more than 16. Cutting makes the surface anew from voxels");
  verb->add_option("--vertices", job->vertices, "How many vertices, where the surface is made anew")
      ->check(CLI::Range(100, 200000));
  verb->callback([job, &asked] {
    if (job->vertices > 0 && job->genus == "keep")
      throw CLI::ValidationError("--vertices", "has no effect here: with --genus keep no surface is made anew");
    asked.run = [job](Progress& progress) { return repair(*job, progress); };
  });
}

}  // namespace homolog
