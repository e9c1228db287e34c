#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>

#include "core/base/files/files.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/mesh_quality.h"
#include "tests/must.h"
#include "tests/real_data.h"
#include "tests/temporary_folder.h"

// What other programs write otherwise than this one: the space of coordinates, polygons, key words.

namespace fs = std::filesystem;
using namespace homolog;

namespace {

struct FormatFolder : TemporaryFolder {
  Result<MeshFile> read(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return read_mesh_file(path / name);
  }
};

template <class T>
std::string number_bytes(T value, std::endian order) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string base64_of(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

/// Sized as VTK sizes what it stores, in one block where it is compressed.
std::string stored(const std::string& bytes, bool compressed, bool base64) {
  const auto size = [](std::size_t n) { return number_bytes(static_cast<std::uint32_t>(n), std::endian::little); };
  if (!compressed) return base64 ? base64_of(size(bytes.size()) + bytes) : size(bytes.size()) + bytes;
  std::string packed(compressBound(bytes.size()), '\0');
  uLongf packed_size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &packed_size, reinterpret_cast<const Bytef*>(bytes.data()),
           bytes.size());
  packed.resize(packed_size);
  const std::string header = size(1) + size(bytes.size()) + size(0) + size(packed.size());
  return base64 ? base64_of(header) + base64_of(packed) : header + packed;
}

/// A triangle in a VTP with the field SPACE as VTK 9 writes it.
std::string vtp_with_space(const std::string& space, bool ascii, bool appended, bool compressed, bool base64) {
  std::string codes;
  for (const char c : space) codes += std::to_string(static_cast<int>(c)) + ' ';
  const std::string bytes = stored(space + '\0', compressed, base64);
  const std::string open = R"(<Array type="String" Name="SPACE" NumberOfTuples="1" format=)";
  const std::string field = ascii      ? open + "\"ascii\">\n" + codes + "0\n</Array>"
                            : appended ? open + R"("appended" offset="0" />)"
                                       : open + "\"binary\">\n" + bytes + "\n</Array>";
  return R"(<?xml version="1.0"?><VTKFile type="PolyData" version="0.1" byte_order="LittleEndian" header_type="UInt32")" +
         std::string(compressed ? R"( compressor="vtkZLibDataCompressor")" : "") + "><PolyData><FieldData>" + field +
         R"(</FieldData><Piece NumberOfPoints="3" NumberOfPolys="1"><Points><DataArray type="Float32" Name="Points")"
         R"( NumberOfComponents="3" format="ascii">1 2 3 4 2 3 1 6 3</DataArray></Points><Polys>)"
         R"(<DataArray type="Int64" Name="connectivity" format="ascii">0 1 2</DataArray>)"
         R"(<DataArray type="Int64" Name="offsets" format="ascii">3</DataArray></Polys></Piece></PolyData>)" +
         (appended ? "<AppendedData encoding=\"" + std::string(base64 ? "base64" : "raw") + "\">\n_" + bytes +
                         "\n</AppendedData>"
                   : "") +
         "</VTKFile>\n";
}

std::string legacy_head(bool binary) {
  return std::string("# vtk DataFile Version 4.2\nvtk output\n") + (binary ? "BINARY" : "ASCII") +
         "\nDATASET POLYDATA\n";
}

/// The same triangle in a legacy file, with a field before it.
std::string vtk_with_field(const std::string& field, bool binary) {
  std::string text = legacy_head(binary) + "FIELD FieldData 1\n" + field + "\nPOINTS 3 float\n";
  if (!binary) return text + "1 2 3 4 2 3 1 6 3\nPOLYGONS 1 4\n3 0 1 2\n";
  for (const float x : {1.0f, 2.0f, 3.0f, 4.0f, 2.0f, 3.0f, 1.0f, 6.0f, 3.0f})
    text += number_bytes(x, std::endian::big);
  text += "\nPOLYGONS 1 4\n";
  for (const std::int32_t v : {3, 0, 1, 2}) text += number_bytes(v, std::endian::big);
  return text + '\n';
}

void check_space(const Result<MeshFile>& mesh, bool flipped, std::size_t warnings) {
  REQUIRE_MESSAGE(mesh, mesh.error().sentence());
  CHECK(Vec3(mesh->points.row(0)) == (flipped ? Vec3(-1, -2, 3) : Vec3(1, 2, 3)));
  CHECK(mesh->warnings.size() == warnings);
}

const std::vector<Vec3> letter_l{{0, 0, 0}, {30, 0, 0}, {30, 10, 0}, {10, 10, 0}, {10, 30, 0}, {0, 30, 0}};

/// A prism: its base and its top polygons that begin at corner `first`, its sides quads.
struct Prism {
  std::vector<Vec3> points;
  std::vector<std::vector<int>> faces;

