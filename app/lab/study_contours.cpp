#include <algorithm>
#include <cmath>

#include "app/lab/experiment.h"
#include "app/lab/shape_interpolation.h"
#include "app/verbs/case_landmarks.h"
#include "app/verbs/read_image.h"
#include "core/adapt/boundary/boundary.h"
#include "core/adapt/contours/contour_fit.h"
#include "core/adapt/snap.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/compare.h"
#include "core/measure/plane_section.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/volume/volume_io.h"

// The verb `study contours`: fits to a few contours of label maps against shape-based interpolation.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct ContoursJob {
  std::string template_source;
  std::vector<fs::path> masks;
  fs::path strokes, image, out;
  int planes = 5;
};

/// A section has the inside on its left.
bool is_hole(const SectionLine& line, const Vec3& normal) {
  Vec3 twice = Vec3::Zero();
  for (std::size_t k = 1; k < line.points.size(); ++k)
    twice += (line.points[k - 1] - line.points[0]).cross(line.points[k] - line.points[0]);
  return twice.dot(normal) < 0;
}

/// Curves in which evenly spaced planes across the grid's slices cut a surface: each in the middle of an equal part of
/// its height. Specks, and the rims of cavities, are left out: nobody would draw them.
std::vector<DrawnContour> cut_by_planes(const Mesh& surface, const Vec3& normal, int planes) {
  constexpr double least_share = 0.02;
  const Eigen::VectorXd height = surface.points * normal;
  std::vector<DrawnContour> contours;
  for (int k = 0; k < planes; ++k) {
    const double at = height.minCoeff() + (k + 0.5) / planes * (height.maxCoeff() - height.minCoeff());
    auto lines = plane_section(surface, at * normal, normal);
    std::erase_if(lines, [&](const SectionLine& line) { return !line.closed || is_hole(line, normal); });
    double largest_mm2 = 0;
    for (const SectionLine& line : lines) largest_mm2 = std::max(largest_mm2, area_within_mm2({line}, normal));
    for (SectionLine& line : lines)
      if (area_within_mm2({line}, normal) > least_share * largest_mm2)
        contours.push_back({.curve = {.points = std::move(line.points)}});
  }
  return contours;
}

/// The outlines of what strokes of a value hold, in each slice across the axis on which they lie in the fewest.
std::vector<DrawnContour> outlines_of_strokes(const Volume& strokes, int value) {
  const auto& dims = strokes.geometry.dims;
  const auto is_stroke = [&](const std::array<int, 3>& v) {
    return rounded_label(strokes.at(v[0], v[1], v[2])) == value;
  };
  std::array<std::vector<int>, 3> voxels_of;
  for (std::size_t a = 0; a < 3; ++a) voxels_of[a].assign(static_cast<std::size_t>(dims[a]), 0);
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i)
        if (is_stroke({i, j, k})) {
          ++voxels_of[0][i];
          ++voxels_of[1][j];
          ++voxels_of[2][k];
        }
  std::size_t axis = 0;
  const auto used = [&](std::size_t a) {
    return std::count_if(voxels_of[a].begin(), voxels_of[a].end(), [](int n) { return n > 0; });
  };
  for (std::size_t a = 1; a < 3; ++a)
    if (used(a) < used(axis)) axis = a;
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<DrawnContour> contours;
  for (int slice = 0; slice < dims[axis]; ++slice) {
    if (voxels_of[axis][slice] == 0) continue;
    // Inside is what cannot be reached from outside.
    const int nu = dims[u] + 2, nv = dims[v] + 2;
    std::vector<std::uint8_t> inside(static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv), 1);
    std::vector<std::array<int, 2>> stack{{0, 0}};
    inside[0] = 0;
    while (!stack.empty()) {
      const auto [i, j] = stack.back();
      stack.pop_back();
      for (const auto& [di, dj] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int x = i + di, y = j + dj;
        if (x < 0 || y < 0 || x >= nu || y >= nv) continue;
        auto& here = inside[static_cast<std::size_t>(y) * static_cast<std::size_t>(nu) + static_cast<std::size_t>(x)];
        if (here == 0) continue;
        std::array<int, 3> voxel{};
        voxel[axis] = slice, voxel[u] = x - 1, voxel[v] = y - 1;
        if (x > 0 && y > 0 && x <= dims[u] && y <= dims[v] && is_stroke(voxel)) continue;
        here = 0;
        stack.push_back({x, y});
      }
    }
    Volume flat;
    flat.geometry.dims = {nu, nv, 1};
    flat.data = inside;
    const auto outline = mask_surface(flat, 1);
    if (!outline) continue;
    for (const SectionLine& line : plane_section(*outline, Vec3::Zero(), Vec3::UnitZ())) {
      DrawnContour contour{.outside = true};
      for (const Vec3& p : line.points) {
        Vec3 voxel;
        voxel[static_cast<Eigen::Index>(axis)] = slice;
        voxel[static_cast<Eigen::Index>(u)] = p.x() - 1;
        voxel[static_cast<Eigen::Index>(v)] = p.y() - 1;
        contour.curve.points.push_back(strokes.geometry.to_mm(voxel));
      }
      if (area_within_mm2({line}, Vec3::UnitZ()) > 20) contours.push_back(std::move(contour));
    }
  }
  return contours;
}

/// The fit drawn to the boundary that an image shows, with the contours kept.
Result<Points> snapped_between(const Template& the_template, const Volume& image,
                               const std::vector<DrawnContour>& contours, const FitResult& fit) {
  SnapStart start{fit.mesh, fit.mesh.points, the_template.stiffness, VertexScalars::Ones(fit.mesh.points.rows())};
  start.pins = contour_pins(contours, fit.mesh);
  auto snapped = snap(image, 0, start, {});
  if (!snapped) return fail(snapped.error());
  return std::move(snapped->points);
}

