#include "app/editor/update/results/opening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <variant>

#include "app/editor/state/views.h"
#include "app/editor/update/results/imports.h"
#include "app/editor/update/results/kept_choices.h"
#include "core/base/files/paths.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/meeting.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

namespace {

/// Shows them over the image, and says where none of them lies in it. `fitted_frame`: of a cine, that was fitted to
/// them.
void show_labels(Editing& editing, const Opened& opened, std::optional<int> fitted_frame = {}) {
  const std::string name = opened.request.labels.filename().string();
  if (opened.labels_off_image) {
    const bool turned = opened.labels_misfit && opened.labels_misfit->half_turn && opened.labels_misfit->factor == 1;
    // A map of a tenth of the size may well lie elsewhere; of a hundredth no map is.
    const double factor = opened.labels_misfit ? opened.labels_misfit->factor : 1;
    const bool scaled = std::abs(std::log10(factor)) > 1.5;
    add_notice(editing.state, name + " lies outside the image: none of its labels is in it. " +
                                  (turned   ? "It would lie in it if its header meant RAS for LPS. Correct its header."
                                   : scaled ? "The lengths in its header may be in another unit than mm. Correct them."
                                            : "Check that both are of one scan, and that the program that wrote the "
                                              "label map kept its place."));
  }
  const Document& document = editing.shown.document();
  std::optional<int> frame;
  if (document.scan.image && document.scan.image->frames > 1 && opened.labels.front().volume->frames == 1) {
    frame = fitted_frame.value_or(document.frame);
    add_notice(editing.state,
               name + " holds one frame. It is shown at frame " + std::to_string(*frame) +
                   (fitted_frame ? ", which was fitted to it." : ", the one on the screen.") +
                   " If it belongs to another one, go there and press \"It is of this frame\" (Case).",
               false);
  }
  editing.state.look.hidden_labels.reset();
  editing.shown.show_labels({opened.labels.front(), name, absolute_path(opened.request.labels), frame, opened.labels});
}

void start_document(Editing& editing, Document document) {
  document.hold_landmarks();
  const bool edited = editing.shown.snapshot().can_undo;
  const std::filesystem::path before = editing.shown.snapshot().file;
  auto session = create_unsaved_case(document);
  if (!session) {
    add_notice(editing.state, session.error().sentence());
    return start_session(editing, EditSession(std::move(document)));
  }
  start_session(editing, std::move(*session));
  if (!edited || before.empty()) return;
  Notice notice{"A new case was started. The previous case is kept.", false};
  notice.kept = before;
  add_notice(editing.state, std::move(notice));
}

/// What the template's own coordinates say of the image: asks where they lie in it after half a turn, and says where
/// they seem to be in another unit.
void meet_image(EditorState& state, const Document& document) {
  if (!document.scan.image || document.structures.empty()) return;
  const Template& the_template = *document.structure()->the_template;
  if (is_built_in(the_template.source)) return;
  const Box image = document.scan.image->geometry.bounds_mm(), own = bounds_of(the_template.points);
  const auto misfit = misfit_in_image(own, document.scan.image->geometry);
  if (!misfit) return;
  const std::string name = std::filesystem::path(the_template.source).filename().string();
  if (misfit->factor != 1)
    return add_notice(state, misfit_sentence(*misfit, {name, own.diagonal().norm()},
                                             {std::filesystem::path(document.scan.source).filename().string(),
                                              image.diagonal().norm()}) +
                                 ".");
  // To negate x and y is half a turn about z.
  const Similarity flip{Eigen::Quaterniond(0, 0, 0, 1), 1, Vec3::Zero()};
  state.dialog = FlipDialog{name, flip, bounds_of(Points(the_template.points * Vec3(-1, -1, 1).asDiagonal()))};
}

/// Whether a template lies on the image as its own coordinates say.
bool lies_on(const std::shared_ptr<const Template>& the_template, const std::shared_ptr<const Volume>& volume) {
  return the_template && volume && volume->geometry.bounds_mm().intersects(bounds_of(the_template->points));
}

void say_template_stays(EditorState& state, const Template& loaded) {
  add_notice(state,
             "The template " + std::filesystem::path(loaded.source).filename().string() +
                 " of the case before was placed in this image too. Choose another one in Template where it shows "
                 "another organ.",
             false);
}

/// Where the views look.
struct View {
  Vec3 crosshair_mm;
  std::array<SlicePan, 3> slices;
  Camera3D camera;
  bool own_planes;
};

View view_of(const EditorState& state) {
  return {state.look.crosshair_mm, state.look.slices, state.look.camera, state.look.own_planes};
}

void look_as(EditorState& state, const View& view) {
  state.look.crosshair_mm = view.crosshair_mm;
  state.look.slices = view.slices;
  state.look.camera = view.camera;
  state.look.own_planes = view.own_planes;
}

/// An image, a template or a demo: a new case with what is open besides.
void start_with(Editing& editing, Opened opened) {
  const Document& now = *editing.shown.snapshot().document;
  EditorState& state = editing.state;
  const bool new_image = opened.volume != nullptr;
  const auto volume = new_image ? opened.volume : now.scan.image;
  const std::string source = new_image ? opened.request.volume_source : now.scan.source;
  // A case's first line names the template's file, so a mirrored one is loaded as it is there and mirrored again.
  // Nobody chose a built-in template for an image that was not yet open, which may show another organ.
  const auto& loaded = editing.shown.loaded_template();
  const bool foreign = new_image && now.scan.image && loaded && is_built_in(loaded->source);
  const bool stays = !opened.the_template && !foreign;
  const auto the_template = stays ? loaded : opened.the_template;
  if (stays && new_image && now.scan.image && loaded) say_template_stays(state, *loaded);
  const bool mirrored = stays && editing.shown.template_is_mirrored();
  const bool demo = opened.demo.has_value();
  const bool in_place = opened.request.template_in_place && !new_image && lies_on(the_template, volume);
  const View view = view_of(state);
  const int frame = now.frame;
  start_document(editing, opened.demo
                              ? std::move(*opened.demo)
                              : new_document(source, volume, the_template,
                                             in_place ? std::optional<Similarity>(Similarity{}) : std::nullopt));
  if (mirrored && !demo) editing.apply(MirrorTemplate{});
  if (!new_image && !demo && frame > 0) editing.apply(SetFrame{frame});
  if (in_place) look_as(state, view);
  if (demo && editing.shown.document().scan.image->modality == "CT") {
    // Soft tissue: what the demo is about.
    state.look.window_low = -160;
    state.look.window_high = 240;
  }
  if (opened.guide) {
    state.guide = std::move(*opened.guide);
    state.guide->shown = !state.preferences.guide_done;
    look_at_step(state);
  }
  if (new_image && !is_phantom(source)) remember_recent(state.preferences.recent, source);
  if (!opened.labels.empty()) show_labels(editing, opened);
  if (!demo) meet_image(state, *editing.shown.snapshot().document);
}

/// A fit that the case keeps.
struct KeptFit {
  std::string structure;  ///< its id
  int frame = 0;
  Fitted fitted;
};

/// What the case keeps of its last fit, where that mesh is still as the fit left it.
std::optional<KeptFit> kept_fit(const Snapshot& snapshot) {
  const auto& kept = snapshot.kept.fit;
  if (!kept) return std::nullopt;
  for (const auto& structure : snapshot.document->structures)
    for (const auto& [frame, shape] : structure->shapes)
      if (mesh_hash(*shape->points) == kept->mesh)
        return KeptFit{structure->id, frame, {.edit = {.by = FoundBy::fit, .points = shape->points}, .figures = *kept}};
  return std::nullopt;
}

/// Whether two cases show the same image: a folder may hold several series.
bool same_image(const Document* before, const Document& now) {
  if (before == nullptr || !before->scan.image || !now.scan.image) return false;
  return before->scan.source == now.scan.source && before->scan.image->series_uid == now.scan.image->series_uid;
}

/// A click that waits for a second one is of the case in which it was done, and so is its line in the log.
void do_click_of_case(Editing& editing) {
  Outbox now;
  do_held_click(editing.state, editing.controls(), now);
  for (const Command& command : now.take()) run(command, editing);
}

}  // namespace

