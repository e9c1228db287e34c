#include <doctest/doctest.h>

#include <cmath>

#include "core/adapt/propagate.h"
#include "core/assist/assist.h"
#include "core/case/action_line.h"
#include "core/catalogue/catalogue.h"
#include "core/deform/fold_guard.h"
#include "core/experiment/scripted_user.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_quality.h"
#include "core/phantom/phantom.h"
#include "core/session/case_file.h"
#include "core/session/session.h"
#include "core/solve/elimination_plan.h"
#include "core/volume/volume_io.h"
#include "tests/changed_shape.h"
#include "tests/real_data.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

using namespace homolog;

namespace {

/// A blurred bright ellipsoid in darkness; frames may differ.
struct Blob {
  Vec3 radii_mm{30, 25, 35};
  double inside = 100, outside = 0, noise = 3;
};

double blob_at(const Blob& blob, const Vec3& p) {
  const double distance_mm = (p.cwiseQuotient(blob.radii_mm).norm() - 1) * blob.radii_mm.mean();
  return blob.outside + (blob.inside - blob.outside) / (1 + std::exp(distance_mm / 0.7));
}

/// Grain that is the same on every machine.
double blob_grain(std::size_t voxel) {
  std::uint64_t bits = voxel * 0x9e3779b97f4a7c15u;
  bits ^= bits >> 31;
  bits *= 0xbf58476d1ce4e5b9u;
  bits ^= bits >> 29;
  return static_cast<double>(bits >> 11) / static_cast<double>(std::uint64_t{1} << 53) * 2 - 1;
}

Volume blob_image(const std::vector<Blob>& blobs, double spacing_mm = 2, int size = 60) {
  Volume image;
  image.geometry.dims = {size, size, size};
  image.geometry.spacing_mm.setConstant(spacing_mm);
  image.geometry.origin_mm.setConstant(-spacing_mm * (size - 1) / 2);
  image.frames = static_cast<int>(blobs.size());
  std::vector<float> voxels;
  voxels.reserve(image.geometry.voxels() * blobs.size());
  for (const Blob& blob : blobs)
    for (int k = 0; k < size; ++k)
      for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i)
          voxels.push_back(static_cast<float>(blob_at(blob, image.geometry.to_mm(Vec3(i, j, k))) +
                                              blob.noise * blob_grain(voxels.size())));
  image.data = std::move(voxels);
  return image;
}

Mesh blob_mesh(const Vec3& radii_mm) {
  Mesh mesh = icosphere(3, 1);
  mesh.points = mesh.points * radii_mm.asDiagonal();
  return mesh;
}

SnapStart all_free(const Mesh& mesh) {
  const VertexScalars ones = VertexScalars::Ones(mesh.points.rows());
  return {mesh, mesh.points, ones, ones};
}

/// A case whose template lies `points` in `image`.
Document document_on(const Volume& image, const Mesh& mesh) {
  MeshFile file;
  file.points = mesh.points;
  file.triangles = mesh.topology->triangles();
  Document document =
      new_document("", std::make_shared<const Volume>(image), make_template(std::move(file), "ball.ply").value());
  Shape& shape = test::changed_shape(document);
  shape.placement = {};
  shape.placed = shape.reference = shape.points = std::make_shared<const Points>(mesh.points);
  return document;
}

}  // namespace

TEST_CASE("a mesh near an edge snaps onto it") {
  const Blob blob;
  const Volume image = blob_image({blob});
  const Mesh truth = blob_mesh(blob.radii_mm);
  for (const double size : {0.85, 1.15}) {
    CAPTURE(size);
    const Mesh start{truth.topology, size * truth.points};
    const auto result = snap(image, 0, all_free(start), {}).value();
    const Mesh snapped{truth.topology, result.points};
    CHECK(mean_surface_distance_mm(snapped, truth) < 0.4);
    CHECK(result.mean_confidence > 0.8);
    CHECK_FALSE(result.doubtful);
    CHECK(turned_triangles(*truth.topology, start.points, result.points).empty());
    CHECK(self_intersections(snapped).empty());
  }
}

TEST_CASE("the side on which the organ is brighter is found and can be given") {
  Blob dark;
  std::swap(dark.inside, dark.outside);
  const Volume image = blob_image({dark});
  const Mesh truth = blob_mesh(dark.radii_mm);
  const Mesh start{truth.topology, 1.1 * truth.points};
  CHECK(EdgeSearch(image, 0, start, {}).polarity() == Polarity::dark_inside);
  CHECK(mean_surface_distance_mm({truth.topology, snap(image, 0, all_free(start), {}).value().points}, truth) < 0.4);
  SnapOptions wrong;
  wrong.edges.polarity = Polarity::bright_inside;
  const auto misled = snap(image, 0, all_free(start), wrong);
  CHECK((!misled || misled->doubtful));
}

