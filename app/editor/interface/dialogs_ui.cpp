#include <algorithm>
#include <cmath>
#include <optional>

#include "app/editor/interface/dialog_frame.h"
#include "app/editor/interface/interface.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/update/keys.h"
#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/key_focus.h"
#include "app/editor/widgets/widgets.h"

#include <imgui_internal.h>  // the order of windows

namespace homolog {

bool begin_dialog(const UiContext& ui, const char* title, float width_units, float height_units) {
  const Theme& theme = ui.theme;
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  // Over all else: what lies under it is neither clicked nor explained.
  begin_region("shade", {0, 0, display.x, display.y}, IM_COL32(0, 0, 0, 110));
  ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());
  end_region();
  const ImVec2 size{std::min(theme.px(width_units), display.x - theme.px(32)),
                    height_units > 0 ? std::min(theme.px(height_units), display.y - theme.px(32)) : 0};
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {theme.px(20), theme.px(16)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  ImGui::PushStyleColor(ImGuiCol_WindowBg, palette::dialog);
  ImGui::Begin(title, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   (height_units > 0 ? 0 : ImGuiWindowFlags_AlwaysAutoResize));
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(2);
  ImGui::SetWindowFocus();
  key_focus().mark_dialog();
  ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());
  enter_part(title);
  ImGui::PushFont(theme.strong);
  text_line(title);
  ImGui::PopFont();
  ImGui::SameLine(ImGui::GetWindowWidth() - theme.px(44));
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() - theme.px(4));
  const bool closed = icon_button(theme, icon::close, "close", "Close (Escape)", {}, false, 24);
  gap(theme, 2);
  return !closed;
}

void end_dialog() {
  leave_part();
  ImGui::End();
}

namespace {

void close_dialog(Outbox& out) {
  out.send(CloseDialog{});
}

/// A key or a movement of the mouse, and what it does.
struct KeysRow {
  std::string keys, does;
};

std::vector<KeysRow> mouse_rows(bool in_models) {
  if (in_models)
    return {{"Left-drag", "turns all shapes"},  {"Middle- or right-drag", "moves all shapes"},
            {"Wheel", "pages, or zoom of one"}, {"Ctrl+wheel", "zoom"},
            {"Click", "marks a vertex"},        {"Double-click", "looks at a vertex"}};
  return {{"Left-drag on the outline", "the tool"},
          {"Ctrl+left-drag", "draws a contour"},
          {"Wheel", "slices; while dragging: \xcf\x83"},
          {"Ctrl+wheel", "zoom"},
          {"Middle-drag", "pan"},
          {"Right-drag", "window and level"},
          {"Shift+mouse", "cross-hair"},
          {"Double-click", "one view, or all four"},
          {"Left-drag beside the mesh", "turns the 3D view"},
          {"Alt while painting", "erases"}};
}

void draw_keys(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  std::vector<KeysRow> rows = mouse_rows(ui.state.models.shown);
  for (const KeyRow& row : key_rows(ui.state.models.shown)) rows.push_back({row.keys, row.does});
  const std::size_t in_column = (rows.size() + 1) / 2;
  // As wide as the widest texts: keys and what they do, in two columns.
  std::array<float, 4> widths{};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t first = i < in_column ? 0 : 2;
    widths[first] = std::max(widths[first], text_size(theme.body, rows[i].keys).x + theme.px(20));
    widths[first + 1] = std::max(widths[first + 1], text_size(theme.body, rows[i].does).x + theme.px(28));
  }
  const float side = theme.px(20), top = theme.px(56), width = widths[0] + widths[1] + widths[2] + widths[3];
  const float display_height = ImGui::GetIO().DisplaySize.y / theme.scale;
  constexpr float row_units = 21;
  const float height = 56 + row_units * static_cast<float>(in_column + 1);
  if (!begin_dialog(ui, "Keys and mouse", (width + 2 * side) / theme.scale - 8, std::min(height, display_height - 32)))
    close_dialog(out);
  ImGui::SetCursorPos({side + text_size(theme.strong, "Keys and mouse").x + theme.px(20), theme.px(16)});
  text_line("Homolog is a tool for research. It is not a medical device.", palette::dim);
  ImGui::SetCursorPos({0, top});
  ImGui::BeginChild("keys");
  key_focus().mark_text(theme.px(row_units));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t first = i < in_column ? 0 : 2;
    const float left = side + (first == 0 ? 0 : widths[0] + widths[1]);
    const float y = theme.px(row_units * static_cast<float>(i % in_column));
    ImGui::SetCursorPos({left, y});
    text_line(rows[i].keys, palette::dim);
    ImGui::SetCursorPos({left + widths[first], y});
    text_line(rows[i].does);
  }
  ImGui::EndChild();
  end_dialog();
}

