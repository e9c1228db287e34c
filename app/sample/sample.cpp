#include "app/sample/sample.h"

#include <string_view>
#include <utility>

#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/session/unsaved_cases.h"

extern "C" {
extern const unsigned char homolog_sample_image[];
extern const std::size_t homolog_sample_image_size;
extern const unsigned char homolog_sample_labels[];
extern const std::size_t homolog_sample_labels_size;
extern const unsigned char homolog_sample_cine[];
extern const std::size_t homolog_sample_cine_size;
extern const unsigned char homolog_sample_cine_labels[];
extern const std::size_t homolog_sample_cine_labels_size;
extern const unsigned char homolog_sample_end_systole[];
extern const std::size_t homolog_sample_end_systole_size;
extern const unsigned char homolog_sample_licence[];
extern const std::size_t homolog_sample_licence_size;
}

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr const char *image_name = "heart.nii.gz", *labels_name = "heart-labels.nii.gz",
                     *licence_name = "heart-licence.txt";

fs::path sample_folder() {
  return unsaved_folder() / "sample";
}

}  // namespace

Result<std::vector<fs::path>> write_sample(const fs::path& folder) {
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());
  const auto bytes = [](const unsigned char* data, std::size_t size) {
    return std::string_view(reinterpret_cast<const char*>(data), size);
  };
  const std::vector<std::pair<const char*, std::string_view>> files{
      {image_name, bytes(homolog_sample_image, homolog_sample_image_size)},
      {labels_name, bytes(homolog_sample_labels, homolog_sample_labels_size)},
      {"heart-cine.nii.gz", bytes(homolog_sample_cine, homolog_sample_cine_size)},
      {"heart-cine-labels.nii.gz", bytes(homolog_sample_cine_labels, homolog_sample_cine_labels_size)},
      {"heart-cine-end-systole-labels.nii.gz", bytes(homolog_sample_end_systole, homolog_sample_end_systole_size)},
      {licence_name, bytes(homolog_sample_licence, homolog_sample_licence_size)}};
  std::vector<fs::path> paths;
  for (const auto& [name, content] : files) {
    if (auto written = write_whole_file(folder / name, content); !written) return fail(written.error());
    paths.push_back(folder / name);
  }
  return paths;
}

OwnSample own_sample() {
  return {sample_folder() / image_name, sample_folder() / labels_name, built_in_source(Organ::ventricle)};
}

Result<void> write_own_sample() {
  if (auto made = make_folder(sample_folder(), Readers::user_alone); !made) return made;
  const auto written = write_sample(sample_folder());
  return written ? Result<void>() : fail(written.error());
}

}  // namespace homolog
