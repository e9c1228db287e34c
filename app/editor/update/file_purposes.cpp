#include "app/editor/update/file_purposes.h"

#include <algorithm>
#include <vector>

#include "app/editor/state/files/file_extensions.h"
#include "core/base/text/text.h"
#include "core/mesh/formats/formats.h"
#include "core/volume/formats/formats.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;
using Extensions = std::vector<std::string>;

template <class C>
Command to(const fs::path& chosen, const EditorState&) {
  return C{{chosen}};
}

template <class C>
Command to_several(const std::vector<fs::path>& chosen) {
  return C{chosen};
}

template <class C>
Command of_frames(const fs::path& chosen, const EditorState& state) {
  return C{{chosen}, state.saving.export_all_frames};
}

Command template_of(const fs::path& chosen, const EditorState&) {
  return open_template(chosen.string());
}

Command labels_of(const fs::path& chosen, const EditorState&) {
  return open_labels(chosen);
}

Command set_of(const fs::path& chosen, const EditorState&) {
  return ChooseSet{chosen.string()};
}

Command recipe_of(const fs::path& chosen, const EditorState&) {
  return ChooseRecipe{chosen.string()};
}

Command shapes_folder(const fs::path& chosen, const EditorState& state) {
  return ExportShapes{chosen, state.models.export_extension};
}

Extensions joined(Extensions first, const Extensions& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

const std::vector<FilePurposeKind>& file_purposes() {
  static const Extensions& meshes = mesh_extensions();
  static const Extensions& volumes = volume_extensions();
  static const Extensions openable = joined(joined({case_extension, ".set.json", ".study.json"}, volumes), meshes);
  static const Extensions exported = mesh_format_extensions();
  static const Extensions shapes = joined(shape_extensions(), {case_extension});
  static const Extensions templates = mesh_format_extensions(&MeshFormat::keeps_template);
  static const Extensions landmarks{".mrk.json", ".fcsv", ".json"};
  static const std::vector<FilePurposeKind> all{
      {FilePurpose::open,
       "open",
       "Open an image, a case, a template or a template set",
       {false, openable, true},
       to<OpenFiles>,
       to_several<OpenFiles>},
      {FilePurpose::open_template, "open template", "Load a template mesh", {false, meshes}, template_of},
      {FilePurpose::open_labels,
       "open labels",
       "Open a label map: to look at, to fit to, or for a template",
       {false, volumes, true},
       labels_of},
      {FilePurpose::open_landmarks,
       "open landmarks",
       "Import placed landmarks",
       {false, landmarks},
       to<ImportLandmarks>},
      {FilePurpose::open_contours,
       "open contours",
       "Open contours: RTSTRUCT, curves of 3D Slicer, lines of VTP",
       {false, {".mrk.json", ".vtp", ".dcm"}, true},
       to<OpenContours>},
      {FilePurpose::open_stiffness,
       "open stiffness",
       "Take stiffness factors from a mesh",
       {false, templates},
       to<ImportStiffness>},
      {FilePurpose::open_template_landmarks,
       "open template landmarks",
       "Import the template's landmarks",
       {false, landmarks},
       to<ImportTemplateLandmarks>},
      {FilePurpose::open_set, "open set", "Choose a template set", {false, {".set.json"}}, set_of},
      {FilePurpose::open_recipe, "open recipe", "Choose a recipe", {false, {".recipe.json", ".json"}}, recipe_of},
      {FilePurpose::open_model,
       "open model",
       "Choose a shape model for the fit",
       {false, {".h5", ".h5.json"}},
       to<OpenFitModel>},
      {FilePurpose::open_score_model,
       "open score model",
       "Choose a model to score against",
       {false, {".h5", ".h5.json"}},
       to<OpenScoreModel>},
      {FilePurpose::open_study, "open study", "Open a study", {false, {".study.json"}}, to<OpenStudy>},
      {FilePurpose::open_study_template,
       "open study template",
       "Set the study's template",
       {false, meshes},
       to<SetStudyTemplate>},
      {FilePurpose::add_shapes,
       "add shapes",
       "Add shapes to the study",
       {false, shapes},
       to<AddCases>,
       to_several<AddCases>},
      {FilePurpose::add_scans,
       "add scans",
       "Add scans or label maps: one file stands for its folder",
       {false, volumes, true},
       to<AddScans>,
       to_several<AddScans>},
      {FilePurpose::save_case, "save case", "Save the case", {true, {case_extension}}, to<SaveCaseAs>},
      {FilePurpose::export_mesh, "export mesh", "Export the mesh", {true, exported}, of_frames<ExportMesh>},
      {FilePurpose::export_label_map,
       "export label map",
       "Export the label map",
       {true, joined(volume_format_endings(&VolumeFormat::written), {".dcm"})},
       of_frames<ExportLabelMap>},
      {FilePurpose::export_structures_map,
       "export map of structures",
       "Export one label map of all structures",
       {true, joined(joined({".seg.nrrd"}, volume_format_endings(&VolumeFormat::written)), {".dcm"})},
       to<ExportStructuresMap>},
      {FilePurpose::export_mended_map,
       "export mended map",
       "Write the label map as the structures are now",
       {true, joined({".seg.nrrd"}, label_map_endings())},
       to<ExportMendedMap>},
      {FilePurpose::export_mended_masks,
       "export mended masks",
       "Write the masks as the structures are now into a new folder",
       {true, {}},
       to<ExportMendedMap>},
      {FilePurpose::export_structures_meshes,
       "export meshes of structures",
       "Export the meshes of all structures into a new folder",
       {true, {}},
       to<ExportStructuresMeshes>},
      {FilePurpose::export_landmarks,
       "export landmarks",
       "Export the placed landmarks",
       {true, landmarks},
       to<ExportLandmarks>},
      {FilePurpose::export_template, "export template", "Save the template", {true, templates}, to<ExportTemplate>},
      {FilePurpose::export_template_landmarks,
       "export template landmarks",
       "Export the template's landmarks",
       {true, landmarks},
       to<ExportTemplateLandmarks>},
      {FilePurpose::use_made_template,
       "use made template",
       "Save the new template",
       {true, templates},
       to<UseMadeTemplate>},
      {FilePurpose::make_study_template,
       "make study template",
       "Save the consensus template of the study's label maps",
       {true, templates},
       to<MakeStudyTemplate>},
      {FilePurpose::export_picture, "export picture", "Save a picture", {true, {".png"}}, to<ExportPicture>},
      {FilePurpose::export_volumes, "export volumes", "Export the volumes", {true, {".csv"}}, to<ExportVolumes>},
      {FilePurpose::export_measurements,
       "export measurements",
       "Export the measurements",
       {true, {".csv"}},
       to<ExportMeasurements>},
      {FilePurpose::new_study, "new study", "New study", {true, {".study.json"}}, to<NewStudy>},
      {FilePurpose::save_study, "save study", "Save the study as", {true, {".study.json"}}, to<SaveStudyAs>},
      {FilePurpose::export_model, "export model", "Export the model", {true, {".h5.json", ".h5"}}, to<ExportModel>},
      {FilePurpose::export_measures,
       "export measures",
       "Export the measures",
       {true, {".csv", ".json"}},
       to<ExportEvaluation>},
      {FilePurpose::export_plots, "export plots", "Save the plots", {true, {".png"}}, to<ExportPlots>},
      {FilePurpose::export_report, "export report", "Write the report", {true, {".html"}}, to<ExportReport>},
      {FilePurpose::export_sizes,
       "export sizes",
       "Export volumes, areas and distances",
       {true, {".csv"}},
       to<ExportSizes>},
      {FilePurpose::export_landmark_table,
       "export landmark table",
       "Export the landmarks of all cases",
       {true, {".tps", ".csv"}},
       to<ExportLandmarkTable>},
      {FilePurpose::open_observer,
       "open observer",
       "Choose the study of the other observer",
       {false, {".study.json"}},
       to<CompareObservers>},
      {FilePurpose::export_observers,
       "export observers",
       "Export the comparison of the observers",
       {true, {".csv"}},
       to<ExportObservers>},
      {FilePurpose::export_shapes, "export shapes", "Export the shapes into a new folder", {true, {}}, shapes_folder},
  };
  return all;
}

}  // namespace

