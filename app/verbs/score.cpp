#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/input_folders.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "app/verbs/verbs.h"
#include "core/adapt/choose_closing.h"
#include "core/adapt/fit.h"
#include "core/adapt/image/fit_to_image.h"
#include "core/adapt/judge_fit.h"
#include "core/base/files.h"
#include "core/base/listed.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/formats/formats.h"
#include "core/model/model_files.h"
#include "core/model/model_prior.h"
#include "core/model/numbering.h"
#include "core/model/score.h"
#include "core/model/shape_files.h"
#include "core/model/statismo.h"
#include "core/model/structure_files.h"
#include "core/model/study.h"
#include "core/model/training_set.h"
#include "core/session/case_file.h"
#include "core/template/template.h"
#include "core/volume/label_likeness.h"

// The verb `score`: subjects against a model that stays as it is.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct ScoreJob {
  std::vector<fs::path> files;
  fs::path model, out;
  fs::path landmarks;  ///< in the images that NEW are: one's file, or a folder with a file of each one's name
  fs::path the_template;
  std::string label;
  std::optional<int> frame;
  bool flip_mirrored = false;
  GivenCommand command;
};

/// What label maps are fitted with: the model's mean, and the shapes that the model allows, of which the nearest comes
/// first. So the fit lies in the model's correspondence as far as the map leaves it open.
struct MapScoring {
  std::shared_ptr<const Template> mean;
  std::shared_ptr<const AllowedShapes> allowed;  ///< null: of a model of several structures
};

/// A shape to score, in the model's numbering.
struct NewShape {
  std::string name;  ///< the file's
  MeshFile mesh;
  std::string doubt;     ///< why the fit is in doubt; empty: it is not, or it was none
  std::size_t from = 0;  ///< which of the files that were named
};

/// Fits the model's mean to a label map, as `fit --model` does with one case.
Result<NewShape> shape_of_map(const ScoreJob& job, const MapScoring& with, const fs::path& path,
                              std::vector<std::string>& warnings, Progress& progress) {
  const std::shared_ptr<const Template>& mean = with.mean;
  auto mask = read_mask(path, job.label, {job.frame, {}, {}}, progress);
  if (!mask) {
    const auto read = read_volume(path);
    if (read && !holds_labels(read->volume) && job.label.empty())
      return fail(path.string(), "is an image and no label map; give --landmarks and --template with images");
    return fail(mask.error());
  }
  warnings.insert(warnings.end(), mask->warnings.begin(), mask->warnings.end());
  const auto boundary =
      label_boundary(mask->volume, mask->label, mask->frame, usual_closing_mm(mask->volume, mask->label, mask->frame),
                     mean->points.rows(), parts_for(*mean->topology));
  if (!boundary) return fail(path.string(), mask->named(boundary.error().what));
  FitOptions options;
  options.allowed = with.allowed;
  options.progress = &progress;
  auto fit = fit_to_boundary(*mean, *boundary, options);
  if (!fit) return fail(path.string(), fit.error().what);
  const FitJudgement judgement = judge_fit(*mean, *boundary, options, *fit);
  NewShape shape{path.string(), {}, {}};
  shape.mesh.points = fit->mesh.points;
  shape.mesh.triangles = fit->mesh.topology->triangles();
  shape.mesh.doubt_mm = fit->doubt_mm;
  if (judgement.doubtful) shape.doubt = "the fit is doubtful; look at it with fit";
  return shape;
}

/// What the images are drawn with: the template that has the landmarks, and the shapes that the model allows.
struct ImageScoring {
  std::shared_ptr<const Template> the_template;
  AllowedShapes allowed;
};

Result<ImageScoring> image_scoring(const ScoreJob& job, const ShapeModel& model) {
  auto the_template = load_template(job.the_template.string());
  if (!the_template) return fail(the_template.error());
  auto allowed = allowed_by(model, **the_template);
  if (!allowed) return fail(job.model.string(), allowed.error().what);
  return ImageScoring{std::move(*the_template), std::move(*allowed)};
}

/// Draws the model's mean to the boundary that an image shows, from where the landmarks place it, as `fit --image
/// --landmarks --model` does.
Result<NewShape> shape_of_image(const ScoreJob& job, const ImageScoring& with, const fs::path& path,
                                std::vector<std::string>& warnings, Progress& progress) {
  const auto landmarks =
      read_case_landmarks({job.landmarks, job.the_template.string(), false}, *with.the_template, path);
  if (!landmarks) return fail(landmarks.error());
  const auto placement = placement_by_landmarks(*with.the_template, landmarks->places);
  if (!placement) return fail(path.string(), placement.error().what);
  const int frame = job.frame.value_or(0);
  const auto image = read_image(path, frame, progress);
  if (!image) return fail(image.error());
  warnings.insert(warnings.end(), image->warnings.begin(), image->warnings.end());
  SnapOptions options;
  options.progress = &progress;
  auto fit =
      fit_to_image(*with.the_template, image->volume, frame, *placement, landmarks->places, options, &with.allowed);
  if (!fit) return fail(path.string(), fit.error().what);
  NewShape shape{path.string(), {}, {}};
  shape.mesh.points = std::move(fit->mesh.points);
  shape.mesh.triangles = with.the_template->topology->triangles();
  return shape;
}

