#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "app/editor/state/state.h"
#include "app/editor/update/commands/logged.h"

namespace homolog {

class Fields;
struct Editing;
enum class Organ;

// A command that sets or clears one member of the state, or calls one function of it, is a row of setting_commands.h.
// One that calls one function with the editor is a row of its subject's header.

/// A text that stands among the arguments of a template.
template <std::size_t size>
struct Word {
  constexpr Word(const char (&given)[size]) { std::copy_n(given, size, text); }
  char text[size];
};

// How a row's value is read from its line in the log, and written there. A value of several members has names of its
// own for them, so that `name` is not used.
void spell_value(Fields& line, const char* name, bool& value);
void spell_value(Fields& line, const char* name, int& value);
void spell_value(Fields& line, const char* name, double& value);
void spell_value(Fields& line, const char* name, std::size_t& value);
void spell_value(Fields& line, const char* name, std::string& value);
void spell_value(Fields& line, const char* name, std::filesystem::path& value);
void spell_value(Fields& line, const char* name, std::vector<std::string>& value);
void spell_value(Fields& line, const char* name, Vec3& value);
void spell_value(Fields& line, const char* name, std::optional<std::string>& value);
void spell_value(Fields& line, const char* name, std::optional<std::size_t>& value);
void spell_value(Fields& line, const char* name, LookFrom& value);
void spell_value(Fields& line, const char* name, Organ& value);
void spell_value(Fields& line, const char* name, Alignment& value);
void spell_value(Fields& line, const char* name, CaseColumn& value);
void spell_value(Fields& line, const char* name, BetweenCurves& value);
void spell_value(Fields& line, const char* name, std::optional<ViewKind>& value);
void spell_value(Fields& line, const char* name, ShownParts& value);
void spell_value(Fields& line, const char* name, BrushSettings& value);
void spell_value(Fields& line, const char* name, FitSettings& value);
void spell_value(Fields& line, const char* name, TemplateSettings& value);
void spell_value(Fields& line, const char* name, PictureOptions& value);
void spell_value(Fields& line, const char* name, std::optional<RegionNaming>& value);
void spell_value(Fields& line, const char* name, std::optional<PanelEdit>& value);
void spell_value(Fields& line, const char* name, std::optional<CaseTextEdit>& value);
void spell_value(Fields& line, const char* name, std::optional<GalleryVertex>& value);

template <class Whole, auto... way>
using MemberOf = std::remove_cvref_t<decltype((std::declval<Whole&>().*....*way))>;

/// Sets a member of the state: the command's word in the log, the value's name there, and the members on the way.
template <Logged when, Word word, Word name, auto... way>
struct SettingLogged {
  static constexpr const char* key = word.text;
  static constexpr Logged logged = when;
  MemberOf<EditorState, way...> value{};

  void spell(Fields& line) { spell_value(line, name.text, value); }
  void run(EditorState& state) const { (state.*....*way) = value; }
};
template <Word word, Word name, auto... way>
using Setting = SettingLogged<Logged::at_once, word, name, way...>;

/// Sets a member of the state back: false, empty or none.
template <Logged when, Word word, auto... way>
struct ClearingLogged {
  static constexpr const char* key = word.text;
  static constexpr Logged logged = when;
  void run(EditorState& state) const { (state.*....*way) = {}; }
};
template <Word word, auto... way>
using Clearing = ClearingLogged<Logged::at_once, word, way...>;

/// Opens a dialog of one kind, as it is at first.
template <Word word, class Kind>
struct DialogOpening {
  static constexpr const char* key = word.text;
  static constexpr Logged logged = Logged::never;
  void run(EditorState& state) const { state.dialog = Kind{}; }
};

/// The dialog that is open, where it is of that kind; else null.
template <class Kind>
Kind* open_dialog(EditorState& state) {
  return state.dialog ? std::get_if<Kind>(&*state.dialog) : nullptr;
}
template <class Kind, class Member, class... More>
Kind whole_of(Member Kind::*, More...);
/// The kind of dialog that has a member.
template <auto... way>
using DialogWith = decltype(whole_of(way...));

/// Sets a member of the dialog that is open, where it is of the kind that has it.
template <Word word, Word name, auto... way>
struct DialogSetting {
  static constexpr const char* key = word.text;
  static constexpr Logged logged = Logged::never;
  using Kind = DialogWith<way...>;

  MemberOf<Kind, way...> value{};

  void spell(Fields& line) { spell_value(line, name.text, value); }
  void run(EditorState& state) const {
    if (Kind* dialog = open_dialog<Kind>(state)) ((*dialog).*....*way) = value;
  }
};

/// Calls a function of the state, or of a member of it, with one value.
template <Word word, Word name, auto function, auto... way>
struct Call {
  static constexpr const char* key = word.text;
  template <class State, class Value>
  static std::remove_cvref_t<Value> value_of(void (*)(State&, Value));

  decltype(value_of(function)) value{};

  void spell(Fields& line) { spell_value(line, name.text, value); }
  void run(EditorState& state) const { function((state.*....*way), value); }
};

/// The same without a value.
template <Word word, auto function, auto... way>
struct PlainCall {
  static constexpr const char* key = word.text;
  void run(EditorState& state) const { function((state.*....*way)); }
};

/// Calls a function of a member of the dialog that is open, where it is of the kind that has it, with one value.
template <Word word, Word name, auto function, auto... way>
struct DialogCall {
  static constexpr const char* key = word.text;
  static constexpr Logged logged = Logged::never;
  template <class Member, class Value>
  static std::remove_cvref_t<Value> value_of(void (*)(Member&, Value));

  decltype(value_of(function)) value{};

  void spell(Fields& line) { spell_value(line, name.text, value); }
  void run(EditorState& state) const {
    if (auto* dialog = open_dialog<DialogWith<way...>>(state)) function(((*dialog).*....*way), value);
  }
};

/// The same without a value.
template <Word word, auto function, auto... way>
struct PlainDialogCall {
  static constexpr const char* key = word.text;
  static constexpr Logged logged = Logged::never;
  void run(EditorState& state) const {
    if (auto* dialog = open_dialog<DialogWith<way...>>(state)) function(((*dialog).*....*way));
  }
};

/// Calls a function with the editor [editing.h] and one value. One whose word begins with "cancel " gives up what runs.
template <Logged when, Word word, Word name, auto function>
struct EditingCallLogged {
  static constexpr const char* key = word.text;
  static constexpr Logged logged = when;
  static constexpr bool cancels = std::string_view(word.text).starts_with("cancel ");
  template <class Value>
  static std::remove_cvref_t<Value> value_of(void (*)(Editing&, Value));

  decltype(value_of(function)) value{};

  void spell(Fields& line) { spell_value(line, name.text, value); }
  void run(Editing& editing) const { function(editing, value); }
};
template <Word word, Word name, auto function>
using EditingCall = EditingCallLogged<Logged::at_once, word, name, function>;

/// The same without a value.
template <Logged when, Word word, auto function>
struct PlainEditingCallLogged {
  static constexpr const char* key = word.text;
  static constexpr Logged logged = when;
  static constexpr bool cancels = std::string_view(word.text).starts_with("cancel ");
  void run(Editing& editing) const { function(editing); }
};
template <Word word, auto function>
using PlainEditingCall = PlainEditingCallLogged<Logged::at_once, word, function>;

}  // namespace homolog
