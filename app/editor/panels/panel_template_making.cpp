#include <algorithm>
#include <cmath>
#include <iterator>

#include "app/editor/panels/models/models_panel.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/files/file_stem.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/label_body.h"
#include "render/label_colours.h"

// The making of a template from the label map that is shown, in the section Template.

namespace homolog {

namespace {

void whole_number(const Theme& theme, const char* label, int& value, const SliderRange& range, const char* tip,
                  bool& changed) {
  bool released = false;
  double number = value;
  if (slider(theme, label, number, range, tip, released)) {
    value = static_cast<int>(number + 0.5);
    changed = true;
  }
}

void draw_organ_settings(const UiContext& ui, int label, MaskTemplateOptions& options, bool& changed) {
  const Theme& theme = ui.theme;
  whole_number(theme, "Vertices", options.vertices, {500, 40000, "%.0f", "", true, true},
               "How many vertices the template gets", changed);
  changed |=
      ball_slider(ui, "Closing", options.closing_mm, label,
                  "Radius. Fills clefts that are narrower than twice the radius. Where you leave it, wider ones are "
                  "tried on the label too, and the template keeps the one for its fits");
  changed |= ball_slider(ui, "Opening", options.opening_mm, label,
                         "Radius. Removes spurs that are thinner than twice the radius");
  caption(theme, "Tunnels through the organ");
  int rule = options.genus.kind == GenusRule::Kind::automatic ? 0
             : options.genus.kind == GenusRule::Kind::keep    ? 1
             : options.genus.genus == 0                       ? 2
                                                              : 3;
  if (choice(theme, "tunnels", {"Auto", "Keep", "None", "One"}, rule,
             {.tips = {"Cuts tunnels narrower than 3.5 % of the organ's size. A vertebral canal stays",
                       "Every tunnel stays", "Cuts all tunnels",
                       "Keeps the widest tunnel and cuts all others, as for a vertebra"}})) {
    options.genus = rule == 0   ? GenusRule{}
                    : rule == 1 ? GenusRule{GenusRule::Kind::keep, 0}
                                : GenusRule{GenusRule::Kind::number, rule == 2 ? 0 : 1};
    changed = true;
  }
}

/// The labels beside the one that a template is made of, to choose those that its part faces.
void draw_part_settings(const UiContext& ui, int label, TemplateSettings& settings, bool& changed) {
  const Theme& theme = ui.theme;
  whole_number(theme, "Vertices", settings.mask.vertices, {500, 40000, "%.0f", "", true, true},
               "How many vertices the template gets", changed);
  changed |= ball_slider(ui, "Closing", settings.mask.closing_mm, label,
                         "Radius. Fills clefts that are narrower than twice the radius");
  int rule = settings.faced.kept ? 0 : 1;
  if (choice(theme, "part", {"Facing", "Open at"}, rule,
             {.tips = {"The part of the surface that faces the labels below, as a joint faces its cartilage",
                       "The surface without what faces the labels below, as a ventricle without its valves"}})) {
    settings.faced.kept = rule == 0;
    changed = true;
  }
  constexpr std::size_t most_rows = 6;
  constexpr float row = 32;
  std::vector<int> others{0};
  std::ranges::copy_if(ui.labels().values, std::back_inserter(others), [&](int value) { return value != label; });
  auto& faced = settings.faced.values;
  // What another map had is forgotten.
  std::erase_if(faced, [&](int value) { return std::ranges::find(others, value) == others.end(); });
  ImGui::BeginChild("faced", {0, theme.px(row) * static_cast<float>(std::min(most_rows, others.size()))});
  for (const int value : others) {
    const Part part("faced");
    ImGui::PushID(value);
    bool on = std::ranges::find(faced, value) != faced.end();
    const std::string name = value == 0 ? "Background" : ui.labels().label_name(value);
    if (toggle(theme, name.c_str(), on, value == 0 ? "What has no label" : "Click: the part faces it, or does not")) {
      std::erase(faced, value);
      if (on) faced.push_back(value);
      std::ranges::sort(faced);
      changed = true;
    }
    ImGui::PopID();
  }
  ImGui::EndChild();
}

void draw_tube_settings(const UiContext& ui, int label, TemplateSettings& settings, bool& changed) {
  const Theme& theme = ui.theme;
  whole_number(theme, "Rings", settings.tube_options.rings, {6, 100, "%.0f", "", false, true},
               "From the base to the apex", changed);
  whole_number(theme, "Sectors", settings.tube_options.sectors, {12, 128, "%.0f", "", false, true},
               "Vertices of a ring", changed);
  const std::string no_ruler = ui.state.hand.ruler ? "" : "Draw the ruler (D) from the base to the apex first.";
  bool by_ruler = settings.axis_by_ruler;
  if (toggle(theme, "Axis by the ruler", by_ruler,
             "On: the ruler is the axis, from the base to the apex. Off: the slices' normal where slices are thick, or "
             "the "
             "label's main axis",
             no_ruler)) {
    settings.axis_by_ruler = by_ruler;
    changed = true;
  }
  changed |= toggle(theme, "Close the base", settings.tube_options.capped, "Closes the base flat. Off leaves it open");
  bool wall = settings.outer_label != 0;
  const auto other =
      std::find_if(ui.labels().values.begin(), ui.labels().values.end(), [&](int value) { return value != label; });
  const bool has_other = other != ui.labels().values.end();
  if (toggle(theme, "Add the outer sheet", wall,
             has_other ? "A second sheet around label " + std::to_string(*other) + " (epicardium)" : std::string(),
             has_other ? std::string() : "The label map holds one label only.")) {
    settings.outer_label = wall ? *other : 0;
    changed = true;
  }
}

void draw_stages(const UiContext& ui, const TemplateMaking& making, Outbox& out) {
  const Theme& theme = ui.theme;
  caption(theme, "Stages (click to look at one)");
  for (std::size_t i = 0; i < making.stages.size(); ++i) {
    const auto& stage = making.stages[i];
    const bool shown = ui.state.look.shown_stage ? *ui.state.look.shown_stage == i : i + 1 == making.stages.size();
    const std::string name = format("%zu  %s", i + 1, stage.name.c_str());
    const std::string time = format("%.2f s", stage.seconds);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float room = ImGui::GetContentRegionAvail().x, time_width = ImGui::CalcTextSize(time.c_str()).x;
    const float height = theme.px(24);
    if (list_row(theme, shortened(name, room - time_width - theme.px(16)), shown, {room, height}).clicked)
      out.send(ShowTemplateStage{i});
    text_at(*ImGui::GetWindowDrawList(),
            {at.x + room - time_width - theme.px(4), at.y + (height - ImGui::GetFontSize()) / 2}, palette::dim, time);
  }
}

void draw_result(const UiContext& ui, const TemplateMaking& making, Outbox& out) {
  const Theme& theme = ui.theme;
  draw_quality_report(theme, *making.mesh, making.quality, making.settings.tube);
  figure(theme, "Template to label", format("%.2f mm, at most %.1f", making.to_mask.mean_mm, making.to_mask.max_mm),
         "Mean and largest distance from the template's surface to the label's");
  figure(theme, "Label to template", format("%.2f mm, at most %.1f", making.from_mask.mean_mm, making.from_mask.max_mm),
         "Mean and largest distance from the label's surface to the template's. It also shows clefts that the template "
         "does not follow");
  if (!making.missing.empty()) text_lines(making.missing, palette::amber);
  for (const std::string& remark : making.remarks) explanation(theme, remark);
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  if (button(theme, "Save and use…", "Saves the template and starts a new case with it",
             ButtonOptions{.width_px = half, .primary = true}))
    out.send(ShowFileDialog{FilePurpose::use_made_template, file_stem(making.source) + "-template"});
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Back", "Goes back to the template made before this one",
             ui.work.template_maker.can_undo() ? "" : "No template was made before this one.", half))
    out.send(UndoTemplate{});
}

