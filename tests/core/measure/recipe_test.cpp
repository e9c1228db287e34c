// Measurements by name: what each kind gives on shapes whose measures are known, and which recipes are refused.
#include <doctest/doctest.h>

#include <numbers>

#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/recipe/measured_lines.h"
#include "core/measure/recipe/measuring.h"
#include "core/measure/recipe/step_kinds.h"
#include "core/mesh/construction/icosphere.h"
#include "tests/must.h"
#include "tests/shapes.h"

namespace homolog {

namespace {

using std::numbers::pi;

/// A recipe of these elements and measurements, measured on a mesh.
std::vector<MeasuredNumber> recipe_gives(const std::string& elements, const std::string& measurements, const Mesh& mesh,
                                         const std::vector<Landmark>& landmarks = {}) {
  const Recipe recipe = test::must(
      parse_recipe(R"({"homolog_recipe":1,"elements":[)" + elements + R"(],"measurements":[)" + measurements + "]}"));
  MeasuredShape shape;
  shape.structures.push_back({"", mesh, landmarks, {}});
  return measure(recipe, shape);
}

double one_number(const std::string& elements, const std::string& measurement, const Mesh& mesh,
                  const std::vector<Landmark>& landmarks = {}) {
  const auto all = recipe_gives(elements, measurement, mesh, landmarks);
  REQUIRE_MESSAGE(all.front().value.has_value(), all.front().missing);
  return *all.front().value;
}

std::string refused_recipe(const std::string& elements, const std::string& measurements) {
  const auto recipe =
      parse_recipe(R"({"homolog_recipe":1,"elements":[)" + elements + R"(],"measurements":[)" + measurements + "]}");
  REQUIRE_FALSE(recipe);
  return recipe.error().what;
}

bool tells(const std::string& sentence, const std::string& part) {
  return sentence.find(part) != std::string::npos;
}

const Similarity other_pose{Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Vec3(0.3, -0.7, 0.5).normalized())), 1,
                            Vec3(31, -48, 12)};

Mesh posed_mesh(const Similarity& place, Mesh mesh) {
  mesh.points = place.apply(mesh.points);
  return mesh;
}

}  // namespace

TEST_CASE("a ball has the radius and the centre and the girth that it was made with") {
  const Mesh ball = posed_mesh(other_pose, icosphere(4, 20));
  CHECK(one_number("", R"({"name":"r","kind":"radius","of":{"kind":"sphere","of":{"kind":"whole"}}})", ball) ==
        doctest::Approx(20).epsilon(1e-9));
  CHECK(one_number(R"({"name":"s","kind":"sphere","of":{"kind":"whole"}},{"name":"c","kind":"centre","of":"s"},
             {"name":"m","kind":"centroid"})",
                   R"({"name":"d","kind":"distance","from":"c","to":"m"})", ball) < 1e-6);
  const std::string cut =
      R"({"name":"a","kind":"landmark"},{"name":"b","kind":"landmark"},{"name":"l","kind":"line","through":["a","b"]},
         {"name":"cut","kind":"section","plane":{"kind":"plane","at":{"kind":"midpoint","of":["a","b"]},"across":"l"}})";
  const std::vector<Landmark> poles{{"a", other_pose.apply(Vec3(0, 0, -20))}, {"b", other_pose.apply(Vec3(0, 0, 20))}};
  const double girth = one_number(cut, R"({"name":"g","kind":"girth","of":"cut"})", ball, poles);
  CHECK(girth == doctest::Approx(2 * pi * 20).epsilon(0.005));
  CHECK(girth < 2 * pi * 20);
  CHECK(one_number(cut, R"({"name":"g","kind":"area","of":"cut"})", ball, poles) ==
        doctest::Approx(pi * 400).epsilon(0.01));
  const double over = one_number(cut, R"({"name":"g","kind":"length","through":["a","b"]})", ball, poles);
  CHECK(over == doctest::Approx(pi * 20).epsilon(0.005));
  CHECK(one_number(cut, R"({"name":"g","kind":"thickness","statistic":"median"})", ball, poles) ==
        doctest::Approx(40).epsilon(0.01));
}

