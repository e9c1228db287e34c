#include "python/homolog/binding.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include "app/verbs/case_pool.h"
#include "core/base/numbers/limits.h"
#include "core/base/processes/parallel.h"

namespace homolog::python {

namespace {

/// While it lives, at most so many threads are used. Of several that live at a time the lowest number holds.
class FewerThreads {
 public:
  explicit FewerThreads(std::optional<int> jobs) : jobs_(jobs) {
    if (!jobs) return;
    if (*jobs < 1 || *jobs > 1024) refuse("jobs", "is " + std::to_string(*jobs) + "; give a number from 1 to 1024");
    const std::lock_guard lock(mutex_);
    if (asked_.empty()) before_ = thread_limit();
    asked_.insert(*jobs);
    set_thread_limit(*asked_.begin());
  }
  ~FewerThreads() {
    if (!jobs_) return;
    const std::lock_guard lock(mutex_);
    asked_.erase(asked_.find(*jobs_));
    set_thread_limit(asked_.empty() ? before_ : *asked_.begin());
  }
  FewerThreads(const FewerThreads&) = delete;
  FewerThreads& operator=(const FewerThreads&) = delete;

 private:
  inline static std::mutex mutex_;
  inline static std::multiset<int> asked_;  ///< by the calls that run
  inline static int before_ = 0;            ///< the limit before the first of them
  std::optional<int> jobs_;
};

/// Work on a thread, and whether it has ended.
class Running {
 public:
  Running(const std::function<void(Progress&)>& work, Progress& progress)
      : thread_([this, &work, &progress] {
          try {
            work(progress);
          } catch (...) {
            thrown_ = std::current_exception();
          }
          const std::lock_guard lock(mutex_);
          ended_ = true;
          changed_.notify_one();
        }) {}
  bool ends_within(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, time, [this] { return ended_; });
  }
  /// Once it has ended.
  void rethrow() {
    thread_.join();
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  std::exception_ptr thrown_;
  std::thread thread_;  // the last, since it uses the others
};

/// Says an array's shape for a sentence.
std::string shape_in_words(const py::array& array) {
  return "has the shape " + std::string(py::str(array.attr("shape")));
}

/// Errors: an array of numpy.ma that hides some of its values, which would be taken for others.
void refuse_hidden(const py::handle& value, const std::string& name) {
  if (!py::hasattr(value, "mask") || !py::hasattr(value, "filled")) return;
  const py::module_ hidden = py::module_::import("numpy.ma");
  if (hidden.attr("isMaskedArray")(value).cast<bool>() && hidden.attr("is_masked")(value).cast<bool>())
    refuse(name, "hides values by a mask, which is not kept; give array.filled(value), or the values alone");
}

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

void check_finite(const double* values, std::size_t count, std::size_t columns, const std::string& name) {
  for (std::size_t k = 0; k < count; ++k) {
    if (std::isfinite(values[k]) && is_in_reach(values[k])) continue;
    const std::string where =
        "[" + std::to_string(k / columns) + (columns > 1 ? ", " + std::to_string(k % columns) : "") + "]";
    refuse(name, std::isfinite(values[k]) ? "at " + where + " " + beyond_farthest + "; give mm"
                                          : "at " + where + " is no finite number; take it out or replace it");
  }
}

/// Text as JSON holds it. Errors: text that is no UTF-8.
std::string utf8(const py::handle& text) {
  py::ssize_t bytes = 0;
  const char* const begin = PyUnicode_AsUTF8AndSize(text.ptr(), &bytes);
  if (begin != nullptr) return {begin, static_cast<std::size_t>(bytes)};
  PyErr_Clear();
  refuse("text", "cannot be written as UTF-8; take out what is no character");
}

/// Errors: a number beyond 64 bits.
Json whole_number(const py::handle& value) {
  int beyond = 0;
  const long long number = PyLong_AsLongLongAndOverflow(value.ptr(), &beyond);
  if (beyond == 0) return static_cast<std::int64_t>(number);
  if (beyond > 0) {
    const unsigned long long large = PyLong_AsUnsignedLongLong(value.ptr());
    if (PyErr_Occurred() == nullptr) return static_cast<std::uint64_t>(large);
    PyErr_Clear();
  }
  refuse("number", std::string("is a whole number ") + (beyond > 0 ? "above" : "below") +
                       " those of 64 bits; give a smaller one");
}

[[noreturn]] void refuse_in_json(const py::handle& value) {
  refuse(std::string(py::str(py::type::of(value))), "has no place in JSON; give numbers, text, lists and dicts");
}

/// What an object of numpy is in Python itself. Its number of more than 64 bits, which has no other form there, becomes
/// a float.
Json json_of_numpy(const py::handle& value, int depth);

Json json_of(const py::handle& value, int depth) {
  constexpr int deepest = 100;
  if (depth > deepest) refuse("value", "holds itself, or lists within lists more than 100 deep; give a flat one");
  if (value.is_none()) return nullptr;
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (py::isinstance<py::int_>(value)) return whole_number(value);
  if (py::isinstance<py::float_>(value)) return value.cast<double>();
  if (py::isinstance<py::str>(value)) return utf8(value);
  if (py::isinstance<py::dict>(value)) {
    Json object = Json::object();
    for (const auto& [key, one] : value.cast<py::dict>()) object[utf8(py::str(key))] = json_of(one, depth + 1);
    return object;
  }
  if (py::hasattr(value, "tolist")) return json_of_numpy(value, depth);
  if (py::hasattr(value, "__fspath__")) return utf8(py::str(value.attr("__fspath__")()));
  if (py::isinstance<py::sequence>(value)) {
    Json list = Json::array();
    for (const auto& one : value.cast<py::sequence>()) list.push_back(json_of(one, depth + 1));
    return list;
  }
  refuse_in_json(value);
}

Json json_of_numpy(const py::handle& value, int depth) {
  refuse_hidden(value, "array");
  const py::object plain = value.attr("tolist")();
  if (!py::hasattr(plain, "tolist")) return json_of(plain, depth + 1);
  if (const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(plain.ptr()))) return whole_number(whole);
  PyErr_Clear();
  const auto kind = py::hasattr(plain, "dtype") ? plain.attr("dtype").attr("kind").cast<std::string>() : "f";
  const double number = kind == "f" ? PyFloat_AsDouble(plain.ptr()) : 0;
  if (kind == "f" && PyErr_Occurred() == nullptr) return number;
  PyErr_Clear();
  refuse_in_json(value);
}

}  // namespace

