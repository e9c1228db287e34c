#include <algorithm>

#include "app/pictures/pictures.h"
#include "app/verbs/describe.h"
#include "app/verbs/record.h"
#include "app/verbs/report/report_content.h"
#include "app/verbs/report/report_page.h"
#include "app/verbs/verbs.h"
#include "core/base/files/file_record.h"
#include "core/base/files/files.h"
#include "core/base/pictures/picture_module.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/model/files/statismo.h"

// The verb `report`: a model as one page to read and to send.

namespace homolog {

namespace {

/// The bytes of a picture of the first modes (PNG). Errors: no OpenGL, no picture module.
Result<std::string> picture_of_modes(const ShapeModel& model) {
  constexpr int rows = 3, cell_px = 320;
  MontageOptions options;
  options.width_px = 3 * cell_px;
  options.height_px = static_cast<int>(std::min<Eigen::Index>(rows, model.modes())) * cell_px;
  options.transparent = true;
  const auto made = modes_picture(model, rows, options);
  if (!made) return fail(made.error());
  const auto module = picture_module();
  if (!module) return fail(module.error());
  const auto bytes = (*module)->encode(made->picture, "modes.png");
  if (!bytes) return fail(bytes.error());
  return std::string(bytes->begin(), bytes->end());
}

Result<Report> write_report(const ReportVerb& verb, const GivenCommand& command, Progress& progress) {
  if (auto there = check_folder_of(verb.out); !there) return fail(there.error());
  auto content = page_content(verb, progress);
  if (!content) return fail(content.error());
  progress.part(0.9, 1);
  Report report;
  report.warnings = content->warnings;
  const auto picture = picture_of_modes(content->model);
  if (!picture)
    report.warnings.push_back("the page has no picture for browsers without WebGL: " + picture.error().sentence());
  const std::string page = report_page(*content, picture.value_or(""));
  if (progress.cancelled()) return fail("", "cancelled");
  if (auto written = write_whole_file(verb.out, page); !written) return fail(written.error());
  if (!verb.without_names) {  // a record has the names of the inputs
    const auto record = record_of(command, progress);
    const auto added = record ? add_record(verb.out, *record) : fail(record.error());
    if (!added) return fail(added.error());
  }
  const auto bytes = size_of_file(verb.out);
  if (!bytes) return fail(bytes.error());
  constexpr std::size_t large_bytes = 10'000'000;
  if (*bytes > large_bytes)
    report.warnings.push_back(
        "the page has " + std::to_string(*bytes / 1'000'000) +
        " MB and opens slowly; show fewer modes with --modes, or make the model of coarser meshes");
  const auto left_out = std::ssize(content->cases) - content->cases_in_model();
  report.values = {{"cases", content->cases_in_model()},
                   {"left_out", left_out},
                   {"vertices", content->model.mean.size() / 3},
                   {"modes", content->model.modes()},
                   {"groups", content->groups()},
                   {"picture", picture.has_value()},
                   {"bytes", *bytes}};
  if (content->recipe) report.values["measurements"] = content->recipe->measurements.size();
  return report;
}

}  // namespace

Result<std::vector<std::string>> write_study_report(const std::filesystem::path& study, Alignment alignment,
                                                    const std::string& the_template, const std::filesystem::path& out,
                                                    Progress& progress) {
  ReportVerb verb;
  verb.training.files = {study};
  verb.training.keep_scale = alignment == Alignment::rigid;
  verb.training.no_align = alignment == Alignment::none;
  verb.out = out;
  GivenCommand command{"report", {{"SHAPE", {study.string()}}}};
  if (verb.training.keep_scale) command.options.push_back({"--keep-scale", {}});
  if (verb.training.no_align) command.options.push_back({"--no-align", {}});
  if (!the_template.empty()) {
    verb.the_template = the_template;
    verb.recipe = recipe_of_template(the_template);
    command.options.push_back({"--recipe", {verb.recipe}});
    command.options.push_back({"--template", {the_template}});
  }
  auto written = write_report(verb, command, progress);
  if (!written) return fail(written.error());
  return std::move(written->warnings);
}

namespace {

bool reports_on_model(const ReportVerb& verb) {
  return verb.training.files.size() == 1 && is_model_name(verb.training.files.front());
}

}  // namespace

void add_report(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<ReportVerb>();
  CLI::App* verb = add_verb(app, "report", "A model as one page (.html) that a browser shows without a network");
  add_training_options(*verb, options->training);
  verb->get_option("SHAPE")->description(
      "A study (.study.json), a model (.h5, .h5.json), or shapes in correspondence and folders of them");
  verb->add_option("-o,--output", options->out, "The page to write (.html)")
      ->required()
      ->check([](const std::string& text) {
        const std::string ending = lower_case(std::filesystem::path(text).extension().string());
        return ending == ".html" || ending == ".htm" ? std::string() : text + " is not the name of a page; use .html";
      });
  verb->add_option("--title", options->title, "What the page is called (default: the name of the first file)");
  verb->add_flag("--without-names", options->without_names,
                 "Number the cases, since their names may be those of patients");
  verb->add_option("--modes", options->modes,
                   "How many modes it shows (default: those that hold 95 % of the variance, at most 10)")
      ->check(CLI::Range(1, 100));
  verb->add_option("--recipe", options->recipe,
                   "What to measure along the first modes: a file (.json), or " + listed(shipped_recipes(), ", ") +
                       "; without it that of the template");
  verb->add_option("--template", options->the_template,
                   "Lends its landmarks and regions to the model for that; without it the first shape does");
  verb->add_option("--left-out", options->left_out,
                   "A table (.csv) of cases that are not among the shapes, as of fits that failed: the name in the "
                   "column name, case or id, the reason in failed or reason; a row without a reason counts as no such "
                   "case");
  verb->add_option("--samples", options->samples, "How many random shapes to draw for specificity")
      ->check(CLI::Range(1, 1000000));
  verb->callback([options, verb, &asked] {
    if (reports_on_model(*options))
      for (const char* option : {"--keep-scale", "--no-align", "--all-frames", "--flip-mirrored", "--group",
                                 "--without-doubtful", "--structures", "--samples"})
        refuse_without_effect(*verb, option, "shapes");
    check_training_options(options->training);
    if (options->recipe.empty() && !options->the_template.empty())
      options->recipe = recipe_of_template(options->the_template);
    asked.run = [options, command = given_command(*verb)](Progress& progress) {
      return write_report(*options, command, progress);
    };
  });
}

}  // namespace homolog
