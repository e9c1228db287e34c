#include <algorithm>
#include <filesystem>

#include "app/verbs/verb.h"
#include "core/case/case_file.h"
#include "core/measure/compare.h"
#include "core/mesh/isosurface.h"
#include "core/study/scripted_user.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct StudyUser {
  std::string template_source;
  fs::path mask, image, out;
  int label = 0;
  int most_pulls = 120;
  bool mirror = false;
};

Result<Report> study_user(const StudyUser& options, Progress& progress) {
  auto reference = load_template(options.template_source);
  if (!reference) return fail(reference.error());
  VolumeReadOptions read_options;
  read_options.progress = &progress;
  auto mask = read_volume(options.mask, read_options);
  if (!mask) return fail(mask.error());
  const auto label = options.label != 0 ? Result<int>(options.label) : only_label(mask->volume);
  if (!label) return fail(options.mask.string(), label.error().what);
  const auto target = mask_surface(mask->volume, *label);
  if (!target) return fail(options.mask.string(), target.error().what);

  std::shared_ptr<const Volume> image;
  if (!options.image.empty()) {
    auto read = read_volume(options.image, read_options);
    if (!read) return fail(read.error());
    image = std::make_shared<const Volume>(std::move(read->volume));
  }
  auto session = create_case(new_document(options.image.string(), image, *reference), options.out);
  if (!session) return fail(session.error());
  if (options.mirror) {
    if (auto mirrored = session->apply(MirrorTemplate{}); !mirrored) return fail(mirrored.error());
  }
  if (auto placed = place_on(*session, *target); !placed) return fail(placed.error());
  ScriptedUserOptions user;
  user.visible_mm = mask->volume.geometry.spacing_mm.minCoeff() / 2;
  user.most_pulls = options.most_pulls;
  user.progress = &progress;
  const auto result = pull_to_target(*session, *target, user);
  if (!result) return fail(options.out.string(), result.error().what);
  const auto agreement = compare_with_mask(session->document().mesh(), mask->volume, *label);
  if (!agreement) return fail(options.mask.string(), agreement.error().what);
  return Report{{{"case", options.out.string()},
                 {"pulls", result->pulls},
                 {"largest_deviation_mm", result->largest_deviation_mm},
                 {"assd_mm", agreement->assd_mm},
                 {"dice", agreement->dice}},
                mask->warnings};
}

}  // namespace

void add_study(CLI::App& app, VerbRun& run) {
  CLI::App* study = app.add_subcommand("study", "Experiments with a scripted user");
  study->require_subcommand(1);
  auto options = std::make_shared<StudyUser>();
  CLI::App* verb =
      add_verb(*study, "user", "A scripted user adapts a template to a mask by boundary pulls: writes a case file");
  verb->add_option("TEMPLATE", options->template_source, "Template mesh, or built-in:kidney, built-in:vertebra …")
      ->required();
  verb->add_option("--mask", options->mask, "The label map to adapt to")->required();
  verb->add_option("--label", options->label, "Which label of the mask");
  verb->add_option("--image", options->image, "The volume that the case is for");
  verb->add_option("--pulls", options->most_pulls, "At most this many pulls")->check(CLI::Range(0, 10000));
  verb->add_flag("--mirror", options->mirror, "Start from the template of the other side");
  verb->add_option("-o,--output", options->out, "The case file to write")->required();
  verb->callback([options, &run] { run = [options](Progress& progress) { return study_user(*options, progress); }; });
}

}  // namespace homolog