FileStamp::FileStamp(const std::filesystem::path& file) : file_(file) {
  std::error_code error;
  written_ = std::filesystem::last_write_time(file, error);
  if (error) file_.clear();
  bytes_ = std::filesystem::file_size(file, error);  // of a folder it is none, the same each time
}

bool FileStamp::holds() const {
  std::error_code error;
  if (file_.empty() || std::filesystem::last_write_time(file_, error) != written_ || error) return false;
  return std::filesystem::file_size(file_, error) == bytes_;
}

py::object to_python(const Json& json) {
  switch (json.type()) {
    case Json::value_t::object: {
      py::dict dict;
      for (const auto& [key, value] : json.items()) dict[py::str(key)] = to_python(value);
      return dict;
    }
    case Json::value_t::array: {
      py::list list(json.size());
      for (std::size_t k = 0; k < json.size(); ++k) list[k] = to_python(json[k]);
      return list;
    }
    case Json::value_t::string: {
      const auto& text = json.get_ref<const std::string&>();
      return py::reinterpret_steal<py::object>(
          PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
    }
    case Json::value_t::boolean:
      return py::bool_(json.get<bool>());
    case Json::value_t::number_integer:
      return py::int_(json.get<std::int64_t>());
    case Json::value_t::number_unsigned:
      return py::int_(json.get<std::uint64_t>());
    case Json::value_t::number_float:
      if (const double number = json.get<double>(); std::isfinite(number)) return py::float_(number);
      return py::none();
    default:
      return py::none();
  }
}

Json to_json(const py::handle& value) {
  return json_of(value, 0);
}

py::str text_of_system(const std::string& text) {
  PyObject* const decoded = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

std::string text_to_system(const py::handle& text) {
  return py::bytes(text.attr("encode")("utf-8", "surrogateescape"));
}

std::string in_python(const std::string& sentence, const std::vector<std::string>& verb) {
  return text_to_system(py::module_::import("homolog._words").attr("in_python")(text_of_system(sentence), verb));
}

void warn(const std::vector<std::string>& sentences) {
  std::vector<std::string> spoken;
  for (const std::string& sentence : sentences) spoken.push_back(in_python(sentence));
  warn_as_given(spoken);
}

void warn_as_given(const std::vector<std::string>& sentences) {
  if (sentences.empty()) return;
  const py::object category = py::module_::import("homolog._core").attr("HomologWarning");
  const py::object say = py::module_::import("warnings").attr("warn");
  for (const std::string& sentence : sentences) say(text_of_system(sentence), category, py::arg("stacklevel") = 3);
}

void do_watched(const Watched& watched, const std::function<void(Progress&)>& work) {
  const FewerThreads fewer(watched.jobs);
  constexpr std::chrono::milliseconds look_every{100};
  set_case_in_work({});  // an earlier call's
  Progress progress;
  std::optional<py::error_already_set> raised;
  double farthest = 0;  // a work that has to begin anew stands still for a while
  const auto look = [&] {
    const py::gil_scoped_acquire locked;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      farthest = std::max(farthest, std::min(progress.fraction(), 1.0));
      if (!watched.progress.is_none()) watched.progress(farthest, case_in_work());
    } catch (py::error_already_set& error) {
      raised.emplace(std::move(error));
      progress.cancel();
    }
  };
  std::exception_ptr thrown;
  {
    const py::gil_scoped_release unlocked;
    Running running(work, progress);
    while (!running.ends_within(look_every))
      if (!raised) look();
    try {
      running.rethrow();
    } catch (...) {
      thrown = std::current_exception();
    }
  }
  if (raised) throw py::error_already_set(std::move(*raised));
  if (thrown) std::rethrow_exception(thrown);
  if (!watched.progress.is_none()) watched.progress(1.0, std::string());
}

py::array read_only(const py::dtype& type, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                    const void* data, const py::handle& owner) {
  py::array view(type, std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

std::shared_ptr<HeldMesh> mesh_in(const py::handle& value) {
  if (py::isinstance<HeldMesh>(value)) return value.cast<std::shared_ptr<HeldMesh>>();
  if (!py::isinstance(value, py::module_::import("homolog._results").attr("Fit"))) return nullptr;
  return mesh_in(value.attr("mesh"));
}

std::string label_text(const py::handle& value) {
  if (py::isinstance<py::str>(value)) return utf8(value);
  if (!py::isinstance<py::bool_>(value) && PyIndex_Check(value.ptr()) != 0)
    if (const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()))) return py::str(whole);
  PyErr_Clear();
  if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value))
    refuse("label", "is a " + std::string(py::str(py::type::of(value).attr("__name__"))) +
                        "; give a number, a name, or a list of them");
  std::string all;
  for (const auto& one : value.cast<py::sequence>()) {
    if (py::isinstance<py::list>(one) || py::isinstance<py::tuple>(one))
      refuse("label", "holds a list within a list; give numbers and names");
    all += (all.empty() ? "" : ",") + label_text(one);
  }
  return all;
}

