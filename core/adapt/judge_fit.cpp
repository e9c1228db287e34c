#include "core/adapt/judge_fit.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/adapt/boundary/cut_faces.h"
#include "core/base/numbers/statistics.h"
#include "core/mesh/construction/clip.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_faults.h"

namespace homolog {

namespace {

constexpr double least_dice = 0.9;
constexpr double hardly_any_dice = 0.5;  ///< below, the template is likely of another organ, whatever else it is
constexpr double most_missing = 0.6;     ///< share of the mesh: of less nobody can tell where it belongs
constexpr double told_beyond = 0.02;     ///< share of the boundary's area, beyond a template's cut
constexpr double most_share = 0.04, most_mean_share = 0.01;  ///< shares of the diagonal

/// The agreement as far as it counts: Dice of two open surfaces would be that of caps which nobody has seen.
Agreement counting(Agreement agreement, const std::optional<RimDistance>& rim) {
  if (rim) agreement.dice = 1;
  return agreement;
}

bool is_doubtful(const Agreement& agreement, const Boundary& boundary) {
  const double diagonal_mm = bounds_of(boundary.surface.points).diagonal().norm();
  return agreement.dice < least_dice || agreement.hd95_mm > most_share * diagonal_mm ||
         agreement.assd_mm > most_mean_share * diagonal_mm;
}

/// A template of many tunnels is the surface of noise or trabeculae: no two organs have the same ones.
std::optional<std::string> riddled(const Template& the_template) {
  MeshFaults faults;
  faults.tunnels = the_template.topology->genus();
  if (!faults.riddled()) return std::nullopt;
  return "the template has " + std::to_string(faults.tunnels) +
         " tunnels, more than organs have, so vertices of its fits do not correspond; make it again with --genus";
}

/// Why the fit is doubtful.
std::string poor_fit(const Agreement& agreement, double doubt_share, bool partial) {
  if (!partial && agreement.dice >= least_dice && doubt_share > most_doubt_share)
    return "the mesh follows the boundary, but where along it vertices belong is in much doubt; look at it, give three "
           "landmarks or more, or use a template that is more alike";
  if (!partial && agreement.dice < hardly_any_dice)
    return "the fit is poor; check that the template is not of another organ or side, and that the label is right; an "
           "organ that lies differently in each subject, as the gut does, has no points that correspond";
  if (partial || agreement.dice < least_dice)
    return "the fit is poor; check that the template is not of another organ or side, and that the label is right";
  char text[200];
  std::snprintf(text, sizeof text,
                "parts of the label are not followed: 5 %% of the surface is more than %.1f mm off; look at clefts and "
                "at the hilum, and pull the mesh there",
                agreement.hd95_mm);
  return text;
}

/// How far the target of a partial fit, without its flat cuts, lies from the mesh: mean and 95th percentile by area.
TargetDistance target_distance(const Mesh& target, const Mesh& mesh) {
  // The fit pulls no farther in the end [surface_target.h].
  constexpr double cut_share = 0.015;  ///< share of the diagonal: a flat face that lies farther off is a cut
  const SurfaceSearch search(mesh);
  const Triangles& triangles = target.topology->triangles();
  std::vector<double> off_mm(static_cast<std::size_t>(triangles.rows()));
  for (std::int32_t face = 0; face < triangles.rows(); ++face) {
    const Vec3 middle = target.points(triangles.row(face), Eigen::all).colwise().mean().transpose();
    off_mm[face] = (search.nearest(middle).position - middle).norm();
  }
  std::vector<char> cut(off_mm.size());
  for (const auto& flat : flat_faces(target)) {
    double mean_mm = 0;
    for (const std::int32_t face : flat) mean_mm += off_mm[face] / static_cast<double>(flat.size());
    if (mean_mm > cut_share * bounds_of(mesh.points).diagonal().norm())
      for (const std::int32_t face : flat) cut[face] = 1;
  }
  std::vector<std::pair<double, double>> parts;  // distance, area
  double area = 0, sum = 0;
  for (std::int32_t face = 0; face < triangles.rows(); ++face) {
    if (cut[face] != 0) continue;
    parts.emplace_back(off_mm[face], area_normal(target, face).norm());
    area += parts.back().second;
    sum += parts.back().first * parts.back().second;
  }
  if (!(area > 0)) return {};
  std::sort(parts.begin(), parts.end());
  TargetDistance distance{sum / area, 0};
  double below = 0;
  for (const auto& [mm, part] : parts) {
    distance.p95_mm = mm;
    if ((below += part) >= 0.95 * area) break;
  }
  return distance;
}

/// The part of a surface that the scan shows, cut along its borders; empty where nothing sound is left.
std::optional<Mesh> shown_part(const Mesh& surface, const std::vector<ScanBorder>& borders) {
  std::optional<Mesh> part = surface;
  for (const ScanBorder& border : borders)
    if (part) part = clipped(*part, border.outward, border.offset_mm - border.tolerance_mm);
  return part;
}

/// Judges a fit by what the scan and the template show.
void judge_inside(const Boundary& boundary, const FitResult& fit, FitJudgement& judgement) {
  judgement.inside_scan = judgement.agreement;
  std::vector<ScanBorder> borders = boundary.scan_borders;
  borders.insert(borders.end(), fit.template_cuts.begin(), fit.template_cuts.end());
  if (borders.empty()) return;
  const auto seen = shown_part(fit.mesh, borders), target = shown_part(boundary.surface, borders);
  judgement.beyond_share = seen ? 1 - surface_area_mm2(*seen) / surface_area_mm2(fit.mesh) : 1;
  if (seen && target) judgement.inside_scan = compare_meshes(*seen, *target);
}

/// The share of the boundary's area that lies beyond the template's cuts.
double share_beyond(const Boundary& boundary, const std::vector<ScanBorder>& template_cuts) {
  double beyond = 0, all = 0;
  const Triangles& triangles = boundary.surface.topology->triangles();
  for (std::int32_t face = 0; face < triangles.rows() && !template_cuts.empty(); ++face) {
    const Vec3 middle = boundary.surface.points(triangles.row(face), Eigen::all).colwise().mean().transpose();
    const double area = area_normal(boundary.surface, face).norm();
    all += area;
    if (std::ranges::any_of(template_cuts,
                            [&](const ScanBorder& cut) { return cut.outward.dot(middle) > cut.offset_mm; }))
      beyond += area;
  }
  return all > 0 ? beyond / all : 0;
}

/// The share of a closed boundary's area off an open mesh and off its flat cap, as where the organ goes on beyond the
/// mesh's rim.
double share_beyond_rim(const Boundary& boundary, const Mesh& mesh) {
  constexpr double off_share = 0.02;  ///< share of the diagonal: farther off is beyond
  const Mesh& surface = boundary.surface;
  const double far_mm = off_share * bounds_of(surface.points).diagonal().norm();
  const SurfaceSearch open(mesh), closed(capped(mesh));
  double beyond = 0, all = 0;
  const Triangles& triangles = surface.topology->triangles();
  for (std::int32_t face = 0; face < triangles.rows(); ++face) {
    const Vec3 middle = surface.points(triangles.row(face), Eigen::all).colwise().mean().transpose();
    const double area = area_normal(surface, face).norm();
    all += area;
    if (!boundary.shows(middle) || closed.nearest(middle).distance_mm <= far_mm) continue;
    if (on_rim(*mesh.topology, open.nearest(middle).at)) beyond += area;
  }
  return all > 0 ? beyond / all : 0;
}

/// The mean doubt of the vertices that the scan shows; of all where it shows none. mm
double mean_doubt_mm(const FitResult& fit) {
  std::vector<char> unseen(static_cast<std::size_t>(fit.doubt_mm.size()), 0);
  for (const std::int32_t i : fit.unseen) unseen[i] = 1;
  double sum_mm = 0;
  int count = 0;
  for (Eigen::Index i = 0; i < fit.doubt_mm.size(); ++i)
    if (unseen[i] == 0) sum_mm += fit.doubt_mm[i], ++count;
  return count > 0 ? sum_mm / count : fit.doubt_mm.mean();
}

/// Judges where an open mesh ends.
void judge_rims(const Boundary& boundary, const FitResult& fit, FitJudgement& judgement) {
  if (long_rims(fit.mesh).empty()) return;
  if (boundary.surface.topology->closed())
    judgement.beyond_rim_share = share_beyond_rim(boundary, fit.mesh);
  else if (!long_rims(boundary.surface).empty())
    judgement.rim = rim_distance(fit.mesh, boundary.surface);
}

/// Judges what the boundary shows of a partial fit.
void judge_partial(const Boundary& boundary, const FitResult& fit, FitJudgement& judgement) {
  const Points& points = fit.mesh.points;
  const SurfaceSearch search(boundary.surface);
  std::vector<char> missing(static_cast<std::size_t>(points.rows()), 0);
  for (const std::int32_t i : fit.outliers) missing[i] = 1;
  double sum_mm = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    if (missing[i] == 0) sum_mm += (search.nearest(points.row(i)).position - Vec3(points.row(i))).norm();
  const auto there = static_cast<double>(points.rows() - std::ssize(fit.outliers));
  judgement.sound_mm = there > 0 ? sum_mm / there : 0;
  judgement.target = target_distance(boundary.surface, fit.mesh);
  // What is missing is in doubt by nature.
  double sound_doubt_mm = 0;
  for (Eigen::Index i = 0; i < fit.doubt_mm.size(); ++i)
    if (missing[i] == 0) sound_doubt_mm += fit.doubt_mm[i] / there;
  const bool in_doubt = sound_doubt_mm > much_doubt_mm(surface_area_mm2(fit.mesh));
  const double diagonal_mm = bounds_of(boundary.surface.points).diagonal().norm();
  judgement.doubtful = fit.mirrored || fit.half_turned || in_doubt ||
                       there < (1 - most_missing) * static_cast<double>(points.rows()) ||
                       std::max(judgement.sound_mm, judgement.target.mean_mm) > most_mean_share * diagonal_mm;
}

}  // namespace

double share_of_doubt(const FitResult& fit) {
  return fit.doubt_mm.size() == 0 ? 0 : fit.doubt_mm.mean() / std::sqrt(surface_area_mm2(fit.mesh));
}

FitJudgement judge_fit(const Template& the_template, const Boundary& boundary, const FitOptions& options,
                       const FitResult& fit) {
  FitJudgement judgement;
  judgement.agreement = compare_meshes(fit.mesh, boundary.surface);
  judge_inside(boundary, fit, judgement);
  judge_rims(boundary, fit, judgement);
  if (fit.doubt_mm.size() > 0)
    judgement.doubt_share = mean_doubt_mm(fit) / std::sqrt(surface_area_mm2(boundary.surface));
  const bool too_little = judgement.beyond_share > most_missing;
  judgement.doubtful = fit.mirrored || fit.half_turned || too_little || judgement.doubt_share > most_doubt_share ||
                       is_doubtful(counting(judgement.inside_scan, judgement.rim), boundary);
  const bool cut_off = !options.partial && the_template.topology->closed() && !long_rims(boundary.surface).empty();
  if (cut_off) judgement.doubtful = true;
  if (options.partial) judge_partial(boundary, fit, judgement);
  // Where parts are missing, the boundary may end anywhere.
  const bool rims_apart =
      !options.partial && judgement.rim &&
      judgement.rim->mean_mm > most_mean_share * bounds_of(boundary.surface.points).diagonal().norm();
  const bool goes_on = judgement.beyond_rim_share > told_beyond;
  if (rims_apart || (!options.partial && goes_on)) judgement.doubtful = true;
  judgement.warnings = boundary.warnings;
  judgement.warnings.insert(judgement.warnings.end(), fit.warnings.begin(), fit.warnings.end());
  if (fit.mirrored)
    judgement.warnings.emplace_back(
        "the organ looks like the template's mirror image; mirror the template, or use that of the other side");
  if (fit.half_turned)
    judgement.warnings.emplace_back(
        "the organ is turned by half a turn against the template, as RAS is against LPS; if the coordinates of one of "
        "them are RAS, turn them by convert --from-ras");
  if (cut_off)
    judgement.warnings.emplace_back(
        "the surface is open, so parts of the organ seem to be missing; use --partial, or close the surface with "
        "repair-mesh --holes all");
  if (rims_apart)
    judgement.warnings.emplace_back(
        "the rims do not lie on each other; give a surface that ends where the template does, or landmarks");
  if (goes_on) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "the template is open and the target goes on beyond its rim, with %.0f %% of its surface; give a "
                  "surface that ends where the template does, or use a template of the whole",
                  100 * judgement.beyond_rim_share);
    judgement.warnings.emplace_back(text);
  }
  if (too_little) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "only %.0f %% of the mesh lies within the scan, too little to tell where it belongs; give three "
                  "landmarks or more, or leave the case out",
                  100 * (1 - judgement.beyond_share));
    judgement.warnings.emplace_back(text);
  }
  if (const double beyond = share_beyond(boundary, fit.template_cuts); beyond > told_beyond) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "the template is cut off by its scan, and %.0f %% of the organ's surface lies beyond the cut; the mesh "
        "ends there; use a template of a whole organ where that is needed",
        100 * beyond);
    judgement.warnings.emplace_back(text);
  }
  if (auto many = riddled(the_template)) judgement.warnings.push_back(std::move(*many));
  const bool tangled = fit.turned_triangles + fit.self_intersections > 0;
  if (!judgement.doubtful && !tangled) return judgement;
  const MeshFaults faults = mesh_faults({the_template.topology, the_template.points});
  if (faults.any())
    judgement.warnings.push_back("the template itself has " + faults.words() +
                                 ", so its fits have faults too; make it again from a surface without faults");
  else if (judgement.doubtful &&
           (!(fit.mirrored || fit.half_turned || cut_off || too_little || rims_apart || goes_on) ||
            counting(judgement.inside_scan, judgement.rim).dice < hardly_any_dice))
    judgement.warnings.push_back(
        poor_fit(counting(judgement.inside_scan, judgement.rim), judgement.doubt_share, options.partial));
  else if (tangled)
    judgement.warnings.emplace_back(
        "some triangles are turned or pass through each other, because the organ differs too much from the template "
        "there; look at them before you use the mesh");
  return judgement;
}

std::string as_sentence(std::string warning) {
  if (!warning.empty()) warning[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(warning[0])));
  return warning.ends_with('.') || warning.ends_with('?') ? warning : warning + '.';
}

std::string reason_of_doubt(const std::vector<std::string>& warnings) {
  return warnings.empty() ? "The fit is doubtful." : as_sentence(warnings.back());
}

}  // namespace homolog
