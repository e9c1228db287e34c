#include "app/editor/state/models/models_state.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "core/base/files/file_stem.h"
#include "core/base/files/paths.h"
#include "core/base/text/text.h"
#include "core/mesh/mesh_quality.h"
#include "core/model/files/model_files.h"
#include "render/hued_shapes.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr double most_deviations = 3;

bool holds(const StudyCase& one, const std::string& wanted) {
  return lower_case(one.name + '\n' + one.group + '\n' + one.notes).find(wanted) != std::string::npos;
}

}  // namespace

ListedSizes listed_sizes(const ModelsState& state) {
  ListedSizes listed;
  for (const StudyCase& one : state.study.cases) {
    const auto known = state.shapes.sizes.find(one.name);
    if (known == state.shapes.sizes.end()) continue;
    listed.names.push_back(one.name);
    listed.sizes.push_back(known->second);
    listed.groups.push_back(one.group);
  }
  if (std::all_of(listed.groups.begin(), listed.groups.end(), [](const auto& group) { return group.empty(); }))
    listed.groups.clear();
  return listed;
}

std::optional<double> distance_mm(const ModelsState& state, const StudyCase& one) {
  if (!state.made.model) return std::nullopt;
  const auto shape = state.made.model->index_of(one.name);
  if (shape < 0) return std::nullopt;
  return state.made.model->distances_mm[shape];
}

std::vector<std::size_t> listed_cases(const ModelsState& state) {
  const auto& cases = state.study.cases;
  const std::string wanted = lower_case(state.list.filter);
  std::vector<std::size_t> listed;
  for (std::size_t k = 0; k < cases.size(); ++k)
    if (wanted.empty() || holds(cases[k], wanted)) listed.push_back(k);
  std::vector<std::string> texts(cases.size());
  if (state.list.sorted_by == CaseColumn::name || state.list.sorted_by == CaseColumn::group)
    for (const std::size_t k : listed)
      texts[k] = lower_case(state.list.sorted_by == CaseColumn::name ? cases[k].name : cases[k].group);
  const auto before = [&](std::size_t a, std::size_t b) {
    switch (state.list.sorted_by) {
      case CaseColumn::study:
        if (cases[a].doubt.empty() != cases[b].doubt.empty()) return cases[b].doubt.empty();  // the doubtful ones first
        return a < b;
      case CaseColumn::name:
      case CaseColumn::group:
        return texts[a] < texts[b];
      case CaseColumn::state:
        return cases[a].state < cases[b].state;
      case CaseColumn::distance:
        return distance_mm(state, cases[a]).value_or(-1) < distance_mm(state, cases[b]).value_or(-1);
    }
    return false;
  };
  std::stable_sort(listed.begin(), listed.end(),
                   [&](std::size_t a, std::size_t b) { return state.list.descending ? before(b, a) : before(a, b); });
  return listed;
}

void sort_by(ModelsState& state, CaseColumn column) {
  if (state.list.sorted_by != column) {
    state.list.sorted_by = column;
    state.list.descending = column == CaseColumn::distance;  // the doubtful ones first
  } else if (state.list.descending == (column == CaseColumn::distance)) {
    state.list.descending = !state.list.descending;
  } else {
    state.list.sorted_by = CaseColumn::study;
    state.list.descending = false;
  }
}

std::size_t waiting_cases(const ModelsState& state) {
  const auto& cases = state.study.cases;
  return static_cast<std::size_t>(std::count_if(
      cases.begin(), cases.end(), [](const StudyCase& one) { return one.waits() && !one.labels.empty(); }));
}

std::size_t cases_with_labels(const ModelsState& state) {
  const auto& cases = state.study.cases;
  return static_cast<std::size_t>(
      std::count_if(cases.begin(), cases.end(), [](const StudyCase& one) { return !one.labels.empty(); }));
}