/// The structures of a joint model in one case, joined. `name`: what the case is called.
Result<NewShape> joined_shape(const ShapeModel& model, const CaseFiles& files, const std::string& name) {
  NewShape shape{name, {}, {}};
  shape.mesh.points.resize(model.mean.size() / 3, 3);
  shape.mesh.triangles = model.topology ? model.topology->triangles() : Triangles();
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    const StructurePart& part = model.parts[k];
    const ShapeSource& source = files.of_structure[k];
    if (source.file.empty()) return fail(name, "has no " + part.name + ", which the model has");
    const auto shape_read = read_shape(source);
    if (!shape_read) return fail(shape_read.error());
    const MeshFile* read = shape_read->get();
    if (read->points.rows() != part.vertices)
      return fail(source.name({}), "has " + std::to_string(read->points.rows()) + " vertices and the model's " +
                                       part.name + " " + std::to_string(part.vertices) +
                                       "; give a fit of the model's template");
    shape.mesh.points.middleRows(part.first_vertex, part.vertices) = read->points;
  }
  return shape;
}

/// What a path stands for where the model is of several structures: a case, by its folder or its file, or the cases of
/// a study as that says, flipped ones flipped.
std::vector<Result<NewShape>> joined_shapes(const ShapeModel& model, const fs::path& path) {
  std::vector<std::string> names;
  for (const StructurePart& part : model.parts) names.push_back(part.name);
  const auto cases = structure_files({path}, names);
  std::vector<Result<NewShape>> shapes;
  if (!cases)
    shapes.emplace_back(fail(cases.error()));
  else if (cases->size() != 1 && !is_study_file(path))
    shapes.emplace_back(fail(path.string(), "holds several cases; give each case's folder"));
  else
    for (const CaseFiles& one : *cases)
      shapes.push_back(joined_shape(model, one, is_study_file(path) ? one.name : path.string()));
  return shapes;
}

Result<MapScoring> map_scoring(const ScoreJob& job, const ShapeModel& model) {
  MeshFile mean;
  mean.points = points_of(model.mean);
  mean.triangles = model.topology ? model.topology->triangles() : Triangles();
  auto made = make_template(std::move(mean), "the model's mean");
  if (!made) return fail(job.model.string(), "has a mean that is no surface, so nothing can be fitted");
  MapScoring with{std::move(*made), nullptr};
  if (auto allowed = allowed_by(model, *with.mean); allowed && model.parts.empty())
    with.allowed = std::make_shared<const AllowedShapes>(std::move(*allowed));
  return with;
}

/// What looks wrong about a shape beside the model's mean, a sentence each. Flips a mirror image where that is asked.
std::vector<std::string> check_against_mean(const ScoreJob& job, const ShapeModel& model, NewShape& shape) {
  std::vector<std::string> found;
  const Points mean = points_of(model.mean);
  Points& points = shape.mesh.points;
  if (points.rows() != mean.rows() || model.alignment == Alignment::none) return found;
  if (looks_mirrored(mean, points)) {
    if (job.flip_mirrored) points.col(0) *= -1;
    found.push_back(shape.name + ": looks like a mirror image of the model's mean (left and right exchanged); " +
                    (job.flip_mirrored ? "flipped" : "use --flip-mirrored to flip it"));
  }
  if (const int power = power_of_ten(centroid_size_mm(points) / centroid_size_mm(mean)); power != 0)
    found.push_back(shape.name + ": about " + std::to_string(std::lround(std::pow(10, std::abs(power)))) +
                    " times as " + (power > 0 ? "large" : "small") +
                    " as the model's mean; its lengths may not be in mm, so convert it first");
  ShapeMatrix both(model.mean.size(), 2);
  both << model.mean, Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  if (model.parts.empty() && !other_numbering(both, model.topology).shapes.empty())
    found.push_back(shape.name +
                    ": has its vertices in another order than the model; its score means nothing, so make it from the "
                    "model's template");
  return found;
}

