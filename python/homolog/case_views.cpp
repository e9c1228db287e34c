#include "core/session/session.h"
#include "python/homolog/case_parts.h"

// What a case holds, as arrays, meshes and dicts.

namespace homolog::python {

ShapeView shown(const Document& document, const std::string& of) {
  const auto view = document.view(of);
  if (!view)
    refuse(of.empty() ? "case" : of, "has no mesh in the frame that it shows; name another structure or frame");
  return *view;
}

namespace {

/// A view of points that stay as they are when the case goes on.
py::array points_view(const HeldCase& self, const std::string& of) {
  const auto document = document_of(self);
  auto* kept = new std::shared_ptr<const Points>(shown(*document, of).shape.points);
  const py::capsule owner(kept, [](void* points) { delete static_cast<std::shared_ptr<const Points>*>(points); });
  return read_only<double>({(*kept)->rows(), 3}, (*kept)->data(), owner);
}

std::shared_ptr<HeldMesh> mesh_of(const HeldCase& self, const std::string& of) {
  const auto document = document_of(self);
  const MeshFile file = to_mesh_file(shown(*document, of), document->scan.frames() > 1);
  return std::make_shared<HeldMesh>(HeldMesh{std::make_shared<const MeshFile>(file)});
}

py::list structures_of(const HeldCase& self) {
  py::list rows;
  const auto document = document_of(self);
  for (const auto& one : document->structures) {
    py::dict row;
    row["id"] = one->id;
    row["name"] = one->name;
    row["label"] = one->label;
    row["vertices"] = one->the_template->points.rows();
    py::list frames;
    for (const auto& [frame, shape] : one->shapes) frames.append(frame);
    row["frames"] = frames;
    row["confidence"] = one->confidence < 0 ? py::none() : py::object(py::float_(one->confidence));
    row["doubt"] = one->doubt;
    rows.append(row);
  }
  return rows;
}

py::object image_of(const HeldCase& self) {
  const auto document = document_of(self);
  const Scan& scan = document->scan;
  if (!scan.image) return py::none();
  if (!self.image) {
    auto read = std::make_shared<VolumeRead>();
    read->volume = *scan.image;
    self.image = std::make_shared<HeldVolume>(HeldVolume{std::move(read), scan.source, self.image_stamp});
  }
  return py::cast(self.image);
}

}  // namespace

void add_case_views(CaseType& type) {
  using Held = HeldCase;
  type.def("points", &points_view, py::arg("of") = "",
           "n×3, LPS mm, of a structure at the shown frame; a view that cannot be written to and that later edits "
           "leave as it is.")
      .def("mesh", &mesh_of, py::arg("of") = "", "The same as a Mesh, with stiffness and landmarks.")
      .def_property_readonly("structures", &structures_of, "[{id, name, label, vertices, frames, confidence, doubt}].")
      .def_property_readonly(
          "shown_frame", [](const Held& self) { return document_of(self)->frame; }, "From 0.")
      .def_property_readonly(
          "frames", [](const Held& self) { return document_of(self)->scan.frames(); }, "Of the image.")
      .def_property_readonly(
          "strokes", [](const Held& self) { return InUse(self), self.session.strokes(); }, "Those left after undo.")
      .def_property_readonly("image", &image_of, "The scan as a Volume, or None; the same one each time.");
}

}  // namespace homolog::python
