#include <cmath>

#include "core/base/numbers/limits.h"
#include "core/model/files/statismo.h"
#include "core/model/measures/score.h"
#include "core/model/shape_model.h"
#include "core/model/shapes/study.h"
#include "python/homolog/binding.h"
#include "python/homolog/held_model.h"

namespace homolog::python {

namespace {

Eigen::VectorXd coefficients_from(const ShapeModel& model, const py::handle& value) {
  const py::array numbers = array_from(value, "coefficients");
  const bool are_none = numbers.size() == 0;  // of no kind, as []
  const py::array_t<double, py::array::c_style | py::array::forcecast> array =
      are_none ? numbers : numbers_from(value, "coefficients");
  if (array.ndim() != 1 || array.shape(0) > model.modes())
    refuse("coefficients", "are no list of at most " + std::to_string(model.modes()) +
                               " numbers, one for each mode, in standard deviations");
  const Eigen::VectorXd z = Eigen::Map<const Eigen::VectorXd>(array.data(), array.shape(0));
  if (!z.allFinite()) refuse("coefficients", "hold a number that is not finite; take it out or replace it");
  return z;
}

Eigen::VectorXd deviations_of(const ShapeModel& model, Eigen::Index count) {
  return model.variances.head(count).cwiseSqrt();
}

/// The labels by which a model of a part of a label's surface knows that part. `kept`: it faces them.
std::optional<std::string> faced_by(const HeldModel& self, bool kept) {
  const auto& faced = self.model->faced;
  return faced && faced->kept == kept ? std::optional(faced->labels) : std::nullopt;
}

/// `name`: of the numbers that the points come from.
std::shared_ptr<HeldMesh> mesh_of(const HeldModel& self, Points points, const char* name) {
  if (!points.allFinite() || !all_in_reach(points))
    refuse(name, std::string("lead to a point that ") + beyond_farthest + "; give standard deviations, as -3 to 3");
  MeshFile file;
  file.points = std::move(points);
  file.triangles = self.model->topology;
  return std::make_shared<HeldMesh>(HeldMesh{std::make_shared<const MeshFile>(std::move(file))});
}

Eigen::Index checked_mode(const HeldModel& self, Eigen::Index mode) {
  if (mode < 0 || mode >= self.model->modes())
    refuse("mode", "is " + std::to_string(mode) + ", and the model has " + std::to_string(self.model->modes()) +
                       ", counted from 0");
  return mode;
}

/// Errors: no whole number from 0 that 64 bits hold.
std::uint64_t seed_from(const py::object& value) {
  if (!py::isinstance<py::bool_>(value) && PyIndex_Check(value.ptr()) != 0) {
    const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    const unsigned long long seed = whole ? PyLong_AsUnsignedLongLong(whole.ptr()) : 0;
    if (PyErr_Occurred() == nullptr) return seed;
    PyErr_Clear();
  }
  refuse("seed", "is no whole number from 0 to 18446744073709551615; give one, as 1");
}

/// The mesh that a shape is: an object, or a file that is read. None: an array of points.
std::shared_ptr<HeldMesh> mesh_given(const py::object& shape) {
  const bool is_file = py::isinstance<py::str>(shape) || py::hasattr(shape, "__fspath__");
  return mesh_in(is_file ? py::module_::import("homolog").attr("read_mesh")(shape) : shape);
}

Points points_of_shape(const HeldModel& self, const py::object& shape, const std::shared_ptr<HeldMesh>& mesh) {
  if (mesh)
    if (const auto same = check_faces(*self.model, *mesh->file); !same) refuse("shape", same.error().what);
  Points points = mesh ? mesh->file->points : points_from(shape, "shape");
  if (3 * points.rows() != self.model->mean.size())
    refuse("shape", "has " + std::to_string(points.rows()) + " vertices and the model " +
                        std::to_string(self.model->mean.size() / 3) + "; give a fit of the model's template");
  return points;
}

py::dict score_of(const HeldModel& self, const py::object& shape) {
  const auto mesh = mesh_given(shape);
  const Points points = points_of_shape(self, shape, mesh);
  VertexScalars doubt;
  if (mesh && mesh->file->doubt_mm) doubt = *mesh->file->doubt_mm;
  const ShapeScore score =
      watched_value<ShapeScore>({py::none(), {}}, [&](Progress&) { return score_shape(*self.model, points, doubt); });
  const auto array = [](const auto& values) {
    py::array_t<double> copy(values.size());
    std::copy(values.data(), values.data() + values.size(), copy.mutable_data());
    return copy;
  };
  py::dict row;
  row["distance"] = score.distance;
  row["residual_mm"] = score.residual_mm;
  row["percentile"] = score.percentile ? py::object(py::float_(*score.percentile)) : py::none();
  row["size_mm"] = score.size_mm;
  row["z_rms"] = score.all.z_rms;
  row["modes"] = array(score.modes);
  row["z"] = array(score.z);
  row["z_low"] = array(score.z_low);
  row["z_high"] = array(score.z_high);
  row["aligned"] = array(score.aligned).reshape({score.aligned.rows(), Eigen::Index(3)});
  return row;
}

std::shared_ptr<HeldModel> read_held_model(const std::filesystem::path& path) {
  const FileStamp stamp(path);
  auto model = value_of(read_model(path));
  const auto record = value_of(read_model_record(path));
  return std::make_shared<HeldModel>(
      HeldModel{std::make_shared<const ShapeModel>(std::move(model)), path.string(), record.value_or(""), stamp});
}

}  // namespace

void add_models(py::module_& module) {
  using Held = HeldModel;
  py::class_<HeldModel, std::shared_ptr<HeldModel>> model(
      module, "Model", py::dynamic_attr(),
      "A statistical shape model x = mean + Σ bₘ · modeₘ, LPS mm. It is never changed.");
  model
      .def_property_readonly(
          "source", [](const Held& self) { return text_of_system(self.source); },
          "The file it was read from; empty where it was made here.")
      .def_property_readonly(
          "_file", [](const Held& self) { return text_of_system(self.stamp.holds() ? self.source : std::string()); })
      .def("__repr__",
           [](const Held& self) {
             return "<homolog.Model of " + std::to_string(self.model->modes()) + " modes and " +
                    std::to_string(self.model->mean.size() / 3) + " vertices>";
           })
      .def_property_readonly(
          "mean",
          [](const py::object& self) {
            const auto& mean = self.cast<const Held&>().model->mean;
            return read_only<double>({mean.size() / 3, 3}, mean.data(), self);
          },
          "n×3, mm; a view that cannot be written to.")
      .def_property_readonly(
          "modes",
          [](const py::object& self) {
            const auto& basis = self.cast<const Held&>().model->basis;
            return read_only<double>({basis.cols(), basis.rows() / 3, 3}, basis.data(), self);
          },
          "t×n×3: unit directions, the mode with the most variance first; a view.")
      .def_property_readonly(
          "variances",
          [](const py::object& self) {
            const auto& variances = self.cast<const Held&>().model->variances;
            return read_only<double>({variances.size()}, variances.data(), self);
          },
          "t, mm²; a view.")
      .def_property_readonly(
          "scores",
          [](const py::object& self) {
            const auto& scores = self.cast<const Held&>().model->scores;
            return read_only<double>({scores.cols(), scores.rows()}, scores.data(), self);
          },
          "M×t coefficients of the training shapes, mm; a view. Without rows where the file has none.")
      .def_property_readonly(
          "names", [](const Held& self) { return self.model->names; }, "Of the training shapes.")
      .def_property_readonly(
          "noise_variance", [](const Held& self) { return self.model->noise_variance; }, "mm².")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) -> py::object {
            const auto& topology = self.cast<const Held&>().model->topology;
            if (!topology) return py::none();
            return read_only<std::int32_t>({topology->triangles().rows(), 3}, topology->triangles().data(), self);
          },
          "m×3, or None for a model of points alone.")
      .def_property_readonly(
          "structures",
          [](const Held& self) {
            py::list names;
            for (const StructurePart& part : self.model->parts) names.append(part.name);
            return names;
          },
          "Of a joint model the names of its structures.")
      .def_property_readonly(
          "facing", [](const Held& self) { return faced_by(self, true); },
          "Names of the labels that its shapes face, where they are of that part of a label's surface, or None.")
      .def_property_readonly(
          "open_at", [](const Held& self) { return faced_by(self, false); },
          "Names of the labels that its shapes end at, or None.")
      .def(
          "__len__", [](const Held& self) { return self.model->modes(); }, "How many modes there are.")
      .def(
          "shape",
          [](const Held& self, const py::object& z) {
            const Eigen::VectorXd given = coefficients_from(*self.model, z);
            return mesh_of(self, shape_of(*self.model, given.cwiseProduct(deviations_of(*self.model, given.size()))),
                           "coefficients");
          },
          py::arg("coefficients"),
          "The Mesh at these coefficients: one a mode, in standard deviations; later modes are 0.")
      .def(
          "mode",
          [](const Held& self, Eigen::Index mode, double deviations) {
            if (!std::isfinite(deviations)) refuse("deviations", "are no finite number; give one, as -3 to 3");
            return mesh_of(self, mode_shape(*self.model, checked_mode(self, mode), deviations), "deviations");
          },
          py::arg("mode"), py::arg("deviations"), "The mean with one mode (from 0) at so many standard deviations.")
      .def(
          "sample",
          [](const Held& self, const py::object& seed) {
            return mesh_of(self, sampled_shape(*self.model, seed_from(seed)), "modes");
          },
          py::arg("seed"), "A random shape. The same seed gives the same shape on every machine.")
      .def(
          "coefficients",
          [](const Held& self, const py::object& shape) {
            const Eigen::VectorXd b = coefficients(*self.model, points_of_shape(self, shape, mesh_given(shape)));
            const Eigen::VectorXd z = b.cwiseQuotient(deviations_of(*self.model, b.size()));
            py::array_t<double> copy(z.size());
            std::copy(z.begin(), z.end(), copy.mutable_data());
            return copy;
          },
          py::arg("shape"),
          "t coefficients, in standard deviations, of a shape (Mesh, Fit, file or n×3) that lies where the model's "
          "shapes "
          "lie.")
      .def(
          "score", &score_of, py::arg("shape"),
          R"(How a shape (Mesh, Fit, file or n×3, mm) stands against the model, wherever it lies: a dict of distance (σ), residual_mm,
percentile, size_mm, z_rms, modes (t, σ), and for each vertex z, z_low, z_high (n, σ) and aligned (n×3, mm).)")
      .def(
          "write",
          [](const Held& self, const std::filesystem::path& path) {
            value_of(write_model(*self.model, path, self.record));
          },
          py::arg("path"), "Writes .h5 or .h5.json, statismo's and scalismo's layout, whole or not at all.");
  module.def("read_model", &read_held_model, py::arg("path"),
             "Reads a model of Homolog, statismo or scalismo (.h5, .h5.json).");
  module.def(
      "loaded_model",
      [](const std::filesystem::path& path) {
        const auto read = read_held_model(path);
        read->source.clear();
        read->stamp = {};
        return read;
      },
      py::arg("path"), "read_model of a file that is removed afterwards.");
  module.def(
      "check_study", [](const std::filesystem::path& path) { warn(value_of(read_study(path)).warnings); },
      py::arg("path"), "Errors: the file is no study. Files that are missing are warnings.");
}

}  // namespace homolog::python
