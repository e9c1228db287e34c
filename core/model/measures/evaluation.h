#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/model/measures/measures.h"

namespace homolog {

struct EvaluationOptions {
  std::vector<int> modes;  ///< mode counts of the mean and surface distances, each 1…M−2
  Eigen::Index samples = 1000;
  std::uint64_t seed = 1;
};

/// The measures of a training set by name, as `homolog evaluate` reports them; see docs/models.md.
struct Evaluation {
  Eigen::Index shapes = 0, vertices = 0;
  double total_variance_mm2 = 0;
  std::vector<int> modes;  ///< the numbers of modes for the entries of at_modes and shapeworks
  std::vector<std::pair<std::string, Measures>> at_every;  ///< at m = 1…M−2
  std::vector<std::pair<std::string, Measures>> at_modes, shapeworks;

  /// Finds a measure in at_every or at_modes; null where it was not measured.
  const Measures* find(const std::string& name) const;
  /// Finds one in shapeworks: "compactness", "generalization" or "specificity"; null where it was not measured.
  const Measures* find_shapeworks(const std::string& name) const;
};

/// All measures; the surface distance where there is a topology. Errors: fewer than three shapes,
/// no mode or one that is not 1…M−2; cancelled.
Result<Evaluation> evaluate_model(const PrincipalComponents& components,
                                  const std::shared_ptr<const Topology>& topology, const EvaluationOptions& options,
                                  Progress* progress = nullptr);

nlohmann::ordered_json to_json(const Evaluation& evaluation);
/// A table, a row a mode count; to_json under a name that ends in .json. Whole or not at all.
Result<void> write_evaluation(const Evaluation& evaluation, const std::filesystem::path& path);

}  // namespace homolog