std::size_t add_cases(ModelsState& state, const std::vector<fs::path>& files) {
  std::size_t added = 0;
  auto& cases = state.study.cases;
  std::set<std::string> names;
  std::set<fs::path> known;
  for (const StudyCase& one : cases) {
    names.insert(one.name);
    known.insert(one.file);
  }
  for (const fs::path& given : files) {
    const fs::path file = absolute_path(given);
    if (!known.insert(file).second) continue;
    const std::string stem = shape_names({file.string()}).front();
    StudyCase one;
    one.name = stem;
    for (int number = 2; !names.insert(one.name).second; ++number) one.name = stem + "-" + std::to_string(number);
    one.file = file;
    cases.push_back(std::move(one));
    ++added;
  }
  if (added > 0) ++state.kept.shapes_revision, ++state.kept.revision;
  return added;
}

void remove_case(ModelsState& state, const std::string& name) {
  std::erase_if(state.study.cases, [&](const StudyCase& one) { return one.name == name; });
  if (state.list.selected == name) state.list.selected.clear();
  ++state.kept.shapes_revision;
  ++state.kept.revision;
}

const StudyCase* find_case(const Study& study, const std::string& name) {
  const auto found =
      std::find_if(study.cases.begin(), study.cases.end(), [&](const StudyCase& one) { return one.name == name; });
  return found == study.cases.end() ? nullptr : &*found;
}

StudyCase* find_case(Study& study, const std::string& name) {
  return const_cast<StudyCase*>(find_case(std::as_const(study), name));
}

const StudyCase* find_case(const ModelsState& state, const fs::path& file, const Document& document,
                           std::string_view structure) {
  const auto& cases = state.study.cases;
  const auto found = std::find_if(cases.begin(), cases.end(), [&](const StudyCase& one) {
    return one.file == file && one.frame.value_or(document.frame) == document.frame &&
           document.structure(one.structure) == document.structure(structure);
  });
  return found == cases.end() ? nullptr : &*found;
}

void flip_cases(ModelsState& state, const std::vector<std::string>& names) {
  const CasesByName by_name(state.study);
  auto& cases = state.study.cases;
  for (const std::string& name : names)
    if (const StudyCase* one = by_name.find(name)) {
      StudyCase& flipped = cases[one - cases.data()];
      flipped.flipped = !flipped.flipped;
    }
  ++state.kept.shapes_revision;
  ++state.kept.revision;
}

namespace {

/// The frame whose shape a case gives; nothing where its file is not known yet.
std::optional<int> frame_of(const ModelsState& state, const StudyCase& one) {
  const auto file = state.shapes.files.find(one.file);
  if (one.frame || file == state.shapes.files.end()) return one.frame;
  return file->second.shapes.shown;
}

}  // namespace

std::vector<int> other_frames(const ModelsState& state, const StudyCase& one) {
  const auto file = state.shapes.files.find(one.file);
  if (file == state.shapes.files.end()) return {};
  const ShapesOfStructure* of = file->second.shapes.structure(one.structure);
  if (of == nullptr) return {};
  std::vector<int> frames = of->edited;
  for (const StudyCase& other : state.study.cases)
    if (other.file == one.file && file->second.shapes.structure(other.structure) == of)
      if (const auto frame = frame_of(state, other)) std::erase(frames, *frame);
  return frames;
}

void add_frames(ModelsState& state, const std::string& name) {
  auto& cases = state.study.cases;
  const auto found = std::find_if(cases.begin(), cases.end(), [&](const StudyCase& one) { return one.name == name; });
  if (found == cases.end()) return;
  const std::vector<int> frames = other_frames(state, *found);
  if (frames.empty()) return;
  const StudyCase first = *found;
  found->frame = frame_of(state, first);  // from now on it is this one, whichever the case shows
  std::vector<StudyCase> added;
  for (const int frame : frames) {
    StudyCase one;
    one.file = first.file;
    one.frame = frame;
    one.structure = first.structure;
    one.group = first.group;
    one.flipped = first.flipped;
    const std::string stem = first.name + " frame " + std::to_string(frame);
    one.name = stem;
    for (int number = 2; find_case(state.study, one.name) != nullptr; ++number)
      one.name = stem + "-" + std::to_string(number);
    added.push_back(std::move(one));
  }
  cases.insert(found + 1, added.begin(), added.end());
  ++state.kept.shapes_revision;
  ++state.kept.revision;
}

