// A case made by program: two strokes, one undo, and the same mesh again from the file alone.
//
//     example_replay [FOLDER]     (FOLDER gets example.homolog; the working folder by default)

#include <cstdio>
#include <filesystem>

#include "core/catalogue/catalogue.h"
#include "core/session/case_file.h"

using namespace homolog;

namespace {

Result<void> run(const std::filesystem::path& file) {
  const auto the_template = load_template("built-in:kidney");
  if (!the_template) return fail(the_template.error());
  auto session = create_case(new_document("", nullptr, *the_template), file);
  if (!session) return fail(session.error());

  // A stroke names the surface point that is taken hold of and where it is dragged to, in LPS mm. Each is on the disk
  // before apply() returns.
  const Vec3 pole = session->document().view()->shape.points->row(0);
  for (const double millimetres : {5.0, 12.0}) {
    Stroke stroke;
    stroke.tool = Tool::grab;
    stroke.at = pole;
    stroke.to = pole + Vec3(0, 0, millimetres);
    stroke.sigma_mm = 20;
    if (const auto done = session->apply(stroke); !done) return fail(done.error());
  }
  if (const auto undone = session->apply(Undo{}); !undone) return fail(undone.error());

  const auto again = read_case(file);
  if (!again) return fail(again.error());
  const double apart = (*again->session.document().view()->shape.points - *session->document().view()->shape.points)
                           .cwiseAbs()
                           .maxCoeff();
  std::printf("strokes left %d, largest difference after replay %g mm\n", again->session.strokes(), apart);
  return again->session.strokes() == 1 && apart <= 1e-9 ? Result<void>{} : fail("", "the replay gave another mesh");
}

}  // namespace

int main(int count, char** arguments) {
  const auto done = run(std::filesystem::path(count > 1 ? arguments[1] : ".") / "example.homolog");
  if (done) return 0;
  std::fprintf(stderr, "%s\n", done.error().sentence().c_str());
  return 1;
}
