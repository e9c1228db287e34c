#include <doctest/doctest.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "app/editor/update/file_purposes.h"
#include "app/editor/update/tools/tool.h"
#include "app/editor/widgets/widgets.h"
#include "app/editor/work/files/file_browsing.h"
#include "core/catalogue/catalogue.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/named_case.h"
#include "tests/skip.h"

// Whether all that the window shows has room, at every size, looked at without pixels: each text and each control says
// where it is drawn, and what cuts it.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// What everything is called that has a name, and how much there is of it.
struct Names {
  const char* what;
  std::vector<std::string> names;
};

std::vector<std::string> numbered(const std::string& name, int count) {
  std::vector<std::string> names;
  for (int k = 1; k <= count; ++k) names.push_back(name + std::to_string(k));
  return names;
}

std::vector<Names> all_names() {
  std::string longest;
  for (int k = 0; k < 12; ++k) longest += "very_long_name_";
  return {{"no data", {}},
          {"one", {"kidney"}},
          {"many", numbered("kidney ", 14)},
          {"very long", numbered(longest, 4)},
          {"non-Latin",
           {"\xe8\x85\x8e\xe8\x87\x93 \xe5\xb7\xa6", "\xd0\xbf\xd0\xbe\xd1\x87\xd0\xba\xd0\xb0",
            "\xec\x8b\xa0\xec\x9e\xa5", "\xce\xbd\xce\xb5\xcf\x86\xcf\x81\xcf\x8c\xcf\x82"}}};
}

struct Sizes {
  int width, height;
};
constexpr std::array<Sizes, 8> sizes{
    {{800, 600}, {900, 640}, {1024, 768}, {1280, 720}, {1280, 800}, {1600, 1000}, {1920, 1080}, {2560, 1440}}};
constexpr std::array<float, 3> scales{1, 1.5f, 3};

float right_of(const RectPx& r) {
  return r.x + r.width;
}
float bottom_of(const RectPx& r) {
  return r.y + r.height;
}
bool meet(const RectPx& a, const RectPx& b, float by) {
  return std::min(right_of(a), right_of(b)) - std::max(a.x, b.x) > by &&
         std::min(bottom_of(a), bottom_of(b)) - std::max(a.y, b.y) > by;
}
bool holds(const RectPx& outer, const RectPx& inner, float by) {
  return inner.x >= outer.x - by && inner.y >= outer.y - by && right_of(inner) <= right_of(outer) + by &&
         bottom_of(inner) <= bottom_of(outer) + by;
}

std::string short_path(const DrawnItem& item) {
  return item.path.size() < 120 ? item.path : item.path.substr(0, 60) + "..." + item.path.substr(item.path.size() - 50);
}

/// What has no room: cut, or lying partly on something else. `ignored` are texts that may cover others.
void add_faults(const std::vector<DrawnItem>& items, float scale, const std::vector<std::string>& ignored,
                const std::string& where, std::set<std::string>& faults) {
  const float by = 1.5f * scale;
  std::vector<const DrawnItem*> looked_at;
  for (const DrawnItem& item : items) {
    if (item.kind == DrawnItem::Kind::tip || item.kind == DrawnItem::Kind::area || item.rect.width <= 0) continue;
    const bool of_view = item.path.find(" view/") != std::string::npos;
    if (of_view && std::find(ignored.begin(), ignored.end(), item.name) != ignored.end()) continue;
    looked_at.push_back(&item);
    // The cross of a dialog never scrolls: what is in the dialog fits it.
    if (item.name == "close" && item.scrolls) faults.insert(short_path(item) + " scrolls" + where);
    const bool cut_sideways = item.rect.x < item.clip.x - by || right_of(item.rect) > right_of(item.clip) + by;
    const bool cut_above_or_below =
        !item.scrolls && (item.rect.y < item.clip.y - by || bottom_of(item.rect) > bottom_of(item.clip) + by);
    if (cut_sideways || cut_above_or_below) faults.insert(short_path(item) + " is cut" + where);
  }
  for (std::size_t i = 0; i < looked_at.size(); ++i) {
    for (std::size_t k = i + 1; k < looked_at.size(); ++k) {
      const DrawnItem &a = *looked_at[i], &b = *looked_at[k];
      if (a.layer != b.layer || !meet(a.seen, b.seen, by)) continue;
      const bool both_texts = !a.is_control() && !b.is_control();
      const bool same_text = both_texts && a.name == b.name && holds(a.rect, b.rect, by);  // drawn with its shadow
      const bool one_in_other = holds(a.rect, b.rect, by) || holds(b.rect, a.rect, by);
      if (both_texts ? !same_text : !one_in_other) faults.insert(short_path(a) + " lies on " + short_path(b) + where);
    }
  }
}

