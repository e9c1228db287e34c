#include "app/verbs/model/score_shapes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/input_folders.h"
#include "app/verbs/read_image.h"
#include "app/verbs/verbs.h"
#include "core/adapt/image/fit_to_image.h"
#include "core/adapt/labels/label_fit.h"
#include "core/catalogue/catalogue.h"
#include "core/model/alignment/numbering.h"
#include "core/model/files/statismo.h"
#include "core/model/joint_models/structure_files.h"
#include "core/model/measures/score.h"
#include "core/model/model_prior.h"
#include "core/model/shapes/shape_files.h"
#include "core/model/shapes/study.h"
#include "core/model/training_set.h"
#include "core/session/case_file.h"
#include "core/template/template.h"
#include "core/volume/labels/label_likeness.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// What label maps are fitted with: the model's mean, and the shapes that the model allows, of which the nearest comes
/// first. So the fit lies in the model's correspondence as far as the map leaves it open.
struct MapScoring {
  std::shared_ptr<const Template> mean;
  std::shared_ptr<const AllowedShapes> allowed;  ///< null: of a model of several structures
};

/// Fits the model's mean to a label map, as `fit --model` does with one case.
Result<NewShape> shape_of_map(const NewShapes& asked, const MapScoring& with, const fs::path& path,
                              std::vector<std::string>& warnings, Progress& progress) {
  const std::shared_ptr<const Template>& mean = with.mean;
  auto mask = read_mask(path, asked.label, {asked.frame, {}, {}, false, mean->faced.has_value()}, progress);
  if (!mask) {
    const auto read = read_volume(path);
    if (read && !holds_labels(read->volume) && asked.label.empty())
      return fail(path.string(), "is an image and no label map; give --landmarks and --template with images");
    return fail(mask.error());
  }
  warnings.insert(warnings.end(), mask->warnings.begin(), mask->warnings.end());
  FitOptions options;
  options.allowed = with.allowed;
  options.progress = &progress;
  const auto fitted = fit_to_label(*mean, {mask->volume, mask->label, mask->frame, mask->segmentation}, {}, options);
  if (!fitted) return fail(path.string(), mask->named(fitted.error().what));
  for (const std::string& warning : fitted->boundary.warnings)
    warnings.push_back(path.string() + ": " + mask->named(warning));
  NewShape shape{path.string(), {}, {}};
  shape.mesh.points = fitted->fit.mesh.points;
  shape.mesh.triangles = fitted->fit.mesh.topology;
  shape.mesh.doubt_mm = fitted->fit.doubt_mm;
  shape.beyond_share = fitted->judgement.beyond_share;
  if (fitted->judgement.doubtful) shape.doubt = "the fit is doubtful; look at it with fit";
  return shape;
}

/// What the images are drawn with: the template that has the landmarks, and the shapes that the model allows.
struct ImageScoring {
  std::shared_ptr<const Template> the_template;
  AllowedShapes allowed;
};

Result<ImageScoring> image_scoring(const NewShapes& asked, const ShapeModel& model) {
  auto the_template = load_template(asked.the_template.string());
  if (!the_template) return fail(the_template.error());
  auto allowed = allowed_by(model, **the_template);
  if (!allowed) return fail(asked.model.string(), allowed.error().what);
  return ImageScoring{std::move(*the_template), std::move(*allowed)};
}

/// Draws the model's mean to the boundary that an image shows, from where the landmarks place it, as `fit --image
/// --landmarks --model` does.
Result<NewShape> shape_of_image(const NewShapes& asked, const ImageScoring& with, const fs::path& path,
                                std::vector<std::string>& warnings, Progress& progress) {
  const auto landmarks =
      read_case_landmarks({asked.landmarks, asked.the_template.string(), false}, *with.the_template, path);
  if (!landmarks) return fail(landmarks.error());
  const auto placement = placement_by_landmarks(*with.the_template, landmarks->places);
  if (!placement) return fail(path.string(), placement.error().what);
  const int frame = asked.frame.value_or(0);
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
  shape.mesh.triangles = with.the_template->topology;
  return shape;
}

/// The structures of a joint model in one case, joined. `name`: what the case is called.
Result<NewShape> joined_shape(const ShapeModel& model, const CaseFiles& files, const std::string& name) {
  NewShape shape{name, {}, {}};
  shape.mesh.points.resize(model.mean.size() / 3, 3);
  shape.mesh.triangles = model.topology;
  VertexScalars doubt_mm(shape.mesh.points.rows());
  bool all_doubts = true;
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
    all_doubts = all_doubts && read->doubt_mm && read->doubt_mm->size() == part.vertices;
    if (all_doubts) doubt_mm.segment(part.first_vertex, part.vertices) = *read->doubt_mm;
  }
  if (all_doubts) shape.mesh.doubt_mm = std::move(doubt_mm);
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

