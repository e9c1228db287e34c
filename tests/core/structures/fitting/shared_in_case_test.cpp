#include "core/structures/fitting/shared_in_case.h"

#include <doctest/doctest.h>

#include "core/catalogue/catalogue.h"
#include "core/mesh/mesh_quality.h"
#include "core/session/case_file.h"
#include "core/session/same_document.h"
#include "core/structures/fitting/keep_apart.h"
#include "core/structures/fitting/set_in_case.h"
#include "core/structures/fitting/share_vertices.h"
#include "core/structures/maps/set_map.h"
#include "tests/half_balls.h"
#include "tests/must.h"
#include "tests/temporary_folder.h"

// A case whose structures have vertices in common: two halves of a ball, which meet in their disc.

namespace homolog {

namespace {

using shapes::disc_vertices;
using shapes::half_ball;

std::shared_ptr<const Template> half_template(const std::filesystem::path& folder, bool above) {
  const Mesh half = half_ball(20, above);
  MeshFile file;
  file.points = half.points;
  file.triangles = half.topology->triangles();
  const std::filesystem::path path = folder / (above ? "upper.ply" : "lower.ply");
  REQUIRE(write_mesh_file(file, path));
  return test::must(load_template(path.string()));
}

std::vector<SharedWith> disc_with(const char* id) {
  std::vector<VertexPair> pairs;
  for (std::int32_t v = 0; v < disc_vertices(); ++v) pairs.push_back({v, v});
  return {{id, std::make_shared<const std::vector<VertexPair>>(std::move(pairs))}};
}

/// "s1" is above, "s2" below. They share their disc.
struct HalvesCase {
  TemporaryFolder folder;
  std::filesystem::path file = folder.path / "halves.homolog";

