#include <doctest/doctest.h>

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "app/editor/state/icons.h"
#include "app/editor/state/view_geometry.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/theme.h"
#include "app/editor/widgets/widgets.h"
#include "app/editor/window/frame_rate.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/ball.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"
#include "tests/screens.h"
#include "tests/seen_colours.h"

// How the window looks: what is written whole, what is told apart, what follows the organ's size.

namespace homolog {

namespace {

namespace fs = std::filesystem;

const std::string dots = "\xe2\x80\xa6";

bool lies_in(const RectPx& inner, const RectPx& outer) {
  return inner.x >= outer.x && inner.y >= outer.y && inner.x + inner.width <= outer.x + outer.width &&
         inner.y + inner.height <= outer.y + outer.height;
}

const DrawnItem* text_that_is(const Driver& driver, const std::string& text, const std::string& part = {}) {
  const auto found = std::find_if(driver.items().begin(), driver.items().end(), [&](const DrawnItem& item) {
    return item.kind == DrawnItem::Kind::text && item.name == text && item.path.starts_with(part);
  });
  return found == driver.items().end() ? nullptr : &*found;
}

/// ImGui within a frame, with the program's fonts.
struct InFrame {
  InFrame() {
    ImGui::GetIO().DisplaySize = {800, 600};
    ImGui::NewFrame();
  }
  ~InFrame() { ImGui::EndFrame(); }
  InFrame(const InFrame&) = delete;
  InFrame& operator=(const InFrame&) = delete;

  ImGuiAlone imgui;
  Theme theme = make_theme(1);
};

/// px without ink between two letters that follow each other.
float gap_between(const ImFont& font, char left, char right) {
  const ImFontGlyph &a = *font.FindGlyph(static_cast<ImWchar>(left)), &b = *font.FindGlyph(static_cast<ImWchar>(right));
  return a.AdvanceX - a.X1 + b.X0;
}

/// How far two pixels differ, as eyes see it.
double difference_at(const Picture& picture, int x0, int y0, int x1, int y1) {
  const auto light = [&](int x, int y) {
    const std::uint8_t* rgba = &picture.rgba[4 * static_cast<std::size_t>(y * picture.width + x)];
    return test::light_of({rgba[0] / 255.0, rgba[1] / 255.0, rgba[2] / 255.0});
  };
  return test::colour_difference(light(x0, y0), light(x1, y1));
}

}  // namespace

TEST_CASE("a 1 in a name stands as near to its neighbours as other digits do") {
  const InFrame frame;
  for (const ImFont* font : {frame.theme.body, frame.theme.strong, frame.theme.small}) {
    const float usual = gap_between(*font, '0', '0');
    for (const auto& [left, right] :
         {std::pair('y', '1'), std::pair('0', '1'), std::pair('1', '0'), std::pair('1', '.')})
      CHECK_MESSAGE(gap_between(*font, left, right) <= usual + 1.5f, left, right);
  }
}

TEST_CASE("numbers that change and stand in columns have digits of one width") {
  const InFrame frame;
  for (ImFont* font : {frame.theme.body, frame.theme.strong, frame.theme.small}) {
    ImFont* even = frame.theme.even_digits(font);
    CHECK(even != font);
    CHECK(text_size(even, "111.11 mm").x == text_size(even, "808.08 mm").x);
  }
  CHECK(frame.theme.even_digits(frame.theme.icons) == frame.theme.icons);
}

TEST_CASE("a sentence of an error is shown whole however long it is") {
  std::string sentence = "scan-of-the-second-visit.nii.gz: is a second image, and not a label map:";
  for (int k = 0; k < 40; ++k) sentence += " it holds values such as " + std::to_string(1000 + k) + ",";
  sentence += " open one image at a time.";
  for (const auto& [width, height] : {std::pair(1600, 1000), std::pair(800, 600)}) {
    Driver driver(ball_document(40), {width, height, 1});
    const std::string shorter = sentence.substr(0, 420) + " open one image at a time.";
    add_notice(driver.state(), shorter);
    driver.frames(3);
    const DrawnItem* whole = text_that_is(driver, shorter);
    REQUIRE(whole != nullptr);
    CHECK(whole->seen == whole->rect);
    // What is taller than most of the window scrolls, and misses nothing.
    driver.state().notices.clear();
    add_notice(driver.state(), sentence + " " + sentence);
    driver.frames(3);
    whole = text_that_is(driver, sentence + " " + sentence);
    REQUIRE(whole != nullptr);
    CHECK((whole->seen == whole->rect || whole->scrolls));
  }
}

TEST_CASE("a warning that no line holds is said whole above the status line") {
  Driver driver(ball_document(40), {800, 600, 1});
  driver.state().found.volume_curve.frames[0].doubt =
      "is in doubt, because the label of this frame is much larger than that of the frame before it, and because nine "
      "tenths of the vertices have moved by more than the heart can move in so short a time";
  driver.frames(2);
  const DrawnItem* said = nullptr;
  for (const DrawnItem& item : driver.items())
    if (item.name.find("in so short a time.") != std::string::npos && item.kind == DrawnItem::Kind::text) said = &item;
  REQUIRE(said != nullptr);
  CHECK(said->name.find(dots) == std::string::npos);
  CHECK(said->seen == said->rect);
  CHECK(said->rect.y + said->rect.height <= driver.app().layout().status_line.y);
}

TEST_CASE("a hint that is too long is said by whole sentences") {
  Driver driver(ball_document(40), {800, 600, 1});
  driver.frames(2);
  const std::string line = "status line/";
  for (const DrawnItem& item : driver.items())
    if (item.kind == DrawnItem::Kind::text && item.path.starts_with(line) && item.name.starts_with("Drag"))
      CHECK(item.name.ends_with("."));
}

TEST_CASE("white in a legend has a rim on the light window's ground") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  for (const bool light : {true, false}) {
    Driver driver(ball_document(40), {1280, 1800, 1});
    driver.app().send(UseLightTheme{light});
    driver.app().send(ChooseColouring{Colouring::known});
    driver.settle();
    const Picture picture = driver.picture();
    const DrawnItem* name = text_that_is(driver, "confirmed", "side panel");
    REQUIRE(name != nullptr);
    REQUIRE(name->seen == name->rect);
    // From the swatch before the name to the left: somewhere it differs from the ground.
    const int y = static_cast<int>(name->rect.y + name->rect.height / 2), x = static_cast<int>(name->rect.x);
    double most = 0;
    for (int left = 4; left < 18; ++left) most = std::max(most, difference_at(picture, x - left, y, x - 2, y));
    CAPTURE(light);
    CHECK(most > 25);
  }
}