Result<MapScoring> map_scoring(const NewShapes& asked, const ShapeModel& model) {
  MeshFile mean;
  mean.points = points_of(model.mean);
  mean.triangles = model.topology;
  if (model.faced) mean.comments.push_back(faced_comment(*model.faced));
  auto made = make_template(std::move(mean), "the model's mean");
  if (!made) return fail(asked.model.string(), "has a mean that is no surface, so nothing can be fitted");
  MapScoring with{std::move(*made), nullptr};
  if (auto allowed = allowed_by(model, *with.mean); allowed && model.parts.empty())
    with.allowed = std::make_shared<const AllowedShapes>(std::move(*allowed));
  return with;
}

bool is_volume_file(const fs::path& path) {
  std::error_code error;
  return !fs::is_directory(path, error) && !is_mesh_name(path) && looks_like_volume(path);
}

/// What looks wrong about a shape beside the model's mean, a sentence each. Flips a mirror image where that is asked.
std::vector<std::string> check_against_mean(const NewShapes& asked, const ShapeModel& model, NewShape& shape) {
  std::vector<std::string> found;
  const Points mean = points_of(model.mean);
  Points& points = shape.mesh.points;
  if (points.rows() != mean.rows() || model.alignment == Alignment::none) return found;
  if (looks_mirrored(mean, points)) {
    if (asked.flip_mirrored) points.col(0) *= -1;
    found.push_back(shape.name + ": looks like a mirror image of the model's mean (left and right exchanged); " +
                    (asked.flip_mirrored ? "flipped" : "use --flip-mirrored to flip it"));
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

}  // namespace

NewShapes with_maps_opened(NewShapes asked) {
  std::vector<fs::path> files;
  for (const fs::path& file : asked.files) {
    std::error_code error;
    const bool is_folder = fs::is_directory(file, error);
    const auto maps = is_folder && !shape_sources({file}) ? volumes_in(file) : std::vector<fs::path>();
    const auto kept = asked.landmarks.empty() ? label_maps_among(maps) : maps;
    files.insert(files.end(), kept.begin(), kept.end());
    if (kept.empty()) files.push_back(file);
  }
  asked.files = std::move(files);
  return asked;
}

Result<std::vector<NewShape>> read_new_shapes(const NewShapes& asked, const ShapeModel& model,
                                              std::vector<std::string>& warnings, Progress& progress) {
  if ((!asked.label.empty() || asked.frame) && std::ranges::none_of(asked.files, is_volume_file))
    return fail(asked.files.front().string(), "is no label map, so --label and --frame have no effect; leave them out");
  std::vector<NewShape> shapes;
  std::size_t from = 0;
  const auto add = [&](Result<NewShape> shape) {
    if (!shape) return warnings.push_back(shape.error().sentence());
    if (auto same = check_faces(model, shape->mesh); !same)
      return warnings.push_back(shape->name + ": " + same.error().what);
    shape->from = from;
    for (std::string& sentence : check_against_mean(asked, model, *shape)) warnings.push_back(std::move(sentence));
    shapes.push_back(std::move(*shape));
  };
  std::optional<MapScoring> of_maps;
  std::optional<ImageScoring> of_images;
  if (!asked.landmarks.empty()) {
    if (!model.parts.empty())
      return fail(asked.model.string(),
                  "is of several structures, whose places no landmarks give; score a case's folder");
    auto made = image_scoring(asked, model);
    if (!made) return fail(made.error());
    of_images = std::move(*made);
  }
  std::error_code error;
  const auto count = static_cast<double>(asked.files.size());
  for (std::size_t k = 0; k < asked.files.size(); ++k) {
    const fs::path& path = asked.files[k];
    from = k;
    Progress own(progress, 1 / count);
    if (progress.cancelled()) return fail("", "the scores were cancelled");
    if (!model.parts.empty() && (fs::is_directory(path, error) || is_case_file(path) || is_study_file(path))) {
      for (auto& shape : joined_shapes(model, path)) add(std::move(shape));
    } else if (is_volume_file(path)) {
      if (of_images) {
        add(shape_of_image(asked, *of_images, path, warnings, own));
        continue;
      }
      if (!of_maps) {
        auto made = map_scoring(asked, model);
        if (!made) return fail(made.error());
        of_maps = std::move(*made);
      }
      add(shape_of_map(asked, *of_maps, path, warnings, own));
    } else {
      const auto sources = shape_sources({path});
      if (!sources) {
        add(fail(sources.error()));
        continue;
      }
      const auto take = [&](ReadShape shape) -> Result<void> {
        add(NewShape{std::move(shape.name), *shape.mesh, std::move(shape.doubt), k});
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

}  // namespace homolog
