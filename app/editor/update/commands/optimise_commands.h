#pragma once

#include "app/editor/update/commands/file_commands.h"

namespace homolog {

// What the section Optimise of the Models mode asks for.

/// Slides the vertices of the study's shapes along their surfaces.
struct StartOptimisation {
  static constexpr const char* key = "start optimisation";
  static constexpr Logged logged = Logged::when_done;
  void run(Editing& editing) const;
};
struct CancelOptimisation {
  static constexpr const char* key = "cancel optimisation";
  static constexpr bool cancels = true;
  static constexpr Logged logged = Logged::never;
  void run(EditorState& state) const;
};
/// Shows the optimised shapes and their model, or those that were fitted.
struct ShowOptimised {
  static constexpr const char* key = "show optimised";
  bool shown = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct DiscardOptimised {
  static constexpr const char* key = "discard optimised";
  void run(EditorState& state) const;
};

}  // namespace homolog
