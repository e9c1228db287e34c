#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/groupwise/consensus.h"
#include "core/mesh/mesh_io.h"

namespace homolog {

/// A subject of a study of templates.
struct BiasSubject {
  std::string name;
  Boundary boundary;
  std::vector<Landmark> landmarks;  ///< places on its surface, LPS mm; without any, places spread over it stand in
};

struct BiasOptions {
  int vertices = 2500;
  bool consensus =
      false;  ///< each start first becomes a consensus template; else the subject's own mesh is the template
  Progress* progress = nullptr;
};

/// How much results depend on which subject the template was made from.
struct TemplateBias {
  double spread_mm = 0, spread_p95_mm = 0, spread_max_mm = 0;  ///< over all places
  std::map<std::string, double> spread_of_mm;                  ///< mean of each landmark
  std::map<std::string, double> apart_mm_of;  ///< mean distance of a start's answers from the mean of all, by its name
  std::string best_start;                     ///< whose answers lie nearest to that mean
  double rv = 0, rv_least = 0;        ///< modified RV of the starts' morphospaces: mean over all pairs, and the least
  std::vector<std::string> failed;    ///< starts that gave no template or could not be fitted to all, left out
  std::vector<std::string> doubtful;  ///< subjects likely of another organ [unlike_the_others]
  std::vector<std::string> warnings;  ///< warnings of the starts' own templates, each with its subject's name
};

/// Takes every subject once as the start: a template of it is fitted to all subjects. Then each start has its own
/// answer where a place of one subject lies on another. `spread`: the root mean square distance of the answers to their
/// mean, averaged over all places and pairs of subjects. The raters' error does not enter. `rv`: the modified RV
/// coefficient [Smilde 2009] of the M×M products of the aligned shapes, 1 where all starts see the same differences
/// between the subjects. Errors: fewer than three subjects or starts; cancelled.
Result<TemplateBias> template_bias(const std::vector<BiasSubject>& subjects, const BiasOptions& options = {});

/// The modified RV coefficient of two M×M products: their correlation without the diagonals [Smilde 2009].
double modified_rv(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace homolog
