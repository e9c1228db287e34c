#include <doctest/doctest.h>

#include <cmath>
#include <exception>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/adapt/annealing.h"
#include "core/adapt/boundary/boundary.h"
#include "core/adapt/fit.h"
#include "core/adapt/labels/label_fit.h"
#include "core/case/actions/points.h"
#include "core/catalogue/catalogue.h"
#include "core/deform/deformer.h"
#include "core/measure/compare.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/model/conditional.h"
#include "core/model/joint_models/complete_structures.h"
#include "core/model/joint_models/joint_alignment.h"
#include "core/model/shape_model.h"
#include "core/phantom/phantom.h"
#include "core/placement/likely_similarity.h"
#include "core/placement/similarity_fit.h"
#include "core/session/case_file.h"
#include "core/solve/shape_solver.h"
#include "core/template_making/tube_template.h"
#include "core/volume/volume_io.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

// What programs that use the library may hand to it by mistake [docs/library.md].

namespace homolog {

namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// One call that goes wrong, and words of the sentence by which it is refused.
struct Call {
  const char* what;
  std::function<std::string()> said;
  const char* words;
};

template <class T>
std::string said(const Result<T>& result) {
  return result ? "nothing was refused" : result.error().sentence();
}

/// What a function that returns no Result says.
std::string thrown(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& refused) {
    return refused.what();
  } catch (const std::exception& other) {
    return std::string("another exception: ") + other.what();
  }
  return "nothing was refused";
}

/// `calls` are refused, each in its own words.
void check_refusals(const std::vector<Call>& calls) {
  for (const Call& call : calls) {
    CAPTURE(std::string(call.what));
    const std::string sentence = call.said();
    CHECK_MESSAGE(sentence.find(call.words) != std::string::npos, sentence);
    CHECK_MESSAGE(sentence.find("; ") != std::string::npos, sentence);  // and what helps
  }
}

Mesh ball() {
  return icosphere(2, 50);
}

Points with_nan(Points points) {
  points(3, 1) = no_number;
  return points;
}

Mesh ball_with(Points points) {
  return {ball().topology, std::move(points)};
}

std::shared_ptr<const Template> kidney() {
  static const auto the_template = test::must(load_template("built-in:kidney"));
  return the_template;
}

/// The kidney as a program may have changed it.
Template changed(const std::function<void(Template&)>& change) {
  Template copy = *kidney();
  change(copy);
  return copy;
}

MeshFile changed_file(const std::function<void(MeshFile&)>& change) {
  MeshFile file = to_mesh_file(*kidney());
  change(file);
  return file;
}

const Volume& kidney_labels() {
  static const Volume labels = make_phantom(Organ::kidney, 1).label_map;
  return labels;
}

Volume changed_labels(const std::function<void(Volume&)>& change) {
  Volume copy = kidney_labels();
  change(copy);
  return copy;
}

Boundary of_ball(const std::function<void(Boundary&)>& change) {
  Boundary boundary = mesh_boundary(ball());
  change(boundary);
  return boundary;
}

std::string fitted_with(const std::function<void(FitOptions&)>& change) {
  FitOptions options;
  change(options);
  return said(fit_to_boundary(*kidney(), mesh_boundary(ball()), options));
}

StrokeStart changed_start(const std::function<void(StrokeStart&)>& change) {
  const Mesh mesh = ball();
  StrokeStart start{.topology = mesh.topology, .stiffness_base = 3};
  start.placed = start.reference = start.points = std::make_shared<const Points>(mesh.points);
  start.stiffness = std::make_shared<const VertexScalars>(VertexScalars::Ones(mesh.points.rows()));
  change(start);
  return start;
}

std::string stroked_from(const std::function<void(StrokeStart&)>& change, Tool tool = Tool::pull) {
  const Stroke stroke{.tool = tool, .at = Vec3(0, 0, 50), .to = Vec3(0, 0, 60)};
  return said(Deformer().stroke(changed_start(change), stroke, Pass::commit));
}

