#include "app/editor/scene/scene_builder.h"

#include <doctest/doctest.h>

#include "core/mesh/construction/icosphere.h"
#include "render/label_colours.h"
#include "tests/ball.h"
#include "tests/changed_shape.h"

namespace homolog {

TEST_CASE("the overlay known follows the frame also where two frames share their points") {
  Document document = ball_document(40, 2);
  Shape begun = document.view()->shape;  // as a frame that was started from the other one
  test::changed_shape(document).decided =
      std::make_shared<const VertexScalars>(VertexScalars::Ones(document.view()->shape.points->rows()));
  document.change({}, [&](Structure& first) { first.set_shape(1, std::move(begun)); });
  EditorState state;
  state.look.colouring = Colouring::known;
  const std::optional<EditReport> no_preview;
  SceneBuilder builder;
  const auto colours_of = [&](int frame) {
    document.frame = frame;
    const SceneBuilder::Input input{state,  std::make_shared<const Document>(document), no_preview, nullptr, nullptr,
                                    nullptr};
    builder.update(input);
    return *builder.scene(input, ViewKind::space).meshes.front().colours;
  };
  const auto decided = colours_of(0), open = colours_of(1);
  CHECK(decided != open);
  CHECK(colours_of(0) == decided);
}

TEST_CASE("the surface of a label is seen through in the 3D view and in no slice") {
  const auto document = std::make_shared<const Document>(ball_document(40, 2));
  EditorState state;
  const std::optional<EditReport> no_preview;
  SceneBuilder builder;
  const auto surface = std::make_shared<const Mesh>(icosphere(3, 42));
  SceneBuilder::Input input{state, document, no_preview, nullptr, nullptr, nullptr, surface, 3};
  builder.update(input);
  const Scene space = builder.scene(input, ViewKind::space);
  REQUIRE(space.meshes.size() == 2);
  CHECK(space.meshes[1].topology == surface->topology);
  CHECK(space.meshes[1].surface_opacity < 0.6f);
  CHECK(space.meshes[1].colours->front() == label_colour(3));
  CHECK(space.meshes[1].points == builder.scene(input, ViewKind::space).meshes[1].points);  // uploaded once
  CHECK(builder.scene(input, ViewKind::axial).meshes.size() == 1);
  input.label_surface = nullptr;
  builder.update(input);
  CHECK(builder.scene(input, ViewKind::space).meshes.size() == 1);
}

namespace {

/// The scene of a state, with what is drawn besides.
struct Shown {
  EditorState state;
  std::optional<EditReport> preview;
  std::shared_ptr<const Volume> labels;
  SceneBuilder builder;

  Scene of(const Document& document, ViewKind view = ViewKind::space) {
    const SceneBuilder::Input input{state,  std::make_shared<const Document>(document), preview, labels, nullptr,
                                    nullptr};
    builder.update(input);
    return builder.scene(input, view);
  }
};

/// A second structure of the same template.
void add_second(Document& document) {
  Structure second = *document.structure();
  second.id = "s2";
  document.structures.push_back(std::make_shared<const Structure>(std::move(second)));
}

}  // namespace

TEST_CASE("what a drag moves of another mesh tints no outline") {
  const Document document = ball_document(40, 2);
  Shown shown;
  const auto plain = *shown.of(document, ViewKind::axial).meshes.front().colours;
  shown.preview.emplace().response =
      std::make_shared<const VertexScalars>(VertexScalars::Ones(document.view()->shape.points->rows()));
  CHECK(*shown.of(document, ViewKind::axial).meshes.front().colours != plain);
  shown.preview->response = std::make_shared<const VertexScalars>(VertexScalars::Ones(3));
  CHECK(*shown.of(document, ViewKind::axial).meshes.front().colours == plain);
}

TEST_CASE("two structures of one template have each its own colour") {
  Document document = ball_document(40, 2);
  document.change({}, [](Structure& first) { first.colour = {255, 0, 0}; });
  add_second(document);
  document.change("s2", [](Structure& second) { second.colour = {0, 0, 255}; });
  Shown shown;
  shown.state.look.colouring = Colouring::structure;
  shown.state.look.structures.hidden = {"s2"};
  const Rgb red = shown.of(document).meshes.front().colours->front();
  shown.state.look.structure = "s2";
  shown.state.look.structures.hidden = {document.structure()->id};
  const Rgb blue = shown.of(document).meshes.front().colours->front();
  CHECK(red[0] > red[2]);
  CHECK(blue[2] > blue[0]);
}

TEST_CASE("a shape as it was read is drawn in its own frame alone") {
  Document document = ball_document(40, 2);
  document.change({}, [](Structure& first) { first.set_shape(1, *first.shape(0)); });
  Shown shown;
  StructureLooks& looks = shown.state.look.structures;
  looks.as_read[document.structure()->id] = document.view()->shape.points;
  looks.as_read_frame = 1;
  CHECK(shown.of(document).meshes.size() == 1);
  document.frame = 1;
  const auto meshes = shown.of(document).meshes;
  REQUIRE(meshes.size() == 2);
  CHECK(meshes[0].yields);  // where both are one, the mesh is seen
  CHECK_FALSE(meshes[1].yields);
}

TEST_CASE("a frame beyond the last of a label map shows the last, as a fit takes it") {
  Document document = ball_document(40, 2);
  Shown shown;
  auto map = std::make_shared<Volume>();
  map->frames = 2;
  shown.labels = map;
  for (const auto& [frame, expected] : {std::pair(0, 0), std::pair(1, 1), std::pair(3, 1)}) {
    document.frame = frame;
    CHECK(shown.of(document).labels.frame == expected);
  }
}

TEST_CASE("glyphs are as large as the organ asks for") {
  for (const double radius_mm : {10.0, 125.0}) {
    const auto document = std::make_shared<const Document>(ball_document(radius_mm, 3));
    EditorState state;
    show_document(state, *document, {});
    state.preferences.show.glyphs = true;
    const std::optional<EditReport> no_preview;
    SceneBuilder builder;
    const SceneBuilder::Input input{state, document, no_preview, nullptr, nullptr, nullptr};
    builder.update(input);
    const Scene scene = builder.scene(input, ViewKind::space);
    CHECK(scene.glyphs.glyphs.size() > 20);
    CHECK(scene.glyphs.glyphs.size() < 300);
    for (const auto& glyph : scene.glyphs.glyphs) {
      CHECK(static_cast<double>(glyph.radius_mm) > 0.02 * radius_mm);
      CHECK(static_cast<double>(glyph.radius_mm) < 0.06 * radius_mm);
    }
  }
}

}  // namespace homolog