/// All shapes, in the order in which they were named. What cannot be read becomes a warning.
Result<std::vector<NewShape>> read_new_shapes(const ScoreJob& job, const ShapeModel& model,
                                              std::vector<std::string>& warnings, Progress& progress) {
  std::vector<NewShape> shapes;
  std::size_t from = 0;
  const auto add = [&](Result<NewShape> shape) {
    if (!shape) return warnings.push_back(shape.error().sentence());
    shape->from = from;
    for (std::string& sentence : check_against_mean(job, model, *shape)) warnings.push_back(std::move(sentence));
    shapes.push_back(std::move(*shape));
  };
  std::optional<MapScoring> of_maps;
  std::optional<ImageScoring> of_images;
  if (!job.landmarks.empty()) {
    if (!model.parts.empty())
      return fail(job.model.string(),
                  "is of several structures, whose places no landmarks give; score a case's folder");
    auto made = image_scoring(job, model);
    if (!made) return fail(made.error());
    of_images = std::move(*made);
  }
  std::error_code error;
  const auto count = static_cast<double>(job.files.size());
  for (std::size_t k = 0; k < job.files.size(); ++k) {
    const fs::path& path = job.files[k];
    from = k;
    Progress own(progress, 1 / count);
    if (progress.cancelled()) return fail("", "the scores were cancelled");
    if (!model.parts.empty() && (fs::is_directory(path, error) || is_case_file(path) || is_study_file(path))) {
      for (auto& shape : joined_shapes(model, path)) add(std::move(shape));
    } else if (!fs::is_directory(path, error) && !is_mesh_name(path) && looks_like_volume(path)) {
      if (of_images) {
        add(shape_of_image(job, *of_images, path, warnings, own));
        continue;
      }
      if (!of_maps) {
        auto made = map_scoring(job, model);
        if (!made) return fail(made.error());
        of_maps = std::move(*made);
      }
      add(shape_of_map(job, *of_maps, path, warnings, own));
    } else {
      const auto sources = shape_sources({path});
      if (!sources) {
        add(fail(sources.error()));
        continue;
      }
      const auto take = [&](ReadShape shape) -> Result<void> {
        NewShape taken{std::move(shape.name), *shape.mesh, std::move(shape.doubt), k};
        for (std::string& sentence : check_against_mean(job, model, taken)) warnings.push_back(std::move(sentence));
        shapes.push_back(std::move(taken));
        return {};
      };
      const auto read = read_shapes(*sources, {.doubts = true}, take, &own);
      if (!read) {
        add(fail(read.error()));
        continue;
      }
      warnings.insert(warnings.end(), read->begin(), read->end());
    }
  }
  return shapes;
}

Json described_part(const ScoreOfPart& part) {
  return {{"z_rms", part.z_rms}, {"residual_mm", part.residual_mm}};
}

Json described_score(const std::string& name, const ShapeScore& score, const ShapeModel& model,
                     const std::string& doubt) {
  Json row{{"name", name},
           {"distance", score.distance},
           {"residual_mm", score.residual_mm},
           {"percentile", score.percentile ? Json(*score.percentile) : Json()},
           {"z_rms", score.all.z_rms},
           {"size_mm", score.size_mm},
           {"modes", std::vector<double>(score.modes.begin(), score.modes.end())},
           {"doubt", doubt.empty() ? Json() : Json(doubt)}};
  if (model.parts.empty()) return row;
  Json parts = Json::array();
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    Json part = described_part(score.parts[k]);
    part["name"] = model.parts[k].name;
    parts.push_back(std::move(part));
  }
  row["structures"] = std::move(parts);
  return row;
}

/// Writes a shape with z of each vertex, where it lies: as VTP, since in PLY z is a coordinate.
Result<void> write_scored(const MeshFile& shape, const ShapeModel& model, const ShapeScore& score, std::string record,
                          const fs::path& to) {
  const MeshFile file{.points = shape.points,
                      .triangles = model.topology->triangles(),
                      .doubt_mm = shape.doubt_mm,
                      .values = {{"z", score.z}, {"z_low", score.z_low}, {"z_high", score.z_high}},
                      .record = std::move(record)};
  return write_mesh_file(file, to);
}

Result<void> write_score_table(const Json& subjects, const fs::path& path) {
  std::ostringstream table;
  table.precision(9);
  table << "name,distance,residual_mm,percentile,z_rms,size_mm";
  for (std::size_t m = 0; m < subjects[0]["modes"].size(); ++m) table << ",mode_" << m + 1;
  table << '\n';
  for (const Json& one : subjects) {
    table << csv_field(one["name"].get<std::string>());
    for (const char* column : {"distance", "residual_mm", "percentile", "z_rms", "size_mm"}) {
      table << ',';
      if (!one[column].is_null()) table << one[column].get<double>();
    }
    for (const Json& mode : one["modes"]) table << ',' << mode.get<double>();
    table << '\n';
  }
  return write_whole_file(path, table.str());
}

