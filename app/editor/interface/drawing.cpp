#include "app/editor/interface/drawing.h"
#include "app/editor/interface/interface.h"

#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/editor/interface/marks/view_marks.h"
#include "app/editor/interface/study_picture.h"
#include "app/editor/state/views.h"
#include "app/editor/update/results/opening.h"
#include "app/editor/update/results/results.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/plots.h"
#include "core/base/pictures/caption_sizes.h"

namespace homolog {

namespace {

void begin_imgui_frame() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::GetIO().Fonts->ClearTexData();  // the texture has it by now: 10 MB
}

}  // namespace

Result<void> Drawing::start(float scale) {
  auto pictures = ViewPictures::make();
  if (!pictures) return fail(pictures.error());
  pictures_ = std::move(*pictures);
  set_scale(scale);
  return {};
}

void Drawing::set_scale(float scale) {
  scale_ = scale;
  const bool had_texture = pictures_ && theme_;
  if (had_texture) ImGui_ImplOpenGL3_DestroyFontsTexture();
  light_ = state_.preferences.light;
  theme_ = make_theme(scale, letters_, light_);
  // ImGui makes the first texture by itself, and only that one.
  if (had_texture) ImGui_ImplOpenGL3_CreateFontsTexture();
}

bool Drawing::letters_wait() const {
  return !std::ranges::includes(letters_, controls_memory().unknown_letters);
}

namespace {

/// Whether a code point is of Chinese, Japanese or Korean.
bool is_east_asian(unsigned letter) {
  constexpr std::array<std::pair<unsigned, unsigned>, 5> ranges{
      {{0x1100, 0x11FF}, {0x2E80, 0x9FFF}, {0xA960, 0xD7FF}, {0xF900, 0xFAFF}, {0xFE30, 0xFFEF}}};
  return std::any_of(ranges.begin(), ranges.end(),
                     [&](const auto& range) { return letter >= range.first && letter <= range.second; });
}

/// The scale at which letters are written on a picture.
float written_scale(float wanted) {
  constexpr float smallest = 1, largest = 6;  // fonts of a larger scale would not fit into a texture
  return std::clamp(wanted, smallest, largest);
}

}  // namespace

void Drawing::find_letters() {
  std::set<unsigned> met = std::exchange(controls_memory().unknown_letters, {});
  letters_.insert(met.begin(), met.end());
  set_scale(scale_);
  std::erase_if(
      met, [&](unsigned letter) { return theme_->body->FindGlyphNoFallback(static_cast<ImWchar>(letter)) != nullptr; });
  if (met.empty()) return;
  add_notice(state_,
             std::all_of(met.begin(), met.end(), is_east_asian)
                 ? "Some names are in Chinese, Japanese or Korean letters that no font here has; install the Debian "
                   "package fonts-noto-cjk and start Homolog again to read them."
                 : "Some names are in letters that Homolog has no font for; they are shown as \"?\".",
             false);
}

void Drawing::forget() {
  if (pictures_) pictures_->forget();
}

void Drawing::draw(int width_px, int height_px, double frames_per_second) {
  if (letters_wait()) find_letters();
  if (light_ != state_.preferences.light) set_scale(scale_);
  layout_ = make_layout(static_cast<float>(width_px), static_cast<float>(height_px), scale_,
                        {state_.look.maximised, state_.preferences.panel_open, state_.models.shown});
  if (!state_.models.shown && std::exchange(state_.look.show_all_wanted, false)) {
    show_all(state_, shown_.document(), layout_);
    if (const auto frame = Models::show_repair(state_, shown_.snapshot())) out_.send(ShowFrame{*frame});
  }
  follow_layout(state_, layout_);
  if (pictures_) draw_pictures(width_px, height_px);
  ImGui::NewFrame();
  begin_controls();
  draw_interface(ui_context(state_, frames_per_second), out_);
  draws_on_ =
      pictures_ && state_.models.shown && (thumbnails_.misses_any(state_.models) || gallery_.draws_on(state_.models));
  for (std::string& refusal : std::exchange(controls_memory().refusals, {})) add_notice(state_, std::move(refusal));
  ImGui::Render();
  if (pictures_) ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

/// What the views and the gallery show, and the background, into the framebuffer that is bound.
void Drawing::draw_pictures(int width_px, int height_px) {
  GLint target_framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target_framebuffer);
  const SceneBuilder::Input input = scene_input(state_);
  if (!state_.models.shown) scenes_.update(input);
  std::array<const Framebuffer*, 4> views{};
  for (const ViewKind kind : all_views) {
    const RectPx& rect = layout_.image(kind);
    if (rect.width < 1 || rect.height < 1) continue;
    const Viewport target{0, 0, static_cast<int>(rect.width), static_cast<int>(rect.height), scale_};
    const Scene scene = scenes_.scene(input, kind);
    views[index_of(kind)] =
        kind == ViewKind::space
            ? pictures_->space(scene, state_.look.camera, target, state_.pointer.drag.has_value())
            : pictures_->slice(kind, scene, slice_view(state_, kind, geometry_of(shown_.document())), target);
  }
  const ModelsLayout models = models_layout(layout_);
  if (state_.models.shown) thumbnails_.draw(state_.models, scale_, pictures_->renderer());
  if (state_.models.shown) gallery_.draw(state_.models, models, scale_, pictures_->renderer());
  for (auto error : {pictures_->take_error(), gallery_.take_error()})
    if (!error.empty()) add_notice(state_, std::move(error));
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target_framebuffer));
  glViewport(0, 0, width_px, height_px);
  glDisable(GL_SCISSOR_TEST);
  const ImVec4 ground = ImGui::ColorConvertU32ToFloat4(palette::window);
  glClearColor(ground.x, ground.y, ground.z, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  for (const ViewKind kind : all_views) {
    const RectPx& rect = layout_.image(kind);
    if (const Framebuffer* view = views[index_of(kind)])
      view->copy_to(static_cast<int>(rect.x), height_px - static_cast<int>(rect.y + rect.height));
  }
  if (state_.models.shown) gallery_.copy(models, height_px);

  begin_imgui_frame();
}