/// The window with some names, taken through its screens at all sizes.
class Screens {
 public:
  explicit Screens(const Names& names) : what_(names.what), named_(names.names), driver_(named_.document) {}

  std::set<std::string> faults() {
    prepare();
    for (const float scale : scales) {
      for (const Sizes& size : sizes) {
        scale_ = scale;
        driver_.resize({static_cast<int>(static_cast<float>(size.width) * scale),
                        static_cast<int>(static_cast<float>(size.height) * scale), scale});
        where_ = ", " + std::string(what_) + ", " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                 " at scale " + std::to_string(scale).substr(0, 3);
        look_at_case();
        look_at_models();
        look_at_dialogs();
        if (faults_.size() > 40) return faults_;
      }
    }
    return faults_;
  }

 private:
  EditorState& state() { return driver_.state(); }

  void prepare() {
    for (const char* section : {"Case", "Template", "Place", "Deform", "Correspondence", "Export", "Model", "Measures",
                                "Optimise", "To check", "Pictures"})
      state().preferences.sections_open[section] = true;
    state().preferences.show.glyphs = true;
    if (named_.names.empty()) return;
    for (const std::string& name : named_.names) {
      driver_.app().send(ApplyEdit{SetRegion{{name, 2, {200, 100, 50}}}, false});
      driver_.app().send(ApplyEdit{PlaceLandmark{name, Vec3(10, 20, 30)}, false});
    }
    driver_.app().send(open_labels(named_.labels));
    driver_.settle();
    driver_.app().send(NewStudy{{named_.folder.path / (named_.names.front().substr(0, 200) + ".study.json")}});
    driver_.settle();
    driver_.app().send(AddCases{named_.shapes});
    driver_.settle();
    for (const std::string& name : named_.names) {
      driver_.app().send(SetCaseText{name.substr(0, 200), "group", name});
      driver_.app().send(SetCaseText{name.substr(0, 200), "notes", name});
    }
    driver_.app().send(SelectCase{named_.names.front().substr(0, 200)});
    driver_.app().send(StartEvaluation{});
    driver_.settle();
    state().notices.clear();
  }

  void look(const char* screen) {
    driver_.frames(2);
    add_faults(driver_.items(), scale_, named_.names, std::string(" (") + screen + where_ + ")", faults_);
  }

  void look_at_case() {
    state().models.shown = false;
    state().look.maximised.reset();
    state().preferences.panel_open = true;
    state().preferences.hints = {};
    for (const MouseTool tool : {MouseTool::pull, MouseTool::relax, MouseTool::landmark}) {
      state().hand.tool = tool;
      look(kind_of(tool).name);
    }
    state().preferences.hints = {true, true, true};
    state().hand.tool = MouseTool::stiffness;
    for (const BrushPaints paints : {BrushPaints::factor, BrushPaints::region, BrushPaints::fill}) {
      state().hand.brush.paints = paints;
      look("a brush");
    }
    state().hand.tool = MouseTool::confirm;
    look("Confirm");
    state().hand.tool = MouseTool::pull;
    state().preferences.panel_open = false;
    state().look.maximised = ViewKind::space;
    look("one view");
    state().look.maximised.reset();
    state().preferences.panel_open = true;
    const std::string name = named_.names.empty() ? "ct" : named_.names.front();
    for (int k = 0; k < 4; ++k)
      add_notice(state(), Notice{.text = "/a/folder/" + std::to_string(k) + "/" + name + "/" + name +
                                         ".nii.gz could not be read: the file ends early; copy it again.",
                                 .error = k % 2 == 0,
                                 .kept = k == 1 ? fs::path(name) : fs::path()});
    look("notices");
    state().notices.clear();
  }

