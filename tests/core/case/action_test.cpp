#include <doctest/doctest.h>

#include "core/case/action_json.h"
#include "core/case/action_line.h"
#include "core/case/packed.h"
#include "core/session/line_kind.h"
#include "tests/docs_page.h"
#include "tests/must.h"

namespace homolog {

namespace {

/// An action, the bytes of its line, and what the Undo menu calls it.
struct KnownLine {
  Action action;
  std::string line, name;
};

const Vec3 here(-21.5, 20, 1.0 / 3);
const std::string written_here = R"("at":[-21.5,20.0,0.3333333333333333])";

std::vector<KnownLine> strokes() {
  const Vec3 to(-19, 1e-7, 9e8);
  const std::string from_to = written_here + R"(,"to":[-19.0,1e-07,900000000.0],"sigma_mm":12.5)";
  return {
      {Stroke{Tool::pull, here, to, 12.5, {}, false, 1}, R"({"tool":"pull",)" + from_to + "}", "pull"},
      {Stroke{Tool::pull, here, to, 12.5, Vec3(1, 2, 3), true, 1},
       R"({"tool":"pull",)" + from_to + R"(,"on":[1.0,2.0,3.0],"through_space":true})", "pull"},
      {Stroke{Tool::grab, here, to, 12.5, {}, true, 1}, R"({"tool":"grab",)" + from_to + R"(,"through_space":true})",
       "grab"},
      {Stroke{Tool::slide, here, to, 12.5, {}, false, 1}, R"({"tool":"slide",)" + from_to + "}", "slide"},
      {Stroke{Tool::relax, here, to, 12.5, {}, false, 0.7}, R"({"tool":"relax",)" + from_to + R"(,"strength":0.7})",
       "relax"},
  };
}

std::vector<KnownLine> edits_of_the_mesh() {
  const Similarity placement{Eigen::Quaterniond(0.6, 0, 0.8, 0), 1.1, Vec3(3, 0.1, -7)};
  const std::string placed = R"("placement":{"rotation":[0.6,0.0,0.8,0.0],"scale":1.1,"translation":[3.0,0.1,-7.0]})";
  const auto points = std::make_shared<const Points>(Points{{1, 2.5, -3}, {0.1, 1e-300, 6}});
  const std::string numbers = R"("points":[1.0,2.5,-3.0,0.1,1e-300,6.0])";
  using Moves = const std::vector<std::uint32_t>;
  const auto moves = std::make_shared<Moves>(Moves{0, 65537, 4, 0, 0, 4294967295U});
  return {
      {SetPlacement{placement}, "{" + placed + "}", "placement"},
      {SetPoints{FoundBy::fit, placement, points}, "{" + numbers + R"(,"by":"fit",)" + placed + "}", "fit"},
      {SetPoints{FoundBy::other, {}, points}, "{" + numbers + R"(,"by":""})", "points"},
      {SetPoints{PointsFinder("a hand"), {}, points}, "{" + numbers + R"(,"by":"a hand"})", "a hand"},
      {MovePoints{FoundBy::snap, {}, moves},
       R"({"by":"snap","moved":{"landmarks":2,"steps":"eAEVwYEJAAAMAiCD/f9yI5WjpoKaPihqBAM="}})", "snap"},
      {MovePoints{FoundBy::fit, {}, moves, {}, {}, doubt_on_grid(VertexScalars{{0.5, 3.001}})},
       R"({"by":"fit","moved":{"landmarks":2,"steps":"eAEVwYEJAAAMAiCD/f9yI5WjpoKaPihqBAM="},"doubt_mm":"eAFrYGBgZgACAAQXAIQ="})",
       "fit"},
      {PlaceLandmark{"x", here}, R"({"landmark":{"name":"x",)" + written_here + "}}", "landmark x"},
      {PlaceLandmark{"x", {}}, R"({"landmark":{"name":"x","at":null}})", "landmark x"},
      {SetLandmarkPull{LandmarkPull::off}, R"({"landmark_fit":"off"})", "landmark fit"},
      {SetTemplateLandmark{"x", here}, R"({"template_landmark":{"name":"x",)" + written_here + "}}",
       "template landmark x"},
      {Confirm{here, 10, false}, R"({"confirm":{)" + written_here + R"(,"radius_mm":10.0,"hold":false}})", "release"},
      {MirrorTemplate{}, R"({"mirror":"sagittal","keeps":"centre"})", "mirror"},
      {MirrorTemplate{false}, R"({"mirror":"sagittal"})", "mirror"},
      {SetFrame{3, false}, R"({"frame":3,"look":true})", "frame"},
      {SetFrame{3, true}, R"({"frame":3})", "frame"},
      {StartFrameFrom{2}, R"({"start_frame_from":2})", "copy of a frame"},
      {SetStructure{.id = "s2", .name = "l", .label = "5", .layer = 1, .colour = {{1, 255, 16}}, .source = "a.ply"},
       R"({"structure":{"id":"s2","name":"l","label":"5","layer":1,"colour":[1,255,16],"template":"a.ply"}})",
       "new structure l"},
      {SetStructure{.id = "s2", .name = "m"}, R"({"structure":{"id":"s2","name":"m"}})", "change of m"},
      {SetStructure{.id = "s2", .confidence = 0.25, .doubt = "why"},
       R"({"structure":{"id":"s2","confidence":0.25,"doubt":"why"}})", "change of s2"},
      {SetStructure{.id = "s2",
                    .side = Side::left,
                    .partner = "s3",
                    .shared = {{{"s1", std::make_shared<const std::vector<VertexPair>>(
                                           std::vector<VertexPair>{{0, 3}, {40, 1}})}}}},
       R"({"structure":{"id":"s2","side":"left","partner":"s3","shared":[{"with":"s1","vertices":"0:3 40:1"}]}})",
       "change of s2"},
      {SetStructure{.id = "s2", .side = Side::none, .partner = "", .shared = std::vector<SharedWith>{}},
       R"({"structure":{"id":"s2","side":"none","partner":"","shared":[]}})", "change of s2"},
      {SetContours{.id = "c1",
                   .name = "l",
                   .curves = std::make_shared<const std::vector<Contour>>(
                       std::vector<Contour>{{{Vec3(1, 2, 3), Vec3(4, 5.5, 6)}, false}}),
                   .off_mm = 0.5,
                   .outside = true},
       R"({"contours":{"id":"c1","name":"l","off_mm":0.5,"side":"outside","curves":[{"points":[1.0,2.0,3.0,4.0,5.5,6.0],"closed":false}]}})",
       "contour l"},
      {SetContours{.id = "c1", .outside = false}, R"({"contours":{"id":"c1","side":"boundary"}})",
       "change of contour c1"},
      {RemoveContours{"c1"}, R"({"remove_contours":"c1"})", "removal of contour c1"},
      {RemoveStructure{"s2"}, R"({"remove_structure":"s2"})", "removal of s2"},
  };
}

std::shared_ptr<const KeptLooks> kept_looks() {
  KeptLooks looks;
  looks.active = "s2";
  looks.hidden = {"s1"};
  looks.opacity = {{"s1", 0.5}};
  return std::make_shared<const KeptLooks>(std::move(looks));
}

KeptLooks kept_choices() {
  KeptLooks looks;
  looks.as_read_hidden = true;
  looks.set = "sets/spine.set.json";
  looks.recipe = "femur";
  looks.measured = {"neck"};
  looks.model = "../femur.json";
  return looks;
}

std::shared_ptr<const KeptMapFit> kept_map_fit() {
  KeptMapFit fit;
  InFittedMap in;
  in.name = "L3";
  in.value = 22;
  in.mesh = "0a";
  in.p_named = 0.75;
  in.as_read = {-1.5, 0, 2.25};
  fit.structures["s1"] = std::move(in);
  fit.changes = {0, 17, 4, 0, 22};
  return std::make_shared<const KeptMapFit>(std::move(fit));
}

/// Steps of 2⁻¹⁶ mm.
std::string packed_coordinates() {
  const std::vector<std::uint32_t> steps{static_cast<std::uint32_t>(-98304), 0, 147456};
  return packed<std::uint32_t>(steps);
}
std::string packed_changes() {
  return packed<std::uint32_t>(kept_map_fit()->changes);
}

std::vector<KnownLine> settings_and_marks() {
  const auto factors = std::make_shared<const VertexScalars>(VertexScalars{{1, 0.1, 5}});
  const std::string brush = written_here + R"(,"radius_mm":10.0)";
  return {
      {PaintStiffness{here, 10, 50, 0}, R"({"stiffness":{)" + brush + R"(,"value":50.0,"soft":0.0}})",
       "stiffness brush"},
      {SmoothStiffness{here, 10, 0.25}, R"({"smooth_stiffness":{)" + brush + R"(,"strength":0.25}})",
       "smoothing of the stiffness"},
      {SetStiffnessBase{7.5}, R"({"stiffness_base":7.5})", "stiffness"},
      {SetStiffnessFactors{factors}, R"({"stiffness_factors":[1.0,0.1,5.0]})", "imported stiffness"},
      {PaintRegion{"a", here, 10, 0.5}, R"({"paint_region":{"name":"a",)" + brush + R"(,"soft":0.5}})",
       "painting of a"},
      {FillRegion{"a", here, FillRegion::By::region, 0.05},
       R"({"fill_region":{"name":"a",)" + written_here + R"(,"by":"region"}})", "filling of a"},
      {FillRegion{"", here, FillRegion::By::curvature, 0.3},
       R"({"fill_region":{"name":"",)" + written_here + R"(,"by":"curvature","tolerance_per_mm":0.3}})", "emptying"},
      {SetRegion{Region{"ü", 2, {1, 255, 16}}}, R"({"region":{"name":"ü","factor":2.0,"colour":"#01ff10"}})",
       "region ü"},
      {RenameRegion{"a", "b"}, R"({"rename_region":{"name":"a","to":"b"}})", "renaming to b"},
      {RemoveRegion{"a"}, R"({"remove_region":"a"})", "removal of a"},
      {SetScheme{Scheme::paper, 3}, R"({"scheme":"paper","events":3})", "scheme"},
      {SetEvenSpacing{0.5}, R"({"spacing":0.5})", "even spacing"},
      {Note{"a \"b\""}, R"({"note":"a \"b\""})", "note"},
      {Note{"looks", {}, {}, {}, kept_looks()},
       R"({"note":"looks","looks":{"active":"s2","hidden":["s1"],"opacity":{"s1":0.5}}})", "note"},
      {Note{"looks", {}, {}, {}, std::make_shared<const KeptLooks>(kept_choices())},
       R"({"note":"looks","looks":{"as_read_hidden":true,"set":"sets/spine.set.json","recipe":"femur","measured":["neck"],"model":"../femur.json"}})",
       "note"},
      {Note{"fit of the set", {}, {}, {}, {}, kept_map_fit()},
       R"({"note":"fit of the set","map_fit":{"frame":0,"structures":[{"id":"s1","name":"L3","layer":0,"value":22,"mesh":"0a","p_named":0.75,"as_read":{"count":3,"packed":")" +
           packed_coordinates() + R"("}}],"changes":{"count":5,"packed":")" + packed_changes() + R"("}}})",
       "note"},
      {Undo{}, R"({"undo":true})", "undo"},
      {Redo{}, R"({"redo":true})", "redo"},
  };
}

}  // namespace

