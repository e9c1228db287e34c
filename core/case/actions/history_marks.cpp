#include "core/case/actions/history_marks.h"

#include <bit>
#include <cstdint>
#include <utility>

#include "core/base/encoding/hash.h"
#include "core/base/text/text.h"
#include "core/case/actions/fields.h"

namespace homolog {

namespace {

constexpr const char* not_true = "\"undo\" and \"redo\" take true";

void spell_figures(Fields line, FitFigures& fit) {
  line.member("mesh", fit.mesh);
  line.member("mean_mm", fit.mean_mm);
  line.member("p95_mm", fit.p95_mm);
  line.optional("dice", fit.dice);
  line.optional("missing_share", fit.missing_share);
  line.optional("warnings", fit.warnings, !fit.warnings.empty());
  line.optional("remarks", fit.remarks, !fit.remarks.empty());
}

template <class Kept>
void spell_kept(Fields& line, const char* key, std::shared_ptr<const Kept>& kept, void (*spell)(Fields, Kept&)) {
  if (line.reads() ? !line.has(key) : !kept) return;
  Kept values = kept ? *kept : Kept();
  spell(line.object(key), values);
  if (line.reads()) kept = std::make_shared<const Kept>(std::move(values));
}

void spell_note(Fields& line, Note& note) {
  line.member("note", note.text);
  std::vector<double> window;
  if (note.window) window.assign(note.window->begin(), note.window->end());
  line.optional("window", window, note.window.has_value());
  if (line.reads() && !window.empty()) {
    if (window.size() != 2 || !(window[0] < window[1])) throw Unreadable{"\"window\" is not two ascending numbers"};
    note.window = {window[0], window[1]};
  }
  line.optional("template_file", note.template_file, !note.template_file.empty());
  if (line.reads() ? line.has("fit") : note.fit.has_value()) {
    if (!note.fit) note.fit.emplace();
    spell_figures(line.object("fit"), *note.fit);
  }
  spell_kept(line, "looks", note.looks, spell_looks);
  spell_kept(line, "map_fit", note.map_fit, spell_map_fit);
}

}  // namespace

std::string mesh_hash(const Points& points) {
  Hash hash;
  for (const double x : points.reshaped()) hash.add(std::bit_cast<std::uint64_t>(x));
  return hash.hex();
}

const ActionKind<Note>& action_kind(const Note&) {
  static constexpr ActionKind<Note> kind{
      .key = "note",
      .example = R"({"note":"a first stroke"})",
      .meaning =
          "a remark. It may say how the case is shown, which is no step and which no undo takes back: "
          "`\"window\":[-160,240]` are the image's values that are black and white, `\"template_file\"` is where the "
          "template was saved as it is painted, `\"fit\":{…}` are the figures of the last fit to a label map, with a "
          "hash of the mesh that they are of. `\"looks\":{…}` is how the window shows the structures: which are "
          "`hidden` and `locked`, the `opacity` of each in 3D, the `active` one, and whether shapes as read are hidden "
          "(`as_read_hidden`); and by which files, named relative to the case: the template `set`, the `recipe` and "
          "what of it is drawn (`measured`), the `model` of the score. `\"map_fit\":{…}` is what a fit of a "
          "set found in the label map: for each structure its label there and its mesh as the map was read, and how "
          "the repair changes voxels. The last of each counts",
      .role = LineRole::note,
      .needs_mesh = false,
      .name = [](const Note&) -> std::string { return "note"; },
      .spell = spell_note,
      .apply = [](const Note& note, DocumentEdit&) -> Result<EditReport> {
        if (is_utf8(note.template_file)) return EditReport{};
        return fail(note.template_file,
                    "has a name that is no UTF-8, so a case cannot hold it; save it under another name");
      }};
  return kind;
}

const ActionKind<Undo>& action_kind(const Undo&) {
  static constexpr ActionKind<Undo> kind{
      .key = "undo",
      .example = R"({"undo":true})",
      .meaning = "takes the last step back",
      .role = LineRole::undo,
      .needs_mesh = false,
      .name = [](const Undo&) -> std::string { return "undo"; },
      .spell = [](Fields& line, Undo&) { line.constant("undo", true, not_true); },
      .apply = [](const Undo&, DocumentEdit&) -> Result<EditReport> { return fail("undo", "belongs to the session"); }};
  return kind;
}

const ActionKind<Redo>& action_kind(const Redo&) {
  static constexpr ActionKind<Redo> kind{
      .key = "redo",
      .example = R"({"redo":true})",
      .meaning = "does the step again that was taken back last",
      .role = LineRole::redo,
      .needs_mesh = false,
      .name = [](const Redo&) -> std::string { return "redo"; },
      .spell = [](Fields& line, Redo&) { line.constant("redo", true, not_true); },
      .apply = [](const Redo&, DocumentEdit&) -> Result<EditReport> { return fail("redo", "belongs to the session"); }};
  return kind;
}

}  // namespace homolog
