#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/case/document.h"
#include "core/measure/recipe/measuring.h"
#include "core/model/shape_model.h"
#include "core/model/shapes/shape_files.h"
#include "core/template/template.h"

namespace homolog {

// Shapes, models and templates as a recipe measures them.

/// A mesh as a structure to measure. `faces`: of a mesh before, used again where this one has the same; becomes those
/// of this one. Errors: faces that are no surface.
Result<MeasuredStructure> measured_structure(std::string name, const MeshFile& mesh,
                                             std::shared_ptr<const Topology>& faces);

/// Meshes that lend landmarks and regions to those of the same faces that lack them: a landmark goes to the same place
/// of the surface, a region to the same vertices.
class Lenders {
 public:
  void add(std::shared_ptr<const Template> lender) { lenders_.push_back(std::move(lender)); }
  /// The structures of a shape whose landmarks or regions can be lent.
  void add(const MeasuredShape& shape);
  /// Whether one of them has the faces of one of the shape's structures.
  bool lend_to(MeasuredShape& shape) const;

 private:
  std::vector<std::shared_ptr<const Template>> lenders_;
};

/// A sentence that says that a template lends nothing. `what`: the thing whose faces differ from its own, as "the
/// shapes".
std::string unsuited_template(const std::string& the_template, const std::string& what);

/// A shape of a model as what is measured: of a joint model each structure by its name. `points`: n×3 of the model.
/// Errors: faces that are no surface.
Result<MeasuredShape> measured_shape(const ShapeModel& model, const Points& points);

/// A case as what is measured, at the frame that it shows: the structure of an id (empty: the first) and then the
/// others that have a mesh there, each with its template's landmarks and regions. A landmark that was placed in the
/// image lies there, the others where the mesh has carried them. The image is the case's own, which must outlive it.
/// The structure must have a mesh.
MeasuredShape measured_shape(const Document& document, const std::string& structure);

/// The heads of a recipe's columns in a table, and the values of a shape in them: a comma before each.
std::string measurement_columns(const Recipe& recipe);
std::string measurement_cells(const std::vector<MeasuredNumber>& values);

/// The measurements of one shape of a model.
struct ModeValues {
  int mode = 0;   ///< the mode's number, from 1
  double sd = 0;  ///< standard deviations along the mode: 0 is the mean
  std::vector<MeasuredNumber> values;
};
/// Each of the first `modes` modes at −most_sd…most_sd whole standard deviations; at 0 it is the mean. Errors:
/// cancelled; faces that are no surface.
Result<std::vector<ModeValues>> measure_modes(const Recipe& recipe, const ShapeModel& model, int modes,
                                              const Lenders& lenders, Progress& progress, int most_sd = 2);

}  // namespace homolog
