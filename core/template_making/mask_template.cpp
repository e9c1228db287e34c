#include "core/template_making/mask_template.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>

#include "core/base/processes/parallel.h"
#include "core/mesh/colours.h"
#include "core/mesh/construction/remesh.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_faults.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/label_body.h"
#include "core/template_making/solid_voxels.h"

namespace homolog {
namespace {

// Shares of the organ's size.
constexpr double auto_width_share = 0.035;
constexpr double widest_share = 0.6;           ///< the widest that is looked for where a number of tunnels is asked for
constexpr double most_thin_share = 0.8;        ///< share of the voxels: from here on an organ is thin as a whole
constexpr double missed_worth_saying = 0.005;  ///< share of the label

std::string number(double value, int digits = 1) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// Which ways of the patient a label map's planes lie, for the warning that an organ is cut off.
std::string sides_touched(const LabelBody& region) {
  static constexpr const char* names[3][2] = {{"right", "left"}, {"anterior", "posterior"}, {"inferior", "superior"}};
  std::string text;
  for (std::size_t side = 0; side < 6; ++side) {
    if (!region.touches[side]) continue;
    const Vec3 outward = region.grid.direction.col(static_cast<Eigen::Index>(side / 2)) * (side % 2 == 0 ? -1 : 1);
    Eigen::Index axis = 0;
    outward.cwiseAbs().maxCoeff(&axis);
    text += (text.empty() ? "" : ", ") + std::string(names[axis][outward[axis] > 0 ? 1 : 0]);
  }
  return text;
}

class Making {
 public:
  Making(const Volume& mask, const MaskTemplateOptions& options, Progress* progress, const ShowStage& show)
      : mask_(mask), options_(options), progress_(progress), show_(show), severs_(options.severs) {}

  Result<MaskTemplate> run() {
    if (auto done = resample(); !done) return fail(done.error());
    surface_ = closed_by(surface_, made_.closing_mm);
    if (auto shown = show(TemplateStage::closed, 0.3); !shown) return fail(shown.error());
    const double thin_share = share_of_thin();
    // Cut open at its thin places, a thin organ would be torn into strips.
    if (thin_share >= most_thin_share) severs_ = false;
    const MaskTemplate begun = made_;
    auto ordinary = opened_and_meshed();
    if (thin_share < most_thin_share || (progress_ && progress_->cancelled()) || (ordinary && is_whole(*ordinary)))
      return ordinary;
    made_ = begun;
    return thickened(thin_share);
  }

 private:
  Result<void> resample() {
    const LabelExtent extent = label_extent(mask_, options_.label, options_.frame);
    if (extent.voxels > 0 && extent.voxels < fewest_voxels_of_shape)
      return fail("", label_name(options_.label) + " has " + std::to_string(extent.voxels) +
                          (extent.voxels == 1 ? " voxel" : " voxels") +
                          ", too few for a shape; name another label, or use a finer label map");
    edge_mm_ = spread_edge_mm(extent.area_mm2, options_.vertices);
    size_mm_ = organ_size_mm(extent);
    made_.closing_mm = options_.closing_mm.value_or(ball_share * size_mm_);
    made_.opening_mm = options_.opening_mm.value_or(ball_share * size_mm_);
    const double ball_mm = options_.genus.kind == GenusRule::Kind::number ? widest_mm() / 2 : fill_below_mm() / 2;
    const double margin_mm = std::max(made_.closing_mm, ball_mm) + edge_mm_;
    const double spacing_mm = worked_spacing_mm(mask_, extent, edge_mm_, margin_mm);
    auto cut_out = label_body(mask_, options_.label, options_.frame, extent, spacing_mm, margin_mm);
    if (!cut_out) return fail(cut_out.error());
    region_ = std::move(*cut_out);

    made_.resampled_mm = spacing_mm;
    const double voxel_ml = region_.grid.voxel_volume_mm3() / 1000;
    for (const std::size_t voxels : region_.body.islands)
      made_.islands_ml.push_back(static_cast<double>(voxels) * voxel_ml);
    made_.cavities = static_cast<int>(region_.body.cavities);
    made_.cavities_ml = static_cast<double>(region_.body.cavity_voxels) * voxel_ml;
    if (auto several = several_parts(region_, options_.label)) made_.warnings.push_back(std::move(*several));
    if (const std::string sides = sides_touched(region_); !sides.empty())
      made_.warnings.push_back(label_name(options_.label) + " touches the edge of the label map (" + sides +
                               "); the organ is closed flat there; use a map that holds the whole organ");
    surface_ = resampled(signed_distance(region_), spacing_mm);
    auto target = boundary_of(region_);
    if (!target) return fail(target.error());
    target_ = std::move(*target);
    return show(TemplateStage::resampled, 0.2);
  }

