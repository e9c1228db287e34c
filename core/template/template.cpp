#include "core/template/template.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/demand.h"
#include "core/mesh/check_mesh.h"
#include "core/mesh/formats/text.h"

namespace homolog {

namespace {

constexpr std::string_view missing_share_key = "homolog.missing_share ";

constexpr std::string_view faces_key = "homolog.faces ", ends_at_key = "homolog.ends_at ";

/// 0 where no comment says it.
double missing_share_in(const std::vector<std::string>& comments) {
  for (const std::string& comment : comments) {
    if (!comment.starts_with(missing_share_key)) continue;
    const auto share = formats::to_number<double>(std::string_view(comment).substr(missing_share_key.size()));
    if (share && *share > 0 && *share <= 1) return *share;
  }
  return 0;
}

bool is_positive(double factor) {
  return factor > 0 && std::isfinite(factor);
}

Result<void> check_regions(const Regions& regions, std::size_t vertices) {
  const std::size_t numbers = regions.of_vertex.size(), most = regions.list.size();
  if ((numbers == 0 || numbers == vertices) &&
      std::ranges::all_of(regions.of_vertex, [&](std::size_t number) { return number <= most; }))
    return {};
  return fail("", "the template has regions that are not of its vertices; give each vertex one, or none");
}

/// Errors: a place that is not finite.
Result<void> check_places(const std::vector<Landmark>& landmarks) {
  for (const Landmark& landmark : landmarks)
    if (!landmark.position.allFinite())
      return fail("", "the landmark \"" + landmark.name + "\" lies at no finite place; correct it or leave it out");
  return {};
}

bool is_on(const SurfacePoint& at, const Topology& topology) {
  return at.face >= 0 && at.face < topology.triangles().rows() && at.weights.allFinite();
}

}  // namespace

Result<void> check_template(const Template& the_template) {
  if (auto sound = check_mesh({the_template.topology, the_template.points}, "the template"); !sound) return sound;
  const Topology& topology = *the_template.topology;
  if (auto counted = check_count(the_template.stiffness.size(), topology.vertices(), "the template's stiffness");
      !counted)
    return counted;
  if (!is_positive(the_template.stiffness_base) ||
      !std::all_of(the_template.stiffness.begin(), the_template.stiffness.end(), is_positive))
    return fail("", "the template has a stiffness that is no positive number; correct it or leave it out");
  if (auto sound = check_regions(the_template.regions, static_cast<std::size_t>(topology.vertices())); !sound)
    return sound;
  if (auto finite = check_places(the_template.landmarks); !finite) return finite;
  if (the_template.landmark_points.size() != the_template.landmarks.size() ||
      !std::ranges::all_of(the_template.landmark_points, [&](const auto& at) { return is_on(at, topology); }))
    return fail("", "the template has landmarks that are not on its surface; give them by with_landmarks");
  return {};
}

std::string missing_share_comment(double share) {
  char number[32];
  std::snprintf(number, sizeof number, "%.4f", share);
  return std::string(missing_share_key) + number;
}

std::string faced_comment(const FacedNames& faced) {
  return std::string(faced.kept ? faces_key : ends_at_key) + faced.labels;
}

std::optional<FacedNames> faced_in(const std::vector<std::string>& comments) {
  for (const std::string& comment : comments)
    for (const auto& [key, kept] : {std::pair{faces_key, true}, std::pair{ends_at_key, false}})
      if (comment.starts_with(key)) return FacedNames{comment.substr(key.size()), kept};
  return std::nullopt;
}

Result<std::shared_ptr<const Template>> make_template(MeshFile file, std::string source) {
  auto topology = Topology::make(file.points.rows(), std::move(file.triangles));
  if (!topology) return fail(source, topology.error().what);
  Template made;
  made.source = std::move(source);
  made.topology = *topology;
  made.stiffness = file.stiffness ? *file.stiffness : VertexScalars::Ones(file.points.rows());
  made.points = std::move(file.points);
  made.stiffness_base = file.stiffness_base;
  made.regions = std::move(file.regions);
  made.missing_share = missing_share_in(file.comments);
  made.faced = faced_in(file.comments);
  if (auto sound = check_template(made); !sound) return fail(made.source, sound.error().what);
  if (auto finite = check_places(file.landmarks); !finite) return fail(made.source, finite.error().what);
  return with_landmarks(made, std::move(file.landmarks));
}

std::shared_ptr<const Template> with_landmarks(const Template& the_template, std::vector<Landmark> landmarks) {
  demand(check_places(landmarks));
  auto made = std::make_shared<Template>(the_template);
  made->landmarks = std::move(landmarks);
  made->landmark_points.clear();
  if (made->landmarks.empty()) return made;
  const SurfaceSearch search({made->topology, made->points});
  for (const Landmark& landmark : made->landmarks)
    made->landmark_points.push_back(search.nearest(landmark.position).at);
  return made;
}

MeshFile to_mesh_file(const Template& the_template) {
  MeshFile file;
  file.points = the_template.points;
  file.triangles = the_template.topology;
  file.stiffness = std::make_shared<const VertexScalars>(the_template.stiffness);
  file.stiffness_base = the_template.stiffness_base;
  file.regions = the_template.regions;
  file.landmarks = the_template.landmarks;
  if (the_template.faced) file.comments.push_back(faced_comment(*the_template.faced));
  if (the_template.missing_share > 0) file.comments.push_back(missing_share_comment(the_template.missing_share));
  return file;
}

std::pair<Points, Points> matched_landmarks(const Template& the_template, const std::map<std::string, Vec3>& placed) {
  Points from(std::ssize(the_template.landmarks), 3), to = from;
  Eigen::Index count = 0;
  for (const Landmark& own : the_template.landmarks) {
    const auto found = placed.find(own.name);
    if (found == placed.end()) continue;
    from.row(count) = own.position.transpose();
    to.row(count++) = found->second.transpose();
  }
  return {from.topRows(count), to.topRows(count)};
}

Vec3 carried_landmark(const Template& the_template, std::size_t landmark, const Points& points) {
  return the_template.landmark_points[landmark].interpolate(*the_template.topology, points).transpose();
}

double value_at_landmark(const Template& the_template, std::size_t landmark, const VertexScalars& values) {
  return the_template.landmark_points[landmark].interpolate(*the_template.topology, values)[0];
}

std::vector<Landmark> carried_landmarks(const Template& the_template, const Points& points) {
  std::vector<Landmark> carried = the_template.landmarks;
  for (std::size_t k = 0; k < carried.size(); ++k) carried[k].position = carried_landmark(the_template, k, points);
  return carried;
}

}  // namespace homolog
