#include <map>

#include "app/verbs/measure/measure_recipe.h"
#include "app/verbs/verb.h"
#include "core/base/files/files.h"
#include "core/base/text/listed.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/meeting.h"
#include "core/mesh/formats/formats.h"
#include "core/model/files/landmark_table.h"
#include "core/model/files/model_files.h"
#include "core/model/measures/observers.h"
#include "core/model/measures/sizes.h"
#include "core/model/shapes/shape_files.h"

// Verbs that put shapes into tables: measure, landmarks, observers.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct ShapesVerb {
  std::vector<fs::path> files;
  bool all_frames = false;
  std::string group;
  fs::path out;
};

void add_shapes(CLI::App& verb, ShapesVerb& options) {
  verb.add_option("SHAPE", options.files,
                  "Shapes (" + listed(mesh_format_extensions(&MeshFormat::keeps_numbers), ", ") +
                      ", .homolog), a folder of them, or a study (.study.json)")
      ->required();
  verb.add_flag("--all-frames", options.all_frames,
                "Take every edited frame of a cine, not only the one that the case shows");
  verb.add_option("--group", options.group, "Take only the cases of this group of a study");
}

struct NamedShapes {
  std::vector<std::string> names;
  std::vector<MeshFile> shapes;
  std::vector<std::string> groups;  ///< of a study's cases; empty: no shape has one
  std::vector<std::string> warnings;
};

Result<NamedShapes> read(const ShapesVerb& options, Progress& progress) {
  const auto sources = shape_sources(options.files, options.group);
  if (!sources) return fail(sources.error());
  NamedShapes all;
  std::vector<std::string> of_first;
  const auto take = [&](ReadShape shape) -> Result<void> {
    if (!shape.others.empty())
      of_first.push_back(shape.name + ": has " + std::to_string(shape.others.size() + 1) +
                         " structures, and the figures are of " + shape.structure +
                         " alone; give the meshes of the others, or a recipe that names them");
    all.names.push_back(std::move(shape.name));
    all.shapes.push_back(*shape.mesh);
    all.groups.push_back(shape.of->group);
    return {};
  };
  auto warnings = read_shapes(*sources, {options.all_frames}, take, &progress);
  if (!warnings) return fail(warnings.error());
  if (std::ranges::all_of(all.groups, &std::string::empty)) all.groups.clear();
  all.names = names_with_folders(all.names);
  all.warnings = std::move(*warnings);
  std::ranges::move(of_first, std::back_inserter(all.warnings));
  return all;
}

Json or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

Json described(const Spread& spread) {
  if (spread.count == 0) return {{"count", 0}, {"mean", nullptr}, {"sd", nullptr}};
  return {{"count", spread.count}, {"mean", spread.mean}, {"sd", spread.sd}};
}

Result<Report> run_measure(const ShapesVerb& options, Progress& progress) {
  auto all = read(options, progress);
  if (!all) return fail(all.error());
  Report report;
  report.warnings = std::move(all->warnings);
  std::vector<ShapeSizes> sizes;
  std::vector<Meeting> met;
  std::shared_ptr<const Topology> faces;
  for (std::size_t k = 0; k < all->shapes.size(); ++k) {
    auto one = sizes_of(all->shapes[k], faces);
    if (!one) return fail(all->names[k], one.error().what);
    if (!one->inward.empty()) report.warnings.push_back(all->names[k] + ": " + one->inward);
    met.push_back({all->names[k], bounds_of(all->shapes[k].points).diagonal().norm()});
    sizes.push_back(std::move(*one));
  }
  for (std::string& sentence : misfits_among(met, "the other shapes")) report.warnings.push_back(std::move(sentence));
  const auto pairs = landmark_pairs(sizes);
  Json cases = Json::array(), distances = Json::object();
  std::vector<std::optional<double>> volumes, areas;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    Json between = Json::object();
    for (const LandmarkPair& pair : pairs)
      if (const auto distance = distance_mm(sizes[k], pair)) between[pair.first + " to " + pair.second] = *distance;
    cases.push_back({{"case", all->names[k]},
                     {"volume_ml", or_null(sizes[k].volume_ml)},
                     {"area_mm2", or_null(sizes[k].area_mm2)},
                     {"centroid_size_mm", sizes[k].centroid_size_mm},
                     {"distances_mm", std::move(between)}});
    if (sizes[k].volume_capped_ml) cases.back()["volume_capped_ml"] = *sizes[k].volume_capped_ml;
    if (!all->groups.empty()) cases.back()["group"] = all->groups[k];
    volumes.push_back(sizes[k].volume_ml);
    areas.push_back(sizes[k].area_mm2);
  }
  for (const LandmarkPair& pair : pairs) {
    std::vector<std::optional<double>> values;
    for (const ShapeSizes& one : sizes) values.push_back(distance_mm(one, pair));
    distances[pair.first + " to " + pair.second] = described(spread_of(values));
  }
  report.values = {{"cases", std::move(cases)},
                   {"volume_ml", described(spread_of(volumes))},
                   {"area_mm2", described(spread_of(areas))},
                   {"distances_mm", std::move(distances)}};
  if (!options.out.empty()) {
    if (auto done = write_whole_file(options.out, sizes_table(all->names, sizes, all->groups)); !done)
      return fail(done.error());
    report.values["table"] = options.out.string();
    report.made = {options.out};
  }
  return report;
}

