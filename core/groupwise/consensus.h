#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/template_making/mesh_template.h"

namespace homolog {

struct ConsensusOptions {
  int vertices = 2500;
  int most_rounds = 6;
  /// A mean whose surface moves less rests: of the square root of the area, or of the mean edge. By so much of an edge
  /// the even spreading changes a surface from round to round.
  double rests_share = 2e-3, rests_edges = 0.1;
  std::optional<std::size_t> start;  ///< the subject to start from; absent: the one of median size
  std::optional<Mesh> first;         ///< the start's template where it was made already; else own_template
  Progress* progress = nullptr;
};

struct Consensus {
  Mesh mesh;                          ///< upright as the subjects are on average, its centroid at 0, mm
  int rounds = 0;                     ///< rounds in which all subjects were fitted
  double moved_mm = 0;                ///< root mean square of how far the mean's surface moved in the last round
  bool rests = false;                 ///< less than `rests_share` or `rests_edges`
  std::vector<std::size_t> left_out;  ///< subjects that could not be fitted in the last round
  std::vector<std::size_t> doubtful;  ///< likely of another organ, by the last round [unlike_the_others]
  std::size_t start = 0;              ///< the subject that was started from
  std::vector<std::string> warnings;  ///< warnings of the start's own template, each a sentence
};

/// A template that no subject decides: the start, made even, is fitted to all subjects; their mean shape, made even, is
/// the next start, until the mean rests. The fits are rough [FitOptions] until that mean rests, in
/// half of the rounds at most. The order of the subjects
/// does not matter to the bit; the start does little (docs/templates.md). Errors: fewer than two subjects or fits; no
/// template can be made of the start; cancelled.
Result<Consensus> consensus_template(const std::vector<Boundary>& subjects, const ConsensusOptions& options = {});

/// The subjects from the smallest to the largest.
std::vector<std::size_t> subjects_by_size(const std::vector<Boundary>& subjects);

/// `vertices` spread evenly over the subject's surface: a template of its own. Errors: as make_mesh_template.
Result<MeshTemplate> own_template(const Boundary& subject, int vertices, Progress* progress = nullptr);

/// Which subjects look like mirror images of most others (and not only turned as RAS is against LPS), or of two
/// subjects the smaller one of the other. Empty where it was cancelled.
std::vector<std::size_t> mirrored_subjects(const std::vector<const Boundary*>& subjects,
                                           const Progress* progress = nullptr);
/// The subject of the other side: x negated, faces turned.
Boundary mirrored_boundary(const Boundary& subject);

}  // namespace homolog
