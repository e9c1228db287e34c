#include <doctest/doctest.h>

#include <array>
#include <climits>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "app/editor/update/command_log.h"
#include "core/case/action_json.h"
#include "core/case/actions/fields.h"

// A command's line holds every member, whatever its value.

namespace homolog {

namespace {

using OrderedJson = Fields::Json;

template <class... Listed>
std::vector<Command> one_of_each_listed(TypeList<Listed...>) {
  return {Listed{}...};
}

/// Commands with members that they have only sometimes.
std::vector<Command> full_commands() {
  std::vector<Command> commands = one_of_each_listed(AllCommands());
  commands.emplace_back(SnapMesh{SnapArea{Vec3(1, 2, 3), 4}, true});
  AnimateMode animated;
  animated.mode = 3;
  commands.emplace_back(animated);
  FitSettings fit;
  fit.closing_mm = 2;
  fit.partial = fit.all_labels = true;
  commands.emplace_back(StartFit{fit});
  for_each_action_kind([&](const auto& kind) {
    const Action action = action_from_json(OrderedJson::parse(kind.example)).value();
    commands.emplace_back(ApplyEdit{action, true});
    commands.emplace_back(PreviewEdit{action});
  });
  return commands;
}

/// Values that a member of the same kind may have.
std::vector<OrderedJson> others(const OrderedJson& value, const std::string& key, std::mt19937& random) {
  const bool is_length = key.ends_with("_mm");
  std::uniform_real_distribution<double> some(-1e6, 1e6);
  if (value.is_boolean()) return {!value.get<bool>()};
  if (value.is_number_integer())
    return {0,
            7,
            1000,
            -1,
            -3,
            static_cast<int>(random()),
            INT_MIN,
            INT_MAX,
            std::uint64_t{1} << 40,
            std::numeric_limits<std::uint64_t>::max()};
  if (value.is_number_float() && is_length) return {0.1, some(random), -1e9, 1e9, 1e-300};
  if (value.is_number_float() && key == "scale") return {1e-6, 1e6, 1 / 3.0};
  if (value.is_number_float()) return {0.1, some(random), -1e300, 1e300, 5e-324};
  if (value.is_string() && key != "do") return {"", "a", "left", "region", "b/\"c\" ü\n" + std::to_string(random())};
  return {};
}

/// Calls `visit` for the line with each of its members, of which each is another for a while.
template <class Visit>
void with_others(OrderedJson& line, OrderedJson& part, std::mt19937& random, const Visit& visit) {
  if (part.is_object()) {
    for (auto& [key, value] : part.items()) {
      const OrderedJson before = value;
      for (const OrderedJson& other : others(before, key, random)) {
        value = other;
        visit(key, other);
      }
      value = before;
      with_others(line, value, random, visit);
    }
  } else if (part.is_array() && part.size() == 3 && part[0].is_number_float()) {
    const OrderedJson before = part;
    for (const double mm : {-1e9, 1e9, -0.1, 1e-300}) {
      part[1] = mm;
      visit("a place", part[1]);
    }
    part = before;
  }
}

}  // namespace

TEST_CASE("a command's line reads back as it was whatever each of its members is") {
  std::mt19937 random(1);
  std::size_t tried = 0;
  std::set<std::string> keys;
  for (const Command& command : full_commands()) {
    OrderedJson line = OrderedJson::parse(log_line(command));
    with_others(line, line, random, [&](const std::string& key, const OrderedJson& value) {
      // Packed numbers belong to as many vertices as they say.
      if (key == "landmarks") return;
      const auto read = command_of_line(line.dump());
      INFO(key << " in " << line.dump());
      ++tried;
      // Whole numbers may be too large for a member, or negative; what is there at all may need other members; an
      // action may refuse what no case can hold. A word may be one of few.
      const bool may_refuse =
          value.is_boolean() || value.is_string() || (value.is_number_integer() && (value < 0 || value > 1000));
      if (!read && !may_refuse && line["do"] != "edit" && line["do"] != "preview") FAIL_CHECK(read.error().sentence());
      if (!read) return;
      // Whether a member is there may depend on another one, which is true or false. An empty word may be left out.
      if (value.is_boolean() || value == "")
        CHECK(log_line(command_of_line(log_line(*read)).value()) == log_line(*read));
      else
        CHECK(OrderedJson::parse(log_line(*read)) == line);
      keys.insert(key);
    });
  }
  CHECK(tried > 300);
  for (const char* key : {"steps", "name", "path", "paints", "region"}) CHECK(keys.contains(key));
}

TEST_CASE("the lines of the commands that are rows stay as logs have them") {
  for (
      const std::string line : {
          R"({"do":"look from side","side":"left"})",
          R"({"do":"maximise view","view":"3D"})",
          R"({"do":"maximise view","view":null})",
          R"({"do":"link zoom","linked":true})",
          R"({"do":"show parts","outline":false,"surface":true,"planes":false,"glyphs":true,"wireframe":true,)"
          R"("crosshair":false,"letters":true,"label_surface":true,"plane_look":2})",
          R"({"do":"show panel","shown":true})",
          R"({"do":"interpolate image","linear":true})",
          R"({"do":"show radiological","radiological":true})",
          R"({"do":"use light theme","light":true})",
          R"({"do":"set label opacity","opacity":0.35})",
          R"({"do":"set others opacity","opacity":0.35})",
          R"({"do":"set structure gap","gap_mm":1.5})",
          R"({"do":"space glyphs","spacing_mm":7.5})",
          R"({"do":"show models","shown":true})",
          R"({"do":"set sigma","sigma_mm":6.25})",
          R"({"do":"set relax strength","strength":0.75})",
          R"({"do":"move through space","through":true})",
          R"({"do":"set brush","radius_mm":4.5,"paints":"smooth","region":"apex","erases":true,"fill_by":"curvature",)"
          R"("fill_tolerance_per_mm":0.02,"stiffness_factor":0.5,"soft":0.25,"hold":false})",
          R"({"do":"name template landmark","name":"apex"})",
          R"({"do":"type region","name":"base"})",
          R"({"do":"name region","name":"base","to":"top"})",
          R"({"do":"name region","name":null,"to":null})",
          R"({"do":"change number","control":"scale","value":1.5})",
          R"({"do":"change number","control":null,"value":null})",
          R"({"do":"set fit","label":3,"all_labels":true,"closing_mm":2.5,"as_placed":true,"model":"file",)"
          R"("partial":true,"beyond":0.5})",
          R"({"do":"set template","label":2,"all_labels":true,"tube":true,"part":true,"faced":[0,3],"facing":false,"organ_options":{"vertices":900,)"
          R"("closing_mm":1.5,"opening_mm":null,"tunnels":"number","genus":2},"tube_options":{"rings":9,"sectors":12,)"
          R"("capped":true},"outer_label":4,"axis_by_ruler":true})",
          R"({"do":"show stage","stage":3})",
          R"({"do":"export all frames","all":true})",
          R"({"do":"set picture","view":"coronal","width":640,"height":480,"transparent":true,"light":true,)"
          R"("captions":false,"study":"modes"})",
          R"({"do":"name folder","name":"new"})",
          R"({"do":"name folder","name":null})",
          R"({"do":"set stack spacing","spacing_mm":[0.5,0.5,2.0]})",
          R"({"do":"ask to discard","journal":"a/b.case"})",
          R"({"do":"set study template","path":"a/b.ply"})",
          R"({"do":"select case","name":"anna"})",
          R"({"do":"select next case"})",
          R"({"do":"remove case","name":"anna"})",
          R"({"do":"cycle case state","name":"anna"})",
          R"({"do":"type case text","field":"group","text":"a"})",
          R"({"do":"flip cases","names":["anna","bert"]})",
          R"({"do":"add frames","name":"anna"})",
          R"({"do":"filter cases","filter":"an"})",
          R"({"do":"sort cases","column":"distance"})",
          R"({"do":"show distance","pair":2})",
          R"({"do":"look from side in gallery","side":"posterior"})",
          R"({"do":"fit gallery"})",
          R"({"do":"zoom gallery","steps":-1.5})",
          R"({"do":"point at vertex","any":true,"shape":2,"vertex":17})",
          R"({"do":"point at vertex","any":false})",
          R"({"do":"show gallery glyphs","shown":true})",
          R"({"do":"space gallery glyphs","spacing_mm":7.5})",
          R"({"do":"show mean"})",
          R"({"do":"show sample"})",
          R"({"do":"show all modes","all":true})",
          R"({"do":"choose alignment","alignment":"rigid"})",
          R"({"do":"show optimised","shown":true})",
          R"({"do":"discard optimised"})",
      }) {
    INFO(line);
    const auto read = command_of_line(line);
    REQUIRE(read);
    CHECK(log_line(*read) == line);
  }
}

TEST_CASE("steps back in the history and in the guide are read from a log") {
  for (const int steps : {-3, -1, INT_MIN, INT_MAX}) {
    const auto back = command_of_line(log_line(GoInHistory{steps}));
    REQUIRE(back);
    CHECK(log_line(*back) == log_line(GoInHistory{steps}));
    CHECK(log_line(GoInHistory{steps}).find("\"steps\":" + std::to_string(steps)) != std::string::npos);
    const auto in_guide = command_of_line(log_line(MoveInGuide{steps}));
    REQUIRE(in_guide);
    CHECK(log_line(*in_guide) == log_line(MoveInGuide{steps}));
  }
}

TEST_CASE("a line of a log with a number that no case needs is refused") {
  for (const char* bad :
       {R"({"do":"look at","point_mm":[0,0,1e308]})", R"({"do":"look at","point_mm":[0,-1.1e9,0]})"}) {
    const auto read = command_of_line(bad);
    REQUIRE_FALSE(read);
    CHECK(read.error().sentence().find("lies beyond 1,000,000,000 mm") != std::string::npos);
  }
}

}  // namespace homolog
