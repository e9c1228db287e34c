#include <charconv>
#include <cstdlib>
#include <cstring>

#include "app/version.h"
#include "core/base/pictures/picture_io.h"
#include "core/base/processes/confined.h"
#include "core/base/processes/parallel.h"
#include "python/homolog/binding.h"

namespace homolog::python {

namespace {

PyObject *error_type = nullptr, *usage_type = nullptr;

void add_exceptions(py::module_& module) {
  const auto add = [&](const char* name, const char* about, PyObject* base) {
    PyObject* type = PyErr_NewExceptionWithDoc((std::string("homolog.") + name).c_str(), about, base, nullptr);
    if (type == nullptr) throw py::error_already_set();
    module.add_object(name, type);
    return type;
  };
  error_type =
      add("Error", "The data or the system refused: the sentence that the command line prints.", PyExc_ValueError);
  usage_type =
      add("UsageError", "What was asked for makes no sense: the sentence of a wrong command line.", error_type);
  add("HomologWarning", "A sentence that the command line prints as a warning.", PyExc_UserWarning);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Refusal& refusal) {
      PyErr_SetObject(refusal.of_usage ? usage_type : error_type, text_of_system(refusal.what()).ptr());
    }
  });
}

/// As the command line: HOMOLOG_THREADS says how many threads are used at most.
void limit_threads_as_told() {
  const char* const wanted = std::getenv("HOMOLOG_THREADS");
  if (wanted == nullptr) return;
  int threads = 0;
  const char* const end = wanted + std::strlen(wanted);
  const auto [stop, error] = std::from_chars(wanted, end, threads);
  if (error != std::errc() || stop != end || threads < 1 || threads > 1024)
    refuse("HOMOLOG_THREADS", std::string("is \"") + wanted + "\"; give a whole number from 1 to 1024");
  set_thread_limit(threads);
}

}  // namespace

}  // namespace homolog::python

PYBIND11_MODULE(_core, module) {
  using namespace homolog::python;
  module.doc() = "The compiled part of homolog.";
  module.attr("__version__") = homolog::version;
  add_exceptions(module);
  limit_threads_as_told();
  module.def("use_picture_module", &homolog::use_picture_module, py::arg("path"));
  module.def("use_reader", &homolog::use_program_for_children, py::arg("path"));
  module.def("thread_limit", &homolog::thread_limit, "How many threads are used at most.");
  module.def(
      "set_thread_limit",
      [](int threads) {
        if (threads < 1 || threads > 1024) refuse("threads", "is out of range; give a number from 1 to 1024");
        homolog::set_thread_limit(threads);
      },
      py::arg("threads"), "Sets how many threads are used at most. No result depends on it.");
  add_volumes(module);
  add_meshes(module);
  add_models(module);
  add_cases(module);
  add_pictures(module);
  add_verbs(module);
}
