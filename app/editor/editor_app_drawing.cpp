#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>

#include <algorithm>

#include "app/editor/editor_app.h"
#include "app/editor/widgets/plots.h"
#include "app/editor/window/view_overlay.h"

// Frames of the window, and pictures of it.

namespace homolog {

void EditorApp::draw(int width_px, int height_px, double frames_per_second) {
  layout_ = make_layout(static_cast<float>(width_px), static_cast<float>(height_px), scale_,
                        {state_.maximised, state_.preferences.panel_open, state_.models.shown});
  if (!state_.models.shown && std::exchange(fit_wanted_, false)) {
    fit_views(state_, *displayed_, layout_);
    show_repair();
  }
  follow_layout(state_, layout_);
  if (pictures_) draw_pictures(width_px, height_px);
  ImGui::NewFrame();
  draw_interface(ui_context(state_, frames_per_second), out_);
  ImGui::Render();
  if (pictures_) ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

/// What the views and the gallery show, and the background, into the framebuffer that is bound.
void EditorApp::draw_pictures(int width_px, int height_px) {
  GLint target_framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target_framebuffer);
  const SceneBuilder::Input input = scene_input(state_);
  if (!state_.models.shown) scenes_.update(input);
  std::array<const Framebuffer*, 4> views{};
  for (const ViewKind kind : all_views) {
    const RectPx& rect = layout_.image(kind);
    if (rect.width < 1 || rect.height < 1) continue;
    const Target target{0, 0, static_cast<int>(rect.width), static_cast<int>(rect.height), scale_};
    const Scene scene = scenes_.scene(input, kind);
    views[index_of(kind)] =
        kind == ViewKind::space
            ? pictures_->space(scene, state_.camera, target, state_.drag.has_value())
            : pictures_->slice(kind, scene, slice_view(state_, kind, geometry_of(*displayed_)), target);
  }
  const ModelsLayout models = models_layout(layout_);
  thumbnails_left_ = state_.models.shown && thumbnails_.draw(state_.models, scale_, pictures_->renderer());
  if (state_.models.shown) gallery_.draw(state_.models, models, scale_, pictures_->renderer());
  for (auto error : {pictures_->take_error(), gallery_.take_error()})
    if (!error.empty()) add_notice(state_, std::move(error));
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target_framebuffer));
  glViewport(0, 0, width_px, height_px);
  glDisable(GL_SCISSOR_TEST);
  glClearColor(0.055f, 0.059f, 0.067f, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  for (const ViewKind kind : all_views) {
    const RectPx& rect = layout_.image(kind);
    if (const Framebuffer* view = views[index_of(kind)])
      view->copy_to(static_cast<int>(rect.x), height_px - static_cast<int>(rect.y + rect.height));
  }
  if (state_.models.shown) gallery_.copy(models, height_px);

  ImGui_ImplOpenGL3_NewFrame();
}

Result<Picture> EditorApp::picture(const PictureOptions& options) {
  if (!pictures_) return fail("", "This window draws nothing, so there is no picture of it.");
  auto framebuffer = Framebuffer::make(options.width, options.height, options.view == ViewKind::space ? 4 : 1);
  if (!framebuffer) return fail(framebuffer.error());
  (*framebuffer)->bind();
  const Layout on_screen = layout_;
  if (options.view) {
    draw_view_picture(options);
  } else {
    ImGui::GetIO().DisplaySize = {static_cast<float>(options.width), static_cast<float>(options.height)};
    // What the program has to say just now is no part of the picture.
    auto notices = std::exchange(state_.notices, {});
    const Hints hints = std::exchange(state_.preferences.hints, {true, true, true});
    draw(options.width, options.height, 0);
    state_.preferences.hints = hints;
    state_.notices.insert(state_.notices.begin(), notices.begin(), notices.end());
  }
  layout_ = on_screen;  // the pointer is still in the window
  return (*framebuffer)->read();
}

void EditorApp::draw_view_picture(const PictureOptions& options) {
  const ViewKind kind = *options.view;
  const auto width = static_cast<float>(options.width), height = static_cast<float>(options.height);
  // As large as the view is on the screen; one that is hidden there as it would be beside the others.
  RectPx rect = layout_.image(kind);
  if (rect.width < 1 || rect.height < 1)
    rect =
        make_layout(layout_.top_bar.width, layout_.status_line.y + layout_.status_line.height, scale_, {}).image(kind);
  const double smaller = std::max(rect.width / width, rect.height / height);
  EditorState shown = state_;
  shown.hover.reset();
  if (kind != ViewKind::space) shown.slices[index_of(kind)].mm_per_px *= smaller;
  const Target target{0, 0, options.width, options.height, static_cast<float>(scale_ / smaller)};
  const SceneBuilder::Input input = scene_input(shown);
  Scene scene = scenes_.scene(input, kind);
  const bool transparent = options.transparent && kind == ViewKind::space;
  if (transparent) scene.background = {0, 0, 0, 0};
  const auto drawn = kind == ViewKind::space
                         ? pictures_->renderer().draw(scene, shown.camera, target)
                         : pictures_->renderer().draw(scene, slice_view(shown, kind, geometry_of(*displayed_)), target);
  if (!drawn) add_notice(state_, drawn.error().sentence());  // the rest of the scene is there all the same
  if (transparent) return;

  // Letters, scale bar, landmarks and ruler: without them nobody can tell the sides of a slice.
  layout_.images[index_of(kind)] = {0, 0, width, height};
  shown.preferences.hints = {true, true, true};
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::GetIO().DisplaySize = {width, height};
  ImGui::NewFrame();
  const UiContext ui = ui_context(shown, 0);
  draw_view_overlay(ui, kind, *ImGui::GetBackgroundDrawList());
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

Result<Picture> EditorApp::plots_picture(const PictureOptions& options) {
  if (!pictures_) return fail("", "This window draws nothing, so there is no picture of it.");
  auto framebuffer = Framebuffer::make(options.width, options.height, 1);
  if (!framebuffer) return fail(framebuffer.error());
  (*framebuffer)->bind();
  glViewport(0, 0, options.width, options.height);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::GetIO().DisplaySize = {static_cast<float>(options.width), static_cast<float>(options.height)};
  ImGui::NewFrame();
  draw_plots_picture(*theme_, *state_.models.evaluation, options, *ImGui::GetBackgroundDrawList());
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return (*framebuffer)->read();
}

}  // namespace homolog
