#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "app/verbs/describe.h"
#include "app/verbs/model/model_part.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "core/base/text/listed.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/compare.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/files/statismo.h"
#include "core/session/case_file.h"
#include "core/structures/maps/case_segments.h"
#include "core/template/other_side.h"
#include "core/volume/contour_labels.h"
#include "core/volume/dicom/write_dicom_segmentation.h"
#include "core/volume/labels/label_likeness.h"
#include "core/volume/labels/map_on_grid.h"
#include "core/volume/labels/soft_mask.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/referenced_images.h"
#include "core/volume/volume_io.h"

// Verbs that write what they read in another form: convert, mirror, label-map.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// A model's mean or random shape as a mesh.
Result<Report> convert_model(const fs::path& in, const fs::path& out, const std::string& structure,
                             std::optional<std::uint64_t> seed, const std::string& record) {
  if (!is_mesh_name(out)) return fail(out.string(), "is no mesh's name; a model's shape is one, so use .ply or .vtk");
  auto mesh = mesh_of_model(in, structure, seed);
  if (!mesh) return fail(mesh.error());
  if (mesh->triangles.rows() == 0 && out.extension() != ".particles")
    return fail(out.string(), "needs faces, and " + in.string() + " is a model of points alone; use .particles");
  auto report = describe(*mesh, in);
  if (!report) return report;
  mesh->record = record;
  if (auto written = write_mesh_file(*mesh, out); !written) return fail(written.error());
  return report;
}

bool is_dicom_name(const fs::path& path) {
  return lower_case(path.extension().string()) == ".dcm";
}

/// Whether a volume holds labels, or is a soft mask.
bool is_mask(const Volume& volume) {
  return holds_labels(volume) || is_soft(volume, 0);
}

/// Writes a label map by the ending of its name; one of DICOM refers to a series. Gives warnings.
Result<std::vector<std::string>> write_labels(const VolumeRead& map, const fs::path& out, const fs::path& series,
                                              Progress& progress, const std::string& record) {
  if (is_dicom_name(out) && series.empty())
    return fail(out.string(), "becomes a DICOM segmentation, which refers to a series of images; name it by --like");
  if (is_dicom_name(out)) return write_dicom_segmentation(map, out, series, &progress);
  if (auto written = write_segmentation(map, out, &progress, record); !written) return fail(written.error());
  return std::vector<std::string>();
}

/// The volume whose grid a label map gets.
Result<VolumeRead> read_like(const fs::path& path, bool resample, Progress& progress) {
  if (auto usable = check_reading(path, "", false, resample); !usable) return fail(usable.error());
  return read_volume(path, read_options("", {}, progress, resample));
}

/// Contours as a label map on the grid of an image.
Result<Report> convert_contours(const fs::path& in, const fs::path& out, const fs::path& like,
                                const std::string& structure, bool resample, Progress& progress,
                                const std::string& record) {
  if (like.empty())
    return fail(in.string(),
                "holds contours, which become a label map on the grid of an image; name the series that "
                "they were drawn on by --like");
  auto contours = read_contours(in);
  if (!contours) return fail(contours.error());
  if (!structure.empty()) {
    const auto roi = roi_of(*contours, structure);
    if (!roi) return fail(in.string(), roi.error().what);
    contours->rois = {ContourRoi(**roi)};
    contours->warnings = doubts_about(in, contours->rois);
  }
  const auto image = read_like(like, resample, progress);
  if (!image) return fail(image.error());
  auto map = labels_of_contours(in, *contours, like, image->volume, &progress, image->resampled);
  if (!map) return fail(map.error());
  map->resampled = image->resampled;
  const auto written = write_labels(*map, out, like, progress, record);
  if (!written) return fail(written.error());
  std::vector<std::string> warnings = image->warnings;
  warnings.insert(warnings.end(), map->warnings.begin(), map->warnings.end());
  warnings.insert(warnings.end(), written->begin(), written->end());
  Report report{describe(map->volume), std::move(warnings)};
  report_resampled(*image, report.values);
  return report;
}