  Prism(const std::vector<Vec3>& base, const Vec3& up, int first) {
    const int n = static_cast<int>(base.size());
    points = base;
    for (const Vec3& p : base) points.push_back(p + up);
    std::vector<int> bottom, top;
    for (int k = 0; k < n; ++k) bottom.push_back((first + n - k) % n);
    for (int k = 0; k < n; ++k) top.push_back(n + (first + k) % n);
    faces = {bottom, top};
    for (int k = 0; k < n; ++k) faces.push_back({k, (k + 1) % n, n + (k + 1) % n, n + k});
  }

  std::string coordinates(const std::string& before = "") const {
    std::string text;
    char line[100];
    for (const Vec3& p : points) {
      std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", p.x(), p.y(), p.z());
      text += before + line;
    }
    return text;
  }
  std::string obj() const {
    std::string text = coordinates("v ");
    for (const auto& face : faces) {
      text += 'f';
      for (const int v : face) text += ' ' + std::to_string(v + 1);
      text += '\n';
    }
    return text;
  }
  std::string counted() const {
    std::string text;
    for (const auto& face : faces) {
      text += std::to_string(face.size());
      for (const int v : face) text += ' ' + std::to_string(v);
      text += '\n';
    }
    return text;
  }
  std::string ply() const {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size()) +
           "\nproperty double x\nproperty double y\nproperty double z\nelement face " + std::to_string(faces.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n" + coordinates() + counted();
  }
  std::string vtk() const {
    std::size_t size = 0;
    for (const auto& face : faces) size += face.size() + 1;
    return legacy_head(false) + "POINTS " + std::to_string(points.size()) + " double\n" + coordinates() + "POLYGONS " +
           std::to_string(faces.size()) + ' ' + std::to_string(size) + '\n' + counted();
  }
  std::string vtp() const {
    std::string connectivity, ends;
    std::size_t end = 0;
    for (const auto& face : faces) {
      for (const int v : face) connectivity += std::to_string(v) + ' ';
      ends += std::to_string(end += face.size()) + ' ';
    }
    return R"(<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints=")" + std::to_string(points.size()) +
           R"(" NumberOfPolys=")" + std::to_string(faces.size()) +
           R"("><Points><DataArray type="Float64" format="ascii">)" + coordinates() +
           R"(</DataArray></Points><Polys><DataArray type="Int32" Name="connectivity" format="ascii">)" + connectivity +
           R"(</DataArray><DataArray type="Int32" Name="offsets" format="ascii">)" + ends +
           "</DataArray></Polys></Piece></PolyData></VTKFile>\n";
  }
};

void check_solid(const Result<MeshFile>& file, double area_mm2, double volume_ml) {
  REQUIRE_MESSAGE(file, file.error().sentence());
  const auto mesh = sound_mesh(*file);
  REQUIRE_MESSAGE(mesh, mesh.error().sentence());
  CHECK(surface_area_mm2(*mesh) == doctest::Approx(area_mm2).epsilon(1e-6));
  CHECK(enclosed_volume_ml(*mesh) == doctest::Approx(volume_ml).epsilon(1e-6));
  for (Eigen::Index f = 0; f < mesh->topology->triangles().rows(); ++f) CHECK(smallest_angle_deg(*mesh, f) > 0.01);
}

}  // namespace

TEST_CASE("VTP that VTK wrote in RAS is flipped however it stores the field") {
  const FormatFolder folder;
  for (const bool ascii : {true, false})
    for (const bool appended : {false, true})
      for (const bool compressed : {false, true})
        for (const bool base64 : {true, false}) {
          if ((ascii && (appended || compressed)) || (!appended && !base64)) continue;
          CAPTURE(ascii);
          CAPTURE(appended);
          CAPTURE(compressed);
          CAPTURE(base64);
          const auto read = [&](const std::string& space) {
            return folder.read("a.vtp", vtp_with_space(space, ascii, appended, compressed, base64));
          };
          check_space(read("RAS"), true, 0);
          check_space(read("LPS"), false, 0);
          check_space(read("Unknown"), false, 1);
        }
  if (const fs::path data = real_data(); !data.empty()) {
    const auto ras = read_mesh_file(data / "odd/vtk_space_ras.vtp");
    REQUIRE(ras);
    CHECK((Vec3(ras->points.row(0)) - Vec3(5.3298, -18.52, 11)).norm() < 1e-3);  // (-5.3298, 18.52, 11) in the file
  }
}

