#include <unordered_map>

#include "core/base/files/file_record.h"
#include "core/base/text/text.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/text.h"
#include "core/mesh/formats/vertex_arrays.h"
#include "core/mesh/formats/volume_cells.h"

namespace homolog::formats {
namespace {

Error damaged_msh() {
  return {"", "is truncated or damaged; copy or export it again"};
}

/// The corners of an element of Gmsh's kinds; 0 for those that are refused.
std::size_t corners_of_msh_element(std::int64_t kind) {
  switch (kind) {
    case 1:
      return 2;  // a line
    case 2:
      return 3;  // a triangle
    case 3:
      return 4;  // a quadrangle
    case 4:
      return 4;  // a tetrahedron
    case 8:
      return 3;  // a curved line
    case 15:
      return 1;  // a point
    default:
      return 0;
  }
}

std::string name_of_msh_element(std::int64_t kind) {
  switch (kind) {
    case 5:
      return "hexahedra";
    case 6:
      return "prisms";
    case 7:
      return "pyramids";
    default:
      return kind > 8 && kind < 140 ? "curved elements (kind " + std::to_string(kind) + " of Gmsh)"
                                    : "elements of kind " + std::to_string(kind);
  }
}

/// Files of Gmsh: sections between $Name and $EndName. Numbers are text, or bytes behind the line of the name.
class MshReader {
 public:
  MshReader(std::string_view bytes, bool with_places) : bytes_(bytes), text_(bytes), with_places_(with_places) {}

  Result<VolumeCells> read() {
    if (text_.word() != "$MeshFormat")
      return fail("", "is not a Gmsh file (it does not begin with $MeshFormat); check its extension");
    if (auto head = read_head(); !head) return fail(head.error());
    for (std::string_view name = text_.word(); !name.empty(); name = text_.word()) {
      if (!name.starts_with('$')) return fail(damaged_msh());
      if (auto section = read_section(name.substr(1)); !section) return fail(section.error());
    }
    if (!has_nodes_ || !has_elements_) return fail("", "lacks $Nodes or $Elements; copy or export it again");
    return std::move(cells_);
  }

 private:
  /// The next number, which a binary file holds as a T.
  template <class T>
  std::optional<T> number() {
    if (!binary_) return text_.number<T>();
    const auto taken = text_.take(sizeof(T));
    return taken ? std::optional(load<T>(taken->data(), order_)) : std::nullopt;
  }
  /// A count, or a name that version 4 keeps in 64 bits.
  std::optional<std::int64_t> large() {
    if (binary_ && four_) return number<std::int64_t>();
    return binary_ ? std::optional<std::int64_t>(number<std::int32_t>()) : number<std::int64_t>();
  }
  /// The name of a node or an element: in 64 bits since version 4.1.
  std::optional<std::int64_t> name() {
    if (binary_ && !long_names_) {
      const auto value = number<std::int32_t>();
      return value ? std::optional<std::int64_t>(*value) : std::nullopt;
    }
    return number<std::int64_t>();
  }
  std::optional<std::int64_t> small() {
    const auto value = number<std::int32_t>();
    return value ? std::optional<std::int64_t>(*value) : std::nullopt;
  }

  Result<void> read_head() {
    const auto version = text_.number<double>();
    const auto mode = text_.number<int>(), size = text_.number<int>();
    if (!version || !mode || !size) return fail(damaged_msh());
    four_ = *version >= 4 && *version < 5;
    long_names_ = *version > 4.05;
    if (!four_ && !(*version >= 2 && *version < 3))
      return fail("", "is of Gmsh's version " + excerpt(std::to_string(*version)).substr(0, 3) +
                          ", and versions 2 and 4 are read; save it as one of these");
    binary_ = *mode == 1;
    if (binary_ && *size != 8) return fail("", "holds numbers of an unknown size; export it again");
    text_.line();
    if (binary_) {
      const auto one = text_.take(4);
      if (!one) return fail(damaged_msh());
      order_ = load<std::int32_t>(one->data(), std::endian::little) == 1 ? std::endian::little : std::endian::big;
      if (load<std::int32_t>(one->data(), order_) != 1) return fail(damaged_msh());
    }
    cells_.form = !binary_                        ? PointsForm::text
                  : order_ == std::endian::little ? PointsForm::little_endian
                                                  : PointsForm::big_endian;
    return text_.word() == "$EndMeshFormat" ? Result<void>() : fail(damaged_msh());
  }

