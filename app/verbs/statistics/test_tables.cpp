#include "app/verbs/statistics/test_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/files/files.h"
#include "core/base/text/listed.h"
#include "core/base/text/nearest_names.h"
#include "core/base/text/text.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/model/files/model_files.h"
#include "core/model/measures/groups.h"
#include "core/model/shapes/shape_files.h"
#include "core/statistics/landmark_test.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

std::string case_named(const TestCases& cases, Eigen::Index k) {
  return cases.names[k];
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

/// The rows of one term, a vertex each.
std::string landmark_rows(const std::string& term, const LandmarkTest& test, const VertexScalars& outward) {
  std::string rows;
  for (Eigen::Index v = 0; v < test.p.size(); ++v) {
    rows += csv_field(term) + ',' + std::to_string(v) + ',' + number(test.p[v]) + ',' + number(test.q[v]) + ',' +
            number(test.effect[v]) + ',' + (outward.size() > 0 ? number(outward[v]) : "") + '\n';
  }
  return rows;
}

/// Where no q is small since p cannot be: what would help. Empty: that is not so.
std::string too_few_permutations(const DesignTerm& term, const LandmarkTest& test, Eigen::Index permutations) {
  const double least = 1 / static_cast<double>(permutations + 1);
  if (test.q.minCoeff() <= 0.05 || test.p.minCoeff() > least) return {};
  const double vertices = static_cast<double>(test.p.size());
  return term.name + ": no vertex has a q up to 0.05, and none can with " + std::to_string(permutations) +
         " permutations unless " + std::to_string(static_cast<int>(std::ceil(vertices * least / 0.05))) +
         " vertices have the least p that these allow; ask for more with --permutations";
}

Result<void> write_table(TestJob& job, const fs::path& file, const std::string& table) {
  job.tables.push_back(file);
  return write_whole_file(file, table);
}

Result<void> write_landmarks(TestJob& job, const fs::path& file, Progress& progress) {
  std::string table = "term,vertex,p,q,effect_mm,outward_mm\n";
  const Eigen::VectorXd mean = job.cases.shapes.rowwise().mean();
  const double terms = static_cast<double>(job.design.terms.size());
  for (std::size_t t = 0; t < job.design.terms.size(); ++t) {
    if (!job.design.terms[t].tested) continue;
    progress.part(0.4 + 0.4 * static_cast<double>(t) / terms, 0.4 + 0.4 * static_cast<double>(t + 1) / terms);
    const LandmarkTest test =
        test_landmarks(job.design, t, job.responses, job.root_weights, job.permutations, &progress);
    if (progress.cancelled()) return fail("", "cancelled");
    if (std::string why = too_few_permutations(job.design.terms[t], test, job.permutations.rows()); !why.empty())
      job.cases.warnings.push_back(std::move(why));
    VertexScalars outward;
    if (test.offset.size() > 0 && job.cases.topology)
      outward = outward_mm(Mesh{job.cases.topology, points_of(mean)}, test.offset);
    table += landmark_rows(job.design.terms[t].name, test, outward);
  }
  return write_table(job, file, table);
}

Result<void> write_cases(TestJob& job, const fs::path& file) {
  std::string table = "case,size_mm,weight\n";
  for (Eigen::Index k = 0; k < job.design.cases(); ++k)
    table += csv_field(case_named(job.cases, k)) + ',' + number(job.cases.sizes_mm[k]) + ',' +
             number(job.root_weights[k] * job.root_weights[k]) + '\n';
  return write_table(job, file, table);
}

/// A place that --at names, and the file that has where each case has it.
struct TestPlace {
  SurfacePoint at;
  std::int32_t vertex = -1;  ///< where it is one
  std::string file;
};

/// Where a named landmark lies on the shapes: on the first that has landmarks. Errors: none has, none of that name.
Result<SurfacePoint> place_of_landmark(const TestJob& job, const std::string& name) {
  const TrainingVerb& asked = job.options.asked.shapes;
  const auto sources = shape_sources(asked.files, asked.reading.group);
  if (!sources) return fail(sources.error());
  for (const ShapeSource& source : *sources) {
    const auto read = read_shape(source);
    if (!read || (*read)->landmarks.empty() || (*read)->points.size() != job.cases.shapes.rows()) continue;
    std::vector<std::string> names;
    for (const Landmark& one : (*read)->landmarks) {
      if (one.name == name) return SurfaceSearch(Mesh{job.cases.topology, (*read)->points}).nearest(one.position).at;
      names.push_back(one.name);
    }
    return fail("--at " + name, "is no landmark of the shapes; there are " + listed(names, " and ") +
                                    ". Did you mean " + listed(nearest_names(name, names, 1), " or ") + "?");
  }
  return fail("--at " + name, "is the name of a landmark, and the shapes have none; give the number of a vertex");
}

Result<TestPlace> place_asked(const TestJob& job, const std::string& text) {
  const Eigen::Index vertices = job.cases.shapes.rows() / 3;
  if (const auto number = as_number<std::int32_t>(text)) {
    if (*number < 0 || *number >= vertices)
      return fail("--at",
                  "names vertex " + text + ", and the shapes have " + std::to_string(vertices) + ", counted from 0");
    return TestPlace{{}, *number, "vertex-" + text + ".csv"};
  }
  if (!job.options.asked.shapes.structures.empty())
    return fail("--at " + text, "is no number; of several structures give the number of a vertex");
  if (!job.cases.topology) return fail("--at " + text, "is no number; of points alone give the number of a vertex");
  if (!is_file_name(text)) return fail("--at " + text, "cannot be the name of a file; give the number of a vertex");
  const auto place = place_of_landmark(job, text);
  if (!place) return fail(place.error());
  return TestPlace{*place, -1, "landmark-" + text + ".csv"};
}

/// Where each case has a place, aligned, and how far outside of the mean shape.
Result<void> write_places(TestJob& job, const TestPlace& place) {
  const ShapeMatrix& shapes = job.cases.shapes;
  const Eigen::VectorXd mean = shapes.rowwise().mean();
  const auto there = [&](const Points& per_vertex) -> Eigen::RowVector3d {
    if (place.vertex >= 0) return per_vertex.row(place.vertex);
    return place.at.interpolate(*job.cases.topology, per_vertex);
  };
  Eigen::RowVector3d normal = Eigen::RowVector3d::Zero();
  if (job.cases.topology) normal = there(vertex_normals({job.cases.topology, points_of(mean)}));
  if (place.vertex < 0) normal.normalize();
  std::string table = "case,x_mm,y_mm,z_mm,outward_mm\n";
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) {
    const Eigen::RowVector3d at = there(points_of(shapes, k));
    table += csv_field(case_named(job.cases, k));
    for (Eigen::Index axis = 0; axis < 3; ++axis) table += ',' + number(at[axis]);
    table += ',';
    if (job.cases.topology) table += number((at - there(points_of(mean))).dot(normal));
    table += '\n';
  }
  return write_table(job, job.options.tables / place.file, table);
}

