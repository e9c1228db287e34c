#include "core/mesh/mesh_io.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/text/listed.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/formats/formats.h"
#include "core/volume/formats/formats.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/volume_io.h"
#include "tests/docs_page.h"
#include "tests/real_data.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;

namespace {

struct MeshFolder : TemporaryFolder {
  fs::path put(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return path / name;
  }
  Result<MeshFile> read(const std::string& name, const std::string& bytes) const {
    return read_mesh_file(put(name, bytes));
  }
  std::string refusal(const std::string& name, const std::string& bytes) const {
    const auto read_back = read(name, bytes);
    return read_back ? "" : read_back.error().sentence();
  }
};

MeshFile sphere_file() {
  const Mesh mesh = icosphere(1, 50.123456789012345, {-1.0 / 3, 1e-7, 200});
  MeshFile file;
  file.points = mesh.points;
  file.triangles = mesh.topology->triangles();
  return file;
}

MeshFile template_file() {
  MeshFile file = sphere_file();
  file.stiffness = std::make_shared<const VertexScalars>(
      VertexScalars::LinSpaced(file.points.rows(), 0.5, 4.5).cast<float>().cast<double>());
  file.stiffness_base = 12.5;
  file.doubt_mm = VertexScalars::LinSpaced(file.points.rows(), 0.25, 3).cast<float>().cast<double>();
  file.landmarks = {{"superior pole", {1.0 / 3, -2, 3}}, {"Hilus „ü“ \"x\"", {0, 0, 1e-9}}};
  file.comments = {"made by hand", "  two  spaces "};
  return file;
}

bool same_shape(const MeshFile& a, const MeshFile& b) {
  return a.points.rows() == b.points.rows() && a.points == b.points && a.triangles.rows() == b.triangles.rows() &&
         a.triangles == b.triangles;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

template <class T>
void put_number(std::string& bytes, T value, bool big_endian = false) {
  char copy[sizeof(T)];
  std::memcpy(copy, &value, sizeof(T));
  if (big_endian == (std::endian::native == std::endian::little)) std::reverse(copy, copy + sizeof(T));
  bytes.append(copy, sizeof(T));
}

std::string base64(const std::string& bytes) {
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

/// Four points and two faces, so that counts differ; the numbers of every hand-written file below.
void check_square(const Result<MeshFile>& mesh) {
  REQUIRE_MESSAGE(mesh, mesh.error().sentence());
  MeshFile square;
  square.points.resize(4, 3);
  square.points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5;
  Triangles& faces = square.triangles.edit();
  faces.resize(2, 3);
  faces << 0, 1, 2, 0, 2, 3;
  CHECK(same_shape(*mesh, square));
}

const std::vector<double> square_coordinates{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5};

}  // namespace

namespace {

const char* yes_if(bool kept) {
  return kept ? " yes |" : " |";
}

/// What a format that is written keeps, found by writing and reading.
std::string row_of_kept(const VolumeFormat& format, const std::string& ending, const TemporaryFolder& folder) {
  Volume cine;
  cine.geometry.dims = {3, 2, 2};
  cine.geometry.origin_mm = {-1 / 3.0, 2, 1e4 / 7};
  cine.frames = 2;
  cine.data = std::vector<float>(24, 0.25f);
  cine.range_min = cine.range_max = 0.25;
  const fs::path path = folder.path / ("cine" + ending), mapped = folder.path / ("map" + ending);
  REQUIRE(write_volume(cine, path));
  const VolumeRead back = test::must(read_volume(path));
  VolumeRead map;
  map.volume.geometry = cine.geometry;
  map.volume.data = std::vector<std::uint8_t>{0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0};
  map.volume.range_max = 1;
  map.segmentation.add({.name = "spleen", .value = 1, .layer = 0, .colour = {{1, 2, 3}}});
  REQUIRE(write_segmentation(map, mapped));
  const VolumeRead again = test::must(read_volume(mapped));
  const Segment* spleen = again.segmentation.find(1);
  map.other_layers.push_back(map.volume);
  map.segmentation.add({.name = "liver", .value = 1, .layer = 1});
  const bool layers = write_segmentation(map, folder.path / ("layers" + ending)).has_value();
  return "| " + format.name + " `" + ending + "` |" + yes_if(back.volume.frames == 2) +
         yes_if(back.volume.data == cine.data) +
         yes_if(spleen && spleen->name == "spleen" && spleen->colour == std::array<std::uint8_t, 3>{1, 2, 3}) +
         yes_if(layers) + yes_if(same_grid(back.volume.geometry, cine.geometry)) + "\n";
}

std::string row_of_kept(const MeshFormat& format, const TemporaryFolder& folder) {
  MeshFile file = template_file();
  file.regions.list = {{"pole", 2, {1, 2, 3}}};
  file.regions.of_vertex.assign(static_cast<std::size_t>(file.points.rows()), 1);
  const fs::path path = folder.path / (std::string("kept") + format.extension);
  REQUIRE(write_mesh_file(file, path));
  const MeshFile back = test::must(read_mesh_file(path));
  const bool same_order =
      back.points.rows() == file.points.rows() && (back.points - file.points).cwiseAbs().maxCoeff() < 1e-3;
  return std::string("| ") + format.name + " |" + yes_if(same_order) +
         yes_if(back.triangles.rows() == file.triangles.rows()) + yes_if(back.stiffness != nullptr) +
         yes_if(back.doubt_mm.has_value()) + yes_if(back.regions == file.regions) +
         yes_if(back.landmarks.size() == file.landmarks.size()) + yes_if(back.comments == file.comments) + "\n";
}

}  // namespace

TEST_CASE("the tables of formats in the docs are made from the formats") {
  const MeshFolder folder;
  const auto cell = [](const std::string& text) { return text.empty() ? std::string(" |") : " " + text + " |"; };
  const auto code = [](std::vector<std::string> endings) {
    for (std::string& ending : endings) ending = "`" + ending + "`";
    return listed(endings, ", ");
  };
  std::string volumes = "| images | names read | names written | |\n|---|---|---|---|\n";
  for (const VolumeFormat* format : volume_formats)
    volumes += "|" + cell(format->name) + cell(code(format->endings)) + cell(code(format->written)) +
               cell(format->note) + "\n";
  std::string meshes = "| meshes | names read and written | |\n|---|---|---|\n";
  for (const MeshFormat* format : mesh_formats)
    meshes += "|" + cell(format->name) + cell(code({format->extension})) + cell(format->note) + "\n";
  std::string of_images =
      "| of images stays | frames | real values | names and colours | layers | place to a hundredth of a voxel |\n"
      "|---|---|---|---|---|---|\n";
  for (const VolumeFormat* format : volume_formats)
    for (const std::string& ending : format->written) of_images += row_of_kept(*format, ending, folder);
  of_images += row_of_kept(formats::nrrd, ".seg.nrrd", folder);
  std::string of_meshes =
      "| of meshes stays | order of vertices | faces | stiffness | doubt | regions | landmarks | comments |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (const MeshFormat* format : mesh_formats) of_meshes += row_of_kept(*format, folder);
  test::DocsPage page("formats.md");
  page.has_table(volumes);
  page.has_table(of_images);
  page.has_table(meshes);
  page.has_table(of_meshes);
  page.check();
}

TEST_CASE("every mesh format reads what it writes") {
  MeshFolder folder;
  const MeshFile file = sphere_file();
  for (const MeshFormat* format : mesh_formats) {
    CAPTURE(std::string(format->name));
    const fs::path path = folder.path / (std::string("a") + format->extension);
    CHECK(is_mesh_name(path));
    REQUIRE(write_mesh_file(file, path));
    const auto back = read_mesh_file(path);
    REQUIRE_MESSAGE(back, back.error().sentence());
    REQUIRE(back->points.rows() == file.points.rows());
    CHECK(back->triangles.rows() == (format->has_faces ? file.triangles.rows() : 0));
    if (format->keeps_numbers) CHECK((back->points - file.points).cwiseAbs().maxCoeff() < 1e-3);
    if (format->keeps_numbers && format->has_faces) CHECK(back->triangles == file.triangles);
  }
}

TEST_CASE("the endings of all formats of meshes and of images are cut off a name") {
  std::vector<std::string> endings = mesh_format_extensions();
  for (const auto which : {&VolumeFormat::endings, &VolumeFormat::written})
    for (const std::string& ending : volume_format_endings(which)) endings.push_back(ending);
  for (const std::string& ending : endings) CHECK_MESSAGE(file_stem("sub.01" + ending) == "sub.01", ending);
}

TEST_CASE("formats that hold doubles give back the same points and faces to the last bit") {
  MeshFolder folder;
  const MeshFile file = sphere_file();
  for (const MeshFormat* format : mesh_formats) {
    if (format == &formats::stl || format == &formats::gifti) continue;  // they hold single precision
    CAPTURE(std::string(format->name));
    const fs::path path = folder.path / (std::string("a") + format->extension);
    REQUIRE(write_mesh_file(file, path));
    const auto back = read_mesh_file(path);
    REQUIRE_MESSAGE(back, back.error().sentence());
    CHECK(back->points == file.points);
    if (format->has_faces)
      CHECK(same_shape(*back, file));
    else
      CHECK(back->triangles.rows() == 0);
    CHECK(back->warnings.empty());
  }
}

TEST_CASE("a template keeps stiffness doubt landmarks and comments in PLY") {
  MeshFolder folder;
  const MeshFile file = template_file();
  REQUIRE(write_mesh_file(file, folder.path / "t.ply"));
  const auto back = read_mesh_file(folder.path / "t.ply").value();
  CHECK(same_shape(back, file));
  REQUIRE(back.doubt_mm);
  CHECK(*back.doubt_mm == *file.doubt_mm);
  REQUIRE(back.stiffness);
  CHECK(*back.stiffness == *file.stiffness);
  CHECK(back.stiffness_base == file.stiffness_base);
  CHECK(back.landmarks == file.landmarks);
  CHECK(back.comments == file.comments);
  CHECK(back.warnings.empty());
}

TEST_CASE("STL gives back one vertex a place and the same faces") {
  MeshFolder folder;
  const MeshFile file = sphere_file();
  REQUIRE(write_mesh_file(file, folder.path / "a.stl"));
  const Mesh back = read_mesh(folder.path / "a.stl").value();
  REQUIRE(back.points.rows() == file.points.rows());
  REQUIRE(back.topology->closed());
  for (Eigen::Index f = 0; f < file.triangles.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      CHECK(back.points.row(back.topology->triangles()(f, k)) ==
            file.points.row(file.triangles(f, k)).cast<float>().cast<double>());
}

TEST_CASE("every truncation of a written mesh is refused or warned of or changes nothing") {
  MeshFolder folder;
  for (const MeshFormat* format : mesh_formats) {
    CAPTURE(std::string(format->name));
    const fs::path path = folder.path / (std::string("a") + format->extension);
    const MeshFile file = format->keeps_template ? template_file() : sphere_file();
    REQUIRE(write_mesh_file(file, path));
    const auto whole = read_mesh_file(path).value();
    const std::string bytes = read_whole_file(path).value();
    for (std::size_t length = 0; length < bytes.size(); length += 1 + length % 17) {
      CAPTURE(length);
      const auto read = folder.read(std::string("cut") + format->extension, bytes.substr(0, length));
      if (!read) {
        CHECK(contains(read.error().sentence(), "cut."));
        continue;
      }
      // A list of points without a count can lose whole lines unseen.
      const bool uncounted = format == &formats::particles && bytes[length - 1] == '\n';
      CHECK((uncounted || same_shape(*read, whole) || !read->warnings.empty()));
    }
  }
}

TEST_CASE("ASCII files cut within their last number are warned of") {
  MeshFolder folder;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 13\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  std::string points;
  for (int i = 0; i < 13; ++i) points += std::to_string(i) + " 0 0\n";
  CHECK(folder.read("a.ply", ply + points + "3 0 1 12\n").value().warnings.empty());
  CHECK(folder.read("a.ply", ply + points + "3 0 1 1").value().warnings.size() == 1);
}

TEST_CASE("binary PLY of both byte orders is read with foreign properties and elements and polygons") {
  MeshFolder folder;
  for (const bool big : {false, true}) {
    std::string bytes =
        std::string("ply\r\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
        " 1.0\r\ncomment by hand\r\nobj_info foreign\r\nelement vertex 4\r\nproperty uchar red\r\n"
        "property float x\r\nproperty double y\r\nproperty list uchar short bones\r\nproperty float z\r\n"
        "element edge 1\r\nproperty int vertex1\r\nproperty int vertex2\r\nelement face 1\r\n"
        "property uchar flag\r\nproperty list ushort uint vertex_index\r\nend_header\r\n";
    for (std::size_t i = 0; i < 4; ++i) {
      bytes += '\x7f';
      put_number(bytes, static_cast<float>(square_coordinates[3 * i]), big);
      put_number(bytes, square_coordinates[3 * i + 1], big);
      put_number(bytes, static_cast<std::uint8_t>(i), big);
      for (std::size_t k = 0; k < i; ++k) put_number(bytes, std::int16_t{-5}, big);
      put_number(bytes, static_cast<float>(square_coordinates[3 * i + 2]), big);
    }
    put_number(bytes, std::int64_t{0}, big);
    bytes += '\1';
    put_number(bytes, std::uint16_t{4}, big);
    for (std::uint32_t v = 0; v < 4; ++v) put_number(bytes, v, big);
    const auto mesh = folder.read("a.ply", bytes);
    check_square(mesh);
    CHECK(mesh->comments == std::vector<std::string>{"by hand"});
    CHECK(folder.read("a.ply", bytes + "surplus").value().warnings.size() == 1);
  }
}

TEST_CASE("legacy VTK is read in its old and new forms and in ASCII and binary") {
  MeshFolder folder;
  const std::string points = "POINTS 4 float\n0 0 0 1 0 0\n1 1 0 0 1 0.5\n";
  check_square(folder.read("a.vtk",
                           "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nFIELD FieldData 1\n"
                           "SPACE 1 1 string\nLPS\n" +
                               points +
                               "VERTICES 1 2\n1 0\nPOLYGONS 1 5\n4 0 1 2 3\n\nPOINT_DATA 4\nSCALARS a float\n"));
  check_square(folder.read("a.vtk", "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET POLYDATA\n" + points +
                                        "METADATA\nINFORMATION 0\n\nPOLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6 \n"
                                        "CONNECTIVITY vtktypeint64\n0 1 2 0 2 3 \n"));
  const auto strip = folder.read("a.vtk", "# vtk DataFile Version 2.0\ntitle\nASCII\nDATASET POLYDATA\n" + points +
                                              "TRIANGLE_STRIPS 1 5\n4 1 2 0 3\n");
  REQUIRE(strip);
  Triangles triangles(2, 3);
  triangles << 1, 2, 0, 0, 2, 3;
  CHECK(strip->triangles == triangles);

  std::string binary =
      "# vtk DataFile Version 5.1\ntitle\nBINARY\nDATASET POLYDATA\nFIELD FieldData 2\nTime 1 1 double\n";
  put_number(binary, 0.5, true);
  binary += "\nSPACE 1 1 string\n\xc3LPS\nPOINTS 4 double\n";
  for (const double x : square_coordinates) put_number(binary, x, true);
  binary += "\nMETADATA\nINFORMATION 0\n\nPOLYGONS 3 6\nOFFSETS vtktypeint64\n";
  for (const std::int64_t x : {0, 3, 6}) put_number(binary, x, true);
  binary += "\nCONNECTIVITY vtktypeint64\n";
  for (const std::int64_t x : {0, 1, 2, 0, 2, 3}) put_number(binary, x, true);
  check_square(folder.read("a.vtk", binary + "\n"));
}

TEST_CASE("VTP is read as ASCII and base64 and appended and compressed") {
  MeshFolder folder;
  std::string xyz, corners, ends;
  for (const double x : square_coordinates) put_number(xyz, static_cast<float>(x));
  for (const std::int64_t x : {0, 1, 2, 0, 2, 3}) put_number(corners, x);
  for (const std::int32_t x : {3, 6}) put_number(ends, x);
  const auto file = [](const std::string& attributes, const std::array<std::string, 3>& arrays,
                       const std::string& rest) {
    return "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\" " + attributes +
           "><PolyData><Piece NumberOfPoints=\"4\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
           "NumberOfPolys=\"2\"><PointData/><Points><DataArray type=\"Float32\" Name=\"Points\" "
           "NumberOfComponents=\"3\" " +
           arrays[0] + "</DataArray></Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" " + arrays[1] +
           "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" " + arrays[2] +
           "</DataArray></Polys></Piece></PolyData>" + rest + "</VTKFile>\n";
  };
  const auto sized = [](const std::string& bytes) {
    std::string header;
    put_number(header, static_cast<std::uint32_t>(bytes.size()));
    return header + bytes;
  };
  const std::string ascii = "format=\"ascii\">", inlined = "format=\"binary\">\n ";
  check_square(
      folder.read("a.vtp", file("", {ascii + "0 0 0 1 0 0 1 1 0 0 1 .5", ascii + "0 1 2 0 2 3", ascii + "3 6"}, "")));
  check_square(folder.read(
      "a.vtp",
      file("", {inlined + base64(sized(xyz)), inlined + base64(sized(corners)) + "\n", inlined + base64(sized(ends))},
           "")));

  const auto at = [](std::size_t offset) { return "format=\"appended\" offset=\"" + std::to_string(offset) + "\">"; };
  const std::string raw = sized(xyz) + sized(corners) + sized(ends);
  check_square(folder.read("a.vtp", file("header_type=\"UInt32\"", {at(0), at(52), at(104)},
                                         "<AppendedData encoding=\"raw\">\n _" + raw + "\n</AppendedData>")));

  const auto compressed = [](const std::string& bytes, std::size_t block) {
    std::string header, data;
    const std::size_t blocks = (bytes.size() + block - 1) / block;
    for (const std::size_t x : {blocks, block, bytes.size() % block}) put_number(header, static_cast<std::uint64_t>(x));
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::string part = bytes.substr(b * block, block);
      std::string packed(compressBound(part.size()), '\0');
      uLongf size = packed.size();
      compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(part.data()),
               part.size());
      put_number(header, static_cast<std::uint64_t>(size));
      data += packed.substr(0, size);
    }
    return base64(header) + base64(data);
  };
  const std::string a = compressed(xyz, 16), b = compressed(corners, 20), c = compressed(ends, 100);
  check_square(folder.read("a.vtp", file("header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"",
                                         {at(0), at(a.size()), at(a.size() + b.size())},
                                         "<AppendedData encoding=\"base64\">_" + a + b + c + "</AppendedData>")));
  CHECK(contains(folder.refusal("a.vtp", file("compressor=\"vtkLZ4DataCompressor\"", {ascii, ascii, ascii}, "")),
                 "zlib"));
}

TEST_CASE("VTP pieces that name one array again and again do not fill the memory") {
  MeshFolder folder;
  std::string numbers;
  for (int k = 0; k < 3000; ++k) put_number(numbers, static_cast<double>(k));
  std::string data;
  put_number(data, static_cast<std::uint32_t>(numbers.size()));
  const auto file = [&](int pieces, std::size_t step) {
    std::string text = R"(<VTKFile type="PolyData" byte_order="LittleEndian"><PolyData>)";
    for (int k = 0; k < pieces; ++k)
      text += R"(<Piece NumberOfPoints="1000"><Points><DataArray type="Float64" format="appended" offset=")" +
              std::to_string(static_cast<std::size_t>(k) * step) + "\"/></Points></Piece>";
    text += R"(</PolyData><AppendedData encoding="raw">_)";
    for (int k = 0; k < 2; ++k) text += data + numbers;
    return text + "</AppendedData></VTKFile>";
  };
  CHECK(contains(folder.refusal("a.vtp", file(2, data.size() + numbers.size())), "holds no faces"));
  CHECK(contains(folder.refusal("a.vtp", file(100, 0)), "lie in one another"));
}

TEST_CASE("VTP that unpacks to far more than a mesh is refused before the memory is taken") {
  MeshFolder folder;
  const std::string zeros(80000000, '\0');
  std::string packed(compressBound(zeros.size()), '\0');
  uLongf size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(zeros.data()), zeros.size());
  std::string data;
  for (const std::size_t x : {std::size_t{1}, zeros.size(), zeros.size(), std::size_t{size}})
    put_number(data, static_cast<std::uint64_t>(x));
  data += packed.substr(0, size);
  CHECK(contains(
      folder.refusal("a.vtp", R"(<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt64" )"
                              R"(compressor="vtkZLibDataCompressor"><PolyData><Piece NumberOfPoints="3333333">)"
                              R"(<Points><DataArray type="Float64" format="appended" offset="0"/></Points>)"
                              R"(</Piece></PolyData><AppendedData encoding="raw">_)" +
                                  data + "</AppendedData></VTKFile>"),
      "unpacks to far more"));
}

