#pragma once

#include <map>
#include <optional>
#include <vector>

#include "app/editor/state/layout.h"

namespace homolog {

/// Which control the keys operate, and which is the next. The controls of a frame lie in groups: a bar, the side panel,
/// an open menu, a dialog. While no group has the keys, they are the program's own. Only keys lead into a group and
/// from control to control; a click gives the keys back.
class KeyFocus {
 public:
  enum class Way { next, previous, up, down, left, right, first, last };

  // For the keyboard: about the controls of the last frame.

  /// Gives the keys to the next or previous group; after the last they are the program's own again. Not while a menu
  /// or a dialog is open.
  void go_to_group(bool next);
  /// Whether controls take keys now: those of a group, or of a menu or a dialog that is open.
  bool takes_keys() const { return layer() != 0; }
  /// Whether a control has been reached.
  bool at_control() const { return focused() != 0; }
  /// Whether it lies in a menu or a dialog.
  bool in_front() const { return layer() != 0 && layer() != group_; }
  void go(Way way);
  /// Presses the control; a field or a number is typed into.
  void activate();
  /// Whether a number is reached; step() changes it so many times by a little.
  bool at_number() const;
  void step(int steps) { steps_ = steps; }
  /// From a field that is typed into to the next control; the typing there is done.
  void leave_field(Way way);
  /// In a menu or a dialog the keys reach again what they reach at first.
  void start_again() { at_.erase(layer()); }
  /// Scrolls the text that is in front: `pages` of its height, or so many lines; far more than it has: to its end.
  /// False where no text is.
  bool scroll_text(float lines, float pages);
  /// The keys are the program's own again.
  void leave();
  /// Who was used last: the reached control is marked and explained while that is the keyboard.
  void let_keys_speak() { speaks_ = true; }
  void let_mouse_speak() { speaks_ = false; }

  // For the controls, while they are drawn.

  /// Begins a frame; after ImGui's has begun.
  void begin_frame();
  struct Traits {
    bool typed = false, number = false, preferred = false;
  };
  /// The keys can reach the control that ImGui made last; or one of this id and place.
  void offer(const Traits& traits);
  void offer(unsigned id, const RectPx& rect, const Traits& traits);
  /// A dialog's keys are first at the control that was offered last.
  void prefer_last();
  /// Whether the keys have reached the control of an id, and mark it; or the one that ImGui made last.
  bool marks(unsigned id) const;
  bool at_last_control() const;
  /// Whether the reached control is explained, and so none under the mouse.
  bool explains() const { return speaks_ && explains_ && at_control(); }
  /// By how much the number that ImGui made last is to change; once.
  int take_steps();
  /// The window that is drawn now is a dialog, over all others.
  void mark_dialog();
  /// The window that is drawn now is a text without controls: keys scroll it, a line is so many px.
  void mark_text(float line_px);
  /// How far down the control nearest to a height of the window that is drawn now has moved on the screen since the
  /// frame before; of those that were seen and are still there. 0 where there is none.
  float moved_px(float at_px) const;
  /// Puts what is drawn from now on into this group, whatever its window; 0: into its window's.
  void set_group(unsigned group) { drawn_group_ = group; }
  /// The keys cannot reach what is drawn now.
  void set_out_of_reach(bool out) { out_of_reach_ = out; }

 private:
  struct Stop {
    unsigned id = 0, group = 0, window = 0;
    RectPx rect;
    bool enabled = true;
    Traits traits;
  };
  unsigned layer() const;
  unsigned focused() const;
  std::vector<Stop> stops() const;
  std::optional<Stop> stop() const;
  void go_to(const Stop& stop);
  const Stop& first_of(const std::vector<Stop>& all) const;
  void find_lost();
  void scroll_on(const Stop& from, Way way);

  std::vector<Stop> drawn_, last_;          ///< stops of this frame so far, and of the one before
  std::map<unsigned, unsigned> at_;         ///< the control reached in each group
  RectPx place_;                            ///< the reached control's last place
  unsigned group_ = 0;                      ///< the group that has the keys, apart from menus and dialogs
  unsigned dialog_ = 0, drawn_dialog_ = 0;  ///< the window of the dialog
  /// The window of a text that keys scroll.
  struct Text {
    unsigned window = 0;
    float line_px = 0;
  };
  Text text_, drawn_text_;
  unsigned drawn_group_ = 0;
  bool out_of_reach_ = false;
  bool speaks_ = false;    ///< the keys were used last, so the reached control is marked
  bool explains_ = false;  ///< a key has led to it, so it is explained
  bool scrolls_ = false, leaves_field_ = false, types_next_ = false;
  std::optional<Way> again_;  ///< the way to go once more when a list has scrolled
  int steps_ = 0;
};

/// Returns the focus of the current ImGui context.
KeyFocus& key_focus();

/// Everything drawn while this lives is one group for the keys, whatever its windows.
class KeyGroup {
 public:
  explicit KeyGroup(const char* name);
  ~KeyGroup() { key_focus().set_group(0); }
  KeyGroup(const KeyGroup&) = delete;
  KeyGroup& operator=(const KeyGroup&) = delete;
};

/// Things drawn while this lives cannot be reached by the keys: it has keys of its own.
class OutOfKeysReach {
 public:
  OutOfKeysReach() { key_focus().set_out_of_reach(true); }
  ~OutOfKeysReach() { key_focus().set_out_of_reach(false); }
  OutOfKeysReach(const OutOfKeysReach&) = delete;
  OutOfKeysReach& operator=(const OutOfKeysReach&) = delete;
};

}  // namespace homolog
