#include "app/editor/state/state.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "app/editor/state/views.h"
#include "core/base/files/file_stem.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

const Structure* active_structure(const EditorState& state, const Document& document) {
  return document.structure(state.look.structure);
}

std::optional<ShapeView> active_shape(const EditorState& state, const Document& document) {
  return document.view(state.look.structure);
}

void show_structure(EditorState& state, const Document& document, const std::string& id) {
  const Structure *before = active_structure(state, document), *now = document.structure(id);
  state.look.structure = now != nullptr && now != document.structure() ? now->id : std::string();
  if (before != nullptr && before == now) return;
  begin_on_structure(state, document);
}

void begin_on_structure(EditorState& state, const Document& document) {
  state.hand.landmark.clear();
  state.hand.template_landmark.clear();
  state.hand.renaming.reset();
  state.found = {};
  state.scoring.z.reset();
  const auto shown = active_shape(state, document);
  if (!shown) return;
  state.hand.landmark = next_unplaced_landmark(*shown);
  state.hand.wheel_sigma_mm.reset();
  state.hand.sigma_presets_mm = default_sigmas_mm(*shown->shape.reference);
  follow_organ(state, bounds_of(*shown->shape.reference).diagonal().norm());
}

bool active_is_locked(const EditorState& state, const Document& document) {
  const Structure* active = active_structure(state, document);
  return active != nullptr && state.look.structures.locks(active->id);
}

bool active_is_shown(const EditorState& state, const Document& document) {
  const Structure* active = active_structure(state, document);
  return active != nullptr && state.look.structures.shows(active->id);
}

void follow_structures(EditorState& state, const Document& document) {
  const bool several = document.structures.size() > 1;
  if (several && state.look.colouring == Colouring::vertex_hue) state.look.colouring = Colouring::structure;
  if (!several && state.look.colouring == Colouring::structure) state.look.colouring = Colouring::vertex_hue;
}

void follow_contours(EditorState& state, const Document& document) {
  std::erase_if(state.look.hidden_contours, [&](const std::string& id) {
    return std::ranges::none_of(document.structures, [&](const auto& one) { return one->contour_set(id) != nullptr; });
  });
}

bool paints_regions(const EditorState& state) {
  return state.hand.tool == MouseTool::stiffness &&
         (state.hand.brush.paints == BrushPaints::region || state.hand.brush.paints == BrushPaints::fill);
}

Colouring shown_colouring(const EditorState& state) {
  // What is in doubt is what a person confirms.
  if (state.hand.tool == MouseTool::confirm)
    return state.look.colouring == Colouring::doubt ? Colouring::doubt : Colouring::known;
  if (state.hand.tool == MouseTool::stiffness) return paints_regions(state) ? Colouring::regions : Colouring::stiffness;
  if (state.look.shows_confidence && state.found.confidence) return Colouring::confidence;
  const bool unknown = state.look.colouring == Colouring::score && state.scoring.z == nullptr;
  return unknown ? Colouring::vertex_hue : state.look.colouring;
}

void show_document(EditorState& state, const Document& document, const Layout& layout, bool same_image) {
  state.pointer.drag.reset();
  state.pointer.held_click.reset();
  state.hand.ruler.reset();
  state.hand.panel_edit.reset();
  state.said_in.reset();
  state.found = {};
  state.scoring.z.reset();
  state.hand.renaming.reset();
  state.look.shown_frame.reset();
  state.look.playing = false;
  state.look.own_planes = state.look.own_planes && is_oblique(geometry_of(document));
  if (document.scan.image && !same_image)
    std::tie(state.look.window_low, state.look.window_high) = default_window(*document.scan.image);
  state.look.structure.clear();
  state.look.structures = {};
  state.look.hidden_contours.clear();
  state.automatic.offered = {};
  follow_structures(state, document);
  if (const auto shown = active_shape(state, document)) {
    state.look.crosshair_mm = bounds_of(*shown->shape.points).center();
    state.hand.wheel_sigma_mm.reset();
    state.hand.sigma_presets_mm = default_sigmas_mm(*shown->shape.reference);
    follow_organ(state, bounds_of(*shown->shape.reference).diagonal().norm());
    state.hand.landmark = next_unplaced_landmark(*shown);
  } else {
    state.look.crosshair_mm = geometry_of(document).bounds_mm().center();
  }
  settle_crosshair(state, document);
  show_all(state, document, layout);
}

