#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "app/lab/schemes.h"
#include "core/case/action_line.h"
#include "core/deform/sigma_presets.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_quality.h"
#include "tests/refusal.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// A ball of 20 mm with landmarks where the axes leave it.
std::shared_ptr<const Template> ball_template() {
  const Mesh ball = icosphere(3, 20);
  MeshFile file;
  file.points = ball.points;
  file.triangles = ball.topology->triangles();
  file.landmarks = {{"left", {20, 0, 0}},   {"right", {-20, 0, 0}}, {"back", {0, 20, 0}},
                    {"front", {0, -20, 0}}, {"top", {0, 0, 20}},    {"bottom", {0, 0, -20}}};
  return make_template(std::move(file), "ball").value();
}

/// The ball stretched along x and dented on top, with its landmarks.
ExperimentSubject stretched_ball() {
  const auto the_template = ball_template();
  ExperimentSubject subject;
  Points points = the_template->points;
  points.col(0) *= 1.25;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    points(i, 2) -= 4 * std::exp(-(Vec3(points.row(i)) - Vec3(0, 0, 20)).squaredNorm() / 128);
  subject.target = {the_template->topology, points};
  subject.visible_mm = 0.5;
  subject.truth = points;
  subject.shown = the_template->landmarks;
  for (std::size_t k = 0; k < subject.shown.size(); ++k)
    subject.shown[k].position = the_template->landmark_points[k].interpolate(*the_template->topology, points);
  return subject;
}

EditSession new_session(const std::shared_ptr<const Template>& the_template = ball_template()) {
  return EditSession(new_document("", nullptr, the_template));
}

SchemeRun run_of(const ExperimentSubject& subject, const std::string& scheme, std::optional<std::uint64_t> seed = {}) {
  EditSession session = new_session();
  return run_scheme(session, subject, working_scheme(scheme).value(), {seed, 30, nullptr}).value();
}

double largest_mm(const std::vector<Deviation>& seen) {
  return std::max_element(seen.begin(), seen.end(),
                          [](const auto& a, const auto& b) { return a.distance_mm < b.distance_mm; })
      ->distance_mm;
}

}  // namespace

TEST_CASE("what the mesh does not reach is seen as well as what it reaches beyond") {
  const Mesh small = icosphere(2, 10), large = icosphere(2, 12);
  Sight outwards(large, small.topology), inwards(small, large.topology);
  CHECK(largest_mm(Sight(small, small.topology).look(small.points)) < 1e-9);
  CHECK(mean_mm(outwards.look(small.points)) == doctest::Approx(2).epsilon(0.05));
  CHECK(mean_mm(inwards.look(large.points)) == doctest::Approx(2).epsilon(0.05));
  // A horn of the target, to which every vertex of the mesh is blind.
  Mesh horned = small;
  horned.points.row(0) *= 2;
  const auto seen = Sight(horned, small.topology).look(small.points);
  CHECK(largest_mm({seen.begin(), seen.begin() + small.points.rows()}) < 4);
  CHECK(largest_mm(seen) == doctest::Approx(10));
}

TEST_CASE("an open mesh is looked at with its openings closed") {
  const Mesh tube = shapes::open_cylinder(9, 24, 10, 40), longer = shapes::open_cylinder(9, 24, 10, 45);
  Sight own(capped(tube), tube.topology);
  CHECK(largest_mm(own.look(tube.points)) < 1e-9);
  Sight beyond(capped(longer), tube.topology);
  const auto seen = beyond.look(tube.points);
  CHECK(largest_mm(seen) == doctest::Approx(5).epsilon(0.01));
  for (const Deviation& d : seen)
    if (d.distance_mm > 4) CHECK(tube.topology->on_rim(d.vertex));
  CHECK(mean_mm(beyond.look(longer.points)) < 1e-9);
}

TEST_CASE("a placement is disturbed by its seed alone") {
  const auto placed = [](std::uint64_t seed) {
    EditSession session = new_session();
    REQUIRE(disturb_placement(session, seed));
    return session.document().view()->shape.placement;
  };
  CHECK(placed(3) == placed(3));
  CHECK(!(placed(3) == placed(4)));
  CHECK(std::abs(placed(3).scale - 1) < 0.06);
}

TEST_CASE("features that are grabbed come near their places") {
  const ExperimentSubject subject = stretched_ball();
  EditSession session = new_session();
  CHECK(grab_landmarks(session, subject.shown).value() == 18);
  const Template& the_template = *session.document().structure()->the_template;
  for (std::size_t k = 0; k < subject.shown.size(); ++k) {
    const Vec3 here =
        the_template.landmark_points[k].interpolate(*the_template.topology, *session.document().view()->shape.points);
    CHECK((here - subject.shown[k].position).norm() < 1);
  }
}

namespace {

/// How wide the strokes were that a session did, mm.
std::vector<double> stroke_sigmas_mm(const EditSession& session) {
  std::stringstream lines;
  REQUIRE(session.lines().copy_to(lines));
  std::vector<double> sigmas_mm;
  for (std::string line; std::getline(lines, line);)
    sigmas_mm.push_back(std::get<Stroke>(parse_action(line).value().action).sigma_mm);
  return sigmas_mm;
}

}  // namespace

