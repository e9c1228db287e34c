#include "core/base/files/file_record.h"
#include "core/base/text/text.h"
#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/space.h"
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

/// The next word before a remark.
std::string_view word_of_line(Text& words) {
  const std::string_view word = words.word();
  return word.starts_with('#') ? std::string_view() : word;
}

Result<void> read_face(Text& words, std::size_t vertices, Faces& faces) {
  std::vector<std::int64_t> polygon;
  for (std::string_view corner = word_of_line(words); !corner.empty(); corner = word_of_line(words)) {
    const auto vertex = vertex_of(corner, vertices);
    if (!vertex) return fail("", "has a face with an unreadable corner; copy or export it again");
    if (polygon.size() == most_corners) return too_many_corners();
    polygon.push_back(*vertex);
  }
  return faces.add(polygon);
}

/// "x y z"; with a weight behind them where that is 1, or with a colour.
Result<void> read_vertex(Text& words, std::vector<double>& coordinates) {
  std::vector<double> numbers;
  for (std::string_view word = word_of_line(words); !word.empty(); word = word_of_line(words)) {
    const auto number = to_number<double>(word);
    if (!number) break;  // counted below
    numbers.push_back(*number);
  }
  const std::string vertex = "vertex " + std::to_string(coordinates.size() / 3);
  if (numbers.size() < 3) return fail("", "has a vertex without three coordinates; copy or export it again");
  if (numbers.size() == 4 && numbers[3] != 1)
    return fail("", vertex + " has a weight other than 1, as curved surfaces have; export the surface as polygons");
  if (numbers.size() == 5)
    return fail("", vertex + " has five numbers where x, y and z belong; export it again with decimal points");
  coordinates.insert(coordinates.end(), numbers.begin(), numbers.begin() + 3);
  return {};
}

/// The next line. A backslash at its end joins the one that follows, but not to a remark, which may end in a path.
std::string_view whole_line(Text& text, std::string& joined) {
  std::string_view line = text.line();
  if (!line.ends_with('\\') || line.starts_with('#')) return line;
  joined.clear();
  while (line.ends_with('\\') && text.remaining() > 0) {
    joined.append(line.substr(0, line.size() - 1)).push_back(' ');
    line = text.line();
  }
  joined.append(line.ends_with('\\') ? line.substr(0, line.size() - 1) : line);
  return joined;
}

Error damaged_mni() {
  return {"", "is an MNI file that is truncated or damaged; copy or export it again"};
}

template <class T>
bool read_mni_numbers(Text& text, std::size_t rows, std::size_t columns, std::vector<T>& numbers) {
  if (rows > text.remaining()) return false;  // a number takes a byte and more
  for (std::size_t i = 0; i < rows * columns; ++i) {
    const auto number = text.number<T>();
    if (!number) return false;
    numbers.push_back(*number);
  }
  return true;
}

/// MNI's polygons in text: how they shine, points, normals, their ends and their corners. In RAS.
Result<MeshFile> read_mni(std::string_view bytes) {
  Text text(bytes);
  const std::string_view kind = text.word();
  if (kind != "P")
    return fail("", kind == "L" ? "is an MNI file of lines; export a surface of polygons"
                                : "is a binary MNI file; save it as text, which begins with a capital P");
  for (int k = 0; k < 5; ++k)
    if (!text.number<double>()) return fail(damaged_mni());
  std::vector<double> coordinates, normals;
  const auto points = text.number<std::size_t>();
  if (!points || !read_mni_numbers(text, *points, 3, coordinates) || !read_mni_numbers(text, *points, 3, normals))
    return fail(damaged_mni());
  const auto polygons = text.number<std::size_t>(), colouring = text.number<std::size_t>();
  if (!polygons || !colouring || *colouring > 2) return fail(damaged_mni());
  std::vector<double> colours;
  std::vector<std::int64_t> ends, corners;
  const std::size_t coloured = *colouring == 0 ? 1 : *colouring == 1 ? *polygons : *points;
  if (!read_mni_numbers(text, coloured, 4, colours) || !read_mni_numbers(text, *polygons, 1, ends))
    return fail(damaged_mni());
  if (!ends.empty() && (ends.back() < 0 || !read_mni_numbers(text, static_cast<std::size_t>(ends.back()), 1, corners)))
    return fail(damaged_mni());
  MeshFile mesh;
  Faces faces;
  if (auto added = faces.add_cells(ends, corners, false); !added) return fail(added.error());
  if (auto filled = std::move(faces).fill(mesh, std::move(coordinates)); !filled) return fail(filled.error());
  mesh.points.leftCols<2>() *= -1;
  if (!text.word().empty()) mesh.warnings.emplace_back("holds further objects behind its polygons, which are not read");
  warn_if_cut(text, mesh.warnings);
  return mesh;
}

