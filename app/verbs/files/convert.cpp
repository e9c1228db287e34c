#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "app/verbs/describe.h"
#include "app/verbs/files/write_labels.h"
#include "app/verbs/model/model_part.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "core/base/files/freesurfer_files.h"
#include "core/base/text/listed.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/mesh_io.h"
#include "core/model/files/statismo.h"
#include "core/template/other_side.h"
#include "core/volume/contour_labels.h"
#include "core/volume/dicom/dicom_series.h"
#include "core/volume/labels/label_likeness.h"
#include "core/volume/labels/map_on_grid.h"
#include "core/volume/labels/soft_mask.h"
#include "core/volume/referenced_images.h"
#include "core/volume/volume_io.h"

// Verbs that write what they read in another form: convert, mirror.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// What `convert` is asked for.
struct ConvertJob {
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
  const CLI::App* verb = nullptr;  ///< whose options these are

  bool has(const char* option) const { return verb->count(option) > 0; }
  /// Of a file there is no series to choose: then --series is that of --like.
  bool series_is_of_like() const {
    std::error_code ignored;
    return !like.empty() && !fs::is_directory(in, ignored);
  }
};

// Each kind of input first refuses what has no effect on it, then does its work. `record`: for the file that is
// written.

/// Errors: an option was given that is for meshes and images alone. `what`: what the input is, as "is a model".
Result<void> refuse_reading(const ConvertJob& job, const std::string& what) {
  for (const char* name : {"--times", "--from-ras", "--spacing"})
    if (job.has(name)) return fail(job.in.string(), what + ", so that " + name + " has no effect; leave it out");
  if (job.has("--series") && job.like.empty())
    return fail(job.in.string(), what + ", so that --series has no effect; leave it out");
  return {};
}

/// A model's mean or random shape as a mesh.
Result<Report> convert_model(const ConvertJob& job, const std::string& record) {
  if (auto refused = refuse_reading(job, "is a model"); !refused) return fail(refused.error());
  if (!job.like.empty() || job.resample)
    return fail(job.in.string(), "is a model, so that --like and --resample have no effect; leave them out");
  if (!is_mesh_name(job.out))
    return fail(job.out.string(), "is no mesh's name; a model's shape is one, so use .ply or .vtk");
  auto mesh = mesh_of_model(job.in, job.structure, job.sample);
  if (!mesh) return fail(mesh.error());
  if (mesh->triangles.rows() == 0 && job.out.extension() != ".particles")
    return fail(job.out.string(),
                "needs faces, and " + job.in.string() + " is a model of points alone; use .particles");
  auto report = describe(*mesh, job.in);
  if (!report) return report;
  mesh->record = record;
  if (auto written = write_mesh_file(*mesh, job.out); !written) return fail(written.error());
  return report;
}

/// Whether a volume holds labels, or is a soft mask.
bool is_mask(const Volume& volume) {
  return holds_labels(volume) || is_soft(volume, 0);
}

/// Contours as a label map on the grid of an image.
Result<Report> convert_contours(const ConvertJob& job, const std::string& record, Progress& progress) {
  const fs::path& in = job.in;
  if (auto refused = refuse_reading(job, "holds contours"); !refused) return fail(refused.error());
  if (job.like.empty())
    return fail(in.string(),
                "holds contours, which become a label map on the grid of an image; name the series that "
                "they were drawn on by --like");
  auto contours = read_contours(in);
  if (!contours) return fail(contours.error());
  if (!job.structure.empty()) {
    const auto roi = roi_of(*contours, job.structure);
    if (!roi) return fail(in.string(), roi.error().what);
    contours->rois = {ContourRoi(**roi)};
    contours->warnings = doubts_about(in, contours->rois);
  }
  const LikeImage wanted =
      like_of({.path = job.like, .resample = job.resample, .series = job.series}, contours->referenced);
  const fs::path& like = wanted.path;
  const auto image = read_like(wanted, contours->referenced, progress);
  if (!image) return fail(image.error());
  auto map = labels_of_contours(in, *contours, like, image->volume, &progress, image->resampled);
  if (!map) return fail(map.error());
  map->resampled = image->resampled;
  const auto written = write_labels(*map, job.out, like, progress, record, image->volume.series_uid);
  if (!written) return fail(written.error());
  std::vector<std::string> warnings = image->warnings;
  warnings.insert(warnings.end(), map->warnings.begin(), map->warnings.end());
  warnings.insert(warnings.end(), written->begin(), written->end());
  Report report{describe(map->volume), std::move(warnings)};
  report_resampled(*image, report.values);
  return report;
}

