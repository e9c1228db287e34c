#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/groupwise/template_bias.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_quality.h"
#include "tests/must.h"
#include "tests/shapes.h"
#include "tests/thread_limit.h"

using namespace homolog;

namespace {

/// An organ with two bumps, not in correspondence with the others: each lies on a sphere of its own vertices.
Boundary bias_organ(int subject) {
  Mesh mesh = icosphere(3, 40);
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    const Eigen::AngleAxisd turn(0.3 * subject, Vec3(1, 2, 3).normalized());
    const Vec3 u = turn * Vec3(mesh.points.row(i)).normalized();
    const double bumps = 9 * std::exp(-12 * (u - Vec3(0.6, 0.8, 0)).squaredNorm()) +
                         7 * std::exp(-12 * (u - Vec3(-0.6, 0, 0.8)).squaredNorm());
    Vec3 p = (40 + bumps) * u;
    p.x() *= 1.4 + 0.08 * std::sin(subject);
    p.y() *= 1 + 0.08 * std::cos(2.0 * subject);
    mesh.points.row(i) = p.transpose();
  }
  return mesh_boundary(mesh);
}

std::vector<Boundary> organs(int count) {
  std::vector<Boundary> all;
  for (int k = 0; k < count; ++k) all.push_back(bias_organ(k));
  return all;
}

}  // namespace

TEST_CASE("a consensus template does not depend on the order of its subjects and hardly on the start") {
  const std::vector<Boundary> subjects = organs(4);
  std::vector<Boundary> reversed = subjects;
  std::reverse(reversed.begin(), reversed.end());
  ConsensusOptions options;
  options.vertices = 400;
  const Consensus first = test::must(consensus_template(subjects, options));
  CHECK(first.rounds >= 1);
  CHECK(first.left_out.empty());
  CHECK(first.mesh.points.rows() == 400);
  CHECK(first.mesh.points.colwise().mean().norm() < 1);
  const Consensus other_order = test::must(consensus_template(reversed, options));
  CHECK(first.mesh.points == other_order.mesh.points);
  CHECK(first.mesh.topology->triangles() == other_order.mesh.topology->triangles());
  {
    const ThreadLimit limit(1);
    CHECK(test::must(consensus_template(subjects, options)).mesh.points == first.mesh.points);
  }
  options.start = 0;
  const Consensus from_first = test::must(consensus_template(subjects, options));
  options.start = 2;
  const Consensus from_last = test::must(consensus_template(subjects, options));
  const double apart_mm = mean_surface_distance_mm(from_first.mesh, from_last.mesh);
  const double edge_mm = mean_edge_mm(*first.mesh.topology, first.mesh.points);
  MESSAGE("two starts give templates " << apart_mm << " mm apart, whose mean edge is " << edge_mm << " mm");
  CHECK(apart_mm < 0.05 * edge_mm);
  CHECK(mean_surface_distance_mm(subjects[0].surface, subjects[2].surface) > 5 * apart_mm);
}

TEST_CASE("template bias is small where templates agree and the same for any number of threads") {
  std::vector<BiasSubject> subjects;
  for (int k = 0; k < 3; ++k) {
    subjects.push_back({"s" + std::to_string(k), bias_organ(k), {}});
    const Points& points = subjects.back().boundary.surface.points;
    subjects.back().landmarks = {{"left", points.row(5).transpose()}, {"right", points.row(60).transpose()}};
  }
  const TemplateBias bias = test::must(template_bias(subjects, {.vertices = 300}));
  CHECK(bias.failed.empty());
  CHECK(bias.spread_mm > 0);
  CHECK(bias.spread_mm < 3);
  CHECK(bias.spread_max_mm >= bias.spread_p95_mm);
  CHECK(bias.spread_of_mm.size() == 2);
  REQUIRE(bias.apart_mm_of.size() == 3);
  for (const auto& [name, apart_mm] : bias.apart_mm_of) CHECK(bias.apart_mm_of.at(bias.best_start) <= apart_mm);
  CHECK(bias.rv > 0.9);
  CHECK(bias.rv_least <= bias.rv);
  const ThreadLimit limit(1);
  const TemplateBias again = test::must(template_bias(subjects, {.vertices = 300}));
  CHECK(again.spread_mm == bias.spread_mm);
  CHECK(again.rv == bias.rv);
}

