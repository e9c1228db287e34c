#include "app/editor/work/template_maker.h"

#include <chrono>
#include <cstdio>
#include <mutex>
#include <new>
#include <utility>

namespace homolog {

namespace {

using Clock = std::chrono::steady_clock;

std::string ml(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f ml", value);
  return text;
}

std::vector<std::string> remarks_on(MaskTemplate& made) {
  std::vector<std::string> remarks = std::move(made.warnings);
  double islands_ml = 0;
  for (const double island : made.islands_ml) islands_ml += island;
  if (!made.islands_ml.empty())
    remarks.push_back(std::to_string(made.islands_ml.size()) + " islands left out, " + ml(islands_ml) + ".");
  if (made.cavities > 0)
    remarks.push_back(std::to_string(made.cavities) + " cavities filled, " + ml(made.cavities_ml) + ".");
  if (!made.tunnels.empty()) remarks.push_back(std::to_string(made.tunnels.size()) + " tunnels cut.");
  return remarks;
}

/// Fills what the settings ask for: the mesh with its figures, or the error.
void make(TemplateMaking& making, const Volume& labels, Progress& progress,
          const std::function<void(const std::string&, const Mesh&)>& show) {
  if (making.settings.tube) {
    auto made = make_tube_template(labels, making.settings.tube_options);
    if (made) {
      show("Rings and sectors", made->mesh);
      making.mesh = std::move(made->mesh);
      making.to_mask = made->to_mask;
      making.from_mask = made->from_mask;
      making.remarks = std::move(made->warnings);
    } else {
      making.error = made.error().sentence();
    }
  } else {
    auto made = make_mask_template(labels, making.settings.mask, &progress,
                                   [&](TemplateStage stage, const Mesh& surface) { show(stage_name(stage), surface); });
    if (made) {
      making.to_mask = made->to_mask;
      making.from_mask = made->from_mask;
      making.remarks = remarks_on(*made);
      making.mesh = std::move(made->mesh);
    } else {
      making.error = made.error().sentence();
    }
  }
  if (making.mesh) making.quality = mesh_quality(*making.mesh);
}

}  // namespace

/// Where the thread leaves what it has; each state is a value of its own.
struct TemplateMaker::Box {
  std::mutex mutex;
  std::shared_ptr<const TemplateMaking> latest;

  void put(const TemplateMaking& making) {
    auto copy = std::make_shared<const TemplateMaking>(making);
    put_back(std::move(copy));
  }
  void put_back(std::shared_ptr<const TemplateMaking> making) {
    const std::lock_guard lock(mutex);
    latest = std::move(making);
  }
};

TemplateMaker::~TemplateMaker() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

void TemplateMaker::cancel() {
  if (progress_) progress_->cancel();
}

std::shared_ptr<const TemplateMaking> TemplateMaker::latest() const {
  if (!box_) return nullptr;
  const std::lock_guard lock(box_->mutex);
  return box_->latest;
}

bool TemplateMaker::busy() const {
  const auto making = latest();
  return making && !making->done;
}

bool TemplateMaker::can_undo() const {
  return !busy() && !before_.empty() && !(before_.size() == 1 && before_.back() == latest());
}

void TemplateMaker::undo() {
  if (!can_undo()) return;
  if (before_.back() == latest()) before_.pop_back();  // a cancelled making has come back to it
  const std::lock_guard lock(box_->mutex);
  box_->latest = before_.back();
  before_.pop_back();
}

void TemplateMaker::forget() {
  if (busy()) return;
  box_.reset();
  before_.clear();
}

void TemplateMaker::start(std::shared_ptr<const Volume> labels, std::string source, const TemplateSettings& settings) {
  if (busy()) return;
  if (thread_.joinable()) thread_.join();
  const auto last = latest();
  if (last && last->mesh && (before_.empty() || before_.back() != last)) before_.push_back(last);
  TemplateMaking making;
  making.settings = settings;
  making.source = std::move(source);
  progress_ = std::make_shared<Progress>();
  box_ = std::make_shared<Box>();
  box_->put(making);
  thread_ = std::thread([labels = std::move(labels), making = std::move(making), progress = progress_, box = box_,
                         wake = wake_, last]() mutable {
    const auto begin = Clock::now();
    const auto show = [&](const std::string& name, const Mesh& surface) {
      making.stages.push_back(
          {name, std::make_shared<const Mesh>(surface), std::chrono::duration<double>(Clock::now() - begin).count()});
      box->put(making);
      wake();
    };
    try {
      make(making, *labels, *progress, show);
    } catch (const std::bad_alloc&) {
      making.mesh.reset();
      making.error = "the template needs more memory than there is; close other programs, or ask for fewer vertices";
    }
    making.done = true;
    if (progress->cancelled() && last && last->mesh)
      box->put_back(last);
    else
      box->put(making);
    wake();
  });
}

}  // namespace homolog