/// One organ: its surface, and what was drawn of it.
struct DrawnCase {
  std::string name;
  Mesh truth;
  std::vector<DrawnContour> contours;
};

/// `image`: null where there is none.
Result<Json> compare_on(const Template& the_template, const DrawnCase& one, const Volume* image, const fs::path& out,
                        Progress& progress) {
  FitOptions options;
  options.progress = &progress;
  auto fit = fit_to_contours(the_template, one.contours, options);
  if (!fit) return fail(one.name, fit.error().what);
  const auto between = interpolated_shape(one.contours);
  if (!between) return fail(one.name, between.error().what);
  const ContourDistance off = contour_distance(one.contours, fit->mesh);
  Json figures{{"case", one.name},
               {"contours", one.contours.size()},
               {"fit_mm", mean_surface_distance_mm(fit->mesh, one.truth)},
               {"interpolation_mm", mean_surface_distance_mm(*between, one.truth)},
               {"contours_mm", {{"mean", off.mean_mm}, {"p95", off.p95_mm}}},
               {"turned_triangles", fit->turned_triangles},
               {"self_intersections", fit->self_intersections}};
  if (image != nullptr) {
    const auto snapped = snapped_between(the_template, *image, one.contours, *fit);
    if (!snapped) return fail(one.name, snapped.error().what);
    figures["image_mm"] = mean_surface_distance_mm({fit->mesh.topology, *snapped}, one.truth);
  }
  if (out.empty()) return figures;
  MeshFile file = to_mesh_file(the_template);
  file.points = fit->mesh.points;
  if (auto written = write_mesh_file(file, out / (one.name + ".ply")); !written) return fail(written.error());
  return figures;
}

/// The direction across the slices of a grid: of its axes the one nearest to the patient's.
Vec3 across_slices(const VolumeGeometry& grid) {
  Eigen::Index axis = 2;
  grid.direction.row(2).cwiseAbs().maxCoeff(&axis);
  return grid.direction.col(axis);
}

/// All labels of a map.
Result<void> compare_labels(const ContoursJob& options, const Template& the_template, const fs::path& path,
                            const Volume* strokes, const Volume* image, Json& cases, Progress& progress) {
  const auto mask = read_volume(path);
  if (!mask) return fail(mask.error());
  for (const auto& [label, voxels] : labels_of(mask->volume)) {
    auto truth = label_boundary(mask->volume, label, 0, {}, the_template.points.rows());
    if (!truth) return fail(path.string(), truth.error().what);
    DrawnCase one{case_name_of(path) + "-" + std::to_string(label), std::move(truth->surface), {}};
    one.contours = strokes != nullptr ? outlines_of_strokes(*strokes, label)
                                      : cut_by_planes(one.truth, across_slices(mask->volume.geometry), options.planes);
    auto figures = compare_on(the_template, one, image, options.out, progress);
    if (!figures) return fail(figures.error());
    cases.push_back(std::move(*figures));
  }
  return {};
}

Result<Report> study_contours(const ContoursJob& options, Progress& progress) {
  auto the_template = load_template(options.template_source);
  if (!the_template) return fail(the_template.error());
  std::optional<VolumeRead> strokes, image;
  for (const auto& [path, volume] : {std::pair(&options.strokes, &strokes), std::pair(&options.image, &image)}) {
    if (path->empty()) continue;
    auto read = read_image(*path, 0, progress);
    if (!read) return fail(read.error());
    *volume = std::move(*read);
  }
  if (!options.out.empty())
    if (auto made = make_folder(options.out); !made) return fail(made.error());
  Json cases = Json::array();
  for (const fs::path& path : options.masks)
    if (auto done = compare_labels(options, **the_template, path, strokes ? &strokes->volume : nullptr,
                                   image ? &image->volume : nullptr, cases, progress);
        !done)
      return fail(done.error());
  if (cases.empty()) return fail(options.masks.front().string(), "has no labels to cut contours out of");
  const auto mean = [&](const char* key) {
    double sum = 0;
    for (const Json& one : cases) sum += one[key].get<double>();
    return sum / static_cast<double>(cases.size());
  };
  const auto better = std::count_if(cases.begin(), cases.end(),
                                    [](const Json& one) { return one["fit_mm"] < one["interpolation_mm"]; });
  Report report;
  report.values = {{"fit_mm", mean("fit_mm")},
                   {"interpolation_mm", mean("interpolation_mm")},
                   {"ratio", mean("fit_mm") / mean("interpolation_mm")},
                   {"better", better}};
  if (image) report.values["image_mm"] = mean("image_mm");
  report.values["cases"] = std::move(cases);
  return report;
}

}  // namespace

void add_study_contours(CLI::App& study, CommandLine& asked) {
  auto options = std::make_shared<ContoursJob>();
  CLI::App* verb = add_verb(study, lab_contours.name, lab_contours.description);
  verb->add_option("TEMPLATE", options->template_source, template_sources())->required();
  verb->add_option("--mask", options->masks, "Label maps: contours of each label are cut out of them")->required();
  verb->add_option("--planes", options->planes, "In how many planes")->check(CLI::Range(2, 100))->capture_default_str();
  verb->add_option("--strokes", options->strokes,
                   "A label map of loose strokes around each label, in place of its own contours");
  verb->add_option("--image", options->image, "An image of them all: also draw each fit to its edges");
  verb->add_option("-o,--output", options->out, "A folder for the fitted meshes");
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return study_contours(*options, progress); }; });
}

}  // namespace homolog