/// A ball that is drawn to itself.
std::string annealed(const std::function<void(Adapting&)>& change, const std::function<void(Force&)>& change_force) {
  const Mesh mesh = ball();
  Adapting shape{.mesh = mesh, .rest = mesh.points, .placed = mesh.points, .factors = VertexScalars::Ones(162)};
  change(shape);
  ShapeSolver solver(mesh.topology);
  return said(anneal(shape, solver, {.steps = 2, .softest_edges = 1}, [&](const Mesh& now, double) {
    Force force{VertexScalars::Ones(now.points.rows()), now.points};
    change_force(force);
    return force;
  }));
}

/// A model of three modes of ten vertices.
ShapeModel small_model() {
  return make_model(principal_components(ShapeMatrix::Random(30, 4)), 1, nullptr, {});
}

const auto nothing = [](auto&) {};

}  // namespace

TEST_CASE("a solver refuses what is not of its mesh") {
  const auto solver = [] { return ShapeSolver(ball().topology); };
  const auto ready = [&] {
    ShapeSolver made = solver();
    REQUIRE(made.factorise(VertexScalars::Ones(162)));
    return made;
  };
  check_refusals({
      {"no topology", [] { return thrown([] { ShapeSolver{nullptr}; }); }, "has no topology"},
      {"few weights", [&] { return said(solver().factorise(VertexScalars::Ones(3))); }, "3 rows for 162 vertices"},
      {"few holds", [&] { return said(solver().factorise(VertexScalars::Ones(162), VertexScalars::Ones(3))); },
       "3 rows for 162 vertices"},
      {"a hold that is no number",
       [&] { return said(solver().factorise(VertexScalars::Ones(162), VertexScalars::Constant(162, no_number))); },
       "a force or a hold"},
      {"few values", [&] { return thrown([&] { ready().solve(VertexScalars(VertexScalars::Ones(5))); }); },
       "5 rows for 162 vertices"},
      {"few points", [&] { return thrown([&] { ready().solve(Points(Points::Ones(5, 3))); }); },
       "5 rows for 162 vertices"},
      {"nothing factorised", [&] { return thrown([&] { solver().solve(VertexScalars(VertexScalars::Ones(162))); }); },
       "nothing is factorised"},
      {"what was factorised is lost",
       [&] {
         ShapeSolver made = ready();
         REQUIRE_FALSE(made.factorise(VertexScalars::Ones(162), VertexScalars::Constant(162, no_number)));
         return thrown([&] { made.solve(VertexScalars(VertexScalars::Ones(162))); });
       },
       "nothing is factorised"},
  });
}

TEST_CASE("an annealing refuses arrays and forces that are not of its mesh") {
  check_refusals({
      {"few factors", [] { return annealed([](Adapting& a) { a.factors.setOnes(7); }, nothing); }, "7 rows for 162"},
      {"few points of the reference", [] { return annealed([](Adapting& a) { a.rest.setZero(5, 3); }, nothing); },
       "5 rows for 162"},
      {"a point that is no number", [] { return annealed([](Adapting& a) { a.placed(3, 1) = no_number; }, nothing); },
       "at vertex 3"},
      {"a held vertex beyond the mesh", [] { return annealed([](Adapting& a) { a.held = {162}; }, nothing); },
       "not on the mesh"},
      {"a pin beyond the mesh",
       [] { return annealed([](Adapting& a) { a.pins = {Pin{.on = {.face = 320}}}; }, nothing); }, "not on the mesh"},
      {"another mesh", [] { return annealed([](Adapting& a) { a.mesh = icosphere(1, 50); }, nothing); },
       "rows for 42 vertices"},
      {"few forces",
       [] { return annealed(nothing, [](Force& f) {
              f = {VertexScalars::Ones(3), Points::Zero(3, 3)};
            }); },
       "3 rows for 162"},
      {"a weight that is no number", [] { return annealed(nothing, [](Force& f) { f.weights[4] = no_number; }); },
       "a force or a hold"},
      {"a pull that is no number", [] { return annealed(nothing, [](Force& f) { f.pulls(3, 1) = no_number; }); },
       "at vertex 3"},
  });
}

