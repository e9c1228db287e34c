#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/formats/text.h"

namespace homolog::formats {
namespace {

Result<MeshFile> read_particles(std::string_view bytes) {
  MeshFile mesh;
  Text text(bytes);
  std::vector<double> coordinates;
  while (text.remaining() > 0) {
    Text words(text.line());
    std::string_view word = words.word();
    if (word.empty()) continue;
    int numbers = 0;
    for (; !word.empty(); word = words.word(), ++numbers) {
      const auto x = to_number<double>(word);
      if (!x) return fail("", "holds a line that is not \"x y z\"; copy or export it again");
      coordinates.push_back(*x);
    }
    if (numbers != 3) return fail("", "holds a line that is not \"x y z\"; copy or export it again");
  }
  mesh.points = to_points(std::move(coordinates));
  // Nothing says how many points there were.
  mesh.may_be_cut = text.may_be_cut();
  if (mesh.may_be_cut)
    mesh.warnings.push_back("ends without a line break after " + std::to_string(mesh.points.rows()) +
                            " points and may have been cut off; compare it with its source");
  return mesh;
}

void write_particles(const MeshFile& mesh, std::ostream& out) {
  std::string text;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    for (int k = 0; k < 3; ++k) {
      append_number(mesh.points(i, k), text);
      text += k < 2 ? ' ' : '\n';
    }
  }
  out << text;
}

}  // namespace

const MeshFormat particles{.name = "ShapeWorks particles",
                           .extension = ".particles",
                           .note = "points only",
                           .has_faces = false,
                           .read = read_particles,
                           .write = write_particles};

}  // namespace homolog::formats
