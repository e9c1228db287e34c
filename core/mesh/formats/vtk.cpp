#include "core/base/files/file_record.h"
#include "core/base/text/text.h"
#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/space.h"
#include "core/mesh/formats/text.h"
#include "core/mesh/formats/vertex_arrays.h"

namespace homolog::formats {
namespace {

constexpr std::endian vtk_order = std::endian::big;

Error damaged_vtk() {
  return {"", "is truncated or holds something that is no number; copy or export it again"};
}

/// `name` in small letters.
std::optional<Scalar> vtk_scalar(std::string_view name) {
  if (name == "char" || name == "signed_char") return Scalar::int8;
  if (name == "unsigned_char") return Scalar::uint8;
  if (name == "short") return Scalar::int16;
  if (name == "unsigned_short") return Scalar::uint16;
  if (name == "int" || name == "vtkidtype") return Scalar::int32;
  if (name == "unsigned_int") return Scalar::uint32;
  if (name == "long" || name == "vtktypeint64") return Scalar::int64;
  if (name == "unsigned_long" || name == "vtktypeuint64") return Scalar::uint64;
  if (name == "float") return Scalar::float32;
  if (name == "double") return Scalar::float64;
  return std::nullopt;
}

/// A string as VTK writes it into text: %20 for a blank, and so on.
std::string decoded(std::string_view text) {
  std::string plain;
  for (std::size_t at = 0; at < text.size(); ++at) {
    unsigned code = 0;
    if (text[at] == '%' && at + 2 < text.size() &&
        std::from_chars(text.data() + at + 1, text.data() + at + 3, code, 16).ptr == text.data() + at + 3) {
      plain += static_cast<char>(code);
      at += 2;
    } else {
      plain += text[at];
    }
  }
  return plain;
}

/// A legacy file: three lines, then key words, in small letters or capitals, each followed by their numbers.
class VtkReader {
 public:
  explicit VtkReader(std::string_view bytes) : text_(bytes) {}

  Result<MeshFile> read() {
    if (auto head = read_head(); !head) return fail(head.error());
    for (std::string key = key_word(); !key.empty(); key = key_word()) {
      if (key == "point_data") {
        read_point_data();
        break;
      }
      if (key == "cell_data") break;  // nothing of these is kept
      if (auto part = read_part(key); !part) return fail(part.error());
    }
    if (auto filled = std::move(faces_).fill(mesh_, std::move(coordinates_)); !filled) return fail(filled.error());
    for (auto& [name, values] : arrays_)
      keep_vertex_array(name, Eigen::Map<const VertexScalars>(values.data(), std::ssize(values)), mesh_);
    space_.apply_to(mesh_);
    if (ascii_) warn_if_cut(text_, mesh_.warnings);
    return std::move(mesh_);
  }

 private:
  std::string key_word() { return lower_case(std::string(text_.word())); }

  Result<void> read_head() {
    constexpr std::string_view magic = "# vtk datafile version ";
    const std::string_view first = text_.line();
    if (!lower_case(std::string(first.substr(0, 100))).starts_with(magic))
      return fail("", "is not a legacy VTK file (its first line is not \"# vtk DataFile\"); check its extension");
    offsets_form_ = to_number<double>(Text(first.substr(magic.size())).word()).value_or(0) >= 5;
    space_.look_in(text_.line());
    const std::string encoding = key_word();
    ascii_ = encoding == "ascii";
    if (!ascii_ && encoding != "binary") return fail("", "is neither ASCII nor BINARY VTK; export it again");
    if (key_word() != "dataset" || key_word() != "polydata")
      return fail("", "holds no surface (its DATASET is not POLYDATA); extract the surface and save it again");
    return {};
  }

  Result<void> read_part(std::string_view key) {
    if (key == "points") return read_points();
    if (key == "polygons" || key == "triangle_strips") return read_cells(key == "triangle_strips", true);
    if (key == "vertices" || key == "lines") return read_cells(false, false);
    if (key == "field") return read_field();
    if (key == "metadata") {
      text_.line();
      while (text_.remaining() > 0 && !text_.line().empty()) {
      }
      return {};
    }
    return fail("",
                "has a part that VTK surfaces do not have (\"" + excerpt(key) + "\") or is truncated; export it again");
  }

  /// `count` numbers of the type named `type`, whose key word's line has not been ended yet.
  template <class To>
  Result<std::vector<To>> numbers(std::string_view type, std::size_t count) {
    const auto scalar = vtk_scalar(type);
    if (!scalar) return fail("", "has numbers of an unknown type (\"" + excerpt(type) + "\"); export it again");
    if (std::is_integral_v<To> && !is_integer(*scalar))
      return fail("", "has faces that are not integers; export it again");
    text_.line();
    const std::size_t smallest = ascii_ ? 1 : size_of(*scalar);
    if (count > text_.remaining() / smallest)
      return fail("", "announces " + std::to_string(count) + " numbers but is too short to hold them; copy it again");
    if (!ascii_) return load_all<To>(*text_.take(count * smallest), *scalar, vtk_order);
    std::vector<To> values(count);
    for (To& value : values) {
      const auto number = text_.number<To>();
      if (!number) return fail(damaged_vtk());
      value = *number;
    }
    return values;
  }

