#include <zlib.h>

#include <array>
#include <map>
#include <pugixml.hpp>

#include "core/base/file_record.h"
#include "core/base/limits.h"
#include "core/base/text.h"
#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/space.h"
#include "core/mesh/formats/text.h"
#include "core/mesh/formats/vertex_arrays.h"
#include "core/mesh/formats/vtp_lines.h"

namespace homolog::formats {
namespace {

Error damaged_vtp() {
  return {"", "is truncated or its data arrays are damaged; copy or export it again"};
}

std::optional<Scalar> vtp_scalar(std::string_view name) {
  constexpr std::array names{"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                             "UInt32", "Int64", "UInt64", "Float32", "Float64"};
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) return std::nullopt;
  return static_cast<Scalar>(at - names.begin());
}

/// Bytes that lie in the file as they are or in base64; decoded only as far as they are asked for.
class ByteSource {
 public:
  ByteSource(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  std::optional<std::string_view> take(std::size_t count) {
    if (!base64_) {
      if (count > text_.size() - at_) return std::nullopt;
      at_ += count;
      return text_.substr(at_ - count, count);
    }
    if (count > text_.size()) return std::nullopt;
    while (decoded_.size() - taken_ < count)
      if (!decode_group()) return std::nullopt;
    taken_ += count;
    return std::string_view(decoded_).substr(taken_ - count, count);
  }
  /// How far into its text it has come.
  std::size_t consumed() const { return at_; }

 private:
  static int value_of(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  }

  /// Four characters to at most three bytes. Groups padded with '=' may stand anywhere: VTK encodes the sizes of
  /// compressed blocks and the blocks one after the other.
  bool decode_group() {
    std::uint32_t bits = 0;
    int digits = 0, padding = 0;
    while (digits + padding < 4) {
      while (at_ < text_.size() && is_space(text_[at_])) ++at_;
      if (at_ == text_.size()) return false;
      const char c = text_[at_++];
      const int value = value_of(c);
      if (c == '=' ? digits < 2 : value < 0 || padding > 0) return false;
      bits = bits << 6 | static_cast<std::uint32_t>(std::max(value, 0));
      ++(c == '=' ? padding : digits);
    }
    for (int byte = 0; byte < digits - 1; ++byte) decoded_ += static_cast<char>(bits >> (16 - 8 * byte) & 255);
    return true;
  }

  std::string_view text_;
  bool base64_;
  std::size_t at_ = 0;
  std::string decoded_;
  std::size_t taken_ = 0;
};

class VtpReader {
 public:
  Result<MeshFile> read(std::string_view bytes) {
    encoded_left_ = bytes.size();
    decoded_left_ = most_decoded(bytes.size());
    if (auto parsed = parse(bytes); !parsed) return fail(parsed.error());
    for (const auto piece : document_.child("VTKFile").child("PolyData").children("Piece"))
      if (auto read = read_piece(piece); !read) return fail(read.error());
    MeshFile mesh;
    if (auto filled = std::move(faces_).fill(mesh, std::move(coordinates_)); !filled) return fail(filled.error());
    for (auto& [name, values] : arrays_)
      if (std::ssize(values) == mesh.points.rows())
        keep_vertex_array(name, Eigen::Map<const VertexScalars>(values.data(), std::ssize(values)), mesh);
    if (auto placed = take_space(mesh); !placed) return fail(placed.error());
    return mesh;
  }

  Result<VtpLines> lines(std::string_view bytes) {
    encoded_left_ = bytes.size();
    decoded_left_ = most_decoded(bytes.size());
    if (auto parsed = parse(bytes); !parsed) return fail(parsed.error());
    VtpLines lines;
    for (const auto piece : document_.child("VTKFile").child("PolyData").children("Piece")) {
      const auto first_vertex = static_cast<std::int64_t>(coordinates_.size() / 3);
      if (auto read = read_points(piece); !read) return fail(read.error());
      if (auto read = read_lines(piece, first_vertex, lines.lines); !read) return fail(read.error());
    }
    MeshFile mesh;
    mesh.points = to_points(std::move(coordinates_));
    if (!all_in_reach(mesh.points)) return fail("", "has a point that is no place in mm; export it again");
    if (auto placed = take_space(mesh); !placed) return fail(placed.error());
    lines.points = std::move(mesh.points);
    lines.warnings = std::move(mesh.warnings);
    return lines;
  }