TEST_CASE("a field of legacy VTK that names the space is followed in text and in binary") {
  const FormatFolder folder;
  check_space(folder.read("a.vtk", vtk_with_field("SPACE 1 1 string\nRAS", false)), true, 0);
  check_space(folder.read("a.vtk", vtk_with_field("SPACE 1 1 string\n%52AS", false)), true, 0);
  check_space(folder.read("a.vtk", vtk_with_field("SPACE 1 3 char\n82 65 83", false)), true, 0);
  check_space(folder.read("a.vtk", vtk_with_field("SPACE 1 1 string\nLPS", false)), false, 0);
  check_space(folder.read("a.vtk", vtk_with_field("SPACE 1 1 string\nUnknown", false)), false, 1);
  check_space(folder.read("a.vtk", vtk_with_field("OTHER 1 1 string\nRAS", false)), false, 0);
  check_space(folder.read("a.vtk", vtk_with_field("SPACE 1 1 string\n\xc3RAS", true)), true, 0);
  check_space(folder.read("a.vtk", vtk_with_field("SPACE 1 1 string\n\xc3LPS", true)), false, 0);
}

TEST_CASE("a space that is neither LPS nor RAS is warned of in every format") {
  const FormatFolder folder;
  const std::string points = "v 1 2 3\nv 4 2 3\nv 1 6 3\n", face = "f 1 2 3\n";
  check_space(folder.read("a.obj", "# SPACE=RAS\n" + points + face), true, 0);
  check_space(folder.read("a.obj", points + face + "# SPACE = RAS\n"), true, 0);
  check_space(folder.read("a.obj", "# SPACE=ras\n" + points + face), true, 0);
  check_space(folder.read("a.obj", "# SPACE=scanner\n" + points + face), false, 1);
  check_space(folder.read("a.obj", "# SPACE=RAS, was SPACE=LPS\n" + points + face), true, 1);
  check_space(folder.read("a.obj", "# WORKSPACE=RAS, free space=12\n" + points + face), false, 0);
  const std::string ply =
      "ply\nformat ascii 1.0\ncomment SPACE=Unknown\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "1 2 3\n4 2 3\n1 6 3\n3 0 1 2\n";
  check_space(folder.read("a.ply", ply), false, 1);
  CHECK(
      folder.read("a.ply", ply)->warnings.front() ==
      "gives its space as \"Unknown\", which is neither LPS nor RAS; its coordinates are taken as LPS, so check where "
      "it lies");
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 1 2 3\nvertex 4 2 3\nvertex 1 6 3\nendloop\nendfacet\n";
  check_space(folder.read("a.stl", "solid a SPACE=RAS\n" + facet + "endsolid a\n"), true, 0);
  check_space(folder.read("a.stl", "solid a SPACE=voxels\n" + facet + "endsolid a\n"), false, 1);
}

TEST_CASE("polygons that bend inward are cut within their outline in every format") {
  const FormatFolder folder;
  for (int first = 0; first < 6; ++first) {
    CAPTURE(first);
    const Prism prism(letter_l, {0, 0, 10}, first);
    check_solid(folder.read("l.obj", prism.obj()), 2200, 5);
    check_solid(folder.read("l.ply", prism.ply()), 2200, 5);
    check_solid(folder.read("l.vtk", prism.vtk()), 2200, 5);
    check_solid(folder.read("l.vtp", prism.vtp()), 2200, 5);
  }
}

TEST_CASE("corners on straight edges and spikes and turned planes are cut without flat triangles") {
  const FormatFolder folder;
  const std::vector<Vec3> with_middles{{0, 0, 0},   {10, 0, 0},  {20, 0, 0},  {30, 0, 0}, {30, 5, 0},
                                       {30, 10, 0}, {10, 10, 0}, {10, 30, 0}, {0, 30, 0}, {0, 10, 0}};
  std::vector<Vec3> star, comb{{0, 0, 0}, {80, 0, 0}};
  for (int k = 0; k < 10; ++k) {
    const double angle = std::numbers::pi * k / 5, radius = k % 2 == 0 ? 30 : 6;
    star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  for (int tooth = 7; tooth >= 0; --tooth) {
    comb.emplace_back(10 * tooth + 10, tooth == 7 ? 40 : 5, 0);
    comb.emplace_back(10 * tooth + 5, 40, 0);
  }
  const Mat3 turned = (Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())).toRotationMatrix();
  for (const auto& outline : {with_middles, star, comb})
    for (int first = 0; first < static_cast<int>(outline.size()); ++first) {
      CAPTURE(first);
      double area = 0, around = 0;
      std::vector<Vec3> base;
      for (std::size_t k = 0; k < outline.size(); ++k) {
        const Vec3 &a = outline[k], &b = outline[(k + 1) % outline.size()];
        area += (a.x() * b.y() - a.y() * b.x()) / 2;
        around += (b - a).norm();
        base.push_back(turned * a + Vec3(100, -200, 300));
      }
      check_solid(folder.read("p.obj", Prism(base, turned * Vec3(0, 0, 10), first).obj()), 2 * area + 10 * around,
                  area / 100);
    }
}

