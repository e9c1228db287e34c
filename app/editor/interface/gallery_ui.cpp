#include <algorithm>
#include <cmath>

#include "app/editor/drawing/gallery_pictures.h"
#include "app/editor/interface/interface.h"
#include "app/editor/interface/side_buttons.h"
#include "app/editor/panels/models/models_panel.h"
#include "app/editor/state/files/file_extensions.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/widgets.h"
#include "app/editor/work/models/study_folder.h"
#include "core/base/text/listed.h"

namespace homolog {

namespace {

void shadowed(ImDrawList& draw, ImFont* font, ImVec2 at, ImU32 colour, const std::string& text) {
  shadowed_text(draw, font, {std::round(at.x), std::round(at.y)}, colour, text);
}

ImU32 to_im(const Rgb& colour) {
  return ImGui::ColorConvertFloat4ToU32({colour[0], colour[1], colour[2], 1});
}

/// `names`: of all that are shown beside it.
std::string cut(ImFont* font, const std::string& text, float width_px, const std::vector<std::string>& names = {}) {
  ImGui::PushFont(font);
  std::string shown = shortened_among(text, names, width_px);
  ImGui::PopFont();
  return shown;
}

/// A ring at a vertex; faint where the shape's other side hides it.
void draw_marker(ImDrawList& draw, const Theme& theme, const ModelsState& state, const RectPx& cell,
                 const Points& points, Eigen::Index vertex, bool lit) {
  const Camera3D camera = cell_camera(state, points);
  const Eigen::Vector2d px = cell_px(camera, cell, points.row(vertex));
  const ImVec2 at{static_cast<float>(px.x()), static_cast<float>(px.y())};
  const bool seen = faces_viewer(camera, {state.made.model->topology, points}, vertex);
  const ImU32 colour = to_im(hsv_to_rgb((*state.made.model->hues)[vertex], 1, 1));
  const float radius = theme.px(lit ? 6 : 5), alpha = seen ? 1.0f : 0.35f;
  draw.AddCircleFilled(at, radius, with_alpha(colour, alpha));
  draw.AddCircle(at, radius, with_alpha(IM_COL32_BLACK, 0.8f * alpha), 0, theme.scale * 3);
  draw.AddCircle(at, radius, with_alpha(IM_COL32_WHITE, alpha), 0, theme.scale * 1.5f);
}

/// The vertex that is shown in all cells: the hovered one, else the pinned one.
std::optional<Eigen::Index> marked_vertex(const ModelsState& state) {
  return state.gallery.hover ? std::optional(state.gallery.hover->vertex) : state.gallery.pinned;
}

/// Why a person has to look at a shape; empty: no reason, or somebody did.
std::string doubt_shown(const ModelsState& state, std::size_t shape) {
  std::string doubt = state.made.model->doubts[shape];
  if (doubt.empty() && state.made.suspicions) doubt = state.made.suspicions->doubts[shape];
  if (doubt.empty()) return {};
  const StudyCase* one = find_case(state.study, state.made.model->names[shape]);
  return one != nullptr && one->state == CaseState::done ? std::string() : doubt;
}

ImU32 name_colour(const StudyModel& model, std::size_t shape, bool pointed, bool in_doubt) {
  if (in_doubt) return palette::amber;
  for (const SuspiciousShape& one : model.suspicious_shapes)
    if (one.shape == static_cast<Eigen::Index>(shape))
      return one.suspicion == Suspicion::far_outside ? palette::bad : palette::amber;
  return with_alpha(palette::mark, pointed ? 1.0f : 0.85f);
}

/// `names`: of all shapes of the page.
void draw_cell(ImDrawList& draw, const UiContext& ui, const GalleryGrid& grid, std::size_t k,
               const std::vector<std::string>& names) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const StudyModel& model = *state.made.model;
  const RectPx cell = grid.cell(k);
  const ImVec2 low{cell.x, cell.y}, high{cell.x + cell.width, cell.y + cell.height};
  draw.PushClipRect(low, high, true);
  const bool pointed = state.gallery.hover && state.gallery.hover->shape == k;
  if (const auto vertex = marked_vertex(state)) draw_marker(draw, theme, state, cell, model.shape(k), *vertex, pointed);
  if (cell.width >= theme.px(56)) {
    const bool in_doubt = !doubt_shown(state, k).empty();
    const std::string mark = in_doubt ? std::string(icon::warning) + " " : std::string();
    const float room = cell.width - theme.px(8) - (in_doubt ? text_size(theme.small, mark).x : 0);
    shadowed(draw, theme.small, {low.x + theme.px(4), low.y + theme.px(2)}, name_colour(model, k, pointed, in_doubt),
             mark + cut(theme.small, model.names[k], room, names));
  }
  draw.PopClipRect();
  if (state.list.selected == model.names[k])
    draw.AddRect(low, high, palette::accent, 0, 0, std::max(theme.scale, 1.0f));
}

std::string place_text(const StudyModel& model, const GalleryVertex& place) {
  const Vec3 apart = model.shape(place.shape).row(place.vertex) - model.mean.points.row(place.vertex);
  return format("%s, vertex %td: %.2f mm from the mean", model.names[place.shape].c_str(), place.vertex, apart.norm());
}

void draw_header_row(const UiContext& ui, const RectPx& rect, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float text_y = std::floor(rect.y + (theme.px(28) - theme.strong->FontSize) / 2);
  // The title, and how much is shown, as far as the buttons leave room.
  const float buttons = rect.x + rect.width - 8 * theme.px(24) - theme.px(8);
  float x = rect.x + theme.px(12);
  const std::string title = "Correspondence";
  const std::string shown = state.made.model ? format("%zu %s, %td vertices", state.made.model->names.size(),
                                                      state.made.optimisation.shown ? "optimised shapes" : "shapes",
                                                      state.made.model->vertices())
                                             : "";
  const float title_width = text_size(theme.strong, title).x;
  if (x + title_width <= buttons) {
    text_at(draw, theme.strong, {x, text_y}, palette::text, title);
    x += title_width + theme.px(12);
  }
  if (!shown.empty() && x + text_size(theme.body, shown).x <= buttons) text_at(draw, {x, text_y}, palette::dim, shown);
  draw_side_buttons<LookFromSideInGallery>(ui, rect.width - 8 * theme.px(24), theme.px(2), theme.px(24),
                                           ". The first shape sets the directions", out);
  ImGui::SetCursorPos({rect.width - theme.px(28), theme.px(2)});
  if (icon_button(theme, icon::everything, "fit", "All shapes in view (F)", {}, false, 24)) out.send(ShowAllShapes{});
}

/// Which page is shown, and a button to either side, at the right end of the tools; gives its width. Nothing where one
/// page holds all shapes.
float draw_pager(const UiContext& ui, const RectPx& rect, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const std::size_t pages = gallery_pages(state), page = state.gallery.page;
  if (pages == 1) return 0;
  const std::string text = format("page %zu of %zu", page + 1, pages);
  // As wide on every page, so that the buttons stay where they are.
  const float words = text_size(theme.body, format("page %zu of %zu", pages, pages)).x + theme.px(8);
  const float width = words + 2 * theme.px(28) + theme.px(8), from = rect.width - width;
  ImGui::SetCursorPos({from, theme.px(30)});
  if (icon_button(theme, icon::left_angle, "page back", "The shapes before (PgUp)",
                  page == 0 ? "This is the first page." : "", false, 28))
    out.send(ShowGalleryPage{page - 1});
  text_at(*ImGui::GetWindowDrawList(),
          {rect.x + from + theme.px(28) + std::floor((words - text_size(theme.body, text).x) / 2),
           std::floor(rect.y + theme.px(44) - theme.body->FontSize / 2)},
          palette::dim, text);
  ImGui::SetCursorPos({from + theme.px(28) + words, theme.px(30)});
  if (icon_button(theme, icon::right_angle, "page on", "The next shapes (PgDn)",
                  page + 1 == pages ? "This is the last page." : "", false, 28))
    out.send(ShowGalleryPage{page + 1});
  return width;
}

void draw_tools_row(const UiContext& ui, const RectPx& rect, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const StudyModel& model = *state.made.model;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  ImGui::SetCursorPos({theme.px(8), theme.px(30)});
  if (icon_button(theme, icon::glyphs, "glyphs", "Glyphs: balls on some vertices, in the vertex's hue",
                  model.topology ? "" : "Shapes without faces show all their points.", state.gallery.glyphs, 28))
    out.send(ShowGalleryGlyphs{!state.gallery.glyphs});
  ImGui::SetCursorPos({theme.px(44), theme.px(32)});
  const float slider_width = std::min(static_cast<float>(theme.px(292)), rect.width - theme.px(44 + 12));
  ImGui::BeginChild("spacing", {slider_width, theme.px(24)});
  double spacing_mm = state.gallery.glyph_spacing_mm;
  bool released = false;
  const double smallest_mm = std::max(model.radius_mm / 40, 0.1), largest_mm = model.radius_mm;
  if (slider(theme, "Spacing", spacing_mm, {smallest_mm, largest_mm, "%.1f", "mm", true},
             "Smallest distance between two glyphs, on the mean shape", released,
             !model.topology        ? "Shapes without faces show all their points."
             : state.gallery.glyphs ? ""
                                    : "Glyphs are switched off."))
    out.send(SpaceGalleryGlyphs{spacing_mm});
  ImGui::EndChild();
  const auto& at = state.gallery.hover;
  std::string text;
  if (at)
    text = place_text(model, *at);
  else if (state.gallery.pinned)
    text = format("Vertex %td is marked (Escape unmarks it)", *state.gallery.pinned);
  const float x = rect.x + theme.px(44 + 12) + slider_width;
  const float room = rect.x + rect.width - theme.px(12) - x - draw_pager(ui, rect, out);
  ImGui::PushFont(theme.small);
  text_at(draw, {x, std::floor(rect.y + theme.px(44) - theme.small->FontSize / 2)}, palette::dim,
          shortened(text, room));
  ImGui::PopFont();
}

/// Turns, moves and zooms all cells with the mouse over the item that was made last.
void steer(const UiContext& ui, double side_px, Outbox& out) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool active = ImGui::IsItemActive();
  const double right_px = io.MouseDelta.x, down_px = io.MouseDelta.y;
  if (active && (right_px != 0 || down_px != 0)) {
    const bool turns = ImGui::IsMouseDragging(ImGuiMouseButton_Left, ui.theme.px(3));
    const bool pans = ImGui::IsMouseDown(ImGuiMouseButton_Right) || ImGui::IsMouseDown(ImGuiMouseButton_Middle);
    if (turns || pans)
      out.send(pans ? Command(PanGallery{right_px, down_px, side_px}) : TurnGallery{right_px, down_px});
  }
  if (ImGui::IsItemDeactivated() && ui.state.models.gallery.turning) out.send(LetGoOfGallery{});
  if (!ImGui::IsItemHovered() || io.MouseWheel == 0) return;
  const ModelsState& state = ui.state.models;
  if (gallery_pages(state) == 1 || io.KeyCtrl)
    out.send(ZoomGallery{static_cast<double>(io.MouseWheel)});
  else if (io.MouseWheel < 0 || state.gallery.page > 0)
    out.send(ShowGalleryPage{io.MouseWheel < 0 ? state.gallery.page + 1 : state.gallery.page - 1});
}

