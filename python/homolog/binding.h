#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume_io.h"

// Things shared by the sources of the Python module. It is thin: it turns numpy arrays into what core takes, calls
// the functions that the verbs call, and gives arrays that are views of what came of them.

namespace homolog::python {

namespace py = pybind11;
using Json = nlohmann::ordered_json;

/// Becomes homolog.Error, or homolog.UsageError, with the sentence that the command line prints.
struct Refusal : std::runtime_error {
  explicit Refusal(const std::string& sentence, bool usage = false) : std::runtime_error(sentence), of_usage(usage) {}
  bool of_usage;
};

[[noreturn]] inline void refuse(const Error& error) {
  throw Refusal(error.sentence());
}
[[noreturn]] inline void refuse(const std::string& subject, const std::string& what) {
  refuse(Error{subject, what});
}

/// The value of a result; its error becomes an exception.
template <class T>
T value_of(Result<T> result) {
  if (!result) refuse(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// JSON as Python's dict, list, str, float, int, bool and None. Numbers that are not finite become None, as in a report
/// that is printed.
py::object to_python(const Json& json);
/// And back; numpy's numbers and arrays are taken too. Errors: what JSON does not know, a dict or list that holds
/// itself, a whole number beyond 64 bits.
Json to_json(const py::handle& value);

/// A sentence of the command line with Python's keywords for its options [_words.py]. `verb`: whose they are.
std::string in_python(const std::string& sentence, const std::vector<std::string>& verb = {});

/// Gives sentences to Python's warnings as homolog.HomologWarning.
void warn_as_given(const std::vector<std::string>& sentences);
/// The same for sentences of the command line.
void warn(const std::vector<std::string>& sentences);

/// How a long call is watched.
struct Watched {
  py::object progress;      ///< called with the share done (0…1) and what is in work; None: nobody is told
  std::optional<int> jobs;  ///< at most so many threads during the call
};

/// Does `work` on a thread of its own, without the interpreter's lock, so that other threads of Python go on. Meanwhile
/// it looks for Ctrl-C and tells `progress`, several times a second. KeyboardInterrupt, or what `progress` raises,
/// cancels the work and is raised once it has ended.
void do_watched(const Watched& watched, const std::function<void(Progress&)>& work);

/// The same for work that gives a Result.
template <class T>
T watched_value(const Watched& watched, const std::function<Result<T>(Progress&)>& work) {
  std::optional<Result<T>> result;
  do_watched(watched, [&](Progress& progress) { result.emplace(work(progress)); });
  return value_of(std::move(*result));
}

/// The state of a file when it was read: whoever holds what it held then takes the file for it no longer once it
/// differs.
class FileStamp {
 public:
  FileStamp() = default;
  explicit FileStamp(const std::filesystem::path& file);
  /// Whether the file is there and as it was; never of no file.
  bool holds() const;
  bool operator==(const FileStamp&) const = default;

 private:
  std::filesystem::path file_;
  std::filesystem::file_time_type written_{};
  std::uintmax_t bytes_ = 0;
};

/// A mesh that Python holds. It is never changed: its arrays are views of what it holds.
struct HeldMesh {
  std::shared_ptr<const MeshFile> file;
  std::string source{};  ///< the file it was read from, or a built-in name; empty: it was made here
  std::string record{};  ///< how it was made [app/verbs/record.h]; empty: nobody knows
  FileStamp stamp{};     ///< the stamp of `source`
};

/// A volume that Python holds, likewise.
struct HeldVolume {
  std::shared_ptr<const VolumeRead> read;
  std::string source{};
  FileStamp stamp{};
};
/// One that is a label map.
struct HeldLabels : HeldVolume {};

/// A mesh as it is given: one that is held, or a Fit for its mesh; null for whatever else.
std::shared_ptr<HeldMesh> mesh_in(const py::handle& value);
/// A label as it is asked for: a name, a number, or a list of them, as `--label` takes it. Errors: whatever else.
std::string label_text(const py::handle& value);
/// Text of the program in which names of files need not be UTF-8: what is none is escaped as os.fsdecode does it.
py::str text_of_system(const std::string& text);
/// The same back, as os.fsencode does it.
std::string text_to_system(const py::handle& text);
/// A path, or a name that stands for one, as str or what has __fspath__. Errors: whatever else; `name` and what is
/// `wanted` are named.
std::string path_from(const py::handle& value, const std::string& name, const std::string& wanted);

/// A view of memory that `owner` keeps; it cannot be written to.
py::array read_only(const py::dtype& type, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                    const void* data, const py::handle& owner);
/// The same of numbers that lie one behind the other.
template <class T>
py::array read_only(std::vector<py::ssize_t> shape, const T* data, const py::handle& owner) {
  std::vector<py::ssize_t> strides(shape.size(), static_cast<py::ssize_t>(sizeof(T)));
  for (std::size_t axis = shape.size(); axis-- > 1;) strides[axis - 1] = strides[axis] * shape[axis];
  return read_only(py::dtype::of<T>(), std::move(shape), std::move(strides), data, owner);
}

/// A numpy array of what is one, or of lists of numbers. Errors: none, of real numbers; one that hides some of its
/// values [numpy.ma].
py::array array_from(const py::handle& value, const std::string& name);
py::array numbers_from(const py::handle& value, const std::string& name);

/// n×3 finite numbers in reach, LPS mm; `name` begins the sentence. Copied.
Points points_from(const py::handle& value, const char* name);
/// One finite number for each of `count` vertices.
VertexScalars scalars_from(const py::handle& value, Eigen::Index count, const char* name);
/// Three finite numbers.
Vec3 vector_from(const py::handle& value, const char* name);

// Each source adds its part.
void add_volumes(py::module_& module);
void add_meshes(py::module_& module);
void add_models(py::module_& module);
void add_cases(py::module_& module);
void add_pictures(py::module_& module);
void add_verbs(py::module_& module);

}  // namespace homolog::python
