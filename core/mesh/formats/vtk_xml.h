#pragma once

#include <bit>
#include <cstdint>
#include <map>
#include <ostream>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/numbers/scalar.h"
#include "core/mesh/formats/byte_source.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/space.h"
#include "core/mesh/mesh_io.h"

namespace homolog::formats {

/// The refusal of a file of VTK's XML formats whose data are cut or damaged.
Error damaged_vtk_xml();

/// A file of VTK's XML formats (VTP, VTU): its tree, and its data arrays in text, base64 or raw bytes, compressed by
/// zlib or not.
class VtkXml {
 public:
  /// `bytes` of a whole file outlive this. `kind`: "PolyData" or "UnstructuredGrid". Errors: no XML, another kind, a
  /// compression that is not zlib.
  Result<void> parse(std::string_view bytes, const char* kind);

  /// The node of the kind, which holds the pieces.
  pugi::xml_node grid() const { return document_.child("VTKFile").child(kind_); }
  /// The values of a DataArray. Errors: absent, damaged, real numbers where indices belong.
  template <class To>
  Result<std::vector<To>> array(pugi::xml_node node);
  /// Appends the points of a piece.
  Result<void> add_points(pugi::xml_node piece, std::vector<double>& coordinates);
  /// Keeps the arrays of one value a vertex. If there are several pieces, an array counts that each of them has.
  void add_vertex_arrays(pugi::xml_node piece, std::int64_t first_vertex);
  /// Those that have a value for each of `vertices` vertices.
  std::map<std::string, VertexScalars> vertex_values(Eigen::Index vertices) const;
  /// The space that the file names.
  Result<SpaceNames> space();

 private:
  Result<std::string> text_of(pugi::xml_node node);
  std::optional<std::size_t> size_from(ByteSource& source) const;
  Result<std::string> content(pugi::xml_node node);
  Result<std::string> plain(ByteSource& source) const;
  Result<std::string> decompress(ByteSource& source) const;

  const char* kind_ = "";
  pugi::xml_document document_;
  std::string_view appended_;
  bool appended_base64_ = false, compressed_ = false;
  std::endian order_ = std::endian::little;
  Scalar header_ = Scalar::uint32;
  std::map<std::string, std::vector<double>> arrays_;  ///< arrays with one value a vertex
  std::size_t encoded_left_ = 0, decoded_left_ = 0;    ///< bytes that may still be taken
};

/// The data of a file that is written, appended to it as raw bytes.
class VtkXmlData {
 public:
  /// Appends an array. Gives its offset, as the DataArray names it.
  template <class T>
  std::string append(const T* values, std::ptrdiff_t count) {
    const std::size_t offset = bytes_.size();
    store(static_cast<std::uint64_t>(count) * sizeof(T), std::endian::little, bytes_);
    for (const T* value = values; value != values + count; ++value) store(*value, std::endian::little, bytes_);
    return std::to_string(offset);
  }
  /// Appends what a mesh has for each vertex. Gives the node of point data, empty where it has nothing.
  std::string vertex_values(const MeshFile& mesh);
  /// The begin of a file: its root, the node of the kind, and the fields SPACE and record.
  static std::string head(const std::string& kind, const std::string& record);
  /// The end of a file, behind the node of the kind.
  void write_to(std::ostream& out) const;

 private:
  std::string bytes_;
};

}  // namespace homolog::formats
