#include <chrono>
#include <memory>

#include "app/verbs/plain_report.h"
#include "app/verbs/verbs.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/deform/volume_carrier.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/parts/rims.h"
#include "core/model/files/model_files.h"
#include "core/model/shapes/shape_files.h"

// The verb `tets`: a user's mesh of tetrahedra in the shape of each case.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct TetsJob {
  fs::path tets, out;
  std::string the_template, group;
  std::vector<fs::path> shapes;
  bool all_frames = false;
};

Result<std::vector<ReadShape>> shapes_to_fill(const TetsJob& job, const std::vector<ShapeSource>& sources,
                                              std::vector<std::string>& warnings, Progress& progress) {
  std::vector<ReadShape> shapes;
  const auto take = [&](ReadShape shape) -> Result<void> {
    shapes.push_back(std::move(shape));
    return {};
  };
  const auto read = read_shapes(sources, {.all_frames = job.all_frames}, take, &progress);
  if (!read) return fail(read.error());
  warnings.insert(warnings.end(), read->begin(), read->end());
  return shapes;
}

fs::path tets_file(const TetsJob& job, const VolumeMesh& mesh, const std::string& name) {
  return job.out / (name + volume_mesh_extension(mesh));
}

/// Errors: a file that would be written is one of those that are read.
Result<void> check_outputs(const TetsJob& job, const std::vector<ShapeSource>& sources, const VolumeMesh& mesh,
                           const std::vector<std::string>& names) {
  std::vector<fs::path> read{job.tets, job.the_template}, written;
  for (const ShapeSource& source : sources) read.push_back(source.file);
  for (const std::string& name : names) written.push_back(tets_file(job, mesh, name));
  return check_not_read(written, read);
}

/// Whether a shape's faces are not the template's, which may be turned.
bool is_numbered_otherwise(const MeshFile& shape, const Template& the_template) {
  const Triangles &faces = *shape.triangles, &known = the_template.topology->triangles();
  return shape.points.rows() == the_template.points.rows() && faces.rows() > 0 && !same_faces(faces, known) &&
         !turned_faces(faces, known);
}

/// A case's row of the report; what is wrong with it becomes a warning. Writes its file unless elements are inverted.
Result<Json> fill_one(const VolumeMesh& mesh, const Template& the_template, const VolumeCarrier& carrier,
                      const ReadShape& shape, const std::string& name, const fs::path& to,
                      std::vector<std::string>& warnings, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  if (is_numbered_otherwise(*shape.mesh, the_template))
    return fail(
        shape.name,
        "has other faces (or another numbering) than the template; give shapes of this template, as homolog fit "
        "makes them");
  const auto carried = carrier.carry(shape.mesh->points, &progress);
  if (!carried) return fail(shape.name, carried.error().what);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  const bool written = carried->inverted == 0;
  constexpr double far_edges = 3;
  const bool slid_far = carried->slid_mm > far_edges * carrier.edge_mm();
  if (written) {
    if (auto done = write_volume_mesh(mesh, carried->points, to); !done) return fail(done.error());
    if (!carried->sound())
      warnings.push_back(shape.name + ": " + std::to_string(carried->poor) +
                         " tetrahedra have a scaled Jacobian below " + plain_number(carrier.asked()) +
                         "; look at them before you compute with this mesh");
    if (carried->lifted_mm > carrier.edge_mm())
      warnings.push_back(shape.name + ": the outside had to leave the surface by up to " +
                         plain_number(carried->lifted_mm) +
                         " mm for the tetrahedra to stay whole; look at the fit there");
    if (slid_far)
      warnings.push_back(shape.name + ": the outside had to slide by up to " + plain_number(carried->slid_mm) +
                         " mm for the tetrahedra to stay whole; look at the fit there");
  } else {
    warnings.push_back(shape.name + ": " + std::to_string(carried->inverted) +
                       " tetrahedra would be turned over, so no mesh was written; give one whose outside is as fine as "
                       "the template, or look at the fit");
  }
  return Json{
      {"name", name},
      {"scaled_jacobian_least", carried->least},
      {"inverted", carried->inverted},
      {"poor", carried->poor},
      {"doubtful", !carried->sound() || carried->lifted_mm > carrier.edge_mm() || slid_far || carrier.is_far_off()},
      {"slid_mm", carried->slid_mm},
      {"lifted_mm", carried->lifted_mm},
      {"file", written ? Json(to.string()) : Json()},
      {"seconds", taken.count()}};
}

