#include <filesystem>
#include <string>
#include <vector>

#include "app/verbs/describe.h"
#include "app/verbs/files/write_labels.h"
#include "app/verbs/read_image.h"
#include "app/verbs/record.h"
#include "core/base/files/file_stem.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/session/case_file.h"
#include "core/structures/maps/case_segments.h"
#include "core/volume/formats/formats.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/readers.h"
#include "core/volume/volume_io.h"

// The verb `label-map`: a mesh, or the structures of a case, as voxels.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// All structures of a case as voxels on a volume's grid, with their names.
Result<Report> label_map_of_case(const fs::path& path, const fs::path& asked_like, bool resample, const fs::path& out,
                                 const GivenCommand& command, Progress& progress) {
  ReplayOptions replay;
  replay.progress = &progress;
  const auto read = read_case(path, replay);
  if (!read) return fail(read.error());
  const Document& document = read->session.document();
  const auto meshes = segments_of(document);
  if (meshes.empty())
    return fail(path.string(), "has no mesh in the frame that it shows; show another one and save it");
  // A case knows which series it was made on.
  ReferencedImages made_on;
  if (document.scan.image && !document.scan.image->series_uid.empty())
    made_on.series = {document.scan.image->series_uid};
  const LikeImage wanted = like_of({.path = asked_like, .resample = resample}, made_on);
  const fs::path& like_path = wanted.path;
  const auto like = read_like(wanted, made_on, progress);
  if (!like) return fail(like.error());
  const bool layered = keeps_layers(out);
  MapOfMeshes made =
      layered ? map_in_layers(meshes, like->volume.geometry) : map_of_meshes(meshes, like->volume.geometry);
  made.map.resampled = like->resampled;
  const auto record = record_of(command, progress);
  if (!record) return fail(record.error());
  const auto written = write_labels(made.map, out, like_path, progress, *record, like->volume.series_uid);
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
    const Volume& layer = made.map.layer(segment.layer);
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
  verb->add_option(
          "-o,--output", options->out,
          "The label map to write (.nii.gz, .nrrd, .seg.nrrd, .mha, .mgz; .dcm: a DICOM segmentation of the series)")
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
    auto like = read_like({.path = options->like, .resample = options->resample}, {}, progress);
    if (!like) return fail(like.error());
    const auto misfit = misfit_in_image(bounds_of(mesh->points), like->volume.geometry);
    const Volume labels = label_map(*mesh, like->volume.geometry, options->value);
    const auto record = record_of(options->command, progress);
    if (!record) return fail(record.error());
    std::vector<std::string> warnings = like->warnings;
    if (is_dicom_name(options->out)) {
      VolumeRead map{.volume = labels, .warnings = {}, .segmentation = {}, .other_layers = {}};
      map.segmentation.add({.name = file_stem(options->mesh), .value = options->value});
      map.resampled = like->resampled;
      const auto written = write_labels(map, options->out, options->like, progress, *record, like->volume.series_uid);
      if (!written) return fail(written.error());
      warnings.insert(warnings.end(), written->begin(), written->end());
    } else if (auto written = has_ending(options->out, formats::mgh.endings)
                                  ? write_mgh_labels(labels, {}, options->out, *record, &progress)
                                  : write_volume(labels, options->out, &progress, *record);
               !written) {
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