Result<void> write_subjects(TestJob& job, const fs::path& file) {
  std::string table = "name,difference_mm,individual_mm\n";
  for (const SubjectPair& one : subject_pairs(job))
    table += csv_field(one.name) + ',' + number(one.difference_mm) + ',' + number(one.individual_mm) + '\n';
  return write_table(job, file, table);
}

}  // namespace

std::vector<SubjectPair> subject_pairs(const TestJob& job) {
  const TestCasesAsked& asked = job.options.asked;
  if (!job.of_shape() || asked.paired.empty()) return {};
  const auto term = std::ranges::find_if(job.design.terms,
                                         [](const DesignTerm& one) { return one.tested && one.levels.size() == 2; });
  if (term == job.design.terms.end()) return {};
  const auto variable =
      std::ranges::find_if(asked.formula.terms, [&](const FormulaTerm& one) { return text_of(one) == term->name; });
  const std::size_t groups = *job.cases.table.column(variable->front().name),
                    subjects = *job.cases.table.column(asked.paired);
  std::map<std::string, std::array<std::vector<Eigen::Index>, 2>> of_subject;
  for (Eigen::Index k = 0; k < job.design.cases(); ++k) {
    const auto& cells = job.cases.table.cells[job.cases.rows[k]];
    of_subject[cells[subjects]][cells[groups] == term->levels[1] ? 1 : 0].push_back(k);
  }
  std::vector<SubjectPair> pairs;
  ShapeMatrix differences(job.responses.rows(), std::ssize(of_subject));
  for (const auto& [name, shapes] : of_subject) {
    if (shapes[0].size() != 1 || shapes[1].size() != 1) return {};
    differences.col(std::ssize(pairs)) = job.responses.col(shapes[1].front()) - job.responses.col(shapes[0].front());
    pairs.push_back({name, 0, 0});
  }
  const Eigen::VectorXd mean = differences.rowwise().mean();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto difference = differences.col(static_cast<Eigen::Index>(k));
    pairs[k].difference_mm = difference.norm() / std::sqrt(job.vertices());
    pairs[k].individual_mm = (difference - mean).norm() / std::sqrt(job.vertices());
  }
  return pairs;
}

Result<Json> write_tables(TestJob& job, Progress& progress) {
  const fs::path tables = job.options.tables;
  std::vector<TestPlace> places;  // all of them first, so that nothing is written for a name that is wrong
  for (const std::string& text : job.options.at) {
    auto place = place_asked(job, text);
    if (!place) return fail(place.error());
    places.push_back(std::move(*place));
  }
  const auto folder = ResultFolder::make(tables);
  if (!folder) return fail(folder.error());
  if (auto done = write_cases(job, tables / "cases.csv"); !done) return fail(done.error());
  for (const TestPlace& place : places)
    if (auto done = write_places(job, place); !done) return fail(done.error());
  if (!subject_pairs(job).empty())
    if (auto done = write_subjects(job, tables / "subjects.csv"); !done) return fail(done.error());
  if (!job.of_shape()) return Json();
  const fs::path landmarks = tables / "landmarks.csv";
  if (auto done = write_landmarks(job, landmarks, progress); !done) return fail(done.error());
  return Json(landmarks.string());
}

}  // namespace homolog
