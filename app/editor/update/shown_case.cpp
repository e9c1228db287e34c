#include "app/editor/update/shown_case.h"

#include <algorithm>
#include <utility>

#include "app/editor/state/looks_to_keep.h"
#include "app/editor/work/opening/recovery.h"
#include "core/base/text/text.h"
#include "core/mesh/construction/mirror.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

namespace {

bool has_region(const Structure* structure, const std::string& name) {
  if (structure == nullptr) return false;
  const auto& list = structure->paint.regions->list;
  return std::any_of(list.begin(), list.end(), [&](const Region& region) { return region.name == name; });
}

/// The brush lets go of a region that was taken back.
void let_go_of_regions(EditorState& state, const Document& document_before, const Document& document_now) {
  const Structure *before = active_structure(state, document_before), *now = active_structure(state, document_now);
  const std::string& brushed = state.hand.brush.region;
  if (has_region(before, brushed) && !has_region(now, brushed)) state.hand.brush.region.clear();
  if (state.hand.renaming && !has_region(now, state.hand.renaming->rename.name)) state.hand.renaming.reset();
}

std::shared_ptr<const Document> at_frame(const std::shared_ptr<const Document>& document, int frame) {
  if (document->frame == frame) return document;
  auto other = std::make_shared<Document>(*document);
  other->frame = frame;
  return other;
}

}  // namespace

bool has_unsaved_edits(const Snapshot& snapshot) {
  if (snapshot.file.empty()) return snapshot.can_undo && snapshot.committed > 0;
  return snapshot.can_undo && snapshot.file.parent_path() == unsaved_folder();
}

std::vector<std::string> told(const Refusals& refused) {
  std::vector<std::string> sentences = refused.news;
  if (refused.count > 0) sentences.push_back(refused.first);
  if (refused.count < 2 || refused.last == refused.first) return sentences;
  const std::size_t more = refused.count - 1;
  sentences.push_back(more == 1 ? refused.last
                                : std::to_string(more) + " more edits were refused. The last one: " + refused.last);
  return sentences;
}

void remember_case(EditorState& state, const Snapshot& snapshot) {
  const auto& file = snapshot.file;
  if (!file.empty() && file.parent_path() != unsaved_folder()) remember_recent(state.preferences.recent, file);
}

Refusals ShownCase::start(EditSession session) {
  const auto volume_before = displayed_ ? displayed_->scan.image : nullptr;
  Refusals refused = close();
  const Structure* first = session.initial_document().structure();
  loaded_template_ = first != nullptr ? first->the_template : nullptr;
  session_ = std::make_unique<SessionThread>(std::move(session), wake_);
  ++number_;
  begun_looks_.reset();
  written_looks_.reset();
  mesh_.forget();
  snapshot_ = session_->snapshot();
  displayed_ = snapshot_->shown;
  if (displayed_->scan.image != volume_before)
    labels_ = {};
  else if (labels_.volume)
    session_->name_labels(labels_.file);
  kept_window_ = snapshot_->kept.window;
  if (!kept_window_ && displayed_->scan.image) {
    const auto [low, high] = default_window(*displayed_->scan.image);
    kept_window_ = {low, high};
  }
  return refused;
}

std::shared_ptr<const Document> ShownCase::done() const {
  return at_frame(snapshot_->document, displayed_->frame);
}

std::string ShownLabels::label_name(int label) const {
  const auto found = names.find(label);
  const std::string number = std::to_string(label);
  return found == names.end() ? "Label " + number : excerpt(found->second) + " (" + number + ")";
}

std::string ShownLabels::refusal_at(int of_frame) const {
  if (is_of(of_frame)) return {};
  return "The label map belongs to frame " + std::to_string(*frame) +
         ". Go there, or say that it is of this frame (Case).";
}

void ShownCase::show_labels(ShownLabels labels) {
  labels_ = std::move(labels);
  session_->name_labels(labels_.file);
}

bool ShownCase::template_is_mirrored() const {
  const Structure* now = snapshot_->document->structure();
  if (now == nullptr || !loaded_template_) return false;
  return turned_faces(now->the_template->topology->triangles(), loaded_template_->topology->triangles());
}

void ShownCase::keep_window(const EditorState& state) {
  const std::array<double, 2> shown{state.look.window_low, state.look.window_high};
  const bool being_changed = state.pointer.drag && std::holds_alternative<WindowLevelDrag>(*state.pointer.drag);
  if (being_changed || !displayed_->scan.image || kept_window_ == shown || !(shown[0] < shown[1])) return;
  kept_window_ = shown;
  session_->apply(Note{"window", shown, {}}, true);
}

void ShownCase::keep_looks(const EditorState& state) {
  auto now = looks_to_write(state);
  if (!now) return;
  written_looks_ = *now;
  session_->apply(Note{"looks", {}, {}, {}, std::make_shared<const KeptLooks>(std::move(*now))}, true);
}