TEST_CASE("a polygon that is no plane or has no inside still gives as many triangles") {
  const FormatFolder folder;
  const std::string points = "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\n";
  const auto read = [&](const std::string& text) {
    auto mesh = folder.read("a.obj", text);
    REQUIRE_MESSAGE(mesh, mesh.error().sentence());
    return std::move(*mesh);
  };
  const auto fan = [](const MeshFile& mesh) {
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f)
      if (mesh.triangles.row(f) != Eigen::RowVector3i(0, static_cast<int>(f) + 1, static_cast<int>(f) + 2))
        return false;
    return true;
  };
  CHECK(fan(read(points + "f 1 2 3 4\n")));
  CHECK(fan(read("v 0 0 0\nv 10 0 3\nv 10 10 0\nv 0 10 3\nf 1 2 3 4\n")));   // a saddle: either diagonal lies within
  CHECK(!fan(read("v 0 0 0\nv 10 1 0\nv 3 3 0.5\nv 1 10 0\nf 2 3 4 1\n")));  // an arrow that is bent a little
  CHECK(read("v 0 0 0\nv 10 10 0\nv 10 0 0\nv 0 10 0\nf 1 2 3 4\n").triangles.rows() == 2);         // crosses itself
  CHECK(read("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 4 0 0\nf 1 2 3 4 5\n").triangles.rows() == 3);  // a line
  CHECK(read("v 5 5 5\nv 5 5 5\nv 5 5 5\nv 5 5 5\nf 1 2 3 4\n").triangles.rows() == 2);             // a point
  // A square with a square hole, joined to it by a slit: 400 mm² without 100.
  const auto frame = read(
      "v 0 0 0\nv 20 0 0\nv 20 20 0\nv 0 20 0\nv 5 5 0\nv 5 15 0\nv 15 15 0\nv 15 5 0\n"
      "f 1 2 3 4 1 5 6 7 8 5\n");
  REQUIRE(frame.triangles.rows() == 8);
  double area = 0;
  for (Eigen::Index f = 0; f < 8; ++f) {
    const auto corner = [&](int k) { return Vec3(frame.points.row(frame.triangles(f, k))); };
    const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)) / 2;
    CHECK(normal.z() > 0);
    area += normal.z();
  }
  CHECK(area == doctest::Approx(300));
}

TEST_CASE("a polygon of a hundred thousand corners that bends is refused and does not run for minutes") {
  const FormatFolder folder;
  std::string text, face = "f";
  for (int k = 0; k < 100'000; ++k) {
    const double angle = 2 * std::numbers::pi * k / 100'000, radius = k % 2 == 0 ? 100 : 99;
    text += "v " + std::to_string(radius * std::cos(angle)) + ' ' + std::to_string(radius * std::sin(angle)) + " 0\n";
    face += ' ' + std::to_string(k + 1);
  }
  const auto mesh = folder.read("a.obj", text + face + '\n');
  REQUIRE(!mesh);
  CHECK(mesh.error().sentence().find("so many corners") != std::string::npos);
}