const FilePurposeKind& file_purpose(FilePurpose purpose) {
  const auto& all = file_purposes();
  return *std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.purpose == purpose; });
}

bool has_several_meshes(const Structure* structure) {
  return structure != nullptr && structure->shapes.size() > 1;
}

fs::path file_of_frame(FilePurpose purpose, const fs::path& chosen, int frame, int last) {
  const std::string name = chosen.filename().string();
  std::string ending = chosen.extension().string();
  for (const std::string& known : file_purpose(purpose).files.extensions)
    if (known.size() > ending.size() && lower_case(name).ends_with(known))
      ending = name.substr(name.size() - known.size());
  const std::size_t digits = std::max<std::size_t>(2, std::to_string(last).size());
  std::string number = std::to_string(frame);
  number.insert(0, digits - std::min(digits, number.size()), '0');
  return chosen.parent_path() / (name.substr(0, name.size() - ending.size()) + "-frame-" + number + ending);
}

std::vector<fs::path> files_written(FilePurpose purpose, const fs::path& chosen, const EditorState& state,
                                    const Document& document) {
  const bool of_frames = purpose == FilePurpose::export_mesh || purpose == FilePurpose::export_label_map;
  const Structure* structure = active_structure(state, document);
  if (!of_frames || !state.saving.export_all_frames || !has_several_meshes(structure)) return {chosen};
  std::vector<fs::path> files;
  for (const auto& [frame, shape] : structure->shapes)
    files.push_back(file_of_frame(purpose, chosen, frame, document.scan.frames() - 1));
  return files;
}

std::optional<FilePurpose> purpose_of(const std::string& name) {
  const auto& all = file_purposes();
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  return found == all.end() ? std::nullopt : std::optional(found->purpose);
}

}  // namespace homolog
