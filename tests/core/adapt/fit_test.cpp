#include <doctest/doctest.h>

#include <numbers>

#include "core/adapt/judge_fit.h"
#include "core/catalogue/catalogue.h"
#include "core/deform/fold_guard.h"
#include "core/measure/compare.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/label_map.h"
#include "core/phantom/phantom.h"
#include "core/template_making/mesh_template.h"
#include "core/volume/volume_io.h"
#include "tests/adapting.h"
#include "tests/ball.h"
#include "tests/real_data.h"
#include "tests/refusal.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// How far the fit moves, at its farthest vertex, when the label map moves by 1e-9 mm.
double moved_by_a_last_bit(const Template& the_template, Volume mask, double closing_mm) {
  const auto fitted = [&] {
    const Boundary boundary = label_boundary(mask, 1, 0, closing_mm, the_template.points.rows()).value();
    return fit_to_boundary(the_template, boundary).value().mesh.points;
  };
  const Points before = fitted();
  mask.geometry.origin_mm += Vec3(1e-9, -1e-9, 1e-9);
  return (fitted() - before).rowwise().norm().maxCoeff();
}

const Similarity elsewhere{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vec3(1, 2, -1).normalized())), 1.2,
                           Vec3(40, -120, 300)};

}  // namespace

TEST_CASE("a template with faults is named as the cause and the organ is not") {
  const Mesh spindle = shapes::torus(24, 16, 5, 8), ball = icosphere(3, 20);
  FitResult fit;
  fit.mesh = spindle;
  fit.self_intersections = 1;
  const auto faulty = make_template({spindle.points, spindle.topology->triangles()}, "spindle").value();
  const auto judged = judge_fit(*faulty, mesh_boundary(ball), {}, fit);
  CHECK(judged.doubtful);
  REQUIRE(judged.warnings.size() == 1);
  CHECK(judged.warnings[0].find("the template itself has") == 0);
  const auto sound = ball_template(20);
  const auto blamed = judge_fit(*sound, mesh_boundary(ball), {}, fit);
  REQUIRE(blamed.warnings.size() == 1);
  CHECK(blamed.warnings[0].find("another organ") != std::string::npos);
}

TEST_CASE("landmarks that are not used are said") {
  const auto the_template = built_in(Organ::kidney);
  const MeshFile truth = phantom_truth(Organ::kidney, 4).front();
  const Boundary boundary = boundary_of({the_template->topology, truth.points}, 2.5);
  FitOptions two;
  two.landmarks = landmarks_of(truth, {"hilum", "superior pole"});
  const FitResult pulled = fit_to_boundary(*the_template, boundary, two).value();
  CHECK(pulled.landmarks_used == 2);
  CHECK_FALSE(pulled.landmarks_place);
  REQUIRE(pulled.warnings.size() == 1);
  CHECK(pulled.warnings[0].find("did not help to place it") != std::string::npos);
  const FitResult free = fit_to_boundary(*the_template, boundary, {}).value();
  for (std::size_t k = 0; k < pulled.landmarks.size(); ++k) {
    const auto there = two.landmarks.find(pulled.landmarks[k].name);
    if (there == two.landmarks.end()) continue;
    const double with_mm = (pulled.landmarks[k].position - there->second).norm(),
                 without_mm = (free.landmarks[k].position - there->second).norm();
    CAPTURE(there->first);
    CHECK(with_mm < 0.95 * without_mm);
  }
  FitOptions at_one_place;
  for (const char* name : {"hilum", "superior pole", "inferior pole"})
    at_one_place.landmarks[name] = landmarks_of(truth, {"hilum"}).at("hilum");
  const FitResult confused = fit_to_boundary(*the_template, boundary, at_one_place).value();
  CHECK(confused.landmarks_used < 3);
  CHECK_FALSE(confused.landmarks_place);
  FitOptions blunder;
  blunder.landmarks = landmarks_of(truth, {"hilum", "superior pole", "inferior pole", "lateral convexity"});
  blunder.landmarks.at("hilum").y() -= 45;
  const FitResult aside = fit_to_boundary(*the_template, boundary, blunder).value();
  check_sound(aside);
  CHECK(aside.landmarks_used == 3);
  CHECK(aside.landmarks_place);
  REQUIRE(aside.warnings.size() == 1);
  CHECK(aside.warnings[0].find("\"hilum\" lies") != std::string::npos);
  CHECK(mean_distance(aside.mesh.points, truth.points) < 2);
}