/// The same job with folders of label maps opened; folders with shapes stay.
ScoreJob with_maps_opened(ScoreJob job) {
  std::vector<fs::path> files;
  for (const fs::path& file : job.files) {
    std::error_code error;
    const bool is_folder = fs::is_directory(file, error);
    const auto maps = is_folder && !shape_sources({file}) ? volumes_in(file) : std::vector<fs::path>();
    const auto kept = job.landmarks.empty() ? label_maps_among(maps) : maps;
    files.insert(files.end(), kept.begin(), kept.end());
    if (kept.empty()) files.push_back(file);
  }
  job.files = std::move(files);
  return job;
}

Result<Report> score(const ScoreJob& asked, Progress& progress) {
  const ScoreJob job = with_maps_opened(asked);
  const auto model = read_model(job.model);
  if (!model) return fail(model.error());
  Report report;
  progress.part(0, 0.9);
  auto shapes = read_new_shapes(job, *model, report.warnings, progress);
  if (!shapes) return fail(shapes.error());
  progress.part(0.9, 1);
  std::vector<std::string> files;
  for (const NewShape& shape : *shapes) files.push_back(shape.name);
  const auto names = shape_names(files);
  if (!job.out.empty())
    if (auto made = make_folder(job.out); !made) return fail(made.error());
  Json subjects = Json::array();
  std::vector<std::string> of_files(job.files.size());  // records, each of what one file gives
  for (std::size_t k = 0; k < shapes->size(); ++k) {
    const MeshFile& mesh = (*shapes)[k].mesh;
    const auto scored = score_shape(*model, mesh.points, mesh.doubt_mm ? *mesh.doubt_mm : VertexScalars());
    if (!scored) {
      report.warnings.push_back(files[k] + ": " + scored.error().what);
      continue;
    }
    subjects.push_back(described_score(names[k], *scored, *model, (*shapes)[k].doubt));
    if (job.out.empty()) continue;
    auto record = of_files[(*shapes)[k].from];
    if (record.empty()) {
      auto made = record_of(job.command.with("NEW", {job.files[(*shapes)[k].from]}), progress);
      if (!made) return fail(made.error());
      of_files[(*shapes)[k].from] = record = std::move(*made);
    }
    const std::string file = names[k] + ".vtp";
    if (auto written = write_scored(mesh, *model, *scored, record_of_output(record, file), job.out / file); !written)
      return fail(written.error());
  }
  if (subjects.empty())
    return fail(job.files.front().string(),
                report.warnings.empty() ? "holds no shape"
                                        : "gives no shape to score; the first reason: " + report.warnings.front());
  if (!job.out.empty())
    if (auto written = write_score_table(subjects, job.out / "scores.csv"); !written) return fail(written.error());
  if (!job.out.empty()) report.made = {job.out / "scores.csv"};
  const auto& others = model->left_out_distances;
  report.values = {{"subjects", std::move(subjects)},
                   {"training_distances", std::vector<double>(others.begin(), others.end())}};
  return report;
}

}  // namespace

void add_score(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<ScoreJob>();
  CLI::App* verb = add_verb(app, "score", "How far subjects are from a model, which stays as it is");
  verb->add_option(
          "NEW", job->files,
          "Meshes in the model's numbering, cases, studies, label maps to which the model's mean is fitted, or images "
          "with --landmarks; for a joint model folders of cases, cases or studies. What a study flips is flipped")
      ->required();
  verb->add_option("--model", job->model, "The model (.h5, .h5.json)")->required()->check(CLI::ExistingFile);
  add_label_option(*verb, job->label, "Which label of a map");
  add_mask_frame_option(*verb, job->frame);
  auto* landmarks = verb->add_option("--landmarks", job->landmarks,
                                     "NEW are images: the landmarks that were placed in one, or a folder with a file "
                                     "of each one's name; the mean starts there and is drawn to the boundary")
                        ->check(CLI::ExistingPath)
                        ->excludes("--label");
  auto* the_template = verb->add_option("--template", job->the_template,
                                        "The model's template, which says where the landmarks lie on it")
                           ->check(CLI::ExistingFile)
                           ->needs(landmarks);
  landmarks->needs(the_template);
  verb->add_flag("--flip-mirrored", job->flip_mirrored, "Flip shapes that are mirror images of the model's mean");
  verb->add_option("-o,--output", job->out,
                   "Folder for scores.csv and for each mesh (.vtp) with z, z_low and z_high of every vertex");
  verb->callback([job, verb, &asked] {
    job->command = given_command(*verb);
    asked.run = [job](Progress& progress) { return score(*job, progress); };
  });
}

}  // namespace homolog
