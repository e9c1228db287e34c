#include "app/verbs/describe.h"

#include <algorithm>

#include "app/verbs/mending_report.h"
#include "app/verbs/model/training.h"
#include "app/verbs/read_image.h"
#include "core/base/pictures/colour.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/curve_io.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/files/slicer_curves.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/parts/rims.h"
#include "core/mesh/repair/inside_out.h"
#include "core/model/files/statismo.h"
#include "core/session/case_file.h"
#include "core/volume/contours.h"
#include "core/volume/labels/label_likeness.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace {

Result<Report> describe_case(const std::filesystem::path& path, Progress* progress) {
  ReplayOptions options;
  options.progress = progress;
  auto read = read_case(path, options);
  if (!read) return fail(read.error());
  const Document& document = read->session.document();
  Report report;
  report.warnings = read->warnings;
  Json& values = report.values;
  values["kind"] = "case";
  values["volume"] = document.scan.source;
  const Structure* structure = document.structure();
  values["template"] = structure != nullptr ? structure->the_template->source : "";
  values["vertices"] = structure != nullptr ? structure->the_template->topology->vertices() : 0;
  values["strokes"] = read->session.strokes();
  values["frame"] = document.frame;
  Json frames = Json::array();
  if (structure != nullptr)
    for (const auto& [frame, shape] : structure->shapes) frames.push_back(frame);
  values["frames_with_mesh"] = std::move(frames);
  return report;
}

Result<Report> describe_model(const std::filesystem::path& path) {
  const auto model = read_model(path);
  if (!model) return fail(model.error());
  const Box box = bounds_of(points_of(model->mean));
  Json names = Json::array();
  for (const std::string& name : model->names) names.push_back(name);
  Report report{{{"kind", "model"},
                 {"vertices", model->mean.size() / 3},
                 {"faces", model->topology ? model->topology->triangles().rows() : 0},
                 {"modes", model->modes()},
                 {"variances", std::vector<double>(model->variances.begin(), model->variances.end())},
                 {"noise_variance", model->noise_variance},
                 {"bounds_mm", Json::array({json_of(box.min()), json_of(box.max())})},
                 {"shapes", std::move(names)}},
                {}};
  if (model->faced) report.values[model->faced->kept ? "facing" : "open_at"] = model->faced->labels;
  if (!model->poses) return report;
  report.values["alignment"] = model->poses->apart ? "each" : "common";
  report.values["structures"] = json_of(model->parts, *model->poses);
  report.values["pose_variances"] = std::vector<double>(model->poses->variances.begin(), model->poses->variances.end());
  report.values["completed"] = json_of(model->completed, model->names, model->parts);
  return report;
}

/// Points alone do not show that some are missing.
std::string cut_off(const MeshFile& file) {
  return "ends without a line break after " + std::to_string(file.points.rows()) +
         " points, so it may have been cut off; add a line break at its end if it is whole, or copy it again";
}

}  // namespace

std::vector<std::string> about(const std::filesystem::path& path, std::vector<std::string> warnings) {
  const std::string subject = path.string() + ": ";
  for (std::string& warning : warnings)
    if (!warning.starts_with(subject)) warning.insert(0, subject);
  return warnings;
}

std::vector<std::string> mesh_warnings(const std::filesystem::path& path, const MeshFile& file, const Mesh& mesh) {
  std::vector<std::string> warnings = file.warnings;
  if (auto inward = inside_out(mesh)) warnings.push_back(std::move(*inward));
  if (auto closed = closed_flat(*mesh.topology); !closed.empty()) warnings.push_back(std::move(closed));
  return about(path, std::move(warnings));
}

Meeting meeting_of(const std::filesystem::path& path, const Points& points) {
  return {path.string(), bounds_of(points).diagonal().norm()};
}

Result<void> check_folder_of(const std::filesystem::path& to_write) {
  std::error_code ignored;
  const std::filesystem::path folder = to_write.parent_path();
  if (folder.empty() || std::filesystem::is_directory(folder, ignored)) return {};
  return fail(to_write.string(), "cannot be written, because its folder is not there; make it, or name another");
}

Result<ChosenStructure> choose_structure(const Document& document, const std::filesystem::path& file,
                                         const std::string& name) {
  std::vector<std::string> names;
  for (const auto& one : document.structures) names.push_back(one->name.empty() ? one->id : one->name);
  if (name.empty()) {
    if (names.size() < 2) return ChosenStructure{};
    return ChosenStructure{{},
                           file.string() + ": has " + listed(names, ", ") + ", of which the first is taken; name " +
                               "another one with --structure"};
  }
  auto chosen = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  for (std::size_t k = 0; k < names.size() && chosen == names.size(); ++k)
    if (document.structures[k]->id == name) chosen = k;
  if (chosen == names.size())
    return fail(file.string(), "has no structure \"" + excerpt(name) + "\"; it has " + listed(names, ", "));
  return ChosenStructure{chosen == 0 ? std::string() : document.structures[chosen]->id, {}};
}

Json json_of(const Vec3& p) {
  return Json::array({p[0], p[1], p[2]});
}

