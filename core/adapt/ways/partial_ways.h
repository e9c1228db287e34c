#pragma once

#include <cstdint>
#include <vector>

#include "core/adapt/ways/fit_context.h"

namespace homolog {

/// A way onto what a boundary has of an organ.
struct PartialWay {
  Adapted way;
  std::vector<std::int32_t> missing;  ///< vertices whose places the boundary lacks, in rising order
  /// The strain of what is there, and how far the boundary lies from the mesh. All of the boundary is the organ's, so
  /// all of it is to be explained; the least is the likeliest.
  double energy;
};

/// Ways of a template onto a boundary that lacks parts of the organ. The placement of a part is less sure than that of
/// the whole, so several are tried. The target and the steps know that parts may be missing.
class PartialWays {
 public:
  explicit PartialWays(const FitContext& fit);

  /// From the placed template; where parts turn out to be missing also from larger and moved ones.
  Result<void> from_placement(const Points& start, const Similarity& placement);

  /// From a mesh (n×3, LPS mm) that lies about right. It keeps to the template.
  Result<void> from_mesh(const Points& mesh);

  /// From a match of the boundary with the template, which is placed by what the best way says is there.
  Result<void> from_match();

  /// The same, but so that the match is its own reference. It follows the organ more closely than the best way, and
  /// tells less of what is missing: what lacks is drawn into what is there.
  Result<Adapted> closest();

  /// All that were tried, the best one first.
  const std::vector<PartialWay>& tried() const { return tried_; }

 private:
  Result<void> add(Result<Adapted> way);
  Points matched() const;
  /// Says where the template lies, by what is not missing of a mesh.
  Similarity placement_of_rest(const Points& mesh, const std::vector<std::int32_t>& missing) const;

  FitContext fit_;
  double area_mm2_;
  std::vector<PartialWay> tried_;
};

}  // namespace homolog
