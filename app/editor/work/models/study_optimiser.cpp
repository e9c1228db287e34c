#include "app/editor/work/models/study_optimiser.h"

#include <algorithm>

#include "app/editor/work/models/build_study_model.h"

namespace homolog {

namespace {

TrainingSet training_set_of(const StudyToOptimise& study) {
  const StudyModel& model = *study.fitted.model;
  TrainingSet set{model.names, model.topology, {}, model.model.faced};
  set.shapes.resize(3 * model.vertices(), std::ssize(model.names));
  for (std::size_t k = 0; k < model.names.size(); ++k) {
    const Points& points = study.fitted.shapes.at(model.names[k])->points;
    set.shapes.col(static_cast<Eigen::Index>(k)) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  return set;
}

/// The shapes as they were, with their vertices where they slid to.
void take_shapes(const StudyToOptimise& study, const ShapeMatrix& slid, OptimisedStudy& optimised) {
  const StudyModel& model = *study.fitted.model;
  std::shared_ptr<const Topology> faces = model.topology;
  for (std::size_t k = 0; k < model.names.size(); ++k) {
    MeshFile shape = *study.fitted.shapes.at(model.names[k]);
    shape.points = points_of(slid, static_cast<Eigen::Index>(k));
    if (shape.triangles.rows() == 0) shape.triangles = model.topology;
    if (auto sizes = sizes_of(shape, faces)) optimised.shapes.sizes[model.names[k]] = std::move(*sizes);
    optimised.shapes.shapes[model.names[k]] = std::make_shared<const MeshFile>(std::move(shape));
  }
}

Result<OptimisedStudy> optimise_study(const StudyToOptimise& study, GroupwiseOptions options, Progress& progress) {
  const StudyModel& model = *study.fitted.model;
  TrainingSet set = training_set_of(study);
  options.alignment = study.alignment;
  options.progress = &progress;
  for (const std::string& name : model.names)
    options.held.push_back(held_vertices(*study.fitted.shapes.at(name), *model.topology, true));
  progress.part(0, 0.9);
  auto slid = optimise_set(set, options);
  if (!slid) return fail(slid.error());
  progress.part(0.9, 1);
  OptimisedStudy optimised;
  optimised.before = slid->before;
  optimised.after = slid->after;
  optimised.largest_slide_mm = *std::max_element(slid->largest_slide_mm.begin(), slid->largest_slide_mm.end());
  optimised.surface_moved_mm = slid->surface_moved_mm;
  take_shapes(study, slid->shapes, optimised);
  set.shapes = std::move(slid->shapes);
  auto made = make_study_model(std::move(set), model.groups, study.alignment, progress, model.doubts);
  if (!made) return fail(made.error());
  optimised.shapes.model = std::move(*made);
  return optimised;
}

}  // namespace

void StudyOptimiser::start(std::shared_ptr<const StudyToOptimise> study) {
  rounds_ = std::make_shared<Rounds>();
  work_.start("The optimisation", [study = std::move(study), rounds = rounds_, wake = wake_](Progress& progress) {
    GroupwiseOptions options;
    options.show = [&](const std::vector<GroupwiseRound>& so_far) {
      rounds->put(so_far);
      wake();
    };
    return optimise_study(*study, std::move(options), progress);
  });
}

}  // namespace homolog