TEST_CASE("a template fitted to its own label map hardly moves") {
  for (const Organ organ : {Organ::kidney, Organ::vertebra}) {
    const auto the_template = built_in(organ);
    const auto fit =
        fit_to_boundary(*the_template, boundary_of({the_template->topology, the_template->points})).value();
    check_sound(fit);
    // Where along a round organ a vertex belongs is told by its whole shape, and so by the label map's steps, too.
    CHECK(mean_distance(fit.mesh.points, the_template->points) < (organ == Organ::kidney ? 0.6 : 0.4));
    CHECK(fit.unseen.empty());
    REQUIRE(fit.landmarks.size() == the_template->landmarks.size());
    for (std::size_t k = 0; k < fit.landmarks.size(); ++k) {
      CHECK(fit.landmarks[k].name == the_template->landmarks[k].name);
      CHECK((fit.landmarks[k].position - the_template->landmarks[k].position).norm() < 2);
    }
  }
}

TEST_CASE("a pocket that the template has and the case has not is opened") {
  const Mesh ball = icosphere(3, 20);
  MeshFile pocketed{ball.points, ball.topology->triangles()};
  for (Eigen::Index i = 0; i < ball.points.rows(); ++i) {
    const double angle = std::acos(std::clamp(ball.points(i, 2) / 20, -1.0, 1.0));
    pocketed.points.row(i) *= 1 - 0.7 * std::exp(-std::pow(angle / 0.4, 4));
  }
  const auto the_template = make_template(pocketed, "pocketed").value();
  const Boundary boundary = boundary_of(ball);
  const auto fit = fit_to_boundary(*the_template, boundary).value();
  check_sound(fit);
  const Agreement agreement = compare_meshes(fit.mesh, boundary.surface);
  CHECK(agreement.assd_mm < 0.15);
  CHECK(agreement.hausdorff_mm < 2);
}

TEST_CASE(
    "of a round organ that differs smoothly the shape tells where vertices belong, and each landmark tells more") {
  const auto the_template = built_in(Organ::kidney);
  const auto off_mm = [&](std::size_t shown) {
    double sum_mm = 0;
    for (const int subject : {1, 5, 7, 13}) {
      const MeshFile truth = phantom_truth(Organ::kidney, subject).front();
      FitOptions options;
      for (std::size_t k = 0; k < shown; ++k) options.landmarks[truth.landmarks[k].name] = truth.landmarks[k].position;
      const auto fit = fit_to_boundary(*the_template, boundary_of({the_template->topology, truth.points}), options);
      check_sound(fit.value());
      sum_mm += mean_distance(fit->mesh.points, truth.points);
    }
    return sum_mm / 4;
  };
  CHECK(off_mm(0) < 1.7);   // by the plain fit alone more than 2.3
  CHECK(off_mm(2) < 1.35);  // nearly 3 where they only pull
  CHECK(off_mm(4) < 1.2);
}

TEST_CASE("named landmarks bring the vertices between them to their places too") {
  const auto the_template = built_in(Organ::kidney);
  double alone_mm = 0, helped_mm = 0;
  for (const int subject : {1, 2, 3}) {
    const MeshFile truth = phantom_truth(Organ::kidney, subject).front();
    const Boundary boundary = boundary_of({the_template->topology, truth.points});
    FitOptions options;
    alone_mm += mean_distance(fit_to_boundary(*the_template, boundary, options).value().mesh.points, truth.points) / 3;
    for (const Landmark& landmark : truth.landmarks) options.landmarks[landmark.name] = landmark.position;
    const FitResult helped = fit_to_boundary(*the_template, boundary, options).value();
    check_sound(helped);
    helped_mm += mean_distance(helped.mesh.points, truth.points) / 3;
  }
  CHECK(helped_mm < 1.1);
  CHECK(helped_mm < 0.6 * alone_mm);
}

TEST_CASE("a turned and larger organ is found where it lies") {
  for (const Organ organ : {Organ::kidney, Organ::vertebra}) {
    const auto the_template = built_in(organ);
    const Mesh there{the_template->topology, elsewhere.apply(the_template->points)};
    const auto fit = fit_to_boundary(*the_template, boundary_of(there)).value();
    check_sound(fit);
    CHECK(fit.placement.rotation.angularDistance(elsewhere.rotation) < 3 * std::numbers::pi / 180);
    CHECK(fit.placement.scale == doctest::Approx(1.2).epsilon(0.02));
    CHECK(mean_distance(fit.mesh.points, there.points) < 1);
  }
}

