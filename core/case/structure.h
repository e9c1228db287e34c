#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/case/contour_set.h"
#include "core/case/relations.h"
#include "core/case/shape.h"
#include "core/template/template.h"

namespace homolog {

/// How placed landmarks move the reference before the first stroke.
enum class LandmarkPull {
  off,         ///< landmarks move nothing
  similarity,  ///< closed-form similarity
  warp         ///< similarity; from the fourth landmark on a smooth warp after it
};

/// How landmarks carry a template. A case keeps the rule that it was begun with, so that it replays to the same points.
enum class LandmarkRule {
  closed_form,  ///< the nearest similarity places; the warp's lengths are mm
  weighed,      ///< they place by how well they determine each rotation (likely_similarity); the warp's lengths are mm
  by_size       ///< the same, and the warp's lengths are shares of the organ's size
};

/// The rules by which landmarks placed in the image change a structure.
struct LandmarkRules {
  LandmarkPull pull = LandmarkPull::warp;
  LandmarkRule rule = LandmarkRule::by_size;
  /// The mesh is held where it has come to meet a placed landmark [held_landmarks.h]. Cases that the window or a verb
  /// begins do so; older ones do not.
  bool hold = false;
};

/// How a structure's template is painted: the template's own paint until a person paints.
struct Paint {
  std::shared_ptr<const VertexScalars> stiffness;  ///< factor_i of every vertex
  std::shared_ptr<const Regions> regions;
  double base = default_stiffness_base;  ///< w_i = base × factor_i
};

/// The id of a case's first structure.
inline constexpr const char* first_structure = "s1";

/// One organ of the scan: its template, and its mesh in every frame where it has one. Large parts are shared, so a copy
/// is cheap.
struct Structure {
  std::string id = first_structure;                   ///< lines of the case file name it by this
  std::string name;                                   ///< empty: it has none but its template's
  std::string label;                                  ///< its label in the scan's label map; empty: not known
  int layer = 0;                                      ///< its layer in a label map in which labels overlap
  std::optional<std::array<std::uint8_t, 3>> colour;  ///< none: that of the mesh
  Side side = Side::none;
  std::optional<std::string> partner;            ///< the id of the same structure of the other side; none: not known
  std::shared_ptr<const Template> the_template;  ///< never null
  Paint paint;
  std::map<int, std::shared_ptr<const Shape>> shapes;  ///< all by frame, never null; a static volume has frame 0 only
  LandmarkRules landmarks;
  double confidence = -1;  ///< 0…1: that its mesh is right, as a fit of a set or a person says; below 0: nobody said
  std::string doubt;       ///< why its mesh has to be looked at, as a sentence; empty: it need not
  std::vector<std::shared_ptr<const ContourSet>> contours;  ///< drawn of it, in any frames; never null
  std::vector<SharedWith> shared;  ///< sharings with others of the case; one of the two says it

  /// The curves of an id; null: there are none.
  const ContourSet* contour_set(const std::string& id) const;
  /// The mesh of a frame; null: it has none.
  const Shape* shape(int frame) const;
  void set_shape(int frame, Shape shape);
};

/// One structure as it is at one frame: what nearly all code takes. The structure must outlive it.
struct ShapeView {
  const Structure& structure;
  const Shape& shape;
  int frame = 0;

  const Template& the_template() const { return *structure.the_template; }
  const Paint& paint() const { return structure.paint; }
  /// The deformed mesh, LPS mm.
  Mesh mesh() const { return {structure.the_template->topology, *shape.points}; }
};

/// A structure without edits: the template at `placement`, in frame 0.
Structure new_structure(std::shared_ptr<const Template> the_template, const Similarity& placement);

/// The template of a structure as it was painted: its own points, with the structure's stiffness and regions.
MeshFile painted_template(const Structure& structure);
/// A shape as a file holds it: its points, the structure's stiffness, the landmarks where they were placed in the
/// image. `of_cine`: with its frame [mesh_frame.h].
MeshFile to_mesh_file(const ShapeView& view, bool of_cine);

}  // namespace homolog
