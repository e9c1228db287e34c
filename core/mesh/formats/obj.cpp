#include "core/base/text.h"
#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/text.h"

namespace homolog::formats {
namespace {

constexpr std::string_view counts_key = "# vertices and faces: ";

/// "v", "v/t", "v//n" or "v/t/n", counted from 1, or from the end where negative; as an index from 0.
std::optional<std::int64_t> vertex_of(std::string_view corner, std::size_t vertices) {
  const auto number = to_number<std::int64_t>(corner.substr(0, corner.find('/')));
  if (!number || *number == 0) return std::nullopt;
  return *number > 0 ? *number - 1 : static_cast<std::int64_t>(vertices) + *number;
}

Result<void> read_face(Text& words, std::size_t vertices, std::vector<std::int32_t>& corners) {
  std::vector<std::int64_t> polygon;
  for (std::string_view corner = words.word(); !corner.empty(); corner = words.word()) {
    const auto vertex = vertex_of(corner, vertices);
    if (!vertex) return fail("", "has a face with an unreadable corner; copy or export it again");
    polygon.push_back(*vertex);
  }
  return add_polygon(polygon, corners);
}

Result<MeshFile> read_obj(std::string_view bytes) {
  MeshFile mesh;
  Text text(bytes);
  std::vector<double> coordinates;
  std::vector<std::int32_t> corners;
  std::string_view space, counts;
  while (text.remaining() > 0) {
    const std::string_view line = text.line();
    if (line.starts_with("#") && line.find("SPACE=") != std::string_view::npos) space = line;
    if (line.starts_with(counts_key)) counts = line.substr(counts_key.size());
    Text words(line);
    const std::string_view key = words.word();
    if (key == "v") {
      for (int k = 0; k < 3; ++k) {
        const auto x = words.number<double>();
        if (!x) return fail("", "has a vertex without three coordinates; copy or export it again");
        coordinates.push_back(*x);
      }
    } else if (key == "f") {
      if (auto read = read_face(words, coordinates.size() / 3, corners); !read) return fail(read.error());
    }
  }
  if (!counts.empty()) {
    Text words(counts);
    // A last line without its break may have lost digits.
    if (words.number<std::size_t>() != coordinates.size() / 3 || words.number<std::size_t>() != corners.size() / 3 ||
        text.may_be_cut())
      return fail("", "does not hold the " + excerpt(counts) + " vertices and faces that it announces; copy it again");
  }
  mesh.points = to_points(std::move(coordinates));
  mesh.triangles = to_triangles(std::move(corners));
  flip_if_ras(space, mesh);
  warn_if_cut(text, mesh.warnings);
  return mesh;
}

void write_obj(const MeshFile& mesh, std::ostream& out) {
  std::string text = "# Homolog mesh, mm\n# SPACE=LPS\n";
  text.append(counts_key)
      .append(std::to_string(mesh.points.rows()) + " " + std::to_string(mesh.triangles.rows()) + "\n");
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    text += 'v';
    for (const double x : mesh.points.row(i)) append_number(x, text += ' ');
    text += '\n';
  }
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    text += 'f';
    for (const std::int32_t v : mesh.triangles.row(f)) append_number(v + 1, text += ' ');
    text += '\n';
  }
  out << text;
}

}  // namespace

const MeshFormat obj{.name = "OBJ", .extension = ".obj", .read = read_obj, .write = write_obj};

}  // namespace homolog::formats
