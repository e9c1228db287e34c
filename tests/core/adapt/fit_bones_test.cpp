#include <doctest/doctest.h>

#include <filesystem>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/mesh_io.h"
#include "core/template_making/mesh_template.h"
#include "core/template_making/template_file.h"
#include "tests/adapting.h"
#include "tests/real_data.h"

// Real bones with experts' landmarks.

using namespace homolog;

namespace {

/// A surface with the landmarks that lie in a file beside it.
MeshFile with_landmarks(const std::filesystem::path& file, const char* ending) {
  MeshFile surface = read_mesh_file(file).value();
  surface.landmarks = read_landmarks(std::filesystem::path(file).replace_extension(ending)).value();
  return surface;
}

std::shared_ptr<const Template> even_template(const MeshFile& subject, int vertices = 2500) {
  MeshFile even = template_file(make_mesh_template(subject, {.vertices = vertices}).value().mesh, {});
  even.landmarks = subject.landmarks;
  return make_template(even, "even").value();
}

Boundary boundary_of_file(const MeshFile& surface) {
  return mesh_boundary({Topology::make(surface.points.rows(), surface.triangles).value(), surface.points});
}

double off_by(const FitResult& fit, const MeshFile& there, const std::string& name) {
  const auto fitted = landmarks_of({.landmarks = fit.landmarks}, {name}), expert = landmarks_of(there, {name});
  return (fitted.at(name) - expert.at(name)).norm();
}

}  // namespace

TEST_CASE("a femur keeps its small features when it is fitted to another") {
  const auto data = real_data();
  if (data.empty()) return;
  const MeshFile own = with_landmarks(data / "bones" / "fem_z009_R.ply", ".mrk.json"),
                 there = with_landmarks(data / "bones" / "fem_z066_R.ply", ".mrk.json");
  const auto fit = fit_to_boundary(*even_template(own), boundary_of_file(there)).value();
  double sum_mm = 0;
  for (const Landmark& landmark : there.landmarks) {
    const double off_mm = off_by(fit, there, landmark.name);
    sum_mm += off_mm;
    if (landmark.name.starts_with("Lesser Trochanter")) CHECK(off_mm < 5);
  }
  CHECK(sum_mm / static_cast<double>(there.landmarks.size()) < 2.4);
}

// A few vertices beside the greater trochanter stay off this bone. They must not make the fit give up its matches.
TEST_CASE("a femur finds its places in another however fine its mesh is") {
  const auto data = real_data();
  if (data.empty()) return;
  const MeshFile own = with_landmarks(data / "bones" / "fem_z066_R.ply", ".mrk.json"),
                 there = with_landmarks(data / "bones" / "fem_z009_R.ply", ".mrk.json");
  for (const int vertices : {2500, 8000}) {
    CAPTURE(vertices);
    const auto fit = fit_to_boundary(*even_template(own, vertices), boundary_of_file(there)).value();
    double sum_mm = 0;
    for (const Landmark& landmark : there.landmarks) sum_mm += off_by(fit, there, landmark.name);
    CHECK(sum_mm / static_cast<double>(there.landmarks.size()) < 2.6);
  }
}

TEST_CASE("landmarks of one side bring the other side of a real vertebra to its places") {
  const auto data = real_data();
  if (data.empty()) return;
  const MeshFile own = with_landmarks(data / "vertebra_L1" / "sub-verse010_segment_20.ply", ".json"),
                 there = with_landmarks(data / "vertebra_L1" / "sub-verse018_segment_20.ply", ".json");
  const auto the_template = even_template(own);
  const auto off_mm = [&](const FitOptions& options) {  // D and F, whose mirror images are A and E
    const auto fit = fit_to_boundary(*the_template, boundary_of_file(there), options).value();
    return (off_by(fit, there, "D") + off_by(fit, there, "F")) / 2;
  };
  const double alone_mm = off_mm({});
  FitOptions shown;
  shown.landmarks = landmarks_of(there, {"A", "E", "G"});
  CAPTURE(alone_mm);
  CHECK(off_mm(shown) < 0.75 * alone_mm);
}

TEST_CASE("a femur of the other side is said to be mirrored, and its doubt covers how far its landmarks are off") {
  const auto data = real_data();
  if (data.empty()) return;
  const MeshFile own = with_landmarks(data / "bones" / "fem_z009_R.ply", ".mrk.json"),
                 there = with_landmarks(data / "bones" / "fem_z013_L.ply", ".mrk.json");
  const auto the_template = even_template(own);
  // All of it, and without its lower 30 %.
  MeshFile upper = there;
  const double low = there.points.col(2).minCoeff(), high = there.points.col(2).maxCoeff();
  const auto below = [&](Eigen::Index face) {
    return (Eigen::Array3d(there.points(there.triangles(face, 0), 2), there.points(there.triangles(face, 1), 2),
                           there.points(there.triangles(face, 2), 2)) < low + 0.3 * (high - low))
        .any();
  };
  Eigen::Index kept = 0;
  Triangles& faces = upper.triangles.edit();
  for (Eigen::Index face = 0; face < there.triangles.rows(); ++face)
    if (!below(face)) faces.row(kept++) = there.triangles.row(face);
  faces.conservativeResize(kept, 3);
  for (const bool partial : {false, true}) {
    CAPTURE(partial);
    FitOptions options;
    options.partial = partial;
    const auto boundary = surface_boundary(partial ? upper : there, the_template->points.rows()).value();
    const auto fit = fit_to_boundary(*the_template, boundary, options).value();
    CHECK(fit.mirrored);
    std::size_t covered = 0;
    for (std::size_t k = 0; k < the_template->landmarks.size(); ++k) {
      const double doubt_mm = value_at_landmark(*the_template, k, fit.doubt_mm);
      if (off_by(fit, there, the_template->landmarks[k].name) < 1.44 * doubt_mm) ++covered;
    }
    // What is left of a bone places the mirror image less surely.
    CHECK(covered > (partial ? 0.5 : 0.85) * static_cast<double>(the_template->landmarks.size()));
    CHECK(judge_fit(*the_template, boundary, options, fit).doubtful);
  }
  FitOptions partial;
  partial.partial = true;
  const MeshFile same = read_mesh_file(data / "bones" / "fem_z066_R.ply").value();
  CHECK_FALSE(fit_to_boundary(*the_template, boundary_of_file(same), partial).value().mirrored);
}