void draw_cells(const UiContext& ui, const RectPx& room, Outbox& out) {
  const ModelsState& state = ui.state.models;
  const GalleryGrid grid = page_grid(state, room);
  ImGui::SetCursorPos({0, 0});
  const ImGuiIO& io = ImGui::GetIO();
  const auto under = grid.shape_at(io.MousePos.x, io.MousePos.y);
  const std::string doubt = under && !state.gallery.turning ? doubt_shown(state, *under) : std::string();
  const auto cells = area(ui.theme, "cells", {room.width, room.height},
                          doubt.empty() ? std::string() : state.made.model->names[*under] + " is in doubt: " + doubt,
                          {false, false, true});
  const RectPx first = grid.cell(grid.first);
  steer(ui, std::min(first.width, first.height), out);
  const bool moved_far = ImGui::GetMouseDragDelta(ImGuiMouseButton_Left, 0).x != 0 && state.gallery.turning;
  const bool hovered = ImGui::IsItemHovered() && !state.gallery.turning;
  const auto place =
      hovered ? vertex_at(state, grid, io.MousePos.x, io.MousePos.y, ui.theme.scale) : std::optional<GalleryVertex>();
  if (place != state.gallery.hover && !state.gallery.turning) out.send(PointAtVertex{place});
  if (cells.doubled) {
    out.send(PinVertex{place, true});
  } else if (ImGui::IsItemDeactivated() && !moved_far && ImGui::IsMouseReleased(ImGuiMouseButton_Left)) {
    if (place)
      out.send(PinVertex{place, false});
    else if (const auto shape = grid.shape_at(io.MousePos.x, io.MousePos.y); shape && !state.gallery.turning)
      out.send(SelectCase{state.made.model->names[*shape]});
  }
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const auto from = state.made.model->names.begin() + static_cast<std::ptrdiff_t>(grid.first);
  const std::vector<std::string> names(from, from + static_cast<std::ptrdiff_t>(grid.shapes));
  for (std::size_t k = 0; k < grid.shapes; ++k) draw_cell(draw, ui, grid, grid.first + k, names);
}