TEST_CASE("a fit meets the label map and comes nearer to the true landmarks than placing alone") {
  for (const Organ organ : {Organ::kidney, Organ::vertebra}) {
    const auto the_template = built_in(organ);
    for (const int number : {1, 3}) {
      CAPTURE(number);
      const Mesh truth{the_template->topology, phantom_truth(organ, number).front().points};
      const Boundary boundary = boundary_of(truth);
      const auto fit = fit_to_boundary(*the_template, boundary).value();
      check_sound(fit);
      const Agreement agreement = compare_meshes(fit.mesh, truth);
      CHECK(agreement.assd_mm < 0.3);
      CHECK(agreement.hd95_mm < 1);
      CHECK(agreement.dice > 0.97);
      const Similarity placed = find_placement(*the_template, boundary).placement;
      CHECK(mean_distance(fit.mesh.points, truth.points) <
            mean_distance(placed.apply(the_template->points), truth.points));
    }
  }
}

TEST_CASE("an organ cut off by the scan keeps the template's shape beyond") {
  const auto the_template = built_in(Organ::kidney);
  VolumeGeometry grid = grid_around(the_template->points, 1.25);
  const int missing = grid.dims[2] / 4;
  grid.origin_mm.z() += missing * 1.25;
  grid.dims[2] -= missing;
  const double edge_mm = grid.origin_mm.z() - 0.625;
  const Mesh whole{the_template->topology, the_template->points};
  const Boundary boundary = label_boundary(label_map(whole, grid), 1, 0, 0, whole.points.rows()).value();
  REQUIRE(boundary.scan_borders.size() == 1);
  CHECK(boundary.scan_borders[0].outward == -Vec3::UnitZ());
  CHECK(boundary.scan_borders[0].offset_mm == doctest::Approx(-edge_mm));
  CHECK(boundary.warnings.size() == 1);
  Volume ends = label_map(whole, grid);  // with the organ itself, as where empty slices were left out
  ends.empty_beyond_slices = true;
  const Boundary there = label_boundary(ends, 1, 0, 0, whole.points.rows()).value();
  CHECK(there.scan_borders.empty());
  CHECK(there.warnings.empty());
  const auto fit = fit_to_boundary(*the_template, boundary).value();
  check_sound(fit);
  REQUIRE(!fit.unseen.empty());
  const double least_mm = fit.doubt_mm.minCoeff();  // of what is seen, which is all in the same doubt
  for (const std::int32_t i : fit.unseen) {
    CHECK((fit.mesh.points.row(i) - whole.points.row(i)).norm() < 4);
    CHECK(fit.doubt_mm[i] > least_mm);
  }
  // What the scan cuts off counts against the whole, and not against what is seen.
  const FitJudgement judged = judge_fit(*the_template, boundary, {}, fit);
  CHECK(judged.agreement.dice < judged.inside_scan.dice - 0.02);
  CHECK(judged.inside_scan.dice > 0.96);
  CHECK(judged.inside_scan.assd_mm < 0.5);
  CHECK(judged.inside_scan.assd_mm < 0.3 * judged.agreement.assd_mm);
  CHECK(judged.beyond_share > 0.15);
  CHECK(judged.beyond_share < 0.35);
  CHECK(!judged.doubtful);
}

TEST_CASE("a fit of which too little lies in the scan is doubtful and says so") {
  const auto the_template = built_in(Organ::kidney);
  VolumeGeometry grid = grid_around(the_template->points, 1.25);
  const int missing = grid.dims[2] * 3 / 4;
  grid.origin_mm.z() += missing * 1.25;
  grid.dims[2] -= missing;
  const Mesh whole{the_template->topology, the_template->points};
  const Boundary boundary = label_boundary(label_map(whole, grid), 1, 0, 0, whole.points.rows()).value();
  FitResult fit;
  fit.mesh = whole;  // as if it were placed rightly
  const FitJudgement judged = judge_fit(*the_template, boundary, {}, fit);
  CHECK(judged.inside_scan.dice > 0.95);
  CHECK(judged.beyond_share > 0.6);
  CHECK(judged.doubtful);
  CHECK(std::any_of(judged.warnings.begin(), judged.warnings.end(), [](const std::string& warning) {
    return warning.find("too little to tell where it belongs") != std::string::npos;
  }));
}

