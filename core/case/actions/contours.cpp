#include "core/case/actions/contours.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/numbers/limits.h"
#include "core/case/actions/fields.h"

namespace homolog {

namespace {

constexpr Names<bool, 2> side_names{{{"boundary", false}, {"outside", true}}};

void spell_contours(Fields& line, SetContours& action) {
  Fields contours = line.object("contours");
  contours.member("id", action.id);
  contours.optional("name", action.name);
  contours.optional("off_mm", action.off_mm);
  if (line.reads() ? contours.has("side") : action.outside.has_value()) {
    bool outside = action.outside.value_or(false);
    contours.member("side", side_names, outside);
    action.outside = outside;
  }
  contours.optional("curve", action.curve);
  if (line.reads() ? !contours.has("curves") : action.curves == nullptr) return;
  Fields::Json curves = action.curves ? curves_to_json(*action.curves) : Fields::Json();
  contours.member("curves", curves);
  if (line.reads()) action.curves = std::make_shared<const std::vector<Contour>>(curves_from_json(curves));
}

std::string quoted_set(const std::string& id) {
  return "\"" + excerpt(id) + "\"";
}

Result<EditReport> apply_contours(const SetContours& action, StructureEdit& edit) {
  if (action.id.empty()) return fail("contours", "need an id");
  if (!is_utf8(action.id) || !is_utf8(action.name.value_or("")))
    return fail("contours", "have a name that is no UTF-8; rename them");
  if (action.off_mm && !(*action.off_mm >= 0 && is_in_reach(*action.off_mm)))
    return fail("off_mm", "must be 0 mm or more");
  const ContourSet* known = edit.before.contour_set(action.id);
  if (known == nullptr && (!action.curves || action.curve))
    return fail("contours", quoted_set(action.id) + " do not exist; give their curves");
  if (known != nullptr && action.curves && !action.curve)
    return fail("contours", quoted_set(action.id) + " exist already; give the new ones another id");
  if (action.curve && !(action.curves && action.curves->size() == 1))
    return fail("contours", "need one curve in the place of another");
  if (action.curve && (*action.curve < 0 || *action.curve >= std::ssize(known->curves)))
    return fail("contours", quoted_set(action.id) + " have no curve " + std::to_string(*action.curve) + "; they have " +
                                std::to_string(known->curves.size()) + ", from 0");
  if (action.curves)
    if (auto usable = check_curves(*action.curves); !usable) return fail(usable.error());
  ContourSet set = known != nullptr ? *known : ContourSet{.id = action.id, .frame = edit.document.frame};
  set.name = action.name.value_or(set.name);
  set.off_mm = action.off_mm.value_or(set.off_mm);
  set.outside = action.outside.value_or(set.outside);
  auto& all = edit.after.contours;
  if (action.curve) set.curves[*action.curve] = action.curves->front();
  if (known == nullptr) {
    set.curves = *action.curves;
    all.push_back(std::make_shared<const ContourSet>(std::move(set)));
    return EditReport{};
  }
  *std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.get() == known; }) =
      std::make_shared<const ContourSet>(std::move(set));
  return EditReport{};
}

Result<EditReport> apply_contours_removal(const RemoveContours& action, StructureEdit& edit) {
  if (std::erase_if(edit.after.contours, [&](const auto& one) { return one->id == action.id; }) == 0)
    return fail("contours", quoted_set(action.id) + " do not exist");
  return EditReport{};
}

}  // namespace

nlohmann::ordered_json curves_to_json(const std::vector<Contour>& curves) {
  auto json = Fields::Json::array();
  for (const Contour& curve : curves) {
    std::vector<double> points;
    for (const Vec3& p : curve.points) points.insert(points.end(), p.begin(), p.end());
    Fields::Json one = Fields::Json::object();
    Fields members = Fields::writer(one);
    bool closed = curve.closed, cuts_out = curve.cuts_out;
    members.member("points", points);
    members.optional("closed", closed, !closed);
    members.optional("cuts_out", cuts_out, cuts_out);
    json.push_back(std::move(one));
  }
  return json;
}

std::vector<Contour> curves_from_json(const nlohmann::ordered_json& json) {
  if (!json.is_array()) throw Unreadable{"\"curves\" is not a list"};
  std::vector<Contour> curves;
  for (const auto& one : json) {
    const std::string which = "curve " + std::to_string(curves.size()) + " of \"curves\" ";
    if (!one.is_object()) throw Unreadable{which + "is no object; give {\"points\": [x, y, z, x, …]}"};
    Fields members = Fields::reader(one);
    Contour curve;
    std::vector<double> points;
    const auto given = one.find("points");
    if (given == one.end() || !given->is_array() ||
        !std::ranges::all_of(*given, [](const auto& number) { return number.is_number(); }))
      throw Unreadable{which +
                       "has no \"points\" that are one list of numbers; give x, y, z of each, behind one another"};
    members.member("points", points);
    members.optional("closed", curve.closed);
    members.optional("cuts_out", curve.cuts_out);
    if (points.size() % 3 != 0)
      throw Unreadable{which + "has \"points\" that are not x, y, z of each point; give three for each"};
    for (std::size_t k = 0; k < points.size(); k += 3)
      curve.points.emplace_back(points[k], points[k + 1], points[k + 2]);
    curves.push_back(std::move(curve));
  }
  return curves;
}

Result<void> check_curves(const std::vector<Contour>& curves) {
  if (curves.empty()) return fail("contours", "need a curve");
  for (const Contour& curve : curves) {
    if (curve.points.size() < (curve.closed ? 3U : 2U))
      return fail("contours", "have a curve of too few points; draw it to its end");
    if (!std::all_of(curve.points.begin(), curve.points.end(), [](const Vec3& p) { return all_in_reach(p); }))
      return fail("contours", std::string("have a point that ") + beyond_farthest);
  }
  return {};
}

const ActionKind<SetContours>& action_kind(const SetContours&) {
  static constexpr ActionKind<SetContours> kind{
      .key = "contours",
      .example =
          R"({"contours":{"id":"c1","name":"left kidney","off_mm":0.5,"side":"boundary","curves":[{"points":[-21,20,-9,-19,25,-9,-14,22,-9]}]}})",
      .meaning =
          "adds curves that somebody drew of the organ in the shown frame: x, y, z of the first point, then of the "
          "next. They are closed but for those with `\"closed\":false`. `off_mm` is how far they may lie off the "
          "boundary (standard deviation). With `\"side\":\"outside\"` they are not the boundary: the organ lies inside "
          "of them. The same id again, without `curves`, changes the name, `off_mm` or `side`; with `curve`, the "
          "number of one of its curves from 0, the one in `curves` takes its place. Older versions refuse this line",
      .needs_mesh = false,
      .name =
          [](const SetContours& action) {
            return (action.curves && !action.curve ? "contour " : "change of contour ") +
                   action.name.value_or(action.id);
          },
      .spell = spell_contours,
      .apply = apply_contours};
  return kind;
}

const ActionKind<RemoveContours>& action_kind(const RemoveContours&) {
  static constexpr ActionKind<RemoveContours> kind{
      .key = "remove_contours",
      .example = R"({"remove_contours":"c1"})",
      .meaning = "takes curves away",
      .needs_mesh = false,
      .name = [](const RemoveContours& action) { return "removal of contour " + action.id; },
      .spell = [](Fields& line, RemoveContours& action) { line.member("remove_contours", action.id); },
      .apply = apply_contours_removal};
  return kind;
}

}  // namespace homolog