void draw_phantom_buttons(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  for (const Organ organ : {Organ::vertebra, Organ::kidney, Organ::ventricle}) {
    const std::string what = organ == Organ::ventricle ? "phases" : "subjects";
    if (button(theme, format("Phantom %s: %d %s", organ_name(organ), phantom_shapes(organ), what.c_str()),
               "Made-up shapes whose true correspondence is known", {}, ImGui::GetContentRegionAvail().x))
      out.send(OpenPhantomStudy{organ});
  }
}

/// What to do with cases that have no shape yet: first a template of all of them, then the fits.
void draw_first_fits(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  explanation(theme, state.made.error.empty() ? "No case of the study has a shape yet." : state.made.error);
  const std::size_t maps = cases_with_labels(state);
  const bool has_template = !state.study.template_file.empty();
  if (state.runs.listing || waiting_cases(state) == 0 || maps < enough_for_consensus || has_template) return;
  gap(theme, 4);
  explanation(theme, "A template of all of them depends on no single subject, and its fits are better.");
  if (button(theme, "Make a consensus template\xe2\x80\xa6", format("The mean shape of the %zu label maps", maps),
             ButtonOptions{.width_px = ImGui::GetContentRegionAvail().x, .primary = true}))
    out.send(ShowFileDialog{FilePurpose::make_study_template, study_stem(state) + "-template.ply"});
}

