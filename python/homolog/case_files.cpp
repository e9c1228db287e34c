#include "app/verbs/read_image.h"
#include "core/case/action_json.h"
#include "core/catalogue/catalogue.h"
#include "core/session/case_file.h"
#include "python/homolog/case_parts.h"

// A case is opened, made, saved and closed.

namespace homolog::python {

namespace {

std::shared_ptr<HeldCase> held(EditSession session, const std::filesystem::path& path,
                               const std::vector<std::string>& warnings) {
  warn(warnings);
  return std::make_shared<HeldCase>(std::move(session), path);
}

std::shared_ptr<HeldCase> open_held(const std::filesystem::path& path, bool read_only, const py::object& progress) {
  auto read = watched_value<CaseRead>({progress, {}}, [&](Progress& own) {
    ReplayOptions options;
    options.progress = &own;
    // From the root: the file has to be found again when the program changes its folder.
    return read_only ? read_case(path, options) : open_case(absolute_path(path), &own);
  });
  return held(std::move(read.session), path, read.warnings);
}

std::shared_ptr<const Template> template_from(const py::object& value) {
  if (const auto mesh = mesh_in(value)) {
    const bool has_changed = names_file(mesh->source) && !mesh->stamp.holds();
    if (mesh->source.empty() || has_changed) return value_of(make_template(*mesh->file, ""));
    return value_of(load_template(mesh->source));
  }
  if (py::isinstance<py::array>(value))
    refuse("template", "is an array of numpy, which has no faces; give homolog.Mesh(points, triangles)");
  return value_of(load_template(path_from(value, "template", "a Mesh, a file, or a name as built-in:kidney")));
}

/// The file for a case, from the root. Errors: it is there already, and nobody said that it may be replaced.
std::filesystem::path file_for_case(const std::filesystem::path& path, bool overwrite) {
  auto file = absolute_path(path);
  std::error_code ignored;
  if (!overwrite && std::filesystem::is_regular_file(file, ignored))
    refuse(path.string(),
           "is there already; give overwrite=True to replace it, or go on with a case by homolog.Case.open");
  return file;
}

std::shared_ptr<HeldCase> create_held(const py::object& the_template, const py::object& image, const py::object& path,
                                      const py::object& placement, bool overwrite, const py::object& progress) {
  std::filesystem::path file;
  if (!path.is_none()) file = file_for_case(path.cast<std::filesystem::path>(), overwrite);
  auto reference = template_from(the_template);
  std::optional<Similarity> place;
  if (!placement.is_none()) {
    const Json given = to_json(placement);
    auto read = similarity_from_json(given);
    if (!read) refuse("placement", read.error().what);
    place = *read;
  }
  std::string source;
  std::shared_ptr<const VolumeRead> read;
  if (py::isinstance<HeldVolume>(image)) {
    const auto& given = image.cast<const HeldVolume&>();
    // A case must not name a file that holds something else by now.
    if (!names_file(given.source) || given.stamp.holds()) source = given.source;
    read = given.read;
  } else if (py::hasattr(image, "dataobj")) {
    refuse("image", "is one of nibabel; give homolog.from_nibabel(image)");
  } else if (py::isinstance<py::array>(image)) {
    refuse("image", "is an array of numpy, which does not say where it lies; give homolog.Volume(array, affine=...)");
  } else if (!image.is_none()) {
    source = path_from(image, "image", "a Volume, a file, or a name as phantom:kidney:1");
    read = std::make_shared<const VolumeRead>(watched_value<VolumeRead>({progress, {}}, [&](Progress& own) {
      VolumeReadOptions options;
      options.progress = &own;
      return load_volume(source, options);
    }));
    warn(read->warnings);
  }
  const auto volume = read ? std::shared_ptr<const Volume>(read, &read->volume) : nullptr;
  const auto with_image = [&](std::shared_ptr<HeldCase> made) {
    if (read) made->image = std::make_shared<HeldVolume>(HeldVolume{read, source, made->image_stamp});
    return made;
  };
  if (path.is_none()) return with_image(held(EditSession(new_document(source, volume, reference, place)), {}, {}));
  if (reference->source.empty())
    refuse("template", "is in memory alone, and a case names its file; write it to one and read that");
  if (volume && source.empty())
    refuse("image", "is in memory alone, and a case names its file; write it to one and read that");
  return with_image(held(value_of(create_case(new_document(source, volume, reference, place), file)), file, {}));
}

void save_as(HeldCase& self, const std::filesystem::path& path, bool overwrite) {
  const InUse held(self);
  Journal* const journal = self.session.journal();
  const bool is_own =
      journal != nullptr && journal->is_at(absolute_path(path)) && journal->fate() == Journal::Fate::as_left;
  const auto file = file_for_case(path, overwrite || is_own);
  value_of(save_case_as(self.session, file));
  self.source = file.string();
  self.is_written = true;
  self.is_closed = false;
}

void close(HeldCase& self) {
  const InUse held(self);
  self.session.close_journal();
  self.is_closed = !self.source.empty();
}

}  // namespace

void add_case_files(CaseType& type) {
  using Held = HeldCase;
  const auto none = py::none();
  type.def_static("open", &open_held, py::arg("path"), py::kw_only(), py::arg("read_only") = false,
                  py::arg("progress") = none, "Opens a case file; further edits are appended to it, unless read_only.")
      .def_static("create", &create_held, py::arg("template"), py::arg("image") = none, py::arg("path") = none,
                  py::kw_only(), py::arg("placement") = none, py::arg("overwrite") = false, py::arg("progress") = none,
                  R"(A new case; without `path` it is in memory alone.

template: a Mesh, a Fit, a file or a built-in name. image: a Volume, a file or a phantom's name. placement: {"rotation":
[w, x, y, z], "scale": s, "translation": [x, y, z]}, LPS mm; without it the middle of the image. overwrite: a file that
is there already is replaced.
Errors: the file is there already; a template or an image that is in memory alone, where the case has a file.)")
      .def_property_readonly(
          "source", [](const Held& self) { return text_of_system(self.source); },
          "Its file, from the root; empty: it has none.")
      .def_property_readonly("_is_in_file",
                             [](const Held& self) {
                               const InUse held(self);
                               return self.is_written || !self.session.edited();
                             })
      .def("save_as", &save_as, py::arg("path"), py::kw_only(), py::arg("overwrite") = false,
           "Writes the case to another file and goes on there. Refused where the file is there already, unless "
           "overwrite.")
      .def("close", &close, "Ends the work on its file. Later edits are refused.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](Held& self, const py::args&) { close(self); });
}

}  // namespace homolog::python