  Result<void> read_section(std::string_view name) {
    text_.line();
    const std::string end = "$End" + std::string(name);
    const bool is_nodes = name == "Nodes", is_elements = name == "Elements", is_node_data = name == "NodeData";
    if ((is_nodes && has_nodes_) || (is_elements && (has_elements_ || !has_nodes_)) || (is_node_data && !has_nodes_))
      return fail("", "holds its nodes and elements in an order that is not Gmsh's; export it again");
    if (is_nodes || is_elements) {
      const auto read = is_nodes ? (four_ ? read_blocks_of_nodes() : read_nodes())
                                 : (four_ ? read_blocks_of_elements() : read_elements());
      if (!read) return read;
      has_nodes_ = has_nodes_ || is_nodes;
      has_elements_ = has_elements_ || is_elements;
      return text_.word() == end ? Result<void>() : fail(damaged_msh());
    }
    const Text begin = text_;
    if (is_node_data || name == "ElementData" || name == "ElementNodeData") read_data(is_node_data, end);
    text_ = begin;
    const std::size_t from = text_.position(), at = bytes_.find(end, from);
    if (at == std::string_view::npos) return fail(damaged_msh());
    text_.take(at + end.size() - from);
    if (name == "Comments") look_for_space(bytes_.substr(from, at - from));
    return {};
  }

  void look_for_space(std::string_view comments) {
    Text lines(comments);
    while (lines.remaining() > 0) {
      const std::string_view line = lines.line();
      if (!is_record_line(line.substr(std::min<std::size_t>(2, line.size())))) cells_.space.look_in(line);
    }
  }

  Eigen::Index nodes() const { return std::ssize(cells_.coordinates) / 3; }

  /// x, y and z, and where they lie.
  Result<void> read_place() {
    const std::size_t before = text_.position();
    const std::size_t at = binary_ ? before : std::min(bytes_.find_first_not_of(" \t\r\n", before), bytes_.size());
    for (int k = 0; k < 3; ++k) {
      const auto x = number<double>();
      if (!x) return fail(damaged_msh());
      cells_.coordinates.push_back(*x);
    }
    if (with_places_) cells_.places.push_back({at, text_.position() - at, nodes() - 1, 1});
    return {};
  }

  Result<void> note_name(std::optional<std::int64_t> name) {
    if (!name) return fail(damaged_msh());
    if (!index_of_.try_emplace(*name, static_cast<std::int64_t>(index_of_.size())).second)
      return fail("", "names node " + std::to_string(*name) + " twice; export it again");
    return {};
  }

  /// No file holds more things than bytes.
  bool is_possible(std::optional<std::int64_t> count) const {
    return count && *count >= 0 && static_cast<std::size_t>(*count) <= text_.remaining();
  }

  Result<void> read_nodes() {
    const auto count = text_.number<std::int64_t>();
    if (!is_possible(count)) return fail(damaged_msh());
    text_.line();
    for (std::int64_t i = 0; i < *count; ++i) {
      if (auto noted = note_name(name()); !noted) return noted;
      if (auto read = read_place(); !read) return read;
    }
    return {};
  }

  /// The heads of a block: dimension, name of its entity, and a number that the section gives a meaning.
  struct BlockHead {
    std::int64_t dimension = 0, meaning = 0, count = 0;
  };
  Result<BlockHead> read_block_head() {
    const auto a = small(), b = small(), meaning = small();
    const auto count = large();
    if (!a || !b || !meaning || !is_possible(count)) return fail(damaged_msh());
    return BlockHead{long_names_ ? *a : *b, *meaning, *count};
  }
  /// The counts before the blocks. Gives the number of blocks and of what they hold.
  Result<std::array<std::int64_t, 2>> read_block_counts() {
    const auto blocks = large(), all = large();
    if (!is_possible(blocks) || !is_possible(all)) return fail(damaged_msh());
    if (long_names_ && (!large() || !large())) return fail(damaged_msh());
    return std::array{*blocks, *all};
  }

