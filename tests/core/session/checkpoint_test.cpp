#include "core/session/checkpoint.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <span>

#include "core/base/encoding/json.h"
#include "core/case/action_line.h"
#include "core/case/members.h"
#include "core/case/packed.h"
#include "core/session/line_kind.h"
#include "tests/case_steps.h"
#include "tests/changed_shape.h"
#include "tests/small_files.h"

namespace homolog {

namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr HistoryLimits often{.replayed_steps = 10};

void write_lines(const fs::path& path, const std::vector<std::string>& lines) {
  std::ofstream file(path, std::ios::binary);
  for (const std::string& line : lines) file << line << '\n';
}

bool is_checkpoint(const std::string& line) {
  return kind_of(line).kind == LineKind::checkpoint;
}

ReplayOptions every_line() {
  ReplayOptions options;
  options.from_checkpoint = false;
  return options;
}

}  // namespace

TEST_CASE("computed points are rounded when they are made and are the same in the case and after a replay") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));  // no coordinate is on the grid
  std::mt19937 random(1);
  for (const double share : {1.0, 0.05}) {
    const Points before = *session.document().view()->shape.points;
    const SetPoints edit = random_snap(session.document(), random, share);
    const std::size_t bytes = folder.text().size();
    REQUIRE(session.apply(edit));
    const Points& after = *session.document().view()->shape.points;
    CHECK(after == *edit.points);
    for (Eigen::Index k = 0; k < after.size(); ++k) {
      const double at = after.data()[k] * 65536;
      CHECK((after.data()[k] == before.data()[k] || at == std::round(at)));
    }
    // What moved by less than a millimetre takes about two bytes a coordinate; what did not, next to nothing.
    const double moved = (after.array() != before.array()).cast<double>().sum();
    CHECK(static_cast<double>(folder.text().size() - bytes) < 3.3 * moved + 500);
    CHECK(*read_case(folder.case_path, every_line())->session.document().view()->shape.points == after);
  }
}

TEST_CASE("a case of an older version opens to the same points") {
  const fs::path folder = fs::path(HOMOLOG_SOURCE_DIR) / "tests" / "older_case";
  auto read = read_case(folder / "ball.homolog");
  REQUIRE(read);
  const Points& points = *read->session.document().view()->shape.points;
  std::ifstream file(folder / "points.txt");
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    double wanted = 0;
    REQUIRE(static_cast<bool>(file >> wanted));
    CHECK(std::abs(points.data()[k] - wanted) < 1e-6);  // that version stopped its rotations short of the last bits
  }
  CHECK(read->session.strokes() == 4);
  CHECK(read->session.redo_name() == "stiffness");
}

TEST_CASE("a case goes on from its last checkpoint as if every line were played") {
  const CaseFolder folder;
  MeshFile of_part = read_mesh_file(folder.template_path).value();
  of_part.comments.push_back(faced_comment({"left lung"}));
  REQUIRE(write_mesh_file(of_part, folder.template_path));
  {
    auto session = create_case(folder.document(), folder.case_path, often).value();
    std::mt19937 random(5);
    REQUIRE(session.apply(MirrorTemplate{}));
    REQUIRE(session.apply(SetTemplateLandmark{"näme", pole}));
    REQUIRE(session.apply(SetRegion{{"hilum", 2, {1, 2, 3}}}));
    REQUIRE(session.apply(PaintRegion{"hilum", pole, 15, 0.5}));
    work(session, random, 25);
    REQUIRE(session.apply(
        points_edit(*session.document().view(), 1.01 * *session.document().view()->shape.points, FoundBy::model)));
    REQUIRE(session.apply(SetEvenSpacing{0.5}));
    work(session, random, 25);
    REQUIRE(session.apply(Undo{}));
  }
  const auto lines = lines_of(folder.case_path);
  CHECK(std::count_if(lines.begin(), lines.end(), is_checkpoint) >= 3);
  auto played = read_case(folder.case_path, every_line());
  auto opened = open_case(folder.case_path, nullptr, {}, {.bytes = 0});
  REQUIRE(played);
  REQUIRE(opened);
  CHECK(opened->session.solves() < played->session.solves() / 3);
  CHECK(opened->session.strokes() == played->session.strokes());
  CHECK(same_document(opened->session.document(), played->session.document()));
  CHECK(opened->session.document().view()->the_template().faced == FacedNames{"right lung"});
  CHECK(opened->session.undo_name() == played->session.undo_name());
  CHECK(opened->session.redo_name() == played->session.redo_name());
  CHECK(same_states(all_states(opened->session), all_states(played->session)));
}