std::optional<KeptLooks> ShownCase::looks_to_write(const EditorState& state) {
  if (!session_ || snapshot_->file.empty()) return std::nullopt;
  KeptLooks now = looks_to_keep(state, snapshot_->file);
  const KeptLooks before = snapshot_->kept.looks ? *snapshot_->kept.looks : KeptLooks();
  if (!begun_looks_) begun_looks_ = now;
  // What was chosen in another case goes on in this one. It becomes this case's once there is an edit, unless the case
  // keeps one: that may be on its way still, or lie on a disk that is not there today.
  const bool unedited = snapshot_->committed == 0;
  if (now.set == begun_looks_->set && (unedited || !before.set.empty())) now.set = before.set;
  if (now.model == begun_looks_->model && (unedited || !before.model.empty())) now.model = before.model;
  if (now.recipe == begun_looks_->recipe && now.measured == begun_looks_->measured &&
      (unedited || !before.recipe.empty())) {
    now.recipe = before.recipe;
    now.measured = before.measured;
  }
  if (now == before || now == written_looks_) return std::nullopt;
  return now;
}

Refusals ShownCase::close() {
  if (!session_) return {};
  session_->finish();  // what was asked for is done, and the journal closed
  Refusals refused = session_->take_refusals();
  session_.reset();
  remove_without_edits(snapshot_->file);
  return refused;
}

bool ShownCase::update_snapshot(EditorState& state) {
  const auto latest = session_->snapshot();
  const bool changed = latest != snapshot_;
  const bool renamed = latest->file != snapshot_->file;
  let_go_of_regions(state, *snapshot_->document, *latest->document);
  const bool travelled = latest->document != snapshot_->document && latest->steps_made == snapshot_->steps_made &&
                         (latest->can_redo || snapshot_->can_redo);
  const bool steps_more = latest->steps_made != snapshot_->steps_made;
  // A note says nothing.
  const bool said = latest->committed != snapshot_->committed || latest->message != snapshot_->message;
  if (said) state.said_in = situation_of(state, *latest->shown);
  snapshot_ = latest;
  if (renamed) remember_case(state, *snapshot_);
  keep_on_disk(state);
  const Refusals refused = session_->take_refusals();
  for (const std::string& sentence : told(refused))
    add_notice(state, Notice{.text = sentence, .unwritten = refused.unwritten});
  if (!refused.saved.empty()) add_notice(state, refused.saved, false);
  const bool written = !refused.saved.empty() || renamed || travelled || steps_more;
  if (written && !refused.unwritten)
    for (Notice& notice : state.notices) notice.over = notice.over || std::exchange(notice.unwritten, false);
  const int frame = shown_frame(state, *snapshot_->shown);
  if (!changed && displayed_->frame == frame) return false;
  const auto before = displayed_;
  displayed_ = at_frame(snapshot_->shown, frame);
  if (travelled || before->frame != frame) {
    // What undo or another frame shows is no edit's doing.
    state.found.intersecting_at_rest = Found::not_known;
    state.found.intersecting_before.reset();
  }
  const Structure* worked_on = active_structure(state, *before);
  const bool is_gone = worked_on != nullptr && displayed_->structure(worked_on->id) == nullptr;
  if (is_gone || (worked_on == nullptr && !displayed_->structures.empty())) {
    // A structure that was taken away is worked on no more; the first ones that come are.
    state.look.structure.clear();
    begin_on_structure(state, *displayed_);
    if (said) state.said_in = situation_of(state, *displayed_);  // of the edit that took it away
  } else if (worked_on != nullptr && active_structure(state, *displayed_)->id != worked_on->id) {
    state.look.structure = worked_on->id;  // another one is the first now
  }
  if (before->structures.size() != displayed_->structures.size()) follow_structures(state, *displayed_);
  follow_contours(state, *displayed_);
  if (is_gone) return true;
  const auto view_before = active_shape(state, *before), view_now = active_shape(state, *displayed_);
  if (!view_before || !view_now) return view_before.has_value() != view_now.has_value();
  const Shape &was = view_before->shape, &now = view_now->shape;
  return was.points != now.points || was.doubt_mm != now.doubt_mm || was.confirmed != now.confirmed;
}

void ShownCase::keep_on_disk(EditorState& state) {
  // The state folder was full, or the case is read-only: tried again with every edit.
  if (!snapshot_->file.empty() || !has_unsaved_edits(*snapshot_) || tried_to_keep_ == snapshot_->document) return;
  tried_to_keep_ = snapshot_->document;
  if (auto path = new_unsaved_path())
    session_->save_as(std::move(*path));
  else
    add_notice(state, path.error().sentence());
}

}  // namespace homolog
