#include "app/editor/window/editor_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <thread>
#include <vector>

#include "app/editor/update/controls.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/window/bench_hand.h"
#include "app/editor/work/opening/demo.h"
#include "core/base/process.h"
#include "core/base/statistics.h"
#include "core/session/case_file.h"
#include "render/offscreen.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// px of the outline's leftmost point in the axial view.
Eigen::Vector2d on_outline(EditorApp& app, BenchHand& hand) {
  const Points& points = *app.snapshot().document->view()->shape.points;
  Eigen::Index vertex = 0;
  points.col(0).maxCoeff(&vertex);
  const Vec3 at = points.row(vertex);
  app.send(LookAt{at});
  hand.rest();
  return view_map(app.state(), app.layout(), *app.snapshot().document, ViewKind::axial).to_px(at).value();
}

/// The cost of each frame of one drag on a circle about the outline's point.
std::vector<double> drag_ms(EditorApp& app, BenchHand& hand, int tool, int frames) {
  hand.key(tool);
  const Eigen::Vector2d start = on_outline(app, hand);
  hand.move(start);
  hand.rest();
  hand.button(true);
  hand.rest();
  std::vector<double> times;
  int event = 0;
  for (int k = 0; k < frames; ++k) {
    const double before = thread_core_ms();
    for (int i = 0; i < events_a_frame; ++i) {
      const double turn = 2 * std::numbers::pi * ++event / (60.0 * events_a_frame);  // once in a second
      hand.move(start + 12 * Eigen::Vector2d(std::cos(turn) - 1, std::sin(turn)));
    }
    hand.frame();
    times.push_back(thread_core_ms() - before);
    // The solver has its time too, as between two frames of a display.
    std::this_thread::sleep_for(std::chrono::milliseconds(8));
  }
  hand.button(false);
  hand.rest();
  app.send(ApplyEdit{Undo{}});
  hand.rest();
  return times;
}

struct Tool {
  const char* name;
  int key;
};
constexpr std::array<Tool, 6> tools{
    {{"pull", 'P'}, {"grab", 'G'}, {"slide", 'S'}, {"relax", 'R'}, {"stiffness brush", 'B'}, {"confirm brush", 'C'}}};

Result<EditSession> demo_session(const fs::path& file) {
  auto document = demo_document(Organ::kidney, 1);
  if (!document) return fail(document.error());
  return create_case(*document, file);
}

/// Every tool's frames, in the order of `tools`.
std::vector<std::vector<double>> all_drags(EditorApp& app, Framebuffer* framebuffer, int frames) {
  BenchHand hand(app, framebuffer);
  hand.rest();
  std::vector<std::vector<double>> times;
  for (const Tool& tool : tools) times.push_back(drag_ms(app, hand, tool.key, frames));
  return times;
}

}  // namespace

Result<std::vector<FrameCost>> frame_costs() {
  const ScratchFolder folder("homolog-bench-editor");
  std::vector<FrameCost> costs;
  {
    auto session = demo_session(folder.path / "plain.homolog");
    if (!session) return fail(session.error());
    const ImGuiAlone imgui;
    EditorApp app([] {});
    app.start_without_pictures(1);
    app.start_session(std::move(*session));
    constexpr int frames = 40;
    const auto times = all_drags(app, nullptr, frames);
    for (std::size_t k = 0; k < tools.size(); ++k)
      costs.push_back({tools[k].name, median_of(times[k]), *std::max_element(times[k].begin(), times[k].end()), {}});
  }
  const auto gl = OffscreenContext::make();
  if (!gl) return costs;
  auto session = demo_session(folder.path / "drawn.homolog");
  if (!session) return fail(session.error());
  const ImGuiOnOpenGl imgui;
  EditorApp app([] {});
  const auto framebuffer = Framebuffer::make(BenchHand::width_px, BenchHand::height_px, 1);
  if (!framebuffer || !app.start_drawing(1)) return costs;
  app.start_session(std::move(*session));
  constexpr int frames = 8;
  const auto times = all_drags(app, framebuffer->get(), frames);
  for (std::size_t k = 0; k < tools.size(); ++k) costs[k].drawn_frame_ms = median_of(times[k]);
  return costs;
}

}  // namespace homolog
