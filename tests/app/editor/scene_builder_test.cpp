#include "app/editor/scene/scene_builder.h"

#include <doctest/doctest.h>

#include "tests/ball.h"

namespace homolog {

TEST_CASE("the overlay known follows the frame also where two frames share their points") {
  Document document = ball_document(40, 2);
  Shape begun = document.shape();  // as a frame that was started from the other one
  document.shapes.at(0).decided =
      std::make_shared<const VertexScalars>(VertexScalars::Ones(document.shape().points->rows()));
  document.shapes.emplace(1, std::move(begun));
  EditorState state;
  state.colouring = Colouring::known;
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

}  // namespace homolog
