#include "core/model/measures/observers.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <set>

#include "core/base/files/file_stem.h"
#include "core/base/processes/parallel.h"
#include "core/measure/meeting.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/parts/rims.h"
#include "core/mesh/repair/inside_out.h"
#include "core/model/files/model_files.h"
#include "core/model/shapes/shape_files.h"
#include "core/model/shapes/shape_folder.h"
#include "core/model/shapes/study.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// Meshes that overlap so much lie in one place.
constexpr double surely_met = 0.7;

Result<Mesh> surface_of(const MeshFile& file) {
  if (file.triangles.rows() == 0) return fail("", "has points alone; surfaces can be compared");
  auto faces = Topology::make(file.points.rows(), file.triangles);
  if (!faces) return fail(faces.error());
  return Mesh{*faces, file.points};
}

/// The sources that are read, each under its name.
Result<std::vector<std::pair<std::string, ShapeSource>>> sources_of(const fs::path& path) {
  std::vector<std::pair<std::string, ShapeSource>> sources;
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    const auto shapes = shapes_in_folder(path);
    if (!shapes) return fail(shapes.error());
    for (const fs::path& file : *shapes) sources.emplace_back(file_stem(file), ShapeSource{file, {}});
  } else if (is_study_file(path)) {
    auto read = read_study(path);
    if (!read) return fail(read.error());
    for (const StudyCase& one : read->study.cases) sources.emplace_back(one.name, source_of(one));
    if (sources.empty()) return fail(path.string(), "has no cases yet; add some first");
  } else {
    sources.emplace_back("", ShapeSource{path, {}});
  }
  return sources;
}

}  // namespace

std::map<std::string, double> landmark_distances_mm(const MeshFile& a, const MeshFile& b) {
  std::map<std::string, double> distances;
  for (const Landmark& one : a.landmarks)
    for (const Landmark& other : b.landmarks)
      if (one.name == other.name) distances[one.name] = (one.position - other.position).norm();
  return distances;
}

Result<ObservedCase> compare_observers(std::string name, const MeshFile& a, const MeshFile& b) {
  const auto first = surface_of(a), second = surface_of(b);
  if (!first) return fail(name, first.error().what);
  if (!second) return fail(name, second.error().what);
  ObservedCase one;
  one.name = std::move(name);
  one.agreement = compare_meshes(*first, *second);
  one.volume_a_ml = enclosed_volume_ml(*first);
  one.volume_b_ml = enclosed_volume_ml(*second);
  one.landmarks_mm = landmark_distances_mm(a, b);
  const auto met = [](const std::string& who, const Mesh& mesh) {
    return Meeting{who, bounds_of(mesh.points).diagonal().norm()};
  };
  const std::string by_first = one.name + " of the first", by_second = one.name + " of the second";
  if (one.agreement.dice < surely_met)
    if (const auto misfit = misfit_in_scan(*first, *second))
      one.warnings.push_back(misfit_sentence(*misfit, met(by_first, *first), met(by_second, *second)));
  for (const auto& [who, mesh] : {std::pair(by_first, &*first), std::pair(by_second, &*second)}) {
    if (const auto inward = inside_out(*mesh)) one.warnings.push_back(who + ": " + *inward);
    if (const std::string closed = closed_flat(*mesh->topology); !closed.empty())
      one.warnings.push_back(who + ": " + closed);
  }
  return one;
}

Result<ObserverRead> read_observer(const fs::path& path, Progress* progress) {
  const auto sources = sources_of(path);
  if (!sources) return fail(sources.error());
  ObserverRead read;
  for (const auto& [name, source] : *sources) {
    const auto take = [&, &called = name, &origin = source](ReadShape shape) -> Result<void> {
      if (read.shapes.contains(called))
        read.warnings.push_back(origin.file.string() + ": is a second file of the case " + called + " (left out)");
      else
        read.shapes[called] = std::move(shape.mesh);
      return {};
    };
    auto warnings = read_shapes({source}, {}, take);
    if (progress != nullptr && progress->cancelled()) return fail("", "the comparison was cancelled");
    if (!warnings && sources->size() == 1) return fail(warnings.error());
    if (!warnings)
      read.warnings.push_back(warnings.error().sentence() + " (left out)");
    else
      read.warnings.insert(read.warnings.end(), warnings->begin(), warnings->end());
  }
  if (read.shapes.empty()) return fail(path.string(), "holds no shape that could be read");
  return read;
}

Result<ObserverComparison> compare_observers(const ObservedShapes& first, const ObservedShapes& second,
                                             Progress* progress) {
  ObserverComparison comparison;
  std::vector<std::string> names;
  for (const auto& [name, shape] : first) (second.contains(name) ? names : comparison.only_first).push_back(name);
  for (const auto& [name, shape] : second)
    if (!first.contains(name)) comparison.only_second.push_back(name);
  if (names.empty()) return fail("", "have no case of the same name; name each case alike in both");
  std::vector<Result<ObservedCase>> done(names.size());
  std::atomic<std::size_t> count = 0;
  for_each_in_parallel(names.size(), [&](std::size_t k) {
    if (progress != nullptr && progress->cancelled()) return;
    done[k] = compare_observers(names[k], *first.at(names[k]), *second.at(names[k]));
    if (progress != nullptr) progress->report(static_cast<double>(++count) / static_cast<double>(names.size()));
  });
  if (progress != nullptr && progress->cancelled()) return fail("", "the comparison was cancelled");
  for (auto& one : done) {
    if (!one) return fail(one.error());
    comparison.cases.push_back(std::move(*one));
  }
  return comparison;
}

std::string observers_table(const ObserverComparison& comparison) {
  std::set<std::string> landmarks;
  for (const ObservedCase& one : comparison.cases)
    for (const auto& [name, distance] : one.landmarks_mm) landmarks.insert(name);
  std::string table = "case,dice,assd_mm,hd95_mm,hausdorff_mm,vertex_mean_mm,volume_a_ml,volume_b_ml";
  for (const std::string& name : landmarks) table += ',' + csv_field(name + " mm");
  table += '\n';
  const auto number = [&](const std::optional<double>& value) {
    char text[40];
    std::snprintf(text, sizeof text, ",%.6g", value.value_or(0));
    table += value ? text : ",";
  };
  for (const ObservedCase& one : comparison.cases) {
    table += csv_field(one.name);
    const Agreement& agreement = one.agreement;
    for (const auto& value : {std::optional(agreement.dice), std::optional(agreement.assd_mm),
                              std::optional(agreement.hd95_mm), std::optional(agreement.hausdorff_mm),
                              agreement.vertex_mean_mm, std::optional(one.volume_a_ml), std::optional(one.volume_b_ml)})
      number(value);
    for (const std::string& name : landmarks) {
      const auto there = one.landmarks_mm.find(name);
      number(there == one.landmarks_mm.end() ? std::nullopt : std::optional(there->second));
    }
    table += '\n';
  }
  return table;
}

}  // namespace homolog