namespace {

/// Gives each member another value than it has, at random.
class Filler {
 public:
  void fill(Document& document) {
    vertices_ = document.structure()->paint.stiffness->size();
    other(document);
  }

 private:
  template <Described Owner>
  void other(Owner& owner) {
    for_each_member(members_of(owner), [&](const auto& member) {
      // A checkpoint knows a structure's template by the structure's id.
      if (member.kept() && member.key != std::string("id")) other(owner.*member.of);
    });
  }
  void other(int& value) { value += 2; }  // frame 2 has a shape
  void other(bool& value) { value = !value; }
  void other(double& value) { value = 0.25 + 0.5 * share(); }
  void other(std::string& value) { value += "näme"; }
  void other(Scheme& scheme) { scheme = Scheme::paper; }
  void other(LandmarkRule& rule) { rule = LandmarkRule::weighed; }
  void other(LandmarkPull& pull) { pull = LandmarkPull::similarity; }
  void other(Similarity& placement) {
    placement = {Eigen::Quaterniond(Eigen::AngleAxisd(1 + share(), Vec3::UnitX())), 1.2 + share(), Vec3(1, 2, share())};
  }
  void other(std::map<std::string, Vec3>& landmarks) { landmarks["north"] = Vec3(0.1, 0.2, share()); }
  void other(std::shared_ptr<const Points>& points) {
    Points values(vertices_, 3);
    for (double& value : values.reshaped()) value = 80 * share() - 40;
    points = std::make_shared<const Points>(std::move(values));
  }
  void other(std::shared_ptr<const VertexScalars>& values) {
    VertexScalars numbers(vertices_);
    for (double& number : numbers) number = 0.1 + share();
    values = std::make_shared<const VertexScalars>(std::move(numbers));
  }
  void other(std::shared_ptr<const Regions>& regions) {
    auto painted = std::make_shared<Regions>();
    painted->list = {{"hilum", 1 + share(), {1, 2, 3}}};
    painted->of_vertex.assign(static_cast<std::size_t>(vertices_), 1);
    regions = painted;
  }
  void other(std::shared_ptr<const Template>& the_template) {
    auto landmarks = the_template->landmarks;
    landmarks.push_back({"näme", Vec3(1, 2, share())});
    template_ = the_template = with_landmarks(*the_template, landmarks);
  }
  void other(std::shared_ptr<const Volume>&) {}  // the first line says it
  void other(std::map<int, std::shared_ptr<const Shape>>& shapes) {
    const Shape start = *shapes.at(0);
    for (const int frame : {0, 2}) {
      Shape shape = start;
      other(shape);
      shape.placed = std::make_shared<const Points>(shape.placement.apply(template_->points));
      shapes.insert_or_assign(frame, std::make_shared<const Shape>(std::move(shape)));
    }
  }
  void other(std::vector<std::shared_ptr<const Structure>>& structures) {
    Structure first = *structures.front();
    other(first);
    structures.front() = std::make_shared<const Structure>(std::move(first));
  }
  void other(std::optional<std::array<std::uint8_t, 3>>& colour) { colour = {10, 200, 30}; }
  void other(Side& side) { side = Side::left; }
  void other(std::optional<std::string>& text) { text = "näme"; }
  void other(std::vector<SharedWith>& shared) {
    const std::vector<VertexPair> pairs{{0, 3}, {static_cast<std::int32_t>(vertices_) - 1, 7}}, none;
    shared = {{"s7", std::make_shared<const std::vector<VertexPair>>(pairs)},
              {"s8", std::make_shared<const std::vector<VertexPair>>(none)}};
  }
  void other(std::vector<std::shared_ptr<const ContourSet>>& contours) {
    const Contour open{{Vec3(0.1, 0.2, share()), Vec3(1, 2, 3)}, false, true},
        closed{{Vec3(0, 0, 0.3), Vec3(1, 0, 0.3), Vec3(0, 1, 0.3)}};
    contours = {std::make_shared<const ContourSet>(ContourSet{"c1", "näme", 2, share(), true, {open, closed}})};
  }
  double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }

