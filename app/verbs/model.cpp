#include <charconv>
#include <filesystem>
#include <sstream>

#include "app/verbs/verb.h"
#include "core/base/listed.h"
#include "core/mesh/formats/formats.h"
#include "core/model/evaluation.h"
#include "core/model/model_files.h"
#include "core/model/statismo.h"
#include "core/model/training_set.h"

// Verbs on a training set: model, evaluate.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct TrainingVerb {
  std::vector<fs::path> files;
  bool keep_scale = false, no_align = false;
  TrainingOptions reading;

  Alignment alignment() const {
    return no_align ? Alignment::none : keep_scale ? Alignment::rigid : Alignment::similarity;
  }
};

void add_training_options(CLI::App& verb, TrainingVerb& options) {
  verb.add_option("SHAPE", options.files,
                  "Shapes in correspondence (" + listed(mesh_format_extensions(&MeshFormat::keeps_numbers), ", ") +
                      ", .homolog), or a study (.study.json)")
      ->required();
  auto* keep_scale = verb.add_flag("--keep-scale", options.keep_scale, "Align by translation and rotation only");
  verb.add_flag("--no-align", options.no_align, "Do not align the shapes")->excludes(keep_scale);
  verb.add_flag("--all-frames", options.reading.all_frames,
                "Take every edited frame of a cine, not only the one that the case shows");
  verb.add_flag("--flip-mirrored", options.reading.flip_mirrored, "Flip shapes that are mirror images of most others");
  verb.add_option("--group", options.reading.group, "Take only the cases of this group of a study");
}

struct Training {
  std::vector<std::string> names;
  std::shared_ptr<const Topology> topology;
  PrincipalComponents components;
  std::vector<std::string> warnings;
};

Result<Training> train(const TrainingVerb& options, Progress& progress) {
  auto read = read_training_set(options.files, options.reading, &progress);
  if (!read) return fail(read.error());
  Training training;
  training.names = std::move(read->set.names);
  training.topology = read->set.topology;
  training.warnings = std::move(read->warnings);
  align(read->set.shapes, options.alignment());
  training.components = principal_components(std::move(read->set.shapes));
  if (training.components.scatter.size() == 0) {
    return fail(training.names.front(),
                "differs from the other shapes by its pose alone, so there is nothing to model; give different shapes");
  }
  return training;
}

Json cumulative(const Eigen::VectorXd& variances) {
  Json shares = Json::array();
  double held = 0;
  for (const double variance : variances) shares.push_back((held += variance) / variances.sum());
  return shares;
}

struct ModelOptions {
  TrainingVerb training;
  fs::path out, tables, aligned;
  double variance = 0.95;
};

Result<Report> make_and_write(const ModelOptions& options, Progress& progress) {
  if (!is_model_name(options.out)) return fail(options.out.string(), "is not the name of a model; use .h5.json or .h5");
  auto training = train(options.training, progress);
  if (!training) return fail(training.error());
  const PrincipalComponents& components = training->components;
  const auto names = shape_names(training->names);
  if (!options.tables.empty())
    if (auto done = write_model_tables(components, names, options.tables); !done) return fail(done.error());
  if (!options.aligned.empty())
    if (auto done = write_aligned_shapes(components, training->topology, names, options.aligned); !done)
      return fail(done.error());
  const ShapeModel model = make_model(components, options.variance, training->topology, names);
  if (auto written = write_model(model, options.out); !written) return fail(written.error());
  Report report;
  report.warnings = std::move(training->warnings);
  if (components.shapes() == 2)
    report.warnings.emplace_back("two shapes give a model of a single mode; give more for one that describes an organ");
  const Eigen::VectorXd variances = components.variances();
  report.values = {{"shapes", components.shapes()},
                   {"vertices", components.vertices()},
                   {"modes", model.modes()},
                   {"variances", std::vector<double>(variances.begin(), variances.end())},
                   {"explained", cumulative(variances)}};
  return report;
}

struct EvaluateOptions {
  TrainingVerb training;
  fs::path csv;
  Eigen::Index samples = 1000;
  std::uint64_t seed = 1;
  std::string modes;
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
    int m = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), m);
    if (error != std::errc() || end != word.data() + word.size() || m < 1) return {};
    modes.push_back(m);
  }
  return modes;
}

Result<Report> evaluate(const EvaluateOptions& options, Progress& progress) {
  auto training = train(options.training, progress);
  if (!training) return fail(training.error());
  const PrincipalComponents& components = training->components;
  const auto most = static_cast<int>(components.shapes()) - 2;
  if (most < 1) {
    return fail(training->names.front(),
                "and one other shape are too few to leave one out; give at least three shapes");
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
  report.warnings = std::move(training->warnings);
  if (!training->topology)
    report.warnings.emplace_back("the shapes have points only, so generalization_surface is left out");
  report.values = to_json(*measured);
  return report;
}

}  // namespace

void add_model(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<ModelOptions>();
  CLI::App* verb = add_verb(app, "model", "A statistical shape model from shapes in correspondence");
  add_training_options(*verb, options->training);
  verb->add_option("-o,--output", options->out, "The model to write (.h5.json or .h5, statismo and scalismo 0.9)")
      ->required();
  verb->add_option("--variance", options->variance, "Keep as many modes as hold this share of the variance")
      ->check(CLI::Range(0.01, 1.0));
  verb->add_option("--csv", options->tables, "Folder for mean.csv, variances.csv and scores.csv");
  verb->add_option("--aligned", options->aligned, "Folder for the aligned shapes as .ply and .particles");
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return make_and_write(*options, progress); }; });
}

void add_evaluate(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* verb = add_verb(app, "evaluate", "Compactness, generalisation and specificity of a training set");
  add_training_options(*verb, options->training);
  verb->add_option("--samples", options->samples, "How many random shapes to draw for specificity")
      ->check(CLI::Range(1, 1000000));
  verb->add_option("--seed", options->seed, "Seed of the random shapes");
  verb->add_option("--modes", options->modes,
                   "Numbers of modes to report at: all, or a list like 1,3,8 (default: the number that holds 95 %)")
      ->check([](const std::string& text) {
        return parsed_modes(text, 1).empty() ? text + " is neither all nor mode counts like 1,3,8" : std::string();
      });
  verb->add_option("--csv", options->csv, "Write the measures as a table too");
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return evaluate(*options, progress); }; });
}

}  // namespace homolog
