#include <cmath>

#include "app/verbs/fit/fit_case.h"
#include "app/verbs/fit/fit_contours.h"
#include "app/verbs/fit/snap_arguments.h"
#include "app/verbs/read_image.h"
#include "core/adapt/labels/label_fit.h"
#include "core/assist/assist.h"
#include "core/assist/cine.h"
#include "core/case/action_json.h"
#include "core/case/action_line.h"
#include "core/catalogue/catalogue.h"
#include "core/session/case_file.h"
#include "core/structures/fitting/set_in_case.h"
#include "core/structures/fitting/shared_in_case.h"
#include "core/template_making/label_body.h"
#include "core/volume/referenced_images.h"
#include "python/homolog/binding.h"
#include "python/homolog/held_case.h"

namespace homolog::python {

namespace {

std::shared_ptr<HeldCase> held(EditSession session, const std::filesystem::path& path,
                               const std::vector<std::string>& warnings) {
  warn(warnings);
  return std::make_shared<HeldCase>(std::move(session), path);
}

std::shared_ptr<HeldCase> open_held(const std::filesystem::path& path, bool read_only, const py::object& progress) {
  auto read = watched_value<CaseRead>({progress, {}}, [&](Progress& own) {
    ReplayOptions options;
    options.progress = &own;
    // From the root: the file has to be found again when the program changes its folder.
    return read_only ? read_case(path, options) : open_case(absolute_path(path), &own);
  });
  return held(std::move(read.session), path, read.warnings);
}

std::shared_ptr<const Template> template_from(const py::object& value) {
  if (const auto mesh = mesh_in(value)) {
    const bool has_changed = names_file(mesh->source) && !mesh->stamp.holds();
    if (mesh->source.empty() || has_changed) return value_of(make_template(*mesh->file, ""));
    return value_of(load_template(mesh->source));
  }
  if (py::isinstance<py::array>(value))
    refuse("template", "is an array of numpy, which has no faces; give homolog.Mesh(points, triangles)");
  return value_of(load_template(path_from(value, "template", "a Mesh, a file, or a name as built-in:kidney")));
}

/// The file for a case, from the root. Errors: it is there already, and nobody said that it may be replaced.
std::filesystem::path file_for_case(const std::filesystem::path& path, bool overwrite) {
  auto file = absolute_path(path);
  std::error_code ignored;
  if (!overwrite && std::filesystem::is_regular_file(file, ignored))
    refuse(path.string(),
           "is there already; give overwrite=True to replace it, or go on with a case by homolog.Case.open");
  return file;
}

std::shared_ptr<HeldCase> create_held(const py::object& the_template, const py::object& image, const py::object& path,
                                      const py::object& placement, bool overwrite, const py::object& progress) {
  std::filesystem::path file;
  if (!path.is_none()) file = file_for_case(path.cast<std::filesystem::path>(), overwrite);
  auto reference = template_from(the_template);
  std::optional<Similarity> place;
  if (!placement.is_none()) {
    const Json given = to_json(placement);
    auto read = similarity_from_json(given);
    if (!read) refuse("placement", read.error().what);
    place = *read;
  }
  std::string source;
  std::shared_ptr<const VolumeRead> read;
  if (py::isinstance<HeldVolume>(image)) {
    const auto& given = image.cast<const HeldVolume&>();
    // A case must not name a file that holds something else by now.
    if (!names_file(given.source) || given.stamp.holds()) source = given.source;
    read = given.read;
  } else if (py::hasattr(image, "dataobj")) {
    refuse("image", "is one of nibabel; give homolog.from_nibabel(image)");
  } else if (py::isinstance<py::array>(image)) {
    refuse("image", "is an array of numpy, which does not say where it lies; give homolog.Volume(array, affine=...)");
  } else if (!image.is_none()) {
    source = path_from(image, "image", "a Volume, a file, or a name as phantom:kidney:1");
    read = std::make_shared<const VolumeRead>(watched_value<VolumeRead>({progress, {}}, [&](Progress& own) {
      VolumeReadOptions options;
      options.progress = &own;
      return load_volume(source, options);
    }));
    warn(read->warnings);
  }
  const auto volume = read ? std::shared_ptr<const Volume>(read, &read->volume) : nullptr;
  const auto with_image = [&](std::shared_ptr<HeldCase> made) {
    if (read) made->image = std::make_shared<HeldVolume>(HeldVolume{read, source, made->image_stamp});
    return made;
  };
  if (path.is_none()) return with_image(held(EditSession(new_document(source, volume, reference, place)), {}, {}));
  if (reference->source.empty())
    refuse("template", "is in memory alone, and a case names its file; write it to one and read that");
  if (volume && source.empty())
    refuse("image", "is in memory alone, and a case names its file; write it to one and read that");
  return with_image(held(value_of(create_case(new_document(source, volume, reference, place), file)), file, {}));
}

/// How far the vertices went on average, of the structure that went farthest, in the frame that is shown now.
double mean_way_mm(const Document& before, const Document& after) {
  double farthest_mm = 0;
  for (const auto& one : after.structures) {
    const Structure* const earlier = before.structure(one->id);
    const Shape* const then = earlier == nullptr ? nullptr : earlier->shape(after.frame);
    const Shape* const now = one->shape(after.frame);
    if (then == nullptr || now == nullptr || then->points->rows() != now->points->rows()) continue;
    farthest_mm = std::max(farthest_mm, (*now->points - *then->points).rowwise().norm().mean());
  }
  return farthest_mm;
}

py::dict report_of(const EditReport& report, double moved_mm) {
  py::dict row;
  row["moved_mm"] = moved_mm;
  row["stopped_by_guard"] = report.stopped_by_guard;
  row["on"] = report.on ? py::object(py::make_tuple(report.on->x(), report.on->y(), report.on->z())) : py::none();
  row["message"] = report.message;
  return row;
}

py::dict apply(HeldCase& self, EditStep step) {
  const InUse held(self);
  check_takes_edits(self);
  std::optional<Result<EditReport>> done;
  const bool is_stroke = std::holds_alternative<Stroke>(step.action);
  double moved_mm = 0;
  {
    const py::gil_scoped_release unlocked;
    const auto before = self.session.shared_document();
    done.emplace(self.session.apply(std::move(step)));
    if (*done) moved_mm = is_stroke ? (*done)->moved_mm : mean_way_mm(*before, self.session.document());
  }
  return report_of(value_of(std::move(*done)), moved_mm);
}

/// An automatic step as an edit: what the edit says, and what the verb reports of the step.
py::dict apply_with_report(HeldCase& self, EditStep step, const Json& report) {
  py::dict row = apply(self, std::move(step));
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

void save_as(HeldCase& self, const std::filesystem::path& path, bool overwrite) {
  const InUse held(self);
  Journal* const journal = self.session.journal();
  const bool is_own =
      journal != nullptr && journal->is_at(absolute_path(path)) && journal->fate() == Journal::Fate::as_left;
  const auto file = file_for_case(path, overwrite || is_own);
  value_of(save_case_as(self.session, file));
  self.source = file.string();
  self.is_written = true;
  self.is_closed = false;
}

void close(HeldCase& self) {
  const InUse held(self);
  self.session.close_journal();
  self.is_closed = !self.source.empty();
}

/// x, y, z of each point, one behind the other, where they are rows.
void flatten(Json& points) {
  if (!points.is_array() || points.empty()) return;
  Json flat = Json::array();
  for (const Json& row : points) {
    if (!row.is_array() || row.size() != 3) return;
    for (const Json& number : row) flat.push_back(number);
  }
  points = std::move(flat);
}

/// An action as its line has it.
Json line_from(const py::dict& action) {
  Json line = to_json(action);
  if (const auto points = line.find("points"); points != line.end()) flatten(*points);
  const auto contours = line.find("contours");
  if (contours == line.end() || !contours->is_object()) return line;
  const auto curves = contours->find("curves");
  if (curves == contours->end() || !curves->is_array()) return line;
  for (Json& curve : *curves)
    if (curve.is_object() && curve.contains("points")) flatten(curve["points"]);
  return line;
}

/// The key under which a number lies that is not finite; empty where there is none. `key`: of the value itself.
std::string key_of_no_number(const Json& value, const std::string& key) {
  if (value.is_number_float() && !std::isfinite(value.get<double>())) return key;
  if (!value.is_structured()) return {};
  for (const auto& [own, one] : value.items())
    if (auto found = key_of_no_number(one, value.is_object() ? own : key); !found.empty()) return found;
  return {};
}

/// Errors: a number that is not finite, which no line of a case can hold.
void check_all_finite(const Json& value, const std::string& subject) {
  if (const std::string key = key_of_no_number(value, subject); !key.empty())
    refuse(subject, "\"" + key + "\" holds a number that is not finite; take it out or replace it");
}

py::dict do_action(HeldCase& self, const py::object& action, const std::string& of) {
  if (!py::isinstance<py::dict>(action))
    refuse("action", "is a " + std::string(py::str(py::type::of(action).attr("__name__"))) +
                         "; give a dict, as {\"tool\": \"pull\", …}");
  const Json line = line_from(action.cast<py::dict>());
  check_all_finite(line, "action");
  auto step = parse_action(dumped(line));
  if (!step) refuse("action", step.error().what);
  if (!of.empty()) step->of = of;
  const bool adds = std::holds_alternative<SetStructure>(step->action);  // the structure itself
  if (!step->of.empty() && !adds && document_of(self)->structure(step->of) == nullptr)
    refuse("case", "has no structure \"" + step->of + "\"; structures says which there are");
  return apply(self, std::move(*step));
}

ShapeView shown(const Document& document, const std::string& of) {
  const auto view = document.view(of);
  if (!view)
    refuse(of.empty() ? "case" : of, "has no mesh in the frame that it shows; name another structure or frame");
  return *view;
}

/// A view of points that stay as they are when the case goes on.
py::array points_view(const HeldCase& self, const std::string& of) {
  const auto document = document_of(self);
  auto* kept = new std::shared_ptr<const Points>(shown(*document, of).shape.points);
  const py::capsule owner(kept, [](void* points) { delete static_cast<std::shared_ptr<const Points>*>(points); });
  return read_only<double>({(*kept)->rows(), 3}, (*kept)->data(), owner);
}

std::shared_ptr<HeldMesh> mesh_of(const HeldCase& self, const std::string& of) {
  const auto document = document_of(self);
  const MeshFile file = to_mesh_file(shown(*document, of), document->scan.frames() > 1);
  return std::make_shared<HeldMesh>(HeldMesh{std::make_shared<const MeshFile>(file)});
}

py::list structures_of(const HeldCase& self) {
  py::list rows;
  const auto document = document_of(self);
  for (const auto& one : document->structures) {
    py::dict row;
    row["id"] = one->id;
    row["name"] = one->name;
    row["label"] = one->label;
    row["vertices"] = one->the_template->points.rows();
    py::list frames;
    for (const auto& [frame, shape] : one->shapes) frames.append(frame);
    row["frames"] = frames;
    row["confidence"] = one->confidence < 0 ? py::none() : py::object(py::float_(one->confidence));
    row["doubt"] = one->doubt;
    rows.append(row);
  }
  return rows;
}

py::object image_of(const HeldCase& self) {
  const auto document = document_of(self);
  const Scan& scan = document->scan;
  if (!scan.image) return py::none();
  if (!self.image) {
    auto read = std::make_shared<VolumeRead>();
    read->volume = *scan.image;
    self.image = std::make_shared<HeldVolume>(HeldVolume{std::move(read), scan.source, self.image_stamp});
  }
  return py::cast(self.image);
}

// --- Automatic steps, each an edit of the case.

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
  return apply_with_report(self, {fitted.edit, of}, fitted.report.values);
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
  apply(self, {std::move(drawn), of});
  try {
    const auto now = document_of(self);
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
    return apply_with_report(self, {std::move(fitted.edit), of, true}, fitted.report.values);
  } catch (...) {
    apply(self, {Undo{}});  // the contours go with the fit
    throw;
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
  return apply_with_report(self, {std::move(snapped.edit), of}, snapped.report.values);
}

py::dict refine_into(HeldCase& self, const std::string& of, const py::object& progress) {
  const auto kept = document_of(self);
  const ShapeView view = shown(*kept, of);
  auto edit = computed<RefineEdit>(self, progress, [&](Progress& own) { return refine_shape(view, &own); });
  warn(edit.warnings);
  return apply(self, {std::move(edit.action), of});
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
  bool joined = false;
  for (SetPoints& action : edit.actions) {
    apply(self, {std::move(action), of, joined});
    joined = true;
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

/// [(key, example line, meaning)] of all actions, in their order.
py::list action_kinds() {
  py::list kinds;
  for_each_action_kind([&](const auto& kind) { kinds.append(py::make_tuple(kind.key, kind.example, kind.meaning)); });
  return kinds;
}

void add_automatic(py::class_<HeldCase, std::shared_ptr<HeldCase>>& type) {
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
            return edit ? py::object(apply(self, {std::move(*edit), of})) : py::none();
          },
          py::arg("of"), "Moves a structure out of its neighbours, as one edit; None where nothing meets.");
}

}  // namespace

void add_cases(py::module_& module) {
  using Held = HeldCase;
  const auto none = py::none();
  py::class_<HeldCase, std::shared_ptr<HeldCase>> type(
      module, "Case",
      "A scan, its structures and all edits. With a file, each edit is on the disk before the call returns.");
  type.def_static("open", &open_held, py::arg("path"), py::kw_only(), py::arg("read_only") = false,
                  py::arg("progress") = none, "Opens a case file; further edits are appended to it, unless read_only.")
      .def_static("create", &create_held, py::arg("template"), py::arg("image") = none, py::arg("path") = none,
                  py::kw_only(), py::arg("placement") = none, py::arg("overwrite") = false, py::arg("progress") = none,
                  R"(A new case; without `path` it is in memory alone.

template: a Mesh, a Fit, a file or a built-in name. image: a Volume, a file or a phantom's name. placement: {"rotation":
[w, x, y, z], "scale": s, "translation": [x, y, z]}, LPS mm; without it the middle of the image. overwrite: a file that
is there already is replaced.
Errors: the file is there already; a template or an image that is in memory alone, where the case has a file.)")
      .def_property_readonly(
          "source", [](const Held& self) { return self.source; }, "Its file, from the root; empty: it has none.")
      .def_property_readonly("_is_in_file",
                             [](const Held& self) {
                               const InUse held(self);
                               return self.is_written || !self.session.edited();
                             })
      .def(
          "do", &do_action, py::arg("action"), py::arg("of") = "",
          R"(Does one action, a dict as a line of the case file (docs/case-file.md): {"tool": "pull", "at": [x, y, z], "to":
[x, y, z], "sigma_mm": 10}. of: the structure's id. Gives moved_mm, stopped_by_guard, on, message. moved_mm: how far a
stroke moved the point that it holds; of all else how far vertices went on average.)")
      .def(
          "undo", [](Held& self) { return apply(self, {Undo{}}); }, "Takes the last step back.")
      .def(
          "redo", [](Held& self) { return apply(self, {Redo{}}); }, "Does the step again that was taken back last.")
      .def_property_readonly(
          "can_undo", [](const Held& self) { return InUse(self), self.session.can_undo(); },
          "Whether there is a step to take back.")
      .def_property_readonly(
          "can_redo", [](const Held& self) { return InUse(self), self.session.can_redo(); },
          "Whether there is one to do again.")
      .def(
          "undo_names", [](Held& self, std::size_t most) { return InUse(self), self.session.undo_names(most); },
          py::arg("most") = 100, "What undo would take back, the nearest first.")
      .def(
          "redo_names", [](Held& self, std::size_t most) { return InUse(self), self.session.redo_names(most); },
          py::arg("most") = 100, "What redo would do again, the nearest first.")
      .def("points", &points_view, py::arg("of") = "",
           "n×3, LPS mm, of a structure at the shown frame; a view that cannot be written to and that later edits "
           "leave as it is.")
      .def("mesh", &mesh_of, py::arg("of") = "", "The same as a Mesh, with stiffness and landmarks.")
      .def_property_readonly("structures", &structures_of, "[{id, name, label, vertices, frames, confidence, doubt}].")
      .def_property_readonly(
          "shown_frame", [](const Held& self) { return document_of(self)->frame; }, "From 0.")
      .def_property_readonly(
          "frames", [](const Held& self) { return document_of(self)->scan.frames(); }, "Of the image.")
      .def_property_readonly(
          "strokes", [](const Held& self) { return InUse(self), self.session.strokes(); }, "Those left after undo.")
      .def_property_readonly("image", &image_of, "The scan as a Volume, or None; the same one each time.")
      .def("save_as", &save_as, py::arg("path"), py::kw_only(), py::arg("overwrite") = false,
           "Writes the case to another file and goes on there. Refused where the file is there already, unless "
           "overwrite.")
      .def("close", &close, "Ends the work on its file. Later edits are refused.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](Held& self, const py::args&) { close(self); });
  add_automatic(type);
  module.def("action_kinds", &action_kinds, "[(key, example, meaning)] of all actions of a case.");
}

}  // namespace homolog::python
