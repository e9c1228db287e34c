#include <doctest/doctest.h>

#include <array>
#include <cstdlib>

#include "app/editor/update/controls.h"
#include "app/editor/work/opening/demo.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/screens.h"

// The guide to the first case, as a newcomer sees it: in the view of each pull there is an arrow, and nothing covers
// it.

namespace homolog {

namespace {

/// How many px around a place have the colour of the guide's arrow.
int px_of_arrow(const Picture& picture, const Eigen::Vector2d& at, int reach) {
  int count = 0;
  for (int y = static_cast<int>(at.y()) - reach; y <= static_cast<int>(at.y()) + reach; ++y)
    for (int x = static_cast<int>(at.x()) - reach; x <= static_cast<int>(at.x()) + reach; ++x) {
      if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) continue;
      const std::uint8_t* px =
          &picture.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                             static_cast<std::size_t>(x))];
      count += std::abs(px[0] - 0x5B) < 12 && std::abs(px[1] - 0xAE) < 12 && std::abs(px[2] - 0xFF) < 12;
    }
  return count;
}

bool meet(const RectPx& a, const RectPx& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

constexpr std::array<const char*, 4> view_names{"axial view", "sagittal view", "coronal view", "3D view"};

}  // namespace

TEST_CASE("each of the five pulls has an arrow in the view that the guide names and nothing covers that view") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const FirstCase first = test::must(first_case());
  Driver driver(first.document, {800, 600, 1});
  driver.state().guide = first.guide;
  driver.app().send(ShowGuide{true});
  driver.settle();
  for (std::size_t k = 0; k < first.guide.steps.size(); ++k) {
    CAPTURE(k);
    const GuideStep& step = first.guide.steps[k];
    CHECK(driver.shows(view_names[index_of(step.view)]));
    const auto at = view_map(driver.state(), driver.app().layout(), driver.document(), step.view).to_px(step.to_mm);
    REQUIRE(at);
    const RectPx& view = driver.app().layout().image(step.view);
    CHECK(view.contains(at->x(), at->y()));
    constexpr int reach = 45, fewest = 70;  // the arrow and its bar, without what lies under the dot
    CHECK(px_of_arrow(driver.picture(), *at, reach) > fewest);
    for (const char* name : {"guide/Back", "guide/Show", "guide/Skip", "guide/Close"})
      CHECK_FALSE(meet(driver.control(name).rect, view));
    driver.click("guide/Skip");
    driver.settle();
  }
  CHECK(driver.shows("First steps: done"));

  // Where another view is enlarged, or the view was moved away, the pull's is brought back.
  driver.app().send(ShowGuide{true});
  driver.app().send(MaximiseView{ViewKind::space});
  driver.state().look.slices[index_of(ViewKind::coronal)].centre_mm += Vec3(300, 0, 0);
  driver.settle();
  driver.click("guide/Show");
  CHECK(driver.state().look.maximised == ViewKind::coronal);
  const Vec3 to_mm = first.guide.steps.front().to_mm;
  const auto at = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::coronal).to_px(to_mm);
  CHECK(driver.app().layout().image(ViewKind::coronal).contains(at->x(), at->y()));

  // Among the models there is nothing to pull, and the guide would cover their buttons.
  driver.app().send(ShowModels{true});
  driver.settle();
  CHECK_FALSE(driver.shows("guide/Show"));
  CHECK_FALSE(driver.shows("First steps: pull 1 of 5"));
  driver.app().send(ShowModels{false});
  driver.settle();
  CHECK(driver.shows("First steps: pull 1 of 5"));
}

}  // namespace homolog