TEST_CASE("OBJ is read with slashes and negative indices and polygons") {
  MeshFolder folder;
  const std::string points = "# by hand\nv 0 0 0\nv 1 0 0 1.0\r\nv 1 1 0\nv 0 1 .5\nvt 0 0\nvn 0 0 1\no part\n";
  check_square(folder.read("a.obj", points + "f 1 2 3\nf 1/1 3/1/1 4//1\n"));
  check_square(folder.read("a.OBJ", points + "f -4 -3 -2 -1\n"));
  CHECK(contains(folder.refusal("a.obj", points + "f 1 2 5\n"), "vertex 4 of 4"));
  CHECK(contains(folder.refusal("a.obj", points + "f 1 2 0\n"), "unreadable corner"));
}

TEST_CASE("ASCII STL is merged and its degenerate facets are left out with a warning") {
  MeshFolder folder;
  const auto facet = [](const std::string& a, const std::string& b, const std::string& c) {
    return "facet normal 0 0 1\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c + "\nendloop\nendfacet\n";
  };
  const std::string stl = "solid hand\n" + facet("0 0 0", "1 0 0", "1 1 0") + facet("-0 0 0", "1 1 0", "0 1 0.5") +
                          facet("0 0 0", "0 0 0", "1 1 0") + "endsolid hand\n";
  const auto mesh = folder.read("a.stl", stl);
  check_square(mesh);
  CHECK(mesh->warnings.size() == 1);
  CHECK(contains(folder.refusal("a.stl", stl.substr(0, stl.size() - 15)), "truncated"));
}

