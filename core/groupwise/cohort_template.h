#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/adapt/labels/choose_closing.h"
#include "core/groupwise/consensus.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume.h"

namespace homolog {

/// A label map as it was read, and which label and frame of it are meant.
struct CohortMap {
  Volume volume;
  int label = 0;  ///< or every_label
  int frame = 0;
};

/// A subject that is a label map. It is read each time that it is needed, so that not all lie in memory at once.
struct CohortMember {
  std::string name;
  std::function<Result<CohortMap>(Progress& progress)> read;
};

/// One closing radius for a whole cohort.
struct CohortClosing {
  struct Tried {
    std::string subject;
    TriedClosing closing;
  };
  std::optional<double> closing_mm;  ///< absent: each label's usual one
  std::vector<Tried> tried;
};

/// Looks at label maps of small, median and large size [choose_template_closing]; the widest radius that one of them
/// needs is all subjects'. Members that cannot be read are left out here. `making`: vertices and genus count.
Result<CohortClosing> choose_cohort_closing(const std::vector<CohortMember>& members, const MaskTemplateOptions& making,
                                            Progress* progress);

/// Subjects of a template of many.
struct Cohort {
  std::vector<std::string> names;    ///< the subjects' names, for warnings and the file
  std::vector<Boundary> boundaries;  ///< in the same order
  std::optional<double> closing_mm;  ///< the closing that all have in common
};

/// The subject that a consensus starts from: that of median size.
std::size_t consensus_start(const Cohort& cohort);

struct CohortConsensus {
  Consensus made;
  MeshFile file;  ///< says which subjects it is of, and the closing radius
  std::vector<std::string> warnings;
};

/// The consensus template of a cohort, from a template of `consensus_start` (LPS mm). Errors: those of
/// consensus_template; a mesh with faults, whose sentence names the subject that is likely of another organ.
Result<CohortConsensus> cohort_consensus(const Cohort& cohort, const Mesh& start, int vertices, Progress* progress);

/// The sentence about a subject whose fits are in much doubt.
std::string other_organ_warning(const std::string& name);
/// Sentences that name subjects whose volume no spread of the others explains [unlike_in_volume].
std::vector<std::string> volume_warnings(const std::vector<std::string>& names,
                                         const std::vector<const Boundary*>& subjects);

}  // namespace homolog