std::string path_from(const py::handle& value, const std::string& name, const std::string& wanted) {
  if (!py::isinstance<py::str>(value) && !py::hasattr(value, "__fspath__"))
    refuse(name, "is a " + std::string(py::str(py::type::of(value).attr("__name__"))) + "; give " + wanted);
  return py::reinterpret_borrow<py::object>(value).cast<std::filesystem::path>().string();
}

py::array array_from(const py::handle& value, const std::string& name) {
  refuse_hidden(value, name);
  const py::array array = py::array::ensure(py::reinterpret_borrow<py::object>(value));
  if (array) return array;
  PyErr_Clear();
  refuse(name, "is no array of numbers; give a numpy array");
}

py::array numbers_from(const py::handle& value, const std::string& name) {
  const py::array array = array_from(value, name);
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    refuse(name, "has the dtype " + std::string(py::str(array.dtype())) + "; give real numbers, as float64");
  return array;
}

Points points_from(const py::handle& value, const char* name) {
  const py::array array = numbers_from(value, name);
  if (array.ndim() != 2 || array.shape(1) != 3)
    refuse(name, shape_in_words(array) + "; give n×3, a row x, y, z in mm for each vertex" +
                     (array.ndim() == 2 && array.shape(0) == 3 ? " (transpose it)" : ""));
  if (array.shape(0) == 0) refuse(name, "is empty; give a row for each vertex");
  const Doubles doubles = array;
  check_finite(doubles.data(), static_cast<std::size_t>(doubles.size()), 3, name);
  return Eigen::Map<const Points>(doubles.data(), doubles.shape(0), 3);
}

VertexScalars scalars_from(const py::handle& value, Eigen::Index count, const char* name) {
  const py::array array = numbers_from(value, name);
  if (array.ndim() != 1 || array.shape(0) != count)
    refuse(name, shape_in_words(array) + "; give " + std::to_string(count) + " numbers, one for each vertex");
  const Doubles doubles = array;
  check_finite(doubles.data(), static_cast<std::size_t>(doubles.size()), 1, name);
  return Eigen::Map<const VertexScalars>(doubles.data(), doubles.shape(0));
}

Vec3 vector_from(const py::handle& value, const char* name) {
  const py::array array = numbers_from(value, name);
  if (array.ndim() != 1 || array.shape(0) != 3) refuse(name, shape_in_words(array) + "; give three numbers x, y, z");
  const Doubles doubles = array;
  check_finite(doubles.data(), 3, 1, name);
  return Eigen::Map<const Vec3>(doubles.data());
}

}  // namespace homolog::python
