#include "core/model/shapes/case_of_shape.h"

#include "core/base/files/files.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/session/case_file.h"

namespace homolog {

namespace fs = std::filesystem;

Result<fs::path> make_case_of_shape(const MeshFile& shape, const std::shared_ptr<const Topology>& faces,
                                    const std::string& name, const fs::path& folder) {
  if (!is_file_name(name)) return fail(name, "cannot be the name of a file; rename the case in the study");
  MeshFile imported = shape;
  if (imported.triangles.rows() == 0) {
    if (!faces || faces->vertices() != shape.points.rows()) {
      return fail(name,
                  "has points only, and the editor needs faces between them; set a mesh of the same numbering as "
                  "the study's template");
    }
    imported.triangles = faces->triangles();
  }
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());
  std::error_code error;
  std::string stem = name;
  for (int number = 2; fs::exists(folder / (stem + case_extension), error); ++number)
    stem = name + "-" + std::to_string(number);
  const fs::path mesh = folder / (stem + "-imported.ply");
  if (auto written = write_mesh_file(imported, mesh); !written) return fail(written.error());
  auto the_template = load_template(mesh.string());
  if (!the_template) return fail(the_template.error());
  const fs::path file = folder / (stem + case_extension);
  if (auto session = create_case(new_document("", nullptr, *the_template), file); !session)
    return fail(session.error());
  return file;
}

}  // namespace homolog
