#include "app/editor/work/models/build_study_model.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <utility>

#include "core/base/processes/parallel.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/mesh_quality.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "core/template/other_side.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The shapes of all cases that can be read; the others are named among the refusals.
struct Gathered {
  std::vector<const StudyCase*> cases;
  std::vector<std::shared_ptr<const MeshFile>> meshes;
};

/// The open case's shapes; one that did not change is the one that was known.
ReadFile open_file(const StudyModelRequest& request) {
  ReadFile open{{}, shapes_of(*request.open_document)};
  const auto known = request.known.find(request.open_file);
  if (known == request.known.end()) return open;
  for (ShapesOfStructure& now : open.shapes.structures) {
    const ShapesOfStructure* before = known->second.shapes.structure(now.id);
    if (before == nullptr) continue;
    for (auto& [frame, mesh] : now.frames)
      if (const auto found = before->frames.find(frame);
          found != before->frames.end() && same_shape(*found->second, *mesh))
        mesh = found->second;
  }
  return open;
}

/// What a file holds, read where that is not known. Errors: it cannot be read.
Result<ReadFile> read_file(const fs::path& file, const StudyModelRequest& request, ReadTogether& together) {
  if (request.open_document && file == request.open_file) return open_file(request);
  std::error_code ignored;
  const auto written = fs::last_write_time(file, ignored);
  const auto known = request.known.find(file);
  if (known != request.known.end() && known->second.written == written) return known->second;
  auto read = read_shapes_of(file, together);
  if (!read) return fail(read.error());
  return ReadFile{written, std::move(*read)};
}

/// Every file of the study once, several at a time; those that are not there are left out. No result depends on how
/// many are read at a time.
std::map<fs::path, Result<ReadFile>> read_files(const StudyModelRequest& request, Progress& progress) {
  std::map<fs::path, Result<ReadFile>> files;
  std::error_code ignored;
  for (const StudyCase& one : request.cases)
    if (!files.contains(one.file) && fs::exists(one.file, ignored)) files.emplace(one.file, fail("", "was not read"));
  std::vector<std::pair<const fs::path, Result<ReadFile>>*> places;
  for (auto& place : files) places.push_back(&place);
  ReadTogether together;
  std::atomic<std::size_t> done = 0;
  for_each_in_parallel(places.size(), [&](std::size_t k) {
    if (progress.cancelled()) return;
    auto& [path, read] = *places[k];
    read = read_file(path, request, together);
    progress.report(static_cast<double>(++done) / static_cast<double>(places.size()));
  });
  return files;
}

Result<std::shared_ptr<const MeshFile>> shape_of(const StudyCase& one, const ReadFile& file) {
  auto mesh = file.shapes.shape({one.structure, one.frame}, one.name);
  if (!mesh || !one.flipped) return mesh;
  return std::make_shared<const MeshFile>(mirrored_with_names(**mesh));
}

Gathered gather(const StudyModelRequest& request, StudyModelBuilt& built, Progress& progress) {
  Gathered gathered;
  auto files = read_files(request, progress);
  if (progress.cancelled()) return gathered;
  for (const StudyCase& one : request.cases) {
    const auto refuse = [&](const Error& error) { built.refusals.push_back(error.sentence() + " (left out)"); };
    const auto read = files.find(one.file);
    if (read == files.end()) {
      built.refusals.push_back(missing_case(one));
      continue;
    }
    if (!read->second) {
      refuse(read->second.error());
      continue;
    }
    const auto [file, is_new] = built.known.try_emplace(one.file, *read->second);
    if (is_new) {
      const auto& remarks = file->second.shapes.warnings;
      built.warnings.insert(built.warnings.end(), remarks.begin(), remarks.end());
    }
    const auto mesh = shape_of(one, file->second);
    if (!mesh) {
      refuse(mesh.error());
      continue;
    }
    built.shapes[one.name] = *mesh;
    gathered.cases.push_back(&one);
    gathered.meshes.push_back(*mesh);
  }
  return gathered;
}

void measure(const Gathered& gathered, StudyModelBuilt& built) {
  if (gathered.meshes.empty()) return;
  std::shared_ptr<const Topology> first;
  (void)sizes_of(*gathered.meshes.front(), first);
  std::vector<std::optional<ShapeSizes>> sizes(gathered.cases.size());
  in_parallel(sizes.size(), [&](std::size_t from, std::size_t to) {
    std::shared_ptr<const Topology> faces = first;
    for (std::size_t k = from; k < to; ++k)
      if (auto measured = sizes_of(*gathered.meshes[k], faces)) sizes[k] = std::move(*measured);
  });
  for (std::size_t k = 0; k < sizes.size(); ++k)
    if (sizes[k]) built.sizes[gathered.cases[k]->name] = std::move(*sizes[k]);
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

/// The template's faces, for shapes that are points alone. Null without a template, or where its vertex count differs.
std::shared_ptr<const Topology> template_faces(const fs::path& file, Eigen::Index vertices, StudyModelBuilt& built) {
  if (file.empty()) return nullptr;
  const auto the_template = load_template(file.string());
  if (!the_template) {
    built.warnings.push_back(the_template.error().sentence());
    return nullptr;
  }
  const Eigen::Index count = (*the_template)->points.rows();
  if (count == vertices) return (*the_template)->topology;
  built.warnings.push_back(file.string() + ": has " + std::to_string(count) + " vertices where the shapes have " +
                           std::to_string(vertices) + ", so they stay without faces; choose another template");
  return nullptr;
}

std::vector<float> hues_of(const StudyModel& model) {
  if (model.topology) return vertex_hues(*model.topology);
  std::vector<float> hues;
  for (Eigen::Index i = 0; i < model.vertices(); ++i)
    hues.push_back(static_cast<float>(i) / static_cast<float>(model.vertices()));
  return hues;
}

/// How far shapes lie from the mean, and which of them too far.
void find_distances(StudyModel& model) {
  model.distances_mm.resize(model.names.size());
  for (const SuspiciousShape& shape : shapes_by_distance(*model.components)) {
    model.distances_mm[shape.shape] = shape.distance_mm;
    if (shape.suspicion != Suspicion::none) model.suspicious_shapes.push_back(shape);
  }
}

}  // namespace