  EditSession begin() const {
    const Similarity in_place;
    auto session = test::must(create_case(new_document("", nullptr, half_template(folder.path, true), in_place), file));
    const auto below = half_template(folder.path, false);
    REQUIRE(session.apply(SetStructure{
        .id = "s2", .name = "lower", .source = below->source, .placement = in_place, .the_template = below}));
    REQUIRE(session.apply(SetStructure{.id = "s2", .shared = disc_with("s1")}));
    return session;
  }
};

Points points_in(const EditSession& session, const char* id) {
  return *session.document().view(id)->shape.points;
}

double disc_apart_mm(const EditSession& session) {
  return (points_in(session, "s1") - points_in(session, "s2")).topRows(disc_vertices()).rowwise().norm().maxCoeff();
}

/// As the window does it after a stroke.
void follow_in(EditSession& session, const SharedLead& lead) {
  std::vector<std::string> edited = sharing_structures(session.document(), lead.leader);
  edited.insert(edited.begin(), lead.leader);
  for (const std::string& id : edited)
    if (auto edit = edit_to_shared(session.document(), id, lead)) REQUIRE(session.apply(std::move(*edit), true, id));
}

Stroke disc_pull() {
  return {.tool = Tool::pull, .at = Vec3(0, 0, 0), .to = Vec3(0, 0, -4), .sigma_mm = 8};
}

}  // namespace

TEST_CASE("where one structure is pulled the other follows, one undo takes both back and a replay gives the same") {
  const HalvesCase halves;
  std::optional<Document> done;
  {
    EditSession session = halves.begin();
    const Points upper = points_in(session, "s1"), lower = points_in(session, "s2");
    REQUIRE(session.apply(disc_pull()));
    REQUIRE(disc_apart_mm(session) > 1);
    follow_in(session, {"s1", {}});
    CHECK(disc_apart_mm(session) < shared_place_mm);
    CHECK(points_in(session, "s1")(0, 2) < -1);
    const Points after = points_in(session, "s2");
    CHECK(after.row(0) != lower.row(0));
    // The dome goes along near the disc, and its top hardly.
    const Mesh mesh{session.document().structure("s2")->the_template->topology, after};
    CHECK((after.row(disc_vertices()) - lower.row(disc_vertices())).norm() < 1);
    CHECK(self_intersections(mesh).empty());
    // What follows is noted as such, and moves nothing again.
    CHECK_FALSE(edit_to_shared(session.document(), "s1", {"s1", {}}));
    CHECK_FALSE(edit_to_shared(session.document(), "s2", {"s1", {}}));
    CHECK_FALSE(edit_to_shared(session.document(), "s1", {"s2", {}}));

    REQUIRE(session.apply(Undo{}));
    CHECK(points_in(session, "s1") == upper);
    CHECK(points_in(session, "s2") == lower);
    REQUIRE(session.apply(Redo{}));
    CHECK(points_in(session, "s2") == after);
    done = session.document();
  }
  ReplayOptions every_line;
  every_line.from_checkpoint = false;
  const auto played = read_case(halves.file, every_line);
  REQUIRE_MESSAGE(played, played.error().sentence());
  CHECK(same_document(played->session.document(), *done));
}

TEST_CASE("a held structure stays and the one that was pulled goes back to it") {
  const HalvesCase halves;
  EditSession session = halves.begin();
  const Points lower = points_in(session, "s2");
  REQUIRE(session.apply(disc_pull()));
  CHECK_FALSE(edit_to_shared(session.document(), "s2", {"s1", {"s2"}}));
  follow_in(session, {"s1", {"s2"}});
  CHECK(points_in(session, "s2") == lower);
  // The grid of computed points is 2⁻¹⁶ mm; what is held was never put on it.
  CHECK(disc_apart_mm(session) < 2e-5);
}

TEST_CASE("a third structure leaves its place only where it shares what was pulled") {
  const HalvesCase halves;
  EditSession session = halves.begin();
  const auto below = session.document().structure("s2")->the_template;
  for (const char* id : {"s3", "s4"})
    REQUIRE(session.apply(
        SetStructure{.id = id, .source = below->source, .placement = Similarity{}, .the_template = below}));
  const std::vector<VertexPair> middle{{0, 0}};
  REQUIRE(session.apply(
      SetStructure{.id = "s3", .shared = {{{"s2", std::make_shared<const std::vector<VertexPair>>(middle)}}}}));
  CHECK(sharing_structures(session.document(), "s1") == std::vector<std::string>{"s2", "s3"});
  CHECK(sharing_structures(session.document(), {}) == std::vector<std::string>{"s2", "s3"});
  CHECK(sharing_structures(session.document(), "s3") == std::vector<std::string>{"s1", "s2"});
  CHECK(sharing_structures(session.document(), "s4").empty());
  CHECK(shared_vertices_of(session.document(), "s1").sum() == disc_vertices());
  CHECK(shared_vertices_of(session.document(), "s3").sum() == 1);
  CHECK(shared_vertices_of(session.document(), "s4").size() == 0);
  const Points fourth = points_in(session, "s4");
  REQUIRE(session.apply(disc_pull()));
  follow_in(session, {"s1", {}});
  CHECK(disc_apart_mm(session) < shared_place_mm);
  CHECK((points_in(session, "s3").row(0) - points_in(session, "s1").row(0)).norm() < shared_place_mm);
  CHECK(points_in(session, "s4") == fourth);
  CHECK_FALSE(edit_to_shared(session.document(), "s4", {"s1", {}}));
}

TEST_CASE("frames to which structures are carried have one place for what they share") {
  const HalvesCase halves;
  EditSession session = halves.begin();
  const auto carried_to = [&](const char* id, int frame, const Vec3& by_mm, PointsFinder by = FoundBy::propagation) {
    const Points moved = points_in(session, id).rowwise() + by_mm.transpose();
    return points_edit(*session.document().view(id), frame, moved, std::move(by));
  };
  std::vector<SetPoints> upper{carried_to("s1", 1, Vec3(0, 0, 0.5)), carried_to("s1", 2, Vec3(0, 0, 1))};
  std::vector<SetPoints> lower{carried_to("s2", 0, Vec3(3, 0, 0), FoundBy::start_of_cine),
                               carried_to("s2", 1, Vec3(0.25, 0, 0)), carried_to("s2", 2, Vec3(0, 0, 1))};
  const auto upper_before = upper, lower_before = lower;
  share_carried(session.document(), {{"s1", upper}, {"s2", lower}});
  constexpr double grid_mm = 2e-5;
  CHECK((*upper[0].points - *upper_before[0].points).cwiseAbs().maxCoeff() < grid_mm);  // the first leads
  CHECK(upper[1] == upper_before[1]);
  CHECK(lower[0] == lower_before[0]);
  CHECK(lower[2] == lower_before[2]);  // they lie together there
  const auto apart_mm = [&](const SetPoints& a, const SetPoints& b) {
    return (*a.points - *b.points).topRows(disc_vertices()).rowwise().norm().maxCoeff();
  };
  CHECK(apart_mm(upper_before[0], lower_before[1]) > 0.5);
  CHECK(apart_mm(upper[0], lower[1]) < shared_place_mm);
  // One that is not carried leads, where somebody edited it.
  REQUIRE(session.apply(disc_pull(), false, "s1"));
  std::vector<SetPoints> alone{carried_to("s2", 0, Vec3(0, 0, 1))};
  share_carried(session.document(), {{"s2", alone}});
  CHECK((*alone[0].points - points_in(session, "s1")).topRows(disc_vertices()).rowwise().norm().maxCoeff() < grid_mm);
}

TEST_CASE("to keep a structure apart moves no vertex that it shares") {
  const HalvesCase halves;
  EditSession session = halves.begin();
  const Points upper = points_in(session, "s1");
  const auto apart = apart_from_others(session.document(), "s1", 1);
  if (apart) CHECK(apart->points->topRows(disc_vertices()) == upper.topRows(disc_vertices()));
  REQUIRE(session.apply(SetStructure{.id = "s2", .shared = std::vector<SharedWith>{}}));
  const auto free = apart_from_others(session.document(), "s1", 1);
  REQUIRE(free);
  CHECK(free->points->topRows(disc_vertices()) != upper.topRows(disc_vertices()));
}

TEST_CASE("a fit of a set tells the case sides, partners and what is shared, by ids") {
  const TemporaryFolder folder;
  SetOfTemplates set;
  std::vector<MeshOfSegment> meshes;
  for (const bool above : {true, false}) {
    TemplateOfSet one;
    one.name = above ? "Left half" : "right half";
    one.value = above ? 1 : 2;
    set.set.structures.push_back(one);
    set.templates.push_back(half_template(folder.path, above));
    meshes.push_back({{.name = one.name, .value = one.value}, half_ball(22, above)});
  }
  find_partners(set.set);
  set.set.shared = {{"right half", "Left half", *disc_with("").front().vertices}};
  VolumeGeometry grid;
  grid.dims = {60, 60, 60};
  grid.origin_mm.setConstant(-29.3);
  const SetInMap subject = find_in_map(set.set, map_of_meshes(meshes, grid).map);
  const FittedSet fitted = test::must(fit_set(set, subject));
  REQUIRE(fitted.structures[0].fit);
  REQUIRE(fitted.structures[1].fit);
  const std::filesystem::path file = folder.path / "case.homolog";
  auto session = test::must(create_case(new_document("", nullptr, set.templates[0], Similarity{}), file));
  const auto bring = [&] {
    const auto steps = steps_of_fitted_set(session.document(), set, subject, fitted);
    CHECK_FALSE(steps.front().joined);
    CHECK(std::holds_alternative<SetPoints>(steps.back().action));
    for (const EditStep& step : steps) REQUIRE(session.apply(step));
    return steps.size();
  };
  // Two structures and their points; then what they are to each other.
  CHECK(bring() == 6);
  const auto document = session.shared_document();
  REQUIRE(document->structures.size() == 2);
  CHECK(document->structure("s1")->side == Side::left);
  CHECK(document->structure("s1")->partner == "s2");
  CHECK(document->structure("s1")->shared.empty());
  CHECK(document->structure("s2")->side == Side::right);
  CHECK(document->structure("s2")->partner == "s1");
  CHECK(document->structure("s2")->shared == disc_with("s1"));
  CHECK(disc_apart_mm(session) < shared_place_mm);
  // What the case knows already is not said again.
  CHECK(bring() == 4);
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(Undo{}));
  CHECK(session.document().structures.size() == 1);
  // A set that says nothing of it gives the case that it always gave.
  for (TemplateOfSet& one : set.set.structures) {
    one.side = Side::none;
    one.partner.clear();
  }
  set.set.shared.clear();
  CHECK(bring() == 4);
  CHECK(session.document().structure("s2")->side == Side::none);
  CHECK_FALSE(session.document().structure("s2")->partner);
}

}  // namespace homolog
