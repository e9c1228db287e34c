#include "app/editor/panels/ui_context.h"
#include "app/editor/widgets/widgets.h"

// What the shape model of a study makes of the case, in the section Deform.

namespace homolog {

namespace {

std::string help_refusal(const UiContext& ui) {
  const auto& model = ui.state.models.model;
  if (!model) return "Open a study (Tab): the model of its cases helps with the next one.";
  if (model->landmarks() != ui.document().reference->topology->vertices())
    return "The study's shapes come from another template.";
  return {};
}

}  // namespace

void draw_model_help(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  double percent = 100 * ui.state.model_help;
  bool released = false;
  const bool changed = slider(
      theme, "Model help", percent, {0, 100, "%.0f", "%", false},
      "What is confirmed or was moved by hand stays; the rest goes this far towards what the model of the study's "
      "other cases expects there, now and with every pull and grab. With nothing known it is the model's mean",
      released, help_refusal(ui));
  if (changed || released) out.send(BlendModel{percent / 100, released});
  if (ui.state.model_help <= 0 || !ui.has_shape()) return;
  const double share = known_landmarks(ui.committed_shape()).mean();
  explanation(theme, format("%.0f %% of the landmarks are known and stay (Correspondence: Known).", 100 * share));
}

}  // namespace homolog