  Result<void> read_blocks_of_nodes() {
    const auto counts = read_block_counts();
    if (!counts) return fail(counts.error());
    for (std::int64_t b = 0; b < (*counts)[0]; ++b) {
      const auto head = read_block_head();
      if (!head) return fail(head.error());
      const std::int64_t more = head->meaning != 0 ? head->dimension : 0;  // parameters on a curve or a surface
      if (more < 0 || more > 3) return fail(damaged_msh());
      if (long_names_)
        for (std::int64_t i = 0; i < head->count; ++i)
          if (auto noted = note_name(name()); !noted) return noted;
      for (std::int64_t i = 0; i < head->count; ++i) {
        if (!long_names_)
          if (auto noted = note_name(name()); !noted) return noted;
        if (auto read = read_place(); !read) return read;
        for (std::int64_t k = 0; k < more; ++k)
          if (!number<double>()) return fail(damaged_msh());
      }
    }
    if (nodes() != (*counts)[1]) return fail("", "announces another number of nodes than it holds; export it again");
    return {};
  }

  Result<void> add_element(std::int64_t kind) {
    std::array<std::int64_t, 4> corners{};
    const std::size_t count = corners_of_msh_element(kind);
    for (std::size_t k = 0; k < count; ++k) {
      const auto node = name();
      if (!node) return fail(damaged_msh());
      const auto found = index_of_.find(*node);
      if (found == index_of_.end())
        return fail("", "has an element with node " + std::to_string(*node) + ", which it lacks; export it again");
      corners[k] = found->second;
    }
    if (kind == 4) return add_tetrahedron(corners.data(), cells_);
    return kind == 2 || kind == 3 ? cells_.faces.add(std::span(corners).first(count)) : Result<void>();
  }

  Result<void> check_kind(std::optional<std::int64_t> kind) const {
    if (!kind) return fail(damaged_msh());
    return corners_of_msh_element(*kind) > 0 ? Result<void>() : fail(unsuited_elements(name_of_msh_element(*kind)));
  }

  Result<void> skip_tags(std::int64_t tags) {
    for (std::int64_t k = 0; k < tags; ++k)
      if (!small()) return fail(damaged_msh());
    return {};
  }

  /// In text each element names its kind and the number of its tags, in a binary file a run of elements does.
  Result<void> read_elements() {
    const auto count = text_.number<std::int64_t>();
    if (!is_possible(count)) return fail(damaged_msh());
    text_.line();
    for (std::int64_t done = 0; done < *count;) {
      std::optional<std::int64_t> run = 1;
      if (!binary_ && !name()) return fail(damaged_msh());
      const auto kind = small();
      if (auto checked = check_kind(kind); !checked) return checked;
      if (binary_) run = small();
      const auto tags = small();
      if (!tags || *tags < 0 || !is_possible(run) || *run < 1 || *run > *count - done) return fail(damaged_msh());
      for (std::int64_t i = 0; i < *run; ++i, ++done) {
        if (binary_ && !name()) return fail(damaged_msh());
        if (auto skipped = skip_tags(*tags); !skipped) return skipped;
        if (auto added = add_element(*kind); !added) return added;
      }
    }
    return {};
  }

  Result<void> read_blocks_of_elements() {
    const auto counts = read_block_counts();
    if (!counts) return fail(counts.error());
    std::int64_t all = 0;
    for (std::int64_t b = 0; b < (*counts)[0]; ++b) {
      const auto head = read_block_head();
      if (!head) return fail(head.error());
      if (head->count > 0)
        if (auto checked = check_kind(head->meaning); !checked) return checked;
      for (std::int64_t i = 0; i < head->count; ++i) {
        if (!name()) return fail(damaged_msh());
        if (auto added = add_element(head->meaning); !added) return added;
      }
      all += head->count;
    }
    if (all != (*counts)[1]) return fail("", "announces another number of elements than it holds; export it again");
    return {};
  }

