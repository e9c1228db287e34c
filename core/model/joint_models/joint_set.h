#pragma once

#include <vector>

#include "core/model/joint_models/structure_files.h"
#include "core/model/joint_models/structure_parts.h"
#include "core/model/training_set.h"

namespace homolog {

/// A training set of shapes that are made of several structures.
struct JointSet {
  TrainingSetRead read;  ///< names are those of the cases; left_out holds cases that lack a structure, with the reason
  std::vector<StructurePart> parts;
  std::vector<CompletedStructure> completed;
};

struct JointOptions {
  bool without_doubtful = false;  ///< as TrainingOptions says; a structure that is left out is one that a case lacks
  /// Cases that lack structures but not all are completed [completed_shapes]; else they are left out.
  bool complete = false;
  Alignment alignment = Alignment::similarity;  ///< the alignment in which they are completed
  bool vertex_doubts = false;                   ///< gives those of cases whose structures all have them
};

/// Reads the structures of cases (structure_files) and joins them, the structures in the order given. The sentences of
/// what cannot be read, of doubts and of oddities name their files. Errors: as read_training_set of one structure;
/// fewer than two cases that have all structures; cancelled.
Result<JointSet> read_joint_set(const std::vector<CaseFiles>& cases, const std::vector<std::string>& structures,
                                const JointOptions& options, Progress* progress = nullptr);

}  // namespace homolog