  Result<MaskTemplate> opened_and_meshed() {
    if (auto done = smooth(); !done) return fail(done.error());
    if (auto done = cut(0.6); !done) return fail(done.error());
    return remesh_surface();
  }

  /// Nearly all of the label is there, no part of it far from the mesh, and no face has a fault.
  bool is_whole(const MaskTemplate& made) const {
    constexpr double most_missed_share = 0.02, most_edges_off = 1.5;
    return made.missed_share < most_missed_share && made.from_mask.max_mm < most_edges_off * edge_mm_ &&
           !mesh_faults(made.mesh).any();
  }

  Result<void> smooth() {
    const float deepest = *std::min_element(surface_.values().begin(), surface_.values().end());
    surface_ = opened_by(surface_, made_.opening_mm);
    if (!(*std::min_element(surface_.values().begin(), surface_.values().end()) < 0))
      return fail("", "nothing of " + label_name(options_.label) + " is left after the opening by " +
                          number(made_.opening_mm) + " mm, since it is at most " + number(-2.0 * deepest) +
                          " mm thick; use an opening radius below " + number(std::max(0.0, -1.0 * deepest)) + " mm");
    if (auto shown = show(TemplateStage::opened, 0.4); !shown) return shown;
    LevelSet smooth = smoothed(surface_, smoothing_ * edge_mm_);
    make_one_body(smooth);
    if (!(*std::min_element(smooth.values().begin(), smooth.values().end()) < 0))
      return fail("", label_name(options_.label) + " is too thin for " + std::to_string(options_.vertices) +
                          " vertices; ask for more vertices");
    surface_ = std::move(smooth);
    return show(TemplateStage::smoothed, 0.5);
  }

  /// How much of the closed label is thinner than what the mesh shows well, as thin bone is, or than an opening that
  /// nobody asked for. 0 where that does not matter.
  double share_of_thin() const {
    constexpr double shown_edges = 1.75;
    if (!severs_ || options_.opening_mm.value_or(0) > 0) return 0;
    const LevelSet thick = opened_by(surface_, std::max(made_.opening_mm, shown_edges / 2 * edge_mm_));
    return 1 - static_cast<double>(voxels_inside(thick)) / static_cast<double>(voxels_inside(surface_));
  }

  /// A label whose walls were lost or meet: each is made as thick as the mesh can show, and nothing is opened.
  Result<MaskTemplate> thickened(double thin_share) {
    const SolidVoxels solid = solid_voxels(target_, solid_detail(target_, options_.vertices), progress_);
    if (progress_ && progress_->cancelled()) return cancelled();
    MaskTemplateOptions of_solid = options_;
    of_solid.label = 1;
    of_solid.frame = 0;
    of_solid.opening_mm = 0;
    of_solid.severs = false;
    const ShowStage silent;  // the same stages once more
    auto made = Making(solid.label_map, of_solid, progress_, silent).run();
    if (!made && options_.genus.kind == GenusRule::Kind::number) {
      of_solid.severs = true;
      made = Making(solid.label_map, of_solid, progress_, silent).run();
    }
    if (!made) return fail("", "the thickened walls of " + label_name(options_.label) + ": " + made.error().what);
    made_.warnings.push_back(number(100 * thin_share) + " % of " + label_name(options_.label) + " is thinner than " +
                             std::to_string(options_.vertices) + " vertices show well, so thin walls were made " +
                             number(solid.wall_mm) + " mm thicker; more vertices show thinner walls");
    made_.opening_mm = 0;
    made_.resampled_mm = made->resampled_mm;
    made_.tunnels = std::move(made->tunnels);
    made_.mesh = std::move(made->mesh);
    if (show_) show_(TemplateStage::remeshed, made_.mesh);
    return measured();
  }

  static std::size_t voxels_inside(const LevelSet& surface) {
    return static_cast<std::size_t>(
        std::count_if(surface.values().begin(), surface.values().end(), [](float value) { return value < 0; }));
  }

