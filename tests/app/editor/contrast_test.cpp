#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/driver.h"
#include "tests/organ_scan.h"
#include "tests/screens.h"
#include "tests/seen_colours.h"

// Whether what is drawn can be told from what it is drawn on: by the colours of the pixels, in the light theme and the
// dark one.

namespace homolog {

namespace {

test::Light linear_rgb(const Picture& picture, std::size_t pixel) {
  const std::uint8_t* rgba = &picture.rgba[4 * pixel];
  return test::light_of({rgba[0] / 255.0, rgba[1] / 255.0, rgba[2] / 255.0});
}

double luminance(const Picture& picture, std::size_t pixel) {
  const auto [r, g, b] = linear_rgb(picture, pixel);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/// The contrast ratio of WCAG 2 between the lightest and the darkest pixel of a rectangle: 1 … 21.
double contrast_in(const Picture& picture, const RectPx& rect) {
  double low = 1, high = 0;
  for (int y = static_cast<int>(rect.y); y < static_cast<int>(rect.y + rect.height); ++y)
    for (int x = static_cast<int>(rect.x); x < static_cast<int>(rect.x + rect.width); ++x) {
      const double here = luminance(picture, static_cast<std::size_t>(y * picture.width + x));
      low = std::min(low, here);
      high = std::max(high, here);
    }
  return (high + 0.05) / (low + 0.05);
}

bool holds_middle(const RectPx& outer, const RectPx& inner) {
  return outer.contains(inner.x + inner.width / 2, inner.y + inner.height / 2);
}

/// Texts with less contrast than they need: 4 where they are read, 2 where they belong to what is disabled.
std::string faint_texts(Driver& driver) {
  const Picture picture = driver.picture();
  std::string faint;
  int looked_at = 0;
  for (const DrawnItem& text : driver.items()) {
    if (text.kind != DrawnItem::Kind::text || !(text.seen == text.rect)) continue;
    const bool disabled = std::any_of(driver.items().begin(), driver.items().end(), [&](const DrawnItem& item) {
      return item.is_control() && !item.enabled && holds_middle(item.rect, text.rect);
    });
    // A slider's label lies beside its track.
    const bool beside = std::any_of(driver.items().begin(), driver.items().end(), [&](const DrawnItem& item) {
      return item.kind == DrawnItem::Kind::track && !item.enabled && std::abs(item.rect.y - text.rect.y) < 12;
    });
    const double contrast = contrast_in(picture, text.seen);
    ++looked_at;
    if (contrast < (disabled || beside ? 2 : 4)) faint += "\n  " + text.path + ": " + std::to_string(contrast);
  }
  CHECK(looked_at > 60);
  return faint;
}

}  // namespace

TEST_CASE("every text stands out in the light theme and in the dark one") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  for (const bool light : {true, false}) {
    Driver driver(scan.document(), {1280, 1500, 1});
    driver.app().send(UseLightTheme{light});
    for (const char* section : {"Template", "Place", "Export"}) driver.app().send(OpenSection{section, true});
    driver.settle();
    CAPTURE(light);
    CHECK(faint_texts(driver) == "");
  }
}

TEST_CASE("an outline without a region stands out on every grey of an image") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), {900, 700, 1});
  driver.state().preferences.panel_open = false;
  driver.state().look.maximised = ViewKind::axial;
  driver.state().look.colouring = Colouring::regions;
  driver.state().preferences.show.crosshair = false;
  // The organ has 150 HU: black, dark, middle, light and white.
  for (const auto& [low, high] :
       {std::pair(160, 600), std::pair(50, 550), std::pair(0, 300), std::pair(-400, 250), std::pair(-900, 100)}) {
    driver.state().look.window_low = low;
    driver.state().look.window_high = high;
    driver.state().preferences.show.outline = true;
    driver.settle();
    const Picture with = driver.picture();
    driver.state().preferences.show.outline = false;
    const Picture without = driver.picture();
    const RectPx image = driver.app().layout().image(ViewKind::axial);
    const test::PixelMask outline = test::differing_pixels(with, without, test::plain_difference);
    std::vector<double> differences;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const auto x = static_cast<double>(i % static_cast<std::size_t>(with.width)),
                 y = static_cast<double>(i / static_cast<std::size_t>(with.width));
      if (!outline[i] || !image.contains(x, y)) continue;
      differences.push_back(test::colour_difference(linear_rgb(with, i), linear_rgb(without, i)));
    }
    REQUIRE(differences.size() > 300);
    std::ranges::nth_element(differences, differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2));
    CHECK_MESSAGE(differences[differences.size() / 2] > 40, "window ", low, " … ", high);
  }
}

TEST_CASE("the name of a landmark off the slice is read on white bone") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), {900, 700, 1});
  driver.state().preferences.panel_open = false;
  driver.state().look.maximised = ViewKind::axial;
  driver.state().preferences.show.crosshair = false;
  driver.state().preferences.show.outline = false;
  driver.state().look.window_low = -900;
  driver.state().look.window_high = 100;  // the organ is white
  constexpr double off_mm = 6.5;          // of 8 at which it would be gone
  driver.app().send(ApplyEdit{PlaceLandmark{"hilum", Vec3(0, 0, off_mm)}});
  driver.app().send(LookAt{Vec3::Zero()});
  driver.settle();
  const Picture picture = driver.picture();
  int names = 0;
  for (const DrawnItem& text : driver.items())
    if (text.kind == DrawnItem::Kind::text && text.name == "hilum" &&
        driver.app().layout().image(ViewKind::axial).contains(text.rect.x, text.rect.y)) {
      ++names;
      CHECK(contrast_in(picture, text.seen) > 6);
    }
  CHECK(names == 1);
}

}  // namespace homolog
