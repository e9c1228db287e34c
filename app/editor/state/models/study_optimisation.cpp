#include "app/editor/state/models/study_optimisation.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "app/editor/state/models/models_state.h"

namespace homolog {

namespace {

/// The first of `names` that the others lack; empty where there is none.
std::string first_beyond(const std::vector<std::string>& names, const std::vector<std::string>& others) {
  for (const std::string& name : names)
    if (std::find(others.begin(), others.end(), name) == others.end()) return name;
  return {};
}

bool same_faces(const StudyModel& a, const StudyModel& b) {
  if (!a.topology || !b.topology) return a.topology == b.topology;
  return a.vertices() == b.vertices() && a.topology->triangles().rows() == b.topology->triangles().rows() &&
         a.topology->triangles() == b.topology->triangles();
}

/// The groups are those that the cases have now.
std::shared_ptr<const OptimisedStudy> with_groups(std::shared_ptr<const OptimisedStudy> optimised,
                                                  const std::vector<std::string>& groups) {
  if (optimised->shapes.model->groups == groups) return optimised;
  auto model = std::make_shared<StudyModel>(*optimised->shapes.model);
  model->groups = groups;
  auto grouped = std::make_shared<OptimisedStudy>(*optimised);
  grouped->shapes.model = std::move(model);
  return grouped;
}

/// Shows the shapes that are chosen, and their model.
void show_chosen(ModelsState& state) {
  state.shapes.shown = state.shapes.fitted.shapes;
  state.shapes.sizes = state.shapes.fitted.sizes;
  if (!state.made.optimisation.shown) return show_model(state, state.shapes.fitted.model);
  const ShapesOfStudy& optimised = state.made.optimisation.done->shapes;
  for (const auto& [name, shape] : optimised.shapes) state.shapes.shown[name] = shape;
  for (const auto& [name, sizes] : optimised.sizes) state.shapes.sizes[name] = sizes;
  show_model(state, optimised.model);
}

}  // namespace

std::string why_outdated(const StudyToOptimise& of, const ShapesOfStudy& now, Alignment alignment) {
  if (alignment != of.alignment) return "the alignment was changed";
  const auto& before = of.fitted.model->names;
  const std::vector<std::string> names = now.model ? now.model->names : std::vector<std::string>();
  if (const std::string added = first_beyond(names, before); !added.empty()) return added + " was added";
  if (const std::string gone = first_beyond(before, names); !gone.empty())
    return gone + " is not in the model any more";
  if (names != before) return "the cases have another order";
  for (const std::string& name : names)
    if (!same_shape(*of.fitted.shapes.at(name), *now.shapes.at(name))) return name + " has changed";
  if (!same_faces(*of.fitted.model, *now.model)) return "the study's template was changed";
  return {};
}

namespace {

using Shapes = std::map<std::string, std::shared_ptr<const MeshFile>>;

bool same_shapes(const Shapes& a, const Shapes& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& other) {
    return one.first == other.first && (one.second == other.second || one.second->points == other.second->points);
  });
}

}  // namespace

std::string take_fitted(ModelsState& state, ShapesOfStudy fitted) {
  StudyOptimisation& optimisation = state.made.optimisation;
  if (!state.observer.compared_shapes.empty() && !same_shapes(fitted.shapes, state.observer.compared_shapes)) {
    state.observer.comparison.reset();
    state.observer.compared_shapes.clear();
    state.observer.outdated = true;
  }
  state.shapes.fitted = std::move(fitted);
  std::string over;
  if (optimisation.of) {
    const std::string why = why_outdated(*optimisation.of, state.shapes.fitted, state.made.alignment);
    if (!why.empty()) {
      const char* const what = optimisation.done ? "The optimised shapes were dropped" : "The optimisation was stopped";
      over = what + (", because " + why) + ". Optimise again.";
      optimisation = {};
    } else if (optimisation.done) {
      optimisation.done = with_groups(optimisation.done, state.shapes.fitted.model->groups);
    }
  }
  show_chosen(state);
  return over;
}

std::string why_not_optimise(const ModelsState& state) {
  if (!state.shapes.fitted.model) return "At least two shapes in correspondence are needed.";
  if (!state.shapes.fitted.model->topology)
    return "Vertices slide along faces, and these shapes have none. Give the study a template first (Study, Set the "
           "template).";
  if (state.runs.evaluating) return "Wait until the measures are done.";
  if (state.runs.modelling) return "Wait until the model is made.";
  return {};
}

void take_optimised(ModelsState& state, OptimisedStudy optimised) {
  state.made.optimisation.done =
      with_groups(std::make_shared<const OptimisedStudy>(std::move(optimised)), state.shapes.fitted.model->groups);
  show_optimised(state, true);
}

void show_optimised(ModelsState& state, bool shown) {
  if (!state.made.optimisation.done || state.made.optimisation.shown == shown) return;
  state.made.optimisation.shown = shown;
  show_chosen(state);
}

void discard_optimised(ModelsState& state) {
  show_optimised(state, false);
  state.made.optimisation = {};
}

}  // namespace homolog