TEST_CASE("a stroke refuses a start that is not whole") {
  const auto few = std::make_shared<const Points>(Points::Zero(3, 3));
  const auto wrong = std::make_shared<const Points>(with_nan(ball().points));
  const auto few_values = std::make_shared<const VertexScalars>(VertexScalars::Ones(3));
  check_refusals({
      {"nothing", [] { return stroked_from([](StrokeStart& s) { s = {}; }); }, "lacks a topology"},
      {"no reference", [] { return stroked_from([](StrokeStart& s) { s.reference.reset(); }); }, "lacks a topology"},
      {"few points", [&] { return stroked_from([&](StrokeStart& s) { s.points = few; }); }, "3 rows for 162"},
      {"few placed", [&] { return stroked_from([&](StrokeStart& s) { s.placed = few; }); }, "3 rows for 162"},
      {"few factors", [&] { return stroked_from([&](StrokeStart& s) { s.stiffness = few_values; }); },
       "3 rows for 162"},
      {"few confirmed", [&] { return stroked_from([&](StrokeStart& s) { s.confirmed = few_values; }); },
       "3 rows for 162"},
      {"a point that is no number", [&] { return stroked_from([&](StrokeStart& s) { s.points = wrong; }); },
       "at vertex 3"},
      {"the same, relaxed", [&] { return stroked_from([&](StrokeStart& s) { s.reference = wrong; }, Tool::relax); },
       "at vertex 3"},
  });
}

TEST_CASE("a template refuses what is not of its vertices") {
  const auto made = [](const std::function<void(MeshFile&)>& change) {
    return said(make_template(changed_file(change), "t.ply"));
  };
  const auto fitted = [](const std::function<void(Template&)>& change) {
    return said(fit_to_boundary(changed(change), mesh_boundary(ball())));
  };
  const auto seven = std::make_shared<const VertexScalars>(VertexScalars::Ones(7));
  check_refusals({
      {"few factors", [&] { return made([&](MeshFile& f) { f.stiffness = seven; }); },
       "t.ply: the template's stiffness"},
      {"a factor of 0",
       [&] {
         return made(
             [](MeshFile& f) { f.stiffness = std::make_shared<const VertexScalars>(VertexScalars::Zero(2500)); });
       },
       "no positive number"},
      {"a base that is no number", [&] { return made([](MeshFile& f) { f.stiffness_base = no_number; }); },
       "no positive number"},
      {"a point that is no number", [&] { return made([](MeshFile& f) { f.points(0, 0) = no_number; }); },
       "at vertex 0"},
      {"regions of other vertices", [&] { return made([](MeshFile& f) {
                                            f.regions.of_vertex = {0, 0};
                                          }); }, "regions"},
      {"a landmark nowhere", [&] { return made([](MeshFile& f) {
                                     f.landmarks = {{"tip", Vec3(no_number, 0, 0)}};
                                   }); },
       "\"tip\" lies at no finite place"},
      {"a landmark nowhere, given afterwards",
       [] { return thrown([] {
              with_landmarks(*kidney(), {{"tip", Vec3(no_number, 0, 0)}});
            }); },
       "\"tip\" lies at no finite place"},
      {"few points, fitted", [&] { return fitted([](Template& t) { t.points.conservativeResize(20, 3); }); },
       "20 rows for 2500"},
      {"few factors, fitted", [&] { return fitted([](Template& t) { t.stiffness.setOnes(3); }); }, "3 rows for 2500"},
      {"a point that is no number, fitted", [&] { return fitted([](Template& t) { t.points(9, 2) = no_number; }); },
       "at vertex 9"},
      {"no topology, fitted", [&] { return fitted([](Template& t) { t.topology.reset(); }); }, "has no triangles"},
      {"landmarks off the surface, fitted", [&] { return fitted([](Template& t) { t.landmark_points.clear(); }); },
       "not on its surface"},
  });
}

