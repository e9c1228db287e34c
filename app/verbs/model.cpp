#include <algorithm>
#include <filesystem>
#include <sstream>

#include "app/verbs/verb.h"
#include "core/base/listed.h"
#include "core/base/text.h"
#include "core/groupwise/optimise.h"
#include "core/mesh/formats/formats.h"
#include "core/model/evaluation.h"
#include "core/model/model_files.h"
#include "core/model/shape_files.h"
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
                      ", .homolog), a folder of them, or a study (.study.json)")
      ->required();
  auto* keep_scale = verb.add_flag("--keep-scale", options.keep_scale, "Align by translation and rotation only");
  verb.add_flag("--no-align", options.no_align, "Do not align the shapes")->excludes(keep_scale);
  verb.add_flag("--all-frames", options.reading.all_frames,
                "Take every edited frame of a cine, not only the one that the case shows");
  verb.add_flag("--flip-mirrored", options.reading.flip_mirrored, "Flip shapes that are mirror images of most others");
  verb.add_option("--group", options.reading.group, "Take only the cases of this group of a study");
  verb.add_flag("--without-doubtful", options.reading.without_doubtful,
                "Leave out shapes that are doubtful, mirrored (without --flip-mirrored) or have faulty faces");
}

struct Training {
  std::vector<std::string> names;
  std::shared_ptr<const Topology> topology;
  PrincipalComponents components;
  std::vector<std::string> warnings;
  std::vector<double> sizes_mm;  ///< centroid sizes before they were aligned
  std::vector<std::string> groups;
  std::vector<DoubtfulShape> doubtful, left_out;

  void report_doubt(Json& values) const {
    const auto listed_shapes = [](const std::vector<DoubtfulShape>& shapes) {
      Json list = Json::array();
      for (const DoubtfulShape& one : shapes) list.push_back({{"name", one.name}, {"reason", one.reason}});
      return list;
    };
    values["doubtful"] = listed_shapes(doubtful);
    values["left_out"] = listed_shapes(left_out);
  }
};

Result<Training> train(TrainingSetRead read, const TrainingVerb& options) {
  Training training;
  training.names = std::move(read.set.names);
  training.topology = read.set.topology;
  training.warnings = std::move(read.warnings);
  training.groups = std::move(read.groups);
  for (Eigen::Index k = 0; k < read.set.shapes.cols(); ++k)
    training.sizes_mm.push_back(centroid_size_mm(points_of(read.set.shapes, k)));
  training.doubtful = std::move(read.doubtful);
  training.left_out = std::move(read.left_out);
  align(read.set.shapes, options.alignment());
  training.components = principal_components(std::move(read.set.shapes));
  if (training.components.scatter.size() == 0) {
    return fail(training.names.front(),
                "differs from the other shapes by its pose alone, so there is nothing to model; give different shapes");
  }
  return training;
}

Result<Training> train(const TrainingVerb& options, Progress& progress) {
  auto read = read_training_set(options.files, options.reading, &progress);
  if (!read) return fail(read.error());
  return train(std::move(*read), options);
}

Json cumulative(const Eigen::VectorXd& variances) {
  Json shares = Json::array();
  double held = 0;
  for (const double variance : variances) shares.push_back((held += variance) / variances.sum());
  return shares;
}

struct ModelOptions {
  TrainingVerb training;
  fs::path out, tables, aligned, optimised;
  double variance = 0.95;
  bool optimise = false, free_landmarks = false;

  /// Where optimised meshes go: as asked, or beside the model under its name.
  fs::path optimised_folder() const {
    if (!optimised.empty()) return optimised;
    const std::string name = out.filename().string();
    return out.parent_path() / (name.substr(0, name.find(".h5")) + "-optimised");
  }
};

Json figures_json(const SetFigures& figures) {
  Json json{{"bits", figures.bits}, {"position_bits", figures.position_bits}};
  if (figures.modes > 0)
    json.update(Json{{"compactness", figures.compactness},
                     {"generalization_rms", figures.generalisation_rms},
                     {"specificity_rms", figures.specificity_rms}});
  return json;
}

/// The files of a training set as they were read, in its order; those that were left out of it too are left out.
Result<std::vector<MeshFile>> files_of(const TrainingVerb& options, const std::vector<std::string>& names,
                                       Progress& progress) {
  const auto sources = shape_sources(options.files, options.reading.group);
  if (!sources) return fail(sources.error());
  std::vector<MeshFile> files;
  const auto take = [&](const ReadShape& shape) {
    if (std::find(names.begin(), names.end(), shape.name) != names.end()) files.push_back(*shape.mesh);
    return Result<void>();
  };
  if (auto read = read_shapes(*sources, {options.reading.all_frames}, take, &progress); !read)
    return fail(read.error());
  return files;
}