StudyModelBuilt build_study_model(const StudyModelRequest& request, Progress& progress) {
  StudyModelBuilt built;
  Gathered gathered = gather(request, built, progress);
  if (progress.cancelled()) return built;
  measure(gathered, built);
  if (gathered.cases.empty()) {
    if (!request.cases.empty()) built.error = "None of the study's cases has a shape that can be read.";
    return built;
  }
  auto read = training_set(gathered, built);
  if (!read) {
    built.error = read.error().sentence();
    return built;
  }
  built.warnings.insert(built.warnings.end(), read->warnings.begin(), read->warnings.end());
  built.mirrored = std::move(read->mirrored);
  std::vector<std::string> groups, doubts;
  for (const StudyCase* one : gathered.cases) {
    groups.push_back(one->group);
    doubts.push_back(one->doubt);
  }
  if (!read->set.topology)
    read->set.topology = template_faces(request.template_file, read->set.shapes.rows() / 3, built);
  auto model =
      make_study_model(std::move(read->set), std::move(groups), request.alignment, progress, std::move(doubts));
  if (model)
    built.model = std::move(*model);
  else
    built.error = model.error().sentence();
  return built;
}

Result<std::shared_ptr<const StudyModel>> make_study_model(TrainingSet set, std::vector<std::string> groups,
                                                           Alignment alignment, const Progress& progress,
                                                           std::vector<std::string> doubts) {
  auto model = std::make_shared<StudyModel>();
  model->names = std::move(set.names);
  for (std::size_t k = 0; k < model->names.size(); ++k) model->places.emplace(model->names[k], k);
  model->groups = std::move(groups);
  model->doubts = std::move(doubts);
  model->doubts.resize(model->names.size());
  model->topology = std::move(set.topology);
  model->alignment = alignment;
  for (Eigen::Index k = 0; k < set.shapes.cols(); ++k)
    model->sizes_mm.push_back(centroid_size_mm(points_of(set.shapes, k)));
  align(set.shapes, alignment);
  model->centre_mm = points_of(Eigen::VectorXd(set.shapes.rowwise().mean())).colwise().mean();
  for (Eigen::Index k = 0; k < set.shapes.cols(); ++k)
    model->radius_mm =
        std::max(model->radius_mm,
                 (points_of(set.shapes, k).rowwise() - model->centre_mm.transpose()).rowwise().norm().maxCoeff());
  auto components = principal_components(std::move(set.shapes));
  if (components.scatter.size() == 0)
    return fail(model->names.front(),
                "differs from the other shapes by its pose alone, so there is nothing to model; give different shapes");
  model->model = make_model(components, share_of_variance, model->topology, model->names);
  model->model.alignment = alignment;
  model->model.faced = std::move(set.faced);
  model->mean = {model->topology, points_of(components.mean)};
  model->components = std::make_shared<const PrincipalComponents>(std::move(components));
  model->hues = std::make_shared<const std::vector<float>>(hues_of(*model));
  if (progress.cancelled()) return fail("", "was stopped");
  find_distances(*model);
  return model;
}

Result<Suspicions> find_suspicions(const StudyModel& model, const std::vector<std::shared_ptr<const MeshFile>>& meshes,
                                   KnownDoubts& known, Progress& progress) {
  Suspicions found;
  found.doubts.resize(meshes.size());
  std::atomic<std::size_t> done = 0;
  for_each_in_parallel(meshes.size(), [&](std::size_t k) {
    if (progress.cancelled() || !meshes[k]) return;
    const auto before = known.find(meshes[k]);
    found.doubts[k] = before != known.end() ? before->second : doubt_of_shape(*meshes[k]);
    progress.report(0.8 * static_cast<double>(++done) / static_cast<double>(meshes.size()));
  });
  if (progress.cancelled()) return fail("", "was stopped");
  known.clear();
  for (std::size_t k = 0; k < meshes.size(); ++k)
    if (meshes[k]) known.emplace(meshes[k], found.doubts[k]);
  const PrincipalComponents& components = *model.components;
  if (components.shapes() < 4) return found;  // fewer have no fences
  const Eigen::Index modes = std::clamp<Eigen::Index>(model.model.modes(), 1, components.shapes() - 2);
  found.vertices = suspicious_vertices(components, model.topology, modes);
  if (progress.cancelled()) return fail("", "was stopped");
  if (model.topology) found.triangles = suspicious_triangles(components, *model.topology);
  return found;
}

}  // namespace homolog
