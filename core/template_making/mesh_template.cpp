#include "core/template_making/mesh_template.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>

#include "core/base/text/lengths.h"
#include "core/mesh/construction/remesh.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/parts/rims.h"
#include "core/mesh/repair/mesh_faults.h"
#include "core/template_making/solid_voxels.h"

namespace homolog {
namespace {

constexpr int most_parts = 200;        ///< parts that are rebuilt together, since each is made voxels by itself
constexpr double wreck_share = 0.005;  ///< share of the faces: so many faults, and the mesh is of no use
constexpr double far_share = 0.01;     ///< share of the diagonal: so far from the surface on average, and it is said

bool is_wreck(const MeshFaults& faults, const Mesh& mesh) {
  const auto faces = static_cast<double>(mesh.topology->triangles().rows());
  return !faults.all_intersections ||
         static_cast<double>(faults.intersections + faults.turned + faults.flat) > wreck_share * faces;
}

class Meshing {
 public:
  Meshing(const MeshTemplateOptions& options, Progress* progress) : options_(options), progress_(progress) {}

  Result<MeshTemplate> run(const MeshFile& surface) {
    auto repair = repaired(surface, {options_.longest_rim_share});
    if (!repair) return fail(repair.error());
    made_.warnings = surface.warnings;
    made_.mended = repair->mended;
    if (repair->mended.any()) made_.warnings.push_back("was mended: " + repair->mended.words());
    if (const auto parts = repair->mesh.topology->components(); parts > 1)
      made_.warnings.push_back("the surface has " + std::to_string(parts) + " parts; the largest was taken");
    surface_ = largest_part(repair->mesh);
    together_ = repair->mesh.topology->components() > most_parts ? surface_ : neighbouring_parts(repair->mesh).front();
    if (auto done = mesh_surface(); !done) return fail(done.error());
    if (progress_ && progress_->cancelled()) return fail("", "making the template was cancelled");
    made_.to_mesh = surface_distance(made_.mesh, made_.rebuilt ? together_ : surface_);
    made_.from_mesh = surface_distance(surface_, made_.mesh);
    say_what_is_far();
    return std::move(made_);
  }

 private:
  Result<void> mesh_surface() {
    const int genus = surface_.topology->genus();
    const GenusRule& rule = options_.genus;
    const bool by_number = rule.kind == GenusRule::Kind::number, automatic = rule.kind == GenusRule::Kind::automatic;
    if (by_number && genus < rule.genus)
      return fail("", "has " + count_of_tunnels(genus) + ", fewer than --genus " + std::to_string(rule.genus) +
                          "; use --genus keep");
    MeshFaults faults;
    faults.tunnels = genus;
    if (options_.closing_mm || options_.opening_mm || (by_number && genus > rule.genus) ||
        (automatic && faults.riddled()))
      return rebuild();
    made_.mesh = spread_over(surface_, options_.vertices, progress_);
    if (progress_ && progress_->cancelled()) return {};
    if (rule.kind == GenusRule::Kind::keep || !is_wreck(mesh_faults(made_.mesh), made_.mesh)) return {};
    return rebuild();
  }