/// The label that a template is made of. While none was chosen for this map, it is the one that the mesh lies in, or
/// else the cross-hair.
int template_label(const UiContext& ui) {
  const auto& known = ui.labels().values;
  const auto is_known = [&](int label) { return std::find(known.begin(), known.end(), label) != known.end(); };
  const int chosen = ui.state.automatic.template_settings.label;
  if (known.empty() || is_known(chosen)) return chosen;
  if (ui.has_shape())
    if (const int there = label_at_mesh(*ui.labels().volume, ui.document().frame, *ui.shown().shape.points);
        is_known(there))
      return there;
  const int there = label_there(ui, ui.state.look.crosshair_mm);
  return is_known(there) ? there : known.front();
}

/// The labels of the map that is open, to choose one; true where another is chosen.
bool label_list(const UiContext& ui, int& label, bool& all_labels) {
  const auto& known = ui.labels().values;
  if (known.empty()) {
    // The list is there before it has anything to choose: what lies below stays where it is.
    int none = 0;
    ImGui::BeginDisabled();
    combo(ui.theme, "label", {"No label map is open"}, none);
    ImGui::EndDisabled();
    return false;
  }
  auto now = std::find(known.begin(), known.end(), label);
  const bool absent = now == known.end();
  if (absent) now = known.begin();
  label = *now;
  std::vector<std::string> names;
  std::vector<ImU32> swatches;
  const auto swatch = [&](const Rgb& colour) {
    swatches.push_back(ImGui::ColorConvertFloat4ToU32({colour[0], colour[1], colour[2], 1}));
  };
  for (const int value : known) {
    names.push_back(ui.labels().label_name(value));
    swatch(label_colour(value, ui.labels().colours.get()));
  }
  names.emplace_back("All labels");
  swatch({0.5f, 0.5f, 0.5f});
  const int all = static_cast<int>(known.size());
  int chosen = all_labels ? all : static_cast<int>(now - known.begin());
  const bool changed = combo(ui.theme, "label", names, chosen, swatches);
  all_labels = chosen == all;
  if (!all_labels) label = known[chosen];
  return absent || changed;
}

}  // namespace