TEST_CASE("the template of another organ gives no wild mesh") {
  const auto the_template = built_in(Organ::vertebra);
  const Mesh kidney{built_in(Organ::kidney)->topology, built_in(Organ::kidney)->points};
  const auto fit = fit_to_boundary(*the_template, boundary_of(kidney, 2)).value();
  REQUIRE(fit.mesh.points.allFinite());
  Box near = bounds_of(kidney.points);
  near.extend(Vec3(near.min() - Vec3::Constant(20))).extend(Vec3(near.max() + Vec3::Constant(20)));
  CHECK(near.contains(bounds_of(fit.mesh.points)));
  CHECK((fit.turned_triangles + fit.self_intersections == 0 || !fit.warnings.empty()));
}

TEST_CASE("a fit that overlaps well but leaves a part out says so and not that the organ is another") {
  const auto the_template = built_in(Organ::kidney);
  const Mesh own{the_template->topology, the_template->points};
  // A thin horn that the fit did not follow.
  Mesh horned = own;
  for (Eigen::Index i = 0; i < horned.points.rows(); ++i)
    if (const double z = horned.points(i, 2) - 0.6 * own.points.col(2).maxCoeff(); z > 0)
      horned.points(i, 2) += 1.5 * z;
  const Boundary boundary = boundary_of(horned, 1);
  FitResult fit = fit_to_boundary(*the_template, boundary_of(own, 2)).value();
  fit.mesh = own;
  const FitJudgement judgement = judge_fit(*the_template, boundary, {}, fit);
  REQUIRE(judgement.agreement.dice >= 0.9);
  REQUIRE(judgement.doubtful);
  REQUIRE(!judgement.warnings.empty());
  CHECK(judgement.warnings.back().find("parts of the label are not followed: 5 %") == 0);
  CHECK(judgement.warnings.back().find("another organ") == std::string::npos);
}

TEST_CASE("a label that does not occur and a placement elsewhere are refused") {
  const auto the_template = built_in(Organ::kidney);
  const Mesh there{the_template->topology, the_template->points};
  const Volume mask = label_map(there, grid_around(there.points, 3));
  const auto absent = label_boundary(mask, 2, 0, 0, 2500);
  REQUIRE(!absent);
  CHECK(absent.error().what.find("label 2") != std::string::npos);
  FitOptions options;
  options.placement = Similarity{Eigen::Quaterniond::Identity(), 1, Vec3(1000, 0, 0)};
  CHECK(says(fit_to_boundary(*the_template, boundary_of(there, 3), options), "puts the template beside the organ"));
}

TEST_CASE("a phantom that moves by a billionth of a millimetre moves its fit as little") {
  const auto the_template = built_in(Organ::vertebra);
  for (const int subject : {3, 5}) {
    CAPTURE(subject);
    const Points truth = phantom_truth(Organ::vertebra, subject).front().points;
    const Volume mask = label_map({the_template->topology, truth}, grid_around(truth, 2.5));
    CHECK(moved_by_a_last_bit(*the_template, mask, 0) < 1e-3);
  }
}

TEST_CASE("a real kidney that moves by a billionth of a millimetre moves its fit as little") {
  const auto data = real_data();
  if (data.empty()) return;
  const auto the_template = built_in(Organ::kidney);
  for (const std::string name : {"case_00036_right_healthy_thick", "case_00078_right_healthy_thin"}) {
    CAPTURE(name);
    const Volume mask = read_volume(data / "kidney_masks" / (name + ".nii.gz")).value().volume;
    CHECK(moved_by_a_last_bit(*the_template, mask, 3) < 1e-3);
  }
}

TEST_CASE("the fit of a scaled copy is the scaled fit") {
  const MeshFile own = phantom_truth(Organ::kidney, 3).front(), other = phantom_truth(Organ::kidney, 5).front();
  MeshTemplateOptions few;
  few.vertices = 300;
  MeshFile file;
  const Mesh mesh = make_mesh_template(own, few).value().mesh;
  file.points = mesh.points;
  file.triangles = mesh.topology->triangles();
  file.landmarks = own.landmarks;
  std::map<std::string, Vec3> places;
  for (const Landmark& landmark : other.landmarks) places[landmark.name] = landmark.position;
  const auto fitted = [&](double template_scale, double scale, bool landmarks) {
    MeshFile scaled = file;
    scaled.points *= template_scale;
    for (Landmark& landmark : scaled.landmarks) landmark.position *= template_scale;
    const auto the_template = make_template(scaled, "scaled").value();
    const Boundary boundary =
        mesh_boundary({Topology::make(other.points.rows(), other.triangles).value(), scale * other.points});
    FitOptions options;
    for (const auto& [name, place] : places)
      if (landmarks) options.landmarks[name] = scale * place;
    const FitResult fit = fit_to_boundary(*the_template, boundary, options).value();
    CHECK_FALSE(judge_fit(*the_template, boundary, options, fit).doubtful);
    return Points(fit.mesh.points / scale);
  };
  const double size_mm = bounds_of(other.points).diagonal().norm();
  for (const bool landmarks : {true, false}) {
    const Points usual = fitted(1, 1, landmarks);
    CHECK(largest_difference(fitted(20, 20, landmarks), usual) < 1e-6 * size_mm);
    CHECK(largest_difference(fitted(1, 1.0 / 16, landmarks), usual) < 1e-6 * size_mm);
    if (!landmarks) continue;
    CHECK(largest_difference(fitted(0.05, 0.05, landmarks), usual) < 1e-6 * size_mm);
    CHECK(largest_difference(fitted(1, 20, landmarks), usual) < 1e-6 * size_mm);
  }
}

