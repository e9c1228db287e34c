#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "app/editor/state/state.h"
#include "core/mesh/colours.h"

namespace homolog {

/// Colour of every vertex for a colouring; `hues` are the template's vertex hues, shown at `saturation`; `confidence`
/// is that of the last snap and `z` that of the score, which their colourings need. Vertices whose place the scan lacks
/// are greyed.
std::vector<Rgb> mesh_colours(const ShapeView& shown, Colouring colouring, const std::vector<float>& hues,
                              float saturation, const VertexScalars* confidence = nullptr,
                              const VertexScalars* z = nullptr);
/// Brightens vertices towards white by how far a gesture moves them (`response`, 0…1), and greys the others.
std::vector<Rgb> tinted(std::vector<Rgb> colours, const VertexScalars& response, bool stopped);

/// Length of every edge relative to the unwarped template's at the shape's placement, by vertex: the mean over the
/// one-ring.
VertexScalars edge_stretch(const ShapeView& shown);
/// Distance of every vertex from the shape's reference, mm.
VertexScalars moved_mm(const ShapeView& shown);

/// The figures at the ends and in the middle of a colouring's scale, as its legend shows them, and the colours there.
struct Legend {
  std::string low, middle, high;
  std::vector<Rgb> colours;        ///< evenly spaced from low to high, or one a name
  std::vector<std::string> names;  ///< names of single colours, where there is no scale
  bool has_confirmed = false;      ///< some of the mesh is white, because it is confirmed
  bool has_outliers = false;       ///< some of the mesh is grey, because the scan lacks its place
};
/// The mesh has much of this grey and some of the colouring where the scan lacks it.
inline constexpr Rgb outlier_grey{0.42f, 0.43f, 0.46f};
Legend colouring_legend(const ShapeView& shown, Colouring colouring);

/// The data that the colours are made of.
struct ColouringInput {
  const ShapeView& shown;
  const std::vector<float>& hues;
  float saturation;
  const VertexScalars *confidence, *z;
};
/// Everything about a colouring.
struct ColouringKind {
  Colouring colouring;
  const char* log_name;            ///< its name in the log
  const char* name;                ///< its button's name
  const char* title;               ///< its legend's title in a view
  const char* tip;                 ///< its button's tip
  bool follows_shape = false;      ///< is made anew when the mesh moves, or what is known of it changes
  bool whitens_confirmed = false;  ///< confirmed vertices are white; the legend says so
  /// Gives every vertex its colour.
  void (*colour)(const ColouringInput& of, std::vector<Rgb>& colours);
  Legend (*legend)(const ShapeView& shown);
};
inline constexpr std::size_t colourings = static_cast<std::size_t>(Colouring::confidence) + 1;
/// In the order of Colouring.
const std::array<ColouringKind, colourings>& colouring_kinds();
const ColouringKind& kind_of(Colouring colouring);

}  // namespace homolog