/// A label map on the grid of an image, with the voxels that it has.
Result<VolumeRead> read_on_image(const fs::path& in, VolumeReadOptions reading, const fs::path& like, bool resample) {
  const auto image = read_like(like, resample, *reading.progress);
  if (!image) return fail(image.error());
  reading.image =
      ImageGrid{image->volume.geometry, image->volume.frame_of_reference, image->volume.images, image->resampled};
  auto map = read_volume(in, reading);
  if (!map) return map;
  if (map->segmentation.segments.empty() && !is_mask(map->volume))
    return fail(in.string(), "is no label map, so that --like has no effect; leave it out");
  auto other = check_scan(in, map->volume.frame_of_reference, map->referenced, like, image->volume, " by --like");
  if (!other) return fail(other.error());
  if (!put_on_grid(*map, image->volume.geometry))
    return fail(in.string(), "does not lie on the voxels of " + like.string() +
                                 "; resample it to that image, or leave out --like to write it as it is");
  map->warnings.insert(map->warnings.begin(), image->warnings.begin(), image->warnings.end());
  map->resampled = image->resampled;
  if (*other) map->warnings.push_back(std::move(**other));
  return map;
}

/// What a mesh has that the format of its new name keeps no place for; empty: nothing.
std::string lost_in(const MeshFile& mesh, const fs::path& out) {
  const MeshFormat* format = mesh_format_of(out);
  if (format == nullptr || format->keeps_template) return {};
  std::vector<std::string> lost;
  if (!mesh.landmarks.empty()) lost.emplace_back("landmarks");
  if (!mesh.regions.list.empty()) lost.emplace_back("names of regions");
  if (lost.empty()) return {};
  return out.string() + ": keeps no " + listed(lost, " and no ") + ", which stay in the mesh that was read; use " +
         listed(mesh_format_extensions(&MeshFormat::keeps_template), " or ") + " to keep them";
}

/// Reads a mesh, changes it, and writes it once it is known to be one that can be read again.
Result<Report> describe_and_write(const fs::path& in, const fs::path& out, const std::string& record,
                                  const std::function<MeshFile(MeshFile)>& change) {
  auto mesh = load_mesh(in.string());
  if (!mesh) return fail(mesh.error());
  MeshFile changed = change(std::move(*mesh));
  changed.record = record;
  auto report = describe(changed, in);
  if (!report) return report;
  if (auto written = write_mesh_file(changed, out); !written) return fail(written.error());
  if (auto lost = lost_in(changed, out); !lost.empty()) report->warnings.push_back(std::move(lost));
  return report;
}

}  // namespace

