#include "core/model/files/landmark_table.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include "core/base/files/files.h"
#include "core/base/text/text.h"
#include "core/model/files/model_files.h"

namespace homolog {

namespace {

/// The names of all landmarks, in the order in which the specimens first name them.
std::vector<std::string> names_of(const std::vector<Specimen>& specimens) {
  std::vector<std::string> names;
  std::set<std::string> known;
  for (const Specimen& one : specimens)
    for (const Landmark& landmark : one.landmarks)
      if (known.insert(landmark.name).second) names.push_back(landmark.name);
  return names;
}

/// Calls `write(coordinates)` for each of the names, null where the specimen lacks it.
template <class Write>
void for_each_landmark(const Specimen& specimen, LandmarkTable& table, const Write& write) {
  std::map<std::string, const Vec3*> places;
  for (const Landmark& landmark : specimen.landmarks) places[landmark.name] = &landmark.position;
  for (const std::string& name : table.landmarks) {
    const auto there = places.find(name);
    write(there == places.end() ? nullptr : there->second);
  }
  if (places.size() < table.landmarks.size()) table.lacking.push_back(specimen.name);
}

std::string coordinates(const Vec3* at, const char* between) {
  if (at == nullptr) return std::string("NA") + between + "NA" + between + "NA";
  char text[120];
  std::snprintf(text, sizeof text, "%.9g%s%.9g%s%.9g", at->x(), between, at->y(), between, at->z());
  return text;
}

}  // namespace

std::vector<Landmark> vertices_as_landmarks(const Points& points) {
  std::vector<Landmark> landmarks;
  for (Eigen::Index i = 0; i < points.rows(); ++i) landmarks.push_back({std::to_string(i), points.row(i)});
  return landmarks;
}

LandmarkTable tps_of(const std::vector<Specimen>& specimens) {
  LandmarkTable table;
  table.landmarks = names_of(specimens);
  for (const Specimen& one : specimens) {
    table.text += "LM3=" + std::to_string(table.landmarks.size()) + '\n';
    for_each_landmark(one, table, [&](const Vec3* at) { table.text += coordinates(at, " ") + '\n'; });
    table.text += "ID=" + printable(one.name) + '\n';
  }
  return table;
}

LandmarkTable csv_of(const std::vector<Specimen>& specimens) {
  LandmarkTable table;
  table.landmarks = names_of(specimens);
  table.text = "ID";
  for (const std::string& name : table.landmarks)
    for (const char* axis : {" x", " y", " z"}) table.text += ',' + csv_field(name + axis);
  table.text += '\n';
  for (const Specimen& one : specimens) {
    table.text += csv_field(one.name);
    for_each_landmark(one, table, [&](const Vec3* at) { table.text += ',' + coordinates(at, ","); });
    table.text += '\n';
  }
  return table;
}

Result<LandmarkTable> write_landmark_table(const std::vector<Specimen>& specimens, const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  if (ending != ".tps" && ending != ".csv")
    return fail(path.string(), "is not the name of a landmark table; use .tps (geomorph) or .csv (MorphoJ)");
  LandmarkTable table = ending == ".tps" ? tps_of(specimens) : csv_of(specimens);
  if (table.landmarks.empty())
    return fail(path.string(),
                "was not written: none of the shapes has a named landmark; name them in the template, "
                "or take every vertex");
  if (auto written = write_whole_file(path, table.text); !written) return fail(written.error());
  return table;
}

}  // namespace homolog
