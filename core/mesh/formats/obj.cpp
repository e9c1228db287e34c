#include "core/base/file_record.h"
#include "core/base/text.h"
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

Result<MeshFile> read_obj(std::string_view bytes) {
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

const MeshFormat obj{.name = "OBJ", .extension = ".obj", .keeps_record = true, .read = read_obj, .write = write_obj};

}  // namespace homolog::formats
