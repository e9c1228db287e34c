#include "core/case/action_line.h"
#include "core/deform/stroke_kinds.h"
#include "python/homolog/case_parts.h"

namespace homolog::python {

namespace {

/// [(key, example line, meaning)] of all actions, in their order.
py::list action_kinds() {
  py::list kinds;
  for_each_action_kind([&](const auto& kind) { kinds.append(py::make_tuple(kind.key, kind.example, kind.meaning)); });
  return kinds;
}

/// The names of the strokes that are drags, in their order.
py::list drag_tools() {
  py::list names;
  for (const StrokeKind& kind : stroke_kinds)
    if (!kind.is_dab()) names.append(kind.name);
  return names;
}

}  // namespace

void add_cases(py::module_& module) {
  CaseType type(module, "Case",
                "A scan, its structures and all edits. With a file, each edit is on the disk before the call returns.");
  add_case_files(type);
  add_case_edits(type);
  add_case_fits(type);
  add_case_views(type);
  module.def("drag_tools", &drag_tools, "The tools whose strokes are drags.");
  module.def("action_kinds", &action_kinds, "[(key, example, meaning)] of all actions of a case.");
}

}  // namespace homolog::python
