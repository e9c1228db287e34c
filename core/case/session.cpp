#include "core/case/session.h"

#include <chrono>

#include "core/case/case_file.h"

namespace homolog {

namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

EditSession::EditSession(Document document) {
  history_.push_back(std::make_shared<const Document>(std::move(document)));
}

Result<void> EditSession::start_at(const Similarity& placement) {
  auto placed = update(document(), SetPlacement{placement}, deformer_, Pass::commit);
  if (!placed) return fail(placed.error());
  history_.assign(1, std::make_shared<const Document>(std::move(placed->document)));
  return {};
}

Result<Updated> EditSession::preview(const std::optional<Action>& action, const std::vector<Compute>& then) {
  const auto start = std::chrono::steady_clock::now();
  auto updated =
      action ? update(document(), *action, deformer_, Pass::preview) : Result<Updated>(Updated{document(), {}});
  if (!updated) return updated;
  for (const Compute& compute : then)
    if (auto followed = follow(updated->document, compute); !followed)
      updated->report.message = followed.error().sentence();
  updated->report.solver_ms = milliseconds_since(start);
  return updated;
}

Result<void> EditSession::follow(Document& document, const Compute& compute) {
  auto action = compute(document);
  if (!action) return fail(action.error());
  if (!*action) return {};
  auto updated = update(document, **action, deformer_, Pass::preview);
  if (!updated) return fail(updated.error());
  document = std::move(updated->document);
  return {};
}

Result<EditReport> EditSession::travel(const Action& action) {
  const bool back = std::holds_alternative<Undo>(action);
  if (back ? !can_undo() : !can_redo())
    return fail("", back ? "There is nothing to undo." : "There is nothing to redo.");
  if (auto written = write(action); !written) return fail(written.error());
  const auto inside_step = [this] { return current_ > 0 && current_ < steps_.size() && steps_[current_].joined; };
  do current_ = back ? current_ - 1 : current_ + 1;
  while (inside_step());
  return EditReport{};
}

Result<void> EditSession::write(const Action& action, bool joined) {
  return journal_ ? journal_->append(action_line(action, joined)) : Result<void>{};
}

Result<EditReport> EditSession::apply(Action action, bool joined) {
  const bool travels = std::holds_alternative<Undo>(action) || std::holds_alternative<Redo>(action);
  auto report = travels ? travel(action) : edit(std::move(action), joined && joinable_);
  joinable_ = report && !travels;
  return report;
}

Result<EditReport> EditSession::edit(Action action, bool joined) {
  const auto start = std::chrono::steady_clock::now();
  int solves = 0;
  auto* stroke = std::get_if<Stroke>(&action);
  if (stroke != nullptr && stroke->tool == Tool::pull && !stroke->on) {
    // A pull remembers where on the surface it ended, so that replaying it needs no cursor path; what is kept is what
    // the line in the file gives, to the last bit: computed from the resolved stroke.
    const auto followed = update(document(), action, deformer_, Pass::preview);
    if (!followed) return fail(followed.error());
    stroke->on = followed->report.on;
    solves = followed->report.solves;
  }
  auto updated = update(document(), action, deformer_, Pass::commit);
  if (!updated) return fail(updated.error());
  updated->report.solves += solves;
  if (auto written = write(action, joined); !written) return fail(written.error());
  solves_ += updated->report.solves;
  updated->report.solver_ms = milliseconds_since(start);
  if (!std::holds_alternative<Note>(action)) {
    history_.resize(current_ + 1);
    steps_.resize(current_);
    history_.push_back(std::make_shared<const Document>(std::move(updated->document)));
    steps_.push_back({std::move(action), joined});
    ++current_;
  }
  return std::move(updated->report);
}

std::string EditSession::undo_name() const {
  return can_undo() ? action_name(steps_[current_ - 1].action) : "";
}
std::string EditSession::redo_name() const {
  return can_redo() ? action_name(steps_[current_].action) : "";
}

int EditSession::strokes() const {
  int count = 0;
  for (const EditStep& step : steps_done()) count += std::holds_alternative<Stroke>(step.action) ? 1 : 0;
  return count;
}

}  // namespace homolog
