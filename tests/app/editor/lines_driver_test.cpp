#include <doctest/doctest.h>

#include <imgui.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/editor/state/figures/quality.h"
#include "app/editor/state/view_geometry.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/widgets.h"
#include "app/editor/window/editor_app.h"
#include "core/catalogue/catalogue.h"
#include "core/experiment/demo_case.h"
#include "core/mesh/mesh_quality.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"
#include "tests/screens.h"

// How texts are broken into lines, how rows are lit, and how large letters are on pictures.

namespace homolog {

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines{""};
  for (const char c : text)
    if (c == '\n')
      lines.emplace_back();
    else
      lines.back() += c;
  return lines;
}

const DrawnItem* item_with(const std::vector<DrawnItem>& items, const std::string& words) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const DrawnItem& item) {
    return item.kind == DrawnItem::Kind::text && item.name.find(words) != std::string::npos;
  });
  return found == items.end() ? nullptr : &*found;
}

std::array<int, 3> colour_at(const Picture& picture, float x, float y) {
  const auto at =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x));
  return {picture.rgba[at], picture.rgba[at + 1], picture.rgba[at + 2]};
}

/// The demo's kidney in a window of 1280 × 800 that is drawn beside the screen.
struct DrawnDemo {
  DrawnDemo() {
    REQUIRE(app.start_drawing(1));
    app.start_session(EditSession(test::must(demo_document(Organ::kidney, 1))));
    app.settle();
    ImGui::GetIO().DisplaySize = {1280, 800};
  }
  void draw() {
    framebuffer->bind();
    app.draw(1280, 800, 0);
  }

  ImGuiOnOpenGl imgui;
  std::unique_ptr<Framebuffer> framebuffer = test::must(Framebuffer::make(1280, 800, 1));
  EditorApp app{[] {}};
};

}  // namespace

TEST_CASE("a number is never broken at its point") {
  const ImGuiAlone imgui;
  const Theme theme = make_theme(1);
  ImGui::GetIO().DisplaySize = {800, 600};
  const std::string before = "The usual factor is", text = before + " 1.08";
  const float room = text_size(theme.small, before + " 1.0").x;  // "1." has room, "1.08" has not
  DrawnItems drawn;
  ImGui::NewFrame();
  begin_controls();
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::SetNextWindowSize({room, 300});
  ImGui::Begin("panel", nullptr, ImGuiWindowFlags_NoDecoration);
  explanation(theme, text);
  ImGui::End();
  ImGui::PopStyleVar();
  ImGui::EndFrame();
  const DrawnItem* shown = item_with(drawn.items(), text);
  REQUIRE(shown != nullptr);
  CHECK(shown->rect.width == doctest::Approx(text_size(theme.small, before).x).epsilon(0.02));
}

TEST_CASE("texts are broken at blanks and paths behind a slash and no line is too wide") {
  const ImGuiAlone imgui;
  const Theme theme = make_theme(1);
  const auto broken = [&](const std::string& text, float width) { return lines_of(in_lines(theme.body, text, width)); };
  const std::string path = "/home/anna/.local/state/homolog/studies/phantom-kidney/kidney-01.ply";
  for (const float width : {90.0f, 140.0f, 200.0f, 320.0f}) {
    CAPTURE(width);
    const auto lines = broken("Written: " + path + ". STL keeps 1.25 of it.", width);
    std::string joined;
    for (const std::string& line : lines) {
      CHECK(text_size(theme.body, line).x <= width);
      joined += line;
    }
    joined.erase(std::remove(joined.begin(), joined.end(), ' '), joined.end());
    CHECK(joined == "Written:" + path + ".STLkeeps1.25ofit.");
  }
  for (const std::string& line : broken(path, 260)) CHECK((line.ends_with('/') || line.ends_with("kidney-01.ply")));
  CHECK(broken("one\n\ntwo", 500) == std::vector<std::string>{"one", "", "two"});
  CHECK(broken("", 500) == std::vector<std::string>{""});
}