TEST_CASE("a cylinder has its axis and its girth and the way over its wall is a straight line unrolled") {
  const Mesh tube = posed_mesh(other_pose, shapes::open_cylinder(31, 64, 10, 60));
  const std::vector<Landmark> ends{{"low", other_pose.apply(Vec3(0, 0, 0))},
                                   {"high", other_pose.apply(Vec3(0, 0, 60))},
                                   {"p", other_pose.apply(Vec3(10, 0, 10))},
                                   {"q", other_pose.apply(Vec3(0, 10, 50))}};
  const std::string axis =
      R"({"name":"low","kind":"landmark"},{"name":"high","kind":"landmark"},{"name":"p","kind":"landmark"},
         {"name":"q","kind":"landmark"},{"name":"l","kind":"line","through":["low","high"]},
         {"name":"c","kind":"cylinder","of":{"kind":"whole"},"towards":"high"})";
  CHECK(one_number(axis, R"({"name":"x","kind":"angle","between":["c","l"]})", tube, ends) < 1e-6);
  CHECK(one_number(axis, R"({"name":"x","kind":"radius","of":"c"})", tube, ends) == doctest::Approx(10).epsilon(1e-9));
  CHECK(one_number(axis, R"({"name":"x","kind":"distance","from":"p","to":"c"})", tube, ends) == doctest::Approx(10));
  CHECK(
      one_number(
          axis,
          R"({"name":"x","kind":"girth","of":{"kind":"section","plane":{"kind":"plane","at":{"kind":"centre","of":"c"},"across":"c"}}})",
          tube, ends) == doctest::Approx(64 * 2 * 10 * std::sin(pi / 64)).epsilon(1e-9));
  // Along an axis a distance has a sign.
  CHECK(one_number(axis, R"({"name":"x","kind":"distance","from":"p","to":"q","along":"c"})", tube, ends) ==
        doctest::Approx(40));
  CHECK(one_number(axis, R"({"name":"x","kind":"distance","from":"q","to":"p","along":"l"})", tube, ends) ==
        doctest::Approx(-40));
  const auto undirected = recipe_gives(
      axis, R"({"name":"x","kind":"distance","from":"p","to":"q","along":{"kind":"cylinder","of":{"kind":"whole"}}})",
      tube, ends);
  CHECK(tells(undirected.front().missing, "goes along an axis without a direction"));
  const double unrolled = std::hypot(40, 16 * 2 * 10 * std::sin(pi / 64));
  CHECK(one_number(axis, R"({"name":"x","kind":"length","through":["p","q"]})", tube, ends) ==
        doctest::Approx(unrolled).epsilon(5e-4));
  CHECK(one_number(axis, R"({"name":"x","kind":"extent","along":"l"})", tube, ends) == doctest::Approx(60));
  const auto open = recipe_gives(
      axis,
      R"({"name":"x","kind":"girth","of":{"kind":"section","plane":{"kind":"plane","through":["low","high","p"]}}})",
      tube, ends);
  CHECK(tells(open.front().missing, "runs into an opening"));
}

TEST_CASE("a box has its volume and areas and angles and a part of it too") {
  const Mesh box = shapes::box(Vec3(0, 0, 0), Vec3(10, 20, 30));
  CHECK(one_number("", R"({"name":"v","kind":"volume"})", box) == doctest::Approx(6));
  CHECK(one_number("", R"({"name":"v","kind":"area"})", box) == doctest::Approx(2200));
  // The faces of the corners with x = 0 are one side.
  CHECK(one_number("", R"({"name":"v","kind":"area","of":{"kind":"vertices","vertices":[0,2,4,6]}})", box) ==
        doctest::Approx(600));
  const std::string corners =
      R"({"name":"o","kind":"vertex","vertex":0},{"name":"x","kind":"vertex","vertex":1},
         {"name":"y","kind":"vertex","vertex":2},{"name":"z","kind":"vertex","vertex":4},
         {"name":"xy","kind":"plane","through":["o","x","y"]},{"name":"ox","kind":"line","through":["o","x"]},
         {"name":"yx","kind":"line","through":["y","x"]},{"name":"xo","kind":"line","through":["x","o"]})";
  CHECK(one_number(corners, R"({"name":"v","kind":"distance","from":"z","to":"xy"})", box) == doctest::Approx(30));
  CHECK(one_number(corners, R"({"name":"v","kind":"angle","at":"o","from":"x","to":"y"})", box) == doctest::Approx(90));
  CHECK(one_number(corners, R"({"name":"v","kind":"angle","between":["ox","xo"]})", box) == doctest::Approx(180));
  CHECK(one_number(corners, R"({"name":"v","kind":"angle","between":["ox","yx"]})", box) ==
        doctest::Approx(std::atan2(20, 10) * 180 / pi));
  CHECK(one_number(corners, R"({"name":"v","kind":"angle","between":["xy",{"kind":"line","through":["o","z"]}]})",
                   box) == doctest::Approx(90));
  CHECK(one_number(
            corners,
            R"({"name":"a","kind":"distance","from":"o","to":"x"},{"name":"v","kind":"length","through":["o","x"]})",
            box) == doctest::Approx(10));
  const auto derived = recipe_gives(corners, R"({"name":"a","kind":"distance","from":"o","to":"x"},
      {"name":"b","kind":"distance","from":"o","to":"y"},{"name":"c","kind":"ratio","of":["a","b"]},
      {"name":"d","kind":"asymmetry","of":["a","b"]},{"name":"e","kind":"difference","of":["a","b"]})",
                                    box);
  CHECK(*derived[2].value == doctest::Approx(0.5));
  CHECK(*derived[3].value == doctest::Approx(-200.0 / 3));
  CHECK(*derived[4].value == doctest::Approx(-10));
}