bool ball_slider(const UiContext& ui, const char* name, std::optional<double>& radius_mm, int label,
                 const std::string& tip) {
  const auto size = ui.labels().sizes_mm.find(label);
  double radius = radius_mm.value_or(size == ui.labels().sizes_mm.end() ? 1 : ball_share * size->second);
  bool released = false;
  if (!slider(ui.theme, name, radius, {0, 10, "%.1f", "mm", false}, tip, released)) return false;
  radius_mm = radius;
  return true;
}

bool label_choice(const UiContext& ui, int& label, bool& all_labels, const std::string& open_tip, Outbox& out) {
  const bool changed = label_list(ui, label, all_labels);
  if (button(ui.theme, "Open a label map…", open_tip, {}, ImGui::GetContentRegionAvail().x))
    out.send(ShowFileDialog{FilePurpose::open_labels, {}});
  return changed;
}
void draw_quality_report(const Theme& theme, const Mesh& mesh, const MeshQuality& quality, bool fans) {
  figure(theme, "Vertices", format("%ld", static_cast<long>(mesh.points.rows())));
  figure(theme, "Surface", format("%s, genus %d", mesh.topology->closed() ? "closed" : "open", mesh.topology->genus()),
         "Openings count as closed flat. Genus is the number of tunnels");
  figure(theme, "Edges", format("%.2f mm \xc2\xb1 %.0f %%", quality.edge_mean, 100 * quality.edge_cv),
         format("Mean length and its standard deviation; %.2f to %.2f mm", quality.edge_min, quality.edge_max));
  figure(
      theme, "Smallest angle", format("%.1f\xc2\xb0", quality.min_angle_deg),
      fans
          ? "In a triangle of equal sides it is 60\xc2\xb0. At the apex of a tube triangles meet in a fan, so they are "
            "thin there"
          : "In a triangle of equal sides it is 60\xc2\xb0",
      quality.min_angle_deg < 20 && !fans ? palette::amber : palette::text);
  figure(theme, "Six neighbours", format("%.0f %%", 100 * quality.regular_share),
         "Share of the vertices that have six neighbours");
  figure(theme, "Self-intersections", format("%zu%s", quality.self_intersections, quality.all_intersections ? "" : "+"),
         "Pairs of triangles that pass through each other",
         quality.self_intersections > 0 ? palette::amber : palette::text);
}