TEST_CASE("a surface or a template that is flat or has no size is named as the cause") {
  const Mesh ball = icosphere(2, 20);
  const auto sound = make_template({ball.points, ball.topology->triangles()}, "ball").value();
  for (const double scale : {0.0, 1e200}) {
    Mesh point = ball;
    point.points *= scale;
    const auto none = make_template({point.points, point.topology->triangles()}, "point").value();
    CHECK(says(fit_to_boundary(*sound, mesh_boundary(point)), "is flat or has no size"));
    CHECK(says(fit_to_boundary(*none, mesh_boundary(ball)), "is flat or has no size"));
  }
  const Mesh triangle = shapes::make_mesh({{0, 0, 0}, {10, 0, 0}, {0, 10, 0}}, {{0, 1, 2}});
  CHECK(says(fit_to_boundary(*sound, mesh_boundary(triangle)), "is flat or has no size"));
}

TEST_CASE("a fit that is cancelled says so") {
  const auto the_template = built_in(Organ::kidney);
  Progress progress;
  progress.cancel();
  FitOptions options;
  options.progress = &progress;
  const auto fit =
      fit_to_boundary(*the_template, boundary_of({the_template->topology, the_template->points}, 3), options);
  REQUIRE(!fit);
  CHECK(fit.error().what == "the fit was cancelled");
}

TEST_CASE("an organ with features is matched as a whole and its vertices come near their true places") {
  const auto the_template = built_in(Organ::vertebra);
  double sum_mm = 0;
  for (const int subject : {1, 2, 3, 4}) {
    const Mesh truth{the_template->topology, phantom_truth(Organ::vertebra, subject).front().points};
    sum_mm += mean_distance(fit_to_boundary(*the_template, boundary_of(truth)).value().mesh.points, truth.points);
  }
  CHECK(sum_mm / 4 < 0.65);  // by the plain fit alone more than 0.8
}

TEST_CASE("a fit doubts a template of another organ more than one of its own kind") {
  const auto the_template = built_in(Organ::vertebra);
  const Mesh own{the_template->topology, phantom_truth(Organ::vertebra, 3).front().points};
  const Mesh other{built_in(Organ::kidney)->topology, built_in(Organ::kidney)->points};
  const auto judged = [&](const Mesh& there) {
    const Boundary boundary = mesh_boundary(there);
    const auto fit = fit_to_boundary(*the_template, boundary).value();
    CHECK(fit.doubt_mm.size() == the_template->points.rows());
    CHECK(fit.doubt_mm.minCoeff() > 0);
    return judge_fit(*the_template, boundary, {}, fit);
  };
  const FitJudgement of_own = judged(own), of_other = judged(other);
  CHECK_FALSE(of_own.doubtful);
  CHECK(of_own.doubt_share < 0.04);
  CHECK(of_other.doubtful);
  CHECK(of_other.doubt_share > 1.5 * of_own.doubt_share);
}

TEST_CASE("of the vertices of phantoms most lie within the doubt of their fits") {
  const auto the_template = built_in(Organ::kidney);
  for (const int subject : {1, 4}) {
    CAPTURE(subject);
    const Mesh truth{the_template->topology, phantom_truth(Organ::kidney, subject).front().points};
    const auto fit = fit_to_boundary(*the_template, mesh_boundary(truth)).value();
    const auto within = (fit.mesh.points - truth.points).rowwise().norm().array() <= 1.44 * fit.doubt_mm.array();
    INFO("within: " << within.count() << " of " << within.size());
    CHECK(static_cast<double>(within.count()) > 0.75 * static_cast<double>(within.size()));
  }
}
