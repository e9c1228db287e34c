// A template fitted to a surface without a hand, and the fit judged. The surface is a phantom kidney, whose true
// landmarks are known. (A label of a label map: fit_to_label, as in library.cpp.)
//
//     example_fit [FOLDER]        (FOLDER gets fitted.ply)

#include <cstdio>
#include <filesystem>
#include <string>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_io.h"
#include "core/phantom/phantom.h"

using namespace homolog;

int main(int count, char** arguments) {
  const auto the_template = make_template(built_in_template(Organ::kidney), "built-in:kidney");
  const MeshFile truth = phantom_truth(Organ::kidney, 2).front();
  const auto surface = Topology::make(truth.points.rows(), truth.triangles);
  if (!the_template || !surface) return 1;

  const Boundary boundary = mesh_boundary({*surface, truth.points});
  const auto fitted = fit_to_boundary(**the_template, boundary);
  if (!fitted) {
    std::fprintf(stderr, "%s\n", fitted.error().sentence().c_str());
    return 1;
  }

  // A fit alone says little of whether it can be trusted: the template may lie mirrored in an organ of the other side.
  const FitJudgement judgement = judge_fit(**the_template, boundary, {}, *fitted);
  for (const std::string& warning : judgement.warnings) std::puts(as_sentence(warning).c_str());

  // Landmark i of the fit is landmark i of the template, so its distance to the truth can be measured.
  const double landmark_mm = (fitted->mesh.points - truth.points).rowwise().norm().mean();
  const double surface_mm = mean_surface_distance_mm(fitted->mesh, boundary.surface);
  std::printf("%s: surface %.2f mm, landmarks %.2f mm, turned triangles %zu\n",
              judgement.doubtful ? "doubtful" : "sound", surface_mm, landmark_mm, fitted->turned_triangles);

  if (count > 1) {
    const auto written = write_mesh(fitted->mesh, std::filesystem::path(arguments[1]) / "fitted.ply");
    if (!written) std::fprintf(stderr, "%s\n", written.error().sentence().c_str());
  }
  return surface_mm < 0.5 && landmark_mm < 8 && fitted->turned_triangles == 0 ? 0 : 1;
}
