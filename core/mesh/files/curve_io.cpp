#include "core/mesh/files/curve_io.h"

#include <algorithm>
#include <cmath>

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

/// A centripetal Catmull-Rom spline through points, in straight pieces.
std::vector<Vec3> smooth_through(const std::vector<Vec3>& points, bool closed) {
  constexpr int pieces = 8;
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  if (count < 3) return points;
  const auto at = [&](std::ptrdiff_t k) -> Vec3 {
    if (closed) return points[static_cast<std::size_t>((k + count) % count)];
    // Beyond its ends a curve goes on as it came.
    if (k < 0) return 2 * points.front() - points[1];
    if (k >= count) return 2 * points.back() - points[static_cast<std::size_t>(count - 2)];
    return points[static_cast<std::size_t>(k)];
  };
  std::vector<Vec3> smooth;
  for (std::ptrdiff_t k = 0; k < (closed ? count : count - 1); ++k) {
    const Vec3 a = at(k - 1), b = at(k), c = at(k + 1), d = at(k + 2);
    const auto knot = [](const Vec3& p, const Vec3& q) { return std::max(1e-9, std::sqrt((q - p).norm())); };
    const double ab = knot(a, b), bc = knot(b, c), cd = knot(c, d);
    const Vec3 leaving = bc * ((b - a) / ab - (c - a) / (ab + bc) + (c - b) / bc),
               arriving = bc * ((c - b) / bc - (d - b) / (bc + cd) + (d - c) / cd);
    for (int piece = 0; piece < pieces; ++piece) {
      const double t = static_cast<double>(piece) / pieces, t2 = t * t, t3 = t2 * t;
      smooth.push_back((2 * t3 - 3 * t2 + 1) * b + (t3 - 2 * t2 + t) * leaving + (3 * t2 - 2 * t3) * c +
                       (t3 - t2) * arriving);
    }
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

Result<std::vector<Contour>> curves_of_slicer(const fs::path& path) {
  const auto drawn = read_slicer_curves(path);
  if (!drawn) return fail(drawn.error());
  std::vector<Contour> curves;
  for (const SlicerCurve& one : *drawn) {
    auto curve = curve_through(one.points, one.closed);
    if (!curve) return fail(path.string(), curve.error().what);
    curve->points = smooth_through(curve->points, curve->closed);
    curves.push_back(std::move(*curve));
  }
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
  if (extension != ".json" && extension != ".vtp") {
    if (is_mesh_name(path) || (looks_like_volume(path) && !looks_like_dicom(path)))
      return fail(path.string(), std::string("is ") + (is_mesh_name(path) ? "a mesh" : "a volume") +
                                     " and no contours, which are a DICOM structure set (RTSTRUCT), curves of 3D "
                                     "Slicer (.mrk.json) or lines (.vtp)");
    return read_contours(path);
  }
  Contours contours;
  auto curves = extension == ".json" ? curves_of_slicer(path) : lines_of_vtp(path, contours.warnings);
  if (!curves) return fail(curves.error());
  if (curves->empty()) return fail(path.string(), "holds no curves; draw closed or open curves, and save these");
  contours.rois.push_back({.name = file_stem(path), .number = 1, .type = {}, .contours = std::move(*curves)});
  for (std::string& doubt : doubts_about(path, contours.rois)) contours.warnings.push_back(std::move(doubt));
  return contours;
}

}  // namespace homolog
