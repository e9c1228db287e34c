#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/outcomes.h"
#include "app/editor/work/mailbox.h"
#include "app/editor/work/worker.h"
#include "core/adapt/labels/faced_template.h"
#include "core/mesh/mesh_quality.h"
#include "core/template_making/mask_template.h"
#include "core/template_making/tube_template.h"

namespace homolog {

/// How a template of a part of a surface is made.
FacedTemplateOptions faced_options(const TemplateSettings& settings);

/// Makes templates beside the window, one at a time. Called from the window's thread only.
class TemplateMaker {
 public:
  /// `wake` is called from the thread after each stage.
  explicit TemplateMaker(std::function<void()> wake) : wake_(wake), worker_(std::move(wake)) {}

  /// `faced`: what settings.faced is called.
  void start(std::shared_ptr<const Volume> labels, std::string source, const TemplateSettings& settings,
             FacedNames faced = {});
  void cancel();
  bool busy() const { return now_ && !now_->done; }
  double fraction() const { return worker_.fraction(); }
  /// Takes in the stages done since the last call; true where there are some.
  bool update();
  /// The making that runs, or the last one (a cancelled making leaves the one before it); null before the first.
  std::shared_ptr<const TemplateMaking> latest() const { return now_ ? now_ : made_.empty() ? nullptr : made_.back(); }
  /// Goes back to the template made before; does nothing where there is none.
  void undo();
  /// Lets go of everything made.
  void forget();
  bool can_undo() const { return !busy() && made_.size() > (now_ ? 0 : 1); }
  /// Waits until it is made.
  void finish();

 private:
  using Stages = Mailbox<std::shared_ptr<const TemplateMaking>>;
  std::function<void()> wake_;
  std::vector<std::shared_ptr<const TemplateMaking>> made_;  ///< with a mesh each, the latest last
  std::shared_ptr<const TemplateMaking> now_;  ///< the one that goes on, or came to nothing; null: neither
  std::shared_ptr<Stages> stages_;             ///< the stages of what is being made
  Worker<std::shared_ptr<const TemplateMaking>> worker_;
};

}  // namespace homolog
