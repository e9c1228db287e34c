#include <filesystem>

#include "app/verbs/verb.h"
#include "core/base/files.h"
#include "core/catalogue/catalogue.h"
#include "core/session/unsaved_cases.h"

// The verb `sample`: one real scan with its label map, compiled in (assets/sample), so that the first minutes can
// happen on a real organ.

extern "C" {
extern const unsigned char sample_image[];
extern const std::size_t sample_image_size;
extern const unsigned char sample_labels[];
extern const std::size_t sample_labels_size;
extern const unsigned char sample_licence[];
extern const std::size_t sample_licence_size;
}

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// The image, its label map, and where they come from; written whole, over what was there.
Result<std::vector<fs::path>> write_sample(const fs::path& folder) {
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());
  const auto bytes = [](const unsigned char* data, std::size_t size) {
    return std::string_view(reinterpret_cast<const char*>(data), size);
  };
  const std::vector<std::pair<const char*, std::string_view>> files{
      {"heart.nii.gz", bytes(sample_image, sample_image_size)},
      {"heart-labels.nii.gz", bytes(sample_labels, sample_labels_size)},
      {"heart-licence.txt", bytes(sample_licence, sample_licence_size)}};
  std::vector<fs::path> paths;
  for (const auto& [name, content] : files) {
    if (auto written = write_whole_file(folder / name, content); !written) return fail(written.error());
    paths.push_back(folder / name);
  }
  return paths;
}

/// Written to a folder of the program's own and opened in the editor; says why that cannot be.
void open_sample(CommandLine& asked) {
  const fs::path folder = unsaved_folder() / "sample";
  auto made = make_folder(folder, Readers::user_alone);
  const auto paths = made ? write_sample(folder) : tl::make_unexpected(made.error());
  if (paths)
    asked.editor.files = {(*paths)[0], (*paths)[1]};
  else
    asked.run = [error = paths.error()](Progress&) -> Result<Report> { return fail(error); };
  asked.editor.template_source = built_in_source(Organ::ventricle);
}

}  // namespace

void add_sample(CLI::App& app, CommandLine& asked) {
  auto folder = std::make_shared<fs::path>("homolog-sample");
  CLI::App* verb = add_verb(app, "sample", "A real heart with its label map, in the editor or as files");
  const CLI::Option* out =
      verb->add_option("-o,--output", *folder, "Only write the files there; without a display to homolog-sample");
  verb->callback([folder, out, &asked] {
    const bool display = std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
    if (out->count() == 0 && display) return open_sample(asked);
    asked.run = [folder](Progress&) -> Result<Report> {
      const auto paths = write_sample(*folder);
      if (!paths) return fail(paths.error());
      Report report;
      for (const fs::path& path : *paths) report.values["paths"].push_back(path.string());
      return report;
    };
  });
}

}  // namespace homolog