/// Slides the set's vertices and writes the meshes; the set then holds the optimised shapes.
Result<Json> optimise(const ModelOptions& options, TrainingSetRead& read, Progress& progress) {
  const auto names = shape_names(read.set.names);
  const fs::path folder = options.optimised_folder();
  for (std::size_t k = 0; k < names.size(); ++k)
    if (fs::weakly_canonical(read.set.names[k]) == fs::weakly_canonical(folder / (names[k] + ".ply")))
      return fail(folder.string(),
                  "holds " + names[k] + ".ply, which is one of the set; name another folder for the optimised meshes");
  progress.part(0, 0.1);
  auto files = files_of(options.training, read.set.names, progress);
  if (!files) return fail(files.error());
  progress.part(0.1, 0.9);
  GroupwiseOptions sliding;
  sliding.alignment = options.training.alignment();
  sliding.progress = &progress;
  if (read.set.topology)
    for (const MeshFile& file : *files)
      sliding.held.push_back(held_vertices(file, *read.set.topology, !options.free_landmarks));
  auto optimised = optimise_set(read.set, sliding);
  if (!optimised) return fail(optimised.error());
  std::vector<NamedShape> shapes;
  Json slides = Json::array();
  for (std::size_t k = 0; k < files->size(); ++k) {
    Points points = points_of(optimised->shapes, static_cast<Eigen::Index>(k));
    const bool flipped = options.training.reading.flip_mirrored && std::find(read.mirrored.begin(), read.mirrored.end(),
                                                                             read.set.names[k]) != read.mirrored.end();
    if (flipped) points.col(0) *= -1;
    MeshFile& file = (*files)[k];
    file.points = std::move(points);
    file.doubt_mm.reset();  // of places that the vertices have left
    forget_doubt(file);
    if (file.triangles.rows() == 0) file.triangles = read.set.topology->triangles();
    shapes.push_back({names[k], std::make_shared<const MeshFile>(std::move(file)), {}, true});
    slides.push_back({{"name", names[k]}, {"largest_slide_mm", optimised->largest_slide_mm[k]}});
  }
  if (auto written = write_shapes(shapes, ".ply", folder, nullptr); !written) return fail(written.error());
  read.set.shapes = std::move(optimised->shapes);
  progress.part(0.9, 1);
  return Json{
      {"modes", optimised->before.modes},
      {"before", figures_json(optimised->before)},
      {"after", figures_json(optimised->after)},
      {"largest_slide_mm", *std::max_element(optimised->largest_slide_mm.begin(), optimised->largest_slide_mm.end())},
      {"surface_moved_mm", optimised->surface_moved_mm},
      {"turned_triangles", optimised->turned_triangles},
      {"meshes", folder.string()},
      {"shapes", std::move(slides)}};
}

Result<Report> make_and_write(const ModelOptions& options, Progress& progress) {
  if (!is_model_name(options.out)) return fail(options.out.string(), "is not the name of a model; use .h5.json or .h5");
  auto read = read_training_set(options.training.files, options.training.reading, &progress);
  if (!read) return fail(read.error());
  Json optimised;
  if (options.optimise) {
    auto done = optimise(options, *read, progress);
    if (!done) return fail(done.error());
    optimised = std::move(*done);
  }
  auto training = train(std::move(*read), options.training);
  if (!training) return fail(training.error());
  const PrincipalComponents& components = training->components;
  const auto names = shape_names(training->names);
  if (!options.tables.empty())
    if (auto done = write_model_tables(components, names, options.tables, training->sizes_mm, training->groups); !done)
      return fail(done.error());
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
  training->report_doubt(report.values);
  if (options.optimise) report.values["optimise"] = std::move(optimised);
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
    const auto m = as_number<int>(word);
    if (!m || *m < 1) return {};
    modes.push_back(*m);
  }
  return modes;
}

Result<Report> evaluate(const EvaluateOptions& options, Progress& progress) {
  auto training = train(options.training, progress);
  if (!training) return fail(training.error());
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
  report.warnings = std::move(training->warnings);
  if (!training->topology)
    report.warnings.emplace_back("the shapes have points only, so generalization_surface is left out");
  report.values = to_json(*measured);
  training->report_doubt(report.values);
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
  auto* optimise = verb->add_flag("--optimise", options->optimise,
                                  "First slide the vertices along their surfaces, so that the set is shorter to "
                                  "describe. Named landmarks and confirmed regions stay");
  verb->add_option("--optimised", options->optimised,
                   "Folder for the optimised meshes (default: NAME-optimised beside the model)")
      ->needs(optimise);
  verb->add_flag("--free-landmarks", options->free_landmarks, "Vertices at named landmarks slide too")->needs(optimise);
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return make_and_write(*options, progress); }; });
}

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
  verb->add_option("--csv", options->csv, "Write the measures as a table too");
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return evaluate(*options, progress); }; });
}

}  // namespace homolog
