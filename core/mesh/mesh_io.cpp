#include "core/mesh/mesh_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/files/file_record.h"
#include "core/base/files/files.h"
#include "core/base/files/freesurfer_files.h"
#include "core/base/numbers/limits.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/mesh/formats/formats.h"

namespace homolog {
namespace {

Result<const MeshFormat*> format_of(const std::filesystem::path& path) {
  if (const MeshFormat* format = mesh_format_of(path)) return format;
  if (std::string words = freesurfer_words(path); !words.empty()) return fail(path.string(), std::move(words));
  return fail(path.string(), "is not a mesh file of a known kind; use " + listed(mesh_format_extensions(), " or "));
}

/// Every array that a format may hold has a value for every vertex.
Result<void> check_arrays(const MeshFile& mesh) {
  const Eigen::Index vertices = mesh.points.rows();
  const auto lacks = [](const std::string& what) {
    return fail("", "does not give every vertex " + what + "; export it again");
  };
  if (std::ssize(mesh.regions.of_vertex) != (mesh.regions.list.empty() ? 0 : vertices)) return lacks("a region");
  for (const auto& [name, values] : mesh.arrays)
    if (values.size() != vertices) return lacks("a value of \"" + excerpt(name) + "\"");
  if (!mesh.stiffness) return {};
  if (mesh.stiffness->size() != vertices) return lacks("a stiffness");
  for (Eigen::Index i = 0; i < vertices; ++i) {
    const double factor = (*mesh.stiffness)[i];  // written in single precision
    if (!(factor >= std::numeric_limits<float>::min() && factor <= std::numeric_limits<float>::max()))
      return fail(
          "", "vertex " + std::to_string(i) + " has a stiffness that is no positive number of usual size; correct it");
  }
  return {};
}

Result<void> check_places(const MeshFile& mesh) {
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    if (!mesh.points.row(i).allFinite())
      return fail("", "vertex " + std::to_string(i) +
                          " has a coordinate that is no finite number; mend it with repair-mesh, or export it again");
    if (!all_in_reach(mesh.points.row(i)))
      return fail("", "vertex " + std::to_string(i) + " " + beyond_farthest + "; export it again in mm");
  }
  for (const Landmark& landmark : mesh.landmarks)
    if (!all_in_reach(landmark.position))
      return fail("", "the landmark \"" + excerpt(landmark.name) + "\" " + beyond_farthest + "; export it again in mm");
  return {};
}

Result<void> check(const MeshFile& mesh, bool needs_faces) {
  if (mesh.points.rows() == 0) return fail("", "holds no points; export it again");
  if (needs_faces && mesh.triangles.rows() == 0) return fail("", "holds no faces; export it as a surface of triangles");
  for (const std::int32_t v : mesh.triangles->reshaped<Eigen::RowMajor>())
    if (v < 0 || v >= mesh.points.rows())
      return fail("", "a face names vertex " + std::to_string(v) + " of " + std::to_string(mesh.points.rows()) +
                          " (counted from 0); copy or export it again");
  return check_arrays(mesh);
}

/// Vertices at one place on open edges are a seam that was never closed, as triangle soups have at every edge.
Result<void> check_seams(const Mesh& mesh) {
  std::vector<Eigen::Index> open;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    if (mesh.topology->on_rim(i)) open.push_back(i);
  const auto place = [&](Eigen::Index i) {
    return std::array{mesh.points(i, 0), mesh.points(i, 1), mesh.points(i, 2)};
  };
  std::sort(open.begin(), open.end(),
            [&](Eigen::Index i, Eigen::Index j) { return std::pair(place(i), i) < std::pair(place(j), j); });
  const auto twin = std::adjacent_find(open.begin(), open.end(),
                                       [&](Eigen::Index i, Eigen::Index j) { return place(i) == place(j); });
  if (twin == open.end()) return {};
  return fail("", "vertices " + std::to_string(*twin) + " and " + std::to_string(*(twin + 1)) +
                      " are duplicates at an open edge; merge duplicate vertices of the mesh");
}

/// The fault of a mesh that was put together wrongly: it must not become a file.
Result<void> check_parts(const MeshFile& mesh) {
  const Eigen::Index vertices = mesh.points.rows();
  for (const auto& triangle : mesh.triangles->rowwise())
    for (const std::int32_t vertex : triangle)
      if (vertex < 0 || vertex >= vertices)
        return fail("", "a face names vertex " + std::to_string(vertex) + " of " + std::to_string(vertices) +
                            " (counted from 0), so it is not written; correct the mesh");
  const auto fits = [&](const VertexScalars& values) { return values.size() == vertices; };
  const auto fits_if_there = [&](const auto& values) { return !values || fits(*values); };
  const bool all_fit =
      fits_if_there(mesh.stiffness) &&
      std::ranges::all_of(fit_values, [&](const FitValue& value) { return fits_if_there(mesh.*value.of); }) &&
      std::ranges::all_of(mesh.values, [&](const auto& one) { return fits(one.second); });
  if (!all_fit)
    return fail("", "values of other than its vertices belong to it, so it is not written; correct the mesh");
  return {};
}

}  // namespace