void draw_series(const UiContext& ui, const SeriesDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!begin_dialog(ui, "This folder contains several series", 560, 0)) close_dialog(out);
  explanation(theme, "Choose the one to open.");
  for (const SeriesInfo& series : dialog.series) {
    const std::string name = series.description.empty() ? series.uid : series.description;
    const std::string label = format("%s  %s  (%d %s)", series.modality.c_str(), name.c_str(), series.files,
                                     series.files == 1 ? "file" : "files");
    const Part part(series.uid, "series");
    if (button(theme, label, series.uid, {}, ImGui::GetContentRegionAvail().x)) {
      OpenRequest request = dialog.request;
      request.volume_options.series_uid = series.uid;
      out.send(OpenRequested{std::move(request)});
      close_dialog(out);
    }
  }
  end_dialog();
}

/// An answer to what a dialog asks: a button.
struct Answer {
  std::string label, tip;
  bool is_main = false;
};

/// The end of a dialog that has two answers, side by side. Gives the one that was pressed, 0 or 1; none: neither.
std::optional<int> end_with_answers(const Theme& theme, const Answer& first, const Answer& second) {
  gap(theme, 4);
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(8)) / 2;
  std::optional<int> pressed;
  if (button(theme, first.label, first.tip, ButtonOptions{.width_px = half, .primary = first.is_main})) pressed = 0;
  ImGui::SameLine();
  if (button(theme, second.label, second.tip, ButtonOptions{.width_px = half, .primary = second.is_main})) pressed = 1;
  end_dialog();
  return pressed;
}

void draw_flip(const UiContext& ui, const FlipDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!begin_dialog(ui, "Are the mesh's coordinates RAS?", 520, 0)) close_dialog(out);
  explanation(theme, "If its coordinates are LPS, " + dialog.name +
                         " lies outside the image. If they are RAS (left-right and front-back exchanged), it lies in "
                         "the image. Until you choose, it is in the middle of the image.");
  const auto answer =
      end_with_answers(theme, {"Flip RAS to LPS", "Exchanges left-right and front-back (negates x and y)", true},
                       {"Leave it in the middle", "Then place it by hand"});
  if (!answer) return;
  if (*answer == 0) {
    out.apply(SetPlacement{dialog.placement});
    out.send(LookAt{dialog.bounds_mm.center()});
  }
  close_dialog(out);
}

/// A button without a fill until it is pointed at.
bool quiet_button(const Theme& theme, const std::string& label, const std::string& tip, float width_px) {
  ImGui::PushStyleColor(ImGuiCol_Button, IM_COL32_BLACK_TRANS);
  ImGui::PushStyleColor(ImGuiCol_Text, palette::dim);
  const bool pressed = button(theme, label, tip, {}, width_px);
  ImGui::PopStyleColor(2);
  return pressed;
}

/// A case that was not saved: a click on its row recovers it. Where its deletion was asked for, the second word for it
/// is not where the first click was.
void draw_unsaved_case(const UiContext& ui, const RecoverDialog::Found& found, bool asked, Outbox& out) {
  const Theme& theme = ui.theme;
  const Part part(found.journal.string(), "unsaved case");
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float whole = ImGui::GetContentRegionAvail().x, height = theme.px(44), gap_px = theme.px(4);
  const float first = theme.px(90), second = theme.px(82), buttons = asked ? first + gap_px + second : first;
  const float width = whole - buttons - theme.px(8), top = ImGui::GetCursorPosY(), left = ImGui::GetCursorPosX();
  const std::string name = shortened(found.name, width - theme.px(16));
  const AreaState row = area(theme, "Recover", {width, height},
                             (name == found.name ? "" : found.name + "\n") + "Click to open it as it was");
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  if (row.hovered) draw.AddRectFilled(at, {at.x + width, at.y + height}, palette::raised, theme.px(4));
  const float line = ImGui::GetTextLineHeight();
  text_at(draw, {at.x + theme.px(8), at.y + theme.px(4)}, row.hovered ? palette::accent : palette::text, name);
  ImGui::PushFont(theme.small);
  text_at(draw, {at.x + theme.px(8), at.y + theme.px(6) + line}, palette::dim,
          shortened(found.details, width - theme.px(16)));
  ImGui::PopFont();
  if (row.clicked) {
    out.send(open_case_file(found.journal));
    close_dialog(out);
  }
  ImGui::SetCursorPos({left + whole - buttons, top + std::floor((height - theme.px(28)) / 2)});
  const auto ask_for = [&](const std::filesystem::path& journal) { out.send(AskToDiscard{journal}); };
  if (asked) {
    if (quiet_button(theme, "Delete it", "The work in it is lost for good", first))
      out.send(DiscardCase{found.journal});
    ImGui::SameLine(0, gap_px);
    if (button(theme, "Keep it", "It is offered again at the next start",
               ButtonOptions{.width_px = second, .primary = true}))
      ask_for({});
  } else if (quiet_button(theme, "Discard…", "Asks first, then deletes the case", first)) {
    ask_for(found.journal);
  }
  ImGui::SetCursorPos({left, top + height + ImGui::GetStyle().ItemSpacing.y / 2});
}

