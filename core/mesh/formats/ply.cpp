#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "core/base/text/text.h"
#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/ply_comments.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/space.h"
#include "core/mesh/formats/text.h"

namespace homolog::formats {
namespace {

struct Property {
  std::string_view name;
  Scalar type = Scalar::float32;
  std::optional<Scalar> length_type;  ///< the type of a list's length
};

struct Element {
  std::string_view name;
  std::size_t count = 0;
  std::vector<Property> properties;

  std::optional<std::size_t> find(std::string_view property) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
      if (properties[i].name == property) return i;
    return std::nullopt;
  }
};

enum class Encoding { ascii, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::vector<std::string_view> comments;
};

std::optional<Scalar> scalar_named(std::string_view name) {
  if (name == "char" || name == "int8") return Scalar::int8;
  if (name == "uchar" || name == "uint8") return Scalar::uint8;
  if (name == "short" || name == "int16") return Scalar::int16;
  if (name == "ushort" || name == "uint16") return Scalar::uint16;
  if (name == "int" || name == "int32") return Scalar::int32;
  if (name == "uint" || name == "uint32") return Scalar::uint32;
  if (name == "float" || name == "float32") return Scalar::float32;
  if (name == "double" || name == "float64") return Scalar::float64;
  return std::nullopt;
}

Result<Property> read_property(Text& words) {
  Property property;
  std::string_view type = words.word();
  if (type == "list") {
    property.length_type = scalar_named(words.word());
    if (!property.length_type || !is_integer(*property.length_type))
      return fail("", "has a list property whose length is no integer; export it again");
    type = words.word();
  }
  const auto scalar = scalar_named(type);
  property.name = words.word();
  if (!scalar || property.name.empty())
    return fail("", "has a property of unknown type \"" + excerpt(type) + "\"; export it again");
  property.type = *scalar;
  return property;
}

// Far more than any mesh has; each is compared with all before it.
constexpr std::size_t most_elements = 100, most_properties = 1000;

Error twice(const char* kind, std::string_view name) {
  return {"", std::string("has the ") + kind + " \"" + excerpt(name) + "\" twice in its header; export it again"};
}

Result<void> read_header_line(std::string_view line, Header& header) {
  Text words(line);
  const std::string_view key = words.word();
  if (key == "comment") {
    header.comments.push_back(line.substr(std::min(line.find("comment") + 8, line.size())));
  } else if (key == "format") {
    const std::string_view encoding = words.word();
    if (encoding == "binary_little_endian")
      header.encoding = Encoding::little_endian;
    else if (encoding == "binary_big_endian")
      header.encoding = Encoding::big_endian;
    else if (encoding != "ascii")
      return fail("", "has an unknown PLY format; save it as ASCII or binary PLY 1.0");
  } else if (key == "element") {
    const std::string_view name = words.word();
    const auto count = words.number<std::size_t>();
    if (!count) return fail("", "has an element without a count in its header; export it again");
    for (const Element& before : header.elements)
      if (before.name == name) return fail(twice("element", name));
    if (header.elements.size() == most_elements)
      return fail("", "has more kinds of elements than a mesh has; export it again");
    header.elements.push_back({name, *count, {}});
  } else if (key == "property") {
    if (header.elements.empty()) return fail("", "has a property before any element in its header; export it again");
    auto property = read_property(words);
    if (!property) return fail(property.error());
    auto& properties = header.elements.back().properties;
    if (header.elements.back().find(property->name)) return fail(twice("property", property->name));
    if (properties.size() == most_properties) return fail("", "has more properties than a mesh has; export it again");
    properties.push_back(*property);
  } else if (key != "obj_info" && !key.empty()) {
    return fail("", "has a header line that PLY does not know (\"" + excerpt(key) + "\"); export it again");
  }
  return {};
}

Result<Header> read_header(Text& text) {
  if (text.line() != "ply") return fail("", "is not a PLY file (it does not begin with \"ply\"); check its extension");
  Header header;
  while (text.remaining() > 0) {
    const std::string_view line = text.line();
    if (line == "end_header") return header;
    if (auto read = read_header_line(line, header); !read) return fail(read.error());
  }
  return fail("", "is truncated within its header; copy or export it again");
}

class BinarySource {
 public:
  BinarySource(Text& text, std::endian order) : text_(text), order_(order) {}
  std::optional<double> next(Scalar type) {
    const auto bytes = text_.take(size_of(type));
    if (!bytes) return std::nullopt;
    return with_type(
        type, [&]<class T>(std::type_identity<T>) { return static_cast<double>(load<T>(bytes->data(), order_)); });
  }
  static std::size_t smallest_size(Scalar type) { return size_of(type); }