const MeshFormat* mesh_format_of(const std::filesystem::path& path) {
  const std::string name = lower_case(path.filename().string());
  const MeshFormat* found = nullptr;
  for (const MeshFormat* format : mesh_formats) {
    const std::string_view ending = format->extension;
    if (name.size() > ending.size() && name.ends_with(ending) &&
        (found == nullptr || ending.size() > std::string_view(found->extension).size()))
      found = format;
  }
  return found;
}

Result<MeshFile> read_mesh_to_mend(const std::filesystem::path& path) {
  const auto format = format_of(path);
  std::error_code ignored;
  if (!format && !std::filesystem::exists(std::filesystem::symlink_status(path, ignored)))
    return fail(path.string(), "does not exist; check the name");
  if (!format) return fail(format.error());
  const auto bytes = read_whole_file(path);
  if (!bytes) return fail(bytes.error());
  if (bytes->empty()) return fail(path.string(), "is empty; copy or export it again");
  auto mesh = (*format)->read_with_others != nullptr ? (*format)->read_with_others(*bytes, path.parent_path())
                                                     : (*format)->read(*bytes);
  if (!mesh) return fail(path.string(), mesh.error().what);
  if (auto checked = check(*mesh, (*format)->has_faces); !checked) return fail(path.string(), checked.error().what);
  return mesh;
}

Result<MeshFile> read_mesh_file(const std::filesystem::path& path) {
  auto mesh = read_mesh_to_mend(path);
  if (!mesh) return mesh;
  if (auto checked = check_places(*mesh); !checked) return fail(path.string(), checked.error().what);
  return mesh;
}

Result<void> write_mesh_file(const MeshFile& mesh, const std::filesystem::path& path) {
  const auto format = format_of(path);
  if (!format) return fail(format.error());
  if (auto sound = check_parts(mesh); !sound) return fail(path.string(), sound.error().what);
  auto written = write_whole_file(path, [&](std::ostream& out) {
    (*format)->write(mesh, out);
    return Result<void>();
  });
  return written ? write_record_file(path, (*format)->keeps_record ? "" : mesh.record) : written;
}

Result<Mesh> sound_mesh(const MeshFile& file) {
  auto topology = Topology::make(file.points.rows(), file.triangles);
  if (!topology) return fail("", topology.error().what + file.likely_cause);
  Mesh mesh{std::move(*topology), file.points};
  if (auto checked = check_seams(mesh); !checked) return fail("", checked.error().what + file.likely_cause);
  return mesh;
}

Result<std::shared_ptr<const Topology>> shared_topology(const MeshFile& file, std::shared_ptr<const Topology>& known) {
  if (known && known->vertices() == file.points.rows() && known->triangles() == file.triangles) return known;
  auto made = Topology::make(file.points.rows(), file.triangles);
  if (made) known = *made;
  return made;
}

Result<Mesh> read_mesh(const std::filesystem::path& path) {
  const auto file = read_mesh_file(path);
  if (!file) return fail(file.error());
  auto mesh = sound_mesh(*file);
  if (!mesh) return fail(path.string(), mesh.error().what);
  return mesh;
}

Result<void> write_mesh(const Mesh& mesh, const std::filesystem::path& path) {
  MeshFile file;
  file.points = mesh.points;
  file.triangles = mesh.topology;
  return write_mesh_file(file, path);
}

bool is_mesh_name(const std::filesystem::path& path) {
  return format_of(path).has_value();
}

bool keeps_numbers(const std::filesystem::path& path) {
  const auto format = format_of(path);
  return format && (*format)->keeps_numbers;
}

}  // namespace homolog