void draw_recover(const UiContext& ui, const RecoverDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!begin_dialog(ui, "Cases that were not saved", 560, 0)) close_dialog(out);
  explanation(theme,
              "The program ended before these cases were saved. Every finished edit is kept. Click one to open it.");
  for (const auto& found : dialog.found) draw_unsaved_case(ui, found, dialog.to_discard == found.journal, out);
  gap(theme, 4);
  if (button(theme, "Later", "They are offered again at the next start", {}, ImGui::GetContentRegionAvail().x))
    close_dialog(out);
  end_dialog();
}

/// Which label of the maps is the organ.
void draw_label_choice(const UiContext& ui, const LabelDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  const bool fits = dialog.template_file.empty();
  const auto choose = [&](int label, bool all_labels) {
    if (fits)
      out.send(FitWaiting{label, all_labels});
    else
      out.send(MakeStudyTemplate{{dialog.template_file}, label, all_labels});
  };
  constexpr std::size_t most_rows = 8, columns = 3;
  const std::size_t rows = (dialog.labels.size() + columns - 1) / columns;
  if (!begin_dialog(ui, "Which label is the organ?", 520, 0)) close_dialog(out);
  explanation(
      theme, dialog.map + format(fits ? " holds %zu labels. The one that you choose is fitted in every case that waits."
                                      : " holds %zu labels. The template is made of the one that you choose.",
                                 dialog.labels.size()));
  gap(theme, 4);
  const float spacing = ImGui::GetStyle().ItemSpacing.y;
  ImGui::BeginChild("labels", {0, (theme.px(28) + spacing) * static_cast<float>(std::min(rows, most_rows)) - spacing});
  const float width = std::floor((ImGui::GetContentRegionAvail().x - 2 * theme.px(8)) / columns);
  for (std::size_t k = 0; k < dialog.labels.size(); ++k) {
    if (k % columns > 0) ImGui::SameLine(0, theme.px(8));
    const Segment& one = dialog.labels[k];
    const std::string words = label_words(one);
    const Part part(std::to_string(one.value), "label");
    if (button(theme, one.name.empty() ? format("Label %d", one.value) : one.name,
               (fits ? "Fits " : "Takes ") + words + (fits ? " in all cases" : " of all cases"), {}, width))
      choose(one.value, false);
  }
  ImGui::EndChild();
  if (button(theme, "All labels together", "Takes all labels of each map as one organ", {},
             ImGui::GetContentRegionAvail().x))
    choose(0, true);
  end_dialog();
}

void draw_replace(const UiContext& ui, const ReplaceDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!begin_dialog(ui, "Replace the file?", 520, 0)) close_dialog(out);
  explanation(theme, dialog.there.string() + " exists already.");
  const auto answer = end_with_answers(theme, {"Replace it", "Its content now is lost"},
                                       {"Choose another name", "Back to the files", true});
  if (answer == 0) out.send(AcceptReplacement{});
  if (answer == 1) out.send(ChooseOtherName{});
}

void draw_quit(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!begin_dialog(ui, "This case was not saved", 520, 0)) close_dialog(out);
  const bool kept = !ui.snapshot().file.empty();
  explanation(theme,
              kept ? "It is kept, and offered again at the next start."
                   : "It could not be written to the disk. Save it in a folder that you may write to, or it is lost.");
  const auto answer = end_with_answers(
      theme, {"Save as…", "Choose a name", true},
      {kept ? "Quit" : "Lose it and quit", kept ? "Nothing is lost" : "Every edit of this case is lost"});
  if (answer == 0) out.send(SaveCase{true});
  if (answer == 1) out.send(Quit{true});
}

