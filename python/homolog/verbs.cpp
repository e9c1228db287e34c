#include <deque>

#include "app/verbs/program.h"
#include "app/verbs/read_image.h"
#include "python/homolog/binding.h"

namespace homolog::python {

namespace {

py::object run(const std::vector<std::string>& arguments,
               const std::vector<std::pair<std::string, std::shared_ptr<HeldVolume>>>& lent, const py::object& progress,
               const std::optional<int>& jobs) {
  std::deque<ImageInMemory> in_memory;
  for (const auto& [name, volume] : lent) in_memory.emplace_back(name, volume->read);
  bool wrong = false;
  std::optional<Result<Report>> done;
  do_watched({progress, jobs}, [&](Progress& own) { done.emplace(run_verb_here(arguments, own, wrong)); });
  const Result<Report>& report = *done;
  if (!report) throw Refusal(report.error().sentence(), wrong);
  warn(report->warnings);
  const py::object values = to_python(report->values);
  if (!report->refusal) return values;
  const py::object error = py::module_::import("homolog._core").attr("Error");
  const py::object raised = error(report->refusal->sentence());
  raised.attr("report") = values;
  PyErr_SetObject(error.ptr(), raised.ptr());
  throw py::error_already_set();
}

}  // namespace

void add_verbs(py::module_& module) {
  module.def(
      "run", &run, py::arg("arguments"), py::arg("lent"), py::arg("progress"), py::arg("jobs"),
      "Does a verb of the command line and gives its report. lent: [(name, volume)] that it reads by these names.");
}

}  // namespace homolog::python