TEST_CASE("a fit refuses a boundary and options that cannot be") {
  const auto fitted_to = [](const std::function<void(Boundary&)>& change) {
    return said(fit_to_boundary(*kidney(), of_ball(change)));
  };
  const std::string landmark = kidney()->landmarks.front().name;
  Points few = ball().points;
  few.conservativeResize(20, 3);
  check_refusals({
      {"no mesh", [] { return thrown([] { mesh_boundary(Mesh{}); }); }, "has no triangles"},
      {"few points", [&] { return thrown([&] { mesh_boundary(ball_with(few)); }); }, "20 rows for 162"},
      {"a point that is no number", [] { return thrown([] { mesh_boundary(ball_with(with_nan(ball().points))); }); },
       "at vertex 3"},
      {"the same put together", [&] { return fitted_to([](Boundary& b) { b.surface.points(3, 1) = no_number; }); },
       "at vertex 3"},
      {"few points put together", [&] { return fitted_to([&](Boundary& b) { b.surface.points = few; }); },
       "20 rows for 162"},
      {"cuts of other faces", [&] { return fitted_to([](Boundary& b) {
                                      b.cut = {1, 0};
                                    }); }, "cuts of other faces"},
      {"a border that is no plane",
       [&] { return fitted_to([](Boundary& b) {
               b.scan_borders = {{Vec3::UnitX(), no_number, 1}};
             }); },
       "border of the scan"},
      {"a landmark nowhere",
       [&] { return fitted_with([&](FitOptions& o) { o.landmarks[landmark] = Vec3(0, no_number, 0); }); },
       "no finite place"},
      {"a placement of no size",
       [] { return fitted_with([](FitOptions& o) { o.placement = Similarity{.scale = no_number}; }); },
       "the placement holds a number"},
      {"allowed shapes of another mesh",
       [] {
         return fitted_with([](FitOptions& o) {
           AllowedShapes allowed{.mean = Points::Zero(5, 3)};
           allowed.nearest = [](const auto&...) { return AllowedShape{}; };
           o.allowed = std::make_shared<const AllowedShapes>(std::move(allowed));
         });
       },
       "5 rows for 2500"},
  });
}

TEST_CASE("a label map that cannot be is refused where it is fitted to, compared with and written") {
  const TemporaryFolder folder;
  const auto fitted = [](const Volume& map, int frame, std::optional<double> closing_mm = {}) {
    return said(fit_to_label(*kidney(), {map, 1, frame}, {.closing_mm = closing_mm}, {}));
  };
  const auto written = [&](const std::function<void(Volume&)>& change) {
    return said(write_volume(changed_labels(change), folder.path / "a.nii.gz"));
  };
  const auto larger = [](Volume& v) { v.geometry.dims = {300, 300, 300}; };
  check_refusals({
      {"a frame before the first", [&] { return fitted(kidney_labels(), -2); }, "has no frame -2"},
      {"a frame behind the last", [&] { return fitted(kidney_labels(), 1); }, "has no frame 1"},
      {"another grid", [&] { return fitted(changed_labels(larger), 0); }, "not what its grid says"},
      {"no voxels", [&] { return fitted(Volume{}, 0); }, "holds no voxels"},
      {"a radius that is no number", [&] { return fitted(kidney_labels(), 0, no_number); }, "such a radius"},
      {"another grid, written", [&] { return written(larger); }, "not what its grid says"},
      {"no voxels, written", [&] { return written([](Volume& v) { v = {}; }); }, "holds no voxels"},
      {"no spacing, written", [&] { return written([](Volume& v) { v.geometry.spacing_mm[1] = 0; }); }, "lies nowhere"},
      {"no axes, written", [&] { return written([](Volume& v) { v.geometry.direction.setZero(); }); }, "lies nowhere"},
      {"no place, written", [&] { return written([](Volume& v) { v.geometry.origin_mm[0] = no_number; }); },
       "lies nowhere"},
      {"a frame to compare with", [] { return said(compare_with_mask(ball(), kidney_labels(), 1, 3)); },
       "has no frame 3"},
      {"the same without a Result", [] { return thrown([] { dice_with_mask(ball(), kidney_labels(), 1, -1); }); },
       "has no frame -1"},
  });
  CHECK(std::filesystem::is_empty(folder.path));
}

TEST_CASE("surfaces that cannot be are not compared") {
  const Mesh pointless = ball_with(Points(0, 3)), wrong = ball_with(with_nan(ball().points));
  check_refusals({
      {"no points", [&] { return thrown([&] { mean_surface_distance_mm(ball(), pointless); }); }, "0 rows for 162"},
      {"no points, the other way", [&] { return thrown([&] { mean_surface_distance_mm(pointless, ball()); }); },
       "0 rows for 162"},
      {"a point that is no number", [&] { return thrown([&] { surface_distance(ball(), wrong); }); }, "at vertex 3"},
      {"no topology", [&] { return thrown([&] { compare_meshes(Mesh{}, ball()); }); }, "has no triangles"},
  });
}