void draw_quit_without_study(const UiContext& ui, const std::filesystem::path& study, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!begin_dialog(ui, "The study was not saved", 520, 0)) close_dialog(out);
  explanation(theme, study.string() + " could not be written. Save the study in a folder that you may write to.");
  const auto answer =
      end_with_answers(theme, {"Save study as…", "Choose a name", true},
                       {"Quit without it", "Changes to the list of cases, states, groups and notes are lost"});
  if (answer == 0) out.send(ShowFileDialog{FilePurpose::save_study, study.filename().string()});
  if (answer == 1) out.send(Quit{true, true});
}

void draw_spacing(const UiContext& ui, const SpacingDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!begin_dialog(ui, "How large is a voxel?", 440, 0)) close_dialog(out);
  explanation(theme, "PNG and TIFF files do not say it. Type the distance between columns, rows and slices:");
  Vec3 spacing = dialog.spacing_mm;
  const float width = (ImGui::GetContentRegionAvail().x - 2 * theme.px(4)) / 3;
  bool released = false, changed = false;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) ImGui::SameLine(0, theme.px(4));
    changed |= number_field(theme, format("spacing %d", axis).c_str(), spacing[axis], released,
                            {.per_px = 0.01,
                             .format = "%.3f",
                             .unit = "mm",
                             .width_px = width,
                             .limits = {.low = 1e-3, .high = 1000, .name = "The distance"}});
  }
  if (changed) out.send(SetStackSpacing{spacing});
  gap(theme, 4);
  if (button(theme, "Open", "With these voxels",
             ButtonOptions{.width_px = ImGui::GetContentRegionAvail().x, .primary = true})) {
    OpenRequest request = dialog.request;
    request.volume_options.stack_spacing_mm = spacing;
    out.send(OpenRequested{std::move(request)});
    close_dialog(out);
  }
  end_dialog();
}

void draw_resample(const UiContext& ui, const ResampleDialog& dialog, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!begin_dialog(ui, "The slices are no even stack", 520, 0)) close_dialog(out);
  explanation(theme, "The series has " + dialog.why +
                         ". It can be shown on a rectangular grid. Values between two slices are then interpolated, "
                         "and the case remembers it.");
  const auto answer = end_with_answers(
      theme,
      {"Resample and open", "Reads the slices onto a grid with even distances. The files stay as they are", true},
      {"Do not open it", "Then copy the whole series again, or choose another"});
  if (!answer) return;
  if (*answer == 0) {
    OpenRequest request = dialog.request;
    request.volume_options.resample = true;
    out.send(OpenRequested{std::move(request)});
  }
  close_dialog(out);
}

}  // namespace

void draw_dialogs(const UiContext& ui, Outbox& out) {
  if (!ui.state.dialog) return;
  const Dialog& dialog = *ui.state.dialog;
  if (std::holds_alternative<KeysDialog>(dialog))
    draw_keys(ui, out);
  else if (const auto* files = std::get_if<FileDialog>(&dialog))
    draw_file_dialog(ui, *files, out);
  else if (const auto* replace = std::get_if<ReplaceDialog>(&dialog))
    draw_replace(ui, *replace, out);
  else if (const auto* series = std::get_if<SeriesDialog>(&dialog))
    draw_series(ui, *series, out);
  else if (const auto* flip = std::get_if<FlipDialog>(&dialog))
    draw_flip(ui, *flip, out);
  else if (const auto* recover = std::get_if<RecoverDialog>(&dialog))
    draw_recover(ui, *recover, out);
  else if (const auto* labels = std::get_if<LabelDialog>(&dialog))
    draw_label_choice(ui, *labels, out);
  else if (const auto* spacing = std::get_if<SpacingDialog>(&dialog))
    draw_spacing(ui, *spacing, out);
  else if (const auto* resample = std::get_if<ResampleDialog>(&dialog))
    draw_resample(ui, *resample, out);
  else if (const auto* quit = std::get_if<QuitDialog>(&dialog); quit->study.empty())
    draw_quit(ui, out);
  else
    draw_quit_without_study(ui, quit->study, out);
}

}  // namespace homolog