void draw_template_making(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  caption(theme, "From a label map");
  TemplateSettings settings = ui.state.automatic.template_settings;
  const int own = template_label(ui);
  int label = own;
  bool changed = label_choice(ui, label, settings.all_labels, "A template is made from one of its labels", out);
  if (label != own) {
    settings.label = label;
    std::erase(settings.faced.values, label);
  }
  caption(theme, "What the label is");
  int kind = settings.tube ? 2 : settings.part ? 1 : 0;
  if (choice(
          theme, "template kind", {"Organ", "Part", "Tube"}, kind,
          {.tips = {
               "For any shape: vertices are spread evenly over the surface",
               "The part of its surface that faces other labels, open at its rim: a joint, or a ventricle without its "
               "valves",
               "For a ventricle: rings and sectors along an axis"}})) {
    settings.tube = kind == 2;
    settings.part = kind == 1;
    changed = true;
  }
  if (settings.tube)
    draw_tube_settings(ui, label, settings, changed);
  else if (settings.part)
    draw_part_settings(ui, label, settings, changed);
  else
    draw_organ_settings(ui, settings.all_labels ? every_label : label, settings.mask, changed);
  if (changed) out.send(SetTemplate{settings});

  const float width = ImGui::GetContentRegionAvail().x;
  const auto making = ui.work.template_maker.latest();
  const bool busy = ui.work.template_maker.busy();
  const bool is_part = settings.part && !settings.tube;
  const std::string refusal = busy                                       ? "The template is being made."
                              : !ui.labels().volume                      ? "Open a label map first."
                              : ui.labels().values.empty()               ? "The label map is empty."
                              : is_part && settings.all_labels           ? "A part is of one label. Choose one."
                              : is_part && settings.faced.values.empty() ? "Choose what the part faces first."
                                                                         : "";
  if (button(theme, "Make the template", "You see each stage in the views",
             ButtonOptions{.refusal = refusal, .width_px = width, .primary = !making || !making->mesh})) {
    settings.label = label;
    out.send(MakeTemplate{settings, settings.axis_by_ruler ? ui.state.hand.ruler : std::nullopt});
  }
  if (const std::size_t maps = cases_with_labels(ui.state.models); maps >= enough_for_consensus) {
    if (button(theme, format("Make it of the study's %zu maps\xe2\x80\xa6", maps),
               "The mean shape of all label maps of the study, which no single subject decides. Cases that wait begin "
               "with it",
               ui.state.models.runs.listing ? "The study's cases are in work."
               : is_part                    ? "A template of a study is of whole organs. Choose Organ."
                                            : "",
               width))
      out.send(ShowFileDialog{FilePurpose::make_study_template, study_stem(ui.state.models) + "-template.ply"});
  }
  std::optional<WorkShown> running;
  if (busy) running = {"Making the template", ui.work.template_maker.fraction(), "Stops after this stage"};
  if (work_area(theme, "", running)) out.send(CancelTemplate{});
  if (!making) return;
  if (making->stages.size() > 1) draw_stages(ui, *making, out);  // one alone is shown anyway
  if (!making->error.empty()) explanation(theme, making->error);
  if (making->mesh) draw_result(ui, *making, out);
  if (!making->stages.empty() && button(theme, "Close", "Closes the stages and shows the case's mesh again",
                                        ui.work.template_maker.busy() ? "The template is being made." : "", width))
    out.send(CloseTemplateMaking{});
}

int label_there(const UiContext& ui, const Vec3& p_mm) {
  const int frame = shown_frame(ui.state, ui.document());
  if (!ui.labels().volume || !ui.labels().is_of(frame)) return 0;
  const Vec3 voxel = ui.labels().volume->geometry.to_voxel(p_mm).array().round();
  const auto& dims = ui.labels().volume->geometry.dims;
  for (int axis = 0; axis < 3; ++axis)
    if (voxel[axis] < 0 || voxel[axis] >= dims[axis]) return 0;
  return rounded_label(ui.labels().volume->at(static_cast<int>(voxel.x()), static_cast<int>(voxel.y()),
                                              static_cast<int>(voxel.z()), frame_of_map(*ui.labels().volume, frame)));
}

}  // namespace homolog