void follow_organ(EditorState& state, double diagonal_mm) {
  constexpr double much = 1.5, glyph_share = 1.0 / 12, brush_share = 0.08;
  if (!(diagonal_mm > 0)) return;
  const bool alike = diagonal_mm < much * state.look.organ_mm && state.look.organ_mm < much * diagonal_mm;
  state.look.organ_mm = diagonal_mm;
  if (alike) return;
  // Two digits, as a person would choose them.
  const auto rounded = [](double mm) {
    const double unit = std::pow(10, std::floor(std::log10(mm)) - 1);
    return std::round(mm / unit) * unit;
  };
  state.look.glyph_spacing_mm = rounded(glyph_share * diagonal_mm);
  state.hand.brush.radius_mm = rounded(brush_share * diagonal_mm);
}

void set_sigma(EditorState& state, double sigma_mm) {
  state.hand.sigma_presets_mm[state.hand.sigma_preset] = std::clamp(sigma_mm, smallest_sigma_mm, largest_sigma_mm);
  state.hand.wheel_sigma_mm.reset();
}

void turn_sigma(EditorState& state, double sigma_mm) {
  state.hand.wheel_sigma_mm = std::clamp(sigma_mm, smallest_sigma_mm, largest_sigma_mm);
}

std::string case_name(const std::filesystem::path& file, const Document& document) {
  if (!file.empty() && file.parent_path() != unsaved_folder()) return file_stem(file);
  std::string name = file_stem(document.scan.source);
  if (name.empty()) name = "case";
  std::replace(name.begin(), name.end(), ':', '-');
  return name;
}

std::vector<Landmark> landmarks_of_template(const std::vector<Landmark>& landmarks, const Template& the_template) {
  std::vector<Landmark> known;
  const auto& names = the_template.landmarks;
  std::copy_if(landmarks.begin(), landmarks.end(), std::back_inserter(known), [&](const Landmark& landmark) {
    return std::any_of(names.begin(), names.end(), [&](const Landmark& n) { return n.name == landmark.name; });
  });
  return known;
}

std::string next_unplaced_landmark(const ShapeView& shown, const std::string& after) {
  const auto& landmarks = shown.the_template().landmarks;
  const auto& placed = shown.shape.landmarks;
  std::size_t start = 0;
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    if (landmarks[i].name == after) start = i + 1;
  for (std::size_t k = 0; k < landmarks.size(); ++k) {
    const auto& name = landmarks[(start + k) % landmarks.size()].name;
    if (!placed.contains(name) && name != after) return name;
  }
  return {};
}

std::string landmark_in_hand(const EditorState& state, const Document& document) {
  const Structure* structure = active_structure(state, document);
  if (structure == nullptr) return {};
  const auto& known = structure->the_template->landmarks;
  const auto is_chosen = [&](const Landmark& landmark) { return landmark.name == state.hand.landmark; };
  if (std::any_of(known.begin(), known.end(), is_chosen)) return state.hand.landmark;
  const auto shown = active_shape(state, document);
  return shown ? next_unplaced_landmark(*shown) : std::string();
}

Situation situation_of(const EditorState& state, const Document& shown) {
  const Structure* structure = active_structure(state, shown);
  return {state.hand.tool,
          state.hand.brush.paints,
          state.hand.brush.region,
          landmark_in_hand(state, shown),
          state.hand.template_landmark,
          shown_frame(state, shown),
          structure != nullptr ? structure->id : std::string()};
}

void add_notice(EditorState& state, std::string text, bool error) {
  add_notice(state, Notice{std::move(text), error});
}

void add_notice(EditorState& state, Notice notice) {
  constexpr std::size_t most = 4;
  const auto same = std::ranges::find_if(
      state.notices, [&](const Notice& n) { return n.text == notice.text && n.kept == notice.kept; });
  if (same != state.notices.end()) {
    if (notice.unwritten) *same = std::move(notice);  // it is so again
    return;
  }
  state.notices.push_back(std::move(notice));
  if (state.notices.size() <= most) return;
  // An error stays longer than news.
  const auto news = std::find_if(state.notices.begin(), state.notices.end(), [](const Notice& n) { return !n.error; });
  state.notices.erase(news == state.notices.end() ? state.notices.begin() : news);
}

void remember_recent(std::vector<std::filesystem::path>& recent, const std::filesystem::path& path) {
  constexpr std::size_t most = 8;
  std::error_code error;
  // The next start may be in another working folder.
  auto whole = std::filesystem::absolute(path, error).lexically_normal();
  std::erase(recent, whole);
  recent.insert(recent.begin(), std::move(whole));
  if (recent.size() > most) recent.resize(most);
}

int shown_frame(const EditorState& state, const Document& document) {
  const int frames = document.scan.image ? document.scan.image->frames : 1;
  return state.look.shown_frame ? std::clamp(*state.look.shown_frame, 0, frames - 1) : document.frame;
}

}  // namespace homolog