/// What to do where there is no model.
void draw_start(const UiContext& ui, const RectPx& room, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const float width = std::min(theme.px(360), room.width - theme.px(32));
  ImGui::SetCursorPos({std::floor((room.width - width) / 2), std::floor(room.height / 4)});
  ImGui::BeginChild("start", {width, 0}, false, ImGuiWindowFlags_NoBackground);
  if (state.runs.modelling) {
    explanation(theme, "Making the model…");
    progress_bar(theme, state.runs.modelling_fraction);
  } else if (!state.study.cases.empty()) {
    draw_first_fits(ui, out);
  } else {
    explanation(
        theme,
        "A model is made of shapes in correspondence: meshes of one template, from Homolog or another program. Label "
        "maps become such shapes by a fit.");
    gap(theme, 4);
    if (button(theme, std::string(icon::plus) + "  Add meshes\xe2\x80\xa6",
               "Cases, or meshes: " + listed(shape_extensions(), " or "),
               ButtonOptions{.width_px = ImGui::GetContentRegionAvail().x, .primary = true}))
      out.send(ShowFileDialog{FilePurpose::add_shapes, {}});
    if (button(theme, std::string(icon::plus) + "  Add scans or label maps\xe2\x80\xa6",
               "A folder. Each becomes a case that waits for its fit", {}, ImGui::GetContentRegionAvail().x))
      out.send(ShowFileDialog{FilePurpose::add_scans, {}});
    if (button(theme, std::string(icon::open) + "  Open a study\xe2\x80\xa6", "A .study.json file (Ctrl+O)", {},
               ImGui::GetContentRegionAvail().x))
      out.send(ShowFileDialog{FilePurpose::open_study, {}});
    gap(theme, 4);
    draw_phantom_buttons(ui, out);
  }
  ImGui::EndChild();
}

}  // namespace