TEST_CASE("the scripted user strokes with the presets of the editor") {
  const ExperimentSubject subject = stretched_ball();
  EditSession session = new_session();
  REQUIRE(grab_landmarks(session, subject.shown));
  const auto presets_mm = default_sigmas_mm(*session.document().view()->shape.reference);
  for (const double sigma_mm : stroke_sigmas_mm(session)) CHECK(sigma_mm == presets_mm[2]);
  const std::size_t grabs = stroke_sigmas_mm(session).size();
  PullingOptions options;
  options.most_pulls = 3;
  REQUIRE(pull_to_target(session, subject.target, options).value().pulls > 0);
  const auto sigmas_mm = stroke_sigmas_mm(session);
  REQUIRE(sigmas_mm.size() > grabs);
  for (const double sigma_mm : sigmas_mm)
    CHECK(std::find(presets_mm.begin(), presets_mm.end(), sigma_mm) != presets_mm.end());
}

TEST_CASE("features that are held stay where they were clicked") {
  const ExperimentSubject subject = stretched_ball();
  EditSession session = new_session();
  REQUIRE(click_landmarks(session, subject.shown));
  REQUIRE(confirm_landmarks(session, subject.shown));
  const auto held = session.document().view()->shape.confirmed;
  REQUIRE(held);
  CHECK(held->sum() >= 6);
  const Points before = *session.document().view()->shape.points;
  PullingOptions options;
  options.most_pulls = 6;
  REQUIRE(pull_to_target(session, subject.target, options).value().pulls > 0);
  const Points moved = *session.document().view()->shape.points - before;
  for (Eigen::Index i = 0; i < moved.rows(); ++i)
    if ((*held)[i] >= 1) CHECK(moved.row(i).norm() < 1e-12);
}

TEST_CASE("the scripted user brings a template onto its target by every way of anchored working") {
  const ExperimentSubject subject = stretched_ball();
  for (const char* scheme : {"anchored", "anchored+grab", "anchored+warp", "anchored+hold", "spacing+warp"}) {
    CAPTURE(scheme);
    const SchemeRun run = run_of(subject, scheme, 1);
    CHECK(run.assd < 0.3);
    CHECK(run.assd < run.assd_placed);
    CHECK(run.dice > 0.97);
    CHECK(run.turned_triangles == 0);
    CHECK(run.pulls_to_1mm.has_value());
    CHECK(*run.landmarks < *run.landmarks_placed);
  }
}

TEST_CASE("the same seed gives the same run and another one another") {
  const ExperimentSubject subject = stretched_ball();
  const SchemeRun once = run_of(subject, "anchored", 5), again = run_of(subject, "anchored", 5);
  CHECK(once.points == again.points);
  CHECK(once.pulls == again.pulls);
  CHECK(run_of(subject, "anchored", 6).points != once.points);
}

TEST_CASE("landmarks that are not shown are where the error is measured") {
  ExperimentSubject subject = stretched_ball();
  const double everywhere = *run_of(subject, "anchored+warp").landmarks;
  subject.truth.reset();
  CHECK(!run_of(subject, "anchored").landmarks);
  subject.hidden = {subject.shown.back()};
  subject.shown.pop_back();
  const SchemeRun run = run_of(subject, "anchored+warp");
  REQUIRE(run.landmarks);
  CHECK(*run.landmarks != everywhere);
  CHECK(*run.landmarks < 4);
}

TEST_CASE("with landmarks shown the default ends nearer to the truth of a phantom than the paper's scheme") {
  const ExperimentSubject subject = phantom_experiment_subject(Organ::vertebra, 2);
  const auto the_template = make_template(built_in_template(Organ::vertebra), "built-in:vertebra").value();
  const auto run = [&](const std::string& scheme) {
    EditSession session = new_session(the_template);
    return run_scheme(session, subject, working_scheme(scheme).value(), {1, 10, nullptr}).value();
  };
  const SchemeRun ours = run(default_scheme(true)), paper = run("paper-10+grab");
  CHECK(*ours.landmarks < 1);
  CHECK(*ours.landmarks < *paper.landmarks / 2);
  CHECK(ours.assd < paper.assd);
  CHECK(ours.turned_triangles == 0);
}

TEST_CASE("names of schemes say all of them and others are refused") {
  for (const bool with_features : {false, true}) {
    const auto names = compared_schemes(with_features);
    for (const std::string& name : names) CHECK(working_scheme(name).value().name == name);
    CHECK(std::count(names.begin(), names.end(), default_scheme(with_features)) == 1);
  }
  CHECK(working_scheme("paper-10+grab").value().paper_events == 10);
  CHECK(working_scheme("paper-10+grab").value().features == LandmarkUse::grab);
  CHECK(working_scheme("fit+warp").value().adaptation == Adaptation::fit);
  CHECK(working_scheme("projection").value().adaptation == Adaptation::projection);
  CHECK(working_scheme("anchored+warp+refine").value().features == LandmarkUse::warp);
  CHECK(working_scheme("anchored+refine").value().refine);
  for (const char* wrong : {"", "anchored+", "anchored+magic", "paper", "raw+warp+hold", "fit+grab", "projection+warp",
                            "fit+refine", "anchored+refine+warp"})
    CHECK(!working_scheme(wrong));
}

TEST_CASE("a run that is cancelled says so") {
  Progress progress;
  progress.cancel();
  EditSession session = new_session();
  const auto run =
      run_scheme(session, stretched_ball(), working_scheme("anchored").value(), {std::nullopt, 30, &progress});
  CHECK(says(run, "the study was cancelled"));
}