/// A label map on the grid of an image, with the voxels that it has. `wanted` becomes the folder and the series of
/// that image.
Result<VolumeRead> read_on_image(const fs::path& in, VolumeReadOptions reading, LikeImage& wanted) {
  const ReferencedImages made_on = images_made_on(in);
  wanted = like_of(std::move(wanted), made_on);
  const fs::path& like = wanted.path;
  const auto image = read_like(wanted, made_on, *reading.progress);
  if (!image) return fail(image.error());
  wanted.series = image->volume.series_uid;
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

/// Errors: meshes and volumes do not become each other here; options that have no effect on either.
Result<void> check_kinds(const ConvertJob& job, bool is_mesh) {
  if (job.has("--structure") || job.has("--sample"))
    return fail(job.in.string(), "is no model, so --structure and --sample have no effect; leave them out");
  if (!job.like.empty() && is_mesh)
    return fail(job.in.string(), "is a mesh, so that --like has no effect; label-map makes voxels of it");
  if (is_mesh && !is_mesh_name(job.out) && !looks_like_volume(job.out))
    return fail(job.out.string(), "is not a kind of mesh that can be written; end its name in " +
                                      listed(mesh_format_extensions(&MeshFormat::keeps_template), " or ") +
                                      ", or in that of another mesh format (docs/formats.md)");
  if (is_mesh == is_mesh_name(job.out)) return {};
  return fail(job.out.string(),
              "is not of the same kind as " + job.in.string() +
                  "; use label-map to make a volume of a mesh, and template to make a mesh of a volume");
}

/// A mesh in another format, or its coordinates in other units or axes.
Result<Report> convert_mesh(const ConvertJob& job, const std::string& record) {
  const Vec3 times = job.times * (job.from_ras ? Vec3(-1, -1, 1) : Vec3(1, 1, 1));
  return describe_and_write(job.in, job.out, record, [times](MeshFile mesh) {
    if (times == Vec3(1, 1, 1)) return mesh;
    mesh.points *= times.asDiagonal();
    for (Landmark& landmark : mesh.landmarks) landmark.position = landmark.position.cwiseProduct(times);
    if (mesh.doubt_mm) *mesh.doubt_mm *= std::abs(times.z());
    return mesh;
  });
}

/// An image or a label map in another format. `warnings`: what is known of its reading already.
Result<Report> convert_volume(const ConvertJob& job, const std::string& record, std::vector<std::string> warnings,
                              Progress& progress) {
  if (job.times != 1 || job.from_ras)
    return fail(job.in.string(),
                "is a volume, on which --times and --from-ras have no effect; correct the geometry in its header");
  const bool on_image = !job.like.empty();
  LikeImage like{.path = job.like, .resample = job.resample, .series = {}};
  if (job.series_is_of_like()) like.series = job.series;
  const VolumeReadOptions reading =
      read_options(job.series_is_of_like() ? "" : job.series, job.spacing_mm, progress, job.resample && !on_image);
  auto read = on_image ? read_on_image(job.in, reading, like) : read_volume(job.in, reading);
  if (!read) return fail(read.error());
  if (is_dicom_name(job.out) && read->segmentation.segments.empty() && !is_mask(read->volume))
    return fail(job.in.string(),
                "is no label map, and DICOM files are written of label maps alone; choose another "
                "format");
  const auto written = write_labels(*read, job.out, like.path, progress, record, like.series.value_or(""));
  if (!written) return fail(written.error());
  warnings.insert(warnings.begin(), read->warnings.begin(), read->warnings.end());
  warnings.insert(warnings.end(), written->begin(), written->end());
  Report report{describe(read->volume), std::move(warnings)};
  report_resampled(*read, report.values);
  return report;
}

Result<Report> convert(const ConvertJob& job, Progress& progress) {
  const auto record = record_of(job.command, progress);
  if (!record) return fail(record.error());
  if (std::string words = freesurfer_words(job.in); !words.empty()) return fail(job.in.string(), std::move(words));
  if (is_model_name(job.in)) return convert_model(job, *record);
  if (!job.has("--sample") && holds_contours(job.in)) return convert_contours(job, *record, progress);
  const bool is_mesh = is_mesh_name(job.in) || is_built_in(job.in.string());
  if (auto kinds = check_kinds(job, is_mesh); !kinds) return fail(kinds.error());
  auto warnings = check_reading(job.in, job.series_is_of_like() ? "" : job.series, !job.spacing_mm.empty(),
                                job.resample && job.like.empty());
  if (!warnings) return fail(warnings.error());
  return is_mesh ? convert_mesh(job, *record) : convert_volume(job, *record, std::move(*warnings), progress);
}

}  // namespace

void add_convert(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<ConvertJob>();
  CLI::App* verb = add_verb(app, "convert", "Any readable volume or mesh to any writable format");
  verb->add_option(
          "IN", options->in,
          "A volume, mesh or built-in template, contours (RTSTRUCT), or a model (.h5, .h5.json), whose mean becomes "
          "a mesh")
      ->required();
  verb->add_option("OUT", options->out, "The file to write; its extension chooses the format")->required();
  verb->add_option(
      "--series", options->series,
      "UID of the series, where a DICOM folder holds several; of a file with --like: which of that folder");
  add_spacing_option(*verb, options->spacing_mm);
  verb->add_option("--times", options->times,
                   "Multiply a mesh's coordinates, which are in another unit than mm: 1000 for metres, 10 for cm")
      ->check(CLI::Range(1e-9, 1e9));
  verb->add_flag("--from-ras", options->from_ras, "A mesh's coordinates are RAS, though its file does not say so");
  verb->add_option("--structure", options->structure, "Of a joint model or of contours this structure alone");
  verb->add_option(
      "--like", options->like,
      "Of contours (RTSTRUCT) or a label map: the image whose grid it gets; of one that is written as DICOM "
      "(.dcm): the series that it refers to");
  add_resample_option(*verb, options->resample);
  verb->add_option("--sample", options->sample, "Of a model the random shape of this seed, not the mean");
  options->verb = verb;
  verb->callback([options, &asked] {
    options->command = given_command(*options->verb);
    asked.run = [options](Progress& progress) { return convert(*options, progress); };
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

}  // namespace homolog