Result<Report> run_landmarks(const ShapesVerb& options, bool vertices, Progress& progress) {
  auto all = read(options, progress);
  if (!all) return fail(all.error());
  std::vector<Specimen> specimens;
  for (std::size_t k = 0; k < all->shapes.size(); ++k) {
    const MeshFile& shape = all->shapes[k];
    if (vertices && shape.points.rows() != all->shapes.front().points.rows())
      return fail(all->names[k], "has " + std::to_string(shape.points.rows()) + " vertices where " +
                                     all->names.front() + " has " + std::to_string(all->shapes.front().points.rows()) +
                                     "; give shapes of one template");
    specimens.push_back({all->names[k], vertices ? vertices_as_landmarks(shape.points) : shape.landmarks});
  }
  const auto table = write_landmark_table(specimens, options.out);
  if (!table) return fail(table.error());
  Report report;
  report.warnings = std::move(all->warnings);
  if (!table->lacking.empty())
    report.warnings.push_back(listed(table->lacking, ", ") + ": lack landmarks that others have, which are NA in " +
                              options.out.string() + "; geomorph can estimate them, MorphoJ needs all");
  report.values = {{"shapes", specimens.size()}, {"table", options.out.string()}};
  report.made = {options.out};
  report.values["landmarks"] = vertices ? Json(table->landmarks.size()) : Json(table->landmarks);
  return report;
}

Json described(const ObservedCase& one) {
  Json values{{"case", one.name},
              {"dice", one.agreement.dice},
              {"assd_mm", one.agreement.assd_mm},
              {"hd95_mm", one.agreement.hd95_mm},
              {"hausdorff_mm", one.agreement.hausdorff_mm}};
  if (one.agreement.vertex_mean_mm)
    values["vertex_distance_mm"] = {{"mean", *one.agreement.vertex_mean_mm}, {"max", *one.agreement.vertex_max_mm}};
  values["volume_ml"] = {one.volume_a_ml, one.volume_b_ml};
  values["landmarks_mm"] = one.landmarks_mm;
  return values;
}

/// Over all cases: what a paper reports.
Json summary_of(const std::vector<ObservedCase>& cases) {
  const auto over = [&](const auto& value_of) {
    std::vector<std::optional<double>> values;
    for (const ObservedCase& one : cases) values.push_back(value_of(one));
    return spread_of(values);
  };
  Json landmarks = Json::object();
  for (const ObservedCase& one : cases)
    for (const auto& [name, unused] : one.landmarks_mm)
      landmarks[name] = described(over([&, &called = name](const ObservedCase& other) -> std::optional<double> {
        const auto there = other.landmarks_mm.find(called);
        return there == other.landmarks_mm.end() ? std::nullopt : std::optional(there->second);
      }));
  const Spread off = over([](const ObservedCase& one) { return std::optional(one.volume_b_ml - one.volume_a_ml); });
  Json volume = described(off);
  if (off.count > 0) volume["limits"] = {off.mean - 1.96 * off.sd, off.mean + 1.96 * off.sd};
  return {{"dice", described(over([](const ObservedCase& one) { return std::optional(one.agreement.dice); }))},
          {"assd_mm", described(over([](const ObservedCase& one) { return std::optional(one.agreement.assd_mm); }))},
          {"hd95_mm", described(over([](const ObservedCase& one) { return std::optional(one.agreement.hd95_mm); }))},
          {"vertex_mean_mm", described(over([](const ObservedCase& one) { return one.agreement.vertex_mean_mm; }))},
          {"volume_difference_ml", std::move(volume)},
          {"landmarks_mm", std::move(landmarks)}};
}

