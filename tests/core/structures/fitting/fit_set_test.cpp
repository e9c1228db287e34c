#include "core/structures/fitting/fit_set.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "core/adapt/labels/faced_template.h"
#include "core/case/placing.h"
#include "core/measure/compare.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/mesh/voxels/label_map.h"
#include "core/structures/fitting/keep_apart.h"
#include "core/structures/fitting/set_in_case.h"
#include "core/structures/maps/set_map.h"
#include "tests/must.h"

namespace homolog {

namespace {

/// A ball, longer along x, so that it has a direction.
Mesh egg_at(double x_mm, double radius_mm) {
  Mesh egg = icosphere(3, radius_mm);
  egg.points.col(0) *= 1.3;
  egg.points.col(2) *= 0.8;
  egg.points.col(0).array() += x_mm;
  return egg;
}

const std::vector<double> radii{20, 15, 10};
const std::vector<double> places{-60, 0, 50};

/// Three eggs in a row, "a", "b", "c", with the labels 1, 2 and 3.
SetOfTemplates eggs() {
  SetOfTemplates set;
  for (std::size_t k = 0; k < 3; ++k) {
    TemplateOfSet one;
    one.name = std::string(1, static_cast<char>('a' + k));
    one.value = static_cast<int>(k) + 1;
    set.set.structures.push_back(one);
    const Mesh egg = egg_at(places[k], radii[k]);
    MeshFile file;
    file.points = egg.points;
    file.triangles = egg.topology->triangles();
    set.templates.push_back(test::must(make_template(file, one.name)));
  }
  return set;
}

/// A map of the same eggs, each a tenth larger, moved by 7 mm along y.
VolumeRead map_of_eggs() {
  VolumeGeometry grid;
  grid.dims = {200, 80, 70};
  grid.origin_mm = Vec3(-100, -33, -35);
  std::vector<MeshOfSegment> meshes;
  for (std::size_t k = 0; k < 3; ++k) {
    Mesh egg = egg_at(places[k], 1.1 * radii[k]);
    egg.points.col(1).array() += 7;
    meshes.push_back({{std::string(1, static_cast<char>('a' + k)), static_cast<int>(k) + 1, 0, {}, {}}, egg});
  }
  MapOfMeshes made = map_of_meshes(meshes, grid);
  CHECK(made.contested_voxels == 0);
  return std::move(made.map);
}

}  // namespace

TEST_CASE("all structures of a set come to their labels") {
  const SetOfTemplates set = eggs();
  const SetInMap subject = find_in_map(set.set, map_of_eggs());
  CHECK(subject.without_template.empty());
  const FittedSet fitted = test::must(fit_set(set, subject));
  CHECK(fitted.depth_mm <= 0.1);
  for (std::size_t k = 0; k < 3; ++k) {
    const FittedStructure& one = fitted.structures[k];
    CAPTURE(k);
    REQUIRE(one.fit);
    CHECK(one.judgement.inside_scan.dice > 0.97);
    CHECK_FALSE(one.judgement.doubtful);
    CHECK(one.off_place >= 0);
    CHECK(one.off_place < 0.1);
    CHECK(one.confidence > 0.5);
    const Vec3 middle = one.fit->mesh.points.colwise().mean();
    CHECK((middle - Vec3(places[k], 7, 0)).norm() < 1);
  }
}

TEST_CASE("what is told of a structure is of its mesh as it was kept apart, and a gap without room makes it doubtful") {
  SetOfTemplates set = eggs();
  // The middle one becomes a plate that the others nearly touch.
  const std::vector<Mesh> meshes = [] {
    std::vector<Mesh> all{egg_at(-28, radii[0]), icosphere(4, 18), egg_at(21, radii[1])};
    all[1].points.col(0) *= 0.08;
    return all;
  }();
  VolumeGeometry grid;
  grid.dims = {220, 100, 100};
  grid.spacing_mm = Vec3::Constant(0.5);
  grid.origin_mm = Vec3(-58, -25, -25);
  std::vector<MeshOfSegment> segments;
  for (std::size_t k = 0; k < 3; ++k) {
    MeshFile file;
    file.points = meshes[k].points;
    file.triangles = meshes[k].topology->triangles();
    set.templates[k] = test::must(make_template(file, set.set.structures[k].name));
    segments.push_back({{set.set.structures[k].name, static_cast<int>(k) + 1, 0, {}, {}}, meshes[k]});
  }
  const VolumeRead map = map_of_meshes(segments, grid).map;
  const SetInMap subject = find_in_map(set.set, map);
  const FittedSet free = test::must(fit_set(set, subject)), wide = test::must(fit_set(set, subject, {.gap_mm = 5}));
  CHECK(std::ranges::none_of(free.apart, &KeptApart::too_near));
  CHECK(wide.depth_mm == 0);
  for (std::size_t k = 0; k < 3; ++k) {
    CAPTURE(k);
    REQUIRE(wide.structures[k].fit);
    const FittedStructure& one = wide.structures[k];
    CHECK_FALSE(free.structures[k].judgement.doubtful);
    CHECK(self_intersections(one.fit->mesh).empty());
    const Mesh label = test::must(mask_surface(map.volume, static_cast<int>(k) + 1, 0));
    CHECK(one.judgement.inside_scan.dice == doctest::Approx(compare_meshes(one.fit->mesh, label).dice).epsilon(0.01));
    CHECK(one.judgement.inside_scan.dice < free.structures[k].judgement.inside_scan.dice);
    // A vertex that was moved may belong as far off as it moved.
    const double moved_mm = (one.fit->mesh.points - free.structures[k].fit->mesh.points).rowwise().norm().maxCoeff();
    CHECK(moved_mm > 0.5);
    CHECK(one.fit->doubt_mm.maxCoeff() >= 0.9 * moved_mm);
  }
  CHECK(wide.structures[1].judgement.doubtful);
  CHECK(wide.structures[1].judgement.warnings.back().find("mm apart from") != std::string::npos);
  CHECK(wide.structures[1].confidence <= 0.5);
  const auto near = std::ranges::find_if(wide.apart, &KeptApart::too_near);
  REQUIRE(near != wide.apart.end());
  CHECK(near->mm < 4.9);
  CHECK(near->mm > 0);
}

namespace {

/// A ventricle (4) of these half axes, its atrium (2) above `base_mm` and its wall (9) below.
VolumeRead map_of_heart(const Vec3& half_axes_mm, double base_mm) {
  VolumeRead map;
  Volume& heart = map.volume;
  heart.geometry.dims = {48, 48, 56};
  heart.geometry.spacing_mm = Vec3::Constant(1.5);
  heart.geometry.origin_mm = Vec3(-35.25, -35.25, -41.25);
  std::vector<std::uint8_t> voxels(heart.geometry.voxels());
  for (int k = 0; k < 56; ++k)
    for (int j = 0; j < 48; ++j)
      for (int i = 0; i < 48; ++i) {
        const Vec3 p = heart.geometry.to_mm(Vec3(i, j, k));
        const bool within = p.cwiseQuotient(half_axes_mm).norm() < 1,
                   around = p.cwiseQuotient(half_axes_mm + Vec3::Constant(6)).norm() <= 1;
        const int value = within ? 4 : !around ? 0 : p.z() > base_mm ? 2 : 9;
        voxels[heart.geometry.index(i, j, k)] = static_cast<std::uint8_t>(value);
      }
  heart.data = std::move(voxels);
  heart.range_max = 9;
  return map;
}

}  // namespace

TEST_CASE("a template of a part of a label ends at its neighbours in a set too") {
  const VolumeRead of_template = map_of_heart({20, 18, 28}, 12);
  const FacedTemplateOptions making{.label = 4, .vertices = 600};
  const FacedTemplate part = test::must(make_faced_template(of_template.volume, {{2}, false}, making));
  MeshFile file = faced_template_file(part.mesh, "heart", {"atrium", false}, making, {4});
  SetOfTemplates set;
  set.set.structures = {{.name = "ventricle", .value = 4}, {.name = "atrium", .value = 2}};
  set.templates = {test::must(make_template(file, "ventricle.ply")), nullptr};
  VolumeRead map = map_of_heart({23, 19, 31}, 16);
  const auto fitted_to = [&] { return test::must(fit_set(set, find_in_map(set.set, map))).structures.front(); };
  const auto check_ends = [](const FittedStructure& one) {
    REQUIRE(one.fit);
    CHECK(one.why_whole.empty());
    CHECK_FALSE(one.judgement.doubtful);
    REQUIRE(one.judgement.rim);
    CHECK(one.judgement.rim->mean_mm < 0.5);
  };
  // Of a map without names the set says which label is the atrium.
  check_ends(fitted_to());
  for (const Segment& segment : {Segment{.name = "ventricle", .value = 4}, Segment{.name = "Atrium", .value = 2}})
    REQUIRE(map.segmentation.add(segment));
  check_ends(fitted_to());

  set.set.structures.pop_back();
  set.templates.pop_back();
  check_ends(fitted_to());
  map.segmentation.segments.front().name = "aorta";  // value 2
  const FittedStructure whole = fitted_to();
  REQUIRE(whole.fit);
  CHECK(whole.why_whole.starts_with("the template ends at its neighbours, and the map has no label named \"atrium\""));
  CHECK(whole.why_whole.ends_with("; the label's whole surface was taken"));
  CHECK_FALSE(whole.judgement.rim);
}

TEST_CASE("what was fitted of another template takes the place of a structure and never its numbering") {
  const SetOfTemplates set = eggs();
  const VolumeRead map = map_of_eggs();
  const SetInMap subject = find_in_map(set.set, map);
  const FittedSet fitted = test::must(fit_set(set, subject));
  Document document;
  for (std::size_t k = 0; k < 2; ++k) {
    // "a" of the set's own template; "b" of one with as many vertices in another order.
    MeshFile file = to_mesh_file(*set.templates[k]);
    if (k == 1) {
      file.points = file.points.colwise().reverse().eval();
      const auto last = static_cast<std::int32_t>(file.points.rows()) - 1;
      file.triangles = Triangles(last - file.triangles->array());
    }
    Structure structure = new_structure(test::must(make_template(file, "t" + std::to_string(k))), Similarity{});
    structure.id = "s" + std::to_string(k + 1);
    structure.name = k == 0 ? "a" : "b";
    document.structures.push_back(std::make_shared<const Structure>(std::move(structure)));
  }
  std::map<std::string, std::string> brought, removed;
  for (const EditStep& step : steps_of_fitted_set(document, set, subject, fitted)) {
    if (const auto* one = std::get_if<SetStructure>(&step.action)) brought[*one->name] = one->id;
    if (const auto* one = std::get_if<RemoveStructure>(&step.action)) removed[one->id] = one->id;
  }
  CHECK(brought["a"] == "s1");
  CHECK(brought["b"] == "s3");
  CHECK(removed.size() == 1);
  CHECK(removed.contains("s2"));
}

TEST_CASE("a structure that the map lacks is missing, and one without template is named") {
  const SetOfTemplates set = eggs();
  VolumeRead map = map_of_eggs();
  for (auto& voxel : std::get<std::vector<std::uint8_t>>(map.volume.data))
    if (voxel == 2) voxel = 9;
  const SetInMap subject = find_in_map(set.set, map);
  CHECK(subject.without_template == std::vector<std::string>{"label 9"});
  CHECK_FALSE(subject.structures[1].is_there());
  const FittedSet fitted = test::must(fit_set(set, subject));
  CHECK(fitted.structures[0].fit);
  CHECK_FALSE(fitted.structures[1].fit);
  CHECK(fitted.structures[1].confidence == 0);
  CHECK(fitted.structures[2].fit);
}

TEST_CASE("a value counts only where the map gives it no other name") {
  const SetOfTemplates set = eggs();
  VolumeRead map = map_of_eggs();
  map.segmentation.segments[0].name = "C";
  map.segmentation.segments[1].name = "";
  map.segmentation.segments[2].name = "A";
  const SetInMap subject = find_in_map(set.set, map);
  CHECK(subject.structures[0].segment.value == 3);
  CHECK(subject.structures[1].segment.value == 2);
  CHECK(subject.structures[2].segment.value == 1);
}

TEST_CASE("a structure is found by the words of its name, unless another label has the name itself") {
  SetOfTemplates set = eggs();
  set.set.structures[0].name = "kidney_left";
  set.set.structures[1].name = "kidney_right";
  VolumeRead map = map_of_eggs();
  map.segmentation.segments[0].name = "Right kidney";
  map.segmentation.segments[1].name = "Left kidney";
  map.segmentation.segments[2].name = "kidney left";
  SetInMap subject = find_in_map(set.set, map);
  CHECK(subject.structures[1].segment.value == 1);
  CHECK(subject.structures[0].why_left_out.find("both have its name") != std::string::npos);
  map.segmentation.segments[2].name = "KIDNEY_LEFT";
  subject = find_in_map(set.set, map);
  CHECK(subject.structures[0].segment.value == 3);
  CHECK(subject.without_template == std::vector<std::string>{"Left kidney"});
}

TEST_CASE("neighbours of different layers are kept apart, but for one that lies within another") {
  SetOfTemplates set = eggs();
  set.set.structures.push_back({.name = "spot", .value = 4});
  const Mesh spot = egg_at(0, 6);
  MeshFile file;
  file.points = spot.points;
  file.triangles = spot.topology->triangles();
  set.templates.push_back(test::must(make_template(file, "spot")));
  const VolumeRead united = map_of_eggs();
  std::vector<MeshOfSegment> meshes;
  for (std::size_t k = 0; k < 4; ++k) {
    Mesh egg = k < 3 ? egg_at(places[k], 1.1 * radii[k]) : spot;
    egg.points.col(1).array() += 7;
    meshes.push_back({{set.set.structures[k].name, 1, k, {}, {}}, egg});
  }
  const SetInMap subject = find_in_map(set.set, map_of_meshes(meshes, united.volume.geometry).map);
  CHECK(subject.lie_apart(0, 1));
  CHECK(subject.lie_apart(2, 3));
  CHECK_FALSE(subject.lie_apart(1, 3));
  CHECK_FALSE(subject.lie_apart(3, 1));
  // The first two come 10 mm near to each other, the last two 14 mm.
  constexpr double gap_mm = 12;
  const FittedSet fitted = test::must(fit_set(set, subject, {.gap_mm = gap_mm}));
  std::vector<Mesh> fits;
  for (const FittedStructure& one : fitted.structures) fits.push_back(one.fit->mesh);
  CHECK(depth_mm(fits[0], fits[1], 20) <= -gap_mm + 0.15);
  CHECK(depth_mm(fits[0], fits[1], 20) >= -gap_mm - 0.5);
  CHECK(share_within(fits[3], *ClosedMesh::of(fits[1])) == 1);
  CHECK(fitted.structures[3].judgement.inside_scan.dice > 0.9);
  CHECK(fitted.depth_mm == 0);
}

TEST_CASE("in a map of meshes a voxel belongs to one structure of a layer") {
  VolumeGeometry grid;
  grid.dims = {80, 50, 50};
  grid.origin_mm = Vec3(-25, -25, -25);
  const Mesh first = icosphere(4, 20);
  Mesh second = first;
  second.points.col(0).array() += 30;
  const Segment a{"a", 1, 0, {}, {}}, b{"b", 300, 0, {}, {}}, c{"c", 300, 7, {}, {}};
  const MapOfMeshes one = map_of_meshes({{a, first}, {b, second}}, grid);
  CHECK(one.map.other_layers.empty());
  CHECK(one.contested_voxels > 2000);
  const auto held = labels_of(one.map.volume);
  CHECK(held.at(1) > held.at(300));
  const MapOfMeshes two = map_of_meshes({{a, first}, {c, second}}, grid);
  CHECK(two.contested_voxels == 0);
  REQUIRE(two.map.other_layers.size() == 1);
  CHECK(labels_of(two.map.volume).at(1) == labels_of(two.map.other_layers[0]).at(300));
  CHECK(two.map.segmentation.segments[1].layer == 1);
  const MeshPair both{0, 1};
  const MapOfMeshes apart = map_of_meshes({{a, first}, {c, second}}, grid, {&both, 1});
  CHECK(apart.contested_voxels == one.contested_voxels);
  CHECK(labels_of(apart.map.volume).at(1) == held.at(1));
  CHECK(labels_of(apart.map.other_layers[0]).at(300) == held.at(300));

  // In layers each keeps all its voxels, and a layer has a value once.
  const MapOfMeshes layered = map_in_layers({{a, first}, {b, second}}, grid);
  CHECK(layered.contested_voxels == one.contested_voxels);
  REQUIRE(layered.map.other_layers.size() == 1);
  CHECK(labels_of(layered.map.volume).at(1) == held.at(1));
  CHECK(labels_of(layered.map.other_layers[0]).at(300) == held.at(1));
  CHECK(layered.map.segmentation.segments[1].layer == 1);
  Mesh third = first;
  third.points.col(0).array() += 60;
  const Segment d{"d", 2, 0, {}, {}}, e{"e", 300, 0, {}, {}};
  const MapOfMeshes three = map_in_layers({{a, first}, {b, second}, {d, third}}, grid);
  CHECK(three.map.other_layers.size() == 1);
  CHECK(three.map.segmentation.find(2, 0) != nullptr);
  CHECK(three.map.segmentation.find(300, 1) != nullptr);
  const MapOfMeshes again = map_in_layers({{a, first}, {c, second}, {e, second}}, grid);
  REQUIRE(again.map.other_layers.size() == 2);
  CHECK(again.map.segmentation.segments[2].layer == 2);
  CHECK(labels_of(again.map.other_layers[1]).at(300) == held.at(1));
  // Nothing changes where none overlaps.
  const MapOfMeshes free = map_in_layers({{a, first}, {d, third}}, grid);
  CHECK(free.contested_voxels == 0);
  CHECK(free.map.volume.data == map_of_meshes({{a, first}, {d, third}}, grid).map.volume.data);
  CHECK(free.map.other_layers.empty());
}

}  // namespace homolog
