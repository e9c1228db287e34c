#include "app/verbs/fit/fit_case.h"
#include "app/verbs/fit/fit_contours.h"
#include "app/verbs/fit/snap_arguments.h"
#include "core/adapt/labels/label_fit.h"
#include "core/assist/assist.h"
#include "core/assist/cine.h"
#include "core/structures/fitting/set_in_case.h"
#include "core/structures/fitting/shared_in_case.h"
#include "core/template_making/label_body.h"
#include "core/volume/referenced_images.h"
#include "python/homolog/case_parts.h"

// Automatic steps, each an edit of the case.

namespace homolog::python {

namespace {

/// An automatic step as an edit: what the edit says, and what the verb reports of the step.
py::dict apply_with_report(HeldCase& self, EditStep step, const Json& report,
                           const std::shared_ptr<const Document>& since) {
  py::dict row = apply(self, std::move(step), since);
  for (const auto& [key, value] : report.items()) row[py::str(key)] = to_python(value);
  return row;
}

/// The first sentence alone; none where there is none.
std::vector<std::string> first_of(const std::vector<std::string>& sentences) {
  if (sentences.empty()) return {};
  return {sentences.front()};
}

/// Says in a report why its mesh has to be looked at.
void say_doubt(const std::vector<std::string>& warnings, Json& report) {
  report["doubt"] = report["doubtful"] == true ? reason_of_doubt(warnings) : std::string();
}

template <class Edit>
Edit computed(HeldCase& self, const py::object& progress, const std::function<Result<Edit>(Progress&)>& work) {
  const InUse held(self);
  check_takes_edits(self);
  return watched_value<Edit>({progress, {}}, work);
}

/// A label map or a soft mask as it is given: one that is held, an image of nibabel, or a file.
std::shared_ptr<HeldVolume> labels_from(const py::object& value) {
  if (py::isinstance<HeldVolume>(value)) return value.cast<std::shared_ptr<HeldVolume>>();
  if (py::isinstance<py::array>(value))
    refuse("labels",
           "is an array of numpy, which does not say where it lies; give homolog.LabelMap(array, affine=...)");
  const py::module_ images = py::module_::import("homolog._images");
  const bool nibabel = images.attr("is_nibabel")(value).cast<bool>();
  const py::object read =
      nibabel ? images.attr("mask_of")(value)
              : images.attr("read_label_map")(path_from(value, "labels", "a LabelMap, a file or an image of nibabel"));
  return read.cast<std::shared_ptr<HeldVolume>>();
}

/// Whether a voxel of a label lies in a grid.
bool lies_in(const MapLabel& target, const VolumeGeometry& grid) {
  const auto& [first, last, area_mm2, voxels] = label_extent(target.map, target.label, target.frame);
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i)
        if (rounded_label(target.map.at(i, j, k, target.frame)) == target.label &&
            grid.holds(target.map.geometry.to_mm(Vec3(i, j, k))))
          return true;
  return voxels == 0;  // said by the fit
}

/// A step that was computed, and what the verb reports of it.
struct ReportedFit {
  SetPoints edit;
  Report report;
};

py::dict fit_into(HeldCase& self, const py::object& given, const py::object& asked, const std::string& of,
                  const std::optional<double>& closing_mm, const std::optional<int>& frame, bool as_placed,
                  const py::object& progress) {
  const auto labels = labels_from(given);
  const std::string label = label_text(asked);
  const auto kept = document_of(self);
  const ShapeView view = shown(*kept, of);
  const Volume* image = kept->scan.image.get();
  const std::string name = labels->source.empty() ? "labels" : labels->source,
                    image_name = kept->scan.source.empty() ? "the image of the case" : kept->scan.source;
  if (image != nullptr) {
    if (const auto other = value_of(
            check_scan(name, labels->read->volume.frame_of_reference, labels->read->referenced, image_name, *image)))
      warn({*other});
  }
  const auto fitted = computed<ReportedFit>(self, progress, [&](Progress& own) -> Result<ReportedFit> {
    FitTarget read;
    const bool among_others = view.the_template().faced.has_value();
    auto mask = chosen_mask(*labels->read, name, label, {frame, {}, {}, false, among_others});
    if (!mask) return fail(mask.error());
    read.mask = std::move(*mask);
    const MapLabel target = read.label();
    if (image != nullptr && !lies_in(target, image->geometry))
      return fail(name, "lies outside of " + image_name + "; give the scan that it was drawn on");
    const Template& the_template = view.the_template();
    FitOptions options;
    options.progress = &own;
    options.landmarks = view.shape.landmarks;
    if (as_placed) options.placement = view.shape.placement;
    const LabelFitOptions how{.closing_mm = closing_mm, .kept_closing_mm = closing_kept_with(the_template.source)};
    auto found = fit_to_label(the_template, target, how, options);
    if (!found) return fail(name, read.mask->named(found.error().what));
    ReportedFit done{edit_of_fit(view, found->fit, false), {}};
    const double seconds = std::chrono::duration<double>(FitClock::now() - read.started).count();
    read.boundary = found->boundary;
    done.report = report_of_fit(read, the_template, found->fit, found->judgement, false, seconds);
    done.report.values.update(described_closing(*found, how));
    auto& said = done.report.warnings;
    said = read.mask->named(found->judgement.warnings);
    say_doubt(said, done.report.values);
    // What reading the map said was said then.
    const auto& of_map = read.mask->warnings;
    said.insert(said.begin(), of_map.begin() + std::ssize(labels->read->warnings), of_map.end());
    return done;
  });
  warn(fitted.report.warnings);
  return apply_with_report(self, {fitted.edit, of}, fitted.report.values, kept);
}

/// One file, or several.
std::vector<std::filesystem::path> files_from(const py::object& value) {
  const auto file = [](const py::object& one) {
    return std::filesystem::path(path_from(one, "contours", "a file, or a list of files"));
  };
  if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value)) return {file(value)};
  std::vector<std::filesystem::path> files;
  for (const py::handle& one : value) files.push_back(file(py::reinterpret_borrow<py::object>(one)));
  if (files.empty()) refuse("contours", "name no file; give one");
  return files;
}

