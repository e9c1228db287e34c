#include "core/base/files/files.h"
#include "core/volume/dicom/write_dicom_segmentation.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/readers.h"
#include "python/homolog/volume_parts.h"

// Volumes and label maps are read from files, and written.

namespace homolog::python {

namespace {

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

void add_writing(VolumeType& volume, LabelMapType& map) {
  const auto none = py::none();
  volume.def(
      "write",
      [](const HeldVolume& self, const std::filesystem::path& path, const py::object& progress) {
        write_held(self, path, progress, false);
      },
      py::arg("path"), py::kw_only(), py::arg("progress") = none,
      "Writes NIfTI, NRRD or MetaImage, by the ending, whole or not at all.");
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
}

}  // namespace

void add_volume_files(py::module_& module, VolumeType& volume, LabelMapType& map) {
  const auto none = py::none();
  add_writing(volume, map);
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
}

}  // namespace homolog::python
