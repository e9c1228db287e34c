#include <filesystem>
#include <optional>
#include <utility>

#include "app/verbs/describe.h"
#include "app/verbs/mending_report.h"
#include "app/verbs/read_image.h"
#include "app/verbs/template/template_job.h"
#include "core/adapt/labels/choose_closing.h"
#include "core/adapt/labels/faced_template.h"
#include "core/mesh/mesh_io.h"
#include "core/template/template.h"
#include "core/template_making/mesh_template.h"
#include "core/template_making/parts_template.h"
#include "core/template_making/template_file.h"

// A template of one subject: of a label, of what faces other labels, of a tube, of a surface.

namespace homolog {

namespace {

std::string how_cut(const CutTunnel& tunnel) {
  return tunnel.how == CutTunnel::How::filled ? "filled" : "severed";
}

/// The labels in a template's provenance: a number, or several.
void list_labels(const MaskRead& mask, Json& provenance) {
  if (mask.from.size() > 1) provenance["label"] = mask.from;
}

Result<MadeTemplate> from_mask(const TemplateJob& options, const MaskRead& mask, bool choose_closing,
                               Progress& progress) {
  MaskTemplateOptions making;
  making.label = mask.label;
  making.frame = mask.frame;
  making.vertices = options.vertices;
  making.closing_mm = options.closing_mm;
  making.opening_mm = options.opening_mm;
  making.genus = genus_rule(options.genus);
  ClosingChoice choice;
  if (choose_closing && !options.closing_mm) {
    choice = choose_template_closing(mask.volume, making, &progress);
    if (choice.tried.size() > 1) making.closing_mm = choice.closing_mm;
  }
  const auto made = options.parts == "all" ? make_parts_template(mask.volume, making, &progress)
                                           : make_mask_template(mask.volume, making, &progress);
  if (!made) return fail(options.in.string(), mask.named(made.error().what));
  std::vector<std::string> warnings = about(options.in, mask.named(made->warnings));
  making.closing_mm = made->closing_mm;
  making.opening_mm = made->opening_mm;

  Json tunnels = Json::array();
  for (const CutTunnel& tunnel : made->tunnels)
    tunnels.push_back({{"at_mm", json_of(tunnel.at_mm)}, {"below_mm", tunnel.width_mm}, {"how", how_cut(tunnel)}});
  const Json removed{{"islands_ml", made->islands_ml},
                     {"cavities", made->cavities},
                     {"cavities_ml", made->cavities_ml},
                     {"tunnels", tunnels}};
  Json provenance = provenance_of(options.in.filename().string(), making);
  list_labels(mask, provenance);
  MeshFile file = template_file(made->mesh, provenance);
  mark_cut(file, made->cut);
  if (options.closing_mm || choice.tried.size() > 1) file.comments.push_back(closing_comment(made->closing_mm));
  Json tried = Json::array();
  for (const TriedClosing& one : choice.tried)
    tried.push_back({{"closing_mm", one.closing_mm}, {"dice_raw", one.dice_raw}, {"doubtful", one.doubtful}});
  return MadeTemplate{std::move(file),
                      {{"distance_to_mask_mm", json_of(made->to_mask)},
                       {"distance_from_mask_mm", json_of(made->from_mask)},
                       {"closing_chosen", !options.closing_mm.has_value()},
                       {"closing_why", options.closing_mm ? "as asked for" : choice.why},
                       {"closing_tried", tried},
                       {"resampled_mm", made->resampled_mm},
                       {"closing_mm", made->closing_mm},
                       {"opening_mm", made->opening_mm},
                       {"missed", {{"ml", made->missed_ml}, {"share", made->missed_share}}},
                       {"removed", removed}},
                      std::move(warnings)};
}

/// Of the part of a label's surface that faces other labels.
Result<MadeTemplate> from_faced_part(const TemplateJob& options, const MaskRead& mask, Progress& progress) {
  const auto faced = faced_labels(*options.faced, mask.segmentation);
  if (!faced) return fail(options.in.string(), faced.error().what);
  const FacedTemplateOptions making{mask.label, mask.frame, options.vertices,
                                    options.closing_mm.value_or(usual_closing_mm(mask.volume, mask.label, mask.frame))};
  auto made = make_faced_template(mask.volume, *faced, making, &progress);
  if (!made) return fail(options.in.string(), mask.named(made.error().what));
  std::vector<std::string> warnings = about(options.in, mask.named(std::move(made->warnings)));
  MeshFile file = faced_template_file(made->mesh, options.in.filename().string(), *options.faced, making, mask.from);
  mark_cut(file, made->cut);
  if (options.closing_mm) file.comments.push_back(closing_comment(*options.closing_mm));
  return MadeTemplate{std::move(file),
                      {{"distance_to_mask_mm", json_of(made->to_mesh)},
                       {"distance_from_mask_mm", json_of(made->from_mesh)},
                       {"closing_mm", *making.closing_mm}},
                      std::move(warnings)};
}

Result<MadeTemplate> tube(const TemplateJob& options, const MaskRead& mask) {
  TubeTemplateOptions making;
  making.label = mask.label;
  making.frame = mask.frame;
  making.rings = options.rings;
  making.sectors = options.sectors;
  making.capped = options.capped;
  if (options.outer_label != 0) making.outer_label = options.outer_label;
  if (!options.axis.empty()) making.axis = Vec3(options.axis.data());
  if (!options.base.empty()) making.base_and_apex = {Vec3(options.base.data()), Vec3(options.apex.data())};
  const auto made = make_tube_template(mask.volume, making);
  if (!made) return fail(options.in.string(), mask.named(made.error().what));
  std::vector<std::string> warnings = about(options.in, mask.named(made->warnings));
  const std::string missing = missing_from(*made, mask.label);
  if (!missing.empty())
    warnings.push_back(options.in.string() + ": " + mask.named(missing) +
                       "; give its --axis, or a --base and an --apex, and make it again");
  Json provenance = provenance_of(options.in.filename().string(), making);
  list_labels(mask, provenance);
  MeshFile file = template_file(made->mesh, provenance);
  if (!missing.empty()) file.comments.push_back(missing_share_comment(made->missing_share));
  return MadeTemplate{std::move(file),
                      {{"distance_to_mask_mm", json_of(made->to_mask)},
                       {"distance_from_mask_mm", json_of(made->from_mask)},
                       {"axis", json_of(made->axis)},
                       {"label_ml", made->label_ml},
                       {"missed", {{"ml", made->missing_share * made->label_ml}, {"share", made->missing_share}}}},
                      std::move(warnings)};
}

/// The vertices that are there: landmarks are added, and all else stays.
Result<MadeTemplate> as_it_is(const TemplateJob& options) {
  auto file = read_mesh_file(options.in);
  if (!file) return fail(file.error());
  if (file->triangles.rows() == 0) return fail(options.in.string(), "has points alone; give a mesh with faces");
  std::vector<std::string> warnings = about(options.in, std::exchange(file->warnings, {}));
  return MadeTemplate{std::move(*file), Json::object(), std::move(warnings)};
}

Result<MadeTemplate> from_mesh(const TemplateJob& options, Progress& progress) {
  if (options.keep_vertices) return as_it_is(options);
  const auto surface = read_mesh_to_mend(options.in);
  if (!surface) return fail(surface.error());
  MeshTemplateOptions making;
  making.vertices = options.vertices;
  making.genus = genus_rule(options.genus);
  making.closing_mm = options.closing_mm;
  making.opening_mm = options.opening_mm;
  making.longest_rim_share = longest_rim_share(options.holes);
  auto made = make_mesh_template(*surface, making, &progress);
  if (!made) return fail(options.in.string(), made.error().what);
  Json provenance{{"source", options.in.filename().string()}, {"vertices", options.vertices}};
  if (made->rebuilt) provenance["rebuilt"] = json_of(*made->rebuilt);
  MeshFile file = template_file(made->mesh, provenance);
  file.landmarks = surface->landmarks;
  Json further{{"distance_to_mesh_mm", json_of(made->to_mesh)},
               {"distance_from_mesh_mm", json_of(made->from_mesh)},
               {"mended", json_of(made->mended)}};
  if (made->rebuilt) further["rebuilt"] = json_of(*made->rebuilt);
  return MadeTemplate{std::move(file), std::move(further), about(options.in, std::move(made->warnings))};
}

}  // namespace

Result<MadeTemplate> make_template_of_one(const TemplateJob& options, bool choose_closing, Progress& progress) {
  if (is_mesh_name(options.in)) {
    if (!options.label.empty() || options.frame || options.level || options.faced)
      return fail(
          options.in.string(),
          "is a mesh, on which --label, --frame, --level, --facing and --open-at have no effect; leave them out");
    if (options.tube)
      return fail(options.in.string(), "is a mesh, and --tube needs a label map; make one with label-map first");
    return from_mesh(options, progress);
  }
  const auto mask = read_mask(options.in, options.label,
                              {options.frame, {}, options.level, options.tube, options.faced.has_value()}, progress);
  if (!mask) return fail(mask.error());
  auto made = options.tube    ? tube(options, *mask)
              : options.faced ? from_faced_part(options, *mask, progress)
                              : from_mask(options, *mask, choose_closing, progress);
  if (!made) return made;
  mask->report(made->values);
  made->of_reading = mask->warnings;
  return made;
}

}  // namespace homolog