TEST_CASE("OBJ lines go on behind a backslash and a weight other than 1 is refused") {
  const FormatFolder folder;
  const std::string points = "v 0 0 0\nv 30 0 \\\n0\nv 30 30 0\n";
  const auto check_three = [&](const Result<MeshFile>& mesh, Eigen::Index faces) {
    REQUIRE_MESSAGE(mesh, mesh.error().sentence());
    CHECK(mesh->triangles.rows() == faces);
    CHECK(Vec3(mesh->points.row(1)) == Vec3(30, 0, 0));
  };
  check_three(folder.read("a.obj", points + "f 1 2 \\\r\n 3\n"), 1);
  check_three(folder.read("a.obj", points + "v 0 30 0\nf 1 2 \\\n 3 \\\n 4\n"), 2);
  check_three(folder.read("a.obj", "# C:\\models\\\n" + points + "f 1 2 3 # the only one\n"), 1);
  check_three(folder.read("a.obj", "v 0 0 0 1.0\nv 30 0 0 1\nv 30 30 0 1\nf 1 2 3\n"), 1);
  check_three(folder.read("a.obj", "v 0 0 0 0.5 0.5 1\nv 30 0 0 0 0 0\nv 30 30 0 1 1 1\nf 1 2 3\n"), 1);  // colours
  for (const char* vertex : {"v 60 0 0 2", "v 30 0 0 0", "v 30 0 0 nan"}) {
    CAPTURE(vertex);
    const auto mesh = folder.read("a.obj", "v 0 0 0\n" + std::string(vertex) + "\nv 30 30 0\nf 1 2 3\n");
    REQUIRE(!mesh);
    CHECK(mesh.error().sentence().find("vertex 1 has a weight other than 1") != std::string::npos);
  }
  CHECK(!folder.read("a.obj", "v 0 0 0\nv 1,5 0 0\nv 30 30 0\nf 1 2 3\n"));
}

TEST_CASE("STL in capitals is read as text and a binary one may begin with solid") {
  const FormatFolder folder;
  const std::string upper =
      "SOLID X\nFACET NORMAL 0 0 0\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\nENDSOLID "
      "X\n";
  const auto read = folder.read("a.stl", upper);
  REQUIRE_MESSAGE(read, read.error().sentence());
  CHECK(read->triangles.rows() == 1);
  CHECK(folder.read("a.stl", upper.substr(0, 100)).error().sentence().find("truncated") != std::string::npos);

  for (const char* begin : {"solid by CAD", "SOLID"}) {
    std::string binary(80, begin[0] == 's' ? ' ' : '\0');
    binary.replace(0, std::strlen(begin), begin);
    binary += number_bytes(std::uint32_t{1}, std::endian::little);
    for (const float x : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f})
      binary += number_bytes(x, std::endian::little);
    const auto mesh = folder.read("b.stl", binary + std::string(2, '\0'));
    REQUIRE_MESSAGE(mesh, mesh.error().sentence());
    CHECK(mesh->triangles.rows() == 1);
    CHECK(folder.read("b.stl", binary).error().sentence().find("announces 1 faces") != std::string::npos);
  }
}

TEST_CASE("key words of legacy VTK may be written in small letters or capitals") {
  const FormatFolder folder;
  const std::string text =
      "# vtk DataFile Version 5.1\nTitle\nascii\ndataset PolyData\nfield FieldData 1\nspace 1 1 String\nRAS\n"
      "metadata\ninformation 0\n\npoints 3 Float\n1 2 3 4 2 3 1 6 3\npolygons 2 3\noffsets VTKTypeInt64\n0 3\n"
      "Connectivity vtktypeint64\n0 1 2\npoint_data 3\nscalars x float\nLOOKUP_TABLE default\n1 2 3\n";
  const auto mesh = folder.read("a.vtk", text);
  REQUIRE_MESSAGE(mesh, mesh.error().sentence());
  CHECK(mesh->triangles.rows() == 1);
  CHECK(Vec3(mesh->points.row(0)) == Vec3(1, 2, 3));  // a field "space" is another one
}

TEST_CASE("values of a VTK file that are cut short or no numbers are named") {
  const FormatFolder folder;
  MeshFile file = test::must(folder.read("a.vtk", vtk_with_field("OTHER 1 1 string\nRAS", false)));
  file.doubt_mm = VertexScalars::Constant(3, 0.5);
  const std::filesystem::path whole = folder.path / "whole.vtk";
  REQUIRE(write_mesh_file(file, whole));
  CHECK(test::must(read_mesh_file(whole)).doubt_mm);
  const std::string bytes = test::must(read_whole_file(whole));
  const auto names = [&](const std::string& damaged, const std::string& what) {
    const auto mesh = folder.read("cut.vtk", damaged);
    REQUIRE_MESSAGE(mesh, mesh.error().sentence());
    CHECK(!mesh->doubt_mm);
    CHECK(std::ranges::any_of(mesh->warnings,
                              [&](const std::string& warning) { return warning.find(what) != std::string::npos; }));
  };
  names(bytes.substr(0, bytes.size() - 6), "values \"doubt_mm\" are cut short or damaged");
  names(bytes.substr(0, bytes.find("doubt_mm 1 3 float") + 10), "values \"doubt_mm\" are cut short or damaged");
  std::string nan = bytes;
  nan.replace(nan.size() - 5, 4, number_bytes(std::numeric_limits<float>::quiet_NaN(), std::endian::big));
  names(nan, "values \"doubt_mm\" are cut short or damaged");
}