TEST_CASE("the cap of a ball has the volume of a cap and a hollow ball the thickness of its wall") {
  const Mesh ball = icosphere(5, 20);
  const std::vector<Landmark> axis{{"o", Vec3::Zero()}, {"up", Vec3(0, 0, 20)}};
  const std::string upper =
      R"({"name":"o","kind":"landmark"},{"name":"up","kind":"landmark"},
         {"name":"cap","kind":"slab","at":"o","along":{"kind":"line","through":["o","up"]},"from_mm":-0.01,"to_mm":20})";
  // An icosphere has vertices on its equator, so the cap is half of it.
  CHECK(one_number(upper, R"({"name":"v","kind":"volume","of":"cap"})", ball, axis) ==
        doctest::Approx(2.0 / 3 * pi * 8).epsilon(0.05));
  Mesh wall = icosphere(3, 20);
  const Mesh inner = icosphere(3, 15);
  const Eigen::Index n = wall.points.rows(), m = wall.topology->triangles().rows();
  Points points(2 * n, 3);
  points << wall.points, inner.points;
  Triangles triangles(2 * m, 3);
  triangles << wall.topology->triangles(), inner.topology->triangles().array() + static_cast<std::int32_t>(n);
  triangles.bottomRows(m).col(1).swap(triangles.bottomRows(m).col(2));
  const Mesh hollow{test::must(Topology::make(2 * n, triangles)), points};
  CHECK(one_number("", R"({"name":"v","kind":"thickness"})", hollow) == doctest::Approx(5).epsilon(0.02));
}

TEST_CASE("a thickness to a sheet passes over what lies between and is empty where the sheet does not lie that way") {
  const Eigen::Index n = icosphere(3, 1).points.rows(), m = icosphere(3, 1).topology->triangles().rows();
  Points points(3 * n, 3);
  Triangles triangles(3 * m, 3);
  for (int k = 0; k < 3; ++k) {
    const Mesh ball = icosphere(3, 20 - 5 * k);
    points.middleRows(k * n, n) = ball.points;
    triangles.middleRows(k * m, m) = ball.topology->triangles().array() + static_cast<std::int32_t>(k * n);
  }
  const Mesh nested{test::must(Topology::make(3 * n, triangles)), points};
  const auto thickness = [&](int of, int to) {
    const std::string part = R"({"name":"v","kind":"thickness","of":{"kind":"sheet","sheet":)" + std::to_string(of) +
                             R"(},"to":{"kind":"sheet","sheet":)" + std::to_string(to) + "}}";
    return recipe_gives("", part, nested).front().value;
  };
  CHECK(thickness(1, 2).value_or(0) == doctest::Approx(5).epsilon(0.02));
  CHECK(thickness(1, 3).value_or(0) == doctest::Approx(10).epsilon(0.02));
  CHECK_FALSE(thickness(3, 1).value_or(30) == doctest::Approx(20).epsilon(0.02));  // the own far wall
  CHECK(thickness(3, 1).value_or(0) == doctest::Approx(30).epsilon(0.02));
}

