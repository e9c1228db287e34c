#include "app/editor/window/editor_picture.h"

#include <backends/imgui_impl_opengl3.h>

#include "app/editor/widgets/imgui_context.h"
#include "app/editor/window/editor_app.h"

namespace homolog {

Result<Picture> editor_picture(EditSession session, const EditorPictureOptions& options) {
  const ImGuiOnOpenGl imgui;
  EditorApp app([] {});
  if (auto started = app.start_drawing(options.scale); !started) return fail(started.error());
  app.start_session(std::move(session));
  auto framebuffer = Framebuffer::make(options.width_px, options.height_px, 1);
  if (!framebuffer) return fail(framebuffer.error());
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(options.width_px), static_cast<float>(options.height_px)};
  io.DeltaTime = 1.0f / 60;
  // ImGui lays out what it has not seen before in the first frames; the third is as it stays.
  constexpr int frames = 3;
  DrawnItems drawn;
  for (int frame = 0; frame < frames || app.draws_on(); ++frame) {
    (*framebuffer)->bind();
    drawn.clear();
    app.draw(options.width_px, options.height_px, 0);
    if (frame == 0) {
      if (options.arrange) options.arrange(app.state());
      if (options.preview) app.preview(*options.preview);
      app.settle();
      if (options.models) {
        app.send(*options.models);
        app.settle();
      }
    }
  }
  if (options.items != nullptr) *options.items = drawn.items();
  if (options.part) return app.picture(*options.part);
  return (*framebuffer)->read();
}

}  // namespace homolog
