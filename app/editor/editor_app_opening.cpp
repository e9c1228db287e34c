#include "app/editor/editor_app.h"

#include "core/case/unsaved_cases.h"

// What the editor does with files once they are read.

namespace homolog {

void EditorApp::take_opened(Opened opened) {
  for (auto& warning : opened.warnings) add_notice(state_, std::move(warning), false);
  if (opened.needs_spacing) {
    state_.dialog = SpacingDialog{std::move(opened.request)};
    return;
  }
  if (!opened.series.empty()) {
    state_.dialog = SeriesDialog{std::move(opened.request), std::move(opened.series)};
    return;
  }
  if (opened.labels && !opened.volume) return take_labels(opened);
  if (has_unsaved_edits(*snapshot_) && snapshot_->file.empty())
    return add_notice(state_, "The case on the screen could not be kept on the disk; save it before opening another.");
  if (opened.opened_case) {
    start_session(std::move(opened.opened_case->session));
    return;
  }
  const Document& now = *snapshot_->document;
  const bool new_image = opened.volume != nullptr;
  const auto volume = new_image ? opened.volume : now.volume;
  const std::string source = new_image ? opened.request.volume_source : now.volume_source;
  // A case's first line names the template's file, so a mirrored one is loaded as it is there and mirrored again.
  const auto reference = opened.reference ? opened.reference : loaded_template_;
  const bool mirrored = !opened.reference && reference && reference->points != now.reference->points;
  const bool demo = opened.demo.has_value();
  start_document(opened.demo ? std::move(*opened.demo) : new_document(source, volume, reference));
  if (mirrored && !demo) session_->apply(MirrorTemplate{});
  if (demo && displayed_->volume->modality == "CT") {
    // Soft tissue: what the demo is about.
    state_.window_low = -160;
    state_.window_high = 240;
  }
  if (new_image && !source.starts_with("phantom:")) remember_recent(state_.preferences, source);
  if (opened.labels) take_labels(opened);
  if (!demo) offer_flip(*snapshot_->document);
}

void EditorApp::take_labels(const Opened& opened) {
  labels_ = opened.labels;
  labels_name_ = opened.request.labels.filename().string();
  label_values_ = opened.label_values;
}

void EditorApp::start_document(Document document) {
  const bool edited = snapshot_->can_undo;
  const std::filesystem::path before = snapshot_->file;
  auto session = create_unsaved_case(document);
  if (!session) {
    add_notice(state_, session.error().sentence());
    start_session(EditSession(std::move(document)));
    return;
  }
  start_session(std::move(*session));
  if (!edited || before.empty()) return;
  Notice notice{"A new case was started. The case before it is kept.", false};
  notice.case_before = before;
  add_notice(state_, std::move(notice));
}

bool EditorApp::take_recovery() {
  auto looked = recovery_.take();
  if (!looked) return false;
  if (!*looked) {
    add_notice(state_, looked->error().sentence());
    return true;
  }
  Recovery::Found* found = &**looked;
  auto* open = state_.dialog ? std::get_if<RecoverDialog>(&*state_.dialog) : nullptr;
  if (found->counted) {
    if (open == nullptr) return false;
    for (RecoverDialog::Found& shown : open->found)
      for (const RecoverDialog::Found& counted : found->cases)
        if (shown.journal == counted.journal) shown.details = counted.details;
  } else if (found->cases.empty()) {
    if (offer_ == Offer::asked) add_notice(state_, "There is no case to recover.", false);
  } else if (offer_ == Offer::notice || (state_.dialog && open == nullptr)) {
    add_notice(state_,
               std::to_string(found->cases.size()) + (found->cases.size() == 1 ? " case was" : " cases were") +
                   " not saved. Unsaved cases… in the section Case recovers them.",
               false);
  } else {
    state_.dialog = RecoverDialog{found->cases, {}};
    recovery_.count(std::move(*found));
  }
  return true;
}

void EditorApp::offer_flip(const Document& document) {
  if (!document.volume || !document.reference || document.reference->source.starts_with("built-in:")) return;
  const Box image = document.volume->geometry.bounds_mm();
  const Points& points = document.reference->points;
  if (image.intersects(bounds_of(points))) return;
  // To negate x and y is half a turn about z.
  const Similarity flip{Eigen::Quaterniond(0, 0, 0, 1), 1, Vec3::Zero()};
  const Box flipped = bounds_of(Points(points * Vec3(-1, -1, 1).asDiagonal()));
  if (!image.intersects(flipped)) return;
  const std::string name = std::filesystem::path(document.reference->source).filename().string();
  state_.dialog = FlipDialog{name, flip, flipped};
}

}  // namespace homolog