Result<Report> run_observers(const fs::path& first, const fs::path& second, const fs::path& out, Progress& progress) {
  auto a = read_observer(first, &progress);
  if (!a) return fail(a.error());
  auto b = read_observer(second, &progress);
  if (!b) return fail(b.error());
  auto comparison = compare_observers(a->shapes, b->shapes, &progress);
  if (!comparison && comparison.error().subject.empty())
    return fail(first.string() + " and " + second.string(), comparison.error().what);
  if (!comparison) return fail(comparison.error());
  Report report;
  report.warnings = std::move(a->warnings);
  report.warnings.insert(report.warnings.end(), b->warnings.begin(), b->warnings.end());
  const auto alone = [&](const std::vector<std::string>& names, const fs::path& where) {
    if (!names.empty())
      report.warnings.push_back(where.string() + ": " + listed(names, ", ") + " is compared with nothing (left out)");
  };
  alone(comparison->only_first, second);
  alone(comparison->only_second, first);
  for (const ObservedCase& one : comparison->cases)
    report.warnings.insert(report.warnings.end(), one.warnings.begin(), one.warnings.end());
  Json cases = Json::array();
  for (const ObservedCase& one : comparison->cases) cases.push_back(described(one));
  report.values = {{"cases", std::move(cases)}, {"summary", summary_of(comparison->cases)}};
  if (!out.empty()) {
    if (auto done = write_whole_file(out, observers_table(*comparison)); !done) return fail(done.error());
    report.values["table"] = out.string();
    report.made = {out};
  }
  return report;
}

}  // namespace

void add_measure(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<ShapesVerb>();
  auto job = std::make_shared<RecipeJob>();
  CLI::App* verb = add_verb(app, "measure",
                            "Volume, area and distances between named landmarks of every shape, or what a recipe "
                            "names, as a table");
  add_shapes(*verb, *options);
  verb->add_option("--csv,-o,--output", options->out, "Also write the table there");
  verb->add_option(
      "--recipe", job->recipe,
      "What to measure: a file (.json), or " + listed(shipped_recipes(), ", ") + "; without it that of the template");
  verb->add_option("--template", job->the_template,
                   "Lends its landmarks and regions to shapes of its numbering that have none");
  verb->add_option("--landmarks", job->landmarks,
                   "The landmarks of a shape, or a folder with a file of each shape's name");
  auto* image = verb->add_option("--image", job->image,
                                 "What image_mean samples along the normals: an image, or a folder with one of each "
                                 "shape's name");
  verb->add_option("--profiles", job->profiles, "Folder for each mesh (.vtp) with the image along its normals")
      ->needs(image);
  auto* model = verb->add_option("--model", job->model, "Measure along the modes of this model too (.h5, .h5.json)");
  verb->add_option("--modes", job->modes, "How many modes, else 3")->check(CLI::Range(1, 1000))->needs(model);
  verb->callback([verb, options, job, &asked] {
    const bool by_recipe = verb->count("--recipe") + verb->count("--template") > 0;
    if (!by_recipe)
      for (const char* option : {"--landmarks", "--model", "--image"}) refuse_without_effect(*verb, option, "--recipe");
    asked.run = [options, job, by_recipe](Progress& progress) {
      if (!by_recipe) return run_measure(*options, progress);
      job->files = options->files;
      job->all_frames = options->all_frames;
      job->group = options->group;
      job->out = options->out;
      return measure_by_recipe(*job, progress);
    };
  });
}

void add_landmarks(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<ShapesVerb>();
  auto vertices = std::make_shared<bool>(false);
  CLI::App* verb = add_verb(app, "landmarks", "The landmarks of many shapes in one file, for geomorph and MorphoJ");
  add_shapes(*verb, *options);
  verb->add_option("-o,--output", options->out, "The file to write: .tps for geomorph, .csv for MorphoJ")->required();
  verb->add_flag("--vertices", *vertices, "Every vertex is a landmark, not only the named ones");
  verb->callback([options, vertices, &asked] {
    asked.run = [options, vertices](Progress& progress) { return run_landmarks(*options, *vertices, progress); };
  });
}

void add_observers(CLI::App& app, CommandLine& asked) {
  struct Options {
    fs::path first, second, out;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, "observers", "How well two observers of the same cases agree");
  verb->add_option("FIRST", options->first, "A study, a folder of cases or meshes, or one of them")->required();
  verb->add_option("SECOND", options->second, "The same by the other observer, with cases of the same names")
      ->required();
  verb->add_option("--csv", options->out, "Also write a row for each case there");
  verb->callback([options, &asked] {
    asked.run = [options](Progress& progress) {
      return run_observers(options->first, options->second, options->out, progress);
    };
  });
}

}  // namespace homolog
