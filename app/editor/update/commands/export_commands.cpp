#include "app/editor/update/commands/export_commands.h"

#include <set>
#include <system_error>
#include <utility>

#include "app/editor/update/editing.h"
#include "app/editor/update/file_purposes.h"
#include "app/editor/update/results/write_beside.h"
#include "app/editor/update/status.h"
#include "core/base/pictures/picture_io.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/case/actions/fields.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/parts/rims.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/files/model_files.h"
#include "core/model/shapes/recipe_shapes.h"
#include "core/structures/maps/case_segments.h"
#include "core/structures/maps/map_of_case.h"
#include "core/structures/template_set.h"
#include "core/template_making/template_file.h"
#include "core/volume/dicom/write_dicom_segmentation.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/labels/write_segmentation.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// The case as it is done, at the frame that is shown: an export never takes a running preview.
Document as_done(const Editing& editing) {
  Document document = *editing.shown.snapshot().document;
  document.frame = editing.shown.document().frame;
  return document;
}

void no_mesh_to_export(Editing& editing) {
  add_notice(editing.state, why_no_mesh(editing.state, as_done(editing)), false);
}

/// What a mesh file does not keep that a shape model needs; empty where it keeps all.
std::string lost_in(const fs::path& path) {
  const MeshFormat* format = mesh_format_of(path);
  if (format == nullptr) return {};
  if (!format->keeps_numbers) return std::string(format->name) + " keeps no numbering; use PLY for a shape model.";
  if (!format->has_faces) return std::string(format->name) + " keep the points alone, without faces.";
  return {};
}

/// What a label map of a structure does to it beyond what the mesh says; empty for a closed one.
std::string closed_flat_of(const Structure& structure) {
  const std::string closed = closed_flat(*structure.the_template->topology);
  return closed.empty() ? closed : structure_name(structure) + " " + closed + ".";
}

/// The image that a label map lies on: where it is, and which series of a folder.
struct SourceOfMap {
  std::string path, series_uid;
};

/// Writes a label map by its name: one of DICOM refers to the series that the image is.
Result<void> write_map(const VolumeRead& map, const fs::path& to, const SourceOfMap& image, Progress& progress) {
  if (lower_case(to.extension().string()) != ".dcm") return write_segmentation(map, to, &progress);
  const auto written = write_dicom_segmentation(map, to, image.path, &progress, image.series_uid);
  return written ? Result<void>() : fail(written.error());
}

/// Writes a label map, or a folder of masks, as the case has it.
Result<void> write_mended(const Document& document, const fs::path& from, const KeptMapFit& fit, const fs::path& to,
                          Progress& progress) {
  constexpr double reading = 0.4, drawing = 0.7;
  progress.part(0, reading);
  VolumeReadOptions options;
  options.progress = &progress;
  auto read = read_labels(from, options);
  if (!read) return fail(read.error());
  progress.part(reading, drawing);
  const auto map = map_of_case(document, std::move(*read), fit, progress);
  if (!map) return fail(map.error().subject.empty() ? from.string() : map.error().subject, map.error().what);
  progress.part(drawing, 1);
  if (!fs::is_directory(from)) return write_segmentation(*map, to, &progress);
  const auto folder = ResultFolder::make(to);
  return folder ? write_single_masks(*map, to, from, &progress) : fail(folder.error());
}

/// Which structures have the voxels within their meshes, as a sentence; empty: none.
std::string drawn_in_words(const std::vector<std::string>& names) {
  constexpr std::size_t most = 4;
  if (names.empty()) return {};
  return "By their meshes: " +
         (names.size() > most ? std::to_string(names.size()) + " structures" : listed(names, ", ")) + ".";
}

/// The values of the shown label map.
SegmentValues values_of(const ShownLabels& labels) {
  SegmentValues values;
  for (std::size_t layer = 0; layer < labels.layers.size(); ++layer)
    for (const auto& [value, name] : labels.layers[layer].names)
      values.emplace(std::pair(layer, lower_case(name)), value);
  return values;
}

}  // namespace