  std::mt19937 random_{4};
  Eigen::Index vertices_ = 0;
  std::shared_ptr<const Template> template_;
};

/// Every member that a checkpoint keeps is another than in `start`.
Document full_document(const Document& start) {
  Document document = start;
  Filler().fill(document);
  return document;
}

}  // namespace

TEST_CASE("a checkpoint keeps every member of a shape and of a document") {
  const CaseFolder folder;
  Document start = cine_document(folder, 3);
  const auto with_rules = [](Document document, LandmarkRule rule, bool hold) {
    document.change({}, [&](Structure& first) { first.landmarks = {first.landmarks.pull, rule, hold}; });
    return document;
  };
  start = with_rules(start, LandmarkRule::weighed, true);
  const Document full = full_document(start);
  const auto line = checkpoint_line(start, full, 5);
  REQUIRE(line);
  const auto read = read_checkpoint(*line, start, 5);
  REQUIRE(read);
  CHECK(same_document(*read, full));

  // What is newer than checkpoints is left out where a structure has none of it.
  const auto of_start = checkpoint_line(start, start, 5);
  REQUIRE(of_start);
  for (const char* key : {"\"side\"", "\"partner\"", "\"shared\"", "\"contours\""}) {
    CAPTURE(key);
    CHECK(line->find(key) != std::string::npos);
    CHECK(of_start->find(key) == std::string::npos);
  }

  // It belongs to that first line alone.
  CHECK_FALSE(read_checkpoint(*line, with_rules(start, LandmarkRule::by_size, true), 5));
  CHECK_FALSE(read_checkpoint(*line, with_rules(start, LandmarkRule::weighed, false), 5));
}

TEST_CASE("a copy of a frame leaves behind what edits made there but for its strokes") {
  const CaseFolder folder;
  Document full = full_document(cine_document(folder, 3));                  // frame 2 is shown
  full.change({}, [](Structure& first) { first.landmarks.hold = false; });  // it would add to what is confirmed
  Deformer deformer;
  const auto updated = update(full, {}, StartFrameFrom{0}, deformer, Pass::commit);
  REQUIRE(updated);
  const Shape &from = *full.structure()->shape(0), &copy = *updated->document.structure()->shape(full.frame);
  for_each_member(shape_members, [&](const auto& member) {
    CAPTURE(std::string(member.key));
    const bool stays = !is_trace(member.origin) || member.key == std::string("strokes");
    Shape expected = from;
    if (!stays) expected.*member.of = {};
    if (member.key == std::string("carried")) expected.carried = from.points;
    CHECK((copy.*member.of == expected.*member.of));
  });
}

TEST_CASE("a fit and a placement empty the members whose origin says so") {
  const CaseFolder folder;
  Document full = full_document(cine_document(folder, 3));                  // frame 2 is shown
  full.change({}, [](Structure& first) { first.landmarks.hold = false; });  // it would add to what is confirmed
  Deformer deformer;
  const Shape& before = *full.structure()->shape(full.frame);
  const auto after = [&](const Action& action) {
    const auto updated = update(full, {}, action, deformer, Pass::commit);
    REQUIRE(updated);
    return *updated->document.structure()->shape(full.frame);
  };
  Points found = *before.points;
  found.topRows(found.rows() / 2) *= 1.25;  // the others stay where a model put them
  const Shape fitted = after(points_edit(*full.view(), found, FoundBy::fit));
  Similarity elsewhere = before.placement;
  elsewhere.translation += Vec3(8, 4, 2);
  const Shape moved = after(SetPlacement{elsewhere});
  for_each_member(shape_members, [&]<class Value>(const Member<Shape, Value>& member) {
    CAPTURE(std::string(member.key));
    const Value none{};
    const Origin origin = member.origin;
    if (origin == Origin::since_fit || origin == Origin::fit || origin == Origin::step)
      CHECK((fitted.*member.of == none));
    if (origin == Origin::edits) CHECK_FALSE((fitted.*member.of == none));
    if (origin == Origin::fit) CHECK((moved.*member.of == none));
    if constexpr (std::is_same_v<Value, std::shared_ptr<const Points>>) {
      if (moves_along(origin)) {
        const Points way = *(moved.*member.of) - *(before.*member.of);
        CHECK((way.rowwise() - Eigen::RowVector3d(8, 4, 2)).cwiseAbs().maxCoeff() < 1e-9);
      }
      if (origin == Origin::step) CHECK((moved.*member.of == before.*member.of));
    } else if (is_trace(origin) && origin != Origin::fit) {
      CHECK((moved.*member.of == before.*member.of));
    }
  });
}

