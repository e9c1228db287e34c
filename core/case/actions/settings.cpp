#include "core/case/actions/settings.h"

#include "core/case/actions/fields.h"

namespace homolog {

namespace {

constexpr Names<Scheme, 3> scheme_names{
    {{"anchored", Scheme::anchored}, {"paper", Scheme::paper}, {"raw", Scheme::raw}}};

void spell_scheme(Fields& line, SetScheme& action) {
  line.member("scheme", scheme_names, action.scheme);
  line.optional("events", action.paper_events);
}

Result<EditReport> apply_scheme(const SetScheme& action, DocumentEdit& edit) {
  if (action.paper_events < 1 || action.paper_events > 1000) return fail("events", "must be 1 to 1,000");
  edit.after.scheme = action.scheme;
  edit.after.paper_events = action.paper_events;
  return EditReport{};
}

}  // namespace

const ActionKind<SetScheme>& action_kind(const SetScheme&) {
  static constexpr ActionKind<SetScheme> kind{
      .key = "scheme",
      .example = R"({"scheme":"anchored"})",
      .meaning = "how strokes move the mesh: `anchored`, `raw`, or `paper` with `\"events\":N` mouse events a stroke",
      .needs_mesh = false,
      .name = [](const SetScheme&) -> std::string { return "scheme"; },
      .spell = spell_scheme,
      .apply = apply_scheme};
  return kind;
}

const ActionKind<SetEvenSpacing>& action_kind(const SetEvenSpacing&) {
  static constexpr ActionKind<SetEvenSpacing> kind{
      .key = "spacing",
      .example = R"({"spacing":0.5})",
      .meaning = "strength of keeping vertices evenly spread along with an edit, 0…1",
      .needs_mesh = false,
      .name = [](const SetEvenSpacing&) -> std::string { return "even spacing"; },
      .spell = [](Fields& line, SetEvenSpacing& action) { line.member("spacing", action.strength); },
      .apply = [](const SetEvenSpacing& action, DocumentEdit& edit) -> Result<EditReport> {
        if (!(action.strength >= 0 && action.strength <= 1)) return fail("spacing", "must be between 0 and 1");
        edit.after.even_spacing = action.strength;
        return EditReport{};
      }};
  return kind;
}

}  // namespace homolog
