#include "app/editor/update/status.h"

#include <doctest/doctest.h>

#include <map>
#include <set>
#include <string>
#include <tuple>

#include "app/editor/update/keys.h"
#include "app/editor/update/tools/tool.h"
#include "core/mesh/construction/icosphere.h"
#include "tests/ball.h"
#include "tests/changed_shape.h"

namespace homolog {

namespace {

Document ball_with(std::size_t landmarks, std::size_t placed) {
  const Mesh ball = icosphere(2, 40);
  MeshFile file{ball.points, ball.topology->triangles()};
  const std::vector<Landmark> all{{"north", Vec3(0, 0, 40)}, {"south", Vec3(0, 0, -40)}, {"east", Vec3(40, 0, 0)}};
  file.landmarks.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(landmarks));
  Document document = new_document("", nullptr, test::must(make_template(std::move(file), "ball")));
  for (std::size_t l = 0; l < placed; ++l) test::changed_shape(document).landmarks[all[l].name] = all[l].position;
  return document;
}

Snapshot snapshot_of(const Document& document) {
  Snapshot snapshot;
  snapshot.document = snapshot.shown = std::make_shared<const Document>(document);
  return snapshot;
}

bool holds_words(const std::string& text, const char* words) {
  return text.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("in every state the status line says what is so") {
  for (std::size_t landmarks = 0; landmarks <= 3; ++landmarks)
    for (std::size_t placed = 0; placed <= landmarks; ++placed) {
      const Document document = ball_with(landmarks, placed);
      const Snapshot snapshot = snapshot_of(document);
      for (const ToolKind* kind : tool_kinds)
        for (const char* chosen : {"", "north", "south", "of another template"}) {
          CAPTURE(landmarks);
          CAPTURE(placed);
          CAPTURE(kind->name);
          CAPTURE(chosen);
          EditorState state;
          state.hand.tool = kind->tool;
          state.hand.landmark = chosen;
          const std::string text = status_of(state, snapshot, document).text;
          CHECK_FALSE(text.empty());
          CHECK_FALSE(holds_words(text, "no mesh"));
          CHECK_FALSE(holds_words(text, "another template"));
          const bool places = kind->tool == MouseTool::landmark;
          CHECK(holds_words(text, "no landmarks yet") == (places && landmarks == 0));
          if (holds_words(text, "placed; drag")) CHECK((places && landmarks > 0 && placed == landmarks));
          if (places && landmarks > placed) CHECK(holds_words(text, "Click where \""));
          for (const auto& [name, at] : document.view()->shape.landmarks)
            CHECK_FALSE(holds_words(text, ("\"" + name + "\" is.").c_str()));
        }
    }
}

TEST_CASE("without an image or a mesh the status line says what is missing whatever the tool") {
  const Document nothing = new_document("", nullptr, nullptr);
  Document other_frame = ball_with(3, 0);
  other_frame.frame = 4;
  for (const ToolKind* kind : tool_kinds) {
    CAPTURE(kind->name);
    EditorState state;
    state.hand.tool = kind->tool;
    CHECK(holds_words(status_of(state, snapshot_of(nothing), nothing).text, "Open an image"));
    other_frame.scan.image = std::make_shared<const Volume>();
    CHECK(holds_words(status_of(state, snapshot_of(other_frame), other_frame).text, "This frame has no mesh yet"));
  }
}

TEST_CASE("what the last edit said goes as soon as something else is in hand") {
  Document document = ball_with(3, 1);
  auto cine = std::make_shared<Volume>();
  cine->frames = 5;
  document.scan.image = cine;
  Snapshot snapshot = snapshot_of(document);
  snapshot.message = "12 vertices painted.";
  EditorState state;
  state.hand.tool = MouseTool::stiffness;
  state.said_in = situation_of(state, document);
  CHECK(status_of(state, snapshot, document).text == snapshot.message);
  EditorState other = state;
  other.hand.tool = MouseTool::landmark;
  CHECK(status_of(other, snapshot, document).text == "Click where \"south\" is.");
  other = state;
  other.hand.brush.paints = BrushPaints::smooth;
  CHECK(status_of(other, snapshot, document).text != snapshot.message);
  other = state;
  other.look.shown_frame = 3;
  CHECK(status_of(other, snapshot, document).text != snapshot.message);

  // A running gesture has a word of its own, and the old one does not come back after it.
  snapshot.preview = EditReport{};
  CHECK(status_of(state, snapshot, document).text != snapshot.message);
  snapshot.preview->stopped_by_guard = true;
  CHECK(status_of(state, snapshot, document).warns);
}

TEST_CASE("the status line says whether the landmark under the pointer is held") {
  Document document = ball_with(2, 1);
  EditorState state;
  state.pointer.hover = Hover{};
  state.pointer.hover->landmark = "north";
  CHECK(holds_words(status_of(state, snapshot_of(document), document).text, "\"north\" is free"));
  Shape& shape = test::changed_shape(document);
  shape.confirmed = std::make_shared<const VertexScalars>(VertexScalars::Ones(shape.points->rows()));
  CHECK(holds_words(status_of(state, snapshot_of(document), document).text, "\"north\" is held"));
  shape.landmarks["north"] = Vec3(0, 0, 60);
  shape.confirmed.reset();
  CHECK(holds_words(status_of(state, snapshot_of(document), document).text, "20.0 mm off \"north\""));
}

TEST_CASE("the status line names the region that the brush paints also before one was chosen") {
  Document document = ball_with(0, 0);
  auto regions = std::make_shared<Regions>(*document.structure()->paint.regions);
  regions->list = {{"cap", 2, {255, 0, 0}}, {"rim", 1, {0, 255, 0}}};
  document.change({}, [&](Structure& first) { first.paint.regions = regions; });
  EditorState state;
  state.hand.tool = MouseTool::stiffness;
  state.hand.brush.paints = BrushPaints::region;
  const auto said = [&] { return status_of(state, snapshot_of(document), document).text; };
  CHECK(said() == "Paint \"cap\"; Alt erases.");
  state.hand.brush.region = "rim";
  CHECK(said() == "Paint \"rim\"; Alt erases.");
  state.hand.brush.erases = true;
  CHECK(holds_words(said(), "out of their region"));
}

TEST_CASE("every tool of the mouse has its row at its place and a name of its own in the log") {
  std::set<std::string> names;
  for (std::size_t place = 0; place < tool_kinds.size(); ++place) {
    const ToolKind& kind = *tool_kinds[place];
    CAPTURE(kind.name);
    CHECK(static_cast<std::size_t>(kind.tool) == place);
    CHECK(&kind_of(kind.tool) == &kind);
    CHECK((kind.begin != nullptr));
    CHECK((kind.hint != nullptr));
    CHECK(names.insert(kind.log_name).second);
  }
}

TEST_CASE("no two rows of keys ask for the same key and each tool with a key is one of them") {
  for (const bool in_models : {false, true}) {
    std::map<std::tuple<int, bool, bool>, std::string> rows;
    for (const KeyRow& row : key_rows(in_models))
      for (const KeyChord& chord : row.chords) {
        const auto [there, is_new] = rows.emplace(std::tuple(chord.code, chord.ctrl, chord.shift), row.does);
        CAPTURE(row.keys);
        CAPTURE(there->second);
        CHECK(is_new);
      }
    if (in_models) continue;
    for (const ToolKind* kind : tool_kinds) {
      CAPTURE(kind->name);
      const std::string key = kind->key;
      REQUIRE(key.size() <= 1);
      if (key.empty()) continue;
      const auto row = rows.find({key[0], false, false});
      REQUIRE((row != rows.end()));
      CHECK(row->second == kind->in_keys);
    }
  }
}

}  // namespace homolog
