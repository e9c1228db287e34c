#include "app/editor/update/commands/file_commands.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <system_error>
#include <utility>

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/editing.h"
#include "app/editor/update/file_purposes.h"
#include "app/editor/update/results/imports.h"
#include "app/editor/update/status.h"
#include "core/base/files.h"
#include "core/base/paths.h"
#include "core/base/picture_io.h"
#include "core/base/text.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/label_map.h"
#include "core/mesh/landmark_io.h"
#include "core/mesh/rims.h"
#include "core/mesh/slicer_curves.h"
#include "core/model/model_files.h"
#include "core/model/recipe_shapes.h"
#include "core/session/unsaved_cases.h"
#include "core/structures/set_map.h"
#include "core/structures/template_set.h"
#include "core/template_making/template_file.h"
#include "core/volume/write_segmentation.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// The case as it is done, at the frame that is shown: an export never takes a running preview.
Document as_done(const Editing& editing) {
  Document document = *editing.shown.snapshot().document;
  document.frame = editing.shown.document().frame;
  return document;
}

/// Says so where the case has no template.
bool lacks_template(Editing& editing) {
  const Document& document = *editing.shown.snapshot().document;
  if (!document.structures.empty()) return false;
  add_notice(editing.state, why_no_mesh(editing.state, document), false);
  return true;
}

void no_mesh_to_export(Editing& editing) {
  add_notice(editing.state, "This frame has no mesh yet. Start from previous (Cine) copies one.", false);
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

/// The structures as they go into a label map: each with the value that the shown map gives its name, else with one
/// that is free.
std::vector<MeshOfSegment> segments_of(const Document& document, const ShownLabels& labels) {
  std::map<std::pair<std::size_t, std::string>, int> values;  // by layer and name
  std::set<int> taken;
  for (std::size_t layer = 0; layer < labels.layers.size(); ++layer)
    for (const auto& [value, name] : labels.layers[layer].names)
      values.emplace(std::pair(layer, lower_case(name)), value);
  const auto known_value = [&](const Structure& one) {
    const std::size_t layer = labels.layers.size() > 1 ? static_cast<std::size_t>(one.layer) : 0;
    return values.find({layer, lower_case(structure_name(one))});
  };
  for (const auto& one : document.structures)
    if (const auto known = known_value(*one); known != values.end()) taken.insert(known->second);
  std::vector<MeshOfSegment> meshes;
  for (const auto& one : document.structures) {
    const Shape* shape = one->shape(document.frame);
    if (shape == nullptr) continue;
    Segment segment;
    segment.name = structure_name(*one);
    segment.layer = static_cast<std::size_t>(one->layer);
    segment.colour = one->colour.value_or(colour_by_name(segment.name));
    if (const auto known = known_value(*one); known != values.end()) {
      segment.value = known->second;
      values.erase(known);
    } else {
      for (segment.value = 1; taken.contains(segment.value);) ++segment.value;
      taken.insert(segment.value);
    }
    meshes.push_back({std::move(segment), {one->the_template->topology, *shape->points}});
  }
  return meshes;
}

/// Says so where there is nothing to save.
bool nothing_to_save(Editing& editing) {
  const Document& document = editing.shown.document();
  if (document.scan.image || !document.structures.empty()) return false;
  add_notice(editing.state, "There is nothing to save yet. Open an image or a template first.");
  return true;
}

}  // namespace

void OpenFiles::spell(Fields& line) {
  line.member("paths", paths);
}
void OpenFiles::run(Editing& editing) const {
  for (const auto& path : paths)
    if (is_study_file(path)) {
      editing.out.send(ShowModels{true});
      return editing.out.send(OpenStudy{{path}});
    }
  // A template set is chosen, whatever else is opened beside it.
  if (const auto set = std::ranges::find_if(paths, is_template_set); set != paths.end()) {
    std::vector<fs::path> others = paths;
    std::erase(others, *set);
    editing.state.wanted_section = structures_section;
    ++editing.state.section_wanted;
    editing.out.send(ChooseSet{absolute_path(*set).string()});
    return others.empty() ? void() : editing.out.send(OpenFiles{std::move(others)});
  }
  // Dropped on the Models mode, all else becomes a case of the study.
  if (editing.state.models.shown) return editing.out.send(AddCases{paths});
  // Points alone are landmarks.
  const bool points = paths.size() == 1 && lower_case(paths.front().string()).ends_with(".mrk.json") &&
                      !read_slicer_curves(paths.front());
  if (points && editing.shape()) return editing.out.send(ImportLandmarks{{paths.front()}});
  auto request = sort_files(paths);
  if (!request) return add_notice(editing.state, request.error().sentence());
  std::error_code ignored;
  if (!request->case_file.empty() && fs::equivalent(request->case_file, editing.shown.snapshot().file, ignored))
    return add_notice(editing.state, request->case_file.filename().string() + " is open already.", false);
  request->beside = editing.shown.document().scan.image;
  editing.out.send(OpenRequested{std::move(*request)});
}

