#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "app/verbs/describe.h"
#include "app/verbs/mending_report.h"
#include "app/verbs/record.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_faults.h"

// The verb `repair-mesh`: a manifold mesh from whatever faces a file holds.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct RepairJob {
  fs::path in, out;
  std::string genus = "keep", holes = "small";
  int vertices = 0;
  GivenCommand command;
};

constexpr int fewest_vertices = 100, most_vertices = 20000;  ///< of a surface that is rebuilt, where nobody says

/// Whether a part has more tunnels than the rule leaves.
bool needs_rebuilding(const Mesh& part, const GenusRule& rule) {
  MeshFaults faults;
  faults.tunnels = part.topology->genus();
  if (rule.kind == GenusRule::Kind::number) return faults.tunnels > rule.genus;
  return rule.kind == GenusRule::Kind::automatic && faults.riddled();
}

/// A surface whose tunnels were cut where need be, with what is said of that.
struct Cut {
  Mesh mesh;
  bool rebuilt = false;
  Json further = Json::object();
  std::vector<std::string> warnings;
};

int vertices_of(const RepairJob& job, const Mesh& group, double share) {
  if (job.vertices > 0) return std::max(fewest_vertices, static_cast<int>(std::lround(share * job.vertices)));
  return std::clamp(static_cast<int>(group.points.rows()), fewest_vertices, most_vertices);
}

/// The rule holds for each part by itself. Parts that lie together are made anew together.
Result<Cut> tunnels_cut(const Mesh& surface, const RepairJob& job, Progress& progress) {
  const GenusRule rule = genus_rule(job.genus);
  const std::vector<Mesh> groups = neighbouring_parts(surface);
  const int tunnels = largest_part(groups.front()).topology->genus();
  if (rule.kind == GenusRule::Kind::number && tunnels < rule.genus)
    return fail("", "has " + count_of_tunnels(tunnels) + ", fewer than --genus " + std::to_string(rule.genus) +
                        "; use --genus keep");
  const double area_mm2 = surface_area_mm2(surface);
  Cut cut;
  std::vector<Mesh> parts;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    Progress of_group(progress, 1 / static_cast<double>(groups.size()));
    if (!needs_rebuilding(largest_part(groups[k]), rule)) {
      parts.push_back(groups[k]);
      continue;
    }
    MeshTemplateOptions making;
    making.genus = rule;
    making.longest_rim_share = longest_rim_share("all");
    making.vertices = vertices_of(job, groups[k], surface_area_mm2(groups[k]) / area_mm2);
    auto made = make_mesh_template({groups[k].points, groups[k].topology->triangles()}, making, &of_group);
    if (!made) return fail(made.error());
    if (!groups[k].topology->closed())
      cut.warnings.push_back("holes that --holes " + job.holes +
                             " leaves open were closed flat, because what is made anew from voxels is closed");
    cut.warnings.insert(cut.warnings.end(), made->warnings.begin(), made->warnings.end());
    if (!cut.rebuilt) {  // of the largest
      if (made->rebuilt) cut.further["rebuilt"] = json_of(*made->rebuilt);
      cut.further["distance_to_mesh_mm"] = json_of(made->to_mesh);
      cut.further["distance_from_mesh_mm"] = json_of(made->from_mesh);
    }
    cut.rebuilt = true;
    parts.push_back(std::move(made->mesh));
  }
  cut.mesh = cut.rebuilt ? joined(parts) : surface;
  return cut;
}

MeshFile file_of(const Mesh& mesh, const MeshFile& before, std::vector<std::string>& warnings) {
  MeshFile file;
  file.points = mesh.points;
  file.triangles = mesh.topology;
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
  const auto cut = tunnels_cut(repair->mesh, job, progress);
  if (!cut) return fail(job.in.string(), cut.error().what);
  std::vector<std::string> warnings = before->warnings;
  if (repair->mended.any()) warnings.push_back("was mended: " + repair->mended.words());
  warnings.insert(warnings.end(), cut->warnings.begin(), cut->warnings.end());
  const bool changed = repair->mended.any() || cut->rebuilt;
  MeshFile file = changed ? file_of(cut->mesh, *before, warnings) : *before;
  auto report = describe(file, job.out);
  if (!report) return report;
  report->values["mended"] = json_of(repair->mended);
  report->values.update(cut->further);
  report->warnings = about(job.in, std::move(warnings));
  for (std::string& fault : faults_of(file, job.out)) report->warnings.push_back(std::move(fault));
  auto record = record_of(job.command, progress);
  if (!record) return fail(record.error());
  file.record = std::move(*record);
  if (auto written = write_mesh_file(file, job.out); !written) return fail(written.error());
  return report;
}

}  // namespace

void add_repair_mesh(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<RepairJob>();
  CLI::App* verb = add_verb(app, "repair-mesh", "A manifold mesh from a broken one, with a report of what was mended");
  verb->add_option("IN", job->in, "A surface (STL, PLY, …)")->required();
  verb->add_option("-o,--output", job->out, "The mesh to write")->required();
  add_holes_option(*verb, job->holes);
  add_genus_option(
      *verb, job->genus,
      "Tunnels of each part. keep: all stay; a number: the narrowest are cut until so many are left; auto: "
      "narrow ones are cut where there are more than 16. Cutting makes the part anew from voxels");
  verb->add_option("--vertices", job->vertices, "How many vertices, where all of the surface is made anew")
      ->check(CLI::Range(100, 200000));
  verb->callback([job, verb, &asked] {
    if (job->genus == "keep") refuse_without_effect(*verb, "--vertices", "surfaces that --genus makes anew");
    job->command = given_command(*verb);
    asked.run = [job](Progress& progress) { return repair(*job, progress); };
  });
}

}  // namespace homolog
