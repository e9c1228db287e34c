#include <doctest/doctest.h>

#include "app/editor/window/editor_app.h"
#include "tests/ball.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

namespace homolog {

TEST_CASE("an export during a drag writes what is done and not what is previewed") {
  const TemporaryFolder folder;
  EditorApp app([] {});
  app.start_session(EditSession(ball_document(40)));
  const auto done = app.snapshot().document;
  app.preview(Stroke{Tool::pull, Vec3(0, 0, 40), Vec3(0, 0, 60), 10, {}, false, 1});
  app.update(0);
  REQUIRE(app.snapshot().preview);
  REQUIRE(*app.snapshot().shown->view()->shape.points != *done->view()->shape.points);
  const auto path = folder.path / "done.ply";
  app.send(ExportMesh{path});
  app.settle();
  const auto written = read_mesh_file(path);
  REQUIRE(written);
  CHECK(largest_difference(written->points, *done->view()->shape.points) < 1e-4);
}

}  // namespace homolog