TEST_CASE("strength 0 moves nothing and half of it goes half of the way") {
  const Blob blob;
  const Volume image = blob_image({blob});
  const Mesh truth = blob_mesh(blob.radii_mm);
  const Mesh start{truth.topology, 1.1 * truth.points};
  SnapOptions options;
  options.strength = 0;
  CHECK(snap(image, 0, all_free(start), options)->points == start.points);
  const double whole = snap(image, 0, all_free(start), {})->moved_mm;
  options.strength = 0.5;
  const double half = snap(image, 0, all_free(start), options)->moved_mm;
  CHECK(half > 0.25 * whole);
  CHECK(half < 0.75 * whole);
}

TEST_CASE("held landmarks do not move at all") {
  const Blob blob;
  const Volume image = blob_image({blob});
  const Mesh truth = blob_mesh(blob.radii_mm);
  SnapStart start = all_free({truth.topology, 1.1 * truth.points});
  for (Eigen::Index i = 0; i < start.free.size(); ++i) start.free[i] = truth.points(i, 2) > 0 ? 0 : 1;
  const auto result = snap(image, 0, start, {}).value();
  double moved = 0;
  for (Eigen::Index i = 0; i < start.free.size(); ++i) {
    if (start.free[i] > 0)
      moved = std::max(moved, (result.points.row(i) - start.mesh.points.row(i)).norm());
    else
      CHECK(result.points.row(i) == start.mesh.points.row(i));
  }
  CHECK(moved > 2);
}

TEST_CASE("confirmed landmarks stay when a case is snapped and replaying its lines gives the same mesh") {
  const Blob blob;
  const Volume image = blob_image({blob});
  const Mesh truth = blob_mesh(blob.radii_mm);
  EditSession session(document_on(image, {truth.topology, 1.1 * truth.points}));
  REQUIRE(session.apply(Confirm{Vec3(0, 0, 38), 15, true}));
  const Document before = session.document();
  auto edit = snap_shape(before.scan, *before.view(), std::nullopt, {}).value();
  const std::string line = action_line({edit.action});
  REQUIRE(session.apply(edit.action));
  const Points& after = *session.document().view()->shape.points;
  CHECK(after == edit.result.points);
  const VertexScalars& confirmed = *before.view()->shape.confirmed;
  REQUIRE(confirmed.sum() > 5);
  for (Eigen::Index i = 0; i < after.rows(); ++i)
    if (confirmed[i] >= 1) CHECK(after.row(i) == before.view()->shape.points->row(i));

  // The line holds the points: neither image nor search is needed for it.
  Document without_image = before;
  without_image.scan.image = nullptr;
  EditSession replayed(without_image);
  REQUIRE(replayed.apply(parse_action(line).value().action));
  CHECK(*replayed.document().view()->shape.points == after);
  CHECK(session.undo_name() == "snap");
  REQUIRE(session.apply(Undo{}));
  CHECK(*session.document().view()->shape.points == *before.view()->shape.points);
}

TEST_CASE("a snap of a region leaves the rest where it was") {
  const Blob blob;
  const Mesh truth = blob_mesh(blob.radii_mm);
  const Document document = document_on(blob_image({blob}), {truth.topology, 1.1 * truth.points});
  const auto edit = snap_shape(document.scan, *document.view(), SnapArea{Vec3(0, 0, 38), 8}, {}).value();
  const Points& before = *document.view()->shape.points;
  for (Eigen::Index i = 0; i < before.rows(); ++i)
    if (before(i, 2) < 0) CHECK(edit.result.points.row(i) == before.row(i));
  Eigen::Index top = 0;
  before.col(2).maxCoeff(&top);
  CHECK(edit.result.points(top, 2) == doctest::Approx(35).epsilon(0.04));
}

TEST_CASE("an image without the organ is refused or doubted") {
  const Mesh ball = blob_mesh(Vec3(30, 25, 35));
  Blob grain_only;
  grain_only.inside = grain_only.outside = 50;
  grain_only.noise = 20;
  const auto in_grain = snap(blob_image({grain_only}), 0, all_free(ball), {});
  REQUIRE(in_grain);
  CHECK(in_grain->doubtful);
  CHECK((in_grain->points - ball.points).rowwise().norm().maxCoeff() < 12);
  Blob nothing = grain_only;
  nothing.noise = 0;
  CHECK_FALSE(snap(blob_image({nothing}), 0, all_free(ball), {}));
  Mesh elsewhere = ball;
  elsewhere.points.rowwise() += Eigen::RowVector3d(500, 0, 0);
  CHECK_FALSE(snap(blob_image({Blob{}}), 0, all_free(elsewhere), {}));
}