/// Whether it is one of MNI's: these begin with the letter of their kind, P for polygons, and numbers. A small letter
/// says that the numbers are bytes; Wavefront's `p` and `l` are followed by text.
bool is_mni(std::string_view bytes) {
  Text text(bytes);
  const std::string_view kind = text.word();
  if (kind == "P" || kind == "L") return true;
  return (bytes.starts_with('p') || bytes.starts_with('l')) && bytes.substr(0, 64).find('\0') != std::string_view::npos;
}

Result<MeshFile> read_obj(std::string_view bytes) {
  if (is_mni(bytes)) return read_mni(bytes);
  MeshFile mesh;
  Text text(bytes);
  std::vector<double> coordinates;
  Faces faces;
  SpaceNames space;
  std::string_view counts;
  std::string joined;
  while (text.remaining() > 0) {
    const std::string_view line = whole_line(text, joined);
    if (line.starts_with("#") && !is_record_line(line.substr(std::min<std::size_t>(2, line.size()))))
      space.look_in(line);
    if (line.starts_with(counts_key)) counts = line.substr(counts_key.size());
    Text words(line);
    const std::string_view key = words.word();
    if (key == "v") {
      if (auto read = read_vertex(words, coordinates); !read) return fail(read.error());
    } else if (key == "f") {
      if (auto read = read_face(words, coordinates.size() / 3, faces); !read) return fail(read.error());
    }
  }
  if (!counts.empty()) {
    Text words(counts);
    // A last line without its break may have lost digits.
    if (words.number<std::size_t>() != coordinates.size() / 3 || words.number<std::size_t>() != faces.triangles() ||
        text.may_be_cut())
      return fail("", "does not hold the " + excerpt(counts) + " vertices and faces that it announces; copy it again");
  }
  if (auto filled = std::move(faces).fill(mesh, std::move(coordinates)); !filled) return fail(filled.error());
  space.apply_to(mesh);
  warn_if_cut(text, mesh.warnings);
  return mesh;
}

/// MNI's files have normals of the points.
Points point_normals(const MeshFile& mesh) {
  Points normals = Points::Zero(mesh.points.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    const auto corner = [&](int k) { return Vec3(mesh.points.row(mesh.triangles(f, k))); };
    const Vec3 area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (const std::int32_t v : mesh.triangles.row(f)) normals.row(v) += area.transpose();
  }
  for (Eigen::Index i = 0; i < normals.rows(); ++i) normals.row(i).normalize();
  return normals;
}

void append_mni_rows(const Points& rows, std::string& text) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    for (int k = 0; k < 3; ++k) append_number(k < 2 ? -rows(i, k) : rows(i, k), text += ' ');
    text += '\n';
  }
  text += '\n';
}

void write_mni(const MeshFile& mesh, std::ostream& out) {
  std::string text = "P 0.3 0.3 0.4 10 1 " + std::to_string(mesh.points.rows()) + "\n";
  append_mni_rows(mesh.points, text);
  append_mni_rows(point_normals(mesh), text);
  text += " " + std::to_string(mesh.triangles.rows()) + "\n 0 1 1 1 1\n\n";
  for (Eigen::Index f = 1; f <= mesh.triangles.rows(); ++f) {
    append_number(3 * f, text += ' ');
    if (f % 8 == 0 || f == mesh.triangles.rows()) text += '\n';
  }
  text += '\n';
  for (Eigen::Index k = 0; k < mesh.triangles.size(); ++k) {
    append_number(mesh.triangles(k / 3, k % 3), text += ' ');
    if (k % 8 == 7 || k + 1 == mesh.triangles.size()) text += '\n';
  }
  out << text;
}

void write_obj(const MeshFile& mesh, std::ostream& out) {
  std::string text = "# Homolog mesh, mm\n# SPACE=LPS\n" + record_lines("# ", mesh.record);
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

const MeshFormat obj{.name = "OBJ",
                     .extension = ".obj",
                     .note = "Wavefront's; one of MNI is told by its content",
                     .keeps_record = true,
                     .read = read_obj,
                     .write = write_obj};
const MeshFormat mni_obj{.name = "MNI OBJ",
                         .extension = ".mni.obj",
                         .note = "polygons in text, in RAS, as CIVET and MNI's tools write them into `.obj`",
                         .read = read_obj,
                         .write = write_mni};

}  // namespace homolog::formats