py::dict fit_to_contours(HeldCase& self, const py::object& files, const std::string& structure, double off_mm,
                         bool outside, bool with_image, const std::string& of, const py::object& progress) {
  const auto kept = document_of(self);
  (void)shown(*kept, of);  // refuses where there is no mesh
  const Scan& scan = kept->scan;
  if (with_image && !scan.image) refuse("case", "has no image to go on to; leave out with_image");
  FitJob job;
  job.contours = files_from(files);
  job.structure = structure;
  job.off_mm = off_mm;
  job.outside = outside;
  const std::string image_name = scan.source.empty() ? "the image of the case" : scan.source;
  auto organ = value_of(read_organ(job, image_name, scan.image.get()));
  warn(organ.warnings);
  auto curves = std::make_shared<std::vector<Contour>>();
  for (DrawnContour& one : organ.contours) curves->push_back(std::move(one.curve));
  SetContours drawn{.id = free_contour_id(*kept), .name = organ.structures.front(), .curves = std::move(curves)};
  drawn.off_mm = off_mm;
  drawn.outside = outside;
  apply(self, {std::move(drawn), of}, kept);
  const auto now = document_of(self);
  try {
    const ShapeView there = shown(*now, of);
    auto fitted = computed<ReportedFit>(self, progress, [&](Progress& own) -> Result<ReportedFit> {
      const auto started = FitClock::now();
      BetweenContours between;
      if (with_image) between.image = now->scan.image;
      FitOptions options;
      options.progress = &own;
      auto found = fit_shape_to_contours(there, between, false, options);
      if (!found) return fail(found.error());
      ReportedFit done{std::move(found->action), {}};
      const double seconds = std::chrono::duration<double>(FitClock::now() - started).count();
      // All that the case holds was fitted to; what reading the files said was said then.
      const DrawnOrgan all{drawn_contours(there), organ.structures, {}};
      describe_contour_fit(all, there.the_template(), found->result, seconds, job.contours.front(), !with_image,
                           done.report);
      // What makes it doubtful is said first.
      const bool doubtful = done.report.values["doubtful"] == true;
      done.report.values["doubt"] = doubtful ? done.report.warnings.front() + "." : std::string();
      return done;
    });
    warn(fitted.report.warnings);
    return apply_with_report(self, {std::move(fitted.edit), of, true}, fitted.report.values, now);
  } catch (...) {
    const std::exception_ptr why = std::current_exception();
    try {
      apply(self, {Undo{}}, now);  // the contours go with the fit
    } catch (const Refusal&) {     // another call has edited the case since
    }
    std::rethrow_exception(why);
  }
}

py::dict snap_into(HeldCase& self, const py::object& at, double sigma_mm, double reach_mm, double strength,
                   const std::string& polarity, const std::string& of, const py::object& progress) {
  const auto kept = document_of(self);
  const ShapeView view = shown(*kept, of);
  const Scan& scan = kept->scan;
  if (!scan.image) refuse("case", "has no image to snap to; give a case that has one");
  std::optional<SnapArea> area;
  if (!at.is_none()) area = SnapArea{vector_from(at, "at"), sigma_mm};
  SnapArguments arguments;
  arguments.reach_mm = reach_mm;
  arguments.strength = strength;
  arguments.polarity = polarity;
  auto snapped = computed<ReportedFit>(self, progress, [&](Progress& own) -> Result<ReportedFit> {
    auto options = snap_options(arguments, view.shape.points->rows(), own);
    if (!options) return fail(options.error());
    options->progress = &own;
    auto edit = snap_shape(scan, view, area, *options);
    if (!edit) return fail(edit.error());
    const Mesh mesh{view.the_template().topology, *edit->action.points};
    Report report = snap_report(edit->result, mesh, *view.shape.placed, scan.source);
    report.warnings = edit->result.warnings;
    say_doubt(first_of(report.warnings), report.values);
    return ReportedFit{std::move(edit->action), std::move(report)};
  });
  warn(snapped.report.warnings);
  return apply_with_report(self, {std::move(snapped.edit), of}, snapped.report.values, kept);
}

