#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/verbs/verb.h"
#include "core/model/shape_model.h"
#include "core/model/training_set.h"

namespace homolog {

/// The arguments of `model` and `evaluate` on their training set.
struct TrainingVerb {
  std::vector<std::filesystem::path> files;
  bool keep_scale = false, no_align = false;
  TrainingOptions reading;
  Eigen::Index leading_modes = 0;  ///< how many components are computed; 0: all
  // Several structures have these.
  std::vector<std::string> structures;  ///< empty: shapes of one
  std::string together = "common";      ///< or "each"
  bool complete = false, world = false;

  Alignment alignment() const {
    return no_align ? Alignment::none : keep_scale ? Alignment::rigid : Alignment::similarity;
  }
};

/// Adds the options of a training set of one structure.
void add_set_options(CLI::App& verb, TrainingVerb& options);
/// Adds the options that `model` and `evaluate` share.
void add_training_options(CLI::App& verb, TrainingVerb& options);
/// Refuses those that make no sense together. For the callbacks of these verbs.
void check_training_options(const TrainingVerb& options);

/// An aligned training set and its components.
struct Training {
  std::vector<std::string> names;  ///< the set's names; of several structures those of the cases
  std::shared_ptr<const Topology> topology;
  PrincipalComponents components;
  std::vector<std::string> warnings;
  std::vector<double> sizes_mm;     ///< centroid sizes before they were aligned
  std::optional<FacedNames> faced;  ///< the set's
  std::vector<std::string> groups;
  std::vector<std::vector<std::string>> study_keys;  ///< each shape's, as TrainingSetRead has them
  std::vector<DoubtfulShape> doubtful, left_out;
  std::size_t flipped = 0;  ///< mirror images that were flipped, as asked
  // Several structures have these.
  std::vector<StructurePart> parts;
  std::optional<StructurePoses> poses;
  std::vector<CompletedStructure> completed;
  ShapeMatrix in_scan;  ///< the shapes before they were aligned, where `keep_unaligned` asked for them

  /// The names of the set's shapes, of shapes in doubt, of structures and how they vary.
  void report(Json& values) const;
};

/// The structures of a joint model, with the spread of where each lies against its mean place.
Json json_of(const std::vector<StructurePart>& parts, const StructurePoses& poses);
/// Which structures of which shapes are completed. `names`: of the shapes.
Json json_of(const std::vector<CompletedStructure>& completed, const std::vector<std::string>& names,
             const std::vector<StructurePart>& parts);

/// Aligns a set of shapes of one structure. Errors: shapes that differ by their pose alone.
Result<Training> train(TrainingSetRead read, const TrainingVerb& options);

/// Reads a set, of one structure or of several, and aligns it. Errors: those of read_training_set, structure_files and
/// read_joint_set; the same.
Result<Training> train(const TrainingVerb& options, Progress& progress, bool keep_unaligned = false);

}  // namespace homolog