void start_session(Editing& editing, EditSession session) {
  EditorState& state = editing.state;
  ShownCase& shown = editing.shown;
  const auto before = shown.displayed();
  const std::string source_before = before && before->scan.image ? before->scan.source : std::string();
  const std::filesystem::path folder_before = std::filesystem::path(source_before).parent_path();
  editing.work.snaps.cancel();
  editing.work.contour_fits.cancel();
  state.guide.reset();
  state.found.finding.reset();
  if (shown.is_open()) shown.keep_looks(state);
  const Refusals refused = shown.start(std::move(session));
  const Document& document = shown.document();
  show_document(state, document, editing.layout, same_image(before.get(), document));
  if (std::filesystem::path(document.scan.source).parent_path() != folder_before) state.saving.saved_folder.clear();
  if (const auto& window = shown.snapshot().kept.window)
    std::tie(state.look.window_low, state.look.window_high) = std::pair((*window)[0], (*window)[1]);
  const KeptWithCase& kept = shown.snapshot().kept;
  state.look.structures = looks_of_case(kept.looks.get(), kept.map_fit.get(), document);
  if (kept.looks && !kept.looks->active.empty() && document.structure(kept.looks->active) != nullptr) {
    show_structure(state, document, kept.looks->active);
    bring_into_view(state, document);
  }
  if (kept.looks) bring_back_choices(editing, *kept.looks);
  const Layout& layout = editing.layout;
  state.look.show_all_wanted = layout.scale <= 0 || layout.status_line.width <= 0 || layout.models.width > 0;
  if (!state.look.show_all_wanted) show_repair(editing);
  remember_case(state, shown.snapshot());
  for (const std::string& sentence : told(refused)) add_notice(state, "In the case before: " + sentence);
  if (document.scan.image != (before ? before->scan.image : nullptr)) editing.pictures.forget();
  editing.work.measurements.post(nullptr);
  editing.work.scores.post(nullptr);
  editing.work.quality.post(nullptr);
  editing.work.quality.post(shown.displayed(), editing.state.look.structure);
}