TEST_CASE("the modified RV coefficient is 1 for one morphospace and 0 for none in common") {
  Eigen::MatrixXd a(3, 3), b(3, 3);
  a << 9, 1, -2, 1, 7, 3, -2, 3, 5;
  b << 0, 3, 0, 3, 8, -1, 0, -1, 4;
  CHECK(modified_rv(a, a) == doctest::Approx(1));
  CHECK(modified_rv(a, 4 * a) == doctest::Approx(1));
  CHECK(modified_rv(a, b) == doctest::Approx(0));
  CHECK(modified_rv(a, -a) == doctest::Approx(-1));
}

TEST_CASE("mirror images among subjects are found and flipped back") {
  std::vector<Boundary> subjects;
  for (int k = 0; k < 3; ++k) {
    Boundary one = bias_organ(k);
    for (Eigen::Index i = 0; i < one.surface.points.rows(); ++i) {
      auto p = one.surface.points.row(i);
      p.x() += 0.01 * p.y() * p.z() + 0.006 * p.y() * p.y();  // no plane of symmetry
    }
    subjects.push_back(std::move(one));
  }
  const Points was = subjects[1].surface.points;
  const auto pointers = [&] {
    std::vector<const Boundary*> all;
    for (const Boundary& subject : subjects) all.push_back(&subject);
    return all;
  };
  CHECK(mirrored_subjects(pointers()).empty());
  subjects[1] = mirrored_boundary(subjects[1]);
  CHECK(enclosed_volume_ml(subjects[1].surface) > 0);
  CHECK(mirrored_subjects(pointers()) == std::vector<std::size_t>{1});
  Progress cancelled;
  cancelled.cancel();
  CHECK(mirrored_subjects(pointers(), &cancelled).empty());
  CHECK(mirrored_boundary(subjects[1]).surface.points == was);
}

TEST_CASE("another organ among the subjects is named") {
  std::vector<Boundary> subjects = organs(4);
  CHECK(consensus_template(subjects, {.vertices = 400}).value().doubtful.empty());
  Mesh stick = icosphere(3, 12);
  stick.points.col(1) *= 7;
  stick.points.col(1).array() += 0.02 * stick.points.col(1).array().square();
  subjects[2] = mesh_boundary(stick);
  CHECK(consensus_template(subjects, {.vertices = 400}).value().doubtful == std::vector<std::size_t>{2});
  std::vector<BiasSubject> named;
  for (std::size_t k = 0; k < subjects.size(); ++k)
    named.push_back({std::string(1, static_cast<char>('a' + k)), subjects[k], {}});
  CHECK(template_bias(named, {.vertices = 400}).value().doubtful == std::vector<std::string>{"c"});
}

TEST_CASE("a consensus of one subject is refused and a cancelled one says so") {
  CHECK(consensus_template(organs(1)).error().what.find("two") != std::string::npos);
  CHECK(template_bias({{"a", bias_organ(0), {}}, {"b", bias_organ(1), {}}}).error().what.find("three") !=
        std::string::npos);
  Progress progress;
  progress.cancel();
  CHECK(consensus_template(organs(2), {.vertices = 200, .progress = &progress}).error().what.find("cancelled") !=
        std::string::npos);
}

TEST_CASE("what was mended of the subject that a template is made from is said") {
  std::vector<Boundary> subjects = organs(3);
  for (Boundary& subject : subjects) {
    const Mesh& whole = subject.surface;
    const Triangles faces = whole.topology->triangles().bottomRows(whole.topology->triangles().rows() - 1);
    subject.surface = {Topology::make(whole.points.rows(), faces).value(), whole.points};
  }
  const Consensus consensus = test::must(consensus_template(subjects, {.vertices = 200, .most_rounds = 1}));
  REQUIRE(consensus.warnings.size() == 1);
  CHECK(consensus.warnings.front().find("one hole closed flat") != std::string::npos);
  const TemplateBias bias = test::must(
      template_bias({{"a", subjects[0], {}}, {"b", subjects[1], {}}, {"c", subjects[2], {}}}, {.vertices = 200}));
  REQUIRE(bias.warnings.size() == 3);
  CHECK(bias.warnings.front().starts_with("a, as a template: "));
}