  void look_at_models() {
    state().models.shown = true;
    look("Models");
    for (const bool difference : {false, true}) {
      state().models.view.show_difference = difference && state().models.made.model && named_.names.size() > 3;
      state().models.view.all_modes = true;
      look("Models, all modes");
    }
    look_at_optimisation();
    state().saving.picture.study = StudyPicture::modes;
    look("Models, a picture of the modes");
    state().saving.picture.study.reset();
    state().models.view.show_difference = false;
    state().models.shown = false;
  }

  void look_at_optimisation() {
    StudyOptimisation& optimisation = state().models.made.optimisation;
    optimisation.of = std::make_shared<const StudyToOptimise>(StudyToOptimise{state().models.shapes.fitted});
    optimisation.bits = {123.45, 120.1};
    look("Models, an optimisation runs");
    auto done = std::make_shared<OptimisedStudy>();
    done->before = {123.456, 1, 3, 0.8, 12.3456, 10.1234};
    done->after = {120.1, 1, 3, 0.9, 10.1, 10.1};
    optimisation.done = std::move(done);
    optimisation.shown = true;
    look("Models, optimised");
    optimisation = {};
  }

  void show(Dialog dialog, const char* screen) {
    state().dialog = std::move(dialog);
    look(screen);
    state().dialog.reset();
  }

  void look_at_dialogs() {
    const std::string name = named_.names.empty() ? "ct" : named_.names.front();
    const fs::path file = fs::path("/a/folder") / name / (name + ".homolog");
    show(KeysDialog{}, "keys");
    state().models.shown = true;
    show(KeysDialog{}, "keys of Models");
    state().models.shown = false;
    for (const FilePurpose purpose : {FilePurpose::open, FilePurpose::save_case, FilePurpose::add_shapes}) {
      FileDialog files{purpose, browse(file_purpose(purpose).files, named_.folder.path, name)};
      files.browser.name.clear();
      show(files, "files");
    }
    show(ReplaceDialog{{}, file}, "replace");
    show(SeriesDialog{{}, {{"1.2.3.4", name, "CT", 120}, {"1.2.3.5", "", "MR", 1}}}, "series");
    show(FlipDialog{name, {}, {}}, "flip");
    show(RecoverDialog{{{file, name, "12 edits, 14 March 2026, 16:02"}, {file / "b", name, "1 edit"}}, file},
         "recover");
    show(QuitDialog{}, "quit");
    show(QuitDialog{file}, "quit without the study");
    show(SpacingDialog{{}, Vec3(0.123, 10.5, 1000)}, "spacing");
    show(ResampleDialog{{},
                        "slices that are shifted sideways against one another (a tilted gantry), and unevenly "
                        "spaced slices: 12.dcm (103.00 mm) and 13.dcm (108.00 mm) lie 5.00 mm apart, the others "
                        "2.50 mm"},
         "resampling");
  }

  const char* what_;
  Named named_;
  Driver driver_;
  float scale_ = 1;
  std::string where_;
  std::set<std::string> faults_;
};

std::string listed_faults(const std::set<std::string>& faults) {
  std::string text;
  for (const std::string& fault : faults) text += "\n  " + fault;
  return text;
}

}  // namespace

TEST_CASE("no text and no control is cut or covered at any size of the window") {
  for (const Names& names : all_names()) {
    const auto faults = Screens(names).faults();
    if (!faults.empty()) FAIL_CHECK(std::string(names.what) << ":" << listed_faults(faults));
  }
}