void add_convert(CLI::App& app, CommandLine& asked) {
  struct Options {
    fs::path in, out;
    std::string series;
    std::vector<double> spacing_mm;
    double times = 1;
    bool from_ras = false;
    std::string structure;
    fs::path like;
    std::optional<std::uint64_t> sample;
    bool resample = false;
    GivenCommand command;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, "convert", "Any readable volume or mesh to any writable format");
  verb->add_option(
          "IN", options->in,
          "A volume, mesh or built-in template, contours (RTSTRUCT), or a model (.h5, .h5.json), whose mean becomes "
          "a mesh")
      ->required();
  verb->add_option("OUT", options->out, "The file to write; its extension chooses the format")->required();
  verb->add_option("--series", options->series, "UID of the series, where a DICOM folder holds several");
  add_spacing_option(*verb, options->spacing_mm);
  verb->add_option("--times", options->times,
                   "Multiply a mesh's coordinates, which are in another unit than mm: 1000 for metres, 10 for cm")
      ->check(CLI::Range(1e-9, 1e9));
  verb->add_flag("--from-ras", options->from_ras, "A mesh's coordinates are RAS, though its file does not say so");
  auto* structure =
      verb->add_option("--structure", options->structure, "Of a joint model or of contours this structure alone");
  verb->add_option(
      "--like", options->like,
      "Of contours (RTSTRUCT) or a label map: the image whose grid it gets; of one that is written as DICOM "
      "(.dcm): the series that it refers to");
  add_resample_option(*verb, options->resample);
  auto* sample =
      verb->add_option("--sample", options->sample, "Of a model the random shape of this seed, not the mean");
  const auto convert = [options, structure, sample, verb](Progress& progress) -> Result<Report> {
    const auto record = record_of(options->command, progress);
    if (!record) return fail(record.error());
    const bool is_model = is_model_name(options->in);
    const bool is_drawn = !is_model && sample->count() == 0 && holds_contours(options->in);
    for (const char* name : {"--times", "--from-ras", "--spacing", "--series"})
      if ((is_model || is_drawn) && verb->count(name) > 0)
        return fail(options->in.string(), std::string(is_model ? "is a model" : "holds contours") + ", so that " +
                                              name + " has no effect; leave it out");
    if (is_model && (!options->like.empty() || options->resample))
      return fail(options->in.string(), "is a model, so that --like and --resample have no effect; leave them out");
    if (is_model) return convert_model(options->in, options->out, options->structure, options->sample, *record);
    if (is_drawn)
      return convert_contours(options->in, options->out, options->like, options->structure, options->resample, progress,
                              *record);
    if (structure->count() + sample->count() > 0)
      return fail(options->in.string(), "is no model, so --structure and --sample have no effect; leave them out");
    const bool is_mesh = is_mesh_name(options->in) || is_built_in(options->in.string());
    if (!options->like.empty() && is_mesh)
      return fail(options->in.string(), "is a mesh, so that --like has no effect; label-map makes voxels of it");
    if (is_mesh && !is_mesh_name(options->out) && !looks_like_volume(options->out))
      return fail(options->out.string(), "is not a kind of mesh that can be written; end its name in " +
                                             listed(mesh_format_extensions(&MeshFormat::keeps_template), " or ") +
                                             ", or in that of another mesh format (docs/formats.md)");
    if (is_mesh != is_mesh_name(options->out)) {
      return fail(options->out.string(),
                  "is not of the same kind as " + options->in.string() +
                      "; use label-map to make a volume of a mesh, and template to make a mesh of a volume");
    }
    auto warnings = check_reading(options->in, options->series, !options->spacing_mm.empty(),
                                  options->resample && options->like.empty());
    if (!warnings) return fail(warnings.error());
    if (is_mesh) {
      const Vec3 times = options->times * (options->from_ras ? Vec3(-1, -1, 1) : Vec3(1, 1, 1));
      return describe_and_write(options->in, options->out, *record, [times](MeshFile mesh) {
        if (times == Vec3(1, 1, 1)) return mesh;
        mesh.points *= times.asDiagonal();
        for (Landmark& landmark : mesh.landmarks) landmark.position = landmark.position.cwiseProduct(times);
        if (mesh.doubt_mm) *mesh.doubt_mm *= std::abs(times.z());
        return mesh;
      });
    }
    if (options->times != 1 || options->from_ras)
      return fail(options->in.string(),
                  "is a volume, on which --times and --from-ras have no effect; correct the geometry in its header");
    const bool on_image = !options->like.empty();
    const VolumeReadOptions reading =
        read_options(options->series, options->spacing_mm, progress, options->resample && !on_image);
    auto read = on_image ? read_on_image(options->in, reading, options->like, options->resample)
                         : read_volume(options->in, reading);
    if (!read) return fail(read.error());
    if (is_dicom_name(options->out) && read->segmentation.segments.empty() && !is_mask(read->volume))
      return fail(options->in.string(),
                  "is no label map, and DICOM files are written of label maps alone; choose another "
                  "format");
    const auto written = write_labels(*read, options->out, options->like, progress, *record);
    if (!written) return fail(written.error());
    warnings->insert(warnings->begin(), read->warnings.begin(), read->warnings.end());
    warnings->insert(warnings->end(), written->begin(), written->end());
    Report report{describe(read->volume), std::move(*warnings)};
    report_resampled(*read, report.values);
    return report;
  };
  verb->callback([options, verb, convert, &asked] {
    options->command = given_command(*verb);
    asked.run = convert;
  });
}