Result<Picture> Drawing::picture(const PictureOptions& options) {
  if (!pictures_) return fail("", "This window draws nothing, so there is no picture of it.");
  if (options.study) return study_picture(options);
  if (!options.view) return window_picture();
  auto framebuffer = Framebuffer::make(options.width, options.height, options.view == ViewKind::space ? 4 : 1);
  if (!framebuffer) return fail(framebuffer.error());
  (*framebuffer)->bind();
  const Layout on_screen = layout_;
  draw_view_picture(options);
  layout_ = on_screen;  // the pointer is still in the window
  return (*framebuffer)->read();
}

Result<Picture> Drawing::window_picture() {
  const auto width = static_cast<int>(layout_.top_bar.width);
  const auto height = static_cast<int>(layout_.status_line.y + layout_.status_line.height);
  auto framebuffer = Framebuffer::make(width, height, 1);
  if (!framebuffer) return fail(framebuffer.error());
  (*framebuffer)->bind();
  // As it is on the screen, but for what the pointer and the program have to say just now.
  auto notices = std::exchange(state_.notices, {});
  auto hover = std::exchange(state_.pointer.hover, std::nullopt);
  const Hints hints = std::exchange(state_.preferences.hints, {true, true, true});
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
  const ImVec2 pointer = std::exchange(io.MousePos, ImVec2(-FLT_MAX, -FLT_MAX));
  key_focus().let_mouse_speak();
  do draw(width, height, 0);
  while (draws_on_);
  io.MousePos = pointer;
  state_.preferences.hints = hints;
  state_.pointer.hover = std::move(hover);
  state_.notices.insert(state_.notices.begin(), notices.begin(), notices.end());
  return (*framebuffer)->read();
}

void Drawing::draw_view_picture(const PictureOptions& options) {
  const ViewKind kind = *options.view;
  const auto width = static_cast<float>(options.width), height = static_cast<float>(options.height);
  // As large as the view is on the screen; one that is hidden there as it would be beside the others.
  RectPx rect = layout_.image(kind);
  if (rect.width < 1 || rect.height < 1)
    rect =
        make_layout(layout_.top_bar.width, layout_.status_line.y + layout_.status_line.height, scale_, {}).image(kind);
  const double smaller = std::max(rect.width / width, rect.height / height);
  EditorState state = state_;
  state.pointer.hover.reset();
  state.preferences.light = options.light;  // of the picture's ground, not of the window
  if (kind != ViewKind::space) state.look.slices[index_of(kind)].mm_per_px *= smaller;
  const Viewport target{0, 0, options.width, options.height, static_cast<float>(scale_ / smaller)};
  const SceneBuilder::Input input = scene_input(state);
  Scene scene = scenes_.scene(input, kind);
  if (options.transparent)
    scene.background = {0, 0, 0, 0};
  else if (options.light)
    scene.background = {1, 1, 1, 1};
  const auto drawn =
      kind == ViewKind::space
          ? pictures_->renderer().draw(scene, state.look.camera, target)
          : pictures_->renderer().draw(scene, slice_view(state, kind, geometry_of(shown_.document())), target);
  if (!drawn) add_notice(state_, drawn.error().sentence());  // the rest of the scene is there all the same
  if (!options.captions) return;

  // Letters, scale bar, landmarks and ruler: without them nobody can tell the sides of a slice. They grow with the
  // picture as its lines do.
  layout_.images[index_of(kind)] = {0, 0, width, height};
  state.preferences.hints = {true, true, true};
  state.guide.reset();
  write_on_picture(options, target.content_scale,
                   [&] { draw_view_marks(ui_context(state, 0), kind, *ImGui::GetBackgroundDrawList()); });
}

