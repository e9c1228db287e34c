#include "core/session/session.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/files/paths.h"
#include "core/case/action_line.h"
#include "core/case/moved_points.h"
#include "core/case/placing.h"
#include "core/deform/stroke_kinds.h"
#include "core/session/case_keeping.h"

namespace homolog {

namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The steps that are played again in about half a second.
std::size_t steps_in_half_a_second(const Document& document) {
  Eigen::Index vertices = 1;
  for (const auto& structure : document.structures)
    vertices = std::max(vertices, structure->the_template->topology->vertices());
  return static_cast<std::size_t>(std::clamp<Eigen::Index>(1'000'000 / vertices, 16, 512));
}

/// The action as its line gives it, so that what is kept is what a replay makes, to the last bit. A pull remembers
/// where on the surface it ended, so that replaying it needs no cursor path.
Result<void> resolve(const Document& document, Deformer& deformer, EditStep& step, int& solves) {
  auto* stroke = std::get_if<Stroke>(&step.action);
  if (stroke == nullptr || !kind_of_stroke(stroke->tool).follows_cursor || stroke->on) return {};
  const auto followed = update(document, step.of, step.action, deformer, Pass::preview);
  if (!followed) return fail(followed.error());
  stroke->on = followed->report.on;
  solves = followed->report.solves;
  return {};
}

}  // namespace

EditSession::EditSession(Document document, const HistoryLimits& limits)
    : history_(std::make_shared<const Document>(std::move(document)), limits.bytes),
      limits_(limits),
      document_(history_.kept(0)) {
  if (limits_.replayed_steps == 0) limits_.replayed_steps = steps_in_half_a_second(*document_);
}

Result<void> EditSession::start_at(const Similarity& placement) {
  auto placed = update(document(), {}, SetPlacement{placement}, deformer_of(document(), {}), Pass::commit);
  if (!placed) return fail(placed.error());
  document_ = std::make_shared<const Document>(std::move(placed->document));
  history_ = History(document_, limits_.bytes);
  return {};
}

Deformer& EditSession::deformer_of(const Document& document, const std::string& of) {
  constexpr std::size_t most_kept = 8;
  const Structure* structure = document.structure(of);
  const std::string& id = structure != nullptr ? structure->id : of;
  const auto known = std::ranges::find_if(deformers_, [&](const auto& one) { return one.first == id; });
  if (known != deformers_.end()) {
    deformers_.splice(deformers_.begin(), deformers_, known);
  } else {
    deformers_.emplace_front(id, Deformer());
    if (deformers_.size() > most_kept) deformers_.pop_back();
  }
  return deformers_.front().second;
}

void EditSession::prepare(const std::string& of) {
  const auto shown = document().view(of);
  if (shown) (void)deformer_of(document(), of).prepare(stroke_start(document(), *shown));
}

void EditSession::end_gestures() {
  for (auto& [id, deformer] : deformers_) deformer.end_gesture();
}

Result<Updated> EditSession::preview(const std::optional<Action>& action, const std::vector<Compute>& then,
                                     const std::string& of) {
  const auto start = std::chrono::steady_clock::now();
  auto updated = action ? update(document(), of, *action, deformer_of(document(), of), Pass::preview)
                        : Result<Updated>(Updated{document(), {}});
  if (!updated) return updated;
  for (const Compute& compute : then)
    if (auto followed = follow(updated->document, compute, of); !followed)
      updated->report.message = followed.error().sentence();
  updated->report.solver_ms = milliseconds_since(start);
  return updated;
}

Result<void> EditSession::follow(Document& document, const Compute& compute, const std::string& of) {
  auto action = compute(document, of);
  if (!action) return fail(action.error());
  if (!*action) return {};
  auto updated = update(document, of, **action, deformer_of(document, of), Pass::preview);
  if (!updated) return fail(updated.error());
  document = std::move(updated->document);
  return {};
}

Result<EditReport> EditSession::apply(Action action, bool joined, std::string of) {
  return apply(EditStep{std::move(action), std::move(of), joined});
}

Result<EditReport> EditSession::apply(EditStep step) {
  keep();
  const bool is_note = std::holds_alternative<Note>(step.action);
  auto report = perform(std::move(step), std::nullopt);
  edited_ = edited_ || (report && !is_note);
  return report;
}

void EditSession::keep() {
  const std::string news = keep_case(*this);
  if (!news.empty()) news_ += (news_.empty() ? "" : " ") + news;
}

Result<EditReport> EditSession::replay(EditStep step, const LinePlace& line) {
  step = templates_.from_line(std::move(step));
  if (adjust_) adjust_(step.action);
  end_gestures();  // a pull follows the straight path, not what was followed before
  return perform(std::move(step), line);
}

/// `line`: where the action's line is; without one it is written.
Result<EditReport> EditSession::perform(EditStep step, const std::optional<LinePlace>& line) {
  const Action& action = step.action;
  const bool travels = std::holds_alternative<Undo>(action) || std::holds_alternative<Redo>(action);
  const auto* frame = std::get_if<SetFrame>(&action);
  const bool looks = frame != nullptr && !frame->step;
  const bool notes = std::holds_alternative<Note>(action);
  const bool joinable = std::exchange(joinable_, false);
  step.joined = step.joined && joinable;
  auto report = travels ? travel(action, line) : looks ? look(*frame, line) : edit(std::move(step), line);
  joinable_ = report && !travels && !looks && (joinable || !notes);
  return report;
}

