#include "app/verbs/verify_compare.h"

#include <algorithm>
#include <cmath>

#include "core/base/file_record.h"
#include "core/base/files.h"
#include "core/mesh/mesh_io.h"
#include "core/model/statismo.h"
#include "core/volume/formats/formats.h"
#include "core/volume/readers.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The longest of the distances between points that lie behind one another in two vectors.
double largest_distance_mm(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (points_of(a) - points_of(b)).rowwise().norm().maxCoeff();
}

Result<FileDifference> difference_of_meshes(const fs::path& file, const fs::path& anew) {
  const auto a = read_mesh_file(file), b = read_mesh_file(anew);
  if (!a) return fail(a.error());
  if (!b) return fail(b.error());
  FileDifference difference;
  if (a->points.rows() != b->points.rows()) {
    difference.in_words = "it has " + std::to_string(a->points.rows()) + " vertices, and the new one has " +
                          std::to_string(b->points.rows());
    return difference;
  }
  difference.largest_mm = (a->points - b->points).rowwise().norm().maxCoeff();
  const bool faces = a->triangles.rows() == b->triangles.rows() && a->triangles == b->triangles;
  difference.same_content = faces && *difference.largest_mm == 0;
  if (!faces) difference.in_words = "its faces are others";
  return difference;
}

Result<FileDifference> difference_of_models(const fs::path& file, const fs::path& anew) {
  const auto a = read_model(file), b = read_model(anew);
  if (!a) return fail(a.error());
  if (!b) return fail(b.error());
  FileDifference difference;
  if (a->mean.size() != b->mean.size() || a->modes() != b->modes()) {
    difference.in_words = "it has " + std::to_string(a->mean.size() / 3) + " vertices and " +
                          std::to_string(a->modes()) + " modes, and the new one has " +
                          std::to_string(b->mean.size() / 3) + " and " + std::to_string(b->modes());
    return difference;
  }
  double largest_mm = largest_distance_mm(a->mean, b->mean);
  for (Eigen::Index k = 0; k < a->modes(); ++k)
    largest_mm = std::max(largest_mm, largest_distance_mm(a->basis.col(k) * std::sqrt(a->variances[k]),
                                                          b->basis.col(k) * std::sqrt(b->variances[k])));
  difference.largest_mm = largest_mm;
  difference.same_content = largest_mm == 0;
  return difference;
}

Result<FileDifference> difference_of_volumes(const fs::path& file, const fs::path& anew, Progress& progress) {
  VolumeReadOptions options;
  options.progress = &progress;
  const auto a = read_volume(file, options), b = read_volume(anew, options);
  if (!a) return fail(a.error());
  if (!b) return fail(b.error());
  FileDifference difference;
  if (!same_grid(a->volume.geometry, b->volume.geometry) || a->volume.frames != b->volume.frames) {
    difference.in_words = "its grid is another";
    return difference;
  }
  std::size_t differ = 0;
  std::visit(
      [&](const auto& first, const auto& second) {
        for (std::size_t v = 0; v < std::min(first.size(), second.size()); ++v)
          if (static_cast<double>(first[v]) != static_cast<double>(second[v])) ++differ;
      },
      a->volume.data, b->volume.data);
  difference.voxels = differ;
  difference.same_content = differ == 0;
  if (differ == 0) difference.largest_mm = 0;
  return difference;
}

/// Of tables, pages and pictures.
FileDifference difference_of_bytes(std::string_view a, std::string_view b) {
  FileDifference difference;
  const auto differ = std::ranges::mismatch(a, b);
  difference.same_content = a == b;
  const std::string_view same = a.substr(0, static_cast<std::size_t>(differ.in1 - a.begin()));
  const bool is_text = a.find('\0') == a.npos;
  if (difference.same_content) return difference;
  difference.in_words =
      is_text ? "line " + std::to_string(1 + std::ranges::count(same, '\n')) + " is another" : "its bytes are others";
  return difference;
}

}  // namespace

Result<FileDifference> difference_of_files(const fs::path& file, const fs::path& anew, Progress& progress) {
  const auto a = read_whole_file(file), b = read_whole_file(anew);
  if (!a) return fail(a.error());
  if (!b) return fail(b.error());
  if (*a == *b) return FileDifference{true, true, 0, std::nullopt, {}};
  if (is_mesh_name(file)) return difference_of_meshes(file, anew);
  if (is_model_name(file)) return difference_of_models(file, anew);
  if (has_ending(file, volume_format_endings(&VolumeFormat::written)))
    return difference_of_volumes(file, anew, progress);
  return difference_of_bytes(without_record(file, *a), without_record(anew, *b));
}

}  // namespace homolog