void Drawing::write_on_picture(const PictureOptions& options, float scale, const std::function<void()>& put) {
  const float on_screen = scale_, wanted = written_scale(scale);
  const bool other = std::abs(wanted - on_screen) > 0.01f;
  if (other) set_scale(wanted);
  begin_imgui_frame();
  ImGui::GetIO().DisplaySize = {static_cast<float>(options.width), static_cast<float>(options.height)};
  ImGui::NewFrame();
  use_palette(options.light, options.light);  // of the picture's ground, whatever the window's theme is
  put();
  use_palette(light_);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (other) set_scale(on_screen);
}

Result<Picture> Drawing::study_picture(const PictureOptions& options) {
  if (!state_.models.made.model) return fail("", "There is no model yet; add at least two shapes to the study.");
  auto framebuffer = Framebuffer::make(options.width, options.height, 4);
  if (!framebuffer) return fail(framebuffer.error());
  (*framebuffer)->bind();
  const std::array<float, 4> ground = options.transparent ? std::array{0.0f, 0.0f, 0.0f, 0.0f}
                                      : options.light     ? std::array{1.0f, 1.0f, 1.0f, 1.0f}
                                                          : gallery_ground;
  glViewport(0, 0, options.width, options.height);
  glClearColor(ground[0], ground[1], ground[2], ground[3]);
  glClear(GL_COLOR_BUFFER_BIT);
  const auto width = static_cast<float>(options.width), height = static_cast<float>(options.height);
  const StudyCells cells = study_cells(state_.models, *options.study, width, height);
  const float scale = written_scale(caption_scale(width, cells.grid.cell(0).width));
  const CaptionRoom room = options.captions ? caption_room(scale) : CaptionRoom();
  gallery_.draw_grid(state_.models, cells.grid, room, cells.shapes, options.height, scale_, pictures_->renderer(),
                     ground);
  if (!options.captions) return (*framebuffer)->read();
  write_on_picture(options, scale,
                   [&] { draw_study_captions(*ImGui::GetBackgroundDrawList(), *theme_, state_.models, cells); });
  return (*framebuffer)->read();
}

Result<Picture> Drawing::plots(const PictureOptions& options) {
  if (!pictures_) return fail("", "This window draws nothing, so there is no picture of it.");
  auto framebuffer = Framebuffer::make(options.width, options.height, 1);
  if (!framebuffer) return fail(framebuffer.error());
  (*framebuffer)->bind();
  glViewport(0, 0, options.width, options.height);
  begin_imgui_frame();
  ImGui::GetIO().DisplaySize = {static_cast<float>(options.width), static_cast<float>(options.height)};
  ImGui::NewFrame();
  use_palette(options.light);
  draw_plots_picture(*theme_, *state_.models.made.evaluation, options, *ImGui::GetBackgroundDrawList());
  use_palette(light_);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return (*framebuffer)->read();
}

SceneBuilder::Input Drawing::scene_input(const EditorState& state) const {
  static const std::optional<EditReport> none;
  const Document& document = shown_.document();
  const bool is_of_active = document.structure(shown_.snapshot().preview_of) == active_structure(state, document);
  const bool shows_label = state.preferences.show.label_surface && shown_.labels().volume;
  return {.state = state,
          .document = shown_.displayed(),
          .preview = is_of_active ? shown_.snapshot().preview : none,
          .labels = shown_.labels_here(),
          .making = shown_making(state, work_),
          .outlines = shown_.mesh().outlines(),
          .label_surface = shows_label ? work_.label_surfaces.shown() : nullptr,
          .label = work_.label_surfaces.label(),
          .label_colours = shown_.labels().colours};
}

std::vector<RunningWork> Drawing::running_work() const {
  constexpr double shown_after_seconds = 0.5;
  std::vector<RunningWork> running;
  const auto show = [&](const char* kind, const std::string& verb, const std::optional<RunningJob>& job, Command cancel,
                        const char* tip) {
    if (job && job->seconds > shown_after_seconds)
      running.push_back({kind, verb + std::filesystem::path(job->subject).filename().string(), tip, std::move(cancel),
                         job->fraction});
  };
  show("opening", "Opening ", work_.opener.running(), CancelOpening{}, "Stops. The open case stays as it is");
  show("reading", "Reading ", work_.imports.running(), CancelReading{}, "Stops. The case stays as it is");
  ShownParts without = state_.preferences.show;
  without.label_surface = false;
  show("label surface", "Surface of ", work_.label_surfaces.running(), ShowParts{without},
       "Stops, and shows no surface of the label (U)");
  if (const auto job = work_.models.files_running(); job && job->seconds > shown_after_seconds)
    running.push_back(study_work(*job));
  if (const auto file = work_.exports.running())
    show("writing", "Writing ", file, CancelWriting{file->subject}, "Stops. The file stays as it was before");
  return running;
}

UiContext Drawing::ui_context(const EditorState& state, double fps) const {
  return {.theme = *theme_,
          .layout = layout_,
          .state = state,
          .on_screen = shown_,
          .work = work_,
          .thumbnails = thumbnails_,
          .running = running_work(),
          .frames_per_second = fps};
}

}  // namespace homolog