  /// The head of the values of nodes or elements.
  struct DataHead {
    std::string name;
    std::int64_t components = 0, count = 0;
  };
  std::optional<DataHead> read_data_head() {
    DataHead head;
    const auto texts = text_.number<std::int64_t>();
    if (!is_possible(texts)) return std::nullopt;
    text_.line();
    for (std::int64_t k = 0; k < *texts; ++k) {
      if (const auto text = trimmed(text_.line()); k == 0) head.name = text;
    }
    const auto reals = text_.number<std::int64_t>();
    if (!is_possible(reals)) return std::nullopt;
    for (std::int64_t k = 0; k < *reals; ++k)
      if (!text_.number<double>()) return std::nullopt;
    const auto whole = text_.number<std::int64_t>();
    if (!is_possible(whole) || *whole < 3) return std::nullopt;
    for (std::int64_t k = 0; k < *whole; ++k) {
      const auto number = text_.number<std::int64_t>();
      if (!number) return std::nullopt;
      if (k == 1) head.components = *number;
      if (k == 2) head.count = *number;
    }
    text_.line();
    if (head.name.size() >= 2 && head.name.starts_with('"')) head.name = head.name.substr(1, head.name.size() - 2);
    return is_possible(head.count) ? std::optional(std::move(head)) : std::nullopt;
  }

  /// Counts values that may be directions, and keeps those of one value a node. The mesh is whole without what cannot
  /// be read, which a warning names. Values of few nodes are left out: a small file could claim much memory by them.
  void read_data(bool of_nodes, std::string_view end) {
    auto head = read_data_head();
    if (!head && of_nodes) cells_.warnings.push_back(left_out("$NodeData"));
    if (!head) return;
    if (head->components == 3 || head->components == 9) ++cells_.vectors;
    if (!of_nodes || head->components != 1 || head->count < nodes() / 2) return;
    VertexScalars values = VertexScalars::Constant(nodes(), NAN);
    for (std::int64_t i = 0; i < head->count; ++i) {
      const auto node = small();
      const auto value = number<double>();
      if (!node || !value) return cells_.warnings.push_back(left_out(head->name));
      if (const auto found = index_of_.find(*node); found != index_of_.end()) values[found->second] = *value;
    }
    if (text_.word() != end) return cells_.warnings.push_back(left_out(head->name));
    cells_.arrays.emplace(std::move(head->name), std::move(values));
  }

  std::string_view bytes_;
  Text text_;
  bool with_places_, four_ = false, long_names_ = false, binary_ = false, has_nodes_ = false, has_elements_ = false;
  std::endian order_ = std::endian::little;
  std::unordered_map<std::int64_t, std::int64_t> index_of_;  ///< the index of a node by its name
  VolumeCells cells_;
};

Result<MeshFile> read_msh(std::string_view bytes) {
  auto cells = msh_cells(bytes, false);
  if (!cells) return fail(cells.error());
  return surface_of(std::move(*cells));
}

void write_msh(const MeshFile& mesh, std::ostream& out) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\nHomolog mesh, mm. SPACE=LPS\n" +
                     record_lines("# ", mesh.record) + "$EndComments\n$Nodes\n" + std::to_string(mesh.points.rows()) +
                     "\n";
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    append_number(i + 1, text);
    for (const double x : mesh.points.row(i)) append_number(x, text += ' ');
    text += '\n';
  }
  text += "$EndNodes\n$Elements\n" + std::to_string(mesh.triangles.rows()) + "\n";
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    append_number(f + 1, text);
    text += " 2 2 1 1";
    for (const std::int32_t v : mesh.triangles.row(f)) append_number(v + 1, text += ' ');
    text += '\n';
  }
  text += "$EndElements\n";
  for (const auto& [name, values] : vertex_arrays(mesh)) {
    text += "$NodeData\n1\n\"" + name + "\"\n1\n0\n3\n0\n1\n" + std::to_string(values.size()) + "\n";
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      append_number(i + 1, text);
      append_number(values[i], text += ' ');
      text += '\n';
    }
    text += "$EndNodeData\n";
  }
  out << text;
}

}  // namespace

Result<VolumeCells> msh_cells(std::string_view bytes, bool with_places) {
  return MshReader(bytes, with_places).read();
}

const MeshFormat msh{.name = "Gmsh",
                     .extension = ".msh",
                     .note =
                         "versions 2 and 4 are read, in text or binary, and 2.2 is written; of a volume of "
                         "tetrahedra the outside",
                     .keeps_record = true,
                     .read = read_msh,
                     .write = write_msh};

}  // namespace homolog::formats
