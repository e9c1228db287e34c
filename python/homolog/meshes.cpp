#include <map>

#include "app/verbs/describe.h"
#include "core/base/files/file_record.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/shapes/shape_files.h"
#include "core/phantom/phantom.h"
#include "core/phantom/phantom_scene.h"
#include "python/homolog/binding.h"

namespace homolog::python {

namespace {

std::shared_ptr<HeldMesh> held(MeshFile file, std::string source = {}, std::string record = {}) {
  return std::make_shared<HeldMesh>(
      HeldMesh{std::make_shared<const MeshFile>(std::move(file)), std::move(source), std::move(record)});
}

Triangles triangles_from(const py::handle& value, Eigen::Index vertices) {
  const py::array array = array_from(value, "triangles");
  if (array.dtype().kind() != 'i' && array.dtype().kind() != 'u')
    refuse("triangles", "have the dtype " + std::string(py::str(array.dtype())) + "; give whole numbers, as int32");
  if (array.ndim() != 2 || array.shape(1) != 3)
    refuse("triangles", "have the shape " + std::string(py::str(array.attr("shape"))) +
                            "; give m×3, a row of three vertex numbers for each face");
  const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> wide = array;
  Triangles triangles(wide.shape(0), 3);
  for (Eigen::Index k = 0; k < triangles.size(); ++k) {
    const std::int64_t vertex = wide.data()[k];
    if (vertex < 0 || vertex >= vertices)
      refuse("triangles", "name vertex " + std::to_string(vertex) + " at [" + std::to_string(k / 3) + ", " +
                              std::to_string(k % 3) + "], and there are " + std::to_string(vertices) +
                              ", counted from 0");
    triangles.data()[k] = static_cast<std::int32_t>(vertex);
  }
  return triangles;
}

std::vector<Landmark> landmarks_from(const py::object& value) {
  std::vector<Landmark> landmarks;
  if (value.is_none()) return landmarks;
  if (!py::isinstance<py::dict>(value)) refuse("landmarks", "is no dict; give {name: (x, y, z)} in LPS mm");
  for (const auto& [name, position] : value.cast<py::dict>()) {
    const std::string text = py::str(name);
    landmarks.push_back({text, vector_from(position, ("landmark " + text).c_str())});
  }
  return landmarks;
}

py::dict landmarks_to(const std::vector<Landmark>& landmarks) {
  py::dict named;
  for (const Landmark& one : landmarks)
    named[py::str(one.name)] = py::make_tuple(one.position.x(), one.position.y(), one.position.z());
  return named;
}

std::shared_ptr<HeldMesh> mesh_from(const py::object& points, const py::object& triangles, const py::object& stiffness,
                                    const py::object& landmarks, const py::object& doubt_mm) {
  MeshFile file;
  file.points = points_from(points, "points");
  if (!triangles.is_none()) file.triangles = triangles_from(triangles, file.points.rows());
  if (!stiffness.is_none()) {
    file.stiffness = std::make_shared<const VertexScalars>(scalars_from(stiffness, file.points.rows(), "stiffness"));
    if (file.stiffness->minCoeff() <= 0) refuse("stiffness", "is not above 0 everywhere; give factors, 1 is usual");
  }
  if (!doubt_mm.is_none()) file.doubt_mm = scalars_from(doubt_mm, file.points.rows(), "doubt_mm");
  file.landmarks = landmarks_from(landmarks);
  return held(std::move(file));
}

Mesh sound(const HeldMesh& self) {
  auto mesh = sound_mesh(*self.file);
  if (!mesh) refuse(self.source.empty() ? "mesh" : self.source, mesh.error().what);
  return std::move(*mesh);
}

/// `values`: a pointer or an optional; none where it is empty.
template <class Values>
py::object scalars_view(const Values& values, const py::object& self) {
  if (!values) return py::none();
  return read_only<double>({values->size()}, values->data(), self);
}

std::shared_ptr<HeldMesh> read_held_mesh(const std::string& source) {
  if (!names_file(source)) return held(to_mesh_file(*value_of(load_template(source))), source);
  const FileStamp stamp(source);
  auto file = value_of(read_mesh_file(source));
  warn(file.warnings);
  const auto record = value_of(read_record(source));
  const auto mesh = held(std::move(file), source, record.value_or(""));
  mesh->stamp = stamp;
  return mesh;
}

/// Reads a file that will not stay.
std::shared_ptr<HeldMesh> loaded(const std::string& file) {
  const auto mesh = read_held_mesh(file);
  mesh->source.clear();
  mesh->stamp = {};
  return mesh;
}

void write_held_mesh(const HeldMesh& self, const std::filesystem::path& path) {
  MeshFile file = *self.file;
  file.record = self.record;
  value_of(write_mesh_file(file, path));
}

std::shared_ptr<HeldMesh> with_points(const HeldMesh& self, const py::object& points) {
  MeshFile file = *self.file;
  file.points = points_from(points, "points");
  if (file.points.rows() != self.file->points.rows())
    refuse("points", "has " + std::to_string(file.points.rows()) + " rows and the mesh " +
                         std::to_string(self.file->points.rows()) + " vertices; give a row for each vertex");
  file.doubt_mm.reset();  // of places that the vertices have left
  file.outlier.reset();
  return held(std::move(file));
}

/// The same mesh with values of vertices as they were, which a file keeps with fewer digits or not at all.
std::shared_ptr<HeldMesh> with_values(const HeldMesh& self, const std::map<std::string, py::object>& values) {
  MeshFile file = *self.file;
  for (const auto& [name, given] : values) {
    const py::array_t<double, py::array::c_style | py::array::forcecast> numbers = array_from(given, name);
    if (numbers.size() != file.points.rows()) refuse(name, "does not hold one number for each vertex");
    const VertexScalars scalars = Eigen::Map<const VertexScalars>(numbers.data(), numbers.size());
    if (name == "stiffness")
      file.stiffness = std::make_shared<const VertexScalars>(scalars);
    else if (name == "doubt_mm")
      file.doubt_mm = scalars;
    else
      file.arrays[name] = scalars;
  }
  return held(std::move(file), {}, self.record);
}

std::shared_ptr<HeldLabels> label_map_of(const HeldMesh& self, const HeldVolume& like, int value) {
  if (value < 1 || value > 32767) refuse("value", "is " + std::to_string(value) + "; give a label from 1 to 32767");
  auto read = std::make_shared<VolumeRead>();
  const Mesh mesh = sound(self);
  const VolumeGeometry& grid = like.read->volume.geometry;
  const std::string name = self.source.empty() ? "mesh" : self.source,
                    like_name = like.source.empty() ? "the volume" : like.source;
  bool is_empty = false;
  {
    const py::gil_scoped_release unlocked;
    read->volume = label_map(mesh, grid, value);
    is_empty = labels_of(read->volume).empty();
  }
  auto warnings = mesh_warnings(name, {}, mesh);  // those of its file were said as it was read
  if (const auto misfit = misfit_in_image(bounds_of(mesh.points), grid))
    warnings.push_back(
        misfit_sentence(*misfit, meeting_of(name, mesh.points), {like_name, grid.bounds_mm().diagonal().norm()}));
  else if (is_empty)
    warnings.push_back(name + " lies outside " + like_name +
                       ", so the label map is empty; check that both are in the same space (LPS or RAS)");
  warn(warnings);
  auto map = std::make_shared<HeldLabels>();
  map->read = std::move(read);
  return map;
}

/// What a phantom subject is in Python.
py::dict phantom_parts(std::shared_ptr<HeldVolume> image, VolumeRead map, const py::object& truth) {
  auto labels = std::make_shared<HeldLabels>();
  labels->read = std::make_shared<VolumeRead>(std::move(map));
  py::dict parts;
  parts["image"] = std::move(image);
  parts["labels"] = std::move(labels);
  parts["truth"] = truth;
  return parts;
}

py::dict spine_phantom_of(int subject) {
  std::optional<PhantomScene> made;
  do_watched({py::none(), {}}, [&](Progress& own) { made.emplace(make_spine_phantom(subject, 0, &own)); });
  auto image = std::make_shared<HeldVolume>();
  image->read = std::make_shared<VolumeRead>(VolumeRead{std::move(made->image), {}, {}, {}});
  py::dict truth;
  for (SceneStructure& one : made->structures) truth[py::str(one.name)] = held(std::move(one.truth));
  return phantom_parts(std::move(image), {std::move(made->label_map), {}, std::move(made->segmentation), {}}, truth);
}

py::dict phantom_of(const std::string& organ, int subject) {
  if (subject < 0) refuse("subject", "is negative; give 0 for the mean shape, or more");
  if (organ == "spine") return spine_phantom_of(subject);
  const Organ which = value_of(organ_from_name(organ));
  std::optional<PhantomSubject> made;
  do_watched({py::none(), {}}, [&](Progress& own) { made.emplace(make_phantom(which, subject, 0, &own)); });
  auto image = std::make_shared<HeldVolume>();
  image->source = phantom_source(which, subject);
  image->read = std::make_shared<VolumeRead>(VolumeRead{std::move(made->image), {}, {}, {}});
  py::list truth;
  for (MeshFile& one : made->truth) truth.append(held(std::move(one)));
  return phantom_parts(std::move(image), {std::move(made->label_map), {}, {}, {}}, truth);
}

}  // namespace

void add_meshes(py::module_& module) {
  using Held = HeldMesh;
  const auto none = py::none();
  py::class_<HeldMesh, std::shared_ptr<HeldMesh>> mesh(
      module, "Mesh",
      "A triangle mesh, or a template: points (LPS mm), faces, values of vertices. It is never changed.");
  mesh.def(py::init(&mesh_from), py::arg("points"), py::arg("triangles") = none, py::kw_only(),
           py::arg("stiffness") = none, py::arg("landmarks") = none, py::arg("doubt_mm") = none,
           R"(A mesh of arrays, which are copied once.

points: n×3, LPS mm. triangles: m×3 vertex numbers from 0, counter-clockwise seen from outside. stiffness: n factors
above 0. landmarks: {name: (x, y, z)}, LPS mm. doubt_mm: n.
Errors: shape, dtype, numbers that are not finite, numbers of no vertex.)")
      .def_property_readonly(
          "source", [](const Held& self) { return text_of_system(self.source); },
          "The file it was read from, or a built-in name; empty where it was made here.")
      .def_property_readonly(
          "_file", [](const Held& self) { return text_of_system(self.stamp.holds() ? self.source : std::string()); })
      .def_property_readonly("_built_in",
                             [](const Held& self) { return names_file(self.source) ? std::string() : self.source; })
      .def("__repr__",
           [](const Held& self) {
             return "<homolog.Mesh of " + std::to_string(self.file->points.rows()) + " vertices and " +
                    std::to_string(self.file->triangles.rows()) + " faces>";
           })
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            const Points& points = self.cast<const Held&>().file->points;
            return read_only<double>({points.rows(), 3}, points.data(), self);
          },
          "n×3, LPS mm; a view that cannot be written to.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            const Triangles& faces = self.cast<const Held&>().file->triangles;
            return read_only<std::int32_t>({faces.rows(), 3}, faces.data(), self);
          },
          "m×3 vertex numbers; a view that cannot be written to.")
      .def_property_readonly(
          "stiffness",
          [](const py::object& self) { return scalars_view(self.cast<const Held&>().file->stiffness, self); },
          "n factors, or None.")
      .def_property_readonly(
          "doubt_mm",
          [](const py::object& self) { return scalars_view(self.cast<const Held&>().file->doubt_mm, self); },
          "n: of a fit, how far (mm, root mean square) each vertex might be from where it belongs; or None.")
      .def_property_readonly(
          "outlier", [](const py::object& self) { return scalars_view(self.cast<const Held&>().file->outlier, self); },
          "n: of a partial fit, 1 where the target lacks the vertex's place; or None.")
      .def_property_readonly(
          "arrays",
          [](const py::object& self) {
            py::dict arrays;
            for (const auto& [name, values] : self.cast<const Held&>().file->arrays)
              arrays[py::str(name)] = read_only<double>({values.size()}, values.data(), self);
            return arrays;
          },
          "{name: n values} of whatever else its file has.")
      .def_property_readonly(
          "landmarks", [](const Held& self) { return landmarks_to(self.file->landmarks); },
          "{name: (x, y, z)}, LPS mm.")
      .def_property_readonly(
          "comments", [](const Held& self) { return self.file->comments; }, "Of its file.")
      .def_property_readonly(
          "volume_ml", [](const Held& self) { return enclosed_volume_ml(sound(self)); },
          "Enclosed volume, ml; holes are capped flat.")
      .def_property_readonly(
          "area_mm2", [](const Held& self) { return surface_area_mm2(sound(self)); }, "mm².")
      .def(
          "describe",
          [](const Held& self) {
            const std::string name = self.source.empty() ? "mesh" : self.source;
            return to_python(
                watched_value<Report>({py::none(), {}}, [&](Progress&) { return describe(*self.file, name); }).values);
          },
          "The figures that `homolog info --json` prints of a mesh, as a dict. Errors: faces that are no manifold "
          "surface.")
      .def("with_points", &with_points, py::arg("points"), "The same mesh with other points (n×3, LPS mm).")
      .def("_with_values", &with_values, py::arg("values"))
      .def(
          "label_map", &label_map_of, py::arg("like"), py::arg("value") = 1,
          "The voxels of a volume's grid whose centre lies inside, as a LabelMap. Warns where there are none, or where "
          "sizes or places say that the two do not belong together.")
      .def("write", &write_held_mesh, py::arg("path"),
           "Writes PLY, VTK, VTP, VTU, OBJ, GIFTI, Gmsh, STL or .particles, by the ending, whole or not at all. PLY "
           "keeps all.")
      .def("__len__", [](const Held& self) { return self.file->points.rows(); });
  module.def(
      "read_mesh", [](const std::filesystem::path& path) { return read_held_mesh(path.string()); }, py::arg("path"),
      "Reads a mesh (PLY, VTK, VTP, VTU, OBJ, GIFTI, Gmsh, STL, MNI, .particles), its points turned to LPS where the "
      "file says RAS.");
  module.def("loaded", &loaded, py::arg("path"), "read_mesh of a file that is removed afterwards.");
  module.def(
      "load_template",
      [](const py::object& source) {
        return read_held_mesh(path_from(source, "source", "a file, or a name as built-in:kidney"));
      },
      py::arg("source"),
      "A template: \"built-in:kidney\", \"built-in:vertebra\", \"built-in:ventricle\", or a mesh file.");
  module.def(
      "read_landmarks", [](const std::filesystem::path& path) { return landmarks_to(value_of(read_landmarks(path))); },
      py::arg("path"), "{name: (x, y, z)} of .mrk.json, .fcsv or scalismo's .json, LPS mm.");
  module.def(
      "write_landmarks",
      [](const py::object& landmarks, const std::filesystem::path& path) {
        value_of(write_landmarks(landmarks_from(landmarks), path));
      },
      py::arg("landmarks"), py::arg("path"), "Writes {name: (x, y, z)} (LPS mm) as .mrk.json, .fcsv or .json.");
  module.def("phantom", &phantom_of, py::arg("organ"), py::arg("subject"),
             R"(A made-up subject whose truth is known: {"image": Volume, "labels": LabelMap, "truth": [Mesh]}.

organ: "kidney", "vertebra", "ventricle", or "spine", whose labels have names and whose truth is {name: Mesh}. subject: 0
is the mean shape.)");
}

}  // namespace homolog::python