TEST_CASE("a mesh in RAS is flipped on reading in every format that can say so") {
  MeshFolder folder;
  const MeshFile file = template_file();
  for (const MeshFormat* format : mesh_formats) {
    const bool has_its_own = format == &formats::gifti || format == &formats::mni_obj;
    if (format == &formats::particles || has_its_own) continue;  // they cannot say so
    CAPTURE(std::string(format->name));
    const fs::path path = folder.path / (std::string("a") + format->extension);
    REQUIRE(write_mesh_file(file, path));
    const auto lps = read_mesh_file(path).value();
    std::string bytes = read_whole_file(path).value();
    const bool codes = format == &formats::vtp || format == &formats::vtu;
    const std::string tag = codes ? "76 80 83" : "SPACE=LPS";
    REQUIRE(contains(bytes, tag));
    bytes.replace(bytes.find(tag), tag.size(), codes ? "82 65 83" : "SPACE=RAS");
    auto ras = folder.read(std::string("b") + format->extension, bytes).value();
    ras.points.leftCols<2>() *= -1;
    CHECK(ras.points == lps.points);
    for (std::size_t i = 0; i < lps.landmarks.size(); ++i)
      CHECK(ras.landmarks[i].position.x() == -lps.landmarks[i].position.x());
    CHECK(ras.comments == lps.comments);
  }
}

