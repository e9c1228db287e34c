#include "app/lab/editor_frames.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "app/editor/update/controls.h"
#include "app/editor/update/tools/tool.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/lab/bench_hand.h"
#include "core/base/numbers/statistics.h"
#include "core/base/processes/process.h"
#include "core/case/actions/structures.h"
#include "core/catalogue/catalogue.h"
#include "core/experiment/demo_case.h"
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

struct DragTool {
  std::string name;
  int key;
};

/// The tools whose drags edit the mesh, in the order of the strip: strokes, then brushes.
const std::vector<DragTool>& drag_tools() {
  static const std::vector<DragTool> tools = [] {
    std::vector<DragTool> those;
    for (const ToolKind* kind : tool_kinds) {
      if (kind->stroke) those.push_back({kind->log_name, *kind->key});
      if (is_brush(kind->tool)) those.push_back({kind->log_name + std::string(" brush"), *kind->key});
    }
    return those;
  }();
  return tools;
}

Result<EditSession> demo_session(const fs::path& file) {
  auto document = demo_document(Organ::kidney, 1);
  if (!document) return fail(document.error());
  return create_case(*document, file);
}

/// The demo kidney with small ones around it, so that the case has so many structures.
Result<EditSession> crowded_session(const fs::path& file, int structures) {
  auto session = demo_session(file);
  if (!session) return session;
  const Points& first = *session->document().view()->shape.points;
  const Vec3 middle = bounds_of(first).center();
  constexpr double growth = 0.3, apart_mm = 40;
  constexpr int across = 4;
  for (int k = 1; k < structures; ++k) {
    const Vec3 place =
        middle + apart_mm * Vec3(k % across - 1.5, k / across % across - 1.5, k / (across * across) - 1.5);
    SetStructure one{.id = "s" + std::to_string(k + 1), .name = "structure " + std::to_string(k + 1)};
    one.source = built_in_source(Organ::kidney);
    one.placement = Similarity{Eigen::Quaterniond::Identity(), growth, place - growth * middle};
    if (auto added = session->apply(std::move(one)); !added) return fail(added.error());
  }
  return session;
}

/// The frames of the first tools, in the order of `drag_tools`.
std::vector<std::vector<double>> drags(EditorApp& app, Framebuffer* framebuffer, int frames, std::size_t count) {
  BenchHand hand(app, framebuffer);
  hand.rest();
  std::vector<std::vector<double>> times;
  for (std::size_t k = 0; k < count; ++k) times.push_back(drag_ms(app, hand, drag_tools()[k].key, frames));
  return times;
}

/// Puts the cost of the first tools behind the others, without OpenGL and with it where it is to be had.
template <class Session>
Result<void> add_costs(const Session& session, int structures, std::size_t count, std::vector<FrameCost>& costs) {
  const std::size_t begin = costs.size();
  {
    auto plain = session("plain");
    if (!plain) return fail(plain.error());
    const ImGuiAlone imgui;
    EditorApp app([] {});
    app.start_without_pictures(1);
    app.start_session(std::move(*plain));
    constexpr int frames = 40;
    const auto times = drags(app, nullptr, frames, count);
    for (std::size_t k = 0; k < count; ++k)
      costs.push_back({drag_tools()[k].name, structures, median_of(times[k]), std::ranges::max(times[k]), {}});
  }
  const auto gl = OffscreenContext::make();
  if (!gl) return {};
  auto drawn = session("drawn");
  if (!drawn) return fail(drawn.error());
  const ImGuiOnOpenGl imgui;
  EditorApp app([] {});
  const auto framebuffer = Framebuffer::make(BenchHand::width_px, BenchHand::height_px, 1);
  if (!framebuffer || !app.start_drawing(1)) return {};
  app.start_session(std::move(*drawn));
  constexpr int frames = 8;
  const auto times = drags(app, framebuffer->get(), frames, count);
  for (std::size_t k = 0; k < count; ++k) costs[begin + k].drawn_frame_ms = median_of(times[k]);
  return {};
}

}  // namespace

Result<std::vector<FrameCost>> frame_costs() {
  const ScratchFolder folder("homolog-bench-editor");
  std::vector<FrameCost> costs;
  const auto alone = [&](const std::string& name) { return demo_session(folder.path / (name + ".homolog")); };
  if (auto added = add_costs(alone, 1, drag_tools().size(), costs); !added) return fail(added.error());
  constexpr int many = 60;
  const auto crowded = [&](const std::string& name) {
    return crowded_session(folder.path / (name + "-crowded.homolog"), many);
  };
  if (auto added = add_costs(crowded, many, 1, costs); !added) return fail(added.error());
  return costs;
}

}  // namespace homolog
