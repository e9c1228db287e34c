#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/topology.h"

namespace homolog {

/// The labels beyond the part of a label's surface that an open template is of, named as `--label` takes them, or
/// `background`.
struct FacedNames {
  std::string labels;
  bool kept = true;  ///< it faces them; else it is what faces none of them, and ends at them
  bool operator==(const FacedNames&) const = default;
};

/// The mesh that every case of a study starts from, with its stiffness, regions and landmarks. Immutable.
struct Template {
  std::string source;  ///< path, or the name of a built-in template [core/catalogue]
  std::shared_ptr<const Topology> topology;
  Points points;                                   ///< in the template's own frame, mm
  VertexScalars stiffness;                         ///< factor_i of every vertex
  double stiffness_base = default_stiffness_base;  ///< w_i = base × factor_i
  Regions regions;
  std::vector<Landmark> landmarks;            ///< named, in the template's own frame
  std::vector<SurfacePoint> landmark_points;  ///< the place of each of them on the surface
  double missing_share = 0;           ///< share of the label it was made of that it lacks, where that is said [below]
  std::optional<FacedNames> faced{};  ///< none of a template of the whole surface
};

/// The comment by which a template's file says that it lacks a share of the label that it was made of.
std::string missing_share_comment(double share);
/// The comment by which it says of which part of a label's surface it is, and what a file's comments say of that.
std::string faced_comment(const FacedNames& faced);
std::optional<FacedNames> faced_in(const std::vector<std::string>& comments);

/// Whether a template is one that can be fitted: also one that a program put together. Errors: no topology; points,
/// factors or regions that are not one a vertex; a coordinate that is not finite; a factor or a base that is not
/// positive; a landmark without its place on the surface.
Result<void> check_template(const Template& the_template);
/// A template from what a file holds; factors default to 1. Errors: those of Topology::make and check_template; a
/// landmark whose place is not finite.
Result<std::shared_ptr<const Template>> make_template(MeshFile file, std::string source);
/// The same template with other landmarks. Throws std::invalid_argument for a landmark whose place is not finite.
std::shared_ptr<const Template> with_landmarks(const Template& the_template, std::vector<Landmark> landmarks);
MeshFile to_mesh_file(const Template& the_template);

/// The landmarks that both the template and `placed` name: where the template has them, and where they were placed. Row
/// k of both is the same landmark.
std::pair<Points, Points> matched_landmarks(const Template& the_template, const std::map<std::string, Vec3>& placed);

/// The place of a template's landmark on a mesh of the same numbering; and the same for all landmarks. `points`:
/// n×3, mm.
Vec3 carried_landmark(const Template& the_template, std::size_t landmark, const Points& points);
std::vector<Landmark> carried_landmarks(const Template& the_template, const Points& points);

/// The value at a landmark of the template, of values given per vertex.
double value_at_landmark(const Template& the_template, std::size_t landmark, const VertexScalars& values);

}  // namespace homolog