void ExportMesh::spell(Fields& line) {
  FileCommand::spell(line);
  line.optional("all_frames", all_frames, all_frames);
}
void ExportMesh::run(Editing& editing) const {
  const Document document = as_done(editing);
  const Structure* structure = active_structure(editing.state, document);
  const auto write = [&](int frame, const fs::path& file) {
    write_beside(
        editing, file,
        [mesh = to_mesh_file({*structure, *structure->shape(frame), frame}, document.scan.frames() > 1)](
            const auto& to, Progress&) { return write_mesh_file(mesh, to); },
        lost_in(path));
  };
  if (all_frames && has_several_meshes(structure)) {
    for (const auto& [frame, shape] : structure->shapes)
      write(frame, file_of_frame(FilePurpose::export_mesh, path, frame, document.scan.frames() - 1));
    return;
  }
  if (!active_shape(editing.state, document)) return no_mesh_to_export(editing);
  write(document.frame, path);
}

void ExportLabelMap::spell(Fields& line) {
  FileCommand::spell(line);
  line.optional("all_frames", all_frames, all_frames);
}
void ExportLabelMap::run(Editing& editing) const {
  const Document document = as_done(editing);
  const Structure* structure = active_structure(editing.state, document);
  const bool all = all_frames && has_several_meshes(structure);
  if (!all && !active_shape(editing.state, document)) return no_mesh_to_export(editing);
  if (!document.scan.image)
    return add_notice(editing.state, "A label map needs the voxels of an image. Open the image of this mesh first.");
  const auto write = [&](int frame, const fs::path& file) {
    write_beside(
        editing, file,
        [mesh = ShapeView{*structure, *structure->shape(frame), frame}.mesh(), grid = document.scan.image->geometry,
         name = structure_name(*structure), image = SourceOfMap{document.scan.source, document.scan.image->series_uid}](
            const fs::path& to, Progress& progress) {
          VolumeRead map;
          map.volume = label_map(mesh, grid, 1);
          if (lower_case(to.extension().string()) != ".dcm") return write_volume(map.volume, to, &progress);
          map.segmentation.add({.name = name, .value = 1});
          return write_map(map, to, image, progress);
        },
        closed_flat_of(*structure));
  };
  if (!all) return write(document.frame, path);
  for (const auto& [frame, shape] : structure->shapes)
    write(frame, file_of_frame(FilePurpose::export_label_map, path, frame, document.scan.frames() - 1));
}

void ExportStructuresMap::run(Editing& editing) const {
  const Document document = as_done(editing);
  if (!document.scan.image)
    return add_notice(editing.state, "A label map needs the voxels of an image. Open the image of this case first.");
  auto meshes = segments_of(document, values_of(editing.shown.labels()));
  if (meshes.empty()) return no_mesh_to_export(editing);
  std::string remark;
  for (const auto& one : document.structures)
    if (const std::string closed = closed_flat_of(*one); one->shape(document.frame) != nullptr && !closed.empty())
      remark += (remark.empty() ? "" : " ") + closed;
  write_beside(
      editing, path,
      [meshes = std::move(meshes), grid = document.scan.image->geometry,
       image = SourceOfMap{document.scan.source, document.scan.image->series_uid}](const fs::path& to,
                                                                                   Progress& progress) {
        const MapOfMeshes made = keeps_layers(to) ? map_in_layers(meshes, grid) : map_of_meshes(meshes, grid);
        return write_map(made.map, to, image, progress);
      },
      std::move(remark));
}

void ExportMendedMap::run(Editing& editing) const {
  const ShownLabels& labels = editing.shown.labels();
  if (labels.file.empty())
    return add_notice(editing.state, "Open the label map of this case first (Place, Open a label map).", false);
  std::error_code ignored;
  if (fs::equivalent(path, labels.file, ignored))
    return add_notice(editing.state,
                      path.filename().string() + " is the map that was read, and stays as it is. Give another name.");
  const auto& kept = editing.shown.snapshot().kept.map_fit;
  const Document document = as_done(editing);
  const KeptMapFit fit = kept ? *kept : KeptMapFit();
  const auto drawn = drawn_by_mesh(document, fit);
  write_beside(
      editing, path,
      [document, from = labels.file, fit](const fs::path& to, Progress& progress) {
        return write_mended(document, from, fit, to, progress);
      },
      drawn_in_words(drawn));
}

