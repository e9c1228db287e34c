#include "app/editor/panels/ui_context.h"
#include "app/editor/widgets/widgets.h"

// Model help: the study's shape model completes the case. In the section Deform.

namespace homolog {

namespace {

std::string help_refusal(const UiContext& ui) {
  const auto& model = ui.state.models.made.model;
  if (!model) return "Open a study (Tab). The model of its cases then helps with this one.";
  if (model->vertices() != ui.structure()->the_template->topology->vertices())
    return "The study's shapes come from another template. Open a study of this template.";
  return {};
}

}  // namespace

void draw_model_help(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  double percent = 100 * ui.state.automatic.model_help;
  bool released = false;
  const bool changed =
      slider(theme, "Model help", percent, {0, 100, "%.0f", "%", false},
             "Moves the rest of the mesh towards what the study's other cases make likely: now, and with every pull "
             "and grab. Known vertices stay. If none is known, the mesh moves to the mean shape",
             released, help_refusal(ui));
  if (changed || released) out.send(BlendModel{percent / 100, released});
  if (ui.state.automatic.model_help <= 0 || !ui.has_shape()) return;
  const double share = known_vertices(ui.committed_shape()).mean();
  explanation(theme, format("%.0f %% of the vertices are known and stay (Correspondence, Known).", 100 * share));
}

}  // namespace homolog
