#include "app/pictures/pictures.h"

#include "core/base/pictures/picture_io.h"
#include "core/base/pictures/picture_module.h"
#include "python/homolog/binding.h"
#include "python/homolog/held_case.h"
#include "python/homolog/held_model.h"

namespace homolog::python {

namespace {

struct HeldPicture {
  Picture picture;
};

py::bytes png_of(const HeldPicture& self) {
  const auto* module = value_of(picture_module());
  const auto bytes = value_of(module->encode(self.picture, "picture.png"));
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

MontageOptions options_from(const std::pair<int, int>& size, const std::string& view, const std::string& ground) {
  MontageOptions options;
  if (size.first < 16 || size.second < 16 || size.first > 16384 || size.second > 16384)
    refuse("size", "is out of range; give (width, height) from 16 to 16384 pixels");
  std::tie(options.width_px, options.height_px) = size;
  options.from = value_of(direction_from_name(view));
  if (ground != "dark" && ground != "light" && ground != "transparent")
    refuse("ground", "is \"" + ground + "\"; give dark, light or transparent");
  options.light = ground == "light";
  options.transparent = ground == "transparent";
  return options;
}

std::shared_ptr<HeldPicture> drawn(const std::function<Result<MadePicture>()>& draw) {
  auto made = watched_value<MadePicture>({py::none(), {}}, [&](Progress&) { return draw(); });
  return std::make_shared<HeldPicture>(HeldPicture{std::move(made.picture)});
}

std::shared_ptr<HeldPicture> of_meshes(const py::iterable& meshes, const MontageOptions& options) {
  std::vector<Mesh> shapes;
  std::vector<std::string> names;
  for (const auto& given : meshes) {
    const std::string name = "mesh " + std::to_string(shapes.size());
    const auto one = mesh_in(given);
    if (!one)
      refuse(name, "is a " + std::string(py::str(py::type::of(given).attr("__name__"))) + "; give a Mesh or a Fit");
    names.push_back(one->source.empty() ? name : one->source);
    auto mesh = sound_mesh(*one->file);
    if (!mesh) refuse(names.back(), mesh.error().what);
    if (!shapes.empty()) {
      if (mesh->topology->hash() != shapes.front().topology->hash())
        refuse(names.back(), "has another numbering or other faces than " + names.front() +
                                 "; only shapes in correspondence can be shown together");
      mesh->topology = shapes.front().topology;
    }
    shapes.push_back(std::move(*mesh));
  }
  if (shapes.empty()) refuse("meshes", "are none; give at least one");
  return drawn([&] { return correspondence_picture(shapes, names, options); });
}

}  // namespace

void add_pictures(py::module_& module) {
  py::class_<HeldPicture, std::shared_ptr<HeldPicture>>(module, "Picture", "A picture; a notebook shows it inline.")
      .def_property_readonly(
          "array",
          [](const py::object& self) {
            const Picture& picture = self.cast<const HeldPicture&>().picture;
            return read_only<std::uint8_t>({picture.height, picture.width, 4}, picture.rgba.data(), self);
          },
          "height×width×4 uint8, RGBA, top row first; a view that cannot be written to.")
      .def("_repr_png_", &png_of)
      .def(
          "write",
          [](const HeldPicture& self, const std::filesystem::path& path) {
            value_of(write_picture(self.picture, path));
          },
          py::arg("path"), "Writes it as .png.");
  const auto size = std::make_pair(1280, 960);
  module.def(
      "picture_of_meshes",
      [](const py::iterable& meshes, const std::pair<int, int>& asked, const std::string& view,
         const std::string& ground) { return of_meshes(meshes, options_from(asked, view, ground)); },
      py::arg("meshes"), py::kw_only(), py::arg("size") = size, py::arg("view") = "anterior",
      py::arg("ground") = "dark",
      "Shapes (Meshes or Fits) in correspondence as a grid; equal hues are equal vertices.");
  module.def(
      "picture_of_modes",
      [](const HeldModel& model, int modes, const std::pair<int, int>& asked, const std::string& view,
         const std::string& ground) {
        const MontageOptions options = options_from(asked, view, ground);
        return drawn([&] { return modes_picture(*model.model, modes, options); });
      },
      py::arg("model"), py::kw_only(), py::arg("modes") = 2, py::arg("size") = size, py::arg("view") = "anterior",
      py::arg("ground") = "dark", "Modes of a model: -3, 0 and +3 standard deviations, a row for each.");
  module.def(
      "picture_of_case",
      [](const HeldCase& of, const std::pair<int, int>& asked, const std::string& view, const std::string& ground) {
        const MontageOptions options = options_from(asked, view, ground);
        const auto document = document_of(of);
        return drawn([&] { return case_picture(*document, options); });
      },
      py::arg("case"), py::kw_only(), py::arg("size") = size, py::arg("view") = "anterior", py::arg("ground") = "dark",
      "A case: three slices with the outline, and the shape in 3D.");
}

}  // namespace homolog::python