void draw_gallery(const UiContext& ui, const ModelsLayout& layout, Outbox& out) {
  begin_region("gallery header", layout.gallery_header, palette::surface);
  draw_header_row(ui, layout.gallery_header, out);
  if (ui.state.models.made.model) draw_tools_row(ui, layout.gallery_header, out);
  end_region();
  begin_region("gallery", layout.gallery, IM_COL32_BLACK_TRANS);
  if (ui.state.models.made.model)
    draw_cells(ui, layout.gallery, out);
  else
    draw_start(ui, layout.gallery, out);
  end_region();
}

namespace {

void draw_difference_legend(const UiContext& ui, const RectPx& rect) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const double most_mm =
      difference_scale_mm(difference_of_groups_mm(*state.made.model, state.view.compared[0], state.view.compared[1]));
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float x0 = rect.x + theme.px(12), x1 = rect.x + rect.width - theme.px(12);
  const float y = rect.y + rect.height - theme.px(28), bar = theme.px(6), middle = std::round((x0 + x1) / 2);
  const ImU32 low = to_im(difference_colour(-1)), none = to_im(difference_colour(0)),
              high = to_im(difference_colour(1));
  draw.AddRectFilled({rect.x, y - theme.px(8)}, {rect.x + rect.width, rect.y + rect.height}, IM_COL32(0, 0, 0, 150));
  draw.AddRectFilledMultiColor({x0, y}, {middle, y + bar}, low, none, none, low);
  draw.AddRectFilledMultiColor({middle, y}, {x1, y + bar}, none, high, high, none);
  const float text_y = y + bar + theme.px(2);
  const std::string inwards = format("\xe2\x88\x92%g mm", most_mm), outwards = format("+%g mm", most_mm);
  const auto width = [&](const std::string& t) {
    return theme.small->CalcTextSizeA(theme.small->FontSize, 1e6f, 0, t.c_str()).x;
  };
  shadowed(draw, theme.small, {x0, text_y}, palette::mark_dim, inwards);
  shadowed(draw, theme.small, {middle - width("0") / 2, text_y}, palette::mark_dim, "0");
  shadowed(draw, theme.small, {x1 - width(outwards), text_y}, palette::mark_dim, outwards);
}

std::string model_title(const ModelsState& state) {
  if (state.view.show_difference) return state.view.compared[1] + " against " + state.view.compared[0];
  const bool mean =
      std::all_of(state.view.deviations.begin(), state.view.deviations.end(), [](double d) { return d == 0; });
  return std::string(mean ? "Mean shape" : "Shape of the model") + (state.made.optimisation.shown ? ", optimised" : "");
}

}  // namespace

void draw_model_view(const UiContext& ui, const ModelsLayout& layout, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  begin_region("model header", layout.model_header, palette::surface);
  const RectPx& header = layout.model_header;
  text_at(*ImGui::GetWindowDrawList(), theme.strong,
          {header.x + theme.px(12), std::floor(header.y + (header.height - theme.strong->FontSize) / 2)}, palette::text,
          state.made.model ? cut(theme.strong, model_title(state), header.width - theme.px(24)) : std::string("Model"));
  end_region();
  begin_region("model", layout.model, state.made.model ? IM_COL32_BLACK_TRANS : palette::surface);
  if (state.made.model) {
    ImGui::SetCursorPos({0, 0});
    area(theme, "shape", {layout.model.width, layout.model.height}, {}, {false, false, true});
    const RectPx shown = legend_room(state, theme.scale).left_of(layout.model);
    steer(ui, std::min(shown.width, shown.height), out);
    const auto vertex = marked_vertex(state);
    if (vertex && !state.view.animated_mode) {
      const Points points = state.view.show_difference ? state.made.model->mean.points
                                                       : shape_of(state.made.model->model, shown_coefficients(state));
      draw_marker(*ImGui::GetWindowDrawList(), theme, state, shown, points, *vertex, false);
    }
    if (state.view.show_difference) draw_difference_legend(ui, layout.model);
  }
  end_region();
}

}  // namespace homolog
