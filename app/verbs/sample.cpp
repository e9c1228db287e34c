#include "app/sample/sample.h"

#include <filesystem>

#include "app/verbs/verb.h"

// The verb `sample`: one real scan with its label map, compiled in (assets/sample), so that the first minutes can
// happen on a real organ.

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// Written to a folder of the program's own and opened in the editor; says why that cannot be.
void open_sample(CommandLine& asked) {
  const OwnSample sample = own_sample();
  asked.editor.files = {sample.image, sample.labels};
  asked.editor.template_source = sample.template_source;
  if (auto made = write_own_sample(); !made)
    asked.run = [error = made.error()](Progress&) -> Result<Report> { return fail(error); };
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
