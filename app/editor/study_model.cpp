#include "app/editor/study_model.h"

#include <algorithm>

#include "core/case/case_file.h"
#include "core/mesh/mesh_quality.h"
#include "core/model/training_set.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr double share_held = 0.95;

bool is_case_file(const fs::path& file) {
  return file.extension() == ".homolog";
}

Result<MeshFile> shape_of_document(const Document& document, int frame, const std::string& name) {
  if (!document.reference || !document.shapes.contains(frame))
    return fail(name, "has no mesh yet; place a template in it first");
  return to_mesh_file(document, frame);
}

Result<MeshFile> read_shape(const StudyCase& one) {
  if (!is_case_file(one.file)) {
    const std::string extension = one.file.extension().string();
    if (extension == ".stl" || extension == ".STL")
      return fail(one.name, "is an STL file, which does not keep vertices and so no correspondence; use PLY or VTK");
    return read_mesh_file(one.file);
  }
  const auto read = read_case(one.file);
  if (!read) return fail(read.error());
  return shape_of_document(read->session.document(), one.frame, one.name);
}

/// The shapes of all cases that can be read; the others are named among the refusals.
struct Gathered {
  std::vector<const StudyCase*> cases;
  std::vector<std::shared_ptr<const MeshFile>> meshes;
};

Gathered gather(const StudyModelRequest& request, StudyModelBuilt& built, Progress& progress) {
  Gathered gathered;
  std::error_code ignored;
  double done = 0;
  for (const StudyCase& one : request.cases) {
    progress.report(done++ / static_cast<double>(request.cases.size()));
    if (progress.cancelled()) break;
    std::shared_ptr<const MeshFile> mesh;
    std::string refusal;
    if (request.open_document && one.file == request.open_file) {
      auto shown = shape_of_document(*request.open_document, one.frame, one.name);
      if (shown)
        mesh = std::make_shared<const MeshFile>(std::move(*shown));
      else
        refusal = shown.error().sentence();
    } else {
      const auto written = fs::last_write_time(one.file, ignored);
      const auto key = std::pair(one.file, one.frame);
      const auto known = request.known.find(key);
      if (known != request.known.end() && known->second.written == written) {
        mesh = known->second.mesh;
      } else if (auto read = read_shape(one)) {
        mesh = std::make_shared<const MeshFile>(std::move(*read));
      } else {
        refusal = read.error().sentence();
      }
      if (mesh) built.known[key] = {written, mesh};
    }
    if (!mesh) {
      built.refusals.push_back(refusal + " (left out)");
      continue;
    }
    gathered.cases.push_back(&one);
    gathered.meshes.push_back(std::move(mesh));
  }
  return gathered;
}

/// The largest training set that is in correspondence.
Result<TrainingSetRead> training_set(Gathered& gathered, StudyModelBuilt& built) {
  for (;;) {
    TrainingSetBuilder builder(gathered.cases.size());
    for (std::size_t k = 0; k < gathered.cases.size(); ++k) builder.add(gathered.cases[k]->name, *gathered.meshes[k]);
    auto read = builder.finish();
    if (read || gathered.cases.size() < 3) return read;
    const auto offender = std::find_if(gathered.cases.begin(), gathered.cases.end(),
                                       [&](const StudyCase* one) { return one->name == read.error().subject; });
    if (offender == gathered.cases.end()) return read;
    built.refusals.push_back(read.error().sentence() + " (left out)");
    gathered.meshes.erase(gathered.meshes.begin() + (offender - gathered.cases.begin()));
    gathered.cases.erase(offender);
  }
}

std::vector<float> hues_of(const StudyModel& model) {
  if (model.topology) return landmark_hues(*model.topology);
  std::vector<float> hues;
  for (Eigen::Index i = 0; i < model.landmarks(); ++i)
    hues.push_back(static_cast<float>(i) / static_cast<float>(model.landmarks()));
  return hues;
}

void find_doubts(StudyModel& model) {
  const PrincipalComponents& components = *model.components;
  model.distances_mm.resize(model.names.size());
  for (const DoubtfulShape& shape : shapes_by_distance(components)) {
    model.distances_mm[static_cast<std::size_t>(shape.shape)] = shape.distance_mm;
    if (shape.doubt != Doubt::none) model.doubtful_shapes.push_back(shape);
  }
  if (components.shapes() < 4) return;  // fewer have no fences
  const Eigen::Index modes = std::clamp<Eigen::Index>(model.model.modes(), 1, components.shapes() - 2);
  model.doubtful_landmarks = doubtful_landmarks(components, model.topology, modes);
  if (model.topology) model.doubtful_triangles = doubtful_triangles(components, *model.topology);
}

}  // namespace

std::ptrdiff_t StudyModel::index_of(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : found - names.begin();
}

std::vector<std::string> StudyModel::comparable_groups() const {
  std::vector<std::string> found;
  for (const std::string& group : groups)
    if (!group.empty() && std::find(found.begin(), found.end(), group) == found.end() &&
        std::count(groups.begin(), groups.end(), group) > 1)
      found.push_back(group);
  return found;
}

VertexScalars group_difference_mm(const StudyModel& model, const std::string& from, const std::string& to) {
  const auto mean_of = [&](const std::string& group) {
    Points sum = Points::Zero(model.landmarks(), 3);
    double count = 0;
    for (std::size_t k = 0; k < model.groups.size(); ++k)
      if (model.groups[k] == group) sum += *model.shapes[k], ++count;
    return Points(sum / count);
  };
  const Points apart = mean_of(to) - mean_of(from);
  if (!model.topology) return apart.rowwise().norm();
  return apart.cwiseProduct(vertex_normals(model.mean)).rowwise().sum();
}

StudyModelBuilt build_study_model(const StudyModelRequest& request, Progress& progress) {
  StudyModelBuilt built;
  Gathered gathered = gather(request, built, progress);
  if (progress.cancelled()) return built;
  if (gathered.cases.empty()) {
    if (!request.cases.empty()) built.error = "None of the study's cases has a shape that can be read.";
    return built;
  }
  auto read = training_set(gathered, built);
  if (!read) {
    built.error = read.error().sentence();
    return built;
  }
  built.warnings = std::move(read->warnings);
  auto model = std::make_shared<StudyModel>();
  for (const StudyCase* one : gathered.cases) {
    model->names.push_back(one->name);
    model->groups.push_back(one->group);
  }
  model->topology = read->set.topology;
  align(read->set.shapes, request.alignment);
  model->centre_mm = points_of(Eigen::VectorXd(read->set.shapes.rowwise().mean())).colwise().mean();
  for (Eigen::Index k = 0; k < read->set.shapes.cols(); ++k) {
    model->shapes.push_back(std::make_shared<const Points>(points_of(read->set.shapes, k)));
    model->radius_mm = std::max(
        model->radius_mm, (model->shapes.back()->rowwise() - model->centre_mm.transpose()).rowwise().norm().maxCoeff());
  }
  auto components = principal_components(std::move(read->set.shapes));
  if (components.scatter.size() == 0) {
    built.error = model->names.front() +
                  ": differs from the other shapes by its pose alone, so there is nothing to model; give different "
                  "shapes";
    return built;
  }
  model->model = make_model(components, share_held, model->topology, model->names);
  model->mean = {model->topology, points_of(components.mean)};
  model->components = std::make_shared<const PrincipalComponents>(std::move(components));
  model->hues = std::make_shared<const std::vector<float>>(hues_of(*model));
  if (progress.cancelled()) return built;
  find_doubts(*model);
  built.model = std::move(model);
  return built;
}

}  // namespace homolog
