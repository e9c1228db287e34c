#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/topology.h"
#include "core/model/alignment/procrustes.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "core/template/template.h"

namespace homolog {

/// Shapes in correspondence, where their files have them.
struct TrainingSet {
  std::vector<std::string> names;            ///< path of each shape
  std::shared_ptr<const Topology> topology;  ///< null where every file is `.particles`
  ShapeMatrix shapes;                        ///< 3n×M, mm
  std::optional<FacedNames> faced{};         ///< which part of a label they are of, where all that say it agree
};

struct TrainingOptions {
  bool all_frames = false;     ///< take every edited frame of a cine; else only the frame that the case shows
  bool flip_mirrored = false;  ///< shapes that are mirror images of most others are flipped
  std::string group;           ///< the group that is taken of a study's cases; empty: all
  /// Shapes in doubt [doubt_of_shape], a study's cases in doubt, and mirror images that are not flipped are left out.
  bool without_doubtful = false;
  bool vertex_doubts = false;  ///< gives how far each vertex is in doubt too
};

struct TrainingSetRead {
  TrainingSet set;
  std::vector<std::string> warnings;  ///< each names its file: what was left out, and what looks wrong (see oddities)
  std::vector<std::string> mirrored;  ///< names of the shapes that are mirror images of most others
  std::vector<std::string> groups;    ///< each shape's group among the study's cases; empty: no shape has one
  std::vector<std::vector<std::string>> study_keys;      ///< each shape's keys of study cases [ShapeSource]
  std::vector<DoubtfulShape> doubtful;                   ///< shapes of the set that a person has to look at
  std::vector<DoubtfulShape> left_out;                   ///< the same, where they were left out as asked
  std::map<std::string, VertexScalars> vertex_doubts{};  ///< mm, by the shape's name, where asked and its file has them
};

/// Puts shapes together into a training set, one after the other; keeps one copy of their points.
class TrainingSetBuilder {
 public:
  explicit TrainingSetBuilder(std::size_t most_shapes);
  ~TrainingSetBuilder();
  TrainingSetBuilder(const TrainingSetBuilder&) = delete;
  TrainingSetBuilder& operator=(const TrainingSetBuilder&) = delete;

  /// A mesh whose faces are those of the others turned inside out, as a template of the other side has them, is in
  /// correspondence.
  void add(std::string name, const MeshFile& mesh);
  std::size_t shapes() const { return set_.names.size(); }
  /// The set, once; the warnings are its oddities and that its shapes are of other parts of labels, but mirror images
  /// are only listed. Errors: a shape with another
  /// vertex count, other faces or another order of vertices [numbering.h] than most of the rest have (the error's
  /// subject is its name), fewer than two shapes, shapes that are all equal.
  Result<TrainingSetRead> finish(bool flip_mirrored = false);

 private:
  class Majority;
  std::unique_ptr<Majority> majority_;
  std::size_t most_shapes_;
  TrainingSet set_;
  std::vector<std::optional<FacedNames>> faced_;  ///< the part of a label that each shape is of
};

/// Reads meshes (PLY, VTK, VTP, OBJ), `.particles`, case files and studies into one training set. A file that cannot be
/// read (absent, damaged, a NaN vertex) is left out with a warning. Errors: a mesh with another vertex count, other
/// faces or another order of vertices than most of the rest have (named), shape_sources' and read_shapes', fewer than
/// two shapes left, shapes that are all equal, cancelled.
Result<TrainingSetRead> read_training_set(const std::vector<std::filesystem::path>& files,
                                          const TrainingOptions& options = {}, Progress* progress = nullptr);

/// The error that a set is too small, with the first of the set's warnings: it says which shape was left out and why.
Error too_small(Error error, const std::vector<std::string>& warnings);

/// Things that look wrong in a set that can be computed with, a sentence each: sizes 10, 100 or 1000 times those of
/// most others, shapes given twice.
std::vector<std::string> oddities(const TrainingSet& set);

/// Whether a shape is nearly the mirror image of another one, n×3 both.
bool looks_mirrored(const Points& shape, const Points& other);
/// Which whole power of ten, not 0, a ratio of sizes is near to: as of lengths in another unit. 0: none.
int power_of_ten(double ratio);

/// The shapes, as columns of the set, that are mirror images of most others.
std::vector<Eigen::Index> mirrored_shapes(const TrainingSet& set);

}  // namespace homolog