Json json_of(const SurfaceDistance& distance) {
  return {{"mean", distance.mean_mm}, {"p95", distance.p95_mm}, {"max", distance.max_mm}};
}

Json describe(const Mesh& mesh) {
  const MeshQuality quality = mesh_quality(mesh);
  const Box box = bounds_of(mesh.points);
  Json rims = Json::array();
  for (const Rim& rim : mesh.topology->rims())
    rims.push_back({{"vertices", rim.size()}, {"length_mm", rim_length_mm(rim, mesh.points)}});
  Json values = {
      {"kind", "mesh"},
      {"vertices", mesh.topology->vertices()},
      {"faces", mesh.topology->triangles().rows()},
      {"components", mesh.topology->components()},
      {"genus", mesh.topology->genus()},
      {"closed", mesh.topology->closed()},
      {"rims", std::move(rims)},
      {"oriented", true},  // Topology holds no other
      {"bounds_mm", Json::array({json_of(box.min()), json_of(box.max())})},
      {"edge_length_mm",
       {{"mean", quality.edge_mean}, {"cv", quality.edge_cv}, {"min", quality.edge_min}, {"max", quality.edge_max}}},
      {"min_angle_deg", quality.min_angle_deg},
      {"valence", {{"min", quality.valence_min}, {"max", quality.valence_max}, {"six", quality.regular_share}}},
      {"self_intersections", quality.self_intersections},
      {"self_intersections_all", quality.all_intersections},
      {"area_mm2", quality.area_mm2},
      {"volume_ml", quality.volume_ml}};
  if (!mesh.topology->closed()) values["volume_capped_ml"] = quality.volume_ml;
  return values;
}

Result<Report> describe(const MeshFile& file, const std::filesystem::path& path) {
  Report report;
  report.warnings = about(path, file.warnings);
  if (file.triangles.rows() == 0) {
    if (file.may_be_cut) return fail(path.string(), cut_off(file));
    const Box box = bounds_of(file.points);
    report.values = {{"kind", "particles"},
                     {"vertices", file.points.rows()},
                     {"bounds_mm", Json::array({json_of(box.min()), json_of(box.max())})}};
    return report;
  }
  auto topology = Topology::make(file.points.rows(), file.triangles);
  if (!topology) return fail(path.string(), topology.error().what + file.likely_cause);
  report.values = describe(Mesh{*topology, file.points});
  if (report.values["self_intersections_all"] == false)
    report.warnings.push_back(
        path.string() +
        ": so many of its faces cut or surround each other that not all were compared; the count of "
        "self_intersections is only a part; remove what is there twice");
  if (file.stiffness || !file.landmarks.empty()) report.values["kind"] = "template";
  if (file.stiffness) {
    report.values["stiffness"] = {{"base", file.stiffness_base},
                                  {"factor_min", file.stiffness->minCoeff()},
                                  {"factor_max", file.stiffness->maxCoeff()}};
  }
  for (const Region& region : file.regions.list)
    report.values["regions"].push_back(
        {{"name", region.name}, {"factor", region.factor}, {"colour", hex_of(region.colour)}});
  Json names = Json::array();
  for (const Landmark& landmark : file.landmarks) names.push_back(landmark.name);
  if (!names.empty()) report.values["landmarks"] = std::move(names);
  return report;
}

namespace {

/// With what repair-mesh would mend. Errors: no sound surface; the sentence says what would be mended too.
Result<Report> describe_surface(const std::filesystem::path& path) {
  const auto file = read_mesh_to_mend(path);
  if (!file) return fail(file.error());
  const auto finite = read_mesh_file(path);
  auto report = finite ? describe(*finite, path) : fail(finite.error());
  if (file->triangles.rows() == 0) return report;
  const auto repair = repaired(*file, {small_rim_share});
  if (!repair || !repair->mended.any()) return report;
  const std::string would_mend = "repair-mesh would mend it: " + repair->mended.words();
  if (!report) return fail(report.error().subject, report.error().what + " (" + would_mend + ")");
  report->values["would_mend"] = json_of(repair->mended);
  report->warnings.push_back(path.string() + ": " + would_mend);
  return report;
}

}  // namespace

Json describe(const Volume& volume) {
  const VolumeGeometry& g = volume.geometry;
  Json direction = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) direction.push_back(g.direction(row, column));
  }
  Json values{{"kind", "volume"},
              {"dims", g.dims},
              {"voxel", voxel_type_name(volume.data)},
              {"spacing_mm", json_of(g.spacing_mm)},
              {"origin_mm", json_of(g.origin_mm)},
              {"direction", std::move(direction)},
              {"frames", volume.frames},
              {"range", Json::array({volume.range_min, volume.range_max})}};
  if (volume.frame_seconds > 0) values["frame_seconds"] = volume.frame_seconds;
  if (!volume.modality.empty()) values["modality"] = volume.modality;
  if (!volume.series_uid.empty()) values["series"] = Json::array({volume.series_uid});
  return values;
}

