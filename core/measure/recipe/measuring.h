#pragma once

#include <cassert>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/measure/plane_section.h"
#include "core/measure/primitive_fits.h"
#include "core/measure/recipe/recipe.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume.h"

namespace homolog {

/// One surface of a shape that is measured.
struct MeasuredStructure {
  std::string name;
  Mesh mesh;  ///< LPS mm; without a topology: points alone
  std::vector<Landmark> landmarks;
  Regions regions;
};

/// The shape that a recipe is applied to.
struct MeasuredShape {
  std::vector<MeasuredStructure> structures;  ///< at least one
  const Volume* image = nullptr;              ///< the image sampled along normals; null: there is none
  int frame = 0;                              ///< the image's frame
  std::string lacks_first{};                  ///< the first structure's name, where it is not among them; empty: it is
};

/// A number that was measured, or why there is none.
struct MeasuredNumber {
  std::optional<double> value;
  std::string missing;  ///< "has no landmark "apex"": what the shape lacks; empty where there is a value
  bool operator==(const MeasuredNumber&) const = default;
};

/// Every measurement of a recipe on one shape, in the recipe's order.
std::vector<MeasuredNumber> measure(const Recipe& recipe, const MeasuredShape& shape);

/// Along the outward normals of vertices: the image's values from `from_mm` to `to_mm` (negative: inside).
struct NormalProfile {
  std::vector<double> offsets_mm;  ///< k, evenly
  Eigen::MatrixXd values;          ///< n×k; NaN beyond the image
  VertexScalars mean() const;      ///< n; of those that are in the image; NaN where none is
};
/// `steps`: k. The mesh has a topology.
NormalProfile profile_along_normals(const Mesh& mesh, const Volume& image, int frame, double from_mm, double to_mm,
                                    int steps);

// The values that steps give [step_kinds.h].

struct LineValue {
  Vec3 at, direction;
  bool directed = false;  ///< else the direction may as well be the opposite
  double rms_mm = 0;
};
struct CylinderValue {
  LineValue axis;
  double radius_mm = 0;
};
struct PartValue {
  std::size_t structure = 0;
  std::vector<std::int32_t> vertices;  ///< rising
};
struct SectionValue {
  std::vector<SectionLine> lines;
  Vec3 normal;
};
using StepValue =
    std::variant<Vec3, LineValue, FittedPlane, FittedSphere, CylinderValue, PartValue, SectionValue, double>;

/// A surface with figures that are computed when they are first needed.
class MeasuredSurface {
 public:
  explicit MeasuredSurface(const MeasuredStructure& structure) : structure_(&structure) {}
  const MeasuredStructure& structure() const { return *structure_; }
  const Mesh& mesh() const { return structure_->mesh; }
  /// mm² that each vertex stands for, a third of its faces; 1 for points alone.
  const VertexScalars& areas();
  const Points& normals();
  const SurfaceSearch& search();

 private:
  const MeasuredStructure* structure_;
  std::optional<VertexScalars> areas_;
  std::optional<Points> normals_;
  std::unique_ptr<SurfaceSearch> search_;
};

/// A recipe at work on one shape: each step is measured once, when it is first needed.
class Measuring {
 public:
  Measuring(const Recipe& recipe, const MeasuredShape& shape);

  /// The error's `what` is a sentence without a subject.
  const Result<StepValue>& value(std::size_t step);

  // For the kinds of steps: what a step was given. The steps that it needs were measured before it.
  bool has(const RecipeStep& step, const char* key) const { return step.given.contains(key); }
  const StepGiven& given(const RecipeStep& step, const char* key) const { return step.given.find(key)->second; }
  const StepValue& of(const RecipeStep& step, const char* key, std::size_t number = 0) const;
  template <class Value>
  const Value& as(const RecipeStep& step, const char* key, std::size_t number = 0) const {
    return std::get<Value>(of(step, key, number));
  }
  Vec3 point(const RecipeStep& step, const char* key, std::size_t number = 0) const {
    return as<Vec3>(step, key, number);
  }
  /// A line, or the axis of a cylinder.
  LineValue axis(const RecipeStep& step, const char* key, std::size_t number = 0) const;
  /// A number or a length.
  double number(const RecipeStep& step, const char* key, double otherwise = 0) const;

  /// The surface that a step means. Errors: the shape has none of that name.
  Result<std::size_t> structure(const RecipeStep& step) const;
  MeasuredSurface& surface(std::size_t structure) { return surfaces_[structure]; }
  /// The same with its faces. Errors: points alone.
  Result<std::size_t> faces(const RecipeStep& step) const;
  Result<void> check_faces(std::size_t structure) const;
  /// The part under a key; without it all vertices of the step's structure.
  Result<PartValue> part(const RecipeStep& step, const char* key) const;
  const MeasuredShape& shape() const { return shape_; }

 private:
  const Recipe& recipe_;
  const MeasuredShape& shape_;
  std::vector<MeasuredSurface> surfaces_;
  std::vector<std::optional<Result<StepValue>>> values_;
};

/// One measurement of the recipe at work.
MeasuredNumber measured_number(Measuring& measuring, const Recipe& recipe, std::size_t step);

/// The error of a step that the shape itself lacks something for: "has no landmark …".
inline tl::unexpected<Error> lacks(std::string what) {
  return fail("shape", std::move(what));
}

}  // namespace homolog
