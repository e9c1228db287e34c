#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/files/volume_mesh.h"

namespace homolog {

/// A ball whose outside is `surface`, cut into shells of tetrahedra around its centre: what a mesher gives of it.
/// Orientation is that of VTK.
struct BallOfTetrahedra {
  Points points;
  Tetrahedra tetrahedra;

  BallOfTetrahedra(const Mesh& surface, int shells) {
    const Eigen::Index n = surface.points.rows();
    points.resize(1 + n * shells, 3);
    const Eigen::RowVector3d centre = surface.points.colwise().mean();
    points.row(0) = centre;
    for (int s = 0; s < shells; ++s)
      points.middleRows(1 + s * n, n) = ((surface.points.rowwise() - centre) * ((s + 1.0) / shells)).rowwise() + centre;
    std::vector<std::array<std::int32_t, 4>> all;
    const auto at = [&](int shell, std::int32_t v) { return static_cast<std::int32_t>(1 + shell * n + v); };
    for (const auto& face : surface.topology->triangles().rowwise()) {
      all.push_back({0, at(0, face[0]), at(0, face[1]), at(0, face[2])});
      // A prism is cut by the order of its corners' numbers, so that neighbours agree.
      std::array<std::int32_t, 3> c{face[0], face[1], face[2]};
      while (c[0] > c[1] || c[0] > c[2]) c = {c[1], c[2], c[0]};
      for (int s = 1; s < shells; ++s) {
        const std::array<std::int32_t, 6> p{at(s - 1, c[0]), at(s - 1, c[1]), at(s - 1, c[2]),
                                            at(s, c[0]),     at(s, c[1]),     at(s, c[2])};
        if (c[1] < c[2]) {
          all.push_back({p[0], p[1], p[2], p[5]});
          all.push_back({p[0], p[1], p[5], p[4]});
        } else {
          all.push_back({p[0], p[1], p[2], p[4]});
          all.push_back({p[0], p[4], p[2], p[5]});
        }
        all.push_back({p[0], p[4], p[5], p[3]});
      }
    }
    tetrahedra.resize(static_cast<Eigen::Index>(all.size()), 4);
    for (std::size_t t = 0; t < all.size(); ++t)
      tetrahedra.row(static_cast<Eigen::Index>(t)) = Eigen::Map<const Eigen::RowVector4i>(all[t].data());
  }

  /// As a .vtu file, with the number of each point and each element as values.
  std::string vtu(bool ras = false) const {
    std::string coordinates, corners, ends, kinds, of_points, of_elements;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      for (int k = 0; k < 3; ++k) coordinates += std::to_string(ras && k < 2 ? -points(i, k) : points(i, k)) + " ";
      of_points += std::to_string(i) + " ";
    }
    for (Eigen::Index t = 0; t < tetrahedra.rows(); ++t) {
      for (int k = 0; k < 4; ++k) corners += std::to_string(tetrahedra(t, k)) + " ";
      ends += std::to_string(4 * (t + 1)) + " ";
      kinds += "10 ";
      of_elements += std::to_string(7 * t) + " ";
    }
    const auto array = [](const std::string& type, const std::string& name, const std::string& values) {
      return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"ascii\">" + values + "</DataArray>";
    };
    return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>" +
           std::string(ras ? "<FieldData><DataArray type=\"String\" Name=\"SPACE\" format=\"ascii\">82 65 83 0"
                             "</DataArray></FieldData>"
                           : "") +
           "<Piece NumberOfPoints=\"" + std::to_string(points.rows()) + "\" NumberOfCells=\"" +
           std::to_string(tetrahedra.rows()) + "\"><PointData>" + array("Float64", "number", of_points) +
           "</PointData><CellData>" + array("Int32", "tissue", of_elements) +
           "</CellData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" + coordinates +
           "</DataArray></Points><Cells>" + array("Int64", "connectivity", corners) + array("Int64", "offsets", ends) +
           array("UInt8", "types", kinds) + "</Cells></Piece></UnstructuredGrid></VTKFile>";
  }

  /// As a .msh file of version 2.2, with a physical group.
  std::string msh() const {
    std::string text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 7 \"cortex\"\n$EndPhysicalNames\n"
        "$Nodes\n" +
        std::to_string(points.rows()) + "\n";
    for (Eigen::Index i = 0; i < points.rows(); ++i)
      text += std::to_string(3 * i + 1) + " " + std::to_string(points(i, 0)) + " " + std::to_string(points(i, 1)) +
              " " + std::to_string(points(i, 2)) + "\n";
    text += "$EndNodes\n$Elements\n" + std::to_string(tetrahedra.rows()) + "\n";
    for (Eigen::Index t = 0; t < tetrahedra.rows(); ++t) {
      text += std::to_string(t + 1) + " 4 2 7 1";
      for (int k = 0; k < 4; ++k) text += " " + std::to_string(3 * tetrahedra(t, k) + 1);
      text += "\n";
    }
    return text + "$EndElements\n$ElementData\n1\n\"tissue\"\n1\n0\n3\n0\n1\n1\n1 4.5\n$EndElementData\n";
  }
};

/// A ball bent into a bean: the more, the farther from its middle.
inline Points bent(const Points& points, double amount) {
  Points bean = points;
  for (Eigen::Index i = 0; i < bean.rows(); ++i) {
    const double z = points(i, 2);
    bean(i, 0) += amount * z * z;
    bean(i, 1) *= 1 - 0.3 * amount * z;
  }
  return bean;
}

}  // namespace homolog