TEST_CASE("only what the first line says and what follows from others is left out of a checkpoint") {
  const auto left_out = [](const auto& members) {
    std::vector<std::string> keys;
    for_each_member(members, [&](const auto& member) {
      if (!member.kept()) keys.emplace_back(member.key);
    });
    return keys;
  };
  CHECK(left_out(shape_members) == std::vector<std::string>{"placed"});
  CHECK(left_out(document_members) == std::vector<std::string>{"scan"});
  CHECK(left_out(structure_members).empty());
  CHECK(left_out(paint_members).empty());
  CHECK(left_out(landmark_rules_members).empty());
}

TEST_CASE("a checkpoint of a case without contours says nothing of them and one with them is no older format") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  const Document start = folder.document();
  CHECK(checkpoint_line(start, session.document(), 7).value().find("contours") == std::string::npos);
  const auto curve = std::make_shared<const std::vector<Contour>>(
      std::vector<Contour>{{{Vec3(0, 0, 41), Vec3(41, 0, 0), Vec3(0, 41, 0)}}});
  REQUIRE(session.apply(SetContours{.id = "c1", .curves = curve, .off_mm = 0.5}));
  const std::string line = checkpoint_line(start, session.document(), 7).value();
  const auto read = read_checkpoint(line, start, 7);
  REQUIRE(read);
  REQUIRE(read->structure()->contours.size() == 1);
  CHECK(read->structure()->contours.front()->curves == *curve);
  CHECK(read->structure()->contours.front()->off_mm == 0.5);
  // A damaged one is passed over.
  OrderedJson damaged = OrderedJson::parse(line);
  damaged["checkpoint"]["document"]["structures"][0]["contours"][0]["curves"][0]["points"] = {1, 2};
  CHECK_FALSE(read_checkpoint(damaged.dump(), start, 7));
}

TEST_CASE("two documents that differ in one member are not the same") {
  const CaseFolder folder;
  const Document start = cine_document(folder, 3), full = full_document(start);
  CHECK(same_document(full, full));
  const auto differs = [&](const char* key, const Document& other) {
    CAPTURE(key);
    CHECK_FALSE(same_document(full, other));
    CHECK_FALSE(same_document(other, full));
  };
  for_each_member(document_members, [&](const auto& member) {
    Document other = full;
    if (member.origin != Origin::first_line) other.*member.of = start.*member.of;
    if (member.key == std::string("scan")) other.scan.source += "x";
    differs(member.key, other);
  });
  Document other = full;
  other.scan.image = nullptr;
  differs("image", other);
  const auto each = [&](const auto& members, const auto& part) {
    for_each_member(members, [&](const auto& member) {
      Document changed = full;
      changed.change({}, [&](Structure& first) {
        Structure old = *start.structure();
        if (member.key == std::string("id")) old.id = "another";
        part(first, member.of) = part(old, member.of);
      });
      differs(member.key, changed);
    });
  };
  each(
      structure_members, [](Structure & one, auto of) -> auto& { return one.*of; });
  each(
      paint_members, [](Structure & one, auto of) -> auto& { return one.paint.*of; });
  each(
      landmark_rules_members, [](Structure & one, auto of) -> auto& { return one.landmarks.*of; });
  for_each_member(shape_members, [&](const auto& member) {
    Document changed = full;
    test::changed_shape(changed).*member.of = start.structure()->shape(0)->*member.of;
    differs(member.key, changed);
  });
  const auto differs_in_template = [&](const char* key, const auto& change) {
    Document changed = full;
    changed.change({}, [&](Structure& first) {
      auto another = std::make_shared<Template>(*first.the_template);
      change(*another);
      first.the_template = another;
    });
    differs(key, changed);
  };
  differs_in_template("landmark_points", [](Template& one) { one.landmark_points.front().face += 1; });
  differs_in_template("missing_share", [](Template& one) { one.missing_share = 0.5; });
  differs_in_template("faced", [](Template& one) { one.faced = FacedNames{"2"}; });
}