void show_repair(Editing& editing) {
  if (const auto frame = Models::show_repair(editing.state, editing.shown.snapshot())) editing.apply(SetFrame{*frame});
}

void show_opened(Editing& editing, Opened opened) {
  EditorState& state = editing.state;
  for (auto& warning : opened.warnings) add_notice(state, std::move(warning), false);
  if (!opened.fault.empty()) add_notice(state, std::move(opened.fault));
  if (opened.needs_spacing) {
    state.dialog = SpacingDialog{std::move(opened.request)};
    return;
  }
  if (!opened.series.empty()) {
    state.dialog = SeriesDialog{std::move(opened.request), std::move(opened.series)};
    return;
  }
  if (!opened.uneven.empty()) {
    state.dialog = ResampleDialog{std::move(opened.request), std::move(opened.uneven)};
    return;
  }
  const OpenRequested command{opened.request};
  const std::vector<std::filesystem::path> contours = opened.request.contours;
  const OpenRequest& asked = opened.request;
  const bool nothing_else = asked.case_file.empty() && asked.volume_source.empty() && asked.template_source.empty() &&
                            asked.labels.empty() && !asked.demo;
  if (!contours.empty() && nothing_else) {
    for (const auto& path : contours) editing.out.send(OpenContours{path});
    return;
  }
  if (!opened.labels.empty() && !opened.volume && !opened.opened_case) {
    editing.log.is_done(command);
    return show_labels(editing, opened);
  }
  do_click_of_case(editing);
  const Snapshot& now = editing.shown.snapshot();
  if (has_unsaved_edits(now) && now.file.empty())
    return add_notice(state, "The open case could not be written to the disk. Save it before you open another.");
  // A template that was made is logged as what it is: its line writes the file again, and opens it.
  if (opened.request.template_in_place)
    editing.log.is_done(UseMadeTemplate{{opened.request.template_source}});
  else
    editing.log.is_done(command);
  if (opened.opened_case) {
    start_session(editing, std::move(opened.opened_case->session));
    if (opened.the_template) editing.shown.adopt_template(std::move(opened.the_template));
    auto fitted = kept_fit(editing.shown.snapshot());
    // A map belongs to the frame that was fitted to it.
    if (!opened.labels.empty()) show_labels(editing, opened, fitted ? std::optional(fitted->frame) : std::nullopt);
    const Structure* active = editing.structure();
    if (fitted && active != nullptr && active->id == fitted->structure)
      state.found.last_fit = std::move(fitted->fitted);
  } else {
    start_with(editing, std::move(opened));
  }
  // The log has them with the rest.
  for (const auto& path : contours) import_contours(editing, path);
}

}  // namespace homolog