 private:
  /// Turns the points as the file's space says.
  Result<void> take_space(MeshFile& mesh) {
    SpaceNames space;
    // VTK writes strings as <Array>; others as <DataArray>.
    for (const auto field : document_.child("VTKFile").child("PolyData").child("FieldData").children()) {
      if (field.attribute("Name").value() != std::string_view("SPACE")) continue;
      const auto name = text_of(field);
      if (!name) return fail(name.error());
      space.add(*name);
    }
    space.apply_to(mesh);
    return {};
  }

  Result<void> read_lines(pugi::xml_node piece, std::int64_t first_vertex,
                          std::vector<std::vector<std::int64_t>>& lines) {
    const auto count = piece.attribute("NumberOfLines").as_ullong();
    if (count == 0) return {};
    const auto cells = piece.child("Lines");
    const auto connectivity = array<std::int64_t>(cells.find_child_by_attribute("DataArray", "Name", "connectivity"));
    if (!connectivity) return fail(connectivity.error());
    const auto ends = array<std::int64_t>(cells.find_child_by_attribute("DataArray", "Name", "offsets"));
    if (!ends) return fail(ends.error());
    const auto all = static_cast<std::int64_t>(connectivity->size());
    const auto vertices = static_cast<std::int64_t>(coordinates_.size() / 3);
    if (ends->size() != count) return fail("", "announces another number of lines than it holds; export it again");
    std::int64_t from = 0;
    for (const std::int64_t end : *ends) {
      if (end < from || end > all) return fail(damaged_vtp());
      auto& line = lines.emplace_back();
      for (; from < end; ++from) {
        const std::int64_t v = (*connectivity)[static_cast<std::size_t>(from)];
        if (v < 0 || v >= vertices - first_vertex)
          return fail("", "has a line through a point that it does not hold; export it again");
        line.push_back(v + first_vertex);
      }
    }
    return {};
  }

  /// No mesh packs into a hundredth of its size: more is a bomb.
  static std::size_t most_decoded(std::size_t file_bytes) { return (std::size_t{16} << 20) + 100 * file_bytes; }

  /// Appended data may be raw bytes, which no XML parser takes: they are cut off first.
  Result<void> parse(std::string_view bytes) {
    std::string xml;
    if (const std::size_t tag = bytes.find("<AppendedData"); tag != std::string_view::npos) {
      const std::size_t end = bytes.find('>', tag), start = bytes.find('_', end);
      if (start == std::string_view::npos) return fail(damaged_vtp());
      appended_ = bytes.substr(start + 1);
      xml = std::string(bytes.substr(0, end + 1)) + "</AppendedData></VTKFile>";
    } else {
      xml = bytes;
    }
    if (const auto parsed = document_.load_buffer(xml.data(), xml.size()); !parsed)
      return fail("", "is no whole VTP file (XML: " + std::string(parsed.description()) + "); copy or export it again");
    const auto root = document_.child("VTKFile");
    if (root.attribute("type").value() != std::string_view("PolyData"))
      return fail("", "holds no surface (its type is not PolyData); extract the surface and save it again");
    appended_base64_ = root.child("AppendedData").attribute("encoding").value() == std::string_view("base64");
    const std::string_view order = root.attribute("byte_order").value(), header = root.attribute("header_type").value();
    order_ = order == "BigEndian" ? std::endian::big : std::endian::little;
    header_ = header == "UInt64" ? Scalar::uint64 : Scalar::uint32;
    const std::string_view compressor = root.attribute("compressor").value();
    compressed_ = !compressor.empty();
    if (compressed_ && compressor != "vtkZLibDataCompressor")
      return fail("", "is compressed by " + excerpt(compressor) + "; save it uncompressed or with zlib");
    return {};
  }

  Result<void> read_points(pugi::xml_node piece) {
    auto points = array<double>(piece.child("Points").child("DataArray"));
    if (!points) return fail(points.error());
    if (points->size() != 3 * piece.attribute("NumberOfPoints").as_ullong())
      return fail("", "announces another number of points than it holds; export it again");
    if (coordinates_.empty())
      coordinates_ = std::move(*points);
    else
      coordinates_.insert(coordinates_.end(), points->begin(), points->end());
    return {};
  }

