#include "core/case/held_landmarks.h"

#include "tests/case_folder.h"
#include "tests/changed_shape.h"

namespace homolog {

namespace {

/// A ball of 40 mm whose case holds the mesh at landmarks.
Document holding(const CaseFolder& folder) {
  Document document = folder.document();
  document.change({}, [&](Structure& first) { first.landmarks.hold = true; });
  return document;
}

LandmarkHold north(const EditSession& session) {
  return landmark_hold(*session.document().structure()->the_template, 0, session.document().view()->shape);
}

Vec3 mesh_at_north(const EditSession& session) {
  return carried_landmark(*session.document().structure()->the_template, 0, *session.document().view()->shape.points);
}

const Vec3 place(0, 0, 44);

}  // namespace

TEST_CASE("strokes leave the mesh at a placed landmark until it is released") {
  const CaseFolder folder;
  EditSession session(holding(folder));
  REQUIRE(session.apply(PlaceLandmark{"north", place}));
  CHECK(north(session).met);
  CHECK(north(session).held);
  const Stroke beside = pull(Vec3(12, 0, 42), Vec3(12, 0, 60), 20);
  REQUIRE(session.apply(beside));
  CHECK((mesh_at_north(session) - place).norm() < 1e-6);

  REQUIRE(session.apply(PlaceLandmark{"north", place, false}));
  CHECK_FALSE(north(session).held);
  CHECK(session.undo_name() == "release of north");
  REQUIRE(session.apply(pull(Vec3(12, 0, 60), Vec3(12, 0, 80), 20)));
  CHECK((mesh_at_north(session) - place).norm() > 2);

  // As every case before did.
  EditSession older(folder.document());
  REQUIRE(older.apply(PlaceLandmark{"north", place}));
  REQUIRE(older.apply(beside));
  CHECK((mesh_at_north(older) - place).norm() > 2);
}

TEST_CASE("a landmark that is placed after strokes is held once the mesh was brought to it") {
  const CaseFolder folder;
  EditSession session(holding(folder));
  REQUIRE(session.apply(pull(-pole, Vec3(0, 0, -45))));
  REQUIRE(session.apply(PlaceLandmark{"north", Vec3(0, 0, 52)}));
  CHECK_FALSE(north(session).met);
  CHECK_FALSE(north(session).held);
  Stroke grab = pull(mesh_at_north(session), Vec3(0, 0, 52));
  grab.tool = Tool::grab;
  REQUIRE(session.apply(grab));
  CHECK(north(session).held);

  // Taken back, the landmark holds nothing.
  REQUIRE(session.apply(PlaceLandmark{"north", std::nullopt}));
  CHECK_FALSE(session.document().view()->shape.confirmed);
}

TEST_CASE("a landmark that is released leaves what a person confirmed around it") {
  const CaseFolder folder;
  EditSession session(holding(folder));
  REQUIRE(session.apply(PlaceLandmark{"north", place}));
  REQUIRE(session.apply(Confirm{place, 20, true}));
  REQUIRE(session.apply(PlaceLandmark{"north", place, false}));
  CHECK(north(session).held);
}

TEST_CASE("what landmarks hold is not what a person confirmed even where two of them share a vertex") {
  const CaseFolder folder;
  EditSession session(holding(folder));
  const Points& points = *session.document().view()->shape.points;
  const auto& triangles = session.document().structure()->the_template->topology->triangles();
  // In the middles of two neighbouring triangles.
  const auto middle = [&](Eigen::Index t) {
    return Vec3((points.row(triangles(t, 0)) + points.row(triangles(t, 1)) + points.row(triangles(t, 2))) / 3);
  };
  Eigen::Index neighbour = 1;
  while ((triangles.row(neighbour).array() == triangles(0, 0)).count() == 0) ++neighbour;
  for (const auto& [name, t] : {std::pair("a", Eigen::Index{0}), std::pair("b", neighbour)}) {
    REQUIRE(session.apply(SetTemplateLandmark{name, middle(t)}));
    REQUIRE(session.apply(PlaceLandmark{name, middle(t)}));
  }
  CHECK(session.document().view()->shape.confirmed);
  CHECK_FALSE(confirmed_without_landmarks(*session.document().view()));
  REQUIRE(session.apply(Confirm{-pole, 10, true}));
  CHECK(confirmed_without_landmarks(*session.document().view()));
}

TEST_CASE("whether a case holds landmarks is in its first line and its lines give the same points again") {
  const CaseFolder folder;
  Points before;
  {
    EditSession session = create_case(holding(folder), folder.case_path).value();
    REQUIRE(session.apply(PlaceLandmark{"north", place}));
    REQUIRE(session.apply(pull(Vec3(12, 0, 42), Vec3(12, 0, 60), 20)));
    REQUIRE(session.apply(PlaceLandmark{"north", place, false}));
    REQUIRE(session.apply(pull(Vec3(-12, 0, 42), Vec3(-12, 0, 60), 20)));
    before = *session.document().view()->shape.points;
  }
  CHECK(folder.text().find("\"held_landmarks\":true") != std::string::npos);
  CHECK(folder.text().find("\"held\":false") != std::string::npos);
  const auto read = read_case(folder.case_path);
  REQUIRE(read);
  CHECK(*read->session.document().view()->shape.points == before);
}

TEST_CASE("a landmark is held by all of its corners and met within an edge or two mm") {
  const CaseFolder folder;
  Document document = holding(folder);
  Shape& shape = test::changed_shape(document);
  const Template& the_template = *document.structure()->the_template;
  const auto corners = the_template.topology->triangles().row(the_template.landmark_points[0].face);
  VertexScalars confirmed = VertexScalars::Zero(shape.points->rows());
  for (int k = 0; k < 3; ++k) {
    confirmed[corners[k]] = 1;
    shape.confirmed = std::make_shared<const VertexScalars>(confirmed);
    CHECK(landmark_hold(the_template, 0, shape).held == (k == 2));
  }
  double edge_mm = 0;
  for (int k = 0; k < 3; ++k)
    edge_mm = std::max(edge_mm, (shape.reference->row(corners[k]) - shape.reference->row(corners[(k + 1) % 3])).norm());
  REQUIRE(edge_mm > 2);
  const Vec3 on_mesh = carried_landmark(the_template, 0, *shape.points);
  for (const double share : {0.9, 1.1}) {
    shape.landmarks["north"] = on_mesh + Vec3(0, 0, share * edge_mm);
    const LandmarkHold hold = landmark_hold(the_template, 0, shape);
    CHECK(hold.placed);
    CHECK(hold.distance_mm == doctest::Approx(share * edge_mm));
    CHECK(hold.met == (share < 1));
  }
}

}  // namespace homolog
