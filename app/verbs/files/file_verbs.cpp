#include <filesystem>
#include <optional>

#include "app/verbs/describe.h"
#include "app/verbs/read_image.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/compare.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/model/measures/observers.h"
#include "core/model/shapes/shape_files.h"
#include "core/phantom/phantom_files.h"
#include "core/volume/volume_io.h"

// Verbs that look at files, and phantoms: info, compare, phantom.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// The 0.5 isosurface of the label that is meant, as it is.
Result<Mesh> labelled_surface(const fs::path& path, const MaskRead& mask) {
  auto surface = mask_surface(mask.volume, mask.label, mask.frame);
  if (!surface) return fail(path.string(), mask.named(surface.error().what));
  return surface;
}

/// Says where a mesh and a surface that should lie in one place do not because of units or axes.
void warn_of_misfit(const fs::path& path, const Mesh& mesh, const fs::path& other_path, const Mesh& other,
                    std::vector<std::string>& warnings) {
  if (const auto misfit = misfit_in_scan(mesh, other))
    warnings.push_back(misfit_sentence(*misfit, meeting_of(path, mesh.points), meeting_of(other_path, other.points)));
}

}  // namespace

void add_info(CLI::App& app, CommandLine& asked) {
  struct Options {
    fs::path file, mask;
    std::string label;
    std::string series;
    std::vector<double> spacing_mm;
    std::optional<int> frame;
    std::optional<double> level;
    bool resample = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, "info", "What a volume, mesh, template, case or model is");
  verb->add_option("FILE", options->file, "A volume (or DICOM folder), mesh, template (built-in too), case or model")
      ->required();
  verb->add_option("--series", options->series, "UID of the series, where a DICOM folder holds several");
  add_spacing_option(*verb, options->spacing_mm);
  add_resample_option(*verb, options->resample);
  auto* mask_option = verb->add_option("--mask", options->mask, "A label map: also measure the mesh's distance to it");
  add_label_option(*verb, options->label, "Which label of the mask, by number or name; 1,2: both together")
      ->needs(mask_option);
  add_mask_frame_option(*verb, options->frame);
  add_level_option(*verb, options->level)->needs(mask_option);
  const auto info = [options](Progress& progress) -> Result<Report> {
    const auto warnings =
        check_reading(options->file, options->series, !options->spacing_mm.empty(), options->resample);
    if (!warnings) return fail(warnings.error());
    auto report =
        describe_file(options->file, read_options(options->series, options->spacing_mm, progress, options->resample),
                      options->mask.empty() ? options->frame : std::nullopt);
    if (report) report->warnings.insert(report->warnings.end(), warnings->begin(), warnings->end());
    if (!report || options->mask.empty()) return report;
    const auto file = load_mesh(options->file.string());
    if (!file) return fail(file.error());
    const auto mesh = sound_mesh(*file);
    if (!mesh) return fail(options->file.string(), mesh.error().what);
    const auto mask =
        read_mask(options->mask, options->label, {options->frame, noted_frame(*file), options->level}, progress);
    if (!mask) return fail(mask.error());
    const auto target = labelled_surface(options->mask, *mask);
    if (!target) return fail(target.error());
    report->warnings.insert(report->warnings.end(), mask->warnings.begin(), mask->warnings.end());
    warn_of_misfit(options->file, *mesh, options->mask, *target, report->warnings);
    mask->report(report->values);
    report->values["distance_to_mask_mm"] = json_of(surface_distance(*mesh, *target));
    report->values["distance_from_mask_mm"] = json_of(surface_distance(*target, *mesh));
    return report;
  };
  verb->callback([info, &asked] { asked.run = info; });
}

namespace {

/// Meshes that overlap so much lie in one place.
constexpr double surely_met = 0.7;

Json describe(const Agreement& agreement) {
  Json values{{"dice", agreement.dice},
              {"assd_mm", agreement.assd_mm},
              {"hd95_mm", agreement.hd95_mm},
              {"hausdorff_mm", agreement.hausdorff_mm}};
  if (agreement.vertex_mean_mm) {
    values["vertex_distance_mm"] = {{"mean", *agreement.vertex_mean_mm}, {"max", *agreement.vertex_max_mm}};
  }
  return values;
}

/// A mesh, or that of a case as it is.
Result<MeshFile> read_shape_or_surface(const fs::path& path) {
  if (!is_case_file(path)) return read_mesh_file(path);
  auto shapes = read_shapes_of(path);
  if (!shapes) return fail(shapes.error());
  const auto shape = shapes->shape({}, path.string());
  if (!shape) return fail(shape.error());
  return **shape;
}

Result<Mesh> surface_of(const MeshFile& file, const fs::path& path) {
  if (!is_case_file(path)) return read_mesh(path);  // that checks more
  auto faces = Topology::make(file.points.rows(), file.triangles);
  if (!faces) return fail(path.string(), faces.error().what);
  return Mesh{*faces, file.points};
}

/// Of an open mesh against a closed surface: Dice closes the rims, and the distances do not.
void warn_of_rims(const fs::path& path, const Mesh& mesh, const std::string& closed,
                  std::vector<std::string>& warnings) {
  if (mesh.topology->rims().empty()) return;
  warnings.push_back(path.string() +
                     ": dice counts it as closed, and the distances (assd_mm, hd95_mm, hausdorff_mm) do "
                     "not, so that the part of " +
                     closed + " beyond the rim makes them larger than those that fit reports");
}

}  // namespace

