#include "app/editor/work/template_maker.h"

#include <chrono>
#include <cstdio>
#include <utility>

#include "core/adapt/labels/choose_closing.h"

namespace homolog {

namespace {

using Clock = std::chrono::steady_clock;

std::string ml(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f ml", value);
  return text;
}

/// "1 tunnel", "2 tunnels".
std::string counted(std::size_t number, const std::string& one, const std::string& several = {}) {
  return std::to_string(number) + " " + (number == 1 ? one : several.empty() ? one + "s" : several);
}

std::vector<std::string> remarks_on(MaskTemplate& made) {
  std::vector<std::string> remarks = std::move(made.warnings);
  double islands_ml = 0;
  for (const double island : made.islands_ml) islands_ml += island;
  if (!made.islands_ml.empty())
    remarks.push_back(counted(made.islands_ml.size(), "island") + " left out, " + ml(islands_ml) + ".");
  if (made.cavities > 0)
    remarks.push_back(counted(static_cast<std::size_t>(made.cavities), "cavity", "cavities") + " filled, " +
                      ml(made.cavities_ml) + ".");
  if (!made.tunnels.empty()) remarks.push_back(counted(made.tunnels.size(), "tunnel") + " cut.");
  return remarks;
}

using Show = std::function<void(const std::string&, const Mesh&)>;

void make_tube(TemplateMaking& making, const Volume& labels, const Show& show) {
  auto made = make_tube_template(labels, making.settings.tube_options);
  if (!made) {
    making.error = made.error().sentence();
    return;
  }
  show("Rings and sectors", made->mesh);
  making.mesh = std::move(made->mesh);
  making.to_mask = made->to_mask;
  making.from_mask = made->from_mask;
  making.remarks = std::move(made->warnings);
  making.missing_share = made->missing_share;
  making.missing = missing_from(*made, making.settings.tube_options.label);
  if (!making.missing.empty())
    making.missing += ". Draw the ruler (D) from the base to the apex, and choose Axis by the ruler.";
}

void make_part(TemplateMaking& making, const Volume& labels, Progress& progress, const Show& show) {
  auto made = make_faced_template(labels, making.settings.faced, faced_options(making.settings), &progress);
  if (!made) {
    making.error = made.error().sentence();
    return;
  }
  show("Cut where the labels part", made->mesh);
  making.mesh = std::move(made->mesh);
  making.to_mask = made->to_mesh;
  making.from_mask = made->from_mesh;
  making.closing_mm = making.settings.mask.closing_mm;
  making.remarks = std::move(made->warnings);
  making.cut = std::move(made->cut);
}

void make_organ(TemplateMaking& making, const Volume& labels, Progress& progress, const Show& show) {
  MaskTemplateOptions options = making.settings.mask;
  making.closing_mm = options.closing_mm;
  if (!options.closing_mm) {
    const ClosingChoice choice = choose_template_closing(labels, options, &progress);
    if (choice.tried.size() > 1) making.closing_mm = options.closing_mm = choice.closing_mm;
  }
  auto made = make_mask_template(labels, options, &progress,
                                 [&](TemplateStage stage, const Mesh& surface) { show(stage_name(stage), surface); });
  if (!made) {
    making.error = made.error().sentence();
    return;
  }
  making.to_mask = made->to_mask;
  making.from_mask = made->from_mask;
  making.remarks = remarks_on(*made);
  if (making.closing_mm && !making.settings.mask.closing_mm) {
    char text[80];
    std::snprintf(text, sizeof text, "Closing %.1f mm, chosen by trying it on the label.", *making.closing_mm);
    making.remarks.emplace_back(text);
  }
  making.cut = std::move(made->cut);
  making.mesh = std::move(made->mesh);
}

/// Fills what the settings ask for: the mesh with its figures, or the error.
void make(TemplateMaking& making, const Volume& labels, Progress& progress, const Show& show) {
  if (making.settings.tube)
    make_tube(making, labels, show);
  else if (making.settings.part)
    make_part(making, labels, progress, show);
  else
    make_organ(making, labels, progress, show);
  if (making.mesh) making.quality = mesh_quality(*making.mesh);
}

}  // namespace

FacedTemplateOptions faced_options(const TemplateSettings& settings) {
  return {settings.mask.label, settings.mask.frame, settings.mask.vertices, settings.mask.closing_mm};
}

void TemplateMaker::start(std::shared_ptr<const Volume> labels, std::string source, const TemplateSettings& settings,
                          FacedNames faced) {
  if (busy()) return;
  TemplateMaking making;
  making.settings = settings;
  making.source = std::move(source);
  making.faced = std::move(faced);
  now_ = std::make_shared<const TemplateMaking>(making);
  stages_ = std::make_shared<Stages>();
  worker_.start(making.source,
                [labels = std::move(labels), begun = making, stages = stages_,
                 wake = wake_](Progress& progress) -> Result<std::shared_ptr<const TemplateMaking>> {
                  const auto begin = Clock::now();
                  TemplateMaking now = begun;
                  make(now, *labels, progress, [&](const std::string& name, const Mesh& surface) {
                    now.stages.push_back({name, std::make_shared<const Mesh>(surface),
                                          std::chrono::duration<double>(Clock::now() - begin).count()});
                    stages->put(std::make_shared<const TemplateMaking>(now));
                    wake();
                  });
                  now.done = true;
                  return std::make_shared<const TemplateMaking>(std::move(now));
                });
}

void TemplateMaker::cancel() {
  if (!busy()) return;
  worker_.cancel();
  if (!made_.empty()) return now_.reset();
  auto stopped = std::make_shared<TemplateMaking>(*now_);
  stopped->done = true;
  now_ = std::move(stopped);
}

bool TemplateMaker::update() {
  if (!busy()) return false;
  auto stage = stages_->take();
  if (stage) now_ = std::move(*stage);
  auto done = worker_.take();
  if (!done) return stage.has_value();
  if (!*done) {
    auto failed = std::make_shared<TemplateMaking>(*now_);
    failed->done = true;
    failed->error = done->error().sentence();
    now_ = std::move(failed);
  } else if ((**done)->mesh) {
    if (!made_.empty() && !made_.back()->stages.empty()) {
      // Of those before only what undo shows is kept.
      auto last = std::make_shared<TemplateMaking>(*made_.back());
      last->stages.erase(last->stages.begin(), last->stages.end() - 1);
      made_.back() = std::move(last);
    }
    made_.push_back(std::move(**done));
    now_.reset();
  } else {
    now_ = std::move(**done);
  }
  return true;
}

void TemplateMaker::undo() {
  if (!can_undo()) return;
  if (now_)
    now_.reset();
  else
    made_.pop_back();
}

void TemplateMaker::forget() {
  if (busy()) return;
  now_.reset();
  made_.clear();
}

void TemplateMaker::finish() {
  worker_.finish();
  update();
}

}  // namespace homolog