void add_mirror(CLI::App& app, CommandLine& asked) {
  struct Options {
    fs::path in, out;
    std::string plane = "sagittal";
    GivenCommand command;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, "mirror", "The template of the other side, with the same numbering");
  verb->add_option("TEMPLATE", options->in, "A template (built-in too) or mesh")->required();
  keeps_correspondence(verb->add_option("-o,--output", options->out, "The file to write")->required());
  verb->add_option("--plane", options->plane, "Plane to mirror across")
      ->check(CLI::IsMember({"sagittal", "coronal", "axial"}));
  const auto mirror = [options](Progress& progress) -> Result<Report> {
    const auto record = record_of(options->command, progress);
    if (!record) return fail(record.error());
    const AnatomicalPlane plane = options->plane == "sagittal"  ? AnatomicalPlane::sagittal
                                  : options->plane == "coronal" ? AnatomicalPlane::coronal
                                                                : AnatomicalPlane::axial;
    return describe_and_write(options->in, options->out, *record,
                              [plane](const MeshFile& mesh) { return mirrored_with_names(mesh, plane); });
  };
  verb->callback([options, verb, mirror, &asked] {
    options->command = given_command(*verb);
    asked.run = mirror;
  });
}

namespace {

/// All structures of a case as voxels on a volume's grid, with their names.
Result<Report> label_map_of_case(const fs::path& path, const fs::path& like_path, bool resample, const fs::path& out,
                                 const GivenCommand& command, Progress& progress) {
  ReplayOptions replay;
  replay.progress = &progress;
  const auto read = read_case(path, replay);
  if (!read) return fail(read.error());
  const Document& document = read->session.document();
  const auto meshes = segments_of(document);
  if (meshes.empty())
    return fail(path.string(), "has no mesh in the frame that it shows; show another one and save it");
  const auto like = read_like(like_path, resample, progress);
  if (!like) return fail(like.error());
  const bool layered = keeps_layers(out);
  MapOfMeshes made =
      layered ? map_in_layers(meshes, like->volume.geometry) : map_of_meshes(meshes, like->volume.geometry);
  made.map.resampled = like->resampled;
  const auto record = record_of(command, progress);
  if (!record) return fail(record.error());
  const auto written = write_labels(made.map, out, like_path, progress, *record);
  if (!written) return fail(written.error());
  Report report;
  report.warnings = read->warnings;
  report.warnings.insert(report.warnings.end(), like->warnings.begin(), like->warnings.end());
  report.warnings.insert(report.warnings.end(), written->begin(), written->end());
  if (made.contested_voxels > 0)
    report.warnings.push_back(
        path.string() + ": has structures that overlap; " + std::to_string(made.contested_voxels) +
        (layered ? " voxels that two of them hold belong to both, in layers; where they should not, keep them apart in "
                   "the case"
                 : " voxels that two of them hold went to the first; keep them apart in the case, or end the name in "
                   ".seg.nrrd or .dcm, which keep layers"));
  Json structures = Json::array();
  std::size_t all = 0;
  for (const Segment& segment : made.map.segmentation.segments) {
    const Volume& layer = segment.layer == 0 ? made.map.volume : made.map.other_layers[segment.layer - 1];
    const auto counted = labels_of(layer);
    const std::size_t voxels = counted.contains(segment.value) ? counted.at(segment.value) : 0;
    all += voxels;
    structures.push_back({{"name", segment.name}, {"value", segment.value}, {"voxels", voxels}});
    if (voxels == 0)
      report.warnings.push_back(path.string() + ": its structure " + segment.name + " lies outside of " +
                                like_path.string() + ", so that it has no voxels; give the scan that it was made on");
  }
  report.values = {{"voxels", all},
                   {"volume_ml", static_cast<double>(all) * like->volume.geometry.voxel_volume_mm3() / 1000},
                   {"structures", std::move(structures)}};
  report_resampled(*like, report.values);
  return report;
}

}  // namespace