  /// From voxels, as a label is.
  Result<void> rebuild() {
    if (!surface_.topology->closed())
      return fail("",
                  "is open, and would have to be rebuilt from voxels, which closes its rim; mend it by repair-mesh, "
                  "leave out --closing-mm, --opening-mm and --genus, or close it by --holes all");
    // Parts far away would make the voxels coarse and the work long, and are left out in the end.
    const SolidVoxels solid = solid_voxels(together_, solid_detail(surface_, options_.vertices), progress_);
    if (progress_ && progress_->cancelled()) return {};
    const Volume& voxels = solid.label_map;
    MaskTemplateOptions as_label;
    as_label.vertices = options_.vertices;
    as_label.closing_mm = options_.closing_mm;
    as_label.opening_mm = options_.opening_mm.value_or(0);
    as_label.genus = options_.genus;
    as_label.severs = false;  // walls are as thin as a strand that would be severed
    auto made = make_mask_template(voxels, as_label, progress_);
    if (!made && options_.genus.kind == GenusRule::Kind::number) {
      as_label.severs = true;
      made = make_mask_template(voxels, as_label, progress_);
    }
    if (!made) return fail("", of_surface(made.error().what));
    made_.mesh = std::move(made->mesh);
    made_.rebuilt = {voxels.geometry.spacing_mm[0], solid.wall_mm, surface_.topology->genus(), made->closing_mm,
                     made->opening_mm};
    made_.warnings.push_back("the surface of " + count_of_tunnels(made_.rebuilt->genus_before) +
                             " was rebuilt from voxels of " + in_mm_by_digits(made_.rebuilt->voxel_mm, 3) +
                             ": clefts below " + in_mm_by_digits(2 * made->closing_mm, 3) +
                             " filled, thin walls made " + in_mm_by_digits(solid.wall_mm, 3) + " thicker, " +
                             count_of_tunnels(made_.mesh.topology->genus()) + " left");
    for (const std::string& warning : made->warnings)
      if (warning.find("voxels from the mesh") == std::string::npos)  // the distance to the surface says that better
        made_.warnings.push_back(of_surface(warning));
    return {};
  }

  /// A sentence about label 1, which is what the voxels have, as one about the surface.
  static std::string of_surface(std::string sentence) {
    constexpr std::string_view label = "label 1";
    for (std::size_t at = sentence.find(label); at != std::string::npos; at = sentence.find(label, at))
      sentence.replace(at, label.size(), "the surface");
    return sentence;
  }

  void say_what_is_far() {
    const double diagonal_mm = bounds_of(surface_.points).diagonal().norm();
    constexpr double least_volume = 0.8, most_volume = 1.5;  ///< times the surface's, where walls are thin for the mesh
    const double before_ml = enclosed_volume_ml(surface_), volume = enclosed_volume_ml(made_.mesh) / before_ml;
    if (surface_.topology->closed() && before_ml > 0 && !(volume >= least_volume && volume <= most_volume)) {
      char percent[32];
      std::snprintf(percent, sizeof percent, "%.0f %%", 100 * volume);
      made_.warnings.push_back(std::string("the template holds ") + percent +
                               " of the surface's volume, because walls are thin for " +
                               std::to_string(options_.vertices) + " vertices; ask for more" +
                               (made_.rebuilt ? "" : ", or give a closing radius to have walls made thicker"));
    }
    const double mean_mm = std::max(made_.to_mesh.mean_mm, made_.from_mesh.mean_mm);
    if (mean_mm <= far_share * diagonal_mm) return;
    made_.warnings.push_back("the template lies " + in_mm_by_digits(mean_mm, 3) +
                             " from the surface on average, at most " +
                             in_mm_by_digits(std::max(made_.to_mesh.max_mm, made_.from_mesh.max_mm), 3) +
                             "; ask for more vertices if you need what is missing");
  }

  const MeshTemplateOptions& options_;
  Progress* progress_;
  Mesh surface_, together_;  ///< the largest part of what was mended; that with its neighbouring_parts
  MeshTemplate made_;
};

}  // namespace

Mesh spread_over(const Mesh& surface, int vertices, Progress* progress) {
  const SurfaceSearch search(surface);
  const auto project = [&search, hint = std::int32_t{0}](const Vec3& p) mutable {
    const auto nearest = search.nearest(p, hint);
    hint = nearest.at.face;
    return nearest.position;
  };
  const auto project_rim = [&surface](const Vec3& p) {
    return nearest_on_rims(surface.topology->rims(), surface.points, p).position;
  };
  Mesh spread = remesh_to_count(surface, vertices, project, progress, project_rim);
  smooth_faults(spread);
  return renumbered_from_top(spread);
}

Result<MeshTemplate> make_mesh_template(const MeshFile& surface, const MeshTemplateOptions& options,
                                        Progress* progress) {
  return Meshing(options, progress).run(surface);
}

}  // namespace homolog
