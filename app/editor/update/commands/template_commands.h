#pragma once

#include "app/editor/update/commands/file_commands.h"

namespace homolog {

// The making of a template from the label map that is shown.

struct MakeTemplate {
  static constexpr const char* key = "make template";
  TemplateSettings settings;
  std::optional<Ruler> axis;  ///< the ruler, where it is to be the tube's axis
  void spell(Fields& line);
  void run(Editing& editing) const;
};
struct CancelTemplate {
  static constexpr const char* key = "cancel template";
  static constexpr bool cancels = true;
  static constexpr Logged logged = Logged::when_done;  ///< nothing is logged where none was being made
  void run(Editing& editing) const;
};
/// Goes back to the one made before.
struct UndoTemplate {
  static constexpr const char* key = "undo template";
  void run(Editing& editing) const;
};
/// Shows the case's mesh again.
using CloseTemplateMaking = PlainEditingCall<"close template", close_template_making>;
/// Writes it and starts anew with it. It is done once the file is open.
using UseMadeTemplate = EditingCallLogged<Logged::when_done, "use template", "path", use_made_template>;

}  // namespace homolog
