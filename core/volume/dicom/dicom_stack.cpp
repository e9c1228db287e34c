#include "core/volume/dicom/dicom_stack.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace homolog {
namespace fs = std::filesystem;

namespace {

using Planes = std::span<const DicomPlaneSource>;

/// The verb that does it, behind what is asked for.
std::string by_resampling() {
  return " (convert IN OUT.nii.gz --resample)";
}

/// By which decimals differ from what they stand for.
constexpr double exactly_mm = 1e-6;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// How far a position may lie off along a direction since its coordinates were rounded to tenths: 0 where some are not.
double rounding_mm(Planes planes, const Vec3& direction) {
  for (const DicomPlaneSource& source : planes)
    for (const double coordinate : *source.plane->position_mm)
      if (std::abs(10 * coordinate - std::rint(10 * coordinate)) > exactly_mm) return 0;
  return 0.05 * direction.cwiseAbs().sum();
}

std::string named(const std::vector<DicomHeader>& headers, const DicomPlaneSource& source) {
  return headers[source.file].path.filename().string() + " (" + mm_text(source.along_normal_mm) + ")";
}

/// Whether rounded places can be those of an even stack: each lies by its rounding beside a line through the ends.
bool even_but_rounded(Planes slices, double rounding_mm) {
  const double first = slices.front().along_normal_mm;
  const double step = (slices.back().along_normal_mm - first) / static_cast<double>(slices.size() - 1);
  const double most = 2 * rounding_mm + exactly_mm;
  for (std::size_t s = 1; s < slices.size(); ++s) {
    const double gap = slices[s].along_normal_mm - slices[s - 1].along_normal_mm;
    const double off_line = slices[s].along_normal_mm - first - static_cast<double>(s) * step;
    if (std::abs(gap - step) > std::min(most, 0.5 * step) || std::abs(off_line) > most) return false;
  }
  return true;
}

Result<void> check_even(const fs::path& path, const std::vector<DicomHeader>& headers, Planes slices,
                        double rounding_mm) {
  if (rounding_mm > 0 && even_but_rounded(slices, rounding_mm)) return {};
  std::vector<double> gaps;
  for (std::size_t s = 1; s < slices.size(); ++s)
    gaps.push_back(slices[s].along_normal_mm - slices[s - 1].along_normal_mm);
  const double usual = median(gaps);
  const double tolerance = std::min(std::max({0.1, 0.02 * usual, 2 * rounding_mm}), 0.25 * usual);
  for (std::size_t s = 0; s < gaps.size(); ++s) {
    if (std::abs(gaps[s] - usual) <= tolerance + exactly_mm) continue;
    return fail(path.string(), (gaps[s] > 1.5 * usual ? "lacks slices: " : "has unevenly spaced slices: ") +
                                   named(headers, slices[s]) + " and " + named(headers, slices[s + 1]) + " lie " +
                                   mm_text(gaps[s]) + " apart, the others " + mm_text(usual) +
                                   "; copy the whole series again, or resample it evenly" + by_resampling());
  }
  return {};
}

/// The planes' places within their own plane, along one of its axes, from the one in the middle.
std::vector<double> to_the_side(Planes planes, const Vec3& axis) {
  std::vector<double> places;
  for (const DicomPlaneSource& source : planes) places.push_back(source.plane->position_mm->dot(axis));
  const double middle = median(places);
  for (double& place : places) place -= middle;
  return places;
}

double extent(const std::vector<double>& places) {
  const auto [low, high] = std::minmax_element(places.begin(), places.end());
  return *high - *low;
}

/// Whether the places run evenly to the side as they run along the normal.
bool is_even_slope(Planes planes, const std::vector<double>& places, double tolerance) {
  const double height = planes.back().along_normal_mm - planes.front().along_normal_mm;
  const double slope = height > 0 ? (places.back() - places.front()) / height : 0;
  for (std::size_t p = 0; p < planes.size(); ++p) {
    const double expected = places.front() + slope * (planes[p].along_normal_mm - planes.front().along_normal_mm);
    if (std::abs(places[p] - expected) > tolerance) return false;
  }
  return true;
}

}  // namespace

Result<Vec3> slice_step(const fs::path& path, const std::vector<DicomHeader>& headers,
                        const DicomArrangement& arrangement, const std::pair<Vec3, Vec3>& axes) {
  const Vec3 normal = axes.first.cross(axes.second).normalized();
  const auto slices = Planes(arrangement.planes).first(static_cast<std::size_t>(arrangement.slices));
  if (auto even = check_even(path, headers, slices, rounding_mm(slices, normal)); !even) return fail(even.error());
  const double whole = slices.back().along_normal_mm - slices.front().along_normal_mm;
  return whole / static_cast<double>(slices.size() - 1) * normal;
}

Result<void> check_straight(const fs::path& path, const std::vector<DicomHeader>& headers,
                            const std::vector<DicomPlaneSource>& planes, const std::pair<Vec3, Vec3>& axes,
                            double pixel_mm) {
  const auto u = to_the_side(planes, axes.first), v = to_the_side(planes, axes.second);
  const double rounded = 2 * std::hypot(rounding_mm(planes, axes.first), rounding_mm(planes, axes.second)) + exactly_mm;
  const double tolerance = std::max(0.5 * pixel_mm, rounded);
  if (std::hypot(extent(u), extent(v)) <= tolerance) return {};
  if (is_even_slope(planes, u, tolerance) && is_even_slope(planes, v, tolerance))
    return fail(path.string(),
                "has slices that are shifted sideways against one another (a tilted gantry); resample it "
                "to a rectangular grid" +
                    by_resampling());
  std::size_t worst = 0;
  for (std::size_t p = 1; p < planes.size(); ++p)
    if (std::hypot(u[p], v[p]) > std::hypot(u[worst], v[worst])) worst = p;
  return fail(path.string(), "has slices that are shifted sideways: " + named(headers, planes[worst]) + " lies " +
                                 mm_text(std::hypot(u[worst], v[worst])) +
                                 " to the side of the others; keep the slices of one stack, or resample it to a "
                                 "rectangular grid" +
                                 by_resampling());
}

}  // namespace homolog
