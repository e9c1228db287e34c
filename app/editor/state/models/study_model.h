#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/case/document.h"
#include "core/mesh/colours.h"
#include "core/model/alignment/procrustes.h"
#include "core/model/measures/sizes.h"
#include "core/model/measures/suspicion.h"
#include "core/model/shape_model.h"
#include "core/model/shapes/shape_files.h"
#include "core/model/shapes/study.h"

namespace homolog {

/// The shapes of a study, aligned, and the model of them; never changed once made.
struct StudyModel {
  std::vector<std::string> names, groups;  ///< those of the cases whose shapes are in it, in the study's order
  std::unordered_map<std::string, std::size_t> places;  ///< places of the names among them
  std::shared_ptr<const Topology> topology;             ///< null where all are points alone
  Alignment alignment = Alignment::none;
  std::vector<double> sizes_mm;  ///< centroid size of each shape before it was aligned
  std::shared_ptr<const PrincipalComponents> components;
  ShapeModel model;                                ///< the model with 95 % of the variance
  Mesh mean;                                       ///< without topology where there is none
  std::shared_ptr<const std::vector<float>> hues;  ///< the vertices' hues
  std::vector<double> distances_mm;                ///< root mean square over the vertices to the mean, of each shape
  Vec3 centre_mm = Vec3::Zero();                   ///< the centre of all shapes; the origin where they were aligned
  double radius_mm = 1;                            ///< the radius that all shapes reach around it

  std::vector<std::string> doubts;                 ///< the study's doubt of each shape's fit; empty: no doubt
  std::vector<SuspiciousShape> suspicious_shapes;  ///< those beyond the fences

  Eigen::Index vertices() const { return mean.points.rows(); }
  /// A shape as it was aligned, mm. Made of the mean and what is left after it: all of them would take much memory.
  Points shape(std::size_t k) const;
  /// −1 where the case has no shape in the model.
  std::ptrdiff_t index_of(const std::string& name) const;
  /// Groups that at least two shapes belong to, in the order of their first.
  std::vector<std::string> comparable_groups() const;
  /// The shapes of a group.
  std::vector<Eigen::Index> of_group(const std::string& group) const;
};

/// Suspicious places and shapes among the shapes of a model: they take longer than the model, and are found after it.
struct Suspicions {
  std::vector<std::string> doubts;  ///< the doubt of each shape [doubt_of_shape]; empty: nothing is known against it
  std::vector<SuspiciousVertex> vertices;
  std::vector<SuspiciousTriangle> triangles;
};

/// The shapes of a study by the names of their cases, and the model of them.
struct ShapesOfStudy {
  std::map<std::string, std::shared_ptr<const MeshFile>> shapes;  ///< the shape of every case that has one, as it lies
  std::map<std::string, ShapeSizes> sizes;                        ///< sizes of those that have faces
  std::shared_ptr<const StudyModel> model;                        ///< null where there is none
};

/// Whether both have the same vertices, faces, named landmarks and confirmed vertices.
bool same_shape(const MeshFile& a, const MeshFile& b);

/// Mean of group `to` minus mean of group `from` along the normals of the mean shape, mm; outwards is positive. Both
/// must be comparable.
VertexScalars difference_of_groups_mm(const StudyModel& model, const std::string& from, const std::string& to);

/// Shapes as they were read, by file: read again only when it was written since.
struct ReadFile {
  std::filesystem::file_time_type written;
  ShapesOfFile shapes;
};
using ReadFiles = std::map<std::filesystem::path, ReadFile>;

}  // namespace homolog
