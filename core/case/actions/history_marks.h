#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/same_values.h"
#include "core/case/actions/kept_structures.h"
#include "core/case/actions/kind.h"

namespace homolog {

// Lines that change no mesh.

/// The window's figures of a fit to a label map.
struct FitFigures {
  std::string mesh;                     ///< mesh_hash of what it made
  double mean_mm = 0, p95_mm = 0;       ///< distance between mesh and label; of a partial fit, from the label
  std::optional<double> dice;           ///< Dice with the closed label
  std::optional<double> missing_share;  ///< share of the mesh that the label lacks, of a partial fit
  std::vector<std::string> warnings, remarks;
  bool operator==(const FitFigures&) const = default;
};
/// A name for these very points.
std::string mesh_hash(const Points& points);

/// A remark; it may say how the case is shown and what becomes of it, which no undo takes back.
struct Note {
  std::string text;
  std::optional<std::array<double, 2>> window;  ///< the image's values that are shown black and white
  std::string template_file;          ///< the file that holds the template as it is painted; empty: it was not saved
  std::optional<FitFigures> fit{};    ///< the last fit's figures
  SharedValue<KeptLooks> looks{};     ///< null: it says nothing of them
  SharedValue<KeptMapFit> map_fit{};  ///< the last fit of a set; null: it says nothing of one
  /// Whether it says more than its text.
  bool keeps() const { return window || !template_file.empty() || fit || looks || map_fit; }
  bool operator==(const Note&) const = default;
};
const ActionKind<Note>& action_kind(const Note&);

struct Undo {
  bool operator==(const Undo&) const = default;
};
const ActionKind<Undo>& action_kind(const Undo&);

struct Redo {
  bool operator==(const Redo&) const = default;
};
const ActionKind<Redo>& action_kind(const Redo&);

}  // namespace homolog