TEST_CASE("the lines of a case file keep their bytes and actions keep their names") {
  for (const auto& known_lines : {strokes(), edits_of_the_mesh(), settings_and_marks()})
    for (const KnownLine& known : known_lines) {
      CHECK(action_line({known.action}) == known.line);
      CHECK(action_name(known.action) == known.name);
      const auto read = parse_action(known.line);
      REQUIRE_MESSAGE(read, known.line);
      CHECK_MESSAGE(read->action == known.action, known.line);
    }
}

TEST_CASE("what finds points has a word in a case and a word that is not known stays") {
  const std::vector<std::pair<FoundBy, std::string>> words{{FoundBy::fit, "fit"},
                                                           {FoundBy::set_fit, "fit of the set"},
                                                           {FoundBy::model, "model help"},
                                                           {FoundBy::refinement, "refine"},
                                                           {FoundBy::snap, "snap"},
                                                           {FoundBy::contours, "contours"},
                                                           {FoundBy::keep_apart, "keep apart"},
                                                           {FoundBy::propagation, "propagate"},
                                                           {FoundBy::start_of_cine, "start of the cine"},
                                                           {FoundBy::projection, "projection"},
                                                           {FoundBy::shared, "shared vertices"},
                                                           {FoundBy::taken_back, "taken back"},
                                                           {FoundBy::other, ""}};
  for (const auto& [by, word] : words) {
    CAPTURE(word);
    CHECK(PointsFinder(by).word() == word);
    CHECK(PointsFinder(word) == by);
  }
  const PointsFinder hand("a hand");
  CHECK(hand.word() == "a hand");
  CHECK(hand == PointsFinder("a hand"));
  CHECK(hand != FoundBy::other);
  CHECK(hand != PointsFinder("another hand"));
}