void ExportStructuresMeshes::run(Editing& editing) const {
  const Document document = as_done(editing);
  std::vector<std::pair<std::string, MeshFile>> files;
  std::set<std::string> taken;
  for (const auto& one : document.structures) {
    const Shape* shape = one->shape(document.frame);
    if (shape == nullptr) continue;
    const std::string own = file_name_of_structure(structure_name(*one));
    std::string name = own;
    for (int again = 2; !taken.insert(lower_case(name)).second; ++again) name = own + "-" + std::to_string(again);
    files.emplace_back(name + ".ply", to_mesh_file({*one, *shape, document.frame}, document.scan.frames() > 1));
  }
  if (files.empty()) return no_mesh_to_export(editing);
  write_beside(editing, path, [files = std::move(files)](const fs::path& to, Progress& progress) -> Result<void> {
    const auto folder = ResultFolder::make(to);
    if (!folder) return fail(folder.error());
    for (std::size_t k = 0; k < files.size() && !progress.cancelled(); ++k) {
      if (auto written = write_mesh_file(files[k].second, to / files[k].first); !written) return written;
      progress.report(static_cast<double>(k + 1) / static_cast<double>(files.size()));
    }
    if (progress.cancelled()) return fail(to.string(), "was stopped; the meshes written so far are kept");
    return {};
  });
}

void ExportLandmarks::run(Editing& editing) const {
  const Document document = as_done(editing);
  const auto shown = active_shape(editing.state, document);
  if (!shown) return no_mesh_to_export(editing);
  std::vector<Landmark> placed;
  for (const auto& [name, position] : shown->shape.landmarks) placed.push_back({name, position});
  write_beside(editing, path, [placed](const auto& to, Progress&) { return write_landmarks(placed, to); });
}

void ExportTemplateLandmarks::run(Editing& editing) const {
  if (lacks_template(editing)) return;
  write_beside(editing, path,
               [landmarks = active_structure(editing.state, as_done(editing))->the_template->landmarks](
                   const auto& to, Progress&) { return write_landmarks(landmarks, to); });
}

void ExportPicture::run(Editing& editing) const {
  PictureOptions options = editing.state.saving.picture;
  if (editing.state.models.shown)
    options.view.reset();
  else
    options.study.reset();
  write_picture_beside(editing, path, editing.pictures.picture(options));
}

void ExportVolumes::run(Editing& editing) const {
  const Document document = as_done(editing);
  const Structure* structure = active_structure(editing.state, document);
  if (structure == nullptr) return no_mesh_to_export(editing);
  const double frame_seconds = document.scan.image ? document.scan.image->frame_seconds : 0;
  write_beside(editing, path,
               [table = volume_table(volume_curve(document, *structure), frame_seconds)](const auto& to, Progress&) {
                 return write_whole_file(to, table);
               });
}

void ExportMeasurements::run(Editing& editing) const {
  const auto document = std::make_shared<const Document>(as_done(editing));
  if (!active_shape(editing.state, *document)) return no_mesh_to_export(editing);
  const auto& recipe = editing.state.measurements.recipe;
  if (recipe == nullptr) return add_notice(editing.state, "Choose a recipe first: it says what to measure.");
  const std::string name = case_name(editing.shown.snapshot().file, *document);
  write_beside(editing, path, [document, recipe, name, of = editing.state.look.structure](const auto& to, Progress&) {
    return write_whole_file(to, "name" + measurement_columns(*recipe) + '\n' + csv_field(name) +
                                    measurement_cells(measure(*recipe, measured_shape(*document, of))) + '\n');
  });
}

}  // namespace homolog