TEST_CASE("shapes that cannot be become no model and a model refuses others") {
  ShapeMatrix wrong = ShapeMatrix::Random(30, 4), uneven = ShapeMatrix::Random(10, 4);
  wrong(2, 2) = no_number;
  const PrincipalComponents sound = principal_components(ShapeMatrix::Random(30, 4));
  check_refusals({
      {"rows", [&] { return thrown([&] { align(uneven, Alignment::similarity); }); }, "no multiple of 3"},
      {"no number", [&] { return thrown([&] { align(wrong, Alignment::rigid); }); }, "no finite number"},
      {"no number, of axes", [&] { return thrown([&] { principal_components(wrong); }); }, "no finite number"},
      {"no number, of some axes", [&] { return thrown([&] { leading_components(wrong, 2); }); }, "no finite number"},
      {"points of another shape",
       [] { return thrown([] { aligned_to(Points::Random(5, 3), Points::Random(6, 3), Alignment::rigid); }); },
       "cannot be aligned"},
      {"a share that is no number", [&] { return thrown([&] { make_model(sound, no_number, nullptr, {}); }); },
       "above 0 and up to 1"},
      {"no share", [&] { return thrown([&] { make_model(sound, 0, nullptr, {}); }); }, "above 0 and up to 1"},
      {"another topology", [&] { return thrown([&] { make_model(sound, 0.9, ball().topology, {}); }); },
       "10 rows for 162"},
      {"a mode too many", [] { return thrown([] { mode_shape(small_model(), 17, 2); }); }, "no such mode"},
      {"a mode below 0", [] { return thrown([] { mode_shape(small_model(), -1, 2); }); }, "no such mode"},
      {"another shape", [] { return thrown([] { coefficients(small_model(), Points::Zero(5, 3)); }); },
       "other vertices than the model"},
      {"more coefficients than modes", [] { return thrown([] { clamped(small_model(), Eigen::VectorXd::Ones(50)); }); },
       "more coefficients"},
  });
}

TEST_CASE("points without partners, vertices that a model lacks and surfaces of no frame are refused") {
  const Points three = Points::Random(3, 3), two = Points::Random(2, 3);
  const auto predicted = [](const std::vector<Eigen::Index>& landmarks, Eigen::Index rows, double noise_mm) {
    return thrown([&] { predict(small_model(), landmarks, Points::Zero(rows, 3), noise_mm); });
  };
  ShapeMatrix shapes = ShapeMatrix::Random(30, 4);
  const std::vector<StructurePart> parts{{.name = "a", .first_vertex = 0, .vertices = 10}};
  const std::vector<float> values(5, -1.0F);
  check_refusals({
      {"a position too many",
       [&] {
         return predicted({1, 2}, 3, 1);
       },
       "other positions than landmarks"},
      {"a vertex behind the last",
       [&] {
         return predicted({1, 10}, 2, 1);
       },
       "no such vertex"},
      {"a vertex before the first", [&] { return predicted({-1}, 1, 1); }, "no such vertex"},
      {"no noise", [&] { return predicted({1}, 1, 0); }, "a noise above 0 mm"},
      {"points of another number", [&] { return thrown([&] { nearest_similarity(three, two, {}); }); },
       "as many of both"},
      {"landmarks of another number", [&] { return thrown([&] { likely_similarity(three, two, {}, 100); }); },
       "as many of both"},
      {"two complete shapes",
       [&] { return thrown([&] { completed_shape(shapes.leftCols(2), parts, {}, Alignment::rigid); }); },
       "three complete shapes"},
      {"structures that are not said",
       [&] { return thrown([&] { completed_shape(shapes, parts, {}, Alignment::rigid); }); }, "other structures"},
      {"each on its own without alignment",
       [&] { return thrown([&] { align_structures(shapes, parts, Alignment::none, true); }); }, "without an alignment"},
      {"a tube of one ring", [] { return said(make_tube_template(kidney_labels(), {.rings = 1})); },
       "at least 2 rings"},
      {"a surface of another frame", [] { return said(mask_surface(kidney_labels(), 1, 1)); }, "has no frame 1"},
      {"values of another grid", [&] { return said(zero_surface(values, kidney_labels().geometry)); },
       "a value of each voxel"},
  });
}

