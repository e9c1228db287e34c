#include "core/volume/stored_voxels.h"
#include "python/homolog/volume_parts.h"

namespace homolog::python {

namespace {

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

/// What a volume holds beside its voxels and its grid, for who tells volumes apart: the time between frames, kind and
/// space of an image, and what is said of its labels. Empty where it is nothing.
std::string beside_voxels(const HeldVolume& self) {
  const VolumeRead& read = *self.read;
  Json said = Json::object();
  if (read.volume.frame_seconds != 0) said["frame_seconds"] = read.volume.frame_seconds;
  if (!read.volume.modality.empty()) said["modality"] = read.volume.modality;
  if (!read.volume.frame_of_reference.empty()) said["frame_of_reference"] = read.volume.frame_of_reference;
  for (const SourceImage& image : read.volume.images)
    if (image.frame <= 1) said["instances"].push_back(image.uid);
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

void add_members(VolumeType& type) {
  using Held = HeldVolume;
  type.def_property_readonly(
          "source", [](const Held& self) { return text_of_system(self.source); },
          "The file it was read from; empty where it was made of an array.")
      .def_property_readonly(
          "shape",
          [](const Held& self) {
            const Volume& v = self.read->volume;
            py::tuple shape = py::make_tuple(v.geometry.dims[0], v.geometry.dims[1], v.geometry.dims[2]);
            return v.frames > 1 ? py::tuple(shape + py::make_tuple(v.frames)) : shape;
          },
          "Voxels along i, j and k; of a cine also the frames.")
      .def_property_readonly(
          "_file", [](const Held& self) { return text_of_system(self.stamp.holds() ? self.source : std::string()); })
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

void add_volume_of_array(VolumeType& volume) {
  const auto none = py::none();
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
}

}  // namespace

void add_volumes(py::module_& module) {
  VolumeType volume(module, "Volume",
                    "A grey-value image, or a cine, on a grid in the patient (LPS mm). It is never changed.");
  add_volume_of_array(volume);
  add_members(volume);
  LabelMapType map(module, "LabelMap",
                   "A label map: whole numbers on a grid (LPS mm), and what they are called. It is never changed.");
  add_labels_of_map(map);
  add_volume_files(module, volume, map);
  module.def("volume_as_it_was", &volume_as_it_was, py::arg("voxels"), py::kw_only(), py::arg("spacing_mm"),
             py::arg("origin_mm"), py::arg("direction"), py::arg("frame_seconds"), py::arg("modality"),
             py::arg("frame_of_reference"), "A volume as another was, its place to the last bit.");
}

}  // namespace homolog::python