Result<EditReport> EditSession::travel(const Action& action, const std::optional<LinePlace>& line) {
  const bool back = std::holds_alternative<Undo>(action);
  const auto way = back ? history_.undo() : history_.redo();
  if (!way) return fail("", back ? "There is nothing to undo." : "There is nothing to redo.");
  auto there = state(way->to);
  if (!there) return fail(there.error());
  EditReport report;
  report.message = (back ? "Undone: " : "Redone: ") + name(way) + ".";
  if (!line)
    if (auto written = lines_.append(action_line({action}) + '\n'); !written) return fail(written.error());
  history_.go_to(way->to);
  document_ = std::move(*there);
  looks_.clear();
  return report;
}

Result<EditReport> EditSession::look(const SetFrame& action, const std::optional<LinePlace>& line) {
  auto updated = update(document(), {}, action, deformer_of(document(), {}), Pass::commit);
  if (!updated) return fail(updated.error());
  auto shown = std::make_shared<const Document>(std::move(updated->document));
  Look look;
  look.unwritten = action_line({action}) + '\n';
  look.line.bytes = look.unwritten.size() - 1;
  looks_.reserve(looks_.size() + 1);
  if (line) {
    look = {{}, *line};
  } else if (const auto at = lines_.append(look.unwritten, false)) {
    look.line.at = *at;
    look.unwritten.clear();
  }
  looks_.push_back(std::move(look));
  document_ = std::move(shown);
  return std::move(updated->report);
}

Result<EditReport> EditSession::edit(EditStep done, const std::optional<LinePlace>& line) {
  const auto start = std::chrono::steady_clock::now();
  int solves = 0;
  Deformer& deformer = deformer_of(document(), done.of);
  if (auto complete = templates_.complete(done); !complete) return fail(complete.error());
  if (auto resolved = resolve(document(), deformer, done, solves); !resolved) return fail(resolved.error());
  const auto shown = document().view(done.of);
  if (const auto* set = std::get_if<SetPoints>(&done.action); set != nullptr && !line && shown) {
    const Shape before = shape_of_frame(shown->structure, shown->frame, set->of_frame.value_or(shown->frame));
    if (auto moves = moves_of(*before.points, *set)) done.action = std::move(*moves);
  }
  auto updated = update(document(), done.of, done.action, deformer, Pass::commit);
  if (!updated) return fail(updated.error());
  updated->report.solves += solves;

  // All that needs memory comes before the line is written: from then on the case is as the disk says.
  const auto* note = std::get_if<Note>(&done.action);
  const bool is_note = note != nullptr;
  History::Step step;
  step.name = edit_name(done, document());
  step.joined = done.joined;
  step.stroke = std::holds_alternative<Stroke>(done.action);
  step.after = std::make_shared<const Document>(std::move(updated->document));
  history_.reserve(looks_.size() + 1);
  if (line)
    step.line = *line;
  else {
    if (auto begun = begin_structures(done); !begun) return fail(begun.error());
    const EditStep as_line = templates_.to_line({done.action, done.of, done.joined && !is_note});
    auto written = write(action_line(as_line), is_note, !done.joined);
    if (!written) return fail(written.error());
    step.line = *written;
  }
  solves_ += updated->report.solves;
  updated->report.solver_ms = milliseconds_since(start);
  if (is_note) {
    keep(*note);
    return std::move(updated->report);
  }
  if (!line && !done.joined) ++steps_made_;
  add_steps(std::move(step));
  tidy();
  return std::move(updated->report);
}

/// Before the first line that names a template: the case's file says from then on that it holds several structures.
Result<void> EditSession::begin_structures(const EditStep& step) {
  const auto* structure = std::get_if<SetStructure>(&step.action);
  if (structure == nullptr || structure->source.empty() || templates_.named()) return {};
  templates_.set_named(true);
  if (journal() == nullptr) return {};
  const std::filesystem::path file = journal()->path();
  if (!templates_.folder()) templates_.set_folder(absolute_path(file).parent_path());
  auto begun = go_on_in(*this, file);
  templates_.set_named(begun.has_value());
  return begun;
}

Result<std::shared_ptr<const Document>> EditSession::state(std::size_t wanted) {
  std::size_t state = wanted;
  auto document = nearest_state(state);
  for (; state < wanted; ++state) {
    auto step = read_step(state);
    if (!step) return fail(step.error());
    int solves = 0;
    end_gestures();
    Deformer& deformer = deformer_of(*document, step->of);
    if (auto resolved = resolve(*document, deformer, *step, solves); !resolved) return fail(resolved.error());
    auto updated = update(*document, step->of, step->action, deformer, Pass::commit);
    if (!updated) return fail(updated.error());
    document = std::make_shared<const Document>(std::move(updated->document));
    const bool passed_through = state + 1 < history_.size() && history_.step(state + 1).joined;
    if (!passed_through) history_.keep(state + 1, document);
  }
  return document;
}

}  // namespace homolog
