#include "core/mesh/files/curve_io.h"

#include <algorithm>
#include <set>

#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/text/text.h"
#include "core/mesh/files/slicer_curves.h"
#include "core/mesh/formats/vtp_lines.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/dicom/dicom_set.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The slopes of a cubic spline at its points, for steps of 1 between these, so that its curvature is steady. At its
/// two ends it stands still.
std::vector<Vec3> steady_slopes(const std::vector<Vec3>& points) {
  // Each slope and its two neighbours obey one equation; the system is solved from front to back and back.
  const std::size_t count = points.size();
  std::vector<double> shares(count, 0);
  std::vector<Vec3> slopes(count, Vec3::Zero());
  for (std::size_t k = 1; k + 1 < count; ++k) {
    shares[k] = 1 / (4 - shares[k - 1]);
    slopes[k] = shares[k] * (3 * (points[k + 1] - points[k - 1]) - slopes[k - 1]);
  }
  for (std::size_t k = count - 1; k-- > 1;) slopes[k] -= shares[k] * slopes[k + 1];
  return slopes;
}

/// A cardinal spline through points, in straight pieces, as 3D Slicer draws it with VTK [vtkCardinalSpline]: steps of 1
/// between points however far apart they lie, periodic where it is closed, slopes of 0 at open ends.
std::vector<Vec3> smooth_through(const std::vector<Vec3>& points, bool closed) {
  constexpr std::size_t pieces = 8;
  // What lies so many points away changes a slope by less than a rounding error.
  constexpr std::size_t far = 40;
  const std::size_t count = points.size();
  if (count < 3) return points;
  const std::size_t before = closed ? far : 0;
  std::vector<Vec3> around;
  for (std::size_t k = 0; k < count + 2 * before; ++k) around.push_back(points[(k + count * far - before) % count]);
  const std::vector<Vec3> slopes = steady_slopes(around);
  std::vector<Vec3> smooth;
  for (std::size_t k = before; k < before + (closed ? count : count - 1); ++k)
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const double t = static_cast<double>(piece) / pieces, t2 = t * t, t3 = t2 * t;
      smooth.push_back((2 * t3 - 3 * t2 + 1) * around[k] + (t3 - 2 * t2 + t) * slopes[k] +
                       (3 * t2 - 2 * t3) * around[k + 1] + (t3 - t2) * slopes[k + 1]);
    }
  if (!closed) smooth.push_back(points.back());
  return smooth;
}

Result<Contour> curve_through(std::vector<Vec3> points, bool closed) {
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (closed && points.size() > 1 && points.front() == points.back()) points.pop_back();
  if (points.size() < (closed ? 3U : 2U))
    return fail("", std::string("has a ") + (closed ? "closed " : "") + "curve of " + std::to_string(points.size()) +
                        (points.size() == 1 ? " point" : " points") + "; draw it to its end, or leave it out");
  return Contour{.points = std::move(points), .closed = closed};
}

/// `warnings`: curves without points, which are left out beside others, and those of a type that is not drawn here.
Result<std::vector<Contour>> curves_of_slicer(const fs::path& path, std::vector<std::string>& warnings) {
  const auto drawn = read_slicer_curves(path);
  if (!drawn) return fail(drawn.error());
  const auto empty = std::ranges::count_if(*drawn, [](const SlicerCurve& one) { return one.points.empty(); });
  const bool any = empty < std::ssize(*drawn);
  if (any && empty > 0)
    warnings.push_back(path.string() + ": has " + std::to_string(empty) + (empty == 1 ? " curve" : " curves") +
                       " without points, which " + (empty == 1 ? "was" : "were") + " left out");
  std::vector<Contour> curves;
  std::set<std::string> unknown;
  for (const SlicerCurve& one : *drawn) {
    if (any && one.points.empty()) continue;
    auto curve = curve_through(one.points, one.closed);
    if (!curve) return fail(path.string(), curve.error().what);
    if (one.type != "linear") curve->points = smooth_through(curve->points, curve->closed);
    if (!one.type.empty() && one.type != "linear" && one.type != "spline") unknown.insert(one.type);
    curves.push_back(std::move(*curve));
  }
  for (const std::string& type : unknown)
    warnings.push_back(path.string() + ": has a curve of the type " + excerpt(type) +
                       ", which was drawn as 3D Slicer's spline through its points; resample the curve there to keep "
                       "its course");
  return curves;
}

Result<std::vector<Contour>> lines_of_vtp(const fs::path& path, std::vector<std::string>& warnings) {
  const auto bytes = read_whole_file(path);
  if (!bytes) return fail(bytes.error());
  const auto lines = formats::vtp_lines(*bytes);
  if (!lines) return fail(path.string(), lines.error().what);
  for (const std::string& warning : lines->warnings) warnings.push_back(path.string() + ": " + warning);
  std::vector<Contour> curves;
  for (const std::vector<std::int64_t>& line : lines->lines) {
    std::vector<Vec3> points;
    for (const std::int64_t k : line) points.emplace_back(lines->points.row(k));
    const bool closed = points.size() > 3 && points.front() == points.back();
    auto curve = curve_through(std::move(points), closed);
    if (!curve) return fail(path.string(), curve.error().what);
    curves.push_back(std::move(*curve));
  }
  return curves;
}

/// The one structure set in a folder.
Result<Contours> contours_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    if (holds_contours(entry->path())) found.push_back(entry->path());
  if (failed) return fail(folder.string(), "cannot be read: " + failed.message());
  std::sort(found.begin(), found.end());
  if (found.empty())
    return fail(folder.string(),
                "holds no DICOM structure set (RTSTRUCT); name the file that does, or the files of curves (.mrk.json, "
                ".vtp)");
  if (found.size() > 1)
    return fail(folder.string(), "holds " + std::to_string(found.size()) + " structure sets; name one, as " +
                                     found.front().filename().string());
  return read_contours(found.front());
}

}  // namespace

Result<Contours> read_curves(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return contours_in(path);
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".fcsv")
    return fail(path.string(),
                "holds points alone and no curves; make a curve of them in 3D Slicer and save it as .mrk.json");
  if (extension != ".json" && extension != ".vtp") {
    if (is_mesh_name(path) || (looks_like_volume(path) && !looks_like_dicom(path)))
      return fail(path.string(), std::string("is ") + (is_mesh_name(path) ? "a mesh" : "a volume") +
                                     " and no contours, which are a DICOM structure set (RTSTRUCT), curves of 3D "
                                     "Slicer (.mrk.json) or lines (.vtp)");
    return read_contours(path);
  }
  Contours contours;
  auto curves =
      extension == ".json" ? curves_of_slicer(path, contours.warnings) : lines_of_vtp(path, contours.warnings);
  if (!curves) return fail(curves.error());
  if (curves->empty()) return fail(path.string(), "holds no curves; draw closed or open curves, and save these");
  contours.rois.push_back({.name = file_stem(path), .number = 1, .type = {}, .contours = std::move(*curves)});
  for (std::string& doubt : doubts_about(path, contours.rois)) contours.warnings.push_back(std::move(doubt));
  return contours;
}

}  // namespace homolog
