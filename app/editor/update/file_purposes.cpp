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

/// What is opened for a case.
std::vector<FilePurposeKind> opened_for_case() {
  const Extensions& meshes = mesh_extensions();
  const Extensions& volumes = volume_extensions();
  const Extensions openable = joined(joined({case_extension, ".set.json", ".study.json"}, volumes), meshes);
  const Extensions templates = mesh_format_extensions(&MeshFormat::keeps_template);
  const Extensions landmarks{".mrk.json", ".fcsv", ".json"};
  return {
      {.purpose = FilePurpose::open,
       .name = "open",
       .title = "Open an image, a case, a template or a template set",
       .files = {.extensions = openable, .any_volume = true},
       .command = to<OpenFiles>,
       .command_of_several = to_several<OpenFiles>},
      {.purpose = FilePurpose::open_template,
       .name = "open template",
       .title = "Load a template mesh",
       .files = {.extensions = meshes},
       .command = template_of},
      {.purpose = FilePurpose::open_labels,
       .name = "open labels",
       .title = "Open a label map: to look at, to fit to, or for a template",
       .files = {.extensions = volumes, .any_volume = true},
       .command = labels_of},
      {.purpose = FilePurpose::open_landmarks,
       .name = "open landmarks",
       .title = "Import placed landmarks",
       .files = {.extensions = landmarks},
       .command = to<ImportLandmarks>},
      {.purpose = FilePurpose::open_contours,
       .name = "open contours",
       .title = "Open contours: RTSTRUCT, curves of 3D Slicer, lines of VTP",
       .files = {.extensions = {".mrk.json", ".vtp", ".dcm"}, .any_volume = true},
       .command = to<OpenContours>},
      {.purpose = FilePurpose::open_stiffness,
       .name = "open stiffness",
       .title = "Take stiffness factors from a mesh",
       .files = {.extensions = templates},
       .command = to<ImportStiffness>},
      {.purpose = FilePurpose::open_template_landmarks,
       .name = "open template landmarks",
       .title = "Import the template's landmarks",
       .files = {.extensions = landmarks},
       .command = to<ImportTemplateLandmarks>},
      {.purpose = FilePurpose::open_set,
       .name = "open set",
       .title = "Choose a template set",
       .files = {.extensions = {".set.json"}},
       .command = set_of},
      {.purpose = FilePurpose::open_recipe,
       .name = "open recipe",
       .title = "Choose a recipe",
       .files = {.extensions = {".recipe.json", ".json"}},
       .command = recipe_of},
      {.purpose = FilePurpose::open_model,
       .name = "open model",
       .title = "Choose a shape model for the fit",
       .files = {.extensions = {".h5", ".h5.json"}},
       .command = to<OpenFitModel>},
      {.purpose = FilePurpose::open_score_model,
       .name = "open score model",
       .title = "Choose a model to score against",
       .files = {.extensions = {".h5", ".h5.json"}},
       .command = to<OpenScoreModel>},
  };
}

/// What is opened for a study.
std::vector<FilePurposeKind> opened_for_study() {
  const Extensions& meshes = mesh_extensions();
  const Extensions& volumes = volume_extensions();
  const Extensions shapes = joined(shape_extensions(), {case_extension});
  return {
      {.purpose = FilePurpose::open_study,
       .name = "open study",
       .title = "Open a study",
       .files = {.extensions = {".study.json"}},
       .command = to<OpenStudy>},
      {.purpose = FilePurpose::open_study_template,
       .name = "open study template",
       .title = "Set the study's template",
       .files = {.extensions = meshes},
       .command = to<SetStudyTemplate>},
      {.purpose = FilePurpose::add_shapes,
       .name = "add shapes",
       .title = "Add shapes to the study",
       .files = {.extensions = shapes},
       .command = to<AddCases>,
       .command_of_several = to_several<AddCases>},
      {.purpose = FilePurpose::add_scans,
       .name = "add scans",
       .title = "Add scans or label maps: one file stands for its folder",
       .files = {.extensions = volumes, .any_volume = true},
       .command = to<AddScans>,
       .command_of_several = to_several<AddScans>},
      {.purpose = FilePurpose::open_observer,
       .name = "open observer",
       .title = "Choose the study of the other observer",
       .files = {.extensions = {".study.json"}},
       .command = to<CompareObservers>},
  };
}

/// What is saved of a case, but for all its structures.
std::vector<FilePurposeKind> saved_of_case() {
  const Extensions exported = mesh_format_extensions();
  const Extensions templates = mesh_format_extensions(&MeshFormat::keeps_template);
  const Extensions landmarks{".mrk.json", ".fcsv", ".json"};
  return {
      {.purpose = FilePurpose::save_case,
       .name = "save case",
       .title = "Save the case",
       .files = {.saves = true, .extensions = {case_extension}},
       .command = to<SaveCaseAs>},
      {.purpose = FilePurpose::export_mesh,
       .name = "export mesh",
       .title = "Export the mesh",
       .files = {.saves = true, .extensions = exported},
       .command = of_frames<ExportMesh>},
      {.purpose = FilePurpose::export_landmarks,
       .name = "export landmarks",
       .title = "Export the placed landmarks",
       .files = {.saves = true, .extensions = landmarks},
       .command = to<ExportLandmarks>},
      {.purpose = FilePurpose::export_template,
       .name = "export template",
       .title = "Save the template",
       .files = {.saves = true, .extensions = templates},
       .command = to<ExportTemplate>},
      {.purpose = FilePurpose::export_template_landmarks,
       .name = "export template landmarks",
       .title = "Export the template's landmarks",
       .files = {.saves = true, .extensions = landmarks},
       .command = to<ExportTemplateLandmarks>},
      {.purpose = FilePurpose::use_made_template,
       .name = "use made template",
       .title = "Save the new template",
       .files = {.saves = true, .extensions = templates},
       .command = to<UseMadeTemplate>},
      {.purpose = FilePurpose::export_picture,
       .name = "export picture",
       .title = "Save a picture",
       .files = {.saves = true, .extensions = {".png"}},
       .command = to<ExportPicture>},
      {.purpose = FilePurpose::export_volumes,
       .name = "export volumes",
       .title = "Export the volumes",
       .files = {.saves = true, .extensions = {".csv"}},
       .command = to<ExportVolumes>},
      {.purpose = FilePurpose::export_measurements,
       .name = "export measurements",
       .title = "Export the measurements",
       .files = {.saves = true, .extensions = {".csv"}},
       .command = to<ExportMeasurements>},
  };
}

