#include "core/phantom/phantom_files.h"

#include "core/base/files/files.h"
#include "core/mesh/files/landmark_io.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/volume_io.h"

namespace homolog {
namespace fs = std::filesystem;

Result<std::vector<fs::path>> write_phantom(Organ organ, int number, const fs::path& folder) {
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());

  const PhantomSubject subject = make_phantom(organ, number);
  const std::string stem = std::string(organ_name(organ)) + "-" + std::to_string(number);
  std::vector<fs::path> paths;
  Result<void> written;
  const auto path_of = [&](const std::string& ending) { return paths.emplace_back(folder / (stem + ending)); };

  written = write_volume(subject.image, path_of("-image.nii.gz"));
  if (written) written = write_volume(subject.label_map, path_of("-labels.nii.gz"));
  for (std::size_t frame = 0; written && frame < subject.truth.size(); ++frame) {
    const std::string two_digits = std::to_string(100 + frame).substr(1);
    written = write_mesh_file(subject.truth[frame],
                              path_of(subject.truth.size() == 1 ? "-truth.ply" : "-truth-" + two_digits + ".ply"));
  }
  if (written) written = write_landmarks(subject.landmarks, path_of("-landmarks.mrk.json"));
  if (!written) return fail(written.error());
  return paths;
}

Result<std::vector<fs::path>> write_spine_phantom(int number, const fs::path& folder) {
  const std::string stem = "spine-" + std::to_string(number);
  const fs::path truth = folder / (stem + "-truth");
  const auto made = ResultFolder::make(truth);
  if (!made) return fail(made.error());

  PhantomScene scene = make_spine_phantom(number);
  std::vector<fs::path> paths;
  const auto path_of = [&](const std::string& ending) { return paths.emplace_back(folder / (stem + ending)); };
  Result<void> written = write_volume(scene.image, path_of("-image.nii.gz"));
  const VolumeRead map{std::move(scene.label_map), {}, std::move(scene.segmentation), {}};
  if (written) written = write_segmentation(map, path_of("-labels.nii.gz"));
  paths.push_back(folder / (stem + "-labels.json"));
  std::vector<Landmark> landmarks;
  for (const SceneStructure& one : scene.structures) {
    if (written) written = write_mesh_file(one.truth, paths.emplace_back(truth / (one.name + ".ply")));
    for (const Landmark& landmark : one.truth.landmarks)
      landmarks.push_back({one.name + " " + landmark.name, landmark.position});
  }
  if (written) written = write_landmarks(landmarks, path_of("-landmarks.mrk.json"));
  if (!written) return fail(written.error());
  return paths;
}

}  // namespace homolog
