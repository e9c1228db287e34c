#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/figures/findings.h"
#include "core/case/document.h"

namespace homolog {

/// How good the shown mesh is. `moved_*` is measured from the placed and warped template; all else compares with the
/// placed template, not warped.
struct QualityFigures {
  double stretch_low = 1, stretch_median = 1, stretch_high = 1;  ///< edge length / reference's: 5 %, 50 %, 95 %
  double edge_mean_mm = 0, edge_cv = 0;  ///< length of the edges: mean, standard deviation / mean
  double regular_share = 0;              ///< share of the vertices with six neighbours
  double min_angle_deg = 0;
  std::size_t turned = 0;        ///< triangles over 90° from their reference normal, carried by the local rotations
  std::size_t intersecting = 0;  ///< pairs of faces
  bool all_intersecting = true;  ///< false: at least so many
  double moved_mean_mm = 0, moved_max_mm = 0;
  double volume_ml = 0;
  std::optional<double> doubt_mean_mm;  ///< over the vertices, of the last fit; none without one
  double doubt_max_mm = 0;
  std::vector<Finding> findings;  ///< the places that the figures above are about, kind by kind
  bool operator==(const QualityFigures&) const = default;
};
QualityFigures quality_figures(const ShapeView& shown);
/// The same of a structure by its id, which has a mesh at the document's frame.
inline QualityFigures quality_of(const Document& document, const std::string& structure) {
  return quality_figures(*document.view(structure));
}

}  // namespace homolog
