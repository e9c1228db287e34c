#include "app/lab/study_frames.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "app/editor/state/models/gallery.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/lab/bench_hand.h"
#include "core/base/numbers/statistics.h"
#include "core/base/processes/memory.h"

namespace homolog {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A frame until it is drawn to its last pixel.
double drawn_frame_ms(BenchHand& hand, Framebuffer& framebuffer) {
  const auto start = Clock::now();
  hand.frame();
  framebuffer.bind();
  glFinish();  // nothing is read back: the window does not do that either
  return ms_since(start);
}

/// Until the study is on the screen, and then until all is done.
Result<StudyCost> opened(EditorApp& app, BenchHand& hand, Framebuffer& framebuffer,
                         const std::filesystem::path& study) {
  StudyCost cost;
  const auto start = Clock::now();
  app.send(ShowModels{true});
  app.send(OpenStudy{{study}});
  do {
    const ModelsState& models = app.state().models;
    if (!models.made.model && !models.made.error.empty()) return fail(study.string(), models.made.error);
    cost.slowest_frame_ms = std::max(cost.slowest_frame_ms, drawn_frame_ms(hand, framebuffer));
    if (models.made.model && cost.open_ms == 0) cost.open_ms = ms_since(start);
    std::this_thread::sleep_for(std::chrono::milliseconds(models.made.model ? 100 : 30));
  } while (cost.open_ms == 0 || !hand.at_rest() || app.draws_on());
  cost.at_rest_ms = ms_since(start);
  return cost;
}

double turned_frame_ms(EditorApp& app, BenchHand& hand, Framebuffer& framebuffer) {
  const RectPx gallery = models_layout(app.layout()).gallery;
  Eigen::Vector2d at(gallery.x + gallery.width / 2, gallery.y + gallery.height / 2);
  hand.move(at);
  hand.rest();
  hand.button(true);
  hand.rest();
  std::vector<double> times;
  constexpr int frames = 30;
  for (int k = 0; k < frames; ++k) {
    at += Eigen::Vector2d(3, 1);
    hand.move(at);
    times.push_back(drawn_frame_ms(hand, framebuffer));
  }
  hand.button(false);
  hand.rest();
  return median_of(std::move(times));
}

/// The frames that show the next page, which are drawn for the first time.
double next_page_frame_ms(EditorApp& app, BenchHand& hand, Framebuffer& framebuffer) {
  std::vector<double> times;
  constexpr std::size_t most_pages = 8;
  for (std::size_t page = 1; page < std::min(gallery_pages(app.state().models), most_pages); ++page) {
    hand.key(key::page_down);
    times.push_back(drawn_frame_ms(hand, framebuffer));
    hand.rest();
  }
  return times.empty() ? 0 : median_of(std::move(times));
}

}  // namespace

Result<StudyCost> study_cost(const std::filesystem::path& study) {
  const auto gl = OffscreenContext::make();
  if (!gl) return fail(gl.error());
  const ImGuiOnOpenGl imgui;
  EditorApp app([] {});
  const auto framebuffer = Framebuffer::make(BenchHand::width_px, BenchHand::height_px, 1);
  if (!framebuffer) return fail(framebuffer.error());
  if (auto started = app.start_drawing(1); !started) return fail(started.error());
  app.start_session(EditSession(new_document({}, nullptr, nullptr)));
  BenchHand hand(app, framebuffer->get());
  hand.rest();
  give_back_freed_memory();  // what making the study took
  forget_peak_memory();
  auto cost = opened(app, hand, **framebuffer, study);
  if (!cost) return cost;
  cost->turned_frame_ms = turned_frame_ms(app, hand, **framebuffer);
  cost->next_page_frame_ms = next_page_frame_ms(app, hand, **framebuffer);
  cost->peak_mb = peak_memory_mb();
  return cost;
}

}  // namespace homolog
