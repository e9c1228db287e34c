#include "app/editor/window/picture_captions.h"

#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>

#include <algorithm>

#include "app/editor/interface/study_picture.h"
#include "app/editor/state/models/gallery.h"
#include "app/editor/widgets/imgui_context.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace homolog {

namespace {

/// Puts `over` on a picture of the same size; neither's colours are multiplied by alpha.
void put_over(Picture& picture, const Picture& over) {
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const unsigned above = over.rgba[i + 3], below = picture.rgba[i + 3] * (255 - above) / 255;
    const unsigned alpha = above + below;
    if (above == 0) continue;
    for (std::size_t k = i; k < i + 3; ++k)
      picture.rgba[k] = static_cast<std::uint8_t>((over.rgba[k] * above + picture.rgba[k] * below) / alpha);
    picture.rgba[i + 3] = static_cast<std::uint8_t>(alpha);
  }
}

}  // namespace

Result<void> write_captions(Picture& picture, const std::vector<PictureCaption>& captions, bool light) {
  const auto context = OffscreenContext::make();
  if (!context) return fail(context.error());
  const ImGuiOnOpenGl imgui;
  const auto width = static_cast<float>(picture.width), height = static_cast<float>(picture.height);
  float narrowest = width;
  for (const PictureCaption& caption : captions) narrowest = std::min(narrowest, caption.rect.width);
  std::vector<std::string> names;
  for (const PictureCaption& caption : captions) names.push_back(caption.name);
  const Theme theme = make_theme(caption_scale(width, narrowest));
  auto framebuffer = Framebuffer::make(picture.width, picture.height, 1);
  if (!framebuffer) return fail(framebuffer.error());
  (*framebuffer)->bind();
  glViewport(0, 0, picture.width, picture.height);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::GetIO().DisplaySize = {width, height};
  ImGui::NewFrame();
  use_palette(false, light);
  for (const PictureCaption& caption : captions) {
    draw_cell_name(*ImGui::GetBackgroundDrawList(), theme, caption.rect, caption.name, names);
    if (caption.mm_per_px > 0) draw_cell_scale(*ImGui::GetBackgroundDrawList(), theme, caption.rect, caption.mm_per_px);
  }
  use_palette(false);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  put_over(picture, (*framebuffer)->read());
  return {};
}

}  // namespace homolog