TEST_CASE("a snap is doubtful where most of the boundary does not show and sound where a little of it does not") {
  const auto hidden_below = [](double z_mm) {
    Volume image = blob_image({Blob{}});
    auto& voxels = std::get<std::vector<float>>(image.data);
    const auto [columns, rows, slices] = image.geometry.dims;
    for (std::size_t v = 0; v < voxels.size(); ++v)
      if (image.geometry.to_mm(Vec3(0, 0, static_cast<double>(v / static_cast<std::size_t>(columns * rows)))).z() <
          z_mm)
        voxels[v] = static_cast<float>(50 + 3 * blob_grain(v));
    return snap(image, 0, all_free(blob_mesh(Blob{}.radii_mm)), {}).value();
  };
  CHECK(hidden_below(12).doubtful);  // two thirds
  CHECK_FALSE(hidden_below(-20).doubtful);
}

TEST_CASE("what the scan cuts off follows the rest and is named") {
  const Blob blob;
  Volume image = blob_image({blob});
  image.geometry.dims[2] = 40;  // up to z = 19 mm; the organ reaches to 35
  std::get<std::vector<float>>(image.data).resize(image.geometry.voxels());
  const Mesh truth = blob_mesh(blob.radii_mm);
  const auto result = snap(image, 0, all_free({truth.topology, 1.1 * truth.points}), {}).value();
  CHECK(mean_surface_distance_mm({truth.topology, result.points}, truth) < 1);
  CHECK_FALSE(result.doubtful);  // what the scan shows is clear
  CHECK(result.mean_confidence > 0.7);
  REQUIRE_FALSE(result.unseen.empty());
  for (const std::int32_t i : result.unseen) {
    CHECK(result.points(i, 2) > 19);
    CHECK(result.confidence[i] == 0);
  }
}

TEST_CASE("a boundary that was learned is found again where its contrast alone misleads") {
  // A brighter shell lies around the organ: the strongest edge is not the organ's.
  Blob organ, shell;
  shell.radii_mm = organ.radii_mm + Vec3::Constant(6);
  const auto shelled = [&](double size) {
    Blob a = organ, b = shell;
    a.radii_mm *= size;
    b.radii_mm *= size;
    a.inside = 40;
    a.noise = 0;
    b.inside = 160;
    Volume image = blob_image({b}), inner = blob_image({a});
    auto& voxels = std::get<std::vector<float>>(image.data);
    const auto& darker = std::get<std::vector<float>>(inner.data);
    for (std::size_t v = 0; v < voxels.size(); ++v) voxels[v] -= darker[v];
    return image;
  };
  const Mesh truth = blob_mesh(organ.radii_mm);
  auto appearance = std::make_shared<Appearance>();
  REQUIRE(appearance->learn(shelled(1), 0, truth));
  SnapOptions options;
  options.edges.appearance = appearance;
  const Mesh larger{truth.topology, 1.08 * truth.points};
  const auto result = snap(shelled(1.08), 0, all_free({truth.topology, 1.02 * truth.points}), options).value();
  CHECK(mean_surface_distance_mm({truth.topology, result.points}, larger) < 0.5);
  CHECK_FALSE(appearance->learn(shelled(1), 0, icosphere(2, 30)));
}

TEST_CASE("a mesh goes through a cine and a corrupt frame is marked") {
  std::vector<Blob> blobs(8);
  std::vector<double> sizes;
  for (std::size_t f = 0; f < blobs.size(); ++f) {
    sizes.push_back(0.85 + 0.15 * std::cos(2 * 3.14159265 * static_cast<double>(f) / 8));
    blobs[f].radii_mm *= sizes.back();
  }
  Volume cine = blob_image(blobs, 2.5, 40);
  const Mesh first = blob_mesh(Blob{}.radii_mm);
  const VertexScalars ones = VertexScalars::Ones(first.points.rows());
  const auto whole = propagate(cine, 0, first, ones).value();
  REQUIRE(whole.frames.size() == 8);
  CHECK(whole.cycle);
  CHECK(whole.ejection.end_diastole == 0);
  CHECK(whole.ejection.end_systole == 4);
  CHECK(whole.ejection.fraction == doctest::Approx(1 - std::pow(0.7, 3)).epsilon(0.05));
  CHECK(whole.frames[0].points == first.points);
  for (std::size_t f = 0; f < 8; ++f) {
    CAPTURE(f);
    CHECK(whole.frames[f].doubt.empty());
    CHECK(mean_surface_distance_mm({first.topology, whole.frames[f].points}, blob_mesh(blobs[f].radii_mm)) < 0.6);
  }

  auto& voxels = std::get<std::vector<float>>(cine.data);
  const std::size_t count = cine.geometry.voxels();
  for (std::size_t v = 3 * count; v < 4 * count; ++v) voxels[v] = static_cast<float>(100 * blob_grain(v));
  const auto torn = propagate(cine, 0, first, ones).value();
  CHECK_FALSE(torn.frames[3].doubt.empty());
  CHECK(mean_surface_distance_mm({first.topology, torn.frames[3].points}, blob_mesh(blobs[3].radii_mm)) < 2);
  for (const std::size_t f : {2u, 4u, 5u})
    CHECK(mean_surface_distance_mm({first.topology, torn.frames[f].points}, blob_mesh(blobs[f].radii_mm)) < 0.8);
  CHECK(torn.ejection.end_systole == 4);

  CHECK_FALSE(propagate(blob_image({Blob{}}, 4, 20), 0, first, ones));
  CHECK_FALSE(propagate(cine, 8, first, ones));
}