void OpenRequested::spell(Fields& line) {
  const auto named = [&](const char* name, auto& value) { line.optional(name, value, !value.empty()); };
  named("case_file", request.case_file);
  named("volume", request.volume_source);
  named("other_volume", request.other_source);
  named("series", request.volume_options.series_uid);
  line.optional("stack_spacing_mm", request.volume_options.stack_spacing_mm);
  named("template", request.template_source);
  line.optional("in_place", request.template_in_place, request.template_in_place);
  named("labels", request.labels);
  named("contours", request.contours);
  std::optional<Organ> organ;
  int subject = 1;
  if (request.demo) std::tie(organ, subject) = *request.demo;
  spell_choice_or_null(line, "phantom", organ_names, organ);
  if (line.reads() ? line.has("subject") : request.demo.has_value()) line.count("subject", subject);
  if (line.reads() && organ) request.demo = {*organ, subject};
}
void OpenRequested::run(Editing& editing) const {
  editing.work.opener.start(request, editing.shown.document().scan.image);
}

OpenRequested open_case_file(const fs::path& file) {
  OpenRequested open;
  open.request.case_file = file;
  return open;
}

OpenRequested open_template(const std::string& source) {
  OpenRequested open;
  open.request.template_source = source;
  return open;
}

OpenRequested open_labels(const fs::path& file) {
  OpenRequested open;
  open.request.labels = file;
  return open;
}

OpenRequested open_phantom(Organ organ, int subject) {
  OpenRequested open;
  open.request.demo = {organ, subject};
  return open;
}

void CloseLabels::run(Editing& editing) const {
  editing.shown.close_labels();
}

void ShowLabelsLayer::spell(Fields& line) {
  line.member("layer", layer);
}
void ShowLabelsLayer::run(Editing& editing) const {
  editing.shown.show_labels_layer(layer);
}

void SetLabelsFrame::spell(Fields& line) {
  line.member("frame", frame);
}
void SetLabelsFrame::run(Editing& editing) const {
  editing.shown.set_labels_frame(frame);
}

void CancelOpening::run(Editing& editing) const {
  editing.work.opener.cancel();
}

void CancelReading::run(Editing& editing) const {
  editing.work.imports.cancel();
}

void CancelWriting::spell(Fields& line) {
  line.member("path", path);
}
void CancelWriting::run(Editing& editing) const {
  editing.work.exports.cancel(path);
}

void SaveCase::spell(Fields& line) {
  line.member("as", as);
}
void SaveCase::run(Editing& editing) const {
  if (nothing_to_save(editing)) return;
  const auto& file = editing.shown.snapshot().file;
  if (as || file.empty() || file.parent_path() == unsaved_folder())
    return editing.out.send(ShowFileDialog{FilePurpose::save_case, case_name(file, editing.shown.document())});
  editing.shown.session().save(true);
}

void FileCommand::spell(Fields& line) {
  line.member("path", path);
}

void SaveCaseAs::run(Editing& editing) const {
  if (!nothing_to_save(editing)) editing.shown.session().save_as(path);
}

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
        [mesh = ShapeView{*structure, *structure->shape(frame), frame}.mesh(), grid = document.scan.image->geometry](
            const auto& to, Progress& progress) { return write_volume(label_map(mesh, grid, 1), to, &progress); },
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
  auto meshes = segments_of(document, editing.shown.labels());
  if (meshes.empty()) return no_mesh_to_export(editing);
  std::string remark;
  for (const auto& one : document.structures)
    if (const std::string closed = closed_flat_of(*one); one->shape(document.frame) != nullptr && !closed.empty())
      remark += (remark.empty() ? "" : " ") + closed;
  write_beside(
      editing, path,
      [meshes = std::move(meshes), grid = document.scan.image->geometry](const auto& to, Progress& progress) {
        return write_segmentation(map_of_meshes(meshes, grid).map, to, &progress);
      },
      std::move(remark));
}

void ExportStructuresMeshes::run(Editing& editing) const {
  const Document document = as_done(editing);
  std::vector<std::pair<std::string, MeshFile>> files;
  std::map<std::string, int> taken;
  for (const auto& one : document.structures) {
    const Shape* shape = one->shape(document.frame);
    if (shape == nullptr) continue;
    std::string name = file_name_of_structure(structure_name(*one));
    if (const int number = ++taken[lower_case(name)]; number > 1) name += "-" + std::to_string(number);
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

void ExportTemplate::run(Editing& editing) const {
  if (!lacks_template(editing)) save_template(editing, path);
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
               [table = volume_table(volume_curve(*structure), frame_seconds)](const auto& to, Progress&) {
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

void ImportLandmarks::run(Editing& editing) const {
  import_landmarks(editing, path);
}

void OpenFitModel::run(Editing& editing) const {
  open_fit_model(editing, path);
}

void OpenScoreModel::run(Editing& editing) const {
  open_score_model(editing, path);
}

void ImportStiffness::run(Editing& editing) const {
  if (!lacks_template(editing)) import_stiffness(editing, path);
}

void ImportTemplateLandmarks::run(Editing& editing) const {
  if (!lacks_template(editing)) import_template_landmarks(editing, path);
}

}  // namespace homolog