TEST_CASE("with another colouring than hues a legend lies in the 3D view") {
  for (const auto& [width, height] : {std::pair(1600, 1000), std::pair(800, 600)}) {
    Driver driver(ball_document(40), {width, height, 1});
    driver.state().preferences.hints = {true, true, true};
    driver.settle();
    CHECK(text_that_is(driver, "Stiffness", "3D view") == nullptr);
    driver.press('B');
    driver.settle();
    const RectPx view = driver.app().layout().image(ViewKind::space);
    for (const char* text : {"Stiffness", "0 soft", "stiff 2.0\xc3\x97"}) {
      const DrawnItem* item = text_that_is(driver, text, "3D view");
      REQUIRE_MESSAGE(item != nullptr, text);
      CHECK(item->seen == item->rect);
      CHECK(lies_in(item->rect, view));
    }
    driver.press('P');
    driver.app().send(ChooseColouring{Colouring::doubt});
    driver.app().send(MaximiseView{ViewKind::axial});
    driver.settle();
    CHECK(text_that_is(driver, "Doubt", "axial view") != nullptr);
  }
}

TEST_CASE("the stiffness brush says which end of its slider is soft") {
  Driver driver(ball_document(40), {1280, 1400, 1});
  driver.press('B');
  driver.settle();
  const DrawnItem* soft = text_that_is(driver, "soft", "side panel");
  const DrawnItem* stiff = text_that_is(driver, "stiff", "side panel");
  REQUIRE(soft != nullptr);
  REQUIRE(stiff != nullptr);
  const RectPx& track = driver.control("Paints factor/track").rect;
  CHECK(soft->rect.x >= track.x - 2);
  CHECK(soft->rect.x < track.x + 0.2f * track.width);
  CHECK(stiff->rect.x > track.x + 0.6f * track.width);
  CHECK(soft->rect.y > track.y);
  CHECK(soft->rect.y < track.y + track.height + 12);
}

TEST_CASE("glyphs and the brush follow the organ's size and keep what was chosen for one as large") {
  std::map<double, std::array<double, 2>> of_size;
  for (const double radius_mm : {10.0, 36.0, 125.0}) {  // a mouse's skull, a kidney, a liver
    Driver driver(ball_document(radius_mm));
    const double diagonal_mm = 2 * radius_mm * std::sqrt(3.0);
    CHECK(driver.state().look.glyph_spacing_mm == doctest::Approx(diagonal_mm / 12).epsilon(0.1));
    CHECK(driver.state().hand.brush.radius_mm == doctest::Approx(0.08 * diagonal_mm).epsilon(0.1));
    driver.state().look.glyph_spacing_mm *= 1.7;
    const double chosen = driver.state().look.glyph_spacing_mm;
    driver.app().start_session(EditSession(ball_document(1.2 * radius_mm)));
    driver.settle();
    CHECK(driver.state().look.glyph_spacing_mm == chosen);
    driver.app().start_session(EditSession(ball_document(4 * radius_mm)));
    driver.settle();
    CHECK(driver.state().look.glyph_spacing_mm == doctest::Approx(4 * diagonal_mm / 12).epsilon(0.1));
  }
}

TEST_CASE("pictures a second are said only while they are drawn one after the other") {
  FrameRate rate;
  double now = 100;
  CHECK(rate.drawn(now) == 0);                                      // after a rest
  for (int k = 0; k < 3; ++k) CHECK(rate.drawn(now += 0.09) == 0);  // three pictures of one event
  CHECK_FALSE(rate.ends_at());
  now += 5;
  for (int k = 0; k < 60; ++k) rate.drawn(now += 1.0 / 60);
  CHECK(rate.drawn(now += 1.0 / 60) == doctest::Approx(60));
  REQUIRE(rate.ends_at());
  CHECK(*rate.ends_at() > now);
  CHECK(*rate.ends_at() < now + 0.5);
  CHECK(rate.drawn(now + 2) == 0);
  CHECK_FALSE(rate.ends_at());
}