TEST_CASE("a beat whose end the scanner left out is a cycle and half a beat is none") {
  const auto beat = [](double frames_a_beat) {
    std::vector<Blob> blobs(10);
    for (std::size_t f = 0; f < blobs.size(); ++f)
      blobs[f].radii_mm *= 0.85 + 0.15 * std::cos(2 * 3.14159265 * static_cast<double>(f) / frames_a_beat);
    return blob_image(blobs, 2.5, 40);
  };
  const Mesh first = blob_mesh(Blob{}.radii_mm);
  const VertexScalars ones = VertexScalars::Ones(first.points.rows());
  CHECK(propagate(beat(11.2), 0, first, ones)->cycle);
  CHECK_FALSE(propagate(beat(20), 0, first, ones)->cycle);
}

TEST_CASE("a beat whose volumes close up is a cycle though the image at its end is another") {
  // Contrast medium comes in: the last frame is as large as the first, and twice as bright inside.
  std::vector<Blob> blobs(10);
  for (std::size_t f = 0; f < blobs.size(); ++f) {
    blobs[f].radii_mm *= 0.85 + 0.15 * std::cos(2 * 3.14159265 * static_cast<double>(f) / 9);
    blobs[f].inside *= 1 + static_cast<double>(f) / 9;
  }
  const Mesh first = blob_mesh(Blob{}.radii_mm);
  const auto found = propagate(blob_image(blobs, 2.5, 40), 0, first, VertexScalars::Ones(first.points.rows())).value();
  CHECK(found.cycle);
  CHECK(found.frames[9].volume_ml == doctest::Approx(found.frames[0].volume_ml).epsilon(0.05));
  CHECK(found.frames[5].disagreement_mm.has_value());
}

TEST_CASE("five gestures lay the built-in kidney on one in a CT of 3 mm voxels") {
  const auto folder = real_data();
  if (folder.empty()) return;
  const auto image =
      std::make_shared<const Volume>(read_volume(folder / "ct/totalseg_example_ct_3mm.nii.gz").value().volume);
  const Volume labels = read_volume(folder / "ct/totalseg_example_ct_3mm_label.nii.gz").value().volume;
  constexpr int kidney_right = 1;
  const auto the_template = load_template("built-in:kidney").value();
  const Mesh target = label_boundary(labels, kidney_right, 0, 0, the_template->points.rows()).value().surface;
  EditSession session(new_document("ct", image, the_template));
  REQUIRE(place_on(session, target));
  const auto snap_within = [&](double reach_mm) {
    SnapOptions options;
    options.edges.reach_mm = reach_mm;
    REQUIRE(session.apply(
        snap_shape(session.document().scan, *session.document().view(), std::nullopt, options).value().action));
  };
  snap_within(15);
  REQUIRE(pull_to_target(session, target, {.visible_mm = 1, .most_pulls = 3}));
  snap_within(10);
  // The second snap holds the pulls, which are not exact.
  CHECK(compare_with_mask(session.document().view()->mesh(), labels, kidney_right)->assd_mm < 1.45);
}

TEST_CASE("pulls and snaps and a refinement and a propagation of one template make one elimination plan") {
  const Mesh mesh = blob_mesh(0.95 * Blob{}.radii_mm);
  const Volume image = blob_image({Blob{}, Blob{}}, 3, 40);
  const int before = EliminationPlan::made();
  EditSession session(document_on(image, mesh));
  Stroke pull;
  pull.at = Vec3(0, 0, 0.95 * Blob{}.radii_mm.z());
  pull.to = pull.at + Vec3(0, 0, 2);
  REQUIRE(session.preview(pull));
  REQUIRE(session.apply(pull));
  const auto snapped = snap_shape(session.document().scan, *session.document().view(), SnapArea{pull.to, 10}, {});
  REQUIRE(snapped);
  REQUIRE(session.apply(snapped->action));
  REQUIRE(snap_shape(session.document().scan, *session.document().view(), std::nullopt, {}));
  REQUIRE(refine_shape(*session.document().view()));
  REQUIRE(propagate(image, 0, session.document().view()->mesh(), VertexScalars::Ones(mesh.points.rows()), {}));
  CHECK(EliminationPlan::made() == before + 1);
}
