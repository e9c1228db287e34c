#pragma once

#include <functional>
#include <optional>
#include <set>

#include "app/editor/drawing/gallery_pictures.h"
#include "app/editor/drawing/view_pictures.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/scene/scene_builder.h"
#include "app/editor/update/editing.h"

namespace homolog {

/// Draws the editor into the framebuffer that is bound: the window, and pictures of it. Without start() it lays out the
/// interface and draws nothing; then ImGui's context alone is needed, else a current OpenGL context too. Both must
/// outlive the drawing calls.
class Drawing : public PictureSource {
 public:
  /// Takes what is drawn, all kept by reference. `layout` is set by every frame; controls send to `out`.
  Drawing(EditorState& state, Layout& layout, const ShownCase& shown, const Work& work, Outbox& out)
      : state_(state), layout_(layout), shown_(shown), work_(work), out_(out) {}

  Result<void> start(float scale);
  /// Sets the scale of the interface; the next frame uses it.
  void set_scale(float scale);
  /// Draws the window; ImGui's frame must not have begun. `frames_per_second` is shown.
  void draw(int width_px, int height_px, double frames_per_second);
  /// Whether the next frame shows more than the last, without anything having happened.
  bool draws_on() const { return draws_on_ || letters_wait(); }

  Result<Picture> picture(const PictureOptions& options) override;
  Result<Picture> plots(const PictureOptions& options) override;
  void forget() override;

 private:
  /// Whether the last frame met letters that no font has and that were not looked for yet.
  bool letters_wait() const;
  void find_letters();
  void draw_pictures(int width_px, int height_px);
  Result<Picture> window_picture();
  Result<Picture> study_picture(const PictureOptions& options);
  void draw_view_picture(const PictureOptions& options);
  /// Draws what is written on a picture, by `put`, with fonts of a scale, in the colours of its ground. The interface
  /// gets its own fonts back.
  void write_on_picture(const PictureOptions& options, float scale, const std::function<void()>& put);
  SceneBuilder::Input scene_input(const EditorState& state) const;
  std::vector<RunningWork> running_work() const;
  UiContext ui_context(const EditorState& state, double fps) const;

  EditorState& state_;
  Layout& layout_;
  const ShownCase& shown_;
  const Work& work_;
  Outbox& out_;
  float scale_ = 1;
  bool light_ = false;
  std::optional<Theme> theme_;
  std::optional<ViewPictures> pictures_;
  SceneBuilder scenes_;
  GalleryPictures gallery_;
  CaseThumbnails thumbnails_;
  bool draws_on_ = false;       ///< pictures of shapes are left
  std::set<unsigned> letters_;  ///< met so far beside those of the program's own font
};

}  // namespace homolog