  Result<void> cut(double fraction) {
    const GenusRule& rule = options_.genus;
    if (rule.kind == GenusRule::Kind::keep) return {};
    const bool automatic = rule.kind == GenusRule::Kind::automatic;
    TunnelLimits limits;
    limits.keep = automatic ? 0 : rule.genus;
    limits.first_below_mm = auto_width_share * size_mm_;
    limits.fill_below_mm = automatic ? fill_below_mm() : widest_mm();
    limits.fill_any = !automatic;
    // A strand that is thinner than the mesh can show would be meshed badly, wherever it leads.
    limits.sever_below_mm = !severs_ ? 0 : automatic ? 1.5 * edge_mm_ : widest_mm();
    limits.reach_mm = 0.5 * edge_mm_;
    TunnelCut cut = cut_tunnels(surface_, limits);
    if (!automatic && cut.genus != rule.genus)
      return fail("", label_name(options_.label) + " has " + count_of_tunnels(cut.genus_before) +
                          (cut.genus < rule.genus ? ", fewer than --genus " : ", and cannot be brought to --genus ") +
                          std::to_string(rule.genus) + "; use --genus keep" +
                          (cut.genus >= rule.genus ? ""
                           : !severs_              ? " or more vertices"
                           : made_.closing_mm > 0  ? " or a smaller closing radius"
                                                   : ""));
    surface_ = std::move(cut.surface);
    made_.tunnels.insert(made_.tunnels.end(), cut.tunnels.begin(), cut.tunnels.end());
    return show(TemplateStage::tunnels_cut, fraction);
  }

  Result<MaskTemplate> remesh_surface() {
    double from = 0.6;
    for (int attempt = 0;; ++attempt) {
      auto rough = surface_of(surface_);
      if (!rough) return fail(rough.error());
      const double to = (from + 0.9) / 2;  // most often the first attempt is the last
      if (progress_) progress_->part(from, to);
      const auto project = [this](const Vec3& p) { return surface_.onto_surface(p); };
      made_.mesh = renumbered_from_top(remesh_to_count(*rough, options_.vertices, project, progress_));
      if (progress_) progress_->part(0, 1);
      if (progress_ && progress_->cancelled()) return cancelled();
      const std::vector<Vec3> bad = badly_meshed(made_.mesh);
      if (bad.empty() || attempt == most_attempts) break;
      // Clefts and rims finer than a triangle: smoothed away there, and only there. A wall as thin as the mesh can show
      // would get holes by that, so its pores are filled first.
      if (!severs_ && attempt == 0) fill_pores();
      const LevelSet smooth = smoothed_near(surface_, 0.5 * edge_mm_, bad, 2 * edge_mm_);
      surface_ = !severs_ && attempt == 0 ? united(surface_, smooth) : smooth;
      make_one_body(surface_);
      if (auto done = cut(to); !done) return fail(done.error());
      from = to;
    }
    smooth_faults(made_.mesh);
    const auto count = made_.mesh.points.rows();
    if (std::abs(static_cast<double>(count) - options_.vertices) > 0.02 * options_.vertices)
      return fail("", label_name(options_.label) + " cannot be meshed with " + std::to_string(options_.vertices) +
                          " vertices; ask for " + std::to_string(count) + " or more");
    if (show_) show_(TemplateStage::remeshed, made_.mesh);
    return measured();
  }

  /// The vertices on the flat faces that the sides of the label map leave.
  void mark_cut() {
    constexpr double rounded_edges = 0.25;  // by so much the smoothing rounds a face's rim off
    made_.cut.clear();
    for (const MapSide& side : sides_that_cut(region_, mask_.geometry)) {
      const double least_mm =
          side.offset_mm - std::max(mask_.geometry.spacing_mm[side.axis] / 2, rounded_edges * edge_mm_);
      for (Eigen::Index i = 0; i < made_.mesh.points.rows(); ++i)
        if (side.outward.dot(Vec3(made_.mesh.points.row(i))) > least_mm)
          made_.cut.push_back(static_cast<std::int32_t>(i));
    }
    std::sort(made_.cut.begin(), made_.cut.end());
    made_.cut.erase(std::unique(made_.cut.begin(), made_.cut.end()), made_.cut.end());
  }

  /// The finished mesh, compared with the label.
  Result<MaskTemplate> measured() {
    if (progress_) progress_->report(0.9);
    say_what_is_missed();
    mark_cut();
    in_parallel(2, [this](int first, int last) {  // each way on a core of its own
      for (int way = first; way < last; ++way)
        (way == 0 ? made_.to_mask : made_.from_mask) =
            way == 0 ? surface_distance(made_.mesh, target_) : surface_distance(target_, made_.mesh);
    });
    if (progress_ && progress_->cancelled()) return cancelled();
    say_what_is_far();
    return std::move(made_);
  }

