#include <algorithm>
#include <sstream>

#include "app/verbs/describe.h"
#include "app/verbs/model/training.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/model/measures/evaluation.h"

// The verb `evaluate`: measures of a training set.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct EvaluateOptions {
  TrainingVerb training;
  fs::path csv;
  Eigen::Index samples = 1000;
  std::uint64_t seed = 1;
  std::string modes, structure;
};

/// "all", or numbers with commas between; empty where it is neither.
std::vector<int> parsed_modes(const std::string& text, int most) {
  std::vector<int> modes;
  if (text == "all") {
    for (int m = 1; m <= most; ++m) modes.push_back(m);
    return modes;
  }
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');) {
    const auto m = as_number<int>(word);
    if (!m || *m < 1) return {};
    modes.push_back(*m);
  }
  return modes;
}

/// One structure of a joint set as it was aligned in it. Errors: not one of the set's.
Result<void> keep_structure(Training& training, const std::string& name) {
  const StructurePart* part = part_named(training.parts, name);
  if (part == nullptr) {
    std::vector<std::string> names;
    for (const StructurePart& one : training.parts) names.push_back(one.name);
    return fail("--structure " + name, "is none of the structures that are joined; name " + listed(names, " or "));
  }
  if (training.topology) {
    auto topology = Topology::make(part->vertices, triangles_of(*part, training.topology->triangles()));
    if (!topology) return fail(part->name, topology.error().what);
    training.topology = std::move(*topology);
  }
  const PrincipalComponents& all = training.components;
  training.components = principal_components(rows_of(*part, all.centred.colwise() + all.mean));
  if (training.components.scatter.size() > 0) return {};
  return fail(part->name, "is the same in all cases, so there is nothing to measure; name another structure");
}

Result<Report> evaluate(const EvaluateOptions& options, Progress& progress) {
  if (auto there = check_folder_of(options.csv); !there) return fail(there.error());
  auto training = train(options.training, progress);
  if (!training) return fail(training.error());
  if (!options.structure.empty())
    if (auto kept = keep_structure(*training, options.structure); !kept) return fail(kept.error());
  const PrincipalComponents& components = training->components;
  const auto most = static_cast<int>(components.shapes()) - 2;
  if (most < 1) {
    return fail(too_small(
        {training->names.front(), "and one other shape are too few to leave one out; give at least three shapes"},
        training->warnings));
  }
  std::vector<int> modes = parsed_modes(options.modes, most);
  if (options.modes.empty()) modes = {std::min(most, static_cast<int>(modes_holding(components.variances(), 0.95)))};
  if (const auto highest = std::max_element(modes.begin(), modes.end()); *highest > most) {
    return fail("--modes " + std::to_string(*highest), "is more than " + std::to_string(components.shapes()) +
                                                           " shapes allow; the most is " + std::to_string(most));
  }
  const auto measured =
      evaluate_model(components, training->topology, {std::move(modes), options.samples, options.seed}, &progress);
  if (!measured) return fail(measured.error());
  if (!options.csv.empty())
    if (auto written = write_evaluation(*measured, options.csv); !written) return fail(written.error());
  Report report;
  if (!options.csv.empty()) report.made = {options.csv};
  report.warnings = std::move(training->warnings);
  if (!training->topology)
    report.warnings.emplace_back("the shapes have points only, so generalization_surface is left out");
  report.values = to_json(*measured);
  training->report(report.values);
  if (!options.structure.empty()) report.values["structure"] = part_named(training->parts, options.structure)->name;
  return report;
}

}  // namespace

void add_evaluate(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* verb = add_verb(app, "evaluate", "Compactness, generalisation and specificity of a training set");
  add_training_options(*verb, options->training);
  verb->add_option("--samples", options->samples, "How many random shapes to draw for specificity")
      ->check(CLI::Range(1, 1000000));
  verb->add_option("--seed", options->seed, "Seed of the random shapes")->check(CLI::NonNegativeNumber);
  verb->add_option("--modes", options->modes,
                   "Numbers of modes to report at: all, or a list like 1,3,8 (default: the number that holds 95 %)")
      ->check([](const std::string& text) {
        return parsed_modes(text, 1).empty() ? text + " is neither all nor mode counts like 1,3,8" : std::string();
      });
  verb->add_option("--structure", options->structure,
                   "Measure this one of the structures, as it lies in the joint shapes")
      ->needs("--structures");
  verb->add_option("--csv", options->csv, "Write the measures as a table too");
  verb->callback([options, &asked] {
    check_training_options(options->training);
    asked.run = [options](Progress& progress) { return evaluate(*options, progress); };
  });
}

}  // namespace homolog
