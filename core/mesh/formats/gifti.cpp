#include <zlib.h>

#include <array>
#include <pugixml.hpp>

#include "core/base/encoding/base64.h"
#include "core/base/files/files.h"
#include "core/base/text/text.h"
#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/text.h"

namespace homolog::formats {
namespace {

Error damaged_gifti() {
  return {"", "is truncated or its data are damaged; copy or export it again"};
}

std::optional<Scalar> gifti_scalar(std::string_view name) {
  constexpr std::string_view begin = "NIFTI_TYPE_";
  if (!name.starts_with(begin)) return std::nullopt;
  constexpr std::array names{"INT8",   "UINT8", "INT16",  "UINT16",  "INT32",
                             "UINT32", "INT64", "UINT64", "FLOAT32", "FLOAT64"};
  const auto at = std::find(names.begin(), names.end(), name.substr(begin.size()));
  if (at == names.end()) return std::nullopt;
  return static_cast<Scalar>(at - names.begin());
}

/// The value of a name in an array's MetaData.
std::string_view gifti_note(pugi::xml_node array, std::string_view name) {
  for (const auto entry : array.child("MetaData").children("MD"))
    if (trimmed(entry.child_value("Name")) == name) return trimmed(entry.child_value("Value"));
  return {};
}

std::optional<double> gifti_number(pugi::xml_node array, const std::string& name) {
  return to_number<double>(gifti_note(array, name));
}

/// Exactly `size` bytes that zlib packed, with its own head or that of gzip; none where they are others.
std::optional<std::string> unpacked_gifti(std::string_view packed, std::size_t size) {
  if (size > 1040 * (packed.size() + 64)) return std::nullopt;  // zlib packs no better
  std::string bytes(size, '\0');
  z_stream stream{};
  constexpr int any_head = 15 + 32;
  if (inflateInit2(&stream, any_head) != Z_OK) return std::nullopt;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  const int end = inflate(&stream, Z_FINISH);
  const bool whole = end == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  return whole ? std::optional(std::move(bytes)) : std::nullopt;
}

class GiftiReader {
 public:
  GiftiReader(std::string_view bytes, std::filesystem::path folder) : bytes_(bytes), folder_(std::move(folder)) {}

  Result<MeshFile> read() {
    if (const auto parsed = document_.load_buffer(bytes_.data(), bytes_.size()); !parsed)
      return fail("",
                  "is no whole GIFTI file (XML: " + std::string(parsed.description()) + "); copy or export it again");
    if (!document_.child("GIFTI")) return fail("", "is no GIFTI file; check its extension");
    const auto points = array_of("NIFTI_INTENT_POINTSET"), faces = array_of("NIFTI_INTENT_TRIANGLE");
    if (!points) return fail(points.error());
    if (!faces) return fail(faces.error());
    auto coordinates = values<double>(*points);
    if (!coordinates) return fail(coordinates.error());
    const auto corners = values<std::int64_t>(*faces);
    if (!corners) return fail(corners.error());
    MeshFile mesh;
    Faces triangles;
    for (std::size_t i = 0; i + 3 <= corners->size(); i += 3)
      if (auto added = triangles.add(std::span(*corners).subspan(i, 3)); !added) return fail(added.error());
    if (auto filled = std::move(triangles).fill(mesh, std::move(*coordinates)); !filled) return fail(filled.error());
    if (auto placed = place(*points, mesh); !placed) return fail(placed.error());
    mesh.points.leftCols<2>() *= -1;  // GIFTI is RAS
    return mesh;
  }

 private:
  Result<pugi::xml_node> array_of(std::string_view intent) const {
    pugi::xml_node found;
    for (const auto node : document_.child("GIFTI").children("DataArray")) {
      if (node.attribute("Intent").value() != intent) continue;
      if (found) return fail("", "holds several surfaces; save each in a file of its own");
      found = node;
    }
    if (!found)
      return fail("", "holds no surface (" + std::string(intent) +
                          " is missing), as .shape.gii and .label.gii hold none; give the .surf.gii it belongs to");
    return found;
  }

  /// The values of an array of three columns, row by row.
  template <class To>
  Result<std::vector<To>> values(pugi::xml_node node) const {
    const auto rows = node.attribute("Dim0").as_ullong();
    if (node.attribute("Dimensionality").as_int() != 2 || node.attribute("Dim1").as_int() != 3 || rows == 0)
      return fail("", "has points or triangles that are no rows of three; export it again");
    const auto type = gifti_scalar(node.attribute("DataType").value());
    if (!type || (std::is_integral_v<To> && !is_integer(*type)))
      return fail("", "has a data array of an unsuited type; export it again");
    const std::string_view encoding = node.attribute("Encoding").value();
    auto read = encoding == "ASCII" ? from_text<To>(node, rows) : from_bytes<To>(node, encoding, *type, rows);
    if (!read || node.attribute("ArrayIndexingOrder").value() != std::string_view("ColumnMajorOrder")) return read;
    std::vector<To> by_rows(read->size());
    for (std::size_t i = 0; i < by_rows.size(); ++i) by_rows[i] = (*read)[i % 3 * rows + i / 3];
    return by_rows;
  }

