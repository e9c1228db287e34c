#include <doctest/doctest.h>

#include "core/base/files/files.h"
#include "core/mesh/construction/icosphere.h"
#include "core/model/files/landmark_table.h"
#include "core/model/measures/observers.h"
#include "core/model/measures/sizes.h"
#include "tests/must.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

// Shapes in tables: sizes, landmarks, two observers.

namespace homolog {

namespace {

MeshFile file_of(const Mesh& mesh, std::vector<Landmark> landmarks = {}) {
  MeshFile file{mesh.points, mesh.topology->triangles()};
  file.landmarks = std::move(landmarks);
  return file;
}

}  // namespace

TEST_CASE("volume and area and distances of a box are those of its sides") {
  std::shared_ptr<const Topology> faces;
  const MeshFile box = file_of(shapes::box({0, 0, 0}, {10, 20, 30}), {{"a", {0, 0, 0}}, {"b", {10, 0, 0}}});
  const ShapeSizes sizes = test::must(sizes_of(box, faces));
  CHECK(*sizes.volume_ml == doctest::Approx(6));
  CHECK(*sizes.area_mm2 == doctest::Approx(2 * (200 + 300 + 600)));
  const MeshFile other = file_of(shapes::box({0, 0, 0}, {20, 20, 30}), {{"b", {3, 4, 0}}, {"c", {0, 0, 0}}});
  const std::vector<ShapeSizes> both{sizes, test::must(sizes_of(other, faces))};
  CHECK(landmark_pairs(both) == std::vector<LandmarkPair>{{"a", "b"}, {"b", "c"}});
  CHECK(*distance_mm(both[0], {"a", "b"}) == doctest::Approx(10));
  CHECK_FALSE(distance_mm(both[1], {"a", "b"}));
  CHECK(sizes_table({"one", "the \"other\""}, both, {"healthy", ""}) ==
        "case,volume_ml,area_mm2,a to b mm,b to c mm,centroid_size_mm,group\none,6,2200,10,,52.915,healthy\n\"the "
        "\"\"other\"\"\",12,3200,,5,58.3095,\n");
  const Spread spread = spread_of({6.0, std::nullopt, 12.0});
  CHECK(spread.count == 2);
  CHECK(spread.mean == doctest::Approx(9));
  CHECK(spread.sd == doctest::Approx(std::sqrt(18)));

  MeshFile points = box;
  points.triangles.edit().resize(0, 3);
  CHECK_FALSE(test::must(sizes_of(points, faces)).volume_ml);
}

TEST_CASE("landmarks are written as geomorph and MorphoJ read them") {
  const std::vector<Specimen> specimens{{"one", {{"hilum", {1, 2, 3.5}}, {"pole", {-4, 0, 0.125}}}},
                                        {"two, left", {{"pole", {7, 8, 9}}}}};
  const LandmarkTable tps = tps_of(specimens);
  CHECK(tps.text == "LM3=2\n1 2 3.5\n-4 0 0.125\nID=one\nLM3=2\nNA NA NA\n7 8 9\nID=two, left\n");
  CHECK(tps.lacking == std::vector<std::string>{"two, left"});
  const LandmarkTable csv = csv_of(specimens);
  CHECK(csv.text ==
        "ID,hilum x,hilum y,hilum z,pole x,pole y,pole z\none,1,2,3.5,-4,0,0.125\n\"two, left\",NA,NA,NA,7,8,9\n");
  const TemporaryFolder folder;
  CHECK(write_landmark_table(specimens, folder.path / "a.TPS"));
  CHECK(test::must(read_whole_file(folder.path / "a.TPS")) == tps.text);
  CHECK_FALSE(write_landmark_table(specimens, folder.path / "a.txt"));
  CHECK_FALSE(write_landmark_table({{"one", {}}}, folder.path / "none.csv"));
  CHECK_FALSE(std::filesystem::exists(folder.path / "none.csv"));
  CHECK(vertices_as_landmarks(shapes::tetrahedron().points)[3].name == "3");
}

TEST_CASE("two observers are compared case by case and by landmark") {
  const TemporaryFolder folder;
  const auto write = [&](const char* observer, const char* name, double radius_mm, double north_mm) {
    std::filesystem::create_directories(folder.path / observer);
    REQUIRE(write_mesh_file(file_of(icosphere(3, radius_mm), {{"north", {0, 0, north_mm}}}),
                            folder.path / observer / name));
  };
  write("a", "one.ply", 20, 20);
  write("a", "two.ply", 20, 20);
  write("a", "mine.ply", 20, 20);
  write("b", "one.ply", 20, 20);
  write("b", "two.ply", 22, 23);
  const auto a = test::must(read_observer(folder.path / "a")), b = test::must(read_observer(folder.path / "b"));
  const ObserverComparison comparison = test::must(compare_observers(a.shapes, b.shapes));
  REQUIRE(comparison.cases.size() == 2);
  CHECK(comparison.only_first == std::vector<std::string>{"mine"});
  CHECK(comparison.only_second.empty());
  CHECK(comparison.cases[0].agreement.dice == doctest::Approx(1));
  CHECK(comparison.cases[0].landmarks_mm.at("north") == 0);
  const ObservedCase& two = comparison.cases[1];
  CHECK(two.name == "two");
  CHECK(two.agreement.assd_mm == doctest::Approx(2).epsilon(0.01));
  CHECK(*two.agreement.vertex_mean_mm == doctest::Approx(2).epsilon(0.01));
  CHECK(two.landmarks_mm.at("north") == doctest::Approx(3));
  CHECK(two.volume_b_ml / two.volume_a_ml == doctest::Approx(std::pow(1.1, 3)));
  CHECK(observers_table(comparison)
            .starts_with(
                "case,dice,assd_mm,hd95_mm,hausdorff_mm,vertex_mean_mm,volume_a_ml,volume_b_ml,north mm\none,1,"));

  const auto single = test::must(read_observer(folder.path / "a" / "two.ply"));
  const auto other = test::must(read_observer(folder.path / "b" / "two.ply"));
  CHECK(test::must(compare_observers(single.shapes, other.shapes)).cases.size() == 1);
  CHECK_FALSE(compare_observers(a.shapes, single.shapes));
  CHECK_FALSE(read_observer(folder.path / "nowhere"));
}

}  // namespace homolog
