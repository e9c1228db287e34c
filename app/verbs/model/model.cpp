#include <algorithm>
#include <filesystem>

#include "app/verbs/describe.h"
#include "app/verbs/model/training.h"
#include "app/verbs/record.h"
#include "core/base/files/files.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/groupwise/optimise.h"
#include "core/mesh/formats/formats.h"
#include "core/model/files/model_files.h"
#include "core/model/files/statismo.h"
#include "core/model/joint_models/structure_files.h"
#include "core/model/measures/leave_one_out.h"
#include "core/model/shapes/shape_files.h"
#include "core/model/training_set.h"
#include "core/statistics/parallel_analysis.h"

// The verb `model`.

namespace homolog {

namespace fs = std::filesystem;

namespace {

Json cumulative(const PrincipalComponents& components) {
  Json shares = Json::array();
  const double total = components.total_variance();
  double held = 0;
  for (const double variance : components.variances()) shares.push_back((held += variance) / total);
  return shares;
}

constexpr const char* by_chance = "parallel";

struct ModelOptions {
  TrainingVerb training;
  fs::path out, tables, aligned, optimised;
  double variance = 0.95;
  bool optimise = false, free_landmarks = false, modes_by_chance = false;
  GivenCommand command;

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

/// Errors: a mesh that would be written into a folder is one that is read here.
Result<void> check_written(const ModelOptions& options, const std::vector<std::string>& names, const fs::path& folder) {
  const TrainingVerb& training = options.training;
  std::vector<fs::path> read, written;
  if (training.structures.empty()) {
    const auto sources = shape_sources(training.files, training.reading.group);
    if (!sources) return fail(sources.error());
    for (const ShapeSource& source : *sources) read.push_back(source.file);
    for (const std::string& name : names) written.push_back(folder / (name + ".ply"));
    return check_not_read(written, read);
  }
  const auto frame = training.world ? ShapeWorksFrame::world : ShapeWorksFrame::local;
  const auto cases = structure_files(training.files, training.structures, frame);
  if (!cases) return fail(cases.error());
  for (const CaseFiles& one : *cases)
    for (const ShapeSource& source : one.of_structure)
      if (!source.file.empty()) read.push_back(source.file);
  for (const std::string& name : names)
    for (const std::string& structure : training.structures) {
      written.push_back(folder / name / (structure + ".ply"));
      for (const char* ending : {"_local.particles", "_world.particles"})
        written.push_back(folder / (name + "_" + structure + ending));
    }
  return check_not_read(written, read);
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
  if (auto safe = check_written(options, names, folder); !safe) return fail(safe.error());
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
    if (file.triangles.rows() == 0) file.triangles = read.set.topology;
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

Result<Training> train_optimised(const ModelOptions& options, Json& report, Progress& progress) {
  auto read = read_training_set(options.training.files, options.training.reading, &progress);
  if (!read) return fail(read.error());
  auto done = optimise(options, *read, progress);
  if (!done) return fail(done.error());
  report = std::move(*done);
  return train(std::move(*read), options.training);
}

/// The tables and the aligned shapes, where they are asked for.
Result<void> write_beside(const ModelOptions& options, const Training& training,
                          const std::vector<std::string>& names) {
  const PrincipalComponents& components = training.components;
  if (!options.tables.empty()) {
    // As `test` and `measure` name shapes, so that their tables go together.
    const auto called = training.parts.empty() ? names_with_folders(training.names) : names;
    if (auto done = write_model_tables(components, called, options.tables, training.sizes_mm, training.groups); !done)
      return done;
    if (training.poses)
      if (auto done = write_pose_table(*training.poses, training.parts, names, training.completed, options.tables);
          !done)
        return done;
  }
  if (options.aligned.empty()) return {};
  if (training.parts.empty()) return write_aligned_shapes(components, training.topology, names, options.aligned);
  const ShapeMatrix aligned = components.centred.colwise() + components.mean;
  return write_structures(training.in_scan, aligned, training.topology ? training.topology->triangles() : Triangles(),
                          training.parts, names, options.aligned);
}

/// How many modes the model keeps. Errors: those above chance are asked for, and there is none.
Result<Eigen::Index> modes_kept(const ModelOptions& options, const PrincipalComponents& components,
                                Progress& progress) {
  if (options.training.leading_modes > 0) return options.training.leading_modes;
  if (!options.modes_by_chance) return modes_holding(components.variances(), options.variance);
  constexpr std::uint64_t seed = 1;  // as test has it
  const Eigen::Index modes = modes_above_chance(components.centred, seed, &progress);
  if (progress.cancelled()) return fail("", "cancelled");
  if (modes == 0)
    return fail(std::string("--modes ") + by_chance, "finds no mode that holds more than chance; ask for a number");
  return modes;
}

Result<Report> make_and_write(const ModelOptions& options, Progress& progress) {
  if (!is_model_name(options.out)) return fail(options.out.string(), "is not the name of a model; use .h5.json or .h5");
  if (auto there = check_folder_of(options.out); !there) return fail(there.error());
  Json optimised;
  auto training = options.optimise ? train_optimised(options, optimised, progress)
                                   : train(options.training, progress, !options.aligned.empty());
  if (!training) return fail(training.error());
  const PrincipalComponents& components = training->components;
  const auto names = training->parts.empty() ? shape_names(training->names) : training->names;
  if (!options.aligned.empty())
    if (auto safe = check_written(options, names, options.aligned); !safe) return fail(safe.error());
  if (auto done = write_beside(options, *training, names); !done) return fail(done.error());
  const auto modes = modes_kept(options, components, progress);
  if (!modes) return fail(modes.error());
  ShapeModel model = model_of_modes(components, *modes, training->topology, names);
  model.alignment = options.training.alignment();
  model.faced = training->faced;
  model.parts = training->parts;
  model.poses = training->poses;
  model.completed = training->completed;
  model.left_out_distances = left_out_distances(components, model.modes());
  const auto record = record_of(options.command, progress);
  if (!record) return fail(record.error());
  if (auto written = write_model(model, options.out, *record); !written) return fail(written.error());
  Report report;
  report.warnings = std::move(training->warnings);
  if (components.shapes() == 2)
    report.warnings.emplace_back("two shapes give a model of a single mode; give more for one that describes an organ");
  const Eigen::VectorXd variances = components.variances();
  report.values = {{"shapes", components.shapes()},
                   {"vertices", components.vertices()},
                   {"modes", model.modes()},
                   {"variances", std::vector<double>(variances.begin(), variances.end())},
                   {"explained", cumulative(components)}};
  training->report(report.values);
  if (options.optimise) report.values["optimise"] = std::move(optimised);
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
  verb->add_option_function<std::string>(
          "--modes",
          [options](const std::string& text) {
            options->modes_by_chance = text == by_chance;
            options->training.leading_modes = as_number<Eigen::Index>(text).value_or(0);
          },
          "Keep this many modes; of thousands of shapes no others are computed, which is faster. Or \"parallel\": "
          "those "
          "that hold more than chance, by parallel analysis")
      ->check([](const std::string& text) {
        return text == by_chance || as_number<Eigen::Index>(text).value_or(0) > 0
                   ? std::string()
                   : text + " is neither a number of modes nor parallel";
      })
      ->excludes("--variance");
  verb->add_option("--csv", options->tables, "Folder for mean.csv, variances.csv and scores.csv");
  verb->add_option("--aligned", options->aligned, "Folder for the aligned shapes as .ply and .particles");
  verb->add_flag("--complete", options->training.complete,
                 "Cases that lack a structure are completed by what the joint model of the others expects, and marked")
      ->needs("--structures");
  auto* optimise = verb->add_flag("--optimise", options->optimise,
                                  "First slide the vertices along their surfaces, so that the set is shorter to "
                                  "describe. Named landmarks and confirmed regions stay")
                       ->excludes("--structures");
  verb->add_option("--optimised", options->optimised,
                   "Folder for the optimised meshes (default: NAME-optimised beside the model)")
      ->needs(optimise);
  verb->add_flag("--free-landmarks", options->free_landmarks, "Vertices at named landmarks slide too")->needs(optimise);
  verb->callback([options, verb, &asked] {
    check_training_options(options->training);
    options->command = given_command(*verb);
    asked.run = [options](Progress& progress) { return make_and_write(*options, progress); };
  });
}

}  // namespace homolog
