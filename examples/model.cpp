// A statistical shape model of sixteen phantom kidneys, its measures, and a new shape drawn from it.
//
//     example_model [FOLDER]      (FOLDER gets sampled.ply)

#include <cstdio>
#include <filesystem>

#include "core/mesh/mesh_io.h"
#include "core/model/measures/measures.h"
#include "core/model/shape_model.h"
#include "core/phantom/phantom.h"

using namespace homolog;

int main(int count, char** arguments) {
  constexpr int subjects = 16;
  ShapeMatrix shapes;
  for (int k = 0; k < subjects; ++k) {
    const Points points = phantom_truth(Organ::kidney, k + 1).front().points;
    if (k == 0) shapes.resize(points.size(), subjects);
    shapes.col(k) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  align(shapes, Alignment::similarity);

  const PrincipalComponents components = principal_components(std::move(shapes));
  const MeshFile any = phantom_truth(Organ::kidney, 1).front();
  const auto topology = Topology::make(any.points.rows(), any.triangles);
  if (!topology) return 1;
  const ShapeModel model = make_model(components, 0.95, *topology, {});

  const Measures compact = compactness(components), general = generalisation_rms(components);
  std::printf("%d modes hold 95 %%; the first %.0f %%; one mode rebuilds a left-out shape to %.2f mm\n",
              static_cast<int>(model.modes()), 100 * compact.front().mean, general.front().mean);

  if (count > 1) {
    const auto written =
        write_mesh({model.topology, sampled_shape(model, 7)}, std::filesystem::path(arguments[1]) / "sampled.ply");
    if (!written) std::fprintf(stderr, "%s\n", written.error().sentence().c_str());
  }
  return model.modes() > 1 && general.back().mean < general.front().mean ? 0 : 1;
}