 private:
  Text& text_;
  std::endian order_;
};

class AsciiSource {
 public:
  explicit AsciiSource(Text& text) : text_(text) {}
  std::optional<double> next(Scalar) { return text_.number<double>(); }
  static std::size_t smallest_size(Scalar) { return 1; }

 private:
  Text& text_;
};

struct Body {
  std::vector<double> coordinates;
  std::map<std::string, VertexScalars, std::less<>> values;  ///< values of every other property, by name
  Faces faces;
};

Error truncated() {
  return {"", "is truncated or holds something that is no number; copy or export it again"};
}

/// Whether the rest of the file can hold an element's records.
template <class Source>
Result<void> check_room(const Element& element, const Text& text) {
  std::size_t record_size = 0;
  for (const Property& p : element.properties) record_size += Source::smallest_size(p.length_type.value_or(p.type));
  if (record_size == 0 || element.count <= text.remaining() / record_size) return {};
  return fail("", "announces " + std::to_string(element.count) + " records of \"" + excerpt(element.name) +
                      "\" but is too short to hold them; copy or export it again");
}

/// One element's records; `keep(property, values)` is called with the values of each property of each record.
template <class Source, class Keep>
Result<void> read_records(const Element& element, Text& text, Source& source, const Keep& keep) {
  if (element.properties.empty()) return {};
  if (auto fits = check_room<Source>(element, text); !fits) return fits;
  std::vector<double> values;
  for (std::size_t record = 0; record < element.count; ++record) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      double count = 1;
      if (property.length_type) {
        const auto length = source.next(*property.length_type);
        if (!length || !(*length >= 0) || *length > static_cast<double>(text.remaining())) return fail(truncated());
        count = *length;
      }
      values.clear();
      for (double i = 0; i < count; ++i) {
        const auto value = source.next(property.type);
        if (!value) return fail(truncated());
        values.push_back(*value);
      }
      if (auto kept = keep(p, values); !kept) return kept;
    }
  }
  return {};
}

template <class Source>
Result<void> read_vertices(const Element& element, Text& text, Source& source, Body& body) {
  const auto x = element.find("x"), y = element.find("y"), z = element.find("z");
  for (const auto& found : {x, y, z})
    if (!found || element.properties[*found].length_type)
      return fail("", "has vertices without coordinates x, y and z; export it again");
  if (auto fits = check_room<Source>(element, text); !fits) return fits;
  // One column a property: room for all vertices, which fit into the file.
  std::vector<VertexScalars*> columns(element.properties.size());
  for (std::size_t p = 0; p < columns.size(); ++p)
    if (p != x && p != y && p != z && !element.properties[p].length_type) {
      columns[p] = &body.values[std::string(element.properties[p].name)];
      columns[p]->resize(static_cast<Eigen::Index>(element.count));
    }
  Vec3 point = Vec3::Zero();
  Eigen::Index vertex = 0;
  const std::size_t last = element.properties.size() - 1;
  body.coordinates.reserve(3 * element.count);
  return read_records(element, text, source, [&](std::size_t property, const std::vector<double>& values) {
    if (property == x) point.x() = values[0];
    if (property == y) point.y() = values[0];
    if (property == z) point.z() = values[0];
    if (columns[property] != nullptr) (*columns[property])[vertex] = values[0];
    if (property == last) {
      body.coordinates.insert(body.coordinates.end(), point.begin(), point.end());
      ++vertex;
    }
    return Result<void>();
  });
}

template <class Source>
Result<void> read_faces(const Element& element, Text& text, Source& source, Body& body) {
  auto list = element.find("vertex_indices");
  if (!list) list = element.find("vertex_index");
  if (!list || !element.properties[*list].length_type || !is_integer(element.properties[*list].type))
    return fail("", "has faces without a list of integers \"vertex_indices\"; export it again");
  std::vector<std::int64_t> polygon;
  return read_records(element, text, source, [&](std::size_t property, const std::vector<double>& values) {
    if (property != list) return Result<void>();
    polygon.clear();
    for (const double v : values) {
      if (!(std::abs(v) < 1e15) || v != std::trunc(v))
        return Result<void>(fail("", "names a vertex by something that is no whole number; export it again"));
      polygon.push_back(static_cast<std::int64_t>(v));
    }
    return body.faces.add(polygon);
  });
}

template <class Source>
Result<Body> read_body(const Header& header, Text& text, Source source) {
  Body body;
  for (const Element& element : header.elements) {
    auto read = element.name == "vertex" ? read_vertices(element, text, source, body)
                : element.name == "face"
                    ? read_faces(element, text, source, body)
                    : read_records(element, text, source, [](std::size_t, const auto&) { return Result<void>(); });
    if (!read) return fail(read.error());
  }
  return body;
}

