#include <algorithm>
#include <array>
#include <cmath>
#include <compare>

#include "core/base/files/file_record.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/text.h"
#include "core/mesh/formats/vertex_arrays.h"
#include "core/mesh/formats/volume_cells.h"
#include "core/mesh/formats/vtk_xml.h"

namespace homolog::formats {
namespace {

/// VTK's numbers of its kinds of cells.
enum VtkCell : std::int64_t {
  vtk_empty = 0,
  vtk_line = 3,
  vtk_poly_line = 4,
  vtk_triangle = 5,
  vtk_strip = 6,
  vtk_polygon = 7,
  vtk_pixel = 8,
  vtk_quad = 9,
  vtk_tetrahedron = 10,
};

std::string name_of_vtk_cell(std::int64_t kind) {
  switch (kind) {
    case 11:
      return "voxels";
    case 12:
      return "hexahedra";
    case 13:
      return "wedges";
    case 14:
      return "pyramids";
    case 41:
    case 42:
      return "polyhedra";
    default:
      return kind > 20 ? "curved elements" : "elements of kind " + std::to_string(kind);
  }
}

Result<void> add_vtk_cell(std::int64_t kind, std::span<const std::int64_t> corners, VolumeCells& cells) {
  if (kind >= vtk_empty && kind <= vtk_poly_line) return {};
  if (kind == vtk_strip) {
    const auto end = static_cast<std::int64_t>(corners.size());
    return cells.faces.add_cells({&end, 1}, corners, true);
  }
  if (kind == vtk_pixel && corners.size() == 4)
    return cells.faces.add(std::array{corners[0], corners[1], corners[3], corners[2]});
  if (kind == vtk_tetrahedron && corners.size() == 4) return add_tetrahedron(corners.data(), cells);
  const bool fits =
      kind == vtk_polygon || (kind == vtk_triangle && corners.size() == 3) || (kind == vtk_quad && corners.size() == 4);
  if (fits) return cells.faces.add(corners);
  if (kind <= vtk_tetrahedron) return fail("", "has an element with a wrong number of corners; export it again");
  return fail(unsuited_elements(name_of_vtk_cell(kind)));
}

/// Behind the end of the node whose '<' is at `at`, in XML that was parsed; npos where there is none. What looks like
/// an end within a comment, a CDATA section or a quoted value is none.
std::size_t end_of_node(std::string_view xml, std::size_t at) {
  constexpr std::array<std::array<std::string_view, 2>, 3> passed_over{
      {{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}}};
  for (int depth = 0; (at = xml.find('<', at)) != std::string_view::npos;) {
    const std::string_view rest = xml.substr(at);
    const auto special = std::find_if(passed_over.begin(), passed_over.end(),
                                      [rest](const auto& marks) { return rest.starts_with(marks[0]); });
    if (special != passed_over.end()) {
      at = xml.find((*special)[1], at + (*special)[0].size());
      continue;
    }
    const bool is_end = rest.starts_with("</");
    for (char quote = 0; ++at < xml.size() && (quote != 0 || xml[at] != '>');)
      if (xml[at] == '"' || xml[at] == '\'') quote = quote == 0 ? xml[at] : quote == xml[at] ? '\0' : quote;
    if (at == xml.size()) break;
    const bool is_empty = xml[at - 1] == '/';
    ++at;
    if (!is_empty) depth += is_end ? -1 : 1;
    if (depth == 0) return at;
  }
  return std::string_view::npos;
}

class VtuReader {
 public:
  explicit VtuReader(std::string_view bytes) : bytes_(bytes) {}

  Result<VolumeCells> read() {
    if (auto parsed = xml_.parse(bytes_, "UnstructuredGrid"); !parsed) return fail(parsed.error());
    cells_.form = PointsForm::vtk_xml;
    const bool of_steps = note_steps();
    for (const auto piece : xml_.grid().children("Piece")) {
      if (of_steps && !is_of_first_step(piece)) continue;
      if (auto read = read_piece(piece); !read) return fail(read.error());
      ends_.push_back(cells_.coordinates.size() / 3);
    }
    note_shared_points();
    const auto space = xml_.space();
    if (!space) return fail(space.error());
    cells_.space = *space;
    cells_.arrays = xml_.vertex_values(static_cast<Eigen::Index>(cells_.coordinates.size() / 3));
    return std::move(cells_);
  }

 private:
  /// Says that a file has several time steps. VTK writes them as pieces in text, else as further arrays of one piece.
  bool note_steps() {
    std::size_t steps = 0;
    Text times(xml_.grid().attribute("TimeValues").value());
    while (!times.word().empty()) ++steps;
    if (steps < 2) return false;
    cells_.warnings.push_back("has " + std::to_string(steps) +
                              " time steps, of which the first is taken; write each to a file of its own for others");
    return true;
  }

  static bool is_of_first_step(pugi::xml_node piece) {
    return piece.child("Points").child("DataArray").attribute("TimeStep").as_int(0) == 0;
  }