TEST_CASE("a landmark that is placed after a reopening lies where it does without a checkpoint") {
  const CaseFolder folder;
  const PlaceLandmark north{"north", Vec3(3, 5, 50), true};
  {
    auto session = create_case(folder.document(), folder.case_path, often).value();
    const Similarity turned{Eigen::Quaterniond(Eigen::AngleAxisd(1, Vec3::UnitX())), 1.2, Vec3::Zero()};
    REQUIRE(session.apply(SetPlacement{turned}));
    for (int k = 0; k < 12; ++k) REQUIRE(session.apply(SetStiffnessBase{5.0 + k}));
  }
  const auto lines = lines_of(folder.case_path);
  REQUIRE(std::any_of(lines.begin(), lines.end(), is_checkpoint));
  auto opened = open_case(folder.case_path);
  auto played = read_case(folder.case_path, every_line());
  REQUIRE(opened);
  REQUIRE(played);
  REQUIRE(opened->session.apply(north));
  REQUIRE(played->session.apply(north));
  CHECK(*opened->session.document().view()->shape.points == *played->session.document().view()->shape.points);
  CHECK(same_document(opened->session.document(), played->session.document()));
}

TEST_CASE("a checkpoint of an older version without that member is passed over") {
  const CaseFolder folder;
  {
    auto session = create_case(folder.document(), folder.case_path, often).value();
    std::mt19937 random(8);
    work(session, random, 25);
  }
  auto lines = lines_of(folder.case_path);
  for (std::string& line : lines) {
    if (!is_checkpoint(line)) continue;
    auto json = OrderedJson::parse(line);
    for (auto& structure : json["checkpoint"]["document"]["structures"])
      for (auto& shape : structure["shapes"]) shape.erase("before_landmarks");
    line = json.dump();
  }
  write_lines(folder.case_path, lines);
  const auto opened = read_case(folder.case_path), played = read_case(folder.case_path, every_line());
  REQUIRE(opened);
  CHECK(opened->session.solves() == played->session.solves());
  CHECK(same_document(opened->session.document(), played->session.document()));
}

TEST_CASE("a note between the touches of a stroke parts nothing that a replay keeps together") {
  const CaseFolder folder;
  const auto paint = [](double x) { return PaintStiffness{Vec3(x, 0, 40), 10, 20, 0.5}; };
  {
    auto session = create_case(folder.document(), folder.case_path, often).value();
    REQUIRE(session.apply(SetStiffnessBase{5}));
    REQUIRE(session.apply(Undo{}));
    REQUIRE(session.apply(Note{"a remark"}));
    REQUIRE(session.apply(paint(9), true));
    for (int k = 0; k < 12; ++k) REQUIRE(session.apply(SetStiffnessBase{6.0 + k}));
  }
  // A script may join what the program would not.
  auto lines = lines_of(folder.case_path);
  for (std::string& line : lines)
    if (line.find("paint_stiffness") != std::string::npos && line.find("joined") == std::string::npos)
      line.insert(line.size() - 1, ",\"joined\":true");
  write_lines(folder.case_path, lines);
  auto opened = read_case(folder.case_path, {}), played = read_case(folder.case_path, every_line());
  REQUIRE(opened);
  REQUIRE(played);
  CHECK(opened->session.undo_names(99) == played->session.undo_names(99));
  CHECK(played->session.undo_names(99).size() == 13);
}

