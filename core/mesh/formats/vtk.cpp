#include "core/base/text.h"
#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/text.h"

namespace homolog::formats {
namespace {

constexpr std::endian vtk_order = std::endian::big;

Error damaged_vtk() {
  return {"", "is truncated or holds something that is no number; copy or export it again"};
}

std::optional<Scalar> vtk_scalar(std::string_view name) {
  if (name == "char" || name == "signed_char") return Scalar::int8;
  if (name == "unsigned_char") return Scalar::uint8;
  if (name == "short") return Scalar::int16;
  if (name == "unsigned_short") return Scalar::uint16;
  if (name == "int" || name == "vtkIdType" || name == "vtkidtype") return Scalar::int32;
  if (name == "unsigned_int") return Scalar::uint32;
  if (name == "long" || name == "vtktypeint64") return Scalar::int64;
  if (name == "unsigned_long" || name == "vtktypeuint64") return Scalar::uint64;
  if (name == "float") return Scalar::float32;
  if (name == "double") return Scalar::float64;
  return std::nullopt;
}

/// A legacy file: three lines, then key words each followed by their numbers.
class VtkReader {
 public:
  explicit VtkReader(std::string_view bytes) : text_(bytes) {}

  Result<MeshFile> read() {
    if (auto head = read_head(); !head) return fail(head.error());
    for (std::string_view key = text_.word(); !key.empty(); key = text_.word()) {
      if (key == "POINT_DATA" || key == "CELL_DATA") break;  // nothing of these is kept
      if (auto part = read_part(key); !part) return fail(part.error());
    }
    mesh_.points = to_points(std::move(coordinates_));
    mesh_.triangles = to_triangles(std::move(corners_));
    flip_if_ras(title_, mesh_);
    if (ascii_) warn_if_cut(text_, mesh_.warnings);
    return std::move(mesh_);
  }

 private:
  Result<void> read_head() {
    constexpr std::string_view magic = "# vtk DataFile Version ";
    const std::string_view first = text_.line();
    if (!first.starts_with(magic))
      return fail("", "is not a legacy VTK file (its first line is not \"# vtk DataFile\"); check its extension");
    offsets_form_ = to_number<double>(Text(first.substr(magic.size())).word()).value_or(0) >= 5;
    title_ = text_.line();
    const std::string_view encoding = text_.word();
    ascii_ = encoding == "ASCII";
    if (!ascii_ && encoding != "BINARY") return fail("", "is neither ASCII nor BINARY VTK; export it again");
    if (text_.word() != "DATASET" || text_.word() != "POLYDATA")
      return fail("", "holds no surface (its DATASET is not POLYDATA); extract the surface and save it again");
    return {};
  }

  Result<void> read_part(std::string_view key) {
    if (key == "POINTS") return read_points();
    if (key == "POLYGONS" || key == "TRIANGLE_STRIPS") return read_cells(key == "TRIANGLE_STRIPS", true);
    if (key == "VERTICES" || key == "LINES") return read_cells(false, false);
    if (key == "FIELD") return skip_field();
    if (key == "METADATA") {
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
    const std::string_view type = text_.word();
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
    return keep ? add_cells(ends, connectivity, strips, corners_) : Result<void>();
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
    for (auto [key, count, values] : {std::tuple("OFFSETS", offsets, &ends), {"CONNECTIVITY", size, &connectivity}}) {
      if (text_.word() != key) return fail(damaged_vtk());
      auto read = numbers<std::int64_t>(text_.word(), count);
      if (!read) return fail(read.error());
      *values = std::move(*read);
    }
    if (ends.front() != 0 || ends.back() != static_cast<std::int64_t>(connectivity.size()))
      return fail("", "has faces whose offsets do not fit their corners; export it again");
    ends.erase(ends.begin());
    return {};
  }

  /// FIELD name arrays, each: name components tuples type, then the values.
  Result<void> skip_field() {
    text_.word();
    const auto arrays = text_.number<std::size_t>();
    if (!arrays) return fail(damaged_vtk());
    for (std::size_t i = 0; i < *arrays; ++i) {
      std::string_view name = text_.word();
      if (name == "METADATA") {
        if (auto skipped = read_part(name); !skipped) return skipped;
        name = text_.word();
      }
      const auto components = text_.number<std::size_t>(), tuples = text_.number<std::size_t>();
      const std::string_view type = text_.word();
      if (!components || !tuples || *components > text_.remaining() || *tuples > text_.remaining())
        return fail(damaged_vtk());
      if (*components != 0 && *tuples > text_.remaining() / *components) return fail(damaged_vtk());
      if (auto skipped = skip_values(type, *components * *tuples); !skipped) return skipped;
    }
    return {};
  }

  Result<void> skip_values(std::string_view type, std::size_t count) {
    if (type != "string") {
      const auto values = numbers<double>(type, count);
      return values ? Result<void>() : fail(values.error());
    }
    text_.line();
    for (std::size_t i = 0; i < count; ++i) {
      if (ascii_)
        text_.line();
      else if (!skip_binary_string())
        return fail(damaged_vtk());
    }
    return {};
  }

  /// The two high bits of its first byte say in how many bytes (8, 4, 2, 1) its length stands.
  bool skip_binary_string() {
    const auto first = text_.take(1);
    if (!first) return false;
    const auto head = static_cast<std::uint8_t>(first->front());
    const auto rest = text_.take((std::size_t{8} >> (head >> 6)) - 1);
    if (!rest) return false;
    std::size_t length = head & 63u;
    for (const char c : *rest) length = length << 8 | static_cast<std::uint8_t>(c);
    return text_.take(length).has_value();
  }

  Text text_;
  std::string_view title_;
  bool ascii_ = false, offsets_form_ = false;
  std::vector<double> coordinates_;
  std::vector<std::int32_t> corners_;
  MeshFile mesh_;
};

Result<MeshFile> read_vtk(std::string_view bytes) {
  return VtkReader(bytes).read();
}

void write_vtk(const MeshFile& mesh, std::ostream& out) {
  std::string bytes = "# vtk DataFile Version 3.0\nHomolog mesh. SPACE=LPS\nBINARY\nDATASET POLYDATA\nPOINTS " +
                      std::to_string(mesh.points.rows()) + " double\n";
  for (const double x : mesh.points.reshaped<Eigen::RowMajor>()) store(x, vtk_order, bytes);
  bytes +=
      "\nPOLYGONS " + std::to_string(mesh.triangles.rows()) + " " + std::to_string(4 * mesh.triangles.rows()) + "\n";
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    store(std::int32_t{3}, vtk_order, bytes);
    for (const std::int32_t v : mesh.triangles.row(f)) store(v, vtk_order, bytes);
  }
  bytes += '\n';
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

const MeshFormat vtk{.name = "VTK legacy", .extension = ".vtk", .read = read_vtk, .write = write_vtk};

}  // namespace homolog::formats
