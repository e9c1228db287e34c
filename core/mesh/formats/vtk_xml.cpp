#include "core/mesh/formats/vtk_xml.h"

#include <zlib.h>

#include <algorithm>
#include <array>

#include "core/base/files/file_record.h"
#include "core/base/text/text.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/text.h"
#include "core/mesh/formats/vertex_arrays.h"

namespace homolog::formats {
namespace {

std::optional<Scalar> vtk_xml_scalar(std::string_view name) {
  constexpr std::array names{"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                             "UInt32", "Int64", "UInt64", "Float32", "Float64"};
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) return std::nullopt;
  return static_cast<Scalar>(at - names.begin());
}

/// No mesh packs into a hundredth of its size: more is a bomb.
std::size_t most_decoded(std::size_t file_bytes) {
  return (std::size_t{16} << 20) + 100 * file_bytes;
}

template <class To>
Result<std::vector<To>> ascii_array(std::string_view content) {
  std::vector<To> values;
  Text text(content);
  for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
    const auto value = to_number<To>(word);
    if (!value) return fail(damaged_vtk_xml());
    values.push_back(*value);
  }
  return values;
}

}  // namespace

Error damaged_vtk_xml() {
  return {"", "is truncated or its data arrays are damaged; copy or export it again"};
}

/// Appended data may be raw bytes, which no XML parser takes: they are cut off first.
Result<void> VtkXml::parse(std::string_view bytes, const char* kind) {
  kind_ = kind;
  encoded_left_ = bytes.size();
  decoded_left_ = most_decoded(bytes.size());
  std::string xml;
  if (const std::size_t tag = bytes.find("<AppendedData"); tag != std::string_view::npos) {
    const std::size_t end = bytes.find('>', tag), start = bytes.find('_', end);
    if (start == std::string_view::npos) return fail(damaged_vtk_xml());
    appended_ = bytes.substr(start + 1);
    xml = std::string(bytes.substr(0, end + 1)) + "</AppendedData></VTKFile>";
  } else {
    xml = bytes;
  }
  if (const auto parsed = document_.load_buffer(xml.data(), xml.size()); !parsed)
    return fail(
        "", "is no whole XML file of VTK (XML: " + std::string(parsed.description()) + "); copy or export it again");
  const auto root = document_.child("VTKFile");
  if (root.attribute("type").value() != std::string_view(kind))
    return fail("",
                "holds no surface (its type is not " + std::string(kind) + "); extract the surface and save it again");
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

Result<void> VtkXml::add_points(pugi::xml_node piece, std::vector<double>& coordinates) {
  if (piece.attribute("NumberOfPoints").value() == std::string_view("0")) return {};  // it may lack the array too
  auto points = array<double>(piece.child("Points").child("DataArray"));
  if (!points) return fail(points.error());
  if (points->size() != 3 * piece.attribute("NumberOfPoints").as_ullong())
    return fail("", "announces another number of points than it holds; export it again");
  if (coordinates.empty())
    coordinates = std::move(*points);
  else
    coordinates.insert(coordinates.end(), points->begin(), points->end());
  return {};
}

void VtkXml::add_vertex_arrays(pugi::xml_node piece, std::int64_t first_vertex) {
  // Of several pieces an array counts where each of them has it.
  for (const auto node : piece.child("PointData").children("DataArray")) {
    const auto components = node.attribute("NumberOfComponents").as_ullong(1);
    if (components != 1 || arrays_.size() > 1000) continue;
    auto values = array<double>(node);
    if (!values) continue;  // the surface is whole without it
    auto& all = arrays_[node.attribute("Name").value()];
    if (std::ssize(all) == first_vertex) all.insert(all.end(), values->begin(), values->end());
  }
}

std::map<std::string, VertexScalars> VtkXml::vertex_values(Eigen::Index vertices) const {
  std::map<std::string, VertexScalars> values;
  for (const auto& [name, all] : arrays_)
    if (std::ssize(all) == vertices) values.emplace(name, Eigen::Map<const VertexScalars>(all.data(), std::ssize(all)));
  return values;
}

Result<SpaceNames> VtkXml::space() {
  SpaceNames space;
  // VTK writes strings as <Array>; others as <DataArray>.
  for (const auto field : grid().child("FieldData").children()) {
    if (field.attribute("Name").value() != std::string_view("SPACE")) continue;
    const auto name = text_of(field);
    if (!name) return fail(name.error());
    space.add(*name);
  }
  return space;
}

template <class To>
Result<std::vector<To>> VtkXml::array(pugi::xml_node node) {
  if (!node) return fail("", "lacks a data array of a surface; export it again");
  const auto type = vtk_xml_scalar(node.attribute("type").value());
  if (!type || (std::is_integral_v<To> && !is_integer(*type)))
    return fail("", "has a data array of an unsuited type; export it again");
  if (node.attribute("format").value() == std::string_view("ascii")) return ascii_array<To>(node.child_value());
  const auto bytes = content(node);
  if (!bytes) return fail(bytes.error());
  return load_all<To>(*bytes, *type, order_);
}

template Result<std::vector<double>> VtkXml::array(pugi::xml_node);
template Result<std::vector<std::int64_t>> VtkXml::array(pugi::xml_node);

/// The first string of an array of strings: character codes in ASCII, bytes with a zero at the end elsewhere.
Result<std::string> VtkXml::text_of(pugi::xml_node node) {
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

std::optional<std::size_t> VtkXml::size_from(ByteSource& source) const {
  const auto bytes = source.take(size_of(header_));
  if (!bytes) return std::nullopt;
  return header_ == Scalar::uint64 ? load<std::uint64_t>(bytes->data(), order_)
                                   : load<std::uint32_t>(bytes->data(), order_);
}

/// The bytes of an inline or appended binary array: its size, or the sizes of its compressed blocks, then the data.
/// Every part of the file is taken once: a thousand pieces that name one array would fill the memory.
Result<std::string> VtkXml::content(pugi::xml_node node) {
  const bool is_appended = node.attribute("format").value() == std::string_view("appended");
  const std::size_t offset = is_appended ? node.attribute("offset").as_ullong() : 0;
  if (offset > (is_appended ? appended_.size() : 0)) return fail(damaged_vtk_xml());
  ByteSource source =
      is_appended ? ByteSource(appended_.substr(offset), appended_base64_) : ByteSource(node.child_value(), true);
  auto bytes = compressed_ ? decompress(source) : plain(source);
  if (!bytes) return bytes;
  if (source.consumed() > encoded_left_) return fail("", "has data arrays that lie in one another; export it again");
  encoded_left_ -= source.consumed();
  decoded_left_ -= std::min(bytes->size(), decoded_left_);
  return bytes;
}

Result<std::string> VtkXml::plain(ByteSource& source) const {
  const auto size = size_from(source);
  const auto bytes = size ? source.take(*size) : std::nullopt;
  if (!bytes) return fail(damaged_vtk_xml());
  return std::string(*bytes);
}

Result<std::string> VtkXml::decompress(ByteSource& source) const {
  const auto blocks = size_from(source), block_size = size_from(source), last_size = size_from(source);
  if (!blocks || !block_size || !last_size) return fail(damaged_vtk_xml());
  std::vector<std::size_t> sizes;
  for (std::size_t b = 0; b < *blocks; ++b) {
    const auto size = size_from(source);
    if (!size) return fail(damaged_vtk_xml());
    sizes.push_back(*size);
  }
  std::string all;
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    const auto packed = source.take(sizes[b]);
    const std::size_t size = b + 1 == sizes.size() && *last_size > 0 ? *last_size : *block_size;
    // zlib packs at most 1,032 to 1: more is a damaged size, not worth the memory
    if (!packed || size > 1040 * (packed->size() + 64)) return fail(damaged_vtk_xml());
    if (size > decoded_left_ - all.size())
      return fail("", "unpacks to far more than a mesh of its size; export it again");
    const std::size_t start = all.size();
    all.resize(start + size);
    uLongf unpacked = size;
    if (uncompress(reinterpret_cast<Bytef*>(all.data() + start), &unpacked,
                   reinterpret_cast<const Bytef*>(packed->data()), packed->size()) != Z_OK ||
        unpacked != size)
      return fail(damaged_vtk_xml());
  }
  return all;
}

std::string VtkXmlData::vertex_values(const MeshFile& mesh) {
  std::string nodes;
  for (const auto& [name, values] : vertex_arrays(mesh)) {
    const std::vector<float> narrow(values.begin(), values.end());
    nodes += "<DataArray type=\"Float32\" Name=\"" + name + "\" format=\"appended\" offset=\"" +
             append(narrow.data(), std::ssize(narrow)) + "\"/>\n";
  }
  return nodes.empty() ? nodes : "<PointData>\n" + nodes + "</PointData>\n";
}

std::string VtkXmlData::head(const std::string& kind, const std::string& record) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + kind +
         "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<" + kind +
         ">\n<FieldData>\n"
         "<DataArray type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">76 80 83 0</DataArray>\n" +
         record_of_vtp(record) + "</FieldData>\n";
}

void VtkXmlData::write_to(std::ostream& out) const {
  out << "<AppendedData encoding=\"raw\">\n_";
  out.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  out << "\n</AppendedData>\n</VTKFile>\n";
}

}  // namespace homolog::formats