void cycle_case_state(ModelsState& state, const std::string& name) {
  StudyCase* one = find_case(state.study, name);
  if (one == nullptr) return;
  set_case_state(state, name, static_cast<CaseState>((static_cast<int>(one->state) + 1) % 3));
}

void set_case_state(ModelsState& state, const std::string& name, CaseState to) {
  StudyCase* one = find_case(state.study, name);
  if (one == nullptr) return;
  const bool waited = one->waits();
  one->state = to;
  if (one->waits() != waited) ++state.kept.shapes_revision;  // one that waits is in no model
  ++state.kept.revision;
}

void set_case_text(ModelsState& state, const std::string& name, const std::string& field, std::string text) {
  StudyCase* one = find_case(state.study, name);
  if (one == nullptr) return;
  if (field == "group") {
    one->group = std::move(text);
    ++state.kept.shapes_revision;
  } else {
    one->notes = std::move(text);
  }
  ++state.kept.revision;
}

void set_study_template(ModelsState& state, const fs::path& file) {
  state.study.template_file = absolute_path(file);
  ++state.kept.shapes_revision;
  ++state.kept.revision;
}

void select_next_case(ModelsState& state) {
  const StudyCase* now = find_case(state.study, state.list.selected);
  const auto next = state.study.next_case(now != nullptr ? now - state.study.cases.data() : -1);
  if (next >= 0) select_case(state, state.study.cases[next].name);
}

namespace {

/// Shows the page that has a shape of the model.
void show_page_of(ModelsState& state, std::size_t shape) {
  state.gallery.page = shape / shapes_a_page;
}

}  // namespace

void select_case(ModelsState& state, const std::string& name) {
  state.list.selected = name;
  const auto shape = state.made.model ? state.made.model->index_of(name) : -1;
  if (shape >= 0) show_page_of(state, static_cast<std::size_t>(shape));
}

std::size_t gallery_pages(const ModelsState& state) {
  const std::size_t shapes = state.made.model ? state.made.model->names.size() : 0;
  return std::max<std::size_t>((shapes + shapes_a_page - 1) / shapes_a_page, 1);
}

void show_gallery_page(ModelsState& state, std::size_t page) {
  state.gallery.page = std::min(page, gallery_pages(state) - 1);
  state.gallery.hover.reset();
}

void show_study(ModelsState& state, Study study, fs::path file) {
  ModelsState fresh;
  fresh.shown = true;
  fresh.study = std::move(study);
  fresh.kept.file = std::move(file);
  fresh.kept.shapes_revision = state.kept.shapes_revision + 1;
  fresh.kept.revision = state.kept.revision;
  fresh.kept.number = state.kept.number + 1;
  fresh.gallery.glyphs = state.gallery.glyphs;
  state = std::move(fresh);
}

void show_model(ModelsState& state, std::shared_ptr<const StudyModel> model) {
  const bool other_landmarks = !model || !state.made.model || state.made.model->vertices() != model->vertices();
  if (state.made.model != model) state.made.suspicions.reset();
  state.made.model = std::move(model);
  state.made.evaluation.reset();
  show_gallery_page(state, state.gallery.page);
  if (!state.made.model) {
    unpin(state);
    return;
  }
  state.view.deviations.resize(static_cast<std::size_t>(state.made.model->model.modes()), 0);
  if (state.view.animated_mode && *state.view.animated_mode >= state.view.deviations.size())
    state.view.animated_mode.reset();
  const auto groups = state.made.model->comparable_groups();
  const auto known = [&](const std::string& group) {
    return std::find(groups.begin(), groups.end(), group) != groups.end();
  };
  if (groups.size() < 2) {
    state.view.show_difference = false;
  } else if (!known(state.view.compared[0]) || !known(state.view.compared[1])) {
    state.view.compared = {groups[0], groups[1]};
  }
  if (!other_landmarks) return;
  state.gallery.glyph_spacing_mm = std::clamp(state.made.model->radius_mm / 6, 1.0, 60.0);
  set_to_mean(state);
  show_all_shapes(state);
}