  /// Pieces have points of their own, also where they meet.
  void note_shared_points() {
    if (ends_.size() < 2) return;
    struct Place {
      std::array<double, 3> at;
      std::size_t piece;
      auto operator<=>(const Place&) const = default;
    };
    std::vector<Place> places;
    for (std::size_t piece = 0, i = 0; piece < ends_.size(); ++piece)
      for (; i < ends_[piece]; ++i) {
        const double* x = cells_.coordinates.data() + 3 * i;
        if (std::isfinite(x[0] + x[1] + x[2])) places.push_back({{x[0], x[1], x[2]}, piece});
      }
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a < b; });
    std::size_t shared = 0;
    for (std::size_t k = 1; k < places.size(); ++k)
      shared += places[k].at == places[k - 1].at && places[k].piece != places[k - 1].piece ? 1 : 0;
    if (shared == 0) return;
    const std::string words =
        "written in " + std::to_string(ends_.size()) + " pieces that each have points of their own, " +
        std::to_string(shared) +
        " of them at the places of others, which are not joined; write it as one piece (ParaView: "
        "Clean to Grid)";
    cells_.warnings.push_back("is " + words);
    cells_.likely_cause = " (it is " + words + ")";
  }

  Result<void> read_piece(pugi::xml_node piece) {
    const auto first_vertex = static_cast<std::int64_t>(cells_.coordinates.size() / 3);
    if (auto read = xml_.add_points(piece, cells_.coordinates); !read) return read;
    note_place(piece.child("Points"), first_vertex);
    xml_.add_vertex_arrays(piece, first_vertex);
    for (const char* where : {"PointData", "CellData"})
      for (const auto node : piece.child(where).children("DataArray"))
        if (const auto n = node.attribute("NumberOfComponents").as_ullong(1); n == 3 || n == 9) ++cells_.vectors;
    return read_cells(piece, first_vertex);
  }

  /// The node <Points> from its '<' to its end. It has no place where a file is not in UTF-8, as no program writes it.
  void note_place(pugi::xml_node points, std::int64_t first_vertex) {
    constexpr std::string_view name = "Points";
    const auto at = static_cast<std::size_t>(points.offset_debug());
    if (at == 0 || at >= bytes_.size() || bytes_.substr(at, name.size()) != name) return;
    const std::size_t end = end_of_node(bytes_, at - 1);
    const auto points_now = static_cast<Eigen::Index>(cells_.coordinates.size() / 3);
    if (points_now > first_vertex && end != std::string_view::npos)
      cells_.places.push_back({at - 1, end - at + 1, first_vertex, points_now - first_vertex});
  }

  Result<void> read_cells(pugi::xml_node piece, std::int64_t first_vertex) {
    const auto count = piece.attribute("NumberOfCells").as_ullong();
    if (count == 0) return {};
    const auto arrays = piece.child("Cells");
    const auto array = [&](const char* name) {
      return xml_.array<std::int64_t>(arrays.find_child_by_attribute("DataArray", "Name", name));
    };
    auto corners = array("connectivity");
    if (!corners) return fail(corners.error());
    const auto ends = array("offsets");
    if (!ends) return fail(ends.error());
    const auto kinds = array("types");
    if (!kinds) return fail(kinds.error());
    if (ends->size() != count || kinds->size() != count || ends->back() != std::ssize(*corners))
      return fail("", "announces another number of elements than it holds; export it again");
    for (std::int64_t& v : *corners)
      if (v >= 0 && v < std::int64_t{1} << 40) v += first_vertex;
    std::int64_t start = 0;
    for (std::size_t c = 0; c < count; ++c) {
      const std::int64_t end = (*ends)[c];
      if (end < start || end > std::ssize(*corners))
        return fail("", "has elements whose offsets do not fit their corners; export it again");
      const auto cell =
          std::span(*corners).subspan(static_cast<std::size_t>(start), static_cast<std::size_t>(end - start));
      if (auto added = add_vtk_cell((*kinds)[c], cell, cells_); !added) return added;
      start = end;
    }
    return {};
  }

  std::string_view bytes_;
  VtkXml xml_;
  VolumeCells cells_;
  std::vector<std::size_t> ends_;  ///< of each piece: behind its last point
};

Result<MeshFile> read_vtu(std::string_view bytes) {
  auto cells = vtu_cells(bytes);
  if (!cells) return fail(cells.error());
  return surface_of(std::move(*cells));
}

void write_vtu(const MeshFile& mesh, std::ostream& out) {
  VtkXmlData data;
  const std::string points = data.append(mesh.points.data(), mesh.points.size());
  const std::string corners = data.append(mesh.triangles->data(), mesh.triangles.size());
  std::vector<std::int32_t> ends;
  for (std::int32_t f = 1; f <= mesh.triangles.rows(); ++f) ends.push_back(3 * f);
  const std::vector<std::uint8_t> kinds(ends.size(), vtk_triangle);
  const std::string offsets = data.append(ends.data(), std::ssize(ends));
  const std::string types = data.append(kinds.data(), std::ssize(kinds));
  const std::string values = data.vertex_values(mesh);
  out << VtkXmlData::head("UnstructuredGrid", mesh.record) << "<Piece NumberOfPoints=\"" << mesh.points.rows()
      << "\" NumberOfCells=\"" << mesh.triangles.rows() << "\">\n"
      << values
      << "<Points>\n<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\" offset=\""
      << points << "\"/>\n</Points>\n<Cells>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"appended\" "
      << "offset=\"" << corners << "\"/>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"appended\" offset=\""
      << offsets << "\"/>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"appended\" offset=\"" << types
      << "\"/>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n";
  data.write_to(out);
}

}  // namespace

Result<VolumeCells> vtu_cells(std::string_view bytes) {
  return VtuReader(bytes).read();
}

const MeshFormat vtu{.name = "VTU",
                     .extension = ".vtu",
                     .note = "of a volume of tetrahedra the outside",
                     .keeps_record = true,
                     .read = read_vtu,
                     .write = write_vtu};

}  // namespace homolog::formats