TEST_CASE("a case begins with a sound template") {
  const TemporaryFolder folder;
  const auto created = [&](const Document& document) { return said(create_case(document, folder.path / "a.homolog")); };
  const auto of_template = [&](const std::function<void(Template&)>& change) {
    Document document = new_document("", nullptr, kidney());
    const auto wrong = std::make_shared<const Template>(changed(change));
    document.change({}, [&](Structure& first) { first.the_template = wrong; });
    return document;
  };
  check_refusals({
      {"few points", [&] { return created(of_template([](Template& t) { t.points.conservativeResize(20, 3); })); },
       "20 rows for 2500"},
      {"a structure that is none",
       [&] {
         Document document = new_document("", nullptr, kidney());
         document.structures.push_back(nullptr);
         return created(document);
       },
       "without a template"},
  });
  CHECK(std::filesystem::is_empty(folder.path));
}

TEST_CASE("a boundary of a frame, a grid or a template that cannot be is refused") {
  const Volume labels = make_phantom(Organ::kidney, 1).label_map;
  const auto said = [](const Result<Boundary>& boundary) { return boundary ? "" : boundary.error().what; };
  CHECK(said(label_boundary(labels, 1, 7, std::nullopt, 500)).starts_with("has no frame 7; it has 1"));
  CHECK(said(label_boundary(labels, 1, -1, std::nullopt, 500)).starts_with("has no frame -1"));
  CHECK(said(label_boundary(labels, 1, 0, std::nullopt, 0)).find("four vertices") != std::string::npos);
  Volume larger = labels;
  larger.geometry.dims[0] *= 9;
  CHECK(said(label_boundary(larger, 1, 0, std::nullopt, 500)).find("not what its grid says") != std::string::npos);
  const auto fit = fit_to_boundary(*test::must(load_template("built-in:kidney")), Boundary{}, {});
  REQUIRE_FALSE(fit);
  CHECK(fit.error().what.starts_with("gives no surface"));
}

TEST_CASE("points of another mesh are refused when they are applied") {
  const auto the_template = test::must(load_template("built-in:kidney"));
  EditSession session(new_document("", nullptr, the_template));
  const auto refused = session.apply(points_edit(*session.document().view(), Points::Zero(5, 3), FoundBy::fit));
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what == "5 were given for 2500 vertices");
}

TEST_CASE("a model of nothing has no axes and coefficients beyond its modes do not count") {
  CHECK(principal_components(ShapeMatrix()).scatter.size() == 0);
  CHECK(principal_components(ShapeMatrix(9, 0)).mean.size() == 9);
  const PrincipalComponents components = principal_components(ShapeMatrix::Random(9, 4));
  const ShapeModel model = make_model(components, 1, nullptr, {});
  REQUIRE(model.modes() == 3);
  CHECK(components.basis(50).cols() == 3);
  CHECK(shape_of(model, Eigen::VectorXd::Ones(50)) == shape_of(model, Eigen::VectorXd::Ones(3)));
  CHECK(std::isnan(mean_surface_distance_mm(Mesh{}, icosphere(1, 1))));
}

TEST_CASE("a mesh that was put together wrongly becomes no file") {
  const TemporaryFolder folder;
  for (const char* name : {"a.ply", "a.vtp", "a.obj", "a.stl"}) {
    CAPTURE(std::string(name));
    MeshFile file{icosphere(1, 10).points, icosphere(1, 10).topology->triangles()};
    REQUIRE(write_mesh_file(file, folder.path / name));
    file.doubt_mm = VertexScalars::Ones(3);
    CHECK_FALSE(write_mesh_file(file, folder.path / name));
    file.doubt_mm.reset();
    file.triangles.edit()(0, 0) = 42;
    const auto refused = write_mesh_file(file, folder.path / name);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().what.starts_with("a face names vertex 42 of 42"));
    file.triangles.edit()(0, 0) = -1;
    CHECK_FALSE(write_mesh_file(file, folder.path / name));
    CHECK(read_mesh_file(folder.path / name));  // the one before is still there
  }
}

}  // namespace homolog