TEST_CASE("a checkpoint is never trusted over the lines before it") {
  const CaseFolder folder;
  Points kept;
  {
    auto session = create_case(folder.document(), folder.case_path, often).value();
    std::mt19937 random(6);
    work(session, random, 35);
    kept = *session.document().view()->shape.points;
  }
  const auto lines = lines_of(folder.case_path);
  const auto points = [&] { return *read_case(folder.case_path).value().session.document().view()->shape.points; };
  const auto played = [&] {
    return *read_case(folder.case_path, every_line()).value().session.document().view()->shape.points;
  };

  // Without them.
  auto changed = lines;
  std::erase_if(changed, is_checkpoint);
  write_lines(folder.case_path, changed);
  CHECK(points() == kept);

  // Another first step: all that follows is played.
  changed = lines;
  changed[1] = action_line({pull(-pole, -1.3 * pole)});
  write_lines(folder.case_path, changed);
  CHECK(points() == played());
  CHECK(points() != kept);

  // Damaged ones, some of another format, and some of another solver.
  for (const char* key : {"", "\"format\":", "\"solver\":\""}) {
    changed = lines;
    for (std::string& line : changed) {
      if (!is_checkpoint(line)) continue;
      const std::size_t found = line.find(key);
      REQUIRE(found != std::string::npos);
      if (*key == '\0')
        line[line.size() / 2] = '*';
      else
        line.insert(found + std::strlen(key), "9");
    }
    write_lines(folder.case_path, changed);
    CHECK(points() == kept);
    CHECK(read_case(folder.case_path)->session.solves() == read_case(folder.case_path, every_line())->session.solves());
  }

  // Another template of the same faces, in a case that does not keep what tells it from others.
  changed = lines;
  auto header = OrderedJson::parse(changed.front());
  REQUIRE(header.erase("template_mark") == 1);
  changed.front() = header.dump();
  write_lines(folder.case_path, changed);
  MeshFile other = read_mesh_file(folder.template_path).value();
  other.points *= 1.1;
  REQUIRE(write_mesh_file(other, folder.template_path));
  CHECK(points() == played());
}

TEST_CASE("a checkpoint that holds what no case can hold is passed over") {
  const CaseFolder folder;
  auto session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  REQUIRE(session.apply(SetRegion{{"cap", 2, {}}}));
  REQUIRE(session.apply(PaintRegion{"cap", pole, 10, 0}));
  const Document start = folder.document();
  const std::string line = checkpoint_line(start, session.document(), 7).value();
  REQUIRE(read_checkpoint(line, start, 7));
  const auto first = [](OrderedJson& document) -> OrderedJson& { return document["structures"][0]; };
  const auto shared_as = [](const char* with, const char* vertices) {
    return OrderedJson::array({OrderedJson{{"with", with}, {"vertices", vertices}}});
  };
  const std::vector<std::function<void(OrderedJson&)>> damages{
      [](OrderedJson& document) { document["frame"] = 3; },
      [](OrderedJson& document) { document["scheme"] = 9; },
      [](OrderedJson& document) { document["events"] = 0; },
      [](OrderedJson& document) { document["spacing"] = -1; },
      [](OrderedJson& document) { document["structures"] = OrderedJson::array(); },
      [&](OrderedJson& document) { first(document)["id"] = "s9"; },
      [&](OrderedJson& document) { first(document)["shapes"][0]["frame"] = 3; },
      [&](OrderedJson& document) { first(document)["landmarks"]["pull"] = 3; },
      [&](OrderedJson& document) { first(document)["landmarks"]["rule"] = 3; },
      [&](OrderedJson& document) { first(document)["paint"]["stiffness_base"] = 0; },
      [&](OrderedJson& document) { first(document)["paint"]["regions"]["list"].clear(); },
      [&](OrderedJson& document) { first(document)["paint"]["regions"]["list"][0]["factor"] = -1; },
      [&](OrderedJson& document) {
        OrderedJson& regions = first(document)["paint"]["regions"];
        regions["of_vertex"] = packed(std::span<const std::uint8_t>(std::vector<std::uint8_t>{1}));
        regions["vertices"] = 1;
      },
      [&](OrderedJson& document) { first(document)["side"] = 3; },
      [&](OrderedJson& document) { first(document)["partner"] = 3; },
      [&](OrderedJson& document) { first(document)["shared"] = shared_as("s2", "0:-1"); },
      [&](OrderedJson& document) { first(document)["shared"] = shared_as("s2", "99999:0"); },
      [&](OrderedJson& document) { first(document)["shared"] = shared_as("", "0:0"); },
      [&](OrderedJson& document) { first(document)["shapes"][0]["placement"]["scale"] = 0; },
      [&](OrderedJson& document) { first(document)["shapes"][0]["strokes"] = -1; },
      [&](OrderedJson& document) { first(document)["shapes"] = OrderedJson::array(); }};
  for (std::size_t k = 0; k < damages.size(); ++k) {
    CAPTURE(k);
    OrderedJson damaged = OrderedJson::parse(line);
    damages[k](damaged["checkpoint"]["document"]);
    CHECK_FALSE(read_checkpoint(damaged.dump(), start, 7));
  }
}

