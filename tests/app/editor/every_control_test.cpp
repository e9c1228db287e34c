#include <doctest/doctest.h>

#include <chrono>
#include <set>
#include <thread>

#include "core/mesh/icosphere.h"
#include "core/mesh/label_map.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/must.h"

// Every control that the program draws is operated, and does something. The list of controls is what the program itself
// says that it draws, so that a new one is operated too.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A ball on an image of it, with regions and landmarks, and its label map in a file.
struct BallScene {
  TemporaryFolder folder;
  fs::path label = folder.path / "label.nii.gz";
  Document document;

  BallScene() {
    const Mesh mesh = icosphere(3, 40);
    MeshFile ball{mesh.points, mesh.topology->triangles()};
    ball.landmarks = {{"north", Vec3(0, 0, 40)}, {"south", Vec3(0, 0, -40)}, {"west", Vec3(40, 0, 0)}};
    const fs::path file = folder.path / "ball.ply";
    REQUIRE(write_mesh_file(ball, file));
    VolumeGeometry grid;
    grid.dims = {60, 60, 60};
    grid.spacing_mm.setConstant(1.6);
    grid.origin_mm.setConstant(-47);
    const Volume labels = label_map(icosphere(4, 37), grid, 1);
    REQUIRE(write_volume(labels, label));
    document = new_document("", std::make_shared<const Volume>(labels), test::must(load_template(file.string())));
  }
};

class Operator {
 public:
  explicit Operator(Driver& driver) : driver_(driver) {}

  /// Operates all controls of a part of the window, also those that appear meanwhile.
  void operate(const std::string& part) {
    for (int k = 0; k < 300; ++k) {
      const auto next = wanted(part);
      if (!next) return;
      done_.insert(next->pattern);
      const std::string before = fingerprint();
      use(*next);
      // Some work goes on beside the window, and nobody waits for it.
      for (int wait = 0; wait < 200 && fingerprint() == before; ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        driver_.frame();
      }
      if (fingerprint() == before) dead_ += "\n  " + next->path;
      tidy();
    }
    FAIL("the controls of " << part << " come to no end");
  }
  const std::string& dead() const { return dead_; }
  std::size_t operated() const { return done_.size(); }

 private:
  std::optional<DrawnItem> wanted(const std::string& part) const {
    for (const DrawnItem& item : driver_.items()) {
      if (!item.is_control() || !item.enabled || !item.path.starts_with(part) || done_.contains(item.pattern)) continue;
      const bool chosen = item.kind == DrawnItem::Kind::choice && item.value == "on";
      const bool closes = item.kind == DrawnItem::Kind::section && item.value == "on";
      if (!chosen && !closes) return item;
    }
    return std::nullopt;
  }

  void use(const DrawnItem& item) {
    switch (item.kind) {
      case DrawnItem::Kind::track:
        driver_.hold_and_move(item.path, item.rect.width / 7, 0);
        driver_.let_go();
        break;
      case DrawnItem::Kind::area:
        driver_.hold_and_move(item.path, 40, 10);
        driver_.let_go();
        break;
      case DrawnItem::Kind::number:
        driver_.type_into(item.path, "7");
        driver_.press(key::enter);
        break;
      case DrawnItem::Kind::field:
        driver_.type_into(item.path, "a name");
        driver_.press(key::enter);
        break;
      default:
        driver_.click(item.path);
    }
    driver_.settle();
  }

  /// What a person could see of a change, and what is written of it.
  std::string fingerprint() const {
    std::string all = std::to_string(driver_.app().log().lines().size()) + ' ' +
                      std::to_string(driver_.app().snapshot().committed) + ' ' +
                      std::to_string(driver_.state().notices.size());
    for (const DrawnItem& item : driver_.items())
      if (item.kind != DrawnItem::Kind::tip) all += '\n' + item.path + '=' + item.value;
    return all;
  }

  void tidy() {
    for (int k = 0; k < 5 && (driver_.state().dialog || driver_.has("menu")); ++k) driver_.press(key::escape);
    while (!driver_.state().notices.empty()) driver_.app().send(DismissNotice{0}), driver_.settle();
    driver_.settle();
  }

  Driver& driver_;
  std::set<std::string> done_;
  std::string dead_;
};

}  // namespace

TEST_CASE("every control of the case does something") {
  const BallScene scene;
  Driver driver(scene.document, {1280, 2400, 1});
  driver.app().send(open_labels(scene.label));
  driver.settle();
  for (const char* section : {"Template", "Place", "Export"}) {
    driver.app().send(OpenSection{section, true});
    driver.settle();
  }
  driver.app().send(ApplyEdit{SetRegion{{"cap", 2, {255, 0, 0}}}});
  driver.settle();
  Operator hands(driver);
  for (const char* part : {"tool strip", "side panel/Correspondence", "side panel/Deform", "side panel/Place",
                           "side panel/Template", "side panel/Export", "side panel/Case", "axial", "top bar"})
    hands.operate(part);
  CHECK(hands.operated() > 120);
  CHECK_MESSAGE(hands.dead().empty(), "These do nothing:", hands.dead());
}

TEST_CASE("every control of the models does something") {
  const BallScene scene;
  Driver driver(scene.document, {1280, 1600, 1});
  driver.app().send(OpenPhantomStudy{});
  driver.wait_until("the model is made", [&] { return driver.state().models.model != nullptr; });
  driver.settle();
  Operator hands(driver);
  for (const char* part : {"gallery", "model", "side panel", "cases"}) hands.operate(part);
  CHECK(hands.operated() > 50);
  CHECK_MESSAGE(hands.dead().empty(), "These do nothing:", hands.dead());
}

}  // namespace homolog
