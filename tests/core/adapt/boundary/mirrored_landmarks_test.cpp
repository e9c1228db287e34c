#include "core/adapt/boundary/mirrored_landmarks.h"

#include <doctest/doctest.h>

#include "core/adapt/boundary/find_placement.h"
#include "core/catalogue/catalogue.h"
#include "core/phantom/phantom.h"
#include "tests/adapting.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// The landmarks of a phantom whose names hold this.
std::map<std::string, Vec3> landmarks_named(const MeshFile& subject, const std::string& part) {
  std::map<std::string, Vec3> found;
  for (const Landmark& landmark : subject.landmarks)
    if (landmark.name.find(part) != std::string::npos) found[landmark.name] = landmark.position;
  return found;
}

/// The mirrored landmarks of what is shown, all of it believed.
std::vector<MirroredLandmark> mirrored_of(const Template& the_template, const Boundary& boundary,
                                          const std::map<std::string, Vec3>& shown) {
  REQUIRE_FALSE(shown.empty());
  return mirrored_landmarks(the_template, boundary, shown, VertexScalars::Ones(std::ssize(shown)),
                            find_placement(the_template, boundary).placement);
}

}  // namespace

TEST_CASE("landmarks of a vertebra's left side tell of its right side") {
  const auto the_template = built_in(Organ::vertebra);
  const MeshFile subject = phantom_truth(Organ::vertebra, 1).front();
  const Mesh surface{the_template->topology, subject.points};
  const auto left = landmarks_named(subject, "left"), right = landmarks_named(subject, "right");
  const auto mirrored = mirrored_of(*the_template, boundary_of(surface), left);
  REQUIRE(mirrored.size() == left.size());
  for (const MirroredLandmark& one : mirrored) {
    // Both name the same place of the other side: on the template, and about there on the subject.
    const Vec3 carried = one.place.interpolate(*the_template->topology, subject.points).transpose();
    CHECK((carried - one.there).norm() < 4);
    double nearest_mm = 1e9;
    for (const auto& [name, place] : right) nearest_mm = std::min(nearest_mm, (place - one.there).norm());
    CHECK(nearest_mm < 5);
  }
  KnownMatches known{Points::Zero(std::ssize(left), 3), Points::Zero(std::ssize(left), 3),
                     VertexScalars::Constant(std::ssize(left), 0.5)};
  add_mirrored(mirrored, surface, known);
  CHECK(known.from.rows() == 2 * std::ssize(left));
  CHECK(known.noise_mm.tail(std::ssize(left)).minCoeff() > 0.5);
  CHECK(known.noise_mm.head(std::ssize(left)).maxCoeff() == 0.5);
}

TEST_CASE("landmarks of both sides or of the middle and those not believed or of a kidney have no mirrored ones") {
  const auto vertebra = built_in(Organ::vertebra), kidney = built_in(Organ::kidney);
  const MeshFile subject = phantom_truth(Organ::vertebra, 2).front();
  const Boundary boundary = boundary_of({vertebra->topology, subject.points});
  const auto left = landmarks_named(subject, "left");
  CHECK(mirrored_of(*vertebra, boundary, left).size() == left.size());
  CHECK(mirrored_of(*vertebra, boundary, landmarks_named(subject, "process")).empty());
  CHECK(mirrored_of(*vertebra, boundary, landmarks_named(subject, "spinous")).empty());
  CHECK(mirrored_landmarks(*vertebra, boundary, left, VertexScalars::Zero(std::ssize(left)),
                           find_placement(*vertebra, boundary).placement)
            .empty());  // none of them is believed
  const MeshFile round = phantom_truth(Organ::kidney, 2).front();
  CHECK(mirrored_of(*kidney, boundary_of({kidney->topology, round.points}), landmarks_named(round, "")).empty());
}
