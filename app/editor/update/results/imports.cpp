#include "app/editor/update/results/imports.h"

#include <algorithm>
#include <cmath>

#include "app/editor/update/editing.h"
#include "core/adapt/labels/choose_closing.h"
#include "core/base/files/paths.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/curve_io.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/model/files/statismo.h"
#include "core/template_making/template_file.h"
#include "core/volume/referenced_images.h"

namespace homolog {

namespace {

/// The values that a mesh file has for the template's vertices.
Result<VertexScalars> stiffness_in(const std::filesystem::path& path, const Topology& topology) {
  auto read = read_mesh_file(path);
  if (!read) return fail(read.error());
  const std::string name = path.filename().string();
  std::optional<VertexScalars> factors;
  if (read->stiffness) factors = *read->stiffness;
  if (!factors && read->arrays.size() == 1) factors = read->arrays.begin()->second;
  if (!factors) {
    std::string names;
    for (const auto& [array, values] : read->arrays) names += (names.empty() ? "" : ", ") + array;
    return fail(name, names.empty()
                          ? "has no value for each vertex; add one with the name \"stiffness\"."
                          : "has several values for each vertex (" + names + "); rename one of them to \"stiffness\".");
  }
  if (read->triangles.rows() > 0 && read->triangles != topology.triangles())
    return fail(name,
                "has other faces than the template, so its vertices are not the same; save the values on the "
                "template's own mesh.");
  return std::move(*factors);
}

/// Landmarks in the template's own frame, with the place of each on its surface.
struct OnTemplate {
  std::vector<std::pair<std::string, SurfacePoint>> landmarks;
  std::string away;  ///< "apex (34 mm), base (40 mm)": what lies off the surface
};

Result<OnTemplate> landmarks_on(const std::filesystem::path& path, const Template& the_template) {
  constexpr double most_mm = 10;
  const auto read = read_landmarks(path);
  if (!read) return fail(read.error());
  const SurfaceSearch search({the_template.topology, the_template.points});
  OnTemplate found;
  for (const Landmark& landmark : *read) {
    const auto nearest = search.nearest(landmark.position);
    if (nearest.distance_mm <= most_mm)
      found.landmarks.emplace_back(landmark.name, nearest.at);
    else
      found.away += (found.away.empty() ? "" : ", ") + landmark.name + " (" +
                    std::to_string(std::lround(nearest.distance_mm)) + " mm)";
  }
  return found;
}

Result<void> write_template(const TemplateMaking& making, const std::filesystem::path& path) {
  const TemplateSettings& settings = making.settings;
  MeshFile file = settings.part && !settings.tube
                      ? faced_template_file(*making.mesh, making.source, making.faced, faced_options(settings))
                      : template_file(*making.mesh, settings.tube ? provenance_of(making.source, settings.tube_options)
                                                                  : provenance_of(making.source, settings.mask));
  mark_cut(file, making.cut);
  if (making.closing_mm) file.comments.push_back(closing_comment(*making.closing_mm));
  if (!making.missing.empty()) file.comments.push_back(missing_share_comment(making.missing_share));
  return write_mesh_file(file, path);
}

/// Reads a file beside the window with `read`, and hands what it gives to `take`, where the case is still the same, and
/// the structure that is worked on is still `of`. Without `of` that may be another one by then.
template <class Done, class Read, class Take>
void read_for_case(Editing& editing, const Done& command, Read read, Take take,
                   const std::optional<std::string>& of = {}) {
  const std::uint64_t number = editing.shown.number();
  auto reading = [command, number, of, read = std::move(read),
                  take = std::move(take)](Progress&) -> Result<Work::Then> {
    auto got = read(command.value);
    if (!got) return fail(got.error());
    using Value = typename decltype(got)::value_type;
    const auto value = std::make_shared<const Value>(std::move(*got));
    return Work::Then([command, number, of, take, value](Editing& then) {
      const bool other_case = number != then.shown.number();
      if (other_case || (of && (then.structure() == nullptr || then.structure()->id != *of)))
        return add_notice(then.state,
                          command.value.filename().string() + " was not imported, because another " +
                              (other_case ? "case was opened" : "structure was chosen") +
                              " meanwhile. Import it again.",
                          false);
      then.log.is_done(command);
      take(then, *value);
    });
  };
  editing.work.imports.queue(command.value.string(), std::move(reading));
}

/// The warning that contours were perhaps drawn on other images than that on the screen. Errors: they were.
Result<std::optional<std::string>> check_contours(const std::string& name, const Contours& read, const Volume* image) {
  if (image == nullptr) return std::nullopt;
  auto other = check_scan(name, read.frame_of_reference, read.referenced, "the image on the screen", *image);
  if (!other) return other;
  for (const ContourRoi& roi : read.rois)
    for (const Contour& curve : roi.contours)
      for (const Vec3& p : curve.points)
        if (image->geometry.holds(p)) return other;
  return fail(name, "lies outside of the image on the screen; open the scan that it was drawn on");
}

/// The structure of the case that is called like one of a file; null: none is.
const Structure* called_like(const Document& document, const std::string& name) {
  for (const auto& one : document.structures)
    if (lower_case(structure_name(*one)) == lower_case(name)) return one.get();
  return nullptr;
}

void take_contours(Editing& editing, const std::string& name, const Contours& read) {
  EditorState& state = editing.state;
  const Document& document = *editing.shown.snapshot().document;
  const auto other = check_contours(name, read, document.scan.image.get());
  if (!other) return add_notice(state, other.error().sentence() + ".");
  if (*other) add_notice(state, **other + ".", false);
  for (const std::string& warning : read.warnings) add_notice(state, warning + ".", false);
  state.wanted_section = contours_section;
  ++state.section_wanted;
  state.automatic.offered = {};
  std::vector<const ContourRoi*> drawn;
  for (const ContourRoi& roi : read.rois)
    if (!roi.contours.empty()) drawn.push_back(&roi);
  if (drawn.empty()) return add_notice(state, name + ": has no contours in any of its structures; draw some.");
  if (drawn.size() == 1 && editing.structure() != nullptr) {
    add_contours(editing, *drawn.front(), *editing.structure(), false);
    return;
  }
  Contours others = read;
  others.rois.clear();
  bool joined = false;
  for (const ContourRoi* roi : drawn)
    if (const Structure* structure = called_like(document, roi->name); structure != nullptr)
      joined = add_contours(editing, *roi, *structure, joined) || joined;
    else
      others.rois.push_back(*roi);
  if (others.rois.empty()) return;
  const std::string count = std::to_string(others.rois.size()) + (joined ? " more structure" : " structure") +
                            (others.rois.size() == 1 ? "" : "s");
  state.automatic.offered = {name, std::make_shared<const Contours>(std::move(others))};
  add_notice(state,
             name + (drawn.size() == 1 ? " holds contours. Load a template, then add them in the section Contours."
                                       : " holds " + count + ". Choose what to add in the section Contours."),
             false);
}

}  // namespace

bool add_contours(Editing& editing, const ContourRoi& roi, const Structure& structure, bool joined) {
  if (editing.state.look.structures.locks(structure.id)) {
    add_notice(editing.state, locked_sentence(structure), false);
    return false;
  }
  stop_playing(editing);
  // Edits that were posted before and are not done yet may take the next ids.
  const auto taken = [&](const std::string& id) {
    return std::ranges::any_of(editing.shown.snapshot().document->structures,
                               [&](const auto& one) { return one->contour_set(id) != nullptr; });
  };
  std::string id = "file" + std::to_string(roi.number);
  for (int again = 2; taken(id); ++again) id = "file" + std::to_string(roi.number) + "-" + std::to_string(again);
  SetContours action{.id = id, .name = roi.name, .curves = std::make_shared<const std::vector<Contour>>(roi.contours)};
  editing.shown.session().apply(std::move(action), joined, structure.id);
  return true;
}

void import_contours(Editing& editing, const std::filesystem::path& path) {
  read_for_case(
      editing, OpenContours{path}, [](const auto& file) { return read_curves(file); },
      [name = path.filename().string()](Editing& then, const Contours& read) { take_contours(then, name, read); });
}

void import_landmarks(Editing& editing, const std::filesystem::path& path) {
  if (lacks_template(editing)) return;
  read_for_case(
      editing, ImportLandmarks{path}, [](const auto& file) { return read_landmarks(file); },
      [name = path.filename().string()](Editing& then, const std::vector<Landmark>& read) {
        const auto known = landmarks_of_template(read, *then.structure()->the_template);
        if (known.empty())
          return add_notice(
              then.state,
              name + ": no name in it is a landmark of the template. Rename its points as in the list (Place).");
        stop_playing(then);
        then.state.hand.landmark.clear();
        for (std::size_t i = 0; i < known.size(); ++i)
          then.apply(PlaceLandmark{known[i].name, known[i].position}, i > 0);
        if (known.size() < read.size())
          add_notice(then.state,
                     name + ": " + std::to_string(read.size() - known.size()) + " of " + std::to_string(read.size()) +
                         " points left out: the template has no landmark with their name.",
                     false);
      },
      editing.structure()->id);
}

void open_fit_model(Editing& editing, const std::filesystem::path& path) {
  read_for_case(
      editing, OpenFitModel{path}, [](const auto& file) { return read_model(file); },
      [path](Editing& then, const ShapeModel& model) {
        then.state.automatic.fit_model = std::make_shared<const ShapeModel>(model);
        then.state.automatic.fit_model_file = path;
        then.state.automatic.fit_settings.model = FitModel::file;
      });
}

void open_score_model(Editing& editing, const std::filesystem::path& path) {
  read_for_case(
      editing, OpenScoreModel{path}, [](const auto& file) { return read_model(file); },
      [path](Editing& then, const ShapeModel& model) {
        Scoring& scoring = then.state.scoring;
        scoring.of_file = std::make_shared<const ShapeModel>(model);
        scoring.file = path;
        scoring.by_file = true;
      });
}

void import_stiffness(Editing& editing, const std::filesystem::path& path) {
  if (lacks_template(editing)) return;
  const auto topology = editing.structure()->the_template->topology;
  read_for_case(
      editing, ImportStiffness{path}, [topology](const auto& file) { return stiffness_in(file, *topology); },
      [](Editing& then, const VertexScalars& factors) {
        then.apply(SetStiffnessFactors{std::make_shared<const VertexScalars>(factors)});
      },
      editing.structure()->id);
}

void import_template_landmarks(Editing& editing, const std::filesystem::path& path) {
  if (lacks_template(editing)) return;
  read_for_case(
      editing, ImportTemplateLandmarks{path},
      [the_template = editing.structure()->the_template](const auto& file) {
        return landmarks_on(file, *the_template);
      },
      [name = path.filename().string()](Editing& then, const OnTemplate& found) {
        const auto shown = active_shape(then.state, *then.shown.snapshot().document);
        bool joined = false;
        for (const auto& [landmark, at] : found.landmarks) {
          if (!shown) break;
          const Vec3 on_mesh = at.interpolate(*shown->the_template().topology, *shown->shape.points).transpose();
          then.apply(SetTemplateLandmark{landmark, on_mesh}, std::exchange(joined, true));
        }
        if (!found.away.empty())
          add_notice(then.state, name + ": points too far from the template were left out: " + found.away +
                                     ". Check that they are in the template's own coordinates.");
      },
      editing.structure()->id);
}

void save_template(Editing& editing, const std::filesystem::path& path) {
  if (lacks_template(editing)) return;
  // Strokes before the painting are played with the template as it was.
  for (const auto& structure : editing.shown.snapshot().document->structures) {
    std::error_code ignored;
    if (std::filesystem::equivalent(path, structure->the_template->source, ignored))
      return add_notice(editing.state,
                        path.filename().string() +
                            " is the template that this case began with, and has to stay as it is. Save the painted "
                            "template under another name.");
  }
  // Read back beside the window: the next image comes with what the file holds.
  const auto saved = std::make_shared<std::shared_ptr<const Template>>();
  const auto write = [file = painted_template(*active_structure(editing.state, *editing.shown.snapshot().document)),
                      path, saved](Progress&) {
    if (auto written = write_mesh_file(file, path); !written) return written;
    auto read = load_template(path.string());
    if (!read) return Result<void>(fail(read.error()));
    *saved = std::move(*read);
    return Result<void>();
  };
  const Document& document = *editing.shown.snapshot().document;
  // New images begin with the template of the first structure.
  const bool is_first = active_structure(editing.state, document) == document.structure();
  editing.work.exports.start(path, write, [&editing, saved, path, is_first, number = editing.shown.number()] {
    if (!is_first || number != editing.shown.number()) return;  // another case is open by now
    editing.shown.adopt_template(*saved);
    editing.apply(Note{"the template was saved", std::nullopt, absolute_path(path).string()});
    const std::string written = "Written: " + path.string();
    std::erase_if(editing.state.notices, [&](const Notice& notice) { return notice.text == written; });
    add_notice(
        editing.state,
        written + ". The case goes on with " + path.filename().string() + ". Images that you open next use it too.",
        false);
  });
}

void use_made_template(Editing& editing, const std::filesystem::path& path) {
  const auto making = editing.work.template_maker.latest();
  if (!making || !making->mesh) return;
  editing.work.exports.start(
      path, [making, path](Progress&) { return write_template(*making, path); },
      // Whoever takes the result does this, on the window's thread, while the editor lives.
      [&editing, making, path] {
        if (editing.work.template_maker.latest() == making) close_template_making(editing);  // no other was begun
        OpenRequested open = open_template(path.string());
        open.request.template_in_place = true;
        editing.out.send(std::move(open));
      });
}

void close_template_making(Editing& editing) {
  editing.state.look.making_shown = false;
  editing.work.template_maker.forget();
}

}  // namespace homolog