TEST_CASE("what has no room is found") {
  Driver driver(new_document({}, nullptr, nullptr));
  std::vector<DrawnItem> items = driver.items();
  std::set<std::string> faults;
  add_faults(items, 1, {}, "", faults);
  CHECK(faults.empty());
  const auto some = std::find_if(items.begin(), items.end(), [](const DrawnItem& item) { return item.name == "save"; });
  REQUIRE(some != items.end());
  DrawnItem beside = *some, below = *some;
  beside.rect.x += beside.rect.width / 2;
  beside.seen = beside.rect;
  below.rect.y = bottom_of(below.clip) - 2;
  below.seen.width = 0;
  items.push_back(beside);
  items.push_back(below);
  add_faults(items, 1, {}, "", faults);
  CHECK(std::any_of(faults.begin(), faults.end(), [](const auto& f) { return f.find("lies on") != f.npos; }));
  CHECK(std::any_of(faults.begin(), faults.end(), [](const auto& f) { return f.find("is cut") != f.npos; }));
}

namespace {

const DrawnItem* tip_in(const std::vector<DrawnItem>& items) {
  const auto tip =
      std::find_if(items.begin(), items.end(), [](const DrawnItem& i) { return i.kind == DrawnItem::Kind::tip; });
  return tip == items.end() ? nullptr : &*tip;
}

void point_at_middle(Driver& driver, const DrawnItem& item) {
  driver.move(item.seen.x + item.seen.width / 2, item.seen.y + item.seen.height / 2);
  driver.frame();
}

/// Points at every control on the screen in turn, and looks at where its tip lies.
int check_tips(Driver& driver, const Driver::Size& size) {
  driver.resize(size);
  driver.settle();
  const RectPx window{0, 0, static_cast<float>(size.width_px), static_cast<float>(size.height_px)};
  int tips = 0;
  const std::vector<DrawnItem> all = driver.items();
  for (const DrawnItem& item : all) {
    if (!item.is_control() || item.tip.empty() || item.seen.height < 8 || item.seen.width < 8) continue;
    if (item.path.starts_with("gallery") || item.path.starts_with("model/")) continue;
    point_at_middle(driver, item);
    const std::vector<DrawnItem> shown = driver.items();
    const DrawnItem* tip = tip_in(shown);
    if (tip == nullptr) continue;
    ++tips;
    CHECK_MESSAGE(holds(window, tip->rect, 0), item.path);
    const float side = 8 * size.scale, above = 6 * size.scale;  // of the box around the text
    const RectPx box{tip->rect.x - side, tip->rect.y - above, tip->rect.width + 2 * side, tip->rect.height + 2 * above};
    for (const DrawnItem& other : shown)
      if (other.is_control() && other.kind != DrawnItem::Kind::area)
        CHECK_MESSAGE(!meet(box, other.seen, 1), "the tip of " << item.path << " covers " << other.path);
  }
  return tips;
}

}  // namespace

TEST_CASE("a tooltip lies within the window and covers no control") {
  const Named named({"kidney", "other"});
  Driver driver(named.document);
  driver.app().send(AddCases{named.shapes});
  driver.settle();
  driver.state().notices.clear();
  for (const Driver::Size& size : {Driver::Size{800, 600, 1}, Driver::Size{1280, 800, 1}, Driver::Size{1100, 1500, 1},
                                   Driver::Size{2560, 1600, 2}}) {
    driver.state().models.shown = false;
    CHECK(check_tips(driver, size) > 30);
    driver.state().models.shown = true;
    CHECK(check_tips(driver, size) > 10);
  }
}

TEST_CASE("a dialog covers what lies under it and its tooltips") {
  Driver driver(new_document({}, nullptr, nullptr));
  driver.point_at("top bar/save");
  CHECK(tip_in(driver.items()) != nullptr);
  driver.press(key::f1);
  CHECK(driver.shows("Keys and mouse"));
  CHECK(tip_in(driver.items()) == nullptr);
  CHECK_FALSE(driver.control("top bar/save").hovered);
}

}  // namespace homolog