  template <class To>
  static Result<std::vector<To>> from_text(pugi::xml_node node, std::size_t rows) {
    std::vector<To> values;
    Text text(node.child_value("Data"));
    for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
      const auto value = to_number<To>(word);
      if (!value) return fail(damaged_gifti());
      values.push_back(*value);
    }
    if (values.size() / 3 != rows || values.size() % 3 != 0) return fail(wrong_count());
    return values;
  }

  static Error wrong_count() {
    return {"", "announces another number of points or triangles than it holds; export it again"};
  }

  template <class To>
  Result<std::vector<To>> from_bytes(pugi::xml_node node, std::string_view encoding, Scalar type,
                                     std::size_t rows) const {
    if (rows > std::size_t{1} << 31) return fail(damaged_gifti());
    const auto bytes = content(node, encoding, 3 * rows * size_of(type));
    if (!bytes) return fail(bytes.error());
    const bool big = node.attribute("Endian").value() == std::string_view("BigEndian");
    return load_all<To>(*bytes, type, big ? std::endian::big : std::endian::little);
  }

  Result<std::string> content(pugi::xml_node node, std::string_view encoding, std::size_t size) const {
    if (encoding == "ExternalFileBinary") return external(node, size);
    const std::string_view text = node.child_value("Data");
    if (encoding != "Base64Binary" && encoding != "GZipBase64Binary")
      return fail("", "is encoded as " + excerpt(encoding) + ", which no GIFTI file is; export it again");
    const auto decoded = from_base64(without_blanks(text));
    const std::string bytes(decoded.begin(), decoded.end());
    if (encoding == "GZipBase64Binary") {
      if (size > (std::size_t{16} << 20) + 100 * bytes_.size())
        return fail("", "unpacks to far more than a mesh of its size; export it again");
      auto whole = unpacked_gifti(bytes, size);
      return whole ? Result<std::string>(std::move(*whole)) : fail(damaged_gifti());
    }
    return bytes.size() == size ? Result<std::string>(bytes) : fail(wrong_count());
  }

  static std::string without_blanks(std::string_view text) {
    std::string tight;
    for (const char c : text)
      if (!is_space(c)) tight += c;
    return tight;
  }

  /// From a file beside this one.
  Result<std::string> external(pugi::xml_node node, std::size_t size) const {
    const std::string name = node.attribute("ExternalFileName").value();
    if (!is_file_name(name))
      return fail("", "keeps its numbers in \"" + excerpt(name) + "\", which is no file beside it; put it there");
    const auto bytes = read_whole_file(folder_ / name);
    if (!bytes) return fail("", "keeps its numbers in another file: " + bytes.error().sentence());
    const auto offset = node.attribute("ExternalFileOffset").as_ullong();
    if (offset > bytes->size() || size > bytes->size() - offset)
      return fail("", "keeps its numbers in " + excerpt(name) + ", which is too short; copy both again");
    return bytes->substr(offset, size);
  }

  /// Errors: a matrix that takes points nowhere, or not all alike.
  static Result<void> check_affine(const Eigen::Matrix4d& matrix) {
    constexpr double nothing = 1e-6;
    const Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
    const Eigen::RowVector4d last(0, 0, 0, 1);
    const bool affine = (matrix.row(3) - last).cwiseAbs().maxCoeff() <= nothing,
               flat = std::abs(turn.determinant()) <= nothing * turn.colwise().norm().prod();
    if (matrix.allFinite() && affine && !flat) return {};
    return fail("", std::string("has a matrix of its space that ") +
                        (!matrix.allFinite() ? "holds no finite numbers"
                         : !affine           ? "is not affine (its last row is not 0 0 0 1)"
                                             : "is singular, so that all points would lie in a plane") +
                        "; export it again");
  }

  /// Takes each point x to turn·x + shift. A mirror image has its faces reversed, so that they are seen from outside.
  static void move(const Eigen::Matrix3d& turn, const Vec3& shift, MeshFile& mesh) {
    mesh.points = (mesh.points * turn.transpose()).rowwise() + shift.transpose();
    if (turn.determinant() > 0) return;
    Triangles reversed = *mesh.triangles;
    reversed.col(1).swap(reversed.col(2));
    mesh.triangles = SharedTriangles(std::move(reversed));
  }

