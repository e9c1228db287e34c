#include <cmath>

#include "core/case/action_json.h"
#include "core/case/action_line.h"
#include "python/homolog/case_parts.h"

// Actions as Python gives them; undo and redo.

namespace homolog::python {

namespace {

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

/// What became of the case's file since: another program changed it, or another process that this one was copied to.
std::string news_of(EditSession& session) {
  std::string news = session.news();
  session.forget_news();
  if (!news.empty() && session.journal() != nullptr)
    news += " The edits are in " + session.journal()->path().string() + ".";
  return news;
}

}  // namespace

py::dict apply(HeldCase& self, EditStep step, const std::shared_ptr<const Document>& since) {
  std::optional<Result<EditReport>> done;
  const bool is_stroke = std::holds_alternative<Stroke>(step.action);
  double moved_mm = 0;
  std::string news;
  {
    const InUse held(self);
    check_takes_edits(self);
    if (since != nullptr && self.session.shared_document() != since)
      refuse("case", "was edited by another call while this one was at work; call it again");
    const py::gil_scoped_release unlocked;
    const auto before = self.session.shared_document();
    done.emplace(self.session.apply(std::move(step)));
    if (*done) moved_mm = is_stroke ? (*done)->moved_mm : mean_way_mm(*before, self.session.document());
    news = news_of(self.session);
  }
  if (!news.empty()) warn({news});
  return report_of(value_of(std::move(*done)), moved_mm);
}

namespace {

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

}  // namespace

void add_case_edits(CaseType& type) {
  using Held = HeldCase;
  type.def(
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
          py::arg("most") = 100, "What redo would do again, the nearest first.");
}

}  // namespace homolog::python
