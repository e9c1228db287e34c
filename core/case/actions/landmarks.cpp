#include "core/case/actions/landmarks.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "core/case/actions/fields.h"
#include "core/case/held_landmarks.h"
#include "core/case/placing.h"
#include "core/mesh/geometry/surface_search.h"

namespace homolog {

namespace {

constexpr Names<LandmarkPull, 3> fit_names{
    {{"off", LandmarkPull::off}, {"similarity", LandmarkPull::similarity}, {"warp", LandmarkPull::warp}}};

Result<void> check_landmark(const std::string& name, const std::optional<Vec3>& at) {
  if (name.empty() || (at && !at->allFinite())) return fail("landmark", "needs a name and a finite position");
  return {};
}

Result<EditReport> apply_landmark(const PlaceLandmark& action, ShapeEdit& edit) {
  if (auto usable = check_landmark(action.name, action.at); !usable) return fail(usable.error());
  Shape& shape = edit.after;
  if (action.at)
    shape.landmarks.insert_or_assign(action.name, *action.at);
  else
    shape.landmarks.erase(action.name);
  const Template& the_template = edit.before.the_template();
  const LandmarkRules& rules = edit.before.structure.landmarks;
  const auto& known = edit.before.shape.landmarks;
  const auto before = known.find(action.name);
  if (rules.hold && action.at && before != known.end() && before->second == *action.at) {
    // It stays where it is: to hold the mesh there, or to let it go, is what is asked for.
    for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
      if (the_template.landmarks[l].name != action.name) continue;
      if (action.held && !landmark_hold(the_template, l, shape).met) continue;
      hold_landmark(the_template, l, action.held, shape);
      return EditReport{};
    }
  }
  return carry_to_landmarks(the_template, rules.pull, rules.rule, shape);
}

Result<EditReport> apply_landmark_pull(const SetLandmarkPull& action, StructureEdit& edit) {
  edit.after.landmarks.pull = action.fit;
  Shape shape = edit.shape();
  const Template& the_template = *edit.before.the_template;
  if (shape.strokes == 0) start_anew(the_template, shape);
  auto report = carry_to_landmarks(the_template, action.fit, edit.before.landmarks.rule, shape);
  edit.after.set_shape(edit.document.frame, std::move(shape));
  return report;
}

Result<EditReport> apply_template_landmark(const SetTemplateLandmark& action, StructureEdit& edit) {
  if (auto usable = check_landmark(action.name, action.at); !usable) return fail(usable.error());
  const Template& the_template = *edit.before.the_template;
  MeshFile file = to_mesh_file(the_template);
  const auto known = std::find_if(file.landmarks.begin(), file.landmarks.end(),
                                  [&](const Landmark& landmark) { return landmark.name == action.name; });
  if (action.at) {
    const SurfacePoint on = nearest_on_surface(*the_template.topology, *edit.shape().points, *action.at).at;
    const Vec3 position = on.interpolate(*the_template.topology, the_template.points).transpose();
    if (known != file.landmarks.end())
      known->position = position;
    else
      file.landmarks.push_back({action.name, position});
  } else {
    if (known == file.landmarks.end())
      return fail("landmark", "\"" + excerpt(action.name) + "\" is none of the template's");
    file.landmarks.erase(known);
  }
  edit.after.the_template = with_landmarks(the_template, std::move(file.landmarks));
  return EditReport{};
}

/// Spells both kinds of landmark.
template <class A>
void spell_landmark(Fields& line, A& action) {
  Fields landmark = line.object(action_kind(action).key);
  landmark.member("name", action.name);
  landmark.or_null("at", action.at);
  if constexpr (std::is_same_v<A, PlaceLandmark>) landmark.optional("held", action.held, !action.held);
}

}  // namespace

const ActionKind<PlaceLandmark>& action_kind(const PlaceLandmark&) {
  static constexpr ActionKind<PlaceLandmark> kind{
      .key = "landmark",
      .example = R"({"landmark":{"name":"hilum","at":[-21,20,-9]}})",
      .meaning =
          "places a landmark; `\"at\":null` takes it away. In a case whose first line has `\"held_landmarks\":true` "
          "the "
          "mesh is held from then on where it meets the landmark, and `\"held\":false` lets it go there",
      .name = [](const PlaceLandmark& action) { return (action.held ? "landmark " : "release of ") + action.name; },
      .spell = spell_landmark<PlaceLandmark>,
      .apply = apply_landmark};
  return kind;
}

const ActionKind<SetLandmarkPull>& action_kind(const SetLandmarkPull&) {
  static constexpr ActionKind<SetLandmarkPull> kind{
      .key = "landmark_fit",
      .example = R"({"landmark_fit":"warp"})",
      .meaning = "how landmarks carry the template before the first stroke: `off`, `similarity` or `warp`",
      .name = [](const SetLandmarkPull&) -> std::string { return "landmark fit"; },
      .spell = [](Fields& line, SetLandmarkPull& action) { line.member("landmark_fit", fit_names, action.fit); },
      .apply = apply_landmark_pull};
  return kind;
}

const ActionKind<SetTemplateLandmark>& action_kind(const SetTemplateLandmark&) {
  static constexpr ActionKind<SetTemplateLandmark> kind{
      .key = "template_landmark",
      .example = R"({"template_landmark":{"name":"apex","at":[-21,20,-9]}})",
      .meaning = "names the template's point nearest to `at` on the mesh; `\"at\":null` takes the name away",
      .name = [](const SetTemplateLandmark& action) { return "template landmark " + action.name; },
      .spell = spell_landmark<SetTemplateLandmark>,
      .apply = apply_template_landmark};
  return kind;
}

}  // namespace homolog