namespace {

/// The labels of a layer's frame. `layer`: empty where the volume holds all layers.
void describe_labels(const Volume& map, const Segmentation& known, std::optional<std::size_t> layer, int frame,
                     Json& labels) {
  for (const auto& [value, voxels] : labels_of(map, frame)) {
    const Segment* segment = layer ? known.find(value, *layer) : known.find(value);
    const bool named = segment != nullptr && !segment->name.empty(), coloured = segment != nullptr && segment->colour;
    labels.push_back({{"value", value},
                      {"name", named ? Json(segment->name) : Json()},
                      {"voxels", voxels},
                      {"volume_ml", static_cast<double>(voxels) * map.geometry.voxel_volume_mm3() / 1000},
                      {"layer", layer                ? *layer
                                : segment != nullptr ? segment->layer
                                                     : 0},
                      {"colour", coloured ? Json(hex_of(*segment->colour)) : Json()}});
  }
}

/// The segments of a file that have no voxels: its description is all that there is of them.
void describe_empty_segments(const Segmentation& known, Json& labels) {
  for (const Segment& segment : known.segments)
    if (std::none_of(labels.begin(), labels.end(),
                     [&](const Json& one) { return one["value"] == segment.value && one["layer"] == segment.layer; }))
      labels.push_back({{"value", segment.value},
                        {"name", segment.name.empty() ? Json() : Json(segment.name)},
                        {"voxels", 0},
                        {"volume_ml", 0.0},
                        {"layer", segment.layer},
                        {"colour", segment.colour ? Json(hex_of(*segment.colour)) : Json()}});
}

Result<Report> describe_contours(const std::filesystem::path& path) {
  const auto contours = read_curves(path);
  if (!contours) return fail(contours.error());
  Json rois = Json::array();
  for (const ContourRoi& roi : contours->rois) {
    const auto apart = roi.planes_apart_mm();
    rois.push_back({{"name", roi.name},
                    {"number", roi.number},
                    {"type", roi.type.empty() ? Json() : Json(roi.type)},
                    {"colour", roi.colour ? Json(hex_of(*roi.colour)) : Json()},
                    {"contours", roi.contours.size()},
                    {"points", roi.all_points()},
                    {"planes", roi.planes()},
                    {"planes_apart_mm", apart ? Json(*apart) : Json()}});
  }
  return Report{{{"kind", "contours"}, {"series", contours->referenced.series}, {"rois", std::move(rois)}},
                contours->warnings};
}

/// Whether a landmark file's points are all of curves that somebody drew.
bool holds_curves(const std::filesystem::path& path, const Result<std::vector<Landmark>>& landmarks) {
  const auto curves = read_slicer_curves(path);
  if (!curves) return false;
  std::size_t points = 0;
  for (const SlicerCurve& curve : *curves) points += curve.points.size();
  return points > 0 && (!landmarks || landmarks->size() == points);
}

}  // namespace

Result<Report> describe_file(const std::filesystem::path& path, const VolumeReadOptions& options,
                             std::optional<int> frame) {
  const bool no_volume = is_built_in(path.string()) || is_case_file(path) || is_model_name(path) ||
                         is_mesh_name(path) || is_landmark_name(path) || holds_contours(path);
  if (frame && no_volume) return fail(path.string(), "is no label map, so --frame has no effect; leave it out");
  if (is_built_in(path.string())) {
    const auto mesh = load_mesh(path.string());
    return mesh ? describe(*mesh, path) : fail(mesh.error());
  }
  if (is_case_file(path)) return describe_case(path, options.progress);
  if (is_model_name(path)) return describe_model(path);
  if (is_mesh_name(path)) return describe_surface(path);
  if (is_landmark_name(path)) {
    const auto landmarks = read_landmarks(path);
    if (holds_curves(path, landmarks)) return describe_contours(path);
    if (!landmarks) return fail(landmarks.error());
    Report report;
    report.values = {{"kind", "landmarks"}, {"landmarks", Json::object()}};
    for (const Landmark& landmark : *landmarks) report.values["landmarks"][landmark.name] = json_of(landmark.position);
    return report;
  }
  if (holds_contours(path)) return describe_contours(path);
  auto read = read_volume(path, options);
  if (!read) return fail(read.error());
  Report report{describe(read->volume), read->warnings};
  report_resampled(*read, report.values);
  if (!read->other_layers.empty()) report.values["layers"] = read->other_layers.size() + 1;
  const Segmentation& known = read->segmentation;
  const bool is_map = !known.segments.empty() || holds_labels(read->volume);
  if (frame && !is_map) return fail(path.string(), "is no label map, so --frame has no effect; leave it out");
  if (frame && *frame >= read->volume.frames)
    return fail(path.string(),
                "has " + std::to_string(read->volume.frames) + " frames, counted from 0; choose --frame among them");
  if (is_map) {
    const auto& others = read->other_layers;
    Json labels = Json::array();
    describe_labels(read->volume, known, others.empty() ? std::optional<std::size_t>() : 0, frame.value_or(0), labels);
    for (std::size_t k = 0; k < others.size(); ++k) describe_labels(others[k], known, k + 1, frame.value_or(0), labels);
    if (read->segments_are_own) describe_empty_segments(known, labels);
    report.values["labels"] = std::move(labels);
  }
  return report;
}

}  // namespace homolog