  /// Much may be lost where voxels are long, although it lies less than two of them away.
  void say_what_is_far() {
    constexpr double most_edges_off = 1.5;
    if (made_.missed_share >= missed_worth_saying || made_.from_mask.p95_mm <= most_edges_off * edge_mm_) return;
    made_.warnings.push_back("5 % of the surface of " + label_name(options_.label) + " lies more than " +
                             number(made_.from_mask.p95_mm) + " mm from the mesh, at most " +
                             number(made_.from_mask.max_mm) +
                             " mm: thin parts were severed or filled; more vertices hold more of them");
  }

  void say_what_is_missed() {
    const auto voxels = static_cast<double>(std::count(region_.inside.begin(), region_.inside.end(), 1));
    const auto missed = static_cast<double>(voxels_off(region_, made_.mesh));
    made_.missed_ml = missed * region_.grid.voxel_volume_mm3() / 1000;
    made_.missed_share = missed / voxels;
    if (made_.missed_share < missed_worth_saying) return;
    made_.warnings.push_back(
        number(100 * made_.missed_share) + " % of " + label_name(options_.label) + " (" + number(made_.missed_ml) +
        " ml) lies more than two voxels from the mesh: parts thinner than the opening of " + number(made_.opening_mm) +
        " mm or the edges of " + number(edge_mm_) + " mm; use a smaller opening radius or more vertices");
  }

  void fill_pores() {
    constexpr double ball_edges = 2;
    const LevelSet distance = signed_distance(inside_of(surface_), surface_.grid());
    surface_ = united(surface_, closed_by(distance, ball_edges * edge_mm_));
  }

  /// All that lies in either.
  static LevelSet united(const LevelSet& a, const LevelSet& b) {
    std::vector<float> values = a.values();
    for (std::size_t v = 0; v < values.size(); ++v) values[v] = std::min(values[v], b.values()[v]);
    return {a.grid(), std::move(values)};
  }

  /// Two edges across, a tunnel is no more than a crease in the mesh; and the smoothing has widened it by about σ.
  double fill_below_mm() const { return std::max(auto_width_share * size_mm_, 2 * edge_mm_) + smoothing_ * edge_mm_; }
  double widest_mm() const { return widest_share * size_mm_; }

  /// The places at which faces meet each other or have a small angle.
  static std::vector<Vec3> badly_meshed(const Mesh& mesh) {
    const Triangles& triangles = mesh.topology->triangles();
    std::vector<Vec3> places;
    const auto note = [&](Eigen::Index f) {
      places.push_back(mesh.points(triangles.row(f), Eigen::all).colwise().mean().transpose());
    };
    for (const auto& pair : self_intersections(mesh)) {
      note(pair[0]);
      note(pair[1]);
    }
    for (Eigen::Index f = 0; f < triangles.rows(); ++f)
      if (smallest_angle_deg(mesh, f) < least_angle_deg) note(f);
    return places;
  }

  static tl::unexpected<Error> cancelled() { return fail("", "making the template was cancelled"); }

  Result<void> show(TemplateStage stage, double fraction) {
    if (progress_) {
      progress_->report(fraction);
      if (progress_->cancelled()) return cancelled();
    }
    if (show_)
      if (const auto mesh = surface_of(surface_)) show_(stage, *mesh);
    return {};
  }

  static constexpr int most_attempts = 4;
  static constexpr double least_angle_deg = 28;
  static constexpr double smoothing_ = 0.25;  ///< σ of the Gaussian in mean edges: what a triangle cannot show anyway

  const Volume& mask_;
  const MaskTemplateOptions& options_;
  Progress* progress_;
  const ShowStage& show_;
  bool severs_;  ///< see MaskTemplateOptions
  double edge_mm_ = 0, size_mm_ = 0;
  LevelSet surface_;
  LabelBody region_;
  Mesh target_;  ///< the boundary of the label's largest part, cavities filled
  MaskTemplate made_;
};

}  // namespace

const char* stage_name(TemplateStage stage) {
  switch (stage) {
    case TemplateStage::resampled:
      return "Resampled";
    case TemplateStage::closed:
      return "Closed";
    case TemplateStage::opened:
      return "Opened";
    case TemplateStage::smoothed:
      return "Smoothed";
    case TemplateStage::tunnels_cut:
      return "Tunnels cut";
    case TemplateStage::remeshed:
      return "Vertices spread";
  }
  assert(false);
  return "";
}

Result<MaskTemplate> make_mask_template(const Volume& mask, const MaskTemplateOptions& options, Progress* progress,
                                        const ShowStage& show) {
  return Making(mask, options, progress, show).run();
}

Mesh renumbered_from_top(const Mesh& mesh) {
  Eigen::Index top = 0;
  mesh.points.col(2).maxCoeff(&top);
  return renumbered(mesh, top);
}

}  // namespace homolog
