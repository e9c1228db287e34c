#include "core/mesh/files/volume_mesh.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "core/base/files/files.h"
#include "core/base/numbers/limits.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/text.h"
#include "core/mesh/formats/volume_cells.h"

namespace homolog {

struct VolumeFile {
  std::string bytes, extension;
  std::vector<formats::PointsPlace> places;
  formats::PointsForm form = formats::PointsForm::text;
  bool ras = false;
};

namespace {

/// Corners that no point belies, and their orientation.
Result<void> take_tetrahedra(const std::vector<std::int32_t>& corners, VolumeMesh& mesh) {
  mesh.tetrahedra = Eigen::Map<const Tetrahedra>(corners.data(), std::ssize(corners) / 4, 4);
  for (const std::int32_t v : corners)
    if (v >= mesh.points.rows())
      return fail("", "a tetrahedron names point " + std::to_string(v) + " of " + std::to_string(mesh.points.rows()) +
                          " (counted from 0); copy or export it again");
  if (mesh.tetrahedra.rows() == 0)
    return fail("", "holds no tetrahedra; export the volume with its elements, not its surface alone");
  if ((sixfold_volumes(mesh.tetrahedra, mesh.points).array() < 0).all())
    mesh.tetrahedra.col(2).swap(mesh.tetrahedra.col(3));
  const auto bad = (scaled_jacobians(mesh.tetrahedra, mesh.points).array() <= 1e-12).count();
  if (bad > 0)
    return fail("", "has " + std::to_string(bad) + " of " + std::to_string(mesh.tetrahedra.rows()) +
                        " tetrahedra that are flat or turned over; mend it where it was made");
  return {};
}

void append_points(const VolumeFile& file, const formats::PointsPlace& place, const Points& points,
                   std::string& bytes) {
  const auto rows = points.middleRows(place.first, place.count);
  using enum formats::PointsForm;
  if (file.form == vtk_xml)
    bytes += "<Points>\n<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double x = file.ras && k < 2 ? -rows(i, k) : rows(i, k);
      if (file.form == little_endian || file.form == big_endian) {
        formats::store(x, file.form == little_endian ? std::endian::little : std::endian::big, bytes);
        continue;
      }
      if (k > 0) bytes += ' ';
      formats::append_number(x, bytes);
    }
    if (file.form == vtk_xml) bytes += '\n';
  }
  if (file.form == vtk_xml) bytes += "</DataArray>\n</Points>";
}

std::array<Vec3, 4> corners_of(const Tetrahedra& tetrahedra, const Points& points, Eigen::Index t) {
  std::array<Vec3, 4> corners;
  for (int k = 0; k < 4; ++k) corners[k] = points.row(tetrahedra(t, k));
  return corners;
}

double sixfold_volume(const std::array<Vec3, 4>& x) {
  return (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]);
}

}  // namespace

Result<VolumeMesh> read_volume_mesh(const std::filesystem::path& path) {
  const MeshFormat* format = mesh_format_of(path);
  if (format != &formats::vtu && format != &formats::msh)
    return fail(path.string(), "is no mesh of tetrahedra by its name; use .vtu or .msh");
  auto bytes = read_whole_file(path);
  if (!bytes) return fail(bytes.error());
  if (bytes->empty()) return fail(path.string(), "is empty; copy or export it again");
  auto cells = format == &formats::vtu ? formats::vtu_cells(*bytes) : formats::msh_cells(*bytes, true);
  if (!cells) return fail(path.string(), cells.error().what);
  VolumeMesh mesh;
  mesh.points = formats::to_points(std::move(cells->coordinates));
  if (mesh.points.rows() == 0) return fail(path.string(), "holds no points; export it again");
  if (!all_in_reach(mesh.points)) return fail(path.string(), "has a point that is no place in mm; export it again");
  MeshFile probe;  // takes what the file says of its space
  probe.points = Points::Ones(1, 3);
  cells->space.apply_to(probe);
  const bool ras = probe.points(0, 0) < 0;
  if (ras) mesh.points.leftCols<2>() *= -1;
  mesh.warnings = std::move(probe.warnings);
  mesh.warnings.insert(mesh.warnings.end(), cells->warnings.begin(), cells->warnings.end());
  if (cells->vectors > 0)
    mesh.warnings.push_back(
        "has " + std::to_string(cells->vectors) +
        " arrays of three or nine values, which are kept as they are; where these are directions, they are "
        "not turned with the shape");
  if (auto whole = formats::check_corners(cells->tetrahedra); !whole) return fail(path.string(), whole.error().what);
  formats::drop_repeated(cells->tetrahedra, mesh.warnings);
  if (auto taken = take_tetrahedra(cells->tetrahedra, mesh); !taken) return fail(path.string(), taken.error().what);
  Eigen::Index placed = 0;
  std::size_t done = 0;
  for (const formats::PointsPlace& place : cells->places) {
    if (place.at < done) break;
    placed += place.count;
    done = place.at + place.length;
  }
  if (placed != mesh.points.rows())
    return fail(path.string(), "is not written in UTF-8, so it cannot be written again; export it again");
  mesh.file = std::make_shared<const VolumeFile>(
      VolumeFile{std::move(*bytes), format->extension, std::move(cells->places), cells->form, ras});
  return mesh;
}