void show_all_shapes(ModelsState& state) {
  unpin(state);
  constexpr double left_px = 40, up_px = 25, room = 1.02;
  state.gallery.camera = turned(camera_from(LookFrom::anterior, Box()), -left_px, up_px);
  state.gallery.camera.fov_deg = 0;
  state.gallery.camera.target = Vec3::Zero();
  const double radius_mm = state.made.model ? state.made.model->radius_mm : 1;
  state.gallery.camera.distance_mm = distance_that_shows(room * radius_mm);
}

void pin_vertex(ModelsState& state, const GalleryVertex& place, bool focus) {
  if (!state.made.model || place.shape >= state.made.model->names.size()) return;
  state.gallery.pinned = place.vertex;
  select_case(state, state.made.model->names[place.shape]);
  if (!focus) return;
  state.gallery.focused = true;
  const Mesh shape{state.made.model->topology, state.made.model->shape(place.shape)};
  if (shape.topology) look_from_outside(state.gallery.camera, vertex_normals(shape).row(place.vertex));
  constexpr double nearer = 0.5;
  state.gallery.camera.target = Vec3::Zero();
  state.gallery.camera.distance_mm = distance_that_shows(nearer * state.made.model->radius_mm);
}

void unpin(ModelsState& state) {
  state.gallery.pinned.reset();
  if (std::exchange(state.gallery.focused, false)) state.gallery.camera.distance_mm *= 2;
}

Eigen::VectorXd shown_coefficients(const ModelsState& state) {
  const Eigen::VectorXd& variances = state.made.model->model.variances;
  return Eigen::Map<const Eigen::VectorXd>(state.view.deviations.data(), std::ssize(state.view.deviations))
      .cwiseProduct(variances.cwiseSqrt());
}

void set_to_mean(ModelsState& state) {
  std::fill(state.view.deviations.begin(), state.view.deviations.end(), 0.0);
  state.view.animated_mode.reset();
}

namespace {

void set_coefficients(ModelsState& state, const Eigen::VectorXd& b) {
  const Eigen::VectorXd& variances = state.made.model->model.variances;
  for (std::size_t k = 0; k < state.view.deviations.size(); ++k) {
    const auto mode = static_cast<Eigen::Index>(k);
    state.view.deviations[k] = std::clamp(b[mode] / std::sqrt(variances[mode]), -most_deviations, most_deviations);
  }
  state.view.animated_mode.reset();
}

}  // namespace

void set_to_sample(ModelsState& state) {
  if (!state.made.model) return;
  set_coefficients(state,
                   sampled_coefficients(state.made.model->model.variances, 1, ++state.view.samples_drawn).col(0));
}

void set_to_case(ModelsState& state, const std::string& name) {
  const auto shape = state.made.model ? state.made.model->index_of(name) : -1;
  if (shape >= 0) set_coefficients(state, state.made.model->model.scores.col(shape));
}

void animate(ModelsState& state, double seconds) {
  constexpr double period_seconds = 4;
  if (!state.view.animated_mode || *state.view.animated_mode >= state.view.deviations.size()) return;
  if (state.view.animation_started < 0) state.view.animation_started = seconds;
  const double phase = (seconds - state.view.animation_started) / period_seconds;
  state.view.deviations[*state.view.animated_mode] = most_deviations * std::sin(2 * std::numbers::pi * phase);
}

std::string study_name(const fs::path& file) {
  return file_stem(file);
}

}  // namespace homolog