TEST_CASE("measurements stay the same in another pose and lengths grow with the shape") {
  const Mesh organ = shapes::shaft_with_ridge(0.4, 4);
  const std::vector<Landmark> marks{{"a", Vec3(organ.points.row(3))}, {"b", Vec3(organ.points.row(500))}};
  const std::string elements =
      R"({"name":"a","kind":"landmark"},{"name":"b","kind":"landmark"},
         {"name":"up","kind":"line","of":{"kind":"whole"},"towards":"b"},
         {"name":"mid","kind":"slab","at":{"kind":"centroid"},"along":"up","from_mm":{"times":-0.2,"of":"d"},"to_mm":{"times":0.2,"of":"d"}},
         {"name":"c","kind":"cylinder","of":"mid"},{"name":"s","kind":"sphere","of":{"kind":"near","point":"b","within_mm":{"times":0.5,"of":"d"}}})";
  const std::string all =
      R"({"name":"d","kind":"distance","from":"a","to":"b"},{"name":"r","kind":"radius","of":"c"},
         {"name":"q","kind":"radius","of":"s"},{"name":"w","kind":"length","through":["a","b"]},
         {"name":"g","kind":"girth","of":{"kind":"section","plane":{"kind":"plane","at":{"kind":"centroid"},"across":"up"}}},
         {"name":"t","kind":"thickness"},{"name":"x","kind":"angle","between":["c","up"]})";
  const auto turned = [&](const Similarity& place) {
    std::vector<Landmark> there = marks;
    for (Landmark& mark : there) mark.position = place.apply(mark.position);
    return recipe_gives(elements, all, posed_mesh(place, organ), there);
  };
  const auto first = turned({}), second = turned(other_pose);
  Similarity twice = other_pose;
  twice.scale = 2;
  const auto grown = turned(twice);
  for (std::size_t k = 0; k < first.size(); ++k) {
    REQUIRE_MESSAGE(first[k].value, first[k].missing);
    CHECK(*second[k].value == doctest::Approx(*first[k].value).epsilon(1e-9));
    CHECK(*grown[k].value == doctest::Approx(*first[k].value * (k == 6 ? 1 : 2)).epsilon(1e-9));
  }
}

TEST_CASE("what a shape lacks is said and the rest is measured") {
  const auto all =
      recipe_gives(R"({"name":"apex","kind":"landmark"},{"name":"base","kind":"landmark"})",
                   R"({"name":"l","kind":"distance","from":"apex","to":"base"},{"name":"v","kind":"volume"})",
                   shapes::box(), {{"apexx", Vec3::Zero()}, {"base", Vec3::Zero()}});
  CHECK_FALSE(all[0].value);
  CHECK(all[0].missing == "has no landmark \"apex\" (the nearest name is \"apexx\")");
  CHECK(all[1].value);
  const auto structure = recipe_gives("", R"({"name":"v","kind":"volume","structure":"L3"})", shapes::box());
  CHECK(structure.front().missing == "has no structure \"L3\"");
}

TEST_CASE("a recipe with a fault is refused with a sentence that names it") {
  const std::string volume = R"({"name":"v","kind":"volume"})";
  CHECK(tells(refused_recipe("", R"({"name":"v","kind":"volumee"})"),
              "unknown word \"volumee\"; the nearest that fits is \"volume\""));
  CHECK(tells(refused_recipe(R"({"name":"a","kind":"landmark","landmrak":"x"})", volume),
              "\"landmrak\"; the nearest that fits is \"landmark\""));
  CHECK(tells(refused_recipe("", R"({"name":"v","kind":"radius","of":"hed"})"), "unknown word \"hed\""));
  CHECK(tells(refused_recipe(volume, volume), "uses the name \"v\" twice"));
  CHECK(tells(
      refused_recipe(R"({"name":"a","kind":"midpoint","of":["b","b"]},{"name":"b","kind":"midpoint","of":["a","a"]})",
                     volume),
      "goes in a circle: \"a\" needs \"b\", which needs \"a\""));
  CHECK(tells(refused_recipe(R"({"name":"p","kind":"landmark"})", R"({"name":"r","kind":"radius","of":"p"})"),
              "is a point (\"landmark\"); give a sphere or a cylinder"));
  CHECK(tells(refused_recipe("", R"({"name":"p","kind":"landmark"})"), "is a point, not a number"));
  CHECK(tells(refused_recipe("", R"({"name":"r","kind":"distance","from":"r"})"), "needs \"from\" with \"to\""));
  CHECK(tells(refused_recipe("", ""), "names no measurement"));
  CHECK(tells(refused_recipe("", R"({"name":"v","kind":"thickness","statistic":"meen"})"),
              "the nearest that fits is \"mean\""));
  CHECK(tells(
      refused_recipe(
          "", R"({"name":"a","kind":"area"},{"name":"v","kind":"volume"},{"name":"s","kind":"sum","of":["a","v"]})"),
      "different units"));
  CHECK_FALSE(parse_recipe("{"));
  CHECK_FALSE(parse_recipe("[]"));
  CHECK(tells(parse_recipe(R"({"homolog_recipe":2,"measurements":[]})").error().what, "newer version"));
  CHECK(tells(parse_recipe(R"({"homolog_recipe":0,"measurements":[]})").error().what, "recipe version 0"));
}