TEST_CASE("files that are wrong are refused by a sentence with their name") {
  MeshFolder folder;
  const std::string head = "ply\nformat ascii 1.0\n";
  const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string ply = head + vertices + faces;
  CHECK(folder.refusal("a.ply", ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").empty());
  CHECK(contains(folder.refusal("a.ply", ply + "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n"), "vertex 1 has a coordinate"));
  CHECK(contains(folder.refusal("a.ply", ply + "0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n"), "no finite number"));
  CHECK(contains(folder.refusal("a.ply", ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "vertex 3 of 3"));
  CHECK(contains(folder.refusal("a.ply", ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), "vertex -1"));
  CHECK(contains(folder.refusal("a.ply", ply + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n"), "2 corners"));
  CHECK(contains(folder.refusal("a.ply", ply + "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n"), "no number"));
  CHECK(contains(folder.refusal("a.ply", head + vertices + "end_header\n0 0 0\n1 0 0\n0 1 0\n"), "no faces"));
  CHECK(contains(folder.refusal("a.ply", head +
                                             "element vertex 4000000000000\nproperty float x\nproperty float y\n"
                                             "property float z\n" +
                                             faces + "0 0 0\n"),
                 "too short"));
  CHECK(contains(folder.refusal("a.ply", "version https://git-lfs.github.com/spec/v1\n"), "not a PLY file"));
  CHECK(contains(folder.refusal("a.vtk", "ply\n"), "not a legacy VTK file"));
  CHECK(contains(
      folder.refusal("a.vtk",
                     "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 999999999999999999 float\n0"),
      "a.vtk"));
  CHECK(contains(folder.refusal("a.stl", std::string(84, '\xff')), "announces"));
  CHECK(contains(folder.refusal("a.vtp", "<VTKFile type=\"ImageData\"></VTKFile>"), "no surface"));
  CHECK(contains(folder.refusal("a.particles", "1 2 3\n1 2\n"), "x y z"));
  CHECK(contains(folder.refusal("a.ply", ""), "is empty"));
  CHECK(contains(folder.refusal("a.png", "x"), "use .ply"));
  for (const char* absent : {"absent.ply", "absent", "absent.png"})
    CHECK(contains(read_mesh_file(folder.path / absent).error().sentence(), "does not exist"));
  CHECK(contains(write_mesh_file(sphere_file(), folder.path / "a.gltf").error().sentence(), "use .ply"));
}

TEST_CASE("a stiffness that is not positive is refused and a damaged landmark is kept as a comment") {
  MeshFolder folder;
  const auto ply = [](const std::string& comment, const std::string& stiffness) {
    return "ply\nformat ascii 1.0\ncomment " + comment +
           "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float stiffness\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 1\n0 1 0 " +
           stiffness + "\n3 0 1 2\n";
  };
  CHECK(contains(folder.refusal("a.ply", ply("x", "0")), "vertex 2 has a stiffness"));
  const auto mesh = folder.read("a.ply", ply("homolog.landmark {\"name\":3}", "1")).value();
  CHECK(mesh.landmarks.empty());
  CHECK(mesh.comments == std::vector<std::string>{"homolog.landmark {\"name\":3}"});
  CHECK(mesh.warnings.size() == 1);
}

TEST_CASE("a header that names something twice is refused and every vertex has a value of every array") {
  MeshFolder folder;
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string region = "comment homolog.region {\"name\":\"a\",\"factor\":1,\"colour\":\"#ffffff\"}\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string head = "ply\nformat ascii 1.0\n";
  CHECK(contains(folder.refusal("a.ply", head + region + "element vertex 1\n" + xyz + "property uchar region\n" +
                                             "element vertex 2\n" + xyz + faces + "0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2\n"),
                 "the element \"vertex\" twice"));
  for (const std::string again : {"x", "stiffness"})
    CHECK(contains(
        folder.refusal("a.ply", head + "element vertex 3\n" + xyz + "property float stiffness\nproperty float " +
                                    again + "\n" + faces + "0 0 0 1 2\n1 0 0 1 2\n0 1 0 1 2\n3 0 1 2\n"),
        "the property \"" + again + "\" twice"));
}

TEST_CASE("a stiffness beyond single precision is neither read nor written") {
  MeshFolder folder;
  MeshFile file = template_file();
  VertexScalars extreme = *file.stiffness;
  extreme[0] = 1e300;
  extreme[1] = 1e-300;
  file.stiffness = std::make_shared<const VertexScalars>(extreme);
  REQUIRE(write_mesh_file(file, folder.path / "a.ply"));
  const auto read = read_mesh_file(folder.path / "a.ply");
  REQUIRE(read);
  CHECK((*read->stiffness)[0] > 1e30);
  CHECK((*read->stiffness)[1] < 1e-30);
  CHECK(contains(folder.refusal("a.ply",
                                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                                "float z\nproperty double stiffness\nelement face 1\nproperty list uchar int "
                                "vertex_indices\nend_header\n0 0 0 1\n1 0 0 1\n0 1 0 1e300\n3 0 1 2\n"),
                 "vertex 2 has a stiffness"));
}

TEST_CASE("a mesh with a vertex or a landmark beyond sense is refused") {
  MeshFolder folder;
  CHECK(contains(folder.refusal("a.obj", "v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n"),
                 "vertex 1 lies beyond 1,000,000,000 mm"));
  MeshFile file = template_file();
  file.landmarks = {{"tip", Vec3(0, 1.8e19, 0)}};
  REQUIRE(write_mesh_file(file, folder.path / "far.ply"));
  const auto read = read_mesh_file(folder.path / "far.ply");
  REQUIRE(!read);
  CHECK(contains(read.error().sentence(), "the landmark \"tip\" lies beyond 1,000,000,000 mm"));
}

TEST_CASE("points without faces are mirrored too") {
  MeshFile file = sphere_file();
  file.triangles.edit().resize(0, 3);
  CHECK(mirrored(file).points.col(0) == -file.points.col(0));
}

TEST_CASE("what a file says is quoted in part") {
  MeshFolder folder;
  const std::string word(100000, 'w');
  for (const std::string& text : {"ply\n" + word + "\n", "ply\nelement a 1\nproperty " + word + " x\n",
                                  "ply\nelement " + word + " 9\nproperty int x\nend_header\n"})
    CHECK(folder.refusal("a.ply", text).size() < 500);
  CHECK(folder.refusal("a.vtk", "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\n" + word + " 1").size() < 500);
  CHECK(folder.refusal("a.obj", "# vertices and faces: " + word + "\nv 0 0 0\n").size() < 500);
}

TEST_CASE("a triangle soup is refused with its duplicate vertices named") {
  MeshFolder folder;
  const fs::path path =
      folder.put("soup.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\n");
  CHECK(contains(read_mesh(path).error().sentence(), "vertices 0 and 3 are duplicates"));
}

TEST_CASE("every real mesh is read and written and read again unchanged") {
  const fs::path data = real_data();
  if (data.empty()) return;
  MeshFolder folder;
  for (const char* part : {"meshes", "vertebra_L1"}) {
    for (const auto& entry : fs::recursive_directory_iterator(data / part)) {
      if (entry.path().extension() != ".ply" && entry.path().extension() != ".obj") continue;
      CAPTURE(entry.path().string());
      const auto mesh = read_mesh(entry.path());
      REQUIRE_MESSAGE(mesh, mesh.error().sentence());
      REQUIRE(write_mesh(*mesh, folder.path / "back.ply"));
      const auto back = read_mesh(folder.path / "back.ply").value();
      CHECK(back.points == mesh->points);
      CHECK(back.topology->hash() == mesh->topology->hash());
    }
  }
}

TEST_CASE("files of FreeSurfer's own formats are refused with how to convert them") {
  const MeshFolder folder;
  const std::string surface =
      "\xff\xff\xfe"
      "created by me\n\n";
  CHECK(folder.refusal("lh.pial", surface).find("convert it by FreeSurfer: mris_convert lh.pial lh.pial.surf.gii") !=
        std::string::npos);
  CHECK(folder.refusal("lh.aparc.annot", "x").find("mris_convert lh.pial lh.surf.gii") != std::string::npos);
  CHECK(folder.refusal("lh.other", "text").find("is not a mesh file of a known kind") != std::string::npos);
  const auto volume = read_volume(folder.put("lh.white", surface));
  REQUIRE_FALSE(volume);
  CHECK(volume.error().what.find("mris_convert lh.white lh.white.surf.gii") != std::string::npos);
}
