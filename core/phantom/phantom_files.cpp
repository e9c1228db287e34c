#include "core/phantom/phantom_files.h"

#include "core/base/files.h"
#include "core/mesh/landmark_io.h"
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

}  // namespace homolog
