#include "app/editor/update/results/results.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <utility>

#include "app/editor/state/views.h"
#include "app/editor/update/results/assistance.h"
#include "app/editor/update/results/measurements.h"
#include "app/editor/update/results/opening.h"
#include "app/editor/update/results/optimisation.h"
#include "app/editor/update/results/quitting.h"
#include "app/editor/update/results/scores.h"
#include "app/editor/update/results/set_fit.h"
#include "app/editor/update/results/worklist.h"

namespace homolog {

namespace {

void take_imports(Editing& editing) {
  while (auto done = editing.work.imports.take()) {
    if (*done)
      (**done)(editing);
    else
      add_notice(editing.state, done->error().sentence());
  }
}

/// Says which files were written; true where there were some.
bool take_written(Editing& editing) {
  EditorState& state = editing.state;
  const auto written = editing.work.exports.take();
  for (const auto& [path, result, cancelled, then, remark] : written) {
    const std::string done = "Written: " + path.string() + (remark.empty() ? "" : ". " + remark);
    add_notice(state, result ? done : result.error().sentence(), !result && !cancelled);
    if (!result)
      state.quitting = Quitting::no;
    else if (then)
      then();
  }
  return !written.empty();
}

/// Takes in how two observers agree; true where there is something new to draw.
bool take_observers(Editing& editing) {
  auto done = editing.work.observers.take();
  if (!done || editing.state.models.observer.study.empty()) return false;  // another study was opened meanwhile
  if (!*done)
    add_notice(editing.state, done->error().sentence());
  else if (!editing.state.models.observer.outdated)  // shapes have changed meanwhile
    editing.state.models.observer.comparison = std::move(**done);
  return true;
}

/// Takes in what the template maker has; true where there is something new to draw.
bool take_stage(Editing& editing) {
  TemplateMaker& maker = editing.work.template_maker;
  const bool ran = maker.busy();
  maker.update();
  const auto making = maker.latest();
  if (making == editing.work.seen_making) return maker.busy();
  // Several stages, or all, may have come since the last frame.
  const auto first_surface = [](const std::shared_ptr<const TemplateMaking>& one) {
    return one && !one->stages.empty() ? one->stages.front().surface : nullptr;
  };
  const auto first = first_surface(making);
  const bool begun = ran && first && first != first_surface(editing.work.seen_making);
  editing.work.seen_making = making;
  if (begun && editing.state.look.making_shown) look_at_mesh(editing.state, first->points);
  return true;
}

double seconds_since_1970(std::chrono::system_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

double changed_seconds(const std::filesystem::path& file) {
  std::error_code error;
  const auto changed = std::filesystem::last_write_time(file, error);
  return error ? 0 : seconds_since_1970(std::chrono::file_clock::to_sys(changed));
}

void show_found(Editing& editing, Recovery::Found found) {
  editing.state.unsaved_found = 0;
  editing.state.dialog = RecoverDialog{found.cases, {}};
  editing.work.recovery.count(std::move(found));
}

/// Asks for the surface of the label in hand while it is to be seen, and takes it in.
bool update_label_surface(Editing& editing) {
  const EditorState& state = editing.state;
  LabelSurfaces& surfaces = editing.work.label_surfaces;
  const ShownLabels& labels = editing.shown.labels();
  // While the mesh or a frame moves the label stays; it is asked for again when that is done.
  if (state.pointer.drag || state.look.shown_frame) return surfaces.update();
  std::optional<LabelSurfaces::Wanted> wanted;
  if (editing.shown.labels_here() && state.preferences.show.label_surface && !state.models.shown) {
    const Document& document = *editing.shown.snapshot().document;
    const int label =
        label_in_hand(state.automatic.fit_settings, labels.values, *labels.volume, active_shape(state, document));
    if (label != 0) wanted = LabelSurfaces::Wanted{labels.volume, label, frame_of_map(*labels.volume, document.frame)};
  }
  surfaces.want(std::move(wanted));
  return surfaces.update();
}

/// Offers the cases that were found; true where there is something new to draw.
bool take_recovery(Editing& editing) {
  auto looked = editing.work.recovery.take();
  if (!looked) return false;
  EditorState& state = editing.state;
  if (!*looked) {
    add_notice(state, looked->error().sentence());
    return true;
  }
  Recovery::Found* found = &**looked;
  const RecoveryOffer offer = editing.work.recovery_offer;
  auto* open = state.dialog ? std::get_if<RecoverDialog>(&*state.dialog) : nullptr;
  if (found->counted) {
    if (open == nullptr) return false;
    for (RecoverDialog::Found& shown : open->found)
      for (const RecoverDialog::Found& counted : found->cases)
        if (shown.journal == counted.journal) shown.details = counted.details;
  } else if (found->cases.empty()) {
    if (offer == RecoveryOffer::asked) add_notice(state, "There is no case to recover.", false);
  } else if (offer == RecoveryOffer::asked) {
    show_found(editing, std::move(*found));
  } else {
    // Each is offered at one start after it was changed; later they are found in the section Case.
    state.unsaved_found = static_cast<std::size_t>(
        std::count_if(found->cases.begin(), found->cases.end(), [&](const RecoverDialog::Found& one) {
          return changed_seconds(one.journal) > state.preferences.told_unsaved;
        }));
    if (state.unsaved_found == 0) return false;
    state.preferences.told_unsaved = seconds_since_1970(std::chrono::system_clock::now());
    const bool in_dialog = offer == RecoveryOffer::dialog && !(state.dialog && open == nullptr);
    if (in_dialog) show_found(editing, std::move(*found));
  }
  return true;
}

/// News go by themselves, errors after a longer while; none while a dialog covers it.
void forget_old_news(EditorState& state, double seconds) {
  constexpr double news_seconds = 8, error_seconds = 60, over_seconds = 4;
  if (state.dialog) return;
  for (Notice& notice : state.notices) {
    if (!notice.until) notice.until = seconds + (notice.error ? error_seconds : news_seconds);
    if (std::exchange(notice.over, false)) notice.until = std::min(*notice.until, seconds + over_seconds);
  }
  std::erase_if(state.notices, [&](const Notice& notice) { return notice.until && *notice.until <= seconds; });
}

/// Hints lie over the image: they go after a while, whether they were followed or not.
void forget_old_hints(EditorState& state, const Document& document, double seconds) {
  constexpr double hint_seconds = 20;
  const bool covered = state.models.shown || state.dialog || (state.guide && state.guide->shown);
  if (state.hints_over) return;
  if (!state.hints_until && !covered && active_shape(state, document)) state.hints_until = seconds + hint_seconds;
  state.hints_over = state.hints_until && *state.hints_until <= seconds;
}

void play(EditorState& state, const Document& document, double seconds) {
  if (!state.look.playing || seconds < state.look.next_frame_seconds || document.scan.frames() <= 1) return;
  const Volume& volume = *document.scan.image;
  const double pace = volume.frame_seconds > 0 ? volume.frame_seconds : 0.05;
  state.look.next_frame_seconds = std::max(state.look.next_frame_seconds + pace, seconds);
  state.look.shown_frame = (shown_frame(state, document) + 1) % volume.frames;
}

/// The guide goes on where its pull is done.
void follow_guide(Editing& editing) {
  EditorState& state = editing.state;
  const auto shown = active_shape(state, *editing.shown.snapshot().document);
  if (!state.guide || !state.guide->shown || state.pointer.drag || !shown) return;
  Guide& guide = *state.guide;
  if (guide.at >= guide.steps.size() || !is_done(guide.steps[guide.at], shown->mesh())) return;
  ++guide.at;
  if (guide.at == guide.steps.size()) state.preferences.guide_done = true;
  look_at_step(state);
}

/// What is looked at goes with the mesh until it is mended.
bool update_quality(Editing& editing) {
  EditorState& state = editing.state;
  const bool fresh = editing.work.quality.update();
  const auto& figures = editing.work.quality.latest();
  // The figures of a pull may have come while it was in hand.
  if (!state.pointer.drag && figures && !editing.work.quality.busy()) {
    const std::size_t before = std::exchange(state.found.intersecting_at_rest, figures->intersecting);
    if (figures->intersecting > before && !state.found.intersecting_before) state.found.intersecting_before = before;
    if (state.found.intersecting_before && figures->intersecting <= *state.found.intersecting_before)
      state.found.intersecting_before.reset();
  }
  if (!fresh) return false;
  if (!state.found.finding || state.found.finding->finding.faces.empty() || !figures) return true;
  const auto& marked = state.found.finding->finding;
  const bool there = std::any_of(figures->findings.begin(), figures->findings.end(), [&](const Finding& one) {
    return one.kind == marked.kind && std::find_first_of(one.faces.begin(), one.faces.end(), marked.faces.begin(),
                                                         marked.faces.end()) != one.faces.end();
  });
  if (!there) state.found.finding.reset();
  return true;
}

/// How a case is looked at is written a while after it changed: a program that is ended from without leaves it so.
void keep_looks_at_rest(Editing& editing, double seconds) {
  constexpr double a_while = 1;
  std::optional<double>& due = editing.work.looks_due;
  const bool in_hand = editing.state.pointer.drag || editing.state.hand.panel_edit;
  if (in_hand || !editing.shown.looks_to_write(editing.state)) return due.reset();
  if (!due) due = seconds + a_while;
  if (seconds < *due) return;
  due.reset();
  editing.shown.keep_looks(editing.state);
}

}  // namespace

bool take_results(Editing& editing, double seconds) {
  EditorState& state = editing.state;
  Work& work = editing.work;
  const std::size_t notices_before = state.notices.size();
  const Snapshot* const before = &editing.shown.snapshot();
  const std::uint64_t steps_before = before->steps_made;
  if (auto opened = work.opener.take()) {
    if (*opened)
      show_opened(editing, std::move(**opened));
    else
      add_notice(state, opened->error().sentence());
  }
  take_imports(editing);
  play(state, editing.shown.document(), seconds);
  const bool other_shape = editing.shown.update_snapshot(state);
  if (other_shape || work.quality.of() != state.look.structure) {
    work.quality.post(editing.shown.displayed(), state.look.structure);
    follow_guide(editing);
  }
  const Document& shown = editing.shown.document();
  if (const Structure* structure = editing.structure(); structure != nullptr && shown.scan.frames() > 1)
    state.found.volume_curve = volume_curve(shown, *structure, state.found.volume_curve);
  editing.shown.keep_window(state);
  keep_looks_at_rest(editing, seconds);
  count_work(editing, steps_before, seconds);
  bool changed = take_written(editing);
  update_fit(editing);
  update_contour_fit(editing);
  update_propagation(editing);
  changed |= update_set_fit(editing);
  update_model_help(editing);
  update_learning(editing);
  changed |= show_snap(editing);
  changed |= work.models.update(state, editing.shown.snapshot(), seconds, editing.out);
  changed |= update_optimisation(editing);
  changed |= take_worklist(editing);
  update_quit(editing);
  changed |= update_quality(editing);
  changed |= update_measurements(editing);
  changed |= update_scores(editing);
  changed |= take_stage(editing);
  changed |= update_label_surface(editing);
  changed |= take_observers(editing);
  changed |= take_recovery(editing);
  forget_old_news(state, seconds);
  const bool hints_before = state.hints_over;
  forget_old_hints(state, editing.shown.document(), seconds);
  return changed || state.notices.size() != notices_before || before != &editing.shown.snapshot() ||
         state.look.playing || state.hints_over != hints_before;
}

void settle(Editing& editing) {
  Work& work = editing.work;
  work.opener.finish();
  work.imports.finish();
  work.observers.finish();
  take_results(editing, 0);
  work.models.settle(editing.state, editing.shown.snapshot(), editing.out);
  work.exports.finish();
  take_written(editing);
  work.quality.finish();
  work.measurements.finish();
  work.scores.finish();
  while (work.recovery.busy()) {
    work.recovery.finish();
    take_recovery(editing);
  }
}

std::optional<double> next_move_seconds(const EditorState& state, const Work& work, double now) {
  constexpr double progress_seconds = 0.1;
  if (state.look.playing) return std::max(state.look.next_frame_seconds - now, 0.0);
  if (work.busy()) return progress_seconds;
  auto next = work.models.next_move_seconds(state.models);
  const auto* brush = state.pointer.drag ? std::get_if<BrushDrag>(&*state.pointer.drag) : nullptr;
  const auto held = state.pointer.held_click ? std::optional(state.pointer.held_click->until)
                    : brush != nullptr       ? brush->waits_until
                                             : std::nullopt;
  if (held) next = std::min(next.value_or(*held - now), std::max(*held - now, 0.0));
  for (const auto rest : {work.quality.rest_seconds(), work.measurements.rest_seconds(), work.scores.rest_seconds()})
    if (rest) next = std::min(next.value_or(*rest), *rest);
  if (work.looks_due) next = std::min(next.value_or(*work.looks_due - now), std::max(*work.looks_due - now, 0.0));
  if (state.hints_until && !state.hints_over)
    next = std::min(next.value_or(*state.hints_until - now), std::max(*state.hints_until - now, 0.0));
  for (const Notice& notice : state.notices)
    if (notice.until) next = std::min(next.value_or(*notice.until - now), std::max(*notice.until - now, 0.0));
  return next;
}

std::shared_ptr<const Mesh> shown_making(const EditorState& state, const Work& work) {
  const auto making = state.look.making_shown ? work.template_maker.latest() : nullptr;
  if (!making || making->stages.empty()) return nullptr;
  return making->stages[std::min(state.look.shown_stage.value_or(making->stages.size()), making->stages.size() - 1)]
      .surface;
}

}  // namespace homolog