  Result<void> read_points() {
    const auto count = text_.number<std::size_t>();
    const std::string type = key_word();
    if (!count || *count > text_.remaining()) return fail(damaged_vtk());
    auto values = numbers<double>(type, 3 * *count);
    if (!values) return fail(values.error());
    coordinates_ = std::move(*values);
    return {};
  }

  Result<void> read_cells(bool strips, bool keep) {
    const auto first = text_.number<std::size_t>(), second = text_.number<std::size_t>();
    if (!first || !second) return fail(damaged_vtk());
    std::vector<std::int64_t> ends, connectivity;
    if (auto read = offsets_form_ ? read_offsets(*first, *second, ends, connectivity)
                                  : read_counted(*first, *second, ends, connectivity);
        !read)
      return read;
    return keep ? faces_.add_cells(ends, connectivity, strips) : Result<void>();
  }

  /// Versions before 5: `size` integers, each cell its number of vertices and then these.
  Result<void> read_counted(std::size_t cells, std::size_t size, std::vector<std::int64_t>& ends,
                            std::vector<std::int64_t>& connectivity) {
    auto values = numbers<std::int64_t>("int", size);
    if (!values) return fail(values.error());
    for (std::size_t at = 0; at < values->size();) {
      const std::int64_t count = (*values)[at++];
      if (count < 0 || static_cast<std::size_t>(count) > values->size() - at) return fail(damaged_vtk());
      connectivity.insert(connectivity.end(), values->begin() + static_cast<std::ptrdiff_t>(at),
                          values->begin() + static_cast<std::ptrdiff_t>(at) + count);
      ends.push_back(static_cast<std::int64_t>(connectivity.size()));
      at += static_cast<std::size_t>(count);
    }
    if (ends.size() != cells) return fail("", "announces another number of faces than it holds; export it again");
    return {};
  }

  /// Since version 5: arrays OFFSETS (one more than cells, the first 0) and CONNECTIVITY.
  Result<void> read_offsets(std::size_t offsets, std::size_t size, std::vector<std::int64_t>& ends,
                            std::vector<std::int64_t>& connectivity) {
    if (offsets == 0) return {};
    for (auto [key, count, values] : {std::tuple("offsets", offsets, &ends), {"connectivity", size, &connectivity}}) {
      if (key_word() != key) return fail(damaged_vtk());
      auto read = numbers<std::int64_t>(key_word(), count);
      if (!read) return fail(read.error());
      *values = std::move(*read);
    }
    if (ends.front() != 0 || ends.back() != static_cast<std::int64_t>(connectivity.size()))
      return fail("", "has faces whose offsets do not fit their corners; export it again");
    ends.erase(ends.begin());
    return {};
  }

  /// The arrays of one value a vertex. What comes is left where something is not understood: the surface is whole.
  void read_point_data() {
    const auto vertices = text_.number<std::size_t>();
    if (!vertices || 3 * *vertices != coordinates_.size()) return;
    for (std::string key = key_word(); key == "scalars" || key == "field"; key = key_word()) {
      if (key == "field" ? !read_point_field(*vertices) : !read_scalars(*vertices)) return;
    }
  }

  bool keep_array(std::string_view name, std::string_view type, std::size_t components, std::size_t vertices) {
    const std::string kept = decoded(name);
    if (components == 0 || components > 16 || !vtk_scalar(type)) return false;
    auto values = numbers<double>(type, components * vertices);
    if (!values) mesh_.warnings.push_back(left_out(kept));
    if (!values) return false;
    if (components == 1) arrays_.emplace_back(kept, std::move(*values));
    return true;
  }

  /// SCALARS name type [components], LOOKUP_TABLE name, then the values.
  bool read_scalars(std::size_t vertices) {
    Text words(text_.line());
    const std::string name(words.word()), type = lower_case(std::string(words.word()));
    const auto components = to_number<std::size_t>(words.word()).value_or(1);
    return key_word() == "lookup_table" && keep_array(name, type, components, vertices);
  }

  bool read_point_field(std::size_t vertices) {
    text_.word();
    const auto arrays = text_.number<std::size_t>();
    if (!arrays || *arrays > 1000) return false;
    for (std::size_t i = 0; i < *arrays; ++i) {
      std::string name(text_.word());
      if (lower_case(name) == "metadata") {
        if (!read_part("metadata")) return false;
        name = text_.word();
      }
      const auto components = text_.number<std::size_t>(), tuples = text_.number<std::size_t>();
      const std::string type = key_word();
      if (!components || !tuples || type.empty()) {
        mesh_.warnings.push_back(left_out(name.empty() ? "FIELD" : name));
        return false;
      }
      if (*tuples != vertices || !keep_array(name, type, *components, vertices)) return false;
    }
    return true;
  }