/// Label maps, and all structures of a case.
std::vector<FilePurposeKind> saved_of_structures() {
  return {
      {.purpose = FilePurpose::export_label_map,
       .name = "export label map",
       .title = "Export the label map",
       .files = {.saves = true, .extensions = joined(volume_format_endings(&VolumeFormat::written), {".dcm"})},
       .command = of_frames<ExportLabelMap>},
      {.purpose = FilePurpose::export_structures_map,
       .name = "export map of structures",
       .title = "Export one label map of all structures",
       .files = {.saves = true,
                 .extensions = joined(joined({".seg.nrrd"}, volume_format_endings(&VolumeFormat::written)), {".dcm"})},
       .command = to<ExportStructuresMap>},
      {.purpose = FilePurpose::export_mended_map,
       .name = "export mended map",
       .title = "Write the label map as the structures are now",
       .files = {.saves = true, .extensions = joined({".seg.nrrd"}, label_map_endings())},
       .command = to<ExportMendedMap>},
      {.purpose = FilePurpose::export_mended_masks,
       .name = "export mended masks",
       .title = "Write the masks as the structures are now into a new folder",
       .files = {.saves = true, .extensions = {}},
       .command = to<ExportMendedMap>},
      {.purpose = FilePurpose::export_structures_meshes,
       .name = "export meshes of structures",
       .title = "Export the meshes of all structures into a new folder",
       .files = {.saves = true, .extensions = {}},
       .command = to<ExportStructuresMeshes>},
  };
}

/// What is saved of a study.
std::vector<FilePurposeKind> saved_of_study() {
  const Extensions templates = mesh_format_extensions(&MeshFormat::keeps_template);
  return {
      {.purpose = FilePurpose::make_study_template,
       .name = "make study template",
       .title = "Save the consensus template of the study's label maps",
       .files = {.saves = true, .extensions = templates},
       .command = to<MakeStudyTemplate>},
      {.purpose = FilePurpose::new_study,
       .name = "new study",
       .title = "New study",
       .files = {.saves = true, .extensions = {".study.json"}},
       .command = to<NewStudy>},
      {.purpose = FilePurpose::save_study,
       .name = "save study",
       .title = "Save the study as",
       .files = {.saves = true, .extensions = {".study.json"}},
       .command = to<SaveStudyAs>},
      {.purpose = FilePurpose::export_model,
       .name = "export model",
       .title = "Export the model",
       .files = {.saves = true, .extensions = {".h5.json", ".h5"}},
       .command = to<ExportModel>},
      {.purpose = FilePurpose::export_measures,
       .name = "export measures",
       .title = "Export the measures",
       .files = {.saves = true, .extensions = {".csv", ".json"}},
       .command = to<ExportEvaluation>},
      {.purpose = FilePurpose::export_plots,
       .name = "export plots",
       .title = "Save the plots",
       .files = {.saves = true, .extensions = {".png"}},
       .command = to<ExportPlots>},
      {.purpose = FilePurpose::export_report,
       .name = "export report",
       .title = "Write the report",
       .files = {.saves = true, .extensions = {".html"}},
       .command = to<ExportReport>},
      {.purpose = FilePurpose::export_sizes,
       .name = "export sizes",
       .title = "Export volumes, areas and distances",
       .files = {.saves = true, .extensions = {".csv"}},
       .command = to<ExportSizes>},
      {.purpose = FilePurpose::export_landmark_table,
       .name = "export landmark table",
       .title = "Export the landmarks of all cases",
       .files = {.saves = true, .extensions = {".tps", ".csv"}},
       .command = to<ExportLandmarkTable>},
      {.purpose = FilePurpose::export_observers,
       .name = "export observers",
       .title = "Export the comparison of the observers",
       .files = {.saves = true, .extensions = {".csv"}},
       .command = to<ExportObservers>},
      {.purpose = FilePurpose::export_shapes,
       .name = "export shapes",
       .title = "Export the shapes into a new folder",
       .files = {.saves = true, .extensions = {}},
       .command = shapes_folder},
  };
}

const std::vector<FilePurposeKind>& file_purposes() {
  static const std::vector<FilePurposeKind> all = [] {
    std::vector<FilePurposeKind> kinds;
    for (const auto& group :
         {opened_for_case(), opened_for_study(), saved_of_case(), saved_of_structures(), saved_of_study()})
      kinds.insert(kinds.end(), group.begin(), group.end());
    return kinds;
  }();
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
