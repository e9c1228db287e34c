#include "core/base/numbers/limits.h"
#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/vertex_arrays.h"
#include "core/mesh/formats/vtk_xml.h"
#include "core/mesh/formats/vtp_lines.h"

namespace homolog::formats {
namespace {

class VtpReader {
 public:
  Result<MeshFile> read(std::string_view bytes) {
    if (auto parsed = xml_.parse(bytes, "PolyData"); !parsed) return fail(parsed.error());
    for (const auto piece : xml_.grid().children("Piece"))
      if (auto read = read_piece(piece); !read) return fail(read.error());
    MeshFile mesh;
    if (auto filled = std::move(faces_).fill(mesh, std::move(coordinates_)); !filled) return fail(filled.error());
    for (auto& [name, values] : xml_.vertex_values(mesh.points.rows())) keep_vertex_array(name, values, mesh);
    if (auto placed = take_space(mesh); !placed) return fail(placed.error());
    return mesh;
  }

  Result<VtpLines> lines(std::string_view bytes) {
    if (auto parsed = xml_.parse(bytes, "PolyData"); !parsed) return fail(parsed.error());
    VtpLines lines;
    for (const auto piece : xml_.grid().children("Piece")) {
      const auto first_vertex = static_cast<std::int64_t>(coordinates_.size() / 3);
      if (auto read = xml_.add_points(piece, coordinates_); !read) return fail(read.error());
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
    const auto space = xml_.space();
    if (!space) return fail(space.error());
    space->apply_to(mesh);
    return {};
  }

  Result<void> read_lines(pugi::xml_node piece, std::int64_t first_vertex,
                          std::vector<std::vector<std::int64_t>>& lines) {
    const auto count = piece.attribute("NumberOfLines").as_ullong();
    if (count == 0) return {};
    const auto cells = piece.child("Lines");
    const auto connectivity =
        xml_.array<std::int64_t>(cells.find_child_by_attribute("DataArray", "Name", "connectivity"));
    if (!connectivity) return fail(connectivity.error());
    const auto ends = xml_.array<std::int64_t>(cells.find_child_by_attribute("DataArray", "Name", "offsets"));
    if (!ends) return fail(ends.error());
    const auto all = static_cast<std::int64_t>(connectivity->size());
    const auto vertices = static_cast<std::int64_t>(coordinates_.size() / 3);
    if (ends->size() != count) return fail("", "announces another number of lines than it holds; export it again");
    std::int64_t from = 0;
    for (const std::int64_t end : *ends) {
      if (end < from || end > all) return fail(damaged_vtk_xml());
      auto& line = lines.emplace_back();
      for (; from < end; ++from) {
        const std::int64_t v = (*connectivity)[from];
        if (v < 0 || v >= vertices - first_vertex)
          return fail("", "has a line through a point that it does not hold; export it again");
        line.push_back(v + first_vertex);
      }
    }
    return {};
  }

  Result<void> read_piece(pugi::xml_node piece) {
    const auto first_vertex = static_cast<std::int64_t>(coordinates_.size() / 3);
    if (auto read = xml_.add_points(piece, coordinates_); !read) return read;
    xml_.add_vertex_arrays(piece, first_vertex);
    if (auto polygons = read_cells(piece, "Polys", "NumberOfPolys", first_vertex); !polygons) return polygons;
    return read_cells(piece, "Strips", "NumberOfStrips", first_vertex);
  }

  Result<void> read_cells(pugi::xml_node piece, const char* name, const char* count_name, std::int64_t first_vertex) {
    const auto count = piece.attribute(count_name).as_ullong();
    if (count == 0) return {};
    const auto cells = piece.child(name);
    auto connectivity = xml_.array<std::int64_t>(cells.find_child_by_attribute("DataArray", "Name", "connectivity"));
    if (!connectivity) return fail(connectivity.error());
    const auto ends = xml_.array<std::int64_t>(cells.find_child_by_attribute("DataArray", "Name", "offsets"));
    if (!ends) return fail(ends.error());
    if (ends->size() != count || ends->back() != static_cast<std::int64_t>(connectivity->size()))
      return fail("", "announces another number of faces than it holds; export it again");
    for (std::int64_t& v : *connectivity)
      if (v >= 0 && v < std::int64_t{1} << 40) v += first_vertex;
    return faces_.add_cells(*ends, *connectivity, name == std::string_view("Strips"));
  }

  VtkXml xml_;
  std::vector<double> coordinates_;
  Faces faces_;
};

Result<MeshFile> read_vtp(std::string_view bytes) {
  return VtpReader().read(bytes);
}

void write_vtp(const MeshFile& mesh, std::ostream& out) {
  VtkXmlData data;
  const std::string points = data.append(mesh.points.data(), mesh.points.size());
  const std::string corners = data.append(mesh.triangles->data(), mesh.triangles.size());
  std::vector<std::int32_t> ends;
  for (std::int32_t f = 1; f <= mesh.triangles.rows(); ++f) ends.push_back(3 * f);
  const std::string offsets = data.append(ends.data(), std::ssize(ends));
  const std::string values = data.vertex_values(mesh);
  out << VtkXmlData::head("PolyData", mesh.record) << "<Piece NumberOfPoints=\"" << mesh.points.rows()
      << "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" << mesh.triangles.rows()
      << "\">\n"
      << values
      << "<Points>\n<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\" "
         "offset=\""
      << points
      << "\"/>\n</Points>\n<Polys>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"appended\" offset=\""
      << corners << "\"/>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"appended\" offset=\"" << offsets
      << "\"/>\n</Polys>\n</Piece>\n</PolyData>\n";
  data.write_to(out);
}

}  // namespace

Result<VtpLines> vtp_lines(std::string_view bytes) {
  return VtpReader().lines(bytes);
}

const MeshFormat vtp{.name = "VTP", .extension = ".vtp", .keeps_record = true, .read = read_vtp, .write = write_vtp};

}  // namespace homolog::formats
