#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/structures/maps/structures_in_map.h"

namespace homolog {

/// How far a structure of a set that is being fitted is.
enum class SetFitStep { waits, runs, fitted, runs_again, failed };

struct FitSetOptions {
  double gap_mm = 0;  ///< the gap that is left between neighbours
  Progress* progress = nullptr;
  /// Called as a structure (by its place in the set) goes on, from any thread and from several at once.
  std::function<void(std::size_t structure, SetFitStep step)> tell{};
};

/// The outcome of one structure of a set.
struct FittedStructure {
  std::optional<FitResult> fit;  ///< none: it is missing, or could not be fitted
  FitJudgement judgement;
  double closing_mm = 0;
  /// How far it lies from where its neighbours say, by its size: the root mean square over the template's vertices,
  /// placed both ways. Below 0: no neighbour says.
  double off_place = -1;
  bool by_neighbours = false;  ///< fitted from where its neighbours say
  std::string why_whole;       ///< why its label's whole surface was taken and not the template's part [Boundary]
  double confidence = 0;       ///< 0…1: that the structure is right [structure_confidence]
  double p_named = 1;          ///< 0…1: that its name is the right one; 1 where nobody looked [doubt_names]
  std::string why_not;         ///< why it has no mesh; empty for one that is missing
};

/// Two structures of a set that were kept apart.
struct KeptApart {
  std::size_t a = 0, b = 0;  ///< both structures, by their places in the set
  double mm = 0;             ///< how far apart they came, at most the gap asked for; below 0: so far within each other
  bool too_near = false;     ///< less than was asked for, by more than a tenth of a millimetre
};

struct FittedSet {
  std::vector<FittedStructure> structures;  ///< in the set's order
  std::vector<KeptApart> apart;             ///< each pair of which there is a fit of both, and that may not overlap
  double depth_mm = 0;                      ///< the largest by which two of them lie within each other
};

/// Fits the templates of a set to one subject: each by itself, one of a part of a label [Template::faced] to that part,
/// then once more those that are doubtful or lie where their neighbours do not say, from there. At the end neighbours
/// are kept apart, but for those whose labels overlap, and vertices that structures share come to one place. If two
/// cannot come as far apart as they should without a fold, they are doubtful. The mesh that came of it is judged.
/// Missing structures are left out. The bytes do not depend on the number of threads. Errors: cancelled.
Result<FittedSet> fit_set(const SetOfTemplates& set, const SetInMap& subject, const FitSetOptions& options = {});

}  // namespace homolog