TEST_CASE("a line that cannot be read names the key") {
  const auto fault = [](const std::string& line) {
    const auto read = parse_action(line);
    return read ? std::string() : read.error().what;
  };
  CHECK(fault(R"({"tool":"pull","at":[0,0,0],"sigma_mm":5})") == R"(lacks the key "to", which its kind of line needs)");
  CHECK(fault(R"({"placement":{"rotation":[1,0,0,0],"translation":[0,0,0]}})") ==
        R"(lacks the key "scale", which its kind of line needs)");
  CHECK(fault(R"({"placement":5})") == R"(lacks the key "rotation", which its kind of line needs)");
  CHECK(fault(R"({"stiffness_base":null})") == R"("stiffness_base" holds a value of the wrong kind)");
  CHECK(fault(R"({"tool":"pull","at":["a",0,0],"to":[0,0,0],"sigma_mm":5})") ==
        R"("at" holds a value of the wrong kind)");
}

TEST_CASE("every action reads its example of the docs and writes it again") {
  for_each_action_kind([](const auto& kind) {
    const auto read = parse_action(kind.example);
    REQUIRE_MESSAGE(read, kind.example);
    const auto example = nlohmann::ordered_json::parse(kind.example);
    const auto written = to_json(read->action);
    CHECK_MESSAGE(written.contains(kind.key), kind.example);
    for (const auto& [key, value] : example.items())
      CHECK_MESSAGE(written.value(key, nlohmann::ordered_json()) == value, kind.example);
    CHECK_MESSAGE(parse_action(written.dump())->action == read->action, kind.example);
    CHECK_MESSAGE(kind_of(kind.example).kind != LineKind::unknown, kind.example);
  });
}

TEST_CASE("the table of lines in the docs is made from the actions") {
  std::string table = "| line | what it does |\n|---|---|\n";
  for_each_action_kind(
      [&](const auto& kind) { table += std::string("| `") + kind.example + "` | " + kind.meaning + " |\n"; });
  test::DocsPage page("case-file.md");
  page.has_table(table);
  page.check();
}

}  // namespace homolog