std::uint8_t region_index(double value) {
  return static_cast<std::uint8_t>(value >= 0 && value <= 255 ? value : 0);
}

/// Indices without a region in the header belong to none; without any region they mean nothing.
void settle_regions(MeshFile& mesh) {
  auto& [list, of_vertex] = mesh.regions;
  if (list.empty())
    of_vertex.clear();
  else if (of_vertex.empty())
    of_vertex.assign(static_cast<std::size_t>(mesh.points.rows()), 0);
  for (auto& region : of_vertex)
    if (region > list.size()) region = 0;
}

/// A factor in the file's precision: neither infinite nor zero, which would be refused on reading.
float as_stiffness(double factor) {
  return static_cast<float>(
      std::clamp<double>(factor, std::numeric_limits<float>::min(), std::numeric_limits<float>::max()));
}

Result<MeshFile> read_ply(std::string_view bytes) {
  Text text(bytes);
  auto header = read_header(text);
  if (!header) return fail(header.error());
  const bool ascii = header->encoding == Encoding::ascii;
  const std::endian order = header->encoding == Encoding::big_endian ? std::endian::big : std::endian::little;
  auto body = ascii ? read_body(*header, text, AsciiSource(text)) : read_body(*header, text, BinarySource(text, order));
  if (!body) return fail(body.error());

  MeshFile mesh;
  if (auto filled = std::move(body->faces).fill(mesh, std::move(body->coordinates)); !filled)
    return fail(filled.error());
  for (auto& [name, values] : body->values) {
    if (name == "stiffness")
      mesh.stiffness = std::make_shared<const VertexScalars>(std::move(values));
    else if (const FitValue* said = fit_value(name))
      mesh.*said->of = std::move(values);
    else if (name == "region")
      for (const double value : values) mesh.regions.of_vertex.push_back(region_index(value));
    else
      mesh.arrays.emplace(name, std::move(values));
  }
  SpaceNames space;
  for (const std::string_view comment : header->comments)
    if (comment.starts_with("homolog.") || !space.look_in(comment)) keep_comment(comment, mesh);
  settle_regions(mesh);
  space.apply_to(mesh);
  if (ascii) warn_if_cut(text, mesh.warnings);
  if (ascii ? !text.word().empty() : text.remaining() > 2)
    mesh.warnings.emplace_back("the file holds more than its header announces; compare it with its source");
  return mesh;
}

void write_ply(const MeshFile& mesh, std::ostream& out) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment SPACE=LPS\n";
  write_comments(mesh, bytes);
  bytes += "element vertex " + std::to_string(mesh.points.rows()) +
           "\nproperty double x\nproperty double y\nproperty double z\n";
  if (mesh.stiffness) bytes += "property float stiffness\n";
  for (const FitValue& value : fit_values)
    if (mesh.*value.of) bytes += std::string("property ") + (value.is_mark ? "uchar " : "float ") + value.name + "\n";
  const bool regions = !mesh.regions.list.empty();
  if (regions) bytes += "property uchar region\n";
  for (const auto& [name, values] : mesh.values) bytes += "property float " + name + "\n";
  bytes += "element face " + std::to_string(mesh.triangles.rows()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    for (const double x : mesh.points.row(i)) store(x, std::endian::little, bytes);
    if (mesh.stiffness) store(as_stiffness((*mesh.stiffness)[i]), std::endian::little, bytes);
    for (const FitValue& value : fit_values) {
      const auto& values = mesh.*value.of;
      if (values && value.is_mark) store(static_cast<std::uint8_t>((*values)[i] > 0), std::endian::little, bytes);
      if (values && !value.is_mark) store(static_cast<float>((*values)[i]), std::endian::little, bytes);
    }
    if (regions) store(mesh.regions.of_vertex[i], std::endian::little, bytes);
    for (const auto& [name, values] : mesh.values) store(static_cast<float>(values[i]), std::endian::little, bytes);
  }
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    store(std::uint8_t{3}, std::endian::little, bytes);
    for (const std::int32_t v : mesh.triangles.row(f)) store(v, std::endian::little, bytes);
  }
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

const MeshFormat ply{.name = "PLY",
                     .extension = ".ply",
                     .note = "what a template is written as: it keeps stiffness, regions and landmarks",
                     .keeps_template = true,
                     .keeps_record = true,
                     .read = read_ply,
                     .write = write_ply};

}  // namespace homolog::formats