TEST_CASE("the recipes that ship are read and built-in templates have all that they need") {
  for (const std::string& name : shipped_recipes()) CHECK(load_recipe(name));
  CHECK(tells(load_recipe("femurr").error().what, "femur is the nearest"));
  for (const Organ organ : {Organ::vertebra, Organ::ventricle}) {
    const std::string source = built_in_source(organ);
    const Recipe recipe = test::must(load_recipe(recipe_of_template(source)));
    const auto built_in = test::must(load_template(source));
    MeasuredShape shape;
    shape.structures.push_back({"", {built_in->topology, built_in->points}, built_in->landmarks, {}});
    const auto all = measure(recipe, shape);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const RecipeStep& step = recipe.steps[recipe.measurements[k]];
      if (!step.optional) CHECK_MESSAGE(all[k].value, step.name << ' ' << all[k].missing);
    }
  }
}

TEST_CASE("the page on recipes names every kind") {
  const std::string page = test::must(read_whole_file(std::string(HOMOLOG_SOURCE_DIR) + "/docs/recipes.md"));
  for (const StepKind* kind : step_kinds()) {
    CHECK_MESSAGE(tells(page, "`" + std::string(kind->word) + "`"), kind->word);
    for (const StepMember& member : kind->members)
      CHECK_MESSAGE(tells(page, "`" + std::string(member.key) + "`"), member.key);
  }
}

TEST_CASE("the lines of a measurement are as long as it says and lie where it was taken") {
  const Mesh ball = posed_mesh(other_pose, icosphere(4, 20));
  const Vec3 centre = other_pose.translation;
  const std::vector<Landmark> places{
      {"a", centre + Vec3(20, 0, 0)}, {"b", centre + Vec3(0, 20, 0)}, {"c", centre + Vec3(0, 0, 20)}};
  const Recipe recipe = test::must(parse_recipe(R"({"homolog_recipe":1,"elements":[
    {"name":"a","kind":"landmark"},{"name":"b","kind":"landmark"},{"name":"c","kind":"landmark"},
    {"name":"ball","kind":"sphere","of":{"kind":"whole"}},
    {"name":"middle","kind":"centre","of":"ball"},
    {"name":"to a","kind":"line","through":["middle","a"]},
    {"name":"b to c","kind":"line","through":["b","c"]}],"measurements":[
    {"name":"points","kind":"distance","from":"a","to":"b"},
    {"name":"lines","kind":"distance","from":"to a","to":"b to c"},
    {"name":"point and line","kind":"distance","from":"a","to":"b to c"},
    {"name":"corner","kind":"angle","at":"middle","from":"a","to":"b"},
    {"name":"way","kind":"length","through":["a","b"]},
    {"name":"girth","kind":"girth","of":{"kind":"section","plane":{"kind":"plane","at":"middle","across":"to a"}}},
    {"name":"width","kind":"extent","along":"to a"},
    {"name":"radius","kind":"radius","of":"ball"},
    {"name":"both","kind":"sum","of":["points","width"]},
    {"name":"content","kind":"volume"},
    {"name":"along","kind":"distance","from":"a","to":"middle","along":"to a"}]})"));
  MeasuredShape shape;
  shape.structures.push_back({"", ball, places, {}});
  Measuring measuring(recipe, shape);
  const auto drawn_mm = [&](std::size_t k) {
    double sum = 0;
    for (const auto& line : lines_of_measurement(measuring, recipe, recipe.measurements[k]).lines)
      for (std::size_t p = 1; p < line.size(); ++p) sum += (line[p] - line[p - 1]).norm();
    return sum;
  };
  for (const std::size_t k : {0U, 1U, 2U, 4U, 5U, 6U, 8U}) {
    const MeasuredNumber number = measured_number(measuring, recipe, recipe.measurements[k]);
    REQUIRE_MESSAGE(number.value.has_value(), number.missing);
    CHECK_MESSAGE(drawn_mm(k) == doctest::Approx(*number.value).epsilon(1e-9),
                  recipe.steps[recipe.measurements[k]].name);
  }
  CHECK(drawn_mm(10) == doctest::Approx(20).epsilon(0.01));
  CHECK(drawn_mm(3) == doctest::Approx(40).epsilon(0.01));               // two arms from the middle
  CHECK(drawn_mm(7) == doctest::Approx(3 * 2 * pi * 20).epsilon(0.01));  // three circles about the ball
  CHECK(lines_of_measurement(measuring, recipe, recipe.measurements[9]).lines.empty());
  CHECK((lines_of_measurement(measuring, recipe, recipe.measurements[7]).at - centre).norm() < 0.05);
}

}  // namespace homolog
