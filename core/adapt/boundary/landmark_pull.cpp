#include "core/adapt/boundary/landmark_pull.h"

#include <cstdio>

#include "core/placement/likely_similarity.h"

namespace homolog {

namespace {

constexpr double landmark_weight = 10;  ///< weight of a named place against a vertex on the boundary

}  // namespace

void pull_landmarks(const Template& the_template, const std::map<std::string, Vec3>& landmarks,
                    const VertexScalars& trust, const Mesh& mesh, TargetPull& pull) {
  Eigen::Index known = 0;
  for (std::size_t k = 0; k < the_template.landmarks.size(); ++k) {
    const auto there = landmarks.find(the_template.landmarks[k].name);
    if (there == landmarks.end()) continue;
    const double believed = trust[known++];
    const Eigen::RowVector3d offset = (there->second - carried_landmark(the_template, k, mesh.points)).transpose();
    const SurfacePoint& place = the_template.landmark_points[k];
    const auto corners = mesh.topology->triangles().row(place.face);
    for (int c = 0; c < 3; ++c) {
      const Eigen::Index i = corners[c];
      const double weight = landmark_weight * believed * place.weights[c], total = pull.weights[i] + weight;
      if (total <= 0) continue;
      pull.targets.row(i) = (pull.weights[i] * pull.targets.row(i) + weight * (mesh.points.row(i) + offset)) / total;
      pull.weights[i] = total;
    }
  }
}

std::vector<std::string> believed_landmarks(const Template& the_template, const std::map<std::string, Vec3>& landmarks,
                                            const VertexScalars& trust) {
  std::vector<std::string> names;
  Eigen::Index k = -1;
  for (const Landmark& landmark : the_template.landmarks)
    if (landmarks.contains(landmark.name) && trust[++k] >= believable) names.push_back(landmark.name);
  return names;
}

std::vector<std::string> warnings_of_landmarks(const Template& the_template,
                                               const std::map<std::string, Vec3>& landmarks, const VertexScalars& trust,
                                               const VertexScalars& off_mm) {
  std::vector<std::string> warnings;
  if (trust.size() > 0 && trust.size() < fewest_placing_landmarks)
    warnings.emplace_back(trust.size() == 1
                              ? "one landmark pulls on the mesh but did not help to place it; give three or more"
                              : "two landmarks pull on the mesh but did not help to place it; give three or more");
  Eigen::Index k = -1;
  for (const Landmark& landmark : the_template.landmarks) {
    if (!landmarks.contains(landmark.name) || trust[++k] >= believable) continue;
    char mm[32];
    std::snprintf(mm, sizeof mm, "%.0f mm", off_mm[k]);
    warnings.push_back("the landmark \"" + landmark.name + "\" lies " + mm +
                       " from where the surface and the other landmarks put it, so it was not used; check its place "
                       "and name");
  }
  return warnings;
}

}  // namespace homolog
