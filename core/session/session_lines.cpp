#include <new>
#include <utility>

#include "core/case/action_line.h"
#include "core/session/checkpoint.h"
#include "core/session/session.h"

// The lines of a session: written after each edit, counted when a case is read, and read again for a state that is not
// kept, or for the name of a step.

namespace homolog {

/// Writes a line, and before it those of the looks that could not be written. A note needs none of them.
Result<LinePlace> EditSession::write(const std::string& line, bool is_note, bool sync) {
  std::string lines;
  if (!is_note)
    for (const Look& look : looks_) lines += look.unwritten;
  const std::size_t before = lines.size();
  lines += line;
  lines += '\n';
  const auto at = lines_.append(lines, sync);
  if (!at) return fail(at.error());
  std::uint64_t next = *at;
  if (!is_note)
    for (Look& look : looks_)
      if (!look.unwritten.empty()) look.line.at = std::exchange(next, next + look.unwritten.size());
  return LinePlace{*at + before, line.size()};
}

/// Needs no memory beyond what History::reserve took.
void EditSession::add_steps(History::Step step) {
  for (const Look& look : looks_) {
    History::Step looked;
    looked.line = look.line;
    looked.look = true;
    if (step.after && &look == &looks_.back()) looked.after = document_;
    history_.push(std::move(looked));
  }
  looks_.clear();
  if (step.after) document_ = step.after;
  history_.push(std::move(step));
}

void EditSession::keep(const Note& note) {
  if (note.window) kept_.window = note.window;
  if (!note.template_file.empty()) kept_.template_file = note.template_file;
  if (note.fit) kept_.fit = note.fit;
  if (note.looks) kept_.looks = note.looks;
  if (note.map_fit) kept_.map_fit = note.map_fit;
}

/// Work that may also be left undone: where memory is short a later edit does it.
void EditSession::tidy() {
  try {
    history_.keep(history_.current(), document_);
    write_checkpoint();
  } catch (const std::bad_alloc&) {
  }
}

void EditSession::write_checkpoint() {
  if (journal() == nullptr || steps_to_checkpoint_ > 0 || steps_since_checkpoint() < limits_.replayed_steps) {
    steps_to_checkpoint_ -= steps_to_checkpoint_ > 0 ? 1 : 0;
    return;
  }
  steps_to_checkpoint_ = limits_.replayed_steps;  // if it fails, its cost is not spent on every edit
  const std::uint32_t check = lines_.check();
  const auto text = checkpoint_line(history_.start(), document(), check, templates_);
  if (!text) return;
  const auto at = lines_.append(*text + '\n', false);
  if (!at) return;
  history_.step(history_.current() - 1).checkpoint = History::Checkpoint{{*at, text->size()}, check};
  steps_to_checkpoint_ = 0;
}

std::size_t EditSession::steps_since_checkpoint() const {
  std::size_t steps = 0;
  while (steps < history_.current() && !history_.step(history_.current() - 1 - steps).checkpoint) ++steps;
  return steps;
}

Result<EditStep> EditSession::read_line(std::size_t k) const {
  const auto line = lines_.read(history_.step(k).line);
  if (!line) return fail(line.error());
  return parse_action(*line);
}

Result<EditStep> EditSession::read_step(std::size_t k) {
  auto step = read_line(k);
  if (!step) return step;
  *step = templates_.from_line(std::move(*step));
  if (adjust_) adjust_(step->action);
  if (auto complete = templates_.complete(*step); !complete) return fail(complete.error());
  return step;
}

/// The nearest state at or before `state` that is kept, in memory or in a checkpoint; `state` becomes its number.
std::shared_ptr<const Document> EditSession::nearest_state(std::size_t& state) {
  for (;; --state) {
    if (auto kept = history_.kept(state)) return kept;
    const auto& checkpoint = history_.step(state - 1).checkpoint;
    const auto line = checkpoint ? lines_.read(checkpoint->line) : std::string();
    auto document = line
                        ? read_checkpoint(*line, history_.start(), checkpoint ? checkpoint->lines_check : 0, templates_)
                        : std::optional<Document>();
    if (!document) continue;
    auto read = std::make_shared<const Document>(std::move(*document));
    history_.keep(state, read);
    return read;
  }
}

/// Without the state `before` it the name of a renaming is not kept: only that it is an aside is sure.
EditName EditSession::read_name(std::size_t k, const Document* before) {
  EditName& known = history_.step(k).name;
  if (!known.words.empty()) return known;
  EditName name{"edit", false, false, {}};  // a long line is not read again
  if (const auto step = read_line(k)) {
    name = edit_name(*step, before != nullptr ? *before : document());
    if (before == nullptr && is_renaming(step->action)) return name;
  }
  return known = std::move(name);
}

std::string EditSession::name(const std::optional<History::Way>& way) {
  if (!way) return "";
  bool all_kept = true;
  const auto read = [&](const Document* before) {
    std::vector<EditName> edits;
    for (std::size_t k = way->first; k <= way->last && (edits.empty() || edits.back().aside); ++k) {
      edits.push_back(read_name(k, before));
      all_kept = all_kept && !history_.step(k).name.words.empty();
    }
    return edits;
  };
  auto edits = read(nullptr);
  if (edits.back().aside && !all_kept)
    if (const auto before = state(way->first)) edits = read(before->get());
  return step_name(edits);
}

std::vector<std::string> EditSession::undo_names(std::size_t most) {
  std::vector<std::string> names;
  for (auto way = history_.undo(); way && names.size() < most; way = history_.undo(way->to)) names.push_back(name(way));
  return names;
}

std::vector<std::string> EditSession::redo_names(std::size_t most) {
  std::vector<std::string> names;
  for (auto way = history_.redo(); way && names.size() < most; way = history_.redo(way->to)) names.push_back(name(way));
  return names;
}

int EditSession::strokes() const {
  int count = 0;
  for (std::size_t k = 0; k < history_.current(); ++k) count += history_.step(k).stroke ? 1 : 0;
  return count;
}

void EditSession::read_from(CaseLines lines, std::function<void(Action&)> adjust) {
  lines_ = std::move(lines);
  adjust_ = std::move(adjust);
  for (const LinePlace& place : std::exchange(kept_lines_, {})) {
    const auto line = lines_.read(place);
    const Result<EditStep> step = line ? parse_action(*line) : fail(line.error());
    if (const auto* note = step ? std::get_if<Note>(&step->action) : nullptr) keep(*note);
  }
}

bool EditSession::count(const LineKind& kind, const LinePlace& line, std::uint32_t lines_check) {
  switch (kind.kind) {
    case LineKind::empty:
      return true;
    case LineKind::note:
      if (kind.keeps) kept_lines_.push_back(line);
      return true;
    case LineKind::look:
      looks_.push_back({{}, line});
      joinable_ = false;
      return true;
    case LineKind::step: {
      History::Step step;
      step.line = line;
      step.joined = kind.joined && joinable_;
      step.stroke = kind.stroke;
      history_.reserve(looks_.size() + 1);
      add_steps(std::move(step));
      return joinable_ = true;
    }
    case LineKind::undo:
    case LineKind::redo: {
      const auto way = kind.kind == LineKind::undo ? history_.undo() : history_.redo();
      if (way) history_.go_to(way->to);
      looks_.clear();
      joinable_ = false;
      return way.has_value();
    }
    case LineKind::checkpoint:
      if (history_.current() > 0 && looks_.empty())
        history_.step(history_.current() - 1).checkpoint = History::Checkpoint{line, lines_check};
      return true;
    case LineKind::unknown:
      break;
  }
  return false;
}

void EditSession::go_on_from(std::shared_ptr<const Document> document) {
  document_ = std::move(document);
  history_.keep(history_.current(), document_);
}

}  // namespace homolog