  /// FIELD name arrays, each: name components tuples type, then the values. Of these SPACE alone is kept.
  Result<void> read_field() {
    text_.word();
    const auto arrays = text_.number<std::size_t>();
    if (!arrays) return fail(damaged_vtk());
    for (std::size_t i = 0; i < *arrays; ++i) {
      std::string_view name = text_.word();
      if (lower_case(std::string(name)) == "metadata") {
        if (auto skipped = read_part("metadata"); !skipped) return skipped;
        name = text_.word();
      }
      const auto components = text_.number<std::size_t>(), tuples = text_.number<std::size_t>();
      const std::string type = key_word();
      if (!components || !tuples || *components > text_.remaining() || *tuples > text_.remaining())
        return fail(damaged_vtk());
      if (*components != 0 && *tuples > text_.remaining() / *components) return fail(damaged_vtk());
      const auto value = text_of_values(type, *components * *tuples);
      if (!value) return fail(value.error());
      if (decoded(name) == "SPACE") space_.add(*value);
    }
    return {};
  }

  /// The first string of an array of strings, or an array of characters as a string; empty for other numbers.
  Result<std::string> text_of_values(std::string_view type, std::size_t count) {
    std::string text;
    if (type != "string" && type != "utf8_string") {
      const auto values = numbers<double>(type, count);
      if (!values) return fail(values.error());
      if (vtk_scalar(type) != Scalar::int8 && vtk_scalar(type) != Scalar::uint8) return text;
      for (const double value : *values)
        if (value > 0 && value < 128) text += static_cast<char>(value);
      return text;
    }
    text_.line();
    for (std::size_t i = 0; i < count; ++i) {
      const auto one = ascii_ ? std::optional(decoded(text_.line())) : binary_string();
      if (!one) return fail(damaged_vtk());
      if (i == 0) text = *one;
    }
    return text;
  }

  /// The two high bits of its first byte say in how many bytes (8, 4, 2, 1) its length stands.
  std::optional<std::string> binary_string() {
    const auto first = text_.take(1);
    if (!first) return std::nullopt;
    const auto head = static_cast<std::uint8_t>(first->front());
    const auto rest = text_.take((std::size_t{8} >> (head >> 6)) - 1);
    if (!rest) return std::nullopt;
    std::size_t length = head & 63u;
    for (const char c : *rest) length = length << 8 | static_cast<std::uint8_t>(c);
    const auto text = text_.take(length);
    return text ? std::optional<std::string>(*text) : std::nullopt;
  }

  Text text_;
  SpaceNames space_;
  bool ascii_ = false, offsets_form_ = false;
  std::vector<double> coordinates_;
  Faces faces_;
  MeshFile mesh_;
  std::vector<std::pair<std::string, std::vector<double>>> arrays_;  ///< arrays with one value a vertex
};

Result<MeshFile> read_vtk(std::string_view bytes) {
  return VtkReader(bytes).read();
}

void write_vtk(const MeshFile& mesh, std::ostream& out) {
  std::string bytes = "# vtk DataFile Version 3.0\nHomolog mesh. SPACE=LPS\nBINARY\nDATASET POLYDATA\n" +
                      record_of_vtk(mesh.record) + "POINTS " + std::to_string(mesh.points.rows()) + " double\n";
  for (const double x : mesh.points.reshaped<Eigen::RowMajor>()) store(x, vtk_order, bytes);
  bytes +=
      "\nPOLYGONS " + std::to_string(mesh.triangles.rows()) + " " + std::to_string(4 * mesh.triangles.rows()) + "\n";
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    store(std::int32_t{3}, vtk_order, bytes);
    for (const std::int32_t v : mesh.triangles.row(f)) store(v, vtk_order, bytes);
  }
  bytes += '\n';
  if (const auto arrays = vertex_arrays(mesh); !arrays.empty()) {
    const std::string vertices = std::to_string(mesh.points.rows());
    bytes += "POINT_DATA " + vertices + "\nFIELD FieldData " + std::to_string(arrays.size()) + "\n";
    for (const auto& [name, values] : arrays) {
      bytes += name + " 1 " + vertices + " float\n";
      for (const double value : values) store(static_cast<float>(value), vtk_order, bytes);
      bytes += '\n';
    }
  }
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

const MeshFormat vtk{
    .name = "VTK legacy", .extension = ".vtk", .keeps_record = true, .read = read_vtk, .write = write_vtk};

}  // namespace homolog::formats