  /// Moves the points from the file's own space to that of the scan, where the file tells how.
  static Result<void> place(pugi::xml_node array, MeshFile& mesh) {
    bool in_scanner = false, in_standard = false;
    const std::string_view scanner = "NIFTI_XFORM_SCANNER_ANAT";
    pugi::xml_node to_scanner;
    for (const auto system : array.children("CoordinateSystemTransformMatrix")) {
      const std::string_view space = trimmed(system.child_value("DataSpace"));
      const bool standard = space == "NIFTI_XFORM_TALAIRACH" || space == "NIFTI_XFORM_MNI_152";
      in_scanner = in_scanner || space == scanner;
      in_standard = in_standard || (standard && space == trimmed(system.child_value("TransformedSpace")));
      if (!to_scanner && trimmed(system.child_value("TransformedSpace")) == scanner) to_scanner = system;
    }
    if (in_scanner || (in_standard && !to_scanner)) return {};
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    if (to_scanner) {
      Text numbers(to_scanner.child_value("MatrixData"));
      for (double& value : matrix.reshaped<Eigen::RowMajor>()) {
        const auto number = numbers.number<double>();
        if (!number) return fail("", "has a matrix of its space that is no 16 numbers; export it again");
        value = *number;
      }
    }
    if (auto usable = check_affine(matrix); !usable) return fail(usable.error());
    if (matrix.isIdentity()) {
      place_by_scan(array, mesh);
      return {};
    }
    move(matrix.topLeftCorner<3, 3>(), matrix.topRightCorner<3, 1>(), mesh);
    mesh.warnings.emplace_back("its points were moved to the scanner's space, as its matrix says");
    return {};
  }

  /// FreeSurfer's surfaces lie about the middle of their scan. Its axes and its middle are notes of the array. Nothing
  /// is moved where there are none. Source: `tkregister` coordinates, x_scan = C Tᵀ x + c, where the columns of C are
  /// the scan's axes, those of T are what FreeSurfer takes for them, and c is its middle.
  static void place_by_scan(pugi::xml_node array, MeshFile& mesh) {
    Eigen::Matrix3d axes, taken;
    Vec3 middle;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        const auto value = gifti_number(array, std::string("VolGeom") + "XYZC"[column] + "_" + "RAS"[row]);
        if (!value || !std::isfinite(*value)) return;
        (column < 3 ? axes(row, column) : middle[row]) = *value;
      }
    }
    taken << -1, 0, 0, 0, 0, 1, 0, -1, 0;
    const Eigen::Matrix3d turn = axes * taken.transpose();
    if (turn.isIdentity(1e-9) && middle.isZero()) return;
    move(turn, middle, mesh);
    mesh.warnings.emplace_back(
        "lies in FreeSurfer's coordinates about the middle of a scan, and was moved to where that scan lies; if "
        "mris_convert --to-scanner made it, remove its VolGeom notes, since it lay there already");
  }

  std::string_view bytes_;
  std::filesystem::path folder_;
  pugi::xml_document document_;
};

Result<MeshFile> read_gifti_beside(std::string_view bytes, const std::filesystem::path& folder) {
  return GiftiReader(bytes, folder).read();
}
Result<MeshFile> read_gifti(std::string_view bytes) {
  return read_gifti_beside(bytes, {});
}

/// An array of three columns, packed. `space`: the node of its space, or nothing.
void write_gifti_array(const char* intent, const char* type, const std::string& bytes, Eigen::Index rows,
                       const char* space, std::ostream& out) {
  uLongf size = compressBound(bytes.size());
  std::vector<unsigned char> packed(size);
  compress(packed.data(), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  packed.resize(size);
  out << "<DataArray Intent=\"" << intent << "\" DataType=\"" << type
      << "\" ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Dim0=\"" << rows
      << "\" Dim1=\"3\" Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\" ExternalFileName=\"\" "
         "ExternalFileOffset=\"\">\n<MetaData></MetaData>\n"
      << space << "<Data>" << to_base64(packed) << "</Data>\n</DataArray>\n";
}

void write_gifti(const MeshFile& mesh, std::ostream& out) {
  std::string points, corners;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    for (int k = 0; k < 3; ++k)
      store(static_cast<float>(k < 2 ? -mesh.points(i, k) : mesh.points(i, k)), std::endian::little, points);
  for (const std::int32_t v : mesh.triangles->reshaped<Eigen::RowMajor>()) store(v, std::endian::little, corners);
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n"
         "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n<MetaData></MetaData>\n<LabelTable></LabelTable>\n";
  write_gifti_array("NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32", points, mesh.points.rows(),
                    "<CoordinateSystemTransformMatrix>\n<DataSpace>NIFTI_XFORM_SCANNER_ANAT</DataSpace>\n"
                    "<TransformedSpace>NIFTI_XFORM_SCANNER_ANAT</TransformedSpace>\n"
                    "<MatrixData>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</MatrixData>\n</CoordinateSystemTransformMatrix>\n",
                    out);
  write_gifti_array("NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", corners, mesh.triangles.rows(), "", out);
  out << "</GIFTI>\n";
}

}  // namespace

const MeshFormat gifti{.name = "GIFTI",
                       .extension = ".gii",
                       .note =
                           "surfaces (.surf.gii), in every encoding; in single precision and RAS, as others have "
                           "them. FreeSurfer's are moved to where their scan lies",
                       .read = read_gifti,
                       .read_with_others = read_gifti_beside,
                       .write = write_gifti};

}  // namespace homolog::formats