TEST_CASE("a row that is chosen is told from a row that is pointed at") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), {1024, 900, 1});
  driver.state().preferences.sections_open = {{"Case", false}, {"Template", true}};
  driver.settle();
  driver.click("Move or remove landmarks…");
  driver.click("upper end");
  driver.point_at("hilum");
  const RectPx chosen = driver.control("upper end").rect, pointed = driver.control("hilum").rect;
  const Picture picture = driver.picture();
  const auto right_end = [&](const RectPx& row) {
    return colour_at(picture, row.x + row.width - 6, row.y + row.height / 2);
  };
  CHECK(right_end(chosen) != right_end(pointed));
}

TEST_CASE("letters grow with an exported picture") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  DrawnDemo demo;
  EditorApp& app = demo.app;
  demo.draw();
  const RectPx pane = app.layout().image(ViewKind::space);
  DrawnItems drawn;
  const auto letter_px = [&](float times) {
    drawn.clear();
    PictureOptions options{ViewKind::space, static_cast<int>(times * pane.width),
                           static_cast<int>(times * pane.height)};
    test::must(app.picture(options));
    REQUIRE_FALSE(drawn.items().empty());
    return drawn.items().front().rect.height;
  };
  const float on_screen = letter_px(1);
  CHECK(letter_px(3) == doctest::Approx(3 * on_screen).epsilon(0.1));
  CHECK(letter_px(1) == on_screen);
}

TEST_CASE("a picture has the ground that was chosen whatever the window's theme is") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  DrawnDemo demo;
  EditorApp& app = demo.app;
  const auto picture_in = [&](bool light_window, bool light_ground) {
    app.state().preferences.light = light_window;
    demo.draw();
    PictureOptions options{ViewKind::space, 400, 300};
    options.light = light_ground;
    return test::must(app.picture(options));
  };
  for (const bool light_ground : {false, true}) {
    CAPTURE(light_ground);
    const Picture in_light = picture_in(true, light_ground);
    CHECK((in_light.rgba[0] > 200) == light_ground);
    CHECK(in_light.rgba == picture_in(false, light_ground).rgba);
  }
}

TEST_CASE("the slices of an image without a mesh fill the 3D view") {
  const OrganScan scan;
  Driver driver(new_document("scan.nii", OrganScan::image(), nullptr));
  driver.settle();
  const ViewMap map = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::space);
  const Box box = OrganScan::grid().bounds_mm();
  double low_x = 1e9, high_x = -1e9, low_y = 1e9, high_y = -1e9;
  for (int k = 0; k < 24; ++k) {  // the corners of the three planes
    Vec3 corner = box.corner(static_cast<Box::CornerType>(k % 8));
    corner[k / 8] = box.center()[k / 8];
    const auto px = map.to_px(corner);
    REQUIRE(px);
    low_x = std::min(low_x, px->x());
    high_x = std::max(high_x, px->x());
    low_y = std::min(low_y, px->y());
    high_y = std::max(high_y, px->y());
  }
  const RectPx& view = map.rect();
  CHECK(std::max(high_x - low_x, high_y - low_y) > 0.75 * std::min(view.width, view.height));
  CHECK(low_x >= view.x);
  CHECK(low_y >= view.y);
  CHECK(high_x <= view.x + view.width);
  CHECK(high_y <= view.y + view.height);
}

TEST_CASE("triangles that are thin in the template itself are no fault and those that became thin are") {
  Document document = new_document("", nullptr, test::must(load_template("built-in:ventricle")));
  REQUIRE(quality_figures(*document.view()).min_angle_deg < thin_below_deg);  // the fan at the apex
  Driver driver(document, {1280, 1600, 1});
  driver.wait_until("the mesh is measured", [&] { return driver.shows("Six neighbours"); });
  driver.settle();
  CHECK_FALSE(driver.has("Correspondence/Smallest angle"));  // a link only where there is something to go to
  const auto& triangles = document.structure()->the_template->topology->triangles();
  Eigen::Index face = 0;  // one of good shape
  while (smallest_angle_deg(document.view()->mesh(), face) < 25) ++face;
  SetPoints squeezed;
  auto points = std::make_shared<Points>(*driver.document().view()->shape.points);
  points->row(triangles(face, 0)) = 0.97 * points->row(triangles(face, 1)) + 0.03 * points->row(triangles(face, 2));
  squeezed.points = points;
  driver.app().send(ApplyEdit{squeezed});
  driver.wait_until("the thin triangle is found", [&] { return driver.has("Correspondence/Smallest angle"); });
}

}  // namespace homolog
