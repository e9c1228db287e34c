#include "app/verbs/case_landmarks.h"

#include <algorithm>
#include <set>

#include "core/base/files/file_record.h"
#include "core/base/files/file_stem.h"
#include "core/base/text/in_quotes.h"
#include "core/mesh/files/landmark_io.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// Of two landmarks' distance in the template: so near to each other they were placed by mistake.
constexpr double one_place_share = 1e-4;

fs::path landmark_file_of(const LandmarkFiles& files, const fs::path& path) {
  return fs::is_directory(files.given) ? landmark_file_in(files.given, case_name_of(path)) : files.given;
}

/// Takes out landmarks that lie at one place with another, since nobody knows which of them is right; gives their
/// names.
std::vector<std::string> take_coincident(const Template& the_template, std::map<std::string, Vec3>& places) {
  std::map<std::string, Vec3> own;
  for (const Landmark& landmark : the_template.landmarks) own[landmark.name] = landmark.position;
  std::vector<std::string> coincident;
  for (const auto& [one, at] : places)
    if (std::any_of(places.begin(), places.end(), [&, one = one, at = at](const auto& other) {
          return other.first != one &&
                 (other.second - at).norm() <= one_place_share * (own.at(other.first) - own.at(one)).norm();
        }))
      coincident.push_back(one);
  for (const std::string& name : coincident) places.erase(name);
  return coincident;
}

}  // namespace

std::string case_name_of(const fs::path& path) {
  return file_stem(path);
}

fs::path landmark_file_in(const fs::path& folder, const std::string& case_name) {
  for (const std::string_view extension : landmark_extensions)
    if (const fs::path file = folder / (case_name + std::string(extension)); fs::exists(file)) return file;
  return {};
}

Result<CaseLandmarks> read_case_landmarks(const LandmarkFiles& files, const Template& the_template,
                                          const fs::path& path) {
  CaseLandmarks landmarks;
  if (files.given.empty()) return landmarks;
  const fs::path file = landmark_file_of(files, path);
  if (file.empty()) {
    const std::string what =
        "has no landmark file in " + files.given.string() + " (" + case_name_of(path) + ".mrk.json, .fcsv or .json)";
    if (!files.several) return fail(path.string(), what + "; put one there, or name the file itself");
    landmarks.warnings.push_back(what + ", so it was fitted without landmarks");
    return landmarks;
  }
  const auto read = read_landmarks(file);
  if (!read) return fail(read.error());
  if (read->empty()) {
    if (!files.several) return fail(file.string(), "holds no points; place the landmarks and save it again");
    landmarks.warnings.push_back("its landmark file holds no points, so it was fitted without landmarks");
    return landmarks;
  }
  std::vector<std::string> known, unknown;
  for (const Landmark& landmark : the_template.landmarks) known.push_back(landmark.name);
  for (const Landmark& landmark : *read) {
    if (std::find(known.begin(), known.end(), landmark.name) == known.end())
      unknown.push_back(landmark.name);
    else
      landmarks.places[landmark.name] = landmark.position;
  }
  if (const auto names = take_coincident(the_template, landmarks.places); !names.empty()) {
    const std::string what = "has " + in_quotes(names) + " at one place";
    if (!files.several) return fail(file.string(), what + "; place each where it belongs, or keep only one of them");
    landmarks.warnings.push_back("its landmark file " + what + "; they were left out");
  }
  if (unknown.empty()) return landmarks;
  const std::string what = "names " + in_quotes(unknown) + ", which the template " + files.template_source +
                           " lacks; " + (known.empty() ? "it has no landmarks" : "it has " + in_quotes(known));
  if (!files.several) return fail(file.string(), what + "; rename each as in the template, or leave it out");
  landmarks.warnings.push_back("its landmark file " + what + "; they were left out");
  return landmarks;
}

std::vector<std::string> landmarks_of_no_case(const LandmarkFiles& files, const std::vector<fs::path>& cases) {
  if (!fs::is_directory(files.given)) return {};
  std::set<fs::path> used;
  for (const fs::path& path : cases) used.insert(landmark_file_of(files, path));
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(files.given, error))
    if (is_landmark_name(entry.path()) && !is_record_file(entry.path()) && !used.contains(entry.path()))
      names.push_back(entry.path().filename().string());
  if (names.empty()) return {};
  std::sort(names.begin(), names.end());
  const std::size_t all = names.size(), most = 5;
  names.resize(std::min(all, most));
  return {files.given.string() + ": holds " + in_quotes(names) +
          (all > most ? " and " + std::to_string(all - most) + " more" : "") +
          ", which belongs to no case; give each file its case's name"};
}

}  // namespace homolog