std::string volume_mesh_extension(const VolumeMesh& mesh) {
  return mesh.file->extension;
}

Result<void> write_volume_mesh(const VolumeMesh& mesh, const Points& points, const std::filesystem::path& path) {
  const VolumeFile& file = *mesh.file;
  std::string bytes;
  std::size_t done = 0;
  for (const formats::PointsPlace& place : file.places) {
    bytes.append(file.bytes, done, place.at - done);
    append_points(file, place, points, bytes);
    done = place.at + place.length;
  }
  bytes.append(file.bytes, done);
  return write_whole_file(path, bytes);
}

VertexScalars sixfold_volumes(const Tetrahedra& tetrahedra, const Points& points) {
  VertexScalars volumes(tetrahedra.rows());
  for (Eigen::Index t = 0; t < volumes.size(); ++t) volumes[t] = sixfold_volume(corners_of(tetrahedra, points, t));
  return volumes;
}

VertexScalars scaled_jacobians(const Tetrahedra& tetrahedra, const Points& points) {
  VertexScalars values(tetrahedra.rows());
  for (Eigen::Index t = 0; t < values.size(); ++t) {
    const auto x = corners_of(tetrahedra, points, t);
    const auto edge = [&](std::size_t a, std::size_t b) { return (x[a] - x[b]).norm(); };
    const double ab = edge(0, 1), ac = edge(0, 2), ad = edge(0, 3), bc = edge(1, 2), bd = edge(1, 3), cd = edge(2, 3);
    const double most = std::max({ab * ac * ad, ab * bc * bd, ac * bc * cd, ad * bd * cd});
    values[t] = most > 0 ? std::numbers::sqrt2 * sixfold_volume(x) / most : 0;
  }
  return values;
}

namespace {

/// The corners of the outer faces, three a face.
std::vector<std::int32_t> outer_corners(const VolumeMesh& mesh) {
  const std::vector<std::int32_t> corners(mesh.tetrahedra.data(), mesh.tetrahedra.data() + mesh.tetrahedra.size());
  const std::vector<double> coordinates(mesh.points.data(), mesh.points.data() + mesh.points.size());
  return formats::outer_faces(corners, coordinates);
}

}  // namespace

std::vector<char> on_outside(const VolumeMesh& mesh) {
  std::vector<char> outside(static_cast<std::size_t>(mesh.points.rows()), 0);
  for (const std::int32_t v : outer_corners(mesh)) outside[v] = 1;
  return outside;
}

std::optional<Mesh> outside_of(const VolumeMesh& mesh) {
  const std::vector<std::int32_t> corners = outer_corners(mesh);
  std::vector<Eigen::Index> rows;
  std::vector<std::int32_t> index(static_cast<std::size_t>(mesh.points.rows()), -1);
  Triangles triangles(std::ssize(corners) / 3, 3);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    std::int32_t& own = index[corners[c]];
    if (own < 0) {
      own = static_cast<std::int32_t>(rows.size());
      rows.push_back(corners[c]);
    }
    triangles(static_cast<Eigen::Index>(c / 3), static_cast<Eigen::Index>(c % 3)) = own;
  }
  auto topology = Topology::make(std::ssize(rows), std::move(triangles));
  if (!topology) return {};
  return Mesh{std::move(*topology), mesh.points(rows, Eigen::all)};
}

}  // namespace homolog