TEST_CASE("a checkpoint that finds no room is left out and the edit is made") {
  const CaseFolder folder;
  auto session = create_case(folder.document(), folder.case_path, {.replayed_steps = 1}).value();
  const std::string before = folder.text();
  const auto done = [&] {
    const SmallFilesOnly full(before.size() + 200);
    return session.apply(SetStiffnessBase{5});
  }();
  CHECK(done);
  CHECK(folder.text() == before + "{\"stiffness_base\":5.0}\n");
  auto again = read_case(folder.case_path);
  REQUIRE(again);
  CHECK(again->session.document().structure()->paint.base == 5);
}

TEST_CASE("a day of work in small opens quickly and undoes to the first stroke") {
  const CaseFolder folder;
  const HistoryLimits limits{.bytes = 500'000, .replayed_steps = 15};
  std::shared_ptr<const Document> end;
  int snaps = 0;
  {
    auto session = create_case(folder.document(), folder.case_path, limits).value();
    std::mt19937 random(7);
    for (int k = 0; k < 100; ++k) {
      const Vec3 at = random_place(random);
      if (k % 5 < 2) {
        REQUIRE(session.apply(random_snap(session.document(), random)));
        ++snaps;
      } else {
        (void)session.apply(pull(at, 1.02 * at));
      }
    }
    end = session.shared_document();
  }
  // A snap: 642 landmarks × 3 coordinates × 3.3 bytes; a stroke: 250; a checkpoint: 60 kB.
  CHECK(fs::file_size(folder.case_path) < static_cast<std::uintmax_t>(snaps) * 6400 + 60 * 250 + 7 * 60'000);
  auto opened = open_case(folder.case_path, nullptr, {}, limits);
  REQUIRE(opened);
  CHECK(opened->session.solves() <= 2 * 15);
  CHECK(same_document(opened->session.document(), *end));
  while (opened->session.can_undo()) {
    REQUIRE(opened->session.apply(Undo{}));
    REQUIRE(opened->session.history_bytes() <= limits.bytes);
  }
  CHECK(*opened->session.document().view()->shape.points == folder.document().structure()->the_template->points);
}

TEST_CASE("what a line is to the history is told from its keys") {
  const auto kind = [](const char* line) { return kind_of(line).kind; };
  CHECK(kind(R"({"tool":"pull","at":[0,0,40],"to":[0,0,45],"sigma_mm":1})") == LineKind::step);
  CHECK(kind(R"( { "note" : "a \"quoted\" {brace", "x": [1, {"undo":true}] } )") == LineKind::note);
  CHECK(kind(R"({"undo":true})") == LineKind::undo);
  CHECK(kind(R"({"redo":true,"author":"x"})") == LineKind::redo);
  CHECK(kind(R"({"frame":3})") == LineKind::step);
  CHECK(kind(R"({"frame":3,"look":true})") == LineKind::look);
  CHECK(kind(R"({"checkpoint":{"undo":true}})") == LineKind::checkpoint);
  CHECK(kind("") == LineKind::empty);
  CHECK(kind(" \r") == LineKind::empty);
  for (const char* none : {"{", "[1]", "nonsense", R"({"wobble":1})", R"({"undo":true)", R"({"undo":true} x)",
                           R"({"note":"open)", R"({"not\u0065":1})", R"({"note")"})
    CHECK(kind(none) == LineKind::unknown);
  CHECK(kind_of(R"({"stiffness":{"at":[0,0,1]},"joined":true})").joined);
  CHECK_FALSE(kind_of(R"({"stiffness":{"at":[0,0,1],"joined":true}})").joined);
  CHECK(kind_of(R"({"tool":"relax"})").stroke);
}

}  // namespace homolog
