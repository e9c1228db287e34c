#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "core/volume/dicom/write_dicom_segmentation.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/readers.h"
#include "core/volume/stored_voxels.h"
#include "python/homolog/binding.h"

namespace homolog::python {

namespace {

// --- Numpy arrays in.

template <class T>
StoredVoxels copied(const py::array& array) {
  // Homolog keeps voxels i fastest, which is Fortran's order; numpy turns whatever order the array has.
  const auto ordered = py::array_t<T, py::array::f_style | py::array::forcecast>::ensure(array);
  if (!ordered) {
    PyErr_Clear();
    throw std::bad_alloc();
  }
  std::vector<T> voxels(static_cast<std::size_t>(ordered.size()));
  std::memcpy(voxels.data(), ordered.data(), voxels.size() * sizeof(T));
  return voxels;
}

/// Voxels in the array's own type. Errors: a type that is none of images.
StoredVoxels voxels_from(const py::array& array) {
  const char kind = array.dtype().kind();
  const auto bytes = array.itemsize();
  if (kind == 'b') return copied<std::uint8_t>(array);
  if (kind == 'u')
    return bytes == 1   ? copied<std::uint8_t>(array)
           : bytes == 2 ? copied<std::uint16_t>(array)
           : bytes == 4 ? copied<std::uint32_t>(array)
                        : copied<std::uint64_t>(array);
  if (kind == 'i')
    return bytes == 1   ? copied<std::int8_t>(array)
           : bytes == 2 ? copied<std::int16_t>(array)
           : bytes == 4 ? copied<std::int32_t>(array)
                        : copied<std::int64_t>(array);
  if (kind == 'f' && bytes <= 4) return copied<float>(array);
  if (kind == 'f' && bytes == 8) return copied<double>(array);
  refuse("voxels",
         "have the dtype " + std::string(py::str(array.dtype())) + "; give whole numbers or floats of at most 64 bits");
}

/// Errors: a value that is no number; of a label map also one that no label has.
void check_voxels(const py::array& array, bool labels) {
  const py::module_ numpy = py::module_::import("numpy");
  const auto first = [&](const py::object& mask) {
    return std::string(py::str(numpy.attr("argwhere")(mask).attr("__getitem__")(0).attr("tolist")()));
  };
  if (array.dtype().kind() == 'f') {
    if (labels)
      refuse("voxels",
             "have the dtype " + std::string(py::str(array.dtype())) +
                 ", and labels are whole numbers; give voxels.astype(numpy.uint16), or a soft mask as homolog.Volume");
    const py::object finite = numpy.attr("isfinite")(array);
    if (!numpy.attr("all")(finite).cast<bool>())
      refuse("voxels", "at " + first(numpy.attr("logical_not")(finite)) +
                           " are no finite number; replace them, as with numpy.nan_to_num");
  } else if (labels) {
    const py::object low = numpy.attr("min")(array), high = numpy.attr("max")(array);
    if (low.cast<double>() < 0 || high.cast<double>() > 65535)
      refuse("voxels", "have values from " + std::string(py::str(low)) + " to " + std::string(py::str(high)) +
                           "; labels are from 0 to 65535");
  }
}

/// p (LPS mm) = the upper left 3×3 · index + the last column.
struct Grid {
  Mat3 steps_mm = Mat3::Identity();
  Vec3 origin_mm = Vec3::Zero();
};

Grid grid_from(const py::object& affine, const py::object& spacing_mm, const py::object& origin_mm,
               const py::object& direction) {
  Grid grid;
  if (!affine.is_none()) {
    if (!spacing_mm.is_none() || !origin_mm.is_none() || !direction.is_none())
      refuse("affine", "says the grid already; leave out spacing_mm, origin_mm and direction");
    const py::array_t<double, py::array::c_style | py::array::forcecast> m = numbers_from(affine, "affine");
    if (m.ndim() != 2 || m.shape(0) != 4 || m.shape(1) != 4)
      refuse("affine", "is no 4×4 matrix; give one from voxel index to mm, LPS");
    using Affine = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    const Affine a = Eigen::Map<const Affine>(m.data());
    if (!a.allFinite() || a.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
      refuse("affine", "is no affine matrix; its numbers must be finite and its last row 0, 0, 0, 1");
    grid.steps_mm = a.topLeftCorner<3, 3>();
    grid.origin_mm = a.topRightCorner<3, 1>();
    return grid;
  }
  Vec3 spacing = Vec3::Ones();
  if (!spacing_mm.is_none()) spacing = vector_from(spacing_mm, "spacing_mm");
  if (spacing.minCoeff() <= 0) refuse("spacing_mm", "is not above 0; give the size of a voxel in mm");
  if (!origin_mm.is_none()) grid.origin_mm = vector_from(origin_mm, "origin_mm");
  if (!direction.is_none()) {
    const py::array given = numbers_from(direction, "direction");
    if (given.ndim() != 2 || given.shape(0) != 3 || given.shape(1) != 3)
      refuse("direction", "has the shape " + std::string(py::str(given.attr("shape"))) +
                              "; give a 3×3 matrix, whose columns are the directions of i, j and k" +
                              (given.ndim() == 1 && given.size() == 9 ? " (SimpleITK's nine: reshape(3, 3))" : ""));
    const Points rows = points_from(given, "direction");
    if (((rows.colwise().norm().array() - 1).abs() > 1e-3).any())
      refuse("direction", "has columns that are no unit vectors; give the spacing as spacing_mm");
    grid.steps_mm = rows;
  }
  grid.steps_mm = grid.steps_mm * spacing.asDiagonal();
  return grid;
}

Segmentation names_from(const py::object& names) {
  Segmentation known;
  if (names.is_none()) return known;
  if (!py::isinstance<py::dict>(names)) refuse("names", "is no dict; give {value: name}");
  for (const auto& [value, name] : names.cast<py::dict>()) {
    Segment segment;
    if (!py::isinstance<py::int_>(value) && !py::hasattr(value, "__index__"))
      refuse("names", "has a key that is no label; give {value: name} with whole numbers");
    const py::object whole = value.attr("__index__")();
    int beyond = 0;
    const long long number = PyLong_AsLongLongAndOverflow(whole.ptr(), &beyond);
    if (beyond != 0 || number < 1 || number > 65535)
      refuse("names", "names the label " + std::string(py::str(whole)) + "; labels are from 1 to 65535");
    if (!py::isinstance<py::str>(name))
      refuse("names", "calls the label " + std::to_string(number) + " by a " +
                          std::string(py::str(py::type::of(name).attr("__name__"))) + "; give text");
    segment.value = static_cast<int>(number);
    const auto given = name.cast<std::string>();
    segment.name = segment_name(given);
    if (segment.name != given)
      warn({"names: the name of label " + std::to_string(number) + " becomes \"" + segment.name +
            "\", since names are printable text in one line"});
    known.add(std::move(segment));
  }
  return known;
}

VolumeRead volume_from(const py::object& voxels, const Grid& grid, const py::object& names, double frame_seconds,
                       const std::string& modality, bool labels) {
  const py::array array = array_from(voxels, "voxels");
  if (array.ndim() != 3 && array.ndim() != 4)
    refuse("voxels", "have the shape " + std::string(py::str(array.attr("shape"))) +
                         "; give three axes [i, j, k], or four with frames as the last");
  if (array.size() == 0) refuse("voxels", "are none; every axis needs at least one");
  if (!std::isfinite(frame_seconds) || frame_seconds < 0)
    refuse("frame_seconds", "is " + std::string(py::str(py::float_(frame_seconds))) +
                                "; give the seconds between frames, or 0 where nobody says");
  StoredVoxels stored = voxels_from(array);
  check_voxels(array, labels);
  VolumeRead read;
  read.volume.geometry =
      value_of(make_geometry("grid", {array.shape(0), array.shape(1), array.shape(2)}, grid.steps_mm, grid.origin_mm));
  read.volume.frames = array.ndim() == 4 ? static_cast<int>(array.shape(3)) : 1;
  read.volume.frame_seconds = frame_seconds;
  read.volume.modality = modality;
  value_of(keep_voxels(std::move(stored), {}, "voxels", read.volume, read.warnings));
  warn(read.warnings);
  read.segmentation = names_from(names);
  return read;
}

/// A volume as another was, its place to the last bit.
std::shared_ptr<HeldVolume> volume_as_it_was(const py::object& voxels, const py::object& spacing_mm,
                                             const py::object& origin_mm, const py::object& direction,
                                             double frame_seconds, const std::string& modality,
                                             const std::string& frame_of_reference) {
  const Grid grid = grid_from(py::none(), spacing_mm, origin_mm, direction);
  VolumeRead read = volume_from(voxels, grid, py::none(), frame_seconds, modality, false);
  read.volume.geometry.spacing_mm = vector_from(spacing_mm, "spacing_mm");
  read.volume.geometry.direction = points_from(direction, "direction");
  read.volume.frame_of_reference = frame_of_reference;
  return std::make_shared<HeldVolume>(HeldVolume{std::make_shared<const VolumeRead>(std::move(read))});
}

// --- And out.

py::array voxels_of(const py::object& self) {
  const Volume& volume = self.cast<const HeldVolume&>().read->volume;
  const auto& dims = volume.geometry.dims;
  std::vector<py::ssize_t> shape{dims[0], dims[1], dims[2]};
  if (volume.frames > 1) shape.push_back(volume.frames);
  return std::visit(
      [&]<class T>(const std::vector<T>& voxels) {
        std::vector<py::ssize_t> strides;
        py::ssize_t step = sizeof(T);
        for (const py::ssize_t length : shape) {
          strides.push_back(step);
          step *= length;
        }
        return read_only(py::dtype::of<T>(), shape, strides, voxels.data(), self);
      },
      volume.data);
}

py::array_t<double> affine_of(const HeldVolume& self, bool ras) {
  const VolumeGeometry& grid = self.read->volume.geometry;
  Eigen::Matrix4d a = Eigen::Matrix4d::Identity();
  a.topLeftCorner<3, 3>() = grid.direction * grid.spacing_mm.asDiagonal();
  a.topRightCorner<3, 1>() = grid.origin_mm;
  if (ras) a.topRows<2>() *= -1;
  py::array_t<double> matrix({4, 4});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix.mutable_at(row, column) = a(row, column) + 0.0;
  return matrix;
}

py::tuple triple(const Vec3& v) {
  return py::make_tuple(v.x(), v.y(), v.z());
}

py::list labels_in(const HeldLabels& self) {
  py::list rows;
  const VolumeRead& read = *self.read;
  const auto add = [&](const Volume& layer, std::size_t at) {
    for (const auto& [value, voxels] : labels_of(layer)) {
      const Segment* known = read.segmentation.find(value, at);
      py::dict row;
      row["value"] = value;
      row["name"] = known != nullptr && !known->name.empty() ? py::object(py::str(known->name)) : py::none();
      row["voxels"] = voxels;
      row["volume_ml"] = static_cast<double>(voxels) * layer.geometry.voxel_volume_mm3() / 1000;
      row["layer"] = at;
      rows.append(row);
    }
  };
  add(read.volume, 0);
  for (std::size_t k = 0; k < read.other_layers.size(); ++k) add(read.other_layers[k], k + 1);
  return rows;
}

/// The label map of one layer, with the names that are of it.
std::shared_ptr<HeldLabels> layer_of(const HeldLabels& self, std::size_t at) {
  VolumeRead read;
  read.volume = at == 0 ? self.read->volume : self.read->other_layers[at - 1];
  for (Segment segment : self.read->segmentation.segments) {
    if (segment.layer != at) continue;
    segment.layer = 0;
    read.segmentation.add(std::move(segment));
  }
  read.referenced = self.read->referenced;
  auto map = std::make_shared<HeldLabels>();
  map->read = std::make_shared<const VolumeRead>(std::move(read));
  return map;
}

py::tuple layers_of(const py::object& self) {
  const auto& labels = self.cast<const HeldLabels&>();
  const std::size_t others = labels.read->other_layers.size();
  py::tuple layers(others + 1);
  for (std::size_t at = 0; at <= others; ++at) layers[at] = others == 0 ? self : py::cast(layer_of(labels, at));
  return layers;
}

/// Marks the voxels of one label in any frame. False where there are none.
bool mark(const Volume& layer, int label, bool* marks) {
  bool any = false;
  std::visit(
      [&](const auto& voxels) {
        for (std::size_t k = 0; k < voxels.size(); ++k)
          if (std::rint(static_cast<double>(voxels[k])) == label) any = marks[k] = true;
      },
      layer.data);
  return any;
}

/// Where segments lie, whatever layers they are in.
py::array mask_of(const HeldLabels& self, const py::object& asked) {
  const VolumeRead& read = *self.read;
  const std::string subject = self.source.empty() ? "labels" : self.source, label = label_text(asked);
  if (label.empty() || is_bad_label(label))
    refuse("label", "is \"" + label + "\"; give a number above 0 or a name, or several as in \"1,2\"");
  const auto segments = asked_segments(label, read.segmentation);
  if (!segments) refuse(subject, segments.error().what);
  const auto& dims = read.volume.geometry.dims;
  std::vector<py::ssize_t> shape{dims[0], dims[1], dims[2]};
  if (read.volume.frames > 1) shape.push_back(read.volume.frames);
  py::array_t<bool, py::array::f_style> marks(shape);
  bool* const begin = marks.mutable_data();
  std::fill(begin, begin + marks.size(), false);
  bool any = false;
  for (const Segment& segment : *segments) {
    const Volume& layer = segment.layer == 0 ? read.volume : read.other_layers[segment.layer - 1];
    if (!same_grid(layer.geometry, read.volume.geometry) || layer.frames != read.volume.frames)
      refuse(subject, "keeps " + label_words(segment) + " on a grid of its own; take it from layers[" +
                          std::to_string(segment.layer) + "]");
    any = mark(layer, segment.value, begin) || any;
  }
  if (!any &&
      std::ranges::none_of(*segments, [&](const Segment& s) { return read.segmentation.find(s.value, s.layer); }))
    refuse(subject, "has no voxel of label " + label + "; labels says which there are");
  return marks;
}

/// What a volume holds beside its voxels and its grid, for who tells volumes apart: the time between frames, kind and
/// space of an image, and what is said of its labels. Empty where it is nothing.
std::string beside_voxels(const HeldVolume& self) {
  const VolumeRead& read = *self.read;
  Json said = Json::object();
  if (read.volume.frame_seconds != 0) said["frame_seconds"] = read.volume.frame_seconds;
  if (!read.volume.modality.empty()) said["modality"] = read.volume.modality;
  if (!read.volume.frame_of_reference.empty()) said["frame_of_reference"] = read.volume.frame_of_reference;
  for (const SourceImage& image : read.volume.images) said["instances"].push_back(image.uid);
  if (read.volume.empty_beyond_slices) said["empty_beyond_slices"] = true;
  if (!read.referenced.series.empty()) said["of_series"] = read.referenced.series;
  if (!read.referenced.instances.empty()) said["of_instances"] = read.referenced.instances;
  for (const Segment& one : read.segmentation.segments) {
    Json segment{{"name", one.name}, {"value", one.value}, {"layer", one.layer}, {"terminology", one.terminology}};
    if (one.colour) segment["colour"] = *one.colour;
    said["segments"].push_back(std::move(segment));
  }
  return said.empty() ? std::string() : said.dump(-1, ' ', true, Json::error_handler_t::replace);
}

void add_members(py::class_<HeldVolume, std::shared_ptr<HeldVolume>>& type) {
  using Held = HeldVolume;
  type.def_property_readonly(
          "source", [](const Held& self) { return self.source; },
          "The file it was read from; empty where it was made of an array.")
      .def_property_readonly(
          "shape",
          [](const Held& self) {
            const Volume& v = self.read->volume;
            py::tuple shape = py::make_tuple(v.geometry.dims[0], v.geometry.dims[1], v.geometry.dims[2]);
            return v.frames > 1 ? py::tuple(shape + py::make_tuple(v.frames)) : shape;
          },
          "Voxels along i, j and k; of a cine also the frames.")
      .def_property_readonly("_file", [](const Held& self) { return self.stamp.holds() ? self.source : std::string(); })
      .def_property_readonly("_beside_voxels", &beside_voxels)
      .def("__repr__",
           [](const py::object& self) {
             return py::str("<homolog.{} {} {} of {} mm>")
                 .format(self.attr("__class__").attr("__name__"), self.attr("shape"),
                         voxel_type_name(self.cast<const Held&>().read->volume.data), self.attr("spacing_mm"));
           })
      .def_property_readonly(
          "frames", [](const Held& self) { return self.read->volume.frames; },
          "How many frames there are; 1 where it is no cine.")
      .def_property_readonly(
          "frame_seconds", [](const Held& self) { return self.read->volume.frame_seconds; },
          "Seconds between frames; 0 where nobody says.")
      .def_property_readonly(
          "modality", [](const Held& self) { return self.read->volume.modality; },
          "\"CT\", \"MR\", …; empty where unknown.")
      .def_property_readonly(
          "spacing_mm", [](const Held& self) { return triple(self.read->volume.geometry.spacing_mm); },
          "Distance between voxels along i, j and k, mm.")
      .def_property_readonly(
          "origin_mm", [](const Held& self) { return triple(self.read->volume.geometry.origin_mm); },
          "Centre of voxel (0, 0, 0), LPS mm.")
      .def_property_readonly(
          "direction",
          [](const Held& self) {
            py::array_t<double> matrix({3, 3});
            for (int r = 0; r < 3; ++r)
              for (int c = 0; c < 3; ++c) matrix.mutable_at(r, c) = self.read->volume.geometry.direction(r, c);
            return matrix;
          },
          "3×3; its columns are the unit directions of i, j and k, LPS.")
      .def_property_readonly(
          "affine", [](const Held& self) { return affine_of(self, false); },
          "4×4, from voxel index (i, j, k, 1) to LPS mm.")
      .def_property_readonly(
          "affine_ras", [](const Held& self) { return affine_of(self, true); },
          "4×4, from voxel index to RAS mm, as nibabel has it.")
      .def_property_readonly("array", &voxels_of,
                             R"(The voxels, a view that cannot be written to. Shape (i, j, k), of a cine
(i, j, k, frame). The first index runs along the grid's first axis, as in nibabel; SimpleITK's arrays are [k, j, i].)")
      .def_property_readonly(
          "warnings", [](const Held& self) { return self.read->warnings; },
          "What had to be mended to read it, each a sentence.")
      .def("__array__", [](const py::object& self, const py::args&, const py::kwargs& more) {
        const py::object array = voxels_of(self);
        const py::object asked = more.contains("dtype") ? py::object(more["dtype"]) : py::none();
        return asked.is_none() ? array : py::object(array.attr("astype")(asked));
      });
}

template <class Held>
std::shared_ptr<Held> read_held(const std::filesystem::path& path, const std::string& series,
                                const py::object& spacing_mm, const py::object& progress, bool labels,
                                bool resample = false) {
  VolumeReadOptions options;
  options.series_uid = series;
  options.resample = resample;
  if (!spacing_mm.is_none()) options.stack_spacing_mm = vector_from(spacing_mm, "spacing_mm");
  // With options, a verb that reads the file would get something else.
  const bool plain = series.empty() && spacing_mm.is_none() && !resample;
  const FileStamp stamp = plain ? FileStamp(path) : FileStamp();
  auto read = watched_value<VolumeRead>({progress, {}}, [&](Progress& own) {
    options.progress = &own;
    return labels ? read_labels(path, options) : read_volume(path, options);
  });
  auto held = std::make_shared<Held>();
  held->source = path.string();
  held->stamp = stamp;
  held->read = std::make_shared<const VolumeRead>(std::move(read));
  warn(held->read->warnings);
  return held;
}

/// A label map as a DICOM segmentation of a series.
void write_dicom_held(const HeldLabels& self, const std::filesystem::path& path, const py::object& like,
                      const py::object& progress) {
  if (like.is_none())
    refuse(path.string(), "becomes a DICOM segmentation, which refers to a series of images; give its folder as like");
  const auto series = like.cast<std::filesystem::path>();
  const auto warnings = watched_value<std::vector<std::string>>(
      {progress, {}}, [&](Progress& own) { return write_dicom_segmentation(*self.read, path, series, &own); });
  warn(warnings);
}

void write_held(const HeldVolume& self, const std::filesystem::path& path, const py::object& progress, bool labels) {
  do_watched({progress, {}}, [&](Progress& own) {
    value_of(labels ? write_segmentation(*self.read, path, &own) : write_volume(self.read->volume, path, &own));
  });
}

constexpr const char* about_grid = R"(
voxels: whole numbers or floats, shape (i, j, k) or (i, j, k, frame), in any memory order; the first index runs along
    the grid's first axis, as in nibabel. They are copied once. float64 is kept as float32.
affine: 4×4, from voxel index to LPS mm. Or spacing_mm (3), origin_mm (3, centre of voxel (0, 0, 0), LPS) and direction
    (3×3, columns are the unit directions of i, j, k).
Errors: shape, dtype, values that are not finite or hidden by a mask, axes that are not at right angles.)";

}  // namespace

void add_volumes(py::module_& module) {
  const auto none = py::none();
  py::class_<HeldVolume, std::shared_ptr<HeldVolume>> volume(
      module, "Volume", "A grey-value image, or a cine, on a grid in the patient (LPS mm). It is never changed.");
  volume.def(py::init([](const py::object& voxels, const py::object& affine, const py::object& spacing,
                         const py::object& origin, const py::object& direction, double frame_seconds,
                         const std::string& modality) {
               auto read = volume_from(voxels, grid_from(affine, spacing, origin, direction), py::none(), frame_seconds,
                                       modality, false);
               return std::make_shared<HeldVolume>(HeldVolume{std::make_shared<const VolumeRead>(std::move(read))});
             }),
             py::arg("voxels"), py::kw_only(), py::arg("affine") = none, py::arg("spacing_mm") = none,
             py::arg("origin_mm") = none, py::arg("direction") = none, py::arg("frame_seconds") = 0.0,
             py::arg("modality") = "", (std::string("An image of an array.\n") + about_grid).c_str());
  add_members(volume);
  volume.def(
      "write",
      [](const HeldVolume& self, const std::filesystem::path& path, const py::object& progress) {
        write_held(self, path, progress, false);
      },
      py::arg("path"), py::kw_only(), py::arg("progress") = none,
      "Writes NIfTI, NRRD or MetaImage, by the ending, whole or not at all.");

  py::class_<HeldLabels, HeldVolume, std::shared_ptr<HeldLabels>> map(
      module, "LabelMap",
      "A label map: whole numbers on a grid (LPS mm), and what they are called. It is never changed.");
  map.def(py::init([](const py::object& voxels, const py::object& affine, const py::object& spacing,
                      const py::object& origin, const py::object& direction, const py::object& names) {
            auto held = std::make_shared<HeldLabels>();
            held->read = std::make_shared<const VolumeRead>(
                volume_from(voxels, grid_from(affine, spacing, origin, direction), names, 0, {}, true));
            return held;
          }),
          py::arg("voxels"), py::kw_only(), py::arg("affine") = none, py::arg("spacing_mm") = none,
          py::arg("origin_mm") = none, py::arg("direction") = none, py::arg("names") = none,
          (std::string("A label map of an array of whole numbers from 0 (background) to 65535.\n") + about_grid +
           "\nnames: {value: name}.")
              .c_str());
  map.def_property_readonly("labels", &labels_in,
                            "What occurs in its first frame: [{value, name, voxels, volume_ml, layer}].");
  map.def_property_readonly(
      "names",
      [](const HeldLabels& self) {
        py::dict names;
        for (const Segment& one : self.read->segmentation.segments)
          if (one.layer == 0 && !one.name.empty()) names[py::int_(one.value)] = one.name;
        return names;
      },
      "{value: name} of the labels of `array` that have a name. Segments that overlap lie in other layers: see "
      "layers.");
  map.def_property_readonly("layers", &layers_of,
                            "A LabelMap for each layer, with its array and names, the one of `array` first. There are "
                            "several where segments overlap or share labels (3D Slicer, a folder of masks).");
  map.def_property_readonly("_layer_count", [](const HeldLabels& self) { return self.read->other_layers.size() + 1; });
  map.def("mask", &mask_of, py::arg("label"),
          "Where a segment lies, in whichever layer: bool, of the shape of `array`; a copy. label: its name or number, "
          "or several, whose union it is.");
  map.def(
      "write",
      [](const HeldLabels& self, const std::filesystem::path& path, const py::object& like,
         const py::object& progress) {
        if (has_ending(path, {".dcm"}))
          write_dicom_held(self, path, like, progress);
        else if (!like.is_none())
          refuse("like", "has no effect, since " + path.string() + " is no DICOM file; leave it out");
        else
          write_held(self, path, progress, true);
      },
      py::arg("path"), py::kw_only(), py::arg("like") = none, py::arg("progress") = none,
      "Writes .seg.nrrd with names, colours and layers, or NIfTI, NRRD, MetaImage with the names in a JSON file beside "
      "it. As .dcm it becomes a DICOM segmentation that refers to the series `like`, a folder.");

  module.def(
      "read_volume",
      [](const std::filesystem::path& path, const std::string& series, const py::object& spacing, bool resample,
         const py::object& progress) {
        return read_held<HeldVolume>(path, series, spacing, progress, false, resample);
      },
      py::arg("path"), py::kw_only(), py::arg("series") = "", py::arg("spacing_mm") = none, py::arg("resample") = false,
      py::arg("progress") = none,
      "Reads an image: NIfTI, NRRD, MetaImage, a DICOM folder, a folder of pictures (these need spacing_mm). resample: "
      "tilted or unevenly spaced DICOM slices become a rectangular grid.");
  module.def(
      "read_label_map",
      [](const std::filesystem::path& path, const py::object& progress) {
        return read_held<HeldLabels>(path, "", py::none(), progress, true);
      },
      py::arg("path"), py::kw_only(), py::arg("progress") = none,
      "Reads a label map with its names: NIfTI, NRRD, 3D Slicer's .seg.nrrd, MetaImage, DICOM SEG, a folder of masks.");
  module.def(
      "loaded_label_map",
      [](const std::filesystem::path& path) {
        const auto read = read_held<HeldLabels>(path, "", py::none(), py::none(), true);
        read->source.clear();
        read->stamp = {};
        return read;
      },
      py::arg("path"), "read_label_map of a file that is removed afterwards.");
  module.def("volume_as_it_was", &volume_as_it_was, py::arg("voxels"), py::kw_only(), py::arg("spacing_mm"),
             py::arg("origin_mm"), py::arg("direction"), py::arg("frame_seconds"), py::arg("modality"),
             py::arg("frame_of_reference"), "A volume as another was, its place to the last bit.");
}

}  // namespace homolog::python