  Result<void> read_piece(pugi::xml_node piece) {
    const auto first_vertex = static_cast<std::int64_t>(coordinates_.size() / 3);
    if (auto read = read_points(piece); !read) return read;
    // Of several pieces an array counts where each of them has it.
    for (const auto node : piece.child("PointData").children("DataArray")) {
      const auto components = node.attribute("NumberOfComponents").as_ullong(1);
      if (components != 1 || arrays_.size() > 1000) continue;
      auto values = array<double>(node);
      if (!values) continue;  // the surface is whole without it
      auto& all = arrays_[node.attribute("Name").value()];
      if (std::ssize(all) == first_vertex) all.insert(all.end(), values->begin(), values->end());
    }
    if (auto polygons = read_cells(piece, "Polys", "NumberOfPolys", first_vertex); !polygons) return polygons;
    return read_cells(piece, "Strips", "NumberOfStrips", first_vertex);
  }

  Result<void> read_cells(pugi::xml_node piece, const char* name, const char* count_name, std::int64_t first_vertex) {
    const auto count = piece.attribute(count_name).as_ullong();
    if (count == 0) return {};
    const auto cells = piece.child(name);
    auto connectivity = array<std::int64_t>(cells.find_child_by_attribute("DataArray", "Name", "connectivity"));
    if (!connectivity) return fail(connectivity.error());
    const auto ends = array<std::int64_t>(cells.find_child_by_attribute("DataArray", "Name", "offsets"));
    if (!ends) return fail(ends.error());
    if (ends->size() != count || ends->back() != static_cast<std::int64_t>(connectivity->size()))
      return fail("", "announces another number of faces than it holds; export it again");
    for (std::int64_t& v : *connectivity)
      if (v >= 0 && v < std::int64_t{1} << 40) v += first_vertex;
    return faces_.add_cells(*ends, *connectivity, name == std::string_view("Strips"));
  }

  template <class To>
  Result<std::vector<To>> array(pugi::xml_node node) {
    if (!node) return fail("", "lacks a data array of a surface; export it again");
    const auto type = vtp_scalar(node.attribute("type").value());
    if (!type || (std::is_integral_v<To> && !is_integer(*type)))
      return fail("", "has a data array of an unsuited type; export it again");
    if (node.attribute("format").value() == std::string_view("ascii")) return ascii_array<To>(node.child_value());
    const auto bytes = content(node);
    if (!bytes) return fail(bytes.error());
    return load_all<To>(*bytes, *type, order_);
  }

  template <class To>
  static Result<std::vector<To>> ascii_array(std::string_view content) {
    std::vector<To> values;
    Text text(content);
    for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
      const auto value = to_number<To>(word);
      if (!value) return fail(damaged_vtp());
      values.push_back(*value);
    }
    return values;
  }

  /// The first string of an array of strings: character codes in ASCII, bytes with a zero at the end elsewhere.
  Result<std::string> text_of(pugi::xml_node node) {
    std::string text;
    if (node.attribute("format").value() == std::string_view("ascii")) {
      const auto codes = ascii_array<int>(node.child_value());
      if (!codes) return fail(codes.error());
      for (const int code : *codes) text += static_cast<char>(code > 0 && code < 128 ? code : 0);
    } else {
      auto bytes = content(node);
      if (!bytes) return fail(bytes.error());
      text = std::move(*bytes);
    }
    return text.substr(0, text.find('\0'));
  }

  std::optional<std::size_t> size_from(ByteSource& source) const {
    const auto bytes = source.take(size_of(header_));
    if (!bytes) return std::nullopt;
    return header_ == Scalar::uint64 ? load<std::uint64_t>(bytes->data(), order_)
                                     : load<std::uint32_t>(bytes->data(), order_);
  }

  /// The bytes of an inline or appended binary array: its size, or the sizes of its compressed blocks, then the data.
  /// Every part of the file is taken once: a thousand pieces that name one array would fill the memory.
  Result<std::string> content(pugi::xml_node node) {
    const bool is_appended = node.attribute("format").value() == std::string_view("appended");
    const std::size_t offset = is_appended ? node.attribute("offset").as_ullong() : 0;
    if (offset > (is_appended ? appended_.size() : 0)) return fail(damaged_vtp());
    ByteSource source =
        is_appended ? ByteSource(appended_.substr(offset), appended_base64_) : ByteSource(node.child_value(), true);
    auto bytes = compressed_ ? decompress(source) : plain(source);
    if (!bytes) return bytes;
    if (source.consumed() > encoded_left_) return fail("", "has data arrays that lie in one another; export it again");
    encoded_left_ -= source.consumed();
    decoded_left_ -= std::min(bytes->size(), decoded_left_);
    return bytes;
  }

