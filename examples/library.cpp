// The ten types of docs/library.md. The page shows this program in parts.
//
//     example_library [FOLDER]        (FOLDER gets library.homolog)

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "core/adapt/labels/label_fit.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shape_model.h"
#include "core/phantom/phantom.h"
#include "core/session/case_file.h"

using namespace homolog;

namespace {

Result<void> run(const std::filesystem::path& folder) {
  const Result<MeshFile> missing = read_mesh_file("no-such-file.ply");
  if (!missing) std::puts(missing.error().sentence().c_str());
  const PhantomSubject subject = make_phantom(Organ::kidney, 1);
  const Volume& labels = subject.label_map;
  const Vec3 middle = labels.geometry.bounds_mm().center();
  const MeshFile truth = subject.truth.front();
  const auto topology = Topology::make(truth.points.rows(), truth.triangles);
  if (!topology) return fail(topology.error());
  const Mesh surface{*topology, truth.points};
  const auto the_template = load_template("built-in:kidney");
  if (!the_template) return fail(the_template.error());
  Progress progress;
  FitOptions options;
  options.progress = &progress;
  const auto fitted = fit_to_label(**the_template, {.map = labels, .label = 1}, {}, options);
  if (!fitted) return fail(fitted.error());
  const FitResult& fit = fitted->fit;
  const FitJudgement& judgement = fitted->judgement;
  std::printf("%s, in doubt by %.2f mm\n", judgement.doubtful ? "doubtful" : "sound", fit.doubt_mm.mean());
  for (const std::string& warning : judgement.warnings) std::puts(as_sentence(warning).c_str());
  const Boundary& boundary = fitted->boundary;
  std::printf("%.2f mm from the boundary, %.2f mm from the truth\n",
              mean_surface_distance_mm(fit.mesh, boundary.surface), mean_surface_distance_mm(fit.mesh, surface));
  const auto image = std::make_shared<const Volume>(subject.image);
  Document document = new_document("phantom:kidney:1", image, *the_template);
  const ShapeView begun = *document.view();
  std::printf("%ld vertices around %.0f %.0f %.0f mm\n", static_cast<long>(begun.shape.points->rows()), middle[0],
              middle[1], middle[2]);
  auto session = create_case(document, folder / "library.homolog");
  if (!session) return fail(session.error());
  const auto placed = session->apply(points_edit(*session->document().view(), fit.mesh.points, FoundBy::fit));
  if (!placed) return fail(placed.error());
  ShapeMatrix shapes(3 * truth.points.rows(), 8);
  for (int k = 0; k < 8; ++k) {
    const Points points = phantom_truth(Organ::kidney, k + 1).front().points;
    shapes.col(k) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  align(shapes, Alignment::similarity);
  const ShapeModel model = make_model(principal_components(std::move(shapes)), 0.9, *topology, {});
  std::printf("%ld modes hold 90 %%\n", static_cast<long>(model.modes()));

  const bool close = mean_surface_distance_mm(fit.mesh, surface) < 1;
  return close && model.modes() > 1 ? Result<void>{} : fail("", "the fit or the model is not what it was");
}

}  // namespace

int main(int count, char** arguments) {
  const auto done = run(count > 1 ? arguments[1] : ".");
  if (done) return 0;
  std::fprintf(stderr, "%s\n", done.error().sentence().c_str());
  return 1;
}