py::dict refine_into(HeldCase& self, const std::string& of, const py::object& progress) {
  const auto kept = document_of(self);
  const ShapeView view = shown(*kept, of);
  auto edit = computed<RefineEdit>(self, progress, [&](Progress& own) { return refine_shape(view, &own); });
  warn(edit.warnings);
  return apply(self, {std::move(edit.action), of}, kept);
}

py::list propagate_into(HeldCase& self, double reach_mm, const std::string& of, const py::object& progress) {
  const auto kept = document_of(self);
  const ShapeView view = shown(*kept, of);
  const Scan& scan = kept->scan;
  if (!scan.image) refuse("case", "has no image to go through; give a case that has one");
  auto edit = computed<CineEdit>(self, progress, [&](Progress& own) {
    PropagateOptions options;
    options.reach_mm = reach_mm;
    options.progress = &own;
    auto carried = propagate_shape(scan, view, options);
    if (carried) share_carried(*kept, {{view.structure.id, carried->actions}});
    return carried;
  });
  auto since = kept;
  for (SetPoints& action : edit.actions) {
    apply(self, {std::move(action), of, since != kept}, since);
    since = document_of(self);
  }
  py::list frames;
  for (const PropagatedFrame& frame : edit.result.frames) {
    py::dict row;
    row["volume_ml"] = frame.volume_ml;
    row["confidence"] = frame.confidence;
    row["disagreement_mm"] = frame.disagreement_mm ? py::object(py::float_(*frame.disagreement_mm)) : py::none();
    row["doubt"] = frame.doubt;
    frames.append(row);
  }
  return frames;
}

}  // namespace

void add_case_fits(CaseType& type) {
  const auto none = py::none();
  type.def("fit", &fit_into, py::arg("labels"), py::kw_only(), py::arg("label") = "", py::arg("of") = "",
           py::arg("closing_mm") = none, py::arg("frame") = none, py::arg("as_placed") = false,
           py::arg("progress") = none,
           "Fits the structure's template to a label, as one edit. label: its number or name, or a list of them for "
           "their union. as_placed: from where it lies. Gives what do() gives, what `homolog fit --json` reports "
           "(doubtful, dice, …), and as doubt the reason.")
      .def("fit_to_contours", &fit_to_contours, py::arg("contours"), py::kw_only(), py::arg("structure") = "",
           py::arg("off_mm") = 0.0, py::arg("outside") = false, py::arg("with_image") = false, py::arg("of") = "",
           py::arg("progress") = none,
           "Takes contours of files (RTSTRUCT, .mrk.json, .vtp) into the case and fits the structure's template to all "
           "that it holds, as one edit. structure: which of theirs. with_image: between them the image counts. Gives "
           "what do() gives, what `homolog fit --json` reports (doubtful, contours_mm, …), and as doubt the reason.")
      .def("snap", &snap_into, py::arg("at") = none, py::kw_only(), py::arg("sigma_mm") = 10.0,
           py::arg("reach_mm") = 10.0, py::arg("strength") = 1.0, py::arg("polarity") = "automatic", py::arg("of") = "",
           py::arg("progress") = none,
           "Draws the mesh, or its part around `at` (LPS mm), to the boundary in the image, as one edit. Gives what "
           "do() gives, what `homolog snap --json` reports (doubtful, confidence, …), and as doubt the reason.")
      .def("refine", &refine_into, py::kw_only(), py::arg("of") = "", py::arg("progress") = none,
           "Moves vertices along the surface to where the template has them, as one edit.")
      .def("propagate", &propagate_into, py::kw_only(), py::arg("reach_mm") = 6.0, py::arg("of") = "",
           py::arg("progress") = none,
           "Carries the known frames' meshes through a cine, as one edit. Gives a dict for each frame.")
      .def(
          "keep_apart",
          [](HeldCase& self, const std::string& of) -> py::object {
            const auto document = document_of(self);
            auto edit = apart_from_others(*document, of);
            return edit ? py::object(apply(self, {std::move(*edit), of}, document)) : py::none();
          },
          py::arg("of"), "Moves a structure out of its neighbours, as one edit; None where nothing meets.");
}

}  // namespace homolog::python