void add_compare(CLI::App& app, CommandLine& asked) {
  struct Options {
    fs::path mesh, mask, other;
    std::string label;
    std::optional<int> frame;
    std::optional<double> level;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, "compare", "How well a mesh agrees with a mask or another mesh");
  verb->add_option("MESH", options->mesh, "The mesh, or a case for its mesh")->required();
  auto* mask_option = verb->add_option("--mask", options->mask, "A label map to compare with");
  add_label_option(*verb, options->label, "Which label of the mask, by number or name; 1,2: both together")
      ->needs(mask_option);
  add_mask_frame_option(*verb, options->frame)->needs(mask_option);
  add_level_option(*verb, options->level)->needs(mask_option);
  verb->add_option("--mesh", options->other, "Another mesh or case to compare with")->excludes(mask_option);
  const auto compare = [options](Progress& progress) -> Result<Report> {
    const auto file = read_shape_or_surface(options->mesh);
    if (!file) return fail(file.error());
    auto mesh = surface_of(*file, options->mesh);
    if (!mesh) return fail(mesh.error());
    std::vector<std::string> warnings = mesh_warnings(options->mesh, *file, *mesh);
    if (!options->other.empty()) {
      const auto other_file = read_shape_or_surface(options->other);
      if (!other_file) return fail(other_file.error());
      auto other = surface_of(*other_file, options->other);
      if (!other) return fail(other.error());
      const Agreement agreement = compare_meshes(*mesh, *other);
      for (std::string& warning : mesh_warnings(options->other, *other_file, *other))
        warnings.push_back(std::move(warning));
      if (other->topology->rims().empty()) warn_of_rims(options->mesh, *mesh, options->other.string(), warnings);
      if (mesh->topology->rims().empty()) warn_of_rims(options->other, *other, options->mesh.string(), warnings);
      if (agreement.dice < surely_met) warn_of_misfit(options->mesh, *mesh, options->other, *other, warnings);
      Report report{describe(agreement), std::move(warnings)};
      if (const auto landmarks = landmark_distances_mm(*file, *other_file); !landmarks.empty())
        report.values["landmarks_mm"] = landmarks;
      return report;
    }
    const auto mask =
        read_mask(options->mask, options->label, {options->frame, noted_frame(*file), options->level}, progress);
    if (!mask) return fail(mask.error());
    const auto agreement = compare_with_mask(*mesh, mask->volume, mask->label, mask->frame);
    if (!agreement) return fail(options->mask.string(), mask->named(agreement.error().what));
    warn_of_rims(options->mesh, *mesh, "the label", warnings);
    warnings.insert(warnings.end(), mask->warnings.begin(), mask->warnings.end());
    if (agreement->dice < surely_met)
      if (const auto target = labelled_surface(options->mask, *mask))
        warn_of_misfit(options->mesh, *mesh, options->mask, *target, warnings);
    Report report{describe(*agreement), std::move(warnings)};
    mask->report(report.values);
    return report;
  };
  verb->callback([options, compare, &asked] {
    if (options->mask.empty() == options->other.empty()) throw CLI::RequiredError("exactly one of --mask and --mesh");
    asked.run = compare;
  });
}

void add_phantom(CLI::App& app, CommandLine& asked) {
  struct Options {
    std::string organ;
    int subject = 0;
    fs::path folder;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, "phantom", "A phantom subject: volume, label map, true meshes and landmarks");
  verb->add_option("ORGAN", options->organ, "Which organ")
      ->required()
      ->check(CLI::IsMember({"kidney", "vertebra", "ventricle", "spine"}));
  verb->add_option("--subject", options->subject, "Number of the subject; 0 is the mean shape")
      ->required()
      ->check(CLI::NonNegativeNumber);
  verb->add_option("-o,--output", options->folder, "Folder for the files")->required();
  const auto make = [options](Progress&) -> Result<Report> {
    const auto write = [&]() -> Result<std::vector<fs::path>> {
      if (options->organ == "spine") return write_spine_phantom(options->subject, options->folder);
      const auto organ = organ_from_name(options->organ);
      if (!organ) return fail(organ.error());
      return write_phantom(*organ, options->subject, options->folder);
    };
    const auto paths = write();
    if (!paths) return fail(paths.error());
    Json written = Json::array();
    for (const auto& path : *paths) written.push_back(path.string());
    return Report{{{"paths", std::move(written)}}, {}};
  };
  verb->callback([make, &asked] { asked.run = make; });
}

}  // namespace homolog
