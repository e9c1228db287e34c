#include <cmath>
#include <cstring>
#include <new>

#include "core/volume/labels/read_labels.h"
#include "core/volume/readers.h"
#include "core/volume/stored_voxels.h"
#include "python/homolog/volume_parts.h"

// Numpy's arrays become volumes.

namespace homolog::python {

namespace {

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

}  // namespace

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

namespace {

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

}  // namespace

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

}  // namespace homolog::python
