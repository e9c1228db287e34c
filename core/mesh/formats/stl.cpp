#include <unordered_map>

#include "core/base/text/text.h"
#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/scalars.h"
#include "core/mesh/formats/space.h"
#include "core/mesh/formats/text.h"

namespace homolog::formats {
namespace {

constexpr std::size_t header_size = 80, facet_size = 50;

/// Gives corners at exactly the same place one vertex, numbered by first appearance.
class Merger {
 public:
  std::int64_t vertex_at(const std::array<double, 3>& position) {
    const auto [at, added] = vertices_.try_emplace(position, static_cast<std::int64_t>(coordinates_.size() / 3));
    if (added) coordinates_.insert(coordinates_.end(), position.begin(), position.end());
    return at->second;
  }
  /// Gives them up.
  std::vector<double> coordinates() && { return std::move(coordinates_); }

 private:
  struct Hash {
    std::size_t operator()(const std::array<double, 3>& p) const {
      std::size_t h = 0;
      for (const double x : p) h = (h ^ std::hash<double>()(x)) * 0x9e3779b97f4a7c15u;
      return h ^ h >> 32;
    }
  };
  std::unordered_map<std::array<double, 3>, std::int64_t, Hash> vertices_;
  std::vector<double> coordinates_;
};

Result<std::vector<double>> binary_corners(std::string_view bytes) {
  const std::size_t facets = load<std::uint32_t>(bytes.data() + header_size, std::endian::little);
  if (bytes.size() != header_size + 4 + facet_size * facets)
    return fail("",
                "announces " + std::to_string(facets) + " faces, which does not fit its size; copy or export it again");
  std::vector<double> corners;
  corners.reserve(9 * facets);
  for (std::size_t f = 0; f < facets; ++f) {
    const char* facet = bytes.data() + header_size + 4 + facet_size * f + 12;  // behind its normal
    for (std::size_t k = 0; k < 9; ++k) corners.push_back(load<float>(facet + 4 * k, std::endian::little));
  }
  return corners;
}

Result<std::vector<double>> ascii_corners(std::string_view bytes) {
  std::vector<double> corners;
  Text text(bytes);
  text.line();
  bool whole = false;
  for (std::string word = lower_case(std::string(text.word())); !word.empty();
       word = lower_case(std::string(text.word()))) {
    whole = word == "endsolid";
    if (whole) text.line();
    if (word != "vertex") continue;
    for (int k = 0; k < 3; ++k) {
      const auto x = text.number<double>();
      if (!x) return fail("", "has a vertex without three coordinates; copy or export it again");
      corners.push_back(*x);
    }
  }
  if (!whole || corners.size() % 9 != 0) return fail("", "is truncated (no \"endsolid\" at its end); copy it again");
  return corners;
}

/// Whether it begins as text does: "solid" in small letters or capitals. Headers of binary files may begin so too, but
/// then their size fits, or a byte of zero follows.
bool begins_as_text(std::string_view bytes) {
  const bool solid = lower_case(std::string(bytes.substr(0, 5))) == "solid";
  return solid && bytes.substr(0, header_size + 4).find('\0') == std::string_view::npos;
}

Result<MeshFile> read_stl(std::string_view bytes) {
  const bool binary =
      bytes.size() >= header_size + 4 &&
      (!begins_as_text(bytes) ||
       bytes.size() ==
           header_size + 4 + facet_size * load<std::uint32_t>(bytes.data() + header_size, std::endian::little));
  if (!binary && !begins_as_text(bytes))
    return fail("", "is not an STL file or is truncated; check its extension or copy it again");
  const auto corners = binary ? binary_corners(bytes) : ascii_corners(bytes);
  if (!corners) return fail(corners.error());

  MeshFile mesh;
  Merger merger;
  Faces kept;
  std::size_t degenerate = 0;
  for (std::size_t i = 0; i + 9 <= corners->size(); i += 9) {
    std::array<std::int64_t, 3> face{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double* p = corners->data() + i + 3 * k;
      face[k] = merger.vertex_at({p[0], p[1], p[2]});
    }
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0])
      ++degenerate;
    else if (auto added = kept.add(face); !added)
      return fail(added.error());
  }
  if (auto filled = std::move(kept).fill(mesh, std::move(merger).coordinates()); !filled) return fail(filled.error());
  if (degenerate > 0)
    mesh.warnings.push_back(std::to_string(degenerate) + " faces with two equal corners were left out");
  SpaceNames space;
  space.look_in(bytes.substr(0, binary ? header_size : bytes.find('\n')));
  space.apply_to(mesh);
  return mesh;
}

void write_stl(const MeshFile& mesh, std::ostream& out) {
  std::string bytes = "Homolog mesh, mm. SPACE=LPS";
  bytes.resize(header_size, ' ');
  store(static_cast<std::uint32_t>(mesh.triangles.rows()), std::endian::little, bytes);
  for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
    const auto corner = [&](int k) { return Vec3(mesh.points.row(mesh.triangles(f, k))); };
    const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    for (const Vec3& v : {normal, corner(0), corner(1), corner(2)})
      for (const double x : v) store(static_cast<float>(x), std::endian::little, bytes);
    store(std::uint16_t{0}, std::endian::little, bytes);
  }
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

const MeshFormat stl{.name = "STL",
                     .extension = ".stl",
                     .note = "vertices lose their numbers, so it is read only to make a template from",
                     .keeps_numbers = false,
                     .read = read_stl,
                     .write = write_stl};

}  // namespace homolog::formats