  Result<std::string> plain(ByteSource& source) const {
    const auto size = size_from(source);
    const auto bytes = size ? source.take(*size) : std::nullopt;
    if (!bytes) return fail(damaged_vtp());
    return std::string(*bytes);
  }

  Result<std::string> decompress(ByteSource& source) const {
    const auto blocks = size_from(source), block_size = size_from(source), last_size = size_from(source);
    if (!blocks || !block_size || !last_size) return fail(damaged_vtp());
    std::vector<std::size_t> sizes;
    for (std::size_t b = 0; b < *blocks; ++b) {
      const auto size = size_from(source);
      if (!size) return fail(damaged_vtp());
      sizes.push_back(*size);
    }
    std::string all;
    for (std::size_t b = 0; b < sizes.size(); ++b) {
      const auto packed = source.take(sizes[b]);
      const std::size_t size = b + 1 == sizes.size() && *last_size > 0 ? *last_size : *block_size;
      // zlib packs at most 1,032 to 1: more is a damaged size, not worth the memory
      if (!packed || size > 1040 * (packed->size() + 64)) return fail(damaged_vtp());
      if (size > decoded_left_ - all.size())
        return fail("", "unpacks to far more than a mesh of its size; export it again");
      const std::size_t start = all.size();
      all.resize(start + size);
      uLongf unpacked = size;
      if (uncompress(reinterpret_cast<Bytef*>(all.data() + start), &unpacked,
                     reinterpret_cast<const Bytef*>(packed->data()), packed->size()) != Z_OK ||
          unpacked != size)
        return fail(damaged_vtp());
    }
    return all;
  }

  pugi::xml_document document_;
  std::string_view appended_;
  bool appended_base64_ = false, compressed_ = false;
  std::endian order_ = std::endian::little;
  Scalar header_ = Scalar::uint32;
  std::vector<double> coordinates_;
  std::map<std::string, std::vector<double>> arrays_;  ///< of one value a vertex
  Faces faces_;
  std::size_t encoded_left_ = 0, decoded_left_ = 0;  ///< of bytes that may still be taken
};

Result<MeshFile> read_vtp(std::string_view bytes) {
  return VtpReader().read(bytes);
}

void write_vtp(const MeshFile& mesh, std::ostream& out) {
  std::string data;
  const auto append = [&data](const auto& values) {
    using T = typename std::decay_t<decltype(values)>::value_type;
    const std::size_t offset = data.size();
    store(static_cast<std::uint64_t>(values.size() * sizeof(T)), std::endian::little, data);
    for (const T value : values) store(value, std::endian::little, data);
    return std::to_string(offset);
  };
  const auto points = append(std::vector<double>(mesh.points.data(), mesh.points.data() + mesh.points.size()));
  const auto corners =
      append(std::vector<std::int32_t>(mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size()));
  std::vector<std::int32_t> ends;
  for (std::int32_t f = 1; f <= mesh.triangles.rows(); ++f) ends.push_back(3 * f);
  const auto offsets = append(ends);
  std::string point_data;
  for (const auto& [name, values] : vertex_arrays(mesh))
    point_data += "<DataArray type=\"Float32\" Name=\"" + name + "\" format=\"appended\" offset=\"" +
                  append(std::vector<float>(values.begin(), values.end())) + "\"/>\n";
  if (!point_data.empty()) point_data = "<PointData>\n" + point_data + "</PointData>\n";
  out << "<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
         "<PolyData>\n<FieldData>\n"
         "<DataArray type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">76 80 83 0</DataArray>\n"
      << record_of_vtp(mesh.record) << "</FieldData>\n<Piece NumberOfPoints=\"" << mesh.points.rows()
      << "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" << mesh.triangles.rows()
      << "\">\n"
      << point_data
      << "<Points>\n<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\" "
         "offset=\""
      << points
      << "\"/>\n</Points>\n<Polys>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"appended\" offset=\""
      << corners << "\"/>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"appended\" offset=\"" << offsets
      << "\"/>\n</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
  out.write(data.data(), static_cast<std::streamsize>(data.size()));
  out << "\n</AppendedData>\n</VTKFile>\n";
}

}  // namespace

Result<VtpLines> vtp_lines(std::string_view bytes) {
  return VtpReader().lines(bytes);
}

const MeshFormat vtp{.name = "VTP", .extension = ".vtp", .keeps_record = true, .read = read_vtp, .write = write_vtp};

}  // namespace homolog::formats
