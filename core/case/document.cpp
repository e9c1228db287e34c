#include "core/case/document.h"

#include <charconv>
#include <limits>
#include <string_view>

#include "core/base/text.h"
#include "core/phantom/phantom.h"

namespace homolog {

namespace {

constexpr std::string_view built_in_prefix = "built-in:";
constexpr std::string_view phantom_prefix = "phantom:";

}  // namespace

Result<std::shared_ptr<const Template>> make_template(MeshFile file, std::string source) {
  auto topology = Topology::make(file.points.rows(), std::move(file.triangles));
  if (!topology) return fail(source, topology.error().what);
  Template made;
  made.source = std::move(source);
  made.topology = *topology;
  made.stiffness = file.stiffness.value_or(VertexScalars::Ones(file.points.rows()));
  made.points = std::move(file.points);
  made.stiffness_base = file.stiffness_base;
  made.regions = std::move(file.regions);
  return with_landmarks(made, std::move(file.landmarks));
}

std::shared_ptr<const Template> with_landmarks(const Template& reference, std::vector<Landmark> landmarks) {
  auto made = std::make_shared<Template>(reference);
  made->landmarks = std::move(landmarks);
  made->landmark_points.clear();
  if (made->landmarks.empty()) return made;
  const SurfaceSearch search({made->topology, made->points});
  for (const Landmark& landmark : made->landmarks)
    made->landmark_points.push_back(search.nearest(landmark.position).at);
  return made;
}

MeshFile to_mesh_file(const Template& reference) {
  MeshFile file;
  file.points = reference.points;
  file.triangles = reference.topology->triangles();
  file.stiffness = reference.stiffness;
  file.stiffness_base = reference.stiffness_base;
  file.regions = reference.regions;
  file.landmarks = reference.landmarks;
  return file;
}

MeshFile painted_template(const Document& document) {
  MeshFile file = to_mesh_file(*document.reference);
  file.stiffness = *document.stiffness;
  file.stiffness_base = document.stiffness_base;
  file.regions = *document.regions;
  return file;
}

MeshFile to_mesh_file(const Document& document, int frame) {
  const Shape& shape = document.shapes.at(frame);
  MeshFile file = painted_template(document);
  file.points = *shape.points;
  file.landmarks.clear();
  for (const auto& [name, position] : shape.landmarks) file.landmarks.push_back({name, position});
  return file;
}

Result<std::shared_ptr<const Template>> load_template(const std::string& source) {
  if (source.starts_with(built_in_prefix)) {
    const auto organ = organ_from_name(source.substr(built_in_prefix.size()));
    if (!organ) return fail(organ.error());
    return make_template(built_in_template(*organ), source);
  }
  auto file = read_mesh_file(source);
  if (!file) return fail(file.error());
  return make_template(std::move(*file), source);
}

Result<VolumeRead> load_volume(const std::string& source, const VolumeReadOptions& options) {
  if (!source.starts_with(phantom_prefix)) return read_volume(source, options);
  const std::string rest = source.substr(phantom_prefix.size());
  const std::size_t colon = rest.find(':');
  const auto organ = organ_from_name(rest.substr(0, colon));
  if (!organ) return fail(organ.error());
  int number = 0;
  const char* end = rest.data() + rest.size();
  const auto numbered = [&] {
    const auto [stop, error] = std::from_chars(rest.data() + colon + 1, end, number);
    return error == std::errc() && stop == end && number >= 0;
  };
  if (colon == std::string::npos || !numbered())
    return fail(excerpt(source), "needs a subject number from 0 to " + std::to_string(std::numeric_limits<int>::max()) +
                                     ", for instance phantom:kidney:1");
  VolumeRead read;
  read.volume = make_phantom(*organ, number).image;
  return read;
}

std::pair<Points, Points> matched_landmarks(const Template& reference, const std::map<std::string, Vec3>& placed) {
  Points from(std::ssize(reference.landmarks), 3), to = from;
  Eigen::Index count = 0;
  for (const Landmark& own : reference.landmarks) {
    const auto found = placed.find(own.name);
    if (found == placed.end()) continue;
    from.row(count) = own.position.transpose();
    to.row(count++) = found->second.transpose();
  }
  return {from.topRows(count), to.topRows(count)};
}

Vec3 carried_landmark(const Template& reference, std::size_t landmark, const Points& points) {
  return reference.landmark_points[landmark].interpolate(*reference.topology, points).transpose();
}

std::vector<Landmark> carried_landmarks(const Template& reference, const Points& points) {
  std::vector<Landmark> carried = reference.landmarks;
  for (std::size_t k = 0; k < carried.size(); ++k) carried[k].position = carried_landmark(reference, k, points);
  return carried;
}

VertexScalars known_landmarks(const Shape& shape) {
  constexpr double followed = 0.6;  // below it a stroke carried a vertex along and did not decide its place
  VertexScalars known = VertexScalars::Zero(shape.points->rows());
  if (shape.decided) known = (shape.decided->array() >= followed).cast<double>();
  if (shape.confirmed) known = known.cwiseMax(*shape.confirmed);
  return known;
}

Points unaided_points(const Shape& shape) {
  if (!shape.unaided) return *shape.points;
  const VertexScalars known = known_landmarks(shape);
  return *shape.unaided + known.asDiagonal() * (*shape.points - *shape.unaided);
}

Document new_document(std::string volume_source, std::shared_ptr<const Volume> volume,
                      std::shared_ptr<const Template> reference) {
  Document document;
  document.volume_source = std::move(volume_source);
  document.volume = std::move(volume);
  document.reference = std::move(reference);
  if (!document.reference) return document;
  const Template& placed = *document.reference;
  document.stiffness = std::make_shared<const VertexScalars>(placed.stiffness);
  document.regions = std::make_shared<const Regions>(placed.regions);
  document.stiffness_base = placed.stiffness_base;
  Shape shape;
  if (document.volume) {
    shape.placement.translation = document.volume->geometry.bounds_mm().center() - bounds_of(placed.points).center();
  }
  shape.before_landmarks = shape.placement;
  shape.placed = std::make_shared<const Points>(shape.placement.apply(placed.points));
  shape.reference = shape.points = shape.placed;
  document.shapes.emplace(0, std::move(shape));
  return document;
}

}  // namespace homolog
