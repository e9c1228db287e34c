#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/case/document.h"
#include "core/case/step_name.h"
#include "core/session/line_place.h"

namespace homolog {

/// The steps of a case, and as many states between them as a budget of memory allows. State 0 is the start, and state k
/// comes after step k − 1. A state that is not kept must be rebuilt by the caller: from the nearest kept state before
/// it and the lines of the steps between.
class History {
 public:
  struct Checkpoint {
    LinePlace line;
    std::uint32_t lines_check = 0;  ///< the checksum of the lines before it
  };
  struct Step {
    LinePlace line;
    EditName name;        ///< the name in menus; empty where the line was not read yet
    bool joined = false;  ///< undone and done again together with the step before
    bool look = false;    ///< a frame was shown: no step of its own, but what later ones start from
    bool stroke = false;
    std::optional<Checkpoint> checkpoint;   ///< the line that keeps the state after it
    std::shared_ptr<const Document> after;  ///< the state after it, if it is kept in memory
  };

  /// `most_bytes`: what the kept states may take.
  History(std::shared_ptr<const Document> start, std::size_t most_bytes);

  /// The present state.
  std::size_t current() const { return current_; }
  /// How many steps there are, with those that can be done again.
  std::size_t size() const { return steps_.size(); }
  const Step& step(std::size_t k) const { return steps_[k]; }
  Step& step(std::size_t k) { return steps_[k]; }

  /// The state that undo (redo) leads to, and the first and the last of the steps between; none where there is nothing
  /// to undo (redo).
  struct Way {
    std::size_t to, first, last;
  };
  std::optional<Way> undo() const { return undo(current_); }
  std::optional<Way> redo() const { return redo(current_); }
  /// The same from any state.
  std::optional<Way> undo(std::size_t from) const;
  std::optional<Way> redo(std::size_t from) const;

  /// Makes room for one more step with the looks before it: `push` throws nothing then.
  void reserve(std::size_t more);
  /// A step from the present state on; what could be redone is forgotten.
  void push(Step step);
  void go_to(std::size_t state) { current_ = state; }

  /// A state; null where it is not kept. The start always is.
  std::shared_ptr<const Document> kept(std::size_t state) const {
    return state == 0 ? start_ : steps_[state - 1].after;
  }
  const Document& start() const { return *start_; }
  /// Keeps a state, as far as the budget allows: around the present one all states stay longest, farther away they
  /// are thinned out evenly.
  void keep(std::size_t state, std::shared_ptr<const Document> document);
  std::size_t bytes() const;  ///< bytes of the kept states

 private:
  std::size_t nearest_before(std::size_t state) const;
  void thin_out();

  std::shared_ptr<const Document> start_;
  std::vector<Step> steps_;
  std::size_t current_ = 0;
  std::size_t most_bytes_;
  std::size_t bytes_at_most_ = 0;  ///< an upper bound of bytes()
  std::size_t stride_ = 1;         ///< far from the present state every so many are kept
};

}  // namespace homolog
