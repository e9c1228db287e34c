#include <deque>
#include <map>

#include "app/verbs/program.h"
#include "app/verbs/read_image.h"
#include "python/homolog/binding.h"

namespace homolog::python {

namespace {

/// What sentences call files that stand for objects in memory.
using Called = std::map<std::string, std::string>;
using Lent = std::vector<std::pair<std::string, std::shared_ptr<HeldVolume>>>;

/// What calls of all threads lend now by the names of files, and as what these were read. The interpreter's lock keeps
/// it.
std::map<std::string, std::pair<FileStamp, int>> lent_files;

/// Lends volumes to a verb for a while. Errors: a file that another call lends as it was before somebody wrote it anew,
/// since a verb could not tell the two apart.
class Lending {
 public:
  explicit Lending(const Lent& lent) {
    for (const auto& [name, volume] : lent)
      if (const auto other = lent_files.find(name);
          name == volume->source && other != lent_files.end() && !(other->second.first == volume->stamp))
        refuse(name, "was written anew while another call works with what it held before; wait for that call");
    for (const auto& [name, volume] : lent) {
      in_memory_.emplace_back(name, volume->read);
      if (name != volume->source) continue;
      ++lent_files.try_emplace(name, volume->stamp, 0).first->second.second;
      files_.push_back(name);
    }
  }
  ~Lending() {
    for (const std::string& name : files_)
      if (const auto one = lent_files.find(name); --one->second.second == 0) lent_files.erase(one);
  }
  Lending(const Lending&) = delete;
  Lending& operator=(const Lending&) = delete;

 private:
  std::deque<ImageInMemory> in_memory_;
  std::vector<std::string> files_;
};

/// A sentence that names objects in memory as the caller knows them.
std::string in_callers_words(std::string sentence, const Called& called) {
  for (const auto& [file, word] : called)
    for (std::size_t at = sentence.find(file); at != std::string::npos; at = sentence.find(file, at + word.size()))
      sentence.replace(at, file.size(), word);
  return sentence;
}

py::object run(const std::vector<std::string>& arguments, const Lent& lent, const py::object& progress,
               const std::optional<int>& jobs, const Called& called, const std::vector<std::string>& verb) {
  const Lending lending(lent);
  bool wrong = false;
  std::optional<Result<Report>> done;
  do_watched({progress, jobs}, [&](Progress& own) { done.emplace(run_verb_here(arguments, own, wrong)); });
  const Result<Report>& report = *done;
  if (!report) throw Refusal(in_callers_words(report.error().sentence(), called), wrong);
  std::vector<std::string> warnings = report->warnings;
  for (std::string& warning : warnings) {
    warning = in_callers_words(std::move(warning), called);
    if (!verb.empty()) warning = in_python(warning, verb);
  }
  warn_as_given(warnings);
  const py::object values = to_python(report->values);
  if (!report->refusal) return values;
  const py::object error = py::module_::import("homolog._core").attr("Error");
  const py::object raised = error(text_of_system(in_callers_words(report->refusal->sentence(), called)));
  raised.attr("report") = values;
  PyErr_SetObject(error.ptr(), raised.ptr());
  throw py::error_already_set();
}

}  // namespace

void add_verbs(py::module_& module) {
  module.def(
      "run", &run, py::arg("arguments"), py::arg("lent"), py::arg("progress"), py::arg("jobs"),
      py::arg("called") = Called(), py::arg("verb") = std::vector<std::string>(),
      "Does a verb of the command line and gives its report. lent: [(name, volume)] that it reads by these names. "
      "called: {file: word}: what sentences call a file that stands for an object. verb: its words, for warnings in "
      "Python's keywords; empty: they name options.");
}

}  // namespace homolog::python
