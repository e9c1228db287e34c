#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/base/encoding/base64.h"
#include "core/base/files/files.h"
#include "core/mesh/mesh_io.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

// GIFTI, MNI's polygons, VTU and Gmsh, as the programs write them that they come from.

namespace fs = std::filesystem;
using namespace homolog;

namespace {

struct ElementFolder : TemporaryFolder {
  Result<MeshFile> read(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return read_mesh_file(path / name);
  }
};

/// An octahedron in RAS, with no two equal axes: its points and triangles as text.
const char* const ras_points = "10.5 2 0\n-10.5 2 0\n0 12 0\n0 -8 0\n0 2 10.25\n0 2 -10\n";
const char* const octahedron = "0 2 4\n2 1 4\n1 3 4\n3 0 4\n2 0 5\n1 2 5\n3 1 5\n0 3 5\n";

/// Whether it is that octahedron in LPS, moved by `shift`.
bool is_octahedron(const MeshFile& mesh, const Vec3& shift = Vec3::Zero()) {
  Points points(6, 3);
  points << -10.5, -2, 0, 10.5, -2, 0, 0, -12, 0, 0, 8, 0, 0, -2, 10.25, 0, -2, -10;
  return mesh.points.rows() == 6 && mesh.triangles.rows() == 8 &&
         mesh.triangles.row(7) == Eigen::RowVector3i(0, 3, 5) &&
         (mesh.points - (points.rowwise() + shift.transpose())).cwiseAbs().maxCoeff() < 1e-5;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

/// A DataArray as nibabel 5.0 writes it.
std::string gifti_array(const std::string& kind, const std::string& type, const std::string& encoding, int rows,
                        const std::string& data, const std::string& notes = "<MetaData />",
                        const std::string& other = "", const std::string& space = "NIFTI_XFORM_TALAIRACH") {
  return "<DataArray Intent=\"NIFTI_INTENT_" + kind + "\" DataType=\"NIFTI_TYPE_" + type +
         "\" ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Encoding=\"" + encoding +
         "\" Endian=\"LittleEndian\" ExternalFileName=\"" + other + "\" ExternalFileOffset=\"0\" Dim0=\"" +
         std::to_string(rows) + "\" Dim1=\"3\">" + notes + "<CoordinateSystemTransformMatrix><DataSpace>" + space +
         "</DataSpace><TransformedSpace>NIFTI_XFORM_TALAIRACH</TransformedSpace><MatrixData>  1.000000   0.000000   "
         "0.000000   0.000000\n  0.000000   1.000000   0.000000   0.000000\n  0.000000   0.000000   1.000000   "
         "0.000000\n  0.000000   0.000000   0.000000   1.000000</MatrixData></CoordinateSystemTransformMatrix><Data>" +
         data + "</Data></DataArray>";
}
std::string gifti_of(const std::string& arrays) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE GIFTI SYSTEM "
         "\"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n<GIFTI Version=\"1.0\" "
         "NumberOfDataArrays=\"2\"><MetaData /><LabelTable />" +
         arrays + "</GIFTI>";
}

/// What nibabel wrote of the octahedron.
const char* const points_base64 =
    "AAAoQQAAAEAAAAAAAAAowQAAAEAAAAAAAAAAAAAAQEEAAAAAAAAAAAAAAMEAAAAAAAAAAAAAAEAAACRBAAAAAAAAAEAAACDB";
const char* const faces_base64 =
    "AAAAAAIAAAAEAAAAAgAAAAEAAAAEAAAAAQAAAAMAAAAEAAAAAwAAAAAAAAAEAAAAAgAAAAAAAAAFAAAAAQAAAAIAAAAFAAAAAwAAAAEA"
    "AAAFAAAAAAAAAAMAAAAFAAAA";
const char* const points_packed = "eJxjYNBwZGBgcGAAA42DCDYIODgi2AwHkdhANSqOCLbCQQCk0gTb";
const char* const faces_packed = "eJxjYGBgYAJiFijNCGWDaGYoG0QzIKkBAVaoGiYomxnKZ4XKM0PZAAsoAD0=";

std::string gifti_text(const std::string& notes = "<MetaData />", const std::string& space = "NIFTI_XFORM_TALAIRACH") {
  return gifti_of(gifti_array("POINTSET", "FLOAT32", "ASCII", 6, ras_points, notes, "", space) +
                  gifti_array("TRIANGLE", "INT32", "ASCII", 8, octahedron));
}

template <class T>
std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

TEST_CASE("GIFTI surfaces of nibabel are read in every encoding and come from RAS to LPS") {
  const ElementFolder folder;
  CHECK(is_octahedron(test::must(folder.read("a.surf.gii", gifti_text()))));
  CHECK(is_octahedron(test::must(
      folder.read("b.surf.gii", gifti_of(gifti_array("POINTSET", "FLOAT32", "Base64Binary", 6, points_base64) +
                                         gifti_array("TRIANGLE", "INT32", "Base64Binary", 8, faces_base64))))));
  CHECK(is_octahedron(test::must(
      folder.read("c.gii", gifti_of(gifti_array("POINTSET", "FLOAT32", "GZipBase64Binary", 6, points_packed) +
                                    gifti_array("TRIANGLE", "INT32", "GZipBase64Binary", 8, faces_packed))))));
  const auto points = from_base64(points_base64), faces = from_base64(faces_base64);
  std::ofstream(folder.path / "xyz.data", std::ios::binary) << std::string(points.begin(), points.end());
  std::ofstream(folder.path / "tri.data", std::ios::binary) << std::string(faces.begin(), faces.end());
  const std::string outer =
      gifti_of(gifti_array("POINTSET", "FLOAT32", "ExternalFileBinary", 6, "", "<MetaData />", "xyz.data") +
               gifti_array("TRIANGLE", "INT32", "ExternalFileBinary", 8, "", "<MetaData />", "tri.data"));
  CHECK(is_octahedron(test::must(folder.read("d.gii", outer))));
  CHECK(says(folder.read("e.gii", replaced(outer, "xyz.data", "none.data")), "none.data"));
  CHECK(says(folder.read("e.gii", replaced(outer, "xyz.data", "/etc/hostname")), "no file beside it"));
  CHECK(says(folder.read("e.gii", replaced(outer, "Dim0=\"6\"", "Dim0=\"7\"")), "is too short"));
  CHECK(says(folder.read("e.gii", replaced(outer, "Dim0=\"6\"", "Dim0=\"1234567890\"")), "is too short"));
}

TEST_CASE("GIFTI in columns and of the other byte order is read") {
  const ElementFolder folder;
  const std::string columns = "10.5 -10.5 0 0 0 0\n2 2 12 -8 2 2\n0 0 0 0 10.25 -10\n";
  CHECK(is_octahedron(test::must(folder.read(
      "a.gii", replaced(replaced(gifti_text(), ras_points, columns), "RowMajorOrder", "ColumnMajorOrder")))));
  auto points = from_base64(points_base64);
  for (std::size_t k = 0; k < points.size(); k += 4) std::reverse(points.data() + k, points.data() + k + 4);
  const std::string big =
      replaced(gifti_array("POINTSET", "FLOAT32", "Base64Binary", 6, to_base64(points)), "LittleEndian", "BigEndian");
  CHECK(is_octahedron(
      test::must(folder.read("b.gii", gifti_of(big + gifti_array("TRIANGLE", "INT32", "ASCII", 8, octahedron))))));
}

TEST_CASE("a GIFTI surface of FreeSurfer comes to where its scan lies") {
  const ElementFolder folder;
  const auto note = [](const std::string& name, const std::string& value) {
    return "<MD><Name><![CDATA[VolGeom" + name + "]]></Name><Value><![CDATA[" + value + "]]></Value></MD>";
  };
  std::string notes = "<MetaData>";
  const std::array<std::array<const char*, 2>, 12> conformed{{{"X_R", "-1.000000"},
                                                              {"X_A", "0.000000"},
                                                              {"X_S", "0.000000"},
                                                              {"Y_R", "0.000000"},
                                                              {"Y_A", "-0.000000"},
                                                              {"Y_S", "-1.000000"},
                                                              {"Z_R", "-0.000000"},
                                                              {"Z_A", "1.000000"},
                                                              {"Z_S", "0.000000"},
                                                              {"C_R", "-46.25"},
                                                              {"C_A", "-47.5"},
                                                              {"C_S", "-13.75"}}};
  for (const auto& [name, value] : conformed) notes += note(name, value);
  notes += "</MetaData>";
  const MeshFile moved = test::must(folder.read("a.gii", gifti_text(notes, "NIFTI_XFORM_UNKNOWN")));
  CHECK(is_octahedron(moved, {46.25, 47.5, -13.75}));
  CHECK(moved.warnings.size() == 1);
  const MeshFile there = test::must(folder.read("b.gii", gifti_text(notes, "NIFTI_XFORM_SCANNER_ANAT")));
  CHECK(is_octahedron(there));
  CHECK(there.warnings.empty());
  CHECK(moved.warnings[0].find("--to-scanner") != std::string::npos);
  const auto to_scanner = [](const std::string& with_notes, const std::string& shift) {
    return replaced(replaced(gifti_text(with_notes), "<TransformedSpace>NIFTI_XFORM_TALAIRACH",
                             "<TransformedSpace>NIFTI_XFORM_SCANNER_ANAT"),
                    "0.000000   0.000000\n  0.000000", "0.000000   " + shift + "\n  0.000000");
  };
  CHECK(is_octahedron(test::must(folder.read("c.gii", to_scanner("<MetaData />", "5.0"))), {-5, 0, 0}));
  CHECK(is_octahedron(test::must(folder.read("d.gii", to_scanner(notes, "5.0"))), {-5, 0, 0}));
  CHECK(is_octahedron(test::must(folder.read("e.gii", to_scanner(notes, "0.0"))), {46.25, 47.5, -13.75}));
  // In a standard space, as Workbench leaves the notes of where a surface came from.
  for (const char* space : {"NIFTI_XFORM_TALAIRACH", "NIFTI_XFORM_MNI_152"}) {
    std::string standard = gifti_text(notes, space);
    standard = replaced(standard, "<TransformedSpace>NIFTI_XFORM_TALAIRACH", "<TransformedSpace>" + std::string(space));
    const MeshFile stays = test::must(folder.read("f.gii", standard));
    CHECK(is_octahedron(stays));
    CHECK(stays.warnings.empty());
  }
}

TEST_CASE("a matrix that mirrors a GIFTI surface keeps its faces outside and one that is no map is refused") {
  const ElementFolder folder;
  const auto read = [&](const std::string& what, const std::string& by) {
    return folder.read("a.gii", replaced(replaced(gifti_text(), "<TransformedSpace>NIFTI_XFORM_TALAIRACH",
                                                  "<TransformedSpace>NIFTI_XFORM_SCANNER_ANAT"),
                                         what, by));
  };
  const std::string first = "<MatrixData>  1.000000   0.000000", last = "0.000000   1.000000</MatrixData>";
  const auto volume_of = [](const MeshFile& mesh) {
    double sixfold = 0;
    for (const auto& t : mesh.triangles->rowwise()) {
      const Vec3 a = mesh.points.row(t[0]), b = mesh.points.row(t[1]), c = mesh.points.row(t[2]);
      sixfold += a.dot(b.cross(c));
    }
    return sixfold;
  };
  const double whole = volume_of(test::must(folder.read("a.gii", gifti_text())));
  CHECK(volume_of(test::must(read(first, "<MatrixData> -1 0.000000"))) == doctest::Approx(whole));
  CHECK(says(read(first, "<MatrixData> 0 0.000000"), "is singular, so that all points would lie in a plane"));
  CHECK(says(read(last, "0.5   1.000000</MatrixData>"), "is not affine"));
  CHECK(says(read(last, "0.000000   2</MatrixData>"), "is not affine"));
  CHECK_FALSE(read(first, "<MatrixData> nan 0.000000").has_value());
  CHECK_FALSE(read(first, "<MatrixData> inf 0.000000").has_value());
}

TEST_CASE("GIFTI files that are wrong are refused by a sentence") {
  const ElementFolder folder;
  const std::string whole = gifti_text();
  CHECK(says(folder.read("a.gii", replaced(whole, "INTENT_POINTSET", "INTENT_SHAPE")), "holds no surface"));
  CHECK(says(folder.read("a.gii", replaced(whole, "INTENT_TRIANGLE", "INTENT_LABEL")), "INTENT_TRIANGLE is missing"));
  CHECK(says(folder.read("a.gii", replaced(whole, "Dim0=\"6\"", "Dim0=\"5\"")), "another number"));
  CHECK(says(folder.read("a.gii", replaced(whole, "Dim1=\"3\"", "Dim1=\"2\"")), "no rows of three"));
  CHECK(says(folder.read("a.gii", replaced(whole, "10.5 2 0", "nan 2 0")), "no finite number"));
  CHECK(says(folder.read("a.gii", replaced(whole, "0 3 5", "0 3 6")), "vertex 6 of 6"));
  CHECK(says(folder.read("a.gii", replaced(whole, "0 3 5", "0 3 x")), "damaged"));
  CHECK(says(folder.read("a.gii", replaced(whole, "ASCII", "Morse")), "Morse"));
  const std::string packed = gifti_of(gifti_array("POINTSET", "FLOAT32", "GZipBase64Binary", 60000000, points_packed) +
                                      gifti_array("TRIANGLE", "INT32", "ASCII", 8, octahedron));
  CHECK(says(folder.read("a.gii", packed), "unpacks to far more"));
}

TEST_CASE("a written GIFTI is RAS in single precision in the scanner's space") {
  const ElementFolder folder;
  const MeshFile mesh = test::must(folder.read("a.gii", gifti_text()));
  REQUIRE(write_mesh_file(mesh, folder.path / "b.surf.gii"));
  const std::string bytes = read_whole_file(folder.path / "b.surf.gii").value();
  CHECK(bytes.find("<DataSpace>NIFTI_XFORM_SCANNER_ANAT") != std::string::npos);
  const std::size_t at = bytes.find("<Data>") + 6;
  const auto packed = from_base64(bytes.substr(at, bytes.find("</Data>", at) - at));
  std::vector<float> values(18);
  uLongf size = 72;
  REQUIRE(uncompress(reinterpret_cast<Bytef*>(values.data()), &size, packed.data(), packed.size()) == Z_OK);
  CHECK(values[0] == 10.5f);
  CHECK(values[1] == 2.0f);
  CHECK(values[14] == 10.25f);
}

TEST_CASE("polygons of MNI are told from Wavefront's by their content") {
  const ElementFolder folder;
  const std::string normals = "1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n";
  const std::string mni = "P 0.3 0.7 0.5 100 1 6\n " + std::string(ras_points) + "\n " + normals +
                          "\n 8\n 0 1 1 1 1\n\n 3 6 9 12 15 18 21 24\n\n " + octahedron;
  CHECK(is_octahedron(test::must(folder.read("white_surface.obj", mni))));
  CHECK(is_octahedron(test::must(folder.read(
      "of_points.obj", replaced(mni, " 0 1 1 1 1", " 2 1 1 1 1\n1 0 0 1\n1 1 1 1\n1 1 1 1\n1 1 1 1\n1 1 1 1")))));
  CHECK(says(folder.read("a.obj", replaced(mni, "100 1 6", "100 1 7")), "MNI file that is truncated"));
  CHECK(says(folder.read("a.obj", replaced(mni, "100 1 6", "100 1 7000000000")), "MNI file that is truncated"));
  CHECK(says(folder.read("a.obj", mni.substr(0, mni.size() - 4)), "MNI file that is truncated"));
  CHECK(says(folder.read("a.obj", "L 0.1 2\n 0 0 0\n"), "lines"));
  CHECK(says(folder.read("a.obj", std::string("p\0\0\0\x3f", 5) + std::string(40, '\0')), "binary MNI file"));
  const MeshFile mesh = test::must(folder.read("a.obj", mni));
  REQUIRE(write_mesh_file(mesh, folder.path / "b.mni.obj"));
  CHECK(read_whole_file(folder.path / "b.mni.obj").value().starts_with("P "));
  CHECK(is_octahedron(test::must(read_mesh_file(folder.path / "b.mni.obj"))));
  REQUIRE(write_mesh_file(mesh, folder.path / "b.obj"));
  CHECK(read_whole_file(folder.path / "b.obj").value().starts_with("# Homolog"));
}

namespace {

/// Two tetrahedra with a face in common and a point that none has; the second is turned.
std::string vtu_of_tetrahedra(const std::string& kind = "10", const std::string& corners = "0 1 2 3 1 3 2 4") {
  return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece "
         "NumberOfPoints=\"6\" NumberOfCells=\"3\"><PointData><DataArray type=\"Float64\" Name=\"doubt_mm\" "
         "format=\"ascii\">0 1 2 3 4 5</DataArray></PointData><CellData/><Points><DataArray type=\"Float32\" "
         "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1 9 9 9</DataArray></Points><Cells>"
         "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">" +
         corners +
         " 0 1</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4 8 10</DataArray><DataArray "
         "type=\"UInt8\" Name=\"types\" format=\"ascii\">" +
         kind + " 10 3</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
}

bool is_outside_of_two(const MeshFile& mesh) {
  const auto made = sound_mesh(mesh);
  if (!made || mesh.points.rows() != 5 || mesh.triangles.rows() != 6) return false;
  double volume = 0;
  for (Eigen::Index f = 0; f < 6; ++f)
    volume += Vec3(mesh.points.row(mesh.triangles(f, 0)))
                  .dot(Vec3(mesh.points.row(mesh.triangles(f, 1))).cross(Vec3(mesh.points.row(mesh.triangles(f, 2))))) /
              6;
  return made->topology->closed() && std::abs(volume - 0.5) < 1e-12;
}

}  // namespace

TEST_CASE("of tetrahedra in VTU the outside is taken with its values and a warning") {
  const ElementFolder folder;
  const MeshFile mesh = test::must(folder.read("a.vtu", vtu_of_tetrahedra()));
  CHECK(is_outside_of_two(mesh));
  REQUIRE(mesh.doubt_mm);
  CHECK((*mesh.doubt_mm)[4] == 4);
  REQUIRE(mesh.warnings.size() == 1);
  CHECK(mesh.warnings[0].find("2 tetrahedra; their outside is taken, 5 of 6 points") != std::string::npos);
  CHECK(says(folder.read("b.vtu", vtu_of_tetrahedra("12")), "hexahedra"));
  CHECK(says(folder.read("b.vtu", vtu_of_tetrahedra("24")), "curved elements"));
  CHECK(says(folder.read("b.vtu", vtu_of_tetrahedra("5")), "wrong number of corners"));
  CHECK(says(folder.read("b.vtu", vtu_of_tetrahedra("10", "0 1 2 3 1 3 2 6")), "point 6 of 6"));
  CHECK(says(folder.read("b.vtu", vtu_of_tetrahedra("10", "0 1 2 3 1 3 2")), "another number of elements"));
  CHECK(says(folder.read("b.vtp", vtu_of_tetrahedra()), "PolyData"));
}

TEST_CASE("an empty piece of VTK's XML formats is passed over") {
  const ElementFolder folder;
  const std::string empty =
      "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\" NumberOfPolys=\"0\"><Points></Points></Piece>";
  CHECK(is_outside_of_two(test::must(folder.read("a.vtu", replaced(vtu_of_tetrahedra(), "<Piece", empty + "<Piece")))));
  CHECK(is_outside_of_two(
      test::must(folder.read("b.vtu", replaced(vtu_of_tetrahedra(), "</Piece>", "</Piece>" + empty)))));
  CHECK(says(folder.read("c.vtu", replaced(vtu_of_tetrahedra(), "NumberOfPoints=\"6\"", "")),
             "another number of points"));
  REQUIRE(write_mesh_file(test::must(folder.read("a.gii", gifti_text())), folder.path / "whole.vtp"));
  const std::string vtp = read_whole_file(folder.path / "whole.vtp").value();
  CHECK(is_octahedron(test::must(folder.read("d.vtp", replaced(vtp, "<Piece", empty + "<Piece")))));
}

TEST_CASE("a tetrahedron that is listed twice counts once") {
  const ElementFolder folder;
  const MeshFile one = test::must(folder.read("a.vtu", vtu_of_tetrahedra("10", "0 1 2 3 3 0 1 2")));
  CHECK(one.points.rows() == 4);
  CHECK(one.triangles.rows() == 4);
  REQUIRE(one.warnings.size() == 2);
  CHECK(one.warnings[0].find("1 of 2 tetrahedra again") != std::string::npos);
  CHECK(one.warnings[1].find("1 tetrahedra; their outside") != std::string::npos);
}

TEST_CASE("a tetrahedron that names a point twice is told where the surface is not sound") {
  const ElementFolder folder;
  const MeshFile read = test::must(folder.read("a.vtu", vtu_of_tetrahedra("10", "0 1 2 3 0 0 1 2")));
  CHECK(says(sound_mesh(read), "(it has 1 of 2 tetrahedra that name a point twice, so that they are flat"));
  CHECK(sound_mesh(test::must(folder.read("b.vtu", vtu_of_tetrahedra()))).has_value());
}

TEST_CASE("of a VTU with several time steps the first is taken and pieces with points at one place are named") {
  const ElementFolder folder;
  const std::string one = vtu_of_tetrahedra();
  const std::size_t begin = one.find("<Piece"), end = one.find("</UnstructuredGrid>");
  const std::string piece = one.substr(begin, end - begin);
  const auto pieces = [&](const std::string& grid, const std::string& first, const std::string& second) {
    return replaced(one.substr(0, begin), "<UnstructuredGrid>", grid) + first + second + one.substr(end);
  };
  const auto of_step = [&](const std::string& step) {
    return replaced(piece, "<DataArray type=\"Float32\" ", "<DataArray type=\"Float32\" TimeStep=\"" + step + "\" ");
  };
  // As VTK writes steps in text, and else: as arrays of one piece.
  const std::string steps = "<UnstructuredGrid TimeValues=\"\n0   \n1   \n\">";
  for (const std::string& second : {of_step("1"), std::string()}) {
    const MeshFile first = test::must(folder.read("a.vtu", pieces(steps, of_step("0"), second)));
    CHECK(is_outside_of_two(first));
    REQUIRE(first.warnings.size() == 2);
    CHECK(first.warnings[0].find("has 2 time steps, of which the first is taken") == 0);
  }
  const MeshFile both = test::must(folder.read("b.vtu", pieces("<UnstructuredGrid>", piece, piece)));
  REQUIRE(both.warnings.size() == 2);
  CHECK(both.warnings[0].find("is written in 2 pieces that each have points of their own, 6 of them at the places of "
                              "others, which are not joined") == 0);
  CHECK(both.likely_cause.find(" (it is written in 2 pieces") == 0);
}

TEST_CASE("a surface in VTU may have triangles and quads and strips and pixels") {
  const ElementFolder folder;
  const auto square = [&](const std::string& corners, const std::string& ends, const std::string& kinds, int cells) {
    return test::must(folder.read(
        "a.vtu", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"" +
                     std::to_string(cells) +
                     "\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 "
                     "0 0 1 0</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" "
                     "format=\"ascii\">" +
                     corners + "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">" + ends +
                     "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">" + kinds +
                     "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"));
  };
  for (const MeshFile& mesh : {square("0 1 2 0 2 3", "3 6", "5 5", 2), square("0 1 2 3", "4", "9", 1),
                               square("0 1 3 2", "4", "6", 1), square("0 1 3 2", "4", "8", 1)}) {
    REQUIRE(mesh.triangles.rows() == 2);
    for (Eigen::Index f = 0; f < 2; ++f) {
      const auto at = [&](int k) { return Vec3(mesh.points.row(mesh.triangles(f, k))); };
      CHECK((at(1) - at(0)).cross(at(2) - at(0)).isApprox(Vec3(0, 0, 1)));
    }
  }
}

namespace {

const std::array<double, 15> two_tetrahedra{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};

/// Versions 2.2 and 4.1 of the two tetrahedra, with nodes whose names have gaps, as Gmsh 4.11 writes them.
const char* const msh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 7 \"cortex\"\n$EndPhysicalNames\n$Nodes\n5\n"
    "1 0 0 0\n2 1 0 0\n4 0 1 0\n7 0 0 1\n9 1 1 1\n$EndNodes\n$Elements\n4\n1 15 2 0 1 1\n2 1 2 0 1 1 2\n"
    "3 4 2 7 1 1 2 4 7\n4 4 2 7 1 2 7 4 9\n$EndElements\n$NodeData\n1\n\"doubt_mm\"\n1\n0\n3\n0\n1\n5\n1 0.5\n2 1\n"
    "4 2\n7 3\n9 4\n$EndNodeData\n";
const char* const msh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n2 5 1 9\n"
    "2 1 1 2\n1\n2\n0 0 0 0.5 0.5\n1 0 0 0.5 0.5\n3 1 0 3\n4\n7\n9\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n2 3 1 "
    "3\n"
    "1 1 1 1\n1 1 2\n3 1 4 2\n2 1 2 4 7\n3 2 7 4 9\n$EndElements\n";
const char* const msh40 =
    "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n1 5\n1 3 0 5\n1 0 0 0\n2 1 0 0\n4 0 1 0\n7 0 0 1\n9 1 1 1\n$EndNodes\n"
    "$Elements\n1 2\n1 3 4 2\n1 1 2 4 7\n2 2 7 4 9\n$EndElements\n";

std::string binary_msh2() {
  std::string bytes = "$MeshFormat\n2.2 1 8\n" + raw<std::int32_t>({1}) + "\n$EndMeshFormat\n$Nodes\n5\n";
  for (std::int32_t i = 0; i < 5; ++i) {
    const auto* x = two_tetrahedra.data() + 3 * i;
    bytes += raw<std::int32_t>({i + 1}) + raw<double>({x[0], x[1], x[2]});
  }
  return bytes + "\n$EndNodes\n$Elements\n2\n" +
         raw<std::int32_t>({4, 2, 2, 1, 7, 1, 1, 2, 3, 4, 2, 7, 1, 2, 4, 3, 5}) + "\n$EndElements\n";
}

std::string binary_msh4() {
  return "$MeshFormat\n4.1 1 8\n" + raw<std::int32_t>({1}) + "\n$EndMeshFormat\n$Nodes\n" +
         raw<std::int64_t>({1, 5, 1, 5}) + raw<std::int32_t>({3, 1, 0}) + raw<std::int64_t>({5, 1, 2, 3, 4, 5}) +
         raw(std::vector<double>(two_tetrahedra.begin(), two_tetrahedra.end())) + "\n$EndNodes\n$Elements\n" +
         raw<std::int64_t>({1, 2, 1, 2}) + raw<std::int32_t>({3, 1, 4}) +
         raw<std::int64_t>({2, 1, 1, 2, 3, 4, 2, 2, 4, 3, 5}) + "\n$EndElements\n";
}

}  // namespace

TEST_CASE("Gmsh files of versions 2 and 4 are read in text and binary") {
  const ElementFolder folder;
  for (const std::string& bytes :
       {std::string(msh2), std::string(msh4), std::string(msh40), binary_msh2(), binary_msh4()})
    CHECK_MESSAGE(is_outside_of_two(test::must(folder.read("a.msh", bytes))), bytes.substr(0, 20));
  const MeshFile mesh = test::must(folder.read("a.msh", msh2));
  REQUIRE(mesh.doubt_mm);
  CHECK((*mesh.doubt_mm)[4] == 4);
}

TEST_CASE("of an element of two groups of Gmsh the outside stays whole") {
  const ElementFolder folder;
  const std::string grouped =
      replaced(replaced(msh2, "$Elements\n4\n", "$Elements\n5\n"), "$EndElements", "5 4 2 8 1 2 7 4 9\n$EndElements");
  const MeshFile mesh = test::must(folder.read("a.msh", grouped));
  CHECK(is_outside_of_two(mesh));
  CHECK(mesh.warnings.size() == 2);
}

TEST_CASE("values of nodes are read as Gmsh does and left out where they cannot be read") {
  const ElementFolder folder;
  const auto read = [&](const std::string& what, const std::string& by) {
    return test::must(folder.read("a.msh", replaced(msh2, what, by)));
  };
  const std::string tags = "1\n\"doubt_mm\"\n1\n0\n3\n0\n1\n5\n";
  for (const char* other : {"1\n\"doubt_mm\"\n1\n0\n3\n0 1 5\n", "1\n\"doubt_mm\"\n1 0.5\n4 0 1 5 0\n"}) {
    const MeshFile mesh = read(tags, other);
    REQUIRE(mesh.doubt_mm);
    CHECK((*mesh.doubt_mm)[3] == 3);
  }
  for (const char* other : {"1\n\"doubt_mm\"\n1\nx\n3\n0\n1\n5\n", "1\n\"doubt_mm\"\n0\n2\n0\n1\n",
                            "1\n\"doubt_mm\"\n0\n3\n0\n12\n5\n", "1\n\"doubt_mm\"\n0\n3\n0\n1\n9\n"}) {
    const MeshFile mesh = read(tags, other);
    CHECK(is_outside_of_two(mesh));
    CHECK(!mesh.doubt_mm);
  }
  for (const char* damaged : {"7 3\n9 x\n", "7 3\n", "7 3\n9 nan\n"}) {
    CAPTURE(damaged);
    const MeshFile mesh = read("7 3\n9 4\n", damaged);
    CHECK(!mesh.doubt_mm);
    CHECK(std::ranges::any_of(mesh.warnings, [](const std::string& warning) {
      return warning.find("values \"doubt_mm\" are cut short or damaged") != std::string::npos;
    }));
  }
  CHECK(says(folder.read("a.msh", replaced(msh2, "$EndNodeData\n", "")), "truncated"));
}

TEST_CASE("Gmsh files that are wrong are refused by a sentence") {
  const ElementFolder folder;
  const std::string whole = msh2, values = whole.substr(whole.find("$NodeData"));
  CHECK(says(folder.read("a.msh", replaced(whole, "$Nodes", values + "$Nodes")), "order that is not Gmsh's"));
  CHECK(says(folder.read("a.msh", replaced(whole, "2.2 0 8", "1.0 0 8")), "version 1.0"));
  CHECK(says(folder.read("a.msh", replaced(whole, "3 4 2 7 1 1 2 4 7", "3 5 2 7 1 1 2 4 7 1 2 4 7")), "hexahedra"));
  CHECK(says(folder.read("a.msh", replaced(whole, "3 4 2 7 1 1 2 4 7", "3 11 2 7 1 1 2 4 7")), "curved elements"));
  CHECK(says(folder.read("a.msh", replaced(whole, "2 7 4 9\n", "2 7 4 8\n")), "node 8, which it lacks"));
  CHECK(says(folder.read("a.msh", replaced(whole, "9 1 1 1\n", "9 1 1 nan\n")), "no finite number"));
  CHECK(says(folder.read("a.msh", replaced(whole, "9 1 1 1\n", "7 1 1 1\n")), "node 7 twice"));
  CHECK(says(folder.read("a.msh", replaced(whole, "$Nodes\n5\n", "$Nodes\n5000000000000\n")), "truncated"));
  CHECK(says(folder.read("a.msh", replaced(whole, "$Nodes\n5\n", "$Nodes\n4\n")), "truncated"));
  CHECK(says(folder.read("a.msh", replaced(msh4, "2 5 1 9", "2 6 1 9")), "another number of nodes"));
  for (const std::string& bytes : {std::string(msh4), binary_msh2(), binary_msh4()})
    for (std::size_t length = 30; length + 14 < bytes.size(); length += 7)
      CHECK(!folder.read("cut.msh", bytes.substr(0, length)));
}