Result<Report> fill_shapes(const TetsJob& job, Progress& progress) {
  const auto mesh = read_volume_mesh(job.tets);
  if (!mesh) return fail(mesh.error());
  const auto the_template = load_template(job.the_template);
  if (!the_template) return fail(the_template.error());
  if (!long_rims({(*the_template)->topology, (*the_template)->points}).empty())
    return fail(job.the_template, "is open, so no tetrahedra lie inside it; close it by homolog template --holes all");
  const auto carrier = VolumeCarrier::make(*mesh, {(*the_template)->topology, (*the_template)->points});
  if (!carrier) return fail(job.tets.string(), carrier.error().what);
  Report report;
  for (const std::string& warning : mesh->warnings) report.warnings.push_back(job.tets.string() + ": " + warning);
  if (carrier->is_far_off())
    report.warnings.push_back(job.tets.string() + ": its outside lies up to " + plain_number(carrier->off_mm()) +
                              " mm off the template's surface, and about as far off that of each case; mesh the "
                              "template itself");
  progress.part(0, 0.1);
  const auto sources = shape_sources(job.shapes, job.group);
  if (!sources) return fail(sources.error());
  const auto read = shapes_to_fill(job, *sources, report.warnings, progress);
  if (!read) return fail(read.error());
  const std::vector<ReadShape>& shapes = *read;
  std::vector<std::string> files;
  for (const ReadShape& shape : shapes) files.push_back(shape.name);
  const auto names = shape_names(files);
  if (auto checked = check_outputs(job, *sources, *mesh, names); !checked) return fail(checked.error());
  const auto folder = ResultFolder::make(job.out);
  if (!folder) return fail(folder.error());
  Json cases = Json::array();
  std::size_t refused_cases = 0;
  progress.part(0.1, 1);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    Progress own(progress, 1 / static_cast<double>(shapes.size()));
    if (progress.cancelled()) return fail("", "was cancelled");
    auto row = fill_one(*mesh, **the_template, *carrier, shapes[k], names[k], tets_file(job, *mesh, names[k]),
                        report.warnings, own);
    if (progress.cancelled()) return fail("", "was cancelled");
    if (!row) {
      report.warnings.push_back(row.error().sentence());
      ++refused_cases;
      continue;
    }
    if ((*row)["inverted"] > 0) ++refused_cases;
    if (!(*row)["file"].is_null()) report.made.emplace_back((*row)["file"].get<std::string>());
    cases.push_back(std::move(*row));
  }
  if (refused_cases > 0)
    report.refusal = Error{job.tets.string(), "could not be carried into " + std::to_string(refused_cases) + " of " +
                                                  std::to_string(shapes.size()) + " shapes; the warnings name them"};
  report.values = {{"tetrahedra", mesh->tetrahedra.rows()},
                   {"points", mesh->points.rows()},
                   {"scaled_jacobian_least", carrier->least()},
                   {"scaled_jacobian_asked", carrier->asked()},
                   {"off_mm", carrier->off_mm()},
                   {"cases", std::move(cases)}};
  return report;
}

}  // namespace

void add_tets(CLI::App& app, CommandLine& asked) {
  auto job = std::make_shared<TetsJob>();
  CLI::App* verb = add_verb(app, "tets", "A mesh of tetrahedra of the template, in the shape of each case");
  verb->add_option("TETS", job->tets, "Tetrahedra of the template's inside (.vtu, .msh), as a mesher made them")
      ->required();
  verb->add_option("SHAPE", job->shapes, "Meshes in the template's numbering, cases, folders of these, or a study")
      ->required();
  verb->add_option("--template", job->the_template, "The template that the tetrahedra fill")->required();
  verb->add_option("-o,--output", job->out, "Folder for the tetrahedra of each case, in the format of TETS")
      ->required();
  verb->add_flag("--all-frames", job->all_frames, "Of a cine case every frame that was edited");
  verb->add_option("--group", job->group, "Of a study the cases of this group alone");
  verb->callback([job, &asked] { asked.run = [job](Progress& progress) { return fill_shapes(*job, progress); }; });
}

}  // namespace homolog