TEST_CASE("a window at rest says nothing of pictures a second") {
  Driver driver(ball_document(40));
  driver.settle();
  CHECK_FALSE(driver.shows("fps"));
  CHECK_FALSE(driver.shows("frames/s"));
}

TEST_CASE("each icon of the bars stands for one thing and the magnet is the snap's") {
  const auto text_of = [](const char* file) {
    std::ifstream in(fs::path(HOMOLOG_SOURCE_DIR) / "app/editor" / file);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  };
  // Fullscreen arrows enlarge one view; the whole of what there is has an icon of its own.
  for (const char* file : {"interface/bars.cpp", "interface/gallery_ui.cpp", "interface/models_ui.cpp"})
    CHECK(text_of(file).find("icon::enlarge") == std::string::npos);
  CHECK(text_of("interface/views_ui.cpp").find("icon::enlarge") != std::string::npos);
  const std::string magnet = "\xef\x81\xb6";
  CHECK(icon::snap == magnet);
  CHECK(icon::pull != magnet);
  CHECK(text_of("panels/panel_snap.cpp").find("icon::snap") != std::string::npos);
}

TEST_CASE("names of landmarks and the ruler's length keep off the frame of their view") {
  const OrganScan scan;
  Driver driver(scan.document({"lateral convexity", "lower end", "left lip"}));
  driver.press('L');
  driver.settle();
  const Points& points = *driver.document().view()->shape.points;
  int seen = 0;
  for (const ViewKind kind : slice_views)
    for (double shift_px = -160; shift_px <= 160; shift_px += 4) {
      SlicePan& pan = driver.state().look.slices[index_of(kind)];
      const auto [right, down] = screen_axes(kind, Mat3::Identity(), true);
      pan.centre_mm = Vec3(points.row(0)) + shift_px * pan.mm_per_px * right;
      driver.frame();
      const RectPx view = driver.app().layout().image(kind);
      const RectPx inner{view.x + 4, view.y, view.width - 8, view.height};
      for (const DrawnItem& item : driver.items())
        if (item.kind == DrawnItem::Kind::text && (item.name == "lateral convexity" || item.name == "left lip") &&
            view.contains(item.rect.x, item.rect.y)) {
          ++seen;
          CHECK(lies_in(item.rect, inner));
        }
    }
  CHECK(seen > 20);
  driver.state().hand.ruler =
      Ruler{Vec3(-60, -20, driver.state().look.crosshair_mm.z()), Vec3(400, -20, driver.state().look.crosshair_mm.z())};
  driver.frames(2);
  const DrawnItem* length = text_that_is(driver, "460.0 mm", "axial view");
  REQUIRE(length != nullptr);
  CHECK(lies_in(length->rect, driver.app().layout().image(ViewKind::axial)));
}

TEST_CASE("the surface of the label in hand is shown in 3D when it is asked for") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  const fs::path file = scan.folder.path / "labels.nii";
  Volume labels = label_map(icosphere(4, 26), OrganScan::grid(), 3);
  REQUIRE(write_volume(labels, file));
  Driver driver(scan.document());
  driver.settle();
  const std::string toggle = "Label's surface in 3D";
  CHECK_FALSE(driver.control(toggle).enabled);
  driver.app().send(open_labels(file));
  driver.settle();
  driver.state().preferences.show.planes = false;
  const auto space = [&] {
    const RectPx view = driver.app().layout().image(ViewKind::space);
    const Picture whole = driver.picture();
    std::vector<std::uint8_t> part;
    for (int y = static_cast<int>(view.y); y < static_cast<int>(view.y + view.height); ++y)
      for (int x = static_cast<int>(view.x); x < static_cast<int>(view.x + view.width); ++x)
        for (std::size_t k = 0; k < 3; ++k)
          part.push_back(whole.rgba[4 * static_cast<std::size_t>(y * whole.width + x) + k]);
    return part;
  };
  const auto changed = [](const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    REQUIRE(a.size() == b.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); i += 3)
      count += std::abs(a[i] - b[i]) + std::abs(a[i + 1] - b[i + 1]) + std::abs(a[i + 2] - b[i + 2]) > 24 ? 1 : 0;
    return static_cast<double>(3 * count) / static_cast<double>(a.size());
  };
  CHECK(driver.control(toggle).value == "off");
  const auto without = space();
  driver.press('U');
  driver.settle();
  CHECK(driver.control(toggle).value == "on");
  CHECK(changed(without, space()) > 0.05);
  // Remembered as a look.
  CHECK(driver.state().preferences.show.label_surface);
  driver.press('U');  // the pointer stays where it is: a tip would lie over the view
  driver.settle();
  CHECK(driver.control(toggle).value == "off");
  CHECK(changed(without, space()) < 0.005);
}

}  // namespace homolog