void add_label_map(CLI::App& app, CommandLine& asked) {
  struct Options {
    fs::path mesh, like, out;
    int value = 1;
    bool resample = false;
    GivenCommand command;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, "label-map", "The segmentation as voxels on a volume's grid");
  verb->add_option("MESH", options->mesh, "The mesh, or a case: all its structures, by name")->required();
  verb->add_option("--like", options->like, "The volume whose grid to use")->required();
  verb->add_option("-o,--output", options->out,
                   "The label map to write (.nii.gz, .nrrd, .seg.nrrd, .mha; .dcm: a DICOM segmentation of the series)")
      ->required();
  auto* value = verb->add_option("--value", options->value, "Label of the voxels inside; of a mesh alone")
                    ->check(CLI::Range(1, 32767));
  add_resample_option(*verb, options->resample);
  const auto label = [options, value](Progress& progress) -> Result<Report> {
    if (is_case_file(options->mesh) && value->count() > 0)
      return fail(options->mesh.string(),
                  "is a case, whose structures are numbered from 1, so --value has no effect; leave it out");
    if (is_case_file(options->mesh))
      return label_map_of_case(options->mesh, options->like, options->resample, options->out, options->command,
                               progress);
    const auto file = read_mesh_file(options->mesh);
    if (!file) return fail(file.error());
    const auto mesh = sound_mesh(*file);
    if (!mesh) return fail(options->mesh.string(), mesh.error().what);
    auto like = read_like(options->like, options->resample, progress);
    if (!like) return fail(like.error());
    const auto misfit = misfit_in_image(bounds_of(mesh->points), like->volume.geometry);
    const Volume labels = label_map(*mesh, like->volume.geometry, options->value);
    const auto record = record_of(options->command, progress);
    if (!record) return fail(record.error());
    std::vector<std::string> warnings = like->warnings;
    if (is_dicom_name(options->out)) {
      VolumeRead map{.volume = labels, .warnings = {}, .segmentation = {}, .other_layers = {}};
      map.segmentation.add({.name = options->mesh.stem().string(), .value = options->value});
      map.resampled = like->resampled;
      const auto written = write_labels(map, options->out, options->like, progress, *record);
      if (!written) return fail(written.error());
      warnings.insert(warnings.end(), written->begin(), written->end());
    } else if (auto written = write_volume(labels, options->out, &progress, *record); !written) {
      return fail(written.error());
    }
    const auto counted = labels_of(labels);
    const std::size_t voxels = counted.contains(options->value) ? counted.at(options->value) : 0;
    Report report;
    report.warnings = std::move(warnings);
    for (std::string& warning : mesh_warnings(options->mesh, *file, *mesh))
      report.warnings.push_back(std::move(warning));
    if (misfit) {
      const double image_mm = like->volume.geometry.bounds_mm().diagonal().norm();
      report.warnings.push_back(
          misfit_sentence(*misfit, meeting_of(options->mesh, mesh->points), {options->like.string(), image_mm}));
    } else if (voxels == 0) {
      report.warnings.push_back(options->mesh.string() + " lies outside " + options->like.string() +
                                ", so the label map is empty; check that both are in the same space (LPS or RAS)");
    }
    report.values = {{"voxels", voxels},
                     {"volume_ml", static_cast<double>(voxels) * labels.geometry.voxel_volume_mm3() / 1000}};
    report_resampled(*like, report.values);
    return report;
  };
  verb->callback([options, verb, label, &asked] {
    options->command = given_command(*verb);
    asked.run = label;
  });
}

}  // namespace homolog
