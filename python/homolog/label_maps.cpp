#include <algorithm>
#include <cmath>

#include "core/volume/labels/read_labels.h"
#include "python/homolog/volume_parts.h"

// Label maps: their labels by name and layer, and where each lies.

namespace homolog::python {

namespace {

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
    const Volume& layer = read.layer(segment.layer);
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

}  // namespace

void add_labels_of_map(LabelMapType& map) {
  const auto none = py::none();
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
}

}  // namespace homolog::python
